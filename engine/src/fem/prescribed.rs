//! The displacements of every node of a grid some of whose nodes are moved as told.

use faer::Mat;

use super::FemError;
use super::condensation::element_stiffnesses;
use super::element::COMPONENTS;
use super::factor::Factor;
use super::sparse::{BlockMatrix, Numbering};
use crate::gear::{Material, Vector};
use crate::grid::Grid;

/// Loads that go through the factor together.
const AT_ONCE: usize = 16;

/// What acts on a grid.
#[derive(Debug, Clone, Default)]
pub struct Load {
    /// How each moved node is moved, in meters.
    pub moves: Vec<Vector>,
    /// Forces in N on nodes that are free.
    pub forces: Vec<(u32, Vector)>,
}

/// The displacements of all nodes of `grid` under each of `loads`, which say how the nodes `moved` move.
///
/// `thickness`, in meters, is that of an element whose own is 1.
///
/// # Errors
///
/// [`FemError::NotPositiveDefinite`] if the grid is degenerate, or what is moved does not hold it.
pub fn displacements(
    part: &'static str,
    grid: &Grid,
    (material, thickness): (&Material, f64),
    moved: &[u32],
    loads: &[Load],
) -> Result<Vec<Vec<Vector>>, FemError> {
    let numbering = Numbering::new(grid.nodes.len(), &[], moved);
    let mut places = vec![usize::MAX; grid.nodes.len()];
    for (place, node) in moved.iter().enumerate() {
        places[*node as usize] = place;
    }
    let mut matrix = BlockMatrix::new(COMPONENTS, &grid.elements, &numbering);
    // The elements that reach a moved node pull at the free ones.
    let mut reaching = Vec::new();
    let stiffnesses = element_stiffnesses(grid, material, thickness);
    for (element, stiffness) in grid.elements.iter().zip(stiffnesses) {
        matrix.add(element, |i, j| stiffness[(i, j)], &numbering);
        let mut nodes = element.nodes().iter();
        if nodes.any(|node| places[*node as usize] != usize::MAX) {
            reaching.push((element, stiffness));
        }
    }
    let factor = Factor::new(part, matrix, &numbering)?;

    let mut answers = Vec::with_capacity(loads.len());
    for loads in loads.chunks(AT_ONCE) {
        let mut columns = Mat::<f64>::zeros(2 * numbering.count, loads.len());
        for (j, load) in loads.iter().enumerate() {
            for (node, force) in &load.forces {
                if let Some(place) = numbering.place(*node) {
                    columns[(2 * place, j)] += force.x;
                    columns[(2 * place + 1, j)] += force.y;
                }
            }
            for (element, stiffness) in &reaching {
                for (b, node) in element.nodes().iter().enumerate() {
                    let Some(moves) = load.moves.get(places[*node as usize]) else {
                        continue;
                    };
                    for (a, node) in element.nodes().iter().enumerate() {
                        let Some(place) = numbering.place(*node) else {
                            continue;
                        };
                        for c in 0..2 {
                            columns[(2 * place + c, j)] -= stiffness[(2 * a + c, 2 * b)] * moves.x
                                + stiffness[(2 * a + c, 2 * b + 1)] * moves.y;
                        }
                    }
                }
            }
        }
        factor.solve_in_place(&mut columns);
        for (j, load) in loads.iter().enumerate() {
            let of_node = |node: usize| match numbering.place(node as u32) {
                Some(place) => Vector::new(columns[(2 * place, j)], columns[(2 * place + 1, j)]),
                None => load.moves[places[node]],
            };
            answers.push((0..grid.nodes.len()).map(of_node).collect());
        }
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::condensation::tests::patch;

    const STEEL: Material = Material {
        youngs_modulus: 210e9,
        poisson_ratio: 0.3,
        density: 7850.0,
    };

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
                .collect(),
            forces: Vec::new(),
        };
        let plate = (&STEEL, 20e-3);
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
        let plate = (&STEEL, 20e-3);
        let stiffness =
            crate::fem::condensation::condense("a patch", &grid, plate.0, plate.1, &[free], &fixed)
                .expect("sound");
        let load = Load {
            moves: vec![Vector::zeros(); fixed.len()],
            forces: vec![(free, Vector::new(300.0, -100.0))],
        };
        let u = &displacements("a patch", &grid, plate, &fixed, &[load]).expect("sound")[0]
            [free as usize];
        let force = [0, 1].map(|i| stiffness[(i, 0)] * u.x + stiffness[(i, 1)] * u.y);
        assert!((force[0] - 300.0).abs() < 1e-9 && (force[1] + 100.0).abs() < 1e-9);
    }
}
