//! Nothing -> accepted, or -> successful at once where the same has been computed before.

use std::collections::{BTreeSet, HashMap};

use jiff::Timestamp;
use serde_json::json;
use uuid::Uuid;

use super::documents::checksum;
use super::endings::tell_end;
use super::hash::sha256_hex;
use super::rows::job_columns;
use super::shares::{self, LaneOf};
use super::statement::{Connection, list, query, query_as};
use super::{Job, Kept, Store, StoreError, column, dialect};

/// A job to be queued.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// Its id, a UUID of version 7.
    pub id: Uuid,
    /// Who submits it.
    pub client: String,
    /// The method of the submission.
    pub method: String,
    /// Short words of the client.
    pub tags: Vec<String>,
    /// The submission with every default filled in, JSON.
    pub submission: String,
    /// The version of the submission's document: who reads only earlier ones leaves the job to others.
    pub document_version: i64,
    /// Hash that equal work has in common.
    pub input_hash: String,
    /// Estimated cost in microseconds of a core.
    pub cost: u64,
    /// Mesh positions to solve.
    pub positions_total: u64,
    /// The time of day.
    pub submitted_at: Timestamp,
    /// The word under which the client may ask again and get this job.
    pub idempotency_key: Option<String>,
    /// The study that it computes a design of.
    pub study: Option<Uuid>,
    /// How much of its results is kept.
    pub keep: Kept,
    /// Maximum number of waiting jobs of the client, those of studies aside.
    pub client_limit: u32,
    /// The user of the client who submits it, if the client says.
    pub submitted_by: Option<String>,
    /// Maximum number of waiting jobs of that user.
    pub user_limit: u32,
}

/// Outcome of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A job waits in the queue.
    Queued(Job),
    /// A job that had its results at once, those of an equal one.
    Known(Job),
    /// The job that the same key and submission got before.
    Repeated(Job),
    /// The key was used for another submission.
    KeyConflict,
    /// The limit of waiting jobs is reached.
    QueueFull {
        /// They.
        waiting: i64,
    },
    /// The limit of waiting jobs of this client is reached.
    ClientQueueFull {
        /// They.
        waiting: i64,
    },
    /// The limit of waiting jobs of this user of the client is reached.
    UserQueueFull {
        /// They.
        waiting: i64,
    },
}

/// Limits for a submission.
#[derive(Debug, Clone, Copy)]
pub struct QueueBounds<'a> {
    /// Maximum number of waiting jobs, those of studies aside.
    pub queue_limit: u32,
    /// Keys that are older than this are forgotten.
    pub forget_keys_before: Timestamp,
    /// Now, by the steady clock: the age of keys.
    pub steady: Timestamp,
    /// Only results of this version are given again.
    pub solver_version: &'a str,
}

impl Store {
    /// Nothing -> accepted, for several submissions in one commit. (A commit waits for the disk; submissions that
    /// arrive together share the wait.)
    pub async fn submit(
        &self,
        batch: &[NewJob],
        bounds: QueueBounds<'_>,
    ) -> Result<Vec<Outcome>, StoreError> {
        let mut write = self.begin().await?;
        query(dialect::lock_queue()).execute(&mut *write).await?;
        if batch.iter().any(|job| job.idempotency_key.is_some()) {
            let forget = query("delete from idempotency_keys where created_at < $1")
                .bind(bounds.forget_keys_before.as_microsecond());
            write.later(forget).await?;
        }
        let mut room = Room::new(bounds.queue_limit);
        let mut outcomes = Vec::with_capacity(batch.len());
        let mut lanes = BTreeSet::new();
        for job in batch {
            let outcome = submit_one(&mut write, job, &mut room, bounds).await?;
            if matches!(outcome, Outcome::Queued(_)) {
                lanes.insert(LaneOf {
                    client: job.client.clone(),
                    person: job.submitted_by.clone(),
                    study: job.study,
                });
            }
            outcomes.push(outcome);
        }
        shares::activate_all(&mut write, &lanes).await?;
        write.commit().await?;
        Ok(outcomes)
    }
}

/// The room in the queue, within one transaction: nobody else queues a job meanwhile, so that one count serves all of it.
struct Room {
    limit: i64,
    waiting: Option<Waiting>,
}

