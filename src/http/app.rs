//! What handlers work with.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use meshwright_engine::library::Library;

use super::door::Door;
use super::edge::Edge;
use super::memory::ReadingMemory;
use super::readings::Readings;
use crate::compute::Previews;
use crate::jobs::Jobs;
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
    /// The memory for what is sent.
    pub reading: ReadingMemory,
    /// What the last look at the database said.
    pub readings: Arc<Readings>,
}
