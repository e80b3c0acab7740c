//! `meshwright-paper reproduce`: every table, figure and claim of the paper, recomputed.
//!
//! Read in this order: [`cases`] (submissions), [`paper`] (printed values), [`computed`] (results), then [`tables`], [`claims`], [`figures`] and the [`report`]
//! that contains them.

pub(super) mod cases;
mod claims;
pub(super) mod computed;
mod figures;
mod paper;
mod report;
pub(super) mod tables;

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::Context;

use computed::Computed;

/// Recompute the paper's tables, figures and study as a document.
#[derive(Debug, clap::Args)]
pub(crate) struct Reproduce {
    /// The folder to write reproduction.md and figures/ to.
    #[arg(long, short, default_value = "docs")]
    output: PathBuf,
}

impl Reproduce {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a case cannot be computed or a file cannot be written.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        let started = Instant::now();
        let computed = Computed::new(&|line| println!("{line}"))?;
        let figures = figures::all(&computed)?;
        let report = report::text(&computed, &figures)?;
        let folder = self.output.join("figures");
        fs::create_dir_all(&folder)
            .with_context(|| format!("{} cannot be created", folder.display()))?;
        for figure in &figures {
            let path = folder.join(figure.file);
            fs::write(&path, &figure.svg)
                .with_context(|| format!("{} cannot be written", path.display()))?;
        }
        let path = self.output.join("reproduction.md");
        fs::write(&path, report)
            .with_context(|| format!("{} cannot be written", path.display()))?;
        let bytes: usize = figures.iter().map(|figure| figure.svg.len()).sum();
        println!(
            "{} and {} figures ({} kB) in {:.1} s.",
            path.display(),
            figures.len(),
            bytes.div_ceil(1000),
            started.elapsed().as_secs_f64()
        );
        Ok(())
    }
}
