//! Splines and ellipses as lines and arcs.

use std::f64::consts::{FRAC_PI_2, TAU};

use meshwright_engine::gear::{Side, Vector};

use super::file::{Entity, code, number};

/// Largest distance of a curve's points from its lines and arcs, in mm: a micrometer, less the part between the points that are checked.
const WITHIN_MM: f64 = 0.9e-3;

/// Share of that for the parts of a curve between its points.
const BETWEEN: f64 = 1.0 / 8.0;

/// The parts of a stretch between two knots before it is looked at where more points are needed.
const PARTS: u32 = 4;

/// A part is divided in two at most so often.
const DEEPEST: u32 = 12;

/// Of the way to the next knots so much is looked at for corners.
const STEP: f64 = 1e-4;

/// A curve turns at a corner by more than this, in radians; in a step it bends by less.
const CORNER: f64 = 1e-3;

/// The most points of a curve.
const MOST_POINTS: usize = 200_000;

/// The most control points of a spline.
const MOST_CONTROLS: usize = 20_000;

/// The largest degree of a spline. The programs that write them have 25 at most.
const LARGEST_DEGREE: usize = 25;

/// An arc turns by a half at most, but for the rounding of its points.
const HALF_TURN: f64 = 1.0 + 1e-9;

/// The lines and arcs of an ellipse, or of a part of one; `turns_over` where its plane is seen from below.
///
/// # Errors
///
/// The end of a sentence, if a group is missing or makes no ellipse.
pub(super) fn ellipse(
    entity: &Entity<'_>,
    turns_over: bool,
    in_mm: f64,
) -> Result<Vec<Side>, String> {
    let [x, y, u, v] =
        [code::X, code::Y, code::END_X, code::END_Y].map(|code| entity.number(code, None));
    let (center, major) = (Vector::new(x?, y?), Vector::new(u?, v?));
    let ratio = entity.number(code::RATIO, None)?;
    if entity.number(code::END_Z, Some(0.0))?.abs() > 1e-6 {
        return Err("does not lie in the plane of the drawing".to_owned());
    }
    if major.norm() <= 0.0 || !(1e-6..=1.0).contains(&ratio) {
        return Err(format!(
            "has a major axis of {} and the ratio {ratio}",
            major.norm()
        ));
    }
    let [start, end] = code::PARAMETERS;
    let start = entity.number(start, Some(0.0))?;
    let end = entity.number(end, Some(TAU))?;
    let turn = (end - start).rem_euclid(TAU);
    let turn = if turn > 1e-9 { turn } else { TAU };
    // Counter-clockwise as its plane is seen from above.
    let sense = if turns_over { -ratio } else { ratio };
    let minor = sense * Vector::new(-major.y, major.x);
    let at = |angle: f64| center + angle.cos() * major + angle.sin() * minor;
    let quarters = (turn / FRAC_PI_2).ceil();
    let knots = (0..=quarters as u32).map(|i| start + turn * f64::from(i) / quarters);
    let mut sides = Vec::new();
    fit(at, &knots.collect::<Vec<_>>(), in_mm, &mut sides)?;
    Ok(sides)
}

/// A rational B-spline.
struct Spline {
    degree: usize,
    knots: Vec<f64>,
    /// The control points times their weights, and the weights.
    controls: Vec<[f64; 3]>,
}

/// The lines and arcs of a spline, or only lines through the points that it is to go through, where the file does not say how.
pub(super) enum Splined {
    Sides(Vec<Side>),
    Points(Vec<Vector>),
}

