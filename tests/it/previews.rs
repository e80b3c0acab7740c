//! Previews: answered at once with what a job would give, replaced by newer ones, bounded, and kept by nobody.

use std::sync::{Arc, mpsc as blocking};
use std::time::Duration;

use meshwright::compute::{PreviewError, PreviewRules, Previews, Solve};
use meshwright_connections::Budget;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Preview, Problem};
use reqwest::{Response, StatusCode};
use serde_json::{Value, json};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use crate::bench::{Asked, Bench, PATIENCE, RESULTS, WAIT, problem, results, submission};
use crate::stores;

fn named(id: &str, torque: f64) -> Value {
    let mut preview = submission(torque);
    preview["preview_id"] = id.into();
    preview
}

/// Sends a preview without waiting for its answer.
fn ask(bench: &Bench, preview: &Value) -> JoinHandle<Response> {
    let request = bench.post("/v1/preview", preview);
    tokio::spawn(async move { request.answer().await })
}

async fn text(response: Response) -> String {
    assert_eq!(response.status(), StatusCode::OK);
    response.whole_text().await
}

/// An engine that obeys no stop: a computation ends when the test lets go of it.
struct Stubborn(mpsc::UnboundedReceiver<(Run, blocking::Sender<()>)>);

impl Stubborn {
    fn new() -> (Self, Solve) {
        let (begun, works) = mpsc::unbounded_channel();
        let solve: Solve = Arc::new(move |_, run| {
            let (hold, held) = blocking::channel();
            // A test that is over holds nothing.
            let _ = begun.send((run.clone(), hold));
            let _ = held.recv();
            Ok(results())
        });
        (Self(works), solve)
    }

    async fn next(&mut self) -> (Run, blocking::Sender<()>) {
        tokio::time::timeout(PATIENCE, self.0.recv())
            .await
            .expect("the engine is given work")
            .unwrap()
    }
}

#[tokio::test]
async fn a_preview_is_the_document_of_a_job_to_the_last_digit_and_is_not_kept() {
    let bench = Bench::real().await;
    let mut case = submission(115.0);
    case["resolution"] = json!({ "grid": "coarse", "positions_per_mesh_period": 8 });
    let mut preview = case.clone();
    preview["preview_id"] = "form 7".into();

    let cold = bench.post("/v1/preview", &preview).answer().await;
    let headers = cold.headers().clone();
    assert_eq!(headers["content-type"], "application/json");
    assert_eq!(headers["cache-control"], "no-store");
    let timing = headers["server-timing"].to_str().unwrap();
    let engine: f64 = timing
        .strip_prefix("engine;dur=")
        .and_then(|rest| rest.split(',').next())
        .and_then(|ms| ms.parse().ok())
        .unwrap_or_else(|| panic!("{timing}"));
    assert!(engine > 0.0);
    assert!(!headers.contains_key("etag") && !headers.contains_key("location"));
    let cold = text(cold).await;
    let warm = text(bench.post("/v1/preview", &preview).answer().await).await;

    for count in [
        "select count(*) from jobs",
        "select count(*) from documents",
    ] {
        let rows = stores::number(&bench.config.database, count).await;
        assert_eq!(rows, 0, "{count}");
    }
    let job = bench.post("/v1/jobs", &case).header("prefer", WAIT);
    let answer: Value = serde_json::from_str(&text(job.answer().await).await).unwrap();
    let path = answer["links"]["results"].as_str().unwrap();
    let job = text(bench.get(path).answer().await).await;
    assert!(cold == job && warm == job);

    let numbers = bench.get("/metrics").answer().await;
    let numbers = numbers.whole_text().await;
    for name in ["bytes", "capacity_bytes", "entries", "evictions_total"] {
        for shelf in [
            "teeth",
            "blanks",
            "gears",
            "spun",
            "flanks",
            "compliances",
            "contacts",
            "faces",
            "yields",
        ] {
            let line = format!("meshwright_cache_{name}{{shelf=\"{shelf}\"}} ");
            assert!(numbers.contains(&line), "{line} in {numbers}");
        }
    }
    // Other services of this process count into the same numbers.
    for name in ["hits", "misses"] {
        // Who finds a whole gear does not ask for its teeth.
        let line = format!("meshwright_cache_{name}_total{{shelf=\"gears\"}} ");
        let number = numbers.lines().find_map(|found| found.strip_prefix(&line));
        assert!(
            number.is_some_and(|number| number != "0"),
            "{line} in {numbers}"
        );
    }
    assert!(numbers.contains("meshwright_preview_engine_seconds_bucket"));
}

