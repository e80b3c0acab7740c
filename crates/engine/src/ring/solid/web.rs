//! A web with holes: a plane grid times functions across it, on the orders of its outer circle.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par, c64};
use rayon::prelude::*;

use super::revolution::{add_block, last_of};
use super::sector::{Arc, SolidSector};
use crate::fem::FemError;
use crate::fem::Followers;
use crate::fem::dense::{Cholesky, mirror_lower};
use crate::fem::divided::DividedPrism;
use crate::fem::prism::{CondensationCost, Interface, Prism};
use crate::grid::BlankGrid;
use crate::run::Run;

/// Classes that are condensed at the same time at most, on as many threads or fewer: each takes memory of its own meanwhile, which the estimate tells.
const CLASSES_AT_ONCE: usize = 8;

/// A ring of sectors with holes, each condensed to its interface.
///
/// Its circles move by the orders up to the largest that is asked for. Where one sector is all of the ring, which has many nodes
/// around it, these take the place of the nodes before it is condensed.
#[derive(Debug)]
pub struct HoledRing<'a> {
    sector: SolidSector,
    /// The angles of the nodes of each of its arcs.
    angles: Vec<Vec<f64>>,
    /// How the recovered nodes move, by the interface of their sector.
    rows: Mat<f64>,
    /// The largest order that is asked for.
    largest: usize,
    /// Stiffness under the inner circle, one of each order 0 …; without it that circle is held.
    hub: Option<&'a [Mat<c64>]>,
}

/// The unknowns to which a sector is condensed: its sides node by node, then its circles, the outer one last.
struct SectorInterface<'a> {
    kept: Vec<u32>,
    followers: Vec<Followers<'a>>,
    held: &'a [u32],
    /// The nodes of each circle that is not held, and their angles.
    circles: Vec<(&'a [u32], Vec<f64>)>,
    /// True if one sector is all of the ring.
    is_whole: bool,
}

/// The stiffness of a ring on its outer circle, in one class.
#[derive(Debug, Clone)]
pub struct ClassStiffness {
    /// Its orders.
    pub orders: Vec<i64>,
    /// The Hermitian stiffness, order by order.
    pub stiffness: Mat<c64>,
}

/// Motion of nodes of sector 0 of a ring by its outer circle, in one class.
#[derive(Debug, Clone)]
pub struct ClassRows {
    /// The class k: from a sector to the next all turns by e^{ik2π/S}.
    pub class: usize,
    /// Its orders on the outer circle.
    pub orders: Vec<i64>,
    /// The unknowns of the nodes by the outer circle, order by order, in the frame of the sector.
    pub rows: Mat<c64>,
}

/// Motion of a ring.
#[derive(Debug, Clone)]
pub struct MovedRing {
    /// The interface of each sector, in its own axes: right side, left side, inner circle unless it is held, outer circle.
    pub sectors: Vec<Vec<f64>>,
    /// The amplitudes of the orders 0 … of the inner circle; `None` where it is held.
    pub hub: Option<Vec<Mat<c64>>>,
}

impl<'a> SectorInterface<'a> {
    fn new(grid: &'a BlankGrid, carried: bool, largest: usize) -> Self {
        let (right, left) = &grid.side_nodes;
        let angle = |node: &u32| {
            let place = grid.grid.nodes[*node as usize];
            place.y.atan2(place.x)
        };
        let mut circles = vec![(grid.arc_nodes.as_slice(), grid.arc_angles.clone())];
        let mut held = grid.bore_nodes.as_slice();
        if carried {
            circles.insert(0, (held, held.iter().map(angle).collect()));
            held = &[];
        }
        let mut kept = [right.as_slice(), left].concat();
        let mut followers = Vec::new();
        let is_whole = right.is_empty();
        for (nodes, angles) in &circles {
            if is_whole {
                let weights = Arc::harmonics_at(angles, largest);
                followers.push(Followers { nodes, weights });
            } else {
                kept.extend_from_slice(nodes);
            }
        }
        Self {
            kept,
            followers,
            held,
            circles,
            is_whole,
        }
    }

