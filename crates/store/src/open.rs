//! Opening of the database: checks and migrations.

use std::io::{ErrorKind, Read};
use std::net::IpAddr;
use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use sqlx::migrate::{MigrateError, Migration, MigrationType, Migrator};
use sqlx::postgres::{PgConnectOptions, PgPoolOptions};
use sqlx::sqlite::{
    SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{ConnectOptions, Connection, PgConnection, SqlSafeStr, SqliteConnection};
use tokio::time::timeout;
use tracing::{info, warn};
use uuid::Uuid;

use super::database_files::{DatabaseFiles, is_on_a_full_disk};
use super::error::{may_pass, primary_code};
use super::health::Health;
use super::lock::beside;
use super::private::open_or_make;
use super::statement::{Dialect, LONGEST_STATEMENT, Pool, Renewal};
use super::{DatabaseAddress, Store, StoreError};

/// The files of the folder `migrations`: numbers, names and statements.
mod files {
    include!(concat!(env!("OUT_DIR"), "/migrations.rs"));
}

/// Migrations of the tables. Those of a later version may be there already.
pub(super) fn migrations(dialect: Dialect) -> Migrator {
    let files = match dialect {
        Dialect::Sqlite => files::SQLITE,
        Dialect::Postgres => files::POSTGRES,
    };
    let migrations = files.iter().map(|&(version, name, statements)| {
        let statements = statements.into_sql_str();
        Migration::new(
            version,
            name.into(),
            MigrationType::Simple,
            statements,
            false,
        )
    });
    let mut migrator = Migrator::with_migrations(migrations.collect());
    migrator.set_ignore_missing(true);
    migrator
}

/// Who brings the tables up to date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Migrate {
    /// Every process that starts, where there is something to do.
    Auto,
    /// `meshwright migrate` only, with the rights that it takes.
    Never,
}

/// Connections of one process to a server at most, the one for news aside. A transaction needs one for some milliseconds.
const CONNECTIONS: u32 = 10;

/// A connection is asked whether the server still answers on it before it is used, for so long at most.
const PROBING: Duration = Duration::from_secs(2);

/// A connection to a server that cannot be had in this time is not had now.
const CONNECTING: Duration = Duration::from_secs(5);

/// A lock of a server that cannot be had in this time is not had now.
const LONGEST_LOCK: Duration = Duration::from_secs(5);

/// By this number a file says that it is ours ("mesh"); SQLite keeps it in the head of the file.
const APPLICATION: i64 = 0x6d65_7368;

/// First bytes of every SQLite database.
const MAGIC: &[u8; 16] = b"SQLite format 3\0";

/// The journal is cut to this length when it has been emptied.
const MOST_JOURNAL_BYTES: u32 = 64 << 20;

/// Another program that has the lock is waited for so long.
const BUSY: Duration = Duration::from_secs(5);

/// Files of more bytes are not read through at the start; `meshwright backup` checks them.
const LARGEST_CHECKED: u64 = 256 << 20;

/// Why a database cannot be opened. In one of another program, or of a later version, nothing was changed.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The file is something else.
    #[error("it is no SQLite database; nothing was changed in it")]
    NotADatabase,
    /// Another program made it.
    #[error("it is a database of another program; nothing was changed in it")]
    AnotherProgram,
    /// The file is damaged.
    #[error(
        "it is damaged ({0}). Restore a backup, or copy what can be read with the sqlite3 program's .recover"
    )]
    Damaged(String),
    /// A later version of this program made it, and this one cannot work on it.
    #[error("it was made by a later version of Meshwright (schema {0}); nothing was changed in it")]
    Newer(i64),
    /// An earlier version made it, and this process may not bring it up to date.
    #[error("its tables are of an earlier version; `meshwright migrate` brings them up to date")]
    Older,
    /// The file or its folder cannot be written.
    #[error(
        "it cannot be written: the file, its folder or the file system is read-only, or this user may not"
    )]
    ReadOnly,
    /// The disk is full.
    #[error("the disk is full")]
    Full,
    /// Another program has it.
    #[error("another program has locked it")]
    Locked,
    /// Its address is none.
    #[error("its address is not understood")]
    Address(#[source] Box<sqlx::Error>),
    /// The system or the server does not open it.
    #[error("it does not open")]
    Connect(#[source] sqlx::Error),
    /// Its tables cannot be brought up to date.
    #[error("its tables cannot be brought up to date")]
    Migrate(#[source] MigrateError),
}

impl OpenError {
    /// True if the server may be there, and admit this process, a moment later.
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Connect(error) if may_pass(error))
    }

    /// Why the system does not open the file.
    pub fn of_system(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::ReadOnlyFilesystem | ErrorKind::PermissionDenied => Self::ReadOnly,
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::Full,
            _ => Self::Connect(sqlx::Error::Io(error)),
        }
    }
}

