//! What a client can know without a job: whether a submission would do, examples, and limits.

use std::sync::LazyLock;

use axum::Json;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use meshwright_studies::MOST_DESIGNS;
use meshwright_studies::table::{QuantityEntry, quantities as all_quantities};
use meshwright_wire::declare::document;
use meshwright_wire::{Limits, Submission, Validation};
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::app::App;
use super::batch::MOST_IN_BATCH;
use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Onlooker;
use super::problem::Refusal;
use super::static_files::StaticFile;
use crate::compute::PreviewRules;
use crate::jobs::Rules;
use crate::webhooks::most_webhooks;

/// Check a submission
///
/// Makes no job. Answers with the submission as it would be computed, the pair's derived geometry, warnings, and an
/// estimate of size and time; or with the problem that a job would meet. Made to be called on every edit of a form.
#[utoipa::path(
    post, path = "/v1/validate", tag = "Reference", operation_id = "validate",
    request_body(content = Submission, content_type = "application/json", description = "The submission."),
    responses(
        (status = 200, description = "The submission can be computed.", body = Validation),
        JsonBody,
        (status = 422, description = "The submission cannot be computed; `errors` says which field is why."),
        (status = 503, description = "Too many submissions are checked at once. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn validate(
    onlooker: Onlooker,
    JsonBody(document, _memory): JsonBody,
) -> Result<Json<Validation>, Refusal> {
    #[expect(clippy::disallowed_methods, reason = "in `blocking`")]
    let validation = blocking(onlooker.name(), move |_| {
        Submission::parse(&document).map(|it| meshwright_wire::validate(&it))
    });
    Ok(Json(validation.await??))
}

document! {
    /// A submission to start from.
    pub(super) struct Example as Example view of (example: &meshwright_wire::Example) {
        /// A short name.
        name: &'static str = example.name,
        /// What it shows.
        description: &'static str = example.description,
        /// Whether it can be computed. One cannot, on purpose: it shows what a refusal looks like.
        valid: bool = example.valid,
        /// The submission, ready for `POST /v1/jobs`.
        #[schema(value_type = Submission)]
        submission: Value = serde_json::from_str(example.json).expect("a test reads every example"),
    }
}

/// The examples.
#[derive(Serialize, ToSchema)]
pub(super) struct Examples {
    /// The examples.
    items: Vec<Example>,
}

/// Get examples
///
/// Submissions to start from: the test cases of the paper and its study.
#[utoipa::path(
    get, path = "/v1/examples", tag = "Reference", operation_id = "get_examples",
    security(()),
    responses((status = 200, description = "The examples.", body = Examples)),
)]
pub(super) async fn examples(request: HeaderMap) -> Response {
    static EXAMPLES: LazyLock<StaticFile> = LazyLock::new(|| {
        let items = meshwright_wire::examples()
            .iter()
            .map(Example::of)
            .collect();
        let json = serde_json::to_vec(&Examples { items }).expect("examples are plain data");
        StaticFile::document("application/json", json)
    });
    EXAMPLES.answer(&request).await
}

/// The quantities.
#[derive(Serialize, ToSchema)]
pub(super) struct Quantities {
    /// The quantities, in the order of the columns of a table.
    items: Vec<QuantityEntry>,
}

/// Get quantities
///
/// The numbers by which designs are told: columns of tables, goals and bounds of searches, and what populations tell have these names. Each says what it
/// is called, its unit, which way it is better, and which submissions tell it.
#[utoipa::path(
    get, path = "/v1/quantities", tag = "Reference", operation_id = "get_quantities",
    security(()),
    responses((status = 200, description = "The quantities.", body = Quantities)),
)]
pub(super) async fn quantities(request: HeaderMap) -> Response {
    static QUANTITIES: LazyLock<StaticFile> = LazyLock::new(|| {
        let items = all_quantities().collect();
        let json = serde_json::to_vec(&Quantities { items }).expect("quantities are plain data");
        StaticFile::document("application/json", json)
    });
    QUANTITIES.answer(&request).await
}

document! {
    /// The limits of every submission, and those of this service.
    pub(super) struct ServiceLimits as ServiceLimits, "Limits" view of (app: &App) {
        #[serde(flatten)]
        submission: Limits = Limits::of(MOST_DESIGNS),
        /// What previews are allowed.
        previews: PreviewLimits = PreviewLimits::of(app.previews.rules()),
        /// What one client is allowed.
        client: ClientLimits = ClientLimits::of(app.jobs.rules()),
    }
}

document! {
    /// What one client is allowed, unless its key says otherwise.
    pub(super) struct ClientLimits as ClientLimits, "ClientLimits" view of (rules: &Rules) {
        /// The most jobs that may wait, those of studies aside.
        jobs_waiting: u32 = rules.client_queue_limit,
        /// The most designs of studies that may wait.
        designs_waiting: i64 = rules.client_design_limit,
        /// The most memory that one job may take, in MB.
        job_memory_mb: u64 = rules.job_memory_mb,
        /// The most submissions of a batch.
        batch: usize = MOST_IN_BATCH,
        /// The most webhooks.
        webhooks: i64 = most_webhooks(),
    }
}

document! {
    /// What previews are allowed.
    pub(super) struct PreviewLimits as PreviewLimits, "PreviewLimits"
    view of (rules: PreviewRules) {
        /// The most positions times torques of one.
        positions: u64 = rules.most_positions,
        /// The most at once.
        at_once: usize = rules.at_once,
        /// From the request to its answer, in seconds.
        time_limit_seconds: u64 = rules.time_limit.as_secs(),
    }
}

/// Get limits
///
/// The bounds that submissions must keep, and those of previews.
#[utoipa::path(
    get, path = "/v1/limits", tag = "Reference", operation_id = "get_limits",
    security(()),
    responses((status = 200, description = "The limits.", body = ServiceLimits)),
)]
pub(super) async fn limits(State(app): State<App>) -> Json<ServiceLimits> {
    Json(ServiceLimits::of(&app))
}
