//! The largest stresses at roots and holes, settled with the grid; `tests/reference` has them against CalculiX.

use meshwright_engine::analysis::stress::PeakStress;
use meshwright_engine::gear::{Material, SpurGear};
use meshwright_engine::grid::{GridLevel, ToothGrid};
use meshwright_engine::substructures::{Functional, Load, displacements, edge_stresses};

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

/// Radii and stresses along the loaded fillet and the other one, of a tooth that is held on its interface circle and loaded at the roll length `s`.
fn along_fillets(section: &SpurGear, grid: &ToothGrid, s: f64) -> [Vec<[f64; 2]>; 2] {
    let rolls = &grid.flank_roll_lengths;
    let after = rolls.partition_point(|roll| *roll < s);
    let part = (s - rolls[after - 1]) / (rolls[after] - rolls[after - 1]);
    let force = -1e5 * section.flank().normal(s);
    let on = |place: usize, share: f64| {
        let force = force * share;
        (grid.flank_nodes[place], force.as_slice().to_vec())
    };
    let load = Load {
        moves: vec![0.0; 2 * grid.arc_nodes.len()],
        forces: vec![on(after - 1, 1.0 - part), on(after, part)],
    };
    let plate = (&Material::STEEL, 1.0);
    let moved = displacements("a tooth", &grid.grid, plate, &grid.arc_nodes, &[load]);
    let moved = &moved.expect("sound")[0];
    [&grid.fillet_nodes, &grid.back_fillet_nodes].map(|side| {
        let stresses = edge_stresses(&grid.grid, &Material::STEEL, side, false);
        let radii = side
            .iter()
            .map(|node| grid.grid.nodes[*node as usize].norm());
        let of = |(radius, of): (f64, Functional)| [radius, of.value(moved)];
        radii.zip(stresses).map(of).collect()
    })
}

#[test]
fn both_fillets_of_a_tooth_along_its_face_are_stressed_as_on_a_finer_grid() {
    // The fine grid of the plane has seventeen times the nodes; it differs from the standard one by 0.6 %.
    let section = SpurGear::new(gear(40, 20e-3)).expect("can be made");
    let section = section.without_blank();
    let (root, form, tip) = (
        section.root_radius(),
        section.form_roll_length(),
        section.tip_roll_length(),
    );
    let radius = root - 2e-3;
    let coarse = ToothGrid::of_stressed_prism(&section, radius, GridLevel::Standard);
    let fine = ToothGrid::new(&section, radius, GridLevel::Fine);
    let [coarse, fine] = [coarse, fine].map(|grid| grid.expect("a usable grid"));
    for part in [0.35, 0.7] {
        let s = form + part * (tip - form);
        let fillets = along_fillets(&section, &coarse, s);
        for (found, expected) in fillets.iter().zip(along_fillets(&section, &fine, s)) {
            let largest = expected.iter().map(|[_, s]| s.abs()).fold(0.0, f64::max);
            // From a tenth of a module above the root land, where one stands at each radius, up to the load's own stresses.
            let compared = found
                .iter()
                .filter(|[radius, _]| (root + 0.2e-3..root + 0.8e-3).contains(radius));
            let mut count = 0;
            for [radius, stress] in compared {
                let after = expected.iter().position(|[other, _]| other <= radius);
                let after = after.expect("fillets go down to the root");
                let [[outer, one], [inner, other]] = [expected[after - 1], expected[after]];
                let between = one + (other - one) * (outer - radius) / (outer - inner);
                let off = (stress - between).abs() / largest;
                assert!(off < 0.04, "{part} {radius}: {stress} {between} {off}");
                count += 1;
            }
            assert!(count >= 4, "{count}");
        }
    }
}
