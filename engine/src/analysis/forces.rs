//! The force table of a case, by its own method, and what is answered with it.

use super::analyze::carried_out;
use super::at_speed::{CurveDynamics, DynamicsRequest, dynamics};
use super::curve::Curve;
use super::plan::Plan;
use super::warning::warn_of_motions;
use super::{Analysis, AnalysisError, Case, Faces, StiffnessRule};
use crate::assembly::Parts;
use crate::dynamics::table::between_closed;
use crate::dynamics::{ForceTable, Ladder};
use crate::gear::{Member, involute_function};
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
    fn ladder(&self, case: &Case) -> Ladder {
        Ladder {
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

/// What is asked beside the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcesRequest {
    /// The table.
    pub table: ForceTableRequest,
    /// The run-up under each torque, none of which is 0 then.
    pub dynamics: Option<DynamicsRequest>,
}

/// What is answered beside the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Forces {
    /// The table.
    pub table: ForceTable,
    /// What the mesh does at speed, one entry a curve, where it was asked for.
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
    let mut analysis = carried_out(&plan, parts, run)?;
    let table = table.table(parts, run)?;
    let curves = request.dynamics.iter().flat_map(|dynamics| {
        let curves = analysis.curves.iter();
        curves.map(move |curve| (dynamics, curve))
    });
    let dynamics = curves
        .map(|(request, curve)| dynamics(case, curve, &table, request, run))
        .collect::<Result<Vec<_>, _>>()?;
    warn_of_motions(&mut analysis.warnings, &dynamics);
    Ok((analysis, Forces { table, dynamics }))
}

/// What is computed of a table.
pub(super) struct TablePlan {
    ladder: Ladder,
    /// Its rows.
    rows: Plan,
    /// The rows of the other flanks, where those are others.
    other: Option<Plan>,
}

impl TablePlan {
    pub(super) fn of(case: &Case, request: ForceTableRequest) -> Self {
        let ladder = request.ladder(case);
        let rows = rows_case(case, &ladder.loads());
        let other = of_other_flank(&rows);
        Self {
            ladder,
            other: (other != rows).then(|| Plan::of(&other)),
            rows: Plan::of(&rows),
        }
    }

    pub(super) fn plans(&self) -> impl Iterator<Item = &Plan> {
        std::iter::once(&self.rows).chain(&self.other)
    }

    fn solutions(&self) -> u64 {
        self.plans().map(Plan::solutions).sum()
    }

    fn table(self, parts: &dyn Parts, run: &Run) -> Result<ForceTable, AnalysisError> {
        let rows_of = |plan: &Plan| -> Result<(Vec<_>, Vec<_>), AnalysisError> {
            let curves = carried_out(plan, parts, run)?.curves.into_iter();
            let compliance = |curve: &Curve| -> Vec<f64> {
                let stiffness = curve.mesh_stiffness_tangent.iter();
                // Without load there is none, and nobody looks at it.
                stiffness
                    .map(|k| if *k > 0.0 { 1.0 / k } else { 0.0 })
                    .collect()
            };
            let rows = curves.map(|curve| (curve.transmission_error.clone(), compliance(&curve)));
            Ok(rows.unzip())
        };
        let case = &self.rows.asked;
        let (rows, compliance) = rows_of(&self.rows)?;
        let other = match &self.other {
            None => of_mirror(case, &rows),
            Some(other) => of_mirror(case, &rows_of(other)?.0),
        };
        let table = ForceTable::new(case.pair.period(), self.ladder, rows, other);
        Ok(table.with_compliance(compliance))
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
        driving_speed: None,
        ..case.clone()
    };
    rows.resolution.positions_per_mesh_period *= MORE_POSITIONS;
    rows.resolution.span_mesh_periods = None;
    rows.resolution.error_estimate = false;
    rows.resolution.stiffness = StiffnessRule::Tangent;
    if let Some(faces) = &mut rows.faces {
        faces.cure = false;
    }
    rows
}

/// The case whose rows are those of the other flanks of `rows`, passed the other way round: the drawing, and along faces the drawing seen
/// from its other side.
fn of_other_flank(rows: &Case) -> Case {
    let faces = rows.faces.clone().map(|faces| Faces {
        pair: faces.pair.as_drawn().turned_over(),
        ..faces
    });
    Case {
        pair: rows.pair.as_drawn(),
        faces,
        ..rows.clone()
    }
}

/// F(θ, δ) of `case` over its true period, by its method.
///
/// The other flanks are those of the drawing, without deviations: a pair of gears whose teeth are alike to both sides touches on them as its
/// mirror image does on the loaded ones, which passes the same positions the other way round.
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

/// δ of the other flank at the positions of the table that is made of `case`, from the `rows` of its mirror image.
fn of_mirror(case: &Case, rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pair = &case.pair;
    let per_period = f64::from(case.resolution.positions_per_mesh_period);
    let count = pair.period() as usize * case.resolution.positions_per_mesh_period as usize;
    // The other flank of a tooth passes the pitch point later, by the thickness of the tooth.
    let gear = pair.gear(Member::Driving);
    let half_angle =
        gear.flank().base_half_angle() - involute_function(pair.working_pressure_angle());
    let later = 2.0 * half_angle / gear.pitch_angle();
    let backlash = pair.backlash();
    let mirrored = |row: &Vec<f64>| -> Vec<f64> {
        (0..count)
            .map(|i| -backlash - between_closed(row, later * per_period - i as f64))
            .collect()
    };
    rows.iter().map(mirrored).collect()
}
