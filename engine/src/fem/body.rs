//! A whole gear: its ring of teeth on its blank.

use std::collections::VecDeque;
use std::ops::Range;

use faer::Mat;

use super::FemError;
use super::blank::BlankSubstructure;
use super::dense::Cholesky;
use super::tooth::TeethRing;
use crate::run::Run;

/// How far apart, in teeth, two loaded teeth of one gear may stand.
pub const FARTHEST_NEIGHBOR: usize = 4;

/// Teeth whose forces go through the ring's factor together: the wider the block, the less often the factor is read, and
/// the longer a stop waits. At least [`FARTHEST_NEIGHBOR`].
const TEETH_AT_ONCE: usize = 4;

/// How the loaded teeth of one gear move each other: the blocks X_ij of H_ij = δ_ij H_0 + V X_ij Vᵀ.
///
/// Every tooth has its own row: nothing here assumes that teeth are alike once the blank has holes.
#[derive(Debug, Clone)]
pub struct Coupling {
    tooth_count: usize,
    /// X between tooth i and tooth i + d, at i (FARTHEST + 1) + d.
    blocks: Vec<Mat<f64>>,
}

impl Coupling {
    /// Teeth on a rigid blank: the interface circle is held (paper: wh).
    pub fn on_rigid_blank(teeth: &TeethRing) -> Self {
        let tooth_count = teeth.held_coupling.len();
        let per_tooth = 0..=FARTHEST_NEIGHBOR;
        let blocks = (0..tooth_count)
            .flat_map(|_| per_tooth.clone())
            .map(|d| teeth.held_coupling[d % tooth_count].clone())
            .collect();
        Self {
            tooth_count,
            blocks,
        }
    }

    /// Teeth on a flexible blank whose hole 0 stands at the angle `phase`.
    ///
    /// C = (S_blank + S_teeth)⁻¹ on the harmonics of the interface circle, and X_ij adds F_iᵀ C F_j.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`]: on hundreds of teeth this is the longest part of a run.
    pub fn on_blank(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        phase: f64,
        run: &Run,
    ) -> Result<Self, FemError> {
        let z = teeth.held_coupling.len();
        let unknowns = teeth.harmonics.unknowns();
        let ring = Cholesky::new(&teeth.stiffness + blank.stiffness_at(phase)).ok_or(
            FemError::NotPositiveDefinite {
                part: "the gear's interface",
                unknowns,
            },
        )?;
        // With L⁻¹ F of every tooth, each block is one plain product. Only neighbors meet in one, so that only they are
        // kept, and the first ones, which are the last ones' neighbors.
        let mut coupling = Self::on_rigid_blank(teeth);
        let mut halves: VecDeque<Mat<f64>> = VecDeque::new();
        let mut first: Vec<Mat<f64>> = Vec::new();
        for j in 0..z + FARTHEST_NEIGHBOR {
            if j < z && j % TEETH_AT_ONCE == 0 {
                run.check()?;
                let batch = j..(j + TEETH_AT_ONCE).min(z);
                halves.extend(half_solved(&ring, teeth, batch));
                if j == 0 {
                    first.extend(halves.iter().take(FARTHEST_NEIGHBOR).cloned());
                }
            } else if j >= z {
                halves.push_back(first[(j - z) % first.len()].clone());
            }
            // The front is tooth j − FARTHEST_NEIGHBOR, or the first one.
            let back = j.min(FARTHEST_NEIGHBOR);
            for d in (0..=back).filter(|d| j - d < z) {
                let block = halves[back - d].transpose() * &halves[back];
                coupling.blocks[(j - d) * (FARTHEST_NEIGHBOR + 1) + d] += block;
            }
            if back == FARTHEST_NEIGHBOR {
                halves.pop_front();
            }
        }
        Ok(coupling)
    }

    /// The coupling of a gear that is alike all around: each block the mean over the teeth.
    pub fn round_average(&self) -> Self {
        let (z, per_tooth) = (self.tooth_count, FARTHEST_NEIGHBOR + 1);
        let means = (0..per_tooth).map(|d| {
            let rows = self.blocks.iter().skip(d).step_by(per_tooth);
            let sum = rows.fold(
                Mat::zeros(self.blocks[d].nrows(), self.blocks[d].ncols()),
                |sum, block| sum + block,
            );
            sum * faer::Scale(1.0 / z as f64)
        });
        let means: Vec<Mat<f64>> = means.collect();
        Self {
            tooth_count: z,
            blocks: (0..z).flat_map(|_| means.iter().cloned()).collect(),
        }
    }

    /// This coupling and a `share` of the way to `other`.
    #[cfg(test)]
    pub(crate) fn mixed(&self, other: &Self, share: f64) -> Self {
        let blocks = self.blocks.iter().zip(&other.blocks);
        let mix = |(a, b): (&Mat<f64>, &Mat<f64>)| a + faer::Scale(share) * (b - a);
        Self {
            tooth_count: self.tooth_count,
            blocks: blocks.map(mix).collect(),
        }
    }

    /// The number of entries of all blocks, for the books of a cache.
    pub fn entries(&self) -> usize {
        self.blocks
            .iter()
            .map(|block| block.nrows() * block.ncols())
            .sum()
    }

    /// X between tooth `i` and the tooth `offset` places counter-clockwise of it, and whether it is to be transposed.
    ///
    /// `None` if the teeth are farther apart than [`FARTHEST_NEIGHBOR`].
    pub fn block(&self, i: usize, offset: i64) -> Option<(&Mat<f64>, bool)> {
        let distance = usize::try_from(offset.unsigned_abs())
            .ok()
            .filter(|&d| d <= FARTHEST_NEIGHBOR)?;
        let (first, transposed) = if offset >= 0 {
            (i, false)
        } else {
            (
                (i + self.tooth_count - distance % self.tooth_count) % self.tooth_count,
                true,
            )
        };
        Some((
            &self.blocks[first * (FARTHEST_NEIGHBOR + 1) + distance],
            transposed,
        ))
    }
}

/// L⁻¹ F of each tooth of `batch`.
fn half_solved(ring: &Cholesky<f64>, teeth: &TeethRing, batch: Range<usize>) -> Vec<Mat<f64>> {
    let z = teeth.held_coupling.len();
    let (n, r) = (teeth.tooth_forces.nrows(), teeth.tooth_forces.ncols());
    let mut together = Mat::zeros(n, batch.len() * r);
    for (place, i) in batch.clone().enumerate() {
        let forces = teeth.forces_of_tooth_at(tooth_angle(i, z));
        together.subcols_mut(place * r, r).copy_from(&forces);
    }
    ring.half_solve_in_place(together.as_mut());
    let own = |place: usize| together.subcols(place * r, r).to_owned();
    (0..batch.len()).map(own).collect()
}

/// The angle of tooth `i` of `z` in the gear's frame.
pub fn tooth_angle(i: usize, z: usize) -> f64 {
    2.0 * std::f64::consts::PI * i as f64 / z as f64
}
