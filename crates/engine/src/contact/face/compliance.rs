//! The linear part of the compliance between slices: the smooth yield of both gears, and the blurred half space along each line.

use std::sync::OnceLock;

use faer::Mat;

use super::FaceModel;
use super::slice::Slice;
use crate::contact::coupled::{LoadedPair, add_coupled, mirror};
use crate::flank::images::{Images, once_inverse, twice_inverse};
use crate::gear::Member;

/// The part of H between slices that all mesh periods have in common, and the data of its smooth part.
pub(super) struct SliceCompliance {
    /// The half space and the ends of the flanks, in m/N; the lower triangle.
    held: Mat<f64>,
    /// The functions over the flank of each gear in the middles of the slices, a column each.
    bases: [Mat<f64>; 2],
    lines: Vec<BlurredLine>,
    /// `held` and the smooth yield of gears whose teeth are all alike, once it is asked for.
    alike: OnceLock<Mat<f64>>,
}

impl SliceCompliance {
    /// That of `slices` of `model`, their lines blurred by `blur`.
    pub(super) fn new(model: &FaceModel, slices: &[Slice], blur: f64) -> Self {
        let mut held = Mat::zeros(slices.len(), slices.len());
        let mut lines: Vec<BlurredLine> = Vec::new();
        for slices in slices.chunk_by(|one, next| one.pair == next.pair) {
            let start = lines.last().map_or(0, BlurredLine::end);
            let line = BlurredLine::new(model, slices, start, blur);
            for column in 0..slices.len() {
                for row in column..slices.len() {
                    held[(start + row, start + column)] += line.in_the_mean(row, column);
                }
            }
            lines.push(line);
        }
        add_ends(model, slices, &mut held);
        Self {
            held,
            bases: Member::BOTH.map(|member| basis(model, member, slices)),
            lines,
            alike: OnceLock::new(),
        }
    }

    /// H without the springs of the slices in m/N, `period` mesh periods on: Φ R Φᵀ of both gears beside the common part.
    pub(super) fn of_teeth(&self, model: &FaceModel, period: i64) -> Mat<f64> {
        let are_alike = |member: &Member| model.yields[member.index()].repeats_after() == 1;
        let (alike, unlike): (Vec<_>, Vec<_>) = Member::BOTH.into_iter().partition(are_alike);
        let all = self.alike.get_or_init(|| {
            let mut h = self.held.clone();
            alike
                .iter()
                .for_each(|of| self.add_smooth(&mut h, model, *of, 0));
            h
        });
        let mut h = all.clone();
        unlike
            .iter()
            .for_each(|of| self.add_smooth(&mut h, model, *of, period));
        mirror(&mut h);
        h
    }

    /// Adds Φ R Φᵀ of one gear, so many mesh periods on, to the lower triangle of `h`.
    fn add_smooth(&self, h: &mut Mat<f64>, model: &FaceModel, member: Member, period: i64) {
        let (Some(first), Some(last)) = (self.lines.first(), self.lines.last()) else {
            return;
        };
        let count = 1 + (last.pair - first.pair) as usize;
        let smooth = model.smooth(member, first.pair + period, count);
        let basis = &self.bases[member.index()];
        let lines = self.lines.iter().map(|line| LoadedPair {
            pair: line.pair + period,
            start: line.start,
            shapes: basis
                .as_ref()
                .subcols(line.start, line.numbers.len())
                .transpose(),
        });
        let lines: Vec<LoadedPair<'_>> = lines.collect();
        add_coupled(h, &lines, |a, b| smooth.block(a, b));
    }

    /// The lines of the slices.
    pub(super) fn lines(&self) -> &[BlurredLine] {
        &self.lines
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
                h[(row, column)] += yields.at_ends(place(other), place(one), one.along);
            }
        }
    }
}

