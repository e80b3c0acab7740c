//! A web with holes: a plane grid times functions across it, on the orders of its outer circle.

use faer::{Mat, c64};
use rayon::prelude::*;

use super::revolution::{add_block, last_of};
use super::sector::SolidSector;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::fem::prism::Prism;
use crate::grid::BlankGrid;
use crate::run::Run;

/// A ring of sectors with holes, each condensed to its interface.
#[derive(Debug)]
pub struct HoledRing<'a> {
    sector: SolidSector,
    /// How the nodes that are told move, by the interface of their sector.
    rows: Mat<f64>,
    /// What carries the inner circle, one of each order 0 …; without it that circle is held.
    hub: Option<&'a [Mat<c64>]>,
}

/// How nodes of sector 0 of a ring move by its outer circle, in one class.
#[derive(Debug, Clone)]
pub struct ClassRows {
    /// The class k: from a sector to the next all turns by e^{ik2π/S}.
    pub class: usize,
    /// Its orders on the outer circle.
    pub orders: Vec<i64>,
    /// The unknowns of the nodes by the outer circle, order by order, in the frame of the sector.
    pub rows: Mat<c64>,
}

/// How a ring moves.
#[derive(Debug, Clone)]
pub struct MovedRing {
    /// The interface of each sector, in its own axes: right side, left side, inner circle unless it is held, outer circle.
    pub sectors: Vec<Vec<f64>>,
    /// The amplitudes of the orders 0 … of the inner circle; `None` where it is held.
    pub hub: Option<Vec<Mat<c64>>>,
}

