//! The program itself under what hostile clients do: bombs, and sockets that say nothing or half of something.

use std::time::{Duration, Instant};

use reqwest::Client;
use rustix::process::{Resource, getrlimit, setrlimit};
use serde_json::{Value, json};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use crate::bench::{Asked, PATIENCE};
use crate::process::Process;
use crate::stores;

/// A study of 0.7 MB that would expand to 600 million torques.
fn bomb() -> String {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    let torques: Vec<f64> = (1..=60_000).map(f64::from).collect();
    let values: Vec<f64> = (0..10_000).map(|i| 10.0 + f64::from(i) * 1e-4).collect();
    json!({
        "base": {
            "method": "flexible",
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": torques,
        },
        "axes": [{ "path": "/pair/driven/blank/bore_radius_mm", "values": values }],
    })
    .to_string()
}

/// A study of a hundred thousand designs, whose base has so many values that to check it in each would take minutes.
fn large_bomb() -> String {
    let torques: Vec<f64> = (1..=60_000).map(f64::from).collect();
    let designs: Vec<Value> = (0..100_000)
        .map(|i| json!({ "label": format!("{i}") }))
        .collect();
    json!({ "base": { "method": "flexible", "output_torques_n_m": torques }, "designs": designs })
        .to_string()
}

async fn refuse(client: Client, url: String, bomb: String) -> Duration {
    let start = Instant::now();
    let request = client.post(url).header("content-type", "application/json");
    let answer = request.body(bomb).answer().await;
    let status = answer.status();
    let problem = answer.document().await;
    assert_eq!(
        (status.as_u16(), &problem["code"]),
        (422, &json!("too_large"))
    );
    start.elapsed()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bombs_are_refused_before_they_go_off_and_hold_up_no_shutdown() {
    let _alone = stores::ALONE.lock().await;
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start(&stores::place(&folder).await);
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let url = format!("{}/v1/studies", process.base);
    let median = async |bomb: String| {
        let mut alone = Vec::new();
        for _ in 0..10 {
            alone.push(refuse(client.clone(), url.clone(), bomb.clone()).await);
        }
        alone.sort();
        alone[5]
    };
    let bomb = bomb();
    let (alone, large) = (median(bomb.clone()).await, median(large_bomb()).await);
    let together: Vec<_> = (0..22)
        .map(|_| tokio::spawn(refuse(client.clone(), url.clone(), bomb.clone())))
        .collect();
    let start = Instant::now();
    for one in together {
        one.await.unwrap();
    }
    let (all, memory) = (start.elapsed(), process.peak_memory_mb());
    assert!(memory < 400, "{memory} MB");
    // Expanded, each would take minutes of the processor.
    let spent = process.processor_seconds();
    assert!(spent < 60.0, "{spent} s");
    let end = process.terminate();
    println!(
        "a bomb of {} kB is refused after {alone:?} (median), one of a hundred thousand designs after {large:?}, 22 of the first at once after {all:?}; at most {memory} MB; ended {end:?} after SIGTERM",
        bomb.len() / 1000,
    );
}

/// Lets this process have as many descriptors as the system allows.
fn raise_descriptors() {
    let mut limit = getrlimit(Resource::Nofile);
    limit.current = limit.maximum;
    setrlimit(Resource::Nofile, limit).unwrap();
}

#[tokio::test]
#[ignore = "./test all"]
async fn two_thousand_silent_and_two_hundred_slow_sockets_do_not_stop_a_service_of_256_descriptors()
{
    raise_descriptors();
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start_with_descriptors(&stores::place(&folder).await, 256);
    let address = process.base.trim_start_matches("http://").to_owned();
    let mut sockets = Vec::new();
    for number in 0..2200 {
        let mut socket = TcpStream::connect(&address).await.unwrap();
        if number % 11 == 0 {
            // It may have been sent away already.
            let _ = socket.write_all(b"GET /v1/jobs HTTP/1.1\r\nX-A").await;
        }
        sockets.push(socket);
    }
    let client = meshwright::client().build().unwrap();
    let mut longest = Duration::ZERO;
    for _ in 0..20 {
        let start = Instant::now();
        // Each on a connection of its own, which has to find a place.
        let request = client.get(format!("{}/v1/jobs", process.base));
        let answer = request.header("connection", "close").answer().await;
        assert_eq!(answer.status(), 200);
        longest = longest.max(start.elapsed());
    }
    let end = process.terminate();
    println!(
        "beside 2,000 silent and 200 slow sockets, with 256 descriptors: answered within {longest:?}; ended {end:?} after SIGTERM"
    );
    drop(sockets);
}
