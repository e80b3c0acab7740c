//! What the workers of a process have in common.

use std::time::Duration;

use jiff::SignedDuration;

use super::queue::Jobs;
use super::store::Lease;
use crate::compute::Solve;

/// How the workers keep time.
#[derive(Debug, Clone, Copy)]
pub struct Pace {
    /// A worker that has not reported for so long is taken for lost.
    pub lease: Duration,
    /// So often a worker reports.
    pub heartbeat: Duration,
    /// A job that takes longer fails.
    pub time_limit: Duration,
    /// A job that has lost so many workers fails.
    pub attempts_limit: u32,
    /// What came of one job waits so long at most for the others that were claimed with it, to be written with them in one commit.
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

/// What every worker has in common.
pub(super) struct Shop {
    pub(super) jobs: Jobs,
    pub(super) solve: Solve,
    pub(super) pace: Pace,
}

impl Shop {
    /// A lease that is given now.
    pub(super) fn lease(&self) -> Lease {
        Lease {
            steady: self.jobs.clock.steady(),
            lasts: SignedDuration::try_from(self.pace.lease).unwrap_or(SignedDuration::MAX),
        }
    }
}
