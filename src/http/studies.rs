//! Studies: many variants of a submission at once, and the table that they come to.

use std::convert::Infallible;
use std::time::Duration;

use axum::Json;
use axum::body::Bytes;
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_TYPE, HeaderMap, HeaderValue, LINK, LOCATION,
    RETRY_AFTER,
};
use axum::response::sse::Event;
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

use super::app::{App, Edge};
use super::client::Client;
use super::conditional::Tag;
use super::document::Document;
use super::events;
use super::parameters::{IdempotencyKey, Parameters, invalid};
use super::prefer::Wait;
use super::problem::internal;
use super::view::with_public_type;
use crate::jobs::{News, Status, StudyRecord, StudySubmitted};
use crate::wire::study_table::{csv, table};
use crate::wire::{Code, Problem, RowState, Study, StudyResults};

/// A study may have so many MiB: ten thousand designs, each listed with a few changes, have one or two.
const MIB: usize = 4;

/// A list has so many studies unless it is told, and so many at most.
const LIMITS: (u32, u32) = (50, 200);

/// The progress of a study is told so often at most.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);

/// A study: how far it has come, and where to find its table.
#[derive(Serialize, ToSchema)]
#[schema(as = StudyState)]
pub(super) struct StudyView {
    /// The id of the study.
    #[schema(value_type = String, format = "uuid")]
    id: Uuid,
    /// `successful` when at least one design has results, `failed` when none has and all have ended.
    status: Status,
    /// Designs that have come to an end, whichever.
    done: u64,
    /// Designs in all.
    total: u64,
    /// Designs that have results.
    successful: u64,
    /// Designs that could not be built or computed, or whose job was deleted.
    failed: u64,
    /// When the study was submitted (UTC).
    #[schema(value_type = String, format = DateTime)]
    submitted_at: Timestamp,
    /// When its last design ended, or it was cancelled (UTC); null until then.
    #[schema(value_type = Option<String>, format = DateTime)]
    finished_at: Option<Timestamp>,
    /// Of a failed study: why.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Problem>)]
    problem: Option<Value>,
    links: StudyLinks,
    /// The study as it was sent. Absent in lists.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Study>)]
    study: Option<Value>,
}

/// Where to find what belongs to a study.
#[derive(Serialize, ToSchema)]
pub(super) struct StudyLinks {
    /// The study.
    #[serde(rename = "self")]
    self_: String,
    /// Its table, at any time.
    results: String,
    /// Its table as CSV.
    results_csv: String,
    /// Its events, as they happen.
    events: String,
    /// Its jobs, one for each design that can be built.
    jobs: String,
    /// Where to cancel it, by POST; absent when it has ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    cancel: Option<String>,
}

/// Some studies, newest first.
#[derive(Serialize, ToSchema)]
#[schema(as = StudyList)]
pub(super) struct StudyListView {
    /// The studies.
    items: Vec<StudyView>,
    /// The value of `cursor` that gives the next studies; null at the end of the list.
    next: Option<String>,
}

/// The data of a `progress` event of a study.
#[derive(Serialize, ToSchema)]
#[schema(as = StudyProgress)]
pub(super) struct StudyProgressView {
    /// Designs that have come to an end, whichever.
    done: u64,
    /// Designs in all.
    total: u64,
}

impl StudyView {
    /// The small view, for lists and answers to a submission.
    fn new(study: &StudyRecord, edge: &Edge) -> Self {
        let status = study.status();
        Self {
            id: study.id,
            status,
            done: study.done(),
            total: study.total,
            successful: study.successful,
            failed: study.failed + study.without_job,
            submitted_at: study.submitted_at,
            finished_at: study.finished_at(),
            problem: why_failed(study, edge),
            links: StudyLinks::new(study, edge),
            study: None,
        }
    }

    /// The whole view, with the study as it was sent.
    fn whole(study: &StudyRecord, edge: &Edge) -> Self {
        Self {
            study: serde_json::from_str(&study.document).ok(),
            ..Self::new(study, edge)
        }
    }

    fn to_json(&self) -> Bytes {
        serde_json::to_vec(self)
            .expect("a view is plain data")
            .into()
    }
}

impl StudyLinks {
    fn new(study: &StudyRecord, edge: &Edge) -> Self {
        let self_ = edge.study(study.id);
        Self {
            results: format!("{self_}/results"),
            results_csv: format!("{self_}/results.csv"),
            events: format!("{self_}/events"),
            jobs: format!("{}/v1/jobs?study={}", edge.public_url, study.id),
            cancel: (!study.status().has_ended()).then(|| format!("{self_}/cancel")),
            self_,
        }
    }
}

