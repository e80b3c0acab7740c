//! The designs that there are.

use std::collections::HashSet;

/// A variable: any number between two, or the first of so many steps from one to the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Every value between its ends.
    Continuous,
    /// Number of steps from one end to the other.
    Steps(u32),
}

impl Axis {
    /// Brings `u` to a value that the axis has. Each has the same part of the axis to itself.
    pub fn snapped(self, u: f64) -> f64 {
        let u = if u.is_finite() { u } else { 0.5 };
        match self {
            Self::Continuous => u.clamp(0.0, 1.0),
            Self::Steps(0) => 0.0,
            Self::Steps(steps) => self.cell(u) / f64::from(steps),
        }
    }

    /// The middle of the part of the axis that the value at `snapped` has to itself.
    pub(crate) fn middle(self, snapped: f64) -> f64 {
        match self {
            Self::Continuous => snapped,
            Self::Steps(steps) => {
                ((snapped * f64::from(steps)).round() + 0.5) / f64::from(steps + 1)
            }
        }
    }

    fn cell(self, u: f64) -> f64 {
        match self {
            Self::Continuous => u,
            Self::Steps(steps) => (u * f64::from(steps + 1))
                .floor()
                .clamp(0.0, f64::from(steps)),
        }
    }

    /// The value so many steps beyond that at `snapped`, or as far as the axis goes.
    pub(crate) fn beyond(self, snapped: f64, steps: f64) -> f64 {
        match self {
            Self::Continuous => snapped,
            Self::Steps(0) => 0.0,
            Self::Steps(count) => {
                let count = f64::from(count);
                ((snapped * count).round() + steps).clamp(0.0, count) / count
            }
        }
    }
}

/// The number of designs that there are; none where a variable is continuous.
pub(crate) fn count(axes: &[Axis]) -> Option<u64> {
    axes.iter().try_fold(1_u64, |count, axis| match axis {
        Axis::Continuous => None,
        Axis::Steps(steps) => Some(count.saturating_mul(u64::from(*steps) + 1)),
    })
}

/// The designs that have been asked for.
#[derive(Debug, Default)]
pub(crate) struct Known(HashSet<Vec<u64>>);

impl Known {
    /// Notes a design; whether it is new.
    pub(crate) fn add(&mut self, point: &[f64]) -> bool {
        self.0.insert(key(point))
    }

    pub(crate) fn has(&self, point: &[f64]) -> bool {
        self.0.contains(&key(point))
    }

    pub(crate) fn count(&self) -> u64 {
        self.0.len() as u64
    }
}

fn key(point: &[f64]) -> Vec<u64> {
    point.iter().map(|u| u.to_bits()).collect()
}
