//! Where a flank is no half space: it ends at the tip of its tooth and at both ends of its face.
//!
//! A tooth is a wedge at its tip, which is more compliant than a half space there: in the plane by the logarithm of the distance from the corner, (C − c) ln (x +
//! y), with Michell's compliance C of the wedge and c of the half plane ([`super::corner`] has the derivation). An image load at the same distance beyond the
//! tip, (C − c)/c as large, gives that logarithm for a long line, and for a short one its form in space.
//!
//! A half space with images beyond both ends of the face ([`super::images`]) has under even loads the logarithm of plane strain at all distances. Between
//! free ends the stress along the axis, ν (σ_x + σ_y) in plane strain, is missing. Under the pressure p cos kx it is 2 ν p e^(−ky) cos kx at the depth y. Its
//! release at both ends, of each as of a half space, adds 32/(3π) (1 − ν²) ν²/(k b) of plane stress, as long as the waves are short against the width b.
//! Under long waves all of ν² of plane stress is added. Both hold for a line of the compliance
//!
//! ```text
//! −(ν² c/b) (ln(B + √(B² + d²)) − √(1 + d²/B²) + d/B),   B = 3 b/(16 (1 − ν²))
//! ```
//!
//! at the distance d beside the logarithm, with the c of plane stress.
//!
//! All are subtracted from the grid's compliance and added again in the contact. None has to be exact: the remainder is smoother, and is fitted.

use std::f64::consts::PI;

use super::corner::tip_softness;
use super::images::{Images, inverse_in_the_mean};
use crate::gear::{Material, SolidGear};

/// The distance, in modules, within which a load beyond the tip is blurred: contacts are wider.
const BLUR: f64 = 0.02;

/// B (1 − ν²)/b: how near a load on a plate the stress along the axis begins to be missing.
const RELIEVED: f64 = 3.0 / 16.0;

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
    /// 2 ν²/(πE b).
    plate: f64,
    /// The distance B.
    relieved: f64,
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
            plate: 2.0 * nu * nu / (PI * e * gear.face_width()),
            relieved: RELIEVED / (1.0 - nu * nu) * gear.face_width(),
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

    /// The images of a load beyond both ends of the face.
    pub(crate) fn images(&self) -> Images {
        Images {
            length: self.face_width * self.along,
            module: self.module,
        }
    }

    /// The inverse distances of a point, a roll length and a height from the middle of the face, from all images of another one.
    pub(crate) fn beyond_face(&self, (s, z): (f64, f64), loaded: (f64, f64)) -> f64 {
        let level = (s * s - loaded.0 * loaded.0) / (2.0 * self.base_radius);
        let beside = level - self.twist * f64::midpoint(s, loaded.0) * (z - loaded.1);
        let [direct, mirrored] = [z - loaded.1, z + loaded.1].map(|apart| apart * self.along);
        let images = self.images();
        let own = |at: &f64| *at != 0.0;
        let near = images.direct().filter(own).map(|at| direct + at);
        let near = near.chain(images.mirrored().map(|at| mirrored + at));
        let near: f64 = near.map(|apart| apart.hypot(beside).recip()).sum();
        near + images.beyond_direct(direct, beside) + images.beyond_mirrored(mirrored, beside)
    }

    /// Displacement at `s` by a unit force at the roll length `loaded`, even across the face, as on a plate, less that of plane strain.
    pub(crate) fn of_plate(&self, s: f64, loaded: f64) -> f64 {
        let Lines { stretch, reach, .. } = self.direct(s, loaded);
        let from = self.relieved;
        let far = from.hypot(reach);
        -self.plate / stretch * (((from + far) / self.module).ln() - (far - reach) / from)
    }

    /// Displacement of a piece of a contact line, in the mean, by a unit force spread over another piece, beside that of a half space with images. Both have the
    /// length `along`; the first is about the roll length `s` and the height `z`, the other about those of `loaded`.
    pub(crate) fn of_pieces(&self, (s, z): (f64, f64), loaded: (f64, f64), along: f64) -> f64 {
        let (lines, factor) = self.beyond_tip(s, loaded.0);
        // The line leans against the tip, and its image the other way: pieces of both move apart as their projections on the tip do.
        let cos = self.along / lines.stretch;
        let out = (self.below_tip(s) + self.below_tip(loaded.0)) * cos;
        let beside = lines.stretch * (z - loaded.1 - lines.nearest);
        let inverse = inverse_in_the_mean(along * cos, beside, out.hypot(self.blur));
        factor * inverse + self.of_plate(s, loaded.0)
    }
}
