//! A closed curve of lines and arcs around an opening.
//!
//! A side is said by its ends and its bulge b = tan(θ/4) with the angle θ through which it turns, positive counter-clockwise: 0 of a line,
//! 1 of a half circle. So a side whose ends are moved or rounded still runs from one to the other.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::moments::Moments;
use crate::gear::{Vector, radial, turned};

/// Two lengths that differ by less, as a part of the reach of the curve, are equal: more than the digits that a drawing has.
pub(super) const SAME: f64 = 1e-9;
/// The sharpest corner that the material may have, in radians: 30 degrees. Elements do not fill a sharper one.
const SHARPEST_MATERIAL: f64 = PI / 6.0;
/// The sharpest corner that the opening may have, in radians: 10 degrees.
const SHARPEST_OPENING: f64 = PI / 18.0;
/// Sides that meet at a smaller angle, in radians, join smoothly: 5 degrees.
pub(super) const SMOOTH: f64 = PI / 36.0;
/// How near to their common corner two sides may cross once more, as a part of the reach of the curve.
const JOINS: f64 = 1e-4;

/// A line or an arc. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Side {
    /// Where it begins.
    pub from: Vector,
    /// Where it ends.
    pub to: Vector,
    /// tan(θ/4) with the angle θ through which it turns, positive counter-clockwise; 0 of a line.
    pub bulge: f64,
    /// The center of an arc.
    pub(super) center: Vector,
    /// Its radius.
    pub(super) radius: f64,
    /// Its length.
    length: f64,
}

impl Side {
    /// From `from` to `to`, with the `bulge` tan(θ/4).
    pub fn new(from: Vector, to: Vector, bulge: f64) -> Self {
        let (middle, along) = ((from + to) / 2.0, to - from);
        let chord = along.norm();
        let mut side = Self {
            from,
            to,
            bulge,
            center: middle,
            radius: 0.0,
            length: chord,
        };
        if bulge != 0.0 {
            // The center stands θ/2 to the left: by half the chord times cot(θ/2).
            let left = Vector::new(-along.y, along.x);
            side.center = middle + left * ((1.0 - bulge * bulge) / (4.0 * bulge));
            side.radius = chord * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
            side.length = side.radius * side.turn().abs();
        }
        side
    }

    /// The arc from `from` through `through` to `to`; `None` if these are not three points of an arc.
    pub fn through(from: Vector, through: Vector, to: Vector) -> Option<Self> {
        let (a, b) = (from - through, to - through);
        // The angle at a point of a circle is half of that at the center, on the other side of the chord.
        let seen = cross(b, a).atan2(b.dot(&a));
        let turn = seen.signum() * (TAU - 2.0 * seen.abs());
        let is_arc = a.norm() > 0.0 && b.norm() > 0.0 && (from - to).norm() > 0.0;
        (is_arc && turn.abs() > SAME && turn.abs() < TAU - SAME)
            .then(|| Self::new(from, to, (turn / 4.0).tan()))
    }

    /// The angle through which it turns, positive counter-clockwise; 0 of a line.
    pub fn turn(&self) -> f64 {
        4.0 * self.bulge.atan()
    }

    /// A point in the middle of it.
    pub fn middle(&self) -> Vector {
        self.point(self.length / 2.0)
    }

    /// The same side the other way round.
    pub fn reversed(&self) -> Self {
        Self::new(self.to, self.from, -self.bulge)
    }

    /// The same turned about the axis by `angle` counter-clockwise.
    pub fn turned(&self, angle: f64) -> Self {
        Self::new(turned(self.from, angle), turned(self.to, angle), self.bulge)
    }

    /// The radius of an arc; 0 of a line.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Center and radius of a circle around it: that of its chord, or its own where it turns by more than half a turn.
    pub(crate) fn circle_around(&self) -> (Vector, f64) {
        if self.bulge.abs() > 1.0 {
            (self.center, self.radius)
        } else {
            let half = (self.to - self.from) / 2.0;
            (self.from + half, half.norm())
        }
    }

    /// How far off `point` is.
    pub fn distance_to(&self, point: Vector) -> f64 {
        (self.nearest_to(point) - point).norm()
    }

    /// The point at `length` from its beginning.
    pub fn point(&self, length: f64) -> Vector {
        if length <= 0.0 {
            return self.from;
        }
        if length >= self.length {
            return self.to;
        }
        let part = length / self.length;
        if self.bulge == 0.0 {
            return self.from + part * (self.to - self.from);
        }
        self.center + turned(self.from - self.center, part * self.turn())
    }

