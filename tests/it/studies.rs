//! Studies over HTTP: many variants of a submission, their queue, their table, and their end.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use meshwright_wire::{Code, Problem};
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{
    Asked, Bench, Engine, Events, RESULTS, Work, eventually, problem, results, submission,
};

/// A study of torques: as many designs, all of which can be built.
fn torques(values: &[f64]) -> Value {
    json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": values }] })
}

/// Submits a study and gives its address.
async fn submit(bench: &Bench, study: &Value) -> String {
    let response = bench.post("/v1/studies", study).answer().await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    response.headers()["location"].to_str().unwrap().to_owned()
}

/// The table of the study at an address.
async fn table(bench: &Bench, path: &str) -> Value {
    bench.job(&format!("{path}/results")).await
}

fn statuses(table: &Value) -> Vec<&str> {
    let rows = table["rows"].as_array().unwrap();
    rows.iter()
        .map(|row| row["status"].as_str().unwrap())
        .collect()
}

/// The torque that a piece of work is about.
fn torque(work: &Work) -> f64 {
    work.submission["output_torques_n_m"][0].as_f64().unwrap()
}

async fn next_torque(engine: &mut Engine) -> f64 {
    let work = engine.next().await;
    let torque = torque(&work);
    work.finish();
    torque
}

#[tokio::test]
async fn a_study_fills_its_table_row_by_row() {
    let (bench, mut engine) = Bench::steered().await;
    let response = bench
        .post("/v1/studies", &torques(&[20.0, 115.0]))
        .answer()
        .await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    assert!(response.headers().contains_key("retry-after"));
    let path = response.headers()["location"].to_str().unwrap().to_owned();
    let study = response.document().await;
    assert_eq!(
        path,
        format!("/v1/studies/{}", study["id"].as_str().unwrap())
    );
    assert_eq!(study["done"], 0);
    assert_eq!(study["total"], 2);

    let work = engine.next().await;
    let partial = table(&bench, &path).await;
    assert_eq!(partial["status"], "running");
    assert_eq!(statuses(&partial), ["running", "accepted"]);
    assert_eq!(partial["rows"][0]["label"], "output_torques_n_m.0=20.0");
    assert_eq!(
        partial["rows"][0]["changes"],
        json!({ "/output_torques_n_m/0": 20.0 })
    );
    assert_eq!(torque(&work), 20.0);
    work.finish();
    engine.next().await.finish();

    let ended = bench.ended(&path).await;
    assert_eq!(ended["status"], "successful");
    assert_eq!(ended["done"], 2);
    assert!(ended["finished_at"].is_string());
    let full = table(&bench, &path).await;
    assert_eq!(
        (
            full["id"].clone(),
            full["done"].as_u64(),
            full["total"].as_u64()
        ),
        (study["id"].clone(), Some(2), Some(2))
    );
    for row in full["rows"].as_array().unwrap() {
        assert_eq!(row["curves"][0]["output_torque_n_m"], 115.0, "of the stub");
        assert_eq!(row["curves"][0]["hole_order_um"], 0.1);
        // The result is that of an ordinary job.
        let job = bench
            .job(&format!("/v1/jobs/{}", row["job"].as_str().unwrap()))
            .await;
        assert_eq!(job["links"]["study"], path);
        let results = bench
            .get(job["links"]["results"].as_str().unwrap())
            .answer()
            .await;
        assert_eq!(results.whole_text().await, RESULTS);
    }
    let jobs = bench.job(ended["links"]["jobs"].as_str().unwrap()).await;
    assert_eq!(jobs["items"].as_array().unwrap().len(), 2);
    let alone = bench.job("/v1/jobs?study=none").await;
    assert_eq!(alone["items"], json!([]));

    let response = bench.get(&format!("{path}/results.csv")).answer().await;
    assert_eq!(
        response.headers()["content-type"],
        "text/csv; charset=utf-8"
    );
    let text = response.whole_text().await;
    // A header, and a line for each of two rows and the stub's two torques.
    assert_eq!(text.lines().count(), 5, "{text}");
    assert!(text.starts_with("label,changes./output_torques_n_m/0,job,status,"));
}

