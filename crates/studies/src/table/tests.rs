//! The table, and the choice of the best designs.

use meshwright_wire::Code;
use meshwright_wire::results::Results;
use serde_json::{Map, json};

use super::*;
use crate::testing::{STUB, and};

/// A results document with two torques, of which the second has no spectrum.
fn document(mass: f64, ranges: [f64; 2], stiffness: f64) -> Value {
    let mut document: Value = serde_json::from_str(STUB).expect("JSON");
    let pair = &mut document["pair"];
    for (gear, mass, removed, inertia) in
        [("driving", 1.0, 0.0, 1e-3), ("driven", mass, 25.0, 9e-4)]
    {
        pair[gear]["mass_kg"] = json!(mass);
        pair[gear]["mass_removed_percent"] = json!(removed);
        pair[gear]["polar_inertia_kg_m2"] = json!(inertia);
    }
    pair["driven"]["least_ligament_mm"] = json!(5.5);
    let of_stub = document["curves"][0].clone();
    let curve = |torque: f64, range: f64| {
        let mut curve = of_stub.clone();
        curve["output_torque_n_m"] = json!(torque);
        curve["statistics"] = json!({
            "partial": false,
            "transmission_error_um": { "mean": 13.79, "rms": 0.38, "peak_to_peak": range },
            "mesh_stiffness_tangent_n_per_m": { "mean": stiffness, "rms": 2.4e7, "peak_to_peak": 6.8e7 },
        });
        curve["spectrum"] = Value::Null;
        curve
    };
    let mut curves = [curve(115.0, ranges[0]), curve(20.0, ranges[1])];
    let line = |order: f64, label: &str, kind: &str, amplitude: f64| json!({ "order": order, "label": label, "kind": kind, "gears": ["driven"], "transmission_error_um": amplitude, "mesh_stiffness_tangent_n_per_m": 0.0 });
    curves[0]["spectrum"] = json!({
        "order": [], "driving_order": [], "transmission_error_um": [], "transmission_error_phase_deg": [],
        "mesh_stiffness_tangent_n_per_m": [], "mesh_stiffness_tangent_phase_deg": [],
        "named": [
            line(10.0, "H_N", "holes", 0.31), line(50.0, "H_Z2", "mesh", 0.42), line(60.0, "H_Z2+N", "hole_sideband", 0.01),
        ],
    });
    document["curves"] = json!(curves);
    let warning =
        |code: &str, gear: &str| json!({ "code": code, "detail": "About it.", "gear": gear });
    document["warnings"] = json!([
        warning("thin_ligament", "driving"),
        warning("few_positions", "driven"),
        warning("thin_ligament", "driven"),
    ]);
    document
}

fn summary(document: &Value) -> Summary {
    let results = Results::read(&document.to_string()).expect("a results document");
    Summary::of(&results).expect("finite")
}

fn state(label: &str, mass: f64, ranges: [f64; 2], stiffness: f64) -> RowState {
    let changes = json!({ "/pair/driven/blank/holes/count": 10, "/method": "flexible" });
    RowState {
        label: label.to_owned(),
        changes: changes.as_object().unwrap().clone(),
        job: Some(Uuid::nil()),
        status: Status::Successful,
        summary: Some(summary(&document(mass, ranges, stiffness))),
        problem: None,
    }
}

/// The cells of a column, line by line.
fn column(text: &str, name: &str) -> Vec<String> {
    let mut read = ::csv::Reader::from_reader(text.as_bytes());
    let names = read.headers().expect("names").clone();
    let place = names.iter().position(|known| known == name).expect(name);
    let cells = read
        .records()
        .map(|line| line.expect("a line")[place].to_owned());
    cells.collect()
}

fn failed(label: &str) -> RowState {
    RowState {
        label: label.to_owned(),
        changes: Map::new(),
        job: None,
        status: Status::Failed,
        summary: None,
        problem: Some(json!({ "code": "holes_overlap", "detail": "Too many, \"far\" too many." })),
    }
}

