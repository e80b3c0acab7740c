//! Patches of contact cells about the places where flanks are nearest.
//!
//! The cells lie on the flank of the seat, the gear whose tip is nearer. On the line of action a cell presses along the
//! theoretical normal; off it, where a tip corner digs into the other flank, the normal is tilted and its arm about the other
//! center is not its base radius.

use super::facing::{Facing, RangeEnd};
use super::half_plane::{NearField, logarithm_factor};
use crate::gear::{GearPair, Member};

/// Half the width of a patch, in half-widths of the contact under the whole load: the contact and a quarter beside it, so that one that
/// a relief shifts still fits.
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
    /// The gear on whose flank the cells lie.
    pub seat: Member,
    /// Where the first cell begins, by arc length on the seat's flank.
    pub from: f64,
    /// The width of each cell along the flank.
    pub cell_width: f64,
    /// The cells, towards the seat's tip.
    pub cells: Vec<Cell>,
    /// What ends the patch on either side, where it reaches as far as the flanks face each other.
    pub ends: [Option<RangeEnd>; 2],
    /// How each gear gives way near the contact.
    pub near_fields: [NearField; 2],
    /// Whether the nominal contact lies past the seat's tip, off the path of contact.
    pub off_path: bool,
}

impl Patch {
    /// Lays `count` cells about the nearest point of `facing`, wide enough for `load` and then by the factor `widening`.
    ///
    /// Where the flanks cease to face each other the patch ends, so that its cells move with the contact and close up smoothly
    /// towards a corner.
    pub fn new(facing: &Facing<'_>, load: f64, count: usize, widening: f64) -> Self {
        let gears = facing.gears();
        let width = gears.common_face_width();
        let nearest = facing.point(facing.nearest);
        let radii = nearest.map_or([0.0; 2], |point| {
            facing.on_both(point.roll_length, point.sight.roll_length)
        });
        let factors: f64 = Member::BOTH
            .map(|member| logarithm_factor(gears.gear(member).material().youngs_modulus, width))
            .into_iter()
            .sum();
        // Near a base circle the involute is as sharp as one likes; a tenth of the other radius is as small as the patch goes.
        let least = 0.1 * radii[0].max(radii[1]);
        let [rho_1, rho_2] = radii.map(|radius| radius.max(least));
        let rho = rho_1 * rho_2 / (rho_1 + rho_2);
        let half_width = contact_width(load * factors, rho, facing.opening_angle());
        let reach = PATCH_HALF_WIDTH * widening * half_width;
        let range = facing.range;
        let (from, to) = (
            (facing.nearest - reach).max(range.from),
            (facing.nearest + reach).min(range.to),
        );
        let cell_width = (to - from) / count as f64;
        Self {
            pair: facing.pair,
            seat: facing.seat,
            from,
            cell_width,
            cells: (0..count)
                .filter_map(|i| facing.cell(from + (i as f64 + 0.5) * cell_width, cell_width))
                .collect(),
            ends: [
                (from <= range.from).then_some(range.ends[0]),
                (to >= range.to).then_some(range.ends[1]),
            ],
            near_fields: Member::BOTH
                .map(|member| NearField::new(gears.gear(member), radii[member.index()], width)),
            off_path: facing.off_path,
        }
    }
}

impl Cell {
    /// The gap between `teeth` of `pair`, the driving and the driven one, with their deviations from the drawing.
    pub(super) fn gap_between(&self, pair: &GearPair, teeth: [usize; 2]) -> f64 {
        let deviations = Member::BOTH.map(|member| {
            let g = member.index();
            pair.gear(member).deviation(teeth[g], self.roll_lengths[g])
        });
        self.gap - deviations[0] - deviations[1]
    }
}

impl Patch {
    /// Where the cells begin and end, by arc length on the seat's flank.
    pub fn reach(&self) -> (f64, f64) {
        (
            self.from,
            self.from + self.cell_width * self.cells.len() as f64,
        )
    }

    /// What ends the contact of the `active` cells where it reaches an end of the flanks.
    pub fn ended_by(&self, active: &[bool]) -> Vec<RangeEnd> {
        let first = self.ends[0].filter(|_| active.first() == Some(&true));
        let last = self.ends[1].filter(|_| active.last() == Some(&true));
        first.into_iter().chain(last).collect()
    }
}

/// How far a contact reaches from its middle or from its corner, where the gap opens as σ x + x²/(2 ρ).
///
/// Without an angle σ this is Hertz's half-width, a² = 2 ρ c F. A tilted corner on a half plane presses with
/// p ~ √((L − x)/x) over the width L = 2 c F/σ. The root between them has both as its limits.
fn contact_width(indentation: f64, radius: f64, angle: f64) -> f64 {
    // σ L/2 + L²/(2 ρ) = c F, without the difference of like numbers.
    let root = (angle * angle + 8.0 * indentation / radius).sqrt();
    4.0 * indentation / (angle + root)
}

