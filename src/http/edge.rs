//! How the service looks from outside.

use axum::http::header::HeaderValue;

/// How the service looks from outside.
#[derive(Debug, Clone, Default)]
pub struct Edge {
    /// Prefix of the path in every link: empty, or the public address without a slash at its end.
    pub public_url: String,
    /// The origins whose pages may call the service; `*` for all.
    pub cors_origins: Vec<HeaderValue>,
    /// True if keys are needed from the start, for the OpenAPI document.
    pub asks_for_keys: bool,
    /// Whose tokens are accepted beside keys, for the same.
    pub issuer: Option<String>,
    /// True if the metrics are served at the same address as everything else.
    pub metrics_here: bool,
}
