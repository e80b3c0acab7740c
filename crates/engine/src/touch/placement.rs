//! Both gears turned to a mesh position, and the gap of one flank to the other.
//!
//! Flanks are taken as they are: modifications and the deviation of a tooth turn each point of its flank about the gear's axis, by
//! e/r_b at the radius at which it stands, and incline its normal by e'.

use std::f64::consts::PI;

use nalgebra::{SimdBool, Vector2};

use crate::gear::{
    GearDeviations, GearPair, Member, PairDeviations, SpurGear, Trace, Vector, radial, tangential,
    teeth_on,
};
use crate::wide::Numbers;

/// The square of an angle below which a few terms give its sine and cosine to the last bit.
const SMALL_TURN: f64 = 1e-4;

/// Both flanks of one tooth pair at a mesh position, with points given on one of them.
///
/// The driving center is the origin, the driven one lies on the x axis; the driving gear turns counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose<'a> {
    /// The gears.
    pub(crate) pair: &'a GearPair,
    /// The gear on whose flank points are given.
    pub(crate) primary: Member,
    pub(super) flanks: [RealFlank<'a>; 2],
    /// Positions of the gears' own axes: beside the axes of rotation where they are eccentric.
    pub(super) centers: [Vector; 2],
    /// The angle of each tooth's centerline.
    angles: [f64; 2],
    /// Cosine and sine of the rotation of each tooth since its points were placed, on the pair as drawn.
    pub(super) rotations: [[f64; 2]; 2],
    /// Weight of the normal of either flank ([`weights`]).
    pub(super) weights: [f64; 2],
}

/// The loaded flank of one tooth: that of the drawing and its deviations.
#[derive(Debug, Clone, Copy)]
pub(super) struct RealFlank<'a> {
    gear: &'a SpurGear,
    /// The pitch deviation: by how much the tooth stands ahead, as a length on the base circle.
    pub(super) turn: f64,
    /// The profile slope deviation by the roll length.
    slope: f64,
    /// The trace of the profile, where there is one.
    trace: Option<Trace<'a>>,
}

/// A transverse section of the teeth of one pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Section {
    /// The pair n.
    pub pair: i64,
    /// Mesh periods since it passed the pitch point in this section.
    pub phase: f64,
    /// Material removed from each flank, the same at every roll length, along the base tangent.
    pub removed: [f64; 2],
    /// The angle by which each gear is turned here from the middle of its face.
    pub twists: [f64; 2],
}

impl Section {
    /// Section of straight teeth as drawn, of `pair` at the mesh position `eta`.
    pub(crate) fn straight(eta: f64, pair: i64) -> Self {
        Self {
            pair,
            phase: eta - pair as f64,
            removed: [0.0; 2],
            twists: [0.0; 2],
        }
    }
}

/// A place on the boundary of a gear.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlankPlace {
    pub(crate) point: Vector,
    /// The outward unit normal.
    pub(crate) normal: Vector,
    /// How the point moves for each unit of arc of the involute.
    pub(crate) way: Vector,
    /// The radial direction e_r of the tangent point on the base circle; the involute's normal is at right angles to it.
    pub(crate) radial: Vector,
}

/// Position of a point, or of several, against a flank: the turn of the flank that would pass through it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RotationGap<T: Numbers = f64> {
    /// The roll length of the flank at the radius of the point: the length of the tangent from the point to the base circle.
    pub(crate) roll_length: T,
    /// The angle by which the flank is to be turned, as a length on its base circle; positive where the point is outside.
    pub(crate) gap: T,
    /// The outward unit normal of the flank where it passes through the point.
    pub(crate) normal: Vector2<T>,
    /// The radial direction of the tangent point on the base circle.
    pub(crate) radial: Vector2<T>,
}

/// A point of the primary flank, and its gap to the other flank.
pub(crate) struct FacingPoint {
    pub(crate) roll_length: f64,
    pub(crate) place: FlankPlace,
    pub(crate) gap: RotationGap,
}

/// The outward unit normal of a flank from which e is missing with the slope e' by the roll length `s`; `radial` and `across` are those
/// of its tangent point on the base circle of radius `r_b`.
#[inline(always)]
pub(crate) fn inclined<T: Numbers>(
    radial: Vector2<T>,
    across: Vector2<T>,
    s: T,
    r_b: f64,
    slope: T,
) -> Vector2<T> {
    let as_drawn = slope.simd_eq(T::splat(0.0));
    if as_drawn.all() {
        return across;
    }
    // dP/ds = −e' e_t + (1 + e') s/r_b e_r.
    let along = (T::splat(1.0) + slope) * s / T::splat(r_b);
    let inclined = unit(across * along + radial * slope);
    across.zip_map(&inclined, |across, inclined| {
        across.select(as_drawn, inclined)
    })
}

