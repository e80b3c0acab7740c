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
    let text = file(Some(4), entities);
    outline(text.as_bytes(), &[]).unwrap_or_else(|refused| panic!("{refused}"))
}

/// The sentence with which it is refused.
fn refused(text: &str) -> String {
    outline(text.as_bytes(), &[])
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
    let read =
        |unit| outline(file(unit, &[circle([2.0, 0.0], 0.5)]).as_bytes(), &[]).expect("a drawing");
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
        "LINE on layer A, line {line_at} ends at (29.95, -3), and nothing goes on within 0.001 mm: the nearest open end, of ARC on layer A, line {arc_at}, is 0.05 mm off"
    );
    assert!(told.contains(&expected), "{told}\n{expected}");
    // Within the tolerance it is closed, and the next side begins where the last one ends.
    pieces[2] = line([20.0, -3.0], [29.9995, -3.0]);
    let closed = read(&pieces);
    assert_eq!(closed.loops[0].len(), 4);
    let branch = [opening(), vec![line([20.0, 3.0], [25.0, 0.0])]].concat();
    let told = refused(&file(Some(4), &branch));
    assert!(
        told.contains("More than two ends meet at (20, 3): of LINE on layer A, line 28; ARC on"),
        "{told}"
    );
    let twice = [
        line([20.0, 3.0], [30.0, 3.0]),
        line([20.0, 3.0], [30.0, 3.0]),
    ];
    let told = refused(&file(Some(4), &twice));
    assert!(told.contains("encloses nothing"), "{told}");
}

#[test]
fn what_may_change_the_outline_and_is_not_read_is_refused_by_its_name() {
    #[rustfmt::skip]
    let cases = [
        ("SPLINE", vec![(70, 8.0)], "SPLINE on layer A, line 88 is not read"),
        ("ELLIPSE", vec![], "ELLIPSE on layer A, line 88 is not read"),
        ("SURVEYED_CURVE", vec![], "SURVEYED_CURVE on layer A"),
        ("INSERT", vec![(2, 7.0)], "INSERT on layer A, line 88 stands for the block 7: explode it"),
        ("POLYLINE", vec![(70, 4.0)], "is a spline or a surface"),
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
            let read = outline(on_paper.as_bytes(), &[]).expect("left out");
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

#[test]
fn a_layer_is_chosen_by_its_name_whatever_its_case() {
    let other = line([0.0, 0.0], [100.0, 0.0]).replace("8\nA\n", "8\nMitte\n");
    let text = file(Some(4), &[opening(), vec![other]].concat());
    assert!(refused(&text).contains("LINE on layer Mitte"));
    let on = |layers: &[&str]| {
        let layers: Vec<String> = layers.iter().map(|layer| (*layer).to_owned()).collect();
        outline(text.as_bytes(), &layers)
    };
    assert_eq!(on(&["a"]).expect("closed").loops.len(), 1);
    assert!(on(&["A", "MITTE"]).is_err());
    let told = on(&["Holes"]).expect_err("no such layer").to_string();
    assert!(
        told.contains("no lines and arcs on layer Holes; there is something on: A, Mitte."),
        "{told}"
    );
    // Names of layers as older files have them.
    let latin: Vec<u8> = text
        .replace("Mitte", "L\u{F6}cher")
        .chars()
        .map(|c| c as u8)
        .collect();
    let told = outline(&latin, &["L\u{F6}cher".to_owned()])
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
    let star = vec![line([30.0, 0.0], [31.0, 0.0]); 20_000];
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
