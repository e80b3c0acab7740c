//! Which designs to compute next.
//!
//! One goal is searched by CMA-ES, several by an evolution of the front (MODE with the update of NSGA-II), both of the crate fcmaes. Either begins
//! with points that fill the cube evenly. CMA-ES goes on from the best of them and learns in which directions goals fall; once it has settled, another
//! one begins elsewhere with twice as many points, as long as there are evaluations left.

use fcmaes_core::{Cmaes, CmaesParams, Fitness, Mode, ModeParams, Rng};
use meshwright_sample::REPLICATES;
use meshwright_sample::points::{Points, Sampling};

use crate::outcome::{Outcome, best};
use crate::space::{Axis, Known, count};

/// How widely CMA-ES looks around the point that it goes on from, as a part of each axis.
const FIRST_STEP: f64 = 0.2;

/// CMA-ES has settled when the designs of a generation differ by less than this part of each axis.
const SETTLED: f64 = 1e-3;

/// No violation weighs more than so much.
const HEAVIEST: f64 = 1e30;

/// What is searched.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The variables; at least one.
    pub axes: Vec<Axis>,
    /// The number of goals; at least one.
    pub goals: usize,
    /// The number of conditions.
    pub conditions: usize,
    /// So many designs are computed at most.
    pub evaluations: u32,
    /// What everything random is drawn from.
    pub seed: u32,
    /// A design to begin with.
    pub start: Option<Vec<f64>>,
}

/// A search under way.
pub struct Driver {
    problem: Problem,
    evolution: Evolution,
    /// Designs asked for.
    asked: u32,
    /// Points of the even beginning that have been used.
    spread: u32,
    known: Known,
    rng: Rng,
    pending: Vec<Vec<f64>>,
}

enum Evolution {
    /// So many evenly spread points are asked for.
    Beginning(usize),
    One(Box<Descent>),
    Several(Box<Mode>),
}

/// CMA-ES, and what conditions weigh in what it is told.
struct Descent {
    cmaes: Cmaes,
    size: usize,
    /// The points as CMA-ES asked for them, or as they were moved.
    told: Vec<Vec<f64>>,
    moved: bool,
    /// Whether the points that it asked for last hardly differ.
    is_narrow: bool,
    weights: Vec<f64>,
    /// Generations of it.
    generation: usize,
}

impl Driver {
    /// A search that has not begun.
    pub fn new(problem: Problem) -> Self {
        let size = problem.size();
        Self {
            evolution: Evolution::Beginning(size),
            asked: 0,
            spread: 0,
            known: Known::default(),
            rng: Rng::new(u64::from(problem.seed)),
            pending: Vec::new(),
            problem,
        }
    }

