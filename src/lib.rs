//! The service around the mechanics: documents, jobs and HTTP.
//!
//! The parts, in the order to read them; each knows only those above it.

pub mod wire;

pub mod jobs;
