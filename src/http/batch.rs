//! Many submissions in one request.

use axum::Json;
use axum::http::StatusCode;
use axum::http::header::{HeaderValue, RETRY_AFTER};
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
use super::parameters::{IdempotencyKey, User};
use super::problem::{Refusal, retry_after};
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

/// Outcomes of the submissions of a batch, in their order.
#[derive(Serialize, ToSchema)]
#[schema(title = "BatchAnswer")]
pub(super) struct BatchAnswer<'a> {
    /// Jobs that were taken, those of an earlier batch with the same key among them.
    taken: usize,
    /// Submissions that were refused.
    refused: usize,
    /// One item for each submission.
    items: Vec<BatchItem<'a>>,
}

/// Outcome of one submission: a job, or a problem.
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
/// Up to 100 submissions at once. Each is taken or refused by itself, as if it had been sent alone. The answer has an item for each, in their order. A batch of
/// which no submission is taken is refused as a whole: as a single job where the queue has no room or nothing can be stored, with `Retry-After`, and otherwise
/// with the errors of its submissions. With an `Idempotency-Key` the batch may be repeated: no submission is taken twice.
#[utoipa::path(
    post, path = "/v1/jobs/batch", tag = "Jobs", operation_id = "submit_batch",
    request_body(content = Batch, content_type = "application/json", description = "The submissions."),
    params(IdempotencyKey, User),
    responses(
        (status = 202, description = "At least one submission is taken.", body = BatchAnswer, headers(
            ("Retry-After" = u32, description = "Seconds after which it is worth looking at the jobs, or sending again those submissions that found no room."),
        )),
        JsonBody<4>,
        (status = 422, description = "The body is no batch, has more than 100 submissions, or none that can be computed; `errors` says which field is why."),
        (status = 429, description = "Nothing was taken: more jobs of this client wait than may. Try again after `Retry-After` seconds."),
        (status = 503, description = "Nothing was taken: the queue is full, nothing can be stored, or too many batches come at once. Try again after `Retry-After` seconds."),
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
    if outcomes.iter().all(Result::is_err) {
        let problems: Vec<Problem> = outcomes.into_iter().filter_map(Result::err).collect();
        return Err(nothing_taken(&problems).into());
    }

    let edge = &client.app.edge;
    let items: Vec<BatchItem<'_>> = outcomes
        .iter()
        .map(|outcome| BatchItem {
            job: outcome
                .as_ref()
                .ok()
                .map(|submitted| JobView::of(&submitted.record, edge)),
            problem: outcome.as_ref().err().map(|problem| {
                let problem = serde_json::to_value(problem).expect("a problem is plain data");
                with_public_type(problem, &edge.public_url)
            }),
        })
        .collect();
    let taken = items.iter().filter(|item| item.job.is_some()).count();
    let refused = items.len() - taken;
    let jobs = outcomes.iter().flatten().map(|taken| &taken.record);
    let waiting = jobs.filter(|job| !job.status.has_ended());
    let made = Made(waiting.map(|job| job.id).collect());
    let mut problems = outcomes.iter().filter_map(|outcome| outcome.as_ref().err());
    let wait = problems.find_map(|problem| retry_after(problem.code));
    let wait = HeaderValue::from_static(wait.unwrap_or("1"));
    let answer = BatchAnswer {
        taken,
        refused,
        items,
    };
    let mut response = (StatusCode::ACCEPTED, [(RETRY_AFTER, wait)], Json(answer)).into_response();
    response.extensions_mut().insert(made);
    Ok(response)
}

/// The refusal of a batch of which nothing was taken, whose submissions have these problems: the first of them that may be over by itself, or
/// all fields that are wrong.
fn nothing_taken(problems: &[Problem]) -> Problem {
    let errors = problems.iter().enumerate().flat_map(|(i, problem)| {
        let place = format!("/submissions/{i}");
        let whole = FieldError::new("", problem.code, &*problem.detail);
        let errors = match problem.errors.as_slice() {
            [] => vec![whole],
            errors => errors.to_vec(),
        };
        errors.into_iter().map(move |error| FieldError {
            pointer: format!("{place}{}", error.pointer),
            ..error
        })
    });
    let errors = errors.take(MOST_ERRORS).collect();
    let is_ours = |problem: &&Problem| problem.status == 429 || problem.status >= 500;
    match problems.iter().find(is_ours) {
        Some(problem) => Problem {
            errors,
            ..problem.clone()
        },
        None => Problem::of_fields(errors),
    }
}

/// The key of a submission of a batch: none that a single submission can have, because no header has a line's end in it.
fn key_within(key: &str, place: usize) -> String {
    format!("{key}\n{place}")
}

fn read<const MIB: usize>(
    document: &JsonBody<MIB>,
    run: &Run,
) -> Result<Vec<Result<Submission, Problem>>, Problem> {
    let batch: Batch<'_> = document.parse()?;
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
    let submissions = batch.submissions.iter().map(|submission| {
        goes_on(run)?;
        Ok(Submission::parse(submission.get().as_bytes()))
    });
    submissions.collect()
}
