//! Two flanks that face each other: where they are nearest, and how far either sees the other.

use super::meeting::FlankPoint;
use super::placement::{FacingPoint, Pose, Section};
use crate::gear::{GearPair, Member, PairDeviations, SpurGear};
use crate::root_finding::crossing;

/// Places besides kinks between which minima of the gap are searched on flanks that are not convex.
const PLACES: u32 = 64;

/// Rounding of coordinates, in meters.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Flanks meet only where a force along their common normal has at least this arm about both axes, over the base radii.
///
/// The normal of an involute has an arm of 1 about its own axis, and that at the top of a rounded tip has none. The mean of such two directions has at least
/// half of the arm. It has less only where both flanks are roundings and turn away from the line of action: they pass each other there and do not drive.
const LEAST_ARM: f64 = 0.5;

/// Turns to the touching flanks; each squares the remainder.
pub(crate) const MOST_TURNS: u32 = 4;

/// End of the part of a flank from which the other flank is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangeEnd {
    /// Its own fillet begins.
    Fillet,
    /// Its own tip.
    Tip,
    /// The fillet of the other gear begins.
    SecondaryFillet,
    /// The tip of the other gear.
    SecondaryTip,
}

/// A stretch of flank, by arc length from the base circle, and its ends on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankRange {
    /// Where it begins, nearer to the root.
    pub from: f64,
    /// Where it ends, nearer to the tip.
    pub to: f64,
    /// Kinds of the ends.
    pub ends: [RangeEnd; 2],
}

/// A place at which the gap is less than on either side of it.
#[derive(Debug, Clone, Copy)]
pub struct GapMinimum {
    /// By arc length on the primary flank.
    pub arc: f64,
    /// The δ at which the flanks touch there.
    pub touch: f64,
    /// Roll length on the driving and on the driven gear.
    pub roll_lengths: [f64; 2],
    /// The arms about the driving and the driven axis of a force there.
    pub arms: [f64; 2],
    /// How fast the gap opens towards the root and towards the tip: nothing where flanks touch with a common tangent, the angle between
    /// them where a corner is nearest.
    pub openings: [f64; 2],
    pub(crate) flank_point: FlankPoint,
}

/// Two flanks that face each other.
///
/// One of them is seen from the other: points are given by their arc length on the flank of `primary`, the gear whose
/// tip is nearer to the contact, so that the stretch may end at its tip corner.
#[derive(Debug, Clone)]
pub struct GapProfile {
    /// The gear on whose flank points are given.
    pub primary: Member,
    /// The part of its flank that faces the other.
    pub range: FlankRange,
    /// Where the gap is least, the first to touch first; never empty.
    pub minima: Vec<GapMinimum>,
    /// Rising places within the range at which either flank has a kink.
    pub kinks: Vec<f64>,
    /// Places at which a flank ends in the corner of its undercut.
    pub corners: Vec<f64>,
    /// True if the nominal contact lies past the primary gear's tip, off the path of contact, and the corner of an undercut flank is not the one that touches.
    pub off_path: bool,
}

impl GapProfile {
    /// How the flanks of a pair of `gears` as drawn face each other, `phase` mesh periods after it passed the pitch point, seen from the gear
    /// whose tip is nearer; `None` where they do not.
    pub fn drawn(gears: &GearPair, phase: f64) -> Option<Self> {
        Self::drawn_on(gears, phase, nearer_tip(gears, phase))
    }

    /// As [`GapProfile::drawn`], seen from the flank of `primary`.
    pub fn drawn_on(gears: &GearPair, phase: f64, primary: Member) -> Option<Self> {
        Pose::drawn(gears, phase, primary).facing(phase)
    }

    /// How the flanks of pair `n` of `gears` with these `deviations` face each other at the mesh position `eta`, the driven gear lagging by
    /// `lag`.
    pub fn real(
        gears: &GearPair,
        deviations: &PairDeviations,
        eta: f64,
        n: i64,
        lag: f64,
    ) -> Option<Self> {
        let section = Section::straight(eta, n);
        let primary = nearer_tip(gears, section.phase);
        let placed = (primary, section.phase);
        Pose::real((gears, deviations), section, lag, placed).facing(section.phase)
    }

