//! What handlers work with.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use axum::http::header::HeaderValue;
use meshwright_engine::library::Library;

use super::door::Door;
use super::health::Readings;
use crate::jobs::{Budget, Jobs, Previews};
use crate::tokens::Tokens;
use crate::webhooks::Webhooks;

/// What handlers work with.
#[derive(Clone)]
pub struct App {
    /// The jobs.
    pub jobs: Jobs,
    /// The previews.
    pub previews: Previews,
    /// The substructures that jobs and previews share.
    pub library: Library,
    /// The number of workers that live.
    pub workers_alive: Arc<AtomicUsize>,
    /// Where clients are told.
    pub webhooks: Webhooks,
    /// Who gets in by a token, where there is an identity provider.
    pub tokens: Option<Tokens>,
    /// Who gets in, and how much of the service each gets.
    pub door: Arc<Door>,
    /// How the service looks from outside.
    pub edge: Arc<Edge>,
    /// Whether this process computes jobs.
    pub computes: bool,
    /// The memory for what is sent, while it is read, in bytes.
    pub reading: Budget,
    /// What the last look at the database said.
    pub readings: Arc<Readings>,
}

/// How the service looks from outside.
#[derive(Debug, Clone, Default)]
pub struct Edge {
    /// What stands before the path in every link: nothing, or the public address without a slash at its end.
    pub public_url: String,
    /// The origins whose pages may call the service; `*` for all.
    pub cors_origins: Vec<HeaderValue>,
    /// Whether keys are needed from the start, for the OpenAPI document.
    pub asks_for_keys: bool,
    /// Whose tokens open the door as keys do, for the same.
    pub issuer: Option<String>,
    /// Whether the numbers of the service are served beside everything else.
    pub metrics_here: bool,
}
