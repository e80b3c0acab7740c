//! Rows of the database as values.

use jiff::{SignedDuration, Timestamp};
use sqlx::postgres::{PgRow, Postgres};
use sqlx::sqlite::{Sqlite, SqliteRow};
use sqlx::{ColumnIndex, Decode, Row as _, Type};
use uuid::Uuid;

use super::{Job, Kept, Progress, Status, StudyRecord};

/// A row of either database.
pub(crate) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

/// A type of a column in both databases.
pub(crate) trait Cell:
    for<'r> Decode<'r, Sqlite> + Type<Sqlite> + for<'r> Decode<'r, Postgres> + Type<Postgres>
{
}

impl<T> Cell for T where
    T: for<'r> Decode<'r, Sqlite> + Type<Sqlite> + for<'r> Decode<'r, Postgres> + Type<Postgres>
{
}

impl Row {
    /// The value of a column, by its name or number.
    pub(crate) fn get<T: Cell>(
        &self,
        column: impl ColumnIndex<SqliteRow> + ColumnIndex<PgRow>,
    ) -> Result<T, sqlx::Error> {
        match self {
            Self::Sqlite(row) => row.try_get(column),
            Self::Postgres(row) => row.try_get(column),
        }
    }
}

/// A value read from a row.
pub(crate) trait Record: Sized {
    fn read(row: &Row) -> Result<Self, sqlx::Error>;
}

macro_rules! tuple {
    ($($cell:ident $number:literal),+) => {
        impl<$($cell: Cell),+> Record for ($($cell,)+) {
            fn read(row: &Row) -> Result<Self, sqlx::Error> {
                Ok(($(row.get($number)?,)+))
            }
        }
    };
}

tuple!(A 0_usize);
tuple!(A 0_usize, B 1_usize);
tuple!(A 0_usize, B 1_usize, C 2_usize);
tuple!(A 0_usize, B 1_usize, C 2_usize, D 3_usize);
tuple!(A 0_usize, B 1_usize, C 2_usize, D 3_usize, E 4_usize);
tuple!(A 0_usize, B 1_usize, C 2_usize, D 3_usize, E 4_usize, F 5_usize);
tuple!(A 0_usize, B 1_usize, C 2_usize, D 3_usize, E 4_usize, F 5_usize, G 6_usize);

/// The columns of a job by their names, as every statement reads them: a later version may add one meanwhile, and the meaning of `*` would change under the
/// statements that a server has prepared.
macro_rules! job_columns {
    () => {
        "id, sequence, client, method, tags, status, attempt, returned, positions_done, positions_total, submitted_at, started_at, \
         finished_at, elapsed, problem, keep, document, solver_version, same_as, study, submitted_by, dismissed_by"
    };
}

/// The columns of a study.
macro_rules! study_columns {
    () => {
        "id, sequence, name, tags, gear, total, expanded, unbuildable, accepted, running, successful, failed, dismissed, version, \
         submitted_at, last_end, cancelled_at, search, submitted_by, dismissed_by"
    };
}

/// The lane of a job, as `shares` names it: its study, or the jobs of its user that stand alone.
macro_rules! lane_of_job {
    () => {
        "coalesce(study, '!' || submitted_by, '')"
    };
}

pub(crate) use {job_columns, lane_of_job, study_columns};

/// Columns as those of a table, where another one has columns of the same names.
pub(crate) fn of_table(table: &str, columns: &str) -> String {
    let columns: Vec<String> = columns
        .split(", ")
        .map(|column| format!("{table}.{column}"))
        .collect();
    columns.join(", ")
}

impl Record for Job {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        let attempt: i64 = row.get("attempt")?;
        let returned: i64 = row.get("returned")?;
        let elapsed: Option<i64> = row.get("elapsed")?;
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.get("sequence")?,
            client: row.get("client")?,
            method: row.get("method")?,
            tags: json("tags", &row.get::<String>("tags")?)?,
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
                .get::<Option<String>>("problem")?
                .map(|text| json("problem", &text))
                .transpose()?,
            keep: keep(row, "keep")?,
            document: row.get("document")?,
            solver_version: row.get("solver_version")?,
            same_as: optional_uuid(row, "same_as")?,
            study: optional_uuid(row, "study")?,
            submitted_by: row.get("submitted_by")?,
            dismissed_by: row.get("dismissed_by")?,
        })
    }
}

impl Record for StudyRecord {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.get("sequence")?,
            name: row.get("name")?,
            tags: json("tags", &row.get::<String>("tags")?)?,
            gear: row.get("gear")?,
            total: count(row, "total")?,
            expanded: count(row, "expanded")?,
            unbuildable: count(row, "unbuildable")?,
            accepted: count(row, "accepted")?,
            running: count(row, "running")?,
            successful: count(row, "successful")?,
            failed: count(row, "failed")?,
            dismissed: count(row, "dismissed")?,
            version: row.get("version")?,
            submitted_at: instant(row, "submitted_at")?,
            last_end: optional_instant(row, "last_end")?,
            cancelled_at: optional_instant(row, "cancelled_at")?,
            search: row.get("search")?,
            submitted_by: row.get("submitted_by")?,
            dismissed_by: row.get("dismissed_by")?,
        })
    }
}

pub(crate) fn instant(row: &Row, column: &'static str) -> Result<Timestamp, sqlx::Error> {
    optional_instant(row, column)?.ok_or_else(|| undecodable(column, Absent))
}

pub(crate) fn optional_instant(
    row: &Row,
    column: &'static str,
) -> Result<Option<Timestamp>, sqlx::Error> {
    let at = row
        .get::<Option<i64>>(column)?
        .map(Timestamp::from_microsecond);
    at.transpose().map_err(|error| undecodable(column, error))
}

pub(crate) fn uuid(row: &Row, column: &'static str) -> Result<Uuid, sqlx::Error> {
    optional_uuid(row, column)?.ok_or_else(|| undecodable(column, Absent))
}

pub(crate) fn optional_uuid(row: &Row, column: &'static str) -> Result<Option<Uuid>, sqlx::Error> {
    let id = row
        .get::<Option<String>>(column)?
        .map(|text| text.parse::<Uuid>());
    id.transpose().map_err(|error| undecodable(column, error))
}

pub(crate) fn status(row: &Row, column: &'static str) -> Result<Status, sqlx::Error> {
    let word = row.get::<Option<String>>(column)?.unwrap_or_default();
    Status::of_word(&word).ok_or_else(|| undecodable(column, UnknownWord(word)))
}

pub(crate) fn keep(row: &Row, column: &'static str) -> Result<Kept, sqlx::Error> {
    let word = row.get::<Option<String>>(column)?.unwrap_or_default();
    Kept::of_word(&word).ok_or_else(|| undecodable(column, UnknownWord(word)))
}

pub(crate) fn json<T: serde::de::DeserializeOwned>(
    column: &'static str,
    text: &str,
) -> Result<T, sqlx::Error> {
    serde_json::from_str(text).map_err(|error| undecodable(column, error))
}

pub(crate) fn count(row: &Row, column: &'static str) -> Result<u64, sqlx::Error> {
    let count = row
        .get::<Option<i64>>(column)?
        .ok_or_else(|| undecodable(column, Absent))?;
    u64::try_from(count).map_err(|error| undecodable(column, error))
}

/// A number that is never large.
pub(crate) fn small(row: &Row, column: &'static str) -> Result<Option<u32>, sqlx::Error> {
    let number = row.get::<Option<i64>>(column)?.map(u32::try_from);
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
