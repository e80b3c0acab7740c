//! Objects, and those within others.

use serde::ser::{SerializeMap, Serializer};
use serde_json::{Map, Value, json};
use utoipa::openapi::RefOr;
use utoipa::openapi::extensions::ExtensionsBuilder;
use utoipa::openapi::schema::{ObjectBuilder, Schema};

use super::{Kind, Location, Named, Node, ObjectReader};

/// A property of an object.
pub struct Property {
    /// Its name.
    pub name: &'static str,
    /// Schema.
    pub schema: Value,
    /// True if it has to be given.
    pub is_needed: bool,
    /// Which others it cannot be given with.
    pub exclusion: Option<Exclusion>,
}

impl Property {
    /// One that excludes no other.
    pub const fn new(name: &'static str, schema: Value, is_needed: bool) -> Self {
        Self {
            name,
            schema,
            is_needed,
            exclusion: None,
        }
    }
}

/// That a field cannot be given together with some others.
#[derive(Debug, Clone, Copy)]
pub struct Exclusion {
    /// The names of the others.
    pub others: &'static [&'static str],
    /// True if one of them has to be given.
    pub is_one_needed: bool,
}

/// An object of the wire; [`document!`] and [`tagged!`] implement it.
pub trait Object: Sized {
    /// Its name in the contract.
    const NAME: &'static str;

    /// Reads its fields, beside which there may be others.
    fn read_fields(reader: &mut ObjectReader<'_>) -> Option<Self>;

    /// Writes its fields.
    fn write_fields<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error>;

    /// Schemas of its fields.
    fn properties() -> Vec<Property>;

    /// Schema.
    fn json_schema() -> Value;

    /// Adds the schemas that its own refers to.
    fn name_fields(named: &mut Named);

    /// Reads an object of these fields and no others.
    fn read_whole(mut reader: ObjectReader<'_>) -> Option<Self> {
        let read = Self::read_fields(&mut reader);
        reader.finish();
        read
    }
}

/// Declaration of an object within another one.
#[derive(Debug, Clone, Copy)]
pub struct Nested {
    title: &'static str,
    /// True if an absent or null object has its fields' defaults.
    or_defaults: bool,
}

/// An object that has to be given.
pub const fn nested(title: &'static str) -> Nested {
    let or_defaults = false;
    Nested { title, or_defaults }
}

/// An object that has to be given, without a description beside its own.
pub const EACH: Nested = nested("");

impl Nested {
    /// Absent or null, it has the default of every field.
    pub const fn or_defaults(self) -> Self {
        let or_defaults = true;
        Self {
            or_defaults,
            ..self
        }
    }
}

impl<O: Object> Kind for O {
    type Spec = Nested;

    fn read(node: &Node, place: &Location<'_>, _: &Nested) -> Option<Self> {
        Self::read_whole(ObjectReader::new(node, place.clone())?)
    }

    fn takes_null(spec: &Nested) -> bool {
        spec.or_defaults
    }

    fn absent(reader: &mut ObjectReader<'_>, name: &'static str, spec: &Nested) -> Option<Self> {
        if !spec.or_defaults {
            return reader.missing(name);
        }
        Self::read(&Node::Object(Vec::new()), &reader.place_of(name), spec)
    }

    fn is_needed(spec: &Nested) -> bool {
        !spec.or_defaults
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        self.write_fields(&mut map)?;
        map.end()
    }

    fn describe(about: &str, spec: &Nested) -> Value {
        let reference = json!({ "$ref": format!("#/components/schemas/{}", O::NAME) });
        if spec.or_defaults {
            return json!({ "title": spec.title, "description": about, "oneOf": [reference, { "type": "null" }] });
        }
        if spec.title.is_empty() {
            return reference;
        }
        json!({ "title": spec.title, "description": about, "oneOf": [reference] })
    }