#[tokio::test]
async fn a_newer_preview_stops_the_older_one_of_its_id_and_no_other() {
    let (bench, mut engine) = Bench::steered().await;
    let [other, nameless] = [named("b", 1.0), submission(2.0)].map(|preview| ask(&bench, &preview));
    let bystanders = [engine.next().await, engine.next().await];

    let older = ask(&bench, &named("a", 3.0));
    // There are two rooms at least; whoever has them makes room.
    for work in bystanders {
        work.finish();
    }
    for answer in [other, nameless] {
        assert_eq!(text(answer.await.unwrap()).await, RESULTS);
    }
    let old_work = engine.next().await;
    let other = ask(&bench, &named("b", 4.0));
    let other_work = engine.next().await;
    let newer = ask(&bench, &named("a", 5.0));
    problem(older.await.unwrap(), 409, "preview_superseded").await;
    old_work.stopped().await;
    let new_work = engine.next().await;
    assert_eq!(new_work.submission["output_torques_n_m"], json!([5.0]));
    new_work.finish();
    assert_eq!(text(newer.await.unwrap()).await, RESULTS);
    other_work.finish();
    assert_eq!(text(other.await.unwrap()).await, RESULTS);
}

#[tokio::test]
async fn a_newer_preview_is_not_refused_while_the_older_one_winds_down() {
    let (mut engine, solve) = Stubborn::new();
    let bench = Bench::start(|config| config.previews = 1, solve).await;
    let older = ask(&bench, &named("a", 1.0));
    let (run, hold) = engine.next().await;

    let newer = ask(&bench, &named("a", 2.0));
    // It is answered although its engine still works, and the newer one has its place already.
    problem(older.await.unwrap(), 409, "preview_superseded").await;
    assert!(run.check().is_err());
    let refused = bench.post("/v1/preview", &named("b", 3.0)).send();
    problem(refused.await.unwrap(), 503, "previews_full").await;
    assert!(
        engine.0.is_empty(),
        "there is no room for the newer one yet"
    );

    drop(hold);
    drop(engine.next().await);
    assert_eq!(text(newer.await.unwrap()).await, RESULTS);
}

#[tokio::test]
async fn beyond_the_number_at_once_a_preview_is_told_to_come_again() {
    let (bench, mut engine) = Bench::steered_with(|config| config.previews = 1).await;
    let first = ask(&bench, &submission(1.0));
    let work = engine.next().await;
    let refused = bench.post("/v1/preview", &submission(2.0)).send();
    let refused = refused.await.unwrap();
    assert_eq!(refused.headers()["retry-after"], "1");
    problem(refused, 503, "previews_full").await;
    work.finish();
    text(first.await.unwrap()).await;

    let second = ask(&bench, &submission(2.0));
    engine.next().await.finish();
    text(second.await.unwrap()).await;
}

