//! What an administrator sees of the service, and what it may end; and what is told to those whom it concerns.

use meshwright::jobs::Role;
use reqwest::{Response, StatusCode};
use serde_json::{Value, json};

use crate::admission::{key_of, make_key};
use crate::bench::{Asked, Bench, Events, WAIT, problem, submission};

async fn administrator(bench: &Bench) -> String {
    make_key(bench, "operations", Role::Administrator, |_| {}).await
}

async fn get(bench: &Bench, path: &str, key: &str) -> Response {
    bench.get(path).bearer_auth(key).answer().await
}

async fn submit(bench: &Bench, key: &str, user: &str, torque: f64) -> Value {
    let request = bench.post("/v1/jobs", &submission(torque)).bearer_auth(key);
    request.header("meshwright-user", user).document().await
}

#[tokio::test]
async fn an_administrator_sees_who_fills_the_queue_and_no_submission() {
    let (bench, mut engine) = Bench::steered().await;
    let (portal, lab) = (key_of(&bench, "portal").await, key_of(&bench, "lab").await);
    let key = administrator(&bench).await;
    let done = submit(&bench, &portal, "ada", 1.0).await;
    engine.next().await.finish();
    let path = done["links"]["self"].as_str().unwrap();
    let ended = bench.get(path).bearer_auth(&portal);
    let ended = ended.header("prefer", WAIT).document().await;
    assert_eq!(ended["status"], "successful");
    let runs = submit(&bench, &portal, "ada", 2.0).await;
    let _running = engine.next().await;
    let waits = submit(&bench, &portal, "bob", 3.0).await;
    let study = json!({ "base": submission(4.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5, 6] }] });
    let study = bench.post("/v1/studies", &study).bearer_auth(&lab);
    let study = study.document().await;

    let answer = get(&bench, "/v1/usage", &key).await;
    assert_eq!(answer.headers()["cache-control"], "no-store");
    let usage = answer.document().await;
    assert_eq!(usage["next"], Value::Null);
    let of = |client: &str, user: Value| {
        let clients = usage["clients"].as_array().unwrap();
        let client = clients.iter().find(|it| it["client"] == client).unwrap();
        let mut users = client["users"].as_array().unwrap().iter();
        users.find(|it| it["user"] == user).unwrap().clone()
    };
    let ada = of("portal", json!("ada"));
    assert_eq!(
        [
            &ada["waiting"],
            &ada["running"],
            &ada["done_last_hour"],
            &ada["done_last_day"]
        ],
        [0, 1, 1, 1]
    );
    assert_eq!(ada["jobs"], json!([runs["id"]]));
    assert!(ada["bytes_kept"].as_u64().unwrap() > 0);
    let bob = of("portal", json!("bob"));
    assert_eq!(
        (&bob["waiting"], &bob["bytes_kept"]),
        (&json!(1), &json!(0))
    );
    assert_eq!(bob["jobs"], json!([waits["id"]]));
    let nobody = of("lab", Value::Null);
    assert_eq!(
        (&nobody["waiting"], &nobody["jobs"]),
        (&json!(2), &json!([]))
    );
    assert_eq!(nobody["studies"], json!([study["id"]]));
    assert!(!usage.to_string().contains("tooth_count"));

    // Page by page, by the names of clients.
    let first = get(&bench, "/v1/usage?limit=1", &key)
        .await
        .document()
        .await;
    assert_eq!(
        (&first["clients"][0]["client"], &first["next"]),
        (&json!("lab"), &json!("lab"))
    );
    let second = get(&bench, "/v1/usage?limit=1&cursor=lab", &key)
        .await
        .document()
        .await;
    assert_eq!(
        (&second["clients"][0]["client"], &second["next"]),
        (&json!("portal"), &Value::Null)
    );
    // It reads nothing of others.
    for path in [path, study["links"]["self"].as_str().unwrap()] {
        assert_eq!(
            get(&bench, path, &key).await.status(),
            StatusCode::NOT_FOUND
        );
    }
}

#[tokio::test]
async fn nobody_else_sees_who_uses_the_service() {
    let bench = Bench::quick().await;
    // Without keys everybody is alike, and nobody an administrator.
    problem(bench.get("/v1/usage"), 403, "forbidden").await;
    for role in [Role::Client, Role::Reader, Role::Operator] {
        let key = make_key(&bench, "portal", role, |_| {}).await;
        problem(get(&bench, "/v1/usage", &key).await, 403, "forbidden").await;
    }
    let key = administrator(&bench).await;
    // Nor does it gain what Prometheus has.
    problem(get(&bench, "/metrics", &key).await, 403, "forbidden").await;
}

#[tokio::test]
async fn an_administrator_ends_what_others_have_submitted_and_they_are_told() {
    let (bench, mut engine) = Bench::steered().await;
    let portal = key_of(&bench, "portal").await;
    let key = administrator(&bench).await;
    let runs = submit(&bench, &portal, "ada", 1.0).await;
    let work = engine.next().await;
    let path = runs["links"]["self"].as_str().unwrap().to_owned();
    let mut events = Events::with(&bench, &path, |request| request.bearer_auth(&portal)).await;
    assert_eq!(events.next().await.unwrap().1["status"], "running");
    // Another client's key and an operator's end nothing.
    for role in [Role::Client, Role::Operator] {
        let other = make_key(&bench, "other", role, |_| {}).await;
        problem(bench.cancel(&path).bearer_auth(other), 404, "job_not_found").await;
    }
    problem(bench.delete(&path).bearer_auth(&key), 409, "job_running").await;
    let cancelled = bench.cancel(&path).bearer_auth(&key).answer().await;
    assert_eq!(cancelled.status(), StatusCode::ACCEPTED);
    work.stopped().await;
    let told = loop {
        let (name, data) = events.next().await.expect("the end is told");
        if name == "status" {
            break data;
        }
    };
    assert_eq!(
        (&told["status"], &told["dismissed_by"]),
        (&json!("dismissed"), &json!("administrator"))
    );
    // What its owner ends says nothing of an administrator.
    let own = submit(&bench, &portal, "ada", 2.0).await;
    let own = bench
        .cancel(own["links"]["self"].as_str().unwrap())
        .bearer_auth(&portal);
    assert!(own.document().await.get("dismissed_by").is_none());

    let gone = bench.delete(&path).bearer_auth(&key).answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    problem(get(&bench, &path, &portal).await, 404, "job_not_found").await;
    problem(bench.delete(&path).bearer_auth(&key), 404, "job_not_found").await;

    let study = json!({ "base": submission(4.0), "axes": [{ "path": "/output_torques_n_m/0", "values": [5, 6] }] });
    let study = bench
        .post("/v1/studies", &study)
        .bearer_auth(&portal)
        .document()
        .await;
    let path = study["links"]["self"].as_str().unwrap();
    let cancelled = bench.cancel(path).bearer_auth(&key).document().await;
    assert_eq!(
        (&cancelled["status"], &cancelled["dismissed_by"]),
        (&json!("dismissed"), &json!("administrator"))
    );
    let gone = bench.delete(path).bearer_auth(&key).answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
}
