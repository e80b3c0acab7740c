//! A blank on the edge of its bore, which its shaft or nothing holds: the disc inside the shaft's radius, on the harmonics of its edge.
//!
//! The disc is solid to the axis. A force and a torque on its edge are balanced over the section of the shaft: a force by an even one, a torque by a tangential
//! force f = T r/(b J) that rises with the radius, as torsion leaves it. Both do work on the mean displacement of the section and on its mean rotation, ∫ r u_t
//! dA/∫ r² dA; these are held at zero. Order by order that is a closed form in plane stress.

use faer::{Mat, c64};

use super::cyclic::{Component, Harmonics, Sector, add_orders, at_angles};
use crate::fem::FemError;
use crate::fem::dense::{Cholesky, symmetrize};
use crate::gear::Material;
use crate::grid::BlankGrid;
use crate::run::Run;

/// The orders that the edge of a shaft under the ring of sectors `grid` carries: one for three and a half nodes.
pub(crate) fn orders_of_edge(grid: &BlankGrid) -> Harmonics {
    const NODES_AN_ORDER: f64 = 3.5;
    // The edges of sectors share their ends; a ring without sides has every node once.
    let is_closed = grid.sector_count == 1 && grid.side_nodes.0.is_empty();
    let own = grid.bore_nodes.len() - usize::from(!is_closed);
    let nodes = f64::from(grid.sector_count) * own as f64;
    Harmonics {
        largest: ((nodes / NODES_AN_ORDER) as usize).max(2),
    }
}

/// A load that is the same in all sectors of a ring.
pub(super) struct EdgeLoads<'a> {
    /// The forces on the unknowns of sector 0, behind the arc those of the edge: a load a row.
    pub(super) forces: &'a Mat<f64>,
    /// By how much the free disc of the shaft is larger in radius than the edge, under each load.
    pub(super) swelling: &'a [f64],
}

/// A ring of sectors on a shaft, condensed to its outer circle.
pub(super) struct OnShaft {
    /// The stiffness on the harmonics of the outer circle.
    pub(super) stiffness: Mat<f64>,
    /// Rows on the unknowns of sector 0 as rows on them.
    pub(super) rows: Mat<f64>,
    /// The orders of the edge of the shaft.
    pub(super) edge: Harmonics,
    /// How that edge moves, by the harmonics of the outer circle.
    pub(super) edge_moved: Mat<f64>,
    /// The forces of the loads on the harmonics of the outer circle, a load a column.
    pub(super) forces: Mat<f64>,
    /// How the loads move the edge while the outer circle is held, a load a column.
    pub(super) edge_under_loads: Mat<f64>,
    /// Values of the rows then: one row a functional, one column a load.
    pub(super) under_loads: Mat<f64>,
}

