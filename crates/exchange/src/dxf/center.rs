//! Where a drawing turns about.

use std::collections::HashMap;
use std::f64::consts::TAU;

use meshwright_engine::gear::blank::contour::winding;
use meshwright_engine::gear::{Moments, Side, Vector};

/// Of more loops it is not looked at which turn onto each other.
const MOST_TURNED: usize = 400;

/// How far beside a point it is looked at whether a curve runs around it, as a part of the largest radius of the curve.
const BESIDE: f64 = 1e-6;

/// A contour is that of teeth if it has so many alike at least: a frame of a sheet has fewer.
const LEAST_TEETH: usize = 5;

/// A closed curve as a whole.
#[derive(Debug)]
pub(super) struct Whole {
    /// The area that it encloses, in the square of the unit of the drawing, positive counter-clockwise.
    pub(super) area: f64,
    /// The center of mass of that.
    pub(super) center: Vector,
    /// The least and the largest distance of its points from there.
    reach: [f64; 2],
    /// The corners of the rectangle around it.
    bounds: [Vector; 2],
}

/// A closed curve.
#[derive(Debug)]
pub(super) struct Closed {
    pub(super) sides: Vec<Side>,
    pub(super) whole: Whole,
    /// The entities that its sides are of.
    pub(super) sources: Vec<usize>,
}

impl Closed {
    /// That of sides which enclose an area.
    pub(super) fn of(sides: Vec<Side>, sources: Vec<usize>) -> Self {
        Self {
            whole: Whole::of(&sides),
            sides,
            sources,
        }
    }

    /// True if it runs around `inner`, which does not cross it.
    pub(super) fn encloses(&self, inner: &Self) -> bool {
        let point = inner.sides[0].from;
        self.whole.may_hold(point) && self.is_around(point)
    }

    /// True if it runs around a point: around most of three places beside it. Rounding puts a point on the chord of an arc, as the center of a circle, on
    /// either side of it.
    pub(super) fn is_around(&self, point: Vector) -> bool {
        let near = BESIDE * self.whole.reach[1];
        let places =
            [0.3_f64, 2.4, 4.5].map(|angle| point + near * Vector::new(angle.cos(), angle.sin()));
        let inside = places.iter().filter(|at| winding(&self.sides, **at) != 0);
        inside.count() >= 2
    }

    /// True if `other` is the same curve, to within `near`, in either direction.
    pub(super) fn is_same(&self, other: &Self, near: f64) -> bool {
        if (self.whole.center - other.whole.center).norm() > near {
            return false;
        }
        let length: f64 = self.sides.iter().map(Side::length).sum();
        let areas = self.whole.area.abs() - other.whole.area.abs();
        let is_on =
            |of: &[Side], point: Vector| of.iter().any(|side| side.distance_to(point) <= near);
        let all_on = |one: &[Side], of: &[Side]| {
            one.iter()
                .all(|side| is_on(of, side.from) && is_on(of, side.middle()))
        };
        areas.abs() <= near * length
            && all_on(&self.sides, &other.sides)
            && all_on(&other.sides, &self.sides)
    }
}

impl Whole {
    fn of(sides: &[Side]) -> Self {
        let moments: Moments = sides.iter().map(Side::moments).sum();
        let center = moments.first / moments.area;
        let about = |side: &Side| Side::new(side.from - center, side.to - center, side.bulge);
        let reach = reach(&sides.iter().map(about).collect::<Vec<_>>());
        let mut bounds = [sides[0].from; 2];
        // An arc stands out from its chord by no more than its length.
        for side in sides {
            let off = if side.bulge == 0.0 {
                0.0
            } else {
                side.length()
            };
            for end in [side.from, side.to] {
                let out = Vector::new(off, off);
                bounds = [bounds[0].inf(&(end - out)), bounds[1].sup(&(end + out))];
            }
        }
        Self {
            area: moments.area,
            center,
            reach,
            bounds,
        }
    }

    /// True if it is a circle to within `slack`.
    pub(super) fn is_circle(&self, slack: f64) -> bool {
        self.reach[1] - self.reach[0] <= 2.0 * slack
    }

    /// The radius about its center.
    pub(super) fn radius(&self) -> f64 {
        f64::midpoint(self.reach[0], self.reach[1])
    }

    /// True if the rectangle around it contains a point.
    pub(super) fn may_hold(&self, point: Vector) -> bool {
        let [low, high] = self.bounds;
        (low.x..=high.x).contains(&point.x) && (low.y..=high.y).contains(&point.y)
    }
}

