//! Health and readiness of the service.

use std::sync::atomic::Ordering;

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

use super::app::App;
use super::problem::Plain;

/// Readiness of the service.
#[derive(Serialize, ToSchema)]
pub(super) struct Readiness {
    /// True if new jobs will be computed.
    ready: bool,
    /// True if the database takes writes.
    database: bool,
    /// The number of workers that live.
    workers: usize,
    /// True during shutdown.
    shutting_down: bool,
}

/// Is the process alive?
///
/// Touches nothing: an answer means that the process lives.
#[utoipa::path(
    get, path = "/health/live", tag = "Operation", operation_id = "health_live",
    security(()),
    responses((status = 200, description = "The process lives.", body = String, content_type = "text/plain")),
)]
pub(super) async fn live() -> &'static str {
    "alive"
}

/// Can the service work?
///
/// Asks the database for a write, and counts the workers.
#[utoipa::path(
    get, path = "/health/ready", tag = "Operation", operation_id = "health_ready",
    security(()),
    responses(
        (status = 200, description = "New jobs will be computed.", body = Readiness),
        (status = 503, description = "New jobs will not be computed now; the body says why.", body = Readiness),
    ),
)]
pub(super) async fn ready(State(app): State<App>) -> Response {
    let database = app.readings.database_works(&app.jobs).await;
    let workers = app.workers_alive.load(Ordering::Relaxed);
    let shutting_down = app.jobs.stop().is_cancelled();
    let ready = database && (workers > 0 || !app.computes) && !shutting_down;
    let status = if ready {
        StatusCode::OK
    } else {
        StatusCode::SERVICE_UNAVAILABLE
    };
    let readiness = Readiness {
        ready,
        database,
        workers,
        shutting_down,
    };
    let mut response = (status, Json(readiness)).into_response();
    response.extensions_mut().insert(Plain);
    response
}
