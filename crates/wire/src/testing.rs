//! Common parts of tests of documents, here and in the crate `studies`: examples, changes of them, and tables of refusals.

use serde_json::Value;

use super::problem::{Code, FieldError, Problem};
use super::{Submission, examples};

/// A small results document.
#[cfg(test)]
pub(crate) const STUB: &str = include_str!("../../../tests/it/results.json");

/// The example of this name as it ships.
pub fn example(name: &str) -> Value {
    let example = examples().iter().find(|example| example.name == name);
    serde_json::from_str(example.expect("ships").json).expect("JSON")
}

/// The submission that `document` is, or why it is none.
pub fn parse(document: &Value) -> Result<Submission, Problem> {
    Submission::parse(document.to_string().as_bytes())
}

/// The submission that the example of this name is.
pub fn submission(name: &str) -> Submission {
    parse(&example(name)).expect("valid")
}

/// The example of this name with everything that is filled in.
pub fn filled_in(name: &str) -> Value {
    echo(&submission(name))
}

/// The answer to a submission.
pub fn echo(submission: &Submission) -> Value {
    serde_json::from_str(&submission.canonical_json()).expect("JSON")
}

/// Puts `value` where `pointer` says, in objects that are there.
pub fn put(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match document.pointer_mut(parent) {
        Some(Value::Object(fields)) => {
            fields.insert(key.to_owned(), value);
        }
        Some(Value::Array(items)) => {
            if let Some(item) = key.parse::<usize>().ok().and_then(|i| items.get_mut(i)) {
                *item = value;
            }
        }
        _ => panic!("{pointer} has no parent"),
    }
}

/// `document` with these values at these places.
pub fn with(mut document: Value, changes: &[(&str, Value)]) -> Value {
    for (pointer, value) in changes {
        put(&mut document, pointer, value.clone());
    }
    document
}

/// `object` with these fields too.
pub fn and(mut object: Value, fields: &Value) -> Value {
    for (name, value) in fields.as_object().expect("fields") {
        object[name] = value.clone();
    }
    object
}

/// Faults, error by error: place, code, and the nearest value that would do.
pub fn faults(problem: Problem) -> Vec<(String, Code, Option<f64>)> {
    let errors = problem.errors.into_iter();
    errors
        .map(|error| (error.pointer, error.code, error.nearest))
        .collect()
}

/// The first thing that is wrong with `document`.
pub fn first_fault(document: &Value) -> FieldError {
    let mut problem = parse(document).expect_err("it is refused");
    problem.errors.remove(0)
}

/// The same, which is this at this place.
pub fn fault(document: &Value, place: &str, code: Code) -> FieldError {
    let fault = first_fault(document);
    assert_eq!((&*fault.pointer, fault.code), (place, code), "{fault:?}");
    fault
}

/// A table of refusals, a line each: the value, place and code of the refusal, and the nearest value that would do.
#[macro_export]
macro_rules! refused {
    ($($sent:expr => $place:expr, $code:ident $(, $nearest:expr)?;)*) => {
        [$(($sent, $place, $crate::Code::$code, $crate::refused!(@nearest $($nearest)?))),*]
    };
    (@nearest) => { None::<f64> };
    (@nearest $nearest:expr) => { Some(f64::from($nearest)) };
}

pub use refused;
