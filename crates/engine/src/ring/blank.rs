//! The blank between the bore, or the axis of its shaft, and the interface circle, as a substructure.

use faer::Mat;

use super::axes::{in_axes, polar_axes, rows_in_axes};
use super::cyclic::{Component, Harmonics, Sector};
use super::shaft::{EdgeCore, EdgeLoads, OnShaft, ShaftSection, orders_of_edge};
use crate::fem::FemError;
use crate::fem::condensation::condense;
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

/// Support of a blank's bore.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Hold {
    /// A rigid hub.
    Rigid,
    /// Only its mean rotation and displacement are held: its edge is free of traction.
    Free,
    /// A solid shaft of the same material, in one piece with the blank.
    Shaft,
}

impl From<Core> for Hold {
    fn from(core: Core) -> Self {
        match core {
            Core::Bore => Self::Rigid,
            Core::Shaft { .. } => Self::Shaft,
        }
    }
}

/// A load that is the same in all sectors of a blank.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankLoad {
    /// The forces on the nodes of sector 0, by the work that they do.
    pub forces: Functional,
    /// By how much the free shaft is larger in radius than the bore, in meters; of [`Hold::Shaft`].
    pub swelling: f64,
}

/// Response of a blank whose interface circle is held to loads, with hole 0 at the angle 0.
#[derive(Debug, Clone)]
pub struct BlankLoads {
    /// The forces that they exert on the harmonics of that circle, a load a column.
    pub forces: Mat<f64>,
    /// Functionals of sector 0: one functional a row, one load a column.
    pub values: Mat<f64>,
    /// How far the bore moves outward in the mean, under each load.
    pub bore: Vec<f64>,
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
        let plate = (material, thickness);
        let plain = (core.into(), plate, harmonics);
        let (blank, recovery, _) = Self::loaded(grid, interface_radius, plain, asked, &[], run)?;
        Ok((blank, recovery))
    }

    /// Condenses the ring of sectors `grid`, whose bore `hold` holds, the functionals `asked` of sector 0, and `loads` inside it.
    ///
    /// # Errors
    ///
    /// As [`BlankSubstructure::new`].
    pub fn loaded(
        grid: &BlankGrid,
        interface_radius: f64,
        (hold, (material, thickness), harmonics): (Hold, (&Material, f64), Harmonics),
        asked: &[Functional],
        loads: &[BlankLoad],
        run: &Run,
    ) -> Result<(Self, BlankRecovery, BlankLoads), FemError> {
        let (right, left) = &grid.side_nodes;
        let (edge, held) = match hold {
            Hold::Rigid => (&[][..], grid.bore_nodes.as_slice()),
            Hold::Free | Hold::Shaft => (grid.bore_nodes.as_slice(), &[][..]),
        };
        let kept: Vec<u32> = right
            .iter()
            .chain(left)
            .chain(&grid.arc_nodes)
            .chain(edge)
            .copied()
            .collect();
        let forces: Vec<Functional> = loads.iter().map(|load| load.forces.clone()).collect();
        let condensed = condense(
            "the blank",
            &grid.grid,
            (material, thickness),
            (&kept, held),
            asked,
            &forces,
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
        let forces = rows_in_axes(&condensed.loads, &axes);
        let mut values = condensed.under_loads;
        if !loads.is_empty() {
            values += sector.under_equal_loads(&asked_rows, &forces, run)?;
        }
        let core = match hold {
            Hold::Rigid => None,
            Hold::Free => Some(EdgeCore::free(material, thickness)),
            Hold::Shaft => Some(EdgeCore::Shaft(ShaftSection::new(material, thickness))),
        };
        let (stiffness, rows, edge, on_circle, bore) = match core {
            None => {
                let on_circle = |rows: &Mat<f64>| {
                    if rows.nrows() == 0 {
                        Ok(Mat::zeros(0, harmonics.unknowns()))
                    } else {
                        sector.ring_rows(rows, &harmonics, run)
                    }
                };
                let rows = on_circle(&asked_rows)?;
                let forces = on_circle(&forces)?;
                let forces = harmonics.of_all_sectors(forces.as_ref(), sector.count);
                let stiffness = sector.ring_stiffness(&harmonics, run)?;
                (stiffness, rows, None, forces, vec![0.0; loads.len()])
            }
            Some(core) => {
                let angles: Vec<f64> = edge
                    .iter()
                    .map(|node| {
                        let point = grid.grid.nodes[*node as usize];
                        point.y.atan2(point.x)
                    })
                    .collect();
                let swelling: Vec<f64> = loads.iter().map(|load| load.swelling).collect();
                let made = OnShaft::new(
                    &sector,
                    (&angles, orders_of_edge(grid)),
                    &core,
                    &harmonics,
                    &asked_rows,
                    &EdgeLoads {
                        forces: &forces,
                        swelling: &swelling,
                    },
                    run,
                )?;
                values += made.under_loads;
                let outward = made.edge.cosine(0, Component::Radial);
                let moved = made.edge_under_loads;
                let bore = (0..loads.len()).map(|load| moved[(outward, load)]);
                let bore = bore.collect();
                let edge = Some((made.edge, made.edge_moved));
                (made.stiffness, made.rows, edge, made.forces, bore)
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
        let under_loads = BlankLoads {
            forces: on_circle,
            values,
            bore,
        };
        Ok((substructure, recovery, under_loads))
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

/// Motion inside a blank by the interface circle: a row for each functional of sector 0.
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

    /// How far the circle of the bore moves outward in the mean for the amplitudes `q` as in [`BlankRecovery::values`].
    pub fn bore_outward(&self, hole_angle: f64, q: &[f64]) -> f64 {
        self.edge.as_ref().map_or(0.0, |(orders, moved)| {
            let seen = self
                .harmonics
                .turned(&q[..self.harmonics.unknowns()], hole_angle);
            let outward = orders.cosine(0, Component::Radial);
            let terms = seen.iter().enumerate();
            terms.map(|(j, q)| moved[(outward, j)] * q).sum()
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::centrifugal::centrifugal;
    use crate::fem::dense::Cholesky;
    use crate::fem::recovery::edge_stresses;
    use crate::gear::HolePattern;
    use crate::grid::GridLevel;

    const BORE: f64 = 16e-3;
    const RIM: f64 = 45e-3;
    const WIDTH: f64 = 20e-3;

    /// A blank on `grid` under its rotation and under a shaft that is larger by one meter: how its rim and its bore move outward in the mean, and how sector
    /// 0 is stressed along its bore, a row a load.
    fn answers(grid: &BlankGrid, hold: Hold) -> Vec<([f64; 2], Vec<f64>)> {
        let (steel, run) = (&Material::STEEL, Run::unattended());
        let is_closed = grid.side_nodes.0.is_empty();
        let asked = edge_stresses(&grid.grid, steel, &grid.bore_nodes, is_closed);
        let disc = (1.0 - 0.3) * steel.density * BORE.powi(3) / (4.0 * steel.youngs_modulus);
        let loads = [
            BlankLoad {
                forces: centrifugal(&grid.grid, steel, WIDTH),
                swelling: disc,
            },
            BlankLoad {
                forces: Functional::new(Vec::new()),
                swelling: 1.0,
            },
        ];
        let orders = Harmonics { largest: 40 };
        let plate = (hold, (steel, WIDTH), orders);
        let made = BlankSubstructure::loaded(grid, RIM, plate, &asked, &loads, &run);
        let (blank, recovery, under) = made.expect("a stiff ring");
        let factor = Cholesky::new(blank.stiffness).expect("held");
        let answer = |load: usize| {
            let mut moved = under.forces.subcols(load, 1).to_owned();
            factor.solve_in_place(moved.as_mut());
            let q = moved.col_as_slice(0);
            let outward = q[orders.cosine(0, Component::Radial)];
            let bore = under.bore[load] + recovery.bore_outward(0.0, q);
            let along = recovery.values(0, 0.0, q);
            let along = along.iter().zip(under.values.col_as_slice(load));
            ([outward, bore], along.map(|(a, b)| a + b).collect())
        };
        (0..2).map(answer).collect()
    }

    fn annulus(level: GridLevel) -> BlankGrid {
        BlankGrid::new(BORE, RIM, None, 50, 4.0, level).expect("a ring")
    }

    #[test]
    fn a_rotating_annulus_grows_and_is_stressed_as_its_closed_form_says() {
        // Timoshenko and Goodier, Theory of Elasticity, article 32, for ω² = 1; to 1e-4.
        let (e, nu, rho) = (210e9, 0.3, 7850.0);
        let (a, b) = (BORE, RIM);
        let u = |r: f64| {
            let even = (3.0 + nu) * (1.0 - nu) * (a * a + b * b);
            let core = (1.0 + nu) * (3.0 + nu) * a * a * b * b / (r * r);
            rho / (8.0 * e) * r * (even + core - (1.0 - nu * nu) * r * r)
        };
        let hoop = rho / 4.0 * ((3.0 + nu) * b * b + (1.0 - nu) * a * a);
        for level in [GridLevel::Coarse, GridLevel::Standard] {
            let (moved, along) = answers(&annulus(level), Hold::Free).swap_remove(0);
            assert!((moved[0] / u(b) - 1.0).abs() < 1e-4, "{moved:?}");
            assert!((moved[1] / u(a) - 1.0).abs() < 1e-4, "{moved:?}");
            // Between its ends; quadratic elements have stresses to half a percent on the coarse level.
            for stress in &along[1..along.len() - 1] {
                assert!((stress / hoop - 1.0).abs() < 5e-3, "{stress} {hoop}");
            }
        }
        // Held at the bore: u = A r + B/r − (1 − ν²) ρ r³/(8 E), nothing at a, and without traction at b.
        let force = (1.0 - nu * nu) * rho / (8.0 * e);
        let traction = (3.0 + nu) * force * b * b;
        let ratio = (1.0 + nu) + (1.0 - nu) * a * a / (b * b);
        let even = (traction + (1.0 - nu) * force * a.powi(4) / (b * b)) / ratio;
        let core = a * a * (force * a * a - even);
        let expected = even * b + core / b - force * b.powi(3);
        let (moved, _) = answers(&annulus(GridLevel::Standard), Hold::Rigid).swap_remove(0);
        assert!(
            (moved[0] / expected - 1.0).abs() < 1e-4,
            "{moved:?} {expected}"
        );
        assert_eq!(moved[1], 0.0);
    }

    #[test]
    fn a_shaft_that_is_too_large_presses_as_lame_says_and_a_rotating_one_lets_go() {
        // p = E g/(2 a) (1 − a²/b²) of a solid shaft of the same material, for g = 1; to 1e-4.
        let (e, nu, rho) = (210e9, 0.3, 7850.0);
        let (a, b) = (BORE, RIM);
        let pressure = e / (2.0 * a) * (1.0 - a * a / (b * b));
        let outward = 2.0 * pressure * a * a * b / (e * (b * b - a * a));
        let hoop = pressure * (b * b + a * a) / (b * b - a * a);
        let found = answers(&annulus(GridLevel::Standard), Hold::Shaft);
        let (moved, along) = &found[1];
        assert!(
            (moved[0] / outward - 1.0).abs() < 1e-4,
            "{moved:?} {outward}"
        );
        let found_pressure = e / (1.0 - nu) / a * (1.0 - moved[1]);
        assert!(
            (found_pressure / pressure - 1.0).abs() < 1e-4,
            "{found_pressure} {pressure}"
        );
        // The strain along the edge is (σ − ν σ_r)/E, with σ_r = −p.
        for stress in along {
            let stress = stress - nu * pressure;
            assert!((stress / hoop - 1.0).abs() < 5e-3, "{stress} {hoop}");
        }
        // In one piece with its shaft it grows as a disc: u = (1 − ν) ρ b³/(4 E).
        let (moved, _) = &found[0];
        let disc = (1.0 - nu) * rho * b.powi(3) / (4.0 * e);
        assert!((moved[0] / disc - 1.0).abs() < 1e-4, "{moved:?} {disc}");
    }

    #[test]
    fn a_holed_blank_that_rotates_is_the_same_by_sectors_and_as_a_whole() {
        let holes = HolePattern {
            count: 5,
            circle_radius: 30e-3,
            radius: 7e-3,
            phase: 0.0,
        };
        let grid = BlankGrid::new(BORE, RIM, Some(&holes), 40, 4.0, GridLevel::Coarse);
        let grid = grid.expect("a sector");
        for hold in [Hold::Rigid, Hold::Free, Hold::Shaft] {
            let [by_sector, whole] = [&grid, &grid.unrolled()].map(|grid| answers(grid, hold));
            for ((moved, along), (expected, whole)) in by_sector.iter().zip(&whole) {
                for (one, other) in moved.iter().zip(expected) {
                    assert!(
                        (one - other).abs() <= 1e-8 * other.abs(),
                        "{hold:?}: {one} {other}"
                    );
                }
                // Inside the sector the nodes of both are the same.
                for (one, other) in along.iter().zip(whole).skip(1).take(along.len() - 2) {
                    assert!(
                        (one - other).abs() <= 1e-7 * other.abs(),
                        "{hold:?}: {one} {other}"
                    );
                }
            }
        }
    }
}
