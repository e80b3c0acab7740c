//! The document of a search, and its faults.

use std::sync::LazyLock;

use meshwright_wire::declare::{
    EACH, Errors, Kind, List, Location, Node, Number, Text, absent, document, list, nested, number,
    or_else, text, word,
};
use meshwright_wire::draw::SEED;
use meshwright_wire::pointer::{NumberKind, Pointer, Schema};
use meshwright_wire::problem::Code;
use meshwright_wire::submission::MOST_TORQUES;
use meshwright_wire::units::plain;

use super::torques::Torques;
use super::{Condition, Goal, MOST_EVALUATIONS, Measure, OF_POPULATION, Search, Variable};
use crate::MOST_DESIGNS;
use crate::optimum::space::Axis;
use crate::population::{Population, PopulationDocument, number_at, rises};
use crate::table::{QUANTITIES, Quantity};

/// The most variables, conditions, and parts of a cost.
const MOST: usize = 50;

/// A field of the submission, or of the population.
const PATH: Text = text("Path", 300);

document! {
    /// A search for the design with the least value of a goal. It asks for designs generation by generation, each chosen by the outcomes of earlier ones.
    pub(crate) struct SearchDocument as "Search", "Search" {
        /// Fields that differ between designs.
        variables: Vec<VariableDocument> =
            list("Variables", EACH, MOST).not_empty(Code::MissingField, "name what may differ"),
        /// Goals to make small. Of two goals the result is the front: the designs that no other one beats in both.
        minimize: Vec<GoalDocument> =
            list("Goals", EACH, 2).not_empty(Code::MissingField, "say what is to be small"),
        /// Conditions. Default: none.
        subject_to: Vec<ConditionDocument> = list("Conditions", EACH, MOST).or_empty(),
        /// The design as it is made: a goal or condition with a percent is looked at over its members.
        population: Option<PopulationDocument> =
            absent(nested("Population"), "designs as they are drawn"),
        /// Maximum number of designs that are computed, each over all members of the population.
        evaluations: u32 = number("Evaluations", "1", 2.0, MOST_EVALUATIONS).or(400.0),
        /// After so much time no further generation is begun.
        seconds: Option<f64> = absent(number("Time", "s", 1.0, 1e7), "no limit"),
        /// Seed of all random numbers: the same seed gives the same designs.
        seed: u32 = SEED,
    }
}

document! {
    /// A field that may differ between designs.
    pub(crate) struct VariableDocument as "SearchVariable", "Variable" {
        /// A JSON pointer to a number of the submission, or to one of the search's population, such as
        /// /population/accuracy/driving/iso_1328_class.
        path: String = PATH,
        /// The smallest value, in the unit of the field.
        low: f64 = value("Smallest value"),
        /// The largest value.
        high: f64 = value("Largest value"),
        /// The step from one value to the next. It has to lead from low to high.
        step: Option<f64> = absent(
            number("Step", "", 1e-9, 1e9),
            "every value between; of a field of whole numbers every whole one",
        ),
    }
}

document! {
    /// A goal to make small: a quantity, or a cost.
    pub(crate) struct GoalDocument as "SearchGoal", "Goal" {
        /// The quantity.
        quantity: Option<QuantityName> = or_else(&["cost"], ()),
        /// The cost: the sum of variables, each times its weight.
        cost: Option<Vec<CostDocument>> = or_else(
            &["quantity"],
            list("Cost", EACH, MOST).not_empty(Code::MissingField, "name what costs"),
        ),
        /// Which torque it is told of.
        torques: Torques = word("Torques").or(Torques::Largest),
        /// How much each of the base's output torques counts, in their order, where `torques` is
        /// `mean` or `rms`.
        weights: Option<Vec<f64>> = absent(WEIGHTS, "all alike"),
        /// The percentile over the members of the population that is told of it.
        percent: Option<f64> = absent(PERCENT, "the design as it is drawn"),
    }
}

document! {
    /// A part of a cost.
    pub(crate) struct CostDocument as "SearchCost", "Part of a cost" {
        /// The path of a variable.
        path: String = PATH,
        /// Cost of one unit of it; negative where more of it is cheaper.
        weight: f64 = value("Weight"),
    }
}

