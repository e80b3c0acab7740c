//! The jobs over HTTP. A handler takes a document, hands it on, and answers; all work is done below.
//!
//! In reading order: the shared state of handlers; the router and its layers; authentication; problem documents; parts of requests (body, client, parameters,
//! preferences); parts of answers (bodies and headers, entity tags, compression, pages, the view of a job); the handlers.

#![warn(clippy::disallowed_methods)]

mod access;
mod answer;
mod app;
mod batch;
mod blocking;
mod body;
mod campbell;
mod client;
mod contact_pattern;
mod contract;
mod credential;
mod curve_columns;
mod docs;
mod draw;
mod edge;
mod events;
mod faults;
mod fields;
mod guides;
mod headers;
mod health;
mod jobs;
mod listed_files;
mod memory;
mod metrics;
mod mode_shapes;
mod outline;
mod packing;
mod page;
mod parameters;
mod pictures;
mod prefer;
mod previews;
mod problem;
mod problem_pages;
mod projects;
mod queries;
mod readings;
mod reference;
mod resource;
mod results;
mod rexs;
mod router;
mod shares;
mod static_files;
mod studies;
mod submit;
mod tables;
mod usage;
mod view;
mod web;
mod webhooks;

pub use access::{Access, AccessRules, KeysRule};
pub use app::App;
pub use edge::Edge;
pub use memory::BodyMemory;
pub use readings::Readings;
pub use router::{openapi, router, router_of_metrics};
pub use studies::Outlines;
