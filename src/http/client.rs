//! Who asks: the client behind a request, known by its key.

use axum::extract::FromRequestParts;
use axum::http::Method;
use axum::http::header::AUTHORIZATION;
use axum::http::request::Parts;

use super::app::App;
use super::problem::Refusal;
use crate::jobs::{JobError, KeyRecord, Member, Role};
use crate::keys::Key;
use crate::wire::{Code, Problem};

/// The client of requests without a key, where none is needed.
const ANONYMOUS: &str = "anonymous";

/// The client that a request comes from. Jobs belong to their client, and nobody sees those of another. A handler that
/// takes it is served to those who may get in, as often as they may, and changes nothing for those who may only look.
pub(super) struct Client(pub(super) Member);

impl Client {
    /// The name that its jobs bear.
    pub(super) fn name(&self) -> &str {
        &self.0.client
    }
}

/// The same for a handler that changes nothing whatever its method is.
pub(super) struct Onlooker;

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
        Ok(Self(caller.member))
    }
}

impl FromRequestParts<App> for Onlooker {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        Caller::of(parts, app).await.map(|_| Self)
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
}

impl Caller {
    async fn of(parts: &Parts, app: &App) -> Result<Self, Refusal> {
        let record = match bearer(parts)? {
            Some(key) => Some(recognize(app, &key).await?),
            None if asks_for_keys(app).await? => {
                return Err(unauthorized("Send a key: Authorization: Bearer KEY.").into());
            }
            None => None,
        };
        let caller = record
            .as_ref()
            .map_or_else(|| Self::anonymous(app), Self::bearer_of);
        let rate = record.and_then(|record| record.requests_per_second);
        app.door
            .count_request(&caller.member.client, rate)
            .map_err(Refusal::too_often)?;
        Ok(caller)
    }

    /// Where no key is needed everybody is alike, and may do everything and have the whole queue.
    fn anonymous(app: &App) -> Self {
        Self {
            member: Member {
                client: ANONYMOUS.to_owned(),
                queue_limit: Some(app.jobs.rules().queue_limit),
            },
            role: Role::Operator,
        }
    }

    fn bearer_of(record: &KeyRecord) -> Self {
        Self {
            member: Member {
                client: record.client.clone(),
                queue_limit: record.queue_limit,
            },
            role: record.role,
        }
    }
}

/// The key that a request has with it. What a proxy may have left there for itself is none.
fn bearer(parts: &Parts) -> Result<Option<Key>, Problem> {
    let mut found = None;
    for header in parts.headers.get_all(AUTHORIZATION) {
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
    let found = key.find(app.jobs.store()).await;
    let found = found.map_err(|error| Problem::from(JobError::from(error)))?;
    found.ok_or_else(|| unauthorized("The key is not known here, or was revoked."))
}

/// Whether a key is needed: where others than this machine can call, and as soon as there is one.
async fn asks_for_keys(app: &App) -> Result<bool, Problem> {
    if app.door.always_asks_for_keys() {
        return Ok(true);
    }
    let has_keys = app.jobs.store().has_keys().await;
    has_keys.map_err(|error| JobError::from(error).into())
}

fn unauthorized(detail: &str) -> Problem {
    Problem::new(Code::Unauthorized, detail)
}

fn forbidden(detail: &str) -> Problem {
    Problem::new(Code::Forbidden, detail)
}
