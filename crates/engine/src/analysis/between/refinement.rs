//! Further positions, where a curve is least known.

use super::sections::{Extremes, Section, Sections, tolerance};
use super::{Sample, Span};
use crate::analysis::Case;

/// Factor of the tolerance of δ away from the extremes: its effect on mean, rms and harmonics is far smaller.
const ELSEWHERE: f64 = 5.0;

/// A further position stands no nearer to another one than this part of their step.
const NEAREST: f64 = 1.0 / 32.0;

/// Fractions of the mesh period that are chosen in one round stand no nearer to each other than this part of a step: events of different mesh periods that
/// are nearer are looked for at one of them.
const APART: f64 = 1.0 / 8.0;

/// An extreme at an event is believed once a position stands within this part of a step of it: from farther away both sides of an event may
/// well agree about a wrong place. Until then it counts as one if it is within this part of the peak-to-peak of an extreme.
const BELIEVED: (f64, f64) = (1.0 / 16.0, 0.02);

/// Shares of the remaining fractions that each round may use: later rounds have more evidence.
const ROUNDS: [f64; 5] = [0.4, 0.4, 0.5, 0.7, 1.0];

/// Further positions that any curve may have, and how many it may have for each of its own.
const FURTHER: (usize, f64) = (20, 0.2);

/// Further positions that each mesh period may have: four for each of its two events, as one pair takes up the load and another one leaves it.
const FURTHER_AT_EVENTS: usize = 2 * 4;

/// Further fractions at extremes that are still open then, each solved by itself: an extreme may stand beside a fraction that was chosen for an event of another
/// mesh period.
const AT_EXTREMES: usize = 2;

/// Refinement of a curve between its positions.
///
/// A fraction of the mesh period that is solved further is solved in all mesh periods of the curve. What the refinement adds is then nearly the same in each, so it
/// consists of mesh orders; if it were added in some periods alone, it would show in the orders of holes and of revolutions. Besides, the common part of a pair
/// is computed once for all positions of a fraction.
pub(in crate::analysis) struct Refinement {
    span: Span,
    /// Positions that may be solved further.
    most: usize,
    /// The mesh periods after which contact repeats: a position solved in the first of them is solved in all later ones.
    repeats_after: u32,
    /// The parts of a step of which further positions are whole multiples, if they are.
    lattice: Option<u32>,
}

/// Largest number of further positions solved for a curve with a given number, over the mesh `periods` after which contact repeats: the end of a span that closes
/// nowhere, and whole fractions in each of these mesh periods.
pub(in crate::analysis) fn most_further(positions: usize, periods: u32) -> usize {
    let of_positions = (FURTHER.1 * positions as f64) as usize;
    let at_events = FURTHER_AT_EVENTS * periods as usize + 1;
    FURTHER.0.max(of_positions).max(at_events) + AT_EXTREMES * periods as usize
}

/// A position at which the curve is little known.
struct Candidate {
    position: f64,
    priority: f64,
}

impl Refinement {
    /// Refinement of a curve of `case` whose contacts repeat after a number of mesh periods and are known at the number `positions`.
    pub(in crate::analysis) fn of(case: &Case, repeats_after: u32, positions: usize) -> Self {
        Self {
            span: Span::of(case),
            most: most_further(positions, repeats_after),
            repeats_after,
            lattice: None,
        }
    }

    /// The same with further positions at whole multiples of a part of a step.
    pub(in crate::analysis) fn on(self, lattice: Option<u32>) -> Self {
        Self { lattice, ..self }
    }

