//! Entity tags: a client that has the answer already is told so (RFC 9110, section 13).

use axum::http::header::{ETAG, HeaderValue, IF_NONE_MATCH};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use sha2::{Digest, Sha256};

/// A strong entity tag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Tag(String);

impl Tag {
    /// The tag of a body.
    pub(super) fn of(body: &[u8]) -> Self {
        let hash: String = Sha256::digest(body)[..16]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        Self(format!("\"{hash}\""))
    }

    /// The tag of what a hash stands for, in one of its forms.
    pub(super) fn of_hash(hash: &str, form: &str) -> Self {
        Self(format!("\"{hash}{form}\""))
    }

    /// Whether the client says that it has this.
    pub(super) fn is_known(&self, request: &HeaderMap) -> bool {
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

    /// Puts the tag on an answer.
    pub(super) fn mark(&self, headers: &mut HeaderMap) {
        headers.insert(
            ETAG,
            HeaderValue::from_str(&self.0).expect("a hash in quotes is visible ASCII"),
        );
    }

    /// The answer to a client that has this already.
    pub(super) fn not_modified(&self) -> Response {
        let mut response = StatusCode::NOT_MODIFIED.into_response();
        self.mark(response.headers_mut());
        response
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
