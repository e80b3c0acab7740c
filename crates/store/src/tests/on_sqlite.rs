//! What the store does whatever is below it, on SQLite.

use super::*;

#[path = "doubt.rs"]
mod doubt;
#[path = "keeping.rs"]
mod keeping;
#[path = "lists.rs"]
mod lists;
#[path = "transitions.rs"]
mod transitions;
#[path = "turns.rs"]
mod turns;
