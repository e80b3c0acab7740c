//! Stresses at the edges of the holes of a solid gear under loads on its flanks.
//!
//! Loads move the outer circle of the web ([`super::face_compliance`]), and that moves the nodes along the holes, sector by sector; the strain along their surface
//! gives the stress ([`crate::fem::surface`]).

use std::f64::consts::TAU;

use faer::c64;

use super::amplitudes::block;
use super::flank_forces::FlankForces;
use super::holed::HoledSection;
use super::{FaceCompliance, FaceComplianceSpec, PartError};
use crate::fem::surface::{Surface, SurfaceStress};
use crate::ring::solid::sector::SolidSector;
use crate::ring::solid::web::ClassRows;
use crate::run::Run;
use crate::vibration::rotation::PulledEdges;

/// The edges of the holes of a gear, by the loads on its flanks.
#[derive(Debug)]
pub struct FaceHoles {
    /// Edges of one sector.
    edges: Surface,
    classes: Vec<ClassRows>,
    sector_count: usize,
    /// Where sector 0 stands, from the centerline of tooth 0.
    phase: f64,
}

/// Response of the edges of holes to loads.
#[derive(Debug)]
pub struct HoleAnswer<'a> {
    holes: &'a FaceHoles,
    /// How the outer circle of the web moves.
    circle: Vec<f64>,
    /// The displacements of the nodes along the holes of each sector without load.
    resting: &'a [Vec<f64>],
}

impl FaceHoles {
    /// Edges of the gear of `spec`, which move by the orders up to `largest` of the outer circle of its web.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn new(spec: &FaceComplianceSpec, largest: usize, run: &Run) -> Result<Self, PartError> {
        let holed = HoledSection::new(&spec.stack(), spec.gear().section(), largest)?;
        run.check()?;
        let edges: Vec<&[u32]> = holed.grid.hole_edges.iter().map(Vec::as_slice).collect();
        let edges = Surface::new(&holed.prism(), &edges, true);
        Ok(Self {
            classes: holed.ring(&edges.nodes(), run)?.inside(run)?,
            sector_count: holed.grid.sector_count as usize,
            phase: holed.phase,
            edges,
        })
    }

    /// The edges under `loads` on the flanks of the same gear, which yield as `yields`.
    pub fn under<'a>(&'a self, yields: &FaceCompliance, loads: &[FlankForces]) -> HoleAnswer<'a> {
        let loads: Vec<_> = loads
            .iter()
            .map(|load| (load.tooth, &load.smooth[..]))
            .collect();
        HoleAnswer {
            holes: self,
            circle: yields.circle(&loads).unwrap_or_default(),
            resting: &[],
        }
    }

    /// Displacements of the holes of each sector of a gear whose edges move by `edges` without load.
    pub fn resting(&self, edges: &PulledEdges) -> Vec<Vec<f64>> {
        if edges.holes.is_empty() {
            return Vec::new();
        }
        let of_sector = |sector| {
            self.edges
                .moved_by(self.turn(sector), |place| edges.holes.at(place))
        };
        (0..self.sector_count).map(of_sector).collect()
    }

    /// The angle of `sector` from the centerline of tooth 0.
    fn turn(&self, sector: usize) -> f64 {
        self.phase + TAU / self.sector_count as f64 * sector as f64
    }

    /// The number of entries, for the size limit of the cache.
    pub fn entries(&self) -> usize {
        let rows = self
            .classes
            .iter()
            .map(|of| 2 * of.rows.nrows() * of.rows.ncols());
        rows.sum()
    }
}

impl<'a> HoleAnswer<'a> {
    /// The same with these displacements of the holes beside those of the loads, of [`FaceHoles::resting`].
    pub fn beside(self, resting: &'a [Vec<f64>]) -> Self {
        Self { resting, ..self }
    }

    /// The stresses along all edges of holes, all across the web: polar angles are those from the centerline of tooth 0.
    pub fn stresses(&self) -> Vec<SurfaceStress> {
        let holes = self.holes;
        (0..holes.sector_count)
            .flat_map(|sector| {
                let turn = holes.turn(sector);
                let stresses = holes.edges.stresses(&self.displacements(sector));
                stresses.into_iter().map(move |of| SurfaceStress {
                    angle: of.angle + turn,
                    ..of
                })
            })
            .collect()
    }

