//! Where everything is kept: SQLite behind one type. All SQL of the service stands in this folder.
//!
//! In reading order: how the database is [opened](open), how it is [written](write) and what can go wrong with it
//! ([`StoreError`]); what a row is (`rows`); the transitions of a job: it is submitted (`submit`), claimed in its turn
//! (`claim`, `shares`), attempted (`attempt`), and ends otherwise (`end`); those of a study (`studies`); what is read:
//! lists, documents, tables; what else is kept: keys, webhooks; and what an operator needs: retention and backup.
//!
//! Each transition is one transaction that names the state it leaves; when the job is not in that state the transition does
//! not happen, and says so. Time comes in as an argument.
//!
//! ```text
//!            submit            claim             succeed
//!   (nothing) ----> accepted <=======> running ----------> successful
//!                      |      release,    |  \---> failed      fail
//!                      |      recover     |
//!                      \------------------+------> dismissed   cancel
//! ```

mod attempt;
mod backup;
mod claim;
mod documents;
mod end;
mod endings;
mod error;
mod keys;
mod lists;
mod open;
mod retention;
mod rows;
mod shares;
mod studies;
mod study_tables;
mod submit;
#[cfg(test)]
mod tests;
mod webhooks;
mod write;

use std::path::PathBuf;
use std::sync::Arc;

use sqlx::SqlitePool;

use write::Health;

pub use backup::BackupError;
pub use documents::{Damaged, Document};
pub use error::StoreError;
pub use keys::{KeyRecord, Role};
pub use lists::{Cursor, Depth, Filter, Membership, NoCursor, Span, StudyFilter};
pub use open::OpenError;
pub use retention::{Removed, Space};
pub use webhooks::{EventKind, Webhook};

pub(super) use attempt::{Claim, End};
pub(super) use claim::{Claimed, Started};
pub(super) use documents::Packed;
pub(super) use end::Lost;
pub(super) use studies::{NewRow, NewStudy, StudyOutcome};
pub(super) use study_tables::StoredRow;
pub(super) use submit::{NewJob, Outcome, QueueBounds};
pub(super) use webhooks::{Delivery, NewWebhook};

/// The database.
///
/// SQLite takes one writer at a time. Writers queue for the one connection in memory, in order of arrival, instead of
/// finding the file locked; readers see the last commit meanwhile.
#[derive(Debug, Clone)]
pub struct Store {
    path: PathBuf,
    writer: SqlitePool,
    readers: SqlitePool,
    health: Arc<Health>,
}

impl Store {
    /// Closes every connection.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

/// SQLite counts in 64 bits with a sign. A count beyond that is only shown, so the nearest will do.
fn column(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
