//! The jobs as handlers see them: submit, look, wait, cancel, delete.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use meshwright_connections::{Budget, blocking, spawn};
use meshwright_engine::analysis::Method;
use meshwright_store::{
    ClientUsage, Depth, Document, Job, Kept, NewJob, Outcome, QueueBounds, Status, Store,
    StoreError,
};
use meshwright_wire::{
    DOCUMENT_VERSION, SOLVER_VERSION, Submission, memory_above, memory_is_within,
};
use tokio::sync::{Notify, mpsc, oneshot};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::clock::Clock;
use super::error::{JobError, not_done};
use super::listed::Submitted;
use super::live::{Changes, Live, News};
use super::others;
use crate::machine;

/// Time for which a repeated request is recognized by its key.
pub(crate) const KEY_LIFETIME: jiff::SignedDuration = jiff::SignedDuration::from_hours(24);

/// Maximum number of submissions in one commit.
const BATCH: usize = 64;

/// Limits of the queue.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// Maximum number of waiting jobs, not counting those of studies.
    pub queue_limit: u32,
    /// Maximum number of waiting jobs of one client.
    pub client_queue_limit: u32,
    /// Maximum number of waiting jobs of one user of a client; by default half of the client's.
    pub user_queue_limit: Option<u32>,
    /// Maximum number of waiting designs of studies of one client.
    pub client_design_limit: i64,
    /// A job whose computation is estimated to take more memory is refused, in MB.
    pub job_memory_mb: u64,
    /// Everything that is computed at the same time takes no more memory than this, by its estimates, in MB.
    pub memory_mb: u64,
}

impl Rules {
    /// Limits of a single user of the machine: everything that it can compute.
    pub fn of_machine() -> Self {
        let memory_mb = machine::memory_mb();
        Self {
            queue_limit: u32::MAX,
            client_queue_limit: u32::MAX,
            user_queue_limit: None,
            client_design_limit: i64::MAX,
            job_memory_mb: memory_mb,
            memory_mb,
        }
    }

    /// Maximum number of waiting jobs of one user of a client that may have `client_limit`.
    pub fn user_limit(&self, client_limit: u32) -> u32 {
        let usual = client_limit.div_ceil(2);
        self.user_queue_limit.unwrap_or(usual).min(client_limit)
    }
}

/// The submitter and its limits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// The name that its jobs bear.
    pub client: String,
    /// The user of the client, if given. All users of a client see all of its submissions.
    pub user: Option<String>,
    /// Its own limit of waiting jobs, if it differs from the usual one.
    pub queue_limit: Option<u32>,
}

impl Member {
    /// Somebody with the usual bounds.
    pub fn usual(client: &str) -> Self {
        Self {
            client: client.to_owned(),
            user: None,
            queue_limit: None,
        }
    }
}

/// All jobs: the store, and the state of running jobs in memory.
#[derive(Clone)]
pub struct Jobs {
    pub(super) store: Store,
    pub(super) live: Arc<Live>,
    pub(super) clock: Clock,
    pub(super) rules: Rules,
    memory: Budget,
    submissions: mpsc::Sender<Pending>,
    stop: CancellationToken,
}

/// A results document in the store.
#[derive(Debug, Clone)]
pub struct Stored {
    hash: String,
    /// The bytes of its text.
    pub bytes: u64,
}

struct Pending {
    job: NewJob,
    answer: oneshot::Sender<Result<Outcome, JobError>>,
}

impl Jobs {
    /// The jobs in `store`. Those who wait for one are sent away when `stop` comes.
    pub fn new(store: Store, rules: Rules, clock: Clock, stop: CancellationToken) -> Self {
        let live = Arc::new(Live::new());
        let (submissions, pending) = mpsc::channel(BATCH);
        spawn(write_submissions(
            pending,
            store.clone(),
            Arc::clone(&live),
            rules,
            clock.clone(),
        ));
        if store.is_shared() {
            spawn(others::hear(store.clone(), Arc::clone(&live), stop.clone()));
        }
        Self {
            store,
            live,
            clock,
            rules,
            memory: Budget::of(rules.memory_mb),
            submissions,
            stop,
        }
    }

    /// The memory for computations, in MB.
    pub fn memory(&self) -> &Budget {
        &self.memory
    }

