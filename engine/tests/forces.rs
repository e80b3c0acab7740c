//! Force tables against direct solutions, and the run-up of a pair of the paper.

mod cases;

use std::f64::consts::PI;

use cases::{case, gear, holed, pair, standard_pair, test_case};
use meshwright_engine::analysis::forces::{
    CurveDynamics, DynamicsRequest, ForceTableRequest, dynamics, equivalent_mass, force_table,
};
use meshwright_engine::analysis::{Case, Method, analyze, pair_model};
use meshwright_engine::contact::{MadePair, WarmStart};
use meshwright_engine::dynamics::ForceTable;
use meshwright_engine::gear::{Eccentricity, PairDeviations};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;

const TWELVE: ForceTableRequest = ForceTableRequest {
    loads: 12,
    largest_output_torque: None,
};

fn table(case: &Case) -> ForceTable {
    force_table(case, TWELVE, &Library::default(), &Run::unattended()).expect("a table")
}

/// Numbers in 0 to 1, the same ones every time.
fn drawn(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The differences of the table of `case` from direct solutions at two hundred places, over its largest load, rising.
fn missed(case: &Case, request: ForceTableRequest, seed: u64) -> Vec<f64> {
    let run = Run::unattended();
    let table = force_table(case, request, &Library::default(), &run).expect("a table");
    let table = table.refined(4, 4);
    let model = pair_model(case, &Library::default(), &run).expect("a model");
    let made = MadePair {
        model: &model,
        deviations: &PairDeviations::NONE,
    };
    let largest = *table.loads().last().expect("loads");
    let mut draw = drawn(seed);
    let mut missed: Vec<f64> = (0..200)
        .map(|_| {
            let eta = draw() * f64::from(table.period());
            let load = draw() * largest;
            let exact = made
                .contact(eta, load, &mut WarmStart::default())
                .expect("a contact");
            (table.load(eta, exact.transmission_error) - load).abs() / largest
        })
        .collect();
    missed.sort_by(f64::total_cmp);
    missed
}

#[test]
fn a_table_holds_at_two_hundred_places_that_it_was_not_computed_at() {
    let cases = [
        (test_case(2), 1),
        (case(standard_pair(false), &[60.0]), 2),
        (case(standard_pair(true), &[20.0]), 3),
    ];
    for (mut case, seed) in cases {
        // As it comes, nine places of ten are within 0.2 % of the largest load and all within 1 %: where two kinks of pairs that begin or
        // cease to carry lie in neighboring cells, a table of 40 positions and 12 loads is coarse.
        let usual = missed(&case, TWELVE, seed);
        assert!(
            usual[179] < 2e-3 && usual[199] < 1e-2,
            "{:?}",
            &usual[170..]
        );
        // Twice as fine each way, all but one in two hundred are within 0.2 %.
        case.resolution.positions_per_mesh_period = 80;
        let fine = ForceTableRequest {
            loads: 24,
            ..TWELVE
        };
        let fine = missed(&case, fine, seed);
        assert!(fine[198] < 2e-3 && fine[199] < 4e-3, "{:?}", &fine[190..]);
    }
}

#[test]
fn the_torque_on_the_driver_follows_from_the_energy_of_the_table() {
    // Virtual work: T_1 = F r_b1 + ∂V/∂η z_1/2π, against the moments of the contact forces about the driving axis. Those act on flanks as
    // they stand without load; that flanks incline as they yield is in the energy alone, and a tenth of the swing.
    let mut case = case(standard_pair(false), &[115.0]);
    case.resolution.positions_per_mesh_period = 160;
    let table = table(&case).refined(4, 4);
    let analysis = analyze(&case, &Library::default(), &Run::unattended()).expect("curves");
    let curve = &analysis.curves[0];
    let driving = case.pair.driving();
    let mean = curve.load * driving.base_radius();
    let swing = curve
        .driving_torque
        .iter()
        .fold(0.0_f64, |most, torque| most.max((torque - mean).abs()));
    assert!(swing > 0.001 * mean, "there is something to see: {swing}");
    let mut squares = 0.0;
    for (i, eta) in curve.mesh_position.iter().enumerate() {
        // Between two slopes of the table, one to either side of its position.
        let beside = [-0.0008, 0.0008].map(|d| {
            let delta = table.transmission_error(curve.load);
            let place = (4 * i) as f64 + d * 640.0;
            let at = place.rem_euclid(delta.len() as f64);
            let (first, part) = (at.floor() as usize, at.fract());
            let delta = delta[first] * (1.0 - part) + delta[(first + 1) % delta.len()] * part;
            let forces = table.forces(eta + d, delta);
            forces.load * driving.base_radius()
                + forces.per_period * f64::from(driving.tooth_count()) / (2.0 * PI)
        });
        let found = (beside[0] + beside[1]) / 2.0;
        squares += (found - curve.driving_torque[i]).powi(2);
    }
    let rms = (squares / curve.mesh_position.len() as f64).sqrt();
    assert!(rms < 0.15 * swing, "{rms} of {swing}");
}

#[test]
fn backlash_is_that_of_the_drawing_and_deviations_move_the_loaded_flank_alone() {
    let mut plain = case(standard_pair(false), &[60.0]);
    plain.method = Method::LoadDistribution;
    let of_plain = table(&plain);
    for backlash in of_plain.backlash() {
        assert!((backlash - plain.pair.backlash()).abs() < 1e-12);
    }
    let mut eccentric = gear(20, 8e-3);
    eccentric.deviations.eccentricity = Some(Eccentricity {
        amount: 20e-6,
        direction: 0.3,
    });
    let mut eccentric = case(pair(eccentric, gear(20, 8e-3), 40.6e-3), &[20.0]);
    eccentric.method = Method::LoadDistribution;
    eccentric.resolution.positions_per_mesh_period = 16;
    let of_eccentric = table(&eccentric);
    assert_eq!(of_eccentric.period(), 20);
    let other = &of_eccentric.rows_of_other_flank()[0];
    assert!(
        other
            .iter()
            .all(|at| (at + eccentric.pair.backlash()).abs() < 1e-12)
    );
    let [most, least] = [f64::max, f64::min].map(|of| {
        let backlash = of_eccentric.backlash();
        backlash.iter().copied().reduce(of).expect("positions")
    });
    // It comes and goes once a revolution, by about its amount to either side.
    assert!((most - least - 40e-6).abs() < 4e-6, "{}", most - least);
}

fn run_up(case: &Case, to: f64, count: u32) -> CurveDynamics {
    let analysis = analyze(case, &Library::default(), &Run::unattended()).expect("curves");
    let step = to / 60.0 / f64::from(count - 1);
    let request = DynamicsRequest {
        speeds: (0..count).map(|i| f64::from(i) * step).collect(),
        damping_ratio: 0.05,
        inertias: [None; 2],
        sweeps: [true, true],
    };
    dynamics(
        &case.pair,
        &analysis.curves[0],
        &table(case),
        &request,
        &Run::unattended(),
    )
    .expect("nobody stops it")
}

#[test]
fn the_run_up_of_a_pair_with_holes_resonates_at_its_mesh_and_hole_orders() {
    let case = test_case(2);
    let found = run_up(&case, 20_000.0, 201);
    let up = found.run_up.up.as_ref().expect("asked for");
    let down = found.run_up.down.as_ref().expect("asked for");
    // Speed 0 is the static curve.
    let analysis = analyze(&case, &Library::default(), &Run::unattended()).expect("curves");
    let statistics = analysis.curves[0].transmission_error_statistics;
    assert!((up.rms[0] / statistics.rms - 1.0).abs() < 1e-2);
    assert!((up.peak_to_peak[0] / statistics.peak_to_peak - 1.0).abs() < 2e-2);
    assert_eq!(up.load_factor[0], 1.0);
    // Each gear has half the mass on the line of action that it would have alone.
    let alike = equivalent_mass(&case.pair, [Some(1e-3); 2]);
    assert!((alike - 1e-3 / 2.0 / case.pair.driving().base_radius().powi(2)).abs() < 1e-9);
    // The mesh order shakes most where it meets the natural frequency; the softening of contact loss takes it lower.
    let label = |label: &str| found.labels.iter().position(|each| each == label);
    let mesh = label("H_Z2").expect("told");
    let most = |list: &[f64]| {
        let place = (0..list.len()).max_by(|&a, &b| list[a].total_cmp(&list[b]));
        found.speeds[place.expect("speeds")] * 60.0
    };
    let critical = found.run_up.natural_frequency / 50.0 * 60.0;
    let peak = most(&down.orders[mesh]);
    assert!(
        (0.8..1.05).contains(&(peak / critical)),
        "{peak} {critical}"
    );
    // The order of the holes, a fifth of it, meets the natural frequency at five times the speed.
    let holes = label("H_N").expect("told");
    let forced: Vec<f64> = found
        .resonances
        .iter()
        .filter(|each| each.order == holes)
        .map(|each| each.speed * 60.0 / critical)
        .collect();
    if 5.0 * critical <= 20_000.0 {
        assert!((forced[0] - 5.0).abs() < 1e-6, "{forced:?}");
    }
    // Far above everything the gears stand still, and only what they are spared of the static curve is left.
    assert!(
        up.load_factor
            .iter()
            .all(|factor| *factor >= 1.0 - 1e-6 && *factor < 6.0)
    );
}

#[test]
fn without_holes_and_relief_at_any_torque_a_run_up_ends_and_is_finite() {
    for torque in [5.0, 300.0] {
        let driven = holed(gear(50, 15e-3), 5, 32e-3, 9e-3, 0.1);
        let mut case = case(pair(gear(50, 15e-3), driven, 100.5e-3), &[torque]);
        case.method = Method::ProjectedDecomposition;
        let found = run_up(&case, 30_000.0, 61);
        for branch in [&found.run_up.up, &found.run_up.down] {
            let branch = branch.as_ref().expect("asked for");
            assert_eq!(branch.rms.len(), 61);
            let lists = [&branch.rms, &branch.peak_to_peak, &branch.load_factor];
            assert!(lists.into_iter().flatten().all(|value| value.is_finite()));
        }
    }
}
