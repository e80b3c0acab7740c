//! A disk that is really full: a file system of 12 MB in memory, filled up under the running service and emptied again.
//! Needs the right to mount; without it nothing is shown, and the test says so.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection};

use crate::bench::{Asked, Bench, PATIENCE, ended, eventually, problem, submission};
use crate::process::Process;

/// A small file system, gone when it is dropped.
struct Small {
    folder: PathBuf,
    _held: tempfile::TempDir,
}

impl Small {
    fn mount(megabytes: u32) -> Option<Self> {
        let held = tempfile::tempdir().unwrap();
        let folder = held.path().join("disk");
        fs::create_dir(&folder).unwrap();
        let size = format!("size={megabytes}m");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", &size, "meshwright-test"])
            .arg(&folder)
            .output();
        let works = mounted.is_ok_and(|output| output.status.success());
        works.then_some(Self {
            folder,
            _held: held,
        })
    }
}

impl Drop for Small {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.folder).status();
    }
}

/// Takes every byte that is left.
fn fill(folder: &Path) -> PathBuf {
    let filler = folder.join("filler");
    let _ = Command::new("dd")
        .args(["if=/dev/zero", "bs=4096"])
        .arg(format!("of={}", filler.display()))
        .output();
    filler
}

fn job(number: u32) -> Value {
    let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
    json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [20.0 + f64::from(number)],
        "resolution": { "span_mesh_periods": 40 },
    })
}

async fn status(client: &Client, url: String) -> u16 {
    client.get(url).answer().await.status().as_u16()
}

#[tokio::test]
async fn a_full_disk_stops_nothing_for_longer_than_it_is_full() {
    let Some(disk) = Small::mount(12) else {
        println!("NOT SHOWN: this user may not mount a file system.");
        return;
    };
    let process = Process::start_with(
        &DatabaseAddress::File(disk.folder.join("meshwright.db")),
        &["--keep-gb", "0"],
    );
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let mut taken = Vec::new();
    let mut filler = None;
    let ready = format!("{}/health/ready", process.base);
    let mut not_ready = false;
    for number in 0..400 {
        let request = client
            .post(format!("{}/v1/jobs", process.base))
            .json(&job(number));
        let answer = request.answer().await;
        match answer.status().as_u16() {
            202 => {
                let job = answer.document().await;
                taken.push(job["id"].as_str().unwrap().to_owned());
            }
            503 => {
                assert!(answer.headers().contains_key("retry-after"));
                let problem = answer.document().await;
                assert_eq!(problem["code"], "storage_unavailable");
                // Who cannot take a submission is not ready, as often as it is asked.
                for _ in 0..16 {
                    assert_eq!(status(&client, ready.clone()).await, 503);
                }
                not_ready = true;
                break;
            }
            other => panic!("{other}"),
        }
        if number == 30 {
            filler = Some(fill(&disk.folder));
        }
    }
    assert_eq!(
        status(&client, format!("{}/health/live", process.base)).await,
        200
    );
    assert!(not_ready, "the service is ready on a full disk");
    // What stands can be read all the while.
    assert_eq!(
        status(&client, format!("{}/v1/jobs/{}", process.base, taken[0])).await,
        200
    );

    fs::remove_file(filler.unwrap()).unwrap();
    eventually(
        async || match status(&client, format!("{}/health/ready", process.base)).await {
            200 => Ok(()),
            other => Err(other),
        },
    )
    .await;
    for id in &taken {
        let url = format!("{}/v1/jobs/{id}", process.base);
        let ended = ended(|| client.get(&url)).await;
        assert_eq!(ended["status"], "successful", "{ended}");
    }
    println!("{} jobs taken and successful", taken.len());
}

/// The exit code of `meshwright serve` on a database that it cannot use, and what it says.
fn serve(database: &Path) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .args(["serve", "--listen", "127.0.0.1:0"])
        .env("MESHWRIGHT_DATABASE", database)
        .output()
        .unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), told)
}

#[test]
fn a_start_on_a_full_disk_says_so_and_is_worth_repeating() {
    let Some(disk) = Small::mount(2) else {
        println!("NOT SHOWN: this user may not mount a file system.");
        return;
    };
    let path = disk.folder.join("meshwright.db");
    let filler = fill(&disk.folder);
    let (code, told) = serve(&path);
    assert!(
        code == Some(1) && told.contains("the disk is full"),
        "{code:?} {told}"
    );
    fs::remove_file(filler).unwrap();
    Process::start(&DatabaseAddress::File(path)).kill();
}

