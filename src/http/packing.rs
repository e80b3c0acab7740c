//! Answers packed for those who take gzip: never on the threads that answer.

use std::io::{self, Write};
use std::mem::take;

use axum::body::{Body, BodyDataStream, Bytes};
use axum::extract::Request;
use axum::http::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE, HeaderValue, VARY};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use futures_util::{StreamExt, stream};
use http_body::Body as _;

use super::accepts::takes_gzip;
use super::blocking::blocking;
use super::conditional::tag_as_packed;
use super::memory::Counted;
use super::problem::{Refusal, internal};

/// What is smaller fits in a packet or two, and packing it would only take time.
const LEAST: u64 = 4 << 10;

/// Whose turn it is to have something packed is not asked: it takes a millisecond for a megabyte.
const NOBODY: &str = "";

/// Packs answers that gain by it and were not packed before.
pub(super) async fn pack(request: Request, next: Next) -> Response {
    let wanted = takes_gzip(request.headers());
    let response = next.run(request).await;
    if !gains(&response) {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    parts
        .headers
        .append(VARY, HeaderValue::from_static("accept-encoding"));
    if !wanted {
        return Response::from_parts(parts, body);
    }
    parts.headers.remove(CONTENT_LENGTH);
    parts
        .headers
        .insert(CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    tag_as_packed(&mut parts.headers);
    // Its bytes are others now.
    parts.extensions.remove::<Counted>();
    if body.size_hint().exact().is_none() {
        return Response::from_parts(parts, packed_stream(body));
    }
    match packed_whole(body).await {
        Some(packed) => Response::from_parts(parts, packed.into()),
        None => Refusal::from(internal()).into_response(),
    }
}

/// Whether it is text of some length. A stream of events has to arrive event by event.
fn gains(response: &Response) -> bool {
    let headers = response.headers();
    let media_type = headers
        .get(CONTENT_TYPE)
        .and_then(|media_type| media_type.to_str().ok())
        .unwrap_or_default();
    let is_text = media_type.starts_with("text/")
        || ["json", "xml"].iter().any(|form| media_type.contains(form));
    let length = response.body().size_hint().exact();
    is_text
        && !media_type.starts_with("text/event-stream")
        && !headers.contains_key(CONTENT_ENCODING)
        && length.is_none_or(|length| length >= LEAST)
}

/// Packs a body that is there already.
async fn packed_whole(body: Body) -> Option<Bytes> {
    let bytes = axum::body::to_bytes(body, usize::MAX).await.ok()?;
    let packed = blocking(NOBODY, move |_| packed(&bytes, Compression::fast())).await;
    packed.ok()?.ok()
}

/// What `bytes` come to, packed.
pub(super) fn packed(bytes: &[u8], how: Compression) -> io::Result<Bytes> {
    let mut encoder = GzEncoder::new(Vec::new(), how);
    encoder.write_all(bytes)?;
    encoder.finish().map(Bytes::from)
}

type Encoder = GzEncoder<Vec<u8>>;

/// Packs a body as it is made.
fn packed_stream(body: Body) -> Body {
    let encoder = GzEncoder::new(Vec::new(), Compression::fast());
    let begin = Some((body.into_data_stream(), encoder));
    Body::from_stream(stream::unfold(begin, async |at| {
        let (stream, encoder) = at?;
        Some(match next_piece(stream, encoder).await {
            Ok((piece, rest)) => (Ok(piece), rest),
            Err(error) => (Err(error), None),
        })
    }))
}

/// The next bytes of a packed stream, and what is left of it.
async fn next_piece(
    mut stream: BodyDataStream,
    mut encoder: Encoder,
) -> Result<(Vec<u8>, Option<(BodyDataStream, Encoder)>), axum::Error> {
    while let Some(chunk) = stream.next().await {
        let chunk = chunk?;
        let written = blocking(NOBODY, move |_| encoder.write_all(&chunk).map(|()| encoder)).await;
        encoder = written
            .map_err(axum::Error::new)?
            .map_err(axum::Error::new)?;
        let piece = take(encoder.get_mut());
        if !piece.is_empty() {
            return Ok((piece, Some((stream, encoder))));
        }
    }
    let last = encoder.finish().map_err(axum::Error::new)?;
    Ok((last, None))
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    fn unpacked(bytes: &[u8]) -> Vec<u8> {
        let mut plain = Vec::new();
        let mut decoder = flate2::read::GzDecoder::new(bytes);
        decoder.read_to_end(&mut plain).unwrap();
        plain
    }

    #[tokio::test]
    async fn a_stream_is_packed_piece_by_piece_and_unpacks_to_what_it_was() {
        let chunks: Vec<String> = (0..2000).map(|i| format!("{i},{}\n", i * 7919)).collect();
        let plain = chunks.concat();
        let body = Body::from_stream(stream::iter(chunks.into_iter().map(Ok::<_, io::Error>)));
        let packed = axum::body::to_bytes(packed_stream(body), usize::MAX)
            .await
            .unwrap();
        assert!(packed.len() < plain.len() / 2);
        assert_eq!(unpacked(&packed), plain.as_bytes());
    }

    #[tokio::test]
    async fn a_stream_that_breaks_does_not_end_as_if_it_were_whole() {
        let pieces = [Ok("some"), Err(io::Error::other("the disk"))];
        let body = packed_stream(Body::from_stream(stream::iter(pieces)));
        assert!(axum::body::to_bytes(body, usize::MAX).await.is_err());
    }
}
