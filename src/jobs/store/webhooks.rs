//! Webhooks as they are kept, and the messages that wait for delivery. A message is written in the transaction of the
//! change that it tells, so that none is lost and none tells what did not happen.

use jiff::{SignedDuration, Timestamp};
use serde::{Deserialize, Serialize};
use sqlx::Row;
use utoipa::ToSchema;
use uuid::Uuid;

use super::rows::{from_row, instant, json, optional_instant, small, uuid};
use super::statement::{Connection, query, query_as, query_scalar};
use super::{Store, StoreError, dialect, micros};
use crate::wire::Status;

/// Where several processes deliver, one that has taken a message has it for so long: more than an attempt takes.
const TAKEN_FOR: SignedDuration = SignedDuration::from_secs(30);

/// What can be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum EventKind {
    /// A job that stands alone has ended.
    #[serde(rename = "job.ended")]
    JobEnded,
    /// A study has ended.
    #[serde(rename = "study.ended")]
    StudyEnded,
}

impl EventKind {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::JobEnded, Self::StudyEnded];

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::JobEnded => "job.ended",
            Self::StudyEnded => "study.ended",
        }
    }
}

/// Where a client is told, and of what.
#[derive(Debug, Clone, PartialEq)]
pub struct Webhook {
    /// Its id on the wire.
    pub id: Uuid,
    /// Where messages are sent.
    pub url: String,
    /// What is told.
    pub events: Vec<EventKind>,
    /// When it was made.
    pub created_at: Timestamp,
    /// When it was given up because nobody took the messages.
    pub disabled_at: Option<Timestamp>,
    /// Why the last message was not taken.
    pub problem: Option<String>,
}

from_row! {
    Webhook, |row| {
        Ok(Self {
            id: uuid(row, "id")?,
            url: row.try_get("url")?,
            events: json("events", &row.try_get::<String, _>("events")?)?,
            created_at: instant(row, "created_at")?,
            disabled_at: optional_instant(row, "disabled_at")?,
            problem: row.try_get("problem")?,
        })
    }
}

/// A webhook to be kept.
#[derive(Debug, Clone)]
pub(in crate::jobs) struct NewWebhook {
    pub(in crate::jobs) webhook: Webhook,
    pub(in crate::jobs) client: String,
    /// The key of the signatures, base64.
    pub(in crate::jobs) secret: String,
    /// So many may a client have.
    pub(in crate::jobs) most: i64,
}

/// A message on its way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::jobs) struct Delivery {
    pub(in crate::jobs) message: Uuid,
    pub(in crate::jobs) webhook: Uuid,
    pub(in crate::jobs) url: String,
    pub(in crate::jobs) secret: String,
    pub(in crate::jobs) body: String,
    /// Attempts so far, without this one.
    pub(in crate::jobs) attempts: u32,
}

from_row! {
    Delivery, |row| {
        Ok(Self {
            message: uuid(row, "message")?,
            webhook: uuid(row, "webhook")?,
            url: row.try_get("url")?,
            secret: row.try_get("secret")?,
            body: row.try_get("body")?,
            attempts: small(row, "attempts")?.unwrap_or(0),
        })
    }
}

/// The body of a message: small, because who wants more asks for it.
#[derive(Serialize)]
struct Message<'a> {
    #[serde(rename = "type")]
    kind: EventKind,
    timestamp: Timestamp,
    data: MessageData<'a>,
}

#[derive(Serialize)]
struct MessageData<'a> {
    id: Uuid,
    status: &'a str,
}

/// Writes a message for each webhook of `client` that wants to be told.
pub(super) async fn queue_messages(
    connection: &mut Connection,
    client: &str,
    kind: EventKind,
    id: Uuid,
    status: Status,
    now: Timestamp,
) -> Result<(), sqlx::Error> {
    let webhooks: Vec<Webhook> =
        query_as("select * from webhooks where client = $1 and disabled_at is null")
            .bind(client)
            .fetch_all(&mut *connection)
            .await?;
    for webhook in webhooks
        .iter()
        .filter(|webhook| webhook.events.contains(&kind))
    {
        let data = MessageData {
            id,
            status: status.as_str(),
        };
        let message = Message {
            kind,
            timestamp: now,
            data,
        };
        query(
            "insert into messages (id, webhook, body, next_at, created_at) values ($1, $2, $3, 0, $4)",
        )
        .bind(Uuid::now_v7().to_string())
        .bind(webhook.id.to_string())
        .bind(serde_json::to_string(&message).expect("a message is plain data"))
        .bind(now.as_microsecond())
        .execute(&mut *connection)
        .await?;
    }
    Ok(())
}

