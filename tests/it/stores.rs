//! The store that the suites run on: files of SQLite, or databases of a PostgreSQL.

use meshwright::jobs::DatabaseAddress;
use sqlx::sqlite::SqlitePool;
use tempfile::TempDir;
use tokio::sync::Mutex;

use crate::server;

/// Held by what takes the whole machine for a while, and by what must not take longer than it may.
pub(crate) static ALONE: Mutex<()> = Mutex::const_new(());

/// Whether the suites run on PostgreSQL.
pub(crate) fn on_postgres() -> bool {
    std::env::var_os("MESHWRIGHT_TEST_STORE").is_some_and(|store| store == "postgres")
}

/// A database without anything in it: a file in `folder`, or one of the server.
pub(crate) async fn place(folder: &TempDir) -> DatabaseAddress {
    if on_postgres() {
        DatabaseAddress::Postgres(server::database().await)
    } else {
        DatabaseAddress::File(folder.path().join("meshwright.db"))
    }
}

/// What the command line calls it.
pub(crate) fn address(place: &DatabaseAddress) -> String {
    match place {
        DatabaseAddress::File(path) => path.to_str().unwrap().to_owned(),
        DatabaseAddress::Postgres(address) => address.clone(),
    }
}

/// The number that a query gives.
pub(crate) async fn number(place: &DatabaseAddress, query: &'static str) -> i64 {
    match place {
        DatabaseAddress::File(path) => {
            let address = format!("sqlite://{}", path.display());
            let file = SqlitePool::connect(&address).await.unwrap();
            let number = sqlx::query_scalar(query);
            number.fetch_one(&file).await.unwrap()
        }
        DatabaseAddress::Postgres(address) => {
            let number = sqlx::query_scalar(query);
            let mut connection = server::connect(address).await;
            number.fetch_one(&mut connection).await.unwrap()
        }
    }
}

/// Bytes of a database.
pub(crate) async fn bytes(place: &DatabaseAddress) -> u64 {
    let bytes = match place {
        DatabaseAddress::File(path) => std::fs::metadata(path).unwrap().len().try_into(),
        DatabaseAddress::Postgres(_) => {
            Ok(number(place, "select pg_database_size(current_database())").await)
        }
    };
    bytes.unwrap().unsigned_abs()
}

/// Has all leases run out, as they do while nobody reports; on SQLite the next process does not wait for that.
pub(crate) async fn pass_a_lease(place: &DatabaseAddress) {
    if let DatabaseAddress::Postgres(address) = place {
        let mut connection = server::connect(address).await;
        for statement in [
            "update jobs set lease_until = 1 where status = 'running'",
            "update studies set expanding_until = 0",
        ] {
            sqlx::query(statement)
                .execute(&mut connection)
                .await
                .unwrap();
        }
    }
}

/// Has leases run by the clock that a test gives, which on SQLite they do anyway.
pub(crate) async fn give_clock(place: &DatabaseAddress) {
    if let DatabaseAddress::Postgres(address) = place {
        server::give_clock(address).await;
    }
}
