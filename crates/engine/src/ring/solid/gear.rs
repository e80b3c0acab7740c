//! A whole gear with an extent along its axis: Z teeth on their support.

use std::ops::AddAssign as _;

use faer::{Mat, c64};
use rayon::prelude::*;

use super::revolution::add_block;
use super::sector::SolidSector;
use super::tooth::SolidTooth;
use super::web::of_order;
use crate::fem::FemError;
use crate::fem::dense::{Cholesky, product};
use crate::run::Run;

/// Response of the flanks of all teeth, and of the interface circle, to loads on the flank of tooth 0, class by class.
#[derive(Debug)]
pub(crate) struct ClassAnswers {
    /// The class k of each.
    pub class: usize,
    /// The orders of the class on the interface circle.
    pub orders: Vec<i64>,
    /// X_k: the answer of the flank's normal displacements to their own loads.
    pub flank: Mat<c64>,
    /// The answer of the interface circle to loads on the flank, order by order.
    pub circle: Mat<c64>,
    /// The compliance of the interface circle.
    pub compliance: Mat<c64>,
}

/// The answers of all classes 0 … Z/2 of a ring of teeth to loads on functions over the flank of tooth 0.
///
/// Each tooth is the `sector` on its interface, and stands on `below`, the stiffness of each order 0 … M. `rows` are the normal displacements of the functions by
/// those of the interface.
///
/// The answers on the circle are given for the orders up to `wanted` only, in the order of `orders`.
///
/// # Errors
///
/// [`FemError`], or [`FemError::Stopped`].
pub(crate) fn answers(
    sector: &SolidSector,
    rows: &Mat<f64>,
    below: &[Mat<c64>],
    wanted: Option<usize>,
    run: &Run,
) -> Result<Vec<ClassAnswers>, FemError> {
    each_class(sector, rows, below, run, |ring, mut half| {
        ring.factor.half_solve_in_place(half.as_mut());
        let units = ring.units(sector, wanted);
        let below = half.subrows(units.first, units.half.nrows());
        ClassAnswers {
            class: ring.class,
            circle: units.half.adjoint() * below,
            compliance: product(units.half.as_ref()),
            flank: product(half.as_ref()),
            orders: units.orders,
        }
    })
}

/// Result of `of` for each class 0 … Z/2 of a ring of teeth on `below`, with unit forces on the functions of `rows` over the flank of tooth 0.
fn each_class<T: Send>(
    sector: &SolidSector,
    rows: &Mat<f64>,
    below: &[Mat<c64>],
    run: &Run,
    of: impl Fn(ClassOfRing, Mat<c64>) -> T + Sync,
) -> Result<Vec<T>, FemError> {
    (0..=sector.count / 2)
        .into_par_iter()
        .map(|class| {
            run.check()?;
            let ring = ClassOfRing::new(sector, below, class)?;
            let rows = sector.on_class(rows, class, &ring.orders);
            Ok(of(ring, rows.adjoint().to_owned()))
        })
        .collect()
}

/// One class of a ring of teeth on their support.
struct ClassOfRing {
    class: usize,
    /// The orders of the class on the interface circle.
    orders: Vec<i64>,
    /// Its stiffness on the unknowns of the class.
    factor: Cholesky<c64>,
    unknowns: usize,
}

impl ClassOfRing {
    fn new(sector: &SolidSector, below: &[Mat<c64>], class: usize) -> Result<Self, FemError> {
        let orders = sector.orders(class, below.len() - 1);
        let sides = sector.size * sector.side_nodes;
        let mut stiffness = sector.class_stiffness(class, &orders);
        for (k, &order) in orders.iter().enumerate() {
            let share = faer::Scale(c64::new(1.0 / sector.count as f64, 0.0));
            let share = of_order(below, order) * share;
            add_block(&mut stiffness, sides + k * sector.size, &share);
        }
        let unknowns = stiffness.nrows();
        let factor = Cholesky::new(stiffness).ok_or(FemError::NotPositiveDefinite {
            part: "the ring of teeth",
            unknowns,
        })?;
        Ok(Self {
            class,
            orders,
            factor,
            unknowns,
        })
    }

    /// Unit forces on the orders up to `wanted` of the interface circle.
    fn units(&self, sector: &SolidSector, wanted: Option<usize>) -> Units {
        let (size, sides) = (sector.size, sector.size * sector.side_nodes);
        let is_wanted = |n: &i64| wanted.is_some_and(|most| n.unsigned_abs() as usize <= most);
        let kept: Vec<usize> = (0..self.orders.len())
            .filter(|k| is_wanted(&self.orders[*k]))
            .collect();
        let first = kept.first().map_or(self.unknowns, |k| sides + k * size);
        let mut half = Mat::<c64>::zeros(self.unknowns - first, kept.len() * size);
        for (place, k) in kept.iter().enumerate() {
            for c in 0..size {
                half[(sides + k * size + c - first, place * size + c)] = c64::new(1.0, 0.0);
            }
        }
        self.factor.half_solve_from(first, half.as_mut());
        Units {
            orders: kept.iter().map(|k| self.orders[*k]).collect(),
            first,
            half,
        }
    }
}

