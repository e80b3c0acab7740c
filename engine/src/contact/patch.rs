//! Where flanks come near each other: patches of contact cells, found from the true geometry.
//!
//! One flank of each pair carries the cells: the one whose tip is nearer, so that the patch may end at its tip corner. The
//! gap of a cell is measured along the normal of the other flank, which is the tangent from the cell to that gear's base
//! circle; reliefs add to it. On the line of action this is the theoretical contact; off it, where a tip corner digs into
//! the other flank, the normal is tilted and its arm about the other center is not its base radius.

use std::f64::consts::PI;

use super::half_plane;
use crate::gear::{GearPair, Member, SpurGear, Vector, radial, tangential};

/// Widths of the patch to either side of the deepest point, in Hertz half-widths of the whole load.
const PATCH_HALF_WIDTH: f64 = 1.25;

/// One contact cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Roll length on the driving and on the driven gear.
    pub roll_lengths: [f64; 2],
    /// How each gear is pressed: components against its outward normal and against its way to the tip.
    pub directions: [[f64; 2]; 2],
    /// The gap g_0 under no load, positive when open.
    pub gap: f64,
    /// The arm of the force about the driven axis over r_b2; 1 on the line of action.
    pub arm: f64,
}

/// The cells of one tooth pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// The pair: the number n of the mesh position at which it passes the pitch point.
    pub pair: i64,
    /// The gear whose flank carries the cells.
    pub carrier: Member,
    /// The width of each cell along the flank.
    pub cell_width: f64,
    /// The cells, towards the carrier's tip.
    pub cells: Vec<Cell>,
    /// Whether the first cell begins where the carrier's flank does.
    pub starts_at_form: bool,
    /// Whether the last cell ends at the carrier's tip corner.
    pub ends_at_tip: bool,
    /// Whether the nominal contact lies past the carrier's tip, off the path of contact.
    pub off_path: bool,
}

/// Two flanks that come near each other, before cells are laid on them.
#[derive(Debug, Clone, Copy)]
pub struct Approach {
    /// The pair n.
    pub pair: i64,
    /// The smallest gap between the flanks.
    pub gap: f64,
    placement: Placement,
    carrier: Member,
    /// Arc length on the carrier at the smallest gap.
    arc: f64,
    off_path: bool,
}

/// Both gears turned to a mesh position, as seen by one tooth pair.
///
/// The driving center is the origin, the driven one lies on the x axis; the driving gear turns counter-clockwise.
#[derive(Debug, Clone, Copy)]
struct Placement {
    centers: [Vector; 2],
    /// The angle of each tooth's centerline.
    angles: [f64; 2],
}

/// What a point sees of the other flank: roll length there, gap along its normal, and that normal.
struct Sight {
    roll_length: f64,
    gap: f64,
    normal: Vector,
}

impl Placement {
    fn new(pair: &GearPair, driving_roll: f64, driven_roll: f64) -> Self {
        let alpha_w = pair.working_pressure_angle();
        let angle = |gear: &SpurGear, tangent: f64, s: f64| {
            tangent - gear.flank().base_half_angle() + s / gear.base_radius()
        };
        Self {
            centers: [Vector::zeros(), Vector::new(pair.center_distance(), 0.0)],
            angles: [
                angle(pair.driving(), -alpha_w, driving_roll),
                angle(pair.driven(), PI - alpha_w, driven_roll),
            ],
        }
    }

    /// The point of the flank of `gear` at roll length `s`, its outward normal and its way to the tip.
    fn point(&self, gear: &SpurGear, member: Member, s: f64) -> (Vector, Vector, Vector) {
        let t = self.angles[member.index()] + gear.flank().tangent_angle(s);
        let (e_r, e_t) = (radial(t), tangential(t));
        (
            self.centers[member.index()] + gear.base_radius() * e_r + s * e_t,
            e_t,
            e_r,
        )
    }

    /// The flank of `gear` as seen from `point`; `None` from inside its base circle.
    fn sight(&self, gear: &SpurGear, member: Member, point: Vector) -> Option<Sight> {
        let d = point - self.centers[member.index()];
        let r_b = gear.base_radius();
        let from_tangent_point = (d.norm_squared() - r_b * r_b).max(0.0).sqrt();
        let t = d.y.atan2(d.x) - (from_tangent_point / r_b).atan();
        let turn = self.angles[member.index()] + gear.flank().base_half_angle() - t;
        let roll_length = r_b * (turn - (turn / (2.0 * PI)).round() * 2.0 * PI);
        (from_tangent_point > 0.0).then(|| Sight {
            roll_length,
            gap: from_tangent_point - roll_length,
            normal: tangential(t),
        })
    }
}