    /// Queues a submission. The answer is given when it is on the disk.
    ///
    /// # Errors
    ///
    /// [`JobError::QueueFull`], [`JobError::ClientQueueFull`], [`JobError::UserQueueFull`], [`JobError::TooMuchMemory`],
    /// [`JobError::KeyConflict`], [`JobError::ShuttingDown`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn submit(
        &self,
        member: &Member,
        submission: &Submission,
        idempotency_key: Option<String>,
    ) -> Result<Submitted<Job>, JobError> {
        self.refuse_if_failing()?;
        self.check_memory(&member.client, submission).await?;
        let client_limit = member.queue_limit.unwrap_or(self.rules.client_queue_limit);
        let user_limit = self.rules.user_limit(client_limit);
        let job = NewJob {
            idempotency_key,
            client_limit,
            submitted_by: member.user.clone(),
            user_limit,
            ..new_job(submission, &member.client, self.clock.now())
        };
        let (answer, outcome) = oneshot::channel();
        self.submissions
            .send(Pending { job, answer })
            .await
            .map_err(|_| JobError::ShuttingDown)?;
        match outcome.await.map_err(|_| JobError::ShuttingDown)?? {
            Outcome::Queued(job) | Outcome::Known(job) => Ok(Submitted {
                record: job,
                repeated: false,
            }),
            Outcome::Repeated(job) => Ok(Submitted {
                record: self.with_live_progress(job),
                repeated: true,
            }),
            Outcome::KeyConflict => Err(JobError::KeyConflict),
            Outcome::QueueFull { waiting } => Err(JobError::QueueFull { waiting }),
            Outcome::ClientQueueFull { waiting } => Err(JobError::ClientQueueFull {
                waiting,
                limit: client_limit.into(),
            }),
            Outcome::UserQueueFull { waiting } => Err(JobError::UserQueueFull {
                waiting,
                limit: user_limit.into(),
            }),
        }
    }

    /// Says no at once while nothing can be stored: each try would wait for the disk, or for a lock, behind all others.
    pub(crate) fn refuse_if_failing(&self) -> Result<(), JobError> {
        match self.store.fault() {
            None => Ok(()),
            Some(cause) => Err(JobError::Unavailable(StoreError::unavailable(cause))),
        }
    }

    /// Comes back when it is worth writing again, or the service stops.
    pub(crate) async fn wait_for_storage(&self) {
        const PAUSE: Duration = Duration::from_millis(100);
        let writable = async {
            tokio::time::sleep(PAUSE).await;
            self.store.writable().await;
        };
        tokio::select! {
            () = writable => {}
            () = self.stop().cancelled() => {}
        }
    }

    /// Refuses a job that needs more memory than a job may have. The exact count, where it is needed, runs for `client` on a thread that delays nobody.
    ///
    /// # Errors
    ///
    /// [`JobError::TooMuchMemory`].
    pub async fn check_memory(
        &self,
        client: &str,
        submission: &Submission,
    ) -> Result<(), JobError> {
        let limit_mb = self.rules.job_memory_mb;
        if memory_is_within(submission, limit_mb) {
            return Ok(());
        }
        let submission = submission.clone();
        #[expect(clippy::disallowed_methods, reason = "beside the requests")]
        let above = blocking(client, move |_| memory_above(&submission, limit_mb));
        match above.await.map_err(not_done)? {
            None => Ok(()),
            Some(needed_mb) => Err(JobError::TooMuchMemory {
                needed_mb,
                limit_mb,
            }),
        }
    }

    /// Limits for new rows.
    pub(super) fn bounds(&self) -> QueueBounds<'static> {
        bounds(&self.rules, &self.clock)
    }

    /// The submission of a job that was found, JSON.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`] if it has been deleted since, [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn submission(&self, id: Uuid) -> Result<String, JobError> {
        let text = self.store.submission(id).await?;
        Ok(text.ok_or(JobError::NotFound(id))??)
    }

    /// The same, to be read rather than shown.
    ///
    /// # Errors
    ///
    /// [`JobError::OfLaterVersion`], and as of [`Jobs::submission`].
    pub async fn readable_submission(&self, id: Uuid) -> Result<String, JobError> {
        match self.store.document_version(id).await? {
            Some(version) if version > DOCUMENT_VERSION => Err(JobError::OfLaterVersion),
            _ => self.submission(id).await,
        }
    }

    /// The results of a job that was found successful: where they are, and how many bytes their text has.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`] if it has been deleted since, [`JobError::Ended`] if it has none,
    /// [`JobError::ResultsNotKept`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn stored(&self, job: &Job) -> Result<Stored, JobError> {
        let Some(hash) = &job.document else {
            return Err(JobError::Ended(job.status));
        };
        let (hash, none) = match job.keep {
            Kept::Results => (Some(hash.clone()), JobError::NotFound(job.id)),
            Kept::Statistics => (
                self.store.document_of_equal(job.id).await?,
                JobError::ResultsNotKept(job.id),
            ),
        };
        let Some(hash) = hash else {
            return Err(none);
        };
        match self.store.document_bytes(&hash).await? {
            Some(bytes) => Ok(Stored {
                hash,
                bytes: u64::try_from(bytes).unwrap_or_default(),
            }),
            None => Err(none),
        }
    }

    /// The results of a job that was found successful.
    ///
    /// # Errors
    ///
    /// The documents of [`Jobs::stored`].
    pub async fn document(&self, job: &Job) -> Result<Document, JobError> {
        let stored = self.stored(job).await?;
        self.document_of(job, &stored).await
    }

    /// The results of a job that are stored so.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`] if it has been deleted since, [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn document_of(&self, job: &Job, stored: &Stored) -> Result<Document, JobError> {
        let document = self.store.document(&stored.hash).await?;
        document.ok_or(JobError::NotFound(job.id))
    }

    /// The queue as an operator sees it.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn depth(&self) -> Result<Depth, JobError> {
        Ok(self.store.depth().await?)
    }

    /// Who uses the service: at most `limit` clients behind the one named `after`.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn usage(&self, after: &str, limit: u32) -> Result<Vec<ClientUsage>, JobError> {
        Ok(self.store.usage(after, limit, self.clock.now()).await?)
    }

    /// True if the database takes writes, by its last answer or by one asked for now.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn check(&self) -> Result<(), JobError> {
        self.refuse_if_failing()?;
        Ok(self.store.look().await?)
    }

    /// Forgets idempotency keys that are a day old, also when nobody submits.
    pub(super) async fn forget_keys(&self) -> Result<(), StoreError> {
        self.store
            .forget_keys(self.bounds().forget_keys_before)
            .await
    }

    /// Where everything is kept.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The clocks of the service.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Limits of the queue.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Changes of a job from now on.
    pub fn news(&self, id: Uuid) -> News {
        News {
            id,
            live: Arc::clone(&self.live),
            changes: self.live.changes(),
        }
    }

    /// Everything that happens to jobs and studies, from now on.
    pub fn changes(&self) -> Changes {
        self.live.changes()
    }

    /// Rung when a message to a webhook begins to wait.
    pub(crate) fn mail(&self) -> &Notify {
        &self.live.mail
    }

    /// Comes when the service shuts down.
    pub fn stop(&self) -> &CancellationToken {
        &self.stop
    }

    /// The row of a running job is as old as the last report of its worker; its progress is not.
    pub(super) fn with_live_progress(&self, mut job: Job) -> Job {
        if job.status == Status::Running
            && let Some(running) = self.live.running(job.id)
        {
            job.progress = running.progress();
        }
        job
    }
}

