//! The part of a results document that the table shows, kept beside the document.

use std::collections::BTreeMap;

use meshwright_engine::analysis::mesh_label;
use meshwright_wire::geometry::GearGeometry;
use meshwright_wire::problem::{Code, Problem};
use meshwright_wire::results::{
    CurveDocument, ErrorEstimateDocument, MOST_MESH_ORDERS, Results, StatisticsDocument,
};
use meshwright_wire::units::{rounded, significant};
use meshwright_wire::warning::{GearName, WarningCode};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The part of a results document that a table shows. It is kept beside the document, so that a table of thousands of rows reads kilobytes where the documents
/// have hundreds of megabytes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    #[serde(default)]
    pub(super) method: Option<String>,
    #[serde(default)]
    pub(super) driving: GearSummary,
    #[serde(default)]
    pub(super) driven: GearSummary,
    #[serde(default)]
    pub(super) contact_ratio: Option<f64>,
    #[serde(default)]
    pub(super) backlash_mm: Option<f64>,
    #[serde(default)]
    pub(super) curves: Vec<CurveSummary>,
    /// How the holes of both gears stand best, where they make one order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) hole_phase: Option<HolePhaseSummary>,
    /// Change by a second grid level, if requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    error_estimate: Option<ErrorEstimateDocument>,
    /// The codes of its warnings, each once; none in summaries that versions before 0.6 kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) warnings: Option<Vec<WarningCode>>,
}

/// The mass of a gear, and the share that holes leave of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Gear of a row")]
pub(super) struct GearSummary {
    /// The mass of the true profile, in kg.
    pub mass_kg: Option<f64>,
    /// The share of the blank that the holes remove, in percent.
    pub mass_removed_percent: Option<f64>,
    /// The least material around the holes, in mm; null without holes.
    pub least_ligament_mm: Option<f64>,
    /// The polar moment of inertia of the true profile, in kg m2.
    pub polar_inertia_kg_m2: Option<f64>,
}

/// The best turn of the driving gear's holes against those of the driven one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Phase of the holes of a row")]
pub struct HolePhaseSummary {
    /// The amplitude of the transmission error at the order of the holes with it, in um.
    pub amplitude_um: f64,
    /// The turn, in degrees: what to add to `phase_deg` of the driving gear's holes.
    pub turn_of_driving_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct CurveSummary {
    pub(crate) output_torque_n_m: f64,
    pub(super) statistics: Option<StatisticsDocument>,
    /// The largest contact pressure over the span, in MPa; none where it has no limit somewhere.
    #[serde(default)]
    pub(super) peak_contact_pressure_mpa: Option<f64>,
    /// The share of the span in which it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) pressure_unbounded_share: Option<f64>,
    /// Hertz's pressure at the working pitch point, in MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) pitch_point_pressure_mpa: Option<f64>,
    /// The largest contact pressure away from kinks and sharp corners, in MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) smooth_contact_pressure_mpa: Option<f64>,
    /// The largest peak-to-peak value of the dynamic transmission error over the speeds of a run-up, whichever way it is run through.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) dynamic_peak_to_peak_um: Option<f64>,
    /// K_Hbeta, where the method sees the faces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) face_load_factor: Option<f64>,
    /// Amplitudes of the transmission error, in um, by the names of their orders.
    pub(super) orders: BTreeMap<String, f64>,
    /// Amplitudes of the holes alone, where teeth deviate.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    orders_of_holes: BTreeMap<String, f64>,
}

/// Method and torques: a comparison has a meaning only where they are the same.
pub(super) type Conditions = (Option<String>, Vec<u64>);

/// The names of orders of holes that a table shows.
const ORDERS: [&str; 3] = [HOLE_ORDER, DRIVING_HOLE_ORDER, DRIVEN_HOLE_ORDER];
/// The holes of the only holed gear, or of both if they make the same order.
const HOLE_ORDER: &str = "H_N";
const DRIVING_HOLE_ORDER: &str = "H_N1";
const DRIVEN_HOLE_ORDER: &str = "H_N2";

impl Summary {
    /// That of `results`, in the very numbers that their document has.
    ///
    /// # Errors
    ///
    /// `internal_error` if a number is not finite, which no valid case may come to.
    pub fn of(results: &Results) -> Result<Self, Problem> {
        let Results {
            method,
            pair,
            curves,
            hole_phase,
            evidence,
            warnings,
            ..
        } = results;
        let mut codes: Vec<WarningCode> = Vec::new();
        for warning in warnings {
            if !codes.contains(&warning.code) {
                codes.push(warning.code);
            }
        }
        let exact = Self {
            method: Some(method.to_string()),
            driving: GearSummary::of(&pair.driving),
            driven: GearSummary::of(&pair.driven),
            contact_ratio: Some(pair.contact_ratio),
            backlash_mm: Some(pair.backlash_mm),
            curves: curves.iter().map(CurveSummary::of).collect(),
            hole_phase: hole_phase.as_ref().map(|phase| HolePhaseSummary {
                amplitude_um: phase.amplitude_um,
                turn_of_driving_deg: phase.turn_of_driving_deg,
            }),
            error_estimate: evidence.error_estimate.clone(),
            warnings: Some(codes),
        };
        rounded(&exact).map_err(|error| Problem::new(Code::InternalError, error.to_string()))
    }

    /// The summary in its stored form.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a summary is plain data")
    }
}

impl GearSummary {
    pub(super) fn has_no_holes(&self) -> bool {
        self.least_ligament_mm.is_none()
    }

