//! Further positions, where they tell most of a curve.

use super::sections::{Section, Sections};
use super::{Sample, Span};
use crate::analysis::Case;

/// What the positions between are to tell of δ: its extremes to this part of its peak-to-peak, and no better than so many meters.
const TOLERANCE: (f64, f64) = (1e-3, 1e-10);

/// Away from the extremes δ may be off by so many tolerances: what is left of that in mean, rms and harmonics is far less.
const ELSEWHERE: f64 = 5.0;

/// A further position stands no nearer to another one than this part of their step.
const NEAREST: f64 = 1.0 / 32.0;

/// Further positions of different mesh periods whose fractions differ by no more than this part of a step share a fraction: what a pair has in
/// common there is found once.
const SHARED: f64 = 1.0 / 8.0;

/// The parts of what is left that may be asked for at once, round by round: later rounds know better.
const ROUNDS: [f64; 4] = [0.5, 0.5, 0.7, 1.0];

/// Further positions that any curve may have, and how many it may have for each of its own.
const FURTHER: (usize, f64) = (12, 0.2);

/// How a curve is looked at between its positions.
pub(in crate::analysis) struct Refinement {
    span: Span,
    /// Positions that may be solved further.
    most: usize,
    /// Whether contact repeats with the mesh period, so that a position solved in the first tells of all later ones.
    repeats: bool,
}

/// How many positions are solved further at most for a curve of so many.
pub(in crate::analysis) fn most_further(positions: usize) -> usize {
    FURTHER.0.max((FURTHER.1 * positions as f64) as usize)
}

/// A position that is worth to be solved.
struct Wanted {
    position: f64,
    priority: f64,
}

impl Refinement {
    /// That of a curve of `case` whose contacts are known at `positions`: all of it, or those after which they repeat.
    pub(in crate::analysis) fn of(case: &Case, positions: usize) -> Self {
        Self {
            span: Span::of(case),
            most: most_further(positions),
            repeats: positions < case.positions(),
        }
    }

    /// The sections of the curve through `samples`, and through what `solve` finds further at the mesh positions that it is given; where contact
    /// repeats they lie in the first mesh period, and it answers for all.
    ///
    /// # Errors
    ///
    /// Those of `solve`.
    pub(in crate::analysis) fn sections<E>(
        &self,
        mut samples: Vec<Sample>,
        mut solve: impl FnMut(&[f64]) -> Result<Vec<Sample>, E>,
    ) -> Result<Sections, E> {
        let mut left = self.most;
        let end = self.span.end();
        if !self.span.closes && left > 0 {
            // Its last step ends beside its last position.
            samples.extend(solve(&[end])?.into_iter().filter(|sample| sample.position <= end));
            left -= 1;
        }
        let mut sections = Sections::new(self.span, &samples);
        for part in ROUNDS {
            let most = (part * left as f64).ceil() as usize;
            let positions = self.chosen(wanted(&sections), &samples, most);
            if positions.is_empty() {
                break;
            }
            left -= positions.len();
            samples.extend(solve(&positions)?);
            samples.sort_by(|a, b| a.position.total_cmp(&b.position));
            sections = Sections::new(self.span, &samples);
        }
        Ok(sections)
    }

    /// At most `most` of the `wanted` positions, the most urgent first, none of them beside a sample.
    fn chosen(&self, mut wanted: Vec<Wanted>, samples: &[Sample], most: usize) -> Vec<f64> {
        wanted.sort_by(|a, b| {
            let urgent = b.priority.total_cmp(&a.priority);
            urgent.then(a.position.total_cmp(&b.position))
        });
        let (first, step) = (self.span.first, self.span.step());
        let mut fractions: Vec<f64> = Vec::new();
        let mut chosen: Vec<f64> = Vec::new();
        for Wanted { position, .. } in wanted {
            if chosen.len() == most {
                break;
            }
            let fraction = (position - first).rem_euclid(1.0);
            let near = |other: &&f64| (*other - fraction).abs() <= SHARED * step;
            let known = fractions.iter().find(near).copied();
            let place = match known {
                Some(_) if self.repeats => continue,
                Some(known) => position + (known - fraction),
                None if self.repeats => first + fraction,
                None => position,
            };
            let beside = |other: f64| (other - place).abs() < NEAREST * step;
            let i = samples.partition_point(|sample| sample.position < place);
            let neighbors = samples[i.saturating_sub(1)..].iter().take(2);
            if neighbors.map(|sample| sample.position).any(beside)
                || chosen.iter().copied().any(beside)
                || !(first..self.span.end()).contains(&place)
            {
                continue;
            }
            if known.is_none() {
                fractions.push(fraction);
            }
            chosen.push(place);
        }
        chosen.sort_by(f64::total_cmp);
        chosen
    }
}

/// Where the curve of `sections` leaves most open.
fn wanted(sections: &Sections) -> Vec<Wanted> {
    let delta = |section: &Section| section.delta;
    let [(low, _), (high, _)] = sections.extremes(delta);
    let tolerance = (TOLERANCE.0 * (high - low)).max(TOLERANCE.1);
    let mut wanted = Vec::new();
    for section in &sections.sections {
        let urgency = section.error / tolerance;
        let extremes = section.extremes(delta);
        let beyond = [low - extremes[0].0, extremes[1].0 - high];
        let mut is_extreme = false;
        for ((_, place), beyond) in extremes.into_iter().zip(beyond) {
            if urgency > 0.5 && beyond + 2.0 * section.error + 0.5 * tolerance >= 0.0 {
                is_extreme = true;
                wanted.push(Wanted {
                    position: section.look(place),
                    priority: 1e3 + urgency,
                });
            }
        }
        if !is_extreme && urgency > ELSEWHERE {
            wanted.push(Wanted {
                position: section.look(section.middle()),
                priority: urgency * (section.to - section.from) / sections.span.step(),
            });
        }
    }
    wanted.extend(wanted_of_stiffness(sections));
    wanted
}

/// Where the extremes of k are read off a line that goes on to an event from far away.
fn wanted_of_stiffness(sections: &Sections) -> Vec<Wanted> {
    let stiffness = |section: &Section| section.stiffness;
    let known = sections.extremes(stiffness);
    let far = 0.25 * sections.span.step();
    let open = sections.sections.iter().filter(|section| {
        let extremes = section.extremes(stiffness);
        let is_extreme = extremes[0].0 <= known[0].0 || extremes[1].0 >= known[1].0;
        is_extreme && section.events.contains(&true) && section.to - section.from > far
    });
    let beside = |section: &Section| {
        let away = 0.25 * (section.to - section.from);
        if section.events[0] { section.from + away } else { section.to - away }
    };
    open.map(|section| Wanted {
        position: beside(section),
        priority: 1e2,
    })
    .collect()
}

impl Section {
    fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }

    /// Where to look in it for what stands at `place`: there, or in the middle where a position is known there.
    fn look(&self, place: f64) -> f64 {
        let is_known = (place == self.from && !self.events[0]) || (place == self.to && !self.events[1]);
        if is_known { self.middle() } else { place }
    }
}
