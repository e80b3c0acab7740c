//! Parts of the results as tables or pictures, for those who want a curve and not the whole document.

use axum::Json;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use meshwright_connections::{Keep, Tag};
use meshwright_engine::run::Run;
use meshwright_exchange::fmu::fmu;
use meshwright_exchange::{force_table, look_up};
use meshwright_wire::csv::CsvWriter;
use meshwright_wire::results::CurveDocument;
use meshwright_wire::solve::no_modes;
use meshwright_wire::{Code, Problem, Results};
use serde::Deserialize;
use utoipa::IntoParams;

use super::answer::file;
use super::app::App;
use super::blocking::{blocking, goes_on};
use super::campbell;
use super::client::Client;
use super::curve_columns::{CurveTable, Table, csv, no_table, select};
use super::listed_files::ListedFile;
use super::parameters::{IfNoneMatch, JobId, Parameters, invalid, number};
use super::pictures::{self, Picture};
use super::problem::{Refusal, internal, of_missing_results};
use super::results::{self, TIMES_THE_RESULTS};
use crate::jobs::{Document, Job, Resource as _};

/// The FMU, whose table is finer, takes so many times their bytes.
const TIMES_FOR_AN_FMU: u64 = 16;

/// Which curve.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct TableParameters {
    /// The output torque of the curve, in N m; without it, all curves.
    #[param(example = 115.0)]
    #[serde(default, deserialize_with = "number")]
    torque: Option<f64>,
    /// True puts the points between positions into a table over mesh positions, as into the results.
    #[param(default = false)]
    between: Option<bool>,
}

/// Get {table}
///
/// The transmission error, the mesh stiffness, the spectrum, the run-up or the load along the face alone, as JSON, as CSV or as a picture; the load shares as a
/// picture. The first column of a CSV is the output torque. A column that the results do not have is left out.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/{table}", tag = "Results", operation_id = "get_table",
    params(
        TableParameters,
        IfNoneMatch,
    ),
    responses(
        (status = 200, description = "The table.", body = CurveTable),
        (status = 400, description = "A parameter is not understood."),
        (status = 404, description = "There is no such job, table or torque, or the job has not ended."),
        (status = 409, description = "The job failed or was cancelled, and has no results."),
        (status = 410, description = "The study of the job keeps statistics only (`results_not_kept`); submitted alone, the design has results."),
    ),
)]
pub(super) async fn table(
    client: Client,
    Path((id, file)): Path<(String, String)>,
    Parameters(parameters): Parameters<TableParameters>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    find_file(&file)?;
    let JobId(id) = JobId::of(&id)?;
    let job = Job::find(&client.app.jobs, client.name(), id).await?;
    answer(&client.app, &job, &file, parameters, &request).await
}

/// The `file` of the results of a job, or why there is none.
pub(super) async fn answer(
    app: &App,
    job: &Job,
    file: &str,
    TableParameters { torque, between }: TableParameters,
    request: &HeaderMap,
) -> Result<Response, Refusal> {
    let wanted = find_file(file)?;
    let between = between.unwrap_or_default();
    if between && !wanted.is_over_positions() {
        let detail =
            format!("{file} is no table over mesh positions, to which between would add points.");
        return Err(invalid(detail).into());
    }
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()).into());
    };
    let mut part = torque.map_or_else(|| format!("/{file}"), |torque| format!("/{file}/{torque}"));
    if between {
        part.push_str("/between");
    }
    let made = async {
        let stored = app.jobs.stored(job).await?;
        let times = match wanted {
            File::Fmu => TIMES_FOR_AN_FMU,
            _ => TIMES_THE_RESULTS,
        };
        let most = times * stored.bytes;
        let memory = app.bodies.for_answer(&job.client, most).await?;
        let document = app.jobs.document_of(job, &stored).await?;
        let name = format!("{}-{file}", job.id);
        let made = blocking(&job.client, move |run| {
            make(&document, (wanted, torque, between), &name, run)
        });
        memory.hold_body(made.await??).await
    };
    Tag::of_hash(hash, &part)
        .answer(Keep::ForGood, request, made)
        .await
}

