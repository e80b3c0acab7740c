//! Answers packed for those who take gzip: never on the threads that answer.

use std::io::{self, Write};
use std::mem::take;

use bytes::Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;
use futures_util::{Stream, StreamExt, stream};
use http_body::SizeHint;
use hyper::HeaderMap;
use hyper::header::{CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_TYPE, HeaderValue};
use tokio::task::JoinError;
use tower::BoxError;

use super::blocking::blocking;
use super::tag::tag_as_packed;

/// Smaller answers fit in a packet or two, and packing would only take time.
const LEAST: u64 = 4 << 10;

/// Whose turn it is to have something packed is not asked: it takes a millisecond for a megabyte.
const NOBODY: &str = "";

/// True if an answer with these headers and of that size is worth packing: text of some length that is not packed yet. A stream of events has to arrive event
/// by event.
pub fn gains_by_packing(headers: &HeaderMap, size: &SizeHint) -> bool {
    let media_type = headers
        .get(CONTENT_TYPE)
        .and_then(|media_type| media_type.to_str().ok())
        .unwrap_or_default();
    let is_text = media_type.starts_with("text/")
        || ["json", "xml"].iter().any(|form| media_type.contains(form));
    is_text
        && !media_type.starts_with("text/event-stream")
        && !headers.contains_key(CONTENT_ENCODING)
        && size.exact().is_none_or(|length| length >= LEAST)
}

/// Says in the headers of an answer that it is packed.
pub fn say_packed(headers: &mut HeaderMap) {
    headers.remove(CONTENT_LENGTH);
    headers.insert(CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    tag_as_packed(headers);
}

/// Packs a body that is there already.
///
/// # Errors
///
/// Where packing panics.
pub async fn packed_whole(bytes: Bytes) -> Result<io::Result<Bytes>, JoinError> {
    blocking(NOBODY, move |_| packed(&bytes, Compression::fast())).await
}

/// The packed form of `bytes`.
///
/// # Errors
///
/// None that memory has.
pub fn packed(bytes: &[u8], how: Compression) -> io::Result<Bytes> {
    let mut encoder = GzEncoder::new(Vec::new(), how);
    encoder.write_all(bytes)?;
    encoder.finish().map(Bytes::from)
}

type Encoder = GzEncoder<Vec<u8>>;

/// Packs a body as it is made.
pub fn packed_stream<S, E>(body: S) -> impl Stream<Item = Result<Vec<u8>, BoxError>>
where
    S: Stream<Item = Result<Bytes, E>> + Unpin,
    E: Into<BoxError>,
{
    let encoder = GzEncoder::new(Vec::new(), Compression::fast());
    let begin = Some((body, encoder));
    stream::unfold(begin, async |at| {
        let (stream, encoder) = at?;
        Some(match next_piece(stream, encoder).await {
            Ok((piece, rest)) => (Ok(piece), rest),
            Err(error) => (Err(error), None),
        })
    })
}

/// The next bytes of a packed stream, and its rest.
async fn next_piece<S, E>(
    mut stream: S,
    mut encoder: Encoder,
) -> Result<(Vec<u8>, Option<(S, Encoder)>), BoxError>
where
    S: Stream<Item = Result<Bytes, E>> + Unpin,
    E: Into<BoxError>,
{
    while let Some(chunk) = stream.next().await {
        let chunk = chunk.map_err(Into::into)?;
        let written = blocking(NOBODY, move |_| encoder.write_all(&chunk).map(|()| encoder)).await;
        encoder = written??;
        let piece = take(encoder.get_mut());
        if !piece.is_empty() {
            return Ok((piece, Some((stream, encoder))));
        }
    }
    Ok((encoder.finish()?, None))
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use futures_util::TryStreamExt;

    use super::*;

    fn unpacked(bytes: &[u8]) -> Vec<u8> {
        let mut plain = Vec::new();
        let mut decoder = flate2::read::GzDecoder::new(bytes);
        decoder.read_to_end(&mut plain).unwrap();
        plain
    }

    /// All that comes of these pieces, packed as they come.
    async fn packed_pieces(pieces: Vec<io::Result<Bytes>>) -> Result<Vec<u8>, BoxError> {
        packed_stream(stream::iter(pieces)).try_concat().await
    }

    #[tokio::test]
    async fn a_stream_is_packed_piece_by_piece_and_unpacks_to_what_it_was() {
        let chunks: Vec<String> = (0..2000).map(|i| format!("{i},{}\n", i * 7919)).collect();
        let plain = chunks.concat();
        let pieces = chunks.into_iter().map(|chunk| Ok(chunk.into())).collect();
        let packed = packed_pieces(pieces).await.unwrap();
        assert!(packed.len() < plain.len() / 2);
        assert_eq!(unpacked(&packed), plain.as_bytes());
    }

    #[tokio::test]
    async fn a_stream_that_breaks_does_not_end_as_if_it_were_whole() {
        let pieces = vec![Ok("some".into()), Err(io::Error::other("the disk"))];
        assert!(packed_pieces(pieces).await.is_err());
    }
}
