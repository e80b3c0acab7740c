//! What is wrong with a model, with its place.

use std::fmt;

/// So many are told at most; nobody reads more before mending some.
const MOST_TOLD: usize = 50;

/// One thing that is wrong, or that is not there.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// The component and its attribute, or the line, or the file.
    pub place: String,
    /// What is wrong there, and what would do.
    pub detail: String,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            place: place.into(),
            detail: detail.into(),
        }
    }

    /// Whether it is of the component at `place`, or of one of its attributes.
    pub(super) fn is_of(&self, place: &str) -> bool {
        let rest = self.place.strip_prefix(place);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(", "))
    }
}

/// Everything that is wrong with a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct Refused(pub Vec<Fault>);

impl From<Fault> for Refused {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "The REXS model cannot be taken.")?;
        for Fault { place, detail } in self.0.iter().take(MOST_TOLD) {
            writeln!(f, "  {place}\n    {detail}")?;
        }
        match self.0.len().saturating_sub(MOST_TOLD) {
            0 => Ok(()),
            more => writeln!(f, "  and {more} more"),
        }
    }
}
