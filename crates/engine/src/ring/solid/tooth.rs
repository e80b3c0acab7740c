//! One tooth with an extent along the axis, as a substructure.

use faer::Mat;

use super::sector::{Arc, SolidSector};
use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::prism::{COMPONENTS, Interface, NodeRows, Prism};
use crate::gear::{SolidGear, radial, tangential};
use crate::grid::ToothGrid;

/// A tooth and its part of the rim, condensed to its interface, with the normal displacements of its loaded flank.
///
/// Displacements and loads of the flank stand node by node, from the form point to the tip corner, function by function.
#[derive(Debug, Clone)]
pub(crate) struct SolidTooth {
    /// The sector on its interface.
    pub sector: SolidSector,
    /// The normal displacements of the flank by those of the interface.
    pub rows: Mat<f64>,
    /// The compliance of the flank with the interface held, in m/N.
    pub held: Mat<f64>,
    /// The roll length of each flank node, rising.
    pub roll_lengths: Vec<f64>,
    /// The nodes of its section.
    pub grid_nodes: usize,
}

impl SolidTooth {
    /// Condenses `grid`, a sector of the section of `gear`, times the functions `axial`.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate.
    pub(crate) fn new(
        gear: &SolidGear,
        grid: &ToothGrid,
        axial: &AxialBasis,
    ) -> Result<Self, FemError> {
        let (tooth, _) = Self::with_nodes(gear, grid, axial, &[])?;
        Ok(tooth)
    }

    /// The same, and how the nodes `recovered` move, by the interface and by the flank.
    ///
    /// # Errors
    ///
    /// As [`SolidTooth::new`].
    pub(crate) fn with_nodes(
        gear: &SolidGear,
        grid: &ToothGrid,
        axial: &AxialBasis,
        recovered: &[u32],
    ) -> Result<(Self, NodeRows), FemError> {
        let section = gear.section();
        let (right, left) = &grid.side_nodes;
        let kept: Vec<u32> = [right, left, &grid.arc_nodes]
            .into_iter()
            .flatten()
            .copied()
            .collect();
        let prism = Prism {
            grid: &grid.grid,
            material: section.material(),
            twist: gear.twist(),
            axial,
        };
        let points = flank_normals(gear, grid);
        let interface = Interface {
            kept: &kept,
            ..Default::default()
        };
        let (condensed, rows) = prism.condense("the tooth", &interface, &points, recovered)?;
        let tooth = Self {
            sector: SolidSector {
                count: section.tooth_count() as usize,
                size: prism.unknowns_of_node(),
                stiffness: condensed.stiffness,
                side_nodes: right.len(),
                arcs: vec![Arc::Nodes(grid.arc_angles.clone())],
            },
            rows: condensed.rows,
            held: condensed.held,
            roll_lengths: grid.flank_roll_lengths.clone(),
            grid_nodes: grid.grid.nodes.len(),
        };
        Ok((tooth, rows))
    }
}

/// The compliance of the loaded flank of `grid` with the sides of the sector free and its arc held, and how the nodes `recovered` move.
///
/// # Errors
///
/// [`FemError`] if the grid is degenerate.
pub(crate) fn flank_compliance_alone(
    gear: &SolidGear,
    grid: &ToothGrid,
    axial: &AxialBasis,
    recovered: &[u32],
) -> Result<(Mat<f64>, NodeRows), FemError> {
    let prism = Prism {
        grid: &grid.grid,
        material: gear.section().material(),
        twist: gear.twist(),
        axial,
    };
    let points = flank_normals(gear, grid);
    let interface = Interface {
        fixed: &grid.arc_nodes,
        ..Default::default()
    };
    let (condensed, rows) = prism.condense("the tooth", &interface, &points, recovered)?;
    Ok((condensed.held, rows))
}

/// The nodes of the loaded flank with their outward normals in polar components: (n cos β_b, −τ r_b cos β_b), n that of the section.
pub(crate) fn flank_normals(gear: &SolidGear, grid: &ToothGrid) -> Vec<(u32, [f64; COMPONENTS])> {
    let flank = gear.section().flank();
    let (sin, cos) = (gear.twist() * flank.base_radius()).atan().sin_cos();
    let nodes = grid.flank_nodes.iter().zip(&grid.flank_roll_lengths);
    nodes
        .map(|(&node, &s)| {
            let place = grid.grid.nodes[node as usize];
            let angle = place.y.atan2(place.x);
            let normal = flank.normal(s) * cos;
            let along = [
                normal.dot(&radial(angle)),
                normal.dot(&tangential(angle)),
                -sin,
            ];
            (node, along)
        })
        .collect()
}
