//! The results of a job: the very text that was stored, or the same with points between positions.

use axum::http::HeaderMap;
use axum::http::header::{CONTENT_ENCODING, CONTENT_LOCATION, CONTENT_TYPE, HeaderValue, VARY};
use axum::response::{IntoResponse, Response};
use meshwright_connections::{Keep, Tag, takes_gzip};
use meshwright_wire::{Code, Problem, Results};
use serde::Deserialize;
use utoipa::IntoParams;

use super::app::App;
use super::blocking::{blocking, goes_on};
use super::client::Client;
use super::parameters::{IfNoneMatch, JobId, Parameters};
use super::problem::{Refusal, of_missing_results};
use crate::jobs::{Document, Job, JobError, Resource as _};

/// Memory of the results' text, its values and what is made of them together, in multiples of the text's size.
pub(super) const TIMES_THE_RESULTS: u64 = 4;

/// Form of the results.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct ResultsParameters {
    /// True puts the points of `between` into the lists of each curve, at their mesh positions: an event stands twice, just before and just behind it. The
    /// largest less the smallest value of a list is then the `peak_to_peak` of the statistics.
    #[param(default = false)]
    between: Option<bool>,
}

/// Get the results
///
/// The results never change, so a client may keep them for good.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results", tag = "Results", operation_id = "get_results",
    params(ResultsParameters, IfNoneMatch),
    responses(
        (status = 200, description = "The results.", body = meshwright_wire::Results),
        (status = 400, description = "A parameter is not understood."),
        (status = 404, description = "There is no such job, or it has not ended; then `Retry-After` says when to ask again. Or `between` is true, and the results are of a version before 0.6, which kept no points."),
        (status = 409, description = "The job failed or was cancelled, and has no results."),
        (status = 410, description = "The study of the job keeps statistics only (`results_not_kept`); submitted alone, the design has results."),
    ),
)]
pub(super) async fn results(
    client: Client,
    JobId(id): JobId,
    Parameters(parameters): Parameters<ResultsParameters>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let job = Job::find(&client.app.jobs, client.name(), id).await?;
    answer(&client.app, &job, &parameters, &request).await
}

/// The results of a job, or why there are none.
pub(super) async fn answer(
    app: &App,
    job: &Job,
    parameters: &ResultsParameters,
    request: &HeaderMap,
) -> Result<Response, Refusal> {
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()).into());
    };
    if parameters.between == Some(true) {
        let made = with_points_between(app, job);
        return Tag::of_hash(hash, "/between")
            .answer(Keep::ForGood, request, made)
            .await;
    }
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

/// The results with points between positions in their lists.
async fn with_points_between(app: &App, job: &Job) -> Result<Response, Refusal> {
    let stored = app.jobs.stored(job).await?;
    let most = TIMES_THE_RESULTS * stored.bytes;
    let memory = app.bodies.for_answer(&job.client, most).await?;
    let document = app.jobs.document_of(job, &stored).await?;
    let made = blocking(&job.client, move |run| -> Result<String, Refusal> {
        let results = read(&document)?;
        goes_on(run)?;
        Ok(with_points(results)?.to_json()?)
    });
    let text = made.await??;
    Ok(([(CONTENT_TYPE, "application/json")], memory.hold(text)).into_response())
}

/// The results as values, if they are of a version that this one reads.
pub(super) fn read(document: &Document) -> Result<Results, Refusal> {
    let text = document.text().map_err(JobError::from)?;
    Results::read(&text).map_err(|error| {
        tracing::warn!(%error, "results are of a version that is not read");
        let detail = "These results are of a version that this one does not read; the whole document has what it has.";
        Problem::new(Code::NotFound, detail).into()
    })
}

/// The results with the points between positions in their lists.
pub(super) fn with_points(results: Results) -> Result<Results, Problem> {
    results.with_points().ok_or_else(|| {
        let detail = "These results are of a version before 0.6, which kept no points between positions; submit the pair again.";
        Problem::new(Code::NotFound, detail)
    })
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
