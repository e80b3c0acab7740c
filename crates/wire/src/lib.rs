//! The JSON documents of the interface as types, in the units of those who read them.
//!
//! Read in this order: [`problem`] (errors), [`submission`] with its parts [`pair`], [`gear`] and [`resolution`], [`forces`] and [`modes`] (the request),
//! [`materials`] by their names; [`geometry`], [`outline`], [`edges`], [`contact_pattern`], [`warning`], [`results`] and `rexs` (the answer),
//! [`solve`](mod@solve) (from the one to the other) and [`examples`](mod@examples); [`preview`], a submission that is answered at once; [`draw`], teeth at
//! random. [`declare`], [`units`], [`size`], `edit` and [`mod@pointer`] support them: the one declaration of each object, conversions, limits of size, changes in
//! place, and places in a submission. Many submissions at once are the crate `studies`, which knows this one.
//!
//! This is the only place where domain data meets serde, and where mm, um, degrees, GPa and MPa meet SI.

pub mod csv;
pub mod declare;
mod edit;
pub mod hash;
pub mod pointer;
pub mod size;
pub mod testing;
pub mod units;

mod kept;
pub mod problem;

pub mod forces;
pub mod gear;
mod gear_name;
mod interface;
pub mod materials;
pub mod modes;
pub mod pair;
pub mod resolution;
pub mod running;
pub mod submission;

pub mod contact_pattern;
pub mod edges;
pub mod geometry;
pub mod outline;
pub mod results;
mod rexs;
pub mod warning;

pub mod examples;
mod memory;
pub mod solve;

pub mod draw;
pub mod preview;

pub use contact_pattern::ContactPatternDocument;
pub use draw::{Draw, DrawnDeviations};
pub use edges::LoadedEdges;
pub use examples::{Example, examples};
pub use memory::{is_plain, memory_above, memory_is_within, memory_of, too_much_memory};
pub use meshwright_state::{Kept, Status};
pub use outline::PairOutline;
pub use preview::Preview;
pub use problem::{Code, FieldError, Problem};
pub use resolution::methods;
pub use results::Results;
pub use rexs::model_of;
pub use solve::{Limits, Validation, solve, validate};
pub use submission::{DOCUMENT_VERSION, SOLVER_VERSION, Submission, method_schema};
