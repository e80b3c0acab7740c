//! Entity tags: a client that has the answer already gets 304 (RFC 9110, section 13).

use hyper::header::{CACHE_CONTROL, CONTENT_ENCODING, ETAG, HeaderValue, IF_NONE_MATCH};
use hyper::{HeaderMap, Response, StatusCode};

use super::accepts::takes_gzip;

/// How long an answer may be kept by who asked for it.
#[derive(Debug, Clone, Copy)]
pub enum Keep {
    /// The content may change: ask again, with the tag.
    AskAgain,
    /// The content never changes under its address.
    ForGood,
}

impl Keep {
    fn value(self) -> &'static str {
        match self {
            Self::AskAgain => "private, no-cache",
            Self::ForGood => "private, max-age=31536000, immutable",
        }
    }
}

/// A strong entity tag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tag(String);

impl Tag {
    /// The tag of one form of the content with this hash.
    pub fn of_hash(hash: &str, form: &str) -> Self {
        Self(format!("\"{hash}{form}\""))
    }

    /// The tag of the same answer packed by gzip: it has other bytes, so that it is another one (RFC 9110, section 8.8.3).
    fn packed(&self) -> Self {
        Self(format!("{}-gzip\"", self.0.trim_end_matches('"')))
    }

    /// Which form of this the client says that it has, if it has one that it takes.
    fn known(&self, request: &HeaderMap) -> Option<Self> {
        let packed = takes_gzip(request).then(|| self.packed());
        let values = request
            .get_all(IF_NONE_MATCH)
            .iter()
            .filter_map(|value| value.to_str().ok());
        let mut known = values
            .flat_map(|value| value.split(','))
            .map(str::trim)
            // For If-None-Match a weak tag is as good as a strong one.
            .map(|known| known.strip_prefix("W/").unwrap_or(known));
        known.find_map(|known| match &packed {
            Some(packed) if known == packed.0 => Some(packed.clone()),
            _ => (known == "*" || known == self.0).then(|| self.clone()),
        })
    }

    /// The answer: 304 if the client has it already, or the result of `make`, with the tag on it.
    ///
    /// # Errors
    ///
    /// Errors of `make`.
    pub async fn answer<B: Default, E>(
        &self,
        keep: Keep,
        request: &HeaderMap,
        make: impl Future<Output = Result<Response<B>, E>>,
    ) -> Result<Response<B>, E> {
        let (mut response, tag) = match self.known(request) {
            Some(known) => {
                let mut response = Response::new(B::default());
                *response.status_mut() = StatusCode::NOT_MODIFIED;
                (response, known)
            }
            None => {
                let made = make.await?;
                let is_packed = made.headers().contains_key(CONTENT_ENCODING);
                (
                    made,
                    if is_packed {
                        self.packed()
                    } else {
                        self.clone()
                    },
                )
            }
        };
        let headers = response.headers_mut();
        let tag = HeaderValue::from_str(&tag.0).expect("a hash in quotes is visible ASCII");
        headers.insert(ETAG, tag);
        headers.insert(CACHE_CONTROL, HeaderValue::from_static(keep.value()));
        Ok(response)
    }
}

/// Gives an answer that is packed now the tag of that form.
pub(super) fn tag_as_packed(headers: &mut HeaderMap) {
    let tag = headers.get(ETAG).and_then(|tag| tag.to_str().ok());
    let packed = tag.map(|tag| Tag(tag.to_owned()).packed());
    if let Some(tag) = packed.and_then(|tag| HeaderValue::try_from(tag.0).ok()) {
        headers.insert(ETAG, tag);
    }
}

#[cfg(test)]
mod tests {
    use hyper::header::ACCEPT_ENCODING;

    use super::*;

    #[test]
    fn a_tag_is_known_in_a_list_weak_or_by_a_star_and_packed_by_who_takes_that() {
        let tag = Tag::of_hash("abc", "");
        let known = |value: &'static str, takes: &'static str| {
            let headers = [(IF_NONE_MATCH, value), (ACCEPT_ENCODING, takes)];
            let headers = headers.map(|(name, value)| (name, HeaderValue::from_static(value)));
            tag.known(&headers.into_iter().collect()).map(|tag| tag.0)
        };
        for value in ["\"abc\"", "\"x\", W/\"abc\"", "*"] {
            assert_eq!(known(value, "gzip").as_deref(), Some("\"abc\""), "{value}");
        }
        let packed = "W/\"abc-gzip\"";
        assert_eq!(known(packed, "gzip").as_deref(), Some("\"abc-gzip\""));
        for (value, takes) in [(packed, ""), ("\"x\"", "gzip"), ("abc", ""), ("", "")] {
            assert_eq!(known(value, takes), None, "{value}");
        }
    }
}
