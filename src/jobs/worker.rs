//! The workers: each claims a job, has it computed on its threads, and writes down what came of it.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meshwright_engine::run::Run;
use rayon::ThreadPool;
use tokio::sync::oneshot;
use tokio::task::JoinSet;
use tokio::time::{Instant, MissedTickBehavior, interval_at, sleep};
use tracing::{error, info, warn};

use super::job::Job;
use super::live::Running;
use super::queue::Jobs;
use super::threads::{Work, engine_threads};
use super::transitions::{Claim, Claimed, Lost};
use crate::wire::{Code, Problem, SOLVER_VERSION, Submission, Summary};

/// The computation of a submission: long work that fills a core, reports to the run and obeys its stop. Gives the
/// text of the results document.
pub type Solve = Arc<dyn Fn(&Submission, &Run) -> Result<String, Problem> + Send + Sync>;

/// What a computation leaves: the results document, and what the tables of studies show of it.
struct Solved {
    document: String,
    summary: Option<String>,
}

/// How the workers keep time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// A worker that has not reported for so long is taken for lost.
    pub lease: Duration,
    /// So often a worker reports.
    pub heartbeat: Duration,
    /// A job that takes longer fails.
    pub time_limit: Duration,
    /// A job that has lost so many workers fails.
    pub attempts_limit: u32,
}

impl Pace {
    /// Leases of half a minute, three attempts, and a limit for each job.
    pub fn with_time_limit(time_limit: Duration) -> Self {
        Self {
            lease: Duration::from_secs(30),
            heartbeat: Duration::from_secs(2),
            time_limit,
            attempts_limit: 3,
        }
    }
}

/// The workers of this process.
pub struct Workers {
    tasks: JoinSet<()>,
    alive: Arc<AtomicUsize>,
}

/// What every worker has in common.
struct Shop {
    jobs: Jobs,
    solve: Solve,
    pace: Pace,
}

impl Workers {
    /// Puts jobs that lost their process back into the queue, and starts `count` workers.
    ///
    /// The caller vouches that no other process works on the same database.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started or the database fails.
    pub async fn start(
        jobs: Jobs,
        solve: Solve,
        count: usize,
        pace: Pace,
    ) -> Result<Self, StartError> {
        let shop = Arc::new(Shop { jobs, solve, pace });
        shop.recover(Lost::All)
            .await
            .map_err(StartError::Database)?;
        shop.jobs
            .resume_studies()
            .await
            .map_err(StartError::Database)?;

        let alive = Arc::new(AtomicUsize::new(0));
        let mut tasks = JoinSet::new();
        for worker in 0..count {
            let alive = Alive::new(&alive);
            let shop = Arc::clone(&shop);
            let name = move |index| format!("engine-{worker}-{index}");
            let threads = engine_threads(name, Work::Job).map_err(StartError::Threads)?;
            tasks.spawn(async move {
                let _alive = alive;
                shop.work(&threads).await;
            });
        }
        tasks.spawn(async move { shop.watch_leases().await });
        Ok(Self { tasks, alive })
    }

    /// The number of workers that live, for the health check.
    pub fn alive(&self) -> Arc<AtomicUsize> {
        Arc::clone(&self.alive)
    }

    /// Comes back when all workers have ended, which they do when the jobs' stop comes.
    pub async fn ended(&mut self) {
        while self.tasks.join_next().await.is_some() {}
    }

    /// Ends all workers where they stand, as a crash would.
    pub async fn kill(mut self) {
        self.tasks.shutdown().await;
    }
}

/// Why workers cannot start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The engine's threads cannot be started.
    #[error("the engine's threads cannot be started")]
    Threads(#[source] rayon::ThreadPoolBuildError),
    /// The jobs of an earlier process cannot be recovered.
    #[error("the jobs of an earlier process cannot be recovered")]
    Database(#[source] sqlx::Error),
}

struct Alive(Arc<AtomicUsize>);

impl Alive {
    fn new(count: &Arc<AtomicUsize>) -> Self {
        count.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(count))
    }
}

