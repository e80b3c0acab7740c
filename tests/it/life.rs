//! A job from submission to end, and the ways to end it early.

use std::sync::Arc;

use meshwright::compute::Solve;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem, Submission};
use reqwest::StatusCode;
use serde_json::{Value, json};

use crate::bench::{Asked, Bench, RESULTS, WAIT, problem, results, submission};

#[tokio::test]
async fn a_job_goes_from_submission_over_progress_to_the_very_text_of_its_results() {
    let (bench, mut engine) = Bench::steered().await;
    let response = bench.post("/v1/jobs", &submission(115.0)).answer().await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    assert!(response.headers().contains_key("retry-after"));
    let path = response.headers()["location"].to_str().unwrap().to_owned();
    let accepted = response.document().await;
    assert_eq!(
        path,
        format!("/v1/jobs/{}", accepted["id"].as_str().unwrap())
    );
    assert_eq!(accepted["status"], "accepted");
    assert_eq!(accepted["method"], "flexible");
    assert_eq!(accepted["progress_percent"], 0);
    assert!(accepted["started_at"].is_null() && accepted["finished_at"].is_null());
    assert!(accepted["submitted_at"].as_str().unwrap().ends_with('Z'));
    assert_eq!(accepted["links"]["results"], format!("{path}/results"));

    let work = engine.next().await;
    let not_ready = bench.get(&format!("{path}/results")).answer().await;
    assert!(not_ready.headers().contains_key("retry-after"));
    problem(not_ready, 404, "result_not_ready").await;

    let running = bench.job(&path).await;
    assert_eq!(running["status"], "running");
    assert_eq!(running["attempt"], 1);
    assert_eq!(
        running["submission"]["pair"]["driven"]["blank"]["holes"]["count"],
        10
    );

    work.finish();
    let ended = bench.ended(&path).await;
    assert_eq!(ended["status"], "successful");
    assert_eq!(ended["progress_percent"], 100);
    assert!(ended["wall_time_seconds"].as_f64().unwrap() >= 0.0);

    let results = bench.get(&format!("{path}/results")).answer().await;
    assert_eq!(results.status(), StatusCode::OK);
    assert_eq!(results.whole_text().await, RESULTS);
}

#[tokio::test]
async fn what_has_not_changed_is_not_sent_again() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    for path in [
        path.clone(),
        format!("{path}/results"),
        format!("{path}/results/ste.csv"),
    ] {
        let first = bench.get(&path).answer().await;
        let tag = first.headers()["etag"].clone();
        assert!(tag.to_str().unwrap().starts_with('"'), "a strong tag");
        let again = bench
            .get(&path)
            .header("if-none-match", &tag)
            .answer()
            .await;
        assert_eq!(
            (again.status(), &again.headers()["etag"]),
            (StatusCode::NOT_MODIFIED, &tag)
        );
        let other = bench
            .get(&path)
            .header("if-none-match", "\"other\"")
            .answer()
            .await;
        assert_eq!(other.status(), StatusCode::OK);
    }
}

#[tokio::test]
async fn a_failed_job_carries_its_problem_and_has_no_results() {
    let (bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(115.0)).await;
    engine
        .next()
        .await
        .fail(Problem::new(Code::TimeLimit, "position 7"));
    let job = bench.ended(&path).await;
    assert_eq!(job["status"], "failed");
    assert_eq!(job["problem"]["code"], "time_limit");
    assert_eq!(job["problem"]["detail"], "position 7");
    let results = problem(bench.get(&format!("{path}/results")), 409, "job_failed").await;
    assert!(results["detail"].as_str().unwrap().contains("position 7"));
}

#[tokio::test]
async fn a_panic_of_the_engine_fails_its_job_only() {
    let (bench, mut engine) = Bench::steered().await;
    let (first, second) = (
        bench.submit(&submission(1.0)).await,
        bench.submit(&submission(2.0)).await,
    );
    engine.next().await.panic();
    let job = bench.ended(&first).await;
    assert_eq!(job["problem"]["code"], "internal_error");
    assert!(
        !job.to_string().contains("as the test ordered"),
        "what is inside stays inside"
    );
    engine.next().await.finish();
    assert_eq!(bench.ended(&second).await["status"], "successful");
}

