//! The parts under the teeth of a solid gear: its rim, and below it web and hub, order by order.

use faer::{Mat, c64};
use rayon::prelude::*;

use super::amplitudes::{amplitudes, sets_of_orders};
use super::{FaceResolution, PartError};
use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::Cholesky;
use crate::fem::prism::COMPONENTS;
use crate::gear::{FaceEnds, Hole, Layer, SolidGear, SpurGear, gcd};
use crate::grid::GridLevel;
use crate::ring::solid::joint::{carried, trace};
use crate::ring::solid::revolution::{Revolution, last_of};
use crate::ring::solid::shaft::SolidShaft;
use crate::root_finding::bisect;
use crate::run::Run;

/// The step of the number of orders in which holes are seen.
const ORDER_STEP: usize = 4;

/// The orders that the interface circle carries: fields of the teeth fall to e^−this on their way to it.
const DECAY: f64 = 4.5;
/// Orders on it for each tooth, at most: beyond, the grids do not follow.
const MOST_ORDERS_PER_TOOTH: usize = 8;
/// A web whose face is nearer to that of the rim, as a part of its width, is flush with it.
const FLUSH: f64 = 0.02;
/// Faces of two parts that differ by a smaller part of the width are treated as equal.
const SAME: f64 = 1e-6;
/// Part of the way from holes that stand in the rim itself to the interface circle that belongs to the teeth; the rest belongs to the holed part.
const TOOTHED_PART: f64 = 0.25;
/// Fields that fall by less from order to order, as a logarithm, are near ones: they make the stress at holes.
const NEAR: f64 = 0.08;
/// The most unknowns that holes couple: with them a gear takes 1 to 2 GB and half a minute of a core.
const MOST_UNKNOWNS: usize = 6000;
/// How much more an unknown counts where all of a part is condensed at once.
const CONDENSED: f64 = 1.5;

/// The parts of a gear from its root circle to its bore or its axis, each with its functions along the axis: all that its yield depends on, but
/// for the holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// The gear with plain flanks and without holes.
    pub(crate) gear: SolidGear,
    /// The functions across the face, of teeth and rim.
    pub(crate) face: AxialBasis,
    /// Radius of the circle on which the teeth meet their support.
    pub(crate) interface_radius: f64,
    /// From the rim to the bore, or through the shaft to the axis.
    pub(crate) layers: Vec<Layer>,
    /// The functions across each; those of the rim are those of the face.
    pub(crate) across: Vec<AxialBasis>,
    /// The orders of its outer circle in which the holes of layer 1 are seen, if there are any.
    pub(crate) hole_orders: Option<usize>,
    /// How fine the sections of teeth are.
    pub(crate) sections: GridLevel,
}

impl Stack {
    /// The parts of `gear`.
    pub fn new(gear: &SolidGear, resolution: FaceResolution) -> Self {
        let section = gear.section();
        let (root, module) = (section.root_radius(), gear.normal_rack().module);
        let resolution = resolution.of_width(gear.face_width() / module);
        let mut layers = gear.layers();
        layers.extend(gear.shaft());
        let mut across = functions_across(gear, &layers, resolution);
        let joints = Joints::of(&layers, (root, module), section.holes());
        if joints.is_in_rim {
            // Holes in the rim itself: its inner part is the holed one.
            let [_, edge] = joints.holed;
            let rim = Layer {
                inner_radius: edge,
                ..layers[0]
            };
            layers[0].outer_radius = edge;
            layers.insert(0, rim);
            // In pieces it would cost five times as much; over a narrower hub they change δ by less than a thousandth.
            across[0] = AxialBasis::new(&layers[0].heights, resolution.face_order);
            across.insert(0, across[0].clone());
        }
        let is_holed = !section.holes().is_empty();
        let hole_orders = is_holed.then(|| joints.orders(root, section.holes(), resolution));
        // A shaft as wide as the part on it continues inside as this part.
        if let [.., above, shaft] = layers.as_slice()
            && gear.shaft().is_some()
            && above.heights == shaft.heights
        {
            let last = across.len() - 1;
            across[last] = across[last - 1].clone();
        }
        let face = across[0].clone();
        Self {
            gear: gear.with_plain_flanks().without_holes(),
            face,
            interface_radius: joints.interface_radius,
            layers,
            across,
            hole_orders,
            sections: resolution.sections,
        }
    }

