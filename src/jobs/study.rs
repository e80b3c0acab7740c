//! The record of a study in the words of documents.

use meshwright_store::{Status, StudyRecord};
use meshwright_studies::SearchState;
use meshwright_wire::warning::GearName;
use meshwright_wire::{Code, Problem};

/// The gear whose mass and holes the table of a study shows.
pub fn gear_of(study: &StudyRecord) -> GearName {
    GearName::of_word(&study.gear).unwrap_or(GearName::Driven)
}

/// How far a search has come; none for other studies.
pub fn search_state(study: &StudyRecord) -> Option<SearchState> {
    serde_json::from_str(study.search.as_ref()?).ok()
}

/// Why a study came to nothing, if it did.
pub fn why_failed(study: &StudyRecord) -> Option<Problem> {
    if study.status() != Status::Failed {
        return None;
    }
    let searched = search_state(study).and_then(|state| state.why_nothing());
    let detail = searched.unwrap_or_else(|| {
        format!(
            "None of the {} designs has results: {} could not be built, {} could not be computed. Each row of the table has its problem.",
            study.total, study.unbuildable, study.failed
        )
    });
    Some(Problem::new(Code::NoDesignComputed, detail))
}
