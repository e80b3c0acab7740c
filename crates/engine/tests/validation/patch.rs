//! Patch tests of the coupled gear.
//!
//! What is proven: a rigid motion of the interface circle costs the floating ring of teeth nothing, and carries the flanks
//! rigidly through the loading modes; a gear with teeth and holes follows its bore rigidly, through all couplings, without
//! strain; and a field of constant strain passes from one grid to another through the harmonics alone, exactly where their
//! boundaries are alike and to the fourth order of the elements' length where they share no node. (A toothed ring has no field of constant strain without tractions on its flanks, and the blank's
//! substructure holds its bore; so the linear field is imposed on two rings of the blank's own elements.)

use meshwright_engine::gear::{Material, SpurGear, Vector, radial};
use meshwright_engine::grid::{BlankGrid, GridLevel, ToothGrid};
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{
    Component, Harmonics, TeethRing, ToothSubstructure, default_interface_radius,
};

use crate::support::{gear, holed};
use crate::whole::{Assembly, Hold, Whole, WholeGear, on_circle, whole_sides};

/// Amplitudes of a translation by (x, y), and of a rotation that moves the interface circle by `turn` along itself.
fn rigid(harmonics: &Harmonics, x: f64, y: f64, turn: f64) -> Vec<f64> {
    use Component::{Radial, Tangential};
    let mut amplitudes = vec![0.0; harmonics.unknowns()];
    amplitudes[harmonics.cosine(0, Tangential)] = turn;
    // u_r = x cos θ + y sin θ, u_t = −x sin θ + y cos θ; the sine stands two places after the cosine.
    amplitudes[harmonics.cosine(1, Radial)] = x;
    amplitudes[harmonics.cosine(1, Radial) + 2] = y;
    amplitudes[harmonics.cosine(1, Tangential)] = y;
    amplitudes[harmonics.cosine(1, Tangential) + 2] = -x;
    amplitudes
}

#[test]
fn a_rigid_motion_of_the_interface_circle_costs_nothing_and_carries_the_flanks() {
    for (z, bore) in [(18, 6e-3), (29, 10e-3)] {
        let gear = SpurGear::new(gear(z, bore)).expect("a gear");
        let r_w = default_interface_radius(&gear);
        let grid = ToothGrid::new(&gear, r_w, GridLevel::Coarse).expect("a tooth");
        let tooth = ToothSubstructure::new(&gear, &grid).expect("a tooth");
        let harmonics = Harmonics {
            largest: 2 * z as usize,
        };
        let ring = TeethRing::new(&tooth, harmonics, &Run::unattended()).expect("teeth");
        let n = harmonics.unknowns();
        let stiffest = (0..n).map(|i| ring.stiffness[(i, i)]).fold(0.0, f64::max);
        for (x, y, turn) in [
            (1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0),
            (0.0, 0.0, 1.0),
            (0.3, -0.8, 0.5),
        ] {
            let motion = rigid(&harmonics, x, y, turn);
            let largest_force = (0..n)
                .map(|i| {
                    (0..n)
                        .map(|j| ring.stiffness[(i, j)] * motion[j])
                        .sum::<f64>()
                        .abs()
                })
                .fold(0.0, f64::max);
            println!("Z {z}: {:.1e} of the stiffness", largest_force / stiffest);
            // Rounding of a condensation that takes off springs as stiff as the rim.
            assert!(largest_force < 1e-9 * stiffest);

            // V Fᵀ q: what the motion of the circle does to the flank of a tooth.
            for i in [0, 7] {
                let angle = 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(z);
                let orders: Vec<usize> = (0..=ring.harmonics.largest).collect();
                let forces = ring.patterns_of_tooth_at(angle, &orders) * &ring.pattern_shares;
                let modal: Vec<f64> = (0..forces.ncols())
                    .map(|mode| (0..n).map(|row| forces[(row, mode)] * motion[row]).sum())
                    .collect();
                let worst = tooth
                    .flank_points
                    .iter()
                    .zip(&tooth.roll_lengths)
                    .enumerate()
                    .map(|(node, (point, s))| {
                        let moved: Vec<f64> = (0..2)
                            .map(|c| {
                                modal
                                    .iter()
                                    .enumerate()
                                    .map(|(m, a)| tooth.modes[(2 * node + c, m)] * a)
                                    .sum()
                            })
                            .collect();
                        let (e_x, e_y) = (radial(angle), Vector::new(-angle.sin(), angle.cos()));
                        let u = Vector::new(x, y);
                        // In the tooth's frame: the translation turned back, and the rotation about the center.
                        let u = Vector::new(u.dot(&e_x), u.dot(&e_y))
                            + turn / r_w * Vector::new(-point.y, point.x);
                        let t = gear.flank().tangent_angle(*s);
                        let (normal, to_tip) = (Vector::new(-t.sin(), t.cos()), radial(t));
                        (moved[0] - u.dot(&normal))
                            .abs()
                            .max((moved[1] - u.dot(&to_tip)).abs())
                    })
                    .fold(0.0, f64::max);
                println!("Z {z}, tooth {i}: flank off by {worst:.1e} of the motion");
                assert!(worst < 1e-8);
            }
        }
    }
}

