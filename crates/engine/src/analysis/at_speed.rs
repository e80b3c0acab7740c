//! Motion of a case's mesh at speed.

use std::f64::consts::PI;

use super::blank_modes::blank_modes_estimate;
use super::cost::Estimate;
use super::curve::Curve;
use super::orders::Orders;
use super::rotors::{self, Blanks};
use super::{AnalysisError, Case, OrderKind};
use crate::dynamics::mount::Rows;
use crate::dynamics::{
    Body, BodyWave, Coupled, Damping, ForceTable, Mount, Order, Resonance, RunUp, RunUpData,
};
use crate::gear::{GearPair, Member};
use crate::run::Run;

/// Orders of a pair in its results, at most, for each mesh period of its true period: speeds are as many fewer as that is longer, so that this bounds the
/// results of a run-up. Those that are known are never more.
const ORDERS_A_PERIOD: usize = 12;

/// Modes of a gear body, at most.
pub const MOST_MODES: usize = 8;

/// The part of the yield of a mesh by which a mode yields at least to be taken in. At its resonance it adds this over twice its damping ratio.
const LEAST_YIELD: f64 = 1e-5;

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
    /// The number of modes of each gear body; `None` for as many as lie below twice the highest mesh frequency, and at least one in torsion.
    pub blank_modes: Option<u32>,
    /// True if the modes are those in the plane, and out of it along faces, beside those in torsion. Of more than there may be, those by which the body yields
    /// most to the mesh are taken in.
    pub all_directions: bool,
    /// ζ of these modes, and of the gears on their shafts and supports.
    pub blank_damping_ratio: f64,
    /// Supports of the driving and the driven hub.
    pub mounts: [MountRequest; 2],
    /// Directions: run-up, and run-down.
    pub sweeps: [bool; 2],
}

impl DynamicsRequest {
    /// The circular frequency up to which bodies have modes where no number is asked for: twice that of the mesh at the highest speed.
    fn highest_mode(&self, case: &Case) -> f64 {
        let fastest = self.speeds.last().copied().unwrap_or(0.0);
        4.0 * PI * fastest * f64::from(case.pair.driving().tooth_count())
    }

    /// The circular frequency up to which modes other than in torsion are a part of the run-up of `case`, if they are.
    pub fn highest_wave(&self, case: &Case) -> Option<f64> {
        let highest = self.highest_mode(case);
        let is_asked = self.all_directions && self.blank_modes != Some(0) && highest > 0.0;
        let has_modes = |member: &Member| self.has_modes(case, *member);
        (is_asked && Member::BOTH.iter().any(has_modes)).then_some(highest)
    }

    fn has_modes(&self, case: &Case, member: Member) -> bool {
        rotors::has_modes(case, member, self.inertias[member.index()])
    }
}

/// Shaft and support of a hub.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MountRequest {
    /// The torsional stiffness in N m/rad of the shaft between the hub and a far end that turns evenly; without it the torque at the hub does not change.
    pub shaft: Option<f64>,
    /// The stiffness of the support in N/m, N and N m to motions along x, y, z and about them, x towards the mate and z along the axis, about the middle of the
    /// face; without it the axis stands still.
    pub support: Option<Rows>,
}

/// Motion at speed under the torque of one curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveDynamics {
    /// m_e in kg.
    pub equivalent_mass: f64,
    /// The speeds, in revolutions per second.
    pub speeds: Vec<f64>,
    /// The motion.
    pub run_up: RunUp,
    /// The labels of the orders whose amplitudes are known.
    pub labels: Vec<String>,
    /// These orders per revolution of the driven gear.
    pub orders: Vec<f64>,
    /// The resonances, the largest amplitude first.
    pub resonances: Vec<NamedResonance>,
    /// The lowest natural frequency in Hz with the inertia of rims and teeth outside their webs, where the motion has it on the hubs.
    pub natural_frequency_of_rims: Option<f64>,
}

/// A resonance with the name of its order.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedResonance {
    /// The name.
    pub label: String,
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// Place, amplitude and cause.
    pub resonance: Resonance,
}

