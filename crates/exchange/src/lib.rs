//! What other programs read and write: look-up tables and tables of force for rotor dynamics and multibody codes, models of gearboxes in REXS, drawings in
//! DXF, fields for viewers.
//!
//! Fields and tables are made of what the engine computes. A model becomes a submission, and a submission a model, and a drawing the outline of a blank: of
//! that document this crate knows the names.

mod digits;
pub mod divided;
pub mod dxf;
pub mod fmu;
pub mod force_table;
pub mod look_up;
pub mod rexs;
pub mod vtu;

pub use digits::significant;
