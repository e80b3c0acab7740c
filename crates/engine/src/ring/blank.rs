//! The blank between the rigid bore, or the axis of its shaft, and the interface circle, as a substructure.

use faer::Mat;

use super::axes::{in_axes, polar_axes, rows_in_axes};
use super::cyclic::{Component, Harmonics, Sector};
use super::shaft::{OnShaft, ShaftSection, orders_of_edge};
use crate::fem::FemError;
use crate::fem::condensation::condense_with;
use crate::fem::recovery::Functional;

use crate::gear::{Core, Material};
use crate::grid::BlankGrid;
use crate::run::Run;

/// A blank on its interface circle, its bore held, or the section of its shaft in the mean.
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
        let parts = Self::with_recovery(
            grid,
            interface_radius,
            (Core::Bore, material, thickness),
            harmonics,
            &[],
            run,
        );
        Ok(parts?.0)
    }

    /// Condenses the ring of sectors `grid`, and with it the functionals `asked` of the displacements of sector 0.
    ///
    /// # Errors
    ///
    /// As [`BlankSubstructure::new`].
    pub fn with_recovery(
        grid: &BlankGrid,
        interface_radius: f64,
        (core, material, thickness): (Core, &Material, f64),
        harmonics: Harmonics,
        asked: &[Functional],
        run: &Run,
    ) -> Result<(Self, BlankRecovery), FemError> {
        let (right, left) = &grid.side_nodes;
        let (edge, held) = match core {
            Core::Bore => (&[][..], grid.bore_nodes.as_slice()),
            Core::Shaft { .. } => (grid.bore_nodes.as_slice(), &[][..]),
        };
        let kept: Vec<u32> = right
            .iter()
            .chain(left)
            .chain(&grid.arc_nodes)
            .chain(edge)
            .copied()
            .collect();
        let condensed = condense_with(
            "the blank",
            &grid.grid,
            (material, thickness),
            &kept,
            held,
            asked,
        )?;
        let axes: Vec<_> = kept
            .iter()
            .map(|&node| polar_axes(grid.grid.nodes[node as usize]))
            .collect();
        let sector = Sector {
            count: grid.sector_count as usize,
            stiffness: in_axes(&condensed.stiffness, &axes),
            side_nodes: right.len(),
            arc_angles: grid.arc_angles.clone(),
        };
        let asked_rows = rows_in_axes(&condensed.rows, &axes);
        let (stiffness, rows, edge) = match core {
            Core::Bore => {
                let rows = if asked.is_empty() {
                    Mat::zeros(0, harmonics.unknowns())
                } else {
                    sector.ring_rows(&asked_rows, &harmonics, run)?
                };
                (sector.ring_stiffness(&harmonics, run)?, rows, None)
            }
            Core::Shaft { .. } => {
                let angles: Vec<f64> = edge
                    .iter()
                    .map(|node| {
                        let point = grid.grid.nodes[*node as usize];
                        point.y.atan2(point.x)
                    })
                    .collect();
                let shaft = ShaftSection::new(material, thickness);
                let made = OnShaft::new(
                    &sector,
                    (&angles, orders_of_edge(grid)),
                    &shaft,
                    &harmonics,
                    &asked_rows,
                    run,
                )?;
                (
                    made.stiffness,
                    made.rows,
                    Some((made.edge, made.edge_moved)),
                )
            }
        };
        let recovery = BlankRecovery {
            harmonics,
            sector_count: sector.count,
            rows,
            edge,
        };
        let substructure = Self {
            interface_radius,
            harmonics,
            stiffness,
            sector_count: sector.count,
            grid_nodes: sector.count * grid.own_nodes(),
        };
        Ok((substructure, recovery))
    }

    /// The stiffness with hole 0 at the angle `hole_angle`.
    pub fn stiffness_at(&self, hole_angle: f64) -> Mat<f64> {
        if hole_angle == 0.0 {
            self.stiffness.clone()
        } else {
            turned(&self.stiffness, &self.harmonics, hole_angle)
        }
    }
}

/// What the interface circle does inside a blank: a row for each functional asked of sector 0.
#[derive(Debug, Clone)]
pub struct BlankRecovery {
    /// The harmonics of the interface circle.
    pub harmonics: Harmonics,
    /// The number of equal sectors.
    pub sector_count: usize,
    /// The functionals by the harmonics, with hole 0 at the angle 0.
    pub rows: Mat<f64>,
    /// The orders of the edge of a shaft, and how it moves by the harmonics.
    edge: Option<(Harmonics, Mat<f64>)>,
}

impl BlankRecovery {
    /// The functionals of sector `sector` for the amplitudes `q` of the interface circle in the frame of the gear, with hole
    /// 0 at the angle `hole_angle`; amplitudes beyond the harmonics of the blank do not reach them.
    pub fn values(&self, sector: usize, hole_angle: f64, q: &[f64]) -> Vec<f64> {
        let turn = std::f64::consts::TAU * sector as f64 / self.sector_count as f64;
        let seen = self
            .harmonics
            .turned(&q[..self.harmonics.unknowns()], hole_angle + turn);
        let row = |i: usize| {
            seen.iter()
                .enumerate()
                .map(|(j, q)| self.rows[(i, j)] * q)
                .sum()
        };
        (0..self.rows.nrows()).map(row).collect()
    }

    /// How the circle of the bore moves at `angles` of sector 0, outward and counter-clockwise, for the amplitudes `q` as in [`BlankRecovery::values`]: a bore
    /// stands still.
    pub fn on_bore(&self, hole_angle: f64, q: &[f64], angles: &[f64]) -> Vec<[f64; 2]> {
        let Some((orders, moved)) = &self.edge else {
            return vec![[0.0; 2]; angles.len()];
        };
        let seen = self
            .harmonics
            .turned(&q[..self.harmonics.unknowns()], hole_angle);
        let q = Mat::from_fn(seen.len(), 1, |i, _| seen[i]);
        let at = orders.on_circle(angles) * (moved * q);
        (0..angles.len())
            .map(|i| [at[(2 * i, 0)], at[(2 * i + 1, 0)]])
            .collect()
    }
}

/// The stiffness `k` on `harmonics` of a body turned by `hole_angle`: Rᵀ k R with R turning each pair (a_n, b_n) by −n `hole_angle`.
fn turned(k: &Mat<f64>, harmonics: &Harmonics, hole_angle: f64) -> Mat<f64> {
    let mut half = k.clone();
    for _ in 0..2 {
        turn_rows(&mut half, harmonics, hole_angle);
        half = half.transpose().to_owned();
    }
    half
}

fn turn_rows(a: &mut Mat<f64>, harmonics: &Harmonics, hole_angle: f64) {
    for n in 1..=harmonics.largest {
        let (sin, cos) = (n as f64 * hole_angle).sin_cos();
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
