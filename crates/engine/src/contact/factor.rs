//! The Cholesky factor of the compliance of the points that touch, most of it kept from sets that differ at their ends.
//!
//! A set is given as its core, all blocks of [`BLOCK`] points that it contains whole, and the points beside. The factor of a core and the contribution of each
//! point beside are computed once. The result depends on the set alone, whatever was stored.

use std::sync::{Arc, OnceLock};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::{Mat, Par};

use crate::wide::{Loops, wide};

/// Points that enter and leave a core together.
const BLOCK: usize = 4;

/// The factor of a core, and the entries of each point beside below it.
#[derive(Debug)]
pub(super) struct Core {
    points: Vec<usize>,
    factor: Lower,
    /// L⁻¹ H of the core and each point of the compliance.
    beside: Vec<OnceLock<Vec<f64>>>,
}

/// The factor of a set.
#[derive(Debug)]
pub(super) struct Factor {
    core: Arc<Option<Core>>,
    /// The places in the set of the points of the core, and of those beside.
    places: [Vec<usize>; 2],
    /// The points beside.
    points: Vec<usize>,
    factor: Lower,
}

/// A lower triangle: its columns from the diagonal down, one after the other, with 1/L_jj on the diagonal.
#[derive(Debug, Default)]
struct Lower {
    size: usize,
    entries: Vec<f64>,
}

/// The core of the rising points `set`, block by block of the compliance's points.
pub(super) fn core_of(set: &[usize]) -> Vec<usize> {
    let mut blocks = Vec::with_capacity(set.len() / BLOCK);
    let mut first = 0;
    while first + BLOCK <= set.len() {
        let point = set[first];
        if point.is_multiple_of(BLOCK) && set[first + BLOCK - 1] == point + BLOCK - 1 {
            blocks.push(point / BLOCK);
            first += BLOCK;
        } else {
            first += 1;
        }
    }
    blocks
}

impl Core {
    /// Factor of the `blocks` of `compliance`; `None` where it is not positive definite.
    pub(super) fn new(compliance: &Mat<f64>, blocks: &[usize]) -> Option<Self> {
        let points = blocks
            .iter()
            .flat_map(|block| BLOCK * block..BLOCK * (block + 1));
        let points: Vec<usize> = points.collect();
        let size = points.len();
        let mut factor = Mat::<f64>::zeros(size, size);
        for (column, &j) in points.iter().enumerate() {
            let h = compliance.col_as_slice(j);
            for (entry, &i) in factor.col_as_slice_mut(column)[column..]
                .iter_mut()
                .zip(&points[column..])
            {
                *entry = h[i];
            }
        }
        let par = Par::Seq;
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(size, par, Default::default());
        let mut memory = MemBuffer::new(scratch);
        llt::factor::cholesky_in_place(
            factor.as_mut(),
            Default::default(),
            par,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .ok()?;
        let mut entries = Vec::with_capacity(size * (size + 1) / 2);
        for j in 0..size {
            let column = &factor.col_as_slice(j)[j..];
            entries.push(column[0].recip());
            entries.extend_from_slice(&column[1..]);
        }
        Some(Self {
            points,
            factor: Lower { size, entries },
            beside: std::iter::repeat_with(OnceLock::new)
                .take(compliance.nrows())
                .collect(),
        })
    }

    /// Largest memory that it can take beside itself, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let beside = self.beside.len() - self.points.len();
        size_of::<f64>() * (self.factor.entries.len() + self.points.len() * (1 + beside))
            + size_of::<OnceLock<Vec<f64>>>() * self.beside.len()
    }

    fn beside(&self, compliance: &Mat<f64>, point: usize) -> &[f64] {
        self.beside[point].get_or_init(|| {
            let column = compliance.col_as_slice(point);
            let mut below: Vec<f64> = self.points.iter().map(|i| column[*i]).collect();
            self.factor.solve(&mut below);
            below
        })
    }
}

impl Factor {
    /// Factor of the rising points `set` of `compliance`, of which `core` is the core; `None` where it is not positive definite.
    pub(super) fn new(
        compliance: &Mat<f64>,
        set: &[usize],
        core: Arc<Option<Core>>,
    ) -> Option<Self> {
        let known = Option::as_ref(&core)?;
        let mut places = [Vec::with_capacity(known.points.len()), Vec::new()];
        let mut points = Vec::new();
        for (place, &point) in set.iter().enumerate() {
            if known.points.get(places[0].len()) == Some(&point) {
                places[0].push(place);
            } else {
                places[1].push(place);
                points.push(point);
            }
        }
        let beside: Vec<&[f64]> = points
            .iter()
            .map(|&point| known.beside(compliance, point))
            .collect();
        let factor = wide(Rest {
            compliance,
            points: &points,
            beside: &beside,
        })?;
        Some(Self {
            places,
            points,
            factor,
            core,
        })
    }

