//! Stresses at the roots of the teeth of a solid gear under loads on its flanks.
//!
//! Rows lead from the forces on the flanks to the displacements of the fillets, as in the plane ([`super::inside`]), and these say the
//! stress ([`crate::fem::surface`]).

use std::f64::consts::TAU;

use faer::Mat;

use super::flank_fit::{FlankFit, smoothed_rows};
use super::flank_forces::{FlankForces, PressedFlank};
use super::stack::Stack;
use super::{FaceCompliance, FaceResolution, PartError, PlainFace};
use crate::contact::face::NormalForce;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::entries;
use crate::fem::prism::Prism;
use crate::fem::surface::{Surface, SurfaceStress};
use crate::flank::polynomials::OTHER_DEGREE;
use crate::gear::{SolidGear, Vector};
use crate::grid::{GridLevel, ToothGrid};
use crate::ring::solid::gear::{interfaces, motions};
use crate::ring::solid::tooth::{SolidTooth, flank_compliance_alone};
use crate::run::Run;
use crate::vibration::rotation::PulledEdges;

/// How far from a loaded tooth, in teeth, the roots are stressed by it.
const REACH: usize = 10;

/// Places on a fillet nearer to a contact are stressed by that contact rather than by the bending of the tooth, and are left out: in the section, in modules;
/// and along the face, as a part of its width over the degree of its functions, which blur shorter distances.
pub(crate) const UNDER_CONTACT: f64 = 0.6;
const BLURRED: f64 = 1.0;

/// The roots of the teeth of a gear, by the loads on its flanks.
#[derive(Debug)]
pub struct FaceRoots {
    /// The fillets: first the one beside the loaded flank.
    fillets: Surface,
    near: Nearness,
    pressed: PressedFlank,
    tooth_count: usize,
    /// The displacements of the fillets of a tooth by the forces on the nodes of its own flank.
    own: Mat<f64>,
    /// Rows of the tooth d places counter-clockwise of a loaded one, for d from −reach to reach, by forces on the lower functions on its flank; that of d = 0
    /// is empty.
    others: Vec<Mat<f64>>,
    /// Rows of tooth 0 by forces on the outer circle of a web with holes, a column for each displacement.
    by_web: Option<Mat<f64>>,
}

/// Response of the roots to loads.
pub struct RootAnswer<'a> {
    roots: &'a FaceRoots,
    yields: Option<&'a FaceCompliance>,
    loads: &'a [FlankForces],
    on_web: Option<Vec<f64>>,
    /// The displacements of the nodes of the fillets of each tooth without load.
    resting: &'a [Vec<f64>],
}

impl FaceRoots {
    /// The roots of the gear of `stack`, whose teeth and rim yield as `plain` says.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn new(stack: &Stack, plain: &PlainFace, run: &Run) -> Result<Self, PartError> {
        let gear = &stack.gear;
        let section = gear.section().without_blank();
        let grid =
            ToothGrid::of_stressed_prism(&section, stack.interface_radius, GridLevel::Standard)?;
        run.check()?;
        let fillets = fillets(gear, &grid, &stack.face);
        let (tooth, rows) = SolidTooth::with_nodes(gear, &grid, &stack.face, &fillets.nodes())?;
        run.check()?;
        let seen = plain.web().map(|web| web.largest());
        let classes = motions(&tooth, plain.stiffness_below(), seen, run)?;
        let (sector, z, m) = (&tooth.sector, tooth.sector.count, stack.face.len());

        let by_flank = classes
            .iter()
            .map(|class| (class.class, class.orders.as_slice(), &class.by_flank));
        let own = interfaces(sector, by_flank, &[0]);
        let own = rows.by_points + &rows.by_kept * &own[0];

