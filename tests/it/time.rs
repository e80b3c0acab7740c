//! Where time decides: the limit for one job, a lease that runs out, and a key that is forgotten.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, mpsc};
use std::time::Duration;

use jiff::Timestamp;
use meshwright::compute::Solve;
use meshwright::jobs::{
    Clock, DatabaseAddress, Filter, Job, Jobs, Member, Pace, Resource as _, Rules, Status, Store,
    Workers,
};
use meshwright_wire::{Code, Problem, Results, Submission};
use tempfile::TempDir;
use tokio_util::sync::CancellationToken;

use crate::bench::{PATIENCE, RESULTS, results, submission};
use crate::stores;

const CLIENT: &str = "anonymous";

/// Two clocks that stand until they are set.
#[derive(Clone, Default)]
struct Hands {
    wall: Arc<AtomicI64>,
    steady: Arc<AtomicI64>,
    /// How often somebody has looked at the steady one.
    looks: Arc<AtomicI64>,
}

const ORIGIN: i64 = 1_000_000;

impl Hands {
    fn clock(&self) -> Clock {
        let read = |hand: &AtomicI64| {
            Timestamp::from_second(ORIGIN + hand.load(Ordering::Relaxed)).unwrap()
        };
        let (wall, steady) = (Arc::clone(&self.wall), Arc::clone(&self.steady));
        let looks = Arc::clone(&self.looks);
        let look = move || {
            looks.fetch_add(1, Ordering::Relaxed);
            read(&steady)
        };
        Clock::given(move || read(&wall), look)
    }

    /// Comes back when somebody has looked at the steady clock so many times.
    async fn looked_at(&self, times: i64) {
        let before = self.looks.load(Ordering::Relaxed);
        while self.looks.load(Ordering::Relaxed) < before + times {
            tokio::task::yield_now().await;
        }
    }

    /// Time passes.
    fn advance(&self, seconds: i64) {
        self.steady.fetch_add(seconds, Ordering::Relaxed);
        self.jump(seconds);
    }

    /// Somebody sets the clock, and no time passes.
    fn jump(&self, seconds: i64) {
        self.wall.fetch_add(seconds, Ordering::Relaxed);
    }
}

fn rules() -> Rules {
    Rules {
        queue_limit: 100,
        client_queue_limit: 100,
        user_queue_limit: None,
        client_design_limit: 1000,
        job_memory_mb: 1000,
        memory_mb: 1000,
    }
}

async fn open(place: &DatabaseAddress) -> Store {
    Store::open(place).await.unwrap()
}

async fn jobs(clock: Clock) -> (Jobs, CancellationToken, (DatabaseAddress, TempDir)) {
    let folder = tempfile::tempdir().unwrap();
    let place = stores::place(&folder).await;
    let stop = CancellationToken::new();
    let jobs = Jobs::new(open(&place).await, rules(), clock, stop.clone());
    stores::give_clock(&place).await;
    (jobs, stop, (place, folder))
}

fn member() -> Member {
    Member::usual(CLIENT)
}

fn case(torque: f64) -> Submission {
    Submission::parse(submission(torque).to_string().as_bytes()).unwrap()
}

async fn ended(jobs: &Jobs, job: &Job) -> Job {
    let job = Job::wait(jobs, CLIENT, job.id, PATIENCE).await.unwrap();
    assert!(job.status.has_ended());
    job
}

