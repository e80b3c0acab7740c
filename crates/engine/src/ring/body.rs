//! A whole gear: its ring of teeth on its blank.

use faer::Mat;
use rayon::prelude::*;

use super::axes::tooth_angle;
use super::blank::BlankSubstructure;
use super::teeth::TeethRing;
use crate::fem::FemError;
use crate::fem::dense::{Cholesky, entries};
use crate::gear::gcd;
use crate::run::Run;

/// Rows of X that one thread makes together, so that it passes the factor once for all of their teeth; the last teeth's
/// neighbors come on top.
const ROWS_AT_ONCE: usize = 16;

/// How the loaded teeth of one gear move each other: the blocks X_ij of H_ij = δ_ij H_0 + V X_ij Vᵀ.
///
/// A gear whose teeth and holes repeat together repeats its rows of X with them, and keeps one period of rows. Teeth are coupled
/// as far apart as may be loaded together.
#[derive(Debug, Clone)]
pub struct Coupling {
    tooth_count: usize,
    /// Blocks in a row: a tooth with itself and with those after it.
    row_length: usize,
    /// X between tooth i and tooth i + d, at i row_length + d, for the teeth of one period.
    blocks: Vec<Mat<f64>>,
}

impl Coupling {
    /// Teeth on a rigid blank: the interface circle is held (paper: wh). Teeth up to `farthest` apart are coupled.
    pub fn on_rigid_blank(teeth: &TeethRing, farthest: usize) -> Self {
        let row_length = row_length(teeth, farthest);
        Self {
            tooth_count: teeth.tooth_count,
            row_length,
            blocks: teeth.held_coupling[..row_length].to_vec(),
        }
    }

    /// Teeth on a flexible blank whose hole 0 stands at the angle `hole_angle`. Teeth up to `farthest` apart are coupled.
    ///
    /// C = (S_blank + S_teeth)⁻¹ on the harmonics of the interface circle, and X_ij adds F_iᵀ C F_j. With Z teeth and a
    /// blank of N equal sectors the gear repeats g = gcd(Z, N) times: only orders that differ by a multiple of g meet in C,
    /// and the rows of Z/g teeth say everything.
    ///
    /// # Errors
    ///
    /// [`FemError::NotPositiveDefinite`], or [`FemError::Stopped`].
    pub fn on_blank(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        hole_angle: f64,
        farthest: usize,
        run: &Run,
    ) -> Result<Self, FemError> {
        let repeats = gcd(teeth.tooth_count as u32, blank.sector_count as u32);
        Self::repeating(teeth, blank, hole_angle, repeats as usize, farthest, run)
    }

    /// As [`Coupling::on_blank`], with every tooth's own row and nothing taken from symmetry: an oracle for tests.
    ///
    /// # Errors
    ///
    /// As [`Coupling::on_blank`].
    pub fn tooth_by_tooth(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        hole_angle: f64,
        farthest: usize,
        run: &Run,
    ) -> Result<Self, FemError> {
        Self::repeating(teeth, blank, hole_angle, 1, farthest, run)
    }

    fn repeating(
        teeth: &TeethRing,
        blank: &BlankSubstructure,
        hole_angle: f64,
        repeats: usize,
        farthest: usize,
        run: &Run,
    ) -> Result<Self, FemError> {
        let rows = teeth.tooth_count / repeats;
        let row_length = row_length(teeth, farthest);
        let stiffness = blank.stiffness_at(hole_angle);
        let mut blocks: Vec<Mat<f64>> = (0..rows)
            .flat_map(|_| teeth.held_coupling[..row_length].iter().cloned())
            .collect();
        for orders in teeth.harmonics.meeting_orders(repeats) {
            let unknowns = teeth.harmonics.unknowns_of(&orders);
            let total = Mat::from_fn(unknowns.len(), unknowns.len(), |i, j| {
                let at = (unknowns[i], unknowns[j]);
                teeth.stiffness[at] + stiffness[at]
            });
            let ring = Cholesky::new_watched(total, run)?.ok_or(FemError::NotPositiveDefinite {
                part: "the gear's interface",
                unknowns: unknowns.len(),
            })?;
            add_answers(&mut blocks, row_length, teeth, &orders, &ring, run)?;
        }
        Ok(Self {
            tooth_count: teeth.tooth_count,
            row_length,
            blocks,
        })
    }