#[tokio::test]
async fn a_single_job_is_served_before_the_designs_of_a_study() {
    let (bench, mut engine) = Bench::steered().await;
    let values: Vec<f64> = (1..=1000).map(f64::from).collect();
    let path = submit(&bench, &torques(&values)).await;
    let running = engine.next().await;
    // The queue's limit is 100 for single jobs; a study does not fill it.
    let single = bench.submit(&submission(5000.0)).await;
    running.finish();
    assert_eq!(next_torque(&mut engine).await, 5000.0);
    assert_eq!(bench.ended(&single).await["status"], "successful");
    assert_eq!(next_torque(&mut engine).await, 2.0);

    // All rows come, although they are expanded in chunks.
    let all = eventually(async || {
        let rows = table(&bench, &path).await["rows"].as_array().unwrap().len();
        if rows == 1000 { Ok(()) } else { Err(rows) }
    });
    all.await;
    bench.cancel(&path).answer().await;
    drop(engine);
}

#[tokio::test]
async fn designs_that_cannot_be_built_stand_in_the_table_and_do_not_fail_the_rest() {
    let (bench, mut engine) = Bench::steered().await;
    let study = json!({ "base": submission(115.0), "designs": [
        { "label": "good", "changes": {} },
        { "label": "apart", "changes": { "/pair/center_distance_mm": 118.5 } },
        { "label": "fails", "changes": { "/output_torques_n_m": [20.0] } },
    ] });
    let path = submit(&bench, &study).await;
    engine.next().await.finish();
    let not_converged = Problem::new(Code::NotConverged, "at mesh position 3");
    engine.next().await.fail(not_converged);
    let ended = bench.ended(&path).await;
    assert_eq!(ended["status"], "successful");
    assert_eq!(ended["successful"], 1);
    assert_eq!(ended["failed"], 2);
    let table = table(&bench, &path).await;
    assert_eq!(statuses(&table), ["successful", "failed", "failed"]);
    let rows = &table["rows"];
    assert_eq!(rows[1]["problem"]["code"], "teeth_do_not_reach");
    assert_eq!(
        rows[1]["problem"]["errors"][0]["pointer"],
        "/pair/center_distance_mm"
    );
    assert!(rows[1]["job"].is_null());
    assert_eq!(rows[2]["problem"]["code"], "not_converged");
    assert!(rows[2]["job"].is_string());
}

#[tokio::test]
async fn a_study_of_impossible_designs_finishes_and_says_so() {
    let bench = Bench::quick().await;
    let study = json!({ "base": submission(115.0), "axes": [
        { "path": "/pair/center_distance_mm", "values": [118.5, 119.0, 120.0] },
    ] });
    let path = submit(&bench, &study).await;
    let ended = bench.job(&path).await;
    assert_eq!(ended["status"], "failed");
    assert_eq!(ended["done"], 3);
    assert_eq!(ended["problem"]["code"], "no_design_computed");
    let table = table(&bench, &path).await;
    assert_eq!(table["problem"]["code"], "no_design_computed");
    assert_eq!(statuses(&table), ["failed"; 3]);
}

