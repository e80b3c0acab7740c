//! Where jobs and studies stand, and how much of them is kept, in the words of the database.

/// Where a job or a study stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// Waits for a worker.
    Accepted,
    /// Is being computed.
    Running,
    /// Has results.
    Successful,
    /// Could not be computed; a problem document says why.
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

    /// Its word.
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

/// How much of the results of a job is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// The results document.
    Results,
    /// The values of a study's table.
    Statistics,
}

impl Kept {
    /// Its word.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Results => "results",
            Self::Statistics => "statistics",
        }
    }

    /// The state of a word.
    pub fn of_word(word: &str) -> Option<Self> {
        [Self::Results, Self::Statistics]
            .into_iter()
            .find(|kept| kept.as_str() == word)
    }
}

/// Who ends or removes a job or a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// The client that submitted it.
    Owner,
    /// An administrator of the service. The owner is told.
    Administrator,
}

impl By {
    /// Its word, as it is kept and told; none for the owner.
    pub fn word(self) -> Option<&'static str> {
        match self {
            Self::Owner => None,
            Self::Administrator => Some("administrator"),
        }
    }
}