    /// About how much memory it takes beside itself, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.minima.as_slice())
            + size_of_val(self.kinks.as_slice())
            + size_of_val(self.corners.as_slice())
    }

    /// The δ at which the flanks touch first.
    pub fn touch(&self) -> f64 {
        self.minima[0].touch
    }

    /// True if the tip corner of the other gear touches first.
    pub(crate) fn is_at_secondary_tip(&self) -> bool {
        let arc = self.minima[0].arc;
        let FlankRange { from, to, ends } = self.range;
        [from, to]
            .into_iter()
            .zip(ends)
            .any(|(end, by)| end == arc && by == RangeEnd::SecondaryTip)
    }
}

/// The gear whose tip is nearer to the contact.
pub(crate) fn nearer_tip(gears: &GearPair, phase: f64) -> Member {
    let (s_a, s_e) = gears.path_of_contact();
    // Past the middle of the path of contact the contact is nearer to the driving tip, which leaves it at E. A pair that stands
    // just there is assigned to the same gear however its numbers are rounded.
    let middle = f64::midpoint(s_a, s_e) + 1e-9 * (s_e - s_a);
    if gears.roll_length_of(phase) > middle {
        Member::Driving
    } else {
        Member::Driven
    }
}

/// Two flanks as they face each other where they just touch.
#[derive(Debug, Clone)]
pub(crate) struct FirstContact<'a> {
    pub(crate) view: Pose<'a>,
    pub(crate) facing: GapProfile,
    /// How far the driven gear lags there. The rest of the way, [`GapProfile::touch`], is so short that it is straight.
    pub(crate) lag: f64,
}

impl<'a> FirstContact<'a> {
    /// The flanks of `pair` with these `deviations` in a `section`, seen from that of `primary`: turned on from the lag `from` until they touch `within`
    /// so long a way.
    pub(crate) fn of(
        made: (&'a GearPair, &'a PairDeviations),
        section: Section,
        primary: Member,
        from: f64,
        within: f64,
    ) -> Option<Self> {
        let at = |lag: f64| {
            let view = Pose::real(made, section, lag, (primary, section.phase));
            let facing = view.facing(section.phase)?;
            Some(Self { view, facing, lag })
        };
        // Seen from afar a corner touches elsewhere than it does: by the square of the way.
        let mut touching = at(from)?;
        for _ in 0..MOST_TURNS {
            if touching.facing.touch().abs() < within {
                break;
            }
            // Where flanks cease to face each other on the way they touch about where it was straight.
            let Some(nearer) = at(touching.delta()) else {
                break;
            };
            touching = nearer;
        }
        Some(touching)
    }

    /// The δ at which they touch.
    pub(crate) fn delta(&self) -> f64 {
        self.lag + self.facing.touch()
    }
}

