//! The pressures of each pair: its contact in plane strain.
//!
//! A contact is far narrower than its face is wide, so that nothing moves along the face there, for any state of the bodies behind it. Each pair keeps the load
//! P that it has in plane stress, and the compliance of its flanks under the contact is λ times that in plane stress:
//!
//! ```text
//! λ = Σ (1 − ν²)/E / Σ 1/E
//! ```
//!
//! With H λ in place of H, λ H p + g = δ w and wᵀ p = P have the solution p = q/λ of H q + g = δ w and wᵀ q = λ P. So the contact is solved again under λ P. Where
//! the flanks are smooth under it the gap is a parabola, of which the solution is known: the pressures are 1/√λ times those of plane stress, and the contact
//! is √λ times as wide (Hertz).

use std::ops::Range;

use faer::Mat;

use super::cells::{ContactCells, PlacedCells};
use super::patch::Patch;
use super::peak::Peak;
use super::{ContactProblem, ContactSolution, PeakPlace, PositionError};
use crate::gear::{GearPair, Member, PlaneState};

/// Pressure on a pair of teeth of which no sharp corner carries.
pub(super) struct PairPressures {
    /// The largest pressure.
    pub(super) peak: Peak,
    /// The largest at least half the width of the contact away from kinks, in Pa; 0 where there is none.
    pub(super) smooth: f64,
}

/// λ: how flanks of `pair` give way under a contact in plane strain, over how they do in plane stress.
pub(super) fn strain_over_stress(pair: &GearPair) -> f64 {
    let yields = |plane: PlaneState| -> f64 {
        let of = |member: Member| pair.gear(member).material().plane_modulus(plane).recip();
        Member::BOTH.map(of).into_iter().sum()
    };
    yields(PlaneState::Strain) / yields(PlaneState::Stress)
}

impl ContactCells<'_> {
    /// The pressures on the cells `placed` on a pair that carries, those in `range` of the `solution` of their problem.
    ///
    /// # Errors
    ///
    /// [`PositionError::Contact`] if the contact of the pair by itself has no solution.
    pub(super) fn pressed(
        &self,
        placed: &PlacedCells,
        range: &Range<usize>,
        (problem, solution): (&ContactProblem, &ContactSolution),
    ) -> Result<PairPressures, PositionError> {
        let patch = &placed.cells().patch;
        let n = self.at.period + placed.pair;
        let width = self.pair().common_face_width();
        let yields = strain_over_stress(self.pair());
        let active = &solution.active[range.clone()];
        let contacts = patch.contacts(active);
        if contacts
            .iter()
            .all(|contact| patch.is_smooth_under(contact))
        {
            let narrower = yields.sqrt();
            let per_width = 1.0 / (narrower * width);
            let pressures = pressures(patch, &solution.forces[range.clone()], per_width);
            return Ok(patch.pressed(n, &pressures, active, narrower));
        }
        let (alone, load) = alone(range, (problem, solution))?;
        let again = self.solved_from(&alone, yields * load, || Some(active.to_vec()))?;
        let pressures = pressures(patch, &again.forces, 1.0 / (yields * width));
        Ok(patch.pressed(n, &pressures, &again.active, 1.0))
    }
}

/// The contact of the pair whose points are in `range` by itself, with the gaps that the forces on all other pairs leave, and the load that it carries.
fn alone(
    range: &Range<usize>,
    (problem, solution): (&ContactProblem, &ContactSolution),
) -> Result<(ContactProblem, f64), PositionError> {
    let (start, count) = (range.start, range.len());
    let forces = &solution.forces[range.clone()];
    let arms = &problem.arms()[range.clone()];
    let compliance = problem.compliance().submatrix(start, start, count, count);
    let mut gaps = solution.gaps[range.clone()].to_vec();
    for (j, force) in forces.iter().enumerate().filter(|(_, force)| **force > 0.0) {
        for (i, gap) in gaps.iter_mut().enumerate() {
            *gap -= compliance[(i, j)] * force;
        }
    }
    let compliance = Mat::from_fn(count, count, |i, j| compliance[(i, j)]);
    let load = arms.iter().zip(forces).map(|(arm, p)| arm * p).sum();
    Ok((ContactProblem::new(compliance, gaps, arms.to_vec())?, load))
}

/// Pressures of `forces` on the cells of `patch`, where a unit force on a cell of unit width has the pressure `one`.
fn pressures(patch: &Patch, forces: &[f64], one: f64) -> Vec<f64> {
    let cells = patch.cells.iter().zip(forces);
    cells
        .map(|(cell, force)| one * force / cell.width)
        .collect()
}

impl Patch {
    /// Pressure of the pair `n` from the `pressures` on `active` cells, where contacts are `times` as wide as those.
    fn pressed(&self, n: i64, pressures: &[f64], active: &[bool], times: f64) -> PairPressures {
        let each = pressures.iter().copied().enumerate();
        let (i, pressure) = each.fold(
            (0, 0.0),
            |most, next| {
                if next.1 > most.1 { next } else { most }
            },
        );
        let contacts = self.contacts(active);
        let about = contacts.iter().find(|contact| contact.contains(&i));
        PairPressures {
            peak: Peak {
                pressure,
                place: PeakPlace {
                    pair: n,
                    roll_lengths: self.cells[i].roll_lengths,
                    z: None,
                    half_width: about.map_or(0.0, |contact| times * self.half_width(contact)),
                },
            },
            smooth: self.smooth_pressure(pressures, active, times),
        }
    }
}
