//! Links to results for somebody without a key: what they open, what they do not, and when they end.

use jiff::{SignedDuration, Timestamp};
use meshwright::jobs::{Clock, Role, Store};
use reqwest::{Response, StatusCode};
use serde_json::{Value, json};

use crate::admission::{key_of, make_key};
use crate::bench::{Asked, Bench, RESULTS, WAIT, problem, submission};

fn hours(hours: i64) -> String {
    (Timestamp::now() + SignedDuration::from_hours(hours)).to_string()
}

async fn done(bench: &Bench, key: &str) -> String {
    let job = bench.post("/v1/jobs", &submission(115.0)).bearer_auth(key);
    let job = job.header("prefer", WAIT).document().await;
    assert_eq!(job["status"], "successful");
    job["links"]["self"].as_str().unwrap().to_owned()
}

async fn share(bench: &Bench, key: &str, job: &str, ends_at: &str) -> Response {
    let request = bench.post(&format!("{job}/shares"), &json!({ "ends_at": ends_at }));
    request.bearer_auth(key).answer().await
}

/// A link to the results of a job, open for an hour: its id and its path.
async fn link(bench: &Bench, key: &str, job: &str) -> (String, String) {
    let made = share(bench, key, job, &hours(1)).await;
    assert_eq!(made.status(), StatusCode::CREATED);
    let made = made.document().await;
    let text = |name: &str| made[name].as_str().unwrap().to_owned();
    (text("id"), text("url"))
}

async fn is_unknown(bench: &Bench, url: &str) {
    for path in [
        url.to_owned(),
        format!("{url}/results"),
        format!("{url}/results/ste.svg"),
    ] {
        problem(bench.get(&path), 404, "not_found").await;
    }
}

#[tokio::test]
async fn somebody_without_a_key_reads_shared_results_and_nothing_else() {
    let bench = Bench::quick().await;
    let key = key_of(&bench, "portal").await;
    let job = done(&bench, &key).await;
    let (_, url) = link(&bench, &key, &job).await;
    let secret = url.rsplit('/').next().unwrap();
    assert_eq!(secret.strip_prefix("mws_").unwrap().len(), 64, "256 bits");

    let results = bench.get(&format!("{url}/results")).answer().await;
    assert_eq!(results.headers()["cache-control"], "no-store");
    assert_eq!(results.headers()["referrer-policy"], "no-referrer");
    assert!(!results.headers().contains_key("content-location"));
    assert_eq!(results.whole_text().await, RESULTS);
    for file in ["ste.csv", "ste.json", "ste.svg", "mesh-stiffness.svg"] {
        let answer = bench.get(&format!("{url}/results/{file}")).answer().await;
        assert_eq!(answer.status(), StatusCode::OK, "{file}");
        assert_eq!(answer.headers()["cache-control"], "no-store", "{file}");
        let own = bench
            .get(&format!("{job}/results/{file}"))
            .bearer_auth(&key);
        assert_eq!(answer.whole_text().await, own.whole_text().await);
    }
    let page = bench.get(&url).answer().await;
    assert_eq!(page.headers()["cache-control"], "no-store");
    assert_eq!(page.headers()["x-robots-tag"], "noindex");
    let policy = page.headers()["content-security-policy"].to_str().unwrap();
    assert!(policy.contains("default-src 'none'") && policy.contains("img-src 'self'"));
    let page = page.whole_text().await;
    assert!(!page.contains("<script") && !page.contains(job.rsplit('/').next().unwrap()));
    // Each picture and file of the page is there, beside its address.
    let base = reqwest::Url::parse(&bench.url(&url)).unwrap();
    let mut linked = 0;
    for part in page.split(['"']).filter(|part| part.starts_with(secret)) {
        let answer = bench.client.get(base.join(part).unwrap()).answer().await;
        assert!([200, 404].contains(&answer.status().as_u16()), "{part}");
        linked += 1;
    }
    assert!(linked >= 6, "{page}");

    for path in [
        "submission",
        "submission.rexs",
        "events",
        "shares",
        "results/fields.vtu",
        "results/modes/1.vtu",
        "results/edges.json",
        "results/contact-pattern.svg",
    ] {
        let answer = bench.get(&format!("{url}/{path}")).answer().await;
        assert_eq!(answer.status(), StatusCode::NOT_FOUND, "{path}");
    }
    // The secret is no key.
    for bearer in [secret, &url] {
        problem(bench.get(&job).bearer_auth(bearer), 401, "unauthorized").await;
    }
    let changed = bench.delete(&url).answer().await;
    assert_eq!(changed.status(), StatusCode::METHOD_NOT_ALLOWED);
}

