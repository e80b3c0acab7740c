//! Projects: documents that a client keeps, two writers of one, and what no client does to those of another.

use jiff::{SignedDuration, Timestamp};
use meshwright::jobs::{Clock, Role, Store};
use reqwest::{RequestBuilder, Response, StatusCode};
use serde_json::{Value, json};

use crate::admission::{key_of, make_key};
use crate::bench::{Asked, Bench, problem};

const PROJECTS: &str = "/v1/projects";

fn document(note: &str) -> Value {
    json!({ "version": 1, "note": note })
}

fn project(name: &str, note: &str) -> Value {
    json!({ "name": name, "document": document(note) })
}

fn put(bench: &Bench, path: &str, project: &Value) -> RequestBuilder {
    bench.client.put(bench.url(path)).json(project)
}

fn tag(answer: &Response) -> String {
    answer.headers()["etag"].to_str().unwrap().to_owned()
}

/// Keeps a project and gives its address and tag.
async fn kept(bench: &Bench, project: &Value) -> (String, String) {
    let made = bench.post(PROJECTS, project).answer().await;
    assert_eq!(made.status(), StatusCode::CREATED);
    let address = made.headers()["location"].to_str().unwrap().to_owned();
    let tag = tag(&made);
    let view = made.document().await;
    assert_eq!(view["links"]["self"], address);
    assert!(view.get("document").is_none(), "who sends it has it");
    (address, tag)
}

