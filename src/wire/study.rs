//! A study: one submission in many variants, each of which is computed.
//!
//! A study has a `base`, and says by `axes` or by `designs` what changes in it. Axes give every combination of their
//! values, the last axis changing fastest, as nested loops written in their order would; designs are listed with their
//! labels. What changes is named by JSON pointers (RFC 6901) into the submission.
//!
//! What is wrong with the study itself is refused: a pointer that names no field, a value of the wrong type, a label
//! that stands twice, more designs than the limit. What is wrong with one design is not: a tooth that is undercut, holes
//! that overlap. Such a design stands in the table with its problem.

use std::collections::HashSet;
use std::f64::consts::PI;
use std::fmt;

use meshwright_engine::gear::Member;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, SeqAccess, Visitor};
use serde_json::{Map, Value, json};
use utoipa::openapi::schema::{AdditionalProperties, ObjectBuilder, Type};

use super::pointer::{Pointer, escaped};
use super::problem::{Code, FieldError, Problem};
use super::quantity::{self, Preset, Quantity};
use super::schema::{self, documented};
use super::submission::Submission;
use super::tree::{Choice, Errors, Node, ObjectReader, OptionalObject};
use super::units::significant;
use super::warning::GearName;

/// The most designs of one study.
pub const MOST_DESIGNS: usize = 10_000;

/// The most axes, and the most changes of one design: the submission has fewer fields.
const MOST_CHANGES: usize = 100;

/// The most characters of a label.
const LONGEST_LABEL: usize = 200;

/// The most characters of an object or list that stands in a label; a longer one is told by its number.
const LONGEST_VALUE_IN_LABEL: usize = 32;

const MASS_REMOVED: Quantity = Quantity {
    name: "mass_removed_percent",
    title: "Mass removed",
    unit: "%",
    description: "The share of the blank that the holes remove. The blank is the ring between the bore and the mean of tip and root circle.",
    bounds: (0.01, 99.0),
    preset: Preset::Needed,
    whole: false,
};

impl Choice for Member {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("driving", Self::Driving, "gear 1, which drives"),
        ("driven", Self::Driven, "gear 2, which is driven"),
    ];
}

/// One submission in many variants. What exists names fields that there are, and has no more designs than the limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The document as it was sent.
    document: Value,
    plan: Plan,
    constant_mass: Option<ConstantMass>,
}

