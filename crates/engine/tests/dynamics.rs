//! Motion at speed against closed forms, known limits and an integrator of the tests' own.

#[path = "cases/plain_motion.rs"]
mod plain_motion;

use std::f64::consts::PI;

use meshwright_engine::dynamics::coupled::{CoupledMotion, Drift};
use meshwright_engine::dynamics::orbit::{Repeating, Scale, multiplier};
use meshwright_engine::dynamics::oscillator::Step;
use meshwright_engine::dynamics::{
    Body, BodyMode, BodyWave, Branch, Coupled, Damping, Excitation, FlankRows, ForceTable, Laws,
    LoadSteps, Mount, Orbit, Order, Oscillator, RunUp, RunUpData, State, Support,
};
use meshwright_engine::run::Run;
use nalgebra::{Cholesky, Complex, DMatrix, DVector, Matrix6, SMatrix};
use plain_motion::settled_by_runge_kutta;

const AT_REST: Orbit = Orbit::REST;

/// Mass 1 on a stiffness that is 1 in the mean and rectangular: k_max for ε − 1 of the period, k_min = 0.6 k_max for the rest, ε = 1.5.
fn rectangular(omega: f64, zeta: f64) -> f64 {
    let most = 1.0 / 0.8;
    let laws = Laws::new(
        vec![-1.0, 1.0],
        vec![
            -1.0 / most,
            1.0 / most,
            -1.0 / (0.6 * most),
            1.0 / (0.6 * most),
        ],
        0,
    );
    let step = |law| Step {
        law,
        force: 0.0,
        kick: 0.0,
    };
    let oscillator = Oscillator {
        laws: &laws,
        mass: 1.0,
        damping: 2.0 * zeta,
        duration: PI / omega,
        looks: 16,
        steps: vec![step(0), step(1)],
    };
    let (_, m) = oscillator.after_period(State { u: 0.0, v: 0.0 }, |_| ());
    multiplier(&[0, 1].map(|j| [m[0][j], m[1][j]].to_vec()).to_vec())
}

#[test]
fn the_instabilities_of_a_rectangular_stiffness_are_where_meissner_has_them() {
    // From |2 cosA cosB − (a/b + b/a) sinA sinB| > 2 cosh(ζT), to the digits given.
    for (low, high, zeta) in [
        (1.8384, 2.1559, 0.0),
        (0.9764, 1.0076, 0.0),
        (0.6470, 0.6766, 0.0),
        (1.8712, 2.1182, 0.05),
    ] {
        let unstable = |omega: f64| rectangular(omega, zeta) > 1.0 + 1e-9;
        let digit = 1e-4;
        assert!(!unstable(low - digit) && unstable(low + digit), "{low}");
        assert!(unstable(high - digit) && !unstable(high + digit), "{high}");
    }
    let damped = (500..1800).filter(|&i| rectangular(f64::from(i) * 1e-3, 0.05) > 1.0);
    assert_eq!(damped.count(), 0, "damping leaves the first only");
}

/// x'' + 0.1 x' + g(x) = 0.1 + 0.05 w² cos wt with a gap of half width 1, at rms 1e-4 of converged.
fn with_backlash(laws: &Laws, w: f64) -> Oscillator<'_> {
    let count = 400;
    let duration = 2.0 * PI / w / f64::from(count);
    // The mean of the force over each step.
    let pushed = |i: i32| (w * duration * f64::from(i)).sin() / w;
    let steps = (0..count)
        .map(|i| Step {
            law: 0,
            force: 0.1 + 0.05 * w * w * (pushed(i + 1) - pushed(i)) / duration,
            kick: 0.0,
        })
        .collect();
    Oscillator {
        laws,
        mass: 1.0,
        damping: 0.1,
        duration,
        looks: 1,
        steps,
    }
}

/// Rms without mean, and whether contact is lost.
fn seen(oscillator: &Oscillator<'_>, orbit: &Orbit) -> (f64, bool) {
    let (mut n, mut sum, mut squares, mut lost) = (0.0, 0.0, 0.0, false);
    let mut state = orbit.state.clone();
    for _ in 0..orbit.periods {
        oscillator.over_period(&mut state, None, &mut |seen| {
            n += 1.0;
            sum += seen.u;
            squares += seen.u * seen.u;
            lost |= seen.apart;
        });
    }
    ((squares / n - (sum / n).powi(2)).sqrt(), lost)
}

#[test]
fn an_oscillator_with_backlash_jumps_where_it_should() {
    let laws = Laws::new(vec![-1.0, 0.0, 0.0, 1.0], vec![-2.0, -1.0, 1.0, 2.0], 2);
    let scale = Scale { u: 0.1, v: 0.1 };
    let rest = Orbit {
        state: vec![1.1, 0.0],
        ..AT_REST
    };
    let sweep = |from: i32, to: i32| -> Vec<(i32, f64, bool)> {
        let step = (to - from).signum();
        let mut orbit = rest.clone();
        (0..=(to - from).abs())
            .map(|k| {
                let w = from + k * step;
                let oscillator = with_backlash(&laws, f64::from(w) / 100.0);
                orbit = oscillator.settled(&orbit, scale);
                let (rms, lost) = seen(&oscillator, &orbit);
                (w, rms, lost)
            })
            .collect()
    };
    let down = sweep(150, 60);
    let largest = down
        .iter()
        .fold(down[0], |a, &b| if b.1 > a.1 { b } else { a });
    let at = |branch: &[(i32, f64, bool)], w: i32| {
        branch.iter().find(|each| each.0 == w).expect("swept").1
    };
    // Down to its fold the branch only rises; the largest is the last on it but rounding of the table of the issue.
    assert!((at(&down, 72) - 0.236).abs() < 1e-3, "{}", at(&down, 72));
    assert!(largest.0 == 71 || largest.0 == 72, "{largest:?}");
    assert!(at(&down, 71) > 0.2 && at(&down, 70) < 0.1, "the drop");
    let up = sweep(60, 150);
    assert!(at(&up, 83) > 1.5 * at(&up, 82), "the jump");
    assert!(
        !up.iter().any(|each| each.0 <= 82 && each.2),
        "linear before it"
    );
    for branch in [&down, &up] {
        assert!(
            (at(branch, 100) - 0.1331).abs() < 1e-4,
            "{}",
            at(branch, 100)
        );
        // Beyond the last knot of the linear response nothing parts.
        assert!(!branch.iter().any(|each| each.0 >= 141 && each.2));
    }
}

