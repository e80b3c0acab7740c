//! One sector of a blank in structured blocks of quadrilaterals: one pitch without holes, or the surroundings of one hole.
//!
//! The sector is laid out in the chart of its ring.

use std::f64::consts::PI;

use super::block::{Edge, GridBuilder, backwards};
use super::chart::{FIRST_LAYER, GROWTH, LARGEST, LAYERS, Ring, RingWeb};
use super::division::{Grading, reversed, uniform};
use super::frame::Frame;
use super::hole_box::HoleBox;
use super::{BlankGrid, GridError, GridLevel, checked};
use crate::gear::{HolePattern, Web};

/// The least way between a hole and the edge of a web on which its box may end, in widths of the hole: two hundredths
/// of its radius. Whatever is nearer is divided as a whole.
const LEAST_ROOM: f64 = 0.01;

/// A sector that can be divided.
#[derive(Debug)]
pub(super) struct Sector<'a> {
    ring: Ring,
    tooth_count: u32,
    holes: Option<&'a HolePattern>,
}

/// The lines below and above a hole, rising; the last of the inner ones and the first of the outer ones are next to it.
struct Surroundings {
    inner: Vec<f64>,
    outer: Vec<f64>,
}

impl Surroundings {
    /// The lines next to the hole.
    fn nearest(&self) -> (f64, f64) {
        (self.inner[self.inner.len() - 1], self.outer[0])
    }
}

impl<'a> Sector<'a> {
    /// The sector of a ring as [`BlankGrid::new`] describes it.
    pub(super) fn new(
        bore_radius: f64,
        interface_radius: f64,
        holes: Option<&'a HolePattern>,
        tooth_count: u32,
        elements_per_tooth: f64,
        level: GridLevel,
    ) -> Result<Self, GridError> {
        if !(bore_radius > 0.0 && bore_radius < interface_radius && interface_radius.is_finite()) {
            return Err(GridError::InterfaceInsideBore {
                interface_radius,
                bore_radius,
            });
        }
        let tooth_count = tooth_count.max(1);
        let holes = holes.filter(|holes| holes.count > 0);
        if let Some(holes) = holes {
            let (beside, above, below) = (
                holes.ligament_between(),
                interface_radius - holes.outer_reach(),
                holes.inner_reach() - bore_radius,
            );
            if !(beside > 0.0 && above > 0.0 && below > 0.0 && holes.radius > 0.0) {
                return Err(GridError::NoLigament {
                    beside,
                    above,
                    below,
                });
            }
        }
        let ring = Ring {
            interface_radius,
            bore: (bore_radius / interface_radius).ln(),
            arc_size: 2.0 * PI / (elements_per_tooth * f64::from(tooth_count)),
            elements_per_tooth,
            level,
            web: None,
        };
        Ok(Self {
            ring,
            tooth_count,
            holes,
        })
    }

    /// The sector with a web, if the lines of one can be those of a structured grid.
    pub(super) fn with_web(mut self, web: Option<Web>, face_width: f64) -> Option<Self> {
        let chart = |radius: f64| (radius / self.ring.interface_radius).ln();
        self.ring.web = web.map(|web| RingWeb {
            ends: [chart(web.inner_radius), chart(web.outer_radius)],
            part: web.thickness / face_width,
        });
        let fits = self
            .holes
            .is_none_or(|holes| self.ring.around(holes).is_some());
        fits.then_some(self)
    }

    /// The grid.
    pub(super) fn divide(&self) -> Result<BlankGrid, GridError> {
        let around = self
            .holes
            .and_then(|holes| Some((holes, self.ring.around(holes)?)));
        let blank = match around {
            None => self.ring.solid(self.tooth_count),
            Some((holes, around)) => self.ring.holed(holes, &around),
        };
        Ok(BlankGrid {
            grid: checked(blank.grid)?,
            ..blank
        })
    }
}

