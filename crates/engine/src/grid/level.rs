//! Levels of the finite-element grids.

/// The public grid levels; each step halves every element.
///
/// The accuracies of coarse and standard are differences from fine in the flexible method over the true period, on the paper's cases and the standard pair;
/// `tests/validation/convergence.rs` checks them. A harmonic below a fifth of the largest one is meant as a part of that one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum GridLevel {
    /// Half as fine as standard, for first looks: within 0.2 % of the mean transmission error, 2 % of its peak-to-peak and rms,
    /// 0.3 % of the mean stiffness and 4 % of the first three mesh harmonics.
    Coarse,
    /// The level at which the published accuracy holds: within 0.03 % of the mean, 0.5 % of peak-to-peak and rms, 0.1 % of the
    /// mean stiffness and 1 % of the first three mesh harmonics.
    Standard,
    /// Twice as fine as standard: for error estimates.
    Fine,
}

impl GridLevel {
    /// The count at this level where the standard grid has about `standard`.
    ///
    /// The standard count is made even, so that the levels are 1 : 2 : 4 exactly.
    pub(super) fn count(self, standard: f64) -> usize {
        // A little more than half rounds up, so that similar gears, whose sizes differ by rounding, have equal grids.
        let half = (standard / 2.0 + 1e-9).round().max(1.0) as usize;
        match self {
            Self::Coarse => half,
            Self::Standard => 2 * half,
            Self::Fine => 4 * half,
        }
    }
}

impl GridLevel {
    /// How often this level halves every element of the coarse one.
    pub(super) fn halvings(self) -> u32 {
        match self {
            Self::Coarse => 0,
            Self::Standard => 1,
            Self::Fine => 2,
        }
    }

    /// The level to compare with for an error estimate: the next finer one, or the next coarser of the finest.
    pub fn neighbor(self) -> Self {
        match self {
            Self::Coarse => Self::Standard,
            Self::Standard => Self::Fine,
            Self::Fine => Self::Standard,
        }
    }
}
