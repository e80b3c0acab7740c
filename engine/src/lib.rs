//! The mechanics.

pub mod analysis;
