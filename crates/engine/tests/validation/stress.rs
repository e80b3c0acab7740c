//! The largest stresses at roots and holes, settled with the grid; `tests/reference` has them against CalculiX.

use meshwright_engine::analysis::stress::PeakStress;
use meshwright_engine::grid::GridLevel;

use crate::support::{gear, holed, pair, paper_case, relieved, stressed, stresses};

fn largest(peaks: &[PeakStress]) -> f64 {
    peaks.iter().map(|peak| peak.stress).fold(0.0, f64::max)
}

#[test]
#[ignore = "./test all"]
fn peaks_at_roots_and_holes_settle_from_the_standard_to_the_fine_level() {
    for number in [1, 2, 3] {
        let [standard, fine] = [GridLevel::Standard, GridLevel::Fine].map(|level| {
            let (pair, torque) = paper_case(number);
            stressed(pair, torque, 8, level)
        });
        for (standard, fine) in stresses(&standard).iter().zip(stresses(&fine)) {
            for (name, standard, fine) in [
                ("root", &standard.root, &fine.root),
                ("hole", &standard.holes, &fine.holes),
            ] {
                for (standard, fine) in standard.iter().zip(fine) {
                    let off = standard.stress / fine.stress - 1.0;
                    println!(
                        "case {number} {name}: {:.2} MPa, {off:+.4}",
                        fine.stress / 1e6
                    );
                    assert!(off.abs() < 0.02);
                }
            }
        }
    }
}

#[test]
fn a_gear_half_as_wide_under_half_the_torque_is_stressed_alike() {
    let of = |width: f64, torque: f64| {
        let mut data = holed(relieved(gear(50, 15e-3)), 8, 34e-3, 8e-3, 0.1);
        data.face_width = width;
        stressed(
            pair(data.clone(), data, 100.5e-3),
            torque,
            4,
            GridLevel::Coarse,
        )
    };
    let (whole, half) = (of(20e-3, 100.0), of(10e-3, 50.0));
    for (whole, half) in stresses(&whole).iter().zip(stresses(&half)) {
        let peaks = whole.root.iter().chain(&whole.holes);
        for (a, b) in peaks.zip(half.root.iter().chain(&half.holes)) {
            assert!((a.stress / b.stress - 1.0).abs() < 1e-6);
        }
        assert!(largest(&whole.holes) > 1e6 && largest(&whole.root) > 50e6);
    }
}

#[test]
fn holes_are_stressed_alike_as_a_pattern_and_as_a_list_and_nothing_is_said_without_them() {
    let solid = relieved(gear(50, 15e-3));
    let pattern = holed(solid.clone(), 6, 32e-3, 8e-3, 0.2);
    let mut list = pattern.clone();
    // One of them larger by nothing that shows makes the blank unlike itself at every turn.
    if let meshwright_engine::gear::HoleShape::Round { radius } = &mut list.blank.holes[3].shape {
        *radius += 1e-9;
    }
    let [one, other] = [pattern, list].map(|driven| {
        stressed(
            pair(solid.clone(), driven, 100.5e-3),
            115.0,
            4,
            GridLevel::Standard,
        )
    });
    assert!(stresses(&one)[0].holes.is_empty());
    for (a, b) in stresses(&one)[1]
        .holes
        .iter()
        .zip(&stresses(&other)[1].holes)
    {
        println!(
            "{:.3} MPa, as a whole {:.3}",
            a.stress / 1e6,
            b.stress / 1e6
        );
        assert!((a.stress / b.stress - 1.0).abs() < 0.02);
        assert!((a.angle - b.angle).abs() < 0.03);
    }
}
