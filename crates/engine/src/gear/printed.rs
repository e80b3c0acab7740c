//! Uncertainty of a drawing by its last printed digits.
//!
//! Gear programs print profile shifts to four decimals and center distances to three decimals of a millimeter; a negative backlash within that is not a jam.

use super::GearPair;

/// Half the last digit of a printed center distance, in meters.
const DISTANCE: f64 = 0.5e-6;

/// Half the last digits of two printed profile shifts, in modules.
const SHIFTS: f64 = 1e-4;

/// Modules in mm with decimals no finer than this are those of a standard (ISO 54), and are exact.
const STANDARD_MODULE: f64 = 0.01;

/// The unit of the last digit with which `value` is written, at most one; digits beyond the fifteenth are those of computation.
pub fn last_unit(value: f64) -> f64 {
    let written = format!("{value:.14e}");
    let Some((digits, exponent)) = written.split_once('e') else {
        return 0.0;
    };
    let decimals = digits
        .trim_end_matches('0')
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let exponent = exponent.parse().unwrap_or(0) - decimals as i32;
    10_f64.powi(exponent.min(0))
}

/// True if `one` and `other` are one value, printed with more digits and with fewer. A value of few digits is taken for exact, unless the other one is as good
/// as equal.
pub fn differ_in_digits_only(one: f64, other: f64) -> bool {
    const FEW_DIGITS: f64 = 1e-3;
    const AS_GOOD_AS_EQUAL: f64 = 1e-5;
    let unit = last_unit(one).max(last_unit(other));
    let apart = (one - other).abs();
    let is_rounded = apart <= 0.5 * unit * (1.0 + 1e-6);
    is_rounded && (unit <= FEW_DIGITS * (1.0 + 1e-6) || apart <= AS_GOOD_AS_EQUAL * one.abs())
}

/// Half a unit of the last digit of a `module`, both in meters: nothing of one that is exact, by a standard or by a whole diametral pitch.
fn half_unit_of_module(module: f64) -> f64 {
    let mm = 1e3 * module;
    let unit = last_unit(mm);
    let is_whole = |value: f64| (value - value.round()).abs() < 1e-9 * value;
    let is_exact = unit > 0.99 * STANDARD_MODULE || is_whole(8.0 * mm) || is_whole(25.4 / mm);
    if is_exact { 0.0 } else { 0.5e-3 * unit }
}

impl GearPair {
    /// How much of a backlash along the line of action the last printed digits leave open: 2 sin α_w (half a micrometer of the center distance, 10⁻⁴
    /// modules of the profile shifts, and half a unit of the module's last digit times (z₁ + z₂)/(2 cos β)).
    pub(super) fn backlash_in_last_digits(&self) -> f64 {
        let module = self.driving().normal_rack().module;
        let stretch = self.driving().data().rack.module / module;
        let teeth = f64::from(self.driving().tooth_count() + self.driven().tooth_count());
        let of_module = half_unit_of_module(module) * stretch * teeth / 2.0;
        2.0 * self.working_pressure_angle().sin() * (DISTANCE + SHIFTS * module + of_module)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_of_a_number_is_that_of_its_shortest_writing() {
        for (value, unit) in [
            (2.0, 1.0),
            (20.0, 1.0),
            (4.5, 0.1),
            (2.1167, 1e-4),
            (2.11667, 1e-5),
            (20.000_000_1, 1e-7),
            (0.0125, 1e-4),
            (1e3 * (2.1167 / 1e3), 1e-4),
        ] {
            let found = last_unit(value);
            assert!((found / unit - 1.0).abs() < 1e-12, "{value}: {found}");
        }
        assert!(last_unit(3.353_658_536_585_365_7) < 1e-13);
    }

    #[test]
    fn a_module_of_a_standard_is_exact_and_a_converted_one_is_not() {
        // ISO 54, its third decimals, and 10, 8 and 16 teeth to an inch.
        for mm in [2.0, 4.5, 1.25, 1.125, 0.55, 2.54, 3.175, 1.5875] {
            assert_eq!(half_unit_of_module(mm / 1e3), 0.0, "{mm}");
        }
        // 12 teeth to an inch are 2.116666... mm.
        for (mm, half) in [(2.117, 0.5e-6), (2.1167, 0.5e-7), (2.116_67, 0.5e-8)] {
            let found = half_unit_of_module(mm / 1e3);
            assert!((found / half - 1.0).abs() < 1e-9, "{mm}: {found}");
        }
    }

    #[test]
    fn one_value_printed_twice_is_distinguished_from_two_values() {
        for (one, other, alike) in [
            (2.1167, 2.116_67, true),
            (2.116_67, 2.1167, true),
            (2.117, 2.116_67, true),
            (20.0, 20.000_000_1, true),
            (3.353_658_536_585_365_7, 3.353_658_536_585_366, true),
            (2.1168, 2.116_67, false),
            (2.0, 2.25, false),
            (17.5, 17.45, false),
            (20.000_000_1, 20.000_000_2, false),
        ] {
            assert_eq!(differ_in_digits_only(one, other), alike, "{one} {other}");
        }
    }
}
