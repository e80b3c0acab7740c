//! What halving every element and every contact cell changes, through the public grid levels, and how smooth the curves
//! are between positions.

use meshwright_engine::analysis::Curve;
use meshwright_engine::gear::GearPair;
use meshwright_engine::grid::GridLevel;
use nalgebra::{DMatrix, DVector};

use crate::support::{case, gear, holed, pair, paper_case, solve, standard_pair};

/// How far the curves of one level may be from those of the fine one, relative.
struct Bounds {
    mean: f64,
    peak_to_peak: f64,
    rms: f64,
    mean_stiffness: f64,
    mesh_harmonic: f64,
}

/// What the coarse level promises, in its documentation and in that of the field `grid`.
const COARSE: Bounds = Bounds {
    mean: 2e-3,
    peak_to_peak: 2e-2,
    rms: 2e-2,
    mean_stiffness: 3e-3,
    mesh_harmonic: 4e-2,
};

/// What the standard level promises. Asked for were 0.1 %, 1 %, 0.5 % of the mean stiffness and 1 % of the harmonics.
const STANDARD: Bounds = Bounds {
    mean: 3e-4,
    peak_to_peak: 5e-3,
    rms: 5e-3,
    mean_stiffness: 1e-3,
    mesh_harmonic: 1e-2,
};

/// The part of the largest mesh harmonic below which a harmonic is held to the bound as a part of the largest one instead of
/// its own. Where the contact of a tip corner sets in, the levels differ by 3 nm at single positions; that is 0.7 nm in
/// each harmonic, and 3 % of the second one of cases 1 and 2, which at 38 and 24 nm nearly cancels beside the 317 and 270 nm
/// of the first. (Standard pair: 2.7 nm beside 231 nm.)
const SMALL_HARMONIC: f64 = 0.2;

fn at(pair: GearPair, torques: &[f64], level: GridLevel) -> Vec<Curve> {
    let mut case = case(pair, torques);
    case.resolution.grid = level;
    solve(&case).curves
}

/// Amplitudes of the first three harmonics of the mesh.
fn mesh_harmonics(curve: &Curve) -> [f64; 3] {
    let spectrum = curve.spectrum.as_ref().expect("whole periods");
    ["H_Z2", "H_2Z2", "H_3Z2"].map(|label| {
        spectrum
            .line(label)
            .expect("a named line")
            .transmission_error
    })
}

/// Prints how far `curve` is from that of the fine level, and holds it to `bounds`.
fn compare(name: &str, curve: &Curve, fine: &Curve, bounds: &Bounds) {
    let change = |value: fn(&Curve) -> f64| value(curve) / value(fine) - 1.0;
    let mean = change(|curve| curve.transmission_error_statistics.mean);
    let peak_to_peak = change(|curve| curve.transmission_error_statistics.peak_to_peak);
    let rms = change(|curve| curve.transmission_error_statistics.rms);
    let stiffness = change(|curve| curve.mesh_stiffness_tangent_statistics.mean);
    let (harmonics, fine_harmonics) = (mesh_harmonics(curve), mesh_harmonics(fine));
    let largest = fine_harmonics.iter().copied().fold(0.0, f64::max);
    let harmonics = harmonics.map(|amplitude| amplitude / largest);
    let fine_harmonics = fine_harmonics.map(|amplitude| amplitude / largest);
    let changes: [f64; 3] = std::array::from_fn(|i| {
        let against = Some(fine_harmonics[i]).filter(|part| *part > SMALL_HARMONIC);
        (harmonics[i] - fine_harmonics[i]) / against.unwrap_or(1.0)
    });
    println!(
        "{name}: mean {mean:+.2e}, p-p {peak_to_peak:+.2e}, rms {rms:+.2e}, mean k {stiffness:+.2e}, H_kZ2 {changes:+.4?} of \
         {fine_harmonics:.4?} times {largest:.3e} m"
    );
    assert!(mean.abs() < bounds.mean, "{name}");
    assert!(peak_to_peak.abs() < bounds.peak_to_peak, "{name}");
    assert!(rms.abs() < bounds.rms, "{name}");
    assert!(stiffness.abs() < bounds.mean_stiffness, "{name}");
    for change in changes {
        assert!(change.abs() < bounds.mesh_harmonic, "{name}: {changes:?}");
    }
}

