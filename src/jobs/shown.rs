//! The states of the store in the words of documents.

use meshwright_store::{Kept, Status};
use meshwright_wire as wire;

/// Where a job or a study stands.
pub fn shown_status(status: Status) -> wire::Status {
    match status {
        Status::Accepted => wire::Status::Accepted,
        Status::Running => wire::Status::Running,
        Status::Successful => wire::Status::Successful,
        Status::Failed => wire::Status::Failed,
        Status::Dismissed => wire::Status::Dismissed,
    }
}

/// How much of the results of a job is kept.
pub fn shown_kept(kept: Kept) -> wire::Kept {
    match kept {
        Kept::Results => wire::Kept::Results,
        Kept::Statistics => wire::Kept::Statistics,
    }
}

/// How much of the results of its designs a study wants to be kept.
pub(super) fn kept_by(study: &meshwright_studies::Study) -> Kept {
    match study.keep() {
        wire::Kept::Results => Kept::Results,
        wire::Kept::Statistics => Kept::Statistics,
    }
}
