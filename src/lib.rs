//! The service around the mechanics: documents, jobs and HTTP.
//!
//! The parts, in reading order; each knows only those above it. `serve` puts them together, and `commands` has the commands of the program.

mod client;
mod machine;
mod mark;
mod runtime;
#[cfg(test)]
mod testing;
pub mod times;

pub mod spans;

pub mod compute;

pub mod jobs;

pub mod webhooks;

pub mod keys;

pub mod tokens;

pub mod http;

pub mod config;

pub mod serve;

pub mod commands;

pub use client::client;
