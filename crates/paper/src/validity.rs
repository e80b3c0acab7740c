//! `meshwright-paper validity`: the transmission error of the service beside every series of reference solutions.
//!
//! These figures show point by point the comparisons that docs/validity.md has in a line each.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_plot::{Axis, Chart, Figure, Look, PALETTE, Panel, Series};
use meshwright_wire::Submission;
use meshwright_wire::solve::solve;
use serde_json::{Value, json};

/// Draw the transmission error of the service beside every series of reference solutions.
#[derive(Debug, clap::Args)]
pub(crate) struct Validity {
    /// The folder of the reference solutions.
    #[arg(long, default_value = "tests/reference")]
    reference: PathBuf,
    /// The folder to write figures/ to.
    #[arg(long, short, default_value = "docs")]
    output: PathBuf,
}

/// A panel: its title, the files whose points it shows, and the torque in N m that they share.
struct Shown {
    title: &'static str,
    files: &'static [&'static str],
    torque: f64,
}

const fn shown(title: &'static str, files: &'static [&'static str], torque: f64) -> Shown {
    Shown {
        title,
        files,
        torque,
    }
}

/// The figures: file, title and panels.
const FIGURES: [(&str, &str, &[Shown]); 3] = [
    (
        "validity-flanks.svg",
        "50/50 teeth: reliefs, crowning, tips and a deviation",
        &[
            shown("S1: relief", &["s1", "check-s1", "fillet"], 115.0),
            shown("S1: relief", &["s1"], 20.0),
            shown("S2: no relief", &["s2", "check-s2"], 115.0),
            shown("crowning by 8 µm", &["crowning"], 115.0),
            shown("tips rounded by 0.2 mm", &["rounding"], 115.0),
            shown("a tooth out by 6 µm", &["pitch-error"], 115.0),
        ],
    ),
    (
        "validity-pairs.svg",
        "Paths beside the pitch point, materials, three pairs in contact, steep reliefs",
        &[
            shown("40/80, recess", &["recess"], 115.0),
            shown("40/80, approach", &["approach"], 115.0),
            shown("steel on a polymer", &["materials"], 8.0),
            shown("contact ratio 2.09", &["contact-ratio"], 180.0),
            shown("17/80, reliefs of 30 µm", &["steep-relief"], 96.0),
            shown("17/80, reliefs of 30 µm", &["steep-relief"], 384.0),
        ],
    ),
    (
        "validity-blanks.svg",
        "Blanks: holes and webs",
        &[
            shown("S3: eight holes", &["s3"], 115.0),
            shown("four unequal holes", &["four-holes"], 115.0),
            shown("a web of 6 mm", &["web"], 115.0),
            shown("the web with six holes", &["web-holes"], 115.0),
        ],
    ),
];

impl Validity {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written, or a pair cannot be computed.
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        let library = Library::default();
        let folder = self.output.join("figures");
        fs::create_dir_all(&folder)
            .with_context(|| format!("{} cannot be created", folder.display()))?;
        for (file, title, panels) in FIGURES {
            let panels = panels
                .iter()
                .map(|each| self.panel(each, &library).context(each.title))
                .collect::<anyhow::Result<Vec<_>>>()?;
            let figure = Figure {
                title: title.into(),
                columns: 2,
                panel_size: (470, 230),
                panels,
            };
            let path = folder.join(file);
            fs::write(&path, figure.to_svg())
                .with_context(|| format!("{} cannot be written", path.display()))?;
            println!("{}", path.display());
        }
        Ok(())
    }

    fn panel(&self, shown: &Shown, library: &Library) -> anyhow::Result<Panel> {
        let mut points = Vec::new();
        for name in shown.files {
            points.extend(points_of(&read(&self.reference, name)?, shown.torque)?);
        }
        let ends =
            |(low, high): (f64, f64), point: &(f64, f64)| (low.min(point.0), high.max(point.0));
        let (first, last) = points.iter().fold((f64::INFINITY, 0.0), ends);
        let (first, last) = (first.floor(), last.ceil());
        let submission = self.submission(shown.files[0], shown.torque)?;
        let mut curve = curve_of(&submission, library)?;
        curve.retain(|(position, _)| (first..=last).contains(position));
        let values: Vec<f64> = curve.iter().chain(&points).map(|point| point.1).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        Ok(Panel::Chart(Chart {
            title: format!("{}, {} N m", shown.title, shown.torque),
            x: Axis::linear("mesh position in mesh periods", first, last),
            y: Axis::reaching("STE in µm", (least.ceil(), least.ceil()), &values),
            series: vec![
                Series::new("this service", PALETTE[2], Look::Line, curve),
                Series::new("CalculiX", PALETTE[1], Look::Rings, points),
            ],
            marks: Vec::new(),
        }))
    }

    /// The pair of the series `name`. Series of others describe it in words; our own checks of them have the submission.
    fn submission(&self, name: &str, torque: f64) -> anyhow::Result<Value> {
        let holder = match name {
            "s1" | "s3" => "check-s1",
            "s2" => "check-s2",
            own => own,
        };
        let mut submission = read(&self.reference, holder)?["inputs"]["submission"].take();
        submission["output_torques_n_m"] = json!([torque]);
        if name == "s3" {
            submission["pair"]["driven"]["blank"]["holes"] = json!({ "count": 8, "circle_radius_mm": 34.0, "radius_mm": 8.39, "phase_deg": 1.6938 });
        }
        Ok(submission)
    }
}

fn read(folder: &Path, name: &str) -> anyhow::Result<Value> {
    let path = folder.join(format!("calculix-{name}.json"));
    let text =
        fs::read_to_string(&path).with_context(|| format!("{} cannot be read", path.display()))?;
    serde_json::from_str(&text).with_context(|| format!("{} is no JSON", path.display()))
}

/// The transmission errors of a series at `torque`, by mesh position.
fn points_of(series: &Value, torque: f64) -> anyhow::Result<Vec<(f64, f64)>> {
    let positions = series["positions"].as_array().context("no positions")?;
    let mut points = Vec::new();
    for position in positions {
        let eta = position["mesh_position"].as_f64().context("no position")?;
        for load in position["loads"].as_array().context("no loads")? {
            let error = load["transmission_error_um"].as_f64().context("no value")?;
            if load["output_torque_n_m"].as_f64() == Some(torque) {
                points.push((eta, error));
            }
        }
    }
    Ok(points)
}

/// The curve of the service, to the end of its period.
fn curve_of(submission: &Value, library: &Library) -> anyhow::Result<Vec<(f64, f64)>> {
    let refused = |problem: meshwright_wire::Problem| anyhow::anyhow!("{}", problem.detail);
    let submission = Submission::parse(submission.to_string().as_bytes()).map_err(refused)?;
    let results = solve(&submission, library, &Run::unattended()).map_err(refused)?;
    let curve = results.curves.into_iter().next().context("no curve")?;
    let (positions, errors) = (curve.mesh_position, curve.transmission_error_um);
    let step = positions[1] - positions[0];
    let end = positions.last().map(|last| (last + step, errors[0]));
    Ok(positions.into_iter().zip(errors).chain(end).collect())
}
