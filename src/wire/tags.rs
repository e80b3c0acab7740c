//! Tags: short strings to find jobs and studies by.

use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::problem::{Code, FieldError};
use super::quantity::MOST_TAGS;
use super::schema::{self, Property};
use super::tree::{Node, ObjectReader};

/// The field.
const NAME: &str = "tags";

/// What the schema says of the tags of `whom`.
pub(super) fn property(whom: &str) -> Property {
    let (most, longest) = MOST_TAGS;
    let tag = ObjectBuilder::new()
        .schema_type(Type::String)
        .title(Some("Tag"))
        .min_length(Some(1))
        .max_length(Some(longest))
        .into();
    let description =
        format!("Short strings to find the {whom} by. They do not change the result.");
    let list =
        schema::list("Tags", &description, tag, (0, most)).default(Some(serde_json::json!([])));
    (NAME, list.into(), false)
}

/// Reads the tags; `None` if they are none.
pub(super) fn read(reader: &mut ObjectReader<'_>) -> Option<Vec<String>> {
    let Some(node) = reader.get(NAME) else {
        return Some(Vec::new());
    };
    let Node::List(items) = node else {
        reader.wrong_kind(NAME, node, "a list of short strings");
        return None;
    };
    let (most, _) = MOST_TAGS;
    let pointer = reader.pointer_to(NAME);
    if items.len() > most {
        let detail = format!(
            "{pointer} has {} tags; at most {most} are kept.",
            items.len()
        );
        reader.report(FieldError::new(pointer, Code::OutOfRange, detail).nearest(most as f64));
        return None;
    }
    let tags = items
        .iter()
        .enumerate()
        .map(|(i, item)| read_tag(reader, item, format!("{pointer}/{i}")));
    tags.collect::<Vec<_>>().into_iter().collect()
}

fn read_tag(reader: &ObjectReader<'_>, item: &Node, pointer: String) -> Option<String> {
    let (_, longest) = MOST_TAGS;
    let (code, detail) = match item {
        Node::Text(tag) if is_short_text(tag, longest) => return Some(tag.clone()),
        Node::Text(_) => (
            Code::OutOfRange,
            format!(
                "{pointer} has to have 1 to {longest} characters, none of them a control character."
            ),
        ),
        _ => (Code::WrongType, format!("{pointer} is not a string.")),
    };
    reader.report(FieldError::new(pointer, code, detail));
    None
}

/// Whether a text has 1 to `longest` characters, none of them a control character.
pub(super) fn is_short_text(text: &str, longest: usize) -> bool {
    (1..=longest).contains(&text.chars().count()) && !text.chars().any(char::is_control)
}
