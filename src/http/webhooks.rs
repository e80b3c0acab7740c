//! Webhooks: where a client is told that a job or study has ended.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

use super::app::App;
use super::client::Client;
use super::document::Document;
use crate::jobs::{EventKind, Webhook};
use crate::wire::{Code, Problem};

/// A webhook to be made.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(title = "NewWebhook")]
pub(super) struct NewWebhookDocument {
    /// Where messages are sent: an address that the operator of the service allows.
    #[schema(format = "uri", example = "https://hooks.example.com/meshwright")]
    url: String,
    /// What is told; everything unless it is said.
    #[serde(default = "all_events")]
    #[schema(min_items = 1)]
    events: Vec<EventKind>,
}

fn all_events() -> Vec<EventKind> {
    EventKind::ALL.to_vec()
}

/// A webhook.
#[derive(Serialize, ToSchema)]
#[schema(as = Webhook, title = "Webhook")]
pub(super) struct WebhookView {
    /// The id of the webhook.
    #[schema(value_type = String, format = "uuid")]
    id: Uuid,
    /// Where messages are sent.
    url: String,
    /// What is told.
    events: Vec<EventKind>,
    /// When it was made (UTC).
    #[schema(value_type = String, format = DateTime)]
    created_at: Timestamp,
    /// When it was given up because nobody took its messages (UTC); null while it works.
    #[schema(value_type = Option<String>, format = DateTime)]
    disabled_at: Option<Timestamp>,
    /// Why the last message that was not taken was not.
    problem: Option<String>,
    /// What messages are signed with: HMAC-SHA-256 as Standard Webhooks has it. Told once, when the webhook is made.
    #[serde(skip_serializing_if = "Option::is_none")]
    secret: Option<String>,
}

/// The webhooks of a client.
#[derive(Serialize, ToSchema)]
#[schema(as = WebhookList, title = "WebhookList")]
pub(super) struct WebhookListView {
    /// The webhooks, the oldest first.
    items: Vec<WebhookView>,
}

impl WebhookView {
    fn new(webhook: Webhook, secret: Option<String>) -> Self {
        Self {
            id: webhook.id,
            url: webhook.url,
            events: webhook.events,
            created_at: webhook.created_at,
            disabled_at: webhook.disabled_at,
            problem: webhook.problem,
            secret,
        }
    }
}

/// Make a webhook
///
/// From now on a message is sent to the address when a job that stands alone, or a study, has ended: a POST with a small
/// JSON body `{"type", "timestamp", "data": {"id", "status"}}`, signed as Standard Webhooks has it (`webhook-id`,
/// `webhook-timestamp`, `webhook-signature`). A message that is not answered with 2xx is sent again, for a day and a half;
/// then the webhook is given up. Off unless the operator of the service allows hosts to send to.
#[utoipa::path(
    post, path = "/v1/webhooks", tag = "Webhooks", operation_id = "make_webhook",
    request_body(content = NewWebhookDocument, content_type = "application/json", description = "The webhook."),
    responses(
        (status = 201, description = "The webhook, with its secret, which is told this once.", body = WebhookView),
        (status = 400, description = "The body is no JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 408, description = "The body came too slowly.", body = Problem, content_type = "application/problem+json"),
        (status = 413, description = "The body has more than 1 MiB.", body = Problem, content_type = "application/problem+json"),
        (status = 415, description = "The body is not declared as JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Webhooks are off, or the address is not one to send to.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn make(
    State(app): State<App>,
    client: Client,
    document: Document,
) -> Result<Response, Problem> {
    let new: NewWebhookDocument = document.parse("webhook")?;
    let mut events: Vec<EventKind> = Vec::new();
    for event in new.events {
        if !events.contains(&event) {
            events.push(event);
        }
    }
    if events.is_empty() {
        let words = EventKind::ALL.map(EventKind::word).join(", ");
        let detail = format!("/events is empty; give one or more of {words}, or leave it out.");
        return Err(Problem::new(Code::OutOfRange, detail));
    }
    let made = app
        .jobs
        .add_webhook(client.name(), &app.hooks, new.url, events)
        .await?;
    let view = WebhookView::new(made.webhook, Some(made.secret));
    Ok((StatusCode::CREATED, Json(view)).into_response())
}

/// List webhooks
///
/// Those of the client, the oldest first, without their secrets.
#[utoipa::path(
    get, path = "/v1/webhooks", tag = "Webhooks", operation_id = "list_webhooks",
    responses((status = 200, description = "The webhooks.", body = WebhookListView)),
)]
pub(super) async fn list(
    State(app): State<App>,
    client: Client,
) -> Result<Json<WebhookListView>, Problem> {
    let webhooks = app.jobs.list_webhooks(client.name()).await?.into_iter();
    Ok(Json(WebhookListView {
        items: webhooks
            .map(|webhook| WebhookView::new(webhook, None))
            .collect(),
    }))
}

/// Delete a webhook
///
/// Nothing is sent any more, not even what waited to be sent.
#[utoipa::path(
    delete, path = "/v1/webhooks/{id}", tag = "Webhooks", operation_id = "delete_webhook",
    params(("id" = String, Path, format = "uuid", description = "The id of the webhook.")),
    responses(
        (status = 204, description = "The webhook is gone."),
        (status = 404, description = "There is no such webhook.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn delete(
    State(app): State<App>,
    client: Client,
    Path(id): Path<String>,
) -> Result<StatusCode, Problem> {
    let unknown = |_| Problem::new(Code::WebhookNotFound, "There is no webhook of this id.");
    let id = id.parse().map_err(unknown)?;
    app.jobs.delete_webhook(client.name(), id).await?;
    Ok(StatusCode::NO_CONTENT)
}