#[tokio::test]
async fn a_job_that_takes_longer_than_the_limit_is_stopped_and_fails() {
    let (jobs, stop, _folder) = jobs(Clock::system()).await;
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
    let mut workers = Workers::start(jobs.clone(), solve, 1, pace, false)
        .await
        .unwrap();

    let job = ended(
        &jobs,
        &jobs
            .submit(&member(), &case(1.0), None)
            .await
            .unwrap()
            .record,
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

/// An engine whose computations wait for what to give.
fn waiting_engine() -> (Solve, impl AsyncFn() -> mpsc::Sender<Results>) {
    let (begun, begins) = mpsc::channel();
    let begins = Arc::new(std::sync::Mutex::new(begins));
    let solve: Solve = Arc::new(move |_, _| {
        let (order, orders) = mpsc::channel();
        begun.send(order).unwrap();
        let given = orders.recv();
        given.map_err(|_| Problem::new(Code::InternalError, "dropped"))
    });
    let next = async move || {
        let begins = Arc::clone(&begins);
        tokio::task::spawn_blocking(move || begins.lock().unwrap().recv_timeout(PATIENCE).unwrap())
            .await
            .unwrap()
    };
    (solve, next)
}

#[tokio::test]
async fn a_job_whose_lease_ran_out_runs_again_elsewhere_and_the_late_results_are_not_kept() {
    let hands = Hands::default();
    let (jobs, stop, (place, _folder)) = jobs(hands.clock()).await;
    let (solve, begin) = waiting_engine();
    // The heart beats at the start of an attempt and not again: the worker seems lost when time goes on.
    let pace = Pace {
        lease: Duration::from_millis(20),
        heartbeat: Duration::from_secs(3600),
        ..Pace::with_time_limit(Duration::from_secs(3600))
    };
    let mut workers = Workers::start(jobs.clone(), Arc::clone(&solve), 1, pace, false)
        .await
        .unwrap();
    let job = jobs
        .submit(&member(), &case(1.0), None)
        .await
        .unwrap()
        .record;
    let first = begin().await;

    // As it would be in another process on the same database, whose start recovers nothing of the living.
    let others = Jobs::new(open(&place).await, rules(), hands.clock(), stop.clone());
    let mut other_workers = Workers::beside(others.clone(), solve, 1, pace)
        .await
        .unwrap();
    hands.advance(1);
    let second = begin().await;
    assert_eq!(Job::find(&jobs, CLIENT, job.id).await.unwrap().attempt, 2);
    let late = Results {
        method: "late".into(),
        ..results()
    };
    first.send(late).unwrap();
    second.send(results()).unwrap();
    let job = ended(&others, &job).await;
    let text = jobs.document(&job).await.unwrap().text().unwrap();
    assert_eq!((job.status, text.as_str()), (Status::Successful, RESULTS));
    stop.cancel();
    workers.ended().await;
    other_workers.ended().await;
}

#[tokio::test]
async fn a_clock_that_is_set_forward_takes_no_job_from_its_worker_nor_a_key_from_its_client() {
    let hands = Hands::default();
    let (jobs, stop, _folder) = jobs(hands.clock()).await;
    let (solve, begin) = waiting_engine();
    let pace = Pace {
        lease: Duration::from_millis(20),
        heartbeat: Duration::from_secs(3600),
        ..Pace::with_time_limit(Duration::from_secs(3600))
    };
    let mut workers = Workers::start(jobs.clone(), solve, 1, pace, false)
        .await
        .unwrap();
    let key = || Some("k".to_owned());
    let job = jobs
        .submit(&member(), &case(1.0), key())
        .await
        .unwrap()
        .record;
    let order = begin().await;
    hands.jump(10 * 365 * 24 * 3600);
    // While the only worker computes, nobody looks at the clock but the watch over leases. A look follows the end of the one
    // before: of three the second was at all leases.
    hands.looked_at(3).await;
    let running = Job::find(&jobs, CLIENT, job.id).await.unwrap();
    assert_eq!((running.status, running.attempt), (Status::Running, 1));
    let again = jobs.submit(&member(), &case(1.0), key()).await.unwrap();
    assert!(again.repeated, "the key is a moment old");
    order.send(results()).unwrap();
    assert_eq!(ended(&jobs, &job).await.status, Status::Successful);
    stop.cancel();
    workers.ended().await;
}

#[tokio::test]
async fn a_clock_that_is_set_back_gives_no_negative_times_and_lists_new_jobs_first() {
    let hands = Hands::default();
    let (jobs, stop, _folder) = jobs(hands.clock()).await;
    let (solve, begin) = waiting_engine();
    let pace = Pace::with_time_limit(Duration::from_secs(3600));
    let mut workers = Workers::start(jobs.clone(), solve, 1, pace, false)
        .await
        .unwrap();
    let first = jobs
        .submit(&member(), &case(1.0), None)
        .await
        .unwrap()
        .record;
    let order = begin().await;
    hands.advance(3);
    hands.jump(-3600);
    order.send(results()).unwrap();
    let first = ended(&jobs, &first).await;
    assert_eq!(first.elapsed.unwrap().as_secs(), 3, "what it took");
    assert!(first.finished_at >= first.started_at && first.started_at >= Some(first.submitted_at));

    let second = jobs
        .submit(&member(), &case(2.0), None)
        .await
        .unwrap()
        .record;
    assert!(
        second.submitted_at < first.submitted_at,
        "as the clock says"
    );
    let order = begin().await;
    let page = Job::list(&jobs, CLIENT, &Filter::default(), 9)
        .await
        .unwrap();
    let ids: Vec<_> = page.items.iter().map(|job| job.id).collect();
    assert_eq!(
        ids,
        [second.id, first.id],
        "the one that came last stands first"
    );
    order.send(results()).unwrap();
    ended(&jobs, &second).await;
    stop.cancel();
    workers.ended().await;
}

#[tokio::test]
async fn a_key_is_forgotten_after_a_day() {
    let hands = Hands::default();
    let (jobs, _stop, _folder) = jobs(hands.clock()).await;
    let submit = async |torque| {
        jobs.submit(&member(), &case(torque), Some("k".to_owned()))
            .await
    };
    let first = submit(1.0).await.unwrap();
    hands.advance(24 * 3600);
    assert!(submit(1.0).await.unwrap().repeated);
    assert!(submit(2.0).await.is_err());
    hands.advance(1);
    let next = submit(2.0).await.unwrap();
    assert!(!next.repeated && next.record.id != first.record.id);
}
