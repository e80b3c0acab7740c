//! The force table of a case, by its own method, and its further results.

use super::analyze::{answered, carried_out};
use super::at_speed::{CurveDynamics, DynamicsRequest, dynamics};
use super::case::Model;
use super::curve::Curve;
use super::plan::Plan;
use super::rotors::Blanks;
use super::warning::warn_of_motions;
use super::{Analysis, AnalysisError, Case, StiffnessRule};
use crate::assembly::Parts;
use crate::dynamics::{FlankRows, ForceTable, LoadSteps};
use crate::run::Run;

/// How many times as many positions a table has as the curves: pairs that begin and cease to carry make kinks, and two of them in
/// neighboring cells are one too many.
pub const MORE_POSITIONS: u32 = 2;

/// The force table that is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceTableRequest {
    /// The number of loads, 0 among them.
    pub loads: u32,
    /// The largest output torque in N m; `None` for twice the largest of the case.
    pub largest_output_torque: Option<f64>,
}

impl ForceTableRequest {
    fn ladder(&self, case: &Case) -> LoadSteps {
        LoadSteps {
            count: self.loads as usize,
            largest: case.pair.load(self.largest(case)),
        }
    }

    fn largest(&self, case: &Case) -> f64 {
        let torques = case.output_torques.iter().copied();
        self.largest_output_torque
            .unwrap_or_else(|| 2.0 * torques.fold(0.0, f64::max))
    }
}

/// Requests beside the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcesRequest {
    /// The table.
    pub table: ForceTableRequest,
    /// The run-up under each torque, none of which is 0 then.
    pub dynamics: Option<DynamicsRequest>,
}

/// Results beside the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces {
    /// The table.
    pub table: ForceTable,
    /// Motion at speed, one entry a curve, if requested.
    pub dynamics: Vec<CurveDynamics>,
}

/// Computes `case`, whose span is whole true periods, and its forces.
///
/// # Errors
///
/// As for [`analyze`](super::analyze()).
pub fn analyze_with_forces(
    case: &Case,
    request: &ForcesRequest,
    parts: &dyn Parts,
    run: &Run,
) -> Result<(Analysis, Forces), AnalysisError> {
    let (plan, table) = (Plan::of(case), TablePlan::of(case, request.table));
    run.expect(plan.solutions() + table.solutions());
    let mut analysis = answered(&plan, parts, run)?;
    let table = table.table(parts, run)?;
    let curves = request.dynamics.iter().flat_map(|dynamics| {
        let curves = analysis.curves.iter();
        curves.map(move |curve| (dynamics, curve))
    });
    let blanks = match &request.dynamics {
        Some(dynamics) => Blanks::of(case, dynamics.highest_wave(case), parts, run)?,
        None => Blanks::default(),
    };
    let dynamics = curves
        .map(|(request, curve)| dynamics(case, curve, &table, (request, &blanks), run))
        .collect::<Result<Vec<_>, _>>()?;
    let driven = case.pair.driven().base_radius();
    warn_of_motions(&mut analysis.warnings, &dynamics, (&table, driven));
    Ok((analysis, Forces { table, dynamics }))
}

/// Plan of a table.
pub(super) struct TablePlan {
    loads: Vec<f64>,
    /// Its rows.
    rows: Plan,
    /// The rows of the other flanks.
    other: OtherFlank,
}

impl TablePlan {
    pub(super) fn of(case: &Case, request: ForceTableRequest) -> Self {
        let loads = request.ladder(case).loads();
        let rows = rows_case(case, &loads);
        Self {
            loads,
            other: OtherFlank::of(&rows),
            rows: Plan::of_rows(&rows),
        }
    }

    pub(super) fn plans(&self) -> [&Plan; 2] {
        [&self.rows, &self.other.mirrored]
    }

    fn solutions(&self) -> u64 {
        self.plans().into_iter().map(Plan::solutions).sum()
    }

