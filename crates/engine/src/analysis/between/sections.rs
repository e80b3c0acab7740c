//! A curve in sections, each a polynomial between neighboring positions or events, and its statistics.

use std::ops::Range;

use super::cubic::Cubic;
use super::events::events;
use super::{Sample, Span};
use crate::analysis::Case;
use crate::analysis::curve_point::{CurvePoint, EventSide, SAME_POSITION};
use crate::analysis::long_wave::LongWave;
use crate::analysis::statistics::{SamplingError, Statistics};
use crate::quadrature::gauss_legendre_panels;

/// Samples from beyond either end of a curve that closes, so that its first and last sections have neighbors too.
const OVERLAP: usize = 8;

/// How much the error of a section is less than the difference to the next lower degree.
const LOWER_DEGREE: f64 = 0.3;

/// Largest excursion of a polynomial beyond both of its ends, as a multiple of that of another one through the nodes beside does: farther, it swings.
const SWING: f64 = 2.0;

/// The error of δ between two places of which nothing else is known, for their difference.
const UNKNOWN: f64 = 0.1;

/// Where samples on both sides of an event are nearer to each other than this, δ need not be the same on both: the classical load distribution
/// sees pairs on the line of contact only, and takes them up at its end with a part of the load.
const JUMP: f64 = 1e-5;

/// Both sides of an event meet within twice this part of the way between its neighbors, if they are near enough to be believed.
const NEARBY: f64 = 0.1;

/// An event whose place no pair gives stands where both sides meet, anywhere between neighbors that are nearer to each other than this part of
/// a step.
const CLOSE: f64 = 1.0 / 8.0;

/// Places in a mesh period by which the long wave is known well enough to tell extremes from it.
const WAVE: usize = 16;

/// Tolerance of δ between positions: of its extremes, as a part of its peak-to-peak, and its least value in meters.
const TOLERANCE: (f64, f64) = (1e-3, 5e-10);

/// The tolerance for this peak-to-peak.
pub(super) fn tolerance(peak_to_peak: f64) -> f64 {
    (TOLERANCE.0 * peak_to_peak).max(TOLERANCE.1)
}

/// δ and k over a whole span.
#[derive(Debug, Clone)]
pub(in crate::analysis) struct Sections {
    pub(super) span: Span,
    /// Rising, without gaps.
    pub(super) sections: Vec<Section>,
    /// The mean torque of the driver over r_b1.
    mean_driving_load: f64,
}

/// δ and k between two neighboring positions or events.
#[derive(Debug, Clone, Copy)]
pub(super) struct Section {
    pub(super) from: f64,
    pub(super) to: f64,
    /// True for each end at which a pair takes up or leaves the load.
    pub(super) events: [bool; 2],
    pub(super) delta: Cubic,
    pub(super) stiffness: Cubic,
    /// By how much δ may be off, about: the difference to curves through other nodes.
    pub(super) error: f64,
    /// The same with what one node less changes: curves through nodes that are far apart may agree on what is wrong.
    open: f64,
}

/// The smallest and the largest value, each with its place.
pub(super) type Extremes = [(f64, f64); 2];

/// The extremes of nothing.
const NONE: Extremes = [(f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0)];

/// The extremes of both; those of the first where they are equal.
fn wider(first: Extremes, second: Extremes) -> Extremes {
    let [low, high] = second;
    [
        if low.0 < first[0].0 { low } else { first[0] },
        if high.0 > first[1].0 { high } else { first[1] },
    ]
}

/// An event, with δ there as either side of it has it.
struct Event {
    at: f64,
    /// True if its place is known without δ.
    is_known: bool,
    /// The sample before it.
    after: usize,
    /// As the side before it has it, and that behind it.
    delta: [f64; 2],
    error: f64,
    /// The same with what one sample less changes on either side.
    open: f64,
}