/// Unit forces on orders of the interface circle.
struct Units {
    orders: Vec<i64>,
    /// The first unknown of the class on which they act.
    first: usize,
    /// Their products with the inverse of the factor, from that unknown on: all above vanishes.
    half: Mat<c64>,
}

/// Motion of the interfaces of all teeth in one class.
#[derive(Debug)]
pub(crate) struct ClassMotion {
    /// The class k.
    pub class: usize,
    /// Its orders on the interface circle.
    pub orders: Vec<i64>,
    /// The unknowns of the class under forces on the flank of tooth 0, a column for each.
    pub by_flank: Mat<c64>,
    /// Values of the wanted orders.
    pub wanted: Vec<i64>,
    /// The unknowns under forces on these, order by order.
    pub by_circle: Mat<c64>,
}

/// How the interfaces of a ring of teeth on `below` move, class by class, under forces on the flank of tooth 0 and on the orders up to
/// `wanted` of the interface circle.
///
/// # Errors
///
/// As [`answers`].
pub(crate) fn motions(
    tooth: &SolidTooth,
    below: &[Mat<c64>],
    wanted: Option<usize>,
    run: &Run,
) -> Result<Vec<ClassMotion>, FemError> {
    each_class(
        &tooth.sector,
        &tooth.rows,
        below,
        run,
        |ring, mut by_flank| {
            ring.factor.solve_in_place(by_flank.as_mut());
            let Units {
                orders: wanted,
                first,
                half,
            } = ring.units(&tooth.sector, wanted);
            let mut by_circle = Mat::zeros(ring.unknowns, half.ncols());
            by_circle.subrows_mut(first, half.nrows()).copy_from(&half);
            ring.factor.other_half_solve_in_place(by_circle.as_mut());
            ClassMotion {
                class: ring.class,
                orders: ring.orders,
                by_flank,
                wanted,
                by_circle,
            }
        },
    )
}

/// Motion of the interfaces of all teeth in one class under given forces.
#[derive(Debug)]
pub(crate) struct ForcedClass {
    /// The class k.
    pub class: usize,
    /// Its orders on the interface circle.
    pub orders: Vec<i64>,
    /// The unknowns of the class.
    pub motion: Mat<c64>,
}

/// How the interfaces of a ring of teeth on `below` move, class by class, under forces on the flank of each class and on the orders of the
/// interface circle.
///
/// # Errors
///
/// As [`answers`].
pub(crate) fn forced(
    tooth: &SolidTooth,
    below: &[Mat<c64>],
    (on_flank, on_order): (
        impl Fn(usize) -> Mat<c64> + Sync,
        impl Fn(i64) -> Option<Mat<c64>> + Sync,
    ),
    run: &Run,
) -> Result<Vec<ForcedClass>, FemError> {
    let (size, sides) = (
        tooth.sector.size,
        tooth.sector.size * tooth.sector.side_nodes,
    );
    each_class(&tooth.sector, &tooth.rows, below, run, |ring, by_flank| {
        let mut motion = by_flank * on_flank(ring.class);
        for (k, &order) in ring.orders.iter().enumerate() {
            if let Some(force) = on_order(order) {
                motion
                    .subrows_mut(sides + k * size, size)
                    .add_assign(&force);
            }
        }
        ring.factor.solve_in_place(motion.as_mut());
        ForcedClass {
            class: ring.class,
            orders: ring.orders,
            motion,
        }
    })
}

/// Motion of the interfaces of the teeth at each of `distances` counter-clockwise of tooth 0, from that of each class: its number, its orders and its unknowns.
pub(crate) fn interfaces<'a>(
    sector: &SolidSector,
    classes: impl Iterator<Item = (usize, &'a [i64], &'a Mat<c64>)>,
    distances: &[usize],
) -> Vec<Mat<f64>> {
    let mut sums = vec![Mat::zeros(0, 0); distances.len()];
    for (class, orders, motion) in classes {
        let moved = sector.off_class(motion, class, orders);
        for (sum, distance) in sums.iter_mut().zip(distances) {
            if sum.nrows() == 0 {
                *sum = Mat::zeros(moved.nrows(), moved.ncols());
            }
            add_class(sum, (class, &moved), sector.count, *distance);
        }
    }
    sums
}

/// The sum over all classes of `of` turned by their share of `distance` teeth, over Z: the block between the tooth `distance`
/// places counter-clockwise of another, and that one.
pub(crate) fn between_teeth<'a>(
    classes: impl Iterator<Item = (usize, &'a Mat<c64>)>,
    tooth_count: usize,
    distance: usize,
) -> Mat<f64> {
    let mut sum = Mat::zeros(0, 0);
    for (class, of) in classes {
        if sum.nrows() == 0 {
            sum = Mat::zeros(of.nrows(), of.ncols());
        }
        add_class(&mut sum, (class, of), tooth_count, distance);
    }
    sum
}

fn add_class(
    sum: &mut Mat<f64>,
    (class, of): (usize, &Mat<c64>),
    tooth_count: usize,
    distance: usize,
) {
    let turn = SolidSector::part(class, distance, tooth_count) * (1.0 / tooth_count as f64);
    for j in 0..of.ncols() {
        for (sum, of) in sum.col_as_slice_mut(j).iter_mut().zip(of.col_as_slice(j)) {
            *sum += (turn * *of).re;
        }
    }
}
