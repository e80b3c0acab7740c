//! The basic rack and the trochoid fillet that it generates.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Involute, Vector, radial, tangential};
use crate::root_finding::bisect;

/// The basic rack of a gear (ISO 53), with lengths in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rack {
    /// The module m.
    pub module: f64,
    /// The pressure angle α.
    pub pressure_angle: f64,
    /// The addendum h_a of the rack.
    pub addendum: f64,
    /// The dedendum h_f of the rack.
    pub dedendum: f64,
    /// The radius ρ of the rack's tip rounding.
    pub tip_radius: f64,
}

impl Rack {
    /// Half the flat at the rack's tip, e = π m/4 − (h_f − ρ) tan α − ρ/cos α; negative if the roundings overlap.
    pub fn half_tip_land(&self) -> f64 {
        let Self {
            module: m,
            pressure_angle: alpha,
            dedendum: h_f,
            tip_radius: rho,
            ..
        } = *self;
        PI * m / 4.0 - (h_f - rho) * alpha.tan() - rho / alpha.cos()
    }

    /// The largest tip rounding for which the tip land does not vanish.
    pub fn largest_tip_radius(&self) -> f64 {
        let (sin, cos) = self.pressure_angle.sin_cos();
        (PI * self.module / 4.0 - self.dedendum * self.pressure_angle.tan()) * cos / (1.0 - sin)
    }

    /// The depth of the end of the rack's straight flank below its reference line, h_f − ρ (1 − sin α).
    pub fn straight_depth(&self) -> f64 {
        self.dedendum - self.tip_radius * (1.0 - self.pressure_angle.sin())
    }
}

/// The fillet of tooth 0 on its loaded side: the envelope of the rack's tip rounding as the rack rolls on the
/// reference circle.
///
/// The parameter γ is the angle of the contact normal to the reference circle's tangent: it runs from α, where the
/// fillet meets the involute at the form radius, to π/2, where it meets the root circle. Where the rack undercuts the
/// flank it begins at a larger γ, at which it cuts the involute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trochoid {
    reference_radius: f64,
    space_angle: f64,
    half_tip_land: f64,
    /// The depth d of the rounding's center below the rolling line; negative at large shifts.
    center_depth: f64,
    tip_radius: f64,
    /// σ: how much longer the rack is in this section than in the one in which its rounding is round.
    stretch: f64,
    /// Where it begins.
    start: f64,
}

impl Trochoid {
    /// The fillet left by `rack`, shifted outward by `shift` (x m), on a gear of `tooth_count` teeth.
    ///
    /// A tooth that is thicker by `thickness` on the reference circle carries its fillet with its flank. The rounding is round in
    /// the `normal` section of the rack; where the rack runs across the gear's teeth at an angle it is an ellipse, longer along
    /// the rack as the modules are.
    pub fn new(rack: &Rack, normal: &Rack, tooth_count: u32, shift: f64, thickness: f64) -> Self {
        let reference_radius = rack.module * f64::from(tooth_count) / 2.0;
        let stretch = rack.module / normal.module;
        Self {
            reference_radius,
            space_angle: PI / f64::from(tooth_count) + thickness / (2.0 * reference_radius),
            half_tip_land: stretch * normal.half_tip_land(),
            center_depth: normal.dedendum - normal.tip_radius - shift,
            tip_radius: normal.tip_radius,
            stretch,
            start: rack.pressure_angle,
        }
    }

    /// The same fillet where it undercuts `flank`: it begins where it cuts the involute.
    ///
    /// The rack's straight flank goes past the base circle, and what it sweeps there folds back on the involute. The fillet goes down from the end of that
    /// fold, outside of the involute, through it and on through the base circle.
    pub(super) fn cutting(self, flank: &Involute) -> Self {
        let outside = |gamma: f64| {
            let point = self.point(gamma);
            point.y.atan2(point.x) >= flank.half_angle(point.norm())
        };
        let base = self.gamma_at(flank.base_radius());
        Self {
            start: bisect(self.start, base, outside),
            ..self
        }
    }

    /// The γ at which it comes down to `radius`.
    pub(super) fn gamma_at(&self, radius: f64) -> f64 {
        let (from, to) = self.ends();
        bisect(from, to, |gamma| self.point(gamma).norm() >= radius)
    }

    /// The values of γ at the involute and at the root circle.
    pub fn ends(&self) -> (f64, f64) {
        (self.start, FRAC_PI_2)
    }

