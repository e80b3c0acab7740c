//! The router: every route, and the layers around them.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use axum::http::header::{
    ACCEPT, AUTHORIZATION, CONTENT_TYPE, ETAG, HeaderName, HeaderValue, IF_MATCH, IF_NONE_MATCH,
    LINK, LOCATION, RETRY_AFTER, WWW_AUTHENTICATE,
};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::routing::get;
use meshwright_wire::{Code, Problem};
use serde_json::Value;
use tower::ServiceBuilder;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::classify::ServerErrorsFailureClass;
use tower_http::cors::{AllowOrigin, CorsLayer};
use tower_http::timeout::TimeoutLayer;
use tower_http::trace::{DefaultOnResponse, TraceLayer};
use tracing::Level;
use tracing::field::Empty;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::app::App;
use super::headers::Trace;
use super::problem::Refusal;
use super::queries::{Queries, refuse_unknown_names};
use super::{
    access, batch, contact_pattern, docs, draw, fields, guides, headers, health, jobs, memory,
    metrics, mode_shapes, outline, packing, previews, problem, problem_pages, projects, reference,
    results, rexs, shares, studies, submit, tables, usage, web, webhooks,
};
use crate::jobs::without_secrets;

/// The service.
pub fn router(app: App) -> Router {
    let edge = Arc::clone(&app.edge);
    let (router, mut openapi) = routes().split_for_parts();
    let queries = Arc::new(Queries::of(&openapi));
    openapi.servers = Some(vec![docs::server(&edge.public_url)]);
    docs::add_common_answers(&mut openapi);
    docs::say_whether_keys_are_needed(&mut openapi, edge.asks_for_keys, edge.issuer.as_deref());
    let is_https = edge.public_url.starts_with("https://");
    let access = Arc::clone(&app.access);

    // The outermost layer stands first.
    let layers = ServiceBuilder::new()
        .layer(from_fn(headers::name))
        .layer(from_fn_with_state(app.jobs.clock().clone(), headers::date))
        .layer(from_fn_with_state(is_https, headers::secure))
        // Before the log, which would be flooded as well.
        .layer(from_fn_with_state(
            Arc::clone(&access),
            access::limit_unauthenticated,
        ))
        .layer(from_fn(access::limit_active))
        .layer(
            TraceLayer::new_for_http()
                .make_span_with(span)
                .on_response(DefaultOnResponse::new().level(Level::INFO))
                .on_failure(failed),
        )
        .layer(from_fn(metrics::count))
        .layer(from_fn(headers::tell))
        .option_layer((!edge.cors_origins.is_empty()).then(|| cors(&edge.cors_origins)))
        .layer(from_fn_with_state(app.bodies.clone(), memory::hold))
        .layer(from_fn(packing::pack))
        .layer(from_fn_with_state(Arc::clone(&edge), problem::shape))
        .layer(from_fn_with_state(access, access::check_host))
        .layer(TimeoutLayer::with_status_code(
            StatusCode::SERVICE_UNAVAILABLE,
            app.times.request,
        ))
        .layer(CatchPanicLayer::custom(problem::of_panic));
    router
        .route_layer(from_fn_with_state(queries, refuse_unknown_names))
        .merge(docs::routes_of_docs(&openapi))
        .merge(web::routes_of_page())
        .merge(guides::routes_of_guides())
        .route("/v1/studies/{id}/results.csv", get(studies::old_csv))
        .route("/shared/{secret}", get(shares::page))
        .fallback(nothing_here)
        .method_not_allowed_fallback(not_that_method)
        .layer(layers)
        .with_state(app)
}

/// Health and numbers alone, for a listener that the operator keeps to himself. It has no keys, so that a page of a foreign
/// name must not reach it wherever it listens.
pub fn router_of_metrics(app: App) -> Router {
    let layers = ServiceBuilder::new()
        .layer(from_fn_with_state(app.jobs.clock().clone(), headers::date))
        .layer(from_fn_with_state(false, headers::secure))
        .layer(from_fn_with_state(
            Arc::clone(&app.access),
            access::check_known_host,
        ))
        .layer(TimeoutLayer::with_status_code(
            StatusCode::SERVICE_UNAVAILABLE,
            app.times.request,
        ))
        .layer(CatchPanicLayer::custom(problem::of_panic));
    Router::new()
        .route("/metrics", get(metrics::metrics_apart))
        .route("/health/live", get(health::live))
        .route("/health/ready", get(health::ready))
        .fallback(nothing_here)
        .method_not_allowed_fallback(not_that_method)
        .layer(layers)
        .with_state(app)
}

/// The OpenAPI document of the service, as it is without a public address.
pub fn openapi() -> Value {
    let mut openapi = routes().into_openapi();
    docs::add_common_answers(&mut openapi);
    openapi.servers = Some(vec![docs::server("")]);
    docs::finished(&openapi)
}

