//! Values that may be absent: because that means something, or because another field stands in their place.

use serde::Serializer;
use serde_json::{Value, json};

use super::{Declared, Exclusion, Kind, Location, Named, Node, ObjectReader};

/// Meaning of an absent value.
#[derive(Debug, Clone, Copy)]
enum Absent {
    /// This. Null is as good.
    Means(&'static str),
    /// Another field stands in its place; where those are absent too, the default of the value by itself.
    Unless,
    /// That another field stands in its place; one of the two has to be given.
    OneOf,
}

/// Declaration of a value that may be absent.
#[derive(Debug, Clone, Copy)]
pub struct Optional<S> {
    /// Declaration of the given value.
    pub spec: S,
    absent: Absent,
    /// The fields that cannot be given together with it.
    others: &'static [&'static str],
    /// True if an absent value is left out instead of being written as null.
    left_out: bool,
}

const fn optional<S>(spec: S, absent: Absent, others: &'static [&'static str]) -> Optional<S> {
    Optional {
        spec,
        absent,
        others,
        left_out: false,
    }
}

/// Absent, it means `meaning`.
pub const fn absent<S>(spec: S, meaning: &'static str) -> Optional<S> {
    optional(spec, Absent::Means(meaning), &[])
}

/// Read and filled in by itself, unless one of the fields `others` is given.
pub const fn unless<S>(others: &'static [&'static str], spec: S) -> Optional<S> {
    optional(spec, Absent::Unless, others)
}

/// Either this or one of the fields `others`.
pub const fn or_else<S>(others: &'static [&'static str], spec: S) -> Optional<S> {
    optional(spec, Absent::OneOf, others)
}

impl<S: Copy> Optional<S> {
    /// Refused together with the fields `others`.
    pub const fn not_beside(self, others: &'static [&'static str]) -> Self {
        Self { others, ..self }
    }

    /// Not written where it is absent.
    pub const fn left_out(self) -> Self {
        let left_out = true;
        Self { left_out, ..self }
    }
}

impl<S> Declared<Optional<S>> {
    /// The declaration of the value that is given.
    pub fn given(self) -> Declared<S> {
        Declared::new(self.name, self.about, self.spec.spec)
    }
}

impl<T: Kind> Kind for Option<T> {
    type Spec = Optional<T::Spec>;

    fn read(node: &Node, place: &Location<'_>, spec: &Self::Spec) -> Option<Self> {
        T::read(node, place, &spec.spec).map(Some)
    }

    fn read_field(
        reader: &mut ObjectReader<'_>,
        name: &'static str,
        spec: &Self::Spec,
    ) -> Option<Self> {
        let node = reader.present(name);
        if reader.is_refused(name) {
            return Some(None);
        }
        for &other in spec.others {
            reader.refuse_both(name, other);
        }
        if spec
            .others
            .iter()
            .any(|other| reader.present(other).is_some())
        {
            return Some(None);
        }
        match (node, spec.absent) {
            (Some(node), _) => Self::read(node, &reader.place_of(name), spec),
            (None, Absent::Means(_)) => Some(None),
            (None, Absent::Unless) => T::absent(reader, name, &spec.spec).map(Some),
            (None, Absent::OneOf) => reader.missing_one_of(&[&[name], spec.others].concat()),
        }
    }

    fn is_needed(_: &Self::Spec) -> bool {
        false
    }

    fn is_left_out(&self, spec: &Self::Spec) -> bool {
        self.is_none() && spec.left_out
    }

    fn exclusion(spec: &Self::Spec) -> Option<Exclusion> {
        let is_one_needed = match spec.absent {
            Absent::Means(_) => false,
            Absent::Unless => T::is_needed(&spec.spec),
            Absent::OneOf => true,
        };
        (!spec.others.is_empty()).then_some(Exclusion {
            others: spec.others,
            is_one_needed,
        })
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Some(value) => value.write(serializer),
            None => serializer.serialize_none(),
        }
    }

    fn describe(about: &str, spec: &Self::Spec) -> Value {
        let about = match spec.others {
            [] => about.to_owned(),
            others => format!("{about} Not together with {}.", others.join(" or ")),
        };
        let mut schema = or_null(T::describe(&about, &spec.spec));
        if let Absent::Means(meaning) = spec.absent {
            schema["default"] = Value::Null;
            schema["x-absent"] = json!(meaning);
            if let Some(said) = schema["description"].as_str() {
                schema["description"] = json!(format!("{said} Default: {meaning}."));
            }
        }
        schema
    }

    fn name_parts(named: &mut Named) {
        T::name_parts(named);
    }
}