    /// The orders that the interface circle carries.
    pub(super) fn orders(&self) -> usize {
        let section = self.gear.section();
        let depth = section.root_radius() - self.interface_radius;
        let z = section.tooth_count() as usize;
        let orders = (DECAY * self.interface_radius / depth - 1e-9).ceil() as usize;
        orders.clamp(z, MOST_ORDERS_PER_TOOTH * z)
    }

    /// How the outer circle of layer 1, a web, follows the rim in `order`, on the functions across each.
    pub(crate) fn trace_of_web(&self, order: usize) -> Mat<c64> {
        let twist = self.gear.twist();
        trace(&self.across[1], &self.face, order as i64, twist)
    }

    /// The rim below the interface circle, down to `inner_radius`.
    pub(crate) fn rim(&self, inner_radius: f64) -> Revolution<'_> {
        Revolution {
            material: self.gear.section().material(),
            twist: self.gear.twist(),
            axial: &self.face,
            radii: [inner_radius, self.interface_radius],
        }
    }

    /// The stiffness of `order` on the outer circle of layer `index`, on the functions across it, without holes; nothing below the
    /// last.
    pub(crate) fn plain(&self, index: usize, order: usize) -> Result<Option<Mat<c64>>, FemError> {
        if index >= self.layers.len() {
            return Ok(None);
        }
        let body = self.layer(index);
        let order = order as i64;
        if let Some(torque_at) = self.shaft().filter(|_| index + 1 == self.layers.len()) {
            return SolidShaft { body, torque_at }.on_outer(order).map(Some);
        }
        let below = self.below(index, order as usize, body.twist)?;
        body.on_outer(order, below.as_ref()).map(Some)
    }

    /// The ends through which the torque enters the shaft, if the gear is of one piece with it: that is the last layer.
    fn shaft(&self) -> Option<FaceEnds> {
        self.gear.section().data().blank.shaft()
    }

    /// The number of layers around the bore or the shaft.
    pub(crate) fn layers_around(&self) -> usize {
        self.layers.len() - usize::from(self.shaft().is_some())
    }

    /// Layer `index` below the rim, without holes: it stands still, while the rim turns; a shaft that is the rim gone on turns with it.
    pub(crate) fn layer(&self, index: usize) -> Revolution<'_> {
        let layer = &self.layers[index];
        Revolution {
            material: self.gear.section().material(),
            twist: self.twist(index),
            axial: &self.across[index],
            radii: [layer.inner_radius, layer.outer_radius],
        }
    }

    /// The turn per length of the frame of a layer below the rim.
    fn twist(&self, index: usize) -> f64 {
        if index == self.layers_around() && index == 1 && self.across[1] == self.face {
            return self.gear.twist();
        }
        0.0
    }

    /// Stiffness under `order` on the inner circle of layer `index`, on the functions across that layer, whose frame turns by `twist`.
    pub(crate) fn below(
        &self,
        index: usize,
        order: usize,
        twist: f64,
    ) -> Result<Option<Mat<c64>>, FemError> {
        let Some(under) = self.plain(index + 1, order)? else {
            return Ok(None);
        };
        let (lower, upper) = (&self.across[index + 1], &self.across[index]);
        let twist = twist - self.twist(index + 1);
        carried(&under, lower, upper, order as i64, twist).map(Some)
    }
}

/// The circles on which the parts of a gear meet.
struct Joints {
    interface_radius: f64,
    /// The inner and the outer circle of the part in which holes stand.
    holed: [f64; 2],
    /// True for an inner part of the rim.
    is_in_rim: bool,
    /// True if another part carries it; otherwise it is held there.
    is_carried: bool,
}

