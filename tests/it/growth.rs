//! What a job takes on the disk, by method, for `docs/reliability.md`.

use serde_json::{Value, json};

use crate::bench::WAIT;
use crate::process::Process;
use crate::stores;

fn case_2(method: &str, number: u32) -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/api/examples/test-case-2.json");
    let mut job: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    job["method"] = json!(method);
    job["output_torques_n_m"] = json!([100.0 + f64::from(number) / 10.0]);
    job
}

async fn bytes_of_a_job(method: &str, jobs: u32) -> u64 {
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let process = Process::start(&database);
    let client = meshwright::client().build().unwrap();
    for number in 0..jobs {
        let request = client.post(format!("{}/v1/jobs", process.base));
        let job = case_2(method, number);
        let answer = request.header("prefer", WAIT).json(&job).send().await;
        assert_eq!(answer.unwrap().status(), 200);
    }
    process.terminate();
    // What was in the journal is in the file now.
    stores::bytes(&database).await / u64::from(jobs)
}

#[tokio::test]
#[ignore = "takes half a minute; ./chaos runs it"]
async fn a_job_takes_so_much_of_the_disk() {
    for method in [
        "flexible",
        "decomposition",
        "projected_decomposition",
        "load_distribution",
    ] {
        let bytes = bytes_of_a_job(method, 200).await;
        println!("{method}: {bytes} bytes a job of test case 2, all included");
        assert!(bytes < 40_000, "{method}: {bytes}");
    }
}
