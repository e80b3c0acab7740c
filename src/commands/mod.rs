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
    /// Read a pair from a REXS model, or write a model.
    #[command(subcommand)]
    Rexs(rexs::Rexs),
    /// Read the openings of a blank from a DXF drawing.
    Outline(outline::Outline),
    /// Make, list and revoke API keys.
    Keys(keys::Keys),
    /// Bring the tables of the database up to date.
    Migrate(migrate::Migrate),
    /// Copy the database; the service may run meanwhile.
    Backup(backup::Backup),
    /// Check whether a running service is ready; exit code 1 if it is not.
    Health(health::Health),
}

/// Runs the command of the command line. An error is printed with its causes in one line.
pub fn run() -> ExitCode {
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
    ended.unwrap_or_else(|error| {
        eprintln!("Error: {error:#}.");
        match error.downcast_ref::<UnusableDatabase>() {
            Some(database) if !database.may_pass() => ExitCode::from(EXIT_DATABASE),
            _ => ExitCode::FAILURE,
        }
    })
}
