//! What the drawing says: racks, flanks, teeth, reliefs, blanks and the pair they make.
//!
//! Read in this order: [`involute`] (one flank), [`rack`] (the tool and the fillet it leaves), [`relief`], [`blank`],
//! [`material`], [`spur`] (a whole gear), [`pair`] (two of them at a center distance).
//!
//! Every gear is described in its own frame: the center of the gear is the origin, the centerline of tooth 0 is the
//! x axis, and the loaded flank of each tooth lies on its counter-clockwise side.

pub mod blank;
pub mod involute;
pub mod material;
pub mod pair;
pub mod rack;
pub mod relief;
pub mod spur;

pub use blank::{
    Blank, BlankRegion, Hole, HolePattern, HoleShape, Ligament, Moments, Symmetry, Web,
};
pub use involute::Involute;
pub use material::{Material, PlaneState};
pub use pair::{GearPair, GearPairError, Member};
pub use rack::Rack;
pub use relief::{ReliefShape, ReliefStart, TipRelief};
pub use spur::{GearData, GearError, ReliefData, SpurGear};

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

/// The greatest common divisor: a turn that two counts divide evenly repeats so many times.
pub(crate) fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
