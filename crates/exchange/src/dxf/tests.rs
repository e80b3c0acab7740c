use meshwright_engine::gear::Side;
use serde_json::{Value, json};

use super::*;

/// A file with these entities, and with `$INSUNITS` if it is said.
fn file(unit: Option<u8>, entities: &[String]) -> String {
    let unit = unit.map_or_else(String::new, |unit| format!("9\n$INSUNITS\n70\n{unit}\n"));
    format!(
        "999\nby hand\n0\nSECTION\n2\nHEADER\n{unit}0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nLINE\n8\n0\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n",
        entities.concat()
    )
}

/// An entity on layer A with these groups.
fn entity(name: &str, groups: &[(i32, f64)]) -> String {
    let groups = groups
        .iter()
        .map(|(code, value)| format!("{code}\n{value}\n"));
    format!("0\n{name}\n5\n2F\n8\nA\n{}", groups.collect::<String>())
}

fn line(from: [f64; 2], to: [f64; 2]) -> String {
    entity(
        "LINE",
        &[(10, from[0]), (20, from[1]), (11, to[0]), (21, to[1])],
    )
}

fn arc(center: [f64; 2], radius: f64, angles: [f64; 2]) -> String {
    entity(
        "ARC",
        &[
            (10, center[0]),
            (20, center[1]),
            (40, radius),
            (50, angles[0]),
            (51, angles[1]),
        ],
    )
}

fn circle(center: [f64; 2], radius: f64) -> String {
    entity("CIRCLE", &[(10, center[0]), (20, center[1]), (40, radius)])
}

/// An opening from x = 20 to 30 that is straight at y = ±3, with half circles at both ends, in four pieces of no order.
fn opening() -> Vec<String> {
    vec![
        line([20.0, 3.0], [30.0, 3.0]),
        arc([20.0, 0.0], 3.0, [90.0, 270.0]),
        line([20.0, -3.0], [30.0, -3.0]),
        arc([30.0, 0.0], 3.0, [-90.0, 90.0]),
    ]
}

/// The same as it is to be told, clockwise.
fn told() -> Value {
    json!([[
        { "line_to": [30.0, 3.0] },
        { "arc_to": [30.0, -3.0], "through": [33.0, 0.0] },
        { "line_to": [20.0, -3.0] },
        { "arc_to": [20.0, 3.0], "through": [17.0, 0.0] },
    ]])
}

fn read(entities: &[String]) -> Outline {
    taken(&file(Some(4), entities), &Choices::default())
}

fn taken(text: &str, choices: &Choices) -> Outline {
    outline(text.as_bytes(), choices).unwrap_or_else(|refused| panic!("{refused}"))
}

/// That one of the remarks has these words.
fn assert_said(outline: &Outline, words: &str) {
    let remarks = &outline.remarks;
    assert!(
        remarks.iter().any(|remark| remark.contains(words)),
        "{words}: {remarks:?}"
    );
}

/// The sentence with which it is refused.
fn refused(text: &str) -> String {
    refused_with(text, &Choices::default())
}

fn refused_with(text: &str, choices: &Choices) -> String {
    outline(text.as_bytes(), choices)
        .expect_err("refused")
        .to_string()
}

/// Loops, each from the corner that is first in some order.
fn loops(outline: &Outline) -> Value {
    let end = |side: &Value| {
        ["line_to", "arc_to"]
            .iter()
            .find_map(|to| side.get(to))
            .expect("an end")
            .to_string()
    };
    let rotated = |sides: &Vec<Value>| {
        let mut sides = sides.clone();
        let last = (0..sides.len())
            .max_by_key(|i| end(&sides[*i]))
            .expect("sides");
        sides.rotate_left(last);
        sides
    };
    let mut loops: Vec<Value> = outline
        .loops
        .iter()
        .map(|sides| rotated(sides).into())
        .collect();
    loops.sort_by_key(Value::to_string);
    loops.into()
}

#[test]
fn lines_and_arcs_in_any_order_and_direction_are_loops_clockwise_around_openings() {
    let expected = told();
    let of = |loops: &Value| Outline {
        loops: serde_json::from_value(loops.clone()).expect("loops"),
        bore_radius_mm: None,
        remarks: Vec::new(),
    };
    let expected = loops(&of(&expected));
    let mut pieces = opening();
    for turn in 0..4 {
        pieces.rotate_left(turn);
        assert_eq!(loops(&read(&pieces)), expected);
    }
    pieces = opening();
    pieces[0] = line([30.0, 3.0], [20.0, 3.0]);
    pieces.sort();
    let outline = read(&pieces);
    assert_eq!(loops(&outline), expected);
    let json: Value = serde_json::from_str(&outline.to_json()).expect("JSON");
    assert_eq!(loops(&of(&json)), expected);
    // Counter-clockwise from (20, -3), half circles by a bulge of one.
    let corners = [
        ([20.0, -3.0], 0.0),
        ([30.0, -3.0], 1.0),
        ([30.0, 3.0], 0.0),
        ([20.0, 3.0], 1.0),
    ];
    let mut groups = vec![(90, 4.0), (70, 1.0), (38, 2.0)];
    groups.extend(
        corners
            .iter()
            .flat_map(|(at, bulge)| [(10, at[0]), (20, at[1]), (42, *bulge)]),
    );
    assert_eq!(loops(&read(&[entity("LWPOLYLINE", &groups)])), expected);
    let mut old = vec![entity("POLYLINE", &[(66, 1.0), (70, 1.0)])];
    old.extend(
        corners
            .iter()
            .map(|(at, bulge)| entity("VERTEX", &[(10, at[0]), (20, at[1]), (42, *bulge)])),
    );
    old.push(entity("SEQEND", &[]));
    assert_eq!(loops(&read(&old)), expected);
    // Seen from below, x runs the other way; a line says where it is.
    let mut mirrored: Vec<String> = corners
        .iter()
        .map(|(at, bulge)| entity("VERTEX", &[(10, -at[0]), (20, at[1]), (42, -bulge)]))
        .collect();
    mirrored.insert(0, entity("POLYLINE", &[(66, 1.0), (70, 1.0), (230, -1.0)]));
    assert_eq!(loops(&read(&mirrored)), expected);
    let mut pieces = opening();
    pieces[1] = entity(
        "ARC",
        &[
            (10, -20.0),
            (20, 0.0),
            (40, 3.0),
            (50, 270.0),
            (51, 90.0),
            (230, -1.0),
        ],
    );
    pieces[0].push_str("230\n-1\n");
    assert_eq!(loops(&read(&pieces)), expected);
}

