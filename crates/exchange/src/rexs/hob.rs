//! The protuberance of the hob that cuts the root, and the stock that it leaves to be ground.

use serde_json::{Value, json};

use super::content::Component;
use super::gear::{DIGITS, Gear, SAME};
use super::own;
use super::unit::{DEG, MM_OR_NONE, NONE, um_of_mm};
use crate::significant;

/// The attributes of a tool that say how far its tip stands out from its flank, in mm and in modules.
const AMOUNT: [&str; 2] = ["protuberance_amount", "protuberance_amount_factor"];

/// Attributes of the height above its tip line where that begins.
const HEIGHT: [&str; 2] = ["protuberance_height", "protuberance_height_factor"];

/// The angle of its flank there, which says the same.
const ANGLE: &str = "protuberance_angle";

/// The attribute of a flank that says how much of the protuberance is left after grinding.
const REMAINING: &str = "remaining_protuberance";

/// Angles nearer than this are the same, in degrees: gear programs print one or two digits.
const SAME_ANGLE_DEG: f64 = 0.05;

impl<'a> Gear<'a> {
    /// The protuberance of the hob as a submission has it: from our own attribute if it is there, otherwise from the standard's attributes. `tip_radius` is the
    /// rounding of the tool's tip, in mm. Missing and contradictory values are reported.
    pub(super) fn protuberance(&self, pointer: &str, tip_radius: Option<f64>) -> Option<Value> {
        let reading = self.reading;
        let field = format!("{pointer}/protuberance");
        if let Some(ours) = reading.json(self.gear, own::PROTUBERANCE) {
            reading.from(field, self.gear, own::PROTUBERANCE);
            return Some(ours);
        }
        let lengths = |tool, [length, factor]: [&'static str; 2]| {
            let names = [(length, 1.0), (factor, self.module)];
            reading.either(tool, names, [MM_OR_NONE, NONE])
        };
        let of_tool = self.tool.and_then(|tool| {
            let (amount, name) = lengths(tool, AMOUNT)?;
            (amount != 0.0).then_some((tool, amount, name))
        });
        let remaining = self.flanks.iter().find_map(|flank| {
            let amount = reading.number(flank, REMAINING, MM_OR_NONE)?;
            (amount != 0.0).then_some((*flank, amount))
        });
        let Some((tool, amount, name)) = of_tool else {
            if let Some((flank, amount)) = remaining {
                let detail = format!(
                    "It is {amount} mm, and no {} of a rack_shaped_tool says what it remains of.",
                    AMOUNT[0]
                );
                reading.wrong(flank.place_of(REMAINING), detail);
            }
            return None;
        };
        let height = match (lengths(tool, HEIGHT), reading.number(tool, ANGLE, DEG)) {
            (Some((height, name)), angle) => {
                reading.from(format!("{field}/height_mm"), tool, name);
                let other = angle.filter(|angle| *angle > 0.0);
                let other = other.zip(tip_radius).filter(|(angle, radius)| {
                    let [less, more] = [-1.0, 1.0]
                        .map(|way| self.height(amount, angle + way * SAME_ANGLE_DEG, *radius));
                    !(less - SAME..=more + SAME).contains(&height)
                });
                if let Some((angle, radius)) = other {
                    reading.remark(format!(
                        "Not read: {}: {angle} deg would begin {} mm above the tip of the hob, {name} says {height} mm.",
                        tool.place_of(ANGLE),
                        significant(self.height(amount, angle, radius), 6)
                    ));
                }
                height
            }
            (None, Some(angle)) => {
                let (true, Some(radius)) =
                    ((0.0..self.pressure_angle_deg).contains(&angle), tip_radius)
                else {
                    let detail = format!(
                        "It is {angle} deg; a {} is expected, or an angle of at least 0 and less than the pressure angle beside a tip radius.",
                        HEIGHT[0]
                    );
                    reading.wrong(tool.place_of(ANGLE), detail);
                    return None;
                };
                reading.from(format!("{field}/height_mm"), tool, ANGLE);
                significant(self.height(amount, angle, radius), DIGITS)
            }
            (None, None) => {
                let detail = format!(
                    "It has neither {} nor {ANGLE}: where does its protuberance begin?",
                    HEIGHT[0]
                );
                reading.wrong(tool.place(), detail);
                return None;
            }
        };
        let said = self.stock();
        if let Some(((flank, rest), stock)) = remaining.zip(said)
            && (amount - stock - rest).abs() > SAME
        {
            reading.remark(format!(
                "Not read: {}: {name} {amount} mm less the stock {} mm leaves {} mm.",
                flank.place_of(REMAINING),
                significant(stock, 6),
                significant(amount - stock, 6)
            ));
        }
        let stock = said.or_else(|| Some(amount - remaining?.1));
        let stock = stock.unwrap_or_else(|| {
            reading.assumed(tool, "machining_allowance", "none: nothing is ground off");
            0.0
        });
        reading.from(format!("{field}/amount_um"), tool, name);
        let um = |length: f64| significant(um_of_mm(length), DIGITS);
        Some(json!({
            "amount_um": um(amount),
            "height_mm": height,
            "grinding_stock_um": um(stock),
        }))
    }

    /// How far above the tip line the straight flank of a protuberance begins that has `angle` degrees to the middle of the hob's tooth and touches
    /// the tip rounding: from there on it is inside of the hob's own flank. Lengths are in mm.
    fn height(&self, amount: f64, angle: f64, tip_radius: f64) -> f64 {
        // Half widths of the hob's tooth at the height y, from that of its flank at the tip line on: y tan(alpha) of the flank, and a + y tan(beta) of
        // the protuberance's, both beside the center of the rounding at the height rho.
        let (alpha, beta) = (self.pressure_angle_deg.to_radians(), angle.to_radians());
        let flatter = alpha.tan() - beta.tan();
        let beside = (amount - tip_radius) / alpha.cos() + tip_radius / beta.cos();
        tip_radius + beside / flatter
    }

    /// The stock on each flank, normal to it, that the first manufacturing step leaves for the others: that it says, or that its generated shift
    /// says against that of the last step. None if neither is said.
    fn stock(&self) -> Option<f64> {
        let said = self.allowance();
        if said > 0.0 {
            return Some(said);
        }
        let shift = |settings: &&'a Component| Some(self.generated_shift(settings)?.0);
        let [first, .., last] = self.settings.as_slice() else {
            return None;
        };
        let thicker = shift(first)? - shift(last)?;
        Some(thicker * self.module * self.pressure_angle_deg.to_radians().sin())
    }
}
