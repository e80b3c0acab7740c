//! SIGKILL at random moments: no job that was taken is lost, none has two results, and all are equal to those of a run that
//! nobody disturbed.
//!
//! Two rounds run with the tests; twenty of two hundred jobs by `./chaos`.

use std::sync::Arc;
use std::time::{Duration, Instant};

use meshwright::jobs::DatabaseAddress;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_studies::solve;
use meshwright_wire::Submission;
use reqwest::Client;
use serde_json::{Value, json};
use tokio::sync::Mutex;

use crate::bench::{Asked, PATIENCE, ended};
use crate::generated::Chance;
use crate::process::Process;
use crate::stores;
use crate::submitters::{Bases, Submitters, Taken};

/// Jobs of a few milliseconds, each another one.
fn job(number: u64) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 },
        "tip_relief": { "amount_um": 5.0, "start": { "radial_length_mm": 1.75 } },
    });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [20.0 + number as f64 * 0.25],
        "resolution": { "span_mesh_periods": 20 },
    })
}

/// What a round came to.
#[derive(Default)]
struct Tally {
    kills: u32,
    ready: Vec<Duration>,
}

async fn round(seed: u64, jobs: u64, kills: u32, database: &DatabaseAddress) -> Tally {
    let mut chance = Chance(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let mut tally = Tally::default();
    let mut process = Process::start(database);
    let bases: Bases = Arc::new(Mutex::new(vec![process.base.clone()]));
    let submitters = Submitters::start(&client, &bases, jobs, job);
    for _ in 0..kills {
        tokio::time::sleep(Duration::from_millis(30 + chance.below(400) as u64)).await;
        process.kill();
        stores::pass_a_lease(database).await;
        tally.kills += 1;
        let start = Instant::now();
        process = Process::start(database);
        let ready = client
            .get(format!("{}/health/ready", process.base))
            .answer()
            .await;
        assert_eq!(ready.status(), 200);
        tally.ready.push(start.elapsed());
        *bases.lock().await = vec![process.base.clone()];
    }
    check(&client, &process, &submitters.taken().await).await;
    tally
}

/// Every job that was taken has its one result, the one of a run that nobody disturbed.
async fn check(client: &Client, process: &Process, taken: &Taken) {
    let library = Library::with_capacity(256 << 20);
    for (number, id) in taken {
        let url = format!("{}/v1/jobs/{id}", process.base);
        let ended = ended(|| client.get(&url)).await;
        assert_eq!(ended["status"], "successful", "job {number}: {ended}");
        let text = client.get(format!("{url}/results")).whole_text().await;
        let submission = Submission::parse(job(*number).to_string().as_bytes()).unwrap();
        assert_eq!(
            text,
            solve(&submission, &library, &Run::unattended())
                .and_then(|results| results.to_json())
                .unwrap(),
            "job {number}"
        );
    }
    let mut listed = 0;
    let mut path = "/v1/jobs?limit=200".to_owned();
    loop {
        let page = process.get(client, &path).await;
        listed += page["items"].as_array().unwrap().len();
        match page["next"].as_str() {
            Some(cursor) => path = format!("/v1/jobs?limit=200&cursor={cursor}"),
            None => break,
        }
    }
    assert_eq!(listed, taken.len(), "no job that nobody knows of");
}

async fn rounds(seeds: std::ops::Range<u64>, jobs: u64, kills: u32) {
    let mut all = Tally::default();
    for seed in seeds.clone() {
        let folder = tempfile::tempdir().unwrap();
        let tally = round(seed, jobs, kills, &stores::place(&folder).await).await;
        all.kills += tally.kills;
        all.ready.extend(tally.ready);
    }
    all.ready.sort();
    let rounds = seeds.end - seeds.start;
    println!(
        "{rounds} rounds, {} kills, {} jobs taken and successful, none lost, none twice, all equal; ready again after {:?} (median), {:?} (longest)",
        all.kills,
        rounds * jobs,
        all.ready[all.ready.len() / 2],
        all.ready.last().unwrap(),
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn kills_at_random_moments_lose_no_job_and_double_none() {
    rounds(1..3, 40, 2).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes minutes; ./chaos runs it"]
async fn twenty_rounds_of_kills_lose_no_job_of_two_hundred() {
    rounds(100..120, 200, 3).await;
}
