//! The service around the mechanics: documents, jobs and HTTP.
//!
//! The parts, in the order to read them; each knows only those above it, and `serve` puts them together.

pub mod wire;

pub mod jobs;

pub mod http;

pub mod config;

pub mod serve;
