//! Spans, told to a collector that here is a listener of the test.

use std::sync::{Arc, Mutex};

use axum::Router;
use axum::body::Bytes;
use axum::routing::post;
use opentelemetry_proto::tonic::collector::trace::v1::ExportTraceServiceRequest;
use opentelemetry_proto::tonic::common::v1::any_value::Value as Attribute;
use opentelemetry_proto::tonic::trace::v1::Span;
use prost::Message;
use reqwest::Client;
use serde_json::{Value, json};
use tokio::net::TcpListener;

use crate::bench::{Asked, PATIENCE, WAIT};
use crate::process::Process;
use crate::stores;

/// A collector: its address, and what it was told.
async fn collector() -> (String, Arc<Mutex<Vec<Span>>>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    let told = Arc::new(Mutex::new(Vec::new()));
    let spans = Arc::clone(&told);
    let take = async move |body: Bytes| {
        let message = ExportTraceServiceRequest::decode(body).unwrap();
        for resource in message.resource_spans {
            let about = resource.resource.unwrap();
            assert_eq!(text(&about.attributes, "service.name"), "meshwright");
            let scopes = resource.scope_spans.into_iter();
            spans
                .lock()
                .unwrap()
                .extend(scopes.flat_map(|scope| scope.spans));
        }
        Bytes::new()
    };
    let router = Router::new().route("/v1/traces", post(take));
    tokio::spawn(async move { axum::serve(listener, router).await });
    (address, told)
}

fn text(attributes: &[opentelemetry_proto::tonic::common::v1::KeyValue], key: &str) -> String {
    let found = attributes.iter().find(|attribute| attribute.key == key);
    let value = found.and_then(|found| found.value.clone()?.value);
    match value {
        Some(Attribute::StringValue(text)) => text,
        Some(Attribute::IntValue(number)) => number.to_string(),
        other => panic!("{key}: {other:?}"),
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn job(torque: f64) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 },
    });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [torque],
    })
}

/// Submits a job under a trace and waits for its end. Gives back its id.
async fn compute(client: &Client, base: &str, torque: f64, parent: &str) -> String {
    let request = client.post(format!("{base}/v1/jobs"));
    let request = request.header("traceparent", parent).json(&job(torque));
    let answer = request.answer().await;
    assert_eq!(answer.status(), 202);
    let made = answer.document().await;
    let id = made["id"].as_str().unwrap().to_owned();
    let wait = client.get(format!("{base}/v1/jobs/{id}"));
    let ended = wait.header("prefer", WAIT).answer().await;
    let ended = ended.document().await;
    assert_eq!(ended["status"], "successful");
    id
}

#[tokio::test]
async fn a_request_points_to_the_job_that_it_makes_and_the_end_tells_what_is_left() {
    let (address, told) = collector().await;
    let folder = tempfile::tempdir().unwrap();
    let place = stores::place(&folder).await;
    let process = Process::start_with(&place, &["--otlp-endpoint", &address]);
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let trace = "0af7651916cd43dd8448eb211c80319c";
    let parent = format!("00-{trace}-b7ad6b7169203331-01");
    let id = compute(&client, &process.base, 1.0, &parent).await;
    // Whoever began the trace wants nothing told.
    let unsampled = "00-1af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-00";
    compute(&client, &process.base, 2.0, unsampled).await;
    // Health is asked for all the time.
    process.get(&client, "/health/ready").await;
    tokio::task::spawn_blocking(|| process.terminate())
        .await
        .unwrap();

    let told = told.lock().unwrap();
    let of = |trace: &str, name: &str| -> Vec<Span> {
        let fits = |span: &&Span| hex(&span.trace_id) == trace && span.name == name;
        told.iter().filter(fits).cloned().collect()
    };
    let [request] = of(trace, "POST /v1/jobs").try_into().unwrap();
    assert_eq!(hex(&request.parent_span_id), "b7ad6b7169203331");
    assert_eq!(
        text(&request.attributes, "http.response.status_code"),
        "202"
    );
    let of_job = id.replace('-', "");
    let [whole] = of(&of_job, "job").try_into().unwrap();
    let [attempt] = of(&of_job, "compute").try_into().unwrap();
    let [link] = request.links.try_into().unwrap();
    assert_eq!(
        (link.trace_id, link.span_id),
        (whole.trace_id, whole.span_id.clone())
    );
    assert_eq!(attempt.parent_span_id, whole.span_id);
    assert!(whole.parent_span_id.is_empty());
    assert_eq!(text(&whole.attributes, "meshwright.job.id"), id);
    assert_eq!(text(&attempt.attributes, "meshwright.job.attempt"), "1");
    assert!(whole.start_time_unix_nano <= attempt.start_time_unix_nano);
    assert!(attempt.start_time_unix_nano <= attempt.end_time_unix_nano);
    assert_eq!(attempt.end_time_unix_nano, whole.end_time_unix_nano);
    assert!(
        told.iter()
            .all(|span| !hex(&span.trace_id).starts_with("1af"))
    );
    assert!(told.iter().all(|span| !span.name.contains("/health")));
}

#[tokio::test]
async fn a_collector_that_takes_nothing_holds_up_no_request_and_no_end() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    tokio::spawn(async move {
        let mut held = Vec::new();
        while let Ok((stream, _)) = listener.accept().await {
            held.push(stream);
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let place = stores::place(&folder).await;
    let process = Process::start_with(&place, &["--otlp-endpoint", &address]);
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let parent = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
    for torque in 1..20 {
        compute(&client, &process.base, f64::from(torque), parent).await;
    }
    // The program cuts itself off, and fails, where an end takes longer than it may.
    let end = tokio::task::spawn_blocking(|| process.terminate());
    end.await.unwrap();
}
