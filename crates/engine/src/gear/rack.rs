//! The basic rack and the trochoid fillet that it generates.

use std::f64::consts::{FRAC_PI_2, PI};

use super::{Involute, Vector, involute_function, radial, tangential};
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
    /// Protuberance, if it is the profile of a hob before grinding.
    pub protuberance: Option<Protuberance>,
}

impl Rack {
    /// Profile A of ISO 53 for this module: 20 degrees, addendum m, dedendum 1.25 m, rounding 0.38 m.
    pub fn profile_a(module: f64) -> Self {
        Self {
            module,
            pressure_angle: 20_f64.to_radians(),
            addendum: module,
            dedendum: 1.25 * module,
            tip_radius: 0.38 * module,
            protuberance: None,
        }
    }
}

/// Difference of a hob that cuts before grinding from the rack of the ground flanks. Lengths are in meters.
///
/// Its flank stands back by the stock q for grinding, and is parallel to that of the rack. From the height h above its tip line down a straight flank leads to
/// the tip rounding and touches it; the rounding touches a parallel to the hob's own flank that stands out from it by the protuberance p_r. The rounding
/// therefore cuts by s_pr = p_r − q deeper than the ground flank (ISO 6336-3 has the same p_r, q and s_pr), and the angle of the protuberance's flank follows
/// from p_r and h.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Protuberance {
    /// p_r: how far the rounding stands out from the hob's flank, normal to it.
    pub amount: f64,
    /// h: the height above the hob's tip line at which the protuberance begins.
    pub height: f64,
    /// q: the stock that is ground off each flank, normal to it.
    pub grinding_stock: f64,
}

impl Rack {
    /// s_pr = p_r − q: by how much the tip rounding cuts deeper than the flank, normal to it; 0 without a protuberance.
    pub fn residual_undercut(&self) -> f64 {
        self.protuberance
            .map_or(0.0, |hob| hob.amount - hob.grinding_stock)
    }

    /// The least height at which a protuberance of this amount can begin: that of a flank that stands upright, or where the rounding itself comes out of
    /// the hob's flank.
    pub fn least_protuberance_height(&self, amount: f64) -> f64 {
        let (alpha, rho) = (self.pressure_angle, self.tip_radius);
        if amount <= 0.0 {
            return rho * (1.0 - alpha.sin());
        }
        let delta = alpha.min((1.0 - amount / rho).clamp(-1.0, 1.0).acos());
        let up = (rho - (rho - amount) * delta.cos()) / delta.sin();
        rho - (rho - amount) * alpha.sin() + up * alpha.cos()
    }

    /// The angle of the protuberance's flank to the middle of the hob's tooth, as α is that of its flank: less than α.
    ///
    /// From a place that stands up from the rounding's center by u along the hob's flank, and inside of the parallel that the rounding touches by p_r, the
    /// tangent to the rounding is inclined by δ with tan δ/2 = p_r/(u + √(u² − p_r (2 ρ − p_r))).
    fn protuberance_angle(&self, hob: &Protuberance) -> f64 {
        let (sin, cos) = self.pressure_angle.sin_cos();
        let (rho, amount) = (self.tip_radius, hob.amount);
        let up = (hob.height - rho + (rho - amount) * sin) / cos;
        let square = (up * up - amount * (2.0 * rho - amount)).max(0.0);
        let angle = self.pressure_angle - 2.0 * (amount / (up + square.sqrt())).atan();
        // An upright flank by its least height may lean over by a rounding.
        angle.max(1e-9)
    }

    /// Half the flat at the rack's tip, e = π m/4 − (h_f − ρ) tan α − (ρ − s_pr)/cos α; negative if the roundings overlap.
    pub fn half_tip_land(&self) -> f64 {
        let Self {
            module: m,
            pressure_angle: alpha,
            dedendum: h_f,
            tip_radius: rho,
            ..
        } = *self;
        PI * m / 4.0 - (h_f - rho) * alpha.tan() - rho / alpha.cos()
            + self.residual_undercut() / alpha.cos()
    }

