//! Where jobs are kept: SQLite, one writer, and what is read from it. What changes a job stands in `transitions`.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use jiff::Timestamp;
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{QueryBuilder, Sqlite, SqlitePool};
use uuid::Uuid;

use super::job::{Job, Status};

static MIGRATIONS: Migrator = sqlx::migrate!();

/// The database of jobs.
///
/// SQLite takes one writer at a time. Writers queue for the one connection in memory, in order of arrival, instead of
/// finding the file locked; readers see the last commit meanwhile.
#[derive(Debug, Clone)]
pub struct Store {
    pub(super) writer: SqlitePool,
    pub(super) readers: SqlitePool,
}

/// Why a database could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The file cannot be opened as a database.
    #[error("the database cannot be opened")]
    Connect(#[source] sqlx::Error),
    /// Its tables cannot be brought up to date.
    #[error("the database cannot be migrated")]
    Migrate(#[source] MigrateError),
}

impl Store {
    /// Opens the database at `path`, creates it if it is absent, and brings its tables up to date.
    ///
    /// # Errors
    ///
    /// [`OpenError`] if the file is no database, is newer than this program, or cannot be written.
    pub async fn open(path: &Path) -> Result<Self, OpenError> {
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .foreign_keys(true)
            .journal_mode(SqliteJournalMode::Wal)
            // A 202 is a promise: the commit is on the disk before it is given.
            .synchronous(SqliteSynchronous::Full)
            .busy_timeout(Duration::from_secs(10));
        let pool = || {
            SqlitePoolOptions::new()
                .idle_timeout(None)
                .max_lifetime(None)
                // A connection to a file does not break while it lies idle; the look would double the way of a query.
                .test_before_acquire(false)
        };

        let writer = pool()
            .max_connections(1)
            .connect_with(options.clone())
            .await
            .map_err(OpenError::Connect)?;
        MIGRATIONS.run(&writer).await.map_err(OpenError::Migrate)?;
        let readers = pool()
            .max_connections(4)
            .connect_with(options.read_only(true))
            .await
            .map_err(OpenError::Connect)?;
        Ok(Self { writer, readers })
    }

    /// A job of a client.
    pub async fn find(&self, client: &str, id: Uuid) -> Result<Option<Job>, sqlx::Error> {
        sqlx::query_as("select * from jobs where id = ?1 and client = ?2")
            .bind(id.to_string())
            .bind(client)
            .fetch_optional(&self.readers)
            .await
    }

    /// At most `limit` jobs of a client, newest first.
    pub async fn list(
        &self,
        client: &str,
        filter: &Filter,
        limit: u32,
    ) -> Result<Vec<Job>, sqlx::Error> {
        filter
            .query(client, limit)
            .build_query_as()
            .fetch_all(&self.readers)
            .await
    }

    /// The text of a results document.
    pub async fn document(&self, hash: &str) -> Result<Option<String>, sqlx::Error> {
        sqlx::query_scalar("select body from documents where hash = ?1")
            .bind(hash)
            .fetch_optional(&self.readers)
            .await
    }

    /// Numbers of jobs that wait and that run.
    pub async fn depth(&self) -> Result<(i64, i64), sqlx::Error> {
        sqlx::query_as(
            "select (select count(*) from jobs where status = 'accepted'),
                    (select count(*) from jobs where status = 'running')",
        )
        .fetch_one(&self.readers)
        .await
    }

    /// Whether the database can be written: takes the write lock, and changes nothing.
    pub async fn check(&self) -> Result<(), sqlx::Error> {
        self.writer
            .begin_with("begin immediate")
            .await?
            .rollback()
            .await
    }

    /// Closes every connection.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

/// Which jobs of a client to list. An absent part does not select.
#[derive(Debug, Clone, Default)]
pub struct Filter {
    /// Those in one of these states.
    pub statuses: Option<Vec<Status>>,
    /// Those that bear this tag.
    pub tag: Option<String>,
    /// These only.
    pub ids: Option<Vec<Uuid>>,
    /// Those that compute designs of this study, or those that stand alone.
    pub study: Option<Membership>,
    /// Those that stand behind this place in the list.
    pub after: Option<Cursor>,
}

/// Whether a job belongs to a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Membership {
    /// It belongs to this one.
    Of(Uuid),
    /// It stands alone.
    Alone,
}

impl Filter {
    fn query(&self, client: &str, limit: u32) -> QueryBuilder<Sqlite> {
        let mut query = QueryBuilder::new("select * from jobs where client = ");
        query.push_bind(client.to_owned());
        if let Some(statuses) = &self.statuses {
            let mut list = query.push(" and status in (").separated(", ");
            for status in statuses {
                list.push_bind(*status);
            }
            query.push(")");
        }
        if let Some(tag) = &self.tag {
            query
                .push(" and exists (select 1 from json_each(jobs.tags) where value = ")
                .push_bind(tag.clone())
                .push(")");
        }
        if let Some(ids) = &self.ids {
            let mut list = query.push(" and id in (").separated(", ");
            for id in ids {
                list.push_bind(id.to_string());
            }
            query.push(")");
        }
        match self.study {
            Some(Membership::Of(study)) => {
                query.push(" and study = ").push_bind(study.to_string());
            }
            Some(Membership::Alone) => {
                query.push(" and study is null");
            }
            None => {}
        }
        if let Some(Cursor { submitted_at, id }) = self.after {
            query
                .push(" and (submitted_at, id) < (")
                .push_bind(submitted_at.as_microsecond());
            query.push(", ").push_bind(id.to_string()).push(")");
        }
        query
            .push(" order by submitted_at desc, id desc limit ")
            .push_bind(limit);
        query
    }
}

/// A place in a list of jobs or studies: behind the one that it names. Clients take it for an opaque word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cursor {
    pub(super) submitted_at: Timestamp,
    pub(super) id: Uuid,
}

impl Cursor {
    /// The place behind `job`.
    pub fn behind(job: &Job) -> Self {
        Self {
            submitted_at: job.submitted_at,
            id: job.id,
        }
    }
}

impl fmt::Display for Cursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:x}-{}",
            self.submitted_at.as_microsecond(),
            self.id.simple()
        )
    }
}

/// The text is no cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("this is not a cursor that a list has given")]
pub struct NoCursor;

impl FromStr for Cursor {
    type Err = NoCursor;

    fn from_str(text: &str) -> Result<Self, NoCursor> {
        let (instant, id) = text.split_once('-').ok_or(NoCursor)?;
        let microseconds = i64::from_str_radix(instant, 16).map_err(|_| NoCursor)?;
        Ok(Self {
            submitted_at: Timestamp::from_microsecond(microseconds).map_err(|_| NoCursor)?,
            id: id.parse().map_err(|_| NoCursor)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_reads_what_it_writes_and_nothing_else() {
        let cursor = Cursor {
            submitted_at: Timestamp::UNIX_EPOCH,
            id: Uuid::now_v7(),
        };
        assert_eq!(cursor.to_string().parse(), Ok(cursor));
        for text in [
            "",
            "-",
            "0",
            "0-0",
            "zz-00000000000000000000000000000000",
            "7fffffffffffffff-0",
        ] {
            assert_eq!(text.parse::<Cursor>(), Err(NoCursor), "{text}");
        }
    }
}
