//! The jobs over HTTP. A handler takes a document, hands it on, and answers; all work is done below.
//!
//! In reading order: what handlers work with; the router and its layers; how errors become problem documents; what requests are made of
//! (body, client, parameters, preferences); what answers are made of (entity tags, the view of a job); the handlers.

mod app;
mod client;
mod conditional;
mod docs;
mod document;
mod events;
mod health;
mod jobs;
mod metrics;
mod parameters;
mod prefer;
mod previews;
mod problem;
mod problem_pages;
mod reference;
mod results;
mod router;
mod studies;
mod submit;
mod tables;
mod view;

pub use app::{App, Edge};
pub use docs::openapi;
pub use router::router;
