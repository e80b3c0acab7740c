//! How two flanks push each other where they meet, and how that changes as gears turn and teeth deviate.

use std::array::from_fn;

use nalgebra::{SimdBool, SimdValue, Vector2};
use simba::simd::WideF64x4;

use super::placement::{self, FlankPlace, Placement, Sight, inclined, quarter_turned, unit};
use crate::gear::{GearPair, Member, PairDeviations, SpurGear, Trace, Vector};
use crate::wide::{Loops, Numbers, wide};

/// The square of an angle below which a few terms give its sine and cosine to the last bit.
const SMALL_TURN: f64 = 1e-4;

/// Contact data of a point, or of several, at which two flanks face each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Meeting<T = f64> {
    /// The gap along the common normal, positive when open.
    pub(crate) gap: T,
    /// The arms of the force about the axes of rotation, over the base radii: 1 on the line of action.
    pub(crate) arms: [T; 2],
}

/// The direction in which two flanks push.
///
/// Pressed together both turn to a common normal between their own, but for a corner ([`placement::weights`]).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Push<T = f64> {
    seat: Member,
    /// Outward from the flank of the other gear.
    pub(crate) normal: Vector2<T>,
}

impl Placement<'_> {
    /// How the flanks push at `place` on the flank of `seat`, which sees `sight`.
    pub(crate) fn push(&self, seat: Member, place: &FlankPlace, sight: &Sight) -> Push {
        Push::new(seat, place.normal, sight.normal, self.weights)
    }

    /// How the flanks meet at `place` on the flank of `seat`, which sees `sight`.
    pub(crate) fn meeting(&self, seat: Member, place: &FlankPlace, sight: &Sight) -> Meeting {
        let push = self.push(seat, place, sight);
        push.meeting(self.pair, place.point, sight.gap, self.centers)
    }
}

impl<T: Numbers> Push<T> {
    /// Between flanks with the outward normals `on_seat` and `on_mate`, which count as the `weights` of the driving and the driven flank say.
    #[inline(always)]
    pub(crate) fn new(
        seat: Member,
        on_seat: Vector2<T>,
        on_mate: Vector2<T>,
        weights: [f64; 2],
    ) -> Self {
        let weight = |member: Member| T::splat(weights[member.index()]);
        Self {
            seat,
            normal: unit(on_mate * weight(seat.other()) - on_seat * weight(seat)),
        }
    }

    /// The arms about `centers`, over the base radii of `pair`, of the force at `point`.
    #[inline(always)]
    fn arms(&self, pair: &GearPair, point: Vector2<T>, centers: [Vector; 2]) -> [T; 2] {
        // On the driven gear; it stands on the other side of the flank.
        let push = match self.seat {
            Member::Driving => -self.normal,
            Member::Driven => self.normal,
        };
        let about = |center: Vector| {
            let d = point - center.map(T::splat);
            d.x * push.y - d.y * push.x
        };
        [
            about(centers[0]) / T::splat(pair.driving().base_radius()),
            -about(centers[1]) / T::splat(pair.driven().base_radius()),
        ]
    }

    /// The meeting at `point` of flanks of which that of the other gear passes through it once turned by the length `turn` on its base
    /// circle about its own center.
    #[inline(always)]
    pub(crate) fn meeting(
        &self,
        pair: &GearPair,
        point: Vector2<T>,
        turn: T,
        centers: [Vector; 2],
    ) -> Meeting<T> {
        let axes = placement::axes(pair);
        let arms = self.arms(pair, point, axes);
        let closing = if centers == axes {
            arms
        } else {
            self.arms(pair, point, centers)
        };
        Meeting {
            gap: turn * closing[self.seat.other().index()],
            arms,
        }
    }
}

/// A point of the seat's flank as drawn and as placed, with all that is needed to say how it meets the other flank. Both gears may have turned on a
/// little since, and their teeth may deviate. It says the same as [`placement::Placement`], without an angle to be taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Probe<T = f64> {
    /// The roll length on the seat, as placed.
    roll_length: T,
    /// From the center of the seat.
    point: Vector2<T>,
    normal: Vector2<T>,
    radial: Vector2<T>,
    /// The radial direction of the tangent point on the other base circle.
    seen: Vector2<T>,
    /// The roll length at which the involute of the other gear would pass through the point unturned.
    foot: T,
}

