//! The commands of the command line.

pub(crate) mod solve;
