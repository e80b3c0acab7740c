//! The flexible method against Table 2 of the paper, with what the paper leaves open filled in as the README says.
//!
//! Bores and hole circles were fitted to the means of δ, so that the means of δ test little; rms and peak-to-peak of δ, and
//! the stiffness, test the method.

use meshwright_engine::analysis::Statistics;
use serde_json::Value;

use crate::reference;
use crate::support::{case, paper_case, solve};

/// The stiffness of case 3 takes the load as T/R_b1 where it is T/R_b2.
const CASE_3_LOAD: f64 = 85.0 / 29.0;

/// Relative differences (mean, rms, peak-to-peak); `None` where the table has no number.
fn differences(ours: &Statistics, table: &Value, unit: f64) -> [Option<f64>; 3] {
    [
        (ours.mean, "mean"),
        (ours.rms, "rms"),
        (ours.peak_to_peak, "peak_to_peak"),
    ]
    .map(|(ours, key)| {
        table[key]
            .as_f64()
            .map(|theirs| ours / (theirs * unit) - 1.0)
    })
}

fn check(number: u32, mean_bound: f64, fluctuation_bound: f64) {
    let table = reference("paper-table-2.json");
    let entry = table["cases"]
        .as_array()
        .expect("cases")
        .iter()
        .find(|entry| entry["case"] == number)
        .expect("the case is in the table");
    let (pair, torque) = paper_case(number);
    assert_eq!(entry["output_torque_n_m"].as_f64(), Some(torque));
    let curve = &solve(&case(pair, &[torque])).curves[0];
    let stiffness_unit = if number == 3 { 1.0 / CASE_3_LOAD } else { 1.0 };
    let flexible = &entry["flexible"];
    let rows = [
        (
            "delta",
            &curve.transmission_error_statistics,
            &flexible["ste_um"],
            1e-6,
        ),
        (
            "k",
            &curve.mesh_stiffness_tangent_statistics,
            &flexible["k_n_per_m"],
            stiffness_unit,
        ),
    ];
    for (name, ours, theirs, unit) in rows {
        let [mean, rms, peak_to_peak] = differences(ours, theirs, unit);
        println!("case {number}, {name}: {ours:?}: {mean:+.4?} {rms:+.4?} {peak_to_peak:+.4?}");
        assert!(
            mean.expect("a mean").abs() < mean_bound,
            "mean of {name}: {mean:?}"
        );
        for difference in [rms, peak_to_peak].into_iter().flatten() {
            assert!(difference.abs() < fluctuation_bound, "{name}: {difference}");
        }
    }
}

#[test]
#[ignore = "./test all"]
fn eight_holes_in_both_gears_give_table_2() {
    check(1, 0.04, 0.13);
}

#[test]
fn ten_holes_in_the_driven_gear_give_table_2() {
    check(2, 0.04, 0.13);
}

#[test]
#[ignore = "./test all"]
fn a_reducer_with_six_large_holes_gives_table_2_within_what_its_misprints_leave() {
    check(3, 0.07, 0.20);
}
