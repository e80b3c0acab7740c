//! What other programs read and write: look-up tables and tables of force for rotor dynamics and multibody codes, models of gearboxes in REXS, fields for
//! viewers.

pub mod fmu;
pub mod force_table;
pub mod look_up;
pub mod rexs;
pub mod vtu;
