//! The grid of one sector of a blank, from the bore to the interface circle.
//!
//! The sector is laid out in the chart (ln(r/R_w), θ), in which it is a rectangle and a round hole is nearly round. The
//! chart keeps angles, so that a grid with good angles there has them in the plane.

use std::f64::consts::PI;

use super::block::{Edge, GridBuilder, backwards};
use super::division::{Grading, reversed, uniform};
use super::{Grid, GridError, GridLevel, checked};
use crate::gear::{HolePattern, Vector, radial};
use crate::root_finding::bisect;

/// The least number of elements on the interface circle per tooth at the standard level.
pub const ELEMENTS_PER_TOOTH: f64 = 4.0;
/// The depth of the first layer under the interface circle, in element lengths along it.
const FIRST_LAYER: f64 = 0.5;
/// The size along a spoke at the hole, in half widths of the hole.
const SIZE_AT_HOLE: f64 = 0.25;
/// The growth of sizes away from the interface circle and away from a hole.
const GROWTH: f64 = 0.35;
/// The largest size along the radius, as a part of the radius.
const LARGEST: f64 = 0.12;
/// The least number of layers between a hole and what is next to it, at the standard level.
const LAYERS: usize = 6;
/// The least number of elements along each of the four arcs of a hole, at the standard level.
const ELEMENTS_PER_ARC: f64 = 8.0;
/// Where a hole's surroundings are narrower than this, in half widths of the hole, its box takes them in.
const NARROW: f64 = 0.7;

/// The grid of one sector of a blank, in a frame whose x axis runs through the middle of the sector: through the center
/// of the hole, if there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct BlankGrid {
    /// The elements.
    pub grid: Grid,
    /// The number n of sectors that make up the blank: one for each hole, or one for each tooth of a solid blank.
    pub sector_count: u32,
    /// The nodes on the interface circle, corners and midsides, from −π/n to π/n.
    pub arc_nodes: Vec<u32>,
    /// The polar angle of each of these.
    pub arc_angles: Vec<f64>,
    /// The nodes on the bore, corners and midsides, from −π/n to π/n.
    pub bore_nodes: Vec<u32>,
    /// The nodes on the sides at −π/n and at π/n, outward, without those on the bore and on the interface circle; equal
    /// radii on both sides. Where n = 1 the two sides are the lips of one cut.
    pub side_nodes: (Vec<u32>, Vec<u32>),
    /// The nodes around each hole, counter-clockwise, each once.
    pub hole_edges: Vec<Vec<u32>>,
}

impl BlankGrid {
    /// Divides one sector of the ring between `bore_radius` and `interface_radius`, on which `tooth_count` teeth stand,
    /// with `elements_per_tooth` elements on the interface circle for each at the standard level.
    ///
    /// The phase of the holes is left to the caller.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the ring has no width, if the holes leave no material around them, or if an element is
    /// distorted.
    pub fn new(
        bore_radius: f64,
        interface_radius: f64,
        holes: Option<&HolePattern>,
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
        let ring = Ring {
            interface_radius,
            bore: (bore_radius / interface_radius).ln(),
            arc_size: 2.0 * PI / (elements_per_tooth * f64::from(tooth_count)),
            elements_per_tooth,
            level,
        };
        let blank = match holes.filter(|holes| holes.count > 0) {
            None => ring.solid(tooth_count),
            Some(holes) => {
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
                ring.holed(holes)
            }
        };
        Ok(Self {
            grid: checked(blank.grid)?,
            ..blank
        })
    }
}

/// The ring in its chart: from `bore` < 0 to 0 at the interface circle.
struct Ring {
    interface_radius: f64,
    bore: f64,
    /// The element size on the interface circle.
    arc_size: f64,
    /// As many of them stand under a tooth.
    elements_per_tooth: f64,
    level: GridLevel,
}

/// The rectangles into which lines of equal radius and lines of equal angle cut the sector.
struct Frame {
    /// The edges along the radius: by interval of the radius, then by line of equal angle.
    rays: Vec<Vec<Edge>>,
    /// The edges along the angle: by line of equal radius, then by interval of the angle.
    arcs: Vec<Vec<Edge>>,
}

impl Frame {
    /// Fills one of the rectangles.
    fn fill(&self, builder: &mut GridBuilder, row: usize, column: usize) {
        builder.block(
            &self.rays[row][column],
            &self.arcs[row + 1][column],
            &self.rays[row][column + 1],
            &self.arcs[row][column],
        );
    }

    /// All nodes along one line of equal angle.
    fn ray(&self, column: usize) -> Edge {
        chain(self.rays.iter().map(|row| &row[column]))
    }

