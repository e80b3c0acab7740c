//! Threads for the engine.

use std::thread;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
#[cfg(target_os = "linux")]
use tracing::warn;

/// One computation uses so many cores at most: its serial parts leave more of them idle.
const MOST_FOR_ONE: usize = 8;

/// Threads of workers for each core. More than one, so that a computation in a serial part leaves its cores to others.
const THREADS_A_CORE: usize = 4;

/// How the cores of the machine are divided among computations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cores {
    available: usize,
}

impl Cores {
    /// The threads of this machine.
    pub fn here() -> Self {
        Self::of(thread::available_parallelism().map_or(1, usize::from))
    }

    /// The threads of a machine with `available` cores.
    pub fn of(available: usize) -> Self {
        Self {
            available: available.max(1),
        }
    }

    /// Jobs computed at the same time, unless it is set.
    pub fn workers(self) -> usize {
        let threads = THREADS_A_CORE * self.available;
        self.available.min(threads / self.for_one()).max(1)
    }

    /// The threads of each of so many workers.
    pub(crate) fn for_each_of(self, workers: usize) -> usize {
        let threads = THREADS_A_CORE * self.available;
        self.for_one().min(threads / workers.max(1)).max(1)
    }

    /// The threads of a computation for which somebody waits.
    pub(super) fn for_one(self) -> usize {
        self.available.min(MOST_FOR_ONE)
    }

    /// Previews computed at the same time at most.
    pub(super) fn rooms(self) -> usize {
        self.available.min(MOST_FOR_ONE)
    }
}

/// The system gives no threads.
#[derive(Debug, thiserror::Error)]
#[error("the engine's threads cannot be started")]
pub struct NoThreads(#[source] ThreadPoolBuildError);

/// Kinds of computation, by who waits for the result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Work {
    /// A preview: somebody drags a hole and waits.
    Preview,
    /// A job: its client comes back for it.
    Job,
}

impl Work {
    /// The nice value of the threads above those that answer requests. While others want the processor, they get a third or a tenth of a share.
    fn niceness(self) -> i32 {
        match self {
            Self::Preview => 5,
            Self::Job => 10,
        }
    }
}

/// Threads of their own for one computation at a time: `count` of them.
///
/// Computations do not share them. In a pool that several share, a thread that waits for a part of its own may take up
/// another whole one, and the first ends only when that does.
///
/// The system serves other threads first. A request needs a core for a fraction of a millisecond. A computation needs all of them until it ends. With equal
/// priority a request waits for the end of a time slice of every engine thread. Under full load this wait is longer than all others together. The computation
/// loses only the time that requests use.
pub(crate) fn engine_threads(
    name: impl Fn(usize) -> String + 'static,
    work: Work,
    count: usize,
) -> Result<ThreadPool, NoThreads> {
    ThreadPoolBuilder::new()
        .thread_name(name)
        .num_threads(count)
        .start_handler(move |_| give_way(work.niceness()))
        .build()
        .map_err(NoThreads)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_bounded_on_a_machine_of_any_size() {
        for (cores, workers, each) in [
            (1, 1, 1),
            (2, 2, 2),
            (4, 4, 4),
            (8, 4, 8),
            (16, 8, 8),
            (64, 32, 8),
        ] {
            let machine = Cores::of(cores);
            assert_eq!(
                (machine.workers(), machine.for_each_of(machine.workers())),
                (workers, each)
            );
            assert!(workers * each <= THREADS_A_CORE * cores);
        }
        // However many workers are asked for, each has a thread, and not many more.
        assert_eq!(Cores::of(64).for_each_of(1000), 1);
        assert_eq!(Cores::of(64).for_each_of(1), 8);
    }
}