    fn of_prism(&self) -> Interface<'_> {
        Interface {
            kept: &self.kept,
            followers: &self.followers,
            fixed: self.held,
        }
    }

    /// The number of its blocks of unknowns, one a node or an amplitude.
    fn blocks(&self) -> usize {
        let followed = self.followers.iter().map(|of| of.weights.ncols());
        self.kept.len() + followed.sum::<usize>()
    }
}

impl<'a> HoledRing<'a> {
    /// The ring of sectors `grid`; `prism` is its section with the functions across it, and the displacements of the nodes `recovered` can be asked for. It is asked
    /// for the orders up to `largest`.
    ///
    /// `hub` is the stiffness under the inner circle, one of each of these orders; without it that circle is held.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn new(
        grid: &BlankGrid,
        prism: &Prism<'_>,
        hub: Option<&'a [Mat<c64>]>,
        (largest, recovered): (usize, &[u32]),
        run: &Run,
    ) -> Result<Self, FemError> {
        let sides = SectorInterface::new(grid, hub.is_some(), largest);
        let interface = sides.of_prism();
        let divided = DividedPrism::new(prism, &interface);
        let (stiffness, rows) = divided.condense("the web", recovered, run)?;
        let angles = sides.circles.into_iter().map(|(_, angles)| angles);
        let angles: Vec<_> = angles.collect();
        let arcs = angles.iter().map(|angles| match sides.is_whole {
            true => Arc::Harmonics(largest),
            false => Arc::Nodes(angles.clone()),
        });
        Ok(Self {
            sector: SolidSector {
                count: grid.sector_count as usize,
                size: prism.unknowns_of_node(),
                stiffness,
                side_nodes: grid.side_nodes.0.len(),
                arcs: arcs.collect(),
            },
            angles,
            rows,
            largest,
            hub,
        })
    }

    /// Cost of making a ring of sectors `grid` on a bore that is `carried` or held, and of its stiffness on the outer circle, for the orders up to `largest` and
    /// so many `recovered` nodes.
    pub fn cost(
        grid: &BlankGrid,
        prism: &Prism<'_>,
        carried: bool,
        (largest, recovered): (usize, usize),
    ) -> CondensationCost {
        let sides = SectorInterface::new(grid, carried, largest);
        let interface = sides.of_prism();
        let made = DividedPrism::new(prism, &interface).cost(recovered);
        let size = prism.unknowns_of_node() as f64;
        let count = grid.sector_count as usize;
        let classes = (count / 2 + 1) as f64;
        let outer = size * (2 * largest + 1).div_ceil(count) as f64;
        let inner =
            size * grid.side_nodes.0.len() as f64 + outer * (sides.circles.len() - 1) as f64;
        let rows = size * recovered as f64;
        // What is left of each class is kept. Meanwhile there are its stiffness, the factor of what is eliminated, a product, and its rows.
        let left = outer * (outer + rows);
        let meanwhile = match inner > 0.0 {
            true => (inner + outer) * (2.0 * inner + outer + rows) + outer * outer,
            false => outer * outer,
        };
        let of_classes = 16.0 * (classes.min(CLASSES_AT_ONCE as f64) * meanwhile + classes * left);
        let kept = size * sides.blocks() as f64;
        CondensationCost {
            memory: made.memory.max(8.0 * kept * (kept + rows) + of_classes),
            // Complex numbers take four of each.
            operations: made.operations
                + 4.0 * classes * inner * (inner * inner / 6.0 + (inner + outer) * (outer + rows)),
        }
    }

    /// Its stiffness on the orders of the outer circle, class by class. Hole 0 of a pattern stands at the angle
    /// `phase`.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn on_outer(&self, phase: f64, run: &Run) -> Result<Vec<ClassStiffness>, FemError> {
        let size = self.sector.size;
        self.each_class(run, |_, orders, mut stiffness| {
            let kept = orders.len() * size;
            // Nothing is to be eliminated of a whole ring on its bore.
            let mut outer = if stiffness.nrows() == kept {
                mirror_lower(&mut stiffness);
                stiffness
            } else {
                last_of(&stiffness, kept)?
            };
            for j in 0..outer.ncols() {
                for i in 0..outer.nrows() {
                    outer[(i, j)] *= SolidSector::turn(orders[j / size] - orders[i / size], phase);
                }
            }
            Ok(ClassStiffness {
                orders,
                stiffness: outer,
            })
        })
    }

    /// How the recovered nodes move by the orders of the outer circle, class by class.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn inside(&self, run: &Run) -> Result<Vec<ClassRows>, FemError> {
        let sector = &self.sector;
        self.each_class(run, |class, orders, stiffness| {
            let outer = orders.len() * sector.size;
            let mut rows = sector.on_class(&self.rows, class, &orders);
            // Nothing else moves of a whole ring on its bore.
            if stiffness.nrows() > outer {
                let follows = following(&stiffness, outer)?;
                let (by_inner, mut by_outer) = rows.as_mut().split_at_col_mut(follows.nrows());
                matmul(
                    by_outer.as_mut(),
                    Accum::Add,
                    by_inner.as_ref(),
                    &follows,
                    c64::new(1.0, 0.0),
                    Par::Seq,
                );
                rows = by_outer.to_owned();
            }
            Ok(ClassRows {
                class,
                rows,
                orders,
            })
        })
    }

    /// How the ring moves where its outer circle does: by the first of `amplitudes`, of the orders 0 …, each a column. Hole 0 of a pattern
    /// stands at the angle `phase`.
    ///
    /// # Errors
    ///
    /// [`FemError`].
    pub fn moved(
        &self,
        phase: f64,
        amplitudes: &[Mat<c64>],
        run: &Run,
    ) -> Result<MovedRing, FemError> {
        let sector = &self.sector.with_nodes(&self.angles);
        let (size, sides) = (sector.size, sector.size * sector.side_nodes);
        let classes = self.each_class(run, |class, orders, stiffness| {
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
        let mut hub = vec![Mat::zeros(size, 1); self.largest + 1];
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

    /// Result of `of` for each class that has orders: its number, these orders, and the stiffness of the ring on its unknowns, the outer circle last: its
    /// lower triangle.
    fn each_class<T: Send>(
        &self,
        run: &Run,
        of: impl Fn(usize, Vec<i64>, Mat<c64>) -> Result<T, FemError> + Sync,
    ) -> Result<Vec<T>, FemError> {
        let sector = &self.sector;
        let of_class = |class: &usize| {
            let class = *class;
            run.check()?;
            let orders = sector.orders(class, self.largest);
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
        };
        let classes: Vec<usize> = (0..=sector.count / 2).collect();
        let mut made = Vec::with_capacity(classes.len());
        for together in classes.chunks(CLASSES_AT_ONCE) {
            let some = together.par_iter().map(of_class);
            made.extend(some.collect::<Result<Vec<Option<T>>, FemError>>()?);
        }
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
    let mut follows = -stiffness
        .submatrix(inner, 0, outer, inner)
        .adjoint()
        .to_owned();
    factor.solve_in_place(follows.as_mut());
    Ok(follows)
}

/// Matrix of an order of either sign, from those of 0 and more.
pub(crate) fn of_order(orders: &[Mat<c64>], order: i64) -> Mat<c64> {
    conjugate_below_zero(&orders[order.unsigned_abs() as usize], order)
}

/// Matrix of an order of either sign, from that of its absolute value, or the other way.
pub(crate) fn conjugate_below_zero(of: &Mat<c64>, order: i64) -> Mat<c64> {
    if order < 0 {
        of.conjugate().to_owned()
    } else {
        of.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fem::axial::AxialBasis;
    use crate::gear::{HolePattern, Material};
    use crate::grid::GridLevel;

    /// The stiffness on all orders up to `largest`, from the lowest negative one on, of that of each class.
    fn on_all(classes: &[ClassStiffness], size: usize, largest: usize) -> Mat<c64> {
        let count = size * (2 * largest + 1);
        let mut all = Mat::<c64>::zeros(count, count);
        let place = |order: i64| (order + largest as i64) as usize * size;
        for ClassStiffness {
            orders,
            stiffness: of,
        } in classes
        {
            for j in 0..of.ncols() {
                for i in 0..of.nrows() {
                    let (n, m) = (orders[i / size], orders[j / size]);
                    all[(place(n) + i % size, place(m) + j % size)] = of[(i, j)];
                    // The class of the opposite orders is the conjugate of this one.
                    all[(place(-n) + i % size, place(-m) + j % size)] = of[(i, j)].conj();
                }
            }
        }
        all
    }

    #[test]
    fn a_ring_is_as_stiff_on_its_orders_by_sectors_and_as_a_whole_on_a_hub_and_on_a_bore() {
        let pattern = HolePattern {
            count: 5,
            circle_radius: 20e-3,
            radius: 4e-3,
            phase: 0.0,
        };
        let (radius, largest, phase) = (30e-3, 6, 0.3);
        let grid = BlankGrid::new(10e-3, radius, Some(&pattern), 20, 4.0, GridLevel::Coarse);
        let grid = grid.expect("a usable grid");
        let whole = grid.unrolled();
        let axial = AxialBasis::new(&[-2e-3, 3e-3], 3);
        let size = 3 * axial.len();
        // The stiffness under the orders couples even motions and odd ones.
        let hub: Vec<Mat<c64>> = (0..=largest)
            .map(|order| {
                let off = |i: usize, j: usize| c64::new(0.01 * (i + j + order) as f64, 0.0);
                let own = |i, j| {
                    if i == j {
                        c64::new(5.0, 0.0)
                    } else {
                        c64::new(0.0, 0.0)
                    }
                };
                Mat::from_fn(size, size, |i, j| (off(i, j) + own(i, j)) * 1e10)
            })
            .collect();
        let run = Run::unattended();
        for hub in [None, Some(hub.as_slice())] {
            let rings = [&grid, &whole].map(|grid| {
                let prism = Prism {
                    grid: &grid.grid,
                    material: &Material::STEEL,
                    twist: 0.0,
                    axial: &axial,
                };
                HoledRing::new(grid, &prism, hub, (largest, &[]), &run).expect("sound")
            });
            let [sectors, as_one] = rings.each_ref().map(|ring| ring.on_outer(phase, &run));
            let [sectors, as_one] =
                [sectors, as_one].map(|of| on_all(&of.expect("sound"), size, largest));
            assert!((&sectors - &as_one).norm_max() < 1e-9 * sectors.norm_max());

            let amplitudes: Vec<Mat<c64>> = (0..=largest)
                .map(|order| {
                    let real = |i: usize| ((3 * i + order) as f64).sin();
                    let imaginary = |i: usize| if order == 0 { 0.0 } else { real(i + 7) };
                    Mat::from_fn(size, 1, |i, _| c64::new(real(i), imaginary(i)) * 1e-6)
                })
                .collect();
            let [sectors, as_one] = rings.map(|ring| {
                let moved = ring.moved(phase, &amplitudes, &run).expect("sound");
                let outer = |of: &Vec<f64>, nodes: usize| of[of.len() - nodes * size..].to_vec();
                // The last node of the arc of a sector is the next one's first.
                let nodes = ring.angles.last().map_or(0, Vec::len);
                let sectors = moved.sectors.iter().flat_map(|of| {
                    let last = usize::from(ring.sector.count > 1);
                    outer(of, nodes)[..(nodes - last) * size].to_vec()
                });
                (sectors.collect::<Vec<f64>>(), moved.hub)
            });
            assert_eq!(sectors.0.len(), as_one.0.len());
            for (one, other) in sectors.0.iter().zip(&as_one.0) {
                assert!((one - other).abs() < 1e-14);
            }
            assert_eq!(sectors.1.is_some(), as_one.1.is_some());
            let hubs = sectors.1.iter().flatten().zip(as_one.1.iter().flatten());
            for (one, other) in hubs {
                assert!((one - other).norm_max() < 1e-9 * 1e-6);
            }
        }
    }
}
