//! A study: how far its jobs have come.

use jiff::Timestamp;
use uuid::Uuid;

use super::Status;

/// A study and how far it has come. Where it stands follows from where its jobs stand.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecord {
    /// The id on the wire, a UUID of version 7.
    pub id: Uuid,
    /// Its place in the order of arrival.
    pub sequence: i64,
    /// The client's name for it.
    pub name: Option<String>,
    /// Short words of the client.
    pub tags: Vec<String>,
    /// The gear whose mass and holes the table shows, in a word.
    pub gear: String,
    /// Number of designs; of a search that has not ended, the most that it may come to.
    pub total: u64,
    /// Designs that have their row.
    pub expanded: u64,
    /// Designs that could not be built.
    pub unbuildable: u64,
    /// Designs that wait.
    pub accepted: u64,
    /// Designs that are being computed.
    pub running: u64,
    /// Designs that have results.
    pub successful: u64,
    /// Designs whose computation failed.
    pub failed: u64,
    /// Designs whose job was cancelled or deleted.
    pub dismissed: u64,
    /// Grows with every change of the study, its rows or its jobs.
    pub version: i64,
    /// When it was submitted.
    pub submitted_at: Timestamp,
    /// When it was cancelled.
    pub cancelled_at: Option<Timestamp>,
    /// When the last of its jobs ended, of those that have.
    pub last_end: Option<Timestamp>,
    /// How far a search has come, JSON; none for other studies.
    pub search: Option<String>,
    /// The user of the client who submitted it, if the client says.
    pub submitted_by: Option<String>,
    /// Who dismissed it, in a word, if that was not its client.
    pub dismissed_by: Option<String>,
}

impl StudyRecord {
    /// Designs that have come to an end, whichever.
    pub fn done(&self) -> u64 {
        self.unbuildable + self.successful + self.failed + self.dismissed
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_a_study_stands_follows_from_its_jobs() {
        let study = StudyRecord {
            id: Uuid::nil(),
            sequence: 1,
            name: None,
            tags: Vec::new(),
            gear: String::new(),
            total: 4,
            expanded: 4,
            unbuildable: 1,
            accepted: 3,
            running: 0,
            successful: 0,
            failed: 0,
            dismissed: 0,
            version: 0,
            submitted_at: Timestamp::UNIX_EPOCH,
            cancelled_at: None,
            last_end: None,
            search: None,
            submitted_by: None,
            dismissed_by: None,
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
            unbuildable: 4,
            accepted: 0,
            ..study
        };
        assert_eq!(
            (impossible.status(), impossible.finished_at()),
            (Status::Failed, Some(Timestamp::UNIX_EPOCH))
        );
    }
}