#[test]
fn the_linear_response_loses_contact_where_its_amplitude_is_the_load() {
    // Within 0.82063 to 1.40709 the linear solution crosses the knot; the linear piece alone tells it.
    let laws = Laws::new(vec![-1.0, 0.0, 1.0], vec![0.0, 1.0, 2.0], 1);
    for (w, parts) in [
        (0.8204, false),
        (0.8209, true),
        (1.4069, true),
        (1.4073, false),
    ] {
        let oscillator = with_backlash(&laws, w);
        let orbit = oscillator
            .periodic(&[1.1, 0.0], 1, Scale { u: 0.1, v: 0.1 })
            .expect("linear");
        let (_, lost) = seen(&oscillator, &orbit);
        assert_eq!(lost, parts, "{w}");
    }
}

/// A table of a mesh with δ = wave(η) + compliance(η) F and no other flank in reach.
fn table(
    positions: usize,
    largest: f64,
    wave: impl Fn(f64) -> f64,
    compliance: impl Fn(f64) -> f64,
) -> ForceTable {
    with_backlash_of(1e3, (positions, largest), wave, compliance)
}

/// The same with the other flank `apart` from the loaded one.
fn with_backlash_of(
    apart: f64,
    (positions, largest): (usize, f64),
    wave: impl Fn(f64) -> f64,
    compliance: impl Fn(f64) -> f64,
) -> ForceTable {
    let ladder = LoadSteps { count: 5, largest };
    let rows = |from: f64, sign: f64| {
        ladder
            .loads()
            .into_iter()
            .map(|load| {
                (0..positions)
                    .map(|i| {
                        let eta = i as f64 / positions as f64;
                        from + wave(eta) + sign * compliance(eta) * load
                    })
                    .collect()
            })
            .collect()
    };
    let flanks = [rows(0.0, 1.0), rows(-apart, -1.0)];
    ForceTable::new(1, ladder.loads(), flanks.map(FlankRows::of_delta)).expect("rows that rise")
}

fn data(speeds: Vec<f64>, load: f64, orders: &[f64]) -> RunUpData {
    RunUpData {
        speeds,
        tooth_count: 1,
        load,
        mass: 1.0,
        bodies: [(); 2].map(|()| Body {
            inertia: 2.0,
            base_radius: 1.0,
            modes: Vec::new(),
            waves: Vec::new(),
            mount: Mount::NONE,
        }),
        damping_ratio: 0.05,
        body_damping_ratio: 0.02,
        stiffness: 1.0,
        orders: orders.to_vec(),
        most_orders: 1000,
        sweeps: [true, true],
    }
}

fn run_up(data: &RunUpData, table: &ForceTable) -> RunUp {
    data.run_up(table, &Run::unattended())
        .expect("nobody stops")
}

#[test]
fn the_estimate_of_a_run_up_grows_with_the_time_in_which_free_motion_dies_away() {
    // With a tenth of the damping, free motion lasts ten times as long, and the stiffness excites more orders.
    let of = |damping_ratio: f64| {
        let data = RunUpData {
            damping_ratio,
            ..data(vec![0.1, 0.4], 1.0, &[1.0])
        };
        data.seconds(1)
    };
    let grows = of(0.005) / of(0.05);
    assert!(grows > 5.0, "{grows}");
}

#[test]
fn a_linear_mesh_answers_each_harmonic_as_a_forced_oscillator() {
    // x'' + 2ζx' + x = F_0 + e(θ): the response to e = Σ A cos kθ is A/√((1 − r²)² + (2ζr)²), r = kω.
    let wave = |eta: f64| 0.02 * (2.0 * PI * eta).cos() + 0.01 * (6.0 * PI * eta + 0.4).cos();
    let of = |positions: usize| {
        let table = table(positions, 2.0, wave, |_| 1.0);
        let speeds: Vec<f64> = [0.2, 0.333, 0.9, 1.0, 1.7]
            .iter()
            .map(|w| w / (2.0 * PI))
            .collect();
        let found = run_up(&data(speeds.clone(), 1.0, &[1.0, 3.0]), &table);
        let [up, down] = [&found.up, &found.down].map(|branch| branch.as_ref().expect("asked"));
        let mut worst = 0.0_f64;
        for (i, speed) in speeds.iter().enumerate() {
            let mut squares = 0.0;
            for (order, amplitude) in [(1_u32, 0.02), (3, 0.01)] {
                let k = found
                    .orders
                    .iter()
                    .position(|each| *each == Order::new(order, 1));
                let k = k.expect("in the results");
                let order = f64::from(order);
                let r = order * speed * 2.0 * PI;
                let expected = amplitude / ((1.0 - r * r).powi(2) + (0.1 * r).powi(2)).sqrt();
                worst = worst.max((up.orders[k][i] / expected - 1.0).abs());
                assert!((up.orders[k][i] - down.orders[k][i]).abs() < 1e-9);
                squares += expected * expected / 2.0;
            }
            worst = worst.max((up.rms[i] / squares.sqrt() - 1.0).abs());
            assert!(!up.contact_lost[i] && up.repeats[i] == Some(1));
        }
        worst
    };
    let (coarse, fine) = (of(256), of(512));
    assert!(coarse < 1.5e-3, "{coarse}");
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.1, "second order: {order}");
}

#[test]
fn a_motion_that_is_pumped_without_bound_is_told_to_run_away() {
    // Meissner's stiffness on both flanks, with nothing between them: with ζ = 0.05 unstable for ω in 1.8712 to 2.1182, and nothing limits it.
    let compliance = |eta: f64| if eta < 0.5 { 0.8 } else { 0.8 / 0.6 };
    let frequencies = [1.2, 1.8, 1.95, 2.05, 2.2, 3.0];
    let speeds = frequencies.map(|w| w / (2.0 * PI)).to_vec();
    for (apart, pumped) in [(0.0, true), (1e3, false)] {
        let table = with_backlash_of(apart, (256, 4.0), |_| 0.0, compliance);
        let found = run_up(&data(speeds.clone(), 1.0, &[1.0]), &table);
        for branch in [found.up, found.down].into_iter().flatten() {
            for (i, w) in frequencies.into_iter().enumerate() {
                let expected = pumped && (1.8712..2.1182).contains(&w);
                assert_eq!(branch.runs_away[i], expected, "{w}, {apart} apart");
                assert!(!expected || branch.repeats[i].is_none(), "{w}");
                // A thousand times the deflection and what it fluctuates by, to either side, and not what it would grow to.
                let told = [branch.rms[i], branch.peak_to_peak[i], branch.orders[0][i]];
                assert!(told.iter().all(|of| *of < 4e3), "{w}: {told:?}");
            }
        }
    }
}

