//! A study: one submission in many variants, each of which is computed.
//!
//! A study has a `base`, and changes it in one of four ways, by JSON pointers (RFC 6901) into the submission:
//! - `axes`: every combination of their values, the last axis changing fastest, as nested loops written in their order would;
//! - `designs`: a list with labels;
//! - `population`: members drawn from laws;
//! - `search`: designs chosen by the outcomes of earlier ones.
//!
//! A fault of the study itself is refused: a pointer that names no field, a value of the wrong type, a label that stands twice. So are a field of
//! the base that a design does not set, and more designs than the limit. A fault of one design is not refused: a tooth that is undercut, holes that
//! overlap. Such a design stands in the table with its problem.

mod constant_mass;
mod document;
mod faults;
mod labels;
mod prospects;
mod schema;
mod size;
#[cfg(test)]
mod tests;

use std::borrow::Cow;

use meshwright_engine::gear::Member;
use meshwright_engine::run::Run;
use meshwright_wire::Kept;
use meshwright_wire::declare::{Choice as _, Errors, Node};
use meshwright_wire::pointer::Pointer;
use meshwright_wire::problem::{Code, FieldError, Problem};
use meshwright_wire::submission::{MOST_TORQUES, Submission};
use meshwright_wire::warning::GearName;
use serde_json::{Map, Value};

use crate::population::{Population, Varied};
use crate::search::{Role, Search, confirming};
use constant_mass::ConstantMass;

/// One submission in many variants. It has been checked: it names known fields, and has no more designs than the limit.
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
    Search(Box<Search>),
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
    /// Its label; no other design of the study has the same.
    pub label: String,
    /// Its changes of the base: pointers and values, the hole radius among them where the study sets it.
    pub changes: Map<String, Value>,
    /// The submission, or why there is none.
    pub submission: Result<Submission, Problem>,
}

/// Places and their values.
type Changes<'a> = Vec<(&'a Pointer, Cow<'a, Value>)>;

/// A row that has been put together.
struct Composed {
    label: String,
    changes: Map<String, Value>,
    /// The submission, or why its changes lead nowhere.
    submission: Result<Node, Problem>,
}

impl Composed {
    /// The design, of a member of a population with its teeth.
    fn design(self, member: Option<(&Population, u32)>) -> Design {
        let submission = self.submission.and_then(|node| match member {
            Some((population, member)) => {
                Submission::of_node_with(&node, population.windows, |pair, method, errors| {
                    population.keep_roots(&node, pair);
                    population.give_teeth(member, pair, method, errors)
                })
            }
            None => Submission::of_node(&node),
        });
        Design {
            label: self.label,
            changes: self.changes,
            submission,
        }
    }
}

/// Values drawn for the varied fields.
fn drawn(varied: &[Varied], values: Vec<f64>) -> impl Iterator<Item = (&Pointer, Cow<'_, Value>)> {
    let drawn = varied.iter().zip(values);
    drawn.map(|(varied, value)| (&varied.path, Cow::Owned(varied.json_of(value))))
}

/// A document that is JSON, without white space between its tokens.
fn without_white_space(document: &[u8]) -> Result<String, Problem> {
    let (mut in_text, mut is_escaped) = (false, false);
    let stays = |&byte: &u8| {
        let stays = in_text || !byte.is_ascii_whitespace();
        in_text ^= byte == b'"' && !is_escaped;
        is_escaped = in_text && byte == b'\\' && !is_escaped;
        stays
    };
    let text = document.iter().copied().filter(stays).collect();
    String::from_utf8(text).map_err(|error| Problem::new(Code::MalformedJson, error.to_string()))
}

impl Study {
    /// The most output torques of a design.
    pub const MOST_TORQUES: usize = MOST_TORQUES;

    /// Reads and checks a study. The work is bounded by the size of the document; `run` stops it earlier.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400), `too_large` before anything is expanded, `stopped`, or 422 with the faults and a JSON pointer into the study.
    pub fn parse(document: &[u8], run: &Run) -> Result<Self, Problem> {
        size::refuse_too_many(document)?;
        let node = Node::parse(document)?;
        let errors = Errors::default();
        let study = document::read(node, without_white_space(document)?, &errors);
        if let (Some(study), 0) = (&study, errors.count()) {
            study.refuse_faults(&errors, run)?;
        }
        errors.settle(study)
    }