document! {
    /// A condition.
    pub(crate) struct ConditionDocument as "SearchCondition", "Condition" {
        /// The quantity.
        quantity: QuantityName = (),
        /// Lower bound.
        at_least: Option<f64> = absent(value("At least"), "no bound"),
        /// Upper bound.
        at_most: Option<f64> = absent(value("At most"), "no bound"),
        /// Which torque it is told of.
        torques: Torques = word("Torques").or(Torques::Largest),
        /// How much each of the base's output torques counts, in their order, where `torques` is
        /// `mean` or `rms`.
        weights: Option<Vec<f64>> = absent(WEIGHTS, "all alike"),
        /// The percentile over the members of the population that has to keep it.
        percent: Option<f64> = absent(PERCENT, "the design as it is drawn"),
    }
}

/// A value of some field or quantity, in its unit.
const fn value(title: &'static str) -> Number {
    number(title, "", -1e12, 1e12)
}

/// How much a torque counts.
const WEIGHT: Number = number("Weight", "1", 0.0, 1e6);

/// The weights of the torques.
const WEIGHTS: List<Number> = list("Weights", WEIGHT, MOST_TORQUES)
    .not_empty(Code::MissingField, "give each torque its weight");

/// A percentile.
const PERCENT: Number = number("Percentile", "%", 0.1, 99.9);

/// A quantity by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct QuantityName(&'static Quantity);

impl Kind for QuantityName {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, (): &()) -> Option<Self> {
        let found = match node {
            Node::Text(name) => Quantity::of_name(name),
            _ => None,
        };
        found.map(Self).or_else(|| {
            let names: Vec<&str> = QUANTITIES.iter().map(|quantity| quantity.name).collect();
            place.wrong_kind(node, &format!("one of {}", names.join(", ")))
        })
    }

    fn write<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name)
    }

    fn describe(about: &str, (): &()) -> serde_json::Value {
        let names: Vec<&str> = QUANTITIES.iter().map(|quantity| quantity.name).collect();
        serde_json::json!({ "type": "string", "title": "Quantity", "description": about, "enum": names })
    }
}

impl Search {
    /// Reads the search at `place` over `base`. Faults are reported there.
    pub(crate) fn read(
        node: &Node,
        base: Option<&Node>,
        place: &Location<'_>,
        errors: &Errors,
    ) -> Option<Self> {
        let before = errors.count();
        let document = SearchDocument::read(node, place, &EACH)?;
        let population = match document.population {
            None => None,
            Some(population) => {
                let made = population.made(base, &place.of("population"), errors)?;
                Some((node.at(&["population"])?.clone(), made))
            }
        };
        let varied = population.as_ref().map(|(_, population)| population);
        let variables = variables(&document.variables, varied, &place.of("variables"));
        if errors.count() > before {
            return None;
        }
        let reader = Reader {
            population: varied,
            variables: &variables,
            torques: base.and_then(|base| match base.at(&["output_torques_n_m"])? {
                Node::List(torques) => Some(torques.len()),
                _ => None,
            }),
        };
        let numbered = document.minimize.iter().enumerate();
        let goals: Vec<_> = numbered
            .map(|(i, goal)| reader.goal(goal, &place.of("minimize").of(&i.to_string())))
            .collect();
        let numbered = document.subject_to.iter().enumerate();
        let conditions: Vec<_> = numbered
            .map(|(i, one)| reader.condition(one, &place.of("subject_to").of(&i.to_string())))
            .collect();
        let goals = goals.into_iter().collect::<Option<Vec<Goal>>>()?;
        let conditions = conditions.into_iter().collect::<Option<Vec<Condition>>>()?;
        refuse_contradictions(&conditions, &place.of("subject_to"));
        let search = Self {
            variables,
            goals,
            conditions,
            population,
            evaluations: document.evaluations,
            seconds: document.seconds,
            seed: document.seed,
        };
        search.refuse_idle_population(place);
        search.refuse_too_many(place);
        (errors.count() == before).then_some(search)
    }

    fn refuse_idle_population(&self, place: &Location<'_>) {
        if self.population.is_some() && !self.looks_at_members() {
            let place = place.of("population");
            let detail = format!(
                "No goal and no condition has a percent, so that {place} would change nothing; give one a percent, or leave the population out."
            );
            place.wrong::<()>(Code::ConflictingFields, detail, None);
        }
    }

    fn refuse_too_many(&self, place: &Location<'_>) {
        let each = self.rows_of_design();
        let most = MOST_DESIGNS.saturating_sub(1) / each;
        if self.evaluations as usize > most {
            let place = place.of("evaluations");
            let detail = format!(
                "{place} is {}; with {} members each these are more than the {MOST_DESIGNS} designs that a study may have. At most {most} fit.",
                self.evaluations,
                each - 1,
            );
            place.wrong::<()>(Code::TooLarge, detail, Some(most as f64));
        }
    }
}

