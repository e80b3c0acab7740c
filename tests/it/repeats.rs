//! The same submission twice: by key, by content, and more than the queue takes.

use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, RESULTS, problem, submission};

#[tokio::test]
async fn a_key_gives_the_same_job_however_often_it_is_sent() {
    let (bench, mut engine) = Bench::steered().await;
    let send = async |torque| {
        bench
            .post("/v1/jobs", &submission(torque))
            .header("idempotency-key", "k-1")
            .answer()
            .await
    };
    let first = send(115.0).await;
    assert_eq!(first.status(), StatusCode::ACCEPTED);
    let path = first.headers()["location"].clone();
    let work = engine.next().await;
    let again = send(115.0).await;
    assert_eq!(
        (again.status(), &again.headers()["location"]),
        (StatusCode::ACCEPTED, &path)
    );
    problem(send(20.0).await, 422, "idempotency_conflict").await;

    work.finish();
    bench.ended(path.to_str().unwrap()).await;
    let late = send(115.0).await;
    assert_eq!(
        (late.status(), &late.headers()["location"]),
        (StatusCode::OK, &path)
    );
    assert_eq!(late.document().await["status"], "successful");
    assert!(engine.is_idle());
    let list: Value = bench.document("/v1/jobs").await;
    assert_eq!(list["items"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn requests_with_one_key_at_the_same_time_make_one_job() {
    let (bench, mut engine) = Bench::steered().await;
    let document = submission(115.0);
    let send = || {
        bench
            .post("/v1/jobs", &document)
            .header("idempotency-key", "k-1")
            .send()
    };
    let answers = futures_util::future::join_all((0..20).map(|_| send())).await;
    let mut places: Vec<String> = answers
        .into_iter()
        .map(|answer| {
            answer.unwrap().headers()["location"]
                .to_str()
                .unwrap()
                .to_owned()
        })
        .collect();
    places.dedup();
    assert_eq!(places.len(), 1);
    engine.next().await.finish();
}

#[tokio::test]
async fn a_key_has_1_to_255_characters() {
    let bench = Bench::quick().await;
    for key in [String::new(), "k".repeat(256)] {
        problem(
            bench
                .post("/v1/jobs", &submission(1.0))
                .header("idempotency-key", key),
            400,
            "invalid_parameter",
        )
        .await;
    }
}

#[tokio::test]
async fn an_equal_submission_is_successful_at_once() {
    let (bench, mut engine) = Bench::steered().await;
    let first = bench.submit(&submission(115.0)).await;
    engine.next().await.finish();
    bench.ended(&first).await;

    let mut equal = submission(115.0);
    equal["tags"] = json!(["again"]);
    let response = bench.post("/v1/jobs", &equal).answer().await;
    let job = response.document().await;
    assert_eq!(job["status"], "successful");
    assert_eq!(job["progress_percent"], 100);
    assert_eq!(job["links"]["same_as"], first);
    assert_eq!(job["tags"], json!(["again"]));
    let results = bench
        .get(job["links"]["results"].as_str().unwrap())
        .answer()
        .await;
    assert_eq!(results.whole_text().await, RESULTS);

    bench.submit(&submission(20.0)).await;
    engine.next().await.finish();
}

#[tokio::test]
async fn a_full_queue_refuses_and_says_when_to_come_again() {
    let (bench, mut engine) = Bench::steered_with(|config| config.queue_limit = 2).await;
    let running = bench.submit(&submission(1.0)).await;
    let work = engine.next().await;
    for torque in [2.0, 3.0] {
        bench.submit(&submission(torque)).await;
    }
    let response = bench.post("/v1/jobs", &submission(4.0)).answer().await;
    assert!(response.headers().contains_key("retry-after"));
    problem(response, 503, "queue_full").await;

    work.finish();
    bench.ended(&running).await;
    let _next = engine.next().await;
    bench.submit(&submission(4.0)).await;
}
