//! What a client can know without a job: whether a submission would do, examples, and limits.

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::app::App;
use super::document::Document;
use crate::wire::{self, Limits, Problem, Submission, Validation};

/// Check a submission
///
/// Makes no job. Answers with the submission as it would be computed, the pair's derived geometry, warnings, and an
/// estimate of size and time; or with the problem that a job would meet. Made to be called on every edit of a form.
#[utoipa::path(
    post, path = "/v1/validate", tag = "Reference", operation_id = "validate",
    request_body(content = Submission, content_type = "application/json", description = "The submission."),
    responses(
        (status = 200, description = "The submission can be computed.", body = Validation),
        (status = 400, description = "The body is no JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 408, description = "The body came too slowly.", body = Problem, content_type = "application/problem+json"),
        (status = 413, description = "The body has more than 1 MiB.", body = Problem, content_type = "application/problem+json"),
        (status = 415, description = "The body is not declared as JSON.", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "The submission cannot be computed; `errors` says which field is why.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn validate(Document(document): Document) -> Result<Json<Validation>, Problem> {
    let submission = Submission::parse(&document)?;
    Ok(Json(wire::validate(&submission)))
}

/// A submission to start from.
#[derive(Serialize, ToSchema)]
pub(super) struct Example {
    /// A short name.
    name: &'static str,
    /// What it shows.
    description: &'static str,
    /// Whether it can be computed. One cannot, on purpose: it shows what a refusal looks like.
    valid: bool,
    /// The submission, ready for `POST /v1/jobs`.
    #[schema(value_type = Object)]
    submission: Value,
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
    responses((status = 200, description = "The examples.", body = Examples)),
)]
pub(super) async fn examples() -> Json<Examples> {
    let view = |example: &wire::Example| Example {
        name: example.name,
        description: example.description,
        valid: example.valid,
        submission: serde_json::from_str(example.json).expect("a test reads every example"),
    };
    Json(Examples {
        items: wire::examples().iter().map(view).collect(),
    })
}

/// The limits of every submission, and those of this service.
#[derive(Serialize, ToSchema)]
#[schema(title = "Limits")]
pub(super) struct ServiceLimits {
    #[serde(flatten)]
    submission: Limits,
    /// What previews are allowed.
    previews: PreviewLimits,
}

/// What previews are allowed.
#[derive(Serialize, ToSchema)]
#[schema(title = "Limits of previews")]
struct PreviewLimits {
    /// The most positions times torques of one.
    positions: u64,
    /// The most at once.
    at_once: usize,
    /// From the request to its answer, in seconds.
    time_limit_seconds: u64,
}

/// Get limits
///
/// The bounds that submissions must keep, and those of previews.
#[utoipa::path(
    get, path = "/v1/limits", tag = "Reference", operation_id = "get_limits",
    responses((status = 200, description = "The limits.", body = ServiceLimits)),
)]
pub(super) async fn limits(State(app): State<App>) -> Json<ServiceLimits> {
    let rules = app.previews.rules();
    Json(ServiceLimits {
        submission: wire::limits(),
        previews: PreviewLimits {
            positions: rules.most_positions,
            at_once: rules.at_once,
            time_limit_seconds: rules.time_limit.as_secs(),
        },
    })
}
