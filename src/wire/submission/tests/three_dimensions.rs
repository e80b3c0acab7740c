//! What three dimensions take, what planes refuse of it, and what comes of a pair along its faces.

use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use serde_json::{Value, json};

use super::{filled_in, least, parse, put};
use crate::wire::{Code, solve};

/// A straight pair that three dimensions take.
fn solid() -> Value {
    let mut document = least();
    put(&mut document, "/method", json!("three_dimensional"));
    document
}

fn with(mut document: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, value) in changes {
        put(&mut document, pointer, value.clone());
    }
    document
}

/// Values, and where they are put.
type Changes<'a> = Vec<(&'a str, Value)>;

/// Everything that the plane does not know, with what it takes instead.
fn beyond_the_plane() -> Vec<(&'static str, Value, &'static str, Option<f64>)> {
    let web =
        json!({ "inner_radius_mm": 20, "outer_radius_mm": 42, "thickness_mm": 6, "offset_mm": 2 });
    let hub = json!({ "outer_radius_mm": 20, "width_mm": 24 });
    let slopes = json!({ "lead_slope_um": vec![3.0; 50] });
    vec![
        (
            "/pair/helix_angle_deg",
            json!(10),
            "/pair/helix_angle_deg",
            Some(0.0),
        ),
        (
            "/pair/axial_offset_mm",
            json!(-1),
            "/pair/axial_offset_mm",
            Some(0.0),
        ),
        (
            "/pair/misalignment_um",
            json!({ "out_of_plane_um": 5 }),
            "/pair/misalignment_um",
            None,
        ),
        (
            "/pair/driving/lead_modifications",
            json!([{ "kind": "crowning", "amount_um": 5 }]),
            "/pair/driving/lead_modifications",
            None,
        ),
        (
            "/pair/driven/tooth_deviations",
            slopes,
            "/pair/driven/tooth_deviations/lead_slope_um",
            None,
        ),
        (
            "/pair/driven/blank/web",
            web,
            "/pair/driven/blank/web/offset_mm",
            Some(0.0),
        ),
        (
            "/pair/driving/blank/hub",
            hub,
            "/pair/driving/blank/hub",
            None,
        ),
    ]
}

#[test]
fn planes_refuse_what_they_do_not_know_and_three_dimensions_take_it() {
    for (pointer, value, told_at, nearest) in beyond_the_plane() {
        for method in [
            "flexible",
            "decomposition",
            "projected_decomposition",
            "load_distribution",
        ] {
            let document = with(
                least(),
                &[(pointer, value.clone()), ("/method", json!(method))],
            );
            let problem = parse(&document).expect_err(pointer);
            let error = &problem.errors[0];
            assert_eq!(problem.errors.len(), 1, "{problem:?}");
            assert_eq!(
                (error.pointer.as_str(), error.code, error.nearest),
                (told_at, Code::NeedsThreeDimensions, nearest)
            );
        }
        let mut changes = vec![(pointer, value)];
        if pointer.contains("helix") {
            changes.push(("/pair/center_distance_mm", json!(102.0)));
        }
        for method in ["three_dimensional", "three_dimensional_projected"] {
            changes.push(("/method", json!(method)));
            let taken = parse(&with(least(), &changes));
            assert!(taken.is_ok(), "{method}, {pointer}: {taken:?}");
        }
    }
}

#[test]
fn what_is_said_to_be_nothing_is_nothing() {
    let nothing = [
        ("/pair/helix_angle_deg", json!(0)),
        ("/pair/axial_offset_mm", json!(0)),
        ("/pair/misalignment_um", json!({ "in_plane_um": 0 })),
        ("/pair/driving/lead_modifications", json!([])),
    ];
    assert!(parse(&with(least(), &nothing)).is_ok());
}

#[test]
fn what_three_dimensions_do_not_tell_is_refused_with_its_place() {
    for (pointer, value, told_at) in [
        ("/force_table", json!({}), "/force_table"),
        (
            "/resolution",
            json!({ "contact_solver": "augmented_lagrangian" }),
            "/resolution/contact_solver",
        ),
    ] {
        let problem = parse(&with(solid(), &[(pointer, value)])).expect_err(pointer);
        let error = &problem.errors[0];
        assert_eq!(
            (error.pointer.as_str(), error.code),
            (told_at, Code::NotInThreeDimensions)
        );
    }
}

