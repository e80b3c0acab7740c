//! The linear part of the compliance between slices: the smooth yield of both gears, and the half space along each line.

use faer::Mat;

use super::FaceModel;
use super::slice::Slice;
use crate::contact::coupled::{Touching, add_coupled, mirror};
use crate::gear::Member;

/// H between `slices` without their own springs, in m/N.
pub(super) fn compliance(model: &FaceModel, slices: &[Slice]) -> Mat<f64> {
    let count = slices.len();
    let mut h = Mat::zeros(count, count);
    for member in Member::BOTH {
        add_smooth(model, member, slices, &mut h);
    }
    add_half_space(slices, &mut h);
    add_ends(model, slices, &mut h);
    mirror(&mut h);
    h
}

/// Adds Φ R Φᵀ of the gear `member`, below the diagonal blocks and on them.
///
/// R is that of forces normal to an involute. Forces at a corner or where a relief is cut away have another arm about the axis, and turn and bend the gear by as
/// much more or less; the points at which they act move so too.
fn add_smooth(model: &FaceModel, member: Member, slices: &[Slice], h: &mut Mat<f64>) {
    let (first, last) = (slices[0].pair, slices[slices.len() - 1].pair);
    let smooth = model.smooth(member, first, 1 + (last - first) as usize);
    let flank = &model.yields[member.index()];
    let cosine = model.pair().base_helix_angle().cos();
    // One column a slice.
    let mut basis = Mat::<f64>::zeros(flank.basis_len(), slices.len());
    for (i, slice) in slices.iter().enumerate() {
        let z = model.pair().own_height(member, slice.z);
        let of_slice = basis.col_as_slice_mut(i);
        flank.basis(slice.middle.roll_lengths[member.index()], z, of_slice);
        let arm = slice.middle.weights[member.index()] / cosine;
        of_slice.iter_mut().for_each(|value| *value *= arm);
    }
    let mut start = 0;
    let lines = slices.chunk_by(|one, next| one.pair == next.pair);
    let lines = lines.map(|line| {
        let from = start;
        start += line.len();
        Touching {
            pair: line[0].pair,
            start: from,
            shapes: basis.as_ref().subcols(from, line.len()).transpose(),
        }
    });
    let lines: Vec<Touching<'_>> = lines.collect();
    add_coupled(h, &lines, |a, b| smooth.block(a, b));
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

/// Adds what both flanks yield at their ends.
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
                // What each of them does to the other is the same but for the point in a slice at which it is taken.
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