#[derive(Debug, Clone, PartialEq)]
enum Plan {
    Axes(Vec<Axis>),
    Designs(Vec<Listed>),
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

/// Holes of one gear that remove the same share of the blank, however many they are.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ConstantMass {
    gear: Member,
    percent: f64,
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

documented!(
    Study,
    "Study",
    [],
    schema::object(
        "Study",
        "One submission in many variants, at most 10,000, each of which is computed as a job. Give either axes or designs. A design that cannot be built stands in the table with its problem.",
        vec![
            (
                "base",
                ObjectBuilder::new()
                    .schema_type(Type::Object)
                    .title(Some("Base"))
                    .description(Some("A submission as for POST /v1/jobs. It may lack what every design gives."))
                    .into(),
                true
            ),
            (
                "axes",
                schema::list(
                    "Axes",
                    "Fields and their values. Every combination is a design; the last axis changes fastest.",
                    schema::object(
                        "Axis",
                        "A field and the values that it takes.",
                        vec![
                            (
                                "path",
                                ObjectBuilder::new()
                                    .schema_type(Type::String)
                                    .title(Some("Path"))
                                    .description(Some("A JSON pointer into the submission; it may name a whole object."))
                                    .examples([json!("/pair/driven/blank/holes/count")])
                                    .into(),
                                true
                            ),
                            (
                                "values",
                                schema::list(
                                    "Values",
                                    "The values, each once.",
                                    ObjectBuilder::new().schema_type(utoipa::openapi::schema::SchemaType::AnyValue).title(Some("Value")).into(),
                                    (1, MOST_DESIGNS)
                                )
                                .into(),
                                true
                            ),
                        ]
                    ),
                    (1, MOST_CHANGES)
                )
                .into(),
                false
            ),
            (
                "designs",
                schema::list(
                    "Designs",
                    "The designs one by one.",
                    schema::object(
                        "Design",
                        "A variant of the base.",
                        vec![
                            (
                                "label",
                                ObjectBuilder::new()
                                    .schema_type(Type::String)
                                    .title(Some("Label"))
                                    .description(Some("What the design is called; each label stands once."))
                                    .min_length(Some(1))
                                    .max_length(Some(LONGEST_LABEL))
                                    .examples([json!("8R34")])
                                    .into(),
                                true
                            ),
                            (
                                "changes",
                                ObjectBuilder::new()
                                    .schema_type(Type::Object)
                                    .title(Some("Changes"))
                                    .description(Some("JSON pointers into the submission and the values there, applied in their order."))
                                    .additional_properties(Some(AdditionalProperties::<utoipa::openapi::schema::Schema>::FreeForm(true)))
                                    .default(Some(json!({})))
                                    .into(),
                                false
                            ),
                        ]
                    ),
                    (1, MOST_DESIGNS)
                )
                .into(),
                false
            ),
            (
                "constant_mass",
                schema::object(
                    "Constant mass",
                    "Sets the hole radius of each design so that its holes remove the same share of the blank. A design without holes is left alone. The radius stands among the changes of the design's row.",
                    vec![
                        schema::choice::<Member>("gear", "Gear", "The gear with the holes.", None),
                        schema::number(&MASS_REMOVED),
                    ]
                ),
                false
            ),
        ]
    )
);

impl Study {
    /// Reads and checks a study.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400), `too_large` before anything is expanded, or 422 with what is wrong and a
    /// JSON pointer into the study.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        refuse_too_many(document)?;
        let node = Node::parse(document)?;
        let value: Value = serde_json::from_slice(document)
            .map_err(|error| Problem::new(Code::MalformedJson, error.to_string()))?;
        let errors = Errors::default();
        match Self::read(&node, value, &errors) {
            Some(study) if errors.count() == 0 => {
                study.check_values(&errors);
                if errors.count() == 0 {
                    Ok(study)
                } else {
                    Err(errors.into_problem())
                }
            }
            _ => Err(errors.into_problem()),
        }
    }

    fn read(node: &Node, document: Value, errors: &Errors) -> Option<Self> {
        let mut reader = ObjectReader::new(node, String::new(), errors)?;
        let base = reader.needed_object("base").is_some();
        let plan = match (reader.present("axes"), reader.present("designs")) {
            (Some(axes), None) => {
                read_axes(&reader, axes, &document["axes"], errors).map(Plan::Axes)
            }
            (None, Some(designs)) => {
                read_designs(&reader, designs, &document["designs"], errors).map(Plan::Designs)
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
        };
        let constant_mass = match reader.optional_object("constant_mass") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(mut rule) => {
                let gear = rule.choice::<Member>("gear", None);
                let percent = rule.number(&MASS_REMOVED, None);
                rule.finish();
                gear.zip(percent)
                    .map(|(gear, percent)| Some(ConstantMass { gear, percent }))
            }
        };
        reader.finish();
        base.then_some(())?;
        Some(Self {
            document,
            plan: plan?,
            constant_mass: constant_mass?,
        })
    }

    /// The number of designs.
    pub fn total(&self) -> usize {
        match &self.plan {
            Plan::Axes(axes) => axes.iter().map(|axis| axis.values.len()).product(),
            Plan::Designs(designs) => designs.len(),
        }
    }

    /// The document as it was sent.
    pub fn document(&self) -> &Value {
        &self.document
    }

    /// The gear that the table tells mass and holes of: the one of constant mass, else the only one that changes, else
    /// the driven one.
    pub fn gear(&self) -> GearName {
        if let Some(rule) = self.constant_mass {
            return rule.gear.into();
        }
        let touches = |member: &str| {
            let within = |path: &Pointer| path.starts_with(&["pair", member]);
            match &self.plan {
                Plan::Axes(axes) => axes.iter().any(|axis| within(&axis.path)),
                Plan::Designs(designs) => designs
                    .iter()
                    .any(|design| design.changes.iter().any(|(path, _)| within(path))),
            }
        };
        if touches("driving") && !touches("driven") {
            GearName::Driving
        } else {
            GearName::Driven
        }
    }

