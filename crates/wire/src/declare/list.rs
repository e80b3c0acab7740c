//! Lists of values of one kind.

use serde::Serializer;
use serde::ser::SerializeSeq;
use serde_json::{Value, json};

use super::{Kind, Location, Named, Node, Written};
use crate::problem::Code;

/// Declaration of a list.
#[derive(Debug, Clone, Copy)]
pub struct List<S> {
    title: &'static str,
    each: S,
    most: usize,
    /// Name of its items in the expectation and in the count, and the use of those that fit.
    said: Option<[&'static str; 3]>,
    /// How too many items are refused.
    too_many: Code,
    /// Code and advice for an empty list; `None` if it may be empty.
    empty: Option<(Code, &'static str)>,
    /// Sentence about an item that stands there twice; `None` if it may.
    repeated: Option<&'static str>,
    /// True if an absent list is empty.
    or_empty: bool,
    /// True if null counts as absent.
    or_null: bool,
}

/// A list of at most so many values, that has to be given.
pub const fn list<S>(title: &'static str, each: S, most: usize) -> List<S> {
    List {
        title,
        each,
        most,
        said: None,
        too_many: Code::TooLarge,
        empty: None,
        repeated: None,
        or_empty: false,
        or_null: false,
    }
}

impl<S: Copy> List<S> {
    /// Declares the name of its items in the expectation and in the count, and the use of those that fit.
    pub const fn of(
        self,
        expected: &'static str,
        counted: &'static str,
        fit: &'static str,
    ) -> Self {
        let said = Some([expected, counted, fit]);
        Self { said, ..self }
    }

    /// Too many items are refused with this code.
    pub const fn too_many_is(self, too_many: Code) -> Self {
        Self { too_many, ..self }
    }

    /// Refuses an empty list.
    pub const fn not_empty(self, code: Code, advice: &'static str) -> Self {
        let empty = Some((code, advice));
        Self { empty, ..self }
    }

    /// Each item stands there once.
    pub const fn unique(self, said: &'static str) -> Self {
        let repeated = Some(said);
        Self { repeated, ..self }
    }

    /// Absent, it is empty.
    pub const fn or_empty(self) -> Self {
        let or_empty = true;
        Self { or_empty, ..self }
    }

    /// Null is as good as absent.
    pub const fn or_null(self) -> Self {
        let or_null = true;
        Self { or_null, ..self }
    }
}

impl<T: Kind + PartialEq> Kind for Vec<T> {
    type Spec = List<T::Spec>;

    fn read(node: &Node, place: &Location<'_>, spec: &Self::Spec) -> Option<Self> {
        let [expected, counted] = T::MANY;
        let [expected, counted, fit] = spec.said.unwrap_or([expected, counted, "fit"]);
        let Node::List(nodes) = node else {
            return place.wrong_kind(node, &format!("a list of {expected}"));
        };
        let (count, most) = (nodes.len(), spec.most);
        if let (0, Some((code, advice))) = (count, spec.empty) {
            let nearest = (code == Code::WrongLength).then_some(1.0);
            return place.wrong(code, format!("{place} is empty; {advice}."), nearest);
        }
        if count > most {
            let detail = format!("{place} has {count} {counted}; at most {most} {fit}.");
            return place.wrong(spec.too_many, detail, Some(most as f64));
        }
        // All of them are looked at, so that all that are wrong are reported.
        let read: Vec<Option<T>> = nodes
            .iter()
            .enumerate()
            .map(|(i, node)| T::read(node, &place.of(&i.to_string()), &spec.each))
            .collect();
        if let Some(said) = spec.repeated {
            for (i, item) in read.iter().enumerate() {
                if item.is_some() && read[..i].contains(item) {
                    let place = place.of(&i.to_string());
                    place.wrong::<()>(Code::OutOfRange, format!("{place} {said}."), None);
                }
            }
        }
        read.into_iter().collect()
    }

    fn takes_null(spec: &Self::Spec) -> bool {
        spec.or_null
    }

    fn usual(spec: &Self::Spec) -> Option<Self> {
        spec.or_empty.then(Self::new)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.len()))?;
        for item in self {
            list.serialize_element(&Written(item))?;
        }
        list.end()
    }

    fn describe(about: &str, spec: &Self::Spec) -> Value {
        let items = T::describe("", &spec.each);
        let mut schema = json!({ "type": "array" });
        if spec.or_null {
            schema["type"] = json!(["array", "null"]);
        }
        if !spec.title.is_empty() {
            schema["title"] = json!(spec.title);
        }
        schema["description"] = match items["x-unit"].as_str() {
            Some(unit) => json!(format!("{about} Unit: {unit}.")),
            None => json!(about),
        };
        if spec.or_empty {
            schema["default"] = json!([]);
        }
        if let Some(unit) = items.get("x-unit") {
            schema["x-unit"] = unit.clone();
        }
        schema["items"] = items;
        if spec.most < usize::MAX {
            schema["minItems"] = json!(usize::from(spec.empty.is_some()));
            schema["maxItems"] = json!(spec.most);
        }
        if spec.repeated.is_some() {
            schema["uniqueItems"] = json!(true);
        }
        schema
    }

    fn name_parts(named: &mut Named) {
        T::name_parts(named);
    }
}
