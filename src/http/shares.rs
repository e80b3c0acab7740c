//! Links to results for readers without a key: their creation and end, and the answers that they open.
//!
//! The address of a link has a secret, which appears in no log. A link opens the stored results of one job to read: results, their tables and pictures, and a
//! page of them. It opens neither the submission nor recomputed files.

use std::fmt::Write as _;
use std::sync::Arc;

use axum::Json;
use axum::extract::{FromRequestParts, Path};
use axum::http::header::{CACHE_CONTROL, CONTENT_LOCATION, CONTENT_TYPE, HeaderName, HeaderValue};
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use meshwright_connections::Connection;
use meshwright_wire::declare::{document, shortened};
use meshwright_wire::{Code, FieldError, Problem};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

use super::app::App;
use super::body::JsonBody;
use super::client::{Client, Pass};
use super::curve_columns::CurveTable;
use super::parameters::{JobId, Parameters, ShareId};
use super::problem::Refusal;
use super::results::{self, ResultsParameters};
use super::tables::{self, TableParameters};
use crate::jobs::{Job, LinkError, LinkRecord, LinkSecret, MOST_LINKS};

/// A link to be made.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(title = "NewShare")]
pub(super) struct NewShare {
    /// From when on it opens nothing (RFC 3339): within the next 90 days.
    #[schema(value_type = Timestamp, example = "2100-01-01T00:00:00Z")]
    ends_at: String,
}

impl NewShare {
    fn end(&self) -> Result<Timestamp, Problem> {
        self.ends_at.parse().map_err(|_| {
            let given = shortened(&self.ends_at);
            let detail = format!(
                "/ends_at is {given:?}; a time with its offset from UTC is expected, such as 2026-12-24T12:00:00Z."
            );
            Problem::of_fields(vec![FieldError::new("/ends_at", Code::WrongType, detail)])
        })
    }
}

document! {
    /// A link to the results of a job.
    pub(super) struct ShareView as Share, "Share" view of (link: LinkRecord, url: Option<String>) {
        /// The id of the link, by which it is ended.
        id: Uuid = link.id,
        /// Its address: whoever has it reads the results. Told once, when the link is made.
        url?: String = url,
        /// When it was made (UTC).
        created_at: Timestamp = link.created_at,
        /// From when on it opens nothing (UTC).
        ends_at: Timestamp = link.ends_at,
    }
}

/// The links to the results of a job.
#[derive(Serialize, ToSchema)]
#[schema(title = "ShareList")]
pub(super) struct ShareList {
    /// The links that are open, the oldest first.
    items: Vec<ShareView>,
}

/// Share the results of a job
///
/// Makes a link by which a reader without a key sees the stored results of the job, their tables and pictures, and a page of them; neither the submission, nor
/// recomputed files, nor any other job. It ends at `ends_at`, with the job, and with the key that made it. A job may have 20 at a time.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/shares", tag = "Results", operation_id = "share_job",
    request_body(content = NewShare, content_type = "application/json", description = "When the link ends."),
    responses(
        (status = 201, description = "The link, with its address, which is told this once.", body = ShareView),
        JsonBody,
        (status = 422, description = "`ends_at` is no time within the next 90 days, or 20 links to the results of the job are open."),
    ),
)]
pub(super) async fn make(
    client: Client,
    JobId(id): JobId,
    document: JsonBody,
) -> Result<Response, Refusal> {
    let ends_at = document.parse::<NewShare>()?.end()?;
    let key = match &client.pass {
        Pass::Key(key) => Some(key.id().to_owned()),
        Pass::Until(_) | Pass::Open => None,
    };
    let jobs = &client.app.jobs;
    let (link, secret) = jobs.make_link(client.name(), id, key, ends_at).await?;
    let url = format!("{}/shared/{}", client.app.edge.public_url, secret.reveal());
    tracing::info!(share = %link.id, job = %id, client = client.name(), "results shared");
    let view = ShareView::of(link, Some(url));
    Ok((StatusCode::CREATED, Json(view)).into_response())
}

/// List the links to the results of a job
///
/// The open links of the job, without their addresses.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/shares", tag = "Results", operation_id = "list_shares",
    responses((status = 200, description = "The links.", body = ShareList)),
)]
pub(super) async fn list(client: Client, JobId(id): JobId) -> Result<Json<ShareList>, Refusal> {
    let links = client.app.jobs.links(client.name(), id).await?.into_iter();
    let items = links.map(|link| ShareView::of(link, None)).collect();
    Ok(Json(ShareList { items }))
}

/// End a link
///
/// From then on its address is unknown.
#[utoipa::path(
    delete, path = "/v1/shares/{id}", tag = "Results", operation_id = "end_share",
    responses((status = 204, description = "The link opens nothing any more.")),
)]
pub(super) async fn end(client: Client, ShareId(id): ShareId) -> Result<StatusCode, Refusal> {
    client.app.jobs.end_link(client.name(), id).await?;
    Ok(StatusCode::NO_CONTENT)
}

impl From<LinkError> for Problem {
    fn from(error: LinkError) -> Self {
        match error {
            LinkError::Job(error) => error.into(),
            LinkError::Time { .. } => {
                let detail = format!("/ends_at: {error}.");
                Self::of_fields(vec![FieldError::new("/ends_at", Code::OutOfRange, detail)])
            }
            LinkError::TooMany => Self::new(
                Code::TooLarge,
                format!(
                    "{MOST_LINKS} links to the results of this job are open, which is the limit; end one first."
                ),
            ),
            LinkError::NotFound(_) => Self::new(Code::NotFound, "There is no link of this id."),
            LinkError::NoChance => super::problem::internal(),
        }
    }
}

