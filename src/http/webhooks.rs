//! Webhooks: where a client is told that a job or study has ended.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use meshwright_store::webhooks::{Delivery, Webhook};
use meshwright_wire::declare::document;
use meshwright_wire::{Code, FieldError, Problem};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

use super::body::JsonBody;
use super::client::Client;
use super::parameters::{IdempotencyKey, WebhookId};
use super::problem::Refusal;
use crate::jobs::EventKind as Kind;
use crate::webhooks::WebhookError;

/// Kinds of events.
#[derive(Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
enum EventKind {
    /// A job that stands alone has ended.
    #[serde(rename = "job.ended")]
    JobEnded,
    /// A study has ended.
    #[serde(rename = "study.ended")]
    StudyEnded,
    /// An administrator of the service has deleted a job.
    #[serde(rename = "job.deleted")]
    JobDeleted,
    /// An administrator of the service has deleted a study.
    #[serde(rename = "study.deleted")]
    StudyDeleted,
}

impl From<Kind> for EventKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::JobEnded => Self::JobEnded,
            Kind::StudyEnded => Self::StudyEnded,
            Kind::JobDeleted => Self::JobDeleted,
            Kind::StudyDeleted => Self::StudyDeleted,
        }
    }
}

impl From<EventKind> for Kind {
    fn from(kind: EventKind) -> Self {
        match kind {
            EventKind::JobEnded => Self::JobEnded,
            EventKind::StudyEnded => Self::StudyEnded,
            EventKind::JobDeleted => Self::JobDeleted,
            EventKind::StudyDeleted => Self::StudyDeleted,
        }
    }
}

/// A webhook to be made.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = NewWebhook, title = "NewWebhook")]
pub(super) struct NewWebhookDocument {
    /// Where messages are sent: an address that the operator of the service allows.
    #[schema(format = "uri", example = "https://hooks.example.com/meshwright")]
    url: String,
    /// Kinds of events to send; all of them by default.
    #[serde(default = "all_events")]
    #[schema(min_items = 1, default = all_events)]
    events: Vec<EventKind>,
}

fn all_events() -> Vec<EventKind> {
    Kind::ALL.map(EventKind::from).to_vec()
}

document! {
    /// A webhook.
    pub(super) struct WebhookView as Webhook, "Webhook"
    view of (webhook: Webhook, secret: Option<String>) {
        /// The id of the webhook.
        id: Uuid = webhook.id,
        /// Where messages are sent.
        url: String = webhook.url,
        /// Kinds of events to send.
        events: Vec<EventKind> = webhook.events.into_iter().map(EventKind::from).collect(),
        /// When it was made (UTC).
        created_at: Timestamp = webhook.created_at,
        /// When it was given up because nobody took its messages (UTC), from when on nothing is sent to it; null while it works.
        disabled_at: Option<Timestamp> = webhook.disabled_at,
        /// Attempts that have failed since the last one that did not.
        failures: u32 = webhook.failures,
        /// When it is tried again (UTC), because the last attempt has failed; null while it works.
        retry_at: Option<Timestamp> = webhook.retry_at.filter(|_| webhook.disabled_at.is_none()),
        /// Why the last message that was not taken was not.
        problem: Option<String> = webhook.problem,
        /// Key of the signatures of messages: HMAC-SHA-256 as Standard Webhooks has it. Shown once, when the webhook is made or gets another one.
        secret?: String = secret,
    }
}

/// The webhooks of a client.
#[derive(Serialize, ToSchema)]
#[schema(as = WebhookList, title = "WebhookList")]
pub(super) struct WebhookListView {
    /// The webhooks, the oldest first.
    items: Vec<WebhookView>,
}

