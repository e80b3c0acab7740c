//! Displacements of all nodes of a grid, with prescribed displacements of some.

use faer::Mat;

use super::FemError;
use super::condensation::element_stiffnesses;
use super::element::COMPONENTS;
use super::factor::Factor;
use super::prism::{Prism, TakeElement};
use super::sparse::{BlockMatrix, Numbering, by_entries};
use crate::gear::{Material, Vector};
use crate::grid::Grid;

/// Loads that go through the factor together.
const AT_ONCE: usize = 16;

/// Loads and prescribed displacements of a grid.
#[derive(Debug, Clone, Default)]
pub struct Load {
    /// How the moved nodes are moved, in meters: node by node, all unknowns of each.
    pub moves: Vec<f64>,
    /// Forces in N on nodes that are free, one on each unknown.
    pub forces: Vec<(u32, Vec<f64>)>,
}

/// The displacements of all nodes of `grid`, a plate in its plane, under each of `loads`, which say how the nodes `moved` move.
///
/// `thickness`, in meters, is that of an element whose own is 1.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`] if the grid is degenerate, or the prescribed nodes do not hold it.
pub fn displacements(
    part: &'static str,
    grid: &Grid,
    (material, thickness): (&Material, f64),
    moved: &[u32],
    loads: &[Load],
) -> Result<Vec<Vec<Vector>>, FemError> {
    let each = |take: &mut TakeElement<'_>| {
        let stiffnesses = element_stiffnesses(grid, material, thickness);
        for (element, stiffness) in grid.elements.iter().zip(stiffnesses) {
            take(element, &by_entries(COMPONENTS, |i, j| stiffness[(i, j)]));
        }
    };
    let answers = solve(part, (grid, COMPONENTS), each, moved, loads)?;
    let vectors = |u: Vec<f64>| u.chunks_exact(2).map(Vector::from_column_slice).collect();
    Ok(answers.into_iter().map(vectors).collect())
}

impl Prism<'_> {
    /// The unknowns of all nodes under each of `loads`, which say how the nodes `moved` move.
    ///
    /// # Errors
    ///
    /// As `displacements`.
    pub fn displacements(
        &self,
        part: &'static str,
        moved: &[u32],
        loads: &[Load],
    ) -> Result<Vec<Vec<f64>>, FemError> {
        let size = self.unknowns_of_node();
        solve(
            part,
            (self.grid, size),
            |take| self.each_element(take),
            moved,
            loads,
        )
    }
}

/// The unknowns, `size` a node, under each of `loads`; `each_element` hands out every element of `grid` with its stiffness.
fn solve(
    part: &'static str,
    (grid, size): (&Grid, usize),
    each_element: impl Fn(&mut TakeElement<'_>),
    moved: &[u32],
    loads: &[Load],
) -> Result<Vec<Vec<f64>>, FemError> {
    let numbering = Numbering::new(grid.nodes.len(), &[], moved);
    let mut places = vec![usize::MAX; grid.nodes.len()];
    for (place, node) in moved.iter().enumerate() {
        places[*node as usize] = place;
    }
    let mut matrix = BlockMatrix::new(size, &grid.elements, &numbering);
    // The elements that reach a moved node pull at the free ones.
    let mut pulls = Mat::<f64>::zeros(size * numbering.count, loads.len());
    let mut between = vec![0.0; size * size];
    each_element(&mut |element, fill| {
        matrix.add(element, fill, &numbering);
        for (b, node) in element.nodes().iter().enumerate() {
            let moved = places[*node as usize];
            if moved == usize::MAX {
                continue;
            }
            for (a, node) in element.nodes().iter().enumerate() {
                let Some(place) = numbering.place(*node) else {
                    continue;
                };
                fill([a, b], &mut between);
                for (d, column) in between.chunks_exact(size).enumerate() {
                    for (c, stiffness) in column.iter().enumerate() {
                        for (j, load) in loads.iter().enumerate() {
                            pulls[(size * place + c, j)] -=
                                stiffness * load.moves[size * moved + d];
                        }
                    }
                }
            }
        }
    });
    for (j, load) in loads.iter().enumerate() {
        for (node, forces) in &load.forces {
            if let Some(place) = numbering.place(*node) {
                for (c, force) in forces.iter().enumerate() {
                    pulls[(size * place + c, j)] += force;
                }
            }
        }
    }
    let factor = Factor::new(part, matrix, &numbering)?;

    let mut answers = Vec::with_capacity(loads.len());
    for (part, loads) in loads.chunks(AT_ONCE).enumerate() {
        let mut columns = pulls.subcols(part * AT_ONCE, loads.len()).to_owned();
        factor.solve_in_place(&mut columns);
        for (j, load) in loads.iter().enumerate() {
            let of_node = |node: usize| match numbering.place(node as u32) {
                Some(place) => &columns.col_as_slice(j)[size * place..][..size],
                None => &load.moves[size * places[node]..][..size],
            };
            answers.push((0..grid.nodes.len()).flat_map(of_node).copied().collect());
        }
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::condensation::condense;
    use crate::fem::condensation::tests::patch;

    #[test]
    fn a_grid_whose_boundary_moves_by_a_linear_field_follows_it_inside() {
        let grid = patch();
        let field = |p: &Vector| Vector::new(1e-3 * p.x + 2e-4 * p.y, -4e-4 * p.y + 1e-4 * p.x);
        // The patch has one corner inside, and the midsides that meet there.
        let corner = |node: u32| grid.elements.iter().all(|e| e.nodes().contains(&node));
        let moved: Vec<u32> = (0..grid.nodes.len() as u32)
            .filter(|node| !corner(*node))
            .collect();
        assert_eq!(moved.len() + 1, grid.nodes.len());
        let moves = |factor: f64| Load {
            moves: moved
                .iter()
                .map(|node| factor * field(&grid.nodes[*node as usize]))
                .flat_map(|u| [u.x, u.y])
                .collect(),
            forces: Vec::new(),
        };
        let plate = (&Material::STEEL, 20e-3);
        let answers = displacements("a patch", &grid, plate, &moved, &[moves(1.0), moves(-2.0)]);
        for (answer, factor) in answers.expect("sound").iter().zip([1.0, -2.0]) {
            for (u, point) in answer.iter().zip(&grid.nodes) {
                assert!((u - factor * field(point)).norm() < 1e-17);
            }
        }
    }

    #[test]
    fn a_force_moves_a_free_node_by_the_compliance_of_the_condensed_grid() {
        let grid = patch();
        let (free, held) = (grid.elements[0].nodes()[0], grid.elements[3].nodes()[2]);
        let fixed: Vec<u32> = grid.elements[3].nodes().to_vec();
        assert!(fixed.contains(&held) && !fixed.contains(&free));
        let plate = (&Material::STEEL, 20e-3);
        let condensed = condense("a patch", &grid, plate, (&[free], &fixed), &[], &[]);
        let stiffness = condensed.expect("sound").stiffness;
        let load = Load {
            moves: vec![0.0; 2 * fixed.len()],
            forces: vec![(free, vec![300.0, -100.0])],
        };
        let u = &displacements("a patch", &grid, plate, &fixed, &[load]).expect("sound")[0]
            [free as usize];
        let force = [0, 1].map(|i| stiffness[(i, 0)] * u.x + stiffness[(i, 1)] * u.y);
        assert!((force[0] - 300.0).abs() < 1e-9 && (force[1] + 100.0).abs() < 1e-9);
    }
}
