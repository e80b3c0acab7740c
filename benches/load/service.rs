//! A service in a process of its own, with its own figures and those of the system.

use std::fs;
use std::process::{Child, Command};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, ensure};
use serde_json::Value;

/// A service in a process of its own.
pub(crate) struct Served {
    pub(crate) process: Child,
    pub(crate) address: String,
}

impl Served {
    fn get(&self, path: &str) -> anyhow::Result<String> {
        tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?
            .block_on(async {
                let client = meshwright::client().build()?;
                let url = format!("http://{}{path}", self.address);
                let response = client.get(url).send().await?;
                Ok(response.error_for_status()?.text().await?)
            })
    }

    /// The sum of a metric over its labels.
    pub(crate) fn metric(&self, name: &str) -> anyhow::Result<f64> {
        let text = self.get("/metrics")?;
        let values = text
            .lines()
            .filter(|line| line.starts_with(name))
            .filter_map(|line| line.rsplit_once(' ')?.1.parse::<f64>().ok());
        Ok(values.sum())
    }

    /// Comes back when no job waits or runs.
    pub(crate) fn until_idle(&self, patience: Duration) -> anyhow::Result<()> {
        let start = Instant::now();
        while self.metric("meshwright_jobs_waiting")? + self.metric("meshwright_jobs_running")?
            > 0.0
        {
            ensure!(
                start.elapsed() < patience,
                "jobs have not ended after {patience:?}"
            );
            thread::sleep(Duration::from_millis(100));
        }
        Ok(())
    }

    /// The number of successful jobs among those at `addresses`.
    pub(crate) fn successful(&self, addresses: &[String]) -> anyhow::Result<usize> {
        let mut count = 0;
        for chunk in addresses.chunks(100) {
            let ids: Vec<_> = chunk
                .iter()
                .filter_map(|address| address.rsplit('/').next())
                .collect();
            let list: Value = serde_json::from_str(
                &self.get(&format!("/v1/jobs?status=successful&ids={}", ids.join(",")))?,
            )?;
            count += list["items"].as_array().map_or(0, Vec::len);
        }
        Ok(count)
    }

    /// Processor time of the process so far.
    pub(crate) fn processor_us(&self) -> anyhow::Result<f64> {
        /// The system counts in hundredths of a second.
        const TICK_US: f64 = 1e4;
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.process.id()))?;
        let (_, behind_name) = stat
            .rsplit_once(')')
            .context("a process has a name in brackets")?;
        let ticks = behind_name
            .split_whitespace()
            .skip(11)
            .take(2)
            .map(str::parse::<f64>)
            .sum::<Result<f64, _>>()?;
        Ok(ticks * TICK_US)
    }

    pub(crate) fn memory_mb(&self) -> anyhow::Result<f64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.process.id()))?;
        let kilobytes = status
            .lines()
            .find_map(|line| line.strip_prefix("VmRSS:")?.trim().strip_suffix(" kB"))
            .context("the system tells the memory of a process")?;
        Ok(kilobytes.trim().parse::<f64>()? / 1024.0)
    }

    /// Ends the service in order.
    pub(crate) fn end(mut self) -> anyhow::Result<()> {
        Command::new("kill")
            .args(["-s", "INT", &self.process.id().to_string()])
            .status()?;
        self.process.wait()?;
        Ok(())
    }
}

impl Drop for Served {
    /// A run that fails leaves no service behind.
    fn drop(&mut self) {
        let _ = self.process.kill();
    }
}
