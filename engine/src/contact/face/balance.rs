//! The balance of forces on slices whose springs are not linear.
//!
//! The springs stiffen with the force, so that the forces are those of the least of a convex energy, and there is one balance. Newton's step
//! from one set of forces to the next is a contact problem with linear springs, which the exact solver of the plane solves; the
//! way to it is shortened where the energy would rise again before its end. Forces stay in balance with the load all along.

use faer::Mat;

use super::compliance::half_space;
use super::slice::Slice;
use super::spring::Closing;
use crate::contact::{ContactError, ContactProblem, PositionError, solve_active_set};

/// Newton steps, of which some eight are taken.
const MOST_STEPS: u32 = 100;

/// Looks for the least energy on the way of one step.
const MOST_LOOKS: u32 = 40;

/// What counts as no gap, over the δ that the load causes.
const NO_GAP: f64 = 1e-10;

/// What counts as no way, over the largest force.
const NO_WAY: f64 = 1e-9;

/// The forces on the slices, and what they leave.
pub(super) struct Balance {
    /// Normal to the flanks, in N.
    pub(super) forces: Vec<f64>,
    /// How they rise with the load.
    pub(super) load_derivative: Vec<f64>,
    /// g + H N + f(N) − δ w.
    pub(super) gaps: Vec<f64>,
    /// The same without f.
    without_springs: Vec<f64>,
    pub(super) transmission_error: f64,
    pub(super) stiffness: f64,
    pub(super) iterations: u32,
}

/// Forces, what they open by the linear compliance, and how their springs close up.
struct State {
    forces: Vec<f64>,
    opened: Vec<f64>,
    closings: Vec<Closing>,
}

/// The slices to be balanced.
struct Problem<'a> {
    h: Mat<f64>,
    slices: &'a [Slice],
    gaps: Vec<f64>,
    weights: Vec<f64>,
    load: f64,
}

/// The balance of `slices` under `load` with the linear compliance `h`.
pub(super) fn balance(h: Mat<f64>, slices: &[Slice], load: f64) -> Result<Balance, PositionError> {
    let problem = Problem {
        h,
        slices,
        gaps: slices.iter().map(|slice| slice.gap).collect(),
        weights: slices.iter().map(|slice| slice.weights[1]).collect(),
        load,
    };
    problem.solved()
}