    /// Puts H_A⁻¹ times each of `right_sides` in its place.
    pub(super) fn solve(&self, right_sides: [&mut [f64]; 2]) {
        let Some(core) = Option::as_ref(&self.core) else {
            return;
        };
        let beside = self.points.iter().map(|point| core.beside[*point].get());
        let beside: Vec<&[f64]> = beside.flatten().map(Vec::as_slice).collect();
        let [in_core, others] = &self.places;
        let sides = right_sides.each_ref();
        let picked = |places: &[usize]| {
            sides.map(|side| -> Vec<f64> { places.iter().map(|place| side[*place]).collect() })
        };
        let ([mut x, mut y], [mut u, mut v]) = (picked(in_core), picked(others));
        wide(Substitution {
            factors: [&core.factor, &self.factor],
            beside: &beside,
            in_core: [&mut x, &mut y],
            others: [&mut u, &mut v],
        });
        for (side, (core, others)) in right_sides.into_iter().zip([(x, u), (y, v)]) {
            for (place, value) in in_core.iter().zip(core) {
                side[*place] = value;
            }
            for (place, value) in self.places[1].iter().zip(others) {
                side[*place] = value;
            }
        }
    }
}

/// The factor of the Schur complement of the points beside a core.
struct Rest<'a> {
    compliance: &'a Mat<f64>,
    points: &'a [usize],
    beside: &'a [&'a [f64]],
}

impl Loops for Rest<'_> {
    type Output = Option<Lower>;

    #[inline(always)]
    fn call(self) -> Option<Lower> {
        let (points, beside) = (self.points, self.beside);
        let size = points.len();
        let mut lower = Vec::with_capacity(size * (size + 1) / 2);
        for j in 0..size {
            let column = self.compliance.col_as_slice(points[j]);
            for i in j..size {
                lower.push(column[points[i]] - dot(beside[i], beside[j]));
            }
        }
        Lower::of(size, lower)
    }
}

/// The substitutions forth and back with the factors of a core and of the points beside.
struct Substitution<'a> {
    factors: [&'a Lower; 2],
    beside: &'a [&'a [f64]],
    in_core: [&'a mut [f64]; 2],
    others: [&'a mut [f64]; 2],
}

impl Loops for Substitution<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let ([core, own], beside) = (self.factors, self.beside);
        let ([x, y], [u, v]) = (self.in_core, self.others);
        core.solve_both(x, y);
        for ((u, v), beside) in u.iter_mut().zip(&mut *v).zip(beside) {
            let [by_x, by_y] = dots(beside, [x, y]);
            *u -= by_x;
            *v -= by_y;
        }
        own.solve_both(u, v);
        own.solve_both_transposed(u, v);
        for ((u, v), beside) in u.iter().zip(&*v).zip(beside) {
            subtract(x, y, beside, *u, *v);
        }
        core.solve_both_transposed(x, y);
    }
}

impl Lower {
    /// The factor of the matrix whose `lower` triangle stands column by column; `None` where it is not positive definite.
    #[inline(always)]
    fn of(size: usize, mut lower: Vec<f64>) -> Option<Self> {
        let mut rest = lower.as_mut_slice();
        for j in 0..size {
            let (column, after) = rest.split_at_mut(size - j);
            if !(column[0] > 0.0 && column[0].is_finite()) {
                return None;
            }
            let scale = column[0].sqrt().recip();
            column[0] = scale;
            for entry in &mut column[1..] {
                *entry *= scale;
            }
            let mut others = &mut *after;
            for k in 1..column.len() {
                let (other, next) = others.split_at_mut(column.len() - k);
                let by = column[k];
                for (other, entry) in other.iter_mut().zip(&column[k..]) {
                    *other -= by * entry;
                }
                others = next;
            }
            rest = after;
        }
        Some(Self {
            size,
            entries: lower,
        })
    }

    fn columns(&self) -> impl DoubleEndedIterator<Item = (usize, &[f64])> {
        let start = |j: usize| j * self.size - j * j.saturating_sub(1) / 2;
        (0..self.size).map(move |j| (j, &self.entries[start(j)..start(j) + self.size - j]))
    }

    /// L⁻¹ x in the place of x.
    #[inline(always)]
    fn solve(&self, x: &mut [f64]) {
        for (j, column) in self.columns() {
            let (here, below) = x[j..].split_at_mut(1);
            here[0] *= column[0];
            for (below, entry) in below.iter_mut().zip(&column[1..]) {
                *below -= entry * here[0];
            }
        }
    }

    /// The same of two at once.
    #[inline(always)]
    fn solve_both(&self, x: &mut [f64], y: &mut [f64]) {
        for (j, column) in self.columns() {
            let (x, x_below) = x[j..].split_at_mut(1);
            let (y, y_below) = y[j..].split_at_mut(1);
            x[0] *= column[0];
            y[0] *= column[0];
            subtract(x_below, y_below, &column[1..], x[0], y[0]);
        }
    }

