//! The transitions of a study. Its designs are jobs, whose own transitions stand in `transitions`; here is what concerns
//! many of them at once: their beginning, chunk after chunk, and their end when the study is cancelled or deleted.

use jiff::Timestamp;
use sqlx::SqliteConnection;
use uuid::Uuid;

use super::job::Status;
use super::store::{Cursor, Store};
use super::study::StudyRecord;
use super::transitions::{NewJob, column, forget_document, insert_known, insert_waiting};
use crate::wire::warning::GearName;

/// So many jobs of studies may wait; further studies are refused.
pub(super) const MOST_WAITING_DESIGNS: i64 = 50_000;

/// So many jobs are deleted in one commit.
const DELETED_AT_ONCE: u32 = 200;

/// A study to be kept.
#[derive(Debug, Clone)]
pub(super) struct NewStudy {
    pub(super) id: Uuid,
    pub(super) client: String,
    pub(super) document: String,
    pub(super) body_hash: String,
    pub(super) gear: GearName,
    pub(super) total: u64,
    pub(super) submitted_at: Timestamp,
    /// The word under which the client may ask again and get this study.
    pub(super) idempotency_key: Option<String>,
}

/// A row to be kept.
#[derive(Debug, Clone)]
pub(super) struct NewRow {
    pub(super) label: String,
    /// JSON.
    pub(super) changes: String,
    /// The job, or the problem document of a design that cannot be built.
    pub(super) job: Result<NewJob, String>,
}

/// What came of a study.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum StudyOutcome {
    /// It stands, with its first rows.
    Taken,
    /// The study that the same key and document got before.
    Repeated(Uuid),
    /// The key was used for another study.
    KeyConflict,
    /// So many designs wait already.
    QueueFull { waiting: i64 },
}

/// A row as it is read.
#[derive(Debug, Clone, sqlx::FromRow)]
pub(super) struct StoredRow {
    pub(super) label: String,
    pub(super) changes: String,
    pub(super) job: Option<String>,
    pub(super) status: Option<Status>,
    pub(super) summary: Option<String>,
    pub(super) problem: Option<String>,
}

/// A study with the counts of its jobs, each from an index.
const SELECT: &str = "select id, document, gear, total, expanded, submitted_at, cancelled_at,
    (select count(*) from study_rows where study = studies.id and job is null) as without_job,
    (select count(*) from jobs where study = studies.id and status = 'accepted') as accepted,
    (select count(*) from jobs where study = studies.id and status = 'running') as running,
    (select count(*) from jobs where study = studies.id and status = 'successful') as successful,
    (select count(*) from jobs where study = studies.id and status = 'failed') as failed,
    (select count(*) from jobs where study = studies.id and status = 'dismissed') as dismissed,
    (select max(finished_at) from jobs where study = studies.id) as last_end
    from studies";

