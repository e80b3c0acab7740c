//! Behavior of the store on any database, on PostgreSQL; and interactions of several processes.

#![expect(
    clippy::duplicate_mod,
    reason = "the suites of SQLite once more, on another store"
)]

use super::*;

#[path = "doubt.rs"]
mod doubt;
mod encrypted;
#[path = "keeping.rs"]
mod keeping;
#[path = "lists.rs"]
mod lists;
mod many;
#[path = "transitions.rs"]
mod transitions;
#[path = "turns.rs"]
mod turns;
mod upgrades;

/// A database whose leases run by the clock that a test gives.
async fn store() -> (Store, DatabaseAddress) {
    let address = server::database().await;
    let place = DatabaseAddress::Postgres(address.clone());
    let store = Store::open(&place).await.unwrap();
    server::give_clock(&address).await;
    (store, place)
}