#[test]
fn each_fault_along_the_axis_is_told_with_a_value_that_would_do() {
    let web = |offset: f64| json!({ "inner_radius_mm": 20, "outer_radius_mm": 42, "thickness_mm": 6, "offset_mm": offset });
    let hub = |width: f64, outer: f64| json!({ "outer_radius_mm": outer, "width_mm": width });
    let relief =
        |length: f64| json!([{ "kind": "end_relief", "amount_um": 5, "length_mm": length }]);
    let table = json!([{ "kind": "table", "z_mm": [0, 0], "removed_um": [0, 1] }]);
    let blank = "/pair/driven/blank";
    let cases: Vec<(Changes<'_>, &str, Code)> = vec![
        (
            vec![("/pair/axial_offset_mm", json!(19))],
            "/pair/axial_offset_mm",
            Code::FacesDoNotOverlap,
        ),
        (
            vec![("/pair/axial_offset_mm", json!(-40))],
            "/pair/axial_offset_mm",
            Code::FacesDoNotOverlap,
        ),
        (
            vec![("/pair/driven/blank/web", web(9.0))],
            "/pair/driven/blank/web/offset_mm",
            Code::WebBeyondFace,
        ),
        (
            vec![
                ("/pair/driven/blank/web", web(0.0)),
                ("/pair/driven/blank/hub", hub(5.0, 20.0)),
            ],
            "/pair/driven/blank/hub/width_mm",
            Code::HubDoesNotFit,
        ),
        (
            vec![("/pair/driven/blank/hub", hub(24.0, 60.0))],
            "/pair/driven/blank/hub/outer_radius_mm",
            Code::HubDoesNotFit,
        ),
        (
            vec![("/pair/driven/lead_modifications", relief(11.0))],
            "/pair/driven/lead_modifications/0/length_mm",
            Code::OutOfRange,
        ),
        (
            vec![("/pair/driven/lead_modifications", table)],
            "/pair/driven/lead_modifications/0/z_mm",
            Code::TableDoesNotRise,
        ),
        (
            vec![("/pair/helix_angle_deg", json!(46))],
            "/pair/helix_angle_deg",
            Code::OutOfRange,
        ),
        (
            // In the transverse section the teeth are undercut below fewer than in the normal one.
            vec![
                ("/pair/helix_angle_deg", json!(20)),
                ("/pair/driving/tooth_count", json!(10)),
                ("/pair/center_distance_mm", json!(64.5)),
                ("/pair/driving/blank/bore_radius_mm", json!(4)),
            ],
            "/pair/driving/profile_shift",
            Code::Undercut,
        ),
    ];
    for (changes, told_at, code) in cases {
        let document = with(solid(), &changes);
        let problem = parse(&document).expect_err(told_at);
        let error = &problem.errors[0];
        assert_eq!(
            (error.pointer.as_str(), error.code),
            (told_at, code),
            "{problem:?}"
        );
        let Some(nearest) = error.nearest else {
            assert_eq!(code, Code::TableDoesNotRise, "{problem:?}");
            continue;
        };
        let cured = with(document, &[(told_at, json!(nearest))]);
        let left = parse(&cured).err().map(|problem| problem.errors);
        let left = left.unwrap_or_default();
        assert!(
            left.iter().all(|error| error.pointer != told_at),
            "{left:?}"
        );
    }
    assert!(parse(&with(solid(), &[(blank, json!({ "bore_radius_mm": 15 }))])).is_ok());
}

#[test]
fn a_helical_pair_has_the_sections_of_the_standard() {
    let document = with(
        solid(),
        &[
            ("/pair/helix_angle_deg", json!(20)),
            ("/pair/center_distance_mm", json!(107.0)),
            ("/pair/driving/profile_shift", json!(0.2)),
            ("/pair/driven/tip_diameter_mm", json!(110.4)),
        ],
    );
    let submission = parse(&document).expect("a pair that meshes");
    let pair = &submission.case().pair;
    let cos = 20_f64.to_radians().cos();
    let (driving, driven) = (pair.driving(), pair.driven());
    assert!((driving.reference_radius() - 50e-3 / cos).abs() < 1e-15);
    // r_a = r + h_a + x m_n: the shift is in normal modules.
    assert!((driving.tip_radius() - (50e-3 / cos + 2e-3 + 0.4e-3)).abs() < 1e-15);
    assert!((driven.tip_radius() - 55.2e-3).abs() < 1e-15);
    let faces = submission.case().faces.as_ref().expect("along its faces");
    assert_eq!(
        faces
            .pair
            .gear(meshwright_engine::gear::Member::Driving)
            .twist()
            .signum(),
        1.0
    );
}

