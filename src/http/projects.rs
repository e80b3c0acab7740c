//! Projects: documents that a client keeps under a name. Of two writers the second one is refused, by the tag of the revision that it has read.

use axum::Json;
use axum::http::header::{ETAG, LOCATION};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use meshwright_connections::{Keep, Tag};
use meshwright_wire::declare::document;
use meshwright_wire::{Code, FieldError, Problem};
use serde::Deserialize;
use serde_json::value::RawValue;
use utoipa::{IntoParams, ToSchema};
use uuid::Uuid;

use super::answer::{json, tag_of_parts};
use super::blocking::turn_to_read;
use super::body::JsonBody;
use super::client::Client;
use super::edge::Edge;
use super::page::{self, Page, USUAL_LIMIT};
use super::parameters::{IdempotencyKey, IfMatch, IfNoneMatch, Parameters, ProjectId, User, whole};
use super::problem::{Refusal, sentence};
use crate::jobs::{MOST_PROJECT_BYTES, ProjectContent, ProjectError, ProjectRecord};

/// The body with a project may have so many MiB: a document, which is told its own bound, and what stands around it.
const MIB: usize = 2;

/// A project to be kept.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(title = "NewProject")]
pub(super) struct NewProject<'a> {
    /// The name of the project: 1 to 200 characters, none of them a control character. Several projects may have one name.
    #[schema(min_length = 1, max_length = 200, example = "E-axle, second stage")]
    name: String,
    /// The document: any JSON of at most 1,000,000 bytes, as it is sent. The service reads nothing of it.
    #[serde(borrow)]
    #[schema(value_type = serde_json::Value)]
    document: &'a RawValue,
}

document! {
    /// A project.
    pub(super) struct ProjectView as Project, "Project" view of (
        project: &ProjectRecord,
        edge: &Edge,
        document: Option<Box<RawValue>>,
    ) {
        /// The id of the project.
        id: Uuid = project.id,
        /// The name of the project.
        name: String = project.name.clone(),
        /// When it was changed last (UTC).
        updated_at: Timestamp = project.updated_at,
        /// Bytes of its document.
        bytes: u64 = project.bytes,
        links: ProjectLinks = ProjectLinks::of(project, edge),
        /// The document, as it was sent. Absent in lists, and in the answer to who has sent it.
        #[schema(value_type = Option<serde_json::Value>)]
        document?: Box<RawValue> = document,
    }
}

document! {
    /// Addresses of what belongs to a project.
    pub(super) struct ProjectLinks as ProjectLinks view of (project: &ProjectRecord, edge: &Edge) {
        /// The project.
        #[serde(rename = "self")]
        self_: String = edge.project(project.id),
    }
}

impl Edge {
    fn project(&self, id: Uuid) -> String {
        format!("{}/v1/projects/{id}", self.public_url)
    }
}

/// The tag of a revision of a project.
fn tag_of(project: &ProjectRecord) -> Tag {
    tag_of_parts(&[&project.id.to_string(), &project.revision.to_string()])
}

/// A project after a change by who has its document, with the tag for the next change.
fn changed(status: StatusCode, project: &ProjectRecord, edge: &Edge) -> Response {
    let view = Json(ProjectView::of(project, edge, None));
    let mut response = (status, view).into_response();
    let headers = response.headers_mut();
    headers.insert(ETAG, tag_of(project).value());
    if status == StatusCode::CREATED {
        let address = HeaderValue::from_str(&edge.project(project.id));
        let address =
            address.expect("the public address was checked at the start, an id is hexadecimal");
        headers.insert(LOCATION, address);
    }
    response
}

impl NewProject<'_> {
    fn content(self) -> Result<ProjectContent, ProjectError> {
        ProjectContent::new(self.name, self.document.get().to_owned())
    }
}

/// What to list.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct ProjectListParameters {
    /// So many projects at most.
    #[param(minimum = 1, maximum = 200, default = 50, example = 20)]
    #[serde(default, deserialize_with = "whole")]
    limit: Option<u32>,
    /// Where to go on: `next` of the list before.
    #[param(pattern = "^c[1-9a-f][0-9a-f]{0,14}$")]
    cursor: Option<String>,
}

/// List projects
///
/// Those of the client, the newest first, without their documents. Without keys all who call the service share one list.
#[utoipa::path(
    get, path = "/v1/projects", tag = "Projects", operation_id = "list_projects",
    params(ProjectListParameters),
    responses(
        (status = 200, description = "The projects.", body = Page<ProjectView>, headers(
            ("Link" = String, description = "With rel=next, the address of the next page; absent at the end."),
        )),
        (status = 400, description = "A parameter is not understood."),
    ),
)]
pub(super) async fn list(
    client: Client,
    Parameters(parameters): Parameters<ProjectListParameters>,
) -> Result<Response, Refusal> {
    let limit = page::limit(parameters.limit, USUAL_LIMIT)?;
    let after = page::cursor(parameters.cursor.as_deref())?;
    let _turn = turn_to_read(client.name()).await;
    let jobs = &client.app.jobs;
    let found = jobs.projects(client.name(), after, limit).await?;
    let (edge, limit) = (&client.app.edge, limit.to_string());
    let view = |project| ProjectView::of(project, edge, None);
    let parameters = [("limit", Some(&*limit))];
    Ok(page::answer(
        edge,
        "/v1/projects",
        &parameters,
        &found,
        view,
    ))
}