#[test]
fn a_summary_keeps_what_the_table_shows_and_survives_the_store() {
    let mut document = document(0.9, [1.7, 2.5], 2.2e8);
    document["curves"][0]["output_torque_n_m"] = json!(115.000_000_000_049);
    let summary = summary(&document);
    let stored = summary.to_json();
    assert!(!stored.contains("mesh_position"), "no curve: {stored}");
    assert!(
        stored.contains("115.0,"),
        "rounded as documents are: {stored}"
    );
    assert_eq!(serde_json::from_str::<Summary>(&stored).unwrap(), summary);
    // Summaries of an earlier version may have none of it.
    assert_eq!(
        serde_json::from_str::<Summary>("{}").unwrap(),
        Summary::default()
    );

    let mut results = Results::read(&document.to_string()).unwrap();
    results.curves[1]
        .statistics
        .transmission_error_um
        .whole
        .mean = f64::NAN;
    assert_eq!(Summary::of(&results).unwrap_err().code, Code::InternalError);
}

#[test]
fn a_row_has_the_names_of_the_contract() {
    let rows = table(
        GearName::Driven,
        vec![state("10R34", 0.9, [1.7, 2.5], 2.2e8)],
    );
    let row = serde_json::to_value(&rows[0]).unwrap();
    for (pointer, value) in [
        ("/label", json!("10R34")),
        ("/status", json!("successful")),
        ("/mass_kg", json!(0.9)),
        ("/mass_removed_percent", json!(25.0)),
        ("/least_ligament_mm", json!(5.5)),
        ("/pareto", json!(true)),
        ("/curves/0/output_torque_n_m", json!(115.0)),
        (
            "/curves/0/statistics/transmission_error_um/peak_to_peak",
            json!(1.7),
        ),
        (
            "/curves/0/statistics/mesh_stiffness_tangent_n_per_m/mean",
            json!(2.2e8),
        ),
        ("/curves/0/hole_order_um", json!(0.31)),
        ("/curves/0/mesh_order_um", json!(0.42)),
        ("/curves/1/hole_order_um", Value::Null),
        ("/problem", Value::Null),
    ] {
        assert_eq!(row.pointer(pointer), Some(&value), "{pointer}");
    }
    let driving = table(GearName::Driving, vec![state("x", 0.9, [1.7, 2.5], 2.2e8)]);
    assert_eq!(
        (driving[0].mass_kg, driving[0].least_ligament_mm),
        (Some(1.0), None)
    );
}

#[test]
fn a_design_is_on_the_front_unless_another_is_as_good_in_all_and_better_in_one() {
    let mut other_method = state("another method", 2.0, [9.0, 9.0], 1e8);
    let summary = other_method.summary.as_mut().unwrap();
    summary.method = Some("decomposition".to_owned());
    let states = vec![
        state("reference", 1.0, [1.0, 2.5], 2.0e8),
        state("lighter", 0.9, [1.0, 2.6], 1.9e8),
        state("worse in all", 1.1, [1.0, 2.7], 1.8e8),
        state("same worst torque", 1.0, [2.4, 2.5], 2.0e8),
        state("softer", 1.0, [1.0, 2.5], 1.9e8),
        state("quieter and heavier", 1.2, [1.0, 2.0], 1.5e8),
        failed("impossible"),
        other_method,
    ];
    let front: Vec<bool> = table(GearName::Driven, states)
        .iter()
        .map(|row| row.pareto)
        .collect();
    assert_eq!(front, [true, true, false, true, false, true, false, true]);
}

#[test]
fn the_front_of_thousands_is_that_of_the_definition() {
    // A pseudorandom cloud, against the comparison of each with each.
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((seed >> 33) % 20) as f64
    };
    let states: Vec<RowState> = (0..400)
        .map(|i| state(&i.to_string(), random(), [random(), 0.0], random()))
        .collect();
    let values: Vec<[f64; 3]> = states
        .iter()
        .map(|state| state.summary.as_ref().unwrap().objectives().unwrap())
        .collect();
    let by_definition = |own: &[f64; 3]| {
        !values
            .iter()
            .any(|other| other != own && other.iter().zip(own).all(|(a, b)| a <= b))
    };
    let expected: Vec<bool> = values.iter().map(by_definition).collect();
    let front: Vec<bool> = table(GearName::Driven, states)
        .iter()
        .map(|row| row.pareto)
        .collect();
    assert_eq!(front, expected);
}