document! {
    /// A message to a webhook, and its state.
    pub(super) struct DeliveryView as Delivery, "Delivery" view of (delivery: Delivery) {
        /// The id of the message, which its header `webhook-id` bears at every attempt.
        id: Uuid = delivery.id,
        /// Type: `job.ended`, `study.ended`, `job.deleted`, `study.deleted`, or `webhook.ping`, which reports no event.
        #[serde(rename = "type")]
        kind: String = delivery.kind,
        /// Whose end it tells: the id of a job or a study; of a ping that of the webhook.
        subject: Option<Uuid> = delivery.subject,
        /// Where it stands.
        status: DeliveryStatus = match delivery.arrived_at {
            Some(_) => DeliveryStatus::Arrived,
            None => DeliveryStatus::Waiting,
        },
        /// Time of the event (UTC).
        created_at: Timestamp = delivery.created_at,
        /// Attempts so far.
        attempts: u32 = delivery.attempts,
        /// When it was last sent (UTC).
        attempted_at: Option<Timestamp> = delivery.attempted_at,
        /// The last HTTP status of the receiver; null if it gave no answer.
        answered: Option<u32> = delivery.answered,
        /// Why it was not taken.
        problem: Option<String> = delivery.problem,
    }
}

/// Where a message stands.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum DeliveryStatus {
    /// The message waits for its turn.
    Waiting,
    /// The receiver answered with 2xx.
    Arrived,
}

/// The latest messages to a webhook.
#[derive(Serialize, ToSchema)]
#[schema(as = DeliveryList, title = "DeliveryList")]
pub(super) struct DeliveryListView {
    /// The messages, the newest first.
    items: Vec<DeliveryView>,
}

/// Make a webhook
///
/// From now on a message is sent to the address when a job that stands alone, or a study, has ended: a POST with a small JSON body `{"type", "timestamp",
/// "data": {"id", "status"}}`, signed as Standard Webhooks has it (`webhook-id`, `webhook-timestamp`, `webhook-signature`). A message that is not answered with
/// 2xx is sent again, for a day and a half. Then the webhook is disabled, and waiting messages are kept for a week from their event. Several messages may be
/// sent at the same time, so their order may change. Off unless the operator of the service allows hosts to send to.
#[utoipa::path(
    post, path = "/v1/webhooks", tag = "Webhooks", operation_id = "make_webhook",
    request_body(content = NewWebhookDocument, content_type = "application/json", description = "The webhook."),
    params(IdempotencyKey),
    responses(
        (status = 200, description = "The webhook that an earlier request with this key has made, with its secret.", body = WebhookView),
        (status = 201, description = "The webhook, with its secret, which is told this once.", body = WebhookView),
        JsonBody,
        (status = 422, description = "Webhooks are off, the address is not one to send to, or the key was used for another webhook."),
    ),
)]
pub(super) async fn make(
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    document: JsonBody,
) -> Result<Response, Refusal> {
    let new: NewWebhookDocument = document.parse()?;
    let mut events: Vec<Kind> = Vec::new();
    for event in new.events.into_iter().map(Kind::from) {
        if !events.contains(&event) {
            events.push(event);
        }
    }
    if events.is_empty() {
        let words = Kind::ALL.map(Kind::word).join(", ");
        let detail = format!("/events is empty; give one or more of {words}, or leave it out.");
        let error = FieldError::new("/events", Code::OutOfRange, detail);
        return Err(Problem::of_fields(vec![error]).into());
    }
    let made = client
        .app
        .webhooks
        .make(client.name(), new.url, events, key)
        .await
        .map_err(|error| match error {
            WebhookError::Refused(why) => {
                let error = FieldError::new("/url", Code::WebhookRefused, why);
                Problem::of_fields(vec![error])
            }
            other => other.into(),
        })?;
    let status = if made.repeated {
        StatusCode::OK
    } else {
        StatusCode::CREATED
    };
    let view = WebhookView::of(made.webhook, Some(made.secret));
    Ok((status, Json(view)).into_response())
}

/// List webhooks
///
/// The webhooks of the client, the oldest first, without their secrets.
#[utoipa::path(
    get, path = "/v1/webhooks", tag = "Webhooks", operation_id = "list_webhooks",
    responses((status = 200, description = "The webhooks.", body = WebhookListView)),
)]
pub(super) async fn list(client: Client) -> Result<Json<WebhookListView>, Refusal> {
    let webhooks = client.app.webhooks.list(client.name()).await?.into_iter();
    Ok(Json(WebhookListView {
        items: webhooks
            .map(|webhook| WebhookView::of(webhook, None))
            .collect(),
    }))
}

