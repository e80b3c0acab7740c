//! Parts of the results as tables or pictures, for those who want a curve and not the whole document.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE, HeaderName};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use utoipa::{IntoParams, ToSchema};

use super::app::App;
use super::aside::aside;
use super::client::Client;
use super::conditional::{Keep, Tag};
use super::parameters::{Parameters, job_id};
use super::pictures::{self, Picture};
use super::problem::{internal, of_missing_results};
use crate::exchange::fmu::fmu;
use crate::exchange::force_table::{self, MeshForces};
use crate::exchange::look_up;
use crate::jobs::{Document, JobError};
use crate::wire::csv::CsvWriter;
use crate::wire::results::{NamedOrderDocument, ResonanceDocument};
use crate::wire::{Code, Problem};

/// What a table shows: where in a curve its columns stand, and which they are.
struct Table {
    name: &'static str,
    /// The member of the curve that holds the columns; empty for the curve itself.
    within: &'static str,
    columns: &'static [&'static str],
    /// What is shown beside the columns in JSON, where a table cannot hold it.
    beside: &'static [&'static str],
}

const POSITION: [&str; 3] = ["mesh_position", "driving_angle_deg", "driven_angle_deg"];

const TABLES: [Table; 4] = [
    Table {
        name: "ste",
        within: "",
        columns: &[
            POSITION[0],
            POSITION[1],
            POSITION[2],
            "transmission_error_um",
        ],
        beside: &[],
    },
    Table {
        name: "mesh-stiffness",
        within: "",
        columns: &[
            POSITION[0],
            POSITION[1],
            POSITION[2],
            "mesh_stiffness_tangent_n_per_m",
            "mesh_stiffness_secant_n_per_m",
        ],
        beside: &[],
    },
    Table {
        name: "spectrum",
        within: "spectrum",
        columns: &[
            "order",
            "frequency_hz",
            "transmission_error_um",
            "transmission_error_phase_deg",
            "mesh_stiffness_tangent_n_per_m",
            "mesh_stiffness_tangent_phase_deg",
        ],
        beside: &["named"],
    },
    Table {
        name: RUN_UP,
        within: "dynamics",
        columns: &[
            "driving_speed_rpm",
            "branch",
            "rms_um",
            "peak_to_peak_um",
            "dynamic_load_factor",
            "contact_lost",
            "period_multiple",
        ],
        beside: &["resonances"],
    },
];

const RUN_UP: &str = "run-up";

/// A table of the results as JSON: for each curve its torque, and the columns of the table, which have one value for each
/// position or order. A column that the results do not have is absent.
#[derive(ToSchema)]
#[schema(title = "CurveTable")]
#[expect(dead_code, reason = "it stands for the table in the OpenAPI document")]
pub(super) struct CurveTable {
    /// One entry for each output torque.
    curves: Vec<CurveColumns>,
}

/// The columns of one curve.
#[derive(ToSchema)]
#[schema(title = "CurveColumns")]
#[expect(dead_code, reason = "it stands for the table in the OpenAPI document")]
struct CurveColumns {
    /// The output torque, in N m.
    output_torque_n_m: f64,
    /// The position in mesh periods.
    mesh_position: Option<Vec<f64>>,
    /// The angle of the driving gear, in degrees.
    driving_angle_deg: Option<Vec<f64>>,
    /// The angle of the driven gear, in degrees.
    driven_angle_deg: Option<Vec<f64>>,
    /// The transmission error, in um; in the spectrum its amplitude.
    transmission_error_um: Option<Vec<f64>>,
    /// The tangent mesh stiffness, in N/m; in the spectrum its amplitude.
    mesh_stiffness_tangent_n_per_m: Option<Vec<f64>>,
    /// The secant mesh stiffness, in N/m.
    mesh_stiffness_secant_n_per_m: Option<Vec<f64>>,
    /// The order, for each revolution of the driven gear.
    order: Option<Vec<f64>>,
    /// The frequency of the order, in Hz.
    frequency_hz: Option<Vec<f64>>,
    /// The phase of the transmission error, in degrees.
    transmission_error_phase_deg: Option<Vec<f64>>,
    /// The phase of the tangent mesh stiffness, in degrees.
    mesh_stiffness_tangent_phase_deg: Option<Vec<f64>>,
    /// The orders that have names.
    named: Option<Vec<NamedOrderDocument>>,
    /// The speed of the driving gear, in 1/min: of the branch that runs up, and again of the one that runs down.
    driving_speed_rpm: Option<Vec<f64>>,
    /// `up` or `down`.
    branch: Option<Vec<String>>,
    /// The root mean square of the dynamic transmission error, in um.
    rms_um: Option<Vec<f64>>,
    /// Its largest less its smallest value, in um.
    peak_to_peak_um: Option<Vec<f64>>,
    /// The largest force between the gears over the static load.
    dynamic_load_factor: Option<Vec<f64>>,
    /// Whether the loaded flanks part.
    contact_lost: Option<Vec<bool>>,
    /// True periods after which the motion repeats; 0 where it was not found to.
    period_multiple: Option<Vec<u32>>,
    /// The speeds at which orders resonate.
    resonances: Option<Vec<ResonanceDocument>>,
}

