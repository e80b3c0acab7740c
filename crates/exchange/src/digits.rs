//! Numbers in as many digits as they have.

/// `value` rounded to `digits` significant decimal digits, half to even of its exact value; a negative zero loses its sign.
pub fn significant(value: f64, digits: usize) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value + 0.0;
    }
    let digits = digits.max(1);
    by_one_quotient(value, digits)
        .unwrap_or_else(|| format!("{value:.*e}", digits - 1).parse().unwrap_or(value))
}

/// The same where that is sure: results are thousands of numbers, and a text takes ten times as long.
///
/// A whole number of so few digits is a double, a power of ten up to the 22nd is too, and their quotient or product is rounded once, as a
/// text is that is read (Clinger 1990, "How to read floating point numbers accurately").
fn by_one_quotient(value: f64, digits: usize) -> Option<f64> {
    /// Fifteen digits are less than 2^53.
    const MOST_DIGITS: usize = 15;
    if digits > MOST_DIGITS {
        return None;
    }
    let shift = digits as i32 - 1 - value.abs().log10().floor() as i32;
    let scale = *POWERS.get(shift.unsigned_abs() as usize)?;
    let scaled = if shift < 0 {
        value / scale
    } else {
        value * scale
    };
    let whole = scaled.round();
    let from_half = (scaled.fract().abs() - 0.5).abs();
    let rounding = 2.0 * f64::EPSILON * scaled.abs();
    // The logarithm may lie on the wrong side of a power of ten, and the last digit may carry into one.
    let (least, most) = (POWERS[digits - 1], POWERS[digits]);
    if from_half <= rounding || scaled.abs() < least || whole.abs() >= most {
        return None;
    }
    Some(if shift < 0 {
        whole * scale
    } else {
        whole / scale
    })
}

/// The powers of ten that are doubles.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The rounding by text.
    fn by_text(value: f64, digits: usize) -> f64 {
        format!("{value:.*e}", digits - 1).parse().unwrap()
    }

    #[test]
    fn it_is_what_a_text_of_so_many_digits_says() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut quick = 0;
        for round in 0..300_000 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let digits = 1 + (state >> 60) as usize;
            let exponent = (state >> 40) as i32 % 40 - 20;
            // Any number, numbers of few digits and their neighbors, and numbers half between two of them.
            let mantissa = (state >> 11) as f64 / (1_u64 << 53) as f64;
            let few = (mantissa * 1e4).floor();
            let value = match round % 4 {
                0 => f64::from_bits(state),
                1 => mantissa * 10_f64.powi(exponent),
                2 => f64::from_bits((few * 10_f64.powi(exponent)).to_bits() + (state >> 20) % 3),
                _ => (few + 0.5) * 10_f64.powi(exponent.rem_euclid(4)),
            };
            if value == 0.0 || !value.is_finite() {
                continue;
            }
            for value in [value, -value] {
                assert_eq!(
                    significant(value, digits).to_bits(),
                    by_text(value, digits).to_bits(),
                    "{value:e} to {digits} digits"
                );
            }
            quick += usize::from(by_one_quotient(value, 10).is_some());
        }
        assert!(quick > 100_000, "{quick} without a text");
    }

    #[test]
    fn what_carries_over_or_is_no_number_is_told_as_it_is() {
        assert_eq!(significant(9.999_999_999_96, 10), 10.0);
        assert_eq!(significant(0.1 + 0.2, 10), 0.3);
        assert_eq!(significant(5e-324, 10), 5e-324);
        assert!(significant(-0.0, 3).is_sign_positive());
        assert!(significant(f64::NAN, 3).is_nan());
    }
}
