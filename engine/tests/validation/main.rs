//! What the mechanics must show: agreement with an independent solver, with the paper, with closed forms and with itself.
//!
//! Read in this order: [`calculix`] and [`paper`] (other people's numbers), [`closed_forms`], [`convergence`] (of grid,
//! cells and positions), [`patch`], [`blanks`], [`uncondensed`] and [`inside`] (the substructures, their coupling and the
//! stresses within them), [`invariants`] and
//! [`robustness`]. [`support`] makes the gears, [`whole`] assembles a gear without any condensation.

mod blanks;
mod calculix;
mod closed_forms;
mod convergence;
mod fields;
mod inside;
mod invariants;
mod paper;
mod patch;
mod robustness;
mod stress;
mod support;
mod uncondensed;
mod whole;
