//! Accepted -> running: the job whose turn it is.

use jiff::Timestamp;
use sqlx::SqliteConnection;

use super::endings::tell_end;
use super::shares::{self, Lane};
use super::submit::{Known, find_known};
use super::{Store, StoreError};
use crate::jobs::job::Job;

/// A job that a worker is to compute.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::jobs) struct Started {
    pub(in crate::jobs) job: Job,
    /// The submission with every default filled in, JSON.
    pub(in crate::jobs) submission: String,
}

/// What a worker finds in the queue.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::jobs) struct Claimed {
    /// The job to compute.
    pub(in crate::jobs) started: Option<Started>,
    /// Jobs that were next, but have been given the results of an equal one.
    pub(in crate::jobs) given: Vec<Job>,
}

/// The job of a lane whose turn it is, unless an equal one is running.
pub(super) const NEXT_WAITING: &str = "select id, input_hash, cost from jobs as waiting
     where status = 'accepted' and client = ?1 and coalesce(study, '') = ?2
       and not exists (select 1 from jobs as equal indexed by jobs_running
                       where equal.status = 'running' and equal.client = waiting.client
                         and equal.input_hash = waiting.input_hash)
     order by sequence limit 1";

/// So many jobs are given results in one commit at most.
const MOST_GIVEN: usize = 100;

impl Store {
    /// Accepted -> running: the job whose turn it is, leased until `lease_until`. Equal work is done once: a job whose equal
    /// is running is passed over, and one whose equal has become successful since it was submitted is given its results,
    /// accepted -> successful.
    ///
    /// A job that may have brought a process down is run alone: before it begins, what runs comes to its end, and nothing
    /// begins beside it.
    pub(in crate::jobs) async fn claim(
        &self,
        now: Timestamp,
        lease_until: Timestamp,
        solver_version: &str,
    ) -> Result<Claimed, StoreError> {
        let mut write = self.begin().await?;
        let mut claimed = Claimed::default();
        let next = match suspects(&mut write).await? {
            Suspects::None => next_in_turn(&mut write, now, solver_version, &mut claimed).await?,
            Suspects::Next(id) => Some(id),
            Suspects::Wait => None,
        };
        if let Some(id) = next {
            claimed.started = Some(start(&mut write, &id, now, lease_until).await?);
        }
        write.commit().await?;
        Ok(claimed)
    }
}

/// Whether a job has to be run alone.
enum Suspects {
    /// None has.
    None,
    /// This one, now.
    Next(String),
    /// One runs alone, or is to and others still run.
    Wait,
}

async fn suspects(connection: &mut SqliteConnection) -> Result<Suspects, sqlx::Error> {
    let (running, alone): (i64, i64) = sqlx::query_as(
        "select count(*), coalesce(sum(suspect), 0) from jobs indexed by jobs_running where status = 'running'",
    )
    .fetch_one(&mut *connection)
    .await?;
    if alone > 0 {
        return Ok(Suspects::Wait);
    }
    let next: Option<String> = sqlx::query_scalar(
        "select id from jobs where suspect = 1 and status = 'accepted' order by sequence limit 1",
    )
    .fetch_optional(connection)
    .await?;
    Ok(match next {
        Some(id) if running == 0 => Suspects::Next(id),
        Some(_) => Suspects::Wait,
        None => Suspects::None,
    })
}

/// The job whose turn it is, its lane charged. Jobs before it that need no computing are given their results.
async fn next_in_turn(
    connection: &mut SqliteConnection,
    now: Timestamp,
    solver_version: &str,
    claimed: &mut Claimed,
) -> Result<Option<String>, sqlx::Error> {
    for lane in shares::lanes(connection).await? {
        while claimed.given.len() < MOST_GIVEN {
            let next: Option<(String, String, i64)> = sqlx::query_as(NEXT_WAITING)
                .bind(&lane.client)
                .bind(&lane.lane)
                .fetch_optional(&mut *connection)
                .await?;
            let Some((id, input_hash, cost)) = next else {
                rest_if_empty(connection, &lane).await?;
                break;
            };
            match find_known(connection, &lane.client, &input_hash, solver_version).await? {
                Some(known) => {
                    let job = give(connection, &id, &known, now, solver_version).await?;
                    tell_end(connection, &job, now).await?;
                    claimed.given.push(job);
                }
                None => {
                    lane.charge(connection, cost).await?;
                    return Ok(Some(id));
                }
            }
        }
    }
    Ok(None)
}

/// A lane whose jobs all wait for an equal one keeps its turn.
async fn rest_if_empty(connection: &mut SqliteConnection, lane: &Lane) -> Result<(), sqlx::Error> {
    let waits: Option<i64> = sqlx::query_scalar(
        "select 1 from jobs where status = 'accepted' and client = ?1 and coalesce(study, '') = ?2 limit 1",
    )
    .bind(&lane.client)
    .bind(&lane.lane)
    .fetch_optional(&mut *connection)
    .await?;
    if waits.is_none() {
        lane.rest(connection).await?;
    }
    Ok(())
}

/// Accepted -> successful, with the results of an equal job.
async fn give(
    connection: &mut SqliteConnection,
    id: &str,
    known: &Known,
    now: Timestamp,
    solver_version: &str,
) -> Result<Job, sqlx::Error> {
    sqlx::query_as(
        "update jobs
         set status = 'successful', started_at = max(?2, submitted_at), finished_at = max(?2, submitted_at), elapsed = 0,
             document = ?3, solver_version = ?4, same_as = ?5, positions_done = ?6, positions_total = ?6
         where id = ?1 and status = 'accepted'
         returning *",
    )
    .bind(id)
    .bind(now.as_microsecond())
    .bind(&known.document)
    .bind(solver_version)
    .bind(&known.job)
    .bind(known.positions)
    .fetch_one(connection)
    .await
}

/// Accepted -> running.
async fn start(
    connection: &mut SqliteConnection,
    id: &str,
    now: Timestamp,
    lease_until: Timestamp,
) -> Result<Started, sqlx::Error> {
    let job = sqlx::query_as(
        "update jobs
         set status = 'running', attempt = attempt + 1, started_at = max(?2, submitted_at), lease_until = ?3,
             positions_done = 0
         where id = ?1 and status = 'accepted'
         returning *",
    )
    .bind(id)
    .bind(now.as_microsecond())
    .bind(lease_until.as_microsecond())
    .fetch_one(&mut *connection)
    .await?;
    let submission = sqlx::query_scalar("select body from submissions where job = ?1")
        .bind(id)
        .fetch_one(connection)
        .await?;
    Ok(Started { job, submission })
}
