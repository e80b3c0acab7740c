//! What can go wrong with the database, by what is to be done about it.

use std::sync::Arc;

/// Why the database did not do its part.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StoreError {
    /// Nothing can be stored, or read, for now: the disk is full or gone, the file is locked or read-only. It may pass.
    #[error("the database cannot be used now")]
    Unavailable(#[source] Arc<sqlx::Error>),
    /// It does not pass: the file is damaged, or a statement is wrong.
    #[error("the database failed")]
    Broken(#[source] Arc<sqlx::Error>),
}

impl From<sqlx::Error> for StoreError {
    fn from(error: sqlx::Error) -> Self {
        if may_pass(&error) {
            Self::Unavailable(Arc::new(error))
        } else {
            Self::Broken(Arc::new(error))
        }
    }
}

impl StoreError {
    /// Whether it is worth trying again.
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Unavailable(_))
    }
}

/// SQLite's primary result codes that speak of the world around the file.
const OF_THE_WORLD: [u32; 7] = [
    5,  // busy: another program has the lock
    6,  // locked
    7,  // no memory
    8,  // read-only
    10, // input or output failed
    13, // full
    14, // cannot be opened
];

fn may_pass(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Database(error) => {
            primary_code(error.as_ref()).is_some_and(|code| OF_THE_WORLD.contains(&code))
        }
        sqlx::Error::Io(_) | sqlx::Error::PoolTimedOut | sqlx::Error::PoolClosed => true,
        // The thread of a connection that broke.
        sqlx::Error::WorkerCrashed => true,
        _ => false,
    }
}

/// The primary result code; extended ones add to it above the lowest byte.
pub(super) fn primary_code(error: &dyn sqlx::error::DatabaseError) -> Option<u32> {
    error.code()?.parse::<u32>().ok().map(|code| code & 0xff)
}
