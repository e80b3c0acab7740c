//! The state of a search, as clients see it.

use meshwright_wire::problem::Problem;
use meshwright_wire::results::ErrorEstimateDocument;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;

use crate::refusals::RefusalState;

/// How far a search has come, as of its last generation that has ended.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = SearchProgress, title = "Search progress")]
pub struct SearchState {
    /// Designs that have been looked at.
    pub evaluations: u64,
    /// The best design so far: of one goal that with the least of it, of two the one of the front that is nearest to having the
    /// least of each, each measured by its range over the front. While no design keeps every condition it is the one that comes nearest to it. Null while none can be had.
    pub best: Option<FoundDesign>,
    /// Of two goals: the designs that keep every condition and of which no other is better in both, the least of the first goal first.
    #[serde(default)]
    pub front: Vec<FoundDesign>,
    /// The generations, in their order.
    pub generations: Vec<GenerationState>,
    /// Why designs could not be had, the most common reason first.
    #[serde(default)]
    pub refusals: Vec<RefusalState>,
    /// The same of members of designs that could be had.
    #[serde(default)]
    pub member_refusals: Vec<RefusalState>,
    /// Why no further designs are asked for; null while some are.
    #[serde(default)]
    pub ended_by: Option<SearchEnd>,
    /// The best design once more, on the fine grid; null until then, and where no design keeps every condition.
    #[serde(default)]
    pub confirmed: Option<ConfirmedDesign>,
}

/// A design that a search has found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Found design")]
pub struct FoundDesign {
    /// Its place in the table, from 0.
    pub row: u64,
    /// The variables: JSON pointers and values.
    #[schema(value_type = Object)]
    pub values: Map<String, Value>,
    /// True if it keeps every condition; for the best design, also on the fine grid, once that has been computed.
    pub feasible: bool,
    /// Its goals, in the order of `minimize`.
    pub goals: Vec<Option<f64>>,
    /// Values of the conditions, in the order of `subject_to`.
    pub conditions: Vec<Option<f64>>,
    /// The share of its members that could not be built or computed; null where it is not looked at over members. In a percentile such a member lies
    /// beyond every number, in the direction that hurts; one that falls among them is null.
    #[serde(default)]
    pub failed_share: Option<f64>,
}

/// A generation of a search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Generation, title = "Generation")]
pub struct GenerationState {
    /// The least of the first goal among all designs up to its end that keep every condition; null while there are none.
    pub best: Option<f64>,
    /// The designs of the generation that keep every condition.
    pub feasible: u32,
}

/// Why a search asks for no further designs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "End of a search")]
pub enum SearchEnd {
    /// As many designs were looked at as were asked for.
    Evaluations,
    /// The time was over.
    Seconds,
    /// Every design that there is was looked at.
    Exhausted,
}

/// The best design by the method `flexible`, or `three_dimensional` where the search sees the faces, on the fine grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Confirmed design")]
pub struct ConfirmedDesign {
    /// Its place in the table, from 0.
    pub row: u64,
    /// True if it keeps every condition there, false where there are no results. Null where all conditions on the drawn design are kept, and others are about
    /// members, which are not computed again.
    pub feasible: Option<bool>,
    /// Its goals there, in the order of `minimize`; null where they are about members.
    pub goals: Vec<Option<f64>>,
    /// Values of the conditions there, in the order of `subject_to`; null where they are about members.
    pub conditions: Vec<Option<f64>>,
    /// Change by a second grid level, the largest over the torques; null where there are no results.
    pub error_estimate: Option<ErrorEstimateDocument>,
    /// Why there are no results.
    #[serde(default)]
    #[schema(value_type = Option<Problem>)]
    pub problem: Option<Value>,
}
