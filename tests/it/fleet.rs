//! Several processes on one PostgreSQL: three compute, two answer. Workers and an answering process are killed, the server is
//! restarted, a worker is frozen beyond its lease: no job is lost, none is done twice in effect.
//!
//! A few hundred jobs run with the tests; five thousand, and the figures of `docs/scaling.md`, by `tests/fleet`.

mod hosts;

use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use meshwright::jobs::DatabaseAddress;
use reqwest::Client;
use rustix::process::Signal;
use serde_json::{Value, json};
use sqlx::PgConnection;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Mutex, watch};

use crate::bench::{Asked, PATIENCE, WAIT, eventually};
use crate::process::Process;
use crate::submitters::{Bases, Submitters};
use crate::{server, stores};

/// A decomposition of some tens of milliseconds, each another one.
fn job(number: u64) -> Value {
    let gear = json!({
        "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 },
        "tip_relief": { "amount_um": 5.0, "start": { "radial_length_mm": 1.75 } },
    });
    let mut driven = gear.clone();
    driven["blank"]["holes"] = json!({ "count": 10, "circle_radius_mm": 34.0, "radius_mm": 7.5 });
    json!({
        "method": "projected_decomposition",
        "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": driven },
        "output_torques_n_m": [20.0 + number as f64 * 0.25],
        "resolution": { "positions_per_mesh_period": 10 },
    })
}

const SUCCESSFUL: &str = "select count(*) from jobs where status = 'successful'";

/// The processes, and the database that they share.
struct Fleet {
    place: DatabaseAddress,
    workers: Vec<Process>,
    apis: Vec<Process>,
    bases: Bases,
    client: Client,
    lease: String,
}

/// The arguments of a process of the fleet.
fn arguments<'a>(role: &'a str, lease: &'a str) -> [&'a str; 8] {
    [
        "--role",
        role,
        "--workers",
        "1",
        "--queue-limit",
        "100000",
        "--lease",
        lease,
    ]
}

fn start(place: &DatabaseAddress, role: &str, lease: &str) -> Process {
    Process::start_with(place, &arguments(role, lease))
}

impl Fleet {
    fn start(address: &str, workers: usize, apis: usize, lease: &str) -> Self {
        let place = DatabaseAddress::Postgres(address.to_owned());
        let apis = (0..apis).map(|_| start(&place, "api", lease)).collect();
        let workers = (0..workers)
            .map(|_| start(&place, "worker", lease))
            .collect();
        Self::of(place, apis, workers, lease)
    }

    /// One process that does everything.
    fn alone(place: DatabaseAddress) -> Self {
        let process = start(&place, "all", "30s");
        Self::of(place, vec![process], Vec::new(), "30s")
    }

    fn of(place: DatabaseAddress, apis: Vec<Process>, workers: Vec<Process>, lease: &str) -> Self {
        let bases = apis.iter().map(|api| api.base.clone()).collect();
        Self {
            workers,
            apis,
            bases: Arc::new(Mutex::new(bases)),
            client: meshwright::client().timeout(PATIENCE).build().unwrap(),
            place,
            lease: lease.to_owned(),
        }
    }

    fn submit(&self, count: u64) -> Submitters {
        Submitters::start(&self.client, &self.bases, count, job)
    }

    /// Another worker.
    fn hire(&mut self) {
        let worker = start(&self.place, "worker", &self.lease);
        self.workers.push(worker);
    }