/// The point about which a drawing seems to turn, and why it does.
pub(super) struct Seen {
    pub(super) at: Vector,
    pub(super) why: String,
}

/// The point about which closed curves seem to turn, if they seem to: the center of the largest that encloses most others and is a circle, has another
/// about the same center, or is alike all around; else that about which all others turn onto each other.
pub(super) fn seen(loops: &[Closed], slack: f64) -> Option<Seen> {
    let mut by_size: Vec<&Closed> = loops.iter().collect();
    by_size.sort_by(|a, b| b.whole.area.abs().total_cmp(&a.whole.area.abs()));
    for (i, outer) in by_size.iter().enumerate() {
        // In an opening there may be something too, but not most of a drawing.
        let inside = by_size[i + 1..]
            .iter()
            .filter(|inner| outer.encloses(inner));
        let inside: Vec<&Closed> = inside.copied().collect();
        if inside.len() < 2 || 2 * inside.len() < loops.len() - 1 {
            continue;
        }
        let Closed { sides, whole, .. } = outer;
        let at = whole.center;
        let about = |inner: &&&Closed| (inner.whole.center - at).norm() <= slack;
        let why = if whole.is_circle(slack) {
            "the center of a circle around other loops".to_owned()
        } else if let count @ 1.. = inside.iter().filter(about).count() {
            format!("the center of {} loops around each other", count + 1)
        } else if let Some(count) = alike(sides, at, slack) {
            format!("the center of a contour that is alike {count} times")
        } else {
            continue;
        };
        return Some(Seen { at, why });
    }
    let weight = |closed: &Closed| closed.whole.area.abs();
    let first = loops
        .iter()
        .map(|closed| weight(closed) * closed.whole.center)
        .sum::<Vector>();
    let at = first / loops.iter().map(weight).sum::<f64>();
    let beside: Vec<&Whole> = loops
        .iter()
        .map(|closed| &closed.whole)
        .filter(|whole| (whole.center - at).norm() > slack)
        .collect();
    let count = turned_onto(&beside, at, slack)?;
    let why = format!(
        "{} loops turn onto each other about it, {count} times",
        beside.len()
    );
    Some(Seen { at, why })
}

/// How often a contour is alike about `center`, at least [`LEAST_TEETH`] times.
fn alike(sides: &[Side], center: Vector, slack: f64) -> Option<usize> {
    let count = sides.len();
    (LEAST_TEETH..=count).rev().find(|times| {
        if !count.is_multiple_of(*times) {
            return false;
        }
        let step = count / times;
        // Whichever way round it is drawn.
        let angle = TAU / *times as f64 * winding(sides, center).signum() as f64;
        let is_next = |i: usize| {
            let (one, other) = (
                sides[i].from - center,
                sides[(i + step) % count].from - center,
            );
            (turned(one, angle) - other).norm() <= slack
        };
        winding(sides, center) != 0 && (0..count).all(is_next)
    })
}

/// How often all of `loops` turn onto each other about `center` in a revolution, at least three times.
fn turned_onto(loops: &[&Whole], center: Vector, slack: f64) -> Option<usize> {
    let count = loops.len();
    if count > MOST_TURNED {
        return None;
    }
    let cell = |at: Vector| [at.x, at.y].map(|x| (x / slack).round() as i64);
    let mut places: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (i, whole) in loops.iter().enumerate() {
        places.entry(cell(whole.center)).or_default().push(i);
    }
    let has = |at: Vector, area: f64| {
        let [x, y] = cell(at);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j]));
        around
            .filter_map(|cell| places.get(&cell))
            .flatten()
            .any(|i| {
                let other = loops[*i];
                let same = slack * other.area.abs().sqrt();
                (other.center - at).norm() <= slack
                    && (other.area.abs() - area.abs()).abs() <= 4.0 * same
            })
    };
    (3..=count).rev().find(|times| {
        let angle = TAU / *times as f64;
        count.is_multiple_of(*times)
            && loops
                .iter()
                .all(|whole| has(center + turned(whole.center - center, angle), whole.area))
    })
}

fn turned(at: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    Vector::new(cos * at.x - sin * at.y, sin * at.x + cos * at.y)
}

/// The least and the largest distance from the axis.
pub(super) fn reach(sides: &[Side]) -> [f64; 2] {
    let reaches = sides.iter().map(Side::reach);
    reaches.fold([f64::INFINITY, 0.0], |[least, most], [low, high]| {
        [least.min(low), f64::max(most, high)]
    })
}
