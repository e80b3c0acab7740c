//! Expansion of a study, and its refusals.

use meshwright_wire::examples::STUDY_SECTION_5;
use serde_json::json;

use super::*;
use crate::testing::study as parse;

#[test]
fn the_studies_in_the_guides_are_studies() {
    let guides = [
        include_str!("../../../../docs/choose-a-relief.md"),
        include_str!("../../../../docs/is-my-thin-web-all-right.md"),
    ];
    for guide in guides {
        let blocks = guide.split("```json\n").skip(1);
        let document = blocks
            .filter_map(|block| block.split("```").next())
            .find(|block| block.contains("\"axes\""))
            .expect("a study");
        let study = Study::parse(document.as_bytes(), &Run::unattended()).expect(document);
        assert!(designs(&study).len() >= 4);
    }
}

#[test]
fn a_study_is_kept_as_it_was_written_but_for_white_space() {
    let kept = r#"{"name":"a \" \\","base":BASE,"axes":[{"path":"/output_torques_n_m/0","values":[1.50,2e1]}]}"#
        .replace("BASE", &base().to_string());
    let sent = kept
        .replace(r#"":"#, "\" :\r\n\t")
        .replace("],", " ] ,")
        .replace("1.50,", " 1.50 , ");
    assert_ne!(sent, kept);
    let study = Study::parse(sent.as_bytes(), &Run::unattended()).unwrap();
    assert_eq!(study.document(), kept);
    let told: Vec<String> = (0..2).map(|row| study.design(row).unwrap().label).collect();
    assert_eq!(
        told,
        ["output_torques_n_m.0=1.5", "output_torques_n_m.0=20.0"]
    );
}

fn base() -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 }
    });
    json!({
        "method": "decomposition",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [115.0]
    })
}

fn axes(axes: Value) -> Value {
    json!({ "base": base(), "axes": axes })
}

fn listed(designs: Value) -> Value {
    json!({ "base": base(), "designs": designs })
}

/// The designs of a study of constant mass, all of which remove this share of the driven blank.
fn removing(document: &Value, share: f64) -> Vec<Design> {
    let designs = designs(&parse(document).unwrap());
    for design in &designs {
        let driven = design.submission.as_ref().unwrap().case().pair.driven();
        // The engine has the area of a slot from its outline.
        let removed = driven.removed_fraction();
        assert!((removed - share).abs() < 1e-10, "{removed}");
    }
    designs
}

fn designs(study: &Study) -> Vec<Design> {
    (0..).map_while(|row| study.design(row)).collect()
}

/// True if a study is refused with this code, at these places.
fn refuses(document: &Value, code: Code, places: &[&str]) {
    let places: Vec<String> = places.iter().map(|place| (*place).to_owned()).collect();
    assert_eq!(refused(document), (code, places), "{document}");
}

/// The refusal of a study: code and pointers.
fn refused(document: &Value) -> (Code, Vec<String>) {
    let problem = parse(document).expect_err("refused");
    let pointers = problem.errors.iter().map(|error| error.pointer.clone());
    (problem.code, pointers.collect())
}

#[test]
fn axes_give_every_combination_and_the_last_one_changes_fastest() {
    let study = parse(&axes(json!([
        { "path": "/method", "values": ["flexible", "projected_decomposition"] },
        { "path": "/output_torques_n_m/0", "values": [20, 115.5, 300] },
    ])))
    .unwrap();
    let designs = designs(&study);
    assert_eq!((study.total(), designs.len()), (6, 6));
    let labels: Vec<&str> = designs.iter().map(|design| &*design.label).collect();
    assert_eq!(
        labels,
        [
            "method=flexible, output_torques_n_m.0=20",
            "method=flexible, output_torques_n_m.0=115.5",
            "method=flexible, output_torques_n_m.0=300",
            "method=projected_decomposition, output_torques_n_m.0=20",
            "method=projected_decomposition, output_torques_n_m.0=115.5",
            "method=projected_decomposition, output_torques_n_m.0=300",
        ]
    );
    let fifth = designs[4].submission.as_ref().unwrap();
    assert_eq!(fifth.method(), "projected_decomposition");
    assert_eq!(fifth.case().output_torques, [115.5]);
    assert_eq!(
        Value::Object(designs[4].changes.clone()),
        json!({ "/method": "projected_decomposition", "/output_torques_n_m/0": 115.5 })
    );
}

