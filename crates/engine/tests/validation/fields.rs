//! The fields of both gears at one position: in balance with the load, and as stressed as the recovered edges say.

use std::f64::consts::TAU;

use meshwright_engine::analysis::fields::{GearField, fields};
use meshwright_engine::gear::{GearPair, Hole, HoleShape, Material, Member, Vector};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::run::Run;
use meshwright_engine::substructures::element_stiffness;

use crate::support::{case, gear, holed, library, pair, relieved, solve};

const TORQUE: f64 = 115.0;
const CENTER_DISTANCE: f64 = 100.5e-3;
/// (N, R, r) of the driven gear.
const HOLES: (u32, f64, f64) = (8, 34e-3, 8.385e-3);

fn holed_pair() -> GearPair {
    let solid = relieved(gear(50, 15e-3));
    let driven = holed(solid.clone(), HOLES.0, HOLES.1, HOLES.2, 0.1);
    pair(solid, driven, CENTER_DISTANCE)
}

fn center(member: Member) -> Vector {
    match member {
        Member::Driving => Vector::zeros(),
        Member::Driven => Vector::new(CENTER_DISTANCE, 0.0),
    }
}

/// The moment about `center` of what the bore exerts on a field: the forces that its nodes need.
fn hub_moment(field: &GearField, center: Vector, bore_radius: f64) -> f64 {
    let mut forces = vec![Vector::zeros(); field.nodes.len()];
    for (element, thickness) in field.elements.iter().zip(&field.thicknesses) {
        let stiffness = element_stiffness(
            element.kind(),
            &element.places(&field.nodes),
            &Material::STEEL,
            *thickness,
        );
        let nodes = element.nodes();
        for (a, node) in nodes.iter().enumerate() {
            for (b, other) in nodes.iter().enumerate() {
                let u = field.displacements[*other as usize];
                let row = |c: usize| {
                    stiffness[(2 * a + c, 2 * b)] * u.x + stiffness[(2 * a + c, 2 * b + 1)] * u.y
                };
                forces[*node as usize] += Vector::new(row(0), row(1));
            }
        }
    }
    let nodes = field.nodes.iter().zip(&forces);
    nodes
        .map(|(node, force)| (node - center, force))
        .filter(|(arm, _)| arm.norm() < bore_radius + 1e-6)
        .map(|(arm, force)| arm.x * force.y - arm.y * force.x)
        .sum()
}

#[test]
fn hubs_hold_the_torques_and_roots_and_holes_are_as_stressed_as_their_edges() {
    let mut case = case(holed_pair(), &[TORQUE]);
    case.resolution.grid = GridLevel::Standard;
    case.resolution.positions_per_mesh_period = 5;
    case.stress = true;
    let curve = solve(&case).curves.remove(0);
    let stresses = curve.stresses.expect("asked for");
    let place = 7;
    let eta = curve.mesh_position[place];
    let fields = fields(&case, TORQUE, eta, library(), &Run::unattended())
        .expect("a field")
        .gears;
    for member in Member::BOTH {
        let (field, peaks) = (&fields[member.index()], &stresses[member.index()]);
        let center = center(member);
        // Equal base circles: equal torques.
        let moment = hub_moment(field, center, 15e-3);
        println!("{member}: hub {moment:.4} N m");
        assert!((moment.abs() / TORQUE - 1.0).abs() < 1e-3);

        let von_mises = &field.von_mises;
        let tooth_0 = tooth_0_angle(field, center);
        let near = |angle: f64, radius: (f64, f64)| {
            let nodes = field.nodes.iter().zip(von_mises);
            nodes
                .filter(|(node, _)| {
                    let arm = *node - center;
                    let beside = (arm.y.atan2(arm.x) - tooth_0 - angle + TAU / 2.0).rem_euclid(TAU)
                        - TAU / 2.0;
                    beside.abs() < 2e-5 && (radius.0..radius.1).contains(&arm.norm())
                })
                .map(|(_, stress)| *stress)
                .fold(0.0, f64::max)
        };
        let root = peaks.root[place];
        let found = near(root.angle, (47.4e-3, 48.4e-3));
        println!(
            "{member}: root {:.2} MPa, field {:.2}",
            root.stress / 1e6,
            found / 1e6
        );
        assert!((found / root.stress - 1.0).abs() < 0.03);
        if let Some(hole) = peaks.holes.get(place) {
            let found = near(
                hole.angle,
                (HOLES.1 - HOLES.2 - 1e-6, HOLES.1 + HOLES.2 + 1e-6),
            );
            println!(
                "{member}: hole {:.2} MPa, field {:.2}",
                hole.stress / 1e6,
                found / 1e6
            );
            assert!((found / hole.stress - 1.0).abs() < 0.03);
        }
        // Teeth and blank move together where they meet.
        let apart = tears(field);
        let most = field
            .displacements
            .iter()
            .map(Vector::norm)
            .fold(0.0, f64::max);
        println!("{member}: tears by {apart:.2e} m, moves by {most:.2e} m");
        assert!(apart < 2e-3 * most);
    }
}

