//! Threads for the engine.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
#[cfg(target_os = "linux")]
use tracing::warn;

/// What threads compute, by who waits for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Work {
    /// A preview: somebody drags a hole and waits.
    Preview,
    /// A job: its client comes back for it.
    Job,
}

impl Work {
    /// So much nicer are the threads than those that answer requests: while others want the processor, they take a third
    /// or a tenth of a share.
    fn niceness(self) -> i32 {
        match self {
            Self::Preview => 5,
            Self::Job => 10,
        }
    }
}

/// Threads of their own for one computation at a time, as many as there are cores: a single one fills the machine.
///
/// Computations do not share them. In a pool that several share, a thread that waits for a part of its own may take up
/// another whole one, and the first ends only when that does.
///
/// The system serves other threads first. A request needs a core for a fraction of a millisecond, a computation all of
/// them for as long as it lasts: without a difference a request waits for the end of a time slice of every engine's
/// thread, which under full load is longer than everything else that it waits for. The computation loses what requests
/// take, no more.
pub(super) fn engine_threads(
    name: impl Fn(usize) -> String + 'static,
    work: Work,
) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new()
        .thread_name(name)
        .start_handler(move |_| give_way(work.niceness()))
        .build()
}

#[cfg(target_os = "linux")]
fn give_way(niceness: i32) {
    if let Err(error) = rustix::process::nice(niceness) {
        warn!(%error, "the engine's threads keep the priority of those that answer");
    }
}

/// Elsewhere the priority belongs to the whole process, and there is nothing to tell apart.
#[cfg(not(target_os = "linux"))]
fn give_way(_niceness: i32) {}