impl Joints {
    /// Ports of a gear of the root radius and the module, with `layers` below its root circle and these `holes`.
    fn of(layers: &[Layer], (root, module): (f64, f64), holes: &[Hole]) -> Self {
        let interface_above = |radius: f64| (root - module).max(f64::midpoint(root, radius));
        let rim = &layers[0];
        let reach = holes.iter().map(Hole::outer_reach).reduce(f64::max);
        if let Some(reach) = reach.filter(|reach| *reach > rim.inner_radius) {
            let interface_radius = interface_above(reach);
            let edge = reach + (1.0 - TOOTHED_PART) * (interface_radius - reach);
            return Self {
                interface_radius,
                holed: [rim.inner_radius, edge],
                is_in_rim: true,
                is_carried: layers.len() > 1,
            };
        }
        let web = layers.get(1).unwrap_or(rim);
        Self {
            interface_radius: interface_above(rim.inner_radius),
            holed: [web.inner_radius, web.outer_radius],
            is_in_rim: false,
            is_carried: layers.len() > 2,
        }
    }

    /// The orders of these circles in which `holes` below the radius `root` are seen, in steps: a hole that moves a little needs as many, so that the teeth
    /// above it are not made anew.
    fn orders(&self, root: f64, holes: &[Hole], resolution: FaceResolution) -> usize {
        let of_hole = |hole: &Hole| self.orders_of(root, hole, resolution);
        let needed = holes.iter().map(of_hole).fold(0.0, f64::max);
        let needed = (needed - 1e-9).ceil() as usize;
        match needed <= resolution.web_harmonics {
            true => resolution.web_harmonics,
            false => needed.next_multiple_of(ORDER_STEP),
        }
    }

    /// The first order whose fields have decayed to the truncation of the resolution: those of the teeth on their way to `hole`, those of the hole on theirs to
    /// the circles. The farther they go, the smaller is their part of the stress.
    fn orders_of(&self, root: f64, hole: &Hole, resolution: FaceResolution) -> f64 {
        let [of_teeth, of_holes] = resolution.hole_decays();
        let within =
            |decay: f64, decrement: f64| (decay - (decrement / NEAR).ln().max(0.0)) / decrement;
        let [inner, outer] = self.holed;
        let direct = within(of_teeth, (root / hole.outer_reach()).ln());
        let above = within(of_holes, hole.decrement(outer));
        let below = match self.is_carried {
            true => within(of_holes, hole.decrement(inner)),
            false => 0.0,
        };
        direct.max(above).max(below)
    }
}

/// Holes that stand so near to the roots, or to an edge of the part that they stand in, that their fields cannot be followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearHoles {
    /// The hole whose field has the most orders, by its place in the list.
    pub hole: usize,
    /// The orders that it needs, and those that can be had.
    pub orders: [usize; 2],
    /// By how much narrower to each side round holes and slots would do, in meters; `None` if one of them is drawn by its contour, or none
    /// would do.
    pub narrower: Option<f64>,
}

impl NearHoles {
    /// Ports of `gear`, if it has such.
    pub fn of(gear: &SolidGear, resolution: FaceResolution) -> Option<Self> {
        let section = gear.section();
        let (root, module) = (section.root_radius(), gear.normal_rack().module);
        let resolution = resolution.of_width(gear.face_width() / module);
        let mut layers = gear.layers();
        layers.extend(gear.shaft());
        let across = functions_across(gear, &layers, resolution);
        let joints = |holes: &[Hole]| Joints::of(&layers, (root, module), holes);
        let orders = |holes: &[Hole]| joints(holes).orders(root, holes, resolution);
        let holes = section.holes();
        let drawn = joints(holes);
        let functions = match drawn.is_in_rim {
            true => resolution.face_order + 1,
            false => across.get(1).map_or(0, AxialBasis::len),
        };
        let unknowns = |orders: usize| {
            let size = COMPONENTS * functions;
            unknowns_of_holes(section, (orders, size), drawn.is_carried)
        };
        let needed = orders(holes);
        if holes.is_empty() || unknowns(needed) <= MOST_UNKNOWNS {
            return None;
        }
        let most = (1..needed).rfind(|orders| unknowns(*orders) <= MOST_UNKNOWNS)?;
        let of_hole = |hole: &Hole| drawn.orders_of(root, hole, resolution);
        let nearest = holes
            .iter()
            .map(of_hole)
            .enumerate()
            .max_by(|(_, one), (_, other)| one.total_cmp(other));
        let widths = holes.iter().map(Hole::half_width);
        let narrowest = widths.fold(f64::INFINITY, f64::min);
        let narrowed =
            |by: f64| -> Option<Vec<Hole>> { holes.iter().map(|hole| hole.narrowed(by)).collect() };
        let does = |by: f64| narrowed(by).is_some_and(|holes| orders(&holes) <= most);
        // The width that is left in any case.
        const LEFT: f64 = 0.01;
        let widest = (1.0 - LEFT) * narrowest;
        Some(Self {
            hole: nearest.map_or(0, |(hole, _)| hole),
            orders: [needed, most],
            narrower: does(widest).then(|| bisect(widest, 0.0, does)),
        })
    }
}

