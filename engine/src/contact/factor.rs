//! The Cholesky factor of the compliance of the points that touch.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::{Mat, Par};

/// L of H_A = L Lᵀ: its columns from the diagonal down, one after the other, with 1/L_jj on the diagonal.
#[derive(Debug)]
pub(super) struct Factor {
    size: usize,
    entries: Vec<f64>,
}

impl Factor {
    /// That of the points `set` of `compliance`, the rising; `None` where that is not positive definite.
    pub(super) fn new(compliance: &Mat<f64>, set: &[usize]) -> Option<Self> {
        let size = set.len();
        let mut factor = Mat::<f64>::zeros(size, size);
        for (column, &j) in set.iter().enumerate() {
            let h = compliance.col_as_slice(j);
            for (entry, &i) in factor.col_as_slice_mut(column)[column..]
                .iter_mut()
                .zip(&set[column..])
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
        Some(Self { size, entries })
    }

    /// Puts H_A⁻¹ times each of `right_sides` in its place.
    pub(super) fn solve(&self, right_sides: [&mut [f64]; 2]) {
        let [x, y] = right_sides;
        let mut columns = self.entries.as_slice();
        for j in 0..self.size {
            let (column, rest) = columns.split_at(self.size - j);
            columns = rest;
            let (x_here, x_below) = x[j..].split_at_mut(1);
            let (y_here, y_below) = y[j..].split_at_mut(1);
            x_here[0] *= column[0];
            y_here[0] *= column[0];
            subtract(x_below, y_below, &column[1..], x_here[0], y_here[0]);
        }
        let mut columns = self.entries.as_slice();
        for j in (0..self.size).rev() {
            let (rest, column) = columns.split_at(columns.len() - (self.size - j));
            columns = rest;
            for side in [&mut *x, &mut *y] {
                let (here, below) = side[j..].split_at_mut(1);
                here[0] = (here[0] - dot(&column[1..], below)) * column[0];
            }
        }
    }

    /// How much memory it takes beside itself, in bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }
}

/// Takes `column` times one factor each from `x` and `y`.
fn subtract(x: &mut [f64], y: &mut [f64], column: &[f64], by_x: f64, by_y: f64) {
    for ((x, y), entry) in x.iter_mut().zip(y).zip(column) {
        *x -= entry * by_x;
        *y -= entry * by_y;
    }
}

/// Sums of several products at once, in an order that is the same on every machine.
fn dot(one: &[f64], other: &[f64]) -> f64 {
    const LANES: usize = 8;
    let (ones, others) = (one.chunks_exact(LANES), other.chunks_exact(LANES));
    let rest = ones.remainder().iter().zip(others.remainder());
    let rest: f64 = rest.map(|(one, other)| one * other).sum();
    let mut sums = [0.0; LANES];
    for (one, other) in ones.zip(others) {
        for ((sum, one), other) in sums.iter_mut().zip(one).zip(other) {
            *sum += one * other;
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_times_the_matrix_is_the_right_side() {
        for size in [1, 2, 7, 8, 9, 33] {
            let compliance = Mat::from_fn(size + 3, size + 3, |i, j| {
                (-0.3 * i.abs_diff(j) as f64).exp() + if i == j { 0.1 } else { 0.0 }
            });
            let set: Vec<usize> = (0..size).map(|i| i + usize::from(i > 2)).collect();
            let factor = Factor::new(&compliance, &set).expect("positive definite");
            let sides = [0.3, 1.7]
                .map(|k: f64| -> Vec<f64> { (0..size).map(|i| (k * i as f64).cos()).collect() });
            let [mut x, mut y] = sides.clone();
            factor.solve([&mut x, &mut y]);
            for (solution, side) in [x, y].iter().zip(&sides) {
                for (row, wanted) in set.iter().zip(side) {
                    let each = set.iter().zip(solution);
                    let found: f64 = each.map(|(j, x)| compliance[(*row, *j)] * x).sum();
                    assert!((found - wanted).abs() < 1e-13, "{size}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_has_none() {
        let compliance = Mat::from_fn(2, 2, |_, _| 1.0);
        assert!(Factor::new(&compliance, &[0, 1]).is_none());
        assert!(Factor::new(&compliance, &[1]).is_some());
    }
}