#[test]
fn without_relief_the_response_over_the_static_deflection_does_not_depend_on_torque() {
    // δ = F/k(η): without backlash's other flank in reach the equation is homogeneous in F_0, contact loss and jumps included.
    let compliance = |eta: f64| 1.0 + 0.25 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta).cos();
    let table = table(64, 50.0, |_| 0.0, compliance);
    let speeds: Vec<f64> = (4..60).map(|i| f64::from(i) * 0.05 / (2.0 * PI)).collect();
    let of = |load: f64| run_up(&data(speeds.clone(), load, &[1.0]), &table);
    let (light, heavy) = (of(0.5), of(20.0));
    let (light, heavy) = (light.down.expect("asked"), heavy.down.expect("asked"));
    assert!(light.contact_lost.contains(&true) && light.contact_lost.contains(&false));
    for i in 0..speeds.len() {
        assert_eq!(light.contact_lost[i], heavy.contact_lost[i]);
        assert_eq!(light.repeats[i], heavy.repeats[i], "{i}");
        if light.repeats[i].is_some() {
            assert!((light.rms[i] / 0.5 - heavy.rms[i] / 20.0).abs() < 1e-6);
            assert!((light.load_factor[i] - heavy.load_factor[i]).abs() < 1e-6);
        }
    }
}

#[test]
fn a_very_slow_mesh_follows_its_static_curve() {
    let wave = |eta: f64| 0.3 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let compliance = |eta: f64| 1.0 + 0.25 * (2.0 * PI * eta).cos();
    let table = table(64, 2.0, wave, compliance);
    let found = run_up(&data(vec![0.0, 1e-9], 1.0, &[1.0, 2.0]), &table);
    for branch in [found.up.expect("asked"), found.down.expect("asked")] {
        assert_eq!(branch.load_factor[0], 1.0);
        for [still, slow] in [
            [branch.rms[0], branch.rms[1]],
            [branch.peak_to_peak[0], branch.peak_to_peak[1]],
            [branch.load_factor[0], branch.load_factor[1]],
            [branch.orders[0][0], branch.orders[0][1]],
            [branch.orders[1][0], branch.orders[1][1]],
        ] {
            assert!((slow / still - 1.0).abs() < 1e-6, "{slow} {still}");
        }
        assert!(!branch.contact_lost[0] && !branch.contact_lost[1]);
    }
}

#[test]
fn a_nonlinear_mesh_moves_as_a_plain_integrator_has_it() {
    // The classical Runge-Kutta method at tight steps on m x'' + c x' + F(θ, x) = F_0 and the very table that is run through.
    let wave = |eta: f64| 0.4 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let compliance = |eta: f64| 1.0 + 0.25 * (2.0 * PI * eta).cos();
    let table = table(128, 4.0, wave, compliance).refined(4, 4);
    for omega in [0.45, 0.7, 1.1, 1.9] {
        let data = data(vec![omega / (2.0 * PI)], 1.0, &[1.0]);
        let found = run_up(&data, &table).up.expect("asked");
        let load = |t: f64, x: f64| table.load(omega * t / (2.0 * PI), x);
        let rate = |t: f64, [x, v]: [f64; 2]| [v, 1.0 - 0.1 * v - load(t, x)];
        let rest = [table.transmission_error(1.0)[0], 0.0];
        let see = |t: f64, [x, _]: [f64; 2]| (x, load(t, x));
        let [rms, _, most] =
            settled_by_runge_kutta(2.0 * PI / omega, [2048, 400, 80], rest, rate, see);
        let repeats = found.repeats[0];
        assert!(
            (found.rms[0] / rms - 1.0).abs() < 2e-3,
            "{omega}: {} {rms} {repeats:?}",
            found.rms[0]
        );
        assert!(
            (found.load_factor[0] / most - 1.0).abs() < 1e-2,
            "{omega}: {} {most}",
            found.load_factor[0]
        );
    }
}

/// The amplitudes of a branch of `found` at the order `times` in `periods`.
fn at(found: &RunUp, order: Order) -> &[f64] {
    let place = found.orders.iter().position(|each| *each == order);
    let branch = found.up.as_ref().expect("asked");
    &branch.orders[place.expect("it is in the results")]
}

/// The resonances of `found`: how often the order comes in a true period, what excites it, the circular frequency of the mesh and the amplitude.
fn resonances(found: &RunUp) -> Vec<(f64, Excitation, f64, f64)> {
    let all = found.resonances.iter();
    all.map(|each| {
        let order = each.order.per_true_period();
        assert!((each.frequency / (order * each.speed) - 1.0).abs() < 1e-12);
        (order, each.excited, 2.0 * PI * each.speed, each.amplitude)
    })
    .collect()
}

#[test]
fn a_resonance_stands_once_at_its_largest_amplitude_however_few_the_speeds() {
    // A linear mesh under 0.02 cos θ + 0.01 cos 3θ: at r² = 1 − 2ζ² an order is 1/(2ζ √(1 − ζ²)) times its static amplitude, and nothing pumps.
    let wave = |eta: f64| 0.02 * (2.0 * PI * eta).cos() + 0.01 * (6.0 * PI * eta).cos();
    let table = table(256, 2.0, wave, |_| 1.0);
    for speeds in [&[0.1, 0.5, 1.9][..], &[0.2, 0.97, 1.01, 1.5]] {
        let speeds: Vec<f64> = speeds.iter().map(|w| w / (2.0 * PI)).collect();
        let found = resonances(&run_up(&data(speeds, 1.0, &[1.0, 3.0]), &table));
        let (place, gain) = ((1.0_f64 - 0.005).sqrt(), 10.0 / (1.0_f64 - 0.0025).sqrt());
        let expected = [(1.0, place, 0.02 * gain), (3.0, place / 3.0, 0.01 * gain)];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for ((order, excited, speed, amplitude), expected) in found.into_iter().zip(expected) {
            assert_eq!((order, excited), (expected.0, Excitation::Forced));
            // Amplitude and parabola in the speed are of second order there.
            assert!(
                (speed / expected.1 - 1.0).abs() < 1e-3,
                "{speed} {}",
                expected.1
            );
            assert!(
                (amplitude / expected.2 - 1.0).abs() < 2e-3,
                "{amplitude} {}",
                expected.2
            );
        }
    }
}

/// A mesh whose stiffness under the load 1 is `stiffness` and whose static curve there is `curve`.
fn under_one(stiffness: impl Fn(f64) -> f64, curve: impl Fn(f64) -> f64) -> ForceTable {
    let compliance = |eta: f64| 1.0 / stiffness(eta);
    table(128, 3.0, |eta| curve(eta) - compliance(eta), compliance)
}

