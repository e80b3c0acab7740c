//! The paper's test cases and designs, with what it leaves open as DESIGN section 4 settles it.

#![allow(dead_code, reason = "each test and benchmark uses some of these")]

use meshwright_engine::analysis::{
    BodyFormula, Case, ContactSolver, Formulas, Method, PlaneState, Resolution, StiffnessRule,
    ToothFormula,
};
use meshwright_engine::gear::{
    Blank, GearData, GearPair, HolePattern, Material, Rack, ReliefData, ReliefShape, ReliefStart,
    SpurGear,
};
use meshwright_engine::grid::GridLevel;

/// A gear of Table 1: module 2 mm, 20 degrees, relief 5 µm over 1.75 mm of radius; lengths in meters.
pub(crate) fn gear(tooth_count: u32, bore_radius: f64, holes: Option<(u32, f64, f64)>) -> GearData {
    GearData {
        tooth_count,
        rack: Rack {
            module: 2e-3,
            pressure_angle: 20_f64.to_radians(),
            addendum: 2e-3,
            dedendum: 2.5e-3,
            tip_radius: 0.76e-3,
        },
        profile_shift: 0.0,
        face_width: 20e-3,
        tip_relief: Some(ReliefData {
            amount: 5e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1.75e-3),
        }),
        material: Material {
            youngs_modulus: 210e9,
            poisson_ratio: 0.3,
            density: 7850.0,
        },
        blank: Blank {
            bore_radius,
            holes: holes.map(|(count, circle_radius, radius)| HolePattern {
                count,
                circle_radius,
                radius,
                phase: 0.0,
            }),
        },
    }
}

/// A flexible case at the standard resolution.
pub(crate) fn case(
    driving: GearData,
    driven: GearData,
    center_distance: f64,
    output_torques: &[f64],
) -> Case {
    let made = |data| SpurGear::new(data).expect("a gear that can be made");
    Case {
        pair: GearPair::new(made(driving), made(driven), center_distance)
            .expect("a pair that meshes"),
        method: Method::Flexible,
        output_torques: output_torques.to_vec(),
        resolution: Resolution {
            positions_per_mesh_period: 40,
            span_mesh_periods: None,
            grid: GridLevel::Standard,
            contact_solver: ContactSolver::ActiveSet,
            stiffness: StiffnessRule::Tangent,
            blank_positions: 16,
            interface_radius: None,
            formulas: Formulas {
                tooth: ToothFormula::WeberBanaschek,
                body: BodyFormula::Sainsot,
                plane_state: PlaneState::Stress,
            },
            error_estimate: false,
        },
        driving_speed: None,
    }
}

/// Test case 1: eight holes in both gears.
pub(crate) fn case_1() -> Case {
    let holed = gear(50, 16e-3, Some((8, 31.5e-3, 10e-3)));
    case(holed, holed, 100.5e-3, &[115.0])
}

/// Test case 2: ten holes in the driven gear.
pub(crate) fn case_2() -> Case {
    case(
        gear(50, 16e-3, None),
        gear(50, 16e-3, Some((10, 34e-3, 7.5e-3))),
        100.5e-3,
        &[115.0],
    )
}

/// Test case 3, at the center distance that lets its teeth mesh: six holes in the driven gear.
pub(crate) fn case_3() -> Case {
    case(
        gear(29, 10e-3, None),
        gear(85, 12e-3, Some((6, 56e-3, 17.5e-3))),
        114.5e-3,
        &[160.0],
    )
}

/// A design of section 5: the standard pair with `holes` (N, R, r) in its driven gear.
pub(crate) fn study_design(holes: Option<(u32, f64, f64)>, output_torques: &[f64]) -> Case {
    case(
        gear(50, 15e-3, None),
        gear(50, 15e-3, holes),
        100.5e-3,
        output_torques,
    )
}
