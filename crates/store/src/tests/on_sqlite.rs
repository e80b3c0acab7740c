//! Behavior of the store on any database, on SQLite.

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