#[test]
fn labels_tell_equal_fields_of_both_gears_apart_and_number_what_is_long() {
    let holes = |count: u32| json!({ "count": count, "circle_radius_mm": 34.0, "radius_mm": 5.0 });
    let study = parse(&axes(json!([
        { "path": "/pair/driving/blank/bore_radius_mm", "values": [15] },
        { "path": "/pair/driven/blank/bore_radius_mm", "values": [16] },
        { "path": "/pair/driven/blank/holes", "values": [holes(6), holes(8)] },
    ])))
    .unwrap();
    let label = study.design(1).unwrap().label;
    assert_eq!(
        label,
        "driving.blank.bore_radius_mm=15, driven.blank.bore_radius_mm=16, holes#2"
    );
}

#[test]
fn constant_mass_sets_the_radius_that_the_paper_s_quarter_needs() {
    // DESIGN section 4: 25 % between bore 15 and the mean of 52 and 47.5 mm is 7.500 (10), 8.385 (8), 9.683 (6) mm.
    let study = Study::parse(STUDY_SECTION_5.as_bytes(), &Run::unattended()).unwrap();
    assert_eq!((study.total(), study.gear()), (6, GearName::Driven));
    let designs = designs(&study);
    let radius = |design: &Design| {
        let radius = design.changes.get("/pair/driven/blank/holes/radius_mm");
        radius.and_then(Value::as_f64)
    };
    for (design, (label, printed)) in designs.iter().zip([
        ("standard", None),
        ("8R34", Some(8.385)),
        ("10R34", Some(7.500)),
        ("6R30", Some(9.683)),
        ("8R30", Some(8.385)),
        ("8R27", Some(8.385)),
    ]) {
        assert_eq!(design.label, label);
        let submission = design.submission.as_ref().expect("can be built");
        let driven = submission.case().pair.driven();
        match printed {
            // Half a digit of the printed value.
            Some(printed) => {
                assert!((radius(design).unwrap() - printed).abs() < 5e-4, "{label}");
                assert!((driven.removed_fraction() - 0.25).abs() < 1e-10, "{label}");
            }
            None => {
                assert_eq!((radius(design), driven.has_holes()), (None, false));
            }
        }
        assert_eq!(submission.case().output_torques, [20.0, 115.0]);
    }
}

#[test]
fn constant_mass_follows_shift_addendum_and_bore_of_its_own_gear() {
    let mut document = axes(json!([
        { "path": "/pair/driving/blank/bore_radius_mm", "values": [12, 18] },
        { "path": "/pair/driving/profile_shift", "values": [0, 0.1] },
        { "path": "/pair/driving/addendum_mm", "values": [1.9, 2.0] },
    ]));
    document["base"]["pair"]["center_distance_mm"] = json!(101.0);
    document["base"]["pair"]["driving"]["blank"]["holes"] =
        json!({ "count": 8, "circle_radius_mm": 31.0 });
    document["constant_mass"] = json!({ "gear": "driving", "mass_removed_percent": 10 });
    let study = parse(&document).unwrap();
    assert_eq!(study.gear(), GearName::Driving);
    for design in designs(&study) {
        let submission = design.submission.unwrap();
        let removed = submission.case().pair.driving().removed_fraction();
        assert!((removed - 0.1).abs() < 1e-10, "{}: {removed}", design.label);
    }
}

#[test]
fn a_design_that_cannot_be_built_has_a_problem_and_the_others_do_not() {
    let study = parse(&axes(json!([
        { "path": "/pair/center_distance_mm", "values": [100.5, 118.5, 1e9] },
    ])))
    .unwrap();
    let outcomes: Vec<_> = designs(&study)
        .into_iter()
        .map(|design| {
            design
                .submission
                .map(|_| ())
                .map_err(|problem| problem.code)
        })
        .collect();
    assert_eq!(
        outcomes,
        [Ok(()), Err(Code::TeethDoNotReach), Err(Code::OutOfRange)]
    );
    let impossible = parse(&listed(
        json!([{ "label": "a", "changes": { "/pair/center_distance_mm": 118.5 } }]),
    ));
    assert!(impossible.unwrap().design(0).unwrap().submission.is_err());
}

