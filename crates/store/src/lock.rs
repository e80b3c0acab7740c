//! One process works on a database. That makes it certain, at the start, that a job that is said to run has lost its worker;
//! without it, two services would take each other's jobs for lost.

use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

use tracing::warn;

use super::private::open_or_make;

/// Content of the note while a process works, and after its orderly end. Both have the same length, so that the second fits on a full disk.
const AT_WORK: &[u8] = b"at work\n";
const AT_REST: &[u8] = b"at rest\n";

/// The lock of a database, and a note beside it of how its process ended.
pub struct DatabaseLock {
    // The lock is the system's, and ends with the file or the process, however that ends.
    _file: File,
    note: File,
    ended_in_order: bool,
}

/// Why a database cannot be locked.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process has the lock.
    #[error("another process serves the database {}", .0.display())]
    Taken(PathBuf),
    /// The file, or the note beside it, cannot be opened.
    #[error("cannot open {}", path.display())]
    Open {
        /// Which of the two.
        path: PathBuf,
        /// Why.
        #[source]
        error: std::io::Error,
    },
}

impl DatabaseLock {
    /// Locks the database, whatever name it is called by: the lock is on the file, so that links of both kinds lead to the
    /// same one.
    ///
    /// # Errors
    ///
    /// [`LockError`].
    pub fn take(database: &Path) -> Result<Self, LockError> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            |error| LockError::Open { path, error }
        };
        let open = |path: &Path| open_or_make(path).map_err(failed(path));
        let file = open(database)?;
        // Its journal has the name of the database behind all symbolic links, as SQLite finds it.
        let path = database.canonicalize().map_err(failed(database))?;
        let mut note = open(&beside(&path, ".lock"))?;
        // SQLite has locks of another kind on the database. On Linux the two know nothing of each other; elsewhere they
        // may, and the lock is on the file beside it.
        let locked = if cfg!(target_os = "linux") {
            &file
        } else {
            &note
        };
        match locked.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(LockError::Taken(database.to_owned())),
            // Some file systems have no locks; there the operator vouches for it.
            Err(TryLockError::Error(error)) => {
                warn!(%error, "the database cannot be locked: make sure that no other process serves it");
            }
        }
        warn_of_other_names(&path, &file);
        let mut said = Vec::new();
        let read = note.read_to_end(&mut said);
        let lock = Self {
            _file: file,
            ended_in_order: read.is_ok() && said == AT_REST,
            note,
        };
        lock.say(AT_WORK);
        Ok(lock)
    }

    /// True if the process before this one ended in order.
    pub fn ended_in_order(&self) -> bool {
        self.ended_in_order
    }

    /// Notes that this process ends in order.
    pub fn end_in_order(&self) {
        self.say(AT_REST);
    }

    fn say(&self, words: &[u8]) {
        let mut note = &self.note;
        let written = note.rewind().and_then(|()| note.write_all(words));
        if let Err(error) = written {
            warn!(%error, "the note beside the database cannot be written");
        }
    }
}

/// The journal of a database has the name of the database. Under another name (a hard link) the commits in it would not be
/// seen, and be overwritten.
fn warn_of_other_names(path: &Path, file: &File) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let names = file.metadata().map_or(1, |data| data.nlink());
        if names > 1 {
            warn!(names, path = %path.display(), "the database has several names; always serve it under the same one, because its journal has only one");
        }
    }
    #[cfg(not(unix))]
    let _ = (path, file);
}

/// The file that stands beside another one, its name longer by this ending.
pub(crate) fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}
