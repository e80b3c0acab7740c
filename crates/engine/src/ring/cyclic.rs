//! A ring of equal sectors, condensed to the harmonics of its interface circle.
//!
//! On the interface circle of radius R_w the displacement is a trigonometric polynomial: in polar components
//! u(θ) = Σ_n c_n e^{inθ}, |n| ≤ M. A ring of S equal sectors couples the orders n ≡ n' (mod S) only, so that each class
//! is condensed on one sector. Teeth (S = Z) and holed blanks (S = N) meet in the same harmonics, whatever Z, N and the
//! angle between them: rigid motions and linear fields are the orders 0, 1 and 2 and are exact.

use faer::{Mat, MatRef, c64};

pub use super::harmonics::{Component, Harmonics};
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::run::Run;

/// Columns of a product between two looks at the run: a tenth of a second for the largest rings of one sector.
const PANEL: usize = 32;

/// One sector of a ring: its stiffness on the unknowns (right side, left side, arc) in polar components.
#[derive(Debug, Clone)]
pub(crate) struct Sector {
    /// The number S of sectors in the ring.
    pub count: usize,
    /// The stiffness, in N/m.
    pub stiffness: Mat<f64>,
    /// The number of nodes on each side.
    pub side_nodes: usize,
    /// The angles of the nodes on the arc.
    pub arc_angles: Vec<f64>,
}

/// The displacements of the sides of one class of a ring when its arc moves or its sides are loaded.
pub(crate) struct ClassSolution {
    /// The factor of the sides' stiffness with the turn of the class across a sector; `None` without side nodes.
    pub sides: Option<Cholesky<c64>>,
    /// The stiffness between sides and the harmonics of the class.
    pub sides_to_harmonics: Mat<c64>,
    /// The orders of the class.
    pub orders: Vec<i64>,
}

impl Sector {
    /// The factor e^{i class 2πd/S} from a sector to the one `distance` places counter-clockwise of it; with 1, from the right side of
    /// a sector to its left one.
    pub(crate) fn turn(&self, class: usize, distance: usize) -> c64 {
        let part = ((class * distance) % self.count) as f64 / self.count as f64;
        let (sin, cos) = (2.0 * std::f64::consts::PI * part).sin_cos();
        c64::new(cos, sin)
    }

    /// E: the polar displacements of the arc's nodes for unit amplitudes of `orders`; two columns an order.
    pub(crate) fn arc_of_harmonics(&self, orders: &[i64]) -> Mat<c64> {
        at_angles(&self.arc_angles, orders)
    }

