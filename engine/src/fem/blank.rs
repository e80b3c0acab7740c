//! The blank between the rigid bore and the interface circle, as a substructure.

use faer::Mat;

use super::FemError;
use super::axes::in_polar_axes;
use super::condensation::condense;
use super::cyclic::{Component, Harmonics, Sector};

use crate::gear::Material;
use crate::grid::BlankGrid;
use crate::run::Run;

/// A blank on its interface circle, its bore held.
#[derive(Debug, Clone)]
pub struct BlankSubstructure {
    /// The interface radius R_w.
    pub interface_radius: f64,
    /// The harmonics of the interface circle.
    pub harmonics: Harmonics,
    /// The stiffness on them, with hole 0 at the angle 0.
    pub stiffness: Mat<f64>,
    /// The number of equal sectors: that of the holes, or of the teeth for a solid blank.
    pub sector_count: usize,
    /// Nodes of all sectors together, the shared sides counted once.
    pub grid_nodes: usize,
}

impl BlankSubstructure {
    /// Condenses the ring of sectors `grid`.
    ///
    /// # Errors
    ///
    /// [`FemError`] if the grid is degenerate or the work is stopped.
    pub fn new(
        grid: &BlankGrid,
        interface_radius: f64,
        material: &Material,
        thickness: f64,
        harmonics: Harmonics,
        run: &Run,
    ) -> Result<Self, FemError> {
        let (right, left) = &grid.side_nodes;
        let kept: Vec<u32> = right
            .iter()
            .chain(left)
            .chain(&grid.arc_nodes)
            .copied()
            .collect();
        let schur = condense(
            "the blank",
            &grid.grid,
            material,
            thickness,
            &kept,
            &grid.bore_nodes,
        )?;
        let stiffness = in_polar_axes(
            &schur,
            kept.iter().map(|&node| grid.grid.nodes[node as usize]),
        );
        let count = grid.sector_count as usize;
        let sector = Sector {
            count,
            stiffness,
            side_nodes: right.len(),
            arc_angles: grid.arc_angles.clone(),
        };
        let stiffness = sector.ring_stiffness(&harmonics, run)?;
        let grid_nodes = count * grid.own_nodes();
        Ok(Self {
            interface_radius,
            harmonics,
            stiffness,
            sector_count: count,
            grid_nodes,
        })
    }

    /// The stiffness with hole 0 at the angle `phase`.
    pub fn stiffness_at(&self, phase: f64) -> Mat<f64> {
        if phase == 0.0 {
            self.stiffness.clone()
        } else {
            turned(&self.stiffness, &self.harmonics, phase)
        }
    }
}

/// The stiffness `k` on `harmonics` of a body turned by `phase`: Rᵀ k R with R turning each pair (a_n, b_n) by −n `phase`.
fn turned(k: &Mat<f64>, harmonics: &Harmonics, phase: f64) -> Mat<f64> {
    let mut half = k.clone();
    for _ in 0..2 {
        turn_rows(&mut half, harmonics, phase);
        half = half.transpose().to_owned();
    }
    half
}

fn turn_rows(a: &mut Mat<f64>, harmonics: &Harmonics, phase: f64) {
    for n in 1..=harmonics.largest {
        let (sin, cos) = (n as f64 * phase).sin_cos();
        for component in [Component::Radial, Component::Tangential] {
            let i = harmonics.cosine(n, component);
            for j in 0..a.ncols() {
                let (x, y) = (a[(i, j)], a[(i + 2, j)]);
                a[(i, j)] = cos * x - sin * y;
                a[(i + 2, j)] = sin * x + cos * y;
            }
        }
    }
}