        let nearest = FlankFit::new(gear, &stack.face, &tooth.roll_lengths).nearest();
        let lower: Vec<_> = classes
            .iter()
            .map(|class| {
                let onto = smoothed_rows(&nearest, &class.by_flank.transpose().to_owned(), m);
                let lower = onto.subrows(0, (OTHER_DEGREE + 1) * m);
                lower.transpose().to_owned()
            })
            .collect();
        let of_classes = classes
            .iter()
            .zip(&lower)
            .map(|(class, lower)| (class.class, class.orders.as_slice(), lower));
        let reach = REACH.min((z - 1) / 2);
        let distances: Vec<usize> = (0..=2 * reach).map(|d| (d + z - reach) % z).collect();
        run.check()?;
        let others = interfaces(sector, of_classes, &distances)
            .into_iter()
            .enumerate()
            .map(|(d, moved)| match d == reach {
                true => Mat::zeros(0, 0),
                false => &rows.by_kept * moved,
            })
            .collect();

        let by_web = plain.web().map(|web| {
            let circles: Vec<_> = classes
                .iter()
                .filter(|class| !class.wanted.is_empty())
                .map(|class| {
                    let on_class = sector.on_class(&rows.by_kept, class.class, &class.orders);
                    (on_class * &class.by_circle).adjoint().to_owned()
                })
                .collect();
            let orders = classes.iter().map(|class| class.wanted.as_slice());
            let orders = orders.filter(|wanted| !wanted.is_empty());
            let transposed = |answers: &Mat<faer::c64>| answers.transpose().to_owned();
            web.answers_to(orders.zip(&circles), &transposed)
        });
        Ok(Self {
            fillets,
            near: Nearness::new(gear, &stack.face),
            pressed: PressedFlank {
                axial: stack.face.clone(),
                flank: *section.flank(),
                roll_lengths: tooth.roll_lengths,
            },
            tooth_count: z,
            own,
            others,
            by_web,
        })
    }

    /// The root of one tooth alone: that of [`FaceCompliance::of_sector`].
    ///
    /// # Errors
    ///
    /// As [`FaceRoots::new`].
    pub fn of_sector(
        gear: &SolidGear,
        inner_radius: f64,
        resolution: FaceResolution,
    ) -> Result<Self, PartError> {
        let axial = Stack::new(gear, resolution).face;
        let section = gear.section().without_blank().with_plain_flanks();
        let grid = ToothGrid::of_stressed_prism(&section, inner_radius, GridLevel::Standard)?;
        let fillets = fillets(gear, &grid, &axial);
        let (_, rows) = flank_compliance_alone(gear, &grid, &axial, &fillets.nodes())?;
        Ok(Self {
            fillets,
            near: Nearness::new(gear, &axial),
            tooth_count: 1,
            own: rows.by_points,
            others: vec![Mat::zeros(0, 0)],
            by_web: None,
            pressed: PressedFlank {
                axial,
                flank: *section.flank(),
                roll_lengths: grid.flank_roll_lengths,
            },
        })
    }

    /// Loads on the flank of `tooth` from these forces.
    pub fn forces(
        &self,
        tooth: usize,
        pressing: impl IntoIterator<Item = NormalForce>,
    ) -> FlankForces {
        self.pressed.forces(tooth, pressing)
    }

    /// The roots under `loads`; `yields` are the flanks' compliances of the same gear, with the effect of holes.
    pub fn under<'a>(
        &'a self,
        yields: Option<&'a FaceCompliance>,
        loads: &'a [FlankForces],
    ) -> RootAnswer<'a> {
        let holes = yields.and_then(FaceCompliance::holes);
        let on_web = holes.map(|holes| {
            let loads = loads.iter();
            let smooth: Vec<_> = loads.map(|load| (load.tooth, &load.smooth[..])).collect();
            holes.forces(&smooth)
        });
        RootAnswer {
            roots: self,
            yields,
            loads,
            on_web,
            resting: &[],
        }
    }

    /// Displacements of the fillets of each tooth of a gear whose edges move by `edges` without load.
    pub fn resting(&self, edges: &PulledEdges) -> Vec<Vec<f64>> {
        if edges.fillets.is_empty() {
            return Vec::new();
        }
        let of_tooth = |tooth: usize| {
            let turn = TAU * tooth as f64 / self.tooth_count as f64;
            self.fillets.moved_by(turn, |place| edges.fillets.at(place))
        };
        (0..self.tooth_count).map(of_tooth).collect()
    }

    /// The number of teeth of the gear.
    pub fn tooth_count(&self) -> usize {
        self.tooth_count
    }

    /// The number of entries, for the size limit of the cache.
    pub fn entries(&self) -> usize {
        let others: usize = self.others.iter().map(entries).sum();
        entries(&self.own) + others + self.by_web.as_ref().map_or(0, entries)
    }
}

