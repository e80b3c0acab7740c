//! The workers: each claims a job and has it computed, one after the other; and those that lost theirs are found.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use meshwright_store::{Claimed, Lease, Lost, Reader, Started, StoreError};
use meshwright_wire::{Code, DOCUMENT_VERSION, Problem, SOLVER_VERSION};
use tokio::task::JoinSet;
use tokio::time::{Instant, MissedTickBehavior, interval, interval_at, sleep};
use tracing::{error, info, warn};
use uuid::Uuid;

use super::queue::Jobs;
use super::worker_context::{Pace, Threads, WorkerContext};
use crate::compute::{Cores, NoThreads, Solve};

/// Work claimed at once, in microseconds of a core by the rough estimate: many jobs of a millisecond, some members of a population, or one ordinary design, of
/// which two would keep others waiting. While a claim and an end are written their worker computes nothing.
const AT_ONCE: i64 = 80_000;

/// The workers of this process.
pub struct Workers {
    tasks: JoinSet<()>,
    alive: Arc<AtomicUsize>,
}

impl Workers {
    /// Puts jobs that lost their process back into the queue, and starts `count` workers. `in_order` says whether that
    /// process ended in order, and only could not write it down.
    ///
    /// The caller vouches that no other process works on the same database, unless it is shared: then jobs that have lost
    /// their process are found by their leases, and `in_order` says nothing.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started or the database fails.
    pub async fn start(
        jobs: Jobs,
        solve: Solve,
        count: usize,
        pace: Pace,
        in_order: bool,
    ) -> Result<Self, StartError> {
        let context = Arc::new(WorkerContext { jobs, solve, pace });
        let lost = if in_order {
            Lost::InOrder
        } else {
            Lost::Process
        };
        let lost = if context.jobs.store.is_shared() {
            // A job that another process runs belongs to it while it reports.
            context.over(&[])
        } else {
            lost
        };
        context.recover(lost).await.map_err(StartError::Database)?;
        let mut workers = Self::hire(Arc::clone(&context), count)?;
        workers
            .tasks
            .spawn(async move { context.watch_studies().await });
        Ok(workers)
    }

    /// Starts `count` workers beside those of another process on the same database, whose jobs are left alone as long as it
    /// renews their leases.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started.
    pub async fn beside(
        jobs: Jobs,
        solve: Solve,
        count: usize,
        pace: Pace,
    ) -> Result<Self, StartError> {
        Self::hire(Arc::new(WorkerContext { jobs, solve, pace }), count)
    }

