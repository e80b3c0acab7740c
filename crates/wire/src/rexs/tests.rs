//! Models taken and refused, and pairs that come back as they went.

use meshwright_engine::gear::Member;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use serde_json::{Value, json};

use meshwright_exchange::rexs::{
    Choices, Import, LoadedFlank, Refused, import, is_model, is_packed, unpacked,
};

use super::model_of;
use crate::testing::{self, example, parse, submission};
use crate::{Submission, examples, solve};

const CASE_2: &str = include_str!("../../../../api/examples/test-case-2.rexs");

const DATE: &str = "2026-11-21T22:00:00+00:00";

fn taken(model: &str) -> Import {
    match import(model.as_bytes(), &Choices::default()) {
        Ok(imported) => imported,
        Err(refused) => panic!("{refused}"),
    }
}

fn refused(model: &str) -> Refused {
    import(model.as_bytes(), &Choices::default()).expect_err("it is refused")
}

/// The model of test case 2 with one piece of its text changed.
fn with(old: &str, new: &str) -> String {
    assert!(CASE_2.contains(old), "{old}");
    CASE_2.replacen(old, new, 1)
}

/// The first attribute of this name in the model of test case 2.
fn attribute(id: &str) -> &'static str {
    let from = CASE_2.find(&format!("<attribute id=\"{id}\"")).expect(id);
    let (own, _) = CASE_2[from..].split_once("</attribute>").expect("an end");
    &CASE_2[from..from + own.len() + "</attribute>".len()]
}

/// The model of test case 2 without this attribute.
fn without(id: &str) -> String {
    with(attribute(id), "")
}

/// The model of test case 2 with another value of this attribute.
fn saying(id: &str, unit: &str, value: &str) -> String {
    with(attribute(id), &said(id, unit, value))
}