#[test]
fn an_arc_of_more_than_half_a_turn_and_a_circle_are_told_in_two() {
    // A circle of radius 5 about (30, 0), cut off at x = 27.
    let pieces = [
        line([27.0, 4.0], [27.0, -4.0]),
        arc(
            [30.0, 0.0],
            5.0,
            [-126.869_897_645_844_02, 126.869_897_645_844_02],
        ),
    ];
    let cut = read(&pieces);
    assert_eq!(cut.loops[0].len(), 3);
    let bulge = f64::tan(253.739_795_291_688_04_f64.to_radians() / 4.0);
    let polyline = entity(
        "LWPOLYLINE",
        &[
            (70, 1.0),
            (10, 27.0),
            (20, -4.0),
            (42, bulge),
            (10, 27.0),
            (20, 4.0),
        ],
    );
    assert_eq!(loops(&read(&[polyline])), loops(&cut));
    let whole = read(&[circle([30.0, 0.0], 5.0)]);
    let expected = json!([{ "arc_to": [25.0, 0.0], "through": [30.0, -5.0] }, { "arc_to": [35.0, 0.0], "through": [30.0, 5.0] }]);
    let mut sides = whole.loops[0].clone();
    sides.sort_by_key(Value::to_string);
    assert_eq!(Value::from(sides), expected);
}

#[test]
fn lengths_are_in_the_unit_that_the_drawing_says_and_without_one_in_mm() {
    let read = |unit| taken(&file(unit, &[circle([2.0, 0.0], 0.5)]), &Choices::default());
    for (unit, reach, remark) in [
        (Some(1), [38.1, 63.5], "in inches, each 25.4 mm"),
        (Some(5), [15.0, 25.0], "in cm"),
        (Some(4), [1.5, 2.5], "in mm"),
        (Some(0), [1.5, 2.5], "no unit"),
        (None, [1.5, 2.5], "no unit"),
    ] {
        let read = read(unit);
        let ends: Vec<f64> = read.loops[0]
            .iter()
            .filter_map(|side| side["arc_to"][0].as_f64())
            .collect();
        assert_eq!([ends[1].min(ends[0]), ends[0].max(ends[1])], reach);
        assert!(read.remarks[0].contains(remark), "{:?}", read.remarks);
    }
    let light_years = refused(&file(Some(19), &[circle([2.0, 0.0], 0.5)]));
    assert!(light_years.contains("$INSUNITS, is 19"), "{light_years}");
    let far = refused(&file(Some(6), &[circle([30.0, 0.0], 5.0)]));
    assert!(
        far.contains("CIRCLE on layer A, line 28 reaches more than 25000 mm"),
        "{far}"
    );
}

#[test]
fn an_open_loop_is_refused_where_it_is_open_with_what_is_missing() {
    let mut pieces = opening();
    pieces[2] = line([20.0, -3.0], [29.95, -3.0]);
    let text = file(Some(4), &pieces);
    let told = refused(&text);
    let place = |name: &str| {
        text.lines()
            .enumerate()
            .filter(|(_, line)| *line == name)
            .map(|(i, _)| i + 1)
            .last()
    };
    let (line_at, arc_at) = (
        place("LINE").expect("a line"),
        place("ARC").expect("an arc"),
    );
    let expected = format!(
        "LINE on layer A, line {line_at} ends at (29.95, -3), and nothing goes on within 0.01 mm: the nearest open end, of ARC on layer A, line {arc_at}, is 0.05 mm off"
    );
    assert!(told.contains(&expected), "{told}\n{expected}");
    // Within the tolerance it is closed, and the next side begins where the last one ends.
    pieces[2] = line([20.0, -3.0], [29.9995, -3.0]);
    let closed = read(&pieces);
    assert_eq!(closed.loops[0].len(), 4);
    let branch = [opening(), vec![line([20.0, 3.0], [25.0, 0.0])]].concat();
    let told = refused(&file(Some(4), &branch));
    assert!(
        told.contains(
            "More than two ends meet at (20, 3) within 0.01 mm: of LINE on layer A, line 28; ARC on"
        ),
        "{told}"
    );
    let flat = [
        line([20.0, 3.0], [30.0, 3.0]),
        line([20.0, 3.0], [25.0, 3.0]),
        line([25.0, 3.0], [30.0, 3.0]),
    ];
    let told = refused(&file(Some(4), &flat));
    assert!(told.contains("encloses nothing"), "{told}");
}

