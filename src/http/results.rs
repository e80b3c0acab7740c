//! The results of a job: the very text that was stored.

use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::http::header::{CACHE_CONTROL, CONTENT_LOCATION, CONTENT_TYPE, HeaderValue};
use axum::response::{IntoResponse, Response};

use super::app::App;
use super::client::Client;
use super::conditional::Tag;
use super::parameters::job_id;
use super::problem::of_missing_results;
use crate::jobs::Job;
use crate::wire::Problem;

/// Get the results
///
/// The results never change, so a client may keep them for good.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results", tag = "Results", operation_id = "get_results",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the job."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The results.", body = crate::wire::Results, headers(
            ("ETag" = String, description = "Stands for these results."),
        )),
        (status = 304, description = "The client has these results."),
        (status = 404, description = "There is no such job, or it has not ended; then `Retry-After` says when to ask again.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The job failed or was cancelled, and has no results.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn results(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let job = app.jobs.find(&client, job_id(&id)?).await?;
    answer(&app, &job, &request).await
}

/// The results of a job, or why there are none.
pub(super) async fn answer(app: &App, job: &Job, request: &HeaderMap) -> Result<Response, Problem> {
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()));
    };
    let tag = Tag::of_hash(hash, "");
    let mut response = if tag.is_known(request) {
        tag.not_modified()
    } else {
        let document = app.jobs.document(job).await?;
        ([(CONTENT_TYPE, "application/json")], document).into_response()
    };
    keep_for_good(&tag, response.headers_mut());
    if let Ok(address) = HeaderValue::try_from(format!("{}/results", app.edge.job(job.id))) {
        response.headers_mut().insert(CONTENT_LOCATION, address);
    }
    Ok(response)
}

/// Results never change under their address.
pub(super) fn keep_for_good(tag: &Tag, headers: &mut HeaderMap) {
    tag.mark(headers);
    headers.insert(
        CACHE_CONTROL,
        HeaderValue::from_static("private, max-age=31536000, immutable"),
    );
}