impl Sections {
    /// Sections of the curve through `samples` over `span`, rising by position.
    pub(in crate::analysis) fn new(span: Span, samples: &[Sample]) -> Self {
        let samples = overlapping(span, samples);
        let events = with_values(&samples, CLOSE * span.step());
        let mut sections = Vec::with_capacity(samples.len() + events.len());
        let mut first = 0;
        for piece in 0..=events.len() {
            let begins = piece.checked_sub(1).map(|before| &events[before]);
            let ends = events.get(piece);
            let last = ends.map_or(samples.len(), |event| event.after + 1);
            add_piece(&mut sections, begins, (&samples, first..last), ends);
            first = last;
        }
        let (from, to) = (span.first, span.end());
        sections.retain(|section| section.from < to && section.to > from);
        for section in &mut sections {
            section.from = section.from.max(from);
            section.to = section.to.min(to);
        }
        Self {
            span,
            sections,
            mean_driving_load: mean_driving_load(span, &samples),
        }
    }

    /// The mean torque of the driver over r_b1, on straight lines from sample to sample.
    pub(in crate::analysis) fn mean_driving_load(&self) -> f64 {
        self.mean_driving_load
    }

    /// Sections of the curve of `case` through `samples`.
    pub(in crate::analysis) fn of(case: &Case, samples: &[Sample]) -> Self {
        Self::new(Span::of(case), samples)
    }

    /// The statistics of δ and of k.
    pub(in crate::analysis) fn statistics(&self) -> [Statistics; 2] {
        [
            self.statistics_of(|section| section.delta),
            self.statistics_of(|section| section.stiffness),
        ]
    }

    fn statistics_of(&self, curve: fn(&Section) -> Cubic) -> Statistics {
        let integral = |value: &dyn Fn(f64) -> f64| -> f64 {
            let each = self.sections.iter().map(|section| {
                let points = gauss_legendre_panels(section.from, section.to, 1);
                let curve = curve(section);
                points
                    .map(|(x, weight)| weight * value(curve.at(x)))
                    .sum::<f64>()
            });
            each.sum()
        };
        let length = integral(&|_| 1.0);
        let mean = integral(&|value| value) / length;
        let square = integral(&|value| (value - mean).powi(2)) / length;
        let [(smallest, smallest_at), (largest, largest_at)] = self.extremes(curve);
        Statistics {
            mean,
            rms: square.sqrt(),
            peak_to_peak: largest - smallest,
            smallest,
            smallest_at,
            largest,
            largest_at,
        }
    }

    /// The smallest and the largest value of a curve.
    pub(super) fn extremes(&self, curve: fn(&Section) -> Cubic) -> Extremes {
        let each = self.sections.iter();
        let extremes = each
            .map(|section| section.extremes(curve))
            .fold(NONE, wider);
        extremes.map(|(value, place)| {
            let beyond = self.span.closes && place >= self.span.end();
            let periods = if beyond {
                f64::from(self.span.periods)
            } else {
                0.0
            };
            (value, place - periods)
        })
    }

    /// δ and k at `count` equal steps over the span.
    pub(in crate::analysis) fn resampled(&self, count: usize) -> [Vec<f64>; 2] {
        let step = f64::from(self.span.periods) / count as f64;
        let mut at = 0;
        let values = (0..count).map(|i| {
            let x = self.span.first + i as f64 * step;
            while at + 1 < self.sections.len() && self.sections[at].to <= x {
                at += 1;
            }
            let section = &self.sections[at];
            (section.delta.at(x), section.stiffness.at(x))
        });
        let (delta, stiffness) = values.unzip();
        [delta, stiffness]
    }

    /// The long wave of δ; `None` where the curve does not close, or fluctuates no slower than the mesh by more than its extremes are to be known.
    pub(super) fn long_wave(&self) -> Option<LongWave> {
        if !self.span.closes || self.span.periods <= 2 {
            return None;
        }
        let [delta, _] = self.resampled(WAVE * self.span.periods as usize);
        let long = LongWave::of(&delta, self.span.first, self.span.periods);
        let [(low, _), (high, _)] = self.extremes(|section| section.delta);
        (long.range() > tolerance(high - low)).then_some(long)
    }

