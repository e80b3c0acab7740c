//! The document of a study, read field by field.

use std::collections::HashSet;

use meshwright_wire::Kept;
use meshwright_wire::declare::{
    Declared, Errors, Location, Node, ObjectReader, OneWord, Optional, Text, absent, escaped,
    nested, text, word,
};
use meshwright_wire::pointer::Pointer;
use meshwright_wire::problem::{Code, FieldError};
use meshwright_wire::submission::TAGS;
use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;

use super::constant_mass::ConstantMass;
use super::labels::name_values;
use super::size::too_many;
use super::{Axis, Listed, Plan, Study};
use crate::MOST_DESIGNS;
use crate::population::Population;
use crate::search::Search;

/// The most axes, and the most changes of one design: the submission has fewer fields.
pub(super) const MOST_CHANGES: usize = 100;

/// The most characters of a label, and of a name.
pub(super) const LONGEST_LABEL: usize = 200;

/// The client's name for the study.
pub(super) const NAME: Declared<Optional<Text>> = Declared::new(
    "name",
    "The client's name for the study.",
    absent(text("Name", LONGEST_LABEL), "none"),
);

/// Extent of the stored results.
pub(super) const KEEP: Declared<OneWord<Kept>> = Declared::new(
    "keep",
    "How much is kept of each design that has been computed.",
    word("Keep").or(Kept::Results),
);

/// The lists of a document, as they are written: values are kept as they were sent, and read one at a time, since those of a hundred thousand designs take
/// fifty times their text.
#[derive(Default, Deserialize)]
struct Written<'a> {
    #[serde(borrow)]
    axes: Option<Vec<&'a RawValue>>,
    #[serde(borrow)]
    designs: Option<Vec<&'a RawValue>>,
}

/// The values of an axis, likewise.
#[derive(Deserialize)]
struct WrittenAxis<'a> {
    #[serde(borrow)]
    values: Vec<&'a RawValue>,
}

/// The item `i` of the written list.
fn value_at(written: Option<&[&RawValue]>, i: usize) -> Value {
    // A value that is not a list has been refused as such.
    let item = written.and_then(|items| items.get(i));
    let value = item.and_then(|item| serde_json::from_str(item.get()).ok());
    value.unwrap_or_default()
}

/// Reads the study that `node` is; `document` is the text of it. `None` if something is wrong, which `errors` has.
pub(super) fn read(node: Node, document: String, errors: &Errors) -> Option<Study> {
    let written = serde_json::from_str(&document).unwrap_or_default();
    let mut reader = ObjectReader::new(&node, Location::root(errors))?;
    let name = NAME.read::<Option<String>>(&mut reader);
    let tags = Declared::new("tags", "", TAGS).read::<Vec<String>>(&mut reader);
    let keep = KEEP.read::<Kept>(&mut reader);
    let base = match reader.get("base") {
        Some(base) => ObjectReader::new(base, reader.place_of("base")).is_some(),
        None => reader.missing::<()>("base").is_some(),
    };
    let plan = read_plan(&mut reader, &written, errors);
    let rule = Declared::new("constant_mass", "", absent(nested(""), "none"));
    let constant_mass = rule.read::<Option<ConstantMass>>(&mut reader);
    reader.finish();
    base.then_some(())?;
    let (name, tags, keep, plan, constant_mass) = (name?, tags?, keep?, plan?, constant_mass?);
    Some(Study {
        document,
        name,
        tags,
        keep,
        base: node.into_field("base")?,
        plan,
        constant_mass,
    })
}

/// Fields of a study that choose its designs.
pub(super) const PLANS: [&str; 4] = ["axes", "designs", "population", "search"];