impl Edge {
    /// The address of a study.
    pub(super) fn study(&self, id: Uuid) -> String {
        format!("{}/v1/studies/{id}", self.public_url)
    }
}

/// A study that came to nothing says so.
fn why_failed(study: &StudyRecord, edge: &Edge) -> Option<Value> {
    if study.status() != Status::Failed {
        return None;
    }
    let detail = format!(
        "None of the {} designs has results: {} could not be built, {} could not be computed. Each row of the table has its problem.",
        study.total, study.without_job, study.failed
    );
    let problem = serde_json::to_value(Problem::new(Code::NoDesignComputed, detail))
        .expect("a problem is plain data");
    Some(with_public_type(problem, edge))
}

/// The id in a path. What is no id names no study.
fn study_id(text: &str) -> Result<Uuid, Problem> {
    text.parse()
        .map_err(|_| Problem::new(Code::StudyNotFound, "There is no study of this id."))
}

/// Does work of some milliseconds where no request waits for it but its own.
async fn aside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, Problem> {
    tokio::task::spawn_blocking(work).await.map_err(|error| {
        tracing::error!(%error, "work beside the requests failed");
        internal()
    })
}

/// Submit a study
///
/// Takes one submission in many variants and answers at once. Each variant that can be built becomes a job of the same
/// queue, behind the jobs that stand alone; the others stand in the table with their problem. The study is on the disk
/// when it is answered. Equal designs are computed once.
#[utoipa::path(
    post, path = "/v1/studies", tag = "Studies", operation_id = "submit_study",
    request_body(content = Study, content_type = "application/json", description = "The study."),
    params(
        ("Idempotency-Key" = Option<String>, Header, description = "A word of the client's choice, 1 to 255 characters, kept for a day: the same key and study get the same study, however often they are sent."),
    ),
    responses(
        (status = 202, description = "The study is taken.", body = StudyView, headers(
            ("Location" = String, description = "The address of the study."),
            ("Retry-After" = u32, description = "Seconds after which it is worth looking."),
        )),
        (status = 200, description = "With a repeated `Idempotency-Key`, the study that has ended meanwhile.", body = StudyView),
        (status = 400, description = "The body is no JSON, or a header is not understood.", body = Problem, content_type = "application/problem+json"),
        (status = 408, description = "The body came too slowly.", body = Problem, content_type = "application/problem+json"),
        (status = 413, description = "The body has more than 4 MiB.", body = Problem, content_type = "application/problem+json"),
        (status = 415, description = "The body is not declared as JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "The study is not understood, or has more than 10,000 designs; `errors` says which field is why. Or the key was used for another study.", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Too many designs wait, or the service is shutting down. Try again after `Retry-After` seconds.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn submit(
    State(app): State<App>,
    Client(client): Client,
    IdempotencyKey(key): IdempotencyKey,
    Document(document): Document<MIB>,
) -> Result<Response, Problem> {
    let study = aside(move || Study::parse(&document)).await??;
    let StudySubmitted { study, repeated } = app.jobs.submit_study(&client, study, key).await?;

    let ended = study.status().has_ended();
    let status = if repeated && ended {
        StatusCode::OK
    } else {
        StatusCode::ACCEPTED
    };
    let body = StudyView::new(&study, &app.edge).to_json();
    let mut response = (status, [(CONTENT_TYPE, "application/json")], body).into_response();
    let headers = response.headers_mut();
    if let Ok(address) = HeaderValue::try_from(app.edge.study(study.id)) {
        headers.insert(LOCATION, address);
    }
    if !ended {
        headers.insert(RETRY_AFTER, HeaderValue::from_static("1"));
    }
    Ok(response)
}

/// What to list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct StudyListParameters {
    /// So many studies at most.
    #[param(minimum = 1, maximum = 200, default = 50)]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    cursor: Option<String>,
}

