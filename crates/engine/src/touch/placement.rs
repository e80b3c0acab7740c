//! Both gears turned to a mesh position, and the gap of one flank to the other.
//!
//! Flanks are taken as they are: modifications and the deviation of a tooth turn each point of its flank about the gear's axis, by
//! e/r_b at the radius at which it stands, and incline its normal by e'.

use std::f64::consts::PI;

use nalgebra::{SimdBool, Vector2};

use crate::gear::{
    GearPair, Member, PairDeviations, SpurGear, Vector, radial, tangential, teeth_on,
};
use crate::wide::Numbers;

/// Both gears at one mesh position, as one tooth pair sees them.
///
/// The driving center is the origin, the driven one lies on the x axis; the driving gear turns counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placement<'a> {
    pub(crate) pair: &'a GearPair,
    /// Where the gears' own axes stand: beside the axes of rotation where they are eccentric.
    pub(crate) centers: [Vector; 2],
    /// The angle of each tooth's centerline.
    angles: [f64; 2],
    /// How much the normal of either flank counts ([`weights`]).
    pub(crate) weights: [f64; 2],
    /// Deviations, and the teeth that are in mesh; `None` for a pair as drawn.
    deviating: Option<(&'a PairDeviations, [usize; 2])>,
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
    /// That of straight teeth as drawn, of `pair` at the mesh position `eta`.
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

/// Position of a point against a flank: the turn of the flank that would pass through it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight {
    /// The roll length of the flank at the radius of the point: the length of the tangent from the point to the base circle.
    pub(crate) roll_length: f64,
    /// The angle by which the flank is to be turned, as a length on its base circle; positive where the point is outside.
    pub(crate) gap: f64,
    /// The outward unit normal of the flank where it passes through the point.
    pub(crate) normal: Vector,
    /// The radial direction of the tangent point on the base circle.
    pub(crate) radial: Vector,
    /// The slope of the missing material there.
    slope: f64,
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

impl<'a> Placement<'a> {
    /// The teeth of a pair as drawn, `phase` mesh periods after it passed the pitch point.
    pub(crate) fn drawn(pair: &'a GearPair, phase: f64) -> Self {
        Self {
            pair,
            centers: axes(pair),
            angles: angles(pair, phase),
            weights: weights(pair, phase),
            deviating: None,
        }
    }

    /// The teeth of `pair` with these `deviations` in a `section`, the driven gear lagging by `lag` on its base circle.
    pub(crate) fn real(
        pair: &'a GearPair,
        deviations: &'a PairDeviations,
        section: Section,
        lag: f64,
    ) -> Self {
        let mut angles = angles(pair, section.phase);
        angles[1] += lag / pair.driven().base_radius();
        let in_middle = [0, 1].map(|g| angles[g] - section.twists[g]);
        let turned = Member::BOTH.map(|member| {
            let g = member.index();
            angles[g] - section.removed[g] / pair.gear(member).base_radius()
        });
        Self {
            pair,
            centers: centers(pair, deviations, section.pair, in_middle),
            angles: turned,
            weights: weights(pair, section.phase),
            deviating: Some((deviations, pair.teeth(section.pair))),
        }
    }

    /// Where the own axis of `member` stands, and the angle of the centerline of its tooth.
    pub(crate) fn frame(&self, member: Member) -> (Vector, f64) {
        (self.centers[member.index()], self.angles[member.index()])
    }

    /// The gears.
    pub(crate) fn gears(&self) -> &'a GearPair {
        self.pair
    }

    /// Material missing from the involute of `member` at the roll length `s`, and its slope.
    fn missing(&self, member: Member, s: f64) -> (f64, f64) {
        let gear = self.pair.gear(member);
        let (depth, slope) = (gear.removed(s), gear.removed_slope(s));
        self.deviating
            .map_or((depth, slope), |(deviations, teeth)| {
                let (gear, tooth) = (deviations.of_gear(member), teeth[member.index()]);
                (depth - gear.at(tooth, s), slope - gear.slope(tooth, s))
            })
    }

    /// By how much the normal of `member` is inclined at the roll length `s`.
    fn inclination(&self, member: Member, s: f64) -> f64 {
        let drawn = self.pair.gear(member).inclination(s);
        self.deviating.map_or(drawn, |(deviations, teeth)| {
            let gear = deviations.of_gear(member);
            drawn - gear.inclination(teeth[member.index()], s)
        })
    }

    /// The place on the flank of `member` at roll length `s`.
    pub(crate) fn place(&self, member: Member, s: f64) -> FlankPlace {
        let gear = self.pair.gear(member);
        let r_b = gear.base_radius();
        let (depth, slope) = self.missing(member, s);
        let t = self.angles[member.index()] + gear.flank().tangent_angle(s) - depth / r_b;
        let e_r = radial(t);
        let e_t = quarter_turned(e_r);
        FlankPlace {
            point: self.centers[member.index()] + r_b * e_r + s * e_t,
            normal: inclined(e_r, e_t, s, r_b, self.inclination(member, s)),
            // An arc grows by s/r_b along a roll length.
            way: (1.0 + slope) * e_r - slope * r_b / s.max(1e-9 * r_b) * e_t,
            radial: e_r,
        }
    }

    /// Position of `point` against the flank of `member`; `None` from inside its base circle.
    pub(crate) fn sight(&self, member: Member, point: Vector) -> Option<Sight> {
        let d = point - self.centers[member.index()];
        let flank = self.pair.gear(member).flank();
        let r_b = flank.base_radius();
        let far = d.norm_squared();
        let s = (far - r_b * r_b).max(0.0).sqrt();
        if s == 0.0 {
            return None;
        }
        // d = r_b e_r + s e_t.
        let e_r = (r_b * d - s * quarter_turned(d)) / far;
        let e_t = quarter_turned(e_r);
        let t = e_r.y.atan2(e_r.x);
        let turn = self.angles[member.index()] + flank.base_half_angle() - t;
        let foot = r_b * (turn - (turn / (2.0 * PI)).round() * 2.0 * PI);
        let (depth, slope) = self.missing(member, s);
        Some(Sight {
            roll_length: s,
            gap: s - foot + depth,
            normal: inclined(e_r, e_t, s, r_b, self.inclination(member, s)),
            radial: e_r,
            slope,
        })
    }

    /// The distance of `point` from the fillet on the loaded side of the tooth of `member`, positive outside.
    pub(crate) fn fillet_distance(&self, member: Member, point: Vector) -> f64 {
        const POINTS: u32 = 64;
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

impl Sight {
    /// How gap and roll length change as the point moves along `way`, on a gear of `base_radius`.
    pub(crate) fn change(&self, base_radius: f64, way: Vector) -> (f64, f64) {
        let across = quarter_turned(self.radial);
        // The point stands at r_b e_r(t) + s e_t(t) of the center: dt = −way·e_r/s, and s less the foot changes as way·e_t.
        let out = way.dot(&across);
        let growth = out + base_radius / self.roll_length * way.dot(&self.radial);
        (out + self.slope * growth, growth)
    }
}
