//! `meshwright solve`: one submission, or one pair of a REXS model, from a file, computed here and now.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_exchange::rexs::is_model;
use meshwright_studies::solve;
use meshwright_wire::results::{CurveDocument, GearPeakStress, PeakStressDocument, Results};
use meshwright_wire::{Problem, Submission};

use super::document::{EXIT_PROBLEM, has_field, is_dash, read, text_of, write};
use super::progress::Progress;
use super::rexs::ModelChoices;

/// Limit of the memory of the substructures of one submission, in bytes; one pair never reaches it.
const LIBRARY_BYTES: usize = 512 << 20;

/// Bytes of a warning that a terminal shows, about, where it is a list.
const LONGEST_LIST: usize = 600;

/// Compute one submission, or one pair of a REXS model.
#[derive(Debug, clap::Args)]
pub(crate) struct Solve {
    /// The submission, or a REXS model as XML, as JSON or zipped; - reads standard input.
    submission: PathBuf,
    /// Where to write the results document; - writes standard output. Without it, only the table is printed.
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Add the points between the positions (events and extremes) to the lists of the document.
    #[arg(long, requires = "output")]
    between: bool,
    #[command(flatten)]
    model: ModelChoices,
}

impl Solve {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written. A problem with the submission is printed, and is exit code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let document = read(&self.submission)?;
        let started = Instant::now();
        let Some(submission) = self.submission(&document) else {
            return Ok(ExitCode::from(EXIT_PROBLEM));
        };
        let results = match compute(&submission) {
            Ok(results) => results,
            Err(problem) => {
                eprint!("{}", text_of(&problem));
                return Ok(ExitCode::from(EXIT_PROBLEM));
            }
        };
        let table = table(&results, started.elapsed());
        match &self.output {
            Some(path) => {
                let json = if self.between {
                    let with_points = results.with_points();
                    with_points.context("results without points")?.to_json()?
                } else {
                    results.to_json()?
                };
                write(path, &json)?;
                // Standard output may be the document; the table must not end up in it.
                if is_dash(path) {
                    eprint!("{table}")
                } else {
                    print!("{table}")
                }
            }
            None => print!("{table}"),
        }
        Ok(ExitCode::SUCCESS)
    }

    /// The submission, read out of a model if the document is one. Prints faults.
    fn submission(&self, document: &[u8]) -> Option<Submission> {
        if is_model(document) {
            return self.model.submission(document);
        }
        if let Some(option) = self.model.given() {
            eprintln!("{option} is for REXS models; a submission has a field for it.");
            return None;
        }
        if has_field(document, "base") {
            eprintln!("This is a study, not a submission; `meshwright study` computes it.");
            return None;
        }
        let parsed = Submission::parse(document);
        parsed
            .map_err(|problem| eprint!("{}", text_of(&problem)))
            .ok()
    }
}

/// Computes `submission`, and shows how far it is.
fn compute(submission: &Submission) -> Result<Results, Problem> {
    let progress = Progress::of("positions");
    let run = Run::new(Arc::default(), move |done, total| {
        progress.tell(done, total, "");
    });
    solve(submission, &Library::with_capacity(LIBRARY_BYTES), &run)
}

