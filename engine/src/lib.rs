//! The mechanics.

pub mod analysis;
pub mod contact;
pub mod fem;
pub mod gear;
pub mod grid;
pub mod quadrature;
pub mod run;
