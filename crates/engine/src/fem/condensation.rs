//! Static condensation: the exact stiffness of a grid on the kept unknowns, and functionals of all others.
//!
//! The kept unknowns are ordered last, so that the trailing block L₂₂ of the sparse Cholesky factor gives the Schur
//! complement S = L₂₂ L₂₂ᵀ without a single right-hand side. A functional b of all displacements takes one: with the kept ones
//! moved by u it is (b₂ − L₂₁ L₁₁⁻¹ b₁)ᵀ u.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, Par};

use super::FemError;
use super::dense::mirror_lower;
use super::element::{self, COMPONENTS, ElementStiffness};
use super::factor::Factor;
use super::recovery::Functional;
use super::sparse::{BlockMatrix, Numbering, by_entries};
use crate::gear::Material;
use crate::grid::Grid;

/// Functionals that go through the factor together: as many columns as stay in the cache beside a supernode.
const FUNCTIONALS_AT_ONCE: usize = 64;

/// A grid condensed to the nodes that are kept.
#[derive(Debug, Clone)]
pub struct Condensed {
    /// The stiffness on the unknowns (u_x, u_y) of each kept node in the order given, in N/m.
    pub stiffness: Mat<f64>,
    /// The requested functionals, one a row, by the same unknowns: their values while no force acts on any other node.
    pub rows: Mat<f64>,
    /// The loads on all nodes as forces on the same unknowns, one load a row.
    pub loads: Mat<f64>,
    /// The functionals asked for under the loads, with the kept nodes held: one functional a row, one load a column.
    pub under_loads: Mat<f64>,
}

/// The stiffness of every element of `grid` in turn, of one material; `thickness`, in meters, is that of an element whose own
/// is 1.
pub(crate) fn element_stiffnesses(
    grid: &Grid,
    material: &Material,
    thickness: f64,
) -> impl Iterator<Item = ElementStiffness> {
    grid.elements.iter().map(move |element| {
        let (nodes, part) = (element.places(&grid.nodes), element.thickness());
        element::stiffness(element.kind(), &nodes, material, thickness * part)
    })
}

/// Condenses `grid` to the unknowns of the nodes in `kept`, with the nodes in `fixed` held, the functionals `asked` and the `loads` on its nodes.
///
/// The result has the unknowns (u_x, u_y) of each kept node in the order given, in N/m. A grid that floats, with nothing
/// fixed, is condensed as well: its stiffness is singular by the rigid motions only. The thickness, in meters, is that of an
/// element whose own is 1. A load is given by the work Σ f·u of its forces and condensed as a functional is: L₁₁⁻¹ of both, multiplied, is the functional
/// under the load with the kept nodes held. No functionals cost nothing.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`] if the grid is degenerate.
pub fn condense(
    part: &'static str,
    grid: &Grid,
    (material, thickness): (&Material, f64),
    (kept, fixed): (&[u32], &[u32]),
    asked: &[Functional],
    loads: &[Functional],
) -> Result<Condensed, FemError> {
    let numbering = Numbering::new(grid.nodes.len(), kept, fixed);
    let mut matrix = BlockMatrix::new(COMPONENTS, &grid.elements, &numbering);
    for (element, k) in grid
        .elements
        .iter()
        .zip(element_stiffnesses(grid, material, thickness))
    {
        matrix.add(
            element,
            by_entries(COMPONENTS, |i, j| k[(i, j)]),
            &numbering,
        );
    }
    // Springs on the kept unknowns make a floating grid definite; they add to the Schur complement exactly and are taken
    // off again below.
    let spring = if fixed.is_empty() {
        material.youngs_modulus * thickness
    } else {
        0.0
    };
    for node in numbering.interior..numbering.count {
        matrix.add_to_diagonal(node, spring);
    }
    let factor = Factor::new(part, matrix, &numbering)?;
    let trailing = factor.trailing();
    let mut stiffness = squared(&trailing);
    for i in 0..stiffness.nrows() {
        stiffness[(i, i)] -= spring;
    }
    let of_loads = factor.halved(loads, &numbering);
    let mut rows = Mat::zeros(asked.len(), 2 * kept.len());
    let mut under_loads = Mat::zeros(asked.len(), loads.len());
    for (chunk, asked) in asked.chunks(FUNCTIONALS_AT_ONCE).enumerate() {
        let halved = factor.halved(asked, &numbering);
        let columns = &trailing * &halved.on_kept;
        let first = chunk * FUNCTIONALS_AT_ONCE;
        rows.subrows_mut(first, asked.len())
            .copy_from(columns.transpose());
        if !loads.is_empty() {
            let inside = halved.inside.transpose() * &of_loads.inside;
            under_loads
                .subrows_mut(first, asked.len())
                .copy_from(inside);
        }
    }
    let loads = (&trailing * &of_loads.on_kept).transpose().to_owned();
    Ok(Condensed {
        stiffness,
        rows,
        loads,
        under_loads,
    })
}

