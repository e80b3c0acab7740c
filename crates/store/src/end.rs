//! How jobs end, or begin anew, without a worker's doing: they lose it, are cancelled, are deleted.

use std::collections::{BTreeMap, BTreeSet};

use jiff::{SignedDuration, Timestamp};
use uuid::Uuid;

use super::documents::forget_document;
use super::endings::{note_study, tell_end};
use super::outbox::{Event, EventKind, tell};
use super::rows::job_columns;
use super::shares::{self, LaneOf};
use super::statement::query_as;
use super::{By, Job, Store, StoreError, dialect, micros};

/// Which running jobs have lost their worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lost<'a> {
    /// All of them: the process that ran them died.
    Process,
    /// All of them: the process that ran them ended in order, but could not write that down.
    InOrder,
    /// Jobs whose lease has ended, by the steady clock, except those that this process runs. Leases last this long.
    Lease {
        /// The steady time.
        steady: Timestamp,
        /// How long a lease lasts.
        lasts: SignedDuration,
        /// Jobs that this process runs.
        alive: &'a [Uuid],
    },
}

impl Store {
    /// Running -> accepted for jobs that have lost their worker, or running -> failed with `problem` for those that have
    /// lost `attempts_limit` of them by their own fault. Gives back the ids of both.
    ///
    /// A process that dies while one job runs is that job's fault. While several run it is one's, and nobody knows whose:
    /// none is charged, and each is run alone the next time. Where several processes work, one is taken for dead when the
    /// leases of all that it runs are over.
    pub async fn recover(
        &self,
        now: Timestamp,
        lost: Lost<'_>,
        attempts_limit: u32,
        problem: &str,
    ) -> Result<Vec<Uuid>, StoreError> {
        let (steady, lasts) = match lost {
            Lost::Lease { steady, lasts, .. } => (steady, lasts),
            Lost::Process | Lost::InOrder => (Timestamp::UNIX_EPOCH, SignedDuration::ZERO),
        };
        let mut write = self.begin().await?;
        let running: Vec<Held> = query_as(dialect::running())
            .bind(steady.as_microsecond())
            .bind(micros(lasts))
            .fetch_all(&mut *write)
            .await?;
        let lost_jobs = which_are_lost(running, lost, self.is_shared());
        let mut to_activate = BTreeSet::new();
        for (id, (returned, suspect)) in &lost_jobs {
            let (returned, suspect) = (*returned, *suspect);
            let job: Job = query_as(
                concat!(
            "update jobs set status = 'accepted', started_at = null, lease_until = null, positions_done = 0,
                                 returned = returned + $2, suspect = max(suspect, $3)
                 where id = $1 and status = 'running'
                 returning ",
            job_columns!()
        ),
            )
            .bind(id)
            .bind(returned)
            .bind(suspect)
            .fetch_one(&mut *write)
            .await?;
            if job.attempts_counted < i64::from(attempts_limit) {
                to_activate.insert(LaneOf::of(&job));
                continue;
            }
            let job: Job = query_as(concat!(
            "update jobs set status = 'failed', finished_at = max($2, submitted_at), problem = $3
                 where id = $1 and status = 'accepted'
                 returning ",
            job_columns!()
        ))
            .bind(id)
            .bind(now.as_microsecond())
            .bind(problem)
            .fetch_one(&mut *write)
            .await?;
            tell_end(&mut write, &job, now).await?;
        }
        shares::activate_all(&mut write, &to_activate).await?;
        write.commit().await?;
        let ids = lost_jobs.iter().filter_map(|(id, _)| id.parse().ok());
        Ok(ids.collect())
    }

    /// Accepted or running -> dismissed. Absent if the client has no such job in these states.
    pub async fn cancel(
        &self,
        client: &str,
        id: Uuid,
        by: By,
        now: Timestamp,
    ) -> Result<Option<Job>, StoreError> {
        let mut write = self.begin().await?;
        let job: Option<Job> = query_as(
            concat!(
            "update jobs set status = 'dismissed', finished_at = max(max($3, submitted_at), coalesce(started_at, 0)),
                             lease_until = null, dismissed_by = $4
             where id = $1 and client = $2 and status in ('accepted', 'running')
             returning ",
            job_columns!()
        ),
        )
        .bind(id.to_string())
        .bind(client)
        .bind(now.as_microsecond())
        .bind(by.word())
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
    pub async fn delete(
        &self,
        client: &str,
        id: Uuid,
        by: By,
        now: Timestamp,
    ) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let deleted: Option<Job> = query_as(concat!(
            "delete from jobs where id = $1 and client = $2 and status <> 'running' returning ",
            job_columns!()
        ))
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
            if by == By::Administrator {
                let event = Event::of_job(EventKind::JobDeleted, job);
                tell(&mut write, client, event, now).await?;
            }
        }
        write.commit().await?;
        Ok(deleted.is_some())
    }
}

/// A job that runs: its id, the process that runs it, and since how many leases its own is over.
type Held = (String, String, i64);

/// The jobs that have lost their worker; for each, whether that is not charged, and whether it is to be run alone.
fn which_are_lost(running: Vec<Held>, lost: Lost<'_>, shared: bool) -> Vec<(String, (i64, i64))> {
    let alive = match lost {
        Lost::Process => return all(running, |count| i64::from(count > 1)),
        Lost::InOrder => {
            let ids = running.into_iter().map(|(id, _, _)| (id, (1, 0)));
            return ids.collect();
        }
        Lost::Lease { alive, .. } => alive,
    };
    let is_alive = |id: &str| alive.iter().any(|alive| alive.to_string() == id);
    if !shared {
        let over = running.into_iter().filter(|(_, _, over)| *over > 0);
        let lost = over.filter(|(id, _, _)| !is_alive(id));
        return lost.map(|(id, _, _)| (id, (0, 0))).collect();
    }
    let mut of_process: BTreeMap<String, Vec<Held>> = BTreeMap::new();
    for held in running {
        of_process.entry(held.1.clone()).or_default().push(held);
    }
    let mut lost = Vec::new();
    for jobs in of_process.into_values() {
        if jobs.iter().all(|(id, _, over)| *over > 0 && !is_alive(id)) {
            lost.extend(all(jobs, |count| i64::from(count > 1)));
        } else {
            // The process lives, and reports of the others: a worker of it has gone.
            let over = jobs.into_iter().filter(|(_, _, over)| *over > 1);
            let gone = over.filter(|(id, _, _)| !is_alive(id));
            lost.extend(gone.map(|(id, _, _)| (id, (0, 0))));
        }
    }
    lost
}

/// All of them, charged and alone as their number says.
fn all(jobs: Vec<Held>, several: impl Fn(usize) -> i64) -> Vec<(String, (i64, i64))> {
    let several = several(jobs.len());
    let ids = jobs.into_iter().map(|(id, _, _)| (id, (several, several)));
    ids.collect()
}
