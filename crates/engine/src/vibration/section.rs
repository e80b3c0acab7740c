//! The section of a blank, or of one of the equal sectors that make it up: rings between circles whose nodes stand on common rays, and a
//! ring with holes where there are some.

use std::f64::consts::PI;

use crate::gear::{BlankRegion, Core, Hole, Layer, SolidGear, Vector, radial};
use crate::grid::{BlankGrid, Element, Grid, GridError, GridLevel};

/// Elements around a holed ring, at least, and for each of the holes of a pattern.
const AROUND: f64 = 48.0;
const AROUND_HOLE: f64 = 5.0;
/// The largest depth of an element along the radius, as a part of its outer radius.
const DEEPEST: f64 = 0.1;
/// The least number of elements along the radius of a part which is thinner than those beside it.
const ACROSS_WEB: usize = 5;
/// The depth of its elements in its thicknesses, and the number of them that is enough for any web.
const IN_THICKNESSES: f64 = 4.0;
const ENOUGH: usize = 10;
/// The least number of elements around a ring without holes.
const LEAST_AROUND: usize = 36;
/// How much of the way from holes in the rim itself to the interface circle belongs to the holed part.
const HOLED_PART: f64 = 0.75;

/// The hole that is left in the middle of a solid shaft, as a part of its radius: it moves the outside by three times its square.
const CENTER: f64 = 4e-3;

/// A section in a frame whose x axis runs through the middle of the sector.
#[derive(Debug, Clone)]
pub(super) struct Section {
    /// The elements.
    pub(super) grid: Grid,
    /// The part that each element belongs to, by its place among the parts.
    pub(super) part_of: Vec<usize>,
    /// The number of equal sectors that make up the section.
    pub(super) sectors: usize,
    /// The nodes on the sides at −π/n and at π/n, those on the bore and on the outer circle among them; equal radii on both sides. Empty where
    /// the section is whole.
    pub(super) sides: (Vec<u32>, Vec<u32>),
    /// The nodes on the bore.
    pub(super) bore: Vec<u32>,
    /// The nodes on the outer circle.
    pub(super) arc: Vec<u32>,
    /// Elements along the outer circle, of all sectors.
    pub(super) around: usize,
    /// The nodes around each hole, counter-clockwise, each once.
    pub(super) hole_edges: Vec<Vec<u32>>,
}

/// Elements around a ring with a pattern of `count` holes, about.
pub(super) fn around_holes(count: f64) -> f64 {
    AROUND.max(AROUND_HOLE * count)
}

/// The blank of a gear inside the circle on which its teeth are joined to it.
#[derive(Debug, Clone)]
pub(super) struct Blank {
    /// The parts from outside to the bore.
    pub(super) parts: Vec<Layer>,
    /// The section, or a sector of it.
    pub(super) section: Section,
    /// By how much its frame is turned from that of the gear.
    pub(super) phase: f64,
}

impl Blank {
    /// The blank of `gear`.
    ///
    /// # Errors
    ///
    /// [`GridError`] if the holes leave no room for elements.
    pub(super) fn new(gear: &SolidGear) -> Result<Self, GridError> {
        Self::of_gear(gear, false)
    }

    /// The blank of `gear` with a solid shaft in its bore, of the width of the part around it.
    ///
    /// # Errors
    ///
    /// As [`Blank::new`].
    pub(super) fn on_shaft(gear: &SolidGear) -> Result<Self, GridError> {
        Self::of_gear(gear, true)
    }

    fn of_gear(gear: &SolidGear, is_on_shaft: bool) -> Result<Self, GridError> {
        let section = gear.section();
        let (root, module) = (section.root_radius(), gear.normal_rack().module);
        let mut parts = gear.layers();
        let holes = section.holes();
        let reach = holes.iter().map(Hole::outer_reach).reduce(f64::max);
        let below = parts[0].inner_radius.max(reach.unwrap_or(0.0));
        parts[0].outer_radius = (root - module).max(f64::midpoint(root, below));
        if is_on_shaft && let Some(innermost) = parts.last().copied() {
            parts.push(Layer {
                inner_radius: CENTER * innermost.inner_radius,
                outer_radius: innermost.inner_radius,
                ..innermost
            });
        }
        let region = &section.data().blank;
        Self::of_region(parts, region, gear.face_width(), section.tooth_count())
    }