/// Which curve.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct TableParameters {
    /// The output torque of the curve, in N m; without it, all curves.
    #[param(example = 115.0)]
    torque: Option<f64>,
}

/// Get one table or picture of the results
///
/// The transmission error, the mesh stiffness or the spectrum alone, as JSON, as CSV or as a picture; the load shares as a
/// picture. The first column of a CSV is the output torque. A column that the results do not have is left out.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/{table}", tag = "Results", operation_id = "get_table",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the job."),
        ("table" = String, Path, description = "`ste`, `mesh-stiffness`, `spectrum` or `run-up`, with `.json`, `.csv` or `.svg`; or `load-share.svg`; or `force-table.csv`, `force-table.txt` (CombiTable2D), `force-table.mo` (a Modelica package), `force-table.fmu` (FMU 2.0, `application/octet-stream`); or `look-up-table.csv`, `look-up-table.txt`, which have one curve over the angle in SI units, datum and signs in their head."),
        TableParameters,
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The table.", content(
            (CurveTable = "application/json"),
            (String = "text/csv"),
            (String = "image/svg+xml"),
            (String = "text/plain"),
        ), headers(("ETag" = String, description = "Stands for this table."))),
        (status = 304, description = "The client has this table."),
        (status = 400, description = "A parameter is not understood.", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "There is no such job, table or torque, or the job has not ended.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The job failed or was cancelled, and has no results.", body = Problem, content_type = "application/problem+json"),
        (status = 410, description = "The study of the job keeps statistics only (`results_not_kept`); submitted alone, the design has results.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn table(
    State(app): State<App>,
    client: Client,
    Path((id, file)): Path<(String, String)>,
    Parameters(TableParameters { torque }): Parameters<TableParameters>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let wanted = find_file(&file)?;
    let job = app.jobs.find(client.name(), job_id(&id)?).await?;
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()));
    };
    let part = torque.map_or_else(|| format!("/{file}"), |torque| format!("/{file}/{torque}"));
    let made = async {
        let document = app.jobs.document(&job).await?;
        let name = format!("{id}-{file}");
        aside(client.name(), move |_| {
            make(&document, wanted, torque, &name)
        })
        .await?
    };
    Tag::of_hash(hash, &part)
        .answer(Keep::ForGood, &request, made)
        .await
}

/// The table or picture of a results document.
fn make(
    document: &Document,
    wanted: File,
    torque: Option<f64>,
    name: &str,
) -> Result<Response, Problem> {
    let text = document.text().map_err(JobError::from)?;
    let results: Value = serde_json::from_str(&text).map_err(|_| nothing_to_show())?;
    let curves = curves_of(&results, torque)?;
    let (table, form) = match wanted {
        File::Table(table, form) => (table, form),
        File::Picture(picture) => {
            let svg = picture
                .draw(&curves)
                .unwrap_or_else(|| Err(nothing_to_show()));
            return svg.map(pictures::answer);
        }
        File::LookUp(form) => return look_up_table(&results, &curves, form, name),
        File::Forces(form) => return forces(&results, form, name),
        File::Fmu => return packed(&results, name),
    };
    let curves = select(table, &curves)?;
    Ok(match form {
        Form::Json => Json(json!({ "curves": curves })).into_response(),
        Form::Csv => {
            let headers = file_headers("text/csv; charset=utf-8", name);
            (headers, csv(table, &curves)).into_response()
        }
    })
}

