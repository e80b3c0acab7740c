//! Parts of the results as tables, JSON or CSV, for those who want a curve and not the whole document.

use axum::Json;
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use utoipa::{IntoParams, ToSchema};

use super::app::App;
use super::aside::aside;
use super::client::Client;
use super::conditional::{Keep, Tag};
use super::parameters::{Parameters, job_id};
use super::problem::of_missing_results;
use crate::jobs::{Document, JobError};
use crate::wire::csv::CsvWriter;
use crate::wire::results::NamedOrderDocument;
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

const TABLES: [Table; 3] = [
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
];

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

/// Get one table of the results
///
/// The transmission error, the mesh stiffness or the spectrum alone, as JSON or CSV. The first column is the output
/// torque. A column that the results do not have is left out.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/{table}", tag = "Results", operation_id = "get_table",
    params(
        ("id" = String, Path, format = "uuid", description = "The id of the job."),
        ("table" = String, Path, description = "`ste`, `mesh-stiffness` or `spectrum`, with `.json` or `.csv`."),
        TableParameters,
        ("If-None-Match" = Option<String>, Header, description = "The `ETag` of an earlier answer."),
    ),
    responses(
        (status = 200, description = "The table.", content(
            (CurveTable = "application/json"),
            (String = "text/csv"),
        ), headers(("ETag" = String, description = "Stands for this table."))),
        (status = 304, description = "The client has this table."),
        (status = 400, description = "A parameter is not understood.", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "There is no such job, table or torque, or the job has not ended.", body = Problem, content_type = "application/problem+json"),
        (status = 409, description = "The job failed or was cancelled, and has no results.", body = Problem, content_type = "application/problem+json"),
    ),
)]
pub(super) async fn table(
    State(app): State<App>,
    client: Client,
    Path((id, file)): Path<(String, String)>,
    Parameters(TableParameters { torque }): Parameters<TableParameters>,
    request: HeaderMap,
) -> Result<Response, Problem> {
    let (table, form) = find_table(&file)?;
    let job = app.jobs.find(client.name(), job_id(&id)?).await?;
    let Some(hash) = &job.document else {
        return Err(of_missing_results(job.status, job.problem.as_ref()));
    };
    let part = torque.map_or_else(|| format!("/{file}"), |torque| format!("/{file}/{torque}"));
    let made = async {
        let document = app.jobs.document(&job).await?;
        let name = format!("{id}-{file}");
        aside(move |_| make(&document, table, form, torque, &name)).await?
    };
    Tag::of_hash(hash, &part)
        .answer(Keep::ForGood, &request, made)
        .await
}

/// The table of a results document.
fn make(
    document: &Document,
    table: &'static Table,
    form: Form,
    torque: Option<f64>,
    name: &str,
) -> Result<Response, Problem> {
    let text = document.text().map_err(JobError::from)?;
    let results: Value = serde_json::from_str(&text).map_err(|_| no_table(table))?;
    let curves = select(table, &results, torque)?;
    Ok(match form {
        Form::Json => Json(json!({ "curves": curves })).into_response(),
        Form::Csv => {
            let file = format!("attachment; filename=\"{name}\"");
            let headers = [
                (CONTENT_TYPE, "text/csv; charset=utf-8"),
                (CONTENT_DISPOSITION, file.as_str()),
            ];
            (headers, csv(table, &curves)).into_response()
        }
    })
}

#[derive(Clone, Copy)]
enum Form {
    Json,
    Csv,
}

fn find_table(file: &str) -> Result<(&'static Table, Form), Problem> {
    let found = file.split_once('.').and_then(|(name, extension)| {
        let form = match extension {
            "json" => Form::Json,
            "csv" => Form::Csv,
            _ => return None,
        };
        Some((TABLES.iter().find(|table| table.name == name)?, form))
    });
    found.ok_or_else(|| {
        Problem::new(
            Code::NotFound,
            "The tables are ste, mesh-stiffness and spectrum, each as .json or .csv.",
        )
    })
}

/// The chosen columns of the chosen curves.
fn select(
    table: &Table,
    results: &Value,
    torque: Option<f64>,
) -> Result<Vec<Map<String, Value>>, Problem> {
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

    let selected: Vec<_> = meant
        .into_iter()
        .filter_map(|curve| select_columns(table, curve))
        .collect();
    if selected.is_empty() {
        Err(no_table(table))
    } else {
        Ok(selected)
    }
}

fn select_columns(table: &Table, curve: &Value) -> Option<Map<String, Value>> {
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

fn no_table(table: &Table) -> Problem {
    let detail = match table.name {
        "spectrum" => "These results have no spectrum: they span no whole number of true periods.",
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

    #[test]
    fn a_table_has_one_line_for_each_torque_and_position() {
        let (table, _) = find_table("ste.csv").unwrap();
        let text = csv(table, &select(table, &results(), None).unwrap());
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
        let (table, _) = find_table("ste.json").unwrap();
        let selected = select(table, &results(), Some(20.0)).unwrap();
        assert_eq!(selected.len(), 1);
        assert_eq!(selected[0]["transmission_error_um"], json!([5.0, 6.0]));
        let problem = select(table, &results(), Some(21.0)).unwrap_err();
        assert!(problem.detail.contains("115, 20 N m"), "{}", problem.detail);
    }

    #[test]
    fn the_spectrum_keeps_its_names_in_json_and_may_be_absent() {
        let (table, _) = find_table("spectrum.json").unwrap();
        let selected = select(table, &results(), Some(115.0)).unwrap();
        assert_eq!(selected[0]["named"], json!([{ "label": "H_N" }]));
        assert_eq!(
            csv(table, &selected),
            "output_torque_n_m,order,transmission_error_um\r\n115.0,10,0.001\r\n115.0,50,0.4\r\n"
        );
        assert!(select(table, &results(), Some(20.0)).is_err());
        assert!(
            find_table("ste.svg").is_err()
                && find_table("ste").is_err()
                && find_table("x.csv").is_err()
        );
    }
}
