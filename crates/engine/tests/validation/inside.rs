//! Stresses inside a whole gear by recovery rows against the same gear solved whole.

use meshwright_engine::gear::{Core, SpurGear};
use meshwright_engine::grid::{BlankGrid, GridLevel, ToothGrid};
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{
    BlankSubstructure, Harmonics, InterfaceMotion, PlainGear, TeethRecovery, TeethRing,
    ToothSubstructure, default_interface_radius, edge_stresses, modal_loads, tooth_angle,
};

use crate::support::{gear, holed};
use crate::whole::WholeGear;

/// Teeth of which two are loaded, on a blank with three holes.
const LOADED: [usize; 2] = [0, 1];

struct Stresses {
    /// Along the fillets of the teeth asked, each from the form point down.
    fillets: Vec<Vec<f64>>,
    /// Along the edge of each hole.
    holes: Vec<Vec<f64>>,
}

fn small() -> SpurGear {
    SpurGear::new(holed(gear(18, 6e-3), 3, 10.5e-3, 2e-3, 0.21)).expect("a small gear")
}

/// A force on the flank node nearest to `part` of the flank, along the inward normal, in N.
fn flank_forces(tooth: &ToothGrid, part: f64) -> Vec<f64> {
    let s = &tooth.flank_roll_lengths;
    let target = s[0] + part * (s[s.len() - 1] - s[0]);
    let apart = |i: &usize| (s[*i] - target).abs();
    let nearest = (0..s.len())
        .min_by(|a, b| apart(a).total_cmp(&apart(b)))
        .expect("nodes");
    let mut forces = vec![0.0; 2 * s.len()];
    forces[2 * nearest] = -1000.0;
    forces
}

fn grids(gear: &SpurGear, level: GridLevel) -> (ToothGrid, BlankGrid) {
    let r_w = default_interface_radius(gear);
    let blank = BlankGrid::new(
        gear.bore_radius(),
        r_w,
        gear.hole_pattern().as_ref(),
        gear.tooth_count(),
        6.0,
        level,
    );
    (
        ToothGrid::new(gear, r_w, level).expect("a tooth"),
        blank.expect("a blank"),
    )
}

fn by_recovery(level: GridLevel, teeth: &[usize], orders: (usize, usize)) -> Stresses {
    let (gear, run) = (small(), Run::unattended());
    let (tooth_grid, blank_grid) = grids(&gear, level);
    let fillet = edge_stresses(
        &tooth_grid.grid,
        gear.material(),
        &tooth_grid.fillet_nodes,
        false,
    );
    let (tooth, rows) =
        ToothSubstructure::with_recovery(&gear, &tooth_grid, &fillet).expect("a tooth");
    let (harmonics, low) = (
        Harmonics { largest: orders.0 },
        Harmonics { largest: orders.1 },
    );
    let ring = TeethRing::new(&tooth, harmonics, &run).expect("a ring");
    let inside = TeethRecovery::new(&tooth, &rows, harmonics, &run).expect("a ring");
    let edge = edge_stresses(
        &blank_grid.grid,
        gear.material(),
        &blank_grid.hole_edges[0],
        true,
    );
    let (r_w, plate) = (
        default_interface_radius(&gear),
        (Core::Bore, gear.material(), gear.face_width()),
    );
    let (blank, around) =
        BlankSubstructure::with_recovery(&blank_grid, r_w, plate, low, &edge, &run)
            .expect("a blank");
    let solid_grid = BlankGrid::new(gear.bore_radius(), r_w, None, 18, 6.0, level).expect("a ring");
    let solid =
        BlankSubstructure::new(&solid_grid, r_w, plate.1, plate.2, harmonics, &run).expect("solid");

    let forces = [0.35, 0.8].map(|part| flank_forces(&tooth_grid, part));
    let loads: Vec<_> = LOADED
        .into_iter()
        .zip(forces.iter().map(|p| modal_loads(&tooth.modes, p)))
        .collect();
    let plain = PlainGear::new(&ring, &solid, &run).expect("a gear");
    let motion = InterfaceMotion::new(&ring, &plain, Some((&blank, 0.21)), &run)
        .expect("a gear")
        .under(&loads);
    let none = vec![0.0; forces[0].len()];
    let own = |tooth: usize| {
        LOADED
            .iter()
            .position(|t| *t == tooth)
            .map_or(&none, |i| &forces[i])
    };
    Stresses {
        fillets: teeth
            .iter()
            .map(|t| inside.values(*t, own(*t), &loads, &motion))
            .collect(),
        holes: (0..3)
            .map(|hole| around.values(hole, 0.21, &motion))
            .collect(),
    }
}

