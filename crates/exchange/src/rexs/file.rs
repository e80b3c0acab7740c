//! A model as its file has it: components, relations and load cases, nothing understood yet.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use roxmltree::{Document, Node, ParsingOptions};

use super::container::{decoded, of_file, unpacked};
use super::content::{Attribute, Component, Content, LoadCase, Relation};
use super::fault::{Faults, Refused};
use super::{json, markup};

/// The largest file that is read. Whole gearboxes with their results have a few megabytes.
const MOST_BYTES: usize = 32 << 20;

/// The most nodes of its tree, which bounds the memory: some 100 bytes each. A file of four megabytes, which is
/// large for a gearbox, has up to this many where every one is an attribute.
const MOST_NODES: u32 = 300_000;

/// The most load cases of a file, which is far more than a submission has torques.
const MOST_LOAD_CASES: usize = 1000;

/// The main versions whose names are read.
const VERSIONS: RangeInclusive<u32> = 1..=2;

/// A whole model.
#[derive(Debug)]
pub(super) struct Model {
    /// The main version, and the one after it.
    pub(super) version: (u32, u32),
    pub(super) components: Vec<Component>,
    pub(super) relations: Vec<Relation>,
    /// Values of each load case, after its identifier.
    pub(super) load_cases: Vec<(i64, LoadCase)>,
    /// Where each component stands, by its id.
    index: HashMap<i64, usize>,
}

impl Model {
    /// Reads a file in any of its containers. Its size is bounded, and document types are refused, so that there are no entities to
    /// expand or to fetch.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Refused> {
        let bytes = unpacked(bytes, MOST_BYTES)?;
        let text = decoded(&bytes).map_err(of_file)?;
        let read = if text.trim_start().starts_with('{') {
            json::content(&text)
        } else {
            content(&text)
        };
        let (version, content) = read.map_err(of_file)?;
        let version = version_of(&version).map_err(of_file)?;
        Self::of(content, version)
    }

    fn of(content: Content, version: (u32, u32)) -> Result<Self, Refused> {
        let Content {
            components,
            relations,
            mut load_cases,
            mut faults,
        } = content;
        if load_cases.len() > MOST_LOAD_CASES {
            let cases = load_cases.len();
            let detail =
                format!("There are {cases} load cases; at most {MOST_LOAD_CASES} are read.");
            faults.push("the load spectrum", detail);
        }
        let mut index = HashMap::new();
        for (i, component) in components.iter().enumerate() {
            if index.insert(component.id, i).is_some() {
                let detail = "Another component has the same id; relations could mean either.";
                faults.push(component.place(), detail);
            }
            if faults.is_full() {
                break;
            }
        }
        let in_cases = load_cases
            .iter_mut()
            .flat_map(|(_, case)| case.values_mut());
        for component in in_cases.filter(|component| component.kind.is_empty()) {
            if let Some(same) = index.get(&component.id) {
                component.kind.clone_from(&components[*same].kind);
            }
        }
        for relation in &relations {
            for (role, id) in &relation.refs {
                if !index.contains_key(id) && !faults.is_full() {
                    let place = format!("relation of type {}, role {role}", relation.kind);
                    let detail = format!("There is no component {id}.");
                    faults.push(place, detail);
                }
            }
        }
        if faults.is_empty() {
            Ok(Self {
                version,
                components,
                relations,
                load_cases,
                index,
            })
        } else {
            Err(faults.into())
        }
    }

    /// Every component of a kind.
    pub(super) fn of_kind<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Component> {
        self.components
            .iter()
            .filter(move |component| component.kind == kind)
    }

    /// Marks of the reading so far: of each component whether it was met, and whether each of its attributes was read.
    pub(super) fn read_marks(&self) -> Vec<bool> {
        let of = |component: &Component| {
            let attributes = component.attributes.iter().map(|it| it.read.get());
            std::iter::once(component.met.get())
                .chain(attributes)
                .collect::<Vec<_>>()
        };
        self.components.iter().flat_map(of).collect()
    }

    /// The same; and nothing has been read afterwards.
    pub(super) fn take_read_marks(&self) -> Vec<bool> {
        let marks = self.read_marks();
        let in_cases = self.load_cases.iter().flat_map(|(_, case)| case.values());
        for component in self.components.iter().chain(in_cases) {
            component.met.set(false);
            component
                .attributes
                .iter()
                .for_each(|it| it.read.set(false));
        }
        marks
    }

    /// Components with the role `wanted` in the relations of a kind in which `known` has its role, in their order.
    pub(super) fn related<'a>(
        &'a self,
        kind: &str,
        known: (&str, &Component),
        wanted: &str,
    ) -> Vec<&'a Component> {
        // The component that it belongs to may stand in the file of its values.
        known.1.wanting.set(true);
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

