//! The jobs as handlers see them: submit, look, wait, cancel, delete.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use tokio::sync::{broadcast, mpsc, oneshot};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::job::{Job, Progress, Status};
use super::live::Live;
use super::store::{Cursor, Filter, Store};
use super::transitions::{NewJob, Outcome};
use crate::wire::{SOLVER_VERSION, Submission};

/// The time of day, given so that tests can set it.
pub type Clock = Arc<dyn Fn() -> Timestamp + Send + Sync>;

/// So long a repeated request is recognized by its key.
pub(super) const KEY_LIFETIME: jiff::SignedDuration = jiff::SignedDuration::from_hours(24);

/// So many submissions share one commit at most.
const BATCH: usize = 64;

/// What the queue allows.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// So many jobs may wait, those of studies aside.
    pub queue_limit: u32,
}

/// Why something cannot be done with a job.
#[derive(Debug, Clone, thiserror::Error)]
pub enum JobError {
    /// So many jobs wait that no more are taken.
    #[error("{waiting} jobs wait, which is the limit")]
    QueueFull {
        /// Jobs that wait.
        waiting: i64,
    },
    /// The idempotency key was used for another submission.
    #[error("the idempotency key was used for another submission")]
    KeyConflict,
    /// The client has no such job.
    #[error("there is no job {0}")]
    NotFound(Uuid),
    /// The client has no such study.
    #[error("there is no study {0}")]
    StudyNotFound(Uuid),
    /// The study is to be deleted, but has not ended.
    #[error("the study has not ended")]
    StudyRunning,
    /// The study is to be cancelled, but has ended.
    #[error("the study is {}", .0.as_str())]
    StudyEnded(Status),
    /// The job runs.
    #[error("the job is running")]
    Running,
    /// The job has ended.
    #[error("the job is {}", .0.as_str())]
    Ended(Status),
    /// The service is shutting down.
    #[error("the service is shutting down")]
    ShuttingDown,
    /// The database did not do its part.
    #[error("the database failed")]
    Database(#[source] Arc<sqlx::Error>),
}

impl From<sqlx::Error> for JobError {
    fn from(error: sqlx::Error) -> Self {
        Self::Database(Arc::new(error))
    }
}

/// A job that answers a submission.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted {
    /// The job.
    pub job: Job,
    /// Whether an earlier request with the same key made it.
    pub repeated: bool,
}

/// Some jobs of a list.
#[derive(Debug)]
pub struct Page {
    /// The jobs, newest first.
    pub items: Vec<Job>,
    /// Where the list goes on.
    pub next: Option<Cursor>,
}

