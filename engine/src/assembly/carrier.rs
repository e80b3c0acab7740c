//! What carries the teeth of a solid gear: its rim, and below it web and hub, order by order.

use faer::{Mat, c64};
use rayon::prelude::*;

use super::{FaceResolution, PartError};
use crate::fem::FemError;
use crate::fem::axial::AxialBasis;
use crate::fem::dense::Cholesky;
use crate::gear::{Layer, SolidGear};
use crate::grid::GridLevel;
use crate::ring::solid::joint::{carried, trace};
use crate::ring::solid::revolution::{Revolution, last_of};
use crate::run::Run;

/// The orders that the interface circle carries: fields of the teeth fall to e^−this on their way to it.
const DECAY: f64 = 4.5;
/// Orders on it for each tooth, at most: beyond, the grids do not follow.
const MOST_ORDERS_PER_TOOTH: usize = 8;
/// A web whose face is nearer to that of the rim, as a part of its width, is flush with it.
const FLUSH: f64 = 0.02;
/// How much of the way from holes that stand in the rim itself to the interface circle belongs to the holed part.
const HOLED_PART: f64 = 0.75;
/// Fields of such holes fall to e^−this on their way out, to the first order that is left out; at most so many orders are kept.
const HOLE_DECAY: f64 = 3.25;
const MOST_HOLE_ORDERS: usize = 24;

/// The parts of a gear from its root circle to its bore, each with its functions along the axis: all that its yield depends on, but
/// for the holes.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// The gear with plain flanks and without holes.
    pub(crate) gear: SolidGear,
    /// The functions across the face, of teeth and rim.
    pub(crate) face: AxialBasis,
    /// Where the teeth meet what carries them.
    pub(crate) interface_radius: f64,
    /// From the rim to the bore.
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
        let interface_above = |radius: f64| (root - module).max(f64::midpoint(root, radius));
        let mut interface_radius = interface_above(layers[0].inner_radius);
        let mut hole_orders = None;
        if let Some(reach) = section.data().blank.outer_reach() {
            hole_orders = Some(resolution.web_harmonics);
            if reach > layers[0].inner_radius {
                // Holes in the rim itself: its inner part is the holed one.
                interface_radius = interface_above(reach);
                let edge = reach + HOLED_PART * (interface_radius - reach);
                let orders = (HOLE_DECAY * edge / (edge - reach)).ceil() as usize;
                hole_orders = Some(orders.clamp(resolution.web_harmonics, MOST_HOLE_ORDERS));
                let rim = Layer {
                    inner_radius: edge,
                    ..layers[0]
                };
                layers[0].outer_radius = edge;
                layers.insert(0, rim);
            }
        }
        let face = face_basis(gear, &layers, resolution);
        let mut across = vec![face.clone()];
        across.extend(layers[1..].iter().map(|layer| {
            let width = layer.heights[1] - layer.heights[0];
            let degree = if width > 0.5 * gear.face_width() {
                resolution.face_order
            } else {
                resolution.web_order
            };
            AxialBasis::new(&layer.heights, degree)
        }));
        Self {
            gear: gear.with_plain_flanks().without_holes(),
            face,
            interface_radius,
            layers,
            across,
            hole_orders,
            sections: resolution.sections,
        }
    }

    /// The orders that the interface circle carries.
    fn orders(&self) -> usize {
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
        let below = self.below(index, order, body.twist)?;
        body.on_outer(order as i64, below.as_ref()).map(Some)
    }

    /// Layer `index` below the rim, without holes: it stands still, while the rim turns.
    pub(crate) fn layer(&self, index: usize) -> Revolution<'_> {
        let layer = &self.layers[index];
        Revolution {
            material: self.gear.section().material(),
            twist: 0.0,
            axial: &self.across[index],
            radii: [layer.inner_radius, layer.outer_radius],
        }
    }

    /// What carries `order` on the inner circle of layer `index`, on the functions across that layer, whose frame turns by `twist`.
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
        carried(&under, lower, upper, order as i64, twist).map(Some)
    }
}

/// The functions across the face: one polynomial, or pieces that are broken where the rim stands on a narrower web.
fn face_basis(gear: &SolidGear, layers: &[Layer], resolution: FaceResolution) -> AxialBasis {
    let [low, high] = gear.face_heights();
    let slack = FLUSH * (high - low);
    let inside = |z: &f64| *z > low + slack && *z < high - slack;
    let mut breaks = vec![low, high];
    if let [_, web, ..] = layers {
        breaks.extend(web.heights.into_iter().filter(inside));
        breaks.sort_by(f64::total_cmp);
    }
    if breaks.len() == 2 {
        AxialBasis::new(&breaks, resolution.face_order)
    } else {
        AxialBasis::new(&breaks, resolution.piece_order())
    }
}

/// What carries the teeth.
#[derive(Debug)]
pub(crate) struct Carrier {
    /// The stiffness of each order 0 … M on the interface circle, without holes.
    pub(crate) stiffness: Vec<Mat<c64>>,
    /// What stands between that circle and the web, where the web has holes.
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

impl Carrier {
    pub(crate) fn new(stack: &Stack, run: &Run) -> Result<Self, PartError> {
        let seen = stack.hole_orders;
        let orders = (0..=stack.orders()).into_par_iter();
        let of_orders = orders
            .map(|order| {
                run.check()?;
                if seen.is_some_and(|largest| order <= largest) {
                    let (stiffness, port) = through_rim(stack, order)?;
                    return Ok((stiffness, Some(port)));
                }
                // A part as wide as the rim is the rim itself.
                let inner = match stack.layers.get(1) {
                    Some(next) if next.heights == stack.layers[0].heights => {
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
        let (stiffness, ports): (Vec<_>, Vec<_>) = of_orders.into_iter().unzip();
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
