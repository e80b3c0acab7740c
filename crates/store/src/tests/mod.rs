//! The store: transitions, turns, damage, retention.

mod faults;
mod file;
mod migration;
mod on_postgres;
mod on_sqlite;
mod plans;
#[path = "../../../../tests/postgres/server.rs"]
mod server;

use jiff::{SignedDuration, Timestamp};
use tempfile::TempDir;
use uuid::Uuid;

use super::statement::{Pool, query, query_as, query_scalar};
use super::{
    By, Came, Claim, DatabaseAddress, End, Ended, Job, Kept, Lease, Lost, NewJob, Outcome, Packed,
    Progress, QueueBounds, Reader, Status, Store, StoreError,
};

const VERSION: &str = "1.0";
const READER: Reader<'static> = Reader {
    solver: VERSION,
    documents: 1,
    at_once: 0,
};

impl Store {
    /// Running -> successful, for one job.
    pub(super) async fn succeed(
        &self,
        claim: Claim,
        end: End,
        document: &Packed,
        summary: Option<&str>,
        solver_version: &str,
    ) -> Result<bool, StoreError> {
        let came = Came::Results { document, summary };
        let ended = Ended { claim, end, came };
        Ok(self.end_all(&[ended], solver_version).await?[0].is_some())
    }

    /// Running -> successful with empty results at a second, for one job: whether they are taken.
    async fn ends(&self, claim: Claim, second: i64) -> bool {
        let results = Packed::of("{}");
        let succeeded = self.succeed(claim, end(second), &results, None, VERSION);
        succeeded.await.unwrap()
    }

    /// Running -> failed, for one job.
    pub(super) async fn fail(
        &self,
        claim: Claim,
        end: End,
        problem: &str,
    ) -> Result<bool, StoreError> {
        let came = Came::Problem(problem);
        let ended = Ended { claim, end, came };
        Ok(self.end_all(&[ended], VERSION).await?[0].is_some())
    }

    /// How far one job has come.
    pub(super) async fn report(
        &self,
        claim: Claim,
        progress: Progress,
        lease: Lease,
    ) -> Result<bool, StoreError> {
        Ok(self.report_all(&[(claim, progress)], lease).await?[0])
    }

    /// True if one claim holds.
    pub(super) async fn holds(&self, claim: Claim) -> Result<bool, StoreError> {
        Ok(self.hold(&[claim]).await?[0])
    }
}

const CLIENT: &str = "portal";

async fn store() -> (Store, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    (open(&folder).await, folder)
}

async fn open(folder: &TempDir) -> Store {
    Store::open(&place(folder)).await.unwrap()
}

fn place(folder: &TempDir) -> DatabaseAddress {
    DatabaseAddress::File(folder.path().join("jobs.db"))
}

/// The connection that writes a file.
fn writer(store: &Store) -> &sqlx::SqlitePool {
    sqlite(&store.writer)
}

/// The connections that read a file.
fn readers(store: &Store) -> &sqlx::SqlitePool {
    sqlite(&store.readers)
}

fn sqlite(pool: &Pool) -> &sqlx::SqlitePool {
    match pool {
        Pool::Sqlite(pool) => pool,
        Pool::Postgres(..) => panic!("this is about files"),
    }
}

fn at(seconds: i64) -> Timestamp {
    Timestamp::from_second(seconds).unwrap()
}

/// The end of an attempt that took three seconds.
fn end(seconds: i64) -> End {
    End {
        at: at(seconds),
        elapsed: SignedDuration::from_secs(3),
    }
}

fn expired(seconds: i64) -> Lost<'static> {
    Lost::Lease {
        steady: at(seconds),
        lasts: SignedDuration::from_secs(30),
        alive: &[],
    }
}

fn bounds(seconds: i64, queue_limit: u32) -> QueueBounds<'static> {
    QueueBounds {
        queue_limit,
        forget_keys_before: at(0),
        steady: at(seconds),
        solver_version: VERSION,
    }
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
        document_version: 1,
        cost: 1000,
        positions_total: 200,
        submitted_at: at(second),
        idempotency_key: None,
        study: None,
        keep: Kept::Results,
        client_limit: u32::MAX,
        submitted_by: None,
        user_limit: u32::MAX,
    }
}

async fn submit(store: &Store, job: NewJob) -> Outcome {
    let bounds = bounds(job.submitted_at.as_second(), 10_000);
    store.submit(&[job], bounds).await.unwrap().remove(0)
}

async fn queued(store: &Store, second: i64, input: &str) -> Job {
    match submit(store, new(second, input)).await {
        Outcome::Queued(job) => job,
        other => panic!("{other:?}"),
    }
}

/// Half a minute from a second on.
fn lease(second: i64) -> Lease {
    Lease {
        steady: at(second),
        lasts: SignedDuration::from_secs(30),
    }
}

async fn next(store: &Store, second: i64) -> Option<Job> {
    let claimed = store.claim(at(second), lease(second), READER).await;
    claimed.unwrap().started.pop().map(|started| started.job)
}

async fn claim(store: &Store, second: i64) -> Claim {
    of(&next(store, second).await.unwrap())
}

fn of(job: &Job) -> Claim {
    Claim {
        id: job.id,
        attempt: job.attempt,
    }
}

async fn find(store: &Store, id: Uuid) -> Job {
    store.find(CLIENT, id).await.unwrap().unwrap()
}

/// A job that has ended with results of its own at a second.
async fn ended(store: &Store, second: i64, input: &str) -> Job {
    let job = queued(store, second, input).await;
    let claim = claim(store, second).await;
    let text = format!("{{\"of\":\"{input}\"}}");
    assert!(
        store
            .succeed(claim, end(second), &Packed::of(&text), None, VERSION)
            .await
            .unwrap()
    );
    find(store, job.id).await
}