#[tokio::test]
async fn equal_designs_are_computed_once() {
    let (bench, mut engine) =
        Bench::steered_with(|config| config.workers = Some(2.try_into().unwrap())).await;
    let study = json!({ "base": submission(115.0), "designs": [
        { "label": "a" },
        { "label": "b", "changes": { "/tags": ["the same, with a tag"] } },
        { "label": "c", "changes": { "/pair/driven/profile_shift": 0.0 } },
    ] });
    let path = submit(&bench, &study).await;
    let work = engine.next().await;
    // The second worker has nothing to do: what waits is equal to what runs.
    assert!(engine.is_idle());
    work.finish();
    assert_eq!(bench.ended(&path).await["successful"], 3);
    let rows = table(&bench, &path).await["rows"].clone();
    let first = format!("/v1/jobs/{}", rows[0]["job"].as_str().unwrap());
    for row in &rows.as_array().unwrap()[1..] {
        let job = bench
            .job(&format!("/v1/jobs/{}", row["job"].as_str().unwrap()))
            .await;
        assert_eq!(job["links"]["same_as"], first);
    }
    // A second study over the same designs has its results at once.
    let again = submit(&bench, &study).await;
    assert_eq!(bench.job(&again).await["status"], "successful");
    assert!(engine.is_idle());
    // Of a third one only what is new waits.
    let mut more = study;
    more["designs"][1]["changes"] = json!({ "/output_torques_n_m/0": 20.0 });
    let more = submit(&bench, &more).await;
    let work = engine.next().await;
    let now = bench.job(&more).await;
    assert_eq!((&now["successful"], &now["done"]), (&json!(2), &json!(2)));
    assert_eq!(torque(&work), 20.0);
    work.finish();
    assert_eq!(bench.ended(&more).await["successful"], 3);
}

#[tokio::test]
async fn a_study_that_keeps_statistics_has_its_table_and_no_curves() {
    let (bench, mut engine) = Bench::steered().await;
    let mut study = torques(&[20.0, 115.0]);
    study["keep"] = json!("statistics");
    let path = submit(&bench, &study).await;
    engine.next().await.finish();
    engine.next().await.finish();
    assert_eq!(bench.ended(&path).await["successful"], 2);
    let rows = table(&bench, &path).await["rows"].clone();
    let mut designs = Vec::new();
    for row in rows.as_array().unwrap() {
        assert_eq!(row["curves"][0]["hole_order_um"], 0.1, "of the stub");
        let design = format!("/v1/jobs/{}", row["job"].as_str().unwrap());
        let job = bench.job(&design).await;
        assert_eq!(
            (&job["status"], &job["keep"]),
            (&json!("successful"), &json!("statistics"))
        );
        for part in ["/results", "/results/ste.csv"] {
            let asked = bench.get(&format!("{design}{part}")).answer().await;
            let refused = problem(asked, 410, "results_not_kept").await;
            let detail = refused["detail"].as_str().unwrap();
            assert!(detail.contains(&design) && detail.contains("POST /v1/jobs"));
        }
        designs.push((design, job["submission"].clone()));
    }
    let documents = bench.get(&format!("{path}/results/documents.ndjson"));
    let documents = documents.answer().await;
    assert_eq!(documents.whole_text().await, "");

    // The numbers are there for the next study that wants no more.
    let again = submit(&bench, &study).await;
    assert_eq!(bench.job(&again).await["status"], "successful");
    assert!(engine.is_idle());

    // Alone it is computed, and the study's design has those results, too.
    let (design, submission) = &designs[0];
    let single = bench.submit(submission).await;
    engine.next().await.finish();
    let job = bench.ended(&single).await;
    assert!(job["links"]["same_as"].is_null() && job["keep"].is_null());
    for path in [&single, design] {
        let results = bench.get(&format!("{path}/results")).answer().await;
        assert_eq!(results.whole_text().await, RESULTS);
    }
}

