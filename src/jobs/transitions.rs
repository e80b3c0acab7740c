//! The transitions of a job. Each is one statement, or one transaction, that names the state it leaves; when the job
//! is not in that state the transition does not happen, and says so. Time comes in as an argument.
//!
//! ```text
//!            submit            claim             succeed
//!   (nothing) ----> accepted <=======> running ----------> successful
//!                      |      release,    |  \---> failed      fail
//!                      |      recover     |
//!                      \------------------+------> dismissed   cancel
//! ```

use jiff::Timestamp;
use sha2::{Digest, Sha256};
use sqlx::SqliteConnection;
use uuid::Uuid;

use super::job::{Job, Progress};
use super::store::Store;

/// A job to be queued.
#[derive(Debug, Clone)]
pub(super) struct NewJob {
    pub(super) id: Uuid,
    pub(super) client: String,
    pub(super) method: String,
    pub(super) tags: Vec<String>,
    pub(super) submission: String,
    pub(super) input_hash: String,
    pub(super) positions_total: u64,
    pub(super) submitted_at: Timestamp,
    /// The word under which the client may ask again and get this job.
    pub(super) idempotency_key: Option<String>,
    /// The study that it computes a design of.
    pub(super) study: Option<Uuid>,
}

/// What came of a submission.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// A job waits in the queue.
    Queued(Job),
    /// A job that had its results at once, those of an equal one.
    Known(Job),
    /// The job that the same key and submission got before.
    Repeated(Job),
    /// The key was used for another submission.
    KeyConflict,
    /// So many jobs wait already.
    QueueFull { waiting: i64 },
}

/// A word for one attempt at one job: only the latest claim may report or finish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Claim {
    pub(super) id: Uuid,
    pub(super) attempt: i64,
}

/// What a worker finds in the queue.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Claimed {
    /// The job to compute.
    pub(super) job: Option<Job>,
    /// Jobs that were next, but have been given the results of an equal one.
    pub(super) given: Vec<Job>,
}

/// The job whose turn it is, unless an equal one is running. The index is named because SQLite, which knows nothing of
/// how many jobs run, would rather go through all jobs that the client has ever had.
const NEXT_WAITING: &str = "select id, client, input_hash from jobs as waiting
     where status = 'accepted'
       and not exists (select 1 from jobs as equal indexed by jobs_running
                       where equal.status = 'running' and equal.client = waiting.client
                         and equal.input_hash = waiting.input_hash)
     order by priority, submitted_at, id limit 1";

/// So many jobs are given results in one commit at most.
const MOST_GIVEN: usize = 100;

/// Which running jobs have lost their worker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lost {
    /// All of them: the process that ran them is gone.
    All,
    /// Those whose lease is over.
    Expired,
}

