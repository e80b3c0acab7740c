//! Mass and inertia of a gear, from its true profile.

use std::f64::consts::PI;

use super::{Moments, SolidGear, SpurGear, Vector};
use crate::quadrature::gauss_legendre_panels;

impl SpurGear {
    /// The mass in kg, from the true profile.
    pub fn mass(&self) -> f64 {
        let (area, _) = self.profile_moments();
        let volume = area * self.face_width() - self.taken_away().area;
        self.material().density * volume
    }

    /// The polar moment of inertia about the axis in kg m², from the true profile.
    pub fn polar_inertia(&self) -> f64 {
        let (_, moment) = self.profile_moments();
        let volume = moment * self.face_width() - self.taken_away().polar;
        self.material().density * volume
    }

    /// The imbalance U in kg m: the mass times the place of its center, from the gear's own axis, in the frame of tooth 0. An eccentricity
    /// adds the mass times itself.
    pub fn imbalance(&self) -> Vector {
        let own = -self.material().density * self.taken_away().first;
        own + self.mass() * self.deviations().displacement(0.0)
    }

    /// Moments of bore, holes and web, which are removed from the body inside the profile.
    fn taken_away(&self) -> Moments {
        self.data().blank.taken_away(self.face_width())
    }

    /// The area and the second polar moment inside the tooth profile, by Green's theorem along one half tooth:
    /// A = ½∮ r² dθ and J = ¼∮ r⁴ dθ, with r² dθ = x dy − y dx.
    fn profile_moments(&self) -> (f64, f64) {
        let (s_form, s_tip) = (self.form_roll_length(), self.tip_form_roll_length());
        let fillet = self.fillet();
        let gamma_1 = fillet.ends().1;
        let (r_a, r_f) = (self.tip_radius(), self.root_radius());
        let tip_angle = self.tip_half_angle();
        let root_end = fillet.point(gamma_1);
        let root_angle = self.pitch_angle() / 2.0 - root_end.y.atan2(root_end.x);

        let mut area = r_a.powi(2) * tip_angle + r_f.powi(2) * root_angle;
        let mut moment = r_a.powi(4) * tip_angle + r_f.powi(4) * root_angle;
        for (s, weight) in gauss_legendre_panels(s_form, s_tip, 8) {
            // From the tip down the involute, x dy − y dx = (s²/r_b) |ds|.
            let swept = s * s / self.flank().base_radius();
            area += weight * swept;
            moment += weight * swept * self.flank().radius(s).powi(2);
        }
        if let Some(edge) = self.broken_edge() {
            for (t, weight) in gauss_legendre_panels(0.0, 1.0, 2) {
                let (p, d) = edge.point(self.flank(), t);
                let swept = p.x * d.y - p.y * d.x;
                area += weight * swept;
                moment += weight * swept * p.norm_squared();
            }
        }
        let step = 1e-5;
        let pieces = fillet.smooth_pieces();
        for (gamma, weight) in pieces.flat_map(|(from, to)| gauss_legendre_panels(from, to, 8)) {
            let p = fillet.point(gamma);
            let d = (fillet.point(gamma + step) - fillet.point(gamma - step)) / (2.0 * step);
            let swept = p.x * d.y - p.y * d.x;
            area += weight * swept;
            moment += weight * swept * p.norm_squared();
        }
        let halves = 2.0 * f64::from(self.tooth_count());
        (halves * area / 2.0, halves * moment / 4.0)
    }
}

impl SolidGear {
    /// The mass in kg.
    pub fn mass(&self) -> f64 {
        self.section().mass() + self.added_by_hub()[0]
    }

    /// The polar moment of inertia about the axis in kg m².
    pub fn polar_inertia(&self) -> f64 {
        self.section().polar_inertia() + self.added_by_hub()[1]
    }

