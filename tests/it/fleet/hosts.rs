//! Workers on hosts of their own: network namespaces, joined by a bridge. A way that is cut is a link that is down: packets are
//! lost, and nobody is told.

use super::*;

/// The addresses of all hosts, and the part of them that they share.
const HOSTS: &str = "10.213.77.0/24";
const PREFIX: &str = "10.213.77";
const BRIDGE: &str = "mw-bridge";

/// Hosts by number from 1, each with a link to the bridge. The server is at the bridge.
struct Network {
    hosts: u32,
}

/// The name of a host, and that of its link at the bridge.
fn names(host: u32) -> (String, String) {
    (format!("mw-host-{host}"), format!("mw-link-{host}"))
}

/// Runs `ip` with the words of `arguments`.
fn ip(arguments: &str) -> bool {
    let status = Command::new("ip").args(arguments.split(' ')).status();
    status.is_ok_and(|status| status.success())
}

impl Network {
    fn of(hosts: u32) -> Self {
        let network = Self { hosts };
        let run = |arguments: &str| {
            assert!(
                ip(arguments),
                "ip {arguments}: it takes root, and no names from a run that was killed"
            )
        };
        run(&format!("link add {BRIDGE} type bridge"));
        run(&format!("addr add {PREFIX}.1/24 dev {BRIDGE}"));
        run(&format!("link set {BRIDGE} up"));
        for host in 1..=hosts {
            let (name, link) = names(host);
            run(&format!("netns add {name}"));
            run(&format!(
                "link add {link} type veth peer name eth0 netns {name}"
            ));
            run(&format!("link set {link} master {BRIDGE} up"));
            run(&format!(
                "-n {name} addr add {PREFIX}.{}/24 dev eth0",
                host + 1
            ));
            run(&format!("-n {name} link set lo up"));
            run(&format!("-n {name} link set eth0 up"));
        }
        network
    }

    /// A host hears nothing more, and nobody hears it.
    fn cut(&self, host: u32) {
        assert!(ip(&format!("link set {} down", names(host).1)));
    }

    fn mend(&self, host: u32) {
        assert!(ip(&format!("link set {} up", names(host).1)));
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for host in 1..=self.hosts {
            let (name, link) = names(host);
            ip(&format!("link del {link}"));
            ip(&format!("netns del {name}"));
        }
        ip(&format!("link del {BRIDGE}"));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes root and a minute; tests/fleet runs it"]
async fn a_host_that_is_cut_off_and_returns_loses_no_job_and_doubles_none() {
    const JOBS: u64 = 2000;
    const LEASE: Duration = Duration::from_secs(2);
    let network = Network::of(3);
    let settings = std::env::var("PG_SETTINGS").unwrap_or_default();
    let settings = format!("{settings}\nlisten_addresses = '127.0.0.1,{PREFIX}.1'");
    let (server, _) = tokio::task::spawn_blocking(move || {
        server::start_with(&[("PG_SETTINGS", &settings), ("PG_HOSTS", HOSTS)])
    })
    .await
    .unwrap();
    let address = server::database_of(&server, "fleet").await;
    let mut fleet = Fleet::start(&address, 0, 2, "2s");
    let from_afar = DatabaseAddress::Postgres(address.replace("127.0.0.1", &format!("{PREFIX}.1")));
    for host in 1..=3 {
        let (name, _) = names(host);
        let worker = Process::start_on(&name, &from_afar, &arguments("worker", "2s"));
        fleet.workers.push(worker);
    }

    let start = Instant::now();
    let submitters = fleet.submit(JOBS);
    fleet.successful(500).await;
    network.cut(1);
    let cut = Instant::now();
    // What it ran is taken over: a job is in its second attempt.
    fleet
        .until("select count(*) from jobs where attempt > 1", 1)
        .await;
    let taken_over = cut.elapsed();
    computes_no_more(&fleet.workers[0], cut, LEASE).await;
    let meanwhile = fleet.number(SUCCESSFUL).await;
    assert!(meanwhile > 500, "the others went on");

    network.mend(1);
    let mended = Instant::now();
    let before = fleet.workers[0].processor_seconds();
    while fleet.workers[0].processor_seconds() < before + 0.2 {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    let back = mended.elapsed();
    submitters.taken().await;
    fleet.successful(JOBS.try_into().unwrap()).await;
    check(&fleet, JOBS).await;
    assert!(taken_over < 10 * LEASE, "{taken_over:?}");
    assert!(back < 10 * LEASE, "{back:?}");
    println!(
        "{JOBS} jobs in {:.1} s by workers on three hosts, one of which was cut off: its job taken over after {taken_over:.1?} with leases of {LEASE:?}, \
         it worked again {back:.1?} after the way was mended; by process {:?}",
        start.elapsed().as_secs_f64(),
        share_of_workers(&fleet).await,
    );
}
