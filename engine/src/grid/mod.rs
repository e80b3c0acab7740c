//! Finite-element grids of tooth sectors and holed blanks.

pub mod level;

pub use level::GridLevel;
