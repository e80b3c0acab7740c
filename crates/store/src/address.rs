//! Where the database is.

use std::convert::Infallible;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use sqlx::postgres::PgConnectOptions;

/// Where the database is: a file of SQLite, or a server of PostgreSQL.
#[derive(Clone, PartialEq, Eq)]
pub enum DatabaseAddress {
    /// A file, served by one process; `sqlite:` may stand before its path.
    File(PathBuf),
    /// A database of a server, `postgres://user:password@host:port/name`, on which several processes work.
    Postgres(String),
}

impl DatabaseAddress {
    /// The file, if it is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Postgres(_) => None,
        }
    }
}

impl FromStr for DatabaseAddress {
    type Err = Infallible;

    // A faulty address is reported when it is used: a parser of arguments repeats the text that it does not understand, with the password.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        let is_address = text.starts_with("postgres://") || text.starts_with("postgresql://");
        let file = ["sqlite://", "sqlite:"]
            .iter()
            .find_map(|scheme| text.strip_prefix(scheme))
            .unwrap_or(text);
        Ok(if is_address {
            Self::Postgres(text.to_owned())
        } else {
            Self::File(file.into())
        })
    }
}

impl From<&Path> for DatabaseAddress {
    fn from(path: &Path) -> Self {
        Self::File(path.to_owned())
    }
}

impl fmt::Display for DatabaseAddress {
    /// Without user and password.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Postgres(address) => match PgConnectOptions::from_str(address) {
                Ok(options) => {
                    let (host, port) = (options.get_host(), options.get_port());
                    let name = options.get_database().unwrap_or_default();
                    write!(f, "postgres://{host}:{port}/{name}")
                }
                // Which part of it is a password is anybody's guess.
                Err(_) => f.write_str("postgres://..."),
            },
        }
    }
}

impl fmt::Debug for DatabaseAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_database_is_a_file_or_a_server_and_no_password_is_shown() {
        let place = |text: &str| text.parse::<DatabaseAddress>().unwrap();
        for (text, file) in [
            ("./a.db", "./a.db"),
            ("sqlite:a.db", "a.db"),
            ("sqlite://a.db", "a.db"),
            ("sqlite:///var/a.db", "/var/a.db"),
        ] {
            assert_eq!(place(text), DatabaseAddress::File(file.into()));
        }
        for (text, shown) in [
            (
                "postgres://me:secret@db.example:5433/gears",
                "postgres://db.example:5433/gears",
            ),
            (
                "postgresql://me:secret@db:1/gears?password=secret",
                "postgres://db:1/gears",
            ),
            ("postgres://me:sec?ret@db/gears", "postgres://..."),
        ] {
            assert_eq!(format!("{}", place(text)), shown);
            assert_eq!(format!("{:?}", place(text)), shown);
        }
    }
}