#[tokio::test]
#[ignore = "./test all"]
async fn a_start_on_a_file_that_another_program_holds_is_worth_repeating() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("meshwright.db");
    Process::start(&DatabaseAddress::File(path.clone())).kill();
    let options = SqliteConnectOptions::new().filename(&path);
    let mut other = options.connect().await.unwrap();
    let holds = "pragma locking_mode = exclusive; begin exclusive";
    sqlx::raw_sql(holds).execute(&mut other).await.unwrap();
    // It waits for the lock for 5 s.
    let (code, told) = serve(&path);
    assert!(
        code == Some(1) && told.contains("another program has locked it"),
        "{code:?} {told}"
    );
}

#[tokio::test]
async fn a_database_that_cannot_be_written_is_refused_with_a_reason_and_an_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("meshwright.db");
    let run = |command: &[&str], database: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_meshwright"))
            .args(command)
            .env("MESHWRIGHT_DATABASE", database)
            .output()
            .unwrap();
        (
            output.status.code(),
            String::from_utf8(output.stderr).unwrap(),
        )
    };
    fs::write(&path, "this is no database, whatever its name says").unwrap();
    let pipe = folder.path().join("pipe");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    for (code, told) in [
        serve(&path),
        run(&["migrate"], &path),
        run(&["keys", "list"], &path),
        serve(&pipe),
    ] {
        assert_eq!(code, Some(3), "{told}");
        assert!(
            told.contains("no SQLite database") && told.contains("nothing was changed"),
            "{told}"
        );
    }
    // A server that is not there may come, and then it helps to start again.
    for server in [
        "postgres://127.0.0.1:1/jobs",
        "postgres://nowhere.invalid/jobs",
    ] {
        let (code, told) = serve(Path::new(server));
        assert_eq!(code, Some(1), "{told}");
        assert!(told.contains("cannot use the database"), "{told}");
    }

    // Of another program, which has it open: its bytes are the same afterwards, to the last one.
    for (number, made) in [
        "create table jobs (id integer); create table letters (id integer)",
        "create table _sqlx_migrations (version integer); create table jobs (id integer)",
        "create view letters as select 1",
        "pragma user_version = 3",
        "pragma journal_mode = wal; create table letters (id integer)",
        "pragma journal_mode = wal; pragma application_id = 77",
    ]
    .into_iter()
    .enumerate()
    {
        let path = folder.path().join(format!("other-{number}.db"));
        let options = SqliteConnectOptions::new()
            .filename(&path)
            .create_if_missing(true);
        let mut other = options.connect().await.unwrap();
        sqlx::raw_sql(made).execute(&mut other).await.unwrap();
        let bytes = || {
            (
                fs::read(&path).unwrap(),
                fs::read(path.with_extension("db-wal")).ok(),
            )
        };
        let before = bytes();
        let (code, told) = serve(&path);
        assert!(
            code == Some(3) && told.contains("another program"),
            "{made}: {code:?} {told}"
        );
        assert_eq!(bytes(), before, "{made}");
        other.close().await.unwrap();
    }

    let Some(disk) = Small::mount(12) else {
        println!("NOT SHOWN: this user may not mount a file system.");
        return;
    };
    let path = disk.folder.join("meshwright.db");
    Process::start(&DatabaseAddress::File(path.clone())).kill();
    let remounted = Command::new("mount")
        .args(["-o", "remount,ro"])
        .arg(&disk.folder)
        .status();
    assert!(remounted.unwrap().success());
    let (code, told) = serve(&path);
    assert!(
        code == Some(3) && told.contains("read-only"),
        "{code:?} {told}"
    );
    // So it is where there is no file yet, and none can be made.
    let (code, told) = serve(&disk.folder.join("other.db"));
    assert!(
        code == Some(3) && told.contains("read-only"),
        "{code:?} {told}"
    );
}

#[tokio::test]
async fn a_file_that_was_removed_takes_nothing_more_and_says_so() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(1.0)).await;
    bench.ended(&path).await;
    let file = bench.config.database.file().unwrap().to_owned();
    let journal = PathBuf::from(format!("{}-wal", file.display()));
    for (torque, file) in [(2.0, file), (3.0, journal)] {
        let moved = file.with_extension("moved");
        fs::rename(&file, &moved).unwrap();
        let answer = bench.post("/v1/jobs", &submission(torque)).answer().await;
        problem(answer, 503, "storage_unavailable").await;
        let ready = bench.get("/health/ready").answer().await;
        assert_eq!(ready.status(), 503);
        // Another file of this name is not the one that is served.
        fs::copy(&moved, &file).unwrap();
        let answer = bench.post("/v1/jobs", &submission(torque)).answer().await;
        problem(answer, 503, "storage_unavailable").await;
        // It is there again, and so is the service.
        fs::rename(&moved, &file).unwrap();
        while bench.get("/health/ready").answer().await.status() != 200 {
            tokio::task::yield_now().await;
        }
        // Nothing is under way when the next file goes.
        let path = bench.submit(&submission(torque)).await;
        bench.ended(&path).await;
    }
}
