//! Largest pressure between flanks, and its place.

/// The place of the largest pressure of a mesh at one position. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakPlace {
    /// The pair n.
    pub pair: i64,
    /// Roll length on the driving and on the driven gear.
    pub roll_lengths: [f64; 2],
    /// Its height from the middle of the common face; `None` in the plane.
    pub z: Option<f64>,
    /// Half the width of the contact there along the flank; 0 where no kink of a flank is seen.
    pub half_width: f64,
}

/// The largest pressure in Pa, and its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) pressure: f64,
    pub(super) place: PeakPlace,
}

impl Peak {
    /// The larger of two; the first of two that are the same.
    pub(super) fn larger(self, other: Self) -> Self {
        if other.pressure > self.pressure {
            other
        } else {
            self
        }
    }
}
