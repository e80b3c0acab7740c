//! Searches for the best of many designs, as numbers: which designs to compute next, and which of those computed is best.
//!
//! A design is a point of a unit cube, one axis for each variable; read [`space`] first. Its result is an [`outcome::Outcome`], by which designs are compared;
//! [`driver`] asks for one generation of designs after the other, by `cmaes` for one goal and by `evolution` for two. It knows neither gears nor JSON.
//!
//! A search is a function of its seed and of the outcomes that it is given, in their order. A new one that is given the same outcomes
//! asks for the same designs, so that only the outcomes are stored.

mod chance;
mod cmaes;
pub mod driver;
mod evolution;
pub mod outcome;
pub mod space;
#[cfg(test)]
mod tests;
