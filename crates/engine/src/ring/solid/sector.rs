//! One of equal sectors around an axis, with functions along it, and the classes of their ring.
//!
//! As [`crate::ring::cyclic`] has it for the plane: the displacement of a class k turns by e^{ik2π/S} from a sector to the next, and on
//! the circle it holds the orders n ≡ k (mod S).

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, c64, unzip, zip};

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

    /// e^{ik2π/S}: the turn of a class from a sector to the next.
    fn across(&self, class: usize) -> c64 {
        let angle = std::f64::consts::TAU * (class % self.count) as f64 / self.count as f64;
        Self::turn(1, angle)
    }

    /// Each arc in `orders`, with its first unknown on the interface.
    fn arcs_in_orders<'a>(&'a self, orders: &'a [i64]) -> Vec<(usize, ArcInOrders<'a>)> {
        let mut from = 2 * self.size * self.side_nodes;
        let in_orders = |arc: &'a Arc| {
            let first = from;
            from += arc.blocks() * self.size;
            (first, ArcInOrders::new(arc, orders))
        };
        self.arcs.iter().map(in_orders).collect()
    }

    /// `rows` on the interface as rows on the unknowns of the class: sides, then arc by arc, order by order.
    pub(crate) fn on_class(&self, rows: &Mat<f64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let across = self.across(class);
        let arcs = self.arcs_in_orders(orders);
        let count = sides + arcs.len() * orders.len() * size;
        let mut on_class = Mat::<c64>::zeros(rows.nrows(), count);
        for j in 0..sides {
            let ends = rows
                .col_as_slice(j)
                .iter()
                .zip(rows.col_as_slice(sides + j));
            let column = on_class.col_as_slice_mut(j);
            for (to, (right, left)) in column.iter_mut().zip(ends) {
                *to = across * *left + *right;
            }
        }
        for (number, (from, arc)) in arcs.iter().enumerate() {
            let first = sides + number * orders.len() * size;
            for c in 0..size {
                let by_orders = arc.of_columns(rows, (from + c, size));
                for k in 0..orders.len() {
                    let parts = [k, orders.len() + k].map(|part| by_orders.col_as_slice(part));
                    let column = on_class.col_as_slice_mut(first + k * size + c);
                    for (to, (re, im)) in column.iter_mut().zip(parts[0].iter().zip(parts[1])) {
                        *to = c64::new(*re, *im);
                    }
                }
            }
        }
        on_class
    }

    /// How the interface moves where the unknowns of the class are `motion`, a column for each of several.
    pub(crate) fn off_class(&self, motion: &Mat<c64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let across = self.across(class);
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

    /// The Hermitian stiffness of one sector on the unknowns of the class: its lower triangle.
    pub(crate) fn class_stiffness(&self, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let across = self.across(class);
        let arcs = self.arcs_in_orders(orders);
        let count = sides + arcs.len() * orders.len() * size;
        let mut stiffness = Mat::<c64>::zeros(count, count);
        for j in 0..sides {
            let [right, left] = [j, sides + j].map(|j| self.stiffness.col_as_slice(j));
            let column = &mut stiffness.col_as_slice_mut(j)[..sides];
            for (i, to) in column.iter_mut().enumerate().skip(j) {
                let both = right[i] + left[sides + i];
                *to = across * left[i] + across.conj() * right[sides + i] + both;
            }
        }
        let first_of = |arc: usize| sides + arc * orders.len() * size;
        for (number, (from, arc)) in arcs.iter().enumerate() {
            for c in 0..size {
                let forces = arc.of_columns(&self.stiffness, (from + c, size));
                for k in 0..orders.len() {
                    let own = first_of(number) + k * size + c;
                    let [re, im] = [k, orders.len() + k].map(|part| forces.col_as_slice(part));
                    for j in 0..sides {
                        let [right, left] = [j, sides + j].map(|j| c64::new(re[j], -im[j]));
                        stiffness[(own, j)] = right + across * left;
                    }
                    for (other, (from, arc)) in arcs.iter().enumerate().skip(number) {
                        let [re, im] = [re, im].map(|of| arc.of_rows(&of[*from..], size));
                        // Those of one arc meet each other once.
                        let lower = if other == number { k } else { 0 };
                        for n in lower..orders.len() {
                            let to = first_of(other) + n * size;
                            let to = &mut stiffness.col_as_slice_mut(own)[to..to + size];
                            let sine = orders.len() + n;
                            for (i, to) in to.iter_mut().enumerate() {
                                *to = c64::new(
                                    re[(i, n)] + im[(i, sine)],
                                    im[(i, n)] - re[(i, sine)],
                                );
                            }
                        }
                    }
                }
            }
        }
        stiffness
    }
}

/// Orders on an arc.
struct ArcInOrders<'a> {
    arc: &'a Arc,
    orders: &'a [i64],
    /// Of nodes, the cosine of each order at each, then the sines: a column each.
    turns: Mat<f64>,
}

impl<'a> ArcInOrders<'a> {
    fn new(arc: &'a Arc, orders: &'a [i64]) -> Self {
        let turns = match arc {
            Arc::Nodes(angles) => {
                let mut turns = Mat::zeros(angles.len(), 2 * orders.len());
                for (k, order) in orders.iter().enumerate() {
                    for (i, angle) in angles.iter().enumerate() {
                        let turn = SolidSector::turn(*order, *angle);
                        (turns[(i, k)], turns[(i, orders.len() + k)]) = (turn.re, turn.im);
                    }
                }
                turns
            }
            Arc::Harmonics(_) => Mat::zeros(0, 0),
        };
        Self { arc, orders, turns }
    }

    /// The sums over the blocks of its unknowns, a column each, turned by each order: the real parts, then the imaginary ones.
    fn sums(&self, blocks: MatRef<'_, f64>) -> Mat<f64> {
        let mut sums = Mat::zeros(blocks.nrows(), 2 * self.orders.len());
        match self.arc {
            Arc::Nodes(_) => matmul(
                sums.as_mut(),
                Accum::Replace,
                blocks,
                self.turns.as_ref(),
                1.0,
                Par::Seq,
            ),
            Arc::Harmonics(_) => {
                for (k, order) in self.orders.iter().enumerate() {
                    for (block, turn) in self.arc.trace(*order) {
                        for (part, share) in [(k, turn.re), (self.orders.len() + k, turn.im)] {
                            zip!(sums.col_mut(part), blocks.col(block))
                                .for_each(|unzip!(sum, of)| *sum += share * *of);
                        }
                    }
                }
            }
        }
        sums
    }

    /// [`ArcInOrders::sums`] of columns of `of`: the first, and every `size`-th from there on.
    fn of_columns(&self, of: &Mat<f64>, (first, size): (usize, usize)) -> Mat<f64> {
        let mut blocks = Mat::zeros(of.nrows(), self.arc.blocks());
        for block in 0..blocks.ncols() {
            let column = of.col(first + block * size);
            blocks.col_mut(block).copy_from(column);
        }
        self.sums(blocks.as_ref())
    }

    /// [`ArcInOrders::sums`] of the first entries of `of`, `size` of each block.
    fn of_rows(&self, of: &[f64], size: usize) -> Mat<f64> {
        let blocks = self.arc.blocks();
        self.sums(MatRef::from_column_major_slice(
            &of[..size * blocks],
            size,
            blocks,
        ))
    }
}
