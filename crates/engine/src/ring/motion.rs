//! Motion of the interface circle of a whole gear under loads on its flanks.

use faer::{Mat, MatRef};

use super::axes::tooth_angle;
use super::blank::BlankSubstructure;
use super::cyclic::Harmonics;
use super::plain::{MeetingOrders, PlainGear};
use super::teeth::TeethRing;
use crate::fem::FemError;
use crate::fem::dense::Cholesky;
use crate::gear::gcd;
use crate::run::Run;

/// A gear whose interface circle can be moved: q = C Σ_j F_j m_j.
///
/// Holes replace the stiffness of the plain blank by that of the holed one on the orders that see them: K_l = L_l L_lᵀ + S_holed − S_plain, where L_l is the
/// factor that the plain gear leaves to them. Orders above follow as they do in the plain gear.
pub struct InterfaceMotion<'a> {
    pub(super) ring: &'a TeethRing,
    pub(super) plain: &'a PlainGear,
    pub(super) holed: Option<HoledOrders>,
}

/// The orders that see holes.
pub(super) struct HoledOrders {
    pub(super) seen: Harmonics,
    /// How often the gear repeats itself around its axis.
    pub(super) repeats: usize,
    /// K_l in sets of orders that meet, factorized.
    pub(super) sets: Vec<(Vec<usize>, Cholesky<f64>)>,
}

impl<'a> InterfaceMotion<'a> {
    /// Joins `plain`, whose teeth are those of `ring`, with another blank, `holed`, whose hole 0 stands at the given angle; `None` for the one that it has.
    ///
    /// With Z teeth and a blank of N equal sectors the gear repeats itself gcd(Z, N) times, and only orders meet whose sum or difference is a multiple of it.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn new(
        ring: &'a TeethRing,
        plain: &'a PlainGear,
        holed: Option<(&BlankSubstructure, f64)>,
        run: &Run,
    ) -> Result<Self, FemError> {
        let holed = holed.map(|(blank, angle)| {
            let repeats = gcd(ring.tooth_count as u32, blank.sector_count as u32);
            HoledOrders::new(plain, (blank, angle), repeats as usize, run)
        });
        Ok(Self {
            ring,
            plain,
            holed: holed.transpose()?,
        })
    }

    /// As [`InterfaceMotion::new`], with nothing taken from symmetry: an oracle for tests.
    ///
    /// # Errors
    ///
    /// As [`InterfaceMotion::new`].
    pub fn tooth_by_tooth(
        ring: &'a TeethRing,
        plain: &'a PlainGear,
        holed: (&BlankSubstructure, f64),
        run: &Run,
    ) -> Result<Self, FemError> {
        Ok(Self {
            ring,
            plain,
            holed: Some(HoledOrders::new(plain, holed, 1, run)?),
        })
    }

    /// The amplitudes of the circle on all orders of the ring of teeth, in meters, under the modal loads of the teeth given by
    /// their numbers.
    pub fn under(&self, modal_loads: &[(usize, Vec<f64>)]) -> Vec<f64> {
        let ring = self.ring;
        let mut forces = Mat::zeros(ring.harmonics.unknowns(), 1);
        for (tooth, loads) in modal_loads {
            let loads = Mat::from_fn(loads.len(), 1, |i, _| loads[i]);
            let shares = &ring.pattern_shares * loads;
            let angle = tooth_angle(*tooth, ring.tooth_count);
            forces += ring.forces_of_tooth_at(angle, shares.col_as_slice(0));
        }
        self.under_forces(forces.col_as_slice(0))
    }

    /// The amplitudes of the circle, in meters, under the `forces` on all orders of the ring of teeth.
    pub fn under_forces(&self, forces: &[f64]) -> Vec<f64> {
        let forces = Mat::from_fn(forces.len(), 1, |i, _| forces[i]);
        let sets = self.plain.sets.iter();
        let mut halves: Vec<_> = sets.map(|set| set.halves(&forces)).collect();
        if let Some(holed) = &self.holed {
            let mut moved = Mat::zeros(holed.seen.unknowns(), 1);
            for (set, half) in self.plain.sets.iter().zip(&halves) {
                holed.add_left(&mut moved, set, half.as_ref());
            }
            for (orders, factor) in &holed.sets {
                let unknowns = holed.seen.unknowns_of(orders);
                let mut of_set = Mat::from_fn(unknowns.len(), 1, |i, _| moved[(unknowns[i], 0)]);
                factor.solve_in_place(of_set.as_mut());
                for (i, unknown) in unknowns.iter().enumerate() {
                    moved[(*unknown, 0)] = of_set[(i, 0)];
                }
            }
            for (set, half) in self.plain.sets.iter().zip(&mut halves) {
                let above = set.above(holed.seen);
                let below = &set.unknowns[above..];
                let of_set = Mat::from_fn(below.len(), 1, |i, _| moved[(below[i], 0)]);
                let rest = set.left(above).transpose() * of_set;
                half.subrows_mut(above, below.len()).copy_from(rest);
            }
        }
        let mut motion = vec![0.0; forces.nrows()];
        for (set, half) in self.plain.sets.iter().zip(&mut halves) {
            set.finish(half);
            for (i, unknown) in set.unknowns.iter().enumerate() {
                motion[*unknown] = half[(i, 0)];
            }
        }
        motion
    }
}

impl HoledOrders {
    fn new(
        plain: &PlainGear,
        (blank, hole_angle): (&BlankSubstructure, f64),
        repeats: usize,
        run: &Run,
    ) -> Result<Self, FemError> {
        let seen = blank.harmonics;
        let mut stiffness = blank.stiffness_at(hole_angle);
        for set in &plain.sets {
            let above = set.above(seen);
            let left = set.left_by_teeth(above);
            let below = &set.unknowns[above..];
            for (j, column) in below.iter().enumerate() {
                for (i, row) in below.iter().enumerate() {
                    stiffness[(*row, *column)] += left[(i, j)];
                }
            }
        }
        let of_set = |orders: Vec<usize>| {
            let unknowns = seen.unknowns_of(&orders);
            let of_set = Mat::from_fn(unknowns.len(), unknowns.len(), |i, j| {
                stiffness[(unknowns[i], unknowns[j])]
            });
            let factor = Cholesky::new_watched(of_set, run)?;
            let factor = factor.ok_or(FemError::NotPositiveDefinite {
                part: "the gear's interface",
                unknowns: unknowns.len(),
            })?;
            Ok::<_, FemError>((orders, factor))
        };
        let sets = seen.meeting_orders(repeats).into_iter().map(of_set);
        Ok(Self {
            seen,
            repeats,
            sets: sets.collect::<Result<_, _>>()?,
        })
    }

    /// Adds to `forces` on the orders that see holes what is left of forces on `set`, of which `halves` is L⁻¹ f, when the orders above are eliminated.
    pub(super) fn add_left(
        &self,
        forces: &mut Mat<f64>,
        set: &MeetingOrders,
        halves: MatRef<'_, f64>,
    ) {
        let above = set.above(self.seen);
        let below = &set.unknowns[above..];
        let left = set.left(above) * halves.subrows(above, below.len());
        for (i, unknown) in below.iter().enumerate() {
            for j in 0..left.ncols() {
                forces[(*unknown, j)] += left[(i, j)];
            }
        }
    }
}
