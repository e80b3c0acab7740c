//! Trigonometric polynomials on an interface circle, with real unknowns.

use faer::{Mat, MatRef, c64};

/// The harmonics of orders −M … M on an interface circle, with real unknowns.
///
/// The unknowns are, for each component (radial, then tangential within an order): a_0, then a_n and b_n of
/// a_n cos nθ + b_n sin nθ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Harmonics {
    /// The largest order M.
    pub largest: usize,
}

/// A component of a displacement or a force on the interface circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// Along e_r.
    Radial,
    /// Along e_t.
    Tangential,
}

impl Harmonics {
    /// The number 2 (2M + 1) of real unknowns.
    pub fn unknowns(&self) -> usize {
        2 * (2 * self.largest + 1)
    }

    /// Where the cosine of order `n` of a component stands; the sine, for n > 0, is two places later.
    pub fn cosine(&self, n: usize, component: Component) -> usize {
        let place = if n == 0 { 0 } else { 2 * (2 * n - 1) };
        place + usize::from(component == Component::Tangential)
    }

    /// The order that an unknown belongs to.
    pub fn order(&self, unknown: usize) -> usize {
        (unknown + 2) / 4
    }

    /// True if an unknown is an a_n with n > 0, whose b_n stands two places later.
    pub fn is_cosine(&self, unknown: usize) -> bool {
        unknown >= 2 && unknown % 4 >= 2
    }

    /// The unknowns of `orders`, order by order.
    pub fn unknowns_of(&self, orders: &[usize]) -> Vec<usize> {
        let of_order = |&n: &usize| {
            let first = self.cosine(n, Component::Radial);
            first..first + if n == 0 { 2 } else { 4 }
        };
        orders.iter().flat_map(of_order).collect()
    }

    /// The orders 0 … M in groups that meet in a body which repeats itself `repeats` times around: those whose sum or
    /// difference is a multiple of it.
    pub fn meeting_orders(&self, repeats: usize) -> Vec<Vec<usize>> {
        let group = |class: usize| -> Vec<usize> {
            (0..=self.largest)
                .filter(|n| (n % repeats).min(repeats - n % repeats) == class)
                .collect()
        };
        let groups = (0..=repeats / 2).map(group);
        groups.filter(|orders| !orders.is_empty()).collect()
    }

    /// The orders n in −M … M with n ≡ `class` (mod `sectors`).
    pub fn orders_of_class(&self, class: usize, sectors: usize) -> Vec<i64> {
        let (m, s) = (self.largest as i64, sectors as i64);
        let first = -m + (class as i64 + m).rem_euclid(s);
        (0..)
            .map(|k| first + k * s)
            .take_while(|&n| n <= m)
            .collect()
    }

    /// The polar displacements of nodes at `angles` on the circle for unit unknowns: (u_r, u_t) of each node.
    pub fn on_circle(&self, angles: &[f64]) -> Mat<f64> {
        let mut e = Mat::zeros(2 * angles.len(), self.unknowns());
        for (node, angle) in angles.iter().enumerate() {
            for n in 0..=self.largest {
                let (sin, cos) = (n as f64 * angle).sin_cos();
                for (c, component) in [Component::Radial, Component::Tangential]
                    .into_iter()
                    .enumerate()
                {
                    let cosine = self.cosine(n, component);
                    e[(2 * node + c, cosine)] = cos;
                    if n > 0 {
                        e[(2 * node + c, cosine + 2)] = sin;
                    }
                }
            }
        }
        e
    }

    /// The amplitudes `q` of a circle as they are seen from a frame turned by `angle` counter-clockwise.
    pub fn turned(&self, q: &[f64], angle: f64) -> Vec<f64> {
        let mut turned = q.to_vec();
        for i in (0..q.len()).filter(|&i| self.is_cosine(i)) {
            // cos n(θ + α) and sin n(θ + α) by those of nθ.
            let (sin, cos) = (self.order(i) as f64 * angle).sin_cos();
            turned[i] = cos * q[i] + sin * q[i + 2];
            turned[i + 2] = cos * q[i + 2] - sin * q[i];
        }
        turned
    }

