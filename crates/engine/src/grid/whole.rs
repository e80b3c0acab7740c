//! The grid of a whole blank: any holes, and a web.
//!
//! The boundaries are divided by a field of sizes, the material between them is triangulated and smoothed at the coarse level
//! (`triangles`), and each finer level halves every triangle, with new nodes on the true curves. All of it happens in
//! interface radii with the last digits cut off, so that similar blanks have similar grids.

use super::outline::Outline;
use super::outlines::{LEAST_AROUND, Outlines};
use super::sizes::{Boundary, Sizes};
use super::triangles::{Chain, TriangleNet};
use super::{BlankGrid, Element, Grid, GridError, GridLevel, checked};
use crate::gear::{BlankRegion, Core, Hole, HoleShape, Ligament, Vector, Web};

/// Elements around a round hole at the coarse level, and along as much of a slot: half those of the structured blank at the
/// standard level.
const AROUND_HOLE: f64 = 16.0;
/// How much smaller triangles are made where some come out distorted, and how often.
const SMALLER: f64 = 0.75;
const MOST_TRIES: i32 = 4;
/// Distance that counts as on the web's edge, in interface radii: more than rounding, less than any element.
const ON_CIRCLE: f64 = 1e-9;
/// Parts along each side of a triangle that the web's edge crosses, for the share of either thickness.
const WEB_PARTS: usize = 16;
/// Rounding of numbers in interface radii: a thousandth of the rounding in which similar gears differ.
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
        // Not `min`, which would ignore a value that is not a number.
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
            core: Core::Bore,
            holes: region
                .holes
                .iter()
                .map(|hole| Hole {
                    circle_radius: length(hole.circle_radius),
                    angle: short(hole.angle),
                    shape: match hole.shape.clone().simplest() {
                        HoleShape::Round { radius } => HoleShape::Round {
                            radius: length(radius),
                        },
                        HoleShape::Slot { width, angle } => HoleShape::Slot {
                            width: length(width),
                            angle: short(angle),
                        },
                        HoleShape::Contour(contour) => {
                            HoleShape::Contour(contour.scaled(1.0 / interface_radius, short))
                        }
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
        let (interface, turn) = (circle(1.0), std::f64::consts::TAU);
        let coarse = GridLevel::Coarse.count(elements_per_turn).max(LEAST_AROUND);
        let mut boundaries = vec![
            Boundary::new(interface, turn / coarse as f64, true, Vec::new()),
            Boundary::new(
                circle(region.bore_radius),
                around(region.bore_radius),
                false,
                Vec::new(),
            ),
        ];
        boundaries.extend(region.holes.iter().map(|hole| {
            let outline = Outline::Edge(hole.clone());
            let details = outline.details(AROUND_HOLE);
            Boundary::new(outline, around(hole.half_width()), false, details)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{Contour, Side, Spokes};

    const LEVELS: [GridLevel; 3] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine];
    const FACE_WIDTH: f64 = 20e-3;
    const INTERFACE: f64 = 45.5e-3;

    fn round(circle_radius: f64, angle: f64, radius: f64) -> Hole {
        Hole {
            circle_radius: circle_radius * 1e-3,
            angle,
            shape: HoleShape::Round {
                radius: radius * 1e-3,
            },
        }
    }

    fn slot(circle_radius: f64, angle: f64, width: f64, span: f64) -> Hole {
        Hole {
            circle_radius: circle_radius * 1e-3,
            angle,
            shape: HoleShape::Slot {
                width: width * 1e-3,
                angle: span,
            },
        }
    }

    fn region(bore: f64, holes: Vec<Hole>, web: Option<(f64, f64)>) -> BlankRegion {
        BlankRegion {
            bore_radius: bore * 1e-3,
            core: Core::Bore,
            holes,
            web: web.map(|(inner, outer)| Web {
                inner_radius: inner * 1e-3,
                outer_radius: outer * 1e-3,
                thickness: 5e-3,
            }),
        }
    }

    /// Holes of all kinds and places: unequal, thin ligaments, slots long and short, tiny ones, and webs whose edges cross
    /// them, touch them, and lie next to the bore and the interface circle.
    fn regions() -> Vec<BlankRegion> {
        let unequal = vec![
            round(30.0, 0.0, 10.0),
            round(30.0, 1.7, 8.0),
            round(30.0, 3.2, 9.0),
            round(30.0, 4.6, 6.0),
        ];
        let slots = vec![
            slot(28.0, 0.0, 12.0, 0.9),
            slot(28.0, 1.6, 12.0, 0.9),
            slot(28.0, 3.3, 8.0, 1.2),
            slot(36.0, 3.3, 3.0, 1.2),
            round(20.0, 5.0, 4.0),
        ];
        let nearly_round = [1e-9, 1e-3, 0.1].map(|span| slot(28.0, 1.0 + 20.0 * span, 6.0, span));
        vec![
            region(15.0, Vec::new(), None),
            region(1.0, Vec::new(), None),
            region(15.0, unequal.clone(), None),
            region(
                15.0,
                vec![round(30.0, 0.0, 14.5), round(34.0, 3.7, 11.0)],
                None,
            ),
            region(12.0, slots, None),
            region(
                10.0,
                vec![round(28.0, 1.0, 0.5), round(30.0, 3.0, 0.7)],
                None,
            ),
            region(10.0, vec![slot(28.0, 1.0, 6.0, 5.9)], None),
            region(10.0, nearly_round[..1].to_vec(), None),
            region(10.0, nearly_round[2..].to_vec(), None),
            region(12.0, Vec::new(), Some((20.0, 40.0))),
            region(12.0, unequal, Some((20.0, 40.0))),
            region(
                12.0,
                vec![round(30.0, 0.0, 7.0), round(30.0, 3.2, 11.0)],
                Some((20.0, 40.0)),
            ),
            region(12.0, vec![slot(30.0, 0.0, 20.0, 0.9)], Some((20.0, 40.0))),
            region(12.0, vec![round(30.0, 0.0, 7.0)], Some((12.01, 45.3))),
            region(12.0, vec![round(30.0, 0.0, 7.0)], Some((25.0, 60.0))),
            region(12.0, spokes(5, 4.0, 3.0), None),
            region(12.0, spokes(8, 2.0, 1.0), Some((15.0, 42.0))),
            region(12.0, spokes(3, 6.0, 2.0), Some((25.0, 31.0))),
            region(12.0, vec![cornered(), round(30.0, 3.0, 8.0)], None),
        ]
    }

    fn spokes(count: u32, width: f64, fillet_radius: f64) -> Vec<Hole> {
        let spokes = Spokes {
            count,
            width: width * 1e-3,
            fillet_radius: fillet_radius * 1e-3,
            inner_radius: 19e-3,
            outer_radius: 39e-3,
            phase: 0.4,
        };
        spokes.openings().expect("spokes")
    }

    /// An opening with sharp corners, a notch and an arc, beside the axis.
    fn cornered() -> Hole {
        let at = |x: f64, y: f64| 1e-3 * Vector::new(x, y);
        let corners = [
            (at(22.0, -12.0), 0.0),
            (at(34.0, -12.0), 0.3),
            (at(34.0, 12.0), 0.0),
            (at(22.0, 12.0), 0.0),
            (at(22.0, 3.0), 0.0),
            (at(28.0, 0.0), 0.0),
            (at(22.0, -3.0), 0.0),
        ];
        let side = |i: usize| Side::new(corners[i].0, corners[(i + 1) % 7].0, corners[i].1);
        Contour::opening(&(0..7).map(side).collect::<Vec<_>>()).expect("an opening")
    }

    fn whole(region: &BlankRegion, level: GridLevel) -> BlankGrid {
        BlankGrid::whole(region, FACE_WIDTH, INTERFACE, 200.0, level)
            .unwrap_or_else(|error| panic!("{region:?} at {level:?}: {error}"))
    }

    #[test]
    fn blanks_of_all_regions_keep_angles_above_twenty_degrees() {
        for region in regions() {
            for level in LEVELS {
                let quality = whole(&region, level).grid.quality();
                let angle = quality.smallest_angle.to_degrees();
                assert!(angle > 20.0, "{region:?} {level:?}: {angle}");
                assert!(quality.smallest_jacobian > 0.5);
            }
        }
    }

    #[test]
    fn a_blank_has_the_area_and_the_volume_of_its_region() {
        for region in regions() {
            for (level, bound) in [(GridLevel::Standard, 2e-5), (GridLevel::Fine, 2e-6)] {
                let grid = whole(&region, level).grid;
                let disc = crate::gear::Moments::of_disc(INTERFACE).area;
                let area =
                    disc - std::f64::consts::PI * region.bore_radius.powi(2) - region.hole_area();
                // Parabolic sides miss an arc by the fourth power of its angle.
                assert!((grid.area() / area - 1.0).abs() < bound);
                let inside = BlankRegion {
                    web: region.web.map(|web| Web {
                        outer_radius: web.outer_radius.min(INTERFACE),
                        ..web
                    }),
                    ..region.clone()
                };
                let volume = disc * FACE_WIDTH - inside.taken_away(FACE_WIDTH).area;
                let found = grid.weighted_area() * FACE_WIDTH;
                // Elements that the web's edge crosses take its share by a lattice of points, which may miss a sixteenth of one.
                assert!(
                    (found / volume - 1.0).abs() < 5e-4,
                    "{region:?} {level:?}: {found} {volume}"
                );
            }
        }
    }

    #[test]
    fn each_level_halves_every_triangle_and_keeps_its_corners() {
        for region in regions() {
            let [coarse, standard, fine] = LEVELS.map(|level| whole(&region, level));
            let count = |blank: &BlankGrid| blank.grid.elements.len();
            assert_eq!(
                (4 * count(&coarse), 4 * count(&standard)),
                (count(&standard), count(&fine))
            );
            for (i, element) in coarse.grid.elements.iter().enumerate() {
                let corner = element.nodes()[0] as usize;
                let same = standard.grid.elements[4 * i].nodes()[0] as usize;
                assert_eq!(coarse.grid.nodes[corner], standard.grid.nodes[same]);
            }
        }
    }

    #[test]
    fn boundary_nodes_lie_on_their_curves_in_order() {
        for region in regions() {
            let blank = whole(&region, GridLevel::Standard);
            let point = |node: &u32| blank.grid.nodes[*node as usize];
            for (nodes, r) in [
                (&blank.arc_nodes, INTERFACE),
                (&blank.bore_nodes, region.bore_radius),
            ] {
                // Radii are shortened to twelve digits.
                assert!(
                    nodes
                        .iter()
                        .all(|n| (point(n).norm() - r).abs() < 1e-12 * INTERFACE)
                );
                assert!(
                    nodes.len().is_multiple_of(4),
                    "corner, midside, ..., halved once"
                );
            }
            assert_eq!(blank.arc_nodes.len(), blank.arc_angles.len());
            assert!(blank.arc_angles.windows(2).all(|a| a[0] < a[1]));
            for (node, angle) in blank.arc_nodes.iter().zip(&blank.arc_angles) {
                let p = point(node);
                assert!((p.y.atan2(p.x) - angle).sin().abs() < 1e-13);
            }
            assert_eq!(blank.hole_edges.len(), region.holes.len());
            for (edge, hole) in blank.hole_edges.iter().zip(&region.holes) {
                assert!(
                    edge.iter()
                        .all(|n| hole.distance_to(point(n)).abs() < 1e-12)
                );
                let area: f64 = (0..edge.len())
                    .map(|i| (point(&edge[i]), point(&edge[(i + 1) % edge.len()])))
                    .map(|(p, q)| (p.x * q.y - p.y * q.x) / 2.0)
                    .sum();
                assert!(area > 0.0, "counter-clockwise");
            }
            let mut used = vec![false; blank.grid.nodes.len()];
            for node in blank
                .grid
                .elements
                .iter()
                .flat_map(|element| element.nodes())
            {
                used[*node as usize] = true;
            }
            assert!(
                used.iter().all(|used| *used),
                "every node belongs to an element"
            );
        }
    }

    #[test]
    fn similar_blanks_have_similar_grids() {
        for region in regions() {
            let factor = 7.3;
            let scaled = BlankRegion {
                bore_radius: factor * region.bore_radius,
                core: Core::Bore,
                holes: region
                    .holes
                    .iter()
                    .map(|hole| Hole {
                        circle_radius: factor * hole.circle_radius,
                        shape: match hole.shape {
                            HoleShape::Round { radius } => HoleShape::Round {
                                radius: factor * radius,
                            },
                            HoleShape::Slot { width, angle } => HoleShape::Slot {
                                width: factor * width,
                                angle,
                            },
                            HoleShape::Contour(ref contour) => {
                                HoleShape::Contour(contour.scaled(factor, |number| number))
                            }
                        },
                        ..hole.clone()
                    })
                    .collect(),
                web: region.web.map(|web| Web {
                    inner_radius: factor * web.inner_radius,
                    outer_radius: factor * web.outer_radius,
                    ..web
                }),
            };
            let one = whole(&region, GridLevel::Coarse);
            let other = BlankGrid::whole(
                &scaled,
                FACE_WIDTH,
                factor * INTERFACE,
                200.0,
                GridLevel::Coarse,
            )
            .expect("a blank");
            assert_eq!(one.grid.elements, other.grid.elements);
            for (p, q) in one.grid.nodes.iter().zip(&other.grid.nodes) {
                assert!((factor * p - q).norm() < 1e-14 * factor);
            }
        }
    }

    #[test]
    fn rings_and_ligaments_without_width_are_refused() {
        let refused = |region: &BlankRegion| {
            BlankGrid::whole(region, FACE_WIDTH, INTERFACE, 200.0, GridLevel::Coarse)
                .expect_err("a refusal")
        };
        assert!(matches!(
            refused(&region(45.5, Vec::new(), None)),
            GridError::InterfaceInsideBore { .. }
        ));
        assert!(matches!(
            refused(&region(f64::NAN, Vec::new(), None)),
            GridError::InterfaceInsideBore { .. }
        ));
        let overlapping = vec![round(30.0, 0.0, 8.0), slot(30.0, 0.5, 6.0, 0.5)];
        let GridError::NoLigament { beside, .. } = refused(&region(15.0, overlapping, None)) else {
            panic!("they overlap")
        };
        assert!(beside < 0.0);
        for (hole, place) in [(round(37.0, 0.0, 8.6), 0), (round(23.0, 0.0, 8.1), 1)] {
            let GridError::NoLigament { above, below, .. } =
                refused(&region(15.0, vec![hole], None))
            else {
                panic!("it breaks through")
            };
            assert!([above, below][place] < 0.0);
        }
        assert!(matches!(
            refused(&region(15.0, vec![round(30.0, 0.0, 0.0)], None)),
            GridError::NoLigament { .. }
        ));
    }
}
