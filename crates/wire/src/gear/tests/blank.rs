//! Blanks: patterns of holes, angles, slots and webs.

use meshwright_engine::gear::{Core, FaceEnds, Hole, HoleShape};
use serde_json::{Value, json};

use super::{data_of, fault, faults, mended, near};
use crate::Code;
use crate::testing::{and, refused};

/// The driving gear with these holes, bore 15 mm, root circle 47.5 mm.
fn holes(holes: &Value) -> Value {
    json!({ "blank": { "bore_radius_mm": 15.0, "holes": holes } })
}

fn web(inner: f64, outer: f64, thickness: f64) -> Value {
    json!({ "blank": { "bore_radius_mm": 15.0, "web": {
        "inner_radius_mm": inner, "outer_radius_mm": outer, "thickness_mm": thickness
    } } })
}

#[test]
fn a_pattern_alone_and_in_a_list_and_by_its_angles_is_the_same() {
    let even = json!({ "count": 4, "circle_radius_mm": 30.0, "radius_mm": 6.0, "phase_deg": 10.0 });
    let at = json!({ "at_deg": [10, 100, 190, 280], "circle_radius_mm": 30.0, "radius_mm": 6.0 });
    let holes_of = |document: &Value| data_of(&holes(document)).blank.holes;
    let alone = holes_of(&even);
    assert_eq!(alone.len(), 4);
    assert_eq!(holes_of(&json!([even])), alone);
    for (one, other) in holes_of(&at).iter().zip(&alone) {
        near(one.angle, other.angle);
        assert_eq!(
            (&one.shape, one.circle_radius),
            (&other.shape, other.circle_radius)
        );
    }
    for none in [json!(null), json!([])] {
        assert!(holes_of(&none).is_empty());
    }
}

#[test]
fn slots_and_several_circles_reach_the_engine_in_order() {
    let data = data_of(&holes(&json!([
        { "count": 2, "circle_radius_mm": 24.0, "radius_mm": 4.0 },
        { "at_deg": [45.0, -135.0], "circle_radius_mm": 38.0, "slot": { "width_mm": 6.0, "angle_deg": 30.0 } }
    ])));
    let [.., third, fourth] = data.blank.holes.as_slice() else {
        panic!("four holes")
    };
    assert_eq!(
        *third,
        Hole {
            circle_radius: 38e-3,
            angle: 45_f64.to_radians(),
            shape: HoleShape::Slot {
                width: 6e-3,
                angle: 30_f64.to_radians()
            },
        }
    );
    near(fourth.angle, -135_f64.to_radians());
}

#[test]
fn holes_that_do_not_fit_are_told_in_their_pattern_with_what_would_do() {
    let first = json!({ "count": 2, "circle_radius_mm": 30.0, "radius_mm": 6.0 });
    let slot = |circle: f64, width: f64, angle: f64, count: u32| json!({ "count": count, "circle_radius_mm": circle, "slot": { "width_mm": width, "angle_deg": angle } });
    let round = |circle: f64, radius: f64, at: Value| json!({ "at_deg": at, "circle_radius_mm": circle, "radius_mm": radius });
    for (document, place, code, _) in refused! {
        // The second pattern gives way to the first.
        json!([first, round(32.0, 5.0, json!([20]))]) => "1/radius_mm", HolesOverlap;
        json!([first, round(40.0, 8.0, json!([90]))]) => "1/radius_mm", HolesBreachRim;
        json!([first, round(20.0, 6.0, json!([90]))]) => "1/radius_mm", HolesBreachBore;
        json!([slot(30.0, 6.0, 100.0, 4)]) => "0/slot/angle_deg", HolesOverlap;
        json!([slot(30.0, 6.0, 348.0, 1)]) => "0/slot/angle_deg", HolesOverlap;
        json!([slot(40.0, 16.0, 20.0, 3)]) => "0/slot/width_mm", HolesBreachRim;
        slot(30.0, 24.0, 0.0, 8) => "slot/width_mm", HolesOverlap;
        round(30.0, 6.0, json!([0, 20, 180])) => "radius_mm", HolesOverlap;
        round(47.0, 6.0, json!([0])) => "circle_radius_mm", HolesBreachRim;
    } {
        let fields = holes(&document);
        let found = &faults(&fields)[0];
        let expected = format!("/pair/driving/blank/holes/{place}");
        assert_eq!(
            (&found.pointer, found.code),
            (&expected, code),
            "{document}: {found:?}"
        );
        mended(&fields);
    }
    // Two holes at one angle find neither radius nor circle.
    let same = fault(
        &holes(&round(30.0, 6.0, json!([20, 20]))),
        "blank/holes/circle_radius_mm",
        Code::HolesOverlap,
    );
    assert_eq!(same.nearest, None);
}