#[test]
fn a_resonance_is_forced_where_its_line_makes_it_and_parametric_where_the_stiffness_does() {
    // The static curve has the order 1 alone. The stiffness is k = 1 + 0.1 cos θ, too little to pump with ζ = 0.05: it makes an order 2 of the order 1.
    let stiffness = |eta: f64| 1.0 + 0.1 * (2.0 * PI * eta).cos();
    let curve = |eta: f64| 0.02 * (2.0 * PI * eta).cos();
    let speeds: Vec<f64> = (3..28).map(|i| 0.05 * f64::from(i) / (2.0 * PI)).collect();
    let data = data(speeds, 1.0, &[1.0]);
    let of = |table: &ForceTable| run_up(&data, table);
    let found = of(&under_one(stiffness, curve));
    let told = resonances(&found);
    let order = |times: f64| {
        let mut of_order = told.iter().filter(|each| each.0 == times);
        let one = of_order.next().expect("told");
        assert!(of_order.next().is_none(), "{times}: {told:?}");
        *one
    };
    let (first, second) = (order(1.0), order(2.0));
    assert_eq!(
        (first.1, second.1),
        (Excitation::Forced, Excitation::Parametric)
    );
    assert!((first.2 - 1.0).abs() < 0.01 && (second.2 - 0.5).abs() < 0.01);
    // The tests that say so, of the run-ups of other tables.
    let most = |found: &RunUp, order: Order| {
        let place = found.orders.iter().position(|each| *each == order);
        place.map_or(0.0, |_| {
            at(found, order).iter().copied().fold(0.0, f64::max)
        })
    };
    let [one, two] = [1, 2].map(|times| Order::new(times, 1));
    let of_mean = of(&under_one(|_| 1.0, curve));
    let of_flat = of(&under_one(stiffness, |_| 0.0));
    assert!(most(&of_mean, one) > 0.95 * first.3 && most(&of_flat, one) < 1e-9);
    assert!(most(&of_mean, two) < 1e-6 && second.3 > 1e-3);
    // What carries more than a fiftieth of the motion is in the results, though nobody asked for it.
    let branch = found.up.as_ref().expect("asked");
    let parts = at(&found, two).iter().zip(&branch.rms);
    assert!(
        parts
            .clone()
            .any(|(amplitude, rms)| amplitude / (2.0_f64.sqrt() * rms) > 0.02)
    );
}

#[test]
fn a_stiffness_that_pumps_makes_a_resonance_at_half_an_order() {
    // k = 1 + 0.4 cos θ is unstable about ω = 2 for ζ = 0.05, where flanks that part end the growth. The line of the static curve is there to begin with.
    let stiffness = |eta: f64| 1.0 + 0.4 * (2.0 * PI * eta).cos();
    let curve = |eta: f64| 1e-4 * (2.0 * PI * eta).cos();
    let speeds = [1.5, 2.0, 2.5].map(|w| w / (2.0 * PI)).to_vec();
    let found = run_up(&data(speeds, 1.0, &[1.0]), &under_one(stiffness, curve));
    let (order, excited, speed, amplitude) = resonances(&found)[0];
    assert_eq!((order, excited), (0.5, Excitation::Parametric));
    assert!(
        speed > 1.5 && speed < 2.2 && amplitude > 1.0,
        "{speed} {amplitude}"
    );
    let half = at(&found, Order::new(1, 2));
    assert!(half[1] > 0.5 && half[1] <= amplitude, "{half:?}");
}

/// A hub and a rim of these inertias on a base radius of 1, with a web of this stiffness between them.
fn hub_and_rim(hub: f64, rim: f64, web: f64) -> Body {
    Body {
        inertia: hub + rim,
        base_radius: 1.0,
        modes: vec![BodyMode {
            frequency: (web / rim).sqrt(),
            at_mesh: 1.0 / rim.sqrt(),
            turn: rim.sqrt(),
        }],
        waves: Vec::new(),
        mount: Mount::NONE,
    }
}

/// Hub, rim and web of both gears, with 1 as mass on the line of action.
const GEARS: [[f64; 3]; 2] = [[1.4, 0.6, 8.0], [1.2, 0.8, 10.0]];

fn on_webs(speeds: Vec<f64>, orders: &[f64]) -> RunUpData {
    RunUpData {
        bodies: GEARS.map(|[hub, rim, web]| hub_and_rim(hub, rim, web)),
        ..data(speeds, 1.0, orders)
    }
}

/// Holds the motion at the speed `place` to an `expected` root mean square, peak-to-peak and load factor.
fn within_a_percent(found: &Branch, place: usize, expected: [f64; 3]) {
    let of_motion = [&found.rms, &found.peak_to_peak, &found.load_factor].map(|list| list[place]);
    for (told, expected) in of_motion.into_iter().zip(expected) {
        let repeats = found.repeats[place];
        assert!(
            (told / expected - 1.0).abs() < 0.01,
            "{place}: {told} {expected} {repeats:?}"
        );
    }
}

#[test]
fn gears_on_webs_move_as_hubs_and_rims_that_a_plain_integrator_moves() {
    // The classical Runge-Kutta method on two hubs, two rims, and the table of the teeth alone: the webs yield 1/8 + 1/10 in the whole one.
    let wave = |eta: f64| 0.3 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let whole = |eta: f64| 1.0 + 0.2 * (2.0 * PI * eta).cos();
    let yields: f64 = GEARS.iter().map(|[_, _, web]| 1.0 / web).sum();
    let of_all = table(256, 4.0, wave, whole);
    let of_teeth = table(256, 4.0, wave, |eta| whole(eta) - yields);
    let omegas = [0.5, 0.85, 1.2, 2.8, 4.4];
    let speeds = omegas.map(|w| w / (2.0 * PI)).to_vec();
    let found = run_up(&on_webs(speeds, &[1.0]), &of_all).up.expect("asked");
    assert!(found.contact_lost.contains(&true) && found.contact_lost.contains(&false));
    for (place, omega) in omegas.into_iter().enumerate() {
        let rate = |t: f64, state: [f64; 8]| -> [f64; 8] {
            let (angles, speeds) = state.split_at(4);
            let nearer = speeds[1] - speeds[3];
            let eta = omega * t / (2.0 * PI);
            let force = of_teeth.load(eta, angles[1] - angles[3]) + 0.1 * nearer;
            let mut rates = [0.0; 8];
            for (gear, sign) in [(0, 1.0), (1, -1.0)] {
                let [hub, rim, web] = GEARS[gear];
                let (h, r) = (2 * gear, 2 * gear + 1);
                let twisted = web * (angles[r] - angles[h])
                    + 2.0 * 0.02 * (web * rim).sqrt() * (speeds[r] - speeds[h]);
                rates[h] = speeds[h];
                rates[r] = speeds[r];
                rates[4 + h] = (sign + twisted) / hub;
                rates[4 + r] = (-sign * force - twisted) / rim;
            }
            rates
        };
        // At rest under the load, the webs wound up.
        let rest = of_all.transmission_error(1.0)[0];
        let mut state = [0.0; 8];
        (state[0], state[1]) = (rest, rest - 1.0 / GEARS[0][2]);
        state[3] = 1.0 / GEARS[1][2];
        let see = |t: f64, s: [f64; 8]| {
            let force = of_teeth.load(omega * t / (2.0 * PI), s[1] - s[3]);
            (s[0] - s[2], force)
        };
        let moved = settled_by_runge_kutta(2.0 * PI / omega, [512, 160, 40], state, rate, see);
        within_a_percent(&found, place, moved);
    }
}

