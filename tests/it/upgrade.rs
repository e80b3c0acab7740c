//! An upgrade while the service works: this program and one of a later version, with a migration and a field of the submission more
//! (`tests/upgrade/run` builds it), in turn and at once on one PostgreSQL, forwards and back.
//! And a file of an earlier version, which every later one opens.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use serde_json::{Value, json};
use tokio::sync::Mutex;

use crate::bench::PATIENCE;
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
        client: meshwright::client().timeout(PATIENCE).build().unwrap(),
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

/// A database that version 0.4.0 wrote and was killed over: a job, a study of two designs, a search, and a job that was being computed. It was made
/// by posting them to the last commit of that version.
const WRITTEN_BY_0_4: &[u8] = include_bytes!("fixtures/version-0.4.0.db.gz");
/// The key that it made, of the client `ann`.
const KEY_OF_0_4: &str =
    "mw_dae6cac1c69b56b8_8d1b7c5eab964199bf4667956ae5af78355b8abfd6ca14bf95f7e61db2c3ba56";

#[tokio::test]
async fn a_file_of_version_0_4_is_opened_and_nothing_in_it_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("jobs.db");
    let mut file = std::fs::File::create(&path).unwrap();
    std::io::copy(&mut flate2::read::GzDecoder::new(WRITTEN_BY_0_4), &mut file).unwrap();
    let process = Process::start_with(&DatabaseAddress::File(path), &["--keep-results", "0"]);
    let mut headers = reqwest::header::HeaderMap::new();
    let bearer = format!("Bearer {KEY_OF_0_4}").parse().unwrap();
    headers.insert(reqwest::header::AUTHORIZATION, bearer);
    let client = meshwright::client().default_headers(headers);
    let client = client.build().unwrap();

    // Results are served as they were written.
    let done = "/v1/jobs/01a21946-7aac-7220-be14-8c682aec1aa5";
    assert_eq!(process.get(&client, done).await["status"], "successful");
    let results = process.get(&client, &format!("{done}/results")).await;
    assert_eq!(results["evidence"]["solver_version"], "meshwright 0.4.0");
    let mean = &results["curves"][0]["statistics"]["transmission_error_um"]["mean"];
    assert_eq!(mean.as_f64(), Some(10.56295802));

    let studies = process.get(&client, "/v1/studies").await;
    let of = |name: &str| {
        let items = studies["items"].as_array().unwrap();
        items.iter().find(|study| study["name"] == name).unwrap()
    };
    assert_eq!(of("kept")["successful"], 2);
    assert_eq!(of("kept")["tags"], json!(["fixture"]));
    assert_eq!(
        of("found")["search"]["best"]["goals"],
        json!([0.9437638018])
    );
    let table = of("kept")["links"]["results"].as_str().unwrap();
    let table = process.get(&client, table).await;
    let bores: Vec<&Value> = table["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| &row["changes"])
        .collect();
    assert_eq!(
        bores,
        [14, 16]
            .map(|bore| json!({ "/pair/driven/blank/bore_radius_mm": bore }))
            .iter()
            .collect::<Vec<_>>()
    );

    // What was being computed is computed again.
    let killed = "/v1/jobs/01a21947-394b-763c-987a-7b7b5f2dc10a";
    loop {
        let job = process.get(&client, killed).await;
        if job["status"] == "successful" {
            break;
        }
        assert!(
            ["accepted", "running"]
                .iter()
                .any(|state| job["status"] == **state),
            "{job}"
        );
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    process.terminate();
}