#[tokio::test]
async fn a_waiting_job_that_is_cancelled_is_never_computed() {
    let (bench, mut engine) = Bench::steered().await;
    let first = bench.submit(&submission(1.0)).await;
    let work = engine.next().await;
    let second = bench.submit(&submission(2.0)).await;
    let third = bench.submit(&submission(3.0)).await;
    let response = bench.cancel(&second).answer().await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    let dismissed = response.document().await;
    assert_eq!(dismissed["status"], "dismissed");
    assert!(dismissed["links"].get("cancel").is_none());

    work.finish();
    engine.next().await.finish();
    assert_eq!(bench.ended(&first).await["status"], "successful");
    assert_eq!(bench.ended(&third).await["status"], "successful");
    assert!(engine.is_idle());
    let asked = bench.get(&format!("{second}/results"));
    problem(asked, 409, "job_dismissed").await;
}

#[tokio::test]
async fn a_running_job_that_is_cancelled_stops_and_frees_its_worker() {
    let (bench, mut engine) = Bench::steered().await;
    let (first, second) = (
        bench.submit(&submission(1.0)).await,
        bench.submit(&submission(2.0)).await,
    );
    let work = engine.next().await;
    for _ in 0..2 {
        let response = bench.cancel(&first).answer().await;
        assert_eq!(
            response.status(),
            StatusCode::ACCEPTED,
            "cancelling again changes nothing"
        );
    }
    work.stopped().await;
    assert_eq!(bench.job(&first).await["status"], "dismissed");
    engine.next().await.finish();
    assert_eq!(bench.ended(&second).await["status"], "successful");

    problem(bench.cancel(&second), 409, "job_finished").await;
}

#[tokio::test]
async fn a_job_is_deleted_unless_it_runs() {
    let (bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(1.0)).await;
    let work = engine.next().await;
    let delete = async || bench.delete(&path).answer().await;
    problem(delete().await, 409, "job_running").await;
    work.finish();
    bench.ended(&path).await;
    assert_eq!(delete().await.status(), StatusCode::NO_CONTENT);
    problem(delete().await, 404, "job_not_found").await;
    for path in [
        path.clone(),
        format!("{path}/results"),
        format!("{path}/events"),
    ] {
        problem(bench.get(&path), 404, "job_not_found").await;
    }
}

#[tokio::test]
async fn who_prefers_to_wait_gets_the_job_with_its_results_inside() {
    let (bench, mut engine) = Bench::steered().await;
    let document = submission(115.0);
    let waiting = bench
        .post("/v1/jobs", &document)
        .header("prefer", format!("respond-async, {WAIT}"))
        .send();
    let (response, ()) = tokio::join!(waiting, async { engine.next().await.finish() });
    let response = response.unwrap();
    assert_eq!(response.status(), StatusCode::OK);
    assert_eq!(response.headers()["preference-applied"], WAIT);
    let path = response.headers()["location"].to_str().unwrap().to_owned();
    let job = response.document().await;
    assert_eq!(job["status"], "successful");
    assert!(path.ends_with(job["id"].as_str().unwrap()));
    assert_eq!(
        job["results"],
        serde_json::from_str::<Value>(RESULTS).unwrap()
    );
    // Elsewhere they stand at their own address.
    assert_eq!(bench.document(&path).await.get("results"), None);
}

#[tokio::test]
async fn a_job_that_was_created_is_answered_with_even_if_it_fails_or_is_cancelled() {
    let (bench, mut engine) = Bench::steered().await;
    let submit = |torque: f64| {
        let request = bench.post("/v1/jobs", &submission(torque));
        request.header("prefer", WAIT).send()
    };
    let (response, ()) = tokio::join!(submit(1.0), async {
        let problem = Problem::new(Code::NotConverged, "As was told.");
        engine.next().await.fail(problem);
    });
    let response = response.unwrap();
    assert_eq!(response.status(), StatusCode::OK);
    let job = response.document().await;
    assert_eq!(
        (&job["status"], &job["problem"]["code"]),
        (&json!("failed"), &json!("not_converged"))
    );
    assert_eq!(job.get("results"), None);

    let (response, ()) = tokio::join!(submit(2.0), async {
        let work = engine.next().await;
        let jobs = bench.document("/v1/jobs").await;
        let path = format!(
            "/v1/jobs/{}/cancel",
            jobs["items"][0]["id"].as_str().unwrap()
        );
        let cancelled = bench.send(&path).answer().await;
        assert_eq!(cancelled.status(), StatusCode::ACCEPTED);
        work.stopped().await;
    });
    let response = response.unwrap();
    assert_eq!(response.status(), StatusCode::OK);
    let job = response.document().await;
    assert_eq!(
        (&job["status"], job.get("results")),
        (&json!("dismissed"), None)
    );
}

