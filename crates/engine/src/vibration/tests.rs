//! Annuli and rings whose frequencies are known in closed form.

use std::f64::consts::TAU;

use super::section::Blank;
use super::*;
use crate::gear::{BlankRegion, HolePattern, Layer};

fn layer(inner_radius: f64, outer_radius: f64, width: f64) -> Layer {
    Layer {
        inner_radius,
        outer_radius,
        heights: [-width / 2.0, width / 2.0],
    }
}

fn modes_of(blank: &Blank, count: usize) -> Vec<Mode> {
    let body = Body {
        blank,
        teeth: None,
        material: &Material::STEEL,
    };
    let asked = ModesAsked {
        count,
        highest: None,
        bore: BoreSupport::Held,
    };
    let (modes, _) = body.modes(asked, None, &Run::unattended()).expect("sound");
    modes
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    let error = found / expected - 1.0;
    assert!(error.abs() < tolerance, "{found} {expected}: {error:e}");
}

#[test]
fn an_annular_plate_that_is_held_within_has_leissas_frequencies() {
    // Leissa, Vibration of Plates (NASA SP-160), table 2.30: λ² = ω a² √(ρ h/D) of plates held at b and free at a; more digits by the
    // roots of the same determinant.
    for (ratio, expected) in [
        (
            0.3,
            [
                (1, 6.5523142),
                (0, 6.6603673),
                (2, 7.9564865),
                (3, 13.275733),
            ],
        ),
        (
            0.5,
            [
                (0, 13.024257),
                (1, 13.289781),
                (2, 14.703812),
                (3, 18.561989),
            ],
        ),
    ] {
        let outer = 0.1;
        let thickness = outer * (1.0 - ratio) / 50.0;
        let blank = Blank::of_parts(vec![layer(ratio * outer, outer, thickness)], 24);
        let steel = Material::STEEL;
        let d = steel.youngs_modulus * thickness.powi(2) / (12.0 * (1.0 - 0.09) * steel.density);
        for (mode, (n, squared)) in modes_of(&blank, 4).iter().zip(expected) {
            assert_eq!(mode.direction, Direction::OutOfPlane);
            assert_eq!((mode.nodal_diameters, mode.nodal_circles), (n, 0));
            assert_eq!(mode.is_double, n > 0);
            assert_near(
                mode.frequency,
                squared * d.sqrt() / outer.powi(2) / TAU,
                0.01,
            );
        }
    }
}

#[test]
fn an_annulus_in_torsion_rings_by_bessels_functions() {
    // J_1(k b) Y_2(k a) = Y_1(k b) J_2(k a), b/a = 0.4: k a of the first two, the second with one nodal circle.
    let blank = Blank::of_parts(vec![layer(40e-3, 100e-3, 40e-3)], 12);
    let modes = modes_of(&blank, 30);
    let steel = Material::STEEL;
    let speed = (steel.shear_modulus() / steel.density).sqrt();
    let torsion: Vec<&Mode> = modes
        .iter()
        .filter(|mode| mode.direction == Direction::Torsion)
        .collect();
    for (mode, (circles, k)) in torsion.iter().zip([(0, 1.392000554), (1, 7.642904502)]) {
        assert_eq!((mode.nodal_diameters, mode.nodal_circles), (0, circles));
        assert!(!mode.is_double);
        assert_near(mode.frequency, k * speed / 0.1 / TAU, 2e-4);
    }
    assert!(!torsion.is_empty());
}

#[test]
fn a_thin_ring_bends_in_its_plane_by_its_closed_form_and_takes_back_its_part_of_the_turn() {
    // Free: ω² = E I n² (n² − 1)²/(ρ A R⁴ (n² + 1)), and c = 2 n/(n² + 1) as its middle line keeps its length.
    let mut blank = Blank::of_parts(vec![layer(99e-3, 101e-3, 5e-3)], 150);
    blank.section.bore.clear();
    let modes = modes_of(&blank, 20);
    let steel = Material::STEEL;
    for n in [2_u32, 3, 4] {
        let of_order =
            |mode: &&Mode| mode.direction == Direction::InPlane && mode.nodal_diameters == n;
        let mode = modes.iter().find(of_order).expect("among the lowest");
        let n = f64::from(n);
        let per_mass = steel.youngs_modulus * 4e-6 / (12.0 * steel.density * 0.1_f64.powi(4));
        let squared = per_mass * n * n * (n * n - 1.0).powi(2) / (n * n + 1.0);
        assert_near(mode.frequency, squared.sqrt() / TAU, 2e-3);
        assert_near(mode.coriolis, 2.0 * n / (n * n + 1.0), 2e-3);
        assert!(mode.is_double && mode.residual < 1e-6);
    }
}

#[test]
fn a_translation_of_a_rim_is_met_at_the_mesh_frequency_alone() {
    let mode = Mode {
        frequency: 6000.0,
        is_double: true,
        direction: Direction::InPlane,
        nodal_diameters: 1,
        nodal_circles: 0,
        coriolis: 1.0,
        residual: 0.0,
        shape: Vec::new(),
    };
    let met = mode.crossings(30, 2);
    assert_eq!(met.len(), 2);
    assert_eq!(met[0].wave, campbell::Wave::Standing);
    assert_near(met[0].turns, 200.0, 1e-12);
    assert_near(met[1].turns, 100.0, 1e-12);
    let bends = Mode {
        direction: Direction::OutOfPlane,
        nodal_diameters: 2,
        ..mode
    };
    let met = bends.crossings(30, 1);
    let turns: Vec<f64> = met.iter().map(|crossing| crossing.turns).collect();
    assert_near(turns[0], 6000.0 / 32.0, 1e-12);
    assert_near(turns[1], 6000.0 / 28.0, 1e-12);
    for crossing in met {
        // There the wave has the frequency of the mesh, in space.
        let waves = bends.waves(crossing.turns);
        let wave = waves.iter().find(|(wave, _)| *wave == crossing.wave);
        assert_near(wave.expect("one of two").1, 30.0 * crossing.turns, 1e-12);
    }
}

#[test]
fn a_web_with_holes_between_rim_and_hub_rings_as_calculix_has_it() {
    // CalculiX 2.20, *FREQUENCY on 1,536 elements C3D20 of the whole ring: hub 15 to 20 mm and rim 40 to 46 mm, 20 mm wide; web of 8 mm with eight
    // holes of 7 mm on a circle of 30 mm; the bore held. Double values stand once.
    let expected = [
        4571.486, 5614.145, 5803.378, 7339.967, 12774.99, 14664.49, 20225.79, 21800.52, 21939.21,
        23251.32, 25658.74, 25727.08, 26605.46, 29589.96, 30610.64, 30755.42, 31649.01, 33582.85,
        34450.96, 34675.41,
    ];
    let parts = vec![
        layer(40e-3, 46e-3, 20e-3),
        layer(20e-3, 40e-3, 8e-3),
        layer(15e-3, 20e-3, 20e-3),
    ];
    let holes = HolePattern {
        count: 8,
        circle_radius: 30e-3,
        radius: 7e-3,
        phase: 0.0,
    };
    let region = BlankRegion {
        holes: holes.holes(),
        ..BlankRegion::solid(15e-3)
    };
    let blank = Blank::of_region(parts, &region, 20e-3, 50).expect("room for elements");
    let modes = modes_of(&blank, 20);
    assert_eq!(modes.len(), 20);
    for (mode, expected) in modes.iter().zip(expected) {
        assert_near(mode.frequency, expected, 0.01);
    }
    let doubles = modes.iter().filter(|mode| mode.is_double).count();
    assert_eq!(doubles, 12);
}
