//! Many designs at once: studies, populations and searches, their tables, and the numbers behind them.
//!
//! Read in this order. The numbers: [`sample`] (members drawn from laws, and estimates from a sample with their confidence) and [`optimum`] (choice of the next
//! points of a cube); neither knows gears or JSON. Then [`table`], the quantities that designs are compared by. The documents: `population`, `search` and
//! [`study`], which holds one of them or lists its designs. Last the statistics of a study's rows: [`population_results`] and [`searching`]. [`refusals`]
//! counts the designs without results.

pub mod optimum;
pub mod sample;

pub mod refusals;
pub mod table;

mod population;
mod search;
pub mod study;

pub mod population_results;
pub mod searching;

#[cfg(test)]
mod testing;

pub use population_results::{PopulationResults, PopulationSample};
pub use searching::{SearchState, Searching};
pub use study::{Design, Study};
pub use table::{RowState, StudyResults, Summary};

/// The most designs of a study.
pub const MOST_DESIGNS: usize = 100_000;