/// A contact line as a half space with images of its load beyond both ends of the face, for a load that is even on each of its slices.
///
/// All is blurred by the same length ρ_0: 1/√(x² + ρ_0²) is positive definite in the mean over slices, however short they are, and with the images what varies
/// along the face is so. Slices are equally long: everything depends on the difference or the sum of two numbers.
pub(super) struct BlurredLine {
    pair: i64,
    /// The number of its first slice among those of all lines.
    start: usize,
    /// The numbers of its slices, from the beginning of the line.
    numbers: Vec<usize>,
    /// By the difference of two numbers: in the mean over a slice, and half a slice ahead of its middle.
    apart: [Vec<f64>; 2],
    /// By the sum of two numbers, likewise.
    mirrored: [Vec<f64>; 2],
}

impl BlurredLine {
    /// That of the `slices` of one line.
    fn new(model: &FaceModel, slices: &[Slice], start: usize, blur: f64) -> Self {
        let Slice { z, along, .. } = slices[0];
        let place = |slice: &Slice| ((slice.z - z) / slices[0].length).round() as usize;
        let numbers: Vec<usize> = slices.iter().map(place).collect();
        let count = numbers.last().map_or(0, |last| last + 1);
        let mut line = Self {
            pair: slices[0].pair,
            start,
            numbers,
            apart: [vec![0.0; count], vec![0.0; count]],
            mirrored: [vec![0.0; 2 * count], vec![0.0; 2 * count]],
        };
        let pair = model.pair();
        let cosine = pair.base_helix_angle().cos();
        for member in Member::BOTH {
            let images = Images {
                length: pair.gear(member).face_width() / cosine,
                module: pair.gear(member).normal_rack().module,
            };
            let factor = 0.5 * slices[0].factors[member.index()];
            let lattice = |first: f64| Lattice { first, along, blur };
            let beyond = |x: f64| images.beyond_direct(x, blur);
            let direct = lattice(0.0).table(count, images.direct(), beyond);
            let beyond = |x: f64| images.beyond_mirrored(x, blur);
            let first = 2.0 * pair.own_height(member, z) / cosine;
            let mirrored = lattice(first).table(2 * count, images.mirrored(), beyond);
            let both = line.apart.iter_mut().chain(&mut line.mirrored);
            for (sum, of_gear) in both.zip(direct.into_iter().chain(mirrored)) {
                for (sum, value) in sum.iter_mut().zip(of_gear) {
                    *sum += factor * value;
                }
            }
        }
        line
    }

    /// Its slices among those of all lines.
    pub(super) fn range(&self) -> std::ops::Range<usize> {
        self.start..self.end()
    }

    fn end(&self) -> usize {
        self.start + self.numbers.len()
    }

    /// Movement of slice `row` in the mean under a unit force on slice `column`, both counted along the line without gaps.
    pub(super) fn in_the_mean(&self, row: usize, column: usize) -> f64 {
        let [i, j] = [row, column].map(|k| self.numbers[k]);
        self.apart[0][i.abs_diff(j)] + self.mirrored[0][i + j]
    }

    /// Movement half a slice ahead of the middle of slice `row`.
    pub(super) fn ahead(&self, row: usize, column: usize) -> f64 {
        let [i, j] = [row, column].map(|k| self.numbers[k]);
        let apart = if i >= j { i - j } else { j - i - 1 };
        self.apart[1][apart] + self.mirrored[1][i + j]
    }
}

/// Places at equal steps along a line.
struct Lattice {
    first: f64,
    along: f64,
    blur: f64,
}

