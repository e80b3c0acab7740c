//! Webhooks and the messages to them. Everything that is to happen later goes by the clock that all processes on the store share, so that
//! processes whose clocks differ agree on it; each says its steady clock, which is that clock where there is one process.

use jiff::{SignedDuration, Timestamp};
use uuid::Uuid;

use super::outbox::NewMessage;
use super::rows::{Record, Row, instant, optional_instant, optional_uuid, small, uuid};
use super::statement::{Nothing, Statement, query, query_as, query_scalar};
use super::{EventKind, Store, StoreError, dialect, micros};

/// The kind of a message that reports nothing.
const PING: &str = "webhook.ping";

/// Who has taken a message has it for so long: more than an attempt takes.
const TAKEN_FOR: SignedDuration = SignedDuration::from_secs(30);

/// Time for which messages are also signed with the secret before the last rotation.
const BOTH_SECRETS_FOR: SignedDuration = SignedDuration::from_hours(24);

/// Number of messages in the list of deliveries.
const LISTED: u32 = 100;

/// After so many seconds a webhook is tried again; when it has failed once more it is given up. A day and a half in all.
const PATIENCE_S: [i64; 9] = [
    5,
    30,
    120,
    600,
    3600,
    3 * 3600,
    6 * 3600,
    12 * 3600,
    12 * 3600,
];

/// A client's address for messages, and their kinds.
#[derive(Debug, Clone, PartialEq)]
pub struct Webhook {
    /// Its id on the wire.
    pub id: Uuid,
    /// Where messages are sent.
    pub url: String,
    /// Kinds of events that are reported.
    pub events: Vec<EventKind>,
    /// When it was made.
    pub created_at: Timestamp,
    /// When it was given up because nobody took the messages.
    pub disabled_at: Option<Timestamp>,
    /// Attempts that have failed since the last one that did not.
    pub failures: u32,
    /// Until then nothing is sent to it, because an attempt has failed.
    pub retry_at: Option<Timestamp>,
    /// Why the last message was not taken.
    pub problem: Option<String>,
}

impl Webhook {
    /// A new webhook, which has not failed yet.
    pub fn new(url: String, events: Vec<EventKind>, created_at: Timestamp) -> Self {
        Self {
            id: Uuid::now_v7(),
            url,
            events,
            created_at,
            disabled_at: None,
            failures: 0,
            retry_at: None,
            problem: None,
        }
    }
}

macro_rules! select_webhooks {
    ($which:literal) => {
        concat!(
            "select id, url, events, created_at, disabled_at, failures, retry_at, problem, secret from webhooks where ",
            $which
        )
    };
}

impl Record for Webhook {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        let failures = small(row, "failures")?.unwrap_or(0);
        Ok(Self {
            id: uuid(row, "id")?,
            url: row.get("url")?,
            events: EventKind::of_words(&row.get::<String>("events")?),
            created_at: instant(row, "created_at")?,
            disabled_at: optional_instant(row, "disabled_at")?,
            failures,
            retry_at: optional_instant(row, "retry_at")?.filter(|_| failures > 0),
            problem: row.get("problem")?,
        })
    }
}

/// A webhook with its secret.
struct Whole(Webhook, String);

impl Record for Whole {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self(Record::read(row)?, row.get("secret")?))
    }
}

/// A webhook to be kept.
pub struct NewWebhook {
    /// The webhook.
    pub webhook: Webhook,
    /// Whose it is.
    pub client: String,
    /// The key of the signatures, base64.
    pub secret: String,
    /// The word under which the client may ask again and get this webhook.
    pub idempotency_key: Option<String>,
    /// Hash of the request.
    pub body_hash: String,
    /// Maximum number of webhooks of a client.
    pub most: i64,
}

/// Outcome of making a webhook.
pub enum Outcome {
    /// The webhook is stored.
    Made,
    /// The same was asked for before under this key: that webhook, and its secret.
    Repeated(Webhook, String),
    /// The key was used for another one.
    KeyConflict,
    /// The client has as many as it may.
    TooMany,
}