    /// The mesh periods of the span.
    pub(in crate::analysis) fn periods(&self) -> f64 {
        f64::from(self.span.periods)
    }

    /// Rising places and δ there, at least a given number in a mesh period, with all at which δ is level or has a kink; where it jumps, both sides.
    pub(in crate::analysis) fn traced(&self, per_period: usize) -> Vec<(f64, f64)> {
        let mut traced = Vec::new();
        for Section {
            from, to, delta, ..
        } in &self.sections
        {
            let parts = ((to - from) * per_period as f64).ceil().max(1.0);
            let steps = (0..parts as usize).map(|i| from + (to - from) * i as f64 / parts);
            let mut places: Vec<f64> = steps.chain(delta.level_within(*from, *to)).collect();
            places.push(*to);
            places.sort_by(f64::total_cmp);
            traced.extend(places.into_iter().map(|x| (x, delta.at(x))));
        }
        traced
    }

    /// Points of the curve between its `positions`: where sections meet, where δ or k is level, and at `further` places, rising. An event stands twice, as
    /// either side has it, also at a position.
    pub(in crate::analysis) fn points(
        &self,
        positions: &[f64],
        further: &[f64],
    ) -> Vec<CurvePoint> {
        let is_position = |place: f64| {
            let i = positions.partition_point(|position| *position < place - SAME_POSITION);
            positions
                .get(i)
                .is_some_and(|position| (position - place).abs() <= SAME_POSITION)
        };
        let each = self.sections.iter();
        let points = each.flat_map(|section| section.points(further));
        // The end of a curve that closes is its beginning.
        let is_over = |point: &CurvePoint| {
            self.span.closes && point.mesh_position >= self.span.end() - SAME_POSITION
        };
        let (mut rising, within): (Vec<_>, Vec<_>) = points.partition(is_over);
        for point in &mut rising {
            point.mesh_position = self.span.first;
        }
        rising.extend(within);
        rising.retain(|point| point.event.is_some() || !is_position(point.mesh_position));
        rising.dedup_by(|next, point| {
            next.event.is_none() && next.mesh_position - point.mesh_position <= SAME_POSITION
        });
        rising
    }

    /// Error of δ from its sampling at some positions only.
    pub(in crate::analysis) fn error(&self) -> SamplingError {
        let known = self.extremes(|section| section.delta);
        // Of all sections that may hold an extreme the one that leaves it open most.
        let open = |beyond: &dyn Fn(&Section) -> f64| {
            let each = self.sections.iter().map(beyond);
            each.fold(0.0, f64::max)
        };
        let low = open(&|section| {
            known[0].0 - section.extremes(|section| section.delta)[0].0 + section.open
        });
        let high = open(&|section| {
            section.extremes(|section| section.delta)[1].0 + section.open - known[1].0
        });
        let each = self.sections.iter();
        let area: f64 = each
            .map(|section| section.error * (section.to - section.from))
            .sum();
        SamplingError {
            mean: area / f64::from(self.span.periods),
            peak_to_peak: low + high + tolerance(known[1].0 - known[0].0),
        }
    }
}

impl Section {
    /// The smallest and the largest value of one of its curves.
    pub(super) fn extremes(&self, curve: fn(&Section) -> Cubic) -> Extremes {
        let curve = curve(self);
        let places = [self.from, self.to].into_iter();
        let places = places.chain(curve.level_within(self.from, self.to));
        let known = places.map(|place| [(curve.at(place), place); 2]);
        known.fold(NONE, wider)
    }