/// The largest and the smallest stress along the edges of `field` between two radii, by the stresses of its elements.
fn along_roots(field: &GearField, center: Vector, radii: (f64, f64)) -> [f64; 2] {
    let place = |node: u32| field.nodes[node as usize] - center;
    let at_root = |edge: &&[u32; 3]| {
        let mut nodes = edge.iter();
        nodes.all(|node| (radii.0..radii.1).contains(&place(*node).norm()))
    };
    let stresses = field.edges.iter().filter(at_root).flat_map(|edge| {
        let along = (place(edge[2]) - place(edge[0])).normalize();
        edge.map(|node| {
            let [xx, yy, xy] = field.stresses[node as usize];
            along.x * along.x * xx + along.y * along.y * yy + 2.0 * along.x * along.y * xy
        })
    });
    stresses.fold([0.0, 0.0], |[most, least], stress| {
        [f64::max(most, stress), f64::min(least, stress)]
    })
}

#[test]
#[ignore = "./test all"]
fn tension_and_compression_at_roots_are_the_extremes_of_the_whole_field() {
    let solid = relieved(gear(50, 15e-3));
    // A rim of one and a half modules over four slots bends at their ends, far from the teeth in mesh.
    let mut thin = solid.clone();
    thin.blank.holes = (0..4)
        .map(|i| Hole {
            circle_radius: 40e-3,
            angle: 0.1 + TAU / 4.0 * f64::from(i),
            shape: HoleShape::Slot {
                width: 9e-3,
                angle: TAU / 6.0,
            },
        })
        .collect();
    let mut elsewhere = 0.0_f64;
    for driven in [holed(solid.clone(), 8, 34e-3, 8.385e-3, 0.1), thin] {
        let mut case = case(pair(solid.clone(), driven, CENTER_DISTANCE), &[TORQUE]);
        case.resolution.grid = GridLevel::Standard;
        case.resolution.positions_per_mesh_period = 1;
        case.stress = true;
        let curve = solve(&case).curves.remove(0);
        let stresses = curve.stresses.expect("asked for");
        for (place, eta) in curve.mesh_position.iter().enumerate().take(3) {
            let fields = fields(&case, TORQUE, *eta, library(), &Run::unattended());
            let fields = fields.expect("a field").gears;
            for member in Member::BOTH {
                let peaks = &stresses[member.index()];
                let spur = case.pair.gear(member);
                let radii = (spur.root_radius() - 1e-6, spur.form_radius() + 1e-6);
                let found = along_roots(&fields[member.index()], center(member), radii);
                let said = [peaks.root_tension[place], peaks.root_compression[place]];
                for (said, found) in said.iter().zip(found) {
                    println!(
                        "{member} at {eta}: {:.2} MPa, field {:.2}",
                        said.stress / 1e6,
                        found / 1e6
                    );
                    assert!((found / said.stress - 1.0).abs() < 0.03);
                }
                let in_mesh = peaks.root[place].stress;
                assert!(said[0].stress >= in_mesh && said[1].stress < -0.5 * in_mesh);
                elsewhere = elsewhere.max(said[0].stress / in_mesh - 1.0);
            }
        }
    }
    println!("up to {elsewhere:+.3} beside the loaded flanks");
    assert!(elsewhere > 0.05, "a thin rim is worst elsewhere");
}

/// The angle of the centerline of the first tooth, whose nodes come first: the mean of its tip corners.
fn tooth_0_angle(field: &GearField, center: Vector) -> f64 {
    let tip: Vec<Vector> = field
        .nodes
        .iter()
        .map(|node| node - center)
        .filter(|arm| arm.norm() > 51.999e-3)
        .collect();
    let first = tip[0];
    let of_tooth: Vec<&Vector> = tip
        .iter()
        .filter(|arm| (*arm - first).norm() < 3e-3)
        .collect();
    let sum: Vector = of_tooth.iter().map(|arm| arm.normalize()).sum();
    let mean = sum.y.atan2(sum.x);
    // The land is symmetric about the centerline: its two farthest nodes are the corners.
    let angles = of_tooth
        .iter()
        .map(|arm| (arm.y.atan2(arm.x) - mean + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0);
    let (low, high) = angles.fold((0.0_f64, 0.0_f64), |(low, high), a| {
        (low.min(a), high.max(a))
    });
    mean + f64::midpoint(low, high)
}

/// How far nodes at the same place move apart, at most.
fn tears(field: &GearField) -> f64 {
    let key = |node: &Vector| ((node.x * 1e8).round() as i64, (node.y * 1e8).round() as i64);
    let mut known = std::collections::HashMap::new();
    let mut most = 0.0_f64;
    for (node, u) in field.nodes.iter().zip(&field.displacements) {
        if let Some(other) = known.insert(key(node), *u) {
            most = most.max((u - other).norm());
        }
    }
    assert!(known.len() < field.nodes.len(), "parts meet");
    most
}

#[test]
fn a_field_turns_with_the_gears() {
    // A whole turn later the same teeth stand in the same places, loaded alike.
    let mut case = case(holed_pair(), &[TORQUE]);
    case.resolution.grid = GridLevel::Coarse;
    let at = |eta: f64| {
        let found = fields(&case, TORQUE, eta, library(), &Run::unattended());
        found.expect("a field").gears
    };
    let (now, later) = (at(0.5), at(50.5));
    let [now, later] = [now, later].map(|[driving, _]| driving);
    for (a, b) in now.displacements.iter().zip(&later.displacements) {
        assert!((a - b).norm() < 1e-12);
    }
    for (a, b) in now.nodes.iter().zip(&later.nodes) {
        assert!((a - b).norm() < 1e-12);
    }
}