/// The table or picture of a results document, unless nobody waits for it any more.
fn make(
    document: &Document,
    (wanted, torque, between): (File, Option<f64>, bool),
    name: &str,
    run: &Run,
) -> Result<Response, Refusal> {
    let results = results::read(document)?;
    let results = if between {
        results::with_points(results)?
    } else {
        results
    };
    let curves = curves_of(&results, torque)?;
    goes_on(run)?;
    match wanted {
        File::Curves => Ok(file("text/csv; charset=utf-8", name, curves_csv(&curves))),
        File::Table(table, form) => {
            let curves = select(table, &curves)?;
            Ok(match form {
                Form::Json => Json(CurveTable { curves }).into_response(),
                Form::Csv => file("text/csv; charset=utf-8", name, csv(&curves)),
            })
        }
        File::Picture(picture) => {
            let svg = picture.draw(&curves).ok_or_else(|| {
                no_table(match picture {
                    Picture::TransmissionError | Picture::LoadShare => Table::TransmissionError,
                    Picture::MeshStiffness => Table::MeshStiffness,
                    Picture::Spectrum => Table::Spectrum,
                    Picture::RunUp => Table::RunUp,
                    Picture::FaceLoad => Table::FaceLoad,
                })
            });
            Ok(pictures::answer(svg?))
        }
        File::HolePhase => {
            let phase = results.hole_phase.as_ref().ok_or_else(|| {
                let detail = "These results have no hole_phase: it is found for gears at rest and as drawn that repeat at one order, over whole true periods.";
                Problem::new(Code::NotFound, detail)
            });
            Ok(pictures::answer(pictures::hole_phase(phase?)))
        }
        File::LookUp(form) => look_up_table(&results, &curves, form, name),
        File::Forces(form) => forces(&results, form, name),
        File::Fmu => packed(&results, name),
        File::CampbellTable => {
            let modes = results.modes.as_ref().ok_or_else(no_modes)?;
            Ok(file("text/csv; charset=utf-8", name, campbell::csv(modes)))
        }
        File::CampbellDiagram => {
            let svg = campbell::draw(&results).ok_or_else(no_modes)?;
            Ok(pictures::answer(svg))
        }
    }
}

/// The first of the curves as a look-up table.
fn look_up_table(
    results: &Results,
    curves: &[&CurveDocument],
    form: look_up::Form,
    name: &str,
) -> Result<Response, Refusal> {
    let first = curves.first();
    let table = first.and_then(|curve| results.look_up(curve)?.write(form));
    let table = table.ok_or_else(|| {
        let detail = "These results span no whole number of true periods, and a look-up table is read over and over.";
        Problem::new(Code::NotFound, detail)
    })?;
    let media_type = match form {
        look_up::Form::Csv => "text/csv; charset=utf-8",
        look_up::Form::Text => "text/plain; charset=utf-8",
    };
    Ok(file(media_type, name, table))
}

fn no_forces() -> Problem {
    let detail = "These results have no force table: the submission asks for none.";
    Problem::new(Code::NotFound, detail)
}

/// The force table as an FMU. Its GUID is made of the submission.
fn packed(results: &Results, name: &str) -> Result<Response, Refusal> {
    let forces = results.mesh_forces().ok_or_else(no_forces)?;
    let bytes = fmu(&forces, &results.evidence.input_hash).map_err(|error| {
        tracing::error!(%error, "an FMU could not be packed");
        internal()
    })?;
    Ok(file("application/octet-stream", name, bytes))
}

/// The force table as others read it.
fn forces(results: &Results, form: force_table::Form, name: &str) -> Result<Response, Refusal> {
    let forces = results.mesh_forces().ok_or_else(no_forces)?;
    let media_type = match form {
        force_table::Form::Csv => "text/csv; charset=utf-8",
        force_table::Form::Text | force_table::Form::Modelica => "text/plain; charset=utf-8",
    };
    Ok(file(media_type, name, forces.write(form)))
}

