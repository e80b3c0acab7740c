//! Where time decides: the limit for one job, a lease that runs out, and a key that is forgotten.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use jiff::Timestamp;
use meshwright::jobs::{Clock, Job, Jobs, Pace, Rules, Solve, Status, Store, Workers};
use meshwright::wire::{Code, Problem, Submission};
use tempfile::TempDir;
use tokio_util::sync::CancellationToken;

use crate::bench::{PATIENCE, RESULTS, submission};

const CLIENT: &str = "anonymous";

/// A clock that stands until it is set.
struct Hand(Arc<AtomicI64>);

impl Hand {
    fn new() -> (Self, Clock) {
        let seconds = Arc::new(AtomicI64::new(1_000_000));
        let read = Arc::clone(&seconds);
        (
            Self(seconds),
            Arc::new(move || Timestamp::from_second(read.load(Ordering::Relaxed)).unwrap()),
        )
    }

    fn advance(&self, seconds: i64) {
        self.0.fetch_add(seconds, Ordering::Relaxed);
    }
}

async fn jobs(clock: Clock) -> (Jobs, CancellationToken, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(&folder.path().join("meshwright.db"))
        .await
        .unwrap();
    let stop = CancellationToken::new();
    (
        Jobs::new(store, Rules { queue_limit: 100 }, clock, stop.clone()),
        stop,
        folder,
    )
}

fn case(torque: f64) -> Submission {
    Submission::parse(submission(torque).to_string().as_bytes()).unwrap()
}

async fn ended(jobs: &Jobs, job: &Job) -> Job {
    let job = jobs.wait(CLIENT, job.id, PATIENCE).await.unwrap();
    assert!(job.status.has_ended());
    job
}

#[tokio::test]
async fn a_job_that_takes_longer_than_the_limit_is_stopped_and_fails() {
    let (jobs, stop, _folder) = jobs(Arc::new(Timestamp::now)).await;
    let (stopped, was_stopped) = mpsc::channel();
    let solve: Solve = Arc::new(move |_, run| {
        while run.check().is_ok() {
            std::thread::yield_now();
        }
        stopped.send(()).unwrap();
        Err(Problem::new(Code::InternalError, "stopped"))
    });
    let pace = Pace {
        heartbeat: Duration::from_millis(5),
        ..Pace::with_time_limit(Duration::from_millis(20))
    };
    let mut workers = Workers::start(jobs.clone(), solve, 1, pace).await.unwrap();

    let job = ended(
        &jobs,
        &jobs.submit(CLIENT, &case(1.0), None).await.unwrap().job,
    )
    .await;
    assert_eq!(
        (job.status, &job.problem.unwrap()["code"]),
        (Status::Failed, &"time_limit".into())
    );
    was_stopped.recv_timeout(PATIENCE).unwrap();
    stop.cancel();
    workers.ended().await;
}

#[tokio::test]
async fn a_job_whose_lease_ran_out_runs_again_and_the_late_results_are_not_kept() {
    let (hand, clock) = Hand::new();
    let (jobs, stop, _folder) = jobs(clock).await;
    let (begun, begins) = mpsc::channel();
    let begins = Arc::new(std::sync::Mutex::new(begins));
    let solve: Solve = Arc::new(move |_, _| {
        let (order, orders) = mpsc::channel::<&'static str>();
        begun.send(order).unwrap();
        orders
            .recv()
            .map(str::to_owned)
            .map_err(|_| Problem::new(Code::InternalError, "dropped"))
    });
    // The heart beats at the start of an attempt and not again: the worker seems lost when the clock moves on.
    let pace = Pace {
        lease: Duration::from_millis(20),
        heartbeat: Duration::from_secs(3600),
        ..Pace::with_time_limit(Duration::from_secs(3600))
    };
    let mut workers = Workers::start(jobs.clone(), solve, 2, pace).await.unwrap();
    let begin = async || {
        let begins = Arc::clone(&begins);
        tokio::task::spawn_blocking(move || begins.lock().unwrap().recv_timeout(PATIENCE).unwrap())
            .await
            .unwrap()
    };

    let job = jobs.submit(CLIENT, &case(1.0), None).await.unwrap().job;
    let first = begin().await;
    hand.advance(1);
    let second = begin().await;
    assert_eq!(jobs.find(CLIENT, job.id).await.unwrap().attempt, 2);
    first.send("{ \"late\": true }").unwrap();
    second.send(RESULTS).unwrap();
    let job = ended(&jobs, &job).await;
    assert_eq!(
        (job.status, jobs.document(&job).await.unwrap().as_str()),
        (Status::Successful, RESULTS)
    );
    stop.cancel();
    workers.ended().await;
}

#[tokio::test]
async fn a_key_is_forgotten_after_a_day() {
    let (hand, clock) = Hand::new();
    let (jobs, _stop, _folder) = jobs(clock).await;
    let submit = async |torque| {
        jobs.submit(CLIENT, &case(torque), Some("k".to_owned()))
            .await
    };
    let first = submit(1.0).await.unwrap();
    hand.advance(24 * 3600);
    assert!(submit(1.0).await.unwrap().repeated);
    assert!(submit(2.0).await.is_err());
    hand.advance(1);
    let next = submit(2.0).await.unwrap();
    assert!(!next.repeated && next.job.id != first.job.id);
}
