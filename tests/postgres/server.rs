//! A PostgreSQL for the tests: one server a process, or the one that `MESHWRIGHT_TEST_POSTGRES` names, and a database for each
//! test.

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use sqlx::{AssertSqlSafe, Connection, Executor, PgConnection};

/// The address of the server's own database.
fn server() -> &'static str {
    static SERVER: OnceLock<String> = OnceLock::new();
    SERVER.get_or_init(|| {
        if let Ok(address) = std::env::var("MESHWRIGHT_TEST_POSTGRES") {
            return address;
        }
        start().0
    })
}

/// Starts a server that ends with this process. Gives back its address and its folder.
pub(crate) fn start() -> (String, String) {
    start_with(&[])
}

/// The same with settings of `tests/postgres/start`.
pub(crate) fn start_with(settings: &[(&str, &str)]) -> (String, String) {
    // The suites of the service have it beside them, those of the store two folders above.
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let mut scripts = folders.map(|folder| folder.join("tests/postgres/start"));
    let script = scripts.find(|script| script.exists());
    let started = Command::new(script.expect("the workspace has tests/postgres/start"))
        .arg(std::process::id().to_string())
        .envs(settings.iter().copied())
        .stderr(Stdio::inherit())
        .output()
        .unwrap();
    assert!(started.status.success(), "tests/postgres/start failed");
    let told = String::from_utf8(started.stdout).unwrap();
    let (address, folder) = told.trim().split_once(' ').unwrap();
    (address.to_owned(), folder.to_owned())
}

/// A connection to a database.
pub(crate) async fn connect(address: &str) -> PgConnection {
    PgConnection::connect(address).await.unwrap()
}

/// The address of a new database without anything in it.
pub(crate) async fn database() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("test_{}_{count}", std::process::id());
    let server = tokio::task::spawn_blocking(server).await.unwrap();
    // The disk is not to fill up. A database of a test that still runs is in use, and the server keeps it.
    if let Some(old) = count.checked_sub(40) {
        let statement = format!("drop database if exists test_{}_{old}", std::process::id());
        let _ = connect(server)
            .await
            .execute(AssertSqlSafe(statement))
            .await;
    }
    database_of(server, &name).await
}

/// The same of a server, with a name.
pub(crate) async fn database_of(server: &str, name: &str) -> String {
    let mut connection = connect(server).await;
    let statement = format!("create database {name}");
    connection.execute(AssertSqlSafe(statement)).await.unwrap();
    connection.close().await.unwrap();
    let (host, _) = server.rsplit_once('/').unwrap();
    format!("{host}/{name}")
}

/// Has leases run by the clock of the process, which a test sets, instead of the database's.
pub(crate) async fn give_clock(address: &str) {
    let mut connection = connect(address).await;
    connection
        .execute(
            "create or replace function steady_now(of_the_process bigint) returns bigint language sql volatile
             return of_the_process",
        )
        .await
        .unwrap();
    connection.close().await.unwrap();
}