/// All lists over mesh positions: one line for each torque and position.
fn curves_csv(curves: &[&CurveDocument]) -> String {
    let tables: Vec<_> = curves.iter().map(|curve| curve.columns()).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in tables.iter().flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let mut text = CsvWriter::default();
    text.text("output_torque_n_m");
    names.iter().for_each(|name| text.text(name));
    text.end_line();
    for (curve, columns) in curves.iter().zip(&tables) {
        let columns: Vec<_> = names
            .iter()
            .map(|name| columns.iter().find(|column| column.0 == *name))
            .collect();
        for row in 0..curve.mesh_position.len() {
            text.number(Some(curve.output_torque_n_m));
            for column in &columns {
                text.number(column.and_then(|column| *column.1.get(row)?));
            }
            text.end_line();
        }
    }
    text.into_text()
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Json,
    Csv,
}

/// Format of a file name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum File {
    Curves,
    Table(Table, Form),
    Picture(Picture),
    HolePhase,
    LookUp(look_up::Form),
    Forces(force_table::Form),
    Fmu,
    CampbellTable,
    CampbellDiagram,
}

#[rustfmt::skip]
const FILES: [(&str, File); 26] = [
    ("curves.csv", File::Curves),
    ("ste.json", File::Table(Table::TransmissionError, Form::Json)),
    ("ste.csv", File::Table(Table::TransmissionError, Form::Csv)),
    ("ste.svg", File::Picture(Picture::TransmissionError)),
    ("mesh-stiffness.json", File::Table(Table::MeshStiffness, Form::Json)),
    ("mesh-stiffness.csv", File::Table(Table::MeshStiffness, Form::Csv)),
    ("mesh-stiffness.svg", File::Picture(Picture::MeshStiffness)),
    ("spectrum.json", File::Table(Table::Spectrum, Form::Json)),
    ("spectrum.csv", File::Table(Table::Spectrum, Form::Csv)),
    ("spectrum.svg", File::Picture(Picture::Spectrum)),
    ("run-up.json", File::Table(Table::RunUp, Form::Json)),
    ("run-up.csv", File::Table(Table::RunUp, Form::Csv)),
    ("run-up.svg", File::Picture(Picture::RunUp)),
    ("face-load.json", File::Table(Table::FaceLoad, Form::Json)),
    ("face-load.csv", File::Table(Table::FaceLoad, Form::Csv)),
    ("face-load.svg", File::Picture(Picture::FaceLoad)),
    ("load-share.svg", File::Picture(Picture::LoadShare)),
    ("hole-phase.svg", File::HolePhase),
    ("look-up-table.csv", File::LookUp(look_up::Form::Csv)),
    ("look-up-table.txt", File::LookUp(look_up::Form::Text)),
    ("force-table.csv", File::Forces(force_table::Form::Csv)),
    ("force-table.txt", File::Forces(force_table::Form::Text)),
    ("force-table.mo", File::Forces(force_table::Form::Modelica)),
    ("force-table.fmu", File::Fmu),
    ("campbell.csv", File::CampbellTable),
    ("campbell.svg", File::CampbellDiagram),
];

impl File {
    /// True for tables of which each line is of a mesh position, among which there may be points.
    fn is_over_positions(self) -> bool {
        match self {
            Self::Curves => true,
            Self::Table(table, _) => matches!(
                table,
                Table::TransmissionError | Table::MeshStiffness | Table::FaceLoad
            ),
            _ => false,
        }
    }

