//! Why some of many designs have no results.

use std::collections::BTreeMap;

use meshwright_wire::problem::Code;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

/// Why some designs could not be had.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Refusal, title = "Refusal")]
pub struct RefusalState {
    /// The code of their problem.
    #[schema(value_type = Code)]
    pub code: String,
    /// Number of designs.
    pub count: u64,
    /// Fault of the first of them.
    pub detail: String,
}

/// The problems of designs, counted by their code.
#[derive(Debug, Clone, Default)]
pub struct Refusals(BTreeMap<String, RefusalState>);

impl Refusals {
    /// Counts the problem of a design, where it has one.
    pub fn note(&mut self, problem: Option<&Value>) {
        let Some(problem) = problem else {
            return;
        };
        let text = |name: &str| problem[name].as_str().unwrap_or_default().to_owned();
        let refusal = self.0.entry(text("code")).or_insert_with(|| RefusalState {
            code: text("code"),
            count: 0,
            detail: text("detail"),
        });
        refusal.count += 1;
    }

    /// The most common one first.
    pub fn most_common_first(&self) -> Vec<RefusalState> {
        let mut states: Vec<RefusalState> = self.0.values().cloned().collect();
        states.sort_by(|a, b| b.count.cmp(&a.count).then(a.code.cmp(&b.code)));
        states
    }
}
