//! What other programs read and write: look-up tables for rotor dynamics and multibody codes, fields for viewers.

pub mod look_up;
pub mod vtu;