/// The same on the whole gear without condensation.
fn by_the_whole(level: GridLevel, teeth: &[usize], orders: usize) -> Stresses {
    let gear = small();
    let (tooth, blank) = grids(&gear, level);
    let plate = (gear.material(), gear.face_width());
    let fillet = edge_stresses(&tooth.grid, gear.material(), &tooth.fillet_nodes, false);
    let forces = [0.35, 0.8].map(|part| flank_forces(&tooth, part));
    let whole = WholeGear::new(tooth.clone(), 18, &blank, 0.21, orders, plate);
    let mut nodal = whole.no_forces();
    for (loaded, forces) in LOADED.into_iter().zip(&forces) {
        for (i, force) in forces.chunks(2).enumerate() {
            let t =
                gear.flank().tangent_angle(tooth.flank_roll_lengths[i]) + tooth_angle(loaded, 18);
            nodal[whole.flank_node(loaded, i) as usize] +=
                force[0] * meshwright_engine::gear::tangential(t);
        }
    }
    let u = &whole.whole.solve(&[nodal])[0];
    // Strains along an edge do not change as it turns with its tooth or sector.
    let along = |stresses: &[meshwright_engine::substructures::Functional],
                 numbers: &[u32],
                 turn: f64| {
        let back: Vec<_> = (0..numbers.len())
            .map(|local| {
                let u = u[numbers[local] as usize];
                let (sin, cos) = turn.sin_cos();
                meshwright_engine::gear::Vector::new(cos * u.x + sin * u.y, cos * u.y - sin * u.x)
            })
            .collect();
        stresses
            .iter()
            .map(|stress| stress.value(&back))
            .collect::<Vec<f64>>()
    };
    let edge = edge_stresses(&blank.grid, gear.material(), &blank.hole_edges[0], true);
    let turn = std::f64::consts::TAU / 3.0;
    Stresses {
        fillets: teeth
            .iter()
            .map(|t| along(&fillet, &whole.teeth[*t], tooth_angle(*t, 18)))
            .collect(),
        holes: (0..3)
            .map(|hole| along(&edge, &whole.sectors[hole], 0.21 + turn * hole as f64))
            .collect(),
    }
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, s| most.max(s.abs()))
}

#[test]
#[ignore = "./test all"]
fn fillets_and_hole_edges_are_stressed_as_in_the_whole_gear() {
    let teeth = [0, 1, 2, 17, 9];
    let (found, expected) = (
        by_recovery(GridLevel::Coarse, &teeth, (36, 36)),
        by_the_whole(GridLevel::Coarse, &teeth, 36),
    );
    let pairs = found.fillets.iter().zip(&expected.fillets);
    for (i, (found, expected)) in pairs
        .chain(found.holes.iter().zip(&expected.holes))
        .enumerate()
    {
        let off = found
            .iter()
            .zip(expected)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        println!(
            "place {i}: up to {:.2} MPa, off by {:.1e} of it",
            peak(expected) / 1e6,
            off / peak(expected)
        );
        // The loading modes keep eleven digits, of which strains lose some.
        assert!(off < 1e-6 * peak(&expected.clone()).max(1e5));
    }
}

#[test]
fn orders_that_do_not_see_the_holes_may_be_solved_apart() {
    let teeth = [0, 2];
    let (apart, together) = (
        by_recovery(GridLevel::Coarse, &teeth, (36, 30)),
        by_recovery(GridLevel::Coarse, &teeth, (36, 36)),
    );
    for (a, b) in apart
        .fillets
        .iter()
        .chain(&apart.holes)
        .zip(together.fillets.iter().chain(&together.holes))
    {
        let off = a
            .iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
            / peak(b);
        println!("off by {off:.1e}");
        assert!(off < 0.01);
    }
}
