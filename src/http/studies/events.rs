//! The events of a study as they happen.

use std::time::Duration;

use axum::response::Response;
use serde::Serialize;
use utoipa::ToSchema;
use uuid::Uuid;

use super::view::StudyView;
use crate::http::app::App;
use crate::http::client::Client;
use crate::http::events::{EventName, NamedData, WatchEvent, Watching, event};
use crate::http::parameters::StudyId;
use crate::http::problem::Refusal;
use crate::http::resource;
use crate::jobs::{News, Resource as _, Status, StudyRecord};

/// The progress of a study is told so often at most.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);

/// The data of a `progress` event of a study.
#[derive(Serialize, ToSchema)]
#[schema(as = StudyProgress)]
pub(in crate::http) struct StudyProgressView {
    /// Designs that have come to an end, whichever.
    done: u64,
    /// Designs in all.
    total: u64,
}

/// Watch a study
///
/// A stream of server-sent events: `status` with the study as data, at the start and whenever its state changes, and
/// `progress` with the designs that are done, four times a second at most. It ends when the study has ended.
#[utoipa::path(
    get, path = "/v1/studies/{id}/events", tag = "Studies", operation_id = "watch_study",
    responses(
        (status = 200, description = "Events: `status` with a SubmittedStudy as data, and `progress` with a StudyProgress.", body = WatchEvent, content_type = "text/event-stream"),
        (status = 429, description = "As many streams are open as one client may have."),
    ),
)]
pub(in crate::http) async fn events(
    client: Client,
    StudyId(id): StudyId,
) -> Result<Response, Refusal> {
    resource::watch::<StudyRecord>(client, id).await
}

/// One client that watches one study.
pub(in crate::http) struct Watch {
    app: App,
    client: String,
    id: Uuid,
    news: News,
    /// The state that the client knows, and the designs done.
    known: Option<(Status, u64)>,
}

impl Watch {
    /// Of one that knows nothing of the study so far.
    pub(super) fn new(app: App, client: String, id: Uuid) -> Self {
        Self {
            news: app.jobs.news(id),
            app,
            client,
            id,
            known: None,
        }
    }
}

impl Watching for Watch {
    /// The next event; none after the study has ended or vanished, or when the service shuts down.
    async fn next(&mut self) -> Option<NamedData> {
        if self.known.is_some_and(|(status, _)| status.has_ended()) {
            return None;
        }
        loop {
            let study = StudyRecord::find(&self.app.jobs, &self.client, self.id)
                .await
                .ok()?;
            let now = (study.status(), study.done());
            let before = self.known.replace(now);
            if before.map(|(status, _)| status) != Some(now.0) {
                return event(EventName::Status, &StudyView::of(&study, &self.app.edge));
            }
            if before != Some(now) {
                let view = StudyProgressView {
                    done: study.done(),
                    total: study.total,
                };
                return event(EventName::Progress, &view);
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
}
