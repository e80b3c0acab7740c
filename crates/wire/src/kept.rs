//! How much of what was computed is kept.

use serde::Serialize;
use utoipa::ToSchema;

use super::declare::words;

/// How much of what was computed is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kept {
    /// The results document.
    Results,
    /// What the table of a study shows.
    Statistics,
}

words! {
    Kept {
        Results = "results": "the whole results of each design, with every curve",
        Statistics = "statistics":
            "the numbers of the table only; a design has its curves when it is submitted alone",
    }
}