#[test]
fn what_may_change_the_outline_and_is_not_read_is_refused_by_its_name() {
    #[rustfmt::skip]
    let cases = [
        ("SPLINE", vec![(70, 8.0)], "SPLINE on layer A, line 88 has no group 71"),
        ("SPLINE", vec![(71, 3.0), (10, 1.0), (10, 2.0)], "has 2 control points and 0 knots, which make no spline of degree 3"),
        ("ELLIPSE", vec![], "ELLIPSE on layer A, line 88 has no group 10"),
        ("ELLIPSE", vec![(10, 1.0), (20, 0.0), (11, 0.0), (21, 0.0), (40, 1.0)], "has a major axis of 0"),
        ("SURVEYED_CURVE", vec![], "SURVEYED_CURVE on layer A"),
        ("INSERT", vec![(2, 7.0)], "INSERT on layer A, line 88 stands for the block 7, which is not in the file"),
        ("POLYLINE", vec![(70, 64.0)], "is a surface"),
        ("LINE", vec![(10, 1.0), (20, 1.0), (11, 2.0), (21, 1.0), (31, 1.0)], "does not lie in the plane"),
        ("CIRCLE", vec![(10, 1.0), (20, 1.0), (40, 1.0), (210, 1.0), (230, 0.0)], "does not lie in the plane"),
        ("CIRCLE", vec![(10, 1.0), (20, 1.0), (40, f64::NAN)], "has a group 40 that is no number"),
        ("CIRCLE", vec![(10, 1.0), (40, 1.0)], "has no group 20"),
        ("CIRCLE", vec![(10, 1.0), (20, 1.0), (40, 0.0)], "has the radius 0"),
        (
            "LWPOLYLINE",
            vec![(10, 1.0), (20, 1.0), (42, 1e9), (10, 1.0)],
            "has the bulge 1000000000 at its corner 1",
        ),
    ];
    for (name, groups, expected) in cases {
        let text = file(Some(4), &[opening(), vec![entity(name, &groups)]].concat());
        let told = refused(&text);
        assert!(told.contains(expected), "{told}");
        // Not of a sheet of paper, nor of another layer.
        let on_paper = text.replace(
            &format!("{name}\n5\n2F\n8\nA\n"),
            &format!("{name}\n67\n1\n8\nA\n"),
        );
        if name != "LINE" {
            let read = taken(&on_paper, &Choices::default());
            assert!(
                read.remarks
                    .iter()
                    .any(|told| told.contains("Left out: 1 of sheets of paper"))
            );
        }
    }
    let text = entity("TEXT", &[(10, 0.0)]);
    let dimension = entity("DIMENSION", &[(10, 0.0)]);
    let read = read(&[opening(), vec![text.clone(), dimension, text]].concat());
    let told = read
        .remarks
        .iter()
        .find(|told| told.starts_with("Left out"))
        .expect("told");
    assert_eq!(told, "Left out: 1 DIMENSION, 2 TEXT.");
}

fn on_layers(layers: &[&str]) -> Choices {
    Choices {
        layers: layers.iter().map(|layer| (*layer).to_owned()).collect(),
        ..Choices::default()
    }
}

#[test]
fn a_drawing_without_entities_is_refused_in_so_many_words() {
    let told = refused(&file(Some(4), &[]));
    assert!(
        told.contains("There are no lines and arcs; the drawing has no entities."),
        "{told}"
    );
}

#[test]
fn a_layer_is_chosen_by_its_name_whatever_its_case() {
    let corner = line([0.0, 50.0], [100.0, 50.0]) + &line([100.0, 50.0], [100.0, 60.0]);
    let other = corner.replace("8\nA\n", "8\nMitte\n");
    let text = file(Some(4), &[opening(), vec![other]].concat());
    assert!(refused(&text).contains("LINE on layer Mitte"));
    let on = |layers: &[&str]| outline(text.as_bytes(), &on_layers(layers));
    assert_eq!(on(&["a"]).expect("closed").loops.len(), 1);
    assert!(on(&["A", "MITTE"]).is_err());
    let told = on(&["Holes"]).expect_err("no such layer").to_string();
    assert!(
        told.contains("no lines and arcs on layer Holes; entities are on: A, Mitte."),
        "{told}"
    );
    // Names of layers as older files have them.
    let latin: Vec<u8> = text
        .replace("Mitte", "L\u{F6}cher")
        .chars()
        .map(|c| c as u8)
        .collect();
    let told = outline(&latin, &on_layers(&["L\u{F6}cher"]))
        .expect_err("open")
        .to_string();
    assert!(told.contains("on layer L\u{F6}cher"), "{told}");
}

#[test]
fn circles_about_the_axis_are_the_bore_and_the_one_around_and_other_contours_there_are_left_out() {
    let axis = [0.0, 0.0];
    // A contour of 40 teeth between the radii 47 and 52.
    let tooth = |i: usize| {
        let angle = std::f64::consts::TAU * i as f64 / 80.0;
        let radius = if i.is_multiple_of(2) { 47.0 } else { 52.0 };
        [(10, radius * angle.cos()), (20, radius * angle.sin())]
    };
    let mut teeth: Vec<(i32, f64)> = (0..80).flat_map(tooth).collect();
    teeth.push((70, 1.0));
    let around = vec![
        entity("LWPOLYLINE", &teeth),
        circle(axis, 12.0),
        circle(axis, 44.0),
        circle(axis, 40.0),
        circle(axis, 16.0),
    ];
    let outline = read(&[around, opening()].concat());
    assert_eq!(outline.loops.len(), 3);
    assert_eq!(outline.loops[0], read(&opening()).loops[0]);
    let bore = json!([{ "arc_to": [-12.0, 0.0], "through": [0.0, -12.0] }, { "arc_to": [12.0, 0.0], "through": [0.0, 12.0] }]);
    let rim = json!([{ "arc_to": [-44.0, 0.0], "through": [0.0, 44.0] }, { "arc_to": [44.0, 0.0], "through": [0.0, -44.0] }]);
    assert_eq!(Value::from(outline.loops[1].clone()), bore);
    assert_eq!(Value::from(outline.loops[2].clone()), rim);
    let told = outline.remarks.join("\n");
    assert!(told.contains("blank/bore_radius_mm is 12."), "{told}");
    assert!(
        told.contains("a circle of 16 mm, a circle of 40 mm, a contour of 47 to 52 mm."),
        "{told}"
    );
    assert!(
        told.contains("Openings on layer A: 1, from the radius 17 mm to 33 mm"),
        "{told}"
    );
    for (odd, expected) in [
        (
            circle(axis, 25.0),
            "with the radii 25 to 25 mm; openings lie on both sides of it or cross it",
        ),
        (
            circle([1.0, 0.0], 12.0),
            "with the radii 11 to 13 mm; a bore is a circle",
        ),
    ] {
        let told = refused(&file(Some(4), &[opening(), vec![odd]].concat()));
        assert!(told.contains(expected), "{told}");
    }
    let told = refused(&file(Some(4), &[circle(axis, 12.0)]));
    assert!(told.contains("none bounds an opening"), "{told}");
    // An opening that does not close is reported beside a bore, too.
    let open = [circle(axis, 12.0), line([20.0, 0.0], [30.0, 0.0])];
    let told = refused(&file(Some(4), &open));
    assert!(told.contains("none bounds an opening"), "{told}");
    assert!(told.contains("nothing goes on within"), "{told}");
}

