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
pub use queue::{Clock, Filter, JobError, Jobs, Page, Rules, Submitted};
pub use store::{Cursor, Store};
pub use worker::{Pace, Solve, Workers};
