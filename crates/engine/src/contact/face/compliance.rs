//! The linear part of the compliance between slices: the smooth yield of both gears, and the half space along each line.

use faer::Mat;

use super::FaceModel;
use super::slice::Slice;
use crate::contact::coupled::{LoadedPair, add_coupled, mirror};
use crate::gear::Member;

/// The part of H between slices that all mesh periods have in common, and the data of its smooth part.
pub(super) struct SliceCompliance {
    /// The half space and the ends of the flanks, in m/N; the lower triangle.
    held: Mat<f64>,
    /// The functions over the flank of each gear in the middles of the slices, a column each.
    bases: [Mat<f64>; 2],
    /// The pair of each line, and how many slices it has.
    lines: Vec<(i64, usize)>,
}

impl SliceCompliance {
    /// That of `slices` of `model`.
    pub(super) fn new(model: &FaceModel, slices: &[Slice]) -> Self {
        let mut held = Mat::zeros(slices.len(), slices.len());
        add_half_space(slices, &mut held);
        add_ends(model, slices, &mut held);
        let lines = slices.chunk_by(|one, next| one.pair == next.pair);
        Self {
            held,
            bases: Member::BOTH.map(|member| basis(model, member, slices)),
            lines: lines.map(|line| (line[0].pair, line.len())).collect(),
        }
    }

    /// H without the springs of the slices in m/N, `period` mesh periods on: Φ R Φᵀ of both gears beside the common part.
    pub(super) fn of_teeth(&self, model: &FaceModel, period: i64) -> Mat<f64> {
        let mut h = self.held.clone();
        let (Some((first, _)), Some((last, _))) = (self.lines.first(), self.lines.last()) else {
            return h;
        };
        for member in Member::BOTH {
            let smooth = model.smooth(member, first + period, 1 + (last - first) as usize);
            let basis = &self.bases[member.index()];
            let mut start = 0;
            let lines = self.lines.iter().map(|&(pair, count)| {
                let from = start;
                start += count;
                LoadedPair {
                    pair: pair + period,
                    start: from,
                    shapes: basis.as_ref().subcols(from, count).transpose(),
                }
            });
            let lines: Vec<LoadedPair<'_>> = lines.collect();
            add_coupled(&mut h, &lines, |a, b| smooth.block(a, b));
        }
        mirror(&mut h);
        h
    }
}

/// Functions over the flank of `member` in the middles of `slices`, a column each, times the arms of the forces there.
///
/// The compliance on them is that of forces normal to an involute. Forces at a corner or where a relief is cut away have another arm about the axis, and turn and
/// bend the gear by as much more or less; the points at which they act move so too.
fn basis(model: &FaceModel, member: Member, slices: &[Slice]) -> Mat<f64> {
    let flank = &model.yields[member.index()];
    let cosine = model.pair().base_helix_angle().cos();
    let mut basis = Mat::<f64>::zeros(flank.basis_len(), slices.len());
    for (i, slice) in slices.iter().enumerate() {
        let z = model.pair().own_height(member, slice.z);
        let of_slice = basis.col_as_slice_mut(i);
        flank.basis(slice.middle.roll_lengths[member.index()], z, of_slice);
        let arm = slice.middle.weights[member.index()] / cosine;
        of_slice.iter_mut().for_each(|value| *value *= arm);
    }
    basis
}

/// Adds how slices move under others of their line.
fn add_half_space(slices: &[Slice], h: &mut Mat<f64>) {
    for (column, loaded) in slices.iter().enumerate() {
        let after = slices.iter().enumerate().skip(column + 1);
        for (row, slice) in after.take_while(|(_, slice)| slice.pair == loaded.pair) {
            h[(row, column)] += half_space(loaded, slice.z);
        }
    }
}

/// Adds the further compliance of both flanks at their ends.
fn add_ends(model: &FaceModel, slices: &[Slice], h: &mut Mat<f64>) {
    for member in Member::BOTH {
        let yields = &model.yields[member.index()];
        let place = |slice: &Slice| {
            let z = model.pair().own_height(member, slice.z);
            (slice.middle.roll_lengths[member.index()], z)
        };
        for (column, one) in slices.iter().enumerate() {
            let after = slices.iter().enumerate().skip(column);
            for (row, other) in after.take_while(|(_, slice)| slice.pair == one.pair) {
                // Their actions on each other differ only in the point of a slice at which each is taken.
                let (one_at, other_at) = (place(one), place(other));
                let both = yields.at_ends(other_at, one_at, one.along)
                    + yields.at_ends(one_at, other_at, other.along);
                h[(row, column)] += 0.5 * both;
            }
        }
    }
}

/// How the line of `loaded` moves at the height `z`, outside of it, under a unit force spread along it: 1/r of the half space, for which the
/// width of the contact is nothing from there.
pub(super) fn half_space(loaded: &Slice, z: f64) -> f64 {
    let apart = ((z - loaded.z) / loaded.length).abs();
    0.5 * loaded.factor / loaded.along * ((apart + 0.5) / (apart - 0.5)).ln()
}
