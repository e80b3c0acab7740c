//! Clients that submit jobs at once, and repeat what was not answered until it is taken.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use reqwest::Client;
use serde_json::Value;
use tokio::sync::Mutex;
use tokio::task::JoinHandle;

/// Where requests go, in turn: what answers there may die, and others take its place.
pub(crate) type Bases = Arc<Mutex<Vec<String>>>;

/// The ids of the jobs that were taken, by their numbers.
pub(crate) type Taken = BTreeMap<u64, String>;

/// Four clients, each with its part of the numbers below `count`.
pub(crate) struct Submitters {
    count: u64,
    tasks: Vec<JoinHandle<Taken>>,
}

impl Submitters {
    pub(crate) fn start(client: &Client, bases: &Bases, count: u64, job: fn(u64) -> Value) -> Self {
        const CLIENTS: u64 = 4;
        let submit = |which| {
            let numbers = (0..count).filter(|number| number % CLIENTS == which);
            let (client, bases) = (client.clone(), Arc::clone(bases));
            tokio::spawn(submit_all(client, bases, numbers.collect(), job))
        };
        let tasks = (0..CLIENTS).map(submit).collect();
        Self { count, tasks }
    }

    /// Comes back when all jobs are taken, each as one.
    pub(crate) async fn taken(self) -> Taken {
        let mut taken = Taken::new();
        for task in self.tasks {
            taken.extend(task.await.unwrap());
        }
        let ids: BTreeSet<&String> = taken.values().collect();
        assert_eq!(
            (taken.len() as u64, ids.len() as u64),
            (self.count, self.count),
            "each was taken once"
        );
        taken
    }
}

/// Submits one after the other, each until somebody takes it.
async fn submit_all(
    client: Client,
    bases: Bases,
    numbers: Vec<u64>,
    job: fn(u64) -> Value,
) -> Taken {
    let mut taken = Taken::new();
    for number in numbers {
        let mut turn = usize::try_from(number).unwrap();
        let id = loop {
            let base = {
                let bases = bases.lock().await;
                bases[turn % bases.len()].clone()
            };
            turn += 1;
            let request = client
                .post(format!("{base}/v1/jobs"))
                .header("idempotency-key", format!("job {number}"))
                .json(&job(number));
            if let Ok(answer) = request.send().await
                // 200 where the answer to an earlier try was lost, and the job has ended meanwhile.
                && answer.status().is_success()
                && let Ok(job) = answer.json::<Value>().await
            {
                break job["id"].as_str().unwrap().to_owned();
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        };
        taken.insert(number, id);
    }
    taken
}
