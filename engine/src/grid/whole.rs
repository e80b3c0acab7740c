//! The grid of a whole blank: any holes, and a web.
//!
//! The boundaries are divided by a field of sizes, the material between them is triangulated and smoothed at the coarse level
//! (`triangles`), and each finer level halves every triangle, with new nodes on the true curves. All of it happens in
//! interface radii with the last digits cut off, so that similar blanks are divided alike.

use super::outline::Outline;
use super::outlines::{LEAST_AROUND, Outlines};
use super::sizes::{Boundary, Sizes};
use super::triangles::{Chain, TriangleNet};
use super::{BlankGrid, Element, Grid, GridError, GridLevel, checked};
use crate::gear::{BlankRegion, Hole, HoleShape, Ligament, Vector, Web};

/// Elements around a round hole at the coarse level, and along as much of a slot: half those of the structured blank at the
/// standard level.
const AROUND_HOLE: f64 = 16.0;
/// How much smaller triangles are made where some come out distorted, and how often.
const SMALLER: f64 = 0.75;
const MOST_TRIES: i32 = 4;
/// What counts as on the web's edge, in interface radii: more than rounding, less than any element.
const ON_CIRCLE: f64 = 1e-9;
/// Parts along each side of a triangle that the web's edge crosses, for the share of either thickness.
const WEB_PARTS: usize = 16;
/// What is cut off of numbers in interface radii: a thousandth of the rounding in which similar gears differ.
const DIGITS: f64 = (1_u64 << 40) as f64;

