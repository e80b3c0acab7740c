//! A search: the choice of designs of a base to compute, each by the outcomes of earlier ones.
//!
//! `document` declares goals and variables, `Search` turns a point of the search into a design, `measure` judges a design. [`searching`](crate::searching)
//! leads from one generation to the next. [`optimum`](crate::optimum) chooses the points.

mod document;
pub(crate) mod measure;
#[cfg(test)]
mod tests;
mod torques;

use meshwright_wire::declare::{Errors, Location, Node};
use meshwright_wire::pointer::Pointer;
use meshwright_wire::problem::{Code, FieldError};
use meshwright_wire::resolution::sees_faces;
use meshwright_wire::units::significant;
use serde_json::{Map, Value, json};

use crate::optimum::driver::Problem as Space;
use crate::optimum::space::Axis;
use crate::population::Population;
use crate::sample::REPLICATES;
use crate::sample::points::{Points, Sampling};
use crate::table::Quantity;
use torques::Torques;

pub(crate) use document::SearchDocument;

/// The most designs of a search.
const MOST_EVALUATIONS: f64 = 20_000.0;

/// A search. Each of its variables has been checked: the base, or the population, takes a number there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search {
    pub(crate) variables: Vec<Variable>,
    pub(crate) goals: Vec<Goal>,
    pub(crate) conditions: Vec<Condition>,
    /// The population over which designs are looked at, as it was written and as it was read.
    population: Option<(Node, Population)>,
    pub(crate) evaluations: u32,
    seconds: Option<f64>,
    seed: u32,
}

/// A field that may differ between designs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Variable {
    pub(crate) path: Pointer,
    low: f64,
    high: f64,
    axis: Axis,
    /// True if the field takes whole numbers.
    whole: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Goal {
    Quantity(Measure),
    /// Variables by their numbers, and their weights.
    Cost(Vec<(usize, f64)>),
}

/// A quantity of a design, or of its members, at all torques together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Measure {
    quantity: &'static Quantity,
    torques: Torques,
    /// How much each torque counts, in their order; all alike if there are none.
    weights: Vec<f64>,
    percent: Option<f64>,
}

