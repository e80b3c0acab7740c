//! Motion of a whole solid gear whose flanks are loaded, part by part.
//!
//! The ring of teeth tells how the sides of the teeth and the interface circle move ([`crate::ring::solid::gear`]); that moves the teeth inside,
//! and the rim below, and so on from circle to circle down to the bore or the shaft, order by order where a part is axisymmetric, and sector by
//! sector where it has holes.

use std::f64::consts::TAU;
use std::sync::Arc;

use faer::{Mat, c64};
use rayon::prelude::*;

use super::amplitudes::block;
use super::flank_forces::{FlankForces, PressedFlank};
use super::holed::HoledSection;
use super::stack::Stack;
use super::{FaceCompliance, FaceComplianceSpec, PartError, Parts, PlainFace};
use crate::contact::face::NormalForce;
use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::prescribed::Load;
use crate::fem::prism::Prism;
use crate::fem::volume::{Frame, Level, Volume};
use crate::gear::Material;
use crate::grid::{Grid, GridLevel, ToothGrid};
use crate::ring::solid::gear::forced;
use crate::ring::solid::joint::below;
use crate::ring::solid::revolution::{Circles, Revolution};
use crate::ring::solid::sector::SolidSector;
use crate::ring::solid::tooth::{SolidTooth, flank_normals};
use crate::ring::solid::web::conjugate_below_zero;
use crate::run::Run;

/// Displacements in the rim and in the parts below it are recovered at radii that resolve fields of these orders, as parts of the number of teeth.
/// Elements of the rim follow the fields of single teeth, which do not reach farther.
const RECOVERED_ORDERS: [f64; 2] = [0.75, 0.25];

/// A solid gear that can be asked how all of it moves.
pub struct FaceInside {
    spec: FaceComplianceSpec,
    stack: Stack,
    plain: Arc<PlainFace>,
    yields: Arc<FaceCompliance>,
    grid: ToothGrid,
    pressed: PressedFlank,
}

/// Parts of a gear that have one section, and how each of them moves.
pub struct MovedParts {
    grid: Grid,
    material: Material,
    axial: AxialBasis,
    twist: f64,
    /// The nodes at which they meet others.
    joints: Vec<u32>,
    /// Where each stands, as the angle from the centerline of tooth 0, and its unknowns.
    parts: Vec<(f64, Vec<f64>)>,
}

/// How the ring of teeth moves.
struct MovedTeeth {
    /// The interface of each tooth: right side, left side, arc.
    interfaces: Vec<Vec<f64>>,
    /// The amplitudes of the orders 0 … on the interface circle.
    circle: Vec<Mat<c64>>,
}

