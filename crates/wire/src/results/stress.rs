//! The largest stresses of both gears, position by position.

use meshwright_engine::analysis::Case;
use meshwright_engine::analysis::stress::{GearStresses, PeakStress, StressedPlace};
use meshwright_engine::gear::Member;

use super::all;
use super::largest_where::WhereDocument;
use crate::declare::document;
use crate::units::{to_mm, to_mpa};

document! {
    /// The largest stresses of both gears at each position. Angles are polar ones from the centerline of tooth 0, where it stands in the middle of
    /// the face, from 0 to 360 degrees; heights are those from the middle of the gear's own face, and absent in the plane.
    pub struct StressDocument as Stress, "Stress"
    answer of ([driving, driven]: &[GearStresses; 2]) {
        /// Of the driving gear.
        driving: GearStressDocument = GearStressDocument::of(driving),
        /// Of the driven gear.
        driven: GearStressDocument = GearStressDocument::of(driven),
    }
}

document! {
    /// The largest stresses of a gear at each position, and where they are.
    pub struct GearStressDocument as GearStress, "Stress of a gear"
    answer of (gear: &GearStresses) with {
        let stresses = |peaks: &[PeakStress]| all(peaks, |peak| to_mpa(peak.stress));
        let angles = |peaks: &[PeakStress]| all(peaks, |peak| peak.angle.to_degrees());
        let heights =
            |peaks: &[PeakStress]| peaks.iter().filter_map(|peak| peak.z.map(to_mm)).collect();
    } {
        /// The largest von Mises stress along the tensile root fillets of the teeth in mesh and their neighbors, in MPa.
        root_mpa: Vec<f64> = stresses(&gear.root),
        /// Where that is, in degrees.
        root_angle_deg: Vec<f64> = angles(&gear.root),
        /// How high that is, in mm; absent in the plane.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        root_z_mm: Vec<f64> = heights(&gear.root),
        /// The largest first principal stress along the root fillets on both sides of all teeth in reach of the load, in MPa.
        #[serde(default)]
        #[schema(required)]
        root_tension_mpa: Vec<f64> = stresses(&gear.root_tension),
        /// Where that is, in degrees.
        #[serde(default)]
        #[schema(required)]
        root_tension_angle_deg: Vec<f64> = angles(&gear.root_tension),
        /// How high that is, in mm; absent in the plane.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        root_tension_z_mm: Vec<f64> = heights(&gear.root_tension),
        /// The smallest one, in MPa: the largest compression, which is negative.
        #[serde(default)]
        #[schema(required)]
        root_compression_mpa: Vec<f64> = stresses(&gear.root_compression),
        /// Where that is, in degrees.
        #[serde(default)]
        #[schema(required)]
        root_compression_angle_deg: Vec<f64> = angles(&gear.root_compression),
        /// How high that is, in mm; absent in the plane.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        root_compression_z_mm: Vec<f64> = heights(&gear.root_compression),
        /// The largest von Mises stress along the edges of the holes, in MPa; absent without holes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        hole_mpa: Vec<f64> = stresses(&gear.holes),
        /// Where that is: the angle about the axis of the gear from the centerline of tooth 0, positive towards the loaded flank of that tooth, from 0 to 360 degrees;
        /// absent without holes.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        hole_angle_deg: Vec<f64> = angles(&gear.holes),
        /// How high that is, in mm; absent without holes, and in the plane.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        hole_z_mm: Vec<f64> = heights(&gear.holes),
    }
}

document! {
    /// The largest stresses of both gears over the span.
    pub struct PeakStressDocument as PeakStress, "Peak stress"
    answer of (of: (&Case, &[f64]), [driving, driven]: &[GearStresses; 2]) with {
        let (case, positions) = of;
    } {
        /// Of the driving gear.
        driving: GearPeakStress =
            GearPeakStress::of((case, Member::Driving), positions, driving),
        /// Of the driven gear.
        driven: GearPeakStress = GearPeakStress::of((case, Member::Driven), positions, driven),
    }
}

document! {
    /// The largest stresses of a gear over the span, between its positions too.
    pub struct GearPeakStress as GearPeakStress, "Peak stress of a gear"
    answer of (of: (&Case, Member), positions: &[f64], gear: &GearStresses) with {
        let extreme = |place: StressedPlace| {
            gear.largest(place, positions).map(|(_, peak)| to_mpa(peak.stress))
        };
    } {
        /// The largest von Mises stress along the tensile root fillets, in MPa.
        root_mpa: f64 = extreme(StressedPlace::Root).unwrap_or(0.0),
        /// The largest first principal stress along all root fillets, in MPa.
        root_tension_mpa?: f64 = extreme(StressedPlace::RootTension),
        /// The smallest one, in MPa: the largest compression, which is negative.
        root_compression_mpa?: f64 = extreme(StressedPlace::RootCompression),
        /// The largest von Mises stress along the edges of the holes, in MPa; absent without holes.
        hole_mpa?: f64 = extreme(StressedPlace::Hole),
        /// Where each of them stands; absent in results of versions before 0.5.
        largest_where?: GearStressWhere = Some(GearStressWhere::of(of, positions, gear)),
    }
}

document! {
    /// Where the largest stresses of a gear stand.
    pub struct GearStressWhere as GearStressWhere, "Places of the largest stresses of a gear"
    answer of ((case, member): (&Case, Member), positions: &[f64], gear: &GearStresses) with {
        let stands = |place: StressedPlace| {
            let (eta, peak) = gear.largest(place, positions)?;
            let on_tooth = place != StressedPlace::Hole;
            Some(WhereDocument::of(&peak.stands((case, member), eta, on_tooth)))
        };
    } {
        /// Of `root_mpa`.
        root_mpa?: WhereDocument = stands(StressedPlace::Root),
        /// Of `root_tension_mpa`.
        root_tension_mpa?: WhereDocument = stands(StressedPlace::RootTension),
        /// Of `root_compression_mpa`.
        root_compression_mpa?: WhereDocument = stands(StressedPlace::RootCompression),
        /// Of `hole_mpa`; absent without holes.
        hole_mpa?: WhereDocument = stands(StressedPlace::Hole),
    }
}
