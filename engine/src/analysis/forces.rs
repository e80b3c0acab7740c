//! The force table of a case, and what its mesh does at speed.

use super::curve::Curve;
use super::estimate::usual_stiffness;
use super::warning::warn_of_motions;
use super::{Analysis, AnalysisError, Case, Faces, OrderKind, StiffnessRule, analyze, expected};
use crate::assembly::Parts;
use crate::dynamics::{FlankRows, ForceTable, Ladder, Resonance, RunUp, RunUpData};
use crate::gear::{GearPair, Member, involute_function};
use crate::run::Run;

/// Harmonics of the mesh that are told at speed.
const MESH_HARMONICS: u32 = 5;

/// Orders that are told at speed, at most, and the least part of the largest static line that one of a sideband or a revolution has.
const TOLD: (usize, f64) = (12, 0.01);

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
/// As for [`analyze`].
pub fn analyze_with_forces(
    case: &Case,
    request: &ForcesRequest,
    parts: &dyn Parts,
    run: &Run,
) -> Result<(Analysis, Forces), AnalysisError> {
    run.expect_whole(expected(case) + table_positions(case, request.table));
    let mut analysis = analyze(case, parts, run)?;
    let table = force_table(case, request.table, parts, run)?;
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

/// Contact solutions that the table needs.
fn table_positions(case: &Case, request: ForceTableRequest) -> u64 {
    let loads = request.ladder(case).loads();
    2 * expected(&rows_case(case, &loads))
}

/// `case` with the loads of a table beside its torques: what both cost together.
pub fn with_table(case: &Case, request: ForceTableRequest) -> Case {
    let mut both = case.clone();
    let rows = rows_case(case, &request.ladder(case).loads());
    for _ in 0..2 * MORE_POSITIONS {
        both.output_torques.extend(&rows.output_torques);
    }
    both
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

/// The other flanks of the case of a table: those of the drawing, without deviations.
///
/// A pair of gears whose teeth are alike to both sides touches on them as its mirror image does on the loaded ones, which passes the same
/// positions the other way round; along faces that is the drawing seen from its other side.
struct OtherFlank {
    /// The case whose curves are those of the mirror image.
    mirrored: Case,
    /// The place of position 0 in its curves.
    zero: i64,
}

impl OtherFlank {
    /// Those of `rows`.
    fn of(rows: &Case) -> Self {
        let pair = rows.pair.as_drawn();
        // The other flank of a tooth passes the pitch point later, by the thickness of the tooth.
        let gear = pair.gear(Member::Driving);
        let half_angle =
            gear.flank().base_half_angle() - involute_function(pair.working_pressure_angle());
        let per_period = f64::from(rows.resolution.positions_per_mesh_period);
        let later = 2.0 * half_angle / gear.pitch_angle() * per_period;
        let faces = rows.faces.clone().map(|faces| Faces {
            pair: faces.pair.as_drawn().turned_over(),
            ..faces
        });
        let mut mirrored = Case {
            pair,
            faces,
            ..rows.clone()
        };
        // So that the positions of the mirror image are those of the table.
        mirrored.resolution.first_position = later.fract() / per_period;
        Self {
            mirrored,
            zero: later.trunc() as i64,
        }
    }

    /// What the other flanks yield at the first `count` positions of the table, of what the mirror image does.
    fn turned(&self, mirrored: &FlankRows, count: usize) -> FlankRows {
        let turned = |rows: &[Vec<f64>], value: &dyn Fn(f64) -> f64| -> Vec<Vec<f64>> {
            let row = |row: &Vec<f64>| {
                (0..count as i64)
                    .map(|i| value(row[(self.zero - i).rem_euclid(row.len() as i64) as usize]))
                    .collect()
            };
            rows.iter().map(row).collect()
        };
        let backlash = self.mirrored.pair.backlash();
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
/// As for [`analyze`].
pub fn force_table(
    case: &Case,
    request: ForceTableRequest,
    parts: &dyn Parts,
    run: &Run,
) -> Result<ForceTable, AnalysisError> {
    let ladder = request.ladder(case);
    let loaded = rows_case(case, &ladder.loads());
    let other = OtherFlank::of(&loaded);
    let rows_of = |case: &Case| -> Result<FlankRows, AnalysisError> {
        let curves = analyze(case, parts, run)?.curves.into_iter();
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
    let mirrored = rows_of(&other.mirrored)?;
    let flanks = [
        rows_of(&loaded)?,
        other.turned(&mirrored, loaded.positions()),
    ];
    Ok(ForceTable::new(case.pair.period(), ladder, flanks))
}

/// The run-up that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct DynamicsRequest {
    /// Speeds of the driving gear in revolutions per second, rising; 0 is the static curve.
    pub speeds: Vec<f64>,
    /// ζ.
    pub damping_ratio: f64,
    /// Polar inertias in kg m², driving and driven; `None` for the gear's own.
    pub inertias: [Option<f64>; 2],
    /// Whether to run up, and whether to run down.
    pub sweeps: [bool; 2],
}

/// What the mesh does at speed under the torque of one curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveDynamics {
    /// m_e in kg.
    pub equivalent_mass: f64,
    /// The speeds, in revolutions per second.
    pub speeds: Vec<f64>,
    /// The motion.
    pub run_up: RunUp,
    /// The labels of the orders that are told.
    pub labels: Vec<String>,
    /// Where they resonate.
    pub resonances: Vec<Resonance>,
}

/// The mass m_e on the line of action: 1/m_e = r_b1²/J_1 + r_b2²/J_2.
pub fn equivalent_mass(case: &Case, inertias: [Option<f64>; 2]) -> f64 {
    let of = |member: Member| {
        let section = case.pair.gear(member);
        let own = || match &case.faces {
            Some(faces) => faces.pair.gear(member).polar_inertia(),
            None => section.polar_inertia(),
        };
        let inertia = inertias[member.index()].unwrap_or_else(own);
        section.base_radius().powi(2) / inertia
    };
    1.0 / (of(Member::Driving) + of(Member::Driven))
}

/// Seconds of one core that the run-ups of `case` take, about: as many as there are torques.
pub fn run_up_seconds(case: &Case, request: &DynamicsRequest) -> f64 {
    let pair = &case.pair;
    let data = RunUpData {
        speeds: request.speeds.clone(),
        tooth_count: pair.driving().tooth_count(),
        load: 0.0,
        mass: equivalent_mass(case, request.inertias),
        damping_ratio: request.damping_ratio,
        stiffness: usual_stiffness(pair),
        orders: Vec::new(),
        sweeps: request.sweeps,
    };
    case.output_torques.len() as f64 * data.seconds(pair.period())
}

/// What the mesh of `table`, which is that of `case`, does at speed under the load of `curve`, which spans whole periods and whose load is not 0.
///
/// # Errors
///
/// [`AnalysisError::Stopped`] if `run` was told to stop.
pub fn dynamics(
    case: &Case,
    curve: &Curve,
    table: &ForceTable,
    request: &DynamicsRequest,
    run: &Run,
) -> Result<CurveDynamics, AnalysisError> {
    let pair = &case.pair;
    let (labels, orders) = told(pair, curve).into_iter().unzip();
    let data = RunUpData {
        speeds: request.speeds.clone(),
        tooth_count: pair.driving().tooth_count(),
        load: curve.load,
        mass: equivalent_mass(case, request.inertias),
        damping_ratio: request.damping_ratio,
        stiffness: curve.mesh_stiffness_tangent_statistics.mean,
        orders,
        sweeps: request.sweeps,
    };
    let mut run_up = data.run_up(table, run)?;
    if data.speeds.first() == Some(&0.0) {
        // The curve as it is told, at its own positions.
        let still = &curve.transmission_error_statistics;
        for branch in [&mut run_up.up, &mut run_up.down].into_iter().flatten() {
            branch.rms[0] = still.rms;
            branch.peak_to_peak[0] = still.peak_to_peak;
        }
    }
    Ok(CurveDynamics {
        equivalent_mass: data.mass,
        speeds: data.speeds.clone(),
        run_up,
        labels,
        resonances: data.resonances(),
    })
}

/// The orders that are told, with their labels and per mesh period: of the mesh, of holes, and of what else stands out.
fn told(pair: &GearPair, curve: &Curve) -> Vec<(String, f64)> {
    let Some(spectrum) = &curve.spectrum else {
        return Vec::new();
    };
    let amplitudes = spectrum.named.iter().map(|line| line.transmission_error);
    let least = TOLD.1 * amplitudes.fold(0.0, f64::max);
    let mut lines: Vec<_> = spectrum
        .named
        .iter()
        .filter(|line| match &line.kind {
            OrderKind::Mesh { harmonic } => *harmonic <= MESH_HARMONICS,
            OrderKind::Cause { cause, multiple: 1 } if cause.holes => true,
            _ => line.transmission_error >= least,
        })
        .collect();
    lines.sort_by(|a, b| b.transmission_error.total_cmp(&a.transmission_error));
    lines.truncate(TOLD.0);
    lines.sort_by(|a, b| a.order.total_cmp(&b.order));
    let per_period = |order: f64| order / f64::from(pair.driven().tooth_count());
    lines
        .into_iter()
        .map(|line| (line.label.clone(), per_period(line.order)))
        .collect()
}