/// Reads a spline.
///
/// # Errors
///
/// The end of a sentence, if its groups make none, or none in the plane of the drawing.
pub(super) fn spline(entity: &Entity<'_>, in_mm: f64) -> Result<Splined, String> {
    let controls = points(entity, [code::X, code::Y, code::Z])?;
    let through = points(entity, [code::END_X, code::END_Y, code::END_Z])?;
    if controls.is_empty() && through.len() > 1 {
        return Ok(Splined::Points(through));
    }
    let numbers = |wanted: i32| {
        let groups = entity.groups.iter().filter(|group| group.0 == wanted);
        let numbers = groups.map(|(code, text)| number(*code, text));
        numbers.collect::<Result<Vec<f64>, String>>()
    };
    let (knots, mut weights) = (numbers(code::KNOT)?, numbers(code::WEIGHT)?);
    let degree = entity.number(code::DEGREE, None)?;
    let count = controls.len();
    if count > MOST_CONTROLS {
        return Err(format!(
            "has {count} control points; at most {MOST_CONTROLS} are read"
        ));
    }
    if !(1.0..=LARGEST_DEGREE as f64).contains(&degree) || degree.fract() != 0.0 {
        return Err(format!("has the degree {degree}"));
    }
    let degree = degree as usize;
    let rises = knots.windows(2).all(|pair| pair[0] <= pair[1]);
    if count <= degree || knots.len() != count + degree + 1 || !rises {
        return Err(format!(
            "has {count} control points and {} knots, which make no spline of degree {degree}",
            knots.len()
        ));
    }
    if weights.is_empty() {
        weights = vec![1.0; count];
    }
    // Their ratios make the curve: some programs write −1 for each point.
    let alike = |weight: &f64| *weight != 0.0 && weight.signum() == weights[0].signum();
    if weights.len() != count || !weights.iter().all(alike) {
        return Err("has weights of both signs or 0, or not one for each control point".to_owned());
    }
    let controls = controls.iter().zip(&weights);
    let spline = Spline {
        degree,
        controls: controls
            .map(|(at, weight)| [at.x * weight, at.y * weight, *weight])
            .collect(),
        knots,
    };
    let mut sides = Vec::new();
    for stretch in spline.stretches() {
        fit(|u| spline.at(u), &stretch, in_mm, &mut sides)?;
    }
    Ok(Splined::Sides(sides))
}

/// The points that the groups of an entity list, which lie at one height.
fn points(entity: &Entity<'_>, [x, y, z]: [i32; 3]) -> Result<Vec<Vector>, String> {
    let mut points: Vec<Vector> = Vec::new();
    let mut heights: Vec<f64> = Vec::new();
    for (code, text) in &entity.groups {
        if *code == x {
            points.push(Vector::new(number(*code, text)?, 0.0));
        } else if *code == z {
            heights.push(number(*code, text)?);
        } else if let Some(last) = points.last_mut().filter(|_| *code == y) {
            last.y = number(*code, text)?;
        }
    }
    if heights
        .windows(2)
        .any(|pair| (pair[1] - pair[0]).abs() > 1e-6)
    {
        return Err("does not lie in the plane of the drawing".to_owned());
    }
    Ok(points)
}

impl Spline {
    /// The knots of each part between two corners, which may be where as many knots fall together as the degree.
    fn stretches(&self) -> Vec<Vec<f64>> {
        let ends = self.degree..=self.controls.len();
        let mut stretches: Vec<Vec<f64>> = Vec::new();
        let mut stretch: Vec<f64> = Vec::new();
        for same in self.knots[ends].chunk_by(|a, b| a == b) {
            stretch.push(same[0]);
            if same.len() >= self.degree && stretch.len() > 1 && self.has_corner(same[0]) {
                stretches.push(std::mem::replace(&mut stretch, vec![same[0]]));
            }
        }
        if stretch.len() > 1 {
            stretches.push(stretch);
        }
        stretches
    }

    /// True if the curve turns at a knot, by more than it bends on the way there.
    fn has_corner(&self, knot: f64) -> bool {
        let before = self.knots.partition_point(|other| *other < knot);
        let after = self.knots.partition_point(|other| *other <= knot);
        let (Some(before), Some(after)) = (before.checked_sub(1), self.knots.get(after)) else {
            return false;
        };
        let at = self.at(knot);
        let one = at - self.at(knot - STEP * (knot - self.knots[before]));
        let other = self.at(knot + STEP * (after - knot)) - at;
        let turn = (one.x * other.y - one.y * other.x).atan2(one.dot(&other));
        turn.abs() > CORNER
    }

    /// The point at the parameter `u`, by de Boor's recursion.
    fn at(&self, u: f64) -> Vector {
        let p = self.degree;
        // The span [u_k, u_{k+1}) of u, the last one where u is its end.
        let last = self.controls.len() - 1;
        let k = self.knots.partition_point(|knot| *knot <= u);
        let mut k = k.saturating_sub(1).clamp(p, last);
        while k > p && self.knots[k] == self.knots[k + 1] {
            k -= 1;
        }
        let mut d: Vec<[f64; 3]> = self.controls[k - p..=k].to_vec();
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[j + k - p], self.knots[j + 1 + k - r]);
                let part = if high > low {
                    (u - low) / (high - low)
                } else {
                    0.0
                };
                d[j] = [0, 1, 2].map(|i| (1.0 - part) * d[j - 1][i] + part * d[j][i]);
            }
        }
        let [x, y, weight] = d[p];
        Vector::new(x, y) / weight
    }
}

