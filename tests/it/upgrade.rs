//! An upgrade while the service works: this program and one of a later version, with a migration and a field of the submission more
//! (`tests/upgrade/run` builds it), in turn and at once on one PostgreSQL, forwards and back.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use serde_json::{Value, json};
use tokio::sync::Mutex;

use crate::process::Process;
use crate::submitters::{Bases, Submitters};
use crate::{server, stores};

const JOBS: u64 = 2500;
const DESIGNS: u64 = 200;

/// A job that takes little, another one for each number.
fn job(number: u64) -> Value {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [20.0 + number as f64 * 0.125],
        "resolution": { "positions_per_mesh_period": 10 },
    })
}

/// A study whose designs are none of the jobs.
fn study(which: u64) -> Value {
    let torques: Vec<Value> = (0..DESIGNS)
        .map(|i| json!([1000 + which * DESIGNS + i]))
        .collect();
    json!({ "base": job(0), "axes": [{ "path": "/output_torques_n_m", "values": torques }] })
}

/// The processes of one version: one that answers and one that computes.
struct Version {
    api: Process,
    worker: Process,
}

/// What goes on while versions come and go.
struct Service {
    place: DatabaseAddress,
    bases: Bases,
    client: Client,
    studies: Vec<(String, String)>,
}

impl Service {
    fn start(&self, program: &str) -> Version {
        let start = |role| {
            let told = [
                "--role",
                role,
                "--workers",
                "1",
                "--lease",
                "2s",
                "--queue-limit",
                "100000",
            ];
            Process::start_program(program, &self.place, &told)
        };
        Version {
            api: start("api"),
            worker: start("worker"),
        }
    }

    async fn number(&self, query: &'static str) -> i64 {
        stores::number(&self.place, query).await
    }

    /// Takes a version into service, with a study of its own.
    async fn begin(&mut self, version: &Version) {
        self.bases.lock().await.push(version.api.base.clone());
        let path = version
            .api
            .submit(&self.client, &study(self.studies.len() as u64))
            .await;
        self.studies.push((version.api.base.clone(), path));
    }

    /// Ends a version in order, as a rolling upgrade does.
    async fn end(&mut self, version: Version) {
        self.bases
            .lock()
            .await
            .retain(|base| *base != version.api.base);
        version.worker.terminate();
        version.api.terminate();
    }

    /// Comes back when so many more jobs are done.
    async fn advance(&self, jobs: i64) {
        const DONE: &str = "select count(*) from jobs where status = 'successful'";
        let aim = self.number(DONE).await + jobs;
        self.until(DONE, aim).await;
    }

    async fn until(&self, query: &'static str, count: i64) {
        let reached = async {
            while self.number(query).await < count {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        };
        let reached = tokio::time::timeout(Duration::from_secs(120), reached).await;
        assert!(reached.is_ok(), "{query} does not come to {count}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes a program of a later version; tests/upgrade/run makes it"]
async fn versions_follow_each_other_forwards_and_back_under_load_and_nothing_fails() {
    let this = env!("CARGO_BIN_EXE_meshwright");
    let next = PathBuf::from(std::env::var_os("MESHWRIGHT_NEXT").expect("a program"));
    let next = next.to_str().unwrap();
    let mut service = Service {
        place: DatabaseAddress::Postgres(server::database().await),
        bases: Arc::new(Mutex::new(Vec::new())),
        client: meshwright::client()
            .timeout(Duration::from_secs(20))
            .build()
            .unwrap(),
        studies: Vec::new(),
    };
    let old = service.start(this);
    service.begin(&old).await;
    let submitters = Submitters::start(&service.client, &service.bases, JOBS, job);
    service.advance(200).await;

    // Forwards: the first of the new ones changes the tables under the old ones, which go on beside it.
    let new = service.start(next);
    service.begin(&new).await;
    service.advance(300).await;
    service.end(old).await;
    service.advance(200).await;

    // Back: the old program starts on tables of a later version, and leaves alone what it does not read.
    let back = service.start(this);
    service.begin(&back).await;
    service.advance(300).await;
    let of_later = "select count(*) from jobs where document_version > 1";
    assert!(
        service.number(of_later).await > 0,
        "the new version took some"
    );
    service.end(new).await;
    let left = service
        .number("select count(*) from jobs where document_version > 1 and status = 'accepted'")
        .await;
    service.advance(200).await;

    // And forwards again, for good.
    let new = service.start(next);
    service.begin(&new).await;
    service.end(back).await;
    submitters.taken().await;
    let all = i64::try_from(JOBS + DESIGNS * service.studies.len() as u64).unwrap();
    service
        .until("select count(*) from jobs where status = 'successful'", all)
        .await;

    assert_eq!(service.number("select count(*) from jobs").await, all);
    let failed = "select count(*) from jobs where status in ('failed', 'dismissed')";
    assert_eq!(service.number(failed).await, 0);
    assert_eq!(
        service
            .number("select count(*) from studies where cancelled_at is not null")
            .await,
        0
    );
    let by_both = "select count(distinct solver_version) from jobs";
    assert_eq!(service.number(by_both).await, 2);
    for (_, path) in &service.studies {
        let study = new.api.done(&service.client, path, DESIGNS).await;
        assert_eq!(study["successful"], DESIGNS, "{study}");
    }
    println!(
        "{all} jobs while versions changed three times: none lost, none failed; {left} waited for the later version when it went"
    );
}
