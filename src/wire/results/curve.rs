//! The curves at one output torque, and their statistics.

use meshwright_engine::analysis::curve::LeadCure;
use meshwright_engine::analysis::forces::CurveDynamics;
use meshwright_engine::analysis::{Case, Curve, FaceLoad, Statistics};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::decomposition::DecompositionDocument;
use super::each;
use super::forces::CurveDynamicsDocument;
use super::spectrum::SpectrumDocument;
use super::stress::{PeakStressDocument, StressDocument};
use crate::wire::units::{or_null, significant, to_mm, to_mpa, to_um};

/// The curves at one output torque. All lists, those of the spectrum and of the dynamics aside, run over the same positions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Curve, title = "Curve")]
pub struct CurveDocument {
    /// The output torque on the driven gear, in N m.
    pub output_torque_n_m: f64,
    /// The transmitted load on the line of action, in N: the torque over the driven base radius.
    pub load_n: f64,
    /// The mesh position, in mesh periods, end excluded; at 0 the reference pair touches at the pitch point.
    pub mesh_position: Vec<f64>,
    /// The rigid rotation of the driving gear, in degrees.
    pub driving_angle_deg: Vec<f64>,
    /// The rigid rotation of the driven gear, in degrees.
    pub driven_angle_deg: Vec<f64>,
    /// The static transmission error, in um, positive when load makes the driven gear lag.
    pub transmission_error_um: Vec<f64>,
    /// The tangent stiffness dF/d delta, in N/m.
    pub mesh_stiffness_tangent_n_per_m: Vec<f64>,
    /// The secant stiffness F/delta, in N/m.
    pub mesh_stiffness_secant_n_per_m: Vec<f64>,
    /// The torque that the driver has to give, in N m; the load times the driving base radius where unmodified flanks touch on the line of action
    /// alone.
    #[serde(default)]
    #[schema(required)]
    pub driving_torque_n_m: Vec<f64>,
    /// The number of tooth pairs that carry load.
    pub pairs_in_contact: Vec<u32>,
    /// The largest contact pressure, in MPa; null where a sharp tip corner carries, at which it has no limit.
    #[serde(serialize_with = "or_null")]
    pub peak_contact_pressure_mpa: Vec<Option<f64>>,
    /// The share of the load on each pair that ever carries any, by rising offset.
    pub load_shares: Vec<LoadShareDocument>,
    /// The largest stresses; absent unless the submission asks for them, for other methods than `flexible` and `three_dimensional`, and
    /// at the torque 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stress: Option<StressDocument>,
    /// The load along the common face; absent for plane methods and at the torque 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<FaceDocument>,
    /// Statistics over the span.
    pub statistics: StatisticsDocument,
    /// The order spectrum; absent for a partial span.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumDocument>,
    /// What the decomposition adds up; absent for other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decomposition: Option<DecompositionDocument>,
    /// The motion over speed; absent unless the submission asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamics: Option<CurveDynamicsDocument>,
}

impl CurveDocument {
    pub(super) fn of(case: &Case, curve: &Curve, dynamics: Option<&CurveDynamics>) -> Self {
        let turned = |tooth_count: u32| {
            each(&curve.mesh_position, |eta| {
                eta * 360.0 / f64::from(tooth_count)
            })
        };
        Self {
            output_torque_n_m: curve.output_torque,
            load_n: curve.load,
            mesh_position: curve.mesh_position.clone(),
            driving_angle_deg: turned(case.pair.driving().tooth_count()),
            driven_angle_deg: turned(case.pair.driven().tooth_count()),
            transmission_error_um: each(&curve.transmission_error, to_um),
            mesh_stiffness_tangent_n_per_m: curve.mesh_stiffness_tangent.clone(),
            mesh_stiffness_secant_n_per_m: curve.mesh_stiffness_secant.clone(),
            driving_torque_n_m: curve.driving_torque.clone(),
            pairs_in_contact: curve.pairs_in_contact.clone(),
            peak_contact_pressure_mpa: curve
                .peak_contact_pressure
                .iter()
                .map(|pressure| pressure.map(to_mpa))
                .collect(),
            load_shares: curve
                .load_shares
                .iter()
                .map(|share| LoadShareDocument {
                    pair_offset: share.pair_offset,
                    share: share.share.clone(),
                })
                .collect(),
            stress: curve.stresses.as_ref().map(StressDocument::of),
            face: curve.face.as_ref().map(FaceDocument::of),
            statistics: StatisticsDocument {
                partial: !case.covers_whole_periods(),
                transmission_error_um: StatisticsValues::of(
                    &curve.transmission_error_statistics,
                    to_um,
                ),
                mesh_stiffness_tangent_n_per_m: StatisticsValues::of(
                    &curve.mesh_stiffness_tangent_statistics,
                    |value| value,
                ),
                stress: curve.stresses.as_ref().map(PeakStressDocument::of),
            },
            spectrum: curve
                .spectrum
                .as_ref()
                .map(|spectrum| SpectrumDocument::of(case, spectrum)),
            decomposition: curve.decomposition.as_ref().map(DecompositionDocument::of),
            dynamics: dynamics.map(CurveDynamicsDocument::of),
        }
    }
}

