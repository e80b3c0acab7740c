//! What the mechanics must show: agreement with closed forms and with itself. `tests/reference` of the repository has its agreement with
//! an independent solver and with the paper.
//!
//! Read in this order: [`closed_forms`], [`convergence`] (of grid, cells and positions), [`patch`], [`blanks`], [`uncondensed`],
//! [`divided`] and [`inside`] (the substructures, their coupling and the stresses within them), [`stress`] and [`fields`], [`undercut`], [`invariants`] and
//! [`robustness`]. [`support`] makes the gears, [`whole`] assembles a gear without any condensation.

mod blanks;
mod closed_forms;
mod convergence;
mod divided;
mod fields;
mod inside;
mod invariants;
mod patch;
mod robustness;
mod stress;
mod support;
mod uncondensed;
mod undercut;
mod whole;