impl Problem<'_> {
    fn solved(&self) -> Result<Balance, PositionError> {
        let touches = self.gaps.iter().zip(&self.weights);
        let touch = touches
            .map(|(gap, weight)| gap / weight)
            .fold(f64::INFINITY, f64::min);
        let mut state = self.even();
        let mut active: Option<Vec<bool>> = None;
        let (mut iterations, mut worst) = (0, 0.0);
        for _ in 0..MOST_STEPS {
            let linear = self.linear_at(&state)?;
            let solved = solve_active_set(&linear, self.load, active.as_deref())?;
            iterations += solved.iterations;
            let whole = self.step(&mut state, &solved.forces, solved.transmission_error);

            let delta = solved.transmission_error;
            let without_springs: Vec<f64> = (0..self.slices.len())
                .map(|i| self.gaps[i] + state.opened[i] - delta * self.weights[i])
                .collect();
            let closings = without_springs.iter().zip(&state.closings);
            let gaps: Vec<f64> = closings.map(|(gap, closing)| gap + closing.depth).collect();
            worst = gaps
                .iter()
                .zip(&state.forces)
                .map(|(gap, force)| if *force > 0.0 { gap.abs() } else { -gap })
                .fold(0.0, f64::max);
            if whole && worst <= NO_GAP * (delta - touch) {
                return Ok(Balance {
                    forces: state.forces,
                    load_derivative: solved.load_derivative,
                    gaps,
                    without_springs,
                    transmission_error: delta,
                    stiffness: solved.stiffness,
                    iterations,
                });
            }
            active = Some(solved.active);
        }
        Err(PositionError::Contact(ContactError::NotConverged {
            iterations,
            gap: worst,
            pull: 0.0,
        }))
    }

    /// The load spread evenly along all lines.
    fn even(&self) -> State {
        let along = self.slices.iter().map(|slice| slice.along);
        let carried: f64 = along.clone().zip(&self.weights).map(|(h, w)| h * w).sum();
        let forces: Vec<f64> = along.map(|h| h * self.load / carried).collect();
        State {
            opened: product(&self.h, &forces),
            closings: self.closings(&forces),
            forces,
        }
    }

    /// The contact with springs that go on as they do at `state`.
    fn linear_at(&self, state: &State) -> Result<ContactProblem, ContactError> {
        let mut compliance = self.h.clone();
        let mut gaps = self.gaps.clone();
        for (i, (closing, force)) in state.closings.iter().zip(&state.forces).enumerate() {
            compliance[(i, i)] += closing.growth;
            gaps[i] += closing.depth - closing.growth * force;
        }
        ContactProblem::new(compliance, gaps, self.weights.clone())
    }

    /// Goes from `state` towards the forces `aim` as far as the energy falls; whether it went all the way.
    fn step(&self, state: &mut State, aim: &[f64], delta: f64) -> bool {
        let way: Vec<f64> = aim
            .iter()
            .zip(&state.forces)
            .map(|(new, old)| new - old)
            .collect();
        let way_opens = product(&self.h, &way);
        // How the energy changes on the way. δ does no work on it, as the load is carried all along, and saves digits.
        let rise = |part: f64, closings: &[Closing]| -> f64 {
            let each = (0..way.len()).map(|i| {
                let opened = state.opened[i] + part * way_opens[i];
                let gap = self.gaps[i] + opened - delta * self.weights[i];
                way[i] * (gap + closings[i].depth)
            });
            each.sum()
        };
        let at = |part: f64| {
            let steps = state.forces.iter().zip(&way);
            let forces: Vec<f64> = steps
                .map(|(old, way)| (old + part * way).max(0.0))
                .collect();
            let closings = self.closings(&forces);
            let rise = rise(part, &closings);
            (forces, closings, rise)
        };
        let largest = aim.iter().copied().fold(0.0, f64::max);
        let is_short = way.iter().all(|way| way.abs() <= NO_WAY * largest);
        let fall = rise(0.0, &state.closings);
        let (mut part, mut end) = (1.0, at(1.0));
        let (mut low, mut high) = ([0.0, fall], [1.0, end.2]);
        let mut looks = 0;
        while !is_short && end.2.abs() > 0.5 * fall.abs() && end.2 > 0.0 && looks < MOST_LOOKS {
            // The energy is convex: its slope vanishes in between.
            let secant = low[1] / (low[1] - high[1]);
            part = low[0] + (high[0] - low[0]) * secant.clamp(0.1, 0.9);
            end = at(part);
            if end.2 > 0.0 {
                high = [part, end.2];
            } else {
                low = [part, end.2];
            }
            looks += 1;
        }
        for (opened, way) in state.opened.iter_mut().zip(&way_opens) {
            *opened += part * way;
        }
        (state.forces, state.closings) = (end.0, end.1);
        part == 1.0
    }

    fn closings(&self, forces: &[f64]) -> Vec<Closing> {
        let springs = self.slices.iter().zip(forces);
        springs
            .map(|(slice, force)| slice.spring.closing(*force))
            .collect()
    }
}

impl Balance {
    /// The largest penetration in the middle of each of `slices` and between each two of a line.
    pub(super) fn penetration(&self, slices: &[Slice]) -> f64 {
        let inside = self.gaps.iter().fold(0.0, |most: f64, gap| most.max(-gap));
        (1..slices.len())
            .filter(|&i| slices[i - 1].pair == slices[i].pair)
            .map(|i| -self.gap_before(slices, i))
            .fold(inside, f64::max)
    }

    /// The gap between slice `i` and the one before it.
    fn gap_before(&self, slices: &[Slice], i: usize) -> f64 {
        let of_line = |(_, slice): &(usize, &Slice)| slice.pair == slices[i].pair;
        let line = || slices.iter().enumerate().filter(of_line);
        // What is smooth between them is between what it is at both; the half space is taken there.
        let smooth = |at: usize| {
            let others = line().filter(|(k, _)| *k != at);
            let moved = others.map(|(k, other)| self.forces[k] * half_space(other, slices[at].z));
            self.without_springs[at] - moved.sum::<f64>()
        };
        let z = f64::midpoint(slices[i - 1].z, slices[i].z);
        let far = line().filter(|(k, _)| *k + 1 != i && *k != i);
        let moved = far.map(|(k, other)| self.forces[k] * half_space(other, z));
        let beside = [i - 1, i].map(|k| slices[k].spring.closing_at_end(self.forces[k]));
        0.5 * (smooth(i - 1) + smooth(i)) + moved.sum::<f64>() + beside[0] + beside[1]
    }
}

fn product(h: &Mat<f64>, forces: &[f64]) -> Vec<f64> {
    let mut moved = vec![0.0; forces.len()];
    for (column, force) in forces
        .iter()
        .enumerate()
        .filter(|(_, force)| **force != 0.0)
    {
        for (moved, entry) in moved.iter_mut().zip(h.col_as_slice(column)) {
            *moved += entry * force;
        }
    }
    moved
}
