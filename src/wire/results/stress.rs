//! The largest stresses of both gears, position by position.

use meshwright_engine::analysis::stress::{GearStresses, PeakStress};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::wire::units::to_mpa;

/// The largest stresses of both gears at each position. Angles are polar ones from the centerline of tooth 0, from 0 to 360 degrees.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Stress, title = "Stress")]
pub struct StressDocument {
    /// Of the driving gear.
    pub driving: GearStressDocument,
    /// Of the driven gear.
    pub driven: GearStressDocument,
}

/// The largest stresses of a gear at each position, and where they are.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = GearStress, title = "Stress of a gear")]
pub struct GearStressDocument {
    /// The largest von Mises stress along the tensile root fillets of the teeth in mesh and their neighbors, in MPa.
    pub root_mpa: Vec<f64>,
    /// Where that is, in degrees.
    pub root_angle_deg: Vec<f64>,
    /// The largest von Mises stress along the edges of the holes, in MPa; absent without holes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hole_mpa: Vec<f64>,
    /// Where that is, in degrees; absent without holes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hole_angle_deg: Vec<f64>,
}

/// The largest stresses of both gears over the span.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PeakStress, title = "Peak stress")]
pub struct PeakStressDocument {
    /// Of the driving gear.
    pub driving: GearPeakStress,
    /// Of the driven gear.
    pub driven: GearPeakStress,
}

/// The largest stresses of a gear over the span.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Peak stress of a gear")]
pub struct GearPeakStress {
    /// The largest von Mises stress along the tensile root fillets, in MPa.
    pub root_mpa: f64,
    /// The largest von Mises stress along the edges of the holes, in MPa; absent without holes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hole_mpa: Option<f64>,
}

impl StressDocument {
    pub(super) fn of([driving, driven]: &[GearStresses; 2]) -> Self {
        let stresses =
            |peaks: &[PeakStress]| peaks.iter().map(|peak| to_mpa(peak.stress)).collect();
        let angles =
            |peaks: &[PeakStress]| peaks.iter().map(|peak| peak.angle.to_degrees()).collect();
        let of = |gear: &GearStresses| GearStressDocument {
            root_mpa: stresses(&gear.root),
            root_angle_deg: angles(&gear.root),
            hole_mpa: stresses(&gear.holes),
            hole_angle_deg: angles(&gear.holes),
        };
        Self {
            driving: of(driving),
            driven: of(driven),
        }
    }
}

impl PeakStressDocument {
    pub(super) fn of([driving, driven]: &[GearStresses; 2]) -> Self {
        let largest = |peaks: &[PeakStress]| {
            let stresses = peaks.iter().map(|peak| to_mpa(peak.stress));
            stresses.reduce(f64::max)
        };
        let of = |gear: &GearStresses| GearPeakStress {
            root_mpa: largest(&gear.root).unwrap_or(0.0),
            hole_mpa: largest(&gear.holes),
        };
        Self {
            driving: of(driving),
            driven: of(driven),
        }
    }
}
