//! The keeper: removes results at the end of their retention, returns space, and keeps the journal short.

use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use meshwright_connections::spawn;
use meshwright_store::{Removed, StoreError};
use tokio::task::JoinHandle;
use tokio::time::{Instant, interval_at, sleep};
use tracing::{info, warn};

use super::queue::Jobs;

/// The journal is emptied when it has grown beyond this.
const LONG_JOURNAL: u64 = 64 << 20;

/// Between two commits of the keeper others write.
const BREATH: Duration = Duration::from_millis(5);

/// Messages to webhooks are kept so long, for the list of deliveries and for receivers that are away.
const MESSAGES_FOR: SignedDuration = SignedDuration::from_hours(7 * 24);

/// Retention of results and the interval of removals.
#[derive(Debug, Clone, Copy)]
pub struct Keep {
    /// Jobs and studies are kept so long after their end; without, for good.
    pub results_for: Option<SignedDuration>,
    /// Limit of the file in bytes; beyond it the jobs that ended first are removed. `None`: no limit.
    pub bytes: Option<u64>,
    /// The first look comes so long after the start: by then a clock that was wrong at the start is mostly right.
    pub first: Duration,
    /// Between two looks.
    pub every: Duration,
}

/// The task that enforces the retention.
pub struct Keeper(JoinHandle<()>);

impl Keeper {
    /// Starts the task that enforces the retention of `jobs`, until their stop.
    pub fn start(jobs: Jobs, keep: Keep) -> Self {
        Self(spawn(async move {
            let mut tick = interval_at(Instant::now() + keep.first, keep.every);
            loop {
                tokio::select! {
                    _ = tick.tick() => {}
                    () = jobs.stop().cancelled() => return,
                }
                if let Err(error) = jobs.look_after(keep).await {
                    warn!(%error, "what is old cannot be removed now");
                }
            }
        }))
    }

    /// Comes back when it has ended.
    pub async fn ended(self) {
        // The task neither panics nor is aborted.
        let _ = self.0.await;
    }
}

impl Jobs {
    /// Removes results that are past their retention or beyond the limit, and returns the space.
    ///
    /// # Errors
    ///
    /// [`StoreError`]; the next look goes on where this one ends.
    pub async fn look_after(&self, keep: Keep) -> Result<(), StoreError> {
        if let Some(before) = self.kept_since(keep) {
            let removed = self.remove_while(before, None).await?;
            tell("kept long enough", removed);
        }
        // The size of a server's database does not shrink when rows are removed: it would never fall below the limit.
        if keep.bytes.is_some() && !self.store.is_shared() {
            let removed = self.remove_while(Timestamp::MAX, keep.bytes).await?;
            tell("no room for it", removed);
        }
        while !self.stop().is_cancelled() && self.store.shrink().await? {
            sleep(BREATH).await;
        }
        if self.store.journal_bytes() > LONG_JOURNAL {
            self.store.empty_journal().await?;
        }
        self.forget_keys().await?;
        self.forget_links().await?;
        self.forget_messages().await
    }

    /// Forgets messages to webhooks that are a week old, arrived or not.
    async fn forget_messages(&self) -> Result<(), StoreError> {
        let now = self.clock.now().min(self.clock.steady());
        let before = now.saturating_sub(MESSAGES_FOR).unwrap_or(Timestamp::MIN);
        self.store.forget_messages(before).await
    }

    /// Jobs that ended before this time are old. The earlier of the two clocks decides: one that was set forward by mistake, at the start or later, removes
    /// nothing as long as the other one is right.
    fn kept_since(&self, keep: Keep) -> Option<Timestamp> {
        let now = self.clock.now().min(self.clock.steady());
        now.checked_sub(keep.results_for?).ok()
    }

    /// Removes jobs that ended before a time, the oldest first, as long as the file is larger than the limit.
    async fn remove_while(
        &self,
        before: Timestamp,
        more_than: Option<u64>,
    ) -> Result<Removed, StoreError> {
        let mut all = Removed::default();
        while !self.stop().is_cancelled() {
            if let Some(most) = more_than
                && self.store.space().await?.used() <= most
            {
                break;
            }
            let removed = self.store.remove_old(before).await?;
            if removed.is_nothing() {
                break;
            }
            all.jobs += removed.jobs;
            all.studies += removed.studies;
            sleep(BREATH).await;
        }
        Ok(all)
    }
}

fn tell(why: &'static str, removed: Removed) {
    if !removed.is_nothing() {
        metrics::counter!("meshwright_removed_jobs_total").increment(removed.jobs);
        metrics::counter!("meshwright_removed_studies_total").increment(removed.studies);
        info!(
            jobs = removed.jobs,
            studies = removed.studies,
            why,
            "removed"
        );
    }
}
