//! Two clocks: the time of day, which people read and somebody may set, and one that only ever goes on.

use std::sync::Arc;
use std::time::Instant;

use jiff::{SignedDuration, Timestamp};

/// The clocks of a process; cloning shares them. They are given, so that tests can set them.
#[derive(Clone)]
pub struct Clock {
    wall: Arc<dyn Fn() -> Timestamp + Send + Sync>,
    steady: Arc<dyn Fn() -> Timestamp + Send + Sync>,
}

impl Clock {
    /// The clocks of the system. The steady one starts at the time of day.
    pub fn system() -> Self {
        let (origin, start) = (Timestamp::now(), Instant::now());
        let steady = move || {
            let elapsed = SignedDuration::try_from(start.elapsed()).unwrap_or(SignedDuration::MAX);
            origin.saturating_add(elapsed).unwrap_or(Timestamp::MAX)
        };
        Self::given(Timestamp::now, steady)
    }

    /// Clocks that stand where `wall` and `steady` say.
    pub fn given(
        wall: impl Fn() -> Timestamp + Send + Sync + 'static,
        steady: impl Fn() -> Timestamp + Send + Sync + 'static,
    ) -> Self {
        Self {
            wall: Arc::new(wall),
            steady: Arc::new(steady),
        }
    }

    /// The time of day, for people. It may jump.
    pub fn now(&self) -> Timestamp {
        (self.wall)()
    }

    /// The steady time: for leases, durations, and everything that is kept for some time. It never jumps while the process
    /// lives, and says little about the time of day if that was wrong at the start.
    pub fn steady(&self) -> Timestamp {
        (self.steady)()
    }
}