/// A job that stands alone, with the usual bounds.
pub(super) fn new_job(submission: &Submission, client: &str, now: Timestamp) -> NewJob {
    NewJob {
        id: Uuid::now_v7(),
        client: client.to_owned(),
        method: submission.method().to_owned(),
        tags: submission.tags().to_vec(),
        submission: submission.canonical_json(),
        document_version: DOCUMENT_VERSION,
        input_hash: submission.input_hash(),
        cost: rough_cost(submission, false),
        positions_total: submission.positions_total(),
        submitted_at: now,
        idempotency_key: None,
        study: None,
        keep: Kept::Results,
        client_limit: u32::MAX,
        submitted_by: None,
        user_limit: u32::MAX,
    }
}

/// Processor time of a submission in microseconds, estimated from its size; less where the pair as drawn is known from others. The engine's own estimate is
/// better, but takes a tenth of a job. For fair shares the order of magnitude is enough.
pub(super) fn rough_cost(submission: &Submission, is_known_as_drawn: bool) -> u64 {
    // The closed form of the load distribution needs no grid.
    let (as_drawn, per_position) = match submission.case().method() {
        Method::LoadDistribution => (200, 5),
        Method::ThreeDimensional => (4_000_000, 5_000),
        Method::ThreeDimensionalProjected => (4_000_000, 50),
        _ => (40_000, 25),
    };
    let fixed = if is_known_as_drawn { 0 } else { as_drawn };
    submission
        .positions_total()
        .saturating_mul(per_position)
        .saturating_add(fixed)
}

fn bounds(rules: &Rules, clock: &Clock) -> QueueBounds<'static> {
    let steady = clock.steady();
    QueueBounds {
        queue_limit: rules.queue_limit,
        forget_keys_before: steady
            .saturating_sub(KEY_LIFETIME)
            .unwrap_or(Timestamp::MIN),
        steady,
        solver_version: SOLVER_VERSION,
    }
}

/// Writes submissions as they come; those that arrive together share a commit.
async fn write_submissions(
    mut pending: mpsc::Receiver<Pending>,
    store: Store,
    live: Arc<Live>,
    rules: Rules,
    clock: Clock,
) {
    let mut batch = Vec::with_capacity(BATCH);
    while pending.recv_many(&mut batch, BATCH).await > 0 {
        let (jobs, answers): (Vec<_>, Vec<_>) = batch
            .drain(..)
            .map(|Pending { job, answer }| (job, answer))
            .unzip();
        // A client that has gone no longer listens; its job stands all the same.
        match store.submit(&jobs, bounds(&rules, &clock)).await {
            Ok(outcomes) => {
                live.ring();
                for (answer, outcome) in answers.into_iter().zip(outcomes) {
                    if matches!(outcome, Outcome::Known(_)) {
                        live.mail.notify_one();
                    }
                    let _ = answer.send(Ok(outcome));
                }
            }
            Err(error) => {
                let error = JobError::from(error);
                for answer in answers {
                    let _ = answer.send(Err(error.clone()));
                }
            }
        }
    }
}