impl Approach {
    /// How the flanks of pair `n` come near each other at mesh position `eta`; `None` where they face nothing.
    pub fn of(pair: &GearPair, eta: f64, n: i64) -> Option<Self> {
        let line = pair.line_of_action();
        let s_1 = pair.pitch_roll_length() + (eta - n as f64) * pair.base_pitch();
        let placement = Placement::new(pair, s_1, line - s_1);
        let carrier = if s_1 < pair.pitch_roll_length() {
            Member::Driven
        } else {
            Member::Driving
        };
        let gear = pair.gear(carrier);
        let nominal = if carrier == Member::Driving {
            s_1
        } else {
            line - s_1
        };
        let (low, high) = (
            gear.flank().arc_length(gear.form_roll_length()),
            gear.flank().arc_length(gear.tip_roll_length()),
        );
        let gap_at = |arc: f64| {
            cell_gap(pair, &placement, carrier, arc).map_or(f64::INFINITY, |(gap, ..)| gap)
        };
        // The gap is a parabola about the nominal contact plus reliefs that grow towards either tip: it has one minimum.
        let arc = golden_minimum(low, high, 1e-4 * (high - low).min(1e-3), gap_at);
        let arc = if gap_at(high) <= gap_at(arc) {
            high
        } else {
            arc
        };
        let gap = gap_at(arc);
        gap.is_finite().then_some(Self {
            pair: n,
            gap,
            placement,
            carrier,
            arc,
            off_path: nominal > gear.tip_roll_length(),
        })
    }

    /// Lays `count` cells about the deepest point, wide enough for `load` and then by the factor `widening`.
    ///
    /// `factors` is the sum of both logarithm factors. Where the flank ends, the patch ends with it, so that its cells move
    /// with the contact and close up smoothly towards a corner.
    pub fn patch(
        &self,
        pair: &GearPair,
        load: f64,
        factors: f64,
        count: usize,
        widening: f64,
    ) -> Patch {
        let gear = pair.gear(self.carrier);
        let flank = gear.flank();
        let (low, high) = (
            flank.arc_length(gear.form_roll_length()),
            flank.arc_length(gear.tip_roll_length()),
        );
        let s = flank.roll_length_at_arc(self.arc);
        let other = (pair.line_of_action() - s).max(0.1 * s);
        let (half_width, _) =
            half_plane::hertz(load, s * other / (s + other), factors, pair.contact_width());
        let reach = PATCH_HALF_WIDTH * widening * half_width;
        let (from, to) = ((self.arc - reach).max(low), (self.arc + reach).min(high));
        let cell_width = (to - from) / count as f64;
        let cells = (0..count)
            .filter_map(|i| self.cell(pair, from + (i as f64 + 0.5) * cell_width, cell_width))
            .collect();
        Patch {
            pair: self.pair,
            carrier: self.carrier,
            cell_width,
            cells,
            starts_at_form: from <= low,
            ends_at_tip: to >= high,
            off_path: self.off_path,
        }
    }

    fn cell(&self, pair: &GearPair, arc: f64, width: f64) -> Option<Cell> {
        let (carrier, other) = (self.carrier, self.carrier.other());
        // The mean gap of the cell, by two Gauss points.
        let offset = width / 12.0_f64.sqrt();
        let (gap_0, ..) = cell_gap(pair, &self.placement, carrier, arc - offset)?;
        let (gap_1, ..) = cell_gap(pair, &self.placement, carrier, arc + offset)?;
        let (_, sight, s) = cell_gap(pair, &self.placement, carrier, arc)?;
        if sight.roll_length < pair.gear(other).form_roll_length() {
            return None;
        }
        let (point, normal, to_tip) = self.placement.point(pair.gear(carrier), carrier, s);
        let mut roll_lengths = [0.0; 2];
        roll_lengths[carrier.index()] = s;
        roll_lengths[other.index()] = sight.roll_length;
        let mut directions = [[1.0, 0.0]; 2];
        directions[carrier.index()] = [-sight.normal.dot(&normal), -sight.normal.dot(&to_tip)];
        let force = if other == Member::Driving {
            sight.normal
        } else {
            -sight.normal
        };
        let from_axis = point - self.placement.centers[1];
        let arm = -(from_axis.x * force.y - from_axis.y * force.x) / pair.driven().base_radius();
        Some(Cell {
            roll_lengths,
            directions,
            gap: f64::midpoint(gap_0, gap_1),
            arm,
        })
    }
}

/// The gap at `arc` on the carrier, reliefs included, what is seen there and the carrier's roll length.
fn cell_gap(
    pair: &GearPair,
    placement: &Placement,
    carrier: Member,
    arc: f64,
) -> Option<(f64, Sight, f64)> {
    let (gear, other) = (pair.gear(carrier), pair.gear(carrier.other()));
    let s = gear.flank().roll_length_at_arc(arc);
    let (point, ..) = placement.point(gear, carrier, s);
    let sight = placement.sight(other, carrier.other(), point)?;
    // Past the other flank's ends there is nothing to touch.
    if !(0.0..=other.tip_roll_length()).contains(&sight.roll_length) {
        return None;
    }
    let relief = gear.relief_depth(gear.flank().radius(s))
        + other.relief_depth(other.flank().radius(sight.roll_length));
    Some((sight.gap + relief, sight, s))
}