/// The unknowns that holes of `section` couple in `orders`, at a given number of unknowns an amplitude: all at once where they do not repeat as teeth do. Without a
/// pattern all amplitudes of the circles of a holed part are condensed together.
pub(super) fn unknowns_of_holes(
    section: &SpurGear,
    (orders, size): (usize, usize),
    is_carried: bool,
) -> usize {
    let count = size * (2 * orders + 1);
    let repeats = repeats_of(section);
    let of_sets = sets_of_orders(orders, repeats);
    let coupled = of_sets.iter().map(|set| amplitudes(set, size)).max();
    let condensed = match section.data().blank.pattern() {
        Some(_) => 0,
        None => (CONDENSED * (count * (1 + usize::from(is_carried))) as f64) as usize,
    };
    coupled.unwrap_or(0).max(condensed)
}

/// How often teeth and holes of `section` repeat together around it.
pub(super) fn repeats_of(section: &SpurGear) -> usize {
    gcd(section.tooth_count(), section.hole_repeats().max(1)) as usize
}

/// The functions across each of `layers`, where no two layers that meet are equal in width: one polynomial, or pieces that are broken at the faces of
/// the parts above and below that end within it.
fn functions_across(
    gear: &SolidGear,
    layers: &[Layer],
    resolution: FaceResolution,
) -> Vec<AxialBasis> {
    let of = |(index, layer): (usize, &Layer)| {
        let [low, high] = layer.heights;
        let slack = FLUSH * (high - low);
        let inside = |z: &f64| *z > low + slack && *z < high - slack;
        let above = index.checked_sub(1).and_then(|above| layers.get(above));
        let meeting = above.into_iter().chain(layers.get(index + 1));
        let mut breaks: Vec<f64> = meeting.flat_map(|other| other.heights).collect();
        breaks.retain(inside);
        breaks.extend([low, high]);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|next, one| *next - *one < SAME * (high - low));
        let degree = if breaks.len() > 2 {
            resolution.piece_order()
        } else if high - low > 0.5 * gear.face_width() {
            resolution.face_order
        } else {
            resolution.web_order
        };
        AxialBasis::new(&breaks, degree)
    };
    layers.iter().enumerate().map(of).collect()
}

/// Compliance of the parts under the teeth.
#[derive(Debug)]
pub(crate) struct StackStiffness {
    /// The stiffness of each order 0 … M on the interface circle, without holes.
    pub(crate) stiffness: Vec<Mat<c64>>,
    /// The part between that circle and the web, where the web has holes.
    pub(crate) web: Option<WebPorts>,
}

/// The web's outer circle as it is seen through the rim, order by order.
#[derive(Debug)]
pub(crate) struct WebPorts {
    /// The largest order in which holes are seen.
    pub(crate) largest: usize,
    /// The orders 0 … of them.
    pub(crate) of: Vec<WebPort>,
}

/// One order of the web's outer circle.
#[derive(Debug)]
pub(crate) struct WebPort {
    /// The stiffness of the web without holes.
    pub(crate) plain: Mat<c64>,
    /// How the circle follows the interface circle.
    pub(crate) follows: Mat<c64>,
    /// Its compliance while the interface circle is held.
    pub(crate) held: Mat<c64>,
}