    /// The direction in which it runs at its beginning and at its end.
    fn directions(&self) -> [Vector; 2] {
        let along = (self.to - self.from).normalize();
        [-0.5, 0.5].map(|part| turned(along, part * self.turn()))
    }

    /// The direction in which it runs at its point nearest to `at`.
    fn direction_at(&self, at: Vector) -> Vector {
        if self.bulge == 0.0 {
            return (self.to - self.from).normalize();
        }
        let arm = (at - self.center).normalize();
        self.bulge.signum() * Vector::new(-arm.y, arm.x)
    }

    /// True if a point of its circle stands on it.
    fn spans(&self, point: Vector) -> bool {
        // On the side of the chord on which the arc lies.
        cross(self.to - self.from, point - self.from) * self.bulge <= 0.0
    }

    /// Its point nearest to `point`.
    fn nearest_to(&self, point: Vector) -> Vector {
        let ends = || {
            if (point - self.from).norm_squared() <= (point - self.to).norm_squared() {
                self.from
            } else {
                self.to
            }
        };
        if self.bulge == 0.0 {
            let along = self.to - self.from;
            let part = (point - self.from).dot(&along) / along.norm_squared();
            return self.from + part.clamp(0.0, 1.0) * along;
        }
        let arm = point - self.center;
        let foot = self.center + arm * (self.radius / arm.norm());
        if arm.norm() > 0.0 && self.spans(foot) {
            foot
        } else {
            ends()
        }
    }

    /// The points where the whole line or circle of one meets that of the other.
    fn crossings_of_curves(&self, other: &Self) -> Vec<Vector> {
        match (self.bulge == 0.0, other.bulge == 0.0) {
            (true, true) => {
                let (a, b) = (self.to - self.from, other.to - other.from);
                let sine = cross(a, b);
                if sine.abs() <= f64::EPSILON * a.norm() * b.norm() {
                    return Vec::new();
                }
                vec![self.from + a * (cross(other.from - self.from, b) / sine)]
            }
            (true, false) => self.crossings_with_circle(other.center, other.radius),
            (false, true) => other.crossings_with_circle(self.center, self.radius),
            (false, false) => {
                circles_meet((self.center, self.radius), (other.center, other.radius))
            }
        }
    }

    /// Where the line of a line meets a circle.
    fn crossings_with_circle(&self, center: Vector, radius: f64) -> Vec<Vector> {
        let along = (self.to - self.from).normalize();
        let foot = self.from + along * (center - self.from).dot(&along);
        let square = radius * radius - (center - foot).norm_squared();
        if square < 0.0 {
            return Vec::new();
        }
        let half = square.sqrt();
        vec![foot - half * along, foot + half * along]
    }

    /// True if a point of its whole line or circle belongs to it, to within `slack`.
    fn has(&self, point: Vector, slack: f64) -> bool {
        (self.nearest_to(point) - point).norm() <= slack
    }

    /// Its points where it meets `other`.
    fn meets(&self, other: &Self, slack: f64) -> Vec<Vector> {
        let mut points = self.crossings_of_curves(other);
        points.retain(|point| self.has(*point, slack) && other.has(*point, slack));
        points
    }

    /// The nearest points of this side and `other`, which do not meet.
    fn nearest(&self, other: &Self) -> (f64, [Vector; 2]) {
        let mut pairs = vec![
            [self.from, other.nearest_to(self.from)],
            [self.to, other.nearest_to(self.to)],
            [self.nearest_to(other.from), other.from],
            [self.nearest_to(other.to), other.to],
        ];
        // Between the ends both stand square to the way from one to the other: through the centers of arcs.
        let mut between = |one: Vector, two: Vector| {
            let (p, q) = (self.nearest_to(one), other.nearest_to(two));
            pairs.push([p, other.nearest_to(p)]);
            pairs.push([self.nearest_to(q), q]);
        };
        match (self.bulge == 0.0, other.bulge == 0.0) {
            (true, true) => {}
            (true, false) => between(other.center, self.nearest_to(other.center)),
            (false, true) => between(other.nearest_to(self.center), self.center),
            (false, false) => {
                between(other.center, self.center);
                // On the far sides of both, seen from each other.
                let way = other.center - self.center;
                between(self.center - way, other.center + way);
            }
        }
        pairs
            .into_iter()
            .map(|pair| ((pair[1] - pair[0]).norm(), pair))
            .fold((f64::INFINITY, [self.from; 2]), |least, next| {
                if next.0 < least.0 { next } else { least }
            })
    }

