//! How good a design is.

use meshwright_wire::declare::Node;
use meshwright_wire::problem::{FieldError, Problem};
use meshwright_wire::warning::GearName;

use super::{Condition, Goal, Measure, Search, Torques};
use crate::optimum::outcome::Outcome;
use crate::sample::percentile::percentile;
use crate::table::{Of, RowState, Summary};

/// No condition fails by more than so many times its limit, as far as a search cares.
const WORST_VIOLATION: f64 = 10.0;

/// Choice among several values: the largest is the worst of a value to make small, the smallest of one to make large.
#[derive(Clone, Copy)]
enum Worst {
    Largest,
    Smallest,
}

impl Worst {
    /// Beyond every number, in the direction that hurts.
    fn beyond(self) -> f64 {
        match self {
            Self::Largest => f64::INFINITY,
            Self::Smallest => f64::NEG_INFINITY,
        }
    }
}

impl Measure {
    /// Its value for a design; none if the design does not tell it. A member without results lies beyond every number, and so does a percentile that falls
    /// among such members.
    fn of(
        &self,
        design: &Summary,
        members: &[Option<Summary>],
        gear: GearName,
        worst: Worst,
    ) -> Option<f64> {
        let at = |place: usize| match self.percent {
            None => self.at(design, place, gear),
            Some(percent) => {
                let numbers = members.iter().map(|member| {
                    let value = member.as_ref().and_then(|one| self.at(one, place, gear));
                    value.unwrap_or(worst.beyond())
                });
                let mut values: Vec<f64> = numbers.collect();
                values.sort_by(f64::total_cmp);
                let found = (!values.is_empty()).then(|| percentile(&values, percent))?;
                // A number and an infinite one have only the infinite one between them.
                Some(if found.is_finite() {
                    found
                } else {
                    worst.beyond()
                })
            }
        };
        let torques = match self.quantity.of {
            Of::Pair(_) => 1,
            Of::Curve(_) => design.curves().len(),
        };
        let values = (0..torques).map(at).collect::<Option<Vec<f64>>>()?;
        match (self.torques, worst) {
            (Torques::Mean, _) => crate::sample::mean(&values),
            (Torques::Largest, Worst::Largest) => values.into_iter().reduce(f64::max),
            (Torques::Largest, Worst::Smallest) => values.into_iter().reduce(f64::min),
        }
    }

    /// The quantity at one torque.
    fn at(&self, design: &Summary, torque: usize, gear: GearName) -> Option<f64> {
        let value = match self.quantity.of {
            Of::Pair(of) => of(design),
            Of::Curve(of) => of(design.curves().get(torque)?, gear),
        };
        value.or_else(|| (self.quantity.absent)(design))
    }
}

impl Condition {
    /// Its value, and its violation as a share of its limit; `None` if the design does not have it.
    fn of(
        &self,
        design: &Summary,
        members: &[Option<Summary>],
        gear: GearName,
    ) -> Option<(f64, f64)> {
        let mut value = 0.0;
        let mut violation: f64 = 0.0;
        let share = |beyond: f64, limit: f64| {
            let share = beyond / if limit == 0.0 { 1.0 } else { limit.abs() };
            if share > 0.0 {
                share.min(WORST_VIOLATION)
            } else {
                0.0
            }
        };
        if let Some(least) = self.at_least {
            value = self.measure.of(design, members, gear, Worst::Smallest)?;
            violation = violation.max(share(least - value, least));
        }
        if let Some(most) = self.at_most {
            value = self.measure.of(design, members, gear, Worst::Largest)?;
            violation = violation.max(share(value - most, most));
        }
        Some((value, violation))
    }
}

/// Outcome of a design: the search's view of it, and the numbers themselves.
pub(crate) struct Judged {
    pub(crate) outcome: Outcome,
    /// Of each goal; none where it is not told.
    pub(crate) goals: Vec<Option<f64>>,
    /// Of each condition.
    pub(crate) conditions: Vec<Option<f64>>,
}

