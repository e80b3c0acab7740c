//! Triangles between closed curves: Delaunay refinement to a field of sizes, smoothing, and the way to 6-node elements.

use std::collections::{HashMap, HashSet};

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::outline::Outline;
use super::sizes::Sizes;
use super::{Element, Grid};
use crate::gear::{Vector, radial};

// Measured over the regions of the tests of `whole` at the coarse level, whose sharpest corners are 33 degrees in the mean.

/// A triangle is divided when its circumscribed circle is larger than this, in sizes: that of an equilateral triangle is
/// 0.58, and a new point then stands no nearer to any other than this. With 0.86 there are a quarter fewer triangles, but some do
/// not recover: corners fall to 16 degrees.
const LARGEST_CIRCLE: f64 = 0.75;
/// How near to the boundary a new point may stand, in sizes: an equilateral triangle is 0.87 high. From 0.2 to 0.6 it hardly
/// matters.
const NEAREST_TO_BOUNDARY: f64 = 0.4;
/// Rounds of dividing all triangles that are too large, at most: nine were needed.
const MOST_PASSES: usize = 40;
/// Smoothing steps after dividing: they even out the bulk. More of them sharpen the sharpest corners.
const SMOOTHINGS: usize = 4;
/// Rounds of moving single points out of sharp corners, each followed by a new triangulation. Without any the corners have 25
/// degrees in the mean, and grids must be made finer for some regions; with one 30, with four hardly more.
const REPAIRS: usize = 2;
/// Corners sharper than this, in radians, are worth moving a point: 38 degrees. With 25 degrees the corners lose four.
const SHARP: f64 = 0.66;
/// The steps that a point may move by, in sizes.
const STEPS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];

/// Points along a curve in their order.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// The curve.
    pub(super) outline: Outline,
    /// The points' numbers.
    pub(super) nodes: Vec<u32>,
    /// Where each stands on the curve.
    pub(super) lengths: Vec<f64>,
    /// True if the last is joined to the first.
    pub(super) closed: bool,
    /// True if the curve bounds the material; one within it only divides it.
    pub(super) bounds: bool,
}

/// A net of triangles whose sides along some curves will follow them.
#[derive(Debug)]
pub(super) struct TriangleNet {
    points: Vec<Vector>,
    /// The size asked for at each point.
    sizes: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    chains: Vec<Chain>,
}

impl Chain {
    /// Neighbors along the chain, and where the middle between them stands on the curve.
    fn links(&self) -> impl Iterator<Item = (u32, u32, f64)> {
        let count = self.nodes.len();
        let links = if self.closed { count } else { count - 1 };
        (0..links).map(move |i| {
            let next = (i + 1) % count;
            let to = if next == 0 {
                self.outline.length() + self.lengths[0]
            } else {
                self.lengths[next]
            };
            let middle = f64::midpoint(self.lengths[i], to);
            (self.nodes[i], self.nodes[next], middle)
        })
    }
}

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// A triangle whose circle is too large for its place.
struct TooLarge {
    triangle: [u32; 3],
    /// The radius of its circle, in sizes.
    radius: f64,
    center: Vector,
    /// The size at the center.
    size: f64,
}

impl TriangleNet {
    /// Fills the material between `chains`, which stand on `points`. The first chain is the outermost. `None` where chains
    /// cross.
    ///
    /// The net depends on nothing but the numbers given.
    pub(super) fn new(points: Vec<Vector>, chains: Vec<Chain>, sizes: &Sizes) -> Option<Self> {
        let fixed = points.len();
        let mut net = Self {
            sizes: points.iter().map(|point| sizes.at(*point)).collect(),
            points,
            triangles: Vec::new(),
            chains,
        };
        net.divide(sizes)?;
        for _ in 0..SMOOTHINGS {
            net.smooth(fixed);
            net.connect()?;
        }
        for _ in 0..REPAIRS {
            net.repair(fixed);
            net.connect()?;
        }
        net.compact();
        Some(net)
    }

