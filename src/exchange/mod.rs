//! What other programs read and write: look-up tables for rotor dynamics and multibody codes, and models of gearboxes in REXS.

pub mod look_up;
pub mod rexs;
