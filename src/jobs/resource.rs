//! What jobs and studies have in common as things that a client submits, lists and waits for.

use std::time::Duration;

use uuid::Uuid;

use super::error::JobError;
use super::queue::Jobs;
use super::store::Cursor;

/// A job or a study that answers a submission.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted<T> {
    /// As it stands now.
    pub record: T,
    /// Whether an earlier request with the same key made it.
    pub repeated: bool,
}

/// Some jobs or studies of a list.
#[derive(Debug)]
pub struct Listed<T> {
    /// They, newest first.
    pub items: Vec<T>,
    /// Where the list goes on.
    pub next: Option<Cursor>,
}

impl<T> Listed<T> {
    /// The first `limit` of what was `found`, of which one more was asked for: it tells whether the list goes on.
    pub(super) fn first(mut found: Vec<T>, limit: u32, sequence: impl Fn(&T) -> i64) -> Self {
        let goes_on = found.len() > limit as usize;
        found.truncate(limit as usize);
        let last = found.last().filter(|_| goes_on);
        let next = last.map(|item| Cursor(sequence(item)));
        Self { items: found, next }
    }
}

impl Jobs {
    /// What `look` finds of the job or study `id` once that `has_ended`, or as it stands after `patience`. It looks when there is
    /// news, and `pause` after that.
    pub(super) async fn until_ended<T, Look>(
        &self,
        id: Uuid,
        patience: Duration,
        pause: Duration,
        look: impl Fn() -> Look,
        has_ended: impl Fn(&T) -> bool,
    ) -> Result<T, JobError>
    where
        Look: Future<Output = Result<T, JobError>>,
    {
        let ended = async {
            let mut news = self.news(id);
            loop {
                let found = look().await?;
                if has_ended(&found) {
                    return Ok(found);
                }
                news.changed_state().await;
                // A sleep of no time would take a millisecond.
                if !pause.is_zero() {
                    tokio::time::sleep(pause).await;
                }
            }
        };
        tokio::select! {
            found = ended => found,
            () = tokio::time::sleep(patience) => look().await,
            () = self.stop().cancelled() => look().await,
        }
    }
}