/// How many jobs wait, those of studies aside.
#[derive(Default)]
struct Waiting {
    all: i64,
    of_clients: HashMap<String, i64>,
    /// By client and user.
    of_users: HashMap<(String, String), i64>,
}

/// Only clients that have jobs alone that wait are counted, so that designs of studies are not even passed over. Lanes before `"` are of such
/// jobs (`shares`).
pub(super) const WAITING_ALONE: &str =
    "select client, coalesce(submitted_by, ''), count(*) from jobs
     where client in (select client from shares where lane < '\"' and active > 0)
       and status = 'accepted' and coalesce(study, '') = ''
     group by client, submitted_by";

impl Waiting {
    async fn count(connection: &mut Connection) -> Result<Self, sqlx::Error> {
        let counts: Vec<(String, String, i64)> =
            query_as(WAITING_ALONE).fetch_all(connection).await?;
        let mut waiting = Self::default();
        for (client, user, count) in counts {
            waiting.all += count;
            *waiting.of_clients.entry(client.clone()).or_default() += count;
            waiting.of_users.insert((client, user), count);
        }
        Ok(waiting)
    }
}

impl Room {
    fn new(limit: u32) -> Self {
        Self {
            limit: i64::from(limit),
            waiting: None,
        }
    }

    /// Takes a place for a job of its client and user, or says who has none left.
    async fn take(
        &mut self,
        connection: &mut Connection,
        new: &NewJob,
    ) -> Result<Result<(), Outcome>, sqlx::Error> {
        let waiting = match &mut self.waiting {
            Some(waiting) => waiting,
            none => none.insert(Waiting::count(connection).await?),
        };
        if waiting.all >= self.limit {
            let waiting = waiting.all;
            return Ok(Err(Outcome::QueueFull { waiting }));
        }
        let of_client = waiting.of_clients.entry(new.client.clone()).or_default();
        if *of_client >= i64::from(new.client_limit) {
            let waiting = *of_client;
            return Ok(Err(Outcome::ClientQueueFull { waiting }));
        }
        if let Some(user) = &new.submitted_by {
            let key = (new.client.clone(), user.clone());
            let of_user = waiting.of_users.entry(key).or_default();
            if *of_user >= i64::from(new.user_limit) {
                let waiting = *of_user;
                return Ok(Err(Outcome::UserQueueFull { waiting }));
            }
            *of_user += 1;
        }
        *of_client += 1;
        waiting.all += 1;
        Ok(Ok(()))
    }
}

async fn submit_one(
    connection: &mut Connection,
    new: &NewJob,
    room: &mut Room,
    bounds: QueueBounds<'_>,
) -> Result<Outcome, sqlx::Error> {
    let body_hash = sha256_hex(&new.submission);
    if let Some(key) = &new.idempotency_key
        && let Some(outcome) = earlier_answer(connection, new, key, &body_hash).await?
    {
        return Ok(outcome);
    }

    let (client, input) = (&new.client, &new.input_hash);
    let known = find_known(connection, client, input, new.keep, bounds.solver_version).await?;
    let is_known = known.is_some();
    if !is_known {
        let taken = room.take(connection, new);
        if let Err(full) = taken.await? {
            return Ok(full);
        }
    }
    let made = insert_jobs(connection, &[(new, known)], bounds.solver_version).await?;
    let job = made.into_iter().next().ok_or(sqlx::Error::RowNotFound)?;
    let outcome = if is_known {
        tell_end(connection, &job, new.submitted_at).await?;
        Outcome::Known(job)
    } else {
        Outcome::Queued(job)
    };

    insert_submissions(connection, &[new]).await?;
    if let Some(key) = &new.idempotency_key {
        let remember = query("insert into idempotency_keys (client, key, body_hash, job, created_at) values ($1, $2, $3, $4, $5)")
            .bind(&new.client)
            .bind(key)
            .bind(&body_hash)
            .bind(new.id.to_string())
            .bind(bounds.steady.as_microsecond());
        connection.later(remember).await?;
    }
    Ok(outcome)
}

