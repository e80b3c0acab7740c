//! Pairs that run: what is read of them, and what is refused.

use meshwright_engine::analysis::running::Bore;
use meshwright_engine::gear::Member;
use serde_json::{Value, json};

use super::case_2;
use crate::Code;
use crate::testing::{echo, fault, parse, with};

fn running(running: &Value) -> Value {
    with(case_2(), &[("/running", running.clone())])
}

#[test]
fn a_pair_that_runs_is_echoed_with_its_defaults_and_read_in_the_units_of_its_fields() {
    let asked =
        json!({ "driving_speed_rpm": 12_000, "press_fit_um": { "driven": 20 }, "bore": "free" });
    let submission = parse(&running(&asked)).expect("valid");
    assert_eq!(
        echo(&submission)["running"],
        json!({
            "driving_speed_rpm": 12_000.0, "temperature_c": null, "reference_c": 20.0,
            "press_fit_um": { "driving": null, "driven": 20.0 }, "bore": "free",
            "housing_temperature_c": null, "housing_expansion_per_k": 11.5e-6
        })
    );
    let case = submission.case();
    let found = case.running.expect("it runs");
    assert!((found.driving_speed.0 - 200.0).abs() < 1e-12);
    let [driving, driven] = found.gears.map(|gear| gear.bore);
    assert_eq!(driving, Bore::Free);
    // Half of the interference of the diameters.
    assert_eq!(
        driven,
        Bore::PressFit {
            interference: 10e-6
        }
    );
    assert_eq!(case.pair.center_distance(), 100.5e-3);
}

#[test]
fn gears_and_housing_grow_by_their_own_expansions() {
    let warm = |housing: f64, expansion: f64| {
        json!({
            "temperature_c": { "driving": 80, "driven": 60 },
            "housing_temperature_c": housing, "housing_expansion_per_k": expansion
        })
    };
    let submission = parse(&running(&warm(50.0, 23e-6))).expect("valid");
    let found = submission.case().running.expect("it runs");
    for (member, risen) in Member::BOTH.into_iter().zip([60.0, 40.0]) {
        let strain = found.gears[member.index()].thermal_strain;
        assert!((strain - risen * 11.5e-6).abs() < 1e-15);
    }
    // In lengths of gears that have grown by 50 K in the mean.
    let expected = 100.5e-3 * (1.0 + 30.0 * 23e-6) / (1.0 + 50.0 * 11.5e-6);
    assert!((submission.case().pair.center_distance() - expected).abs() < 1e-15);
    // Along faces too.
    let along = with(
        running(&warm(50.0, 23e-6)),
        &[("/method", json!("three_dimensional"))],
    );
    let along = parse(&along).expect("valid").case().pair.center_distance();
    assert_eq!(along, submission.case().pair.center_distance());
    let alike = parse(&running(&warm(70.0, 11.5e-6))).expect("valid");
    assert!((alike.case().pair.center_distance() - 100.5e-3).abs() < 1e-15);
}

#[test]
fn what_cannot_run_is_refused_with_its_place() {
    let turning = json!({ "driving_speed_rpm": 12_000 });
    let by = |method: &str| with(running(&turning), &[("/method", json!(method))]);
    fault(&by("load_distribution"), "/running", Code::QuantityNotTold);
    for method in [
        "decomposition",
        "projected_decomposition",
        "three_dimensional",
        "three_dimensional_projected",
    ] {
        parse(&by(method)).expect("it sees what rotation does");
    }
    // Along faces too, with stresses.
    let fitted = running(&json!({ "press_fit_um": { "driving": 20 } }));
    let along = [
        ("/method", json!("three_dimensional")),
        ("/stress", json!(true)),
    ];
    let fitted = parse(&with(fitted, &along)).expect("it sees fits");
    let bores = fitted
        .case()
        .running
        .expect("it runs")
        .gears
        .map(|gear| gear.bore);
    let interference = 10e-6;
    assert_eq!(bores, [Bore::PressFit { interference }, Bore::Held]);
    // But for a gear that its holes pull to one side.
    let uneven = json!([
        { "at_deg": [0, 140], "circle_radius_mm": 34, "radius_mm": 7.5 },
        { "at_deg": [250], "circle_radius_mm": 34, "radius_mm": 6 }
    ]);
    for (bore, place) in [
        (
            json!({ "press_fit_um": { "driven": 20 } }),
            "/running/press_fit_um/driven",
        ),
        (
            json!({ "driving_speed_rpm": 9000, "bore": "free" }),
            "/running/bore",
        ),
    ] {
        let along = [
            ("/method", json!("three_dimensional")),
            ("/pair/driven/blank/holes", uneven.clone()),
        ];
        let along = with(running(&bore), &along);
        fault(&along, place, Code::NotInThreeDimensions);
        parse(&with(along, &[("/method", json!("flexible"))])).expect("seen in the plane");
    }
    let run_up = json!({ "driving_speed_rpm": 3000 });
    let run_up = with(running(&turning), &[("/dynamics", run_up)]);
    fault(&run_up, "/dynamics", Code::QuantityNotTold);
    let hot = running(&json!({ "temperature_c": { "driven": 900 } }));
    let hot = fault(&hot, "/running/temperature_c/driven", Code::OutOfRange);
    assert_eq!(hot.nearest, Some(500.0));
    let backwards = running(&json!({ "driving_speed_rpm": -1 }));
    fault(&backwards, "/running/driving_speed_rpm", Code::OutOfRange);
    let on_shaft = with(
        running(&json!({ "press_fit_um": { "driving": 20 } })),
        &[(
            "/pair/driving/blank",
            json!({ "shaft": { "radius_mm": 16 } }),
        )],
    );
    fault(
        &on_shaft,
        "/running/press_fit_um/driving",
        Code::ConflictingFields,
    );
    // Gears hot in a cold housing, all but without backlash.
    let tight = with(
        running(&json!({ "temperature_c": { "driving": 120, "driven": 120 } })),
        &[("/pair/center_distance_mm", json!(100.05))],
    );
    let tight = fault(&tight, "/running", Code::NegativeBacklash);
    assert!(tight.detail.contains("warm gears"), "{}", tight.detail);
}
