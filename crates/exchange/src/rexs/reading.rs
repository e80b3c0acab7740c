//! The reading of a model: marks of its attributes, and remarks.

use std::cell::RefCell;

use serde_json::Value;

use super::content::Component;
use super::fault::{Faults, cut};
use super::file::Model;
use super::unit::Unit;

/// The most remarks on a pair of one kind, and the most characters of each.
pub(super) const MOST_REMARKS: usize = 100;
const LONGEST_REMARK: usize = 1000;

/// Choices of the caller where a model leaves them open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Choices {
    /// The id of the cylindrical stage, where there are several.
    pub stage: Option<i64>,
    /// Output torques in N m, instead of those of the model.
    pub torques: Vec<f64>,
    /// The method, instead of the flexible one or that of the model.
    pub method: Option<String>,
    /// The bore radii in mm of the driving and of the driven gear, or one for both, instead of those of the model.
    pub bore_radii: Vec<f64>,
    /// The flanks that are loaded, instead of those that the model says: of both gears, because left flanks touch left ones.
    pub flank: Option<LoadedFlank>,
}

/// A side of the teeth of both gears, as a model calls it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadedFlank {
    /// The flanks in the role `left`.
    Left,
    /// The flanks in the role `right`.
    Right,
}

impl LoadedFlank {
    /// The side that a word names.
    pub fn named(word: &str) -> Option<Self> {
        match word {
            "left" => Some(Self::Left),
            "right" => Some(Self::Right),
            _ => None,
        }
    }
}

/// The reading of a model. Every method reports faults and then returns `None`, so that all faults are reported together.
pub(super) struct Reading<'a> {
    pub(super) model: &'a Model,
    pub(super) choices: &'a Choices,
    pub(super) faults: RefCell<Faults>,
    pub(super) remarks: RefCell<Vec<String>>,
    pub(super) origins: RefCell<Vec<(String, String)>>,
}

impl<'a> Reading<'a> {
    pub(super) fn wrong(&self, place: String, detail: impl Into<String>) {
        // Components of both flanks are read for each, and noted once.
        self.faults.borrow_mut().push(place, detail);
    }

    pub(super) fn remark(&self, sentence: String) {
        let sentence = cut(sentence, LONGEST_REMARK);
        let mut remarks = self.remarks.borrow_mut();
        if remarks.len() < MOST_REMARKS && !remarks.contains(&sentence) {
            remarks.push(sentence);
        }
    }

    /// That the field at `pointer` is from this attribute.
    pub(super) fn from(&self, pointer: String, component: &Component, attribute: &str) {
        let place = component.place_of(attribute);
        self.origins.borrow_mut().push((pointer, place));
    }

    /// The number of an attribute, if it is there.
    pub(super) fn number(&self, of: &Component, attribute: &str, unit: Unit) -> Option<f64> {
        let read = of.attribute(attribute)?.number(unit);
        read.map_err(|detail| self.wrong(of.place_of(attribute), detail))
            .ok()
    }

    /// The number of an attribute of either name.
    pub(super) fn either(
        &self,
        of: &Component,
        attributes: [(&'static str, f64); 2],
        units: [Unit; 2],
    ) -> Option<(f64, &'static str)> {
        let read = |i: usize| {
            let (name, factor) = attributes[i];
            Some((self.number(of, name, units[i])? * factor, name))
        };
        let (first, second) = (read(0), read(1));
        first.or(second)
    }

    /// The word of an attribute, if it is there and not empty.
    pub(super) fn word(&self, of: &'a Component, attribute: &str) -> Option<&'a str> {
        let read = of.attribute(attribute)?.word();
        let word = read.map_err(|detail| self.wrong(of.place_of(attribute), detail));
        word.ok().filter(|word| !word.is_empty())
    }

    /// True if one of several words is chosen. A program writes `false` where none was chosen.
    pub(super) fn is_chosen(&self, of: &'a Component, attribute: &str) -> bool {
        !matches!(self.word(of, attribute), None | Some("false"))
    }

    /// One of the words that an attribute may have here.
    pub(super) fn choice(
        &self,
        of: &'a Component,
        attribute: &str,
        words: &[&str],
    ) -> Option<&'a str> {
        let word = self.word(of, attribute)?;
        if words.contains(&word) {
            return Some(word);
        }
        if !self.is_chosen(of, attribute) {
            return None;
        }
        let short: String = word.chars().take(40).collect();
        let detail = format!("It is \"{short}\"; known here: {}.", words.join(", "));
        self.wrong(of.place_of(attribute), detail);
        None
    }

    /// That the model does not say this of a component.
    pub(super) fn assumed(&self, of: &Component, attribute: &str, taken: &str) {
        let place = of.place();
        self.remark(format!(
            "Assumed: {place} has no {attribute}; taken is {taken}."
        ));
    }

    /// The JSON of an attribute that only we write.
    pub(super) fn json(&self, of: &'a Component, attribute: &str) -> Option<Value> {
        let text = self.word(of, attribute)?;
        let read = serde_json::from_str(text);
        read.map_err(|error| {
            let detail = format!("It is not the JSON of a submission: {error}.");
            self.wrong(of.place_of(attribute), detail);
        })
        .ok()
    }
}
