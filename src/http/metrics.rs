//! Numbers for Prometheus.

use std::sync::OnceLock;
use std::sync::atomic::Ordering;
use std::time::Instant;

use axum::extract::{MatchedPath, Request, State};
use axum::http::Method;
use axum::http::header::CONTENT_TYPE;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use meshwright_engine::library::Library;
use meshwright_wire::{Code, Problem, methods};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

use super::app::App;
use super::client::Operator;
use super::problem::Refusal;
use crate::jobs::JobError;
use crate::machine;
use crate::tokens::Tokens;

/// Declares metrics: names and descriptions.
macro_rules! numbers {
    ($($name:literal: $about:literal,)*) => {
        &[$(($name, $about)),*]
    };
}

const COUNTERS: &[(&str, &str)] = numbers! {
    "meshwright_http_requests_total": "Requests answered.",
    "meshwright_jobs_ended_total": "Jobs that a worker brought to an end.",
    "meshwright_commits_total": "Transactions that were written, by whether their commit waited for the disk.",
    "meshwright_webhook_attempts_total": "Messages to webhooks, by what came of them.",
    "meshwright_cache_hits_total": "Substructures that were wanted and kept.",
    "meshwright_cache_misses_total": "Substructures that were wanted and had to be computed.",
    "meshwright_cache_evictions_total": "Substructures that found no room or had to make room.",
};

/// Rare events exist as counters from the start, with the value 0, so that an alert sees the first one as an increase.
const RARE: &[(&str, &str)] = numbers! {
    "meshwright_connections_evicted_total": "Connections that gave way to new ones: idle, or reading nothing of their answer.",
    "meshwright_strangers_refused_total": "Requests without a known key that were refused because too many came.",
    "meshwright_spans_forgotten_total": "Spans that found no place in the queue to the collector.",
    "meshwright_removed_jobs_total": "Jobs removed because they were old or there was no room.",
    "meshwright_removed_studies_total": "Studies removed because they were old or there was no room.",
};

const GAUGES: &[(&str, &str)] = numbers! {
    "meshwright_oldest_waiting_seconds": "Age of the job alone that has waited longest.",
    "meshwright_workers": "Workers that live.",
    "meshwright_storage_writable": "1 if something can be stored, 0 if not.",
    "meshwright_database_bytes": "Size of the database without its journal.",
    "meshwright_database_free_bytes": "Of these, bytes that nothing occupies.",
    "meshwright_database_journal_bytes": "Size of the journal.",
    "meshwright_connections": "Connections of clients.",
    "meshwright_jobs_waiting": "Jobs in the queue, alone or of studies.",
    "meshwright_jobs_running": "Jobs that are being computed.",
    "meshwright_previews_running": "Previews that requests wait for.",
    "meshwright_files_running": "Files that are computed anew from jobs.",
    "meshwright_cache_bytes": "Memory of the substructures that jobs and previews share.",
    "meshwright_cache_capacity_bytes": "Memory that they may take.",
    "meshwright_cache_entries": "Substructures that are kept.",
    "meshwright_build_info": "1; its label is the version of the program.",
    "meshwright_process_memory_bytes": "Memory that the process occupies.",
    "meshwright_disk_bytes": "Size of the disk of the database; absent on a server.",
    "meshwright_disk_free_bytes": "Of these, bytes that are free for the service.",
    "meshwright_identity_provider_answers": "0 if the identity provider gave no keys when it was last asked; 1 if it did, or there is none.",
};

/// These, and where their buckets end.
const HISTOGRAMS: &[(&str, &str, &[f64])] = &[
    (
        "meshwright_http_request_duration_seconds",
        "Time until the head of an answer.",
        &[0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0, 60.0],
    ),
    (
        "meshwright_job_wall_time_seconds",
        "Time that a job was computed.",
        &[0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 600.0],
    ),
    (
        "meshwright_job_waiting_time_seconds",
        "Time from the submission of a job to its last begin.",
        &[0.01, 0.1, 1.0, 10.0, 60.0, 600.0, 3600.0, 21_600.0],
    ),
    (
        "meshwright_preview_engine_seconds",
        "Time that a preview was computed.",
        &[0.01, 0.02, 0.035, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0],
    ),
];

/// The numbers of this process. One recorder serves all parts of it, as the `metrics` facade wants.
fn recorder() -> &'static PrometheusHandle {
    static RECORDER: OnceLock<PrometheusHandle> = OnceLock::new();
    RECORDER.get_or_init(|| {
        let mut builder = PrometheusBuilder::new();
        for &(name, _, ends) in HISTOGRAMS {
            builder = builder
                .set_buckets_for_metric(Matcher::Full(name.to_owned()), ends)
                .expect("no list of buckets is empty");
        }
        let recorder = builder.build_recorder();
        let handle = recorder.handle();
        // Another recorder may have been set by who embeds the service; then it gets the numbers.
        let _ = metrics::set_global_recorder(recorder);
        for &(name, about) in COUNTERS.iter().chain(RARE) {
            metrics::describe_counter!(name, about);
        }
        for &(name, about) in GAUGES {
            metrics::describe_gauge!(name, about);
        }
        for &(name, about, _) in HISTOGRAMS {
            metrics::describe_histogram!(name, about);
        }
        for &(name, _) in RARE {
            metrics::counter!(name).increment(0);
        }
        for result in ["arrived", "refused", "given_up"] {
            metrics::counter!("meshwright_webhook_attempts_total", "result" => result).increment(0);
        }
        for method in methods() {
            let code = Code::InternalError.word();
            metrics::counter!("meshwright_jobs_ended_total", "status" => "failed", "method" => method, "code" => code)
                .increment(0);
        }
        handle
    })
}

