//! A whole gear with an extent along its axis: Z teeth on what carries them.

use faer::{Mat, c64};
use rayon::prelude::*;

use super::revolution::add_block;
use super::sector::SolidSector;
use super::tooth::SolidTooth;
use super::web::of_order;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::run::Run;

/// What the loads on the flank of tooth 0 do to the flanks of all, and to the interface circle, class by class.
#[derive(Debug)]
pub struct ClassAnswers {
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

/// The answers of all classes 0 … Z/2 of a ring of teeth on `carriers`, the stiffness of each order 0 … M.
///
/// The answers on the circle are given for the orders up to `wanted` only, in the order of `orders`.
///
/// # Errors
///
/// [`FemError`], or [`FemError::Stopped`].
pub fn answers(
    tooth: &SolidTooth,
    carriers: &[Mat<c64>],
    wanted: Option<usize>,
    run: &Run,
) -> Result<Vec<ClassAnswers>, FemError> {
    let sector = &tooth.sector;
    let largest = carriers.len() - 1;
    (0..=sector.count / 2)
        .into_par_iter()
        .map(|class| {
            run.check()?;
            let orders = sector.orders(class, largest);
            let sides = sector.size * sector.side_nodes;
            let mut stiffness = sector.class_stiffness(class, &orders);
            for (k, &order) in orders.iter().enumerate() {
                let share = faer::Scale(c64::new(1.0 / sector.count as f64, 0.0));
                let share = of_order(carriers, order) * share;
                add_block(&mut stiffness, sides + k * sector.size, &share);
            }
            let unknowns = stiffness.nrows();
            let factor = Cholesky::new(stiffness).ok_or(FemError::NotPositiveDefinite {
                part: "the ring of teeth",
                unknowns,
            })?;
            let mut half = sector
                .on_class(&tooth.rows, class, &orders)
                .adjoint()
                .to_owned();
            factor.half_solve_in_place(half.as_mut());
            let flank = half.adjoint() * &half;
            let kept: Vec<usize> = orders
                .iter()
                .enumerate()
                .filter(|(_, n)| wanted.is_some_and(|most| n.unsigned_abs() as usize <= most))
                .map(|(k, _)| k)
                .collect();
            let size = sector.size;
            let mut unit = Mat::<c64>::zeros(unknowns, kept.len() * size);
            for (place, k) in kept.iter().enumerate() {
                for c in 0..size {
                    unit[(sides + k * size + c, place * size + c)] = c64::new(1.0, 0.0);
                }
            }
            factor.half_solve_in_place(unit.as_mut());
            Ok(ClassAnswers {
                class,
                orders: kept.iter().map(|k| orders[*k]).collect(),
                circle: unit.adjoint() * &half,
                compliance: unit.adjoint() * &unit,
                flank,
            })
        })
        .collect()
}

/// The sum over all classes of `of` turned by their share of `distance` teeth, over Z: the block between the tooth `distance`
/// places counter-clockwise of another, and that one.
pub fn between_teeth<'a>(
    classes: impl Iterator<Item = (usize, &'a Mat<c64>)>,
    tooth_count: usize,
    distance: usize,
) -> Mat<f64> {
    let mut sum: Option<Mat<f64>> = None;
    for (class, of) in classes {
        let own_conjugate = (2 * class).is_multiple_of(tooth_count);
        let weight = if own_conjugate { 1.0 } else { 2.0 } / tooth_count as f64;
        let place = (class * distance) % tooth_count;
        let angle = std::f64::consts::TAU * place as f64 / tooth_count as f64;
        let turn = SolidSector::turn(1, angle) * weight;
        let sum = sum.get_or_insert_with(|| Mat::zeros(of.nrows(), of.ncols()));
        for j in 0..of.ncols() {
            for i in 0..of.nrows() {
                sum[(i, j)] += (turn * of[(i, j)]).re;
            }
        }
    }
    sum.unwrap_or_else(|| Mat::zeros(0, 0))
}
