//! The OpenAPI schemas of a study.

use meshwright_wire::Kept;
use meshwright_wire::declare::{
    Kind, Object, Property, exclusive, nested, object, or_null, utoipa_schema,
};
use meshwright_wire::submission::TAGS;
use serde_json::{Value, json};

use super::Study;
use super::constant_mass::ConstantMass;
use super::document::{KEEP, LONGEST_LABEL, MOST_CHANGES, NAME, PLANS};
use crate::MOST_DESIGNS;
use crate::population::PopulationDocument;
use crate::search::SearchDocument;

impl utoipa::PartialSchema for Study {
    fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
        let about = "One submission in many variants, at most 100,000, each of which is computed as a job. Give axes, designs, a population or a search. A design that cannot be built stands in the table with its problem.";
        let tags = Vec::<String>::describe(
            "Short strings to find the study by. They do not change the result.",
            &TAGS,
        );
        let base = json!({
            "description": "A submission as for POST /v1/jobs. What every design sets it may lack, and need not have right.",
            "anyOf": [{ "$ref": "#/components/schemas/Submission" }, { "type": "object" }],
        });
        let optional = |name, schema| Property::new(name, or_null(schema), false);
        let properties = vec![
            NAME.property::<Option<String>>(),
            Property::new("tags", tags, false),
            KEEP.property::<Kept>(),
            Property::new("base", base, true),
            optional("axes", axes()),
            optional("designs", designs()),
            optional("population", PopulationDocument::describe("", &nested(""))),
            optional("search", SearchDocument::describe("", &nested(""))),
            optional("constant_mass", ConstantMass::json_schema()),
        ];
        let mut schema = object("Study", about, properties);
        schema["allOf"] = json!([exclusive(&PLANS, true)]);
        utoipa_schema(schema)
    }
}

impl utoipa::ToSchema for Study {
    fn schemas(schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::Schema>)>) {
        let mut named = Vec::new();
        PopulationDocument::name_parts(&mut named);
        SearchDocument::name_parts(&mut named);
        schemas.extend(
            named
                .into_iter()
                .map(|(name, schema)| (name.to_owned(), utoipa_schema(schema))),
        );
    }
}

fn axes() -> Value {
    let path = json!({
        "type": "string",
        "title": "Path",
        "description": "A JSON pointer into the submission; it may name a whole object.",
        "examples": ["/pair/driven/blank/holes/count"],
    });
    let values = json!({ "title": "Value" });
    let values = list("Values", "The values, each once.", values, MOST_DESIGNS);
    let axis = object(
        "Axis",
        "A field and the values that it takes.",
        vec![
            Property::new("path", path, true),
            Property::new("values", values, true),
        ],
    );
    let about =
        "Fields and their values. Every combination is a design; the last axis changes fastest.";
    list("Axes", about, axis, MOST_CHANGES)
}

fn designs() -> Value {
    let label = json!({
        "type": "string",
        "title": "Label",
        "description": "What the design is called; each label stands once.",
        "minLength": 1,
        "maxLength": LONGEST_LABEL,
        "examples": ["8R34"],
    });
    let changes = json!({
        "type": ["object", "null"],
        "title": "Changes",
        "description": "JSON pointers into the submission and the values there, applied in their order.",
        "additionalProperties": true,
        "default": null,
    });
    let properties = vec![
        Property::new("label", label, true),
        Property::new("changes", changes, false),
    ];
    let design = object("Design", "A variant of the base.", properties);
    list("Designs", "The designs one by one.", design, MOST_DESIGNS)
}

fn list(title: &str, about: &str, items: Value, most: usize) -> Value {
    json!({ "type": "array", "title": title, "description": about, "items": items, "minItems": 1, "maxItems": most })
}
