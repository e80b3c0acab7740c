//! The router: every route, and the layers around them.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use axum::http::header::{
    ACCEPT, AUTHORIZATION, CONTENT_TYPE, ETAG, HeaderName, HeaderValue, IF_NONE_MATCH, LINK,
    LOCATION, RETRY_AFTER,
};
use axum::http::{Method, Uri};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{Redirect, Response};
use axum::routing::get;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::cors::{AllowOrigin, CorsLayer};
use tower_http::request_id::{MakeRequestUuid, PropagateRequestIdLayer, SetRequestIdLayer};
use tower_http::trace::{DefaultOnResponse, TraceLayer};
use tracing::Level;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::app::App;
use super::{
    docs, events, health, jobs, metrics, previews, problem, problem_pages, reference, results,
    studies, submit, tables,
};
use crate::wire::{Code, Problem};

/// A request has its answer's head within this time. Longer than the longest wait that a client may ask for.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(90);

/// The service.
pub fn router(app: App) -> Router {
    let edge = Arc::clone(&app.edge);
    let (router, mut openapi) = routes().split_for_parts();
    openapi.servers = Some(vec![docs::server(&edge.public_url)]);

    let router = router
        .merge(docs::routes_of_docs(&openapi))
        .route("/", get(|| async { Redirect::to("/docs/") }))
        .fallback(nothing_here)
        .method_not_allowed_fallback(not_that_method)
        .layer(CatchPanicLayer::custom(problem::of_panic))
        .layer(from_fn(limit_time))
        .layer(from_fn_with_state(Arc::clone(&edge), problem::shape))
        .layer(CompressionLayer::new().gzip(true));
    let router = if edge.cors_origins.is_empty() {
        router
    } else {
        router.layer(cors(&edge.cors_origins))
    };
    router
        .layer(PropagateRequestIdLayer::x_request_id())
        .layer(from_fn(metrics::count))
        .layer(
            TraceLayer::new_for_http()
                .make_span_with(span)
                .on_response(DefaultOnResponse::new().level(Level::INFO)),
        )
        .layer(SetRequestIdLayer::x_request_id(MakeRequestUuid))
        .with_state(app)
}

/// The routes that the OpenAPI document describes.
pub(super) fn routes() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(docs::introduction())
        .routes(routes!(submit::submit, jobs::list))
        .routes(routes!(jobs::show, jobs::delete))
        .routes(routes!(jobs::cancel))
        .routes(routes!(results::results))
        .routes(routes!(tables::table))
        .routes(routes!(events::events))
        .routes(routes!(previews::preview))
        .routes(routes!(studies::submit, studies::list))
        .routes(routes!(studies::show, studies::delete))
        .routes(routes!(studies::results))
        .routes(routes!(studies::results_csv))
        .routes(routes!(studies::events))
        .routes(routes!(studies::cancel))
        .routes(routes!(reference::validate))
        .routes(routes!(reference::examples))
        .routes(routes!(reference::limits))
        .routes(routes!(problem_pages::index))
        .routes(routes!(problem_pages::page_of))
        .routes(routes!(health::live))
        .routes(routes!(health::ready))
        .routes(routes!(metrics::metrics))
}

async fn nothing_here(uri: Uri) -> Problem {
    Problem::new(
        Code::NotFound,
        format!(
            "There is nothing at {}. /docs lists what there is.",
            uri.path()
        ),
    )
}

async fn not_that_method(method: Method, uri: Uri) -> Problem {
    Problem::new(
        Code::MethodNotAllowed,
        format!(
            "{} does not take {method}; the header Allow says what it takes.",
            uri.path()
        ),
    )
}

async fn limit_time(request: Request, next: Next) -> Response {
    match tokio::time::timeout(REQUEST_TIMEOUT, next.run(request)).await {
        Ok(response) => response,
        Err(_) => problem::too_slow(REQUEST_TIMEOUT),
    }
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
        .allow_methods([Method::GET, Method::HEAD, Method::POST, Method::DELETE])
        .allow_headers([
            ACCEPT,
            AUTHORIZATION,
            CONTENT_TYPE,
            IF_NONE_MATCH,
            name("idempotency-key"),
            name("last-event-id"),
            name("prefer"),
            name("x-request-id"),
        ])
        .expose_headers([
            ETAG,
            LINK,
            LOCATION,
            RETRY_AFTER,
            name("content-location"),
            name("preference-applied"),
            name("server-timing"),
            name("x-request-id"),
        ])
        .max_age(Duration::from_secs(3600))
}

/// What stands in the log beside a request: never its query or headers, which may hold secrets.
fn span(request: &Request) -> tracing::Span {
    let id = request
        .headers()
        .get("x-request-id")
        .and_then(|id| id.to_str().ok())
        .unwrap_or_default();
    tracing::info_span!("request", method = %request.method(), path = request.uri().path(), request_id = id)
}