impl<'a> HoledRing<'a> {
    /// The ring of sectors `grid`; `prism` is its section with the functions across it, and the nodes `told` can be asked for.
    ///
    /// `hub` is what carries the inner circle, one of each order 0 … that is asked for; without it that circle is held.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn new(
        grid: &BlankGrid,
        prism: &Prism<'_>,
        hub: Option<&'a [Mat<c64>]>,
        told: &[u32],
    ) -> Result<Self, FemError> {
        let (right, left) = &grid.side_nodes;
        let angle = |node: &u32| {
            let place = grid.grid.nodes[*node as usize];
            place.y.atan2(place.x)
        };
        let (inner, held) = match hub {
            Some(_) => (grid.bore_nodes.as_slice(), [].as_slice()),
            None => ([].as_slice(), grid.bore_nodes.as_slice()),
        };
        let kept: Vec<u32> = [right.as_slice(), left, inner, &grid.arc_nodes]
            .into_iter()
            .flatten()
            .copied()
            .collect();
        let (condensed, rows) = prism.condense_with("the web", &kept, held, &[], told)?;
        let inner = hub.map(|_| inner.iter().map(angle).collect());
        Ok(Self {
            sector: SolidSector {
                count: grid.sector_count as usize,
                size: prism.unknowns_of_node(),
                stiffness: condensed.stiffness,
                side_nodes: right.len(),
                arcs: inner.into_iter().chain([grid.arc_angles.clone()]).collect(),
            },
            rows: rows.by_kept,
            hub,
        })
    }

    /// Its Hermitian stiffness on the orders −`largest` … `largest` of the outer circle, order by order. Hole 0 of a pattern stands at the
    /// angle `phase`.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn on_outer(&self, largest: usize, phase: f64, run: &Run) -> Result<Mat<c64>, FemError> {
        let size = self.sector.size;
        let classes = self.each_class(largest, run, |_, orders, stiffness| {
            last_of(&stiffness, orders.len() * size).map(|outer| (orders, outer))
        })?;
        let count = size * (2 * largest + 1);
        let mut ring = Mat::<c64>::zeros(count, count);
        let place = |order: i64| (order + largest as i64) as usize * size;
        for (orders, outer) in &classes {
            for (a, &n) in orders.iter().enumerate() {
                for (b, &m) in orders.iter().enumerate() {
                    let turn = SolidSector::turn(m - n, phase);
                    for j in 0..size {
                        for i in 0..size {
                            let value = outer[(a * size + i, b * size + j)] * turn;
                            // The class of the opposite orders is the conjugate of this one.
                            ring[(place(n) + i, place(m) + j)] = value;
                            ring[(place(-n) + i, place(-m) + j)] = value.conj();
                        }
                    }
                }
            }
        }
        Ok(ring)
    }

    /// How the nodes that are told move by the orders −`largest` … `largest` of the outer circle, class by class.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn inside(&self, largest: usize, run: &Run) -> Result<Vec<ClassRows>, FemError> {
        let sector = &self.sector;
        self.each_class(largest, run, |class, orders, stiffness| {
            let follows = following(&stiffness, orders.len() * sector.size)?;
            let rows = sector.on_class(&self.rows, class, &orders);
            let (inner, outer) = (follows.nrows(), follows.ncols());
            let by_inner = rows.subcols(0, inner) * follows;
            Ok(ClassRows {
                class,
                rows: rows.subcols(inner, outer) + by_inner,
                orders,
            })
        })
    }

    /// How the ring moves where its outer circle does: by the first of `amplitudes`, of the orders 0 …, up to the order `largest`, each a column.
    /// Hole 0 of a pattern stands at the angle `phase`.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn moved(
        &self,
        (largest, phase): (usize, f64),
        amplitudes: &[Mat<c64>],
        run: &Run,
    ) -> Result<MovedRing, FemError> {
        let sector = &self.sector;
        let (size, sides) = (sector.size, sector.size * sector.side_nodes);
        let classes = self.each_class(largest, run, |class, orders, stiffness| {
            let outer = orders.len() * size;
            let follows = following(&stiffness, outer)?;
            let inner = follows.nrows();
            let mut motion = Mat::<c64>::zeros(inner + outer, 1);
            for (k, &order) in orders.iter().enumerate() {
                let seen =
                    of_order(amplitudes, order) * faer::Scale(SolidSector::turn(order, phase));
                motion.subrows_mut(inner + k * size, size).copy_from(&seen);
            }
            let moved = follows * motion.subrows(inner, outer);
            motion.subrows_mut(0, inner).copy_from(&moved);
            Ok((class, orders, motion))
        })?;
        let mut hub = vec![Mat::zeros(size, 1); largest + 1];
        let mut sectors = vec![Vec::new(); sector.count];
        for (class, orders, motion) in &classes {
            let interface = sector.off_class(motion, *class, orders);
            sector.add_to_each(*class, &interface, &mut sectors);
            for (k, &order) in orders.iter().enumerate() {
                if self.hub.is_some() {
                    let of = motion.subrows(sides + k * size, size);
                    let of = of * faer::Scale(SolidSector::turn(-order, phase));
                    hub[order.unsigned_abs() as usize] = conjugate_below_zero(&of, order);
                }
            }
        }
        Ok(MovedRing {
            sectors,
            hub: self.hub.is_some().then_some(hub),
        })
    }

    /// What `of` makes of each class that has orders up to `largest`: its number, these orders, and the stiffness of the ring on its
    /// unknowns, the outer circle last.
    fn each_class<T: Send>(
        &self,
        largest: usize,
        run: &Run,
        of: impl Fn(usize, Vec<i64>, Mat<c64>) -> Result<T, FemError> + Sync,
    ) -> Result<Vec<T>, FemError> {
        let sector = &self.sector;
        let made = (0..=sector.count / 2).into_par_iter().map(|class| {
            run.check()?;
            let orders = sector.orders(class, largest);
            if orders.is_empty() {
                return Ok(None);
            }
            let mut stiffness = sector.class_stiffness(class, &orders);
            stiffness *= faer::Scale(c64::new(sector.count as f64, 0.0));
            if let Some(hub) = self.hub {
                let first = sector.size * sector.side_nodes;
                for (k, order) in orders.iter().enumerate() {
                    let carried = of_order(hub, *order);
                    add_block(&mut stiffness, first + k * sector.size, &carried);
                }
            }
            of(class, orders, stiffness).map(Some)
        });
        let made: Vec<Option<T>> = made.collect::<Result<_, FemError>>()?;
        Ok(made.into_iter().flatten().collect())
    }
}

/// How all other unknowns follow the last `outer` of those of a class.
fn following(stiffness: &Mat<c64>, outer: usize) -> Result<Mat<c64>, FemError> {
    let inner = stiffness.nrows() - outer;
    let factor = Cholesky::new(stiffness.submatrix(0, 0, inner, inner).to_owned());
    let factor = factor.ok_or(FemError::NotPositiveDefinite {
        part: "the web",
        unknowns: inner,
    })?;
    let mut follows = -stiffness.submatrix(0, inner, inner, outer).to_owned();
    factor.solve_in_place(follows.as_mut());
    Ok(follows)
}

/// That of an order of either sign, of those of 0 and more.
pub fn of_order(orders: &[Mat<c64>], order: i64) -> Mat<c64> {
    conjugate_below_zero(&orders[order.unsigned_abs() as usize], order)
}

/// That of an order of either sign, of that of 0 or more; or the other way.
pub fn conjugate_below_zero(of: &Mat<c64>, order: i64) -> Mat<c64> {
    if order < 0 {
        of.conjugate().to_owned()
    } else {
        of.clone()
    }
}
