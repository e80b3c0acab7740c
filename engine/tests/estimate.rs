//! What a case is said to cost, beside what it was measured to cost.

mod cases;

use cases::{case, gear, holed, test_case};
use meshwright_engine::analysis::{Case, ContactSolver, Method, estimate};
use meshwright_engine::gear::{GearData, GearPair, SpurGear};
use meshwright_engine::grid::GridLevel;

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
    decomposed.method = Method::Decomposition;
    let mut stressed = active_set.clone();
    stressed.stress = true;
    // Seconds of one busy core and the most memory of the program, in MB.
    for (name, case, seconds, memory) in [
        ("active set", active_set, 5.3, 326.0),
        ("stress", stressed, 11.2, 434.0),
        ("augmented Lagrangian", augmented, 8.7, 389.0),
        ("fine", fine, 2.2, 571.0),
        ("decomposition", decomposed, 1.6, 294.0),
        ("case 3", test_case(3), 0.31, 71.0),
    ] {
        let told = estimate(&case);
        let parts = [told.seconds / seconds, told.memory as f64 * 1e-6 / memory];
        println!(
            "{name}: {:.2} s, {} MB, {parts:.2?} of what was measured",
            told.seconds,
            told.memory / 1_000_000
        );
        assert!(parts.iter().all(|part| (0.5..2.0).contains(part)), "{name}");
    }
}