impl<'a> RootAnswer<'a> {
    /// The same with these displacements of the fillets beside those of the loads, of [`FaceRoots::resting`].
    pub fn beside(self, resting: &'a [Vec<f64>]) -> Self {
        Self { resting, ..self }
    }

    /// The stresses on the fillets of tooth `tooth`, on both sides and all across the face, but for places under a contact.
    pub fn stresses(&self, tooth: usize) -> Vec<SurfaceStress> {
        let FaceRoots {
            fillets,
            near,
            pressed,
            ..
        } = self.roots;
        let foot = pressed.flank.point(pressed.roll_lengths[0]);
        let own = self.loads.iter().find(|load| load.tooth == tooth);
        let places = own.map_or(&[][..], |load| &load.places).iter();
        let at_foot: Vec<_> = places
            .filter(|load| near.are_near(**load, (foot, load.1)))
            .collect();
        let mut stresses = fillets.stresses(&self.displacements(tooth));
        stresses.retain(|of| {
            let mut loads = at_foot.iter();
            !loads.any(|load| near.are_near(**load, (of.place, of.z)))
        });
        stresses
    }

    /// The displacements of the nodes of the fillets of `tooth`: node by node, component by component, function by function.
    fn displacements(&self, tooth: usize) -> Vec<f64> {
        let roots = self.roots;
        let (z, reach) = (roots.tooth_count, roots.others.len() / 2);
        let resting = self.resting.get(tooth).cloned();
        let mut moved = resting.unwrap_or_else(|| vec![0.0; roots.own.nrows()]);
        // Forces press into the tooth, and rows are of forces outward.
        let mut add = |rows: &Mat<f64>, by: &[f64]| {
            for (j, by) in by.iter().enumerate().take(rows.ncols()) {
                for (moved, row) in moved.iter_mut().zip(rows.col_as_slice(j)) {
                    *moved -= row * by;
                }
            }
        };
        for load in self.loads {
            let ahead = (tooth + reach + z - load.tooth % z) % z;
            if load.tooth == tooth {
                add(&roots.own, &load.nodal);
            } else if let Some(rows) = roots.others.get(ahead) {
                add(rows, &load.smooth);
            }
        }
        let holes = self.yields.and_then(FaceCompliance::holes);
        let on_web = self.on_web.as_ref().zip(holes).zip(roots.by_web.as_ref());
        if let Some(((forces, holes), by_web)) = on_web {
            let seen = holes.seen_from(tooth, forces);
            for (j, moved) in moved.iter_mut().enumerate() {
                let column = by_web.col_as_slice(j);
                *moved -= column.iter().zip(&seen).map(|(a, f)| a * f).sum::<f64>();
            }
        }
        moved
    }
}

/// The surface of both fillets of `grid`, a sector of the section of `gear`: first the one beside the loaded flank.
fn fillets(gear: &SolidGear, grid: &ToothGrid, axial: &AxialBasis) -> Surface {
    let prism = Prism {
        grid: &grid.grid,
        material: gear.section().material(),
        twist: gear.twist(),
        axial,
    };
    Surface::new(
        &prism,
        &[&grid.fillet_nodes, &grid.back_fillet_nodes],
        false,
    )
}

/// How near to a contact a place is under it: in the section, and along the face.
#[derive(Debug, Clone, Copy)]
struct Nearness([f64; 2]);