    /// The largest tip rounding for which the tip land does not vanish.
    pub fn largest_tip_radius(&self) -> f64 {
        let (sin, cos) = self.pressure_angle.sin_cos();
        ((PI * self.module / 4.0 - self.dedendum * self.pressure_angle.tan()) * cos
            + self.residual_undercut())
            / (1.0 - sin)
    }

    /// The depth of the end of the rack's straight flank below its reference line, h_f − ρ (1 − sin α).
    pub fn straight_depth(&self) -> f64 {
        self.dedendum - self.tip_radius * (1.0 - self.pressure_angle.sin())
    }
}

/// The fillet of tooth 0 on its loaded side: the envelope of the rack's tip rounding as the rack rolls on the
/// reference circle.
///
/// The parameter γ is the angle of the contact normal to the reference circle's tangent: it runs from α, where the fillet meets the involute at the form
/// radius, to π/2, where it meets the root circle. Where the rack undercuts the flank it begins at a larger γ, at which it cuts the involute. A protuberance
/// makes it begin at a smaller one; where the straight flank of the protuberance cuts the involute already, its part comes first, at values of γ below those of
/// the rounding.
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
    /// The angle α of the rack's flank in this section.
    flank_angle: f64,
    /// Where it begins.
    start: f64,
    /// Part of the straight flank of a protuberance above that of the rounding.
    ramp: Option<Ramp>,
}

