//! Substructures of gears by themselves: the names that tests, benchmarks and examples outside this crate state mechanics on.
//!
//! The rooms they stand in are private. Other crates need none of these: they call [`crate::analysis`].

pub use crate::assembly::blank::blank_grid;
pub use crate::assembly::interface::{default_interface_radius, harmonics, orders_of_blank};
pub use crate::fem::FemError;
pub use crate::fem::Followers;
pub use crate::fem::axial::AxialBasis;
pub use crate::fem::condensation::{Condensed, condense};
pub use crate::fem::divided::DividedPrism;
pub use crate::fem::element::{ElementStiffness, stiffness as element_stiffness};
pub use crate::fem::prescribed::{Load, displacements};
pub use crate::fem::prism::{Interface, Prism};
pub use crate::fem::recovery::{Functional, edge_stresses};
pub use crate::fem::surface::SurfaceStress;
pub use crate::flank::half_plane::{hertz, logarithm_factor};
pub use crate::flank::table::FlankTable;
pub use crate::ring::annulus::Imposed;
pub use crate::ring::axes::tooth_angle;
pub use crate::ring::blank::BlankSubstructure;
pub use crate::ring::body::Coupling;
pub use crate::ring::cyclic::{Component, Harmonics};
pub use crate::ring::motion::InterfaceMotion;
pub use crate::ring::plain::PlainGear;
pub use crate::ring::solid::joint::trace;
pub use crate::ring::solid::revolution::Revolution;
pub use crate::ring::solid::web::HoledRing;
pub use crate::ring::teeth::{FARTHEST_COUPLED, TeethRing};
pub use crate::ring::teeth_recovery::TeethRecovery;
pub use crate::ring::tooth::{ToothSubstructure, modal_loads};
pub use crate::touch::gap_profile::GapProfile;
