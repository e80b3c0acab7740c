//! Connections that say nothing, half of something, or take nothing: none of them stops the service or its end.

use std::time::Duration;

use meshwright::config::Config;
use reqwest::RequestBuilder;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

use crate::admission::key_of;
use crate::bench::{Asked, Bench, PATIENCE, eventually, problem, results, submission};

async fn service(adjust: impl FnOnce(&mut Config)) -> Bench {
    Bench::start(adjust, std::sync::Arc::new(|_, _| Ok(results()))).await
}

async fn connect(bench: &Bench) -> TcpStream {
    TcpStream::connect(bench.service().address().unwrap())
        .await
        .unwrap()
}

/// Comes back when the service has closed the connection.
async fn closed(mut stream: TcpStream) {
    let mut rest = Vec::new();
    let end = tokio::time::timeout(PATIENCE, stream.read_to_end(&mut rest));
    // It may be closed in order or reset.
    let _ = end.await.expect("the connection is closed");
}

#[tokio::test]
async fn a_connection_that_sends_no_head_in_time_is_closed() {
    let bench = service(|config| config.admission.idle_time = Duration::from_millis(200)).await;
    let silent = connect(&bench).await;
    let mut slow = connect(&bench).await;
    slow.write_all(b"GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nX-A")
        .await
        .unwrap();
    let mut between = connect(&bench).await;
    between
        .write_all(b"GET /health/live HTTP/1.1\r\nHost: localhost\r\n\r\n")
        .await
        .unwrap();
    for stream in [silent, slow, between] {
        closed(stream).await;
    }
}

#[tokio::test]
async fn silent_connections_give_way_to_those_who_ask() {
    let bench = service(|config| config.admission.connections = 16).await;
    let mut silent = Vec::new();
    for _ in 0..100 {
        silent.push(connect(&bench).await);
    }
    let answer = bench.get("/v1/jobs").answer().await;
    assert_eq!(answer.status(), 200);
    // The first that came is the first that went.
    closed(silent.remove(0)).await;
}

#[tokio::test]
async fn a_client_whose_requests_never_come_whole_locks_no_other_one_out() {
    let bench = service(|config| config.admission.connections = 16).await;
    let (hog, other) = (key_of(&bench, "hog").await, key_of(&bench, "other").await);
    let head = format!(
        "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {hog}\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n"
    );
    let service = bench.service().address().unwrap();
    let mut hanging = tokio::task::JoinSet::new();
    for _ in 0..20 {
        let head = head.clone();
        hanging.spawn(async move {
            loop {
                let mut stream = TcpStream::connect(service).await.unwrap();
                // Each comes again when it was sent away.
                if stream.write_all(head.as_bytes()).await.is_ok() {
                    let _ = stream.read(&mut [0]).await;
                }
                tokio::time::sleep(Duration::from_millis(50)).await;
            }
        });
    }
    tokio::time::sleep(Duration::from_millis(500)).await;
    for _ in 0..4 {
        // Each on a connection of its own, which has to find a place. On a busy machine it may be evicted before its head is read.
        let answer = eventually(async || {
            let request = bench.get("/v1/jobs").bearer_auth(&other);
            request.header("connection", "close").send().await
        });
        assert_eq!(answer.await.status(), 200);
    }
}

#[tokio::test]
async fn the_streams_of_one_client_leave_most_connections_to_others() {
    let adjust = |config: &mut Config| config.admission.connections = 16;
    let (bench, _engine) = Bench::steered_with(adjust).await;
    let (hog, other) = (key_of(&bench, "hog").await, key_of(&bench, "other").await);
    let request = bench.post("/v1/jobs", &submission(1.0)).bearer_auth(&hog);
    let job = request.document().await;
    let events = format!("/v1/jobs/{}/events", job["id"].as_str().unwrap());
    let mut streams = Vec::new();
    for _ in 0..16 / 8 {
        let stream = bench.get(&events).bearer_auth(&hog).answer().await;
        assert_eq!(stream.status(), 200);
        streams.push(stream);
    }
    problem(bench.get(&events).bearer_auth(&hog), 429, "rate_limited").await;
    let answer = bench.get("/v1/jobs").bearer_auth(&other).answer().await;
    assert_eq!(answer.status(), 200);
}

