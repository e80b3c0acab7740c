//! Looking at jobs, cancelling and deleting them.

use axum::Json;
use axum::http::StatusCode;
use axum::http::header::HeaderMap;
use axum::response::{IntoResponse, Response};
use meshwright_connections::Keep;
use meshwright_wire::Problem;
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

use super::answer::{json, tag_of_parts, tell_when_to_return};
use super::blocking::turn_to_read;
use super::client::Client;
use super::page::{self, LARGEST_LIMIT, Page, USUAL_LIMIT};
use super::parameters::{IfNoneMatch, JobId, Parameters, invalid};
use super::prefer::Wait;
use super::problem::Refusal;
use super::view::JobView;
use crate::jobs::{Filter, Membership, Status};

/// What to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ListParameters {
    /// Jobs in this state, or in one of these, separated by commas.
    #[param(
        example = "accepted,running",
        pattern = "^((accepted|running|successful|failed|dismissed)(,(accepted|running|successful|failed|dismissed))*)?$"
    )]
    status: Option<String>,
    /// Jobs with this tag.
    #[param(pattern = "^[^\\x00]*$")]
    tag: Option<String>,
    /// Jobs of these ids, separated by commas; those that do not exist are left out. 200 at most.
    #[param(
        pattern = "^([0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}(,[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12}){0,199})?$"
    )]
    ids: Option<String>,
    /// Jobs of the study of this id; `none` for jobs that belong to no study.
    #[param(
        example = "none",
        pattern = "^(none|[0-9a-fA-F]{8}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{4}-[0-9a-fA-F]{12})$"
    )]
    study: Option<String>,
    /// Jobs from the first one on that was submitted at this instant or later (RFC 3339).
    #[param(format = DateTime, example = "2026-01-01T00:00:00Z")]
    submitted_since: Option<String>,
    /// Jobs before the first one that was submitted at this instant or later (RFC 3339).
    #[param(format = DateTime, example = "2100-01-01T00:00:00Z")]
    submitted_before: Option<String>,
    /// So many jobs at most.
    #[param(minimum = 1, maximum = 200, default = 50, example = 20)]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    #[param(pattern = "^c[1-9a-f][0-9a-f]{0,14}$")]
    cursor: Option<String>,
}

impl ListParameters {
    fn limit(&self) -> Result<u32, Problem> {
        // Who names jobs wants them all.
        let usual = if self.ids.is_some() {
            LARGEST_LIMIT
        } else {
            USUAL_LIMIT
        };
        page::limit(self.limit, usual)
    }

    fn filter(&self) -> Result<Filter, Problem> {
        let status = |word: &str| {
            Status::of_word(word).ok_or_else(|| {
                invalid(format!(
                    "status {word:?} is none of accepted, running, successful, failed, dismissed."
                ))
            })
        };
        let id = |word: &str| {
            word.parse::<Uuid>()
                .map_err(|_| invalid(format!("ids: {word:?} is not an id.")))
        };
        let ids = self
            .ids
            .as_ref()
            .map(|ids| words(ids).map(id).collect::<Result<Vec<_>, _>>())
            .transpose()?;
        if ids
            .as_ref()
            .is_some_and(|ids| ids.len() > LARGEST_LIMIT as usize)
        {
            return Err(invalid(format!(
                "ids names more than {LARGEST_LIMIT} jobs."
            )));
        }
        Ok(Filter {
            statuses: self
                .status
                .as_ref()
                .map(|list| words(list).map(status).collect())
                .transpose()?,
            tag: self.tag.clone(),
            ids,
            study: self.study.as_deref().map(membership).transpose()?,
            span: page::span(
                self.submitted_since.as_deref(),
                self.submitted_before.as_deref(),
            )?,
            after: page::cursor(self.cursor.as_deref())?,
        })
    }

    /// What the address of the next page has in common with this one's.
    fn pairs<'a>(&'a self, limit: &'a str) -> [(&'static str, Option<&'a str>); 7] {
        [
            ("status", self.status.as_deref()),
            ("tag", self.tag.as_deref()),
            ("ids", self.ids.as_deref()),
            ("study", self.study.as_deref()),
            ("submitted_since", self.submitted_since.as_deref()),
            ("submitted_before", self.submitted_before.as_deref()),
            ("limit", Some(limit)),
        ]
    }
}