    /// Condenses one class to its harmonics: returns the Hermitian stiffness of one sector and the way back to the sides.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub(crate) fn condense_class(
        &self,
        class: usize,
        harmonics: &Harmonics,
        run: &Run,
    ) -> Result<(Mat<c64>, ClassSolution), FemError> {
        let orders = harmonics.orders_of_class(class, self.count);
        let e = self.arc_of_harmonics(&orders);
        self.condense_class_on(class, &e, orders, run)
    }

    /// As [`Sector::condense_class`], with the unknowns behind both sides moved by the columns of `e`; `orders` are those of the displacements that are recovered.
    pub(super) fn condense_class_on(
        &self,
        class: usize,
        e: &Mat<c64>,
        orders: Vec<i64>,
        run: &Run,
    ) -> Result<(Mat<c64>, ClassSolution), FemError> {
        let ns = 2 * self.side_nodes;
        let na = e.nrows();
        let k = &self.stiffness;
        // Displacements of (right, left) are (1, turn) times those of the right side.
        let turn = self.turn(class, 1);
        let real = |i: usize, j: usize| c64::new(k[(i, j)], 0.0);
        let arc = Mat::<c64>::from_fn(na, na, |i, j| real(2 * ns + i, 2 * ns + j));
        let mut condensed = Mat::<c64>::zeros(e.ncols(), e.ncols());
        // A ring of one sector has all orders in one class: its products take long and are done in panels.
        for start in (0..e.ncols()).step_by(PANEL) {
            run.check()?;
            let width = PANEL.min(e.ncols() - start);
            let forces = &arc * e.subcols(start, width);
            condensed
                .subcols_mut(start, width)
                .copy_from(e.adjoint() * forces);
        }
        let solution = if ns == 0 {
            ClassSolution {
                sides: None,
                sides_to_harmonics: Mat::zeros(0, e.ncols()),
                orders,
            }
        } else {
            let sides = Mat::<c64>::from_fn(ns, ns, |i, j| {
                real(i, j)
                    + real(ns + i, ns + j)
                    + turn * real(i, ns + j)
                    + turn.conj() * real(ns + i, j)
            });
            let sides_to_arc = Mat::<c64>::from_fn(ns, na, |i, j| {
                real(i, 2 * ns + j) + turn.conj() * real(ns + i, 2 * ns + j)
            });
            let sides_to_harmonics = &sides_to_arc * e;
            let sides = Cholesky::new(sides).ok_or(FemError::NotPositiveDefinite {
                part: "a ring's sides",
                unknowns: ns,
            })?;
            let mut half = sides_to_harmonics.clone();
            sides.half_solve_in_place(half.as_mut());
            condensed -= half.adjoint() * &half;
            ClassSolution {
                sides: Some(sides),
                sides_to_harmonics,
                orders,
            }
        };
        Ok((condensed, solution))
    }

    /// The stiffness of the whole ring on the real unknowns of `harmonics`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub(crate) fn ring_stiffness(
        &self,
        harmonics: &Harmonics,
        run: &Run,
    ) -> Result<Mat<f64>, FemError> {
        if self.count == 1 && self.side_nodes == 0 {
            return self.closed_stiffness(harmonics, run);
        }
        let mut stiffness = Mat::zeros(harmonics.unknowns(), harmonics.unknowns());
        // Classes c and S − c are each other's conjugates; both are visited only through their orders, so half suffice.
        for class in 0..=self.count / 2 {
            let (condensed, solution) = self.condense_class(class, harmonics, run)?;
            self.add_class(
                &mut stiffness,
                harmonics,
                class,
                &condensed,
                &solution.orders,
            );
        }
        Ok(stiffness)
    }

    /// The stiffness of a ring that is one sector without sides: Eᵀ K E with the real harmonics, at a quarter of the work of
    /// the complex ones.
    fn closed_stiffness(&self, harmonics: &Harmonics, run: &Run) -> Result<Mat<f64>, FemError> {
        let e = harmonics.on_circle(&self.arc_angles);
        let mut stiffness = Mat::zeros(e.ncols(), e.ncols());
        for start in (0..e.ncols()).step_by(PANEL) {
            run.check()?;
            let width = PANEL.min(e.ncols() - start);
            let forces = &self.stiffness * e.subcols(start, width);
            stiffness
                .subcols_mut(start, width)
                .copy_from(e.transpose() * forces);
        }
        Ok(stiffness)
    }

    /// Rows on the unknowns of sector 0 (right side, left side, arc) as rows on the real unknowns of `harmonics`, with no force
    /// on any side: one row of the result for each of `rows`.
    ///
    /// For sector i take the rows on harmonics turned by [`Harmonics::turned`].
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub(crate) fn ring_rows(
        &self,
        rows: &Mat<f64>,
        harmonics: &Harmonics,
        run: &Run,
    ) -> Result<Mat<f64>, FemError> {
        if self.count == 1 && self.side_nodes == 0 {
            return Ok(rows * harmonics.on_circle(&self.arc_angles));
        }
        let mut ring = Mat::zeros(rows.nrows(), harmonics.unknowns());
        for class in 0..=self.count / 2 {
            let (_, solution) = self.condense_class(class, harmonics, run)?;
            let on_harmonics = self.class_rows(rows, class, &solution);
            for (j, &n) in solution.orders.iter().enumerate() {
                harmonics.set_rows(&mut ring, n, on_harmonics.subcols(2 * j, 2));
            }
        }
        Ok(ring)
    }

    /// Rows on the unknowns of sector 0 as rows on the complex amplitudes of the orders of one class.
    pub(crate) fn class_rows(
        &self,
        rows: &Mat<f64>,
        class: usize,
        solution: &ClassSolution,
    ) -> Mat<c64> {
        let e = self.arc_of_harmonics(&solution.orders);
        self.class_rows_on(rows, class, &e, solution)
    }

    /// As [`Sector::class_rows`], of a class that was condensed with the columns of `e`.
    pub(super) fn class_rows_on(
        &self,
        rows: &Mat<f64>,
        class: usize,
        e: &Mat<c64>,
        solution: &ClassSolution,
    ) -> Mat<c64> {
        let ns = 2 * self.side_nodes;
        let on_arc = Mat::<c64>::from_fn(rows.nrows(), e.nrows(), |i, j| {
            c64::new(rows[(i, 2 * ns + j)], 0.0)
        });
        let mut on_harmonics = on_arc * e;
        if let Some(sides) = &solution.sides {
            let mut moved = solution.sides_to_harmonics.clone();
            sides.solve_in_place(moved.as_mut());
            on_harmonics -= self.side_rows(rows, class) * moved;
        }
        on_harmonics
    }

    /// Values of `rows` on the unknowns of sector 0 under `forces` on the same unknowns, a row each, the same in every sector: the sides follow, and all
    /// behind them is held. One row a functional, one column a load.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub(super) fn under_equal_loads(
        &self,
        rows: &Mat<f64>,
        forces: &Mat<f64>,
        run: &Run,
    ) -> Result<Mat<f64>, FemError> {
        let behind = self.stiffness.nrows() - 4 * self.side_nodes;
        let held = Mat::zeros(behind, 0);
        let (_, solution) = self.condense_class_on(0, &held, Vec::new(), run)?;
        let mut answers = Mat::zeros(rows.nrows(), forces.nrows());
        if let Some(sides) = &solution.sides {
            let mut moved = self.side_rows(forces, 0).transpose().to_owned();
            sides.solve_in_place(moved.as_mut());
            let moved = self.side_rows(rows, 0) * moved;
            answers = Mat::from_fn(moved.nrows(), moved.ncols(), |i, j| moved[(i, j)].re);
        }
        Ok(answers)
    }

    /// Rows on both sides of sector 0 as rows on the amplitudes of its right side in one class.
    pub(crate) fn side_rows(&self, rows: &Mat<f64>, class: usize) -> Mat<c64> {
        let (ns, turn) = (2 * self.side_nodes, self.turn(class, 1));
        Mat::<c64>::from_fn(rows.nrows(), ns, |i, j| {
            c64::new(rows[(i, j)], 0.0) + turn * rows[(i, ns + j)]
        })
    }

    /// How often a condensed class counts in the stiffness of the ring: it stands for all sectors, and for its conjugate.
    pub(super) fn class_weight(&self, class: usize) -> f64 {
        let own_conjugate = (2 * class).is_multiple_of(self.count);
        // The conjugate class has the orders −n and conjugate blocks; its real contribution equals this one's.
        self.count as f64 * if own_conjugate { 1.0 } else { 2.0 }
    }

    /// Adds one condensed class, and its conjugate, to the ring's real stiffness.
    pub(crate) fn add_class(
        &self,
        stiffness: &mut Mat<f64>,
        harmonics: &Harmonics,
        class: usize,
        condensed: &Mat<c64>,
        orders: &[i64],
    ) {
        let weight = self.class_weight(class);
        add_orders(
            stiffness,
            harmonics,
            condensed.as_ref(),
            [orders, orders],
            weight,
        );
    }
}

