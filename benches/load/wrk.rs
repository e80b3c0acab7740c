//! wrk: its load and its results.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::Context;
use serde::Deserialize;

use crate::service::Served;

const SCRIPTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/load");

const CLIENT_CORE: &str = "1";
const CONNECTIONS: u32 = 32;

/// Load that wrk produces.
pub(crate) struct Load<'a> {
    pub(crate) script: &'a str,
    pub(crate) connections: u32,
    pub(crate) span: Duration,
    /// Requests a second; as many as are answered if absent.
    pub(crate) rate: Option<f64>,
    /// Where to write the addresses of the jobs taken.
    pub(crate) taken: Option<&'a Path>,
    /// Addresses to look at.
    pub(crate) polled: Option<&'a Path>,
    /// The core to run on, or any.
    pub(crate) core: Option<&'a str>,
}

/// Results of wrk. Latencies are in microseconds; a round is a submission with all looks at its job.
#[derive(Debug, Deserialize)]
pub(crate) struct Seen {
    pub(crate) requests: u64,
    pub(crate) seconds: f64,
    socket_errors: u64,
    pub(crate) statuses: std::collections::BTreeMap<u16, u64>,
    p50_us: f64,
    p99_us: f64,
    max_us: f64,
    pub(crate) rounds: u64,
    pub(crate) round_p50_us: f64,
    pub(crate) round_p99_us: f64,
    pub(crate) round_max_us: f64,
    /// Processor time of the service for each request, which other processes on the machine hardly change. Absent where
    /// its engine works too.
    #[serde(skip)]
    processor_us: Option<f64>,
}

impl<'a> Load<'a> {
    pub(crate) fn of(script: &'a str, span: Duration) -> Self {
        Self {
            script,
            connections: CONNECTIONS,
            span,
            rate: None,
            taken: None,
            polled: None,
            core: Some(CLIENT_CORE),
        }
    }

    /// Sends variants of `submission` to `service`, numbered from `first`.
    pub(crate) fn start<'s>(
        &self,
        service: &'s Served,
        submission: &Path,
        first: u64,
    ) -> anyhow::Result<Running<'s>> {
        let mut command = match self.core {
            Some(core) => {
                let mut command = Command::new("taskset");
                command.args(["--cpu-list", core, "wrk"]);
                command
            }
            None => Command::new("wrk"),
        };
        command
            .args(["--threads", "1", "--timeout", "60s"])
            .args(["--connections", &self.connections.to_string()])
            .args(["--duration", &format!("{}s", self.span.as_secs())])
            .args(["--script", &format!("{SCRIPTS}/{}.lua", self.script)])
            .arg(format!("http://{}", service.address))
            .env("LOAD_SCRIPTS", SCRIPTS)
            .env("LOAD_SUBMISSION", submission)
            .env("LOAD_FIRST", first.to_string());
        if let Some(rate) = self.rate {
            command.env("LOAD_RATE", rate.to_string());
        }
        if let Some(path) = self.taken {
            command.env("LOAD_ADDRESSES", path);
        }
        if let Some(path) = self.polled {
            command.env("LOAD_POLLED", path);
        }
        let before_us = match self.core {
            Some(_) => Some(service.processor_us()?),
            None => None,
        };
        Ok(Running {
            process: command.stdout(Stdio::piped()).spawn()?,
            service,
            before_us,
        })
    }
}

/// A wrk that runs.
pub(crate) struct Running<'a> {
    process: Child,
    service: &'a Served,
    /// Processor time of the service before, if it is to be told.
    before_us: Option<f64>,
}

impl Running<'_> {
    pub(crate) fn finish(self) -> anyhow::Result<Seen> {
        let output = self.process.wait_with_output()?;
        let after_us = self.service.processor_us()?;
        let text = String::from_utf8(output.stdout)?;
        let result = text
            .lines()
            .find_map(|line| line.strip_prefix("RESULT "))
            .with_context(|| format!("wrk has no result: {text}"))?;
        let seen: Seen = serde_json::from_str(result)?;
        Ok(Seen {
            processor_us: self
                .before_us
                .map(|before_us| (after_us - before_us) / seen.requests as f64),
            ..seen
        })
    }
}

impl Seen {
    /// Ends the run if an answer was none of those expected.
    pub(crate) fn check(&self, expected: &[u16]) {
        let strange = self
            .statuses
            .keys()
            .any(|status| !expected.contains(status));
        assert!(
            !strange && self.socket_errors == 0,
            "answers that were not expected: {self:?}"
        );
    }

    pub(crate) fn processor_time(&self) -> String {
        self.processor_us
            .map_or_else(String::new, |time| format!("{time:.0} µs"))
    }

    pub(crate) fn answers(&self) -> String {
        let counts: Vec<_> = self
            .statuses
            .iter()
            .map(|(status, count)| format!("{count} x {status}"))
            .collect();
        counts.join(", ")
    }

    pub(crate) fn row(&self, name: &str, expected: &[u16]) {
        self.check(expected);
        println!(
            "| {name} | {:.0}/s | {} | {} | {} | {} | {} |",
            self.requests as f64 / self.seconds,
            milliseconds(self.p50_us),
            milliseconds(self.p99_us),
            milliseconds(self.max_us),
            self.processor_time(),
            self.answers(),
        );
    }
}

pub(crate) fn milliseconds(microseconds: f64) -> String {
    format!("{:.2} ms", microseconds * 1e-3)
}