impl OnShaft {
    /// Condenses the ring of `sector`, whose stiffness, `rows` and `loads` go on behind the arc with the nodes of the edge at `edge_angles`, which `core`
    /// holds.
    pub(super) fn new(
        sector: &Sector,
        (edge_angles, edge): (&[f64], Harmonics),
        core: &EdgeCore,
        outer: &Harmonics,
        rows: &Mat<f64>,
        loads: &EdgeLoads<'_>,
        run: &Run,
    ) -> Result<Self, FemError> {
        let asked = rows.nrows();
        let rows = &below(rows, loads.forces);
        let [o, i] = [outer.unknowns(), edge.unknowns()];
        let (mut on_outer, mut between, mut on_edge) =
            (Mat::zeros(o, o), Mat::zeros(i, o), Mat::zeros(i, i));
        let (mut outer_rows, mut edge_rows) =
            (Mat::zeros(rows.nrows(), o), Mat::zeros(rows.nrows(), i));
        for class in 0..=sector.count / 2 {
            let orders = [outer, &edge].map(|each| each.orders_of_class(class, sector.count));
            let arcs = [
                sector.arc_of_harmonics(&orders[0]),
                at_angles(edge_angles, &orders[1]),
            ];
            let e = beside(&arcs);
            let first = arcs[0].ncols();
            let (condensed, solution) =
                sector.condense_class_on(class, &e, orders[0].clone(), run)?;
            let weight = sector.class_weight(class);
            let count = arcs[1].ncols();
            let [a, b] = [&orders[0][..], &orders[1][..]];
            let part = |row: usize, column: usize, rows: usize, columns: usize| {
                condensed.as_ref().submatrix(row, column, rows, columns)
            };
            add_orders(
                &mut on_outer,
                outer,
                part(0, 0, first, first),
                [a, a],
                weight,
            );
            add_orders(
                &mut between,
                &edge,
                part(first, 0, count, first),
                [b, a],
                weight,
            );
            add_orders(
                &mut on_edge,
                &edge,
                part(first, first, count, count),
                [b, b],
                weight,
            );
            if rows.nrows() > 0 {
                let moved = sector.class_rows_on(rows, class, &e, &solution);
                for (j, &n) in a.iter().enumerate() {
                    outer.set_rows(&mut outer_rows, n, moved.subcols(2 * j, 2));
                }
                for (j, &n) in b.iter().enumerate() {
                    edge.set_rows(&mut edge_rows, n, moved.subcols(first + 2 * j, 2));
                }
            }
        }
        core.add_to(&mut on_edge, &edge);
        let factor = Cholesky::new(on_edge).ok_or(FemError::NotPositiveDefinite {
            part: "the edge of a shaft",
            unknowns: i,
        })?;
        let mut edge_moved = between.clone();
        factor.solve_in_place(edge_moved.as_mut());
        edge_moved = -edge_moved;
        let mut stiffness = on_outer;
        stiffness += between.transpose() * &edge_moved;
        symmetrize(&mut stiffness);
        let of_loads = |rows: &Mat<f64>, harmonics: &Harmonics| {
            let loads = rows.subrows(asked, rows.nrows() - asked);
            harmonics.of_all_sectors(loads, sector.count)
        };
        let mut on_edge = of_loads(&edge_rows, &edge);
        let outward = edge.cosine(0, Component::Radial);
        for (load, swelling) in loads.swelling.iter().enumerate() {
            on_edge[(outward, load)] += core.stiffness_outward() * swelling;
        }
        let forces = of_loads(&outer_rows, outer) + edge_moved.transpose() * &on_edge;
        factor.solve_in_place(on_edge.as_mut());
        let under_loads = edge_rows.subrows(0, asked) * &on_edge;
        let rows = outer_rows.subrows(0, asked) + edge_rows.subrows(0, asked) * &edge_moved;
        Ok(Self {
            stiffness,
            rows,
            edge,
            edge_moved,
            forces,
            edge_under_loads: on_edge,
            under_loads,
        })
    }
}

/// The rows of `one`, and below them those of `other`.
fn below(one: &Mat<f64>, other: &Mat<f64>) -> Mat<f64> {
    let first = one.nrows();
    Mat::from_fn(first + other.nrows(), one.ncols(), |i, j| {
        if i < first {
            one[(i, j)]
        } else {
            other[(i - first, j)]
        }
    })
}

/// Support of the edge of a bore.
#[derive(Debug, Clone, Copy)]
pub(super) enum EdgeCore {
    /// The shaft that fills it.
    Shaft(ShaftSection),
    /// Nothing but the means of its motion as a whole, which springs of this stiffness in N/m hold.
    Free {
        /// The stiffness: far above that of any gear in its plane, and small enough to cost no digits.
        stiffness: f64,
    },
}

impl EdgeCore {
    /// Support of the edge of a bore in a plate, if only its mean rotation and displacement are held.
    pub(super) fn free(material: &Material, thickness: f64) -> Self {
        const FIRM: f64 = 1e4;
        Self::Free {
            stiffness: FIRM * material.youngs_modulus * thickness,
        }
    }

    /// Adds the support of the edge to the `stiffness` on `harmonics` of it.
    fn add_to(&self, stiffness: &mut Mat<f64>, harmonics: &Harmonics) {
        let firm = match self {
            Self::Shaft(shaft) => return shaft.add_to(stiffness, harmonics),
            Self::Free { stiffness } => *stiffness,
        };
        let turned = harmonics.cosine(0, Component::Tangential);
        stiffness[(turned, turned)] += firm;
        let radial = harmonics.cosine(1, Component::Radial);
        let tangential = harmonics.cosine(1, Component::Tangential);
        // Displaced as a whole by d along x: u_r = d cos θ, u_t = −d sin θ; along y: u_r = d sin θ, u_t = d cos θ.
        for (i, j, sign) in [
            (radial, tangential + 2, -1.0),
            (radial + 2, tangential, 1.0),
        ] {
            for (row, column, share) in [(i, i, 1.0), (j, j, 1.0), (i, j, sign), (j, i, sign)] {
                stiffness[(row, column)] += 0.25 * firm * share;
            }
        }
    }

    /// The force in N, summed around the edge, by which it is held outward for each meter of its mean radial displacement.
    fn stiffness_outward(&self) -> f64 {
        match self {
            Self::Shaft(shaft) => shaft.stiffness(0)[0][0],
            Self::Free { .. } => 0.0,
        }
    }
}

