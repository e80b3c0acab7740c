//! A model as its file has it: components, relations and load cases, nothing understood yet.

use std::cell::Cell;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt::Write as _;

use roxmltree::{Document, Node, ParsingOptions};

use super::fault::{Fault, Refused};
use super::markup;
use super::unit::Unit;

pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// The largest file that is read. Whole gearboxes with their results have a few megabytes.
const MOST_BYTES: usize = 32 << 20;

/// The most nodes of its tree, which bounds the memory: some 100 bytes each. A file of four megabytes, which is
/// large for a gearbox, has up to this many where every one is an attribute.
const MOST_NODES: u32 = 300_000;

/// The most load cases of a file, which is far more than a submission has torques.
const MOST_LOAD_CASES: usize = 1000;

/// Faults beyond this number are not looked for: each says its line, which is counted from the top.
const MOST_FAULTS: usize = 100;

/// The first version whose names are read, and the last main version.
const VERSIONS: ((u32, u32), u32) = ((1, 4), 2);

/// A whole model.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) components: Vec<Component>,
    pub(super) relations: Vec<Relation>,
    /// What is different in each load case, after its identifier.
    pub(super) load_cases: Vec<(i64, LoadCase)>,
    /// Where each component stands, by its id.
    index: HashMap<i64, usize>,
}

/// Components with the attributes that they have in one load case, by their ids.
pub(super) type LoadCase = BTreeMap<i64, Component>;

/// Something of a gearbox, and what is said of it.
#[derive(Debug)]
pub(super) struct Component {
    pub(super) id: i64,
    pub(super) kind: String,
    name: String,
    pub(super) attributes: Vec<Attribute>,
    /// Whether it belongs to what is imported.
    pub(super) met: Cell<bool>,
}

/// One number, word or list.
#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) id: String,
    unit: Option<String>,
    /// The text; `None` where there is a list in its place.
    text: Option<String>,
    pub(super) read: Cell<bool>,
}

/// How components belong together.
#[derive(Debug)]
pub(super) struct Relation {
    pub(super) kind: String,
    pub(super) order: i64,
    /// The role of each component in it.
    refs: Vec<(String, i64)>,
}

impl Model {
    /// Reads a file. Its size is bounded, and document types are refused, so that there are no entities to expand or to fetch.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Refused> {
        let whole = |detail: String| Refused::from(Fault::new("the file", detail));
        if bytes.len() > MOST_BYTES {
            return Err(whole(format!(
                "It has {} bytes; at most {MOST_BYTES} are read.",
                bytes.len()
            )));
        }
        let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        let text = std::str::from_utf8(bytes).map_err(|error| {
            whole(format!(
                "It is no UTF-8 after byte {}, which REXS has to be.",
                error.valid_up_to()
            ))
        })?;
        markup::check(text).map_err(whole)?;
        let options = ParsingOptions {
            allow_dtd: false,
            nodes_limit: MOST_NODES,
            ..ParsingOptions::default()
        };
        let document = Document::parse_with_options(text, options)
            .map_err(|error| whole(format!("It cannot be read as XML: {error}.")))?;
        let root = document.root_element();
        if root.tag_name().name() != "model" {
            return Err(whole(format!(
                "It begins with <{}>; a REXS model begins with <model>.",
                root.tag_name().name()
            )));
        }
        check_version(root.attribute("version").unwrap_or_default()).map_err(whole)?;
        Self::of(root)
    }

    fn of(root: Node<'_, '_>) -> Result<Self, Refused> {
        let all = |name: &'static str| root.children().filter(move |node| is(*node, name));
        let inner = |outer: &'static str, name: &'static str| {
            all(outer).flat_map(move |node| node.children().filter(move |node| is(*node, name)))
        };
        let mut faults = Vec::new();
        let components: Vec<Component> = inner("components", "component")
            .filter_map(|node| Component::of(node, &mut faults))
            .collect();
        let cases = inner("load_spectrum", "load_case").count();
        if cases > MOST_LOAD_CASES {
            let detail =
                format!("There are {cases} load cases; at most {MOST_LOAD_CASES} are read.");
            faults.push(Fault::new("the load spectrum", detail));
        }
        let load_cases = inner("load_spectrum", "load_case")
            .take(MOST_LOAD_CASES)
            .map(|case| {
                let id = whole_number(case, "id").unwrap_or_default();
                let components = case.children().filter(|node| is(*node, "component"));
                let read = components.filter_map(|node| Component::of(node, &mut faults));
                (
                    id,
                    read.map(|component| (component.id, component)).collect(),
                )
            })
            .collect();
        let mut index = HashMap::new();
        for (i, component) in components.iter().enumerate() {
            if index.insert(component.id, i).is_some() {
                let detail = "Another component has the same id; relations could mean either.";
                faults.push(Fault::new(component.place(), detail));
            }
        }
        let relations: Vec<Relation> = inner("relations", "relation").map(Relation::of).collect();
        for relation in &relations {
            for (role, id) in &relation.refs {
                if !index.contains_key(id) {
                    let place = format!("relation of type {}, role {role}", relation.kind);
                    let detail = format!("There is no component {id}.");
                    faults.push(Fault::new(place, detail));
                }
            }
        }
        if faults.is_empty() {
            Ok(Self {
                components,
                relations,
                load_cases,
                index,
            })
        } else {
            Err(Refused(faults))
        }
    }

    /// Every component of a kind.
    pub(super) fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Component> {
        self.components
            .iter()
            .filter(move |component| component.kind == kind)
    }

    /// What stands as `wanted` in the relations of a kind in which `known` has its role, in their order.
    pub(super) fn related<'a>(
        &'a self,
        kind: &str,
        known: (&str, &Component),
        wanted: &str,
    ) -> Vec<&'a Component> {
        let mut relations: Vec<&Relation> = self
            .relations
            .iter()
            .filter(|relation| relation.kind == kind && relation.has(known.0, known.1.id))
            .collect();
        relations.sort_by_key(|relation| relation.order);
        relations
            .into_iter()
            .filter_map(|relation| self.in_role(relation, wanted))
            .collect()
    }

    /// The component that has a role in `relation`.
    pub(super) fn in_role(&self, relation: &Relation, role: &str) -> Option<&Component> {
        let (_, id) = relation.refs.iter().find(|(has, _)| has == role)?;
        self.components.get(*self.index.get(id)?)
    }
}

