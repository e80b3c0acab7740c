//! JSON as it was sent, read field by field so that every error names its place.

use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

use super::problem::{Code, FieldError, Problem};
use super::quantity::{Preset, Quantity};
use super::units::plain;

/// Errors beyond this number are not told; a document with so many is not a slip.
const MOST_ERRORS: usize = 50;

/// A JSON value. Unlike `serde_json::Value` it keeps keys that stand twice, so that they can be refused.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    Object(Vec<(String, Node)>),
}

impl Node {
    /// Reads one JSON document.
    ///
    /// # Errors
    ///
    /// `malformed_json` for a syntax error, for deep nesting and for a key that stands twice in one object.
    pub(super) fn parse(document: &[u8]) -> Result<Self, Problem> {
        let node: Self = serde_json::from_slice(document).map_err(|error| {
            Problem::new(
                Code::MalformedJson,
                format!("The JSON ends or breaks: {error}."),
            )
        })?;
        match node.key_that_stands_twice("") {
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
    pub(super) fn of(value: &serde_json::Value) -> Self {
        use serde_json::Value;
        match value {
            Value::Null => Self::Null,
            Value::Bool(value) => Self::Bool(*value),
            // Every number of JSON that was read has a nearest double.
            Value::Number(number) => Self::Number(number.as_f64().unwrap_or(f64::NAN)),
            Value::String(text) => Self::Text(text.clone()),
            Value::Array(items) => Self::List(items.iter().map(Self::of).collect()),
            Value::Object(fields) => {
                let fields = fields.iter();
                Self::Object(
                    fields
                        .map(|(key, value)| (key.clone(), Self::of(value)))
                        .collect(),
                )
            }
        }
    }

    /// The value of one of its fields, if it is an object with it.
    pub(super) fn into_field(self, name: &str) -> Option<Self> {
        let Self::Object(fields) = self else {
            return None;
        };
        let mut fields = fields.into_iter();
        fields.find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// A text that equal values have in common, and others have not.
    pub(super) fn key(&self) -> String {
        format!("{self:?}")
    }

    /// The pointer to a key that stands twice in its object, below `pointer`.
    fn key_that_stands_twice(&self, pointer: &str) -> Option<String> {
        let steps = self.steps_to_double_key()?;
        // Found from the inside, so the outermost step came last.
        let steps = steps.iter().rev();
        Some(steps.fold(pointer.to_owned(), |pointer, step| joined(&pointer, step)))
    }

    fn steps_to_double_key(&self) -> Option<Vec<String>> {
        let with = |step: String, steps: Option<Vec<String>>| {
            let mut steps = steps?;
            steps.push(step);
            Some(steps)
        };
        match self {
            Self::List(items) => items
                .iter()
                .enumerate()
                .find_map(|(i, item)| with(i.to_string(), Some(item.steps_to_double_key()?))),
            Self::Object(fields) => {
                let mut seen = HashSet::new();
                fields.iter().find_map(|(key, value)| {
                    if seen.insert(key) {
                        with(key.clone(), Some(value.steps_to_double_key()?))
                    } else {
                        Some(vec![key.clone()])
                    }
                })
            }
            Self::Null | Self::Bool(_) | Self::Number(_) | Self::Text(_) => None,
        }
    }

    /// What it is, for a sentence.
    fn kind(&self) -> String {
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

/// A JSON pointer's next step (RFC 6901).
pub(super) fn joined(pointer: &str, key: &str) -> String {
    format!("{pointer}/{}", key.replace('~', "~0").replace('/', "~1"))
}

fn shortened(text: &str) -> String {
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
        Ok(Node::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Node, A::Error> {
        let mut fields = Vec::new();
        while let Some(entry) = entries.next_entry()? {
            fields.push(entry);
        }
        Ok(Node::Object(fields))
    }
}

/// The errors found so far, with a bound on their number.
#[derive(Debug, Default)]
pub(super) struct Errors(RefCell<Vec<FieldError>>);

impl Errors {
    pub(super) fn push(&self, error: FieldError) {
        let mut errors = self.0.borrow_mut();
        if errors.len() < MOST_ERRORS {
            errors.push(error);
        }
    }

    pub(super) fn count(&self) -> usize {
        self.0.borrow().len()
    }

    /// Whether no more are told.
    fn is_full(&self) -> bool {
        self.count() >= MOST_ERRORS
    }

    pub(super) fn into_errors(self) -> Vec<FieldError> {
        self.0.into_inner()
    }

    pub(super) fn into_problem(self) -> Problem {
        Problem::of_fields(self.into_errors())
    }
}

/// Words that a field may take, each standing for a value.
pub(super) trait Choice: Copy + PartialEq + 'static {
    /// Word, value, and what it means.
    const OPTIONS: &'static [(&'static str, Self, &'static str)];

    /// The word for this value.
    fn word(self) -> &'static str {
        Self::OPTIONS
            .iter()
            .find(|(_, value, _)| *value == self)
            .map_or("", |(word, ..)| word)
    }

    /// The value that `word` stands for.
    fn of_word(word: &str) -> Option<Self> {
        Self::OPTIONS
            .iter()
            .find(|(option, ..)| *option == word)
            .map(|(_, value, _)| *value)
    }

    /// All words, for a sentence.
    fn words() -> String {
        Self::OPTIONS
            .iter()
            .map(|(word, ..)| *word)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// Writes a choice as its word.
pub(super) fn as_word<C: Choice, S: serde::Serializer>(
    choice: &C,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(choice.word())
}

/// One object of the document, and which of its fields have been asked for.
///
/// Every method reports what is wrong and answers `None` then; reading goes on, so that all errors are told together.
/// What nobody asked for is refused when the reading is [`finished`](ObjectReader::finish).
pub(super) struct ObjectReader<'a> {
    pointer: String,
    fields: &'a [(String, Node)],
    known: Vec<&'static str>,
    errors: &'a Errors,
}

impl<'a> ObjectReader<'a> {
    /// Reads `node` as an object.
    pub(super) fn new(node: &'a Node, pointer: String, errors: &'a Errors) -> Option<Self> {
        let Node::Object(fields) = node else {
            errors.push(FieldError::new(
                &*pointer,
                Code::WrongType,
                format!(
                    "{} is {}; an object is expected.",
                    place(&pointer),
                    node.kind()
                ),
            ));
            return None;
        };
        Some(Self {
            pointer,
            fields,
            known: Vec::new(),
            errors,
        })
    }

    pub(super) fn pointer_to(&self, name: &str) -> String {
        joined(&self.pointer, name)
    }

    fn wrong(&self, name: &str, code: Code, detail: String, nearest: Option<f64>) {
        self.errors
            .push(FieldError::new(self.pointer_to(name), code, detail).nearest(nearest));
    }

    /// The field `name`, if it is there.
    pub(super) fn get(&mut self, name: &'static str) -> Option<&'a Node> {
        self.known.push(name);
        self.fields
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, node)| node)
    }

    /// The field `name`, if it is there and not null.
    pub(super) fn present(&mut self, name: &'static str) -> Option<&'a Node> {
        self.get(name).filter(|node| **node != Node::Null)
    }

    /// The field `name`, which has no default.
    pub(super) fn needed(&mut self, name: &'static str) -> Option<&'a Node> {
        let node = self.get(name);
        if node.is_none() {
            let detail = format!("{} is needed.", place(&self.pointer_to(name)));
            self.wrong(name, Code::MissingField, detail, None);
        }
        node
    }

    /// Reads `node`, which stands at `pointer`, as an object with the same list of errors.
    pub(super) fn object<'b>(&self, node: &'b Node, pointer: String) -> Option<ObjectReader<'b>>
    where
        'a: 'b,
    {
        ObjectReader::new(node, pointer, self.errors)
    }

    /// The object `name`, which has no default.
    pub(super) fn needed_object(&mut self, name: &'static str) -> Option<ObjectReader<'a>> {
        let node = self.needed(name)?;
        ObjectReader::new(node, self.pointer_to(name), self.errors)
    }

    /// A number with its bounds; absent, its default, which may be so many times `module`.
    pub(super) fn number(&mut self, quantity: &Quantity, module: Option<f64>) -> Option<f64> {
        let Some(node) = self.get(quantity.name) else {
            return match quantity.preset {
                Preset::Value(value) => Some(value),
                Preset::Modules(modules) => {
                    module.map(|module| super::units::significant(modules * module, 12))
                }
                Preset::Needed | Preset::Absent(_) => {
                    let detail = format!("{} is needed.", place(&self.pointer_to(quantity.name)));
                    self.wrong(quantity.name, Code::MissingField, detail, None);
                    None
                }
            };
        };
        self.checked_number(node, &self.pointer_to(quantity.name), quantity)
    }

    /// A number that may be absent or null.
    pub(super) fn optional_number(&mut self, quantity: &Quantity) -> Option<Option<f64>> {
        match self.present(quantity.name) {
            None => Some(None),
            Some(node) => self
                .checked_number(node, &self.pointer_to(quantity.name), quantity)
                .map(Some),
        }
    }

    /// `node` as a number within the bounds of `quantity`.
    pub(super) fn checked_number(
        &self,
        node: &Node,
        pointer: &str,
        quantity: &Quantity,
    ) -> Option<f64> {
        let Node::Number(value) = node else {
            let detail = format!(
                "{} is {}; a number is expected.",
                place(pointer),
                node.kind()
            );
            self.errors
                .push(FieldError::new(pointer, Code::WrongType, detail));
            return None;
        };
        match quantity.check(*value, place(pointer)) {
            Ok(value) => Some(value),
            Err((code, detail, nearest)) => {
                self.errors
                    .push(FieldError::new(pointer, code, detail).nearest(nearest));
                None
            }
        }
    }

    /// A whole number with its bounds.
    pub(super) fn count(&mut self, quantity: &Quantity) -> Option<u32> {
        self.number(quantity, None).map(|value| value as u32)
    }

    /// A word; absent, its default.
    pub(super) fn choice<C: Choice>(&mut self, name: &'static str, preset: Option<C>) -> Option<C> {
        let node = match (self.get(name), preset) {
            (Some(node), _) => node,
            (None, Some(preset)) => return Some(preset),
            (None, None) => {
                let detail = format!(
                    "{} is needed: one of {}.",
                    place(&self.pointer_to(name)),
                    C::words()
                );
                self.wrong(name, Code::MissingField, detail, None);
                return None;
            }
        };
        if let Node::Text(word) = node
            && let Some(choice) = C::of_word(word)
        {
            return Some(choice);
        }
        self.wrong_kind(name, node, &format!("one of {}", C::words()));
        None
    }

    /// True or false; absent, `preset`.
    pub(super) fn flag(&mut self, name: &'static str, preset: bool) -> Option<bool> {
        match self.get(name) {
            None => Some(preset),
            Some(Node::Bool(value)) => Some(*value),
            Some(node) => {
                self.wrong_kind(name, node, "true or false");
                None
            }
        }
    }

    /// Reports that the field `name` is not what was expected.
    pub(super) fn wrong_kind(&self, name: &str, node: &Node, expected: &str) {
        let detail = format!(
            "{} is {}; expected is {expected}.",
            place(&self.pointer_to(name)),
            node.kind()
        );
        self.wrong(name, Code::WrongType, detail, None);
    }

    /// Reports `error`.
    pub(super) fn report(&self, error: FieldError) {
        self.errors.push(error);
    }

    /// Reads the field `name` as an object if it is there and not null.
    pub(super) fn optional_object(&mut self, name: &'static str) -> OptionalObject<'a> {
        match self.present(name) {
            None => OptionalObject::Absent,
            Some(node) => match ObjectReader::new(node, self.pointer_to(name), self.errors) {
                Some(reader) => OptionalObject::Present(reader),
                None => OptionalObject::Wrong,
            },
        }
    }

    /// Refuses the fields that nobody asked for.
    pub(super) fn finish(self) {
        for (key, _) in self.fields {
            // A document of nothing but unknown fields would be compared with the known ones for seconds.
            if self.errors.is_full() {
                return;
            }
            if !self.known.contains(&key.as_str()) {
                let meant = nearest_word(key, &self.known)
                    .map_or_else(String::new, |word| format!(" Is {word} meant?"));
                let detail = format!(
                    "{} is not a field here.{meant} Known are {}.",
                    shortened(&joined(&self.pointer, key)),
                    self.known.join(", "),
                );
                self.errors.push(FieldError::new(
                    joined(&self.pointer, &shortened(key)),
                    Code::UnknownField,
                    detail,
                ));
            }
        }
    }
}

/// An object that need not be there.
pub(super) enum OptionalObject<'a> {
    Absent,
    Wrong,
    Present(ObjectReader<'a>),
}

/// A pointer as a sentence names it.
pub(super) fn place(pointer: &str) -> &str {
    if pointer.is_empty() {
        "The document"
    } else {
        pointer
    }
}

/// The known word that takes the fewest edits, if they are few.
fn nearest_word(word: &str, known: &[&'static str]) -> Option<&'static str> {
    if word.len() > 60 {
        return None;
    }
    known
        .iter()
        .map(|&other| (strsim::levenshtein(word, other), other))
        .min()
        .filter(|(edits, other)| *edits * 3 <= other.len())
        .map(|(_, other)| other)
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

    #[test]
    fn a_misspelled_field_is_answered_with_the_one_that_is_meant() {
        assert_eq!(
            nearest_word("tooth_cuont", &["module_mm", "tooth_count"]),
            Some("tooth_count")
        );
        assert_eq!(nearest_word("color", &["module_mm", "tooth_count"]), None);
    }
}