    /// The design of a row, counted from 0; none beyond the last.
    pub fn design(&self, row: usize) -> Option<Design> {
        let (label, changes) = self.changes(row)?;
        let mut submission = self.document["base"].clone();
        let mut told = Map::new();
        for (path, value) in changes {
            told.insert(path.text().to_owned(), value.clone());
            if !path.put(&mut submission, value.clone()) {
                let detail = format!(
                    "{} names nothing in this design: what stands above it is no object, or a list without this place.",
                    path.text()
                );
                let error = FieldError::new(path.text(), Code::UnknownField, detail);
                return Some(Design {
                    label,
                    changes: told,
                    submission: Err(Problem::of_fields(vec![error])),
                });
            }
        }
        if let Some(rule) = self.constant_mass {
            rule.apply(&mut submission, &mut told);
        }
        Some(Design {
            label,
            changes: told,
            submission: Submission::parse(submission.to_string().as_bytes()),
        })
    }

    /// The label and the changes of a row.
    fn changes(&self, row: usize) -> Option<(String, Vec<(&Pointer, &Value)>)> {
        match &self.plan {
            Plan::Designs(designs) => {
                let design = designs.get(row)?;
                let changes = design.changes.iter().map(|(path, value)| (path, value));
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
                let changes = chosen().map(|(axis, &place)| (&axis.path, &axis.values[place]));
                Some((words.join(", "), changes.collect()))
            }
        }
    }

    /// Refuses what is wrong wherever it stands: fields that there are not and values of the wrong type, in the base and
    /// in each value. Whether the values go together is each design's own matter.
    fn check_values(&self, errors: &Errors) {
        let base = &self.document["base"];
        self.check_constant_mass(errors);
        self.check_base(base, errors);
        if errors.count() > 0 {
            return;
        }
        match &self.plan {
            Plan::Axes(axes) => {
                // An axis may change a part of what an axis before it brings.
                let mut before = base.clone();
                for (i, axis) in axes.iter().enumerate() {
                    for (j, value) in axis.values.iter().enumerate() {
                        let place = format!("/axes/{i}/values/{j}");
                        check_changes(before.clone(), &[(&axis.path, value, place)], errors);
                    }
                    axis.path.put(&mut before, axis.values[0].clone());
                }
            }
            Plan::Designs(designs) => {
                for (i, design) in designs.iter().enumerate() {
                    let place =
                        |path: &Pointer| format!("/designs/{i}/changes/{}", escaped(path.text()));
                    let changes: Vec<_> = design
                        .changes
                        .iter()
                        .map(|(path, value)| (path, value, place(path)))
                        .collect();
                    check_changes(base.clone(), &changes, errors);
                }
            }
        }
    }

    fn check_base(&self, base: &Value, errors: &Errors) {
        let replaced = |pointer: &str| match &self.plan {
            Plan::Axes(axes) => axes.iter().any(|axis| axis.path.covers(pointer)),
            Plan::Designs(designs) => designs
                .iter()
                .any(|design| design.changes.iter().any(|(path, _)| path.covers(pointer))),
        };
        for error in Submission::misread_fields(base.to_string().as_bytes()) {
            if !replaced(&error.pointer) {
                errors.push(FieldError {
                    pointer: format!("/base{}", error.pointer),
                    ..error
                });
            }
        }
    }

    /// A radius that is set twice would be one of them only.
    fn check_constant_mass(&self, errors: &Errors) {
        let Some(rule) = self.constant_mass else {
            return;
        };
        let radius = rule.radius_pointer();
        let refuse = |place: String| {
            let detail = format!(
                "{radius} is set by /constant_mass in every design that has holes; it cannot be changed as well."
            );
            errors.push(FieldError::new(place, Code::OutOfRange, detail));
        };
        match &self.plan {
            Plan::Axes(axes) => {
                for (i, axis) in axes.iter().enumerate() {
                    if axis.path.text() == radius {
                        refuse(format!("/axes/{i}/path"));
                    }
                }
            }
            Plan::Designs(designs) => {
                for (i, design) in designs.iter().enumerate() {
                    if design.changes.iter().any(|(path, _)| path.text() == radius) {
                        refuse(format!("/designs/{i}/changes/{}", escaped(&radius)));
                    }
                }
            }
        }
    }
}

