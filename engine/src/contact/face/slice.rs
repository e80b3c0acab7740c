//! The slices of the contact lines at one position: where each stands, how far its flanks are apart, and its spring.

use super::FaceModel;
use super::spring::Spring;
use crate::contact::facing::{Facing, View};
use crate::contact::half_plane::{hertz, logarithm_factor};
use crate::contact::placement::Placement;
use crate::gear::{ContactLine, Member};

/// No slice is shorter than so many half-widths of its contact: a line that short is none.
const SHORTEST: f64 = 2.0;

/// One slice.
pub(super) struct Slice {
    /// The pair n.
    pub(super) pair: i64,
    /// Its middle, from the middle of the common face.
    pub(super) z: f64,
    /// Its length along the axis, and along the contact line.
    pub(super) length: f64,
    pub(super) along: f64,
    /// Where it touches: roll length on the driving and on the driven gear.
    pub(super) roll_lengths: [f64; 2],
    /// The arms about the driving and the driven axis over the base radii, times cos β_b.
    pub(super) weights: [f64; 2],
    /// The gap along the normal, the spring not pressed.
    pub(super) gap: f64,
    /// Σ 2(1 − ν²)/(πE).
    pub(super) factor: f64,
    pub(super) spring: Spring,
}

/// What slices are laid for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loading {
    /// The load.
    pub(super) load: f64,
    /// How many times the mean may stand on each length of a contact line: so heavy an edge is looked for beside it, and so heavy no slice is
    /// shorter than its contact is wide.
    pub(super) heavier: f64,
}

/// What is cut into slices.
pub(super) struct Stretches {
    lines: Vec<ContactLine>,
    /// No slice is longer along the axis.
    longest: f64,
}

impl Stretches {
    /// All lines of `model` at the position `eta` on which sections are in `phases`.
    pub(super) fn whole(model: &FaceModel, eta: f64, phases: [f64; 2]) -> Self {
        Self {
            lines: model.pair.lines(eta, phases),
            longest: model.pair.common_face_width() / model.slices as f64,
        }
    }

    /// Where `slices` of these are shut, which have no gap, or may be within half of their length, for which the `gaps` beside them speak; each
    /// with a slice to either side, and cut into as many as a whole face is. `None` where that is more than half a face.
    pub(super) fn shut(&self, model: &FaceModel, slices: &[Slice], gaps: &[f64]) -> Option<Self> {
        let mut lines = Vec::new();
        let mut first = 0;
        for line in slices.chunk_by(|one, next| one.pair == next.pair) {
            let gaps = &gaps[first..first + line.len()];
            first += line.len();
            let may_shut = |i: usize| {
                let beside = [i.wrapping_sub(1), i + 1].map(|k| gaps.get(k));
                let rise = |other: &f64| gaps[i] - (other - gaps[i]).abs() <= 0.0;
                gaps[i] <= 0.0 || beside.into_iter().flatten().any(rise)
            };
            let mut shut = (0..line.len()).filter(|&i| may_shut(i));
            let Some(low) = shut.next() else {
                continue;
            };
            let high = shut.next_back().unwrap_or(low);
            let [low, high] = [low.saturating_sub(1), (high + 1).min(line.len() - 1)];
            lines.push(ContactLine {
                pair: line[0].pair,
                heights: [
                    line[low].z - 0.5 * line[low].length,
                    line[high].z + 0.5 * line[high].length,
                ],
            });
        }
        let longest = length(&lines) / model.slices as f64;
        (longest <= 0.5 * self.longest).then_some(Self { lines, longest })
    }

    /// Whether of `slices` of these one that carries, as `forces` say, ends where its line goes on, as the `whole` ones have it.
    pub(super) fn end_under_load(&self, slices: &[Slice], forces: &[f64], whole: &Self) -> bool {
        let is_end = |place: f64, of: &[ContactLine], pair: i64| {
            let ends = of.iter().filter(|line| line.pair == pair);
            let mut places = ends.flat_map(|line| line.heights);
            places.any(|end| (end - place).abs() < 1e-6 * self.longest)
        };
        let mut loaded = slices.iter().zip(forces).filter(|(_, force)| **force > 0.0);
        loaded.any(|(slice, _)| {
            let half = 0.5 * slice.length;
            [slice.z - half, slice.z + half].into_iter().any(|place| {
                is_end(place, &self.lines, slice.pair) && !is_end(place, &whole.lines, slice.pair)
            })
        })
    }
}

fn length(lines: &[ContactLine]) -> f64 {
    let lengths = lines.iter().map(|line| line.heights[1] - line.heights[0]);
    lengths.sum()
}

