//! A job: one submission, where it stands, and when it got there.

use jiff::{SignedDuration, Timestamp};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row};
use utoipa::ToSchema;
use uuid::Uuid;

/// Where a job stands. The words are those of OGC API Processes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema, sqlx::Type)]
#[serde(rename_all = "lowercase")]
#[sqlx(rename_all = "lowercase")]
pub enum Status {
    /// Waits for a worker.
    Accepted,
    /// Is being computed.
    Running,
    /// Has results.
    Successful,
    /// Could not be computed; `problem` says why.
    Failed,
    /// Was cancelled.
    Dismissed,
}

impl Status {
    /// All states, in the order in which a job meets them.
    pub const ALL: [Self; 5] = [
        Self::Accepted,
        Self::Running,
        Self::Successful,
        Self::Failed,
        Self::Dismissed,
    ];

    /// The word on the wire and in the database.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Running => "running",
            Self::Successful => "successful",
            Self::Failed => "failed",
            Self::Dismissed => "dismissed",
        }
    }

    /// Whether nothing changes any more.
    pub fn has_ended(self) -> bool {
        matches!(self, Self::Successful | Self::Failed | Self::Dismissed)
    }
}

/// Mesh positions solved, of those to solve, over all torques. Never time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Progress {
    /// Positions solved.
    pub done: u64,
    /// Positions to solve.
    pub total: u64,
}

impl Progress {
    /// Whole percent, rounded down, so that 100 means all.
    pub fn percent(self) -> u8 {
        let share = u128::from(self.done.min(self.total)) * 100 / u128::from(self.total.max(1));
        u8::try_from(share).expect("a share of one hundred percent fits")
    }
}

/// One submission and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The id on the wire, a UUID of version 7.
    pub id: Uuid,
    /// Who submitted it.
    pub client: String,
    /// The method of the submission.
    pub method: String,
    /// Short words of the client.
    pub tags: Vec<String>,
    /// The submission with every default filled in, JSON.
    pub submission: String,
    /// Where it stands.
    pub status: Status,
    /// Number of claims so far: the fence. Only the latest claim may report or finish.
    pub attempt: i64,
    /// Claims that count towards the limit of attempts.
    pub attempts_counted: i64,
    /// How far it has come.
    pub progress: Progress,
    /// When it was submitted.
    pub submitted_at: Timestamp,
    /// When its latest attempt started.
    pub started_at: Option<Timestamp>,
    /// When it ended.
    pub finished_at: Option<Timestamp>,
    /// Of a failed job: the problem document.
    pub problem: Option<Value>,
    /// Of a successful job: the hash of its results.
    pub document: Option<String>,
    /// The earlier job whose results this one was given.
    pub same_as: Option<Uuid>,
    /// The study that it computes a design of.
    pub study: Option<Uuid>,
}

impl Job {
    /// The time that the last attempt took, once it is over.
    pub fn wall_time(&self) -> Option<SignedDuration> {
        Some(self.started_at?.duration_until(self.finished_at?))
    }
}

impl FromRow<'_, SqliteRow> for Job {
    fn from_row(row: &SqliteRow) -> Result<Self, sqlx::Error> {
        let attempt: i64 = row.try_get("attempt")?;
        let returned: i64 = row.try_get("returned")?;
        let same_as: Option<String> = row.try_get("same_as")?;
        let study: Option<String> = row.try_get("study")?;
        Ok(Self {
            id: uuid("id", &row.try_get::<String, _>("id")?)?,
            client: row.try_get("client")?,
            method: row.try_get("method")?,
            tags: json("tags", &row.try_get::<String, _>("tags")?)?,
            submission: row.try_get("submission")?,
            status: row.try_get("status")?,
            attempt,
            attempts_counted: attempt - returned,
            progress: Progress {
                done: count(row, "positions_done")?,
                total: count(row, "positions_total")?,
            },
            submitted_at: instant("submitted_at", row.try_get("submitted_at")?)?,
            started_at: optional_instant(row, "started_at")?,
            finished_at: optional_instant(row, "finished_at")?,
            problem: row
                .try_get::<Option<String>, _>("problem")?
                .map(|text| json("problem", &text))
                .transpose()?,
            document: row.try_get("document")?,
            same_as: same_as.map(|id| uuid("same_as", &id)).transpose()?,
            study: study.map(|id| uuid("study", &id)).transpose()?,
        })
    }
}

pub(super) fn optional_instant(
    row: &SqliteRow,
    column: &'static str,
) -> Result<Option<Timestamp>, sqlx::Error> {
    row.try_get::<Option<i64>, _>(column)?
        .map(|microseconds| instant(column, microseconds))
        .transpose()
}

pub(super) fn instant(column: &'static str, microseconds: i64) -> Result<Timestamp, sqlx::Error> {
    Timestamp::from_microsecond(microseconds).map_err(|error| undecodable(column, error))
}

pub(super) fn uuid(column: &'static str, text: &str) -> Result<Uuid, sqlx::Error> {
    text.parse()
        .map_err(|error: uuid::Error| undecodable(column, error))
}

fn json<T: serde::de::DeserializeOwned>(
    column: &'static str,
    text: &str,
) -> Result<T, sqlx::Error> {
    serde_json::from_str(text).map_err(|error| undecodable(column, error))
}

pub(super) fn count(row: &SqliteRow, column: &'static str) -> Result<u64, sqlx::Error> {
    u64::try_from(row.try_get::<i64, _>(column)?).map_err(|error| undecodable(column, error))
}

fn undecodable(
    column: &'static str,
    source: impl std::error::Error + Send + Sync + 'static,
) -> sqlx::Error {
    sqlx::Error::ColumnDecode {
        index: column.to_owned(),
        source: Box::new(source),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hundred_percent_means_that_every_position_is_solved() {
        let percent = |done, total| Progress { done, total }.percent();
        assert_eq!(
            (
                percent(0, 0),
                percent(199, 200),
                percent(200, 200),
                percent(3, 2)
            ),
            (0, 99, 100, 100)
        );
        assert_eq!(percent(u64::MAX - 1, u64::MAX), 99);
    }
}
