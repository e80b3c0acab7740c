//! A model in JSON.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::content::{Attribute, Component, Content, Relation};
use super::fault::Faults;

/// The file.
#[derive(Deserialize)]
struct File {
    model: Model,
}

#[derive(Deserialize)]
struct Model {
    #[serde(default)]
    version: Scalar,
    #[serde(default)]
    relations: Vec<Related>,
    #[serde(default)]
    components: Vec<Part>,
    #[serde(default)]
    load_spectrum: Option<Spectrum>,
}

#[derive(Deserialize)]
struct Related {
    #[serde(rename = "type", default)]
    kind: String,
    #[serde(default)]
    order: Option<i64>,
    #[serde(default)]
    refs: Vec<Reference>,
}

#[derive(Deserialize)]
struct Reference {
    id: i64,
    #[serde(default)]
    role: String,
}

#[derive(Deserialize)]
struct Part {
    id: i64,
    /// Components of load cases have none.
    #[serde(rename = "type", default)]
    kind: Option<String>,
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    attributes: Vec<Said>,
}

#[derive(Deserialize)]
struct Spectrum {
    #[serde(default)]
    load_cases: Vec<LoadCase>,
}

#[derive(Deserialize)]
struct LoadCase {
    #[serde(default)]
    id: i64,
    #[serde(default)]
    components: Vec<Part>,
}

/// An attribute: its value stands under the name of its type, of which there are twenty.
struct Said {
    id: String,
    unit: Option<String>,
    value: Scalar,
}

/// A value, as a text; lists are passed over.
#[derive(Default)]
enum Scalar {
    /// Nothing is said.
    #[default]
    Null,
    Text(String),
    /// And its numbers, if it has three.
    List(Option<[f64; 3]>),
}

impl Scalar {
    /// The text of it, none of a list.
    fn text(self) -> Option<String> {
        match self {
            Self::Null => Some(String::new()),
            Self::Text(text) => Some(text),
            Self::List(_) => None,
        }
    }
}

impl<'de> Deserialize<'de> for Scalar {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Scalar;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a value of an attribute")
            }
            fn visit_unit<E>(self) -> Result<Scalar, E> {
                Ok(Scalar::Null)
            }
            fn visit_bool<E>(self, value: bool) -> Result<Scalar, E> {
                Ok(Scalar::Text(value.to_string()))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Scalar, E> {
                Ok(Scalar::Text(value.to_string()))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Scalar, E> {
                Ok(Scalar::Text(value.to_string()))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Scalar, E> {
                Ok(Scalar::Text(value.to_string()))
            }
            fn visit_str<E>(self, value: &str) -> Result<Scalar, E> {
                Ok(Scalar::Text(value.to_owned()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Scalar, A::Error> {
                let (mut numbers, mut length) = ([f64::NAN; 3], 0);
                while let Some(cell) = list.next_element::<Scalar>()? {
                    if let (Some(number), Scalar::Text(text)) = (numbers.get_mut(length), &cell) {
                        *number = text.parse().unwrap_or(f64::NAN);
                    }
                    length += 1;
                }
                let vector = length == 3 && numbers.iter().all(|number| number.is_finite());
                Ok(Scalar::List(vector.then_some(numbers)))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut coded: A) -> Result<Scalar, A::Error> {
                while coded.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
                Ok(Scalar::List(None))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

impl<'de> Deserialize<'de> for Said {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = Said;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an attribute")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Said, A::Error> {
                let mut said = Said {
                    id: String::new(),
                    unit: None,
                    value: Scalar::Null,
                };
                while let Some(name) = fields.next_key::<String>()? {
                    match name.as_str() {
                        "id" => said.id = fields.next_value()?,
                        "unit" => said.unit = fields.next_value()?,
                        _ => said.value = fields.next_value()?,
                    }
                }
                Ok(said)
            }
        }
        deserializer.deserialize_map(Fields)
    }
}

impl Part {
    fn component(self, kind: String, name: String, faults: &mut Faults) -> Option<Component> {
        let attributes = self.attributes.into_iter().map(|said| {
            let vector = match &said.value {
                Scalar::List(vector) => *vector,
                _ => None,
            };
            Attribute::new(said.id, said.unit, said.value.text(), vector)
        });
        Component::new(self.id, kind, name, attributes.collect(), faults)
    }
}

/// The model in the text of a file.
///
/// # Errors
///
/// A sentence, if it is no JSON of a model.
pub(super) fn content(text: &str) -> Result<(String, Content), String> {
    let File { model } = serde_json::from_str(text)
        .map_err(|error| format!("It cannot be read as a model in JSON: {error}."))?;
    let mut faults = Faults::default();
    let mut components = Vec::new();
    for mut part in model.components {
        match part.kind.take() {
            Some(kind) => {
                let name = part.name.take().unwrap_or_default();
                components.extend(part.component(kind, name, &mut faults));
            }
            None => {
                let place = format!("component {}", part.id);
                faults.push(place, "A component needs a type.");
            }
        }
    }
    let cases = model.load_spectrum.map(|spectrum| spectrum.load_cases);
    let load_cases = cases.into_iter().flatten().map(|case| {
        // They have no types: those of the model's components are taken.
        let parts = case.components.into_iter().filter_map(|mut part| {
            let kind = part.kind.take().unwrap_or_default();
            let name = part.name.take().unwrap_or_default();
            part.component(kind, name, &mut faults)
        });
        let parts = parts.map(|part| (part.id, part)).collect();
        (case.id, parts)
    });
    let load_cases = load_cases.collect();
    let relations = model.relations.into_iter().map(|related| {
        let refs = related.refs.into_iter();
        let refs = refs.map(|reference| (reference.role, reference.id));
        Relation::new(related.kind, related.order.unwrap_or_default(), refs)
    });
    let content = Content {
        components,
        relations: relations.collect(),
        load_cases,
        faults,
    };
    Ok((model.version.text().unwrap_or_default(), content))
}