impl StackStiffness {
    pub(crate) fn new(stack: &Stack, run: &Run) -> Result<Self, PartError> {
        let seen = stack.hole_orders;
        // The interface circle does not carry all orders in which holes near a web's edge are seen.
        let (carried, most) = (stack.orders(), stack.orders().max(seen.unwrap_or(0)));
        let orders = (0..=most).into_par_iter();
        let of_orders = orders
            .map(|order| {
                run.check()?;
                if seen.is_some_and(|largest| order <= largest) {
                    let (stiffness, port) = through_rim(stack, order)?;
                    return Ok((stiffness, Some(port)));
                }
                // A part as wide as the rim is the rim itself.
                let inner = match stack.layers.get(1) {
                    Some(next)
                        if stack.layers_around() > 1 && next.heights == stack.layers[0].heights =>
                    {
                        let rim = stack.rim(next.inner_radius);
                        let below = stack.below(1, order, rim.twist)?;
                        return Ok((rim.on_outer(order as i64, below.as_ref())?, None));
                    }
                    _ => stack.layers[0].inner_radius,
                };
                let rim = stack.rim(inner);
                let below = stack.below(0, order, rim.twist)?;
                Ok((rim.on_outer(order as i64, below.as_ref())?, None))
            })
            .collect::<Result<Vec<_>, PartError>>()?;
        let (mut stiffness, ports): (Vec<_>, Vec<_>) = of_orders.into_iter().unzip();
        stiffness.truncate(carried + 1);
        let web = seen.map(|largest| WebPorts {
            largest,
            of: ports.into_iter().flatten().collect(),
        });
        Ok(Self { stiffness, web })
    }
}

