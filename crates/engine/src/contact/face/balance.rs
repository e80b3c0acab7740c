//! The balance of forces on slices whose springs are not linear.
//!
//! The linear yield of a line is computed in the middles of its slices and interpolated linearly between them; gaps are interpolated linearly from the
//! middles to the ends of slices. At the end of a line the yield is that of the parabola through the last two middles that is even about that end. So the depth
//! p by which flanks are pressed together is piecewise linear along z, and the line load q(p) of the springs is continuous and ends where p does. It is
//! integrated over the loaded part of each half slice. The forces in the middles have the same moments, so that the work is the same:
//!
//! ```text
//! p = δ w − g − P H N,   N = ∫ Pᵀ q(p) dz,   ∫ w q(p) dz = F
//! ```
//!
//! q rises with p, and H = L Lᵀ: with N = L⁻ᵀ y these are the conditions for the least of a convex function of y and δ, and there is one
//! balance. A step of Newton's method is shortened where the function would rise again before its end.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatRef, Par};

use super::compliance::BlurredLine;
use super::slice::{Carried, Slice, Within};
use crate::contact::{ContactError, PositionError};
use crate::fem::dense::Cholesky;

/// Newton steps, of which some eight are taken.
const MOST_STEPS: u32 = 100;

/// Evaluations of the energy's slope along one step, at most.
const MOST_EVALUATIONS: u32 = 40;

/// A step that moves flanks by less than this part of the δ that the load causes ends the iteration, and so does one within the rounding of δ.
const NO_WAY: f64 = 1e-11;

/// The points and weights of Gauss's rules over a loaded half of a slice, and over the loaded part of one, where the load is more curved.
const WHOLE: [[f64; 2]; 2] = [
    [0.211_324_865_405_187_1, 0.5],
    [0.788_675_134_594_812_9, 0.5],
];
const PART: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_9, 0.326_072_577_431_273_1],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_1],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

/// The least depth of a loaded half of a slice over its largest one, up to which [`PART`] is used, and from which on [`WHOLE`] is. In between both are, each with
/// a part of its weight: where forces jumped from one rule to the other, there would be no balance on the jump.
const UNEVEN: f64 = 0.5;
const EVEN: f64 = 0.75;

/// The beginning and the end of a slice.
const SIDES: [f64; 2] = [-1.0, 1.0];

/// A loaded point of integration.
struct Point {
    slice: usize,
    /// The slice of [`Beside`] on its side, and the weight of that one's middle in the interpolation.
    beside: usize,
    share: f64,
    /// On which half of the slice, and where: from the middle (0) to the end (1).
    end: usize,
    place: f64,
    /// The arm about the driven axis.
    weight: f64,
    /// The force that it stands for, and how that grows with the depth.
    force: f64,
    growth: f64,
}

/// The forces on the slices, and the gaps that are left.
pub(super) struct Balance {
    /// Load of each slice.
    pub(super) carried: Vec<Carried>,
    /// The forces in their middles that stand for all of that, N, and how they rise with the load.
    pub(super) forces: Vec<f64>,
    pub(super) load_derivative: Vec<f64>,
    /// The gaps in their middles; where a slice carries load, its residual.
    pub(super) gaps: Vec<f64>,
    /// g + H N − δ w.
    without_springs: Vec<f64>,
    pub(super) transmission_error: f64,
    pub(super) stiffness: f64,
    pub(super) iterations: u32,
    /// The largest line load of a slice in the mean over its loaded part.
    pub(super) heaviest: f64,
    /// By how much the linear yield opens their middles.
    opened: Vec<f64>,
    points: Vec<Point>,
    tangent: Tangent,
    lower: Mat<f64>,
}

/// Where a balance is looked for first.
#[derive(Clone)]
pub(super) struct Start {
    /// The forces in the middles of the slices.
    pub(super) forces: Vec<f64>,
    /// By how much these open them.
    pub(super) opened: Vec<f64>,
    pub(super) transmission_error: f64,
}

/// An iterate.
#[derive(Clone)]
struct State {
    /// y = Lᵀ N.
    y: Vec<f64>,
    /// L y.
    opened: Vec<f64>,
    delta: f64,
}

/// The linear system of a step: 1 + Lᵀ D L, and its answer to δ.
struct Tangent {
    factor: Cholesky<f64>,
    /// Lᵀ d.
    by_delta: Vec<f64>,
    answer: Vec<f64>,
    stiffness: f64,
}