impl Store {
    /// Nothing -> a study with its first rows.
    pub(super) async fn begin_study(
        &self,
        study: &NewStudy,
        rows: &[NewRow],
        forget_keys_before: Timestamp,
        solver_version: &str,
    ) -> Result<StudyOutcome, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        sqlx::query(
            "update studies set idempotency_key = null where idempotency_key is not null and submitted_at < ?1",
        )
        .bind(forget_keys_before.as_microsecond())
        .execute(&mut *transaction)
        .await?;
        if let Some(key) = &study.idempotency_key {
            let earlier: Option<(String, String)> = sqlx::query_as(
                "select id, body_hash from studies where client = ?1 and idempotency_key = ?2",
            )
            .bind(&study.client)
            .bind(key)
            .fetch_optional(&mut *transaction)
            .await?;
            if let Some((id, body_hash)) = earlier {
                return Ok(match id.parse() {
                    Ok(id) if body_hash == study.body_hash => StudyOutcome::Repeated(id),
                    _ => StudyOutcome::KeyConflict,
                });
            }
        }
        let waiting: i64 = sqlx::query_scalar(
            "select (select count(*) from jobs where status = 'accepted' and priority > 0)
                  + (select coalesce(sum(total - expanded), 0) from studies
                     where expanded < total and cancelled_at is null)",
        )
        .fetch_one(&mut *transaction)
        .await?;
        if waiting.saturating_add(column(study.total)) > MOST_WAITING_DESIGNS {
            return Ok(StudyOutcome::QueueFull { waiting });
        }
        sqlx::query(
            "insert into studies (id, client, document, body_hash, gear, total, expanded, submitted_at, idempotency_key)
             values (?1, ?2, ?3, ?4, ?5, ?6, 0, ?7, ?8)",
        )
        .bind(study.id.to_string())
        .bind(&study.client)
        .bind(&study.document)
        .bind(&study.body_hash)
        .bind(study.gear.word())
        .bind(column(study.total))
        .bind(study.submitted_at.as_microsecond())
        .bind(&study.idempotency_key)
        .execute(&mut *transaction)
        .await?;
        append(&mut transaction, study.id, 0, rows, solver_version).await?;
        transaction.commit().await?;
        Ok(StudyOutcome::Taken)
    }

    /// The rows behind the first `expanded` ones. False if the study has not just so many rows, or wants no more.
    pub(super) async fn continue_study(
        &self,
        id: Uuid,
        expanded: u64,
        rows: &[NewRow],
        solver_version: &str,
    ) -> Result<bool, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        let stands: Option<i64> = sqlx::query_scalar(
            "select 1 from studies where id = ?1 and expanded = ?2 and cancelled_at is null",
        )
        .bind(id.to_string())
        .bind(column(expanded))
        .fetch_optional(&mut *transaction)
        .await?;
        if stands.is_none() {
            return Ok(false);
        }
        append(&mut transaction, id, expanded, rows, solver_version).await?;
        transaction.commit().await?;
        Ok(true)
    }

    /// The studies that do not have all their rows: ids and clients.
    pub(super) async fn unfinished_expansions(&self) -> Result<Vec<(Uuid, String)>, sqlx::Error> {
        let found: Vec<(String, String)> = sqlx::query_as(
            "select id, client from studies where expanded < total and cancelled_at is null order by submitted_at, id",
        )
        .fetch_all(&self.readers)
        .await?;
        Ok(found
            .into_iter()
            .filter_map(|(id, client)| Some((id.parse().ok()?, client)))
            .collect())
    }

    /// A study of a client.
    pub(super) async fn find_study(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<Option<StudyRecord>, sqlx::Error> {
        sqlx::query_as(sqlx::AssertSqlSafe(format!(
            "{SELECT} where id = ?1 and client = ?2"
        )))
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&self.readers)
        .await
    }

    /// At most `limit` studies of a client behind a place in the list, newest first.
    pub(super) async fn list_studies(
        &self,
        client: &str,
        after: Option<Cursor>,
        limit: u32,
    ) -> Result<Vec<StudyRecord>, sqlx::Error> {
        sqlx::query_as(sqlx::AssertSqlSafe(format!(
            "{SELECT} where client = ?1 and (?2 is null or (submitted_at, id) < (?2, ?3))
             order by submitted_at desc, id desc limit ?4"
        )))
        .bind(client)
        .bind(after.map(|cursor| cursor.submitted_at.as_microsecond()))
        .bind(after.map(|cursor| cursor.id.to_string()))
        .bind(limit)
        .fetch_all(&self.readers)
        .await
    }

    /// The rows of a study, in their order.
    pub(super) async fn study_rows(&self, id: Uuid) -> Result<Vec<StoredRow>, sqlx::Error> {
        sqlx::query_as(
            "select r.label, r.changes, r.job, j.status, s.body as summary, coalesce(r.problem, j.problem) as problem
             from study_rows r
             left join jobs j on j.id = r.job
             left join summaries s on s.document = j.document
             where r.study = ?1
             order by r.position",
        )
        .bind(id.to_string())
        .fetch_all(&self.readers)
        .await
    }

    /// Accepted or running -> dismissed, for a study and its jobs. Gives back the ids of the jobs; none if the client
    /// has no such study in these states.
    pub(super) async fn cancel_study(
        &self,
        client: &str,
        id: Uuid,
        now: Timestamp,
    ) -> Result<Option<Vec<Uuid>>, sqlx::Error> {
        let mut transaction = self.writer.begin_with("begin immediate").await?;
        let cancelled = sqlx::query(
            "update studies set cancelled_at = ?3
             where id = ?1 and client = ?2 and cancelled_at is null
               and (expanded < total
                    or exists (select 1 from jobs where study = ?1 and status in ('accepted', 'running')))",
        )
        .bind(id.to_string())
        .bind(client)
        .bind(now.as_microsecond())
        .execute(&mut *transaction)
        .await?;
        if cancelled.rows_affected() == 0 {
            return Ok(None);
        }
        let jobs: Vec<String> = sqlx::query_scalar(
            "update jobs set status = 'dismissed', finished_at = ?2, lease_until = null
             where study = ?1 and status in ('accepted', 'running')
             returning id",
        )
        .bind(id.to_string())
        .bind(now.as_microsecond())
        .fetch_all(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(Some(jobs.iter().filter_map(|id| id.parse().ok()).collect()))
    }

    /// Ended -> nothing, for a study, its jobs, and their results unless another job has the same. False if the client
    /// has no such study, or it has not ended. Commits some jobs at a time, so that others may write meanwhile.
    pub(super) async fn delete_study(&self, client: &str, id: Uuid) -> Result<bool, sqlx::Error> {
        loop {
            let mut transaction = self.writer.begin_with("begin immediate").await?;
            let ended: Option<i64> = sqlx::query_scalar(
                "select 1 from studies where id = ?1 and client = ?2
                   and (cancelled_at is not null or expanded = total)
                   and not exists (select 1 from jobs where study = ?1 and status in ('accepted', 'running'))",
            )
            .bind(id.to_string())
            .bind(client)
            .fetch_optional(&mut *transaction)
            .await?;
            if ended.is_none() {
                return Ok(false);
            }
            let documents: Vec<Option<String>> = sqlx::query_scalar(
                "delete from jobs where id in (select id from jobs where study = ?1 limit ?2) returning document",
            )
            .bind(id.to_string())
            .bind(DELETED_AT_ONCE)
            .fetch_all(&mut *transaction)
            .await?;
            for hash in documents.iter().flatten() {
                forget_document(&mut transaction, hash).await?;
            }
            let last = documents.is_empty();
            if last {
                sqlx::query("delete from studies where id = ?1")
                    .bind(id.to_string())
                    .execute(&mut *transaction)
                    .await?;
            }
            transaction.commit().await?;
            if last {
                return Ok(true);
            }
        }
    }
}

/// Adds rows behind the first `expanded` ones, with their jobs.
async fn append(
    connection: &mut SqliteConnection,
    study: Uuid,
    expanded: u64,
    rows: &[NewRow],
    solver_version: &str,
) -> Result<(), sqlx::Error> {
    for (position, row) in (expanded..).zip(rows) {
        let (job, problem) = match &row.job {
            Ok(new) => {
                if insert_known(connection, new, solver_version)
                    .await?
                    .is_none()
                {
                    insert_waiting(connection, new).await?;
                }
                (Some(new.id.to_string()), None)
            }
            Err(problem) => (None, Some(problem)),
        };
        sqlx::query(
            "insert into study_rows (study, position, label, changes, job, problem) values (?1, ?2, ?3, ?4, ?5, ?6)",
        )
        .bind(study.to_string())
        .bind(column(position))
        .bind(&row.label)
        .bind(&row.changes)
        .bind(job)
        .bind(problem)
        .execute(&mut *connection)
        .await?;
    }
    sqlx::query("update studies set expanded = ?2 where id = ?1")
        .bind(study.to_string())
        .bind(column(expanded + rows.len() as u64))
        .execute(connection)
        .await?;
    Ok(())
}
