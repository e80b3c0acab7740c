//! Spokes and outlines: reading, conversion for the engine and refusals; a gear drawn in two ways, or in a drawing, is one gear.

use std::f64::consts::PI;

use meshwright_engine::gear::HoleShape;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_exchange::dxf::{Choices, outline};
use serde_json::{Value, json};

use super::{data_of, fault, faults, mended, near};
use crate::Code;
use crate::outline::PairOutline;
use crate::solve::solve;
use crate::testing::{parse, refused, with};

fn spokes() -> Value {
    json!({ "count": 5, "width_mm": 4.0, "fillet_radius_mm": 3.0, "inner_radius_mm": 19.0, "outer_radius_mm": 39.0, "phase_deg": 10.0 })
}

fn blank(fields: &Value) -> Value {
    let mut blank = json!({ "bore_radius_mm": 15.0 });
    for (name, value) in fields.as_object().expect("fields") {
        blank[name] = value.clone();
    }
    json!({ "blank": blank })
}

fn line(x: f64, y: f64) -> Value {
    json!({ "line_to": [x, y] })
}

fn arc(through: [f64; 2], to: [f64; 2]) -> Value {
    json!({ "arc_to": to, "through": through })
}

/// A point in mm at a polar angle in degrees.
fn polar(radius: f64, degrees: f64) -> [f64; 2] {
    let angle = degrees.to_radians();
    [radius * angle.cos(), radius * angle.sin()]
}

/// A circle, clockwise or counter-clockwise, of two arcs.
fn circle(center: [f64; 2], radius: f64, is_clockwise: bool) -> Value {
    let at = |degrees: f64| {
        let [x, y] = polar(radius, if is_clockwise { -degrees } else { degrees });
        [center[0] + x, center[1] + y]
    };
    json!([arc(at(10.0), at(100.0)), arc(at(190.0), at(280.0))])
}

/// A kidney about `degrees`, clockwise.
fn kidney(radius: f64, width: f64, degrees: f64, span: f64) -> Value {
    let (low, high) = (degrees - span / 2.0, degrees + span / 2.0);
    let (inner, outer) = (radius - width / 2.0, radius + width / 2.0);
    let end = |at: f64, side: f64| {
        let ([x, y], [u, v]) = (polar(radius, at), polar(width / 2.0, at + side));
        [x + u, y + v]
    };
    json!([
        arc(polar(outer, degrees), polar(outer, low)),
        arc(end(low, -90.0), polar(inner, low)),
        arc(polar(inner, degrees), polar(inner, high)),
        arc(end(high, 90.0), polar(outer, high)),
    ])
}

/// The opening between two of `spokes`, clockwise, by compass and ruler.
fn between_spokes(spokes: &Value, index: u32) -> Value {
    let number = |name: &str| spokes[name].as_f64().expect("a number");
    let (half, rho) = (number("width_mm") / 2.0, number("fillet_radius_mm"));
    let (inner, outer) = (number("inner_radius_mm"), number("outer_radius_mm"));
    let pitch = 360.0 / number("count");
    let middle = number("phase_deg") + (f64::from(index) + 0.5) * pitch;
    // Beside the spoke at −pitch/2 in a frame along the middle of the opening; `sign` mirrors.
    let world = |[along, across]: [f64; 2], sign: f64| {
        let ([a, b], [c, d]) = (polar(1.0, -pitch / 2.0), polar(1.0, 90.0 - pitch / 2.0));
        let (x, y) = (along * a + across * c, sign * (along * b + across * d));
        let [e, f] = polar(1.0, middle);
        [x * e - y * f, x * f + y * e]
    };
    let center = |distance: f64| [(distance.powi(2) - (half + rho).powi(2)).sqrt(), half + rho];
    let (low, high) = (center(inner + rho), center(outer - rho));
    let on_spoke = |[along, _]: [f64; 2]| [along, half];
    let times = |[a, b]: [f64; 2], factor: f64| [a * factor, b * factor];
    let (ring, rim) = (
        times(low, inner / (inner + rho)),
        times(high, outer / (outer - rho)),
    );
    // A point of the fillet between its ends.
    let within = |center: [f64; 2], a: [f64; 2], b: [f64; 2]| {
        let way = [a[0] + b[0] - 2.0 * center[0], a[1] + b[1] - 2.0 * center[1]];
        let scale = rho / way[0].hypot(way[1]);
        [center[0] + way[0] * scale, center[1] + way[1] * scale]
    };
    let (at_ring, at_rim) = (
        within(low, ring, on_spoke(low)),
        within(high, rim, on_spoke(high)),
    );
    json!([
        arc(polar(outer, middle), world(rim, 1.0)),
        arc(world(at_rim, 1.0), world(on_spoke(high), 1.0)),
        { "line_to": world(on_spoke(low), 1.0) },
        arc(world(at_ring, 1.0), world(ring, 1.0)),
        arc(polar(inner, middle), world(ring, -1.0)),
        arc(world(at_ring, -1.0), world(on_spoke(low), -1.0)),
        { "line_to": world(on_spoke(high), -1.0) },
        arc(world(at_rim, -1.0), world(rim, -1.0)),
    ])
}