#[tokio::test]
async fn a_preview_that_is_too_large_is_sent_to_the_jobs() {
    let (bench, mut engine) = Bench::steered_with(|config| config.preview_positions = 199).await;
    let refused = bench.post("/v1/preview", &submission(115.0)).send();
    let problem = problem(refused.await.unwrap(), 422, "too_large").await;
    let error = &problem["errors"][0];
    assert_eq!(
        (&error["pointer"], &error["nearest"]),
        (
            &"/resolution/positions_per_mesh_period".into(),
            &39.0.into()
        )
    );
    assert!(
        error["detail"].as_str().unwrap().contains("POST /v1/jobs"),
        "{problem}"
    );
    assert!(engine.is_idle());
    let limits: Value = bench.document("/v1/limits").await;
    assert_eq!(
        limits["previews"],
        json!({ "positions": 199, "at_once": 4, "time_limit_seconds": 60 })
    );
    assert_eq!(limits["positions"], 20_000);
}

#[tokio::test]
async fn a_client_that_goes_away_stops_its_preview_and_leaves_its_place() {
    let (bench, mut engine) = Bench::steered_with(|config| config.previews = 1).await;
    let gone = ask(&bench, &submission(1.0));
    let work = engine.next().await;
    gone.abort();
    work.stopped().await;

    let next = ask(&bench, &submission(2.0));
    engine.next().await.finish();
    text(next.await.unwrap()).await;
}

#[tokio::test]
async fn unknown_fields_and_ids_that_are_none_are_refused_at_their_place() {
    let (bench, mut engine) = Bench::steered().await;
    let long = "a".repeat(65);
    for (id, code) in [
        (json!(""), "out_of_range"),
        (json!(long), "out_of_range"),
        (json!("a\u{7}"), "out_of_range"),
        (json!(7), "wrong_type"),
    ] {
        let mut preview = submission(1.0);
        preview["preview_id"] = id;
        let refused = bench.post("/v1/preview", &preview).answer().await;
        let problem = problem(refused, 422, code).await;
        assert_eq!(problem["errors"][0]["pointer"], "/preview_id");
    }
    let mut preview = named("a", 1.0);
    preview["pair"]["driven"]["blank"]["hole"] = json!({});
    let refused = bench.post("/v1/preview", &preview).answer().await;
    let unknown = problem(refused, 422, "unknown_field").await;
    assert_eq!(unknown["errors"][0]["pointer"], "/pair/driven/blank/hole");
    let refused = bench.post("/v1/jobs", &named("a", 1.0)).send();
    let unknown = problem(refused.await.unwrap(), 422, "unknown_field").await;
    assert_eq!(unknown["errors"][0]["pointer"], "/preview_id");
    assert!(engine.is_idle());
}

#[tokio::test]
async fn what_the_engine_cannot_do_ends_one_preview() {
    let (bench, mut engine) = Bench::steered_with(|config| config.previews = 1).await;
    let answer = ask(&bench, &submission(1.0));
    engine.next().await.panic();
    problem(answer.await.unwrap(), 500, "internal_error").await;
    let answer = ask(&bench, &submission(1.0));
    let not_converged = Problem::new(Code::NotConverged, "a gap was left");
    engine.next().await.fail(not_converged);
    problem(answer.await.unwrap(), 422, "not_converged").await;
    let answer = ask(&bench, &submission(1.0));
    engine.next().await.finish();
    text(answer.await.unwrap()).await;
}

#[tokio::test]
async fn a_shutdown_stops_previews() {
    let (mut bench, mut engine) = Bench::steered().await;
    let answer = ask(&bench, &submission(1.0));
    let work = engine.next().await;
    bench.shut_down().await;
    let answer = answer.await.unwrap();
    assert!(answer.headers().contains_key("retry-after"));
    problem(answer, 503, "unavailable").await;
    work.stopped().await;
}

/// Previews without a service around them, for what a test cannot say over HTTP.
fn previews(solve: Solve, time_limit: Duration) -> Previews {
    let rules = PreviewRules {
        at_once: 2,
        most_positions: 4000,
        time_limit,
    };
    Previews::new(solve, rules, Budget::of(4096), CancellationToken::new()).unwrap()
}

fn parsed(preview: &Value) -> Preview {
    Preview::parse(preview.to_string().as_bytes(), 4000).unwrap()
}

