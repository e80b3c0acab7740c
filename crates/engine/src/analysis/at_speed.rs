//! What the mesh of a case does at speed.

use std::f64::consts::PI;

use super::curve::Curve;
use super::orders::Orders;
use super::{AnalysisError, Case, OrderKind};
use crate::dynamics::torsion::{Coupled, Ring, Rotor};
use crate::dynamics::{ForceTable, Order, Resonance, RunUp, RunUpData};
use crate::gear::{GearPair, Member};
use crate::run::Run;

/// Orders of a pair in its results, at most, for each mesh period of its true period: speeds are as many fewer as that is longer, so that this bounds the
/// results of a run-up. Those that are known are never more.
const ORDERS_A_PERIOD: usize = 12;

/// Rings into which the band of a hole is divided.
const BANDS: u32 = 8;

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
    /// The labels of the orders whose amplitudes are known.
    pub labels: Vec<String>,
    /// These orders per revolution of the driven gear.
    pub orders: Vec<f64>,
    /// The resonances, the largest amplitude first.
    pub resonances: Vec<NamedResonance>,
    /// The natural frequency in Hz with the inertia of rims and teeth outside their webs, about; `None` where the inertia given
    /// is less than the gear's own.
    pub natural_frequency_of_rims: Option<f64>,
}

/// A resonance with the name of its order.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedResonance {
    /// The name.
    pub label: String,
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// Where it stands, how large it is, and what excites it.
    pub resonance: Resonance,
}

/// The mass m_e on the line of action: 1/m_e = r_b1²/J_1 + r_b2²/J_2.
pub fn equivalent_mass(case: &Case, inertias: [Option<f64>; 2]) -> f64 {
    let of = |member: Member| {
        let inertia = inertias[member.index()].unwrap_or_else(|| own_inertia(case, member));
        case.pair.gear(member).base_radius().powi(2) / inertia
    };
    1.0 / (of(Member::Driving) + of(Member::Driven))
}

/// The polar inertia of a gear as drawn, in kg m².
fn own_inertia(case: &Case, member: Member) -> f64 {
    match case.faces() {
        Some(faces) => faces.pair.gear(member).polar_inertia(),
        None => case.pair.gear(member).polar_inertia(),
    }
}

/// The lowest natural frequency in Hz of the gears of `case` on a mesh whose mean stiffness is `stiffness` with the bores held: their blanks turn in
/// themselves, and what turns with a gear beside its own inertia stands at its bore.
fn natural_frequency_of_rims(
    case: &Case,
    inertias: [Option<f64>; 2],
    stiffness: f64,
) -> Option<f64> {
    let rotor = |member: Member| {
        let own = own_inertia(case, member);
        let beside = inertias[member.index()].map_or(0.0, |given| given - own);
        rotor(case, member, own, beside)
    };
    let coupled = Coupled {
        rotors: [rotor(Member::Driving), rotor(Member::Driven)],
        radii: Member::BOTH.map(|member| case.pair.gear(member).base_radius()),
        stiffness,
    };
    coupled.natural_frequency()
}

/// The rings of a blank between bore and root circle, with what of a ring its holes leave, the teeth on the last of them, and what turns `beside` at
/// the bore.
fn rotor(case: &Case, member: Member, own: f64, beside: f64) -> Rotor {
    let gear = case.pair.gear(member);
    let blank = &gear.data().blank;
    let hub = case.faces().and_then(|of| of.pair.gear(member).hub());
    let (bore, root) = (blank.bore_radius, gear.root_radius());
    let mut edges = vec![bore, root];
    edges.extend(
        blank
            .web
            .iter()
            .flat_map(|web| [web.inner_radius, web.outer_radius]),
    );
    edges.extend(hub.map(|hub| hub.outer_radius));
    for hole in &blank.holes {
        let [inner, outer] = [hole.inner_reach(), hole.outer_reach()];
        edges
            .extend((0..=BANDS).map(|i| inner + (outer - inner) * f64::from(i) / f64::from(BANDS)));
    }
    edges.retain(|edge| (bore..=root).contains(edge));
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let open = |radius: f64| -> f64 {
        let areas = blank
            .holes
            .iter()
            .map(|hole| hole.moments_within(radius).area);
        areas.sum()
    };
    let rings = edges.windows(2).map(|ends| {
        let [inner, outer] = [ends[0], ends[1]];
        let middle = f64::midpoint(inner, outer);
        let thickness = match hub {
            Some(hub) if middle < hub.outer_radius => hub.width,
            _ => blank.thickness_at(middle, gear.face_width()),
        };
        let share = (open(outer) - open(inner)) / (PI * (outer * outer - inner * inner));
        Ring {
            radii: [inner, outer],
            thickness: thickness * (1.0 - share),
        }
    });
    let material = gear.material();
    let rotor = Rotor {
        rings: rings.collect(),
        shear_modulus: material.shear_modulus(),
        density: material.density,
        inner: beside,
        outer: 0.0,
    };
    let teeth = own - rotor.inertia_of_rings();
    Rotor {
        outer: teeth,
        ..rotor
    }
}

/// The mean stiffness of a mesh in N/m, about.
pub(super) fn usual_stiffness(pair: &GearPair) -> f64 {
    let moduli = Member::BOTH.map(|member| pair.gear(member).material().youngs_modulus);
    STIFFNESS * moduli[0].min(moduli[1]) * pair.common_face_width()
}

/// Seconds of one core that the run-ups of `case` take, about, as many as there are torques, and the bytes.
pub(super) fn run_up_cost(case: &Case, request: &DynamicsRequest) -> (f64, u64) {
    let pair = &case.pair;
    let orders = known(pair).into_iter().map(|(_, order)| order).collect();
    let data = data(case, request, (0.0, usual_stiffness(pair)), orders);
    let seconds = case.output_torques.len() as f64 * data.seconds(pair.period());
    (seconds, data.memory(pair.period()))
}

/// The parameters of a run-up of `case` under a load, with a mean stiffness of the mesh.
fn data(
    case: &Case,
    request: &DynamicsRequest,
    (load, stiffness): (f64, f64),
    orders: Vec<f64>,
) -> RunUpData {
    RunUpData {
        speeds: request.speeds.clone(),
        tooth_count: case.pair.driving().tooth_count(),
        load,
        mass: equivalent_mass(case, request.inertias),
        damping_ratio: request.damping_ratio,
        stiffness,
        orders,
        most_orders: most_orders(&case.pair),
        sweeps: request.sweeps,
    }
}

/// What the mesh of `table`, which is that of `case`, does at speed under the load of `curve`, which spans whole periods and whose load is not 0.
///
/// # Errors
///
/// [`AnalysisError::Stopped`] if `run` was stopped.
pub fn dynamics(
    case: &Case,
    curve: &Curve,
    table: &ForceTable,
    request: &DynamicsRequest,
    run: &Run,
) -> Result<CurveDynamics, AnalysisError> {
    let pair = &case.pair;
    let orders = orders_at_speed(pair, curve);
    let orders = orders.into_iter().map(|(_, order)| order).collect();
    let stiffness = curve.mesh_stiffness_tangent_statistics.mean;
    let data = data(case, request, (curve.load, stiffness), orders);
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
        natural_frequency_of_rims: natural_frequency_of_rims(
            case,
            request.inertias,
            data.stiffness,
        ),
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

/// The orders that are given: those that are known, and what else stands out of the static curve but for the mesh, as far as there is room.
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
