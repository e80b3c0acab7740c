//! Searches over HTTP: generation after generation of designs that real workers compute, killed and gone on with, cancelled, and reported.

use std::num::NonZeroUsize;
use std::sync::Arc;

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, problem};

/// Reliefs of a small pair by the quick method, chosen by a search.
fn reliefs(evaluations: u32) -> Value {
    let gear = json!({
        "tooth_count": 20, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 8.0 },
        "tip_relief": { "amount_um": 5.0, "start": { "radial_length_mm": 0.8 } }
    });
    json!({
        "base": {
            "method": "load_distribution",
            "pair": { "center_distance_mm": 40.2, "driving": gear, "driven": gear },
            "output_torques_n_m": [50.0],
            "resolution": { "positions_per_mesh_period": 12, "span_mesh_periods": 1 },
        },
        "search": {
            "variables": [
                { "path": "/pair/driving/tip_relief/amount_um", "low": 0.5, "high": 30 },
                { "path": "/pair/driven/tip_relief/amount_um", "low": 0.5, "high": 30, "step": 0.5 },
            ],
            "minimize": [{ "quantity": "transmission_error_um.peak_to_peak" }],
            "subject_to": [{ "quantity": "transmission_error_um.mean", "at_most": 40 }],
            "evaluations": evaluations,
            "seed": 3,
        },
    })
}

async fn begun(bench: &Bench, study: &Value) -> String {
    let response = bench.post("/v1/studies", study).answer().await;
    let status = response.status();
    let path = response
        .headers()
        .get("location")
        .map(|path| path.to_str().unwrap().to_owned());
    assert_eq!(
        status,
        StatusCode::ACCEPTED,
        "{}",
        response.whole_text().await
    );
    path.unwrap()
}

async fn with_workers(workers: usize) -> Bench {
    let adjust =
        |config: &mut meshwright::config::Config| config.workers = NonZeroUsize::new(workers);
    // Two services in one test would be more than its stack has room for.
    Box::pin(Bench::start_with(adjust, Arc::new(meshwright_wire::solve))).await
}

#[tokio::test]
async fn a_search_finds_its_best_design_confirms_it_and_gives_its_submission() {
    let bench = with_workers(2).await;
    let path = begun(&bench, &reliefs(30)).await;
    let study = bench.ended(&path).await;
    let search = &study["search"];
    assert_eq!(study["status"], "successful");
    assert_eq!(
        (&search["evaluations"], &search["ended_by"]),
        (&json!(30), &json!("evaluations"))
    );
    // Thirty designs, and the best one once more.
    assert_eq!((&study["done"], &study["total"]), (&json!(31), &json!(31)));

    let table = bench.job(&format!("{path}/results")).await;
    let rows = table["rows"].as_array().unwrap();
    let range = |row: &Value| {
        row["curves"][0]["statistics"]["transmission_error_um"]["peak_to_peak"].as_f64()
    };
    let best = &search["best"];
    let place = best["row"].as_u64().unwrap() as usize;
    let least = rows[..30]
        .iter()
        .filter_map(range)
        .fold(f64::INFINITY, f64::min);
    assert_eq!(
        (range(&rows[place]), best["goals"][0].as_f64()),
        (Some(least), Some(least))
    );
    assert_eq!(
        (&best["feasible"], &best["values"]),
        (&json!(true), &rows[place]["changes"])
    );
    assert!(
        least < range(&rows[0]).unwrap(),
        "the base is the first design, and not the best"
    );
    let feasible = search["generations"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["feasible"].as_u64().unwrap());
    assert!(feasible.sum::<u64>() <= 30);

    let confirmed = &search["confirmed"];
    assert_eq!(
        (&confirmed["row"], &confirmed["feasible"]),
        (&json!(30), &json!(true))
    );
    assert_eq!(rows[30]["method"], "flexible");
    assert_eq!(confirmed["goals"][0].as_f64(), range(&rows[30]));
    let estimate = confirmed["error_estimate"]["transmission_error_peak_to_peak_um"]
        .as_f64()
        .unwrap();
    assert!((0.0..0.2 * least).contains(&estimate), "{estimate}");

    let submission = bench.job(&format!("{path}/best")).await;
    for (pointer, value) in best["values"].as_object().unwrap() {
        assert_eq!(
            submission.pointer(pointer).and_then(Value::as_f64),
            value.as_f64()
        );
    }
    assert_eq!(
        submission,
        bench.job(&format!("{path}/designs/{place}")).await
    );
    let fine = bench.job(&format!("{path}/designs/30")).await;
    assert_eq!(
        (&fine["method"], &fine["resolution"]["grid"]),
        (&json!("flexible"), &json!("fine"))
    );
    let csv = bench
        .get(&format!("{path}/results/table.csv"))
        .whole_text()
        .await;
    assert_eq!(csv.lines().count(), 32);

    let other = begun(&bench, &json!({ "base": reliefs(2)["base"], "axes": [{ "path": "/output_torques_n_m/0", "values": [1.0] }] })).await;
    problem(bench.get(&format!("{other}/best")), 404, "not_found").await;
    assert_eq!(bench.ended(&other).await["search"], Value::Null);
}

