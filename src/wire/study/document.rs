//! The document of a study, read field by field.

use std::collections::HashSet;

use serde_json::Value;

use super::constant_mass::ConstantMass;
use super::labels::name_values;
use super::size::{MOST_DESIGNS, too_many};
use super::{Axis, Listed, Plan, Study};
use crate::wire::kept::Kept;
use crate::wire::pointer::Pointer;
use crate::wire::problem::{Code, FieldError};
use crate::wire::tags::{self, is_short_text};
use crate::wire::tree::{Errors, Node, ObjectReader, OptionalObject, escaped};

/// The most axes, and the most changes of one design: the submission has fewer fields.
pub(super) const MOST_CHANGES: usize = 100;

/// The most characters of a label, and of a name.
pub(super) const LONGEST_LABEL: usize = 200;

/// Reads the study that `node` is; `value` is the same document. `None` if something is wrong, which `errors` has.
pub(super) fn read(node: Node, value: Value, errors: &Errors) -> Option<Study> {
    let mut reader = ObjectReader::new(&node, String::new(), errors)?;
    let name = read_name(&mut reader);
    let tags = tags::read(&mut reader);
    let keep = reader.choice("keep", Some(Kept::Results));
    let base = reader.needed_object("base").is_some();
    let plan = read_plan(&mut reader, &value, errors);
    let constant_mass = match reader.optional_object("constant_mass") {
        OptionalObject::Absent => Some(None),
        OptionalObject::Wrong => None,
        OptionalObject::Present(rule) => ConstantMass::read(rule).map(Some),
    };
    reader.finish();
    base.then_some(())?;
    let (name, tags, keep, plan, constant_mass) = (name?, tags?, keep?, plan?, constant_mass?);
    Some(Study {
        document: value.to_string(),
        name,
        tags,
        keep,
        base: node.into_field("base")?,
        plan,
        constant_mass,
    })
}

fn read_name(reader: &mut ObjectReader<'_>) -> Option<Option<String>> {
    match reader.present("name") {
        None => Some(None),
        Some(Node::Text(name)) if is_short_text(name, LONGEST_LABEL) => Some(Some(name.clone())),
        Some(other) => {
            let expected = format!(
                "a text of 1 to {LONGEST_LABEL} characters, none of them a control character"
            );
            reader.wrong_kind("name", other, &expected);
            None
        }
    }
}

fn read_plan(reader: &mut ObjectReader<'_>, value: &Value, errors: &Errors) -> Option<Plan> {
    match (reader.present("axes"), reader.present("designs")) {
        (Some(axes), None) => read_axes(reader, axes, &value["axes"], errors).map(Plan::Axes),
        (None, Some(designs)) => {
            read_designs(reader, designs, &value["designs"], errors).map(Plan::Designs)
        }
        (None, None) => {
            let detail = "A study needs /axes or /designs; it has neither.";
            reader.report(FieldError::new("/designs", Code::MissingField, detail));
            None
        }
        (Some(_), Some(_)) => {
            let detail = "A study has either /axes or /designs; it has both.";
            reader.report(FieldError::new("/designs", Code::OutOfRange, detail));
            None
        }
    }
}

/// The items of a list, which has to have some.
fn items<'a>(
    reader: &ObjectReader<'_>,
    name: &str,
    node: &'a Node,
    errors: &Errors,
) -> Option<&'a [Node]> {
    let Node::List(items) = node else {
        reader.wrong_kind(name, node, "a list");
        return None;
    };
    if items.is_empty() {
        let pointer = reader.pointer_to(name);
        let detail = format!("{pointer} is empty; give at least one.");
        errors.push(FieldError::new(pointer, Code::OutOfRange, detail));
        return None;
    }
    Some(items)
}

fn read_axes(
    reader: &ObjectReader<'_>,
    node: &Node,
    values: &Value,
    errors: &Errors,
) -> Option<Vec<Axis>> {
    let items = items(reader, "axes", node, errors)?;
    if items.len() > MOST_CHANGES {
        let detail = format!(
            "/axes has {} axes; at most {MOST_CHANGES} are read.",
            items.len()
        );
        errors.push(FieldError::new("/axes", Code::TooLarge, detail).nearest(MOST_CHANGES as f64));
        return None;
    }
    let total = items.iter().fold(1_u128, |total, item| {
        total.saturating_mul(length_of_values(item).max(1) as u128)
    });
    if total > MOST_DESIGNS as u128 {
        errors.push(too_many(total, "/axes"));
        return None;
    }
    let axes: Vec<_> = items
        .iter()
        .enumerate()
        .map(|(i, item)| read_axis(i, item, &values[i], errors))
        .collect();
    let mut axes = axes.into_iter().collect::<Option<Vec<_>>>()?;
    for i in 0..axes.len() {
        let undone = axes[..i]
            .iter()
            .position(|earlier| axes[i].path.covers(earlier.path.text()));
        if let Some(j) = undone {
            let detail = format!("It would undo what /axes/{j} changes.");
            let place = format!("/axes/{i}/path");
            errors.push(FieldError::new(place, Code::OutOfRange, detail));
        }
    }
    name_values(&mut axes);
    Some(axes)
}

