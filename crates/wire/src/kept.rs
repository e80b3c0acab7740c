//! How much of what was computed is kept.

use serde::Serialize;
use utoipa::ToSchema;

use super::declare::{Choice, words};

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

impl Kept {
    /// The word on the wire and in the database.
    pub fn as_str(self) -> &'static str {
        self.word()
    }

    /// What a word of the database stands for.
    pub fn named(word: &str) -> Option<Self> {
        Self::of_word(word)
    }
}
