//! Many large documents of one client at once: they take turns, in a bounded memory, and another client notices little.
//! `./chaos` measures it at length.

use std::sync::Arc;
use std::time::{Duration, Instant};

use reqwest::Client;
use serde_json::{Value, json};

use crate::bench::{Asked, PATIENCE};
use crate::process::Process;
use crate::stores;

/// A study of 15 MB, none of whose designs can be built: a base without teeth.
fn large(number: usize) -> String {
    let designs: Vec<Value> = (0..60_000)
        .map(|i| {
            let label = format!("{number}-{i}-{}", "x".repeat(150));
            let changes = json!({ "/pair/driven/blank/bore_radius_mm": 10.0, "/pair/driving/blank/bore_radius_mm": 11.0 });
            json!({ "label": label, "changes": changes })
        })
        .collect();
    json!({ "base": { "method": "flexible" }, "designs": designs }).to_string()
}

async fn upload(client: Client, url: String, body: String) -> u16 {
    let request = client.post(url).header("content-type", "application/json");
    let answer = request.body(body).answer().await;
    answer.status().as_u16()
}

/// What so many at once come to: the most memory, in MB, how long they took, and the median of short questions meanwhile.
async fn bear(count: usize) -> (Option<u64>, Duration, Duration) {
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start(&stores::place(&folder).await);
    let client = meshwright::client().build().unwrap();
    let url = format!("{}/v1/studies", process.base);
    let body = Arc::new(large(0));
    assert!(body.len() > 10 << 20, "{}", body.len());
    let start = Instant::now();
    let uploads: Vec<_> = (0..count)
        .map(|_| tokio::spawn(upload(client.clone(), url.clone(), String::clone(&body))))
        .collect();
    let mut asked = Vec::new();
    while !uploads.iter().all(tokio::task::JoinHandle::is_finished) {
        let start = Instant::now();
        process.get(&client, "/v1/jobs").await;
        asked.push(start.elapsed());
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    let took = start.elapsed();
    for upload in uploads {
        let status = upload.await.unwrap();
        assert!([202, 422].contains(&status), "{status}");
    }
    asked.sort();
    (process.peak_memory_mb(), took, asked[asked.len() / 2])
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn large_documents_are_read_in_turns_in_a_bounded_memory() {
    let _alone = stores::ALONE.lock().await;
    let (memory, took, median) = tokio::time::timeout(6 * PATIENCE, bear(12)).await.unwrap();
    // Side by side they would take more than this.
    assert!(memory.is_none_or(|memory| memory < 600), "{memory:?} MB");
    println!(
        "12 uploads at once: {took:?}, at most {memory:?} MB, other questions {median:?} (median)"
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn forty_uploads_of_fifteen_megabytes() {
    let (memory, took, median) = bear(40).await;
    println!(
        "40 uploads at once: {took:?}, at most {memory:?} MB, other questions {median:?} (median)"
    );
    assert!(memory.is_none_or(|memory| memory < 600), "{memory:?} MB");
    assert!(median < Duration::from_millis(20), "{median:?}");
    assert!(took < Duration::from_secs(60), "{took:?}");
}