#[tokio::test]
async fn a_link_ends_by_itself_when_it_is_ended_with_its_job_and_with_its_key() {
    let mut bench = Bench::quick().await;
    let (key, other) = (
        key_of(&bench, "portal").await,
        key_of(&bench, "portal").await,
    );
    let stranger = key_of(&bench, "lab").await;
    let job = done(&bench, &key).await;
    let (id, ended) = link(&bench, &key, &job).await;
    let (_, of_other) = link(&bench, &other, &job).await;
    let (_, stays) = link(&bench, &key, &job).await;

    let listed = bench
        .get(&format!("{job}/shares"))
        .bearer_auth(&key)
        .document()
        .await;
    assert_eq!(listed["items"].as_array().unwrap().len(), 3);
    assert_eq!(listed["items"][0]["id"], id.as_str());
    assert!(listed["items"][0].get("url").is_none(), "it is told once");
    assert!(!listed.to_string().contains("mws_"));
    let share = format!("/v1/shares/{id}");
    problem(
        bench.delete(&share).bearer_auth(&stranger),
        404,
        "not_found",
    )
    .await;
    let gone = bench.delete(&share).bearer_auth(&other).answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    problem(bench.delete(&share).bearer_auth(&key), 404, "not_found").await;
    is_unknown(&bench, &ended).await;

    // With the key that made it, and with no other one.
    let store = Store::open(&bench.config.database).await.unwrap();
    let id = other.split('_').nth(1).unwrap();
    assert!(store.revoke_key(id, Timestamp::now()).await.unwrap());
    store.close().await;
    is_unknown(&bench, &of_other).await;
    assert_eq!(bench.get(&stays).answer().await.status(), StatusCode::OK);

    let second = bench.post("/v1/jobs", &submission(20.0)).bearer_auth(&key);
    let second = second.header("prefer", WAIT).document().await;
    let second = second["links"]["self"].as_str().unwrap();
    let (_, of_second) = link(&bench, &key, second).await;
    let gone = bench.delete(second).bearer_auth(&key).answer().await;
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    is_unknown(&bench, &of_second).await;

    let later = Timestamp::now() + SignedDuration::from_hours(2);
    bench.shut_down().await;
    bench.clock = Clock::given(move || later, Timestamp::now);
    bench.start_again().await;
    is_unknown(&bench, &stays).await;
    let listed = bench
        .get(&format!("{job}/shares"))
        .bearer_auth(&key)
        .document()
        .await;
    assert_eq!(listed["items"], json!([]));
    let unknown = format!("/shared/mws_{}", "0".repeat(64));
    is_unknown(&bench, &unknown).await;
    is_unknown(&bench, "/shared/x").await;
}

#[tokio::test]
async fn a_link_is_made_by_who_may_change_something_and_within_bounds() {
    let bench = Bench::quick().await;
    let key = key_of(&bench, "portal").await;
    let reader = make_key(&bench, "portal", Role::Reader, |_| {}).await;
    let job = done(&bench, &key).await;
    problem(
        share(&bench, &reader, &job, &hours(1)).await,
        403,
        "forbidden",
    )
    .await;
    let stranger = key_of(&bench, "lab").await;
    problem(
        share(&bench, &stranger, &job, &hours(1)).await,
        404,
        "job_not_found",
    )
    .await;
    for ends_at in [hours(-1), hours(24 * 90 + 1)] {
        let refused = problem(
            share(&bench, &key, &job, &ends_at).await,
            422,
            "out_of_range",
        )
        .await;
        assert_eq!(refused["errors"][0]["pointer"], "/ends_at");
    }
    let refused = problem(
        share(&bench, &key, &job, "tomorrow").await,
        422,
        "wrong_type",
    )
    .await;
    assert_eq!(refused["errors"][0]["pointer"], "/ends_at");
    for _ in 0..20 {
        let made = share(&bench, &key, &job, &hours(24 * 89)).await;
        assert_eq!(made.status(), StatusCode::CREATED);
    }
    problem(share(&bench, &key, &job, &hours(1)).await, 422, "too_large").await;
    let limits = bench.document("/v1/limits").await;
    assert_eq!(limits["client"]["shares_of_job"], 20);
    assert_eq!(limits["client"]["share_days"], 90);
}

#[tokio::test]
async fn a_link_is_asked_for_no_more_often_than_it_may() {
    let bench = Bench::quick().await;
    let key = key_of(&bench, "portal").await;
    let job = done(&bench, &key).await;
    let (_, url) = link(&bench, &key, &job).await;
    // Three times as many at once as a link has room for.
    let asked = (0..120).map(|_| bench.get(&url).answer());
    let answers = futures_util::future::join_all(asked).await;
    let refused = answers
        .into_iter()
        .find(|answer| answer.status() != StatusCode::OK);
    let refused = refused.expect("so many at once are too many");
    assert!(refused.headers().contains_key("retry-after"));
    problem(refused, 429, "rate_limited").await;
}

#[tokio::test]
async fn without_a_result_a_link_says_so() {
    let (bench, _engine) = Bench::steered().await;
    let key = key_of(&bench, "portal").await;
    let job = bench.post("/v1/jobs", &submission(1.0)).bearer_auth(&key);
    let job = job.document().await;
    let (_, url) = link(&bench, &key, job["links"]["self"].as_str().unwrap()).await;
    problem(
        bench.get(&format!("{url}/results")),
        404,
        "result_not_ready",
    )
    .await;
    let page = bench.get(&url).whole_text().await;
    assert!(
        page.contains("the job is ") && !page.contains("<img"),
        "{page}"
    );
    let none: Value = bench.document("/v1/jobs").await;
    assert_eq!(none["code"], "unauthorized");
}