    /// Freezes the first worker, whom the database calls `owner`, in the middle of something that nobody ends for it; `enough`
    /// jobs may end before that is seen.
    async fn freeze(&mut self, owner: &str, enough: i64) -> Process {
        let worker = self.workers.remove(0);
        while self.number(SUCCESSFUL).await < enough {
            worker.signal(Signal::STOP);
            let held = self.held_by(owner).await;
            if !held.is_empty() {
                // A statement that it had sent ends without it.
                tokio::time::sleep(Duration::from_millis(500)).await;
                let still = self.held_by(owner).await;
                if held.iter().any(|job| still.contains(job)) {
                    return worker;
                }
            }
            worker.signal(Signal::CONT);
            // It has to come to something new before it is worth another look.
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        panic!("the worker is never seen at work");
    }

    /// The jobs that a worker runs.
    async fn held_by(&self, owner: &str) -> Vec<String> {
        let held =
            sqlx::query_scalar("select id from jobs where status = 'running' and owner = $1");
        let mut connection = self.connect().await;
        held.bind(owner).fetch_all(&mut connection).await.unwrap()
    }

    /// What the database calls the only worker that there has been.
    async fn owner(&self) -> String {
        let owner =
            sqlx::query_scalar("select distinct owner from jobs where status = 'successful'");
        owner.fetch_one(&mut self.connect().await).await.unwrap()
    }

    async fn connect(&self) -> PgConnection {
        let DatabaseAddress::Postgres(address) = &self.place else {
            unreachable!("a fleet has a server")
        };
        server::connect(address).await
    }

    /// Comes back when so many jobs are successful.
    async fn successful(&self, count: i64) {
        self.until(SUCCESSFUL, count).await;
    }

    /// Comes back when `query` counts as many. Panics when it has counted no more for a long while.
    async fn until(&self, query: &'static str, count: i64) {
        const LONG: Duration = Duration::from_secs(180);
        let (mut seen, mut since) = (self.number(query).await, Instant::now());
        while seen < count {
            tokio::time::sleep(Duration::from_millis(50)).await;
            let number = self.number(query).await;
            if number > seen {
                (seen, since) = (number, Instant::now());
            }
            assert!(since.elapsed() < LONG, "{seen} of {count}: {query}");
        }
    }

    async fn number(&self, query: &'static str) -> i64 {
        stores::number(&self.place, query).await
    }

    /// What the whole database comes to for each of `count` jobs, in bytes.
    async fn bytes_of_each(&self, count: u64) -> i64 {
        let size = self.number("select pg_database_size(current_database())");
        size.await / i64::try_from(count).unwrap()
    }
}

/// Each job once, whatever happened meanwhile.
async fn check(fleet: &Fleet, count: u64) {
    let count = i64::try_from(count).unwrap();
    assert_eq!(fleet.number("select count(*) from jobs").await, count);
    assert_eq!(
        fleet
            .number("select count(*) from jobs where status = 'successful' and same_as is null")
            .await,
        count,
        "each was computed"
    );
    assert_eq!(
        fleet
            .number("select count(distinct document) from jobs")
            .await,
        count,
        "each has the results of its own input"
    );
    assert_eq!(fleet.number("select count(*) from documents").await, count);
}

async fn share_of_workers(fleet: &Fleet) -> Vec<i64> {
    let shares = sqlx::query_scalar("select count(*) from jobs group by owner order by 1 desc");
    shares.fetch_all(&mut fleet.connect().await).await.unwrap()
}

/// A round of `count` jobs in which everything happens that can happen. `lease` in seconds.
async fn troubled(count: u64, lease: u64) {
    // One of its own, because it is restarted.
    let (server, folder) = tokio::task::spawn_blocking(server::start).await.unwrap();
    let address = server::database_of(&server, "fleet").await;
    let start = Instant::now();
    let mut fleet = Fleet::start(&address, 1, 2, &format!("{lease}s"));
    let submitters = fleet.submit(count);
    let part = |of: u64| i64::try_from(count * of / 10).unwrap();

    fleet.successful(1).await;
    let owner = fleet.owner().await;
    for _ in 0..2 {
        fleet.hire();
    }
    fleet.successful(part(2)).await;
    // It goes on long after its lease.
    let frozen = fleet.freeze(&owner, part(6)).await;
    let frozen_at = Instant::now();
    fleet.hire();
    fleet.successful(part(4)).await;
    // Two workers and one that answers die; others take their places.
    for _ in 0..2 {
        fleet.workers.remove(0).kill();
    }
    fleet.bases.lock().await.remove(0);
    fleet.apis.remove(0).kill();
    for _ in 0..2 {
        fleet.hire();
    }
    fleet.successful(part(5)).await;
    let restart = Instant::now();
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/postgres/restart");
    let restarted = tokio::task::spawn_blocking(move || Command::new(program).arg(folder).status());
    assert!(restarted.await.unwrap().unwrap().success());
    let restarted = restart.elapsed();
    fleet.successful(part(7)).await;
    let frozen_for = Duration::from_secs(lease * 2).saturating_sub(frozen_at.elapsed());
    tokio::time::sleep(frozen_for).await;
    frozen.signal(Signal::CONT);

    submitters.taken().await;
    fleet.successful(count.try_into().unwrap()).await;
    check(&fleet, count).await;
    let again = fleet
        .number("select count(*) from jobs where attempt > 1")
        .await;
    assert!(again >= 1, "what the dead ran was run again");
    println!(
        "{count} jobs in {:.1} s by 3 workers, of which 2 were killed and 1 frozen, and 2 that answer, of which 1 was killed; the server restarted in {restarted:?}; {again} jobs ran more than once, none is lost, none has two results; by process {:?}",
        start.elapsed().as_secs_f64(),
        share_of_workers(&fleet).await,
    );
}

/// Comes back when all of `count` jobs are done that nobody disturbs; says how many a second.
async fn calm(fleet: &Fleet, count: u64) -> f64 {
    let start = Instant::now();
    let submitters = fleet.submit(count);
    fleet.successful(count.try_into().unwrap()).await;
    let seconds = start.elapsed().as_secs_f64();
    submitters.taken().await;
    check(fleet, count).await;
    count as f64 / seconds
}

async fn calm_on_a_file(count: u64) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let fleet = Fleet::alone(DatabaseAddress::File(folder.path().join("meshwright.db")));
    let rate = calm(&fleet, count).await;
    println!("{count} jobs, one process on a file, 1 worker: {rate:.1} a second");
    rate
}