/// `v` over its length.
#[inline(always)]
pub(crate) fn unit<T: Numbers>(v: Vector2<T>) -> Vector2<T> {
    v * (T::splat(1.0) / v.norm())
}

/// `v`, turned by a quarter counter-clockwise.
#[inline(always)]
pub(crate) fn quarter_turned<T: Numbers>(v: Vector2<T>) -> Vector2<T> {
    Vector2::new(-v.y, v.x)
}

/// Length of the tangent from a point at `d` of the center to the base circle of radius `r_b`, and the radial direction of the point that it touches:
/// d = r_b e_r + s e_t. The length is zero from inside.
#[inline(always)]
pub(super) fn tangent<T: Numbers>(d: Vector2<T>, r_b: f64) -> (T, Vector2<T>) {
    let r_b = T::splat(r_b);
    let far = d.norm_squared();
    let s = (far - r_b * r_b).simd_max(T::splat(0.0)).simd_sqrt();
    (s, (d * r_b - quarter_turned(d) * s) / far)
}

/// Cosine and sine of the turn by an `arc` on a circle of the `radius`.
#[inline(always)]
pub(super) fn turn<T: Numbers>(arc: T, radius: f64) -> [T; 2] {
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

/// The angle of the centerline of each tooth of a pair at `phase`.
pub(crate) fn angles(pair: &GearPair, phase: f64) -> [f64; 2] {
    let alpha_w = pair.working_pressure_angle();
    let s_1 = pair.roll_length_of(phase);
    let angle = |gear: &SpurGear, tangent: f64, s: f64| {
        tangent - gear.flank().base_half_angle() + s / gear.base_radius()
    };
    [
        angle(pair.driving(), -alpha_w, s_1),
        angle(pair.driven(), PI - alpha_w, pair.line_of_action() - s_1),
    ]
}

/// The weights of the normals of the driving and of the driven flank of a pair at `phase` in the direction in which they push. They are equal, but for the
/// corner of an undercut flank, which pushes along the normal of the smooth flank that it touches.
pub(crate) fn weights(pair: &GearPair, phase: f64) -> [f64; 2] {
    /// The part of the roll length of the corner over which the weights change as the nominal contact passes it.
    const CHANGES_OVER: f64 = 0.1;
    let s_1 = pair.roll_length_of(phase);
    let rolls = [s_1, pair.line_of_action() - s_1];
    let mut weights = [1.0; 2];
    for member in Member::BOTH {
        let (gear, g) = (pair.gear(member), member.index());
        let corner = gear.form_roll_length();
        if gear.is_undercut() && rolls[g] < corner {
            let beyond = ((corner - rolls[g]) / (CHANGES_OVER * corner)).min(1.0);
            weights[g] -= beyond;
            weights[member.other().index()] += beyond;
        }
    }
    weights
}

/// The axes of rotation.
pub(crate) fn axes(pair: &GearPair) -> [Vector; 2] {
    [Vector::zeros(), Vector::new(pair.center_distance(), 0.0)]
}

/// Where the own axes of gears with these `deviations` stand while the centerlines of the teeth of pair `n` point along `angles`.
pub(crate) fn centers(
    pair: &GearPair,
    deviations: &PairDeviations,
    n: i64,
    angles: [f64; 2],
) -> [Vector; 2] {
    let axes = axes(pair);
    Member::BOTH.map(|member| {
        let (gear, g) = (pair.gear(member), member.index());
        // From the tooth in mesh back to tooth 0.
        let tooth_0 = angles[g] - teeth_on(member, n) as f64 * gear.pitch_angle();
        axes[g] + deviations.of_gear(member).displacement(tooth_0)
    })
}

impl<'a> RealFlank<'a> {
    fn drawn(gear: &'a SpurGear) -> Self {
        Self {
            gear,
            turn: 0.0,
            slope: 0.0,
            trace: None,
        }
    }

    fn of_tooth(gear: &'a SpurGear, deviations: &'a GearDeviations, tooth: usize) -> Self {
        Self {
            gear,
            turn: deviations.turn(tooth),
            slope: deviations.profile_slope(tooth),
            trace: deviations.trace(tooth),
        }
    }

    pub(super) fn base_radius(&self) -> f64 {
        self.gear.base_radius()
    }

    /// True if its profile is that of the drawing.
    #[inline(always)]
    pub(super) fn is_drawn(&self) -> bool {
        self.slope == 0.0 && self.trace.is_none()
    }

    /// Height of the profile beyond the drawing at the roll length `s`, and by how much that inclines its normal.
    #[inline(always)]
    pub(super) fn beyond_drawing<T: Numbers>(&self, s: T) -> (T, T) {
        let slope = T::splat(self.slope);
        let form = T::splat(self.gear.form_roll_length());
        let (depth, inclination) = match &self.trace {
            Some(trace) => at_each(s, |s| (trace.depth(s), trace.inclination(s))),
            None => (T::splat(0.0), T::splat(0.0)),
        };
        (slope * (s - form) - depth, slope - inclination)
    }

    /// Material removed from the involute at the roll length `s`, and by how much that inclines the normal.
    #[inline(always)]
    fn removed_and_inclination<T: Numbers>(&self, s: T) -> (T, T) {
        let [from, to] = self.gear.untouched().map(T::splat);
        let (removed, inclination) = if (s.simd_gt(from) & s.simd_lt(to)).all() {
            (T::splat(0.0), T::splat(0.0))
        } else {
            at_each(s, |s| self.gear.removed_and_inclination(s))
        };
        let beyond = self.beyond_drawing(s);
        (removed - beyond.0, inclination - beyond.1)
    }

    /// The slope of the material removed from the involute, by the roll length; it jumps at kinks.
    fn removed_slope(&self, s: f64) -> f64 {
        let traced = self.trace.as_ref().map_or(0.0, |trace| trace.slope(s));
        self.gear.removed_slope(s) - (self.slope - traced)
    }

    /// Position of a point against this flank, from its `tangent` to the base circle and the roll length `foot` at which the involute would pass through it
    /// unturned.
    #[inline(always)]
    pub(super) fn rotation_gap<T: Numbers>(
        &self,
        (s, radial): (T, Vector2<T>),
        foot: T,
    ) -> RotationGap<T> {
        let (removed, inclination) = self.removed_and_inclination(s);
        let across = quarter_turned(radial);
        RotationGap {
            roll_length: s,
            gap: s - foot + removed,
            normal: inclined(radial, across, s, self.base_radius(), inclination),
            radial,
        }
    }
}

/// Both values of `of` at each of the roll lengths `s`.
#[inline(always)]
fn at_each<T: Numbers>(s: T, of: impl Fn(f64) -> (f64, f64)) -> (T, T) {
    let (mut one, mut other) = (T::splat(0.0), T::splat(0.0));
    for place in 0..T::LANES {
        let (first, second) = of(s.extract(place));
        one.replace(place, first);
        other.replace(place, second);
    }
    (one, other)
}

impl<'a> Pose<'a> {
    /// The teeth of a pair as drawn, `phase` mesh periods after it passed the pitch point, with points on the flank of `primary`.
    pub(crate) fn drawn(pair: &'a GearPair, phase: f64, primary: Member) -> Self {
        Self {
            pair,
            primary,
            flanks: Member::BOTH.map(|member| RealFlank::drawn(pair.gear(member))),
            centers: axes(pair),
            angles: angles(pair, phase),
            rotations: [[1.0, 0.0]; 2],
            weights: weights(pair, phase),
        }
    }

    /// The teeth of `pair` with these `deviations` in a `section`, the driven gear lagging by `lag` on its base circle. Points on the flank of `primary` are placed on
    /// the pair as drawn at the phase `placed_at`.
    pub(crate) fn real(
        (pair, deviations): (&'a GearPair, &'a PairDeviations),
        section: Section,
        lag: f64,
        (primary, placed_at): (Member, f64),
    ) -> Self {
        let teeth = pair.teeth(section.pair);
        let flanks = Member::BOTH.map(|member| {
            let tooth = teeth[member.index()];
            RealFlank::of_tooth(pair.gear(member), deviations.of_gear(member), tooth)
        });
        let mut angles = angles(pair, section.phase);
        angles[1] += lag / pair.driven().base_radius();
        let in_middle = [0, 1].map(|g| angles[g] - section.twists[g]);
        let ahead = (section.phase - placed_at) * pair.base_pitch();
        let advance = [ahead, lag - ahead];
        Self {
            pair,
            primary,
            flanks,
            centers: centers(pair, deviations, section.pair, in_middle),
            angles: [0, 1].map(|g| angles[g] - section.removed[g] / flanks[g].base_radius()),
            rotations: [0, 1].map(|g| {
                let length = advance[g] + flanks[g].turn - section.removed[g];
                turn(length, flanks[g].base_radius())
            }),
            weights: weights(pair, section.phase),
        }
    }

    /// The same flanks, with points on the other one.
    pub(crate) fn seen_from_secondary(&self) -> Self {
        Self {
            primary: self.primary.other(),
            ..*self
        }
    }

    /// Where the own axis of `member` stands, and the angle of the centerline of its tooth.
    pub(crate) fn frame(&self, member: Member) -> (Vector, f64) {
        (self.centers[member.index()], self.angles[member.index()])
    }

    /// The point of the primary flank at the roll length `s`, and its gap; `None` inside the other base circle.
    pub(crate) fn point_at(&self, s: f64) -> Option<FacingPoint> {
        let place = self.place(s);
        Some(FacingPoint {
            roll_length: s,
            gap: self.rotation_gap(place.point)?,
            place,
        })
    }

    /// The place on the primary flank at roll length `s`.
    pub(crate) fn place(&self, s: f64) -> FlankPlace {
        let (g, flank) = (self.primary.index(), &self.flanks[self.primary.index()]);
        let r_b = flank.base_radius();
        let (removed, inclination) = flank.removed_and_inclination(s);
        let t = self.angles[g] + flank.gear.flank().tangent_angle(s) - (removed - flank.turn) / r_b;
        let e_r = radial(t);
        let e_t = quarter_turned(e_r);
        let slope = flank.removed_slope(s);
        FlankPlace {
            point: self.centers[g] + r_b * e_r + s * e_t,
            normal: inclined(e_r, e_t, s, r_b, inclination),
            // An arc grows by s/r_b along a roll length.
            way: (1.0 + slope) * e_r - slope * r_b / s.max(1e-9 * r_b) * e_t,
            radial: e_r,
        }
    }

    /// Position of `point` against the flank opposite to the primary gear's; `None` from inside its base circle.
    fn rotation_gap(&self, point: Vector) -> Option<RotationGap> {
        let g = self.primary.other().index();
        let flank = &self.flanks[g];
        let r_b = flank.base_radius();
        let (s, e_r) = tangent(point - self.centers[g], r_b);
        if s == 0.0 {
            return None;
        }
        let t = e_r.y.atan2(e_r.x);
        let turn = self.angles[g] + flank.gear.flank().base_half_angle() - t;
        let foot = r_b * (turn - (turn / (2.0 * PI)).round() * 2.0 * PI);
        let at_rest = flank.rotation_gap((s, e_r), foot);
        Some(RotationGap {
            gap: at_rest.gap - flank.turn,
            ..at_rest
        })
    }

    /// How the rotation gap of `point` and its roll length on the other flank change as it moves along its own flank, by its arc.
    pub(crate) fn change(&self, point: &FacingPoint) -> (f64, f64) {
        let (way, gap) = (point.place.way, &point.gap);
        let flank = &self.flanks[self.primary.other().index()];
        // The point stands at r_b e_r(t) + s e_t(t) of the center: dt = −way·e_r/s, and s less the foot changes as way·e_t.
        let out = way.dot(&quarter_turned(gap.radial));
        let growth = out + flank.base_radius() / gap.roll_length * way.dot(&gap.radial);
        (out + flank.removed_slope(gap.roll_length) * growth, growth)
    }

    /// The distance of `point` from the fillet on the loaded side of the tooth opposite to the primary gear's, positive outside.
    pub(crate) fn fillet_distance(&self, point: Vector) -> f64 {
        const POINTS: u32 = 64;
        let member = self.primary.other();
        let d = point - self.centers[member.index()];
        let (e_x, e_y) = (
            radial(self.angles[member.index()]),
            tangential(self.angles[member.index()]),
        );
        let in_tooth = Vector::new(d.dot(&e_x), d.dot(&e_y));
        let fillet = self.pair.gear(member).fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let at =
            |i: u32| fillet.point(gamma_0 + (gamma_1 - gamma_0) * f64::from(i) / f64::from(POINTS));
        let mut nearest = f64::INFINITY;
        for i in 0..POINTS {
            let (from, to) = (at(i), at(i + 1));
            let way = to - from;
            let part = ((in_tooth - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            let apart = in_tooth - from - part * way;
            // On the way down to the root the space lies on the left of the tooth.
            let side = apart.dot(&Vector::new(way.y, -way.x));
            if apart.norm() < nearest.abs() {
                nearest = apart.norm().copysign(side);
            }
        }
        nearest
    }
}