    /// Mass and polar inertia that a hub of its own width adds to the section, in which the part around the bore is as wide as the face, or as thick as the
    /// web.
    fn added_by_hub(&self) -> [f64; 2] {
        let Some(hub) = self.hub() else {
            return [0.0, 0.0];
        };
        let (section, blank) = (self.section(), &self.section().data().blank);
        let density = section.material().density;
        let ring = |from: f64, to: f64, width: f64| {
            let to = to.max(from);
            [
                density * PI * (to.powi(2) - from.powi(2)) * width,
                0.5 * density * PI * (to.powi(4) - from.powi(4)) * width,
            ]
        };
        let web = blank.web.map_or(hub.outer_radius, |web| web.inner_radius);
        let thickness = blank.web.map_or(0.0, |web| web.thickness);
        let within = web.min(hub.outer_radius);
        let [inner, outer] = [
            ring(blank.open_radius(), within, hub.width - self.face_width()),
            ring(within, hub.outer_radius, hub.width - thickness),
        ];
        [inner[0] + outer[0], inner[1] + outer[1]]
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{HolePattern, TipEdge, radial};

    #[test]
    fn a_single_hole_draws_the_center_of_mass_away_from_it() {
        let mut data = paper_gear(50);
        let pattern = |count| HolePattern {
            count,
            circle_radius: 30e-3,
            radius: 5e-3,
            phase: 0.5,
        };
        data.blank.holes = pattern(1).holes();
        let gear = SpurGear::new(data.clone()).expect("one hole");
        // 7850 kg/m3 by 20 mm by pi 25 mm2 at 30 mm.
        let expected = 7850.0 * 20e-3 * PI * 25e-6 * 30e-3;
        let imbalance = gear.imbalance();
        assert!((imbalance + expected * radial(0.5)).norm() < 1e-12 * expected);
        data.blank.holes = pattern(2).holes();
        let pair_of_holes = SpurGear::new(data).expect("two holes");
        assert!(pair_of_holes.imbalance().norm() < 1e-12 * expected);
    }

    #[test]
    fn the_profile_area_agrees_with_a_polygon_through_the_true_profile() {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let (s_0, s_1) = (gear.form_roll_length(), gear.tip_roll_length());
        let (gamma_0, gamma_1) = gear.fillet().ends();
        let n = 4000;
        let half: Vec<_> = (0..=n)
            .map(|i| {
                gear.flank()
                    .point(s_1 + (s_0 - s_1) * f64::from(i) / f64::from(n))
            })
            .chain((1..=n).map(|i| {
                gear.fillet()
                    .point(gamma_0 + (gamma_1 - gamma_0) * f64::from(i) / f64::from(n))
            }))
            .collect();
        let swept: f64 = half
            .windows(2)
            .map(|p| (p[0].x * p[1].y - p[0].y * p[1].x) / 2.0)
            .sum();
        let first = half[0].y.atan2(half[0].x);
        let last = gear.pitch_angle() / 2.0 - half[half.len() - 1].y.atan2(half[half.len() - 1].x);
        let area =
            100.0 * (swept + 52e-3_f64.powi(2) * first / 2.0 + 47.5e-3_f64.powi(2) * last / 2.0);
        let mass = 7850.0 * 20e-3 * (area - PI * 15e-3_f64.powi(2));
        assert!(
            (gear.mass() / mass - 1.0).abs() < 1e-6,
            "polygon {mass}, quadrature {}",
            gear.mass()
        );
    }

    #[test]
    fn broken_edges_take_off_what_lies_beyond_them() {
        let gear = |tip_edge| {
            let mut data = paper_gear(50);
            data.tip_edge = tip_edge;
            SpurGear::new(data).expect("a gear that can be made")
        };
        let sharp = gear(TipEdge::Sharp);
        for edge in [TipEdge::Rounded(0.2e-3), TipEdge::Chamfered(0.15e-3)] {
            let broken = gear(edge);
            // A polygon around the missing corner: up the flank to the tip, along the tip circle, down the edge.
            let (s_0, s_1) = (broken.tip_form_roll_length(), broken.tip_roll_length());
            let n = 2000;
            let part = |i: i32| f64::from(i) / f64::from(n);
            let (from, to) = (broken.tip_half_angle(), broken.flank().half_angle(52e-3));
            let outline: Vec<_> = (0..=n)
                .map(|i| broken.flank().point(s_0 + (s_1 - s_0) * part(i)))
                .chain((0..=n).map(|i| 52e-3 * crate::gear::radial(to + (from - to) * part(i))))
                .chain((0..=n).map(|i| {
                    let edge = broken.broken_edge().expect("an edge");
                    edge.point(broken.flank(), part(i)).0
                }))
                .collect();
            let area: f64 = (0..outline.len())
                .map(|i| {
                    let (p, q) = (outline[i], outline[(i + 1) % outline.len()]);
                    (p.x * q.y - p.y * q.x) / 2.0
                })
                .sum();
            let removed = 7850.0 * 20e-3 * 100.0 * area.abs();
            assert!(((sharp.mass() - broken.mass()) / removed - 1.0).abs() < 1e-4);
        }
    }
}