/// A message to a webhook, and its state.
#[derive(Debug, Clone, PartialEq)]
pub struct Delivery {
    /// Its id, the same at every attempt.
    pub id: Uuid,
    /// Kind of event, in a word.
    pub kind: String,
    /// Whose end it reports: a job or a study; or the webhook itself.
    pub subject: Option<Uuid>,
    /// Time of the event.
    pub created_at: Timestamp,
    /// Attempts so far.
    pub attempts: u32,
    /// When it was last sent.
    pub attempted_at: Option<Timestamp>,
    /// When it arrived; `None` while it waits.
    pub arrived_at: Option<Timestamp>,
    /// The receiver's last HTTP status.
    pub answered: Option<u32>,
    /// Why it was not taken.
    pub problem: Option<String>,
}

impl Record for Delivery {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid(row, "id")?,
            kind: row.get("kind")?,
            subject: optional_uuid(row, "subject")?,
            created_at: instant(row, "created_at")?,
            attempts: small(row, "attempts")?.unwrap_or(0),
            attempted_at: optional_instant(row, "attempted_at")?,
            arrived_at: optional_instant(row, "arrived_at")?,
            answered: small(row, "answered")?,
            problem: row.get("problem")?,
        })
    }
}

/// A webhook for which something waits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Waiting {
    /// The webhook.
    pub webhook: Uuid,
    /// Whose it is.
    pub client: String,
    /// True if the last attempt has failed.
    pub is_failing: bool,
    /// How long it is not to be tried yet.
    pub patience: SignedDuration,
}

/// A message to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Its id, the same at every attempt.
    pub id: Uuid,
    /// The webhook.
    pub webhook: Uuid,
    /// Where it is sent.
    pub url: String,
    /// Keys of its signatures: the secret, and for a day the one before.
    pub secrets: Vec<String>,
    /// Its body, JSON.
    pub body: String,
    /// When it was taken, by the store's clock.
    taken_at: i64,
}

/// Outcome of an attempt.
pub struct Attempt {
    /// The HTTP status, if there was an answer.
    pub answered: Option<u16>,
    /// Why the message was not taken, if it was not.
    pub refusal: Option<Refusal>,
}

/// Why a message was not taken.
pub enum Refusal {
    /// The message may arrive the next time.
    Again(String),
    /// The message will not arrive.
    Never(String),
}

impl Store {
    /// Now, by the clock that all processes on the store share.
    async fn shared_now(&self, steady: Timestamp) -> Result<i64, StoreError> {
        let now = query_scalar(dialect::steady_now()).bind(steady.as_microsecond());
        Ok(now.fetch_one(&self.readers).await?)
    }

    /// Carries out a statement by itself. Gives back how many rows it was about.
    async fn write(&self, statement: Statement<Nothing>) -> Result<u64, StoreError> {
        let mut write = self.begin().await?;
        let changed = statement.execute(&mut *write).await?;
        write.commit().await?;
        Ok(changed)
    }

