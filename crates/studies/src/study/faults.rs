//! Faults of a study independent of the place: unknown fields, and values that no submission may have, in the base and in each change. Each design checks its
//! values against each other.

use std::collections::HashSet;

use meshwright_engine::run::Run;
use meshwright_wire::declare::{Errors, Node, escaped};
use meshwright_wire::pointer::Pointer;
use meshwright_wire::problem::{Code, FieldError, Problem};
use meshwright_wire::submission::Submission;
use serde_json::Value;

use super::constant_mass::ConstantMass;
use super::{Plan, Study};
use crate::population::Population;
use crate::search::Search;

/// Between so many designs it is asked whether anybody still waits.
const BETWEEN_LOOKS: usize = 64;

impl Study {
    /// Reports every fault to `errors`.
    ///
    /// # Errors
    ///
    /// `stopped`, if `run` is.
    pub(super) fn refuse_faults(&self, errors: &Errors, run: &Run) -> Result<(), Problem> {
        self.check_constant_mass(errors);
        self.check_base(errors);
        if errors.count() > 0 {
            return Ok(());
        }
        match &self.plan {
            Plan::Axes(_) => self.check_axes(errors, run),
            Plan::Designs(_) => self.check_designs(errors, run),
            Plan::Population(population) => {
                self.check_population(population, "/population", errors);
                Ok(())
            }
            Plan::Search(search) => {
                if let Some(population) = search.population() {
                    self.check_population(population, "/search/population", errors);
                }
                self.check_search(search, errors);
                Ok(())
            }
        }
    }

    /// Refuses faulty fields of the base, unless each design sets them.
    fn check_base(&self, errors: &Errors) {
        let mended = |error: &FieldError| {
            let pointer = &error.pointer;
            let is_set = |path: &Pointer| path.covers(pointer) || path.is_below(pointer);
            let by_rule = |rule: &ConstantMass| rule.sets(pointer);
            let by_designs = || match &self.plan {
                Plan::Designs(designs) => designs
                    .iter()
                    .all(|design| design.changes.iter().any(|(path, _)| is_set(path))),
                _ => self.paths().any(is_set),
            };
            // A list that is too long is so whatever stands in it, and no base that anybody means.
            error.code != Code::TooLarge
                && (self.constant_mass.as_ref().is_some_and(by_rule) || by_designs())
        };
        for error in Submission::wrong_fields(&self.base) {
            if !mended(&error) {
                errors.push(FieldError {
                    pointer: format!("/base{}", error.pointer),
                    ..error
                });
            }
        }
    }

    fn check_axes(&self, errors: &Errors, run: &Run) -> Result<(), Problem> {
        let Plan::Axes(axes) = &self.plan else {
            return Ok(());
        };
        // An axis may change a part that an axis before it brings.
        let mut before = self.base.clone();
        let mut right = HashSet::new();
        for (i, axis) in axes.iter().enumerate() {
            for (j, value) in axis.values.iter().enumerate() {
                look_around(j, run)?;
                let place = format!("/axes/{i}/values/{j}");
                check_changes(
                    &mut before,
                    &mut right,
                    &[(&axis.path, value, place)],
                    errors,
                );
            }
            if errors.count() > 0 {
                return Ok(());
            }
            before.put(axis.path.steps(), Node::of(&axis.values[0]));
            right.clear();
        }
        Ok(())
    }

    fn check_designs(&self, errors: &Errors, run: &Run) -> Result<(), Problem> {
        let Plan::Designs(designs) = &self.plan else {
            return Ok(());
        };
        let mut submission = self.base.clone();
        let mut right = HashSet::new();
        for (i, design) in designs.iter().enumerate() {
            look_around(i, run)?;
            let changes = design.changes.iter();
            let changes = changes.map(|(path, value)| (path, value, place_of_change(i, path)));
            let changes: Vec<_> = changes.collect();
            check_changes(&mut submission, &mut right, &changes, errors);
        }
        Ok(())
    }

    /// Refuses a varied field that would be faulty in the middle of its law.
    fn check_population(&self, population: &Population, at: &str, errors: &Errors) {
        let mut submission = self.base.clone();
        let places = population.varied().iter().zip(0..).map(|(varied, i)| {
            let place = format!("{at}/vary/{i}/path");
            (&varied.path, varied.json_of(varied.median()), place)
        });
        let places: Vec<_> = places.collect();
        for (path, value, place) in &places {
            if submission.put(path.steps(), Node::of(value)).is_none() {
                errors.push(names_nothing(path, place));
            }
        }
        for error in Submission::wrong_fields(&submission) {
            // A field may need others beside it, which the base lacks.
            let brought = places
                .iter()
                .find(|(path, ..)| path.covers(&error.pointer) || is_beside(path, &error.pointer));
            if let Some((.., place)) = brought {
                errors.push(FieldError {
                    pointer: place.clone(),
                    ..error
                });
            }
        }
    }

    /// Refuses a variable that would be faulty at an end of its range.
    fn check_search(&self, search: &Search, errors: &Errors) {
        for (i, end, changes) in search.ends() {
            let path = search.path_of(i);
            let found = match search.population_with(&self.base, &changes) {
                Err(errors) => errors,
                Ok(_) => match self.node_searched(&changes) {
                    Some(node) => Submission::wrong_fields(&node),
                    None => vec![names_nothing(path, path.text())],
                },
            };
            // A field may need others beside it, which the base lacks.
            let own = found
                .into_iter()
                .find(|error| path.covers(&error.pointer) || is_beside(path, &error.pointer));
            if let Some(error) = own {
                errors.push(FieldError {
                    pointer: format!("/search/variables/{i}/{end}"),
                    ..error
                });
            }
        }
    }

