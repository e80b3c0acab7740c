//! The events of a job as they happen, for a browser's `EventSource`.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::{Path, State};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{self, Stream};
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

use super::app::App;
use super::client::Client;
use super::parameters::job_id;
use super::view::JobView;
use crate::jobs::{News, Progress, Status};
use crate::wire::Problem;

/// Progress is told so often at most.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// The data of a `progress` event.
#[derive(Serialize, ToSchema)]
#[schema(as = Progress)]
pub(super) struct ProgressView {
    /// Mesh positions solved, in whole percent of those to solve.
    progress_percent: u8,
    /// Mesh positions solved so far, over all torques.
    positions_done: u64,
    /// Mesh positions to solve, over all torques.
    positions_total: u64,
}

/// Watch a job
///
/// A stream of server-sent events: `status` with the job as data, at the start and whenever its state changes, and
/// `progress` with the positions solved. It ends when the job has ended. A client that comes back (`Last-Event-ID`)
/// gets the present state first, so nothing is missed.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "Jobs", operation_id = "watch_job",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the job."),
        ("Last-Event-ID" = Option<String>, Header, description = "Sent by a client that comes back; every stream starts with the present state."),
    ),
    responses(
        (status = 200, description = "Events: `status` (a job) and `progress`.", body = ProgressView, content_type = "text/event-stream"),
        (status = 404, description = "There is no such job.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn events(
    State(app): State<App>,
    Client(client): Client,
    Path(id): Path<String>,
) -> Result<Response, Problem> {
    let id = job_id(&id)?;
    app.jobs.find(&client, id).await?;

    let watch = Watch {
        news: app.jobs.news(id),
        app,
        client,
        id,
        count: 0,
        status: None,
        progress: None,
    };
    let events = stream::unfold(watch, async |mut watch| {
        let event = watch.next().await?;
        Some((Ok::<_, Infallible>(event), watch))
    });
    Ok(answer(events))
}

/// The answer that streams `events`.
pub(super) fn answer(
    events: impl Stream<Item = Result<Event, Infallible>> + Send + 'static,
) -> Response {
    // A proxy that collects the answer before it passes it on would spoil the stream.
    (
        [("x-accel-buffering", "no")],
        Sse::new(events).keep_alive(KeepAlive::default()),
    )
        .into_response()
}

/// Event number `count` of a stream.
pub(super) fn event(count: u64, name: &str, data: &impl Serialize) -> Event {
    let data = serde_json::to_string(data).expect("a view is plain data");
    Event::default()
        .id(count.to_string())
        .event(name)
        .data(data)
}

/// One client that watches one job.
struct Watch {
    app: App,
    client: String,
    id: Uuid,
    news: News,
    /// Events sent.
    count: u64,
    /// What the client knows.
    status: Option<Status>,
    progress: Option<Progress>,
}

impl Watch {
    /// The next event; none after the job has ended or vanished, or when the service shuts down.
    async fn next(&mut self) -> Option<Event> {
        if self.status.is_some_and(Status::has_ended) {
            return None;
        }
        loop {
            let job = self.app.jobs.find(&self.client, self.id).await.ok()?;
            if self.status != Some(job.status) {
                self.status = Some(job.status);
                return Some(self.event("status", &JobView::new(&job, &self.app.edge)));
            }
            if job.status == Status::Running && self.progress != Some(job.progress) {
                self.pause().await?;
                self.progress = Some(job.progress);
                let view = ProgressView {
                    progress_percent: job.progress.percent(),
                    positions_done: job.progress.done,
                    positions_total: job.progress.total,
                };
                return Some(self.event("progress", &view));
            }
            tokio::select! {
                () = self.news.changed(self.progress) => {}
                () = self.app.jobs.stop().cancelled() => return None,
            }
        }
    }

    /// Leaves time between two reports of progress; none when the service shuts down.
    async fn pause(&self) -> Option<()> {
        if self.progress.is_none() {
            return Some(());
        }
        tokio::select! {
            () = tokio::time::sleep(PROGRESS_INTERVAL) => Some(()),
            () = self.app.jobs.stop().cancelled() => None,
        }
    }

    fn event(&mut self, name: &str, data: &impl Serialize) -> Event {
        self.count += 1;
        event(self.count, name, data)
    }
}
