//! The shape of a natural mode on the grid of its gear, for those who look at it in space.

use std::io;

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use flate2::Compression;
use flate2::write::GzEncoder;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_engine::vibration::{ModeShape, ShapeSize};
use meshwright_exchange::vtu;
use meshwright_wire::solve::{check_mode_number, mode_shape, mode_shape_estimate};
use meshwright_wire::warning::GearName;
use meshwright_wire::{Code, Problem, Submission};
use serde::Deserialize;
use utoipa::IntoParams;

use super::client::Client;
use super::fields::{Cells, Cost, Done, File, NoLook};
use super::parameters::{IfNoneMatch, JobId, Parameters};
use super::problem::{Refusal, internal};

/// Bytes of the packed file for each node and for each element, at most.
const PACKED: [u64; 2] = [30, 60];

/// Which gear.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct ShapeParameters {
    /// The gear whose mode it is; without it, the driving one.
    #[param(inline)]
    gear: Option<GearName>,
}

/// Get the shape of a natural mode
///
/// A VTK unstructured grid of blank and teeth of one gear, in mm: its axis is the z axis, the middle of its face z = 0, tooth 0 at the x axis. Teeth of a
/// helix stand straight. At points `displacement_um`, and `displacement_sine_um` of a double mode, which turns as the first times cos(wt) plus the second
/// times sin(wt) or against it. The largest displacement of either is 1 um. In the field data `frequency_hz`, and `modal_mass_kg`, the modal mass of the
/// first for displacements over the largest. It is computed anew, bounded, and answered later (202) as `fields.vtu` is.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/modes/{n}", tag = "Results", operation_id = "get_mode_shape",
    params(
        ("n" = u32, Path, minimum = 1, example = 1, description = "The number of the mode in the list of its gear in the results, from 1."),
        ShapeParameters,
        IfNoneMatch,
    ),
    responses(
        (status = 200, description = "The grid.", body = String, content_type = "text/xml", headers(
            ("Solver-Version" = String, description = "The version of the solver that has computed this grid."),
            ("Results-Solver-Version" = Option<String>, description = "The version that computed the job's results, where it is another one."),
        )),
        NoLook,
    ),
)]
pub(super) async fn vtu(
    client: Client,
    Path((id, file)): Path<(String, String)>,
    Parameters(ShapeParameters { gear }): Parameters<ShapeParameters>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let number = number_of(&file)?;
    let JobId(id) = JobId::of(&id)?;
    let gear = gear.unwrap_or(GearName::Driving);
    let done = Done::find(&client, id).await?;
    check_mode_number(&done.submission, gear, number)?;
    let cost = move |submission: &Submission| cost(submission, gear);
    let work = move |submission: &Submission, _: &Library, run: &Run| {
        let shape = mode_shape(submission, (gear, number), run)?;
        packed(&shape).map_err(|error| {
            tracing::error!(%error, "a mode could not be written");
            internal()
        })
    };
    let form = format!("{}/{number}", gear.word());
    let file = File::grids("mode.vtu", "text/xml", Cells::Quadratic);
    done.look(&client, (file, &form), &request, cost, work)
        .await
}

/// The number in the name of a file.
fn number_of(file: &str) -> Result<u32, Problem> {
    let number = file.strip_suffix(".vtu").and_then(|n| n.parse().ok());
    number.ok_or_else(|| {
        let detail = format!("There is no file {file:?} of modes; mode 1 is in 1.vtu.");
        Problem::new(Code::NotFound, detail)
    })
}

/// Cost of the shape of a mode of `gear`.
fn cost(submission: &Submission, gear: GearName) -> Result<Cost, Problem> {
    let (estimate, size) = mode_shape_estimate(submission, gear)?;
    let sent = packed_bytes(size);
    Ok(Cost {
        memory: estimate.memory + sent,
        seconds: estimate.seconds,
        sent,
    })
}

/// Bytes of the packed file, at most, of a mode with a sine.
fn packed_bytes(ShapeSize { nodes, elements }: ShapeSize) -> u64 {
    let [a_node, an_element] = PACKED;
    a_node * nodes as u64 + an_element * elements as u64
}

/// The file of a shape, packed as it is written.
fn packed(shape: &ModeShape) -> io::Result<Vec<u8>> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    vtu::write_mode(shape, &mut packed)?;
    packed.finish()
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::GzDecoder;
    use meshwright_wire::examples;
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn the_file_of_a_mode_takes_no_more_than_is_said_and_has_the_numbers_of_its_field() {
        let example = examples().iter().find(|of| of.name == "test-case-2");
        let mut document: Value = serde_json::from_str(example.expect("ships").json).expect("JSON");
        document["modes"] = json!({ "count": 2 });
        let submission = Submission::parse(document.to_string().as_bytes()).expect("valid");
        let run = Run::unattended();
        for (gear, number) in [(GearName::Driving, 1), (GearName::Driven, 2)] {
            let shape = mode_shape(&submission, (gear, number), &run).expect("computed");
            let (_, size) = mode_shape_estimate(&submission, gear).expect("estimated");
            let packed = packed(&shape).expect("packed");
            let said = packed_bytes(size);
            println!("{} bytes packed; {said} said; {size:?}", packed.len());
            assert!(packed.len() as u64 <= said);
            let mut text = String::new();
            let mut unpacked = GzDecoder::new(packed.as_slice());
            unpacked.read_to_string(&mut text).expect("a text");
            for name in ["displacement_um", "frequency_hz", "modal_mass_kg"] {
                assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
            }
            let has_sine = text.contains("displacement_sine_um");
            assert_eq!(has_sine, shape.mode.is_double);
        }
        let beyond = mode_shape(&submission, (GearName::Driving, 3), &run);
        assert_eq!(
            beyond.err().map(|problem| problem.code),
            Some(Code::NotFound)
        );
    }
}
