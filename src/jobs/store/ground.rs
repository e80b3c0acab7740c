//! What a file of SQLite stands on: its name, which may be taken from it while it is open, and the room on its disk.

use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// With less room on the disk nothing is taken for writable, in bytes. A look writes less than a submission does, and what one
/// checkpoint gives back is enough for many looks.
#[cfg(unix)]
const LEAST_ROOM: u64 = 1 << 20;

/// The file of a database, as it was when it was opened.
#[derive(Debug, Clone)]
pub(super) struct Ground {
    path: PathBuf,
    identity: Identity,
}

#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = ();

impl Ground {
    pub(super) fn of(path: &Path) -> Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            identity: identity(path)?,
        })
    }

    /// That the file still has its name. What is written to one that has lost it is gone with the process.
    pub(super) fn check_name(&self) -> Result<()> {
        match identity(&self.path) {
            Ok(identity) if identity == self.identity => Ok(()),
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
            _ => Err(Error::new(
                ErrorKind::NotFound,
                "the file of the database was removed, or another one has its name",
            )),
        }
    }

    /// That there is room for what comes.
    pub(super) fn check_room(&self) -> Result<()> {
        #[cfg(unix)]
        {
            let disk = rustix::fs::statvfs(&self.path)?;
            if disk.f_bavail.saturating_mul(disk.f_frsize) < LEAST_ROOM {
                return Err(Error::new(ErrorKind::StorageFull, "the disk is full"));
            }
        }
        Ok(())
    }
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
