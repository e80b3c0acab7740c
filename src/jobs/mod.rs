//! A job's life: from the queue to its results.
//!
//! In reading order: the two [`Clock`]s; what a [`Job`] and a [`StudyRecord`] are; the [`Store`] that keeps them and the
//! transitions between their states; what of a running job lives in memory only (`live`); the [`Jobs`] that handlers speak
//! to (`queue`, `studies`, and in `resource` what both have in common); the [`Workers`] that compute; and the keeper that removes what is old.

mod attempt;
mod clock;
mod designs;
mod error;
mod job;
mod keeper;
mod live;
mod others;
mod queue;
mod resource;
mod searches;
pub(crate) mod store;
mod studies;
mod study;
mod worker;
mod worker_context;

pub use clock::Clock;
pub use error::JobError;
pub use job::{Job, Progress};
pub use keeper::{Keep, Keeper};
pub use live::{Changes, News};
pub(crate) use queue::KEY_LIFETIME;
pub use queue::{Jobs, Member, Rules};
pub use resource::{Listed, Resource, Submitted};
pub use store::{
    BackupError, Cursor, Damaged, DatabaseAddress, Depth, Document, DocumentLine, EventKind,
    Filter, KeyRecord, Membership, Migrate, NoCursor, OpenError, Removed, Role, Space, Span, Store,
    StoreError, StudyFilter,
};
pub use study::StudyRecord;
pub use worker::{StartError, Workers};
pub use worker_context::Pace;