    /// L⁻ᵀ x in the place of x, of two at once.
    #[inline(always)]
    fn solve_both_transposed(&self, x: &mut [f64], y: &mut [f64]) {
        for (j, column) in self.columns().rev() {
            let (x, x_below) = x[j..].split_at_mut(1);
            let (y, y_below) = y[j..].split_at_mut(1);
            let [by_x, by_y] = dots(&column[1..], [x_below, y_below]);
            x[0] = (x[0] - by_x) * column[0];
            y[0] = (y[0] - by_y) * column[0];
        }
    }
}

/// Adds `by` times `column` to `x`.
#[inline(always)]
pub(super) fn add(x: &mut [f64], column: &[f64], by: f64) {
    for (x, entry) in x.iter_mut().zip(column) {
        *x += by * entry;
    }
}

/// Takes `column` times one factor each from `x` and `y`.
#[inline(always)]
fn subtract(x: &mut [f64], y: &mut [f64], column: &[f64], by_x: f64, by_y: f64) {
    for ((x, y), entry) in x.iter_mut().zip(y).zip(column) {
        *x -= entry * by_x;
        *y -= entry * by_y;
    }
}

/// The sum of products, several of them at once, in an order that is the same on every machine.
#[inline(always)]
pub(super) fn dot(one: &[f64], other: &[f64]) -> f64 {
    let [sum] = dots(one, [other]);
    sum
}

/// [`dot`] of `one` and each of `others`, which are as long.
#[inline(always)]
fn dots<const N: usize>(one: &[f64], others: [&[f64]; N]) -> [f64; N] {
    const LANES: usize = 8;
    let (ones, rest) = one.as_chunks::<LANES>();
    let others = others.map(|other| other[..one.len()].as_chunks::<LANES>());
    let mut sums = [[0.0; LANES]; N];
    for (i, one) in ones.iter().enumerate() {
        for (sums, (other, _)) in sums.iter_mut().zip(&others) {
            for ((sum, one), other) in sums.iter_mut().zip(one).zip(&other[i]) {
                *sum += one * other;
            }
        }
    }
    let mut totals = [0.0; N];
    for (total, (sums, (_, other))) in totals.iter_mut().zip(sums.iter().zip(&others)) {
        let rest: f64 = rest
            .iter()
            .zip(*other)
            .map(|(one, other)| one * other)
            .sum();
        *total = sums.iter().sum::<f64>() + rest;
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(compliance: &Mat<f64>, set: &[usize]) -> Option<Factor> {
        let core = Core::new(compliance, &core_of(set));
        Factor::new(compliance, set, Arc::new(core))
    }

    #[test]
    fn a_core_is_the_whole_blocks() {
        assert_eq!(core_of(&[1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 15]), [1, 3]);
        assert_eq!(core_of(&[0, 1, 2, 4, 5, 6]), [0; 0]);
    }

    #[test]
    fn a_solution_times_the_matrix_is_the_right_side() {
        for size in [1, 2, 7, 8, 9, 33] {
            for skipped in [0, 2, 5] {
                let compliance = Mat::from_fn(size + 3, size + 3, |i, j| {
                    (-0.3 * i.abs_diff(j) as f64).exp() + if i == j { 0.1 } else { 0.0 }
                });
                let set: Vec<usize> = (0..size).map(|i| i + usize::from(i >= skipped)).collect();
                let factor = factor(&compliance, &set).expect("positive definite");
                let sides = [0.3, 1.7].map(|k: f64| -> Vec<f64> {
                    (0..size).map(|i| (k * i as f64).cos()).collect()
                });
                let [mut x, mut y] = sides.clone();
                factor.solve([&mut x, &mut y]);
                for (solution, side) in [x, y].iter().zip(&sides) {
                    for (row, expected) in set.iter().zip(side) {
                        let each = set.iter().zip(solution);
                        let found: f64 = each.map(|(j, x)| compliance[(*row, *j)] * x).sum();
                        assert!(
                            (found - expected).abs() < 1e-13,
                            "{size}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_none() {
        let compliance = Mat::from_fn(8, 8, |_, _| 1.0);
        assert!(factor(&compliance, &[0, 1]).is_none());
        assert!(factor(&compliance, &[0, 1, 2, 3]).is_none());
        assert!(factor(&compliance, &[1]).is_some());
    }

    #[test]
    fn wide_vectors_change_no_digit() {
        for count in [1, 7, 8, 40, 111] {
            let [one, other] = [0.3, 1.7].map(|k: f64| -> Vec<f64> {
                (0..count).map(|i| (k * f64::from(i)).cos()).collect()
            });
            let wide = wide(|| dot(&one, &other));
            assert_eq!(wide.to_bits(), dot(&one, &other).to_bits(), "{count}");
        }
    }
}
