//! Files for other programs: look-up tables and tables of force for rotor dynamics and multibody codes, models of gearboxes in REXS, drawings in DXF, fields
//! for viewers.
//!
//! Fields and tables are made from the engine's results. A model becomes a submission, a submission a model, and a drawing the outline of a blank: this crate
//! knows the names of that document's fields.

mod digits;
pub mod divided;
pub mod dxf;
pub mod fmu;
pub mod force_table;
pub mod look_up;
mod piece;
pub mod rexs;
pub mod vtu;

pub use digits::significant;
