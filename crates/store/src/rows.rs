//! Rows of the database as what they mean.

use jiff::{SignedDuration, Timestamp};
use sqlx::Row;
use sqlx::postgres::PgRow;
use sqlx::sqlite::SqliteRow;
use uuid::Uuid;

use super::{Job, Kept, Progress, Status, StudyRecord};

/// Reads a type from the rows of both databases by the same words.
macro_rules! from_row {
    ($type:ty, |$row:ident| $read:block) => {
        impl sqlx::FromRow<'_, sqlx::sqlite::SqliteRow> for $type {
            fn from_row($row: &sqlx::sqlite::SqliteRow) -> Result<Self, sqlx::Error> $read
        }

        impl sqlx::FromRow<'_, sqlx::postgres::PgRow> for $type {
            fn from_row($row: &sqlx::postgres::PgRow) -> Result<Self, sqlx::Error> $read
        }
    };
}

pub(crate) use from_row;

/// The columns of a job by their names, which is what every statement reads: a later version may add one meanwhile, and what
/// `*` means would change under the statements that a server has prepared.
macro_rules! job_columns {
    () => {
        "id, sequence, client, method, tags, status, attempt, returned, positions_done, positions_total, submitted_at, started_at, \
         finished_at, elapsed, problem, keep, document, solver_version, same_as, study"
    };
}

/// The columns of a study.
macro_rules! study_columns {
    () => {
        "id, sequence, name, tags, gear, total, expanded, unbuildable, accepted, running, successful, failed, dismissed, version, \
         submitted_at, last_end, cancelled_at, search"
    };
}

pub(crate) use {job_columns, study_columns};

/// Columns as those of a table, where another one has columns of the same names.
pub(crate) fn of_table(table: &str, columns: &str) -> String {
    let columns: Vec<String> = columns
        .split(", ")
        .map(|column| format!("{table}.{column}"))
        .collect();
    columns.join(", ")
}

/// A row of either database, by the kinds of columns that there are.
pub(crate) trait Cells {
    fn integer(&self, column: &'static str) -> Result<Option<i64>, sqlx::Error>;
    fn text(&self, column: &'static str) -> Result<Option<String>, sqlx::Error>;
}

macro_rules! cells {
    ($row:ty) => {
        impl Cells for $row {
            fn integer(&self, column: &'static str) -> Result<Option<i64>, sqlx::Error> {
                self.try_get(column)
            }

            fn text(&self, column: &'static str) -> Result<Option<String>, sqlx::Error> {
                self.try_get(column)
            }
        }
    };
}

cells!(SqliteRow);
cells!(PgRow);

from_row! {
    Job, |row| {
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
            keep: keep(row, "keep")?,
            document: row.try_get("document")?,
            solver_version: row.try_get("solver_version")?,
            same_as: optional_uuid(row, "same_as")?,
            study: optional_uuid(row, "study")?,
        })
    }
}

from_row! {
    StudyRecord, |row| {
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.try_get("sequence")?,
            name: row.try_get("name")?,
            tags: json("tags", &row.try_get::<String, _>("tags")?)?,
            gear: row.try_get("gear")?,
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
            search: row.try_get("search")?,
        })
    }
}

pub(crate) fn instant(row: &impl Cells, column: &'static str) -> Result<Timestamp, sqlx::Error> {
    optional_instant(row, column)?.ok_or_else(|| undecodable(column, Absent))
}

pub(crate) fn optional_instant(
    row: &impl Cells,
    column: &'static str,
) -> Result<Option<Timestamp>, sqlx::Error> {
    let at = row.integer(column)?.map(Timestamp::from_microsecond);
    at.transpose().map_err(|error| undecodable(column, error))
}

pub(crate) fn uuid(row: &impl Cells, column: &'static str) -> Result<Uuid, sqlx::Error> {
    optional_uuid(row, column)?.ok_or_else(|| undecodable(column, Absent))
}

pub(crate) fn optional_uuid(
    row: &impl Cells,
    column: &'static str,
) -> Result<Option<Uuid>, sqlx::Error> {
    let id = row.text(column)?.map(|text| text.parse::<Uuid>());
    id.transpose().map_err(|error| undecodable(column, error))
}

pub(crate) fn status(row: &impl Cells, column: &'static str) -> Result<Status, sqlx::Error> {
    let word = row.text(column)?.unwrap_or_default();
    Status::of_word(&word).ok_or_else(|| undecodable(column, UnknownWord(word)))
}

pub(crate) fn keep(row: &impl Cells, column: &'static str) -> Result<Kept, sqlx::Error> {
    let word = row.text(column)?.unwrap_or_default();
    Kept::of_word(&word).ok_or_else(|| undecodable(column, UnknownWord(word)))
}

pub(crate) fn json<T: serde::de::DeserializeOwned>(
    column: &'static str,
    text: &str,
) -> Result<T, sqlx::Error> {
    serde_json::from_str(text).map_err(|error| undecodable(column, error))
}

pub(crate) fn count(row: &impl Cells, column: &'static str) -> Result<u64, sqlx::Error> {
    let count = row
        .integer(column)?
        .ok_or_else(|| undecodable(column, Absent))?;
    u64::try_from(count).map_err(|error| undecodable(column, error))
}

/// A number that is never large.
pub(crate) fn small(row: &impl Cells, column: &'static str) -> Result<Option<u32>, sqlx::Error> {
    let number = row.integer(column)?.map(u32::try_from);
    number
        .transpose()
        .map_err(|error| undecodable(column, error))
}

/// The database has nothing where something has to be.
#[derive(Debug, thiserror::Error)]
#[error("nothing is there")]
struct Absent;

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