fn variables(
    documents: &[VariableDocument],
    population: Option<&Population>,
    place: &Location<'_>,
) -> Vec<Variable> {
    let mut variables: Vec<Variable> = Vec::new();
    for (i, document) in documents.iter().enumerate() {
        let place = place.of(&i.to_string());
        let Some(variable) = document.made(&place) else {
            continue;
        };
        let place = place.of("path");
        let path = variable.path.text();
        if let Some(j) = variables
            .iter()
            .position(|earlier| earlier.path == variable.path)
        {
            let detail = format!("{path} is a variable already, item {j}.");
            place.wrong::<()>(Code::OutOfRange, detail, None);
        }
        if variable.is_of_population() && population.is_none() {
            let detail =
                format!("{path} is a field of the search's population, and there is none.");
            place.wrong::<()>(Code::MissingField, detail, None);
        }
        let laws = population.into_iter().flat_map(Population::varied);
        if let Some((law, _)) = (0..)
            .zip(laws)
            .find(|(_, varied)| varied.path == variable.path)
        {
            let detail = format!(
                "{path} follows a law in the population, which would stand in its place in every member. Make a number of the law the variable, such as /population/vary/{law}/mean."
            );
            place.wrong::<()>(Code::ConflictingFields, detail, None);
        }
        variables.push(variable);
    }
    variables
}

static POPULATION: LazyLock<Schema> =
    LazyLock::new(|| Schema::of::<PopulationDocument>("a population"));

/// Kind of number of a variable's field: one of the submission, or one of the population.
fn number_kind(pointer: &Pointer) -> Result<NumberKind, (Code, String)> {
    match pointer.steps() {
        // Designs are compared by their members.
        [first, only] if first == OF_POPULATION && (only == "size" || only == "seed") => {
            let detail = format!("{} has to be the same for all designs.", pointer.text());
            Err((Code::OutOfRange, detail))
        }
        [first, rest @ ..] if first == OF_POPULATION => pointer.number_kind_in(&POPULATION, rest),
        _ => pointer.number_kind(),
    }
}

impl VariableDocument {
    fn made(&self, place: &Location<'_>) -> Option<Variable> {
        let (path, whole) = number_at(&self.path, &place.of("path"), number_kind)?;
        rises(place, self.low, self.high)?;
        if whole {
            for (name, value) in [
                ("low", self.low),
                ("high", self.high),
                ("step", self.step.unwrap_or(1.0)),
            ] {
                if value.fract() != 0.0 {
                    let place = place.of(name);
                    let detail = format!(
                        "{place} is {}; {} takes whole numbers.",
                        plain(value),
                        path.text()
                    );
                    return place.wrong(Code::WrongType, detail, Some(value.round()));
                }
            }
        }
        let step = self.step.or(whole.then_some(1.0));
        let axis = match step {
            None => Axis::Continuous,
            Some(step) => Axis::Steps(self.steps(step, &place.of("step"))?),
        };
        Some(Variable {
            path,
            low: self.low,
            high: self.high,
            axis,
            whole,
        })
    }

    /// How many steps lead from low to high.
    fn steps(&self, step: f64, place: &Location<'_>) -> Option<u32> {
        let steps = (self.high - self.low) / step;
        let nearest = steps.round().max(1.0);
        if (steps - nearest).abs() <= 1e-9 * nearest && nearest <= 1e6 {
            return Some(nearest as u32);
        }
        let nearest = nearest.min(1e6);
        let fitting = (self.high - self.low) / nearest;
        let detail = format!(
            "{place} is {}; {} such steps lead from {} to {}, where a whole number of them, at most a million, is needed.",
            plain(step),
            plain(steps),
            plain(self.low),
            plain(self.high)
        );
        place.wrong(Code::OutOfRange, detail, Some(fitting))
    }
}

/// Reader of goals and conditions.
struct Reader<'a> {
    population: Option<&'a Population>,
    variables: &'a [Variable],
    /// The output torques of the base, if they are a list.
    torques: Option<usize>,
}

