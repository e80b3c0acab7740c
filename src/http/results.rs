//! The results of a job: the very text that was stored.

use axum::http::HeaderMap;
use axum::http::header::{CONTENT_ENCODING, CONTENT_LOCATION, CONTENT_TYPE, HeaderValue, VARY};
use axum::response::{IntoResponse, Response};
use meshwright_connections::{Keep, Tag, takes_gzip};
use meshwright_wire::Problem;

use super::app::App;
use super::blocking::blocking;
use super::client::Client;
use super::parameters::{IfNoneMatch, JobId};
use super::problem::{Refusal, of_missing_results};
use crate::jobs::{Document, Job, JobError, Resource as _};

/// Get the results
///
/// The results never change, so a client may keep them for good.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results", tag = "Results", operation_id = "get_results",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The results.", body = meshwright_wire::Results),
        (status = 404, description = "There is no such job, or it has not ended; then `Retry-After` says when to ask again."),
        (status = 409, description = "The job failed or was cancelled, and has no results."),
        (status = 410, description = "The study of the job keeps statistics only (`results_not_kept`); submitted alone, the design has results."),
    ),
)]
pub(super) async fn results(
    client: Client,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let job = Job::find(&client.app.jobs, client.name(), id).await?;
    answer(&client.app, &job, &request).await
}

/// The results of a job, or why there are none.
pub(super) async fn answer(app: &App, job: &Job, request: &HeaderMap) -> Result<Response, Refusal> {
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()).into());
    };
    let stored = packed_or_plain(app, job, request);
    let mut response = Tag::of_hash(hash, "")
        .answer(Keep::ForGood, request, stored)
        .await?;
    if let Ok(address) = HeaderValue::try_from(format!("{}/results", app.edge.job(job.id))) {
        response.headers_mut().insert(CONTENT_LOCATION, address);
    }
    Ok(response)
}

/// A document is kept packed, and sent so to those who can unpack it: nobody packs it again.
async fn packed_or_plain(app: &App, job: &Job, request: &HeaderMap) -> Result<Response, Refusal> {
    let json = [(CONTENT_TYPE, "application/json")];
    let stored = app.jobs.stored(job).await?;
    // Packed and not, while it is unpacked.
    let memory = app.bodies.for_answer(&job.client, 2 * stored.bytes).await?;
    let document = app.jobs.document_of(job, &stored).await?;
    let packed = document.gzip().map_err(JobError::from)?;
    if let Some(packed) = packed.filter(|_| takes_gzip(request)) {
        let packing = [(CONTENT_ENCODING, "gzip"), (VARY, "accept-encoding")];
        return Ok((json, packing, memory.hold(packed)).into_response());
    }
    let text = text_of(&job.client, document).await?;
    Ok((json, memory.hold(text)).into_response())
}

/// A document of fewer bytes, packed, is unpacked in less time than the way to another thread and back takes.
const SMALL: usize = 8 << 10;

/// The text of a document, unpacked where that holds nobody up.
pub(super) async fn text_of(client: &str, document: Document) -> Result<String, Problem> {
    let text = if document.packed_bytes() <= SMALL {
        document.text()
    } else {
        blocking(client, move |_| document.text()).await?
    };
    Ok(text.map_err(JobError::from)?)
}
