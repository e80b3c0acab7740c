//! Formulas that are exact, or nearly so, against the same quantities from the finite elements and the contact.

use std::f64::consts::PI;

use meshwright_engine::analysis::pair_model;
use meshwright_engine::contact::WarmStart;
use meshwright_engine::gear::Material;
use meshwright_engine::grid::{BlankGrid, GridLevel};
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{BlankSubstructure, Component, Harmonics};

use crate::support::{case, gear, library, pair, standard_pair};

#[test]
fn an_annulus_under_uniform_tangential_traction_turns_by_its_closed_form() {
    // θ = T/(4π G b) (1/r_i² − 1/r_o²): T 115 N m, b 20 mm, r_o 47.5 mm; 5.41407e-5 rad for r_i 10 mm and 2.26676e-5 rad
    // for 15 mm, to 0.1 %.
    let (torque, width, r_o) = (115.0, 20e-3, 47.5e-3);
    let shear_modulus =
        Material::STEEL.youngs_modulus / (2.0 * (1.0 + Material::STEEL.poisson_ratio));
    for (r_i, printed) in [(10e-3, 5.41407e-5), (15e-3, 2.26676e-5)] {
        let formula = torque / (4.0 * PI * shear_modulus * width)
            * (1.0 / f64::powi(r_i, 2) - 1.0 / f64::powi(r_o, 2));
        assert!(
            (formula / printed - 1.0).abs() < 2e-6,
            "the formula gives what is printed"
        );
        for level in [GridLevel::Coarse, GridLevel::Standard] {
            let grid = BlankGrid::new(r_i, r_o, None, 50, 4.0, level).expect("a ring");
            let blank = BlankSubstructure::new(
                &grid,
                r_o,
                &Material::STEEL,
                width,
                Harmonics { largest: 60 },
                &Run::unattended(),
            )
            .expect("a stiff ring");
            // A uniform traction T/(2π r_o² b) does the work T/r_o a_0 on the uniform tangential displacement a_0.
            let uniform = blank.harmonics.cosine(0, Component::Tangential);
            let theta = torque / r_o / blank.stiffness[(uniform, uniform)] / r_o;
            println!("r_i {r_i}, {level:?}: {theta:.6e} for {formula:.6e} rad");
            assert!((theta / formula - 1.0).abs() < 1e-3);
            // By symmetry nothing else moves.
            let n = blank.harmonics.unknowns();
            let scale = blank.stiffness[(uniform, uniform)];
            assert!(
                (0..n).all(|i| i == uniform || blank.stiffness[(i, uniform)].abs() < 1e-9 * scale)
            );
        }
    }
}

#[test]
fn the_contact_at_the_pitch_point_is_hertz() {
    // Plane stress, both radii 17.8187 mm, T 115 N m: half-width 115.0 µm and 677 MPa.
    let case = case(standard_pair(false), &[115.0]);
    let model = pair_model(&case, library(), &Run::unattended()).expect("a model");
    let load = case.pair.load(115.0);
    let found = model
        .as_drawn()
        .cells(0.0, load, &mut WarmStart::default())
        .expect("contact");
    let (_, patch) = found
        .patches
        .iter()
        .find(|(pair, _)| *pair == 0)
        .expect("the reference pair touches at the pitch point");
    let before: usize = found
        .patches
        .iter()
        .take_while(|(pair, _)| *pair != 0)
        .map(|(_, patch)| patch.cells.len())
        .sum();
    let here = before..before + patch.cells.len();
    let touching = found.solution.active[here.clone()]
        .iter()
        .filter(|active| **active)
        .count();
    let cell_width = patch.cells[0].width;
    let half_width = 0.5 * touching as f64 * cell_width;
    let peak = found.solution.forces[here]
        .iter()
        .fold(0.0_f64, |peak, p| peak.max(*p))
        / (cell_width * case.pair.common_face_width());
    println!(
        "half-width {half_width:.4e} m of cells {:.4e} m, peak pressure {peak:.4e} Pa",
        cell_width
    );
    assert!(
        (half_width - 115.0e-6).abs() < cell_width,
        "within one cell"
    );
    assert!((peak / 677e6 - 1.0).abs() < 0.02);
    let carried: f64 = found.solution.forces.iter().sum();
    assert!(
        (carried / load - 1.0).abs() < 1e-4,
        "one pair carries all; arms differ from one by (a/ρ)²"
    );
}

#[test]
fn contact_ratios_are_those_of_the_closed_form() {
    let with = |z_1, z_2, a| pair(gear(z_1, 8e-3), gear(z_2, 8e-3), a).contact_ratio();
    for (z_1, z_2, a, ratio) in [
        (50, 50, 100.5e-3, 1.51155),
        (29, 85, 114.5e-3, 1.49604),
        (29, 85, 114.0e-3, 1.73969),
    ] {
        assert!((with(z_1, z_2, a) - ratio).abs() < 6e-6, "{z_1}/{z_2}");
    }
    // The largest distance is 115.567 mm, rounded up; a micron shortens the path of contact by some three.
    assert!((with(29, 85, 115.566e-3) - 1.0).abs() < 5e-4);
}