#[test]
fn a_linear_mesh_of_gears_on_webs_answers_by_its_direct_frequency_response() {
    // Constant stiffness: at order 1 the hubs move by the gain of the dynamic stiffness times the static curve, at the speed 0 by the static curve.
    let curve = |eta: f64| 0.02 * (2.0 * PI * eta).cos();
    let table = table(256, 2.0, curve, |_| 1.0);
    let speeds: Vec<f64> = (0..20).map(|i| 0.28 * f64::from(i) / (2.0 * PI)).collect();
    let data = on_webs(speeds.clone(), &[1.0]);
    let found = run_up(&data, &table);
    let damping = Damping {
        mesh: 0.1,
        bodies: 0.02,
    };
    let coupled = Coupled::new(&data.bodies, 1.0 / (1.0 - 0.225), damping).expect("bodies");
    assert_eq!(found.natural_frequencies, coupled.natural_frequencies());
    let amplitudes = at(&found, Order::new(1, 1));
    for (speed, amplitude) in speeds.iter().zip(amplitudes) {
        let expected = 0.02 * coupled.gain(2.0 * PI * speed, 0.0);
        assert!(
            (amplitude / expected - 1.0).abs() < 0.01,
            "{speed}: {amplitude} {expected}"
        );
    }
    assert!((amplitudes[0] / 0.02 - 1.0).abs() < 1e-6);
    // Each largest gain is a resonance, and nothing else is.
    let mut told: Vec<f64> = resonances(&found).iter().map(|each| each.2).collect();
    told.sort_by(f64::total_cmp);
    let gains: Vec<(f64, f64)> = (1..5320)
        .map(|i| 1e-3 * f64::from(i))
        .map(|omega| (omega, coupled.gain(omega, 0.0)))
        .collect();
    let peaks = gains
        .windows(3)
        .filter(|three| three[1].1 > three[0].1.max(three[2].1));
    let peaks: Vec<f64> = peaks.map(|three| three[1].0).collect();
    assert_eq!(told.len(), peaks.len(), "{told:?} {peaks:?}");
    for (told, peak) in told.iter().zip(&peaks) {
        assert!((told / peak - 1.0).abs() < 0.01, "{told} {peak}");
    }
}

#[test]
fn a_slow_mesh_of_gears_on_webs_follows_its_static_curve() {
    let wave = |eta: f64| 0.3 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let table = table(64, 2.0, wave, |eta| 1.0 + 0.2 * (2.0 * PI * eta).cos());
    let found = run_up(&on_webs(vec![0.0, 1e-7], &[1.0, 2.0]), &table);
    for branch in [found.up.expect("asked"), found.down.expect("asked")] {
        for [still, slow] in [
            [branch.rms[0], branch.rms[1]],
            [branch.peak_to_peak[0], branch.peak_to_peak[1]],
            [branch.load_factor[0], branch.load_factor[1]],
        ] {
            assert!((slow / still - 1.0).abs() < 1e-6, "{slow} {still}");
        }
    }
}

/// The natural frequencies of K v = ω² M v in rad/s, rising, without those of free motions.
fn natural(mass: &DMatrix<f64>, stiffness: &DMatrix<f64>) -> Vec<f64> {
    let factor = Cholesky::new(mass.clone()).expect("masses").l();
    let inverse = factor.try_inverse().expect("a triangle");
    let values = (&inverse * stiffness * inverse.transpose()).symmetric_eigenvalues();
    let mut found: Vec<f64> = values.iter().map(|value| value.max(0.0).sqrt()).collect();
    found.retain(|omega| *omega > 1e-6 * values.max().sqrt());
    found.sort_by(f64::total_cmp);
    found
}

