//! An attempt at a job, or at several small ones: their computation on the threads of their worker, supervision, and the writing of results.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meshwright_connections::Budget;
use meshwright_engine::run::Run;
use meshwright_store::{
    Came, Claim, Damaged, End, Ended, Job, Kept, Packed, Progress, Started, StoreError,
};
use meshwright_studies::Summary;
use meshwright_wire::{Code, Problem, SOLVER_VERSION, Submission, memory_of};
use tokio::sync::mpsc;
use tokio::time::{Instant, MissedTickBehavior, interval_at, sleep};
use tracing::{error, info, warn};
use uuid::Uuid;

use super::error::damage_problem;
use super::live::Entered;
use super::worker_context::{Threads, WorkerContext};
use crate::compute::{Solve, message_of};
use crate::spans::{self, Place, Span};

/// Output of a computation: the results document or its name, and the values for the tables of studies.
struct Solved {
    document: Packed,
    summary: String,
}

/// Outcome of an attempt.
type Outcome = Result<Solved, Problem>;

/// An attempt that is under way.
struct Attempt {
    job: Job,
    claim: Claim,
    entered: Entered,
}

/// An attempt that has come to something, and when.
struct Done {
    attempt: Attempt,
    end: End,
    outcome: Outcome,
}

/// Attempts that go on, by their places among those that were begun together.
type Held = BTreeMap<usize, Attempt>;

/// Report of the engine's threads: index of the attempt, outcome, and time.
type Reached = (usize, Outcome, SignedDuration);

/// Time after which the claims are checked. Shorter computations are not worth the look.
const LOOK_AFTER: Duration = Duration::from_millis(50);

impl Attempt {
    fn of(context: &WorkerContext, job: Job) -> Self {
        info!(job = %job.id, client = job.client, attempt = job.attempt, method = job.method, "job started");
        let claim = Claim {
            id: job.id,
            attempt: job.attempt,
        };
        let entered = context.jobs.live.enter(job.id, job.progress);
        Self {
            job,
            claim,
            entered,
        }
    }
}

/// A job to compute: its id and client, how much of its results is kept, its submission, and its handle.
type Work = (Uuid, String, Kept, Result<String, Damaged>, Run);

impl WorkerContext {
    /// Has claimed jobs computed, and watches over them: heartbeat, time limit, shutdown. Gives back how often a
    /// worker had been notified of jobs when the last of these had ended, and nobody knew yet.
    pub(super) async fn compute(&self, started: Vec<Started>, threads: &Threads) -> u64 {
        let mut rung = self.jobs.live.rung();
        let mut work = Vec::with_capacity(started.len());
        // Attempts whose rows are still claimed, as far as is known. The engine's results for others are dropped.
        let mut held = Held::new();
        for (place, Started { job, submission }) in started.into_iter().enumerate() {
            let attempt = Attempt::of(self, job);
            work.push((
                attempt.job.id,
                attempt.job.client.clone(),
                attempt.job.keep,
                submission,
                attempt.entered.running.run(),
            ));
            held.insert(place, attempt);
        }
        let mut outcomes = self.launch(work, threads);
        let mut reached: Vec<Reached> = Vec::with_capacity(held.len());
        // Results to be written, at that time at the latest.
        let mut done = Vec::with_capacity(held.len());
        let mut written = pin!(sleep(Duration::ZERO));
        // The first one that has come to nothing is being computed, since then at the latest.
        let mut begin = self.jobs.clock.steady();
        let mut deadline = pin!(sleep(self.pace.time_limit));
        let mut look = pin!(sleep(LOOK_AFTER));
        let mut looked = false;
        let mut heartbeat = interval_at(Instant::now() + self.pace.heartbeat, self.pace.heartbeat);
        heartbeat.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut reported = Instant::now();

        loop {
            tokio::select! {
                count = outcomes.recv_many(&mut reached, usize::MAX) => {
                    if count == 0 {
                        break;
                    }
                    begin = self.jobs.clock.steady();
                    deadline.as_mut().reset(Instant::now() + self.pace.time_limit);
                    if done.is_empty() {
                        written.as_mut().reset(Instant::now() + self.pace.gather);
                    }
                    done.extend(reached.drain(..).filter_map(|(place, outcome, elapsed)| {
                        let attempt = held.remove(&place)?;
                        let end = End { at: self.jobs.clock.now(), elapsed };
                        Some(Done { attempt, end, outcome })
                    }));
                    if held.is_empty() {
                        rung = self.settle(std::mem::take(&mut done)).await;
                    }
                }
                () = &mut written, if !done.is_empty() => {
                    rung = self.settle(std::mem::take(&mut done)).await;
                }
                () = &mut deadline, if !held.is_empty() => {
                    deadline.as_mut().reset(Instant::now() + self.pace.time_limit);
                    if let Some((_, attempt)) = held.pop_first() {
                        done.push(self.beyond_limit(attempt, begin));
                        rung = self.settle(std::mem::take(&mut done)).await;
                    }
                }
                () = self.jobs.stop().cancelled(), if !held.is_empty() => {
                    for attempt in std::mem::take(&mut held).into_values() {
                        self.release(attempt.claim).await;
                        attempt.entered.running.stop();
                    }
                }
                // A cancel that came after the claim and before the entry found nothing to stop; it shows in the row.
                () = &mut look, if !looked => {
                    looked = true;
                    let holds = self.hold(&held).await;
                    give_up(&mut held, &holds);
                    rung = self.jobs.live.rung();
                }
                _ = heartbeat.tick(), if !held.is_empty() => {
                    // Its futures are large, and would stand on the stack of every claim.
                    let holds = Box::pin(self.report(&held, &mut reported)).await;
                    give_up(&mut held, &holds);
                    rung = self.jobs.live.rung();
                }
            }
        }
        // The engine has ended without a word of these.
        let end = End {
            at: self.jobs.clock.now(),
            elapsed: begin.duration_until(self.jobs.clock.steady()),
        };
        done.extend(held.into_values().map(|attempt| Done {
            attempt,
            end,
            outcome: Err(internal_problem()),
        }));
        if !done.is_empty() {
            rung = self.settle(done).await;
        }
        rung
    }