/// L Lᵀ of a lower triangle.
pub(super) fn squared(l: &Mat<f64>) -> Mat<f64> {
    let mut square = Mat::<f64>::zeros(l.nrows(), l.nrows());
    triangular::matmul(
        square.as_mut(),
        BlockStructure::TriangularLower,
        Accum::Replace,
        l,
        BlockStructure::TriangularLower,
        l.transpose(),
        BlockStructure::TriangularUpper,
        1.0,
        Par::Seq,
    );
    mirror_lower(&mut square);
    square
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::gear::Vector;
    use crate::grid::Element;

    /// Four distorted elements around one corner: nodes on the lattice of corners and midsides.
    pub(in crate::fem) fn patch() -> Grid {
        let mut number = [[u32::MAX; 5]; 5];
        let mut nodes = Vec::new();
        for (j, row) in number.iter_mut().enumerate() {
            for (i, place) in row.iter_mut().enumerate() {
                if i % 2 == 1 && j % 2 == 1 {
                    continue;
                }
                *place = nodes.len() as u32;
                let (x, y) = (i as f64, j as f64);
                nodes.push(1e-3 * Vector::new(x + 0.1 * y * y + 0.05 * x * y, 0.9 * y - 0.1 * x));
            }
        }
        let element = |i: usize, j: usize| {
            [
                (0, 0),
                (2, 0),
                (2, 2),
                (0, 2),
                (1, 0),
                (2, 1),
                (1, 2),
                (0, 1),
            ]
            .map(|(a, b)| number[j + b][i + a])
        };
        let element = |i: usize, j: usize| Element::quadrilateral(element(i, j));
        Grid {
            nodes,
            elements: vec![element(0, 0), element(2, 0), element(0, 2), element(2, 2)],
        }
    }

    /// The stiffness of the whole grid.
    fn dense(grid: &Grid) -> DMatrix<f64> {
        let n = 2 * grid.nodes.len();
        let mut k = DMatrix::<f64>::zeros(n, n);
        for (element, stiffness) in
            grid.elements
                .iter()
                .zip(element_stiffnesses(grid, &Material::STEEL, 20e-3))
        {
            let place = |local: usize| 2 * element.nodes()[local / 2] as usize + local % 2;
            let unknowns = 2 * element.nodes().len();
            for i in 0..unknowns {
                for j in 0..unknowns {
                    k[(place(i), place(j))] += stiffness[(i, j)];
                }
            }
        }
        k
    }

    /// Stiffness of a plate of steel on the nodes `kept`, with those of `fixed` held.
    fn alone(grid: &Grid, kept: &[u32], fixed: &[u32]) -> Result<Mat<f64>, FemError> {
        let plate = (&Material::STEEL, 20e-3);
        Ok(condense("a patch", grid, plate, (kept, fixed), &[], &[])?.stiffness)
    }

    /// K_bb − K_bi K_ii⁻¹ K_ib with dense matrices, all unknowns of `kept` against all that are neither kept nor fixed.
    fn dense_schur(grid: &Grid, kept: &[u32], fixed: &[u32]) -> DMatrix<f64> {
        let k = dense(grid);
        let unknowns = |nodes: &[u32]| -> Vec<usize> {
            nodes
                .iter()
                .flat_map(|node| [2 * *node as usize, 2 * *node as usize + 1])
                .collect()
        };
        let inner: Vec<u32> = (0..grid.nodes.len() as u32)
            .filter(|node| !kept.contains(node) && !fixed.contains(node))
            .collect();
        let (b, i) = (unknowns(kept), unknowns(&inner));
        let part = |rows: &[usize], cols: &[usize]| k.select_rows(rows).select_columns(cols);
        let solved = part(&i, &i)
            .lu()
            .solve(&part(&i, &b))
            .expect("what is inside is held by its boundary");
        part(&b, &b) - part(&b, &i) * solved
    }

    fn assert_equal(schur: &Mat<f64>, dense: &DMatrix<f64>) {
        assert_eq!(
            (schur.nrows(), schur.ncols()),
            (dense.nrows(), dense.ncols())
        );
        for i in 0..dense.nrows() {
            for j in 0..dense.ncols() {
                // Roundings of an elimination of a few dozen unknowns.
                assert!((schur[(i, j)] - dense[(i, j)]).abs() < 1e-12 * dense.amax());
            }
        }
    }

    #[test]
    fn the_trailing_factor_is_the_schur_complement_of_a_floating_grid() {
        let grid = patch();
        let kept = [20, 0, 7, 4, 12];
        let schur = alone(&grid, &kept, &[]).expect("a sound grid");
        assert_equal(&schur, &dense_schur(&grid, &kept, &[]));
        // It floats: a translation and a rotation of the kept nodes cost nothing.
        let scale = schur[(0, 0)];
        for i in 0..schur.nrows() {
            let along_x: f64 = (0..kept.len()).map(|k| schur[(i, 2 * k)]).sum();
            let turning: f64 = kept
                .iter()
                .enumerate()
                .map(|(k, node)| {
                    let p = 1e3 * grid.nodes[*node as usize];
                    -p.y * schur[(i, 2 * k)] + p.x * schur[(i, 2 * k + 1)]
                })
                .sum();
            assert!(along_x.abs() < 1e-11 * scale && turning.abs() < 1e-10 * scale);
        }
    }

    #[test]
    fn the_trailing_factor_is_the_schur_complement_of_a_held_grid() {
        let grid = patch();
        let (kept, fixed) = ([18, 20, 3], [0, 1, 2]);
        let schur = alone(&grid, &kept, &fixed).expect("a sound grid");
        assert_equal(&schur, &dense_schur(&grid, &kept, &fixed));
    }

    #[test]
    fn a_grid_turned_inside_out_is_refused() {
        let mut grid = patch();
        for element in &mut grid.elements {
            let nodes = element.nodes();
            *element = Element::quadrilateral([0, 3, 2, 1, 7, 6, 5, 4].map(|i: usize| nodes[i]));
        }
        let error = alone(&grid, &[0, 4], &[]).expect_err("a refusal");
        assert!(matches!(
            error,
            FemError::NotPositiveDefinite {
                part: "a patch",
                ..
            }
        ));
    }

    #[test]
    fn functionals_follow_the_kept_nodes_as_the_solution_of_the_dense_system_does() {
        let grid = patch();
        let n = grid.nodes.len() as u32;
        // Inner, kept and fixed nodes together, with and without anything held.
        let asked: Vec<Functional> = (0..70)
            .map(|k| {
                let term = |i: u32| {
                    (
                        (7 * k + 3 * i) % n,
                        Vector::new(f64::from(i) - 1.0, 0.5 + f64::from(k % 5)),
                    )
                };
                Functional::new((0..4).map(term).collect())
            })
            .collect();
        for fixed in [&[0, 1, 2][..], &[]] {
            let kept = [18, 20, 3];
            let plate = (&Material::STEEL, 20e-3);
            let condensed = condense("a patch", &grid, plate, (&kept, fixed), &asked, &[]);
            let condensed = condensed.expect("a sound grid");
            let inner: Vec<u32> = (0..n)
                .filter(|node| !kept.contains(node) && !fixed.contains(node))
                .collect();
            // u_i = −K_ii⁻¹ K_ib u_b, from the dense matrix.
            let k = dense(&grid);
            let unknowns = |nodes: &[u32]| -> Vec<usize> {
                let both = |node: &u32| [2 * *node as usize, 2 * *node as usize + 1];
                nodes.iter().flat_map(both).collect()
            };
            let (b, i) = (unknowns(&kept), unknowns(&inner));
            let part = |rows: &[usize], cols: &[usize]| k.select_rows(rows).select_columns(cols);
            let moved = -part(&i, &i).lu().solve(&part(&i, &b)).expect("held");
            for (row, functional) in asked.iter().enumerate() {
                for column in 0..b.len() {
                    let mut expected = 0.0;
                    for &(node, weight) in functional.terms() {
                        for (unknown, w) in [
                            (2 * node as usize, weight.x),
                            (2 * node as usize + 1, weight.y),
                        ] {
                            if unknown == b[column] {
                                expected += w;
                            } else if let Some(place) = i.iter().position(|u| *u == unknown) {
                                expected += w * moved[(place, column)];
                            }
                        }
                    }
                    assert!((condensed.rows[(row, column)] - expected).abs() < 1e-11);
                }
            }
        }
    }
}
