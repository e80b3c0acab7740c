//! A study as clients see it.

use axum::body::Bytes;
use jiff::Timestamp;
use meshwright_studies::{SearchState, Study};
use meshwright_wire::declare::document;
use meshwright_wire::{Problem, Status};
use serde_json::Value;
use serde_json::value::RawValue;
use uuid::Uuid;

use crate::http::edge::Edge;
use crate::http::reference::StudyEstimate;
use crate::http::view::with_public_type;
use crate::jobs::{self, StudyRecord};

document! {
    /// A study: how far it has come, and where to find its table.
    pub(in crate::http) struct StudyView as SubmittedStudy
    view of (study: &StudyRecord, edge: &Edge) {
        /// The id of the study.
        id: Uuid = study.id,
        /// `successful` when at least one design has results, `failed` when none has and all have ended.
        status: Status = study.status(),
        /// Designs that have come to an end, whichever.
        done: u64 = study.done(),
        /// Designs in all; of a search that has not ended, the most that it may come to.
        total: u64 = study.total,
        /// Designs that have results.
        successful: u64 = study.successful,
        /// Designs that could not be built or computed.
        failed: u64 = study.failed + study.unbuildable,
        /// Designs that were cancelled, or whose job was deleted.
        dismissed: u64 = study.dismissed,
        /// The client's name for the study.
        name: Option<String> = study.name.clone(),
        /// The tags of the study.
        tags: Vec<String> = study.tags.clone(),
        /// The user of the client who submitted it (`Meshwright-User`, or the claim of a token); null where the client names none.
        submitted_by: Option<String> = study.submitted_by.clone(),
        /// When the study was submitted (UTC).
        submitted_at: Timestamp = study.submitted_at,
        /// When its last design ended, or it was cancelled (UTC); null until then.
        finished_at: Option<Timestamp> = study.finished_at(),
        /// `administrator` where an administrator of the service dismissed the study; absent elsewhere.
        #[schema(example = "administrator")]
        dismissed_by?: String = study.dismissed_by.clone(),
        /// Of a failed study: why.
        #[schema(value_type = Option<Problem>)]
        problem?: Value = why_failed(study, edge),
        /// Of a search: how far it has come.
        #[schema(value_type = Option<SearchState>)]
        search?: Box<RawValue> = study
            .search
            .clone()
            .and_then(|text| RawValue::from_string(text).ok()),
        /// What its computation will cost, in the answer to its submission; absent elsewhere, and where none of the designs that were looked at can be built.
        estimate?: StudyEstimate = None,
        links: StudyLinks = StudyLinks::of(study, edge),
        /// The study as it was sent. Absent in lists, and where it has more than 64 KiB: `links.document` has it whole.
        #[schema(value_type = Option<Study>)]
        study?: Box<RawValue> = None,
    }
}

document! {
    /// Links of a study.
    pub(in crate::http) struct StudyLinks as StudyLinks
    view of (study: &StudyRecord, edge: &Edge) with {
        let address = edge.study(study.id);
    } {
        /// The study.
        #[serde(rename = "self")]
        self_: String = address.clone(),
        /// The study as it was sent.
        document: String = format!("{address}/document"),
        /// Its table, at any time.
        results: String = format!("{address}/results"),
        /// Its table as CSV.
        results_csv: String = format!("{address}/results/table.csv"),
        /// Its table, one row to a line.
        table_ndjson: String = format!("{address}/results/table.ndjson"),
        /// The results of all designs that have some, one to a line.
        results_ndjson: String = format!("{address}/results/documents.ndjson"),
        /// Its events, as they happen.
        events: String = format!("{address}/events"),
        /// Its jobs, one for each design that can be built.
        jobs: String = format!("{}/v1/jobs?study={}", edge.public_url, study.id),
        /// Of a search: the submission of the best design.
        best?: String = study.search.is_some().then(|| format!("{address}/best")),
        /// Where to cancel it, by POST; absent when it has ended.
        cancel?: String = (!study.status().has_ended()).then(|| format!("{address}/cancel")),
    }
}

impl StudyView {
    /// The whole view, with the study as it was sent.
    pub(super) fn whole(study: &StudyRecord, document: Option<String>, edge: &Edge) -> Self {
        Self {
            study: document.and_then(|text| RawValue::from_string(text).ok()),
            ..Self::of(study, edge)
        }
    }

    /// The view in answer to the submission, with what the study will take.
    pub(super) fn submitted(
        study: &StudyRecord,
        estimate: Option<StudyEstimate>,
        edge: &Edge,
    ) -> Self {
        Self {
            estimate,
            ..Self::of(study, edge)
        }
    }

    pub(super) fn to_json(&self) -> Bytes {
        serde_json::to_vec(self)
            .expect("a view is plain data")
            .into()
    }
}

impl Edge {
    /// The address of a study.
    pub(in crate::http) fn study(&self, id: Uuid) -> String {
        format!("{}/v1/studies/{id}", self.public_url)
    }
}

/// A study that came to nothing says so.
pub(super) fn why_failed(study: &StudyRecord, edge: &Edge) -> Option<Value> {
    let problem = serde_json::to_value(jobs::why_failed(study)?).expect("a problem is plain data");
    Some(with_public_type(problem, &edge.public_url))
}