    fn table(self, parts: &dyn Parts, run: &Run) -> Result<ForceTable, AnalysisError> {
        let rows_of = |plan: &Plan| -> Result<FlankRows, AnalysisError> {
            let curves = carried_out(plan, parts, run)?.curves.into_iter();
            let compliance = |curve: &Curve| -> Vec<f64> {
                let stiffness = curve.mesh_stiffness_tangent.iter();
                // Without load there is none, and nobody looks at it.
                stiffness
                    .map(|k| if *k > 0.0 { 1.0 / k } else { 0.0 })
                    .collect()
            };
            let rows = curves.map(|curve| (curve.transmission_error.clone(), compliance(&curve)));
            let (delta, compliance) = rows.unzip();
            Ok(FlankRows {
                delta,
                compliance: Some(compliance),
            })
        };
        let case = &self.rows.case;
        let [loaded, mirrored] = self.plans().map(rows_of);
        let flanks = [loaded?, self.other.turned(&mirrored?, case.positions())];
        Ok(ForceTable::new(case.pair.period(), self.loads, flanks)?)
    }
}

/// The case whose curves are the rows of the table.
fn rows_case(case: &Case, loads: &[f64]) -> Case {
    let mut rows = Case {
        output_torques: loads
            .iter()
            .map(|load| load * case.pair.driven().base_radius())
            .collect(),
        stress: false,
        windows: Vec::new(),
        driving_speed: None,
        running: None,
        ..case.clone()
    };
    rows.resolution.positions_per_mesh_period *= MORE_POSITIONS;
    rows.resolution.span_mesh_periods = None;
    rows.resolution.error_estimate = false;
    rows.resolution.stiffness = StiffnessRule::Tangent;
    if let Model::Faces(faces, _) = &mut rows.model {
        faces.cure = false;
    }
    rows
}

/// The other flanks of the case of a table.
///
/// A pair of gears touches on them as its mirror image does on the loaded ones, which passes the same positions the other way round; along faces that
/// is the pair seen from its other side. Pitch deviations and eccentricities move both flanks; slopes are those of the loaded ones alone.
struct OtherFlank {
    /// The curves of the mirror image.
    mirrored: Plan,
    /// The place of position 0 in its curves.
    zero: i64,
}

impl OtherFlank {
    /// The plan of `rows`.
    fn of(rows: &Case) -> Self {
        let pair = rows.pair.mirror_image();
        let per_period = f64::from(rows.resolution.positions_per_mesh_period);
        let later = pair.other_flanks_later() * per_period;
        let mut mirrored = Case {
            pair,
            ..rows.clone()
        };
        if let Model::Faces(faces, _) = &mut mirrored.model {
            faces.pair = faces.pair.turned_over();
        }
        // The positions of the mirror image are then those of the table.
        mirrored.resolution.first_position = later.fract() / per_period;
        Self {
            mirrored: Plan::of_rows(&mirrored),
            zero: later.trunc() as i64,
        }
    }

    /// Compliance of the other flanks at the first `count` positions of the table, from those of the mirror image.
    fn turned(&self, mirrored: &FlankRows, count: usize) -> FlankRows {
        let turned = |rows: &[Vec<f64>], value: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            let row = |row: &Vec<f64>| {
                (0..count as i64)
                    .map(|i| value(row[(self.zero - i).rem_euclid(row.len() as i64) as usize]))
                    .collect()
            };
            rows.iter().map(row).collect()
        };
        let backlash = self.mirrored.case.pair.backlash();
        let compliance = mirrored.compliance.as_ref();
        FlankRows {
            delta: turned(&mirrored.delta, &|delta| -backlash - delta),
            compliance: compliance.map(|rows| turned(rows, &|compliance| compliance)),
        }
    }
}

/// F(θ, δ) of `case` over its true period, by its method.
///
/// # Errors
///
/// As for [`analyze`](super::analyze()).
pub fn force_table(
    case: &Case,
    request: ForceTableRequest,
    parts: &dyn Parts,
    run: &Run,
) -> Result<ForceTable, AnalysisError> {
    let plan = TablePlan::of(case, request);
    run.expect(plan.solutions());
    plan.table(parts, run)
}