/// What a search comes to, apart from the ids of its jobs.
async fn outcome(bench: &Bench, path: &str) -> (Value, Vec<Value>) {
    let mut study = bench.ended(path).await;
    let table = bench.job(&format!("{path}/results")).await;
    let rows = table["rows"].as_array().unwrap().iter().map(|row| {
        let mut row = row.clone();
        row["job"] = Value::Null;
        row
    });
    (study["search"].take(), rows.collect())
}

#[tokio::test]
async fn a_search_comes_to_the_same_with_two_workers_and_after_its_process_was_killed() {
    let alone = with_workers(1).await;
    let path = begun(&alone, &reliefs(40)).await;
    let straight = outcome(&alone, &path).await;

    let mut bench = with_workers(2).await;
    let path = begun(&bench, &reliefs(40)).await;
    for rows in [5, 22] {
        loop {
            let study = bench.job(&path).await;
            if study["done"].as_u64().unwrap() >= rows {
                break;
            }
            tokio::task::yield_now().await;
        }
        bench.kill().await;
        Box::pin(bench.start_again()).await;
    }
    let interrupted = outcome(&bench, &path).await;
    assert_eq!(interrupted.0, straight.0);
    assert_eq!(interrupted.1, straight.1);
}

#[tokio::test]
async fn a_search_of_two_goals_comes_to_a_front() {
    let bench = with_workers(2).await;
    let mut study = reliefs(48);
    study["search"]["minimize"] = json!([
        { "quantity": "transmission_error_um.peak_to_peak" },
        { "cost": [
            { "path": "/pair/driving/tip_relief/amount_um", "weight": 1 },
            { "path": "/pair/driven/tip_relief/amount_um", "weight": 1 },
        ] },
    ]);
    study["keep"] = json!("statistics");
    let path = begun(&bench, &study).await;
    let (search, rows) = outcome(&bench, &path).await;
    let front = search["front"].as_array().unwrap();
    assert!(front.len() > 2, "{search}");
    let goals = |design: &Value| [0, 1].map(|i| design["goals"][i].as_f64().unwrap());
    assert!(
        front
            .windows(2)
            .all(|two| goals(&two[0])[0] < goals(&two[1])[0]
                && goals(&two[0])[1] > goals(&two[1])[1])
    );
    // No design of the table beats one of the front.
    let range = |row: &Value| {
        row["curves"][0]["statistics"]["transmission_error_um"]["peak_to_peak"].as_f64()
    };
    for row in &rows[..48] {
        let Some(own) = range(row) else { continue };
        let cost: f64 = row["changes"]
            .as_object()
            .unwrap()
            .values()
            .map(|value| value.as_f64().unwrap())
            .sum();
        let beats =
            |design: &Value| own < goals(design)[0] - 1e-12 && cost < goals(design)[1] - 1e-9;
        assert!(!front.iter().any(beats), "{row}");
    }
    assert!(front.contains(&search["best"]));
    assert_eq!(search["confirmed"]["row"], 48);
    assert!(
        search["confirmed"]["error_estimate"].is_object(),
        "though only statistics are kept"
    );
}

#[tokio::test]
async fn a_search_over_members_takes_the_percentile_that_its_table_has() {
    let bench = with_workers(2).await;
    let mut study = reliefs(6);
    study["search"]["variables"][1] =
        json!({ "path": "/population/accuracy/driven/iso_1328_class", "low": 4, "high": 8 });
    study["search"]["minimize"][0]["percent"] = json!(75);
    study["search"]["population"] =
        json!({ "size": 9, "accuracy": { "driven": { "iso_1328_class": 6 } } });
    let path = begun(&bench, &study).await;
    let (search, rows) = outcome(&bench, &path).await;
    assert_eq!(rows.len(), 6 * 10 + 1);
    let place = search["best"]["row"].as_u64().unwrap() as usize;
    assert_eq!(rows[place]["label"], format!("design {}", place / 10 + 1));
    let range = |row: &Value| {
        row["curves"][0]["statistics"]["transmission_error_um"]["peak_to_peak"]
            .as_f64()
            .unwrap()
    };
    let mut members: Vec<f64> = rows[place + 1..place + 10].iter().map(range).collect();
    members.sort_by(f64::total_cmp);
    // numpy.percentile(members, 75) of nine: the seventh.
    assert_eq!(search["best"]["goals"][0].as_f64(), Some(members[6]));
    let member = bench.job(&format!("{path}/designs/{}", place + 3)).await;
    assert!(member["pair"]["driven"]["tooth_deviations"].is_object());
    let job = bench
        .job(&format!(
            "/v1/jobs/{}",
            bench.job(&format!("{path}/results")).await["rows"][place + 3]["job"]
                .as_str()
                .unwrap()
        ))
        .await;
    assert_eq!(job["submission"], member);
}

