//! A stand-in for the wire documents, until the real ones replace this folder: every name here is theirs.

mod problem;

use meshwright_engine::run::Run;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

pub use problem::{Code, FieldError, Problem};

/// A submission.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Submission {
    method: String,
    pair: Value,
    output_torques_n_m: Vec<f64>,
    #[serde(default)]
    resolution: Value,
    #[serde(default)]
    tags: Vec<String>,
}

impl Submission {
    /// Reads a submission.
    ///
    /// # Errors
    ///
    /// A [`Problem`] that says what is wrong with it.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        serde_json::from_slice(document).map_err(|error| match error.classify() {
            serde_json::error::Category::Data => {
                Problem::new(Code::UnknownField, error.to_string())
            }
            _ => Problem::new(Code::MalformedJson, error.to_string()),
        })
    }

    /// The document with every default filled in.
    pub fn canonical_json(&self) -> String {
        serde_json::to_string(self).expect("a submission is plain data")
    }

    /// The hash of what is computed.
    pub fn input_hash(&self) -> String {
        let input = json!([
            self.method,
            self.pair,
            self.output_torques_n_m,
            self.resolution
        ]);
        Sha256::digest(input.to_string())
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// Positions times torques.
    pub fn positions_total(&self) -> u64 {
        200 * self.output_torques_n_m.len() as u64
    }

    /// The method's name.
    pub fn method(&self) -> &str {
        &self.method
    }

    /// The tags.
    pub fn tags(&self) -> &[String] {
        &self.tags
    }
}

/// Solves a submission.
///
/// # Errors
///
/// A [`Problem`] when it cannot be solved.
pub fn solve(_: &Submission, _: &Run) -> Result<String, Problem> {
    Err(Problem::new(
        Code::InternalError,
        "the engine is not here yet",
    ))
}

/// The answer of `/v1/validate`.
pub fn validate(submission: &Submission) -> Value {
    json!({ "valid": true, "submission": submission })
}

/// An example.
#[derive(Debug, Clone, Copy)]
pub struct Example {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Whether it can be computed.
    pub valid: bool,
    /// The document.
    pub json: &'static str,
}

/// The examples.
pub fn examples() -> &'static [Example] {
    &[Example {
        name: "test-case-2",
        description: "Test case 2 of the paper.",
        valid: true,
        json: r#"{ "method": "flexible", "pair": {}, "output_torques_n_m": [115.0] }"#,
    }]
}

/// The version of the solver.
pub const SOLVER_VERSION: &str = concat!("meshwright ", env!("CARGO_PKG_VERSION"));

/// The limits.
pub fn limits() -> Value {
    json!({ "positions": 20_000 })
}
