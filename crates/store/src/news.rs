//! Reports of other processes on the same database: the server passes them on with each commit (see `migrations/postgres`).

use sqlx::postgres::PgListener;
use uuid::Uuid;

use super::statement::Pool;
use super::{Status, Store, StoreError};

/// The channel on which the triggers notify.
const CHANNEL: &str = "meshwright";

/// Something that a process has done, this one perhaps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Notice {
    /// A job waits.
    Work,
    /// The state of jobs has changed.
    Jobs(Status, Vec<Uuid>),
    /// A study has changed.
    Study(Uuid),
    /// A message to a webhook waits.
    Message,
    /// Something may have been missed.
    Missed,
}

/// Somebody who listens.
pub struct Listener(PgListener);

impl Store {
    /// Listens to other processes; none where there are no others.
    pub async fn listen(&self) -> Result<Option<Listener>, StoreError> {
        let Pool::Postgres(pool, _) = &self.readers else {
            return Ok(None);
        };
        let mut listener = PgListener::connect_with(pool).await?;
        listener.listen(CHANNEL).await?;
        Ok(Some(Listener(listener)))
    }
}

impl Listener {
    /// The next notice.
    pub async fn next(&mut self) -> Result<Notice, StoreError> {
        // Without a connection a notice may be lost.
        let heard = self.0.try_recv().await?;
        Ok(heard.map_or(Notice::Missed, |heard| read(heard.payload())))
    }
}

/// Meaning of a trigger's words. Those of a later version mean that something has happened.
fn read(words: &str) -> Notice {
    let mut words = words.split(' ');
    let notice = match words.next() {
        Some("work") => Some(Notice::Work),
        // The version before sent one at a time.
        Some("jobs" | "job") => {
            let status = words.next().and_then(Status::of_word);
            let ids: Option<Vec<Uuid>> = words.by_ref().map(|id| id.parse().ok()).collect();
            let ids = ids.filter(|ids| !ids.is_empty());
            status
                .zip(ids)
                .map(|(status, ids)| Notice::Jobs(status, ids))
        }
        Some("message") => Some(Notice::Message),
        Some("study") => words
            .next()
            .and_then(|id| id.parse().ok())
            .map(Notice::Study),
        _ => None,
    };
    notice.unwrap_or(Notice::Missed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_told_is_understood_or_taken_for_news() {
        let id = Uuid::now_v7();
        for (words, meant) in [
            ("work".to_owned(), Notice::Work),
            (
                format!("job dismissed {id}"),
                Notice::Jobs(Status::Dismissed, vec![id]),
            ),
            (
                format!("jobs failed {id} {id}"),
                Notice::Jobs(Status::Failed, vec![id, id]),
            ),
            (format!("jobs failed {id} x"), Notice::Missed),
            ("message".to_owned(), Notice::Message),
            (format!("study {id}"), Notice::Study(id)),
            ("job dismissed".to_owned(), Notice::Missed),
            ("weather fine".to_owned(), Notice::Missed),
            (String::new(), Notice::Missed),
        ] {
            assert_eq!(read(&words), meant, "{words}");
        }
    }
}