impl Measure {
    fn in_words(&self) -> String {
        match self.percent {
            None => self.quantity.name.to_owned(),
            Some(percent) => format!("p{percent} of {}", self.quantity.name),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Condition {
    measure: Measure,
    at_least: Option<f64>,
    at_most: Option<f64>,
}

/// The first step of paths into the population of the search.
const OF_POPULATION: &str = "population";

impl Variable {
    fn is_of_population(&self) -> bool {
        self.path.starts_with(&[OF_POPULATION])
    }

    /// The value at a point of its axis.
    pub(crate) fn at(&self, u: f64) -> f64 {
        let value = self.low + u * (self.high - self.low);
        match self.axis {
            // Digits that are the same on every machine that adds them up.
            Axis::Steps(_) => significant(value, 12),
            // Nobody makes anything finer than a hundred thousandth of its range, or wants to read it.
            Axis::Continuous => {
                let digits = -((self.high - self.low) * 1e-5).log10().floor();
                let unit = 10_f64.powf(digits);
                significant((value * unit).round() / unit, 12).clamp(self.low, self.high)
            }
        }
    }

    /// The same as JSON has it.
    fn json_at(&self, u: f64) -> Value {
        let value = self.at(u);
        if self.whole {
            json!(value.round() as i64)
        } else {
            json!(value)
        }
    }

    /// Where a value stands on its axis, or the end nearest to it.
    fn place_of(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

impl Search {
    /// Designs of a generation are looked at over so many seconds at most.
    pub(crate) fn seconds(&self) -> Option<f64> {
        self.seconds
    }

    /// The most rows that it makes: its designs with their members, and the best one once more.
    pub(crate) fn most_rows(&self) -> usize {
        self.evaluations as usize * self.rows_of_design() + 1
    }

    /// A design and its members.
    pub(crate) fn rows_of_design(&self) -> usize {
        1 + if self.looks_at_members() {
            self.members()
        } else {
            0
        }
    }

    pub(crate) fn members(&self) -> usize {
        self.population
            .as_ref()
            .map_or(0, |(_, population)| population.size())
    }

    pub(crate) fn looks_at_members(&self) -> bool {
        let of_goals = self.goals.iter().filter_map(|goal| match goal {
            Goal::Quantity(measure) => Some(measure),
            Goal::Cost(_) => None,
        });
        let mut measures = of_goals.chain(self.conditions.iter().map(|one| &one.measure));
        measures.any(|measure| measure.percent.is_some())
    }

    /// The fields of the submission that differ between its rows.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Pointer> {
        let varied = self
            .population
            .iter()
            .flat_map(|(_, population)| population.varied());
        self.paths_of_base()
            .chain(varied.map(|varied| &varied.path))
    }

    /// Paths of the variables in the base.
    pub(crate) fn paths_of_base(&self) -> impl Iterator<Item = &Pointer> {
        let own = self
            .variables
            .iter()
            .filter(|variable| !variable.is_of_population());
        own.map(|variable| &variable.path)
    }

    /// The paths of its variables, in their order.
    pub(crate) fn paths_of_variables(&self) -> impl Iterator<Item = &Pointer> {
        self.variables.iter().map(|variable| &variable.path)
    }

    /// The variables among the changes of a row; `None` if one is missing.
    pub(crate) fn changes_among(&self, row: &Map<String, Value>) -> Option<Map<String, Value>> {
        let paths = self.paths_of_variables().map(Pointer::text);
        paths
            .map(|path| Some((path.to_owned(), row.get(path)?.clone())))
            .collect()
    }

    /// The population as it was sent.
    pub(crate) fn population(&self) -> Option<&Population> {
        self.population.as_ref().map(|(_, population)| population)
    }

    /// Its goals, as a line of text names them.
    pub(crate) fn goals_in_words(&self) -> Vec<String> {
        let goals = self.goals.iter().map(|goal| match goal {
            Goal::Quantity(measure) => measure.in_words(),
            Goal::Cost(_) => "cost".to_owned(),
        });
        goals.collect()
    }

    /// Its conditions, as a line of text names them.
    pub(crate) fn conditions_in_words(&self) -> Vec<String> {
        let conditions = self.conditions.iter();
        conditions.map(|one| one.measure.in_words()).collect()
    }

    /// The space of the search, as numbers.
    pub(crate) fn space(&self, base: &Node) -> Space {
        Space {
            axes: self
                .variables
                .iter()
                .map(|variable| variable.axis)
                .collect(),
            goals: self.goals.len(),
            conditions: self.conditions.len(),
            evaluations: self.evaluations,
            seed: self.seed,
            start: self.start(base),
        }
    }

    /// The base as a design of the search; none where it says nothing of the variables.
    fn start(&self, base: &Node) -> Option<Vec<f64>> {
        let given = self.variables.iter().map(|variable| {
            let steps: Vec<&str> = variable.path.steps().iter().map(String::as_str).collect();
            if variable.is_of_population() {
                self.population.as_ref()?.0.number_at(&steps[1..])
            } else {
                base.number_at(&steps)
            }
        });
        let given: Vec<Option<f64>> = given.collect();
        given.iter().any(Option::is_some).then(|| {
            let places = self.variables.iter().zip(given);
            places
                .map(|(variable, value)| value.map_or(0.5, |value| variable.place_of(value)))
                .collect()
        })
    }

    /// The changes at a point of the search: values of the variables, in their order.
    pub(crate) fn changes_at(&self, point: &[f64]) -> Map<String, Value> {
        let placed = self.variables.iter().zip(point);
        placed
            .map(|(variable, u)| (variable.path.text().to_owned(), variable.json_at(*u)))
            .collect()
    }

    /// The population of a design with these changes.
    ///
    /// # Errors
    ///
    /// Faults of a law beside the variables.
    pub(crate) fn population_with(
        &self,
        base: &Node,
        changes: &Map<String, Value>,
    ) -> Result<Option<Population>, Vec<FieldError>> {
        let Some((node, population)) = &self.population else {
            return Ok(None);
        };
        let own = || {
            self.variables
                .iter()
                .filter(|variable| variable.is_of_population())
        };
        if own().next().is_none() {
            return Ok(Some(population.clone()));
        }
        let errors = Errors::default();
        let mut node = node.clone();
        for variable in own() {
            let value = changes.get(variable.path.text()).map(Node::of);
            let put = value.and_then(|value| node.put(&variable.path.steps()[1..], value));
            if put.is_none() {
                let detail = format!("{} names nothing in the population.", variable.path.text());
                errors.push(FieldError::new(
                    variable.path.text(),
                    Code::UnknownField,
                    detail,
                ));
            }
        }
        let place = Location::root(&errors).of(OF_POPULATION);
        let population = Population::read(&node, Some(base), &place, &errors);
        let population = errors.settle(population);
        population.map(Some).map_err(|problem| problem.errors)
    }

    /// Every variable at an end of its range, the others in the middle of theirs: the variable, the name of the end, and the changes.
    pub(crate) fn ends(&self) -> impl Iterator<Item = (usize, &'static str, Map<String, Value>)> {
        (0..self.variables.len()).flat_map(move |i| {
            [("low", 0.0), ("high", 1.0)].map(|(name, u)| {
                let mut point: Vec<f64> = self
                    .variables
                    .iter()
                    .map(|variable| variable.axis.snapped(0.5))
                    .collect();
                point[i] = u;
                (i, name, self.changes_at(&point))
            })
        })
    }

    /// Designs that show possible outcomes of the search before anything is computed: the base, the ends of each variable, and some spread evenly.
    pub(crate) fn trials(&self, base: &Node) -> impl Iterator<Item = Map<String, Value>> {
        const SPREAD: u32 = 32;
        let points = Points {
            sampling: Sampling::Sobol,
            seed: self.seed,
        };
        let spread = (0..SPREAD).map(move |place| {
            let axes = self.variables.iter().zip(0..);
            let point: Vec<f64> = axes
                .map(|(variable, axis)| variable.axis.snapped(points.at(place * REPLICATES, axis)))
                .collect();
            self.changes_at(&point)
        });
        let start = self.start(base).map(|point| self.changes_at(&point));
        let ends = self.ends().map(|(_, _, changes)| changes);
        start.into_iter().chain(ends).chain(spread)
    }

    /// The quantities that it goes by, of designs as they are drawn or as a `percent` of their members: where each is asked for.
    pub(crate) fn asked(&self, percent: bool) -> Vec<(String, &'static Quantity, Option<String>)> {
        let goals = (0..).zip(&self.goals).filter_map(|(i, goal)| match goal {
            Goal::Quantity(measure) => Some(("minimize", i, measure)),
            Goal::Cost(_) => None,
        });
        let conditions = (0..).zip(&self.conditions);
        let conditions = conditions.map(|(i, one)| ("subject_to", i, &one.measure));
        let asked = goals.chain(conditions);
        asked
            .filter(|(.., measure)| measure.percent.is_some() == percent)
            .map(|(list, i, measure)| {
                let pointer = format!("/search/{list}/{i}/quantity");
                (pointer, measure.quantity, None)
            })
            .collect()
    }

    /// The path of a variable.
    pub(crate) fn path_of(&self, variable: usize) -> &Pointer {
        &self.variables[variable].path
    }
}

/// Kind of a row of a search, by its label.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// A design as it is drawn, by its number, from 1.
    Design(usize),
    /// A member of its population, from 0.
    Member(usize, u32),
    /// The best design once more, by the method that sees most, on the fine grid.
    Confirmed,
}

impl std::fmt::Display for Role {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Design(number) => write!(f, "design {number}"),
            Self::Member(number, member) => write!(f, "design {number}, member {member}"),
            Self::Confirmed => f.write_str("confirmed"),
        }
    }
}

impl Role {
    /// Of a member its number.
    pub(crate) fn member(self) -> Option<u32> {
        match self {
            Self::Member(_, member) => Some(member),
            Self::Design(_) | Self::Confirmed => None,
        }
    }

    /// Kind of the row of this label.
    pub(crate) fn of_label(label: &str) -> Option<Self> {
        if label == Self::Confirmed.to_string() {
            return Some(Self::Confirmed);
        }
        let rest = label.strip_prefix("design ")?;
        match rest.split_once(", member ") {
            None => Some(Self::Design(rest.parse().ok()?)),
            Some((number, member)) => {
                Some(Self::Member(number.parse().ok()?, member.parse().ok()?))
            }
        }
    }
}

/// Changes of the best design for its confirmation: the method that has most of the effects of its own, and the finest grid.
pub(crate) fn confirming(method: Option<&Node>) -> Vec<(Pointer, Value)> {
    let method = if method.is_some_and(sees_faces) {
        "three_dimensional"
    } else {
        "flexible"
    };
    let changes = [
        ("/method", json!(method)),
        ("/resolution/grid", json!("fine")),
        ("/resolution/error_estimate", json!(true)),
    ];
    let named = |(path, value)| Some((Pointer::parse(path).ok()?, value));
    changes.into_iter().filter_map(named).collect()
}
