//! A file is served by one process, whatever name leads to it; and a process that computes alone has one of its own.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use meshwright::jobs::DatabaseAddress;
use meshwright_wire::examples;
use serde_json::{Value, json};
use sqlx::Connection;

use crate::bench::{Asked, Bench, problem, submission};

#[tokio::test]
async fn a_database_is_served_by_one_process_only() {
    let mut bench = Bench::quick().await;
    let refusal = bench.another().await.err().unwrap();
    assert!(refusal.to_string().contains("another process"), "{refusal}");
    bench.shut_down().await;
    bench.another().await.unwrap().shut_down().await;
}

#[tokio::test]
async fn a_stored_document_that_was_changed_is_not_served() {
    let bench = Bench::quick().await;
    let path = bench.submit(&submission(1.0)).await;
    bench.ended(&path).await;
    let axes = json!([{ "path": "/output_torques_n_m/0", "values": [1, 2] }]);
    let study = json!({ "base": submission(1.0), "axes": axes });
    let study = bench.post("/v1/studies", &study).answer().await;
    let study = study.headers()["location"].to_str().unwrap().to_owned();
    bench.ended(&study).await;
    let database = bench.config.database.file().unwrap();
    let address = format!("sqlite:{}", database.display());
    let mut file = sqlx::SqliteConnection::connect(&address).await.unwrap();
    for words in [
        "update documents set body = cast(substr(body, 1, 9) || x'07' || substr(body, 11) as blob)",
        "update submissions set body = replace(body, 'flexible', 'flexibme')",
        "update study_documents set body = replace(body, 'flexible', 'flexibme')",
        "update summaries set body = replace(body, '0', '1')",
    ] {
        sqlx::query(words).execute(&mut file).await.unwrap();
    }
    for path in [
        format!("{path}/results"),
        path,
        format!("{study}/document"),
        format!("{study}/results"),
        format!("{study}/results/table.csv"),
    ] {
        let answer = bench.get(&path).header("accept-encoding", "gzip");
        problem(answer, 500, "document_damaged").await;
    }
}

#[cfg(unix)]
#[tokio::test]
async fn links_of_both_kinds_lead_to_the_same_lock() {
    let bench = Bench::quick().await;
    let database = bench.config.database.file().unwrap();
    let folder = tempfile::tempdir_in(database.parent().unwrap()).unwrap();
    let symbolic = folder.path().join("symbolic.db");
    let hard = folder.path().join("hard.db");
    std::os::unix::fs::symlink(database, &symbolic).unwrap();
    std::fs::hard_link(database, &hard).unwrap();
    for path in [symbolic, hard] {
        let refusal = bench
            .another_on(DatabaseAddress::File(path))
            .await
            .err()
            .unwrap();
        assert!(refusal.to_string().contains("another process"), "{refusal}");
    }
}

#[cfg(unix)]
#[test]
fn a_study_that_is_stopped_leaves_its_results_and_no_database() {
    let mut study: Value = serde_json::from_str(examples::STUDY_SECTION_5).unwrap();
    study["base"]["method"] = json!("load_distribution");
    let study = study.as_object_mut().unwrap();
    study.remove("designs");
    study.remove("constant_mass");
    let vary = json!([{ "path": "/pair/center_distance_mm", "kind": "uniform", "low": 100.45, "high": 100.55 }]);
    // More than anybody would wait for.
    study.insert(
        "population".into(),
        json!({ "size": 100_000, "vary": vary }),
    );
    let folder = tempfile::tempdir().unwrap();
    let (document, out) = (folder.path().join("study.json"), folder.path().join("out"));
    fs::write(&document, json!(study).to_string()).unwrap();

    let mut program = Command::new(env!("CARGO_BIN_EXE_meshwright"))
        .arg("study")
        .args([&document, Path::new("--output"), &out])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let entries = |of: &Path| fs::read_dir(of).map_or(0, Iterator::count);
    while entries(&out.join("results")) == 0 {
        assert_eq!(program.try_wait().unwrap(), None);
        sleep(Duration::from_millis(10));
    }
    let id = program.id().to_string();
    let stopped = Command::new("kill").args(["-INT", &id]).status();
    assert!(stopped.unwrap().success());
    let ended = program.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(1));
    let told = String::from_utf8(ended.stderr).unwrap();
    assert!(told.contains("stopped before its end"), "{told}");
    assert_eq!(entries(&out), 1);
}
