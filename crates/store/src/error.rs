//! Errors of the database, by the action that they need.

use std::sync::Arc;

use sqlx::postgres::PgDatabaseError;
use sqlx::sqlite::SqliteError;

/// Why the database did not do its part.
#[derive(Debug, Clone, thiserror::Error)]
pub enum StoreError {
    /// The database cannot be read or written for now: the disk is full or gone, the file is locked or read-only, the server is away.
    /// This may pass.
    #[error("the database cannot be used now")]
    Unavailable(#[source] Arc<sqlx::Error>),
    /// A lasting error: the file is damaged, or a statement is wrong.
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
    /// Nothing can be stored, for a cause that was found before.
    pub fn unavailable(cause: String) -> Self {
        sqlx::Error::Io(std::io::Error::other(cause)).into()
    }

    /// The store did not answer in the time that its caller had.
    pub fn timed_out() -> Self {
        sqlx::Error::PoolTimedOut.into()
    }

    /// True if another try may succeed.
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

/// The beginnings of PostgreSQL's codes (its manual, appendix A) that speak of the world around the statement.
const OF_THE_SERVER: [&str; 9] = [
    "08",    // the connection
    "0A000", // the tables have changed under a statement that was prepared
    "25006", // read-only: a standby
    "40",    // taken back because of another transaction
    "53",    // no room, no memory, too many connections
    "55P03", // a lock that cannot be had
    "57",    // shut down, not up yet, or told to stop
    "58",    // input or output failed
    "3D000", // the database is not there yet
];

/// True if another try may succeed.
pub(super) fn may_pass(error: &sqlx::Error) -> bool {
    match error {
        sqlx::Error::Database(error) => match error.try_downcast_ref::<PgDatabaseError>() {
            Some(error) => OF_THE_SERVER
                .iter()
                .any(|class| error.code().starts_with(class)),
            None => primary_code(error.as_ref()).is_some_and(|code| OF_THE_WORLD.contains(&code)),
        },
        // A server that shuts down in the middle of an answer.
        sqlx::Error::Protocol(_) | sqlx::Error::Tls(_) => true,
        sqlx::Error::Io(_) | sqlx::Error::PoolTimedOut | sqlx::Error::PoolClosed => true,
        // The thread of a connection that broke.
        sqlx::Error::WorkerCrashed => true,
        _ => false,
    }
}

/// SQLite's primary result code; extended ones add to it above the lowest byte.
pub(super) fn primary_code(error: &dyn sqlx::error::DatabaseError) -> Option<u32> {
    error.try_downcast_ref::<SqliteError>()?;
    error.code()?.parse::<u32>().ok().map(|code| code & 0xff)
}