#[test]
fn spokes_stand_beside_holes_and_are_told_with_what_is_left_between_them() {
    let holes =
        json!({ "count": 5, "circle_radius_mm": 42.5, "radius_mm": 1.0, "phase_deg": 10.0 });
    let data = data_of(&blank(&json!({ "spokes": spokes(), "holes": holes })));
    assert_eq!(data.blank.holes.len(), 10);
    assert!(matches!(data.blank.holes[5].shape, HoleShape::Contour(_)));
    near(data.blank.holes[5].angle, 46_f64.to_radians());
    let submission = parse(&super::with(&blank(&json!({ "spokes": spokes() })))).expect("valid");
    let gear = submission.case().pair.driving();
    near(gear.least_ligament().expect("openings"), 4e-3);
    let drawn = PairOutline::of(&submission.case().pair);
    let json: Value = serde_json::from_str(&drawn.to_json().expect("JSON")).expect("JSON");
    let openings = json["driving"]["holes"].as_array().expect("openings");
    assert_eq!(openings.len(), 5);
    assert!(openings[0]["edge_mm"].as_array().expect("an edge").len() > 40);
    assert!(json["driving"]["bore_radius_mm"].is_number());
}

#[test]
fn spokes_that_do_not_fit_are_refused_where_they_stand_with_what_would_do() {
    let of = |changes: Value| {
        let mut changed = spokes();
        for (name, value) in changes.as_object().expect("fields") {
            changed[name] = value.clone();
        }
        blank(&json!({ "spokes": changed }))
    };
    for (changes, place, code, _) in refused! {
        json!({ "count": 1 }) => "count", OutOfRange;
        json!({ "width_mm": 30.0 }) => "width_mm", SpokesDoNotFit;
        json!({ "width_mm": 0.4 }) => "width_mm", HolesOverlap;
        json!({ "fillet_radius_mm": 11.0 }) => "fillet_radius_mm", SpokesDoNotFit;
        json!({ "fillet_radius_mm": 0.02 }) => "fillet_radius_mm", OutOfRange;
        json!({ "outer_radius_mm": 18.0 }) => "outer_radius_mm", SpokesDoNotFit;
        json!({ "outer_radius_mm": 47.4 }) => "outer_radius_mm", HolesBreachRim;
        json!({ "inner_radius_mm": 15.2 }) => "inner_radius_mm", HolesBreachBore;
    } {
        let fields = of(changes);
        fault(&fields, &format!("blank/spokes/{place}"), code);
        mended(&fields);
    }
    fault(
        &of(json!({ "width_mm": null })),
        "blank/spokes/width_mm",
        Code::WrongType,
    );
    let far = json!({ "spokes": spokes(), "holes": { "count": 1, "circle_radius_mm": 30.0, "radius_mm": 2.0, "phase_deg": 30.0 } });
    fault(&blank(&far), "blank/spokes", Code::HolesOverlap);
    let many = json!({ "spokes": spokes(), "holes": { "count": 58, "circle_radius_mm": 43.0, "radius_mm": 0.6 } });
    fault(&blank(&many), "blank/holes", Code::TooLarge);
}

