//! The documents of the repository: the paper, recomputed, and measurements of the machine; and the hashes by which two versions of the engine are compared.

mod digests;
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
    /// Print the hash of every result, or compare it with an earlier list.
    Digests(digests::Digests),
    /// Measure the speed of this machine, and the growth of time with the size of a request.
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
        Command::Digests(digests) => digests.run(),
        Command::Measure(measure) => measure.run(),
        Command::Reproduce(reproduce) => reproduce.run(),
        Command::Validity(validity) => validity.run(),
    }
}
