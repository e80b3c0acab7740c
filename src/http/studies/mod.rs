//! Studies: many variants of a submission at once, and the table that they come to.

mod events;
mod outlines;
mod population;
mod table;
mod view;

use axum::body::Bytes;
use axum::http::StatusCode;
use axum::http::header::HeaderMap;
use axum::response::Response;
use meshwright_connections::{Keep, Tag};
use meshwright_engine::run::Run;
use meshwright_studies::Study;
use serde::{Deserialize, Serialize};
use utoipa::IntoParams;
use uuid::Uuid;

use super::answer::{self, json, tag_of_parts};
use super::app::App;
use super::blocking::{blocking, turn_to_read};
use super::body::JsonBody;
use super::client::Client;
use super::edge::Edge;
use super::page::{self, Page, USUAL_LIMIT};
use super::parameters::{IdempotencyKey, IfNoneMatch, Parameters, StudyId, User, whole};
use super::prefer::Wait;
use super::problem::Refusal;
use super::reference::StudyEstimate;
use super::resource::{self, Shown};
use crate::jobs::{JobError, Jobs, Resource as _, StudyFilter, StudyRecord};
use view::StudyView;

pub(super) use events::*;
pub use outlines::Outlines;
pub(super) use population::*;
pub(super) use table::*;

/// A study may have so many MiB: a hundred thousand designs, each listed with two changes, have a dozen.
const MIB: usize = 16;

/// The document of a study is told with its state if it has no more bytes than this.
const LONGEST_IN_VIEW: u64 = 64 << 10;

/// Submit a study
///
/// Takes one submission in many variants and answers at once. Each variant that can be built becomes a job of the same
/// queue, which takes turns with the jobs that stand alone; the others stand in the table with their problem. The study is on the disk
/// when it is answered. Equal designs are computed once.
#[utoipa::path(
    post, path = "/v1/studies", tag = "Studies", operation_id = "submit_study",
    request_body(content = Study, content_type = "application/json", description = "The study."),
    params(IdempotencyKey, User),
    responses(
        (status = 202, description = "The study is taken; `estimate` says what it will take.", body = StudyView, headers(
            ("Location" = String, description = "The address of the study."),
            ("Retry-After" = u32, description = "Seconds after which it is worth looking."),
        )),
        (status = 200, description = "With a repeated `Idempotency-Key`, the study that has ended meanwhile.", body = StudyView),
        JsonBody<MIB>,
        (status = 422, description = "The study is not understood, or has more than 100,000 designs; `errors` says which field is why. Or the key was used for another study."),
        (status = 429, description = "More designs of this client wait than may."),
        (status = 503, description = "Too many designs wait, nothing can be stored, or the service is shutting down. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn submit(
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(document, memory): JsonBody<MIB>,
) -> Result<Response, Refusal> {
    let read = move |run: &Run| {
        let study = Study::submitted(&document, run);
        let estimated = study.and_then(|study| {
            let estimate = StudyEstimate::of(&study, run)?;
            Ok((study, estimate))
        });
        (estimated, memory)
    };
    let (estimated, _memory) = blocking(client.name(), read).await?;
    let (study, estimate) = estimated?;
    let submitted = client
        .app
        .jobs
        .submit_study(&client.member, study, key)
        .await?;
    let study = &submitted.record;
    let view = StudyView::submitted(study, estimate, &client.app.edge);
    let (address, has_ended) = (client.app.edge.study(study.id), study.status().has_ended());
    Ok(answer::submitted(
        view.to_json(),
        &address,
        has_ended,
        submitted.repeated,
    ))
}

/// Filter of a list.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(in crate::http) struct StudyListParameters {
    /// Studies of this name.
    #[param(pattern = "^[^\\x00]*$")]
    name: Option<String>,
    /// Studies with this tag.
    #[param(pattern = "^[^\\x00]*$")]
    tag: Option<String>,
    /// Studies that this user of the client submitted (`Meshwright-User`).
    #[param(pattern = "^[^\\x00]*$")]
    submitted_by: Option<String>,
    /// Studies from the first one on that was submitted at this instant or later (RFC 3339).
    #[param(format = DateTime, example = "2026-01-01T00:00:00Z")]
    submitted_since: Option<String>,
    /// Studies before the first one that was submitted at this instant or later (RFC 3339).
    #[param(format = DateTime, example = "2100-01-01T00:00:00Z")]
    submitted_before: Option<String>,
    /// Maximum number of studies.
    #[param(minimum = 1, maximum = 200, default = 50, example = 20)]
    #[serde(default, deserialize_with = "whole")]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    #[param(pattern = "^c[1-9a-f][0-9a-f]{0,14}$")]
    cursor: Option<String>,
}