/// The mass m_e on the line of action: 1/m_e = r_b1²/J_1 + r_b2²/J_2.
pub fn equivalent_mass(case: &Case, inertias: [Option<f64>; 2]) -> f64 {
    let of = |member: Member| {
        let inertia = inertias[member.index()].unwrap_or_else(|| rotors::own_inertia(case, member));
        case.pair.gear(member).base_radius().powi(2) / inertia
    };
    1.0 / (of(Member::Driving) + of(Member::Driven))
}

/// The bodies of `case` with at most the given number of modes, of those up to twice the highest mesh frequency where nothing is said.
fn bodies(
    case: &Case,
    request: &DynamicsRequest,
    (modes, blanks): (Option<u32>, &Blanks),
) -> [Body; 2] {
    let limits = match modes {
        Some(count) => (f64::INFINITY, count as usize),
        None => (request.highest_mode(case), MOST_MODES),
    };
    let least = LEAST_YIELD / usual_stiffness(&case.pair);
    Member::BOTH.map(|member| {
        let inertia = request.inertias[member.index()];
        let MountRequest { shaft, support } = request.mounts[member.index()];
        let mount = Mount {
            shaft: shaft.unwrap_or(0.0),
            support: support.map(|rows| rotors::support(case, member, &rows)),
        };
        let twist = blanks.twists[member.index()];
        let mut body = rotors::body(case, member, inertia, twist, limits, mount);
        if request.has_modes(case, member) {
            body.add_waves(&blanks.waves[member.index()], (least, limits.1));
        }
        body
    })
}

/// The lowest natural frequency in Hz of the bodies of `case` with their modes, where none are asked for, on a mesh whose mean stiffness is `stiffness` with the
/// bores held.
fn natural_frequency_of_rims(
    case: &Case,
    request: &DynamicsRequest,
    blanks: &Blanks,
    stiffness: f64,
) -> Option<f64> {
    if request.blank_modes != Some(0) {
        return None;
    }
    let bodies = bodies(case, request, (Some(MOST_MODES as u32), blanks));
    let yields: f64 = bodies.iter().map(Body::compliance).sum();
    let teeth = 1.0 / stiffness - yields;
    let undamped = Damping {
        mesh: 0.0,
        bodies: 0.0,
    };
    let coupled = (teeth > 0.0).then(|| Coupled::new(&bodies, 1.0 / teeth, undamped));
    coupled??.natural_frequencies().first().copied()
}

/// The mean stiffness of a mesh in N/m, about.
pub(super) fn usual_stiffness(pair: &GearPair) -> f64 {
    let moduli = Member::BOTH.map(|member| pair.gear(member).material().youngs_modulus);
    STIFFNESS * moduli[0].min(moduli[1]) * pair.common_face_width()
}

/// Seconds of one core that the run-ups of `case` take, about, as many as there are torques, and the bytes.
pub(super) fn run_up_cost(case: &Case, request: &DynamicsRequest) -> (f64, u64) {
    let pair = &case.pair;
    let mut blanks = Blanks::default();
    let mut found = Estimate::default();
    if let Some(frequency) = request.highest_wave(case) {
        // Nobody knows yet how many there are: as many as there may be, which yield hardly more than they have to.
        let wave = BodyWave {
            frequency,
            at_mesh: frequency * (2.0 * LEAST_YIELD / usual_stiffness(pair)).sqrt(),
            diameters: 1,
            split: 1.0,
        };
        let most = request
            .blank_modes
            .map_or(MOST_MODES, |count| count as usize);
        blanks.waves = [(); 2].map(|()| vec![wave; most.saturating_sub(1)]);
        found = blank_modes_estimate(case);
    }
    let orders = known(pair).into_iter().map(|(_, order)| order).collect();
    let data = data(case, request, &blanks, (0.0, usual_stiffness(pair)), orders);
    let seconds = case.output_torques.len() as f64 * data.seconds(pair.period());
    (
        found.seconds + seconds,
        found.memory.max(data.memory(pair.period())),
    )
}

