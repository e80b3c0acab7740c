//! Functions along the axis that parts of unlike width share: quadratic pieces between the faces of all of them.
//!
//! Every part is some of the pieces, so that two parts which meet have the same motion where both are. A gear that is its own image in the middle
//! of its face is half of one, once with motions that are even about that plane and once with odd ones.

use faer::Mat;

use crate::gear::Layer;
use crate::quadrature::gauss_legendre;

/// Nodes of a piece.
const PIECE: usize = 3;
/// Faces that differ by a smaller part of the whole width are one.
const SAME: f64 = 1e-6;
/// The largest length of a piece, in depths of the narrowest part along the radius.
const LONGEST: f64 = 3.0;
/// The most pieces between two faces.
const MOST_PIECES: f64 = 4.0;

/// About which motions a half gear is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// Motions of the whole: the gear is not its own image.
    Whole,
    /// Radial and tangential motions even about the middle, axial ones odd: in the plane.
    Even,
    /// The opposite: out of the plane.
    Odd,
}

/// The functions along the axis of all parts of a gear: one for each node of the pieces.
#[derive(Debug, Clone)]
pub struct Heights {
    /// Ends and middles of the pieces, rising, in meters.
    pub nodes: Vec<f64>,
    /// True if the nodes are those of the upper half of a gear that is its own image.
    pub is_half: bool,
}

/// The functions of one part: those from `first` on, and the integrals of their products over its width.
#[derive(Debug, Clone)]
pub struct PartHeights {
    /// The first function that is not zero on the part.
    pub first: usize,
    /// ∫ f_p f_q dz.
    pub products: Mat<f64>,
    /// ∫ f_p f_q' dz.
    pub slope: Mat<f64>,
    /// ∫ f_p' f_q' dz.
    pub slopes: Mat<f64>,
}

impl PartHeights {
    /// The number of its functions.
    pub fn count(&self) -> usize {
        self.products.nrows()
    }
}

impl Heights {
    /// The functions for these parts of a gear.
    pub fn of_layers(parts: &[Layer]) -> Self {
        let faces: Vec<[f64; 2]> = parts.iter().map(|part| part.heights).collect();
        let depth = |part: &Layer| part.outer_radius - part.inner_radius;
        let narrowest = parts.iter().map(depth).fold(f64::INFINITY, f64::min);
        Self::new(&faces, narrowest)
    }

    /// The functions for parts with these faces; `depth` is that of the narrowest part along the radius.
    pub fn new(parts: &[[f64; 2]], depth: f64) -> Self {
        let width = parts.iter().flatten().fold(0.0, |w: f64, z| w.max(z.abs()));
        let is_even = |[low, high]: &[f64; 2]| (low + high).abs() < SAME * width;
        let is_half = parts.iter().all(is_even);
        let mut ends: Vec<f64> = parts.iter().flatten().copied().collect();
        // The middle of each part as well: shear over half of it is a line and not a constant.
        ends.extend(parts.iter().map(|[low, high]| f64::midpoint(*low, *high)));
        if is_half {
            ends.retain(|z| *z > -SAME * width);
            ends.iter_mut().for_each(|z| *z = z.max(0.0));
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|next, one| *next - *one < SAME * width);
        let mut nodes = vec![ends[0]];
        for piece in ends.windows(2) {
            let parts = ((piece[1] - piece[0]) / (LONGEST * depth)).ceil();
            let parts = parts.clamp(1.0, MOST_PIECES) as usize;
            let step = (piece[1] - piece[0]) / (2 * parts) as f64;
            nodes.extend((1..=2 * parts).map(|i| piece[0] + step * i as f64));
        }
        Self { nodes, is_half }
    }

    /// How many times the nodes make up the gear: 2 for a half, 1 for the whole.
    pub fn copies(&self) -> f64 {
        if self.is_half { 2.0 } else { 1.0 }
    }

    /// The classes of motions that have to be asked for.
    pub fn parities(&self) -> &'static [Parity] {
        if self.is_half {
            &[Parity::Even, Parity::Odd]
        } else {
            &[Parity::Whole]
        }
    }

    /// Heights of a part between two faces.
    pub fn part(&self, [low, high]: [f64; 2]) -> PartHeights {
        let low = low.max(self.nodes[0]);
        let nearest = |z: f64| {
            let distances = self.nodes.iter().map(|node| (node - z).abs()).enumerate();
            let nearest = distances.min_by(|(_, a), (_, b)| a.total_cmp(b));
            nearest.map_or(0, |(index, _)| index)
        };
        let (first, last) = (nearest(low), nearest(high));
        let count = last + 1 - first;
        let mut part = PartHeights {
            first,
            products: Mat::zeros(count, count),
            slope: Mat::zeros(count, count),
            slopes: Mat::zeros(count, count),
        };
        for piece in (first..last).step_by(PIECE - 1) {
            let (from, to) = (self.nodes[piece], self.nodes[piece + 2]);
            for (x, w) in gauss_legendre(PIECE) {
                let half = (to - from) / 2.0;
                let f = [x * (x - 1.0) / 2.0, 1.0 - x * x, x * (x + 1.0) / 2.0];
                let g = [x - 0.5, -2.0 * x, x + 0.5].map(|g| g / half);
                for p in 0..PIECE {
                    for q in 0..PIECE {
                        let (i, j) = (piece - first + p, piece - first + q);
                        part.products[(i, j)] += w * half * f[p] * f[q];
                        part.slope[(i, j)] += w * half * f[p] * g[q];
                        part.slopes[(i, j)] += w * half * g[p] * g[q];
                    }
                }
            }
        }
        part
    }

    /// True if `component` (radial, tangential, axial) has opposite signs on both halves by `parity`.
    pub fn is_odd(&self, parity: Parity, component: usize) -> bool {
        let is_axial = component == 2;
        match parity {
            Parity::Whole => false,
            Parity::Even => is_axial,
            Parity::Odd => !is_axial,
        }
    }

    /// True if `component` of the function `index` is zero by `parity`: on the middle plane.
    pub fn is_zero(&self, parity: Parity, component: usize, index: usize) -> bool {
        index == 0 && self.is_odd(parity, component)
    }
}
