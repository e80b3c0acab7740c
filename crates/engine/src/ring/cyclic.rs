//! A ring of equal sectors, condensed to the harmonics of its interface circle.
//!
//! On the interface circle of radius R_w the displacement is a trigonometric polynomial: in polar components
//! u(θ) = Σ_n c_n e^{inθ}, |n| ≤ M. A ring of S equal sectors couples the orders n ≡ n' (mod S) only, so that each class
//! is condensed on one sector. Teeth (S = Z) and holed blanks (S = N) meet in the same harmonics, whatever Z, N and the
//! angle between them: rigid motions and linear fields are the orders 0, 1 and 2 and are exact.

use faer::{Mat, MatRef, c64};

pub use super::harmonics::{Component, Harmonics};
use super::sector::{ClassOnArcs, Sector};
use crate::fem::FemError;
use crate::run::Run;

/// Columns of a product between two looks at the run: a tenth of a second for the largest rings of one sector.
const PANEL: usize = 32;

impl Sector {
    /// The stiffness of the whole ring on the real unknowns of `harmonics`.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn ring_stiffness(&self, harmonics: &Harmonics, run: &Run) -> Result<Mat<f64>, FemError> {
        if self.count == 1 && self.side_nodes == 0 {
            return self.closed_stiffness(harmonics, run);
        }
        let mut stiffness = Mat::zeros(harmonics.unknowns(), harmonics.unknowns());
        // Classes c and S − c are each other's conjugates; both are visited only through their orders, so half suffice.
        for class in 0..=self.count / 2 {
            run.check()?;
            let on_arc = self.condense_class(class, self.orders(class, harmonics.largest))?;
            self.add_class(&mut stiffness, harmonics, class, &on_arc);
        }
        Ok(stiffness)
    }

    /// The stiffness of a ring that is one sector without sides: Eᵀ K E with the real harmonics, at a quarter of the work of
    /// the complex ones.
    fn closed_stiffness(&self, harmonics: &Harmonics, run: &Run) -> Result<Mat<f64>, FemError> {
        let e = harmonics.on_circle(self.arcs[0].angles());
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
    pub fn ring_rows(
        &self,
        rows: &Mat<f64>,
        harmonics: &Harmonics,
        run: &Run,
    ) -> Result<Mat<f64>, FemError> {
        if self.count == 1 && self.side_nodes == 0 {
            return Ok(rows * harmonics.on_circle(self.arcs[0].angles()));
        }
        let mut ring = Mat::zeros(rows.nrows(), harmonics.unknowns());
        for class in 0..=self.count / 2 {
            run.check()?;
            let on_arc = self.condense_class(class, self.orders(class, harmonics.largest))?;
            let rows = on_arc.on_arcs(&self.on_class(rows, class, &on_arc.orders));
            for (j, &n) in on_arc.orders.iter().enumerate() {
                harmonics.set_rows(&mut ring, n, rows.subcols(2 * j, 2));
            }
        }
        Ok(ring)
    }

    /// How often a condensed class counts in the stiffness of the ring: it stands for all sectors, and for its conjugate.
    pub(super) fn class_weight(&self, class: usize) -> f64 {
        let own_conjugate = (2 * class).is_multiple_of(self.count);
        // The conjugate class has the orders −n and conjugate blocks; its real contribution equals this one's.
        self.count as f64 * if own_conjugate { 1.0 } else { 2.0 }
    }

    /// Adds one condensed class, and its conjugate, to the ring's real stiffness.
    pub fn add_class(
        &self,
        stiffness: &mut Mat<f64>,
        harmonics: &Harmonics,
        class: usize,
        on_arc: &ClassOnArcs,
    ) {
        let (orders, weight) = (&on_arc.orders[..], self.class_weight(class));
        let condensed = on_arc.stiffness.as_ref();
        add_orders(stiffness, harmonics, condensed, [orders, orders], weight);
    }
}

/// Adds the blocks of `condensed`, of one set of orders by another, to a real `stiffness` so many times.
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
    use crate::ring::sector::Arc;

    /// A sector of `count` with any symmetric positive definite stiffness: nothing below depends on where it comes from.
    pub(in crate::ring) fn sector(count: usize, side_nodes: usize) -> Sector {
        let pitch = 2.0 * std::f64::consts::PI / count as f64;
        let arc_angles = [-0.5, -0.3, 0.1, 0.5].map(|part| part * pitch).to_vec();
        let n = 4 * side_nodes + 2 * arc_angles.len();
        let factor = DMatrix::from_fn(n, n, |i, j| (1.0 + (i * n + j * j) as f64).sin());
        let dense = &factor * factor.transpose() + DMatrix::identity(n, n);
        Sector {
            count,
            size: 2,
            stiffness: Mat::from_fn(n, n, |i, j| dense[(i, j)]),
            side_nodes,
            arcs: vec![Arc::Nodes(arc_angles, usize::MAX)],
        }
    }

    /// The stiffness of the whole ring, sector by sector, on its sides and then on the real amplitudes of its arcs.
    ///
    /// The unknowns of side i are shared by sector i − 1, on its left, and sector i, on its right.
    pub(in crate::ring) fn assembled(sector: &Sector, harmonics: &Harmonics) -> DMatrix<f64> {
        let (ns, s) = (2 * sector.side_nodes, sector.count);
        let (na, nq) = (2 * sector.arcs[0].angles().len(), harmonics.unknowns());
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
        let mut arc = DMatrix::zeros(2 * sector.arcs[0].angles().len(), harmonics.unknowns());
        for (node, angle) in sector.arcs[0].angles().iter().enumerate() {
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