/// The parameters of a run-up of `case` under a load, with a mean stiffness of the mesh.
fn data(
    case: &Case,
    request: &DynamicsRequest,
    blanks: &Blanks,
    (load, stiffness): (f64, f64),
    orders: Vec<f64>,
) -> RunUpData {
    RunUpData {
        speeds: request.speeds.clone(),
        tooth_count: case.pair.driving().tooth_count(),
        load,
        mass: equivalent_mass(case, request.inertias),
        bodies: bodies(case, request, (request.blank_modes, blanks)),
        damping_ratio: request.damping_ratio,
        body_damping_ratio: request.blank_damping_ratio,
        stiffness,
        orders,
        most_orders: most_orders(&case.pair),
        sweeps: request.sweeps,
    }
}

/// The motion at speed in the mesh of `table`, which is that of `case`, under the load of `curve`, which spans whole periods and whose load is not 0.
/// The gears have these `blanks`.
///
/// # Errors
///
/// [`AnalysisError::Stopped`] if `run` was stopped.
pub fn dynamics(
    case: &Case,
    curve: &Curve,
    table: &ForceTable,
    (request, blanks): (&DynamicsRequest, &Blanks),
    run: &Run,
) -> Result<CurveDynamics, AnalysisError> {
    let pair = &case.pair;
    let orders = orders_at_speed(pair, curve);
    let orders = orders.into_iter().map(|(_, order)| order).collect();
    let stiffness = curve.mesh_stiffness_tangent_statistics.mean;
    let data = data(case, request, blanks, (curve.load, stiffness), orders);
    let mut run_up = data.run_up(table, run)?;
    if data.speeds.first() == Some(&0.0) {
        // The curve as it stands in the results, at its own positions.
        let still = &curve.transmission_error_statistics;
        for branch in [&mut run_up.up, &mut run_up.down].into_iter().flatten() {
            branch.rms[0] = still.rms;
            branch.peak_to_peak[0] = still.peak_to_peak;
        }
    }
    let names = Orders::of(pair);
    let order_of = |order: Order| {
        let mesh = f64::from(pair.driven().tooth_count());
        order.per_true_period() * mesh / f64::from(pair.period())
    };
    let name = |order: Order| names.name(order_of(order), order.periods());
    let resonances = run_up.resonances.iter();
    let resonances = resonances.map(|resonance| NamedResonance {
        label: name(resonance.order),
        order: order_of(resonance.order),
        resonance: *resonance,
    });
    Ok(CurveDynamics {
        labels: run_up.orders.iter().map(|order| name(*order)).collect(),
        orders: run_up.orders.iter().map(|order| order_of(*order)).collect(),
        resonances: resonances.collect(),
        equivalent_mass: data.mass,
        speeds: data.speeds.clone(),
        run_up,
        natural_frequency_of_rims: natural_frequency_of_rims(case, request, blanks, data.stiffness),
    })
}

/// The orders of `pair` that are given whatever their amplitude, with their labels and per mesh period, rising: of the mesh to the tenth, of holes, of the
/// first revolutions of gears that deviate, and the sidebands of both.
fn known(pair: &GearPair) -> Vec<(String, f64)> {
    let known = Orders::of(pair).known().into_iter();
    known
        .map(|known| (known.label, per_mesh_period(pair, known.order)))
        .collect()
}

/// The number of orders in the results, at most.
fn most_orders(pair: &GearPair) -> usize {
    ORDERS_A_PERIOD * pair.period() as usize
}

fn per_mesh_period(pair: &GearPair, order: f64) -> f64 {
    order / f64::from(pair.driven().tooth_count())
}

/// The orders of the motion: the known ones, and others that stand out of the static curve except those of the mesh, as far as there is room.
fn orders_at_speed(pair: &GearPair, curve: &Curve) -> Vec<(String, f64)> {
    let mut orders = known(pair);
    let most = most_orders(pair);
    let named = curve.spectrum.iter().flat_map(|spectrum| &spectrum.named);
    for line in named {
        let is_new = orders.iter().all(|(label, _)| *label != line.label);
        if is_new && orders.len() < most && !matches!(line.kind, OrderKind::Mesh { .. }) {
            orders.push((line.label.clone(), per_mesh_period(pair, line.order)));
        }
    }
    orders.sort_by(|a, b| a.1.total_cmp(&b.1));
    orders
}
