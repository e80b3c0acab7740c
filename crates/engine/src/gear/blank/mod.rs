//! The blank under the teeth: a bore on a rigid hub ring, holes, and a web.
//!
//! Read in this order: [`hole`] (one opening, round or a slot, and the ligament between two), [`contour`] (any other opening), `drawn` (regions bounded by
//! closed curves of a drawing), [`spokes`] (openings between spokes), [`region`] (bore, holes and web together), [`moments`] (their integrals), [`symmetry`]
//! (repetition of a blank around).

use std::f64::consts::PI;

pub mod contour;
mod drawn;
pub mod hole;
pub mod moments;
pub mod region;
pub mod spokes;
pub mod symmetry;

pub use contour::{Contour, ContourFault, Side};
pub use drawn::Drawn;
pub use hole::{Hole, HoleShape};
pub use moments::Moments;
pub use region::{BlankRegion, Core, Ligament, Web};
pub use spokes::{Spokes, SpokesFault};
pub use symmetry::Symmetry;

/// N equal round holes on a circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HolePattern {
    /// The number of holes N.
    pub count: u32,
    /// The radius R of the circle through their centers.
    pub circle_radius: f64,
    /// The radius r of each hole.
    pub radius: f64,
    /// The angle of hole 0 from the centerline of tooth 0, positive towards its loaded flank, in radians.
    pub phase: f64,
}

impl HolePattern {
    /// The material left between neighboring holes, 2 R sin(π/N) − 2 r; infinite for a single hole.
    pub fn ligament_between(&self) -> f64 {
        match self.count {
            0 | 1 => f64::INFINITY,
            n => 2.0 * self.circle_radius * (PI / f64::from(n)).sin() - 2.0 * self.radius,
        }
    }

    /// The largest radius that any hole reaches, R + r.
    pub fn outer_reach(&self) -> f64 {
        self.circle_radius + self.radius
    }

    /// The smallest radius that any hole reaches, R − r.
    pub fn inner_reach(&self) -> f64 {
        self.circle_radius - self.radius
    }

    /// The area N π r² that the holes remove.
    pub fn area(&self) -> f64 {
        f64::from(self.count) * PI * self.radius.powi(2)
    }

    /// The second polar moment of the removed area about the gear's center, N π r² (r²/2 + R²).
    pub fn polar_moment(&self) -> f64 {
        self.area() * (self.radius.powi(2) / 2.0 + self.circle_radius.powi(2))
    }
}