/// The slices to be balanced.
struct Problem<'a> {
    slices: &'a [Slice],
    lower: Mat<f64>,
    load: f64,
}

/// The balance of `slices` under `load` with the linear compliance `h`, looked for from `start`, or from a load that is even along all lines: these change
/// no more of it than its last digits.
///
/// # Errors
///
/// [`ContactError::NotPositiveDefinite`] where the compliance is not positive definite.
pub(super) fn balance(
    h: &Mat<f64>,
    slices: &[Slice],
    load: f64,
    start: Option<&Start>,
) -> Result<Balance, PositionError> {
    let points = slices.len();
    let factor = Cholesky::new(h.clone());
    let factor = factor.ok_or(ContactError::NotPositiveDefinite { points })?;
    let problem = Problem {
        slices,
        lower: factor.lower(),
        load,
    };
    problem.solved(h, start)
}

impl Problem<'_> {
    fn solved(self, h: &Mat<f64>, start: Option<&Start>) -> Result<Balance, PositionError> {
        let touches = self
            .slices
            .iter()
            .map(|slice| slice.middle.gap / slice.middle.weights[1]);
        let touch = touches.fold(f64::INFINITY, f64::min);
        let near = start.map(|start| self.near(start));
        let near = near.map(|state| (self.points(&state), state));
        let near = near.filter(|(points, _)| !points.is_empty());
        let (mut points, mut state) = near.unwrap_or_else(|| {
            let state = self.even(h);
            (self.points(&state), state)
        });
        let mut iterations = 0;
        for _ in 0..MOST_STEPS {
            iterations += 1;
            let (rest, missing) = self.rest(&state, &points);
            let points_of = self.slices.len();
            let tangent = self.tangent(&points);
            let tangent = tangent.ok_or(ContactError::NotPositiveDefinite { points: points_of })?;
            // y and δ change by x + x' dδ, so that nothing is missing.
            let mut way = column(&rest.iter().map(|rest| -rest).collect::<Vec<_>>());
            tangent.factor.solve_in_place(way.as_mut());
            let by_way = dot(&tangent.by_delta, way.col_as_slice(0));
            let delta = (missing + by_way) / tangent.stiffness;
            let way: Vec<f64> = (way.col_as_slice(0).iter().zip(&tangent.answer))
                .map(|(way, answer)| way + delta * answer)
                .collect();
            let way_opens = product(self.lower.as_ref(), &way);
            let fall = dot(&rest, &way) - missing * delta;
            let at = |part: f64| {
                let go = |from: &[f64], way: &[f64]| -> Vec<f64> {
                    from.iter()
                        .zip(way)
                        .map(|(from, way)| from + part * way)
                        .collect()
                };
                let state = State {
                    y: go(&state.y, &way),
                    opened: go(&state.opened, &way_opens),
                    delta: state.delta + part * delta,
                };
                let points = self.points(&state);
                let (rest, missing) = self.rest(&state, &points);
                let rise = dot(&rest, &way) - missing * delta;
                (state, points, rise)
            };
            let longest = way_opens
                .iter()
                .fold(delta.abs(), |most, way| most.max(way.abs()));
            let rounding = 4.0 * f64::EPSILON * state.delta.abs();
            let is_short = longest <= rounding.max(NO_WAY * (state.delta - touch).abs());
            let (mut part, mut end) = (1.0, at(1.0));
            let (mut low, mut high) = ([0.0, fall], [1.0, end.2]);
            let mut evaluations = 0;
            while !is_short && end.2 > 0.5 * fall.abs() && evaluations < MOST_EVALUATIONS {
                // The function is convex: its slope vanishes in between.
                let secant = low[1] / (low[1] - high[1]);
                part = low[0] + (high[0] - low[0]) * secant.clamp(0.1, 0.9);
                end = at(part);
                if end.2 > 0.0 {
                    high = [part, end.2];
                } else {
                    low = [part, end.2];
                }
                evaluations += 1;
            }
            (state, points) = (end.0, end.1);
            if part == 1.0 && is_short {
                return Ok(self.balanced((state, points), tangent, h, iterations));
            }
        }
        Err(PositionError::Contact(ContactError::NotConverged {
            iterations,
            gap: self.rest(&state, &points).1.abs() / self.load * (state.delta - touch),
            pull: 0.0,
        }))
    }

    /// The load spread evenly along all lines.
    fn even(&self, h: &Mat<f64>) -> State {
        let weighed = self
            .slices
            .iter()
            .map(|slice| slice.along * slice.middle.weights[1]);
        let density = self.load / weighed.sum::<f64>();
        let forces: Vec<f64> = self
            .slices
            .iter()
            .map(|slice| density * slice.along)
            .collect();
        let deltas = self.slices.iter().zip(product(h.as_ref(), &forces));
        let deltas = deltas.map(|(slice, opened)| {
            let closed = slice.middle.spring.closing(density);
            (slice.middle.gap + opened + closed) / slice.middle.weights[1]
        });
        let delta = deltas.sum::<f64>() / self.slices.len() as f64;
        self.under(&forces, delta)
    }

    /// The forces of another balance. To first order δ changes by Nᵀ ΔH N/F.
    fn near(&self, start: &Start) -> State {
        let mut state = self.under(&start.forces, start.transmission_error);
        let more = state.opened.iter().zip(&start.opened);
        let work = more.zip(&start.forces);
        let work = work.map(|((now, before), force)| (now - before) * force);
        state.delta += work.sum::<f64>() / self.load;
        state
    }

    /// These `forces` in the middles of the slices, at this δ.
    fn under(&self, forces: &[f64], delta: f64) -> State {
        let y = self.lower.transpose() * column(forces);
        let y = y.col_as_slice(0).to_vec();
        State {
            opened: product(self.lower.as_ref(), &y),
            delta,
            y,
        }
    }

    /// The places that are loaded at `state`.
    fn points(&self, state: &State) -> Vec<Point> {
        let mut points = Vec::with_capacity(4 * self.slices.len());
        for (i, slice) in self.slices.iter().enumerate() {
            for (end, edge) in slice.ends.iter().enumerate() {
                let beside = Beside::of(self.slices, i, end);
                let [middle, outer] = self.depths(state, i, end);
                let Some([from, to]) = loaded_part(middle, outer) else {
                    continue;
                };
                let evenness = (middle.min(outer) / middle.max(outer)).max(0.0);
                let whole = ((evenness - UNEVEN) / (EVEN - UNEVEN)).clamp(0.0, 1.0);
                let rules = [(&WHOLE[..], whole), (&PART[..], 1.0 - whole)];
                let rules = rules.into_iter().filter(|(_, share)| *share > 0.0);
                let points_of =
                    rules.flat_map(|(rule, share)| rule.iter().map(move |[at, w]| (at, w * share)));
                for (gauss, weight) in points_of {
                    let place = from + (to - from) * gauss;
                    let depth = middle + (outer - middle) * place;
                    if depth <= 0.0 {
                        continue;
                    }
                    let along = 0.5 * weight * slice.along * (to - from);
                    let [force, growth] =
                        slice.load(SIDES[end] * place, depth).map(|of| along * of);
                    points.push(Point {
                        slice: i,
                        beside: beside.slice,
                        share: beside.share * place,
                        end,
                        place,
                        weight: slice.middle.weights[1]
                            + (edge.weights[1] - slice.middle.weights[1]) * place,
                        force,
                        growth,
                    });
                }
            }
        }
        points
    }

    /// How far flanks are pressed together at `state` in the middle of slice `i` and at one of its ends.
    fn depths(&self, state: &State, i: usize, end: usize) -> [f64; 2] {
        let slice = &self.slices[i];
        let outer = Beside::of(self.slices, i, end).at_end(&state.opened, i);
        [(&slice.middle, state.opened[i]), (&slice.ends[end], outer)]
            .map(|(place, opened)| state.delta * place.weights[1] - place.gap - opened)
    }

    /// y − Lᵀ N, and the excess of the load over that of `points`.
    fn rest(&self, state: &State, points: &[Point]) -> (Vec<f64>, f64) {
        let forces = in_middles(points, self.slices.len(), |point| point.force);
        let held = self.lower.transpose() * column(&forces);
        let held = held.col_as_slice(0).iter();
        let carried: f64 = points.iter().map(|point| point.weight * point.force).sum();
        let rest = state.y.iter().zip(held).map(|(y, held)| y - held);
        (rest.collect(), self.load - carried)
    }

    fn tangent(&self, points: &[Point]) -> Option<Tangent> {
        let size = self.slices.len();
        let lower = self.lower.as_ref();
        // D couples each slice with the next one.
        let mut middle = vec![[0.0; 2]; size];
        for point in points {
            let own = 1.0 - point.share;
            if point.beside == point.slice {
                middle[point.slice][0] += point.growth;
            } else {
                middle[point.slice][0] += own * own * point.growth;
                middle[point.beside][0] += point.share * point.share * point.growth;
                middle[point.slice.min(point.beside)][1] += own * point.share * point.growth;
            }
        }
        let mut moved = Mat::<f64>::zeros(size, size);
        for j in 0..size {
            let column = lower.col(j);
            let target = moved.col_as_slice_mut(j);
            for i in 0..size {
                let mut sum = middle[i][0] * column[i];
                if i > 0 {
                    sum += middle[i - 1][1] * column[i - 1];
                }
                if i + 1 < size {
                    sum += middle[i][1] * column[i + 1];
                }
                target[i] = sum;
            }
        }
        let mut whole = Mat::<f64>::identity(size, size);
        triangular::matmul(
            whole.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            lower.transpose(),
            BlockStructure::TriangularUpper,
            moved,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        let factor = Cholesky::new(whole)?;
        let grown = in_middles(points, size, |point| point.weight * point.growth);
        let by_delta = lower.transpose() * column(&grown);
        let mut answer = by_delta.clone();
        factor.solve_in_place(answer.as_mut());
        let (by_delta, answer) = (
            by_delta.col_as_slice(0).to_vec(),
            answer.col_as_slice(0).to_vec(),
        );
        let each = points.iter();
        let held: f64 = each
            .map(|point| point.weight * point.weight * point.growth)
            .sum();
        Some(Tangent {
            stiffness: held - dot(&by_delta, &answer),
            factor,
            by_delta,
            answer,
        })
    }

    /// The balance at its last iterate.
    fn balanced(
        self,
        (state, points): (State, Vec<Point>),
        tangent: Tangent,
        h: &Mat<f64>,
        iterations: u32,
    ) -> Balance {
        let size = self.slices.len();
        let forces = in_middles(&points, size, |point| point.force);
        let opened_by_delta = product(self.lower.as_ref(), &tangent.answer);
        let grown = |point: &Point| {
            let opened = point.at(&opened_by_delta);
            point.growth * (point.weight - opened) / tangent.stiffness
        };
        let mut carried = vec![
            Carried {
                part: [1.0, -1.0],
                ..Carried::default()
            };
            size
        ];
        for point in &points {
            let of = &mut carried[point.slice];
            of.force += point.force;
            of.rise += grown(point);
            of.weighed += point.weight * point.force;
        }
        let mut gaps = Vec::with_capacity(size);
        for (i, carried) in carried.iter_mut().enumerate() {
            gaps.push(-self.depths(&state, i, 0)[0]);
            for (end, sign) in SIDES.into_iter().enumerate() {
                let [middle, outer] = self.depths(&state, i, end);
                let [low, high] = &mut carried.part;
                for place in loaded_part(middle, outer).into_iter().flatten() {
                    (*low, *high) = (low.min(sign * place), high.max(sign * place));
                }
            }
        }
        let opened = product(h.as_ref(), &forces);
        // Where a slice carries, forces and their openings are to be the same.
        for (i, carried) in carried.iter().enumerate() {
            if carried.force > 0.0 {
                gaps[i] = opened[i] - state.opened[i];
            }
        }
        let without_springs = self.slices.iter().zip(&opened);
        Balance {
            without_springs: without_springs
                .map(|(slice, opened)| {
                    slice.middle.gap + opened - state.delta * slice.middle.weights[1]
                })
                .collect(),
            heaviest: (self.slices.iter().zip(&carried))
                .filter(|(_, carried)| carried.force > 0.0)
                .map(|(slice, carried)| {
                    let long = 0.5 * (carried.part[1] - carried.part[0]) * slice.along;
                    carried.force / long
                })
                .fold(0.0, f64::max),
            load_derivative: in_middles(&points, size, grown),
            carried,
            forces,
            gaps,
            transmission_error: state.delta,
            stiffness: tangent.stiffness,
            iterations,
            opened: state.opened,
            points,
            tangent,
            lower: self.lower,
        }
    }
}

