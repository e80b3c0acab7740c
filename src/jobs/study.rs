//! A study as it is kept: what was sent, and how far its jobs have come.

use jiff::Timestamp;
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row};
use uuid::Uuid;

use super::job::{Status, count, instant, optional_instant, uuid};
use crate::wire::warning::GearName;

/// A study and how far it has come. Where it stands follows from where its jobs stand.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecord {
    /// The id on the wire, a UUID of version 7.
    pub id: Uuid,
    /// The study as it was sent, JSON.
    pub document: String,
    /// The gear whose mass and holes the table tells.
    pub gear: GearName,
    /// Number of designs.
    pub total: u64,
    /// Designs that have their row.
    pub(super) expanded: u64,
    /// Designs that came to an end without a job.
    pub without_job: u64,
    /// Designs that wait.
    pub accepted: u64,
    /// Designs that are being computed.
    pub running: u64,
    /// Designs that have results.
    pub successful: u64,
    /// Designs whose computation failed.
    pub failed: u64,
    /// Designs whose job was cancelled.
    pub dismissed: u64,
    /// When it was submitted.
    pub submitted_at: Timestamp,
    /// When it was cancelled.
    pub cancelled_at: Option<Timestamp>,
    /// When the last of its jobs ended, of those that have.
    last_end: Option<Timestamp>,
}

impl StudyRecord {
    /// Designs that have come to an end, whichever.
    pub fn done(&self) -> u64 {
        self.without_job + self.successful + self.failed + self.dismissed
    }

    /// Where it stands.
    pub fn status(&self) -> Status {
        if self.cancelled_at.is_some() {
            Status::Dismissed
        } else if self.done() < self.total {
            let begun = self.running + self.successful + self.failed > 0;
            if begun {
                Status::Running
            } else {
                Status::Accepted
            }
        } else if self.successful > 0 {
            Status::Successful
        } else if self.dismissed > 0 {
            Status::Dismissed
        } else {
            Status::Failed
        }
    }

    /// When it ended.
    pub fn finished_at(&self) -> Option<Timestamp> {
        if self.status().has_ended() {
            // Where no design could be built, the end was the beginning.
            self.cancelled_at
                .or(self.last_end)
                .or(Some(self.submitted_at))
        } else {
            None
        }
    }
}

impl FromRow<'_, SqliteRow> for StudyRecord {
    fn from_row(row: &SqliteRow) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid("id", &row.try_get::<String, _>("id")?)?,
            document: row.try_get("document")?,
            gear: row
                .try_get::<String, _>("gear")
                .map(|word| GearName::of_word(&word).unwrap_or(GearName::Driven))?,
            total: count(row, "total")?,
            expanded: count(row, "expanded")?,
            without_job: count(row, "without_job")?,
            accepted: count(row, "accepted")?,
            running: count(row, "running")?,
            successful: count(row, "successful")?,
            failed: count(row, "failed")?,
            dismissed: count(row, "dismissed")?,
            submitted_at: instant("submitted_at", row.try_get("submitted_at")?)?,
            cancelled_at: optional_instant(row, "cancelled_at")?,
            last_end: optional_instant(row, "last_end")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_a_study_stands_follows_from_its_jobs() {
        let study = StudyRecord {
            id: Uuid::nil(),
            document: String::new(),
            gear: GearName::Driven,
            total: 4,
            expanded: 4,
            without_job: 1,
            accepted: 3,
            running: 0,
            successful: 0,
            failed: 0,
            dismissed: 0,
            submitted_at: Timestamp::UNIX_EPOCH,
            cancelled_at: None,
            last_end: None,
        };
        let status = |accepted, running, successful, failed, dismissed| {
            StudyRecord {
                accepted,
                running,
                successful,
                failed,
                dismissed,
                ..study.clone()
            }
            .status()
        };
        assert_eq!(status(3, 0, 0, 0, 0), Status::Accepted);
        assert_eq!(status(2, 1, 0, 0, 0), Status::Running);
        assert_eq!(status(2, 0, 1, 0, 0), Status::Running);
        assert_eq!(status(0, 0, 1, 2, 0), Status::Successful);
        assert_eq!(status(0, 0, 0, 3, 0), Status::Failed);
        assert_eq!(status(0, 0, 0, 0, 3), Status::Dismissed);
        let cancelled = StudyRecord {
            cancelled_at: Some(Timestamp::UNIX_EPOCH),
            expanded: 2,
            ..study.clone()
        };
        assert_eq!(cancelled.status(), Status::Dismissed);
        assert_eq!(cancelled.finished_at(), Some(Timestamp::UNIX_EPOCH));
        let impossible = StudyRecord {
            without_job: 4,
            accepted: 0,
            ..study
        };
        assert_eq!(
            (impossible.status(), impossible.finished_at()),
            (Status::Failed, Some(Timestamp::UNIX_EPOCH))
        );
    }
}