    /// Its ends, the places at which δ or k is level, and the `further` ones in it, rising.
    fn points(&self, further: &[f64]) -> Vec<CurvePoint> {
        let Self { from, to, .. } = *self;
        if from >= to {
            return Vec::new();
        }
        let further = further.iter().copied();
        let further = further.filter(|place| from < *place && *place < to);
        let level = self.delta.level_within(from, to);
        let level = level.chain(self.stiffness.level_within(from, to));
        let mut places: Vec<f64> = level.chain(further).collect();
        places.sort_by(f64::total_cmp);
        let [begins, ends] = self.events;
        let begin = (from, begins.then_some(EventSide::Behind));
        let end = (to, ends.then_some(EventSide::Before));
        let within = places.into_iter().map(|place| (place, None));
        let all = std::iter::once(begin).chain(within).chain([end]);
        all.map(|(place, event)| CurvePoint {
            mesh_position: place,
            transmission_error: self.delta.at(place),
            mesh_stiffness_tangent: self.stiffness.at(place),
            event,
        })
        .collect()
    }
}

/// The mean torque of the driver over r_b1, over that part of `span` which lies between `samples`, on straight lines from one to the next.
fn mean_driving_load(span: Span, samples: &[Sample]) -> f64 {
    let (mut sum, mut length) = (0.0, 0.0);
    for pair in samples.windows(2) {
        let nodes = [0, 1].map(|i| (pair[i].position, pair[i].driving_load));
        let [from, to] = nodes.map(|(place, _)| place.clamp(span.first, span.end()));
        if from < to {
            sum += (to - from) * Cubic::through(&nodes).at(f64::midpoint(from, to));
            length += to - from;
        }
    }
    sum / length
}

/// `samples` of a curve over `span`, and where it closes some more on either side of it.
fn overlapping(span: Span, samples: &[Sample]) -> Vec<Sample> {
    if !span.closes {
        return samples.to_vec();
    }
    let periods = i64::from(span.periods);
    let count = samples.len();
    let overlap = OVERLAP.min(count);
    let before = samples[count - overlap..]
        .iter()
        .map(|sample| sample.later(-periods));
    let after = samples[..overlap]
        .iter()
        .map(|sample| sample.later(periods));
    before.chain(samples.iter().cloned()).chain(after).collect()
}

/// The events between `samples`, with δ at each; neighbors within `close` of each other are close.
fn with_values(samples: &[Sample], close: f64) -> Vec<Event> {
    let mut found = Vec::new();
    for after in 0..samples.len().saturating_sub(1) {
        let places = events(samples, after).into_iter();
        found.extend(places.map(|place| Event {
            at: place.at,
            is_known: place.is_known,
            after,
            delta: [0.0; 2],
            error: 0.0,
            open: 0.0,
        }));
    }
    let firsts: Vec<usize> = found.iter().map(|event| event.after + 1).collect();
    for (i, event) in found.iter_mut().enumerate() {
        let begins = i.checked_sub(1).map_or(0, |before| firsts[before]);
        let ends = firsts.get(i + 1).copied().unwrap_or(samples.len());
        let beside = [&samples[event.after], &samples[event.after + 1]];
        let beside = beside.map(|sample| (sample.position, sample.transmission_error));
        let before = Side::of(samples[begins..=event.after].iter().rev(), event.at);
        let behind = Side::of(samples[event.after + 1..ends].iter(), event.at);
        event.settle(beside, (before, behind), close);
    }
    found
}