impl FaceInside {
    /// The gear of `spec`, whose flanks yield as `yields`.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn new(
        spec: FaceComplianceSpec,
        yields: Arc<FaceCompliance>,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Self, PartError> {
        let stack = spec.stack();
        let section = stack.gear.section().without_blank();
        let radius = stack.interface_radius;
        let grid = ToothGrid::of_stressed_prism(&section, radius, GridLevel::Standard)?;
        Ok(Self {
            plain: parts.plain_face(&stack, run)?,
            yields,
            pressed: PressedFlank {
                axial: stack.face.clone(),
                flank: *section.flank(),
                roll_lengths: grid.flank_roll_lengths.clone(),
            },
            grid,
            stack,
            spec,
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

    /// All parts of the gear under `loads`, from the teeth to the bore.
    ///
    /// # Errors
    ///
    /// [`PartError`].
    pub fn under(&self, loads: &[FlankForces], run: &Run) -> Result<Vec<MovedParts>, PartError> {
        let on_web = self.forces_of_holes(loads);
        let teeth = self.teeth(loads, on_web.as_deref(), run)?;
        run.check()?;
        let mut parts = vec![self.inside_teeth(&teeth.interfaces, loads)?];
        run.check()?;

        let Stack { layers, across, .. } = &self.stack;
        let mut body = self.stack.rim(layers[0].inner_radius);
        let mut circle = self.body(&mut parts, 0, &body, &teeth.circle, on_web.as_deref())?;
        for index in 1..self.stack.layers_around() {
            run.check()?;
            let (bases, twist) = ([&across[index], &across[index - 1]], body.twist);
            let outer = each_order(circle.len(), |order| {
                let carries = self.stack.plain(index, order)?;
                let carries = carries.unwrap_or_else(|| Mat::zeros(0, 0));
                below(&carries, bases, (order as i64, twist), &circle[order])
            })?;
            body = self.stack.layer(index);
            circle = if index == 1 && on_web.is_some() {
                self.holed(&mut parts, &outer, run)?
            } else {
                self.body(&mut parts, index, &body, &outer, None)?
            };
        }
        Ok(parts)
    }

    /// The forces on the web's outer circle by which its holes act, order by order from 0; `None` without holes.
    fn forces_of_holes(&self, loads: &[FlankForces]) -> Option<Vec<Mat<c64>>> {
        let holes = self.yields.holes()?;
        let loads = loads.iter();
        let smooth: Vec<_> = loads.map(|load| (load.tooth, &load.smooth[..])).collect();
        let forces = holes.forces(&smooth);
        let web = self.plain.web()?;
        let size = forces.len() / (2 * web.largest() + 1);
        let of = |order: usize| {
            Mat::from_fn(size, 1, |i, _| match order {
                // Forces press into the teeth; those on the circle point outward.
                0 => c64::new(-forces[i], 0.0),
                _ => {
                    let at = block(order) * size + i;
                    c64::new(-forces[at], forces[at + size])
                }
            })
        };
        Some((0..=web.largest()).map(of).collect())
    }

    fn teeth(
        &self,
        loads: &[FlankForces],
        on_web: Option<&[Mat<c64>]>,
        run: &Run,
    ) -> Result<MovedTeeth, PartError> {
        let tooth = SolidTooth::new(&self.stack.gear, &self.grid, &self.stack.face)?;
        let (sector, z) = (&tooth.sector, tooth.sector.count);
        let turned = |class: usize, tooth: usize| {
            SolidSector::turn(1, TAU * (class * tooth % z) as f64 / z as f64)
        };
        let on_flank = |class: usize| {
            let mut sum = Mat::<c64>::zeros(tooth.rows.nrows(), 1);
            for load in loads {
                let back = -turned(class, load.tooth % z).conj();
                for (sum, force) in sum.col_as_slice_mut(0).iter_mut().zip(&load.nodal) {
                    *sum += back * *force;
                }
            }
            sum
        };
        let on_order = |order: i64| {
            let force = on_web?.get(order.unsigned_abs() as usize)?;
            Some(self.plain.web()?.on_interface(order, force))
        };
        let classes = forced(
            &tooth,
            self.plain.stiffness_below(),
            (on_flank, on_order),
            run,
        )?;
        let carried = self.plain.stiffness_below().len();
        let seen = self.stack.hole_orders.unwrap_or(0);
        let mut moved = MovedTeeth {
            interfaces: vec![Vec::new(); z],
            circle: vec![Mat::zeros(sector.size, 1); carried.max(seen + 1)],
        };
        for class in &classes {
            let motion = &class.motion * faer::Scale(c64::new(1.0 / z as f64, 0.0));
            let interface = sector.off_class(&motion, class.class, &class.orders);
            sector.add_to_each(class.class, &interface, &mut moved.interfaces);
            let sides = sector.size * sector.side_nodes;
            for (k, &order) in class.orders.iter().enumerate() {
                let of = motion.subrows(sides + k * sector.size, sector.size);
                moved.circle[order.unsigned_abs() as usize] =
                    conjugate_below_zero(&of.to_owned(), order);
            }
        }
        Ok(moved)
    }

    /// The teeth, whose interfaces move.
    fn inside_teeth(
        &self,
        interfaces: &[Vec<f64>],
        loads: &[FlankForces],
    ) -> Result<MovedParts, PartError> {
        let gear = &self.stack.gear;
        let (m, z) = (self.stack.face.len(), interfaces.len());
        let normals = flank_normals(gear, &self.grid);
        let acting = |(number, moves): (usize, &Vec<f64>)| {
            let own = loads.iter().filter(|load| load.tooth % z == number);
            let forces = own.flat_map(|load| {
                normals
                    .iter()
                    .zip(load.nodal.chunks_exact(m))
                    .map(|((node, normal), forces)| {
                        let along = normal
                            .iter()
                            .flat_map(|n| forces.iter().map(move |f| -n * f));
                        (*node, along.collect())
                    })
            });
            Load {
                moves: moves.clone(),
                forces: forces.collect(),
            }
        };
        let acting: Vec<Load> = interfaces.iter().enumerate().map(acting).collect();
        let (right, left) = &self.grid.side_nodes;
        let joints = [right, left, &self.grid.arc_nodes]
            .map(Vec::as_slice)
            .concat();
        let parts = MovedParts {
            grid: self.grid.grid.clone(),
            material: *gear.section().material(),
            axial: self.stack.face.clone(),
            twist: gear.twist(),
            parts: Vec::new(),
            joints,
        };
        let prism = parts.prism();
        let unknowns = prism.displacements("the tooth", &parts.joints, &acting)?;
        let pitch = TAU / z as f64;
        let angles = (0..z).map(|number| pitch * number as f64);
        Ok(MovedParts {
            parts: angles.zip(unknowns).collect(),
            ..parts
        })
    }

    /// Adds layer `index` to `parts`, an axisymmetric body, whose outer circle moves by the amplitudes `outer` of the orders 0 …;
    /// `forces` act on the circle below. How its inner circle moves.
    fn body(
        &self,
        parts: &mut Vec<MovedParts>,
        index: usize,
        body: &Revolution<'_>,
        outer: &[Mat<c64>],
        forces: Option<&[Mat<c64>]>,
    ) -> Result<Vec<Mat<c64>>, PartError> {
        let circles = each_order(outer.len(), |order| {
            let carried = self.stack.below(index, order, body.twist)?;
            let force = forces.and_then(|forces| forces.get(order));
            let force = force.map(|force| self.stack.trace_of_web(order).adjoint() * force);
            body.inside(order as i64, (carried.as_ref(), force), &outer[order])
        })?;
        let z = self.stack.gear.section().tooth_count();
        let radii = body.circles((RECOVERED_ORDERS[index.min(1)] * f64::from(z)) as i64);
        let arc = &self.grid.arc_angles[..self.grid.arc_angles.len() - 1];
        let turns = (0..z).map(|tooth| TAU * f64::from(tooth) / f64::from(z));
        let mut angles: Vec<f64> = turns
            .flat_map(|turn| arc.iter().map(move |angle| angle + turn))
            .collect();
        // Below the rim half as many do, if corners and middles are still in turn.
        if index > 0 && angles.len().is_multiple_of(4) {
            angles = angles.into_iter().step_by(2).collect();
        }
        let grid = Grid::polar(&radii, &angles);
        let (nodes, around_circle) = (grid.nodes.len() as u32, angles.len() as u32);
        let outermost = nodes - around_circle..nodes;
        // The last part ends at the bore.
        let innermost = match index + 1 == self.stack.layers.len() {
            true => 0..0,
            false => 0..around_circle,
        };
        parts.push(MovedParts {
            parts: vec![(0.0, around(&circles, &radii, &angles))],
            joints: outermost.chain(innermost).collect(),
            grid,
            material: *body.material,
            axial: body.axial.clone(),
            twist: body.twist,
        });
        Ok(circles.iter().map(|of| of.inner().clone()).collect())
    }

    /// Adds the web with its holes to `parts`, whose outer circle moves by the amplitudes `outer`. How its inner circle moves.
    fn holed(
        &self,
        parts: &mut Vec<MovedParts>,
        outer: &[Mat<c64>],
        run: &Run,
    ) -> Result<Vec<Mat<c64>>, PartError> {
        let largest = self.stack.hole_orders.unwrap_or(0);
        let holed = HoledSection::new(&self.stack, self.spec.gear().section(), largest)?;
        let ring = holed.ring(&[], run)?.moved(holed.phase, outer, run)?;
        run.check()?;
        let (grid, prism) = (&holed.grid, holed.prism());
        let (right, left) = &grid.side_nodes;
        let (inner, held): (&[u32], usize) = match ring.hub {
            Some(_) => (&grid.bore_nodes, 0),
            None => (&[], grid.bore_nodes.len() * prism.unknowns_of_node()),
        };
        let mut moved = [right, left, inner, &grid.arc_nodes].concat();
        if held > 0 {
            moved.extend(&grid.bore_nodes);
        }
        let acting: Vec<Load> = ring
            .sectors
            .into_iter()
            .map(|mut moves| {
                moves.extend(std::iter::repeat_n(0.0, held));
                Load {
                    moves,
                    forces: Vec::new(),
                }
            })
            .collect();
        let unknowns = prism.displacements("the web", &moved, &acting)?;
        let size = prism.unknowns_of_node();
        let own = grid.own();
        let of_sector = |unknowns: &Vec<f64>| -> Vec<f64> {
            let own = own.iter().map(|node| *node as usize * size);
            own.flat_map(|first| &unknowns[first..first + size])
                .copied()
                .collect()
        };
        let whole = grid.unrolled();
        let hub = if ring.hub.is_some() {
            whole.bore_nodes
        } else {
            Vec::new()
        };
        parts.push(MovedParts {
            parts: vec![(holed.phase, unknowns.iter().flat_map(of_sector).collect())],
            joints: [whole.arc_nodes, hub].concat(),
            grid: whole.grid,
            material: *prism.material,
            axial: prism.axial.clone(),
            twist: 0.0,
        });
        Ok(ring.hub.unwrap_or_default())
    }
}

impl MovedParts {
    fn prism(&self) -> Prism<'_> {
        Prism {
            grid: &self.grid,
            material: &self.material,
            twist: self.twist,
            axial: &self.axial,
        }
    }

    /// The section of which they are.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The nodes of it at which they meet others.
    pub fn joints(&self) -> &[u32] {
        &self.joints
    }

    /// Their sections at the height `z`, or where they end before it, of a gear that stands at `place`.
    pub fn sections(&self, z: f64, place: Frame) -> Vec<Level> {
        let [low, high] = self.axial.heights();
        let heights = [z.clamp(low, high)];
        let parts = self.parts.iter();
        let section = |(angle, unknowns): &(f64, Vec<f64>)| {
            let angle = place.angle + angle;
            let place = Frame { angle, ..place };
            self.prism().levels(unknowns, &heights, place)
        };
        parts.flat_map(section).collect()
    }

    /// Adds them to `volume`, of a gear that stands at `place`.
    pub fn add_to(&self, volume: &mut Volume, place: Frame) {
        for (angle, unknowns) in &self.parts {
            let angle = place.angle + angle;
            volume.add(&self.prism(), unknowns, Frame { angle, ..place });
        }
    }
}

/// Result of `of` for the orders 0 … below `count`.
fn each_order<T: Send>(
    count: usize,
    of: impl Fn(usize) -> Result<T, FemError> + Send + Sync,
) -> Result<Vec<T>, PartError> {
    let made = (0..count).into_par_iter().map(of);
    Ok(made.collect::<Result<_, _>>()?)
}

/// The unknowns of the nodes of [`polar`], of which `circles` tell order by order from 0.
fn around(circles: &[Circles], radii: &[f64], angles: &[f64]) -> Vec<f64> {
    let of_radius = |(i, radius): (usize, &f64)| {
        let orders: Vec<Mat<c64>> = circles.iter().map(|of| of.at(*radius)).collect();
        let mut unknowns = Vec::new();
        for angle in angles.iter().step_by(1 + i % 2) {
            let mut sum = vec![0.0; orders[0].nrows()];
            for (order, of) in (0..).zip(&orders) {
                // Of the opposite orders, the conjugates.
                let share = if order == 0 { 1.0 } else { 2.0 };
                let turn = SolidSector::turn(order, *angle) * share;
                for (sum, of) in sum.iter_mut().zip(of.col_as_slice(0)) {
                    *sum += (turn * *of).re;
                }
            }
            unknowns.extend(sum);
        }
        unknowns
    };
    let unknowns: Vec<Vec<f64>> = radii.par_iter().enumerate().map(of_radius).collect();
    unknowns.concat()
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::assembly::face_holes::tests::webbed;
    use crate::assembly::{FaceResolution, MakeAll};
    use crate::fem::surface::SurfaceStress;
    use crate::fem::volume::{VolumeElement, von_mises};
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Core, FaceEnds, Helix, Hub, SolidGear, radial};

    const RESOLUTION: FaceResolution = FaceResolution {
        face_order: 6,
        web_order: 4,
        web_harmonics: 10,
        sections: crate::grid::GridLevel::Standard,
    };
    const HERE: Frame = Frame {
        axis: nalgebra::Vector2::new(0.0, 0.0),
        angle: 0.0,
        height: 0.0,
    };
    /// The points of Gauss' rule of two.
    const G: f64 = 0.577_350_269_189_625_8;
    const FORCES: [(usize, f64, f64); 2] = [(7, 3e-3, 100.0), (8, -6e-3, 60.0)];

    /// Gears of 30 teeth: without a web, on a web with holes that stands off the middle, the same on a hub wider than the web, and that on a web of one piece
    /// with a shaft.
    fn gears() -> [SolidGear; 4] {
        let mut plain = paper_gear(30);
        plain.blank.bore_radius = 8e-3;
        let holed = webbed(0.3, 4e-3, 0.0);
        let mut data = holed.section().data().clone();
        let mut on_shaft = data.clone();
        on_shaft.blank.core = Core::Shaft {
            torque_at: FaceEnds::Plus,
        };
        data.blank.bore_radius = 5e-3;
        let hub = Hub {
            outer_radius: 8e-3,
            width: 14e-3,
            offset: 0.0,
        };
        [
            SolidGear::new(plain, Helix::right(0.3), 0.0, None).expect("can be made"),
            holed,
            SolidGear::new(data, Helix::right(0.3), 4e-3, Some(hub)).expect("can be made"),
            SolidGear::new(on_shaft, Helix::right(0.3), 4e-3, None).expect("can be made"),
        ]
    }

    fn inside(gear: &SolidGear) -> FaceInside {
        let spec = FaceComplianceSpec::new(gear, RESOLUTION);
        let run = Run::unattended();
        let yields = MakeAll.face_compliance(&spec, &run).expect("sound");
        FaceInside::new(spec, yields, &MakeAll, &run).expect("sound")
    }

    fn loads(inside: &FaceInside) -> Vec<FlankForces> {
        let s = inside.pressed.roll_lengths[9];
        let load = |(tooth, z, force)| {
            inside.forces(
                tooth,
                [NormalForce {
                    roll_length: s,
                    z,
                    force,
                }],
            )
        };
        FORCES.into_iter().map(load).collect()
    }

    /// Each of the gears, its inside, and how it moves under the loads.
    static MADE: LazyLock<[(SolidGear, FaceInside, Vec<MovedParts>); 4]> = LazyLock::new(|| {
        gears().map(|gear| {
            let inside = inside(&gear);
            let moved = inside.under(&loads(&inside), &Run::unattended());
            (gear, inside, moved.expect("sound"))
        })
    });

    /// The force and the moment about the origin with which the flanks are pressed.
    fn pressed(inside: &FaceInside) -> [Vector3<f64>; 2] {
        let gear = &inside.stack.gear;
        let flank = gear.section().flank();
        let s = inside.pressed.roll_lengths[9];
        let slope = gear.twist() * flank.base_radius();
        let mut sums = [Vector3::zeros(); 2];
        for (tooth, z, force) in FORCES {
            let turn = TAU * tooth as f64 / 30.0 + gear.twist() * z;
            let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), turn);
            let (at, normal) = (flank.point(s), flank.normal(s));
            let normal = turn * Vector3::new(normal.x, normal.y, -slope).normalize();
            let at = turn * Vector3::new(at.x, at.y, 0.0) + z * Vector3::z();
            sums[0] -= force * normal;
            sums[1] -= force * at.cross(&normal);
        }
        sums
    }

    /// The force and the moment about the origin that go through a circle of nodes in `parts`, from outside to inside: the stresses on it,
    /// integrated. Circle 0 is the outermost that is not at a joint.
    fn through(parts: &MovedParts, circle: usize) -> Option<[Vector3<f64>; 2]> {
        let prism = parts.prism();
        let rule = prism.axial.rule(12);
        let heights: Vec<f64> = rule.iter().map(|(z, _)| *z).collect();
        let (_, unknowns) = &parts.parts[0];
        let levels = prism.levels(unknowns, &heights, HERE);
        let mut radii: Vec<f64> = parts.grid.nodes.iter().map(|node| node.norm()).collect();
        radii.sort_by(f64::total_cmp);
        radii.dedup_by(|one, other| (*one - *other).abs() < 1e-9);
        let inside = &radii[1..radii.len() - 1];
        let nearest = *inside.iter().rev().nth(circle)?;
        let on_circle: Vec<usize> = (0..parts.grid.nodes.len())
            .filter(|i| (parts.grid.nodes[*i].norm() - nearest).abs() < 1e-9)
            .collect();
        let mut sums = [Vector3::zeros(); 2];
        for (level, (_, weight)) in levels.iter().zip(&rule) {
            for (k, &i) in on_circle.iter().enumerate() {
                let angle = |k: usize| {
                    let at = parts.grid.nodes[on_circle[k % on_circle.len()]];
                    at.y.atan2(at.x)
                };
                let (before, after) = (angle(k + on_circle.len() - 1), angle(k + 1));
                let length = 0.5 * nearest * (after - before).rem_euclid(TAU);
                let at = level.nodes[i];
                let outward = Vector3::new(at.x, at.y, 0.0) / nearest;
                let force = weight * length * (level.stresses[i] * outward);
                sums[0] += force;
                sums[1] += at.cross(&force);
            }
        }
        Some(sums)
    }

    #[test]
    #[ignore = "./test all"]
    fn what_presses_the_flanks_goes_through_every_circle_of_rim_web_and_hub() {
        for (_, inside, moved) in &*MADE {
            let [force, moment] = pressed(inside);
            let arm = inside.stack.interface_radius;
            for (part, moved) in moved.iter().enumerate().skip(1) {
                // Holes leave no whole circle in the middle of a web.
                if moved.grid.elements.len() % 30 != 0 {
                    continue;
                }
                let circles = (0..).map_while(|circle| Some((circle, through(moved, circle)?)));
                for (circle, [found, about]) in circles {
                    let (off, twisted) = ((found - force).norm(), (about - moment).norm());
                    // At its outermost circles a hub feels the corner of the web on it.
                    assert!(
                        off < 0.02 * force.norm(),
                        "{part} {circle}: {found} {force}"
                    );
                    // Stresses of second-order elements, at their corners and between.
                    assert!(
                        twisted < 0.006 * arm * force.norm(),
                        "{part} {circle}: {about} {moment}"
                    );
                }
            }
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn the_web_moves_as_the_yield_of_the_flanks_has_it() {
        for (_, inside, moved) in &MADE[1..] {
            let loads = loads(inside);
            let smooth: Vec<_> = loads.iter().map(|of| (of.tooth, &of.smooth[..])).collect();
            let expected = inside.yields.circle(&smooth).expect("it has holes");
            let web = &moved[2];
            let m = web.axial.len();
            let largest = inside.stack.hole_orders.expect("it has holes");
            let size = expected.len() / (2 * largest + 1);
            let (phase, unknowns) = &web.parts[0];
            let most = expected.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
            let mut compared = 0;
            for (i, place) in web.grid.nodes.iter().enumerate() {
                if place.norm() < inside.stack.layers[1].outer_radius - 1e-9 {
                    continue;
                }
                let angle = place.y.atan2(place.x) + phase;
                for j in 0..3 * m {
                    let mut sum = expected[j];
                    for order in 1..=largest {
                        let (sin, cos) = (order as f64 * angle).sin_cos();
                        let at = block(order) * size + j;
                        sum += expected[at] * cos + expected[at + size] * sin;
                    }
                    // The grid of the teeth is another one, and their loads are polynomials there.
                    let off = (unknowns[i * 3 * m + j] + sum).abs();
                    assert!(off < 0.02 * most, "{} {sum}", unknowns[i * 3 * m + j]);
                    compared += 1;
                }
            }
            assert!(compared > 1000);
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn parts_move_together_where_they_meet() {
        for (_, _, moved) in &*MADE {
            let most = |levels: &[Level]| {
                let all = levels.iter().flat_map(|of| &of.displacements);
                all.map(Vector3::norm).fold(0.0, f64::max)
            };
            let sections: Vec<Vec<Level>> =
                moved.iter().map(|of| of.sections(4e-3, HERE)).collect();
            let largest = most(&sections[0]);
            for (outer, inner) in sections.iter().zip(&sections[1..]) {
                let (mut met, mut apart) = (0, 0.0_f64);
                for below in inner {
                    for (at, u) in below.nodes.iter().zip(&below.displacements) {
                        for above in outer {
                            let same = above.nodes.iter().position(|of| (of - at).norm() < 1e-8);
                            if let Some(i) = same {
                                apart = apart.max((above.displacements[i] - u).norm());
                                met += 1;
                            }
                        }
                    }
                }
                // A narrower part follows a wider one in the mean over its functions.
                assert!(apart < 0.02 * largest, "{apart} of {largest}");
                assert!(met > 0 || outer.len() == 1, "{met}");
            }
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn fillets_and_holes_are_stressed_inside_as_on_their_surfaces() {
        let run = Run::unattended();
        let (gear, inside, moved) = &MADE[1];
        let loads = loads(inside);
        let spec = FaceComplianceSpec::new(gear, RESOLUTION);
        let roots = MakeAll.face_roots(&spec.stack(), &run).expect("sound");
        let holes = MakeAll.face_holes(&spec, &run).expect("sound");
        let holes = holes
            .expect("it has holes")
            .under(&inside.yields, &loads)
            .stresses();
        let of_teeth = roots.under(Some(&inside.yields), &loads).stresses(8);
        let largest = |of: &[SurfaceStress]| {
            let highest = of
                .iter()
                .max_by(|a, b| a.von_mises().total_cmp(&b.von_mises()));
            *highest.expect("stresses")
        };
        let pitch = TAU / 30.0;
        for (surface, part, turn) in [(&of_teeth, 0, 8.0 * pitch), (&holes, 2, 0.0)] {
            let of = largest(surface);
            let radius = of.place.norm();
            let at = radius * radial(of.angle + turn);
            let sections = moved[part].sections(of.z, HERE);
            let places = sections
                .iter()
                .flat_map(|of| of.nodes.iter().zip(&of.stresses));
            let apart = |node: &Vector3<f64>| (node.xy() - at).norm();
            let nearest = places.min_by(|(a, _), (b, _)| apart(a).total_cmp(&apart(b)));
            let (node, stress) = nearest.expect("nodes");
            assert!(apart(node) < 1e-8, "{}", apart(node));
            let found = von_mises(stress);
            // Elements tell the stress at a surface less exactly than the surface itself.
            let off = (found / of.von_mises() - 1.0).abs();
            assert!(off < 0.06, "{found} {}", of.von_mises());
        }
    }

    #[test]
    #[ignore = "./test all"]
    fn elements_fill_the_gear_once() {
        for (gear, _, moved) in &*MADE {
            let mut volume = Volume::default();
            moved.iter().for_each(|of| of.add_to(&mut volume, HERE));
            // By the corners alone: cells are so small that their curves hardly count.
            let of = |element: &VolumeElement| {
                let corners = element.kind.corner_count();
                let rule: &[(f64, f64, f64)] = match corners {
                    3 => &[
                        (1.0 / 6.0, 1.0 / 6.0, 1.0),
                        (2.0 / 3.0, 1.0 / 6.0, 1.0),
                        (1.0 / 6.0, 2.0 / 3.0, 1.0),
                    ],
                    _ => &[(-G, -G, 6.0), (G, -G, 6.0), (-G, G, 6.0), (G, G, 6.0)],
                };
                let mut filled = 0.0;
                for &(x, y, weight) in rule {
                    // Values and derivatives of the corners' linear functions.
                    let linear: Vec<[f64; 3]> = match corners {
                        3 => vec![[1.0 - x - y, -1.0, -1.0], [x, 1.0, 0.0], [y, 0.0, 1.0]],
                        _ => [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                            .map(|(a, b): (f64, f64)| {
                                let (f, g) = (1.0 + a * x, 1.0 + b * y);
                                [f * g / 4.0, a * g / 4.0, f * b / 4.0]
                            })
                            .to_vec(),
                    };
                    for up in [-G, G] {
                        let mut by = [Vector3::zeros(); 3];
                        for (k, [f, by_x, by_y]) in linear.iter().enumerate() {
                            for (top, side) in [(0, -1.0), (1, 1.0)] {
                                let at = volume.nodes[element.nodes[k + top * corners] as usize];
                                let share = 0.5 * (1.0 + side * up);
                                by[0] += share * by_x * at;
                                by[1] += share * by_y * at;
                                by[2] += 0.5 * side * f * at;
                            }
                        }
                        let here = Matrix3::from_columns(&by).determinant();
                        assert!(here > 0.0, "an element is turned inside out");
                        filled += weight / 6.0 * here;
                    }
                }
                filled
            };
            let filled: f64 = volume.elements.iter().map(of).sum();
            // Fields end at the radius of a shaft.
            let shaft = gear.shaft().map_or(0.0, |shaft| {
                let [low, high] = shaft.heights;
                0.5 * TAU * shaft.outer_radius.powi(2) * (high - low)
            });
            let drawn = gear.mass() / gear.section().material().density - shaft;
            assert!((filled / drawn - 1.0).abs() < 0.01, "{filled} {drawn}");
        }
    }
}
