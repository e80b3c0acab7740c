//! One object of a document, read field by field.

use std::fmt;

use super::errors::Errors;
use super::node::{Node, joined, shortened};
use crate::problem::{Code, FieldError};

/// A place in a document, with the list of faults.
#[derive(Debug, Clone)]
pub struct Location<'a> {
    /// The JSON pointer to it.
    pub pointer: String,
    errors: &'a Errors,
}

impl<'a> Location<'a> {
    /// The whole document.
    pub fn root(errors: &'a Errors) -> Self {
        Self {
            pointer: String::new(),
            errors,
        }
    }

    /// Place of the field or item `step`.
    pub fn of(&self, step: &str) -> Self {
        Self {
            pointer: joined(&self.pointer, step),
            errors: self.errors,
        }
    }

    /// Reports a fault here, and returns no value of whatever kind.
    pub fn wrong<T>(
        &self,
        code: Code,
        detail: impl Into<String>,
        nearest: Option<f64>,
    ) -> Option<T> {
        let error = FieldError::new(&*self.pointer, code, detail);
        self.errors.push(error.nearest(nearest));
        None
    }

    /// Reports that something else than `node` was expected here.
    pub fn wrong_kind<T>(&self, node: &Node, expected: &str) -> Option<T> {
        let detail = format!("{self} is {}; expected is {expected}.", node.kind());
        self.wrong(Code::WrongType, detail, None)
    }
}

/// A place as a sentence names it.
impl fmt::Display for Location<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.pointer.is_empty() {
            "The document"
        } else {
            &self.pointer
        })
    }
}

/// One object of the document, and which of its fields have been asked for.
///
/// Every method reports faults and then returns `None`. Reading goes on, so that all errors are reported together. Unknown fields are refused when the reading
/// is [`finished`](ObjectReader::finish).
pub struct ObjectReader<'a> {
    place: Location<'a>,
    fields: &'a [(String, Node)],
    known: Vec<&'static str>,
    /// The numbers that were read so far, those that were filled in among them.
    numbers: Vec<(&'static str, f64)>,
    /// The fields that were refused because another one stands in their place.
    refused: Vec<&'static str>,
}

impl<'a> ObjectReader<'a> {
    /// Reads `node` as an object.
    pub fn new(node: &'a Node, place: Location<'a>) -> Option<Self> {
        let Node::Object(fields) = node else {
            let detail = format!("{place} is {}; an object is expected.", node.kind());
            return place.wrong(Code::WrongType, detail, None);
        };
        Some(Self {
            place,
            fields,
            known: Vec::new(),
            numbers: Vec::new(),
            refused: Vec::new(),
        })
    }

