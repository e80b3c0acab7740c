//! Files that are their owner's alone: the database has all results, and the secrets that webhooks are signed with.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::Path;

/// Opens the file at `path` to read and write, and makes it if it is absent: then only its owner may read it, where the system has owners. The files of SQLite
/// beside a database have the rights of the database.
///
/// # Errors
///
/// When the file can neither be opened nor made.
pub(crate) fn open_or_make(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)
}
