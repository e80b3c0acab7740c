//! The mechanics.