    /// A radius that is set twice would be one of them only.
    fn check_constant_mass(&self, errors: &Errors) {
        let Some(rule) = &self.constant_mass else {
            return;
        };
        for (place, path) in self.places() {
            let radius = path.text();
            if rule.sets(radius) {
                let detail = format!(
                    "{radius} is set by /constant_mass in every design that has holes; it cannot be changed as well."
                );
                errors.push(FieldError::new(place, Code::OutOfRange, detail));
            }
        }
    }

    /// Every place of the study with a path of a change, and the path.
    fn places(&self) -> Vec<(String, &Pointer)> {
        fn numbered<'a>(
            at: &str,
            paths: impl Iterator<Item = &'a Pointer>,
        ) -> Vec<(String, &'a Pointer)> {
            let paths = paths.enumerate();
            paths
                .map(|(i, path)| (format!("{at}/{i}/path"), path))
                .collect()
        }
        fn varied<'a>(at: &str, population: &'a Population) -> Vec<(String, &'a Pointer)> {
            numbered(at, population.varied().iter().map(|varied| &varied.path))
        }
        match &self.plan {
            Plan::Axes(axes) => numbered("/axes", axes.iter().map(|axis| &axis.path)),
            Plan::Population(population) => varied("/population/vary", population),
            Plan::Search(search) => {
                let mut places = numbered("/search/variables", search.paths_of_variables());
                if let Some(population) = search.population() {
                    places.extend(varied("/search/population/vary", population));
                }
                places
            }
            Plan::Designs(designs) => {
                let numbered = designs.iter().enumerate();
                let changes = numbered.flat_map(|(i, design)| {
                    let paths = design.changes.iter().map(|(path, _)| path);
                    paths.map(move |path| (place_of_change(i, path), path))
                });
                changes.collect()
            }
        }
    }
}

/// Place of a design of the list that has this path.
fn place_of_change(design: usize, path: &Pointer) -> String {
    format!("/designs/{design}/changes/{}", escaped(path.text()))
}

pub(super) fn look_around(round: usize, run: &Run) -> Result<(), Problem> {
    if round.is_multiple_of(BETWEEN_LOOKS) {
        run.check()
            .map_err(|_| Problem::new(Code::Stopped, "Nobody waits for this study any more."))?;
    }
    Ok(())
}

/// Reports fields that there are not and values of the wrong type, at or below the places that the changes bring; each is
/// told at its own place. `submission` is as before afterwards. `right` are the [`forms`](form) of changes of this submission in which nothing was wrong:
/// a hundred thousand designs rarely have more than a few.
fn check_changes(
    submission: &mut Node,
    right: &mut HashSet<String>,
    changes: &[(&Pointer, &Value, String)],
    errors: &Errors,
) {
    let form = form(changes);
    if right.contains(&form) {
        return;
    }
    let mut undo = Vec::with_capacity(changes.len());
    for (path, value, place) in changes {
        match submission.put(path.steps(), Node::of(value)) {
            Some(done) => undo.push(done),
            None => {
                errors.push(names_nothing(path, place));
                break;
            }
        }
    }
    if undo.len() == changes.len() && report_misread(submission, changes, errors) {
        right.insert(form);
    }
    for done in undo.into_iter().rev() {
        submission.undo(done);
    }
}

fn names_nothing(path: &Pointer, place: &str) -> FieldError {
    let detail = format!(
        "{} names nothing in the base: what stands above it is no object, or a list without this place.",
        path.text()
    );
    FieldError::new(place, Code::UnknownField, detail)
}

/// True if `pointer` names a field beside that of `path`, or the object of both.
fn is_beside(path: &Pointer, pointer: &str) -> bool {
    let object = path
        .text()
        .rsplit_once('/')
        .map_or("", |(object, _)| object);
    pointer == object
        || pointer
            .rsplit_once('/')
            .is_some_and(|(within, _)| within == object)
}

/// True if the changes are free of faults, numbers beyond their bounds included.
fn report_misread(
    submission: &Node,
    changes: &[(&Pointer, &Value, String)],
    errors: &Errors,
) -> bool {
    let mut is_right = true;
    for error in Submission::wrong_fields(submission) {
        let brought = changes
            .iter()
            .rfind(|(path, ..)| path.covers(&error.pointer));
        let Some((.., place)) = brought else {
            continue;
        };
        is_right = false;
        if matches!(error.code, Code::UnknownField | Code::WrongType) {
            errors.push(FieldError {
                pointer: place.clone(),
                ..error
            });
        }
    }
    is_right
}

/// The part of a change that decides whether it names known fields with values of the right types: all but the size of numbers.
fn form(changes: &[(&Pointer, &Value, String)]) -> String {
    fn add(value: &Value, form: &mut String) {
        match value {
            Value::Number(number) => {
                let is_whole = number.as_f64().is_some_and(|number| number.fract() == 0.0);
                form.push_str(if is_whole { "1" } else { "1.5" });
            }
            Value::Array(items) => {
                form.push('[');
                for item in items {
                    add(item, form);
                    form.push(',');
                }
                form.push(']');
            }
            Value::Object(fields) => {
                form.push('{');
                for (name, value) in fields {
                    *form += &format!("{name:?}:");
                    add(value, form);
                    form.push(',');
                }
                form.push('}');
            }
            Value::Null | Value::Bool(_) | Value::String(_) => *form += &value.to_string(),
        }
    }
    let mut form = String::new();
    for (path, value, _) in changes {
        form += &format!("{:?}=", path.text());
        add(value, &mut form);
        form.push(';');
    }
    form
}