    /// Leaves out points of no triangle, which smoothing may have moved into an opening.
    fn compact(&mut self) {
        let mut used = vec![false; self.points.len()];
        for corner in self.triangles.iter().flatten() {
            used[*corner as usize] = true;
        }
        for node in self.chains.iter().flat_map(|chain| &chain.nodes) {
            used[*node as usize] = true;
        }
        let mut numbers = vec![0; used.len()];
        let mut next = 0;
        for (number, used) in numbers.iter_mut().zip(&used) {
            *number = next;
            next += u32::from(*used);
        }
        let mut keep = used.iter();
        self.points
            .retain(|_| keep.next().is_some_and(|used| *used));
        // Nodes on chains come first and keep their numbers.
        for corner in self.triangles.iter_mut().flatten() {
            *corner = numbers[*corner as usize];
        }
    }

    fn delaunay(&self) -> Option<Delaunay> {
        let points = self.points.iter().map(|p| Point2::new(p.x, p.y)).collect();
        let links = self.chains.iter().flat_map(Chain::links);
        let links: Vec<[usize; 2]> = links.map(|(a, b, _)| [a as usize, b as usize]).collect();
        let mut crossed = false;
        let delaunay = Delaunay::try_bulk_load_cdt(points, links, |_| crossed = true).ok()?;
        (!crossed && delaunay.num_vertices() == self.points.len()).then_some(delaunay)
    }

    /// The triangles of the material in `delaunay`: those that are reached from the outermost chain without crossing a
    /// boundary.
    fn material(&self, delaunay: &Delaunay) -> Vec<[u32; 3]> {
        let mut boundary = HashSet::new();
        for chain in self.chains.iter().filter(|chain| chain.bounds) {
            for (a, b, _) in chain.links() {
                boundary.insert((a.min(b), a.max(b)));
            }
        }
        let mut seen = vec![false; delaunay.num_all_faces()];
        // The outermost chain is counter-clockwise: the material lies on its left.
        let mut next: Vec<_> = self.chains[0]
            .links()
            .filter_map(|(a, b, _)| {
                let [a, b] = [a, b].map(|i| FixedVertexHandle::from_index(i as usize));
                let edge = delaunay.get_edge_from_neighbors(a, b)?;
                edge.face().as_inner()
            })
            .collect();
        while let Some(face) = next.pop() {
            if std::mem::replace(&mut seen[face.fix().index()], true) {
                continue;
            }
            for edge in face.adjacent_edges() {
                let [a, b] = edge.vertices().map(|v| v.fix().index() as u32);
                if !boundary.contains(&(a.min(b), a.max(b))) {
                    next.extend(edge.rev().face().as_inner());
                }
            }
        }
        // In the order of the triangulation, not of the search.
        delaunay
            .inner_faces()
            .filter(|face| seen[face.fix().index()])
            .map(|face| face.vertices().map(|v| v.fix().index() as u32))
            .collect()
    }

    /// Triangulates the points anew.
    fn connect(&mut self) -> Option<()> {
        let delaunay = self.delaunay()?;
        self.triangles = self.material(&delaunay);
        Some(())
    }

    /// Adds the centers of the circumscribed circles of triangles that are too large until there are none, largest first.
    fn divide(&mut self, sizes: &Sizes) -> Option<()> {
        let mut delaunay = self.delaunay()?;
        // Triangles that are found small enough stay so until a new point replaces them.
        let (mut last, mut waiting) = (0, HashSet::new());
        for _ in 0..MOST_PASSES {
            let mut wanted: Vec<TooLarge> = self
                .material(&delaunay)
                .into_iter()
                .filter(|triangle| {
                    triangle.iter().any(|i| *i as usize >= last)
                        || waiting.contains(&sorted(*triangle))
                })
                .filter_map(|triangle| self.too_large(triangle, sizes))
                .collect();
            if wanted.is_empty() {
                break;
            }
            wanted.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            waiting.clear();
            last = self.points.len();
            for TooLarge {
                triangle,
                center: point,
                size,
                ..
            } in wanted
            {
                let apart = |p: &Vector| (p - point).norm() > LARGEST_CIRCLE * size;
                if self.points[last..].iter().all(apart) {
                    self.points.push(point);
                    self.sizes.push(size);
                    delaunay.insert(Point2::new(point.x, point.y)).ok()?;
                } else {
                    waiting.insert(sorted(triangle));
                }
            }
        }
        self.triangles = self.material(&delaunay);
        Some(())
    }