    /// The coupling of a gear that is alike all around: each block the mean over the teeth.
    pub fn round_average(&self) -> Self {
        let share = faer::Scale(1.0 / self.rows() as f64);
        let means = (0..self.row_length).map(|d| {
            let zeros = Mat::zeros(self.blocks[d].nrows(), self.blocks[d].ncols());
            let rows = self.blocks.iter().skip(d).step_by(self.row_length);
            rows.fold(zeros, |sum, block| sum + block) * share
        });
        Self {
            tooth_count: self.tooth_count,
            row_length: self.row_length,
            blocks: means.collect(),
        }
    }

    /// The teeth of one period.
    fn rows(&self) -> usize {
        self.blocks.len() / self.row_length
    }

    /// The first tooth whose row of X is that of `tooth`.
    pub fn like(&self, tooth: usize) -> usize {
        tooth % self.rows()
    }

    /// How far apart, in teeth, coupled teeth stand at most.
    pub fn farthest(&self) -> usize {
        self.row_length - 1
    }

    /// The number r of shapes in which an interface shows at its flank: the size of a block.
    pub fn shape_count(&self) -> usize {
        self.blocks[0].nrows()
    }

    /// This coupling and a `share` of the way to `other`.
    #[cfg(test)]
    pub(crate) fn mixed(&self, other: &Self, share: f64) -> Self {
        let (ours, theirs) = (self.blocks.iter().cycle(), other.blocks.iter().cycle());
        let mix = |(a, b): (&Mat<f64>, &Mat<f64>)| a + faer::Scale(share) * (b - a);
        Self {
            tooth_count: self.tooth_count,
            row_length: self.row_length,
            blocks: ours
                .zip(theirs)
                .map(mix)
                .take(self.tooth_count * self.row_length)
                .collect(),
        }
    }

    /// The number of entries of all blocks, for the size limit of the cache.
    pub fn entries(&self) -> usize {
        self.blocks.iter().map(entries).sum()
    }

    /// X between tooth `i` and the tooth `offset` places counter-clockwise of it, and whether it is to be transposed.
    ///
    /// # Panics
    ///
    /// If the teeth are farther apart than [`Coupling::farthest`].
    pub fn block(&self, i: usize, offset: i64) -> (&Mat<f64>, bool) {
        let distance = offset.unsigned_abs() as usize;
        assert!(
            distance < self.row_length,
            "teeth {distance} apart are not coupled"
        );
        let first = if offset >= 0 {
            i
        } else {
            i + self.tooth_count - distance % self.tooth_count
        };
        (
            &self.blocks[self.like(first) * self.row_length + distance],
            offset < 0,
        )
    }
}

/// Adds F_iᵀ C F_j on `orders`, whose stiffness C⁻¹ is factorized in `ring`, to the `blocks` of every row.
///
/// F_i = G_i W, and with L⁻¹ G of both teeth the inside is one plain product.
fn add_answers(
    blocks: &mut [Mat<f64>],
    row_length: usize,
    teeth: &TeethRing,
    orders: &[usize],
    ring: &Cholesky<f64>,
    run: &Run,
) -> Result<(), FemError> {
    let (z, r) = (teeth.tooth_count, teeth.force_patterns.ncols());
    let unknowns = teeth.harmonics.unknowns_of(orders).len();
    blocks
        .par_chunks_mut(ROWS_AT_ONCE * row_length)
        .enumerate()
        .try_for_each(|(chunk, blocks)| {
            run.check()?;
            let (first, rows) = (chunk * ROWS_AT_ONCE, blocks.len() / row_length);
            // L⁻¹ G of the teeth of these rows and of the neighbors of the last.
            let count = rows + row_length - 1;
            let mut halves = Mat::<f64>::zeros(unknowns, count * r);
            for tooth in 0..count {
                let angle = tooth_angle((first + tooth) % z, z);
                let patterns = teeth.patterns_of_tooth_at(angle, orders);
                halves.subcols_mut(tooth * r, r).copy_from(patterns);
            }
            ring.half_solve_in_place(halves.as_mut());
            for (row, blocks) in blocks.chunks_exact_mut(row_length).enumerate() {
                let one = halves.subcols(row * r, r);
                let answers = one.transpose() * halves.subcols(row * r, row_length * r);
                for (d, block) in blocks.iter_mut().enumerate() {
                    let answer = answers.subcols(d * r, r);
                    *block += teeth.pattern_shares.transpose() * answer * &teeth.pattern_shares;
                }
            }
            Ok(())
        })
}

/// Blocks in a row of X where teeth up to `farthest` apart are coupled.
fn row_length(teeth: &TeethRing, farthest: usize) -> usize {
    (farthest + 1).min(teeth.held_coupling.len())
}
