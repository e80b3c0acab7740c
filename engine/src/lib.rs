//! The mechanics.

pub mod analysis;
pub mod gear;
pub mod grid;
pub mod quadrature;
pub mod run;