    /// Keeps a new webhook. Keys under which webhooks were made are forgotten after `keys_last`.
    pub async fn add_webhook(
        &self,
        new: &NewWebhook,
        steady: Timestamp,
        keys_last: SignedDuration,
    ) -> Result<Outcome, StoreError> {
        let now = self.shared_now(steady).await?;
        let mut write = self.begin().await?;
        query(dialect::lock_webhooks()).execute(&mut *write).await?;
        query("update webhooks set idempotency_key = null where client = $1 and keyed_at < $2")
            .bind(&new.client)
            .bind(now.saturating_sub(micros(keys_last)))
            .execute(&mut *write)
            .await?;
        if let Some(key) = &new.idempotency_key {
            let earlier: Option<(String, String)> = query_as(
                "select id, coalesce(body_hash, '') from webhooks where client = $1 and idempotency_key = $2",
            )
            .bind(&new.client)
            .bind(key)
            .fetch_optional(&mut *write)
            .await?;
            if let Some((id, body_hash)) = earlier {
                let found: Option<Whole> = query_as(select_webhooks!("id = $1"))
                    .bind(id)
                    .fetch_optional(&mut *write)
                    .await?;
                write.rollback().await?;
                return Ok(match found {
                    Some(Whole(webhook, secret)) if body_hash == new.body_hash => {
                        Outcome::Repeated(webhook, secret)
                    }
                    _ => Outcome::KeyConflict,
                });
            }
        }
        let count: i64 = query_scalar("select count(*) from webhooks where client = $1")
            .bind(&new.client)
            .fetch_one(&mut *write)
            .await?;
        if count >= new.most {
            write.rollback().await?;
            return Ok(Outcome::TooMany);
        }
        let events: Vec<&str> = new.webhook.events.iter().map(|kind| kind.word()).collect();
        query(
            "insert into webhooks (id, client, url, events, secret, created_at, idempotency_key, body_hash, keyed_at)
             values ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        )
        .bind(new.webhook.id.to_string())
        .bind(&new.client)
        .bind(&new.webhook.url)
        .bind(serde_json::to_string(&events).expect("words are JSON"))
        .bind(&new.secret)
        .bind(new.webhook.created_at.as_microsecond())
        .bind(&new.idempotency_key)
        .bind(&new.body_hash)
        .bind(now)
        .execute(&mut *write)
        .await?;
        write.commit().await?;
        Ok(Outcome::Made)
    }

    /// The webhooks of a client, the oldest first, or the one of this id.
    pub async fn webhooks(
        &self,
        client: &str,
        id: Option<Uuid>,
    ) -> Result<Vec<Webhook>, StoreError> {
        let webhooks = query_as(select_webhooks!(
            "client = $1 and id = coalesce($2, id) order by created_at, id"
        ))
        .bind(client)
        .bind(id.map(|id| id.to_string()))
        .fetch_all(&self.readers)
        .await?;
        Ok(webhooks)
    }

    /// Removes a webhook and its messages. False if the client has no such webhook.
    pub async fn remove_webhook(&self, client: &str, id: Uuid) -> Result<bool, StoreError> {
        let deleted = query("delete from webhooks where id = $1 and client = $2")
            .bind(id.to_string())
            .bind(client);
        Ok(self.write(deleted).await? == 1)
    }

    /// The latest messages to a webhook, the newest first, or the one of this id.
    pub async fn deliveries(
        &self,
        webhook: Uuid,
        id: Option<Uuid>,
    ) -> Result<Vec<Delivery>, StoreError> {
        let deliveries = query_as(
            "select id, kind, subject, created_at, attempts, attempted_at, arrived_at, answered, problem from messages
             where webhook = $1 and id = coalesce($2, id) order by id desc limit $3",
        )
        .bind(webhook.to_string())
        .bind(id.map(|id| id.to_string()))
        .bind(LISTED)
        .fetch_all(&self.readers)
        .await?;
        Ok(deliveries)
    }

    /// Writes a ping, unless one waits, and has the webhook tried at once. Gives back the id of the message.
    pub async fn ping_webhook(&self, webhook: Uuid, now: Timestamp) -> Result<Uuid, StoreError> {
        let id = webhook.to_string();
        let mut write = self.begin().await?;
        // Whoever pings beside us waits here.
        query("update webhooks set retry_at = 0 where id = $1")
            .bind(&id)
            .execute(&mut *write)
            .await?;
        let waiting: Option<String> = query_scalar(
            "select id from messages where webhook = $1 and arrived_at is null and kind = 'webhook.ping' limit 1",
        )
        .bind(&id)
        .fetch_optional(&mut *write)
        .await?;
        let message = match waiting.and_then(|id| id.parse().ok()) {
            Some(message) => message,
            None => {
                let ping = NewMessage {
                    webhook: &id,
                    kind: PING,
                    subject: webhook,
                    status: None,
                    by: None,
                };
                ping.insert(&mut write, now).await?
            }
        };
        write.commit().await?;
        Ok(message)
    }

