//! A row of the table: a design, its outcome, and the quantities that designs are compared by.

use meshwright_engine::analysis::Method;
use meshwright_wire::Status;
use meshwright_wire::declare::{Kind as _, utoipa_schema, word};
use meshwright_wire::problem::Problem;
use meshwright_wire::results::StatisticsDocument;
use meshwright_wire::warning::{GearName, WarningCode};
use serde::Serialize;
use serde_json::{Map, Value, json};
use utoipa::ToSchema;
use uuid::Uuid;

use super::quantity::{Of, Quantity};
use super::summary::{CurveSummary, HolePhaseSummary, Summary};

/// A design and its outcome so far.
#[derive(Debug, Clone, PartialEq)]
pub struct RowState {
    /// Label of the design.
    pub label: String,
    /// Its changes of the base.
    pub changes: Map<String, Value>,
    /// The job that computes it, if it could be built.
    pub job: Option<Uuid>,
    /// Where it stands.
    pub status: Status,
    /// The summary of its results, once there are some.
    pub summary: Option<Summary>,
    /// Why it has no results.
    pub problem: Option<Value>,
}

impl RowState {
    /// A design with these changes that has been computed without a job, and its outcome.
    #[cfg(test)]
    pub(crate) fn computed(
        label: String,
        changes: Map<String, Value>,
        outcome: Result<Summary, Problem>,
    ) -> Self {
        let (status, summary, problem) = match outcome {
            Ok(summary) => (Status::Successful, Some(summary), None),
            Err(problem) => {
                let problem = serde_json::to_value(problem).expect("a problem is plain data");
                (Status::Failed, None, Some(problem))
            }
        };
        Self {
            label,
            changes,
            job: None,
            status,
            summary,
            problem,
        }
    }
}

/// A design, and the numbers that designs are compared by.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Row")]
pub struct TableRow {
    /// Label of the design.
    pub label: String,
    /// Its changes of the base: JSON pointers and values, the hole radius among them where the study sets it.
    #[schema(value_type = Object)]
    pub changes: Map<String, Value>,
    /// The job that computes it; null for a design that could not be built.
    pub job: Option<Uuid>,
    /// Where it stands.
    pub status: Status,
    /// The method that computed it; null until then.
    #[schema(schema_with = method_once_computed)]
    pub method: Option<String>,
    /// The mass of the study's gear, in kg.
    pub mass_kg: Option<f64>,
    /// The share of its blank that the holes remove, in percent.
    pub mass_removed_percent: Option<f64>,
    /// The least material around its holes, in mm; null without holes.
    pub least_ligament_mm: Option<f64>,
    /// Its polar moment of inertia, in kg m2.
    pub polar_inertia_kg_m2: Option<f64>,
    /// The mass of both gears, in kg.
    pub pair_mass_kg: Option<f64>,
    /// The contact ratio, as in the results.
    pub contact_ratio: Option<f64>,
    /// The backlash, in mm, as in the results.
    pub backlash_mm: Option<f64>,
    /// How the holes of both gears stand best; absent where they do not make one order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hole_phase: Option<HolePhaseSummary>,
    /// True if no other design of the study is at least as good in everything and better in one quantity, among those that were computed by the same method at
    /// the same torques so far. The quantities are the mass of both gears (less is better), the largest peak-to-peak transmission error over the torques
    /// (less), and the mean tangent stiffness, averaged over the torques (more), each to six significant digits.
    pub pareto: bool,
    /// One entry for each output torque.
    pub curves: Vec<RowCurve>,
    /// The codes of the warnings of its results, each once; absent until then, and in results of versions before 0.6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warnings: Option<Vec<WarningCode>>,
    /// Why the design has no results; its pointers lead into the design's submission.
    #[schema(value_type = Option<Problem>)]
    pub problem: Option<Value>,
    /// The study's gear, and the outcome of the design.
    #[serde(skip)]
    #[schema(ignore)]
    known: (GearName, Summary),
}

fn method_once_computed() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
    let method = Method::describe("How the curves are computed.", &word("Method"));
    let about = "The method that computed it; null until then.";
    utoipa_schema(json!({ "description": about, "oneOf": [{ "type": "null" }, method] }))
}

/// The numbers of one design at one torque.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Curve of a row")]
pub struct RowCurve {
    /// The output torque on the driven gear, in N m.
    pub output_torque_n_m: f64,
    /// Statistics over the span, as in the results.
    pub statistics: Option<StatisticsDocument>,
    /// The amplitude of the transmission error at the order of the holes, H_N, in um. Where the holes of both gears make
    /// different orders it is that of the study's gear. Null without holes or spectrum.
    pub hole_order_um: Option<f64>,
    /// The part of it that comes from the holes alone, in um: where teeth deviate, pitch errors and runout have a part in that order too. Absent where none
    /// deviate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hole_order_of_holes_um: Option<f64>,
    /// The amplitude of the transmission error at the mesh order, H_Z2, in um; null without spectrum.
    pub mesh_order_um: Option<f64>,
    /// The amplitudes at the mesh harmonics.
    #[serde(flatten)]
    pub mesh_orders: RowMeshOrders,
    /// K_Hbeta, the load of the heaviest of ten strips of the face over the mean; absent for methods that do not see the face, and at torque 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face_load_factor: Option<f64>,
    /// The largest contact pressure over the span, in MPa; absent where it has no limit somewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_contact_pressure_mpa: Option<f64>,
    /// The share of the span, from 0 to 1, in which a sharp corner carries, at which pressure has no limit; absent in results of versions before 0.6.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_unbounded_share: Option<f64>,
    /// Hertz's pressure at the working pitch point under the whole load, in MPa; absent where the pitch point lies outside the path of contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pitch_point_pressure_mpa: Option<f64>,
    /// The largest contact pressure away from kinks and sharp corners, in MPa; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth_contact_pressure_mpa: Option<f64>,
    /// Results of a run-up; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamic_transmission_error_um: Option<RowDynamics>,
}