impl Point {
    /// Values in the middles of the slices, interpolated to this point.
    fn at(&self, middles: &[f64]) -> f64 {
        (1.0 - self.share) * middles[self.slice] + self.share * middles[self.beside]
    }
}

impl Balance {
    /// From where a balance is looked for that is about this one.
    pub(super) fn start(&self) -> Start {
        Start {
            forces: self.forces.clone(),
            opened: self.opened.clone(),
            transmission_error: self.transmission_error,
        }
    }

    /// How fast the force on each slice grows as its flanks are pressed together, in N/m.
    pub(super) fn growth(&self) -> Vec<f64> {
        in_middles(&self.points, self.forces.len(), |point| point.growth)
    }

    /// How far flanks are pressed together at a place of slice `i`, whose line is blurred by `blur`.
    pub(super) fn depth(&self, slices: &[Slice], i: usize, within: &Within, blur: f64) -> f64 {
        let (end, place) = (usize::from(within.at > 0.0), within.at.abs());
        let Beside { slice, share } = Beside::of(slices, i, end);
        let share = if is_line_end(slices, i, end) && slice != i {
            let along = slices[i].along;
            share_near_end(along / blur, 0.5 * (1.0 - place) * along / blur)
        } else {
            share * place
        };
        let opened = (1.0 - share) * self.opened[i] + share * self.opened[slice];
        self.transmission_error * within.place.weights[1] - within.place.gap - opened
    }