    /// The number of designs; of a search the most that it may come to.
    pub fn total(&self) -> usize {
        match &self.plan {
            Plan::Axes(axes) => axes.iter().map(|axis| axis.values.len()).product(),
            Plan::Designs(designs) => designs.len(),
            Plan::Population(population) => population.size(),
            Plan::Search(search) => search.most_rows(),
        }
    }

    /// Number of its designs whose gears may be unlike: the members of a design of a search have its gears.
    pub fn unlike_designs(&self) -> usize {
        match &self.plan {
            Plan::Search(search) => search.most_rows().div_ceil(search.rows_of_design()),
            Plan::Axes(_) | Plan::Designs(_) | Plan::Population(_) => self.total(),
        }
    }

    /// The population that its designs are, if they are one.
    pub(crate) fn population(&self) -> Option<&Population> {
        match &self.plan {
            Plan::Population(population) => Some(population),
            Plan::Axes(_) | Plan::Designs(_) | Plan::Search(_) => None,
        }
    }

    /// The search that chooses its designs, if one does.
    pub(crate) fn search(&self) -> Option<&Search> {
        match &self.plan {
            Plan::Search(search) => Some(search),
            Plan::Axes(_) | Plan::Designs(_) | Plan::Population(_) => None,
        }
    }

    /// The goals of a search, in words.
    pub fn goals(&self) -> Vec<String> {
        self.search().map_or_else(Vec::new, Search::goals_in_words)
    }

    /// The conditions of a search, in words.
    pub fn conditions(&self) -> Vec<String> {
        let search = self.search();
        search.map_or_else(Vec::new, Search::conditions_in_words)
    }

    /// True if its designs are the members of one population.
    pub fn is_population(&self) -> bool {
        self.population().is_some()
    }

    /// True if its designs are chosen by a search, one after the other.
    pub fn is_search(&self) -> bool {
        self.search().is_some()
    }

    /// The document as it was sent, without its white space.
    pub fn document(&self) -> &str {
        &self.document
    }

    /// The submission that designs are variants of.
    pub(crate) fn base(&self) -> &Node {
        &self.base
    }

    /// The client's name for it.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Short strings to find it by.
    pub fn tags(&self) -> &[String] {
        &self.tags
    }

    /// Extent of the stored results.
    pub fn keep(&self) -> Kept {
        self.keep
    }

    /// The same study, of whose results so much is kept.
    #[must_use]
    pub fn keeping(self, keep: Kept) -> Self {
        Self { keep, ..self }
    }