    fn hire(context: Arc<WorkerContext>, count: usize) -> Result<Self, StartError> {
        let alive = Arc::new(AtomicUsize::new(0));
        let mut tasks = JoinSet::new();
        for worker in 0..count {
            let alive = Alive::new(&alive);
            let context = Arc::clone(&context);
            let threads = Threads::of(worker, Cores::here().for_each_of(count))?;
            tasks.spawn(async move {
                let _alive = alive;
                context.work(&threads).await;
            });
        }
        tasks.spawn(async move { context.watch_leases().await });
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
    /// The engine has no threads.
    #[error(transparent)]
    Threads(#[from] NoThreads),
    /// The jobs of an earlier process cannot be recovered.
    #[error("the jobs of an earlier process cannot be recovered")]
    Database(#[source] StoreError),
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

impl WorkerContext {
    /// One worker: job after job until the stop.
    async fn work(&self, threads: &Threads) {
        let stop = self.jobs.stop();
        while !stop.is_cancelled() {
            let rung = self.jobs.live.rung();
            match self.claim().await {
                Ok(Claimed {
                    started,
                    given,
                    drained,
                }) => {
                    let found = !started.is_empty() || !given.is_empty();
                    for job in given {
                        info!(job = %job.id, "job given the results of an equal one");
                        self.jobs.live.changed_job(&job);
                    }
                    if !started.is_empty() {
                        // Where one job waited there may be another for the next worker.
                        if !drained {
                            self.jobs.live.work.notify_one();
                        }
                        for Started { job, .. } in &started {
                            self.jobs.live.changed_job(job);
                        }
                        let rung_since = self.compute(started, threads).await;
                        // Jobs that had to wait for this one may begin, also one for a worker of its own. Later jobs find it ended.
                        if !drained || rung_since != rung {
                            self.jobs.live.work.notify_one();
                        }
                    }
                    if !found || drained {
                        tokio::select! {
                            () = self.jobs.live.work.notified() => {}
                            () = stop.cancelled() => {}
                        }
                    }
                }
                Err(error) => {
                    error!(error = %error, "no job can be claimed");
                    // Where the disk is at fault the worker looks again when it is not.
                    tokio::select! {
                        () = sleep(Duration::from_secs(1)) => {}
                        () = stop.cancelled() => {}
                    }
                    self.jobs.wait_for_storage().await;
                }
            }
        }
    }

    async fn claim(&self) -> Result<Claimed, StoreError> {
        let now = self.jobs.clock.now();
        let reader = Reader {
            solver: SOLVER_VERSION,
            documents: DOCUMENT_VERSION,
            at_once: AT_ONCE,
        };
        self.jobs.store.claim(now, self.lease(), reader).await
    }

    /// Looks for leases that have run out until the stop.
    async fn watch_leases(&self) {
        let stop = self.jobs.stop();
        let mut tick = interval_at(Instant::now() + self.watch(), self.watch());
        loop {
            tokio::select! {
                _ = tick.tick() => {}
                () = stop.cancelled() => return,
            }
            let alive = self.jobs.live.ids();
            if let Err(error) = self.recover(self.over(&alive)).await {
                error!(error = %error, "lost jobs cannot be recovered");
            }
        }
    }

    /// Goes on with the studies that another process has left, which may take long: leases are watched meanwhile. Where there is one
    /// process, only one before it can have left something.
    async fn watch_studies(&self) {
        let mut tick = interval(self.watch());
        tick.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                _ = tick.tick() => {}
                () = self.jobs.stop().cancelled() => return,
            }
            match self.jobs.resume_studies().await {
                Ok(()) if !self.jobs.store.is_shared() => return,
                Ok(()) => {}
                Err(error) => {
                    error!(error = %error, "studies that were left cannot be gone on with");
                }
            }
        }
    }

    /// Interval between two looks for jobs that other processes have left.
    fn watch(&self) -> Duration {
        if self.jobs.store.is_shared() {
            // Of several processes each may be the one that is left.
            self.pace.lease / 3
        } else {
            self.pace.lease
        }
    }

    /// Jobs whose lease is over, but for those that are alive.
    fn over<'a>(&self, alive: &'a [Uuid]) -> Lost<'a> {
        let Lease { steady, lasts } = self.lease();
        Lost::Lease {
            steady,
            lasts,
            alive,
        }
    }

