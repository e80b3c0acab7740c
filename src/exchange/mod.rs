//! What other programs read and write: look-up tables for rotor dynamics and multibody codes, models of gearboxes in REXS, fields for
//! viewers.

pub mod look_up;
pub mod rexs;
pub mod vtu;