    /// Change of each slice's load where gaps open by these amounts, in the middle of each and at both of its ends, under the same load.
    pub(super) fn change(&self, opened: &[[f64; 3]]) -> Vec<f64> {
        let size = opened.len();
        let gap = |point: &Point| {
            let [begin, middle, end] = opened[point.slice];
            let outer = [begin, end][point.end];
            middle + (outer - middle) * point.place
        };
        let lost = in_middles(&self.points, size, |point| point.growth * gap(point));
        let mut way = self.lower.transpose() * column(&lost);
        self.tangent.factor.solve_in_place(way.as_mut());
        let each = self.points.iter();
        let unloaded: f64 = each
            .map(|point| point.weight * point.growth * gap(point))
            .sum();
        let by_way = dot(&self.tangent.by_delta, way.col_as_slice(0));
        let delta = (unloaded - by_way) / self.stiffness;
        let way: Vec<f64> = (way.col_as_slice(0).iter().zip(&self.tangent.answer))
            .map(|(way, answer)| delta * answer - way)
            .collect();
        let moved = product(self.lower.as_ref(), &way);
        let mut changes = vec![0.0; size];
        for point in &self.points {
            let pressed = delta * point.weight - gap(point) - point.at(&moved);
            changes[point.slice] += point.weight * point.growth * pressed;
        }
        changes
    }
}