    /// Takes up a webhook again, whatever has failed before.
    pub async fn enable_webhook(&self, webhook: Uuid) -> Result<(), StoreError> {
        let enabled = query(
            "update webhooks set disabled_at = null, failures = 0, retry_at = 0, problem = null where id = $1",
        );
        self.write(enabled.bind(webhook.to_string())).await?;
        Ok(())
    }

    /// Gives a webhook another secret. For a day messages are signed with the one before, too.
    pub async fn rotate_secret(
        &self,
        webhook: Uuid,
        secret: &str,
        steady: Timestamp,
    ) -> Result<(), StoreError> {
        let until = self
            .shared_now(steady)
            .await?
            .saturating_add(micros(BOTH_SECRETS_FOR));
        let rotated = query("update webhooks set previous_secret = secret, previous_until = $3, secret = $2 where id = $1")
            .bind(webhook.to_string())
            .bind(secret)
            .bind(until);
        self.write(rotated).await?;
        Ok(())
    }

    /// The webhooks for which something waits.
    pub async fn waiting_webhooks(&self, steady: Timestamp) -> Result<Vec<Waiting>, StoreError> {
        let now = self.shared_now(steady).await?;
        let found: Vec<(String, String, i64, i64)> = query_as(
            "select w.id, w.client, w.failures, w.retry_at from webhooks w
             where w.disabled_at is null
               and exists (select 1 from messages m where m.webhook = w.id and m.arrived_at is null)",
        )
        .fetch_all(&self.readers)
        .await?;
        let waiting = |(id, client, failures, retry_at): (String, String, i64, i64)| {
            Some(Waiting {
                webhook: id.parse().ok()?,
                client,
                is_failing: failures > 0,
                patience: SignedDuration::from_micros(retry_at.saturating_sub(now).max(0)),
            })
        };
        Ok(found.into_iter().filter_map(waiting).collect())
    }

    /// Takes at most so many messages to a webhook, the oldest first, and a ping before them. Nobody else takes them for a while.
    pub async fn take_messages(
        &self,
        webhook: Uuid,
        most: usize,
        steady: Timestamp,
    ) -> Result<Vec<Message>, StoreError> {
        let now = self.shared_now(steady).await?;
        let id = webhook.to_string();
        let mut write = self.begin().await?;
        let mut taken: Vec<(String, String)> = Vec::new();
        for statement in [dialect::take_pings(), dialect::take_messages()] {
            let left = u32::try_from(most.saturating_sub(taken.len())).unwrap_or(u32::MAX);
            let mut messages: Vec<(String, String)> = query_as(statement)
                .bind(&id)
                .bind(now)
                .bind(now.saturating_add(micros(TAKEN_FOR)))
                .bind(left)
                .fetch_all(&mut *write)
                .await?;
            // The returned rows have no order.
            messages.sort();
            taken.extend(messages);
        }
        if taken.is_empty() {
            write.rollback().await?;
            return Ok(Vec::new());
        }
        let hook: Option<(String, String, Option<String>, i64)> = query_as(
            "select url, secret, previous_secret, previous_until from webhooks where id = $1",
        )
        .bind(&id)
        .fetch_optional(&mut *write)
        .await?;
        write.commit().await?;
        let Some((url, secret, previous, previous_until)) = hook else {
            return Ok(Vec::new());
        };
        let mut secrets = vec![secret];
        secrets.extend(previous.filter(|_| now < previous_until));
        let message = |(id, body): (String, String)| {
            Some(Message {
                id: id.parse().ok()?,
                webhook,
                url: url.clone(),
                secrets: secrets.clone(),
                body,
                taken_at: now,
            })
        };
        Ok(taken.into_iter().filter_map(message).collect())
    }

    /// Releases messages that another process had taken, where there is no other one: it was this one, before its start.
    pub async fn give_back_messages(&self) -> Result<(), StoreError> {
        if self.is_shared() {
            return Ok(());
        }
        self.write(query(
            "update messages set next_at = 0 where arrived_at is null and next_at > 0",
        ))
        .await?;
        Ok(())
    }

