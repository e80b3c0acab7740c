//! Outcomes of a running job: running -> running, successful, failed, or accepted again.

use std::collections::BTreeMap;

use jiff::{SignedDuration, Timestamp};
use serde_json::{Value, json};
use uuid::Uuid;

use super::documents::{Packed, forget_document, insert_documents};
use super::endings::tell_ends;
use super::rows::job_columns;
use super::shares::{self, LaneOf};
use super::statement::{list, query_as};
use super::{Job, Progress, Status, Store, StoreError, column, dialect, micros};

/// A word for one attempt at one job: only the latest claim may report or finish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claim {
    /// The job.
    pub id: Uuid,
    /// The number of the attempt.
    pub attempt: i64,
}

/// A lease that is given now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lease {
    /// The steady time, where leases run by the clock of the one process that there is.
    pub steady: Timestamp,
    /// How long it lasts.
    pub lasts: SignedDuration,
}

/// End and duration of an attempt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct End {
    /// The time of day.
    pub at: Timestamp,
    /// Duration of the attempt, by the steady clock.
    pub elapsed: SignedDuration,
}

/// Outcome of an attempt.
#[derive(Debug, Clone, Copy)]
pub enum Came<'a> {
    /// Results, and their summary for the tables of studies.
    Results {
        /// The results document, or its name.
        document: &'a Packed,
        /// Summary for tables, JSON.
        summary: Option<&'a str>,
    },
    /// The problem document, JSON.
    Problem(&'a str),
}

/// An attempt that is over.
#[derive(Debug, Clone, Copy)]
pub struct Ended<'a> {
    /// The attempt.
    pub claim: Claim,
    /// When it ended.
    pub end: End,
    /// Outcome.
    pub came: Came<'a>,
}

impl Ended<'_> {
    /// The values that a statement reads.
    fn row(&self) -> Value {
        let (status, results, problem) = match self.came {
            Came::Results { document, .. } => (Status::Successful, Some(document.hash()), None),
            Came::Problem(problem) => (Status::Failed, None, Some(problem)),
        };
        json!({
            "job": self.claim.id,
            "claimed": self.claim.attempt,
            "at": self.end.at.as_microsecond(),
            "took": micros(self.end.elapsed).max(0),
            "word": status.as_str(),
            "results": results,
            "fault": problem,
        })
    }
}

/// For each claim whether it is among those that hold, which are ids with attempts.
fn are_among(claims: &[Claim], held: &[(String, i64)]) -> Vec<bool> {
    let held: BTreeMap<&str, i64> = held
        .iter()
        .map(|(id, attempt)| (id.as_str(), *attempt))
        .collect();
    let holds = |claim: &Claim| held.get(claim.id.to_string().as_str()) == Some(&claim.attempt);
    claims.iter().map(holds).collect()
}

impl Store {
    /// For each claim whether it holds: the job runs, and nobody has claimed it since.
    pub async fn hold(&self, claims: &[Claim]) -> Result<Vec<bool>, StoreError> {
        let ids: Vec<Uuid> = claims.iter().map(|claim| claim.id).collect();
        let states: Vec<(String, i64, String)> = query_as(dialect::states())
            .bind(list(&ids))
            .fetch_all(&self.readers)
            .await?;
        let running = states
            .into_iter()
            .filter(|(.., status)| status == Status::Running.as_str());
        let held: Vec<(String, i64)> = running.map(|(id, attempt, _)| (id, attempt)).collect();
        Ok(are_among(claims, &held))
    }

    /// Running -> running for several jobs: how far each has come, and a longer lease. For each, false if its claim holds no more.
    pub async fn report_all(
        &self,
        reports: &[(Claim, Progress)],
        lease: Lease,
    ) -> Result<Vec<bool>, StoreError> {
        let rows: Vec<_> = reports
            .iter()
            .map(|(claim, progress)| {
                json!({
                    "job": claim.id, "claimed": claim.attempt, "solved": column(progress.done), "total": column(progress.total),
                })
            })
            .collect();
        let mut write = self.begin_relaxed().await?;
        let held: Vec<(String, i64)> = query_as(dialect::report())
            .bind(list(&rows))
            .bind(lease.steady.as_microsecond())
            .bind(micros(lease.lasts))
            .fetch_all(&mut *write)
            .await?;
        write.commit().await?;
        let claims: Vec<Claim> = reports.iter().map(|(claim, _)| *claim).collect();
        Ok(are_among(&claims, &held))
    }

    /// Running -> successful or failed for several jobs in one commit, each with its results document and its summary for the tables of studies, or with its
    /// problem document. Returns each job as it has ended; `None` if its claim no longer holds: then nothing of it is stored.
    pub async fn end_all(
        &self,
        ends: &[Ended<'_>],
        solver_version: &str,
    ) -> Result<Vec<Option<Job>>, StoreError> {
        let mut write = self.begin().await?;
        // Whoever keeps equal documents, or dismisses these jobs, takes them in the same order.
        let documents = ends.iter().filter_map(|ended| match ended.came {
            Came::Results { document, summary } => Some((document, summary)),
            Came::Problem(_) => None,
        });
        insert_documents(&mut write, documents).await?;
        let rows: Vec<_> = ends.iter().map(Ended::row).collect();
        let jobs: Vec<Job> = query_as(dialect::end())
            .bind(list(&rows))
            .bind(solver_version)
            .fetch_all(&mut *write)
            .await?;
        if jobs.is_empty() {
            write.rollback().await?;
            return Ok(vec![None; ends.len()]);
        }
        let mut jobs: BTreeMap<Uuid, Job> = jobs.into_iter().map(|job| (job.id, job)).collect();
        let mut ended = Vec::with_capacity(ends.len());
        for end in ends {
            let job = jobs.remove(&end.claim.id);
            if job.is_none()
                && let Came::Results { document, .. } = end.came
            {
                forget_document(&mut write, document.hash()).await?;
            }
            ended.push(job);
        }
        let times = ends.iter().map(|end| end.end.at);
        let told = ended.iter().zip(times);
        let told = told.filter_map(|(job, at)| Some((job.as_ref()?, at)));
        tell_ends(&mut write, told).await?;
        write.commit().await?;
        Ok(ended)
    }

    /// Running -> accepted, because the worker shuts down: this claim does not count as an attempt.
    pub async fn release(&self, claim: Claim) -> Result<bool, StoreError> {
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
            shares::activate(&mut write, &LaneOf::of(job)).await?;
        }
        write.commit().await?;
        Ok(job.is_some())
    }
}