#[test]
fn the_csv_has_a_line_for_each_row_and_torque_and_names_joined_by_dots() {
    let rows = table(
        GearName::Driven,
        vec![state("10R34", 0.9, [1.7, 2.5], 2.2e8), failed("a, \"b\"")],
    );
    let text = csv(&rows);
    let lines: Vec<&str> = text.split("\r\n").collect();
    assert_eq!(
        lines,
        [
            "label,changes./pair/driven/blank/holes/count,changes./method,job,status,method,mass_kg,mass_removed_percent,\
             least_ligament_mm,polar_inertia_kg_m2,pair_mass_kg,contact_ratio,backlash_mm,pareto,output_torque_n_m,\
             statistics.transmission_error_um.mean,statistics.transmission_error_um.rms,\
             statistics.transmission_error_um.peak_to_peak,statistics.mesh_stiffness_tangent_n_per_m.mean,\
             statistics.mesh_stiffness_tangent_n_per_m.rms,statistics.mesh_stiffness_tangent_n_per_m.peak_to_peak,\
             hole_order_um,mesh_order_um,mesh_order_1_um,problem.code,problem.detail,warnings",
            "10R34,10,flexible,00000000-0000-0000-0000-000000000000,successful,flexible,0.9,25.0,5.5,0.0009,1.9,1.61,0.34,true,\
             115.0,13.79,0.38,1.7,220000000.0,24000000.0,68000000.0,0.31,0.42,0.42,,,thin_ligament few_positions",
            "10R34,10,flexible,00000000-0000-0000-0000-000000000000,successful,flexible,0.9,25.0,5.5,0.0009,1.9,1.61,0.34,true,\
             20.0,13.79,0.38,2.5,220000000.0,24000000.0,68000000.0,,,,,,thin_ligament few_positions",
            "\"a, \"\"b\"\"\",,,,failed,,,,,,,,,false,,,,,,,,,,,holes_overlap,\"Too many, \"\"far\"\" too many.\",",
            "",
        ]
    );
}

#[test]
fn the_csv_has_columns_for_stresses_where_any_row_tells_them() {
    let mut document = document(0.9, [1.7, 2.5], 2.2e8);
    document["curves"][0]["statistics"]["stress"] = json!({ "driving": { "root_mpa": 151.0 }, "driven": { "root_mpa": 157.5, "root_tension_mpa": 160.0, "root_compression_mpa": -181.0, "hole_mpa": 38.9 } });
    let mut stressed = state("stressed", 0.9, [1.7, 2.5], 2.2e8);
    stressed.summary = Some(summary(&document));
    let rows = table(
        GearName::Driven,
        vec![stressed, state("plain", 0.9, [1.7, 2.5], 2.2e8)],
    );
    let text = csv(&rows);
    let cell = |line: usize, name: &str| column(&text, name)[line].clone();
    for (name, value) in [
        ("statistics.stress.driving.root_mpa", "151.0"),
        ("statistics.stress.driving.root_tension_mpa", ""),
        ("statistics.stress.driving.hole_mpa", ""),
        ("statistics.stress.driven.root_mpa", "157.5"),
        ("statistics.stress.driven.root_tension_mpa", "160.0"),
        ("statistics.stress.driven.root_compression_mpa", "-181.0"),
        ("statistics.stress.driven.hole_mpa", "38.9"),
        ("hole_order_um", "0.31"),
    ] {
        assert_eq!(cell(0, name), value, "{name}");
    }
    assert_eq!(cell(2, "statistics.stress.driven.hole_mpa"), "");
    assert_eq!(cell(2, "hole_order_um"), "0.31");
}

