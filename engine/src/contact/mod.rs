//! Frictionless contact between two flanks, condensed to the cells where they may touch.
//!
//! In reading order:
//! - [`patch`]: where flanks come near each other, and their gaps, from the true geometry,
//! - [`flank`] and [`half_plane`]: the compliance of the cells, smooth part and logarithm,
//! - [`ContactProblem`]: compliance, gaps and arms; and [`ContactSolution`]: forces, approach, stiffness, residuals,
//! - [`solve_active_set`]: the exact solver, for every position of a mesh,
//! - [`solve_augmented_lagrangian`]: the method of the paper (eq. 7), for comparison.
//!
//! With the forces p at the candidate points, the compliance H of both gears, the gaps g_0 before loading and the
//! arms w, the approach delta under the load F follows from the Signorini conditions (eqs. 4 to 6):
//!
//! ```text
//! g = H p + g_0 - delta w >= 0,   p >= 0,   p_j g_j = 0,   w^T p = F
//! ```
//!
//! These are the optimality conditions of: minimize 1/2 p^T H p + g_0^T p subject to w^T p = F, p >= 0; delta is the
//! multiplier of the load. As H is positive definite there is exactly one solution. (Eq. 5 prints the gap with the
//! signs of H p and delta mixed; eq. 4 has them as here.)
//!
//! The two solvers share the problem and the form of the answer, nothing else: their agreement is a proof of both.

mod active_set;
mod augmented_lagrangian;
pub mod flank;
pub mod half_plane;
pub mod patch;
mod problem;

pub use active_set::solve_active_set;
pub use augmented_lagrangian::{AugmentedLagrangian, solve_augmented_lagrangian};
pub use problem::{ContactError, ContactProblem, ContactQuantity, ContactSolution};
