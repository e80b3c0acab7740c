//! A job as clients see it.

use axum::body::Bytes;
use jiff::Timestamp;
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

use super::app::Edge;
use crate::jobs::Job;
use crate::wire::{Kept, Status, method_schema};

/// A job: one submission, where it stands, and where to find what belongs to it.
#[derive(Serialize, ToSchema)]
#[schema(as = Job)]
pub(super) struct JobView<'a> {
    /// The id of the job.
    #[schema(value_type = String, format = "uuid")]
    id: Uuid,
    status: Status,
    /// Mesh positions solved, in whole percent of those to solve. 100 means all.
    #[schema(minimum = 0, maximum = 100)]
    progress_percent: u8,
    /// Mesh positions solved so far, over all torques.
    positions_done: u64,
    /// Mesh positions to solve, over all torques.
    positions_total: u64,
    /// The method of the submission.
    #[schema(schema_with = method_schema)]
    method: &'a str,
    /// The tags of the submission.
    tags: &'a [String],
    /// How often the job was begun, attempts that ended by no fault of its own aside. A job that ends its process is begun
    /// three times at most.
    attempt: i64,
    /// When the job was submitted (UTC).
    #[schema(value_type = String, format = DateTime)]
    submitted_at: Timestamp,
    /// When the computation began (UTC); null while the job waits.
    #[schema(value_type = Option<String>, format = DateTime)]
    started_at: Option<Timestamp>,
    /// When the job ended (UTC); null until then.
    #[schema(value_type = Option<String>, format = DateTime)]
    finished_at: Option<Timestamp>,
    /// What the computation took, in seconds; null until the job has ended.
    wall_time_seconds: Option<f64>,
    /// `statistics` where the study of the job keeps no more of its results; absent where they are kept whole. They can be
    /// had by submitting the design alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(example = "statistics")]
    keep: Option<Kept>,
    /// Of a failed job: why.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<crate::wire::Problem>)]
    problem: Option<Value>,
    links: Links,
    /// The submission with every default filled in. Absent in lists.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<crate::wire::Submission>)]
    submission: Option<&'a RawValue>,
    /// The results, in the answer to a submission with `Prefer: wait` whose job has ended in time. Absent elsewhere: they stand at
    /// `links.results`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<crate::wire::Results>)]
    results: Option<Box<RawValue>>,
}

/// Where to find what belongs to a job.
#[derive(Serialize, ToSchema)]
pub(super) struct Links {
    /// The job.
    #[serde(rename = "self")]
    self_: String,
    /// Its results.
    results: String,
    /// Its events, as they happen.
    events: String,
    /// Where to cancel it, by POST; absent when it has ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    cancel: Option<String>,
    /// The earlier job whose results this one was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    same_as: Option<String>,
    /// The study that it computes a design of.
    #[serde(skip_serializing_if = "Option::is_none")]
    study: Option<String>,
}

impl<'a> JobView<'a> {
    /// The small view, for lists and answers to a submission.
    pub(super) fn new(job: &'a Job, edge: &Edge) -> Self {
        Self {
            id: job.id,
            status: job.status,
            progress_percent: job.progress.percent(),
            positions_done: job.progress.done,
            positions_total: job.progress.total,
            method: &job.method,
            tags: &job.tags,
            attempt: job.attempts_counted,
            submitted_at: job.submitted_at,
            started_at: job.started_at,
            finished_at: job.finished_at,
            wall_time_seconds: job.elapsed.map(|time| time.as_secs_f64()),
            keep: Some(job.keep).filter(|keep| *keep != Kept::Results),
            problem: job
                .problem
                .clone()
                .map(|problem| with_public_type(problem, &edge.public_url)),
            links: Links::new(job, edge),
            submission: None,
            results: None,
        }
    }

    /// The whole view, with the submission, which is JSON.
    pub(super) fn whole(job: &'a Job, submission: &'a str, edge: &Edge) -> Self {
        Self {
            // It is JSON as it stands: a look at a job need not take it apart and put it together again.
            submission: serde_json::from_str(submission).ok(),
            ..Self::new(job, edge)
        }
    }

    /// The small view with the results, for those who waited for them.
    pub(super) fn with_results(job: &'a Job, results: Option<Box<RawValue>>, edge: &Edge) -> Self {
        Self {
            results,
            ..Self::new(job, edge)
        }
    }

    /// The document.
    pub(super) fn to_json(&self) -> Bytes {
        serde_json::to_vec(self)
            .expect("a view is plain data")
            .into()
    }
}

impl Links {
    fn new(job: &Job, edge: &Edge) -> Self {
        let self_ = edge.job(job.id);
        Self {
            results: format!("{self_}/results"),
            events: format!("{self_}/events"),
            cancel: (!job.status.has_ended()).then(|| format!("{self_}/cancel")),
            same_as: job.same_as.map(|id| edge.job(id)),
            study: job.study.map(|id| edge.study(id)),
            self_,
        }
    }
}

impl Edge {
    /// The address of a job.
    pub(super) fn job(&self, id: Uuid) -> String {
        format!("{}/v1/jobs/{id}", self.public_url)
    }
}

/// A stored problem knows no address; its link gets one when it is served.
pub(super) fn with_public_type(mut problem: Value, public_url: &str) -> Value {
    if let Some(Value::String(type_)) = problem.get_mut("type") {
        type_.insert_str(0, public_url);
    }
    problem
}