    fn name_parts(named: &mut Named) {
        named.push((O::NAME, O::json_schema()));
        O::name_fields(named);
    }
}

/// The schema of an object that has these properties and no others.
pub fn object(title: &str, about: &str, properties: Vec<Property>) -> Value {
    let needed: Vec<_> = properties
        .iter()
        .filter(|property| property.is_needed)
        .map(|property| property.name)
        .collect();
    let mut pairs: Vec<([&str; 2], bool)> = Vec::new();
    for property in &properties {
        let Some(exclusion) = property.exclusion else {
            continue;
        };
        for &other in exclusion.others {
            // Either of the two may say so, or both.
            if !pairs
                .iter()
                .any(|(pair, _)| *pair == [other, property.name])
            {
                pairs.push(([property.name, other], exclusion.is_one_needed));
            }
        }
    }
    let exclusions: Vec<Value> = pairs
        .iter()
        .map(|(pair, is_one_needed)| exclusive(pair, *is_one_needed))
        .collect();
    let mut schema = json!({ "type": "object", "title": title, "description": about.trim_start() });
    if !needed.is_empty() {
        schema["required"] = json!(needed);
    }
    let properties = properties
        .into_iter()
        .map(|property| (property.name.to_owned(), property.schema));
    schema["properties"] = Value::Object(Map::from_iter(properties));
    schema["additionalProperties"] = json!(false);
    if !exclusions.is_empty() {
        schema["allOf"] = json!(exclusions);
    }
    schema
}

/// Schema of fields that exclude each other: one alternative for each, and one for none of them unless one has to be given. Null counts as absent.
///
/// The schema stands in an `allOf` beside the properties and only excludes: generators of clients make no types of such alternatives.
pub fn exclusive(names: &[&str], is_one_needed: bool) -> Value {
    let given = |name: &&str| json!({ "not": { "properties": { *name: { "type": "null" } } } });
    let mut alternatives: Vec<Value> = names.iter().map(given).collect();
    if !is_one_needed {
        alternatives.push(json!({ "not": { "anyOf": alternatives } }));
    }
    json!({ "oneOf": alternatives })
}

/// `schema` in a form that utoipa carries to the finished document, which then contains it. The model of utoipa knows fewer keywords than our schemas use, and
/// drops the others.
pub fn utoipa_schema(schema: Value) -> RefOr<Schema> {
    let declared = ExtensionsBuilder::new().add("x-declared", schema).build();
    ObjectBuilder::new().extensions(Some(declared)).into()
}

/// Declares an object of the interface.
///
/// Of one that is sent each field has its type, a sentence and a specification: `field: f64 = number("Title", "mm", 0.1, 50.0),`. From it come reader,
/// writer and schema.
///
/// Each field of an answered object (`answer of (what: &There, is: f64)`) has its type, a sentence and its source; a field with a question mark is absent where
/// its source is `None`. It can be read back. An object that is only written is a `view of (…)`.
#[macro_export]
macro_rules! document {
    (
        $(#[doc = $about:literal])*
        $visibility:vis struct $Object:ident as $name:literal, $title:literal {
            $(
                $(#[doc = $sentence:literal])*
                $within:vis $field:ident: $kind:ty = $spec:expr $(=> $needs:ident)?,
            )*
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, PartialEq)]
        $visibility struct $Object {
            $($(#[doc = $sentence])* $within $field: $kind,)*
        }

        #[expect(non_upper_case_globals, reason = "a declaration is named as its field")]
        impl $Object {
            $(
                $(#[doc = $sentence])*
                $visibility const $field:
                    $crate::declare::Declared<<$kind as $crate::declare::Kind>::Spec> =
                    $crate::declare::Declared::new(
                        stringify!($field),
                        concat!($($sentence),*),
                        $spec,
                    )$(.$needs())?;
            )*
        }

        impl $crate::declare::Object for $Object {
            const NAME: &'static str = $name;

            fn read_fields(reader: &mut $crate::declare::ObjectReader<'_>) -> Option<Self> {
                // All of them are read, so that all that is wrong is reported.
                $(let $field = Self::$field.read(reader);)*
                Some(Self { $($field: $field?),* })
            }

            fn write_fields<M: serde::ser::SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
                $(Self::$field.write(&self.$field, map)?;)*
                Ok(())
            }

            fn properties() -> Vec<$crate::declare::Property> {
                vec![$(Self::$field.property::<$kind>()),*]
            }

            fn json_schema() -> serde_json::Value {
                $crate::declare::object($title, concat!($($about),*), Self::properties())
            }

            fn name_fields(named: &mut $crate::declare::Named) {
                $(<$kind as $crate::declare::Kind>::name_parts(named);)*
            }
        }

        $crate::document!(@known $Object);
    };

    // Requests of other modules to an object.
    (@known $Object:ty) => {
        impl serde::Serialize for $Object {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $crate::declare::Kind::write(self, serializer)
            }
        }

        impl utoipa::PartialSchema for $Object {
            fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::schema::Schema> {
                use $crate::declare::Object;
                $crate::declare::utoipa_schema(Self::json_schema())
            }
        }

        impl utoipa::ToSchema for $Object {
            fn name() -> std::borrow::Cow<'static, str> {
                <Self as $crate::declare::Object>::NAME.into()
            }

            fn schemas(
                schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::schema::Schema>)>,
            ) {
                let mut named = Vec::new();
                <Self as $crate::declare::Object>::name_fields(&mut named);
                schemas.extend(named.into_iter().map(|(name, schema)| {
                    (name.to_owned(), $crate::declare::utoipa_schema(schema))
                }));
            }
        }
    };

    (
        $(#[$about:meta])*
        $visibility:vis struct $Object:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
        answer of $($rest:tt)*
    ) => {
        $crate::document! {
            @derive [Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, utoipa::ToSchema]
            $(#[$about])*
            $visibility struct $Object $(<$lifetime>)? as $name $(, $title)? of $($rest)*
        }
    };

    (
        $(#[$about:meta])*
        $visibility:vis struct $Object:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
        view of $($rest:tt)*
    ) => {
        $crate::document! {
            @derive [serde::Serialize, utoipa::ToSchema]
            $(#[$about])*
            $visibility struct $Object $(<$lifetime>)? as $name $(, $title)? of $($rest)*
        }
    };

    (
        @next [$($derive:path),*] $head:tt [$($known:tt)*]
        $(#[$about:meta])* $field:ident?: $kind:ty = $source:expr, $($rest:tt)*
    ) => {
        $crate::document! {
            @next [$($derive),*] $head
            [
                $($known)*
                $(#[$about])*
                #[serde(default, skip_serializing_if = "Option::is_none")]
                $field: Option<$kind> = $source,
            ]
            $($rest)*
        }
    };

    (
        @next [$($derive:path),*] $head:tt [$($known:tt)*]
        $(#[$about:meta])* $field:ident: $kind:ty = $source:expr, $($rest:tt)*
    ) => {
        $crate::document! {
            @next [$($derive),*] $head [$($known)* $(#[$about])* $field: $kind = $source,] $($rest)*
        }
    };

    (
        @next [$($derive:path),*]
        [
            $(#[$about:meta])*
            $visibility:vis struct $Object:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
            of $given:tt { $($before:tt)* }
        ]
        [$($(#[$sentence:meta])* $field:ident: $kind:ty = $source:expr,)*]
    ) => {
        $(#[$about])*
        #[derive($($derive),*)]
        #[schema(as = $name $(, title = $title)?)]
        $visibility struct $Object $(<$lifetime>)? {
            $($(#[$sentence])* $visibility $field: $kind,)*
        }

        impl $(<$lifetime>)? $Object $(<$lifetime>)? {
            /// Makes the document from its sources.
            $visibility fn of $given -> Self {
                $($before)*
                Self { $($field: $source,)* }
            }
        }
    };

    (
        @derive [$($derive:path),*]
        $(#[$about:meta])*
        $visibility:vis struct $Object:ident $(<$lifetime:lifetime>)? as $name:ident $(, $title:literal)?
        of $given:tt $(with { $($before:tt)* })? { $($fields:tt)* }
    ) => {
        $crate::document! {
            @next [$($derive),*]
            [
                $(#[$about])*
                $visibility struct $Object $(<$lifetime>)? as $name $(, $title)?
                of $given { $($($before)*)? }
            ]
            [] $($fields)*
        }
    };
}

pub use document;

/// Declares an object that is of one of several kinds, named by the word of its field `kind`.
#[macro_export]
macro_rules! tagged {
    (
        $(#[doc = $about:literal])*
        $visibility:vis enum $Object:ident as $name:literal, $title:literal {
            $(
                $(#[doc = $meaning:literal])*
                $Variant:ident($part:ty) = $word:literal as $part_name:literal, $part_title:literal,
            )*
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, PartialEq)]
        $visibility enum $Object {
            $($(#[doc = $meaning])* $Variant($part),)*
        }

        impl $crate::declare::Object for $Object {
            const NAME: &'static str = $name;

            fn read_fields(reader: &mut $crate::declare::ObjectReader<'_>) -> Option<Self> {
                use $crate::declare::{Node, Object};
                const WORDS: &[&str] = &[$($word),*];
                match reader.get("kind") {
                    $(
                        Some(Node::Text(word)) if word == $word => {
                            <$part as Object>::read_fields(reader).map(Self::$Variant)
                        }
                    )*
                    other => reader.refuse_kind(other, WORDS),
                }
            }

            fn write_fields<M: serde::ser::SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
                match self {
                    $(
                        Self::$Variant(part) => {
                            map.serialize_entry("kind", $word)?;
                            $crate::declare::Object::write_fields(part, map)
                        }
                    )*
                }
            }

            fn properties() -> Vec<$crate::declare::Property> {
                Vec::new()
            }

            fn json_schema() -> serde_json::Value {
                serde_json::json!({
                    "title": $title,
                    "description": concat!($($about),*).trim_start(),
                    "oneOf": [$({ "$ref": concat!("#/components/schemas/", $part_name) }),*],
                })
            }

            fn name_fields(named: &mut $crate::declare::Named) {
                use $crate::declare::{Object, Property};
                $(
                    let kind = serde_json::json!({
                        "type": "string",
                        "title": "Kind",
                        "description": "Kind.",
                        "enum": [$word],
                    });
                    let mut properties = vec![Property::new("kind", kind, true)];
                    properties.extend(<$part as Object>::properties());
                    let schema =
                        $crate::declare::object($part_title, concat!($($meaning),*), properties);
                    named.push(($part_name, schema));
                    <$part as Object>::name_fields(named);
                )*
            }
        }

        $crate::document!(@known $Object);
    };
}

pub use tagged;
