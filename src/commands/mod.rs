//! The command line.

mod backup;
mod chart;
mod demo;
mod document;
mod health;
mod keys;
mod migrate;
mod outline;
mod progress;
mod rexs;
mod serve;
mod solve;
mod study;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::serve::UnusableDatabase;

/// The exit code for a database that cannot be used, where to start again does not help.
const EXIT_DATABASE: u8 = 3;

/// Static transmission error and mesh stiffness of gears with lightening holes.
#[derive(Parser)]
#[command(name = "meshwright", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Serve jobs over HTTP.
    Serve(Box<serve::Serve>),
    /// Compute one submission.
    Solve(solve::Solve),
    /// Compute a study: many variants of one submission, and their table.
    Study(study::Study),
    /// Take a pair out of a REXS model, or write one.
    #[command(subcommand)]
    Rexs(rexs::Rexs),
    /// Write the openings of a blank that a drawing in DXF comes to.
    Outline(outline::Outline),
    /// Make, list and revoke API keys.
    Keys(keys::Keys),
    /// Bring the tables of the database up to date.
    Migrate(migrate::Migrate),
    /// Copy the database, while the service runs or not.
    Backup(backup::Backup),
    /// Ask a running service whether it is ready; exit code 1 if not.
    Health(health::Health),
}

/// Runs the command of the command line.
///
/// # Errors
///
/// The error of a command that has no exit code of its own for it.
pub fn run() -> anyhow::Result<ExitCode> {
    let ended = match Arguments::parse().command {
        Command::Serve(serve) => serve.run(),
        Command::Solve(solve) => solve.run(),
        Command::Study(study) => study.run(),
        Command::Rexs(rexs) => rexs.run(),
        Command::Outline(outline) => outline.run(),
        Command::Keys(keys) => keys.run(),
        Command::Migrate(migrate) => migrate.run(),
        Command::Backup(backup) => backup.run(),
        Command::Health(health) => health.run(),
    };
    match ended {
        Err(error)
            if error
                .downcast_ref::<UnusableDatabase>()
                .is_some_and(|database| !database.may_pass()) =>
        {
            eprintln!("Error: {error:#}.");
            Ok(ExitCode::from(EXIT_DATABASE))
        }
        ended => ended,
    }
}
