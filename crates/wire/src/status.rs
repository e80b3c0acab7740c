//! Where a job or a study stands.

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
    /// The word on the wire.
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
}
