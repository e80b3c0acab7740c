//! One object of a document, read field by field.

use super::choice::Choice;
use super::errors::Errors;
use super::node::{Node, joined, shortened};
use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{Preset, Quantity};

/// One object of the document, and which of its fields have been asked for.
///
/// Every method reports what is wrong and answers `None` then; reading goes on, so that all errors are told together.
/// What nobody asked for is refused when the reading is [`finished`](ObjectReader::finish).
pub(in crate::wire) struct ObjectReader<'a> {
    pointer: String,
    fields: &'a [(String, Node)],
    known: Vec<&'static str>,
    errors: &'a Errors,
}

impl<'a> ObjectReader<'a> {
    /// Reads `node` as an object.
    pub(in crate::wire) fn new(
        node: &'a Node,
        pointer: String,
        errors: &'a Errors,
    ) -> Option<Self> {
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

    pub(in crate::wire) fn pointer_to(&self, name: &str) -> String {
        joined(&self.pointer, name)
    }

    fn wrong(&self, name: &str, code: Code, detail: String, nearest: Option<f64>) {
        self.errors
            .push(FieldError::new(self.pointer_to(name), code, detail).nearest(nearest));
    }

    /// The field `name`, if it is there.
    pub(in crate::wire) fn get(&mut self, name: &'static str) -> Option<&'a Node> {
        if !self.known.contains(&name) {
            self.known.push(name);
        }
        self.fields
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, node)| node)
    }

    /// The field `name`, if it is there and not null.
    pub(in crate::wire) fn present(&mut self, name: &'static str) -> Option<&'a Node> {
        self.get(name).filter(|node| **node != Node::Null)
    }

    /// The field `name`, which has no default.
    pub(in crate::wire) fn needed(&mut self, name: &'static str) -> Option<&'a Node> {
        let node = self.get(name);
        if node.is_none() {
            let detail = format!("{} is needed.", place(&self.pointer_to(name)));
            self.wrong(name, Code::MissingField, detail, None);
        }
        node
    }

    /// Reads `node`, which stands at `pointer`, as an object with the same list of errors.
    pub(in crate::wire) fn object<'b>(
        &self,
        node: &'b Node,
        pointer: String,
    ) -> Option<ObjectReader<'b>>
    where
        'a: 'b,
    {
        ObjectReader::new(node, pointer, self.errors)
    }

    /// The object `name`, which has no default.
    pub(in crate::wire) fn needed_object(
        &mut self,
        name: &'static str,
    ) -> Option<ObjectReader<'a>> {
        let node = self.needed(name)?;
        ObjectReader::new(node, self.pointer_to(name), self.errors)
    }

    /// A number with its bounds; absent, its default, which may be so many times `module`.
    pub(in crate::wire) fn number(
        &mut self,
        quantity: &Quantity,
        module: Option<f64>,
    ) -> Option<f64> {
        let Some(node) = self.get(quantity.name) else {
            if let Preset::Needed | Preset::Absent(_) = quantity.preset {
                let detail = format!("{} is needed.", place(&self.pointer_to(quantity.name)));
                self.wrong(quantity.name, Code::MissingField, detail, None);
            }
            return quantity.preset_for(module);
        };
        self.checked_number(node, &self.pointer_to(quantity.name), quantity)
    }

    /// A number that has to be given here, whatever its quantity says, and is not null.
    pub(in crate::wire) fn given_number(&mut self, quantity: &Quantity) -> Option<f64> {
        match self.present(quantity.name) {
            Some(node) => self.checked_number(node, &self.pointer_to(quantity.name), quantity),
            None => {
                let detail = format!("{} is needed.", place(&self.pointer_to(quantity.name)));
                self.wrong(quantity.name, Code::MissingField, detail, None);
                None
            }
        }
    }

    /// A number that may be absent or null.
    pub(in crate::wire) fn optional_number(&mut self, quantity: &Quantity) -> Option<Option<f64>> {
        match self.present(quantity.name) {
            None => Some(None),
            Some(node) => self
                .checked_number(node, &self.pointer_to(quantity.name), quantity)
                .map(Some),
        }
    }

    /// A list of at most so many numbers, each within the bounds of `quantity`, that may be absent or null.
    pub(in crate::wire) fn optional_numbers(
        &mut self,
        quantity: &Quantity,
        most: usize,
    ) -> Option<Option<Vec<f64>>> {
        match self.present(quantity.name) {
            None => Some(None),
            Some(node) => self.numbers_of(node, quantity, most).map(Some),
        }
    }

    /// A list of at most so many numbers, each within the bounds of `quantity`, that has to be given.
    pub(in crate::wire) fn needed_numbers(
        &mut self,
        quantity: &Quantity,
        most: usize,
    ) -> Option<Vec<f64>> {
        let node = self.needed(quantity.name)?;
        self.numbers_of(node, quantity, most)
    }

