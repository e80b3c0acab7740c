//! A copy of the database while it is in use.

use std::path::{Path, PathBuf};

use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection};

use super::{DatabaseAddress, Store};

/// Why there is no backup.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    /// The database is no file.
    #[error("{0} is copied by PostgreSQL's own pg_dump")]
    NoFile(DatabaseAddress),
    /// A file is there already.
    #[error("{} is there already; nothing was written", .0.display())]
    Exists(PathBuf),
    /// The database cannot be read, or the copy cannot be written.
    #[error("the database cannot be copied")]
    Copy(#[source] sqlx::Error),
    /// The copy is damaged, and so is the database then.
    #[error("the copy is damaged, and was not kept: {0}")]
    Damaged(String),
    /// The copy cannot be put in its place.
    #[error("the copy cannot be put in its place")]
    Place(#[source] std::io::Error),
}

impl Store {
    /// Copies the database at `database` to `target`, as it stands at one moment, whoever writes to it meanwhile. The copy
    /// is checked through before it gets its name, and is as small as it can be.
    ///
    /// # Errors
    ///
    /// [`BackupError`].
    pub async fn backup(database: &DatabaseAddress, target: &Path) -> Result<(), BackupError> {
        let DatabaseAddress::File(database) = database else {
            return Err(BackupError::NoFile(database.clone()));
        };
        if target.exists() {
            return Err(BackupError::Exists(target.to_owned()));
        }
        let mut name = target.as_os_str().to_owned();
        name.push(".partial");
        let partial = PathBuf::from(name);
        // A file that an interrupted backup left.
        let _ = std::fs::remove_file(&partial);
        let copied = copy(database, &partial).await;
        let placed = copied.and_then(|()| place(&partial, target));
        if placed.is_err() {
            let _ = std::fs::remove_file(&partial);
        }
        placed
    }
}

async fn copy(database: &Path, partial: &Path) -> Result<(), BackupError> {
    // SQLite takes an empty file for none, and keeps its rights.
    super::private::open_or_make(partial).map_err(BackupError::Place)?;
    let options = SqliteConnectOptions::new().filename(database);
    let mut source = options.connect().await.map_err(BackupError::Copy)?;
    let copied = sqlx::query("vacuum into ?1")
        .bind(partial.to_string_lossy().into_owned())
        .execute(&mut source)
        .await;
    let closed = source.close().await;
    copied.map_err(BackupError::Copy)?;
    closed.map_err(BackupError::Copy)?;

    let options = SqliteConnectOptions::new()
        .filename(partial)
        .read_only(true);
    let mut copy = options.connect().await.map_err(BackupError::Copy)?;
    let found: Result<Vec<String>, _> = sqlx::query_scalar("pragma integrity_check")
        .fetch_all(&mut copy)
        .await;
    let closed = copy.close().await;
    let found = found.map_err(BackupError::Copy)?;
    closed.map_err(BackupError::Copy)?;
    match found.iter().find(|line| *line != "ok") {
        Some(first) => Err(BackupError::Damaged(first.clone())),
        None => Ok(()),
    }
}

/// Gives the copy its name once it is on the disk.
fn place(partial: &Path, target: &Path) -> Result<(), BackupError> {
    let synced = std::fs::File::open(partial).and_then(|file| file.sync_all());
    // A link, unlike a rename, does not take the place of a file that has appeared meanwhile.
    let linked = synced.and_then(|()| std::fs::hard_link(partial, target));
    linked.map_err(BackupError::Place)?;
    std::fs::remove_file(partial).map_err(BackupError::Place)
}
