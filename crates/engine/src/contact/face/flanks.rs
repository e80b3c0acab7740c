//! The flanks of a pair along their faces before they yield: where they touch first, and how far they stand apart.

use std::cell::Cell;
use std::sync::OnceLock;

use crate::contact::light::{FirstTouch, TOGETHER, first, on_path, touching_near};
use crate::contact::memo::Memo;
use crate::contact::{MeshContact, PositionError};
use crate::gear::{GearPair, Member, PairDeviations, SolidPair};
use crate::root_finding::{crossing, least_places};
use crate::touch::gap_profile::{FirstContact, GapProfile, nearer_tip};
use crate::touch::placement::Section;

/// The flanks of a pair along their faces.
pub struct FaceFlanks {
    pub(super) pair: SolidPair,
    pub(super) deviations: PairDeviations,
    /// One meter of the flanks as drawn.
    pub(super) plane_strain: GearPair,
    /// Slices of the whole face.
    pub(super) slices: usize,
    /// The phases on the path of contact at which sections are nearest, once they are asked for.
    nearest: OnceLock<Vec<f64>>,
    /// [`FaceFlanks::phases_within`] of the last few, by the bits of δ.
    within: Memo<u64, [f64; 2]>,
}

/// How many ranges of phases are known, in bytes.
const MOST_BYTES: usize = 64 * size_of::<[f64; 2]>();

impl FaceFlanks {
    /// Flanks of `pair`, its face cut into `slices` slices.
    pub fn new(pair: SolidPair, slices: usize) -> Self {
        Self {
            deviations: pair.section().deviations(),
            plane_strain: pair.section().plane_strain(),
            pair,
            slices,
            nearest: OnceLock::new(),
            within: Memo::new(MOST_BYTES, size_of_val),
        }
    }

    /// The same, whose teeth have these `deviations`.
    pub fn deviating(self, deviations: PairDeviations) -> Self {
        let Self { pair, slices, .. } = self;
        Self {
            deviations,
            ..Self::new(pair, slices)
        }
    }

    /// The moduli of both gears in plane strain.
    pub(super) fn moduli(&self) -> [f64; 2] {
        Member::BOTH.map(|member| self.plane_strain.gear(member).material().youngs_modulus)
    }