impl From<sqlx::Error> for OpenError {
    fn from(error: sqlx::Error) -> Self {
        let code = match &error {
            sqlx::Error::Database(error) => primary_code(error.as_ref()),
            _ => None,
        };
        match code {
            Some(5 | 6) => Self::Locked,
            Some(8) => Self::ReadOnly,
            Some(11) => Self::Damaged(error.to_string()),
            Some(13) => Self::Full,
            Some(26) => Self::NotADatabase,
            _ => Self::Connect(error),
        }
    }
}

impl From<StoreError> for OpenError {
    fn from(error: StoreError) -> Self {
        let (StoreError::Unavailable(source) | StoreError::Broken(source)) = error;
        match std::sync::Arc::try_unwrap(source) {
            Ok(error) => error.into(),
            Err(shared) => Self::Damaged(shared.to_string()),
        }
    }
}

impl From<MigrateError> for OpenError {
    fn from(error: MigrateError) -> Self {
        match error {
            MigrateError::Execute(error) | MigrateError::ExecuteMigration(error, _) => error.into(),
            other => Self::Migrate(other),
        }
    }
}

impl Store {
    /// Opens the database at `place`, brings its tables up to date and looks for damage. A file that is absent is made.
    ///
    /// # Errors
    ///
    /// [`OpenError`].
    pub async fn open(place: &DatabaseAddress) -> Result<Self, OpenError> {
        Self::open_as(place, Migrate::Auto).await
    }

    /// The same, with tables that are brought up to date or have to be.
    ///
    /// # Errors
    ///
    /// [`OpenError`].
    pub async fn open_as(place: &DatabaseAddress, migrate: Migrate) -> Result<Self, OpenError> {
        let opened = Self::try_to_open(place, migrate).await;
        opened.map_err(|error| match (error, place.file()) {
            // Of a full disk SQLite only reports the operation that failed: to map, to read or to write.
            (OpenError::Connect(_), Some(path)) if is_on_a_full_disk(path) => OpenError::Full,
            (error, _) => error,
        })
    }

    async fn try_to_open(place: &DatabaseAddress, migrate: Migrate) -> Result<Self, OpenError> {
        let (writer, readers) = match place {
            DatabaseAddress::File(path) => open_file(path, migrate).await?,
            DatabaseAddress::Postgres(address) => open_server(address, migrate).await?,
        };
        let mut store = Self {
            place: place.clone(),
            writer,
            readers,
            health: Health::new(),
            files: None,
            process: Uuid::now_v7(),
        };
        store.look_for_damage().await?;
        store.probe().await?;
        // By now there is a journal, too.
        if let Some(path) = place.file() {
            store.files = Some(DatabaseFiles::of(path).map_err(sqlx::Error::Io)?);
        }
        store.watch_writing();
        Ok(store)
    }

    /// Reads the whole file, unless that would take seconds; then damage is found when it is read. A server checks its own files.
    async fn look_for_damage(&self) -> Result<(), OpenError> {
        let Pool::Sqlite(readers) = &self.readers else {
            return Ok(());
        };
        if self.space().await?.file > LARGEST_CHECKED {
            return Ok(());
        }
        let found: Vec<String> = sqlx::query_scalar("pragma quick_check(1)")
            .fetch_all(readers)
            .await?;
        match found.into_iter().find(|line| line != "ok") {
            Some(first) => Err(OpenError::Damaged(first)),
            None => Ok(()),
        }
    }
}

