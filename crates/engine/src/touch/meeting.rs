//! Gaps and arms of two flanks where they face each other, and how they change as gears turn and teeth deviate.

use std::array::from_fn;

use nalgebra::{SimdValue, Vector2};
use simba::simd::WideF64x4;

use super::placement::{self, FacingPoint, Pose, RotationGap, tangent, turn, unit};
use crate::gear::{Member, Vector};
use crate::wide::{Loops, Numbers, wide};

/// Gap and arms at a point, or at several, at which two flanks face each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GapAndArms<T = f64> {
    /// The gap along the common normal, positive when open.
    pub(crate) gap: T,
    /// The arms of the force about the axes of rotation, over the base radii: 1 on the line of action.
    pub(crate) arms: [T; 2],
}

/// A point of the primary flank as drawn and as placed, to be evaluated at many positions: both gears may have turned on a little since, and their teeth may
/// deviate. No angle is to be taken for that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlankPoint<T = f64> {
    /// The roll length on the primary, as placed.
    roll_length: T,
    /// Position from the center of the primary.
    point: Vector2<T>,
    normal: Vector2<T>,
    radial: Vector2<T>,
    /// The radial direction of the tangent point on the other base circle.
    opposite: Vector2<T>,
    /// The roll length at which the involute of the other gear would pass through the point unturned.
    foot: T,
}

/// A row of points, four of them in one.
#[derive(Debug, Clone, Default)]
pub(crate) struct FlankPoints {
    count: usize,
    fours: Vec<FlankPoint<WideF64x4>>,
}

impl FlankPoints {
    /// Adds `point` behind the others.
    pub(crate) fn push(&mut self, point: &FlankPoint) {
        let place = self.count % WideF64x4::LANES;
        if place == 0 {
            self.fours.push(point.map(WideF64x4::splat));
        } else if let Some(last) = self.fours.last_mut() {
            last.set(place, point);
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

impl FlankPoint {
    /// The `point` of a pair as drawn, on a gear with its axis at `center`; the drawing removes `removed` from the flank opposite to it.
    pub(crate) fn new(point: &FacingPoint, removed: f64, center: Vector) -> Self {
        let FacingPoint {
            roll_length,
            place,
            gap,
        } = point;
        Self {
            roll_length: *roll_length,
            point: place.point - center,
            normal: place.normal,
            radial: place.radial,
            opposite: gap.radial,
            foot: gap.roll_length + removed - gap.gap,
        }
    }

    fn map<T: Numbers>(&self, of: fn(f64) -> T) -> FlankPoint<T> {
        FlankPoint {
            roll_length: of(self.roll_length),
            point: self.point.map(of),
            normal: self.normal.map(of),
            radial: self.radial.map(of),
            opposite: self.opposite.map(of),
            foot: of(self.foot),
        }
    }
}

impl<T: Numbers> FlankPoint<T> {
    /// Puts `point` in the `place` of one of these.
    fn set(&mut self, place: usize, point: &FlankPoint) {
        self.roll_length.replace(place, point.roll_length);
        for (mine, given) in [
            (&mut self.point, point.point),
            (&mut self.normal, point.normal),
            (&mut self.radial, point.radial),
            (&mut self.opposite, point.opposite),
        ] {
            mine.x.replace(place, given.x);
            mine.y.replace(place, given.y);
        }
        self.foot.replace(place, point.foot);
    }
}

#[inline(always)]
fn turned<T: Numbers>([cosine, sine]: [T; 2], v: Vector2<T>) -> Vector2<T> {
    Vector2::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y)
}

impl Pose<'_> {
    /// The gap and the arms at `point`.
    pub(crate) fn gap_and_arms(&self, point: &FacingPoint) -> GapAndArms {
        let normal = self.common_normal(point.place.normal, point.gap.normal);
        self.gap_along(normal, point.place.point, point.gap.gap)
    }

    /// The gap and the arms at each of `points`.
    pub(crate) fn gaps_and_arms(&self, points: &FlankPoints) -> Vec<GapAndArms> {
        let mut found = Vec::with_capacity(points.fours.len() * WideF64x4::LANES);
        wide(GapsOfFours {
            pose: self,
            fours: &points.fours,
            found: &mut found,
        });
        found.truncate(points.count);
        found
    }

    /// The gap and the arms at a `point` that was placed before.
    #[inline(always)]
    pub(crate) fn gap_and_arms_of<T: Numbers>(&self, point: &FlankPoint<T>) -> GapAndArms<T> {
        let number = T::splat;
        let (primary, secondary) = (self.primary.index(), self.primary.other().index());
        let (own, other) = (&self.flanks[primary], &self.flanks[secondary]);
        // A slope deviation, or a trace, turns each point by itself and inclines the flank.
        let (mut place, mut normal) = (point.point, point.normal);
        if !own.is_drawn() {
            let (s, r_b) = (point.roll_length, own.base_radius());
            let (height, inclination) = own.beyond_drawing(s);
            place = turned(turn(height, r_b), place);
            normal -= point.radial * (inclination * number(r_b) / s.simd_max(number(1e-9 * r_b)));
        }
        let rotation = self.rotations[primary].map(number);
        let place = self.centers[primary].map(number) + turned(rotation, place);
        let on_primary = turned(rotation, normal);

        // As the other gear sees it in the frame in which it was placed.
        let [cosine, sine] = self.rotations[secondary].map(number);
        let d = turned([cosine, -sine], place - self.centers[secondary].map(number));
        let (s, radial) = tangent(d, other.base_radius());
        // An arc of a few thousandths, to the last digit.
        let chord = point.opposite.x * radial.y - point.opposite.y * radial.x;
        let square = chord * chord;
        let turn =
            chord * (number(1.0) + square * (number(1.0 / 6.0) + square * number(3.0 / 40.0)));
        let foot = point.foot - number(other.base_radius()) * turn;
        let RotationGap { gap, normal, .. } = other.rotation_gap((s, radial), foot);
        let normal = self.common_normal(on_primary, turned([cosine, sine], normal));
        self.gap_along(normal, place, gap)
    }

    /// The direction in which flanks with the outward normals `on_primary` and `on_secondary` push, outward from that of the other gear.
    ///
    /// Pressed together both turn to a common normal between their own, but for a corner ([`placement::weights`]).
    #[inline(always)]
    pub(crate) fn common_normal<T: Numbers>(
        &self,
        on_primary: Vector2<T>,
        on_secondary: Vector2<T>,
    ) -> Vector2<T> {
        let weight = |member: Member| T::splat(self.weights[member.index()]);
        unit(on_secondary * weight(self.primary.other()) - on_primary * weight(self.primary))
    }

    /// Gap and arms at `point`, where the flanks push along `normal`: that of the other gear passes through it once turned by the length `rotation` on its base
    /// circle about its own center.
    #[inline(always)]
    fn gap_along<T: Numbers>(
        &self,
        normal: Vector2<T>,
        point: Vector2<T>,
        rotation: T,
    ) -> GapAndArms<T> {
        let axes = placement::axes(self.pair);
        let arms = self.arms(normal, point, axes);
        let closing = if self.centers == axes {
            arms
        } else {
            self.arms(normal, point, self.centers)
        };
        GapAndArms {
            gap: rotation * closing[self.primary.other().index()],
            arms,
        }
    }

    /// The arms about `centers`, over the base radii, of a force along `normal` at `point`.
    #[inline(always)]
    fn arms<T: Numbers>(
        &self,
        normal: Vector2<T>,
        point: Vector2<T>,
        centers: [Vector; 2],
    ) -> [T; 2] {
        // On the driven gear; it stands on the other side of the flank.
        let push = match self.primary {
            Member::Driving => -normal,
            Member::Driven => normal,
        };
        let about = |center: Vector| {
            let d = point - center.map(T::splat);
            d.x * push.y - d.y * push.x
        };
        [
            about(centers[0]) / T::splat(self.pair.driving().base_radius()),
            -about(centers[1]) / T::splat(self.pair.driven().base_radius()),
        ]
    }
}

/// Gaps and arms at points, four at a time.
struct GapsOfFours<'a> {
    pose: &'a Pose<'a>,
    fours: &'a [FlankPoint<WideF64x4>],
    found: &'a mut Vec<GapAndArms>,
}

