//! JSON as it was sent, read field by field so that every error names its place.

mod choice;
mod errors;
mod node;
mod reader;

pub(super) use choice::{Choice, as_word};
pub(super) use errors::Errors;
pub(super) use node::{Node, escaped};
pub(super) use reader::{ObjectReader, OptionalObject};
