//! The service under load: wrk sends requests from a process and a core of its own, and a table shows the results.
//!
//! `./load` runs all of it; `./load latency polls` some. The service keeps its log, its metrics and its database on the
//! disk as in production. Where the overhead of the service is measured, its engine is replaced by one that has the
//! results already (`instant`), or by one that never has them (`endless`); the overload runs the real program.
//!
//! wrk keeps a number of connections busy: where it sends as fast as it is answered, its latencies are those of a queue
//! of that length. Where it has a rate to keep, an answer that is late counts for those that had to wait behind it.

mod service;
mod stub;
mod wrk;

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use clap::Parser;
use serde_json::{Value, json};

use service::Served;
use stub::Stub;
use wrk::{Load, Running, milliseconds};

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Test case 2 of the paper, the submission whose variants are sent.
const SUBMISSION: &str = include_str!("../../api/examples/test-case-2.json");

const SERVICE_CORE: &str = "0";
const SPAN: Duration = Duration::from_secs(10);
const OVERLOAD_SPAN: Duration = Duration::from_secs(60);
/// A thousand waiting jobs, each looked at once a second as `Retry-After` says.
const POLLS_PER_SECOND: f64 = 1000.0;
/// Multiple of the earlier rate that is submitted in the overload: three is to be shown, and the rate may rise meanwhile.
const SURPLUS: f64 = 5.0;
const SCENARIOS: [&str; 6] = [
    "latency",
    "submissions",
    "polls",
    "mixed",
    "previews",
    "overload",
];

#[derive(Parser)]
struct Arguments {
    /// Scenarios to measure; all of them by default.
    #[arg(value_parser = SCENARIOS)]
    scenarios: Vec<String>,
    /// Seconds of overload.
    #[arg(long, default_value_t = OVERLOAD_SPAN.as_secs())]
    overload_seconds: u64,
    /// Given by `cargo bench`.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> anyhow::Result<()> {
    // The same program is the service with the replaced engine, so that it is built once.
    if std::env::args().nth(1).as_deref() == Some("stub") {
        return stub::run(Stub::parse_from(std::env::args().skip(1)));
    }
    let arguments = Arguments::parse();
    let wanted = |name: &str| {
        arguments.scenarios.is_empty() || arguments.scenarios.iter().any(|given| given == name)
    };
    let wrk = Command::new("wrk")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if wrk.is_err() {
        // `cargo bench` runs all benches, on machines without wrk too.
        eprintln!("wrk is not installed, so that nothing was measured; ./load installs it.");
        return Ok(());
    }
    let bench = Bench::new()?;
    describe_machine()?;
    bench.describe_disk()?;
    println!("| scenario | rate | p50 | p99 | longest | processor time a request | answers |");
    println!("| --- | ---: | ---: | ---: | ---: | ---: | --- |");
    if wanted("latency") {
        bench.latency()?;
    }
    if wanted("submissions") {
        bench.submissions()?;
    }
    if wanted("polls") {
        bench.polls()?;
    }
    if wanted("mixed") {
        bench.mixed()?;
    }
    if wanted("previews") {
        bench.previews()?;
    }
    if wanted("overload") {
        bench.overload(Duration::from_secs(arguments.overload_seconds))?;
    }
    Ok(())
}

/// Prints the machine and its load: figures of a busy machine are upper bounds.
fn describe_machine() -> anyhow::Result<()> {
    let processor = fs::read_to_string("/proc/cpuinfo")?;
    let model = processor
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or("unknown", |(_, model)| model);
    let load = fs::read_to_string("/proc/loadavg")?;
    println!(
        "{} cores of {model}; {} threads of others wanted them in the last minute.",
        thread::available_parallelism()?,
        load.split(' ').next().unwrap_or_default(),
    );
    Ok(())
}

/// The folder of databases and lists, and the numbers that have been sent.
struct Bench {
    folder: tempfile::TempDir,
    submission: PathBuf,
    sent: AtomicU64,
}