    /// The least and the largest distance of its points from the axis.
    pub fn reach(&self) -> [f64; 2] {
        let ends = [self.from.norm(), self.to.norm()];
        let mut least = self
            .nearest_to(Vector::zeros())
            .norm()
            .min(ends[0])
            .min(ends[1]);
        let mut largest = ends[0].max(ends[1]);
        let off = self.center.norm();
        if self.bulge != 0.0 && off > 0.0 {
            let far = self.center * (1.0 + self.radius / off);
            if self.spans(far) {
                largest = largest.max(off + self.radius);
            }
        } else if self.bulge != 0.0 {
            [least, largest] = [self.radius; 2];
        }
        [least, largest]
    }

    /// Its contribution to the moments of a region on its left.
    pub fn moments(&self) -> Moments {
        if self.bulge == 0.0 {
            return Moments::under_line(self.from, self.to);
        }
        let arm = self.from - self.center;
        let start = arm.y.atan2(arm.x);
        Moments::under_arc(self.center, self.radius, start, start + self.turn())
    }

    /// The lengths along it at which the circle of `radius` about the axis crosses it, in order.
    fn crossings(&self, radius: f64) -> Vec<f64> {
        let points = if self.bulge == 0.0 {
            self.crossings_with_circle(Vector::zeros(), radius)
        } else {
            circles_meet((self.center, self.radius), (Vector::zeros(), radius))
        };
        let slack = SAME * radius;
        let mut lengths: Vec<f64> = points
            .into_iter()
            .filter(|point| self.has(*point, slack))
            .map(|point| self.length_to(point))
            .collect();
        lengths.sort_by(f64::total_cmp);
        lengths
    }

    /// The length from its beginning to a `point` of it.
    fn length_to(&self, point: Vector) -> f64 {
        if self.bulge == 0.0 {
            return (point - self.from).norm().min(self.length);
        }
        let (arm, to) = (self.from - self.center, point - self.center);
        let angle = self.bulge.signum() * cross(arm, to).atan2(arm.dot(&to));
        // The beginning itself may be seen just behind.
        let angle = (angle + SAME).rem_euclid(TAU) - SAME;
        (self.radius * angle).clamp(0.0, self.length)
    }

    /// How often the side and the chord back go around `point`.
    fn winds(&self, point: Vector) -> i32 {
        let within = self.bulge != 0.0
            && (point - self.center).norm() < self.radius
            && cross(self.to - self.from, point - self.from) * self.bulge < 0.0;
        if within {
            self.bulge.signum() as i32
        } else {
            0
        }
    }
}

/// Faults of a curve that is to bound an opening. Sides and corners are numbered by their places in the list; corner i is where side i begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContourFault {
    /// A side ends where it begins.
    NoLength {
        /// The side.
        side: usize,
    },
    /// There are not enough sides to enclose anything.
    TooFew,
    /// Two sides cross or touch, other than at the corner that they share.
    Crosses {
        /// The two sides.
        sides: [usize; 2],
    },
    /// The material or the opening has a corner that is too sharp for elements.
    TooSharp {
        /// The corner.
        corner: usize,
    },
    /// The curve runs clockwise.
    Clockwise,
    /// The axis of the gear lies within.
    AroundAxis,
}

/// A closed curve of lines and arcs around an opening that does not contain the axis, counter-clockwise, in the frame whose x axis runs through
/// the center of mass of the opening.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour(pub(super) Arc<[Side]>);

impl Contour {
    /// Its sides.
    pub fn sides(&self) -> &[Side] {
        &self.0
    }

    /// The same with each coordinate times `factor`, and numbers `shortened`.
    pub(crate) fn scaled(&self, factor: f64, shortened: impl Fn(f64) -> f64) -> Self {
        let short = |p: Vector| (p * factor).map(&shortened);
        let side = |s: &Side| Side::new(short(s.from), short(s.to), shortened(s.bulge));
        Self(self.0.iter().map(side).collect())
    }

    /// The mirror image about the x axis, counter-clockwise again: reflection and the reversed order change the sign of a bulge twice.
    pub(super) fn mirrored(&self) -> Self {
        let mirror = |p: Vector| Vector::new(p.x, -p.y);
        let side = |s: &Side| Side::new(mirror(s.to), mirror(s.from), s.bulge);
        Self(self.0.iter().rev().map(side).collect())
    }