impl Store {
    /// Nothing -> accepted, for several submissions in one commit. (A commit waits for the disk; submissions that
    /// arrive together share the wait.)
    pub(super) async fn submit(
        &self,
        batch: &[NewJob],
        queue_limit: u32,
        forget_keys_before: Timestamp,
        solver_version: &str,
    ) -> Result<Vec<Outcome>, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        sqlx::query("delete from idempotency_keys where created_at < ?1")
            .bind(forget_keys_before.as_microsecond())
            .execute(&mut *transaction)
            .await?;
        let mut room = Room::new(queue_limit);
        let mut outcomes = Vec::with_capacity(batch.len());
        for job in batch {
            outcomes.push(submit_one(&mut transaction, job, &mut room, solver_version).await?);
        }
        transaction.commit().await?;
        Ok(outcomes)
    }

    /// Accepted -> running: the job whose turn it is, leased until `lease_until`. Jobs that stand alone come before those
    /// of studies, older before younger. Equal work is done once: a job whose equal is running is passed over, and one
    /// whose equal has become successful since it was submitted is given its results, accepted -> successful.
    pub(super) async fn claim(
        &self,
        now: Timestamp,
        lease_until: Timestamp,
        solver_version: &str,
    ) -> Result<Claimed, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        let mut claimed = Claimed::default();
        while claimed.given.len() < MOST_GIVEN {
            let next: Option<(String, String, String)> = sqlx::query_as(NEXT_WAITING)
                .fetch_optional(&mut *transaction)
                .await?;
            let Some((id, client, input_hash)) = next else {
                break;
            };
            match find_known(&mut transaction, &client, &input_hash, solver_version).await? {
                Some(known) => {
                    let job = give(&mut transaction, &id, &known, now, solver_version).await?;
                    claimed.given.push(job);
                }
                None => {
                    let job = start(&mut transaction, &id, now, lease_until).await?;
                    claimed.job = Some(job);
                    break;
                }
            }
        }
        transaction.commit().await?;
        Ok(claimed)
    }

    /// Whether a claim holds: the job runs, and nobody has claimed it since.
    pub(super) async fn holds(&self, claim: Claim) -> Result<bool, sqlx::Error> {
        let found: Option<i64> = sqlx::query_scalar(
            "select 1 from jobs where id = ?1 and attempt = ?2 and status = 'running'",
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .fetch_optional(&self.readers)
        .await?;
        Ok(found.is_some())
    }

    /// Running -> running: how far the job has come, and a longer lease. False if the claim holds no more.
    pub(super) async fn report(
        &self,
        claim: Claim,
        progress: Progress,
        lease_until: Timestamp,
    ) -> Result<bool, sqlx::Error> {
        let updated = sqlx::query(
            "update jobs set positions_done = ?3, positions_total = ?4, lease_until = ?5
             where id = ?1 and attempt = ?2 and status = 'running'",
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .bind(column(progress.done))
        .bind(column(progress.total))
        .bind(lease_until.as_microsecond())
        .execute(&self.writer)
        .await?;
        Ok(updated.rows_affected() == 1)
    }

    /// Running -> successful, with the results document and what the tables of studies show of it. False if the claim holds no more; then nothing is kept.
    pub(super) async fn succeed(
        &self,
        claim: Claim,
        now: Timestamp,
        document: &str,
        summary: Option<&str>,
        solver_version: &str,
    ) -> Result<bool, sqlx::Error> {
        let hash: String = Sha256::digest(document)
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        sqlx::query(
            "insert into documents (hash, body) values (?1, ?2) on conflict (hash) do nothing",
        )
        .bind(&hash)
        .bind(document)
        .execute(&mut *transaction)
        .await?;
        if let Some(summary) = summary {
            sqlx::query(
                "insert into summaries (document, body) values (?1, ?2) on conflict (document) do nothing",
            )
            .bind(&hash)
            .bind(summary)
            .execute(&mut *transaction)
            .await?;
        }
        let updated = sqlx::query(
            "update jobs
             set status = 'successful', finished_at = ?3, lease_until = null, document = ?4, solver_version = ?5,
                 positions_done = positions_total
             where id = ?1 and attempt = ?2 and status = 'running'",
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .bind(now.as_microsecond())
        .bind(&hash)
        .bind(solver_version)
        .execute(&mut *transaction)
        .await?;
        let held = updated.rows_affected() == 1;
        if held {
            transaction.commit().await?;
        } else {
            transaction.rollback().await?;
        }
        Ok(held)
    }

    /// Running -> failed, with the problem document. False if the claim holds no more.
    pub(super) async fn fail(
        &self,
        claim: Claim,
        now: Timestamp,
        problem: &str,
    ) -> Result<bool, sqlx::Error> {
        let updated = sqlx::query(
            "update jobs set status = 'failed', finished_at = ?3, lease_until = null, problem = ?4
             where id = ?1 and attempt = ?2 and status = 'running'",
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .bind(now.as_microsecond())
        .bind(problem)
        .execute(&self.writer)
        .await?;
        Ok(updated.rows_affected() == 1)
    }

    /// Running -> accepted, because the worker shuts down: this claim does not count as an attempt.
    pub(super) async fn release(&self, claim: Claim) -> Result<bool, sqlx::Error> {
        let updated = sqlx::query(
            "update jobs
             set status = 'accepted', returned = returned + 1, started_at = null, lease_until = null,
                 positions_done = 0
             where id = ?1 and attempt = ?2 and status = 'running'",
        )
        .bind(claim.id.to_string())
        .bind(claim.attempt)
        .execute(&self.writer)
        .await?;
        Ok(updated.rows_affected() == 1)
    }

    /// Running -> accepted for jobs that have lost their worker, or running -> failed with `problem` for those that
    /// have lost `attempts_limit` of them. Gives back the ids of both, the second ones last.
    pub(super) async fn recover(
        &self,
        now: Timestamp,
        lost: Lost,
        attempts_limit: u32,
        problem: &str,
    ) -> Result<Vec<Uuid>, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        let queued: Vec<String> = sqlx::query_scalar(
            "update jobs set status = 'accepted', started_at = null, lease_until = null, positions_done = 0
             where status = 'running' and (?1 or lease_until < ?2) and attempt - returned < ?3
             returning id",
        )
        .bind(lost == Lost::All)
        .bind(now.as_microsecond())
        .bind(attempts_limit)
        .fetch_all(&mut *transaction)
        .await?;
        let failed: Vec<String> = sqlx::query_scalar(
            "update jobs set status = 'failed', finished_at = ?2, lease_until = null, problem = ?3
             where status = 'running' and (?1 or lease_until < ?2)
             returning id",
        )
        .bind(lost == Lost::All)
        .bind(now.as_microsecond())
        .bind(problem)
        .fetch_all(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(queued
            .iter()
            .chain(&failed)
            .filter_map(|id| id.parse().ok())
            .collect())
    }

    /// Accepted or running -> dismissed. Absent if the client has no such job in these states.
    pub(super) async fn cancel(
        &self,
        client: &str,
        id: Uuid,
        now: Timestamp,
    ) -> Result<Option<Job>, sqlx::Error> {
        sqlx::query_as(
            "update jobs set status = 'dismissed', finished_at = ?3, lease_until = null
             where id = ?1 and client = ?2 and status in ('accepted', 'running')
             returning *",
        )
        .bind(id.to_string())
        .bind(client)
        .bind(now.as_microsecond())
        .fetch_optional(&self.writer)
        .await
    }

    /// Any state but running -> nothing, with the results unless another job has the same. False if the client has
    /// no such job in these states.
    pub(super) async fn delete(&self, client: &str, id: Uuid) -> Result<bool, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        let deleted: Option<Option<String>> = sqlx::query_scalar(
            "delete from jobs where id = ?1 and client = ?2 and status <> 'running' returning document",
        )
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&mut *transaction)
        .await?;
        if let Some(Some(hash)) = &deleted {
            forget_document(&mut transaction, hash).await?;
        }
        transaction.commit().await?;
        Ok(deleted.is_some())
    }
}

/// Removes a document unless a job needs it.
pub(super) async fn forget_document(
    connection: &mut SqliteConnection,
    hash: &str,
) -> Result<(), sqlx::Error> {
    sqlx::query(
        "delete from documents where hash = ?1 and not exists (select 1 from jobs where document = ?1)",
    )
    .bind(hash)
    .execute(connection)
    .await?;
    Ok(())
}

/// The room in the queue, within one transaction: nobody else writes meanwhile, so that one count serves all of it.
struct Room {
    limit: i64,
    waiting: Option<i64>,
}

impl Room {
    fn new(limit: u32) -> Self {
        Self {
            limit: i64::from(limit),
            waiting: None,
        }
    }

    /// Takes one place, or tells how many jobs wait if there is none.
    async fn take(
        &mut self,
        connection: &mut SqliteConnection,
    ) -> Result<Result<(), i64>, sqlx::Error> {
        let waiting = match self.waiting {
            Some(waiting) => waiting,
            None => {
                sqlx::query_scalar(
                    "select count(*) from jobs where status = 'accepted' and priority = 0",
                )
                .fetch_one(connection)
                .await?
            }
        };
        let has_room = waiting < self.limit;
        self.waiting = Some(waiting + i64::from(has_room));
        Ok(if has_room { Ok(()) } else { Err(waiting) })
    }
}

async fn submit_one(
    connection: &mut SqliteConnection,
    new: &NewJob,
    room: &mut Room,
    solver_version: &str,
) -> Result<Outcome, sqlx::Error> {
    let body_hash: String = Sha256::digest(&new.submission)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    if let Some(key) = &new.idempotency_key
        && let Some(outcome) = earlier_answer(connection, &new.client, key, &body_hash).await?
    {
        return Ok(outcome);
    }

    let outcome = if let Some(job) = insert_known(connection, new, solver_version).await? {
        Outcome::Known(job)
    } else {
        if let Err(waiting) = room.take(connection).await? {
            return Ok(Outcome::QueueFull { waiting });
        }
        Outcome::Queued(insert_waiting(connection, new).await?)
    };

    if let Some(key) = &new.idempotency_key {
        sqlx::query("insert into idempotency_keys (client, key, body_hash, job, created_at) values (?1, ?2, ?3, ?4, ?5)")
            .bind(&new.client)
            .bind(key)
            .bind(&body_hash)
            .bind(new.id.to_string())
            .bind(new.submitted_at.as_microsecond())
            .execute(&mut *connection)
            .await?;
    }
    Ok(outcome)
}

/// What the key was answered with before.
async fn earlier_answer(
    connection: &mut SqliteConnection,
    client: &str,
    key: &str,
    body_hash: &str,
) -> Result<Option<Outcome>, sqlx::Error> {
    let earlier: Option<(String, String)> = sqlx::query_as(
        "select body_hash, job from idempotency_keys where client = ?1 and key = ?2",
    )
    .bind(client)
    .bind(key)
    .fetch_optional(&mut *connection)
    .await?;
    let Some((earlier_hash, job)) = earlier else {
        return Ok(None);
    };
    if earlier_hash != body_hash {
        return Ok(Some(Outcome::KeyConflict));
    }
    let job = sqlx::query_as("select * from jobs where id = ?1")
        .bind(job)
        .fetch_one(connection)
        .await?;
    Ok(Some(Outcome::Repeated(job)))
}

/// Finished work that an equal submission can be answered with.
struct Known {
    job: String,
    document: String,
    positions: i64,
}

/// What the client has had computed of the same input by this version.
async fn find_known(
    connection: &mut SqliteConnection,
    client: &str,
    input_hash: &str,
    solver_version: &str,
) -> Result<Option<Known>, sqlx::Error> {
    // The one that was computed comes before those that were given its results.
    let earlier: Option<(String, String, i64)> = sqlx::query_as(
        "select id, document, positions_total from jobs
         where client = ?1 and input_hash = ?2 and solver_version = ?3 and status = 'successful'
         order by same_as is not null, submitted_at, id limit 1",
    )
    .bind(client)
    .bind(input_hash)
    .bind(solver_version)
    .fetch_optional(connection)
    .await?;
    Ok(earlier.map(|(job, document, positions)| Known {
        job,
        document,
        positions,
    }))
}

/// A job that is successful at once, if the client has had the same input computed by this version.
pub(super) async fn insert_known(
    connection: &mut SqliteConnection,
    new: &NewJob,
    solver_version: &str,
) -> Result<Option<Job>, sqlx::Error> {
    let known = find_known(connection, &new.client, &new.input_hash, solver_version).await?;
    let Some(known) = known else {
        return Ok(None);
    };
    sqlx::query_as(
        "insert into jobs (id, client, method, tags, submission, input_hash, status, positions_done, positions_total,
                           submitted_at, started_at, finished_at, document, solver_version, same_as, study, priority)
         values (?1, ?2, ?3, ?4, ?5, ?6, 'successful', ?7, ?7, ?8, ?8, ?8, ?9, ?10, ?11, ?12, ?13)
         returning *",
    )
    .bind(new.id.to_string())
    .bind(&new.client)
    .bind(&new.method)
    .bind(tags(new))
    .bind(&new.submission)
    .bind(&new.input_hash)
    .bind(known.positions)
    .bind(new.submitted_at.as_microsecond())
    .bind(known.document)
    .bind(solver_version)
    .bind(known.job)
    .bind(new.study.map(|study| study.to_string()))
    .bind(priority(new))
    .fetch_one(connection)
    .await
    .map(Some)
}

