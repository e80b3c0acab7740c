//! Studies and single jobs, and two clients, all at once: each gets its part. (`crates/store/src/tests/turns.rs` holds the rule turn
//! by turn; this is what comes of it in the program.)

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use reqwest::Client;
use serde_json::{Value, json};

use crate::bench::WAIT;
use crate::process::Process;
use crate::stores;

fn base(torque: f64) -> Value {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [torque],
        "resolution": { "span_mesh_periods": 100 },
    })
}

/// Sends one job after the other, and waits for each.
async fn ask(client: Client, base_url: String, first: u32, ended: Arc<AtomicU64>) {
    for number in 0.. {
        let job = base(20.0 + f64::from(first) + f64::from(number) / 1e4);
        let request = client.post(format!("{base_url}/v1/jobs"));
        let answer = request.header("prefer", WAIT).json(&job).send().await;
        if answer.is_ok_and(|answer| answer.status() == 200) {
            ended.fetch_add(1, Ordering::Relaxed);
        }
    }
}

fn study(first: f64) -> Value {
    let values: Vec<[f64; 1]> = (0..10_000).map(|i| [first + f64::from(i) / 1e3]).collect();
    json!({ "base": base(first), "axes": [{ "path": "/output_torques_n_m", "values": values }] })
}

async fn shares(seconds: u64) -> (u64, u64, u64) {
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start(&stores::place(&folder).await);
    let client = meshwright::client().build().unwrap();
    let first = process.submit(&client, &study(100.0)).await;
    let second = process.submit(&client, &study(200.0)).await;
    let ended = Arc::new(AtomicU64::new(0));
    let before = (
        process.done(&client, &first, 0).await,
        process.done(&client, &second, 0).await,
    );
    let asking: Vec<_> = (0..6)
        .map(|i| {
            let work = ask(client.clone(), process.base.clone(), i, Arc::clone(&ended));
            tokio::spawn(work)
        })
        .collect();
    tokio::time::sleep(Duration::from_secs(seconds)).await;
    let singles = ended.load(Ordering::Relaxed);
    let done =
        |now: &Value, then: &Value| now["done"].as_u64().unwrap() - then["done"].as_u64().unwrap();
    let after = (
        process.done(&client, &first, 0).await,
        process.done(&client, &second, 0).await,
    );
    for one in asking {
        one.abort();
    }
    process.kill();
    (
        singles,
        done(&after.0, &before.0),
        done(&after.1, &before.1),
    )
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes twenty seconds; ./chaos runs it"]
async fn two_studies_advance_together_beside_six_who_ask_without_a_pause() {
    let (singles, first, second) = shares(20).await;
    println!(
        "in 20 s: {singles} single jobs of six who wait for each; {first} and {second} designs of two studies"
    );
    let designs = first + second;
    assert!(designs * 10 > singles, "studies do not starve");
    assert!(singles * 2 > designs, "nor do those who wait");
    assert!(
        first.abs_diff(second) * 5 < designs,
        "studies advance together"
    );
}
