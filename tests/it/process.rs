//! The program itself, in a process of its own.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use reqwest::Client;
use serde_json::Value;

use meshwright::jobs::DatabaseAddress;

use crate::bench::Asked;
use crate::stores;

/// Little memory to share, and what a process with it takes at most.
pub(crate) const LITTLE: [&str; 4] = ["--memory-mb", "256", "--cache-mb", "16"];
pub(crate) const LITTLE_MB: u64 = 256 + 16 + 150;

/// A service in a process of its own.
pub(crate) struct Process {
    child: Child,
    pub(crate) base: String,
}

impl Process {
    pub(crate) fn start(database: &DatabaseAddress) -> Self {
        Self::start_with(database, &[])
    }

    /// The same with more arguments.
    pub(crate) fn start_with(database: &DatabaseAddress, arguments: &[&str]) -> Self {
        let program = Command::new(env!("CARGO_BIN_EXE_meshwright"));
        Self::spawn(program, database, arguments)
    }

    /// The same of another program.
    pub(crate) fn start_program(
        program: &str,
        database: &DatabaseAddress,
        arguments: &[&str],
    ) -> Self {
        Self::spawn(Command::new(program), database, arguments)
    }

    /// The same with so many descriptors.
    pub(crate) fn start_with_descriptors(database: &DatabaseAddress, descriptors: u32) -> Self {
        let mut shell = Command::new("sh");
        let limited = format!("ulimit -n {descriptors}; exec \"$0\" \"$@\"");
        shell.args(["-c", &limited, env!("CARGO_BIN_EXE_meshwright")]);
        Self::spawn(shell, database, &[])
    }

    /// The same on a host of its own, a network namespace.
    pub(crate) fn start_on(host: &str, database: &DatabaseAddress, arguments: &[&str]) -> Self {
        let mut program = Command::new("ip");
        program.args(["netns", "exec", host, env!("CARGO_BIN_EXE_meshwright")]);
        Self::spawn(program, database, arguments)
    }

    fn spawn(mut program: Command, database: &DatabaseAddress, arguments: &[&str]) -> Self {
        let mut child = program
            .args(["serve", "--listen", "127.0.0.1:0", "--database"])
            .arg(stores::address(database))
            .args(arguments)
            .env("MESHWRIGHT_LOG", "warn")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        // The first line says where it listens.
        let output = BufReader::new(child.stdout.take().unwrap());
        let line = output.lines().next().unwrap().unwrap();
        let base = line
            .split_whitespace()
            .find(|word| word.starts_with("http://"))
            // One that only computes listens nowhere.
            .unwrap_or_default();
        let base = base.trim_end_matches(';').to_owned();
        Self { child, base }
    }

    /// SIGKILL: nothing is written, nobody is told.
    pub(crate) fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Sends it a signal.
    pub(crate) fn signal(&self, signal: rustix::process::Signal) {
        let pid = rustix::process::Pid::from_child(&self.child);
        rustix::process::kill_process(pid, signal).unwrap();
    }

    /// SIGTERM, as an operator ends it. Gives back how long it took.
    pub(crate) fn terminate(mut self) -> Duration {
        let start = Instant::now();
        self.signal(rustix::process::Signal::TERM);
        assert!(self.child.wait().unwrap().success());
        start.elapsed()
    }

    pub(crate) async fn get(&self, client: &Client, path: &str) -> Value {
        let response = client.get(format!("{}{path}", self.base)).answer().await;
        assert_eq!(response.status(), 200, "{path}");
        response.document().await
    }

    pub(crate) async fn submit(&self, client: &Client, study: &Value) -> String {
        let response = client
            .post(format!("{}/v1/studies", self.base))
            .json(study)
            .answer()
            .await;
        assert_eq!(response.status(), 202);
        response.headers()["location"].to_str().unwrap().to_owned()
    }

    /// Looks at the study until so many designs are done.
    pub(crate) async fn done(&self, client: &Client, path: &str, count: u64) -> Value {
        loop {
            let study = self.get(client, path).await;
            if study["done"].as_u64().unwrap() >= count {
                return study;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// The processor time that the process has had.
    pub(crate) fn processor_seconds(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let (_, behind_name) = stat.rsplit_once(')').unwrap();
        let ticks = behind_name.split_whitespace().skip(11).take(2);
        // The system counts in hundredths of a second.
        ticks
            .map(|ticks| ticks.parse::<f64>().unwrap())
            .sum::<f64>()
            / 100.0
    }

    /// The most memory that the process has had, in MB.
    pub(crate) fn peak_memory_mb(&self) -> u64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().nth(1));
        kilobytes.unwrap().parse::<u64>().unwrap() / 1000
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // A test that fails leaves no process behind; one that was killed before is no error.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
