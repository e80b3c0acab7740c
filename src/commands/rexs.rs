//! `meshwright rexs`: submissions out of REXS models, and models out of submissions.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use jiff::Zoned;
use meshwright_exchange::rexs::{Choices, Import, LoadedFlank, import};
use meshwright_wire::{Submission, model_of};
use serde_json::Value;

use super::document::{EXIT_PROBLEM, read, text_of, text_with_origins, write};

/// Read a pair from a REXS model, or write a model.
#[derive(Debug, clap::Subcommand)]
pub(crate) enum Rexs {
    /// Read a pair from a model, and write its submission.
    Import {
        /// The model, REXS 1.0 to 2 as XML, as JSON or zipped; - reads standard input.
        model: PathBuf,
        /// Where to write the submission.
        #[arg(long, short, default_value = "-")]
        output: PathBuf,
        #[command(flatten)]
        choices: ModelChoices,
    },
    /// Write a submission as a REXS 2.0 model, with its results if they are given.
    Export {
        /// The submission; - reads standard input.
        submission: PathBuf,
        /// Its results document.
        results: Option<PathBuf>,
        /// Where to write the model.
        #[arg(long, short, default_value = "-")]
        output: PathBuf,
    },
}

/// Choices that a REXS model leaves open.
#[derive(Debug, clap::Args)]
pub(crate) struct ModelChoices {
    /// REXS model: id of the cylindrical stage, if there are several.
    #[arg(long, value_name = "ID")]
    stage: Option<i64>,
    /// REXS model: torques on the driven gear, instead of those of the model.
    #[arg(
        long,
        value_name = "N_M",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    torque: Vec<f64>,
    /// REXS model: method, instead of that of the model; flexible if neither says one.
    #[arg(long)]
    method: Option<String>,
    /// REXS model: bore radius of both gears, or of the driving and the driven one, instead of those of the model.
    #[arg(long, value_name = "MM", value_delimiter = ',')]
    bore_radius: Vec<f64>,
    /// REXS model: loaded flanks of both gears, instead of those of the model.
    #[arg(long, value_parser = ["left", "right"])]
    flank: Option<String>,
}

impl ModelChoices {
    /// The first option that is given.
    pub(super) fn given(&self) -> Option<&'static str> {
        [
            (self.stage.is_some(), "--stage"),
            (!self.torque.is_empty(), "--torque"),
            (self.method.is_some(), "--method"),
            (!self.bore_radius.is_empty(), "--bore-radius"),
            (self.flank.is_some(), "--flank"),
        ]
        .into_iter()
        .find_map(|(given, name)| given.then_some(name))
    }

    /// The submission of one pair of a model. Prints what it assumes, what it does not read, and faults.
    pub(super) fn submission(&self, model: &[u8]) -> Option<Submission> {
        let choices = Choices {
            stage: self.stage,
            torques: self.torque.clone(),
            method: self.method.clone(),
            bore_radii: self.bore_radius.clone(),
            flank: self.flank.as_deref().and_then(LoadedFlank::named),
        };
        let imported: Import = match import(model, &choices) {
            Ok(imported) => imported,
            Err(refused) => {
                eprint!("{refused}");
                return None;
            }
        };
        for remark in &imported.remarks {
            eprintln!("{remark}");
        }
        let parsed = Submission::parse(imported.submission.to_string().as_bytes());
        parsed
            .map_err(|problem| {
                eprint!(
                    "{}",
                    text_with_origins(&problem, |field| imported.origin(field))
                )
            })
            .ok()
    }
}

impl Rexs {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or written. Faults of a document are printed and end with exit code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        match self {
            Self::Import {
                model,
                output,
                choices,
            } => {
                let Some(submission) = choices.submission(&read(model)?) else {
                    return Ok(ExitCode::from(EXIT_PROBLEM));
                };
                let json = serde_json::to_string_pretty(&submission)?;
                write(output, &json)?;
            }
            Self::Export {
                submission,
                results,
                output,
            } => {
                let submission = match Submission::parse(&read(submission)?) {
                    Ok(submission) => submission,
                    Err(problem) => {
                        eprint!("{}", text_of(&problem));
                        return Ok(ExitCode::from(EXIT_PROBLEM));
                    }
                };
                let results: Option<Value> = match results {
                    Some(path) => Some(
                        serde_json::from_slice(&read(path)?)
                            .with_context(|| format!("{} is no JSON", path.display()))?,
                    ),
                    None => None,
                };
                if let Some(results) = &results
                    && results["evidence"]["input_hash"] != submission.input_hash()
                {
                    eprintln!(
                        "The results are not those of this submission: their evidence.input_hash is {}, that of the submission {}.",
                        results["evidence"]["input_hash"],
                        submission.input_hash()
                    );
                    return Ok(ExitCode::from(EXIT_PROBLEM));
                }
                let date = Zoned::now().strftime("%Y-%m-%dT%H:%M:%S%:z").to_string();
                write(
                    output,
                    model_of(&submission, results.as_ref(), &date).trim_end(),
                )?;
            }
        }
        Ok(ExitCode::SUCCESS)
    }
}
