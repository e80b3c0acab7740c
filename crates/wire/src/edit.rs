//! Changing a document in place and back again, so that thousands of variants of it cost no copy.

use super::declare::Node;

/// The inverse of a change.
#[derive(Debug)]
pub enum Undo {
    /// This stood there.
    Restore(Node),
    /// The last field of the object was not there.
    RemoveLast,
    /// The change lies below the field or item of this number.
    Below(usize, Box<Undo>),
}

impl Node {
    /// The value behind `steps`, if there is one.
    pub fn at(&self, steps: &[&str]) -> Option<&Self> {
        steps.iter().try_fold(self, |here, step| match here {
            Self::Object(fields) => fields
                .iter()
                .find(|(key, _)| key == step)
                .map(|(_, value)| value),
            Self::List(items) => items.get(step.parse::<usize>().ok()?),
            _ => None,
        })
    }

    /// The number behind `steps`, if there is one.
    pub fn number_at(&self, steps: &[&str]) -> Option<f64> {
        match self.at(steps)? {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// Puts `value` behind `steps`. Objects on the way that are absent or null are made, lists are not. `None`, and nothing is
    /// changed, if something on the way is no object, or a list without this place.
    pub fn put<S: AsRef<str>>(&mut self, steps: &[S], value: Self) -> Option<Undo> {
        let Some((step, rest)) = steps.split_first() else {
            return Some(Undo::Restore(std::mem::replace(self, value)));
        };
        let step = step.as_ref();
        match self {
            Self::Null if rest.iter().any(is_item) || is_item(&step) => None,
            Self::Null => {
                let made = Self::Object(vec![(step.to_owned(), within(rest, value))]);
                Some(Undo::Restore(std::mem::replace(self, made)))
            }
            Self::Object(fields) => match fields.iter().position(|(key, _)| key == step) {
                Some(i) => below(i, fields[i].1.put(rest, value)),
                None if is_item(&step) || rest.iter().any(is_item) => None,
                None => {
                    fields.push((step.to_owned(), within(rest, value)));
                    Some(Undo::RemoveLast)
                }
            },
            Self::List(items) => {
                let i = step.parse::<usize>().ok()?;
                below(i, items.get_mut(i)?.put(rest, value))
            }
            _ => None,
        }
    }

    /// Takes a change back. Later changes have to be taken back before.
    pub fn undo(&mut self, undo: Undo) {
        match (self, undo) {
            (here, Undo::Restore(value)) => *here = value,
            (Self::Object(fields), Undo::RemoveLast) => {
                fields.pop();
            }
            (Self::Object(fields), Undo::Below(i, undo)) => fields[i].1.undo(*undo),
            (Self::List(items), Undo::Below(i, undo)) => items[i].undo(*undo),
            (_, Undo::RemoveLast | Undo::Below(..)) => {
                unreachable!("what has fields keeps them until the change is taken back")
            }
        }
    }
}

/// True if a step names an item of a list: no field of a submission is a number.
fn is_item<S: AsRef<str>>(step: &S) -> bool {
    step.as_ref().bytes().all(|byte| byte.is_ascii_digit())
}

fn below(i: usize, undo: Option<Undo>) -> Option<Undo> {
    Some(Undo::Below(i, Box::new(undo?)))
}

/// `value` in as many objects as there are steps to it.
fn within<S: AsRef<str>>(steps: &[S], value: Node) -> Node {
    steps.iter().rev().fold(value, |inner, step| {
        Node::Object(vec![(step.as_ref().to_owned(), inner)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(text: &str) -> Node {
        Node::parse(text.as_bytes()).unwrap()
    }

    #[test]
    fn a_value_is_put_where_it_belongs_and_absent_objects_are_made() {
        let before = node(r#"{"pair": {"driven": {"holes": null}}, "torques": [1]}"#);
        let mut document = before.clone();
        let mut undo = Vec::new();
        for (steps, value) in [
            (&["pair", "driven", "holes", "count"][..], "8"),
            (&["torques", "0"], "2"),
            (&["speed", "rpm"], "600"),
        ] {
            undo.push(document.put(steps, node(value)).unwrap());
        }
        let after = r#"{"pair": {"driven": {"holes": {"count": 8}}}, "torques": [2], "speed": {"rpm": 600}}"#;
        assert_eq!(document, node(after));
        for nowhere in [
            &["torques", "1"][..],
            &["torques", "0", "x"],
            &["torques", "x"],
            &["pair", "driven", "holes", "0", "count"],
            &["pair", "driven", "modifications", "0", "amount"],
        ] {
            assert!(document.put(nowhere, Node::Null).is_none());
        }
        assert_eq!(document, node(after), "what fails changes nothing");
        for undo in undo.into_iter().rev() {
            document.undo(undo);
        }
        assert_eq!(document, before);
    }
}