#[tokio::test]
async fn a_search_that_is_cancelled_keeps_what_is_there() {
    let (bench, mut engine) = Bench::steered().await;
    let mut study = reliefs(400);
    // What the engine that is steered tells, and a method that may tell it.
    study["base"]["method"] = json!("flexible");
    study["search"]["minimize"] = json!([{ "quantity": "hole_order_um" }]);
    study["search"]["subject_to"] = json!([]);
    let path = begun(&bench, &study).await;
    let before = bench.job(&path).await;
    assert_eq!(
        (&before["search"]["evaluations"], &before["search"]["best"]),
        (&json!(0), &Value::Null)
    );
    problem(bench.get(&format!("{path}/best")), 404, "result_not_ready").await;
    let begun = bench.job(&format!("{path}/results")).await["rows"]
        .as_array()
        .unwrap()
        .len();
    for _ in 0..begun {
        engine.next().await.finish();
    }
    // The first design of the second generation.
    let _running = engine.next().await;
    let study = bench.job(&path).await;
    assert_eq!(study["search"]["evaluations"], begun);
    assert_eq!(
        study["search"]["generations"].as_array().map(Vec::len),
        Some(1)
    );
    let cancelled = bench.cancel(&path).answer().await;
    assert_eq!(cancelled.status(), StatusCode::ACCEPTED);
    let kept = bench.job(&path).await;
    assert_eq!(kept["status"], "dismissed");
    assert_eq!(kept["search"], study["search"]);
    let best = bench.job(&format!("{path}/best")).await;
    assert_eq!(best["method"], "flexible");
}

#[tokio::test]
async fn a_search_whose_every_design_is_refused_names_the_usual_reason() {
    let bench = with_workers(1).await;
    let mut study = reliefs(20);
    study["search"]["variables"][0] =
        json!({ "path": "/pair/center_distance_mm", "low": 45, "high": 50 });
    let path = begun(&bench, &study).await;
    let failed = bench.ended(&path).await;
    assert_eq!(
        (&failed["status"], &failed["done"], &failed["total"]),
        (&json!("failed"), &json!(20), &json!(20))
    );
    assert_eq!(failed["problem"]["code"], "no_design_computed");
    let detail = failed["problem"]["detail"].as_str().unwrap();
    assert!(
        detail.contains("teeth_do_not_reach") && detail.contains("20 of them"),
        "{detail}"
    );
    assert_eq!(failed["search"]["refusals"][0]["count"], 20);
    problem(bench.get(&format!("{path}/best")), 404, "result_not_ready").await;
}

#[tokio::test]
async fn a_search_begins_no_generation_after_its_time() {
    let (bench, mut engine) = Bench::steered_with(|_| {}).await;
    let mut study = reliefs(400);
    study["search"]["seconds"] = json!(1);
    study["base"]["method"] = json!("flexible");
    study["search"]["minimize"] = json!([{ "quantity": "hole_order_um" }]);
    study["search"]["subject_to"] = json!([{ "quantity": "hole_order_um", "at_most": 1e-3 }]);
    let path = begun(&bench, &study).await;
    let mut computed = 0;
    let study = loop {
        tokio::select! {
            work = engine.next() => {
                computed += 1;
                // The first generation takes longer than there is time.
                if computed == 1 {
                    tokio::time::sleep(std::time::Duration::from_millis(1100)).await;
                }
                work.finish();
            }
            study = bench.ended(&path) => break study,
        }
    };
    assert_eq!(
        (
            study["search"]["ended_by"].as_str(),
            study["search"]["evaluations"].as_u64()
        ),
        (Some("seconds"), Some(computed))
    );
    assert_eq!(
        study["search"]["generations"].as_array().map(Vec::len),
        Some(1)
    );
    // No design kept the condition, so that none is confirmed; the best is the one that comes nearest to it.
    assert_eq!(
        (
            &study["search"]["best"]["feasible"],
            &study["search"]["confirmed"]
        ),
        (&json!(false), &Value::Null)
    );
}

#[tokio::test]
async fn a_search_that_cannot_be_is_refused_with_its_place() {
    let bench = Bench::quick().await;
    let mut study = reliefs(40);
    study["search"]["variables"][1]["step"] = json!(7);
    let refused = problem(bench.post("/v1/studies", &study), 422, "out_of_range").await;
    assert_eq!(refused["errors"][0]["pointer"], "/search/variables/1/step");
    study["axes"] = json!([{ "path": "/output_torques_n_m/0", "values": [1.0] }]);
    let refused = problem(bench.post("/v1/studies", &study), 422, "conflicting_fields").await;
    assert_eq!(refused["errors"][0]["pointer"], "/search");
}
