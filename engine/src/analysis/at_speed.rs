//! What the mesh of a case does at speed.

use super::curve::Curve;
use super::{AnalysisError, Case, OrderKind};
use crate::dynamics::{ForceTable, Resonance, RunUp, RunUpData};
use crate::gear::{GearPair, Member};
use crate::run::Run;

/// Harmonics of the mesh that are told at speed.
const MESH_HARMONICS: u32 = 5;

/// Orders that are told at speed, at most, and the least part of the largest static line that one of a sideband or a revolution has.
const TOLD: (usize, f64) = (12, 0.01);

/// The stiffness of a mesh over E b of its softer gear, about: 0.03 with large holes under a heavy load, 0.04 in the paper's case 2.
const STIFFNESS: f64 = 0.035;

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

/// The mean stiffness of a mesh in N/m, about.
pub(super) fn usual_stiffness(pair: &GearPair) -> f64 {
    let moduli = Member::BOTH.map(|member| pair.gear(member).material().youngs_modulus);
    STIFFNESS * moduli[0].min(moduli[1]) * pair.common_face_width()
}

/// Seconds of one core that the run-ups of `case` take, about: as many as there are torques.
pub(super) fn run_up_seconds(case: &Case, request: &DynamicsRequest) -> f64 {
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
