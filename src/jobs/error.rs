//! Why something cannot be done with a job or a study.

use meshwright_store::{Damaged, Status, StoreError};
use meshwright_wire::{Code, Problem};
use tokio::task::JoinError;
use tracing::error;
use uuid::Uuid;

/// Why something cannot be done with a job or a study.
#[derive(Debug, Clone, thiserror::Error)]
pub enum JobError {
    /// The limit of waiting jobs is reached.
    #[error("{waiting} jobs wait, which is the limit")]
    QueueFull {
        /// Jobs that wait.
        waiting: i64,
    },
    /// The limit of waiting jobs of this client is reached.
    #[error("{waiting} jobs of yours wait; at most {limit} may")]
    ClientQueueFull {
        /// Jobs of the client that wait.
        waiting: i64,
        /// The limit.
        limit: i64,
    },
    /// The limit of waiting jobs of this user of the client is reached.
    #[error("{waiting} jobs of this user wait; at most {limit} may")]
    UserQueueFull {
        /// Jobs of the user that wait.
        waiting: i64,
        /// The limit.
        limit: i64,
    },
    /// The computation would take more memory than a job may.
    #[error("the job needs about {needed_mb} MB; a job may take {limit_mb} MB here")]
    TooMuchMemory {
        /// Memory that it is estimated to take.
        needed_mb: u64,
        /// The bound.
        limit_mb: u64,
    },
    /// The idempotency key was used for another submission.
    #[error("the idempotency key was used for another submission")]
    KeyConflict,
    /// The client has no such job.
    #[error("there is no job {0}")]
    NotFound(Uuid),
    /// The study of the job keeps statistics only.
    #[error("of job {0} only the statistics were kept")]
    ResultsNotKept(Uuid),
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
    /// A later version of the service took the job, and this one does not read its submission.
    #[error("a later version of the service took the job")]
    OfLaterVersion,
    /// The service is shutting down.
    #[error("the service is shutting down")]
    ShuttingDown,
    /// Nothing can be stored or read now.
    #[error("nothing can be stored now")]
    Unavailable(#[source] StoreError),
    /// The database did not do its part.
    #[error("the database failed")]
    Database(#[source] StoreError),
    /// A stored document cannot be read.
    #[error(transparent)]
    Damaged(#[from] Damaged),
}

impl From<StoreError> for JobError {
    fn from(error: StoreError) -> Self {
        if error.may_pass() {
            Self::Unavailable(error)
        } else {
            Self::Database(error)
        }
    }
}

/// The answer to clients for a document that is damaged. The cause stands in the log.
pub fn damage_problem(error: &Damaged) -> Problem {
    error!(%error, "the database is damaged");
    let detail = "A document that is needed was changed since it was stored, by a fault of the disk or by other means. The failure has been logged.";
    Problem::new(Code::DocumentDamaged, detail)
}

/// The error of work beside the requests that was not done.
///
/// # Panics
///
/// Where the work did.
pub(super) fn not_done(error: JoinError) -> JobError {
    match error.try_into_panic() {
        Ok(panic) => std::panic::resume_unwind(panic),
        // Only a runtime that ends drops such work.
        Err(_) => JobError::ShuttingDown,
    }
}