/// The first of the curves as a look-up table.
fn look_up_table(
    results: &Value,
    curves: &[&Value],
    form: look_up::Form,
    name: &str,
) -> Result<Response, Problem> {
    let curve = curves.first().ok_or_else(nothing_to_show)?;
    let table = look_up::table(results, curve, form).ok_or_else(|| {
        let detail = "These results span no whole number of true periods, and a look-up table is read over and over.";
        Problem::new(Code::NotFound, detail)
    })?;
    let media_type = match form {
        look_up::Form::Csv => "text/csv; charset=utf-8",
        look_up::Form::Text => "text/plain; charset=utf-8",
    };
    Ok((file_headers(media_type, name), table).into_response())
}

fn no_forces() -> Problem {
    let detail = "These results have no force table: the submission asks for none.";
    Problem::new(Code::NotFound, detail)
}

/// The force table as an FMU. What it was computed from tells it from others.
fn packed(results: &Value, name: &str) -> Result<Response, Problem> {
    let forces = MeshForces::of(results).ok_or_else(no_forces)?;
    let hash = results.pointer("/evidence/input_hash");
    let guid = hash.and_then(Value::as_str).unwrap_or_default();
    let bytes = fmu(&forces, guid).map_err(|error| {
        tracing::error!(%error, "an FMU could not be packed");
        internal()
    })?;
    Ok((file_headers("application/octet-stream", name), bytes).into_response())
}

/// The force table as others read it.
fn forces(results: &Value, form: force_table::Form, name: &str) -> Result<Response, Problem> {
    let forces = MeshForces::of(results).ok_or_else(no_forces)?;
    let media_type = match form {
        force_table::Form::Csv => "text/csv; charset=utf-8",
        force_table::Form::Text | force_table::Form::Modelica => "text/plain; charset=utf-8",
    };
    Ok((file_headers(media_type, name), forces.write(form)).into_response())
}

fn file_headers(media_type: &str, name: &str) -> [(HeaderName, String); 2] {
    [
        (CONTENT_TYPE, media_type.to_owned()),
        (
            CONTENT_DISPOSITION,
            format!("attachment; filename=\"{name}\""),
        ),
    ]
}

#[derive(Clone, Copy)]
enum Form {
    Json,
    Csv,
}