impl Ring {
    /// The lines next to the hole on either side, between which its box stays, and those beyond; `None` if one runs through
    /// the hole or closer to it than a box has room for.
    fn around(&self, holes: &HolePattern) -> Option<Surroundings> {
        let reach = |radius: f64| (radius / self.interface_radius).ln();
        let (low, high) = (reach(holes.inner_reach()), reach(holes.outer_reach()));
        let room = LEAST_ROOM * (high - low);
        let lines = self.lines();
        let inner = lines.iter().filter(|x| **x <= low - room).count();
        let outer = lines.iter().filter(|x| **x >= high + room).count();
        // Bore and interface circle may come as close as they like.
        let (inner, outer) = (inner.max(1), outer.max(1));
        (inner + outer == lines.len()).then(|| Surroundings {
            inner: lines[..inner].to_vec(),
            outer: lines[inner..].to_vec(),
        })
    }

    /// One pitch of a blank without holes.
    fn solid(&self, tooth_count: u32) -> BlankGrid {
        let half = PI / f64::from(tooth_count);
        let lines = self.lines();
        let whole = Grading {
            length: -self.bore,
            first: FIRST_LAYER * self.arc_size,
            last: f64::INFINITY,
            growth: GROWTH,
            largest: LARGEST,
        };
        let least = |row: usize| if row + 2 == lines.len() { LAYERS } else { 2 };
        let rays: Vec<_> = (0..lines.len() - 1)
            .map(|row| {
                let layers = Grading {
                    length: lines[row + 1] - lines[row],
                    // Sizes go on from line to line.
                    first: if row + 2 == lines.len() {
                        whole.first
                    } else {
                        whole.size(-lines[row + 1])
                    },
                    ..whole
                };
                reversed(&layers.divide(layers.count_at(least(row), self.level)))
            })
            .collect();
        let arcs = uniform(self.level.count(self.elements_per_tooth));
        let mut builder = GridBuilder::default();
        let frame = Frame::new(
            &mut builder,
            (&lines, &[-half, half]),
            &rays,
            &vec![vec![arcs]; lines.len()],
        );
        for row in 0..rays.len() {
            builder.thickness = self.thickness(lines[row], lines[row + 1]);
            frame.fill(&mut builder, row, 0);
        }
        frame.blank(builder, self.interface_radius, tooth_count, Vec::new())
    }

    /// The sector of one hole.
    fn holed(&self, holes: &HolePattern, around: &Surroundings) -> BlankGrid {
        let hole = HoleBox::new(self, holes, around.nearest());
        let plan = hole.plan(self, around.nearest());
        let mut builder = GridBuilder::default();

        // Lines of equal radius and of equal angle, outward and counter-clockwise; the box stands between two of each.
        let (mut radii, mut rays) = (vec![hole.inner, hole.outer], vec![plan.side.clone()]);
        let (mut angles, mut columns) = (vec![-hole.beta, hole.beta], 1);
        let (mut inner_arcs, mut outer_arcs) = (vec![plan.inner.clone()], vec![plan.outer.clone()]);
        let mut box_column = 0;
        let inward = plan
            .below
            .into_iter()
            .chain(self.strips(&around.inner, true));
        for (fractions, line) in inward {
            radii.insert(0, line);
            rays.insert(0, fractions);
        }
        let box_row = rays.len() - 1;
        for (fractions, line) in plan
            .above
            .into_iter()
            .chain(self.strips(&around.outer, false))
        {
            radii.push(line);
            rays.push(fractions);
        }
        if let Some(fractions) = plan.beside {
            angles.insert(0, -hole.half_pitch);
            angles.push(hole.half_pitch);
            for arcs in [&mut inner_arcs, &mut outer_arcs] {
                arcs.insert(0, reversed(&fractions));
                arcs.push(fractions.clone());
            }
            box_column = 1;
            columns = 3;
        }
        let arcs: Vec<_> = (0..radii.len())
            .map(|row| {
                if row <= box_row {
                    inner_arcs.clone()
                } else {
                    outer_arcs.clone()
                }
            })
            .collect();
        let frame = Frame::new(&mut builder, (&radii, &angles), &rays, &arcs);
        for row in 0..rays.len() {
            for column in 0..columns {
                if (row, column) != (box_row, box_column) {
                    builder.thickness = self.thickness(radii[row], radii[row + 1]);
                    frame.fill(&mut builder, row, column);
                }
            }
        }

        builder.thickness = self.thickness(hole.inner, hole.outer);
        // Around the hole: the sides of the box counter-clockwise from the clockwise outer corner.
        let (row, column) = (box_row, box_column);
        let sides = [
            frame.arcs[row + 1][column].clone(),
            backwards(&frame.rays[row][column + 1]),
            backwards(&frame.arcs[row][column]),
            frame.rays[row][column].clone(),
        ];
        let spokes: [Edge; 4] = std::array::from_fn(|i| {
            let from = builder.node(hole.point(hole.splits[i]));
            let fractions = if i < 2 {
                &plan.outer_spoke
            } else {
                &plan.inner_spoke
            };
            builder.straight(from, sides[i][0], fractions)
        });
        let mut hole_nodes = Edge::new();
        for (i, side) in sides.iter().enumerate() {
            let next = (i + 1) % 4;
            let phis = hole.arc(i, side.len());
            let points: Vec<_> = phis.iter().map(|phi| hole.point(*phi)).collect();
            let rim = builder.curve(spokes[i][0], spokes[next][0], &points);
            builder.ruled(&spokes[i], side, &spokes[next], &rim);
            hole_nodes.extend(&rim[..rim.len() - 1]);
        }
        frame.blank(
            builder,
            self.interface_radius,
            holes.count,
            vec![hole_nodes],
        )
    }

