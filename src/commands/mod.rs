//! The commands of the command line.

pub(crate) mod backup;
mod chart;
mod demo;
mod document;
pub(crate) mod health;
pub(crate) mod keys;
pub(crate) mod migrate;
pub(crate) mod rexs;
pub(crate) mod serve;
pub(crate) mod solve;
pub(crate) mod study;
