//! One client who reads of a large study on many connections at once: the memory that it takes, and what another client notices of it,
//! for `docs/reliability.md`.

use std::time::{Duration, Instant};

use reqwest::{Client, StatusCode};
use serde_json::{Value, json};
use tokio::task::JoinSet;

use crate::bench::{Asked, PATIENCE, WAIT, problem};
use crate::flood::{make_key, shared_by};
use crate::process::{LITTLE, LITTLE_MB, Process};
use crate::stores;

const ROWS: u64 = 20_000;

/// A study of which a few designs are computed; the others cannot be built, and each of their rows says why.
fn study() -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 },
    });
    let base = json!({
        "method": "load_distribution",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
        "output_torques_n_m": [20.0],
    });
    let bores = (0..ROWS).map(|i| if i < 20 { 10.0 } else { 60.0 } + i as f64 / 1000.0);
    let bores: Vec<f64> = bores.collect();
    json!({ "base": base, "axes": [{ "path": "/pair/driven/blank/bore_radius_mm", "values": bores }] })
}

/// The median of short questions, one after the other, as long as `more` says.
async fn median(client: &Client, url: &str, key: &str, more: impl Fn(usize) -> bool) -> Duration {
    let mut taken = Vec::new();
    while more(taken.len()) {
        let start = Instant::now();
        let answer = client.get(url).bearer_auth(key).answer().await;
        assert_eq!(answer.status(), 200);
        answer.bytes().await.unwrap();
        taken.push(start.elapsed());
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    taken.sort();
    taken[taken.len() / 2]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn who_reads_a_large_table_on_forty_connections_leaves_the_service_to_others() {
    let (_folder, process, [reader, other]) = shared_by(["reader", "other"], &[]).await;
    let client = meshwright::client().timeout(15 * PATIENCE).build().unwrap();
    let made = client.post(format!("{}/v1/studies", process.base));
    let made = made.bearer_auth(&reader).json(&study()).answer().await;
    assert_eq!(made.status(), 202);
    let path = made.headers()["location"].to_str().unwrap().to_owned();
    let state = format!("{}{path}", process.base);
    loop {
        let answer = client.get(&state).bearer_auth(&reader).answer().await;
        let study = answer.document().await;
        if study["done"] == ROWS {
            break;
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }

    let url = format!("{}/v1/jobs", process.base);
    let before = median(&client, &url, &other, |count| count < 100).await;
    let start = Instant::now();
    let readers: Vec<_> = (0..40)
        .map(|_| {
            let request = client.get(format!("{state}/results/table.ndjson"));
            let request = request.bearer_auth(&reader);
            tokio::spawn(async move {
                let table = request.whole_text().await;
                table.lines().count() as u64
            })
        })
        .collect();
    let done = || readers.iter().all(tokio::task::JoinHandle::is_finished);
    // A machine that is quicker than the questions has nothing to tell.
    let during = median(&client, &url, &other, |count| count < 20 || !done()).await;
    let took = start.elapsed();
    for reader in readers {
        assert_eq!(reader.await.unwrap(), ROWS);
    }
    println!(
        "a table of {ROWS} rows read on 40 connections: {took:?}; another client's questions meanwhile {during:?} (median), {before:?} before"
    );
    assert!(during < Duration::from_millis(50), "{during:?}");
}

/// Reads of `url` without a pause, on so many connections; one that is refused comes again after a second, as it is told.
fn readers(client: &Client, url: &str, key: &str, count: usize) -> JoinSet<()> {
    let mut readers = JoinSet::new();
    for _ in 0..count {
        let request = client.get(url).bearer_auth(key);
        readers.spawn(async move {
            loop {
                let request = request.try_clone().unwrap();
                match request.send().await {
                    Ok(answer) if answer.status() == 200 => {
                        let _ = answer.bytes().await;
                    }
                    _ => tokio::time::sleep(Duration::from_secs(1)).await,
                }
            }
        });
    }
    readers
}

/// A study of 14 MB, none of whose designs can be built: where its document is, and how many bytes that has.
async fn large_study(process: &Process, client: &Client, key: &str) -> (String, u64) {
    let designs: Vec<Value> = (0..60_000)
        .map(|i| {
            let label = format!("{i}-{}", "x".repeat(150));
            json!({ "label": label, "changes": { "/pair/driven/blank/bore_radius_mm": 60 } })
        })
        .collect();
    let study = json!({ "base": study()["base"], "designs": designs });
    let made = client.post(format!("{}/v1/studies", process.base));
    let made = made.bearer_auth(key).json(&study).answer().await;
    let status = made.status();
    let path = made
        .headers()
        .get("location")
        .map(|path| path.to_str().unwrap().to_owned());
    assert_eq!(status, 202, "{}", made.whole_text().await);
    let url = format!("{}{}/document", process.base, path.unwrap());
    let document = client.get(&url).bearer_auth(key).answer().await;
    (url, document.whole_text().await.len() as u64)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn large_answers_that_nobody_reads_take_no_more_than_their_part_of_the_memory() {
    let _alone = stores::ALONE.lock().await;
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let process = Process::start_with(&database, &LITTLE);
    let client = meshwright::client().timeout(6 * PATIENCE).build().unwrap();
    let [hog, other] = [
        make_key(&database, "hog").await,
        make_key(&database, "other").await,
    ];
    let (url, bytes) = large_study(&process, &client, &hog).await;
    // Each has asked, and reads nothing.
    let hanging = futures_util::future::join_all((0..80).map(|_| {
        let request = client.get(&url).bearer_auth(&hog);
        tokio::time::timeout(Duration::from_secs(8), request.send())
    }));
    let hanging = hanging.await;
    let begun = hanging
        .iter()
        .filter(|answer| matches!(answer, Ok(Ok(_))))
        .count() as u64;
    assert!(begun >= 1 && begun * bytes < 80 * bytes / 2, "{begun}");
    // Another client has its own part.
    let (own, bytes) = large_study(&process, &client, &other).await;
    let answer = client.get(&own).bearer_auth(&other).answer().await;
    assert_eq!(answer.bytes().await.unwrap().len() as u64, bytes);
    let memory = process.peak_memory_mb();
    println!(
        "80 answers of {bytes} bytes that nobody reads, --memory-mb 256: {begun} are sent at once, at most {memory} MB"
    );
    assert!(memory < LITTLE_MB, "{memory} MB");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn who_reads_a_large_document_or_lists_on_sixty_four_connections_leaves_looks_at_jobs_to_others()
 {
    let (_folder, process, [reader, other]) = shared_by(["reader", "other"], &LITTLE).await;
    let client = meshwright::client().timeout(6 * PATIENCE).build().unwrap();
    let (document, _) = large_study(&process, &client, &reader).await;
    let made = client.post(format!("{}/v1/jobs", process.base));
    let made = made
        .bearer_auth(&other)
        .json(&study()["base"])
        .answer()
        .await;
    let job = made.headers()["location"].to_str().unwrap().to_owned();
    let job = format!("{}{job}", process.base);
    for (what, url) in [
        ("a document of 15 MB", document),
        (
            "lists of jobs",
            format!("{}/v1/jobs?limit=200", process.base),
        ),
    ] {
        let mut readers = readers(&client, &url, &reader, 64);
        let mut taken = Vec::new();
        for _ in 0..300 {
            let start = Instant::now();
            let answer = client.get(&job).bearer_auth(&other).answer().await;
            assert_eq!(answer.status(), 200);
            taken.push(start.elapsed());
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
        readers.shutdown().await;
        taken.sort();
        let (median, late) = (taken[150], taken[297]);
        println!(
            "{what} read on 64 connections: another client's looks at a job {median:?} (median), {late:?} (99 %)"
        );
        assert!(median < Duration::from_millis(20), "{what}: {median:?}");
        assert!(late < Duration::from_millis(100), "{what}: {late:?}");
    }
    let memory = process.peak_memory_mb();
    println!("at most {memory} MB");
    assert!(memory < LITTLE_MB, "{memory} MB");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn a_thousand_readers_of_a_large_table_leave_health_and_other_clients_their_answers() {
    let (_folder, process, [reader, other]) = shared_by(["reader", "other"], &LITTLE).await;
    let client = meshwright::client().timeout(15 * PATIENCE).build().unwrap();
    let made = client.post(format!("{}/v1/studies", process.base));
    let made = made.bearer_auth(&reader).json(&study()).answer().await;
    let path = made.headers()["location"].to_str().unwrap().to_owned();
    let table = format!("{}{path}/results/table.ndjson", process.base);
    let mut readers = readers(&client, &table, &reader, 1030);
    tokio::time::sleep(Duration::from_secs(2)).await;
    for (what, path) in [
        ("health", "/health/live"),
        ("ready", "/health/ready"),
        ("another client", "/v1/jobs"),
    ] {
        let mut taken = Vec::new();
        for _ in 0..200 {
            let start = Instant::now();
            let request = client.get(format!("{}{path}", process.base));
            let request = request.bearer_auth(&other).header("connection", "close");
            assert_eq!(request.answer().await.status(), 200, "{what}");
            taken.push(start.elapsed());
        }
        taken.sort();
        println!(
            "{what} beside 1,030 readers of a table of {ROWS} rows: {:?} (median), {:?} (99 %)",
            taken[100], taken[198]
        );
        assert!(
            taken[198] < Duration::from_millis(250),
            "{what}: {:?}",
            taken[198]
        );
    }
    let memory = process.peak_memory_mb();
    println!("at most {memory} MB");
    assert!(memory < LITTLE_MB, "{memory} MB");
    readers.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn designs_of_a_large_study_are_looked_at_in_a_bounded_memory() {
    let _alone = stores::ALONE.lock().await;
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start_with(&stores::place(&folder).await, &["--memory-mb", "512"]);
    let client = meshwright::client().timeout(6 * PATIENCE).build().unwrap();
    let designs: Vec<Value> = (0..60_000)
        .map(|i| {
            let changes = json!({ "/output_torques_n_m": [f64::from(i) + 1.5] });
            json!({ "label": i.to_string(), "changes": changes })
        })
        .collect();
    let study = json!({ "base": study()["base"], "designs": designs });
    let path = process.submit(&client, &study).await;
    let readers: Vec<_> = (0..20)
        .map(|row| {
            let request = client.get(format!("{}{path}/designs/{row}", process.base));
            tokio::spawn(async move { request.document().await })
        })
        .collect();
    for (row, reader) in readers.into_iter().enumerate() {
        let torques = &reader.await.unwrap()["output_torques_n_m"];
        assert_eq!(*torques, json!([row as f64 + 1.5]));
    }
    // Twenty of them side by side would take more than twice as much.
    let memory = process.peak_memory_mb();
    println!("20 designs of a study of 60,000 at once: at most {memory} MB");
    assert!(memory < 400, "{memory} MB");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn fields_of_gears_are_refused_where_they_never_fit_and_others_stay_in_the_memory() {
    let _alone = stores::ALONE.lock().await;
    let folder = tempfile::tempdir().unwrap();
    let process = Process::start_with(&stores::place(&folder).await, &LITTLE);
    let client = meshwright::client().timeout(6 * PATIENCE).build().unwrap();
    // The job itself takes nothing: its method is a formula. What is looked at are the gears.
    let job = async |teeth: u32| {
        let mut pair = study()["base"].clone();
        pair["pair"]["center_distance_mm"] = json!(f64::from(2 * teeth) + 0.3);
        for member in ["driving", "driven"] {
            pair["pair"][member]["tooth_count"] = json!(teeth);
        }
        let made = client.post(format!("{}/v1/jobs", process.base));
        let made = made.json(&pair).header("prefer", WAIT).answer().await;
        made.document().await["id"].as_str().unwrap().to_owned()
    };
    let fields = async |job: &str, file: &str| {
        let url = format!("{}/v1/jobs/{job}/results/{file}", process.base);
        loop {
            let asked = client.get(&url).header("accept-encoding", "gzip");
            let answer = asked.answer().await;
            if answer.status() != StatusCode::ACCEPTED {
                return answer;
            }
        }
    };
    let large = job(300).await;
    for file in ["fields.vtu", "edges.json"] {
        problem(fields(&large, file).await, 422, "too_large").await;
    }
    let small = job(30).await;
    let at_once = (0..4).map(|_| fields(&small, "fields.vtu"));
    let answers = futures_util::future::join_all(at_once).await;
    let mut sent = 0;
    for answer in answers {
        // One goes at a time; on a busy machine the last ones wait too long.
        match answer.status().as_u16() {
            200 => sent += usize::from(answer.bytes().await.unwrap().len() > 1_000_000),
            status => assert_eq!(status, 503),
        }
    }
    assert!(sent > 0);
    let memory = process.peak_memory_mb();
    println!(
        "four fields of 30/30 teeth at once, --memory-mb 256: {sent} sent, at most {memory} MB"
    );
    assert!(memory < LITTLE_MB, "{memory} MB");
}
