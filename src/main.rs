//! The program: [`meshwright::commands`] with an allocator.

use std::process::ExitCode;

/// Every position of a curve makes and drops matrices of a hundred kilobytes: an allocator that gives such memory back to
/// the system each time spends a fifth of a job on getting it again.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    meshwright::commands::run()
}