/// The earlier answer to the key.
async fn earlier_answer(
    connection: &mut Connection,
    new: &NewJob,
    key: &str,
    body_hash: &str,
) -> Result<Option<Outcome>, sqlx::Error> {
    let earlier: Option<(String, String, i64)> = query_as(
        "select k.body_hash, k.job, j.document_version from idempotency_keys k join jobs j on j.id = k.job
         where k.client = $1 and k.key = $2",
    )
    .bind(&new.client)
    .bind(key)
    .fetch_optional(&mut *connection)
    .await?;
    let Some((earlier_hash, job, document_version)) = earlier else {
        return Ok(None);
    };
    // Versions that fill in other defaults write the same submission in other words; between them the key has to do.
    let comparable = document_version == new.document_version;
    if comparable && earlier_hash != body_hash {
        return Ok(Some(Outcome::KeyConflict));
    }
    let job = query_as(concat!(
        "select ",
        job_columns!(),
        " from jobs where id = $1"
    ))
    .bind(job)
    .fetch_one(connection)
    .await?;
    Ok(Some(Outcome::Repeated(job)))
}

/// Finished work that an equal submission can be answered with.
pub(super) struct Known {
    pub(super) job: String,
    pub(super) document: String,
    pub(super) positions: i64,
}

/// The client's stored results of the same input by this version, of the wanted extent.
pub(super) async fn find_known(
    connection: &mut Connection,
    client: &str,
    input_hash: &str,
    keep: Kept,
    solver_version: &str,
) -> Result<Option<Known>, sqlx::Error> {
    let earlier: Option<(String, String, i64)> = query_as(dialect::known())
        .bind(client)
        .bind(input_hash)
        .bind(solver_version)
        .bind(i64::from(keep == Kept::Results))
        .fetch_optional(connection)
        .await?;
    Ok(earlier.map(|(job, document, positions)| Known {
        job,
        document,
        positions,
    }))
}

/// New jobs without their submissions, in their order: those of which something is known are successful at once, the others wait. Lanes in
/// which one waits are to be activated behind it.
pub(super) async fn insert_jobs(
    connection: &mut Connection,
    jobs: &[(&NewJob, Option<Known>)],
    solver_version: &str,
) -> Result<Vec<Job>, sqlx::Error> {
    let rows: Vec<_> = jobs
        .iter()
        .map(|(new, known)| {
            let known = known.as_ref();
            json!({
                "job": new.id,
                "owner": new.client,
                "method": new.method,
                "tags": words(&new.tags),
                "input": new.input_hash,
                "cost": column(new.cost),
                "positions": known.map_or(column(new.positions_total), |known| known.positions),
                "at": new.submitted_at.as_microsecond(),
                "results": known.map(|known| &known.document),
                "equal": known.map(|known| &known.job),
                "study": new.study,
                "keep": new.keep.as_str(),
                "version": new.document_version,
                "person": new.submitted_by,
            })
        })
        .collect();
    let mut made: Vec<Job> = query_as(dialect::insert_jobs())
        .bind(list(&rows))
        .bind(solver_version)
        .fetch_all(&mut *connection)
        .await?;
    made.sort_by_key(|job| job.sequence);
    for ((new, _), job) in jobs.iter().zip(&made) {
        insert_tags(connection, new, job.sequence).await?;
    }
    Ok(made)
}

/// The submissions of new jobs.
pub(super) async fn insert_submissions(
    connection: &mut Connection,
    jobs: &[&NewJob],
) -> Result<(), sqlx::Error> {
    let rows: Vec<_> = jobs
        .iter()
        .map(|new| {
            let checksum = checksum(new.submission.as_bytes());
            json!({ "job": new.id, "body": new.submission, "checksum": checksum })
        })
        .collect();
    let insert = query(dialect::insert_submissions()).bind(list(&rows));
    connection.later(insert).await
}

/// The tags of a new job.
async fn insert_tags(
    connection: &mut Connection,
    new: &NewJob,
    sequence: i64,
) -> Result<(), sqlx::Error> {
    let id = new.id.to_string();
    for tag in &new.tags {
        // A tag may stand twice in a submission.
        let insert = query(
            "insert into job_tags (client, tag, sequence, job) values ($1, $2, $3, $4) on conflict do nothing",
        )
        .bind(&new.client)
        .bind(tag)
        .bind(sequence)
        .bind(&id);
        connection.later(insert).await?;
    }
    Ok(())
}

/// A list of words as a column.
pub(super) fn words(words: &[String]) -> String {
    serde_json::to_string(words).expect("a list of strings is JSON")
}
