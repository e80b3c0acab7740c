//! How the interface circle of a whole gear moves under loads on its flanks.

use faer::Mat;

use super::axes::tooth_angle;
use super::blank::BlankSubstructure;
use super::teeth::TeethRing;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::run::Run;

/// A gear whose interface circle can be moved: q = C Σ_j F_j m_j.
///
/// Orders that see the blank are solved together; those above them, which find it as the solid one, follow in the groups in
/// which the teeth join them.
pub struct InterfaceMotion<'a> {
    ring: &'a TeethRing,
    /// The ring on the orders that see the blank.
    seen: TeethRing,
    gear: Cholesky<f64>,
    above: Vec<OrdersAbove>,
}

/// Orders that do not see the blank and meet in the ring of teeth.
struct OrdersAbove {
    /// Their places among all unknowns.
    unknowns: Vec<usize>,
    /// The lower orders that they meet with.
    of_low: Vec<usize>,
    coupling: Mat<f64>,
    rim: Cholesky<f64>,
}

impl<'a> InterfaceMotion<'a> {
    /// Joins `ring` with `blank`, whose hole 0 stands at `hole_angle`; `solid` is the blank that the orders above those of `blank`
    /// find, if there are any.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn new(
        ring: &'a TeethRing,
        blank: &BlankSubstructure,
        hole_angle: f64,
        solid: Option<&BlankSubstructure>,
        run: &Run,
    ) -> Result<Self, FemError> {
        let low = blank.harmonics;
        let (seen, above) = match solid {
            None => (ring.clone(), Vec::new()),
            Some(solid) => (
                ring.above(low, solid, run)?,
                orders_above(ring, low.largest, solid)?,
            ),
        };
        let total = &seen.stiffness + blank.stiffness_at(hole_angle);
        let unknowns = total.nrows();
        let gear = Cholesky::new_watched(total, run)?.ok_or(FemError::NotPositiveDefinite {
            part: "the gear's interface",
            unknowns,
        })?;
        Ok(Self {
            ring,
            seen,
            gear,
            above,
        })
    }

    /// The amplitudes of the circle on all orders of the ring of teeth, in meters, under the modal loads of the teeth given by
    /// their numbers.
    pub fn under(&self, modal_loads: &[(usize, Vec<f64>)]) -> Vec<f64> {
        let mut motion = forces(&self.seen, modal_loads);
        self.gear.solve_in_place(motion.as_mut());
        if self.above.is_empty() {
            return motion.col_as_slice(0).to_vec();
        }
        let forces = forces(self.ring, modal_loads);
        self.with_orders_above(motion.col_as_slice(0), |group| {
            Mat::from_fn(group.unknowns.len(), 1, |i, _| {
                forces[(group.unknowns[i], 0)]
            })
        })
    }

    /// The amplitudes of the circle, in meters, under the `forces` on all orders of the ring of teeth.
    pub fn under_forces(&self, forces: &[f64]) -> Vec<f64> {
        let low = self.seen.harmonics.unknowns();
        let mut motion = Mat::from_fn(low, 1, |i, _| forces[i]);
        let of_group = |group: &OrdersAbove| {
            Mat::from_fn(group.unknowns.len(), 1, |i, _| forces[group.unknowns[i]])
        };
        for group in &self.above {
            let mut moved = of_group(group);
            group.rim.solve_in_place(moved.as_mut());
            let passed = group.coupling.transpose() * moved;
            for (i, unknown) in group.of_low.iter().enumerate() {
                motion[(*unknown, 0)] -= passed[(i, 0)];
            }
        }
        self.gear.solve_in_place(motion.as_mut());
        self.with_orders_above(motion.col_as_slice(0), of_group)
    }

    /// The motion of all orders of which `low` is that of the lower ones, under the forces `of_group` on each group above them.
    fn with_orders_above(
        &self,
        low: &[f64],
        of_group: impl Fn(&OrdersAbove) -> Mat<f64>,
    ) -> Vec<f64> {
        let mut all = vec![0.0; self.ring.harmonics.unknowns()];
        all[..low.len()].copy_from_slice(low);
        for group in &self.above {
            let mut moved = of_group(group);
            let of_low = Mat::from_fn(group.of_low.len(), 1, |i, _| all[group.of_low[i]]);
            moved -= &group.coupling * of_low;
            group.rim.solve_in_place(moved.as_mut());
            for (i, unknown) in group.unknowns.iter().enumerate() {
                all[*unknown] = moved[(i, 0)];
            }
        }
        all
    }
}

/// Σ_j F_j m_j on the harmonics of `ring`, order by order.
fn forces(ring: &TeethRing, modal_loads: &[(usize, Vec<f64>)]) -> Mat<f64> {
    let orders: Vec<usize> = (0..=ring.harmonics.largest).collect();
    let mut sum = Mat::zeros(ring.harmonics.unknowns(), 1);
    for (tooth, loads) in modal_loads {
        let loads = Mat::from_fn(loads.len(), 1, |i, _| loads[i]);
        let shares = &ring.pattern_shares * loads;
        let angle = tooth_angle(*tooth, ring.tooth_count);
        sum += ring.forces_of_tooth_at(angle, shares.col_as_slice(0), &orders);
    }
    sum
}

fn orders_above(
    ring: &TeethRing,
    largest: usize,
    solid: &BlankSubstructure,
) -> Result<Vec<OrdersAbove>, FemError> {
    let groups = ring.harmonics.meeting_orders(ring.tooth_count).into_iter();
    let groups = groups.map(|orders| orders.into_iter().partition::<Vec<_>, _>(|n| *n > largest));
    let group = |(orders, low): (Vec<usize>, Vec<usize>)| {
        let (unknowns, of_low) = (
            ring.harmonics.unknowns_of(&orders),
            ring.harmonics.unknowns_of(&low),
        );
        let rim = Mat::from_fn(unknowns.len(), unknowns.len(), |i, j| {
            let at = (unknowns[i], unknowns[j]);
            ring.stiffness[at] + solid.stiffness[at]
        });
        Ok(OrdersAbove {
            coupling: Mat::from_fn(unknowns.len(), of_low.len(), |i, j| {
                ring.stiffness[(unknowns[i], of_low[j])]
            }),
            rim: Cholesky::new(rim).ok_or(FemError::NotPositiveDefinite {
                part: "the rim",
                unknowns: unknowns.len(),
            })?,
            unknowns,
            of_low,
        })
    };
    groups
        .filter(|(orders, _)| !orders.is_empty())
        .map(group)
        .collect()
}
