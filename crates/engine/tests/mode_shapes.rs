//! Shapes of natural modes on their grids.

mod cases;

use std::collections::HashMap;
use std::f64::consts::TAU;

use cases::{gear, helical};
use meshwright_engine::gear::{HolePattern, SolidGear};
use meshwright_engine::run::Run;
use meshwright_engine::vibration::{
    BoreSupport, Direction, Mode, ModeShape, ModesAsked, OrderShape, mode_shape, modes, shape_size,
};
use nalgebra::{Complex, Rotation3, Vector3};

/// The order of the largest wave of `shape` around teeth, by the same node of each of `z` teeth, and the part of the whole that it has with its opposite.
fn order_of_teeth(shape: &ModeShape, z: u32) -> (u32, f64) {
    // The farthest out on the upper face: one of each tooth.
    let place = |at: &&Vector3<f64>| (at.z * 1e9).round() + at.xy().norm();
    let one = shape
        .nodes
        .iter()
        .max_by(|one, other| place(one).total_cmp(&place(other)))
        .expect("nodes");
    let angle = |at: &Vector3<f64>| at.y.atan2(at.x);
    let pitch = TAU / f64::from(z);
    let tooth = |at: &Vector3<f64>| {
        let teeth = (angle(at) - angle(one)) / pitch;
        let is_same = (at.xy().norm() - one.xy().norm()).abs() < 1e-12
            && (at.z - one.z).abs() < 1e-12
            && (teeth - teeth.round()).abs() < 1e-6;
        is_same.then_some(pitch * teeth.round())
    };
    let mut energies = vec![0.0; z as usize / 2 + 1];
    let mut count = 0;
    let mut sums = vec![[Complex::new(0.0, 0.0); 3]; z as usize];
    for (at, [cosine, sine]) in shape.nodes.iter().zip(&shape.displacements) {
        let Some(turned) = tooth(at) else { continue };
        count += 1;
        let u = Rotation3::from_axis_angle(&Vector3::z_axis(), -angle(at));
        let [cosine, sine] = [u * *cosine, u * *sine];
        for (n, sum) in sums.iter_mut().enumerate() {
            for (sum, (re, im)) in sum.iter_mut().zip(cosine.iter().zip(&sine)) {
                *sum += Complex::new(*re, *im) * Complex::cis(-(n as f64) * turned);
            }
        }
    }
    assert_eq!(count, z, "one node a tooth");
    for (n, sum) in sums.iter().enumerate() {
        let folded = n.min(z as usize - n);
        energies[folded] += sum.iter().map(|of| of.norm_sqr()).sum::<f64>();
    }
    let all: f64 = energies.iter().sum();
    let largest = (0..energies.len()).max_by(|a, b| energies[*a].total_cmp(&energies[*b]));
    let largest = largest.expect("orders");
    (largest as u32, energies[largest] / all)
}

/// The largest difference between nodes of `shape` at the same place, over the largest displacement.
fn torn(shape: &ModeShape) -> f64 {
    let key = |at: &Vector3<f64>| [at.x, at.y, at.z].map(|x| (x * 1e8).round() as i64);
    let mut known = HashMap::new();
    let mut most: f64 = 0.0;
    for (at, moved) in shape.nodes.iter().zip(&shape.displacements) {
        let first = known.entry(key(at)).or_insert(moved);
        for (one, other) in first.iter().zip(moved) {
            most = most.max((one - other).norm());
        }
    }
    assert!(known.len() < shape.nodes.len(), "some nodes coincide");
    most / shape.largest()
}

/// A gear of 24 teeth of module 2 mm with `count` holes.
fn holed(count: u32) -> SolidGear {
    let mut data = gear(24, 7e-3);
    let pattern = HolePattern {
        count,
        circle_radius: 13e-3,
        radius: 2.5e-3,
        phase: 0.3,
    };
    if count > 0 {
        data.blank.holes = pattern.holes();
    }
    helical(data, 0.0, 0.0)
}

fn asked(count: usize) -> ModesAsked {
    ModesAsked {
        count,
        highest: None,
        bore: BoreSupport::Held,
    }
}

/// Holds a shape to the nodal diameters of its mode, and sectors and teeth that meet at a place to one displacement there.
fn assert_shape(gear: &SolidGear, shape: &ModeShape) {
    let (order, share) = order_of_teeth(shape, 24);
    assert_eq!(order, shape.mode.nodal_diameters);
    assert!(share > 0.9, "{order}: {share}");
    assert!(torn(shape) < 1e-6, "{order}: {}", torn(shape));
    let size = shape_size(gear).expect("a size");
    assert_eq!(shape.elements.len(), size.elements);
    assert!(shape.nodes.len() <= size.nodes);
}

#[test]
fn the_shape_of_the_lowest_mode_has_its_nodal_diameters_and_is_not_torn() {
    let gear = holed(0);
    let shape = mode_shape(&gear, asked(1), 0, &Run::unattended());
    assert_shape(&gear, &shape.expect("sound").expect("in the list"));
}

#[test]
#[ignore = "./test all"]
fn shapes_on_the_grid_have_the_nodal_diameters_that_are_listed_and_are_not_torn() {
    for holes in [0, 5] {
        let (gear, run) = (holed(holes), Run::unattended());
        let modes = modes(&gear, asked(6), &run).expect("sound");
        for (place, mode) in modes.iter().enumerate() {
            let shape = mode_shape(&gear, asked(6), place, &run).expect("sound");
            let shape = shape.expect("in the list");
            assert_eq!(&shape.mode, mode);
            assert_shape(&gear, &shape);
        }
        let beyond = mode_shape(&gear, asked(6), modes.len(), &run);
        assert!(beyond.expect("sound").is_none());
    }
}

#[test]
fn around_the_gear_the_squares_of_cosine_and_sine_are_those_at_its_places_in_the_mean() {
    let [u, v, w] = [
        Complex::new(0.3, 0.1),
        Complex::new(-0.2, 0.9),
        Complex::new(0.4, 0.0),
    ];
    let of = |order: i64, at_pitch: [Complex<f64>; 3]| OrderShape {
        order,
        at_pitch,
        on_rim: at_pitch,
    };
    let mut mode = Mode {
        frequency: 1000.0,
        is_double: true,
        direction: Direction::InPlane,
        nodal_diameters: 3,
        nodal_circles: 0,
        coriolis: 0.0,
        residual: 0.0,
        shape: vec![of(3, [u, v, w]), of(-3, [w, u, v])],
    };
    let along = [0.34, 0.94, -0.2];
    let in_the_mean = |mode: &Mode| -> f64 {
        let squares = (0..12).map(|i| {
            let both = mode.at_pitch(f64::from(i) * std::f64::consts::TAU / 12.0);
            let each = both.map(|u| u.iter().zip(along).map(|(u, a)| u * a).sum::<f64>());
            each.iter().map(|u| u * u).sum::<f64>()
        });
        squares.sum::<f64>() / 12.0
    };
    assert!((mode.around(&along).powi(2) / in_the_mean(&mode) - 1.0).abs() < 1e-12);
    // A single mode is half of it in each of two waves that are alike.
    mode.is_double = false;
    assert!((mode.around(&along).powi(2) / in_the_mean(&mode) - 1.0).abs() < 1e-12);
    // Without nodal diameters it is the same at all places.
    mode.nodal_diameters = 0;
    mode.shape = vec![of(0, [u, v, w])];
    assert!((mode.around(&along).powi(2) / in_the_mean(&mode) - 1.0).abs() < 1e-12);
}
