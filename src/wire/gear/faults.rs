//! What prevents a gear, told by field, with the bound beyond which it could be made.

use meshwright_engine::gear::data::{LEAST_LIGAMENT, LEAST_RIM, LEAST_TIP_THICKNESS};
use meshwright_engine::gear::{GearError, Relief, SpurGear};

use super::GearDocument;
use super::field::Field;
use super::relief::StartWay;
use crate::wire::problem::Code;
use crate::wire::units::{Side, from_mm, plain, rounded_inward, to_mm};

/// Why a gear cannot be made, and the bound beyond which it could, in the unit of the field.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub(super) field: Field,
    pub(super) code: Code,
    pub(super) detail: String,
    pub(super) bound: Option<(f64, Side)>,
    pub(super) cure: Option<f64>,
    pub(super) steps: u32,
}

impl Fault {
    fn new(field: Field, code: Code, detail: String, bound: Option<(f64, Side)>) -> Self {
        Self {
            field,
            code,
            detail,
            bound,
            cure: None,
            steps: 0,
        }
    }

    /// How many units inward the next cure goes, where the field is still at fault after this one: a bound that has
    /// not moved was met only up to the last bits.
    pub(super) fn steps_after(&self, next: &Self) -> u32 {
        match (self.bound, next.bound) {
            (Some((before, _)), Some((now, _))) if (before - now).abs() <= 1e-6 * now.abs() => {
                self.steps + 1
            }
            _ => 0,
        }
    }
}

impl GearDocument {
    /// Makes the gear, or tells the first thing that prevents it.
    pub(super) fn made(&self) -> Result<SpurGear, Fault> {
        self.check_proportions()?;
        let gear = SpurGear::new(self.data()).map_err(|error| self.fault(&error))?;
        // A relief that begins and ends at the tip is a step, which no grid and no contact search can follow.
        match gear.tip_relief().map(Relief::start_radius) {
            Some(start) if start > gear.tip_radius() - self.least_relief() => {
                Err(self.relief_fault(start, gear.form_radius(), gear.tip_radius()))
            }
            _ => Ok(gear),
        }
    }

    /// The least radial length of a relief, in meters.
    fn least_relief(&self) -> f64 {
        0.01 * from_mm(self.module_mm)
    }

    /// Bounds that depend on the other fields, so that nothing degenerate reaches the grids.
    fn check_proportions(&self) -> Result<(), Fault> {
        let m = self.module_mm;
        for (field, least, most) in [
            (Field::Addendum, 0.2, 2.0),
            (Field::Dedendum, 0.5, 2.5),
            (Field::RackTipRadius, 0.05, 2.0),
        ] {
            self.check_between(
                field,
                least * m,
                most * m,
                &format!("{least} and {most} modules"),
            )?;
        }
        // A bore or a hole that is a mere point has a logarithmically singular compliance.
        let least_bore = 0.05 * self.root_radius_mm();
        self.check_between(
            Field::Bore,
            least_bore,
            f64::INFINITY,
            "5 % of the root radius and more",
        )?;
        if self.blank.holes.is_some() {
            self.check_between(
                Field::HoleRadius,
                self.least_hole_mm(),
                f64::INFINITY,
                "1 % of the root radius and more",
            )?;
        }
        Ok(())
    }

    fn check_between(&self, field: Field, least: f64, most: f64, said: &str) -> Result<(), Fault> {
        let value = self.value(field);
        let bound = if value < least * (1.0 - 1e-12) {
            (least, Side::AtLeast)
        } else if value > most * (1.0 + 1e-12) {
            (most, Side::AtMost)
        } else {
            return Ok(());
        };
        let detail = format!("{} mm is outside {said}.", plain(value));
        Err(Fault::new(field, Code::OutOfRange, detail, Some(bound)))
    }

    fn least_hole_mm(&self) -> f64 {
        0.01 * self.root_radius_mm()
    }

    fn root_radius_mm(&self) -> f64 {
        self.module_mm * f64::from(self.tooth_count) / 2.0 - self.dedendum_mm
            + self.profile_shift * self.module_mm
    }

