//! How fine the finite-element grids are.

/// The public grid levels; each step halves every element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum GridLevel {
    /// Half as fine as standard: for first looks.
    Coarse,
    /// The level at which the published accuracy holds.
    Standard,
    /// Twice as fine as standard: for error estimates.
    Fine,
}