impl Drop for Alive {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Shop {
    /// One worker: job after job until the stop.
    async fn work(&self, threads: &ThreadPool) {
        let stop = self.jobs.stop();
        while !stop.is_cancelled() {
            match self.claim().await {
                Ok(Claimed { job, given }) => {
                    let found = job.is_some() || !given.is_empty();
                    for job in given {
                        info!(job = %job.id, "job given the results of an equal one");
                        self.jobs.live.changed_job(&job);
                    }
                    if let Some(job) = job {
                        // Where one job waited there may be another for the next worker.
                        self.jobs.live.work.notify_one();
                        self.jobs.live.changed_job(&job);
                        self.compute(job, threads).await;
                    }
                    if !found {
                        tokio::select! {
                            () = self.jobs.live.work.notified() => {}
                            () = stop.cancelled() => {}
                        }
                    }
                }
                Err(error) => {
                    error!(error = %error, "no job can be claimed");
                    tokio::select! {
                        () = sleep(Duration::from_secs(1)) => {}
                        () = stop.cancelled() => {}
                    }
                }
            }
        }
    }

    async fn claim(&self) -> Result<Claimed, sqlx::Error> {
        let now = self.now();
        self.jobs
            .store
            .claim(now, self.lease_from(now), SOLVER_VERSION)
            .await
    }

    /// Has a claimed job computed, and watches over it: heartbeat, time limit, shutdown.
    async fn compute(&self, job: Job, threads: &ThreadPool) {
        let claim = Claim {
            id: job.id,
            attempt: job.attempt,
        };
        info!(job = %job.id, attempt = job.attempt, method = job.method, "job started");
        let entered = self.jobs.live.enter(job.id, job.progress);
        let running = &entered.running;
        // A cancel that came after the claim and before the entry found nothing to stop; it shows in the row.
        // A look is enough for that: a report would be one more commit for every job of a study.
        if !self.holds(claim).await {
            return;
        }
        let mut outcome = self.launch(&job, running.run(), threads);
        let mut deadline = pin!(sleep(self.pace.time_limit));
        let mut heartbeat = interval_at(Instant::now() + self.pace.heartbeat, self.pace.heartbeat);
        heartbeat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        // False once the row says that this attempt is over: what the engine still gives is not asked for.
        let mut held = true;

        loop {
            tokio::select! {
                result = &mut outcome => {
                    if held {
                        let result = result.unwrap_or_else(|_| Err(internal_problem()));
                        self.settle(&job, claim, result).await;
                    }
                    return;
                }
                () = &mut deadline, if held => {
                    held = false;
                    let limit = self.pace.time_limit.as_secs_f64();
                    let problem = Problem::new(Code::TimeLimit, format!(
                        "The job was stopped after {limit} s, the limit for one job, with {} of {} positions solved.",
                        running.progress().done, running.progress().total,
                    ));
                    self.settle(&job, claim, Err(problem)).await;
                }
                () = self.jobs.stop().cancelled(), if held => {
                    held = false;
                    self.release(claim).await;
                }
                _ = heartbeat.tick(), if held => held = self.report(claim, running).await,
            }
            if !held {
                running.stop();
            }
        }
    }