/// Two matrices on the diagonal of one.
fn beside([one, other]: &[Mat<c64>; 2]) -> Mat<c64> {
    let (rows, columns) = (one.nrows(), one.ncols());
    let mut both = Mat::zeros(rows + other.nrows(), columns + other.ncols());
    both.submatrix_mut(0, 0, rows, columns).copy_from(one);
    both.submatrix_mut(rows, columns, other.nrows(), other.ncols())
        .copy_from(other);
    both
}

/// The disc of one material inside the shaft's radius. How large it is does not matter to the forces that displacements of its edge take.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShaftSection {
    shear_modulus: f64,
    poisson_ratio: f64,
    thickness: f64,
}

impl ShaftSection {
    pub(super) fn new(material: &Material, thickness: f64) -> Self {
        Self {
            shear_modulus: material.shear_modulus(),
            poisson_ratio: material.poisson_ratio,
            thickness,
        }
    }

    /// Adds the stiffness of the disc at its edge to the `stiffness` on `harmonics` of that edge.
    pub(super) fn add_to(&self, stiffness: &mut Mat<f64>, harmonics: &Harmonics) {
        for n in 0..=harmonics.largest {
            let [[rr, rt], [_, tt]] = self.stiffness(n);
            let radial = harmonics.cosine(n, Component::Radial);
            let tangential = harmonics.cosine(n, Component::Tangential);
            stiffness[(radial, radial)] += rr;
            stiffness[(tangential, tangential)] += tt;
            if n == 0 {
                continue;
            }
            stiffness[(radial + 2, radial + 2)] += rr;
            stiffness[(tangential + 2, tangential + 2)] += tt;
            // A cosine outward goes with a sine along, a sine outward with the cosine backwards.
            for (i, j, entry) in [(radial, tangential + 2, rt), (radial + 2, tangential, -rt)] {
                stiffness[(i, j)] += entry;
                stiffness[(j, i)] += entry;
            }
        }
    }

