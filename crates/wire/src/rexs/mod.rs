//! A submission, and its results, as a model of REXS.

#[cfg(test)]
mod tests;

use serde_json::Value;

use super::submission::Submission;

/// The model of `submission`, as [`meshwright_exchange::rexs::export`] writes it.
pub fn model_of(submission: &Submission, results: Option<&Value>, date: &str) -> String {
    let document = serde_json::to_value(submission).expect("a submission is words and numbers");
    meshwright_exchange::rexs::export(&document, submission.case(), results, date)
}
