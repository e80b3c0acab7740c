//! The suites of `main.rs` once more, on PostgreSQL, each test under a name of its own: `on_postgres::life::...`.
//!
//! Not here is what only a file has (`disk`, `one_process`), what knows no store (`contract`), and what runs on a server anyway (`fleet`).

#![expect(
    clippy::unwrap_used,
    reason = "a test may end where its assumption does"
)]
#![expect(dead_code, reason = "some of what helps the other suites")]

/// Which store the suites run on.
const ON_POSTGRES: bool = true;

#[path = "."]
mod on_postgres {
    pub(crate) mod bench;
    #[path = "../postgres/server.rs"]
    pub(crate) mod server;
    pub(crate) mod stores;
    pub(crate) mod submitters;

    mod batch;
    mod chaos;
    mod connections;
    pub(crate) mod door;
    mod edge;
    mod events;
    mod growth;
    mod life;
    mod lists;
    mod members;
    mod page;
    mod population;
    mod previews;
    pub(crate) mod process;
    mod real;
    mod recovery;
    mod refusals;
    mod repeats;
    mod rexs;
    mod searches;
    mod shares;
    mod sigkill;
    mod strain;
    mod studies;
    mod tables;
    mod time;
    pub(crate) mod webhooks;
}

use on_postgres::{bench, door, process, server, stores, submitters};
