//! Who asks: the client behind a request, known by its key or by a token of the identity provider.

use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method};
use jiff::Timestamp;
use meshwright_connections::ActiveRequest;
use meshwright_wire::{Code, Problem};

use super::app::App;
use super::credential::{Credential, bearer, no_credential, unauthorized};
use super::parameters::User;
use super::problem::{Refusal, overloaded};
use crate::jobs::{JobError, KeyRecord, Member, Role};
use crate::keys::Key;
use crate::tokens::{Bearer, TokenError};

/// The client of requests without a key, where none is needed.
const ANONYMOUS: &str = "anonymous";

/// The client that a request comes from, and the service that it asks. Jobs belong to their client, and nobody sees those of another. A
/// handler that takes it is served to those who may get in, as often as they may, and changes nothing for those who may only look.
pub(super) struct Client {
    pub(super) app: App,
    pub(super) member: Member,
    pub(super) role: Role,
    pub(super) pass: Pass,
}

/// The name of the client of a request, for layers that run before its handler.
#[derive(Debug, Clone)]
pub(super) struct ClientName(pub(super) Arc<str>);

/// The right by which a request was admitted.
pub(super) enum Pass {
    /// Its key.
    Key(Key),
    /// A token, which ends by itself.
    Until(Timestamp),
    /// None is needed.
    Open,
}

impl Pass {
    /// True if the request would be admitted now. A failed lookup counts as true.
    pub(super) async fn holds(&self, app: &App) -> bool {
        let now = app.jobs.clock().now();
        match self {
            Self::Key(key) => !matches!(key.find(app.jobs.store(), now).await, Ok(None)),
            Self::Until(end) => now < *end,
            Self::Open => true,
        }
    }
}

impl Client {
    /// The name that its jobs bear.
    pub(super) fn name(&self) -> &str {
        &self.member.client
    }

    /// Refuses who has waited and would not get in now.
    ///
    /// # Errors
    ///
    /// `unauthorized`.
    pub(super) async fn check_again(&self) -> Result<(), Problem> {
        if self.pass.holds(&self.app).await {
            Ok(())
        } else {
            let detail = "The key was revoked or has expired while the request waited.";
            Err(unauthorized(detail))
        }
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

/// The same for who uses the service.
pub(super) struct Administrator {
    pub(super) app: App,
    /// The name of the client that it is.
    pub(super) name: String,
}

impl FromRequestParts<App> for Client {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let caller = Caller::of(parts, app).await?;
        let changes = !matches!(parts.method, Method::GET | Method::HEAD);
        if changes && caller.role == Role::Reader {
            return Err(forbidden("The key may look, and change nothing.").into());
        }
        Ok(Self {
            app: app.clone(),
            member: caller.member,
            role: caller.role,
            pass: caller.pass,
        })
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
            Role::Client | Role::Reader | Role::Administrator => {
                Err(forbidden("The numbers of the service are for keys of its operator.").into())
            }
        }
    }
}

impl FromRequestParts<App> for Administrator {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let caller = Caller::of(parts, app).await?;
        match caller.role {
            Role::Administrator => Ok(Self {
                app: app.clone(),
                name: caller.member.client,
            }),
            Role::Client | Role::Reader | Role::Operator => {
                Err(forbidden("Who uses the service is for keys of its administrator.").into())
            }
        }
    }
}

/// The sender of a request and its role.
struct Caller {
    member: Member,
    role: Role,
    pass: Pass,
    /// Requests a second, where they are not the usual ones.
    rate: Option<u32>,
}

impl Caller {
    async fn of(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        let credential = bearer(&parts.headers)?;
        let fingerprint = credential.as_ref().map(Credential::fingerprint);
        let caller = match credential {
            Some(Credential::Key(key)) => Self::with_key(app, key, &parts.headers).await?,
            Some(Credential::Token(token)) => Self::with_token(app, &token, &parts.headers).await?,
            None if asks_for_keys(app, &parts.headers).await? => {
                return Err(unauthorized("Send a key: Authorization: Bearer KEY.").into());
            }
            None => Self::anonymous(app),
        };
        let client = Arc::from(caller.member.client.as_str());
        if let Some(fingerprint) = fingerprint {
            app.access.remember(fingerprint);
            if let Some(active) = parts.extensions.get::<Arc<ActiveRequest>>() {
                active.authenticated(&client).map_err(overloaded)?;
            }
            tracing::Span::current().record("client", &caller.member.client);
        }
        // Who reads the body shares the memory for that by it.
        parts.extensions.insert(ClientName(client));
        app.access
            .count_request(&caller.member.client, caller.rate)
            .map_err(Refusal::too_often)?;
        Ok(caller)
    }

    /// Where no key is needed everybody is alike, and may do everything and have the whole queue.
    fn anonymous(app: &App) -> Self {
        let member = Member {
            client: ANONYMOUS.to_owned(),
            // Where everybody may say anything a name means nothing.
            user: None,
            queue_limit: Some(app.jobs.rules().queue_limit),
        };
        Self {
            member,
            role: Role::Operator,
            pass: Pass::Open,
            rate: None,
        }
    }

    async fn with_key(app: &App, key: Key, headers: &HeaderMap) -> Result<Self, Problem> {
        let record = recognize(app, &key).await?;
        app.access.found_keys();
        // The log entry of a request names its key: who did it, and with which answer.
        tracing::Span::current().record("key", &record.id);
        Ok(Self {
            member: Member {
                client: record.client,
                user: User::of(headers)?.0,
                queue_limit: record.queue_limit,
            },
            role: record.role,
            pass: Pass::Key(key),
            rate: record.requests_per_second,
        })
    }

    async fn with_token(app: &App, token: &str, headers: &HeaderMap) -> Result<Self, Problem> {
        let tokens = app.tokens.as_ref().ok_or_else(no_credential)?;
        let bearer: Bearer = tokens
            .recognize(token)
            .await
            .map_err(|error| match &error {
                TokenError::Refused(why) => unauthorized(why),
                TokenError::Unreachable => {
                    Problem::new(Code::IdentityProviderUnavailable, error.to_string())
                }
            })?;
        let span = tracing::Span::current();
        span.record("subject", bearer.subject);
        span.record("token", bearer.id);
        User::refuse_beside_token(headers)?;
        Ok(Self {
            member: Member {
                client: bearer.client,
                user: bearer.user,
                queue_limit: None,
            },
            role: bearer.role,
            pass: Pass::Until(bearer.until),
            rate: None,
        })
    }
}

async fn recognize(app: &App, key: &Key) -> Result<KeyRecord, Problem> {
    let found = key.find(app.jobs.store(), app.jobs.clock().now()).await;
    let found = found.map_err(|error| Problem::from(JobError::from(error)))?;
    found.ok_or_else(|| unauthorized("The key is not known here, was revoked or has expired."))
}

/// True if a request needs a key.
async fn asks_for_keys(app: &App, headers: &HeaderMap) -> Result<bool, Problem> {
    if let Some(asks) = app.access.asks_for_keys(headers) {
        return Ok(asks);
    }
    let has_keys = app.jobs.store().has_keys().await;
    let has_keys = has_keys.map_err(JobError::from)?;
    if has_keys {
        app.access.found_keys();
    }
    Ok(has_keys)
}

fn forbidden(detail: &str) -> Problem {
    Problem::new(Code::Forbidden, detail)
}
