//! The last reading of whether the database takes writes.

use std::time::Duration;

use tokio::sync::Mutex;
use tokio::time::Instant;

use crate::jobs::Jobs;

/// A look at the database is good for so long: to look is to write, and anybody may ask.
const GOOD_FOR: Duration = Duration::from_secs(1);

/// When the database took a write, the last time that somebody asked.
#[derive(Debug, Default)]
pub struct Readings(Mutex<Option<Instant>>);

impl Readings {
    /// True if the database takes writes. Simultaneous requests share one look.
    pub(super) async fn database_works(&self, jobs: &Jobs) -> bool {
        let mut last = self.0.lock().await;
        if jobs.store().fault().is_some() {
            *last = None;
            return false;
        }
        if last.is_some_and(|last| last.elapsed() < GOOD_FOR) {
            return true;
        }
        let works = jobs.check().await.is_ok();
        *last = works.then(Instant::now);
        works
    }
}