#[test]
fn the_load_along_the_face_is_told_by_those_who_see_it() {
    let mut document = document(0.9, [1.7, 2.5], 2.2e8);
    document["curves"][0]["face"] = json!({ "face_load_factor": 1.69, "z_mm": [0.0], "load_n_per_mm": [[0.0]], "load_centroid_mm": [0.0] });
    let mut helical = state("helical", 0.9, [1.7, 2.5], 2.2e8);
    helical.summary = Some(summary(&document));
    let told = |state: &RowState, curve: usize| {
        let quantity = QUANTITIES
            .iter()
            .find(|quantity| quantity.name == "face_load_factor");
        let Of::Curve(of) = quantity.expect("it has a name").of else {
            panic!("it depends on the torque")
        };
        let summary = state.summary.as_ref().expect("computed");
        of(&summary.curves()[curve], GearName::Driven)
    };
    let plain = state("plain", 0.9, [1.7, 2.5], 2.2e8);
    assert_eq!(
        [told(&helical, 0), told(&helical, 1), told(&plain, 0)],
        [Some(1.69), None, None]
    );
    // It is stored with the row.
    let kept = serde_json::to_string(&helical.summary).expect("JSON");
    helical.summary = serde_json::from_str(&kept).expect("the same");
    assert_eq!(told(&helical, 0), Some(1.69));

    let rows = table(GearName::Driven, vec![helical, plain.clone()]);
    let text = csv(&rows);
    assert!(text.contains(",face_load_factor,hole_order_um,"), "{text}");
    assert_eq!(column(&text, "face_load_factor"), ["1.69", "", "", ""]);
    let json = serde_json::to_value(&rows).expect("JSON");
    assert_eq!(json[0]["curves"][0]["face_load_factor"], 1.69);
    assert!(json[1]["curves"][0].get("face_load_factor").is_none());
    let plane = csv(&table(GearName::Driven, vec![plain]));
    assert!(!plane.contains("face_load_factor"));
}

#[test]
fn what_holes_alone_make_stands_beside_their_order_where_teeth_deviate() {
    let mut document = document(0.9, [1.7, 2.5], 2.2e8);
    document["curves"][0]["spectrum"]["named"][0]["transmission_error_of_holes_um"] = json!(0.12);
    let mut deviating = state("deviating", 0.9, [1.7, 2.5], 2.2e8);
    deviating.summary = Some(summary(&document));
    // It is stored with the row.
    let kept = deviating.summary.as_ref().expect("computed").to_json();
    deviating.summary = serde_json::from_str(&kept).expect("the same");
    let plain = state("plain", 0.9, [1.7, 2.5], 2.2e8);
    let rows = table(GearName::Driven, vec![deviating, plain.clone()]);
    let json = serde_json::to_value(&rows).expect("JSON");
    assert_eq!(json[0]["curves"][0]["hole_order_of_holes_um"], 0.12);
    assert_eq!(json[0]["curves"][0]["hole_order_um"], 0.31);
    assert!(json[1]["curves"][0].get("hole_order_of_holes_um").is_none());
    let text = csv(&rows);
    assert_eq!(
        column(&text, "hole_order_of_holes_um"),
        ["0.12", "", "", ""]
    );
    assert_eq!(column(&text, "contact_ratio"), ["1.61"; 4]);
    assert_eq!(column(&text, "backlash_mm"), ["0.34"; 4]);
    let as_drawn = csv(&table(GearName::Driven, vec![plain]));
    assert!(!as_drawn.contains("hole_order_of_holes_um"));
}