impl Reader<'_> {
    fn goal(&self, document: &GoalDocument, place: &Location<'_>) -> Option<Goal> {
        if let Some(quantity) = document.quantity {
            let torques = (document.torques, document.weights.as_deref());
            let measure = self.measure(quantity, torques, document.percent, place)?;
            return Some(Goal::Quantity(measure));
        }
        for (field, is_given, same) in [
            ("percent", document.percent.is_some(), "for all members"),
            ("weights", document.weights.is_some(), "under all torques"),
        ] {
            if is_given {
                let place = place.of(field);
                let detail = format!("{place} stands beside cost, which is the same {same}.");
                return place.wrong(Code::ConflictingFields, detail, None);
            }
        }
        let parts = document.cost.iter().flatten().enumerate().map(|(i, part)| {
            let known = |variable: &Variable| variable.path.text() == part.path;
            let found = self.variables.iter().position(known);
            let found = found.map(|variable| (variable, part.weight));
            found.or_else(|| {
                let place = place.of("cost").of(&i.to_string()).of("path");
                let paths: Vec<&str> = self
                    .variables
                    .iter()
                    .map(|variable| variable.path.text())
                    .collect();
                let detail = format!(
                    "{} is none of the variables, which are {}.",
                    part.path,
                    paths.join(", ")
                );
                place.wrong(Code::UnknownField, detail, None)
            })
        });
        let parts: Vec<_> = parts.collect();
        Some(Goal::Cost(parts.into_iter().collect::<Option<Vec<_>>>()?))
    }

    fn condition(&self, document: &ConditionDocument, place: &Location<'_>) -> Option<Condition> {
        let torques = (document.torques, document.weights.as_deref());
        let measure = self.measure(document.quantity, torques, document.percent, place);
        if document.at_least.is_none() && document.at_most.is_none() {
            let detail = format!("{place} needs one of at_least, at_most; it has none.");
            return place.wrong(Code::MissingField, detail, None);
        }
        Some(Condition {
            measure: measure?,
            at_least: document.at_least,
            at_most: document.at_most,
        })
    }

    /// A measure of designs. Whether they tell it is looked at once they can be put together.
    fn measure(
        &self,
        QuantityName(quantity): QuantityName,
        (torques, weights): (Torques, Option<&[f64]>),
        percent: Option<f64>,
        place: &Location<'_>,
    ) -> Option<Measure> {
        self.check_weights(torques, weights, &place.of("weights"))?;
        if percent.is_some() && self.population.is_none() {
            let place = place.of("percent");
            let detail = format!(
                "{place} is given, and the search has no population whose percentile it could be."
            );
            return place.wrong(Code::MissingField, detail, None);
        }
        Some(Measure {
            quantity,
            torques,
            weights: weights.unwrap_or_default().to_vec(),
            percent,
        })
    }

    /// Refuses weights that are not one for each torque of the base, or count nothing.
    fn check_weights(
        &self,
        torques: Torques,
        weights: Option<&[f64]>,
        place: &Location<'_>,
    ) -> Option<()> {
        let Some(weights) = weights else {
            return Some(());
        };
        if torques == Torques::Largest {
            let detail = format!(
                "{place} is given, and the torque at which it is worst has no weight; torques mean and rms have."
            );
            return place.wrong(Code::ConflictingFields, detail, None);
        }
        if let Some(count) = self.torques.filter(|count| *count != weights.len()) {
            let detail = format!(
                "{place} has {}; the base has {count} output torques, and each needs one.",
                weights.len()
            );
            return place.wrong(Code::OutOfRange, detail, Some(count as f64));
        }
        if weights.iter().sum::<f64>() <= 0.0 {
            let detail = format!("{place} are all 0, so that no torque counts.");
            return place.wrong(Code::OutOfRange, detail, None);
        }
        Some(())
    }
}

/// Refuses bounds of one quantity that no design keeps.
fn refuse_contradictions(conditions: &[Condition], place: &Location<'_>) {
    for (i, one) in conditions.iter().enumerate() {
        let same = |other: &&Condition| {
            other.measure.quantity.name == one.measure.quantity.name
                && other.measure.percent == one.measure.percent
        };
        let bounds = |bound: fn(&Condition) -> Option<f64>| {
            conditions[..=i].iter().filter(same).filter_map(bound)
        };
        let least = bounds(|one| one.at_least).reduce(f64::max);
        let most = bounds(|one| one.at_most).reduce(f64::min);
        if let (Some(least), Some(most)) = (least, most)
            && least > most
        {
            let given = if one.at_most == Some(most) {
                "at_most"
            } else {
                "at_least"
            };
            let detail = format!(
                "{} has to be at least {} and at most {}, which no design is.",
                one.measure.quantity.name,
                plain(least),
                plain(most)
            );
            place
                .of(&i.to_string())
                .of(given)
                .wrong::<()>(Code::OutOfRange, detail, None);
            return;
        }
    }
}