    /// All nodes along one line of equal radius.
    fn arc(&self, row: usize) -> Edge {
        chain(self.arcs[row].iter())
    }

    fn blank(
        &self,
        builder: GridBuilder,
        interface_radius: f64,
        sector_count: u32,
        hole_edges: Vec<Edge>,
    ) -> BlankGrid {
        let inner = |edge: Edge| edge[1..edge.len() - 1].to_vec();
        let arc_nodes = self.arc(self.arcs.len() - 1);
        BlankGrid {
            sector_count,
            arc_angles: arc_nodes.iter().map(|n| builder.point(*n).y).collect(),
            arc_nodes,
            bore_nodes: self.arc(0),
            side_nodes: (inner(self.ray(0)), inner(self.ray(self.arcs[0].len()))),
            hole_edges,
            grid: builder.finish(|p| interface_radius * p.x.exp() * radial(p.y)),
        }
    }
}

/// Edges that follow one another, as one.
fn chain<'a>(edges: impl Iterator<Item = &'a Edge>) -> Edge {
    let mut whole = Edge::new();
    for edge in edges {
        let repeated = usize::from(!whole.is_empty());
        whole.extend(&edge[repeated..]);
    }
    whole
}

impl Ring {
    fn frame(
        &self,
        builder: &mut GridBuilder,
        lines: (&[f64], &[f64]),
        ray_fractions: &[Vec<f64>],
        arc_fractions: &[Vec<Vec<f64>>],
    ) -> Frame {
        let (radii, angles) = lines;
        let vertices: Vec<Vec<u32>> = radii
            .iter()
            .map(|x| {
                angles
                    .iter()
                    .map(|t| builder.node(Vector::new(*x, *t)))
                    .collect()
            })
            .collect();
        let rays = (0..radii.len() - 1)
            .map(|row| {
                (0..angles.len())
                    .map(|c| {
                        builder.straight(
                            vertices[row][c],
                            vertices[row + 1][c],
                            &ray_fractions[row],
                        )
                    })
                    .collect()
            })
            .collect();
        let arcs = (0..radii.len())
            .map(|row| {
                (0..angles.len() - 1)
                    .map(|c| {
                        builder.straight(
                            vertices[row][c],
                            vertices[row][c + 1],
                            &arc_fractions[row][c],
                        )
                    })
                    .collect()
            })
            .collect();
        Frame { rays, arcs }
    }

    /// One pitch of a blank without holes.
    fn solid(&self, tooth_count: u32) -> BlankGrid {
        let half = PI / f64::from(tooth_count);
        let layers = Grading {
            length: -self.bore,
            first: FIRST_LAYER * self.arc_size,
            last: f64::INFINITY,
            growth: GROWTH,
            largest: LARGEST,
        };
        let rays = reversed(&layers.divide(layers.count_at(LAYERS, self.level)));
        let arcs = uniform(self.level.count(self.elements_per_tooth));
        let mut builder = GridBuilder::default();
        let frame = self.frame(
            &mut builder,
            (&[self.bore, 0.0], &[-half, half]),
            &[rays],
            &[vec![arcs.clone()], vec![arcs]],
        );
        frame.fill(&mut builder, 0, 0);
        frame.blank(builder, self.interface_radius, tooth_count, Vec::new())
    }