async fn open_file(path: &Path, migrate: Migrate) -> Result<(Pool, Pool), OpenError> {
    refuse_other_files(path)?;
    refuse_other_programs(path).await?;
    let options = options(path);
    bring_up_to_date(&options, migrate).await?;
    // From here on the file is there. Made anew behind our back, it would be an empty one.
    let options = options.create_if_missing(false).foreign_keys(true);
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
        .await?;
    let readers = pool()
        .max_connections(4)
        .connect_with(options.read_only(true))
        .await?;
    Ok((Pool::Sqlite(writer), Pool::Sqlite(readers)))
}

/// Connects to a server, and brings the tables up to date: one process at a time, by a lock that the driver takes.
async fn open_server(address: &str, migrate: Migrate) -> Result<(Pool, Pool), OpenError> {
    let options = PgConnectOptions::from_str(address)
        .map_err(|error| OpenError::Address(Box::new(error)))?
        .application_name("meshwright")
        // Tables grow from nothing to hundreds of thousands of rows while a connection keeps its plans: a scan that was cheap at first is not later. Every
        // statement that matters has its index.
        .options([("enable_seqscan", "off"), ("jit", "off")])
        // A process that vanishes in the middle of a transaction, with its network or frozen, holds its locks no longer than this.
        .options([
            ("idle_in_transaction_session_timeout", "10s"),
            ("tcp_keepalives_idle", "10"),
            ("tcp_keepalives_interval", "5"),
            ("tcp_keepalives_count", "3"),
        ]);
    let mut connection = options.connect().await?;
    if leaves_the_machine(&options) && !is_encrypted(&mut connection).await? {
        warn!(
            "the connections to the database are not encrypted; sslmode=verify-full in its address asks for it"
        );
    }
    let migrated = migrate_server(&mut connection, migrate).await;
    connection.close().await?;
    migrated?;
    // Migrations take the time that they need; nothing else does. Whoever holds a lock for longer keeps us from our work.
    let options = options.options([
        (
            "statement_timeout",
            LONGEST_STATEMENT.as_millis().to_string(),
        ),
        ("lock_timeout", LONGEST_LOCK.as_millis().to_string()),
    ]);
    let renewal = Renewal::default();
    let renewed = renewal.clone();
    let pool = PgPoolOptions::new()
        .max_connections(CONNECTIONS)
        .acquire_timeout(CONNECTING)
        .test_before_acquire(false)
        // After a restart of the server all connections are dead; a frozen one answers none.
        .before_acquire(move |connection, meta| {
            let outdated = renewed.outdates(meta.age);
            Box::pin(async move {
                if outdated {
                    return Ok(false);
                }
                let answer = timeout(PROBING, connection.ping()).await;
                Ok(answer.is_ok_and(|answer| answer.is_ok()))
            })
        })
        .connect_with(options)
        .await?;
    let pool = Pool::Postgres(pool, renewal);
    Ok((pool.clone(), pool))
}

async fn migrate_server(connection: &mut PgConnection, migrate: Migrate) -> Result<(), OpenError> {
    let migrations = migrations(Dialect::Postgres);
    let applied: Vec<i64> =
        if sqlx::query_scalar("select to_regclass('_sqlx_migrations') is not null")
            .fetch_one(&mut *connection)
            .await?
        {
            sqlx::query_scalar(APPLIED)
                .fetch_all(&mut *connection)
                .await?
        } else {
            Vec::new()
        };
    let least = async {
        let least = sqlx::query_scalar(LEAST_MIGRATION);
        least.fetch_one(&mut *connection).await.ok()
    };
    if !is_to_be_done(&migrations, &applied, least, migrate).await? {
        return Ok(());
    }
    Ok(migrations.run_direct(None, connection, false).await?)
}

const APPLIED: &str = "select version from _sqlx_migrations where success order by version";
const LEAST_MIGRATION: &str = "select least_migration from compatibility";

