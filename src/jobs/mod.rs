//! A job's life: from the queue to its results.
//!
//! In reading order: the two [`Clock`]s; what a [`Job`] and a [`StudyRecord`] are; the [`Store`] that keeps them and the
//! transitions between their states; what of a running job lives in memory only (`live`); the [`Jobs`] that handlers speak
//! to (`queue`, `studies`, `hooks`); the [`Workers`] that compute; the keeper that removes what is old; and the messages to
//! webhooks. [`Previews`] are computed in the same way, but are no jobs: a request waits for each, and nothing is kept.

mod addresses;
mod attempt;
mod clock;
mod deliver;
mod error;
mod hooks;
mod job;
mod keeper;
mod live;
mod others;
mod previews;
mod queue;
mod store;
mod studies;
mod study;
mod threads;
mod worker;

pub use addresses::is_public;
pub use clock::Clock;
pub use deliver::Deliveries;
pub use error::JobError;
pub use hooks::{HookRules, HookTarget, NewHook, most_webhooks};
pub use job::{Job, Progress};
pub use keeper::{Keep, Keeper};
pub use live::News;
pub use previews::{Computed, PreviewError, PreviewRules, Previewed, Previews};
pub use queue::{Jobs, Member, Page, Rules, Submitted};
pub use store::{
    BackupError, Cursor, Damaged, Depth, Document, EventKind, Filter, KeyRecord, Membership,
    NoCursor, OpenError, Place, Removed, Role, Space, Span, Store, StoreError, StudyFilter,
    Webhook,
};
pub use studies::{DocumentLine, StudyPage, StudySubmitted};
pub use study::StudyRecord;
pub use threads::Cores;
pub use worker::{Pace, Solve, StartError, Workers};