/// The number of values of an axis that has not been read.
fn length_of_values(axis: &Node) -> usize {
    match axis.at(&["values"]) {
        Some(Node::List(values)) => values.len(),
        _ => 0,
    }
}

fn read_axis(i: usize, item: &Node, value: &Value, errors: &Errors) -> Option<Axis> {
    let mut reader = ObjectReader::new(item, format!("/axes/{i}"), errors)?;
    let path = match reader.needed("path") {
        Some(Node::Text(text)) => read_pointer(text, &reader.pointer_to("path"), errors),
        Some(other) => {
            reader.wrong_kind("path", other, "a JSON pointer");
            None
        }
        None => None,
    };
    let values = reader
        .needed("values")
        .and_then(|node| items(&reader, "values", node, errors));
    if let Some(values) = values {
        let mut seen = HashSet::new();
        if let Some(j) = values.iter().position(|value| !seen.insert(value.key())) {
            let place = format!("/axes/{i}/values/{j}");
            let detail = format!("{place} repeats a value; each gives its own designs.");
            errors.push(FieldError::new(place, Code::OutOfRange, detail));
        }
    }
    reader.finish();
    values?;
    Some(Axis {
        path: path?,
        values: value["values"].as_array()?.clone(),
        words: Vec::new(),
    })
}

fn read_pointer(text: &str, place: &str, errors: &Errors) -> Option<Pointer> {
    let pointer = Pointer::parse(text)
        .and_then(|pointer| pointer.check_named().map(|()| pointer))
        .map_err(|(code, detail)| errors.push(FieldError::new(place, code, detail)));
    pointer.ok()
}

fn read_designs(
    reader: &ObjectReader<'_>,
    node: &Node,
    values: &Value,
    errors: &Errors,
) -> Option<Vec<Listed>> {
    let items = items(reader, "designs", node, errors)?;
    if items.len() > MOST_DESIGNS {
        errors.push(too_many(items.len() as u128, "/designs"));
        return None;
    }
    let designs: Vec<_> = items
        .iter()
        .enumerate()
        .map(|(i, item)| read_design(i, item, &values[i], errors))
        .collect();
    let designs = designs.into_iter().collect::<Option<Vec<_>>>()?;
    let mut labels = HashSet::new();
    for (i, design) in designs.iter().enumerate() {
        if !labels.insert(&design.label) {
            let place = format!("/designs/{i}/label");
            let detail = format!(
                "{place} repeats the label {:?}; rows are told apart by it.",
                design.label
            );
            errors.push(FieldError::new(place, Code::OutOfRange, detail));
        }
    }
    Some(designs)
}

fn read_design(i: usize, item: &Node, value: &Value, errors: &Errors) -> Option<Listed> {
    let mut reader = ObjectReader::new(item, format!("/designs/{i}"), errors)?;
    let label = match reader.needed("label") {
        Some(Node::Text(text)) if is_short_text(text, LONGEST_LABEL) => Some(text.clone()),
        Some(Node::Text(_)) => {
            let place = reader.pointer_to("label");
            let detail = format!(
                "{place} has to have 1 to {LONGEST_LABEL} characters, none of them a control character."
            );
            reader.report(FieldError::new(place, Code::OutOfRange, detail));
            None
        }
        Some(other) => {
            reader.wrong_kind("label", other, "a text");
            None
        }
        None => None,
    };
    let changes = match reader.present("changes") {
        None => Some(Vec::new()),
        Some(node @ Node::Object(fields)) => {
            if fields.len() > MOST_CHANGES {
                let detail = format!("an object of at most {MOST_CHANGES} changes");
                reader.wrong_kind("changes", node, &detail);
                None
            } else {
                read_changes(i, fields, &value["changes"], errors)
            }
        }
        Some(other) => {
            reader.wrong_kind("changes", other, "an object of JSON pointers and values");
            None
        }
    };
    reader.finish();
    Some(Listed {
        label: label?,
        changes: changes?,
    })
}

fn read_changes(
    i: usize,
    fields: &[(String, Node)],
    values: &Value,
    errors: &Errors,
) -> Option<Vec<(Pointer, Value)>> {
    let place = |text: &str| format!("/designs/{i}/changes/{}", escaped(text));
    let changes: Vec<_> = fields
        .iter()
        .map(|(text, _)| {
            Some((
                read_pointer(text, &place(text), errors)?,
                values[text].clone(),
            ))
        })
        .collect();
    let changes = changes.into_iter().collect::<Option<Vec<_>>>()?;
    for (j, (path, _)) in changes.iter().enumerate() {
        if let Some((earlier, _)) = changes[..j]
            .iter()
            .find(|(earlier, _)| path.covers(earlier.text()))
        {
            let detail = format!(
                "It would undo the change of {}; put it before that.",
                earlier.text()
            );
            errors.push(FieldError::new(
                place(path.text()),
                Code::OutOfRange,
                detail,
            ));
        }
    }
    Some(changes)
}
