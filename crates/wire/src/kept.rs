//! Extent of the stored results, as a study chooses it.

use super::declare::words;
use meshwright_state::Kept;

words! {
    Kept {
        Results = "results": "the whole results of each design, with every curve",
        Statistics = "statistics":
            "the numbers of the table only; a design has its curves when it is submitted alone",
    }
}
