//! A study: one submission in many variants, each of which is computed.
//!
//! A study has a `base`, and says by `axes`, by `designs` or by a `population` what changes in it. Axes give every combination of their
//! values, the last axis changing fastest, as nested loops written in their order would; designs are listed with their
//! labels; the members of a population are drawn from laws. What changes is named by JSON pointers (RFC 6901) into the submission.
//!
//! What is wrong with the study itself is refused: a pointer that names no field, a value of the wrong type, a field of
//! the base that no design mends, a label that stands twice, more designs than the limit. What is wrong with one design
//! is not: a tooth that is undercut, holes that overlap. Such a design stands in the table with its problem.

mod constant_mass;
mod document;
mod faults;
mod labels;
mod schema;
mod size;
#[cfg(test)]
mod tests;

use std::borrow::Cow;

use meshwright_engine::gear::Member;
use meshwright_engine::run::Run;
use serde_json::{Map, Value};

use super::declare::{Choice as _, Errors, Node};
use super::kept::Kept;
use super::pointer::Pointer;
use super::population::{Population, Varied};
use super::problem::{Code, FieldError, Problem};
use super::submission::{MOST_TORQUES, Submission};
use super::warning::GearName;
use constant_mass::ConstantMass;

pub use size::MOST_DESIGNS;

/// One submission in many variants. What exists names fields that there are, and has no more designs than the limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The document as it was sent, without its white space.
    document: String,
    name: Option<String>,
    tags: Vec<String>,
    keep: Kept,
    base: Node,
    plan: Plan,
    constant_mass: Option<ConstantMass>,
}

#[derive(Debug, Clone, PartialEq)]
enum Plan {
    Axes(Vec<Axis>),
    Designs(Vec<Listed>),
    Population(Box<Population>),
}

/// A field and the values that it takes.
#[derive(Debug, Clone, PartialEq)]
struct Axis {
    path: Pointer,
    values: Vec<Value>,
    /// For each value, how a label says it.
    words: Vec<String>,
}

/// A design of the list.
#[derive(Debug, Clone, PartialEq)]
struct Listed {
    label: String,
    changes: Vec<(Pointer, Value)>,
}

/// One variant of the base.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// What it is called; no other design of the study is called so.
    pub label: String,
    /// What it changes in the base: pointers and values, the hole radius among them where the study sets it.
    pub changes: Map<String, Value>,
    /// The submission, or why there is none.
    pub submission: Result<Submission, Problem>,
}

/// Places and what stands there.
type Changes<'a> = Vec<(&'a Pointer, Cow<'a, Value>)>;

/// A row that has been put together.
struct Composed {
    label: String,
    changes: Map<String, Value>,
    /// The submission, or why its changes lead nowhere.
    submission: Result<Node, Problem>,
}

impl Study {
    /// The most output torques of a design.
    pub const MOST_TORQUES: usize = MOST_TORQUES;

    /// Reads and checks a study. The work is bounded by the size of the document; `run` stops it earlier.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400), `too_large` before anything is expanded, `stopped`, or 422 with what is
    /// wrong and a JSON pointer into the study.
    pub fn parse(document: &[u8], run: &Run) -> Result<Self, Problem> {
        size::refuse_too_many(document)?;
        let node = Node::parse(document)?;
        let value: Value = serde_json::from_slice(document)
            .map_err(|error| Problem::new(Code::MalformedJson, error.to_string()))?;
        let errors = Errors::default();
        let Some(study) = document::read(node, value, &errors) else {
            return Err(errors.into_problem());
        };
        if errors.count() == 0 {
            study.refuse_faults(&errors, run)?;
        }
        if errors.count() == 0 {
            Ok(study)
        } else {
            Err(errors.into_problem())
        }
    }

    /// The number of designs.
    pub fn total(&self) -> usize {
        match &self.plan {
            Plan::Axes(axes) => axes.iter().map(|axis| axis.values.len()).product(),
            Plan::Designs(designs) => designs.len(),
            Plan::Population(population) => population.size(),
        }
    }

    /// The population that its designs are, if they are one.
    pub(super) fn population(&self) -> Option<&Population> {
        match &self.plan {
            Plan::Population(population) => Some(population),
            Plan::Axes(_) | Plan::Designs(_) => None,
        }
    }

    /// The document as it was sent, without its white space.
    pub fn document(&self) -> &str {
        &self.document
    }

    /// The submission that designs are variants of.
    pub(super) fn base(&self) -> &Node {
        &self.base
    }

    /// What the client calls it.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Short strings to find it by.
    pub fn tags(&self) -> &[String] {
        &self.tags
    }

    /// How much of what is computed is kept.
    pub fn keep(&self) -> Kept {
        self.keep
    }

