//! Estimated costs of submissions beside measured ones.

use serde_json::{Value, json};

use crate::testing::{and, parse};

/// A gear of so many teeth on this `blank`, all lengths in millimeters.
fn gear([teeth, module, width]: [f64; 3], blank: &Value) -> Value {
    json!({ "tooth_count": teeth as u32, "module_mm": module, "face_width_mm": width, "blank": blank })
}

/// A submission of two gears at a distance under a torque, with `further` fields.
fn pair(method: &str, [distance, torque]: [f64; 2], gears: [Value; 2], further: &Value) -> Value {
    let [driving, driven] = gears;
    let document = json!({
        "method": method,
        "pair": { "center_distance_mm": distance, "driving": driving, "driven": driven },
        "output_torques_n_m": [torque],
    });
    and(document, further)
}

#[test]
fn the_time_of_each_kind_of_submission_is_within_a_factor_of_two_of_what_was_measured() {
    let plain = |bore: f64| json!({ "bore_radius_mm": bore });
    let with = |bore: f64, further: Value| and(plain(bore), &further);
    let round = |count: u32, circle: f64, radius: f64| json!({ "holes": { "count": count, "circle_radius_mm": circle, "radius_mm": radius } });
    let spokes = |count: u32, inner: f64, outer: f64| json!({ "spokes": { "count": count, "width_mm": 2.2, "fillet_radius_mm": 1.2, "inner_radius_mm": inner, "outer_radius_mm": outer } });
    let positions = |count: u32| json!({ "resolution": { "positions_per_mesh_period": count } });
    let helical = |mut document: Value, angle: f64| {
        document["pair"]["helix_angle_deg"] = json!(angle);
        document
    };

    let fine_spokes = [
        gear([45.0, 1.0, 11.5], &plain(7.372)),
        gear([90.0, 1.0, 11.5], &with(14.036, spokes(6, 15.54, 41.95))),
    ];
    let spokes_and_holes = [
        gear([45.0, 1.0, 10.3], &with(7.018, spokes(5, 8.52, 19.45))),
        gear([90.0, 1.0, 10.3], &with(13.885, round(5, 28.767, 10.845))),
    ];
    let slots = json!({ "holes": { "count": 4, "circle_radius_mm": 53.184, "slot": { "width_mm": 21.274, "angle_deg": 31.5 } } });
    let long_period = [
        gear([29.0, 2.0, 16.7], &with(8.311, round(8, 17.306, 4.078))),
        gear([85.0, 2.0, 16.7], &with(24.068, slots)),
    ];
    let table = and(positions(20), &json!({ "force_table": { "loads": 12 } }));
    let of_table = [
        gear([45.0, 2.0, 18.7], &plain(15.039)),
        gear([90.0, 2.0, 18.7], &with(26.937, round(6, 57.118, 17.944))),
    ];
    let speeds = json!({ "from": 0, "to": 12_000, "count": 100 });
    let run_up = and(
        table.clone(),
        &json!({ "dynamics": { "driving_speed_rpm": speeds } }),
    );
    let of_run_up = [
        gear([50.0, 2.0, 17.0], &plain(14.968)),
        gear([50.0, 2.0, 17.0], &with(14.528, round(5, 30.914, 11.654))),
    ];
    let web = json!({ "web": { "inner_radius_mm": 16.139, "outer_radius_mm": 41.3, "thickness_mm": 7.96 } });
    let on_web = [
        gear([23.0, 2.0, 19.9], &plain(6.405)),
        gear([47.0, 2.0, 19.9], &with(13.139, web)),
    ];
    let many_functions = json!({
        "resolution": { "positions_per_mesh_period": 8, "face_order": 12, "face_slices": 40, "span_mesh_periods": 1 },
    });
    let of_many = [
        gear([30.0, 3.0, 26.2], &plain(14.085)),
        gear([60.0, 3.0, 26.2], &plain(22.597)),
    ];
    #[rustfmt::skip]
    let jobs = [
        // User time of `meshwright solve` on one thread of an AMD EPYC, the least of two.
        ("spokes near the rim", 6.9, pair("decomposition", [67.65, 22.16], fine_spokes, &positions(8))),
        ("spokes and holes", 1.1, pair("flexible", [67.65, 8.5], spokes_and_holes, &positions(40))),
        ("2,465 mesh periods", 0.95, pair("projected_decomposition", [114.3, 182.65], long_period, &positions(8))),
        ("force table", 1.15, pair("flexible", [135.3, 90.68], of_table, &table)),
        ("run-up", 5.8, pair("flexible", [100.3, 82.75], of_run_up, &run_up)),
        ("web along faces", 6.5, helical(pair("three_dimensional", [74.792, 41.71], on_web, &positions(24)), 20.0)),
        ("order 12 along faces", 6.5, helical(pair("three_dimensional", [144.114, 245.14], of_many, &many_functions), 20.0)),
    ];
    for (name, measured, document) in jobs {
        let submission = parse(&document).expect("valid");
        let part = submission.estimate().seconds / measured;
        println!("{name}: {part:.2}");
        assert!((0.5..2.0).contains(&part), "{name}: {part}");
    }
}