impl Nearness {
    fn new(gear: &SolidGear, axial: &AxialBasis) -> Self {
        Self([
            UNDER_CONTACT * gear.section().data().rack.module,
            BLURRED * gear.face_width() / (axial.len() - 1) as f64,
        ])
    }

    /// True if two places are so near to each other that a contact at one of them acts at the other by itself.
    fn are_near(&self, (one, z): (Vector, f64), (other, y): (Vector, f64)) -> bool {
        let [flat, high] = self.0;
        (z - y).abs() < high && (one - other).norm() < flat
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::face_holes::tests::webbed;
    use crate::assembly::{FaceComplianceSpec, MakeAll, Parts as _};
    use crate::fem::prescribed::{Load, displacements};
    use crate::fem::recovery::{Functional, edge_stresses};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Helix, HolePattern, Material};
    use crate::grid::BlankGrid;
    use crate::ring::blank::BlankSubstructure;
    use crate::ring::cyclic::Harmonics;
    use crate::ring::motion::InterfaceMotion;
    use crate::ring::plain::PlainGear;
    use crate::ring::teeth::TeethRing;
    use crate::ring::teeth_recovery::TeethRecovery;
    use crate::ring::tooth::{ToothSubstructure, modal_loads};

    fn of_order(face_order: usize) -> FaceResolution {
        FaceResolution {
            face_order,
            web_order: 3,
            web_harmonics: 8,
            sections: crate::grid::GridLevel::Standard,
        }
    }

    fn gear(beta: f64, face_width: f64) -> SolidGear {
        let mut data = paper_gear(30);
        data.blank.bore_radius = 8e-3;
        data.face_width = face_width;
        SolidGear::new(data, Helix::right(beta), 0.0, None).expect("can be made")
    }

    /// An even load of 1 N per meter on a line along the flank of tooth 0.
    fn even(roots: &FaceRoots, s: f64) -> [FlankForces; 1] {
        let rule = roots.pressed.axial.rule(16).into_iter();
        [roots.forces(
            0,
            rule.map(|(z, w)| NormalForce {
                roll_length: s,
                z,
                force: w,
            }),
        )]
    }

    /// The principal stresses of a straight tooth at the nodes of its fillets, nearest to the middle of its face.
    fn in_the_middle(answer: &RootAnswer<'_>, tooth: usize) -> Vec<[f64; 2]> {
        let stresses = answer.stresses(tooth);
        let middle = stresses.iter().map(|of| of.z.abs()).fold(1.0, f64::min);
        let found = stresses.iter().filter(|of| of.z == middle);
        found.map(|of| of.principal).collect()
    }

