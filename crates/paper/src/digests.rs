//! `meshwright-paper digests`: the results of many submissions, each as one hash, so that two versions of the engine are compared to the last bit.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_wire::hash::sha256_hex;
use meshwright_wire::{Submission, methods, solve};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Print the SHA-256 of the results of submissions by every method that takes them, with the library and without it.
#[derive(Debug, clap::Args)]
pub(crate) struct Digests {
    /// Documents of JSON: submissions, studies, whose base is computed, and series of reference solutions.
    #[arg(required = true)]
    documents: Vec<PathBuf>,
    /// Compute them at their own resolution. Otherwise they are computed on the coarse grid at 8 positions a mesh period, in three dimensions over one
    /// mesh period.
    #[arg(long)]
    full: bool,
    /// An earlier list. Lines that are in only one of the two are printed, and are an error.
    #[arg(long)]
    against: Option<PathBuf>,
}

impl Digests {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a document cannot be read, or if the list differs from the earlier one.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        let library = Library::default();
        let mut jobs = Vec::new();
        for path in &self.documents {
            let Some(submission) = submission_of(path)? else {
                continue;
            };
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            for method in methods() {
                jobs.push((name.clone().into_owned(), method, submission.clone()));
            }
        }
        let lines = jobs.par_iter().flat_map_iter(|(name, method, submission)| {
            let submission = self.asked(submission, method);
            let Ok(submission) = Submission::parse(submission.to_string().as_bytes()) else {
                return Vec::new();
            };
            let nothing_kept = Library::with_capacity(0);
            let line = |(kind, library)| {
                let digest = digest(&submission, library);
                format!("{digest}  {name}  {method}  {kind}")
            };
            [("library", &library), ("none", &nothing_kept)]
                .map(line)
                .to_vec()
        });
        let lines: Vec<String> = lines.collect();
        match &self.against {
            None => lines.iter().for_each(|line| println!("{line}")),
            Some(path) => compare(&lines, &read(path)?)?,
        }
        Ok(())
    }

    /// `submission` by `method`, at the resolution at which it is computed here.
    fn asked(&self, submission: &Value, method: &str) -> Value {
        let mut submission = submission.clone();
        submission["method"] = json!(method);
        if !self.full {
            let resolution = &mut submission["resolution"];
            resolution["grid"] = json!("coarse");
            resolution["positions_per_mesh_period"] = json!(8);
            if method == "three_dimensional" {
                resolution["span_mesh_periods"] = json!(1);
            }
        }
        submission
    }
}

/// The hash of the results of `submission`, or of the problem that is met, without the version of the solver.
fn digest(submission: &Submission, library: &Library) -> String {
    let text = match solve(submission, library, &Run::unattended()) {
        Err(problem) => format!("{problem:?}"),
        Ok(results) => match serde_json::to_value(&results) {
            Err(error) => error.to_string(),
            Ok(mut document) => {
                if let Some(evidence) = document["evidence"].as_object_mut() {
                    evidence.remove("solver_version");
                }
                document.to_string()
            }
        },
    };
    sha256_hex(text)
}

/// The submission in a document: itself, the base of a study, or the pair of a series of reference solutions; `None` where it has none of these.
fn submission_of(path: &Path) -> anyhow::Result<Option<Value>> {
    let document: Value = serde_json::from_str(&read(path)?)
        .with_context(|| format!("{} is no JSON", path.display()))?;
    let places = ["", "/base", "/inputs/submission"];
    let mut found = places.iter().filter_map(|place| document.pointer(place));
    Ok(found.find(|found| found.get("pair").is_some()).cloned())
}

/// Prints entries that only one of the lists `now` and `before` has.
fn compare(now: &[String], before: &str) -> anyhow::Result<()> {
    let now: BTreeSet<&str> = now.iter().map(String::as_str).collect();
    let before: BTreeSet<&str> = before.lines().collect();
    for line in now.symmetric_difference(&before) {
        let side = if now.contains(line) {
            "now   "
        } else {
            "before"
        };
        println!("{side} {line}");
    }
    ensure!(
        now == before,
        "the results are not those of the earlier list"
    );
    println!("{} results are as before", now.len());
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<String> {
    fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))
}
