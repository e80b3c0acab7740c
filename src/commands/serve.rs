//! `meshwright serve`: the service until a signal ends it.

use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context;
use meshwright::config::Config;
use meshwright::serve::serve;
use meshwright::wire;
use tracing_subscriber::EnvFilter;

use super::demo;

/// Serve jobs over HTTP.
#[derive(Debug, clap::Args)]
pub(crate) struct Serve {
    #[command(flatten)]
    config: Config,
    /// Submit test case 2 of the paper to the service once it runs, show what comes of it, and go on serving.
    #[arg(long)]
    demo: bool,
}

impl Serve {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If the service cannot start, or the demo gets an answer that it cannot read.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let runtime = tokio::runtime::Runtime::new().context("the runtime cannot be started")?;
        runtime.block_on(self.until_signal())?;
        Ok(ExitCode::SUCCESS)
    }

    async fn until_signal(&self) -> anyhow::Result<()> {
        // The demo speaks for itself; the log would interrupt it.
        let quiet = if self.demo { "warn" } else { "info" };
        let filter =
            EnvFilter::try_from_env("MESHWRIGHT_LOG").unwrap_or_else(|_| EnvFilter::new(quiet));
        tracing_subscriber::fmt()
            .with_env_filter(filter)
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal())
            .init();

        let service = serve(
            &self.config,
            Arc::new(wire::solve),
            Arc::new(jiff::Timestamp::now),
        )
        .await?;
        println!(
            "Meshwright serves http://{}; its documentation is at /docs.",
            service.address()
        );
        if self.demo {
            demo::run(service.address()).await?;
        }
        signal().await?;
        // A second signal does not wait for the end of the first.
        tokio::select! {
            () = service.shut_down() => Ok(()),
            second = signal() => second,
        }
    }
}

/// Comes with ctrl-c, or when the system asks the process to end.
async fn signal() -> anyhow::Result<()> {
    let interrupt = tokio::signal::ctrl_c();
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        let mut terminate = signal(SignalKind::terminate()).context("cannot listen for signals")?;
        tokio::select! {
            result = interrupt => result.context("cannot listen for signals"),
            _ = terminate.recv() => Ok(()),
        }
    }
    #[cfg(not(unix))]
    interrupt.await.context("cannot listen for signals")
}
