//! A job as a client looks at it, lists it, cancels it and deletes it.

use std::sync::Arc;
use std::time::Duration;

use meshwright_store::{By, Filter, Job, Status};
use uuid::Uuid;

use super::error::JobError;
use super::listed::Listed;
use super::live::Changes;
use super::queue::Jobs;
use super::resource::Resource;

impl Resource for Job {
    type Filter = Filter;

    async fn find(jobs: &Jobs, client: &str, id: Uuid) -> Result<Self, JobError> {
        let found = jobs.store.find(client, id).await?;
        let job = found.ok_or(JobError::NotFound(id))?;
        Ok(jobs.with_live_progress(job))
    }

    async fn wait(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
        patience: Duration,
    ) -> Result<Self, JobError> {
        let changes = jobs.changes();
        let job = Self::find(jobs, client, id).await?;
        jobs.until_ended(changes, job, patience).await
    }

    async fn list(
        jobs: &Jobs,
        client: &str,
        filter: &Filter,
        limit: u32,
    ) -> Result<Listed<Self>, JobError> {
        let found = jobs.store.list(client, filter, limit + 1).await?;
        let found = found.into_iter().map(|job| jobs.with_live_progress(job));
        Ok(Listed::first(found.collect(), limit, |job| job.sequence))
    }

    async fn owner(jobs: &Jobs, id: Uuid) -> Result<Option<String>, JobError> {
        Ok(jobs.store.owner_of_job(id).await?)
    }

    async fn cancel(jobs: &Jobs, client: &str, id: Uuid, by: By) -> Result<Self, JobError> {
        let running = jobs.live.running(id);
        let cancelled = jobs.store.cancel(client, id, by, jobs.clock.now());
        if let Some(job) = cancelled.await? {
            // If this future is dropped before the stop, the worker's next report finds out.
            if let Some(running) = running.or_else(|| jobs.live.running(id)) {
                running.stop();
            }
            jobs.live.changed_job(&job);
            return Ok(job);
        }
        let job = Self::find(jobs, client, id).await?;
        if job.status == Status::Dismissed {
            Ok(job)
        } else {
            Err(JobError::Ended(job.status))
        }
    }

    async fn delete(jobs: &Jobs, client: &str, id: Uuid, by: By) -> Result<(), JobError> {
        let now = jobs.clock.now();
        if jobs.store.delete(client, id, by, now).await? {
            jobs.live.mail.notify_one();
            jobs.live.changed(id);
            return Ok(());
        }
        Self::find(jobs, client, id).await?;
        Err(JobError::Running)
    }

    fn status(&self) -> Status {
        self.status
    }
}

impl Jobs {
    /// A job that stood like this when the `changes` had begun, once it has ended, or as it stands after `patience`: where its end is among the changes the
    /// store is not asked.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn until_ended(
        &self,
        mut changes: Changes,
        job: Job,
        patience: Duration,
    ) -> Result<Job, JobError> {
        let (client, id) = (job.client.clone(), job.id);
        let look = || Job::find(self, &client, id);
        let ended = async {
            let mut job = job;
            while !job.status.has_ended() {
                job = match changes.end_of(id).await {
                    Some(job) => Arc::unwrap_or_clone(job),
                    None => look().await?,
                };
            }
            Ok(job)
        };
        tokio::select! {
            job = ended => job,
            () = tokio::time::sleep(patience) => look().await,
            () = self.stop().cancelled() => look().await,
        }
    }
}