/// From where to where half a slice is loaded whose flanks are pressed so far together in the middle of the slice (0) and at its end (1).
fn loaded_part(middle: f64, outer: f64) -> Option<[f64; 2]> {
    let turn = middle / (middle - outer);
    match (middle > 0.0, outer > 0.0) {
        (true, true) => Some([0.0, 1.0]),
        (true, false) => Some([0.0, turn]),
        (false, true) => Some([turn, 1.0]),
        (false, false) => None,
    }
}

/// Half by half, the other slice of the same line by whose middle values are continued from the middle of a slice (0) to one of its ends (1).
#[derive(Clone, Copy)]
struct Beside {
    slice: usize,
    /// The weight of its middle at that end.
    share: f64,
}

/// The weight that continues a parabola, even about the end of a line, from the middles of its last two slices to that end: −1/8. Contact lines have their
/// images there.
const EVEN_BEYOND: f64 = -0.125;

impl Beside {
    /// The neighbor of slice `i` towards its beginning (0) or its `end` (1); at an end of the line the one on the other side.
    fn of(slices: &[Slice], i: usize, end: usize) -> Self {
        match (neighbor(slices, i, end), neighbor(slices, i, 1 - end)) {
            (Some(slice), _) => Self { slice, share: 0.5 },
            (None, Some(slice)) => Self {
                slice,
                share: EVEN_BEYOND,
            },
            (None, None) => Self {
                slice: i,
                share: 0.0,
            },
        }
    }

    /// `middles`, continued to the end of slice `i`.
    fn at_end(self, middles: &[f64], i: usize) -> f64 {
        (1.0 - self.share) * middles[i] + self.share * middles[self.slice]
    }
}

/// The slice of the same line before slice `i` (0) or behind its `end` (1).
fn neighbor(slices: &[Slice], i: usize, end: usize) -> Option<usize> {
    let slice = &slices[i];
    let other = if end == 0 {
        i.checked_sub(1)
    } else {
        Some(i + 1)
    };
    other.filter(|other| {
        slices.get(*other).is_some_and(|other| {
            let apart = (other.z - slice.z).abs();
            other.pair == slice.pair && apart < 1.5 * slice.length
        })
    })
}