    /// The designs of the next generation; none once the search is over. Each call needs the outcomes of the one before.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        let left = (self.problem.evaluations - self.asked) as usize;
        if left == 0 || self.is_exhausted() {
            return Vec::new();
        }
        self.pending = match &mut self.evolution {
            Evolution::Beginning(size) => {
                let size = *size;
                self.spread_points(size)
            }
            Evolution::One(_) | Evolution::Several(_) => self.evolved(),
        };
        let designs: Vec<Vec<f64>> = self.pending.iter().take(left).cloned().collect();
        self.asked += designs.len() as u32;
        designs.iter().for_each(|design| {
            self.known.add(design);
        });
        designs
    }

    /// Whether every design that there is has been asked for.
    pub fn is_exhausted(&self) -> bool {
        count(&self.problem.axes).is_some_and(|all| all <= self.known.count())
    }

    /// What came of the designs that were asked for last, in their order.
    pub fn tell(&mut self, outcomes: &[Outcome]) {
        // The last generation may be cut short; nothing follows it.
        if outcomes.len() < self.pending.len() || self.is_exhausted() {
            return;
        }
        match &mut self.evolution {
            Evolution::Beginning(size) => {
                let size = *size;
                self.evolution = self.begun(size, outcomes);
            }
            Evolution::One(descent) => {
                if descent.tell(outcomes) {
                    self.evolution =
                        Evolution::Beginning((2 * descent.size).min(4 * self.problem.size()));
                }
            }
            Evolution::Several(mode) => {
                let rows: Vec<Vec<f64>> =
                    outcomes.iter().map(|one| self.problem.row(one)).collect();
                mode.tell(&rows);
            }
        }
    }

    /// Points that fill the cube evenly, the design to begin with before them.
    fn spread_points(&mut self, size: usize) -> Vec<Vec<f64>> {
        let points = Points {
            sampling: Sampling::Sobol,
            seed: self.problem.seed,
        };
        let mut spread: Vec<Vec<f64>> = Vec::with_capacity(size);
        if let (0, Some(start)) = (self.spread, &self.problem.start) {
            spread.push(self.problem.snapped(start));
        }
        while spread.len() < size {
            let place = self.spread;
            self.spread += 1;
            let point: Vec<f64> = (0..self.problem.axes.len() as u32)
                .map(|axis| points.at(place * REPLICATES, axis))
                .collect();
            spread.push(self.problem.snapped(&point));
        }
        self.without_repeats(spread)
    }

    /// The designs that the evolution asks for.
    fn evolved(&mut self) -> Vec<Vec<f64>> {
        let asked = match &mut self.evolution {
            Evolution::One(descent) => descent.cmaes.ask(),
            Evolution::Several(mode) => mode.ask(),
            Evolution::Beginning(_) => return Vec::new(),
        };
        let snapped: Vec<Vec<f64>> = asked
            .iter()
            .map(|point| self.problem.snapped(point))
            .collect();
        let mut designs = snapped.clone();
        if let Evolution::One(descent) = &self.evolution {
            self.problem.look_beside(&mut designs, descent.generation);
        }
        let designs = self.without_repeats(designs);
        if let Evolution::One(descent) = &mut self.evolution {
            descent.moved = designs != snapped;
            descent.is_narrow = is_narrow(&asked);
            descent.told = asked;
            for (i, (told, design)) in descent.told.iter_mut().zip(&designs).enumerate() {
                for (k, axis) in self.problem.axes.iter().enumerate() {
                    if snapped[i][k] != design[k] {
                        told[k] = axis.middle(design[k]);
                    }
                }
                if descent.moved {
                    // CMA-ES divides by how far a point that was moved is from the middle, which may stand in the same corner.
                    let inward = 1.0 - 1e-6 * (i + 1) as f64;
                    told.iter_mut().for_each(|u| *u = 0.5 + (*u - 0.5) * inward);
                }
            }
        }
        designs
    }

    /// Moves designs that have been asked for before to others beside them, where every variable has steps; leaves them out where there are no others.
    fn without_repeats(&mut self, designs: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        const TRIES: u32 = 64;
        let Some(all) = count(&self.problem.axes) else {
            return designs;
        };
        let mut here = Known::default();
        let mut kept = Vec::with_capacity(designs.len());
        for design in designs {
            if self.known.count() + here.count() >= all {
                break;
            }
            let mut moved = design.clone();
            let mut tries = 0;
            while self.known.has(&moved) || here.has(&moved) {
                tries += 1;
                if tries > TRIES {
                    self.problem.step_on(&mut moved);
                    continue;
                }
                // Farther and farther away.
                let reach = 1 + i64::from(tries / 8);
                moved.clone_from(&design);
                for _ in 0..reach {
                    let i = self.rng.int_below(moved.len() as i64) as usize;
                    let up = self.rng.int_below(2) == 0;
                    moved[i] = self.problem.axes[i].beyond(moved[i], if up { 1.0 } else { -1.0 });
                }
            }
            here.add(&moved);
            kept.push(moved);
        }
        kept
    }

    /// What follows the evenly spread points.
    fn begun(&mut self, size: usize, outcomes: &[Outcome]) -> Evolution {
        let (axes, seed) = (self.problem.axes.len(), self.rng.next_u64());
        let [low, high] = [0.0, 1.0].map(|end| vec![end; axes]);
        if self.problem.goals > 1 {
            let values = self.problem.goals + self.problem.conditions + 1;
            let fitness = Fitness::bounded(axes, values, &low, &high);
            let parameters = ModeParams {
                popsize: size as i32,
                seed,
                ..ModeParams::default()
            };
            let mut mode = Mode::new(
                fitness,
                self.problem.goals,
                self.problem.conditions + 1,
                None,
                &parameters,
            );
            let rows: Vec<Vec<f64>> = outcomes.iter().map(|one| self.problem.row(one)).collect();
            mode.set_population(&self.pending, &rows);
            return Evolution::Several(Box::new(mode));
        }
        let first =
            (0..outcomes.len()).min_by(|i, j| outcomes[*i].order(&outcomes[*j]).then(i.cmp(j)));
        let first = &self.pending[best(outcomes).or(first).unwrap_or(0)];
        let guess: Vec<f64> = self
            .problem
            .axes
            .iter()
            .zip(first)
            .map(|(axis, u)| axis.middle(*u))
            .collect();
        let parameters = CmaesParams {
            popsize: size as i32,
            max_evaluations: u64::from(self.problem.evaluations),
            seed,
            ..CmaesParams::default()
        };
        let fitness = Fitness::bounded(axes, 1, &low, &high);
        Evolution::One(Box::new(Descent {
            cmaes: Cmaes::new(fitness, &guess, &[FIRST_STEP], &parameters),
            size,
            told: Vec::new(),
            moved: false,
            is_narrow: false,
            weights: first_weights(outcomes, self.problem.conditions),
            generation: 0,
        }))
    }
}