impl Facing<'_> {
    /// What belongs to the seat and to the other gear, as driving and driven.
    pub(super) fn on_both<T: Copy>(&self, seat: T, other: T) -> [T; 2] {
        match self.seat {
            Member::Driving => [seat, other],
            Member::Driven => [other, seat],
        }
    }

    /// A cell of width `width` about `arc`; `None` inside the other base circle.
    pub(super) fn cell(&self, arc: f64, width: f64) -> Option<Cell> {
        // The mean gap of the cell, by two Gauss points.
        let offset = width / 12.0_f64.sqrt();
        let (before, after) = (self.point(arc - offset)?.gap, self.point(arc + offset)?.gap);
        let here = self.point(arc)?;
        let (place, sight) = (here.place, here.sight);
        // Pressed together both flanks turn to a common normal between their own.
        let normal = (sight.normal - place.normal).normalize();
        let on_seat = [-normal.dot(&place.normal), -normal.dot(&place.to_tip)];
        let on_mate = [normal.dot(&sight.normal), normal.dot(&sight.tipward())];
        // The driven gear is pressed away from the driving flank, where its own flank stands.
        let (at, push) = match self.seat {
            Member::Driving => (place.point - sight.gap * sight.normal, -normal),
            Member::Driven => (place.point, normal),
        };
        Some(Cell {
            roll_lengths: self.on_both(here.roll_length, sight.roll_length),
            directions: self.on_both(on_seat, on_mate),
            gap: f64::midpoint(before, after),
            arm: self.placement().arm(at, push),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::SpurGear;
    use crate::gear::spur::tests::paper_gear;

    fn pair() -> GearPair {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes")
    }

    fn patch(pair: &GearPair, eta: f64, n: i64, count: usize) -> Patch {
        let facing = Facing::of(pair, eta, n, 0).expect("flanks that face each other");
        Patch::new(&facing, 2447.61, count, 1.0)
    }

    #[test]
    fn conjugate_flanks_touch_on_the_line_of_action_with_arm_one() {
        let pair = pair();
        for (eta, n) in [(0.0, 0), (0.3, 0), (0.3, 1), (0.7, 1), (-0.25, 0)] {
            let patch = patch(&pair, eta, n, 40);
            let s = pair.roll_length_of(eta - n as f64);
            // At x beside the line of action both normals are turned against each other by x (1/s_1 + 1/s_2): half of that
            // tilts the force, whose arm then differs by s_2 times it.
            let other = pair.line_of_action() - s;
            let tilt = 20.0 * patch.cell_width * (1.0 / s + 1.0 / other) / 2.0;
            let most = 1.1 * tilt * other / pair.driven().base_radius();
            assert!(patch.cells.iter().all(|cell| (cell.arm - 1.0).abs() < most));
            let nearest = patch
                .cells
                .iter()
                .min_by(|a, b| a.gap.total_cmp(&b.gap))
                .expect("cells");
            // Half a cell beside it: along a roll length a cell is r_b/s of its width.
            let cell =
                patch.cell_width * pair.driving().base_radius() / s.min(pair.line_of_action() - s);
            assert!((nearest.roll_lengths[0] - s).abs() < 0.51 * cell);
            let sum = nearest.roll_lengths[0] + nearest.roll_lengths[1];
            assert!((sum - pair.line_of_action()).abs() < cell);
        }
    }

    #[test]
    fn the_gap_beside_the_contact_is_the_parabola_of_the_relative_curvature() {
        let patch = patch(&pair(), 0.2, 0, 41);
        let (center, end) = (patch.cells[20], patch.cells[36]);
        let x = 16.0 * patch.cell_width;
        let curvature = 1.0 / center.roll_lengths[0] + 1.0 / center.roll_lengths[1];
        assert!(
            ((end.gap - center.gap) / (x * x / 2.0 * curvature) - 1.0).abs() < 0.03,
            "third-order terms are x/ρ"
        );
    }

    #[test]
    fn past_the_path_of_contact_the_patch_ends_at_the_tip_corner_of_either_gear() {
        let pair = pair();
        let (s_a, s_e) = pair.path_of_contact();
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        for (eta, seat) in [
            (periods(s_a) - 0.1, Member::Driven),
            (periods(s_e) + 0.1, Member::Driving),
        ] {
            let patch = patch(&pair, eta, 0, 40);
            assert!(patch.off_path && patch.seat == seat);
            assert_eq!(patch.ends, [None, Some(RangeEnd::Tip)]);
            let last = patch.cells.last().expect("cells");
            assert!(patch.cells.iter().all(|cell| cell.gap >= last.gap));
        }
    }

    #[test]
    fn a_contact_is_as_wide_as_hertz_or_as_the_tilted_corner_has_it() {
        let (indentation, radius) = (7e-7, 9e-3);
        let hertz = (2.0_f64 * indentation * radius).sqrt();
        assert!((contact_width(indentation, radius, 0.0) / hertz - 1.0).abs() < 1e-14);
        // At an angle where the parabola is small beside the tilt: their ratio is L/(ρ σ) = 1.6e-4.
        let tilted = contact_width(indentation, radius, 1.0);
        assert!((tilted / (2.0 * indentation) - 1.0).abs() < 2e-4);
    }
}