/// List studies
///
/// Newest first, page by page.
#[utoipa::path(
    get, path = "/v1/studies", tag = "Studies", operation_id = "list_studies",
    params(StudyListParameters),
    responses(
        (status = 200, description = "The studies.", body = StudyListView, headers(
            ("Link" = String, description = "With rel=next, the address of the next page; absent at the end."),
        )),
        (status = 400, description = "A parameter is not understood.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn list(
    State(app): State<App>,
    Client(client): Client,
    Parameters(parameters): Parameters<StudyListParameters>,
) -> Result<Response, Problem> {
    let (usual, most) = LIMITS;
    let limit = parameters.limit.unwrap_or(usual);
    if !(1..=most).contains(&limit) {
        return Err(invalid(format!(
            "limit is {limit}; it lies between 1 and {most}."
        )));
    }
    let cursor = parameters.cursor.as_ref().map(|cursor| cursor.parse());
    let after = cursor.transpose().map_err(|_| {
        invalid("cursor is not one that a list has given; take it from next as it stands.")
    })?;
    let page = app.jobs.list_studies(&client, after, limit).await?;

    let view = |study: &StudyRecord| StudyView::new(study, &app.edge);
    let next = page.next.map(|cursor| cursor.to_string());
    let link = next.as_ref().map(|cursor| {
        format!(
            "<{}/v1/studies?limit={limit}&cursor={cursor}>; rel=\"next\"",
            app.edge.public_url
        )
    });
    let items = page.items.iter().map(view).collect();
    let mut response = Json(StudyListView { items, next }).into_response();
    if let Some(link) = link.and_then(|link| HeaderValue::try_from(link).ok()) {
        response.headers_mut().insert(LINK, link);
    }
    Ok(response)
}

/// Look at a study
///
/// Its state, its progress and the study as it was sent. With `If-None-Match` it costs nothing while nothing changes.
#[utoipa::path(
    get, path = "/v1/studies/{id}", tag = "Studies", operation_id = "get_study",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the study."),
        ("Prefer" = Option<String>, Header, description = "`wait=N`: answer when the study has ended, or after N seconds (60 at most)."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The study.", body = StudyView, headers(
            ("ETag" = String, description = "Stands for this answer."),
            ("Retry-After" = u32, description = "Until the study has ended: seconds after which it is worth looking again."),
        )),
        (status = 304, description = "Nothing has changed since the answer of that `ETag`."),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn show(
    State(app): State<App>,
    Client(client): Client,
    wait: Wait,
    Path(id): Path<String>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let id = study_id(&id)?;
    let study = match wait.granted() {
        Some(patience) => app.jobs.wait_for_study(&client, id, patience).await?,
        None => app.jobs.find_study(&client, id).await?,
    };
    let body = StudyView::whole(&study, &app.edge).to_json();
    let mut response = tagged(body, "application/json", &study, &request);
    wait.acknowledge(response.headers_mut());
    Ok(response)
}

/// An answer that changes until the study has ended.
fn tagged(
    body: Bytes,
    content_type: &'static str,
    study: &StudyRecord,
    request: &HeaderMap,
) -> Response {
    let tag = Tag::of(&body);
    let mut response = if tag.is_known(request) {
        tag.not_modified()
    } else {
        ([(CONTENT_TYPE, content_type)], body).into_response()
    };
    let headers = response.headers_mut();
    tag.mark(headers);
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("private, no-cache"));
    if !study.status().has_ended() {
        headers.insert(RETRY_AFTER, HeaderValue::from_static("1"));
    }
    response
}

/// Get the table of a study
///
/// A row for each design, filled as far as the study has come; it can be read at any time. Rows have their place when the
/// study is taken, those beyond the first 500 a moment later.
#[utoipa::path(
    get, path = "/v1/studies/{id}/results", tag = "Studies", operation_id = "get_study_results",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the study."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The table.", body = StudyResults, headers(
            ("ETag" = String, description = "Stands for this answer."),
            ("Retry-After" = u32, description = "Until the study has ended: seconds after which it is worth looking again."),
        )),
        (status = 304, description = "Nothing has changed since the answer of that `ETag`."),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn results(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let (study, rows) = read(&app, &client, &id).await?;
    let edge = app.edge.clone();
    let record = study.clone();
    let body = aside(move || {
        serde_json::to_vec(&document(&record, rows, &edge)).expect("a table is plain data")
    })
    .await?;
    Ok(tagged(body.into(), "application/json", &study, &request))
}

/// Get the table of a study as CSV
///
/// One line for each row and torque, the columns named as in the JSON with dots between the names.
#[utoipa::path(
    get, path = "/v1/studies/{id}/results.csv", tag = "Studies", operation_id = "get_study_results_csv",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the study."),
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The table.", body = String, content_type = "text/csv", headers(
            ("ETag" = String, description = "Stands for this answer."),
        )),
        (status = 304, description = "Nothing has changed since the answer of that `ETag`."),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn results_csv(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let (study, rows) = read(&app, &client, &id).await?;
    let edge = app.edge.clone();
    let record = study.clone();
    let body = aside(move || csv(&document(&record, rows, &edge).rows)).await?;
    let mut response = tagged(body.into(), "text/csv; charset=utf-8", &study, &request);
    let name = format!("attachment; filename=\"study-{}.csv\"", study.id);
    if let Ok(name) = HeaderValue::try_from(name) {
        response.headers_mut().insert(CONTENT_DISPOSITION, name);
    }
    Ok(response)
}

