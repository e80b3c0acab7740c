//! Looking at jobs, cancelling and deleting them.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, HeaderMap, HeaderValue, LINK, RETRY_AFTER};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

use super::app::App;
use super::client::Client;
use super::conditional::Tag;
use super::parameters::{Parameters, invalid, job_id};
use super::prefer::Wait;
use super::view::{JobView, ListView};
use crate::jobs::{Filter, Membership, Status};
use crate::wire::Problem;

/// A list has so many jobs unless it is told.
const USUAL_LIMIT: u32 = 50;
/// A list has so many jobs at most, and names so many ids.
const LARGEST_LIMIT: u32 = 200;

/// What to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ListParameters {
    /// Jobs in this state, or in one of these, separated by commas.
    #[param(example = "accepted,running")]
    status: Option<String>,
    /// Jobs with this tag.
    tag: Option<String>,
    /// Jobs of these ids, separated by commas; those that do not exist are left out. 200 at most.
    ids: Option<String>,
    /// Jobs of the study of this id; `none` for jobs that belong to no study.
    study: Option<String>,
    /// So many jobs at most.
    #[param(minimum = 1, maximum = 200, default = 50)]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    cursor: Option<String>,
}

impl ListParameters {
    fn limit(&self, filter: &Filter) -> Result<u32, Problem> {
        match (self.limit, &filter.ids) {
            (Some(limit), _) if (1..=LARGEST_LIMIT).contains(&limit) => Ok(limit),
            (Some(limit), _) => Err(invalid(format!(
                "limit is {limit}; it lies between 1 and {LARGEST_LIMIT}."
            ))),
            // Who names jobs wants them all.
            (None, Some(_)) => Ok(LARGEST_LIMIT),
            (None, None) => Ok(USUAL_LIMIT),
        }
    }

    fn filter(&self) -> Result<Filter, Problem> {
        let status = |word: &str| {
            Status::ALL
                .into_iter()
                .find(|status| status.as_str() == word)
                .ok_or_else(|| invalid(format!("status {word:?} is none of accepted, running, successful, failed, dismissed.")))
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
            after: self
                .cursor
                .as_ref()
                .map(|cursor| cursor.parse())
                .transpose()
                .map_err(|_| {
                    invalid(
                        "cursor is not one that a list has given; take it from next as it stands.",
                    )
                })?,
        })
    }

    /// The address of the next page.
    fn next(&self, cursor: &str, public_url: &str) -> String {
        let mut query = url_encoded(&[
            ("status", self.status.as_deref()),
            ("tag", self.tag.as_deref()),
            ("ids", self.ids.as_deref()),
            ("study", self.study.as_deref()),
            (
                "limit",
                self.limit.map(|limit| limit.to_string()).as_deref(),
            ),
            ("cursor", Some(cursor)),
        ]);
        query.insert_str(0, &format!("{public_url}/v1/jobs?"));
        query
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

fn url_encoded(pairs: &[(&str, Option<&str>)]) -> String {
    let encode = |text: &str| {
        text.bytes()
            .map(|byte| match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => {
                    char::from(byte).to_string()
                }
                _ => format!("%{byte:02X}"),
            })
            .collect::<String>()
    };
    let given = pairs
        .iter()
        .filter_map(|(name, value)| value.map(|value| format!("{name}={}", encode(value))));
    given.collect::<Vec<_>>().join("&")
}

/// List jobs
///
/// Newest first, page by page. With `ids` it is the way to look at many jobs at once.
#[utoipa::path(
    get, path = "/v1/jobs", tag = "Jobs", operation_id = "list_jobs",
    params(ListParameters),
    responses(
        (status = 200, description = "The jobs.", body = ListView, headers(
            ("Link" = String, description = "With rel=next, the address of the next page; absent at the end."),
        )),
        (status = 400, description = "A parameter is not understood.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn list(
    State(app): State<App>,
    Client(client): Client,
    Parameters(parameters): Parameters<ListParameters>,
) -> Result<Response, Problem> {
    let filter = parameters.filter()?;
    let page = app
        .jobs
        .list(&client, &filter, parameters.limit(&filter)?)
        .await?;

    let items = page
        .items
        .iter()
        .map(|job| JobView::new(job, &app.edge))
        .collect();
    let next = page.next.map(|cursor| cursor.to_string());
    let link = next.as_ref().map(|cursor| {
        format!(
            "<{}>; rel=\"next\"",
            parameters.next(cursor, &app.edge.public_url)
        )
    });
    let mut response = Json(ListView { items, next }).into_response();
    if let Some(link) = link.and_then(|link| HeaderValue::try_from(link).ok()) {
        response.headers_mut().insert(LINK, link);
    }
    Ok(response)
}

/// Look at a job
///
/// Its state, progress and submission. With `If-None-Match` it costs nothing while nothing changes.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "Jobs", operation_id = "get_job",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the job."),
        ("Prefer" = Option<String>, Header, description = "`wait=N`: answer when the job has ended, or after N seconds (60 at most)."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The job.", body = JobView, headers(
            ("ETag" = String, description = "Stands for this answer."),
            ("Retry-After" = u32, description = "Until the job has ended: seconds after which it is worth looking again."),
        )),
        (status = 304, description = "Nothing has changed since the answer of that `ETag`."),
        (status = 404, description = "There is no such job.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn show(
    State(app): State<App>,
    Client(client): Client,
    wait: Wait,
    Path(id): Path<String>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let id = job_id(&id)?;
    let job = match wait.granted() {
        Some(patience) => app.jobs.wait(&client, id, patience).await?,
        None => app.jobs.find(&client, id).await?,
    };

    let body = JobView::whole(&job, &app.edge).to_json();
    let tag = Tag::of(&body);
    let mut response = if tag.is_known(&request) {
        tag.not_modified()
    } else {
        ([(CONTENT_TYPE, "application/json")], body).into_response()
    };
    let headers = response.headers_mut();
    tag.mark(headers);
    wait.acknowledge(headers);
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    if !job.status.has_ended() {
        headers.insert(RETRY_AFTER, HeaderValue::from_static("1"));
    }
    Ok(response)
}

/// Cancel a job
///
/// A waiting job is taken from the queue, a running one stops within a fraction of a second. Cancelling again
/// changes nothing.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "Jobs", operation_id = "cancel_job",
    params(("id" = String, Path, format = "uuid", description = "The id of the job.")),
    responses(
        (status = 202, description = "The job is dismissed.", body = JobView),
        (status = 404, description = "There is no such job.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The job is successful or failed already.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn cancel(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let job = app.jobs.cancel(&client, job_id(&id)?).await?;
    Ok((StatusCode::ACCEPTED, Json(JobView::new(&job, &app.edge))).into_response())
}

/// Delete a job
///
/// Removes a job that does not run, with its submission and results.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "Jobs", operation_id = "delete_job",
    params(("id" = String, Path, format = "uuid", description = "The id of the job.")),
    responses(
        (status = 204, description = "The job is gone."),
        (status = 404, description = "There is no such job.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The job is running; cancel it first.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn delete(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<StatusCode, Problem> {
    app.jobs.delete(&client, job_id(&id)?).await?;
    Ok(StatusCode::NO_CONTENT)
}
