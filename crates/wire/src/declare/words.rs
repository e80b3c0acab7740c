//! Choices of one word, texts, and booleans.

use serde::Serializer;
use serde_json::{Value, json};

use super::reader::is_meant;
use super::{Kind, Location, Node, ObjectReader};
use crate::problem::Code;

/// Words that a field may take, each standing for a value.
pub trait Choice: Copy + PartialEq + 'static {
    /// Word, value and meaning of each.
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
        let words: Vec<_> = Self::OPTIONS.iter().map(|(word, ..)| *word).collect();
        words.join(", ")
    }
}

/// Declaration of a choice of words.
#[derive(Debug, Clone, Copy)]
pub struct OneWord<C> {
    title: &'static str,
    /// Default; `None` if it has to be given.
    pub preset: Option<C>,
}

/// One of several words, that has to be given.
pub const fn word<C>(title: &'static str) -> OneWord<C> {
    let preset = None;
    OneWord { title, preset }
}

impl<C: Copy> OneWord<C> {
    /// Not given, it is this.
    pub const fn or(self, preset: C) -> Self {
        let preset = Some(preset);
        Self { preset, ..self }
    }

    /// Reads one of the words.
    pub fn read(&self, node: &Node, place: &Location<'_>) -> Option<C>
    where
        C: Choice,
    {
        let Node::Text(word) = node else {
            return place.wrong_kind(node, &format!("one of {}", C::words()));
        };
        C::of_word(word).or_else(|| {
            let known: Vec<_> = C::OPTIONS.iter().map(|(word, ..)| *word).collect();
            let meant = is_meant(word, &known);
            let words = C::words();
            let detail = format!(
                "{place} is {}; expected is one of {words}.{meant}",
                node.kind()
            );
            place.wrong(Code::WrongType, detail, None)
        })
    }

    /// Value of the absent field `name`.
    pub fn absent(&self, reader: &mut ObjectReader<'_>, name: &'static str) -> Option<C>
    where
        C: Choice,
    {
        self.preset.or_else(|| {
            let place = reader.place_of(name);
            let detail = format!("{place} is needed: one of {}.", C::words());
            place.wrong(Code::MissingField, detail, None)
        })
    }

    /// Schema.
    pub fn describe(&self, about: &str) -> Value
    where
        C: Choice,
    {
        let meanings: Vec<_> = C::OPTIONS
            .iter()
            .map(|(word, _, meaning)| format!("`{word}`: {meaning}"))
            .collect();
        let words: Vec<_> = C::OPTIONS.iter().map(|(word, ..)| word).collect();
        let mut schema = json!({
            "type": "string",
            "title": self.title,
            "description": format!("{about} {}.", meanings.join("; ")),
            "enum": words,
        });
        if let Some(preset) = self.preset {
            schema["default"] = json!(preset.word());
        }
        schema
    }
}

/// Declares the words of a type and the meaning of each; the type itself, too, unless it is one of the engine.
#[macro_export]
macro_rules! words {
    (
        $(#[doc = $about:literal])*
        $visibility:vis enum $choice:ident {
            $($value:ident = $word:literal: $meaning:literal),* $(,)?
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visibility enum $choice {
            $(#[doc = $meaning] $value,)*
        }

        $crate::words! { $choice { $($value = $word: $meaning),* } }
    };

    ($($choice:ty { $($value:ident = $word:literal: $meaning:literal),* $(,)? })*) => {$(
        impl $crate::declare::Choice for $choice {
            const OPTIONS: &'static [(&'static str, Self, &'static str)] =
                &[$(($word, Self::$value, $meaning)),*];
        }

        impl $crate::declare::Kind for $choice {
            type Spec = $crate::declare::OneWord<Self>;

            fn read(
                node: &$crate::declare::Node,
                place: &$crate::declare::Location<'_>,
                spec: &Self::Spec,
            ) -> Option<Self> {
                spec.read(node, place)
            }

            fn absent(
                reader: &mut $crate::declare::ObjectReader<'_>,
                name: &'static str,
                spec: &Self::Spec,
            ) -> Option<Self> {
                spec.absent(reader, name)
            }

            fn usual(spec: &Self::Spec) -> Option<Self> {
                spec.preset
            }

            fn write<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str($crate::declare::Choice::word(*self))
            }

            fn describe(about: &str, spec: &Self::Spec) -> serde_json::Value {
                spec.describe(about)
            }
        }
    )*};
}

pub use words;

/// Declaration of a boolean.
#[derive(Debug, Clone, Copy)]
pub struct Flag {
    title: &'static str,
    preset: bool,
}

/// True or false; not given, `preset`.
pub const fn flag(title: &'static str, preset: bool) -> Flag {
    Flag { title, preset }
}

impl Kind for bool {
    type Spec = Flag;

    fn read(node: &Node, place: &Location<'_>, _: &Flag) -> Option<Self> {
        match node {
            Node::Bool(value) => Some(*value),
            _ => place.wrong_kind(node, "true or false"),
        }
    }

    fn usual(spec: &Flag) -> Option<Self> {
        Some(spec.preset)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bool(*self)
    }

    fn describe(about: &str, spec: &Flag) -> Value {
        json!({ "type": "boolean", "title": spec.title, "description": about, "default": spec.preset })
    }
}

/// Declaration of a short text.
#[derive(Debug, Clone, Copy)]
pub struct Text {
    title: &'static str,
    longest: usize,
}

/// A text of 1 to `longest` characters, none of them a control character.
pub const fn text(title: &'static str, longest: usize) -> Text {
    Text { title, longest }
}

impl Kind for String {
    type Spec = Text;
    const MANY: [&'static str; 2] = ["short strings", "strings"];

    fn read(node: &Node, place: &Location<'_>, spec: &Text) -> Option<Self> {
        let longest = spec.longest;
        match node {
            Node::Text(text) if is_short_text(text, longest) => Some(text.clone()),
            Node::Text(text) => {
                let detail = match text.chars().count() {
                    0 => format!("{place} is empty; it has to have 1 to {longest} characters."),
                    count if count > longest => {
                        format!("{place} has {count} characters; at most {longest} are taken.")
                    }
                    _ => format!("{place} has a control character, which is not taken."),
                };
                place.wrong(Code::OutOfRange, detail, None)
            }
            _ => place.wrong_kind(node, "a text"),
        }
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self)
    }

    fn describe(about: &str, spec: &Text) -> Value {
        let mut schema = json!({ "type": "string", "title": spec.title });
        if !about.is_empty() {
            schema["description"] = json!(about);
        }
        schema["minLength"] = json!(1);
        schema["maxLength"] = json!(spec.longest);
        schema
    }
}

/// True if a text has 1 to `longest` characters, none of them a control character.
pub fn is_short_text(text: &str, longest: usize) -> bool {
    (1..=longest).contains(&text.chars().count()) && !text.chars().any(char::is_control)
}
