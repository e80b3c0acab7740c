//! Numbers in as many digits as they have.

/// `value` rounded to `digits` significant decimal digits; a negative zero loses its sign.
pub fn significant(value: f64, digits: usize) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value + 0.0;
    }
    format!("{value:.*e}", digits.max(1) - 1)
        .parse()
        .unwrap_or(value)
}
