//! Two flanks that face each other: where they are nearest, and how far either sees the other.

use super::placement::{FlankPlace, Placement, Sight};
use crate::gear::{GearPair, Member};
use crate::root_finding::bisect;

/// What ends the part of a flank from which the other flank is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangeEnd {
    /// Its own fillet begins.
    Fillet,
    /// Its own tip.
    Tip,
    /// The fillet of the other gear begins.
    MateFillet,
    /// The tip of the other gear.
    MateTip,
}

/// A stretch of flank, by arc length from the base circle, and what ends it on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankRange {
    /// Where it begins, nearer to the root.
    pub from: f64,
    /// Where it ends, nearer to the tip.
    pub to: f64,
    /// What is there.
    pub ends: [RangeEnd; 2],
}

/// Two flanks that face each other at a mesh position.
///
/// One of them is looked at from the other: points are told by their arc length on the flank of `seat`, the gear whose
/// tip is nearer to the contact, so that the stretch may end at its tip corner. The gap of a point is measured along the normal of
/// the other flank; reliefs add to it.
#[derive(Debug, Clone, Copy)]
pub struct Facing<'a> {
    /// The pair n.
    pub pair: i64,
    /// The gear on whose flank points are told.
    pub seat: Member,
    /// The part of its flank that faces the other.
    pub range: FlankRange,
    /// The arc length of the least gap.
    pub nearest: f64,
    /// The least gap.
    pub gap: f64,
    /// The arm of a force there about the driven axis, over r_b2.
    arm: f64,
    /// Whether the nominal contact lies past the seat's tip, off the path of contact.
    pub off_path: bool,
    gears: &'a GearPair,
    eta: f64,
    home: i64,
    placement: Placement<'a>,
}

/// A point of the seat's flank and what it sees.
pub(super) struct FacingPoint {
    pub(super) roll_length: f64,
    pub(super) place: FlankPlace,
    pub(super) sight: Sight,
    /// The gap along the other flank's normal, reliefs included.
    pub(super) gap: f64,
}

impl<'a> Facing<'a> {
    /// How the flanks of pair `n` of `gears` face each other at the mesh position `eta`, told on the gear whose tip is nearer;
    /// `None` where they do not. `home` whole mesh periods later they do so again, but for eccentric gears.
    pub fn of(gears: &'a GearPair, eta: f64, n: i64, home: i64) -> Option<Self> {
        let (s_a, s_e) = gears.path_of_contact();
        let s_1 = gears.roll_length_of(eta - n as f64);
        // Past the middle of the path of contact the contact is nearer to the driving tip, which leaves it at E. A pair that stands
        // just there is told alike however its numbers are rounded.
        let middle = f64::midpoint(s_a, s_e) + 1e-9 * (s_e - s_a);
        let seat = if s_1 > middle {
            Member::Driving
        } else {
            Member::Driven
        };
        Self::from_seat(gears, eta, n, home, seat)
    }

    /// As [`Facing::of`], told on the flank of `seat`.
    pub fn from_seat(
        gears: &'a GearPair,
        eta: f64,
        n: i64,
        home: i64,
        seat: Member,
    ) -> Option<Self> {
        let s_1 = gears.roll_length_of(eta - n as f64);
        let nominal = match seat {
            Member::Driving => s_1,
            Member::Driven => gears.line_of_action() - s_1,
        };
        let mut facing = Self {
            pair: n,
            seat,
            range: FlankRange {
                from: 0.0,
                to: 0.0,
                ends: [RangeEnd::Fillet, RangeEnd::Tip],
            },
            nearest: 0.0,
            gap: f64::INFINITY,
            arm: 1.0,
            off_path: nominal > gears.gear(seat).tip_form_roll_length(),
            gears,
            eta,
            home,
            placement: Placement::new(gears, eta, n, home),
        };
        facing.range = facing.facing_range()?;
        facing.nearest = facing.nearest_point([0.0; 2]);
        facing.gap = facing.point(facing.nearest)?.gap;
        facing.arm = facing.cell(facing.nearest, 0.0)?.arm;
        Some(facing)
    }

    /// The same flanks, told on the other gear.
    pub(super) fn told_on_mate(&self) -> Option<Self> {
        Self::from_seat(
            self.gears,
            self.eta,
            self.pair,
            self.home,
            self.seat.other(),
        )
    }