#[test]
fn an_outline_has_a_thousand_sides_at_most() {
    // Round openings by so many lines each.
    let outline = |loops: u32, sides: u32| {
        let polygon = |i: u32| -> Value {
            let [x, y] = polar(31.0, f64::from(i) * 360.0 / f64::from(loops));
            let corner = |k: u32| {
                let [u, v] = polar(4.0, -f64::from(k) * 360.0 / f64::from(sides));
                line(x + u, y + v)
            };
            (0..sides).map(corner).collect()
        };
        json!({ "outline": (0..loops).map(polygon).collect::<Value>() })
    };
    assert_eq!(data_of(&blank(&outline(10, 100))).blank.holes.len(), 10);
    fault(&blank(&outline(10, 101)), "blank/outline", Code::TooLarge);
}

#[test]
fn loops_that_bound_no_region_are_refused_at_their_side() {
    let square = |x: f64| {
        json!([
            line(x, 5.0),
            line(x + 8.0, 5.0),
            line(x + 8.0, -5.0),
            line(x, -5.0)
        ])
    };
    let outlined = |loops: Value| blank(&json!({ "outline": loops }));
    assert_eq!(
        data_of(&outlined(json!([square(25.0)]))).blank.holes.len(),
        1
    );
    for (loops, place, code, _) in refused! {
        json!([square(25.0), square(30.0)]) => "1", HolesOverlap;
        json!([square(18.5), square(39.0)]) => "1", HolesBreachRim;
        json!([square(14.0)]) => "0", HolesBreachBore;
        json!([square(-4.0)]) => "0", OutlineUnsound;
        json!([[line(25.0, -5.0), line(33.0, -5.0), line(33.0, 5.0), line(25.0, 5.0)]]) => "0", OutlineUnsound;
        json!([[line(25.0, 5.0), line(33.0, -5.0), line(33.0, 5.0), line(25.0, -5.0)]]) => "0/3", OutlineUnsound;
        json!([[line(25.0, 5.0), line(33.0, 5.0), line(33.0, 5.0), line(33.0, -5.0)]]) => "0/2", OutlineUnsound;
        json!([[line(25.0, 5.0), arc([29.0, 5.0], [33.0, 5.0]), line(33.0, -5.0)]]) => "0/1", OutlineUnsound;
        json!([[line(25.0, 0.0), line(35.0, 0.0), line(35.0, -1.0)]]) => "0/1", OutlineUnsound;
        json!([[line(25.0, 0.0), line(35.0, 0.0)]]) => "0", OutlineUnsound;
        json!([circle([30.0, 0.0], 0.3, true)]) => "0", OutlineUnsound;
        json!([circle([0.0, 0.0], 14.0, true)]) => "0", OutlineUnsound;
        json!([circle([0.0, 0.0], 15.0, true), circle([0.0, 0.0], 15.0, true)]) => "1", OutlineUnsound;
        json!([circle([0.0, 0.0], 32.0, false), square(25.0)]) => "0", OutlineUnsound;
        json!([[]]) => "0", WrongLength;
        json!([[{ "arc_to": [3.0, 4.0] }]]) => "0/0/through", MissingField;
        json!([[{ "line_to": [3.0, 4.0], "arc_to": [3.0, 4.0], "through": [1.0, 2.0] }]]) => "0/0/arc_to", ConflictingFields;
        json!([[line(25.0, 5.0), { "line_to": [33.0] }]]) => "0/1/line_to", WrongLength;
    } {
        let found = &faults(&outlined(loops.clone()))[0];
        let expected = format!("/pair/driving/blank/outline/{place}");
        assert_eq!(
            (&found.pointer, found.code),
            (&expected, code),
            "{loops}: {found:?}"
        );
    }
}

