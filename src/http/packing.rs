//! Answers packed for those who take gzip: never on the threads that answer.

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::header::{HeaderValue, VARY};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body::Body as _;
use meshwright_connections::{
    gains_by_packing, packed_stream, packed_whole, say_packed, takes_gzip,
};

use super::memory::Counted;
use super::problem::{Refusal, internal};

/// Packs answers that gain by it and were not packed before.
pub(super) async fn pack(request: Request, next: Next) -> Response {
    let wanted = takes_gzip(request.headers());
    let response = next.run(request).await;
    if !gains_by_packing(response.headers(), &response.body().size_hint()) {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    parts
        .headers
        .append(VARY, HeaderValue::from_static("accept-encoding"));
    if !wanted {
        return Response::from_parts(parts, body);
    }
    say_packed(&mut parts.headers);
    // Its bytes are others now.
    parts.extensions.remove::<Counted>();
    if body.size_hint().exact().is_none() {
        let stream = packed_stream(body.into_data_stream());
        return Response::from_parts(parts, Body::from_stream(stream));
    }
    match whole(body).await {
        Some(packed) => Response::from_parts(parts, packed.into()),
        None => Refusal::from(internal()).into_response(),
    }
}

async fn whole(body: Body) -> Option<Bytes> {
    let bytes = axum::body::to_bytes(body, usize::MAX).await.ok()?;
    packed_whole(bytes).await.ok()?.ok()
}
