//! Which designs to compute next.
//!
//! One goal is searched by CMA-ES, two by an evolution of the front. Either begins with points that fill the cube evenly. CMA-ES goes on from the best of
//! them and learns in which directions goals fall; once it has settled, another one begins elsewhere with twice as many points, as long as there are
//! evaluations left. Where every variable has steps, the last designs are those one step beside the best one: no law of CMA-ES promises that it looked there.

use crate::optimum::chance::Chance;
use crate::optimum::cmaes::Cmaes;
use crate::optimum::evolution::Evolution;
use crate::optimum::outcome::{Outcome, best};
use crate::optimum::space::{Axis, Known, count};
use crate::sample::REPLICATES;
use crate::sample::points::{Points, Sampling};

/// How widely CMA-ES looks around the point that it goes on from, as a part of each axis.
const FIRST_STEP: f64 = 0.2;

/// CMA-ES has settled when the designs of a generation differ by less than this part of each axis.
const SETTLED: f64 = 1e-3;

/// No violation weighs more than so much.
const HEAVIEST: f64 = 1e30;

/// An optimization problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The variables; at least one.
    pub axes: Vec<Axis>,
    /// The number of goals: one or two.
    pub goals: usize,
    /// The number of conditions.
    pub conditions: usize,
    /// Maximum number of designs that are computed.
    pub evaluations: u32,
    /// Seed of all random numbers.
    pub seed: u32,
    /// A design to begin with.
    pub start: Option<Vec<f64>>,
}

/// A search under way.
pub struct Driver {
    problem: Problem,
    way: Way,
    /// Designs asked for.
    asked: u32,
    /// Points of the even beginning that have been used.
    spread: u32,
    known: Known,
    chance: Chance,
    pending: Vec<Vec<f64>>,
    /// The best design so far, and its outcome.
    best: Option<(Vec<f64>, Outcome)>,
    /// True if `pending` are designs beside the best one.
    is_beside: bool,
}

enum Way {
    /// Number of evenly spread points at the start.
    Beginning(usize),
    One(Box<Descent>),
    Two(Evolution),
}