#[test]
fn the_projection_tells_what_the_whole_solution_does_and_how_far_it_is_off() {
    let pattern = json!({ "count": 6, "circle_radius_mm": 42, "radius_mm": 6 });
    let document = with(
        filled_in("helical-pair"),
        &[
            ("/method", json!("three_dimensional_projected")),
            ("/pair/driven/blank/holes", pattern),
            ("/output_torques_n_m", json!([100])),
            ("/resolution/positions_per_mesh_period", json!(8)),
            ("/resolution/span_mesh_periods", json!(10)),
            ("/resolution/face_order", json!(4)),
            ("/face_load", json!("positions")),
        ],
    );
    let solved = |document: &Value| -> Value {
        let submission = parse(document).expect("valid");
        let results = solve(&submission, &Library::default(), &Run::unattended());
        serde_json::from_str(&results.expect("solves")).expect("JSON")
    };
    let projected = solved(&document);
    let whole = solved(&with(document, &[("/method", json!("three_dimensional"))]));
    let names = |value: &Value, place: &str| -> Vec<String> {
        let object = value.pointer(place).and_then(Value::as_object);
        object.expect("an object").keys().cloned().collect()
    };
    for place in ["", "/pair", "/curves/0", "/curves/0/face"] {
        assert_eq!(names(&projected, place), names(&whole, place), "{place}");
    }
    let rows = |of: &Value, name: &str| {
        let rows = of
            .pointer(&format!("/curves/0{name}"))
            .and_then(Value::as_array);
        rows.expect(name).len()
    };
    for name in [
        "/transmission_error_um",
        "/face/load_n_per_mm",
        "/face/load_centroid_mm",
    ] {
        assert_eq!(
            (rows(&projected, name), rows(&whole, name)),
            (80, 80),
            "{name}"
        );
    }
    assert_eq!(projected["method"], "three_dimensional_projected");
    let error = projected["evidence"]["projection_error_um"].as_f64();
    assert!(error.expect("it is told") < 0.1, "{error:?}");
    let unseen = projected["evidence"]["does_not_see"].to_string();
    assert!(unseen.contains("beyond first order"), "{unseen}");
}

#[test]
fn results_tell_the_load_along_the_face() {
    let document = with(
        filled_in("helical-pair"),
        &[
            ("/output_torques_n_m", json!([100, 0])),
            ("/resolution/positions_per_mesh_period", json!(8)),
            ("/resolution/face_order", json!(4)),
            ("/face_load", json!("positions")),
        ],
    );
    let submission = parse(&document).expect("valid");
    let results = solve(&submission, &Library::default(), &Run::unattended()).expect("solves");
    let results: Value = serde_json::from_str(&results).expect("JSON");
    let (curve, face) = (&results["curves"][0], &results["curves"][0]["face"]);
    let rows = face["load_n_per_mm"].as_array().expect("rows");
    let heights = face["z_mm"].as_array().expect("heights");
    assert_eq!((rows.len(), heights.len()), (8, 40));
    let strip = 20.0 / 40.0;
    for row in rows {
        let row = row
            .as_array()
            .expect("numbers")
            .iter()
            .filter_map(Value::as_f64);
        let load = row.sum::<f64>() * strip;
        assert!((load / curve["load_n"].as_f64().expect("a load") - 1.0).abs() < 1e-6);
    }
    let factor = face["face_load_factor"].as_f64().expect("a factor");
    assert!(factor > 1.0 && factor < 10.0, "{factor}");
    assert_eq!(face["load_centroid_mm"].as_array().map(Vec::len), Some(8));
    assert!(
        results["curves"][1].get("face").is_none(),
        "no load, no load along the face"
    );
    let pair = &results["pair"];
    let number = |name: &str| pair[name].as_f64().expect("a number");
    let total = number("contact_ratio") + number("overlap_ratio");
    assert!((number("total_contact_ratio") - total).abs() < 1e-8);
    assert!((number("helix_angle_base_deg") - 18.7472).abs() < 1e-4);
    assert!((number("transverse_module_mm") - 2.12836).abs() < 1e-5);
    assert!((number("transverse_pressure_angle_deg") - 21.1728).abs() < 1e-4);
    let unseen = results["evidence"]["does_not_see"].to_string();
    assert!(!unseen.contains("the model is plane"), "{unseen}");
}
