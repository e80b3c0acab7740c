//! The largest stresses of both gears, position by position.

use meshwright_engine::analysis::stress::{GearStresses, PeakStress};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::wire::units::{to_mm, to_mpa};

/// The largest stresses of both gears at each position. Angles are polar ones from the centerline of tooth 0, where it stands in the middle of
/// the face, from 0 to 360 degrees; heights are those from the middle of the gear's own face, and absent in the plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Stress, title = "Stress")]
pub struct StressDocument {
    /// Of the driving gear.
    pub driving: GearStressDocument,
    /// Of the driven gear.
    pub driven: GearStressDocument,
}

/// The largest stresses of a gear at each position, and where they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = GearStress, title = "Stress of a gear")]
pub struct GearStressDocument {
    /// The largest von Mises stress along the tensile root fillets of the teeth in mesh and their neighbors, in MPa.
    pub root_mpa: Vec<f64>,
    /// Where that is, in degrees.
    pub root_angle_deg: Vec<f64>,
    /// How high that is, in mm; absent in the plane.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub root_z_mm: Vec<f64>,
    /// The largest first principal stress along the root fillets on both sides of all teeth in reach of the load, in MPa.
    #[serde(default)]
    #[schema(required)]
    pub root_tension_mpa: Vec<f64>,
    /// Where that is, in degrees.
    #[serde(default)]
    #[schema(required)]
    pub root_tension_angle_deg: Vec<f64>,
    /// How high that is, in mm; absent in the plane.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub root_tension_z_mm: Vec<f64>,
    /// The smallest one, in MPa: the largest compression, which is negative.
    #[serde(default)]
    #[schema(required)]
    pub root_compression_mpa: Vec<f64>,
    /// Where that is, in degrees.
    #[serde(default)]
    #[schema(required)]
    pub root_compression_angle_deg: Vec<f64>,
    /// How high that is, in mm; absent in the plane.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub root_compression_z_mm: Vec<f64>,
    /// The largest von Mises stress along the edges of the holes, in MPa; absent without holes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hole_mpa: Vec<f64>,
    /// Where that is, in degrees; absent without holes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hole_angle_deg: Vec<f64>,
    /// How high that is, in mm; absent without holes, and in the plane.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub hole_z_mm: Vec<f64>,
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
    /// The largest first principal stress along all root fillets, in MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub root_tension_mpa: Option<f64>,
    /// The smallest one, in MPa: the largest compression, which is negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub root_compression_mpa: Option<f64>,
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
        let heights = |peaks: &[PeakStress]| {
            peaks
                .iter()
                .filter_map(|peak| Some(to_mm(peak.z?)))
                .collect()
        };
        let of = |gear: &GearStresses| GearStressDocument {
            root_mpa: stresses(&gear.root),
            root_angle_deg: angles(&gear.root),
            root_z_mm: heights(&gear.root),
            root_tension_mpa: stresses(&gear.root_tension),
            root_tension_angle_deg: angles(&gear.root_tension),
            root_tension_z_mm: heights(&gear.root_tension),
            root_compression_mpa: stresses(&gear.root_compression),
            root_compression_angle_deg: angles(&gear.root_compression),
            root_compression_z_mm: heights(&gear.root_compression),
            hole_mpa: stresses(&gear.holes),
            hole_angle_deg: angles(&gear.holes),
            hole_z_mm: heights(&gear.holes),
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
        let smallest = |peaks: &[PeakStress]| {
            let stresses = peaks.iter().map(|peak| to_mpa(peak.stress));
            stresses.reduce(f64::min)
        };
        let of = |gear: &GearStresses| GearPeakStress {
            root_mpa: largest(&gear.root).unwrap_or(0.0),
            root_tension_mpa: largest(&gear.root_tension),
            root_compression_mpa: smallest(&gear.root_compression),
            hole_mpa: largest(&gear.holes),
        };
        Self {
            driving: of(driving),
            driven: of(driven),
        }
    }
}