#[test]
fn a_gear_with_teeth_and_holes_follows_its_bore_rigidly() {
    let data = holed(gear(18, 6e-3), 3, 10.5e-3, 2e-3, 0.21);
    let gear = SpurGear::new(data).expect("a gear");
    let r_w = default_interface_radius(&gear);
    let tooth = ToothGrid::new(&gear, r_w, GridLevel::Coarse).expect("a tooth");
    let blank = BlankGrid::new(
        6e-3,
        r_w,
        gear.hole_pattern().as_ref(),
        18,
        4.0,
        GridLevel::Coarse,
    )
    .expect("a blank");
    let motion = |p: Vector| Vector::new(2e-6, -1e-6) + 1e-3 * Vector::new(-p.y, p.x);
    let mut assembly = WholeGear::new(tooth, 18, &blank, 0.21, 36, (&Material::STEEL, 20e-3));
    let bore = assembly.bore.clone();
    assembly.whole.assembly.hold(bore, |p| Hold::At(motion(p)));
    let u = &assembly.whole.solve(&[assembly.no_forces()])[0];
    let worst = assembly
        .whole
        .assembly
        .nodes
        .iter()
        .zip(u)
        .map(|(p, u)| (u - motion(*p)).norm())
        .fold(0.0, f64::max);
    println!("off by {worst:.1e} m of 2e-5 m");
    assert!(worst < 1e-10 * 2e-5 * 100.0);
}

/// How far, over the field, the displacements of two rings that meet at R_w by harmonics are from a linear field imposed on
/// their outer and inner boundaries. Each ring is told by its sectors, the elements of each at the standard level, and its
/// phase.
fn off_a_linear_field(inner: (u32, f64), outer: (u32, f64), phase: f64, level: GridLevel) -> f64 {
    let (r_0, r_w, r_1) = (20e-3, 30e-3, 38e-3);
    let inner = BlankGrid::new(r_0, r_w, None, inner.0, inner.1, level).expect("a ring");
    let outer = BlankGrid::new(r_w, r_1, None, outer.0, outer.1, level).expect("a ring");
    let mut assembly = Assembly::default();
    let mut ring = |grid: &BlankGrid, phase: f64| {
        let (right, left) = whole_sides(grid);
        assembly.add_ring(
            &grid.grid,
            (&right, &left),
            grid.sector_count as usize,
            phase,
        )
    };
    let (inner_copies, outer_copies) = (ring(&inner, 0.0), ring(&outer, phase));
    let all = |copies: &[Vec<u32>], nodes: &[u32]| -> Vec<u32> {
        copies
            .iter()
            .flat_map(|copy| nodes.iter().map(|node| copy[*node as usize]))
            .collect()
    };
    let field = |p: Vector| {
        Vector::new(
            1e-6 + 1e-3 * p.x + 0.4e-3 * p.y,
            -2e-6 + 0.7e-3 * p.x - 0.5e-3 * p.y,
        )
    };
    assembly.hold(all(&inner_copies, &inner.bore_nodes), |p| {
        Hold::At(field(p))
    });
    assembly.hold(all(&outer_copies, &outer.arc_nodes), |p| Hold::At(field(p)));
    assembly.hold(all(&inner_copies, &inner.arc_nodes), on_circle);
    assembly.hold(all(&outer_copies, &outer.bore_nodes), on_circle);
    // Orders 0 and 2 carry A x, order 1 the translation; the others must stay silent.
    let whole = Whole::new(assembly, &Material::STEEL, 20e-3, 12);
    let none = vec![Vector::zeros(); whole.assembly.nodes.len()];
    let u = &whole.solve(&[none])[0];
    let moved = whole.assembly.nodes.iter().zip(u);
    moved
        .map(|(p, u)| (u - field(*p)).norm())
        .fold(0.0, f64::max)
        / 4e-5
}

#[test]
fn constant_strain_passes_through_the_harmonics() {
    // Fewer orders than nodes, but alike on both sides: exact but for rounding.
    let alike = off_a_linear_field((7, 6.0), (7, 6.0), 0.0, GridLevel::Standard);
    println!("alike: off by {alike:.1e}");
    assert!(alike < 1e-11);
}

#[test]
fn constant_strain_passes_between_grids_that_share_no_node_as_well_as_their_parabolas_are_circles()
{
    // Seven sectors of six elements inside, nine sectors of four outside, turned against each other. Sides of elements are
    // parabolas, which leave slivers of the fourth order in their length between the two.
    let [coarse, standard, fine] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine]
        .map(|level| off_a_linear_field((7, 6.0), (9, 4.0), 0.1, level));
    println!("off by {coarse:.1e}, {standard:.1e}, {fine:.1e}");
    assert!(standard < 1e-6);
    assert!(
        standard < coarse / 10.0 && fine < standard / 10.0,
        "the fourth order is a factor of 16"
    );
}
