//! Gears, pairs and cases that several tests share.

use std::sync::OnceLock;

use meshwright_engine::analysis::{
    Analysis, BodyFormula, Case, ContactSolver, Curve, Formulas, Library, Method, PlaneState,
    Resolution, StiffnessRule, ToothFormula, analyze,
};
use meshwright_engine::gear::{
    Blank, GearData, GearPair, HolePattern, Material, Rack, ReliefData, ReliefShape, ReliefStart,
    SpurGear,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::run::Run;

/// Steel, as everywhere in DESIGN section 4.
pub(crate) const STEEL: Material = Material {
    youngs_modulus: 210e9,
    poisson_ratio: 0.3,
    density: 7850.0,
};

/// The gears of the paper and of CalculiX but for their tooth counts and blanks: m 2 mm, α 20°, b 20 mm.
pub(crate) fn gear(tooth_count: u32, bore_radius: f64) -> GearData {
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
        tip_relief: None,
        material: STEEL,
        blank: Blank {
            bore_radius,
            holes: None,
        },
    }
}

/// The relief of the paper: 5 µm, linear, from 1.75 mm below the tip circle.
pub(crate) fn relieved(data: GearData) -> GearData {
    GearData {
        tip_relief: Some(ReliefData {
            amount: 5e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(1.75e-3),
        }),
        ..data
    }
}

/// `data` with holes.
pub(crate) fn holed(
    mut data: GearData,
    count: u32,
    circle_radius: f64,
    radius: f64,
    phase: f64,
) -> GearData {
    data.blank.holes = Some(HolePattern {
        count,
        circle_radius,
        radius,
        phase,
    });
    data
}

/// The pair of two drawings.
pub(crate) fn pair(driving: GearData, driven: GearData, center_distance: f64) -> GearPair {
    let gear = |data| SpurGear::new(data).expect("the drawing of a test can be made");
    GearPair::new(gear(driving), gear(driven), center_distance).expect("the pair of a test meshes")
}

/// The standard pair: 50/50 at 100.5 mm with a bore of 15 mm, with or without the relief of the paper.
pub(crate) fn standard_pair(with_relief: bool) -> GearPair {
    let data = gear(50, 15e-3);
    let data = if with_relief { relieved(data) } else { data };
    pair(data, data, 100.5e-3)
}

/// Test case `number` of the paper with the values of DESIGN section 4, and its output torque.
pub(crate) fn paper_case(number: u32) -> (GearPair, f64) {
    let blank = |z, bore| relieved(gear(z, bore));
    match number {
        1 => {
            let data = holed(blank(50, 16e-3), 8, 31.5e-3, 10e-3, 0.0);
            (pair(data, data, 100.5e-3), 115.0)
        }
        2 => {
            let driven = holed(blank(50, 16e-3), 10, 34e-3, 7.5e-3, 0.0);
            (pair(blank(50, 16e-3), driven, 100.5e-3), 115.0)
        }
        3 => {
            let driven = holed(blank(85, 12e-3), 6, 56e-3, 17.5e-3, 0.0);
            (pair(blank(29, 10e-3), driven, 114.5e-3), 160.0)
        }
        _ => unreachable!("the paper has three test cases"),
    }
}

/// A small pair for whole grids: 18/18 at 36.3 mm, bore 6 mm, three holes in the driven gear, out of line with its teeth.
pub(crate) fn small_pair() -> GearPair {
    let data = gear(18, 6e-3);
    pair(data, holed(data, 3, 10.5e-3, 2e-3, 0.21), 36.3e-3)
}

/// The flexible method at the standard level, 40 positions a mesh period over the true period, exact active set and
/// tangent.
pub(crate) fn case(pair: GearPair, output_torques: &[f64]) -> Case {
    Case {
        pair,
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

/// The teeth and blanks that the tests share.
pub(crate) fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(Library::default)
}

/// The answer to `case`.
pub(crate) fn solve(case: &Case) -> Analysis {
    analyze(case, library(), &Run::unattended())
        .unwrap_or_else(|error| panic!("{error} {:?}", std::error::Error::source(&error)))
}

/// The roll length on the driving gear at which the pair that passes the pitch point at mesh position `n` touches.
pub(crate) fn roll_length(pair: &GearPair, eta: f64, n: i64) -> f64 {
    pair.pitch_roll_length() + (eta - n as f64) * pair.base_pitch()
}

/// How far a roll length lies outside the path of contact A-E; zero inside.
pub(crate) fn beyond_path(pair: &GearPair, roll_length: f64) -> f64 {
    let (s_a, s_e) = pair.path_of_contact();
    (s_a - roll_length).max(roll_length - s_e).max(0.0)
}

/// The pairs that carry load at position `i` of a curve: roll length on the driving gear and share, by rising roll length.
pub(crate) fn loaded_pairs(pair: &GearPair, curve: &Curve, i: usize) -> Vec<(f64, f64)> {
    let eta = curve.mesh_position[i];
    let mut loaded: Vec<(f64, f64)> = curve
        .load_shares
        .iter()
        .filter(|share| share.share[i] > 0.0)
        .map(|share| {
            let n = eta.floor() as i64 + i64::from(share.pair_offset);
            (roll_length(pair, eta, n), share.share[i])
        })
        .collect();
    loaded.sort_by(|a, b| a.0.total_cmp(&b.0));
    loaded
}

/// Where the reference data lie: `tests/reference` at the root of the repository.
pub(crate) fn reference(file: &str) -> serde_json::Value {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/reference")
        .join(file);
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{file}: {error}"))
}
