//! Faults of a document, collected while it is read.

use std::cell::RefCell;

use crate::problem::{FieldError, Problem};

/// Errors beyond this number are not reported; a document with so many is not a slip.
const MOST_ERRORS: usize = 50;

/// The errors found so far, with a bound on their number.
#[derive(Debug, Default)]
pub struct Errors(RefCell<Vec<FieldError>>);

impl Errors {
    /// Adds an error, as long as there are not too many.
    pub fn push(&self, error: FieldError) {
        let mut errors = self.0.borrow_mut();
        if errors.len() < MOST_ERRORS {
            errors.push(error);
        }
    }

    /// The number of errors so far.
    pub fn count(&self) -> usize {
        self.0.borrow().len()
    }

    /// True if no more are reported.
    pub fn is_full(&self) -> bool {
        self.count() >= MOST_ERRORS
    }

    /// The errors, in the order in which they were found.
    pub fn into_errors(self) -> Vec<FieldError> {
        self.0.into_inner()
    }

    /// The same errors, each as `mend` gives it.
    pub fn mended(self, mend: impl Fn(FieldError) -> FieldError) -> Self {
        let errors = self.into_errors().into_iter();
        Self(RefCell::new(errors.map(mend).collect()))
    }

    /// The value of `made`, if it could be made; else its faults are reported.
    pub fn report<T>(&self, made: Result<T, impl IntoIterator<Item = FieldError>>) -> Option<T> {
        made.map_err(|faults| faults.into_iter().for_each(|fault| self.push(fault)))
            .ok()
    }

    /// The value that was read, if there are no faults.
    pub fn settle<T>(self, read: Option<T>) -> Result<T, Problem> {
        match read {
            Some(read) if self.count() == 0 => Ok(read),
            _ => Err(Problem::of_fields(self.into_errors())),
        }
    }
}
