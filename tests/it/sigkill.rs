//! The program itself, its real engine, and SIGKILL in the middle of a study.
//!
//! The large one is ignored, because it takes a minute or more: `./test it -- --ignored --nocapture thousand`.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use reqwest::Client;
use serde_json::{Value, json};

/// A service in a process of its own.
struct Process {
    child: Child,
    base: String,
}

impl Process {
    fn start(database: &Path) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_meshwright"))
            .args(["serve", "--listen", "127.0.0.1:0", "--database"])
            .arg(database)
            .env("MESHWRIGHT_LOG", "warn")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        // The first line says where it listens.
        let output = BufReader::new(child.stdout.take().unwrap());
        let line = output.lines().next().unwrap().unwrap();
        let base = line
            .split_whitespace()
            .find(|word| word.starts_with("http://"))
            .unwrap();
        let base = base.trim_end_matches(';').to_owned();
        Self { child, base }
    }

    /// SIGKILL: nothing is written, nobody is told.
    fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    async fn get(&self, client: &Client, path: &str) -> Value {
        let response = client
            .get(format!("{}{path}", self.base))
            .send()
            .await
            .unwrap();
        assert_eq!(response.status(), 200, "{path}");
        response.json().await.unwrap()
    }

    async fn submit(&self, client: &Client, study: &Value) -> String {
        let response = client
            .post(format!("{}/v1/studies", self.base))
            .json(study)
            .send()
            .await
            .unwrap();
        assert_eq!(response.status(), 202);
        response.headers()["location"].to_str().unwrap().to_owned()
    }

    /// Looks at the study until so many designs are done.
    async fn done(&self, client: &Client, path: &str, count: u64) -> Value {
        loop {
            let study = self.get(client, path).await;
            if study["done"].as_u64().unwrap() >= count {
                return study;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// The most memory that the process has had, in MB, where the system tells.
    fn peak_memory_mb(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
        let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
        Some(kilobytes / 1000)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // A test that fails leaves no process behind; one that was killed before is no error.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Hole patterns of the standard pair: different blanks on the same teeth.
fn patterns(method: &str, counts: &[u32], radii: &[f64], circles: &[f64]) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0,
        "tip_relief": { "amount_um": 5.0, "start": { "radial_length_mm": 1.75 } },
        "blank": { "bore_radius_mm": 15.0 },
    });
    let holes = "/pair/driven/blank/holes";
    json!({
        "base": {
            "method": method,
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [115.0],
        },
        "axes": [
            { "path": format!("{holes}/count"), "values": counts },
            { "path": format!("{holes}/radius_mm"), "values": radii },
            { "path": format!("{holes}/circle_radius_mm"), "values": circles },
        ],
    })
}

fn spread(from: f64, to: f64, count: u32) -> Vec<f64> {
    let step = (to - from) / f64::from(count - 1);
    (0..count)
        .map(|i| ((from + step * f64::from(i)) * 1e4).round() / 1e4)
        .collect()
}

/// Every row has its numbers, and every design was computed once.
fn check_table(table: &Value, total: usize) {
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(rows.len(), total);
    let mut jobs: Vec<&str> = Vec::new();
    for row in rows {
        assert_eq!(row["status"], "successful", "{row}");
        let range = &row["curves"][0]["statistics"]["transmission_error_um"]["peak_to_peak"];
        assert!(range.as_f64().is_some_and(|range| range > 0.0), "{row}");
        jobs.push(row["job"].as_str().unwrap());
    }
    jobs.sort_unstable();
    jobs.dedup();
    assert_eq!(jobs.len(), total);
}

#[tokio::test]
async fn a_study_killed_half_way_is_finished_by_the_next_process_with_every_design() {
    let folder = tempfile::tempdir().unwrap();
    let database = folder.path().join("meshwright.db");
    let client = Client::new();
    let study = patterns(
        "load_distribution",
        &[6, 8, 10],
        &spread(4.0, 6.0, 10),
        &spread(30.0, 32.0, 2),
    );

    let first = Process::start(&database);
    let path = first.submit(&client, &study).await;
    let before = first.done(&client, &path, 20).await;
    first.kill();

    let second = Process::start(&database);
    let after = second.get(&client, &path).await;
    assert!(
        after["successful"].as_u64() >= before["successful"].as_u64(),
        "what was computed is kept"
    );
    let ended = second.done(&client, &path, 60).await;
    assert_eq!(
        (ended["status"].as_str(), ended["successful"].as_u64()),
        (Some("successful"), Some(60))
    );
    check_table(&second.get(&client, &format!("{path}/results")).await, 60);
}

#[tokio::test]
#[ignore = "computes two thousand designs, which takes a minute or more"]
async fn a_thousand_decomposition_designs_straight_through_and_killed_half_way() {
    let study = patterns(
        "decomposition",
        &[6, 7, 8, 9, 10],
        &spread(4.0, 7.0, 20),
        &spread(29.0, 34.0, 10),
    );
    let client = Client::new();
    for kill in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let database = folder.path().join("meshwright.db");
        let start = Instant::now();
        let mut process = Process::start(&database);
        let path = process.submit(&client, &study).await;
        println!("taken after {:.3} s", start.elapsed().as_secs_f64());
        if kill {
            process.done(&client, &path, 500).await;
            process.kill();
            println!("killed after {:.2} s", start.elapsed().as_secs_f64());
            process = Process::start(&database);
            let study = process.get(&client, &path).await;
            println!("at the restart {} are done", study["successful"]);
        }
        let ended = process.done(&client, &path, 1000).await;
        let seconds = start.elapsed().as_secs_f64();
        assert_eq!(ended["successful"], 1000);
        let read = Instant::now();
        check_table(
            &process.get(&client, &format!("{path}/results")).await,
            1000,
        );
        println!(
            "1000 designs in {seconds:.2} s, {:.1} a second; the table took {:.3} s; peak memory {:?} MB; database {} MB",
            1000.0 / seconds,
            read.elapsed().as_secs_f64(),
            process.peak_memory_mb(),
            std::fs::metadata(&database).unwrap().len() / 1_000_000,
        );
        process.kill();
    }
}