    /// The displacements of the nodes along the holes of `sector`: node by node, component by component, function by function.
    fn displacements(&self, sector: usize) -> Vec<f64> {
        let holes = self.holes;
        let nothing = || vec![0.0; holes.classes.first().map_or(0, |class| class.rows.nrows())];
        let mut moved = self.resting.get(sector).cloned().unwrap_or_else(nothing);
        for of in &holes.classes {
            let size = of.rows.ncols() / of.orders.len();
            let turn = SolidSector::part(of.class, sector, holes.sector_count);
            let columns = of.orders.iter().flat_map(|&order| {
                let seen = SolidSector::turn(order, holes.phase) * turn;
                (0..size).map(move |i| seen * self.amplitude(order, i, size))
            });
            for (j, by) in columns.enumerate() {
                for (moved, row) in moved.iter_mut().zip(of.rows.col_as_slice(j)) {
                    // Forces press into the teeth; those on the circle point outward.
                    *moved -= (row * by).re;
                }
            }
        }
        moved
    }

    /// The amplitude of the unknown `i` of an order on the circle, of either sign.
    fn amplitude(&self, order: i64, i: usize, size: usize) -> c64 {
        let n = order.unsigned_abs() as usize;
        let of = |block: usize| self.circle.get(block * size + i).copied().unwrap_or(0.0);
        match n {
            0 => c64::new(of(0), 0.0),
            _ => {
                let sine = of(block(n) + 1) * order.signum() as f64;
                c64::new(of(block(n)), -sine) * 0.5
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::assembly::{FaceResolution, MakeAll, Parts as _};
    use crate::contact::face::NormalForce;
    use crate::fem::axial::AxialBasis;
    use crate::fem::prism::Prism;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Helix, Hole, HolePattern, HoleShape, Material, SolidGear, Web};
    use crate::grid::{BlankGrid, GridLevel};
    use crate::ring::solid::web::HoledRing;

    #[test]
    #[ignore = "./test all"]
    fn a_small_hole_in_a_wide_plate_triples_the_stress_beside_it_and_presses_across() {
        let pattern = HolePattern {
            count: 5,
            circle_radius: 20e-3,
            radius: 1e-3,
            phase: 0.0,
        };
        let (radius, phase, largest) = (40e-3, 0.4, 3);
        // At its largest within 1 % on the grid that gears have, and everywhere on a fine one.
        for (level, everywhere) in [(GridLevel::Coarse, 0.1), (GridLevel::Fine, 0.015)] {
            let grid = BlankGrid::new(0.5e-3, radius, Some(&pattern), 40, 2.0, level);
            let grid = grid.expect("a usable grid");
            let axial = AxialBasis::new(&[-0.02e-3, 0.02e-3], 2);
            let prism = Prism {
                grid: &grid.grid,
                material: &Material::STEEL,
                twist: 0.0,
                axial: &axial,
            };
            let edges: Vec<&[u32]> = grid.hole_edges.iter().map(Vec::as_slice).collect();
            let edges = Surface::new(&prism, &edges, true);
            let ring = HoledRing::new(
                &grid,
                &prism,
                None,
                (largest, &edges.nodes()),
                &Run::unattended(),
            )
            .expect("sound");
            let holes = FaceHoles {
                classes: ring.inside(&Run::unattended()).expect("sound"),
                sector_count: 5,
                phase,
                edges,
            };
            // Tension σ along the direction `along`: strain on the circle, even across the plate except for its thinning.
            let (sigma, along) = (100e6, 0.9_f64);
            let (mean, apart) = (0.35 * sigma / 210e9, 0.65 * sigma / 210e9);
            let m = axial.len();
            let mut circle = vec![0.0; 3 * m * (2 * largest + 1)];
            for (z, w) in axial.rule(8) {
                for (p, f) in axial.values(z).into_iter().enumerate() {
                    let mut add = |block: usize, component: usize, u: f64| {
                        // As forces press, answers are taken with the other sign.
                        circle[(3 * block + component) * m + p] -= w * f * u;
                    };
                    let (sin, cos) = (2.0 * along).sin_cos();
                    add(0, 0, mean * radius);
                    add(block(2), 0, apart * radius * cos);
                    add(block(2) + 1, 0, apart * radius * sin);
                    add(block(2), 1, apart * radius * sin);
                    add(block(2) + 1, 1, -apart * radius * cos);
                    add(0, 2, -0.3 * sigma / 210e9 * z);
                }
            }
            let answer = HoleAnswer {
                holes: &holes,
                circle,
                resting: &[],
            };
            let stresses = answer.stresses();
            assert!(
                (most(&stresses) / (3.0 * sigma) - 1.0).abs() < 0.01,
                "{}",
                most(&stresses)
            );
            let pitch = TAU / 5.0;
            for hole in 0..5 {
                let turn = phase + pitch * f64::from(hole);
                let center = 20e-3 * crate::gear::radial(0.0);
                let of_hole = stresses
                    .iter()
                    .filter(|of| (of.angle - turn + 0.5 * pitch).rem_euclid(TAU) < pitch);
                let mut compared = 0;
                for of in of_hole {
                    let out = of.place - center;
                    let at = out.y.atan2(out.x) + turn - along;
                    // Kirsch: σ (1 − 2 cos 2θ) along the edge.
                    let expected = sigma * (1.0 - 2.0 * (2.0 * at).cos());
                    let found = of.principal[usize::from(expected < 0.0)];
                    let off = (found - expected).abs() / (3.0 * sigma);
                    assert!(off < everywhere, "{found} {expected}");
                    compared += 1;
                }
                assert!(compared > 300, "{compared}");
            }
        }
    }

    const COARSE: FaceResolution = FaceResolution {
        face_order: 4,
        web_order: 3,
        web_harmonics: 8,
        sections: crate::grid::GridLevel::Standard,
    };

    /// A gear of 30 teeth whose web with five holes stands off the middle by `offset`; one of the holes is larger by `larger`.
    pub(in crate::assembly) fn webbed(beta: f64, offset: f64, larger: f64) -> SolidGear {
        let mut data = paper_gear(30);
        data.blank.bore_radius = 8e-3;
        data.blank.web = Some(Web {
            inner_radius: 8e-3,
            outer_radius: 22e-3,
            thickness: 5e-3,
        });
        let mut holes: Vec<Hole> = HolePattern {
            count: 5,
            circle_radius: 15e-3,
            radius: 3e-3,
            phase: 0.1,
        }
        .holes();
        if larger > 0.0 {
            holes[0].shape = HoleShape::Round {
                radius: 3e-3 + larger,
            };
        }
        data.blank.holes = holes;
        SolidGear::new(data, Helix::right(beta), offset, None).expect("can be made")
    }

    /// The stresses along the holes of such a gear, or of its image where `sign` is negative.
    fn stressed(beta: f64, sign: f64, offset: f64, larger: f64) -> Vec<SurfaceStress> {
        let spec = FaceComplianceSpec::new(&webbed(sign * beta, sign * offset, larger), COARSE);
        let run = Run::unattended();
        let roots = MakeAll.face_roots(&spec.stack(), &run).expect("sound");
        let yields = MakeAll.face_compliance(&spec, &run).expect("sound");
        let holes = MakeAll.face_holes(&spec, &run).expect("sound");
        let loads = [(7, 3e-3), (8, -6e-3)].map(|(tooth, z)| {
            roots.forces(
                tooth,
                [NormalForce {
                    roll_length: 9e-3,
                    z: sign * z,
                    force: 100.0,
                }],
            )
        });
        holes
            .expect("it has holes")
            .under(&yields, &loads)
            .stresses()
    }

    fn most(of: &[SurfaceStress]) -> f64 {
        of.iter().map(SurfaceStress::von_mises).fold(0.0, f64::max)
    }

    #[test]
    #[ignore = "./test all"]
    fn holes_of_a_gear_and_of_its_image_have_equal_stresses() {
        let (right, left) = (
            stressed(0.3, 1.0, 4e-3, 0.0),
            stressed(0.3, -1.0, 4e-3, 0.0),
        );
        let largest = most(&right);
        for of in &right {
            let image = left.iter().find(|image| {
                (image.z + of.z).abs() < 1e-9
                    && (image.angle - of.angle).abs() < 1e-9
                    && (image.place - of.place).norm() < 1e-9
            });
            let image = image.expect("the image of a place is a place");
            for i in [0, 1] {
                let off = (of.principal[i] - image.principal[i]).abs();
                assert!(off < 1e-5 * largest, "{of:?} {image:?}");
            }
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn stresses_of_holes_are_equal_by_sectors_and_as_a_whole() {
        // One hole a little larger, and there are no equal sectors.
        let (sectors, whole) = (
            stressed(0.3, 1.0, 2e-3, 0.0),
            stressed(0.3, 1.0, 2e-3, 1e-6),
        );
        let (one, other) = (most(&sectors), most(&whole));
        assert!((one / other - 1.0).abs() < 0.02, "{one} {other}");
        for hole in 0..5 {
            let center = 0.1 + TAU / 5.0 * f64::from(hole);
            let ends = |all: &[SurfaceStress]| {
                let of_hole = all.iter().filter(|of| (of.angle - center).cos() > 0.9);
                of_hole.fold([0.0_f64; 2], |[high, low], of| {
                    [high.max(of.principal[0]), low.min(of.principal[1])]
                })
            };
            for (one, other) in ends(&sectors).into_iter().zip(ends(&whole)) {
                assert!((one - other).abs() < 0.03 * most(&sectors), "{one} {other}");
            }
        }
    }

    #[test]
    fn a_gear_without_holes_has_no_edges() {
        let gear = SolidGear::new(paper_gear(30), Helix::STRAIGHT, 0.0, None);
        let spec = FaceComplianceSpec::new(&gear.expect("can be made"), COARSE);
        let run = Run::unattended();
        assert!(MakeAll.face_holes(&spec, &run).expect("sound").is_none());
    }
}
