//! Common interface of jobs and studies, which a client submits and lists.

use std::time::Duration;

use meshwright_store::{By, Status};
use uuid::Uuid;

use super::error::JobError;
use super::listed::Listed;
use super::queue::Jobs;

/// A job or a study of a client.
///
/// Each method fails with [`JobError::Unavailable`] or [`JobError::Database`] if the store does, and with [`JobError::NotFound`] or
/// [`JobError::StudyNotFound`] where the client has none of this id.
pub trait Resource: Sized + Send + Sync {
    /// Which of them to list.
    type Filter: Sync;

    /// The item in its present state.
    fn find(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
    ) -> impl Future<Output = Result<Self, JobError>> + Send;

    /// The item once it has ended, or after `patience`.
    fn wait(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
        patience: Duration,
    ) -> impl Future<Output = Result<Self, JobError>> + Send;

    /// At most `limit` of them, newest first.
    fn list(
        jobs: &Jobs,
        client: &str,
        filter: &Self::Filter,
        limit: u32,
    ) -> impl Future<Output = Result<Listed<Self>, JobError>> + Send;

    /// The client that submitted the one of this id, if there is one.
    fn owner(
        jobs: &Jobs,
        id: Uuid,
    ) -> impl Future<Output = Result<Option<String>, JobError>> + Send;

    /// Ends the item: waiting and running parts are dismissed, finished ones keep their results. A cancelled one stays cancelled.
    ///
    /// # Errors
    ///
    /// [`JobError::Ended`] or [`JobError::StudyEnded`] if it has ended otherwise.
    fn cancel(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
        by: By,
    ) -> impl Future<Output = Result<Self, JobError>> + Send;

    /// Removes it, with its results.
    ///
    /// # Errors
    ///
    /// [`JobError::Running`] or [`JobError::StudyRunning`] if it is being computed.
    fn delete(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
        by: By,
    ) -> impl Future<Output = Result<(), JobError>> + Send;

    /// Where it stands.
    fn status(&self) -> Status;
}
