//! The refusal that all formulas share: a length, modulus or count that is not a positive number.

/// A quantity that has to be positive and finite is not.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{quantity} has to be a positive number, not {value}")]
pub struct NotPositive {
    /// What the quantity is, in the words of the signature.
    pub quantity: &'static str,
    /// Its value, in SI units.
    pub value: f64,
}

/// Hands `value` on if it is positive and finite.
pub(super) fn positive(quantity: &'static str, value: f64) -> Result<f64, NotPositive> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(NotPositive { quantity, value })
    }
}