/// Center, radius, first angle and turn of an arc, in mm and radians, positive counter-clockwise.
fn arc_of(from: [f64; 2], through: [f64; 2], to: [f64; 2]) -> ([f64; 2], f64, f64, f64) {
    // From the first of them, where the circle is |p|² = 2 p · c.
    let [[a, b], [c, d]] = [through, to].map(|[x, y]| [x - from[0], y - from[1]]);
    let (p, q) = ((a * a + b * b) / 2.0, (c * c + d * d) / 2.0);
    let twice = a * d - b * c;
    let arm = [(p * d - q * b) / twice, (a * q - c * p) / twice];
    let center = [from[0] + arm[0], from[1] + arm[1]];
    let at = |[x, y]: [f64; 2]| (y - center[1]).atan2(x - center[0]);
    let turn = |to: f64| (to - at(from)).rem_euclid(2.0 * PI);
    let turn = match turn(at(through)) < turn(at(to)) {
        true => turn(at(to)),
        false => turn(at(to)) - 2.0 * PI,
    };
    (center, arm[0].hypot(arm[1]), at(from), turn)
}

/// A drawing of these loops in inches: of lines and arcs last to first, every second line the other way round, or of polylines with bulges.
fn dxf(loops: &[Value], of_polylines: bool) -> String {
    let mm = |x: f64| x / 25.4;
    let point = |value: &Value| [0, 1].map(|i| value[i].as_f64().expect("a coordinate"));
    let mut entities: Vec<String> = Vec::new();
    for sides in loops {
        let sides = sides.as_array().expect("sides");
        let end = |side: &Value| point(side.get("line_to").unwrap_or(&side["arc_to"]));
        let mut from = end(sides.last().expect("a side"));
        let mut polyline = format!("0\nLWPOLYLINE\n8\n0\n90\n{}\n70\n1\n", sides.len());
        for (i, side) in sides.iter().enumerate() {
            let to = end(side);
            let [[x, y], [u, v]] = if i.is_multiple_of(2) {
                [from, to]
            } else {
                [to, from]
            };
            let mut bulge = 0.0;
            entities.push(match side.get("through") {
                None => format!(
                    "0\nLINE\n8\n0\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n",
                    mm(x),
                    mm(y),
                    mm(u),
                    mm(v)
                ),
                Some(through) => {
                    let (center, radius, first, turn) = arc_of(from, point(through), to);
                    bulge = (turn / 4.0).tan();
                    let (start, end) = if turn > 0.0 {
                        (first, first + turn)
                    } else {
                        (first + turn, first)
                    };
                    let [x, y] = center.map(mm);
                    let (start, end) = (start.to_degrees(), end.to_degrees());
                    format!(
                        "0\nARC\n8\n0\n10\n{x}\n20\n{y}\n40\n{}\n50\n{start}\n51\n{end}\n",
                        mm(radius)
                    )
                }
            });
            polyline += &format!("10\n{}\n20\n{}\n42\n{bulge}\n", mm(from[0]), mm(from[1]));
            from = to;
        }
        if of_polylines {
            entities.truncate(entities.len() - sides.len());
            entities.push(polyline);
        }
    }
    entities.reverse();
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n1\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n",
        entities.concat()
    )
}

