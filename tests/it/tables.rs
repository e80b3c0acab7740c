//! Parts of the results as tables.

use std::time::Duration;

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, problem, submission};
use crate::stores;

#[tokio::test]
async fn curves_and_spectra_come_as_csv_and_json() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    let get = async |table: &str| bench.get(&format!("{path}/results/{table}")).answer().await;

    let csv = get("ste.csv?torque=115").await;
    assert_eq!(csv.headers()["content-type"], "text/csv; charset=utf-8");
    let text = csv.whole_text().await;
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "output_torque_n_m,mesh_position,driving_angle_deg,driven_angle_deg,transmission_error_um"
    );
    assert_eq!(
        lines[1..],
        ["115.0,0.0,0.0,0.0,13.79", "115.0,0.5,3.6,3.6,14.0"]
    );
    assert_eq!(
        get("ste.csv").await.whole_text().await.lines().count(),
        5,
        "both torques"
    );

    let json = get("mesh-stiffness.json").await.document().await;
    assert_eq!(
        json["curves"][0]["mesh_stiffness_tangent_n_per_m"][0],
        2.2e8
    );
    assert_eq!(json["curves"][0]["output_torque_n_m"], 115.0);
    let spectrum = get("spectrum.json?torque=115.0").await.document().await;
    assert_eq!(spectrum["curves"][0]["named"][0]["label"], "H_N");

    problem(get("ste.csv?torque=116").await, 404, "not_found").await;
    problem(get("spectrum.csv?torque=20").await, 404, "not_found").await;
    problem(get("ste.xml").await, 404, "not_found").await;
    problem(get("ste.csv?torque=much").await, 400, "invalid_parameter").await;
}

#[tokio::test]
async fn points_between_positions_come_where_they_are_kept_and_tables_have_them() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    let get = async |part: &str| bench.get(&format!("{path}/results{part}")).answer().await;
    // The stub's results are of an earlier version.
    problem(get("?between=true").await, 404, "not_found").await;
    problem(get("/ste.csv?between=true").await, 404, "not_found").await;
    problem(get("?between=much").await, 400, "invalid_parameter").await;
    problem(
        get("/spectrum.csv?between=true").await,
        400,
        "invalid_parameter",
    )
    .await;
    let plain = get("?between=false").await.document().await;
    assert_eq!(
        plain["curves"][0]["mesh_position"].as_array().map(Vec::len),
        Some(2)
    );
    let csv = get("/curves.csv").await.whole_text().await;
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("output_torque_n_m,mesh_position,driving_angle_deg,driven_angle_deg,transmission_error_um,mesh_stiffness_tangent_n_per_m,"));
    assert!(
        lines[0].ends_with(",peak_contact_pressure_mpa,load_share.0,load_share.1"),
        "{}",
        lines[0]
    );
    assert_eq!(lines.len(), 5);

    let bench = Bench::real().await;
    let mut pair = submission(115.0);
    pair["method"] = json!("load_distribution");
    let path = bench.submit(&pair).await;
    bench.ended(&path).await;
    let get = async |part: &str| bench.get(&format!("{path}/results{part}")).answer().await;
    let (plain, merged) = (get("").await, get("?between=true").await);
    assert_ne!(plain.headers()["etag"], merged.headers()["etag"]);
    let (plain, merged) = (plain.document().await, merged.document().await);
    let (plain, curve) = (&plain["curves"][0], &merged["curves"][0]);
    let count = |list: &Value| list.as_array().expect("a list").len();
    let points = count(&plain["between"]["mesh_position"]);
    assert!(points > 0);
    let all = count(&plain["mesh_position"]) + points;
    assert_eq!(count(&curve["mesh_position"]), all);
    assert_eq!(curve["statistics"], plain["statistics"]);
    for table in ["ste.csv", "mesh-stiffness.csv", "curves.csv"] {
        let text = get(&format!("/{table}?between=true"))
            .await
            .whole_text()
            .await;
        assert_eq!(text.lines().count(), 1 + all, "{table}");
        let text = get(&format!("/{table}")).await.whole_text().await;
        assert_eq!(text.lines().count(), 1 + all - points, "{table}");
    }
}

#[tokio::test]
async fn a_table_of_a_job_that_has_not_ended_is_not_ready() {
    let (bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(115.0)).await;
    let work = engine.next().await;
    let asked = bench.get(&format!("{path}/results/ste.csv"));
    problem(asked, 404, "result_not_ready").await;
    work.finish();
    bench.ended(&path).await;
    assert_eq!(
        bench
            .get(&format!("{path}/results/ste.csv"))
            .answer()
            .await
            .status(),
        StatusCode::OK
    );
}

