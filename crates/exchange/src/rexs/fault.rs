//! Faults of a model, with their places.

use std::fmt;

/// Maximum number of reported faults; nobody reads more before mending some.
const MOST_TOLD: usize = 50;

/// Faults beyond this number are not kept.
const MOST_FAULTS: usize = 100;

/// Maximum number of characters of a place, and of a fault there.
const LONGEST: usize = 500;

/// One thing that is wrong, or that is not there.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// The component and its attribute, or the line, or the file.
    pub place: String,
    /// The fault, and the nearest value that would do.
    pub detail: String,
}

impl Fault {
    pub(super) fn new(place: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            place: cut(place.into(), LONGEST),
            detail: cut(detail.into(), LONGEST),
        }
    }

    /// True if it is of the component at `place`, or of one of its attributes.
    pub(super) fn is_of(&self, place: &str) -> bool {
        let rest = self.place.strip_prefix(place);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(", "))
    }
}

/// The first `most` characters of `text`, and a sign that there were more.
pub(super) fn cut(mut text: String, most: usize) -> String {
    if let Some((at, _)) = text.char_indices().nth(most) {
        text.truncate(at);
        text.push('…');
    }
    text
}

/// Faults so far: a bounded number, whatever the size of the model.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<Fault>);

impl Faults {
    /// Notes that `detail` is wrong at `place`, unless that is noted already or there is no room for more.
    pub(super) fn push(&mut self, place: impl Into<String>, detail: impl Into<String>) {
        if self.is_full() {
            return;
        }
        let fault = Fault::new(place, detail);
        if !self.0.contains(&fault) {
            self.0.push(fault);
        }
    }

    /// True if no more are noted.
    pub(super) fn is_full(&self) -> bool {
        self.0.len() >= MOST_FAULTS
    }

    /// `first`, and then these faults without those of the same components.
    pub(super) fn after(mut self, first: Vec<Fault>) -> Self {
        self.0
            .retain(|fault| !first.iter().any(|other| fault.is_of(&other.place)));
        self.0.splice(0..0, first);
        self.0.truncate(MOST_FAULTS);
        self
    }

    /// True if there are no faults.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl From<Faults> for Refused {
    fn from(faults: Faults) -> Self {
        Self(faults.0)
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