/// The routes that the OpenAPI document describes.
fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(docs::introduction())
        .routes(routes!(submit::submit, jobs::list))
        .routes(routes!(jobs::show, jobs::delete))
        .routes(routes!(jobs::cancel))
        .routes(routes!(results::results))
        .routes(routes!(shares::make, shares::list))
        .routes(routes!(shares::end))
        .routes(routes!(shares::results))
        .routes(routes!(shares::table))
        .routes(routes!(jobs::events))
        .routes(routes!(previews::preview))
        .routes(routes!(studies::list))
        .routes(routes!(studies::show, studies::delete))
        .routes(routes!(studies::document))
        .routes(routes!(studies::events))
        .routes(routes!(studies::cancel))
        .routes(routes!(webhooks::make, webhooks::list))
        .routes(routes!(webhooks::show, webhooks::delete))
        .routes(routes!(webhooks::ping))
        .routes(routes!(webhooks::deliveries))
        .routes(routes!(webhooks::enable))
        .routes(routes!(webhooks::rotate))
        .routes(routes!(projects::make, projects::list))
        .routes(routes!(projects::show, projects::change, projects::delete))
        .routes(routes!(reference::examples))
        .routes(routes!(reference::limits))
        .routes(routes!(reference::quantities))
        .routes(routes!(reference::materials))
        .routes(routes!(problem_pages::index))
        .routes(routes!(problem_pages::page_of))
        .routes(routes!(health::live))
        .routes(routes!(health::ready))
        .routes(routes!(metrics::metrics))
        .routes(routes!(usage::usage))
        .routes(routes!(reference::validate))
        .routes(routes!(outline::outline))
        .routes(routes!(draw::draw))
        .routes(routes!(rexs::read))
        .routes(routes!(rexs::write))
        .routes(routes!(fields::vtu))
        .routes(routes!(fields::edges))
        .routes(routes!(mode_shapes::vtu))
        .routes(routes!(contact_pattern::json))
        .routes(routes!(contact_pattern::svg))
        .routes(routes!(tables::table))
        .routes(routes!(studies::results))
        .routes(routes!(studies::population))
        .routes(routes!(studies::best))
        .routes(routes!(studies::design))
        .routes(routes!(studies::file))
        .routes(routes!(studies::submit))
        .routes(routes!(batch::submit))
}

async fn nothing_here(uri: Uri) -> Refusal {
    let detail = format!(
        "There is nothing at {}. /docs lists what there is.",
        uri.path()
    );
    Problem::new(Code::NotFound, detail).into()
}

async fn not_that_method(method: Method, uri: Uri) -> Refusal {
    let detail = format!(
        "{} does not take {method}; the header Allow says what it takes.",
        uri.path()
    );
    Problem::new(Code::MethodNotAllowed, detail).into()
}

fn cors(origins: &[HeaderValue]) -> CorsLayer {
    let name = HeaderName::from_static;
    let origin = if origins.iter().any(|origin| origin == "*") {
        AllowOrigin::any()
    } else {
        AllowOrigin::list(origins.iter().cloned())
    };
    CorsLayer::new()
        .allow_origin(origin)
        .allow_methods([
            Method::GET,
            Method::HEAD,
            Method::POST,
            Method::PUT,
            Method::DELETE,
        ])
        .allow_headers([
            ACCEPT,
            AUTHORIZATION,
            CONTENT_TYPE,
            IF_MATCH,
            IF_NONE_MATCH,
            name("idempotency-key"),
            name("last-event-id"),
            name("meshwright-user"),
            name("prefer"),
            name("traceparent"),
            name("x-request-id"),
        ])
        .expose_headers([
            ETAG,
            LINK,
            LOCATION,
            RETRY_AFTER,
            WWW_AUTHENTICATE,
            name("content-location"),
            name("preference-applied"),
            name("results-solver-version"),
            name("server-timing"),
            name("solver-version"),
            name("traceparent"),
            name("x-request-id"),
        ])
        .max_age(Duration::from_secs(3600))
}

/// Logs a request that failed. A 503 says that something is full or away, which is nothing that a programmer has to look at.
fn failed(failure: ServerErrorsFailureClass, latency: Duration, _: &tracing::Span) {
    match failure {
        ServerErrorsFailureClass::StatusCode(StatusCode::SERVICE_UNAVAILABLE) => {
            tracing::warn!(?latency, "503: the request may be sent again");
        }
        failure => tracing::error!(%failure, ?latency, "the request failed"),
    }
}

/// Fields of a request in the log: never its query or headers, which may hold secrets, nor the secret of a link; of a key its public part, of a token its
/// issuer's name for it and for its bearer.
fn span(request: &Request) -> tracing::Span {
    let id = request
        .headers()
        .get("x-request-id")
        .and_then(|id| id.to_str().ok())
        .unwrap_or_default();
    let trace = request.extensions().get::<Trace>();
    let trace = trace.map_or("", |trace| trace.id.as_str());
    tracing::info_span!(
        "request",
        method = metrics::known(request.method()),
        path = without_secrets(request.uri().path()),
        request_id = id,
        trace_id = trace,
        key = Empty,
        subject = Empty,
        token = Empty,
        client = Empty
    )
}