#[tokio::test]
async fn a_file_that_is_not_made_in_time_is_202_and_comes_later_at_the_same_address() {
    let mut bench = Bench::quick().await;
    bench.times.file = Duration::ZERO;
    bench.shut_down().await;
    bench.start_again().await;
    let mut small = submission(115.0);
    small["resolution"] = json!({ "grid": "coarse" });
    for member in ["driving", "driven"] {
        small["pair"][member]["tooth_count"] = 25.into();
        small["pair"][member]["blank"] = json!({ "bore_radius_mm": 8.0 });
    }
    small["pair"]["center_distance_mm"] = 50.25.into();
    let path = bench.submit(&small).await;
    bench.ended(&path).await;
    for file in ["edges.json", "fields.vtu"] {
        let path = format!("{path}/results/{file}?mesh_position=0.25");
        let later = bench.get(&path).answer().await;
        assert_eq!(later.status(), StatusCode::ACCEPTED, "{file}");
        assert_eq!(later.headers()["retry-after"], "1");
        assert_eq!(later.headers()["cache-control"], "no-store");
        assert!(!later.headers().contains_key("etag"));
        assert_eq!(later.whole_text().await, "");
        let made = bench.file(&path).await;
        assert_eq!(made.status(), StatusCode::OK, "{file}");
        let tag = made.headers()["etag"].clone();
        let made = made.whole_text().await;
        // It is kept.
        let again = bench.get(&path).answer().await;
        assert_eq!(again.status(), StatusCode::OK, "{file}");
        assert!(again.whole_text().await == made, "{file}");
        let known = bench.get(&path).header("if-none-match", tag);
        assert_eq!(known.answer().await.status(), StatusCode::NOT_MODIFIED);
    }
    // It ends with its job.
    assert!(bench.delete(&path).answer().await.status().is_success());
    let gone = bench.get(&format!("{path}/results/edges.json?mesh_position=0.25"));
    problem(gone, 404, "job_not_found").await;
}

#[tokio::test]
#[ignore = "./test all"]
async fn fields_come_as_a_grid_at_any_position_and_torque_of_the_job() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    let get = async |query: &str| {
        bench
            .file(&format!("{path}/results/fields.vtu{query}"))
            .await
    };
    let answer = get("?torque=115&mesh_position=0.25").await;
    assert_eq!(answer.status(), StatusCode::OK);
    assert_eq!(answer.headers()["content-type"], "text/xml");
    let tag = answer.headers()["etag"].clone();
    let text = answer.whole_text().await;
    for name in [
        "UnstructuredGrid",
        "displacement_um",
        "stress_mpa",
        "von_mises_mpa",
        "thickness_mm",
        "gear",
    ] {
        assert!(text.contains(name), "{name}");
    }
    let again = bench
        .get(&format!(
            "{path}/results/fields.vtu?torque=115&mesh_position=0.25"
        ))
        .header("if-none-match", tag)
        .answer()
        .await;
    assert_eq!(again.status(), StatusCode::NOT_MODIFIED);
    // Another version of the solver says it otherwise, under the same address: nobody keeps it unasked.
    assert_eq!(again.headers()["cache-control"], "private, no-cache");
    let here = meshwright_wire::SOLVER_VERSION;
    assert_eq!(again.headers()["solver-version"], here);
    assert!(!again.headers().contains_key("results-solver-version"));
    let older = "update jobs set solver_version = 'meshwright 0.1.0' returning cast(1 as bigint)";
    stores::number(&bench.config.database, older).await;
    let of_older = get("?torque=115&mesh_position=0.25").await;
    assert_eq!(
        of_older.headers()["results-solver-version"],
        "meshwright 0.1.0"
    );
    let edges = format!("{path}/results/edges.json?torque=115&mesh_position=0.25");
    let edges = bench.file(&edges).await.document().await;
    assert_eq!(edges["mesh_position"], 0.25);
    let submitted = submission(115.0);
    for member in ["driving", "driven"] {
        let teeth = edges[member]["teeth"].as_array().unwrap();
        assert_eq!(
            teeth.len() as u64,
            submitted["pair"][member]["tooth_count"].as_u64().unwrap()
        );
        // Each tooth ends where the next begins.
        for (tooth, next) in teeth.iter().zip(teeth.iter().cycle().skip(1)) {
            let last = tooth["at_mm"].as_array().unwrap().last().unwrap();
            let first = &next["at_mm"][0];
            for axis in 0..2 {
                let apart = last[axis].as_f64().unwrap() - first[axis].as_f64().unwrap();
                assert!(apart.abs() < 1e-3, "{member}: {apart} mm");
            }
        }
    }
    problem(get("?torque=116").await, 404, "not_found").await;
    problem(get("?mesh_position=-0.5").await, 400, "invalid_parameter").await;
    problem(get("?mesh_position=1e9").await, 404, "not_found").await;
    problem(get("?position=1").await, 400, "invalid_parameter").await;
}

