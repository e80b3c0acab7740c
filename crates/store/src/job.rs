//! A job: one submission, where it stands, and when it got there.

use jiff::{SignedDuration, Timestamp};
use serde_json::Value;
use uuid::Uuid;

use super::{Kept, Status};

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

/// One submission and where it stands. The text of the submission is read by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The id on the wire, a UUID of version 7.
    pub id: Uuid,
    /// Its place in the order of arrival.
    pub sequence: i64,
    /// Who submitted it.
    pub client: String,
    /// The method of the submission.
    pub method: String,
    /// Short words of the client.
    pub tags: Vec<String>,
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
    /// Duration of the attempt that ended it, by a clock that is never set.
    pub elapsed: Option<SignedDuration>,
    /// Of a failed job: the problem document.
    pub problem: Option<Value>,
    /// How much of its results is kept.
    pub keep: Kept,
    /// Of a successful job: the hash of its results.
    pub document: Option<String>,
    /// Of a successful job: the version of the solver that computed its results.
    pub solver_version: Option<String>,
    /// The earlier job whose results this one was given.
    pub same_as: Option<Uuid>,
    /// The study that it computes a design of.
    pub study: Option<Uuid>,
    /// The user of the client who submitted it, if the client says.
    pub submitted_by: Option<String>,
    /// Who dismissed it, in a word, if that was not its client.
    pub dismissed_by: Option<String>,
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
