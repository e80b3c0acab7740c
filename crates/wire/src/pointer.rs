//! JSON pointers (RFC 6901) into a submission: whether they name a field that there is.

use std::sync::LazyLock;

use serde_json::{Map, Value};

use super::declare::{self, nearest_word};
use super::problem::Code;
use super::submission::SubmissionDocument;

/// A place in a submission.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pointer {
    text: String,
    steps: Vec<String>,
}

impl Pointer {
    /// Reads a pointer.
    ///
    /// # Errors
    ///
    /// The code and a sentence, when the text is no pointer or names the whole document.
    pub fn parse(text: &str) -> Result<Self, (Code, String)> {
        const LONGEST: usize = 300;
        let refuse = |what: &str| {
            let detail = format!(
                "A JSON pointer such as /pair/driven/blank/holes/count is expected; this {what}."
            );
            Err((Code::UnknownField, detail))
        };
        if text.len() > LONGEST {
            return refuse("is longer than any");
        }
        let Some(steps) = text.strip_prefix('/') else {
            return refuse(if text.is_empty() {
                "names the whole submission"
            } else {
                "does not begin with /"
            });
        };
        let unescaped = |step: &str| {
            let rest = step.replace("~0", "").replace("~1", "");
            (!rest.contains('~')).then(|| step.replace("~1", "/").replace("~0", "~"))
        };
        match steps.split('/').map(unescaped).collect::<Option<Vec<_>>>() {
            Some(mut steps) => {
                // A study may have a hundred thousand.
                steps.shrink_to_fit();
                Ok(Self {
                    text: text.to_owned(),
                    steps,
                })
            }
            None => refuse("has a ~ that is neither ~0 nor ~1"),
        }
    }

    /// The pointer as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Its steps, unescaped.
    pub fn steps(&self) -> &[String] {
        &self.steps
    }

    /// Its last steps.
    pub fn last(&self, count: usize) -> &[String] {
        &self.steps[self.steps.len().saturating_sub(count)..]
    }

    /// True if its first steps are these.
    pub fn starts_with(&self, steps: &[&str]) -> bool {
        self.steps.len() >= steps.len() && self.steps.iter().zip(steps).all(|(a, b)| a == b)
    }

    /// True if it names the same place as `pointer`, or an object that contains it.
    pub fn covers(&self, pointer: &str) -> bool {
        is_within(pointer, &self.text)
    }

    /// True if it names a place below `pointer`.
    pub fn is_below(&self, pointer: &str) -> bool {
        is_within(&self.text, pointer)
    }

    /// Checks that the schema of a submission has a field at this place.
    ///
    /// # Errors
    ///
    /// The code and a sentence that names the unknown step and the known ones there.
    pub fn check_named(&self) -> Result<(), (Code, String)> {
        self.named(&SCHEMA, &self.steps).map(|_| ())
    }

    /// Kind of number of the field at this place.
    ///
    /// # Errors
    ///
    /// As [`check_named`](Self::check_named), or that the field takes no number.
    pub fn number_kind(&self) -> Result<NumberKind, (Code, String)> {
        self.number_kind_in(&SCHEMA, &self.steps)
    }

    /// Kind of number of the field behind these last steps, by `schema`.
    ///
    /// # Errors
    ///
    /// As [`number_kind`](Self::number_kind).
    pub fn number_kind_in(
        &self,
        schema: &'static Schema,
        steps: &[String],
    ) -> Result<NumberKind, (Code, String)> {
        let named = self.named(schema, steps)?;
        let schemas = schema.alternatives(&named);
        let is = |word: &str| {
            schemas.iter().any(|schema| match &schema["type"] {
                Value::String(own) => own == word,
                Value::Array(several) => several.iter().any(|own| own == word),
                _ => false,
            })
        };
        if is("number") {
            Ok(NumberKind::Real)
        } else if is("integer") {
            Ok(NumberKind::Whole)
        } else {
            let detail = format!("{} is no field that takes a number.", self.text);
            Err((Code::WrongType, detail))
        }
    }

    /// The part of a schema at the place behind these last steps.
    fn named(
        &self,
        schema: &'static Schema,
        steps: &[String],
    ) -> Result<Vec<&'static Value>, (Code, String)> {
        let mut here: Vec<&'static Value> = vec![&schema.root];
        for (i, step) in steps.iter().enumerate() {
            let schemas = schema.alternatives(&here);
            let next: Vec<&'static Value> = schemas
                .iter()
                .filter_map(|schema| child(schema, step))
                .collect();
            if next.is_empty() {
                let place = format!("/{}", steps[..i].join("/"));
                let known: Vec<&str> = schemas
                    .iter()
                    .filter_map(|schema| schema["properties"].as_object())
                    .flat_map(Map::keys)
                    .map(String::as_str)
                    .collect();
                let meant = nearest_word(step, &known);
                let meant = meant.map(|name| format!(" Is {place}/{name} meant?"));
                let meant = meant.unwrap_or_default().replace("//", "/");
                let known = if known.is_empty() {
                    "nothing".to_owned()
                } else {
                    known.join(", ")
                };
                let detail = format!(
                    "{} names no field of {}; at {place} there is {known}.{meant}",
                    self.text, schema.of
                );
                return Err((Code::UnknownField, detail));
            }
            here = next;
        }
        Ok(here)
    }
}