/// True if these migrations are missing in the tables, and this process may run them. `least` is the migration that a program has to know to work on tables of
/// a later version.
async fn is_to_be_done(
    migrations: &Migrator,
    applied: &[i64],
    least: impl Future<Output = Option<i64>>,
    migrate: Migrate,
) -> Result<bool, OpenError> {
    let known = migrations.iter().map(|migration| migration.version);
    if let Some(later) = applied
        .last()
        .copied()
        .filter(|last| known.clone().all(|own| own < *last))
    {
        // Tables that do not say who can work on them are none of ours.
        let least = least.await.unwrap_or(i64::MAX);
        if !known.clone().any(|own| own >= least) {
            return Err(OpenError::Newer(later));
        }
        info!(
            schema = later,
            "the tables are of a later version, which this one can work on"
        );
    }
    let missing = known.clone().any(|own| !applied.contains(&own));
    match migrate {
        Migrate::Never if missing => Err(OpenError::Older),
        Migrate::Never => Ok(false),
        Migrate::Auto => Ok(missing),
    }
}

/// True if data for the server cross a network.
fn leaves_the_machine(options: &PgConnectOptions) -> bool {
    let host = options.get_host();
    let by_number = host.trim_matches(['[', ']']).parse::<IpAddr>();
    let here = host == "localhost"
        || host.starts_with('/')
        || by_number.is_ok_and(|address| address.is_loopback());
    !here && options.get_socket().is_none()
}

/// True if the connection is encrypted.
async fn is_encrypted(connection: &mut PgConnection) -> Result<bool, sqlx::Error> {
    sqlx::query_scalar(
        "select exists (select from pg_stat_ssl where pid = pg_backend_pid() and ssl)",
    )
    .fetch_one(connection)
    .await
}

/// A file that is there and not empty has to be a database; SQLite would say so later, and less clearly. One that is absent is
/// made.
fn refuse_other_files(path: &Path) -> Result<(), OpenError> {
    // A pipe would be waited for.
    if std::fs::metadata(path).is_ok_and(|data| !data.is_file()) {
        return Err(OpenError::NotADatabase);
    }
    let mut head = [0; MAGIC.len()];
    let Ok(mut file) = std::fs::File::open(path) else {
        // SQLite reports a file that cannot be read or made.
        let _ = open_or_make(path);
        return Ok(());
    };
    match file.read_exact(&mut head) {
        Ok(()) if head == *MAGIC => Ok(()),
        Ok(()) => Err(OpenError::NotADatabase),
        Err(_) if file.metadata().is_ok_and(|data| data.len() == 0) => Ok(()),
        Err(_) => Err(OpenError::NotADatabase),
    }
}

/// An existing database has our application id, or our tables, or no content yet. It is only read for that; SQLite reports other faults when it is opened.
async fn refuse_other_programs(path: &Path) -> Result<(), OpenError> {
    // The last writes of its program may stand in the journal alone. Without one not even that is made.
    let journal = path
        .canonicalize()
        .and_then(|path| std::fs::metadata(beside(&path, "-wal")));
    let options = SqliteConnectOptions::new()
        .filename(path)
        .read_only(true)
        .immutable(journal.map_or(true, |journal| journal.len() == 0));
    let Ok(mut connection) = options.connect().await else {
        return Ok(());
    };
    let said: Result<(i64, i64, i64, i64), _> = sqlx::query_as(
        "select (select application_id from pragma_application_id), (select user_version from pragma_user_version), count(*),
                coalesce(sum(type = 'table' and name in ('_sqlx_migrations', 'documents', 'idempotency_keys', 'jobs')), 0)
         from sqlite_master",
    )
    .fetch_one(&mut connection)
    .await;
    // Of a connection that has only read there is nothing to lose.
    let _ = connection.close().await;
    match said {
        // The first versions did not say that a file is theirs.
        Ok((APPLICATION, ..) | (0, 0, 0, _) | (0, 0, _, 4)) | Err(_) => Ok(()),
        Ok(_) => Err(OpenError::AnotherProgram),
    }
}

fn options(path: &Path) -> SqliteConnectOptions {
    SqliteConnectOptions::new()
        .filename(path)
        .create_if_missing(true)
        .journal_mode(SqliteJournalMode::Wal)
        .pragma("journal_size_limit", MOST_JOURNAL_BYTES.to_string())
        // A 202 is a promise: the commit is on the disk before it is given.
        .synchronous(SqliteSynchronous::Full)
        .busy_timeout(BUSY)
}

