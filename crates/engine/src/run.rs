//! The handle that a caller gives to long work.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The caller asked the work to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the work was stopped")]
pub struct Stopped;

/// Progress of long work, and whether it should go on.
///
/// The engine knows neither job nor thread: it counts the positions that it has solved and asks, between
/// factorizations and between positions, whether it is to stop.
#[derive(Clone)]
pub struct Run {
    stop: Arc<AtomicBool>,
    done: Arc<AtomicU64>,
    total: Arc<AtomicU64>,
    observer: Arc<dyn Fn(u64, u64) + Send + Sync>,
}

impl fmt::Debug for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run").field("stop", &self.stop).finish()
    }
}

impl Run {
    /// A handle that obeys `stop` and tells `observer` (positions done, positions in all) after each position.
    pub fn new(stop: Arc<AtomicBool>, observer: impl Fn(u64, u64) + Send + Sync + 'static) -> Self {
        Self {
            stop,
            done: Arc::default(),
            total: Arc::default(),
            observer: Arc::new(observer),
        }
    }

    /// A handle that nobody watches and nobody stops.
    pub fn unattended() -> Self {
        Self::new(Arc::default(), |_, _| {})
    }

    /// A child handle without progress: it stops with this one.
    pub fn unwatched(&self) -> Self {
        Self::new(Arc::clone(&self.stop), |_, _| {})
    }

    /// Announces `count` more positions of work.
    pub fn expect(&self, count: u64) {
        self.total.fetch_add(count, Ordering::Relaxed);
    }

    /// Reports `count` more positions as solved, and asks whether to go on.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if the caller wants the work to end.
    pub fn reached(&self, count: u64) -> Result<(), Stopped> {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        (self.observer)(done, self.total.load(Ordering::Relaxed));
        self.check()
    }

    /// Asks whether to go on.
    ///
    /// # Errors
    ///
    /// [`Stopped`] if the caller wants the work to end.
    pub fn check(&self) -> Result<(), Stopped> {
        if self.stop.load(Ordering::Relaxed) {
            Err(Stopped)
        } else {
            Ok(())
        }
    }
}