/// What a file name asks for.
enum File {
    Table(&'static Table, Form),
    Picture(Picture),
    LookUp(look_up::Form),
    Forces(force_table::Form),
    Fmu,
}

fn find_file(file: &str) -> Result<File, Problem> {
    match file {
        "look-up-table.csv" => return Ok(File::LookUp(look_up::Form::Csv)),
        "look-up-table.txt" => return Ok(File::LookUp(look_up::Form::Text)),
        "force-table.csv" => return Ok(File::Forces(force_table::Form::Csv)),
        "force-table.txt" => return Ok(File::Forces(force_table::Form::Text)),
        "force-table.fmu" => return Ok(File::Fmu),
        "force-table.mo" => return Ok(File::Forces(force_table::Form::Modelica)),
        _ => {}
    }
    if let Some(picture) = Picture::named(file) {
        return Ok(File::Picture(picture));
    }
    let found = file.split_once('.').and_then(|(name, extension)| {
        let form = match extension {
            "json" => Form::Json,
            "csv" => Form::Csv,
            _ => return None,
        };
        let table = TABLES.iter().find(|table| table.name == name)?;
        Some(File::Table(table, form))
    });
    found.ok_or_else(|| {
        Problem::new(
            Code::NotFound,
            "The tables are ste, mesh-stiffness, spectrum and run-up, each as .json or .csv; the pictures are those and load-share, as .svg; there are look-up-table.csv, look-up-table.txt, force-table.csv, force-table.txt, force-table.mo and force-table.fmu.",
        )
    })
}

/// The curves of the results, or the one of a torque.
fn curves_of(results: &Value, torque: Option<f64>) -> Result<Vec<&Value>, Problem> {
    let curves = results
        .get("curves")
        .and_then(Value::as_array)
        .map_or(&[][..], Vec::as_slice);
    let torque_of = |curve: &Value| curve.get("output_torque_n_m").and_then(Value::as_f64);
    // A torque is one of those in the submission; the tolerance is for how it was written.
    let is_meant = |curve: &&Value| {
        torque.is_none_or(|torque| {
            torque_of(curve).is_some_and(|of| (of - torque).abs() <= 1e-9 * of.abs())
        })
    };
    let meant: Vec<&Value> = curves.iter().filter(is_meant).collect();
    if let (Some(torque), true) = (torque, meant.is_empty()) {
        let known: Vec<String> = curves
            .iter()
            .filter_map(torque_of)
            .map(|torque| torque.to_string())
            .collect();
        let detail = format!(
            "There is no curve for {torque} N m; there are {} N m.",
            known.join(", ")
        );
        return Err(Problem::new(Code::NotFound, detail));
    }
    Ok(meant)
}

/// The chosen columns of the chosen curves.
fn select(table: &Table, curves: &[&Value]) -> Result<Vec<Map<String, Value>>, Problem> {
    let selected: Vec<_> = curves
        .iter()
        .filter_map(|curve| select_columns(table, curve))
        .collect();
    if selected.is_empty() {
        Err(no_table(table))
    } else {
        Ok(selected)
    }
}

fn select_columns(table: &Table, curve: &Value) -> Option<Map<String, Value>> {
    let one_after_the_other = (table.name == RUN_UP).then(|| branches(curve)).flatten();
    let curve = one_after_the_other.as_ref().unwrap_or(curve);
    let holder = if table.within.is_empty() {
        curve
    } else {
        curve.get(table.within)?
    };
    let mut selected = Map::new();
    selected.insert(
        "output_torque_n_m".to_owned(),
        curve.get("output_torque_n_m")?.clone(),
    );
    for name in table.columns.iter().chain(table.beside) {
        if let Some(values @ Value::Array(_)) = holder.get(*name) {
            selected.insert((*name).to_owned(), values.clone());
        }
    }
    Some(selected).filter(|selected| selected.len() > 1)
}

/// A curve whose dynamics are columns: the branches one after the other, up first.
fn branches(curve: &Value) -> Option<Value> {
    let dynamics = curve.get("dynamics")?;
    let speeds = dynamics.get("driving_speed_rpm")?.as_array()?;
    let mut columns: Map<String, Value> = Map::new();
    let mut add = |name: String, values: &[Value]| {
        let column = columns.entry(name).or_insert_with(|| json!([]));
        if let Value::Array(column) = column {
            column.extend_from_slice(values);
        }
    };
    for branch in ["up", "down"] {
        let Some(of_branch) = dynamics.get(branch) else {
            continue;
        };
        add("driving_speed_rpm".to_owned(), speeds);
        add("branch".to_owned(), &vec![json!(branch); speeds.len()]);
        let error = of_branch.get("dynamic_transmission_error_um")?;
        for name in ["rms", "peak_to_peak"] {
            add(format!("{name}_um"), error.get(name)?.as_array()?);
        }
        for name in ["dynamic_load_factor", "contact_lost", "period_multiple"] {
            add(name.to_owned(), of_branch.get(name)?.as_array()?);
        }
    }
    columns.insert("resonances".to_owned(), dynamics.get("resonances")?.clone());
    Some(json!({ "output_torque_n_m": curve.get("output_torque_n_m")?, "dynamics": columns }))
}

/// One line for each torque and position or order. Numbers are written as they stand in the results.
fn csv(table: &Table, curves: &[Map<String, Value>]) -> String {
    let present = |name: &&&str| curves.iter().any(|curve| curve.contains_key(**name));
    let columns: Vec<&str> = table.columns.iter().filter(present).copied().collect();
    let mut text = CsvWriter::new();
    text.text("output_torque_n_m");
    for name in &columns {
        text.text(name);
    }
    text.end_line();
    for curve in curves {
        let column = |name: &&str| {
            curve
                .get(*name)
                .and_then(Value::as_array)
                .map_or(&[][..], Vec::as_slice)
        };
        let cells: Vec<&[Value]> = columns.iter().map(column).collect();
        for row in 0..cells.iter().map(|cells| cells.len()).max().unwrap_or(0) {
            text.value(curve.get("output_torque_n_m"));
            for column in &cells {
                text.value(column.get(row));
            }
            text.end_line();
        }
    }
    text.into_text()
}

fn nothing_to_show() -> Problem {
    Problem::new(
        Code::NotFound,
        "These results have nothing that this shows.",
    )
}

fn no_table(table: &Table) -> Problem {
    let detail = match table.name {
        "spectrum" => "These results have no spectrum: they span no whole number of true periods.",
        RUN_UP => "These results have no run-up: the submission asks for no dynamics.",
        _ => "These results have no such table.",
    };
    Problem::new(Code::NotFound, detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn results() -> Value {
        json!({ "curves": [
            { "output_torque_n_m": 115.0, "mesh_position": [0.0, 0.025], "transmission_error_um": [14.1, null],
              "spectrum": { "order": [10, 50], "transmission_error_um": [1e-3, 0.4], "named": [{ "label": "H_N" }] } },
            { "output_torque_n_m": 20.0, "mesh_position": [0.0, 0.025], "transmission_error_um": [5.0, 6.0] },
        ] })
    }

    fn table_of(file: &str) -> &'static Table {
        match find_file(file) {
            Ok(File::Table(table, _)) => table,
            _ => panic!("{file} is a table"),
        }
    }

    #[test]
    fn a_table_has_one_line_for_each_torque_and_position() {
        let table = table_of("ste.csv");
        let results = results();
        let text = csv(
            table,
            &select(table, &curves_of(&results, None).unwrap()).unwrap(),
        );
        let lines = [
            "output_torque_n_m,mesh_position,transmission_error_um",
            "115.0,0.0,14.1",
            "115.0,0.025,",
            "20.0,0.0,5.0",
            "20.0,0.025,6.0",
            "",
        ];
        assert_eq!(text, lines.join("\r\n"));
    }

    #[test]
    fn a_torque_selects_its_curve_and_an_unknown_one_is_told_which_there_are() {
        let (table, results) = (table_of("ste.json"), results());
        let selected = select(table, &curves_of(&results, Some(20.0)).unwrap()).unwrap();
        assert_eq!(selected.len(), 1);
        assert_eq!(selected[0]["transmission_error_um"], json!([5.0, 6.0]));
        let problem = curves_of(&results, Some(21.0)).unwrap_err();
        assert!(problem.detail.contains("115, 20 N m"), "{}", problem.detail);
    }

    #[test]
    fn the_spectrum_keeps_its_names_in_json_and_may_be_absent() {
        let (table, results) = (table_of("spectrum.json"), results());
        let at = |torque| curves_of(&results, Some(torque)).unwrap();
        let selected = select(table, &at(115.0)).unwrap();
        assert_eq!(selected[0]["named"], json!([{ "label": "H_N" }]));
        assert_eq!(
            csv(table, &selected),
            "output_torque_n_m,order,transmission_error_um\r\n115.0,10,0.001\r\n115.0,50,0.4\r\n"
        );
        assert!(select(table, &at(20.0)).is_err());
        for unknown in ["ste", "x.csv", "x.svg", "load-share.csv"] {
            assert!(find_file(unknown).is_err(), "{unknown}");
        }
        assert!(matches!(find_file("ste.svg"), Ok(File::Picture(_))));
    }
}
