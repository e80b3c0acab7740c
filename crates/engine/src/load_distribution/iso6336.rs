//! The single stiffness of ISO 6336-1, method B: one number for a pair of teeth, their bodies and their contact.
//!
//! The standard fits a polynomial in 1/z and x to sums of the tooth, body and contact compliances of steel disc gears cut by
//! one rack, and corrects it by factors. In its symbols, for spur gears:
//!
//! - q' = 0.04723 + 0.15551/z_1 + 0.25791/z_2 − 0.00635 x_1 − 0.11654 x_1/z_1 − 0.00193 x_2
//!   − 0.24188 x_2/z_2 + 0.00529 x_1² + 0.00182 x_2², in mm µm/N; gear 1 is the pinion;
//! - c'_th = 1/q', the theoretical single stiffness;
//! - C_B = (1 + 0.5 (1.2 − h_fP/m)) (1 − 0.02 (20° − α)) for other racks; the mean of the two where the gears' racks differ;
//! - E/E_steel for other materials, with E = 2 E_1 E_2/(E_1 + E_2) and E_steel = 206 GPa.
//!
//! Here c' = c'_th C_B E/E_steel, per unit of the common face width and along the line of action: the theoretical value, as with the other formulas. It is the
//! stiffness of a pair where it is stiffest, and stands for every position, so that the mean over the path of contact lies above theirs by some 5 to 35 %.
//!
//! The standard goes on to C_M = 0.8, the ratio of measured stiffnesses to the theory, to C_R for webbed blanks (1 for the discs here), and below a line load
//! of 100 N/mm to a stiffness that falls with its fourth root. These corrections are empirical, and left out: the stiffness is the same at every load.
//!
//! The fit holds for x_1 ≥ x_2 and −0.5 ≤ x_1 + x_2 ≤ 2. Outside, and at lower line loads, [`out_of_range`] says so and the
//! value is given all the same.

use super::range::{FormulaQuantity, FormulaRange};
use crate::gear::{GearPair, Member, Rack, SpurGear};

/// One N/(mm µm), in N/m².
const NEWTON_PER_MILLIMETER_MICROMETER: f64 = 1e9;
/// Young's modulus of the steel that the fit was made for, in Pa.
const STEEL_MODULUS: f64 = 206e9;
/// The sums of profile shifts that the fit was made for.
const SHIFT_SUMS: (f64, f64) = (-0.5, 2.0);
/// The line load from which the standard takes the stiffness as constant, in N/m.
const LEAST_LINE_LOAD: f64 = 100e3;

/// The single stiffness c' = c'_th C_B E/E_steel of `pair`, in N/m².
///
/// Far outside its range the fit can give one that is not positive.
pub(super) fn single_stiffness(pair: &GearPair) -> f64 {
    let gears = pinion_and_wheel(pair);
    let [e_1, e_2] = gears.map(|gear| gear.material().youngs_modulus);
    let [c_b1, c_b2] = gears.map(|gear| rack_factor(&gear.data().rack));
    let c_th = theoretical_stiffness(
        gears.map(|gear| f64::from(gear.tooth_count())),
        gears.map(|gear| gear.data().profile_shift),
    );
    c_th * f64::midpoint(c_b1, c_b2) * 2.0 / (1.0 / e_1 + 1.0 / e_2) / STEEL_MODULUS
}

/// Values of `pair` under its least output torque outside the range of the standard.
pub(super) fn out_of_range(pair: &GearPair, least_torque: f64) -> Vec<FormulaRange> {
    let [x_1, x_2] = pinion_and_wheel(pair).map(|gear| gear.data().profile_shift);
    let line_load = least_torque / pair.driven().reference_radius() / pair.common_face_width();
    let from = |least| (least, f64::INFINITY);
    [
        (FormulaQuantity::ShiftDifference, x_1 - x_2, from(0.0)),
        (FormulaQuantity::ShiftSum, x_1 + x_2, SHIFT_SUMS),
        (FormulaQuantity::LineLoad, line_load, from(LEAST_LINE_LOAD)),
    ]
    .into_iter()
    .filter_map(|(quantity, value, range)| FormulaRange::outside(quantity, None, value, range))
    .collect()
}

/// The gear with fewer teeth first; of two with equal counts, the one with more profile shift.
fn pinion_and_wheel(pair: &GearPair) -> [&SpurGear; 2] {
    let mut gears = Member::BOTH.map(|member| pair.gear(member));
    let [(z_1, x_1), (z_2, x_2)] =
        gears.map(|gear| (gear.tooth_count(), gear.data().profile_shift));
    if z_1 > z_2 || (z_1 == z_2 && x_1 < x_2) {
        gears.reverse();
    }
    gears
}

/// c'_th = 1/q' in N/m², of the tooth counts and profile shifts of pinion and wheel.
fn theoretical_stiffness([z_1, z_2]: [f64; 2], [x_1, x_2]: [f64; 2]) -> f64 {
    let q = 0.04723 + 0.15551 / z_1 + 0.25791 / z_2
        - 0.00635 * x_1
        - 0.11654 * x_1 / z_1
        - 0.00193 * x_2
        - 0.24188 * x_2 / z_2
        + 0.00529 * x_1.powi(2)
        + 0.00182 * x_2.powi(2);
    NEWTON_PER_MILLIMETER_MICROMETER / q
}

