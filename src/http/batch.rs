//! Many submissions in one request.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use futures_util::future::join_all;
use meshwright_engine::run::Run;
use meshwright_wire::{Code, FieldError, Problem, Submission};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::blocking::{blocking, goes_on};
use super::body::JsonBody;
use super::client::Client;
use super::headers::Made;
use super::parameters::IdempotencyKey;
use super::problem::Refusal;
use super::view::{JobView, with_public_type};
use crate::jobs::{Job, Submitted};

/// The most submissions of a batch.
pub(super) const MOST_IN_BATCH: usize = 100;

/// Errors beyond this number are not told.
const MOST_ERRORS: usize = 50;

/// Submissions that stand side by side. Unlike the designs of a study they have nothing in common.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(title = "Batch")]
pub(super) struct Batch<'a> {
    /// The submissions, each as for `POST /v1/jobs`.
    #[serde(borrow)]
    #[schema(value_type = Vec<Submission>, min_items = 1, max_items = 100)]
    submissions: Vec<&'a RawValue>,
}

/// What came of the submissions of a batch, in their order.
#[derive(Serialize, ToSchema)]
#[schema(title = "BatchAnswer")]
pub(super) struct BatchAnswer<'a> {
    /// Jobs that were taken, those of an earlier batch with the same key among them.
    taken: usize,
    /// One item for each submission.
    items: Vec<BatchItem<'a>>,
}

/// What came of one submission: a job, or a problem.
#[derive(Serialize, ToSchema)]
#[schema(title = "BatchItem")]
pub(super) struct BatchItem<'a> {
    /// The job, if it was taken.
    job: Option<JobView<'a>>,
    /// Why it was not taken; its pointers lead into the submission.
    #[schema(value_type = Option<Problem>)]
    problem: Option<serde_json::Value>,
}

/// Submit a batch of jobs
///
/// Up to 100 submissions at once. A batch with a field that no submission may have is refused as a whole, with its place.
/// Otherwise each submission is taken or refused by itself, as if it had been sent alone: teeth that do not reach each other,
/// a queue that is full. The answer says what came of each, in their order. With an `Idempotency-Key` the batch may be repeated: what was taken is not taken twice.
#[utoipa::path(
    post, path = "/v1/jobs/batch", tag = "Jobs", operation_id = "submit_batch",
    request_body(content = Batch, content_type = "application/json", description = "The submissions."),
    params(IdempotencyKey),
    responses(
        (status = 202, description = "What came of each submission. None may have been taken.", body = BatchAnswer),
        JsonBody<4>,
        (status = 422, description = "The body is no batch, has more than 100 submissions, or fields that no submission may have; `errors` says which."),
        (status = 503, description = "Too many batches come at once. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn submit(
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    document: JsonBody<4>,
) -> Result<Response, Refusal> {
    let read = blocking(client.name(), move |run| read(&document, run)).await??;
    let jobs = read.into_iter().enumerate().map(|(i, submission)| {
        let key = key.as_ref().map(|key| key_within(key, i));
        let client = &client;
        async move {
            let submission = submission?;
            let submitted = client
                .app
                .jobs
                .submit(&client.member, &submission, key)
                .await;
            submitted.map_err(Problem::from)
        }
    });
    // Submissions that arrive together share a commit.
    let outcomes: Vec<Result<Submitted<Job>, Problem>> = join_all(jobs).await;

    let item = |outcome: &'_ Result<Submitted<Job>, Problem>| match outcome {
        Ok(submitted) => (Some(submitted.record.clone()), None),
        Err(problem) => (None, Some(problem.clone())),
    };
    let outcomes: Vec<_> = outcomes.iter().map(item).collect();
    let items: Vec<BatchItem<'_>> = outcomes
        .iter()
        .map(|(job, problem)| BatchItem {
            job: job.as_ref().map(|job| JobView::of(job, &client.app.edge)),
            problem: problem.as_ref().map(|problem| {
                let problem = serde_json::to_value(problem).expect("a problem is plain data");
                with_public_type(problem, &client.app.edge.public_url)
            }),
        })
        .collect();
    let taken = items.iter().filter(|item| item.job.is_some()).count();
    let made = outcomes.iter().filter_map(|(job, _)| job.as_ref());
    let made = made.filter(|job| !job.status.has_ended()).map(|job| job.id);
    let made = Made(made.collect());
    let mut response = (StatusCode::ACCEPTED, Json(BatchAnswer { taken, items })).into_response();
    response.extensions_mut().insert(made);
    Ok(response)
}

/// The key of a submission of a batch: none that a single submission can have, because no header has a line's end in it.
fn key_within(key: &str, place: usize) -> String {
    format!("{key}\n{place}")
}

fn read<const MIB: usize>(
    document: &JsonBody<MIB>,
    run: &Run,
) -> Result<Vec<Result<Submission, Problem>>, Problem> {
    let batch: Batch<'_> = document.parse("batch of submissions")?;
    let count = batch.submissions.len();
    if !(1..=MOST_IN_BATCH).contains(&count) {
        let detail = format!(
            "/submissions has {count} submissions; a batch has 1 to {MOST_IN_BATCH}. POST /v1/studies takes thousands of variants of one."
        );
        let nearest = count.clamp(1, MOST_IN_BATCH) as f64;
        let code = if count == 0 {
            Code::OutOfRange
        } else {
            Code::TooLarge
        };
        let error = FieldError::new("/submissions", code, detail).nearest(nearest);
        return Err(Problem::of_fields(vec![error]));
    }
    let wrong: Vec<FieldError> = batch
        .submissions
        .iter()
        .enumerate()
        .take_while(|_| run.check().is_ok())
        .flat_map(|(i, submission)| {
            let errors = Submission::field_errors(submission.get().as_bytes());
            errors.into_iter().map(move |error| FieldError {
                pointer: format!("/submissions/{i}{}", error.pointer),
                ..error
            })
        })
        .take(MOST_ERRORS)
        .collect();
    if !wrong.is_empty() {
        return Err(Problem::of_fields(wrong));
    }
    let read = batch.submissions.iter().map(|submission| {
        goes_on(run)?;
        Ok(Submission::parse(submission.get().as_bytes()))
    });
    read.collect()
}