impl Event {
    /// Moves it to the intersection of both sides, if that is near, and returns δ there; `beside` are the samples next to it, which are close within `close`.
    fn settle(
        &mut self,
        beside: [(f64, f64); 2],
        (before, behind): (Option<Side>, Option<Side>),
        close: f64,
    ) {
        let [from, to] = beside;
        let unknown = UNKNOWN * (to.1 - from.1).abs();
        let (Some(before), Some(behind)) = (&before, &behind) else {
            let known = before.or(behind).map(|side| side.curve);
            let curve = known.unwrap_or_else(|| Cubic::through(&beside));
            (self.delta, self.error) = ([curve.at(self.at); 2], unknown);
            self.open = unknown;
            return;
        };
        let apart = |at: f64| before.curve.at(at) - behind.curve.at(at);
        let width = to.0 - from.0;
        if width < JUMP {
            self.delta = [before, behind].map(|side| side.curve.at(self.at));
            return;
        }
        let (a, b) = (before.weight(), behind.weight());
        let of_sides = (a * before.error + b * behind.error) / (a + b);
        self.error = apart(self.at).abs() * a.min(b) / (a + b);
        self.open = of_sides.max(self.error);
        // A step of the secant over a small part of the way.
        let step = NEARBY * width;
        let rate = (apart(self.at + step) - apart(self.at - step)) / (2.0 * step);
        let met = self.at - apart(self.at) / rate;
        let is_open = !self.is_known && width < close;
        let is_near = is_open || (met - self.at).abs() < 2.0 * step;
        if is_near && from.0 < met && met < to.0 {
            self.at = met;
        }
        let [one, other] = [before, behind].map(|side| side.curve.at(self.at));
        self.delta = [(a * one + b * other) / (a + b); 2];
    }
}

/// δ as the samples on one side of an event have it.
struct Side {
    /// Through the nearest of them.
    curve: Cubic,
    /// How far it is to be relied on: by how many it goes through.
    reliability: f64,
    /// How far from the event the nearest is.
    distance: f64,
    /// By how much the curve differs there from that through one sample less; 0 where there is only one.
    error: f64,
}

impl Side {
    /// Polynomial of `samples`, the nearest to `place` first.
    fn of<'a>(samples: impl Iterator<Item = &'a Sample>, place: f64) -> Option<Self> {
        const RELIABILITIES: [f64; 3] = [0.03, 0.3, 1.0];
        let mut nodes: Vec<(f64, f64)> = Vec::with_capacity(RELIABILITIES.len());
        for sample in samples {
            // The difference of nodes that stand close together is mostly rounding.
            let apart = match (nodes.first(), nodes.last()) {
                (Some(first), Some(last)) => {
                    (sample.position - last.0).abs() >= 0.5 * (first.0 - place).abs()
                }
                _ => true,
            };
            if apart {
                nodes.push((sample.position, sample.transmission_error));
            }
            if nodes.len() == RELIABILITIES.len() {
                break;
            }
        }
        let distance = (nodes.first()?.0 - place).abs();
        let curve = Cubic::through(&nodes);
        let fewer = Cubic::through(&nodes[..(nodes.len() - 1).max(1)]);
        Some(Self {
            distance,
            reliability: RELIABILITIES[nodes.len() - 1],
            error: (curve.at(place) - fewer.at(place)).abs(),
            curve,
        })
    }

    /// How much it counts beside the other side.
    fn weight(&self) -> f64 {
        self.reliability / self.distance.max(1e-9).powi(2)
    }
}