    /// The limit of the contact at the mesh position `eta` as the load goes to zero: δ is that at which the first of the flanks touch.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn light_contact(&self, eta: f64) -> Result<MeshContact, PositionError> {
        MeshContact::of_first(0.0, &self.touches(eta), self.rounding())
    }

    /// The δ at which the first flanks touch at the position `eta`, on the path of contact or off it.
    pub fn least_touch(&self, eta: f64) -> Option<f64> {
        Some(first(&self.touches(eta))).filter(|touch| touch.is_finite())
    }

    /// Where each pair touches at the position `eta` that may be the first.
    fn touches(&self, eta: f64) -> Vec<FirstTouch> {
        let beside = 0.5 * self.pair.overlap_ratio();
        let slopes = Member::BOTH.map(|member| self.deviations.of_gear(member).largest_lead());
        let apart = 2.0 * (self.deviations.nearest() + slopes[0] + slopes[1]) + self.rounding();
        let pairs = on_path(self.pair.section(), eta, beside);
        touching_near(pairs, apart, |n| self.touch_of(eta, n))
    }

    /// Where pair `n` touches first at the position `eta`: in that of its sections which does.
    fn touch_of(&self, eta: f64, n: i64) -> Option<FirstTouch> {
        let half = 0.5 * self.pair.common_face_width();
        let last = Cell::new(None);
        let touch = |z: f64| {
            let section = self.section(eta, n, z);
            // Straight teeth without leads face each other alike in all sections.
            let known = last.get().filter(|(of, _)| *of == section);
            let touch = match known {
                Some((_, touch)) => touch,
                None => self
                    .touching(section)
                    .map(|touching| FirstTouch::of(n, &touching.facing, touching.delta())),
            };
            last.set(Some((section, touch)));
            let touch = touch?;
            Some(FirstTouch {
                delta: touch.delta + self.pair.misalignment_gap(z),
                ..touch
            })
        };
        let delta = |z: f64| touch(z).map_or(f64::INFINITY, |touch| touch.delta);
        let places = least_places([-half, half], self.slices, self.rounding(), delta);
        let touches = places.into_iter().filter_map(|(z, _)| touch(z));
        touches.min_by(|a, b| a.delta.total_cmp(&b.delta))
    }

    /// The teeth of pair `n` in the section at `z` at the position `eta`.
    pub(super) fn section(&self, eta: f64, n: i64, z: f64) -> Section {
        let (pair, deviations) = (&self.pair, &self.deviations);
        let twist = |member: Member| pair.gear(member).twist() * pair.own_height(member, z);
        Section {
            pair: n,
            phase: pair.phase(eta, n, z),
            removed: pair.removed_by_leads(deviations, pair.section().teeth(n), z),
            twists: Member::BOTH.map(twist),
        }
    }

    /// The flanks in a `section` where they just touch; `None` where they do not face each other.
    pub(super) fn touching(&self, section: Section) -> Option<FirstContact<'_>> {
        // In modules: 20 nm at 2 mm. So short a way is straight to 0.1 nm.
        const NEAR: f64 = 1e-5;
        let (gears, deviations) = (&self.plane_strain, &self.deviations);
        let s_1 = gears.roll_length_of(section.phase);
        let nominal = [s_1, gears.line_of_action() - s_1];
        // On the path of contact they nearly touch so.
        let missing = Member::BOTH.map(|member| {
            let (g, gear) = (member.index(), gears.gear(member));
            let s = nominal[g].clamp(gear.form_roll_length(), gear.tip_roll_length());
            let (tooth, twist) = (gears.tooth(member, section.pair), section.twists[g]);
            section.removed[g] + deviations.of_gear(member).missing(gear, tooth, s, twist)
        });
        let primary = nearer_tip(gears, section.phase);
        let within = NEAR * gears.driving().data().rack.module;
        let from = missing[0] + missing[1];
        FirstContact::of((gears, deviations), section, primary, from, within)
    }

    /// How far the driving tooth of a `section` stands ahead of the drawing, in mesh periods.
    pub(super) fn ahead(&self, section: Section) -> f64 {
        let driving = self.deviations.of_gear(Member::Driving);
        let [tooth, _] = self.pair.section().teeth(section.pair);
        (driving.turn(tooth) - section.removed[0]) / self.pair.section().base_pitch()
    }

    /// The phases between `from` and `to` at which sections as drawn are nearer to each other than those beside them, rising; looked for from `step`
    /// to `step`.
    fn nearest_phases(&self, [from, to]: [f64; 2], step: f64) -> Vec<f64> {
        let count = ((to - from) / step).ceil() as usize;
        let touch = |phase: f64| self.drawn_touch(phase);
        let found = least_places([from, to], count, self.rounding(), touch);
        found.into_iter().map(|(phase, _)| phase).collect()
    }

    /// How far leads, deviations and the axes may bring flanks nearer to each other than their sections are.
    fn nearer(&self) -> f64 {
        const PLACES: usize = 33;
        let half = 0.5 * self.pair.common_face_width();
        let at = |i: usize| half * (2.0 * i as f64 / (PLACES - 1) as f64 - 1.0);
        let counts = Member::BOTH.map(|member| self.pair.section().gear(member).tooth_count());
        let pairs = counts[0].max(counts[1]) as usize;
        let pairs = if self.deviations.are_none() { 1 } else { pairs };
        let least = (0..pairs).map(|pair| {
            let teeth = counts.map(|count| pair % count as usize);
            let gaps: [f64; PLACES] =
                std::array::from_fn(|i| self.pair.lead_gap(&self.deviations, teeth, at(i)));
            // Between two places a gap is less than at both by no more than they differ somewhere.
            let steps = gaps.windows(2).map(|gaps| (gaps[1] - gaps[0]).abs());
            gaps.into_iter().fold(f64::INFINITY, f64::min) - steps.fold(0.0, f64::max)
        });
        self.deviations.nearest() - least.fold(f64::INFINITY, f64::min)
    }

    /// The phases between which sections may touch before δ is `reach`.
    pub(super) fn phases_within(&self, reach: f64) -> [f64; 2] {
        *self
            .within
            .get(reach.to_bits(), |_| self.phases_that_touch(reach))
    }

    fn phases_that_touch(&self, reach: f64) -> [f64; 2] {
        const STEP: f64 = 1.0 / 32.0;
        let limit = reach + self.nearer();
        let closed = |phase: f64| limit - self.drawn_touch(phase);
        let touches = |phase: f64| closed(phase) >= 0.0;
        let (s_a, s_e) = self.pair.section().path_of_contact();
        let ends = [s_a, s_e].map(|s| self.pair.phase_at(s));
        let nearest = self.nearest.get_or_init(|| self.nearest_phases(ends, STEP));
        let outermost = |end: f64, way: f64, other: f64| {
            let mut out = end + way;
            while touches(out) {
                out += way;
            }
            let (mut outside, mut inside) = (out, out);
            while !touches(inside) && (inside - other) * way > 0.0 {
                outside = inside;
                inside -= way * STEP;
                // A range of phases that touch may be narrower than a step: the phase in it at which flanks are nearest is not stepped over.
                let first = |a: f64, b: f64| if (b - a) * way > 0.0 { b } else { a };
                let ahead = nearest
                    .iter()
                    .filter(|phase| (outside - **phase) * way > 0.0);
                inside = ahead.copied().fold(inside, first);
            }
            let [good, bad] = [inside, outside].map(|phase| (phase, closed(phase)));
            if good.1 < 0.0 {
                return inside;
            }
            crossing(good, bad, closed)
        };
        [
            outermost(ends[0], -1.0, ends[1]),
            outermost(ends[1], 1.0, ends[0]),
        ]
    }

    /// The δ at which sections at `phase` as drawn touch, seen from where they are drawn; infinite where they do not face each other.
    fn drawn_touch(&self, phase: f64) -> f64 {
        let facing = GapProfile::drawn(&self.plane_strain, phase);
        facing.map_or(f64::INFINITY, |facing| facing.touch())
    }

    fn rounding(&self) -> f64 {
        TOGETHER * self.pair.section().driving().data().rack.module
    }
}
