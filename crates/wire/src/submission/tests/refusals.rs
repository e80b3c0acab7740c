//! Each kind of bad value, and its refusal.

use serde::Deserialize;
use serde_json::{Value, json};

use super::case_2;
use crate::Code;
use crate::testing::{echo, fault, parse, put, refused, with};

/// A value that is refused: place of the value, and the refusal.
#[derive(Deserialize)]
struct Refused {
    at: String,
    value: Value,
    told_at: String,
    code: Code,
    /// True if the refusal has a nearest value.
    nearest: bool,
}

#[test]
fn every_kind_of_bad_value_is_refused_with_its_place_and_a_value_that_works() {
    let cases: Vec<Refused> = serde_json::from_str(include_str!("refused.json")).expect("JSON");
    for case in cases {
        let mut document = case_2();
        put(&mut document, &case.at, case.value.clone());
        let problem = parse(&document).expect_err(&case.at);
        let said = format!("{} {}: {problem:?}", case.at, case.value);
        assert_eq!(problem.status, 422, "{said}");
        let error = &problem.errors[0];
        assert_eq!(
            (&error.pointer, error.code),
            (&case.told_at, case.code),
            "{said}"
        );
        assert_eq!(error.nearest.is_some(), case.nearest, "{said}");
        assert!(
            !error.detail.contains("NaN") && !error.detail.contains("inf"),
            "{said}"
        );
    }
}

#[test]
fn the_nearest_values_together_make_a_submission() {
    let changes: &[&[(&str, Value)]] = &[
        &[
            ("/pair/driving/tooth_count", json!(12)),
            ("/pair/driving/blank/bore_radius_mm", json!(30)),
        ],
        &[
            ("/pair/driven/blank/holes/radius_mm", json!(20)),
            ("/pair/driven/addendum_mm", json!(3.9)),
        ],
        &[
            ("/pair/driven/blank/holes/circle_radius_mm", json!(12)),
            ("/output_torques_n_m/0", json!(-1)),
        ],
        &[
            ("/pair/driven/blank/holes/circle_radius_mm", json!(5000)),
            ("/pair/driven/tip_relief/amount_um", json!(-1)),
        ],
        &[
            ("/resolution/positions_per_mesh_period", json!(400)),
            ("/resolution/span_mesh_periods", json!(500)),
        ],
        &[("/pair/center_distance_mm", json!(1e9))],
    ];
    for change in changes {
        let mut document = with(case_2(), change);
        assert!(parse(&document).is_err());
        // Faults that need a whole pair come with a later answer.
        for _ in 0..4 {
            let Err(problem) = parse(&document) else {
                break;
            };
            for error in &problem.errors {
                let nearest = error
                    .nearest
                    .unwrap_or_else(|| panic!("{change:?}: {error:?}"));
                put(&mut document, &error.pointer, json!(nearest));
            }
        }
        assert!(
            parse(&document).is_ok(),
            "{change:?}: {:?}",
            parse(&document)
        );
    }
}

#[test]
fn the_wrong_fields_of_both_gears_are_told_together() {
    let wrong = [
        ("/pair/driving/tooth_count", json!(3)),
        ("/pair/driven/face_width_mm", json!("wide")),
        ("/resolution/grids", json!("fine")),
        ("/method", json!(7)),
    ];
    let document = with(case_2(), &wrong);
    let problem = parse(&document).expect_err("four fields");
    let mut pointers: Vec<_> = problem.errors.iter().map(|error| &*error.pointer).collect();
    pointers.sort_unstable();
    assert_eq!(
        pointers,
        [
            "/method",
            "/pair/driven/face_width_mm",
            "/pair/driving/tooth_count",
            "/resolution/grids"
        ]
    );

    let wrong = [
        ("/pair/driving/blank/bore_radius_mm", json!(50)),
        ("/pair/driven/blank/holes/radius_mm", json!(15)),
    ];
    let problem = parse(&with(case_2(), &wrong)).expect_err("both gears");
    assert_eq!(problem.errors.len(), 2, "{problem:?}");
}

