//! What handlers work with.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use axum::http::header::HeaderValue;
use meshwright_engine::analysis::Library;

use crate::jobs::{Jobs, Previews};

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
    /// How the service looks from outside.
    pub edge: Arc<Edge>,
}

/// How the service looks from outside.
#[derive(Debug, Clone, Default)]
pub struct Edge {
    /// What stands before the path in every link: nothing, or the public address without a slash at its end.
    pub public_url: String,
    /// The origins whose pages may call the service; `*` for all.
    pub cors_origins: Vec<HeaderValue>,
}
