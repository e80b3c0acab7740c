//! One tooth as a substructure.

use faer::Mat;

use super::axes::{in_axes, polar_axes, rows_in_axes};
use super::cyclic::Sector;
use super::modes::compress;
use crate::fem::FemError;
use crate::fem::condensation::condense;
use crate::fem::dense::{Cholesky, mirror_lower, symmetrize};
use crate::fem::recovery::Functional;
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

/// Loads inside a tooth, with its interface held.
#[derive(Debug, Clone)]
pub struct ToothLoads {
    /// How they move the unknowns of the flank, a load a column.
    pub(super) flank: Mat<f64>,
    /// Values of the functionals under them: one functional a row, one load a column.
    pub(super) values: Mat<f64>,
    /// The forces that they exert on the interface (right side, left side, arc) in polar components, with the flank free: a load a row.
    pub(super) on_interface: Mat<f64>,
}

impl ToothSubstructure {
    /// Condenses `grid`, a sector of `gear`.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate.
    pub fn new(gear: &SpurGear, grid: &ToothGrid) -> Result<Self, FemError> {
        Ok(Self::with_recovery(gear, grid, &[])?.0)
    }

    /// Condenses `grid`, a sector of `gear`, and with it the functionals `asked` of its displacements.
    ///
    /// # Errors
    ///
    /// As [`ToothSubstructure::new`].
    pub fn with_recovery(
        gear: &SpurGear,
        grid: &ToothGrid,
        asked: &[Functional],
    ) -> Result<(Self, ToothRows), FemError> {
        let (tooth, rows, _) = Self::loaded(gear, grid, asked, &[])?;
        Ok((tooth, rows))
    }

    /// Condenses `grid`, a sector of `gear`, the functionals `asked`, and `loads` inside the tooth, given by the work that they do.
    ///
    /// # Errors
    ///
    /// As [`ToothSubstructure::new`].
    pub fn loaded(
        gear: &SpurGear,
        grid: &ToothGrid,
        asked: &[Functional],
        loads: &[Functional],
    ) -> Result<(Self, ToothRows, ToothLoads), FemError> {
        let (right, left) = &grid.side_nodes;
        let kept: Vec<u32> = grid
            .flank_nodes
            .iter()
            .chain(right)
            .chain(left)
            .chain(&grid.arc_nodes)
            .copied()
            .collect();
        let condensed = condense(
            "the tooth",
            &grid.grid,
            (gear.material(), gear.face_width()),
            (&kept, &[]),
            asked,
            loads,
        )?;

        // Components: normal and towards the tip on the flank, polar elsewhere.
        let flank = gear.flank();
        let axes: Vec<[Vector; 2]> = grid
            .flank_roll_lengths
            .iter()
            .map(|&s| [flank.normal(s), radial(flank.tangent_angle(s))])
            .chain(
                kept[grid.flank_nodes.len()..]
                    .iter()
                    .map(|&node| polar_axes(grid.grid.nodes[node as usize])),
            )
            .collect();
        let schur = in_axes(&condensed.stiffness, &axes);
        let rows = rows_in_axes(&condensed.rows, &axes);
        let forces = rows_in_axes(&condensed.loads, &axes);

        let f = 2 * grid.flank_nodes.len();
        let b = schur.nrows() - f;
        let failure = FemError::NotPositiveDefinite {
            part: "the flank",
            unknowns: f,
        };
        let flank_factor = Cholesky::new(schur.submatrix(0, 0, f, f).to_owned()).ok_or(failure)?;
        let mut fixed_compliance = Mat::<f64>::identity(f, f);
        flank_factor.solve_in_place(fixed_compliance.as_mut());
        symmetrize(&mut fixed_compliance);

        // With a unit displacement of the interface the flank follows by Ψ = −S_ff⁻¹ S_fb.
        let coupling = schur.submatrix(0, f, f, b);
        let mut half = coupling.to_owned();
        flank_factor.half_solve_in_place(half.as_mut());
        let mut stiffness = schur.submatrix(f, f, b, b).to_owned();
        stiffness -= half.transpose() * &half;
        mirror_lower(&mut stiffness);
        flank_factor.other_half_solve_in_place(half.as_mut());
        // u_f = H_0 p + Ψ u_b.
        let on_flank = rows.subcols(0, f);
        let pulled = forces.subcols(0, f);
        let moved = &fixed_compliance * pulled.transpose();
        let loads = ToothLoads {
            values: condensed.under_loads + on_flank * &moved,
            flank: moved,
            on_interface: forces.subcols(f, b).to_owned() - pulled * &half,
        };
        let rows = ToothRows {
            by_flank: on_flank * &fixed_compliance,
            by_interface: rows.subcols(f, b).to_owned() - on_flank * &half,
        };
        let (modes, mode_forces) = compress(&(-half)).ok_or(FemError::NotPositiveDefinite {
            part: "the flank's modes",
            unknowns: b,
        })?;

        let sector = Sector {
            count: gear.tooth_count() as usize,
            stiffness,
            side_nodes: right.len(),
            arc_angles: grid.arc_angles.clone(),
        };
        let tooth = Self {
            fixed_compliance,
            modes,
            roll_lengths: grid.flank_roll_lengths.clone(),
            flank_points: grid
                .flank_nodes
                .iter()
                .map(|&node| grid.grid.nodes[node as usize])
                .collect(),
            grid_nodes: grid.grid.nodes.len(),
            mode_forces,
            sector,
        };
        Ok((tooth, rows, loads))
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

/// Vᵀ p: the forces `flank_forces` on the flank's unknowns in terms of the loading `modes`.
pub fn modal_loads(modes: &Mat<f64>, flank_forces: &[f64]) -> Vec<f64> {
    let shapes = modes.col_iter();
    shapes
        .map(|shape| shape.iter().zip(flank_forces).map(|(v, p)| v * p).sum())
        .collect()
}
