//! Common parts of tests of studies, beside those of tests of documents.

use meshwright_engine::run::Run;
use meshwright_wire::Problem;
pub(crate) use meshwright_wire::testing::*;
use serde_json::Value;

use crate::Study;

/// A small results document.
pub(crate) const STUB: &str = include_str!("../../../tests/it/results.json");

/// The study that `document` is, or why it is none.
pub(crate) fn study(document: &Value) -> Result<Study, Problem> {
    Study::submitted(document.to_string().as_bytes(), &Run::unattended())
}
