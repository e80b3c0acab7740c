//! A JSON document as it was sent: keys that stand twice are still there, so that they can be refused.

use std::collections::HashSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use crate::problem::{Code, FieldError, Problem};
use crate::units::plain;

/// A JSON value. Unlike `serde_json::Value` it keeps keys that stand twice, so that they can be refused.
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// Nothing.
    Null,
    /// True or false.
    Bool(bool),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// Names and values, in the order in which they were sent.
    Object(Vec<(String, Node)>),
}

impl Node {
    /// Reads one JSON document.
    ///
    /// # Errors
    ///
    /// `malformed_json` for a syntax error, for deep nesting and for a key that stands twice in one object.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        let node: Self = serde_json::from_slice(document).map_err(|error| {
            Problem::new(
                Code::MalformedJson,
                format!("The JSON ends or breaks: {error}."),
            )
        })?;
        match node.key_that_stands_twice() {
            None => Ok(node),
            Some(pointer) => {
                let detail = format!(
                    "The key at {} stands twice in its object.",
                    shortened(&pointer)
                );
                Err(Problem {
                    errors: vec![FieldError::new(
                        pointer,
                        Code::MalformedJson,
                        detail.clone(),
                    )],
                    ..Problem::new(Code::MalformedJson, detail)
                })
            }
        }
    }

    /// The document that serde read, which had no key twice.
    pub fn of(value: &serde_json::Value) -> Self {
        Self::deserialize(value).expect("every value of JSON is a node")
    }

    /// The same document for serde.
    pub fn to_value(&self) -> serde_json::Value {
        use serde_json::{Value, json};
        match self {
            Self::Null => Value::Null,
            Self::Bool(value) => Value::Bool(*value),
            // A count is written as one.
            Self::Number(value) if value.fract() == 0.0 && value.abs() < 1e15 => {
                json!(*value as i64)
            }
            Self::Number(value) => json!(value),
            Self::Text(text) => Value::String(text.clone()),
            Self::List(items) => items.iter().map(Self::to_value).collect(),
            Self::Object(fields) => {
                let fields = fields.iter();
                Value::Object(
                    fields
                        .map(|(key, value)| (key.clone(), value.to_value()))
                        .collect(),
                )
            }
        }
    }

    /// The value of one of its fields, if it is an object with it.
    pub fn into_field(self, name: &str) -> Option<Self> {
        let Self::Object(fields) = self else {
            return None;
        };
        let mut fields = fields.into_iter();
        fields.find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// A text that equal values have in common, and others have not.
    pub fn key(&self) -> String {
        format!("{self:?}")
    }

    /// The pointer to a key that stands twice in its object.
    fn key_that_stands_twice(&self) -> Option<String> {
        fn within(node: &Node, step: impl FnOnce() -> String) -> Option<String> {
            let rest = node.key_that_stands_twice()?;
            Some(joined("", &step()) + &rest)
        }
        match self {
            Self::List(items) => {
                let mut items = items.iter().enumerate();
                items.find_map(|(i, item)| within(item, || i.to_string()))
            }
            Self::Object(fields) => {
                let mut seen = HashSet::new();
                fields.iter().find_map(|(key, value)| {
                    if seen.insert(key) {
                        within(value, || key.clone())
                    } else {
                        Some(joined("", key))
                    }
                })
            }
            Self::Null | Self::Bool(_) | Self::Number(_) | Self::Text(_) => None,
        }
    }

    /// Name of its kind, for a sentence.
    pub fn kind(&self) -> String {
        match self {
            Self::Null => "null".to_owned(),
            Self::Bool(_) => "true or false".to_owned(),
            Self::Number(value) => format!("the number {}", plain(*value)),
            Self::Text(text) => format!("the text \"{}\"", shortened(text)),
            Self::List(_) => "a list".to_owned(),
            Self::Object(_) => "an object".to_owned(),
        }
    }
}

/// A step of a JSON pointer as it is written: the key with `~` and `/` escaped (RFC 6901).
pub fn escaped(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

/// The pointer to `key` in the object at `pointer`.
pub(super) fn joined(pointer: &str, key: &str) -> String {
    format!("{pointer}/{}", escaped(key))
}

/// The first characters of a text, for a message.
pub fn shortened(text: &str) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
        Ok(Node::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Node, E> {
        Ok(Node::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Node, E> {
        Ok(Node::Text(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Node, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element()? {
            list.push(item);
        }
        // Most have one item or two, and hundreds of thousands may stand beside each other.
        list.shrink_to_fit();
        Ok(Node::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Node, A::Error> {
        let mut fields = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            fields.push(entry);
        }
        fields.shrink_to_fit();
        Ok(Node::Object(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_that_stands_twice_is_refused_with_its_place() {
        let problem =
            Node::parse(br#"{"pair": {"driving": [{"x": 1, "x": 1}]}}"#).expect_err("twice");
        assert_eq!((problem.code, problem.status), (Code::MalformedJson, 400));
        assert_eq!(problem.errors[0].pointer, "/pair/driving/0/x");
    }

    #[test]
    fn broken_truncated_trailing_and_deep_json_is_malformed() {
        let deep = "[".repeat(100_000);
        for text in [
            "",
            "{",
            "{} {}",
            "nul",
            "{\"a\": 1e999}",
            "[1,]",
            "\u{feff}{}",
            &deep,
        ] {
            let problem = Node::parse(text.as_bytes()).expect_err("malformed");
            assert_eq!(problem.code, Code::MalformedJson, "{}", shortened(text));
        }
        assert!(Node::parse(b"\"\xff\"").is_err());
    }
}