#[test]
fn a_row_and_its_line_of_csv_have_every_quantity_under_one_name() {
    // Numbers that are all different, so that none can stand in the place of another.
    let gear = |n: f64| json!({ "mass_kg": n, "mass_removed_percent": n + 1.0, "least_ligament_mm": n + 2.0, "polar_inertia_kg_m2": n + 3.0 });
    let spread = |n: f64| json!({ "mean": n, "rms": n + 1.0, "peak_to_peak": n + 2.0 });
    let stress = |n: f64| json!({ "root_mpa": n, "root_tension_mpa": n + 1.0, "root_compression_mpa": -n, "hole_mpa": n + 2.0 });
    let summary = json!({
        "method": "flexible", "driving": gear(10.0), "driven": gear(20.0), "contact_ratio": 34.0, "backlash_mm": 35.0,
        "hole_phase": { "amplitude_um": 36.0, "turn_of_driving_deg": 37.0 },
        "curves": [{
            "output_torque_n_m": 115.0,
            "statistics": { "partial": false, "transmission_error_um": and(spread(40.0), &json!({ "tooth_to_tooth": 43.0, "long_wave": 44.0, "short_wave": 45.0, "mesh_harmonics_rms": 46.0 })), "mesh_stiffness_tangent_n_per_m": spread(50.0),
                "stress": { "driving": stress(60.0), "driven": stress(70.0) } },
            "peak_contact_pressure_mpa": 80.0, "pressure_unbounded_share": 0.88, "pitch_point_pressure_mpa": 89.0, "smooth_contact_pressure_mpa": 90.0, "dynamic_peak_to_peak_um": 81.0, "face_load_factor": 82.0,
            "orders": { "H_N1": 83.0, "H_N2": 84.0, "H_Z2": 85.0, "H_2Z2": 102.0, "H_3Z2": 103.0, "H_4Z2": 104.0, "H_5Z2": 105.0,
                "H_6Z2": 106.0, "H_7Z2": 107.0, "H_8Z2": 108.0, "H_9Z2": 109.0, "H_10Z2": 110.0 }, "orders_of_holes": { "H_N1": 86.0, "H_N2": 87.0 },
        }],
    });
    let summary: Summary = serde_json::from_value(summary).expect("as it is kept");
    for gear in [GearName::Driving, GearName::Driven] {
        let mut state = state("whole", 0.9, [1.7, 2.5], 2.2e8);
        state.summary = Some(summary.clone());
        let rows = table(gear, vec![state]);
        let (text, row) = (csv(&rows), serde_json::to_value(&rows[0]).expect("JSON"));
        let mut seen = Vec::new();
        let mut names = Vec::new();
        for quantity in QUANTITIES {
            let (value, at) = match quantity.of {
                Of::Pair(of) => (of(&summary), &row),
                Of::Curve(of) => (of(&summary.curves()[0], gear), &row["curves"][0]),
            };
            let value = value.unwrap_or_else(|| panic!("{} is not told", quantity.name));
            if !quantity.is_in_rows_of(gear) {
                continue;
            }
            let name = quantity.column();
            let pointer = format!("/{}", name.replace('.', "/"));
            let in_row = at.pointer(&pointer).and_then(Value::as_f64);
            assert_eq!(in_row, Some(value), "{} at {pointer}", quantity.name);
            assert_eq!(column(&text, &name), [format!("{value:?}")], "{name}");
            // The first harmonic is the mesh order by its number.
            if name != "mesh_order_1_um" {
                seen.push(value.to_bits());
            }
            names.push(name);
        }
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), count, "two quantities tell the same number");
        // And no column of numbers stands for none of them.
        let line = text.lines().next().expect("names");
        let others = line
            .split(',')
            .filter(|name| !names.iter().any(|own| own == name));
        let others: Vec<&str> = others
            .filter(|name| !name.starts_with("changes."))
            .collect();
        assert_eq!(
            others,
            [
                "label",
                "job",
                "status",
                "method",
                "pareto",
                "output_torque_n_m",
                "problem.code",
                "problem.detail",
                "warnings"
            ]
        );
    }
}

#[test]
fn every_quantity_says_what_it_is_and_no_two_are_called_alike() {
    let entries: Vec<QuantityEntry> = quantities().collect();
    for told in [
        |entry: &QuantityEntry| entry.name.to_owned(),
        |entry: &QuantityEntry| entry.title.clone(),
        |entry: &QuantityEntry| entry.symbol.clone(),
    ] {
        let mut all: Vec<String> = entries.iter().map(told).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), entries.len());
    }
    for entry in entries {
        // A part of the name ends with the unit.
        let unit = match entry.unit {
            "1" => "",
            "%" => "_percent",
            "N/m" => "_n_per_m",
            "kg m^2" => "_kg_m2",
            unit => &format!("_{}", unit.to_lowercase()),
        };
        let mut parts = entry.name.split('.');
        assert!(
            parts.any(|part| part.ends_with(unit)),
            "{} in {}",
            entry.name,
            entry.unit
        );
        let gear = entry.gear.map(GearName::word);
        let of_gear = entry
            .name
            .split('.')
            .find(|part| ["driving", "driven"].contains(part));
        assert_eq!(gear, of_gear, "{}", entry.name);
        assert!(!entry.methods.is_empty(), "{}", entry.name);
    }
}

#[test]
fn a_label_that_begins_a_formula_comes_out_as_text() {
    let rows = table(
        GearName::Driven,
        vec![failed("=HYPERLINK(\"http://x\")"), failed("+1+1")],
    );
    let text = csv(&rows);
    let starts: Vec<&str> = text.lines().skip(1).map(|line| &line[..3]).collect();
    assert_eq!(starts, ["\"'=", "'+1"], "{text}");
}
