//! OpenAPI schemas built from the same tables as the checks.

use meshwright_engine::analysis::Method;
use serde_json::{Value, json};
use utoipa::ToSchema;
use utoipa::openapi::extensions::ExtensionsBuilder;
use utoipa::openapi::schema::{
    AdditionalProperties, ArrayBuilder, Object, ObjectBuilder, OneOfBuilder, Schema, SchemaType,
    Type,
};
use utoipa::openapi::{Ref, RefOr};

use super::quantity::{Preset, Quantity};
use super::tree::Choice;

/// A property of an object: its name, its schema, and whether it is needed.
pub(super) type Property = (&'static str, RefOr<Schema>, bool);

/// The named schemas that others refer to.
pub(super) type Named = Vec<(String, RefOr<Schema>)>;

/// An object that has these properties and no others.
pub(super) fn object(title: &str, description: &str, properties: Vec<Property>) -> RefOr<Schema> {
    let mut object = ObjectBuilder::new()
        .schema_type(Type::Object)
        .title(Some(title))
        .description(Some(description))
        .additional_properties(Some(AdditionalProperties::<Schema>::FreeForm(false)));
    for (name, schema, needed) in properties {
        object = object.property(name, schema);
        if needed {
            object = object.required(name);
        }
    }
    object.into()
}

/// The property that `quantity` is.
pub(super) fn number(quantity: &Quantity) -> Property {
    let needed = quantity.preset == Preset::Needed;
    (quantity.name, number_schema(quantity), needed)
}

/// The schema of `quantity`: title, unit, default and bounds.
pub(super) fn number_schema(quantity: &Quantity) -> RefOr<Schema> {
    let base = if quantity.whole {
        Type::Integer
    } else {
        Type::Number
    };
    let (schema_type, default, said): (SchemaType, Option<Value>, String) = match quantity.preset {
        Preset::Needed => (base.into(), None, String::new()),
        Preset::Value(value) => (
            base.into(),
            Some(literal(value, quantity.whole)),
            String::new(),
        ),
        Preset::Modules(modules) => (base.into(), None, format!(" Default: {modules} modules.")),
        Preset::ModulesUnless(modules, other) => (
            [base, Type::Null].into_iter().collect(),
            None,
            format!(" Default: {modules} modules, unless {other} is given."),
        ),
        Preset::Absent(meaning) => (
            [base, Type::Null].into_iter().collect(),
            Some(Value::Null),
            format!(" Default: {meaning}."),
        ),
    };
    let (mut least, most) = quantity.bounds;
    if quantity.or_zero {
        least = least.min(0.0);
    }
    let bounds = ObjectBuilder::new();
    let bounds = if quantity.whole {
        bounds
            .minimum(Some(least as i64))
            .maximum(Some(most as i64))
    } else {
        bounds.minimum(Some(least)).maximum(Some(most))
    };
    bounds
        .schema_type(schema_type)
        .title(Some(quantity.title))
        .description(Some(format!(
            "{} Unit: {}.{said}",
            quantity.description, quantity.unit
        )))
        .default(default)
        .extensions(Some(
            ExtensionsBuilder::new()
                .add("x-unit", quantity.unit)
                .build(),
        ))
        .into()
}

fn literal(value: f64, whole: bool) -> Value {
    if whole {
        json!(value as i64)
    } else {
        json!(value)
    }
}

/// A property that takes one of several words.
pub(super) fn choice<C: Choice>(
    name: &'static str,
    title: &str,
    description: &str,
    default: Option<C>,
) -> Property {
    (
        name,
        choice_schema(title, description, default),
        default.is_none(),
    )
}

/// The schema of the word of a method.
pub fn method_schema() -> RefOr<Schema> {
    choice_schema::<Method>("Method", "How the curves are computed.", None)
}

/// The schema of one of several words.
pub(super) fn choice_schema<C: Choice>(
    title: &str,
    description: &str,
    default: Option<C>,
) -> RefOr<Schema> {
    let meanings: Vec<_> = C::OPTIONS
        .iter()
        .map(|(word, _, meaning)| format!("`{word}`: {meaning}"))
        .collect();
    ObjectBuilder::new()
        .schema_type(Type::String)
        .title(Some(title))
        .description(Some(format!("{description} {}.", meanings.join("; "))))
        .enum_values(Some(C::OPTIONS.iter().map(|(word, ..)| *word)))
        .default(default.map(|default| json!(default.word())))
        .into()
}

/// The schema of one fixed word.
pub(super) fn word(title: &str, description: &str, word: &str) -> RefOr<Schema> {
    ObjectBuilder::new()
        .schema_type(Type::String)
        .title(Some(title))
        .description(Some(description))
        .enum_values(Some([word]))
        .into()
}

/// A property that is true or false.
pub(super) fn flag(name: &'static str, title: &str, description: &str, default: bool) -> Property {
    let schema = ObjectBuilder::new()
        .schema_type(Type::Boolean)
        .title(Some(title))
        .description(Some(description))
        .default(Some(json!(default)));
    (name, schema.into(), false)
}

/// A property that is the document `T`.
pub(super) fn document<T: ToSchema>(name: &'static str, needed: bool) -> Property {
    if needed {
        return (name, reference::<T>(), true);
    }
    // Null is as good as absent.
    let null = ObjectBuilder::new().schema_type(Type::Null);
    let either = OneOfBuilder::new()
        .title(Some(T::name()))
        .item(reference::<T>())
        .item(null);
    (name, either.into(), false)
}

/// A property that is the document `T` or null, which is its default.
pub(super) fn optional_document<T: ToSchema>(
    name: &'static str,
    title: &str,
    description: &str,
) -> Property {
    let schema = OneOfBuilder::new()
        .title(Some(title))
        .description(Some(description))
        .default(Some(Value::Null))
        .item(Object::with_type(Type::Null))
        .item(reference::<T>());
    (name, schema.into(), false)
}

/// A reference to the document `T`.
pub(super) fn reference<T: ToSchema>() -> RefOr<Schema> {
    Ref::from_schema_name(T::name()).into()
}

/// One of several schemas.
pub(super) fn one_of(
    title: &str,
    description: &str,
    default: Option<Value>,
    items: Vec<RefOr<Schema>>,
) -> RefOr<Schema> {
    items
        .into_iter()
        .fold(OneOfBuilder::new(), OneOfBuilder::item)
        .title(Some(title))
        .description(Some(description))
        .default(default)
        .into()
}

/// A list with bounds on its length.
pub(super) fn list(
    title: &str,
    description: &str,
    items: RefOr<Schema>,
    (least, most): (usize, usize),
) -> ArrayBuilder {
    ArrayBuilder::new()
        .title(Some(title))
        .description(Some(description))
        .items(items)
        .min_items(Some(least))
        .max_items(Some(most))
}

/// The property that is a list of numbers with these bounds on its length, or null where the list is `quantity`'s own choice.
pub(super) fn numbers(quantity: &Quantity, lengths: (usize, usize), needed: bool) -> Property {
    let item = ObjectBuilder::new()
        .schema_type(Type::Number)
        .minimum(Some(quantity.bounds.0))
        .maximum(Some(quantity.bounds.1));
    let said = format!("{} Unit: {}.", quantity.description, quantity.unit);
    let unit = ExtensionsBuilder::new().add("x-unit", quantity.unit);
    let array = list(quantity.title, &said, item.into(), lengths).extensions(Some(unit.build()));
    if needed {
        return (quantity.name, array.into(), true);
    }
    let types: SchemaType = [Type::Array, Type::Null].into_iter().collect();
    let array = array.schema_type(types).default(Some(Value::Null));
    (quantity.name, array.into(), false)
}

/// Implements the schema of a document by its `schema()` function, and names the documents that it refers to.
macro_rules! documented {
    ($document:ty, $name:literal, [$($part:ty),*], $schema:expr) => {
        impl utoipa::PartialSchema for $document {
            fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::schema::Schema> {
                $schema
            }
        }

        impl utoipa::ToSchema for $document {
            fn name() -> std::borrow::Cow<'static, str> {
                $name.into()
            }

            fn schemas(schemas: &mut $crate::wire::schema::Named) {
                let _ = &schemas;
                $(
                    schemas.push((
                        <$part as utoipa::ToSchema>::name().into_owned(),
                        <$part as utoipa::PartialSchema>::schema(),
                    ));
                    <$part as utoipa::ToSchema>::schemas(schemas);
                )*
            }
        }
    };
}

pub(super) use documented;
