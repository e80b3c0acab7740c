//! A job's life: from the queue to its results.
//!
//! In reading order: what a [`Job`] is, the [`Store`] that keeps it, the transitions between its states, what of a
//! running job lives in memory only, the [`Jobs`] that handlers speak to, and the [`Workers`] that compute.

mod job;
mod live;
mod queue;
mod store;
mod transitions;
mod worker;

pub use job::{Job, Progress, Status};
pub use queue::{Clock, JobError, Jobs, News, Page, Rules, Submitted};
pub use store::{Cursor, Filter, OpenError, Store};
pub use worker::{Pace, Solve, StartError, Workers};