#[tokio::test]
async fn who_waits_in_vain_gets_the_job() {
    let (bench, mut engine) = Bench::steered().await;
    let response = bench
        .post("/v1/jobs", &submission(1.0))
        .header("prefer", "wait=0")
        .answer()
        .await;
    assert_eq!(response.status(), StatusCode::ACCEPTED);
    let path = response.headers()["location"].to_str().unwrap().to_owned();
    let work = engine.next().await;
    let response = bench.get(&path).header("prefer", "wait=0").answer().await;
    assert_eq!(response.document().await["status"], "running");
    work.finish();
    bench.ended(&path).await;
}

#[tokio::test]
async fn two_workers_compute_two_jobs_at_the_same_time() {
    let (bench, mut engine) =
        Bench::steered_with(|config| config.workers = Some(2.try_into().unwrap())).await;
    let paths = [
        bench.submit(&submission(1.0)).await,
        bench.submit(&submission(2.0)).await,
    ];
    // Both have begun before either has ended.
    let works = [engine.next().await, engine.next().await];
    works.into_iter().for_each(|work| work.finish());
    for path in paths {
        assert_eq!(bench.ended(&path).await["status"], "successful");
    }
}

#[tokio::test]
#[cfg(target_os = "linux")]
async fn the_engine_gives_way_to_those_who_answer() {
    /// The niceness of the thread that asks: the seventeenth word behind its name.
    fn niceness() -> i32 {
        let stat = std::fs::read_to_string("/proc/thread-self/stat").unwrap();
        let (_, behind_name) = stat.rsplit_once(')').unwrap();
        let word = behind_name.split_whitespace().nth(16);
        word.unwrap().parse().unwrap()
    }
    let (tell, mut told) = tokio::sync::mpsc::unbounded_channel();
    let solve = move |_: &Submission, _: &Run| {
        tell.send(niceness()).unwrap();
        Ok(results())
    };
    let bench = Bench::start(|_| {}, Arc::new(solve)).await;
    let path = bench.submit(&submission(115.0)).await;
    bench.ended(&path).await;
    let of_job = told.recv().await.unwrap();
    let preview = bench.post("/v1/preview", &submission(115.0));
    assert_eq!(preview.answer().await.status(), 200);
    let of_preview = told.recv().await.unwrap();
    // Above the test's own, which may be close to the highest one.
    let above = |more: i32| (niceness() + more).min(19);
    assert_eq!((of_preview, of_job), (above(5), above(10)));
}

#[tokio::test]
async fn of_small_jobs_that_are_computed_together_each_has_its_own_end() {
    // The one at 7 N m panics, the one at 8 is refused; jobs of the load distribution are claimed several at once.
    let solve: Solve = Arc::new(|submission, _| match submission.case().output_torques[0] {
        7.0 => panic!("as the test ordered"),
        8.0 => Err(Problem::new(Code::NotConverged, "as the test ordered")),
        _ => Ok(results()),
    });
    let bench = Bench::start(|_| {}, solve).await;
    let mut base = submission(1.0);
    base["method"] = json!("load_distribution");
    let torques: Vec<Value> = (1..=40).map(|torque| json!([torque])).collect();
    let study =
        json!({ "base": base, "axes": [{ "path": "/output_torques_n_m", "values": torques }] });
    let taken = bench.post("/v1/studies", &study).answer().await;
    let path = taken.headers()["location"].to_str().unwrap().to_owned();
    let study = bench.ended(&path).await;
    assert_eq!(
        (&study["successful"], &study["failed"]),
        (&json!(38), &json!(2))
    );
    let failed = bench.job("/v1/jobs?status=failed").await;
    let mut codes: Vec<&str> = failed["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|job| job["problem"]["code"].as_str().unwrap())
        .collect();
    codes.sort_unstable();
    assert_eq!(codes, ["internal_error", "not_converged"]);
}