    /// Its media type, as the contract has it.
    fn media_type(self) -> &'static str {
        match self {
            Self::Table(_, Form::Json) => "application/json",
            Self::Curves
            | Self::Table(_, Form::Csv)
            | Self::LookUp(look_up::Form::Csv)
            | Self::Forces(force_table::Form::Csv)
            | Self::CampbellTable => "text/csv",
            Self::Picture(_) | Self::HolePhase | Self::CampbellDiagram => "image/svg+xml",
            Self::LookUp(look_up::Form::Text)
            | Self::Forces(force_table::Form::Text | force_table::Form::Modelica) => "text/plain",
            Self::Fmu => "application/octet-stream",
        }
    }
}

/// The tables and pictures.
pub(super) fn files() -> Vec<ListedFile> {
    let of = |(name, file): &(&'static str, File)| ListedFile {
        name,
        media_type: file.media_type(),
        schema: matches!(file, File::Table(_, Form::Json)).then_some("CurveTable"),
        about: None,
        without: match file.is_over_positions() {
            true => &[],
            false => &["between"],
        },
    };
    FILES.iter().map(of).collect()
}

fn find_file(file: &str) -> Result<File, Problem> {
    let found = FILES.iter().find(|(name, _)| *name == file);
    found.map(|(_, file)| *file).ok_or_else(|| {
        let names = FILES.map(|(name, _)| name).join(", ");
        let detail = format!("The tables and pictures are {names}.");
        Problem::new(Code::NotFound, detail)
    })
}

