//! Cost of a case: memory, time, and the parts that other designs share.

use crate::assembly::{FaceComplianceSpec, FaceContactsSpec, GearSpec, TeethSpec};

/// Cost of a case.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Unknowns of both gears before condensation.
    pub degrees_of_freedom: u64,
    /// Memory in bytes.
    pub memory: u64,
    /// Time on one core in seconds, nothing cached.
    pub seconds: f64,
    /// The parts that are made in this time, and that other designs may have too.
    pub parts: Vec<PartCost>,
}

/// A part of a case, and the time that it takes to make it.
#[derive(Debug, Clone, PartialEq)]
pub struct PartCost {
    spec: PartSpec,
    /// Time on one core in seconds.
    pub seconds: f64,
}

/// Specification that decides a part.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum PartSpec {
    Teeth(Box<TeethSpec>),
    Gear(Box<GearSpec>),
    Face(Box<FaceComplianceSpec>),
    DrawnFaces(Box<FaceContactsSpec>),
}

impl PartCost {
    /// True if it is the same part as `other`, which a library makes once for both.
    pub fn is_same(&self, other: &Self) -> bool {
        self.spec == other.spec
    }
}

impl Estimate {
    /// Adds the cost of a part. One that both gears have is made once.
    pub(super) fn add_part(&mut self, spec: PartSpec, seconds: f64) {
        if self.parts.iter().all(|part| part.spec != spec) {
            self.seconds += seconds;
            self.parts.push(PartCost { spec, seconds });
        }
    }
}