/// Migrates on a connection of its own: tables are made anew, which foreign keys would take for deletions.
async fn bring_up_to_date(
    options: &SqliteConnectOptions,
    migrate: Migrate,
) -> Result<(), OpenError> {
    // In a new file the space of deleted rows can be returned a little at a time. (The statement writes, so it is not for readers.)
    let options = options.clone().auto_vacuum(SqliteAutoVacuum::Incremental);
    let mut connection = options.foreign_keys(false).connect().await?;
    let migrated = migrate_file(&mut connection, migrate).await;
    if let Ok(done) = migrated {
        // Looking through everything takes as long as there is much of it; only tables made anew can have lost a row.
        if done {
            let dangling = sqlx::query("pragma foreign_key_check")
                .fetch_optional(&mut connection)
                .await?;
            if dangling.is_some() {
                return Err(OpenError::Damaged("rows that belong to nothing".to_owned()));
            }
        }
        make_shrinkable(&mut connection).await;
        mark(&mut connection).await?;
    }
    connection.close().await?;
    migrated.map(|_| ())
}

/// Writes into the file that it is ours.
async fn mark(connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    let marked: i64 = sqlx::query_scalar("pragma application_id")
        .fetch_one(&mut *connection)
        .await?;
    if marked != APPLICATION {
        let mark = format!("pragma application_id = {APPLICATION}");
        sqlx::raw_sql(sqlx::AssertSqlSafe(mark))
            .execute(connection)
            .await?;
    }
    Ok(())
}

/// True if there was something to do.
async fn migrate_file(
    connection: &mut SqliteConnection,
    migrate: Migrate,
) -> Result<bool, OpenError> {
    let migrations = migrations(Dialect::Sqlite);
    let named = sqlx::query("select 1 from sqlite_master where name = '_sqlx_migrations'")
        .fetch_optional(&mut *connection)
        .await?;
    let applied: Vec<i64> = match named {
        Some(_) => {
            sqlx::query_scalar(APPLIED)
                .fetch_all(&mut *connection)
                .await?
        }
        None => {
            // Whoever comes after a start that was cut off finds something in the file, and is to know that it is ours.
            mark(connection).await?;
            Vec::new()
        }
    };
    let least = async {
        let least = sqlx::query_scalar(LEAST_MIGRATION);
        least.fetch_one(&mut *connection).await.ok()
    };
    let to_be_done = is_to_be_done(&migrations, &applied, least, migrate).await?;
    if to_be_done {
        migrations.run_direct(None, connection, false).await?;
    }
    Ok(to_be_done)
}

/// A database of an earlier version keeps the space of deleted rows until it is made anew, which takes as much space again. It works without; only the file
/// stays as large as it once was.
async fn make_shrinkable(connection: &mut SqliteConnection) {
    let mode: Result<i64, _> = sqlx::query_scalar("pragma auto_vacuum")
        .fetch_one(&mut *connection)
        .await;
    const INCREMENTAL: i64 = 2;
    if mode.is_ok_and(|mode| mode == INCREMENTAL) {
        return;
    }
    info!("the database is made anew, so that it can shrink");
    let vacuum = sqlx::raw_sql("pragma auto_vacuum = incremental; vacuum")
        .execute(connection)
        .await;
    if let Err(error) = vacuum {
        warn!(%error, "the database cannot be made anew now, and will not shrink");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_goes_to_another_machine_crosses_a_network() {
        for (address, leaves) in [
            ("postgres://me@127.0.0.1/gears", false),
            ("postgres://me@localhost:5433/gears", false),
            ("postgres://me@[::1]/gears", false),
            ("postgres://me@%2Fvar%2Frun%2Fpostgresql/gears", false),
            ("postgres://me@db.example/gears", true),
            ("postgres://me@10.0.0.7/gears", true),
        ] {
            let options = PgConnectOptions::from_str(address).unwrap();
            assert_eq!(leaves_the_machine(&options), leaves, "{address}");
        }
    }
}