#[test]
fn what_is_no_drawing_or_too_large_is_refused() {
    let whole = file(Some(4), &opening());
    let cut = whole
        .split("0\nENDSEC\n0\nEOF")
        .next()
        .expect("a beginning");
    let twenty = |count: usize| file(Some(4), &vec![entity("POINT", &[]); count]);
    for (text, expected) in [
        (String::new(), "no section ENTITIES"),
        ("{}".to_owned(), "Line 1 is no group code"),
        (cut.to_owned(), "cut off"),
        (whole[..200].to_owned(), "cut off"),
        ("AutoCAD Binary DXF\r\n\u{1A}".to_owned(), "binary DXF"),
        ("AC1027".to_owned(), "a DWG"),
        (twenty(100_001), "more than 100000 entities"),
        (
            file(Some(4), &vec![circle([30.0, 0.0], 5.0); 10_001]),
            "more than 20000 lines and arcs",
        ),
        (" ".repeat((16 << 20) + 1), "at most 16777216 are read"),
        (file(Some(4), &[]), "no lines and arcs"),
    ] {
        let told = refused(&text);
        assert!(told.contains(expected), "{told}");
    }
    // As many ends at one place as there may be.
    let way = |i: u32| f64::from(i) * 1e-3;
    let star: Vec<String> = (0..20_000)
        .map(|i| line([30.0, 0.0], [30.0 + way(i).cos(), way(i).sin()]))
        .collect();
    assert!(refused(&file(Some(4), &star)).contains("More than two ends meet"));
}

#[test]
fn openings_are_told_by_their_radius_and_then_by_their_angle_however_they_are_drawn() {
    let at = |radius: f64, degrees: f64| {
        let angle = degrees.to_radians();
        circle([radius * angle.cos(), radius * angle.sin()], 2.0)
    };
    let places = [
        (20.0, 0.0),
        (20.0, 90.0),
        (20.0, 180.0),
        (20.0, 270.0),
        (30.0, -1e-12),
        (30.0, 120.0),
        (30.0, 240.0),
    ];
    let mut drawn: Vec<String> = places
        .iter()
        .map(|(radius, degrees)| at(*radius, *degrees))
        .collect();
    let expected: Vec<f64> = places
        .iter()
        .map(|(radius, degrees)| radius * degrees.to_radians().cos())
        .collect();
    for _ in 0..2 {
        let read = read(&drawn);
        let middle = |sides: &Vec<Value>| {
            let ends: f64 = sides
                .iter()
                .filter_map(|side| side["arc_to"][0].as_f64())
                .sum();
            ends / 2.0
        };
        let middles: Vec<f64> = read.loops.iter().map(middle).collect();
        assert!(
            middles
                .iter()
                .zip(&expected)
                .all(|(a, b)| (a - b).abs() < 1e-9),
            "{middles:?}"
        );
        drawn.reverse();
        drawn.swap(1, 4);
    }
}

/// The points of loops, close to each other: between them lies less than a thousandth of a micrometer more than at them.
fn points(sides: &[Value]) -> Vec<[f64; 2]> {
    let at = |value: &Value| [0, 1].map(|i| value[i].as_f64().expect("a coordinate"));
    let end = |side: &Value| at(side.get("line_to").unwrap_or(&side["arc_to"]));
    let mut from = end(sides.last().expect("a side"));
    let mut points = Vec::new();
    for side in sides {
        let to = end(side);
        let through = side.get("through").map(at);
        let side =
            through.and_then(|through| Side::through(from.into(), through.into(), to.into()));
        let side = side.unwrap_or_else(|| Side::new(from.into(), to.into(), 0.0));
        points.extend((0..50).map(|i| {
            let point = side.point(side.length() * f64::from(i) / 50.0);
            [point.x, point.y]
        }));
        from = to;
    }
    points
}

/// The farthest that a point of `sides` is from a curve, by its distance in mm, in um.
fn off(sides: &[Value], distance: impl Fn([f64; 2]) -> f64) -> f64 {
    let distances = points(sides).into_iter().map(|point| distance(point).abs());
    1e3 * distances.fold(0.0, f64::max)
}

/// True if a loop is a whole circle.
fn is_two_arcs(sides: &[Value]) -> bool {
    sides.len() == 2 && sides.iter().all(|side| side.get("arc_to").is_some())
}

const LASER: &str = include_str!("../../../../tests/reference/dxf/laser.dxf");
const OFFICE: &str = include_str!("../../../../tests/reference/dxf/office.dxf");