    fn of(gear: &GearGeometry) -> Self {
        Self {
            mass_kg: Some(gear.mass_kg),
            mass_removed_percent: Some(gear.mass_removed_percent),
            least_ligament_mm: gear.least_ligament_mm,
            polar_inertia_kg_m2: Some(gear.polar_inertia_kg_m2),
        }
    }
}

impl CurveSummary {
    fn of(curve: &CurveDocument) -> Self {
        let pressures = curve.statistics.peak_contact_pressure_mpa.as_ref();
        let branches = curve.dynamics.iter();
        let branches = branches.flat_map(|dynamics| [&dynamics.up, &dynamics.down]);
        let ranges = branches
            .flatten()
            .flat_map(|branch| &branch.dynamic_transmission_error_um.peak_to_peak);
        let named = curve.spectrum.iter().flat_map(|spectrum| &spectrum.named);
        let mesh_orders: Vec<String> = (1..=MOST_MESH_ORDERS).map(mesh_label).collect();
        let shown = named.filter(|line| {
            ORDERS.contains(&line.label.as_str()) || mesh_orders.contains(&line.label)
        });
        let estimated = mesh_orders
            .iter()
            .zip(curve.mesh_orders_um.iter().flatten());
        Self {
            output_torque_n_m: curve.output_torque_n_m,
            statistics: Some(curve.statistics.clone()),
            peak_contact_pressure_mpa: pressures.and_then(|pressures| pressures.largest),
            pressure_unbounded_share: curve.pressure_unbounded_share,
            pitch_point_pressure_mpa: curve.pitch_point_pressure_mpa,
            smooth_contact_pressure_mpa: curve.smooth_contact_pressure_mpa,
            dynamic_peak_to_peak_um: ranges.copied().reduce(f64::max),
            face_load_factor: curve.face.as_ref().map(|face| face.face_load_factor),
            orders_of_holes: shown
                .clone()
                .filter_map(|line| Some((line.label.clone(), line.transmission_error_of_holes_um?)))
                .collect(),
            orders: shown
                .map(|line| (line.label.clone(), line.transmission_error_um))
                .chain(estimated.map(|(name, amplitude)| (name.clone(), *amplitude)))
                .collect(),
        }
    }
}

impl CurveSummary {
    /// The amplitude at the order of the holes; where both gears make an order of their own, that of `gear`.
    pub(super) fn hole_order(&self, gear: GearName) -> Option<f64> {
        of_holes(&self.orders, gear)
    }

    /// The part of the hole order that comes from the holes alone, where teeth deviate.
    pub(super) fn hole_order_of_holes(&self, gear: GearName) -> Option<f64> {
        of_holes(&self.orders_of_holes, gear)
    }

    /// Whether it runs over a part of its true period.
    pub(crate) fn is_partial(&self) -> bool {
        let statistics = self.statistics.as_ref();
        statistics.is_some_and(|statistics| statistics.partial)
    }

    /// The amplitude at the mesh order.
    pub(super) fn mesh_order(&self) -> Option<f64> {
        self.mesh_harmonic(1)
    }

    /// The amplitude at this multiple of the mesh order, from 1 to 10.
    pub(super) fn mesh_harmonic(&self, harmonic: u32) -> Option<f64> {
        self.orders.get(&mesh_label(harmonic)).copied()
    }
}

/// The amplitude at the order of the holes; where both gears make an order of their own, that of `gear`.
fn of_holes(orders: &BTreeMap<String, f64>, gear: GearName) -> Option<f64> {
    let own = match gear {
        GearName::Driving => DRIVING_HOLE_ORDER,
        GearName::Driven => DRIVEN_HOLE_ORDER,
    };
    orders.get(HOLE_ORDER).or_else(|| orders.get(own)).copied()
}

impl Summary {
    /// Its curves, one for each torque.
    pub(crate) fn curves(&self) -> &[CurveSummary] {
        &self.curves
    }

    /// Change by a second grid level, if requested.
    pub(crate) fn error_estimate(&self) -> Option<ErrorEstimateDocument> {
        self.error_estimate.clone()
    }

    pub(super) fn pair_mass(&self) -> Option<f64> {
        let sum = self.driving.mass_kg? + self.driven.mass_kg?;
        Some(significant(sum, 10))
    }

    /// The values that designs are compared by, each the less the better; `None` if a number is missing.
    pub(super) fn objectives(&self) -> Option<[f64; 3]> {
        let mut worst_range = f64::NEG_INFINITY;
        let mut stiffness = 0.0;
        for curve in &self.curves {
            let statistics = curve.statistics.as_ref()?;
            worst_range = worst_range.max(statistics.transmission_error_um.peak_to_peak);
            stiffness += statistics.mesh_stiffness_tangent_n_per_m.mean;
        }
        if self.curves.is_empty() {
            return None;
        }
        let objectives = [
            self.pair_mass()?,
            worst_range,
            -stiffness / self.curves.len() as f64,
        ];
        // Six digits: differences beyond them, as in the masses of a study of constant mass, are rounding and no merit.
        Some(objectives.map(|objective| significant(objective, 6)))
    }

    pub(super) fn conditions(&self) -> Conditions {
        let mut torques: Vec<u64> = self
            .curves
            .iter()
            .map(|curve| curve.output_torque_n_m.to_bits())
            .collect();
        torques.sort_unstable();
        (self.method.clone(), torques)
    }
}
