//! Where everything is kept: a file of SQLite, or a server of PostgreSQL on which several processes work, behind one type.
//!
//! All SQL of the service stands here. Documents go in and out as text, states as the words of the database: the store knows no gear and no HTTP.
//!
//! In reading order:
//! - the database: its `address`, statements for either kind (`statement`) and the differences (`dialect`), opening (`open`, `lock`), writing (`write`), and
//!   its errors ([`StoreError`]);
//! - the states (`state`), a [`Job`], a [`StudyRecord`], and their rows (`rows`);
//! - the transitions of a job: `submit`, `claim` in its turn (`shares`), `attempt`, and other ends (`end`); those of a study (`studies`);
//! - reading: lists, documents, tables; reports of other processes (`news`);
//! - keys, `projects`, `links` to results, [`webhooks`], and their messages, which are written with the change that they report (`outbox`);
//! - for operators: `usage`, retention and backup.
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

mod address;
mod attempt;
mod backup;
mod claim;
mod database_files;
mod dialect;
mod documents;
mod end;
mod endings;
mod error;
mod hash;
mod health;
mod job;
mod keys;
mod links;
mod lists;
mod lock;
mod news;
mod open;
mod outbox;
mod private;
mod projects;
mod retention;
mod rows;
mod shares;
mod state;
mod statement;
mod studies;
mod study;
mod study_tables;
mod submit;
#[cfg(test)]
mod tests;
mod usage;
pub mod webhooks;
mod write;

use std::sync::Arc;

use database_files::DatabaseFiles;
use health::Health;
use jiff::SignedDuration;
use statement::Pool;
use uuid::Uuid;

pub use address::DatabaseAddress;
pub use attempt::{Came, Claim, End, Ended, Lease};
pub use backup::BackupError;
pub use claim::{Claimed, Reader, Started};
pub use documents::{Damaged, Document, Packed};
pub use end::Lost;
pub use error::StoreError;
pub use job::{Job, Progress};
pub use keys::{KeyRecord, Role};
pub use links::{LinkOutcome, LinkRecord, NewLink};
pub use lists::{Cursor, Depth, Filter, Membership, NoCursor, Span, StudyFilter};
pub use lock::{DatabaseLock, LockError};
pub use news::{Listener, Notice};
pub use open::{Migrate, OpenError};
pub use outbox::EventKind;
pub use projects::{NewProject, ProjectChange, ProjectOutcome, ProjectRecord};
pub use retention::{Removed, Space};
pub use state::{By, Kept, Status};
pub use studies::{NewRow, NewStudy, SearchStep, StudyOutcome};
pub use study::StudyRecord;
pub use study_tables::{DocumentLine, StoredRow};
pub use submit::{NewJob, Outcome, QueueBounds};
pub use usage::{ClientUsage, UserUsage};

/// The database.
///
/// SQLite takes one writer at a time. Writers queue for the one connection in memory, in order of arrival, instead of
/// finding the file locked; readers see the last commit meanwhile. PostgreSQL takes many; there both pools are one.
#[derive(Debug, Clone)]
pub struct Store {
    place: DatabaseAddress,
    writer: Pool,
    readers: Pool,
    health: Arc<Health>,
    /// Identity of its files, for SQLite.
    files: Option<DatabaseFiles>,
    /// This process, among those that work on the same database. Another one at each start.
    process: Uuid,
}

impl Store {
    /// Closes every connection.
    pub async fn close(&self) {
        self.close_readers().await;
        self.writer.close().await;
    }

    /// Closes the connections that read: from here on nothing can be read of a file.
    pub async fn close_readers(&self) {
        self.readers.close().await;
    }

    /// True if it was closed.
    pub fn is_closed(&self) -> bool {
        self.writer.is_closed()
    }

    /// The bytes of the disk on which the file of the database is, and those of them that are free for this process; none of a server.
    pub fn disk(&self) -> Option<(u64, u64)> {
        self.files.as_ref()?.disk()
    }

    /// True if other processes may work on the same database.
    pub fn is_shared(&self) -> bool {
        matches!(self.place, DatabaseAddress::Postgres(_))
    }
}

/// A span of time as a column.
fn micros(span: SignedDuration) -> i64 {
    i64::try_from(span.as_micros()).unwrap_or(i64::MAX)
}

/// The databases count in 64 bits with a sign. A count beyond that is only shown, so the nearest will do.
fn column(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
