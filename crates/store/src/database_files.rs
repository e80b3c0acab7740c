//! Identity of a SQLite database's file and of its journal, which may be renamed or replaced while they are open, and the room on its disk.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

use super::lock::beside;

/// Room on the disk below which the database counts as read-only, in bytes. A check writes less than a submission does, and one checkpoint frees enough room
/// for many checks.
#[cfg(unix)]
const LEAST_ROOM: u64 = 1 << 20;

/// The file of a database, as it was when something had been written to it.
#[derive(Debug, Clone)]
pub(super) struct DatabaseFiles {
    path: PathBuf,
    /// The file, and the journal beside it.
    files: [(PathBuf, Identity); 2],
}

#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = ();

impl DatabaseFiles {
    pub(super) fn of(path: &Path) -> Result<Self> {
        // The journal stands beside the file, wherever a link to that stands.
        let journal = beside(&path.canonicalize()?, "-wal");
        let (own, its) = (identity(path)?, identity(&journal)?);
        Ok(Self {
            path: path.to_owned(),
            files: [(path.to_owned(), own), (journal, its)],
        })
    }

    /// Checks that both still have their names. Data written to a file without a name is lost with the process.
    pub(super) fn check_names(&self) -> Result<()> {
        for (path, known) in &self.files {
            match identity(path) {
                Ok(identity) if identity == *known => {}
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {
                    return Err(Error::new(
                        ErrorKind::NotFound,
                        "the file of the database or its journal was removed, or another one has its name",
                    ));
                }
            }
        }
        Ok(())
    }

    /// The bytes of the disk, and those of them that are free for this process.
    pub(super) fn disk(&self) -> Option<(u64, u64)> {
        #[cfg(unix)]
        {
            let disk = rustix::fs::statvfs(&self.path).ok()?;
            let bytes = |blocks: u64| blocks.saturating_mul(disk.f_frsize);
            Some((bytes(disk.f_blocks), bytes(disk.f_bavail)))
        }
        #[cfg(not(unix))]
        None
    }

    /// Checks that there is room for the next write.
    pub(super) fn check_room(&self) -> Result<()> {
        check_room(&self.path)
    }
}

/// That there is room on the disk of `path`.
fn check_room(path: &Path) -> Result<()> {
    #[cfg(unix)]
    {
        let disk = rustix::fs::statvfs(path)?;
        if disk.f_bavail.saturating_mul(disk.f_frsize) < LEAST_ROOM {
            return Err(Error::new(ErrorKind::StorageFull, "the disk is full"));
        }
    }
    #[cfg(not(unix))]
    let _ = path;
    Ok(())
}

/// True if the disk of a file, or of the folder in which it would be made, is full.
pub(super) fn is_on_a_full_disk(path: &Path) -> bool {
    let place = match path.parent() {
        Some(folder) if !path.exists() => folder,
        _ => path,
    };
    check_room(place).is_err_and(|error| error.kind() == ErrorKind::StorageFull)
}

#[cfg(unix)]
fn identity(path: &Path) -> Result<Identity> {
    use std::os::unix::fs::MetadataExt;
    let data = std::fs::metadata(path)?;
    Ok((data.dev(), data.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Result<Identity> {
    std::fs::metadata(path).map(|_| ())
}
