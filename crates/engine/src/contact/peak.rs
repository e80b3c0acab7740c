//! Where flanks press hardest on each other.

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
