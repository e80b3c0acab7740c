//! Entity tags: a client that has the answer already is told so (RFC 9110, section 13).

use axum::http::header::{CACHE_CONTROL, ETAG, HeaderValue, IF_NONE_MATCH};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};

use crate::hash::sha256_hex_of;

/// How long an answer may be kept by who asked for it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Keep {
    /// It may change: ask again, with the tag.
    AskAgain,
    /// It never changes under its address.
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
pub(super) struct Tag(String);

impl Tag {
    /// The tag of an answer that is the same as long as these parts are.
    pub(super) fn of(parts: &[&str]) -> Self {
        Self(format!("\"{}\"", &sha256_hex_of(parts)[..32]))
    }

    /// The tag of what a hash stands for, in one of its forms.
    pub(super) fn of_hash(hash: &str, form: &str) -> Self {
        Self(format!("\"{hash}{form}\""))
    }

    /// Whether the client says that it has this.
    fn is_known(&self, request: &HeaderMap) -> bool {
        let values = request
            .get_all(IF_NONE_MATCH)
            .iter()
            .filter_map(|value| value.to_str().ok());
        values
            .flat_map(|value| value.split(','))
            .map(str::trim)
            .any(|known| {
                // For If-None-Match a weak tag is as good as a strong one.
                known == "*" || known.strip_prefix("W/").unwrap_or(known) == self.0
            })
    }

    /// The answer: that the client has it already, or what `make` gives, with the tag on it.
    ///
    /// # Errors
    ///
    /// What `make` meets.
    pub(super) async fn answer<E>(
        &self,
        keep: Keep,
        request: &HeaderMap,
        make: impl Future<Output = Result<Response, E>>,
    ) -> Result<Response, E> {
        let mut response = if self.is_known(request) {
            StatusCode::NOT_MODIFIED.into_response()
        } else {
            make.await?
        };
        let headers = response.headers_mut();
        let tag = HeaderValue::from_str(&self.0).expect("a hash in quotes is visible ASCII");
        headers.insert(ETAG, tag);
        headers.insert(CACHE_CONTROL, HeaderValue::from_static(keep.value()));
        Ok(response)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tag_is_known_in_a_list_weak_or_by_a_star() {
        let tag = Tag::of_hash("abc", "");
        let known = |value: &'static str| {
            tag.is_known(&HeaderMap::from_iter([(
                IF_NONE_MATCH,
                HeaderValue::from_static(value),
            )]))
        };
        assert!(known("\"abc\"") && known("\"x\", W/\"abc\"") && known("*"));
        assert!(!known("\"x\"") && !known("abc") && !known(""));
    }
}