#[test]
fn the_same_gear_drawn_both_ways_has_the_same_curve() {
    let holes =
        json!({ "count": 6, "circle_radius_mm": 30.0, "radius_mm": 7.0, "phase_deg": 10.0 });
    let slots = json!({ "count": 5, "circle_radius_mm": 30.0, "phase_deg": 7.0, "slot": { "width_mm": 9.0, "angle_deg": 40.0 } });
    let of_holes: Vec<Value> = (0..6)
        .map(|i| circle(polar(30.0, 10.0 + 60.0 * f64::from(i)), 7.0, true))
        .collect();
    let of_slots: Vec<Value> = (0..5)
        .map(|i| kidney(30.0, 9.0, 7.0 + 72.0 * f64::from(i), 40.0))
        .collect();
    let mut of_spokes: Vec<Value> = (0..5).map(|i| between_spokes(&spokes(), i)).collect();
    // The bore and the circle around may be given as well.
    of_spokes.push(circle([0.0, 0.0], 15.0, true));
    of_spokes.push(circle([0.0, 0.0], 47.5, false));
    // As a drawing has them.
    let [of_lines, of_polylines] = [false, true].map(|of_polylines| {
        let text = dxf(&of_spokes, of_polylines);
        let read = outline(text.as_bytes(), &Choices::default())
            .unwrap_or_else(|refused| panic!("{refused}"));
        assert_eq!(read.loops.len(), of_spokes.len());
        read.loops.into_iter().map(Value::from).collect()
    });
    for (said, drawn) in [
        (json!({ "holes": holes }), of_holes),
        (json!({ "holes": slots }), of_slots),
        (json!({ "spokes": spokes() }), of_spokes),
        (json!({ "spokes": spokes() }), of_lines),
        (json!({ "spokes": spokes() }), of_polylines),
    ] {
        let [one, other] = [said, json!({ "outline": drawn })].map(|fields| {
            let coarse =
                json!({ "grid": "coarse", "positions_per_mesh_period": 8, "span_mesh_periods": 1 });
            let document = with(
                super::with(&blank(&fields)),
                &[("/resolution", coarse), ("/stress", true.into())],
            );
            let submission = parse(&document).expect("valid");
            let results = solve(&submission, &Library::default(), &Run::unattended());
            let json = results.expect("computed").to_json().expect("JSON");
            let results: Value = serde_json::from_str(&json).expect("JSON");
            let numbers = |name: &str| -> Vec<f64> {
                let list = results["curves"][0][name].as_array().expect("a curve");
                list.iter().filter_map(Value::as_f64).collect()
            };
            let stress = results["curves"][0]["stress"]["driving"]["hole_mpa"].as_array();
            let stress: Vec<f64> = stress
                .into_iter()
                .flatten()
                .filter_map(Value::as_f64)
                .collect();
            assert!(!stress.is_empty() && stress.iter().all(|s| *s > 0.1));
            [
                numbers("transmission_error_um"),
                numbers("mesh_stiffness_tangent_n_per_m"),
                stress,
            ]
        });
        for (one, other) in one.iter().zip(&other) {
            assert_eq!(one.len(), other.len());
            for (a, b) in one.iter().zip(other) {
                println!("{a} {b} {:e}", a / b - 1.0);
                assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}

#[test]
fn an_outline_takes_away_the_area_of_its_loops() {
    let data = data_of(&blank(
        &json!({ "outline": [circle([30.0, 0.0], 6.0, true)] }),
    ));
    let area = data.blank.hole_area();
    assert!((area / (PI * 36e-6) - 1.0).abs() < 1e-12);
}

/// `value` with every number in it rounded to so many decimals.
fn rounded(value: &Value, decimals: i32) -> Value {
    match value {
        Value::Array(items) => items.iter().map(|item| rounded(item, decimals)).collect(),
        Value::Object(fields) => {
            let fields = fields.iter();
            fields
                .map(|(name, item)| (name.clone(), rounded(item, decimals)))
                .collect()
        }
        Value::Number(number) => {
            let unit = 10_f64.powi(decimals);
            json!((number.as_f64().expect("a number") * unit).round() / unit)
        }
        other => other.clone(),
    }
}

#[test]
fn openings_that_are_drawn_with_three_decimals_repeat_as_they_are_meant() {
    let mut six = spokes();
    six["count"] = json!(6);
    let several: Vec<(Vec<Value>, u32)> = vec![
        ((0..6).map(|i| between_spokes(&six, i)).collect(), 6),
        ((0..5).map(|i| between_spokes(&spokes(), i)).collect(), 5),
        (
            (0..7)
                .map(|i| kidney(30.0, 9.0, 7.0 + 360.0 / 7.0 * f64::from(i), 30.0))
                .collect(),
            7,
        ),
    ];
    for (loops, count) in several {
        let drawn = Value::Array(loops);
        for decimals in [3, 4, 6] {
            let outline = rounded(&drawn, decimals);
            let blank = data_of(&blank(&json!({ "outline": outline }))).blank;
            assert_eq!(blank.symmetry().count, count, "{decimals} decimals");
        }
        // One of them moved by a hundredth of a millimeter is drawn so.
        let mut uneven = rounded(&drawn, 3);
        for side in uneven[1].as_array_mut().expect("sides") {
            for (_, point) in side.as_object_mut().expect("a side") {
                let x = point[0].as_f64().expect("a coordinate");
                point[0] = json!(((x + 0.01) * 1e3).round() / 1e3);
            }
        }
        let blank = data_of(&blank(&json!({ "outline": uneven }))).blank;
        assert_eq!(blank.symmetry().count, 1);
    }
}
