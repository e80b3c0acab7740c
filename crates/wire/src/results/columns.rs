//! The lists of a curve over its positions as columns of a table.

use serde_json::{Map, Value};

use super::curve::CurveDocument;

/// A list with its name.
type Column = (String, Vec<Option<f64>>);

impl CurveDocument {
    /// Its lists of numbers over mesh positions with their names in the document: its own, then those of stresses, then the shares of pairs. `None` where a
    /// value has no limit. A list that a version did not write is left out.
    pub fn columns(&self) -> Vec<(String, Vec<Option<f64>>)> {
        let count = self.mesh_position.len();
        // The names are those of the declaration, which writes the document.
        let document = serde_json::to_value(self).unwrap_or_default();
        let lists = |of: &Value, name: &dyn Fn(&str) -> String| -> Vec<Column> {
            let fields = of.as_object().into_iter().flat_map(Map::iter);
            let lists = fields.filter_map(|(field, value)| {
                Some((
                    name(field),
                    numbers(value).filter(|list| list.len() == count)?,
                ))
            });
            lists.collect()
        };
        let mut columns = lists(&document, &str::to_owned);
        for (gear, stresses) in document["stress"].as_object().into_iter().flatten() {
            columns.extend(lists(stresses, &|field| format!("stress.{gear}.{field}")));
        }
        let shares = self.load_shares.iter().map(|share| {
            let list = share.share.iter().copied().map(Some).collect();
            (format!("load_share.{}", share.pair_offset), list)
        });
        columns.extend(shares);
        columns
    }
}

/// A list of numbers.
fn numbers(value: &Value) -> Option<Vec<Option<f64>>> {
    let number = |item: &Value| match item {
        Value::Null => Some(None),
        item => item.as_f64().map(Some),
    };
    value.as_array()?.iter().map(number).collect()
}
