//! Frictionless contact between the flanks of two gears.
//!
//! In reading order:
//! - `patch`: cells about the places where flanks are nearest (`touch` finds them),
//! - `pair_cells`: the cells of one pair, as drawn, and their compliance (`flank`),
//! - `drawn` and `memo`: stored data of flanks as drawn, for any support of the teeth,
//! - `coupled`: common compliance of teeth, on cells and on slices,
//! - `compliances` and `factor`: stored data of pairs made to one drawing, for any deviations of their teeth,
//! - `facings` and `cells`: the pairs that come near with the deviations of the teeth that stand there, and the cells of all of them; H on them, and the
//!   summary of their solution,
//! - `mesh_phase`: one fraction of the mesh period, from placing the cells to a solution that nothing penetrates,
//! - `light`: its limit as the load vanishes,
//! - `pressures`: the contact of each pair in plane strain, and `peak`: the place of the largest pressure; `mesh_contact`: the summary of a solved contact,
//! - `checked` and `penetration`: the check of the whole flanks that proves that nothing penetrates; `contradiction`: the checks of a solution against its own
//!   evidence,
//! - [`positions`]: many positions of one load, in parallel,
//! - [`face`]: the same along faces of helical, misaligned or uneven gears, slice by slice,
//! - `model`: the model of a pair on which all of this works,
//! - [`ContactProblem`]: compliance, gaps and arms; and [`ContactSolution`]: forces, delta, stiffness, residuals,
//! - [`solve_active_set`]: the exact solver, for every position of a mesh,
//! - [`solve_augmented_lagrangian`]: the method of the paper (eq. 7), for comparison.
//!
//! With the forces p at the candidate points, the compliance H of both gears, the gaps g_0 before loading and the
//! arms w, the transmission error delta under the load F follows from the Signorini conditions (eqs. 4 to 6):
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
pub(crate) mod cells;
mod checked;
pub(crate) mod compliances;
mod contradiction;
mod coupled;
pub(crate) mod drawn;
pub mod face;
mod facings;
mod factor;
mod light;
mod memo;
pub(crate) mod mesh_contact;
pub(crate) mod mesh_phase;
pub(crate) mod model;
pub(crate) mod pair_cells;
pub(crate) mod patch;
mod peak;
mod penetration;
pub mod positions;
mod pressures;
mod problem;

pub use active_set::solve_active_set;
pub use augmented_lagrangian::{AugmentedLagrangian, default_penalty, solve_augmented_lagrangian};
pub use cells::ContactCells;
pub use contradiction::Contradiction;
pub(crate) use coupled::add_yielded;
pub use light::light_contact;
pub use mesh_contact::{FlankLoad, MeshCells, MeshContact, PairContact, PairLoads};
pub use mesh_phase::MeshPhase;
pub use model::{ContactSolver, DeviatingPair, GearModel, PairModel, PositionError, WarmStart};
pub use peak::PeakPlace;
pub use problem::{ContactError, ContactProblem, ContactQuantity, ContactSolution};