/// The stiffness of `order` on the interface circle, and the outer circle of the web.
fn through_rim(stack: &Stack, order: usize) -> Result<(Mat<c64>, WebPort), FemError> {
    let failed = FemError::NotPositiveDefinite {
        part: "the rim",
        unknowns: 3 * stack.face.len(),
    };
    let plain = stack.plain(1, order)?.ok_or(failed.clone())?;
    let t = stack.trace_of_web(order);
    let rim = stack.rim(stack.layers[0].inner_radius);
    let mut ports = rim.on_both(order as i64)?;
    let size = ports.size;
    let web = t.adjoint() * &plain * &t;
    for j in 0..size {
        for i in 0..size {
            ports.stiffness[(i, j)] += web[(i, j)];
        }
    }
    let inner = ports.stiffness.submatrix(0, 0, size, size).to_owned();
    let factor = Cholesky::new(inner).ok_or(failed)?;
    let mut follows = ports.stiffness.submatrix(0, size, size, size).to_owned();
    factor.solve_in_place(follows.as_mut());
    let mut half = t.adjoint().to_owned();
    factor.half_solve_in_place(half.as_mut());
    let port = WebPort {
        plain,
        follows: -(&t * follows),
        held: half.adjoint() * &half,
    };
    Ok((last_of(&ports.stiffness, size)?, port))
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;
    use crate::fem::prism::Law3;
    use crate::gear::spur::tests::paper_gear;
    use crate::gear::{Core, Helix, HolePattern, Material, Web};
    use crate::quadrature::gauss_legendre;

    /// A web of so much thickness from a radius of 16 to 33 mm, its middle at +4 mm under a face of 20 mm; under it a ring as wide as the face, or none, on
    /// a bore or a shaft of the radius.
    fn stack(thickness: f64, radius: f64, core: Core) -> Stack {
        let mut data = paper_gear(40);
        data.blank.bore_radius = radius;
        data.blank.core = core;
        data.blank.web = Some(Web {
            inner_radius: 16e-3,
            outer_radius: 33e-3,
            thickness,
        });
        let gear = SolidGear::new(data, Helix::right(0.26), 4e-3, None).expect("can be made");
        Stack::new(&gear, FaceResolution::STANDARD)
    }

    /// 48 teeth 20 mm wide with round holes on a circle that reach so far; the root circle has 45.5 mm.
    fn holed_on(circle_radius: f64, count: u32, reach: f64) -> SolidGear {
        let (mut data, phase) = (paper_gear(48), 0.0);
        data.blank.bore_radius = 15e-3;
        data.blank.holes = HolePattern {
            count,
            circle_radius,
            radius: reach - circle_radius,
            phase,
        }
        .holes();
        SolidGear::new(data, Helix::STRAIGHT, 0.0, None).expect("can be made")
    }

    /// The same on a circle of 38 mm.
    fn holed(count: u32, reach: f64) -> SolidGear {
        holed_on(38e-3, count, reach)
    }

    #[test]
    fn holes_are_seen_in_the_orders_that_their_ligament_needs() {
        let orders = |reach| {
            let stack = Stack::new(&holed(7, reach), FaceResolution::STANDARD);
            stack.hole_orders.expect("it has holes")
        };
        let far = Stack::new(&holed_on(25e-3, 5, 30e-3), FaceResolution::STANDARD);
        assert_eq!(
            far.hole_orders,
            Some(FaceResolution::STANDARD.web_harmonics)
        );
        for reach in [42.5e-3, 44e-3] {
            // (reach/root)^n falls to e^−5.5.
            let ratio = (reach / 45.5e-3_f64).powi(orders(reach) as i32);
            let before = (orders(reach) - ORDER_STEP) as i32;
            let before = (reach / 45.5e-3_f64).powi(before);
            let left = (-5.5_f64).exp();
            assert!(ratio <= 1.01 * left && before > left, "{reach}");
        }
        let coarse = FaceResolution::STANDARD.at(GridLevel::Coarse);
        let seen = Stack::new(&holed(7, 44e-3), coarse).hole_orders;
        assert!(seen.is_some_and(|seen| seen < orders(44e-3)));
    }

    #[test]
    fn holes_that_need_too_many_orders_are_named_with_what_would_do() {
        let near = |count, reach| NearHoles::of(&holed(count, reach), FaceResolution::STANDARD);
        assert_eq!(near(7, 42e-3), None);
        // Eight of them repeat with every sixth tooth, and couple a quarter of the unknowns.
        assert_eq!(near(8, 44.6e-3), None);
        let found = near(7, 44.6e-3).expect("too near");
        let [needed, most] = found.orders;
        assert!(27 * (2 * most + 1) <= MOST_UNKNOWNS && needed > 2 * most);
        let by = found.narrower.expect("round holes");
        assert_eq!(near(7, 44.6e-3 - by - 1e-9), None);
        assert!(near(7, 44.6e-3 - by + 0.05e-3).is_some());
    }

    /// How far the web's outer circle moves in the mean under an even force of `order` in each of the three directions, for a unit of it.
    fn yields(stack: &Stack, order: usize) -> [f64; 3] {
        let stiffness = stack.plain(1, order).expect("definite").expect("a web");
        let factor = Cholesky::new(stiffness).expect("definite");
        let even = stack.across[1].even();
        let m = even.len();
        [0, 1, 2].map(|c| {
            let mut half = Mat::<c64>::zeros(3 * m, 1);
            for (p, f) in even.iter().enumerate() {
                half[(c * m + p, 0)] = c64::new(*f, 0.0);
            }
            factor.half_solve_in_place(half.as_mut());
            half.norm_l2().powi(2)
        })
    }

    /// `count` steps from 0 to 1, the smaller the nearer to `ends`.
    fn steps(count: usize, ends: [bool; 2]) -> Vec<f64> {
        let at = |i: usize| i as f64 / count as f64;
        let place = |t: f64| match ends {
            [true, true] => (1.0 - (std::f64::consts::PI * t).cos()) / 2.0,
            [true, false] => t * t,
            _ => 1.0 - (1.0 - t) * (1.0 - t),
        };
        (1..=count).map(|i| place(at(i))).collect()
    }

    /// The same of second-order elements in the plane of the axis, of nine nodes each, small about the corners between web and ring.
    fn by_elements(thickness: f64, radius: f64, core: Core, order: usize) -> [f64; 3] {
        let (inner, outer) = (16e-3, 33e-3);
        let torque_at = match core {
            Core::Bore => None,
            Core::Shaft { torque_at } => Some(torque_at),
        };
        let faces = [4e-3 - thickness / 2.0, 4e-3 + thickness / 2.0];
        // Lines of nodes: corners and middles.
        let lines = |pieces: &[(f64, f64, usize, [bool; 2])]| {
            let mut all = vec![pieces[0].0];
            for &(from, to, count, ends) in pieces {
                for step in steps(count, ends) {
                    let next = from + step * (to - from);
                    let last = all[all.len() - 1];
                    all.extend([f64::midpoint(last, next), next]);
                }
            }
            all
        };
        let mut radial = vec![(inner, outer, 10, [true, false])];
        if radius < inner {
            radial.insert(0, (radius, inner, 6, [false, true]));
        }
        if torque_at.is_some() {
            radial.insert(0, (0.0, radius, 8, [false, true]));
        }
        let radii = lines(&radial);
        let heights = lines(&[
            (-10e-3, faces[0], 8, [false, true]),
            (faces[0], faces[1], 6, [true, true]),
            (faces[1], 10e-3, 6, [true, false]),
        ]);
        let mut numbers = vec![[None; 3]; radii.len() * heights.len()];
        let at = |i: usize, j: usize| i * heights.len() + j;
        let mut count = 0;
        let n = order as f64;
        let mut elements = Vec::new();
        for i in (0..radii.len() - 1).step_by(2) {
            for j in (0..heights.len() - 1).step_by(2) {
                let in_web = heights[j + 1] > faces[0] && heights[j + 1] < faces[1];
                if radii[i + 1] < inner || in_web {
                    elements.push((i, j));
                }
            }
        }
        for &(i, j) in &elements {
            for (a, b) in (0..9).map(|k| (k / 3, k % 3)) {
                let node = &mut numbers[at(i + a, j + b)];
                if node.iter().any(Option::is_some) {
                    continue;
                }
                // The bore is held. Points of the axis move as one: along it in order 0, across it in order 1.
                let moves: &[(usize, usize, f64)] = match (i + a, torque_at, order) {
                    (0, None, _) | (0, _, 2..) => &[],
                    (0, _, 0) => &[(2, 0, 1.0)],
                    (0, _, 1) => &[(0, 0, 1.0), (1, 0, -1.0)],
                    _ => &[(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0)],
                };
                for &(component, ahead, share) in moves {
                    node[component] = Some((count + ahead, share));
                }
                count += moves.last().map_or(0, |(_, ahead, _)| ahead + 1);
            }
        }
        let law = Law3::new(&Material::STEEL);
        let shape = |x: f64| {
            [
                [x * (x - 1.0) / 2.0, x - 0.5],
                [1.0 - x * x, -2.0 * x],
                [x * (x + 1.0) / 2.0, x + 0.5],
            ]
        };
        let mut k = Mat::<f64>::zeros(count, count);
        let mut even = Mat::<f64>::zeros(count, 3);
        let rule = gauss_legendre(3);
        // The means that a shaft holds: which, by which share of each end, of which components, by which power of the radius.
        let along = [0.0, 0.0, 1.0];
        let each = |first: usize, components: [f64; 3], power: i32| {
            let shares = [[1.0, 0.0], [0.0, 1.0]];
            [0, 1].map(|end| (first + end, shares[end], components, power))
        };
        let means: Vec<(usize, [f64; 2], [f64; 3], i32)> = match (torque_at, order) {
            (Some(torque_at), 0) => {
                let shares = match torque_at {
                    FaceEnds::Both => [0.5, 0.5],
                    FaceEnds::Minus => [1.0, 0.0],
                    FaceEnds::Plus => [0.0, 1.0],
                };
                let shifts = each(1, along, 0);
                [vec![(0, shares, [0.0, 1.0, 0.0], 1)], shifts.to_vec()].concat()
            }
            (Some(_), 1) => [each(0, [1.0, -1.0, 0.0], 0), each(2, along, 1)].concat(),
            _ => Vec::new(),
        };
        let held_count = means.iter().map(|of| of.0 + 1).max().unwrap_or(0);
        let mut held = Mat::<f64>::zeros(count, held_count);
        for &(i, j) in &elements {
            let half = [
                0.5 * (radii[i + 2] - radii[i]),
                0.5 * (heights[j + 2] - heights[j]),
            ];
            let mut own = SMatrix::<f64, 27, 27>::zeros();
            for (x, w_x) in &rule {
                for (y, w_y) in &rule {
                    let r = radii[i + 1] + half[0] * x;
                    let mut b = SMatrix::<f64, 6, 27>::zeros();
                    let (up, along) = (shape(*x), shape(*y));
                    for (node, (p, q)) in (0..9).map(|k| (up[k / 3], along[k % 3])).enumerate() {
                        let (f, by_r, by_z) =
                            (p[0] * q[0], p[1] * q[0] / half[0], p[0] * q[1] / half[1]);
                        // u_r and u_z go with cos nφ, u_φ with sin nφ.
                        let [u, v, w] = [0, 1, 2].map(|c| 3 * node + c);
                        b[(0, u)] = by_r;
                        b[(1, u)] = f / r;
                        b[(1, v)] = n * f / r;
                        b[(2, w)] = by_z;
                        b[(3, v)] = by_r - f / r;
                        b[(3, u)] = -n * f / r;
                        b[(4, u)] = by_z;
                        b[(4, w)] = by_r;
                        b[(5, v)] = by_z;
                        b[(5, w)] = -n * f / r;
                    }
                    let mut stressed = SMatrix::<f64, 6, 27>::zeros();
                    let weight = std::f64::consts::TAU * r * w_x * w_y * half[0] * half[1];
                    for column in 0..27 {
                        let stress = law.stress(std::array::from_fn(|row| b[(row, column)]));
                        for (row, stress) in stress.into_iter().enumerate() {
                            stressed[(row, column)] = stress * weight;
                        }
                    }
                    own += b.transpose() * stressed;
                }
            }
            let number = |k: usize| numbers[at(i + k / 3, j + k % 3)];
            for (a, b) in (0..27 * 27).map(|k| (k / 27, k % 27)) {
                let of = number(a / 3)[a % 3].zip(number(b / 3)[b % 3]);
                if let Some(((one, s), (other, t))) = of {
                    k[(one, other)] += s * t * own[(a, b)];
                }
            }
            let ends = [j == 0, j + 3 == heights.len()];
            for (mean, shares, components, power) in &means {
                let at_ends = [0, 1]
                    .into_iter()
                    .filter(|end| ends[*end] && radii[i + 1] < radius);
                for (end, (x, w)) in at_ends.flat_map(|end| rule.iter().map(move |of| (end, of))) {
                    let r = radii[i + 1] + half[0] * x;
                    for (a, [f, _]) in shape(*x).into_iter().enumerate() {
                        let node = number(3 * a + 2 * end);
                        for (of, component) in node.into_iter().zip(components) {
                            if let Some((at, share)) = of {
                                let weight = w * half[0] * r.powi(power + 1) * shares[end];
                                held[(at, *mean)] += weight * f * share * component;
                            }
                        }
                    }
                }
            }
            if i + 3 == radii.len() {
                // Simpson's rule.
                for (b, part) in [1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0].into_iter().enumerate() {
                    for c in 0..3 {
                        let (at, _) = number(6 + b)[c].expect("it is free");
                        even[(at, c)] += part * half[1];
                    }
                }
            }
        }
        // With means of their own stiffness, of any size, and then such forces on these that they stand still.
        if held_count > 0 {
            let means = &held * held.transpose();
            let scale = k.norm_max() / means.norm_max();
            k += means * faer::Scale(scale);
        }
        let factor = Cholesky::new(k).expect("definite");
        factor.half_solve_in_place(even.as_mut());
        factor.half_solve_in_place(held.as_mut());
        let mut forces = held.transpose() * &even;
        Cholesky::new(held.transpose() * &held)
            .expect("definite")
            .half_solve_in_place(forces.as_mut());
        [0, 1, 2].map(|c| even.col(c).norm_l2().powi(2) - forces.col(c).norm_l2().powi(2))
    }

    #[test]
    #[ignore = "./test all"]
    fn a_web_on_a_wider_ring_yields_as_in_elements_of_both() {
        let shaft = |torque_at| Core::Shaft { torque_at };
        for (thickness, radius, core) in [
            (2.5e-3, 16e-3, Core::Bore),
            (2.5e-3, 12e-3, Core::Bore),
            (5e-3, 12e-3, Core::Bore),
            (5e-3, 12e-3, shaft(FaceEnds::Both)),
            (5e-3, 16e-3, shaft(FaceEnds::Minus)),
            (2.5e-3, 12e-3, shaft(FaceEnds::Plus)),
        ] {
            let stack = stack(thickness, radius, core);
            for order in 0..=2 {
                let found = yields(&stack, order);
                let expected = by_elements(thickness, radius, core, order);
                for (c, (found, expected)) in found.iter().zip(expected).enumerate() {
                    // Polynomials stiffen the corner between web and ring: by a hundredth of how far it tilts, and less of the rest.
                    let off = found / expected - 1.0;
                    assert!(
                        (-0.013..0.002).contains(&off),
                        "{thickness} {radius} {core:?} {order} {c}: {found} {expected}"
                    );
                }
            }
        }
    }
}