    /// Stops an attempt that has taken too long.
    fn beyond_limit(&self, attempt: Attempt, begin: Timestamp) -> Done {
        let running = &attempt.entered.running;
        running.stop();
        let limit = self.pace.time_limit.as_secs_f64();
        let problem = Problem::new(
            Code::TimeLimit,
            format!(
                "The job was stopped after {limit} s, the limit for one job, with {} of {} positions solved.",
                running.progress().done,
                running.progress().total,
            ),
        );
        Done {
            attempt,
            end: End {
                at: self.jobs.clock.now(),
                elapsed: begin.duration_until(self.jobs.clock.steady()),
            },
            outcome: Err(problem),
        }
    }

    /// Starts the computations on the worker's own threads: they are long, so they must not sit on a thread that answers requests. A
    /// panic in one is the engine's fault and ends this job only.
    fn launch(&self, work: Vec<Work>, threads: &Threads) -> mpsc::UnboundedReceiver<Reached> {
        let (sender, receiver) = mpsc::unbounded_channel();
        let pools = threads.for_jobs(work.len());
        let work = Arc::new(Mutex::new(work.into_iter().enumerate()));
        for pool in pools {
            let (work, sender) = (Arc::clone(&work), sender.clone());
            let memory = self.jobs.memory().clone();
            let (solve, clock) = (Arc::clone(&self.solve), self.jobs.clock.clone());
            let next = move || {
                work.lock()
                    .expect("nothing panics while it holds this lock")
                    .next()
            };
            pool.spawn(move || {
                while let Some((place, (id, client, keep, submission, run))) = next() {
                    let begin = clock.steady();
                    let work = || {
                        let submission = submission.as_ref().map_err(damage_problem)?;
                        solved(&solve, (&memory, client.as_str()), submission, keep, &run)
                    };
                    let result = catch_unwind(AssertUnwindSafe(work));
                    let result = result.unwrap_or_else(|panic| {
                        error!(job = %id, panic = message_of(&*panic), "the engine panicked");
                        Err(internal_problem())
                    });
                    let elapsed = begin.duration_until(clock.steady());
                    // The worker may have gone meanwhile; then the attempt is lost and the fence holds.
                    let _ = sender.send((place, result, elapsed));
                }
            });
        }
        receiver
    }