impl Store {
    /// Keeps a webhook. False if the client has as many as it may.
    pub(in crate::jobs) async fn add_webhook(&self, new: &NewWebhook) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        query(dialect::lock_webhooks()).execute(&mut *write).await?;
        let count: i64 = query_scalar("select count(*) from webhooks where client = $1")
            .bind(&new.client)
            .fetch_one(&mut *write)
            .await?;
        if count >= new.most {
            write.rollback().await?;
            return Ok(false);
        }
        let events = serde_json::to_string(&new.webhook.events).expect("words are JSON");
        query(
            "insert into webhooks (id, client, url, events, secret, created_at) values ($1, $2, $3, $4, $5, $6)",
        )
        .bind(new.webhook.id.to_string())
        .bind(&new.client)
        .bind(&new.webhook.url)
        .bind(events)
        .bind(&new.secret)
        .bind(new.webhook.created_at.as_microsecond())
        .execute(&mut *write)
        .await?;
        write.commit().await?;
        Ok(true)
    }

    /// The webhooks of a client, the oldest first.
    pub(in crate::jobs) async fn list_webhooks(
        &self,
        client: &str,
    ) -> Result<Vec<Webhook>, StoreError> {
        let webhooks = query_as("select * from webhooks where client = $1 order by created_at, id")
            .bind(client)
            .fetch_all(&self.readers)
            .await?;
        Ok(webhooks)
    }

    /// Removes a webhook and its messages. False if the client has no such webhook.
    pub(in crate::jobs) async fn delete_webhook(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let deleted = query("delete from webhooks where id = $1 and client = $2")
            .bind(id.to_string())
            .bind(client)
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        Ok(deleted == 1)
    }

    /// Messages that are due, the oldest first.
    pub(in crate::jobs) async fn due_messages(
        &self,
        steady: Timestamp,
        limit: u32,
    ) -> Result<Vec<Delivery>, StoreError> {
        let due = query_as(dialect::due_messages())
            .bind(steady.as_microsecond())
            .bind(limit)
            .bind(micros(TAKEN_FOR))
            .fetch_all(&self.readers)
            .await?;
        Ok(due)
    }

    /// When the next message is due, by the steady clock; `None` if none waits.
    pub(in crate::jobs) async fn next_message(&self) -> Result<Option<Timestamp>, StoreError> {
        let next: Option<i64> = query_scalar("select min(next_at) from messages")
            .fetch_one(&self.readers)
            .await?;
        Ok(next.and_then(|at| Timestamp::from_microsecond(at).ok()))
    }

    /// A message has arrived.
    pub(in crate::jobs) async fn message_arrived(&self, message: Uuid) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query("delete from messages where id = $1")
            .bind(message.to_string())
            .execute(&mut *write)
            .await?;
        write.commit().await
    }

    /// A message was not taken, and is tried again at `next_at`; without that the webhook is given up, with all its
    /// messages.
    pub(in crate::jobs) async fn message_refused(
        &self,
        delivery: &Delivery,
        problem: &str,
        next_at: Option<Timestamp>,
        now: Timestamp,
    ) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        let webhook = delivery.webhook.to_string();
        query("update webhooks set problem = $2, disabled_at = coalesce(disabled_at, $3) where id = $1")
            .bind(&webhook)
            .bind(problem)
            .bind(next_at.is_none().then(|| now.as_microsecond()))
            .execute(&mut *write)
            .await?;
        match next_at {
            Some(next_at) => {
                query("update messages set attempts = attempts + 1, next_at = $2 where id = $1")
                    .bind(delivery.message.to_string())
                    .bind(next_at.as_microsecond())
                    .execute(&mut *write)
                    .await?;
            }
            None => {
                query("delete from messages where webhook = $1")
                    .bind(&webhook)
                    .execute(&mut *write)
                    .await?;
            }
        }
        write.commit().await
    }
}
