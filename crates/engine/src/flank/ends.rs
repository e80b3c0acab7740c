//! Where a flank is no half space: it ends at the tip of its tooth and at both ends of its face.
//!
//! A tooth is a wedge at its tip, which is more compliant than a half space there: in the plane by the logarithm of the distance from the corner, (C − c) ln (x +
//! y), with Michell's compliance C of the wedge and c of the half plane ([`super::corner`] has the derivation). An image load at the same distance beyond the
//! tip, (C − c)/c as large, gives that logarithm for a long line, and for a short one its form in space.
//!
//! A face that is narrow against its teeth is a plate, which yields by the logarithm of plane stress as far as it is high, where a half space
//! under a load so narrow would have nothing to tell beyond its width b. Of loads that are even across the face the half space knows
//!
//! ```text
//! (c/b) (asinh(b/d) − √(1 + d²/b²) + d/b)
//! ```
//!
//! at the distance d, and a plate −(c/b) ln d. The difference is that of a wide face too, except for a smooth part.
//!
//! Both are subtracted from the grid's compliance and added again in the contact. Neither has to be exact: the remainder is smoother, and is fitted.

use std::f64::consts::PI;

use super::corner::tip_softness;
use crate::gear::{Material, SolidGear};

/// The distance, in modules, within which a load beyond the tip is blurred: contacts are wider.
const BLUR: f64 = 0.02;

/// Further compliance of a flank beside a half space.
#[derive(Debug, Clone)]
pub(crate) struct FlankEnds {
    base_radius: f64,
    twist: f64,
    /// 1/cos β_b.
    along: f64,
    /// The roll length of the tip.
    tip: f64,
    /// (C − c)/c (1 − ν²)/(πE).
    beyond: f64,
    blur: f64,
    /// 2/(πE b).
    plate: f64,
    face_width: f64,
    module: f64,
}

/// Distances between two lines of equal roll lengths: √((κ (Δ − Δ_0))² + (κ ε)²) at heights Δ apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines {
    /// κ.
    pub(crate) stretch: f64,
    /// Δ_0.
    pub(crate) nearest: f64,
    /// ε.
    pub(crate) reach: f64,
}

impl FlankEnds {
    pub(crate) fn new(gear: &SolidGear) -> Self {
        let section = gear.section();
        let Material {
            youngs_modulus: e,
            poisson_ratio: nu,
            ..
        } = *section.material();
        let module = gear.normal_rack().module;
        Self {
            base_radius: section.base_radius(),
            twist: gear.twist(),
            along: 1.0 / gear.base_helix_angle().cos(),
            tip: section.tip_roll_length(),
            beyond: tip_softness(section) * (1.0 - nu * nu) / (PI * e),
            blur: BLUR * module,
            plate: 2.0 / (PI * e * gear.face_width()),
            face_width: gear.face_width(),
            module,
        }
    }

    /// The distances between a point at the roll length `s` and a load at `loaded`, and the half space's factor of their inverse.
    pub(crate) fn direct(&self, s: f64, loaded: f64) -> Lines {
        let level = (s * s - loaded * loaded) / (2.0 * self.base_radius);
        let slope = self.twist * f64::midpoint(s, loaded);
        let stretch = slope.hypot(self.along);
        Lines {
            stretch,
            nearest: level * slope / (stretch * stretch),
            reach: (level * self.along).abs() / (stretch * stretch),
        }
    }

    /// The same for the image load beyond the tip, with the factor of the inverse of the distances.
    pub(crate) fn beyond_tip(&self, s: f64, loaded: f64) -> (Lines, f64) {
        let level = (s * s - loaded * loaded) / (2.0 * self.base_radius);
        let below = self.below_tip(s) + self.below_tip(loaded);
        let slope = self.twist * self.tip;
        let stretch = slope.hypot(self.along);
        let lines = Lines {
            stretch,
            nearest: level * slope / (stretch * stretch),
            reach: (below * self.along / stretch).hypot(self.blur) / stretch,
        };
        (lines, self.beyond)
    }

    /// How far a roll length is from the tip, along the flank.
    fn below_tip(&self, s: f64) -> f64 {
        (self.tip * self.tip - s * s) / (2.0 * self.base_radius)
    }

    /// Displacement at `s` by a unit force at the roll length `loaded`, even across the face, as on a plate, less that of a half space.
    pub(crate) fn of_plate(&self, s: f64, loaded: f64) -> f64 {
        let Lines { stretch, reach, .. } = self.direct(s, loaded);
        let b = self.face_width;
        let far = b.hypot(reach);
        -self.plate / stretch * (((b + far) / self.module).ln() - (far - reach) / b)
    }

    /// Displacement at the roll length `s` and the height `z` by a unit force beside that of a half space, spread over a piece of the contact line of the
    /// length `along` about the roll length and the height `loaded`.
    pub(crate) fn of_piece(&self, (s, z): (f64, f64), loaded: (f64, f64), along: f64) -> f64 {
        let (lines, factor) = self.beyond_tip(s, loaded.0);
        let slope = self.twist * self.tip;
        // The line leans against the tip, and beyond it the other way.
        let (sin, cos) = (slope / lines.stretch, self.along / lines.stretch);
        let out = (self.below_tip(s) + self.below_tip(loaded.0)) * cos;
        let beside = lines.stretch * (z - loaded.1 - lines.nearest);
        let (middle, off) = (out * sin + beside * cos, out * cos - beside * sin);
        let off = off.hypot(self.blur);
        let [to, from] = [0.5, -0.5].map(|part| ((middle + part * along) / off).asinh());
        factor * (to - from) / along + self.of_plate(s, loaded.0)
    }
}
