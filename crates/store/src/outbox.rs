//! Messages to webhooks: each is written in the transaction of the change that it reports, so that none is lost and none reports a change that was rolled back.
//! `webhooks` delivers them.

use jiff::Timestamp;
use serde::Serialize;
use uuid::Uuid;

use super::statement::{Connection, query, query_as};
use super::{By, Job, Status, Store, StoreError, StudyRecord};

/// Changes that can be reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// A job that stands alone has ended.
    JobEnded,
    /// A study has ended.
    StudyEnded,
    /// An administrator has deleted a job.
    JobDeleted,
    /// An administrator has deleted a study.
    StudyDeleted,
}

impl EventKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [
        Self::JobEnded,
        Self::StudyEnded,
        Self::JobDeleted,
        Self::StudyDeleted,
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::JobEnded => "job.ended",
            Self::StudyEnded => "study.ended",
            Self::JobDeleted => "job.deleted",
            Self::StudyDeleted => "study.deleted",
        }
    }

    /// The cause in its message; `None` where it is always the client.
    fn by(self) -> Option<&'static str> {
        match self {
            Self::JobEnded | Self::StudyEnded => None,
            Self::JobDeleted | Self::StudyDeleted => By::Administrator.word(),
        }
    }

    /// The kinds of a list of words as it is kept. Later versions report the words that they add.
    pub(crate) fn of_words(words: &str) -> Vec<Self> {
        let words: Vec<String> = serde_json::from_str(words).unwrap_or_default();
        let known = |word: &String| Self::ALL.into_iter().find(|kind| kind.word() == word);
        words.iter().filter_map(known).collect()
    }
}

/// A message to a webhook.
pub(crate) struct NewMessage<'a> {
    /// The webhook.
    pub(crate) webhook: &'a str,
    /// Kind of change, in a word.
    pub(crate) kind: &'static str,
    /// Whose end it reports, or the webhook itself.
    pub(crate) subject: Uuid,
    /// Where that stands.
    pub(crate) status: Option<Status>,
    /// Who did it, in a word, if that was not its client.
    pub(crate) by: Option<&'a str>,
}

/// A change of a job or a study.
pub(super) struct Event<'a> {
    kind: EventKind,
    subject: Uuid,
    status: Status,
    by: Option<&'a str>,
}

impl<'a> Event<'a> {
    /// Of a job; only an administrator's deletion is told.
    pub(super) fn of_job(kind: EventKind, job: &'a Job) -> Self {
        Self {
            kind,
            subject: job.id,
            status: job.status,
            by: kind.by().or(job.dismissed_by.as_deref()),
        }
    }

    /// The same of a study.
    pub(super) fn of_study(kind: EventKind, study: &'a StudyRecord) -> Self {
        Self {
            kind,
            subject: study.id,
            status: study.status(),
            by: kind.by().or(study.dismissed_by.as_deref()),
        }
    }
}

/// The body of a message: small, because who wants more asks for it.
#[derive(Serialize)]
struct Body<'a> {
    #[serde(rename = "type")]
    kind: &'static str,
    timestamp: Timestamp,
    data: BodyData<'a>,
}

#[derive(Serialize)]
struct BodyData<'a> {
    id: Uuid,
    #[serde(skip_serializing_if = "Option::is_none")]
    status: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    by: Option<&'a str>,
}

impl NewMessage<'_> {
    /// Puts it with those that wait. Gives back its id.
    pub(crate) async fn insert(
        &self,
        connection: &mut Connection,
        now: Timestamp,
    ) -> Result<Uuid, sqlx::Error> {
        let id = Uuid::now_v7();
        let body = Body {
            kind: self.kind,
            timestamp: now,
            data: BodyData {
                id: self.subject,
                status: self.status.map(Status::as_str),
                by: self.by,
            },
        };
        let insert = query(
            "insert into messages (id, webhook, kind, subject, body, next_at, created_at) values ($1, $2, $3, $4, $5, 0, $6)",
        )
        .bind(id.to_string())
        .bind(self.webhook)
        .bind(self.kind)
        .bind(self.subject.to_string())
        .bind(serde_json::to_string(&body).expect("a message is plain data"))
        .bind(now.as_microsecond());
        connection.later(insert).await?;
        Ok(id)
    }
}

/// Writes a message for each webhook of `client` that wants it.
pub(super) async fn tell(
    connection: &mut Connection,
    client: &str,
    event: Event<'_>,
    now: Timestamp,
) -> Result<(), sqlx::Error> {
    let webhooks: Vec<(String, String)> =
        query_as("select id, events from webhooks where client = $1 and disabled_at is null")
            .bind(client)
            .fetch_all(&mut *connection)
            .await?;
    let wanting = webhooks
        .iter()
        .filter(|(_, events)| EventKind::of_words(events).contains(&event.kind));
    for (webhook, _) in wanting {
        let message = NewMessage {
            webhook,
            kind: event.kind.word(),
            subject: event.subject,
            status: Some(event.status),
            by: event.by,
        };
        message.insert(connection, now).await?;
    }
    Ok(())
}

impl Store {
    /// Removes the messages that were written before, whether they have arrived or nobody has taken them.
    pub async fn forget_messages(&self, before: Timestamp) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query("delete from messages where created_at < $1")
            .bind(before.as_microsecond())
            .execute(&mut *write)
            .await?;
        write.commit().await
    }
}