    /// The sections of the curve through `samples`, and through the further positions that `solve` computes. These lie in the first of the mesh periods after
    /// which contact repeats, and count for all.
    ///
    /// # Errors
    ///
    /// Errors of `solve`.
    pub(in crate::analysis) fn sections<E>(
        &self,
        mut samples: Vec<Sample>,
        mut solve: impl FnMut(&[f64]) -> Result<Vec<Sample>, E>,
    ) -> Result<Sections, E> {
        let mut left = self.most;
        let end = self.span.end();
        if !self.span.closes && left > 0 {
            // Its last step ends beside its last position.
            samples.extend(
                solve(&[end])?
                    .into_iter()
                    .filter(|sample| sample.position <= end),
            );
            left -= 1;
        }
        let fractions = left / self.repeats_after as usize;
        let at_extremes = AT_EXTREMES.min(fractions);
        let mut left = fractions - at_extremes;
        let mut sections = Sections::new(self.span, &samples);
        // How many fractions were solved.
        let mut refine = |sections: &mut Sections, open: Vec<Candidate>, most| {
            let fractions = self.chosen(open, &samples, most);
            if !fractions.is_empty() {
                samples.extend(solve(&self.in_each_period(&fractions, &samples))?);
                samples.sort_by(|a, b| a.position.total_cmp(&b.position));
                *sections = Sections::new(self.span, &samples);
            }
            Ok(fractions.len())
        };
        for part in ROUNDS {
            let most = (part * left as f64).ceil() as usize;
            let open = candidates(&sections);
            match refine(&mut sections, open, most)? {
                0 => break,
                solved => left -= solved,
            }
        }
        for _ in 0..at_extremes {
            let (open, _) = open_extremes(&sections);
            if refine(&mut sections, open, 1)? == 0 {
                break;
            }
        }
        Ok(sections)
    }

    /// Where a candidate stands, counted from the first position, in the mesh periods after which contact repeats.
    fn place(&self, candidate: &Candidate) -> f64 {
        let place = candidate.position - self.span.first;
        let place = place.rem_euclid(f64::from(self.repeats_after));
        self.span.on_lattice(place, self.lattice)
    }

    /// At most `most` fractions of the mesh period at which `candidates` stand, those of the most urgent first, none of them beside a sample.
    fn chosen(&self, mut candidates: Vec<Candidate>, samples: &[Sample], most: usize) -> Vec<f64> {
        candidates.sort_by(|a, b| {
            let urgent = b.priority.total_cmp(&a.priority);
            urgent.then(a.position.total_cmp(&b.position))
        });
        let (first, step) = (self.span.first, self.span.step());
        let mut chosen: Vec<f64> = Vec::new();
        for candidate in candidates {
            if chosen.len() == most {
                break;
            }
            let place = self.place(&candidate);
            let fraction = place.rem_euclid(1.0);
            let is_near = |other: &f64| (other - fraction).abs() <= APART * step;
            if !chosen.iter().any(is_near) && !self.is_beside(first + place, samples) {
                chosen.push(fraction);
            }
        }
        chosen
    }

    /// True if `position` stands beside one of `samples` or outside the mesh periods after which contact repeats.
    fn is_beside(&self, position: f64, samples: &[Sample]) -> bool {
        let end = self.span.first + f64::from(self.repeats_after);
        let nearest = NEAREST * self.span.step();
        let i = samples.partition_point(|sample| sample.position < position);
        let mut neighbors = samples[i.saturating_sub(1)..].iter().take(2);
        neighbors.any(|sample| (sample.position - position).abs() < nearest)
            || !(self.span.first..end).contains(&position)
    }

    /// The positions at these fractions in each of the mesh periods after which contact repeats, rising, without those beside a sample.
    fn in_each_period(&self, fractions: &[f64], samples: &[Sample]) -> Vec<f64> {
        let all = fractions.iter().flat_map(|fraction| {
            let first = self.span.first + fraction;
            (0..self.repeats_after).map(move |later| first + f64::from(later))
        });
        let mut positions: Vec<f64> = all
            .filter(|position| !self.is_beside(*position, samples))
            .collect();
        positions.sort_by(f64::total_cmp);
        positions
    }
}

/// Where the curve of `sections` leaves most open.
fn candidates(sections: &Sections) -> Vec<Candidate> {
    let (mut candidates, are_extreme) = open_extremes(sections);
    let [(low, _), (high, _)] = sections.extremes(|section| section.delta);
    let tolerance = tolerance(high - low);
    let others = sections.sections.iter().zip(are_extreme);
    candidates.extend(others.filter_map(|(section, is_extreme)| {
        let urgency = section.error / tolerance;
        (!is_extreme && urgency > ELSEWHERE).then(|| Candidate {
            position: section.look(section.middle()),
            priority: urgency * (section.to - section.from) / sections.span.step(),
        })
    }));
    candidates.extend(candidates_for_stiffness(sections));
    candidates
}