    /// The rows of `columns` on all unknowns that belong to `orders`, turned by `angle` counter-clockwise.
    pub(super) fn rows_at(&self, columns: &Mat<f64>, angle: f64, orders: &[usize]) -> Mat<f64> {
        let unknowns = self.unknowns_of(orders);
        let mut turned = Mat::from_fn(unknowns.len(), columns.ncols(), |i, j| {
            columns[(unknowns[i], j)]
        });
        let turns: Vec<(usize, (f64, f64))> = (0..unknowns.len())
            .filter(|&i| self.is_cosine(unknowns[i]))
            .map(|i| (i, (self.order(unknowns[i]) as f64 * angle).sin_cos()))
            .collect();
        for j in 0..turned.ncols() {
            let column = turned.col_as_slice_mut(j);
            for &(i, (sin, cos)) in &turns {
                let (x, y) = (column[i], column[i + 2]);
                column[i] = cos * x - sin * y;
                column[i + 2] = sin * x + cos * y;
            }
        }
        turned
    }

    /// The sum over `sectors` equal sectors of `rows` on the unknowns, each turned to its sector: a column for each row. Orders that are no multiple of
    /// the number of sectors cancel.
    pub(super) fn of_all_sectors(&self, rows: MatRef<'_, f64>, sectors: usize) -> Mat<f64> {
        Mat::from_fn(rows.ncols(), rows.nrows(), |unknown, row| {
            if self.order(unknown).is_multiple_of(sectors) {
                sectors as f64 * rows[(row, unknown)]
            } else {
                0.0
            }
        })
    }

    /// Enters `of_order`, rows on the complex amplitudes (radial, tangential) of order `n`, into real `rows`.
    ///
    /// With c_n = (a_n − i b_n)/2 and its conjugate at −n, a row x + i y of order n is x on a_n and y on b_n.
    pub fn set_rows(&self, rows: &mut Mat<f64>, n: i64, of_order: MatRef<'_, c64>) {
        let first = self.cosine(n.unsigned_abs() as usize, Component::Radial);
        for i in 0..rows.nrows() {
            for c in 0..2 {
                rows[(i, first + c)] = of_order[(i, c)].re;
                if n != 0 {
                    rows[(i, first + c + 2)] = n.signum() as f64 * of_order[(i, c)].im;
                }
            }
        }
    }

    /// Adds to `stiffness` the block `block` (components of order `n` by components of order `n_other`) of a Hermitian
    /// form in the complex amplitudes c_n = (a_n − i b_n)/2.
    pub(super) fn add_block(
        &self,
        stiffness: &mut Mat<f64>,
        n: i64,
        n_other: i64,
        block: [[c64; 2]; 2],
    ) {
        let parts = |n: i64| -> [(usize, c64); 2] {
            // The share of a_|n| and of b_|n| in c_n; order 0 has no sine.
            let half = if n == 0 { 1.0 } else { 0.5 };
            let sine = if n == 0 {
                0.0
            } else {
                -0.5 * n.signum() as f64
            };
            [(0, c64::new(half, 0.0)), (2, c64::new(0.0, sine))]
        };
        for (row_offset, row_share) in parts(n).into_iter().take(if n == 0 { 1 } else { 2 }) {
            for (col_offset, col_share) in
                parts(n_other)
                    .into_iter()
                    .take(if n_other == 0 { 1 } else { 2 })
            {
                let row = self.cosine(n.unsigned_abs() as usize, Component::Radial) + row_offset;
                let col =
                    self.cosine(n_other.unsigned_abs() as usize, Component::Radial) + col_offset;
                for (i, line) in block.iter().enumerate() {
                    for (j, value) in line.iter().enumerate() {
                        stiffness[(row + i, col + j)] += (row_share.conj() * value * col_share).re;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_share_out_all_orders_each_once() {
        let harmonics = Harmonics { largest: 11 };
        let mut orders: Vec<i64> = (0..4)
            .flat_map(|class| harmonics.orders_of_class(class, 4))
            .collect();
        orders.sort_unstable();
        assert_eq!(orders, (-11..=11).collect::<Vec<i64>>());
        assert_eq!(harmonics.orders_of_class(1, 4), [-11, -7, -3, 1, 5, 9]);
    }

    #[test]
    fn amplitudes_seen_from_a_turned_frame_are_the_same_motion() {
        let harmonics = Harmonics { largest: 4 };
        let q: Vec<f64> = (0..harmonics.unknowns())
            .map(|i| (1.0 + i as f64).sin())
            .collect();
        let at = |q: &[f64], angle: f64| -> [f64; 2] {
            let e = harmonics.on_circle(&[angle]);
            [0, 1].map(|c| (0..q.len()).map(|i| e[(c, i)] * q[i]).sum())
        };
        let turned = harmonics.turned(&q, 0.7);
        for angle in [-2.0, 0.0, 0.3, 3.0] {
            let (seen, there) = (at(&turned, angle), at(&q, angle + 0.7));
            assert!((seen[0] - there[0]).abs() + (seen[1] - there[1]).abs() < 1e-13);
        }
    }
}