#[test]
fn a_gear_in_splines_and_ellipses_is_read_within_a_micrometer_and_its_teeth_and_bore_are_known() {
    // Drawn by ezdxf from the numbers that stand here: tests/reference/dxf/make.py.
    let read = taken(LASER, &Choices::default());
    assert_said(&read, "blank/bore_radius_mm is 8.");
    assert_said(&read, "a contour of 43");
    let bore = read.bore_radius_mm.expect("a bore");
    assert!((bore - 8.0).abs() < 2e-3, "{bore}");
    let [kidney, stadium, ellipse, round, bore] = read.loops.as_slice() else {
        panic!("{:?}", read.remarks);
    };
    let from = |x: f64, y: f64| move |[u, v]: [f64; 2]| (u - x).hypot(v - y);
    // The polynomials of degree 3 deviate from their arcs by 2.7e-4 of the radius; the lines and arcs read from them deviate by a micrometer.
    let cubic = |radius: f64| 0.275 * radius;
    let drawn = off(round, |at| from(27.0, 0.0)(at) - 7.0);
    assert!(drawn < 1.0 + cubic(7.0), "{drawn}");
    let ways: [&[Value]; 2] = [round, bore];
    assert!(is_two_arcs(bore), "{bore:?}");
    for (sides, radius) in ways.into_iter().zip([7.0, 8.0]) {
        assert!(sides.len() <= 24, "{} sides of {radius} mm", sides.len());
    }
    // A stadium of lines and exact arcs: one side for each.
    let drawn = off(stadium, |[x, y]| {
        let beside = (x.abs() - 4.0).max(0.0);
        beside.hypot(y + 25.0) - 5.0
    });
    assert!(drawn < 1e-6, "{drawn}");
    assert_eq!(stadium.len(), 4, "{stadium:?}");
    let drawn = off(kidney, |at| {
        let radius = at[0].hypot(at[1]);
        let angle = at[1].atan2(at[0]).to_degrees();
        let end = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            from(25.0 * cos, 25.0 * sin)(at)
        };
        if angle < 60.0 {
            end(60.0) - 5.0
        } else if angle > 100.0 {
            end(100.0) - 5.0
        } else {
            (radius - 25.0).abs() - 5.0
        }
    });
    assert!(drawn < 1.0 + cubic(5.0), "{drawn}");
    // The distance from an ellipse is at most the residual of its equation over the slope of that.
    let drawn = off(ellipse, |[x, y]| {
        let (u, v) = ((x + 26.0) / 9.0, y / 4.5);
        let slope = 2.0 * (u / 9.0).hypot(v / 4.5);
        (u * u + v * v - 1.0) / slope
    });
    assert!(drawn < 1.0, "{drawn}");
    assert!(ellipse.len() <= 40, "{} sides", ellipse.len());
}

#[test]
fn a_spline_is_what_its_equation_says() {
    // A cubic whose curve is y = x^3/100 from x = -5 to 5 by its control points, with a knot put in at 0: the same curve.
    let cubic =
        |groups: &[(i32, f64)]| entity("SPLINE", &[&[(70, 8.0), (71, 3.0)], groups].concat());
    let at = |x: f64, y: f64| [(10, x + 30.0), (20, y), (30, 0.0)];
    // The blossom of x^3/100 at (a, b, c) is a b c/100, that of x its mean: Boehm's control points.
    let blossom = |[a, b, c]: [f64; 3]| at((a + b + c) / 3.0, a * b * c / 100.0);
    let knots = [-5.0, -5.0, -5.0, -5.0, 0.0, 5.0, 5.0, 5.0, 5.0];
    let mut groups: Vec<(i32, f64)> = knots.iter().map(|knot| (40, *knot)).collect();
    for i in 0..5 {
        groups.extend(blossom([knots[i + 1], knots[i + 2], knots[i + 3]]));
    }
    let closing = [
        line([25.0, -1.25], [25.0, -6.0]),
        line([25.0, -6.0], [35.0, -6.0]),
        line([35.0, -6.0], [35.0, 1.25]),
    ];
    let weighted = |weights: [f64; 5]| {
        let groups = [groups.as_slice(), &weights.map(|weight| (41, weight))].concat();
        [vec![cubic(&groups)], closing.to_vec()].concat()
    };
    let read = read(&[vec![cubic(&groups)], closing.to_vec()].concat());
    // Only the ratios of its weights count: Autodesk Inventor writes −1 for each point (netDxf, issue 122).
    assert_eq!(self::read(&weighted([-1.0; 5])).loops, read.loops);
    let told = refused(&file(Some(4), &weighted([1.0, 1.0, -1.0, 1.0, 1.0])));
    assert!(told.contains("weights of both signs"), "{told}");
    let curved: Vec<Value> = read.loops[0].clone();
    let farthest = points(&curved)
        .into_iter()
        .filter(|[x, y]| *y > -5.9 && (25.001..34.999).contains(x))
        .map(|[x, y]| {
            let x = x - 30.0;
            let slope = 3.0 * x * x / 100.0;
            ((y - x.powi(3) / 100.0) / slope.hypot(1.0)).abs()
        })
        .fold(0.0, f64::max);
    assert!(farthest < 1e-3, "{farthest}");
    // A fillet of the spline is where it has a knot three times over.
    let corner = [-5.0, -5.0, -5.0, -5.0, 0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 5.0];
    let mut groups: Vec<(i32, f64)> = corner.iter().map(|knot| (40, *knot)).collect();
    for (x, y) in [
        (-5.0, -1.25),
        (-3.0, 0.0),
        (-2.0, 1.0),
        (0.0, 3.0),
        (2.0, 1.0),
        (3.0, 1.0),
        (5.0, 1.25),
    ] {
        groups.extend(at(x, y));
    }
    let read = self::read(&[vec![cubic(&groups)], closing.to_vec()].concat());
    let has_corner = read.loops[0].iter().any(|side| {
        let end = side.get("line_to").unwrap_or(&side["arc_to"]);
        end == &json!([30.0, 3.0])
    });
    assert!(has_corner, "{:?}", read.loops);
}

