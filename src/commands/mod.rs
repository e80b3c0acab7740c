//! The commands of the command line.

mod chart;
mod demo;
pub(crate) mod health;
pub(crate) mod measure;
pub(crate) mod plot;
pub(crate) mod reproduce;
pub(crate) mod serve;
pub(crate) mod solve;
pub(crate) mod study;