/// The place of the minimum of a function with one minimum, by golden sections.
fn golden_minimum(mut low: f64, mut high: f64, tolerance: f64, f: impl Fn(f64) -> f64) -> f64 {
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - ratio * (high - low), low + ratio * (high - low));
    let (mut f_a, mut f_b) = (f(a), f(b));
    while high - low > tolerance {
        if f_a < f_b {
            (high, b, f_b) = (b, a, f_a);
            a = high - ratio * (high - low);
            f_a = f(a);
        } else {
            (low, a, f_a) = (a, b, f_b);
            b = low + ratio * (high - low);
            f_b = f(b);
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{ReliefData, ReliefShape, ReliefStart};

    fn pair(relief: bool) -> GearPair {
        let mut data = paper_gear(50);
        if relief {
            data.tip_relief = Some(ReliefData {
                amount: 5e-6,
                shape: ReliefShape::Linear,
                start: ReliefStart::RadialLength(1.75e-3),
            });
        }
        let gear = SpurGear::new(data).expect("the standard gear");
        GearPair::new(gear, gear, 100.5e-3).expect("meshes")
    }

    #[test]
    fn conjugate_flanks_touch_on_the_line_of_action_with_arm_one() {
        let pair = pair(false);
        for (eta, n) in [(0.0, 0), (0.3, 0), (0.3, 1), (0.7, 1), (-0.25, 0)] {
            let approach = Approach::of(&pair, eta, n).expect("near");
            assert!(approach.gap.abs() < 1e-12, "gap {} at {eta}", approach.gap);
            let patch = approach.patch(&pair, 2447.61, 3e-10, 40, 1.0);
            let s = pair.pitch_roll_length() + (eta - n as f64) * pair.base_pitch();
            for cell in &patch.cells {
                assert!(
                    (cell.arm - 1.0).abs() < 1e-2,
                    "cells beside the line of action are tilted by a/ρ: {}",
                    cell.arm
                );
            }
            let nearest = patch
                .cells
                .iter()
                .min_by(|a, b| a.gap.total_cmp(&b.gap))
                .expect("cells");
            assert!((nearest.roll_lengths[0] - s).abs() < 0.02e-3);
            assert!(
                (nearest.roll_lengths[0] + nearest.roll_lengths[1] - pair.line_of_action()).abs()
                    < 5e-6,
                "half a cell beside it"
            );
        }
    }

    #[test]
    fn the_gap_beside_the_contact_is_the_parabola_of_the_relative_curvature() {
        let pair = pair(false);
        let patch = Approach::of(&pair, 0.2, 0)
            .expect("near")
            .patch(&pair, 2447.61, 3e-10, 41, 1.0);
        let (center, end) = (patch.cells[20], patch.cells[36]);
        let x = 16.0 * patch.cell_width;
        let curvature = 1.0 / center.roll_lengths[0] + 1.0 / center.roll_lengths[1];
        assert!(
            ((end.gap - center.gap) / (x * x / 2.0 * curvature) - 1.0).abs() < 0.03,
            "third-order terms are x/ρ"
        );
    }

    #[test]
    fn past_the_path_of_contact_the_tip_corner_is_nearest_from_either_gear() {
        let pair = pair(false);
        let (s_a, s_e) = pair.path_of_contact();
        let before = (s_a - pair.pitch_roll_length()) / pair.base_pitch() - 0.1;
        let after = (s_e - pair.pitch_roll_length()) / pair.base_pitch() + 0.1;
        for (eta, carrier) in [(before, Member::Driven), (after, Member::Driving)] {
            let approach = Approach::of(&pair, eta, 0).expect("near");
            assert_eq!(approach.carrier, carrier);
            assert!(
                approach.off_path && approach.gap > 1e-6 && approach.gap < 1e-4,
                "{}",
                approach.gap
            );
            let patch = approach.patch(&pair, 2447.61, 3e-10, 40, 1.0);
            assert!(patch.ends_at_tip);
            let last = patch.cells.last().expect("cells");
            assert!(patch.cells.iter().all(|cell| cell.gap >= last.gap));
        }
    }

    #[test]
    fn reliefs_add_to_the_gap() {
        let (plain, relieved) = (pair(false), pair(true));
        let eta = 0.5;
        let gap = |pair: &GearPair| Approach::of(pair, eta, 0).expect("near").gap;
        let s = plain.pitch_roll_length() + eta * plain.base_pitch();
        let depth = relieved
            .driving()
            .relief_depth(relieved.driving().flank().radius(s));
        // A slope σ beside a parabola of radius ρ lowers its minimum by σ² ρ/2.
        let (r_b, r) = (
            plain.driving().base_radius(),
            plain.driving().flank().radius(s),
        );
        let slope = 5e-6 / 1.75e-3 * r_b / r;
        let rho = s * (plain.line_of_action() - s) / plain.line_of_action();
        let expected = depth - slope * slope * rho / 2.0;
        let added = gap(&relieved) - gap(&plain);
        assert!(
            depth > 2e-6 && (added - expected).abs() < 1e-9,
            "{added} {expected}"
        );
    }
}