    /// The point of the fillet at γ = `gamma`.
    pub fn point(&self, gamma: f64) -> Vector {
        let Self {
            reference_radius: r,
            space_angle,
            half_tip_land: e,
            center_depth: d,
            tip_radius: rho,
            stretch,
            ..
        } = *self;
        let (sin, cos) = gamma.sin_cos();
        // The place on the rounding, from its center, whose normal is at γ: it passes through the pitch point.
        let longer = stretch * stretch - 1.0;
        let q = (1.0 + longer * cos * cos).sqrt();
        let (beside, below) = (rho * (stretch * stretch) * cos / q, rho * sin / q);
        // The pitch point of the rolling stands at angle φ of the gear, the rounding's center a length l beside it.
        let l = -d * cos / sin + rho * longer * cos / q;
        let phi = space_angle - (l + e) / r;
        (r - d - below) * radial(phi) + (l - beside) * tangential(phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Involute;
    use crate::gear::involute::involute_function;

    #[test]
    fn the_fillet_runs_from_the_involute_at_the_form_radius_to_the_root_circle() {
        let rack = Rack {
            module: 2e-3,
            pressure_angle: 20_f64.to_radians(),
            addendum: 2e-3,
            dedendum: 2.5e-3,
            tip_radius: 0.76e-3,
        };
        // Beyond a shift of 0.87 the rounding's center runs above the rolling line.
        for (z, x) in [
            (50_u32, 0.0),
            (29, 0.3),
            (18, 0.0),
            (85, -0.2),
            (40, 0.87),
            (40, 1.1),
            (60, 1.4),
        ] {
            let shift = x * rack.module;
            let fillet = Trochoid::new(&rack, &rack, z, shift, 0.0);
            let r = rack.module * f64::from(z) / 2.0;
            let alpha = rack.pressure_angle;
            let psi_b = PI / (2.0 * f64::from(z))
                + 2.0 * x * alpha.tan() / f64::from(z)
                + involute_function(alpha);
            let flank = Involute::new(r * alpha.cos(), psi_b);
            let s_form = r * alpha.sin() - (rack.straight_depth() - shift) / alpha.sin();
            let (start, end) = fillet.ends();
            assert!(
                (fillet.point(start) - flank.point(s_form)).norm() < 1e-15,
                "the curves meet"
            );
            let step = 1e-6;
            let tangent = (fillet.point(start + step) - fillet.point(start)).normalize();
            assert!(
                tangent.dot(&flank.normal(s_form)).abs() < 1e-4,
                "and share a tangent"
            );
            assert!((fillet.point(end).norm() - (r - rack.dedendum + shift)).abs() < 1e-15);
        }
    }

    #[test]
    fn the_rolling_rack_touches_the_fillet_and_never_cuts_into_it() {
        let rack = Rack {
            module: 2e-3,
            pressure_angle: 20_f64.to_radians(),
            addendum: 2e-3,
            dedendum: 2.5e-3,
            tip_radius: 0.6e-3,
        };
        // The last two are undercut: above the corner of the flank the sweep touches nothing of the involute.
        for (z, x) in [(30_u32, 0.0), (40, 0.95), (40, 1.2), (10, 0.0), (13, -0.1)] {
            let (shift, r) = (x * rack.module, rack.module * f64::from(z) / 2.0);
            let mut fillet = Trochoid::new(&rack, &rack, z, shift, 0.0);
            let alpha = rack.pressure_angle;
            let psi_b = PI / (2.0 * f64::from(z))
                + 2.0 * x * alpha.tan() / f64::from(z)
                + involute_function(alpha);
            let flank = Involute::new(r * alpha.cos(), psi_b);
            let is_undercut = r * alpha.sin().powi(2) < rack.straight_depth() - shift;
            if is_undercut {
                fillet = fillet.cutting(&flank);
            }
            let (start, end) = fillet.ends();
            let boundary: Vec<(f64, f64)> = (0..=2000)
                .map(|i| fillet.point(start + (end - start) * f64::from(i) / 2000.0))
                .map(|point| (point.norm(), point.y.atan2(point.x)))
                .collect();
            // The center of the rounding rolls by: d below the line, half a tip land beside the middle of its space.
            let mut nearest = f64::INFINITY;
            for roll in -1500..=1500 {
                let turn = f64::from(roll) * 2e-4;
                for arc in 0..=200 {
                    let angle = FRAC_PI_2 * f64::from(arc) / 200.0;
                    let depth =
                        rack.dedendum - rack.tip_radius - shift + rack.tip_radius * angle.sin();
                    // Beside the pitch point, towards the tooth; the gear turns as the rack passes.
                    let beside = rack.half_tip_land() + rack.tip_radius * angle.cos() - r * turn;
                    let phi = PI / f64::from(z) - turn;
                    let point = (r - depth) * radial(phi) - beside * tangential(phi);
                    let (radius, theta) = (point.norm(), point.y.atan2(point.x));
                    let after = boundary.partition_point(|known| known.0 > radius);
                    if after == 0 && is_undercut {
                        nearest = nearest.min(radius * (theta - flank.half_angle(radius)));
                    }
                    if after == 0 || after == boundary.len() {
                        continue;
                    }
                    let ((r_0, t_0), (r_1, t_1)) = (boundary[after - 1], boundary[after]);
                    let edge = t_0 + (t_1 - t_0) * (radius - r_0) / (r_1 - r_0);
                    nearest = nearest.min(radius * (theta - edge));
                }
            }
            // Chords of the boundary lie beside it by less than a tenth of a micrometer; the steps of the rolling come within one
            // of touch.
            assert!(
                (-1e-7..1e-6).contains(&nearest),
                "{z} teeth, x {x}: {nearest}"
            );
        }
    }
}
