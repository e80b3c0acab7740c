//! Many submissions in one request, and many results in one answer.

use meshwright::config::Config;
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::admission::key_of;
use crate::bench::{Asked, Bench, RESULTS, problem, submission};

#[tokio::test]
async fn each_submission_of_a_batch_is_taken_or_refused_by_itself() {
    let bench = Bench::quick().await;
    let mut wrong = submission(1.0);
    wrong["pair"]["center_distance_mm"] = json!(118.5);
    let batch = json!({ "submissions": [submission(1.0), wrong, submission(2.0)] });
    let send = async || {
        let request = bench
            .post("/v1/jobs/batch", &batch)
            .header("idempotency-key", "b");
        request.answer().await
    };
    let answer = send().await;
    assert_eq!(answer.status(), StatusCode::ACCEPTED);
    let answer = answer.document().await;
    assert_eq!(
        (&answer["taken"], &answer["refused"]),
        (&json!(2), &json!(1))
    );
    assert_eq!(answer["items"][1]["problem"]["code"], "teeth_do_not_reach");
    assert_eq!(
        answer["items"][1]["problem"]["errors"][0]["pointer"],
        "/pair/center_distance_mm"
    );
    let again = send().await.document().await;
    for i in [0, 2] {
        assert_eq!(
            answer["items"][i]["job"]["id"],
            again["items"][i]["job"]["id"]
        );
        bench
            .ended(answer["items"][i]["job"]["links"]["self"].as_str().unwrap())
            .await;
    }
    let list = bench.job("/v1/jobs").await;
    assert_eq!(list["items"].as_array().unwrap().len(), 2);
    // A single submission whose key looks like that of a place in the batch is another one.
    let single = bench.post("/v1/jobs", &submission(3.0));
    let single = single.header("idempotency-key", "b/0").answer().await;
    assert_eq!(single.status(), StatusCode::ACCEPTED);
    let single = single.document().await;
    assert_ne!(single["id"], answer["items"][0]["job"]["id"]);
}

#[tokio::test]
async fn a_submission_with_a_wrong_field_refuses_itself_alone() {
    let (bench, _engine) = Bench::steered().await;
    let mut odd = submission(3.0);
    odd["colour"] = json!("red");
    let batch = json!({ "submissions": [submission(1.0), submission(-1.0), odd] });
    let answer = bench.post("/v1/jobs/batch", &batch).answer().await;
    assert_eq!(answer.status(), StatusCode::ACCEPTED);
    assert_eq!(answer.headers()["retry-after"], "1");
    let answer = answer.document().await;
    assert_eq!(
        (&answer["taken"], &answer["refused"]),
        (&json!(1), &json!(2))
    );
    let problem = |place: usize| &answer["items"][place]["problem"];
    assert_eq!(problem(0), &Value::Null);
    assert_eq!(problem(1)["code"], "torque_not_positive");
    assert_eq!(problem(1)["errors"][0]["pointer"], "/output_torques_n_m/0");
    assert_eq!(problem(2)["code"], "unknown_field");
}