/// Appends the lines and arcs of the smooth curve `at` between the first and the last of the parameters `knots`, each as long as it can be.
///
/// # Errors
///
/// The end of a sentence, if it takes too many points to see how the curve runs.
fn fit(
    at: impl Fn(f64) -> Vector,
    knots: &[f64],
    in_mm: f64,
    sides: &mut Vec<Side>,
) -> Result<(), String> {
    let within = WITHIN_MM / in_mm;
    let mut points = vec![at(knots[0])];
    for span in knots.windows(2) {
        for i in 0..PARTS {
            let [from, to] =
                [i, i + 1].map(|i| span[0] + (span[1] - span[0]) * f64::from(i) / f64::from(PARTS));
            sample(&at, [from, to], within, 0, &mut points);
        }
        if points.len() > MOST_POINTS {
            return Err(format!(
                "takes more than {MOST_POINTS} points to see how it runs"
            ));
        }
    }
    let lengths: Vec<f64> = std::iter::once(0.0)
        .chain(points.windows(2).scan(0.0, |length, ends| {
            *length += (ends[1] - ends[0]).norm();
            Some(*length)
        }))
        .collect();
    // Of an even number of steps, so that there is a point in its middle.
    let side = |from: usize, to: usize| {
        let middle = from + (to - from) / 2;
        let side = piece(points[from], points[middle], points[to])?;
        let fits = side.bulge.abs() <= HALF_TURN
            && lengths[to] - lengths[from] <= 1.02 * side.length() + within
            && points[from..=to]
                .iter()
                .all(|point| side.distance_to(*point) <= within);
        fits.then_some(side)
    };
    let last = points.len() - 1;
    let mut from = 0;
    while from < last {
        // Number of steps that fit, and a number that does not.
        let most = (last - from) / 2;
        let (mut good, mut bad) = (1, most + 1);
        let mut found = side(from, from + 2);
        while found.is_some() && good < most {
            let next = (2 * good).min(most);
            match side(from, from + 2 * next) {
                Some(longer) => (found, good) = (Some(longer), next),
                None => {
                    bad = next;
                    break;
                }
            }
        }
        while found.is_some() && bad - good > 1 {
            let middle = usize::midpoint(good, bad);
            match side(from, from + 2 * middle) {
                Some(longer) => (found, good) = (Some(longer), middle),
                None => bad = middle,
            }
        }
        let to = from + 2 * good;
        match found {
            Some(side) => sides.push(side),
            // A curve that turns back within one step is that step, which is shorter than anything that matters.
            None if points[to] != points[from] => {
                sides.push(Side::new(points[from], points[to], 0.0));
            }
            None => {}
        }
        from = to;
    }
    Ok(())
}

/// Appends the points of a part of a curve to those before: its middle and its end, or those of its halves where they leave too much between them.
fn sample(
    at: &impl Fn(f64) -> Vector,
    [from, to]: [f64; 2],
    within: f64,
    depth: u32,
    points: &mut Vec<Vector>,
) {
    let Some(start) = points.last().copied() else {
        return;
    };
    let middle = f64::midpoint(from, to);
    let quarters = [(from, middle), (middle, to)].map(|(a, b)| at(f64::midpoint(a, b)));
    let (center, end) = (at(middle), at(to));
    let is_seen = piece(start, center, end).is_some_and(|side| {
        let near = |point: &Vector| side.distance_to(*point) <= BETWEEN * within;
        side.bulge.abs() <= HALF_TURN && quarters.iter().all(near)
    });
    if is_seen || depth == DEEPEST || points.len() > MOST_POINTS {
        points.extend([center, end]);
        return;
    }
    for part in [[from, middle], [middle, to]] {
        sample(at, part, within, depth + 1, points);
    }
}

/// The arc or the line through three points; none if the first is the last.
fn piece(from: Vector, through: Vector, to: Vector) -> Option<Side> {
    let line = || (from != to).then(|| Side::new(from, to, 0.0));
    Side::through(from, through, to).or_else(line)
}
