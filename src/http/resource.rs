//! Jobs and studies over HTTP: both are looked at, waited for, listed, watched, cancelled and deleted in the same way.

use axum::body::Bytes;
use axum::http::StatusCode;
use axum::http::header::HeaderMap;
use axum::response::{IntoResponse, Response};
use meshwright_connections::{Keep, Tag};
use serde::Serialize;
use tracing::warn;
use uuid::Uuid;

use super::answer::{json, tell_when_to_return};
use super::app::App;
use super::blocking::turn_to_read;
use super::client::Client;
use super::edge::Edge;
use super::events::{self, Watching};
use super::page;
use super::prefer::Wait;
use super::problem::Refusal;
use crate::jobs::{By, JobError, Jobs, Resource, Role, Status};

/// A job or a study as clients see it.
pub(super) trait Shown: Resource {
    /// Where all of them are listed.
    const PATH: &'static str;

    /// The stream of the events of one.
    type Watch: Watching;

    /// Its view.
    fn view(&self, edge: &Edge) -> impl Serialize;

    /// Its view with the document that was sent, JSON.
    fn whole_view(
        &self,
        jobs: &Jobs,
        edge: &Edge,
    ) -> impl Future<Output = Result<Bytes, JobError>> + Send;

    /// The tag of its state.
    fn tag(&self, edge: &Edge) -> Tag;

    /// Follows the events of the one of this id.
    fn watch(app: App, client: String, id: Uuid) -> Self::Watch;
}

/// Lists those that `filter` lets through, `limit` on a page; the next page has the same `parameters`.
pub(super) async fn list<R: Shown>(
    client: Client,
    filter: R::Filter,
    limit: u32,
    parameters: &[(&str, Option<&str>)],
) -> Result<Response, Refusal> {
    let _turn = turn_to_read(client.name()).await;
    let (jobs, edge) = (&client.app.jobs, &client.app.edge);
    let found = R::list(jobs, client.name(), &filter, limit).await?;
    let limit = limit.to_string();
    let parameters = [parameters, &[("limit", Some(&*limit))]].concat();
    let view = |item| R::view(item, edge);
    Ok(page::answer(edge, R::PATH, &parameters, &found, view))
}

/// Shows the one of this id, at its end if the client waits for that.
pub(super) async fn show<R: Shown>(
    client: Client,
    wait: Wait,
    id: Uuid,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let (jobs, edge) = (&client.app.jobs, &client.app.edge);
    let wait = wait.grant(&client);
    let found = match wait.patience() {
        Some(patience) => {
            let found = R::wait(jobs, client.name(), id, patience).await?;
            client.check_again().await?;
            found
        }
        None => R::find(jobs, client.name(), id).await?,
    };
    // The submission never changes, and is not read if the state has not changed.
    let whole = async { Ok::<_, Refusal>(json(found.whole_view(jobs, edge).await?)) };
    let tag = found.tag(edge);
    let mut response = tag.answer(Keep::AskAgain, &request, whole).await?;
    wait.acknowledge(response.headers_mut());
    tell_when_to_return(found.status().has_ended(), &mut response);
    Ok(response)
}

/// Streams the events of the one of this id.
pub(super) async fn watch<R: Shown>(client: Client, id: Uuid) -> Result<Response, Refusal> {
    R::find(&client.app.jobs, client.name(), id).await?;
    let place = events::place(&client.app, client.name())?;
    let watch = R::watch(client.app.clone(), client.member.client, id);
    Ok(events::answer(client.app, watch, client.pass, place))
}

/// Cancels the one of this id.
pub(super) async fn cancel<R: Shown>(client: Client, id: Uuid) -> Result<Response, Refusal> {
    let (owner, by) = whose::<R>(&client, id).await?;
    let cancelled = R::cancel(&client.app.jobs, &owner, id, by).await?;
    note(&client, by, "cancelled", R::PATH, id, &owner);
    let view = axum::Json(cancelled.view(&client.app.edge));
    Ok((StatusCode::ACCEPTED, view).into_response())
}

/// Deletes the one of this id.
pub(super) async fn delete<R: Shown>(client: Client, id: Uuid) -> Result<StatusCode, Refusal> {
    let (owner, by) = whose::<R>(&client, id).await?;
    let jobs = &client.app.jobs;
    if by == By::Administrator {
        let waits = R::find(jobs, &owner, id).await?.status() == Status::Accepted;
        if waits {
            // Who watches it is told.
            R::cancel(jobs, &owner, id, by).await?;
        }
    }
    R::delete(jobs, &owner, id, by).await?;
    note(&client, by, "deleted", R::PATH, id, &owner);
    Ok(StatusCode::NO_CONTENT)
}

/// The client whose job or study has this id, for who may end or remove it: oneself, or, for an administrator, whoever it is.
async fn whose<R: Shown>(client: &Client, id: Uuid) -> Result<(String, By), JobError> {
    let own = (client.name().to_owned(), By::Owner);
    if client.role != Role::Administrator {
        return Ok(own);
    }
    let owner = R::owner(&client.app.jobs, id).await?;
    let other = owner.filter(|owner| owner != client.name());
    Ok(other.map_or(own, |owner| (owner, By::Administrator)))
}

/// Logs an administrator's action on another client's job or study. The span of the request names the administrator.
fn note(client: &Client, by: By, done: &str, path: &str, id: Uuid, owner: &str) {
    if by == By::Administrator {
        let administrator = client.name();
        warn!(%id, path, owner, administrator, "an administrator {done} what belongs to another client");
    }
}
