//! The schema of a submission against its reader and its defaults.

use std::collections::{BTreeSet, HashMap};

use serde_json::Value;

use super::{DOCUMENT_VERSION, SubmissionDocument, least};
use crate::declare::Object as _;
use crate::examples;
use crate::hash::sha256_hex;
use crate::pointer::Pointer;
use crate::testing::{filled_in, parse};

#[test]
fn every_field_of_the_schema_has_a_title_and_the_defaults_are_those_that_are_filled_in() {
    let mut named = vec![("Submission", SubmissionDocument::json_schema())];
    SubmissionDocument::name_fields(&mut named);
    let schemas: HashMap<_, Value> = named.into_iter().collect();
    let echo: Value =
        serde_json::from_str(&parse(&least()).expect("valid").canonical_json()).expect("JSON");
    for (name, place) in [
        ("Submission", ""),
        ("Pair", "/pair"),
        ("Gear", "/pair/driven"),
        ("Material", "/pair/driven/material"),
        ("Blank", "/pair/driven/blank"),
        ("Resolution", "/resolution"),
        ("LoadDistribution", "/resolution/load_distribution"),
    ] {
        let schema = &schemas[name];
        let fields = echo
            .pointer(place)
            .and_then(Value::as_object)
            .expect("an object");
        let properties = schema["properties"].as_object().expect("properties");
        // One of several ways to give the same quantity is left out where another is taken.
        let is_echoed = |field: &&String| {
            let ways = [
                "tooth_thickness_deviation_normal_um",
                "span_measurement",
                "ball_measurement",
                "root_diameter_mm",
                "generating_profile_shift",
                "shaft",
                "protuberance",
                "spokes",
                "outline",
                "name",
                "window_starts",
            ];
            !ways.contains(&field.as_str())
        };
        assert_eq!(
            fields.keys().collect::<Vec<_>>(),
            properties.keys().filter(is_echoed).collect::<Vec<_>>(),
            "{name} is echoed field by field"
        );
        for (field, property) in properties {
            if property.get("$ref").is_none() {
                assert!(property["title"].is_string(), "{name}.{field}");
            }
            // A span that is not given is filled in with the true period.
            if let Some(default) = property
                .get("default")
                .filter(|_| field != "span_mesh_periods" && is_echoed(&field))
            {
                assert_eq!(default.as_f64(), fields[field].as_f64(), "{name}.{field}");
                if !default.is_number() {
                    assert_eq!(default, &fields[field], "{name}.{field}");
                }
            }
            let number = ["number", "integer"]
                .iter()
                .any(|kind| property["type"] == **kind);
            if number {
                assert!(
                    property["minimum"].is_number() && property["maximum"].is_number(),
                    "{name}.{field}"
                );
                assert!(property["x-unit"].is_string(), "{name}.{field}");
            }
        }
    }
}

#[test]
fn every_field_of_every_echo_is_one_of_the_schema() {
    fn check(value: &Value, here: &str) {
        if !here.is_empty() {
            let named = Pointer::parse(here).and_then(|pointer| pointer.check_named());
            assert!(named.is_ok(), "{here}: {named:?}");
        }
        match value {
            Value::Object(fields) => fields
                .iter()
                .for_each(|(key, value)| check(value, &format!("{here}/{key}"))),
            Value::Array(items) => items
                .iter()
                .enumerate()
                .for_each(|(i, value)| check(value, &format!("{here}/{i}"))),
            _ => {}
        }
    }
    for example in examples().iter().filter(|example| example.valid) {
        check(&filled_in(example.name), "");
    }
}

#[test]
fn a_submission_with_other_fields_or_words_has_another_version() {
    fn collect(schema: &Value, here: &str, found: &mut BTreeSet<String>) {
        match schema {
            Value::Object(parts) => {
                for (key, part) in parts {
                    match (key.as_str(), part) {
                        ("properties", Value::Object(fields)) => {
                            for (field, part) in fields {
                                let here = format!("{here}.{field}");
                                collect(part, &here, found);
                                found.insert(here);
                            }
                        }
                        ("enum", Value::Array(words)) => {
                            found.extend(words.iter().map(|word| format!("{here}={word}")));
                        }
                        _ => collect(part, here, found),
                    }
                }
            }
            Value::Array(parts) => parts.iter().for_each(|part| collect(part, here, found)),
            _ => {}
        }
    }
    let mut named = vec![("Submission", SubmissionDocument::json_schema())];
    SubmissionDocument::name_fields(&mut named);
    let mut found = BTreeSet::new();
    for (name, schema) in &named {
        collect(schema, name, &mut found);
    }
    let told: Vec<String> = found.into_iter().collect();
    // Who changes the fields raises DOCUMENT_VERSION, once between two releases, and puts the new hash here: a process of the version before
    // would refuse the jobs of this one.
    assert_eq!(
        (DOCUMENT_VERSION, sha256_hex(told.join("\n")).as_str()),
        (
            4,
            "a155f6f4870bfd55bbe6e32d4679ade5bf6e1beaf301b9cd0a7e80f8a17bd2d0"
        ),
        "{told:#?}"
    );
}
