//! A population in one study: every row of it listed, streamed in each form and cancelled, with memory that does not grow with
//! it. Some hundreds run with the tests; a hundred thousand, and the figures of `docs/scaling.md`, by `tests/fleet`.

use std::time::Instant;

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use serde_json::{Value, json};

use crate::bench::{Asked, eventually};
use crate::process::Process;
use crate::{server, stores};

/// Designs that are listed one by one, each another torque, of which the statistics are kept.
fn population(designs: u32) -> Value {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    let listed: Vec<Value> = (0..designs)
        .map(|i| {
            let torque = 20.0 + f64::from(i) / 1e3;
            json!({ "label": format!("d{i}"), "changes": { "/output_torques_n_m": [torque] } })
        })
        .collect();
    json!({
        "keep": "statistics",
        "base": {
            "method": "load_distribution",
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [100.0],
            "resolution": { "positions_per_mesh_period": 10 },
        },
        "designs": listed,
    })
}

/// The text at a path, read to its end.
async fn text(process: &Process, client: &Client, path: &str) -> String {
    let response = client.get(format!("{}{path}", process.base)).send().await;
    let response = response.unwrap();
    assert_eq!(response.status(), 200, "{path}");
    response.whole_text().await
}

/// The jobs of a study, page after page.
async fn listed(process: &Process, client: &Client, study: &Value) -> usize {
    let first = study["links"]["jobs"].as_str().unwrap();
    let mut next = Some(format!("{first}&limit=200"));
    let mut count = 0;
    while let Some(path) = next {
        let page = process.get(client, &path).await;
        count += page["items"].as_array().unwrap().len();
        let cursor = page["next"].as_str();
        next = cursor.map(|cursor| format!("{first}&limit=200&cursor={cursor}"));
    }
    count
}

/// A job of a minute on a quiet machine, more than fifty times as long as its test, and of more on a busy one, where jobs give way. It takes 160 MB.
fn long_job() -> Value {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    let mut holed = gear.clone();
    holed["blank"]["holes"] = json!({ "count": 7, "radius_mm": 5.0, "circle_radius_mm": 31.0 });
    let torques: Vec<u32> = (1..=10).collect();
    json!({
        "method": "three_dimensional",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": holed },
        "output_torques_n_m": torques,
        "resolution": { "positions_per_mesh_period": 40, "grid": "coarse" },
    })
}

/// Who computes the designs of a study meanwhile.
enum Meanwhile {
    /// The only worker.
    Computed,
    /// Nobody: the only worker has a job that takes longer.
    Held,
}

/// A study of so many designs, from its submission to its cancellation. It says what that took.
async fn live_and_die(place: &DatabaseAddress, designs: u32, meanwhile: Meanwhile) {
    let client = meshwright::client().build().unwrap();
    let process = Process::start_with(place, &["--workers", "1"]);
    if let Meanwhile::Held = meanwhile {
        let job = client.post(format!("{}/v1/jobs", process.base));
        let job = job.json(&long_job()).answer().await;
        assert_eq!(job.status(), 202);
        let job = job.headers()["location"].to_str().unwrap();
        eventually(async || match process.get(&client, job).await {
            job if job["status"] == "running" => Ok(()),
            job => Err(job),
        })
        .await;
    }
    let study = population(designs);
    let sent = study.to_string().len();
    let start = Instant::now();
    let path = process.submit(&client, &study).await;
    let taken = start.elapsed();
    let rows = designs as usize;
    let lines = loop {
        let lines = text(&process, &client, &format!("{path}/results/table.ndjson")).await;
        if lines.lines().count() == rows {
            break lines;
        }
    };
    let expanded = start.elapsed();
    for (i, line) in lines.lines().enumerate().step_by(rows / 50) {
        let row: Value = serde_json::from_str(line).unwrap();
        assert_eq!(row["label"], format!("d{i}"));
    }
    let start = Instant::now();
    let state = process.get(&client, &path).await;
    assert_eq!(listed(&process, &client, &state).await, rows);
    let list = start.elapsed();
    let start = Instant::now();
    let csv = text(&process, &client, &format!("{path}/results/table.csv")).await;
    assert_eq!(csv.lines().count(), rows + 1);
    let csv_took = start.elapsed();
    let start = Instant::now();
    let again = text(&process, &client, &format!("{path}/results/table.ndjson")).await;
    assert_eq!(again.lines().count(), rows);
    let ndjson_took = start.elapsed();

    let start = Instant::now();
    let cancel = client.post(format!("{}{path}/cancel", process.base));
    let cancelled = cancel.document().await;
    let cancel = start.elapsed();
    let count = |name: &str| cancelled[name].as_u64().unwrap();
    assert_eq!(cancelled["status"], "dismissed");
    assert_eq!(
        (count("successful") + count("dismissed"), count("failed")),
        (u64::from(designs), 0),
        "{cancelled}"
    );
    if let Meanwhile::Held = meanwhile {
        assert_eq!(count("dismissed"), u64::from(designs));
    }
    let memory = process.peak_memory_mb();
    // What the document takes while it is read, and the parts that gears share; not the rows.
    assert!(memory < 600, "{memory} MB");
    println!(
        "{designs} designs, {sent} bytes sent: taken after {taken:?}, all rows after {expanded:?}; jobs listed in {list:?}, the table of {} kB streamed as NDJSON in {ndjson_took:?}, as CSV in {csv_took:?}; {} had been computed, the others dismissed in {cancel:?}; peak memory {memory} MB, database {} MB",
        again.len() / 1000,
        count("successful"),
        stores::bytes(place).await / 1_000_000,
    );
}

#[tokio::test]
async fn a_population_is_listed_streamed_and_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    live_and_die(&stores::place(&folder).await, 1200, Meanwhile::Held).await;
}

#[tokio::test]
#[ignore = "takes some minutes; tests/fleet runs it"]
async fn a_hundred_thousand_designs_are_listed_streamed_and_cancelled() {
    let folder = tempfile::tempdir().unwrap();
    live_and_die(
        &DatabaseAddress::File(folder.path().join("meshwright.db")),
        100_000,
        Meanwhile::Computed,
    )
    .await;
    live_and_die(
        &DatabaseAddress::Postgres(server::database().await),
        100_000,
        Meanwhile::Computed,
    )
    .await;
}