    /// Writes the outcomes of attempts in one commit, and notifies waiting requests. Returns how often a worker had been notified of jobs before.
    async fn settle(&self, done: Vec<Done>) -> u64 {
        let problems: Vec<String> = done
            .iter()
            .map(|done| {
                done.outcome
                    .as_ref()
                    .err()
                    .map_or_else(String::new, Problem::to_json)
            })
            .collect();
        let ends: Vec<Ended<'_>> = done
            .iter()
            .zip(&problems)
            .map(|(done, problem)| Ended {
                claim: done.attempt.claim,
                end: done.end,
                came: match &done.outcome {
                    Ok(solved) => Came::Results {
                        document: &solved.document,
                        summary: Some(&solved.summary),
                    },
                    Err(_) => Came::Problem(problem),
                },
            })
            .collect();
        let store = &self.jobs.store;
        let written = self.written(|| store.end_all(&ends, SOLVER_VERSION)).await;
        let rung = self.jobs.live.rung();
        match written {
            Ok(ended) => {
                for (done, job) in done.iter().zip(ended) {
                    self.tell(done, job);
                }
            }
            // The next process finds the jobs running, and begins them anew.
            Err(error) => {
                for Done { attempt, .. } in &done {
                    error!(job = %attempt.job.id, error = %error, "the outcome cannot be written");
                    self.jobs.live.changed(attempt.job.id);
                }
            }
        }
        rung
    }

    /// Repeats a write. While the disk is full it waits, so that neither the results nor the job are lost. A store that does not answer is asked again while
    /// the lease lasts, each time with a longer timeout: it may just be slow.
    async fn written<T, F: Future<Output = Result<T, StoreError>>>(
        &self,
        write: impl Fn() -> F,
    ) -> Result<T, StoreError> {
        let is_over = |error: &StoreError| !error.may_pass() || self.jobs.stop().is_cancelled();
        let wait = || self.jobs.wait_for_storage();
        repeated(self.patience(), write, is_over, wait).await
    }

    /// Tells those who wait, and the log, how a job has ended, if it has by this attempt.
    fn tell(&self, done: &Done, ended: Option<Job>) {
        let job = &done.attempt.job;
        match ended {
            Some(ended) => {
                tell_end(job, done.end, &done.outcome);
                self.jobs.live.changed_job(&ended);
            }
            None => {
                info!(job = %job.id, attempt = job.attempt, "the attempt was over before it ended");
                self.jobs.live.changed(job.id);
            }
        }
    }