    /// The sector of one hole.
    fn holed(&self, holes: &HolePattern) -> BlankGrid {
        let hole = Hole::new(self, holes);
        let plan = hole.plan(self);
        let mut builder = GridBuilder::default();

        // Lines of equal radius and of equal angle, outward and counter-clockwise; the box stands between two of each.
        let (mut radii, mut rays) = (vec![hole.inner, hole.outer], vec![plan.side.clone()]);
        let (mut angles, mut columns) = (vec![-hole.beta, hole.beta], 1);
        let (mut inner_arcs, mut outer_arcs) = (vec![plan.inner.clone()], vec![plan.outer.clone()]);
        let (mut box_row, mut box_column) = (0, 0);
        if let Some(fractions) = plan.below {
            radii.insert(0, self.bore);
            rays.insert(0, fractions);
            box_row = 1;
        }
        if let Some(fractions) = plan.above {
            radii.push(0.0);
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
        let frame = self.frame(&mut builder, (&radii, &angles), &rays, &arcs);
        for row in 0..rays.len() {
            for column in 0..columns {
                if (row, column) != (box_row, box_column) {
                    frame.fill(&mut builder, row, column);
                }
            }
        }

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
}

/// The hole of a sector and its box, in the chart.
struct Hole {
    interface_radius: f64,
    circle_radius: f64,
    radius: f64,
    half_pitch: f64,
    /// The coordinate of the middle of the hole.
    middle: f64,
    /// The half widths of the hole along the radius and along the angle.
    half: (f64, f64),
    /// The box: from `inner` to `outer`, and `beta` to either side.
    inner: f64,
    outer: f64,
    beta: f64,
    /// The angles φ around the hole of the spokes to the corners, counter-clockwise from the clockwise outer corner.
    splits: [f64; 4],
}

/// The divisions of a holed sector.
struct HolePlan {
    /// The sides of the box along the angle at its outer and inner radius, and along the radius.
    outer: Vec<f64>,
    inner: Vec<f64>,
    side: Vec<f64>,
    outer_spoke: Vec<f64>,
    inner_spoke: Vec<f64>,
    /// What the box leaves: to the bore, to the interface circle, and to the side of the sector at π/N.
    below: Option<Vec<f64>>,
    above: Option<Vec<f64>>,
    beside: Option<Vec<f64>>,
}

impl Hole {
    fn new(ring: &Ring, holes: &HolePattern) -> Self {
        let (r, r_h) = (holes.circle_radius, holes.radius);
        let half_pitch = PI / f64::from(holes.count);
        // In the chart the hole reaches from ln(R − r) to ln(R + r), and asin(r/R) to either side.
        let (low, high) = (
            (holes.inner_reach() / ring.interface_radius).ln(),
            (holes.outer_reach() / ring.interface_radius).ln(),
        );
        let half = ((high - low) / 2.0, (r_h / r).asin());
        // Each gap with the half width of the hole beside it: to the bore, to the interface circle, to the side.
        let gaps = [
            (low - ring.bore, half.0),
            (-high, half.0),
            (half_pitch - half.1, half.1),
        ];
        let [to_bore, to_interface, to_side] = gaps.map(|(gap, half)| gap <= NARROW * half);
        // Next to a narrow gap the box stays close around the hole, so that its corners are not far out of square. A hole
        // that is small among the elements around it has a box of some of them.
        let close = 0.4 * half.1;
        let free = gaps
            .iter()
            .fold(f64::INFINITY, |least, (gap, _)| least.min(*gap));
        let wide = if to_bore || to_interface || to_side {
            close
        } else {
            close.max(0.5 * ELEMENTS_PER_ARC * 1.2 * ring.arc_size - half.1)
        };
        let margin = |gap: f64| wide.min(0.5 * gap).min(0.5 * free.max(2.0 * close));
        let [below, above, beside] = gaps.map(|(gap, _)| margin(gap));
        let mut hole = Self {
            interface_radius: ring.interface_radius,
            circle_radius: r,
            radius: r_h,
            half_pitch,
            middle: f64::midpoint(low, high),
            half,
            // Exactly the boundary where the box reaches it.
            inner: if to_bore { ring.bore } else { low - below },
            outer: if to_interface { 0.0 } else { high + above },
            beta: if to_side { half_pitch } else { half.1 + beside },
            splits: [0.0; 4],
        };
        let (outer, inner) = (hole.towards(hole.outer), hole.towards(hole.inner));
        hole.splits = [-outer, outer, inner, 2.0 * PI - inner];
        hole
    }

    /// The point of the hole at the angle `phi` around its center.
    fn point(&self, phi: f64) -> Vector {
        let Self {
            circle_radius: r,
            radius: r_h,
            ..
        } = *self;
        let (x, y) = (r + r_h * phi.cos(), r_h * phi.sin());
        Vector::new((x.hypot(y) / self.interface_radius).ln(), y.atan2(x))
    }

    /// The angle φ in (0, π) whose point is seen from the middle in the direction of the box's corner at `x` and +β.
    fn towards(&self, x: f64) -> f64 {
        let target = self.beta.atan2(x - self.middle);
        bisect(0.0, PI, |phi| {
            let p = self.point(phi);
            p.y.atan2(p.x - self.middle) < target
        })
    }

    /// The angles φ of the lattice points between spoke `i` and the next.
    fn arc(&self, i: usize, points: usize) -> Vec<f64> {
        let from = self.splits[i];
        let to = if i == 3 {
            self.splits[0] + 2.0 * PI
        } else {
            self.splits[i + 1]
        };
        let last = (points - 1) as f64;
        (0..points)
            .map(|k| from + (to - from) * k as f64 / last)
            .collect()
    }

    /// The division of side `i` of the box, from `from` to `to` along it, into `count` elements.
    ///
    /// Where the hole comes close the nodes stand opposite to those of the hole, so that thin elements stay upright;
    /// otherwise they are evenly spread.
    fn opposite(&self, i: usize, count: usize, gap: f64) -> Vec<f64> {
        let phis = self.arc(i, 2 * count + 1);
        // Along the angle at the outer and inner sides, along the radius at the others.
        let along_angle = i.is_multiple_of(2);
        let along = |p: Vector| if along_angle { p.y } else { p.x };
        let (nearest, half) = if along_angle {
            (0.0, self.half.0)
        } else {
            (self.middle, self.half.1)
        };
        let (from, to) = match i {
            0 => (-self.beta, self.beta),
            1 => (self.outer, self.inner),
            2 => (self.beta, -self.beta),
            _ => (self.inner, self.outer),
        };
        let positions: Vec<f64> = phis
            .iter()
            .map(|phi| along(self.point(*phi)) - nearest)
            .collect();
        let share = 1.0 / (1.0 + gap / (0.15 * half));
        let last = 2 * count;
        (0..=last)
            .map(|k| {
                let even = k as f64 / last as f64;
                let d = positions[k];
                let (end, target) = if (d < 0.0) == (from < to) {
                    (positions[0], from - nearest)
                } else {
                    (positions[last], to - nearest)
                };
                let stretched = d * (1.0 + (target / end - 1.0) * (d / end).powi(2));
                let close = (stretched + nearest - from) / (to - from);
                share * close + (1.0 - share) * even
            })
            .collect()
    }

    fn plan(&self, ring: &Ring) -> HolePlan {
        let Self {
            inner, outer, beta, ..
        } = *self;
        let size = ring.arc_size;
        let (low, high) = (self.middle - self.half.0, self.middle + self.half.0);
        let (below, above, beside) = (low - inner, outer - high, beta - self.half.1);

        // Where the division of the outer side is uneven, its largest element decides.
        let even = (2.0 * beta / size).max(ELEMENTS_PER_ARC);
        let largest = self
            .opposite(0, even.ceil() as usize, above)
            .windows(3)
            .step_by(2)
            .map(|f| 2.0 * beta * (f[2] - f[0]))
            .fold(0.0, f64::max);
        let outer_standard = even * (largest / (1.2 * size)).max(1.0);
        let outer_count = ring.level.count(outer_standard);
        let inner_count = ring
            .level
            .count((outer_standard / 3.0).max(ELEMENTS_PER_ARC));
        let side_count = ring
            .level
            .count(((outer - inner) / (2.0 * size)).max(ELEMENTS_PER_ARC));

        // Spokes: finer towards the interface circle where the box reaches it.
        let to_interface = outer == 0.0;
        let spoke = |length: f64| Grading {
            length,
            first: if to_interface {
                (FIRST_LAYER * size).min(length)
            } else {
                length
            },
            last: (SIZE_AT_HOLE * self.half.1).min(length),
            growth: GROWTH,
            largest: length,
        };
        let away = |length: f64| Grading {
            first: length,
            ..spoke(length)
        };
        let thick = away(below).count().max(away(beside).count());
        let standard_layers = spoke(above).count().max(thick).max(LAYERS as f64);
        let layers = ring.level.count(standard_layers);
        let corner = Vector::new(outer, beta);
        let outer_length = (corner - self.point(self.splits[1])).norm();
        let inner_length = (Vector::new(inner, beta) - self.point(self.splits[2])).norm();
        // The size of the layer next to the side of the box, at the standard level.
        let layer = |margin: f64| away(margin).size(0.0) * away(margin).count() / standard_layers;

        let strip = |length: f64, first: f64, last: f64, largest: f64| {
            let sizes = Grading {
                length,
                first,
                last,
                growth: GROWTH,
                largest,
            };
            sizes.divide(sizes.count_at(2, ring.level))
        };
        HolePlan {
            outer: self.opposite(0, outer_count, above),
            inner: self.opposite(2, inner_count, below),
            side: reversed(&self.opposite(1, side_count, beside)),
            outer_spoke: reversed(&spoke(outer_length).divide(layers)),
            inner_spoke: reversed(&away(inner_length).divide(layers)),
            below: (inner > ring.bore).then(|| {
                reversed(&strip(
                    inner - ring.bore,
                    layer(below),
                    f64::INFINITY,
                    LARGEST,
                ))
            }),
            above: (outer < 0.0)
                .then(|| reversed(&strip(-outer, FIRST_LAYER * size, layer(above), LARGEST))),
            beside: (beta < self.half_pitch)
                .then(|| strip(self.half_pitch - beta, layer(beside), f64::INFINITY, size)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn boundary_nodes_lie_on_their_circles_in_order_and_the_sides_are_alike() {
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
            // The brief of the coupling: at most a third of a pitch.
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
