//! One tooth as a substructure.

use faer::Mat;

use super::axes::{in_axes, polar_axes, rows_in_axes};
use super::modes::compress;
use super::sector::{Arc, Sector};
use crate::fem::body::Plate;
use crate::fem::condensation::{Condensed, condense};
use crate::fem::element::COMPONENTS;
use crate::fem::recovery::Functional;
use crate::fem::{FemError, Interface};
use crate::gear::{SpurGear, Vector, radial};
use crate::grid::ToothGrid;

/// One tooth sector, condensed to its interface and its loaded flank.
///
/// Flank unknowns are the displacements along the outward normal and towards the tip, node by node from the form point to
/// the tip corner. All Z teeth of a gear share it.
#[derive(Debug, Clone)]
pub struct ToothSubstructure {
    /// The compliance H_0 of the flank with the interface fixed, in m/N.
    pub fixed_compliance: Mat<f64>,
    /// V: how each loading mode of the interface shows at the flank; Ψ = V Q.
    pub modes: Mat<f64>,
    /// Roll length of each flank node, rising.
    pub roll_lengths: Vec<f64>,
    /// Place of each flank node.
    pub flank_points: Vec<Vector>,
    /// Nodes of the sector's grid.
    pub grid_nodes: usize,
    /// Q: the forces on sides and arc that the unit modes exert.
    pub(super) mode_forces: Mat<f64>,
    /// The sector with its flank free.
    pub(super) sector: Sector,
}

/// Functionals asked of a tooth, a row each.
#[derive(Debug, Clone)]
pub struct ToothRows {
    /// By the forces on the flank's unknowns, with the interface held.
    pub by_flank: Mat<f64>,
    /// By the displacements of the interface (right side, left side, arc) in polar components, with the flank free.
    pub(super) by_interface: Mat<f64>,
}

impl ToothSubstructure {
    /// Condenses `grid`, a sector of `gear`.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate.
    pub fn new(gear: &SpurGear, grid: &ToothGrid) -> Result<Self, FemError> {
        let (tooth, _) = Self::with_recovery(gear, grid, &Self::condensed(gear, grid)?, &[])?;
        Ok(tooth)
    }

    /// Condenses `grid`, a sector of `gear`, to its sides and its arc.
    ///
    /// # Errors
    ///
    /// As [`ToothSubstructure::new`].
    pub fn condensed(gear: &SpurGear, grid: &ToothGrid) -> Result<Condensed, FemError> {
        let plate = Plate {
            grid: &grid.grid,
            material: gear.material(),
            thickness: gear.face_width(),
        };
        let interface = Interface {
            kept: &grid.interface(),
            ..Default::default()
        };
        condense("the tooth", &plate, &interface)
    }

    /// That of `grid`, a sector of `gear` that is `condensed`, and what the functionals `asked` of its displacements become.
    ///
    /// # Errors
    ///
    /// As [`ToothSubstructure::new`].
    pub fn with_recovery(
        gear: &SpurGear,
        grid: &ToothGrid,
        condensed: &Condensed,
        asked: &[Functional],
    ) -> Result<(Self, ToothRows), FemError> {
        // Components: normal and towards the tip on the flank, polar elsewhere.
        let flank = gear.flank();
        let on_flank = grid.flank_nodes.iter().zip(&grid.flank_roll_lengths);
        let on_flank: Vec<Functional> = on_flank
            .flat_map(|(&node, &s)| {
                let axes = [flank.normal(s), radial(flank.tangent_angle(s))];
                axes.map(|axis| Functional::displacement(node, axis))
            })
            .collect();
        let [on_flank, asked] = condensed.rows(&on_flank, asked);
        let place = |node: &u32| grid.grid.nodes[*node as usize];
        let axes: Vec<[Vector; 2]> = grid
            .interface()
            .iter()
            .map(|node| polar_axes(place(node)))
            .collect();
        // u_f = H_0 p + Ψ u_b.
        let follows = rows_in_axes(&on_flank.by_kept, &axes);
        let (modes, mode_forces) = compress(&follows).ok_or(FemError::NotPositiveDefinite {
            part: "the flank's modes",
            unknowns: follows.ncols(),
        })?;
        let sector = Sector {
            count: gear.tooth_count() as usize,
            stiffness: in_axes(&condensed.stiffness(), &axes),
            size: COMPONENTS,
            side_nodes: grid.side_nodes.0.len(),
            arcs: vec![Arc::Nodes(grid.arc_angles.clone(), usize::MAX)],
        };
        let tooth = Self {
            fixed_compliance: on_flank.by_forces,
            modes,
            roll_lengths: grid.flank_roll_lengths.clone(),
            flank_points: grid.flank_nodes.iter().map(place).collect(),
            grid_nodes: grid.grid.nodes.len(),
            mode_forces,
            sector,
        };
        let rows = ToothRows {
            by_flank: asked.by_forces,
            by_interface: rows_in_axes(&asked.by_kept, &axes),
        };
        Ok((tooth, rows))
    }

    /// The nodes of the sector that are not also nodes of its neighbor: all but one side, which ends on the arc.
    pub fn own_nodes(&self) -> usize {
        self.grid_nodes - self.sector.side_nodes - 1
    }

    /// The number r of loading modes.
    pub fn mode_count(&self) -> usize {
        self.modes.ncols()
    }
}

/// Vᵀ p: what the forces `flank_forces` on the flank's unknowns are on the loading `modes`.
pub fn modal_loads(modes: &Mat<f64>, flank_forces: &[f64]) -> Vec<f64> {
    let shapes = modes.col_iter();
    shapes
        .map(|shape| shape.iter().zip(flank_forces).map(|(v, p)| v * p).sum())
        .collect()
}
