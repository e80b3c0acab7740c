//! Threads that run the engine, and computations outside of jobs.
//!
//! In reading order:
//!
//! - the [`Cores`] of the machine and the threads on them;
//! - the rooms, which have threads for one computation at a time;
//! - [`Previews`]: a request waits for each of them, and nothing of it is kept;
//! - [`Files`], which are computed anew from a job and kept for a while.
//!
//! Jobs are computed by their workers in the same way.

#![warn(clippy::disallowed_methods)]

mod files;
mod previews;
mod rooms;
mod threads;

use std::any::Any;
use std::sync::Arc;

use meshwright_engine::run::Run;

use meshwright_wire::{Problem, Results, Submission};

pub use files::{Asked, Asker, FileError, FileRules, Files, IsThere, Making};
pub use previews::{PreviewError, PreviewRules, Previewed, Previews};
pub use threads::{Cores, NoThreads};
pub(crate) use threads::{Work, engine_threads};

/// The computation of a submission: long work that fills a core, reports to the run and obeys its stop.
pub type Solve = Arc<dyn Fn(&Submission, &Run) -> Result<Results, Problem> + Send + Sync>;

/// The message of a panic of the engine.
pub(crate) fn message_of(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}
