//! The involute of a base circle, by its roll length.

use super::{Vector, radial, tangential};

/// inv(α) = tan α − α.
pub fn involute_function(angle: f64) -> f64 {
    angle.tan() - angle
}

/// The loaded involute flank of tooth 0, in the frame of its gear.
///
/// The point at roll length s has its tangent point on the base circle at the angle t = ψ_b − s/r_b; it stands at
/// r_b e_r(t) + s e_t(t) and its outward normal is e_t(t).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Involute {
    base_radius: f64,
    base_half_angle: f64,
}

impl Involute {
    /// The flank over the base radius r_b whose tooth has the half angle ψ_b at the base circle.
    pub fn new(base_radius: f64, base_half_angle: f64) -> Self {
        Self {
            base_radius,
            base_half_angle,
        }
    }

    /// The base radius r_b.
    pub fn base_radius(&self) -> f64 {
        self.base_radius
    }

    /// The half angle ψ_b of the tooth at the base circle.
    pub fn base_half_angle(&self) -> f64 {
        self.base_half_angle
    }

    /// The angle t of the tangent point that belongs to roll length `s`.
    pub fn tangent_angle(&self, s: f64) -> f64 {
        self.base_half_angle - s / self.base_radius
    }

    /// The point at roll length `s`.
    pub fn point(&self, s: f64) -> Vector {
        let t = self.tangent_angle(s);
        self.base_radius * radial(t) + s * tangential(t)
    }

    /// The outward unit normal at roll length `s`.
    pub fn normal(&self, s: f64) -> Vector {
        tangential(self.tangent_angle(s))
    }

    /// The radius at roll length `s`.
    pub fn radius(&self, s: f64) -> f64 {
        // Lengths of a gear neither overflow nor vanish when squared.
        (self.base_radius * self.base_radius + s * s).sqrt()
    }

    /// The roll length at `radius`, zero on and below the base circle.
    pub fn roll_length(&self, radius: f64) -> f64 {
        (radius.powi(2) - self.base_radius.powi(2)).max(0.0).sqrt()
    }

    /// The half angle of the tooth at `radius`, negative past the point where its flanks cross.
    pub fn half_angle(&self, radius: f64) -> f64 {
        let s = self.roll_length(radius);
        self.base_half_angle - (s / self.base_radius - (s / self.base_radius).atan())
    }

    /// The length of the flank from the base circle to roll length `s`: s²/(2 r_b).
    pub fn arc_length(&self, s: f64) -> f64 {
        s * s / (2.0 * self.base_radius)
    }

    /// The roll length at which the flank is `arc` long from the base circle, zero below it.
    pub fn roll_length_at_arc(&self, arc: f64) -> f64 {
        (2.0 * self.base_radius * arc).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flank_point_lies_one_roll_length_from_its_tangent_point_and_the_normal_is_normal() {
        let flank = Involute::new(46.98463e-3, 0.0463);
        for s in [5e-3, 12e-3, 22e-3] {
            let (p, t) = (flank.point(s), flank.tangent_angle(s));
            assert!(((p - 46.98463e-3 * radial(t)).norm() - s).abs() < 1e-15);
            let step = 1e-7;
            let tangent = (flank.point(s + step) - flank.point(s - step)) / (2.0 * step);
            assert!(
                tangent.dot(&flank.normal(s)).abs() < 1e-9,
                "the normal is orthogonal to a central difference"
            );
            assert!(
                (tangent.norm() - s / 46.98463e-3).abs() < 1e-8,
                "d(arc)/ds = s/r_b"
            );
            assert!((flank.roll_length_at_arc(flank.arc_length(s)) - s).abs() < 1e-15);
        }
    }
}