impl Bench {
    fn new() -> anyhow::Result<Self> {
        // Beside the build: the folder for temporary files may be in memory, and a disk is to be measured.
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR"))?;
        let mut document: Value = serde_json::from_str(SUBMISSION)?;
        document["output_torques_n_m"] = json!(["@torque@"]);
        document["pair"]["driven"]["blank"]["holes"]["radius_mm"] = json!("@radius@");
        let submission = folder.path().join("submission.json");
        fs::write(&submission, serde_json::to_vec(&document)?)?;
        Ok(Self {
            folder,
            submission,
            sent: AtomicU64::new(0),
        })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Prints the time of the disk for the sync that every commit waits for.
    fn describe_disk(&self) -> anyhow::Result<()> {
        let mut file = File::create(self.path("disk"))?;
        file.write_all(&vec![0; 4 << 20])?;
        file.sync_all()?;
        let mut times = Vec::new();
        for page in 0..200_u64 {
            use std::os::unix::fs::FileExt;
            let start = Instant::now();
            file.write_all_at(&[1; 4096], page * 4096)?;
            file.sync_data()?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        println!(
            "The disk writes 4 KiB for good in {:.2} ms in the median, {:.2} ms in 99 of 100 cases.\n",
            times[100], times[198]
        );
        Ok(())
    }

    /// From the submission to the end of a job whose engine time is 0.
    fn latency(&self) -> anyhow::Result<()> {
        let service = self.stub("instant", "latency", 1000)?;
        let load = Load {
            connections: 1,
            ..Load::of("wait", SPAN)
        };
        let seen = self.wrk(&service, &load)?.finish()?;
        seen.row("one job after the other, `Prefer: wait`", &[200]);
        let load = Load {
            connections: 1,
            ..Load::of("round", SPAN)
        };
        let seen = self.wrk(&service, &load)?.finish()?;
        seen.check(&[200, 202]);
        println!(
            "| one job after the other, polled without a pause | {:.0} jobs/s | {} | {} | {} | {} | {} |",
            seen.rounds as f64 / seen.seconds,
            milliseconds(seen.round_p50_us),
            milliseconds(seen.round_p99_us),
            milliseconds(seen.round_max_us),
            seen.processor_time(),
            seen.answers(),
        );
        service.end()
    }

    /// How many submissions are taken, with an engine that never ends and with one that takes no time.
    fn submissions(&self) -> anyhow::Result<()> {
        for engine in ["endless", "instant"] {
            let service = self.stub(engine, &format!("submissions-{engine}"), u32::MAX)?;
            let seen = self.wrk(&service, &Load::of("submit", SPAN))?.finish()?;
            seen.row(&format!("submissions, {engine} engine"), &[202]);
            if engine == "instant" {
                let ended = service.metric("meshwright_jobs_ended_total")?;
                println!(
                    "| jobs ended meanwhile | {:.0}/s | | | | | |",
                    ended / seen.seconds
                );
            }
            service.end()?;
        }
        Ok(())
    }

    /// How many looks at a job are answered.
    fn polls(&self) -> anyhow::Result<()> {
        for (engine, state) in [("instant", "successful"), ("endless", "waiting")] {
            let service = self.stub(engine, &format!("polls-{engine}"), 10_000)?;
            let taken = self.path(&format!("taken-{engine}"));
            let fill = Load {
                taken: Some(&taken),
                rate: Some(500.0),
                ..Load::of("submit", Duration::from_secs(2))
            };
            self.wrk(&service, &fill)?.finish()?.check(&[202]);
            if engine == "instant" {
                service.until_idle(Duration::from_secs(60))?;
            }
            let poll = Load {
                polled: Some(&taken),
                ..Load::of("poll", SPAN)
            };
            self.wrk(&service, &poll)?
                .finish()?
                .row(&format!("polls of {state} jobs"), &[200]);
            service.end()?;
        }
        Ok(())
    }

    /// Five polls for every submission.
    fn mixed(&self) -> anyhow::Result<()> {
        let service = self.stub("endless", "mixed", u32::MAX)?;
        let seen = self.wrk(&service, &Load::of("mixed", SPAN))?.finish()?;
        seen.row("both, five polls for each submission", &[200, 202]);
        let rate = |status| seen.statuses.get(&status).copied().unwrap_or(0) as f64 / seen.seconds;
        println!(
            "| of these | {:.0} submissions/s, {:.0} polls/s | | | | | |",
            rate(202),
            rate(200)
        );
        service.end()
    }

    /// Previews by the real program on all cores: one after the other, first alone and then while both workers compute.
    fn previews(&self) -> anyhow::Result<()> {
        let service = self.program("previews")?;
        let drag = Load {
            connections: 1,
            core: None,
            ..Load::of("preview", SPAN)
        };
        let seen = self.wrk(&service, &drag)?.finish()?;
        seen.row("previews of a dragged hole, 20 positions", &[200]);
        let fill = Load {
            core: None,
            ..Load::of("submit", Duration::from_secs(2))
        };
        self.wrk(&service, &fill)?.finish()?.check(&[202, 503]);
        let seen = self.wrk(&service, &drag)?.finish()?;
        seen.row("the same, while both workers compute", &[200]);
        service.end()
    }

    /// The real program on all cores, with three times the work that it can do.
    fn overload(&self, span: Duration) -> anyhow::Result<()> {
        let service = self.program("overload")?;
        let taken = self.path("taken-overload");

        // The queue is filled, and the served requests are counted.
        let fill = Load {
            taken: Some(&taken),
            core: None,
            ..Load::of("submit", Duration::from_secs(2))
        };
        let full = self.wrk(&service, &fill)?.finish()?;
        full.row("overload: the queue is filled", &[202, 503]);
        // The first jobs compute the teeth that all of them share.
        thread::sleep(SPAN / 2);
        let before = service.metric("meshwright_jobs_ended_total")?;
        let start = Instant::now();
        thread::sleep(SPAN);
        let served = (service.metric("meshwright_jobs_ended_total")? - before)
            / start.elapsed().as_secs_f64();
        println!("| overload: jobs served, no other requests | {served:.1}/s | | | | | |");

        let polled = self.path("polled-overload");
        fs::copy(&taken, &polled)?;
        let before = service.metric("meshwright_jobs_ended_total")?;
        let submit = self.wrk(
            &service,
            &Load {
                taken: Some(&taken),
                rate: Some(SURPLUS * served),
                core: None,
                ..Load::of("submit", span)
            },
        )?;
        let poll = self.wrk(
            &service,
            &Load {
                polled: Some(&polled),
                rate: Some(POLLS_PER_SECOND),
                core: None,
                ..Load::of("poll", span)
            },
        )?;
        let (start, mut memory) = (Instant::now(), Vec::new());
        while start.elapsed() < span {
            thread::sleep(Duration::from_secs(1));
            memory.push(service.memory_mb()?);
        }
        let ended = service.metric("meshwright_jobs_ended_total")? - before;
        let served = ended / start.elapsed().as_secs_f64();
        let submitted = submit.finish()?;
        let surplus = submitted.requests as f64 / submitted.seconds / served;
        submitted.row(
            &format!("overload: submissions, {surplus:.1} times what is served"),
            &[202, 503],
        );
        poll.finish()?.row("overload: polls meanwhile", &[200]);
        println!("| overload: jobs served meanwhile | {served:.1}/s | | | | | |");
        let third = |part: usize| {
            let ends = |at: usize| memory.len() * at / 3;
            memory[ends(part)..ends(part + 1)]
                .iter()
                .copied()
                .fold(0.0, f64::max)
        };
        println!(
            "| overload: most memory in the first, second, last third | {:.0}, {:.0}, {:.0} MB | | | | | |",
            third(0),
            third(1),
            third(2)
        );

        // Every job that was taken comes to its end, and is there.
        let start = Instant::now();
        service.until_idle(Duration::from_secs(600))?;
        let addresses: Vec<_> = BufReader::new(File::open(&taken)?)
            .lines()
            .collect::<Result<_, _>>()?;
        let successful = service.successful(&addresses)?;
        println!(
            "| afterwards: jobs taken and successful | {} of {} | | | | | all ended {:.0} s later |",
            successful,
            addresses.len(),
            start.elapsed().as_secs_f64()
        );
        ensure!(successful == addresses.len(), "jobs were lost");
        service.end()
    }

    /// The service with a replaced engine, on one core.
    fn stub(&self, engine: &str, name: &str, queue_limit: u32) -> anyhow::Result<Served> {
        let mut command = Command::new("taskset");
        command.args(["--cpu-list", SERVICE_CORE]);
        command
            .arg(std::env::current_exe()?)
            .args(["stub", engine, "--workers", "2"]);
        self.serve(command, name, queue_limit)
    }

    /// The real program on all cores.
    fn program(&self, name: &str) -> anyhow::Result<Served> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meshwright"));
        command.arg("serve");
        self.serve(command, name, 1000)
    }

    fn serve(&self, mut command: Command, name: &str, queue_limit: u32) -> anyhow::Result<Served> {
        let mut process = command
            .args(["--listen", "127.0.0.1:0", "--database"])
            .arg(self.path(&format!("{name}.db")))
            .args(["--queue-limit", &queue_limit.to_string()])
            .env_remove("MESHWRIGHT_LOG")
            .stdout(Stdio::piped())
            .stderr(File::create(self.path(&format!("{name}.log")))?)
            .spawn()?;
        let mut line = String::new();
        BufReader::new(process.stdout.take().context("the output is a pipe")?)
            .read_line(&mut line)?;
        let address = line
            .split_once("http://")
            .and_then(|(_, rest)| rest.split_once(';'))
            .with_context(|| format!("the service has not started: {line}"))?
            .0
            .to_owned();
        Ok(Served { process, address })
    }

    fn wrk<'a>(&self, service: &'a Served, load: &Load<'_>) -> anyhow::Result<Running<'a>> {
        // Scripts count upwards from here; nobody sends so many in one run.
        let first = self.sent.fetch_add(1_000_000, Ordering::Relaxed);
        load.start(service, &self.submission, first)
    }
}