/// The statistics of every torque, the hole and mesh lines, warnings and the time.
fn table(results: &Results, elapsed: Duration) -> String {
    const LINES: [&str; 4] = ["H_N", "H_N1", "H_N2", "H_Z2"];
    let lines: Vec<&str> = LINES
        .into_iter()
        .filter(|label| {
            results
                .curves
                .iter()
                .any(|curve| amplitude(curve, label).is_some())
        })
        .collect();
    let mut text = format!(
        "{:>10}  {:>27}  {:>32}{}\n",
        "torque",
        "transmission error in um",
        "tangent stiffness in N/m",
        if lines.is_empty() {
            ""
        } else {
            "  lines in um"
        }
    );
    text.push_str(&format!(
        "{:>10}  {:>9}{:>9}{:>9}  {:>12}{:>10}{:>10}",
        "N m", "mean", "rms", "p-p", "mean", "rms", "p-p"
    ));
    for label in &lines {
        text.push_str(&format!("  {label:>8}"));
    }
    text.push('\n');
    for curve in &results.curves {
        let (ste, k) = (
            &curve.statistics.transmission_error_um,
            &curve.statistics.mesh_stiffness_tangent_n_per_m,
        );
        text.push_str(&format!(
            "{:>10}  {:>9.3}{:>9.3}{:>9.3}  {:>12.4e}{:>10.2e}{:>10.2e}",
            curve.output_torque_n_m,
            ste.mean,
            ste.rms,
            ste.peak_to_peak,
            k.mean,
            k.rms,
            k.peak_to_peak
        ));
        for label in &lines {
            text.push_str(
                &amplitude(curve, label)
                    .map_or_else(|| format!("  {:>8}", "-"), |a| format!("  {a:>8.4}")),
            );
        }
        text.push('\n');
    }
    for curve in &results.curves {
        text.push_str(&stresses(curve));
    }
    for warning in &results.warnings {
        text.push_str(&format!("Warning: {}\n", for_a_terminal(&warning.detail)));
    }
    text.push_str(&format!(
        "{} over {} positions in {:.2} s, {} degrees of freedom.\n",
        results.method,
        results
            .curves
            .iter()
            .map(|curve| curve.mesh_position.len())
            .sum::<usize>(),
        elapsed.as_secs_f64(),
        results.evidence.degrees_of_freedom
    ));
    text
}

/// A line of the largest stresses, where they were asked for.
fn stresses(curve: &CurveDocument) -> String {
    let Some(PeakStressDocument { driving, driven }) = &curve.statistics.stress else {
        return String::new();
    };
    let of = |gear: &GearPeakStress| {
        let hole = gear.hole_mpa;
        let hole = hole.map_or_else(String::new, |stress| format!(", {stress:.1} at a hole"));
        format!("{:.1} at a root{hole}", gear.root_mpa)
    };
    format!(
        "Largest stress in MPa at {} N m: driving gear {}; driven gear {}.\n",
        curve.output_torque_n_m,
        of(driving),
        of(driven)
    )
}

fn amplitude(curve: &CurveDocument, label: &str) -> Option<f64> {
    let named = &curve.spectrum.as_ref()?.named;
    named
        .iter()
        .find(|line| line.label == label)
        .map(|line| line.transmission_error_um)
}

/// A sentence as a terminal shows it: of a long list, whose parts end with semicolons, the first parts and the number of the others, which the results have.
fn for_a_terminal(detail: &str) -> String {
    let mut parts = detail.split("; ");
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut left = 0;
    for part in parts {
        if left > 0 || text.len() + part.len() > LONGEST_LIST {
            left += 1;
        } else {
            text.push_str("; ");
            text.push_str(part);
        }
    }
    if left > 0 {
        text.push_str(&format!("; {left} more in the results."));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_is_told_with_its_place_and_the_nearest_value() {
        let bad = include_str!("../../api/examples/bad-case-3-as-printed.json");
        let text = text_of(&Submission::parse(bad.as_bytes()).expect_err("the teeth do not reach"));
        for part in [
            "teeth_do_not_reach",
            "/pair/center_distance_mm",
            "nearest: 115.56",
        ] {
            assert!(text.contains(part), "{text}");
        }
    }

    #[test]
    fn a_long_list_is_told_by_its_first_parts_and_the_number_of_the_others() {
        let parts: Vec<String> = (0..100).map(|i| format!("H_Z2 at {i} 1/min")).collect();
        let told = for_a_terminal(&parts.join("; "));
        assert!(told.len() < LONGEST_LIST + 50 && told.starts_with("H_Z2 at 0 1/min; "));
        let shown = told.matches("1/min").count();
        assert!(told.ends_with(&format!("; {} more in the results.", 100 - shown)));
        assert_eq!(for_a_terminal("one; two."), "one; two.");
        let long = format!("{}; two", "one".repeat(LONGEST_LIST));
        assert!(for_a_terminal(&long).ends_with("oneone; 1 more in the results."));
    }
}
