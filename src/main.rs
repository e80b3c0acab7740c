//! The command line: reads the configuration, starts the parts, waits for the signal.

mod commands;

use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;

use anyhow::Context;
use clap::{Parser, Subcommand};
use meshwright::config::Config;
use meshwright::serve::serve;
use meshwright::wire::{self, Submission};
use meshwright_engine::analysis::Library;
use meshwright_engine::run::Run;
use tracing_subscriber::EnvFilter;

/// What the substructures that jobs share may take.
const LIBRARY_BYTES: usize = 256 << 20;

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
    /// Compute one submission.
    Solve(commands::solve::Solve),
    /// Recompute the paper's tables, figures and study.
    Reproduce(commands::reproduce::Reproduce),
}

fn main() -> anyhow::Result<ExitCode> {
    match Arguments::parse().command {
        Command::Serve(config) => {
            let runtime =
                tokio::runtime::Runtime::new().context("the runtime cannot be started")?;
            runtime.block_on(serve_until_signal(&config))?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Solve(solve) => solve.run(),
        Command::Reproduce(reproduce) => {
            reproduce.run()?;
            Ok(ExitCode::SUCCESS)
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

    // Jobs share the teeth and blanks that they have in common.
    let library = Library::with_capacity(LIBRARY_BYTES);
    let service = serve(
        config,
        Arc::new(move |submission: &Submission, run: &Run| wire::solve(submission, &library, run)),
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