    /// True if the sides of both are the same to within `slack`, whichever side is the first. The middle of an arc may be off by twice as much as its ends: it
    /// moves with both of them and with the point that defines it.
    pub(super) fn is_like(&self, other: &Self, slack: f64) -> bool {
        let near = |a: &Side, b: &Side| {
            (a.from - b.from).norm() <= slack
                && (a.bulge - b.bulge).abs() * a.length <= 4.0 * slack * (1.0 + a.bulge * a.bulge)
        };
        let count = self.0.len();
        let begins_at = |first: usize| {
            let turned = other.0[first..].iter().chain(&other.0[..first]);
            self.0.iter().zip(turned).all(|(a, b)| near(a, b))
        };
        count == other.0.len() && (0..count).any(begins_at)
    }

    /// The length all around.
    pub(crate) fn length(&self) -> f64 {
        self.0.iter().map(|side| side.length).sum()
    }

    /// The point at `length` from the beginning of the first side.
    pub(crate) fn point(&self, length: f64) -> Vector {
        let mut left = length;
        for side in self.0.iter() {
            if left <= side.length {
                return side.point(left);
            }
            left -= side.length;
        }
        self.0[0].from
    }

    /// The lengths at which its sides begin, and whether they meet the ones before at an angle.
    pub(crate) fn corners(&self) -> Vec<(f64, bool)> {
        let mut length = 0.0;
        (0..self.0.len())
            .map(|i| {
                let at = length;
                length += self.0[i].length;
                (at, self.turn_at(i).abs() > SMOOTH)
            })
            .collect()
    }

    /// The angle by which the curve turns where side `i` begins.
    fn turn_at(&self, i: usize) -> f64 {
        turn_at(&self.0, i)
    }

    /// The lengths at which the circle of `radius` about the axis crosses it, with the sine of the angle of each crossing.
    pub(crate) fn crossings(&self, radius: f64) -> Vec<(f64, f64)> {
        let mut before = 0.0;
        let mut found = Vec::new();
        for side in self.0.iter() {
            for length in side.crossings(radius) {
                let point = side.point(length);
                let sine = side.direction_at(point).dot(&point.normalize()).abs();
                found.push((before + length, sine));
            }
            before += side.length;
        }
        found
    }

    /// The distance from `point` to the curve, negative inside of it.
    pub(super) fn distance_to(&self, point: Vector) -> f64 {
        let distances = self.0.iter().map(|side| side.distance_to(point));
        let distance = distances.fold(f64::INFINITY, f64::min);
        if self.contains(point) {
            -distance
        } else {
            distance
        }
    }