fn assert_frequencies(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

const UNDAMPED: Damping = Damping {
    mesh: 0.0,
    bodies: 0.0,
};

/// A spring between the coordinates in `along`, added to `stiffness`.
fn spring(stiffness: &mut DMatrix<f64>, k: f64, along: &[(usize, f64)]) {
    let mut vector = DVector::zeros(stiffness.nrows());
    for (place, share) in along {
        vector[*place] += share;
    }
    *stiffness += k * &vector * vector.transpose();
}

#[test]
fn gears_on_their_shafts_vibrate_as_inertias_in_a_row() {
    let (inertias, radii, shafts, teeth) = ([3e-3, 8e-3], [0.04, 0.06], [2e4, 7e4], 3e8);
    let gear = |i: usize, shaft: f64| Body {
        inertia: inertias[i],
        base_radius: radii[i],
        modes: Vec::new(),
        waves: Vec::new(),
        mount: Mount {
            shaft,
            support: None,
        },
    };
    // Two gears between ends that turn evenly: λ² − λ (a/J₁ + b/J₂) + (a b − c²)/(J₁ J₂) = 0, a = k₁ + k r₁², b = k₂ + k r₂², c = k r₁ r₂.
    let coupled = Coupled::new(&[gear(0, shafts[0]), gear(1, shafts[1])], teeth, UNDAMPED);
    let (a, b) = (
        shafts[0] + teeth * radii[0] * radii[0],
        shafts[1] + teeth * radii[1] * radii[1],
    );
    let c = teeth * radii[0] * radii[1];
    let half = 0.5 * (a / inertias[0] + b / inertias[1]);
    let product = (a * b - c * c) / (inertias[0] * inertias[1]);
    let root = (half * half - product).sqrt();
    let expected = [(half - root).sqrt(), (half + root).sqrt()];
    assert_frequencies(&coupled.expect("bodies").frequencies, &expected);
    // One shaft: the gears turn as one on it, and nothing turns freely.
    let coupled = Coupled::new(&[gear(0, shafts[0]), gear(1, 0.0)], teeth, UNDAMPED);
    assert_eq!(coupled.expect("bodies").count(), 2);
    // Hub, rim, rim and hub in a row, hubs on their shafts.
    let rims = [1e-3, 2e-3];
    let webs = [4e5, 9e5];
    let bodies = [0, 1].map(|i: usize| {
        let mode = BodyMode {
            frequency: f64::sqrt(webs[i] / rims[i]),
            at_mesh: radii[i] / f64::sqrt(rims[i]),
            turn: f64::sqrt(rims[i]),
        };
        Body {
            modes: vec![mode],
            ..gear(i, shafts[i])
        }
    });
    let coupled = Coupled::new(&bodies, teeth, UNDAMPED).expect("bodies");
    let hubs = [0, 1].map(|i| inertias[i] - rims[i]);
    let mass = DMatrix::from_diagonal(&vec![hubs[0], rims[0], rims[1], hubs[1]].into());
    let mut stiffness = DMatrix::zeros(4, 4);
    spring(&mut stiffness, shafts[0], &[(0, 1.0)]);
    spring(&mut stiffness, webs[0], &[(0, 1.0), (1, -1.0)]);
    spring(&mut stiffness, teeth, &[(1, radii[0]), (2, -radii[1])]);
    spring(&mut stiffness, webs[1], &[(2, 1.0), (3, -1.0)]);
    spring(&mut stiffness, shafts[1], &[(3, 1.0)]);
    assert_frequencies(&coupled.frequencies, &natural(&mass, &stiffness));
}

/// Stiffness of an isotropic support, mass, polar inertia and shaft of both gears with a base radius of 1; the force on the driven gear stands at 25° to y.
const ON_SUPPORTS: [[f64; 4]; 2] = [[6.0, 2.0, 2.0, 0.4], [9.0, 3.0, 2.0, 0.3]];
const LINE: [f64; 2] = [0.422_618_261_740_699_44, 0.906_307_787_036_65];

fn on_supports() -> [Body; 2] {
    ON_SUPPORTS.map(|[support, m, inertia, shaft]| {
        let mut mass = SMatrix::<f64, 5, 5>::identity() * m;
        (mass[(3, 3)], mass[(4, 4)]) = (1.0, 1.0);
        let mut stiffness = Matrix6::zeros();
        (stiffness[(0, 0)], stiffness[(1, 1)]) = (support, support);
        Body {
            inertia,
            base_radius: 1.0,
            modes: Vec::new(),
            waves: Vec::new(),
            mount: Mount {
                shaft,
                support: Some(Support {
                    stiffness,
                    mass,
                    at_mesh: [LINE[0], LINE[1], 0.0, 0.0, 0.0],
                }),
            },
        }
    })
}

#[test]
fn gears_on_supports_vibrate_along_their_line_of_action_and_beside_it() {
    // In one frame for both: x₁, y₁, θ₁, x₂, y₂, θ₂ with the teeth between them. Beside the line of action each moves at √(k/m).
    let mut mass = DMatrix::zeros(6, 6);
    let mut stiffness = DMatrix::zeros(6, 6);
    for (gear, [support, m, inertia, shaft]) in ON_SUPPORTS.into_iter().enumerate() {
        for (i, m) in [m, m, inertia].into_iter().enumerate() {
            mass[(3 * gear + i, 3 * gear + i)] = m;
        }
        for (i, k) in [support, support, shaft].into_iter().enumerate() {
            spring(&mut stiffness, k, &[(3 * gear + i, 1.0)]);
        }
    }
    let [s, c] = LINE;
    let along = [(0, s), (1, c), (2, 1.0), (3, -s), (4, -c), (5, -1.0)];
    spring(&mut stiffness, 1.7, &along);
    let expected = natural(&mass, &stiffness);
    let coupled = Coupled::new(&on_supports(), 1.7, UNDAMPED).expect("bodies");
    let found = coupled.natural_frequencies();
    let found: Vec<f64> = found.iter().map(|hertz| 2.0 * PI * hertz).collect();
    assert_frequencies(&found, &expected);
    // The motions beside the line of action, and that of both gears along it at their common frequency, are listed and not carried.
    assert_eq!(coupled.count(), expected.len() - 3);
    for [support, m, _, _] in ON_SUPPORTS {
        let beside = f64::sqrt(support / m);
        let is_there = |omega: &&f64| (**omega / beside - 1.0).abs() < 1e-6;
        assert!(expected.iter().any(|omega| is_there(&omega)), "{beside}");
    }
}

#[test]
fn gears_on_shafts_and_supports_move_as_a_plain_integrator_moves_them() {
    // The classical Runge-Kutta method on both gears in one frame: displacements from the place of rest under the load.
    let wave = |eta: f64| 0.9 * (2.0 * PI * eta).cos() + 0.2 * (4.0 * PI * eta + 0.4).cos();
    let table = table(256, 4.0, wave, |eta| 1.0 + 0.2 * (2.0 * PI * eta).cos());
    let rest = table.transmission_error(1.0);
    let rest = rest.iter().sum::<f64>() / rest.len() as f64;
    let omegas = [0.35, 0.8, 1.4, 3.0];
    let asked = RunUpData {
        bodies: on_supports(),
        body_damping_ratio: 0.1,
        ..data(omegas.map(|w| w / (2.0 * PI)).to_vec(), 1.0, &[1.0])
    };
    let found = run_up(&asked, &table).up.expect("asked");
    let lost = &found.contact_lost;
    assert!(lost.contains(&true) && lost.contains(&false), "{lost:?}");
    for (place, omega) in omegas.into_iter().enumerate() {
        let approach = |q: &[f64]| LINE[0] * (q[0] - q[3]) + LINE[1] * (q[1] - q[4]) + q[2] - q[5];
        let rate = |t: f64, state: [f64; 12]| -> [f64; 12] {
            let (q, v) = state.split_at(6);
            let eta = omega * t / (2.0 * PI);
            let force = table.load(eta, rest + approach(q)) + 0.1 * approach(v) - 1.0;
            let mut rates = [0.0; 12];
            rates[..6].copy_from_slice(v);
            for (gear, sign) in [(0, -1.0), (1, 1.0)] {
                let [support, m, inertia, shaft] = ON_SUPPORTS[gear];
                let of = [
                    (support, m, LINE[0]),
                    (support, m, LINE[1]),
                    (shaft, inertia, 1.0),
                ];
                for (i, (k, m, along)) in of.into_iter().enumerate() {
                    let place = 3 * gear + i;
                    let damper = 2.0 * 0.1 * (k * m).sqrt();
                    rates[6 + place] =
                        (sign * along * force - k * q[place] - damper * v[place]) / m;
                }
            }
            rates
        };
        let see = |t: f64, s: [f64; 12]| {
            let eta = omega * t / (2.0 * PI);
            (s[2] - s[5], table.load(eta, rest + approach(&s[..6])))
        };
        let moved = settled_by_runge_kutta(2.0 * PI / omega, [256, 160, 40], [0.0; 12], rate, see);
        within_a_percent(&found, place, moved);
    }
}

#[test]
fn a_shaft_on_one_side_leaves_the_load_of_a_slow_mesh_and_two_shafts_share_its_error() {
    // Slowly: with one far end that turns evenly the load stays, and the hubs follow the static curve. With two, spring k in a row with both shafts, the
    // hubs follow it by c/(c + 1/k), c = Σ r²/k_s.
    let curve = |eta: f64| 0.02 * (2.0 * PI * eta).cos();
    let table = table(256, 2.0, curve, |_| 1.0);
    let of = |shafts: [f64; 2]| {
        let mut asked = data(vec![1e-5], 1.0, &[1.0]);
        for (body, shaft) in asked.bodies.iter_mut().zip(shafts) {
            body.mount.shaft = shaft;
        }
        let found = run_up(&asked, &table);
        at(&found, Order::new(1, 1))[0]
    };
    assert!((of([0.5, 0.0]) / 0.02 - 1.0).abs() < 1e-4);
    let c = 1.0 / 0.5 + 1.0 / 0.8;
    assert!((of([0.5, 0.8]) / (0.02 * c / (c + 1.0)) - 1.0).abs() < 1e-4);
}

/// Teeth of the gears whose bodies move in waves.
const TEETH: u32 = 12;

/// A mode of ω = 3 of two nodal diameters with Coriolis forces of a part 0.8, and one of ω = 5 without nodal diameters.
const WAVES: [BodyWave; 2] = [
    BodyWave {
        frequency: 3.0,
        at_mesh: 0.9,
        diameters: 2,
        split: 1.2,
    },
    BodyWave {
        frequency: 5.0,
        at_mesh: 1.1,
        diameters: 0,
        split: 0.0,
    },
];

/// By how much the modes yield.
const YIELD: f64 = 0.09 + 0.0484;

/// The driving gear has these modes; both turn as fast.
fn in_waves(speeds: Vec<f64>, orders: &[f64]) -> RunUpData {
    let mut data = data(speeds, 1.0, orders);
    data.tooth_count = TEETH;
    data.bodies[0].waves = WAVES.to_vec();
    data
}

#[test]
fn gears_in_waves_move_as_a_plain_integrator_moves_them_in_the_frame_of_the_gear() {
    // In the frame of the gear, past which the mesh runs, the first mode has a cosine and a sine: Q = q_c + i q_s. It obeys
    // Q'' + 2 ζ ω Q' + 2 i c Ω Q' + (ω² − c² Ω²) Q = −F φ e^{−inΩt}. The teeth move by φ Re(Q e^{inΩt}). The table is that of the teeth alone.
    let wave = |eta: f64| 0.3 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let whole = |eta: f64| 1.0 + 0.2 * (2.0 * PI * eta).cos();
    let of_all = table(256, 4.0, wave, whole);
    let of_teeth = table(256, 4.0, wave, |eta| whole(eta) - YIELD);
    let omegas = [0.5, 0.9, 1.4, 2.9, 3.4];
    let teeth = f64::from(TEETH);
    let speeds = omegas.map(|w| w / (2.0 * PI * teeth)).to_vec();
    let found = run_up(&in_waves(speeds, &[1.0]), &of_all)
        .up
        .expect("asked");
    assert!(found.contact_lost.contains(&true) && found.contact_lost.contains(&false));
    let [first, second] = WAVES;
    for (place, omega) in omegas.into_iter().enumerate() {
        let turn = omega / teeth;
        let (n, c) = (2.0, 2.0 - first.split);
        // Approach of the hubs, the two parts of Q and the second mode, then their rates.
        let at_teeth = |t: f64, s: &[f64]| {
            let (sin, cos) = (n * turn * t).sin_cos();
            s[0] + first.at_mesh * (s[1] * cos - s[2] * sin) + second.at_mesh * s[3]
        };
        let rate = |t: f64, s: [f64; 8]| -> [f64; 8] {
            let (x, v) = s.split_at(4);
            let (sin, cos) = (n * turn * t).sin_cos();
            // d/dt of Re(Q e^{inΩt}).
            let carried = n * turn * first.at_mesh * (-x[1] * sin - x[2] * cos);
            let nearer = at_teeth(t, v) + carried;
            let force = of_teeth.load(omega * t / (2.0 * PI), at_teeth(t, x)) + 0.1 * nearer;
            let own = first.frequency.powi(2) - (c * turn).powi(2);
            let damping = 0.04 * first.frequency;
            let pushed = force * first.at_mesh;
            [
                v[0],
                v[1],
                v[2],
                v[3],
                1.0 - force,
                -damping * v[1] + 2.0 * c * turn * v[2] - own * x[1] - pushed * cos,
                -damping * v[2] - 2.0 * c * turn * v[1] - own * x[2] + pushed * sin,
                -0.04 * second.frequency * v[3]
                    - second.frequency.powi(2) * x[3]
                    - force * second.at_mesh,
            ]
        };
        let rest = of_all.transmission_error(1.0)[0];
        let pushed = |mode: &BodyWave| -mode.at_mesh / mode.frequency.powi(2);
        let state = [
            rest,
            pushed(&first),
            0.0,
            pushed(&second),
            0.0,
            0.0,
            0.0,
            0.0,
        ];
        let see = |t: f64, s: [f64; 8]| {
            let force = of_teeth.load(omega * t / (2.0 * PI), at_teeth(t, &s));
            (s[0], force)
        };
        let moved = settled_by_runge_kutta(2.0 * PI / omega, [512, 160, 40], state, rate, see);
        within_a_percent(&found, place, moved);
    }
}

/// The amplitude of the hubs over that of the static curve at the circular frequency `omega` of the mesh, with the stiffness `k` of the teeth alone: the first of
/// [`WAVES`] by its response in the frame of the gear at the frequencies ω ∓ nΩ.
fn direct(omega: f64, k: f64) -> f64 {
    let i = Complex::<f64>::i();
    let turn = omega / f64::from(TEETH);
    let [first, second] = WAVES;
    let (n, c) = (2.0, 2.0 - first.split);
    let answer = |lambda: f64| {
        let own = first.frequency.powi(2) - (c * turn).powi(2);
        1.0 / (own - lambda * lambda - 2.0 * c * turn * lambda
            + i * 0.04 * first.frequency * lambda)
    };
    let around = 0.5 * (answer(omega - n * turn) + answer(-omega - n * turn).conj());
    let alone =
        1.0 / (second.frequency.powi(2) - omega * omega + i * 0.04 * second.frequency * omega);
    let hubs = Complex::from(-1.0 / (omega * omega));
    let teeth = hubs + first.at_mesh.powi(2) * around + second.at_mesh.powi(2) * alone;
    (hubs * k / (1.0 + (k + i * 0.1 * omega) * teeth)).norm()
}

#[test]
fn a_linear_mesh_of_gears_in_waves_answers_by_its_direct_frequency_response() {
    // Constant stiffness, at 20 speeds, and the static curve at speed 0.
    let curve = |eta: f64| 0.02 * (2.0 * PI * eta).cos();
    let table = table(256, 2.0, curve, |_| 1.0);
    let omegas: Vec<f64> = (0..=20).map(|i| 0.28 * f64::from(i)).collect();
    let turns = |omega: &f64| omega / (2.0 * PI * f64::from(TEETH));
    let found = run_up(
        &in_waves(omegas.iter().map(turns).collect(), &[1.0]),
        &table,
    );
    let amplitudes = at(&found, Order::new(1, 1));
    assert!((amplitudes[0] / 0.02 - 1.0).abs() < 1e-6);
    for (omega, amplitude) in omegas.iter().zip(amplitudes).skip(1) {
        let expected = 0.02 * direct(*omega, 1.0 / (1.0 - YIELD));
        assert!(
            (amplitude / expected - 1.0).abs() < 0.01,
            "{omega}: {amplitude} {expected}"
        );
    }
    // Each largest answer is a resonance, and nothing else is.
    let mut told: Vec<f64> = found.resonances.iter().map(|each| each.speed).collect();
    told.sort_by(f64::total_cmp);
    let answers: Vec<(f64, f64)> = (1..5600)
        .map(|i| 1e-3 * f64::from(i))
        .map(|omega| (omega, direct(omega, 1.0 / (1.0 - YIELD))))
        .collect();
    let peaks = answers
        .windows(3)
        .filter(|three| three[1].1 > three[0].1.max(three[2].1));
    let peaks: Vec<f64> = peaks.map(|three| turns(&three[1].0)).collect();
    assert_eq!(told.len(), peaks.len(), "{told:?} {peaks:?}");
    assert!(peaks.len() >= 4, "{peaks:?}");
    for (told, peak) in told.iter().zip(&peaks) {
        assert!((told / peak - 1.0).abs() < 0.01, "{told} {peak}");
    }
}

#[test]
fn a_mesh_meets_a_mode_where_the_campbell_diagram_has_it() {
    // A mode that hardly moves the teeth leaves its frequency f to itself. Order 1 of 12 teeth meets it at f/(z ± (n − c)): a thin ring that bends in its plane,
    // c = 2n/(n² + 1), a disc out of it, c = 0, and at f/z alone the translation of a rigid rim, c = n = 1.
    let table = table(256, 2.0, |eta| 0.02 * (2.0 * PI * eta).cos(), |_| 1.0);
    for (n, coriolis) in [(3, 0.6), (2, 0.0), (1, 1.0)] {
        let split = f64::from(n) - coriolis;
        let frequency = 3.0;
        let z = f64::from(TEETH);
        let meets = |by: f64| frequency / (2.0 * PI * (z + by));
        let speeds = (0..60).map(|i| meets(0.0) * (0.7 + 0.01 * f64::from(i)));
        let mut data = in_waves(speeds.collect(), &[1.0]);
        data.bodies[0].waves = vec![BodyWave {
            frequency,
            at_mesh: 0.12,
            diameters: n,
            split,
        }];
        data.body_damping_ratio = 1e-3;
        let found = run_up(&data, &table);
        let mut told: Vec<f64> = found.resonances.iter().map(|each| each.speed).collect();
        told.sort_by(f64::total_cmp);
        let mut expected = vec![meets(split), meets(-split)];
        expected.dedup();
        assert_eq!(told.len(), expected.len(), "{n}: {told:?} {expected:?}");
        for (told, expected) in told.iter().zip(expected) {
            assert!(
                (told / expected - 1.0).abs() < 5e-3,
                "{n}: {told} {expected}"
            );
        }
    }
}

#[test]
fn a_slow_mesh_of_gears_in_waves_follows_its_static_curve() {
    let wave = |eta: f64| 0.3 * (2.0 * PI * eta).cos() + 0.1 * (4.0 * PI * eta + 0.4).cos();
    let table = table(64, 2.0, wave, |eta| 1.0 + 0.2 * (2.0 * PI * eta).cos());
    let found = run_up(&in_waves(vec![0.0, 1e-8], &[1.0, 2.0]), &table);
    let branch = found.up.expect("asked");
    for [still, slow] in [
        [branch.rms[0], branch.rms[1]],
        [branch.peak_to_peak[0], branch.peak_to_peak[1]],
        [branch.load_factor[0], branch.load_factor[1]],
    ] {
        assert!((slow / still - 1.0).abs() < 1e-6, "{slow} {still}");
    }
}

#[test]
fn without_damping_waves_of_gears_that_turn_neither_grow_nor_decay() {
    // Coriolis forces do no work. Over a period all multipliers have the modulus 1: none is larger, and their product is 1.
    let mut bodies = in_waves(vec![1.0], &[1.0]).bodies;
    bodies[1].waves = vec![WAVES[0]];
    let coupled = Coupled::new(&bodies, 1.5, UNDAMPED).expect("bodies");
    let laws = Laws::new(vec![-3.0, 3.0], vec![-4.0 / 1.5, 2.0 / 1.5], 0);
    let drift = Drift {
        law: 0,
        deflection: [0.0; 2],
    };
    for turn in [0.0, 0.1, 0.7] {
        let motion = CoupledMotion::new((&laws, 1.0), (&coupled, turn), (0.13, 2), vec![drift; 64]);
        let size = motion.size();
        assert_eq!(size, 2 * coupled.count());
        let mut derivative: Vec<Vec<f64>> = (0..size)
            .map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect())
            .collect();
        motion.over_period(&mut vec![0.0; size], Some(&mut derivative), &mut |_| ());
        assert!((multiplier(&derivative) - 1.0).abs() < 1e-8);
        let matrix = DMatrix::from_fn(size, size, |i, j| derivative[j][i]);
        assert!((matrix.determinant() - 1.0).abs() < 1e-8);
    }
}

#[test]
fn of_more_modes_than_there_may_be_those_stay_by_which_a_body_yields_most() {
    let wave = |at_mesh: f64, frequency: f64| BodyWave {
        frequency,
        at_mesh,
        diameters: 2,
        split: 2.0,
    };
    let [most, more, little, least] = [(3.0, 1.0), (2.0, 1.0), (1.0, 2.0), (1e-3, 1.0)];
    let waves = [little, most, least, more].map(|(at_mesh, omega)| wave(at_mesh, omega));
    let mut body = hub_and_rim(2e-4, 5e-4, 3e5);
    body.add_waves(&waves, (1e-5, 8));
    assert_eq!(body.waves, [waves[0], waves[1], waves[3]]);
    // The first in torsion has its place whatever it yields.
    body.add_waves(&waves, (1e-5, 3));
    assert_eq!(body.waves, [waves[1], waves[3]]);
    assert_eq!(body.modes.len(), 1);
    assert!((body.compliance() - 13.0 - 1.0 / 3e5).abs() < 1e-12);
}