impl Pose<'_> {
    /// Values of the primary and of the other gear, as driving and driven.
    pub(crate) fn on_both<T: Copy>(&self, primary: T, other: T) -> [T; 2] {
        match self.primary {
            Member::Driving => [primary, other],
            Member::Driven => [other, primary],
        }
    }

    /// How they face each other, `phase` mesh periods after they passed the pitch point.
    pub(crate) fn facing(&self, phase: f64) -> Option<GapProfile> {
        let gears = self.pair;
        let s_1 = gears.roll_length_of(phase);
        let [nominal, _] = self.on_both(s_1, gears.line_of_action() - s_1);
        let range = self.range()?;
        let (kinks, corners) = (self.kinks(&range), self.corners(&range));
        let places = self.least_places(&range, &kinks).into_iter();
        let mut minima: Vec<GapMinimum> =
            places.filter_map(|arc| self.minimum(arc, &range)).collect();
        minima.sort_by(|a, b| a.touch.total_cmp(&b.touch));
        let first = minima.first()?.arc;
        Some(GapProfile {
            primary: self.primary,
            range,
            off_path: nominal > gears.gear(self.primary).tip_form_roll_length()
                && !corners.contains(&first),
            minima,
            kinks,
            corners,
        })
    }

    /// The point at `arc` of the primary flank; `None` inside the other base circle.
    pub(crate) fn point(&self, arc: f64) -> Option<FacingPoint> {
        let flank = self.pair.gear(self.primary).flank();
        self.point_at(flank.roll_length_at_arc(arc))
    }

    /// `point`, to be evaluated at many positions.
    pub(crate) fn flank_point(&self, point: &FacingPoint) -> FlankPoint {
        let opposite = self.pair.gear(self.primary.other());
        let (center, _) = self.frame(self.primary);
        FlankPoint::new(point, opposite.removed(point.gap.roll_length), center)
    }

    /// The roll length that `arc` sees on the other flank; it falls towards the primary gear's tip.
    fn seen_from(&self, arc: f64) -> f64 {
        self.point(arc)
            .map_or(f64::NEG_INFINITY, |point| point.gap.roll_length)
    }

    /// The part of the primary flank that sees the other flank between its form circle, or somewhat below the corner of its undercut, and its tip, as far as
    /// a force between both drives the driven gear ([`LEAST_ARM`]).
    pub(crate) fn range(&self) -> Option<FlankRange> {
        let range = self.seen_range()?;
        let beyond_least = |arc: f64| {
            let arms = self.point(arc).map(|point| self.gap_and_arms(&point).arms);
            arms.map_or(f64::NEG_INFINITY, |arms| arms[0].min(arms[1]) - LEAST_ARM)
        };
        let ends = [range.from, range.to].map(|arc| (arc, beyond_least(arc)));
        let drives = |(_, beyond_least): (f64, f64)| beyond_least >= 0.0;
        if ends.into_iter().all(drives) {
            return Some(range);
        }
        // Arms are longest about where the flanks are parallel, and shorter towards either tip.
        let parallel = self.least_between(range.from, range.to, &[]);
        let parallel = (parallel, beyond_least(parallel));
        if !drives(parallel) {
            return None;
        }
        let [from, to] = ends.map(|end| {
            if drives(end) {
                end.0
            } else {
                crossing(parallel, end, beyond_least)
            }
        });
        (from < to).then_some(FlankRange { from, to, ..range })
    }

    /// The part of the primary flank that sees the other flank, whether a force there drives or not.
    fn seen_range(&self) -> Option<FlankRange> {
        let (gear, secondary) = (
            self.pair.gear(self.primary),
            self.pair.gear(self.primary.other()),
        );
        // The face of a chamfer is far from the other flank; its edge is the corner that touches.
        let (_, high) = gear.flank_arcs();
        let low = gear.flank().arc_length(gear.lowest_roll_length());
        let high = gear
            .chamfer_edge()
            .map_or(high, |s| gear.flank().arc_length(s));
        let form = secondary.lowest_roll_length();
        let tip = secondary
            .chamfer_edge()
            .unwrap_or(secondary.tip_roll_length());
        let (mut from, mut to) = ((low, RangeEnd::Fillet), (high, RangeEnd::Tip));
        let [seen_low, seen_high] = [low, high].map(|arc| self.seen_from(arc));
        if seen_high > tip || seen_low < form {
            return None;
        }
        if seen_low > tip {
            let ends = [(high, tip - seen_high), (low, tip - seen_low)];
            let sought = |arc: f64| tip - self.seen_from(arc);
            from = (crossing(ends[0], ends[1], sought), RangeEnd::SecondaryTip);
        }
        if seen_high < form {
            let ends = [(low, seen_low - form), (high, seen_high - form)];
            let sought = |arc: f64| self.seen_from(arc) - form;
            to = (
                crossing(ends[0], ends[1], sought),
                RangeEnd::SecondaryFillet,
            );
        }
        (from.0 < to.0).then_some(FlankRange {
            from: from.0,
            to: to.0,
            ends: [from.1, to.1],
        })
    }

    /// The rising places within `range` at which either flank has a kink.
    fn kinks(&self, range: &FlankRange) -> Vec<f64> {
        self.places_of(SpurGear::kinks, range)
    }

    /// The rising places within `range` at which either flank has the corner of its undercut.
    fn corners(&self, range: &FlankRange) -> Vec<f64> {
        let corner = |gear: &SpurGear| {
            let corner = gear.is_undercut().then(|| gear.form_roll_length());
            corner.into_iter().collect()
        };
        self.places_of(corner, range)
    }

    /// The rising places within `range` of the roll lengths `of` either gear.
    fn places_of(&self, of: impl Fn(&SpurGear) -> Vec<f64>, range: &FlankRange) -> Vec<f64> {
        let [gear, secondary] =
            [self.primary, self.primary.other()].map(|member| self.pair.gear(member));
        let own = of(gear).into_iter();
        let own = own.map(|s| gear.flank().arc_length(s));
        let seen = of(secondary).into_iter();
        let mut places: Vec<f64> = own
            .chain(seen.filter_map(|s| self.arc_that_sees(s, range)))
            .filter(|arc| range.from < *arc && *arc < range.to)
            .collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    }

    /// The arc that sees the roll length `sought` of the other flank, within `range` where that is undercut.
    fn arc_that_sees(&self, sought: f64, range: &FlankRange) -> Option<f64> {
        const STEPS: u32 = 12;
        let (gear, secondary) = (
            self.pair.gear(self.primary),
            self.pair.gear(self.primary.other()),
        );
        // The corner of an undercut flank touches far off the line of action, and beside it the secondary passes the base circle.
        if secondary.is_undercut() {
            let beyond = |arc: f64| self.seen_from(arc) - sought;
            let [from, to] = [range.from, range.to].map(|arc| (arc, beyond(arc)));
            let within = from.1 >= 0.0 && to.1 < 0.0;
            return within.then(|| crossing(from, to, beyond));
        }
        // Flanks that touch share the line of action.
        let opposite = self.pair.line_of_action() - sought;
        let mut arc = gear.flank().arc_length(opposite.max(0.0));
        for _ in 0..STEPS {
            let point = self.point(arc)?;
            let missed = sought - point.gap.roll_length;
            if missed.abs() <= 1e-15 * secondary.base_radius() {
                break;
            }
            let (_, growth) = self.change(&point);
            arc = (arc + missed / growth).max(0.0);
        }
        Some(arc)
    }

    /// Where the gap has minima.
    ///
    /// The gap is a parabola about the nominal contact plus reliefs that grow towards either tip: convex, and least where its slope changes sign, or at an end.
    /// Modifications of other kinds may give it several minima; between kinks each is found in the same way.
    fn least_places(&self, range: &FlankRange, kinks: &[f64]) -> Vec<f64> {
        let FlankRange { from, to, .. } = *range;
        if self.pair.driving().is_convex() && self.pair.driven().is_convex() {
            return vec![self.least_between(from, to, kinks)];
        }
        let evenly = (0..=PLACES).map(|i| from + (to - from) * f64::from(i) / f64::from(PLACES));
        let mut places: Vec<f64> = evenly.chain(kinks.iter().copied()).collect();
        places.sort_by(f64::total_cmp);
        // Just beside a kink the slope is that of its own side.
        let beside = 1e-9 * (to - from);
        places.dedup_by(|a, b| (*a - *b).abs() < 4.0 * beside);
        let mut found = Vec::new();
        // True if the gap falls just before the place.
        let mut falling = true;
        for pair in places.windows(2) {
            let (low, high) = (pair[0] + beside, pair[1] - beside);
            let [begins, ends] = [low, high].map(|arc| (arc, self.fall(arc)));
            if falling && begins.1 <= 0.0 {
                found.push(pair[0]);
            }
            if begins.1 > 0.0 && ends.1 <= 0.0 {
                found.push(crossing(begins, ends, |arc| self.fall(arc)));
            }
            falling = ends.1 > 0.0;
        }
        if falling {
            found.push(to);
        }
        found
    }

    /// Where the gap is least between the arcs `low` and `high`, between which it falls and then rises, with these `kinks` in between.
    fn least_between(&self, low: f64, high: f64, kinks: &[f64]) -> f64 {
        // Just beside a kink the slope is that of its own side.
        let beside = 1e-9 * (high - low);
        let mut from = (low, self.fall(low));
        if from.1 <= 0.0 {
            return low;
        }
        for kink in kinks {
            let before = (kink - beside, self.fall(kink - beside));
            if before.1 <= 0.0 {
                return crossing(from, before, |arc| self.fall(arc));
            }
            let behind = (kink + beside, self.fall(kink + beside));
            if behind.1 <= 0.0 {
                return *kink;
            }
            from = behind;
        }
        let to = (high, self.fall(high));
        if to.1 > 0.0 {
            return high;
        }
        crossing(from, to, |arc| self.fall(arc))
    }

    /// How fast the gap falls along the primary flank, towards its tip.
    fn fall(&self, arc: f64) -> f64 {
        -self.slope(arc)
    }

    fn minimum(&self, arc: f64, range: &FlankRange) -> Option<GapMinimum> {
        let point = self.point(arc)?;
        let met = self.gap_and_arms(&point);
        let beside = 1e-6 * (range.to - range.from);
        let opening = |place: f64, sign: f64| {
            let inside = range.from <= place && place <= range.to;
            inside.then(|| (sign * self.slope(place)).max(0.0))
        };
        Some(GapMinimum {
            arc,
            touch: met.gap / met.arms[1],
            roll_lengths: self.on_both(point.roll_length, point.gap.roll_length),
            arms: met.arms,
            openings: [
                opening(arc - beside, -1.0).unwrap_or_default(),
                opening(arc + beside, 1.0).unwrap_or_default(),
            ],
            flank_point: self.flank_point(&point),
        })
    }

    /// The least distance between the tip of the primary, as far as it stands below the flank of the other gear within `range`, and the
    /// fillet there; `None` where the tip does not reach below that flank.
    pub(crate) fn tip_to_fillet(&self, range: &FlankRange) -> Option<f64> {
        const TIP_POINTS: u32 = 8;
        if range.ends[1] != RangeEnd::SecondaryFillet {
            return None;
        }
        let gear = self.pair.gear(self.primary);
        let (_, tip) = gear.flank_arcs();
        let tip = gear
            .chamfer_edge()
            .map_or(tip, |s| gear.flank().arc_length(s));
        let gaps = (1..=TIP_POINTS).map(|i| {
            let arc = range.to + (tip - range.to) * f64::from(i) / f64::from(TIP_POINTS);
            let s = gear.flank().roll_length_at_arc(arc);
            self.fillet_distance(self.place(s).point)
        });
        gaps.reduce(f64::min)
    }

    /// The slope of the gap along the primary flank, towards its tip.
    fn slope(&self, arc: f64) -> f64 {
        self.point(arc).map_or(0.0, |point| self.change(&point).0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart};

    fn pair(relief: Option<ReliefShape>) -> GearPair {
        let mut data = paper_gear(50);
        let relief = relief.map(|shape| ReliefData {
            amount: 5e-6,
            shape,
            start: ReliefStart::RadialLength(1.75e-3),
        });
        data.modifications
            .extend(relief.map(ModificationData::TipRelief));
        let gear = SpurGear::new(data).expect("the standard gear");
        GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes")
    }

    /// 40 and 80 teeth with shifts ±1.1: the path of contact lies beside the pitch point.
    fn recess_pair() -> GearPair {
        let gear = |tooth_count, profile_shift| {
            let mut data = paper_gear(tooth_count);
            data.profile_shift = profile_shift;
            data.rack.tip_radius = 0.2e-3;
            SpurGear::new(data).expect("a gear that can be made")
        };
        GearPair::new(gear(40, 1.1), gear(80, -1.1), 120.2e-3).expect("meshes")
    }

    #[test]
    fn unrelieved_flanks_touch_all_along_the_path_of_contact_wherever_it_lies() {
        for pair in [pair(None), recess_pair()] {
            let (s_a, s_e) = pair.path_of_contact();
            for i in 0..=40 {
                let s = s_a + (s_e - s_a) * f64::from(i) / 40.0;
                let eta = (s - pair.pitch_roll_length()) / pair.base_pitch();
                for primary in Member::BOTH {
                    let facing = GapProfile::drawn_on(&pair, eta, primary).expect("they touch");
                    let touch = facing.touch();
                    assert!(touch.abs() < 1e-15, "{primary} at {s}: {touch}");
                }
            }
        }
    }

    #[test]
    fn the_gear_whose_tip_is_nearer_is_the_primary_one() {
        let pair = recess_pair();
        let (s_a, s_e) = pair.path_of_contact();
        assert!(s_a > pair.pitch_roll_length(), "all of the path is recess");
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        for (s, primary, off_path) in [
            (s_a - 0.2e-3, Member::Driven, true),
            (s_a + 0.2e-3, Member::Driven, false),
            (s_e - 0.2e-3, Member::Driving, false),
            (s_e + 0.2e-3, Member::Driving, true),
        ] {
            let facing = GapProfile::drawn(&pair, periods(s)).expect("they face each other");
            assert_eq!((facing.primary, facing.off_path), (primary, off_path));
            assert_eq!(
                facing.minima[0].arc == facing.range.to,
                off_path,
                "a corner is nearest"
            );
        }
    }

    #[test]
    fn gaps_past_the_path_of_contact_grow_until_the_flanks_face_each_other_no_more() {
        for pair in [pair(None), recess_pair()] {
            let mut last = 0.0;
            let faces = (0..200).take_while(|i| {
                let (_, s_e) = pair.path_of_contact();
                let s = s_e + 0.2e-3 * f64::from(*i);
                let eta = (s - pair.pitch_roll_length()) / pair.base_pitch();
                GapProfile::drawn(&pair, eta).is_some_and(|facing| {
                    assert!(facing.touch() >= last);
                    last = facing.touch();
                    true
                })
            });
            let count = faces.count();
            assert!(count > 5 && count < 200, "{count}");
        }
    }

    /// 10 and 80 teeth of module 1 at their reference distance: the pinion's flank begins at a radius of 4.7256 mm.
    pub(crate) fn undercut_pair() -> GearPair {
        let gear = |tooth_count| {
            let mut data = paper_gear(tooth_count);
            data.rack = crate::gear::Rack::profile_a(1e-3);
            data.blank.bore_radius = 0.15e-3 * f64::from(tooth_count);
            data.face_width = 5e-3;
            SpurGear::new(data).expect("can be made")
        };
        GearPair::new(gear(10), gear(80), 45e-3).expect("meshes")
    }

    #[test]
    fn roundings_face_each_other_only_where_a_force_between_them_drives() {
        let gear = |tooth_count, radius| {
            let mut data = paper_gear(tooth_count);
            data.blank.bore_radius = 0.3e-3 * f64::from(tooth_count);
            data.tip_edge = crate::gear::TipEdge::Rounded(radius);
            SpurGear::new(data).expect("can be made")
        };
        let (mut ended, mut last_ones) = (0, 0);
        for radius in [0.1e-3, 0.2e-3, 0.3e-3] {
            let pair = GearPair::new(gear(20, radius), gear(40, radius), 60.2e-3).expect("meshes");
            for i in -100..100 {
                let phase = 0.02 * f64::from(i);
                let primary = nearer_tip(&pair, phase);
                let view = Pose::drawn(&pair, phase, primary);
                let (Some(range), Some(seen)) = (view.range(), view.seen_range()) else {
                    // Both tips turn away from the line of action, if they face each other at all.
                    last_ones += i32::from(view.seen_range().is_some());
                    continue;
                };
                ended += i32::from(range != seen);
                let arms_at = |arc: f64| {
                    let point = view.point(arc).expect("outside the base circle");
                    view.gap_and_arms(&point).arms
                };
                for k in 0..=50 {
                    let arc = range.from + (range.to - range.from) * f64::from(k) / 50.0;
                    let arms = arms_at(arc);
                    assert!(arms.iter().all(|arm| *arm > 0.499), "{phase} {k}: {arms:?}");
                }
                // The part that one involute faces is not cut, and no flank touches beside the rest.
                let tips = [(primary, range.to), (primary.other(), range.from)];
                let first = view.facing(phase).expect("they face each other").minima[0];
                for (member, arc) in tips {
                    let place = view.point(arc).expect("outside the base circle");
                    let on_both = view.on_both(place.roll_length, place.gap.roll_length);
                    let is_cut = arc != seen.from && arc != seen.to;
                    let on_rounding = Member::BOTH
                        .map(|of| on_both[of.index()] > pair.gear(of).tip_form_roll_length());
                    assert!(!is_cut || on_rounding[member.index()], "{phase}");
                }
                assert!(first.arms.iter().all(|arm| *arm > 0.5));
            }
        }
        assert!(ended > 50 && last_ones > 0, "{ended} {last_ones}");
    }

    #[test]
    fn before_the_shortened_path_of_contact_the_corner_of_an_undercut_flank_is_nearest() {
        // How far the driven gear lags in µm until the outlines of both teeth touch, sampled by a program of its own, where they would nominally touch at
        // a roll length in mm of the pinion; the flank begins at 0.506 mm.
        let pair = undercut_pair();
        for (s, gap) in [
            (-0.6, 3.766),
            (-0.4, 3.771),
            (-0.21, 3.108),
            (-0.06, 2.319),
            (0.2, 0.872),
        ] {
            let phase = (s * 1e-3 - pair.pitch_roll_length()) / pair.base_pitch();
            let facing = GapProfile::drawn(&pair, phase).expect("they face each other");
            let first = &facing.minima[0];
            assert!(
                (first.touch * 1e6 - gap).abs() < 0.01 * gap,
                "{s}: {}",
                first.touch
            );
            assert!(
                facing.corners.contains(&first.arc) && !facing.off_path,
                "{s}"
            );
            // The secondary leans over the corner on both sides.
            assert!(first.openings.iter().all(|angle| *angle > 0.01), "{s}");
        }
        // On the path that is left flanks touch as ever.
        let (s_a, s_e) = pair.path_of_contact();
        for part in [0.05, 0.4, 0.95] {
            let s = s_a + part * (s_e - s_a);
            let phase = (s - pair.pitch_roll_length()) / pair.base_pitch();
            let touch = GapProfile::drawn(&pair, phase).expect("they touch").touch();
            assert!(touch.abs() < 1e-14, "{s}: {touch}");
        }
    }

    #[test]
    fn reliefs_add_to_the_gap() {
        let (plain, relieved) = (pair(None), pair(Some(ReliefShape::Linear)));
        let gap = |pair: &GearPair| GapProfile::drawn(pair, 0.5).expect("near").touch();
        let s = plain.roll_length_of(0.5);
        let radius = relieved.driving().flank().radius(s);
        let depth = relieved.driving().removed(s);
        // A slope σ beside a parabola of radius ρ lowers its minimum by σ² ρ/2. A flank that is turned back touches earlier on itself, by the missing amount,
        // so that the relief is read as much farther down.
        let slope = 5e-6 / 1.75e-3 * plain.driving().base_radius() / radius;
        let by_roll_length = 5e-6 / 1.75e-3 * s / radius;
        let rho = s * (plain.line_of_action() - s) / plain.line_of_action();
        let added = gap(&relieved) - gap(&plain);
        let expected = depth * (1.0 - by_roll_length) - slope * slope * rho / 2.0;
        // Terms of the third order in the shift σ ρ over ρ: σ of it.
        assert!(depth > 2e-6 && (added - expected).abs() < 2.0 * slope * slope * slope * rho);
    }

    #[test]
    fn the_nearest_point_is_the_least_of_many() {
        for shape in [ReliefShape::Linear, ReliefShape::Parabolic] {
            let pair = pair(Some(shape));
            for i in 0..60 {
                let eta = -0.9 + 0.03 * f64::from(i);
                let Some(facing) = GapProfile::drawn(&pair, eta) else {
                    continue;
                };
                let view = Pose::drawn(&pair, eta, facing.primary);
                let FlankRange { from, to, .. } = facing.range;
                let least = (0..=2000)
                    .filter_map(|k| view.point(from + (to - from) * f64::from(k) / 2000.0))
                    .map(|point| point.gap.gap)
                    .fold(f64::INFINITY, f64::min);
                let nearest = view.point(facing.minima[0].arc).expect("it is seen");
                // Samples stand 2.2 µm apart: half of that times the slope of the relief, where a kink is nearest.
                assert!((-1e-15..4e-9).contains(&(least - nearest.gap.gap)), "{eta}");
            }
        }
    }
}
