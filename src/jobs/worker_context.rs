//! Common state of the workers of a process.

use std::time::Duration;

use jiff::SignedDuration;
use meshwright_store::Lease;
use rayon::ThreadPool;

use super::queue::Jobs;
use crate::compute::{NoThreads, Solve, Work, engine_threads};

/// How the workers keep time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// A worker that has not reported for so long is taken for lost.
    pub lease: Duration,
    /// Interval of a worker's reports.
    pub heartbeat: Duration,
    /// A job that takes longer fails.
    pub time_limit: Duration,
    /// A job that has lost so many workers fails.
    pub attempts_limit: u32,
    /// Longest time that the outcome of one job waits for others of the same claim, to be written in one commit.
    pub gather: Duration,
}

impl Pace {
    /// Leases of half a minute, three attempts, and a limit for each job.
    pub fn with_time_limit(time_limit: Duration) -> Self {
        Self::with_lease(Duration::from_secs(30), time_limit)
    }

    /// Leases of this length, three attempts, and a limit for each job.
    pub fn with_lease(lease: Duration, time_limit: Duration) -> Self {
        Self {
            lease,
            heartbeat: (lease / 5).min(Duration::from_secs(2)),
            time_limit,
            attempts_limit: 3,
            gather: Duration::from_millis(50),
        }
    }
}

/// Common state of all workers.
pub(super) struct WorkerContext {
    pub(super) jobs: Jobs,
    pub(super) solve: Solve,
    pub(super) pace: Pace,
}

impl WorkerContext {
    /// A lease that is given now.
    pub(super) fn lease(&self) -> Lease {
        Lease {
            steady: self.jobs.clock.steady(),
            lasts: SignedDuration::try_from(self.pace.lease).unwrap_or(SignedDuration::MAX),
        }
    }
}

/// The threads of a worker.
pub(super) struct Threads {
    /// For a job that is computed alone, and has all of them.
    together: ThreadPool,
    /// For several small ones, each on one: from a second thread a small job gains less than the two of them wait for each other.
    apart: Vec<ThreadPool>,
}

impl Threads {
    /// The cores of worker number `worker` of `count`.
    pub(super) fn of(worker: usize, count: usize) -> Result<Self, NoThreads> {
        let name = move |index| format!("engine-{worker}-{index}");
        let apart = (0..count)
            .map(|place| engine_threads(move |_| format!("small-{worker}-{place}"), Work::Job, 1));
        Ok(Self {
            together: engine_threads(name, Work::Job, count)?,
            apart: apart.collect::<Result<_, _>>()?,
        })
    }

    /// The pools for so many jobs that were claimed together: each pool computes one after the other.
    pub(super) fn for_jobs(&self, count: usize) -> &[ThreadPool] {
        match count {
            0 | 1 => std::slice::from_ref(&self.together),
            _ => &self.apart[..count.min(self.apart.len())],
        }
    }
}
