//! A whole gear: its ring of teeth on its blank.

use faer::Mat;

use super::FemError;
use super::blank::BlankSubstructure;
use super::dense::Cholesky;
use super::tooth::TeethRing;
use crate::run::Run;

/// How far apart, in teeth, two loaded teeth of one gear may stand.
pub const FARTHEST_NEIGHBOR: usize = 4;

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
        let of_tooth =
            (0..=FARTHEST_NEIGHBOR).map(|d| teeth.held_coupling[d % tooth_count].clone());
        Self {
            tooth_count,
            blocks: (0..tooth_count).flat_map(|_| of_tooth.clone()).collect(),
        }
    }

    /// Teeth on a flexible blank whose hole 0 stands at the angle `phase`.
    ///
    /// C = (S_blank + S_teeth)⁻¹ on the harmonics of the interface circle, and X_ij adds F_iᵀ C F_j.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn on_blank(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        phase: f64,
        run: &Run,
    ) -> Result<Self, FemError> {
        let z = teeth.held_coupling.len();
        let unknowns = teeth.harmonics.unknowns();
        let total = &teeth.stiffness + blank.stiffness_at(phase);
        let ring = Cholesky::new_watched(total, run)?.ok_or(FemError::NotPositiveDefinite {
            part: "the gear's interface",
            unknowns,
        })?;
        // With L⁻¹ F of both teeth, a block is one plain product. Only neighbors are needed at a time, and the first few
        // once more at the end, where the circle closes.
        let mut halves: Vec<Option<Mat<f64>>> = vec![None; z];
        let mut blocks = Vec::with_capacity(z * (FARTHEST_NEIGHBOR + 1));
        for i in 0..z {
            run.check()?;
            for d in 0..=FARTHEST_NEIGHBOR {
                let j = (i + d) % z;
                for tooth in [i, j] {
                    if halves[tooth].is_none() {
                        let mut half = teeth.forces_of_tooth_at(tooth_angle(tooth, z));
                        ring.half_solve_in_place(half.as_mut());
                        halves[tooth] = Some(half);
                    }
                }
                let (Some(one), Some(other)) = (&halves[i], &halves[j]) else {
                    unreachable!("both halves were just made")
                };
                blocks.push(&teeth.held_coupling[d % z] + one.transpose() * other);
            }
            if i >= FARTHEST_NEIGHBOR {
                halves[i] = None;
            }
        }
        Ok(Self {
            tooth_count: z,
            blocks,
        })
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

/// The angle of tooth `i` of `z` in the gear's frame.
pub fn tooth_angle(i: usize, z: usize) -> f64 {
    2.0 * std::f64::consts::PI * i as f64 / z as f64
}