    /// The forces in N on (u_r, u_t) of the edge, by work, for unit amplitudes of u_r = U cos nθ, u_t = V sin nθ; of order 0 both are even.
    fn stiffness(&self, n: usize) -> [[f64; 2]; 2] {
        let Self {
            shear_modulus: g,
            poisson_ratio: nu,
            thickness: b,
        } = *self;
        let kappa = (3.0 - nu) / (1.0 + nu);
        let pi = std::f64::consts::PI;
        if n == 0 {
            // Outward 2 c r; turned u_t = β (r³ − 2 R² r/3), of which the mean rotation is none, and τ = 2 G β r².
            return [
                [8.0 * pi * g * b / (kappa - 1.0), 0.0],
                [0.0, 12.0 * pi * g * b],
            ];
        }
        // Two fields that end at the axis, with their displacements and tractions on the edge, in units of R and of 2 G.
        let order = n as f64;
        let (moved, pulls) = if n == 1 {
            // That of an even force, u_x = r², and that of the potential z², both moved until the mean of the disc stands still.
            let lame = nu / (1.0 - nu);
            (
                [[0.5, kappa - 1.0], [-0.5, kappa + 1.0]],
                [[2.0 * lame + 2.0, 2.0], [-1.0, 2.0]],
            )
        } else {
            // The gradient of rⁿ cos nθ, and the potential zⁿ⁺¹.
            (
                [[order, kappa - order - 1.0], [-order, kappa + order + 1.0]],
                [
                    [order * (order - 1.0), (order + 1.0) * (2.0 - order)],
                    [-order * (order - 1.0), order * (order + 1.0)],
                ],
            )
        };
        let [[a, c], [d, e]] = moved;
        let determinant = a * e - c * d;
        let inverse = [[e, -c], [-d, a]].map(|row| row.map(|entry| entry / determinant));
        let scale = 2.0 * g * pi * b;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                scale * (pulls[i][0] * inverse[0][j] + pulls[i][1] * inverse[1][j])
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{Core, FaceEnds, HolePattern};
    use crate::grid::GridLevel;
    use crate::ring::blank::BlankSubstructure;

    fn on_shaft(grid: &BlankGrid, outer: f64, largest: usize) -> BlankSubstructure {
        let torque_at = FaceEnds::Both;
        let plate = (Core::Shaft { torque_at }, &Material::STEEL, 20e-3);
        let orders = Harmonics { largest };
        let made =
            BlankSubstructure::with_recovery(grid, outer, plate, orders, &[], &Run::unattended());
        made.expect("a stiff ring").0
    }

    #[test]
    fn outside_the_shaft_a_blank_turns_by_its_closed_form() {
        // φ(r) = T/(4 π G b) (4/(3 R²) − 1/r²) against the mean rotation of the section, T 115 N m, b 20 mm, to 1e-4.
        let (torque, outer) = (115.0, 47.5e-3_f64);
        let shear_modulus = Material::STEEL.youngs_modulus / 2.6;
        for shaft in [10e-3_f64, 25e-3] {
            let inverse = 4.0 / (3.0 * shaft.powi(2)) - 1.0 / outer.powi(2);
            let expected = torque / (4.0 * std::f64::consts::PI * shear_modulus * 20e-3) * inverse;
            for level in [GridLevel::Coarse, GridLevel::Standard] {
                let grid = BlankGrid::new(shaft, outer, None, 50, 4.0, level).expect("a ring");
                let blank = on_shaft(&grid, outer, 60);
                let round = blank.harmonics.cosine(0, Component::Tangential);
                let found = torque / outer / blank.stiffness[(round, round)] / outer;
                assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_holed_blank_on_a_shaft_is_the_same_by_sectors_and_as_a_whole() {
        let holes = HolePattern {
            count: 5,
            circle_radius: 30e-3,
            radius: 7e-3,
            phase: 0.0,
        };
        let grid = BlankGrid::new(12e-3, 45e-3, Some(&holes), 40, 4.0, GridLevel::Coarse);
        let grid = grid.expect("a sector");
        let [by_sector, whole] = [&grid, &grid.unrolled()].map(|grid| on_shaft(grid, 45e-3, 40));
        let scale = by_sector.stiffness.norm_max();
        let apart = (&by_sector.stiffness - &whole.stiffness).norm_max();
        assert!(apart < 1e-9 * scale, "{apart:e} of {scale:e}");
    }

    fn section() -> ShaftSection {
        ShaftSection::new(&Material::STEEL, 20e-3)
    }

    #[test]
    fn forces_of_every_order_are_mutual_and_hold() {
        for n in 0..40 {
            let [[a, b], [c, d]] = section().stiffness(n);
            assert!((b - c).abs() < 1e-12 * a, "{n}: {b} {c}");
            assert!(a > 0.0 && a * d - b * c > 0.0, "{n}");
        }
    }

    #[test]
    fn a_rigid_motion_of_the_edge_is_held_by_the_force_and_the_torque_of_the_section() {
        let shear_modulus = Material::STEEL.youngs_modulus / 2.6;
        // Turned by φ the edge takes T = 12 π G b R² φ: at r = R that is φ = T/(4 π G b) (4/3 − 1)/R².
        let [_, [_, turned]] = section().stiffness(0);
        let expected = 12.0 * std::f64::consts::PI * shear_modulus * 20e-3;
        assert!((turned / expected - 1.0).abs() < 1e-12);
        // Held at a rigid edge the even force p on it makes u = p (R² − r²)/(6 G + 2 λ) along it and so a mean of half that at the axis: moved by d
        // the edge takes F = π R² b p = 4 π b (3 G + λ) d, with λ of plane stress.
        let [[a, b], [c, d]] = section().stiffness(1);
        let lame = 2.0 * shear_modulus * 0.3 / 0.7;
        let force = (a - b) - (c - d);
        let expected = 4.0 * std::f64::consts::PI * 20e-3 * (3.0 * shear_modulus + lame);
        assert!((force / expected - 1.0).abs() < 1e-12, "{force} {expected}");
    }

    #[test]
    fn a_plain_disc_stretched_evenly_knows_hookes_law() {
        // u = (x, −y) R: order 2, with the traction 2 G in it: u_r = cos 2θ, u_t = −sin 2θ.
        let [[a, b], [c, d]] = section().stiffness(2);
        let shear_modulus = Material::STEEL.youngs_modulus / 2.6;
        let scale = 2.0 * shear_modulus * std::f64::consts::PI * 20e-3;
        assert!(((a - b) / scale - 1.0).abs() < 1e-12 && ((c - d) / scale + 1.0).abs() < 1e-12);
        // u = r outward: the traction of E/(1 − ν).
        let [[even, _], _] = section().stiffness(0);
        let plane = Material::STEEL.youngs_modulus / 0.7;
        assert!((even / (2.0 * std::f64::consts::PI * 20e-3 * plane) - 1.0).abs() < 1e-12);
    }
}