/// The curves of the results, or the one of a torque.
fn curves_of(results: &Results, torque: Option<f64>) -> Result<Vec<&CurveDocument>, Problem> {
    // A torque is one of those in the submission; the tolerance is for how it was written.
    let is_meant = |curve: &&CurveDocument| {
        let of = curve.output_torque_n_m;
        torque.is_none_or(|torque| (of - torque).abs() <= 1e-9 * of.abs())
    };
    let meant: Vec<_> = results.curves.iter().filter(is_meant).collect();
    if let (Some(torque), true) = (torque, meant.is_empty()) {
        let known = results.curves.iter().map(|curve| curve.output_torque_n_m);
        let known: Vec<String> = known.map(|torque| torque.to_string()).collect();
        let detail = format!(
            "There is no curve for {torque} N m; there are {} N m.",
            known.join(", ")
        );
        return Err(Problem::new(Code::NotFound, detail));
    }
    Ok(meant)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::super::curve_columns::CurveColumns;
    use super::*;
    use crate::testing::RESULTS;

    fn results() -> Results {
        Results::read(RESULTS).expect("a results document")
    }

    fn table_of(file: &str, torque: Option<f64>) -> Result<Vec<CurveColumns>, Problem> {
        let Ok(File::Table(table, _)) = find_file(file) else {
            panic!("{file} is a table");
        };
        select(table, &curves_of(&results(), torque)?)
    }

    #[test]
    fn a_table_has_one_line_for_each_torque_and_position() {
        let lines = [
            "output_torque_n_m,mesh_position,driving_angle_deg,driven_angle_deg,transmission_error_um",
            "115.0,0.0,0.0,0.0,13.79",
            "115.0,0.5,3.6,3.6,14.0",
            "20.0,0.0,0.0,0.0,5.0",
            "20.0,0.5,3.6,3.6,6.0",
            "",
        ];
        let text = csv(&table_of("ste.csv", None).unwrap());
        assert_eq!(text, lines.join("\r\n"));
    }

    #[test]
    fn a_column_of_one_curve_leaves_its_cells_empty_in_others() {
        let mut results = results();
        results.curves[1].driving_angle_deg.clear();
        let curves: Vec<_> = results.curves.iter().collect();
        let text = csv(&select(Table::TransmissionError, &curves).unwrap());
        assert!(text.ends_with("20.0,0.5,,3.6,6.0\r\n"), "{text}");
        results.curves[0].driving_angle_deg.clear();
        let curves: Vec<_> = results.curves.iter().collect();
        let text = csv(&select(Table::TransmissionError, &curves).unwrap());
        assert!(text.starts_with("output_torque_n_m,mesh_position,driven_angle_deg,"));
    }

    #[test]
    fn a_torque_selects_its_curve_and_an_unknown_one_is_told_which_there_are() {
        let selected = json!(table_of("ste.json", Some(20.0)).unwrap());
        assert_eq!(selected.as_array().map(Vec::len), Some(1));
        assert_eq!(selected[0]["transmission_error_um"], json!([5.0, 6.0]));
        let problem = table_of("ste.json", Some(21.0)).err().expect("refused");
        assert!(problem.detail.contains("115, 20 N m"), "{}", problem.detail);
    }

    #[test]
    fn the_spectrum_keeps_its_names_in_json_and_may_be_absent() {
        let selected = table_of("spectrum.json", Some(115.0)).unwrap();
        assert_eq!(json!(selected)[0]["named"][0]["label"], "H_N");
        let text = csv(&selected);
        assert!(
            text.starts_with(
                "output_torque_n_m,order,transmission_error_um,transmission_error_phase_deg,"
            ),
            "{text}"
        );
        assert!(text.contains("\r\n115.0,10.0,0.1,"), "{text}");
        assert!(table_of("spectrum.csv", Some(20.0)).is_err());
        for unknown in ["ste", "x.csv", "x.svg", "load-share.csv"] {
            assert!(find_file(unknown).is_err(), "{unknown}");
        }
    }

    #[test]
    fn the_load_along_a_face_is_told_strip_by_strip_and_position_by_position_where_it_is_known() {
        let mut results = results();
        assert!(table_of("face-load.csv", None).is_err());
        let of_face = |rows: Value| {
            serde_json::from_value(
                json!({ "z_mm": [-5.0, 5.0], "load_n_per_mm": rows, "face_load_factor": 1.25,
                                           "load_centroid_mm": [0.5, 0.5] }),
            )
        };
        let table = |results: &Results| {
            let curves: Vec<_> = results.curves.iter().collect();
            csv(&select(Table::FaceLoad, &curves).unwrap())
        };
        results.curves[0].face = Some(of_face(json!([[60.0, 100.0]])).unwrap());
        let mean = [
            "output_torque_n_m,z_mm,load_n_per_mm",
            "115.0,-5.0,60.0",
            "115.0,5.0,100.0",
            "",
        ];
        assert_eq!(table(&results), mean.join("\r\n"));
        results.curves[0].face = Some(of_face(json!([[60.0, 100.0], [70.0, 90.0]])).unwrap());
        let each = [
            "output_torque_n_m,mesh_position,z_mm,load_n_per_mm",
            "115.0,0.0,-5.0,60.0",
            "115.0,0.0,5.0,100.0",
            "115.0,0.5,-5.0,70.0",
            "115.0,0.5,5.0,90.0",
            "",
        ];
        assert_eq!(table(&results), each.join("\r\n"));
    }

    #[test]
    fn the_branches_of_a_run_up_stand_one_after_the_other() {
        let mut results = results();
        assert!(table_of("run-up.csv", None).is_err());
        let branch = |load_factor: f64| {
            json!({ "dynamic_transmission_error_um": { "rms": [1.0, 2.0], "peak_to_peak": [3.0, 4.0] },
                    "dynamic_load_factor": [1.0, load_factor], "contact_lost": [false, true], "period_multiple": [1, 0],
                    "orders": [] })
        };
        let dynamics = json!({ "natural_frequency_hz": 1.0, "equivalent_mass_kg": 1.0, "driving_speed_rpm": [100.0, 200.0],
                               "up": branch(1.5), "down": branch(2.5), "resonances": [] });
        results.curves[0].dynamics = Some(serde_json::from_value(dynamics).unwrap());
        let curves: Vec<_> = results.curves.iter().collect();
        let text = csv(&select(Table::RunUp, &curves).unwrap());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "of the one curve that has it");
        assert_eq!(lines[2], "115.0,200.0,up,2.0,4.0,1.5,true,0");
        assert_eq!(lines[4], "115.0,200.0,down,2.0,4.0,2.5,true,0");
    }
}