/// Adds the sections between two events, with those of all samples that stand there.
fn add_piece(
    sections: &mut Vec<Section>,
    begins: Option<&Event>,
    (all, range): (&[Sample], Range<usize>),
    ends: Option<&Event>,
) {
    let samples = &all[range.clone()];
    let of_event = |event: &Event, side: usize| (event.at, event.delta[side]);
    let of_sample = |sample: &Sample| (sample.position, sample.transmission_error);
    let begin = begins.map(|event| of_event(event, 1)).into_iter();
    let nodes: Vec<(f64, f64)> = begin
        .chain(samples.iter().map(of_sample))
        .chain(ends.map(|event| of_event(event, 0)))
        .collect();
    // Where no sample stands between two events, k goes from that before them to that after them.
    let around = if range.is_empty() {
        &all[range.start - 1..=range.start]
    } else {
        samples
    };
    let stiffness = around
        .iter()
        .map(|sample| (sample.position, sample.stiffness));
    let stiffness: Vec<(f64, f64)> = stiffness.collect();
    let last = nodes.len().saturating_sub(2);
    for (i, pair) in nodes.windows(2).enumerate() {
        let events = [i == 0 && begins.is_some(), i == last && ends.is_some()];
        let beside = [(events[0], begins), (events[1], ends)];
        let beside = beside.iter().filter(|(is_beside, _)| *is_beside);
        let of_events: Vec<&Event> = beside.filter_map(|(_, event)| *event).collect();
        let (delta, error, open) = curve_of(&nodes, i);
        let first = if range.is_empty() {
            Some(0)
        } else {
            i.checked_sub(usize::from(begins.is_some()))
        };
        sections.push(Section {
            from: pair[0].0,
            to: pair[1].0,
            events,
            delta,
            stiffness: stiffness_of(&stiffness, first, (pair[0].0, pair[1].0)),
            error: of_events
                .iter()
                .fold(error, |most, event| most.max(event.error)),
            open: of_events
                .iter()
                .fold(open, |most, event| most.max(event.open)),
        });
    }
}

/// The curve of δ between the nodes `i` and `i + 1`, by how much others through the nodes beside differ from it, and the same with those through a node less.
///
/// Between two nodes that are no events a curve has an extreme that is smooth, on which polynomials through other nodes agree. A cubic whose nodes lie on both sides of
/// a kink, or two of whose nodes are an event and a position beside it, swings in their place: then the one that goes least beyond both ends is taken.
fn curve_of(nodes: &[(f64, f64)], i: usize) -> (Cubic, f64, f64) {
    let ends = [nodes[i], nodes[i + 1]];
    let middle = f64::midpoint(ends[0].0, ends[1].0);
    let degree = (nodes.len() - 1).min(3);
    // Windows of `count` nodes that hold both, that with as many on either side first.
    let windows = |count: usize| {
        let first = (i + 2).saturating_sub(count);
        let last = i.min(nodes.len() - count);
        let even = (i + 1).saturating_sub(count / 2).clamp(first, last);
        let others = (first..=last).filter(move |start| *start != even);
        std::iter::once(even)
            .chain(others)
            .map(move |start| Cubic::through(&nodes[start..start + count]))
    };
    let found: Vec<Cubic> = windows(degree + 1).collect();
    let lower = (degree > 2).then(|| windows(degree)).into_iter().flatten();
    let least = found
        .iter()
        .copied()
        .chain(lower)
        .map(|curve| (curve, beyond(&curve, ends)));
    let least = least.reduce(|least, next| if next.1 < least.1 { next } else { least });
    let even = found[0];
    let curve = match least {
        Some((curve, swing)) if beyond(&even, ends) > SWING * swing + TOLERANCE.1 => curve,
        _ => even,
    };
    let difference = |other: Cubic| (other.at(middle) - even.at(middle)).abs();
    let lower = || windows(degree).map(difference);
    let error = match (found.len(), degree) {
        (1, 0 | 1) => UNKNOWN * (ends[1].1 - ends[0].1).abs(),
        (1, _) => LOWER_DEGREE * lower().fold(0.0, f64::max),
        _ => found.iter().copied().map(difference).fold(0.0, f64::max),
    };
    let open = match found.len() {
        1 => error,
        // One through two nodes that stand close together swings.
        _ => error.max(LOWER_DEGREE * lower().fold(f64::INFINITY, f64::min)),
    };
    (curve, error, open)
}

/// How far `curve` goes beyond both of its `ends` between them.
fn beyond(curve: &Cubic, [from, to]: [(f64, f64); 2]) -> f64 {
    let (low, high) = (from.1.min(to.1), from.1.max(to.1));
    let level = curve.level_within(from.0, to.0).map(|x| curve.at(x));
    level.fold(0.0, |most, value| most.max(value - high).max(low - value))
}