/// Where the extremes of δ are open, with and without its slow wave, and of which sections those with it are.
fn open_extremes(sections: &Sections) -> (Vec<Candidate>, Vec<bool>) {
    let mut candidates = Vec::new();
    let are_extreme = add_extremes(&mut candidates, sections, 1e3, |_| 0.0);
    if let Some(long) = sections.long_wave() {
        add_extremes(&mut candidates, sections, 5e2, |place| long.at(place));
    }
    (candidates, are_extreme)
}

/// Adds to `candidates`, with this `priority`, where the extremes of δ less a slow `wave` are open, and tells of which sections they are.
fn add_extremes(
    candidates: &mut Vec<Candidate>,
    sections: &Sections,
    priority: f64,
    wave: impl Fn(f64) -> f64,
) -> Vec<bool> {
    let extremes_of = |section: &Section| {
        let extremes = section.extremes(|section| section.delta);
        extremes.map(|(value, place)| (value - wave(place), place))
    };
    let all: Vec<Extremes> = sections.sections.iter().map(extremes_of).collect();
    let low = all
        .iter()
        .map(|[low, _]| low.0)
        .fold(f64::INFINITY, f64::min);
    let high = all
        .iter()
        .map(|[_, high]| high.0)
        .fold(f64::NEG_INFINITY, f64::max);
    let tolerance = tolerance(high - low);
    let mut are_extreme = Vec::with_capacity(all.len());
    for (i, (section, extremes)) in sections.sections.iter().zip(all).enumerate() {
        let urgency = section.error / tolerance;
        let beyond = [low - extremes[0].0, extremes[1].0 - high];
        let mut is_extreme = false;
        for ((_, place), beyond) in extremes.into_iter().zip(beyond) {
            let doubted = sections.is_doubted(i, place);
            let slack = if doubted {
                BELIEVED.1 * (high - low)
            } else {
                0.5 * tolerance
            };
            if (doubted || urgency > 0.5) && beyond + 2.0 * section.error + slack >= 0.0 {
                is_extreme = true;
                candidates.push(Candidate {
                    position: section.look(place),
                    priority: priority + urgency,
                });
            }
        }
        are_extreme.push(is_extreme);
    }
    are_extreme
}

/// Where the extremes of k are read off a line that goes on to an event from far away, and between two events without a position, where other pairs carry
/// and nothing is known of k.
fn candidates_for_stiffness(sections: &Sections) -> Vec<Candidate> {
    let stiffness = |section: &Section| section.stiffness;
    let known = sections.extremes(stiffness);
    let far = 2.0 * BELIEVED.0 * sections.span.step();
    let open = sections.sections.iter().filter(|section| {
        let extremes = section.extremes(stiffness);
        let is_extreme = extremes[0].0 <= known[0].0 || extremes[1].0 >= known[1].0;
        let is_open = match section.events {
            [false, false] => false,
            [true, true] => true,
            _ => is_extreme,
        };
        is_open && section.to - section.from > far
    });
    let beside = |section: &Section| {
        let away = 0.5 * far;
        match section.events {
            [true, true] => section.middle(),
            [true, false] => section.from + away,
            _ => section.to - away,
        }
    };
    open.map(|section| Candidate {
        position: beside(section),
        priority: 1e2,
    })
    .collect()
}

impl Sections {
    /// True if `place` is an event at an end of section `i` without a position near it.
    fn is_doubted(&self, i: usize, place: f64) -> bool {
        let width = |section: &Section| section.to - section.from;
        let section = &self.sections[i];
        let other = match section.events {
            [true, _] if place == section.from => i.checked_sub(1),
            [_, true] if place == section.to => Some(i + 1),
            _ => return false,
        };
        let other = other.and_then(|other| self.sections.get(other));
        let nearest = other.map_or(f64::INFINITY, width).min(width(section));
        nearest > BELIEVED.0 * self.span.step()
    }
}

