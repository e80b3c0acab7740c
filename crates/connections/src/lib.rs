//! Connections of HTTP: their number, the share of a client, and their end. It knows requests and clients, but not the content of requests and answers.
//!
//! In reading order: the [`Budget`] that clients share; a [`Connection`] and its requests; the [limit](Overloaded) of connections, the eviction of idle ones
//! and the limit for one client; reads and writes that stall; the [`Rates`] of requests, and those [without a key](Unauthenticated); the [`Server`] that
//! accepts connections and serves them. Then parts of answers: tasks that can be [measured](measure_polls), work that delays no other request ([`blocking`]),
//! packing, and entity [tags](Tag).

mod accepts;
mod active_request;
mod blocking;
mod budget;
mod connection;
mod limit;
mod packing;
mod rates;
mod server;
mod stalled_reads;
mod stalled_writes;
mod tag;
mod tasks;
mod unauthenticated;

pub use accepts::takes_gzip;
pub use active_request::ActiveRequest;
pub use blocking::{StopOnDrop, blocking};
pub use budget::{Budget, Part};
pub use connection::{Address, Connection};
pub use limit::Overloaded;
pub use packing::{gains_by_packing, packed, packed_stream, packed_whole, say_packed};
pub use rates::Rates;
pub use server::{Answer, AnswerBody, Bounds, Server};
pub use stalled_reads::WatchedBody;
pub use tag::{Keep, Tag};
pub use tasks::{Gauge, measure_polls, spawn};
pub use unauthenticated::Unauthenticated;