/// The probes of a row of points, four of them in one.
#[derive(Debug, Clone, Default)]
pub(crate) struct Probes {
    count: usize,
    fours: Vec<Probe<WideF64x4>>,
}

/// How the flanks of one pair stand, from how they were placed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Standing<'a> {
    pair: &'a GearPair,
    seat: Member,
    /// Cosine and sine of the turn of each gear since.
    turns: [[f64; 2]; 2],
    centers: [Vector; 2],
    /// The profile slope deviations, and the roll lengths at which they begin.
    slopes: [f64; 2],
    forms: [f64; 2],
    /// The traces of both profiles, where there are some.
    traces: [Option<Trace<'a>>; 2],
    weights: [f64; 2],
}

impl Probe {
    /// The point at `place` on the flank of `seat` that sees `sight`, its center at `center`.
    pub(crate) fn new(
        roll_length: f64,
        place: &FlankPlace,
        sight: &Sight,
        removed: f64,
        center: Vector,
    ) -> Self {
        Self {
            roll_length,
            point: place.point - center,
            normal: place.normal,
            radial: place.radial,
            seen: sight.radial,
            foot: sight.roll_length + removed - sight.gap,
        }
    }
}

impl Probes {
    /// Adds `probe` behind the others.
    pub(crate) fn push(&mut self, probe: &Probe) {
        let place = self.count % WideF64x4::LANES;
        if place == 0 {
            self.fours.push(probe.map(WideF64x4::splat));
        } else if let Some(last) = self.fours.last_mut() {
            last.set(place, probe);
        }
        self.count += 1;
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// About how much memory they take beside themselves, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.fours.as_slice())
    }
}

impl Probe {
    fn map<T: Numbers>(&self, of: fn(f64) -> T) -> Probe<T> {
        Probe {
            roll_length: of(self.roll_length),
            point: self.point.map(of),
            normal: self.normal.map(of),
            radial: self.radial.map(of),
            seen: self.seen.map(of),
            foot: of(self.foot),
        }
    }
}

impl<T: Numbers> Probe<T> {
    /// Puts `probe` in the `place` of one of these.
    fn set(&mut self, place: usize, probe: &Probe) {
        self.roll_length.replace(place, probe.roll_length);
        for (mine, given) in [
            (&mut self.point, probe.point),
            (&mut self.normal, probe.normal),
            (&mut self.radial, probe.radial),
            (&mut self.seen, probe.seen),
        ] {
            mine.x.replace(place, given.x);
            mine.y.replace(place, given.y);
        }
        self.foot.replace(place, probe.foot);
    }
}

/// Cosine and sine of the turn by an `arc` on a circle of the `radius`.
#[inline(always)]
fn turn<T: Numbers>(arc: T, radius: f64) -> [T; 2] {
    let number = T::splat;
    let angle = arc / number(radius);
    let square = angle * angle;
    // To the last digit.
    let series = [
        number(1.0)
            - square * (number(0.5) - square * (number(1.0 / 24.0) - square / number(720.0))),
        angle * (number(1.0) - square * (number(1.0 / 6.0) - square * number(1.0 / 120.0))),
    ];
    let small = square.simd_lt(number(SMALL_TURN));
    if small.all() {
        return series;
    }
    [
        series[0].select(small, angle.map_lanes(f64::cos)),
        series[1].select(small, angle.map_lanes(f64::sin)),
    ]
}

#[inline(always)]
fn turned<T: Numbers>([cosine, sine]: [T; 2], v: Vector2<T>) -> Vector2<T> {
    Vector2::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y)
}