    /// The distance from `point`, in the material, to a part of the curve that faces the nearest one across the material; infinite where there is none.
    pub(crate) fn distance_across(&self, point: Vector) -> f64 {
        let ways = || {
            self.0.iter().map(|side| {
                let foot = side.nearest_to(point);
                let way = foot - point;
                let distance = way.norm();
                let along = side.direction_at(foot);
                // On the curve the way to it is the way into the opening, which lies on the left.
                let way = match distance > SAME * self.0[0].from.norm() {
                    true => way / distance,
                    false => Vector::new(-along.y, along.x),
                };
                (distance, way)
            })
        };
        let Some((_, towards)) = ways().min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return f64::INFINITY;
        };
        ways()
            .filter(|(_, way)| way.dot(&towards) < -0.5)
            .fold(f64::INFINITY, |least, (distance, _)| least.min(distance))
    }

    /// True if `point` lies in the opening.
    pub(super) fn contains(&self, point: Vector) -> bool {
        winding(&self.0, point) != 0
    }

    /// Half the extent of the opening: along the radius, or twice its area by its circumference, which is the radius of a circle.
    pub(super) fn half_width(&self) -> f64 {
        let [inner, outer] = self.reach();
        ((outer - inner) / 2.0).min(2.0 * self.moments_within(f64::INFINITY).area / self.length())
    }

    /// The least and the largest radius that the opening reaches.
    pub(super) fn reach(&self) -> [f64; 2] {
        let reaches = self.0.iter().map(Side::reach);
        reaches.fold([f64::INFINITY, 0.0], |[least, largest], [low, high]| {
            [least.min(low), largest.max(high)]
        })
    }

    /// Area and moments of the part of the opening within `radius` of the axis, in the frame of the curve.
    pub(super) fn moments_within(&self, radius: f64) -> Moments {
        let [inner, outer] = self.reach();
        if radius <= inner {
            return Moments::default();
        }
        if radius >= outer {
            return self.0.iter().map(Side::moments).sum();
        }
        let mut sum = Moments::default();
        let mut angles = Vec::new();
        for side in self.0.iter() {
            let crossings = side.crossings(radius);
            angles.extend(crossings.iter().map(|length| {
                let point = side.point(*length);
                point.y.atan2(point.x)
            }));
            let ends: Vec<f64> = [vec![0.0], crossings, vec![side.length]].concat();
            for piece in ends.windows(2) {
                let [from, to] = [piece[0], piece[1]];
                let part = (to - from) / side.length;
                if part > 0.0 && side.point(f64::midpoint(from, to)).norm() < radius {
                    let bulge = (part * side.bulge.atan()).tan();
                    sum = sum + Side::new(side.point(from), side.point(to), bulge).moments();
                }
            }
        }
        angles.sort_by(f64::total_cmp);
        for i in 0..angles.len() {
            let next = match angles.get(i + 1) {
                Some(next) => *next,
                None => angles[0] + TAU,
            };
            if self.contains(radius * radial(f64::midpoint(angles[i], next))) {
                sum = sum + Moments::under_arc(Vector::zeros(), radius, angles[i], next);
            }
        }
        sum
    }

    /// The least material between two parts of the curve that face each other, square to both; infinite where nothing stands between two parts.
    pub(super) fn neck(&self) -> f64 {
        let count = self.0.len();
        let mut least = f64::INFINITY;
        for i in 0..count {
            for j in i + 2..count {
                if i == 0 && j == count - 1 {
                    continue;
                }
                let (distance, [p, q]) = self.0[i].nearest(&self.0[j]);
                let way = (q - p) / distance;
                // A step along the curve, on either side, does not bring one nearer to the other.
                let stands = self.leads_away(i, p, way) && self.leads_away(j, q, -way);
                if distance < least && stands && !self.contains((p + q) / 2.0) {
                    least = distance;
                }
            }
        }
        least
    }

    /// True if no way along the curve from the point `at` of side `i` has a part along `way`.
    fn leads_away(&self, i: usize, at: Vector, way: Vector) -> bool {
        const SQUARE: f64 = 1e-6;
        let (count, side) = (self.0.len(), &self.0[i]);
        let slack = SAME * self.0[0].from.norm();
        let own = side.direction_at(at);
        let forward = match (side.to - at).norm() <= slack {
            true => self.0[(i + 1) % count].directions()[0],
            false => own,
        };
        let back = match (side.from - at).norm() <= slack {
            true => self.0[(i + count - 1) % count].directions()[1],
            false => own,
        };
        forward.dot(&way) <= SQUARE && -back.dot(&way) <= SQUARE
    }
}

