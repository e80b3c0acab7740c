//! A job's life: from the queue to its results.
//!
//! In reading order: what a [`Job`] is, the [`Store`] that keeps it, the transitions between its states, what of a
//! running job lives in memory only, the [`Jobs`] that handlers speak to, and the [`Workers`] that compute. A study is
//! many jobs at once: what a [`StudyRecord`] is, its transitions, and what handlers do with it. [`Previews`] are computed in
//! the same way, but are no jobs: a request waits for each, and nothing is kept.

mod job;
mod live;
mod previews;
mod queue;
mod store;
mod studies;
mod study;
mod study_transitions;
mod threads;
mod transitions;
mod worker;

pub use job::{Job, Progress, Status};
pub use previews::{PreviewError, PreviewRules, Previewed, Previews};
pub use queue::{Clock, JobError, Jobs, News, Page, Rules, Submitted};
pub use store::{Cursor, Filter, Membership, OpenError, Store};
pub use studies::{StudyPage, StudySubmitted};
pub use study::StudyRecord;
pub use worker::{Pace, Solve, StartError, Workers};
