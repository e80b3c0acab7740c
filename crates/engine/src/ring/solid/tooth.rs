//! One tooth with an extent along the axis, as a substructure.

use faer::Mat;

use crate::fem::axial::AxialBasis;
use crate::fem::body::Body as _;
use crate::fem::condensation::{Condensed, Rows, condense};
use crate::fem::prism::Prism;
use crate::fem::recovery::Functional;
use crate::fem::{FemError, Interface};
use crate::gear::{Involute, SolidGear, radial, tangential};
use crate::grid::ToothGrid;
use crate::ring::sector::{Arc, Sector};

/// A tooth and its part of the rim divided into elements: a sector of the section of a gear, times functions along the axis.
#[derive(Debug, Clone)]
pub struct DividedTooth {
    gear: SolidGear,
    /// The sector.
    pub grid: ToothGrid,
    /// The functions.
    pub axial: AxialBasis,
}

/// A tooth and its part of the rim, condensed to its interface, with the normal displacements of its loaded flank.
///
/// Displacements and loads of the flank stand node by node, from the form point to the tip corner, function by function.
#[derive(Debug, Clone)]
pub struct SolidTooth {
    /// The sector on its interface.
    pub sector: Sector,
    /// The normal displacements of the flank by those of the interface.
    pub rows: Mat<f64>,
    /// The compliance of the flank with the interface held, in m/N.
    pub held: Mat<f64>,
    /// The roll length of each flank node, rising.
    pub roll_lengths: Vec<f64>,
    /// The nodes of its section.
    pub grid_nodes: usize,
}

impl DividedTooth {
    /// The sector `grid` of the section of `gear`, times the functions `axial`.
    pub fn new(gear: &SolidGear, grid: ToothGrid, axial: &AxialBasis) -> Self {
        Self {
            gear: gear.clone(),
            grid,
            axial: axial.clone(),
        }
    }

    /// It as a prism.
    pub fn prism(&self) -> Prism<'_> {
        Prism {
            grid: &self.grid.grid,
            material: self.gear.section().material(),
            twist: self.gear.twist(),
            axial: &self.axial,
        }
    }

    /// Its loaded flank.
    pub fn flank(&self) -> &Involute {
        self.gear.section().flank()
    }

    /// Its unknowns with its arc held.
    pub fn free_unknowns(&self) -> u64 {
        let nodes = self.grid.grid.nodes.len() - self.grid.arc_nodes.len();
        (self.prism().unknowns_of_node() * nodes) as u64
    }

    /// It on its interface.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate.
    pub fn condensed(&self) -> Result<Condensed, FemError> {
        let interface = Interface {
            kept: &self.grid.interface(),
            ..Default::default()
        };
        condense("the tooth", &self.prism(), &interface)
    }

    /// It as a substructure, `condensed` to its interface, and how `nodes` move.
    pub fn substructure(&self, condensed: &Condensed, nodes: &[u32]) -> (SolidTooth, Rows) {
        let [on_flank, on_nodes] = self.rows(condensed, nodes);
        let tooth = SolidTooth {
            sector: Sector {
                count: self.gear.section().tooth_count() as usize,
                size: self.prism().unknowns_of_node(),
                stiffness: condensed.stiffness(),
                side_nodes: self.grid.side_nodes.0.len(),
                arcs: vec![Arc::Nodes(self.grid.arc_angles.clone(), usize::MAX)],
            },
            rows: on_flank.by_kept,
            held: on_flank.by_forces,
            roll_lengths: self.grid.flank_roll_lengths.clone(),
            grid_nodes: self.grid.grid.nodes.len(),
        };
        (tooth, on_nodes)
    }

    /// The compliance of the loaded flank with the sides of the sector free and its arc held, and how `nodes` move by the same forces.
    ///
    /// # Errors
    ///
    /// As [`DividedTooth::condensed`].
    pub fn alone(&self, nodes: &[u32]) -> Result<[Mat<f64>; 2], FemError> {
        let interface = Interface {
            fixed: &self.grid.arc_nodes,
            ..Default::default()
        };
        let condensed = condense("the tooth", &self.prism(), &interface)?;
        Ok(self.rows(&condensed, nodes).map(|rows| rows.by_forces))
    }

    /// The normal displacements of the loaded flank, and all unknowns of `nodes`.
    fn rows(&self, condensed: &Condensed, nodes: &[u32]) -> [Rows; 2] {
        let nodes = Functional::unknowns(nodes, self.prism().unknowns_of_node());
        condensed.rows(&self.normals(), &nodes)
    }

    /// The displacement of each node of the loaded flank along its outward normal, in polar components (n cos β_b, −τ r_b cos β_b), n that of the
    /// section; for every function along the axis.
    pub fn normals(&self) -> Vec<Functional> {
        let flank = self.flank();
        let (sin, cos) = (self.gear.twist() * flank.base_radius()).atan().sin_cos();
        let nodes = self.grid.flank_nodes.iter();
        let points = nodes.zip(&self.grid.flank_roll_lengths).map(|(&node, &s)| {
            let place = self.grid.grid.nodes[node as usize];
            let angle = place.y.atan2(place.x);
            let normal = flank.normal(s) * cos;
            let along = [
                normal.dot(&radial(angle)),
                normal.dot(&tangential(angle)),
                -sin,
            ];
            (node, along)
        });
        self.prism().along(&points.collect::<Vec<_>>())
    }
}