/// That the names of `version` are known here.
fn check_version(version: &str) -> Result<(), String> {
    let mut parts = version.split('.').map(|part| part.parse::<u32>().ok());
    let said = parts.next().flatten().zip(parts.next().unwrap_or(Some(0)));
    match said {
        Some(said) if (VERSIONS.0..=(VERSIONS.1, u32::MAX)).contains(&said) => Ok(()),
        _ => Err(format!(
            "It is of REXS version \"{version}\"; 1.4 to 2 are read. Earlier ones arrange flanks otherwise."
        )),
    }
}

/// Elements are known by their names, in the namespace of the standard or in none.
fn is(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

fn whole_number(node: Node<'_, '_>, name: &str) -> Option<i64> {
    node.attribute(name)?.trim().parse().ok()
}

fn at_line(node: Node<'_, '_>) -> String {
    let at = node.document().text_pos_at(node.range().start);
    format!("line {}", at.row)
}

impl Component {
    /// Reads a component; what is wrong with it is added to `faults`.
    fn of(node: Node<'_, '_>, faults: &mut Vec<Fault>) -> Option<Self> {
        if faults.len() >= MOST_FAULTS {
            return None;
        }
        let id = whole_number(node, "id");
        let Some((id, kind)) = id.zip(node.attribute("type")) else {
            let detail = "A component needs a type, and a whole number as its id.";
            faults.push(Fault::new(at_line(node), detail));
            return None;
        };
        let mut component = Self {
            id,
            kind: kind.to_owned(),
            name: node.attribute("name").unwrap_or_default().to_owned(),
            attributes: Vec::new(),
            met: Cell::new(false),
        };
        let mut seen = HashSet::new();
        for child in node.children().filter(|node| is(*node, "attribute")) {
            let attribute = Attribute::of(child);
            if !seen.insert(attribute.id.clone()) {
                let place = component.place_of(&attribute.id);
                faults.push(Fault::new(place, "It stands there twice."));
            }
            component.attributes.push(attribute);
        }
        Some(component)
    }

    /// The attribute, which is read by that.
    pub(super) fn attribute(&self, id: &str) -> Option<&Attribute> {
        let found = self
            .attributes
            .iter()
            .find(|attribute| attribute.id == id)?;
        self.met.set(true);
        found.read.set(true);
        Some(found)
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
    fn of(node: Node<'_, '_>) -> Self {
        let list = node.children().any(|child| child.is_element());
        let text: String = node.children().filter_map(|child| child.text()).collect();
        Self {
            id: node.attribute("id").unwrap_or_default().to_owned(),
            unit: node.attribute("unit").map(str::to_owned),
            text: (!list).then(|| text.trim().to_owned()),
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

    /// Its word.
    pub(super) fn word(&self) -> Result<&str, String> {
        let text = self.text.as_deref();
        text.ok_or_else(|| "It is a list; a single value is expected.".to_owned())
    }
}

impl Relation {
    fn of(node: Node<'_, '_>) -> Self {
        let refs = node.children().filter(|child| is(*child, "ref"));
        Self {
            kind: node.attribute("type").unwrap_or_default().to_owned(),
            order: whole_number(node, "order").unwrap_or_default(),
            refs: refs
                .map(|child| {
                    let role = child.attribute("role").unwrap_or_default();
                    (role.to_owned(), whole_number(child, "id").unwrap_or(-1))
                })
                .collect(),
        }
    }

    pub(super) fn has(&self, role: &str, id: i64) -> bool {
        self.refs.iter().any(|(has, of)| has == role && *of == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_nothing_but_nodes_is_refused_before_they_are_memory() {
        let nodes = "<a/>".repeat(MOST_NODES as usize);
        let text = format!("<model version='1.4'>{nodes}</model>");
        let told = Model::read(text.as_bytes()).unwrap_err().to_string();
        assert!(told.contains("nodes"), "{told}");
    }
}
