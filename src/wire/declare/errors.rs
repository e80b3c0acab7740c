//! What is wrong with a document, collected while it is read.

use std::cell::RefCell;

use crate::wire::problem::{FieldError, Problem};

/// Errors beyond this number are not told; a document with so many is not a slip.
const MOST_ERRORS: usize = 50;

/// The errors found so far, with a bound on their number.
#[derive(Debug, Default)]
pub(in crate::wire) struct Errors(RefCell<Vec<FieldError>>);

impl Errors {
    pub(in crate::wire) fn push(&self, error: FieldError) {
        let mut errors = self.0.borrow_mut();
        if errors.len() < MOST_ERRORS {
            errors.push(error);
        }
    }

    pub(in crate::wire) fn count(&self) -> usize {
        self.0.borrow().len()
    }

    /// Whether no more are told.
    pub(super) fn is_full(&self) -> bool {
        self.count() >= MOST_ERRORS
    }

    pub(in crate::wire) fn into_errors(self) -> Vec<FieldError> {
        self.0.into_inner()
    }

    pub(in crate::wire) fn into_problem(self) -> Problem {
        Problem::of_fields(self.into_errors())
    }
}