impl Search {
    /// True if `design` keeps every condition on designs as they are drawn, and has every such goal; `None` where all known ones hold, and others are about
    /// members.
    pub(crate) fn is_kept_as_drawn(&self, design: &Summary, gear: GearName) -> Option<bool> {
        let drawn = |measure: &Measure| measure.percent.is_none();
        let keeps = |one: &Condition| {
            let found = one.of(design, &[], gear);
            found.is_some_and(|(_, violation)| violation == 0.0)
        };
        let tells = |goal: &Goal| match goal {
            Goal::Quantity(measure) if drawn(measure) => {
                let found = measure.of(design, &[], gear, Worst::Largest);
                found.is_some_and(f64::is_finite)
            }
            Goal::Quantity(_) | Goal::Cost(_) => true,
        };
        let (own, others): (Vec<&Condition>, Vec<&Condition>) =
            self.conditions.iter().partition(|one| drawn(&one.measure));
        if !own.into_iter().all(keeps) || !self.goals.iter().all(tells) {
            return Some(false);
        }
        others.is_empty().then_some(true)
    }

    /// Outcome of a design, whose variables have these values.
    pub(crate) fn judge(
        &self,
        values: &[f64],
        design: &Summary,
        members: &[Option<Summary>],
        gear: GearName,
    ) -> Judged {
        let goals: Vec<Option<f64>> = self
            .goals
            .iter()
            .map(|goal| match goal {
                Goal::Quantity(measure) => measure
                    .of(design, members, gear, Worst::Largest)
                    .filter(|value| value.is_finite()),
                Goal::Cost(parts) => Some(
                    parts
                        .iter()
                        .map(|(variable, weight)| weight * values[*variable])
                        .sum(),
                ),
            })
            .collect();
        let conditions: Vec<Option<(f64, f64)>> = self
            .conditions
            .iter()
            .map(|condition| condition.of(design, members, gear))
            .collect();
        let violations: Option<Vec<f64>> = conditions
            .iter()
            .map(|found| found.map(|(_, violation)| violation))
            .collect();
        let known: Option<Vec<f64>> = goals.iter().copied().collect();
        let outcome = match (known, violations) {
            (Some(goals), Some(violations)) => Outcome::Computed { goals, violations },
            // The design can be built, and lacks a value that judges it: a pressure at a sharp corner has no limit, and too many members may have no results.
            _ => Outcome::Refused(failed_share(members).unwrap_or(0.0)),
        };
        let finite = |(value, _): (f64, f64)| Some(value).filter(|value| value.is_finite());
        Judged {
            outcome,
            conditions: conditions
                .into_iter()
                .map(|condition| condition.and_then(finite))
                .collect(),
            goals,
        }
    }
}

/// The share of members that have no results; none without members.
pub(crate) fn failed_share(members: &[Option<Summary>]) -> Option<f64> {
    let failed = members.iter().filter(|member| member.is_none()).count();
    (!members.is_empty()).then(|| failed as f64 / members.len() as f64)
}

/// How far a row without results is from having some: by which share of itself each wrong field would have to change.
pub(crate) fn distance(row: &RowState, submission: Option<&Node>) -> f64 {
    /// Distance of a design that no small change would mend.
    const FAR: f64 = 1.0;
    let problem: Option<Problem> = row
        .problem
        .as_ref()
        .and_then(|problem| serde_json::from_value(problem.clone()).ok());
    let errors = problem.map_or_else(Vec::new, |problem| problem.errors);
    if errors.is_empty() {
        return 2.0 * FAR;
    }
    let each = |error: &FieldError| -> Option<f64> {
        let steps: Vec<&str> = error.pointer.split('/').skip(1).collect();
        let value = submission?.number_at(&steps)?;
        let nearest = error.nearest?;
        let size = value.abs().max(nearest.abs());
        (size > 0.0).then(|| ((value - nearest).abs() / size).min(FAR))
    };
    errors.iter().map(|error| each(error).unwrap_or(FAR)).sum()
}