    /// Gives a job back to the queue.
    async fn release(&self, claim: Claim) {
        /// Number of tries in a shutdown that has little time.
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

    /// For each attempt, whether its row says that its claim still holds.
    async fn hold(&self, held: &Held) -> Vec<bool> {
        let claims: Vec<Claim> = held.values().map(|attempt| attempt.claim).collect();
        match self.answered(self.jobs.store.hold(&claims)).await {
            Ok(holds) => holds,
            Err(error) => {
                warn!(error = %error, "claims cannot be looked up");
                vec![true; claims.len()]
            }
        }
    }

    /// Reports progress and renews leases. For each attempt, false if its claim holds no more.
    ///
    /// Where other processes take over a job that has not been reported for a lease, `reported` is the time of the last report. Attempts that cannot report for
    /// that long end: they would be computed twice.
    async fn report(&self, held: &Held, reported: &mut Instant) -> Vec<bool> {
        let store = &self.jobs.store;
        let reports: Vec<(Claim, Progress)> = held
            .values()
            .map(|attempt| (attempt.claim, attempt.entered.running.progress()))
            .collect();
        let report = store.report_all(&reports, self.lease());
        match self.answered(report).await {
            Ok(holds) => {
                *reported = Instant::now();
                holds
            }
            Err(error) => {
                warn!(error = %error, "progress cannot be written");
                let over = store.is_shared() && reported.elapsed() > self.pace.lease;
                if over {
                    warn!(
                        attempts = held.len(),
                        "attempts are given up: their lease is over"
                    );
                }
                vec![!over; reports.len()]
            }
        }
    }

    /// The answer of the store. A network that is cut gives none at all, and a lease is over meanwhile.
    async fn answered<T>(
        &self,
        answer: impl Future<Output = Result<T, StoreError>>,
    ) -> Result<T, StoreError> {
        answered_within(self.patience(), answer).await
    }

    /// How long an answer of the store is waited for; without an end where no other process can take a lease.
    fn patience(&self) -> Option<Duration> {
        self.jobs.store.is_shared().then(|| self.pace.lease / 3)
    }
}

/// The answer of the store, if it comes within `patience`.
async fn answered_within<T>(
    patience: Option<Duration>,
    answer: impl Future<Output = Result<T, StoreError>>,
) -> Result<T, StoreError> {
    let Some(patience) = patience else {
        return answer.await;
    };
    let answer = tokio::time::timeout(patience, answer).await;
    answer.unwrap_or_else(|_| Err(StoreError::timed_out()))
}

/// Repeats `write` until it succeeds or `is_over` after an error, and waits in between. The first time an answer is waited for within `patience`, each further
/// time twice as long.
async fn repeated<T, F: Future<Output = Result<T, StoreError>>, W: Future<Output = ()>>(
    mut patience: Option<Duration>,
    write: impl Fn() -> F,
    is_over: impl Fn(&StoreError) -> bool,
    wait: impl Fn() -> W,
) -> Result<T, StoreError> {
    loop {
        match answered_within(patience, write()).await {
            Err(error) if !is_over(&error) => {
                warn!(error = %error, "an outcome waits until it can be written");
                wait().await;
                patience = patience.map(|patience| patience.saturating_mul(2));
            }
            written => return written,
        }
    }
}

/// Stops the attempts whose claims hold no more.
fn give_up(held: &mut Held, holds: &[bool]) {
    let mut holds = holds.iter();
    held.retain(|_, attempt| {
        let holds = holds.next().copied().unwrap_or(true);
        if !holds {
            attempt.entered.running.stop();
        }
        holds
    });
}

/// Computes a job: reads it, solves it when there is memory for its client, and packs its output.
fn solved(
    solve: &Solve,
    (memory, client): (&Budget, &str),
    submission: &str,
    keep: Kept,
    run: &Run,
) -> Outcome {
    let submission = Submission::parse(submission.as_bytes())?;
    #[expect(clippy::disallowed_methods, reason = "on the engine's threads")]
    let (needed, is_wanted) = (memory_of(&submission), || run.check().is_ok());
    let Some(_memory) = memory.take_on_thread(client, needed, is_wanted) else {
        let detail = "The work was stopped before it began.";
        return Err(Problem::new(Code::Stopped, detail));
    };
    let results = solve(&submission, run)?;
    let summary = Summary::of(&results)?.to_json();
    let document = match keep {
        Kept::Results => Packed::of(&results.to_json()?),
        // To write thousands of numbers that nobody keeps takes a third of the time of a design of a population.
        Kept::Statistics => Packed::name_of(&summary),
    };
    Ok(Solved { document, summary })
}

fn tell_end(job: &Job, end: End, outcome: &Outcome) {
    let seconds = end.elapsed.as_secs_f64();
    let (status, code) = match outcome {
        Ok(_) => ("successful", "none".to_owned()),
        Err(problem) => ("failed", problem.code.word()),
    };
    metrics::counter!("meshwright_jobs_ended_total", "status" => status, "method" => job.method.clone(), "code" => code.clone())
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
    export_spans(job, end, status, &code);
}

/// The job from its submission to its end, and within it the attempt that brought it there.
fn export_spans(job: &Job, end: End, status: &'static str, code: &str) {
    let span = |attempt: Option<i64>, name: &'static str, begin: Timestamp| Span {
        place: Place::of_job(job.id, attempt),
        parent: attempt.map(|_| Place::of_job(job.id, None).span),
        is_entry: false,
        name: name.into(),
        begin: begin.into(),
        end: end.at.into(),
        attributes: vec![
            ("meshwright.job.id", job.id.to_string().into()),
            ("meshwright.job.client", job.client.clone().into()),
            ("meshwright.job.method", job.method.clone().into()),
            ("meshwright.job.attempt", job.attempt.into()),
            ("meshwright.job.status", status.into()),
            ("meshwright.job.code", code.to_owned().into()),
        ],
        causes: Vec::new(),
        failed: status != "successful",
    };
    spans::export(|| span(None, "job", job.submitted_at));
    let begin = job.started_at.unwrap_or(job.submitted_at);
    spans::export(|| span(Some(job.attempt), "compute", begin));
}

/// The cause stands in the log; clients learn that it was not their fault.
fn internal_problem() -> Problem {
    Problem::new(
        Code::InternalError,
        "The service failed while it computed this job. The failure has been logged.",
    )
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    #[tokio::test]
    async fn a_write_that_nobody_answers_is_begun_anew() {
        let count = AtomicU32::new(0);
        // The first connection has died without a word.
        let write = async || match count.fetch_add(1, Ordering::Relaxed) {
            0 => std::future::pending().await,
            1 => Err(StoreError::timed_out()),
            number => Ok(number),
        };
        let patience = Some(Duration::from_millis(1));
        let is_over = |error: &StoreError| !error.may_pass();
        let written = repeated(patience, write, is_over, async || {});
        let written = tokio::time::timeout(Duration::from_secs(60), written).await;
        assert_eq!(written.unwrap().unwrap(), 2);
    }
}