    /// Starts the computation on the worker's own threads: it is long, so it must not sit on a thread that answers
    /// requests. A panic in it is the engine's fault and ends this job only.
    fn launch(
        &self,
        job: &Job,
        run: Run,
        threads: &ThreadPool,
    ) -> oneshot::Receiver<Result<Solved, Problem>> {
        let (sender, receiver) = oneshot::channel();
        let (solve, submission, id) = (Arc::clone(&self.solve), job.submission.clone(), job.id);
        threads.spawn(move || {
            let work = || {
                let submission = Submission::parse(submission.as_bytes())?;
                let document = solve(&submission, &run)?;
                let summary = Summary::of_document(&document).map(|summary| {
                    serde_json::to_string(&summary).expect("a summary is plain data")
                });
                Ok(Solved { document, summary })
            };
            let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
                error!(job = %id, panic = message_of(&*panic), "the engine panicked");
                Err(internal_problem())
            });
            // The worker may have gone meanwhile; then the attempt is lost and the fence holds.
            let _ = sender.send(result);
        });
        receiver
    }

    /// Writes down what came of an attempt.
    async fn settle(&self, job: &Job, claim: Claim, result: Result<Solved, Problem>) {
        let now = self.now();
        let (status, written) = match result {
            Ok(Solved { document, summary }) => (
                "successful",
                self.jobs
                    .store
                    .succeed(claim, now, &document, summary.as_deref(), SOLVER_VERSION)
                    .await,
            ),
            Err(problem) => (
                "failed",
                self.jobs.store.fail(claim, now, &text_of(&problem)).await,
            ),
        };
        match written {
            Ok(true) => {
                let seconds = job
                    .started_at
                    .map_or(0.0, |start| start.duration_until(now).as_secs_f64());
                metrics::counter!("meshwright_jobs_ended_total", "status" => status, "method" => job.method.clone())
                    .increment(1);
                metrics::histogram!("meshwright_job_wall_time_seconds", "method" => job.method.clone()).record(seconds);
                info!(job = %job.id, status, wall_time_seconds = seconds, "job ended");
            }
            Ok(false) => {
                info!(job = %job.id, attempt = claim.attempt, "the attempt was over before it ended")
            }
            // The lease runs out, and the job runs again.
            Err(error) => error!(job = %job.id, error = %error, "the outcome cannot be written"),
        }
        self.jobs.live.changed_job(job);
    }

    /// Gives a job back to the queue.
    async fn release(&self, claim: Claim) {
        match self.jobs.store.release(claim).await {
            Ok(_) => info!(job = %claim.id, "job returned to the queue"),
            // The next process finds it running and recovers it.
            Err(error) => {
                error!(job = %claim.id, error = %error, "the job cannot be returned to the queue")
            }
        }
        self.jobs.live.changed(claim.id);
    }

    /// Whether the row says that the claim still holds.
    async fn holds(&self, claim: Claim) -> bool {
        match self.jobs.store.holds(claim).await {
            Ok(held) => held,
            Err(error) => {
                warn!(job = %claim.id, error = %error, "a claim cannot be looked up");
                true
            }
        }
    }

    /// Reports progress and renews the lease. False if the claim holds no more.
    async fn report(&self, claim: Claim, running: &Running) -> bool {
        let lease_until = self.lease_from(self.now());
        match self
            .jobs
            .store
            .report(claim, running.progress(), lease_until)
            .await
        {
            Ok(held) => held,
            Err(error) => {
                warn!(job = %claim.id, error = %error, "progress cannot be written");
                true
            }
        }
    }

    /// Looks for leases that have run out until the stop.
    async fn watch_leases(&self) {
        let stop = self.jobs.stop();
        let mut tick = interval_at(Instant::now() + self.pace.lease, self.pace.lease);
        loop {
            tokio::select! {
                _ = tick.tick() => {}
                () = stop.cancelled() => return,
            }
            if let Err(error) = self.recover(Lost::Expired).await {
                error!(error = %error, "lost jobs cannot be recovered");
            }
        }
    }

    async fn recover(&self, lost: Lost) -> Result<(), sqlx::Error> {
        let limit = self.pace.attempts_limit;
        let problem = Problem::new(
            Code::AttemptsExhausted,
            format!(
                "The service ended {limit} times while it computed this job, so it is not tried again."
            ),
        );
        let recovered = self
            .jobs
            .store
            .recover(self.now(), lost, limit, &text_of(&problem))
            .await?;
        for id in recovered {
            warn!(job = %id, "recovered a job that had lost its worker");
            self.jobs.live.changed(id);
            self.jobs.live.work.notify_one();
        }
        Ok(())
    }

    fn now(&self) -> Timestamp {
        (self.jobs.clock)()
    }

    fn lease_from(&self, now: Timestamp) -> Timestamp {
        let lease = SignedDuration::try_from(self.pace.lease).unwrap_or(SignedDuration::MAX);
        now.saturating_add(lease).unwrap_or(Timestamp::MAX)
    }
}

fn text_of(problem: &Problem) -> String {
    serde_json::to_string(problem).expect("a problem is plain data")
}

/// The cause stands in the log; clients learn that it was not their fault.
fn internal_problem() -> Problem {
    Problem::new(
        Code::InternalError,
        "The service failed while it computed this job. The failure has been logged.",
    )
}

pub(super) fn message_of(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}
