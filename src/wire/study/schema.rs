//! What the OpenAPI document says of a study.

use meshwright_engine::gear::Member;
use serde_json::{Value, json};
use utoipa::openapi::schema::{AdditionalProperties, ObjectBuilder, SchemaType, Type};

use super::Study;
use super::constant_mass::MASS_REMOVED;
use super::document::{LONGEST_LABEL, MOST_CHANGES};
use super::size::MOST_DESIGNS;
use crate::wire::kept::Kept;
use crate::wire::schema::{self, documented};
use crate::wire::tags;

documented!(
    Study,
    "Study",
    [],
    schema::object(
        "Study",
        "One submission in many variants, at most 100,000, each of which is computed as a job. Give either axes or designs. A design that cannot be built stands in the table with its problem.",
        vec![
            (
                "name",
                ObjectBuilder::new()
                    .schema_type(nullable(Type::String))
                    .title(Some("Name"))
                    .description(Some("What the client calls the study. Default: none."))
                    .min_length(Some(1))
                    .max_length(Some(LONGEST_LABEL))
                    .default(Some(Value::Null))
                    .into(),
                false
            ),
            tags::property("study"),
            schema::choice("keep", "Keep", "How much is kept of each design that has been computed.", Some(Kept::Results)),
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

fn nullable(kind: Type) -> SchemaType {
    [kind, Type::Null].into_iter().collect()
}
