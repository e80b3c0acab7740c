//! Shared state of the handlers.

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use meshwright_engine::library::Library;

use super::access::Access;
use super::edge::Edge;
use super::memory::BodyMemory;
use super::readings::Readings;
use super::studies::Outlines;
use crate::compute::{Files, Previews};
use crate::jobs::Jobs;
use crate::times::Times;
use crate::tokens::Tokens;
use crate::webhooks::Webhooks;

/// Shared state of the handlers.
#[derive(Clone)]
pub struct App {
    /// The jobs.
    pub jobs: Jobs,
    /// The previews.
    pub previews: Previews,
    /// The files that are computed anew from jobs.
    pub files: Files,
    /// The substructures that jobs and previews share.
    pub library: Library,
    /// The number of workers that live.
    pub workers_alive: Arc<AtomicUsize>,
    /// Where clients want messages sent.
    pub webhooks: Webhooks,
    /// Who gets in by a token, where there is an identity provider.
    pub tokens: Option<Tokens>,
    /// Who may use the service, and how much of it each may use.
    pub access: Arc<Access>,
    /// How the service looks from outside.
    pub edge: Arc<Edge>,
    /// True if this process computes jobs.
    pub computes: bool,
    /// The memory for the bodies of requests and answers.
    pub bodies: BodyMemory,
    /// Outlines of the tables that are being read.
    pub outlines: Outlines,
    /// Result of the last look at the database.
    pub readings: Arc<Readings>,
    /// Timeouts of requests.
    pub times: Times,
}