impl Loops for GapsOfFours<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for four in self.fours {
            let GapAndArms { gap, arms } = self.pose.gap_and_arms_of(four);
            let (gap, arms) = (gap.into_arr(), arms.map(WideF64x4::into_arr));
            self.found
                .extend_from_slice(&from_fn::<_, 4, _>(|place| GapAndArms {
                    gap: gap[place],
                    arms: [arms[0][place], arms[1][place]],
                }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{
        Eccentricity, GearPair, ModificationData, PairDeviations, ReliefData, ReliefShape,
        ReliefStart, SpurGear, ToothDeviations,
    };
    use crate::touch::gap_profile::GapProfile;
    use crate::touch::placement::Section;

    #[test]
    fn points_side_by_side_have_the_gap_to_the_bit_that_each_has_alone() {
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
                let facing = GapProfile::drawn(&pair, phase).expect("flanks that face each other");
                let view = Pose::drawn(&pair, phase, facing.primary);
                let (from, to) = (facing.range.from, facing.range.to);
                let arcs = || (1..40).map(|i| from + (to - from) * f64::from(i) / 40.0);
                let points = arcs().filter_map(|arc| view.point(arc));
                let alone: Vec<FlankPoint> = points.map(|point| view.flank_point(&point)).collect();
                assert_ne!(alone.len() % WideF64x4::LANES, 0);
                let mut points = FlankPoints::default();
                alone.iter().for_each(|point| points.push(point));

                let (section, placed) =
                    (Section::straight(3.0 + phase, 3), (facing.primary, phase));
                let pose = Pose::real((&pair, &deviations), section, 2e-6, placed);
                let each = alone.iter();
                let expected: Vec<GapAndArms> =
                    each.map(|point| pose.gap_and_arms_of(point)).collect();
                assert_eq!(pose.gaps_and_arms(&points), expected);

                // The same flanks point by point, with angles taken. A normal is inclined to the first order there.
                for (point, found) in arcs().filter_map(|arc| pose.point(arc)).zip(&expected) {
                    let GapAndArms { gap, arms } = pose.gap_and_arms(&point);
                    let off = (gap - found.gap).abs();
                    assert!(
                        off < 1e-15 + 1e-5 * gap.abs(),
                        "{phase}: {off:e} of {gap:e}"
                    );
                    for (arm, found) in arms.iter().zip(found.arms) {
                        assert!((arm - found).abs() < 2e-5, "{phase}: {arm} {found}");
                    }
                }
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
