//! The program itself, its real engine, and SIGKILL in the middle of a study.
//!
//! The large one is ignored, because it takes a minute or more: `./test it -- --ignored --nocapture thousand`.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::process::Process;
use crate::stores;

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
async fn small_designs_that_are_computed_together_are_each_done_once_whoever_kills_their_process() {
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let client = meshwright::client().build().unwrap();
    let first = Process::start_with(&database, &["--workers", "1"]);
    let mut study = patterns("load_distribution", &[], &[], &[]);
    let torques: Vec<Value> = (1..=400).map(|torque| json!([torque])).collect();
    study["axes"] = json!([{ "path": "/output_torques_n_m", "values": torques }]);
    let path = first.submit(&client, &study).await;
    first.done(&client, &path, 10).await;
    first.kill();
    stores::pass_a_lease(&database).await;
    let second = Process::start_with(&database, &["--workers", "1"]);
    let study = second.done(&client, &path, 400).await;
    assert_eq!(
        (&study["successful"], &study["failed"]),
        (&json!(400), &json!(0))
    );
    let left = "select count(*) from jobs where status <> 'successful' or same_as is not null";
    assert_eq!(stores::number(&database, left).await, 0);
    let documents = "select count(*) from documents";
    assert_eq!(
        stores::number(&database, documents).await,
        400,
        "each has its own results, once"
    );
}

#[tokio::test]
async fn a_study_killed_half_way_is_finished_by_the_next_process_with_every_design() {
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let client = meshwright::client().build().unwrap();
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
    stores::pass_a_lease(&database).await;

    let second = Process::start(&database);
    let after = second.get(&client, &path).await;
    assert!(
        after["successful"].as_u64() >= before["successful"].as_u64(),
        "what was computed is kept"
    );
    let ended = second.done(&client, &path, 60).await;
    assert_eq!(ended["status"], "successful");
    assert_eq!(ended["successful"], 60);
    check_table(&second.get(&client, &format!("{path}/results")).await, 60);
}

/// Bound of the compressed bytes of a result for each of its positions.
///
/// Seven numbers of a position are unlike those of others. Three are the transmission error and both stiffnesses. There is half an order of the spectrum for each
/// position, with two amplitudes and two phases, and a third of a point between, with the first three. Ten decimal digits are 33 bits, hence 29 bytes of
/// information. Deflate, which sees digits but no curve, needs twice as many: measured are 53 with all that repeats.
const BYTES_A_POSITION: u64 = 60;

/// Bound of the bytes of a design beside its result. The submission takes a page of 4 kB, the summary 2 kB. The rest are the job, the row of the table, their
/// indexes, and the part of a page that a document leaves free.
const BYTES_BESIDE: u64 = 16_000;

#[tokio::test]
#[ignore = "computes two thousand designs, which takes a minute or more"]
async fn a_thousand_decomposition_designs_straight_through_and_killed_half_way() {
    let study = patterns(
        "decomposition",
        &[6, 7, 8, 9, 10],
        &spread(4.0, 7.0, 20),
        &spread(29.0, 34.0, 10),
    );
    let client = meshwright::client().build().unwrap();
    for kill in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let database = stores::place(&folder).await;
        let mut process = Process::start(&database);
        let empty = stores::bytes(&database).await;
        let start = Instant::now();
        let path = process.submit(&client, &study).await;
        println!("taken after {:.3} s", start.elapsed().as_secs_f64());
        if kill {
            process.done(&client, &path, 500).await;
            process.kill();
            stores::pass_a_lease(&database).await;
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
        let read = read.elapsed();
        let memory = process.peak_memory_mb();
        let bytes = stores::bytes(&database).await - empty;
        let positions = "select cast(sum(positions_total) as bigint) from jobs";
        let positions = stores::number(&database, positions).await.unsigned_abs();
        let documents = "select cast(sum(length(body)) as bigint) from documents";
        let documents = stores::number(&database, documents).await.unsigned_abs();
        println!(
            "1000 designs of {positions} positions in {seconds:.2} s, {:.1} a second; the table took {read:.3?}; peak memory {memory} MB; database {} MB, of which results {} MB",
            1000.0 / seconds,
            bytes / 1_000_000,
            documents / 1_000_000,
        );
        assert!(read < Duration::from_secs(5), "{read:?}");
        assert!(memory < 400, "{memory} MB");
        assert_eq!(positions, 1_240_000);
        assert!(
            documents < BYTES_A_POSITION * positions,
            "{documents} bytes"
        );
        assert!(bytes < documents + 1000 * BYTES_BESIDE, "{bytes} bytes");
        process.kill();
    }
}