#[test]
fn points_that_a_curve_goes_through_are_enough_for_teeth_and_not_for_an_opening() {
    let through = |radius: f64, center: f64| {
        let ways = (0..60).map(|i| f64::from(i) * 6.0_f64.to_radians());
        let groups = ways.flat_map(|way| {
            [
                (11, center + radius * way.cos()),
                (21, radius * way.sin()),
                (31, 0.0),
            ]
        });
        let head = [(70, 9.0), (71, 3.0)];
        entity(
            "SPLINE",
            &head.into_iter().chain(groups).collect::<Vec<_>>(),
        )
    };
    let read = read(&[opening(), vec![through(50.0, 0.0)]].concat());
    assert_eq!(loops(&read), loops(&self::read(&opening())));
    assert_said(&read, "a contour of 49.9");
    let told = refused(&file(
        Some(4),
        &[opening(), vec![through(4.0, -25.0)]].concat(),
    ));
    assert!(told.contains("points that it goes through"), "{told}");
    // The same of a polyline that stands for a spline: the frame is not read with it.
    let vertex = |flags: f64, x: f64, y: f64| entity("VERTEX", &[(70, flags), (10, x), (20, y)]);
    let square = [[-30.0, -3.0], [-20.0, -3.0], [-20.0, 3.0], [-30.0, 3.0]];
    let mut splined = vec![
        entity("POLYLINE", &[(66, 1.0), (70, 5.0)]),
        vertex(16.0, 99.0, 99.0),
    ];
    splined.extend(square.map(|[x, y]| vertex(8.0, x, y)));
    let told = refused(&file(Some(4), &[opening(), splined].concat()));
    assert!(
        told.contains("POLYLINE on layer A") && told.contains("goes through"),
        "{told}"
    );
}

#[test]
fn blocks_stand_where_they_are_put_turned_mirrored_and_in_rows_and_at_no_other_scale() {
    let keyed = Choices {
        center: Some([150.0, 105.0]),
        bore_radius_mm: Some(11.0),
        ..Choices::default()
    };
    let read = taken(OFFICE, &keyed);
    // Eight holes of 4 mm at 34 mm, six slots of 8 by 4 mm across the radius at 20 mm, and the rim.
    assert_eq!(read.loops.len(), 15, "{:?}", read.remarks);
    let mut centers = Vec::new();
    for sides in &read.loops[..14] {
        let points = points(sides);
        let count = points.len() as f64;
        let [x, y] = [0, 1].map(|i| points.iter().map(|point| point[i]).sum::<f64>() / count);
        centers.push((x.hypot(y), y.atan2(x).to_degrees().rem_euclid(360.0)));
    }
    for (i, (radius, angle)) in centers.iter().enumerate() {
        let expected = match i {
            0..6 => (20.0, 60.0 * i as f64),
            _ => (34.0, 45.0 * (i - 6) as f64),
        };
        let turned = (angle - expected.1 + 180.0).rem_euclid(360.0) - 180.0;
        assert!(
            (radius - expected.0).abs() < 1e-9 && turned.abs() < 1e-6,
            "{i}: {radius} {angle}"
        );
    }
    let drawn = off(&read.loops[0], |[x, y]| {
        (x - 20.0).hypot((y.abs() - 2.0).max(0.0)) - 2.0
    });
    assert!(drawn < 1e-6, "{drawn}");
    for words in [
        "(150, 105) is taken for the axis",
        "Drawn twice and taken once: 1 CIRCLE.",
        "10 LINE on layer CENTER",
        "a bore of 11 to 13",
        "As chosen, blank/bore_radius_mm is 11.",
        "a circle of 34 mm",
    ] {
        assert_said(&read, words);
    }
    assert_eq!(read.bore_radius_mm, Some(11.0));
    let told = refused_with(
        OFFICE,
        &Choices {
            bore_radius_mm: None,
            ..keyed.clone()
        },
    );
    assert!(
        told.contains("a bore is a circle") && told.contains("--bore-radius"),
        "{told}"
    );
    let told = refused_with(
        OFFICE,
        &Choices {
            bore_radius_mm: Some(19.0),
            ..keyed.clone()
        },
    );
    assert!(
        told.contains("reaches the openings, which begin at 18 mm"),
        "{told}"
    );
    let told = refused_with(
        OFFICE,
        &Choices {
            center: None,
            ..keyed.clone()
        },
    );
    assert!(
        told.contains("seems to turn about (150, 105)") && told.contains("--center 150,105"),
        "{told}"
    );

    let insert = |groups: &[(i32, f64)]| {
        format!(
            "0\nINSERT\n8\nA\n2\nSlot\n{}",
            entity("", groups).split_once("8\nA\n").expect("groups").1
        )
    };
    let blocks = |entities: &str, inserts: &[String]| {
        file(Some(4), inserts).replace(
            "2\nBLOCKS\n",
            &format!("2\nBLOCKS\n0\nBLOCK\n8\n0\n2\nSLOT\n70\n0\n10\n0\n20\n0\n{entities}0\nENDBLK\n8\n0\n"),
        )
    };
    let slot = opening().concat();
    // Mirrored about the y axis, a plane that is seen from below, and half a turn are the same for a slot that is alike on both sides.
    let mirrored = json!(points(&read_one(&blocks(&slot, &[insert(&[(41, -1.0)])]))));
    let below = json!(points(&read_one(&blocks(&slot, &[insert(&[(230, -1.0)])]))));
    assert_eq!(mirrored, below);
    let area = |points: &Value| {
        let at = |i: usize, k: usize| points[i][k].as_f64().expect("a coordinate");
        let count = points.as_array().expect("points").len();
        (0..count)
            .map(|i| {
                let j = (i + 1) % count;
                0.5 * (at(i, 0) * at(j, 1) - at(j, 0) * at(i, 1))
            })
            .sum::<f64>()
    };
    let left = mirrored[0][0].as_f64().expect("a coordinate");
    assert!(left < 0.0 && area(&mirrored) < 0.0, "{mirrored}");
    // Two columns and three rows.
    let row = insert(&[(70, 2.0), (71, 3.0), (44, 20.0), (45, 8.0), (50, 90.0)]);
    assert_eq!(
        taken(&blocks(&slot, &[row]), &Choices::default())
            .loops
            .len(),
        6
    );
    let told = refused(&blocks(&slot, &[insert(&[(41, 2.0), (42, 2.0)])]));
    assert!(
        told.contains("stands for the block Slot at the scale 2, 2") && told.contains("explode it"),
        "{told}"
    );
    let itself = insert(&[]);
    let told = refused(&blocks(&itself, &[insert(&[])]));
    assert!(told.contains("more than 16 deep"), "{told}");
    let doubled = itself.repeat(2);
    let told = refused(&blocks(&doubled, &[insert(&[])]));
    assert!(
        told.contains("more than 16 deep") || told.contains("more than 100000 entities"),
        "{told}"
    );
    let nothing = insert(&[(70, 60_000.0), (71, 60_000.0)]);
    let told = refused(&blocks("", &[nothing]));
    assert!(told.contains("more than 100000 entities"), "{told}");
    let elsewhere =
        blocks(&slot, &[insert(&[])]).replace("70\n0\n10\n0\n", "70\n4\n1\nholes.dwg\n10\n0\n");
    let told = refused(&elsewhere);
    assert!(told.contains("in another file, holes.dwg"), "{told}");
}