/// CMA-ES, and the weights of the conditions in its values.
struct Descent {
    cmaes: Cmaes,
    size: usize,
    /// The points as CMA-ES asked for them, or as they were moved.
    points: Vec<Vec<f64>>,
    /// True if its last points hardly differ.
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
            way: Way::Beginning(size),
            asked: 0,
            spread: 0,
            known: Known::default(),
            chance: Chance::new(problem.seed),
            pending: Vec::new(),
            best: None,
            is_beside: false,
            problem,
        }
    }

    /// The designs of the next generation; none once the search is over. Each call needs the outcomes of the one before.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        let left = (self.problem.evaluations - self.asked) as usize;
        if left == 0 || self.is_exhausted() {
            return Vec::new();
        }
        let beside = self.beside_the_best(left);
        self.is_beside = !beside.is_empty();
        self.pending = match &self.way {
            _ if self.is_beside => beside,
            Way::Beginning(size) => self.spread_points(*size),
            Way::One(_) => self.descended(),
            Way::Two(evolution) => {
                let asked = evolution.ask(&mut self.chance);
                let designs = asked.iter().map(|point| self.problem.snapped(point));
                let designs = designs.collect();
                self.without_repeats(designs)
            }
        };
        let designs: Vec<Vec<f64>> = self.pending.iter().take(left).cloned().collect();
        self.asked += designs.len() as u32;
        designs.iter().for_each(|design| {
            self.known.add(design);
        });
        designs
    }

    /// True if every possible design has been asked for.
    pub fn is_exhausted(&self) -> bool {
        count(&self.problem.axes).is_some_and(|all| all <= self.known.count())
    }

    /// Reports the outcomes of the last designs, in their order.
    pub fn tell(&mut self, outcomes: &[Outcome]) {
        // The last generation may be cut short; nothing follows it.
        if outcomes.len() < self.pending.len() || self.is_exhausted() {
            return;
        }
        for (design, outcome) in self.pending.iter().zip(outcomes) {
            let best = self.best.as_ref();
            if best.is_none_or(|(_, best)| outcome.order(best).is_lt()) {
                self.best = Some((design.clone(), outcome.clone()));
            }
        }
        if self.is_beside {
            return;
        }
        match &mut self.way {
            Way::Beginning(size) => {
                let size = *size;
                self.way = self.begun(size, outcomes);
            }
            Way::One(descent) => {
                if descent.tell(outcomes) {
                    self.way = Way::Beginning((2 * descent.size).min(4 * self.problem.size()));
                }
            }
            Way::Two(evolution) => evolution.tell(&self.pending, outcomes),
        }
    }

    /// The designs one step beside the best one that nobody has asked for, once no more than two fifths of the evaluations, and three rounds of them, are `left`;
    /// none of two goals, and none where a variable is continuous.
    fn beside_the_best(&self, left: usize) -> Vec<Vec<f64>> {
        let axes = &self.problem.axes;
        let is_late = left <= 6 * axes.len() && 5 * left <= 2 * self.problem.evaluations as usize;
        let Some((best, _)) = &self.best else {
            return Vec::new();
        };
        if !is_late || self.problem.goals > 1 || count(axes).is_none() {
            return Vec::new();
        }
        let one = |(i, steps): (usize, f64)| {
            let mut design = best.clone();
            design[i] = axes[i].beyond(best[i], steps);
            design
        };
        let beside = (0..axes.len()).flat_map(|i| [(i, 1.0), (i, -1.0)]).map(one);
        beside.filter(|design| !self.known.has(design)).collect()
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

    /// The designs that the descent asks for.
    fn descended(&mut self) -> Vec<Vec<f64>> {
        let Way::One(descent) = &mut self.way else {
            return Vec::new();
        };
        descent.points = descent.cmaes.ask(&mut self.chance);
        descent.is_narrow = is_narrow(&descent.points);
        let generation = descent.generation;
        let points = descent.points.iter();
        let snapped: Vec<Vec<f64>> = points.map(|point| self.problem.snapped(point)).collect();
        let mut designs = snapped.clone();
        self.problem.look_beside(&mut designs, generation);
        let designs = self.without_repeats(designs);
        if let Way::One(descent) = &mut self.way {
            // Reports the points to which designs were moved.
            descent.points.truncate(designs.len());
            for ((point, design), snapped) in descent.points.iter_mut().zip(&designs).zip(&snapped)
            {
                for (i, axis) in self.problem.axes.iter().enumerate() {
                    if snapped[i] != design[i] {
                        point[i] = axis.middle(design[i]);
                    }
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
                    let i = self.chance.below(moved.len());
                    let up = self.chance.happens(0.5);
                    moved[i] = self.problem.axes[i].beyond(moved[i], if up { 1.0 } else { -1.0 });
                }
            }
            here.add(&moved);
            kept.push(moved);
        }
        kept
    }

    /// The method that follows the evenly spread points.
    fn begun(&self, size: usize, outcomes: &[Outcome]) -> Way {
        if self.problem.goals > 1 {
            return Way::Two(Evolution::new(size, &self.pending, outcomes));
        }
        let first =
            (0..outcomes.len()).min_by(|i, j| outcomes[*i].order(&outcomes[*j]).then(i.cmp(j)));
        let first = &self.pending[best(outcomes).or(first).unwrap_or(0)];
        let axes = self.problem.axes.iter().zip(first);
        let from: Vec<f64> = axes.map(|(axis, u)| axis.middle(*u)).collect();
        Way::One(Box::new(Descent {
            cmaes: Cmaes::new(&from, FIRST_STEP, size),
            size,
            points: Vec::new(),
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
}

/// True if points differ by less than the resolution on every axis.
fn is_narrow(points: &[Vec<f64>]) -> bool {
    (0..points[0].len()).all(|i| {
        let values = || points.iter().map(|point| point[i]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
            < SETTLED
    })
}

/// First weights of violations against goals: the usual violation counts as half the range of the goal.
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
        let usual = crate::sample::mean(&positive).unwrap_or(1.0);
        (0.5 * range / usual).min(HEAVIEST)
    };
    (0..conditions).map(of_condition).collect()
}

impl Descent {
    /// Reports the outcomes of its designs; true if it has settled.
    fn tell(&mut self, outcomes: &[Outcome]) -> bool {
        let merits = self.merits(outcomes);
        self.weigh(outcomes, &merits);
        self.cmaes.tell(&self.points, &merits);
        self.generation += 1;
        self.is_narrow
    }

    /// The values that CMA-ES makes small: the goal and the weighted violations; above all of those, by their distance, designs that cannot be built.
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