    /// Writes the outcome of an attempt. True if the webhook is disabled with it.
    pub async fn attempted(
        &self,
        message: &Message,
        attempt: &Attempt,
        steady: Timestamp,
        now: Timestamp,
    ) -> Result<bool, StoreError> {
        let at = now.as_microsecond();
        let now = self.shared_now(steady).await?;
        let problem = attempt.refusal.as_ref().map(|refusal| match refusal {
            Refusal::Again(why) | Refusal::Never(why) => why,
        });
        let mut write = self.begin().await?;
        query(
            "update messages set attempts = attempts + 1, attempted_at = $2, answered = $3, problem = $4, arrived_at = $5, next_at = 0
             where id = $1",
        )
        .bind(message.id.to_string())
        .bind(at)
        .bind(attempt.answered.map(u32::from))
        .bind(problem.cloned())
        .bind(attempt.refusal.is_none().then_some(at))
        .execute(&mut *write)
        .await?;
        let Some(refusal) = &attempt.refusal else {
            query("update webhooks set failures = 0, retry_at = 0 where id = $1 and failures > 0")
                .bind(message.webhook.to_string())
                .execute(&mut *write)
                .await?;
            write.commit().await?;
            return Ok(false);
        };
        let before: Option<(i64, i64)> =
            query_as("update webhooks set problem = $2 where id = $1 returning failures, retry_at")
                .bind(message.webhook.to_string())
                .bind(problem.cloned())
                .fetch_optional(&mut *write)
                .await?;
        let next = before.map(|(failures, retry_at)| {
            // Several that were under way together fail once.
            let counts = retry_at <= message.taken_at;
            Patience::after(failures, counts, now, refusal).unwrap_or(Patience {
                failures,
                retry_at: Some(retry_at),
            })
        });
        let gives_up = next.is_some_and(|next| next.retry_at.is_none());
        if let Some(Patience { failures, retry_at }) = next {
            query(
                "update webhooks set failures = $2, retry_at = $3, disabled_at = coalesce(disabled_at, $4) where id = $1",
            )
            .bind(message.webhook.to_string())
            .bind(failures)
            .bind(retry_at.unwrap_or(0))
            .bind(retry_at.is_none().then_some(at))
            .execute(&mut *write)
            .await?;
        }
        write.commit().await?;
        Ok(gives_up)
    }
}

/// How a webhook stands after a failure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Patience {
    failures: i64,
    /// By the store's clock; `None`: it is given up.
    retry_at: Option<i64>,
}

impl Patience {
    /// After so many failures before this one; none if it changes nothing.
    fn after(failures: i64, counts: bool, now: i64, refusal: &Refusal) -> Option<Self> {
        if matches!(refusal, Refusal::Never(_)) {
            return Some(Self {
                failures: failures + 1,
                retry_at: None,
            });
        }
        if !counts {
            return None;
        }
        let seconds = usize::try_from(failures)
            .ok()
            .and_then(|failures| PATIENCE_S.get(failures));
        Some(Self {
            failures: failures + 1,
            retry_at: seconds.map(|seconds| now.saturating_add(seconds * 1_000_000)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patience_grows_and_ends_after_a_day_and_a_half() {
        let again = Refusal::Again("it answered 500".to_owned());
        let waits: Vec<i64> = (0..)
            .map_while(|failures| Patience::after(failures, true, 0, &again)?.retry_at)
            .map(|at| at / 1_000_000)
            .collect();
        assert_eq!(waits, PATIENCE_S);
        assert!(waits.is_sorted());
        assert!((33 * 3600..37 * 3600).contains(&waits.iter().sum::<i64>()));
        assert_eq!(Patience::after(3, false, 0, &again), None);
        let never = Refusal::Never("it answered 410".to_owned());
        let never = Patience::after(0, false, 0, &never);
        assert_eq!(never.unwrap().retry_at, None);
    }
}
