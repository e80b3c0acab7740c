//! Clients without a key that ask for as much as they can and take nothing of it: those who have a key notice nothing, and the
//! service ends when it is told to. `./chaos` measures it.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::{Duration, Instant};

use jiff::Timestamp;
use meshwright::jobs::{DatabaseAddress, KeyRecord, Role, Store};
use meshwright::keys::Key;
use tempfile::TempDir;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpSocket, TcpStream};
use tokio::task::JoinSet;

use crate::bench::{Asked, Bench, PATIENCE, results};
use crate::process::Process;
use crate::stores;

/// The program on a database of its own, with `arguments`, and a key for each of two clients.
pub(crate) async fn shared_by(
    clients: [&str; 2],
    arguments: &[&str],
) -> (TempDir, Process, [String; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let process = Process::start_with(&database, arguments);
    let [one, other] = clients;
    let keys = [
        make_key(&database, one).await,
        make_key(&database, other).await,
    ];
    (folder, process, keys)
}

/// Makes a key, as `meshwright keys create` does.
pub(crate) async fn make_key(database: &DatabaseAddress, client: &str) -> String {
    let store = Store::open(database).await.unwrap();
    let key = Key::random().unwrap();
    let record = KeyRecord {
        id: key.id().to_owned(),
        client: client.to_owned(),
        name: client.to_owned(),
        role: Role::Client,
        secret_hash: key.secret_hash(),
        requests_per_second: None,
        queue_limit: None,
        created_at: Timestamp::now(),
        expires_at: None,
        revoked_at: None,
    };
    store.add_key(&record).await.unwrap();
    store.close().await;
    key.reveal()
}

/// Twenty requests for the largest file that there is.
fn pipelined() -> String {
    "GET /docs/swagger-ui-bundle.js HTTP/1.1\r\nHost: localhost\r\nAccept-Encoding: gzip\r\n\r\n"
        .repeat(20)
}

/// A connection from an address of this machine that has sent them and takes nothing.
async fn greedy(service: SocketAddr, from: Ipv4Addr) -> std::io::Result<TcpStream> {
    let socket = TcpSocket::new_v4()?;
    socket.bind((from, 0).into())?;
    let mut stream = socket.connect(service).await?;
    stream.write_all(pipelined().as_bytes()).await?;
    Ok(stream)
}

/// A hundred of them, by turns from so many addresses. Each comes again when it has been sent away.
fn flood(service: SocketAddr, addresses: u8) -> JoinSet<()> {
    let mut flood = JoinSet::new();
    for number in 0..100 {
        let from = Ipv4Addr::new(127, 0, 0, 2 + number % addresses);
        flood.spawn(async move {
            loop {
                if let Ok(stream) = greedy(service, from).await {
                    // Without a read there is no other sign that the service has closed it.
                    let mut stream = stream;
                    while stream.write_all(b"\r\n").await.is_ok() {
                        tokio::time::sleep(Duration::from_millis(100)).await;
                    }
                }
                tokio::task::yield_now().await;
            }
        });
    }
    flood
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn eighty_sockets_that_take_nothing_lock_nobody_out_of_sixty_four_places() {
    let engine = Arc::new(|_: &_, _: &_| Ok(results()));
    let bench = Bench::start(|config| config.admission.connections = 64, engine).await;
    let key = make_key(&bench.config.database, "portal").await;
    let service = bench.service().address().unwrap();
    let ask = async || {
        let request = bench.get("/v1/jobs").bearer_auth(&key);
        // Each on a connection of its own, which has to find a place.
        request.header("connection", "close").answer().await
    };
    // From here on the service knows that there are keys, and this one.
    assert_eq!(ask().await.status(), 200);
    let mut sockets = Vec::new();
    for _ in 0..80 {
        // Some are sent away before they have said everything.
        sockets.extend(greedy(service, Ipv4Addr::LOCALHOST).await.ok());
    }
    let answers = async {
        for _ in 0..20 {
            assert_eq!(ask().await.status(), 200);
        }
    };
    answers.await;
    drop(sockets);
}

/// How a flood from so many addresses is borne: how many of a hundred requests with a key are answered, and how fast; and
/// how long the end takes.
async fn bear(addresses: u8) -> (usize, Vec<Duration>, Duration) {
    let folder = tempfile::tempdir().unwrap();
    let database = stores::place(&folder).await;
    let process = Process::start(&database);
    let key = make_key(&database, "portal").await;
    let service = process.base.trim_start_matches("http://").parse().unwrap();
    let client = meshwright::client().timeout(PATIENCE).build().unwrap();
    let ask = async || {
        let request = client.get(format!("{}/v1/jobs", process.base));
        request
            .bearer_auth(&key)
            .header("connection", "close")
            .send()
            .await
    };
    let mut flood = flood(service, addresses);
    let (mut taken, mut good) = (Vec::new(), 0);
    for _ in 0..100 {
        let start = Instant::now();
        let answer = ask().await;
        taken.push(start.elapsed());
        good += usize::from(answer.is_ok_and(|answer| answer.status() == 200));
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let end = process.terminate();
    flood.shutdown().await;
    taken.sort();
    (good, taken, end)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "./test all"]
async fn a_flood_without_a_key_stops_nobody_who_has_one_and_holds_up_no_shutdown() {
    let _alone = stores::ALONE.lock().await;
    for addresses in [1, 20] {
        let (good, taken, end) = bear(addresses).await;
        assert_eq!(good, 100);
        println!(
            "beside 100 sockets from {addresses} addresses that ask for 20 files each and take nothing: 100 of 100 requests with a key answered, half within {:?}, 95 within {:?}; ended {end:?} after SIGTERM",
            taken[50], taken[94],
        );
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "it measures, and wants the machine for itself: ./chaos"]
async fn ninety_five_of_a_hundred_are_answered_within_a_fifth_of_a_second() {
    for addresses in [1, 20] {
        let (_, taken, _) = bear(addresses).await;
        assert!(taken[94] < Duration::from_millis(200), "{:?}", taken[94]);
    }
}