#[tokio::test]
async fn an_id_belongs_to_its_client() {
    let (mut engine, solve) = Stubborn::new();
    let previews = previews(solve, PATIENCE);
    let ask = |client: &'static str| {
        let previews = previews.clone();
        tokio::spawn(async move { previews.compute(client, parsed(&named("a", 1.0))).await })
    };
    let (one, other) = (ask("one"), ask("other"));
    let works = [engine.next().await, engine.next().await];
    assert!(works.iter().all(|(run, _)| run.check().is_ok()));
    drop(works);
    for answer in [one, other] {
        assert_eq!(answer.await.unwrap().unwrap().document, RESULTS);
    }
    assert_eq!(previews.count(), 0);
}

#[tokio::test]
async fn a_preview_that_takes_longer_than_the_limit_is_stopped() {
    let (mut engine, solve) = Stubborn::new();
    let limit = Duration::from_millis(20);
    let previews = previews(solve, limit);
    let late = previews.compute("one", parsed(&submission(1.0))).await;
    assert_eq!(late, Err(PreviewError::TimeLimit(limit)));
    let (run, _hold) = engine.next().await;
    assert!(run.check().is_err());
}

#[tokio::test]
async fn as_many_previews_of_one_client_as_there_are_places_do_not_shut_another_one_out() {
    let (mut engine, solve) = Stubborn::new();
    let previews = previews(solve, PATIENCE);
    let ask = |client: &'static str, number: usize| {
        let (previews, preview) = (previews.clone(), parsed(&named(&number.to_string(), 1.0)));
        tokio::spawn(async move { previews.compute(client, preview).await })
    };
    let most = previews.rules().at_once;
    let mut hogs = Vec::new();
    for number in 0..most {
        hogs.push(ask("hog", number));
        while previews.count() <= number {
            tokio::task::yield_now().await;
        }
    }
    // One more of the same is too many.
    assert_eq!(
        ask("hog", most).await.unwrap(),
        Err(PreviewError::Full(most))
    );
    let other = ask("other", 0);
    // The newest one of the crowd gives its place up; the others are computed, and the other client's is next.
    let newest = hogs.pop().unwrap();
    assert_eq!(newest.await.unwrap(), Err(PreviewError::Full(most)));
    let release = async {
        loop {
            drop(engine.next().await);
        }
    };
    tokio::select! {
        () = release => {}
        answer = other => assert_eq!(answer.unwrap().unwrap().document, RESULTS),
    }
    for hog in hogs {
        drop(engine.0.try_recv());
        hog.abort();
    }
}

#[tokio::test]
async fn a_preview_that_is_estimated_above_the_limit_is_refused_before_it_starts() {
    let (bench, mut engine) = Bench::steered_with(|config| {
        config.preview_time_limit_seconds = 1;
        config.memory_mb = Some(16_000);
        config.job_memory_mb = 8000;
    })
    .await;
    let mut long = submission(115.0);
    long["method"] = json!("three_dimensional");
    let foreseen = bench.post("/v1/validate", &long).document().await;
    let seconds = foreseen["estimate"]["seconds"].as_f64().unwrap();
    assert!(seconds > 1.0, "{seconds}");
    let refused = problem(bench.post("/v1/preview", &long), 422, "too_large").await;
    let detail = refused["detail"].as_str().unwrap();
    assert!(
        detail.contains(&format!("{seconds:.1} s")) && detail.contains("1 s here"),
        "{detail}"
    );
    assert!(engine.is_idle());
}

#[tokio::test]
async fn a_preview_that_is_not_computed_in_the_time_that_was_expected_may_be_sent_again() {
    let (bench, mut engine) =
        Bench::steered_with(|config| config.preview_time_limit_seconds = 1).await;
    let asked = ask(&bench, &submission(115.0));
    let work = engine.next().await;
    let late = asked.await.unwrap();
    assert_eq!(late.headers()["retry-after"], "5");
    problem(late, 503, "preview_time_limit").await;
    work.stopped().await;
}