fn with_modes() -> Value {
    let mut submission = submission(115.0);
    submission["modes"] = serde_json::json!({ "count": 2 });
    submission
}

#[tokio::test]
async fn a_mode_that_no_list_has_is_not_found_before_anything_is_computed() {
    let bench = Bench::quick().await;
    let path = bench.submit(&with_modes()).await;
    bench.ended(&path).await;
    let get = async |file: &str| bench.file(&format!("{path}/results/modes/{file}")).await;
    for file in ["0.vtu", "3.vtu?gear=driven", "one.vtu", "1.csv", "1"] {
        problem(get(file).await, 404, "not_found").await;
    }
    for query in ["gear=both", "mode=1", "cells=linear"] {
        let answer = get(&format!("1.vtu?{query}")).await;
        problem(answer, 400, "invalid_parameter").await;
    }
    let bare = bench.submit(&submission(115.0)).await;
    bench.ended(&bare).await;
    let answer = bench
        .get(&format!("{bare}/results/modes/1.vtu"))
        .answer()
        .await;
    problem(answer, 404, "not_found").await;
}

#[tokio::test]
#[ignore = "./test all"]
async fn the_shape_of_a_mode_comes_as_a_grid_of_its_gear() {
    let bench = Bench::quick().await;
    let path = bench.submit(&with_modes()).await;
    bench.ended(&path).await;
    let get = async |file: &str| bench.file(&format!("{path}/results/modes/{file}")).await;
    for query in ["", "?gear=driving", "?gear=driven"] {
        let answer = get(&format!("2.vtu{query}")).await;
        assert_eq!(answer.status(), StatusCode::OK, "{query}");
        assert_eq!(answer.headers()["content-type"], "text/xml");
        let text = answer.whole_text().await;
        for name in ["displacement_um", "frequency_hz", "modal_mass_kg"] {
            assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
        }
        assert!(!text.contains("stress_mpa"));
    }
}

fn helical() -> Value {
    let mut submission: Value =
        serde_json::from_str(include_str!("../../api/examples/helical-pair.json")).unwrap();
    submission["resolution"] =
        serde_json::json!({ "positions_per_mesh_period": 8, "face_order": 4, "face_slices": 20 });
    submission["output_torques_n_m"] = serde_json::json!([200, 0, 50]);
    submission
}

