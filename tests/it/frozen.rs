//! A PostgreSQL that answers nothing: it is frozen, or somebody holds a table. Requests end, `/health/ready` says so, SIGTERM is obeyed, and
//! all goes on when it is over. `./chaos` measures it.

use std::fs;
use std::time::{Duration, Instant};

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use rustix::process::{Pid, Signal, kill_process};

use crate::bench::{Asked, eventually, submission};
use crate::process::Process;
use crate::server;

/// Every request has an answer in this time, whatever the server does: one under way when it freezes takes 12 s.
const ANSWERED: Duration = Duration::from_secs(60);

/// So soon it is refused what waits for the database, and so soon what may wait for a statement that is under way.
const SOON: Duration = Duration::from_millis(5600);
const UNDER_WAY: Duration = Duration::from_secs(13);

/// The processes of the server in `folder`, the first of which is its parent.
fn processes(folder: &str) -> Vec<Pid> {
    let told = fs::read_to_string(format!("{folder}/data/postmaster.pid")).unwrap();
    let parent: i32 = told.lines().next().unwrap().trim().parse().unwrap();
    let is_child = |pid: &i32| {
        let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let behind_name = stat.rsplit_once(')').map_or("", |(_, behind)| behind);
        behind_name.split_whitespace().nth(1) == Some(&parent.to_string())
    };
    let all = fs::read_dir("/proc").unwrap();
    let all = all.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    [parent]
        .into_iter()
        .chain(all.filter(is_child))
        .filter_map(Pid::from_raw)
        .collect()
}

fn signal(folder: &str, signal: Signal) {
    for process in processes(folder) {
        // One that ends meanwhile needs none.
        let _ = kill_process(process, signal);
    }
}

async fn ready(client: &Client, process: &Process) -> u16 {
    let url = format!("{}/health/ready", process.base);
    client.get(url).answer().await.status().as_u16()
}

/// Comes back when ready says `status`. Gives back how long that took.
async fn until(client: &Client, process: &Process, status: u16) -> Duration {
    let start = Instant::now();
    eventually(async || match ready(client, process).await {
        said if said == status => Ok(()),
        other => Err(other),
    })
    .await;
    start.elapsed()
}

/// Both are refused, and so soon.
fn refused(asked: [(u16, Duration); 2], within: Duration) {
    for (status, took) in asked {
        assert_eq!(status, 503);
        assert!(took < within, "{took:?}");
    }
}

/// What the service says, and how long it takes, for a look and a submission.
async fn ask(client: &Client, process: &Process, torque: f64) -> [(u16, Duration); 2] {
    let url = format!("{}/v1/jobs", process.base);
    let asked = [
        client.get(&url),
        client.post(&url).json(&submission(torque)),
    ];
    let answer = async |request: reqwest::RequestBuilder| {
        let start = Instant::now();
        let answer = request.answer().await;
        (answer.status().as_u16(), start.elapsed())
    };
    let [look, submit] = asked;
    let (look, submit) = tokio::join!(answer(look), answer(submit));
    [look, submit]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn whichever_table_is_locked_ready_says_so() {
    let address = server::database().await;
    let client = meshwright::client().timeout(ANSWERED).build().unwrap();
    let process = Process::start(&DatabaseAddress::Postgres(address.clone()));
    let mut lock = server::connect(&address).await;
    // But for those that are looked at when a process begins.
    let tables: Vec<String> = sqlx::query_scalar(
        "select tablename::text from pg_tables where schemaname = 'public' and tablename not in ('_sqlx_migrations', 'compatibility')",
    )
    .fetch_all(&mut lock)
    .await
    .unwrap();
    assert!(tables.len() > 12, "{tables:?}");
    for table in tables {
        let words = format!("begin; lock table {table} in access exclusive mode");
        let words = sqlx::raw_sql(sqlx::AssertSqlSafe(words));
        words.execute(&mut lock).await.unwrap();
        until(&client, &process, 503).await;
        sqlx::raw_sql("rollback").execute(&mut lock).await.unwrap();
        until(&client, &process, 200).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes a minute, and wants the machine for itself: ./chaos"]
async fn a_server_that_answers_nothing_holds_up_no_request_and_no_end() {
    let (address, folder) = tokio::task::spawn_blocking(server::start).await.unwrap();
    let address = server::database_of(&address, "frozen").await;
    let place = DatabaseAddress::Postgres(address.clone());
    let client = meshwright::client().timeout(ANSWERED).build().unwrap();
    let mut process = Process::start(&place);

    let mut lock = server::connect(&address).await;
    let words = "begin; lock table jobs in access exclusive mode";
    sqlx::raw_sql(words).execute(&mut lock).await.unwrap();
    let told = until(&client, &process, 503).await;
    let [look, submit] = ask(&client, &process, 1.0).await;
    refused([look, submit], UNDER_WAY);
    sqlx::raw_sql("rollback").execute(&mut lock).await.unwrap();
    let again = until(&client, &process, 200).await;
    println!(
        "a table locked: ready says so after {told:?}, a look is refused after {:?}, a submission after {:?}; ready again {again:?} after it is free",
        look.1, submit.1
    );

    signal(&folder, Signal::STOP);
    let told = until(&client, &process, 503).await;
    let [look, submit] = ask(&client, &process, 2.0).await;
    signal(&folder, Signal::CONT);
    refused([look, submit], UNDER_WAY);
    let again = until(&client, &process, 200).await;
    println!(
        "the server frozen: ready says so after {told:?}, a look is refused after {:?}, a submission after {:?}; ready again {again:?} after it is back",
        look.1, submit.1
    );

    for round in 1..=3 {
        signal(&folder, Signal::STOP);
        let asked = ask(&client, &process, 10.0 + f64::from(round)).await;
        signal(&folder, Signal::CONT);
        refused(asked, SOON);
        until(&client, &process, 200).await;
        println!(
            "the server frozen, round {round}: a look and a submission are refused after {:?}",
            asked.map(|(_, took)| took)
        );
    }

    for what in ["a table locked", "the server frozen"] {
        if what == "a table locked" {
            sqlx::raw_sql(words).execute(&mut lock).await.unwrap();
        } else {
            signal(&folder, Signal::STOP);
        }
        let hanging = {
            let client = client.clone();
            let url = format!("{}/v1/jobs", process.base);
            tokio::spawn(async move { client.get(url).send().await.is_ok() })
        };
        tokio::time::sleep(Duration::from_millis(200)).await;
        let end = tokio::task::spawn_blocking(|| process.terminate())
            .await
            .unwrap();
        signal(&folder, Signal::CONT);
        let _ = hanging.await;
        println!("{what}: ended {end:?} after SIGTERM");
        assert!(end < Duration::from_secs(10), "{what}: {end:?}");
        if what == "a table locked" {
            sqlx::raw_sql("rollback").execute(&mut lock).await.unwrap();
        }
        process = Process::start(&place);
    }
    // What was refused was not taken, and what is taken now is.
    let taken = client.post(format!("{}/v1/jobs", process.base));
    let taken = taken.json(&submission(3.0)).answer().await;
    assert_eq!(taken.status(), 202);
}