/// The sides of the one loop of a drawing.
fn read_one(text: &str) -> Vec<Value> {
    let read = taken(text, &Choices::default());
    assert_eq!(read.loops.len(), 1, "{:?}", read.remarks);
    read.loops[0].clone()
}

#[test]
fn ends_are_joined_within_the_tolerance_and_three_within_it_are_refused() {
    let gap = |gap: f64| {
        let mut pieces = opening();
        pieces[2] = line([20.0, -3.0], [30.0 - gap, -3.0]);
        file(Some(4), &pieces)
    };
    let within = |tolerance_mm: f64| Choices {
        tolerance_mm,
        ..Choices::default()
    };
    let read = taken(&gap(0.009), &Choices::default());
    assert_said(
        &read,
        "Joined: 1 pairs of ends that are up to 0.009 mm apart.",
    );
    assert_eq!(read.loops[0].len(), 4);
    assert!(refused(&gap(0.011)).contains("nothing goes on within 0.01 mm"));
    assert_eq!(taken(&gap(0.099), &within(0.1)).loops.len(), 1);
    assert!(refused_with(&gap(0.0005), &within(0.0)).contains("nothing goes on within 0 mm"));
    let exact = taken(&gap(0.0), &within(0.0));
    assert!(
        !exact.remarks.concat().contains("Joined"),
        "{:?}",
        exact.remarks
    );
    for tolerance in [-0.01, 0.11, f64::NAN] {
        let told = refused_with(&gap(0.0), &within(tolerance));
        assert!(told.contains("0 to 0.1 mm are taken"), "{told}");
    }
    // A third end near two that meet, and three that do not quite.
    let third = |at: [f64; 2], gap: f64| {
        let mut pieces = opening();
        pieces[2] = line([20.0, -3.0], [30.0 - gap, -3.0]);
        pieces.push(line(at, [50.0, -10.0]));
        refused(&file(Some(4), &pieces))
    };
    for told in [third([30.0, -3.005], 0.0), third([30.002, -3.004], 0.004)] {
        assert!(
            told.contains("More than two ends meet at (") && told.contains("within 0.01 mm"),
            "{told}"
        );
    }
    // Sides that are shorter than the tolerance follow each other all the same.
    let fine: Vec<(i32, f64)> = (0..3000)
        .flat_map(|i| {
            let way = f64::from(i) * std::f64::consts::TAU / 3000.0;
            [(10, 30.0 + 3.0 * way.cos()), (20, 3.0 * way.sin())]
        })
        .collect();
    let polyline = entity("LWPOLYLINE", &[&[(70, 1.0)], &*fine].concat());
    assert_eq!(read_one(&file(Some(4), &[polyline])).len(), 3000);
}

#[test]
fn what_is_drawn_twice_is_taken_once_whichever_way_and_in_other_pieces() {
    let back = [
        line([30.0, 3.0], [20.0, 3.0]),
        arc([20.0, 0.0], 3.0, [90.0, 270.0]),
    ];
    let read = read(&[opening(), back.to_vec()].concat());
    assert_eq!(loops(&read), loops(&self::read(&opening())));
    assert_said(&read, "Drawn twice and taken once: 1 ARC, 1 LINE.");
    let halves = [[10.0, 130.0], [130.0, 370.0]].map(|angles| arc([30.0, 0.0], 5.0, angles));
    let read = self::read(&[vec![circle([30.0, 0.0], 5.0)], halves.to_vec()].concat());
    assert_eq!(read.loops.len(), 1);
    assert_said(&read, "Drawn twice and taken once: 2 ARC.");
}

#[test]
fn an_island_and_what_stands_in_an_opening_is_refused_as_one_loop_inside_another() {
    let island = circle([25.0, 0.0], 1.0);
    let told = refused(&file(Some(4), &[opening(), vec![island]].concat()));
    assert!(
        told.contains("CIRCLE on layer A, line 88 begins one loop inside another, that of LINE on layer A, line 28"),
        "{told}"
    );
}