impl Lattice {
    /// The sum of 1/√(x² + ρ_0²) over all images, which stand `at` places of the line and `beyond`, at so many places: in the mean over two pieces as long as a
    /// step, and half a step ahead in the mean over one.
    fn table(
        &self,
        count: usize,
        at: impl Iterator<Item = f64>,
        beyond: impl Fn(f64) -> f64,
    ) -> [Vec<f64>; 2] {
        let Self { first, along, blur } = *self;
        let place = |steps: f64| first + steps * along;
        // Those beyond are so smooth that Simpson's rules have their means.
        let far = |steps: f64| beyond(place(steps));
        let middles: Vec<f64> = (0..count + 2).map(|k| far(k as f64 - 1.0)).collect();
        let in_the_mean = middles
            .windows(3)
            .map(|near| (near[0] + 10.0 * near[1] + near[2]) / 12.0);
        let ahead = (0..count).map(|k| {
            let near = middles[k + 1] + 4.0 * far(k as f64 + 0.5) + middles[k + 2];
            near / 6.0
        });
        let mut tables = [in_the_mean.collect(), ahead.collect::<Vec<f64>>()];
        for image in at {
            // Their differences between steps are the means.
            let integrals = |k: usize| {
                let x = place(k as f64 - 1.0) + image;
                [once_inverse(x, blur), twice_inverse(x, blur)]
            };
            let integrals: Vec<[f64; 2]> = (0..count + 2).map(integrals).collect();
            for (k, step) in integrals.windows(3).enumerate() {
                let [before, here, after] = [step[0], step[1], step[2]];
                tables[0][k] += (after[1] - 2.0 * here[1] + before[1]) / (along * along);
                tables[1][k] += (after[0] - here[0]) / along;
            }
        }
        tables
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::face::slice::SHORTEST;
    use crate::fem::dense::Cholesky;
    use crate::flank::images::inverse_in_the_mean;

    const IMAGES: Images = Images {
        length: 1.0,
        module: 0.5,
    };

    /// The compliance of a line over a whole face, of so many slices.
    fn whole_face(count: usize, blur: f64) -> Mat<f64> {
        let along = 1.0 / count as f64;
        let lattice = |first: f64| Lattice { first, along, blur };
        let beyond = |x: f64| IMAGES.beyond_direct(x, blur);
        let [apart, _] = lattice(0.0).table(count, IMAGES.direct(), beyond);
        let beyond = |x: f64| IMAGES.beyond_mirrored(x, blur);
        let [mirrored, _] = lattice(along - 1.0).table(2 * count, IMAGES.mirrored(), beyond);
        Mat::from_fn(count, count, |i, j| apart[i.abs_diff(j)] + mirrored[i + j])
    }

    #[test]
    fn tables_have_the_means_over_pieces_of_all_images() {
        const PARTS: i32 = 2000;
        let lattice = Lattice {
            first: -0.9,
            along: 0.2,
            blur: 0.1,
        };
        let [mean, ahead] = lattice.table(6, [-2.0, 0.0].into_iter(), |x| x);
        for (k, (mean, ahead)) in mean.into_iter().zip(ahead).enumerate() {
            let x = -0.9 + 0.2 * k as f64;
            let means = [x - 2.0, x].map(|x| inverse_in_the_mean(0.2, x, 0.1));
            let expected = x + means[0] + means[1];
            assert!((mean - expected).abs() < 1e-12, "{mean} {expected}");
            let x = x + 0.1;
            let part = |i: i32| 0.2 * ((f64::from(i) + 0.5) / f64::from(PARTS) - 0.5);
            let inverse =
                |i: i32| (x + part(i)).hypot(0.1).recip() + (x - 2.0 + part(i)).hypot(0.1).recip();
            let expected = x + (0..PARTS).map(inverse).sum::<f64>() / f64::from(PARTS);
            assert!((ahead - expected).abs() < 1e-6, "{ahead} {expected}");
        }
    }

    #[test]
    fn an_even_load_over_a_face_moves_it_evenly_by_the_logarithm_of_the_plane() {
        for (count, blur) in [(40, 0.02), (6, 0.3), (1, 1.5)] {
            let h = whole_face(count, blur);
            for i in 0..count {
                let moved: f64 = (0..count).map(|j| h[(i, j)] / count as f64).sum();
                let plane = -2.0 * (blur / 0.5_f64).ln();
                assert!((moved - plane).abs() < 1e-3, "{count} {i}: {moved} {plane}");
            }
        }
    }

    #[test]
    fn what_varies_along_a_face_is_positive_definite_for_the_shortest_slices() {
        for count in [2, 6, 40, 160] {
            let mut h = whole_face(count, 1.0 / (SHORTEST * count as f64));
            // So even a compliance beside it that the constant of the logarithm does not matter.
            for i in 0..count {
                for j in 0..count {
                    h[(i, j)] += 10.0;
                }
            }
            assert!(Cholesky::new(h).is_some(), "{count}");
        }
    }
}
