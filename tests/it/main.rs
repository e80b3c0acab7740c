//! The service over real sockets, with a real database and an engine that does as the test tells it.

#![expect(
    clippy::unwrap_used,
    reason = "a test may end where its assumption does"
)]

/// Which store the suites run on.
const ON_POSTGRES: bool = false;

mod bench;
#[path = "../postgres/server.rs"]
mod server;
mod stores;
mod submitters;

mod batch;
mod chaos;
mod connections;
mod contract;
mod disk;
mod door;
mod edge;
mod events;
mod fleet;
mod flood;
mod frozen;
mod generated;
mod growth;
mod life;
mod lists;
mod members;
mod one_process;
mod operators;
mod page;
mod population;
mod previews;
mod process;
mod readers;
mod real;
mod recovery;
mod refusals;
mod repeats;
mod rexs;
mod searches;
mod shares;
mod sigkill;
mod spans;
mod strain;
mod studies;
mod tables;
mod time;
mod tokens;
mod upgrade;
mod uploads;
mod webhooks;
