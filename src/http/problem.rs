//! Errors on the wire: every one is a problem document (RFC 9457), whoever found it.

use std::any::Any;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::header::{
    CONTENT_LENGTH, CONTENT_TYPE, HeaderValue, RETRY_AFTER, WWW_AUTHENTICATE,
};
use axum::http::{HeaderMap, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use meshwright_connections::Overloaded;
use meshwright_wire::{Code, Problem, too_much_memory};
use tracing::error;

use super::edge::Edge;
use crate::compute::PreviewError;
use crate::jobs::{JobError, Status, damage_problem};
use crate::webhooks::WebhookError;

const PROBLEM_JSON: HeaderValue = HeaderValue::from_static("application/problem+json");

/// A problem, and when it may be over.
pub(super) struct Refusal {
    problem: Box<Problem>,
    retry_after: Option<Duration>,
}

impl Refusal {
    /// The client comes too often, and may come again after `wait`.
    pub(super) fn too_often(wait: Duration) -> Self {
        let detail = format!(
            "More requests came from you than one client may send; the next is taken in {:.1} s.",
            wait.as_secs_f64()
        );
        Self::until(wait, detail)
    }

    /// Too many requests come without a key that is known.
    pub(super) fn too_many_unauthenticated(wait: Duration) -> Self {
        let detail = format!(
            "More requests came without a key that is known here than are answered; the next is taken in {:.1} s. A key that is known has bounds of its own.",
            wait.as_secs_f64()
        );
        Self::until(wait, detail)
    }

    fn until(wait: Duration, detail: String) -> Self {
        Self {
            problem: Box::new(Problem::new(Code::RateLimited, detail)),
            retry_after: Some(wait),
        }
    }
}

impl<E: Into<Problem>> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self {
            problem: Box::new(error.into()),
            retry_after: None,
        }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let mut response = render(&self.problem, HeaderMap::new());
        // `shape` finds it here and completes its links.
        response
            .extensions_mut()
            .insert(Arc::<Problem>::from(self.problem));
        if let Some(wait) = self.retry_after {
            // Whole seconds, never before the time.
            let seconds = wait.as_secs_f64().ceil().max(1.0) as u64;
            response.headers_mut().insert(RETRY_AFTER, seconds.into());
        }
        response
    }
}

fn render(problem: &Problem, mut headers: HeaderMap) -> Response {
    headers.insert(CONTENT_TYPE, PROBLEM_JSON);
    headers.remove(CONTENT_LENGTH);
    if let Some(seconds) = retry_after(problem.code)
        && !headers.contains_key(RETRY_AFTER)
    {
        headers.insert(RETRY_AFTER, HeaderValue::from_static(seconds));
    }
    if problem.code == Code::Unauthorized {
        let asked = HeaderValue::from_static("Bearer realm=\"meshwright\"");
        headers.insert(WWW_AUTHENTICATE, asked);
    }
    let status = StatusCode::from_u16(problem.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    let body = serde_json::to_vec(problem).expect("a problem is plain data");
    (status, headers, body).into_response()
}

/// After so many seconds it is worth asking again.
pub(super) fn retry_after(code: Code) -> Option<&'static str> {
    match code {
        Code::ResultNotReady => Some("1"),
        // Previews take a fraction of a second each.
        Code::PreviewsFull => Some("1"),
        Code::Overloaded | Code::RateLimited | Code::ServerTimeout => Some("1"),
        Code::QueueFull
        | Code::PreviewTimeLimit
        | Code::ClientQueueFull
        | Code::Unavailable
        | Code::StorageUnavailable
        | Code::IdentityProviderUnavailable => Some("5"),
        _ => None,
    }
}

impl From<JobError> for Problem {
    fn from(error: JobError) -> Self {
        match &error {
            JobError::QueueFull { .. } => Problem::new(
                Code::QueueFull,
                format!("{}. Try again later.", sentence(&error)),
            ),
            JobError::ClientQueueFull { .. } | JobError::UserQueueFull { .. } => Problem::new(
                Code::ClientQueueFull,
                format!("{}. Try again when some have ended.", sentence(&error)),
            ),
            JobError::TooMuchMemory {
                needed_mb,
                limit_mb,
            } => too_much_memory(*needed_mb, *limit_mb),
            JobError::KeyConflict => Problem::new(
                Code::IdempotencyConflict,
                "The Idempotency-Key was used for another submission within the last day. Use a new key.",
            ),
            JobError::NotFound(_) => {
                Problem::new(Code::JobNotFound, format!("{}.", sentence(&error)))
            }
            JobError::ResultsNotKept(id) => Problem::new(
                Code::ResultsNotKept,
                format!(
                    "Of this design only the statistics were kept, as its study asked; they stand in its table. POST /v1/jobs with the submission of GET /v1/jobs/{id} computes the curves and keeps them."
                ),
            ),
            JobError::StudyNotFound(_) => {
                Problem::new(Code::StudyNotFound, format!("{}.", sentence(&error)))
            }
            JobError::StudyRunning => Problem::new(
                Code::JobRunning,
                "The study has not ended; cancel it before it is deleted.",
            ),
            JobError::StudyEnded(status) => Problem::new(
                Code::JobFinished,
                format!("The study is {} already.", status.as_str()),
            ),
            JobError::Running => Problem::new(
                Code::JobRunning,
                "The job is running; cancel it before it is deleted.",
            ),
            JobError::Ended(status) => Problem::new(
                Code::JobFinished,
                format!("The job is {} already.", status.as_str()),
            ),
            // To the client it is the same: no job was taken, and the next process will take one.
            JobError::ShuttingDown => Problem::new(
                Code::Unavailable,
                "The service is shutting down and takes no more jobs.",
            ),
            JobError::OfLaterVersion => Problem::new(
                Code::Unavailable,
                "A later version of the service took this job, which this process does not read. The processes are being renewed; try again.",
            ),
            JobError::Unavailable(_) => Problem::new(
                Code::StorageUnavailable,
                "Nothing can be stored or read now. Nothing was changed; what was taken before is safe.",
            ),
            JobError::Database(source) => {
                let cause = std::error::Error::source(source).map(ToString::to_string);
                error!(error = cause, "the database failed");
                internal()
            }
            JobError::Damaged(damage) => damage_problem(damage),
        }
    }
}

