//! Credentials of a request.

use axum::http::HeaderMap;
use axum::http::header::AUTHORIZATION;
use meshwright_wire::hash::sha256_hex;
use meshwright_wire::{Code, Problem};

use crate::keys::{self, Key};
use crate::tokens;

/// A credential of a request.
pub(super) enum Credential {
    /// A key of the service.
    Key(Key),
    /// A token, not looked at yet.
    Token(String),
}

impl Credential {
    /// Text that distinguishes the credential from others without revealing it.
    pub(super) fn fingerprint(&self) -> String {
        match self {
            Self::Key(key) => key.secret_hash(),
            Self::Token(token) => sha256_hex(token),
        }
    }
}

/// The bearer credential of a request. An empty one, as a proxy may leave it, counts as none.
pub(super) fn bearer(headers: &HeaderMap) -> Result<Option<Credential>, Problem> {
    let mut found = None;
    for header in headers.get_all(AUTHORIZATION) {
        let text = header.to_str().unwrap_or_default();
        let (scheme, text) = text.split_once(' ').unwrap_or((text, ""));
        if !scheme.eq_ignore_ascii_case("bearer") {
            continue;
        }
        let text = text.trim();
        let credential = if keys::has_prefix(text) {
            Key::parse(text).map(Credential::Key)
        } else {
            tokens::has_form(text).then(|| Credential::Token(text.to_owned()))
        };
        match (credential, &found) {
            (Some(credential), None) => found = Some(credential),
            _ => return Err(no_credential()),
        }
    }
    Ok(found)
}

pub(super) fn no_credential() -> Problem {
    unauthorized(
        "What Authorization has is no key; it has the form Bearer mw_ID_SECRET, or is a token of the identity provider where there is one, and stands once.",
    )
}

pub(super) fn unauthorized(detail: &str) -> Problem {
    Problem::new(Code::Unauthorized, detail)
}