/// The job that the secret of an open link reads, of whichever client.
pub(super) struct Shared {
    app: App,
    link: LinkRecord,
    job: Job,
    /// The last part of the address of the page.
    secret: String,
}

#[derive(Deserialize)]
struct Named {
    secret: String,
}

impl FromRequestParts<App> for Shared {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, app: &App) -> Result<Self, Refusal> {
        // Unknown, ended and revoked are alike.
        let nothing = || {
            let detail = "There is nothing at this address: the link is not known, or has ended.";
            Refusal::from(Problem::new(Code::NotFound, detail))
        };
        let named = Path::<Named>::from_request_parts(parts, app).await;
        let Path(Named { secret }) = named.map_err(|_| nothing())?;
        if let Some(connection) = parts.extensions.get::<Arc<Connection>>() {
            let address = connection.address;
            app.access
                .count_looks_at_shares(address)
                .map_err(Refusal::too_often)?;
        }
        let parsed = LinkSecret::parse(&secret).ok_or_else(nothing)?;
        let opened = app.jobs.open_link(&parsed).await?;
        let (link, job) = opened.ok_or_else(nothing)?;
        app.access
            .count_share(link.id)
            .map_err(Refusal::too_often)?;
        Ok(Self {
            app: app.clone(),
            link,
            job,
            secret,
        })
    }
}

/// Get shared results
///
/// The answer of `GET /v1/jobs/{id}/results`, for readers with the link. Caches do not keep it.
#[utoipa::path(
    get, path = "/shared/{secret}/results", tag = "Results", operation_id = "get_shared_results",
    params(
        ("secret" = String, Path, description = "The last part of the address of the link."),
        ResultsParameters,
    ),
    security(()),
    responses(
        (status = 200, description = "The results.", body = meshwright_wire::Results),
        (status = 400, description = "A parameter is not understood."),
        (status = 404, description = "The link is not known, or has ended; or the job has not ended."),
        (status = 409, description = "The job failed or was cancelled, and has no results."),
        (status = 410, description = "Only the statistics of the results were kept."),
    ),
)]
pub(super) async fn results(
    shared: Shared,
    Parameters(parameters): Parameters<ResultsParameters>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let answer = results::answer(&shared.app, &shared.job, &parameters, &request).await?;
    Ok(not_kept(answer))
}

/// Get shared {table}
///
/// The answer of `GET /v1/jobs/{id}/results/{table}`, for readers with the link. Caches do not keep it.
#[utoipa::path(
    get, path = "/shared/{secret}/results/{table}", tag = "Results", operation_id = "get_shared_table",
    params(
        ("secret" = String, Path, description = "The last part of the address of the link."),
        TableParameters,
    ),
    security(()),
    responses(
        (status = 200, description = "The table.", body = CurveTable),
        (status = 400, description = "A parameter is not understood."),
        (status = 404, description = "The link is not known, or has ended; or there is no such table or torque."),
        (status = 409, description = "The job failed or was cancelled, and has no results."),
        (status = 410, description = "Only the statistics of the results were kept."),
    ),
)]
pub(super) async fn table(
    shared: Shared,
    Path((_secret, file)): Path<(String, String)>,
    Parameters(parameters): Parameters<TableParameters>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let answer = tables::answer(&shared.app, &shared.job, &file, parameters, &request).await?;
    Ok(not_kept(answer))
}

/// The page of a link: the pictures, and where the numbers are. It needs no script.
pub(super) async fn page(shared: Shared) -> Response {
    let Shared {
        link, job, secret, ..
    } = &shared;
    let status = job.status.as_str();
    let mut page = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>Results of a gear pair</title><style>body{{font-family:sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}}\
         img{{width:100%}}</style></head><body><h1>Results of a gear pair</h1>\
         <p>Computed by Meshwright with the method <code>{}</code>; the job is {status}. This link ends on {:.0}.</p>",
        job.method, link.ends_at,
    );
    let files = |page: &mut String, files: &[&str]| {
        for file in files {
            let _ = write!(
                page,
                "<li><a href=\"{secret}/results/{file}\">{file}</a></li>"
            );
        }
    };
    if job.document.is_some() {
        for (file, title) in [
            ("ste.svg", "Transmission error"),
            ("mesh-stiffness.svg", "Mesh stiffness"),
            ("load-share.svg", "Load shares"),
        ] {
            let _ = write!(
                page,
                "<h2>{title}</h2><img src=\"{secret}/results/{file}\" alt=\"{title} over the mesh position\">"
            );
        }
        let _ = write!(
            page,
            "<h2>Files</h2><ul><li><a href=\"{secret}/results\">results as JSON</a></li>"
        );
        files(
            &mut page,
            &[
                "curves.csv",
                "ste.csv",
                "mesh-stiffness.csv",
                "spectrum.csv",
                "spectrum.svg",
            ],
        );
        page.push_str("</ul>");
    }
    page.push_str("</body></html>");
    let headers = [(CONTENT_TYPE, "text/html; charset=utf-8")];
    not_kept((headers, page).into_response())
}

/// An answer that nobody keeps, and that no search engine lists.
fn not_kept(mut response: Response) -> Response {
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(
        HeaderName::from_static("x-robots-tag"),
        HeaderValue::from_static("noindex"),
    );
    // The address of the job is for those who have a key.
    headers.remove(CONTENT_LOCATION);
    response
}
