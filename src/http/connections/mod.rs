//! Connections: how many there are, which of them a client may use, and how they end.
//!
//! In reading order: what is known of a [`Connection`] and its requests; the [limit] of connections, the eviction of idle ones
//! and the limit for one client; reads and writes that stall; the [rates] of requests, and those [without a key](unauthenticated); the
//! [server] that accepts connections and serves them.

mod connection;
mod limit;
mod rates;
mod server;
mod stalled_reads;
mod stalled_writes;
mod unauthenticated;

pub(super) use connection::{ActiveRequest, Address, Connection};
pub(super) use limit::Overloaded;
pub(super) use rates::Rates;
pub use server::{Answer, AnswerBody, Bounds, Server};
pub use stalled_reads::WatchedBody;
pub(super) use unauthenticated::Unauthenticated;
