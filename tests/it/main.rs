//! The service over real sockets, with a real database and an engine that does as the test tells it.

#![expect(
    clippy::unwrap_used,
    reason = "a test may end where its assumption does"
)]

mod bench;
#[path = "../postgres/server.rs"]
mod server;
mod stores;
mod submitters;

/// What the store has a part in: `./test all` runs these suites once more with `MESHWRIGHT_TEST_STORE=postgres`, and `./test` eight of them.
#[path = "."]
mod either_store {
    pub(crate) mod admission;
    mod batch;
    mod chaos;
    mod events;
    mod growth;
    mod life;
    mod links;
    mod lists;
    mod members;
    mod population;
    pub(crate) mod process;
    mod projects;
    mod recovery;
    mod repeats;
    mod searches;
    mod shares;
    mod sigkill;
    mod strain;
    mod studies;
    mod tables;
    mod time;
    mod usage;
    mod users;
    pub(crate) mod webhooks;
}

mod circles;
mod connections;
mod contract;
mod disk;
mod edge;
mod fleet;
mod flood;
mod frozen;
mod generated;
mod mangled;
mod memory;
mod one_process;
mod operators;
mod page;
mod previews;
mod readers;
mod real;
mod refusals;
mod rexs;
#[cfg(feature = "otlp")]
mod spans;
mod threads;
mod tokens;
mod upgrade;
mod uploads;

use either_store::{admission, process};