    async fn recover(&self, lost: Lost<'_>) -> Result<(), StoreError> {
        let limit = self.pace.attempts_limit;
        let detail = match lost {
            Lost::Process | Lost::InOrder => format!(
                "The service ended {limit} times while it computed this job and no other, so it is not tried again."
            ),
            Lost::Lease { .. } => {
                format!("The job lost {limit} workers, so it is not tried again.")
            }
        };
        let problem = Problem::new(Code::AttemptsExhausted, detail).to_json();
        let now = self.jobs.clock.now();
        let recovered = self.jobs.store.recover(now, lost, limit, &problem).await?;
        for id in recovered {
            warn!(job = %id, "recovered a job that had lost its worker");
            self.jobs.live.changed(id);
            self.jobs.live.ring();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use meshwright_wire::{Results, Submission};
    use metrics::LocalRecorderGuard;
    use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
    use serde_json::json;
    use tokio_util::sync::CancellationToken;

    use super::super::clock::Clock;
    use super::super::queue::{Member, Rules};
    use super::super::resource::Resource as _;
    use super::*;
    use crate::testing::RESULTS;
    use meshwright_store::{By, DatabaseAddress, Job, Status, Store};

    const RULES: Rules = Rules {
        queue_limit: 100,
        client_queue_limit: 100,
        user_queue_limit: None,
        client_design_limit: 100,
        job_memory_mb: 1000,
        memory_mb: 1000,
    };

    /// A small job; each torque is another one.
    fn small(torque: f64) -> Submission {
        let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
        let document = json!({
            "method": "load_distribution",
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [torque],
        });
        Submission::parse(document.to_string().as_bytes()).unwrap()
    }

    /// Results that an engine gives at once; each torque makes another document.
    fn results(torque: f64) -> Results {
        let mut results = Results::read(RESULTS).unwrap();
        results.curves[0].output_torque_n_m = torque;
        results
    }

    /// An engine that gives its results when the test lets it go, once for each job.
    fn gated() -> (mpsc::Sender<()>, Solve) {
        let (go, wait) = mpsc::channel();
        let wait = std::sync::Mutex::new(wait);
        let solve: Solve = Arc::new(move |_, _| {
            wait.lock().unwrap().recv().unwrap();
            Ok(results(1.0))
        });
        (go, solve)
    }

    /// A queue on a file, and how many transactions have been written that waited for the disk, and how many that did not.
    struct Desk {
        jobs: Jobs,
        numbers: PrometheusHandle,
        stop: CancellationToken,
        _recorder: LocalRecorderGuard<'static>,
        _folder: tempfile::TempDir,
    }

    impl Desk {
        async fn new() -> Self {
            let recorder = Box::leak(Box::new(PrometheusBuilder::new().build_recorder()));
            let folder = tempfile::tempdir().unwrap();
            let place = DatabaseAddress::File(folder.path().join("jobs.db"));
            let store = Store::open(&place).await.unwrap();
            let stop = CancellationToken::new();
            Self {
                jobs: Jobs::new(store, RULES, Clock::system(), stop.clone()),
                numbers: recorder.handle(),
                stop,
                _recorder: metrics::set_default_local_recorder(recorder),
                _folder: folder,
            }
        }

        async fn submit(&self, torque: f64) -> Uuid {
            let member = Member::usual("portal");
            let submitted = self.jobs.submit(&member, &small(torque), None).await;
            submitted.unwrap().record.id
        }

        fn commits(&self, waits: &str) -> u32 {
            let line = format!("meshwright_commits_total{{waits=\"{waits}\"}} ");
            let told = self.numbers.render();
            let count = told.lines().find_map(|told| told.strip_prefix(&line));
            count.map_or(0, |count| count.parse().unwrap())
        }

        /// Comes when a job runs.
        async fn runs(&self, id: Uuid) {
            let mut news = self.jobs.news(id);
            while Job::find(&self.jobs, "portal", id).await.unwrap().status != Status::Running {
                news.changed_state().await;
            }
        }

        async fn ended(&self, id: Uuid) -> Job {
            let ended = Job::wait(&self.jobs, "portal", id, Duration::from_secs(60));
            ended.await.unwrap()
        }
    }

    #[tokio::test]
    async fn jobs_that_are_claimed_together_end_in_one_commit_each_with_what_came_of_it() {
        let desk = Desk::new().await;
        let mut ids = Vec::new();
        for torque in 1..=12_u8 {
            ids.push(desk.submit(torque.into()).await);
        }

        // The first one waits for the test, the fourth panics, the fifth cannot be computed.
        let (go, wait) = mpsc::channel::<()>();
        let wait = std::sync::Mutex::new(wait);
        let solve: Solve =
            Arc::new(
                move |submission, _| match submission.case().output_torques[0] {
                    1.0 => {
                        wait.lock().unwrap().recv().unwrap();
                        Ok(results(1.0))
                    }
                    4.0 => panic!("as the test ordered"),
                    5.0 => Err(Problem::new(Code::NotConverged, "as the test ordered")),
                    torque => Ok(results(torque)),
                },
            );
        let pace = Pace {
            gather: Duration::from_secs(3600),
            ..Pace::with_time_limit(Duration::from_secs(3600))
        };
        let workers = Workers::beside(desk.jobs.clone(), solve, 1, pace).await;
        let mut workers = workers.unwrap();
        desk.runs(ids[11]).await;
        Job::cancel(&desk.jobs, "portal", ids[7], By::Owner)
            .await
            .unwrap();
        let before = desk.commits("yes");
        go.send(()).unwrap();
        for id in &ids {
            let ended = desk.ended(*id).await;
            let status = match ids.iter().position(|other| other == id).unwrap() + 1 {
                4 | 5 => Status::Failed,
                8 => Status::Dismissed,
                _ => Status::Successful,
            };
            assert_eq!((ended.status, ended.attempt), (status, 1));
        }
        assert_eq!(desk.commits("yes") - before, 1);
        desk.stop.cancel();
        workers.ended().await;
    }

    #[tokio::test]
    async fn jobs_that_are_claimed_together_are_computed_beside_each_other_on_a_thread_each() {
        let desk = Desk::new().await;
        let first = desk.submit(1.0).await;
        let ids = [first, desk.submit(2.0).await];
        let beside = std::sync::Barrier::new(Cores::here().for_each_of(1).min(ids.len()));
        let solve: Solve = Arc::new(move |submission, _| {
            beside.wait();
            assert_eq!(rayon::current_num_threads(), 1);
            Ok(results(submission.case().output_torques[0]))
        });
        let pace = Pace::with_time_limit(Duration::from_secs(60));
        let workers = Workers::beside(desk.jobs.clone(), solve, 1, pace).await;
        let mut workers = workers.unwrap();
        for id in ids {
            assert_eq!(desk.ended(id).await.status, Status::Successful);
        }
        desk.stop.cancel();
        workers.ended().await;
    }

    #[tokio::test]
    async fn who_waits_for_a_job_is_told_its_end_and_does_not_look_for_it() {
        let desk = Desk::new().await;
        let (go, solve) = gated();
        let pace = Pace::with_time_limit(Duration::from_secs(3600));
        let workers = Workers::beside(desk.jobs.clone(), solve, 1, pace).await;
        let mut workers = workers.unwrap();
        let changes = desk.jobs.changes();
        let id = desk.submit(1.0).await;
        desk.runs(id).await;
        let job = Job::find(&desk.jobs, "portal", id).await.unwrap();
        // From here on whoever looked would find nothing.
        desk.jobs.store.close_readers().await;
        go.send(()).unwrap();
        let ended = desk.jobs.until_ended(changes, job, Duration::from_secs(60));
        let ended = ended.await.unwrap();
        assert_eq!(
            (ended.status, ended.document.is_some()),
            (Status::Successful, true)
        );
        desk.stop.cancel();
        workers.ended().await;
    }

    /// An equal job comes while the last one that waited is computed, which is cancelled or comes to its end.
    async fn equal_job_beside(is_cancelled: bool) -> (Job, Job) {
        let desk = Desk::new().await;
        let first = desk.submit(1.0).await;
        let (go, solve) = gated();
        let pace = Pace::with_time_limit(Duration::from_secs(3600));
        let workers = Workers::beside(desk.jobs.clone(), solve, 2, pace).await;
        let mut workers = workers.unwrap();
        desk.runs(first).await;
        let before = desk.commits("no");
        let equal = desk.submit(1.0).await;
        // The other worker has looked, and left it: nobody rings again until the first one has ended.
        while desk.commits("no") == before {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        if is_cancelled {
            Job::cancel(&desk.jobs, "portal", first, By::Owner)
                .await
                .unwrap();
            go.send(()).unwrap();
        }
        go.send(()).unwrap();
        let ended = (desk.ended(first).await, desk.ended(equal).await);
        desk.stop.cancel();
        workers.ended().await;
        ended
    }

    #[tokio::test]
    async fn an_equal_job_that_came_while_the_last_one_was_computed_is_given_its_results() {
        let (first, equal) = equal_job_beside(false).await;
        assert_eq!(
            (equal.status, equal.same_as),
            (Status::Successful, Some(first.id))
        );
    }

    #[tokio::test]
    async fn an_equal_job_that_came_while_the_last_one_was_cancelled_is_computed() {
        let (first, equal) = equal_job_beside(true).await;
        assert_eq!(
            (first.status, equal.status),
            (Status::Dismissed, Status::Successful)
        );
        assert_eq!(equal.same_as, None);
    }

    #[tokio::test]
    async fn for_one_job_after_the_other_there_are_few_looks_beside_their_claims() {
        let desk = Desk::new().await;
        let solve: Solve =
            Arc::new(|submission, _| Ok(results(submission.case().output_torques[0])));
        let pace = Pace::with_time_limit(Duration::from_secs(3600));
        let workers = Workers::beside(desk.jobs.clone(), solve, 2, pace).await;
        let mut workers = workers.unwrap();
        // Both workers look once when they begin.
        while desk.commits("no") < 2 {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        for torque in 1..=20_u8 {
            let id = desk.submit(torque.into()).await;
            assert_eq!(desk.ended(id).await.status, Status::Successful);
        }
        // Who hears of an end before its worker goes on, and sends another job, makes it look once more.
        assert!((2 + 20..=2 + 2 * 20).contains(&desk.commits("no")));
        assert_eq!(desk.commits("yes"), 2 * 20, "the submission, the end");
        desk.stop.cancel();
        workers.ended().await;
    }
}