impl<'a> Standing<'a> {
    /// Pair `n` with these `deviations` at the mesh position `eta`, the driven gear lagging by `lag`, from where a pair of `phase` was placed on
    /// `seat`.
    pub(crate) fn new(
        (pair, deviations): (&'a GearPair, &'a PairDeviations),
        eta: f64,
        n: i64,
        lag: f64,
        (seat, phase): (Member, f64),
    ) -> Self {
        let teeth = pair.teeth(n);
        let ahead = (eta - n as f64 - phase) * pair.base_pitch();
        let advance = [ahead, lag - ahead];
        let lengths = Member::BOTH.map(|member| {
            let g = member.index();
            advance[g] + deviations.of_gear(member).turn(teeth[g])
        });
        let body = placement::angles(pair, eta - n as f64);
        let body = [body[0], body[1] + lag / pair.driven().base_radius()];
        Self {
            pair,
            seat,
            turns: Member::BOTH
                .map(|member| turn(lengths[member.index()], pair.gear(member).base_radius())),
            centers: placement::centers(pair, deviations, n, body),
            slopes: Member::BOTH.map(|member| {
                deviations
                    .of_gear(member)
                    .profile_slope(teeth[member.index()])
            }),
            traces: Member::BOTH
                .map(|member| deviations.of_gear(member).trace(teeth[member.index()])),
            forms: Member::BOTH.map(|member| pair.gear(member).form_roll_length()),
            weights: placement::weights(pair, eta - n as f64),
        }
    }

    /// How each of `probes` meets the other flank.
    pub(crate) fn meetings(&self, probes: &Probes) -> Vec<Meeting> {
        let mut meetings = Vec::with_capacity(probes.fours.len() * WideF64x4::LANES);
        wide(Meet {
            standing: self,
            fours: &probes.fours,
            meetings: &mut meetings,
        });
        meetings.truncate(probes.count);
        meetings
    }

    /// How `probe` meets the other flank.
    #[inline(always)]
    pub(crate) fn meeting<T: Numbers>(&self, probe: &Probe<T>) -> Meeting<T> {
        let number = T::splat;
        let (seat, mate) = (self.seat.index(), self.seat.other().index());
        let (gear, other) = (self.pair.gear(self.seat), self.pair.gear(self.seat.other()));
        // A slope deviation, or a trace, turns each point by itself and inclines the flank.
        let (mut place, mut normal) = (probe.point, probe.normal);
        let slope = self.slopes[seat];
        if slope != 0.0 || self.traces[seat].is_some() {
            let (s, r_b) = (probe.roll_length, gear.base_radius());
            let (depth, inclination) = depth_and_inclination(self.traces[seat].as_ref(), s);
            let towards = number(slope) * (s - number(self.forms[seat])) - depth;
            place = turned(turn(towards, r_b), place);
            let inclination = (number(slope) - inclination) * number(r_b);
            normal -= probe.radial * (inclination / s.simd_max(number(1e-9 * r_b)));
        }
        let point = self.centers[seat].map(number) + turned(self.turns[seat].map(number), place);

        // As the other gear sees it in the frame in which it was placed.
        let [cosine, sine] = self.turns[mate].map(number);
        let d = turned([cosine, -sine], point - self.centers[mate].map(number));
        let r_b = number(other.base_radius());
        let far = d.norm_squared();
        let s = (far - r_b * r_b).simd_max(number(0.0)).simd_sqrt();
        let radial = (d * r_b - quarter_turned(d) * s) / far;
        let across = quarter_turned(radial);
        // An arc of a few thousandths, to the last digit.
        let chord = probe.seen.x * radial.y - probe.seen.y * radial.x;
        let square = chord * chord;
        let turn =
            chord * (number(1.0) + square * (number(1.0 / 6.0) + square * number(3.0 / 40.0)));
        let foot = probe.foot - r_b * turn;
        let slope = number(self.slopes[mate]);
        let (removed, inclination) = removed_and_inclination(other, s);
        let trace = depth_and_inclination(self.traces[mate].as_ref(), s);
        let missing = removed - slope * (s - number(self.forms[mate])) + trace.0;
        let inclination = inclination - slope + trace.1;

        let on_mate = turned(
            [cosine, sine],
            inclined(radial, across, s, other.base_radius(), inclination),
        );
        let on_seat = turned(self.turns[seat].map(number), normal);
        let push = Push::new(self.seat, on_seat, on_mate, self.weights);
        push.meeting(self.pair, point, s - foot + missing, self.centers)
    }
}

/// Finds how each of four and four probes meets the other flank.
struct Meet<'a> {
    standing: &'a Standing<'a>,
    fours: &'a [Probe<WideF64x4>],
    meetings: &'a mut Vec<Meeting>,
}

impl Loops for Meet<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for four in self.fours {
            let Meeting { gap, arms } = self.standing.meeting(four);
            let (gap, arms) = (gap.into_arr(), arms.map(WideF64x4::into_arr));
            self.meetings
                .extend_from_slice(&from_fn::<_, 4, _>(|place| Meeting {
                    gap: gap[place],
                    arms: [arms[0][place], arms[1][place]],
                }));
        }
    }
}