#[test]
fn a_pattern_says_where_and_how_its_holes_are_in_one_way() {
    let pattern = |fields: Value| holes(&and(json!({ "circle_radius_mm": 30.0 }), &fields));
    let slot = json!({ "width_mm": 5, "angle_deg": 10 });
    for (fields, place, code, _) in refused! {
        json!({ "count": 3, "at_deg": [0], "radius_mm": 5 }) => "at_deg", ConflictingFields;
        json!({ "phase_deg": 3, "at_deg": [0], "radius_mm": 5 }) => "at_deg", ConflictingFields;
        json!({ "count": 3, "radius_mm": 5, "slot": slot }) => "slot", ConflictingFields;
        json!({ "count": 3 }) => "radius_mm", MissingField;
        json!({ "radius_mm": 5 }) => "count", MissingField;
        json!({ "at_deg": [], "radius_mm": 5 }) => "at_deg", WrongLength;
        json!({ "at_deg": 7, "radius_mm": 5 }) => "at_deg", WrongType;
    } {
        fault(&pattern(fields), &format!("blank/holes/{place}"), code);
    }
    let many = json!([
        { "count": 40, "circle_radius_mm": 40.0, "radius_mm": 1.0 },
        { "count": 40, "circle_radius_mm": 30.0, "radius_mm": 1.0 }
    ]);
    fault(&holes(&many), "blank/holes", Code::TooLarge);
}

#[test]
fn a_gear_that_is_cut_on_its_shaft_says_the_shaft_instead_of_the_bore() {
    let on_shaft = |radius: f64| json!({ "blank": { "shaft": { "radius_mm": radius } } });
    let data = data_of(&on_shaft(15.0)).blank;
    assert_eq!(
        (data.core, data.bore_radius),
        (
            Core::Shaft {
                torque_at: FaceEnds::Both
            },
            15e-3
        )
    );
    let both = json!({ "blank": { "bore_radius_mm": 15.0, "shaft": { "radius_mm": 15.0 } } });
    for (fields, place, code, _) in refused! {
        both => "shaft", ConflictingFields;
        json!({ "blank": {} }) => "bore_radius_mm", MissingField;
        json!({ "blank": { "shaft": {} } }) => "shaft/radius_mm", MissingField;
        on_shaft(1.0) => "shaft/radius_mm", OutOfRange;
        on_shaft(46.0) => "shaft/radius_mm", BoreTooLarge;
    } {
        fault(&fields, &format!("blank/{place}"), code);
    }
    mended(&on_shaft(46.0));
}

#[test]
fn a_web_lies_between_bore_and_rim() {
    let data = data_of(&web(20.0, 44.0, 6.0)).blank.web.expect("a web");
    assert_eq!(
        (data.inner_radius, data.outer_radius, data.thickness),
        (20e-3, 44e-3, 6e-3)
    );
    for (fields, name, code, _) in refused! {
        web(14.0, 44.0, 6.0) => "inner_radius_mm", WebOutsideBlank;
        web(20.0, 47.0, 6.0) => "outer_radius_mm", WebOutsideBlank;
        web(30.0, 20.0, 6.0) => "outer_radius_mm", WebOutsideBlank;
        web(15.01, 44.0, 6.0) => "inner_radius_mm", OutOfRange;
        web(20.0, 20.1, 6.0) => "outer_radius_mm", OutOfRange;
        web(20.0, 44.0, 0.1) => "thickness_mm", OutOfRange;
        web(20.0, 44.0, 90.0) => "thickness_mm", OutOfRange;
    } {
        let found = fault(&fields, &format!("blank/web/{name}"), code);
        assert!(found.nearest.is_some(), "{found:?}");
        mended(&fields);
    }
}
