//! Submitting a job.

use axum::extract::State;
use axum::http::header::{ACCEPT_ENCODING, CONTENT_TYPE, HeaderValue, LOCATION, RETRY_AFTER};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use utoipa::ToSchema;

use super::app::App;
use super::client::Client;
use super::document::Document;
use super::parameters::IdempotencyKey;
use super::prefer::Wait;
use super::results;
use super::view::JobView;
use crate::jobs::{Job, Submitted};
use crate::wire::{Problem, Results, Submission};

/// What a submission is answered with when the job has ended: its results, or the job.
#[derive(ToSchema)]
#[schema(title = "SubmitAnswer")]
#[serde(untagged)]
#[expect(dead_code, reason = "it stands for the two in the OpenAPI document")]
pub(super) enum SubmitAnswer<'a> {
    /// The results of the job.
    Results(Box<Results>),
    /// The job.
    Job(Box<JobView<'a>>),
}

/// Submit a job
///
/// Queues the computation of a gear pair and answers at once with the job, before it is computed. The job is on the
/// disk by then. A submission equal to one whose job is successful gets a new job that is successful at once.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "Jobs", operation_id = "submit_job",
    request_body(content = Submission, content_type = "application/json", description = "The submission."),
    params(
        ("Idempotency-Key" = Option<String>, Header, min_length = 1, max_length = 255, pattern = "^[!-~]([ -~]*[!-~])?$", description = "A word of the client's choice, 1 to 255 characters, kept for a day: the same key and submission get the same job, however often they are sent."),
        ("Prefer" = Option<String>, Header, description = "`wait=N`: answer with the results if the job ends within N seconds (60 at most)."),
    ),
    responses(
        (status = 202, description = "The job is queued, or is known and successful already.", body = JobView, headers(
            ("Location" = String, description = "The address of the job."),
            ("Retry-After" = u32, description = "Seconds after which it is worth looking."),
        )),
        (status = 200, description = "With `Prefer: wait`, the results of a job that ended in time. With a repeated `Idempotency-Key`, the job that has ended meanwhile.", body = SubmitAnswer),
        (status = 400, description = "The body is no JSON, or a header is not understood.", body = Problem, content_type = "application/problem+json"),
        (status = 408, description = "The body came too slowly.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "With `Prefer: wait`: the job failed or was cancelled in time.", body = Problem, content_type = "application/problem+json"),
        (status = 413, description = "The body has more than 1 MiB.", body = Problem, content_type = "application/problem+json"),
        (status = 415, description = "The body is not declared as JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "The submission cannot be computed; `errors` says which field is why. Or the key was used for another submission.", body = Problem, content_type = "application/problem+json"),
        (status = 429, description = "More jobs of this client wait than may.", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The queue is full, nothing can be stored, or the service is shutting down. Try again after `Retry-After` seconds.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn submit(
    State(app): State<App>,
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    wait: Wait,
    headers: HeaderMap,
    Document(document): Document,
) -> Result<Response, Problem> {
    // A condition would be about an answer that the client had before it submitted.
    let headers: HeaderMap = headers
        .get(ACCEPT_ENCODING)
        .map(|accepted| (ACCEPT_ENCODING, accepted.clone()))
        .into_iter()
        .collect();
    let submission = Submission::parse(&document)?;
    let Submitted { mut job, repeated } = app.jobs.submit(&client.0, &submission, key).await?;

    let wait = wait.grant(&app.door, client.name());
    let mut response = if let Some(patience) = wait.patience() {
        job = app.jobs.wait(client.name(), job.id, patience).await?;
        if job.status.has_ended() {
            results::answer(&app, &job, &headers)
                .await
                .unwrap_or_else(Problem::into_response)
        } else {
            small_view(&app, &job, StatusCode::ACCEPTED)
        }
    } else if repeated && job.status.has_ended() {
        small_view(&app, &job, StatusCode::OK)
    } else {
        small_view(&app, &job, StatusCode::ACCEPTED)
    };
    response
        .headers_mut()
        .insert(LOCATION, address(&app.edge.job(job.id)));
    wait.acknowledge(response.headers_mut());
    Ok(response)
}

pub(super) fn small_view(app: &App, job: &Job, status: StatusCode) -> Response {
    let body = JobView::new(job, &app.edge).to_json();
    let mut response = (status, [(CONTENT_TYPE, "application/json")], body).into_response();
    if !job.status.has_ended() {
        response
            .headers_mut()
            .insert(RETRY_AFTER, HeaderValue::from_static("1"));
    }
    response
}

pub(super) fn address(url: &str) -> HeaderValue {
    HeaderValue::from_str(url)
        .expect("the public address was checked at the start, an id is hexadecimal")
}