#[test]
fn what_is_too_large_is_told_with_what_would_fit() {
    let mut document = case_2();
    document["output_torques_n_m"] = json!([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
    document["resolution"] = json!({ "positions_per_mesh_period": 400 });
    let problem = parse(&document).expect_err("24,000 positions");
    assert_eq!(problem.code, Code::TooLarge);
    for part in [
        "24000",
        "20000",
        "333 positions",
        "10 torques",
        "4 mesh periods",
    ] {
        assert!(problem.detail.contains(part), "{part}: {}", problem.detail);
    }
    assert_eq!(problem.errors[0].nearest, Some(333.0));
}

#[test]
fn a_run_up_is_refused_where_it_has_no_table_or_no_load_and_the_nearest_will_do() {
    let speeds = json!({ "from": 0, "to": 20_000, "count": 400 });
    let run_up = with(
        case_2(),
        &[("/dynamics", json!({ "driving_speed_rpm": speeds }))],
    );
    assert!(parse(&run_up).is_ok());
    let speeds = json!({ "driving_speed_rpm": { "from": 0, "to": 100, "count": 4000 } });
    let torques: Vec<u32> = (1..=20).collect();
    let many = [
        ("/dynamics", speeds),
        ("/output_torques_n_m", json!(torques)),
        ("/resolution", json!({ "positions_per_mesh_period": 8 })),
    ];
    for (changes, place, code, _) in refused! {
        vec![("/output_torques_n_m", json!([115, 0]))] => "/output_torques_n_m/1", TorqueNotPositive;
        vec![("/resolution", json!({ "span_mesh_periods": 2 }))] => "/resolution/span_mesh_periods", OutOfRange;
        vec![("/force_table", json!({ "largest_output_torque_n_m": 50 }))]
            => "/force_table/largest_output_torque_n_m", OutOfRange;
        vec![("/resolution", json!({ "positions_per_mesh_period": 400 }))]
            => "/resolution/positions_per_mesh_period", TooLarge;
        many.to_vec() => "/dynamics/driving_speed_rpm/count", TooLarge;
    } {
        let mut document = with(run_up.clone(), &changes);
        let nearest = fault(&document, place, code).nearest;
        let nearest = nearest.expect("a nearest value");
        put(&mut document, place, json!(nearest));
        let again = parse(&document);
        assert!(again.is_ok(), "{nearest:?}: {again:?}");
    }
}

#[test]
fn a_run_up_may_be_one_speed() {
    let of = |speed: serde_json::Value| {
        with(
            case_2(),
            &[("/dynamics", json!({ "driving_speed_rpm": speed }))],
        )
    };
    let submission = parse(&of(json!(3000))).expect("valid");
    assert_eq!(
        echo(&submission)["dynamics"]["driving_speed_rpm"],
        json!(3000.0)
    );
    let request = submission.forces().expect("asked for");
    assert_eq!(request.dynamics.as_ref().expect("asked for").speeds, [50.0]);
    for (speed, code) in [
        (json!(-1), Code::OutOfRange),
        (json!(2e6), Code::OutOfRange),
        (json!("fast"), Code::WrongType),
        (json!([1, 2]), Code::WrongType),
    ] {
        fault(&of(speed), "/dynamics/driving_speed_rpm", code);
    }
}

#[test]
fn a_table_of_too_many_positions_is_refused_with_the_loads_that_fit() {
    let mut document = case_2();
    put(
        &mut document,
        "/resolution",
        json!({ "positions_per_mesh_period": 400 }),
    );
    // Five mesh periods: 20,000 / 400 = 5 of the curve and 9 loads of 5.
    let mut with = |loads: u32| {
        put(&mut document, "/force_table", json!({ "loads": loads }));
        parse(&document)
    };
    let problem = with(10).expect_err("too large");
    let detail = &problem.errors[0].detail;
    assert!(detail.contains(", or 9 loads"), "{detail}");
    assert!(with(9).is_ok());
}

#[test]
fn a_run_up_brings_the_usual_table_and_both_count() {
    let mut document = case_2();
    let alone = parse(&document).expect("valid").positions_total();
    put(
        &mut document,
        "/dynamics",
        json!({ "driving_speed_rpm": { "from": 0, "to": 20_000 } }),
    );
    let submission = parse(&document).expect("valid");
    let echo = echo(&submission);
    assert_eq!(
        echo["force_table"],
        json!({ "loads": 12, "largest_output_torque_n_m": null })
    );
    assert_eq!(
        echo["dynamics"],
        json!({ "driving_speed_rpm": { "from": 0.0, "to": 20_000.0, "count": 400 }, "damping_ratio": 0.05,
                "driving_inertia_kg_m2": null, "driven_inertia_kg_m2": null,
                "blank_modes": null, "blank_damping_ratio": 0.02, "sweep": "both" })
    );
    assert_eq!(
        parse(&echo).expect("valid").canonical_json(),
        submission.canonical_json()
    );
    // Twelve loads at twice 40 positions of 5 mesh periods.
    assert_eq!(submission.positions_total(), alone + 12 * 400);
    let request = submission.forces().expect("asked for");
    let speeds = &request.dynamics.as_ref().expect("asked for").speeds;
    assert_eq!((speeds.len(), speeds[0]), (400, 0.0));
    assert!((speeds[399] - 20_000.0 / 60.0).abs() < 1e-9);
}

#[test]
fn shafts_and_supports_reach_the_run_up_and_a_support_that_is_no_stiffness_is_refused_with_its_number()
 {
    let of = |name: &str, value: Value| {
        let dynamics = json!({ "driving_speed_rpm": 3000, name: value });
        with(case_2(), &[("/dynamics", dynamics)])
    };
    let rows = |diagonal: [f64; 6]| -> Vec<Vec<f64>> {
        let row = |i: usize| {
            (0..6)
                .map(|j| if i == j { diagonal[i] } else { 0.0 })
                .collect()
        };
        (0..6).map(row).collect()
    };
    let shafts = of("shaft_stiffness_n_m_per_rad", json!({ "driven": 2e4 }));
    let submission = parse(&shafts).expect("valid");
    let mounts = |submission: &crate::Submission| {
        let request = submission.forces().expect("asked for");
        request.dynamics.as_ref().expect("asked for").mounts
    };
    assert_eq!(
        mounts(&submission).map(|mount| mount.shaft),
        [None, Some(2e4)]
    );
    assert_eq!(
        echo(&submission)["dynamics"]["shaft_stiffness_n_m_per_rad"],
        json!({ "driving": null, "driven": 2e4 })
    );
    let support = |rows: Vec<Vec<f64>>| of("support_stiffness", json!({ "driving": rows }));
    let pointer = "/dynamics/support_stiffness/driving";
    let whole = rows([1e8, 2e8, 3e7, 1e5, 1e5, 0.0]);
    let submission = parse(&support(whole.clone())).expect("valid");
    let found = mounts(&submission)[0].support.expect("given");
    assert_eq!((found[1][1], found[5][5], found[0][1]), (2e8, 0.0, 0.0));
    let said = |document: &Value, pointer: &str, code: Code| {
        let problem = parse(document).expect_err("refused");
        let error = &problem.errors[0];
        assert_eq!((error.pointer.as_str(), error.code), (pointer, code));
        (error.nearest, error.detail.clone())
    };
    let (nearest, _) = said(&support(whole[..5].to_vec()), pointer, Code::WrongLength);
    assert_eq!(nearest, Some(6.0));
    let mut short = whole.clone();
    short[2].pop();
    said(&support(short), &format!("{pointer}/2"), Code::WrongLength);
    let mut askew = whole.clone();
    askew[4][0] = 3e6;
    let (nearest, detail) = said(&support(askew), &format!("{pointer}/4/0"), Code::OutOfRange);
    assert_eq!(nearest, Some(0.0));
    assert!(detail.contains("3000000"), "{detail}");
    // (a − b) and (a + b) of a pair of rows with a on the diagonal and b beside it.
    let mut pushing = whole;
    (pushing[1][1], pushing[0][1], pushing[1][0]) = (1e8, 1.5e8, 1.5e8);
    let (_, detail) = said(&support(pushing), pointer, Code::OutOfRange);
    assert!(detail.contains("-50000000"), "{detail}");
    // Nothing along y: cos² of the working pressure angle of the force is left.
    let (_, detail) = said(
        &support(rows([1e8, 0.0, 0.0, 0.0, 0.0, 0.0])),
        pointer,
        Code::OutOfRange,
    );
    assert!(detail.contains("93.5 %"), "{detail}");
}

#[test]
fn the_usual_table_ends_at_what_the_teeth_bear() {
    let of = |torque: f64| {
        let speeds = json!({ "driving_speed_rpm": 3000 });
        let changes = [
            ("/output_torques_n_m", json!([torque])),
            ("/dynamics", speeds),
        ];
        let submission = parse(&with(case_2(), &changes)).expect("valid");
        submission
            .forces()
            .expect("asked for")
            .table
            .largest_output_torque
    };
    // A quarter of the module of 2 mm, 14 N/(mm um) of steel, 20 mm of face, and a base radius of
    // 50 mm cos 20 degrees.
    let bearable = 0.25 * 2e-3 * 14e9 * 20e-3 * 50e-3 * 20_f64.to_radians().cos();
    assert_eq!(of(0.4 * bearable), None);
    let largest = of(0.6 * bearable).expect("less than twice the torque");
    assert!(
        (largest / bearable - 1.0).abs() < 1e-9,
        "{largest} N m, not {bearable}"
    );
}

#[test]
fn stresses_are_refused_by_each_method_that_tells_none() {
    let asking = |method: &str| {
        with(
            case_2(),
            &[("/method", json!(method)), ("/stress", json!(true))],
        )
    };
    for method in ["flexible", "three_dimensional"] {
        assert!(parse(&asking(method)).is_ok(), "{method}");
    }
    for method in [
        "decomposition",
        "projected_decomposition",
        "three_dimensional_projected",
        "load_distribution",
    ] {
        fault(&asking(method), "/stress", Code::QuantityNotTold);
        let silent = with(asking(method), &[("/stress", json!(false))]);
        assert!(parse(&silent).is_ok(), "{method}");
    }
}

#[test]
fn a_refusal_says_what_is_meant_and_proposes_no_other_pair() {
    let said = |at: &str, value: Value, code: Code| {
        let mut document = case_2();
        put(&mut document, at, value);
        let error = parse(&document).expect_err(at).errors.remove(0);
        assert_eq!(error.code, code, "{error:?}");
        (error.detail, error.nearest)
    };
    let (detail, _) = said("/method", json!("flexibel"), Code::WrongType);
    assert!(detail.contains("Is flexible meant?"), "{detail}");
    let (detail, _) = said("/method", json!("Flexible"), Code::WrongType);
    assert!(detail.contains("Is flexible meant?"), "{detail}");
    let (detail, _) = said("/method", json!("boundary"), Code::WrongType);
    assert!(!detail.contains("meant"), "{detail}");
    for (at, place) in [
        ("/pair/driven/helix", "/pair/helix_angle_deg"),
        ("/pair/driven/helix_angle_deg", "/pair/helix_angle_deg"),
        (
            "/pair/driven/bore_radius_mm",
            "/pair/driven/blank/bore_radius_mm",
        ),
        (
            "/positions_per_mesh_period",
            "/resolution/positions_per_mesh_period",
        ),
        ("/pair/driving/z", "/pair/driving/tooth_count"),
        ("/pair/driven/m_n", "/pair/driven/module_mm"),
        ("/pair/a", "/pair/center_distance_mm"),
        ("/pair/driven/beta", "/pair/helix_angle_deg"),
        ("/torque", "/output_torques_n_m"),
        (
            "/pair/driven/blank/bore_diameter_mm",
            "/pair/driven/blank/bore_radius_mm",
        ),
        (
            "/pair/driven/bore_diameter_mm",
            "/pair/driven/blank/bore_radius_mm",
        ),
    ] {
        let (detail, _) = said(at, json!(9), Code::UnknownField);
        assert!(detail.ends_with(&format!("Is {place} meant?")), "{detail}");
    }
    let (detail, _) = said("/pair/driven/unheard_of", json!(9), Code::UnknownField);
    assert!(!detail.contains("meant"), "{detail}");
    let relief = json!({ "amount_um": 5 });
    let (detail, _) = said("/pair/driving/tip_relief", relief, Code::MissingField);
    for way in [
        "radial_length_mm",
        "roll_length_from_tip_mm",
        "diameter_mm",
        "roll_angle_deg",
    ] {
        assert!(detail.contains(way), "{way}: {detail}");
    }
    let (detail, nearest) = said(
        "/pair/helix_angle_deg",
        json!(15),
        Code::NeedsThreeDimensions,
    );
    assert!(
        detail.contains("three_dimensional") && nearest.is_none(),
        "{detail}"
    );
    let (detail, nearest) = said("/pair/driven/tooth_count", json!(-50), Code::OutOfRange);
    assert!(
        detail.contains("internal gears are not computed") && nearest.is_none(),
        "{detail}"
    );
    let place = "/pair/driven/blank/bore_radius_mm";
    let (detail, nearest) = said(place, json!(47), Code::BoreTooLarge);
    let largest = format!(" The largest is {} mm.", nearest.expect("a radius"));
    assert!(detail.ends_with(&largest), "{detail}");
}

#[test]
fn windows_lie_apart_in_a_true_period_that_is_longer() {
    // The holes of case 2 repeat after five mesh periods.
    let over = |span: u32, starts: Value| {
        let resolution = json!({ "span_mesh_periods": span, "window_starts": starts });
        with(case_2(), &[("/resolution", resolution)])
    };
    let submission = parse(&over(2, json!([1, 3]))).expect("valid");
    assert_eq!(submission.case().windows, [1, 3]);
    assert_eq!(submission.case().resolution.first_position, 1.0);
    assert_eq!(submission.positions_total(), 2 * 2 * 40);
    assert!(
        submission
            .canonical_json()
            .contains("\"window_starts\":[1,3]")
    );
    let place = "/resolution/window_starts";
    fault(&over(5, json!([0])), place, Code::ConflictingFields);
    let beyond = fault(
        &over(2, json!([5])),
        &format!("{place}/0"),
        Code::OutOfRange,
    );
    assert_eq!(beyond.nearest, Some(4.0));
    // The second one begins within the first, and the last one runs over the end into the first.
    for starts in [json!([1, 2]), json!([0, 4])] {
        fault(&over(2, starts), &format!("{place}/1"), Code::OutOfRange);
    }
    let none = over(2, json!([]));
    fault(&none, place, Code::WrongLength);
    let whole = parse(&case_2()).expect("valid").canonical_json();
    assert!(!whole.contains("window_starts"));
}

#[test]
fn modes_are_filled_in_and_more_than_the_grid_of_a_gear_carries_are_refused_with_the_most() {
    let of = |modes: Value| with(case_2(), &[("/modes", modes)]);
    let submission = parse(&of(json!({}))).expect("valid");
    assert_eq!(
        echo(&submission)["modes"],
        json!({ "count": 20, "highest_hz": null, "bore": "held" })
    );
    assert!(
        submission
            .modes()
            .is_some_and(|request| request.speeds.is_none())
    );
    // 50 teeth: an order of each kind up to half as many.
    let problem = parse(&of(json!({ "count": 51 }))).expect_err("too many");
    let error = &problem.errors[0];
    assert_eq!(
        (error.pointer.as_str(), error.code),
        ("/modes/count", Code::OutOfRange)
    );
    assert_eq!(error.nearest, Some(50.0));
    assert!(parse(&of(json!({ "count": 50 }))).is_ok());
    fault(&of(json!({ "count": 0 })), "/modes/count", Code::OutOfRange);
    fault(
        &of(json!({ "highest_hz": 0 })),
        "/modes/highest_hz",
        Code::OutOfRange,
    );
    // The estimate of the job has the modes in it.
    let bare = parse(&case_2()).expect("valid").estimate();
    assert!(submission.estimate().seconds > bare.seconds);
}