/// The curve of k on the section `within`, which begins with the sample `first` of a piece or, where there is none, with an event.
///
/// Between samples it is a cubic that rises and falls with them: k has steps of some thousandths, as one cell more touches or one less, and a
/// cubic through such steps would swing. From the last sample to an event the line of the last two goes on.
fn stiffness_of(samples: &[(f64, f64)], first: Option<usize>, within: (f64, f64)) -> Cubic {
    let secant = |i: usize| {
        let (a, b) = (samples[i], samples[i + 1]);
        (b.1 - a.1) / (b.0 - a.0)
    };
    let slope = |i: usize| match (
        i.checked_sub(1).map(secant),
        (i + 1 < samples.len()).then(|| secant(i)),
    ) {
        (Some(before), Some(after)) if before * after > 0.0 => {
            2.0 * before * after / (before + after)
        }
        (Some(_), Some(_)) | (None, None) => 0.0,
        (Some(only), None) | (None, Some(only)) => only,
    };
    let last = samples.len() - 1;
    let width = within.1 - within.0;
    match first {
        None => line(samples[0], samples[1..].iter(), width),
        Some(first) if first == last => line(samples[last], samples[..last].iter().rev(), width),
        Some(first) => {
            let ends = [samples[first], samples[first + 1]];
            Cubic::hermite(ends, [slope(first), slope(first + 1)])
        }
    }
}

/// The line through `near` and the first of the `others` that is no nearer to it than `width`.
fn line<'a>(
    near: (f64, f64),
    mut others: impl Iterator<Item = &'a (f64, f64)>,
    width: f64,
) -> Cubic {
    match others.find(|other| (other.0 - near.0).abs() >= width) {
        Some(&other) => Cubic::through(&[near, other]),
        None => Cubic::through(&[near]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest value of the curve between the nodes `i` and `i + 1`.
    fn largest(nodes: &[(f64, f64)], i: usize) -> f64 {
        let (curve, ..) = curve_of(nodes, i);
        let within = curve.level_within(nodes[i].0, nodes[i + 1].0);
        let ends = [nodes[i].0, nodes[i + 1].0].into_iter();
        let values = ends.chain(within).map(|x| curve.at(x));
        values.fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn a_curve_does_not_swing_beyond_a_position_beside_an_event() {
        // The event stands a thousandth before a position, and is a hundredth of the values off: a cubic through both would rise by 0.5 beyond.
        let nodes = [
            (0.749, 9.9e-6),
            (0.75, 10e-6),
            (0.83, 9.9e-6),
            (0.91, 9.8e-6),
            (0.99, 9.7e-6),
        ];
        assert!(largest(&nodes, 1) < 10.01e-6, "{:e}", largest(&nodes, 1));
        // Nor where it lies level before a flank that rises steeply from one position on.
        let nodes = [
            (0.0, 3e-6),
            (0.1, 1.1e-6),
            (0.2, 1e-6),
            (0.3, 1e-6),
            (0.35, 4e-6),
        ];
        let (curve, error, _) = curve_of(&nodes, 2);
        assert!(curve.at(0.25) > 0.98e-6 && error > 0.1e-6, "{error:e}");
    }

    #[test]
    fn an_extreme_on_which_all_polynomials_agree_stays_beyond_the_positions() {
        // A crest of a sine, ten positions in its period.
        let sine = |i: i32| {
            (
                f64::from(i) * 0.1,
                1e-6 * (0.2 * f64::from(i) * std::f64::consts::PI).sin(),
            )
        };
        let nodes: Vec<(f64, f64)> = (0..10).map(sine).collect();
        let found = largest(&nodes, 2);
        assert!((found / 1e-6 - 1.0).abs() < 4e-3, "{found:e}");
        assert!(found > 1.04 * nodes[2].1);
    }
}
