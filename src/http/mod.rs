//! The jobs over HTTP. A handler takes a document, hands it on, and answers; all work is done below.
//!
//! In reading order: what handlers work with; how connections are served (who is there, what they give of their requests and take of their
//! answers);
//! the router and its layers; who gets in; how errors become problem documents; what requests are made of (body, client,
//! parameters, preferences); what answers are made of (bodies and headers, entity tags, packing, pages, the view of a job); the handlers.

mod answer;
mod app;
mod aside;
mod batch;
mod client;
mod conditional;
mod contact_pattern;
mod credential;
mod docs;
mod document;
mod door;
mod draw;
mod edge;
mod events;
mod fields;
mod giving;
mod guests;
mod guides;
mod headers;
mod health;
mod jobs;
mod memory;
mod metrics;
mod outline;
mod packing;
mod page;
mod parameters;
mod pictures;
mod prefer;
mod previews;
mod problem;
mod problem_pages;
mod readings;
mod reference;
mod results;
mod rexs;
mod router;
mod server;
mod standing;
mod strangers;
mod studies;
mod submit;
mod tables;
mod taking;
mod view;
mod web;
mod webhooks;

pub use app::App;
pub use door::{Door, DoorRules, KeysRule};
pub use edge::Edge;
pub use memory::ReadingMemory;
pub use readings::Readings;
pub use router::{openapi, router, router_of_metrics};
pub use server::{Bounds, Server};