    fn fault(&self, error: &GearError) -> Fault {
        let mm = |value: f64| plain(to_mm(value));
        match *error {
            GearError::RackTipRadius {
                tip_radius,
                largest,
            } => Fault::new(
                Field::RackTipRadius,
                Code::OutOfRange,
                format!(
                    "A rack tip rounding of {} mm does not fit; at most {} mm does.",
                    mm(tip_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::Undercut {
                profile_shift,
                smallest,
            } => Fault::new(
                Field::ProfileShift,
                Code::Undercut,
                format!(
                    "{} teeth are undercut at profile shift {}; it takes at least {}.",
                    self.tooth_count,
                    plain(profile_shift),
                    plain(smallest)
                ),
                Some((smallest, Side::AtLeast)),
            ),
            GearError::PointedTip {
                thickness,
                largest_addendum,
            } => Fault::new(
                Field::Addendum,
                Code::PointedTip,
                if thickness < 0.0 {
                    format!(
                        "The flanks of a tooth cross below the tip circle; an addendum of at most {} mm avoids it.",
                        mm(largest_addendum)
                    )
                } else {
                    format!(
                        "The teeth are {} mm thick at the tip, less than {LEAST_TIP_THICKNESS} modules; an addendum of at most {} mm leaves enough.",
                        mm(thickness),
                        mm(largest_addendum)
                    )
                },
                Some((to_mm(largest_addendum), Side::AtMost)),
            ),
            GearError::NoFlank {
                tip_radius,
                form_radius,
            } => Fault::new(
                Field::Addendum,
                Code::OutOfRange,
                format!(
                    "The tip radius {} mm leaves no flank above the form radius {} mm.",
                    mm(tip_radius),
                    mm(form_radius)
                ),
                Some((
                    self.addendum_mm + to_mm(form_radius - tip_radius) + 0.1 * self.module_mm,
                    Side::AtLeast,
                )),
            ),
            GearError::ReliefTooLong {
                modification: _,
                start_radius,
                form_radius,
                tip_radius,
            } => self.relief_fault(start_radius, form_radius, tip_radius),
            GearError::BoreTooLarge {
                bore_radius,
                largest,
            } => Fault::new(
                Field::Bore,
                Code::BoreTooLarge,
                format!(
                    "A bore of radius {} mm leaves less than {LEAST_RIM} module below the root circle; at most {} mm.",
                    mm(bore_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::TeethTooThick { .. }
            | GearError::TipEdgeTooLarge { .. }
            | GearError::TableDoesNotRise { .. }
            | GearError::DeviationCount { .. } => Fault::new(
                Field::ProfileShift,
                Code::OutOfRange,
                error.to_string(),
                None,
            ),
            GearError::HolesOverlap {
                ligament,
                largest_radius,
            } => self.hole_fault(Code::HolesOverlap, "between them", ligament, largest_radius),
            GearError::HolesBreachRim {
                ligament,
                largest_radius,
            } => self.hole_fault(
                Code::HolesBreachRim,
                "below the root circle",
                ligament,
                largest_radius,
            ),
            GearError::HolesBreachBore {
                ligament,
                largest_radius,
            } => self.hole_fault(
                Code::HolesBreachBore,
                "around the bore",
                ligament,
                largest_radius,
            ),
        }
    }

    fn relief_fault(&self, start_radius: f64, form_radius: f64, tip_radius: f64) -> Fault {
        let highest = tip_radius - self.least_relief();
        let detail = format!(
            "The relief starts at radius {} mm; on this flank it can start from {} mm to {} mm.",
            plain(to_mm(start_radius)),
            plain(to_mm(form_radius)),
            plain(to_mm(highest))
        );
        let r_b = from_mm(self.module_mm * f64::from(self.tooth_count) / 2.0)
            * self.pressure_angle_deg.to_radians().cos();
        let roll = |radius: f64| (radius.powi(2) - r_b.powi(2)).max(0.0).sqrt();
        // The radius that is nearest, and on which side of it the flank is.
        let (nearest, above) = if start_radius > highest {
            (highest, Side::AtMost)
        } else {
            (form_radius, Side::AtLeast)
        };
        let below = match above {
            Side::AtMost => Side::AtLeast,
            Side::AtLeast => Side::AtMost,
        };
        let way = self.tip_relief.as_ref().map(|relief| relief.start.way);
        let bound = match way {
            Some(StartWay::RadialLength) => (to_mm(tip_radius - nearest), below),
            Some(StartWay::RollLengthFromTip) => (to_mm(roll(tip_radius) - roll(nearest)), below),
            Some(StartWay::Diameter) | None => (to_mm(2.0 * nearest), above),
            Some(StartWay::RollAngle) => ((roll(nearest) / r_b).to_degrees(), above),
        };
        Fault::new(Field::ReliefStart, Code::ReliefTooLong, detail, Some(bound))
    }

    /// The radius of the holes is to blame, unless no radius would do: then it is their circle.
    fn hole_fault(&self, code: Code, place: &str, ligament: f64, largest_radius: f64) -> Fault {
        let least = to_mm(LEAST_LIGAMENT);
        let detail = if ligament < 0.0 {
            format!(
                "The holes leave nothing {place}: they cut {} mm too far.",
                plain(to_mm(-ligament))
            )
        } else {
            format!(
                "The holes leave {} mm {place}; at least {least} mm has to stay.",
                plain(to_mm(ligament))
            )
        };
        let largest = rounded_inward(to_mm(largest_radius), Side::AtMost, 0);
        if self.accepts(Field::HoleRadius, largest) && largest >= self.least_hole_mm() {
            return Fault::new(
                Field::HoleRadius,
                code,
                detail,
                Some((to_mm(largest_radius), Side::AtMost)),
            );
        }
        let missing = least - to_mm(ligament);
        let circle = self.value(Field::HoleCircle);
        let bound = match code {
            Code::HolesBreachRim => (circle - missing, Side::AtMost),
            Code::HolesBreachBore => (circle + missing, Side::AtLeast),
            _ => {
                let count = self.blank.holes.as_ref().map_or(1, |holes| holes.count);
                let half_angle = std::f64::consts::PI / f64::from(count);
                (
                    (self.value(Field::HoleRadius) + least / 2.0) / half_angle.sin(),
                    Side::AtLeast,
                )
            }
        };
        Fault::new(Field::HoleCircle, code, detail, Some(bound))
    }
}
