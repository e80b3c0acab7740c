//! Content of a model: components with their attributes, relations between them, and load cases.

use std::cell::Cell;
use std::collections::{BTreeMap, HashSet};
use std::fmt::Write as _;

use super::fault::{Fault, Faults, cut};
use super::unit::Unit;

/// Limit of the characters of a type, an id, a unit, a role or a name. Those of the standard have at most half as many. Faults and the list of unread parts
/// repeat them.
const LONGEST_NAME: usize = 120;

/// The attributes by which a component says, since version 1.5, that its values are those of a component in another file.
const DATA_SOURCE: &str = "data_source";
const REFERENCED_COMPONENT: &str = "referenced_component_id";

/// Components with the attributes that they have in one load case, by their ids.
pub(super) type LoadCase = BTreeMap<i64, Component>;

/// A component of a gearbox with its attributes.
#[derive(Debug)]
pub(super) struct Component {
    pub(super) id: i64,
    pub(super) kind: String,
    name: String,
    pub(super) attributes: Vec<Attribute>,
    /// True if it belongs to the imported stage.
    pub(super) met: Cell<bool>,
    /// True if an attribute was asked for that it does not have here.
    pub(super) wanting: Cell<bool>,
}

/// One number, word or list.
#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) id: String,
    unit: Option<String>,
    /// The text; `None` where there is a list in its place.
    text: Option<String>,
    /// Its numbers, if it is a list of three.
    vector: Option<[f64; 3]>,
    pub(super) read: Cell<bool>,
}

/// How components belong together.
#[derive(Debug)]
pub(super) struct Relation {
    pub(super) kind: String,
    pub(super) order: i64,
    /// The role of each component in it.
    pub(super) refs: Vec<(String, i64)>,
}

/// Content of a file, not yet checked.
#[derive(Debug, Default)]
pub(super) struct Content {
    pub(super) components: Vec<Component>,
    pub(super) relations: Vec<Relation>,
    pub(super) load_cases: Vec<(i64, LoadCase)>,
    pub(super) faults: Faults,
}

impl Component {
    /// A component; its faults are added to `faults`.
    pub(super) fn new(
        id: i64,
        kind: String,
        name: String,
        attributes: Vec<Attribute>,
        faults: &mut Faults,
    ) -> Option<Self> {
        if faults.is_full() {
            return None;
        }
        let mut component = Self {
            id,
            kind: cut(kind, LONGEST_NAME),
            name: cut(name, LONGEST_NAME),
            attributes,
            met: Cell::new(false),
            wanting: Cell::new(false),
        };
        let mut seen = HashSet::new();
        for attribute in &component.attributes {
            if !seen.insert(&attribute.id) {
                let place = component.place_of(&attribute.id);
                faults.push(place, "It stands there twice.");
            }
            if faults.is_full() {
                return None;
            }
        }
        // An empty one says nothing.
        component
            .attributes
            .retain(|attribute| attribute.text.as_deref() != Some(""));
        Some(component)
    }

    /// The attribute, which is read by that.
    pub(super) fn attribute(&self, id: &str) -> Option<&Attribute> {
        let found = self.find(id)?;
        self.met.set(true);
        found.read.set(true);
        Some(found)
    }

    /// Clears the marks of the component.
    pub(super) fn begin(&self) {
        self.wanting.set(false);
    }

    /// The attribute, if there is one; else the component is wanting.
    fn find(&self, id: &str) -> Option<&Attribute> {
        let found = self.attributes.iter().find(|attribute| attribute.id == id);
        if found.is_none() {
            self.wanting.set(true);
        }
        found
    }

    /// A fault, if something was asked of the component that may stand in another file, where it says that its values are.
    pub(super) fn elsewhere(&self) -> Option<Fault> {
        let said = |id: &str| {
            let mut attributes = self.attributes.iter();
            attributes.find(|attribute| attribute.id == id)?.word().ok()
        };
        let (source, component) = (said(DATA_SOURCE), said(REFERENCED_COMPONENT));
        if !self.wanting.get() || source.or(component).is_none() {
            return None;
        }
        let short = |text: &str| text.chars().take(LONGEST_NAME).collect::<String>();
        let mut file = source.map_or_else(|| "a file without a name".to_owned(), short);
        if let Some(component) = component {
            let _ = write!(file, ", component {}", short(component));
        }
        let detail = format!(
            "Its values stand in another file, which is not read: {file}. Write them into the model."
        );
        Some(Fault::new(self.place(), detail))
    }

    /// The number of an attribute, if it is one, which is not read by that.
    pub(super) fn glance(&self, id: &str, unit: Unit) -> Option<f64> {
        self.find(id)?.number(unit).ok()
    }

    /// How a person finds it in the file.
    pub(super) fn place(&self) -> String {
        let mut place = format!("component {} ({}", self.id, self.kind);
        if !self.name.is_empty() {
            let short: String = self.name.chars().take(40).collect();
            let _ = write!(place, " \"{short}\"");
        }
        place.push(')');
        place
    }

    /// How a person finds one of its attributes.
    pub(super) fn place_of(&self, attribute: &str) -> String {
        format!("{}, {attribute}", self.place())
    }
}

impl Attribute {
    /// An attribute whose text is `text`; none is a list, of three numbers where it is a `vector`.
    pub(super) fn new(
        id: String,
        unit: Option<String>,
        text: Option<String>,
        vector: Option<[f64; 3]>,
    ) -> Self {
        Self {
            id: cut(id, LONGEST_NAME),
            unit: unit.map(|unit| cut(unit, LONGEST_NAME)),
            vector,
            text: text.map(|text| text.trim().to_owned()),
            read: Cell::new(false),
        }
    }

    /// Its number in `unit`.
    pub(super) fn number(&self, unit: Unit) -> Result<f64, String> {
        let text = self.word()?;
        let value = text.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| {
            let short: String = text.chars().take(40).collect();
            format!("It is \"{short}\"; a number is expected.")
        })?;
        unit.convert(value, self.unit.as_deref()).ok_or_else(|| {
            format!(
                "Its unit is \"{}\"; {} are known here.",
                self.unit.as_deref().unwrap_or_default(),
                unit.known()
            )
        })
    }

    /// Its three numbers in `unit`, if it is a list of so many.
    pub(super) fn vector(&self, unit: Unit) -> Option<[f64; 3]> {
        let numbers = self.vector?;
        let converted = numbers.map(|number| unit.convert(number, self.unit.as_deref()));
        let [Some(u), Some(v), Some(w)] = converted else {
            return None;
        };
        Some([u, v, w])
    }

    /// Its word.
    pub(super) fn word(&self) -> Result<&str, String> {
        let text = self.text.as_deref();
        text.ok_or_else(|| "It is a list; a single value is expected.".to_owned())
    }
}

impl Relation {
    /// A relation of components by their roles.
    pub(super) fn new(kind: String, order: i64, refs: impl Iterator<Item = (String, i64)>) -> Self {
        Self {
            kind: cut(kind, LONGEST_NAME),
            order,
            refs: refs
                .map(|(role, id)| (cut(role, LONGEST_NAME), id))
                .collect(),
        }
    }

    pub(super) fn has(&self, role: &str, id: i64) -> bool {
        self.refs.iter().any(|(has, of)| has == role && *of == id)
    }
}