/// C_B of gears cut by `rack`.
fn rack_factor(rack: &Rack) -> f64 {
    (1.0 + 0.5 * (1.2 - rack.dedendum / rack.module))
        * (1.0 - 0.02 * (20.0 - rack.pressure_angle.to_degrees()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{GearData, SpurGear};

    /// C_M: ratio of measured single stiffnesses to c'_th; the published examples have it.
    const MEASURED_SHARE: f64 = 0.8;

    /// A value in N/m² against a print in N/(mm µm), to half a unit of its last digit.
    fn assert_printed(value: f64, print: f64, decimals: i32) {
        let value = value / 1e9;
        assert!(
            (value - print).abs() <= 0.5 * 10_f64.powi(-decimals),
            "{value} beside the printed {print}"
        );
    }

    /// Gears of the paper, cut by the rack of the standard's dedendum, of the standard's steel.
    fn drawn(tooth_count: u32, profile_shift: f64) -> GearData {
        let mut data = paper_gear(tooth_count);
        data.profile_shift = profile_shift;
        data.rack.dedendum = 2.4e-3;
        data.rack.tip_radius = 0.4e-3;
        data.material.youngs_modulus = 206e9;
        data.blank.bore_radius = 10e-3;
        data
    }

    fn pair(driving: GearData, driven: GearData, center_distance: f64) -> GearPair {
        let gear = |data| SpurGear::new(data).expect("the gear of a test");
        GearPair::new(gear(driving), gear(driven), center_distance).expect("the pair of a test")
    }

    #[test]
    fn the_worked_example_of_iso_tr_6336_30_comes_out_to_its_printed_digits() {
        // Example 1: z 17/103, β 15.8 degrees, x 0.145/0, rack D (h_fP 1.4, 20 degrees). Helical gears have the tooth
        // counts z/(cos² β_b cos β) of their equivalent spur gears and cos β in c'.
        let beta = 15.8_f64.to_radians();
        let base_helix_angle = (beta.sin() * 20_f64.to_radians().cos()).asin();
        let equivalent = |z: f64| z / (base_helix_angle.cos().powi(2) * beta.cos());
        let c_th = theoretical_stiffness([equivalent(17.0), equivalent(103.0)], [0.145, 0.0]);
        assert_printed(c_th, 17.85584, 5);
        let mut rack = paper_gear(50).rack;
        rack.dedendum = 1.4 * rack.module;
        assert_printed(
            c_th * MEASURED_SHARE * rack_factor(&rack) * beta.cos(),
            12.37047,
            5,
        );
    }

    #[test]
    fn the_papers_pairs_have_the_single_stiffnesses_worked_out_for_them() {
        // Worked out with C_M and for E_steel; the paper's rack has the dedendum 1.25.
        for (z_1, z_2, a, printed) in [(50, 50, 100.5e-3, 14.0545), (29, 85, 114.5e-3, 14.0221)] {
            let gear = |z| {
                let mut data = paper_gear(z);
                data.material.youngs_modulus = 206e9;
                data
            };
            let c = single_stiffness(&pair(gear(z_1), gear(z_2), a));
            assert_printed(c * MEASURED_SHARE, printed, 4);
        }
    }

    #[test]
    fn the_order_of_the_gears_does_not_matter() {
        for (one, other, a) in [
            (drawn(29, 0.2), drawn(85, -0.1), 114.4e-3),
            (drawn(50, 0.0), drawn(50, 0.3), 100.9e-3),
        ] {
            let [forward, backward] = [pair(one.clone(), other.clone(), a), pair(other, one, a)];
            assert_eq!(single_stiffness(&forward), single_stiffness(&backward));
            assert_eq!(out_of_range(&forward, 500.0), []);
            assert_eq!(out_of_range(&backward, 500.0), []);
        }
    }

    #[test]
    fn unlike_gears_have_the_mean_of_their_rack_factors_and_their_moduli_in_series() {
        let standard = drawn(50, 0.0);
        let c = |other| single_stiffness(&pair(standard.clone(), other, 100.5e-3));
        // h_fP = 1.4 alone makes C_B = 0.9; with 1.2 on the other gear 0.95.
        let mut deep = standard.clone();
        deep.rack.dedendum = 2.8e-3;
        assert!((c(deep) / c(standard.clone()) - 0.95).abs() < 1e-12);
        // E = 2/(1 + 1/3) = 1.5 of the softer of two moduli that are as one to three.
        let mut stiff = standard.clone();
        stiff.material.youngs_modulus *= 3.0;
        assert!((c(stiff) / c(standard.clone()) - 1.5).abs() < 1e-12);
    }

    #[test]
    fn the_rack_factor_falls_with_the_pressure_angle_as_by_hand() {
        let mut rack = drawn(50, 0.0).rack;
        assert!((rack_factor(&rack) - 1.0).abs() < 1e-12);
        // 1 − 0.02 (20 − 15) = 0.9.
        rack.pressure_angle = 15_f64.to_radians();
        assert!((rack_factor(&rack) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn what_lies_outside_the_range_is_named_with_its_value() {
        let flagged = |x_1, x_2, a, torque| -> Vec<_> {
            out_of_range(&pair(drawn(30, x_1), drawn(60, x_2), a), torque)
                .iter()
                .map(|found| (found.quantity, found.value))
                .collect()
        };
        assert_eq!(flagged(0.2, 0.1, 90.9e-3, 500.0), []);
        assert_eq!(
            flagged(0.125, 0.25, 90.9e-3, 500.0),
            [(FormulaQuantity::ShiftDifference, -0.125)]
        );
        assert_eq!(
            flagged(-0.25, -0.375, 88.9e-3, 500.0),
            [(FormulaQuantity::ShiftSum, -0.625)]
        );
        // 60 N m on a reference radius of 60 mm and 20 mm of width are 50 N/mm.
        let [(FormulaQuantity::LineLoad, line_load)] = flagged(0.0, 0.0, 90.5e-3, 60.0)[..] else {
            panic!("only the load is low")
        };
        assert!((line_load / 50e3 - 1.0).abs() < 1e-12);
    }
}
