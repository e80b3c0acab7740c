//! One attempt at one job: it is computed on its worker's threads, watched over, and what comes of it is written down.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meshwright_engine::run::Run;
use rayon::ThreadPool;
use tokio::sync::oneshot;
use tokio::time::{Instant, MissedTickBehavior, interval_at, sleep};
use tracing::{error, info, warn};

use super::job::Job;
use super::live::Running;
use super::store::{Claim, End, Lease, Packed, Started, StoreError};
use super::worker::Shop;
use crate::wire::{Code, Kept, Problem, SOLVER_VERSION, Submission, Summary};

/// What a computation leaves: the results document or its name, and what the tables of studies show of it.
struct Solved {
    document: Packed,
    summary: Option<String>,
}

/// What an attempt came to.
type Outcome = Result<Solved, Problem>;

impl Shop {
    /// Has a claimed job computed, and watches over it: heartbeat, time limit, shutdown.
    pub(super) async fn compute(&self, started: Started, threads: &ThreadPool) {
        let Started { job, submission } = started;
        let claim = Claim {
            id: job.id,
            attempt: job.attempt,
        };
        let begin = self.jobs.clock.steady();
        info!(job = %job.id, client = job.client, attempt = job.attempt, method = job.method, "job started");
        let entered = self.jobs.live.enter(job.id, job.progress);
        let running = &entered.running;
        // A cancel that came after the claim and before the entry found nothing to stop; it shows in the row.
        // A look is enough for that: a report would be one more commit for every job of a study.
        if !self.holds(claim).await {
            return;
        }
        let mut outcome = self.launch(&job, submission, running.run(), threads);
        let mut deadline = pin!(sleep(self.pace.time_limit));
        let mut heartbeat = interval_at(Instant::now() + self.pace.heartbeat, self.pace.heartbeat);
        heartbeat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        // False once the row says that this attempt is over: what the engine still gives is not asked for.
        let mut held = true;
        let mut reported = Instant::now();

        loop {
            tokio::select! {
                result = &mut outcome => {
                    if held {
                        let result = result.unwrap_or_else(|_| Err(internal_problem()));
                        self.settle(&job, claim, begin, result).await;
                    }
                    return;
                }
                () = &mut deadline, if held => {
                    held = false;
                    running.stop();
                    let limit = self.pace.time_limit.as_secs_f64();
                    let problem = Problem::new(Code::TimeLimit, format!(
                        "The job was stopped after {limit} s, the limit for one job, with {} of {} positions solved.",
                        running.progress().done, running.progress().total,
                    ));
                    self.settle(&job, claim, begin, Err(problem)).await;
                }
                () = self.jobs.stop().cancelled(), if held => {
                    held = false;
                    self.release(claim).await;
                }
                _ = heartbeat.tick(), if held => held = self.report(claim, running, &mut reported).await,
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
        submission: String,
        run: Run,
        threads: &ThreadPool,
    ) -> oneshot::Receiver<Outcome> {
        let (sender, receiver) = oneshot::channel();
        let solve = Arc::clone(&self.solve);
        let (id, keep) = (job.id, job.keep);
        threads.spawn(move || {
            let work = || {
                let submission = Submission::parse(submission.as_bytes())?;
                let document = solve(&submission, &run)?;
                let summary = Summary::of_document(&document).map(|summary| {
                    serde_json::to_string(&summary).expect("a summary is plain data")
                });
                let document = match keep {
                    Kept::Results => Packed::of(&document),
                    Kept::Statistics => Packed::name_of(&document),
                };
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

    /// Writes down what came of an attempt. While nothing can be stored it waits: what was computed is not given up for
    /// the disk's sake, nor is the job.
    async fn settle(&self, job: &Job, claim: Claim, begin: Timestamp, outcome: Outcome) {
        let end = End {
            at: self.jobs.clock.now(),
            elapsed: begin.duration_until(self.jobs.clock.steady()),
        };
        let written = loop {
            let written = self.write_down(claim, end, &outcome).await;
            match written {
                Err(error) if error.may_pass() && !self.jobs.stop().is_cancelled() => {
                    warn!(job = %job.id, error = %error, "the outcome waits until it can be written");
                    self.jobs.wait_for_storage().await;
                }
                written => break written,
            }
        };
        match written {
            Ok(true) => tell_end(job, end, &outcome),
            Ok(false) => {
                info!(job = %job.id, attempt = claim.attempt, "the attempt was over before it ended")
            }
            // The next process finds the job running, and begins it anew.
            Err(error) => error!(job = %job.id, error = %error, "the outcome cannot be written"),
        }
        self.jobs.live.changed_job(job);
    }

    async fn write_down(
        &self,
        claim: Claim,
        end: End,
        outcome: &Outcome,
    ) -> Result<bool, StoreError> {
        let store = &self.jobs.store;
        match outcome {
            Ok(Solved { document, summary }) => {
                let summary = summary.as_deref();
                store
                    .succeed(claim, end, document, summary, SOLVER_VERSION)
                    .await
            }
            Err(problem) => store.fail(claim, end, &problem.to_json()).await,
        }
    }

    /// Gives a job back to the queue.
    async fn release(&self, claim: Claim) {
        /// So often, in a shutdown that has little time.
        const TRIES: u32 = 3;
        for _ in 0..TRIES {
            match self.jobs.store.release(claim).await {
                Ok(_) => {
                    info!(job = %claim.id, "job returned to the queue");
                    break;
                }
                // The next process finds it running and recovers it.
                Err(error) => {
                    error!(job = %claim.id, error = %error, "the job cannot be returned to the queue");
                    sleep(Duration::from_millis(100)).await;
                }
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
    ///
    /// Where other processes take over what has not been reported for a lease, `reported` is when it last was, and an
    /// attempt that cannot report for so long is over: it would be computed twice.
    async fn report(&self, claim: Claim, running: &Running, reported: &mut Instant) -> bool {
        let store = &self.jobs.store;
        let report = store.report(claim, running.progress(), self.lease());
        let held = if store.is_shared() {
            // A network that is cut answers nothing at all.
            let answer = tokio::time::timeout(self.pace.lease / 3, report).await;
            answer.unwrap_or_else(|_| Err(sqlx::Error::PoolTimedOut.into()))
        } else {
            report.await
        };
        match held {
            Ok(held) => {
                *reported = Instant::now();
                held
            }
            Err(error) => {
                warn!(job = %claim.id, error = %error, "progress cannot be written");
                let over = store.is_shared() && reported.elapsed() > self.pace.lease;
                if over {
                    warn!(job = %claim.id, "the attempt is given up: its lease is over");
                }
                !over
            }
        }
    }

    /// A lease that is given now.
    pub(super) fn lease(&self) -> Lease {
        Lease {
            steady: self.jobs.clock.steady(),
            lasts: SignedDuration::try_from(self.pace.lease).unwrap_or(SignedDuration::MAX),
        }
    }
}

fn tell_end(job: &Job, end: End, outcome: &Outcome) {
    let seconds = end.elapsed.as_secs_f64();
    let (status, code) = match outcome {
        Ok(_) => ("successful", "none"),
        Err(problem) => ("failed", problem.code.slug()),
    };
    metrics::counter!("meshwright_jobs_ended_total", "status" => status, "method" => job.method.clone(), "code" => code)
        .increment(1);
    metrics::histogram!("meshwright_job_wall_time_seconds", "method" => job.method.clone())
        .record(seconds);
    let waited = job
        .started_at
        .map(|start| job.submitted_at.duration_until(start).as_secs_f64());
    let kind = if job.study.is_some() {
        "study"
    } else {
        "alone"
    };
    metrics::histogram!("meshwright_job_waiting_time_seconds", "kind" => kind)
        .record(waited.unwrap_or(0.0).max(0.0));
    info!(job = %job.id, client = job.client, status, code, wall_time_seconds = seconds, "job ended");
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
