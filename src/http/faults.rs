//! Faults that the derived readers of serde meet, in the words of this service: the words of the library stay out of answers.

use meshwright_wire::declare::{escaped, is_meant, shortened};
use meshwright_wire::{Code, FieldError, Problem};

/// Kind of a fault.
#[derive(Debug, PartialEq)]
enum Fault<'a> {
    /// This field is absent.
    Missing(&'a str),
    /// This name is none of the known ones.
    Unknown(&'a str, Vec<&'a str>),
    /// This word is none of the known ones.
    NoneOf(&'a str, Vec<&'a str>),
    /// This name stands twice.
    Twice(&'a str),
    /// The value is of one type, another one is expected.
    Type(String, &'a str),
    /// Another fault, in words of our own readers.
    Other(&'a str),
}

impl<'a> Fault<'a> {
    /// Kind of the fault that serde words as `message`.
    fn of(message: &'a str) -> Self {
        let quoted = |text: &'a str| text.split('`').skip(1).step_by(2).collect();
        // A name that was sent may have any characters; those that follow it are ours.
        let among = |start: &str| {
            let rest = message.strip_prefix(start)?.strip_prefix(" `")?;
            let (given, known) = rest.rsplit_once("`, expected ")?;
            Some((given, quoted(known)))
        };
        let named = |start: &str| message.strip_prefix(start)?.strip_suffix('`');
        if let Some((given, known)) = among("unknown field") {
            return Self::Unknown(given, known);
        }
        if let Some((given, known)) = among("unknown variant") {
            return Self::NoneOf(given, known);
        }
        if let Some(name) = named("missing field `") {
            return Self::Missing(name);
        }
        if let Some(name) = named("duplicate field `") {
            return Self::Twice(name);
        }
        let types = message.strip_prefix("invalid type: ");
        match types.and_then(|types| types.rsplit_once(", expected ")) {
            Some((given, expected)) => Self::Type(kind(given), expected),
            None => Self::Other(message),
        }
    }
}

/// Words for a value that serde calls `given`.
fn kind(given: &str) -> String {
    let value = given.split_once(' ').map_or("", |(_, value)| value);
    let value = shortened(value.trim_matches('`'));
    match given.split([' ', ':']).next().unwrap_or_default() {
        "map" => "an object".to_owned(),
        "sequence" => "a list".to_owned(),
        "null" | "unit" => "null".to_owned(),
        "boolean" => "true or false".to_owned(),
        "string" => format!("the text {value}"),
        _ => format!("the number {}", value.trim_start_matches("point `")),
    }
}

/// Our word for a type that serde expects.
fn expected(kind: &str) -> &str {
    match kind {
        "a string" => "a text",
        "a sequence" => "a list",
        "a boolean" => "true or false",
        _ if kind.starts_with("struct ") || kind == "a map" => "an object",
        other => other,
    }
}

/// Asks whether the known name nearest to `given` is meant, if one is near, and lists them all.
fn known_names(given: &str, known: &[&str]) -> String {
    let meant = is_meant(given, known);
    format!("{meant} Known are {}.", known.join(", "))
}

/// The problem of a document whose object at `place` has the fault that serde words as `message`.
pub(super) fn of_document(place: &str, message: &str) -> Problem {
    let whole = if place.is_empty() {
        "The document"
    } else {
        place
    };
    let (pointer, code, detail) = match Fault::of(message) {
        Fault::Missing(name) => {
            let pointer = format!("{place}/{}", escaped(name));
            let detail = format!("{pointer} is needed.");
            (pointer, Code::MissingField, detail)
        }
        Fault::Unknown(given, known) => {
            let names = known_names(given, &known);
            let detail = format!("{} is not a field here.{names}", shortened(place));
            (shortened(place), Code::UnknownField, detail)
        }
        Fault::NoneOf(given, known) => {
            let given = shortened(given);
            let known = known.join(", ");
            let detail = format!("{whole} is the text {given:?}; expected is one of {known}.");
            (place.to_owned(), Code::WrongType, detail)
        }
        Fault::Twice(name) => {
            let detail = format!("The key at {place}/{name} stands twice in its object.");
            (format!("{place}/{name}"), Code::MalformedJson, detail)
        }
        Fault::Type(given, wanted) => {
            let detail = format!("{whole} is {given}; {} is expected.", expected(wanted));
            (place.to_owned(), Code::WrongType, detail)
        }
        Fault::Other(message) => {
            let detail = format!("{whole} is not understood: {}.", shortened(message));
            (place.to_owned(), Code::WrongType, detail)
        }
    };
    Problem::of_fields(vec![FieldError::new(pointer, code, detail)])
}

/// The problem of a document whose first byte that is no space is `first`, and no object begins so; absent if one does.
pub(super) fn of_whole_document(first: u8) -> Option<Problem> {
    let given = match first {
        b'{' => return None,
        b'[' => "a list",
        b'"' => "a text",
        b'n' => "null",
        b't' | b'f' => "true or false",
        _ => "a number",
    };
    let detail = format!("The document is {given}; an object is expected.");
    Some(Problem::of_fields(vec![FieldError::new(
        "",
        Code::WrongType,
        detail,
    )]))
}

/// What is wrong with the parameters of a query: the fault that serde words as `message` at the parameter `name`, whose value is `given`.
pub(super) fn of_parameter(name: &str, message: &str, given: Option<&str>) -> String {
    let value = format!("{:?}", shortened(given.unwrap_or_default()));
    match Fault::of(message) {
        Fault::Missing(name) => format!("The parameter {name} is needed."),
        Fault::NoneOf(_, known) => {
            let known = known.join(", ");
            format!("{name} is {value}; expected is one of {known}.")
        }
        Fault::Twice(name) => format!("The parameter {name} stands twice."),
        Fault::Other("provided string was not `true` or `false`") => {
            format!("{name} is {value}; expected is one of true, false.")
        }
        Fault::Unknown(..) | Fault::Type(..) | Fault::Other(_) => format!("{name}: {message}"),
    }
}

/// What is wrong with a query that has the parameter `given` where `known` ones are taken.
pub(super) fn of_unknown_parameter(given: &str, known: &[String]) -> String {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let names = match known[..] {
        [] => " None is taken.".to_owned(),
        _ => known_names(given, &known),
    };
    format!("{} is not a parameter here.{names}", shortened(given))
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Side {
        Left,
        Right,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "the faults of its reader are what is looked at")]
    struct Sheet {
        name: String,
        sides: Option<Vec<Side>>,
    }

    /// The sentence about a document that no [`Sheet`] can be read of, and the pointer and code.
    fn fault(text: &str) -> (String, Code, String) {
        let mut json = serde_json::Deserializer::from_str(text);
        let error = serde_path_to_error::deserialize::<_, Sheet>(&mut json).unwrap_err();
        let problem = crate::http::body::fault_of(&error);
        let error = &problem.errors[0];
        (error.pointer.clone(), error.code, error.detail.clone())
    }

    #[test]
    fn faults_are_said_without_the_words_of_the_library() {
        for (text, pointer, code, detail) in [
            (r#"{}"#, "/name", Code::MissingField, "/name is needed."),
            (
                r#"{"nane": 1}"#,
                "/nane",
                Code::UnknownField,
                "/nane is not a field here. Is name meant? Known are name, sides.",
            ),
            (
                r#"{"a`, expected `b": 1}"#,
                "/a`, expected `b",
                Code::UnknownField,
                "/a`, expected `b is not a field here. Known are name, sides.",
            ),
            (
                r#"{"name": 5}"#,
                "/name",
                Code::WrongType,
                "/name is the number 5; a text is expected.",
            ),
            (
                r#"{"name": 5.5}"#,
                "/name",
                Code::WrongType,
                "/name is the number 5.5; a text is expected.",
            ),
            (
                r#"{"name": {}}"#,
                "/name",
                Code::WrongType,
                "/name is an object; a text is expected.",
            ),
            (
                r#"{"name": "a", "sides": "left"}"#,
                "/sides",
                Code::WrongType,
                "/sides is the text \"left\"; a list is expected.",
            ),
            (
                r#"{"name": "a", "sides": ["left", "top"]}"#,
                "/sides/1",
                Code::WrongType,
                "/sides/1 is the text \"top\"; expected is one of left, right.",
            ),
            (
                r#"{"name": "a", "name": "b"}"#,
                "/name",
                Code::MalformedJson,
                "The key at /name stands twice in its object.",
            ),
        ] {
            assert_eq!(
                fault(text),
                (pointer.to_owned(), code, detail.to_owned()),
                "{text}"
            );
        }
    }
}