/// True if the line of slice `i` ends at its beginning (0) or at its `end` (1).
pub(super) fn is_line_end(slices: &[Slice], i: usize, end: usize) -> bool {
    neighbor(slices, i, end).is_none()
}

/// The weight of the second slice from the end of a line in the yield at a distance from that end, less than half a slice, that of the last one having the rest.
/// Slices and the distance are given over the blur ρ_0 of the line.
///
/// A load that falls linearly from the end, and is even about it, opens the line by x asinh x − √(1 + x²) + 1 less than at the end, in K q'ρ_0.
fn share_near_end(slice: f64, distance: f64) -> f64 {
    let less = |x: f64| x * x.asinh() - x.hypot(1.0) + 1.0;
    let integral = |x: f64| (0.5 * x * x - 0.25) * x.asinh() + (1.0 - 0.75 * x.hypot(1.0)) * x;
    let last = integral(slice) / slice;
    let second = integral(2.0 * slice) / slice - last;
    (less(distance) - last) / (second - last)
}

/// `of` each point, summed up in the middles of so many slices by the weights of interpolation.
fn in_middles(points: &[Point], slices: usize, of: impl Fn(&Point) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; slices];
    for point in points {
        let value = of(point);
        sums[point.slice] += (1.0 - point.share) * value;
        sums[point.beside] += point.share * value;
    }
    sums
}

fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}

fn product(h: MatRef<'_, f64>, values: &[f64]) -> Vec<f64> {
    let moved = h * column(values);
    moved.col_as_slice(0).to_vec()
}

impl Balance {
    /// The largest penetration in the middle of each of `slices`, and between each two of one of their `lines`.
    pub(super) fn penetration(&self, slices: &[Slice], lines: &[BlurredLine]) -> f64 {
        let inside = self.gaps.iter().fold(0.0, |most: f64, gap| most.max(-gap));
        (lines.iter())
            .flat_map(|line| (1..line.range().len()).map(move |i| (line, i)))
            .map(|(line, i)| -self.gap_before(slices, line, i))
            .fold(inside, f64::max)
    }

    /// The gap between slice `i` of a `line` and the one before it.
    fn gap_before(&self, slices: &[Slice], line: &BlurredLine, i: usize) -> f64 {
        let forces = || self.forces[line.range()].iter().enumerate();
        let start = line.range().start;
        // The smooth part is interpolated between both middles; the half space is taken there.
        let of_middle = |at: usize| {
            let moved: f64 = forces().map(|(k, n)| n * line.in_the_mean(at, k)).sum();
            let slice = &slices[start + at];
            let closed = slice
                .middle
                .spring
                .closing(self.forces[start + at] / slice.along);
            self.without_springs[start + at] - moved + closed
        };
        let moved: f64 = forces().map(|(k, n)| n * line.ahead(i - 1, k)).sum();
        0.5 * (of_middle(i - 1) + of_middle(i)) + moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flank::images::twice_inverse;

    #[test]
    fn the_yield_near_the_end_of_a_line_is_that_of_a_load_that_falls_from_it() {
        // The load R − |y|, with R far beyond the slices, opens a line by the second difference of the double integral of 1/√(x² + 1).
        const R: f64 = 1e5;
        const PARTS: u32 = 4000;
        let opened = |x: f64| {
            let [before, here, after] = [x - R, x, x + R].map(|x| twice_inverse(x, 1.0));
            after - 2.0 * here + before
        };
        let mean = |from: f64, length: f64| {
            let part = |i| length * (f64::from(i) + 0.5) / f64::from(PARTS);
            (0..PARTS).map(|i| opened(from + part(i))).sum::<f64>() / f64::from(PARTS)
        };
        for slice in [0.5, 1.0, 4.0, 10.0] {
            let (last, second) = (mean(0.0, slice), mean(slice, slice));
            for part in [0.0, 0.2, 0.5] {
                let distance = part * slice;
                let share = share_near_end(slice, distance);
                let found = (1.0 - share) * last + share * second;
                let expected = opened(distance);
                let wrong = (found - expected).abs();
                assert!(wrong < 1e-3 * (last - second), "{slice} {part}: {wrong}");
            }
        }
    }
}
