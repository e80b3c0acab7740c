//! Users behind one key: their turns, their part of the queue, and what is told of them.

use meshwright::http::KeysRule;
use reqwest::header::HeaderValue;
use reqwest::{RequestBuilder, Response, StatusCode};
use serde_json::{Value, json};

use crate::admission::key_of;
use crate::bench::{Asked, Bench, problem, submission};

/// A submission of a user of the client of `key`.
fn by(bench: &Bench, key: &str, user: &str, document: &Value, path: &str) -> RequestBuilder {
    let request = bench.post(path, document).bearer_auth(key);
    request.header("meshwright-user", user)
}

async fn submit(bench: &Bench, key: &str, user: &str, torque: f64) -> Response {
    by(bench, key, user, &submission(torque), "/v1/jobs")
        .answer()
        .await
}

#[tokio::test]
async fn the_second_engineer_behind_a_key_waits_for_no_more_than_one_job_of_the_first() {
    let (bench, mut engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    for torque in 1..=6 {
        submit(&bench, &key, "ada", f64::from(torque)).await;
    }
    let running = engine.next().await;
    submit(&bench, &key, "bob@example.com", 77.0).await;
    running.finish();
    let mut before = 0;
    loop {
        let work = engine.next().await;
        let torque = work.submission["output_torques_n_m"][0].as_f64();
        work.finish();
        if torque == Some(77.0) {
            break;
        }
        before += 1;
    }
    assert!(
        before < 2,
        "{before} jobs of the first one were computed before"
    );
}

#[tokio::test]
async fn jobs_and_studies_say_who_submitted_them_and_lists_go_by_it() {
    let (bench, _engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    let told = submit(&bench, &key, "ada", 1.0).await.document().await;
    assert_eq!(told["submitted_by"], "ada");
    submit(&bench, &key, "bob", 2.0).await;
    let nobody = bench.post("/v1/jobs", &submission(3.0)).bearer_auth(&key);
    assert_eq!(nobody.document().await["submitted_by"], Value::Null);
    let study = json!({ "base": submission(4.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5, 6] }] });
    let study = by(&bench, &key, "bob", &study, "/v1/studies")
        .document()
        .await;
    assert_eq!(study["submitted_by"], "bob");
    let batch = json!({ "submissions": [submission(7.0)] });
    let batch = by(&bench, &key, "ada", &batch, "/v1/jobs/batch")
        .document()
        .await;
    assert_eq!(batch["items"][0]["job"]["submitted_by"], "ada");

    // All of a client see all, whoever they are.
    let count = async |path: &str| {
        let request = bench.get(path).bearer_auth(&key);
        let list = request.header("meshwright-user", "eve").document().await;
        list["items"].as_array().unwrap().len()
    };
    assert_eq!(count("/v1/jobs").await, 6);
    assert_eq!(count("/v1/jobs?submitted_by=ada").await, 2);
    assert_eq!(count("/v1/jobs?submitted_by=bob").await, 3);
    assert_eq!(count("/v1/jobs?submitted_by=bob&study=none").await, 1);
    assert_eq!(count("/v1/jobs?submitted_by=eve").await, 0);
    assert_eq!(count("/v1/studies?submitted_by=bob").await, 1);
    assert_eq!(count("/v1/studies?submitted_by=ada").await, 0);
    let first = bench
        .get("/v1/jobs?submitted_by=ada&limit=1")
        .bearer_auth(&key);
    let first = first.answer().await;
    let next = first.headers()["link"].to_str().unwrap().to_owned();
    assert!(next.contains("submitted_by=ada"), "{next}");
}

#[tokio::test]
async fn a_user_fills_its_part_of_the_queue_of_its_client() {
    let (bench, mut engine) = Bench::steered_with(|config| {
        config.admission.client_queue_limit = Some(3);
        config.admission.user_queue_limit = Some(2);
    })
    .await;
    let key = key_of(&bench, "portal").await;
    submit(&bench, &key, "ada", 1.0).await;
    let _work = engine.next().await;
    for torque in [2.0, 3.0] {
        let taken = submit(&bench, &key, "ada", torque).await;
        assert_eq!(taken.status(), StatusCode::ACCEPTED);
    }
    let full = problem(
        submit(&bench, &key, "ada", 4.0).await,
        429,
        "client_queue_full",
    )
    .await;
    assert!(full["detail"].as_str().unwrap().contains("user"), "{full}");
    let other = submit(&bench, &key, "bob", 4.0).await;
    assert_eq!(other.status(), StatusCode::ACCEPTED);
    // The client's limit comes first.
    let full = problem(
        submit(&bench, &key, "bob", 5.0).await,
        429,
        "client_queue_full",
    )
    .await;
    assert!(!full["detail"].as_str().unwrap().contains("user"), "{full}");
    let limits = bench.document("/v1/limits").await;
    assert_eq!(limits["client"]["jobs_waiting_of_user"], 2);
}

#[tokio::test]
async fn a_name_of_a_user_is_visible_ascii_and_needs_a_key() {
    let (bench, _engine) = Bench::steered().await;
    let anybody = bench.post("/v1/jobs", &submission(1.0));
    let anybody = anybody.header("meshwright-user", "ada").document().await;
    assert_eq!(anybody["submitted_by"], Value::Null);

    let key = key_of(&bench, "portal").await;
    let longest = "u".repeat(128);
    for name in ["a", "!~", longest.as_str()] {
        let taken = submit(&bench, &key, name, 2.0).await.document().await;
        assert_eq!(taken["submitted_by"], name);
    }
    let longer = "u".repeat(129);
    let wrong = ["", "a b", "\u{e4}da", longer.as_str()];
    for name in wrong.map(|name| HeaderValue::from_bytes(name.as_bytes()).unwrap()) {
        let request = bench.post("/v1/jobs", &submission(3.0)).bearer_auth(&key);
        let answer = request.header("meshwright-user", name).answer().await;
        problem(answer, 422, "out_of_range").await;
    }
    let twice = by(&bench, &key, "ada", &submission(3.0), "/v1/jobs");
    problem(twice.header("meshwright-user", "bob"), 422, "out_of_range").await;
}

#[tokio::test]
async fn the_same_idempotency_key_of_two_users_of_a_client_is_one() {
    let (bench, _engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    let send = async |user: &str| {
        let request = by(&bench, &key, user, &submission(1.0), "/v1/jobs");
        request.header("idempotency-key", "k").document().await
    };
    let (first, second) = (send("ada").await, send("bob").await);
    assert_eq!(first["id"], second["id"]);
    assert_eq!(second["submitted_by"], "ada");
}

#[tokio::test]
async fn a_page_of_another_origin_may_name_its_user() {
    let (bench, _engine) = Bench::steered_with(|config| {
        config.cors_origin = vec!["https://portal.example".parse().unwrap()];
        config.admission.keys = Some(KeysRule::Required);
    })
    .await;
    let asked = bench
        .client
        .request(reqwest::Method::OPTIONS, bench.url("/v1/jobs"))
        .header("origin", "https://portal.example")
        .header("access-control-request-method", "POST")
        .header("access-control-request-headers", "meshwright-user")
        .answer()
        .await;
    let allowed = asked.headers()["access-control-allow-headers"].to_str();
    assert!(allowed.unwrap().contains("meshwright-user"));
}