/// The polar displacements of nodes at `angles` for unit amplitudes of `orders`; two columns an order.
pub(super) fn at_angles(angles: &[f64], orders: &[i64]) -> Mat<c64> {
    let mut e = Mat::<c64>::zeros(2 * angles.len(), 2 * orders.len());
    for (j, &n) in orders.iter().enumerate() {
        for (i, &angle) in angles.iter().enumerate() {
            let (sin, cos) = (n as f64 * angle).sin_cos();
            e[(2 * i, 2 * j)] = c64::new(cos, sin);
            e[(2 * i + 1, 2 * j + 1)] = c64::new(cos, sin);
        }
    }
    e
}

/// Adds the blocks of `condensed`, of one set of orders by another, to a real `stiffness`, times `weight`.
pub(super) fn add_orders(
    stiffness: &mut Mat<f64>,
    harmonics: &Harmonics,
    condensed: MatRef<'_, c64>,
    [orders, others]: [&[i64]; 2],
    weight: f64,
) {
    for (i, &n) in orders.iter().enumerate() {
        for (j, &n_other) in others.iter().enumerate() {
            let at = |a: usize, b: usize| condensed[(2 * i + a, 2 * j + b)] * weight;
            harmonics.add_block(
                stiffness,
                n,
                n_other,
                [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]],
            );
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// A sector of `count` with any symmetric positive definite stiffness: nothing below depends on where it comes from.
    pub(in crate::ring) fn sector(count: usize, side_nodes: usize) -> Sector {
        let pitch = 2.0 * std::f64::consts::PI / count as f64;
        let arc_angles = [-0.5, -0.3, 0.1, 0.5].map(|part| part * pitch).to_vec();
        let n = 4 * side_nodes + 2 * arc_angles.len();
        let factor = DMatrix::from_fn(n, n, |i, j| (1.0 + (i * n + j * j) as f64).sin());
        let dense = &factor * factor.transpose() + DMatrix::identity(n, n);
        Sector {
            count,
            stiffness: Mat::from_fn(n, n, |i, j| dense[(i, j)]),
            side_nodes,
            arc_angles,
        }
    }

    /// The stiffness of the whole ring, sector by sector, on its sides and then on the real amplitudes of its arcs.
    ///
    /// The unknowns of side i are shared by sector i − 1, on its left, and sector i, on its right.
    pub(in crate::ring) fn assembled(sector: &Sector, harmonics: &Harmonics) -> DMatrix<f64> {
        let (ns, s) = (2 * sector.side_nodes, sector.count);
        let (na, nq) = (2 * sector.arc_angles.len(), harmonics.unknowns());
        let n = s * ns + nq;
        let mut ring = DMatrix::<f64>::zeros(n, n);
        for i in 0..s {
            let mut place = DMatrix::<f64>::zeros(2 * ns + na, n);
            for c in 0..ns {
                place[(c, i * ns + c)] += 1.0;
                place[(ns + c, (i + 1) % s * ns + c)] += 1.0;
            }
            place
                .view_mut((2 * ns, s * ns), (na, nq))
                .copy_from(&arc(sector, harmonics, i));
            let k = DMatrix::from_fn(2 * ns + na, 2 * ns + na, |a, b| sector.stiffness[(a, b)]);
            ring += place.transpose() * k * &place;
        }
        ring
    }

    /// The polar displacements of the arc of sector `i` for unit amplitudes: a_n cos nθ + b_n sin nθ as documented.
    pub(in crate::ring) fn arc(sector: &Sector, harmonics: &Harmonics, i: usize) -> DMatrix<f64> {
        let mut arc = DMatrix::zeros(2 * sector.arc_angles.len(), harmonics.unknowns());
        for (node, angle) in sector.arc_angles.iter().enumerate() {
            let angle = angle + 2.0 * std::f64::consts::PI * i as f64 / sector.count as f64;
            for n in 0..=harmonics.largest {
                for (c, component) in [Component::Radial, Component::Tangential]
                    .into_iter()
                    .enumerate()
                {
                    let cosine = harmonics.cosine(n, component);
                    arc[(2 * node + c, cosine)] = (n as f64 * angle).cos();
                    if n > 0 {
                        arc[(2 * node + c, cosine + 2)] = (n as f64 * angle).sin();
                    }
                }
            }
        }
        arc
    }

    #[test]
    fn a_ring_by_its_classes_is_the_ring_assembled_sector_by_sector() {
        // One sector that closes on itself, odd and even counts, more orders than sectors, and sectors without side nodes.
        for (count, side_nodes, largest) in [
            (1, 2, 3),
            (2, 2, 3),
            (3, 2, 7),
            (4, 1, 2),
            (4, 3, 9),
            (5, 2, 11),
            (4, 0, 3),
            (1, 0, 3),
        ] {
            let (sector, harmonics) = (sector(count, side_nodes), Harmonics { largest });
            let ring = sector
                .ring_stiffness(&harmonics, &Run::unattended())
                .expect("definite");
            let whole = assembled(&sector, &harmonics);
            let sides = 2 * side_nodes * count;
            let nq = harmonics.unknowns();
            let mut expected = whole.view((sides, sides), (nq, nq)).clone_owned();
            if sides > 0 {
                let coupling = whole.view((0, sides), (sides, nq)).clone_owned();
                let held = whole.view((0, 0), (sides, sides)).clone_owned();
                let solved = held.cholesky().expect("definite").solve(&coupling);
                expected -= coupling.transpose() * solved;
            }
            for i in 0..nq {
                for j in 0..nq {
                    // Roundings.
                    let apart = (ring[(i, j)] - expected[(i, j)]).abs();
                    assert!(
                        apart < 1e-11 * expected.amax(),
                        "{count} sectors, ({i}, {j}): {apart}"
                    );
                }
            }
        }
    }

    #[test]
    fn rows_on_a_sector_are_those_of_the_ring_assembled_sector_by_sector() {
        for (count, side_nodes, largest) in [(1, 2, 3), (2, 2, 3), (4, 3, 9), (5, 2, 11), (1, 0, 3)]
        {
            let (sector, harmonics) = (sector(count, side_nodes), Harmonics { largest });
            let rows = Mat::from_fn(3, sector.stiffness.nrows(), |i, j| {
                (1.0 + (5 * i + 3 * j) as f64).sin()
            });
            let ring = sector
                .ring_rows(&rows, &harmonics, &Run::unattended())
                .expect("definite");
            let whole = assembled(&sector, &harmonics);
            let (ns, nq) = (2 * side_nodes, harmonics.unknowns());
            let sides = ns * count;
            let q: Vec<f64> = (0..nq).map(|i| (2.0 + i as f64).cos()).collect();
            let q_dense = DMatrix::from_column_slice(nq, 1, &q);
            let moved = if sides > 0 {
                let held = whole.view((0, 0), (sides, sides)).clone_owned();
                let coupling = whole.view((0, sides), (sides, nq)).clone_owned();
                -held
                    .cholesky()
                    .expect("definite")
                    .solve(&(coupling * &q_dense))
            } else {
                DMatrix::zeros(0, 1)
            };
            for i in 0..count {
                let on_arc = arc(&sector, &harmonics, i) * &q_dense;
                let seen = harmonics.turned(&q, std::f64::consts::TAU * i as f64 / count as f64);
                for row in 0..3 {
                    let mut expected = 0.0;
                    for c in 0..ns {
                        expected += rows[(row, c)] * moved[i * ns + c];
                        expected += rows[(row, ns + c)] * moved[(i + 1) % count * ns + c];
                    }
                    for c in 0..on_arc.nrows() {
                        expected += rows[(row, 2 * ns + c)] * on_arc[c];
                    }
                    let found: f64 = (0..nq).map(|c| ring[(row, c)] * seen[c]).sum();
                    assert!(
                        (found - expected).abs() < 1e-9,
                        "{count} sectors, {i}: {found} {expected}"
                    );
                }
            }
        }
    }
}