/// Reports what is wrong in `submission` at or below the places that the changes bring; each is told at its own place.
fn check_changes(mut submission: Value, changes: &[(&Pointer, &Value, String)], errors: &Errors) {
    for (path, value, place) in changes {
        if !path.put(&mut submission, (*value).clone()) {
            let detail = format!(
                "{} names nothing in the base: what stands above it is no object, or a list without this place.",
                path.text()
            );
            errors.push(FieldError::new(place, Code::UnknownField, detail));
            return;
        }
    }
    for error in Submission::misread_fields(submission.to_string().as_bytes()) {
        let brought = changes
            .iter()
            .rfind(|(path, ..)| path.covers(&error.pointer));
        if let Some((.., place)) = brought {
            errors.push(FieldError {
                pointer: place.clone(),
                ..error
            });
        }
    }
}

impl ConstantMass {
    fn radius_pointer(self) -> String {
        format!(
            "/pair/{}/blank/holes/{}",
            self.gear.word(),
            quantity::HOLE_RADIUS.name
        )
    }

    /// Gives the holes of `submission` their radius, and notes it among the changes. What cannot be read is left to the
    /// check of the submission.
    ///
    /// N π r² = percent · π (((r_a + r_f)/2)² − r_bore²), DESIGN section 4.
    fn apply(self, submission: &mut Value, changes: &mut Map<String, Value>) {
        let place = format!("/pair/{}", self.gear.word());
        let Some(gear) = submission.pointer_mut(&place) else {
            return;
        };
        let Some(blank_area) = blank_area(gear) else {
            return;
        };
        let Some(holes) = gear
            .pointer_mut("/blank/holes")
            .and_then(Value::as_object_mut)
        else {
            return;
        };
        let count = holes.get(quantity::HOLE_COUNT.name).and_then(Value::as_f64);
        let Some(count) = count.filter(|&count| count >= 1.0) else {
            return;
        };
        let name = quantity::HOLE_RADIUS.name;
        if blank_area > 0.0 {
            let radius = significant(
                (self.percent / 100.0 * blank_area / (PI * count)).sqrt(),
                12,
            );
            holes.insert(name.to_owned(), json!(radius));
            changes.insert(self.radius_pointer(), json!(radius));
        } else {
            // The bore leaves no blank. Any radius will do for the check to come to that.
            holes.insert(name.to_owned(), json!(quantity::HOLE_RADIUS.bounds.0));
        }
    }
}

/// The area between the bore and the mean of tip and root circle, in mm².
fn blank_area(gear: &Value) -> Option<f64> {
    let given = |quantity: &Quantity| gear.get(quantity.name).map(Value::as_f64);
    let m = given(&quantity::MODULE)??;
    let z = given(&quantity::TOOTH_COUNT)??;
    let or_preset = |quantity: &Quantity| match (given(quantity), quantity.preset) {
        (Some(value), _) => value,
        (None, Preset::Value(value)) => Some(value),
        (None, Preset::Modules(modules)) => Some(modules * m),
        (None, Preset::Needed | Preset::Absent(_)) => None,
    };
    let shift = or_preset(&quantity::PROFILE_SHIFT)? * m;
    let r_a = m * z / 2.0 + or_preset(&quantity::ADDENDUM)? + shift;
    let r_f = m * z / 2.0 - or_preset(&quantity::DEDENDUM)? + shift;
    let bore = gear
        .get("blank")?
        .get(quantity::BORE_RADIUS.name)?
        .as_f64()?;
    Some(PI * (((r_a + r_f) / 2.0).powi(2) - bore.powi(2)))
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
            errors.push(FieldError::new(
                format!("/axes/{i}/path"),
                Code::OutOfRange,
                detail,
            ));
        }
    }
    name_values(&mut axes);
    Some(axes)
}