/// Schema of a value that may also be null; null counts as absent.
pub fn or_null(mut schema: Value) -> Value {
    let nothing = json!({ "type": "null" });
    if schema.get("type").is_some() {
        schema["type"] = json!([schema["type"], "null"]);
        if let Some(words) = schema.get_mut("enum").and_then(Value::as_array_mut) {
            words.push(Value::Null);
        }
    } else if let Some(alternatives) = schema.get_mut("oneOf").and_then(Value::as_array_mut) {
        alternatives.insert(0, nothing);
    } else {
        schema = json!({ "oneOf": [nothing, schema] });
    }
    schema
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declare::{EACH, Errors, Object as _, document, number};

    document! {
        /// Something whose fields exclude each other.
        struct Thing as "Thing", "Thing" {
            /// One of the two has to be given.
            length: Option<f64> = or_else(&["angle"], number("Length", "m", 0.0, 9.0)),
            /// The other one.
            angle: Option<f64> = or_else(&["length"], number("Angle", "rad", 0.0, 9.0)),
            /// One of the two may be given.
            chamfer: Option<f64> =
                absent(number("Chamfer", "m", 0.0, 9.0), "none").not_beside(&["rounding"]),
            /// The other one.
            rounding: Option<f64> = absent(number("Rounding", "m", 0.0, 9.0), "none"),
            /// One has a default, in whose place the other may stand.
            width: Option<f64> = unless(&["share"], number("Width", "m", 0.0, 9.0).or(1.0)),
            /// The other one.
            share: Option<f64> = absent(number("Share", "1", 0.0, 9.0), "the width decides"),
        }
    }

    /// True if `schema`, in the keywords about present fields, allows `value`.
    fn allows(schema: &Value, value: &Value) -> bool {
        let all = |schemas: &Value, count: fn(usize, usize) -> bool| {
            schemas.as_array().is_none_or(|schemas| {
                let met = schemas.iter().filter(|schema| allows(schema, value));
                count(met.count(), schemas.len())
            })
        };
        let properties = schema["properties"].as_object().into_iter().flatten();
        all(&schema["allOf"], |met, all| met == all)
            && all(&schema["anyOf"], |met, _| met > 0)
            && all(&schema["oneOf"], |met, _| met == 1)
            && (schema["type"] != "null" || value.is_null())
            && schema.get("not").is_none_or(|not| !allows(not, value))
            && properties
                .filter_map(|(name, schema)| Some((schema, value.get(name)?)))
                .all(|(schema, value)| allows(schema, value))
    }

    #[test]
    fn the_schema_allows_together_what_the_reader_takes_together() {
        let schema = Thing::json_schema();
        let names = ["length", "angle", "chamfer", "rounding", "width", "share"];
        let states = [None, Some(Value::Null), Some(json!(0.5))];
        let mut taken = 0;
        for number in 0..3_usize.pow(6) {
            let state = |i: usize| states[number / 3_usize.pow(i as u32) % 3].clone();
            let fields = names.iter().enumerate();
            let fields = fields.filter_map(|(i, name)| Some(((*name).to_owned(), state(i)?)));
            let document = Value::Object(fields.collect());
            let errors = Errors::default();
            Thing::read(&Node::of(&document), &Location::root(&errors), &EACH);
            let is_taken = errors.count() == 0;
            assert_eq!(allows(&schema, &document), is_taken, "{document}");
            taken += usize::from(is_taken);
        }
        assert!(taken > 50, "{taken}");
    }

    #[test]
    fn words_of_which_none_may_be_given_are_null_as_well() {
        let words = json!({ "type": "string", "enum": ["a", "b"] });
        assert_eq!(or_null(words)["enum"], json!(["a", "b", null]));
    }
}
