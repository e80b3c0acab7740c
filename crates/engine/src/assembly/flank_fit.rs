//! Fit of polynomials to a flank's compliance between nodes.

use faer::traits::ComplexField;
use faer::{Mat, Side};

use crate::fem::axial::AxialBasis;
use crate::fem::dense::symmetrize;
use crate::flank::half_space::HalfSpace;
use crate::flank::polynomials::{OTHER_DEGREE, OWN_DEGREE, projecting};
use crate::gear::SolidGear;
use crate::quadrature::{gauss_legendre, parabola};

/// Fit of polynomials to values at the nodes of a flank: the nearest to the grid's interpolation between its nodes, in the mean along the flank. Loads are
/// converted in the same way, so that the grid's response to loads on single nodes does not count.
pub(super) struct FlankFit<'a> {
    gear: &'a SolidGear,
    pub(super) axial: &'a AxialBasis,
    roll_lengths: &'a [f64],
    pub(super) squares: [f64; 2],
}

impl<'a> FlankFit<'a> {
    /// On a flank with nodes at the ends and in the middle of each of its elements.
    pub(super) fn new(gear: &'a SolidGear, axial: &'a AxialBasis, roll_lengths: &'a [f64]) -> Self {
        Self {
            gear,
            axial,
            roll_lengths,
            squares: squares(roll_lengths),
        }
    }

    /// The compliance of one flank under its own loads on the polynomials, less the half space: `held` is given node by node, `more` of it on the polynomials
    /// already.
    ///
    /// A free end is softer than images make it, and a tooth softer than both. Under loads that vary along the axis faster than the grid resolves, the rest would
    /// be negative; its negative part is left out.
    pub(super) fn own(&self, held: &Mat<f64>, more: Option<&Mat<f64>>) -> Mat<f64> {
        let space = HalfSpace::new(self.gear, self.axial);
        let mut own = smoothed(&self.nearest(), held, self.axial.len());
        if let Some(more) = more {
            own += more;
        }
        own -= space.over_flank(self.squares, OWN_DEGREE);
        symmetrize(&mut own);
        own += missing(&own, &self.axial.even());
        own
    }

    /// `rows` of all the polynomials, those above [`OTHER_DEGREE`] empty.
    pub(super) fn without_highest<T: ComplexField>(&self, mut rows: Mat<T>) -> Mat<T> {
        let first = (OTHER_DEGREE + 1) * self.axial.len();
        let highest = rows.nrows() - first;
        rows.subrows_mut(first, highest)
            .fill(faer::traits::math_utils::zero());
        rows
    }

    /// The polynomials nearest to values at the nodes, a row each: the mean along the flank of each with the interpolation of a node's value, a parabola over
    /// an element.
    pub(super) fn nearest(&self) -> Mat<f64> {
        let mut nearest = Mat::zeros(OWN_DEGREE + 1, self.roll_lengths.len());
        let [from, to] = self.squares;
        let rule = gauss_legendre(OWN_DEGREE / 2 + 2);
        for (i, nodes) in self.roll_lengths.windows(3).enumerate().step_by(2) {
            // Arcs of an involute go with the square of the roll length.
            let arcs = [0, 1, 2].map(|i| (nodes[i].powi(2) - from) / (to - from));
            let [a, _, c] = arcs;
            for (x, w) in &rule {
                let at = f64::midpoint(a, c) + 0.5 * (c - a) * x;
                let shapes = parabola(arcs, at);
                let roll_length = (from + at * (to - from)).sqrt();
                let values = projecting(self.squares, roll_length, OWN_DEGREE);
                for (row, value) in values.into_iter().enumerate() {
                    for (node, shape) in shapes.into_iter().enumerate() {
                        nearest[(row, i + node)] += 0.5 * (c - a) * w * value * shape;
                    }
                }
            }
        }
        nearest
    }
}

/// The part of a compliance `h` between functions that have no mean along the axis, below zero and with the other sign; the mean of each function there is in
/// proportion to `even`.
fn missing(h: &Mat<f64>, even: &[f64]) -> Mat<f64> {
    let m = even.len();
    // The squares of the functions, in the mean up the flank.
    let scale = |i: usize| ((2 * (i / m) + 1) as f64).sqrt();
    let square: f64 = even.iter().map(|mean| mean * mean).sum();
    let part = Mat::from_fn(h.nrows(), h.nrows(), |i, j| {
        let same = if i == j { 1.0 } else { 0.0 };
        if i / m == j / m {
            (same - even[i % m] * even[j % m] / square) / scale(i)
        } else {
            0.0
        }
    });
    let varying = &part * h * &part;
    let Ok(eigen) = varying.self_adjoint_eigen(Side::Lower) else {
        return Mat::zeros(h.nrows(), h.nrows());
    };
    let (values, vectors) = (eigen.S(), eigen.U());
    let scaled = |i: usize, k: usize| scale(i) * vectors[(i, k)];
    let below = Mat::from_fn(h.nrows(), values.dim(), |i, k| {
        scaled(i, k) * (-values[k]).max(0.0)
    });
    below * Mat::from_fn(values.dim(), h.nrows(), |k, i| scaled(i, k))
}

/// The squares of the first and of the last of `roll_lengths`.
pub(super) fn squares(roll_lengths: &[f64]) -> [f64; 2] {
    [roll_lengths[0], roll_lengths[roll_lengths.len() - 1]].map(|s| s * s)
}

/// Q g Qᵀ, with Q the same for each of `m` functions along the axis.
fn smoothed(smoothing: &Mat<f64>, g: &Mat<f64>, m: usize) -> Mat<f64> {
    let once = smoothed_rows(smoothing, g, m);
    smoothed_rows(smoothing, &once.transpose().to_owned(), m)
        .transpose()
        .to_owned()
}

/// Q g, of real or complex columns.
pub(super) fn smoothed_rows<T>(smoothing: &Mat<f64>, g: &Mat<T>, m: usize) -> Mat<T>
where
    T: ComplexField + Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign,
{
    let mut rows = Mat::zeros(smoothing.nrows() * m, g.ncols());
    for j in 0..g.ncols() {
        for node in 0..smoothing.ncols() {
            for a in 0..smoothing.nrows() {
                let share = smoothing[(a, node)];
                for p in 0..m {
                    rows[(a * m + p, j)] += g[(node * m + p, j)] * share;
                }
            }
        }
    }
    rows
}
