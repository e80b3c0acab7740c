//! The command line.

mod commands;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use meshwright::serve::UnusableDatabase;

/// The exit code for a database that cannot be used: to start again does not help.
const EXIT_DATABASE: u8 = 3;

/// Static transmission error and mesh stiffness of gears with lightening holes.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Serve jobs over HTTP.
    Serve(Box<commands::serve::Serve>),
    /// Compute one submission.
    Solve(commands::solve::Solve),
    /// Compute a study: many variants of one submission, and their table.
    Study(commands::study::Study),
    /// Take a pair out of a REXS model, or write one.
    #[command(subcommand)]
    Rexs(commands::rexs::Rexs),
    /// Make, list and revoke API keys.
    Keys(commands::keys::Keys),
    /// Bring the tables of the database up to date.
    Migrate(commands::migrate::Migrate),
    /// Copy the database, while the service runs or not.
    Backup(commands::backup::Backup),
    /// Ask a running service whether it is ready; exit code 1 if not.
    Health(commands::health::Health),
}

/// Every position of a curve makes and drops matrices of a hundred kilobytes: an allocator that gives such memory back to
/// the system each time spends a fifth of a job on getting it again.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> anyhow::Result<ExitCode> {
    let ended = match Arguments::parse().command {
        Command::Serve(serve) => serve.run(),
        Command::Solve(solve) => solve.run(),
        Command::Study(study) => study.run(),
        Command::Rexs(rexs) => rexs.run(),
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