/// All jobs: the store, and what of the running ones lives in memory.
#[derive(Clone)]
pub struct Jobs {
    pub(super) store: Store,
    pub(super) live: Arc<Live>,
    pub(super) clock: Clock,
    submissions: mpsc::Sender<Pending>,
    stop: CancellationToken,
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
        tokio::spawn(write_submissions(
            pending,
            store.clone(),
            Arc::clone(&live),
            rules,
            Arc::clone(&clock),
        ));
        Self {
            store,
            live,
            clock,
            submissions,
            stop,
        }
    }

    /// Queues a submission. The answer is given when it is on the disk.
    ///
    /// # Errors
    ///
    /// [`JobError::QueueFull`], [`JobError::KeyConflict`], [`JobError::ShuttingDown`], [`JobError::Database`].
    pub async fn submit(
        &self,
        client: &str,
        submission: &Submission,
        idempotency_key: Option<String>,
    ) -> Result<Submitted, JobError> {
        let job = NewJob {
            id: Uuid::now_v7(),
            client: client.to_owned(),
            method: submission.method().to_owned(),
            tags: submission.tags().to_vec(),
            submission: submission.canonical_json(),
            input_hash: submission.input_hash(),
            positions_total: submission.positions_total(),
            submitted_at: (self.clock)(),
            idempotency_key,
            study: None,
        };
        let (answer, outcome) = oneshot::channel();
        self.submissions
            .send(Pending { job, answer })
            .await
            .map_err(|_| JobError::ShuttingDown)?;
        match outcome.await.map_err(|_| JobError::ShuttingDown)?? {
            Outcome::Queued(job) | Outcome::Known(job) => Ok(Submitted {
                job,
                repeated: false,
            }),
            Outcome::Repeated(job) => Ok(Submitted {
                job: self.with_live_progress(job),
                repeated: true,
            }),
            Outcome::KeyConflict => Err(JobError::KeyConflict),
            Outcome::QueueFull { waiting } => Err(JobError::QueueFull { waiting }),
        }
    }

    /// A job as it stands now.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`], [`JobError::Database`].
    pub async fn find(&self, client: &str, id: Uuid) -> Result<Job, JobError> {
        let job = self
            .store
            .find(client, id)
            .await?
            .ok_or(JobError::NotFound(id))?;
        Ok(self.with_live_progress(job))
    }

    /// A job once it has ended, or as it stands after `patience`.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`], [`JobError::Database`].
    pub async fn wait(&self, client: &str, id: Uuid, patience: Duration) -> Result<Job, JobError> {
        let ended = async {
            let mut news = self.news(id);
            loop {
                let job = self.find(client, id).await?;
                if job.status.has_ended() {
                    return Ok(job);
                }
                news.changed_state().await;
            }
        };
        tokio::select! {
            job = ended => job,
            () = tokio::time::sleep(patience) => self.find(client, id).await,
            () = self.stop.cancelled() => self.find(client, id).await,
        }
    }

    /// At most `limit` jobs, newest first.
    ///
    /// # Errors
    ///
    /// [`JobError::Database`].
    pub async fn list(&self, client: &str, filter: &Filter, limit: u32) -> Result<Page, JobError> {
        // One more than asked for tells whether the list goes on.
        let mut items = self
            .store
            .list(client, filter, limit.saturating_add(1))
            .await?;
        let goes_on = items.len() > limit as usize;
        items.truncate(limit as usize);
        let next = if goes_on {
            items.last().map(Cursor::behind)
        } else {
            None
        };
        Ok(Page {
            items: items
                .into_iter()
                .map(|job| self.with_live_progress(job))
                .collect(),
            next,
        })
    }

    /// The text of the results of a job that was found successful.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`] if it has been deleted since, [`JobError::Database`].
    pub async fn document(&self, job: &Job) -> Result<String, JobError> {
        let Some(hash) = &job.document else {
            return Err(JobError::Ended(job.status));
        };
        self.store
            .document(hash)
            .await?
            .ok_or(JobError::NotFound(job.id))
    }

    /// Ends a job that waits or runs. A job that was cancelled before stays so.
    ///
    /// # Errors
    ///
    /// [`JobError::Ended`] if it is successful or failed, [`JobError::NotFound`], [`JobError::Database`].
    pub async fn cancel(&self, client: &str, id: Uuid) -> Result<Job, JobError> {
        let running = self.live.running(id);
        if let Some(job) = self.store.cancel(client, id, (self.clock)()).await? {
            // If this future is dropped before the stop, the worker's next report finds out.
            if let Some(running) = running.or_else(|| self.live.running(id)) {
                running.stop();
            }
            self.live.changed(id);
            return Ok(job);
        }
        let job = self.find(client, id).await?;
        if job.status == Status::Dismissed {
            Ok(job)
        } else {
            Err(JobError::Ended(job.status))
        }
    }

    /// Removes a job that does not run, and its results.
    ///
    /// # Errors
    ///
    /// [`JobError::Running`], [`JobError::NotFound`], [`JobError::Database`].
    pub async fn delete(&self, client: &str, id: Uuid) -> Result<(), JobError> {
        if self.store.delete(client, id).await? {
            self.live.changed(id);
            return Ok(());
        }
        self.find(client, id).await?;
        Err(JobError::Running)
    }

    /// Numbers of jobs that wait and that run.
    ///
    /// # Errors
    ///
    /// [`JobError::Database`].
    pub async fn depth(&self) -> Result<(i64, i64), JobError> {
        Ok(self.store.depth().await?)
    }

    /// Whether the database takes writes.
    ///
    /// # Errors
    ///
    /// [`JobError::Database`].
    pub async fn check(&self) -> Result<(), JobError> {
        Ok(self.store.check().await?)
    }

    /// What happens to a job from now on.
    pub fn news(&self, id: Uuid) -> News {
        News {
            id,
            live: Arc::clone(&self.live),
            changes: self.live.changes(),
        }
    }

    /// Comes when the service shuts down.
    pub fn stop(&self) -> &CancellationToken {
        &self.stop
    }

    /// The row of a running job is as old as the last report of its worker; its progress is not.
    fn with_live_progress(&self, mut job: Job) -> Job {
        if job.status == Status::Running
            && let Some(running) = self.live.running(job.id)
        {
            job.progress = running.progress();
        }
        job
    }
}

/// What happens to one job.
pub struct News {
    id: Uuid,
    live: Arc<Live>,
    changes: broadcast::Receiver<Uuid>,
}

impl News {
    /// Comes back when the state of the job may have changed.
    pub async fn changed_state(&mut self) {
        loop {
            match self.changes.recv().await {
                Ok(id) if id != self.id => {}
                // One who lags has missed news, perhaps of this job.
                Ok(_) | Err(broadcast::error::RecvError::Lagged(_)) => return,
                Err(broadcast::error::RecvError::Closed) => std::future::pending().await,
            }
        }
    }

    /// Comes back when the state or the progress of the job may have changed, `seen` being the progress known.
    pub async fn changed(&mut self, seen: Option<Progress>) {
        let progress = self.live.running(self.id).map(|running| running.watch());
        let moved = async {
            match progress {
                Some(mut progress) => {
                    // An attempt that ends drops its sender; the change of state follows.
                    if progress.wait_for(|now| Some(*now) != seen).await.is_err() {
                        std::future::pending::<()>().await;
                    }
                }
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            () = self.changed_state() => {}
            () = moved => {}
        }
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
        let forget_before = clock()
            .saturating_sub(KEY_LIFETIME)
            .unwrap_or(Timestamp::MIN);
        // A client that has gone no longer listens; its job stands all the same.
        match store
            .submit(&jobs, rules.queue_limit, forget_before, SOLVER_VERSION)
            .await
        {
            Ok(outcomes) => {
                live.work.notify_one();
                for (answer, outcome) in answers.into_iter().zip(outcomes) {
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
