//! A job as clients see it.

use axum::body::Bytes;
use jiff::Timestamp;
use meshwright_wire::declare::document;
use meshwright_wire::{Kept, Status, method_schema};
use serde_json::Value;
use serde_json::value::RawValue;
use uuid::Uuid;

use super::edge::Edge;
use crate::jobs::Job;

document! {
    /// A job: one submission, its state, and links to its parts.
    pub(super) struct JobView<'a> as Job view of (job: &'a Job, edge: &Edge) {
        /// The id of the job.
        id: Uuid = job.id,
        status: Status = job.status,
        /// Mesh positions solved, in whole percent of those to solve. 100 means all.
        #[schema(minimum = 0, maximum = 100)]
        progress_percent: u8 = job.progress.percent(),
        /// Mesh positions solved so far, over all torques.
        positions_done: u64 = job.progress.done,
        /// Mesh positions to solve, over all torques.
        positions_total: u64 = job.progress.total,
        /// The method of the submission.
        #[schema(schema_with = method_schema)]
        method: &'a str = &job.method,
        /// The tags of the submission.
        tags: &'a [String] = &job.tags,
        /// How often the job was begun, attempts that ended by no fault of its own aside. A job that ends its process is begun
        /// three times at most.
        attempt: i64 = job.attempts_counted,
        /// The user of the client who submitted it (`Meshwright-User`, or the claim of a token); null where the client names none.
        submitted_by: Option<&'a str> = job.submitted_by.as_deref(),
        /// When the job was submitted (UTC).
        submitted_at: Timestamp = job.submitted_at,
        /// When the computation began (UTC); null while the job waits.
        started_at: Option<Timestamp> = job.started_at,
        /// When the job ended (UTC); null until then.
        finished_at: Option<Timestamp> = job.finished_at,
        /// Time of the computation in seconds; null until the job has ended.
        wall_time_seconds: Option<f64> = job.elapsed.map(|time| time.as_secs_f64()),
        /// `statistics` where the study of the job keeps no more of its results; absent where they are kept whole. They can be
        /// had by submitting the design alone.
        #[schema(example = "statistics")]
        keep?: Kept = Some(job.keep).filter(|keep| *keep != Kept::Results),
        /// `administrator` where an administrator of the service dismissed the job; absent elsewhere.
        #[schema(example = "administrator")]
        dismissed_by?: &'a str = job.dismissed_by.as_deref(),
        /// Of a failed job: why.
        #[schema(value_type = Option<meshwright_wire::Problem>)]
        problem?: Value = job
            .problem
            .clone()
            .map(|problem| with_public_type(problem, &edge.public_url)),
        links: Links = Links::of(job, edge),
        /// The submission with every default filled in. Absent in lists.
        #[schema(value_type = Option<meshwright_wire::Submission>)]
        submission?: &'a RawValue = None,
        /// The results, in the answer to a submission with `Prefer: wait` whose job has ended in time. Absent elsewhere: they stand at
        /// `links.results`.
        #[schema(value_type = Option<meshwright_wire::Results>)]
        results?: Box<RawValue> = None,
    }
}

document! {
    /// Links of a job.
    pub(super) struct Links as Links view of (job: &Job, edge: &Edge) with {
        let address = edge.job(job.id);
    } {
        /// The job.
        #[serde(rename = "self")]
        self_: String = address.clone(),
        /// Its results.
        results: String = format!("{address}/results"),
        /// Its events, as they happen.
        events: String = format!("{address}/events"),
        /// Where to cancel it, by POST; absent when it has ended.
        cancel?: String = (!job.status.has_ended()).then(|| format!("{address}/cancel")),
        /// The earlier job whose results this one was given.
        same_as?: String = job.same_as.map(|id| edge.job(id)),
        /// The study that it computes a design of.
        study?: String = job.study.map(|id| edge.study(id)),
    }
}

impl<'a> JobView<'a> {
    /// The whole view, with the submission, which is JSON.
    pub(super) fn whole(job: &'a Job, submission: &'a str, edge: &Edge) -> Self {
        Self {
            // The text is JSON as it stands; a look at a job need not parse and write it.
            submission: serde_json::from_str(submission).ok(),
            ..Self::of(job, edge)
        }
    }

    /// The small view with the results, for those who waited for them.
    pub(super) fn with_results(job: &'a Job, results: Option<Box<RawValue>>, edge: &Edge) -> Self {
        Self {
            results,
            ..Self::of(job, edge)
        }
    }

    /// The document.
    pub(super) fn to_json(&self) -> Bytes {
        serde_json::to_vec(self)
            .expect("a view is plain data")
            .into()
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
