//! A gear without holes on its interface circle: one factor for whatever holes its blank has.

use faer::Mat;

use super::axes::tooth_angle;
use super::blank::BlankSubstructure;
use super::cyclic::Harmonics;
use super::teeth::TeethRing;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::run::Run;

/// A gear without holes: the stiffness of its interface circle, factorized.
///
/// Its teeth are equal, so that only orders meet whose sum or difference is a multiple of Z. The factor L eliminates the highest of them first. The last rows and
/// columns of L, those of the orders up to any n, are then the factor of the stiffness that is left when all orders above n are eliminated. Holes that
/// are seen up to the order n change only that.
#[derive(Debug)]
pub struct PlainGear {
    /// Nodes of the grid of its blank.
    pub(crate) blank_nodes: usize,
    /// The orders in sets that meet.
    pub(super) sets: Vec<MeetingOrders>,
}

/// Orders that meet in a gear whose teeth are equal.
#[derive(Debug)]
pub(super) struct MeetingOrders {
    /// The highest first.
    orders: Vec<usize>,
    /// The unknowns of these orders.
    pub(super) unknowns: Vec<usize>,
    /// L.
    factor: Cholesky<f64>,
    /// Stiffness of the blank.
    blank: Mat<f64>,
}

impl PlainGear {
    /// Joins `teeth` with a `blank` that has no holes.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn new(teeth: &TeethRing, blank: &BlankSubstructure, run: &Run) -> Result<Self, FemError> {
        let set = |mut orders: Vec<usize>| {
            run.check()?;
            orders.reverse();
            let unknowns = teeth.harmonics.unknowns_of(&orders);
            let of = |stiffness: &Mat<f64>| {
                Mat::from_fn(unknowns.len(), unknowns.len(), |i, j| {
                    stiffness[(unknowns[i], unknowns[j])]
                })
            };
            let blank = of(&blank.stiffness);
            let factor = Cholesky::new(of(&teeth.stiffness) + &blank).ok_or(
                FemError::NotPositiveDefinite {
                    part: "the rim",
                    unknowns: unknowns.len(),
                },
            )?;
            Ok(MeetingOrders {
                orders,
                unknowns,
                factor,
                blank,
            })
        };
        let sets = teeth.harmonics.meeting_orders(teeth.tooth_count);
        let sets = sets.into_iter().map(set).collect::<Result<_, FemError>>()?;
        Ok(Self {
            blank_nodes: blank.grid_nodes,
            sets,
        })
    }

    /// The number of entries, for the size limit of the cache.
    pub fn entries(&self) -> usize {
        let factors = self.sets.iter().map(|set| set.unknowns.len().pow(2));
        2 * factors.sum::<usize>()
    }
}

impl MeetingOrders {
    /// The number of their unknowns that lie above the orders of `seen`: the first ones.
    pub(super) fn above(&self, seen: Harmonics) -> usize {
        let below = seen.unknowns();
        self.unknowns.partition_point(|unknown| *unknown >= below)
    }

    /// The factor of the stiffness that is left when the first `above` unknowns are eliminated.
    pub(super) fn left(&self, above: usize) -> Mat<f64> {
        let rest = self.unknowns.len() - above;
        self.factor
            .lower()
            .submatrix(above, above, rest, rest)
            .to_owned()
    }

    /// The stiffness that is left without that of the blank, when the first `above` unknowns are eliminated.
    pub(super) fn left_by_teeth(&self, above: usize) -> Mat<f64> {
        let (left, rest) = (self.left(above), self.unknowns.len() - above);
        &left * left.transpose() - self.blank.submatrix(above, above, rest, rest)
    }

    /// L⁻¹ f of `forces` on all unknowns of the circle.
    pub(super) fn halves(&self, forces: &Mat<f64>) -> Mat<f64> {
        let mut halves = Mat::from_fn(self.unknowns.len(), forces.ncols(), |i, j| {
            forces[(self.unknowns[i], j)]
        });
        self.factor.half_solve_in_place(halves.as_mut());
        halves
    }

    /// L⁻¹ G of the first `count` teeth of `ring`, one beside the other.
    pub(super) fn halves_of_teeth(&self, ring: &TeethRing, count: usize) -> Mat<f64> {
        let of_teeth = (0..count).map(|tooth| {
            let angle = tooth_angle(tooth, ring.tooth_count);
            ring.patterns_of_tooth_at(angle, &self.orders)
        });
        let mut halves = beside(of_teeth);
        self.factor.half_solve_in_place(halves.as_mut());
        halves
    }

    /// Overwrites `halves`, L⁻¹ f, with how the unknowns move.
    pub(super) fn finish(&self, halves: &mut Mat<f64>) {
        self.factor.other_half_solve_in_place(halves.as_mut());
    }
}

/// Matrices of one size, one beside the other.
pub(super) fn beside(of: impl ExactSizeIterator<Item = Mat<f64>>) -> Mat<f64> {
    let count = of.len();
    let mut all = Mat::zeros(0, 0);
    for (i, one) in of.enumerate() {
        let columns = one.ncols();
        if i == 0 {
            all = Mat::zeros(one.nrows(), count * columns);
        }
        all.subcols_mut(i * columns, columns).copy_from(one);
    }
    all
}
