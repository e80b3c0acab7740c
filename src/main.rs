//! The command line.

mod commands;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Static transmission error and mesh stiffness of spur gears with lightening holes.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compute one submission.
    Solve(commands::solve::Solve),
}

fn main() -> anyhow::Result<ExitCode> {
    match Arguments::parse().command {
        Command::Solve(solve) => solve.run(),
    }
}
