//! One of equal sectors around an axis, with functions along it, and the classes of their ring.
//!
//! As [`crate::ring::cyclic`] has it for the plane: the displacement of a class k turns by e^{ik2π/S} from a sector to the next, and on
//! the circle it holds the orders n ≡ k (mod S).

use faer::{Mat, c64};

/// A sector on its interface: right side, left side, arcs, node by node.
#[derive(Debug, Clone)]
pub(crate) struct SolidSector {
    /// The number S of sectors in the ring.
    pub count: usize,
    /// The unknowns of a node.
    pub size: usize,
    /// The stiffness, in N/m.
    pub stiffness: Mat<f64>,
    /// The number of nodes on each side.
    pub side_nodes: usize,
    /// Its arcs, one after the other.
    pub arcs: Vec<Arc>,
}

/// Displacement of an arc: blocks of unknowns.
#[derive(Debug, Clone)]
pub(crate) enum Arc {
    /// The nodes at these angles.
    Nodes(Vec<f64>),
    /// The amplitudes a_0, a_1, b_1, … of Σ a_n cos nφ + b_n sin nφ up to an order: of a whole circle.
    Harmonics(usize),
}

impl Arc {
    fn blocks(&self) -> usize {
        match self {
            Self::Nodes(angles) => angles.len(),
            Self::Harmonics(largest) => 2 * largest + 1,
        }
    }

    /// The blocks in which e^{i order φ} is seen, and how.
    fn trace(&self, order: i64) -> Vec<(usize, c64)> {
        match self {
            Self::Nodes(angles) => {
                let turn = |angle: &f64| SolidSector::turn(order, *angle);
                angles.iter().map(turn).enumerate().collect()
            }
            Self::Harmonics(_) => {
                let (cosine, one) = (2 * order.unsigned_abs() as usize, c64::new(1.0, 0.0));
                match order.signum() {
                    0 => vec![(0, one)],
                    sign => vec![(cosine - 1, one), (cosine, c64::new(0.0, sign as f64))],
                }
            }
        }
    }

    /// The amplitudes of [`Arc::Harmonics`] at nodes: a row for each of `angles`.
    pub(crate) fn harmonics_at(angles: &[f64], largest: usize) -> Mat<f64> {
        Mat::from_fn(angles.len(), 2 * largest + 1, |i, j| {
            let (sin, cos) = (j.div_ceil(2) as f64 * angles[i]).sin_cos();
            if j > 0 && j.is_multiple_of(2) {
                sin
            } else {
                cos
            }
        })
    }
}

impl SolidSector {
    /// The interface alone, its arcs given node by node at these angles.
    pub(crate) fn with_nodes(&self, angles: &[Vec<f64>]) -> Self {
        Self {
            stiffness: Mat::zeros(0, 0),
            arcs: angles.iter().cloned().map(Arc::Nodes).collect(),
            ..*self
        }
    }

    /// The orders of `class` up to `largest`.
    pub(crate) fn orders(&self, class: usize, largest: usize) -> Vec<i64> {
        let harmonics = crate::ring::cyclic::Harmonics { largest };
        harmonics.orders_of_class(class, self.count)
    }

    /// e^{i order angle}.
    pub(crate) fn turn(order: i64, angle: f64) -> c64 {
        let (sin, cos) = (order as f64 * angle).sin_cos();
        c64::new(cos, sin)
    }

    /// Weight of a class in the sector `ahead` places counter-clockwise of `count`, if it stands for the opposite one too, its conjugate: the real part is to
    /// be taken.
    pub(crate) fn part(class: usize, ahead: usize, count: usize) -> c64 {
        // The class may be its own opposite.
        let share = match (2 * class).is_multiple_of(count) {
            true => 1.0,
            false => 2.0,
        };
        let place = (class * ahead % count) as f64;
        Self::turn(1, std::f64::consts::TAU * place / count as f64) * share
    }

