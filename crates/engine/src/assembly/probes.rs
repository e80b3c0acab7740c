//! Functionals of the inside of a gear.

use crate::fem::recovery::{Functional, edge_stresses};
use crate::gear::Material;
use crate::grid::{BlankGrid, ToothGrid};

/// Functionals of the inside of a gear.
#[derive(Debug, Clone, Default)]
pub struct Probes {
    /// Functionals of the displacements of one tooth.
    pub in_tooth: Vec<Functional>,
    /// Functionals of the displacements of sector 0 of the blank.
    pub in_blank: Vec<Functional>,
}

impl Probes {
    /// The stresses along the free edges of a gear of `material`: along the fillets of a `tooth`, that beside the loaded flank first, and around the holes of
    /// sector 0 of its `blank`.
    pub fn along_free_edges(
        tooth: &ToothGrid,
        blank: Option<&BlankGrid>,
        material: &Material,
    ) -> Self {
        let sides = [&tooth.fillet_nodes, &tooth.back_fillet_nodes];
        let along = |side: &Vec<u32>| edge_stresses(&tooth.grid, material, side, false);
        let around = |blank: &BlankGrid| -> Vec<Functional> {
            let edges = blank.hole_edges.iter();
            edges
                .flat_map(|edge| edge_stresses(&blank.grid, material, edge, true))
                .collect()
        };
        Self {
            in_tooth: sides.into_iter().flat_map(along).collect(),
            in_blank: blank.map(around).unwrap_or_default(),
        }
    }
}
