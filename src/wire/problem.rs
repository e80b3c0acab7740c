//! A stand-in for the problem documents (RFC 9457).

use serde::Serialize;
use utoipa::ToSchema;

/// A problem document.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct Problem {
    /// Where the problem is explained.
    #[serde(rename = "type")]
    pub type_: String,
    /// What kind of problem it is.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// What is wrong this time.
    pub detail: String,
    /// The stable code.
    pub code: Code,
    /// What is wrong with which field.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
}

/// What is wrong with one field.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct FieldError {
    /// JSON pointer.
    pub pointer: String,
    /// The stable code.
    pub code: Code,
    /// What is wrong.
    pub detail: String,
    /// The nearest value that would do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<f64>,
}

macro_rules! codes {
    ($($name:ident $slug:literal $status:literal $title:literal)*) => {
        /// The stable codes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum Code { $(#[doc = $title] $name,)* }

        impl Code {
            /// All codes.
            pub const ALL: &[Code] = &[$(Code::$name,)*];
            /// The last part of the problem's type.
            pub fn slug(self) -> &'static str { match self { $(Code::$name => $slug,)* } }
            /// The HTTP status.
            pub fn status(self) -> u16 { match self { $(Code::$name => $status,)* } }
            /// What kind of problem it is.
            pub fn title(self) -> &'static str { match self { $(Code::$name => $title,)* } }
            /// A paragraph of explanation.
            pub fn explanation(self) -> &'static str { self.title() }
        }
    };
}

codes! {
    MalformedJson "malformed-json" 400 "The body is not JSON"
    UnknownField "unknown-field" 422 "A field is not known"
    TimeLimit "time-limit" 422 "The job took longer than its limit"
    ResultNotReady "result-not-ready" 404 "The result is not ready yet"
    JobNotFound "job-not-found" 404 "There is no such job"
    NotFound "not-found" 404 "There is nothing here"
    MethodNotAllowed "method-not-allowed" 405 "This resource does not take that method"
    UnsupportedMediaType "unsupported-media-type" 415 "The body is not of a type that is read here"
    QueueFull "queue-full" 503 "The queue is full"
    PayloadTooLarge "payload-too-large" 413 "The body is too large"
    IdempotencyConflict "idempotency-conflict" 422 "The idempotency key was used for another submission"
    InvalidParameter "invalid-parameter" 400 "A query parameter or header is not understood"
    JobRunning "job-running" 409 "The job is running"
    JobFinished "job-finished" 409 "The job has ended"
    JobFailed "job-failed" 409 "The job failed"
    JobDismissed "job-dismissed" 409 "The job was dismissed"
    AttemptsExhausted "attempts-exhausted" 500 "The job was lost too often"
    RequestTimeout "request-timeout" 408 "The request took too long"
    InternalError "internal-error" 500 "The service failed"
}

impl Problem {
    /// A problem of a kind, with what is wrong this time.
    pub fn new(code: Code, detail: impl Into<String>) -> Self {
        Self {
            type_: format!("/problems/{}", code.slug()),
            title: code.title().to_owned(),
            status: code.status(),
            detail: detail.into(),
            code,
            errors: Vec::new(),
        }
    }
}
