//! States of jobs and studies, and the extent of stored results: the words that the database and the documents share.
//!
//! A crate of its own, so that the store compiles beside the engine and not after it, and the documents compile without a database.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Where a job stands. The words are those of OGC API Processes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
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

    /// True if the state is final.
    pub fn has_ended(self) -> bool {
        matches!(self, Self::Successful | Self::Failed | Self::Dismissed)
    }

    /// The state that a word names.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|status| status.as_str() == word)
    }
}

/// Extent of the stored results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kept {
    /// The results document.
    Results,
    /// The values of a study's table.
    Statistics,
}

impl Kept {
    /// The word on the wire and in the database.
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Results => "results",
            Self::Statistics => "statistics",
        }
    }

    /// The extent that a word names.
    pub fn of_word(word: &str) -> Option<Self> {
        [Self::Results, Self::Statistics]
            .into_iter()
            .find(|kept| kept.as_str() == word)
    }
}
