//! The mechanics.

pub mod run;