    /// Where its field `name` stands.
    pub fn place_of(&self, name: &str) -> Location<'a> {
        self.place.of(name)
    }

    /// The field `name`, if it is there.
    pub fn get(&mut self, name: &'static str) -> Option<&'a Node> {
        if !self.known.contains(&name) {
            self.known.push(name);
        }
        let mut fields = self.fields.iter();
        fields.find(|(key, _)| key == name).map(|(_, node)| node)
    }

    /// The field `name`, if it is there and not null.
    pub fn present(&mut self, name: &'static str) -> Option<&'a Node> {
        self.get(name).filter(|node| **node != Node::Null)
    }

    /// Remembers a number that was read or filled in.
    pub fn note(&mut self, name: &'static str, value: f64) {
        self.numbers.push((name, value));
    }

    /// A number that was read or filled in before.
    pub fn number(&self, name: &str) -> Option<f64> {
        let mut numbers = self.numbers.iter();
        numbers
            .find(|(known, _)| *known == name)
            .map(|(_, value)| *value)
    }

    /// The text of the field `name`, if it is one.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        let mut fields = self.fields.iter();
        match fields.find(|(key, _)| key == name) {
            Some((_, Node::Text(text))) => Some(text),
            _ => None,
        }
    }

    /// Reports that the field `name` is needed.
    pub fn missing<T>(&mut self, name: &'static str) -> Option<T> {
        let place = self.place_of(name);
        place.wrong(Code::MissingField, format!("{place} is needed."), None)
    }

    /// Reports that one of these fields is needed and none is there.
    pub fn missing_one_of<T>(&mut self, names: &[&'static str]) -> Option<T> {
        // One fault covers all of them.
        self.refused.extend(names);
        let names = names.join(", ");
        let detail = format!("{} needs one of {names}; it has none.", self.place);
        self.place.wrong(Code::MissingField, detail, None)
    }

    /// Refuses two fields of which one stands in place of the other.
    pub fn refuse_both(&mut self, one: &'static str, other: &'static str) {
        let both = self.present(one).is_some() && self.present(other).is_some();
        if both && !self.refused.contains(&other) && !self.refused.contains(&one) {
            self.refused.push(other);
            let place = self.place_of(other);
            let detail = format!("{place} stands beside {one}; only one of them can be given.");
            place.wrong::<()>(Code::ConflictingFields, detail, None);
        }
    }

    /// True if the field was refused because another one stands in its place.
    pub fn is_refused(&self, name: &str) -> bool {
        self.refused.contains(&name)
    }

    /// Reports that the object is of no kind that there is.
    pub fn refuse_kind<T>(&mut self, node: Option<&Node>, kinds: &[&str]) -> Option<T> {
        let (place, kinds) = (self.place_of("kind"), kinds.join(", "));
        // Which fields belong here is not known, so none is reported as unknown.
        self.fields = &[];
        match node {
            Some(node) => place.wrong_kind(node, &format!("one of {kinds}")),
            None => {
                let detail = format!("{place} is needed: one of {kinds}.");
                place.wrong(Code::MissingField, detail, None)
            }
        }
    }

    /// Refuses the fields that nobody asked for.
    pub fn finish(self) {
        for (key, _) in self.fields {
            // A document of nothing but unknown fields would be compared with the known ones for seconds.
            if self.place.errors.is_full() {
                return;
            }
            if !self.known.contains(&key.as_str()) {
                let meant = is_meant(key, &self.known);
                let detail = format!(
                    "{} is not a field here.{meant} Known are {}.",
                    shortened(&joined(&self.place.pointer, key)),
                    self.known.join(", "),
                );
                self.place
                    .of(&shortened(key))
                    .wrong::<()>(Code::UnknownField, detail, None);
            }
        }
    }
}

/// Question whether the known word nearest to `word` is meant, as it follows a sentence; empty if none is near.
pub fn is_meant(word: &str, known: &[&str]) -> String {
    nearest_word(word, known).map_or_else(String::new, |word| format!(" Is {word} meant?"))
}

/// The known word that takes the fewest edits, capitals aside, if they are few: a third of its letters, and half of those of each of its parts. Of a name with
/// dots, as `mass_kg.driving`, a piece between them will do.
pub(crate) fn nearest_word<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    if word.len() > 60 {
        return None;
    }
    let word = word.to_lowercase();
    let pieces = known.iter().flat_map(|&name| {
        let pieces = name.split('.').filter(move |piece| *piece != name);
        std::iter::once(name)
            .chain(pieces)
            .map(move |piece| (piece.to_lowercase(), name))
    });
    let near = pieces.map(|(piece, name)| (strsim::osa_distance(&word, &piece), piece, name));
    let (edits, piece, name) = near.min_by_key(|(edits, ..)| *edits)?;
    (edits * 3 <= piece.len() && has_near_parts(&word, &piece)).then_some(name)
}

/// False where two names have as many parts and two of them have little in common: another word before the same ones is another name.
fn has_near_parts(word: &str, other: &str) -> bool {
    let mut parts = word.split('_').zip(other.split('_'));
    word.matches('_').count() != other.matches('_').count()
        || parts.all(|(one, other)| strsim::osa_distance(one, other) * 2 <= other.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelled_field_is_answered_with_the_one_that_is_meant() {
        assert_eq!(
            nearest_word("tooth_cuont", &["module_mm", "tooth_count"]),
            Some("tooth_count")
        );
        assert_eq!(nearest_word("color", &["module_mm", "tooth_count"]), None);
        assert_eq!(
            nearest_word("bore_diameter_mm", &["root_diameter_mm"]),
            None
        );
    }

    #[test]
    fn a_piece_of_a_name_with_dots_is_answered_with_the_first_name_that_has_it() {
        let known = ["mass_kg.driving", "mass_kg.driven", "error_um.peak_to_peak"];
        assert_eq!(nearest_word("mass_gk", &known), Some("mass_kg.driving"));
        assert_eq!(
            nearest_word("peak_to_peek_um", &known),
            Some("error_um.peak_to_peak")
        );
        assert_eq!(nearest_word("stiffness", &known), None);
    }
}
