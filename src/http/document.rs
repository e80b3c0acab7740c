//! The body of a request: a JSON document of bounded size.

use std::error::Error;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::{FromRequest, Request};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE};
use futures_util::StreamExt;
use serde::Deserialize;
use tower_http::timeout::TimeoutError;

use crate::wire::{Code, Problem};

/// So many times the limit is read and thrown away, because a client that is still sending does not see the answer.
const DRAINED: usize = 64;

/// The body is here within this time; a layer of the router sees to it.
pub(super) const PATIENCE: Duration = Duration::from_secs(30);

/// The bytes of a request's JSON document, so many MiB at most. The largest submission, with every table full, has a few hundred thousand bytes.
pub(super) struct Document<const MIB: usize = 1>(pub(super) Bytes);

impl<const MIB: usize, S: Send + Sync> FromRequest<S> for Document<MIB> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Self, Problem> {
        let media_type = check_media_type(request.headers());
        let body = read(request.into_body(), MIB * 1024 * 1024).await?;
        media_type?;
        Ok(Self(body))
    }
}

impl<const MIB: usize> Document<MIB> {
    /// The document as a `T`, of which a problem speaks as `name`.
    pub(super) fn parse<'a, T: Deserialize<'a>>(&'a self, name: &str) -> Result<T, Problem> {
        serde_json::from_slice(&self.0).map_err(|error| {
            let code = if error.is_data() {
                Code::WrongType
            } else {
                Code::MalformedJson
            };
            Problem::new(code, format!("This is no {name}: {error}."))
        })
    }
}

fn check_media_type(headers: &HeaderMap) -> Result<(), Problem> {
    let refuse = |detail: String| Err(Problem::new(Code::UnsupportedMediaType, detail));
    if headers
        .get(CONTENT_ENCODING)
        .is_some_and(|encoding| encoding != "identity")
    {
        return refuse("Send the body without a Content-Encoding.".to_owned());
    }
    let Some(given) = headers.get(CONTENT_TYPE) else {
        return refuse("Send the body with Content-Type: application/json.".to_owned());
    };
    let essence = given
        .to_str()
        .unwrap_or_default()
        .split(';')
        .next()
        .unwrap_or_default()
        .trim()
        .to_ascii_lowercase();
    if essence == "application/json"
        || (essence.starts_with("application/") && essence.ends_with("+json"))
    {
        return Ok(());
    }
    refuse(format!(
        "Send the body with Content-Type: application/json, not {essence:?}."
    ))
}

async fn read(body: Body, limit: usize) -> Result<Bytes, Problem> {
    let (mut stream, mut bytes, mut length) = (body.into_data_stream(), Vec::new(), 0_usize);
    while let Some(chunk) = stream.next().await {
        let chunk = chunk.map_err(|error| broken(&error))?;
        length = length.saturating_add(chunk.len());
        if length > DRAINED * limit {
            break;
        }
        if length <= limit {
            bytes.extend_from_slice(&chunk);
        }
    }
    if length > limit {
        return Err(Problem::new(
            Code::PayloadTooLarge,
            format!("The body has more than {limit} bytes, the limit here."),
        ));
    }
    Ok(bytes.into())
}

/// Why a body is not complete.
fn broken(error: &axum::Error) -> Problem {
    let mut cause: Option<&(dyn Error + 'static)> = Some(error);
    while let Some(error) = cause {
        if error.is::<TimeoutError>() {
            return Problem::new(
                Code::RequestTimeout,
                format!("The body was not here within {} s.", PATIENCE.as_secs()),
            );
        }
        cause = error.source();
    }
    Problem::new(
        Code::MalformedJson,
        "The body ended before it was complete.",
    )
}
