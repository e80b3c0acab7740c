//! A study as clients see it.

use axum::body::Bytes;
use jiff::Timestamp;
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

use crate::http::app::Edge;
use crate::http::view::with_public_type;
use crate::jobs::StudyRecord;
use crate::wire::{Code, Problem, SearchState, Status, Study};

/// A study: how far it has come, and where to find its table.
#[derive(Serialize, ToSchema)]
#[schema(as = SubmittedStudy)]
pub(in crate::http) struct StudyView {
    /// The id of the study.
    #[schema(value_type = String, format = "uuid")]
    id: Uuid,
    /// `successful` when at least one design has results, `failed` when none has and all have ended.
    status: Status,
    /// Designs that have come to an end, whichever.
    done: u64,
    /// Designs in all; of a search that has not ended, the most that it may come to.
    total: u64,
    /// Designs that have results.
    successful: u64,
    /// Designs that could not be built or computed.
    failed: u64,
    /// Designs that were cancelled, or whose job was deleted.
    dismissed: u64,
    /// What the client calls the study.
    name: Option<String>,
    /// The tags of the study.
    tags: Vec<String>,
    /// When the study was submitted (UTC).
    #[schema(value_type = String, format = DateTime)]
    submitted_at: Timestamp,
    /// When its last design ended, or it was cancelled (UTC); null until then.
    #[schema(value_type = Option<String>, format = DateTime)]
    finished_at: Option<Timestamp>,
    /// Of a failed study: why.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Problem>)]
    problem: Option<Value>,
    /// Of a search: how far it has come.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<SearchState>)]
    search: Option<Box<RawValue>>,
    links: StudyLinks,
    /// The study as it was sent. Absent in lists, and where it has more than 64 KiB: `links.document` has it whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Study>)]
    study: Option<Box<RawValue>>,
}

/// Where to find what belongs to a study.
#[derive(Serialize, ToSchema)]
pub(in crate::http) struct StudyLinks {
    /// The study.
    #[serde(rename = "self")]
    self_: String,
    /// The study as it was sent.
    document: String,
    /// Its table, at any time.
    results: String,
    /// Its table as CSV.
    results_csv: String,
    /// Its table, one row to a line.
    table_ndjson: String,
    /// The results of all designs that have some, one to a line.
    results_ndjson: String,
    /// Its events, as they happen.
    events: String,
    /// Its jobs, one for each design that can be built.
    jobs: String,
    /// Of a search: the submission of the best design.
    #[serde(skip_serializing_if = "Option::is_none")]
    best: Option<String>,
    /// Where to cancel it, by POST; absent when it has ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    cancel: Option<String>,
}

impl StudyView {
    /// The small view, for lists and answers to a submission.
    pub(in crate::http) fn new(study: &StudyRecord, edge: &Edge) -> Self {
        let status = study.status();
        Self {
            id: study.id,
            status,
            done: study.done(),
            total: study.total,
            successful: study.successful,
            failed: study.failed + study.unbuildable,
            dismissed: study.dismissed,
            name: study.name.clone(),
            tags: study.tags.clone(),
            submitted_at: study.submitted_at,
            finished_at: study.finished_at(),
            problem: why_failed(study, edge),
            search: study
                .search
                .clone()
                .and_then(|text| RawValue::from_string(text).ok()),
            links: StudyLinks::new(study, edge),
            study: None,
        }
    }

    /// The whole view, with the study as it was sent.
    pub(super) fn whole(study: &StudyRecord, document: Option<String>, edge: &Edge) -> Self {
        Self {
            study: document.and_then(|text| RawValue::from_string(text).ok()),
            ..Self::new(study, edge)
        }
    }

    pub(super) fn to_json(&self) -> Bytes {
        serde_json::to_vec(self)
            .expect("a view is plain data")
            .into()
    }
}

impl StudyLinks {
    fn new(study: &StudyRecord, edge: &Edge) -> Self {
        let self_ = edge.study(study.id);
        Self {
            results: format!("{self_}/results"),
            document: format!("{self_}/document"),
            results_csv: format!("{self_}/results/table.csv"),
            table_ndjson: format!("{self_}/results/table.ndjson"),
            results_ndjson: format!("{self_}/results/documents.ndjson"),
            events: format!("{self_}/events"),
            jobs: format!("{}/v1/jobs?study={}", edge.public_url, study.id),
            best: study.search.is_some().then(|| format!("{self_}/best")),
            cancel: (!study.status().has_ended()).then(|| format!("{self_}/cancel")),
            self_,
        }
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
    if study.status() != Status::Failed {
        return None;
    }
    let searched: Option<SearchState> = study
        .search
        .as_ref()
        .and_then(|text| serde_json::from_str(text).ok());
    let usual = || {
        format!(
            "None of the {} designs has results: {} could not be built, {} could not be computed. Each row of the table has its problem.",
            study.total, study.unbuildable, study.failed
        )
    };
    let detail = searched
        .and_then(|search| search.why_nothing())
        .unwrap_or_else(usual);
    let problem = serde_json::to_value(Problem::new(Code::NoDesignComputed, detail))
        .expect("a problem is plain data");
    Some(with_public_type(problem, &edge.public_url))
}
