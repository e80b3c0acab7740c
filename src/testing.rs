//! Common parts of the service's unit tests.

use meshwright_wire::{Submission, examples};

/// The results of a small pair.
pub(crate) const RESULTS: &str = include_str!("../tests/it/results.json");

/// The submission that the example of this name is.
pub(crate) fn submission(name: &str) -> Submission {
    let example = examples().iter().find(|example| example.name == name);
    Submission::parse(example.expect("ships").json.as_bytes()).expect("valid")
}