    /// The gear that the table tells mass and holes of: the one of constant mass, else the only one that changes, else
    /// the driven one.
    pub fn gear(&self) -> GearName {
        if let Some(rule) = &self.constant_mass {
            return rule.gear.into();
        }
        let touches = |member: Member| {
            let mut paths = self.paths();
            let drawn = self.population();
            paths.any(|path| path.starts_with(&["pair", member.word()]))
                || drawn.is_some_and(|population| population.draws_teeth_of(member))
        };
        if touches(Member::Driving) && !touches(Member::Driven) {
            GearName::Driving
        } else {
            GearName::Driven
        }
    }

    /// Every place that a design changes, those of the list as often as they stand there.
    fn paths(&self) -> impl Iterator<Item = &Pointer> {
        let (axes, designs, varied) = match &self.plan {
            Plan::Axes(axes) => (&axes[..], &[][..], &[][..]),
            Plan::Designs(designs) => (&[][..], &designs[..], &[][..]),
            Plan::Population(population) => (&[][..], &[][..], population.varied()),
        };
        let listed = designs.iter().flat_map(|design: &Listed| &design.changes);
        let of_axes = axes.iter().map(|axis: &Axis| &axis.path);
        let of_members = varied.iter().map(|varied: &Varied| &varied.path);
        of_axes
            .chain(listed.map(|(path, _)| path))
            .chain(of_members)
    }

    /// The design of a row, counted from 0; none beyond the last.
    pub fn design(&self, row: usize) -> Option<Design> {
        let Composed {
            label,
            changes,
            submission,
        } = self.composed(row)?;
        let submission = submission.and_then(|submission| match &self.plan {
            Plan::Population(population) => {
                Submission::of_node_with(&submission, |pair, errors| {
                    population.give_teeth(row as u32, pair, errors)
                })
            }
            Plan::Axes(_) | Plan::Designs(_) => Submission::of_node(&submission),
        });
        Some(Design {
            label,
            changes,
            submission,
        })
    }

    /// The submission of a row, as JSON; one that cannot be built as far as it can be put together. None beyond the last row.
    pub fn submission_of(&self, row: usize) -> Option<String> {
        let design = self.design(row)?;
        Some(match design.submission {
            Ok(submission) => submission.canonical_json(),
            Err(_) => match self.composed(row)?.submission {
                Ok(node) => node.to_value().to_string(),
                Err(_) => self.base.to_value().to_string(),
            },
        })
    }

    /// A row put together, before it is looked at as a whole.
    fn composed(&self, row: usize) -> Option<Composed> {
        let (label, changes) = self.changes(row)?;
        let mut submission = self.base.clone();
        let mut told = Map::new();
        for (path, value) in changes {
            let put = submission.put(path.steps(), Node::of(&value));
            told.insert(path.text().to_owned(), value.into_owned());
            if put.is_none() {
                let detail = format!(
                    "{} names nothing in this design: what stands above it is no object, or a list without this place.",
                    path.text()
                );
                let error = FieldError::new(path.text(), Code::UnknownField, detail);
                return Some(Composed {
                    label,
                    changes: told,
                    submission: Err(Problem::of_fields(vec![error])),
                });
            }
        }
        if let Some(rule) = &self.constant_mass {
            rule.apply(&mut submission, &mut told);
        }
        Some(Composed {
            label,
            changes: told,
            submission: Ok(submission),
        })
    }

    /// The label and the changes of a row.
    fn changes(&self, row: usize) -> Option<(String, Changes<'_>)> {
        match &self.plan {
            Plan::Population(population) => {
                let member = u32::try_from(row)
                    .ok()
                    .filter(|_| row < population.size())?;
                let values = population.values(member).into_iter();
                let changes = population
                    .varied()
                    .iter()
                    .zip(values)
                    .map(|(varied, value)| (&varied.path, Cow::Owned(varied.told(value))));
                Some((format!("member {member}"), changes.collect()))
            }
            Plan::Designs(designs) => {
                let design = designs.get(row)?;
                let changes = design.changes.iter();
                let changes = changes.map(|(path, value)| (path, Cow::Borrowed(value)));
                Some((design.label.clone(), changes.collect()))
            }
            Plan::Axes(axes) => {
                let mut rest = row;
                let mut places = vec![0; axes.len()];
                for (place, axis) in places.iter_mut().zip(axes).rev() {
                    (rest, *place) = (rest / axis.values.len(), rest % axis.values.len());
                }
                if rest > 0 {
                    return None;
                }
                let chosen = || axes.iter().zip(&places);
                let words: Vec<&str> = chosen()
                    .map(|(axis, &place)| axis.words[place].as_str())
                    .collect();
                let changes =
                    chosen().map(|(axis, &place)| (&axis.path, Cow::Borrowed(&axis.values[place])));
                Some((words.join(", "), changes.collect()))
            }
        }
    }
}
