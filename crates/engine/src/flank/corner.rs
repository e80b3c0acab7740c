//! The compliance near a sharp tip corner, at distances that no grid resolves.
//!
//! Near its tip corner a tooth is a wedge, and a wedge has no length of its own: nearer by a factor, the compliance between two points grows by C ln of the
//! factor, with the compliance C of a wedge loaded at its apex (Michell). With the half plane's logarithm subtracted as everywhere, R(x, y) − (c − C) ln m
//! depends on the ratio of the distances x, y from the corner alone, m their mean, except for a part of the rest of the tooth in proportion to m. Both parts
//! are read from the table at the distances m = d and 2 d that the grid resolves.

use std::f64::consts::LN_2;

use faer::Mat;

use super::half_plane::logarithm_factor;
use crate::gear::{SpurGear, Vector, radial, tangential};

/// Nodes between the corner and the distance d from which the table is trusted: seven elements. On a flank shorter than 4 d, the largest distance
/// that is read, d is a quarter of the flank.
const TRUSTED_FROM: usize = 14;

/// Places of the ratio t = (y − x)/(x + y), from −1 to 1, at which R is tabulated.
const RATIOS: usize = 49;

/// R near a sharp tip corner.
#[derive(Debug, Clone)]
pub(crate) struct Corner {
    /// The arc length of the tip, from the base circle.
    tip: f64,
    /// The distance d.
    trusted: f64,
    /// C on (normal, towards the tip), less c where the half plane's logarithm is taken off.
    growth: [[f64; 2]; 2],
    /// R at mean distances d and 2 d by ratio, on (normal, towards the tip) of either point.
    at: [Vec<[[f64; 2]; 2]>; 2],
}

impl Corner {
    /// Reads the law of the tip corner of `gear` from the table `smooth` on the nodes at `arcs`; `factor` is c.
    pub(crate) fn new(
        gear: &SpurGear,
        arcs: &[f64],
        factor: f64,
        smooth: impl Fn(f64, f64) -> [[f64; 2]; 2],
    ) -> Self {
        let last = arcs.len() - 1;
        let tip = arcs[last];
        let trusted = tip - arcs[last.saturating_sub(TRUSTED_FROM)];
        let trusted = trusted.min(0.25 * (tip - arcs[0]));
        let mut growth = apex_compliance(gear);
        growth[0][0] -= factor;
        growth[1][1] -= factor;
        let at = [1.0, 2.0].map(|scale| {
            (0..RATIOS)
                .map(|i| {
                    let t = 2.0 * i as f64 / (RATIOS - 1) as f64 - 1.0;
                    let mean = scale * trusted;
                    smooth(tip - mean * (1.0 - t), tip - mean * (1.0 + t))
                })
                .collect()
        });
        Self {
            tip,
            trusted,
            growth,
            at,
        }
    }

    /// True if [`Corner::compliance`] covers the point at an arc length, with any other one.
    pub(crate) fn may_know(&self, arc: f64) -> bool {
        self.tip - arc < 2.0 * self.trusted
    }

    /// R between the points at two arc lengths, if they are nearer to the corner than the table knows.
    pub(crate) fn compliance(&self, one: f64, other: f64) -> Option<[[f64; 2]; 2]> {
        let (x, y) = (self.tip - one, self.tip - other);
        let mean = f64::midpoint(x, y);
        // At the very corner the logarithm has no value; no cell has its middle there.
        if mean >= self.trusted || mean <= 0.0 {
            return None;
        }
        let t = (y - x) / (x + y);
        let place = 0.5 * (t + 1.0) * (RATIOS - 1) as f64;
        let (first, weights) = cubic(place);
        let [near, far] = [0, 1].map(|i| &self.at[i][first..first + 4]);
        let rest = 1.0 - mean / self.trusted;
        // From d on inward by the wedge's law; the departure from that law between 2 d and d continues in proportion.
        let grown = (self.trusted / mean).ln() - rest * LN_2;
        let mut compliance = self.growth.map(|row| row.map(|growth| grown * growth));
        for ((near, far), weight) in near.iter().zip(far).zip(weights) {
            for (a, row) in compliance.iter_mut().enumerate() {
                for (b, entry) in row.iter_mut().enumerate() {
                    *entry += weight * (near[a][b] + rest * (near[a][b] - far[a][b]));
                }
            }
        }
        Some(compliance)
    }
}

/// The first of the four entries of a table around `place`, and their weights in a cubic.
fn cubic(place: f64) -> (usize, [f64; 4]) {
    let first = (place.floor() as usize).saturating_sub(1).min(RATIOS - 4);
    let z = place - first as f64;
    let weights = [
        -(z - 1.0) * (z - 2.0) * (z - 3.0) / 6.0,
        z * (z - 2.0) * (z - 3.0) / 2.0,
        -z * (z - 1.0) * (z - 3.0) / 2.0,
        z * (z - 1.0) * (z - 2.0) / 6.0,
    ];
    (first, weights)
}