#[test]
fn center_lines_on_a_layer_of_their_own_stop_nothing_and_others_do() {
    let on = |layer: &str, entity: &str| entity.replace("8\nA\n", &format!("8\n{layer}\n"));
    let lines = [
        on("Mitte", &line([-60.0, 0.0], [60.0, 0.0])),
        on("Mitte", &line([25.0, -5.0], [25.0, 5.0])),
        on("Mitte", &arc([0.0, 0.0], 25.0, [-20.0, 20.0])),
        on("Mitte", &circle([0.0, 0.0], 25.0)),
    ];
    let read = read(&[opening(), lines.to_vec()].concat());
    assert_eq!(loops(&read), loops(&self::read(&opening())));
    assert_said(&read, "1 ARC on layer Mitte, 2 LINE on layer Mitte");
    assert_said(&read, "a circle of 25 mm");
    for (other, words) in [
        (
            line([-60.0, 0.0], [60.0, 0.0]),
            "LINE on layer A, line 88 ends at (-60, 0)",
        ),
        (
            circle([0.0, 0.0], 25.0),
            "openings lie on both sides of it or cross it",
        ),
    ] {
        let told = refused(&file(Some(4), &[opening(), vec![other]].concat()));
        assert!(told.contains(words), "{told}");
    }
}

#[test]
fn a_drawing_that_turns_about_another_point_is_refused_with_that_point() {
    let around = |at: [f64; 2], count: u32, radius: f64| -> Vec<String> {
        let ways = (0..count).map(|i| f64::from(i) * std::f64::consts::TAU / f64::from(count));
        ways.map(|way| {
            circle(
                [at[0] + radius * way.cos(), at[1] + radius * way.sin()],
                3.0,
            )
        })
        .collect()
    };
    let teeth = |at: [f64; 2]| {
        let corner = |i: u32| {
            let way = f64::from(i) * std::f64::consts::TAU / 80.0;
            let radius = if i.is_multiple_of(2) { 47.0 } else { 52.0 };
            [
                (10, at[0] + radius * way.cos()),
                (20, at[1] + radius * way.sin()),
            ]
        };
        let corners: Vec<(i32, f64)> = (0..80).flat_map(corner).collect();
        entity("LWPOLYLINE", &[&[(70, 1.0)], &*corners].concat())
    };
    let frame = entity(
        "LWPOLYLINE",
        &[
            (70, 1.0),
            (10, -60.0),
            (20, -70.0),
            (10, 360.0),
            (20, -70.0),
            (10, 360.0),
            (20, 227.0),
            (10, -60.0),
            (20, 227.0),
        ],
    );
    let far = [150.0, 105.0];
    let uneven = || vec![circle([180.0, 105.0], 3.0), circle([140.0, 120.0], 4.0)];
    for drawn in [
        // Rim, bore and holes; teeth and holes that are nowhere alike; holes alone; all in a frame.
        [
            around(far, 7, 30.0),
            vec![circle(far, 47.0), circle(far, 8.0)],
        ]
        .concat(),
        [uneven(), vec![teeth(far)]].concat(),
        [uneven(), vec![teeth(far), frame.clone()]].concat(),
        around(far, 5, 30.0),
        [around(far, 7, 30.0), vec![circle(far, 47.0), frame.clone()]].concat(),
    ] {
        let text = file(Some(4), &drawn);
        let told = refused(&text);
        assert!(
            told.contains("does not turn about the origin: it seems to turn about (150, 105)")
                && told.contains("--center 150,105"),
            "{told}"
        );
        let about = Choices {
            center: Some(far),
            ..Choices::default()
        };
        assert!(!taken(&text, &about).loops.is_empty());
        let beside = Choices {
            center: Some([150.0, 100.0]),
            ..Choices::default()
        };
        assert!(
            refused_with(&text, &beside)
                .contains("about the chosen center: it seems to turn about (150, 105)")
        );
    }
    // Wherever it is, a circle about the axis runs around it: its center is on the chord of both its halves.
    for i in 0..50 {
        let at = [7.3 * f64::from(i), 90.0 - 11.7 * f64::from(i)];
        let drawn = [
            around(at, 6, 34.0),
            vec![circle(at, 47.0), circle(at, 16.0)],
        ]
        .concat();
        let about = Choices {
            center: Some(at),
            ..Choices::default()
        };
        let read = taken(&file(Some(4), &drawn), &about);
        assert_eq!(read.loops.len(), 8, "{at:?}: {:?}", read.remarks);
        let bore = read.bore_radius_mm.expect("a bore");
        assert!((bore - 16.0).abs() < 1e-8, "{bore}");
    }
    // A little beside it, and in inches.
    let near = [0.05, -0.02];
    let drawn = [
        around(near, 7, 30.0),
        vec![circle(near, 47.0), circle(near, 8.0)],
    ]
    .concat();
    let told = refused(&file(Some(4), &drawn));
    assert!(told.contains("--center 0.05,-0.02"), "{told}");
    let inches = [
        around(near, 7, 1.0)
            .concat()
            .replace("40\n3\n", "40\n0.1\n"),
        circle(near, 2.0),
    ];
    let told = refused(&file(Some(1), &inches));
    assert!(told.contains("--center 0.05,-0.02"), "{told}");
    // About the origin: as they are, in a frame, with holes nowhere alike, and one opening alone.
    let origin = [0.0, 0.0];
    for drawn in [
        [
            around(origin, 7, 30.0),
            vec![circle(origin, 47.0), circle(origin, 8.0), frame.clone()],
        ]
        .concat(),
        [vec![
            circle([30.0, 0.0], 3.0),
            circle([-10.0, 15.0], 4.0),
            teeth(origin),
            frame,
        ]]
        .concat(),
        around(origin, 5, 30.0),
        opening(),
    ] {
        assert!(!read(&drawn).loops.is_empty());
    }
}