/// List studies
///
/// Newest first, page by page.
#[utoipa::path(
    get, path = "/v1/studies", tag = "Studies", operation_id = "list_studies",
    params(StudyListParameters),
    responses(
        (status = 200, description = "The studies.", body = Page<StudyView>, headers(
            ("Link" = String, description = "With rel=next, the address of the next page; absent at the end."),
        )),
        (status = 400, description = "A parameter is not understood."),
    ),
)]
pub(super) async fn list(
    client: Client,
    Parameters(parameters): Parameters<StudyListParameters>,
) -> Result<Response, Refusal> {
    let limit = page::limit(parameters.limit, USUAL_LIMIT)?;
    let (since, before) = (&parameters.submitted_since, &parameters.submitted_before);
    let filter = StudyFilter {
        name: parameters.name.clone(),
        tag: parameters.tag.clone(),
        submitted_by: parameters.submitted_by.clone(),
        span: page::span(since.as_deref(), before.as_deref())?,
        after: page::cursor(parameters.cursor.as_deref())?,
    };
    let pairs = [
        ("name", parameters.name.as_deref()),
        ("tag", parameters.tag.as_deref()),
        ("submitted_by", parameters.submitted_by.as_deref()),
        ("submitted_since", since.as_deref()),
        ("submitted_before", before.as_deref()),
    ];
    resource::list::<StudyRecord>(client, filter, limit, &pairs).await
}

/// Look at a study
///
/// Its state, its progress and the study as it was sent. With `If-None-Match` it costs nothing while nothing changes.
#[utoipa::path(
    get, path = "/v1/studies/{id}", tag = "Studies", operation_id = "get_study",
    params(Wait, IfNoneMatch),
    responses(
        (status = 200, description = "The study.", body = StudyView, headers(
            ("Retry-After" = u32, description = "Until the study has ended: seconds after which it is worth looking again."),
        )),
    ),
)]
pub(super) async fn show(
    client: Client,
    wait: Wait,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    resource::show::<StudyRecord>(client, wait, id, request).await
}

/// The entity tag of one form of a study, until the study changes.
fn tag_of(study: &StudyRecord, form: &str, edge: &Edge) -> Tag {
    let (id, version) = (study.id.to_string(), study.version.to_string());
    tag_of_parts(&["study", &id, &version, form, &edge.public_url])
}

/// Get a study as it was sent
///
/// The document that was submitted, without its white space. It never changes.
#[utoipa::path(
    get, path = "/v1/studies/{id}/document", tag = "Studies", operation_id = "get_study_document",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The study.", body = Study),
    ),
)]
pub(super) async fn document(
    client: Client,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let study = StudyRecord::find(&client.app.jobs, client.name(), id).await?;
    let text = async {
        let bytes = client.app.jobs.study_text_bytes(study.id).await?;
        let memory = client.app.bodies.for_answer(client.name(), bytes).await?;
        let _turn = turn_to_read(client.name()).await;
        let text = client.app.jobs.study_text(study.id).await?;
        Ok::<_, Refusal>(json(memory.hold(text)))
    };
    let tag = tag_of_parts(&["study document", &study.id.to_string()]);
    tag.answer(Keep::ForGood, &request, text).await
}

/// Cancel a study
///
/// Dismisses the waiting and running jobs of the study; finished ones keep their results. Cancelling again changes nothing.
#[utoipa::path(
    post, path = "/v1/studies/{id}/cancel", tag = "Studies", operation_id = "cancel_study",
    responses(
        (status = 202, description = "The study is dismissed.", body = StudyView),
        (status = 409, description = "The study has ended already."),
    ),
)]
pub(super) async fn cancel(client: Client, StudyId(id): StudyId) -> Result<Response, Refusal> {
    resource::cancel::<StudyRecord>(client, id).await
}

/// Delete a study
///
/// Removes a study that has ended, with its jobs and their results.
#[utoipa::path(
    delete, path = "/v1/studies/{id}", tag = "Studies", operation_id = "delete_study",
    responses(
        (status = 204, description = "The study is gone."),
        (status = 409, description = "The study has not ended; cancel it first."),
    ),
)]
pub(super) async fn delete(client: Client, StudyId(id): StudyId) -> Result<StatusCode, Refusal> {
    resource::delete::<StudyRecord>(client, id).await
}

impl Shown for StudyRecord {
    const PATH: &'static str = "/v1/studies";

    type Watch = Watch;

    fn view(&self, edge: &Edge) -> impl Serialize {
        StudyView::of(self, edge)
    }

    async fn whole_view(&self, jobs: &Jobs, edge: &Edge) -> Result<Bytes, JobError> {
        let document = jobs.short_study_text(self.id, LONGEST_IN_VIEW).await?;
        Ok(StudyView::whole(self, document, edge).to_json())
    }

    fn tag(&self, edge: &Edge) -> Tag {
        tag_of(self, "state", edge)
    }

    fn watch(app: App, client: String, id: Uuid) -> Watch {
        Watch::new(app, client, id)
    }
}