/// The material between the openings inside of two closed curves of `one` and `other`, negative where they overlap.
pub(super) fn between(one: &[Side], other: &[Side]) -> f64 {
    let around =
        |sides: &[Side]| -> Vec<(Vector, f64)> { sides.iter().map(Side::circle_around).collect() };
    let (circles, others) = (around(one), around(other));
    let mut least = f64::INFINITY;
    let mut meet = false;
    for (a, (p, r)) in one.iter().zip(&circles) {
        let slack = SAME * a.from.norm();
        for (b, (q, s)) in other.iter().zip(&others) {
            let apart = (p - q).norm() - r - s;
            if apart > slack && apart > least {
                continue;
            }
            meet |= !a.meets(b, slack).is_empty();
            least = least.min(a.nearest(b).0);
        }
    }
    let depth = |these: &[Side], those: &[Side]| {
        let points = these.iter().flat_map(|side| [side.from, side.middle()]);
        points
            .filter(|point| winding(those, *point) != 0)
            .map(|point| {
                let distances = those.iter().map(|side| side.distance_to(point));
                distances.fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max)
    };
    let depth = f64::max(depth(one, other), depth(other, one));
    if meet || depth > 0.0 { -depth } else { least }
}

/// Refuses curves that are not simple, closed and counter-clockwise, or that contain the axis.
pub(super) fn check(sides: &[Side]) -> Result<(), ContourFault> {
    let count = sides.len();
    let size = sides
        .iter()
        .map(|side| side.from.norm())
        .fold(0.0, f64::max);
    let slack = SAME * size;
    if let Some(side) = sides
        .iter()
        .position(|side| side.length.is_nan() || side.length <= slack)
    {
        return Err(ContourFault::NoLength { side });
    }
    if count < 2 || sides.iter().all(|side| side.bulge == 0.0) && count < 3 {
        return Err(ContourFault::TooFew);
    }
    for i in 0..count {
        for j in i + 1..count {
            let mut shared = Vec::new();
            shared.extend((j == i + 1).then_some(sides[j].from));
            shared.extend((i == 0 && j == count - 1).then_some(sides[0].from));
            // Sides that join smoothly to the digits of a drawing may cross once more close to where they join.
            let near = |point: &Vector| shared.iter().any(|at| (point - at).norm() <= JOINS * size);
            let touch = shared.is_empty() && sides[i].nearest(&sides[j]).0 <= slack;
            if touch || !sides[i].meets(&sides[j], slack).iter().all(near) {
                return Err(ContourFault::Crosses { sides: [i, j] });
            }
        }
    }
    let turns: f64 = (0..count)
        .map(|i| sides[i].turn() + turn_at(sides, i))
        .sum();
    if (turns.abs() - TAU).abs() > PI {
        return Err(ContourFault::Crosses {
            sides: [0, count - 1],
        });
    }
    let area = sides.iter().map(Side::moments).sum::<Moments>().area;
    if area <= 0.0 {
        return Err(ContourFault::Clockwise);
    }
    if winding(sides, Vector::zeros()) != 0 {
        return Err(ContourFault::AroundAxis);
    }
    let sharp = |corner: &usize| {
        let turn = turn_at(sides, *corner);
        PI + turn < SHARPEST_MATERIAL || PI - turn < SHARPEST_OPENING
    };
    match (0..count).find(sharp) {
        Some(corner) => Err(ContourFault::TooSharp { corner }),
        None => Ok(()),
    }
}

/// The angle by which the curve turns where side `i` begins.
pub(super) fn turn_at(sides: &[Side], i: usize) -> f64 {
    let [_, before] = sides[(i + sides.len() - 1) % sides.len()].directions();
    let [after, _] = sides[i].directions();
    cross(before, after).atan2(before.dot(&after))
}

/// How often a closed curve goes around `point`, counter-clockwise. Each side begins exactly where the one before it ends.
pub fn winding(sides: &[Side], point: Vector) -> i32 {
    let mut winds = 0;
    for side in sides {
        let (a, b) = (side.from - point, side.to - point);
        if (a.y <= 0.0) != (b.y <= 0.0) {
            let left = cross(a, b);
            if b.y > 0.0 && left > 0.0 {
                winds += 1;
            } else if b.y <= 0.0 && left < 0.0 {
                winds -= 1;
            }
        }
        winds += side.winds(point);
    }
    winds
}

/// The same curve with as few sides as it can have.
pub(super) fn merged(sides: &[Side]) -> Vec<Side> {
    let count = sides.len();
    let joins = |i: usize| joined(&sides[(i + count - 1) % count], &sides[i]).is_some();
    // All on one circle: two halves of it say so.
    let Some(first) = (0..count).find(|i| !joins(*i)) else {
        let half = sides[0].center * 2.0 - sides[0].from;
        return vec![
            Side::new(sides[0].from, half, 1.0),
            Side::new(half, sides[0].from, 1.0),
        ];
    };
    let mut merged: Vec<Side> = Vec::new();
    for k in 0..count {
        let side = sides[(first + k) % count];
        let both = merged.last().and_then(|last| joined(last, &side));
        if both.is_some() {
            merged.pop();
        }
        merged.push(both.unwrap_or(side));
    }
    merged
}

/// Two sides as one, if they lie on one line or on one circle.
fn joined(one: &Side, other: &Side) -> Option<Side> {
    let slack = SAME * one.length.max(other.length);
    let alike = match (one.bulge == 0.0, other.bulge == 0.0) {
        (true, true) => {
            let along = other.to - one.from;
            along.norm() > slack
                && (one.to - one.from).dot(&along) > 0.0
                && (cross(along, one.to - one.from) / along.norm()).abs() <= slack
                && one.directions()[0].dot(&other.directions()[0]) > 0.0
        }
        (false, false) => {
            (one.center - other.center).norm() <= SAME * one.radius && one.bulge * other.bulge > 0.0
        }
        _ => false,
    };
    alike.then(|| {
        Side::new(
            one.from,
            other.to,
            (one.bulge.atan() + other.bulge.atan()).tan(),
        )
    })
}

/// Where two circles meet.
fn circles_meet((one, r): (Vector, f64), (other, s): (Vector, f64)) -> Vec<Vector> {
    let way = other - one;
    let apart = way.norm();
    if apart == 0.0 {
        return Vec::new();
    }
    let along = way / apart;
    let to_foot = (apart * apart + r * r - s * s) / (2.0 * apart);
    let square = r * r - to_foot * to_foot;
    if square < 0.0 {
        return Vec::new();
    }
    let (foot, half) = (one + to_foot * along, square.sqrt());
    let across = Vector::new(-along.y, along.x);
    vec![foot - half * across, foot + half * across]
}

fn cross(a: Vector, b: Vector) -> f64 {
    a.x * b.y - a.y * b.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Hole;
    use crate::gear::Spokes;
    use crate::gear::blank::hole::tests::holes;

    fn at(x: f64, y: f64) -> Vector {
        Vector::new(x, y) * 1e-3
    }

    fn closed(corners: &[(Vector, f64)]) -> Vec<Side> {
        let next = |i: usize| corners[(i + 1) % corners.len()].0;
        (0..corners.len())
            .map(|i| Side::new(corners[i].0, next(i), corners[i].1))
            .collect()
    }

    /// A notched opening: the material reaches into it.
    fn notched() -> Vec<(Vector, f64)> {
        vec![
            (at(20.0, -10.0), 0.0),
            (at(34.0, -10.0), 0.3),
            (at(34.0, 10.0), 0.0),
            (at(20.0, 10.0), 0.0),
            (at(20.0, 3.0), 0.0),
            (at(30.0, 3.0), 0.0),
            (at(30.0, -3.0), 0.0),
            (at(20.0, -3.0), 0.0),
        ]
    }

    #[test]
    fn an_arc_through_three_points_has_them_and_their_circle() {
        for (bulge, turn) in [
            (0.2_f64, 0.789_582_239_4),
            (-1.0, -PI),
            (3.0, 4.996_183_088_8),
        ] {
            let side = Side::new(at(3.0, 1.0), at(-2.0, 5.0), bulge);
            // θ = 4 atan b.
            assert!((side.turn() - turn).abs() < 1e-9);
            let again = Side::through(side.from, side.middle(), side.to).expect("an arc");
            assert!((again.bulge - bulge).abs() < 1e-14 * bulge.abs().max(1.0));
            for point in [side.from, side.middle(), side.to] {
                assert!(((point - side.center).norm() - side.radius).abs() < 1e-17);
            }
        }
        assert_eq!(
            Side::through(at(0.0, 0.0), at(1.0, 1.0), at(3.0, 3.0)),
            None
        );
        assert_eq!(
            Side::through(at(0.0, 0.0), at(0.0, 0.0), at(3.0, 3.0)),
            None
        );
    }

    #[test]
    fn circles_and_kidneys_drawn_by_their_sides_are_round_holes_and_slots() {
        for hole in holes()
            .into_iter()
            .filter(|hole| hole.ligament_between_own_ends() > 0.0)
        {
            let mut sides = hole.sides();
            // Some other first side, of which there are two halves.
            sides.rotate_left(1);
            let (whole, middle) = (sides[0], sides[0].middle());
            let half = (whole.bulge.atan() / 2.0).tan();
            sides[0] = Side::new(middle, whole.to, half);
            sides.push(Side::new(whole.from, middle, half));
            let found = Contour::opening(&sides).expect("an opening");
            assert_eq!(found.contour(), None);
            let off = found.angle - hole.angle;
            assert!((off - TAU * (off / TAU).round()).abs() < 1e-12);
            assert!((found.circle_radius - hole.circle_radius).abs() < 1e-15);
            assert!((found.half_width() - hole.half_width()).abs() < 1e-15);
            assert!((found.span() - hole.span()).abs() < 1e-12);
        }
    }

    #[test]
    fn moments_within_a_circle_are_those_of_a_fine_lattice() {
        let spokes = Spokes {
            count: 4,
            width: 5e-3,
            fillet_radius: 3e-3,
            inner_radius: 20e-3,
            outer_radius: 36e-3,
            phase: 0.7,
        };
        let notched = Contour::opening(&closed(&notched())).expect("an opening");
        for hole in [notched, spokes.openings().expect("spokes").remove(1)] {
            for radius in [22e-3, 28e-3, 34.5e-3, 1.0] {
                let found = hole.moments_within(radius);
                let (step, mut expected) = (0.05e-3, Moments::default());
                for i in -800..800 {
                    for k in -800..800 {
                        let point = Vector::new(f64::from(i) + 0.5, f64::from(k) + 0.5) * step;
                        if point.norm() < radius && hole.distance_to(point) < 0.0 {
                            let area = step * step;
                            expected = expected
                                + Moments {
                                    area,
                                    first: area * point,
                                    polar: area * point.norm_squared(),
                                };
                        }
                    }
                }
                // Cells on the edge count whole or not at all.
                assert!((found.area - expected.area).abs() < 2e-3 * expected.area);
                assert!((found.first - expected.first).norm() < 2e-3 * expected.area * 30e-3);
                assert!((found.polar - expected.polar).abs() < 2e-3 * expected.polar);
            }
        }
    }

    #[test]
    fn distances_are_those_of_sampled_edges_and_a_notch_has_a_neck() {
        let hole = Contour::opening(&closed(&notched())).expect("an opening");
        let tongue = hole.ligament_between_own_ends();
        assert!(
            (tongue - 6e-3).abs() < 1e-16,
            "between the flanks of the notch: {tongue}"
        );
        assert!(
            (hole.inner_reach() - 409e-6_f64.sqrt()).abs() < 1e-15,
            "a corner beside the notch"
        );
        // The arc from (34, −10) to (34, 10) with b = 0.3 rises by b half chords.
        assert!((hole.outer_reach() - 37e-3).abs() < 1e-15);
        let edge = |hole: &Hole| -> Vec<Vector> {
            let sides = hole.sides().into_iter();
            sides
                .flat_map(|side| {
                    (0..500).map(move |i| side.point(side.length * f64::from(i) / 500.0))
                })
                .collect()
        };
        for other in holes() {
            let moved = Hole {
                angle: other.angle + 2.4,
                circle_radius: other.circle_radius + 12e-3,
                ..other
            };
            let ligament = hole.ligament_to(&moved);
            assert!((ligament - moved.ligament_to(&hole)).abs() < 1e-15);
            let (one, two) = (edge(&hole), edge(&moved));
            let sampled = one
                .iter()
                .flat_map(|p| two.iter().map(move |q| (p - q).norm()))
                .fold(f64::INFINITY, f64::min);
            if ligament > 0.0 {
                assert!(sampled >= ligament - 1e-15 && sampled < ligament + 0.05e-3);
            } else {
                assert!(one.iter().any(|p| moved.distance_to(*p) < 0.2e-3));
            }
        }
    }

    #[test]
    fn curves_that_enclose_no_opening_are_refused() {
        let refused =
            |corners: &[(Vector, f64)]| Contour::opening(&closed(corners)).expect_err("no");
        let mut bow = notched();
        bow.swap(1, 2);
        assert!(matches!(refused(&bow), ContourFault::Crosses { .. }));
        let mut clockwise = notched();
        clockwise.reverse();
        for corner in &mut clockwise {
            corner.1 = 0.0;
        }
        assert_eq!(refused(&clockwise), ContourFault::Clockwise);
        let around = [at(-9.0, -9.0), at(9.0, -9.0), at(9.0, 9.0), at(-9.0, 9.0)];
        assert_eq!(
            refused(&around.map(|corner| (corner, 0.0))),
            ContourFault::AroundAxis
        );
        let twice = [at(20.0, 0.0), at(30.0, 0.0), at(30.0, 0.0), at(30.0, 9.0)];
        assert_eq!(
            refused(&twice.map(|corner| (corner, 0.0))),
            ContourFault::NoLength { side: 1 }
        );
        let thin = [at(20.0, 0.0), at(30.0, 0.0), at(30.0, 1.0)];
        assert_eq!(
            refused(&thin.map(|corner| (corner, 0.0))),
            ContourFault::TooSharp { corner: 0 }
        );
        assert_eq!(
            refused(
                &notched()[..2]
                    .iter()
                    .map(|c| (c.0, 0.0))
                    .collect::<Vec<_>>()
            ),
            ContourFault::TooFew
        );
        // Twice around a circle.
        let thirds = [0.0, 2.0, 4.0].map(|k| at(30.0, 0.0) + 5e-3 * radial(k * TAU / 3.0));
        let bulge = (TAU / 3.0 / 2.0).tan();
        let around = thirds.map(|corner| (corner, bulge));
        assert!(matches!(refused(&around), ContourFault::Crosses { .. }));
    }
}