fn check(name: &str, pair: GearPair, torques: &[f64]) {
    let [coarse, standard, fine] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine]
        .map(|level| at(pair.clone(), torques, level));
    for (i, torque) in torques.iter().enumerate() {
        let name = format!("{name}, T {torque}");
        compare(&format!("{name}, coarse"), &coarse[i], &fine[i], &COARSE);
        compare(
            &format!("{name}, standard"),
            &standard[i],
            &fine[i],
            &STANDARD,
        );
    }
}

#[test]
#[ignore = "./test all"]
fn halving_every_element_moves_the_curves_of_case_1_by_less_than_promised() {
    let (pair, torque) = paper_case(1);
    check("case 1", pair, &[torque]);
}

#[test]
#[ignore = "./test all"]
fn halving_every_element_moves_the_curves_of_case_2_by_less_than_promised() {
    let (pair, torque) = paper_case(2);
    check("case 2", pair, &[torque]);
}

#[test]
#[ignore = "./test all"]
fn halving_every_element_moves_the_curves_of_case_3_by_less_than_promised() {
    let (pair, torque) = paper_case(3);
    check("case 3", pair, &[torque]);
}

#[test]
#[ignore = "./test all"]
fn halving_every_element_moves_the_curves_of_large_gears_by_less_than_promised() {
    // Blanks of more than a hundred teeth are divided by their holes, here once near the rim and once far from it.
    for (circle_radius, radius) in [(165e-3, 26e-3), (105e-3, 24e-3)] {
        let driven = holed(gear(200, 16e-3), 8, circle_radius, radius, 0.01);
        let pair = pair(gear(200, 16e-3), driven, 400.5e-3);
        check(&format!("holes at {circle_radius} m"), pair, &[400.0]);
    }
}

#[test]
fn halving_every_element_moves_the_curves_of_the_standard_pair_by_less_than_promised() {
    check("standard pair", standard_pair(true), &[115.0, 20.0]);
}

/// The largest difference of `values` from their best fourth-order polynomial.
fn ripple(values: &[f64]) -> f64 {
    let n = values.len();
    let place = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let powers = DMatrix::from_fn(n, 5, |i, power| place(i).powi(power as i32));
    let y = DVector::from_column_slice(values);
    let fit = powers
        .clone()
        .svd(true, true)
        .solve(&y, 1e-14)
        .expect("both sides were asked for");
    (powers * fit - y).amax()
}

#[test]
#[ignore = "./test all"]
fn plateaus_of_the_curves_have_no_ripple() {
    // Where the number of pairs does not change, away from tip corners, the curves are smooth; 400 positions a period
    // see what moves with the cells and the elements.
    for (name, relief, torque, from, to) in [
        ("with relief", true, 115.0, 0.30, 0.70),
        ("with relief", true, 20.0, 0.05, 0.35),
        ("without relief", false, 115.0, 0.30, 0.70),
    ] {
        let mut case = case(standard_pair(relief), &[torque]);
        case.resolution.positions_per_mesh_period = 400;
        let curve = &solve(&case).curves[0];
        let plateau = (0..400).filter(|i| (from..=to).contains(&curve.mesh_position[*i]));
        let plateau: Vec<usize> = plateau.collect();
        let of = |values: &[f64]| plateau.iter().map(|i| values[*i]).collect::<Vec<f64>>();
        let delta = ripple(&of(&curve.transmission_error));
        let stiffness = of(&curve.mesh_stiffness_tangent);
        let mean = stiffness.iter().sum::<f64>() / stiffness.len() as f64;
        let k = ripple(&stiffness) / mean;
        println!(
            "{name}, T {torque}: ripple {:.3} nm and {:.4} % of k",
            delta * 1e9,
            k * 100.0
        );
        assert!(delta < 5e-9);
        assert!(k < 5e-3);
    }
}