impl Section {
    fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }

    /// Position at which to evaluate it for `place`: there, or in the middle where a position is known there.
    fn look(&self, place: f64) -> f64 {
        let is_known =
            (place == self.from && !self.events[0]) || (place == self.to && !self.events[1]);
        if is_known { self.middle() } else { place }
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::super::PairState;
    use super::*;

    /// Pairs that are springs, with gaps that grow beside the middle of their path: linear beside its ends, and as a parabola along it.
    ///
    /// With the gaps g of the pairs that touch, δ = (F/k + Σ g)/n over the n of them whose gap is less than δ.
    fn sample(position: f64) -> Sample {
        const LOAD: f64 = 2000.0;
        const STIFFNESS: f64 = 2e8;
        let gap = |n: i64| {
            let phase = position - n as f64;
            let ends = 5e-5 * (-0.1 - phase).max(0.0) + 4e-5 * (phase - 0.8).max(0.0);
            ends + 2e-6 * (phase - 0.4).powi(2)
        };
        let first = position.floor() as i64;
        let pairs: Vec<(i64, f64)> = (first - 2..=first + 3).map(|n| (n, gap(n))).collect();
        let mut touching = 0;
        let mut rising = pairs.clone();
        rising.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut delta = f64::INFINITY;
        let mut sum = 0.0;
        for &(_, gap) in &rising {
            if gap >= delta {
                break;
            }
            touching += 1;
            sum += gap;
            delta = LOAD / STIFFNESS / f64::from(touching) + sum / f64::from(touching);
        }
        let states = pairs.iter().map(|&(pair, gap)| PairState {
            pair,
            share: (STIFFNESS * (delta - gap) / LOAD).max(0.0),
            clearance: (gap >= delta).then_some(gap - delta),
        });
        Sample {
            position,
            transmission_error: delta,
            stiffness: STIFFNESS * f64::from(touching),
            driving_load: LOAD,
            pairs: states.collect(),
        }
    }

    #[test]
    fn further_positions_stand_on_the_lattice_that_is_asked_for() {
        const PARTS: u32 = 4;
        let span = span(10, 3, true);
        let refinement = Refinement {
            span,
            most: most_further(30, 3),
            repeats_after: 3,
            lattice: Some(PARTS),
        };
        let samples = (0..30).map(|i| sample(f64::from(i) / 10.0)).collect();
        let mut solved = 0;
        let sections = refinement.sections(samples, |further| {
            solved += further.len();
            for position in further {
                let node = f64::from(10 * PARTS) * position;
                assert!((node - node.round()).abs() < 1e-9, "{position}");
            }
            Ok::<_, Infallible>(further.iter().copied().map(sample).collect())
        });
        assert!(sections.is_ok() && solved > 0);
    }

    fn span(per_period: u32, periods: u32, closes: bool) -> Span {
        Span {
            first: 0.0,
            periods,
            per_period,
            closes,
        }
    }

    fn refined(span: Span, most: usize) -> (Sections, usize) {
        let refinement = Refinement {
            span,
            most,
            repeats_after: span.periods,
            lattice: None,
        };
        let count = span.per_period * span.periods;
        let positions = (0..count).map(|i| f64::from(i) * span.step());
        let samples = positions.map(sample).collect();
        let mut solved = 0;
        let sections = refinement.sections(samples, |further| {
            solved += further.len();
            Ok::<_, Infallible>(further.iter().copied().map(sample).collect())
        });
        (sections.expect("nothing fails"), solved)
    }

    #[test]
    fn extremes_at_kinks_are_found_between_few_positions() {
        // The curve of springs in closed form, at 100,000 positions.
        let dense: Vec<f64> = (0..100_000)
            .map(|i| sample(f64::from(i) * 1e-5).transmission_error)
            .collect();
        let low = dense.iter().copied().fold(f64::INFINITY, f64::min);
        let high = dense.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = dense.iter().sum::<f64>() / dense.len() as f64;
        let square = dense
            .iter()
            .map(|delta| (delta - mean).powi(2))
            .sum::<f64>();
        let rms = (square / dense.len() as f64).sqrt();
        for (per_period, allowed) in [(10, 1e-2), (40, 2e-3)] {
            let (sections, solved) = refined(span(per_period, 1, true), most_further(10, 1));
            let [delta, stiffness] = sections.statistics();
            let even = (0..per_period).map(|i| sample(f64::from(i) / f64::from(per_period)));
            let even = even.map(|sample| sample.transmission_error);
            let missed = high - even.fold(f64::NEG_INFINITY, f64::max);
            assert!(
                missed > 3.0 * allowed * (high - low),
                "the positions step over the peak"
            );
            assert!((delta.peak_to_peak / (high - low) - 1.0).abs() < allowed);
            assert!((delta.largest - high).abs() < allowed * (high - low));
            assert!((delta.smallest - low).abs() < allowed * (high - low));
            assert!(
                (sample(delta.largest_at).transmission_error - high).abs() < allowed * (high - low)
            );
            assert!((delta.rms / rms - 1.0).abs() < 2.0 * allowed);
            assert!((delta.mean / mean - 1.0).abs() < 1e-3);
            let error = (delta.peak_to_peak - (high - low)).abs();
            assert!(error < 2.0 * sections.error().peak_to_peak);
            // One spring carries, or two.
            assert!((stiffness.smallest / 2e8 - 1.0).abs() < 1e-9);
            assert!((stiffness.largest / 4e8 - 1.0).abs() < 1e-9);
            assert!(solved <= most_further(10, 1));
        }
    }

    #[test]
    fn the_extremes_of_the_mesh_are_found_where_a_long_wave_hides_them_from_those_of_the_curve() {
        // The same springs on a wave over five mesh periods that is ten times as high.
        const PERIODS: u32 = 5;
        let short: Vec<f64> = (0..100_000)
            .map(|i| sample(f64::from(i) * 1e-5).transmission_error)
            .collect();
        let range = |values: &[f64]| {
            let [low, high] = [f64::min, f64::max].map(|pick| values.iter().copied().reduce(pick));
            high.expect("values") - low.expect("values")
        };
        let expected = range(&short);
        let turn = std::f64::consts::TAU / f64::from(PERIODS);
        let wave = |x: f64| 5.0 * expected * (turn * x).sin();
        let on_wave = |x: f64| {
            let of_mesh = sample(x);
            Sample {
                transmission_error: of_mesh.transmission_error + wave(x),
                ..of_mesh
            }
        };
        let span = span(20, PERIODS, true);
        let refinement = Refinement {
            span,
            most: most_further(20 * PERIODS as usize, PERIODS),
            repeats_after: PERIODS,
            lattice: None,
        };
        let samples = (0..20 * PERIODS)
            .map(|i| on_wave(f64::from(i) / 20.0))
            .collect();
        let sections = refinement.sections(samples, |further| {
            Ok::<_, Infallible>(further.iter().copied().map(on_wave).collect())
        });
        let traced = sections.expect("nothing fails").traced(400);
        let found: Vec<f64> = traced.iter().map(|(x, value)| value - wave(*x)).collect();
        // The tolerance of the curve is a thousandth of its range, ten of the mesh.
        assert!(
            (range(&found) / expected - 1.0).abs() < 0.01,
            "{} {expected}",
            range(&found)
        );
    }

    #[test]
    fn what_is_solved_further_adds_mesh_orders_alone() {
        // The springs over five mesh periods, on a wave of 0.1 nm over all of them, and nothing else below the order of the mesh.
        const PERIODS: u32 = 5;
        const WAVE: f64 = 1e-10;
        let turn = std::f64::consts::TAU / f64::from(PERIODS);
        let on_wave = |x: f64| {
            let of_mesh = sample(x);
            Sample {
                transmission_error: of_mesh.transmission_error + WAVE * (turn * x).sin(),
                ..of_mesh
            }
        };
        for per_period in [10, 12, 20] {
            let span = span(per_period, PERIODS, true);
            let count = per_period * PERIODS;
            let refinement = Refinement {
                span,
                most: most_further(count as usize, PERIODS),
                repeats_after: PERIODS,
                lattice: None,
            };
            let samples = (0..count).map(|i| on_wave(f64::from(i) * span.step()));
            let sections = refinement.sections(samples.collect(), |further| {
                Ok::<_, Infallible>(further.iter().copied().map(on_wave).collect())
            });
            let [delta, _] = sections.expect("nothing fails").resampled(2000);
            let lines = crate::fourier::harmonics(&delta);
            for (bin, expected) in [(1, WAVE), (2, 0.0), (3, 0.0), (4, 0.0)] {
                let amplitude = lines[bin - 1].0;
                assert!(
                    (amplitude - expected).abs() < 0.05 * WAVE,
                    "{per_period} positions, line {bin}: {amplitude:e}"
                );
            }
        }
    }

    #[test]
    fn an_event_of_which_no_pair_tells_stands_where_both_sides_of_it_meet() {
        // Before it δ rises on a line; behind it it falls on a parabola, on which a second pair takes up the load so that a line through two of its shares
        // says nothing.
        let event = 0.32;
        let curve = |x: f64| {
            let behind = (x - event).max(0.0);
            1e-6 * (1.0 + 0.1 * x - 2.0 * behind + 1.2 * behind * behind)
        };
        let state = |pair: i64, share: f64| PairState {
            pair,
            share,
            clearance: None,
        };
        let sample = |i: u32| {
            let position = f64::from(i) / 10.0;
            let taken = (0.3 * (position - event).max(0.0)).powf(0.2);
            Sample {
                position,
                transmission_error: curve(position),
                stiffness: 1e8,
                driving_load: 1e3,
                pairs: vec![state(0, 1.0 - taken), state(1, taken)],
            }
        };
        // Ten in a step of the curve.
        let samples: Vec<Sample> = (0..=10).map(sample).collect();
        let sections = Sections::new(span(1, 1, false), &samples);
        let [delta, _] = sections.statistics();
        // Remainder after a step of the secant, of 0.03.
        assert!((delta.largest_at - event).abs() < 1e-3, "{delta:?}");
        assert!((delta.largest / curve(event) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn k_is_looked_at_between_two_events_without_a_position() {
        // One pair leaves the load shortly after another one took it up, and in between three springs carry.
        let (takes_up, leaves) = (0.42, 0.47);
        let state = |pair: i64, ahead: f64| PairState {
            pair,
            share: ahead.max(0.0),
            clearance: (ahead <= 0.0).then_some(-ahead),
        };
        let sample = |position: f64| Sample {
            position,
            transmission_error: 1e-6 * (1.0 + 0.1 * (6.0 * (position - 0.2)).cos()),
            stiffness: if takes_up < position && position < leaves {
                3e8
            } else {
                2e8
            },
            driving_load: 1e3,
            pairs: vec![
                state(0, leaves - position),
                state(1, 1.0),
                state(2, position - takes_up),
            ],
        };
        let span = span(10, 1, false);
        let refinement = Refinement {
            span,
            most: most_further(10, 1),
            repeats_after: 1,
            lattice: None,
        };
        let samples = (0..10).map(|i| sample(f64::from(i) / 10.0)).collect();
        let sections = refinement.sections(samples, |further| {
            Ok::<_, Infallible>(further.iter().copied().map(sample).collect())
        });
        let [_, stiffness] = sections.expect("nothing fails").statistics();
        assert_eq!((stiffness.smallest, stiffness.largest), (2e8, 3e8));
    }

    #[test]
    fn a_span_that_closes_nowhere_ends_where_its_last_step_does() {
        let (sections, _) = refined(span(20, 1, false), 12);
        let (closed, _) = refined(span(20, 1, true), 12);
        let [open, closed] = [sections, closed].map(|sections| sections.statistics()[0]);
        assert!((open.mean / closed.mean - 1.0).abs() < 1e-3);
        assert!((open.peak_to_peak / closed.peak_to_peak - 1.0).abs() < 5e-3);
    }

    #[test]
    fn without_a_further_position_nothing_is_solved() {
        let (_, solved) = refined(span(40, 2, true), 0);
        assert_eq!(solved, 0);
    }
}