    fn numbers_of(&self, node: &Node, quantity: &Quantity, most: usize) -> Option<Vec<f64>> {
        let Node::List(items) = node else {
            self.wrong_kind(quantity.name, node, "a list of numbers");
            return None;
        };
        let pointer = self.pointer_to(quantity.name);
        if items.len() > most {
            let detail = format!("{pointer} has {} numbers; at most {most} fit.", items.len());
            let error = FieldError::new(pointer, Code::TooLarge, detail);
            self.errors.push(error.nearest(most as f64));
            return None;
        }
        // All of them are looked at, so that all that are wrong are told.
        let numbers: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| self.checked_number(item, &format!("{pointer}/{i}"), quantity))
            .collect();
        numbers.into_iter().collect()
    }

    /// Reads the items of the list `name` as objects; absent or null, none of them.
    pub(in crate::wire) fn objects(
        &mut self,
        name: &'static str,
        most: usize,
    ) -> Option<Vec<ObjectReader<'a>>> {
        let items = match self.present(name) {
            None => return Some(Vec::new()),
            Some(Node::List(items)) => items,
            Some(node) => {
                self.wrong_kind(name, node, "a list of objects");
                return None;
            }
        };
        let pointer = self.pointer_to(name);
        if items.len() > most {
            let detail = format!("{pointer} has {} items; at most {most} fit.", items.len());
            let error = FieldError::new(pointer, Code::TooLarge, detail);
            self.errors.push(error.nearest(most as f64));
            return None;
        }
        let readers: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| ObjectReader::new(item, format!("{pointer}/{i}"), self.errors))
            .collect();
        readers.into_iter().collect()
    }

    /// Reports that one of these fields is needed and none is there.
    pub(in crate::wire) fn missing_one_of(&self, names: &[&str]) {
        let here = place(&self.pointer);
        let detail = format!("{here} needs one of {}; it has none.", names.join(", "));
        let error = FieldError::new(&*self.pointer, Code::MissingField, detail);
        self.errors.push(error);
    }

    /// Refuses two fields of which one stands in place of the other, and says whether both are there.
    pub(in crate::wire) fn conflict(&mut self, one: &'static str, other: &'static str) -> bool {
        let both = self.present(one).is_some() && self.present(other).is_some();
        if both {
            let detail = format!(
                "{} stands beside {one}; only one of them can be given.",
                self.pointer_to(other)
            );
            self.wrong(other, Code::ConflictingFields, detail, None);
        }
        both
    }

    /// `node` as a number within the bounds of `quantity`.
    pub(in crate::wire) fn checked_number(
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
    pub(in crate::wire) fn count(&mut self, quantity: &Quantity) -> Option<u32> {
        self.number(quantity, None).map(|value| value as u32)
    }

    /// A word; absent, its default.
    pub(in crate::wire) fn choice<C: Choice>(
        &mut self,
        name: &'static str,
        preset: Option<C>,
    ) -> Option<C> {
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
    pub(in crate::wire) fn flag(&mut self, name: &'static str, preset: bool) -> Option<bool> {
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
    pub(in crate::wire) fn wrong_kind(&self, name: &str, node: &Node, expected: &str) {
        let detail = format!(
            "{} is {}; expected is {expected}.",
            place(&self.pointer_to(name)),
            node.kind()
        );
        self.wrong(name, Code::WrongType, detail, None);
    }

    /// Reports `error`.
    pub(in crate::wire) fn report(&self, error: FieldError) {
        self.errors.push(error);
    }

    /// Reads the field `name` as an object if it is there and not null.
    pub(in crate::wire) fn optional_object(&mut self, name: &'static str) -> OptionalObject<'a> {
        match self.present(name) {
            None => OptionalObject::Absent,
            Some(node) => match ObjectReader::new(node, self.pointer_to(name), self.errors) {
                Some(reader) => OptionalObject::Present(reader),
                None => OptionalObject::Wrong,
            },
        }
    }

    /// Refuses the fields that nobody asked for.
    pub(in crate::wire) fn finish(self) {
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
pub(in crate::wire) enum OptionalObject<'a> {
    Absent,
    Wrong,
    Present(ObjectReader<'a>),
}

/// A pointer as a sentence names it.
pub(in crate::wire) fn place(pointer: &str) -> &str {
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
    fn a_misspelled_field_is_answered_with_the_one_that_is_meant() {
        assert_eq!(
            nearest_word("tooth_cuont", &["module_mm", "tooth_count"]),
            Some("tooth_count")
        );
        assert_eq!(nearest_word("color", &["module_mm", "tooth_count"]), None);
    }
}
