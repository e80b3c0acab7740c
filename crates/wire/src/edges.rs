//! The edges of both gears under load at one mesh position, for pages that draw how they deform.

use std::collections::{HashMap, HashSet};

use meshwright_engine::analysis::fields::{Fields, GearField};

use super::declare::document;
use super::units::{rounded_json, significant, to_mm, to_mpa, to_um};

/// Significant digits of a place, and of the values there: more than a drawing shows at any scale.
const DIGITS: (usize, usize) = (6, 4);

/// A point or a displacement.
type Plane = [f64; 2];

document! {
    /// Where both gears end, how far their edges move under load and how stressed they are. The driving axis is the origin, the driven one
    /// lies on the x axis, and both gears stand as at this mesh position without load.
    pub struct LoadedEdges as LoadedEdges, "Edges under load"
    answer of (fields: &Fields, output_torque_n_m: f64, mesh_position: f64) with {
        let [driving, driven] = &fields.gears;
    } {
        /// The mesh position in mesh periods.
        mesh_position: f64 = mesh_position,
        /// The output torque, in N m.
        output_torque_n_m: f64 = output_torque_n_m,
        /// The static transmission error, in um: turned back by it about its axis, the driven gear touches the driving one.
        transmission_error_um: f64 = significant(to_um(fields.transmission_error), DIGITS.0),
        /// Gear 1.
        driving: GearEdges = GearEdges::of(driving),
        /// Gear 2.
        driven: GearEdges = GearEdges::of(driven),
    }
}

document! {
    /// The edges of one gear.
    pub struct GearEdges as GearEdges, "Edges of a gear" answer of (field: &GearField) with {
        let (closed, open): (Vec<_>, Vec<_>) =
            chains(&field.edges).into_iter().partition(|chain| chain.first() == chain.last());
    } {
        /// The edge around the teeth, counter-clockwise, in a piece for each tooth; only the corners of elements.
        // Flanks are divided so finely that their corners are enough.
        teeth: Vec<Edge> = open
            .iter()
            .map(|chain| Edge::of(field, chain.iter().step_by(2).copied().collect()))
            .collect(),
        /// The edges of the holes and of the bore, closed; the bore is missing where the blank has no grid of its own.
        openings: Vec<Edge> = closed.into_iter().map(|chain| Edge::of(field, chain)).collect(),
    }
}

document! {
    /// An edge, node by node with the material on its left.
    pub struct Edge as Edge, "Edge" answer of (field: &GearField, nodes: Vec<u32>) with {
        let nodes = || nodes.iter().map(|node| *node as usize);
        let rounded = |value: f64| significant(value, DIGITS.1);
        let placed = |value: f64| significant(to_mm(value), DIGITS.0);
    } {
        /// Where its nodes lie before loading, in mm.
        #[schema(value_type = Vec<Vec<f64>>)]
        at_mm: Vec<Plane> = nodes()
            .map(|i| field.nodes[i])
            .map(|at| [at.x, at.y].map(placed))
            .collect(),
        /// How far each moves against the hub of its gear, in um.
        #[schema(value_type = Vec<Vec<f64>>)]
        displacement_um: Vec<Plane> = nodes()
            .map(|i| field.displacements[i])
            .map(|moved| [moved.x, moved.y].map(to_um).map(rounded))
            .collect(),
        /// The von Mises stress at each, in MPa. Near a contact it is that of the grid, which does not resolve the pressure.
        von_mises_mpa: Vec<f64> = nodes().map(|i| rounded(to_mpa(field.von_mises[i]))).collect(),
    }
}

impl LoadedEdges {
    /// The document, rounded as results are.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, which no solution has.
    pub fn to_json(&self) -> serde_json::Result<String> {
        rounded_json(self)
    }
}

/// Edges joined where one begins at the node at which another ends; a closed chain has its first node at its end too.
fn chains(edges: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let ends: HashSet<u32> = edges.iter().map(|edge| edge[2]).collect();
    let mut from: HashMap<u32, [u32; 3]> = edges.iter().map(|edge| (edge[0], *edge)).collect();
    // Edges that begin where no other ends come first; the rest are rings.
    let (begins, rest): (Vec<u32>, Vec<u32>) = edges
        .iter()
        .map(|edge| edge[0])
        .partition(|node| !ends.contains(node));
    let mut chains = Vec::new();
    for first in begins.into_iter().chain(rest) {
        let mut chain = Vec::new();
        let mut node = first;
        while let Some([_, middle, to]) = from.remove(&node) {
            chain.extend([node, middle]);
            node = to;
        }
        if !chain.is_empty() {
            chain.push(node);
            chains.push(chain);
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_joined_to_open_chains_and_to_rings() {
        let edges = [[4, 5, 6], [0, 1, 2], [10, 11, 12], [2, 3, 4], [12, 13, 10]];
        let joined = chains(&edges);
        assert_eq!(
            joined,
            [vec![0, 1, 2, 3, 4, 5, 6], vec![10, 11, 12, 13, 10]]
        );
    }
}
