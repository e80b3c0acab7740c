//! Outcomes of designs, and their comparison.

use std::cmp::Ordering;

/// Outcome of a design.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// The design was computed.
    Computed {
        /// Values to make small.
        goals: Vec<f64>,
        /// By how much each condition fails, as a share of its limit; zero where it holds.
        violations: Vec<f64>,
    },
    /// The design cannot be built or computed. The number is its distance from one that can: the relative change that is needed.
    Refused(f64),
}

impl Outcome {
    /// True if it can be built and every condition holds.
    pub fn is_feasible(&self) -> bool {
        self.violation() == Some(0.0)
    }

    /// By how much its conditions fail, together; none of a design that cannot be had.
    pub(crate) fn violation(&self) -> Option<f64> {
        match self {
            Self::Computed { violations, .. } => Some(violations.iter().sum()),
            Self::Refused(_) => None,
        }
    }

    /// Compares two by how nearly they are feasible: the less the better.
    pub(crate) fn by_feasibility(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Refused(own), Self::Refused(other)) => own.total_cmp(other),
            (Self::Refused(_), _) => Ordering::Greater,
            (_, Self::Refused(_)) => Ordering::Less,
            _ => {
                let [own, other] = [self, other].map(|one| one.violation().unwrap_or(f64::MAX));
                own.total_cmp(&other)
            }
        }
    }

    /// Compares two by feasibility, then by the first goal: the less the better.
    pub fn order(&self, other: &Self) -> Ordering {
        let goal = |one: &Self| match one {
            Self::Computed { goals, .. } => goals.first().copied().unwrap_or(f64::MAX),
            Self::Refused(_) => f64::MAX,
        };
        self.by_feasibility(other)
            .then_with(|| goal(self).total_cmp(&goal(other)))
    }

    /// The goals of a design that is feasible.
    pub(crate) fn goals_if_feasible(&self) -> Option<&[f64]> {
        match self {
            Self::Computed { goals, .. } if self.is_feasible() => Some(goals),
            _ => None,
        }
    }
}

/// The best of some designs: of one goal that with the least of it, of several the one of the front that is nearest to having the
/// least of each. Where no condition can be kept it is the design that is nearest to keeping them; none if no design can be had.
pub fn best(outcomes: &[Outcome]) -> Option<usize> {
    let front = front(outcomes);
    let several = front
        .first()
        .and_then(|first| outcomes[*first].goals_if_feasible())
        .is_some_and(|goals| goals.len() > 1);
    if several {
        return compromise(outcomes, &front);
    }
    let had = outcomes.iter().enumerate();
    had.filter(|(_, outcome)| !matches!(outcome, Outcome::Refused(_)))
        .min_by(|(i, a), (j, b)| a.order(b).then(i.cmp(j)))
        .map(|(i, _)| i)
}

/// The design of `front` that is nearest to having the least of each goal, each measured by its range over the front.
fn compromise(outcomes: &[Outcome], front: &[usize]) -> Option<usize> {
    let goals: Vec<&[f64]> = front
        .iter()
        .filter_map(|i| outcomes[*i].goals_if_feasible())
        .collect();
    let range = |k: usize| {
        let values = || goals.iter().map(|goals| goals[k]);
        let least = values().fold(f64::INFINITY, f64::min);
        (least, values().fold(f64::NEG_INFINITY, f64::max) - least)
    };
    let ranges: Vec<(f64, f64)> = (0..goals.first()?.len()).map(range).collect();
    let distance = |goals: &[f64]| -> f64 {
        let parts = goals.iter().zip(&ranges);
        parts
            .map(|(goal, (least, range))| {
                if *range > 0.0 {
                    ((goal - least) / range).powi(2)
                } else {
                    0.0
                }
            })
            .sum()
    };
    let numbered = front.iter().zip(&goals);
    numbered
        .min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)))
        .map(|(i, _)| *i)
}

/// The feasible designs that no other feasible one is at least as good as in every goal and better in one; of equal ones the first. By the first
/// goal, the least of it first.
pub fn front(outcomes: &[Outcome]) -> Vec<usize> {
    let numbered = outcomes.iter().enumerate();
    let mut feasible: Vec<(usize, &[f64])> = numbered
        .filter_map(|(i, outcome)| Some((i, outcome.goals_if_feasible()?)))
        .collect();
    let lexical = |a: &[f64], b: &[f64]| {
        let mut pairs = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
        pairs.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    // In lexical order a design is beaten by earlier ones only.
    feasible.sort_by(|(i, a), (j, b)| lexical(a, b).then(i.cmp(j)));
    let mut front: Vec<(usize, &[f64])> = Vec::new();
    for (i, goals) in feasible {
        let is_beaten = front.iter().any(|(_, other)| is_no_worse(other, goals));
        if !is_beaten {
            front.push((i, goals));
        }
    }
    front.into_iter().map(|(i, _)| i).collect()
}

/// True if `one` is as good as the `other` in every goal.
fn is_no_worse(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).all(|(one, other)| one <= other)
}

/// True if `one` is as good as the `other` in every goal, and better in one.
pub(crate) fn beats(one: &[f64], other: &[f64]) -> bool {
    is_no_worse(one, other) && one != other
}
