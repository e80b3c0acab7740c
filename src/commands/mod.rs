//! The commands of the command line.

pub(crate) mod plot;
pub(crate) mod reproduce;
pub(crate) mod solve;