#[test]
fn a_pointer_that_names_nothing_is_refused_with_its_place() {
    let document = axes(json!([
        { "path": "/method", "values": ["flexible"] },
        { "path": "/pair/driven/blank/holes/cuont", "values": [6] },
    ]));
    refuses(&document, Code::UnknownField, &["/axes/1/path"]);
    let document = listed(json!([{ "label": "a", "changes": { "/pair/driven/hole": 6 } }]));
    refuses(
        &document,
        Code::UnknownField,
        &["/designs/0/changes/~1pair~1driven~1hole"],
    );
    let document = axes(json!([{ "path": "/output_torques_n_m/7", "values": [6] }]));
    refuses(&document, Code::UnknownField, &["/axes/0/values/0"]);
}

#[test]
fn one_design_of_the_wrong_type_among_many_of_the_right_one_is_found() {
    let counts = [
        json!(8),
        json!(9),
        json!(1e6),
        json!(10),
        json!(8.5),
        json!(7),
        json!("9"),
    ];
    let designs = counts.iter().enumerate().map(|(i, count)| {
        json!({ "label": i.to_string(), "changes": { "/pair/driven/blank/holes/count": count } })
    });
    let places =
        [4, 6].map(|i| format!("/designs/{i}/changes/~1pair~1driven~1blank~1holes~1count"));
    let document = listed(designs.collect());
    refuses(&document, Code::WrongType, &[&places[0], &places[1]]);
    // Digits of torques are counted from the first one; that one is out of range, which its design reports.
    let torques = [
        json!([-1.5]),
        json!([1.5]),
        json!([2.25]),
        json!(["1.5"]),
        json!([3.5]),
    ];
    let designs = torques.iter().enumerate().map(|(i, torques)| {
        json!({ "label": i.to_string(), "changes": { "/output_torques_n_m": torques } })
    });
    let document = listed(designs.collect());
    refuses(
        &document,
        Code::WrongType,
        &["/designs/3/changes/~1output_torques_n_m"],
    );
}

