//! The slices of the contact lines at one position: where each stands, how far its flanks are apart, and its springs.

use std::sync::Arc;

use super::FaceModel;
use super::spring::{Line, Spring, blur};
use crate::flank::half_plane::{hertz, logarithm_factor};
use crate::gear::ContactLine;
use crate::touch::gap_profile::GapProfile;
use crate::touch::placement::Section;

/// No slice is shorter than this part of the blur of lines: equal and opposite forces on shorter ones hardly move anything.
pub(super) const SHORTEST: f64 = 0.5;

/// One slice.
#[derive(Clone)]
pub(super) struct Slice {
    /// The pair n.
    pub(super) pair: i64,
    /// Its middle, from the middle of the common face.
    pub(super) z: f64,
    /// Its length along the axis, and along the contact line.
    pub(super) length: f64,
    pub(super) along: f64,
    /// Values in its middle, and its ends along the axis.
    pub(super) middle: Place,
    pub(super) ends: [Place; 2],
    /// 2(1 − ν²)/(πE) of both gears.
    pub(super) factors: [f64; 2],
}

/// A place of a contact line.
#[derive(Clone)]
pub(super) struct Place {
    /// Where it touches: roll length on the driving and on the driven gear.
    pub(super) roll_lengths: [f64; 2],
    /// The arms about the driving and the driven axis over the base radii, times cos β_b.
    pub(super) weights: [f64; 2],
    /// The gap along the normal, the spring not pressed.
    pub(super) gap: f64,
    pub(super) spring: Arc<Spring>,
}

/// A kink near the loaded part of a slice.
pub(super) struct NearKink {
    /// Which kink of the model it is.
    pub(super) number: usize,
    /// Where it stands in the middle of the contact, from the beginning of the slice (−1) to its end (1) or beside it.
    pub(super) stands: f64,
    /// The nearest place of the loaded part.
    pub(super) nearest: f64,
}

/// A place within a slice, from its beginning (−1) to its end (1).
pub(super) struct Within {
    pub(super) at: f64,
    pub(super) z: f64,
    pub(super) place: Place,
}

impl Slice {
    /// Its beginning (−1) or its end (1); `None` where flanks do not face each other there.
    pub(super) fn at_end(&self, at: f64) -> Option<Within> {
        let place = &self.ends[usize::from(at > 0.0)];
        let faces = !Arc::ptr_eq(&place.spring, &self.middle.spring);
        faces.then(|| Within {
            at,
            z: self.z + at * 0.5 * self.length,
            place: place.clone(),
        })
    }

    /// The place `at` of it, from its beginning (−1) to its end (1): values between those in its middle and at its end, with the spring of the nearer one.
    pub(super) fn between(&self, at: f64) -> Within {
        let (middle, end, share) = (&self.middle, &self.ends[usize::from(at > 0.0)], at.abs());
        let between = |one: f64, other: f64| one + (other - one) * share;
        let both = |of: fn(&Place) -> [f64; 2]| {
            let (one, other) = (of(middle), of(end));
            [0, 1].map(|i| between(one[i], other[i]))
        };
        Within {
            at,
            z: self.z + at * 0.5 * self.length,
            place: Place {
                roll_lengths: both(|place| place.roll_lengths),
                weights: both(|place| place.weights),
                gap: between(middle.gap, end.gap),
                spring: Arc::clone(if share < 0.5 {
                    &middle.spring
                } else {
                    &end.spring
                }),
            },
        }
    }

    /// The load a length `at` a place, from its beginning (−1) to its end (1), closed up by `depth`, and how fast that grows with it.
    pub(super) fn load(&self, at: f64, depth: f64) -> [f64; 2] {
        let end = &self.ends[usize::from(at > 0.0)];
        let middle = self.middle.spring.load(depth);
        if self.middle.spring.is_hertz() && end.spring.is_hertz() {
            return middle;
        }
        let outer = end.spring.load(depth);
        [0, 1].map(|i| middle[i] + (outer[i] - middle[i]) * at.abs())
    }
}

/// The load on one slice.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Carried {
    /// Normal to the flanks, in N, and how it rises with the load.
    pub(super) force: f64,
    pub(super) rise: f64,
    /// The same, weighed with the arms about the driven axis.
    pub(super) weighed: f64,
    /// The part of the slice that is loaded, from its beginning (−1) to its end (1).
    pub(super) part: [f64; 2],
}

/// The load for which slices are made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loading {
    /// The load.
    pub(super) load: f64,
    /// The largest line load that is expected. Under it the contact is so wide that an edge beside it is looked for, and lines are blurred by more than that
    /// width.
    pub(super) heaviest: f64,
}

/// Lines that are cut into slices.
#[derive(Clone, PartialEq)]
pub(super) struct Stretches {
    lines: Vec<ContactLine>,
    /// No slice is longer along the axis.
    longest: f64,
    /// At least so many slices a line, unless they would be shorter than [`SHORTEST`].
    least: f64,
}