    /// `triangle`, if its circle is too large for its place and has its center in the material.
    fn too_large(&self, triangle: [u32; 3], sizes: &Sizes) -> Option<TooLarge> {
        let (center, radius) = self.circle(triangle)?;
        let size = sizes.at(center);
        let inside = sizes.is_inside(center, NEAREST_TO_BOUNDARY * size);
        (inside && radius > LARGEST_CIRCLE * size).then_some(TooLarge {
            triangle,
            radius: radius / size,
            center,
            size,
        })
    }

    /// Center and radius of the circle through the corners of a triangle.
    fn circle(&self, triangle: [u32; 3]) -> Option<(Vector, f64)> {
        let [a, b, c] = triangle.map(|i| self.points[i as usize]);
        let (p, q) = (b - a, c - a);
        let cross = 2.0 * (p.x * q.y - p.y * q.x);
        let (pp, qq) = (p.norm_squared(), q.norm_squared());
        let to = Vector::new(q.y * pp - p.y * qq, p.x * qq - q.x * pp) / cross;
        to.norm().is_finite().then(|| (a + to, to.norm()))
    }

    /// Moves every point that stands on no chain to the center of mass of the triangles around it, each weighed by the
    /// density h⁻⁴ at which such centers stand in distances proportional to h.
    fn smooth(&mut self, fixed: usize) {
        let mut sums = vec![(Vector::zeros(), 0.0); self.points.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| self.points[i as usize]);
            let (p, q) = (b - a, c - a);
            let center = (a + b + c) / 3.0;
            let size = triangle
                .iter()
                .map(|i| self.sizes[*i as usize])
                .sum::<f64>();
            let mass = (p.x * q.y - p.y * q.x) * size.powi(-4);
            for corner in triangle {
                let sum = &mut sums[*corner as usize];
                sum.0 += mass * center;
                sum.1 += mass;
            }
        }
        for (point, (moment, mass)) in self.points.iter_mut().zip(sums).skip(fixed) {
            if mass > 0.0 {
                *point = moment / mass;
            }
        }
    }

    /// Moves points around sharp corners, one after the other, where that makes the sharpest corner around them blunter.
    fn repair(&mut self, fixed: usize) {
        let mut around: Vec<Vec<[u32; 3]>> = vec![Vec::new(); self.points.len()];
        for triangle in &self.triangles {
            for i in 0..3 {
                // Each triangle with the point itself first.
                let turned = [triangle[i], triangle[(i + 1) % 3], triangle[(i + 2) % 3]];
                around[triangle[i] as usize].push(turned);
            }
        }
        let mut bulges = HashMap::new();
        for chain in &self.chains {
            for (a, b, middle) in chain.links() {
                bulges.insert((a.min(b), a.max(b)), chain.outline.point(middle));
            }
        }
        let sharpest = |points: &[Vector], star: &[[u32; 3]]| {
            let corners = star.iter().map(|t| sharpest_corner(points, *t, &bulges));
            corners.fold(f64::INFINITY, f64::min)
        };
        for (point, star) in around.iter().enumerate().skip(fixed) {
            let mut best = sharpest(&self.points, star);
            if best >= SHARP {
                continue;
            }
            for step in STEPS.map(|step| step * self.sizes[point]) {
                for direction in 0..8 {
                    let from = self.points[point];
                    let turn = std::f64::consts::FRAC_PI_4 * f64::from(direction);
                    self.points[point] = from + step * radial(turn);
                    let corner = sharpest(&self.points, star);
                    if corner > best {
                        best = corner;
                    } else {
                        self.points[point] = from;
                    }
                }
            }
        }
    }

    /// A new point in the middle of every side, on its curve where it follows one: by the sides' ends.
    fn middles(&mut self) -> HashMap<(u32, u32), u32> {
        let mut middles = HashMap::with_capacity(2 * self.triangles.len());
        for chain in &mut self.chains {
            let mut nodes = Vec::with_capacity(2 * chain.nodes.len());
            let mut lengths = Vec::with_capacity(2 * chain.nodes.len());
            for (i, (a, b, middle)) in chain.links().enumerate() {
                let number = self.points.len() as u32;
                self.points.push(chain.outline.point(middle));
                middles.insert((a.min(b), a.max(b)), number);
                nodes.extend([a, number]);
                lengths.extend([chain.lengths[i], middle]);
            }
            if !chain.closed {
                nodes.extend(chain.nodes.last());
                lengths.extend(chain.lengths.last());
            }
            (chain.nodes, chain.lengths) = (nodes, lengths);
        }
        for triangle in &self.triangles {
            for i in 0..3 {
                let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
                middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let middle = (self.points[a as usize] + self.points[b as usize]) / 2.0;
                    self.points.push(middle);
                    self.points.len() as u32 - 1
                });
            }
        }
        middles
    }

    /// Divides every triangle into four similar ones, those along a curve with new corners on it.
    pub(super) fn halve(&mut self) {
        let middles = self.middles();
        let at = |a: u32, b: u32| middles[&(a.min(b), a.max(b))];
        let four = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (at(a, b), at(b, c), at(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        self.triangles = self.triangles.iter().flat_map(four).collect();
    }

    /// The net as a grid of 6-node triangles, and its chains with corners and midsides.
    pub(super) fn into_grid(mut self) -> (Grid, Vec<Chain>) {
        let middles = self.middles();
        let at = |a: u32, b: u32| middles[&(a.min(b), a.max(b))];
        let element =
            |&[a, b, c]: &[u32; 3]| Element::triangle([a, b, c, at(a, b), at(b, c), at(c, a)]);
        let grid = Grid {
            elements: self.triangles.iter().map(element).collect(),
            nodes: self.points,
        };
        (grid, self.chains)
    }
}

/// The corners of a triangle in an order that says nothing of where it begins.
fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// The smallest angle at a corner of `triangle` between its sides as they will be: parabolas through the points of the curves
/// in `bulges`.
fn sharpest_corner(
    points: &[Vector],
    triangle: [u32; 3],
    bulges: &HashMap<(u32, u32), Vector>,
) -> f64 {
    let corners = triangle.map(|i| points[i as usize]);
    // How much the side from corner i leans into the triangle at its ends.
    let lean: [f64; 3] = std::array::from_fn(|i| {
        let next = (i + 1) % 3;
        let key = (
            triangle[i].min(triangle[next]),
            triangle[i].max(triangle[next]),
        );
        bulges.get(&key).map_or(0.0, |top| {
            let (along, up) = (corners[next] - corners[i], top - corners[i]);
            let height = (along.x * up.y - along.y * up.x) / along.norm();
            (4.0 * height / along.norm()).atan()
        })
    });
    let angle = |i: usize| {
        let (p, q) = (
            corners[(i + 1) % 3] - corners[i],
            corners[(i + 2) % 3] - corners[i],
        );
        (p.x * q.y - p.y * q.x).atan2(p.dot(&q)) - lean[i] - lean[(i + 2) % 3]
    };
    (0..3).map(angle).fold(f64::INFINITY, f64::min)
}