impl BlankGrid {
    /// Divides the whole of `region` inside `interface_radius` into triangles with `elements_per_turn` of them on the
    /// interface circle at the standard level, nothing taken from symmetry. The web is as thick as it is in parts of
    /// `face_width`.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the ring has no width, if the holes leave no material around them, or if an element is distorted
    /// whatever the sizes.
    pub fn whole(
        region: &BlankRegion,
        face_width: f64,
        interface_radius: f64,
        elements_per_turn: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        check(region, interface_radius)?;
        let region = &BlankRegion {
            web: region.web_in(face_width),
            ..region.clone()
        };
        let plan = Plan::new(region, interface_radius, elements_per_turn);
        let part = region.web.map_or(1.0, |web| web.thickness / face_width);
        let mut last = GridError::Distorted {
            smallest_jacobian: f64::NAN,
            smallest_angle: 0.0,
            largest_angle: 0.0,
        };
        for attempt in 0..MOST_TRIES {
            let Some(blank) = plan.divide(SMALLER.powi(attempt), part, level) else {
                continue;
            };
            let scaled = blank.scaled(interface_radius);
            match checked(scaled.grid) {
                Ok(grid) => return Ok(Self { grid, ..scaled }),
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    fn scaled(mut self, factor: f64) -> Self {
        for node in &mut self.grid.nodes {
            *node *= factor;
        }
        self
    }
}

/// Refuses a ring without width and holes without material around them.
fn check(region: &BlankRegion, interface_radius: f64) -> Result<(), GridError> {
    let bore_radius = region.bore_radius;
    if !(bore_radius > 0.0 && bore_radius < interface_radius && interface_radius.is_finite()) {
        return Err(GridError::InterfaceInsideBore {
            interface_radius,
            bore_radius,
        });
    }
    let [mut beside, mut above, mut below] = [f64::INFINITY; 3];
    for (place, left) in region.ligaments(interface_radius) {
        let least = match place {
            Ligament::Between(..) | Ligament::WithinSlot(_) => &mut beside,
            Ligament::ToRim(_) => &mut above,
            Ligament::ToBore(_) => &mut below,
        };
        // Not `min`, which would pass over what is not a number.
        if left < *least || left.is_nan() {
            *least = left;
        }
    }
    let wide = region.holes.iter().all(|hole| hole.half_width() > 0.0);
    if beside > 0.0 && above > 0.0 && below > 0.0 && wide {
        Ok(())
    } else {
        Err(GridError::NoLigament {
            beside,
            above,
            below,
        })
    }
}

/// A region in interface radii, with the sizes that it asks for.
struct Plan {
    region: BlankRegion,
    boundaries: Vec<Boundary>,
}

impl Plan {
    fn new(region: &BlankRegion, interface_radius: f64, elements_per_turn: f64) -> Self {
        let short = |number: f64| (number * DIGITS).round() / DIGITS;
        let length = |length: f64| short(length / interface_radius);
        let region = BlankRegion {
            bore_radius: length(region.bore_radius),
            holes: region
                .holes
                .iter()
                .map(|hole| Hole {
                    circle_radius: length(hole.circle_radius),
                    angle: short(hole.angle),
                    shape: match hole.shape.simplest() {
                        HoleShape::Round { radius } => HoleShape::Round {
                            radius: length(radius),
                        },
                        HoleShape::Slot { width, angle } => HoleShape::Slot {
                            width: length(width),
                            angle: short(angle),
                        },
                    },
                })
                .collect(),
            web: region.web.map(|web| Web {
                inner_radius: length(web.inner_radius),
                outer_radius: length(web.outer_radius),
                ..web
            }),
        };
        let circle = |radius| Outline::Circle { radius };
        let around = |half_width: f64| std::f64::consts::TAU * half_width / AROUND_HOLE;
        let interface = circle(1.0);
        let coarse = GridLevel::Coarse.count(elements_per_turn).max(LEAST_AROUND);
        let mut boundaries = vec![
            Boundary {
                outline: interface,
                size: interface.length() / coarse as f64,
                around: true,
            },
            Boundary {
                outline: circle(region.bore_radius),
                size: around(region.bore_radius),
                around: false,
            },
        ];
        boundaries.extend(region.holes.iter().map(|hole| Boundary {
            outline: Outline::Edge(*hole),
            size: around(hole.half_width()),
            around: false,
        }));
        Self { region, boundaries }
    }

    /// The grid with all sizes times `scale`, in interface radii; `None` where boundaries cross in their divisions.
    fn divide(&self, scale: f64, web_part: f64, level: GridLevel) -> Option<BlankGrid> {
        let sizes = Sizes {
            boundaries: self.boundaries.clone(),
            scale,
        };
        let (points, chains) = Outlines::new(&self.boundaries, &self.web_edges(), &sizes).finish();
        let mut net = TriangleNet::new(points, chains, &sizes)?;
        for _ in 0..level.halvings() {
            net.halve();
        }
        let (mut grid, chains) = net.into_grid();
        self.thin(&mut grid, web_part);
        Some(self.blank(grid, chains))
    }

    /// The circles on which the thickness changes, within the material.
    fn web_edges(&self) -> Vec<f64> {
        let ends = self
            .region
            .web
            .map(|web| [web.inner_radius, web.outer_radius]);
        let bore = self.region.bore_radius;
        let within = |r: &f64| *r > bore && *r < 1.0;
        ends.into_iter().flatten().filter(within).collect()
    }

    /// Gives every element in the web its thickness `part`; one that the web's edge crosses takes the mean by area.
    fn thin(&self, grid: &mut Grid, part: f64) {
        let Some(web) = self.region.web else { return };
        for i in 0..grid.elements.len() {
            let share = share_within(
                grid,
                &grid.elements[i],
                (web.inner_radius, web.outer_radius),
            );
            let thickness = match share {
                0.0 => 1.0,
                1.0 => part,
                share => 1.0 + share * (part - 1.0),
            };
            grid.elements[i] = grid.elements[i].of_thickness(thickness);
        }
    }

    fn blank(&self, grid: Grid, chains: Vec<Chain>) -> BlankGrid {
        let mut nodes = chains.iter().map(|chain| chain.nodes.clone());
        let (arc_nodes, bore_nodes) = (
            nodes.next().unwrap_or_default(),
            nodes.next().unwrap_or_default(),
        );
        BlankGrid {
            grid,
            sector_count: 1,
            arc_angles: chains[0]
                .lengths
                .iter()
                .map(|s| s - std::f64::consts::PI)
                .collect(),
            arc_nodes,
            bore_nodes,
            side_nodes: (Vec::new(), Vec::new()),
            hole_edges: nodes.take(self.region.holes.len()).collect(),
        }
    }
}

/// The share of a triangle's area that lies between two radii; all of it or nothing, to the digit, where its nodes do.
fn share_within(grid: &Grid, element: &Element, (inner, outer): (f64, f64)) -> f64 {
    let radii = element
        .nodes()
        .iter()
        .map(|node| grid.nodes[*node as usize].norm());
    let (low, high) = radii.fold((f64::INFINITY, 0.0_f64), |(low, high), r| {
        (low.min(r), high.max(r))
    });
    if low >= inner - ON_CIRCLE && high <= outer + ON_CIRCLE {
        return 1.0;
    }
    if high <= inner + ON_CIRCLE || low >= outer - ON_CIRCLE {
        return 0.0;
    }
    let places = element.places(&grid.nodes);
    let parts = WEB_PARTS as f64;
    let mut within = 0;
    // The centers of the equal parts of the reference triangle, upright and upside down.
    for i in 0..WEB_PARTS {
        for j in 0..WEB_PARTS - i {
            for third in [1.0, 2.0]
                .iter()
                .take(if i + j + 1 < WEB_PARTS { 2 } else { 1 })
            {
                let (xi, eta) = (
                    (i as f64 + third / 3.0) / parts,
                    (j as f64 + third / 3.0) / parts,
                );
                let values = element.kind().values(xi, eta);
                let point: Vector = places.iter().zip(values).map(|(p, n)| *p * n).sum();
                within += u32::from(point.norm() > inner && point.norm() < outer);
            }
        }
    }
    f64::from(within) / (parts * parts)
}
