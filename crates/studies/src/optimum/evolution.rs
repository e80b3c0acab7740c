//! The evolution of a front of two goals: of parents and children those stay that leave the largest area behind the front.
//!
//! A child is a parent moved by a part of the difference of two others, as in differential evolution (Storn and Price 1997), so that steps follow the shape and
//! the size of the front. Half of the children mutate as well (polynomial mutation, Deb and Agrawal 1999). Designs that no other beats stay; of the last front
//! the designs go first whose loss costs the least area (SMS-EMOA; Beume, Naujoks and Emmerich 2007). Designs that are not feasible come behind all that are.

use std::cmp::Ordering;

use crate::optimum::chance::Chance;
use crate::optimum::outcome::{Outcome, beats};

/// The least and the largest part of a difference by which a child is moved.
const REACH: [f64; 2] = [0.2, 0.9];

/// How often each variable is moved so, and how often children mutate.
const MOVED: f64 = 0.9;
const MUTATES: f64 = 0.5;

/// The larger, the smaller mutations are.
const NEAR: f64 = 15.0;

/// The designs from which the next ones are made.
pub(crate) struct Evolution {
    /// How many stay; half as many are made of them at once.
    size: usize,
    /// The best first.
    parents: Vec<(Vec<f64>, Outcome)>,
}

impl Evolution {
    /// An evolution that begins with these designs.
    pub(crate) fn new(size: usize, designs: &[Vec<f64>], outcomes: &[Outcome]) -> Self {
        let mut evolution = Self {
            size,
            parents: Vec::new(),
        };
        evolution.tell(designs, outcomes);
        evolution
    }

    /// The next designs.
    pub(crate) fn ask(&self, chance: &mut Chance) -> Vec<Vec<f64>> {
        (0..self.size / 2).map(|_| self.child(chance)).collect()
    }

    fn child(&self, chance: &mut Chance) -> Vec<f64> {
        let count = self.parents.len();
        let of = |place: usize| &self.parents[place].0;
        // The better one of two.
        let base = of(chance.below(count).min(chance.below(count)));
        let one = chance.below(count);
        let other = of((one + 1 + chance.below((count - 1).max(1))) % count);
        let one = of(one);
        let reach = REACH[0] + (REACH[1] - REACH[0]) * chance.even();
        let mut child = base.clone();
        for (i, u) in child.iter_mut().enumerate() {
            if chance.happens(MOVED) {
                let moved = *u + reach * (one[i] - other[i]);
                // A step out of the cube ends between its border and the middle of the way there.
                *u = if moved < 0.0 {
                    0.5 * *u * chance.even()
                } else if moved > 1.0 {
                    1.0 - 0.5 * (1.0 - *u) * chance.even()
                } else {
                    moved
                };
            }
        }
        if chance.happens(MUTATES) {
            mutate(&mut child, chance);
        }
        child
    }

    /// Reports the outcomes of the last designs.
    pub(crate) fn tell(&mut self, designs: &[Vec<f64>], outcomes: &[Outcome]) {
        let children = designs.iter().cloned().zip(outcomes.iter().cloned());
        self.parents.extend(children);
        let order = ranked(&self.parents, self.size);
        self.parents = order.into_iter().map(|i| self.parents[i].clone()).collect();
    }
}

/// The places of the best `count`, the best first.
fn ranked(designs: &[(Vec<f64>, Outcome)], count: usize) -> Vec<usize> {
    let goals = |i: usize| designs[i].1.goals_if_feasible();
    let (mut left, mut rest): (Vec<usize>, Vec<usize>) =
        (0..designs.len()).partition(|i| goals(*i).is_some());
    rest.sort_by(|i, j| designs[*i].1.by_feasibility(&designs[*j].1).then(i.cmp(j)));
    let mut order = Vec::with_capacity(count);
    while !left.is_empty() && order.len() < count {
        let is_beaten = |i: &usize| {
            let own = goals(*i).unwrap_or_default();
            let mut others = left.iter().map(|j| goals(*j).unwrap_or_default());
            others.any(|other| beats(other, own))
        };
        let (behind, front): (Vec<usize>, Vec<usize>) = left.iter().partition(|i| is_beaten(i));
        let front = front.into_iter().map(|i| (i, goals(i).unwrap_or_default()));
        order.extend(by_area(front.collect(), count - order.len()));
        left = behind;
    }
    order.extend(rest);
    order.truncate(count);
    order
}

/// The places of the `count` designs of one front that keep most of the area behind it, those first whose loss costs most.
fn by_area(mut front: Vec<(usize, &[f64])>, count: usize) -> Vec<usize> {
    front.sort_by(|(i, a), (j, b)| {
        let pairs = a.iter().zip(*b).map(|(a, b)| a.total_cmp(b));
        let first = pairs.into_iter().find(|order| order.is_ne());
        first.unwrap_or(Ordering::Equal).then(i.cmp(j))
    });
    // The ends of the front have no neighbor, and are never lost.
    let area = |front: &[(usize, &[f64])], i: usize| match (i.checked_sub(1), front.get(i + 1)) {
        (Some(before), Some(after)) => {
            let (own, before) = (front[i].1, front[before].1);
            ((after.1[0] - own[0]) * (before[1] - own[1])).abs()
        }
        _ => f64::INFINITY,
    };
    let mut lost = Vec::new();
    while front.len() > 1 {
        let areas = (0..front.len()).map(|i| area(&front, i));
        let least = areas.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
        let Some((least, _)) = least else { break };
        lost.push(front.remove(least).0);
    }
    let last = front.into_iter().map(|(i, _)| i);
    last.chain(lost.into_iter().rev()).take(count).collect()
}

/// Moves one variable in the mean.
fn mutate(child: &mut [f64], chance: &mut Chance) {
    let often = 1.0 / child.len() as f64;
    let power = 1.0 / (NEAR + 1.0);
    for u in child {
        if chance.happens(often) {
            let drawn = chance.even();
            *u += if drawn < 0.5 {
                *u * (libm::pow(2.0 * drawn, power) - 1.0)
            } else {
                (1.0 - *u) * (1.0 - libm::pow(2.0 - 2.0 * drawn, power))
            };
        }
    }
}
