//! Spans of requests and jobs: each request, and each job from its submission to its end.
//!
//! The trace of a job has the job's id, so that a request that submits one can point to it, whichever process computes it and when. The feature `otlp`
//! exports spans to a collector of OpenTelemetry; without it there is none, and every span is dropped.

use std::borrow::Cow;
use std::time::SystemTime;

use uuid::Uuid;

#[cfg(feature = "otlp")]
mod otlp;

#[cfg(feature = "otlp")]
pub use otlp::Spans;

/// True if there is a collector.
pub(crate) fn are_exported() -> bool {
    #[cfg(feature = "otlp")]
    return otlp::is_started();
    #[cfg(not(feature = "otlp"))]
    false
}

/// Exports a span, if there is a collector. A span that finds no place in the queue is dropped and counted.
pub(crate) fn export(span: impl FnOnce() -> Span) {
    #[cfg(feature = "otlp")]
    otlp::enqueue(span);
    #[cfg(not(feature = "otlp"))]
    let _ = span;
}

/// Place of a span: the 16 bytes of its trace's id, and the 8 bytes of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) trace: [u8; 16],
    pub(crate) span: [u8; 8],
}

impl Place {
    /// The place of a job, from its submission to its end, or of one attempt at it (from 1 on), which is a part of it.
    pub(crate) fn of_job(id: Uuid, attempt: Option<i64>) -> Self {
        let (_, low) = id.as_u64_pair();
        let span = low.wrapping_add_signed(attempt.unwrap_or(0));
        Self {
            trace: id.into_bytes(),
            span: span.to_be_bytes(),
        }
    }
}

/// Value of an attribute of a span.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Value {
    Text(Cow<'static, str>),
    Number(i64),
}

impl From<&'static str> for Value {
    fn from(text: &'static str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Self {
        Self::Number(number)
    }
}

/// Work with a beginning and an end.
#[cfg_attr(
    not(feature = "otlp"),
    expect(dead_code, reason = "the export alone reads it")
)]
pub(crate) struct Span {
    pub(crate) place: Place,
    /// The span of which this one is a part; `None` at the beginning of a trace.
    pub(crate) parent: Option<[u8; 8]>,
    /// True if its parent belongs to another program.
    pub(crate) is_entry: bool,
    pub(crate) name: Cow<'static, str>,
    pub(crate) begin: SystemTime,
    pub(crate) end: SystemTime,
    pub(crate) attributes: Vec<(&'static str, Value)>,
    /// Jobs that the span has caused and does not wait for.
    pub(crate) causes: Vec<Place>,
    pub(crate) failed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trace_of_a_job_has_its_id_and_its_attempts_are_other_spans() {
        let id = Uuid::from_u128(0x0123_4567_89ab_7def_8123_4567_89ab_cdef);
        let job = Place::of_job(id, None);
        assert_eq!(job.trace, *id.as_bytes());
        assert_eq!(u64::from_be_bytes(job.span), 0x8123_4567_89ab_cdef);
        let attempt = Place::of_job(id, Some(1));
        assert_eq!(attempt.trace, job.trace);
        assert_eq!(u64::from_be_bytes(attempt.span), 0x8123_4567_89ab_cdf0);
    }
}