async fn calm_on_a_server(count: u64, workers: usize) -> f64 {
    let fleet = Fleet::start(&server::database().await, workers, 2, "30s");
    let rate = calm(&fleet, count).await;
    let shares = share_of_workers(&fleet).await;
    assert_eq!(
        shares.len(),
        workers,
        "each worker had its share: {shares:?}"
    );
    let memory: Vec<_> = fleet.workers.iter().map(Process::peak_memory_mb).collect();
    let connections = fleet
        .number("select count(*) from pg_stat_activity where datname = current_database()")
        .await;
    let bytes = fleet.bytes_of_each(count).await;
    println!(
        "{count} jobs, {workers} workers: {rate:.1} a second, shares {shares:?}, peak memory of workers {memory:?} MB, {connections} connections, {bytes} bytes a job"
    );
    assert!(memory.iter().all(|mb| *mb < 400), "{memory:?} MB");
    // Ten of each process, and the one that asks.
    let processes = i64::try_from(workers + fleet.apis.len()).unwrap();
    assert!(connections <= 10 * processes + 1, "{connections}");
    // An empty database has 8 MB, which a thousand jobs share.
    assert!(bytes < 40_000, "{bytes} bytes");
    rate
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn kills_a_restart_and_a_frozen_worker_lose_no_job_and_double_none() {
    let _alone = stores::ALONE.lock().await;
    troubled(300, 2).await;
}

#[tokio::test]
async fn only_a_server_is_shared_by_processes_of_different_roles() {
    let folder = tempfile::tempdir().unwrap();
    for role in ["api", "worker"] {
        let refused = Command::new(env!("CARGO_BIN_EXE_meshwright"))
            .args([
                "serve",
                "--listen",
                "127.0.0.1:0",
                "--role",
                role,
                "--database",
            ])
            .arg(folder.path().join("meshwright.db"))
            .output()
            .unwrap();
        assert!(!refused.status.success());
        let told = String::from_utf8(refused.stderr).unwrap();
        assert!(
            told.contains("only a database of PostgreSQL can be shared"),
            "{told}"
        );
    }
}

#[tokio::test]
async fn a_password_stands_neither_in_the_help_nor_in_an_error() {
    let address = "postgres://me:secret-word@127.0.0.1:1/gears";
    for arguments in [
        &["serve", "--help"][..],
        &["serve"],
        &["keys", "list"],
        &["backup", "x"],
    ] {
        let told = Command::new(env!("CARGO_BIN_EXE_meshwright"))
            .args(arguments)
            .env("MESHWRIGHT_DATABASE", address)
            .output()
            .unwrap();
        let all = [told.stdout, told.stderr].concat();
        let all = String::from_utf8(all).unwrap();
        assert!(!all.contains("secret-word"), "{arguments:?}: {all}");
    }
}

/// The transaction that waits for a lock in the database.
async fn waiting(connection: &mut PgConnection) -> Option<String> {
    let waiting = sqlx::query_scalar(
        "select pid || ' since ' || xact_start from pg_stat_activity where datname = current_database() and wait_event_type = 'Lock'",
    );
    waiting.fetch_optional(connection).await.unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_dismissal_that_takes_long_keeps_no_lost_job_waiting() {
    let address = server::database().await;
    let fleet = Fleet::start(&address, 0, 1, "1s");
    let torques: Vec<Value> = (0..10).map(|i| json!([50 + i])).collect();
    let study =
        json!({ "base": job(0), "axes": [{ "path": "/output_torques_n_m", "values": torques }] });
    fleet.apis[0].submit(&fleet.client, &study).await;
    fleet.submit(1).taken().await;
    // Nobody can dismiss the designs as long as one is locked.
    let mut lock = server::connect(&address).await;
    for words in [
        "begin",
        "select id from jobs where study is not null order by sequence limit 1 for update",
    ] {
        sqlx::raw_sql(words).execute(&mut lock).await.unwrap();
    }
    let mut other = server::connect(&address).await;
    let cancel = "update studies set cancelled_at = submitted_at";
    sqlx::query(cancel).execute(&mut other).await.unwrap();
    // A transaction that waits for a lock gives up after a while, and another one follows it. The lost job is found while one of them waits.
    eventually(async || {
        let before = waiting(&mut other).await;
        let lose = "update jobs set status = 'running', attempt = 1, owner = 'gone', lease_until = 1 where study is null";
        sqlx::query(lose).execute(&mut other).await.unwrap();
        let found =
            "select count(*) from jobs where study is null and status = 'accepted' and attempt = 1";
        fleet.until(found, 1).await;
        let after = waiting(&mut other).await;
        match before.is_some() && before == after {
            true => Ok(()),
            false => Err((before, after)),
        }
    })
    .await;
    sqlx::raw_sql("rollback").execute(&mut lock).await.unwrap();
    let dismissed = "select count(*) from jobs where status = 'dismissed'";
    fleet.until(dismissed, 10).await;
}

/// The median time of a small job from its submission to its answer, one after the other, in milliseconds.
async fn to_and_fro(place: &DatabaseAddress) -> f64 {
    const JOBS: u32 = 200;
    let process = Process::start(place);
    let client = meshwright::client().build().unwrap();
    let mut times = Vec::new();
    for number in 0..JOBS {
        let gear = json!({ "tooth_count": 50, "module_mm": 2.0, "face_width_mm": 20.0, "blank": { "bore_radius_mm": 15.0 } });
        let small = json!({
            "method": "load_distribution",
            "pair": { "center_distance_mm": 100.5, "driving": gear, "driven": gear },
            "output_torques_n_m": [20.0 + f64::from(number)],
            "resolution": { "positions_per_mesh_period": 10 },
        });
        let start = Instant::now();
        let request = client.post(format!("{}/v1/jobs", process.base));
        let answer = request.header("prefer", WAIT).json(&small).send().await;
        assert_eq!(answer.unwrap().status(), 200);
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

#[tokio::test]
#[ignore = "a measurement; tests/fleet runs it"]
async fn a_job_takes_a_little_longer_to_and_fro_than_on_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = DatabaseAddress::File(folder.path().join("meshwright.db"));
    let server = DatabaseAddress::Postgres(server::database().await);
    for round in 0..2 {
        let (on_file, on_server) = (to_and_fro(&file).await, to_and_fro(&server).await);
        println!(
            "round {round}: a small job from submission to answer takes {on_file:.2} ms on SQLite, {on_server:.2} ms on PostgreSQL (median of 200)"
        );
        // Every statement goes to another process and back: some ten of them, each a small part of a millisecond.
        assert!(on_server < on_file + 20.0, "{on_server} ms, {on_file} ms");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes some minutes; tests/fleet runs it"]
async fn a_study_of_twenty_thousand_designs_through_two_processes() {
    let address = server::database().await;
    let fleet = Fleet::start(&address, 2, 1, "30s");
    let api = &fleet.apis[0];
    let base = job(0);
    let radii: Vec<f64> = (0..100).map(|i| 5.0 + f64::from(i) * 0.02).collect();
    let torques: Vec<Value> = (0..200).map(|i| json!([50.0 + f64::from(i)])).collect();
    let study = json!({
        "base": base,
        "axes": [
            { "path": "/pair/driven/blank/holes/radius_mm", "values": radii },
            { "path": "/output_torques_n_m", "values": torques },
        ],
    });
    let start = Instant::now();
    let path = api.submit(&fleet.client, &study).await;
    let taken = start.elapsed();
    let ended = api.done(&fleet.client, &path, 20_000).await;
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(ended["successful"], 20_000, "{ended}");
    let read = Instant::now();
    let table = fleet
        .client
        .get(format!("{}{path}/results/table.csv", api.base))
        .timeout(Duration::from_secs(120));
    let table = table.whole_text().await;
    assert_eq!(table.lines().count(), 20_001);
    let read = read.elapsed();
    let bytes = fleet.bytes_of_each(20_000).await;
    let memory: Vec<_> = fleet.workers.iter().map(Process::peak_memory_mb).collect();
    let (answering, shares) = (api.peak_memory_mb(), share_of_workers(&fleet).await);
    println!(
        "20,000 designs taken after {taken:?}, done in {seconds:.1} s, {:.1} a second; the table of {} kB took {read:?}; {bytes} bytes a design; peak memory of workers {memory:?} MB, of the one that answers {answering} MB; shares {shares:?}",
        20_000.0 / seconds,
        table.len() / 1000,
    );
    // Each some ten times what docs/scaling.md has, but for memory and bytes, which no other work on the machine changes.
    assert!(taken < Duration::from_secs(5), "{taken:?}");
    assert!(read < Duration::from_secs(10), "{read:?}");
    assert!(bytes < 20_000, "{bytes} bytes");
    assert!(memory.iter().all(|mb| *mb < 300), "{memory:?} MB");
    assert!(answering < 200, "{answering} MB");
    // They take turns, whichever of them is slower.
    assert!(
        shares.len() == 2 && shares.iter().all(|share| *share > 4000),
        "{shares:?}"
    );
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement; tests/fleet runs it"]
async fn a_study_of_designs_that_take_no_time_tells_how_fast_claims_take_turns() {
    const DESIGNS: u16 = 3000;
    for workers in [1, 2, 4] {
        let fleet = Fleet::start(&server::database().await, workers, 1, "30s");
        let mut base = job(0);
        base["method"] = json!("load_distribution");
        base["resolution"]["span_mesh_periods"] = json!(1);
        let torques: Vec<Value> = (0..DESIGNS)
            .map(|i| json!([50.0 + f64::from(i) * 0.1]))
            .collect();
        let study = json!({
            "base": base,
            "axes": [{ "path": "/output_torques_n_m", "values": torques }],
            "keep": "statistics",
        });
        let start = Instant::now();
        let path = fleet.apis[0].submit(&fleet.client, &study).await;
        fleet.apis[0]
            .done(&fleet.client, &path, DESIGNS.into())
            .await;
        let seconds = start.elapsed().as_secs_f64();
        let processor: f64 = fleet.workers.iter().map(Process::processor_seconds).sum();
        let rate = f64::from(DESIGNS) / seconds;
        let each_ms = 1e3 * processor / f64::from(DESIGNS);
        println!(
            "{workers} workers: {DESIGNS} designs that take no time in {seconds:.1} s, {rate:.0} a second; {each_ms:.2} ms of a core each in the workers"
        );
        // A statement for each design would be some hundreds a second. The time of a core is a fifth of a millisecond, whatever else runs.
        assert!(rate > 500.0, "{rate:.0} a second");
        assert!(each_ms < 1.0, "{each_ms:.2} ms");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes a quarter of an hour; tests/fleet runs it"]
async fn five_thousand_jobs_with_and_without_trouble() {
    let file = calm_on_a_file(1000).await;
    let one = calm_on_a_server(1000, 1).await;
    let three = calm_on_a_server(5000, 3).await;
    println!(
        "three workers are {:.2} times as fast as one, and one {:.2} times as fast as on a file",
        three / one,
        one / file
    );
    // On two cores further workers bring little, and a server costs statements: neither may cost most of the work.
    assert!(
        three > one / 2.0 && one > file / 4.0,
        "{file}, {one}, {three}"
    );
    troubled(5000, 10).await;
}

/// A way to the server that can be cut: nothing comes through then, and nobody is told. What was under way comes when it is mended.
struct Way {
    address: String,
    open: watch::Sender<bool>,
    /// The first connection on which this is said is dead from then on, and nobody is told.
    fatal: Arc<std::sync::Mutex<Option<&'static str>>>,
}

impl Way {
    async fn to(address: &str) -> Self {
        Self::with_fatal(address, None).await
    }

    async fn with_fatal(address: &str, fatal: Option<&'static str>) -> Self {
        const HOST: &str = "127.0.0.1:";
        let (before, behind) = address.split_once(HOST).unwrap();
        let (port, name) = behind.split_once('/').unwrap();
        let server = format!("{HOST}{port}");
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let own = listener.local_addr().unwrap();
        let (open, is_open) = watch::channel(true);
        let fatal = Arc::new(std::sync::Mutex::new(fatal));
        let words = Arc::clone(&fatal);
        tokio::spawn(async move {
            while let Ok((client, _)) = listener.accept().await {
                let server = TcpStream::connect(&server).await.unwrap();
                let (to_client, to_server) = (client.into_split(), server.into_split());
                let said = Some(Arc::clone(&words));
                tokio::spawn(carry(to_client.0, to_server.1, is_open.clone(), said));
                tokio::spawn(carry(to_server.0, to_client.1, is_open.clone(), None));
            }
        });
        let address = format!("{before}{own}/{name}");
        Self {
            address,
            open,
            fatal,
        }
    }
}

async fn carry(
    mut from: OwnedReadHalf,
    mut to: OwnedWriteHalf,
    mut open: watch::Receiver<bool>,
    fatal: Option<Arc<std::sync::Mutex<Option<&'static str>>>>,
) {
    let mut bytes = vec![0; 1 << 16];
    while let Ok(count @ 1..) = from.read(&mut bytes).await {
        let is_said = |words: &str| {
            bytes[..count]
                .windows(words.len())
                .any(|part| part == words.as_bytes())
        };
        let dies = fatal.as_ref().is_some_and(|fatal| {
            let mut fatal = fatal.lock().unwrap();
            fatal.take_if(|words| is_said(words)).is_some()
        });
        if dies {
            std::future::pending::<()>().await;
        }
        if open.wait_for(|open| *open).await.is_err()
            || to.write_all(&bytes[..count]).await.is_err()
        {
            break;
        }
    }
}

/// Looks at a worker that was cut off from the server at `cut`. Its reports go unanswered for a lease, after one that may have been under way;
/// then the engine is told, and obeys between two positions.
async fn computes_no_more(worker: &Process, cut: Instant, lease: Duration) {
    tokio::time::sleep((3 * lease).saturating_sub(cut.elapsed())).await;
    let before = worker.processor_seconds();
    tokio::time::sleep(lease / 2).await;
    let spent = worker.processor_seconds() - before;
    assert!(spent < 0.15, "it computes on: {spent} s of {:?}", lease / 2);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn a_worker_cut_off_from_the_server_gives_up_its_job_and_works_again_when_it_is_back() {
    let _alone = stores::ALONE.lock().await;
    const LEASE: Duration = Duration::from_secs(1);
    let address = server::database().await;
    let mut fleet = Fleet::start(&address, 0, 1, "1s");
    let way = Way::to(&address).await;
    let cut_off = start(
        &DatabaseAddress::Postgres(way.address.clone()),
        "worker",
        "1s",
    );

    // A job that nobody ends before the test does.
    let mut long = job(0);
    long["method"] = json!("flexible");
    long["output_torques_n_m"] = (0..20).map(|i| json!(50.0 + f64::from(i))).collect();
    long["resolution"] = json!({ "grid": "fine", "positions_per_mesh_period": 150, "contact_solver": "augmented_lagrangian" });
    let url = format!("{}/v1/jobs", fleet.apis[0].base);
    let taken = fleet.client.post(&url).json(&long).answer().await;
    assert_eq!(taken.status(), 202);
    let taken = taken.document().await;
    fleet
        .until(
            "select count(*) from jobs where status = 'running' and attempt = 1",
            1,
        )
        .await;

    way.open.send(false).unwrap();
    let cut_at = Instant::now();
    fleet.hire();
    fleet
        .until(
            "select count(*) from jobs where status = 'running' and attempt = 2",
            1,
        )
        .await;
    computes_no_more(&cut_off, cut_at, LEASE).await;

    let cancelled = fleet
        .client
        .post(format!("{url}/{}/cancel", taken["id"].as_str().unwrap()));
    assert!(cancelled.answer().await.status().is_success());
    // What it reports late changes nothing, and what comes now has nobody else.
    fleet.workers.remove(0).kill();
    way.open.send(true).unwrap();
    fleet.submit(20).taken().await;
    fleet.successful(20).await;
    let ended =
        fleet.number("select count(*) from jobs where status = 'dismissed' and attempt = 2");
    assert_eq!(ended.await, 1, "the job that was cancelled stays so");
    assert_eq!(fleet.number("select count(*) from jobs").await, 21);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn results_whose_connection_dies_are_written_by_another_one_within_the_lease() {
    let _alone = stores::ALONE.lock().await;
    let address = server::database().await;
    let mut fleet = Fleet::start(&address, 0, 1, "6s");
    // The connection dies when the results are said on it, before anything is locked; nobody is told.
    let way = Way::with_fatal(&address, Some("insert into documents")).await;
    let half_open = start(
        &DatabaseAddress::Postgres(way.address.clone()),
        "worker",
        "6s",
    );
    let submitted = fleet.submit(1);
    fleet
        .until("select count(*) from jobs where status <> 'accepted'", 1)
        .await;
    // Somebody who would take it over when the lease is over.
    fleet.hire();
    fleet.successful(1).await;
    submitted.taken().await;
    assert!(way.fatal.lock().unwrap().is_none(), "a connection died");
    assert_eq!(fleet.number("select attempt from jobs").await, 1);
    half_open.kill();
}
