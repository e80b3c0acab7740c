//! A whole gear: its ring of teeth on its blank.

use faer::Mat;

use super::FemError;
use super::blank::BlankSubstructure;
use super::dense::Cholesky;
use super::tooth::TeethRing;

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
        Self::new(teeth, |_, _, held| held)
    }

    /// Teeth on a flexible blank whose hole 0 stands at the angle `phase`.
    ///
    /// C = (S_blank + S_teeth)⁻¹ on the harmonics of the interface circle, and X_ij adds F_iᵀ C F_j.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`].
    pub fn on_blank(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        phase: f64,
    ) -> Result<Self, FemError> {
        let z = teeth.held_coupling.len();
        let unknowns = teeth.harmonics.unknowns();
        let ring = Cholesky::new(&teeth.stiffness + blank.stiffness_at(phase)).ok_or(
            FemError::NotPositiveDefinite {
                part: "the gear's interface",
                unknowns,
            },
        )?;
        // With L⁻¹ F of every tooth, each block is one plain product.
        let halves: Vec<Mat<f64>> = (0..z)
            .map(|i| {
                let mut half = teeth.forces_of_tooth_at(tooth_angle(i, z));
                ring.half_solve_in_place(half.as_mut());
                half
            })
            .collect();
        Ok(Self::new(teeth, |i, j, held| {
            held + halves[i].transpose() * &halves[j]
        }))
    }

    fn new(teeth: &TeethRing, block: impl Fn(usize, usize, Mat<f64>) -> Mat<f64>) -> Self {
        let tooth_count = teeth.held_coupling.len();
        let blocks = (0..tooth_count)
            .flat_map(|i| (0..=FARTHEST_NEIGHBOR).map(move |d| (i, d)))
            .map(|(i, d)| {
                block(
                    i,
                    (i + d) % tooth_count,
                    teeth.held_coupling[d % tooth_count].clone(),
                )
            })
            .collect();
        Self {
            tooth_count,
            blocks,
        }
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