impl Problem {
    /// The designs of a generation.
    fn size(&self) -> usize {
        let axes = self.axes.len() as f64;
        if self.goals > 1 {
            let half = (0.6 * f64::from(self.evaluations).sqrt()).round() as usize;
            2 * half.clamp(4, 32)
        } else {
            (5.0 + 3.0 * axes.ln()).floor() as usize
        }
    }

    fn snapped(&self, point: &[f64]) -> Vec<f64> {
        self.axes
            .iter()
            .zip(point)
            .map(|(axis, u)| axis.snapped(*u))
            .collect()
    }

    /// Goes on to the next of all designs, as nested loops would; behind the last one comes the first.
    fn step_on(&self, design: &mut [f64]) {
        for (axis, u) in self.axes.iter().zip(design).rev() {
            let next = axis.beyond(*u, 1.0);
            if next != *u {
                *u = next;
                return;
            }
            *u = 0.0;
        }
    }

    /// Where all designs have the same value of a variable with steps, one of them has the next value: a normal law narrower than a step would
    /// never leave it.
    fn look_beside(&self, designs: &mut [Vec<f64>], generation: usize) {
        for (i, axis) in self.axes.iter().enumerate() {
            let alike = matches!(axis, Axis::Steps(1..))
                && designs.iter().all(|design| design[i] == designs[0][i]);
            if alike {
                let chosen = (generation + i) % designs.len();
                let up = if (generation / 2).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                };
                let here = designs[chosen][i];
                let beside = axis.beyond(here, up);
                designs[chosen][i] = if beside == here {
                    axis.beyond(here, -up)
                } else {
                    beside
                };
            }
        }
    }

    /// Goals, violations and refusal of a design, for the evolution of a front.
    fn row(&self, outcome: &Outcome) -> Vec<f64> {
        /// Above every goal, and small enough to be calculated with.
        const WORST: f64 = 1e30;
        match outcome {
            Outcome::Computed { goals, violations } => goals
                .iter()
                .chain(violations)
                .chain(&[0.0])
                .copied()
                .collect(),
            Outcome::Refused(distance) => {
                let mut row = vec![WORST; self.goals + self.conditions];
                row.push(1.0 + distance);
                row
            }
        }
    }
}

