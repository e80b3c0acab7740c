//! The command line: reads the configuration, starts the parts, waits for the signal.

use std::io::IsTerminal;
use std::sync::Arc;

use anyhow::Context;
use clap::{Parser, Subcommand};
use meshwright::config::Config;
use meshwright::serve::serve;
use meshwright::wire;
use tracing_subscriber::EnvFilter;

/// Static transmission error and mesh stiffness of spur gears with lightening holes.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Serve jobs over HTTP.
    Serve(Config),
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    match arguments.command {
        Command::Serve(config) => {
            let runtime =
                tokio::runtime::Runtime::new().context("the runtime cannot be started")?;
            runtime.block_on(serve_until_signal(&config))
        }
    }
}

async fn serve_until_signal(config: &Config) -> anyhow::Result<()> {
    let filter =
        EnvFilter::try_from_env("MESHWRIGHT_LOG").unwrap_or_else(|_| EnvFilter::new("info"));
    tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .init();

    let service = serve(
        config,
        Arc::new(wire::solve),
        Arc::new(jiff::Timestamp::now),
    )
    .await?;
    println!(
        "Meshwright serves http://{}; its documentation is at /docs.",
        service.address()
    );
    signal().await?;
    // A second signal does not wait for the end of the first.
    tokio::select! {
        () = service.shut_down() => Ok(()),
        second = signal() => second,
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