impl Stretches {
    /// All lines of `model` at the position `eta` on which sections are in `phases`.
    pub(super) fn whole(model: &FaceModel, eta: f64, phases: [f64; 2]) -> Self {
        let width = model.pair().common_face_width();
        let longest = width / model.flanks.slices as f64;
        // As many slices on a line while it grows and shrinks, so that nothing steps.
        let across = (phases[1] - phases[0]) / model.pair().advance().abs();
        Self {
            lines: model.pair().lines(eta, phases),
            longest,
            least: (width.min(across) / longest - 1e-9).ceil(),
        }
    }

    /// The loaded part of each line, by the `gaps` of its `slices`: from the first slice that is loaded, or by the gap beside it may be at one of its
    /// ends, to the last, and one more to either side. It is cut into as many slices as a whole face. `None` where it is more than half a face.
    pub(super) fn loaded(&self, model: &FaceModel, slices: &[Slice], gaps: &[f64]) -> Option<Self> {
        let mut lines = Vec::new();
        let mut first = 0;
        for line in slices.chunk_by(|one, next| one.pair == next.pair) {
            let gaps = &gaps[first..first + line.len()];
            first += line.len();
            let may_be_loaded = |i: usize| {
                let beside = [i.wrapping_sub(1), i + 1].map(|k| gaps.get(k));
                let rise = |other: &f64| gaps[i] - (other - gaps[i]).abs() <= 0.0;
                gaps[i] <= 0.0 || beside.into_iter().flatten().any(rise)
            };
            let mut loaded = (0..line.len()).filter(|&i| may_be_loaded(i));
            let Some(low) = loaded.next() else {
                continue;
            };
            let high = loaded.next_back().unwrap_or(low);
            let [low, high] = [low.saturating_sub(1), (high + 1).min(line.len() - 1)];
            lines.push(ContactLine {
                pair: line[0].pair,
                heights: [
                    line[low].z - 0.5 * line[low].length,
                    line[high].z + 0.5 * line[high].length,
                ],
            });
        }
        let longest = length(&lines) / model.flanks.slices as f64;
        (longest <= 0.5 * self.longest).then_some(Self {
            lines,
            longest,
            least: 1.0,
        })
    }

    /// The mean line load under `load`: for each length of a contact line normal to it, as along the axis in the transverse section.
    pub(super) fn mean_load(&self, load: f64) -> f64 {
        load / length(&self.lines)
    }

    /// True if one of the loaded `slices` of these lies at the end of its line, where the `whole` line goes on.
    pub(super) fn end_under_load(
        &self,
        slices: &[Slice],
        carried: &[Carried],
        whole: &Self,
    ) -> bool {
        let is_end = |place: f64, of: &[ContactLine], pair: i64| {
            let ends = of.iter().filter(|line| line.pair == pair);
            let mut places = ends.flat_map(|line| line.heights);
            places.any(|end| (end - place).abs() < 1e-6 * self.longest)
        };
        let mut loaded = slices
            .iter()
            .zip(carried)
            .filter(|(_, carried)| carried.force > 0.0);
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

/// Common data of all slices of one position.
pub(super) struct Slicer<'a> {
    model: &'a FaceModel,
    eta: f64,
    cosine: f64,
    /// 2(1 − ν²)/(πE) of both gears, and their sum.
    factors: [f64; 2],
    factor: f64,
    /// The blur of lines.
    pub(super) blur: f64,
    /// The line loads for which springs are made: in the mean, and at most.
    densities: [f64; 2],
}

impl<'a> Slicer<'a> {
    /// Of `stretches` of `model` at the position `eta`, with springs for a load.
    pub(super) fn new(
        model: &'a FaceModel,
        eta: f64,
        stretches: &Stretches,
        Loading { load, heaviest }: Loading,
    ) -> Self {
        let moduli = model.flanks.moduli();
        let factors = moduli.map(|modulus| logarithm_factor(modulus, 1.0));
        let factor = factors[0] + factors[1];
        let cosine = model.pair().base_helix_angle().cos();
        let densities = [stretches.mean_load(load), heaviest];
        let radius = 0.25 * model.pair().section().line_of_action() / cosine;
        Self {
            model,
            eta,
            cosine,
            factors,
            factor,
            blur: blur(densities[1], radius, factor),
            densities,
        }
    }

    /// True if no line of `stretches` is longer than the blur.
    pub(super) fn is_no_line(&self, stretches: &Stretches) -> bool {
        length(&stretches.lines) <= self.blur * self.cosine
    }

    /// The slices of `stretches`. Those of one line are equally long, so that they move with it.
    pub(super) fn slices(&self, stretches: &Stretches) -> Vec<Slice> {
        let lines = stretches.lines.iter();
        lines.flat_map(|line| self.line(stretches, line)).collect()
    }

