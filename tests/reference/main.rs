//! The mechanics against other people's numbers: those of CalculiX, an independent finite-element solver, and of the paper. They lie
//! here as JSON, of which the mechanics itself knows nothing.

mod calculix;
mod fillets;
mod paper;
mod solid;
#[path = "../../crates/engine/tests/validation/support.rs"]
mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;

/// What stands in `file`, which lies beside this one.
fn reference(file: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/reference")
        .join(file);
    let text =
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{file}: {error}"))
}
