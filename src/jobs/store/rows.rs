//! Rows of the database as what they mean.

use jiff::{SignedDuration, Timestamp};
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row};
use uuid::Uuid;

use crate::jobs::job::{Job, Progress};
use crate::jobs::study::StudyRecord;
use crate::wire::Status;
use crate::wire::warning::GearName;

impl FromRow<'_, SqliteRow> for Job {
    fn from_row(row: &SqliteRow) -> Result<Self, sqlx::Error> {
        let attempt: i64 = row.try_get("attempt")?;
        let returned: i64 = row.try_get("returned")?;
        let elapsed: Option<i64> = row.try_get("elapsed")?;
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.try_get("sequence")?,
            client: row.try_get("client")?,
            method: row.try_get("method")?,
            tags: json("tags", &row.try_get::<String, _>("tags")?)?,
            status: status(row, "status")?,
            attempt,
            attempts_counted: attempt - returned,
            progress: Progress {
                done: count(row, "positions_done")?,
                total: count(row, "positions_total")?,
            },
            submitted_at: instant(row, "submitted_at")?,
            started_at: optional_instant(row, "started_at")?,
            finished_at: optional_instant(row, "finished_at")?,
            elapsed: elapsed.map(SignedDuration::from_micros),
            problem: row
                .try_get::<Option<String>, _>("problem")?
                .map(|text| json("problem", &text))
                .transpose()?,
            document: row.try_get("document")?,
            same_as: optional_uuid(row, "same_as")?,
            study: optional_uuid(row, "study")?,
        })
    }
}

impl FromRow<'_, SqliteRow> for StudyRecord {
    fn from_row(row: &SqliteRow) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.try_get("sequence")?,
            name: row.try_get("name")?,
            tags: json("tags", &row.try_get::<String, _>("tags")?)?,
            gear: row
                .try_get::<String, _>("gear")
                .map(|word| GearName::of_word(&word).unwrap_or(GearName::Driven))?,
            total: count(row, "total")?,
            expanded: count(row, "expanded")?,
            unbuildable: count(row, "unbuildable")?,
            accepted: count(row, "accepted")?,
            running: count(row, "running")?,
            successful: count(row, "successful")?,
            failed: count(row, "failed")?,
            dismissed: count(row, "dismissed")?,
            version: row.try_get("version")?,
            submitted_at: instant(row, "submitted_at")?,
            last_end: optional_instant(row, "last_end")?,
            cancelled_at: optional_instant(row, "cancelled_at")?,
        })
    }
}

pub(super) fn instant(row: &SqliteRow, column: &'static str) -> Result<Timestamp, sqlx::Error> {
    let microseconds: i64 = row.try_get(column)?;
    Timestamp::from_microsecond(microseconds).map_err(|error| undecodable(column, error))
}

pub(super) fn optional_instant(
    row: &SqliteRow,
    column: &'static str,
) -> Result<Option<Timestamp>, sqlx::Error> {
    match row.try_get::<Option<i64>, _>(column)? {
        Some(_) => instant(row, column).map(Some),
        None => Ok(None),
    }
}

pub(super) fn uuid(row: &SqliteRow, column: &'static str) -> Result<Uuid, sqlx::Error> {
    let text: String = row.try_get(column)?;
    text.parse()
        .map_err(|error: uuid::Error| undecodable(column, error))
}

pub(super) fn optional_uuid(
    row: &SqliteRow,
    column: &'static str,
) -> Result<Option<Uuid>, sqlx::Error> {
    match row.try_get::<Option<String>, _>(column)? {
        Some(_) => uuid(row, column).map(Some),
        None => Ok(None),
    }
}

pub(super) fn status(row: &SqliteRow, column: &'static str) -> Result<Status, sqlx::Error> {
    let word: String = row.try_get(column)?;
    Status::of_word(&word).ok_or_else(|| undecodable(column, UnknownWord(word)))
}

pub(super) fn json<T: serde::de::DeserializeOwned>(
    column: &'static str,
    text: &str,
) -> Result<T, sqlx::Error> {
    serde_json::from_str(text).map_err(|error| undecodable(column, error))
}

pub(super) fn count(row: &SqliteRow, column: &'static str) -> Result<u64, sqlx::Error> {
    u64::try_from(row.try_get::<i64, _>(column)?).map_err(|error| undecodable(column, error))
}

/// The database has a word that this version does not know.
#[derive(Debug, thiserror::Error)]
#[error("{0:?} is no word that is known here")]
struct UnknownWord(String);

fn undecodable(
    column: &'static str,
    source: impl std::error::Error + Send + Sync + 'static,
) -> sqlx::Error {
    sqlx::Error::ColumnDecode {
        index: column.to_owned(),
        source: Box::new(source),
    }
}
