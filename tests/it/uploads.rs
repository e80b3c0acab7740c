//! Many large documents of one client at once, and slow ones: they take turns, in a bounded memory, and another client notices
//! little. `./chaos` measures it at length.

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use crate::bench::{Asked, PATIENCE, submission};
use crate::flood::shared_by;
use crate::process::Process;
use crate::stores;

/// A study of 15 MB, none of whose designs can be built: a base without teeth.
fn large() -> String {
    let designs: Vec<Value> = (0..60_000)
        .map(|i| {
            let label = format!("{i}-{}", "x".repeat(150));
            let changes = json!({ "/pair/driven/blank/bore_radius_mm": 10.0, "/pair/driving/blank/bore_radius_mm": 11.0 });
            json!({ "label": label, "changes": changes })
        })
        .collect();
    json!({ "base": { "method": "flexible" }, "designs": designs }).to_string()
}

/// A study of as many designs as there may be, all of which can be built. What is made of it takes far more than its 6 MB.
fn rich() -> String {
    let designs: Vec<Value> = (0..100_000)
        .map(|i| {
            let changes = json!({ "/output_torques_n_m": [f64::from(i % 900) + 1.5] });
            json!({ "label": i.to_string(), "changes": changes })
        })
        .collect();
    json!({ "base": submission(100.0), "designs": designs }).to_string()
}

async fn upload(request: reqwest::RequestBuilder) -> u16 {
    request.answer().await.status().as_u16()
}

/// What `count` of them at once come to.
struct Borne {
    /// The most memory, in MB.
    memory: u64,
    took: Duration,
    /// The medians of a list and of a check that another client asks for meanwhile.
    medians: [Duration; 2],
}

async fn bear(count: usize, body: String) -> Borne {
    let (_folder, process, [hog, other]) = shared_by(["hog", "other"], &[]).await;
    let client = meshwright::client().timeout(6 * PATIENCE).build().unwrap();
    let url = |path: &str| format!("{}{path}", process.base);
    let (body, start) = (bytes::Bytes::from(body), Instant::now());
    let uploads: Vec<_> = (0..count)
        .map(|_| {
            let request = client.post(url("/v1/studies")).bearer_auth(&hog);
            let request = request.header("content-type", "application/json");
            tokio::spawn(upload(request.body(body.clone())))
        })
        .collect();
    let mut asked = [Vec::new(), Vec::new()];
    while !uploads.iter().all(tokio::task::JoinHandle::is_finished) {
        let questions = [
            client.get(url("/v1/jobs")),
            client.post(url("/v1/validate")).json(&submission(100.0)),
        ];
        for (question, asked) in questions.into_iter().zip(&mut asked) {
            let start = Instant::now();
            assert_eq!(question.bearer_auth(&other).answer().await.status(), 200);
            asked.push(start.elapsed());
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    let took = start.elapsed();
    for upload in uploads {
        let status = upload.await.unwrap();
        // One client may have so many designs waiting, and no more.
        assert!([202, 422, 429].contains(&status), "{status}");
    }
    let medians = asked.map(|mut asked| {
        asked.sort();
        asked[asked.len() / 2]
    });
    Borne {
        memory: process.peak_memory_mb(),
        took,
        medians,
    }
}

impl Borne {
    fn check_memory(&self, what: &str) {
        let Self {
            memory,
            took,
            medians: [list, check],
        } = self;
        println!(
            "{what} at once: {took:?}, at most {memory} MB; another client's list {list:?}, check {check:?} (medians)"
        );
        // Side by side they would take more than this.
        assert!(*memory < 600, "{memory} MB");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn large_documents_are_read_in_turns_in_a_bounded_memory() {
    let _alone = stores::ALONE.lock().await;
    let borne = bear(12, large()).await;
    borne.check_memory("12 uploads of 13 MB");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn studies_of_many_designs_are_weighed_by_what_is_made_of_them() {
    let _alone = stores::ALONE.lock().await;
    let borne = bear(6, rich()).await;
    borne.check_memory("6 studies of 100,000 designs");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn forty_large_uploads_leave_the_service_to_others() {
    for (what, body) in [
        ("40 uploads of 13 MB", large()),
        ("40 studies of 100,000 designs", rich()),
    ] {
        let borne = bear(40, body).await;
        borne.check_memory(what);
        let slowest = borne.medians.into_iter().max().unwrap();
        assert!(slowest < Duration::from_millis(20), "{slowest:?}");
        assert!(borne.took < Duration::from_secs(60), "{:?}", borne.took);
    }
}

/// Bodies of one client that never come to their end. Had each all memory that it may take once it is here, they would leave 120 bytes of
/// 256 MiB.
async fn slow_bodies(process: &Process, key: &str) -> Vec<TcpStream> {
    let host = process.base.trim_start_matches("http://");
    let (large, small) = (16 << 20, 1 << 20);
    let rest = (256 << 20) / 6 - 2 * large - 20;
    let studies = [large, large, rest].map(|length| ("/v1/studies", length));
    let bodies = studies.into_iter().chain([("/v1/validate", small); 43]);
    let mut streams = Vec::new();
    for (path, length) in bodies {
        let mut stream = TcpStream::connect(host).await.unwrap();
        let head = format!(
            "POST {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {key}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n{{"
        );
        stream.write_all(head.as_bytes()).await.unwrap();
        streams.push(stream);
    }
    streams
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_sends_slowly_keeps_no_other_client_waiting() {
    let _alone = stores::ALONE.lock().await;
    let (_folder, process, [hog, other]) = shared_by(["hog", "other"], &[]).await;
    let client = meshwright::client().timeout(2 * PATIENCE).build().unwrap();
    let slow = slow_bodies(&process, &hog).await;
    // They are there, and wait.
    tokio::time::sleep(Duration::from_millis(300)).await;
    let small = submission(100.0).to_string();
    // One that has to wait for memory, if there is none.
    let middling = format!("{small}{}", " ".repeat(500_000));
    for _ in 0..3 {
        for body in [&small, &middling] {
            let request = client.post(format!("{}/v1/validate", process.base));
            let request = request.header("content-type", "application/json");
            let request = request.bearer_auth(&other).body(body.clone());
            assert_eq!(upload(request).await, 200);
        }
    }
    // The slow bodies are still awaited: nobody was answered because they were given up.
    for stream in &slow {
        let unread = stream.try_read(&mut [0]).unwrap_err();
        assert_eq!(unread.kind(), std::io::ErrorKind::WouldBlock);
    }
}