/// The slices of `stretches` of the lines of `model` at the position `eta`; with the springs that they have under a load, or Hertz's alone.
///
/// Slices of one stretch are equally long, so that they move with their line.
pub(super) fn lay(
    model: &FaceModel,
    eta: f64,
    stretches: &Stretches,
    loading: Option<Loading>,
) -> Vec<Slice> {
    // For each length along a contact line.
    let total = length(&stretches.lines);
    let densities = loading.map(|of| [1.0, of.heavier].map(|times| times * of.load / total));
    let layer = Layer::new(model, densities, stretches.longest);
    let lines = stretches.lines.iter();
    lines.flat_map(|line| layer.line(eta, line)).collect()
}

/// What all slices of one position have alike.
struct Layer<'a> {
    model: &'a FaceModel,
    cosine: f64,
    factor: f64,
    /// In the mean, and at most.
    densities: Option<[f64; 2]>,
    /// The longest slice along the axis.
    longest: f64,
}

impl<'a> Layer<'a> {
    fn new(model: &'a FaceModel, densities: Option<[f64; 2]>, longest: f64) -> Self {
        let factors = Member::BOTH.map(|member| {
            let modulus = model.long.gear(member).material().youngs_modulus;
            logarithm_factor(modulus, 1.0)
        });
        Self {
            model,
            cosine: model.pair.base_helix_angle().cos(),
            factor: factors[0] + factors[1],
            densities,
            longest,
        }
    }

    fn line(&self, eta: f64, line: &ContactLine) -> Vec<Slice> {
        let [from, to] = line.heights;
        let pair = &self.model.pair;
        let half_width = self.densities.map_or(0.0, |[_, density]| {
            let s = 0.5 * pair.section().line_of_action();
            hertz(density, 0.5 * s / self.cosine, self.factor, 1.0).0
        });
        let shortest = self.longest.max(SHORTEST * half_width * self.cosine);
        let count = ((to - from) / shortest - 1e-9).ceil().max(1.0);
        let length = (to - from) / count;
        let straight = pair.advance() == 0.0;
        let mut known: Option<Facing> = None;
        (0..count as usize)
            .filter_map(|i| {
                let z = from + (i as f64 + 0.5) * length;
                let phase = pair.phase(eta, line.pair, z);
                let facing = match known.take().filter(|_| straight) {
                    Some(facing) => facing,
                    None => Facing::drawn(&self.model.long, phase)?,
                };
                let slice = self.slice(line.pair, (z, length), (phase, &facing));
                known = Some(facing);
                Some(slice)
            })
            .collect()
    }

    fn slice(&self, n: i64, (z, length): (f64, f64), (phase, facing): (f64, &Facing)) -> Slice {
        let model = self.model;
        let view = View {
            placement: Placement::drawn(&model.long, phase),
            seat: facing.seat,
        };
        let hollow = &facing.hollows[0];
        // Where flanks face each other the hollow is seen.
        let meeting = view.point(hollow.arc).map(|point| view.meeting(&point));
        let arms = meeting.map_or([1.0, 1.0], |meeting| meeting.arms);
        let weights = arms.map(|arm| arm * self.cosine);
        let along = length / self.cosine;
        let radius = {
            let [one, other] = hollow.roll_lengths.map(|s| s / self.cosine);
            one * other / (one + other)
        };
        let (spring, section_gap) = match self.densities {
            Some([mean, most]) if self.is_crowded(facing, most, radius) => {
                Spring::patch(&view, facing, (along, self.cosine, self.factor), mean)
            }
            of => (
                Spring::hertz(along, radius, self.factor, of.map_or(1.0, |[_, most]| most)),
                hollow.touch * weights[1],
            ),
        };
        Slice {
            pair: n,
            z,
            length,
            along,
            roll_lengths: hollow.roll_lengths,
            weights,
            gap: section_gap + weights[1] * model.opening(n, z, hollow.roll_lengths),
            factor: self.factor,
            spring,
        }
    }

    /// Whether a contact under `density` may reach an end of the flanks or a kink, or is not that of two parabolas.
    fn is_crowded(&self, facing: &Facing, density: f64, radius: f64) -> bool {
        const BESIDE: f64 = 1.5;
        const COMMON_TANGENT: f64 = 0.02;
        let (half_width, _) = hertz(density, radius, self.factor, 1.0);
        let hollow = &facing.hollows[0];
        let near = |place: &f64| (place - hollow.arc).abs() < BESIDE * half_width;
        let inclined = |angle: &f64| *angle * radius > COMMON_TANGENT * half_width;
        [facing.range.from, facing.range.to].iter().any(near)
            || facing.kinks.iter().any(near)
            || hollow.openings.iter().any(inclined)
            || facing.hollows.len() > 1
    }
}