/// Counts a request and the time to the head of its answer.
pub(super) async fn count(request: Request, next: Next) -> Response {
    recorder();
    let start = Instant::now();
    let method = known(request.method());
    // The pattern, not the address: an id in a label would make a series of its own.
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map_or("none", MatchedPath::as_str)
        .to_owned();
    let response = next.run(request).await;
    let status = response.status().as_u16().to_string();
    metrics::histogram!("meshwright_http_request_duration_seconds", "method" => method, "route" => route.clone())
        .record(start.elapsed().as_secs_f64());
    metrics::counter!("meshwright_http_requests_total", "method" => method, "route" => route, "status" => status)
        .increment(1);
    response
}

/// The method as a label. A client may invent methods, and a label of each would be kept until the process ends.
pub(super) fn known(method: &Method) -> &'static str {
    const METHODS: [&str; 7] = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"];
    let known = METHODS.into_iter().find(|known| *known == method.as_str());
    known.unwrap_or("other")
}

/// Get metrics
///
/// Numbers of requests, jobs, previews, storage and of the cache in the Prometheus text format. Where keys are needed, that
/// of an operator. A service may keep them for a listener of their own (`--metrics-listen`).
#[utoipa::path(
    get, path = "/metrics", tag = "Operation", operation_id = "metrics",
    responses(
        (status = 200, description = "The numbers.", body = String, content_type = "text/plain"),
        (status = 404, description = "The numbers have a listener of their own."),
        (status = 503, description = "The database cannot be read now."),
    ),
)]
pub(super) async fn metrics(State(app): State<App>, _: Operator) -> Result<Response, Refusal> {
    if !app.edge.metrics_here {
        let detail = "The numbers of this service have a listener of their own.";
        return Err(Problem::new(Code::NotFound, detail).into());
    }
    render(&app).await
}

/// The same on a listener of its own, which the operator keeps to himself.
pub(super) async fn metrics_apart(State(app): State<App>) -> Result<Response, Refusal> {
    render(&app).await
}

async fn render(app: &App) -> Result<Response, Refusal> {
    let depth = app.jobs.depth().await?;
    metrics::gauge!("meshwright_jobs_waiting", "kind" => "alone").set(gauge(depth.alone));
    metrics::gauge!("meshwright_jobs_waiting", "kind" => "study").set(gauge(depth.in_studies));
    metrics::gauge!("meshwright_jobs_running").set(gauge(depth.running));
    let oldest = depth.oldest.map_or(0.0, |at| {
        at.duration_until(app.jobs.clock().now())
            .as_secs_f64()
            .max(0.0)
    });
    metrics::gauge!("meshwright_oldest_waiting_seconds").set(oldest);
    set_storage(app).await?;
    let workers = app.workers_alive.load(Ordering::Relaxed);
    metrics::gauge!("meshwright_workers").set(workers as f64);
    metrics::gauge!("meshwright_previews_running").set(app.previews.count() as f64);
    metrics::gauge!("meshwright_files_running").set(app.files.count() as f64);
    set_cache(&app.library);
    set_process(app);
    recorder().run_upkeep();
    Ok((
        [(CONTENT_TYPE, "text/plain; version=0.0.4")],
        recorder().render(),
    )
        .into_response())
}

async fn set_storage(app: &App) -> Result<(), Problem> {
    let store = app.jobs.store();
    let space = store.space().await.map_err(JobError::from)?;
    metrics::gauge!("meshwright_database_bytes").set(space.file as f64);
    metrics::gauge!("meshwright_database_free_bytes").set(space.free as f64);
    metrics::gauge!("meshwright_database_journal_bytes").set(store.journal_bytes() as f64);
    let writable = if store.fault().is_none() { 1.0 } else { 0.0 };
    metrics::gauge!("meshwright_storage_writable").set(writable);
    Ok(())
}

/// Metrics of the process and its version.
fn set_process(app: &App) {
    metrics::gauge!("meshwright_build_info", "version" => env!("CARGO_PKG_VERSION")).set(1.0);
    if let Some(bytes) = machine::occupied_bytes() {
        metrics::gauge!("meshwright_process_memory_bytes").set(bytes as f64);
    }
    if let Some((all, free)) = app.jobs.store().disk() {
        metrics::gauge!("meshwright_disk_bytes").set(all as f64);
        metrics::gauge!("meshwright_disk_free_bytes").set(free as f64);
    }
    let answers = app.tokens.as_ref().is_none_or(Tokens::has_provider);
    metrics::gauge!("meshwright_identity_provider_answers").set(f64::from(u8::from(answers)));
}

/// The cache counts for itself; its counters are copied at each scrape.
fn set_cache(library: &Library) {
    for (shelf, usage) in library.usage() {
        metrics::gauge!("meshwright_cache_bytes", "shelf" => shelf).set(usage.bytes as f64);
        metrics::gauge!("meshwright_cache_capacity_bytes", "shelf" => shelf)
            .set(usage.capacity as f64);
        metrics::gauge!("meshwright_cache_entries", "shelf" => shelf).set(usage.entries as f64);
        metrics::counter!("meshwright_cache_hits_total", "shelf" => shelf).absolute(usage.hits);
        metrics::counter!("meshwright_cache_misses_total", "shelf" => shelf).absolute(usage.misses);
        metrics::counter!("meshwright_cache_evictions_total", "shelf" => shelf)
            .absolute(usage.evictions);
    }
}

/// Gauges are floating-point numbers, exact for any number of jobs that fits on a disk.
fn gauge(count: i64) -> f64 {
    count as f64
}