#[tokio::test]
async fn a_project_is_kept_listed_read_changed_and_deleted_and_outlives_the_process() {
    let mut bench = Bench::quick().await;
    let (first, made) = kept(&bench, &project("First", "a")).await;
    let (second, _) = kept(&bench, &project("<b>Second</b> & \"third\"", "b")).await;

    let listed = bench.document(PROJECTS).await;
    assert_eq!(listed["next"], Value::Null);
    let names: Vec<&Value> = listed["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|item| &item["name"])
        .collect();
    assert_eq!(
        names,
        ["<b>Second</b> & \"third\"", "First"],
        "newest first"
    );
    let item = &listed["items"][1];
    assert!(item.get("document").is_none());
    assert_eq!(item["bytes"], document("a").to_string().len());

    bench.shut_down().await;
    bench.start_again().await;
    let read = bench.get(&first).answer().await;
    assert_eq!(tag(&read), made);
    let read = read.document().await;
    assert_eq!(read["document"], document("a"));
    assert_eq!(read["name"], "First");
    let same = bench.get(&first).header("if-none-match", &made);
    assert_eq!(same.answer().await.status(), StatusCode::NOT_MODIFIED);

    let changed = put(&bench, &first, &project("Renamed", "c")).header("if-match", &made);
    let changed = changed.answer().await;
    assert_eq!(changed.status(), StatusCode::OK);
    let later = tag(&changed);
    assert_ne!(later, made);
    let changed = changed.document().await;
    assert_eq!(
        (&changed["id"], &changed["name"]),
        (&read["id"], &json!("Renamed"))
    );
    assert!(changed["updated_at"].as_str() >= read["updated_at"].as_str());
    let read = bench.document(&first).await;
    assert_eq!(read["document"], document("c"));

    let gone = bench
        .delete(&first)
        .header("if-match", &later)
        .answer()
        .await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    problem(bench.get(&first), 404, "project_not_found").await;
    problem(bench.get("/v1/projects/x"), 404, "project_not_found").await;
    let listed = bench.document(PROJECTS).await;
    assert_eq!(listed["items"][0]["links"]["self"], second);
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn of_two_writers_the_second_is_refused_and_nothing_of_the_first_is_lost() {
    let bench = Bench::quick().await;
    let (path, made) = kept(&bench, &project("Shared", "a")).await;
    // Both have read the same.
    let first = put(&bench, &path, &project("Shared", "of the first"));
    let first = first.header("if-match", &made).answer().await;
    assert_eq!(first.status(), StatusCode::OK);
    let now = tag(&first);
    let second = project("Shared", "of the second");
    for stale in [&*made, "W/\"x\"", &format!("W/{now}"), "\"\""] {
        let change = put(&bench, &path, &second).header("if-match", stale);
        problem(change, 412, "precondition_failed").await;
        let deletion = bench.delete(&path).header("if-match", stale);
        problem(deletion, 412, "precondition_failed").await;
    }
    problem(put(&bench, &path, &second), 428, "precondition_required").await;
    problem(bench.delete(&path), 428, "precondition_required").await;
    assert_eq!(
        bench.document(&path).await["document"],
        document("of the first")
    );

    // One that changes without a change by another: ten at once, of which one is first.
    let changes = (0..10).map(|writer| {
        let change = project("Shared", &format!("of writer {writer}"));
        put(&bench, &path, &change)
            .header("if-match", &now)
            .answer()
    });
    let statuses = futures_util::future::join_all(changes).await;
    let done = statuses.iter().filter(|it| it.status() == StatusCode::OK);
    assert_eq!(done.count(), 1);
    let gone = bench.delete(&path).header("if-match", "*").answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    let change = put(&bench, &path, &second).header("if-match", "*");
    problem(change, 404, "project_not_found").await;
}

#[tokio::test]
async fn who_reads_a_packed_answer_changes_the_project_by_its_tag() {
    let bench = Bench::quick().await;
    let (path, _) = kept(&bench, &project("Packed", &"note ".repeat(2_000))).await;
    // As a browser asks.
    let read = bench.get(&path).header("accept-encoding", "gzip");
    let packed = tag(&read.answer().await);
    assert!(packed.ends_with("-gzip\""), "{packed}");
    let changed = put(&bench, &path, &project("Packed", "b")).header("if-match", packed);
    assert_eq!(changed.answer().await.status(), StatusCode::OK);
}

#[tokio::test]
async fn a_project_belongs_to_its_client_and_a_key_that_only_reads_changes_none() {
    let bench = Bench::quick().await;
    let open = kept(&bench, &project("From before there were keys", "a"))
        .await
        .0;
    let key = key_of(&bench, "portal").await;
    let reader = make_key(&bench, "portal", Role::Reader, |_| {}).await;
    let other = key_of(&bench, "portal").await;
    let stranger = key_of(&bench, "lab").await;
    let administrator = make_key(&bench, "operations", Role::Administrator, |_| {}).await;
    let made = bench.post(PROJECTS, &project("Own", "a")).bearer_auth(&key);
    let made = made.header("meshwright-user", "ada").answer().await;
    assert_eq!(made.status(), StatusCode::CREATED);
    let (path, made) = (
        made.headers()["location"].to_str().unwrap().to_owned(),
        tag(&made),
    );

    problem(bench.get(PROJECTS), 401, "unauthorized").await;
    for foreign in [&stranger, &administrator] {
        problem(
            bench.get(&path).bearer_auth(foreign),
            404,
            "project_not_found",
        )
        .await;
        let change = put(&bench, &path, &project("Own", "b")).header("if-match", &made);
        problem(change.bearer_auth(foreign), 404, "project_not_found").await;
        let deletion = bench.delete(&path).header("if-match", "*");
        problem(deletion.bearer_auth(foreign), 404, "project_not_found").await;
        let listed = bench.get(PROJECTS).bearer_auth(foreign).document().await;
        assert_eq!(listed["items"], json!([]));
    }
    problem(bench.get(&open).bearer_auth(&key), 404, "project_not_found").await;

    let read = bench.get(&path).bearer_auth(&reader).document().await;
    assert_eq!(read["document"], document("a"));
    let change = put(&bench, &path, &project("Own", "b")).header("if-match", &made);
    problem(change.bearer_auth(&reader), 403, "forbidden").await;
    let deletion = bench.delete(&path).header("if-match", &made);
    problem(deletion.bearer_auth(&reader), 403, "forbidden").await;
    let another = bench.post(PROJECTS, &project("Another", "b"));
    problem(another.bearer_auth(&reader), 403, "forbidden").await;

    // Its bytes are counted, also for who has no jobs.
    let usage = bench
        .get("/v1/usage")
        .bearer_auth(&administrator)
        .document()
        .await;
    let clients = usage["clients"].as_array().unwrap();
    let names: Vec<&Value> = clients.iter().map(|client| &client["client"]).collect();
    assert_eq!(names, ["anonymous", "portal"]);
    let bytes = document("a").to_string().len();
    assert_eq!(clients[1]["users"][0]["user"], "ada");
    assert_eq!(clients[1]["users"][0]["bytes_kept"], bytes);
    assert!(!usage.to_string().contains("note"));

    // It outlives the key that made it.
    let store = Store::open(&bench.config.database).await.unwrap();
    let id = key.split('_').nth(1).unwrap();
    assert!(store.revoke_key(id, Timestamp::now()).await.unwrap());
    store.close().await;
    problem(bench.get(&path).bearer_auth(&key), 401, "unauthorized").await;
    let read = bench.get(&path).bearer_auth(&other).document().await;
    assert_eq!(read["name"], "Own");
}

#[tokio::test]
async fn a_project_keeps_the_bounds_that_the_limits_tell() {
    let bench = Bench::quick().await;
    let limits = bench.document("/v1/limits").await;
    let most = limits["client"]["project_bytes"].as_u64().unwrap();
    assert_eq!(
        (most, &limits["client"]["projects"]),
        (1_000_000, &json!(200))
    );
    let around = document("").to_string().len();
    let of_bytes = |bytes: u64| project("Large", &"a".repeat(bytes as usize - around));
    let (path, made) = kept(&bench, &of_bytes(most)).await;
    assert_eq!(bench.document(&path).await["bytes"], most);
    let refused = problem(bench.post(PROJECTS, &of_bytes(most + 1)), 422, "too_large").await;
    assert_eq!(refused["errors"][0]["pointer"], "/document");
    assert_eq!(refused["errors"][0]["nearest"], 1e6);
    let change = put(&bench, &path, &of_bytes(most + 1)).header("if-match", made);
    problem(change, 422, "too_large").await;
    let huge = bench.post(PROJECTS, &of_bytes(3 * most));
    problem(huge, 413, "payload_too_large").await;

    for name in ["", " ", "line\nbreak", "nul\0", &"n".repeat(201)] {
        let refused = problem(
            bench.post(PROJECTS, &project(name, "")),
            422,
            "out_of_range",
        )
        .await;
        assert_eq!(refused["errors"][0]["pointer"], "/name");
    }
    kept(&bench, &project(&"ü".repeat(200), "")).await;
    for (body, pointer, code) in [
        ("{\"name\": \"a\"}", "/document", "missing_field"),
        (
            "{\"name\": \"a\", \"document\": {}, \"x\": 1}",
            "/x",
            "unknown_field",
        ),
        ("{\"name\": 5, \"document\": {}}", "/name", "wrong_type"),
        ("[\"a\", {}]", "", "wrong_type"),
    ] {
        let request = bench
            .send(PROJECTS)
            .header("content-type", "application/json");
        let refused = problem(request.body(body), 422, code).await;
        assert_eq!(refused["errors"][0]["pointer"], pointer, "{body}");
    }
    let request = bench
        .send(PROJECTS)
        .header("content-type", "application/json");
    let broken = request.body("{\"name\": \"a\", \"document\": {");
    problem(broken, 400, "malformed_json").await;
    for number in 2..200 {
        kept(&bench, &project(&number.to_string(), "")).await;
    }
    problem(
        bench.post(PROJECTS, &project("One more", "")),
        422,
        "too_large",
    )
    .await;

    // Page by page.
    let (mut seen, mut path) = (0, format!("{PROJECTS}?limit=80"));
    loop {
        let page = bench.document(&path).await;
        seen += page["items"].as_array().unwrap().len();
        let Some(next) = page["next"].as_str() else {
            break;
        };
        path = format!("{PROJECTS}?limit=80&cursor={next}");
    }
    assert_eq!(seen, 200);
}

#[tokio::test]
async fn a_project_is_made_once_however_often_it_is_sent_under_one_key() {
    let mut bench = Bench::quick().await;
    let send = async |bench: &Bench, note: &str| {
        let request = bench.post(PROJECTS, &project("Once", note));
        request.header("idempotency-key", "once").answer().await
    };
    let first = send(&bench, "a").await;
    assert_eq!(first.status(), StatusCode::CREATED);
    let made = tag(&first);
    let first = first.document().await;
    let path = first["links"]["self"].as_str().unwrap();
    let changed = put(&bench, path, &project("Twice", "b")).header("if-match", made);
    let now = tag(&changed.answer().await);
    let again = send(&bench, "a").await;
    assert_eq!(again.status(), StatusCode::OK);
    assert_eq!(tag(&again), now, "as it stands now");
    assert_eq!(again.document().await["id"], first["id"]);
    problem(send(&bench, "other").await, 422, "idempotency_conflict").await;

    bench.shut_down().await;
    let later = Timestamp::now() + SignedDuration::from_hours(25);
    bench.clock = Clock::given(move || later, Timestamp::now);
    bench.start_again().await;
    let another = send(&bench, "other").await;
    assert_eq!(another.status(), StatusCode::CREATED);
    assert_ne!(another.document().await["id"], first["id"]);
}
