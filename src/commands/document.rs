//! Documents from files and into them, and problems as a person reads them.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Read, Write};
use std::path::Path;

use anyhow::Context;

use meshwright_wire::Problem;
use meshwright_wire::declare::meant_by;
use serde::de::IgnoredAny;

use crate::mark::without_mark;

/// The exit code for a submission that cannot be computed.
pub(super) const EXIT_PROBLEM: u8 = 2;

/// Writes a document as a line of its own.
pub(super) fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    if is_dash(path) {
        writeln!(std::io::stdout(), "{text}").context("standard output cannot be written")
    } else {
        fs::write(path, format!("{text}\n"))
            .with_context(|| format!("{} cannot be written", path.display()))
    }
}

/// The document at `path`, or from standard input.
pub(super) fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    if is_dash(path) {
        let mut document = Vec::new();
        std::io::stdin()
            .read_to_end(&mut document)
            .context("standard input cannot be read")?;
        Ok(unmarked(document))
    } else {
        let document = fs::read(path);
        let document = document.with_context(|| format!("{} cannot be read", path.display()));
        document.map(unmarked)
    }
}

/// A document without the byte-order mark that Windows puts before it.
fn unmarked(document: Vec<u8>) -> Vec<u8> {
    without_mark(&document).to_vec()
}

/// True if a path stands for standard input or output.
pub(super) fn is_dash(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// True if a document is an object with this field.
pub(super) fn has_field(document: &[u8], name: &str) -> bool {
    let object = serde_json::from_slice::<BTreeMap<String, IgnoredAny>>(document);
    object.is_ok_and(|object| object.contains_key(name))
}

/// The number of an option, with a decimal point.
pub(super) fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| {
        let meant = meant_by(text, "mm").map_or(String::new(), |meant| format!(": {meant}"));
        format!("a number is expected{meant}")
    })
}

/// A problem as a person reads it.
pub(super) fn text_of(problem: &Problem) -> String {
    text_with_origins(problem, |_| None)
}

/// The same, with where each field is from.
pub(super) fn text_with_origins<'a>(
    problem: &Problem,
    origin: impl Fn(&str) -> Option<&'a str>,
) -> String {
    let mut text = format!("{} ({}).\n", problem.title, problem.code.word());
    if problem.errors.is_empty() {
        text.push_str(&format!("  {}\n", problem.detail));
    }
    for error in &problem.errors {
        text.push_str(&format!("  {}\n    {}\n", error.pointer, error.detail));
        if let Some(place) = origin(&error.pointer) {
            text.push_str(&format!("    from {place}\n"));
        }
        if let Some(nearest) = error.nearest {
            text.push_str(&format!("    nearest: {nearest}\n"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_study_and_a_submission_are_told_apart_by_a_field_and_text_has_none() {
        let study = include_bytes!("../../api/examples/study-section-5.json");
        let submission = include_bytes!("../../api/examples/test-case-2.json");
        assert!(has_field(study, "base") && !has_field(study, "pair"));
        assert!(has_field(submission, "pair") && !has_field(submission, "base"));
        assert!(!has_field(b"[\"base\"]", "base") && !has_field(b"base", "base"));
    }
}