pub(super) async fn insert_waiting(
    connection: &mut SqliteConnection,
    new: &NewJob,
) -> Result<Job, sqlx::Error> {
    sqlx::query_as(
        "insert into jobs (id, client, method, tags, submission, input_hash, status, positions_total, submitted_at,
                           study, priority)
         values (?1, ?2, ?3, ?4, ?5, ?6, 'accepted', ?7, ?8, ?9, ?10)
         returning *",
    )
    .bind(new.id.to_string())
    .bind(&new.client)
    .bind(&new.method)
    .bind(tags(new))
    .bind(&new.submission)
    .bind(&new.input_hash)
    .bind(column(new.positions_total))
    .bind(new.submitted_at.as_microsecond())
    .bind(new.study.map(|study| study.to_string()))
    .bind(priority(new))
    .fetch_one(connection)
    .await
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
         set status = 'successful', started_at = ?2, finished_at = ?2, document = ?3, solver_version = ?4, same_as = ?5,
             positions_done = ?6, positions_total = ?6
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
) -> Result<Job, sqlx::Error> {
    sqlx::query_as(
        "update jobs
         set status = 'running', attempt = attempt + 1, started_at = ?2, lease_until = ?3, positions_done = 0
         where id = ?1 and status = 'accepted'
         returning *",
    )
    .bind(id)
    .bind(now.as_microsecond())
    .bind(lease_until.as_microsecond())
    .fetch_one(connection)
    .await
}