    /// The gears.
    pub(super) fn gears(&self) -> &'a GearPair {
        self.gears
    }

    /// Both gears where they stand.
    pub(super) fn placement(&self) -> &Placement<'a> {
        &self.placement
    }

    /// The point at `arc` of the seat's flank; `None` inside the other base circle.
    pub(super) fn point(&self, arc: f64) -> Option<FacingPoint> {
        let (gear, mate) = (
            self.gears.gear(self.seat),
            self.gears.gear(self.seat.other()),
        );
        let s = gear.flank().roll_length_at_arc(arc);
        let place = self.placement.place(self.seat, s);
        let sight = self.placement.sight(self.seat.other(), place.point)?;
        let removed = gear.removed(s) + mate.removed(sight.roll_length);
        Some(FacingPoint {
            roll_length: s,
            place,
            gap: sight.gap + removed,
            sight,
        })
    }

    /// The roll length that `arc` sees on the other flank; it falls towards the seat's tip.
    fn seen_from(&self, arc: f64) -> f64 {
        let s = self.gears.gear(self.seat).flank().roll_length_at_arc(arc);
        let point = self.placement.place(self.seat, s).point;
        self.placement
            .sight(self.seat.other(), point)
            .map_or(f64::NEG_INFINITY, |sight| sight.roll_length)
    }

    /// The part of the seat's flank that sees the other flank between its form circle and its tip.
    fn facing_range(&self) -> Option<FlankRange> {
        let (gear, mate) = (
            self.gears.gear(self.seat),
            self.gears.gear(self.seat.other()),
        );
        let (low, high) = gear.flank_arcs();
        let (form, tip) = (mate.form_roll_length(), mate.tip_roll_length());
        let (mut from, mut to) = ((low, RangeEnd::Fillet), (high, RangeEnd::Tip));
        if self.seen_from(high) > tip || self.seen_from(low) < form {
            return None;
        }
        if self.seen_from(low) > tip {
            from = (
                bisect(high, low, |arc| self.seen_from(arc) <= tip),
                RangeEnd::MateTip,
            );
        }
        if self.seen_from(high) < form {
            to = (
                bisect(low, high, |arc| self.seen_from(arc) >= form),
                RangeEnd::MateFillet,
            );
        }
        (from.0 < to.0).then_some(FlankRange {
            from: from.0,
            to: to.0,
            ends: [from.1, to.1],
        })
    }

    /// The arc length at which the gap is least between flanks inclined by `slopes`, those of the driving and of the driven tooth: what
    /// stands out beyond the drawing for each roll length.
    ///
    /// The gap is a parabola about the nominal contact plus reliefs that grow towards either tip: it is convex, and least where its
    /// slope changes sign, or at an end. A profile table may give it several hollows: of many places the least tells where to look.
    fn nearest_point(&self, slopes: [f64; 2]) -> f64 {
        const PLACES: u32 = 128;
        let FlankRange { from, to, .. } = self.range;
        let (mut low, mut high) = (from, to);
        if !(self.gears.driving().is_convex() && self.gears.driven().is_convex()) {
            let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(PLACES);
            let gap = |i: u32| {
                self.point(at(i)).map_or(f64::INFINITY, |point| {
                    let rolls = self.on_both(point.roll_length, point.sight.roll_length);
                    point.gap - slopes[0] * rolls[0] - slopes[1] * rolls[1]
                })
            };
            let least = (0..=PLACES).min_by(|&i, &j| gap(i).total_cmp(&gap(j)));
            let least = least.unwrap_or(0);
            (low, high) = (at(least.saturating_sub(1)), at((least + 1).min(PLACES)));
        }
        let closes = |arc: f64| self.slope(arc, slopes) < 0.0;
        if closes(high) {
            high
        } else if closes(low) {
            bisect(low, high, closes)
        } else {
            low
        }
    }

    /// The δ at which `teeth`, the driving and the driven one, touch with their deviations from the drawing: their least gap over its
    /// arm.
    pub(super) fn touch_of(&self, teeth: [usize; 2]) -> f64 {
        let alike = |member: Member| self.gears.gear(member).deviations().are_teeth_alike();
        if Member::BOTH.into_iter().all(alike) {
            return self.gap / self.arm;
        }
        let of = |member: Member| (self.gears.gear(member), teeth[member.index()]);
        let slopes = Member::BOTH.map(|member| {
            let (gear, tooth) = of(member);
            gear.deviation_slope(tooth)
        });
        let nearest = if slopes == [0.0; 2] {
            self.nearest
        } else {
            self.nearest_point(slopes)
        };
        self.point(nearest).map_or(f64::INFINITY, |point| {
            let rolls = self.on_both(point.roll_length, point.sight.roll_length);
            let deviations = Member::BOTH.map(|member| {
                let (gear, tooth) = of(member);
                gear.deviation(tooth, rolls[member.index()])
            });
            (point.gap - deviations[0] - deviations[1]) / self.arm
        })
    }

    /// The least distance between the tip of the seat, as far as it stands below the flank of the other gear, and the fillet there;
    /// `None` where the tip does not reach below that flank.
    pub(super) fn tip_to_fillet(&self) -> Option<f64> {
        const TIP_POINTS: u32 = 8;
        if self.range.ends[1] != RangeEnd::MateFillet {
            return None;
        }
        let (_, tip) = self.gears.gear(self.seat).flank_arcs();
        let gaps = (1..=TIP_POINTS).map(|i| {
            let arc = self.range.to + (tip - self.range.to) * f64::from(i) / f64::from(TIP_POINTS);
            let s = self.gears.gear(self.seat).flank().roll_length_at_arc(arc);
            let point = self.placement.place(self.seat, s).point;
            self.placement.fillet_distance(self.seat.other(), point)
        });
        gaps.reduce(f64::min)
    }

    /// How fast the gap opens beside the nearest point: nothing where flanks touch with a common tangent, the angle between them
    /// where a corner is nearest.
    pub(super) fn opening_angle(&self) -> f64 {
        let FlankRange { from, to, .. } = self.range;
        if self.nearest == to {
            (-self.slope(to, [0.0; 2])).max(0.0)
        } else if self.nearest == from {
            self.slope(from, [0.0; 2]).max(0.0)
        } else {
            0.0
        }
    }

    /// The slope of the gap along the seat's flank, towards its tip, between flanks inclined by `slopes`.
    fn slope(&self, arc: f64, slopes: [f64; 2]) -> f64 {
        let other = self.seat.other();
        let (gear, mate) = (self.gears.gear(self.seat), self.gears.gear(other));
        let Some(FacingPoint {
            roll_length: s,
            place,
            sight,
            ..
        }) = self.point(arc)
        else {
            return 0.0;
        };
        let (gap, seen) = sight.change(mate.base_radius(), place.to_tip);
        let away = gear.removed_slope(s) - slopes[self.seat.index()];
        let away_on_mate = mate.removed_slope(sight.roll_length) - slopes[other.index()];
        // An arc grows by s/r_b along a roll length.
        gap + away * gear.base_radius() / s.max(1e-9 * gear.base_radius()) + away_on_mate * seen
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart, SpurGear};

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
                for seat in Member::BOTH {
                    let facing = Facing::from_seat(&pair, eta, 0, 0, seat).expect("they touch");
                    assert!(facing.gap.abs() < 1e-15, "{seat} at {s}: {}", facing.gap);
                }
            }
        }
    }

    #[test]
    fn the_gear_whose_tip_is_nearer_is_the_seat() {
        let pair = recess_pair();
        let (s_a, s_e) = pair.path_of_contact();
        assert!(s_a > pair.pitch_roll_length(), "all of the path is recess");
        let periods = |s: f64| (s - pair.pitch_roll_length()) / pair.base_pitch();
        for (s, seat, off_path) in [
            (s_a - 0.2e-3, Member::Driven, true),
            (s_a + 0.2e-3, Member::Driven, false),
            (s_e - 0.2e-3, Member::Driving, false),
            (s_e + 0.2e-3, Member::Driving, true),
        ] {
            let facing = Facing::of(&pair, periods(s), 0, 0).expect("they face each other");
            assert_eq!((facing.seat, facing.off_path), (seat, off_path));
            assert_eq!(
                facing.nearest == facing.range.to,
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
                Facing::of(&pair, eta, 0, 0).is_some_and(|facing| {
                    assert!(facing.gap >= last);
                    last = facing.gap;
                    true
                })
            });
            let count = faces.count();
            assert!(count > 5 && count < 200, "{count}");
        }
    }

    #[test]
    fn reliefs_add_to_the_gap() {
        let (plain, relieved) = (pair(None), pair(Some(ReliefShape::Linear)));
        let gap = |pair: &GearPair| Facing::of(pair, 0.5, 0, 0).expect("near").gap;
        let s = plain.roll_length_of(0.5);
        let radius = relieved.driving().flank().radius(s);
        let depth = relieved.driving().removed(s);
        // A slope σ beside a parabola of radius ρ lowers its minimum by σ² ρ/2.
        let slope = 5e-6 / 1.75e-3 * plain.driving().base_radius() / radius;
        let rho = s * (plain.line_of_action() - s) / plain.line_of_action();
        let added = gap(&relieved) - gap(&plain);
        let expected = depth - slope * slope * rho / 2.0;
        // Terms of the third order in the shift σ ρ over ρ: σ of it.
        assert!(depth > 2e-6 && (added - expected).abs() < 2.0 * slope * slope * slope * rho);
    }

    #[test]
    fn the_nearest_point_is_the_least_of_many() {
        for shape in [ReliefShape::Linear, ReliefShape::Parabolic] {
            let pair = pair(Some(shape));
            for i in 0..60 {
                let eta = -0.9 + 0.03 * f64::from(i);
                let Some(facing) = Facing::of(&pair, eta, 0, 0) else {
                    continue;
                };
                let FlankRange { from, to, .. } = facing.range;
                let least = (0..=2000)
                    .filter_map(|k| facing.point(from + (to - from) * f64::from(k) / 2000.0))
                    .map(|point| point.gap)
                    .fold(f64::INFINITY, f64::min);
                // Samples stand 2.2 µm apart: half of that times the slope of the relief, where a kink is nearest.
                assert!((-1e-15..4e-9).contains(&(least - facing.gap)), "{eta}");
            }
        }
    }
}
