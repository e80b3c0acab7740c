//! The service ends in mid-job, in order or not, and starts again on the same database.

use crate::bench::{Asked, Bench, submission};

#[tokio::test]
async fn a_job_whose_process_died_runs_again() {
    let (mut bench, mut engine) = Bench::steered().await;
    let running = bench.submit(&submission(1.0)).await;
    let lost = engine.next().await;
    lost.reach(50);
    let waiting = bench.submit(&submission(2.0)).await;
    bench.kill().await;

    bench.start_again().await;
    let work = engine.next().await;
    let job = bench.job(&running).await;
    assert_eq!(job["status"], "running");
    assert_eq!(job["attempt"], 2);
    // The first attempt ends after all; nobody asks for it any more.
    lost.finish();
    assert_eq!(bench.job(&running).await["status"], "running");

    work.finish();
    engine.next().await.finish();
    for path in [running, waiting] {
        assert_eq!(bench.ended(&path).await["status"], "successful");
    }
}

#[tokio::test]
async fn a_job_that_loses_its_process_three_times_fails() {
    let (mut bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(1.0)).await;
    for attempt in 1..=3 {
        let _work = engine.next().await;
        assert_eq!(bench.job(&path).await["attempt"], attempt);
        bench.kill().await;
        bench.start_again().await;
    }
    let job = bench.job(&path).await;
    assert_eq!(job["status"], "failed");
    assert_eq!(job["problem"]["code"], "attempts_exhausted");
    assert!(engine.is_idle());
}

#[tokio::test]
async fn a_shutdown_returns_the_job_to_the_queue_without_counting_the_attempt() {
    let (mut bench, mut engine) = Bench::steered().await;
    let path = bench.submit(&submission(1.0)).await;
    for _ in 0..4 {
        let work = engine.next().await;
        bench.shut_down().await;
        work.stopped().await;
        bench.start_again().await;
    }
    let work = engine.next().await;
    assert_eq!(bench.job(&path).await["attempt"], 1);
    work.finish();
    assert_eq!(bench.ended(&path).await["status"], "successful");
}

#[tokio::test]
async fn jobs_and_results_outlive_the_process() {
    let mut bench = Bench::quick().await;
    let path = bench.submit(&submission(1.0)).await;
    let before = bench.ended(&path).await;
    bench.shut_down().await;
    bench.start_again().await;
    assert_eq!(bench.job(&path).await, before);
    assert_eq!(
        bench
            .get(&format!("{path}/results"))
            .answer()
            .await
            .status(),
        200
    );
}

#[tokio::test]
async fn a_job_beside_one_that_kills_the_process_loses_no_attempt() {
    let (mut bench, mut engine) =
        Bench::steered_with(|config| config.workers = Some(2.try_into().unwrap())).await;
    let poison = bench.submit(&submission(1.0)).await;
    let _first = engine.next().await;
    let innocent = bench.submit(&submission(2.0)).await;
    let _second = engine.next().await;
    // Both run; then each is run alone, and the first kills the process each time.
    for _ in 0..4 {
        bench.kill().await;
        bench.start_again().await;
        if bench.job(&poison).await["status"] == "failed" {
            break;
        }
        let work = engine.next().await;
        assert_eq!(work.submission["output_torques_n_m"][0], 1.0);
        assert!(engine.is_idle(), "alone");
    }
    let job = bench.job(&poison).await;
    assert_eq!(job["problem"]["code"], "attempts_exhausted");
    let work = engine.next().await;
    assert_eq!(bench.job(&innocent).await["attempt"], 1);
    work.finish();
    assert_eq!(bench.ended(&innocent).await["status"], "successful");
}