/// Delete a webhook
///
/// No further message is sent, not even a waiting one.
#[utoipa::path(
    delete, path = "/v1/webhooks/{id}", tag = "Webhooks", operation_id = "delete_webhook",
    responses(
        (status = 204, description = "The webhook is gone."),
    ),
)]
pub(super) async fn delete(
    client: Client,
    WebhookId(id): WebhookId,
) -> Result<StatusCode, Refusal> {
    client.app.webhooks.delete(client.name(), id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Get a webhook
///
/// How it stands: whether messages arrive, and when it is tried again if not.
#[utoipa::path(
    get, path = "/v1/webhooks/{id}", tag = "Webhooks", operation_id = "get_webhook",
    responses(
        (status = 200, description = "The webhook, without its secret.", body = WebhookView),
    ),
)]
pub(super) async fn show(
    client: Client,
    WebhookId(id): WebhookId,
) -> Result<Json<WebhookView>, Refusal> {
    let webhook = client.app.webhooks.find(client.name(), id).await?;
    Ok(Json(WebhookView::of(webhook, None)))
}

/// Ping a webhook
///
/// A message of the type `webhook.ping` is sent to it now, with all waiting messages. The deliveries show the result.
#[utoipa::path(
    post, path = "/v1/webhooks/{id}/ping", tag = "Webhooks", operation_id = "ping_webhook",
    responses(
        (status = 202, description = "The message.", body = DeliveryView),
        (status = 409, description = "The webhook was given up."),
    ),
)]
pub(super) async fn ping(client: Client, WebhookId(id): WebhookId) -> Result<Response, Refusal> {
    let ping = client.app.webhooks.ping(client.name(), id).await?;
    Ok((StatusCode::ACCEPTED, Json(DeliveryView::of(ping))).into_response())
}

/// List deliveries
///
/// The latest hundred messages to a webhook, the newest first, with the state of each. They are kept for a week.
#[utoipa::path(
    get, path = "/v1/webhooks/{id}/deliveries", tag = "Webhooks", operation_id = "list_deliveries",
    responses(
        (status = 200, description = "The messages.", body = DeliveryListView),
    ),
)]
pub(super) async fn deliveries(
    client: Client,
    WebhookId(id): WebhookId,
) -> Result<Json<DeliveryListView>, Refusal> {
    let deliveries = client.app.webhooks.deliveries(client.name(), id).await?;
    let items = deliveries.into_iter().map(DeliveryView::of).collect();
    Ok(Json(DeliveryListView { items }))
}

/// Enable a webhook
///
/// A disabled webhook is enabled again, and one that waits for a retry is tried now: the waiting messages are sent. Events during the time in which it was
/// disabled are not sent.
#[utoipa::path(
    post, path = "/v1/webhooks/{id}/enable", tag = "Webhooks", operation_id = "enable_webhook",
    responses(
        (status = 200, description = "The webhook.", body = WebhookView),
        (status = 422, description = "The address is no longer one to send to."),
    ),
)]
pub(super) async fn enable(
    client: Client,
    WebhookId(id): WebhookId,
) -> Result<Json<WebhookView>, Refusal> {
    let webhook = client.app.webhooks.enable(client.name(), id).await?;
    Ok(Json(WebhookView::of(webhook, None)))
}

/// Rotate the secret of a webhook
///
/// From now on messages are signed with a new secret, and for a day with the one before, too: `webhook-signature` has both signatures then,
/// separated by a blank.
#[utoipa::path(
    post, path = "/v1/webhooks/{id}/rotate", tag = "Webhooks", operation_id = "rotate_webhook",
    responses(
        (status = 200, description = "The webhook, with its new secret, which is told this once.", body = WebhookView),
    ),
)]
pub(super) async fn rotate(
    client: Client,
    WebhookId(id): WebhookId,
) -> Result<Json<WebhookView>, Refusal> {
    let rotated = client.app.webhooks.rotate(client.name(), id).await?;
    Ok(Json(WebhookView::of(rotated.webhook, Some(rotated.secret))))
}
