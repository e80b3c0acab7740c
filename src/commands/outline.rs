//! `meshwright outline`: the openings of a blank out of a drawing in DXF.

use std::path::PathBuf;
use std::process::ExitCode;

use meshwright_exchange::dxf::outline;

use super::document::{EXIT_PROBLEM, read, write};

/// Write the outline that a drawing comes to, for `blank.outline` of a submission.
#[derive(Debug, clap::Args)]
pub(crate) struct Outline {
    /// The drawing, DXF as text, the axis of the gear at its origin; - reads standard input.
    drawing: PathBuf,
    /// Take only what is on this layer; may be given several times.
    #[arg(long, value_name = "NAME")]
    layer: Vec<String>,
    /// Where to write the outline.
    #[arg(long, short, default_value = "-")]
    output: PathBuf,
}

impl Outline {
    /// Runs the command. What was assumed and left out is printed.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written. What is wrong with the drawing is printed, and is exit code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        match outline(&read(&self.drawing)?, &self.layer) {
            Ok(outline) => {
                for remark in &outline.remarks {
                    eprintln!("{remark}");
                }
                write(&self.output, &outline.to_json())?;
                Ok(ExitCode::SUCCESS)
            }
            Err(refused) => {
                eprint!("{refused}");
                Ok(ExitCode::from(EXIT_PROBLEM))
            }
        }
    }
}
