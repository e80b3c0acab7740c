//! `meshwright health`: the health check of a container that has no other client.

use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context;

/// Check whether a running service is ready.
#[derive(Debug, clap::Args)]
pub(crate) struct Health {
    /// Address that the service listens on.
    #[arg(long, env = "MESHWRIGHT_LISTEN", default_value = "127.0.0.1:8080")]
    listen: std::net::SocketAddr,
}

impl Health {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If there is no answer.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let runtime = crate::runtime::runtime()?;
        let status = runtime.block_on(async {
            let client = crate::client().timeout(Duration::from_secs(3)).build()?;
            // A service that listens everywhere is asked on the loopback.
            let host = if self.listen.ip().is_unspecified() {
                "127.0.0.1".to_owned()
            } else {
                self.listen.ip().to_string()
            };
            client
                .get(format!("http://{host}:{}/health/ready", self.listen.port()))
                .send()
                .await
                .map(|answer| answer.status())
        });
        let status = status.context("no answer from the service")?;
        println!("{status}");
        Ok(if status.is_success() {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        })
    }
}