    /// The blank of these parts, from outside to the bore, with the holes of `region`, under the given number of teeth.
    pub(super) fn of_region(
        parts: Vec<Layer>,
        region: &BlankRegion,
        face_width: f64,
        tooth_count: u32,
    ) -> Result<Self, GridError> {
        let (outer, z) = (parts[0].outer_radius, tooth_count as usize);
        let reach = region.holes.iter().map(Hole::outer_reach);
        let Some(reach) = reach.reduce(f64::max) else {
            return Ok(Self {
                section: Section::plain(&parts, z),
                parts,
                phase: 0.0,
            });
        };
        // Holes in the rim itself: its inner part is the holed one.
        let holed = usize::from(reach <= parts[0].inner_radius && parts.len() > 1);
        let mut circles = [parts[holed].inner_radius, parts[holed].outer_radius];
        if holed == 0 {
            circles[1] = reach + HOLED_PART * (outer - reach);
        }
        let region = BlankRegion {
            bore_radius: circles[0],
            core: Core::Bore,
            web: None,
            ..region.clone()
        };
        let count = region
            .pattern()
            .map_or(1.0, |pattern| f64::from(pattern.count));
        // The coarse level halves.
        let per_tooth = 2.0 * around_holes(count) / z as f64;
        let grid = BlankGrid::of_region(
            &region,
            face_width,
            circles[1],
            tooth_count,
            per_tooth,
            GridLevel::Coarse,
        )?;
        Ok(Self {
            section: Section::holed(&parts, (holed, circles), &grid),
            parts,
            phase: region.phase(),
        })
    }

    #[cfg(test)]
    /// A blank of these parts, from outside to the bore, made up of the given number of equal sectors.
    pub(super) fn of_parts(parts: Vec<Layer>, sectors: usize) -> Self {
        Self {
            section: Section::plain(&parts, sectors),
            parts,
            phase: 0.0,
        }
    }
}

impl Section {
    /// One of `sectors` of rings without holes.
    fn plain(parts: &[Layer], sectors: usize) -> Self {
        let elements = least_around(sectors) / sectors;
        let half = PI / sectors as f64;
        let steps = 2 * elements;
        let angles: Vec<f64> = (0..=steps)
            .map(|i| half * (2.0 * i as f64 / steps as f64 - 1.0))
            .collect();
        let mut rings = Rings::new(angles, true);
        let innermost = parts[parts.len() - 1].inner_radius;
        let mut circle = rings.first_circle(innermost);
        let (bore, mut sides) = (circle.clone(), vec![[circle[0], circle[steps]]]);
        for (index, part) in parts.iter().enumerate().rev() {
            circle = rings.grow(&circle, &radii(part, (index, parts)), index, &mut sides);
        }
        Self {
            grid: rings.grid,
            part_of: rings.part_of,
            sectors,
            sides: sides.into_iter().map(|[right, left]| (right, left)).unzip(),
            bore,
            arc: circle,
            around: elements * sectors,
            hole_edges: Vec::new(),
        }
    }

    /// Rings above and below the holed one, `grid`, which is between `circles` in the part `holed`.
    fn holed(parts: &[Layer], (holed, circles): (usize, [f64; 2]), grid: &BlankGrid) -> Self {
        let is_open = !grid.side_nodes.0.is_empty();
        let ends = |nodes: &[u32]| [nodes[0], nodes[nodes.len() - 1]];
        let mut sides: Vec<[u32; 2]> = Vec::new();
        if is_open {
            let pairs = grid.side_nodes.0.iter().zip(&grid.side_nodes.1);
            sides.extend(pairs.map(|(right, left)| [*right, *left]));
            sides.push(ends(&grid.bore_nodes));
            sides.push(ends(&grid.arc_nodes));
        }
        let angle = |node: &u32| {
            let place = grid.grid.nodes[*node as usize];
            place.y.atan2(place.x)
        };
        let mut rings = Rings {
            part_of: vec![holed; grid.grid.elements.len()],
            grid: grid.grid.clone(),
            angles: grid.arc_angles.clone(),
            is_open,
        };
        // Outward.
        let mut circle = grid.arc_nodes.clone();
        for index in (0..=holed).rev() {
            let part = Layer {
                inner_radius: if index == holed {
                    circles[1]
                } else {
                    parts[index].inner_radius
                },
                ..parts[index]
            };
            if part.outer_radius > part.inner_radius {
                circle = rings.grow(&circle, &radii(&part, (index, parts)), index, &mut sides);
            }
        }
        let arc = circle;
        // Inward.
        rings.angles = grid.bore_nodes.iter().map(angle).collect();
        let mut circle = grid.bore_nodes.clone();
        for (index, part) in parts.iter().enumerate().skip(holed + 1) {
            let mut radii = radii(part, (index, parts));
            radii.reverse();
            circle = rings.grow(&circle, &radii, index, &mut sides);
        }
        let around = (arc.len() / 2) * grid.sector_count as usize;
        Self {
            grid: rings.grid,
            part_of: rings.part_of,
            sectors: grid.sector_count as usize,
            sides: sides.into_iter().map(|[right, left]| (right, left)).unzip(),
            bore: circle,
            arc,
            around,
            hole_edges: grid.hole_edges.clone(),
        }
    }
}