#[tokio::test]
#[ignore = "./test all"]
async fn fields_of_a_pair_along_its_faces_are_volumes_and_its_edges_those_of_a_section() {
    let bench = Bench::real().await;
    let submission = helical();
    let path = bench.submit(&submission).await;
    bench.ended(&path).await;
    let get = async |file: &str| {
        let path = format!("{path}/results/{file}?torque=50&mesh_position=0.25");
        bench.file(&path).await
    };
    let volumes = get("fields.vtu").await;
    assert_eq!(volumes.status(), StatusCode::OK);
    let text = volumes.whole_text().await;
    for name in ["displacement_um", "stress_mpa", "von_mises_mpa", "gear"] {
        assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    assert!(!text.contains("thickness_mm"));
    let edges = get("edges.json").await.document().await;
    let results = bench.document(&format!("{path}/results")).await;
    let at = |name: &str| results["curves"][2][name][2].as_f64().unwrap();
    let lag = edges["transmission_error_um"].as_f64().unwrap();
    assert_eq!(at("mesh_position"), 0.25);
    assert!((lag - at("transmission_error_um")).abs() < 1e-3 * lag);
    for member in ["driving", "driven"] {
        let of = |name: &str| edges[member][name].as_array().unwrap().len() as u64;
        let pair = &submission["pair"][member];
        assert_eq!(of("teeth"), pair["tooth_count"].as_u64().unwrap());
        // The bore is one.
        assert_eq!(of("openings"), 1);
    }
}

#[tokio::test]
#[ignore = "./test all"]
async fn the_load_along_a_face_adds_up_to_the_whole_in_the_mean_and_at_every_position() {
    let bench = Bench::real().await;
    for (each, rows) in [(false, 1), (true, 8)] {
        let mut submission = helical();
        if each {
            submission["face_load"] = "positions".into();
        }
        let path = bench.submit(&submission).await;
        bench.ended(&path).await;
        let results = bench.document(&format!("{path}/results")).await;
        let load = results["curves"][2]["load_n"].as_f64().unwrap();
        let get = async |file: &str| {
            let path = format!("{path}/results/face-load.{file}");
            bench.get(&path).whole_text().await
        };
        let table = get("csv?torque=50").await;
        let lines: Vec<Vec<&str>> = table
            .lines()
            .map(|line| line.split(',').collect())
            .collect();
        assert_eq!(lines[0].contains(&"mesh_position"), each, "{:?}", lines[0]);
        let number = |text: &str| text.parse::<f64>().unwrap();
        let strips: Vec<[f64; 2]> = lines[1..]
            .iter()
            .map(|line| [line[line.len() - 2], line[line.len() - 1]].map(number))
            .collect();
        assert_eq!(strips.len(), rows * 20);
        let width = strips[1][0] - strips[0][0];
        for row in strips.chunks(20) {
            let whole = width * row.iter().map(|strip| strip[1]).sum::<f64>();
            // Ten digits of each are written.
            assert!((whole / load - 1.0).abs() < 1e-8, "{whole} of {load}");
        }
        let picture = get("svg").await;
        assert!(picture.contains("200 N m, K_Hβ") && picture.contains("50 N m, K_Hβ"));
    }
    let plane = bench.submit(&submission(115.0)).await;
    bench.ended(&plane).await;
    for file in ["json", "csv", "svg"] {
        let path = format!("{plane}/results/face-load.{file}");
        problem(bench.get(&path), 404, "not_found").await;
    }
}

#[tokio::test]
#[ignore = "./test all"]
async fn the_contact_pattern_of_a_pair_along_its_faces_comes_as_numbers_and_as_a_picture() {
    let bench = Bench::quick().await;
    let path = bench.submit(&helical()).await;
    bench.ended(&path).await;
    let get = async |file: &str| {
        let path = format!("{path}/results/contact-pattern.{file}");
        bench.file(&path).await
    };
    let answer = get("json").await;
    assert_eq!(answer.status(), StatusCode::OK);
    assert_eq!(answer.headers()["cache-control"], "private, no-cache");
    assert_eq!(
        answer.headers()["solver-version"],
        meshwright_wire::SOLVER_VERSION
    );
    let tag = answer.headers()["etag"].clone();
    let pattern = answer.document().await;
    let torques: Vec<f64> = pattern["curves"]
        .as_array()
        .unwrap()
        .iter()
        .map(|curve| curve["output_torque_n_m"].as_f64().unwrap())
        .collect();
    assert_eq!(torques, [200.0, 50.0], "at 0 nothing is pressed");
    let again = bench
        .get(&format!("{path}/results/contact-pattern.json"))
        .header("if-none-match", &tag)
        .answer()
        .await;
    assert_eq!(again.status(), StatusCode::NOT_MODIFIED);
    let one = get("json?torque=50").await;
    assert_ne!(one.headers()["etag"], tag);
    let one = one.document().await;
    assert_eq!(
        one["curves"][0], pattern["curves"][1],
        "to the last digit, whatever was asked beside it"
    );

    let picture = get("svg").await;
    assert_eq!(picture.headers()["content-type"], "image/svg+xml");
    let picture = picture.whole_text().await;
    for word in [
        "driving flank, 200 N m",
        "driven flank, 50 N m",
        "z in mm",
        "diameter in mm",
        "MPa",
    ] {
        assert!(picture.contains(word), "{word}");
    }
    let one = get("svg?torque=200").await.whole_text().await;
    assert!(!one.contains("50 N m") && one.len() < picture.len());
    problem(get("json?torque=0").await, 404, "not_found").await;
    problem(get("svg?torque=51").await, 404, "not_found").await;
    problem(get("json?position=1").await, 400, "invalid_parameter").await;

    let plane = bench.submit(&submission(115.0)).await;
    bench.ended(&plane).await;
    for file in ["json", "svg"] {
        let path = format!("{plane}/results/contact-pattern.{file}");
        let answer = bench.get(&path).answer().await;
        let told = problem(answer, 404, "not_found").await;
        assert!(
            told["detail"]
                .as_str()
                .unwrap()
                .contains("three_dimensional")
        );
    }
}

#[tokio::test]
async fn a_contact_pattern_of_a_job_that_failed_or_is_under_way_is_told_as_its_results_are() {
    let (bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&helical()).await;
    let work = engine.next().await;
    let pattern = format!("{path}/results/contact-pattern.json");
    problem(bench.get(&pattern), 404, "result_not_ready").await;
    let cancel = bench.cancel(&path);
    assert!(cancel.answer().await.status().is_success());
    work.stopped().await;
    bench.ended(&path).await;
    let answer = bench.get(&pattern).answer().await;
    assert_eq!(answer.status(), StatusCode::CONFLICT);
}