async fn read(app: &App, client: &str, id: &str) -> Result<(StudyRecord, Vec<RowState>), Problem> {
    let study = app.jobs.find_study(client, study_id(id)?).await?;
    let rows = app.jobs.study_rows(&study).await?;
    Ok((study, rows))
}

/// The table as a document.
fn document(study: &StudyRecord, mut rows: Vec<RowState>, edge: &Edge) -> StudyResults {
    for row in &mut rows {
        row.problem = row
            .problem
            .take()
            .map(|problem| with_public_type(problem, edge));
    }
    StudyResults {
        id: Some(study.id),
        status: study.status().as_str(),
        done: study.done(),
        total: study.total,
        gear: study.gear,
        problem: why_failed(study, edge),
        rows: table(study.gear, rows),
    }
}

/// Watch a study
///
/// A stream of server-sent events: `status` with the study as data, at the start and whenever its state changes, and
/// `progress` with the designs that are done, four times a second at most. It ends when the study has ended.
#[utoipa::path(
    get, path = "/v1/studies/{id}/events", tag = "Studies", operation_id = "watch_study",
    params(("id" = String, Path, format = "uuid", description = "The id of the study.")),
    responses(
        (status = 200, description = "Events: `status` (a study) and `progress`.", body = StudyProgressView, content_type = "text/event-stream"),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn events(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let id = study_id(&id)?;
    app.jobs.find_study(&client, id).await?;
    let watch = Watch {
        news: app.jobs.news(id),
        app,
        client,
        id,
        count: 0,
        known: None,
    };
    let events = stream::unfold(watch, async |mut watch| {
        let event = watch.next().await?;
        Some((Ok::<_, Infallible>(event), watch))
    });
    Ok(events::answer(events))
}

/// One client that watches one study.
struct Watch {
    app: App,
    client: String,
    id: Uuid,
    news: News,
    /// Events sent.
    count: u64,
    /// What the client knows: the state, and the designs done.
    known: Option<(Status, u64)>,
}

impl Watch {
    /// The next event; none after the study has ended or vanished, or when the service shuts down.
    async fn next(&mut self) -> Option<Event> {
        if self.known.is_some_and(|(status, _)| status.has_ended()) {
            return None;
        }
        loop {
            let study = self.app.jobs.find_study(&self.client, self.id).await.ok()?;
            let now = (study.status(), study.done());
            let before = self.known.replace(now);
            if before.map(|(status, _)| status) != Some(now.0) {
                return Some(self.event("status", &StudyView::new(&study, &self.app.edge)));
            }
            if before != Some(now) {
                let view = StudyProgressView {
                    done: study.done(),
                    total: study.total,
                };
                return Some(self.event("progress", &view));
            }
            // The pause comes after the news, so that many of them cost one look.
            let news = async {
                self.news.changed_state().await;
                tokio::time::sleep(PROGRESS_INTERVAL).await;
            };
            tokio::select! {
                () = news => {}
                () = self.app.jobs.stop().cancelled() => return None,
            }
        }
    }

    fn event(&mut self, name: &str, data: &impl Serialize) -> Event {
        self.count += 1;
        events::event(self.count, name, data)
    }
}

/// Cancel a study
///
/// Dismisses what waits or runs of it; what has results keeps them. Cancelling again changes nothing.
#[utoipa::path(
    post, path = "/v1/studies/{id}/cancel", tag = "Studies", operation_id = "cancel_study",
    params(("id" = String, Path, format = "uuid", description = "The id of the study.")),
    responses(
        (status = 202, description = "The study is dismissed.", body = StudyView),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The study has ended already.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn cancel(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let study = app.jobs.cancel_study(&client, study_id(&id)?).await?;
    let view = StudyView::new(&study, &app.edge);
    Ok((StatusCode::ACCEPTED, Json(view)).into_response())
}

/// Delete a study
///
/// Removes a study that has ended, with its jobs and their results.
#[utoipa::path(
    delete, path = "/v1/studies/{id}", tag = "Studies", operation_id = "delete_study",
    params(("id" = String, Path, format = "uuid", description = "The id of the study.")),
    responses(
        (status = 204, description = "The study is gone."),
        (status = 404, description = "There is no such study.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The study has not ended; cancel it first.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn delete(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<StatusCode, Problem> {
    app.jobs.delete_study(&client, study_id(&id)?).await?;
    Ok(StatusCode::NO_CONTENT)
}