/// Declares the mesh harmonics of a row.
macro_rules! mesh_orders {
    ($($name:ident: $harmonic:literal,)*) => {
        /// Amplitudes of the transmission error at the mesh harmonics, in um; absent without spectrum, and where the positions do not show them.
        #[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
        #[schema(title = "Mesh harmonics of a row")]
        pub struct RowMeshOrders {
            $(
                #[doc = concat!("The amplitude at mesh harmonic ", $harmonic, ", in um.")]
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $name: Option<f64>,
            )*
        }

        impl RowMeshOrders {
            fn of(curve: &CurveSummary) -> Self {
                Self {
                    $($name: curve.mesh_harmonic($harmonic),)*
                }
            }
        }
    };
}

mesh_orders! {
    mesh_order_1_um: 1,
    mesh_order_2_um: 2,
    mesh_order_3_um: 3,
    mesh_order_4_um: 4,
    mesh_order_5_um: 5,
    mesh_order_6_um: 6,
    mesh_order_7_um: 7,
    mesh_order_8_um: 8,
    mesh_order_9_um: 9,
    mesh_order_10_um: 10,
}

/// Results of a design's run-up at one torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
#[schema(title = "Run-up of a row")]
pub struct RowDynamics {
    /// The largest peak-to-peak value of the dynamic transmission error over the speeds, whichever way they are run through, in um.
    pub peak_to_peak: f64,
}

impl TableRow {
    /// The row of a design, `gear` being the study's and `pareto` whether it is one of the best.
    pub fn new(gear: GearName, state: RowState, pareto: bool) -> Self {
        let known = (gear, state.summary.clone().unwrap_or_default());
        let summary = state.summary.unwrap_or_default();
        let own = match gear {
            GearName::Driving => summary.driving,
            GearName::Driven => summary.driven,
        };
        Self {
            label: state.label,
            changes: state.changes,
            job: state.job,
            status: state.status,
            pair_mass_kg: summary.pair_mass(),
            contact_ratio: summary.contact_ratio,
            backlash_mm: summary.backlash_mm,
            method: summary.method,
            mass_kg: own.mass_kg,
            mass_removed_percent: own.mass_removed_percent,
            least_ligament_mm: own.least_ligament_mm,
            polar_inertia_kg_m2: own.polar_inertia_kg_m2,
            hole_phase: summary.hole_phase,
            pareto,
            curves: summary
                .curves
                .into_iter()
                .map(|curve| RowCurve::of(gear, curve))
                .collect(),
            warnings: summary.warnings,
            problem: state.problem,
            known,
        }
    }

    /// The study's gear.
    pub(super) fn gear(&self) -> GearName {
        self.known.0
    }

    pub(super) fn summary(&self) -> &Summary {
        &self.known.1
    }

    /// The quantity of this name at each of its torques.
    pub fn numbers(&self, name: &str) -> Vec<Option<f64>> {
        let quantity = Quantity::of_name(name);
        let curves = self.summary().curves().iter();
        curves
            .map(|curve| self.number(quantity?, Some(curve)))
            .collect()
    }

    /// A number of it, of the given one of its curves if it is told of curves.
    pub(super) fn number(&self, quantity: &Quantity, curve: Option<&CurveSummary>) -> Option<f64> {
        match quantity.of {
            Of::Pair(of) => of(self.summary()),
            Of::Curve(of) => of(curve?, self.gear()),
        }
    }
}

impl RowCurve {
    fn of(gear: GearName, curve: CurveSummary) -> Self {
        Self {
            hole_order_um: curve.hole_order(gear),
            hole_order_of_holes_um: curve.hole_order_of_holes(gear),
            mesh_order_um: curve.mesh_order(),
            mesh_orders: RowMeshOrders::of(&curve),
            output_torque_n_m: curve.output_torque_n_m,
            face_load_factor: curve.face_load_factor,
            peak_contact_pressure_mpa: curve.peak_contact_pressure_mpa,
            pressure_unbounded_share: curve.pressure_unbounded_share,
            pitch_point_pressure_mpa: curve.pitch_point_pressure_mpa,
            smooth_contact_pressure_mpa: curve.smooth_contact_pressure_mpa,
            dynamic_transmission_error_um: curve
                .dynamic_peak_to_peak_um
                .map(|peak_to_peak| RowDynamics { peak_to_peak }),
            statistics: curve.statistics,
        }
    }
}
