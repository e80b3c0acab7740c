//! The JSON documents of the interface as types, in the units of those who read them.
//!
//! Read in this order: [`problem`] (what goes wrong), [`submission`] with its parts [`pair`], [`gear`] and
//! [`resolution`] (what is asked), [`results`] and [`tables`] (what is answered), [`job`] (its life), [`validation`],
//! [`limits`] and [`examples`]; [`solve()`] leads from the one to the other. `units`, `quantity`, `tree` and `schema`
//! carry them: conversions, the table of bounds, JSON with its places, and OpenAPI.
//!
//! This is the only place where domain data meets serde, and where mm, um, degrees, GPa and MPa meet SI.

mod quantity;
mod schema;
mod tree;
mod units;

pub mod problem;

pub mod gear;
pub mod pair;
pub mod resolution;
pub mod submission;

pub mod examples;

pub use examples::{Example, examples};
pub use problem::{Code, FieldError, Problem};
pub use submission::{SOLVER_VERSION, Submission};
