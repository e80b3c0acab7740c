//! States of jobs and studies, and who changes them.

pub use meshwright_state::{Kept, Status};

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