#[tokio::test]
async fn a_batch_that_takes_nothing_is_refused_with_every_place() {
    let bench = Bench::quick().await;
    let mut apart = submission(1.0);
    apart["pair"]["center_distance_mm"] = json!(118.5);
    let batch = json!({ "submissions": [submission(-1.0), apart] });
    let asked = bench.post("/v1/jobs/batch", &batch);
    let refused = problem(asked, 422, "torque_not_positive").await;
    let pointers: Vec<&Value> = refused["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|error| &error["pointer"])
        .collect();
    assert_eq!(
        pointers,
        [
            "/submissions/0/output_torques_n_m/0",
            "/submissions/1/pair/center_distance_mm"
        ]
    );
}

#[tokio::test]
async fn a_batch_that_finds_no_room_in_the_queue_is_refused_as_a_job_is() {
    let full = |config: &mut Config| {
        config.queue_limit = 2;
        config.admission.client_queue_limit = Some(10);
    };
    finds_no_room(full, 503, "queue_full").await;
}

#[tokio::test]
async fn a_batch_that_finds_no_room_in_the_part_of_its_client_is_refused_as_a_job_is() {
    let has_its_part = |config: &mut Config| config.admission.client_queue_limit = Some(2);
    finds_no_room(has_its_part, 429, "client_queue_full").await;
}

/// Two jobs find room, and a third none.
async fn finds_no_room(adjust: impl FnOnce(&mut Config), status: u16, code: &str) {
    let (bench, mut engine) = Box::pin(Bench::steered_with(adjust)).await;
    let key = key_of(&bench, "portal").await;
    let send = async |torques: [f64; 3]| {
        let batch = json!({ "submissions": torques.map(submission) });
        let request = bench.post("/v1/jobs/batch", &batch).bearer_auth(&key);
        request.answer().await
    };
    let first = bench.post("/v1/jobs", &submission(50.0)).bearer_auth(&key);
    assert_eq!(first.answer().await.status(), StatusCode::ACCEPTED);
    let _work = engine.next().await;
    let some = send([1.0, 2.0, 3.0]).await;
    assert_eq!(some.status(), StatusCode::ACCEPTED);
    // The one that found no room may be sent again then.
    assert_eq!(some.headers()["retry-after"], "5");
    let some = some.document().await;
    assert_eq!((&some["taken"], &some["refused"]), (&json!(2), &json!(1)));
    assert_eq!(some["items"][2]["problem"]["code"], code);
    // A field that is wrong does not hide that there is no room.
    let none = send([-1.0, 4.0, 5.0]).await;
    assert_eq!(none.headers()["retry-after"], "5");
    problem(none, status, code).await;
}

#[tokio::test]
async fn what_is_no_batch_is_refused() {
    let bench = Bench::quick().await;
    let send = async |batch: Value| bench.post("/v1/jobs/batch", &batch).answer().await;
    problem(send(json!([])).await, 422, "wrong_type").await;
    let misspelled = send(json!({ "submission": [] })).await;
    problem(misspelled, 422, "unknown_field").await;
    // A list of the fields is no object of them.
    let list = send(json!([[submission(1.0)]])).await;
    problem(list, 422, "wrong_type").await;
    let asked = send(json!({ "submissions": [] })).await;
    problem(asked, 422, "out_of_range").await;
    let many = vec![submission(1.0); 101];
    problem(send(json!({ "submissions": many })).await, 422, "too_large").await;
}

#[tokio::test]
async fn the_results_of_a_study_come_line_by_line_and_its_table_at_both_addresses() {
    let bench = Bench::quick().await;
    let mut study = json!({ "name": "torques", "tags": ["t"], "base": submission(1.0),
        "axes": [{ "path": "/output_torques_n_m/0", "values": (1..=20).collect::<Vec<_>>() }] });
    study["axes"][0]["values"]
        .as_array_mut()
        .unwrap()
        .push(json!(-1));
    let taken = bench.post("/v1/studies", &study).document().await;
    let path = taken["links"]["self"].as_str().unwrap();
    let ended = bench.ended(path).await;
    assert_eq!(ended["successful"], 20);
    assert_eq!(ended["failed"], 1);
    assert_eq!(
        (ended["name"].as_str(), &ended["tags"]),
        (Some("torques"), &json!(["t"]))
    );

    let answer = bench
        .get(ended["links"]["results_ndjson"].as_str().unwrap())
        .answer()
        .await;
    assert_eq!(answer.headers()["content-type"], "application/x-ndjson");
    let text = answer.whole_text().await;
    let lines: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(lines.len(), 20);
    let results: Value = serde_json::from_str(RESULTS).unwrap();
    for (i, line) in lines.iter().enumerate() {
        assert_eq!(
            (line["row"].as_u64(), &line["results"]),
            (Some(i as u64), &results)
        );
        assert!(
            line["label"]
                .as_str()
                .unwrap()
                .starts_with("output_torques_n_m.0=")
        );
    }

    let csv = bench
        .get(ended["links"]["results_csv"].as_str().unwrap())
        .answer()
        .await;
    let tag = csv.headers()["etag"].clone();
    let csv = csv.whole_text().await;
    let old = bench.get(&format!("{path}/results.csv")).answer().await;
    assert!(old.headers().contains_key("deprecation"));
    assert_eq!(old.whole_text().await, csv);
    let known = bench
        .get(ended["links"]["results_csv"].as_str().unwrap())
        .header("if-none-match", tag);
    assert_eq!(known.answer().await.status(), StatusCode::NOT_MODIFIED);
    let json: Value = bench.document(&format!("{path}/results/table.json")).await;
    assert_eq!(json, bench.document(&format!("{path}/results")).await);
    assert_eq!(json["rows"].as_array().unwrap().len(), 21);
    let lines = bench.get(ended["links"]["table_ndjson"].as_str().unwrap());
    let lines = lines.answer().await;
    assert_eq!(lines.headers()["content-type"], "application/x-ndjson");
    let lines = lines.whole_text().await;
    let rows: Vec<Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(json["rows"], json!(rows), "row by row the same");
    let document = bench
        .document(ended["links"]["document"].as_str().unwrap())
        .await;
    assert_eq!((&document, &ended["study"]), (&study, &study));
    let asked = bench.get(&format!("{path}/results/table.xls"));
    problem(asked, 404, "not_found").await;

    for (query, count) in [
        ("tag=t", 1),
        ("tag=u", 0),
        ("name=torques", 1),
        ("name=x", 0),
        ("submitted_since=2020-01-01T00:00:00Z", 1),
        ("submitted_before=2020-01-01T00:00:00Z", 0),
    ] {
        let list = bench.job(&format!("/v1/studies?{query}")).await;
        assert_eq!(list["items"].as_array().unwrap().len(), count, "{query}");
    }
    let jobs = bench
        .job("/v1/jobs?submitted_before=2020-01-01T00:00:00Z")
        .await;
    assert_eq!(jobs["items"], json!([]));
    let asked = bench.get("/v1/jobs?submitted_since=tuesday");
    problem(asked, 400, "invalid_parameter").await;
}