fn said(id: &str, unit: &str, value: &str) -> String {
    format!(r#"<attribute id="{id}" unit="{unit}">{value}</attribute>"#)
}

/// That exactly one thing is wrong, at `place`, and that these words are said of it.
fn assert_refused(model: &str, place: &str, words: &[&str]) {
    let Refused(faults) = refused(model);
    let [fault] = faults.as_slice() else {
        panic!("{faults:?}");
    };
    assert!(fault.place.contains(place), "{fault:?}");
    for word in words {
        assert!(fault.detail.contains(word), "{word}: {fault:?}");
    }
}

/// That each of these words is in a remark.
fn assert_noted(imported: &Import, words: &[&str]) {
    let remarks = &imported.remarks;
    for word in words {
        let is_told = remarks.iter().any(|remark| remark.contains(word));
        assert!(is_told, "{word}: {remarks:?}");
    }
}

fn field(imported: &Import, pointer: &str) -> Value {
    let found = imported.submission.pointer(pointer);
    found
        .unwrap_or_else(|| panic!("no {pointer}: {}", imported.submission))
        .clone()
}

#[test]
fn the_model_of_test_case_2_is_its_submission() {
    let imported = taken(CASE_2);
    let of_model = parse(&imported.submission).expect("valid");
    // The relief of the model begins at a diameter, that of the submission at a depth: the same place.
    let json = example("test-case-2").to_string();
    let json = json.replace(r#""radial_length_mm":1.75"#, r#""diameter_mm":100.5"#);
    let json = json.replace(r#""addendum_mm":2.0"#, r#""tip_diameter_mm":104.0"#);
    let by_hand = Submission::parse(json.as_bytes()).expect("valid");
    assert_eq!(of_model.canonical_json(), by_hand.canonical_json());
    let said = &imported.remarks;
    assert_eq!(said, &["Not read: 1 gear_unit, 1 shaft."]);
}

#[test]
fn units_are_converted_and_unknown_ones_refused() {
    #[rustfmt::skip]
    let cases = [
        ("center_distance", "m", "0.1005", "/pair/center_distance_mm", 100.5),
        ("elastic_modulus", "MPa", "205000", "/pair/driven/material/youngs_modulus_gpa", 205.0),
        ("density", "kg / m^3", "7850", "/pair/driven/material/density_kg_m3", 7850.0),
        ("torque_around_u_axis", "kN m", "-0.115", "/output_torques_n_m/0", 115.0),
        ("tip_relief_depth", "mum", "5.1", "/pair/driving/tip_relief/amount_um", 5.1),
    ];
    for (id, unit, said, pointer, value) in cases {
        let found = field(&taken(&saying(id, unit, said)), pointer);
        assert_eq!(found.as_f64(), Some(value), "{said}");
    }
    let unitless = with(
        r#""number_of_teeth" unit="none">50"#,
        r#""number_of_teeth">50"#,
    );
    assert_eq!(field(&taken(&unitless), "/pair/driving/tooth_count"), 50);
    let inches = saying("center_distance", "inch", "3.957");
    assert_refused(
        &inches,
        "component 2 (cylindrical_stage \"Stage\"), center_distance",
        &["inch", "mm, mum"],
    );
    let word = saying("center_distance", "mm", "wide");
    assert_refused(&word, "center_distance", &["wide", "number"]);
}

#[test]
fn a_word_that_is_not_known_is_refused() {
    let flank = CASE_2.replace(
        "true</attribute>",
        r#"true</attribute><attribute id="loaded_tooth_flank">both</attribute>"#,
    );
    assert_refused(&flank, "component 11", &["both", "left, right"]);
    let drives = with(">true<", ">yes<");
    assert_refused(&drives, "component 11", &["yes", "true, false"]);
    let shape = taken(&without("shape_of_relief"));
    assert_eq!(field(&shape, "/pair/driven/tip_relief/shape"), "linear");
    let said = "Assumed: component 32 (tip_relief) has no shape_of_relief; taken is linear.";
    assert_eq!(shape.remarks[0], said);
}

#[test]
fn a_helix_an_internal_gear_and_flanks_that_differ_are_refused_with_the_reason() {
    let helix = saying("helix_angle_reference_diameter", "deg", "21");
    assert_refused(
        &helix,
        "component 10 (cylindrical_gear \"Pinion\"), helix_angle_reference_diameter",
        &["21 deg", "0 deg", "opposite"],
    );
    let ring = with(
        r#"<component id="20" type="cylindrical_gear""#,
        r#"<component id="20" type="ring_gear""#,
    );
    assert_refused(&ring, "component 20", &["ring_gear", "external"]);
    let shifted = saying("addendum_modification_coefficient", "none", "0.2");
    assert_refused(&shifted, "component 13", &["0.2", "both sides"]);
    let one_relief = with(
        r#"<ref id="12" role="origin"/>"#,
        r#"<ref id="10" role="origin"/>"#,
    );
    assert_refused(
        &one_relief,
        "component 10",
        &["loaded_tooth_flank", "--flank left"],
    );
    let told = one_relief.replacen(
        r#"true</attribute>"#,
        r#"true</attribute><attribute id="loaded_tooth_flank">right</attribute>"#,
        1,
    );
    let amount = "/pair/driving/tip_relief/amount_um";
    assert_eq!(field(&taken(&told), amount), 5.0);
    // The caller chooses, whatever the model says.
    for (flank, relieved) in [(LoadedFlank::Right, true), (LoadedFlank::Left, false)] {
        let choices = Choices {
            flank: Some(flank),
            ..Choices::default()
        };
        for model in [&one_relief, &told] {
            let imported = import(model.as_bytes(), &choices).expect("chosen");
            let relief = imported.submission.pointer(amount);
            assert_eq!(relief.is_some(), relieved, "{flank:?}");
        }
    }
}

#[test]
fn of_several_stages_one_is_chosen_by_its_id() {
    let two = with(
        "</components>",
        r#"<component id="3" type="cylindrical_stage" name="Second"/></components>"#,
    );
    assert_refused(
        &two,
        "the file",
        &[
            "2 cylindrical stages",
            "--stage",
            "component 3",
            "component 2",
        ],
    );
    let choices = |stage| Choices {
        stage: Some(stage),
        ..Choices::default()
    };
    assert!(import(two.as_bytes(), &choices(2)).is_ok());
    let Refused(faults) = import(two.as_bytes(), &choices(7)).expect_err("none has this id");
    assert!(
        faults[0].detail.contains("No stage has the id 7"),
        "{faults:?}"
    );
    let Refused(faults) = import(two.as_bytes(), &choices(3)).expect_err("it has no gears");
    assert!(faults[0].detail.contains("gear_1"), "{faults:?}");
    let none = CASE_2.replace("cylindrical_stage\"", "bevel_stage\"");
    assert_refused(&none, "the file", &["bevel_stage only"]);
}

#[test]
fn a_torque_comes_from_the_case_the_gear_data_or_the_caller_and_else_is_missed() {
    let none = without("torque_around_u_axis");
    assert_refused(&none, "component 2", &["--torque", "external_load"]);
    let choices = Choices {
        torques: vec![80.0, 20.0],
        ..Choices::default()
    };
    let chosen = import(none.as_bytes(), &choices).expect("the caller says it");
    assert_eq!(field(&chosen, "/output_torques_n_m"), json!([80.0, 20.0]));
    // The torque of the driving gear is larger by the ratio on the driven one, and signs are those of the axes.
    let data = attribute("is_driving_gear");
    let of_driving = none.replace(data, &(data.to_owned() + &said("torque", "N m", "-40")));
    let of_driving = of_driving.replacen(">50<", ">25<", 1);
    assert_eq!(
        field(&taken(&of_driving), "/output_torques_n_m"),
        json!([80.0])
    );
    let cases = with(
        "</load_spectrum>",
        r#"<load_case id="2"><component id="21" type="cylindrical_stage_gear_data"><attribute id="torque">20</attribute></component>
           <component id="10" type="cylindrical_gear"><attribute id="rotational_speed" unit="1 / s">-25</attribute></component></load_case></load_spectrum>"#,
    );
    let cases = taken(&cases);
    assert_eq!(field(&cases, "/output_torques_n_m"), json!([115.0, 20.0]));
    assert_eq!(field(&cases, "/driving_speed_rpm"), 1500.0);
}

#[test]
fn the_gear_that_says_so_drives() {
    let swapped = CASE_2
        .replace(">true<", ">?<")
        .replace(">false<", ">true<")
        .replace(">?<", ">false<");
    let swapped = taken(&swapped.replace(
        r#"<ref id="20" role="part"/>"#,
        r#"<ref id="10" role="part"/>"#,
    ));
    assert_eq!(field(&swapped, "/pair/driving/blank/holes/count"), 10);
    let silent = CASE_2.replace(">true<", "><").replace(">false<", "><");
    let silent = taken(&silent);
    assert_eq!(field(&silent, "/pair/driven/blank/holes/count"), 10);
    assert_noted(&silent, &["drives"]);
    let both = CASE_2.replace(">false<", ">true<");
    assert_refused(&both, "component 2", &["exactly one drives"]);
}

#[test]
fn what_is_absent_is_told_as_assumed_or_missed_and_what_is_not_read_is_named() {
    let poor = without("tip_radius_factor").replace(
        attribute("normal_pressure_angle"),
        &said("grinding_allowance", "mm", "0.1"),
    );
    let imported = taken(&poor);
    assert_eq!(field(&imported, "/pair/driven/pressure_angle_deg"), 20.0);
    assert_noted(
        &imported,
        &[
            "Assumed: component 10 (cylindrical_gear \"Pinion\") has no normal_pressure_angle; taken is 20 deg.",
            "no rack_shaped_tool with a tip radius",
            "Not read: of component 12 (cylindrical_gear_flank): grinding_allowance.",
        ],
    );
    let solid = without("inner_diameter");
    assert_refused(&solid, "component 10", &["inner_diameter", "--bore-radius"]);
    let choices = Choices {
        bore_radii: vec![12.0, 15.0],
        ..Choices::default()
    };
    let bored = import(solid.as_bytes(), &choices).expect("the caller says it");
    assert_eq!(field(&bored, "/pair/driving/blank/bore_radius_mm"), 12.0);
    assert_eq!(field(&bored, "/pair/driven/blank/bore_radius_mm"), 15.0);
    let narrow = without("face_width");
    assert_refused(&narrow, "component 10", &["face_width", "no default"]);
}

#[test]
fn the_tool_stands_where_it_generates_the_teeth() {
    let thin = saying(
        "generated_addendum_modification_coefficient",
        "none",
        "-0.02",
    );
    let imported = taken(&thin);
    // Cut 0.02 modules deeper by the same tool: the root by 0.04 mm, the tooth thinner by 2 * 0.04 mm * tan 20 deg.
    assert_eq!(field(&imported, "/pair/driving/dedendum_mm"), 2.5);
    let validation = crate::validate(&parse(&imported.submission).expect("valid"));
    let driving = &validation.pair.driving;
    assert!((driving.generating_profile_shift + 0.02).abs() < 1e-9);
    let root = driving.reference_radius_mm - 2.54;
    assert!((driving.root_radius_mm - root).abs() < 1e-9);
    let thinner = field(&imported, "/pair/driving/tooth_thickness_deviation_um");
    let expected = -80.0 * 20_f64.to_radians().tan();
    assert!((thinner.as_f64().expect("a number") - expected).abs() < 1e-6);
    // A root diameter that says otherwise holds, and that is told.
    let tip = attribute("tip_diameter");
    let root = said("root_diameter", "mm", "94.8");
    let ground = taken(&CASE_2.replace(tip, &(tip.to_owned() + &root)));
    assert_eq!(field(&ground, "/pair/driven/dedendum_mm"), 2.6);
    assert_noted(&ground, &["root_diameter 2.6 mm"]);
    let other = with(
        r#""normal_module" unit="mm">2</attribute>
      <attribute id="normal_pressure_angle""#,
        r#""normal_module" unit="mm">2.5</attribute>
      <attribute id="normal_pressure_angle""#,
    );
    let Refused(faults) = refused(&other);
    assert!(
        faults
            .iter()
            .all(|fault| fault.place.contains("component 30")),
        "{faults:?}"
    );
}

#[test]
fn a_web_lies_between_the_rim_and_the_bore() {
    let rim = said("gear_body_rim_thickness", "mm", "4.5");
    let web = said("gear_body_web_thickness", "mm", "6");
    let body =
        format!(r#"<component id="50" type="gear_body">{rim}{web}</component></components>"#);
    let relation = r#"<relation id="50" type="assembly"><ref id="20" role="assembly"/><ref id="50" role="part"/></relation></relations>"#;
    let model = CASE_2
        .replace("</components>", &body)
        .replace("</relations>", relation);
    let imported = taken(&model);
    let web = json!({ "inner_radius_mm": 16.0, "outer_radius_mm": 43.0, "thickness_mm": 6.0 });
    assert_eq!(field(&imported, "/pair/driven/blank/web"), web);
    assert_noted(&imported, &["no hub"]);
    assert_refused(&model.replace(&rim, ""), "component 50", &["needs both"]);
}

#[test]
fn reliefs_that_are_said_otherwise_than_we_can_take_are_refused() {
    let shape = "shape_of_relief";
    let grown = saying(shape, "none", "exponential");
    assert_refused(&grown, "component 32", &["exponential", "parabolic"]);
    let below_tip = said("tip_relief_evaluation_reference", "mm", "103.6");
    let below_tip = with(
        attribute(shape),
        &(attribute(shape).to_owned() + &below_tip),
    );
    assert_refused(&below_tip, "component 32", &["103.6", "104"]);
    let datum = "tip_relief_datum_diameter";
    assert_refused(&without(datum), "component 32", &["where does it begin"]);
    let rolled = said("tip_relief_datum_length", "mm", "4");
    let rolled = taken(&with(attribute(datum), &rolled));
    assert_eq!(
        field(&rolled, "/pair/driving/tip_relief/start"),
        json!({ "roll_length_from_tip_mm": 4.0 })
    );
}

#[test]
fn a_crowning_takes_off_the_same_at_both_ends_and_a_slope_at_the_tip() {
    let model = |crowning: &str| {
        let parts = format!(
            r#"<component id="60" type="profile_crowning">{crowning}</component><component id="61" type="profile_slope"><attribute id="profile_slope" unit="mum">-3</attribute></component></components>"#
        );
        let refer = |flank: u32, to: u32| {
            format!(
                r#"<relation id="{to}{flank}" type="reference"><ref id="{flank}" role="origin"/><ref id="{to}" role="referenced"/></relation>"#
            )
        };
        let relations = [refer(12, 60), refer(13, 60), refer(12, 61), refer(13, 61)].concat();
        let model = CASE_2.replace("</components>", &parts);
        model.replace("</relations>", &format!("{relations}</relations>"))
    };
    let at = |end: &str, mm: &str| said(&format!("profile_crowning_at_{end}"), "mm", mm);
    let imported = taken(&model(&(at("tip", "0.004") + &at("root", "0.004"))));
    assert_eq!(
        field(&imported, "/pair/driving/profile_modifications"),
        json!([{ "kind": "crowning", "amount_um": 4.0 }, { "kind": "slope", "amount_um": -3.0 }])
    );
    assert_noted(&imported, &["takes material off at the tip"]);
    let unlike = model(&(at("tip", "0.004") + &at("root", "0.006")));
    assert_refused(
        &unlike,
        "component 60",
        &["0.004", "0.006", "profile_slope"],
    );
}

#[test]
fn more_load_cases_than_anybody_computes_are_refused() {
    let cases: String = (2..1002)
        .map(|id| format!(r#"<load_case id="{id}"/>"#))
        .collect();
    let many = with("</load_spectrum>", &format!("{cases}</load_spectrum>"));
    assert_refused(&many, "the load spectrum", &["1001", "1000"]);
}

#[test]
fn a_problem_of_the_submission_leads_back_to_the_model() {
    let imported = taken(&saying("center_distance", "mm", "105"));
    let problem = parse(&imported.submission).expect_err("apart");
    let origin = imported.origin(&problem.errors[0].pointer);
    assert_eq!(
        origin,
        Some("component 2 (cylindrical_stage \"Stage\"), center_distance")
    );
}

#[test]
fn every_valid_example_comes_back_as_the_same_pair() {
    let quick =
        json!({ "positions_per_mesh_period": 40, "span_mesh_periods": 1, "grid": "coarse" });
    let library = Library::with_capacity(256 << 20);
    let solved = |submission: &Submission| {
        let solved = solve(submission, &library, &Run::unattended()).expect("computed");
        serde_json::to_value(solved).expect("JSON")
    };
    for example in examples().iter().filter(|example| example.valid) {
        let mut document: Value = serde_json::from_str(example.json).expect("JSON");
        // How it is computed is no part of a model of a gearbox.
        let along_faces = document["method"]
            .as_str()
            .is_some_and(|method| method.starts_with("three_dimensional"));
        let quick = if along_faces {
            json!({ "positions_per_mesh_period": 40, "span_mesh_periods": 1, "face_order": 4, "face_slices": 20 })
        } else {
            quick.clone()
        };
        document["resolution"] = quick.clone();
        document["stress"] = json!(false);
        document["dynamics"] = Value::Null;
        document["force_table"] = Value::Null;
        let gone = parse(&document).expect("valid");
        let there = solved(&gone);
        let imported = taken(&model_of(&gone, Some(&there), DATE));
        let mut submission = imported.submission.clone();
        submission["resolution"] = quick.clone();
        let back = parse(&submission);
        let back = back.unwrap_or_else(|problem| panic!("{}: {problem:?}", example.name));
        assert_eq!(gone.method(), back.method());
        let again = solved(&back);
        for part in ["pair", "frequencies", "curves"] {
            assert_alike(&there[part], &again[part], example.name);
        }
    }
}

fn helical(changes: &[(&str, Value)]) -> Value {
    testing::with(example("helical-pair"), changes)
}

#[test]
fn helices_leads_and_what_stands_askew_come_back_as_they_went() {
    let end_relief =
        json!({ "kind": "end_relief", "amount_um": 6, "length_mm": 3, "side": "plus" });
    let table = json!({ "kind": "table", "z_mm": [-5, 5], "removed_um": [0, 3] });
    let slope = |amount: f64| json!({ "kind": "slope", "amount_um": amount });
    for (helix, offset) in [(20.0, 1.5), (-20.0, -1.5), (20.0, 0.0)] {
        let gone = helical(&[
            ("/pair/helix_angle_deg", json!(helix)),
            ("/pair/axial_offset_mm", json!(offset)),
            (
                "/pair/misalignment_um",
                json!({ "in_plane_um": 8, "out_of_plane_um": -3 }),
            ),
            (
                "/pair/driving/lead_modifications",
                json!([{ "kind": "crowning", "amount_um": 4 }, slope(-7.5), end_relief]),
            ),
            ("/pair/driven/lead_modifications", json!([table])),
            ("/pair/driven/tooth_thickness_deviation_um", json!(-40)),
            ("/pair/driven/tip_diameter_mm", json!(131.5)),
        ]);
        let gone = parse(&gone).expect("valid");
        let text = model_of(&gone, None, DATE);
        let imported = taken(&text);
        let back = parse(&imported.submission).expect("valid");
        let [gone, back] = [&gone, &back].map(|pair| serde_json::to_value(pair).expect("JSON"));
        assert_eq!(gone["method"], back["method"]);
        for field in ["helix_angle_deg", "axial_offset_mm", "misalignment_um"] {
            assert_alike(&gone["pair"][field], &back["pair"][field], field);
        }
        for gear in ["driving", "driven"] {
            for field in [
                "lead_modifications",
                "blank",
                "tooth_thickness_deviation_um",
                "tip_diameter_mm",
                "dedendum_mm",
                "addendum_mm",
            ] {
                assert_alike(
                    &gone["pair"][gear][field],
                    &back["pair"][gear][field],
                    field,
                );
            }
        }
        let hand = if helix > 0.0 {
            "right-handed"
        } else {
            "left-handed"
        };
        assert_noted(&imported, &[hand, "+z end"]);

        // Another program says no method: the one that sees the helix is taken, and that is told.
        let own = "<attribute id=\"custom_meshwright_method\" unit=\"none\">three_dimensional</attribute>";
        assert!(text.contains(own));
        let other = taken(&text.replace(own, ""));
        assert_eq!(other.submission["method"], "three_dimensional");
        assert_noted(&other, &["by three_dimensional"]);
        let angle =
            |angle: f64| format!("\"helix_angle_reference_diameter\" unit=\"deg\">{angle}<");
        let alone = text.replace(&angle(-helix), &angle(11.0));
        assert_refused(
            &alone,
            "helix_angle_reference_diameter",
            &["11 deg", "opposite"],
        );
    }
}

#[test]
fn a_helix_crowning_that_differs_at_the_ends_is_refused() {
    let gone = parse(&helical(&[])).expect("valid");
    let text = model_of(&gone, None, DATE);
    let name = "\"helix_crowning_amount_non_datum_face\" unit=\"mm\">";
    let uneven = text.replace(&format!("{name}0.004"), &format!("{name}0.006"));
    assert_ne!(uneven, text);
    assert_refused(
        &uneven,
        "helix_crowning",
        &["0.004", "0.006", "helix_slope"],
    );
}

/// Equal words, and numbers equal but for the last bits of the conversions, which contact answers with some more.
fn assert_alike(one: &Value, other: &Value, place: &str) {
    match (one, other) {
        (Value::Number(a), Value::Number(b)) => {
            let [a, b] = [a, b].map(|number| number.as_f64().unwrap_or(f64::NAN));
            assert!(
                (a - b).abs() <= 1e-6 * a.abs().max(b.abs()).max(1e-3),
                "{place}: {a} and {b}"
            );
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                assert_alike(a, b, &format!("{place}/{i}"));
            }
        }
        (Value::Object(a), Value::Object(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            for (key, a) in a {
                assert_alike(a, &b[key], &format!("{place}/{key}"));
            }
        }
        _ => assert_eq!(one, other, "{place}"),
    }
}

#[test]
fn the_curves_stand_at_the_stage_in_the_units_of_the_standard() {
    let submission = submission("standard-pair");
    let library = Library::with_capacity(64 << 20);
    let solved = solve(&submission, &library, &Run::unattended()).expect("computed");
    let results = serde_json::to_value(&solved).expect("JSON");
    let text = model_of(&submission, Some(&results), DATE);
    let document = roxmltree::Document::parse(&text).expect("XML");
    let lists = |id: &str| -> Vec<(String, Vec<f64>)> {
        let attributes = document
            .descendants()
            .filter(|node| node.attribute("id") == Some(id));
        let of = |node: roxmltree::Node<'_, '_>| {
            let cells = node.descendants().filter(|cell| cell.has_tag_name("c"));
            let numbers = cells.map(|cell| cell.text().expect("text").parse().expect("a number"));
            (
                node.attribute("unit").expect("a unit").to_owned(),
                numbers.collect(),
            )
        };
        attributes.map(of).collect()
    };
    let stiffness = lists("meshing_stiffness_characteristic");
    assert_eq!(stiffness.len(), solved.curves.len());
    for ((unit, said), curve) in stiffness.iter().zip(&solved.curves) {
        assert_eq!(unit, "N / mm");
        let computed = &curve.mesh_stiffness_tangent_n_per_m;
        assert_eq!(said.len(), computed.len());
        for (said, computed) in said.iter().zip(computed) {
            assert!((said * 1e3 / computed - 1.0).abs() < 1e-12);
        }
    }
    let angles = lists("rotational_meshing_position");
    assert_eq!(angles.len(), 2 * solved.curves.len());
    assert_eq!(angles[0].0, "deg");
    let torques: Vec<_> = document
        .descendants()
        .filter(|node| node.attribute("id") == Some("torque"))
        .map(|node| node.text().expect("text"))
        .collect();
    assert_eq!(torques, ["115", "20"]);
}

#[test]
fn what_is_no_model_is_refused_before_anything_grows() {
    let bomb = r#"<!DOCTYPE model [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><model version="2.0.0">&b;</model>"#;
    assert_refused(bomb, "the file", &["XML", "DTD"]);
    let foreign = r#"<!DOCTYPE model SYSTEM "file:///etc/hostname"><model version="2.0.0"/>"#;
    assert_refused(foreign, "the file", &["XML", "DTD"]);
    let unknown = with("Pinion", "&pinion;");
    assert_refused(&unknown, "the file", &["XML", "pinion"]);
    let deep = format!("<model version=\"2.0.0\">{}", "<a>".repeat(500_000));
    assert_refused(&deep, "the file", &["XML"]);
    let many = format!(
        "<model version=\"2.0.0\">{}</model>",
        "<a/>".repeat(2_000_001)
    );
    assert_refused(&many, "the file", &["XML", "limit"]);
    let large = " ".repeat((32 << 20) + 1);
    assert_refused(&large, "the file", &["33554433 bytes", "33554432"]);
    assert_refused("<gearbox/>", "the file", &["<gearbox>"]);
    assert_refused(
        r#"<model version="0.9"/>"#,
        "the file",
        &["0.9", "1.0 to 2"],
    );
    assert_refused(r#"<model version="3.0"/>"#, "the file", &["3.0"]);
    let same = with(
        "</components>",
        r#"<component id="33" type="material"/></components>"#,
    );
    assert_refused(&same, "component 33", &["same id"]);
    let lost = with(
        r#"<ref id="2" role="stage" hint"#,
        r#"<ref id="99" role="stage" hint"#,
    );
    assert_refused(&lost, "relation of type stage", &["component 99"]);
    let twice = with(
        attribute("poisson_ratio"),
        r#"<attribute id="density">7</attribute>"#,
    );
    assert_refused(&twice, "component 33", &["twice"]);
    let Refused(faults) = import(b"<model \xFF", &Choices::default()).expect_err("no UTF-8");
    assert!(faults[0].detail.contains("UTF-8"), "{faults:?}");
}

#[test]
fn damaged_models_are_taken_or_refused_and_never_panic() {
    let mut state: u64 = 1;
    let mut next = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut taken, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut bytes = CASE_2.as_bytes().to_vec();
        for _ in 0..=next(3) {
            let (at, from) = (next(bytes.len()), next(bytes.len()));
            match next(3) {
                0 => bytes[at] = bytes[from],
                1 => bytes.truncate(at.max(1)),
                _ => {
                    let piece = bytes[from..(from + 30).min(bytes.len())].to_vec();
                    bytes.splice(at..at, piece);
                }
            }
        }
        match import(&bytes, &Choices::default()) {
            Ok(imported) => {
                taken += 1;
                parse(&imported.submission).ok();
            }
            Err(Refused(faults)) => {
                refused += 1;
                assert!(!faults.is_empty());
            }
        }
    }
    assert!(
        taken > 50 && refused > 500,
        "{taken} taken, {refused} refused"
    );
}

#[test]
fn a_model_is_known_by_what_it_begins_with() {
    assert!(is_model(CASE_2.as_bytes()));
    assert!(is_model(b"\xEF\xBB\xBF\r\n <model/>"));
    assert!(is_model(b"\xFF\xFE<\0m\0"));
    assert!(is_model(JSON) && is_model(ZIPPED));
    assert!(!is_model(b" {}"));
    assert!(!is_model(example("test-case-2").to_string().as_bytes()));
    assert!(!is_model(b""));
    let marked = [b"\xEF\xBB\xBF", CASE_2.as_bytes()].concat();
    assert!(import(&marked, &Choices::default()).is_ok());
    let named = with(
        "<model version",
        "<model xmlns=\"https://www.rexs.info\" version",
    );
    assert_eq!(taken(&named).submission, taken(CASE_2).submission);
}

/// Models as other programs write them, one thing in each.
macro_rules! model {
    ($name:literal) => {
        include_bytes!(concat!("../../../../tests/reference/rexs/", $name))
    };
}

const JSON: &[u8] = model!("json.rexsj");
const ZIPPED: &[u8] = model!("zipped.rexsz");
const BOTH_FALSE: &[u8] = model!("both-drive-false.rexs");

fn taken_of(model: &[u8]) -> Import {
    match import(model, &Choices::default()) {
        Ok(imported) => imported,
        Err(refused) => panic!("{refused}"),
    }
}

/// The model in which no gear drives, with more text behind the attributes of its component `id`.
fn with_more(id: u32, attributes: &str) -> String {
    let model = std::str::from_utf8(BOTH_FALSE).expect("UTF-8");
    let from = model
        .find(&format!("<component id=\"{id}\""))
        .expect("it is there");
    let (head, tail) = model.split_at(from);
    format!(
        "{head}{}",
        tail.replacen("</component>", &format!("{attributes}</component>"), 1)
    )
}

/// The same with another component, to which others refer: each by its id.
fn referring(model: &str, from: &[u32], component: &str) -> String {
    let id = component.split('"').nth(1).expect("an id");
    let refer = |from: &u32| {
        format!(
            r#"<relation id="9{from}" type="reference"><ref id="{from}" role="origin"/><ref id="{id}" role="referenced"/></relation>"#
        )
    };
    let relations: String = from.iter().map(refer).collect();
    model
        .replace("</components>", &format!("{component}</components>"))
        .replace("</relations>", &format!("{relations}</relations>"))
}

#[test]
fn one_pair_is_the_same_in_every_container_version_encoding_and_spelling() {
    let plain = taken_of(JSON);
    for (pointer, value) in [
        ("/pair/center_distance_mm", 60.5),
        ("/pair/driving/tooth_count", 24.0),
        ("/pair/driven/tooth_count", 36.0),
        ("/pair/driving/module_mm", 2.0),
        ("/pair/driving/blank/bore_radius_mm", 8.0),
        ("/pair/driven/blank/bore_radius_mm", 10.0),
        ("/pair/driven/material/youngs_modulus_gpa", 210.0),
        ("/pair/driven/material/density_kg_m3", 7850.0),
        ("/output_torques_n_m/0", 100.0),
    ] {
        assert_eq!(field(&plain, pointer).as_f64(), Some(value), "{pointer}");
    }
    parse(&plain.submission).expect("valid");
    // The same with a line of UTF-16 for each of ISO-8859-1.
    let latin: &[u8] = model!("umlaut-latin-1.rexs");
    let text: String = latin.iter().map(|byte| char::from(*byte)).collect();
    let wide = text.replace("ISO-8859-1", "UTF-16");
    let wide: Vec<u8> = std::iter::once('\u{FEFF}')
        .chain(wide.chars())
        .flat_map(|c| (c as u16).to_be_bytes())
        .collect();
    for model in [
        ZIPPED,
        model!("version-1.0-flank-geometry.rexs"),
        model!("units-superscript.rexs"),
        BOTH_FALSE,
        latin,
        &wide,
    ] {
        assert_eq!(taken_of(model).submission, plain.submission);
    }
    for model in [latin, &wide] {
        assert_noted(&taken_of(model), &["(cylindrical_gear \"Prüfritzel\")"]);
    }
    assert_noted(
        &taken_of(BOTH_FALSE),
        &["Assumed: gear_1 drives, component 10 (cylindrical_gear \"Pinion\")"],
    );
    assert!(is_packed(ZIPPED) && !is_packed(JSON));
    assert!(unpacked(ZIPPED, 4153).is_err());
    assert_eq!(unpacked(ZIPPED, 4154).expect("unpacked").len(), 4154);
}

#[test]
fn a_tool_of_the_first_versions_is_that_to_which_the_gear_refers() {
    let model = String::from_utf8_lossy(model!("version-1.0-flank-geometry.rexs"));
    let tool = |kind: &str| {
        let tool = format!(
            r#"<component id="50" type="{kind}"><attribute id="addendum_coefficient_reference_profile" unit="none">1.3</attribute><attribute id="tip_radius_factor" unit="none">0.25</attribute></component>"#
        );
        let model = referring(&model, &[10], &tool);
        model.replace(
            r#"id="910" type="reference""#,
            r#"id="910" type="ordered_reference" order="1""#,
        )
    };
    let read = taken(&tool("rack_shaped_tool"));
    assert_eq!(field(&read, "/pair/driving/dedendum_mm"), 2.6);
    assert_eq!(field(&read, "/pair/driving/rack_tip_radius_mm"), 0.5);
    assert_refused(
        &tool("cutter_wheel_tool"),
        "component 50 (cutter_wheel_tool)",
        &["rack_shaped_tool"],
    );
}

#[test]
fn a_torque_goes_on_over_the_shafts_by_the_ratios() {
    let model: &[u8] = model!("two-stages-torque-at-input.rexs");
    let of = |model: &str, stage| {
        let choices = Choices {
            stage: Some(stage),
            ..Choices::default()
        };
        import(model.as_bytes(), &choices)
    };
    let text = std::str::from_utf8(model).expect("UTF-8");
    // 50 N m, 36/24, and 36/24 once more.
    let first = of(text, 2).expect("taken");
    assert_eq!(field(&first, "/output_torques_n_m"), json!([75.0]));
    let second = of(text, 3).expect("taken");
    assert_eq!(field(&second, "/output_torques_n_m"), json!([112.5]));
    assert_noted(
        &second,
        &[
            "Assumed: the torque of component 3 (cylindrical_stage \"Second\") is carried over the shafts from component 60 (external_load) without losses.",
        ],
    );
    // From the output: the rest of 90 N m before the second stage.
    let at_output = text
        .replace(r#"unit="N m">50<"#, r#"unit="N m"><"#)
        .replace(
            r#""defines_torque" unit="none">false<"#,
            r#""torque_around_u_axis" unit="N m">-90<"#,
        );
    let first = of(&at_output, 2).expect("taken");
    assert_eq!(field(&first, "/output_torques_n_m"), json!([60.0]));
    // A third load on the shaft between takes 15 N m of the 75: by its sign, against the sense in which its shaft turns there.
    let third = r#"<component id="62" type="external_load"><attribute id="torque_around_u_axis" unit="N m">15</attribute></component>"#;
    let part = r#"<relation id="62" type="assembly"><ref id="41" role="assembly"/><ref id="62" role="part"/></relation>"#;
    let branched = text
        .replace("</components>", &format!("{third}</components>"))
        .replace("</relations>", &format!("{part}</relations>"));
    let second = of(&branched, 3).expect("taken");
    assert_eq!(field(&second, "/output_torques_n_m"), json!([90.0]));
    // One that is not said leaves it open on this side, as a stage beside it would.
    let open = branched.replace(
        r#"id="62" type="external_load"><attribute id="torque_around_u_axis" unit="N m">15<"#,
        r#"id="62" type="external_load"><attribute id="transmits_torque" unit="none">true<"#,
    );
    let Refused(faults) = of(&open, 3).expect_err("nobody knows");
    assert!(faults[0].detail.contains("No torque is said"), "{faults:?}");
    assert!(of(&open, 2).is_ok());
}

#[test]
fn a_gear_without_a_bore_sits_on_the_section_of_its_shaft() {
    let model: &[u8] = model!("bore-from-shaft-sections.rexs");
    let seated = taken_of(model);
    assert_eq!(field(&seated, "/pair/driving/blank/bore_radius_mm"), 12.0);
    assert_eq!(field(&seated, "/pair/driven/blank/bore_radius_mm"), 15.0);
    assert_noted(
        &seated,
        &[
            "Assumed: component 10 (cylindrical_gear \"Pinion\") has no inner_diameter; taken is the outer diameter of its shaft under it, 24 mm of component 61 (shaft_section).",
        ],
    );
    let text = std::str::from_utf8(model).expect("UTF-8");
    let bore = |model: &str| field(&taken(model), "/pair/driving/blank/bore_radius_mm");
    // A cone from 20 to 32 mm over 60 mm: 24 mm in thickness at 20 mm.
    let cone = text
        .replacen(r#"begin" unit="mm">24<"#, r#"begin" unit="mm">20<"#, 1)
        .replacen(r#"end" unit="mm">24<"#, r#"end" unit="mm">32<"#, 1);
    assert_eq!(bore(&cone), 12.0);
    // In version 1.0 the place is that of the end of the face, in space always that of its middle.
    let old = cone.replace("version=\"1.6\"", "version=\"1.0\"");
    assert_eq!(bore(&old), 13.0);
    let vector = |name: &str, u: f64| {
        format!(
            r#"<attribute id="{name}" unit="mm"><array><c>{u}</c><c>0</c><c>0</c></array></attribute>"#
        )
    };
    let in_space = old
        .replace(
            r#"<component id="40" type="shaft">"#,
            &format!(
                r#"<component id="40" type="shaft">{}{}"#,
                vector("u_axis_vector", -1.0),
                vector("support_vector", 100.0)
            ),
        )
        .replace(
            r#"type="cylindrical_gear" name="Pinion">"#,
            &format!(
                r#"type="cylindrical_gear" name="Pinion">{}"#,
                vector("support_vector", 60.0)
            ),
        );
    assert_eq!(bore(&in_space), 14.0);
    // Nothing is left around 42 mm of 43 mm at the root, and a bore of none is none.
    let thick = text
        .replacen(r#">24<"#, ">X<", 1)
        .replace(r#"unit="mm">24<"#, r#"unit="mm">42<"#);
    let thick = thick.replacen(">X<", ">24<", 1);
    let solid = text.replacen(
        r#"<attribute id="u_coordinate_on_shaft""#,
        r#"<attribute id="inner_diameter" unit="mm">0</attribute><attribute id="u_coordinate_on_shaft""#,
        1,
    );
    // Of the thick one a module is left below the root circle.
    for (model, radius, taken_radius) in [(thick, "21 mm", None), (solid, "12 mm", Some(12.0))] {
        let read = taken_of(model.as_bytes());
        let shaft = field(&read, "/pair/driving/blank/shaft/radius_mm");
        let shaft = shaft.as_f64().expect("a radius");
        assert!(
            taken_radius.is_none_or(|radius| shaft == radius) && shaft < 21.0,
            "{shaft}"
        );
        let told = read.remarks.join(" ");
        for word in ["of one piece with its shaft", radius, "component 10"] {
            assert!(told.contains(word), "{told}");
        }
        let choices = Choices {
            bore_radii: vec![12.0],
            ..Choices::default()
        };
        assert!(import(model.as_bytes(), &choices).is_ok());
    }
}

#[test]
fn a_helical_pinion_of_one_piece_with_its_shaft_is_computed_along_its_face() {
    let text = std::str::from_utf8(model!("bore-from-shaft-sections.rexs")).expect("UTF-8");
    let angle = |angle: &str| said("helix_angle_reference_diameter", "deg", angle);
    let none = said("inner_diameter", "mm", "0");
    let place = r#"<attribute id="u_coordinate_on_shaft""#;
    let model = text
        .replacen(&angle("0.0"), &angle("10.0"), 1)
        .replacen(&angle("-0.0"), &angle("-10.0"), 1)
        .replacen("60.5", "61.4", 1)
        .replacen(place, &format!("{none}{place}"), 1);
    let read = taken_of(model.as_bytes());
    assert_eq!(field(&read, "/method"), "three_dimensional");
    let shaft = "/pair/driving/blank/shaft";
    assert_eq!(field(&read, shaft), json!({ "radius_mm": 12.0 }));
    let library = Library::with_capacity(64 << 20);
    let computed = |changes: &[(&str, Value)]| {
        let quick =
            json!({ "positions_per_mesh_period": 8, "span_mesh_periods": 1, "grid": "coarse" });
        let quick = testing::with(read.submission.clone(), &[("/resolution", quick)]);
        let submission = parse(&testing::with(quick, changes)).expect("valid");
        let solved = solve(&submission, &library, &Run::unattended()).expect("computed");
        let curve = &solved.curves[0];
        let face = curve.face.as_ref().expect("along faces");
        (
            curve.statistics.transmission_error_um.mean,
            face.face_load_factor,
        )
    };
    let on_shaft = computed(&[]);
    let at_one_end = computed(&[(shaft, json!({ "radius_mm": 12.0, "torque_at": "plus" }))]);
    let bored = computed(&[("/pair/driving/blank", json!({ "bore_radius_mm": 12.0 }))]);
    // A rigid bore is stiffer than a shaft, and a shaft is stiffer where the torque leaves it at both ends. Beside the compliance of the teeth, the body turns
    // by φ = T/(4 π G b) (1/R² − 1/r²) around a bore and (4/(3 R²) − 1/r²) around a shaft, and T b/(12 G J) more.
    assert!(
        bored.0 < on_shaft.0 && on_shaft.0 < at_one_end.0,
        "{bored:?} {on_shaft:?} {at_one_end:?}"
    );
    assert_ne!(at_one_end.1, on_shaft.1);
    // Of a shaft that is as thick as the root a module of the transverse section is left.
    let section = |diameter: u32| format!(r#"unit="mm">{diameter}<"#);
    let thick = taken_of(model.replace(&section(24), &section(42)).as_bytes());
    let radius = field(&thick, "/pair/driving/blank/shaft/radius_mm").as_f64();
    let largest = 24.0 / 10_f64.to_radians().cos() - 2.5 - 2.0 / 10_f64.to_radians().cos();
    assert!(
        (0.0..2e-4).contains(&(largest - radius.expect("a radius"))),
        "{radius:?}"
    );
    assert!(parse(&thick.submission).is_ok());
}

#[test]
fn a_gear_without_a_material_has_that_of_its_shaft() {
    let aluminium = taken_of(model!("material-on-shafts-aluminium.rexs"));
    for gear in ["driving", "driven"] {
        let modulus = field(
            &aluminium,
            &format!("/pair/{gear}/material/youngs_modulus_gpa"),
        );
        assert_eq!(modulus, 70.0);
    }
    assert_noted(
        &aluminium,
        &[
            "Assumed: component 20 (cylindrical_gear \"Wheel\") has no material; taken is that of its shaft, component 30 (material).",
        ],
    );
}

#[test]
fn pairs_at_the_border_of_what_can_be_computed_are_read_as_they_stand() {
    let helical = taken_of(model!("centre-distance-to-4-decimals.rexs"));
    assert_eq!(field(&helical, "/pair/center_distance_mm"), 60.9255);
    assert_eq!(field(&helical, "/pair/helix_angle_deg"), 10.0);
    let sun = taken_of(model!("sun-17-teeth.rexs"));
    for (pointer, value) in [
        ("/pair/center_distance_mm", 39.2),
        ("/pair/driving/tooth_count", 17.0),
        ("/pair/driven/tooth_count", 22.0),
        ("/pair/driving/profile_shift", 0.0),
        ("/pair/driving/blank/bore_radius_mm", 5.0),
        ("/pair/driven/blank/bore_radius_mm", 6.0),
        ("/output_torques_n_m/0", 100.0),
    ] {
        assert_eq!(field(&sun, pointer).as_f64(), Some(value), "{pointer}");
    }
}

#[test]
fn what_would_make_another_flank_is_refused_by_its_place() {
    let of_kind = String::from_utf8_lossy(model!("relief-of-a-kind-not-known.rexs"));
    let Refused(faults) = refused(&of_kind);
    assert_eq!(faults.len(), 1, "{faults:?}");
    for fault in &faults {
        let place = "component 51 (triangular_tip_relief), tip_relief_depth";
        assert_eq!(fault.place, place);
        assert!(
            fault.detail.contains("triangular_tip_relief is not known"),
            "{fault:?}"
        );
    }
    // One that takes nothing off does no harm.
    assert!(
        import(
            of_kind.replace(">0.02<", ">0<").as_bytes(),
            &Choices::default()
        )
        .is_ok()
    );
    assert_refused(
        &String::from_utf8_lossy(model!("tip-diameter-placeholder.rexs")),
        "component 10 (cylindrical_gear \"Pinion\"), tip_diameter",
        &["It is 1 mm", "root circle"],
    );
    let plain = with_more(1, "");
    for (component, place, words) in [
        (
            r#"<component id="70" type="profile_twist"><attribute id="profile_twist" unit="mm">0.01</attribute></component>"#,
            "component 70 (profile_twist), profile_twist",
            ["profile_twist is not known", "another one"],
        ),
        (
            r#"<component id="70" type="custom_waviness"/>"#,
            "component 70 (custom_waviness)",
            ["custom_waviness is not known", "another one"],
        ),
        (
            r#"<component id="70" type="tip_relief"><attribute id="tip_relief_depth" unit="mm">0.02</attribute><attribute id="tip_relief_datum_diameter" unit="mm">51</attribute><attribute id="shape_of_relief">linear</attribute><attribute id="specify_tangential_transition">true</attribute></component>"#,
            "component 70 (tip_relief), specify_tangential_transition",
            ["corner", "transition"],
        ),
        (
            r#"<component id="70" type="end_relief_datum_face"><attribute id="end_relief_depth_datum_face" unit="mm">0.02</attribute><attribute id="end_relief_length_datum_face" unit="mm">4</attribute><attribute id="shape_of_relief">linear</attribute></component>"#,
            "component 70 (end_relief_datum_face), end_relief_depth_datum_face",
            ["both ends", "sense"],
        ),
    ] {
        assert_refused(&referring(&plain, &[12, 13], component), place, &words);
    }
    let hob = |attribute: &str| {
        let tool = format!(r#"<component id="70" type="rack_shaped_tool">{attribute}</component>"#);
        let step = |flank: u32| {
            format!(
                r#"<relation id="8{flank}" type="manufacturing_step" order="1"><ref id="{flank}" role="workpiece"/><ref id="70" role="tool"/></relation>"#
            )
        };
        plain
            .replace("</components>", &format!("{tool}</components>"))
            .replace(
                "</relations>",
                &format!("{}{}</relations>", step(12), step(13)),
            )
    };
    assert!(
        import(
            hob(&said("protuberance_amount", "mm", "0")).as_bytes(),
            &Choices::default()
        )
        .is_ok()
    );
    // 0.1 mm on each flank, normal to it: the rack stands 0.1 mm/sin 20 deg farther out.
    let reach = said("addendum_coefficient_reference_profile", "none", "1.4");
    let stock = reach + &said("machining_allowance_din_3972", "mm", "0.1");
    let ground = taken(&hob(&stock));
    let dedendum = field(&ground, "/pair/driving/dedendum_mm")
        .as_f64()
        .expect("a number");
    assert!(
        (dedendum - (2.8 - 0.1 / 20_f64.to_radians().sin())).abs() < 1e-9,
        "{dedendum}"
    );
    let rest = with_more(13, &said("remaining_protuberance", "mm", "0.02"));
    assert_refused(
        &rest,
        "component 13 (cylindrical_gear_flank), remaining_protuberance",
        &["0.02", "protuberance_amount"],
    );
}

/// `model` with the values of component `id` in another file.
fn elsewhere(model: &str, id: u32) -> String {
    let (before, rest) = model
        .split_once(&format!(r#"<component id="{id}" type=""#))
        .unwrap_or_else(|| panic!("no component {id}"));
    let (head, rest) = rest.split_once('>').expect("an end of the tag");
    let rest = match head.strip_suffix('/') {
        Some(_) => rest,
        None => rest.split_once("</component>").expect("an end").1,
    };
    let head = head.trim_end_matches('/');
    let source = said("data_source", "none", "./database.rexs")
        + &said("referenced_component_id", "none", "7");
    format!(r#"{before}<component id="{id}" type="{head}>{source}</component>{rest}"#)
}

#[test]
fn a_component_whose_values_stand_in_another_file_is_refused_by_its_name_and_never_assumed() {
    let sections = String::from_utf8_lossy(model!("bore-from-shaft-sections.rexs"));
    let section = sections
        .split_once(r#"" type="shaft_section""#)
        .and_then(|(before, _)| before.rsplit_once(r#"id=""#)?.1.parse().ok())
        .expect("a section");
    // Stage, gear, and its flank, tool, settings, relief and material in the model.
    let cases = [2, 10, 11, 12, 30, 31, 32, 33].map(|id| (CASE_2, id));
    for (model, id) in cases {
        let words = ["another file", "./database.rexs, component 7"];
        assert_refused(&elsewhere(model, id), &format!("component {id} ("), &words);
    }
    // Without its section the shaft says no bore either.
    let Refused(faults) = refused(&elsewhere(&sections, section));
    assert!(
        faults[0]
            .place
            .starts_with(&format!("component {section} ("))
    );
    assert!(faults[0].detail.contains("./database.rexs"), "{faults:?}");
    let whole = attribute("density");
    let source = said("data_source", "none", "steels.rexs");
    // All that is asked of a material is said, and nothing is asked of the unit.
    let told = taken(&with(whole, &(whole.to_owned() + &source)));
    assert_eq!(field(&told, "/pair/driven/material/density_kg_m3"), 7850.0);
    assert!(parse(&taken(&elsewhere(CASE_2, 1)).submission).is_ok());
    let file = "x".repeat(5000);
    let long = with(whole, &said("data_source", "none", &file));
    let Refused(faults) = refused(&long);
    assert!(faults[0].detail.len() < 300, "{faults:?}");
}

/// Test case 2 whose hob says this too, with these settings of the steps after its own, by their generated shifts.
fn hobbed(of_hob: &str, later: &[&str]) -> String {
    let radius = attribute("tip_radius_factor");
    let mut model = with(radius, &(radius.to_owned() + of_hob));
    for (i, shift) in later.iter().enumerate() {
        let (id, order) = (80 + i, i + 2);
        let shift = said("generated_addendum_modification_coefficient", "none", shift);
        let settings = format!(
            r#"<component id="{id}" type="cylindrical_gear_manufacturing_settings">{shift}</component></components>"#
        );
        let steps = [12, 22].map(|flank| {
            format!(
                r#"<relation id="{order}{flank}" type="manufacturing_step" order="{order}"><ref id="{flank}" role="workpiece"/><ref id="{id}" role="manufacturing_settings"/></relation>"#
            )
        });
        model = model
            .replace("</components>", &settings)
            .replace("</relations>", &(steps.concat() + "</relations>"));
    }
    model
}

#[test]
fn the_protuberance_of_the_hob_is_read_with_its_height_or_its_angle_and_the_stock_that_it_leaves() {
    let amount = said("protuberance_amount", "mm", "0.12");
    let height = said("protuberance_height", "mm", "1.1");
    let stock = said("machining_allowance_din_3972", "mm", "0.1");
    let fields = |amount: f64, height: f64, stock: f64| json!({ "amount_um": amount, "height_mm": height, "grinding_stock_um": stock });
    let read = |model: &str| field(&taken(model), "/pair/driving/protuberance");
    let whole = hobbed(&(amount.clone() + &height + &stock), &[]);
    assert_eq!(read(&whole), fields(120.0, 1.1, 100.0));
    assert!(parse(&taken(&whole).submission).is_ok());
    let factors = said("protuberance_amount_factor", "none", "0.06")
        + &said("protuberance_height_factor", "none", "0.55");
    assert_eq!(
        read(&hobbed(&(factors + &stock), &[])),
        fields(120.0, 1.1, 100.0)
    );
    // The rack of the ground teeth stands 0.1 mm / (2 mm sin 20 deg) of a module deeper: 0.1 mm on each flank.
    let deeper = format!("{:.12}", -0.05 / 20_f64.to_radians().sin());
    let steps = hobbed(&(amount.clone() + &height), &[&deeper]);
    let stepped = read(&steps);
    let ground = stepped["grinding_stock_um"].as_f64().expect("a number");
    assert!((ground - 100.0).abs() < 1e-6, "{stepped}");
    // The rest gives the stock as well; without either nothing is ground off.
    let rest = said("remaining_protuberance", "mm", "0.02");
    let flank = attribute("normal_pressure_angle");
    let plain = hobbed(&(amount.clone() + &height), &[]);
    let left = plain.replacen(flank, &(flank.to_owned() + &rest), 1);
    assert_eq!(read(&left), fields(120.0, 1.1, 100.0));
    let unground = taken(&plain);
    assert_eq!(
        field(&unground, "/pair/driving/protuberance"),
        fields(120.0, 1.1, 0.0)
    );
    assert_noted(
        &unground,
        &["component 30 (rack_shaped_tool \"Hob\") has no machining_allowance"],
    );
    // The angle to which a height of 1.1 mm leads, as the engine computes it: tan(delta/2) = p/(u + sqrt(u^2 - p (2 rho - p))).
    let (alpha, rho, p) = (20_f64.to_radians(), 0.76, 0.12);
    let u = (1.1 - rho + (rho - p) * alpha.sin()) / alpha.cos();
    let delta = 2.0 * (p / (u + (u * u - p * (2.0 * rho - p)).sqrt())).atan();
    let angle = (alpha - delta).to_degrees();
    let by_angle = |angle: f64| said("protuberance_angle", "deg", &angle.to_string());
    let angled = read(&hobbed(&(amount.clone() + &by_angle(angle) + &stock), &[]));
    let found = angled["height_mm"].as_f64().expect("a number");
    assert!((found - 1.1).abs() < 1e-9, "{angled}");
    let both = |angle: f64| {
        taken(&hobbed(
            &(amount.clone() + &height + &by_angle(angle) + &stock),
            &[],
        ))
    };
    assert!(
        !both(angle)
            .remarks
            .concat()
            .contains("protuberance_angle: ")
    );
    let other = both(angle + 2.0);
    assert_eq!(field(&other, "/pair/driving/protuberance/height_mm"), 1.1);
    assert_noted(
        &other,
        &["Not read: component 30 (rack_shaped_tool \"Hob\"), protuberance_angle: "],
    );
    let Refused(faults) = refused(&hobbed(&amount, &[]));
    assert!(
        faults[0].place.starts_with("component 30")
            && faults[0].detail.contains("protuberance_height"),
        "{faults:?}"
    );
    // Ours stands before it.
    let ours = r#"<attribute id="custom_meshwright_protuberance">{ "amount_um": 130, "height_mm": 1, "grinding_stock_um": 90 }</attribute>"#;
    let both = whole.replacen(
        attribute("face_width"),
        &(attribute("face_width").to_owned() + ours),
        1,
    );
    assert_eq!(
        field(&taken(&both), "/pair/driving/protuberance/amount_um"),
        130
    );
    // Less than the stock is refused at the tool.
    let less = hobbed(
        &(said("protuberance_amount", "mm", "0.08") + &height + &stock),
        &[],
    );
    let imported = taken(&less);
    let problem = parse(&imported.submission).expect_err("a step in the root");
    let error = &problem.errors[0];
    let from = imported.origin(&error.pointer).expect("from somewhere");
    assert!(from.ends_with("protuberance_amount"), "{error:?} {from}");
}

/// Material removed from the profile of the driving gear at a diameter in mm, in um.
fn removed(imported: &Import, diameter: f64) -> f64 {
    let submission = parse(&imported.submission).expect("valid");
    let gear = submission.case().pair.gear(Member::Driving);
    let length = (0.25e-6 * diameter * diameter - gear.base_radius().powi(2)).sqrt();
    gear.removed(length) * 1e6
}

#[test]
fn a_profile_is_crowned_and_sloped_as_is_said_between_two_diameters() {
    let plain = with_more(1, "");
    let part =
        |kind: &str, said: &str| format!(r#"<component id="70" type="{kind}">{said}</component>"#);
    let at = |end: &str, diameter: &str| {
        said(&format!("profile_crowning_at_{end}"), "mum", "8")
            + &said(
                &format!("diameter_where_profile_crowning_{end}_is_specified"),
                "mm",
                diameter,
            )
    };
    let crowning = part("profile_crowning", &(at("tip", "51") + &at("root", "46.5")));
    let crowned = taken(&referring(&plain, &[12, 13], &crowning));
    // Roll lengths of 24 teeth of module 2: a parabola about the middle of those at 46.5 and 51 mm. The tip circle has 52 mm.
    let base = 24.0 * 20_f64.to_radians().cos();
    let roll = |diameter: f64| (0.25 * diameter * diameter - base * base).sqrt();
    let (from, to) = (roll(46.5), roll(51.0));
    let parabola = |diameter: f64| {
        let place = (roll(diameter) - f64::midpoint(from, to)) / (0.5 * (to - from));
        8.0 * place * place
    };
    assert!((parabola(52.0) - 14.2).abs() < 0.02, "{}", parabola(52.0));
    for diameter in [45.7, 46.5, 48.0, 49.0, 50.0, 51.0, 52.0] {
        let (is, should) = (removed(&crowned, diameter), parabola(diameter));
        // Of conversions to micrometers and back nothing else is left.
        assert!((is - should).abs() < 1e-6, "{diameter}: {is} {should}");
    }
    let slope = said("profile_slope", "mum", "6")
        + &said("profile_evaluation_start", "mm", "46.5")
        + &said("profile_evaluation_end", "mm", "51");
    let sloped = taken(&referring(
        &plain,
        &[12, 13],
        &part("profile_slope", &slope),
    ));
    for diameter in [45.7, 46.5, 49.0, 51.0, 52.0] {
        let should = 6.0 * (roll(diameter) - from) / (to - from);
        let is = removed(&sloped, diameter);
        assert!((is - should).abs() < 1e-6, "{diameter}: {is} {should}");
    }
    // Of an undercut flank it is not known here where it begins: its points are told. A program writes `false` for a word that was not chosen.
    let sun = String::from_utf8_lossy(model!("sun-17-teeth.rexs"));
    let crowning =
        at("tip", "37") + &at("root", "33") + &said("shape_of_profile_crowning", "", "false");
    let crowned = taken(&referring(
        &sun,
        &[12, 13],
        &part("profile_crowning", &crowning),
    ));
    let table = field(&crowned, "/pair/driving/profile_modifications/0");
    let list = |name: &str| -> Vec<f64> {
        let cells = table[name].as_array().expect("a list").iter();
        cells.map(|cell| cell.as_f64().expect("a number")).collect()
    };
    let base = 17.0 * 20_f64.to_radians().cos();
    let roll = |diameter: f64| (0.25 * diameter * diameter - base * base).sqrt();
    let (from, to) = (roll(33.0), roll(37.0));
    let (places, amounts) = (list("roll_length_mm"), list("removed_um"));
    assert_eq!((places.len(), amounts.len()), (49, 49));
    assert!((places[48] - roll(38.0)).abs() < 1e-9);
    for (place, is) in places.iter().zip(amounts) {
        let should = 8.0 * ((place - f64::midpoint(from, to)) / (0.5 * (to - from))).powi(2);
        assert!((is - should).abs() < 1e-6, "{place}: {is} {should}");
    }
    let below = part("profile_crowning", &(at("tip", "51") + &at("root", "44")));
    assert_refused(
        &referring(&plain, &[12, 13], &below),
        "diameter_where_profile_crowning_root_is_specified",
        &["44 mm", "base circle", "45.10"],
    );
    let by_length = said("profile_crowning_at_tip", "mum", "8")
        + &said("length_where_profile_crowning_tip_is_specified", "mm", "9");
    assert_refused(
        &referring(&plain, &[12, 13], &part("profile_crowning", &by_length)),
        "length_where_profile_crowning_tip_is_specified",
        &["diameter_where_profile_crowning_tip_is_specified"],
    );
    let off = part(
        "profile_crowning",
        &(at("tip", "51") + &at("root", "46.5") + &said("profile_highest_point", "mm", "50")),
    );
    assert_refused(
        &referring(&plain, &[12, 13], &off),
        "profile_highest_point",
        &["midway"],
    );
}

#[test]
fn a_lead_is_crowned_sloped_and_relieved_as_is_said_along_a_part_of_the_face() {
    let plain = with_more(1, "");
    let leads = |kind: &str, said: &str| {
        let part = format!(r#"<component id="70" type="{kind}">{said}</component>"#);
        referring(&plain, &[12, 13], &part)
    };
    let crowning = |from: &str, to: &str| {
        let at = |end: &str, place: &str| {
            said(&format!("helix_crowning_amount_{end}"), "mum", "5")
                + &said(
                    &format!("coordinate_where_helix_crowning_is_specified_{end}"),
                    "mm",
                    place,
                )
        };
        leads(
            "helix_crowning",
            &(at("datum_face", from) + &at("non_datum_face", to)),
        )
    };
    // 5 um at the ends of 16 mm are 5 (20/16)^2 um at those of 20 mm.
    for (from, to) in [("2", "18"), ("-8", "8")] {
        assert_eq!(
            field(
                &taken(&crowning(from, to)),
                "/pair/driving/lead_modifications"
            ),
            json!([{ "kind": "crowning", "amount_um": 7.8125 }])
        );
    }
    assert_refused(
        &crowning("2", "20"),
        "coordinate_where_helix_crowning_is_specified_non_datum_face",
        &["alike"],
    );
    let slope = said("helix_slope", "mum", "8")
        + &said("helix_evaluation_start", "mm", "2")
        + &said("helix_evaluation_end", "mm", "18");
    assert_eq!(
        field(
            &taken(&leads("helix_slope", &slope)),
            "/pair/driving/lead_modifications"
        ),
        json!([
            { "kind": "slope", "amount_um": 10.0 },
            { "kind": "table", "z_mm": [-10.0, 10.0], "removed_um": [-1.0, -1.0] },
        ])
    );
    let end = |id: u32, end: &str| {
        format!(
            r#"<component id="{id}" type="end_relief_{end}">{}{}{}</component>"#,
            said(&format!("end_relief_depth_{end}"), "mum", "12"),
            said(&format!("end_relief_length_{end}"), "mm", "3"),
            said("shape_of_relief", "none", "linear"),
        )
    };
    let one = referring(&plain, &[12, 13], &end(70, "datum_face"));
    let both = one
        .replace("</components>", &(end(71, "non_datum_face") + "</components>"))
        .replace(
            "</relations>",
            r#"<relation id="71" type="reference"><ref id="12" role="origin"/><ref id="71" role="referenced"/></relation><relation id="72" type="reference"><ref id="13" role="origin"/><ref id="71" role="referenced"/></relation></relations>"#,
        );
    assert_eq!(
        field(&taken(&both), "/pair/driving/lead_modifications"),
        json!([{ "kind": "end_relief", "amount_um": 12.0, "length_mm": 3.0, "side": "both" }])
    );
}

#[test]
fn a_pair_keeps_the_tool_that_cut_its_roots_there_and_back() {
    let thinner = ("/pair/driving/tooth_thickness_deviation_um", json!(-40));
    for (more, means) in [
        (vec![], ("hob", None)),
        (
            vec![("/pair/driving/thinned_by", json!("flank_grinding"))],
            ("flank_grinding", None),
        ),
        (
            vec![("/pair/driving/generating_profile_shift", json!(-0.05))],
            ("hob", Some(-0.05)),
        ),
    ] {
        let changes: Vec<_> = [thinner.clone()].into_iter().chain(more).collect();
        let gone = parse(&testing::with(example("test-case-2"), &changes)).expect("valid");
        let back = taken(&model_of(&gone, None, DATE));
        let back = parse(&back.submission).expect("valid");
        let [gone, found] = [&gone, &back].map(|submission| {
            let gear = submission.case().pair.driving();
            [gear.root_radius(), gear.form_radius(), gear.tip_thickness()]
        });
        for (gone, found) in gone.iter().zip(found) {
            assert!((gone - found).abs() < 1e-12, "{means:?}: {gone} {found}");
        }
        let written = serde_json::to_value(&back).expect("JSON");
        let driving = &written["pair"]["driving"];
        assert_eq!(driving["thinned_by"], means.0);
        let shift = driving["generating_profile_shift"].as_f64();
        assert_eq!(shift.is_some(), means.1.is_some());
        let apart = shift.unwrap_or(0.0) - means.1.unwrap_or(0.0);
        assert!(apart.abs() < 1e-9);
    }
}
