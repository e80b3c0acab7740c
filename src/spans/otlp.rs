//! Export of spans to a collector of OpenTelemetry (OTLP over HTTP).
//!
//! A span is exported when it has ended, from a bounded queue: no request and no job waits for the collector. Spans that the collector does not take are
//! dropped.

use std::sync::OnceLock;
use std::time::Duration;

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

use super::{Place, Span, Value};
use crate::client::bounded;

/// Maximum number of spans that wait for export; further ones are dropped.
const MOST_WAITING: usize = 8192;

/// Maximum number of spans in one message, and the time to wait for more of them.
const AT_ONCE: usize = 512;
const GATHERING: Duration = Duration::from_secs(1);

/// A collector takes a message in so much time.
const TIME_OUT: Duration = Duration::from_secs(5);

/// Time for the remaining spans at the end: with all of [`END`](crate::serve::END) before it, less than ten seconds.
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

    /// Exports the remaining spans, as far as the collector takes them in time.
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

/// True once the export has begun.
pub(super) fn is_started() -> bool {
    QUEUE.get().is_some()
}

/// Puts a span into the queue, if the export has begun. A span that finds no place is dropped and counted.
pub(super) fn enqueue(span: impl FnOnce() -> Span) {
    let Some(queue) = QUEUE.get() else {
        return;
    };
    let Ok(place) = queue.try_reserve() else {
        metrics::counter!("meshwright_spans_forgotten_total").increment(1);
        return;
    };
    place.send(data(span()));
}

fn data(span: Span) -> SpanData {
    let mut links = SpanLinks::default();
    let link = |place: Place| Link::new(context(place), Vec::new(), 0);
    links.links = span.causes.into_iter().map(link).collect();
    let parent = span.parent.map_or(SpanId::INVALID, SpanId::from_bytes);
    let attribute = |(key, value)| match value {
        Value::Text(text) => KeyValue::new(key, text),
        Value::Number(number) => KeyValue::new(key, number),
    };
    SpanData {
        span_context: context(span.place),
        parent_span_id: parent,
        parent_span_is_remote: span.is_entry && parent != SpanId::INVALID,
        span_kind: if span.is_entry {
            SpanKind::Server
        } else {
            SpanKind::Internal
        },
        name: span.name,
        start_time: span.begin,
        end_time: span.end.max(span.begin),
        attributes: span.attributes.into_iter().map(attribute).collect(),
        dropped_attributes_count: 0,
        events: Default::default(),
        links,
        status: if span.failed {
            Status::error("")
        } else {
            Status::Unset
        },
        instrumentation_scope: InstrumentationScope::builder("meshwright").build(),
    }
}

/// The place of a span that is exported.
fn context(place: Place) -> SpanContext {
    SpanContext::new(
        TraceId::from_bytes(place.trace),
        SpanId::from_bytes(place.span),
        TraceFlags::SAMPLED,
        false,
        TraceState::NONE,
    )
}
