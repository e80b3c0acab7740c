//! Webhooks as handlers see them: make, look, try out, take up again, rotate, delete. Where they may lead is decided here and again at
//! each delivery.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use meshwright_store::webhooks::{Delivery, NewWebhook, Outcome, Webhook};
use meshwright_wire::hash::sha256_hex_of;
use uuid::Uuid;

use super::addresses::HookRules;
use crate::jobs::{EventKind, JobError, Jobs, KEY_LIFETIME, StoreError};

/// Maximum number of webhooks of a client.
const MOST: i64 = 16;

/// Bytes of the key of the signatures; Standard Webhooks asks for 24 to 64.
const SECRET_BYTES: usize = 32;

/// Maximum number of webhooks of a client.
pub fn most_webhooks() -> i64 {
    MOST
}

/// Why something cannot be done with a webhook.
#[derive(Debug, Clone, thiserror::Error)]
pub enum WebhookError {
    /// The client has no such webhook.
    #[error("there is no webhook {0}")]
    NotFound(Uuid),
    /// The client has as many webhooks as it may.
    #[error("a client has {0} webhooks at most")]
    TooMany(i64),
    /// Webhooks are not served here, or not to this address.
    #[error("{0}")]
    Refused(String),
    /// The webhook is disabled and gets no messages.
    #[error("the webhook was given up")]
    Disabled,
    /// Errors of jobs.
    #[error(transparent)]
    Job(#[from] JobError),
}

impl From<StoreError> for WebhookError {
    fn from(error: StoreError) -> Self {
        Self::Job(error.into())
    }
}

/// A webhook that was made. The secret is shown this once, and to who repeats the request.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The webhook.
    pub webhook: Webhook,
    /// Key of the signatures of its messages: `whsec_` and base64.
    pub secret: String,
    /// True if an earlier request with the same key made it.
    pub repeated: bool,
}

/// The webhooks of all clients.
#[derive(Clone)]
pub struct Webhooks {
    pub(super) jobs: Jobs,
    pub(super) rules: HookRules,
}

impl Webhooks {
    /// Webhooks that report the ends of `jobs`, by these rules.
    pub fn new(jobs: Jobs, rules: HookRules) -> Self {
        Self { jobs, rules }
    }

    /// Makes a webhook.
    ///
    /// # Errors
    ///
    /// [`WebhookError::Refused`], [`WebhookError::TooMany`], [`JobError::KeyConflict`], [`JobError::Unavailable`],
    /// [`JobError::Database`].
    pub async fn make(
        &self,
        client: &str,
        url: String,
        events: Vec<EventKind>,
        idempotency_key: Option<String>,
    ) -> Result<Made, WebhookError> {
        self.jobs.refuse_if_failing()?;
        self.rules.check(&url).map_err(WebhookError::Refused)?;
        let words: Vec<&str> = events.iter().map(|kind| kind.word()).collect();
        let body_hash = sha256_hex_of(&[&url, &words.join(" ")]);
        let new = NewWebhook {
            webhook: Webhook::new(url, events, self.jobs.clock().now()),
            client: client.to_owned(),
            secret: new_secret()?,
            idempotency_key,
            body_hash,
            most: MOST,
        };
        let steady = self.jobs.clock().steady();
        let (webhook, secret, repeated) = match self
            .jobs
            .store()
            .add_webhook(&new, steady, KEY_LIFETIME)
            .await?
        {
            Outcome::Made => (new.webhook, new.secret, false),
            Outcome::Repeated(webhook, secret) => (webhook, secret, true),
            Outcome::KeyConflict => return Err(JobError::KeyConflict.into()),
            Outcome::TooMany => return Err(WebhookError::TooMany(MOST)),
        };
        Ok(Made {
            webhook,
            secret: shown(&secret),
            repeated,
        })
    }

    /// The webhooks of a client, the oldest first.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn list(&self, client: &str) -> Result<Vec<Webhook>, WebhookError> {
        Ok(self.jobs.store().webhooks(client, None).await?)
    }

    /// A webhook of a client.
    ///
    /// # Errors
    ///
    /// [`WebhookError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn find(&self, client: &str, id: Uuid) -> Result<Webhook, WebhookError> {
        let found = self.jobs.store().webhooks(client, Some(id)).await?;
        found.into_iter().next().ok_or(WebhookError::NotFound(id))
    }

    /// Removes a webhook and its messages.
    ///
    /// # Errors
    ///
    /// [`WebhookError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn delete(&self, client: &str, id: Uuid) -> Result<(), WebhookError> {
        if self.jobs.store().remove_webhook(client, id).await? {
            Ok(())
        } else {
            Err(WebhookError::NotFound(id))
        }
    }

    /// Has a message without meaning sent to a webhook, at once, whatever its patience says. One that waits already will do.
    ///
    /// # Errors
    ///
    /// [`WebhookError::Disabled`], [`WebhookError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn ping(&self, client: &str, id: Uuid) -> Result<Delivery, WebhookError> {
        let webhook = self.find(client, id).await?;
        if webhook.disabled_at.is_some() {
            return Err(WebhookError::Disabled);
        }
        let message = self
            .jobs
            .store()
            .ping_webhook(id, self.jobs.clock().now())
            .await?;
        self.jobs.mail().notify_one();
        let deliveries = self.jobs.store().deliveries(id, Some(message)).await?;
        let delivery = deliveries.into_iter().next();
        delivery.ok_or(WebhookError::NotFound(id))
    }

    /// The latest messages to a webhook, the newest first, with their outcomes.
    ///
    /// # Errors
    ///
    /// [`WebhookError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn deliveries(&self, client: &str, id: Uuid) -> Result<Vec<Delivery>, WebhookError> {
        self.find(client, id).await?;
        Ok(self.jobs.store().deliveries(id, None).await?)
    }

    /// Enables a webhook that was disabled, or that waits for a retry: waiting messages are sent at once.
    ///
    /// # Errors
    ///
    /// [`WebhookError::Refused`] if the operator no longer allows its address, [`WebhookError::NotFound`], [`JobError::Unavailable`],
    /// [`JobError::Database`].
    pub async fn enable(&self, client: &str, id: Uuid) -> Result<Webhook, WebhookError> {
        let webhook = self.find(client, id).await?;
        self.rules
            .check(&webhook.url)
            .map_err(WebhookError::Refused)?;
        self.jobs.store().enable_webhook(id).await?;
        self.jobs.mail().notify_one();
        self.find(client, id).await
    }

    /// Gives a webhook another secret. For a day messages are signed with the one before, too.
    ///
    /// # Errors
    ///
    /// [`WebhookError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn rotate(&self, client: &str, id: Uuid) -> Result<Made, WebhookError> {
        let webhook = self.find(client, id).await?;
        let secret = new_secret()?;
        let steady = self.jobs.clock().steady();
        self.jobs.store().rotate_secret(id, &secret, steady).await?;
        Ok(Made {
            webhook,
            secret: shown(&secret),
            repeated: false,
        })
    }
}

fn new_secret() -> Result<String, WebhookError> {
    let mut secret = [0; SECRET_BYTES];
    getrandom::fill(&mut secret).map_err(|error| WebhookError::Refused(error.to_string()))?;
    Ok(BASE64.encode(secret))
}

/// A secret as it is shown.
fn shown(secret: &str) -> String {
    format!("whsec_{secret}")
}
