//! The events of a job as they happen, for a browser's `EventSource`.

use std::convert::Infallible;
use std::pin::pin;
use std::time::Duration;

use axum::http::header::{CACHE_CONTROL, HeaderValue};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use meshwright_connections::Part;
use meshwright_wire::{Code, Problem};
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

use super::app::App;
use super::client::Pass;
use super::view::JobView;
use crate::jobs::{Job, News, Progress, Resource as _, Status};

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

/// An event of a job or of a study.
#[derive(ToSchema)]
#[schema(title = "WatchEvent")]
pub(super) struct WatchEvent {
    /// The number of the event in the stream.
    id: String,
    /// `status` at the start of the stream and whenever the state changes, else `progress`.
    event: EventName,
    /// JSON: of `status` a `Job` or a `SubmittedStudy`, of `progress` a `Progress` or a `StudyProgress`.
    #[schema(content_media_type = "application/json")]
    data: String,
}

/// The name of an event.
#[derive(Clone, Copy, ToSchema)]
#[schema(title = "EventName", rename_all = "snake_case")]
pub(super) enum EventName {
    /// The watched state.
    Status,
    /// How far it has come.
    Progress,
}

impl From<WatchEvent> for Event {
    fn from(WatchEvent { id, event, data }: WatchEvent) -> Self {
        let name = match event {
            EventName::Status => "status",
            EventName::Progress => "progress",
        };
        Self::default().id(id).event(name).data(data)
    }
}

/// An event: its name, and its data as JSON.
pub(super) type NamedData = (EventName, String);

/// The event `name` with this data.
pub(super) fn event(name: EventName, data: &impl Serialize) -> Option<NamedData> {
    let data = serde_json::to_string(data).expect("a view is plain data");
    Some((name, data))
}

/// One who watches until there is nothing more to see.
pub(super) trait Watching: Send + 'static {
    /// The next event; none at the end.
    fn next(&mut self) -> impl Future<Output = Option<NamedData>> + Send;
}

/// A place among those who wait.
pub(super) fn place(app: &App, client: &str) -> Result<Part, Problem> {
    app.access.place_to_wait(client).ok_or_else(|| {
        Problem::new(
            Code::RateLimited,
            "As many streams of events and waiting requests are open as one client, or all together, may have.",
        )
    })
}

/// The answer that streams the events of `watch`. It keeps its place until the events end, or until the watcher would not be admitted any more.
pub(super) fn answer(app: App, watch: impl Watching, pass: Pass, place: Part) -> Response {
    let events = stream::unfold(
        (app, watch, pass, place, 1_u64),
        async |(app, mut watch, pass, place, count)| {
            let (event, data) = next(&app, &mut watch, &pass).await?;
            let id = count.to_string();
            let event = Event::from(WatchEvent { id, event, data });
            let next = (app, watch, pass, place, count + 1);
            Some((Ok::<_, Infallible>(event), next))
        },
    );
    // A proxy that collects the answer before it passes it on would spoil the stream.
    // Packed on the way, events would be held back until there are enough of them.
    let events = Sse::new(events).keep_alive(KeepAlive::default());
    let mut response = ([("x-accel-buffering", "no")], events).into_response();
    let live = HeaderValue::from_static("no-cache, no-transform");
    response.headers_mut().insert(CACHE_CONTROL, live);
    response
}

/// The next event for one who may see it; none when his key is revoked meanwhile.
async fn next(app: &App, watch: &mut impl Watching, pass: &Pass) -> Option<NamedData> {
    let mut event = pin!(watch.next());
    loop {
        tokio::select! {
            event = &mut event => {
                let event = event?;
                return pass.holds(app).await.then_some(event);
            }
            () = tokio::time::sleep(app.times.look_at_keys) => {
                if !pass.holds(app).await {
                    return None;
                }
            }
        }
    }
}

/// One client that watches one job.
pub(super) struct Watch {
    app: App,
    client: String,
    id: Uuid,
    news: News,
    /// The state that the client knows.
    status: Option<Status>,
    progress: Option<Progress>,
}

impl Watching for Watch {
    /// The next event; none after the job has ended or vanished, or when the service shuts down.
    async fn next(&mut self) -> Option<NamedData> {
        if self.status.is_some_and(Status::has_ended) {
            return None;
        }
        loop {
            let job = Job::find(&self.app.jobs, &self.client, self.id)
                .await
                .ok()?;
            if self.status != Some(job.status) {
                self.status = Some(job.status);
                return event(EventName::Status, &JobView::of(&job, &self.app.edge));
            }
            if job.status == Status::Running && self.progress != Some(job.progress) {
                self.pause().await?;
                self.progress = Some(job.progress);
                let view = ProgressView {
                    progress_percent: job.progress.percent(),
                    positions_done: job.progress.done,
                    positions_total: job.progress.total,
                };
                return event(EventName::Progress, &view);
            }
            tokio::select! {
                () = self.news.changed(self.progress) => {}
                () = self.app.jobs.stop().cancelled() => return None,
            }
        }
    }
}

impl Watch {
    /// Of one that knows nothing of the job so far.
    pub(super) fn new(app: App, client: String, id: Uuid) -> Self {
        Self {
            news: app.jobs.news(id),
            app,
            client,
            id,
            status: None,
            progress: None,
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
}
