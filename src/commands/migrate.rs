//! `meshwright migrate`: the tables brought up to date by somebody who may, so that the processes that serve need not.

use std::process::ExitCode;

use crate::jobs::DatabaseAddress;
use crate::serve::migrate;

/// Bring the tables of the database up to date.
#[derive(Debug, clap::Args)]
pub(crate) struct Migrate {
    /// File of the database, which no process serves meanwhile; or postgres://user@host/name, whose processes go on.
    #[arg(
        long,
        env = "MESHWRIGHT_DATABASE",
        default_value = "./meshwright.db",
        hide_env_values = true,
        value_name = "FILE or ADDRESS"
    )]
    database: DatabaseAddress,
}

impl Migrate {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If the database is served, or its tables cannot be brought up to date; then nothing is changed.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let runtime = crate::runtime::runtime()?;
        runtime.block_on(migrate(&self.database))?;
        println!("The tables of {} are up to date.", self.database);
        Ok(ExitCode::SUCCESS)
    }
}
