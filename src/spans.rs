//! Spans for a collector of OpenTelemetry (OTLP): each request, and each job from its submission to its end.
//!
//! A span is exported when it has ended and dropped when the collector does not take it: it waits in a bounded queue, and nobody waits for that.
//! The trace of a job has the job's id, so that a request that submits one can point to it, whichever process computes it and when.

use std::borrow::Cow;
use std::sync::OnceLock;
use std::time::{Duration, SystemTime};

use opentelemetry::trace::{
    Link, SpanContext, SpanId, SpanKind, Status, TraceFlags, TraceId, TraceState,
};
use opentelemetry::{InstrumentationScope, KeyValue};
use opentelemetry_otlp::{Protocol, SpanExporter, WithExportConfig, WithHttpConfig};
use opentelemetry_sdk::Resource;
use opentelemetry_sdk::trace::{SpanData, SpanExporter as _, SpanLinks};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};
use tokio_util::sync::CancellationToken;
use tracing::{info, warn};
use uuid::Uuid;

use crate::client::bounded;

/// So many spans wait to be taken; further ones are dropped.
const MOST_WAITING: usize = 8192;

/// So many go in one message, and so long it is waited for more of them.
const AT_ONCE: usize = 512;
const GATHERING: Duration = Duration::from_secs(1);

/// A collector takes a message in so much time.
const TIME_OUT: Duration = Duration::from_secs(5);

/// At the end it has so much time for what is left: with all of [`END`](crate::serve::END) before it, less than ten seconds.
const LAST: Duration = Duration::from_millis(400);

/// Where spans wait for their export. Like the numbers of the process, they are of the process.
static QUEUE: OnceLock<Sender<SpanData>> = OnceLock::new();

/// The export of spans.
pub struct Spans {
    end: CancellationToken,
    exporting: JoinHandle<()>,
}

impl Spans {
    /// Exports spans to the collector at `endpoint` from now on.
    ///
    /// # Errors
    ///
    /// When the address is none, or there is no encryption to be had.
    pub fn start(endpoint: &str) -> anyhow::Result<Self> {
        let url = format!("{}/v1/traces", endpoint.trim_end_matches('/'));
        let mut exporter = SpanExporter::builder()
            .with_http()
            .with_http_client(bounded(TIME_OUT).build()?)
            .with_protocol(Protocol::HttpBinary)
            .with_endpoint(url)
            .with_timeout(TIME_OUT)
            .build()?;
        let version = KeyValue::new("service.version", env!("CARGO_PKG_VERSION"));
        let resource = Resource::builder()
            .with_service_name("meshwright")
            .with_attribute(version);
        exporter.set_resource(&resource.build());
        let (queue, waiting) = channel(MOST_WAITING);
        let _ = QUEUE.set(queue);
        let end = CancellationToken::new();
        let exporting = tokio::spawn(export_all(exporter, waiting, end.clone()));
        Ok(Self { end, exporting })
    }

    /// Exports what is left, as far as the collector takes it soon.
    pub async fn end(self) {
        self.end.cancel();
        if timeout(LAST, self.exporting).await.is_err() {
            warn!("some spans were not exported");
        }
    }
}

async fn export_all(
    exporter: SpanExporter,
    mut waiting: Receiver<SpanData>,
    end: CancellationToken,
) {
    let mut works = true;
    let mut batch = Vec::with_capacity(AT_ONCE);
    loop {
        tokio::select! {
            _ = waiting.recv_many(&mut batch, AT_ONCE) => {}
            () = end.cancelled() => {}
        }
        if batch.len() < AT_ONCE {
            tokio::select! {
                () = sleep(GATHERING) => {}
                () = end.cancelled() => {}
            }
        }
        while batch.len() < AT_ONCE
            && let Ok(span) = waiting.try_recv()
        {
            batch.push(span);
        }
        if batch.is_empty() {
            return;
        }
        let taken = exporter.export(std::mem::take(&mut batch)).await;
        match (&taken, works) {
            (Ok(()), false) => info!("the collector takes spans again"),
            (Err(error), true) => warn!(%error, "the collector takes no spans; they are dropped"),
            _ => {}
        }
        works = taken.is_ok();
    }
}

/// Whether there is a collector.
pub(crate) fn are_exported() -> bool {
    QUEUE.get().is_some()
}

/// Something that took some time.
pub(crate) struct Span {
    pub(crate) place: SpanContext,
    pub(crate) parent: SpanId,
    /// Whether its parent is another program's.
    pub(crate) is_entry: bool,
    pub(crate) name: Cow<'static, str>,
    pub(crate) begin: SystemTime,
    pub(crate) end: SystemTime,
    pub(crate) attributes: Vec<KeyValue>,
    /// What it has caused and does not wait for.
    pub(crate) causes: Vec<SpanContext>,
    pub(crate) failed: bool,
}

/// Exports a span, if there is a collector. One that finds no place is dropped.
pub(crate) fn export(span: impl FnOnce() -> Span) {
    let Some(queue) = QUEUE.get() else {
        return;
    };
    let Ok(place) = queue.try_reserve() else {
        metrics::counter!("meshwright_spans_forgotten_total").increment(1);
        return;
    };
    place.send(span().into_data());
}

impl Span {
    fn into_data(self) -> SpanData {
        let mut links = SpanLinks::default();
        let link = |place: SpanContext| Link::new(place, Vec::new(), 0);
        links.links = self.causes.into_iter().map(link).collect();
        SpanData {
            span_context: self.place,
            parent_span_id: self.parent,
            parent_span_is_remote: self.is_entry && self.parent != SpanId::INVALID,
            span_kind: if self.is_entry {
                SpanKind::Server
            } else {
                SpanKind::Internal
            },
            name: self.name,
            start_time: self.begin,
            end_time: self.end.max(self.begin),
            attributes: self.attributes,
            dropped_attributes_count: 0,
            events: Default::default(),
            links,
            status: if self.failed {
                Status::error("")
            } else {
                Status::Unset
            },
            instrumentation_scope: InstrumentationScope::builder("meshwright").build(),
        }
    }
}

/// The place of a span that is exported.
pub(crate) fn place(trace: [u8; 16], span: [u8; 8]) -> SpanContext {
    SpanContext::new(
        TraceId::from_bytes(trace),
        SpanId::from_bytes(span),
        TraceFlags::SAMPLED,
        false,
        TraceState::NONE,
    )
}

/// The place of a job, from its submission to its end, or of one attempt at it (from 1 on), which is a part of it.
pub(crate) fn place_of_job(id: Uuid, attempt: Option<i64>) -> SpanContext {
    let (_, low) = id.as_u64_pair();
    let span = low.wrapping_add_signed(attempt.unwrap_or(0));
    place(id.into_bytes(), span.to_be_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trace_of_a_job_has_its_id_and_its_attempts_are_other_spans() {
        let id = Uuid::from_u128(0x0123_4567_89ab_7def_8123_4567_89ab_cdef);
        let job = place_of_job(id, None);
        assert_eq!(job.trace_id().to_string(), id.simple().to_string());
        assert_eq!(job.span_id().to_string(), "8123456789abcdef");
        let attempt = place_of_job(id, Some(1));
        assert_eq!(attempt.trace_id(), job.trace_id());
        assert_eq!(attempt.span_id().to_string(), "8123456789abcdf0");
    }
}