/// The main version and the next, if the names of `version` are known here.
fn version_of(version: &str) -> Result<(u32, u32), String> {
    let mut parts = version.split('.').map(|part| part.trim().parse().ok());
    let said = parts.next().flatten().zip(parts.next().unwrap_or(Some(0)));
    said.filter(|(main, _)| VERSIONS.contains(main))
        .ok_or_else(|| format!("It is of REXS version \"{version}\"; 1.0 to 2 are read."))
}

/// The model in the text of an XML file, and its version.
///
/// # Errors
///
/// A sentence, if it is no XML of a model.
fn content(text: &str) -> Result<(String, Content), String> {
    markup::check(text)?;
    let options = ParsingOptions {
        allow_dtd: false,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options)
        .map_err(|error| format!("It cannot be read as XML: {error}."))?;
    let root = document.root_element();
    if root.tag_name().name() != "model" {
        return Err(format!(
            "It begins with <{}>; a REXS model begins with <model>.",
            root.tag_name().name()
        ));
    }
    let all = |name: &'static str| root.children().filter(move |node| is(*node, name));
    let inner = |outer: &'static str, name: &'static str| {
        all(outer).flat_map(move |node| node.children().filter(move |node| is(*node, name)))
    };
    let mut faults = Faults::default();
    let mut read = |node: Node<'_, '_>| Component::of(node, &mut faults);
    let components = inner("components", "component")
        .filter_map(&mut read)
        .collect();
    let load_cases = inner("load_spectrum", "load_case")
        .map(|case| {
            let components = case.children().filter(|node| is(*node, "component"));
            let components = components.filter_map(&mut read);
            let components = components.map(|component| (component.id, component));
            (
                whole_number(case, "id").unwrap_or_default(),
                components.collect(),
            )
        })
        .collect();
    let content = Content {
        components,
        relations: inner("relations", "relation").map(Relation::of).collect(),
        load_cases,
        faults,
    };
    let version = root.attribute("version").unwrap_or_default();
    Ok((version.to_owned(), content))
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
    /// Reads a component; its faults are added to `faults`.
    fn of(node: Node<'_, '_>, faults: &mut Faults) -> Option<Self> {
        if faults.is_full() {
            return None;
        }
        let id = whole_number(node, "id");
        let Some((id, kind)) = id.zip(node.attribute("type")) else {
            let detail = "A component needs a type, and a whole number as its id.";
            faults.push(at_line(node), detail);
            return None;
        };
        let name = node.attribute("name").unwrap_or_default();
        let attributes = node.children().filter(|node| is(*node, "attribute"));
        let attributes = attributes.map(Attribute::of).collect();
        Self::new(id, kind.to_owned(), name.to_owned(), attributes, faults)
    }
}

impl Attribute {
    fn of(node: Node<'_, '_>) -> Self {
        let list = node.children().find(|child| child.is_element());
        let text: String = node.children().filter_map(|child| child.text()).collect();
        let cells = list.into_iter().flat_map(|list| list.children());
        let cells = cells.filter(|cell| is(*cell, "c"));
        let numbers = cells.take(4).map(|cell| cell.text()?.trim().parse().ok());
        let numbers: Option<Vec<f64>> = numbers.collect();
        Self::new(
            node.attribute("id").unwrap_or_default().to_owned(),
            node.attribute("unit").map(str::to_owned),
            list.is_none().then_some(text),
            numbers.and_then(|numbers| numbers.try_into().ok()),
        )
    }
}

impl Relation {
    fn of(node: Node<'_, '_>) -> Self {
        let refs = node.children().filter(|child| is(*child, "ref"));
        let refs = refs.map(|child| {
            let role = child.attribute("role").unwrap_or_default();
            (role.to_owned(), whole_number(child, "id").unwrap_or(-1))
        });
        let kind = node.attribute("type").unwrap_or_default().to_owned();
        Self::new(kind, whole_number(node, "order").unwrap_or_default(), refs)
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