    fn line(&self, stretches: &Stretches, line: &ContactLine) -> Vec<Slice> {
        let [from, to] = line.heights;
        let longest = ((to - from) / stretches.longest - 1e-9)
            .ceil()
            .max(stretches.least);
        let shortest = ((to - from) / (SHORTEST * self.blur * self.cosine)).floor();
        let count = longest.min(shortest).max(1.0);
        let length = (to - from) / count;
        let along = length / self.cosine;
        let mut known: Option<(Section, Place)> = None;
        let mut place = |z: f64| {
            let section = self.section(line.pair, z);
            // Straight teeth without leads face each other alike in all sections.
            if known.as_ref().is_none_or(|(of, _)| *of != section) {
                known = self.place(section).map(|place| (section, place));
            }
            let (_, place) = known.as_ref()?;
            Some(self.standing(place.clone(), z))
        };
        let mut begin = place(from);
        (0..count as usize)
            .filter_map(|i| {
                let z = from + (i as f64 + 0.5) * length;
                let middle = place(z);
                let end = place(z + 0.5 * length);
                let ends = [begin.take(), end.clone()];
                begin = end;
                let middle = middle?;
                Some(Slice {
                    pair: line.pair,
                    z,
                    length,
                    along,
                    ends: ends.map(|end| end.unwrap_or_else(|| middle.clone())),
                    middle,
                    factors: self.factors,
                })
            })
            .collect()
    }

    fn section(&self, pair: i64, z: f64) -> Section {
        self.model.flanks.section(self.eta, pair, z)
    }

    /// `place`, at `z`, with the opening by the axes.
    fn standing(&self, mut place: Place, z: f64) -> Place {
        place.gap += place.weights[1] * self.model.pair().misalignment_gap(z);
        place
    }

    /// The kinks that stand nearer to the loaded part, from one place to another, of `slice` than the contact, of this `half_width`, is wide.
    pub(super) fn near_kinks(
        &self,
        slice: &Slice,
        [from, to]: [f64; 2],
        half_width: f64,
    ) -> Vec<NearKink> {
        let (pair, half) = (self.model.pair(), 0.5 * slice.length);
        let section = self.section(slice.pair, slice.z);
        let phase = section.phase + self.model.flanks.ahead(section);
        let across = pair.advance() * half;
        let kinks = self.model.kinks.iter().enumerate();
        let near = kinks.filter_map(|(number, kink)| {
            let stands = (kink.phase - phase) / across;
            let step = kink.along * across * pair.section().base_pitch();
            let beside = (2.0 * half_width / step).abs();
            if across == 0.0 || stands < from - beside || stands > to + beside {
                return None;
            }
            Some(NearKink {
                number,
                stands,
                nearest: stands.clamp(from, to),
            })
        });
        near.collect()
    }

    /// The number of kinks that may be near.
    pub(super) fn kink_count(&self) -> usize {
        self.model.kinks.len()
    }

    /// A place of `slice`, from its beginning (−1) to its end (1); `None` where flanks do not face each other there.
    pub(super) fn within(&self, slice: &Slice, at: f64) -> Option<Within> {
        let z = slice.z + at * 0.5 * slice.length;
        let place = self.place(self.section(slice.pair, z))?;
        let place = self.standing(place, z);
        Some(Within { at, z, place })
    }

    /// The place of a line in a `section`; `None` where flanks do not face each other.
    fn place(&self, section: Section) -> Option<Place> {
        let touching = self.model.flanks.touching(section)?;
        let (view, facing) = (&touching.view, &touching.facing);
        let minimum = &facing.minima[0];
        let weights = minimum.arms.map(|arm| arm * self.cosine);
        let radius = {
            let [one, other] = minimum.roll_lengths.map(|s| s / self.cosine);
            one * other / (one + other)
        };
        let of = Line {
            blur: self.blur,
            radius,
            factor: self.factor,
        };
        let free = self.free_under(facing, radius);
        let (spring, gap) = if self.densities[1] >= free {
            Spring::patch(view, facing, self.cosine, of, self.densities, free)
        } else {
            let spring = Spring::hertz(of, self.densities);
            (spring, minimum.touch * weights[1])
        };
        Some(Place {
            roll_lengths: minimum.roll_lengths,
            gap: gap + weights[1] * touching.lag,
            weights,
            spring: Arc::new(spring),
        })
    }

    /// The line load below which a contact is that of two parabolas and reaches no end of the flanks and no kink; 0 where there is none.
    fn free_under(&self, facing: &GapProfile, radius: f64) -> f64 {
        const BESIDE: f64 = 1.1;
        const COMMON_TANGENT: f64 = 0.02;
        let (usual, _) = hertz(self.densities[1], radius, self.factor, 1.0);
        let minimum = &facing.minima[0];
        let inclined = |angle: &f64| *angle * radius > COMMON_TANGENT * usual;
        if minimum.openings.iter().any(inclined) || facing.minima.len() > 1 {
            return 0.0;
        }
        let ends = [facing.range.from, facing.range.to];
        let nearest = (ends.iter().chain(&facing.kinks))
            .map(|place| (place - minimum.arc).abs())
            .fold(f64::INFINITY, f64::min);
        // The half width grows with the root of the load.
        self.densities[1] * (nearest / (BESIDE * usual)).powi(2)
    }
}