/// The number of values of an axis that has not been read.
fn length_of_values(axis: &Node) -> usize {
    let Node::Object(fields) = axis else {
        return 0;
    };
    let values = fields.iter().find(|(key, _)| key == "values");
    match values {
        Some((_, Node::List(values))) => values.len(),
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
        for (j, one) in values.iter().enumerate() {
            // Many values are numbers; comparing each with each is fast enough for as many as there may be.
            if values[..j].contains(one) {
                let place = format!("/axes/{i}/values/{j}");
                let detail = format!("{place} repeats a value; each gives its own designs.");
                errors.push(FieldError::new(place, Code::OutOfRange, detail));
                break;
            }
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

/// Gives every value of every axis the words that a label says it with: the last part of the path, or as many parts as
/// tell it from the other axes, and the value.
fn name_values(axes: &mut [Axis]) {
    let names: Vec<String> = axes
        .iter()
        .map(|axis| {
            let ambiguous = |parts: usize| {
                let same = |other: &&Axis| other.path.last(parts) == axis.path.last(parts);
                axes.iter().filter(same).count() > 1
                    || axis.path.last(parts)[0]
                        .bytes()
                        .all(|byte| byte.is_ascii_digit())
            };
            let most = axis.path.len();
            let parts = (1..most).find(|&parts| !ambiguous(parts)).unwrap_or(most);
            axis.path.last(parts).join(".")
        })
        .collect();
    for (axis, name) in axes.iter_mut().zip(names) {
        let words: Vec<String> = axis.values.iter().map(said).collect();
        let distinct: HashSet<&String> = words.iter().collect();
        let usable = distinct.len() == words.len()
            && words.iter().all(|word| {
                word.chars().count() <= LONGEST_VALUE_IN_LABEL
                    && !word.chars().any(char::is_control)
            });
        axis.words = words
            .iter()
            .enumerate()
            .map(|(j, word)| {
                if usable {
                    format!("{name}={word}")
                } else {
                    format!("{name}#{}", j + 1)
                }
            })
            .collect();
    }
}

/// A value in a label: a word without its quotes, anything else as JSON.
fn said(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
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
        Some(Node::Text(text))
            if (1..=LONGEST_LABEL).contains(&text.chars().count())
                && !text.chars().any(char::is_control) =>
        {
            Some(text.clone())
        }
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

fn too_many(total: u128, pointer: &str) -> FieldError {
    let detail = format!(
        "The study has {total} designs; at most {MOST_DESIGNS} are taken. Nothing was expanded."
    );
    FieldError::new(pointer, Code::TooLarge, detail).nearest(MOST_DESIGNS as f64)
}

/// Counts designs without keeping any, so that a document with ten million of them costs no memory.
fn refuse_too_many(document: &[u8]) -> Result<(), Problem> {
    #[derive(Deserialize)]
    struct Counted {
        #[serde(default)]
        axes: Vec<CountedAxis>,
        #[serde(default)]
        designs: Count,
    }
    #[derive(Deserialize)]
    struct CountedAxis {
        #[serde(default)]
        values: Count,
    }

    // What is not of this form is told later, with its place.
    let Ok(counted) = serde_json::from_slice::<Counted>(document) else {
        return Ok(());
    };
    let long = counted
        .axes
        .iter()
        .position(|axis| axis.values.0 > MOST_DESIGNS);
    let error = match long {
        Some(i) => too_many(
            counted.axes.iter().fold(1, |total: u128, axis| {
                total.saturating_mul(axis.values.0.max(1) as u128)
            }),
            &format!("/axes/{i}/values"),
        ),
        None if counted.designs.0 > MOST_DESIGNS => too_many(counted.designs.0 as u128, "/designs"),
        None => return Ok(()),
    };
    Err(Problem::of_fields(vec![error]))
}

/// The length of a list.
#[derive(Default)]
struct Count(usize);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Counter;
        impl<'de> Visitor<'de> for Counter {
            type Value = Count;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Count, A::Error> {
                let mut count = 0;
                while items.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                Ok(Count(count))
            }
        }
        deserializer.deserialize_seq(Counter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::examples::STUDY_SECTION_5;

    fn base() -> Value {
        let gear = json!({
            "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 }
        });
        json!({
            "method": "decomposition",
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [115.0]
        })
    }

    fn parse(document: &Value) -> Result<Study, Problem> {
        Study::parse(document.to_string().as_bytes())
    }

    fn axes(axes: Value) -> Value {
        json!({ "base": base(), "axes": axes })
    }

    fn listed(designs: Value) -> Value {
        json!({ "base": base(), "designs": designs })
    }

    fn designs(study: &Study) -> Vec<Design> {
        (0..).map_while(|row| study.design(row)).collect()
    }

    /// What a study is refused with: code, and pointers.
    fn refused(document: &Value) -> (Code, Vec<String>) {
        let problem = parse(document).expect_err("refused");
        let pointers = problem.errors.iter().map(|error| error.pointer.clone());
        (problem.code, pointers.collect())
    }

    #[test]
    fn axes_give_every_combination_and_the_last_one_changes_fastest() {
        let study = parse(&axes(json!([
            { "path": "/method", "values": ["flexible", "projected_decomposition"] },
            { "path": "/output_torques_n_m/0", "values": [20, 115.5, 300] },
        ])))
        .unwrap();
        let designs = designs(&study);
        assert_eq!((study.total(), designs.len()), (6, 6));
        let labels: Vec<&str> = designs.iter().map(|design| &*design.label).collect();
        assert_eq!(
            labels,
            [
                "method=flexible, output_torques_n_m.0=20",
                "method=flexible, output_torques_n_m.0=115.5",
                "method=flexible, output_torques_n_m.0=300",
                "method=projected_decomposition, output_torques_n_m.0=20",
                "method=projected_decomposition, output_torques_n_m.0=115.5",
                "method=projected_decomposition, output_torques_n_m.0=300",
            ]
        );
        let fifth = designs[4].submission.as_ref().unwrap();
        assert_eq!(fifth.method(), "projected_decomposition");
        assert_eq!(fifth.case().output_torques, [115.5]);
        assert_eq!(
            Value::Object(designs[4].changes.clone()),
            json!({ "/method": "projected_decomposition", "/output_torques_n_m/0": 115.5 })
        );
    }

    #[test]
    fn labels_tell_equal_fields_of_both_gears_apart_and_number_what_is_long() {
        let holes =
            |count: u32| json!({ "count": count, "circle_radius_mm": 34.0, "radius_mm": 5.0 });
        let study = parse(&axes(json!([
            { "path": "/pair/driving/blank/bore_radius_mm", "values": [15] },
            { "path": "/pair/driven/blank/bore_radius_mm", "values": [16] },
            { "path": "/pair/driven/blank/holes", "values": [holes(6), holes(8)] },
        ])))
        .unwrap();
        let label = study.design(1).unwrap().label;
        assert_eq!(
            label,
            "driving.blank.bore_radius_mm=15, driven.blank.bore_radius_mm=16, holes#2"
        );
    }

    #[test]
    fn constant_mass_sets_the_radius_that_the_paper_s_quarter_needs() {
        // DESIGN section 4: 25 % between bore 15 and the mean of 52 and 47.5 mm is 7.500 (10), 8.385 (8), 9.683 (6) mm.
        let study = Study::parse(STUDY_SECTION_5.as_bytes()).unwrap();
        assert_eq!((study.total(), study.gear()), (6, GearName::Driven));
        let designs = designs(&study);
        let radius = |design: &Design| {
            let radius = design.changes.get("/pair/driven/blank/holes/radius_mm");
            radius.and_then(Value::as_f64)
        };
        for (design, (label, printed)) in designs.iter().zip([
            ("standard", None),
            ("8R34", Some(8.385)),
            ("10R34", Some(7.500)),
            ("6R30", Some(9.683)),
            ("8R30", Some(8.385)),
            ("8R27", Some(8.385)),
        ]) {
            assert_eq!(design.label, label);
            let submission = design.submission.as_ref().expect("can be built");
            let driven = submission.case().pair.driven();
            match printed {
                // Half a digit of what is printed.
                Some(printed) => {
                    assert!((radius(design).unwrap() - printed).abs() < 5e-4, "{label}");
                    assert!((driven.removed_fraction() - 0.25).abs() < 1e-10, "{label}");
                }
                None => {
                    assert_eq!((radius(design), driven.holes()), (None, None));
                }
            }
            assert_eq!(submission.case().output_torques, [20.0, 115.0]);
        }
    }

    #[test]
    fn constant_mass_follows_shift_addendum_and_bore_of_its_own_gear() {
        let mut document = axes(json!([
            { "path": "/pair/driving/blank/bore_radius_mm", "values": [12, 18] },
            { "path": "/pair/driving/profile_shift", "values": [0, 0.1] },
            { "path": "/pair/driving/addendum_mm", "values": [1.9, 2.0] },
        ]));
        document["base"]["pair"]["center_distance_mm"] = json!(101.0);
        document["base"]["pair"]["driving"]["blank"]["holes"] =
            json!({ "count": 8, "circle_radius_mm": 31.0 });
        document["constant_mass"] = json!({ "gear": "driving", "mass_removed_percent": 10 });
        let study = parse(&document).unwrap();
        assert_eq!(study.gear(), GearName::Driving);
        for design in designs(&study) {
            let submission = design.submission.unwrap();
            let removed = submission.case().pair.driving().removed_fraction();
            assert!((removed - 0.1).abs() < 1e-10, "{}: {removed}", design.label);
        }
    }

    #[test]
    fn a_design_that_cannot_be_built_has_a_problem_and_the_others_do_not() {
        let study = parse(&axes(json!([
            { "path": "/pair/center_distance_mm", "values": [100.5, 118.5, 1e9] },
        ])))
        .unwrap();
        let outcomes: Vec<_> = designs(&study)
            .into_iter()
            .map(|design| {
                design
                    .submission
                    .map(|_| ())
                    .map_err(|problem| problem.code)
            })
            .collect();
        assert_eq!(
            outcomes,
            [Ok(()), Err(Code::TeethDoNotReach), Err(Code::OutOfRange)]
        );
        let impossible = parse(&listed(
            json!([{ "label": "a", "changes": { "/pair/center_distance_mm": 118.5 } }]),
        ));
        assert!(impossible.unwrap().design(0).unwrap().submission.is_err());
    }

    #[test]
    fn a_pointer_that_names_nothing_is_refused_with_its_place() {
        let document = axes(json!([
            { "path": "/method", "values": ["flexible"] },
            { "path": "/pair/driven/blank/holes/cuont", "values": [6] },
        ]));
        assert_eq!(
            refused(&document),
            (Code::UnknownField, vec!["/axes/1/path".to_owned()])
        );
        let document = listed(json!([{ "label": "a", "changes": { "/pair/driven/hole": 6 } }]));
        assert_eq!(
            refused(&document),
            (
                Code::UnknownField,
                vec!["/designs/0/changes/~1pair~1driven~1hole".to_owned()]
            )
        );
        let document = axes(json!([{ "path": "/output_torques_n_m/7", "values": [6] }]));
        assert_eq!(
            refused(&document),
            (Code::UnknownField, vec!["/axes/0/values/0".to_owned()])
        );
    }

    #[test]
    fn values_of_the_wrong_type_are_refused_with_their_place() {
        let document = axes(json!([
            { "path": "/pair/driven/tooth_count", "values": [50, "50", 50.5, null] },
        ]));
        let places = [1, 2, 3].map(|j| format!("/axes/0/values/{j}"));
        assert_eq!(refused(&document), (Code::WrongType, places.to_vec()));
        let document = listed(json!([
            { "label": "a", "changes": { "/pair/driven/blank/holes": { "count": 8, "circle_radius_mm": 34, "radius": 3 } } },
            { "label": "b", "changes": { "/method": "fast" } },
        ]));
        assert_eq!(
            refused(&document).1,
            [
                "/designs/0/changes/~1pair~1driven~1blank~1holes",
                "/designs/1/changes/~1method"
            ]
        );
        for (document, pointer) in [
            (json!([]), ""),
            (
                json!({ "base": [], "axes": [{ "path": "/method", "values": ["flexible"] }] }),
                "/base",
            ),
            (json!({ "base": base() }), "/designs"),
            (json!({ "base": base(), "axes": {} }), "/axes"),
            (axes(json!([])), "/axes"),
            (axes(json!([5])), "/axes/0"),
            (axes(json!([{ "path": 5, "values": [1] }])), "/axes/0/path"),
            (
                axes(json!([{ "path": "/method", "values": "flexible" }])),
                "/axes/0/values",
            ),
            (
                axes(json!([{ "path": "/method", "values": [] }])),
                "/axes/0/values",
            ),
            (
                axes(json!([{ "path": "/method", "values": ["flexible"], "x": 1 }])),
                "/axes/0/x",
            ),
            (listed(json!([])), "/designs"),
            (listed(json!([{ "label": 1 }])), "/designs/0/label"),
            (listed(json!([{ "label": "" }])), "/designs/0/label"),
            (listed(json!([{ "changes": {} }])), "/designs/0/label"),
            (
                listed(json!([{ "label": "a", "changes": [] }])),
                "/designs/0/changes",
            ),
        ] {
            assert_eq!(refused(&document).1, [pointer], "{document}");
        }
        // JSON has no NaN.
        let problem = Study::parse(br#"{ "base": { "x": NaN } }"#).unwrap_err();
        assert_eq!(problem.code, Code::MalformedJson);
    }

    #[test]
    fn a_base_with_a_field_that_is_not_known_is_refused_once_and_not_in_every_row() {
        let mut document = axes(json!([{ "path": "/method", "values": ["flexible"] }]));
        document["base"]["pair"]["driven"]["colour"] = json!("red");
        document["base"]["method"] = json!("replaced by the axis");
        assert_eq!(
            refused(&document),
            (
                Code::UnknownField,
                vec!["/base/pair/driven/colour".to_owned()]
            )
        );
    }

    #[test]
    fn repeated_labels_and_values_are_refused() {
        let document = listed(json!([{ "label": "a" }, { "label": "b" }, { "label": "a" }]));
        assert_eq!(
            refused(&document),
            (Code::OutOfRange, vec!["/designs/2/label".to_owned()])
        );
        // 6 and 6.0 are one number.
        let document =
            axes(json!([{ "path": "/pair/driven/blank/bore_radius_mm", "values": [6, 7, 6.0] }]));
        assert_eq!(
            refused(&document),
            (Code::OutOfRange, vec!["/axes/0/values/2".to_owned()])
        );
    }

    #[test]
    fn a_change_that_undoes_another_is_refused() {
        let document = axes(json!([
            { "path": "/pair/driven/blank/bore_radius_mm", "values": [15] },
            { "path": "/pair/driven/blank", "values": [{ "bore_radius_mm": 16 }] },
        ]));
        assert_eq!(
            refused(&document),
            (Code::OutOfRange, vec!["/axes/1/path".to_owned()])
        );
        // The other way round the second refines the first.
        let document = axes(json!([
            { "path": "/pair/driven/blank", "values": [{ "bore_radius_mm": 16 }] },
            { "path": "/pair/driven/blank/bore_radius_mm", "values": [15, 17] },
        ]));
        assert!(parse(&document).is_ok());
        let mut document =
            axes(json!([{ "path": "/pair/driven/blank/holes/radius_mm", "values": [5] }]));
        document["constant_mass"] = json!({ "gear": "driven", "mass_removed_percent": 25 });
        assert_eq!(
            refused(&document),
            (Code::OutOfRange, vec!["/axes/0/path".to_owned()])
        );
    }

    #[test]
    fn ten_million_designs_are_refused_with_the_limit_before_any_is_expanded() {
        let values: Vec<u32> = (0..57).collect();
        let product = json!(["count", "circle_radius_mm", "radius_mm", "phase_deg"].map(
            |field| json!({ "path": format!("/pair/driven/blank/holes/{field}"), "values": values })
        ));
        let problem = parse(&axes(product)).unwrap_err();
        assert_eq!((problem.code, problem.status), (Code::TooLarge, 422));
        assert!(problem.detail.contains("10556001") && problem.detail.contains("10000"));
        assert_eq!(problem.errors[0].nearest, Some(10_000.0));

        let long = format!("[{}0]", "0,".repeat(9_999_999));
        let text =
            format!(r#"{{ "base": {{}}, "axes": [{{ "path": "/method", "values": {long} }}] }}"#);
        let problem = Study::parse(text.as_bytes()).unwrap_err();
        assert_eq!(problem.code, Code::TooLarge);
        assert!(
            problem.detail.contains("10000000 designs"),
            "{}",
            problem.detail
        );
        let text = format!(r#"{{ "base": {{}}, "designs": {long} }}"#);
        assert_eq!(
            Study::parse(text.as_bytes()).unwrap_err().code,
            Code::TooLarge
        );
    }
}
