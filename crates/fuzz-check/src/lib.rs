//! Bytes as a submission, a preview, a study, a REXS model and a drawing: for any bytes, reading ends in a document or a problem, and a document is read again
//! from its echo, or from the model that it is written as.

use meshwright_engine::run::Run;
use meshwright_exchange::dxf::{Choices as Drawn, outline};
use meshwright_exchange::rexs::{Choices, import, is_model};
use meshwright_studies::{Searching, Study};
use meshwright_wire::{Preview, Problem, Submission, model_of};

/// Designs of a study that are expanded.
const DESIGNS: usize = 8;

/// Reads `bytes` as all that they might be.
///
/// # Panics
///
/// If something does not hold that should, whatever they are.
pub fn check(bytes: &[u8]) {
    // Loops, or why there are none.
    let _ = outline(bytes, &Drawn::default());
    if is_model(bytes) {
        check_model(bytes);
        return;
    }
    match Submission::parse(bytes) {
        Ok(submission) => {
            let again = Submission::parse(submission.canonical_json().as_bytes());
            let again = again.expect("an echo is valid");
            assert_eq!(again.input_hash(), submission.input_hash());
        }
        Err(problem) => check_problem(&problem),
    }
    if let Err(problem) = Preview::parse(bytes, 4000) {
        check_problem(&problem);
    }
    match Study::submitted(bytes, &Run::unattended()) {
        Ok(study) => check_study(&study),
        Err(problem) => check_problem(&problem),
    }
}

/// Reads a model, and writes its submission as a model that can be read again.
fn check_model(bytes: &[u8]) {
    let Ok(imported) = import(bytes, &Choices::default()) else {
        return;
    };
    match Submission::parse(imported.submission.to_string().as_bytes()) {
        Ok(submission) => {
            let model = model_of(&submission, None, "");
            import(model.as_bytes(), &Choices::default()).expect("what is written can be read");
        }
        Err(problem) => check_problem(&problem),
    }
}

/// Expands the first designs.
fn check_study(study: &Study) {
    if let Some(mut search) = Searching::new(study.clone()) {
        for row in 0..search.ask().min(DESIGNS) {
            if let Err(problem) = &search.design(row).submission {
                check_problem(problem);
            }
        }
        return;
    }
    for row in 0..study.total().min(DESIGNS) {
        let design = study.design(row).expect("there are so many");
        if let Err(problem) = &design.submission {
            check_problem(problem);
        }
    }
    assert!(study.design(study.total()).is_none());
}

fn check_problem(problem: &Problem) {
    assert!([400, 422].contains(&problem.status), "{problem:?}");
    assert!(!problem.detail.contains("NaN"), "{problem:?}");
    for error in &problem.errors {
        assert!(error.nearest.is_none_or(f64::is_finite), "{error:?}");
    }
}