/// A preview that has begun. Where most connections are new, one of them is evicted for a further one: the service says first that it reads
/// the request.
async fn lasting_preview(bench: &Bench, key: &str) -> TcpStream {
    let body = submission(1.0).to_string();
    let length = body.len();
    let head = format!(
        "POST /v1/preview HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {key}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\nExpect: 100-continue\r\n\r\n"
    );
    let mut stream = connect(bench).await;
    stream.write_all(head.as_bytes()).await.unwrap();
    let mut answer = [0; 25];
    stream.read_exact(&mut answer).await.unwrap();
    assert_eq!(&answer, b"HTTP/1.1 100 Continue\r\n\r\n");
    stream.write_all(body.as_bytes()).await.unwrap();
    stream
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn one_client_has_a_quarter_of_the_connections_busy_and_health_is_answered_where_all_are() {
    let adjust = |config: &mut Config| {
        config.admission.connections = 16;
        config.previews = 32;
    };
    let (bench, _engine) = Bench::steered_with(adjust).await;
    let mut keys = Vec::new();
    for client in ["hog", "b", "c", "d", "other"] {
        keys.push(key_of(&bench, client).await);
    }
    // Each on a connection of its own: one that is kept alive could be evicted while the next request is sent on it.
    let alone =
        |request: RequestBuilder, key: &str| request.bearer_auth(key).header("connection", "close");
    let mut lasting = tokio::task::JoinSet::new();
    for _ in 0..6 {
        let request = alone(bench.post("/v1/preview", &submission(1.0)), &keys[0]);
        lasting.spawn(request.answer());
    }
    for _ in 0..2 {
        let refusal = lasting.join_next().await.unwrap().unwrap();
        assert_eq!(refusal.headers()["retry-after"], "1");
        problem(refusal, 503, "overloaded").await;
    }
    let jobs = || alone(bench.get("/v1/jobs"), &keys[4]);
    let answer = jobs().answer().await;
    assert_eq!(answer.status(), 200, "it leaves three quarters to others");
    // Four clients have them all.
    let mut previews = Vec::new();
    for key in &keys[1..4] {
        for _ in 0..4 {
            previews.push(lasting_preview(&bench, key).await);
        }
    }
    for path in ["/health/live", "/health/ready"] {
        let request = bench.get(path).header("connection", "close");
        assert_eq!(request.answer().await.status(), 200, "{path}");
    }
    problem(jobs(), 503, "overloaded").await;
}

#[tokio::test]
async fn half_a_head_does_not_hold_a_shutdown_up_and_an_answer_under_way_is_finished() {
    let (mut bench, mut engine) = Bench::steered().await;
    let mut slow = connect(&bench).await;
    slow.write_all(b"GET /v1/jobs HTTP/1.1\r\nHost: localhost\r\nX-A")
        .await
        .unwrap();
    let preview = bench.post("/v1/preview", &submission(1.0));
    let preview = tokio::spawn(preview.send());
    // The request has arrived when the engine is asked.
    let work = engine.next().await;
    let ((), answer) = tokio::join!(bench.shut_down(), preview);
    problem(answer.unwrap().unwrap(), 503, "unavailable").await;
    drop(work);
    closed(slow).await;
}

#[tokio::test]
async fn a_head_that_is_too_large_is_refused() {
    let bench = service(|_| {}).await;
    let mut stream = connect(&bench).await;
    // As many bytes as a head may have, and it is not at its end: all of them are read, so that the answer comes whole.
    let mut head = b"GET / HTTP/1.1\r\nHost: localhost\r\nX-A: ".to_vec();
    head.resize(32 << 10, b'a');
    stream.write_all(&head).await.unwrap();
    let mut answer = String::new();
    let read = tokio::time::timeout(PATIENCE, stream.read_to_string(&mut answer));
    read.await.unwrap().unwrap();
    assert!(answer.starts_with("HTTP/1.1 431"), "{answer}");
}

#[tokio::test]
async fn a_body_that_is_too_long_is_refused_before_it_is_sent() {
    let bench = service(|_| {}).await;
    for (length, media_type) in [(1_u64 << 60, "application/json"), (2, "text/plain")] {
        let mut stream = connect(&bench).await;
        let head = format!(
            "POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: {media_type}\r\nContent-Length: {length}\r\nExpect: 100-continue\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).await.unwrap();
        let mut answer = [0; 12];
        stream.read_exact(&mut answer).await.unwrap();
        let answer = String::from_utf8_lossy(&answer);
        assert!(answer.starts_with("HTTP/1.1 41"), "{answer}");
    }
}

#[tokio::test]
async fn a_request_without_a_host_is_refused() {
    let bench = service(|_| {}).await;
    let mut stream = connect(&bench).await;
    stream
        .write_all(b"GET /v1/jobs HTTP/1.1\r\nConnection: close\r\n\r\n")
        .await
        .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).await.unwrap();
    assert!(
        answer.starts_with("HTTP/1.1 400") && answer.contains("invalid_parameter"),
        "{answer}"
    );
}
