//! A whole gear: its ring of teeth on its blank.

use faer::Mat;
use rayon::prelude::*;

use super::axes::tooth_angle;
use super::motion::InterfaceMotion;
use super::plain::beside;
use super::teeth::TeethRing;
use crate::fem::FemError;
use crate::fem::dense::{Cholesky, entries};
use crate::run::Run;

/// Rows of X that one thread makes together, so that it passes the factor once for all of their teeth; the last teeth's
/// neighbors come on top.
const ROWS_AT_ONCE: usize = 16;

/// Compliance between the loaded teeth of one gear: the blocks X_ij of H_ij = δ_ij H_0 + V X_ij Vᵀ.
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

    /// Teeth on the blank of the gear whose interface circle moves by `motion`. Teeth up to `farthest` apart are coupled.
    ///
    /// With C the compliance of the circle, X_ij adds F_iᵀ C F_j. A gear of Z teeth that repeats itself g times has Z/g different rows.
    ///
    /// # Errors
    ///
    /// [`FemError::Stopped`].
    pub fn new(motion: &InterfaceMotion<'_>, farthest: usize, run: &Run) -> Result<Self, FemError> {
        let InterfaceMotion { ring, plain, holed } = motion;
        let (row_length, patterns) = (row_length(ring, farthest), ring.force_patterns.ncols());
        // Orders that see no hole.
        let mut equal = Mat::<f64>::zeros(patterns, row_length * patterns);
        let seen = holed.as_ref().map(|holed| holed.seen);
        let mut forces = Mat::zeros(seen.map_or(0, |seen| seen.unknowns()), patterns);
        for set in &plain.sets {
            run.check()?;
            let halves = set.halves_of_teeth(ring, row_length);
            let above = seen.map_or(set.unknowns.len(), |seen| set.above(seen));
            let of_above = halves.subrows(0, above);
            equal += of_above.subcols(0, patterns).transpose() * of_above;
            if let Some(holed) = holed {
                holed.add_left(&mut forces, set, halves.subcols(0, patterns));
            }
        }
        let repeats = holed
            .as_ref()
            .map_or(ring.tooth_count, |holed| holed.repeats);
        let distances = (0..ring.tooth_count / repeats).flat_map(|_| 0..row_length);
        let block = |d: usize| equal.subcols(d * patterns, patterns).to_owned();
        let mut blocks: Vec<Mat<f64>> = distances.map(block).collect();
        if let Some(holed) = holed {
            for (orders, factor) in &holed.sets {
                let of_tooth = |tooth: usize| {
                    let angle = tooth_angle(tooth % ring.tooth_count, ring.tooth_count);
                    holed.seen.rows_at(&forces, angle, orders)
                };
                add_answers(&mut blocks, row_length, &of_tooth, factor, run)?;
            }
        }
        let shares = &ring.pattern_shares;
        blocks.par_iter_mut().enumerate().for_each(|(i, block)| {
            let held = &ring.held_coupling[i % row_length];
            *block = held + shares.transpose() * &*block * shares;
        });
        Ok(Self {
            tooth_count: ring.tooth_count,
            row_length,
            blocks,
        })
    }

    /// The coupling of an axisymmetric gear: each block is the mean over the teeth.
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

/// Adds G_iᵀ C G_j on the orders whose stiffness C⁻¹ is factorized in `ring` to the `blocks` of every row; `of_tooth` is G of a tooth on them.
///
/// With L⁻¹ G of both teeth the inside is one plain product.
fn add_answers(
    blocks: &mut [Mat<f64>],
    row_length: usize,
    of_tooth: &(dyn Fn(usize) -> Mat<f64> + Sync),
    ring: &Cholesky<f64>,
    run: &Run,
) -> Result<(), FemError> {
    blocks
        .par_chunks_mut(ROWS_AT_ONCE * row_length)
        .enumerate()
        .try_for_each(|(chunk, blocks)| {
            run.check()?;
            let (first, rows) = (chunk * ROWS_AT_ONCE, blocks.len() / row_length);
            // L⁻¹ G of the teeth of these rows and of the neighbors of the last.
            let count = rows + row_length - 1;
            let of_teeth = (0..count).map(|tooth| of_tooth(first + tooth));
            let mut halves = beside(of_teeth);
            ring.half_solve_in_place(halves.as_mut());
            let r = halves.ncols() / count;
            for (row, blocks) in blocks.chunks_exact_mut(row_length).enumerate() {
                let one = halves.subcols(row * r, r);
                let answers = one.transpose() * halves.subcols(row * r, row_length * r);
                for (d, block) in blocks.iter_mut().enumerate() {
                    *block += answers.subcols(d * r, r);
                }
            }
            Ok(())
        })
}

/// Blocks in a row of X where teeth up to `farthest` apart are coupled.
fn row_length(teeth: &TeethRing, farthest: usize) -> usize {
    (farthest + 1).min(teeth.held_coupling.len())
}
