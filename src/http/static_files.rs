//! Answers that stay the same as long as the program runs. They are packed once, and cost a request nothing: anybody may ask
//! for them, as often as he likes.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::OnceLock;

use axum::body::Bytes;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE, HeaderValue, VARY};
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use meshwright_connections::{Keep, Tag, packed, takes_gzip};
use meshwright_wire::hash::sha256_hex;

use super::memory::Counted;

/// An answer in both forms.
#[derive(Debug)]
pub(super) struct StaticFile {
    media_type: &'static str,
    plain: Bytes,
    packed: Bytes,
    hash: OnceLock<String>,
}

impl StaticFile {
    /// A document that is made when the program starts.
    pub(super) fn document(media_type: &'static str, plain: impl Into<Bytes>) -> Self {
        let plain = plain.into();
        let packed = packed(&plain, Compression::best()).expect("memory takes every byte");
        Self {
            media_type,
            plain,
            packed,
            hash: OnceLock::new(),
        }
    }

    /// The answer to a request with these headers.
    pub(super) async fn answer(&self, request: &HeaderMap) -> Response {
        let is_packed = takes_gzip(request);
        let hash = self
            .hash
            .get_or_init(|| sha256_hex(&self.plain)[..32].to_owned());
        let tag = Tag::of_hash(hash, "");
        let made = async {
            let media_type = [(CONTENT_TYPE, self.media_type)];
            Ok::<_, Infallible>(if is_packed {
                let packing = [(CONTENT_ENCODING, "gzip")];
                (media_type, packing, self.packed.clone()).into_response()
            } else {
                (media_type, self.plain.clone()).into_response()
            })
        };
        let Ok(mut response) = tag.answer(Keep::AskAgain, request, made).await;
        let by = HeaderValue::from_static("accept-encoding");
        response.headers_mut().insert(VARY, by);
        response.extensions_mut().insert(Counted);
        response
    }
}

/// A file of the program: its name, its content, and its content packed by the build.
pub(super) type File = (&'static str, &'static [u8], &'static [u8]);

/// A folder of files.
#[derive(Debug)]
pub(super) struct Folder(BTreeMap<&'static str, StaticFile>);

impl Folder {
    pub(super) fn of(files: &'static [File]) -> Self {
        let file = |&(name, plain, packed): &File| {
            let answer = StaticFile {
                media_type: media_type(name),
                plain: Bytes::from_static(plain),
                packed: Bytes::from_static(packed),
                hash: OnceLock::new(),
            };
            (name, answer)
        };
        Self(files.iter().map(file).collect())
    }

    /// The file of this name.
    pub(super) fn find(&self, name: &str) -> Option<&StaticFile> {
        self.0.get(name)
    }
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        _ => "text/plain; charset=utf-8",
    }
}

/// The files of the program, as its build has listed them.
pub(super) mod files {
    use super::File;

    include!(concat!(env!("OUT_DIR"), "/files.rs"));
}
