//! What comes of a job that runs: running -> running, successful, failed, or accepted again.

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use uuid::Uuid;

use super::documents::{Packed, forget_document};
use super::endings::{tell_end, tell_ends};
use super::rows::job_columns;
use super::statement::{query, query_as};
use super::{Store, StoreError, column, dialect, micros, shares};
use crate::jobs::job::{Job, Progress};

/// A word for one attempt at one job: only the latest claim may report or finish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::jobs) struct Claim {
    pub(in crate::jobs) id: Uuid,
    pub(in crate::jobs) attempt: i64,
}

/// A lease that is given now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::jobs) struct Lease {
    /// The steady time, where leases run by the clock of the one process that there is.
    pub(in crate::jobs) steady: Timestamp,
    /// How long it lasts.
    pub(in crate::jobs) lasts: SignedDuration,
}

/// When an attempt ended, and what it took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::jobs) struct End {
    /// The time of day.
    pub(in crate::jobs) at: Timestamp,
    /// What the attempt took, by the steady clock.
    pub(in crate::jobs) elapsed: SignedDuration,
}

/// The results of an attempt.
#[derive(Debug, Clone, Copy)]
pub(in crate::jobs) struct Results<'a> {
    pub(in crate::jobs) claim: Claim,
    pub(in crate::jobs) end: End,
    pub(in crate::jobs) document: &'a Packed,
    /// What the tables of studies show of it.
    pub(in crate::jobs) summary: Option<&'a str>,
}

impl End {
    fn columns(self) -> (i64, i64) {
        (self.at.as_microsecond(), micros(self.elapsed).max(0))
    }
}

impl Store {
    /// Whether a claim holds: the job runs, and nobody has claimed it since.
    pub(in crate::jobs) async fn holds(&self, claim: Claim) -> Result<bool, StoreError> {
        let found =
            query("select 1 from jobs where id = $1 and attempt = $2 and status = 'running'")
                .bind(claim.id.to_string())
                .bind(claim.attempt)
                .exists(&self.readers)
                .await?;
        Ok(found)
    }

    /// Running -> running: how far the job has come, and a longer lease. False if the claim holds no more.
    pub(in crate::jobs) async fn report(
        &self,
        claim: Claim,
        progress: Progress,
        lease: Lease,
    ) -> Result<bool, StoreError> {
        let mut write = self.begin_relaxed().await?;
        let updated = query(dialect::report())
            .bind(claim.id.to_string())
            .bind(claim.attempt)
            .bind(column(progress.done))
            .bind(column(progress.total))
            .bind(lease.steady.as_microsecond())
            .bind(micros(lease.lasts))
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        Ok(updated == 1)
    }

    /// Running -> successful for several jobs in one commit, each with its results document and what the tables of studies show of it.
    /// For each, false if its claim holds no more; then nothing of it is kept.
    pub(in crate::jobs) async fn succeed_all(
        &self,
        results: &[Results<'_>],
        solver_version: &str,
    ) -> Result<Vec<bool>, StoreError> {
        let mut write = self.begin().await?;
        // Whoever keeps equal documents, or dismisses these jobs, takes them in the same order.
        let by_hash: BTreeMap<&str, &Results<'_>> = results
            .iter()
            .map(|result| (result.document.hash(), result))
            .collect();
        for (hash, result) in by_hash {
            result.document.insert(&mut write).await?;
            if let Some(summary) = result.summary {
                query(
                    "insert into summaries (document, body) values ($1, $2) on conflict (document) do nothing",
                )
                .bind(hash)
                .bind(summary)
                .execute(&mut *write)
                .await?;
            }
        }
        if results.len() > 1 {
            let ids: Vec<String> = results
                .iter()
                .map(|result| result.claim.id.to_string())
                .collect();
            query(dialect::lock_jobs())
                .bind(ids.join(","))
                .execute(&mut *write)
                .await?;
        }
        let mut ended = Vec::new();
        let mut held = Vec::with_capacity(results.len());
        for result in results {
            let (at, elapsed) = result.end.columns();
            let job: Option<Job> = query_as(concat!(
                "update jobs
                 set status = 'successful', finished_at = max($3, started_at), elapsed = $4, lease_until = null,
                     document = $5, solver_version = $6, positions_done = positions_total
                 where id = $1 and attempt = $2 and status = 'running'
                 returning ",
                job_columns!()
            ))
            .bind(result.claim.id.to_string())
            .bind(result.claim.attempt)
            .bind(at)
            .bind(elapsed)
            .bind(result.document.hash())
            .bind(solver_version)
            .fetch_optional(&mut *write)
            .await?;
            held.push(job.is_some());
            ended.extend(job.map(|job| (job, result.end.at)));
        }
        if ended.is_empty() {
            write.rollback().await?;
            return Ok(held);
        }
        for (result, _) in results.iter().zip(&held).filter(|(_, held)| !**held) {
            forget_document(&mut write, result.document.hash()).await?;
        }
        tell_ends(&mut write, &ended).await?;
        write.commit().await?;
        Ok(held)
    }

    /// Running -> failed, with the problem document. False if the claim holds no more.
    pub(in crate::jobs) async fn fail(
        &self,
        claim: Claim,
        end: End,
        problem: &str,
    ) -> Result<bool, StoreError> {
        let (at, elapsed) = end.columns();
        let mut write = self.begin().await?;
        let job: Option<Job> = query_as(
            concat!(
            "update jobs
             set status = 'failed', finished_at = max($3, started_at), elapsed = $4, lease_until = null, problem = $5
             where id = $1 and attempt = $2 and status = 'running'
             returning ",
            job_columns!()
        ),
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .bind(at)
        .bind(elapsed)
        .bind(problem)
        .fetch_optional(&mut *write)
        .await?;
        if let Some(job) = &job {
            tell_end(&mut write, job, end.at).await?;
        }
        write.commit().await?;
        Ok(job.is_some())
    }

    /// Running -> accepted, because the worker shuts down: this claim does not count as an attempt.
    pub(in crate::jobs) async fn release(&self, claim: Claim) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let job: Option<Job> = query_as(
            concat!(
            "update jobs
             set status = 'accepted', returned = returned + 1, started_at = null, lease_until = null, positions_done = 0
             where id = $1 and attempt = $2 and status = 'running'
             returning ",
            job_columns!()
        ),
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .fetch_optional(&mut *write)
        .await?;
        if let Some(job) = &job {
            shares::activate(&mut write, &job.client, job.study).await?;
        }
        write.commit().await?;
        Ok(job.is_some())
    }
}