/// Elements around a ring without holes that has the given number of sectors.
pub(super) fn least_around(sectors: usize) -> usize {
    sectors * LEAST_AROUND.div_ceil(sectors)
}

/// Rings in the making, with nodes at `angles`, corners and middles in turn.
struct Rings {
    grid: Grid,
    part_of: Vec<usize>,
    angles: Vec<f64>,
    is_open: bool,
}

impl Rings {
    fn new(angles: Vec<f64>, is_open: bool) -> Self {
        Self {
            grid: Grid {
                nodes: Vec::new(),
                elements: Vec::new(),
            },
            part_of: Vec::new(),
            angles,
            is_open,
        }
    }

    /// Nodes at every angle of a circle.
    fn first_circle(&mut self, radius: f64) -> Vec<u32> {
        (0..self.angles.len())
            .map(|i| self.node(radius, i))
            .collect()
    }

    fn node(&mut self, radius: f64, index: usize) -> u32 {
        let place: Vector = radius * radial(self.angles[index]);
        self.grid.nodes.push(place);
        self.grid.nodes.len() as u32 - 1
    }

    /// The rings of the part of this index from `circle`, which is that of the first of `radii`, to the last of them; the last circle.
    fn grow(
        &mut self,
        circle: &[u32],
        radii: &[f64],
        part: usize,
        sides: &mut Vec<[u32; 2]>,
    ) -> Vec<u32> {
        let count = self.angles.len();
        let (mut from, is_outward) = (circle.to_vec(), radii[radii.len() - 1] > radii[0]);
        for ends in radii.windows(2) {
            let (middle, end) = (f64::midpoint(ends[0], ends[1]), ends[1]);
            let middles: Vec<u32> = (0..count)
                .step_by(2)
                .map(|i| self.node(middle, i))
                .collect();
            let to: Vec<u32> = (0..count).map(|i| self.node(end, i)).collect();
            if self.is_open {
                sides.push([middles[0], middles[middles.len() - 1]]);
                sides.push([to[0], to[count - 1]]);
            }
            let (inner, outer) = if is_outward {
                (&from, &to)
            } else {
                (&to, &from)
            };
            for j in (0..count - usize::from(self.is_open)).step_by(2) {
                let at = |circle: &[u32], j: usize| circle[j % count];
                let next = middles[(j / 2 + 1) % middles.len()];
                self.grid.elements.push(Element::quadrilateral([
                    at(inner, j),
                    at(outer, j),
                    at(outer, j + 2),
                    at(inner, j + 2),
                    middles[j / 2],
                    at(outer, j + 1),
                    next,
                    at(inner, j + 1),
                ]));
                self.part_of.push(part);
            }
            from = to;
        }
        from
    }
}

/// The circles, rising, on which the elements of a part end.
fn radii(part: &Layer, (index, parts): (usize, &[Layer])) -> Vec<f64> {
    let width = |part: &Layer| part.heights[1] - part.heights[0];
    let beside = index.checked_sub(1).into_iter().chain([index + 1]);
    let mut beside = beside.filter_map(|index| parts.get(index)).peekable();
    let is_web = parts.len() == 1
        || beside.peek().is_some() && beside.all(|other| width(other) > width(part));
    let depth = part.outer_radius - part.inner_radius;
    let by_width = (depth / (IN_THICKNESSES * width(part))).ceil() as usize;
    let least = if is_web {
        by_width.clamp(ACROSS_WEB, ENOUGH)
    } else {
        1
    };
    let count = (depth / (DEEPEST * part.outer_radius) - 1e-9).ceil() as usize;
    let count = count.max(least);
    (0..=count)
        .map(|i| part.inner_radius + depth * i as f64 / count as f64)
        .collect()
}
