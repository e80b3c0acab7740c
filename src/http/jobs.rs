//! Looking at jobs, cancelling and deleting them.

use axum::body::Bytes;
use axum::http::StatusCode;
use axum::http::header::HeaderMap;
use axum::response::Response;
use meshwright_connections::Tag;
use meshwright_wire::Problem;
use serde::{Deserialize, Serialize};
use utoipa::IntoParams;
use uuid::Uuid;

use super::answer::tag_of_parts;
use super::app::App;
use super::client::Client;
use super::edge::Edge;
use super::events::{Watch, WatchEvent};
use super::page::{self, LARGEST_LIMIT, Page, USUAL_LIMIT};
use super::parameters::{IfNoneMatch, JobId, Parameters, invalid, whole};
use super::prefer::Wait;
use super::problem::Refusal;
use super::resource::{self, Shown};
use super::view::JobView;
use crate::jobs::{Filter, Job, JobError, Jobs, Membership, Status};

/// Filter of a list.
#[derive(Deserialize, IntoParams)]
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
    /// Jobs that this user of the client submitted (`Meshwright-User`).
    #[param(pattern = "^[^\\x00]*$")]
    submitted_by: Option<String>,
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
    /// Maximum number of jobs.
    #[param(minimum = 1, maximum = 200, default = 50, example = 20)]
    #[serde(default, deserialize_with = "whole")]
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
            submitted_by: self.submitted_by.clone(),
            ids,
            study: self.study.as_deref().map(membership).transpose()?,
            span: page::span(
                self.submitted_since.as_deref(),
                self.submitted_before.as_deref(),
            )?,
            after: page::cursor(self.cursor.as_deref())?,
        })
    }

    /// Parameters that the address of the next page shares with this one.
    fn pairs(&self) -> [(&'static str, Option<&str>); 7] {
        [
            ("status", self.status.as_deref()),
            ("tag", self.tag.as_deref()),
            ("submitted_by", self.submitted_by.as_deref()),
            ("ids", self.ids.as_deref()),
            ("study", self.study.as_deref()),
            ("submitted_since", self.submitted_since.as_deref()),
            ("submitted_before", self.submitted_before.as_deref()),
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
    let (limit, filter) = (parameters.limit()?, parameters.filter()?);
    resource::list::<Job>(client, filter, limit, &parameters.pairs()).await
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
    resource::show::<Job>(client, wait, id, request).await
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
    resource::cancel::<Job>(client, id).await
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
    resource::delete::<Job>(client, id).await
}

/// Watch a job
///
/// A stream of server-sent events: `status` with the job as data, at the start and whenever its state changes, and
/// `progress` with the positions solved. It ends when the job has ended. A client that comes back (`Last-Event-ID`)
/// gets the present state first, so nothing is missed.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "Jobs", operation_id = "watch_job",
    params(
        ("Last-Event-ID" = Option<String>, Header, description = "Sent by a client that comes back; every stream starts with the present state."),
    ),
    responses(
        (status = 200, description = "Events: `status` with a Job as data, and `progress` with a Progress.", body = WatchEvent, content_type = "text/event-stream"),
        (status = 429, description = "As many streams are open as one client may have."),
    ),
)]
pub(super) async fn events(client: Client, JobId(id): JobId) -> Result<Response, Refusal> {
    resource::watch::<Job>(client, id).await
}

impl Shown for Job {
    const PATH: &'static str = "/v1/jobs";

    type Watch = Watch;

    fn view(&self, edge: &Edge) -> impl Serialize {
        JobView::of(self, edge)
    }

    async fn whole_view(&self, jobs: &Jobs, edge: &Edge) -> Result<Bytes, JobError> {
        let submission = jobs.submission(self.id).await?;
        Ok(JobView::whole(self, &submission, edge).to_json())
    }

    fn tag(&self, edge: &Edge) -> Tag {
        let small = JobView::of(self, edge).to_json();
        tag_of_parts(&["job", &String::from_utf8_lossy(&small)])
    }

    fn watch(app: App, client: String, id: Uuid) -> Watch {
        Watch::new(app, client, id)
    }
}
