//! Extent of the stored results.

use serde::Serialize;
use utoipa::ToSchema;

use super::declare::words;

/// Extent of the stored results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kept {
    /// The results document.
    Results,
    /// The values of a study's table.
    Statistics,
}

words! {
    Kept {
        Results = "results": "the whole results of each design, with every curve",
        Statistics = "statistics":
            "the numbers of the table only; a design has its curves when it is submitted alone",
    }
}