fn read_plan(
    reader: &mut ObjectReader<'_>,
    written: &Written<'_>,
    errors: &Errors,
) -> Option<Plan> {
    let given = PLANS.map(|name| reader.present(name).map(|node| (name, node)));
    let mut given = given.into_iter().flatten();
    let Some((name, node)) = given.next() else {
        let detail = "A study needs one of /axes, /designs, /population and /search; it has none.";
        return reader
            .place_of("designs")
            .wrong(Code::MissingField, detail, None);
    };
    if let Some((other, _)) = given.next() {
        reader.refuse_both(name, other);
        return None;
    }
    match name {
        "axes" => read_axes(reader, node, written.axes.as_deref(), errors).map(Plan::Axes),
        "designs" => {
            read_designs(reader, node, written.designs.as_deref(), errors).map(Plan::Designs)
        }
        "search" => {
            let (place, base) = (reader.place_of(name), reader.get("base"));
            let search = Search::read(node, base, &place, errors)?;
            Some(Plan::Search(Box::new(search)))
        }
        _ => {
            let (place, base) = (reader.place_of(name), reader.get("base"));
            let population = Population::read(node, base, &place, errors)?;
            Some(Plan::Population(Box::new(population)))
        }
    }
}

/// The items of a list, which has to have some.
fn items<'a>(place: &Location<'_>, node: &'a Node) -> Option<&'a [Node]> {
    match node {
        Node::List(items) if items.is_empty() => {
            let detail = format!("{place} is empty; give at least one.");
            place.wrong(Code::OutOfRange, detail, None)
        }
        Node::List(items) => Some(items),
        _ => place.wrong_kind(node, "a list"),
    }
}

fn read_axes(
    reader: &ObjectReader<'_>,
    node: &Node,
    written: Option<&[&RawValue]>,
    errors: &Errors,
) -> Option<Vec<Axis>> {
    let items = items(&reader.place_of("axes"), node)?;
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
        .map(|(i, item)| read_axis(i, item, written, reader, errors))
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

fn read_axis(
    i: usize,
    item: &Node,
    written: Option<&[&RawValue]>,
    study: &ObjectReader<'_>,
    errors: &Errors,
) -> Option<Axis> {
    let place = study.place_of("axes").of(&i.to_string());
    let mut reader = ObjectReader::new(item, place)?;
    let path = match reader.get("path") {
        Some(Node::Text(text)) => read_pointer(text, &reader.place_of("path").pointer, errors),
        Some(other) => reader.place_of("path").wrong_kind(other, "a JSON pointer"),
        None => reader.missing("path"),
    };
    let values = match reader.get("values") {
        Some(node) => items(&reader.place_of("values"), node),
        None => reader.missing("values"),
    };
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
    let axis: WrittenAxis<'_> = serde_json::from_str(written?.get(i)?.get()).ok()?;
    let places = 0..axis.values.len();
    Some(Axis {
        path: path?,
        // A copy has no room to spare, which a value that was read has.
        values: places
            .map(|place| value_at(Some(&axis.values), place).clone())
            .collect(),
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
    written: Option<&[&RawValue]>,
    errors: &Errors,
) -> Option<Vec<Listed>> {
    let items = items(&reader.place_of("designs"), node)?;
    if items.len() > MOST_DESIGNS {
        errors.push(too_many(items.len() as u128, "/designs"));
        return None;
    }
    let designs: Vec<_> = items
        .iter()
        .enumerate()
        .map(|(i, item)| read_design(i, item, &value_at(written, i), reader, errors))
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

fn read_design(
    i: usize,
    item: &Node,
    value: &Value,
    study: &ObjectReader<'_>,
    errors: &Errors,
) -> Option<Listed> {
    let place = study.place_of("designs").of(&i.to_string());
    let mut reader = ObjectReader::new(item, place)?;
    let label = Declared::new("label", "", text("Label", LONGEST_LABEL));
    let label = label.read::<String>(&mut reader);
    let changes = match reader.present("changes") {
        None => Some(Vec::new()),
        Some(node @ Node::Object(fields)) => {
            if fields.len() > MOST_CHANGES {
                let expected = format!("an object of at most {MOST_CHANGES} changes");
                reader.place_of("changes").wrong_kind(node, &expected)
            } else {
                read_changes(i, fields, &value["changes"], errors)
            }
        }
        Some(other) => reader
            .place_of("changes")
            .wrong_kind(other, "an object of JSON pointers and values"),
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
    let mut changes = changes.into_iter().collect::<Option<Vec<_>>>()?;
    changes.shrink_to_fit();
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