#[tokio::test]
async fn a_cancelled_study_keeps_what_it_has_and_computes_no_more() {
    let (bench, mut engine) = Bench::steered().await;
    let path = submit(&bench, &torques(&[1.0, 2.0, 3.0])).await;
    engine.next().await.finish();
    let running = engine.next().await;
    problem(bench.delete(&path), 409, "job_running").await;
    for _ in 0..2 {
        let response = bench.cancel(&path).answer().await;
        assert_eq!(response.status(), StatusCode::ACCEPTED);
        let study = response.document().await;
        assert_eq!(study["status"], "dismissed");
    }
    running.stopped().await;
    let rows = table(&bench, &path).await;
    assert_eq!(statuses(&rows), ["successful", "dismissed", "dismissed"]);
    assert!(engine.is_idle());

    let first = format!("/v1/jobs/{}", rows["rows"][0]["job"].as_str().unwrap());
    let deleted = bench.delete(&path).answer().await;
    assert_eq!(deleted.status(), StatusCode::NO_CONTENT);
    problem(bench.get(&path), 404, "study_not_found").await;
    problem(bench.get(&first), 404, "job_not_found").await;
}

#[tokio::test]
async fn a_study_that_has_ended_is_not_cancelled_and_an_unknown_one_is_not_found() {
    let bench = Bench::quick().await;
    let path = submit(&bench, &torques(&[1.0])).await;
    bench.ended(&path).await;
    problem(bench.cancel(&path), 409, "job_finished").await;
    for path in [
        "/v1/studies/00000000-0000-0000-0000-000000000000",
        "/v1/studies/x",
        "/v1/studies/x/results",
        "/v1/studies/x/results.csv",
        "/v1/studies/x/events",
    ] {
        problem(bench.get(path), 404, "study_not_found").await;
    }
}

#[tokio::test]
async fn a_job_of_a_study_may_be_deleted_and_its_row_stays() {
    let bench = Bench::quick().await;
    let path = submit(&bench, &torques(&[1.0, 2.0])).await;
    bench.ended(&path).await;
    let job = table(&bench, &path).await["rows"][0]["job"].clone();
    let job = format!("/v1/jobs/{}", job.as_str().unwrap());
    bench.delete(&job).answer().await;
    let table = table(&bench, &path).await;
    assert_eq!(statuses(&table), ["dismissed", "successful"]);
    assert_eq!(table["done"], 2);
    assert_eq!(table["status"], "successful");
}

#[tokio::test]
async fn what_is_wrong_with_a_study_is_refused_with_its_place() {
    let bench = Bench::quick().await;
    let send = async |study: Value| bench.post("/v1/studies", &study).answer().await;
    let typo = json!({ "base": submission(1.0), "axes": [
        { "path": "/pair/driven/blank/holes/cuont", "values": [6, 8] }] });
    let refused = problem(send(typo).await, 422, "unknown_field").await;
    assert_eq!(refused["errors"][0]["pointer"], "/axes/0/path");

    let values: Vec<u32> = (0..57).collect();
    let fields = ["count", "circle_radius_mm", "radius_mm", "phase_deg"];
    let axes = fields.map(
        |field| json!({ "path": format!("/pair/driven/blank/holes/{field}"), "values": values }),
    );
    let huge = json!({ "base": submission(1.0), "axes": axes });
    let refused = problem(send(huge).await, 422, "too_large").await;
    assert!(refused["detail"].as_str().unwrap().contains("100000"));

    let twice = json!({ "base": submission(1.0), "designs": [{ "label": "a" }, { "label": "a" }] });
    problem(send(twice).await, 422, "out_of_range").await;
    let long = json!({ "base": submission(1.0), "axes": [{ "path": "/output_torques_n_m/0", "values": vec![1.0; 5_000_000] }] });
    problem(send(long).await, 413, "payload_too_large").await;
    problem(
        bench
            .send("/v1/studies")
            .header("content-type", "application/json")
            .body(r#"{ "base": NaN }"#),
        400,
        "malformed_json",
    )
    .await;
    let list = bench.job("/v1/studies").await;
    assert_eq!(list, json!({ "items": [], "next": null }));
}

#[tokio::test]
async fn a_key_gives_the_same_study_and_lists_turn_their_pages() {
    let bench = Bench::quick().await;
    let send = async |key: &'static str, torque: f64| {
        bench
            .post("/v1/studies", &torques(&[torque]))
            .header("idempotency-key", key)
            .answer()
            .await
    };
    let first = send("a", 1.0).await.headers()["location"].clone();
    bench.ended(first.to_str().unwrap()).await;
    let again = send("a", 1.0).await;
    assert_eq!(
        (again.status(), &again.headers()["location"]),
        (StatusCode::OK, &first)
    );
    problem(send("a", 2.0).await, 422, "idempotency_conflict").await;
    let second = send("b", 2.0).await.headers()["location"].clone();

    let page = bench.job("/v1/studies?limit=1").await;
    assert_eq!(page["items"][0]["links"]["self"], second.to_str().unwrap());
    let cursor = page["next"].as_str().unwrap();
    let page = bench
        .job(&format!("/v1/studies?limit=1&cursor={cursor}"))
        .await;
    assert_eq!(page["items"][0]["links"]["self"], first.to_str().unwrap());
    assert!(page["next"].is_null());
    for query in ["?limit=0", "?cursor=x", "?colour=red"] {
        let asked = bench.get(&format!("/v1/studies{query}"));
        problem(asked, 400, "invalid_parameter").await;
    }
}