fn membership(word: &str) -> Result<Membership, Problem> {
    if word == "none" {
        return Ok(Membership::Alone);
    }
    let id = word.parse();
    id.map(Membership::Of)
        .map_err(|_| invalid(format!("study: {word:?} is neither an id nor none.")))
}

fn words(list: &str) -> impl Iterator<Item = &str> {
    list.split(',')
        .map(str::trim)
        .filter(|word| !word.is_empty())
}

/// List jobs
///
/// Newest first, page by page. With `ids` it is the way to look at many jobs at once.
#[utoipa::path(
    get, path = "/v1/jobs", tag = "Jobs", operation_id = "list_jobs",
    params(ListParameters),
    responses(
        (status = 200, description = "The jobs.", body = Page<JobView>, headers(
            ("Link" = String, description = "With rel=next, the address of the next page; absent at the end."),
        )),
        (status = 400, description = "A parameter is not understood."),
    ),
)]
pub(super) async fn list(
    client: Client,
    Parameters(parameters): Parameters<ListParameters>,
) -> Result<Response, Refusal> {
    let limit = parameters.limit()?;
    let app = &client.app;
    let _turn = turn_to_read(client.name()).await;
    let found = app
        .jobs
        .list(client.name(), &parameters.filter()?, limit)
        .await?;
    let limit = limit.to_string();
    let pairs = parameters.pairs(&limit);
    let view = |job| JobView::of(job, &app.edge);
    Ok(page::answer(&app.edge, "/v1/jobs", &pairs, &found, view))
}

/// Look at a job
///
/// Its state, progress and submission. With `If-None-Match` it costs nothing while nothing changes.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "Jobs", operation_id = "get_job",
    params(Wait, IfNoneMatch),
    responses(
        (status = 200, description = "The job.", body = JobView, headers(
            ("Retry-After" = u32, description = "Until the job has ended: seconds after which it is worth looking again."),
        )),
    ),
)]
pub(super) async fn show(
    client: Client,
    wait: Wait,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let wait = wait.grant(&client);
    let job = match wait.patience() {
        Some(patience) => {
            let job = client.app.jobs.wait(client.name(), id, patience).await?;
            client.check_again().await?;
            job
        }
        None => client.app.jobs.find(client.name(), id).await?,
    };

    // The submission never changes; what has not changed is answered without reading it.
    let small = JobView::of(&job, &client.app.edge).to_json();
    let tag = tag_of_parts(&["job", &String::from_utf8_lossy(&small)]);
    let whole = async {
        let submission = client.app.jobs.submission(id).await?;
        let body = JobView::whole(&job, &submission, &client.app.edge).to_json();
        Ok::<_, Refusal>(json(body))
    };
    let mut response = tag.answer(Keep::AskAgain, &request, whole).await?;
    wait.acknowledge(response.headers_mut());
    tell_when_to_return(job.status.has_ended(), &mut response);
    Ok(response)
}

/// Cancel a job
///
/// A waiting job is taken from the queue, a running one stops within a fraction of a second. Cancelling again
/// changes nothing.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "Jobs", operation_id = "cancel_job",
    responses(
        (status = 202, description = "The job is dismissed.", body = JobView),
        (status = 409, description = "The job is successful or failed already."),
    ),
)]
pub(super) async fn cancel(client: Client, JobId(id): JobId) -> Result<Response, Refusal> {
    let job = client.app.jobs.cancel(client.name(), id).await?;
    Ok((
        StatusCode::ACCEPTED,
        Json(JobView::of(&job, &client.app.edge)),
    )
        .into_response())
}

/// Delete a job
///
/// Removes a job that does not run, with its submission and results.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "Jobs", operation_id = "delete_job",
    responses(
        (status = 204, description = "The job is gone."),
        (status = 409, description = "The job is running; cancel it first."),
    ),
)]
pub(super) async fn delete(client: Client, JobId(id): JobId) -> Result<StatusCode, Refusal> {
    client.app.jobs.delete(client.name(), id).await?;
    Ok(StatusCode::NO_CONTENT)
}
