//! How jobs end, or begin anew, without a worker's doing: they lose it, are cancelled, are deleted.

use jiff::Timestamp;
use uuid::Uuid;

use super::documents::forget_document;
use super::endings::{note_study, tell_end};
use super::{Store, StoreError, shares};
use crate::jobs::job::Job;

/// Which running jobs have lost their worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::jobs) enum Lost<'a> {
    /// All of them: the process that ran them died.
    Process,
    /// All of them: the process that ran them ended in order, but could not write that down.
    InOrder,
    /// Those whose lease is over, by the steady clock, but for those that this process knows to run.
    Lease {
        steady: Timestamp,
        alive: &'a [Uuid],
    },
}

impl Store {
    /// Running -> accepted for jobs that have lost their worker, or running -> failed with `problem` for those that have
    /// lost `attempts_limit` of them by their own fault. Gives back the ids of both.
    ///
    /// A process that dies while one job runs is that job's fault. While several run it is one's, and nobody knows whose:
    /// none is charged, and each is run alone the next time.
    pub(in crate::jobs) async fn recover(
        &self,
        now: Timestamp,
        lost: Lost<'_>,
        attempts_limit: u32,
        problem: &str,
    ) -> Result<Vec<Uuid>, StoreError> {
        let mut write = self.begin().await?;
        let running: Vec<(String, i64)> = sqlx::query_as(
            "select id, lease_until from jobs indexed by jobs_running where status = 'running'",
        )
        .fetch_all(&mut *write)
        .await?;
        let is_lost = |(id, lease_until): &(String, i64)| match lost {
            Lost::Process | Lost::InOrder => true,
            Lost::Lease { steady, alive } => {
                *lease_until < steady.as_microsecond()
                    && !alive.iter().any(|alive| alive.to_string() == *id)
            }
        };
        let ids: Vec<String> = running
            .into_iter()
            .filter(is_lost)
            .map(|(id, _)| id)
            .collect();
        let (returned, suspect) = match lost {
            Lost::Process if ids.len() > 1 => (1, 1),
            Lost::InOrder => (1, 0),
            Lost::Process | Lost::Lease { .. } => (0, 0),
        };
        for id in &ids {
            let job: Job = sqlx::query_as(
                "update jobs set status = 'accepted', started_at = null, lease_until = null, positions_done = 0,
                                 returned = returned + ?2, suspect = max(suspect, ?3)
                 where id = ?1 and status = 'running'
                 returning *",
            )
            .bind(id)
            .bind(returned)
            .bind(suspect)
            .fetch_one(&mut *write)
            .await?;
            if job.attempts_counted < i64::from(attempts_limit) {
                shares::activate(&mut write, &job.client, job.study).await?;
                continue;
            }
            let job: Job = sqlx::query_as(
                "update jobs set status = 'failed', finished_at = max(?2, submitted_at), problem = ?3
                 where id = ?1 and status = 'accepted'
                 returning *",
            )
            .bind(id)
            .bind(now.as_microsecond())
            .bind(problem)
            .fetch_one(&mut *write)
            .await?;
            tell_end(&mut write, &job, now).await?;
        }
        write.commit().await?;
        Ok(ids.iter().filter_map(|id| id.parse().ok()).collect())
    }

    /// Accepted or running -> dismissed. Absent if the client has no such job in these states.
    pub(in crate::jobs) async fn cancel(
        &self,
        client: &str,
        id: Uuid,
        now: Timestamp,
    ) -> Result<Option<Job>, StoreError> {
        let mut write = self.begin().await?;
        let job: Option<Job> = sqlx::query_as(
            "update jobs set status = 'dismissed', finished_at = max(?3, submitted_at, coalesce(started_at, 0)),
                             lease_until = null
             where id = ?1 and client = ?2 and status in ('accepted', 'running')
             returning *",
        )
        .bind(id.to_string())
        .bind(client)
        .bind(now.as_microsecond())
        .fetch_optional(&mut *write)
        .await?;
        if let Some(job) = &job {
            tell_end(&mut write, job, now).await?;
        }
        write.commit().await?;
        Ok(job)
    }

    /// Any state but running -> nothing, with the results unless another job has the same. False if the client has
    /// no such job in these states.
    pub(in crate::jobs) async fn delete(&self, client: &str, id: Uuid) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let deleted: Option<Job> = sqlx::query_as(
            "delete from jobs where id = ?1 and client = ?2 and status <> 'running' returning *",
        )
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&mut *write)
        .await?;
        if let Some(job) = &deleted {
            if let Some(hash) = &job.document {
                forget_document(&mut write, hash).await?;
            }
            if let Some(study) = job.study {
                // With its last waiting design a study has ended.
                note_study(&mut write, study, job.submitted_at).await?;
            }
        }
        write.commit().await?;
        Ok(deleted.is_some())
    }
}