/// (C − c)/c: by how much more than the half plane the sharp tip corner of `gear` gives way along the normal of its flank.
pub(crate) fn tip_softness(gear: &SpurGear) -> f64 {
    let factor = logarithm_factor(gear.material().youngs_modulus, gear.face_width());
    apex_compliance(gear)[0][0] / factor - 1.0
}

/// C: how the apex of the tip corner gives way, u = −C F ln r + constant, on (normal, towards the tip) of the flank.
///
/// A wedge of angle φ in plane stress: 2/(E b (φ + sin φ)) along its middle, 2/(E b (φ − sin φ)) across it.
fn apex_compliance(gear: &SpurGear) -> [[f64; 2]; 2] {
    let t = gear.flank().tangent_angle(gear.tip_roll_length());
    let (normal, to_tip) = (tangential(t), radial(t));
    let corner = gear.flank().point(gear.tip_roll_length());
    // Into the tooth along its two sides: down the flank, and along the tip circle.
    let (down, along) = (-to_tip, -tangential(corner.y.atan2(corner.x)));
    let angle = down.dot(&along).clamp(-1.0, 1.0).acos();
    let middle = (down + along).normalize();
    let across = Vector::new(-middle.y, middle.x);
    let stiffness = gear.material().youngs_modulus * gear.face_width();
    let along_middle = 2.0 / (stiffness * (angle + angle.sin()));
    let across_middle = 2.0 / (stiffness * (angle - angle.sin()));
    [normal, to_tip].map(|a| {
        [normal, to_tip].map(|b| {
            along_middle * a.dot(&middle) * b.dot(&middle)
                + across_middle * a.dot(&across) * b.dot(&across)
        })
    })
}

/// R on the nodes of the table as blocks, for the entries between them.
pub(crate) fn block(smooth: &Mat<f64>, row: usize, column: usize) -> [[f64; 2]; 2] {
    std::array::from_fn(|a| std::array::from_fn(|b| smooth[(2 * row + a, 2 * column + b)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;

    #[test]
    fn a_table_that_follows_the_wedges_law_is_continued_by_it() {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let c = crate::flank::half_plane::logarithm_factor(210e9, 20e-3);
        let tip = gear.flank_arcs().1;
        let arcs: Vec<f64> = (0..60).rev().map(|i| tip - 8e-6 * f64::from(i)).collect();
        let apex = apex_compliance(&gear);
        // Any even function of the ratio, the logarithm, and a part in proportion to the mean.
        let exact = |one: f64, other: f64| -> [[f64; 2]; 2] {
            let (x, y) = (tip - one, tip - other);
            let (mean, t) = (f64::midpoint(x, y), (y - x) / (x + y));
            std::array::from_fn(|a| {
                std::array::from_fn(|b| {
                    let growth = apex[a][b] - if a == b { c } else { 0.0 };
                    c * (3.0 + t * t - 200.0 * mean) - growth * mean.ln()
                })
            })
        };
        let corner = Corner::new(&gear, &arcs, c, exact);
        for (x, y) in [(1e-6, 1e-6), (0.5e-6, 30e-6), (100e-6, 20e-6), (3e-6, 0.0)] {
            let found = corner
                .compliance(tip - x, tip - y)
                .expect("near the corner");
            let expected = exact(tip - x, tip - y);
            for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                assert!((found[a][b] - expected[a][b]).abs() < 1e-10 * c, "{x} {y}");
            }
        }
        assert!(corner.compliance(tip - 120e-6, tip - 120e-6).is_none());
    }

    #[test]
    fn a_short_flank_is_read_within_its_own_table() {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let tip = gear.flank_arcs().1;
        // Fewer nodes than the distance from which tables are trusted, and some more.
        for nodes in [9, 15, 30] {
            let arcs: Vec<f64> = (0..nodes)
                .rev()
                .map(|i| tip - 8e-6 * f64::from(i))
                .collect();
            let within = |arc: f64| arc >= arcs[0] - 1e-12 && arc <= tip + 1e-12;
            Corner::new(&gear, &arcs, 1.0, |one, other| {
                assert!(within(one) && within(other), "{nodes} nodes: {one} {other}");
                [[0.0; 2]; 2]
            });
        }
    }

    #[test]
    fn a_wedge_of_a_straight_angle_is_the_half_plane() {
        // φ = π: 2/(π E b) along its middle. Here the middle leans; across, the force pulls the half plane sideways.
        let c = crate::flank::half_plane::logarithm_factor(210e9, 20e-3);
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let apex = apex_compliance(&gear);
        // The corner of a tooth is blunter than a right angle and sharper than a straight one.
        let right = std::f64::consts::FRAC_PI_2;
        let softest = 2.0 / (210e9 * 20e-3 * (right - 1.0));
        assert!(apex[0][0] > c && apex[0][0] < softest);
        assert!((apex[0][1] - apex[1][0]).abs() < 1e-15 * c);
    }
}
