//! What the documents of the repository are made by: the paper, recomputed, and the machine, measured at it.

mod measure;
mod reproduce;
mod validity;

use clap::{Parser, Subcommand};

/// Recomputes the paper, and measures the machine at it.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure how fast this machine computes, and how time grows with what is asked.
    Measure(measure::Measure),
    /// Recompute the paper's tables, figures and study.
    Reproduce(reproduce::Reproduce),
    /// Draw the transmission error beside every series of reference solutions.
    Validity(validity::Validity),
}

/// As in the service.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> anyhow::Result<()> {
    match Arguments::parse().command {
        Command::Measure(measure) => measure.run(),
        Command::Reproduce(reproduce) => reproduce.run(),
        Command::Validity(validity) => validity.run(),
    }
}
