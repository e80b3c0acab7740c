//! Geometry of the drawing: racks, flanks, teeth, their modifications and deviations, blanks and the pair.
//!
//! Read in this order: [`involute`] (one flank), [`rack`] (the tool and its fillet), [`modification`] and [`tip`] (material removed from it), [`deviation`]
//! (differences between teeth) and [`accuracy`] (their tolerances), [`blank`], [`material`], [`data`] (drawing data), [`thickness`] (ways to give the tooth
//! thickness), [`spur`], `mass` and `outline` (a whole gear), [`solid`] (the same with an extent along its axis), [`member`] and [`pair`] (two of them at a
//! center distance), [`pair_deviations`] (deviations of their teeth), [`printed`] (the last digits of a drawing), [`lead`] and [`solid_pair`] (two of them
//! along their faces).
//!
//! Every gear is described in its own frame: the center of the gear is the origin, the centerline of tooth 0 is the
//! x axis, and the loaded flank of each tooth lies on its counter-clockwise side.

pub mod accuracy;
mod backlash;
pub mod blank;
pub mod data;
pub mod deviation;
pub mod involute;
pub mod lead;
mod mass;
pub mod material;
pub mod member;
pub mod modification;
mod outline;
pub mod pair;
pub mod pair_deviations;
pub mod printed;
pub mod rack;
pub mod solid;
pub mod solid_pair;
pub mod spur;
pub mod thickness;
pub mod tip;

pub use accuracy::{Inspection, Normals, Passed, Tolerances};
pub use blank::{
    BlankRegion, Contour, ContourFault, Core, Drawn, Hole, HolePattern, HoleShape, Ligament,
    Moments, Side, Spokes, SpokesFault, Symmetry, Web,
};
pub use data::{DeviationList, GearData, GearError, ToolDepth};
pub use deviation::{Eccentricity, ToothDeviations, ToothLeads, ToothProfiles};
pub use involute::{Involute, involute_function};
pub use lead::{FaceEnds, LeadError, LeadModification};
pub use material::{Material, PlaneState};
pub use member::{Member, teeth_on};
pub use modification::{
    ModificationData, Relief, ReliefData, ReliefShape, ReliefStart, TablePlaces,
};
pub use pair::{DeviationsError, GearPair, GearPairError};
pub(crate) use pair_deviations::Trace;
pub use pair_deviations::{FlankGrowth, GearDeviations, PairDeviations};
pub use rack::{Protuberance, Rack};
pub use solid::{Hand, Helix, Hub, Layer, SolidGear, SolidGearError};
pub use solid_pair::{Alignment, ContactLine, SolidPair, SolidPairError};
pub use spur::SpurGear;
pub use thickness::{MeasuredTeeth, Thickness};
pub use tip::TipEdge;

/// A point or vector of the plane, in meters.
pub type Vector = nalgebra::Vector2<f64>;

/// The unit vector e_r at polar angle `angle`.
pub fn radial(angle: f64) -> Vector {
    Vector::new(angle.cos(), angle.sin())
}

/// The unit vector e_t at polar angle `angle`, a quarter turn counter-clockwise of [`radial`].
pub fn tangential(angle: f64) -> Vector {
    Vector::new(-angle.sin(), angle.cos())
}

/// `vector` turned by `angle` counter-clockwise.
pub(crate) fn turned(vector: Vector, angle: f64) -> Vector {
    vector.x * radial(angle) + vector.y * tangential(angle)
}

/// The greatest common divisor.
pub(crate) fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
