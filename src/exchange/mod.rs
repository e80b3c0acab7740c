//! What other programs read and write: look-up tables for rotor dynamics and multibody codes.

pub mod look_up;