#[tokio::test]
async fn the_events_of_a_study_tell_its_progress_and_end_with_it() {
    let (bench, mut engine) = Bench::steered().await;
    let path = submit(&bench, &torques(&[1.0, 2.0])).await;
    let work = engine.next().await;
    let mut events = Events::of(&bench, &path).await;
    let (name, study) = events.next().await.unwrap();
    assert_eq!(
        (name.as_str(), &study["status"], &study["done"]),
        ("status", &json!("running"), &json!(0))
    );
    // What the stream tells next can only be what happens from here on.
    work.finish();
    assert_eq!(
        events.next().await.unwrap(),
        ("progress".to_owned(), json!({ "done": 1, "total": 2 }))
    );
    engine.next().await.finish();
    let (name, study) = events.next().await.unwrap();
    assert_eq!(
        (name.as_str(), &study["status"], &study["done"]),
        ("status", &json!("successful"), &json!(2))
    );
    assert_eq!(events.next().await, None);
}

#[tokio::test]
async fn a_study_whose_process_died_goes_on_where_it_was_and_loses_no_design() {
    let (mut bench, mut engine) = Bench::steered().await;
    let values: Vec<f64> = (1..=1200).map(f64::from).collect();
    let path = submit(&bench, &torques(&values)).await;
    for _ in 0..3 {
        engine.next().await.finish();
    }
    let lost = engine.next().await;
    bench.kill().await;
    drop(lost);

    bench.start_again().await;
    assert_eq!(bench.job(&path).await["successful"], 3);
    let mut computed = Vec::new();
    for _ in 4..=1200 {
        computed.push(next_torque(&mut engine).await);
    }
    assert_eq!(computed, values[3..], "each of the others once, in order");
    let ended = bench.ended(&path).await;
    assert_eq!(ended["status"], "successful");
    assert_eq!(ended["successful"], 1200);
    assert!(engine.is_idle());
    assert_eq!(
        statuses(&table(&bench, &path).await),
        vec!["successful"; 1200]
    );
}

#[tokio::test]
async fn a_thousand_quick_designs_come_through_the_queue() {
    let count = Arc::new(AtomicU64::new(0));
    let counted = Arc::clone(&count);
    let bench = Bench::start(
        |config| config.workers = Some(2.try_into().unwrap()),
        Arc::new(move |_, _| {
            counted.fetch_add(1, Ordering::Relaxed);
            Ok(results())
        }),
    )
    .await;
    let values: Vec<f64> = (1..=1000).map(f64::from).collect();
    let path = submit(&bench, &torques(&values)).await;
    assert_eq!(bench.ended(&path).await["successful"], 1000);
    assert_eq!(count.load(Ordering::Relaxed), 1000);
}