/// The part of a fillet that the straight flank of a protuberance leaves: an involute of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ramp {
    involute: Involute,
    /// The γ from which on the fillet is the rounding's.
    until: f64,
    /// The roll length there.
    lowest: f64,
    /// By how much the roll length grows as γ falls from there.
    rate: f64,
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
            flank_angle: rack.pressure_angle,
            start: rack.pressure_angle,
            ramp: None,
        }
    }

    /// The fillet that all of the rack leaves under `flank`: it begins where its rounding or its protuberance cuts the involute, or where the straight flank
    /// goes over into the rounding. `end_of_rack` is the roll length there.
    ///
    /// `normal` is as for [`Trochoid::new`], `module` that of the section.
    pub(super) fn under(
        self,
        flank: &Involute,
        end_of_rack: f64,
        module: f64,
        normal: &Rack,
    ) -> Self {
        match normal.protuberance {
            Some(hob) if normal.residual_undercut() > 0.0 => {
                let angle = normal.protuberance_angle(&hob);
                let fillet = self.protruding(flank, angle, hob.height, module);
                fillet.unwrap_or_else(|fillet| {
                    // The place of the rounding that touches the parallel to the flank is inside of it, unless the parallel is undercut as well.
                    let inside = if end_of_rack < 0.0 {
                        fillet.gamma_at(flank.base_radius())
                    } else {
                        self.flank_angle
                    };
                    fillet.cutting(flank, inside)
                })
            }
            _ if end_of_rack < 0.0 => self.cutting(flank, self.gamma_at(flank.base_radius())),
            _ => self,
        }
    }

    /// The fillet of a hob whose protuberance begins at the height `height` and has the angle `normal_angle` in the normal section, where its straight flank
    /// cuts `flank`; otherwise that of its rounding alone, as it begins outside of `flank`. The part of the straight flank counts by its length over `module`.
    fn protruding(
        self,
        flank: &Involute,
        normal_angle: f64,
        height: f64,
        module: f64,
    ) -> Result<Self, Self> {
        let r = self.reference_radius;
        let gamma = (self.stretch * normal_angle.tan()).atan();
        let (sin, cos) = gamma.sin_cos();
        // Where the protuberance's flank touches the rounding: below the rolling line, and beside the middle of the space.
        let (sideways, below) = (normal_angle.cos(), normal_angle.sin());
        let depth = self.center_depth + self.tip_radius * below;
        let width = self.half_tip_land + self.stretch * self.tip_radius * sideways;
        let half_angle = self.space_angle - (width + depth * gamma.tan()) / r;
        let involute = Involute::new(r * cos, half_angle + involute_function(gamma));
        let roll_length = |depth: f64| r * sin - depth / sin;
        let highest = roll_length(self.center_depth + self.tip_radius - height);
        let mut lowest = roll_length(depth);

        let rounding = Self {
            start: gamma,
            ..self
        };
        let mut after = rounding;
        if lowest < 0.0 {
            // It goes past its base circle and folds back there, as an undercut flank does.
            after = rounding.cutting(&involute, rounding.gamma_at(involute.base_radius()));
            lowest = involute.roll_length(after.point(after.start).norm());
        }
        if highest <= lowest {
            return Err(rounding);
        }
        let outside = |s: f64| is_outside(involute.point(s), flank);
        if outside(lowest) {
            return Err(after);
        }
        let from = bisect(highest, lowest, outside);
        let turn = (involute.arc_length(from) - involute.arc_length(lowest)) / module;
        if turn <= 0.0 {
            return Ok(after);
        }
        Ok(Self {
            start: after.start - turn,
            ramp: Some(Ramp {
                involute,
                until: after.start,
                lowest,
                rate: (from - lowest) / turn,
            }),
            ..self
        })
    }

    /// The same fillet where it undercuts `flank`: it begins where it cuts the involute.
    ///
    /// The rack's straight flank goes past the base circle, and its envelope there folds back on the involute. The fillet goes down from the end of that fold,
    /// outside of the involute, through it and on through the base circle. At γ = `inside` it is inside of the involute.
    fn cutting(self, flank: &Involute, inside: f64) -> Self {
        let outside = |gamma: f64| is_outside(self.point(gamma), flank);
        Self {
            start: bisect(self.start, inside, outside),
            ..self
        }
    }

    /// The γ at which it comes down to `radius`.
    pub(super) fn gamma_at(&self, radius: f64) -> f64 {
        let (from, to) = self.ends();
        bisect(from, to, |gamma| self.point(gamma).norm() >= radius)
    }

    /// The ranges of γ, rising, over which it has no kink and changes evenly: below the angle of the rack's flank points run the faster the smaller γ is.
    pub(super) fn smooth_pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        let (from, to) = self.ends();
        let kink = self.ramp.map_or(from, |ramp| ramp.until);
        let even = self.flank_angle.max(kink);
        [(from, kink), (kink, even), (even, to)]
            .into_iter()
            .filter(|(from, to)| from < to)
    }

    /// The values of γ at the involute and at the root circle.
    pub fn ends(&self) -> (f64, f64) {
        (self.start, FRAC_PI_2)
    }

    /// The point of the fillet at γ = `gamma`.
    pub fn point(&self, gamma: f64) -> Vector {
        if let Some(ramp) = self.ramp.filter(|ramp| gamma < ramp.until) {
            let s = ramp.lowest + (ramp.until - gamma) * ramp.rate;
            return ramp.involute.point(s);
        }
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
        let (sideways, below) = (rho * (stretch * stretch) * cos / q, rho * sin / q);
        // The pitch point of the rolling stands at angle φ of the gear, the rounding's center a length l beside it.
        let l = -d * cos / sin + rho * longer * cos / q;
        let phi = space_angle - (l + e) / r;
        (r - d - below) * radial(phi) + (l - sideways) * tangential(phi)
    }
}

/// True if `point` lies on `flank`, which ends on its base circle, or outside of its tooth.
fn is_outside(point: Vector, flank: &Involute) -> bool {
    point.y.atan2(point.x) >= flank.half_angle(point.norm())
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
            protuberance: None,
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
            protuberance: None,
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
                fillet = fillet.cutting(&flank, fillet.gamma_at(flank.base_radius()));
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
                    let sideways = rack.half_tip_land() + rack.tip_radius * angle.cos() - r * turn;
                    let phi = PI / f64::from(z) - turn;
                    let point = (r - depth) * radial(phi) - sideways * tangential(phi);
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