#[test]
fn values_of_the_wrong_type_are_refused_with_their_place() {
    let document = axes(json!([
        { "path": "/pair/driven/tooth_count", "values": [50, "50", 50.5, null] },
    ]));
    let places = ["/axes/0/values/1", "/axes/0/values/2", "/axes/0/values/3"];
    refuses(&document, Code::WrongType, &places);
    let document = listed(json!([
        { "label": "a", "changes": { "/pair/driven/blank/holes": { "count": 8, "circle_radius_mm": 34, "radius": 3 } } },
        { "label": "b", "changes": { "/method": "fast" } },
    ]));
    assert_eq!(
        refused(&document).1,
        [
            "/designs/0/changes/~1pair~1driven~1blank~1holes",
            "/designs/1/changes/~1method"
        ]
    );
    #[rustfmt::skip]
    let cases = [
        (json!([]), ""),
        (json!({ "base": [], "axes": [{ "path": "/method", "values": ["flexible"] }] }), "/base"),
        (json!({ "base": base() }), "/designs"),
        (json!({ "base": base(), "axes": {} }), "/axes"),
        (axes(json!([])), "/axes"),
        (axes(json!([5])), "/axes/0"),
        (axes(json!([{ "path": 5, "values": [1] }])), "/axes/0/path"),
        (axes(json!([{ "path": "/method", "values": "flexible" }])), "/axes/0/values"),
        (axes(json!([{ "path": "/method", "values": [] }])), "/axes/0/values"),
        (axes(json!([{ "path": "/method", "values": ["flexible"], "x": 1 }])), "/axes/0/x"),
        (listed(json!([])), "/designs"),
        (listed(json!([{ "label": 1 }])), "/designs/0/label"),
        (listed(json!([{ "label": "" }])), "/designs/0/label"),
        (listed(json!([{ "changes": {} }])), "/designs/0/label"),
        (listed(json!([{ "label": "a", "changes": [] }])), "/designs/0/changes"),
    ];
    for (document, pointer) in cases {
        assert_eq!(refused(&document).1, [pointer], "{document}");
    }
    // JSON has no NaN.
    let problem = Study::parse(br#"{ "base": { "x": NaN } }"#, &Run::unattended()).unwrap_err();
    assert_eq!(problem.code, Code::MalformedJson);
}

#[test]
fn a_base_with_a_field_that_is_not_known_is_refused_once_and_not_in_every_row() {
    let mut document = axes(json!([{ "path": "/method", "values": ["flexible"] }]));
    document["base"]["pair"]["driven"]["colour"] = json!("red");
    document["base"]["method"] = json!("replaced by the axis");
    refuses(&document, Code::UnknownField, &["/base/pair/driven/colour"]);
}

#[test]
fn repeated_labels_and_values_are_refused() {
    let document = listed(json!([{ "label": "a" }, { "label": "b" }, { "label": "a" }]));
    refuses(&document, Code::OutOfRange, &["/designs/2/label"]);
    // 6 and 6.0 are one number.
    let mut document =
        axes(json!([{ "path": "/pair/driven/blank/bore_radius_mm", "values": [6, 7, 6.0] }]));
    refuses(&document, Code::OutOfRange, &["/axes/0/values/2"]);
    document["designs"] = json!([{ "changes": {} }]);
    refuses(&document, Code::ConflictingFields, &["/designs"]);
}

#[test]
fn a_change_that_undoes_another_is_refused() {
    let document = axes(json!([
        { "path": "/pair/driven/blank/bore_radius_mm", "values": [15] },
        { "path": "/pair/driven/blank", "values": [{ "bore_radius_mm": 16 }] },
    ]));
    refuses(&document, Code::OutOfRange, &["/axes/1/path"]);
    // The other way round the second refines the first.
    let document = axes(json!([
        { "path": "/pair/driven/blank", "values": [{ "bore_radius_mm": 16 }] },
        { "path": "/pair/driven/blank/bore_radius_mm", "values": [15, 17] },
    ]));
    assert!(parse(&document).is_ok());
    let mut document =
        axes(json!([{ "path": "/pair/driven/blank/holes/radius_mm", "values": [5] }]));
    document["constant_mass"] = json!({ "gear": "driven", "mass_removed_percent": 25 });
    refuses(&document, Code::OutOfRange, &["/axes/0/path"]);
}

#[test]
fn a_study_keeps_results_unless_it_asks_for_statistics_only() {
    let mut document = listed(json!([{ "label": "a" }]));
    assert_eq!(parse(&document).unwrap().keep(), Kept::Results);
    document["keep"] = json!("statistics");
    assert_eq!(parse(&document).unwrap().keep(), Kept::Statistics);
    document["keep"] = json!("curves");
    let problem = parse(&document).unwrap_err();
    assert_eq!(problem.errors[0].pointer, "/keep");
    assert!(
        problem.detail.contains("one of results, statistics"),
        "{}",
        problem.detail
    );
}

#[test]
fn ten_million_designs_are_refused_with_the_limit_before_any_is_expanded() {
    let values: Vec<u32> = (0..57).collect();
    let product = json!(["count", "circle_radius_mm", "radius_mm", "phase_deg"].map(
        |field| json!({ "path": format!("/pair/driven/blank/holes/{field}"), "values": values })
    ));
    let problem = parse(&axes(product)).unwrap_err();
    assert_eq!((problem.code, problem.status), (Code::TooLarge, 422));
    assert!(problem.detail.contains("10556001") && problem.detail.contains("100000"));
    assert_eq!(problem.errors[0].nearest, Some(100_000.0));

    let long = format!("[{}0]", "0,".repeat(9_999_999));
    let text =
        format!(r#"{{ "base": {{}}, "axes": [{{ "path": "/method", "values": {long} }}] }}"#);
    let problem = Study::parse(text.as_bytes(), &Run::unattended()).unwrap_err();
    assert_eq!(problem.code, Code::TooLarge);
    assert!(
        problem.detail.contains("10000000 designs"),
        "{}",
        problem.detail
    );
    let text = format!(r#"{{ "base": {{}}, "designs": {long} }}"#);
    assert_eq!(
        Study::parse(text.as_bytes(), &Run::unattended())
            .unwrap_err()
            .code,
        Code::TooLarge
    );
}

#[test]
fn a_base_that_no_design_mends_is_refused_once() {
    let torques = |torques: Value, changed: Value| {
        let mut document = axes(changed);
        document["base"]["output_torques_n_m"] = torques;
        document
    };
    let bores = json!([{ "path": "/pair/driven/blank/bore_radius_mm", "values": [15, 16] }]);
    let too_many: Vec<u32> = (1..=61).collect();
    let place = ["/base/output_torques_n_m"];
    refuses(
        &torques(json!(too_many), bores.clone()),
        Code::TooLarge,
        &place,
    );
    refuses(
        &torques(json!([-1]), bores.clone()),
        Code::TorqueNotPositive,
        &["/base/output_torques_n_m/0"],
    );
    let mut document = axes(bores);
    document["base"].as_object_mut().unwrap().remove("method");
    refuses(&document, Code::MissingField, &["/base/method"]);
    // A value that every design brings may be absent or wrong in the base.
    document["axes"] = json!([{ "path": "/method", "values": ["flexible"] }]);
    assert!(parse(&document).is_ok());
    let item = json!([{ "path": "/output_torques_n_m/0", "values": [20] }]);
    assert!(parse(&torques(json!([-1]), item.clone())).is_ok());
    // One torque of too many is still one too many.
    refuses(&torques(json!(too_many), item), Code::TooLarge, &place);
}

#[test]
fn a_bomb_is_refused_before_it_is_expanded() {
    let torques: Vec<f64> = (1..=60_000).map(f64::from).collect();
    let values: Vec<f64> = (0..10_000).map(|i| 10.0 + f64::from(i) * 1e-4).collect();
    let mut document =
        axes(json!([{ "path": "/pair/driven/blank/bore_radius_mm", "values": values }]));
    document["base"]["output_torques_n_m"] = json!(torques);
    // Expanded it would take minutes, and more memory than there is.
    refuses(&document, Code::TooLarge, &["/base"]);

    // As many torques as one submission may have values, changed away in each of ten thousand designs.
    document["base"]["output_torques_n_m"] = json!(vec![1.0; 19_900]);
    document["axes"] = json!([
        { "path": "/output_torques_n_m", "values": [[1.0]] },
        { "path": "/pair/driven/blank/bore_radius_mm", "values": values },
    ]);
    refuses(&document, Code::TooLarge, &["/base"]);
}

#[test]
fn nobody_waits_for_a_study_whose_request_has_ended() {
    let stop = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(true));
    let document = axes(json!([{ "path": "/method", "values": ["flexible"] }])).to_string();
    let problem = Study::parse(document.as_bytes(), &Run::new(stop, |_, _| {})).unwrap_err();
    assert_eq!(problem.code, Code::Stopped);
}

#[test]
fn a_study_has_a_name_and_tags_that_change_no_design() {
    let mut document = axes(json!([{ "path": "/method", "values": ["flexible"] }]));
    document["name"] = json!("holes of the wheel");
    document["tags"] = json!(["tuesday"]);
    let study = parse(&document).unwrap();
    assert_eq!(study.name(), Some("holes of the wheel"));
    assert_eq!(study.tags(), ["tuesday"]);
    document["name"] = json!("");
    document["tags"] = json!([7]);
    assert_eq!(refused(&document).1, ["/name", "/tags/0"]);
}

#[test]
fn a_study_varies_a_modification_in_its_list() {
    let path = "/pair/driving/profile_modifications/0/amount_um";
    let mut document = axes(json!([{ "path": path, "values": [2, 4.5] }]));
    document["base"]["pair"]["driving"]["profile_modifications"] =
        json!([{ "kind": "crowning", "amount_um": 0 }]);
    let designs = designs(&parse(&document).unwrap());
    let labels: Vec<&str> = designs.iter().map(|design| &*design.label).collect();
    assert_eq!(labels, ["amount_um=2", "amount_um=4.5"]);
    let second = designs[1].submission.as_ref().unwrap();
    let crowning = &second.case().pair.driving().data().modifications[0];
    assert_eq!(
        *crowning,
        meshwright_engine::gear::ModificationData::Crowning { amount: 4.5e-6 }
    );
    // A list that is not there has no first item.
    let absent = parse(&axes(json!([{ "path": path, "values": [2] }])));
    assert!(absent.is_err(), "{absent:?}");
}

#[test]
fn a_thousand_pairs_with_drawn_pitch_errors_make_a_study() {
    let drawn = |seed: u32| {
        let noise = |tooth: u32| f64::from((seed * 7919 + tooth * 104_729) % 101) / 10.0 - 5.0;
        json!((0..50).map(noise).collect::<Vec<_>>())
    };
    let list: Vec<Value> = (0..1000)
        .map(|i| {
            json!({ "label": format!("pair {i}"), "changes": {
                "/pair/driving/tooth_deviations/pitch_cumulative_um": drawn(2 * i),
                "/pair/driven/tooth_deviations": { "pitch_cumulative_um": drawn(2 * i + 1) }
            } })
        })
        .collect();
    let study = parse(&listed(json!(list))).unwrap();
    let last = study.design(999).unwrap().submission.unwrap();
    let pair = &last.case().pair;
    assert_eq!((study.total(), pair.period()), (1000, 50));
    assert_eq!(pair.driven().deviations().cumulative_pitch.len(), 50);
}

#[test]
fn a_constant_mass_knows_a_tip_circle_by_its_diameter() {
    let radius = |tip: Value| {
        let mut document = axes(json!([{ "path": "/method", "values": ["flexible"] }]));
        let driven = &mut document["base"]["pair"]["driven"];
        for (name, value) in tip.as_object().unwrap() {
            driven[name] = value.clone();
        }
        driven["blank"]["holes"] =
            json!({ "count": 8, "circle_radius_mm": 30.0, "radius_mm": 5.0 });
        document["constant_mass"] = json!({ "gear": "driven", "mass_removed_percent": 20 });
        let study = parse(&document).unwrap();
        study.design(0).unwrap().changes["/pair/driven/blank/holes/radius_mm"].clone()
    };
    let by_addendum = radius(json!({ "addendum_mm": 1.8 }));
    assert_eq!(
        radius(json!({ "tip_diameter_mm": 103.6, "addendum_mm": null })),
        by_addendum
    );
    assert_ne!(radius(json!({})), by_addendum);
}

#[test]
fn a_constant_mass_gives_every_pattern_of_a_list_the_same_radius() {
    let mut document = axes(json!([
        { "path": "/pair/driven/blank/holes/1/circle_radius_mm", "values": [38, 39] }
    ]));
    document["base"]["pair"]["driven"]["blank"]["holes"] = json!([
        { "count": 4, "circle_radius_mm": 26.0 },
        { "at_deg": [40, 140, 230, 320], "circle_radius_mm": 38.0 }
    ]);
    document["constant_mass"] = json!({ "gear": "driven", "mass_removed_percent": 10 });
    for design in removing(&document, 0.1) {
        let radii = ["0", "1"].map(|i| {
            let pointer = format!("/pair/driven/blank/holes/{i}/radius_mm");
            design.changes[&pointer].as_f64().unwrap()
        });
        assert_eq!(radii[0], radii[1]);
    }
    document["axes"] = json!([
        { "path": "/pair/driven/blank/holes/0/radius_mm", "values": [3, 4] }
    ]);
    refuses(&document, Code::OutOfRange, &["/axes/0/path"]);
}

#[test]
fn a_constant_mass_gives_slots_a_width_beside_round_holes_of_the_same_half_width() {
    let mut document = axes(json!([
        { "path": "/pair/driven/blank/holes/1/slot/angle_deg", "values": [0, 20, 40] }
    ]));
    document["base"]["pair"]["driven"]["blank"]["holes"] = json!([
        { "count": 6, "circle_radius_mm": 24.0 },
        { "count": 4, "circle_radius_mm": 38.0, "slot": { "angle_deg": 10 } }
    ]);
    document["constant_mass"] = json!({ "gear": "driven", "mass_removed_percent": 12 });
    for design in removing(&document, 0.12) {
        let set = |pointer: &str| design.changes[pointer].as_f64().unwrap();
        let radius = set("/pair/driven/blank/holes/0/radius_mm");
        let width = set("/pair/driven/blank/holes/1/slot/width_mm");
        assert_eq!(width, 2.0 * radius);
    }
    // Alone, as an object.
    document["base"]["pair"]["driven"]["blank"]["holes"] =
        json!({ "count": 5, "circle_radius_mm": 34.0, "slot": { "angle_deg": 25 } });
    document["axes"] = json!([{ "path": "/pair/driven/blank/holes/count", "values": [3, 5] }]);
    removing(&document, 0.12);
    document["axes"] = json!([
        { "path": "/pair/driven/blank/holes/slot/width_mm", "values": [3, 4] }
    ]);
    refuses(&document, Code::OutOfRange, &["/axes/0/path"]);
}