    /// How each unknown of the class, sides, then arc by arc, order by order, moves the interface: the unknowns there, and how far.
    fn motions(&self, class: usize, orders: &[i64]) -> Vec<Vec<(usize, c64)>> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let angle = std::f64::consts::TAU * (class % self.count) as f64 / self.count as f64;
        let across = Self::turn(1, angle);
        let of_side = |j: usize| vec![(j, c64::new(1.0, 0.0)), (sides + j, across)];
        let mut motions: Vec<_> = (0..sides).map(of_side).collect();
        let mut from = 2 * sides;
        for arc in &self.arcs {
            for &order in orders {
                let trace = arc.trace(order);
                for c in 0..size {
                    let moved = trace
                        .iter()
                        .map(|(block, turn)| (from + block * size + c, *turn));
                    motions.push(moved.collect());
                }
            }
            from += arc.blocks() * size;
        }
        motions
    }

    /// `rows` on the interface as rows on the unknowns of the class: sides, then arc by arc, order by order.
    pub(crate) fn on_class(&self, rows: &Mat<f64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let motions = self.motions(class, orders);
        let mut on_class = Mat::<c64>::zeros(rows.nrows(), motions.len());
        for (j, moved) in motions.iter().enumerate() {
            add_columns(on_class.col_as_slice_mut(j), rows, moved);
        }
        on_class
    }

    /// How the interface moves where the unknowns of the class are `motion`, a column for each of several.
    pub(crate) fn off_class(&self, motion: &Mat<c64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let angle = std::f64::consts::TAU * (class % self.count) as f64 / self.count as f64;
        let across = Self::turn(1, angle);
        let blocks: usize = self.arcs.iter().map(Arc::blocks).sum();
        let mut off = Mat::<c64>::zeros(2 * sides + blocks * size, motion.ncols());
        for j in 0..motion.ncols() {
            let (from, to) = (motion.col_as_slice(j), off.col_as_slice_mut(j));
            for i in 0..sides {
                to[i] = from[i];
                to[sides + i] = across * from[i];
            }
        }
        let (mut first, mut from) = (2 * sides, sides);
        for arc in &self.arcs {
            for &order in orders {
                for (block, turn) in arc.trace(order) {
                    for j in 0..motion.ncols() {
                        let from = &motion.col_as_slice(j)[from..from + size];
                        let to = &mut off.col_as_slice_mut(j)[first + block * size..][..size];
                        for (to, from) in to.iter_mut().zip(from) {
                            *to += turn * *from;
                        }
                    }
                }
                from += size;
            }
            first += arc.blocks() * size;
        }
        off
    }

    /// Adds the part `of` a class, and as its conjugate of the opposite one, to `sums`, one for each sector.
    pub(crate) fn add_to_each(&self, class: usize, of: &Mat<c64>, sums: &mut [Vec<f64>]) {
        for (number, sum) in sums.iter_mut().enumerate() {
            let turn = Self::part(class, number, self.count);
            sum.resize(of.nrows(), 0.0);
            for (sum, of) in sum.iter_mut().zip(of.col_as_slice(0)) {
                *sum += (turn * *of).re;
            }
        }
    }

    /// The Hermitian stiffness of one sector on the unknowns of the class.
    pub(crate) fn class_stiffness(&self, class: usize, orders: &[i64]) -> Mat<c64> {
        let motions = self.motions(class, orders);
        let count = motions.len();
        let mut stiffness = Mat::<c64>::zeros(count, count);
        let mut forces = vec![c64::new(0.0, 0.0); self.stiffness.nrows()];
        for (j, moved) in motions.iter().enumerate() {
            forces.fill(c64::new(0.0, 0.0));
            add_columns(&mut forces, &self.stiffness, moved);
            let column = stiffness.col_as_slice_mut(j);
            for (to, motion) in column.iter_mut().zip(&motions) {
                let each = motion.iter().map(|(at, turn)| turn.conj() * forces[*at]);
                *to = each.sum();
            }
        }
        stiffness
    }
}

/// Adds the columns of `rows` that have a part in a motion, times that part.
fn add_columns(sum: &mut [c64], rows: &Mat<f64>, moved: &[(usize, c64)]) {
    for (from, turn) in moved {
        for (to, value) in sum.iter_mut().zip(rows.col_as_slice(*from)) {
            *to += *turn * *value;
        }
    }
}
