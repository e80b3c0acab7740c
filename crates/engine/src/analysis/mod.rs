//! From a pair to its curves: the methods, their results and spectra.
//!
//! Read in this order:
//! - [`case`] (request), `plan` (what is to be computed), `analyze` (execution of the plan), `estimate` (its cost);
//! - `under_load` (the common part of all methods, torque by torque), `found` (their results at some positions), `setup` and `pair_contacts` (the basis of
//!   methods by finite elements);
//! - `flexible`, `decomposition`, `projected`, `three_dimensional` and `load_distribution` (the methods), `first_order` (effect of holes, in the plane and
//!   along faces) and `checks` (comparison of it with exact solutions), [`hole_phase`] and `hole_turns` (best turn of the holes of both gears), `light` (torque
//!   0, the same for all), [`running`] and `spun_pair` (pairs that turn, are warm, and are pressed onto shafts);
//! - [`stress`] (at roots and holes; along faces `face_stress`), [`fields`] (everywhere; along faces [`face_fields`]), [`contact_pattern`] (over the flanks);
//! - `between` (a curve between its positions), `curve_parts` and [`curve`] with [`load_share`], `curve_point` and its `statistics`, [`largest_where`] (places of its largest
//!   values), [`pressures`] (their summary), [`spectrum`] and [`single_flank`] with the `long_wave`; `windows` (stretches of a true period that is too long),
//!   [`mesh_wave`] and `pair_springs` (their estimate of the mesh orders);
//! - [`evidence`], [`warning`], [`error`] and `answer` (results); [`forces`] (tables of force), [`at_speed`] (motion), [`rotors`] (gear bodies in torsion),
//!   [`blank_modes`] (natural modes of both gears).

mod analyze;
mod answer;
pub mod at_speed;
mod between;
pub mod blank_modes;
pub mod case;
mod checks;
pub mod contact_pattern;
mod cost;
pub mod curve;
mod curve_parts;
mod curve_point;
mod decomposition;
pub mod error;
mod estimate;
pub mod evidence;
pub mod face_fields;
mod face_stress;
pub mod fields;
mod first_order;
mod flexible;
pub mod forces;
mod found;
pub mod hole_phase;
mod hole_turns;
pub mod largest_where;
mod light;
mod load_distribution;
pub mod load_share;
mod long_wave;
pub mod mesh_wave;
mod orders;
mod pair_contacts;
mod pair_springs;
mod plan;
pub mod pressures;
mod projected;
pub mod rotors;
pub mod running;
mod setup;
pub mod single_flank;
pub mod spectrum;
mod spun_pair;
mod statistics;
pub mod stress;
mod three_dimensional;
mod turned_pair;
mod under_load;
pub mod warning;
mod windows;

pub use analyze::{analyze, pair_model};
pub use answer::Analysis;
pub use case::{Case, FaceHoles, Faces, Method, Model, Resolution, SectionHoles, StiffnessRule};
pub use cost::{Estimate, PartCost};
pub use curve::{Curve, FaceLoad};
pub use error::AnalysisError;
pub use estimate::estimate;
pub use evidence::{ErrorEstimate, Evidence};
pub use orders::{OrderCause, OrderKind, mesh_label};
pub use running::RotationSpeed;
pub use statistics::{SamplingError, Statistics};
pub use warning::{FEW_POSITIONS, PLANE_RIM, PLANE_WEB, Warning, warnings};
pub use windows::windows_at_largest_steps;

pub use crate::contact::ContactSolver;
pub use crate::gear::PlaneState;
pub use crate::load_distribution::{
    BodyFormula, Formula, FormulaQuantity, FormulaRange, Formulas, ToothFormula,
};
