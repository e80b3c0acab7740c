//! `meshwright backup`: a copy of the database while it is served.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail};

use crate::jobs::{DatabaseAddress, Store};

/// Copy the database; the service may run meanwhile.
#[derive(Debug, clap::Args)]
pub(crate) struct Backup {
    /// File of the database.
    #[arg(
        long,
        env = "MESHWRIGHT_DATABASE",
        default_value = "./meshwright.db",
        hide_env_values = true,
        value_name = "FILE"
    )]
    database: DatabaseAddress,
    /// Path of the copy; it must not exist yet.
    target: PathBuf,
}

impl Backup {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If there is no database, something is at the target, or the copy cannot be made; then nothing is left there.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        if self.database.file().is_some_and(|file| !file.exists()) {
            bail!("there is no database {}", self.database);
        }
        let runtime = crate::runtime::runtime()?;
        runtime
            .block_on(Store::backup(&self.database, &self.target))
            .with_context(|| format!("cannot back up {}", self.database))?;
        let bytes = std::fs::metadata(&self.target).map_or(0, |data| data.len());
        println!(
            "{} has {bytes} bytes, and was checked.",
            self.target.display()
        );
        Ok(ExitCode::SUCCESS)
    }
}
