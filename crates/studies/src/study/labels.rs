//! Labels of the designs of axes.

use std::collections::HashSet;

use meshwright_wire::declare::is_short_text;
use serde_json::Value;

use super::Axis;

/// The most characters of an object or list that stands in a label; a longer one is shown by its number.
const LONGEST_VALUE: usize = 32;

/// Gives every value of every axis the words that a label says it with: the last part of the path, or as many parts as
/// tell it from the other axes, and the value.
pub(super) fn name_values(axes: &mut [Axis]) {
    let names: Vec<String> = axes
        .iter()
        .map(|axis| {
            let ambiguous = |parts: usize| {
                let same = |other: &&Axis| other.path.last(parts) == axis.path.last(parts);
                axes.iter().filter(same).count() > 1
                    || axis.path.last(parts)[0]
                        .bytes()
                        .all(|byte| byte.is_ascii_digit())
            };
            let most = axis.path.steps().len();
            let parts = (1..most).find(|&parts| !ambiguous(parts)).unwrap_or(most);
            axis.path.last(parts).join(".")
        })
        .collect();
    for (axis, name) in axes.iter_mut().zip(names) {
        axis.words = words(&name, &axis.values);
    }
}

fn words(name: &str, values: &[Value]) -> Vec<String> {
    let said: Vec<String> = values.iter().map(said).collect();
    let distinct: HashSet<&String> = said.iter().collect();
    // An empty text is short enough, too.
    let usable = distinct.len() == said.len()
        && said
            .iter()
            .all(|word| word.is_empty() || is_short_text(word, LONGEST_VALUE));
    let numbered = said.iter().enumerate();
    numbered
        .map(|(j, word)| {
            if usable {
                format!("{name}={word}")
            } else {
                format!("{name}#{}", j + 1)
            }
        })
        .collect()
}

/// A value in a label: a word without its quotes, anything else as JSON.
fn said(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