/// A kind of number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberKind {
    /// Any.
    Real,
    /// Whole ones only.
    Whole,
}

fn is_within(inner: &str, outer: &str) -> bool {
    inner
        .strip_prefix(outer)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The schema of a document, with those that it refers to.
pub struct Schema {
    /// Name of its object.
    of: &'static str,
    root: Value,
    named: Map<String, Value>,
}

static SCHEMA: LazyLock<Schema> =
    LazyLock::new(|| Schema::of::<SubmissionDocument>("a submission"));

impl Schema {
    /// That of a document, which is called so.
    pub fn of<D: declare::Object>(of: &'static str) -> Self {
        let mut named = Vec::new();
        D::name_fields(&mut named);
        let named = named.into_iter();
        let named = named.map(|(name, schema)| (name.to_owned(), schema));
        Self {
            of,
            root: D::json_schema(),
            named: named.collect(),
        }
    }

    /// The schemas behind references and alternatives.
    fn alternatives<'a>(&'a self, schemas: &[&'a Value]) -> Vec<&'a Value> {
        let mut found = Vec::new();
        let mut open: Vec<&Value> = schemas.to_vec();
        while let Some(schema) = open.pop() {
            if let Some(name) = schema["$ref"].as_str() {
                let name = name.rsplit('/').next().unwrap_or_default();
                open.extend(self.named.get(name));
                continue;
            }
            open.extend(schema["oneOf"].as_array().into_iter().flatten());
            found.push(schema);
        }
        found
    }
}

/// The part of a schema for the field or item `step`.
fn child<'a>(schema: &'a Value, step: &str) -> Option<&'a Value> {
    let property = schema["properties"]
        .as_object()
        .and_then(|properties| properties.get(step));
    let is_index = !step.is_empty()
        && step.len() < 6
        && step.bytes().all(|byte| byte.is_ascii_digit())
        && (step == "0" || !step.starts_with('0'));
    let item = || schema.get("items").filter(|_| is_index);
    property.or_else(item)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(text: &str) -> bool {
        Pointer::parse(text).is_ok_and(|pointer| pointer.check_named().is_ok())
    }

    #[test]
    fn a_misspelled_step_is_answered_with_the_one_that_is_meant() {
        for (text, meant) in [
            (
                "/pair/driven/blank/holes/cont",
                " Is /pair/driven/blank/holes/count meant?",
            ),
            ("/metod", " Is /method meant?"),
            ("/colour", "resolution, tags."),
        ] {
            let (_, detail) = Pointer::parse(text).unwrap().check_named().unwrap_err();
            assert!(detail.ends_with(meant), "{detail}");
        }
    }

    #[test]
    fn a_pointer_names_fields_objects_and_items_of_a_submission() {
        for text in [
            "/method",
            "/pair",
            "/pair/driven/blank/holes",
            "/pair/driven/blank/holes/count",
            "/pair/driving/tip_relief/start/radial_length_mm",
            "/pair/driving/profile_modifications/0/amount_um",
            "/pair/driving/profile_modifications/15/start/roll_length_from_form_mm",
            "/pair/driven/profile_modifications/0/removed_um/7",
            "/pair/driven/tooth_deviations/pitch_single_um",
            "/pair/driven/tooth_deviations/pitch_cumulative_um/49",
            "/pair/driven/tooth_deviations/eccentricity/phase_deg",
            "/pair/driven/tip_diameter_mm",
            "/resolution/interface_radius_mm",
            "/resolution/interface_radius_mm/driven",
            "/output_torques_n_m",
            "/output_torques_n_m/0",
            "/resolution/grid",
            "/resolution/contact_solver/augmented_lagrangian/penalty_n_per_m",
            "/tags",
        ] {
            assert!(named(text), "{text}");
        }
    }

    #[test]
    fn a_pointer_that_names_nothing_is_refused_with_what_is_there() {
        for text in [
            "",
            "method",
            "/",
            "/methods",
            "/pair/driven/blank/hole/count",
            "/pair/driven/blank/holes/count/0",
            "/output_torques_n_m/first",
            "/output_torques_n_m/00",
            "/pair/~2",
        ] {
            assert!(!named(text), "{text}");
        }
        let pointer = Pointer::parse("/pair/driven/blank/hole/count").unwrap();
        let (code, detail) = pointer.check_named().unwrap_err();
        assert_eq!(code, Code::UnknownField);
        assert!(detail.contains("bore_radius_mm, shaft, holes"), "{detail}");
    }

    #[test]
    fn a_pointer_covers_itself_and_what_is_below_it_only() {
        let holes = Pointer::parse("/pair/driven/blank/holes").unwrap();
        assert!(
            holes.covers("/pair/driven/blank/holes")
                && holes.covers("/pair/driven/blank/holes/count")
        );
        assert!(
            !holes.covers("/pair/driven/blank") && !holes.covers("/pair/driven/blank/holes_mm")
        );
    }
}
