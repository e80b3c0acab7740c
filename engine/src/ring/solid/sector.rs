//! One of equal sectors around an axis, with functions along it, and the classes of their ring.
//!
//! As [`crate::ring::cyclic`] has it for the plane: the displacement of a class k turns by e^{ik2π/S} from a sector to the next, and on
//! the circle it holds the orders n ≡ k (mod S).

use faer::{Mat, c64};

/// A sector on its interface: right side, left side, arcs, node by node.
#[derive(Debug, Clone)]
pub struct SolidSector {
    /// The number S of sectors in the ring.
    pub count: usize,
    /// The unknowns of a node.
    pub size: usize,
    /// The stiffness, in N/m.
    pub stiffness: Mat<f64>,
    /// The number of nodes on each side.
    pub side_nodes: usize,
    /// The angles of the nodes on its arcs, one arc after the other.
    pub arcs: Vec<Vec<f64>>,
}

impl SolidSector {
    /// The orders of `class` up to `largest`.
    pub fn orders(&self, class: usize, largest: usize) -> Vec<i64> {
        let harmonics = crate::ring::cyclic::Harmonics { largest };
        harmonics.orders_of_class(class, self.count)
    }

    /// e^{i order angle}.
    pub fn turn(order: i64, angle: f64) -> c64 {
        let (sin, cos) = (order as f64 * angle).sin_cos();
        c64::new(cos, sin)
    }

    /// By what a class adds to the sector `ahead` places counter-clockwise of `count`, if it is told together with the opposite one, its conjugate:
    /// the real part is to be taken.
    pub fn part(class: usize, ahead: usize, count: usize) -> c64 {
        // The class may be its own opposite.
        let share = match (2 * class).is_multiple_of(count) {
            true => 1.0,
            false => 2.0,
        };
        let place = (class * ahead % count) as f64;
        Self::turn(1, std::f64::consts::TAU * place / count as f64) * share
    }

    /// The unknowns of a class: those of one side, and on each arc those of each of `orders`.
    pub fn unknowns(&self, orders: &[i64]) -> usize {
        self.size * (self.side_nodes + self.arcs.len() * orders.len())
    }

    /// `rows` on the interface as rows on the unknowns of the class: sides, then arc by arc, order by order.
    pub fn on_class(&self, rows: &Mat<f64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let angle = std::f64::consts::TAU * (class % self.count) as f64 / self.count as f64;
        let across = Self::turn(1, angle);
        let mut on_class = Mat::<c64>::zeros(rows.nrows(), self.unknowns(orders));
        for j in 0..sides {
            let (right, left) = (rows.col_as_slice(j), rows.col_as_slice(sides + j));
            let column = on_class.col_as_slice_mut(j);
            for ((to, r), l) in column.iter_mut().zip(right).zip(left) {
                *to = across * *l + c64::new(*r, 0.0);
            }
        }
        let mut from = 2 * sides;
        for (arc, angles) in self.arcs.iter().enumerate() {
            let first = sides + arc * orders.len() * size;
            for &angle in angles {
                for (k, &order) in orders.iter().enumerate() {
                    let turn = Self::turn(order, angle);
                    for c in 0..size {
                        let from = rows.col_as_slice(from + c);
                        let column = on_class.col_as_slice_mut(first + k * size + c);
                        for (to, from) in column.iter_mut().zip(from) {
                            *to += turn * *from;
                        }
                    }
                }
                from += size;
            }
        }
        on_class
    }

    /// How the interface moves where the unknowns of the class are `motion`, a column for each of several.
    pub fn off_class(&self, motion: &Mat<c64>, class: usize, orders: &[i64]) -> Mat<c64> {
        let (size, sides) = (self.size, self.size * self.side_nodes);
        let angle = std::f64::consts::TAU * (class % self.count) as f64 / self.count as f64;
        let across = Self::turn(1, angle);
        let nodes: usize = self.arcs.iter().map(Vec::len).sum();
        let mut off = Mat::<c64>::zeros(2 * sides + nodes * size, motion.ncols());
        for j in 0..motion.ncols() {
            let (from, to) = (motion.col_as_slice(j), off.col_as_slice_mut(j));
            for i in 0..sides {
                to[i] = from[i];
                to[sides + i] = across * from[i];
            }
        }
        let mut first = 2 * sides;
        for (arc, angles) in self.arcs.iter().enumerate() {
            let of_arc = sides + arc * orders.len() * size;
            for &angle in angles {
                for (k, &order) in orders.iter().enumerate() {
                    let turn = Self::turn(order, angle);
                    for j in 0..motion.ncols() {
                        let from = &motion.col_as_slice(j)[of_arc + k * size..][..size];
                        let to = &mut off.col_as_slice_mut(j)[first..first + size];
                        for (to, from) in to.iter_mut().zip(from) {
                            *to += turn * *from;
                        }
                    }
                }
                first += size;
            }
        }
        off
    }

    /// Adds what is `of` a class, and as its conjugate of the opposite one, to `sums`, one for each sector.
    pub fn add_to_each(&self, class: usize, of: &Mat<c64>, sums: &mut [Vec<f64>]) {
        for (number, sum) in sums.iter_mut().enumerate() {
            let turn = Self::part(class, number, self.count);
            sum.resize(of.nrows(), 0.0);
            for (sum, of) in sum.iter_mut().zip(of.col_as_slice(0)) {
                *sum += (turn * *of).re;
            }
        }
    }

    /// The Hermitian stiffness of one sector on the unknowns of the class.
    pub fn class_stiffness(&self, class: usize, orders: &[i64]) -> Mat<c64> {
        let half = self.on_class(&self.stiffness, class, orders);
        // Pᴴ (K P): the same on the rows of K P, which are the conjugates of the columns of its adjoint.
        let adjoint = half.adjoint().to_owned();
        let parts = [
            Mat::from_fn(adjoint.nrows(), adjoint.ncols(), |i, j| adjoint[(i, j)].re),
            Mat::from_fn(adjoint.nrows(), adjoint.ncols(), |i, j| adjoint[(i, j)].im),
        ];
        let [real, imaginary] = parts.map(|part| self.on_class(&part, class, orders));
        let n = real.nrows();
        Mat::from_fn(n, n, |i, j| {
            real[(i, j)] + c64::new(0.0, 1.0) * imaginary[(i, j)]
        })
    }
}
