//! Fields of real drawings: reading, conversion for the engine, echo and refusals.

mod blank;
mod generated;
mod hob;
mod openings;
mod published;
mod teeth;
mod tool;

use meshwright_engine::gear::GearData;
use serde_json::{Value, json};

use crate::testing::{and, echo, parse, put};
use crate::{Code, FieldError};

/// The pair of the least submission, its driving gear with these fields too.
fn with(fields: &Value) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 }
    });
    json!({
        "method": "flexible",
        "pair": { "center_distance_mm": 100.5, "driving": and(gear.clone(), fields), "driven": gear },
        "output_torques_n_m": [115.0]
    })
}

/// The engine's data of the driving gear with these fields.
fn data_of(fields: &Value) -> GearData {
    let submission = parse(&with(fields));
    let submission = submission.unwrap_or_else(|problem| panic!("{fields}: {problem:?}"));
    let echo = echo(&submission);
    let again = parse(&echo).expect("an echo is valid");
    assert_eq!(again, submission, "an echo is its own echo: {echo}");
    submission.case().pair.driving().data().clone()
}

/// The faults of the driving gear with these fields.
fn faults(fields: &Value) -> Vec<FieldError> {
    let problem = parse(&with(fields))
        .err()
        .unwrap_or_else(|| panic!("{fields} is taken"));
    assert_eq!(problem.status, 422);
    problem.errors
}

/// The only fault of the driving gear with these fields, which stands at `place` in it.
fn fault(fields: &Value, place: &str, code: Code) -> FieldError {
    let faults = faults(fields);
    let [fault] = faults.as_slice() else {
        panic!("one fault of {fields}: {faults:?}")
    };
    let expected = (format!("/pair/driving/{place}"), code);
    assert_eq!((fault.pointer.clone(), fault.code), expected, "{fault:?}");
    fault.clone()
}

fn near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-15, "{value} {expected}");
}

/// Follows the advice on the driving gear with these fields until it is taken.
fn mended(fields: &Value) -> Value {
    const MOST_ROUNDS: usize = 6;
    let mut document = with(fields);
    for _ in 0..MOST_ROUNDS {
        let Err(problem) = parse(&document) else {
            return document;
        };
        for error in &problem.errors {
            let nearest = error.nearest.unwrap_or_else(|| panic!("{error:?}"));
            put(&mut document, &error.pointer, json!(nearest));
        }
    }
    panic!("{document}")
}