/// Whether points differ by less than what is worth looking at, on every axis.
fn is_narrow(points: &[Vec<f64>]) -> bool {
    (0..points[0].len()).all(|i| {
        let values = || points.iter().map(|point| point[i]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
            < SETTLED
    })
}

/// What a violation weighs against goals at first: the usual violation as much as half the range of the goal.
fn first_weights(outcomes: &[Outcome], conditions: usize) -> Vec<f64> {
    let computed = || {
        outcomes.iter().filter_map(|one| match one {
            Outcome::Computed { goals, violations } => Some((goals[0], violations)),
            Outcome::Refused(_) => None,
        })
    };
    let least = computed()
        .map(|(goal, _)| goal)
        .fold(f64::INFINITY, f64::min);
    let most = computed()
        .map(|(goal, _)| goal)
        .fold(f64::NEG_INFINITY, f64::max);
    let range = if most > least { most - least } else { 1.0 };
    let of_condition = |j: usize| {
        let positive: Vec<f64> = computed()
            .map(|(_, violations)| violations[j])
            .filter(|v| *v > 0.0)
            .collect();
        let usual = meshwright_sample::mean(&positive).unwrap_or(1.0);
        (0.5 * range / usual).min(HEAVIEST)
    };
    (0..conditions).map(of_condition).collect()
}

impl Descent {
    /// What came of its designs; whether it has settled.
    fn tell(&mut self, outcomes: &[Outcome]) -> bool {
        let merits = self.merits(outcomes);
        self.weigh(outcomes, &merits);
        if self.moved {
            self.cmaes.tell_x(&merits, &self.told);
        } else {
            self.cmaes.tell(&merits);
        }
        self.generation += 1;
        self.is_narrow || self.cmaes.stop() != 0
    }

    /// What CMA-ES is to make small: the goal and what violations weigh; above all of that, by their distance, what cannot be had.
    fn merits(&self, outcomes: &[Outcome]) -> Vec<f64> {
        let computed: Vec<Option<f64>> = outcomes
            .iter()
            .map(|one| match one {
                Outcome::Computed { goals, violations } => {
                    let weighed = self
                        .weights
                        .iter()
                        .zip(violations)
                        .map(|(weight, v)| weight * v);
                    Some(goals[0] + weighed.sum::<f64>())
                }
                Outcome::Refused(_) => None,
            })
            .collect();
        let known = || computed.iter().copied().flatten();
        let least = known().fold(f64::INFINITY, f64::min);
        let most = known().fold(f64::NEG_INFINITY, f64::max);
        let (most, range) = if most >= least {
            (most, (most - least).max(1e-9 * most.abs()))
        } else {
            (0.0, 1.0)
        };
        let merits = computed
            .iter()
            .zip(outcomes)
            .map(|(merit, one)| match (merit, one) {
                (Some(merit), _) => *merit,
                (None, Outcome::Refused(distance)) => {
                    most + range.max(f64::MIN_POSITIVE) * (1.0 + distance)
                }
                (None, Outcome::Computed { .. }) => most,
            });
        merits.collect()
    }

    /// A condition that the best design fails weighs more from now on; one that all keep weighs less.
    fn weigh(&mut self, outcomes: &[Outcome], merits: &[f64]) {
        let first = (0..merits.len()).min_by(|i, j| merits[*i].total_cmp(&merits[*j]));
        let violation = |i: usize, j: usize| match &outcomes[i] {
            Outcome::Computed { violations, .. } => violations[j],
            Outcome::Refused(_) => 0.0,
        };
        for (j, weight) in self.weights.iter_mut().enumerate() {
            if first.is_some_and(|first| violation(first, j) > 0.0) {
                *weight = (2.0 * *weight).min(HEAVIEST);
            } else if (0..outcomes.len()).all(|i| violation(i, j) == 0.0) {
                *weight /= 1.2;
            }
        }
    }
}