/// Jobs that stand alone are served before those of studies.
fn priority(new: &NewJob) -> i64 {
    i64::from(new.study.is_some())
}

fn tags(new: &NewJob) -> String {
    serde_json::to_string(&new.tags).expect("a list of strings is JSON")
}

/// SQLite counts in 64 bits with a sign. A count beyond that is only shown, so the nearest will do.
pub(super) fn column(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::super::job::Status;
    use super::super::store::{Cursor, Filter};
    use super::*;
    use tempfile::TempDir;

    const VERSION: &str = "1.0";
    const CLIENT: &str = "portal";

    async fn store() -> (Store, TempDir) {
        let folder = tempfile::tempdir().unwrap();
        (
            Store::open(&folder.path().join("jobs.db")).await.unwrap(),
            folder,
        )
    }

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_second(seconds).unwrap()
    }

    /// A submission at a second; equal inputs are equal work.
    fn new(second: i64, input: &str) -> NewJob {
        NewJob {
            id: Uuid::now_v7(),
            client: CLIENT.to_owned(),
            method: "flexible".to_owned(),
            tags: vec![input.to_owned()],
            submission: format!("{{\"input\":\"{input}\"}}"),
            input_hash: input.to_owned(),
            positions_total: 200,
            submitted_at: at(second),
            idempotency_key: None,
            study: None,
        }
    }

    async fn submit(store: &Store, job: NewJob) -> Outcome {
        store
            .submit(&[job], 10, at(0), VERSION)
            .await
            .unwrap()
            .remove(0)
    }

    async fn queued(store: &Store, second: i64, input: &str) -> Job {
        match submit(store, new(second, input)).await {
            Outcome::Queued(job) => job,
            other => panic!("{other:?}"),
        }
    }

    async fn next(store: &Store, second: i64) -> Option<Job> {
        let claimed = store
            .claim(at(second), at(second + 30), VERSION)
            .await
            .unwrap();
        claimed.job
    }

    async fn claim(store: &Store, second: i64) -> Claim {
        let job = next(store, second).await.unwrap();
        Claim {
            id: job.id,
            attempt: job.attempt,
        }
    }

    async fn find(store: &Store, id: Uuid) -> Job {
        store.find(CLIENT, id).await.unwrap().unwrap()
    }

    #[tokio::test]
    async fn the_oldest_job_is_claimed_first_and_only_once() {
        let (store, _folder) = store().await;
        let second = queued(&store, 2, "b").await;
        let first = queued(&store, 1, "a").await;
        let claimed = next(&store, 10).await.unwrap();
        assert_eq!(
            (claimed.id, claimed.status, claimed.attempt),
            (first.id, Status::Running, 1)
        );
        assert_eq!(claimed.started_at, Some(at(10)));
        assert_eq!(claim(&store, 11).await.id, second.id);
        assert_eq!(next(&store, 12).await, None);
    }

    #[tokio::test]
    async fn a_claim_looks_at_no_job_that_has_ended() {
        let (store, _folder) = store().await;
        let steps: Vec<(i64, i64, i64, String)> = sqlx::query_as(sqlx::AssertSqlSafe(format!(
            "explain query plan {NEXT_WAITING}"
        )))
        .fetch_all(&store.writer)
        .await
        .unwrap();
        // Both indexes leave out what has ended, and the first one has the order of the queue: nothing is sorted.
        let scans = |index: &str| {
            steps
                .iter()
                .filter(|step| step.3.contains(&format!("USING INDEX {index}")))
                .count()
        };
        assert_eq!(
            (scans("jobs_waiting"), scans("jobs_running"), steps.len()),
            (1, 1, 3),
            "{steps:?}"
        );
    }

    #[tokio::test]
    async fn a_job_ends_with_the_very_text_of_its_results() {
        let (store, _folder) = store().await;
        let job = queued(&store, 1, "a").await;
        let claim = claim(&store, 2).await;
        assert!(
            store
                .report(
                    claim,
                    Progress {
                        done: 50,
                        total: 200
                    },
                    at(60)
                )
                .await
                .unwrap()
        );
        assert_eq!(
            find(&store, job.id).await.progress,
            Progress {
                done: 50,
                total: 200
            }
        );
        assert!(
            store
                .succeed(claim, at(5), "{ \"x\": 1.0e0 }", None, VERSION)
                .await
                .unwrap()
        );

        let job = find(&store, job.id).await;
        assert_eq!(
            (job.status, job.progress.percent()),
            (Status::Successful, 100)
        );
        assert_eq!(job.wall_time().unwrap().as_secs(), 3);
        let document = store.document(&job.document.unwrap()).await.unwrap();
        assert_eq!(document.as_deref(), Some("{ \"x\": 1.0e0 }"));
    }

    #[tokio::test]
    async fn only_the_latest_attempt_may_report_or_finish() {
        let (store, _folder) = store().await;
        let job = queued(&store, 1, "a").await;
        let lost = claim(&store, 2).await;
        assert_eq!(
            store.recover(at(33), Lost::Expired, 3, "{}").await.unwrap(),
            [job.id]
        );
        let held = claim(&store, 34).await;
        assert_eq!(held.attempt, 2);

        assert!(
            !store
                .report(lost, Progress::default(), at(90))
                .await
                .unwrap()
        );
        assert!(
            !store
                .succeed(lost, at(35), "{}", None, VERSION)
                .await
                .unwrap()
        );
        assert!(!store.fail(lost, at(35), "{}").await.unwrap());
        assert!(!store.release(lost).await.unwrap());
        assert_eq!(find(&store, job.id).await.status, Status::Running);
        let documents: i64 = sqlx::query_scalar("select count(*) from documents")
            .fetch_one(&store.writer)
            .await
            .unwrap();
        assert_eq!(
            documents, 0,
            "results that come too late leave nothing behind"
        );

        assert!(
            store
                .succeed(held, at(36), "{}", None, VERSION)
                .await
                .unwrap()
        );
    }

    #[tokio::test]
    async fn a_job_that_loses_three_workers_fails() {
        let (store, _folder) = store().await;
        let job = queued(&store, 1, "a").await;
        for attempt in 1..=3 {
            assert_eq!(claim(&store, 2).await.attempt, attempt);
            assert_eq!(
                store
                    .recover(at(3), Lost::All, 3, r#"{"code":"lost"}"#)
                    .await
                    .unwrap(),
                [job.id]
            );
        }
        let job = find(&store, job.id).await;
        assert_eq!((job.status, job.finished_at), (Status::Failed, Some(at(3))));
        assert_eq!(job.problem.unwrap()["code"], "lost");
    }

    #[tokio::test]
    async fn a_lease_that_is_not_over_is_left_alone() {
        let (store, _folder) = store().await;
        queued(&store, 1, "a").await;
        claim(&store, 2).await;
        assert!(
            store
                .recover(at(31), Lost::Expired, 3, "{}")
                .await
                .unwrap()
                .is_empty()
        );
    }

    #[tokio::test]
    async fn a_shutdown_does_not_count_as_an_attempt_but_still_fences() {
        let (store, _folder) = store().await;
        let job = queued(&store, 1, "a").await;
        let given_back = claim(&store, 2).await;
        assert!(store.release(given_back).await.unwrap());
        let waiting = find(&store, job.id).await;
        assert_eq!(
            (waiting.status, waiting.attempts_counted, waiting.started_at),
            (Status::Accepted, 0, None)
        );

        let held = claim(&store, 3).await;
        assert_eq!(find(&store, job.id).await.attempts_counted, 1);
        assert!(
            !store
                .succeed(given_back, at(4), "{}", None, VERSION)
                .await
                .unwrap()
        );
        assert!(
            store
                .succeed(held, at(4), "{}", None, VERSION)
                .await
                .unwrap()
        );
    }

    #[tokio::test]
    async fn a_waiting_and_a_running_job_can_be_cancelled_and_an_ended_one_cannot() {
        let (store, _folder) = store().await;
        let running = queued(&store, 1, "a").await;
        let waiting = queued(&store, 2, "b").await;
        let claim = claim(&store, 3).await;
        for id in [running.id, waiting.id] {
            assert_eq!(
                store
                    .cancel(CLIENT, id, at(4))
                    .await
                    .unwrap()
                    .unwrap()
                    .status,
                Status::Dismissed
            );
            assert_eq!(store.cancel(CLIENT, id, at(5)).await.unwrap(), None);
        }
        assert!(
            !store
                .report(claim, Progress::default(), at(50))
                .await
                .unwrap()
        );
        assert_eq!(next(&store, 6).await, None);
    }

    #[tokio::test]
    async fn equal_input_gets_the_results_at_once_even_after_the_first_job_is_deleted() {
        let (store, _folder) = store().await;
        let first = queued(&store, 1, "a").await;
        assert!(
            store
                .succeed(claim(&store, 2).await, at(3), "{}", None, VERSION)
                .await
                .unwrap()
        );

        let Outcome::Known(second) = submit(&store, new(4, "a")).await else {
            panic!("computed twice")
        };
        assert_eq!(
            (second.status, second.same_as),
            (Status::Successful, Some(first.id))
        );
        let Outcome::Known(third) = submit(&store, new(5, "a")).await else {
            panic!("computed twice")
        };
        assert_eq!(third.same_as, Some(first.id));

        assert!(store.delete(CLIENT, first.id).await.unwrap());
        let second = find(&store, second.id).await;
        assert_eq!(second.same_as, None);
        let hash = second.document.unwrap();
        assert!(store.document(&hash).await.unwrap().is_some());
        assert!(store.delete(CLIENT, second.id).await.unwrap());
        assert!(store.delete(CLIENT, third.id).await.unwrap());
        assert_eq!(
            store.document(&hash).await.unwrap(),
            None,
            "the last job takes the document with it"
        );
    }

    #[tokio::test]
    async fn another_client_or_another_version_computes_afresh() {
        let (store, _folder) = store().await;
        queued(&store, 1, "a").await;
        assert!(
            store
                .succeed(claim(&store, 2).await, at(3), "{}", None, VERSION)
                .await
                .unwrap()
        );
        let mut foreign = new(4, "a");
        foreign.client = "other".to_owned();
        assert!(matches!(submit(&store, foreign).await, Outcome::Queued(_)));
        let upgraded = store
            .submit(&[new(5, "a")], 10, at(0), "2.0")
            .await
            .unwrap();
        assert!(matches!(upgraded[..], [Outcome::Queued(_)]));
    }

    #[tokio::test]
    async fn a_key_answers_with_the_same_job_for_a_day() {
        let (store, _folder) = store().await;
        let keyed = |second, input| NewJob {
            idempotency_key: Some("k".to_owned()),
            ..new(second, input)
        };
        let Outcome::Queued(job) = submit(&store, keyed(1, "a")).await else {
            panic!("not queued")
        };
        assert_eq!(
            submit(&store, keyed(2, "a")).await,
            Outcome::Repeated(job.clone())
        );
        assert_eq!(submit(&store, keyed(3, "b")).await, Outcome::KeyConflict);

        let day = 24 * 60 * 60;
        let next = store
            .submit(&[keyed(day + 2, "b")], 10, at(2), VERSION)
            .await
            .unwrap();
        assert!(
            matches!(next[..], [Outcome::Queued(_)]),
            "the key of second 1 is forgotten: {next:?}"
        );
    }

    #[tokio::test]
    async fn a_key_sees_the_submission_before_it_in_the_same_commit() {
        let (store, _folder) = store().await;
        let keyed = |input| NewJob {
            idempotency_key: Some("k".to_owned()),
            ..new(1, input)
        };
        let outcomes = store
            .submit(&[keyed("a"), keyed("a"), keyed("b")], 10, at(0), VERSION)
            .await
            .unwrap();
        assert!(matches!(
            outcomes[..],
            [
                Outcome::Queued(_),
                Outcome::Repeated(_),
                Outcome::KeyConflict
            ]
        ));
    }

    #[tokio::test]
    async fn a_full_queue_takes_no_more_but_still_knows_what_it_has_done() {
        let (store, _folder) = store().await;
        queued(&store, 1, "done").await;
        assert!(
            store
                .succeed(claim(&store, 2).await, at(3), "{}", None, VERSION)
                .await
                .unwrap()
        );
        let batch = [new(4, "a"), new(4, "b"), new(4, "c"), new(4, "done")];
        let outcomes = store.submit(&batch, 2, at(0), VERSION).await.unwrap();
        assert!(matches!(
            outcomes[..],
            [
                Outcome::Queued(_),
                Outcome::Queued(_),
                Outcome::QueueFull { waiting: 2 },
                Outcome::Known(_)
            ]
        ));
    }

    #[tokio::test]
    async fn a_running_job_is_not_deleted() {
        let (store, _folder) = store().await;
        let job = queued(&store, 1, "a").await;
        claim(&store, 2).await;
        assert!(!store.delete(CLIENT, job.id).await.unwrap());
        assert!(store.cancel(CLIENT, job.id, at(3)).await.unwrap().is_some());
        assert!(!store.delete("other", job.id).await.unwrap());
        assert!(store.delete(CLIENT, job.id).await.unwrap());
        assert_eq!(store.find(CLIENT, job.id).await.unwrap(), None);
    }

    #[tokio::test]
    async fn the_list_turns_its_pages_newest_first_and_selects() {
        let (store, _folder) = store().await;
        let mut jobs = Vec::new();
        for second in [1, 1, 2, 3] {
            jobs.push(queued(&store, second, &format!("input {}", jobs.len())).await);
        }
        let list = async |filter: Filter, limit| {
            let jobs = store.list(CLIENT, &filter, limit).await.unwrap();
            jobs.iter().map(|job| job.id).collect::<Vec<_>>()
        };
        assert_eq!(list(Filter::default(), 2).await, [jobs[3].id, jobs[2].id]);
        let behind = Filter {
            after: Some(Cursor::behind(&jobs[2])),
            ..Filter::default()
        };
        assert_eq!(list(behind, 9).await, [jobs[1].id, jobs[0].id]);
        let tagged = Filter {
            tag: Some("input 1".to_owned()),
            ..Filter::default()
        };
        assert_eq!(list(tagged, 9).await, [jobs[1].id]);
        let these = Filter {
            ids: Some(vec![jobs[0].id, Uuid::nil(), jobs[3].id]),
            ..Filter::default()
        };
        assert_eq!(list(these, 9).await, [jobs[3].id, jobs[0].id]);
        claim(&store, 4).await;
        let running = Filter {
            statuses: Some(vec![Status::Running, Status::Failed]),
            ..Filter::default()
        };
        assert_eq!(list(running, 9).await, [jobs[0].id]);
        assert!(
            list(
                Filter {
                    statuses: Some(vec![]),
                    ..Filter::default()
                },
                9
            )
            .await
            .is_empty()
        );
        assert_eq!(store.depth().await.unwrap(), (3, 1));
    }
}
