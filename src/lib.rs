//! The service.

pub mod wire;
