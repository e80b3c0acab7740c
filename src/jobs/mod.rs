//! A job's life: from the queue to its results.
//!
//! In reading order: the two [`Clock`]s; the records of the store in the words of documents (`shown`, `study`); the state of running jobs in memory (`live`);
//! the [`Jobs`] that handlers use (`queue`, `job`, `studies`, and in `resource` and `listed` the common part of both); the [`Workers`] that compute; and the keeper that removes
//! old results. The states of jobs and studies are kept, and change, in [`meshwright_store`].

#![warn(clippy::disallowed_methods)]

mod attempt;
mod clock;
mod designs;
mod error;
mod job;
mod keeper;
mod links;
mod listed;
mod live;
mod others;
mod projects;
mod queue;
mod resource;
mod searches;
mod studies;
mod study;
mod worker;
mod worker_context;

pub use meshwright_store::{
    BackupError, By, ClientUsage, Cursor, Damaged, DatabaseAddress, Depth, Document, DocumentLine,
    EventKind, Filter, Job, Kept, KeyRecord, LinkRecord, Membership, Migrate, NoCursor, OpenError,
    Progress, ProjectRecord, Removed, Role, Space, Span, Status, Store, StoreError, StudyFilter,
    StudyRecord, UserUsage,
};

pub use clock::Clock;
pub use error::{JobError, damage_problem};
pub use keeper::{Keep, Keeper};
pub use links::{LONGEST_LINK_DAYS, LinkError, LinkSecret, MOST_LINKS, without_secrets};
pub use listed::{Listed, Submitted};
pub use live::{Changes, News};
pub use projects::{MOST_PROJECT_BYTES, MOST_PROJECTS, ProjectContent, ProjectError};
pub(crate) use queue::KEY_LIFETIME;
pub use queue::{Jobs, Member, Rules};
pub use resource::Resource;
pub use study::{gear_of, search_state, why_failed};
pub use worker::{StartError, Workers};
pub use worker_context::Pace;