/// The load along the common face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Face, title = "Load along the face")]
pub struct FaceDocument {
    /// The middles of equal strips of the common face, in mm from its middle; +z is the side from which the driving gear is seen to turn
    /// counter-clockwise.
    pub z_mm: Vec<f64>,
    /// The load on each strip for its width, along the transverse line of action, in N/mm: one row, the mean over the positions, or a row a
    /// position where the submission asks for them.
    pub load_n_per_mm: Vec<Vec<f64>>,
    /// K_Hbeta: of ten equal strips of the common face the load of the largest over their mean, the mean over the positions of each.
    pub face_load_factor: f64,
    /// The lead that would make K_Hbeta least.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cure: Option<LeadCureDocument>,
    /// Where the load stands in the mean at each position, in mm from the middle of the common face.
    pub load_centroid_mm: Vec<f64>,
}

impl FaceDocument {
    fn of(face: &FaceLoad) -> Self {
        let row = |row: &Vec<f64>| each(row, |load| load * 1e-3);
        Self {
            z_mm: each(&face.heights, to_mm),
            load_n_per_mm: face.load.iter().map(row).collect(),
            face_load_factor: face.face_load_factor,
            cure: face.cure.as_ref().map(LeadCureDocument::of),
            load_centroid_mm: each(&face.load_centroid, to_mm),
        }
    }
}

/// What would even the load along the face at this torque: add a slope and a crowning of these amounts to the `lead_modifications` of the driving gear.
/// Found from a few positions, and within 2 % of what a job finds for it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = LeadCure, title = "Lead that evens the load")]
pub struct LeadCureDocument {
    /// The slope to add, in um: taken off at the +z end of the face; negative adds.
    pub lead_slope_um: f64,
    /// The crowning to add, in um; negative takes back what the leads have of it, and makes no flank hollow.
    pub crowning_um: f64,
    /// K_Hbeta with both.
    pub face_load_factor: f64,
}

impl LeadCureDocument {
    fn of(cure: &LeadCure) -> Self {
        Self {
            lead_slope_um: significant(to_um(cure.slope), 4),
            crowning_um: significant(to_um(cure.crowning), 4),
            face_load_factor: significant(cure.face_load_factor, 4),
        }
    }
}

/// The share of the load that the pairs at one offset carry.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = LoadShare, title = "Load share")]
pub struct LoadShareDocument {
    /// 0 for the pair that passed the pitch point last, 1 for the next, -1 for the one before.
    pub pair_offset: i32,
    /// Its share of the load, from 0 to 1.
    pub share: Vec<f64>,
}

/// Statistics over the span.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Statistics, title = "Statistics")]
pub struct StatisticsDocument {
    /// Whether the span is less than whole true periods.
    pub partial: bool,
    /// Of the transmission error, in um.
    pub transmission_error_um: StatisticsValues,
    /// Of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: StatisticsValues,
    /// The largest stresses, where they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<PeakStressDocument>,
}

/// Mean, fluctuation and range of a curve, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Statistics of a curve")]
pub struct StatisticsValues {
    /// The mean.
    pub mean: f64,
    /// The root mean square of the fluctuation, the mean removed.
    pub rms: f64,
    /// The largest less the smallest value.
    pub peak_to_peak: f64,
}

impl StatisticsValues {
    fn of(statistics: &Statistics, convert: impl Fn(f64) -> f64) -> Self {
        Self {
            mean: convert(statistics.mean),
            rms: convert(statistics.rms),
            peak_to_peak: convert(statistics.peak_to_peak),
        }
    }
}