    /// The strips between `lines`, from the one nearest to the hole on, with the line that each ends on.
    fn strips(&self, lines: &[f64], inward: bool) -> Vec<(Vec<f64>, f64)> {
        let strip = |pair: &[f64]| {
            let outer_size = if pair[1] == 0.0 {
                FIRST_LAYER * self.arc_size
            } else {
                LARGEST
            };
            let layers = Grading {
                length: pair[1] - pair[0],
                first: outer_size.min(pair[1] - pair[0]),
                last: f64::INFINITY,
                growth: GROWTH,
                largest: LARGEST,
            };
            let fractions = reversed(&layers.divide(layers.count_at(2, self.level)));
            (fractions, if inward { pair[0] } else { pair[1] })
        };
        let mut strips: Vec<_> = lines.windows(2).map(strip).collect();
        if inward {
            strips.reverse();
        }
        strips
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Vector;
    use crate::grid::ring_grid::ELEMENTS_PER_TOOTH;

    const LEVELS: [GridLevel; 3] = [GridLevel::Coarse, GridLevel::Standard, GridLevel::Fine];

    /// Bore, holes (N, R, r), interface radius in millimeters, and teeth.
    type Case = (f64, u32, f64, f64, f64, u32);

    /// The gears of the paper and of the study, then few and many, large and small holes.
    const CASES: [Case; 24] = [
        (16.0, 8, 31.5, 10.0, 45.5, 50),
        (16.0, 10, 34.0, 7.5, 45.5, 50),
        (12.0, 6, 56.0, 17.5, 80.5, 85),
        (15.0, 8, 34.0, 8.385, 45.5, 50),
        (15.0, 6, 30.0, 9.683, 45.5, 50),
        (15.0, 8, 27.0, 8.385, 45.5, 50),
        (15.0, 10, 30.0, 7.5, 45.5, 50),
        (15.0, 10, 34.0, 7.5, 45.5, 50),
        (15.0, 6, 34.0, 9.683, 45.5, 50),
        (10.0, 1, 28.0, 3.0, 45.5, 50),
        (10.0, 1, 28.0, 17.0, 45.5, 50),
        (5.0, 1, 25.0, 19.5, 45.5, 50),
        (10.0, 2, 28.0, 2.0, 45.5, 50),
        (10.0, 2, 28.0, 17.0, 45.5, 50),
        (10.0, 3, 28.0, 1.0, 45.5, 50),
        (10.0, 3, 28.0, 16.5, 45.5, 50),
        (10.0, 12, 36.0, 9.0, 45.5, 50),
        (15.0, 12, 40.0, 2.0, 45.5, 50),
        (15.0, 20, 30.0, 2.0, 45.5, 50),
        (15.0, 60, 40.0, 1.8, 45.5, 50),
        (15.0, 60, 40.0, 0.5, 45.5, 300),
        (5.0, 5, 9.5, 2.5, 13.5, 18),
        (15.0, 4, 20.0, 4.75, 45.5, 50),
        (15.0, 8, 36.0, 9.25, 45.5, 50),
    ];

    fn holed(case: Case, level: GridLevel) -> BlankGrid {
        let (bore, count, circle, radius, interface, teeth) = case;
        let holes = HolePattern {
            count,
            circle_radius: circle * 1e-3,
            radius: radius * 1e-3,
            phase: 0.0,
        };
        BlankGrid::new(
            bore * 1e-3,
            interface * 1e-3,
            Some(&holes),
            teeth,
            ELEMENTS_PER_TOOTH,
            level,
        )
        .unwrap_or_else(|error| panic!("{case:?} at {level:?}: {error}"))
    }

    fn angle(grid: &BlankGrid, node: u32) -> f64 {
        let p = grid.grid.nodes[node as usize];
        p.y.atan2(p.x)
    }

    #[test]
    fn sectors_of_all_hole_patterns_keep_angles_above_twenty_five_degrees() {
        for case in CASES {
            for level in LEVELS {
                let blank = holed(case, level);
                let quality = blank.grid.quality();
                assert!(
                    quality.smallest_angle.to_degrees() > 25.0,
                    "{case:?} {level:?}"
                );
            }
        }
    }

    #[test]
    fn ligaments_down_to_a_fifth_of_a_millimeter_are_divided() {
        for ligament in [0.2, 0.5, 1.0, 3.0] {
            // Thin above, thin below, thin beside, and all at once, by the closed forms of `HolePattern`.
            let beside = 30.0 * (PI / 8.0).sin() - ligament / 2.0;
            let (above, below) = (34.0 + 8.0 + ligament, 34.0 - 8.0 - ligament);
            for case in [
                (15.0, 8, 34.0, 8.0, above, 50),
                (below, 8, 34.0, 8.0, 45.5, 50),
                (10.0, 8, 30.0, beside, 45.5, 50),
                (
                    30.0 - beside - ligament,
                    8,
                    30.0,
                    beside,
                    30.0 + beside + ligament,
                    50,
                ),
                (5.0, 2, 25.0, 20.0 - ligament, 45.5, 50),
                (5.0, 2, 25.0, 20.0 - ligament, 45.0, 50),
            ] {
                let quality = holed(case, GridLevel::Standard).grid.quality();
                assert!(quality.smallest_angle.to_degrees() > 25.0);
            }
        }
    }

    #[test]
    fn elements_beside_a_neck_are_shorter_than_it_bends() {
        // Few elements around a ring whose holes leave necks of 0.75 mm: these bend over some √(r t).
        let (circle, radius) = (24.5e-3, 9e-3);
        let holes = HolePattern {
            count: 8,
            circle_radius: circle,
            radius,
            phase: 0.0,
        };
        let grid = BlankGrid::new(15e-3, 40e-3, Some(&holes), 48, 1.5, GridLevel::Standard);
        let grid = grid.expect("a usable grid");
        let bends = (radius * holes.ligament_between()).sqrt();
        let edge = &grid.hole_edges[0];
        let corners: Vec<_> = edge.iter().step_by(2).collect();
        let point = |i: usize| grid.grid.nodes[*corners[i % corners.len()] as usize];
        let beside = |p: &Vector| p.y.abs() > 0.8 * radius;
        let lengths = (0..corners.len()).map(|i| (point(i), point(i + 1)));
        let mut lengths: Vec<f64> = lengths
            .filter(|(from, to)| beside(from) && beside(to))
            .map(|(from, to)| (to - from).norm())
            .collect();
        lengths.sort_by(f64::total_cmp);
        let longest = lengths.last().expect("elements beside the neck");
        assert!(*longest < 0.35 * bends, "{longest} {bends}");
    }

    #[test]
    fn a_sector_has_the_area_of_its_ring_less_its_hole() {
        for case in CASES {
            let (bore, count, _, radius, interface, _) = case;
            let ring = PI * (interface * interface - bore * bore) * 1e-6 / f64::from(count);
            let area = ring - PI * radius * radius * 1e-6;
            let error = |level| (holed(case, level).grid.area() / area - 1.0).abs();
            // Parabolic sides miss an arc by the fourth power of its angle: 32 around the hole at the standard level, and
            // sixteen times less at the fine one.
            assert!(error(GridLevel::Standard) < 2e-5, "{case:?}");
            assert!(error(GridLevel::Fine) < 2e-6, "{case:?}");
        }
    }

    #[test]
    fn each_level_halves_every_element() {
        for case in CASES {
            let [coarse, standard, fine] =
                LEVELS.map(|level| holed(case, level).grid.elements.len());
            assert_eq!((4 * coarse, 4 * standard), (standard, fine), "{case:?}");
        }
    }

    #[test]
    fn boundary_nodes_lie_on_their_circles_in_order_and_the_sides_are_equal() {
        for case in CASES {
            let (bore, count, circle, radius, interface, teeth) = case;
            let blank = holed(case, GridLevel::Standard);
            let half = PI / f64::from(count);
            let point = |node: &u32| blank.grid.nodes[*node as usize];
            assert_eq!(blank.sector_count, count);
            for (nodes, r) in [(&blank.arc_nodes, interface), (&blank.bore_nodes, bore)] {
                assert!(
                    nodes
                        .iter()
                        .all(|n| (point(n).norm() - r * 1e-3).abs() < 1e-15)
                );
                assert!(nodes.len() % 2 == 1, "corner, midside, ..., corner");
            }
            let angles = &blank.arc_angles;
            assert!(
                (angles[0] + half).abs() < 1e-15 && (angles[angles.len() - 1] - half).abs() < 1e-15
            );
            let largest = angles
                .windows(3)
                .step_by(2)
                .map(|a| a[2] - a[0])
                .fold(0.0, f64::max);
            // Three elements to a pitch, so that two wavelengths have six nodes at the highest order.
            assert!(
                largest < 2.0 * PI / (3.0 * f64::from(teeth)),
                "{case:?}: {largest}"
            );
            for (node, angle_of) in blank.arc_nodes.iter().zip(angles) {
                let turned = angle(&blank, *node) - angle_of;
                assert!(turned.sin().abs() < 1e-14);
            }
            assert!(angles.windows(2).all(|a| a[0] < a[1]));
            let (right, left) = &blank.side_nodes;
            assert_eq!(right.len(), left.len());
            assert!(
                right
                    .iter()
                    .zip(left)
                    .all(|(a, b)| point(a).norm() == point(b).norm() && a != b)
            );
            assert!(
                right
                    .windows(2)
                    .all(|n| point(&n[0]).norm() < point(&n[1]).norm())
            );
            let center = Vector::new(circle * 1e-3, 0.0);
            assert_eq!(blank.hole_edges.len(), 1);
            assert!(blank.hole_edges[0].len() >= 64);
            assert!(
                blank.hole_edges[0]
                    .iter()
                    .all(|n| ((point(n) - center).norm() - radius * 1e-3).abs() < 1e-14)
            );
        }
    }

    #[test]
    fn a_solid_blank_repeats_with_its_teeth() {
        for (bore, interface, teeth) in [
            (15e-3, 45.5e-3, 50),
            (1e-3, 45.5e-3, 50),
            (3e-3, 13.5e-3, 18),
            (43e-3, 45.5e-3, 50),
        ] {
            let blank = BlankGrid::new(
                bore,
                interface,
                None,
                teeth,
                ELEMENTS_PER_TOOTH,
                GridLevel::Standard,
            )
            .expect("a ring");
            let area = PI * (interface * interface - bore * bore) / f64::from(teeth);
            assert_eq!((blank.sector_count, blank.arc_nodes.len()), (teeth, 9));
            // Four parabolas a pitch.
            assert!((blank.grid.area() / area - 1.0).abs() < 1e-6);
            assert!(blank.hole_edges.is_empty());
        }
    }

    #[test]
    fn rings_and_ligaments_without_width_are_refused() {
        let standard = |bore, interface, holes| {
            BlankGrid::new(
                bore,
                interface,
                holes,
                50,
                ELEMENTS_PER_TOOTH,
                GridLevel::Standard,
            )
        };
        assert!(matches!(
            standard(15e-3, 15e-3, None),
            Err(GridError::InterfaceInsideBore { .. })
        ));
        assert!(matches!(
            standard(f64::NAN, 15e-3, None),
            Err(GridError::InterfaceInsideBore { .. })
        ));
        let holes = HolePattern {
            count: 8,
            circle_radius: 34e-3,
            radius: 11.6e-3,
            phase: 0.0,
        };
        let Err(GridError::NoLigament { above, .. }) = standard(15e-3, 45.5e-3, Some(&holes))
        else {
            panic!("the hole reaches 45.6 mm")
        };
        assert!((above + 0.1e-3).abs() < 1e-15);
    }
}
