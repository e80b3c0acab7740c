//! One declaration for every object of the wire; from it come its reader, its writer and its schema.
//!
//! A [`document!`] declares for each field its name, its type, a sentence, and a specification such as `number("Module", "mm", 0.1, 50.0)`: title, unit,
//! bounds, and default. The content of a specification depends on the type of the field, which is a [`Kind`]. The declaration of a field is a constant of its
//! object, named as the field, for code that looks up its unit or its bounds. The declaration of an answered object also has the source of each field.

mod errors;
mod list;
mod nested;
mod node;
mod number;
mod optional;
mod reader;
mod words;

use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;

pub use errors::Errors;
pub use list::{List, list};
pub use nested::{
    EACH, Exclusion, Nested, Object, Property, document, exclusive, nested, object, tagged,
    utoipa_schema,
};
pub use node::{Node, escaped, shortened};
pub use number::{Number, meant_by, number};
pub use optional::{Optional, absent, or_else, or_null, unless};
pub(crate) use reader::nearest_word;
pub use reader::{Location, ObjectReader, is_meant};
pub use words::{Choice, Flag, OneWord, Text, flag, is_short_text, text, word, words};

/// The named schemas that others refer to.
pub type Named = Vec<(&'static str, Value)>;

/// A kind of value: how it is read, written and described, by its declaration.
pub trait Kind: Sized {
    /// Declaration of such a value.
    type Spec;

    /// Plural of the value: the expected content of a list of them, and the name in its count.
    const MANY: [&'static str; 2] = ["objects", "items"];

    /// Reads the value at `place`. Faults are reported there.
    fn read(node: &Node, place: &Location<'_>, spec: &Self::Spec) -> Option<Self>;

    /// Reads the field `name`.
    fn read_field(
        reader: &mut ObjectReader<'_>,
        name: &'static str,
        spec: &Self::Spec,
    ) -> Option<Self> {
        let node = reader.get(name);
        match node.filter(|node| **node != Node::Null || !Self::takes_null(spec)) {
            Some(node) => Self::read(node, &reader.place_of(name), spec),
            None => Self::absent(reader, name, spec),
        }
    }

    /// True if null counts as absent.
    fn takes_null(_: &Self::Spec) -> bool {
        false
    }

    /// Default of an absent value; `None` if it has to be given.
    fn usual(_: &Self::Spec) -> Option<Self> {
        None
    }

    /// Value that another field of the object gives in its place; `None` if none does.
    fn by_another(_: &ObjectReader<'_>, _: &Self::Spec) -> Option<Self> {
        None
    }

    /// Value of the absent field `name`.
    /// Value of the absent field `name`.
    fn absent(
        reader: &mut ObjectReader<'_>,
        name: &'static str,
        spec: &Self::Spec,
    ) -> Option<Self> {
        Self::usual(spec).or_else(|| reader.missing(name))
    }

    /// True if it has to be given.
    fn is_needed(spec: &Self::Spec) -> bool {
        Self::usual(spec).is_none()
    }

    /// The field that cannot be given together with it.
    fn exclusion(_: &Self::Spec) -> Option<Exclusion> {
        None
    }

    /// True if its field is not written.
    fn is_left_out(&self, _: &Self::Spec) -> bool {
        false
    }

    /// Writes it.
    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error>;

    /// Schema of the value; `about` is the sentence of its field.
    fn describe(about: &str, spec: &Self::Spec) -> Value;

    /// Adds the schemas that its own refers to.
    fn name_parts(_: &mut Named) {}
}

/// The declaration of a field.
#[derive(Debug, Clone, Copy)]
pub struct Declared<S> {
    /// Its name.
    pub name: &'static str,
    /// Description.
    pub about: &'static str,
    /// Specification of its kind of value.
    pub spec: S,
    /// True if plane methods refuse it.
    is_solid: bool,
}

impl<S: Copy> Declared<S> {
    /// The same of a field that plane methods refuse. The schema says so by `x-dimensions`.
    pub const fn in_three_dimensions(self) -> Self {
        Self {
            is_solid: true,
            ..self
        }
    }
}

impl<S> Declared<S> {
    /// The declaration of the field `name`.
    pub const fn new(name: &'static str, about: &'static str, spec: S) -> Self {
        Self {
            name,
            about,
            spec,
            is_solid: false,
        }
    }

    /// Reads the field.
    pub fn read<K: Kind<Spec = S>>(&self, reader: &mut ObjectReader<'_>) -> Option<K> {
        K::read_field(reader, self.name, &self.spec)
    }

    /// Writes the field.
    pub fn write<K: Kind<Spec = S>, M: SerializeMap>(
        &self,
        value: &K,
        map: &mut M,
    ) -> Result<(), M::Error> {
        if value.is_left_out(&self.spec) {
            return Ok(());
        }
        map.serialize_entry(self.name, &Written(value))
    }

    /// Schema of the field.
    pub fn property<K: Kind<Spec = S>>(&self) -> Property {
        let mut schema = K::describe(self.about.trim_start(), &self.spec);
        if self.is_solid {
            schema["x-dimensions"] = Value::from(3);
        }
        Property {
            exclusion: K::exclusion(&self.spec),
            ..Property::new(self.name, schema, K::is_needed(&self.spec))
        }
    }
}

/// A value as serde writes it.
pub struct Written<'a, K>(pub &'a K);

impl<K: Kind> Serialize for Written<'_, K> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.write(serializer)
    }
}
