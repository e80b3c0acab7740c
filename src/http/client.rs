//! Who asks.

use std::convert::Infallible;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;

/// The client that a request comes from. Jobs belong to their client, and nobody sees those of another.
///
/// There are no keys yet, so everybody is the same anonymous client.
pub(super) struct Client(pub(super) String);

impl<S: Sync> FromRequestParts<S> for Client {
    type Rejection = Infallible;

    async fn from_request_parts(_: &mut Parts, _: &S) -> Result<Self, Infallible> {
        Ok(Self("anonymous".to_owned()))
    }
}