/// [`SpurGear::removed_and_inclination`] at each of the roll lengths `s`.
#[inline(always)]
fn removed_and_inclination<T: Numbers>(gear: &SpurGear, s: T) -> (T, T) {
    let (mut removed, mut inclination) = (T::splat(0.0), T::splat(0.0));
    let [from, to] = gear.untouched().map(T::splat);
    if (s.simd_gt(from) & s.simd_lt(to)).all() {
        return (removed, inclination);
    }
    for place in 0..T::LANES {
        let (depth, slope) = gear.removed_and_inclination(s.extract(place));
        removed.replace(place, depth);
        inclination.replace(place, slope);
    }
    (removed, inclination)
}

/// Removal by `trace` at each of the roll lengths `s`, and its inclination; zero without one.
#[inline(always)]
fn depth_and_inclination<T: Numbers>(trace: Option<&Trace<'_>>, s: T) -> (T, T) {
    let (mut depth, mut inclination) = (T::splat(0.0), T::splat(0.0));
    if let Some(trace) = trace {
        for place in 0..T::LANES {
            let s = s.extract(place);
            depth.replace(place, trace.depth(s));
            inclination.replace(place, trace.inclination(s));
        }
    }
    (depth, inclination)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{
        Eccentricity, ModificationData, ReliefData, ReliefShape, ReliefStart, ToothDeviations,
    };
    use crate::touch::facing::{Facing, View};
    use crate::touch::placement::Placement;

    #[test]
    fn probes_side_by_side_meet_to_the_bit_as_each_alone() {
        let mut data = paper_gear(50);
        // It begins among the probes, so that some of four see it and others do not.
        data.modifications = vec![ModificationData::TipRelief(ReliefData {
            amount: 8e-6,
            shape: ReliefShape::Parabolic,
            start: ReliefStart::RadialLength(1.5e-3),
        })];
        let gear = SpurGear::new(data).expect("the relieved gear");
        let pair = GearPair::new(gear.clone(), gear, 100.5e-3).expect("meshes");
        let straight = ToothDeviations {
            cumulative_pitch: (0..50).map(|i| 1e-6 * f64::from(i % 7)).collect(),
            ..ToothDeviations::default()
        };
        let inclined = ToothDeviations {
            profile_slope: (0..50).map(|i| 1e-6 * f64::from(i % 5)).collect(),
            eccentricity: Some(Eccentricity {
                amount: 20e-6,
                direction: 0.4,
            }),
            ..straight.clone()
        };
        for teeth in [[&straight, &inclined], [&inclined, &straight]] {
            let deviations = PairDeviations::new(&pair, teeth).expect("small deviations");
            for phase in [-0.45, 0.1, 0.62] {
                let facing = Facing::drawn(&pair, phase).expect("flanks that face each other");
                let view = View {
                    placement: Placement::drawn(&pair, phase),
                    seat: facing.seat,
                };
                let (from, to) = (facing.range.from, facing.range.to);
                let arcs = (1..40).map(|i| from + (to - from) * f64::from(i) / 40.0);
                let points = arcs.filter_map(|arc| view.point(arc));
                let alone: Vec<Probe> = points.map(|point| view.probe(&point)).collect();
                assert_ne!(alone.len() % WideF64x4::LANES, 0);
                let mut probes = Probes::default();
                alone.iter().for_each(|probe| probes.push(probe));

                let (eta, placed) = (3.0 + phase, (facing.seat, phase));
                let standing = Standing::new((&pair, &deviations), eta, 3, 2e-6, placed);
                let expected: Vec<Meeting> =
                    alone.iter().map(|probe| standing.meeting(probe)).collect();
                assert_eq!(standing.meetings(&probes), expected);
            }
        }
    }

    #[test]
    fn a_small_turn_is_the_sine_and_cosine_of_its_angle() {
        for i in -400..=400 {
            let angle = 5e-5 * f64::from(i);
            let (sine, cosine) = angle.sin_cos();
            let found = turn(angle * 0.05, 0.05);
            // A rounding each.
            assert!((found[0] - cosine).abs() < 3e-16 && (found[1] - sine).abs() < 1e-17);
        }
    }
}
