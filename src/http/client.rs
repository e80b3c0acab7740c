//! Who asks: the client behind a request, known by its key.

use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::header::AUTHORIZATION;
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method};

use super::app::App;
use super::guests::Guest;
use super::problem::Refusal;
use crate::jobs::{JobError, KeyRecord, Member, Role};
use crate::keys::Key;
use crate::wire::{Code, Problem};

/// The client of requests without a key, where none is needed.
const ANONYMOUS: &str = "anonymous";

/// The client that a request comes from. Jobs belong to their client, and nobody sees those of another. A handler that
/// takes it is served to those who may get in, as often as they may, and changes nothing for those who may only look.
pub(super) struct Client(pub(super) Member, pub(super) Pass);

/// The name of the client of a request, for what is done before its handler.
#[derive(Debug, Clone)]
pub(super) struct ClientName(pub(super) Arc<str>);

/// What a request got in by: its key, or that none is needed.
pub(super) struct Pass(Option<Key>);

impl Pass {
    /// Whether it would get in now. What cannot be looked up is not held against it.
    pub(super) async fn holds(&self, app: &App) -> bool {
        match &self.0 {
            Some(key) => {
                let now = app.jobs.clock().now();
                !matches!(key.find(app.jobs.store(), now).await, Ok(None))
            }
            None => true,
        }
    }
}

impl Client {
    /// The name that its jobs bear.
    pub(super) fn name(&self) -> &str {
        &self.0.client
    }
}

/// The same for a handler that changes nothing whatever its method is.
pub(super) struct Onlooker(String);

impl Onlooker {
    /// The name of the client.
    pub(super) fn name(&self) -> &str {
        &self.0
    }
}

/// The same for the numbers of the whole service.
pub(super) struct Operator;

impl FromRequestParts<App> for Client {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let caller = Caller::of(parts, app).await?;
        let changes = !matches!(parts.method, Method::GET | Method::HEAD);
        if changes && caller.role == Role::Reader {
            return Err(forbidden("The key may look, and change nothing.").into());
        }
        Ok(Self(caller.member, caller.pass))
    }
}

impl FromRequestParts<App> for Onlooker {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let caller = Caller::of(parts, app).await?;
        Ok(Self(caller.member.client))
    }
}

impl FromRequestParts<App> for Operator {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        match Caller::of(parts, app).await?.role {
            Role::Operator => Ok(Self),
            Role::Client | Role::Reader => {
                Err(forbidden("The numbers of the service are for keys of its operator.").into())
            }
        }
    }
}

/// Who sent a request, and in what part.
struct Caller {
    member: Member,
    role: Role,
    pass: Pass,
}

impl Caller {
    async fn of(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let key = bearer(&parts.headers)?;
        let record = match &key {
            Some(key) => Some(recognize(app, key).await?),
            None if asks_for_keys(app, &parts.headers).await? => {
                return Err(unauthorized("Send a key: Authorization: Bearer KEY.").into());
            }
            None => None,
        };
        if record.is_some()
            && let Some(guest) = parts.extensions.get::<Arc<Guest>>()
        {
            guest.recognize();
        }
        let (member, role) = record
            .as_ref()
            .map_or_else(|| Self::anonymous(app), Self::bearer_of);
        if let Some(record) = &record {
            // What the log says of the request, it says of its key: who did what, and with what answer.
            tracing::Span::current()
                .record("key", &record.id)
                .record("client", &record.client);
        }
        // Who reads the body shares the memory for that by it.
        parts
            .extensions
            .insert(ClientName(Arc::from(member.client.as_str())));
        let pass = Pass(key);
        let caller = Self { member, role, pass };
        let rate = record.and_then(|record| record.requests_per_second);
        app.door
            .count_request(&caller.member.client, rate)
            .map_err(Refusal::too_often)?;
        Ok(caller)
    }

    /// Where no key is needed everybody is alike, and may do everything and have the whole queue.
    fn anonymous(app: &App) -> (Member, Role) {
        let member = Member {
            client: ANONYMOUS.to_owned(),
            queue_limit: Some(app.jobs.rules().queue_limit),
        };
        (member, Role::Operator)
    }

    fn bearer_of(record: &KeyRecord) -> (Member, Role) {
        let member = Member {
            client: record.client.clone(),
            queue_limit: record.queue_limit,
        };
        (member, record.role)
    }
}

/// The key that a request has with it. What a proxy may have left there for itself is none.
pub(super) fn bearer(headers: &HeaderMap) -> Result<Option<Key>, Problem> {
    let mut found = None;
    for header in headers.get_all(AUTHORIZATION) {
        let text = header.to_str().unwrap_or_default();
        let (scheme, key) = text.split_once(' ').unwrap_or((text, ""));
        if !scheme.eq_ignore_ascii_case("bearer") {
            continue;
        }
        match (Key::parse(key.trim()), &found) {
            (Some(key), None) => found = Some(key),
            _ => {
                return Err(unauthorized(
                    "What Authorization has is no key; it has the form Bearer mw_ID_SECRET, and stands once.",
                ));
            }
        }
    }
    Ok(found)
}

async fn recognize(app: &App, key: &Key) -> Result<KeyRecord, Problem> {
    let found = key.find(app.jobs.store(), app.jobs.clock().now()).await;
    let found = found.map_err(|error| Problem::from(JobError::from(error)))?;
    let found = found
        .ok_or_else(|| unauthorized("The key is not known here, was revoked or has expired."))?;
    app.door.prove(key);
    Ok(found)
}

/// Whether a request needs a key.
async fn asks_for_keys(app: &App, headers: &HeaderMap) -> Result<bool, Problem> {
    if let Some(asks) = app.door.asks_for_keys(headers) {
        return Ok(asks);
    }
    let has_keys = app.jobs.store().has_keys().await;
    let has_keys = has_keys.map_err(JobError::from)?;
    if has_keys {
        app.door.found_keys();
    }
    Ok(has_keys)
}

fn unauthorized(detail: &str) -> Problem {
    Problem::new(Code::Unauthorized, detail)
}

fn forbidden(detail: &str) -> Problem {
    Problem::new(Code::Forbidden, detail)
}