    /// Asserts that principal stresses along the edges are those in the plane: the largest and the smallest to a part `most` of the largest of
    /// all, and all of them to a percent, because a node of a grid does not know of itself that its surface is free.
    fn assert_equal(found: &[[f64; 2]], plane: &[f64], most: f64) {
        assert_eq!(found.len(), plane.len());
        let largest = plane.iter().map(|s| s.abs()).fold(0.0, f64::max);
        for (i, (found, plane)) in found.iter().zip(plane).enumerate() {
            let off = (found[usize::from(*plane < 0.0)] - plane).abs() / largest;
            assert!(off < 0.011, "{i}: {found:?} {plane}");
        }
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([0.0_f64; 2], |[low, high], s| [low.min(s), high.max(s)])
        };
        let found = ends(&mut found.iter().flatten().copied());
        let plane = ends(&mut plane.iter().copied());
        for (found, plane) in found.iter().zip(plane) {
            assert!((found - plane).abs() < most * largest, "{found} {plane}");
        }
    }

    fn along_edges(grid: &ToothGrid, material: &Material) -> Vec<Functional> {
        let sides = [&grid.fillet_nodes, &grid.back_fillet_nodes].into_iter();
        sides
            .flat_map(|side| edge_stresses(&grid.grid, material, side, false))
            .collect()
    }

    #[test]
    fn narrow_and_wide_straight_teeth_are_stressed_as_in_the_plane() {
        let nu = Material::STEEL.poisson_ratio;
        let plane_strain = Material {
            youngs_modulus: Material::STEEL.youngs_modulus / (1.0 - nu * nu),
            poisson_ratio: nu / (1.0 - nu),
            ..Material::STEEL
        };
        for (width, order, material, most) in [
            (0.05e-3, 2, &Material::STEEL, 2e-3),
            (60e-3, 8, &plane_strain, 2e-3),
        ] {
            let gear = gear(0.0, width);
            let section = gear.section();
            let inner = section.root_radius() - 4e-3;
            let roots = FaceRoots::of_sector(&gear, inner, of_order(order)).expect("sound");
            let loads = even(&roots, roots.pressed.roll_lengths[7]);
            let found = in_the_middle(&roots.under(None, &loads), 0);

            let plain = section.without_blank();
            let grid = ToothGrid::of_stressed_prism(&plain, inner, GridLevel::Standard);
            let grid = grid.expect("a usable grid");
            let s = grid.flank_roll_lengths[7];
            let load = Load {
                moves: vec![0.0; 2 * grid.arc_nodes.len()],
                forces: vec![(
                    grid.flank_nodes[7],
                    (-section.flank().normal(s)).as_slice().to_vec(),
                )],
            };
            let plate = (material, 1.0);
            let moved = displacements("a tooth", &grid.grid, plate, &grid.arc_nodes, &[load]);
            let moved = &moved.expect("sound")[0];
            let plane = along_edges(&grid, material).into_iter();
            let plane: Vec<f64> = plane.map(|of| of.value(moved)).collect();
            assert_equal(&found, &plane, most);
        }
    }

    #[test]
    fn the_teeth_of_a_narrow_gear_are_stressed_as_in_the_plane() {
        let run = Run::unattended();
        let pattern = HolePattern {
            count: 5,
            circle_radius: 16e-3,
            radius: 4e-3,
            phase: 0.1,
        };
        for holes in [false, true] {
            let mut data = paper_gear(30);
            data.blank.bore_radius = 8e-3;
            data.face_width = 0.05e-3;
            if holes {
                data.blank.holes = pattern.holes();
            }
            let gear = SolidGear::new(data, Helix::STRAIGHT, 0.0, None).expect("can be made");
            let section = gear.section();
            let spec = FaceComplianceSpec::new(&gear, of_order(2));
            let stack = spec.stack();
            let roots = MakeAll.face_roots(&stack, &run).expect("sound");
            let yields = MakeAll.face_compliance(&spec, &run).expect("sound");

            // The same grid in the plane.
            let radius = stack.interface_radius;
            let plain = section.without_blank();
            let grid = ToothGrid::of_stressed_prism(&plain, radius, GridLevel::Standard);
            let grid = grid.expect("a usable grid");
            let probes = along_edges(&grid, &Material::STEEL);
            let (tooth, rows) =
                ToothSubstructure::with_recovery(section, &grid, &probes).expect("sound");
            let harmonics = Harmonics { largest: 90 };
            let ring = TeethRing::new(&tooth, harmonics, &run).expect("sound");
            let inside = TeethRecovery::new(&tooth, &rows, harmonics, &run).expect("sound");
            let [solid, blank] = [None, holes.then_some(&pattern)].map(|holes| {
                let (bore, level) = (section.bore_radius(), GridLevel::Fine);
                let grid = BlankGrid::new(bore, radius, holes, 30, 8.0, level);
                let (grid, width) = (grid.expect("a usable grid"), section.face_width());
                let steel = &Material::STEEL;
                let made = BlankSubstructure::new(&grid, radius, steel, width, harmonics, &run);
                made.expect("sound")
            });
            let plain = PlainGear::new(&ring, &solid, &run).expect("sound");
            let holed = Some((&blank, section.hole_angle()));
            let motion = InterfaceMotion::new(&ring, &plain, holed, &run).expect("sound");
            for node in [9, 15] {
                let loads = even(&roots, roots.pressed.roll_lengths[node]);
                let answer = roots.under(Some(&yields), &loads);
                let mut forces = vec![0.0; 2 * grid.flank_nodes.len()];
                forces[2 * node] = -section.face_width();
                let loads = [(0, modal_loads(&tooth.modes, &forces))];
                let motion = motion.under(&loads);
                for tooth in [0, 1, 3, 29] {
                    let own = if tooth == 0 { &forces[..] } else { &[] };
                    let plane = inside.values(tooth, own, &loads, &motion);
                    assert_equal(&in_the_middle(&answer, tooth), &plane, 5e-3);
                }
            }
        }
    }

    #[test]
    fn places_under_a_contact_are_left_out_on_the_tooth_that_it_presses() {
        let gear = gear(0.3, 10e-3);
        let run = Run::unattended();
        let stack = FaceComplianceSpec::new(&gear, of_order(4)).stack();
        let roots = MakeAll.face_roots(&stack, &run).expect("sound");
        let foot = roots.pressed.roll_lengths[0];
        let loads = [roots.forces(
            0,
            [NormalForce {
                roll_length: foot,
                z: 4e-3,
                force: 10.0,
            }],
        )];
        let answer = roots.under(None, &loads);
        let (own, neighbor) = (answer.stresses(0), answer.stresses(1));
        assert_eq!(
            neighbor.len(),
            // Four heights a degree, and both ends.
            roots.fillets.nodes().len() * (4 * 4 + 2)
        );
        assert!(own.len() < neighbor.len() && own.len() > neighbor.len() * 3 / 4);
        let (twist, foot) = (gear.twist(), roots.pressed.flank.point(foot));
        let at_foot = |of: &&SurfaceStress| {
            (of.edge == 0) && (of.angle - twist * of.z - foot.y.atan2(foot.x)).abs() < 1e-9
        };
        let heights: Vec<f64> = own.iter().filter(at_foot).map(|of| of.z).collect();
        assert!(
            heights.iter().all(|z| *z < 1.6e-3) && !heights.is_empty(),
            "{heights:?}"
        );
        assert!(neighbor.iter().filter(at_foot).any(|of| of.z > 4e-3));
    }

    #[test]
    #[ignore = "./test all"]
    fn a_gear_and_its_image_in_the_plane_of_its_face_have_equal_stresses() {
        let of = |beta: f64, sign: f64| {
            let gear = webbed(sign * beta, sign * 4e-3, 0.0);
            let spec = FaceComplianceSpec::new(&gear, of_order(4));
            let run = Run::unattended();
            let roots = MakeAll.face_roots(&spec.stack(), &run).expect("sound");
            let yields = MakeAll.face_compliance(&spec, &run).expect("sound");
            let s = roots.pressed.roll_lengths[9];
            let loads = [(7, 3e-3), (8, -6e-3)].map(|(tooth, z)| {
                roots.forces(
                    tooth,
                    [NormalForce {
                        roll_length: s,
                        z: sign * z,
                        force: 100.0,
                    }],
                )
            });
            let answer = roots.under(Some(&yields), &loads);
            [6, 7, 8, 12].map(|tooth| answer.stresses(tooth))
        };
        let (right, left) = (of(0.3, 1.0), of(0.3, -1.0));
        for (right, left) in right.iter().zip(&left) {
            let largest = right.iter().map(|of| of.principal[0]).fold(0.0, f64::max);
            for of in right {
                let image = left.iter().find(|image| {
                    (image.z + of.z).abs() < 1e-9 && (image.angle - of.angle).abs() < 1e-9
                });
                let image = image.expect("the image of a place is a place");
                for i in [0, 1] {
                    let off = (of.principal[i] - image.principal[i]).abs();
                    assert!(off < 1e-5 * largest, "{of:?} {image:?}");
                }
            }
        }
    }
}
