//! What a case is said to cost, beside what it was measured to cost.

mod cases;

use cases::{along_faces, case, gear, helical, holed, model_by, test_case};
use meshwright_engine::analysis::{Case, ContactSolver, Method, estimate};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::contact::face::SLICES;
use meshwright_engine::gear::{
    Alignment, GearData, GearPair, Hole, HoleShape, SolidPair, SpurGear, Web,
};
use meshwright_engine::grid::GridLevel;
use meshwright_engine::vibration;

/// The largest gears that are taken, 299 and 300 teeth with unlike holes, under 830 N for each millimeter of width.
fn largest(positions: u32, span: u32) -> Case {
    let made = |teeth, count, circle, radius| {
        let mut data: GearData = holed(gear(teeth, 50e-3), count, circle, radius, 0.0);
        data.rack.tip_radius = 0.2e-3;
        SpurGear::new(data).expect("a gear that can be made")
    };
    let driving = made(299, 7, 170e-3, 60e-3);
    let driven = made(300, 60, 270e-3, 10e-3);
    let pair = GearPair::new(driving, driven, 599.2e-3).expect("a pair that meshes");
    let mut case = case(pair, &[5000.0]);
    case.resolution.positions_per_mesh_period = positions;
    case.resolution.span_mesh_periods = Some(span);
    case
}

/// Five kidneys in a web half as wide as its face, a millimeter and a half below its edge: a web that is condensed as a whole.
fn kidneys() -> SolidPair {
    let made = |teeth, width, beta: f64, bore, web: Option<Web>| {
        let mut data = gear(teeth, bore);
        let rack = &mut data.rack;
        (rack.module, rack.addendum, rack.dedendum) = (1e-3, 1e-3, 1.25e-3);
        (rack.tip_radius, data.face_width) = (0.38e-3, width);
        if web.is_some() {
            data.blank.web = web;
            let kidney = |i: u32| Hole {
                circle_radius: 16.26e-3,
                angle: std::f64::consts::TAU * f64::from(i) / 5.0,
                shape: HoleShape::Slot {
                    width: 5.77e-3,
                    angle: 0.445,
                },
            };
            data.blank.holes = (0..5).map(kidney).collect();
        }
        helical(data, beta.to_radians(), 0.0)
    };
    let web = Web {
        inner_radius: 11.88e-3,
        outer_radius: 20.64e-3,
        thickness: 3.7e-3,
    };
    let gears = [
        made(43, 5.56e-3, 18.46, 6.8e-3, None),
        made(47, 7.1e-3, -18.46, 10.1e-3, Some(web)),
    ];
    let none = [Vec::new(), Vec::new()];
    SolidPair::new(gears, none, 47.486e-3, Alignment::default()).expect("meshes")
}

#[test]
fn an_estimate_is_within_a_factor_of_two_of_what_was_measured() {
    let active_set = largest(400, 5);
    let mut augmented = active_set.clone();
    augmented.resolution.contact_solver = ContactSolver::AugmentedLagrangian {
        penalty: None,
        gap_tolerance: 1e-12,
    };
    let mut fine = largest(16, 1);
    fine.resolution.grid = GridLevel::Fine;
    let mut decomposed = largest(16, 20);
    decomposed.model = model_by(Method::Decomposition, &decomposed.model);
    let mut stressed = active_set.clone();
    stressed.stress = true;
    let mut kidneys = along_faces(kidneys(), (FaceResolution::STANDARD, SLICES), &[1.4]);
    kidneys.resolution.positions_per_mesh_period = 8;
    kidneys.resolution.span_mesh_periods = Some(1);
    // Seconds of one busy core and the most memory of the program, in MB.
    for (name, case, seconds, memory) in [
        ("active set", active_set, 5.3, 326.0),
        ("stress", stressed, 11.2, 434.0),
        ("augmented Lagrangian", augmented, 8.7, 389.0),
        ("fine", fine, 2.2, 571.0),
        ("decomposition", decomposed, 1.6, 294.0),
        ("case 3", test_case(3), 0.31, 71.0),
        ("kidneys along the face", kidneys, 9.6, 690.0),
    ] {
        let told = estimate(&case, None);
        let parts = [told.seconds / seconds, told.memory as f64 * 1e-6 / memory];
        println!(
            "{name}: {:.2} s, {} MB, {parts:.2?} of what was measured",
            told.seconds,
            told.memory / 1_000_000
        );
        assert!(parts.iter().all(|part| (0.5..2.0).contains(part)), "{name}");
    }
}

#[test]
fn modes_are_said_to_take_within_a_factor_of_two_of_what_was_measured() {
    let plain = || gear(50, 16e-3);
    let webbed = |mut data: GearData| {
        data.blank.web = Some(Web {
            inner_radius: 22e-3,
            outer_radius: 43e-3,
            thickness: 8e-3,
        });
        data
    };
    let unlike = |mut data: GearData, holes: &[f64], shape: &HoleShape| {
        let hole = |angle: &f64| Hole {
            circle_radius: 34e-3,
            angle: angle.to_radians(),
            shape: shape.clone(),
        };
        data.blank.holes = holes.iter().map(hole).collect();
        data
    };
    let round = HoleShape::Round { radius: 7.5e-3 };
    let slot = HoleShape::Slot {
        width: 9e-3,
        angle: 36_f64.to_radians(),
    };
    let slots = [0.0, 72.0, 144.0, 216.0, 288.0];
    // Seconds of one busy core.
    for (name, data, web_offset, seconds) in [
        ("a disk", plain(), 0.0, 0.84),
        ("90 teeth", gear(90, 16e-3), 0.0, 1.3),
        ("six holes", holed(plain(), 6, 32.5e-3, 6e-3, 0.0), 0.0, 2.7),
        ("a web", webbed(plain()), 0.0, 2.2),
        (
            "six holes in a web",
            webbed(holed(plain(), 6, 32.5e-3, 6e-3, 0.0)),
            0.0,
            5.2,
        ),
        (
            "ten holes in a web",
            webbed(holed(plain(), 10, 32.5e-3, 4e-3, 0.0)),
            0.0,
            5.2,
        ),
        ("a web off the middle", webbed(plain()), 3e-3, 8.8),
        (
            "six holes in a web off the middle",
            webbed(holed(plain(), 6, 32.5e-3, 6e-3, 0.0)),
            3e-3,
            19.7,
        ),
        (
            "unlike holes",
            unlike(plain(), &[0.0, 85.0, 185.0, 268.0], &round),
            0.0,
            13.4,
        ),
        ("slots", unlike(plain(), &slots, &slot), 0.0, 21.0),
    ] {
        let [told, _] = vibration::estimate(&helical(data, 0.0, web_offset));
        let part = told / seconds;
        println!("{name}: {told:.2} s, {part:.2} of what was measured");
        assert!((0.5..2.0).contains(&part), "{name}");
    }
}