    /// The gear whose mass and holes the table shows: the one of constant mass, else the only one that changes, else
    /// the driven one.
    pub fn gear(&self) -> GearName {
        if let Some(rule) = &self.constant_mass {
            return rule.gear.into();
        }
        let touches = |member: Member| {
            let mut paths = self.paths();
            let drawn = self
                .population()
                .or(self.search().and_then(Search::population));
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
    fn paths(&self) -> Box<dyn Iterator<Item = &Pointer> + '_> {
        match &self.plan {
            Plan::Axes(axes) => Box::new(axes.iter().map(|axis| &axis.path)),
            Plan::Designs(designs) => {
                let changes = designs.iter().flat_map(|design| &design.changes);
                Box::new(changes.map(|(path, _)| path))
            }
            Plan::Population(population) => {
                Box::new(population.varied().iter().map(|varied| &varied.path))
            }
            Plan::Search(search) => Box::new(search.paths()),
        }
    }

    /// The design of a row, counted from 0; none beyond the last, and none of a search, whose rows follow from each other.
    pub fn design(&self, row: usize) -> Option<Design> {
        let member = self.population().zip(u32::try_from(row).ok());
        Some(self.composed(row)?.design(member))
    }

    /// The submission of a row, as JSON; one that cannot be built as far as it can be put together. None beyond the last row.
    pub fn submission_of(&self, row: usize) -> Option<String> {
        let design = self.design(row)?;
        Some(self.written(design.submission, || self.composed(row)))
    }

    /// The submission of a row of a search, which has these changes; none if it is no row of one.
    pub fn submission_searched(&self, label: &str, changes: &Map<String, Value>) -> Option<String> {
        let (role, search) = (Role::of_label(label)?, self.search()?);
        let changes = search.changes_among(changes)?;
        let design = self.searched(role, &changes);
        Some(self.written(design.submission, || {
            Some(self.composed_of_search(role, &changes).0)
        }))
    }

    fn written(
        &self,
        submission: Result<Submission, Problem>,
        composed: impl FnOnce() -> Option<Composed>,
    ) -> String {
        match submission {
            Ok(submission) => submission.canonical_json(),
            Err(_) => match composed().map(|composed| composed.submission) {
                Some(Ok(node)) => node.to_value().to_string(),
                _ => self.base.to_value().to_string(),
            },
        }
    }

    /// A design of a search, its variables having these values.
    pub(crate) fn searched(&self, role: Role, changes: &Map<String, Value>) -> Design {
        let (composed, population) = self.composed_of_search(role, changes);
        composed.design(population.as_ref().zip(role.member()))
    }

    /// The same before it is looked at as a whole; none if its changes lead nowhere.
    pub(crate) fn node_searched(&self, changes: &Map<String, Value>) -> Option<Node> {
        let (composed, _) = self.composed_of_search(Role::Design(1), changes);
        composed.submission.ok()
    }

    /// A design of a search put together, and the population that it has members of.
    fn composed_of_search(
        &self,
        role: Role,
        variables: &Map<String, Value>,
    ) -> (Composed, Option<Population>) {
        let population = match self.search() {
            Some(search) => search.population_with(&self.base, variables),
            None => Ok(None),
        };
        let population = match population {
            Ok(population) => population,
            Err(errors) => {
                let unmade = Composed {
                    label: role.to_string(),
                    changes: variables.clone(),
                    submission: Err(Problem::of_fields(errors)),
                };
                return (unmade, None);
            }
        };
        let confirming = match role {
            Role::Confirmed => confirming(self.base.at(&["method"])),
            Role::Design(_) | Role::Member(..) => Vec::new(),
        };
        let varied = population.as_ref().map_or(&[][..], Population::varied);
        let values = match (role.member(), &population) {
            (Some(member), Some(population)) => population.values(member),
            // As it is drawn, a design has the middle of each law.
            _ => varied.iter().map(Varied::median).collect(),
        };
        let drawn = drawn(varied, values);
        let own = self.search().into_iter().flat_map(Search::paths_of_base);
        let own = own.filter_map(|path| Some((path, Cow::Borrowed(variables.get(path.text())?))));
        let fixed = confirming.iter();
        let fixed = fixed.map(|(path, value)| (path, Cow::Borrowed(value)));
        let changes: Changes<'_> = own.chain(drawn).chain(fixed).collect();
        let composed = self.put_together(role.to_string(), variables.clone(), changes);
        (composed, population)
    }

    /// A row put together, before it is looked at as a whole.
    fn composed(&self, row: usize) -> Option<Composed> {
        let (label, changes) = self.changes(row)?;
        Some(self.put_together(label, Map::new(), changes))
    }

    /// The base with these changes; the row gets them in addition to those that it has.
    fn put_together(
        &self,
        label: String,
        mut row: Map<String, Value>,
        changes: Changes<'_>,
    ) -> Composed {
        let mut submission = self.base.clone();
        for (path, value) in changes {
            let put = submission.put(path.steps(), Node::of(&value));
            row.insert(path.text().to_owned(), value.into_owned());
            if put.is_none() {
                let detail = format!(
                    "{} names nothing in this design: what stands above it is no object, or a list without this place.",
                    path.text()
                );
                let error = FieldError::new(path.text(), Code::UnknownField, detail);
                return Composed {
                    label,
                    changes: row,
                    submission: Err(Problem::of_fields(vec![error])),
                };
            }
        }
        if let Some(rule) = &self.constant_mass {
            rule.apply(&mut submission, &mut row);
        }
        Composed {
            label,
            changes: row,
            submission: Ok(submission),
        }
    }

    /// The label and the changes of a row.
    fn changes(&self, row: usize) -> Option<(String, Changes<'_>)> {
        match &self.plan {
            Plan::Search(_) => None,
            Plan::Population(population) => {
                let member = u32::try_from(row)
                    .ok()
                    .filter(|_| row < population.size())?;
                let changes = drawn(population.varied(), population.values(member));
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