/// Keep a project
///
/// Keeps a document under a name until it is deleted. A client may have 200 projects, each of at most 1 MB (`/v1/limits`).
#[utoipa::path(
    post, path = "/v1/projects", tag = "Projects", operation_id = "make_project",
    request_body(content = NewProject, content_type = "application/json", description = "The project."),
    params(IdempotencyKey, User),
    responses(
        (status = 200, description = "The project that an earlier request with this key has made, as it stands now.", body = ProjectView, headers(
            ("ETag" = String, description = "Stands for this revision: what `If-Match` of a change names."),
        )),
        (status = 201, description = "The project.", body = ProjectView, headers(
            ("Location" = String, description = "The address of the project."),
            ("ETag" = String, description = "Stands for this revision: what `If-Match` of a change names."),
        )),
        JsonBody<MIB>,
        (status = 422, description = "The document has more than 1,000,000 bytes, the client has 200 projects, the name is none, or the key was used for another project."),
    ),
)]
pub(super) async fn make(
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    body: JsonBody<MIB>,
) -> Result<Response, Refusal> {
    let content = body.parse::<NewProject>()?.content()?;
    let jobs = &client.app.jobs;
    let (project, repeated) = jobs.add_project(&client.member, content, key).await?;
    let status = if repeated {
        StatusCode::OK
    } else {
        StatusCode::CREATED
    };
    Ok(changed(status, &project, &client.app.edge))
}

/// Get a project
///
/// With its document.
#[utoipa::path(
    get, path = "/v1/projects/{id}", tag = "Projects", operation_id = "get_project",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The project.", body = ProjectView),
    ),
)]
pub(super) async fn show(
    client: Client,
    ProjectId(id): ProjectId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let (jobs, edge) = (&client.app.jobs, &client.app.edge);
    let bytes = jobs.project(client.name(), id).await?.bytes;
    // The document, and the answer with it.
    let memory = client.app.bodies.for_answer(client.name(), 2 * bytes);
    let memory = memory.await?;
    // Read with its revision, which may be a later one by now.
    let (project, document) = jobs.project_document(client.name(), id).await?;
    let document = RawValue::from_string(document).ok();
    let view = ProjectView::of(&project, edge, document);
    let view = serde_json::to_vec(&view).expect("a project is plain data");
    let whole = async { Ok::<_, Refusal>(json(memory.hold(view))) };
    tag_of(&project)
        .answer(Keep::AskAgain, &request, whole)
        .await
}

/// Change a project
///
/// Gives it another name and document, if it still is what `If-Match` says.
#[utoipa::path(
    put, path = "/v1/projects/{id}", tag = "Projects", operation_id = "change_project",
    request_body(content = NewProject, content_type = "application/json", description = "The project."),
    params(IfMatch),
    responses(
        (status = 200, description = "The project.", body = ProjectView, headers(
            ("ETag" = String, description = "Stands for this revision: what `If-Match` of the next change names."),
        )),
        JsonBody<MIB>,
        (status = 412, description = "The project was changed since it was read."),
        (status = 422, description = "The document has more than 1,000,000 bytes, or the name is none."),
        (status = 428, description = "`If-Match` is missing."),
    ),
)]
pub(super) async fn change(
    client: Client,
    ProjectId(id): ProjectId,
    request: HeaderMap,
    body: JsonBody<MIB>,
) -> Result<Response, Refusal> {
    let read = read_by(&client, id, &request).await?;
    let content = body.parse::<NewProject>()?.content()?;
    let jobs = &client.app.jobs;
    let project = jobs.change_project(client.name(), &read, &content).await?;
    Ok(changed(StatusCode::OK, &project, &client.app.edge))
}

/// Delete a project
///
/// If it still is what `If-Match` says.
#[utoipa::path(
    delete, path = "/v1/projects/{id}", tag = "Projects", operation_id = "delete_project",
    params(IfMatch),
    responses(
        (status = 204, description = "The project is gone."),
        (status = 412, description = "The project was changed since it was read."),
        (status = 428, description = "`If-Match` is missing."),
    ),
)]
pub(super) async fn delete(
    client: Client,
    ProjectId(id): ProjectId,
    request: HeaderMap,
) -> Result<StatusCode, Refusal> {
    let read = read_by(&client, id, &request).await?;
    client.app.jobs.delete_project(client.name(), &read).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// The project of this id, if it still is what the request says that it has read.
async fn read_by(client: &Client, id: Uuid, request: &HeaderMap) -> Result<ProjectRecord, Problem> {
    let project = client.app.jobs.project(client.name(), id).await?;
    match tag_of(&project).matches(request) {
        Some(true) => Ok(project),
        Some(false) => Err(ProjectError::Changed.into()),
        None => Err(Problem::new(
            Code::PreconditionRequired,
            "Send If-Match with the ETag of the project that you have read, so that nobody's change is lost.",
        )),
    }
}

impl From<ProjectError> for Problem {
    fn from(error: ProjectError) -> Self {
        let said = sentence(&error);
        match error {
            ProjectError::Job(error) => error.into(),
            ProjectError::Name(_) => Self::of_fields(vec![FieldError::new(
                "/name",
                Code::OutOfRange,
                format!("{said}."),
            )]),
            ProjectError::TooLarge(_) => {
                let error = FieldError::new("/document", Code::TooLarge, format!("{said}."));
                Self::of_fields(vec![error.nearest(MOST_PROJECT_BYTES as f64)])
            }
            ProjectError::TooMany => Self::new(Code::TooLarge, format!("{said}.")),
            ProjectError::NotFound(_) => Self::new(Code::ProjectNotFound, format!("{said}.")),
            ProjectError::Changed => Self::new(
                Code::PreconditionFailed,
                "The project was changed since you read it. Get it again, and decide which of the two stays.",
            ),
        }
    }
}