impl From<WebhookError> for Problem {
    fn from(error: WebhookError) -> Self {
        match &error {
            WebhookError::Job(error) => error.clone().into(),
            WebhookError::NotFound(_) => {
                Problem::new(Code::WebhookNotFound, format!("{}.", sentence(&error)))
            }
            WebhookError::Refused(_) | WebhookError::TooMany(_) => {
                Problem::new(Code::WebhookRefused, sentence(&error))
            }
            WebhookError::Disabled => Problem::new(
                Code::WebhookDisabled,
                "The webhook was given up because nobody took its messages; enable it first.",
            ),
        }
    }
}

impl From<PreviewError> for Problem {
    fn from(error: PreviewError) -> Self {
        match error {
            PreviewError::Full(_) => Problem::new(
                Code::PreviewsFull,
                format!("{}. Try again later.", sentence(&error)),
            ),
            PreviewError::Superseded => Problem::new(
                Code::PreviewSuperseded,
                "A newer request with the same preview_id took the place of this one.",
            ),
            PreviewError::TimeLimit(limit) => Problem::new(
                Code::PreviewTimeLimit,
                format!(
                    "The preview was stopped after {} s, the limit for one. POST /v1/jobs has more time.",
                    limit.as_secs_f64()
                ),
            ),
            PreviewError::ShuttingDown => Problem::new(
                Code::Unavailable,
                "The service is shutting down and computes no more previews.",
            ),
            PreviewError::Failed(problem) => problem,
        }
    }
}

pub(super) fn sentence(error: &impl std::error::Error) -> String {
    let text = error.to_string();
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Why a job has no results.
pub(super) fn of_missing_results(
    status: Status,
    job_problem: Option<&serde_json::Value>,
) -> Problem {
    match status {
        Status::Failed => {
            let part = |name| {
                job_problem
                    .and_then(|problem| problem.get(name))
                    .and_then(serde_json::Value::as_str)
            };
            let (code, detail) = (
                part("code").unwrap_or("unknown"),
                part("detail").unwrap_or_default(),
            );
            Problem::new(
                Code::JobFailed,
                format!("The job failed and has no results ({code}). {detail}"),
            )
        }
        Status::Dismissed => Problem::new(
            Code::JobDismissed,
            "The job was cancelled and has no results.",
        ),
        Status::Accepted | Status::Running | Status::Successful => Problem::new(
            Code::ResultNotReady,
            format!(
                "The job is {}; its results come at its end.",
                status.as_str()
            ),
        ),
    }
}

/// The answer when a handler panics: a fault of ours that ends this request only.
pub(super) fn of_panic(panic: Box<dyn Any + Send>) -> Response {
    let message = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message");
    error!(panic = message, "a handler panicked");
    Refusal::from(internal()).into_response()
}

/// The refusal of a request that is not answered now.
pub(super) fn overloaded(error: Overloaded) -> Problem {
    let detail = format!("{}. Try again in a moment.", sentence(&error));
    Problem::new(Code::Overloaded, detail)
}

pub(super) fn internal() -> Problem {
    Problem::new(
        Code::InternalError,
        "The service failed. The failure has been logged.",
    )
}

/// Gives every error the form of a problem document, and its link the public address.
pub(super) async fn shape(State(edge): State<Arc<Edge>>, request: Request, next: Next) -> Response {
    let response = next.run(request).await;
    let found = response.extensions().get::<Arc<Problem>>().cloned();
    let error = response.status().is_client_error() || response.status().is_server_error();
    let problem = match found {
        Some(_) if edge.public_url.is_empty() => return response,
        Some(problem) => (*problem).clone(),
        // The framework's own refusals, and those of the documentation pages.
        None if error && response.extensions().get::<Plain>().is_none() => {
            of_status(response.status())
        }
        None => return response,
    };
    let (parts, _) = response.into_parts();
    let type_ = format!("{}{}", edge.public_url, problem.type_);
    render(&Problem { type_, ..problem }, parts.headers)
}

/// Marks an answer that is no error although its status is one, as a health check's.
#[derive(Clone, Copy)]
pub(super) struct Plain;

fn of_status(status: StatusCode) -> Problem {
    match status {
        StatusCode::NOT_FOUND => Problem::new(Code::NotFound, "There is nothing at this address."),
        StatusCode::METHOD_NOT_ALLOWED => Problem::new(
            Code::MethodNotAllowed,
            "The resource does not take this method.",
        ),
        StatusCode::PAYLOAD_TOO_LARGE => {
            Problem::new(Code::PayloadTooLarge, "The body is too large.")
        }
        // Whatever else is not available says so in a problem of its own.
        StatusCode::SERVICE_UNAVAILABLE => Problem::new(
            Code::ServerTimeout,
            "The service did not answer in time. Try again in a moment.",
        ),
        StatusCode::UNSUPPORTED_MEDIA_TYPE => {
            Problem::new(Code::UnsupportedMediaType, "The body is not JSON.")
        }
        status if status.is_client_error() => {
            Problem::new(Code::InvalidParameter, "The request is not understood.")
        }
        _ => internal(),
    }
}
