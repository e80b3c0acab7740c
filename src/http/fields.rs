//! Displacements and stresses everywhere in both gears at one mesh position, for those who look inside.

use std::io::{self, Read};
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::header::{CACHE_CONTROL, CONTENT_ENCODING, CONTENT_TYPE, HeaderValue, VARY};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use bytes::Buf;
use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use futures_util::stream;
use meshwright_connections::{Keep, takes_gzip};
use meshwright_engine::analysis::{self, Case, Estimate, FaceHoles, Model, SectionHoles};
use meshwright_engine::gear::Member;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_exchange::divided::Divided;
use meshwright_exchange::vtu;
use meshwright_wire::solve::{Inside, inside, section};
use meshwright_wire::{Code, LoadedEdges, Problem, SOLVER_VERSION, Submission, too_much_memory};
use serde::Deserialize;
use utoipa::{IntoParams, IntoResponses, ToSchema};
use uuid::Uuid;

use super::answer::{self, tag_of_parts};
use super::blocking::blocking;
use super::client::Client;
use super::memory::Held;
use super::parameters::{IfNoneMatch, JobId, Parameters, invalid, number};
use super::problem::{Refusal, internal, of_missing_results, sentence};
use crate::compute::{Asker, FileError, Making};
use crate::jobs::{Job, Resource as _};

/// Time limit of a file in multiples of that of a preview, at most [`LONGEST`]: nobody drags these pictures, and volumes of both gears take seconds.
const PREVIEWS_LONG: u32 = 4;
const LONGEST: Duration = Duration::from_secs(60);

/// Time limit in multiples of the job's estimate or of its time, if that is longer: all of its positions are solved again.
const JOBS_LONG: f64 = 4.0;

/// Bytes that volumes of both gears take until they are written, for each tooth, and the largest size of their packed file.
const VOLUME_BYTES: [u64; 2] = [4 << 20, 1 << 20];

/// The same for plates, for each unknown of the estimate. Pairs of 50/50 and of 300/300 teeth took 70 beside the estimate, while both gears are solved, and 23
/// in the file.
const PLATE_BYTES: [u64; 2] = [80, 30];

/// The same of linear cells, in times of the file of the elements themselves: what is held more until they are written, and what the file has at most.
const LINEAR: [u64; 2] = [40, 10];

/// Where to look.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct FieldParameters {
    /// One of the job's output torques, in N m, not 0; without it, the first of them.
    #[param(example = 115.0)]
    #[serde(default, deserialize_with = "number")]
    torque: Option<f64>,
    /// The mesh position in mesh periods, from 0 to the span of the job; without it, 0.
    #[param(example = 0.25, minimum = 0)]
    #[serde(default, deserialize_with = "number")]
    mesh_position: Option<f64>,
}

/// Where to look, and on which cells.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct GridParameters {
    /// One of the job's output torques, in N m, not 0; without it, the first of them.
    #[param(example = 115.0)]
    #[serde(default, deserialize_with = "number")]
    torque: Option<f64>,
    /// The mesh position in mesh periods, from 0 to the span of the job; without it, 0.
    #[param(example = 0.25, minimum = 0)]
    #[serde(default, deserialize_with = "number")]
    mesh_position: Option<f64>,
    /// The cells of the grid: `quadratic`, the elements as they were solved, or `linear`, each element divided so that filters which take a cell as straight between its
    /// corners are within 1 % of it. Without it, `quadratic`.
    #[param(inline)]
    cells: Option<Cells>,
}

/// The cells of a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum Cells {
    #[default]
    Quadratic,
    Linear,
}

/// Get displacements and stresses of both gears at a mesh position
///
/// A VTK unstructured grid that ParaView, PyVista and meshio read: at points `displacement_um` of each gear against its hub, `stress_mpa`
/// and `von_mises_mpa`, in cells `gear` (0 driving, 1 driven); points in mm, the driving axis at the origin, the driven one on the x axis. Of a plane
/// method plates with `thickness_mm`, by the flexible method; of `three_dimensional` and its projection volumes, by `three_dimensional`, with z from
/// the middle of the common face. It is computed anew from the submission. Where that takes longer than 10 s, the answer is 202:
/// the file is made meanwhile, and comes at the same address after `Retry-After` seconds. It is kept for five minutes. It may take four times as long as a preview,
/// or as the job: by its estimate, or as it was.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/fields.vtu", tag = "Results", operation_id = "get_fields",
    params(GridParameters, IfNoneMatch),
    responses(
        (status = 200, description = "The grid.", body = String, content_type = "text/xml", headers(
            ("Solver-Version" = String, description = "The version of the solver that has computed this grid."),
            ("Results-Solver-Version" = Option<String>, description = "The version that computed the job's results, where it is another one: its curves may differ a little from what is seen here."),
        )),
        NoLook,
    ),
)]
pub(super) async fn vtu(
    client: Client,
    Parameters(asked): Parameters<GridParameters>,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let GridParameters {
        torque,
        mesh_position,
        cells,
    } = asked;
    let place = FieldParameters {
        torque,
        mesh_position,
    };
    let cells = cells.unwrap_or_default();
    let work = move |submission: &Submission, place, library: &Library, run: &Run| {
        packed_grids(&inside(submission, place, library, run)?, cells).map_err(|error| {
            tracing::error!(%error, "a field could not be written");
            internal()
        })
    };
    let file = File::grids("fields.vtu", "text/xml", cells);
    answer(&client, id, &place, &request, file, work).await
}

/// Get the edges of both gears under load at a mesh position
///
/// The part of `fields.vtu` that a drawing of the deformed pair needs: the boundaries of the gears, the displacement of each node there against the hub of its
/// gear, and its von Mises stress; and the transmission error, by which the driven gear is to be turned back for the flanks to touch. For pairs along their
/// faces it is a section through the middle of the common face; of a part that ends before it, its end. It is computed by the method of `fields.vtu`, with its time
/// limit, and comes later (202) as that does.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/edges.json", tag = "Results", operation_id = "get_edges",
    params(FieldParameters, IfNoneMatch),
    responses(
        (status = 200, description = "The edges.", body = LoadedEdges, headers(
            ("Solver-Version" = String, description = "The version of the solver that has computed these edges."),
            ("Results-Solver-Version" = Option<String>, description = "The version that computed the job's results, where it is another one: its curves may differ a little from what is seen here."),
        )),
        NoLook,
    ),
)]
pub(super) async fn edges(
    client: Client,
    Parameters(place): Parameters<FieldParameters>,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let work = |submission: &Submission, place: (f64, f64), library: &Library, run: &Run| {
        let found = section(submission, place, library, run)?;
        let edges = LoadedEdges::of(&found, place.0, place.1);
        let text = edges.to_json().map_err(|_| internal())?;
        Ok(text.into_bytes())
    };
    let file = File::shown("edges.json", "application/json");
    answer(&client, id, &place, &request, file, work).await
}

/// Why a job that is computed once more shows nothing now.
#[derive(IntoResponses)]
#[expect(dead_code, reason = "the document alone reads it")]
pub(super) enum NoLook {
    #[response(
        status = 202,
        description = "The file is not made yet. It is computed meanwhile; ask again at the same address.",
        headers(("Retry-After" = u32, description = "Seconds after which to ask again."))
    )]
    Later,
    #[response(
        status = 400,
        description = "A parameter is not understood, or outside the span."
    )]
    Parameters,
    #[response(
        status = 404,
        description = "There is no such job, torque or mesh position, the job has not ended, or its method does not see this."
    )]
    Absent,
    #[response(
        status = 409,
        description = "The job failed or was cancelled, and has no results."
    )]
    NoResults,
    #[response(
        status = 422,
        description = "This cannot be computed, or takes too long."
    )]
    Uncomputed,
    #[response(
        status = 503,
        description = "As many files are computed as the service takes at once, or it is shutting down. Try again after `Retry-After` seconds."
    )]
    Busy,
}

/// Name and media type of an answer.
pub(super) struct File {
    pub(super) name: &'static str,
    pub(super) media_type: &'static str,
    /// Its cells, if it has grids. The file is large: it is packed while it is made, and a browser saves it.
    grids: Option<Cells>,
}

impl File {
    /// One that a browser shows.
    pub(super) fn shown(name: &'static str, media_type: &'static str) -> Self {
        Self {
            name,
            media_type,
            grids: None,
        }
    }

    /// Grids.
    pub(super) fn grids(name: &'static str, media_type: &'static str, cells: Cells) -> Self {
        Self {
            grids: Some(cells),
            ..Self::shown(name, media_type)
        }
    }
}

/// The file that `work` makes of job `id` at `place`, a torque and a mesh position.
async fn answer(
    client: &Client,
    id: Uuid,
    place: &FieldParameters,
    request: &HeaderMap,
    file: File,
    work: impl FnOnce(&Submission, (f64, f64), &Library, &Run) -> Result<Vec<u8>, Problem>
    + Send
    + 'static,
) -> Result<Response, Refusal> {
    let done = Done::find(client, id).await?;
    let (torque, position) = place.within(&done.submission)?;
    let form = match file.grids {
        Some(Cells::Linear) => format!("{torque}/{position}/linear"),
        _ => format!("{torque}/{position}"),
    };
    let look = move |submission: &Submission, library: &Library, run: &Run| {
        work(submission, (torque, position), library, run)
    };
    let grids = file.grids;
    let cost = move |submission: &Submission| Ok(Cost::of_fields(submission, grids));
    done.look(client, (file, &form), request, cost, look).await
}

/// Cost of computing a job once more for a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cost {
    /// Bytes until the file is written.
    pub(super) memory: u64,
    /// Seconds of one core.
    pub(super) seconds: f64,
    /// Bytes of the packed file, at most, if it has grids.
    pub(super) sent: u64,
}

impl Cost {
    /// That of fields of both gears, or of a file made of them.
    pub(super) fn of_fields(submission: &Submission, grids: Option<Cells>) -> Self {
        let case = submission.case();
        // The full method of the plane or of faces solves it, whichever the job had.
        let whole = Case {
            model: match &case.model {
                Model::Faces(faces, _) => Model::Faces(faces.clone(), FaceHoles::Whole),
                Model::Section(_) | Model::Formulas(_) => Model::Section(SectionHoles::Whole),
            },
            ..case.clone()
        };
        #[expect(clippy::disallowed_methods, reason = "called in `blocking`")]
        let Estimate {
            degrees_of_freedom,
            memory,
            seconds,
            ..
        } = analysis::estimate(&whole, None);
        let [made, sent] = field_bytes(case, degrees_of_freedom, grids);
        Self {
            memory: memory + made,
            seconds,
            sent,
        }
    }
}

/// A job with results whose submission is computed again for fields that the results do not hold.
pub(super) struct Done {
    job: Job,
    hash: String,
    input_hash: String,
    pub(super) submission: Submission,
}

impl Done {
    /// That of an id.
    pub(super) async fn find(client: &Client, id: Uuid) -> Result<Self, Problem> {
        let jobs = &client.app.jobs;
        let job = Job::find(jobs, client.name(), id).await?;
        let Some(hash) = job.document.clone() else {
            return Err(of_missing_results(job.status, job.problem.as_ref()));
        };
        let submission = jobs.readable_submission(id).await?;
        let read = move |_: &Run| -> Result<_, Problem> {
            let submission = Submission::parse(submission.as_bytes())?;
            Ok((submission.input_hash(), submission))
        };
        let (input_hash, submission) = blocking(client.name(), read).await??;
        Ok(Self {
            job,
            hash,
            input_hash,
            submission,
        })
    }

    /// The `file` that `work` makes of a job, packed if it has grids, at the cost that `cost` tells; `form` tells it from others of the same name. 202 where it
    /// is not made in time.
    pub(super) async fn look(
        self,
        client: &Client,
        (file, form): (File, &str),
        request: &HeaderMap,
        cost: impl FnOnce(&Submission) -> Result<Cost, Problem> + Send + 'static,
        work: impl FnOnce(&Submission, &Library, &Run) -> Result<Vec<u8>, Problem> + Send + 'static,
    ) -> Result<Response, Refusal> {
        let File {
            name,
            media_type,
            grids,
        } = file;
        let id = self.job.id;
        let version = self.job.solver_version.clone();
        let tag = tag_of_parts(&[&self.hash, name, form, SOLVER_VERSION]);
        let made = async {
            let file = self.made(client, (name, form), cost, work).await;
            let Some(bytes) = file.map_err(IntoResponse::into_response)? else {
                return Err(made_later());
            };
            let held = Held(bytes);
            Ok(match grids {
                Some(_) => {
                    let body = packed_or_plain(held, request);
                    answer::file(media_type, &format!("{id}-{name}"), body)
                }
                None => ([(CONTENT_TYPE, media_type)], held).into_response(),
            })
        };
        // The answer of this version of the solver; another version may answer otherwise at the same address.
        let mut response = match tag.answer(Keep::AskAgain, request, made).await {
            Ok(response) => response,
            // Nobody keeps a refusal, nor that the file comes later.
            Err(response) => return Ok(response),
        };
        let headers = response.headers_mut();
        headers.insert("solver-version", HeaderValue::from_static(SOLVER_VERSION));
        if let Some(version) = version.filter(|version| version != SOLVER_VERSION)
            && let Ok(version) = HeaderValue::try_from(version)
        {
            headers.insert("results-solver-version", version);
        }
        Ok(response)
    }

    /// The bytes of a file; `None` if they come later.
    async fn made(
        self,
        client: &Client,
        (name, form): (&str, &str),
        cost: impl FnOnce(&Submission) -> Result<Cost, Problem> + Send + 'static,
        work: impl FnOnce(&Submission, &Library, &Run) -> Result<Vec<u8>, Problem> + Send + 'static,
    ) -> Result<Option<Bytes>, Refusal> {
        let files = client.app.files.clone();
        let asker = Asker {
            client: client.name().into(),
            job: self.job.id,
        };
        // Jobs of equal submissions share their files.
        let name = format!("{}/{name}/{form}", self.input_hash);
        let asked = match files.find(&asker, &name) {
            Some(asked) => asked,
            None => {
                let making = self.making(client, cost, work).await?;
                files.find_or_make(&asker, &name, making).map_err(of_file)?
            }
        };
        Ok(asked.file().await.map_err(of_file)?)
    }

    /// The computation of a file, if it fits.
    async fn making(
        self,
        client: &Client,
        cost: impl FnOnce(&Submission) -> Result<Cost, Problem> + Send + 'static,
        work: impl FnOnce(&Submission, &Library, &Run) -> Result<Vec<u8>, Problem> + Send + 'static,
    ) -> Result<Making<impl FnOnce(&Run) -> Result<Bytes, Problem> + Send + 'static>, Refusal> {
        let Self {
            job, submission, ..
        } = self;
        let app = &client.app;
        app.jobs.check_memory(client.name(), &submission).await?;
        let counted = blocking(client.name(), move |_| (cost(&submission), submission));
        let (cost, submission) = counted.await?;
        let Cost {
            memory,
            seconds,
            sent,
        } = cost?;
        let memory = memory.div_ceil(1_000_000);
        let limit = app.jobs.rules().memory_mb;
        if memory > limit {
            return Err(too_much_memory(memory, limit).into());
        }
        app.bodies.check_answer(sent)?;
        let took = job.elapsed.map_or(0.0, |elapsed| elapsed.as_secs_f64());
        let time_limit = time_limit(app.previews.rules().time_limit, [seconds, took]);
        let (library, bodies, files) = (app.library.clone(), app.bodies.clone(), app.files.clone());
        let client = client.name().to_owned();
        let work = move |run: &Run| {
            let made = work(&submission, &library, run)?;
            let is_wanted = || run.check().is_ok();
            let give_way = || files.remove_oldest_of(&client);
            Ok(bodies.hold_file(&client, made, is_wanted, give_way).0)
        };
        Ok(Making {
            memory,
            time_limit,
            work,
        })
    }
}

/// Time limit of a file of a job, whose seconds are those of its estimate and those that it took, beside previews of at most `preview`.
fn time_limit(preview: Duration, [estimated, took]: [f64; 2]) -> Duration {
    let again = JOBS_LONG * estimated.max(took);
    let again = Duration::try_from_secs_f64(again).unwrap_or(LONGEST);
    again.max((preview * PREVIEWS_LONG).min(LONGEST))
}

/// The answer until a file is made.
fn made_later() -> Response {
    let mut response = (StatusCode::ACCEPTED, [(CACHE_CONTROL, "no-store")]).into_response();
    answer::tell_when_to_return(false, &mut response);
    response
}

/// Why there is no file of a job.
fn of_file(error: FileError) -> Problem {
    match error {
        FileError::Full(_) => Problem::new(
            Code::PreviewsFull,
            format!("{}. Try again later.", sentence(&error)),
        ),
        FileError::ClientFull(_) => Problem::new(
            Code::RateLimited,
            format!("{}. Ask again when one of them has come.", sentence(&error)),
        ),
        FileError::TimeLimit(limit) => Problem::new(
            Code::TimeLimit,
            format!(
                "It was stopped after {} s, the most that it may take. One torque takes less than all of them.",
                limit.as_secs()
            ),
        ),
        FileError::JobRemoved => Problem::new(
            Code::JobNotFound,
            "The job was removed while its file was computed.",
        ),
        FileError::ShuttingDown => Problem::new(
            Code::Unavailable,
            "The service is shutting down and computes no more files.",
        ),
        FileError::Failed(problem) => problem,
    }
}

/// Bytes that displacements and stresses of both gears take until the file is written, and those of the packed file of both, if the request asks for it.
fn field_bytes(case: &Case, degrees_of_freedom: u64, grids: Option<Cells>) -> [u64; 2] {
    let [made, sent] = if case.faces().is_some() {
        if grids.is_none() {
            return [0, 0];
        }
        let teeth = Member::BOTH.map(|member| u64::from(case.pair.gear(member).tooth_count()));
        VOLUME_BYTES.map(|bytes| bytes * (teeth[0] + teeth[1]))
    } else {
        PLATE_BYTES.map(|bytes| bytes * degrees_of_freedom)
    };
    match grids {
        None => [made, 0],
        Some(Cells::Quadratic) => [made, sent],
        Some(Cells::Linear) => {
            let [more, times] = LINEAR;
            [made + more * sent, times * sent]
        }
    }
}

/// The file of both gears on such `cells`, packed as it is written.
fn packed_grids(found: &Inside, cells: Cells) -> io::Result<Vec<u8>> {
    let gears = match found {
        Inside::Plates(found) => found.gears.each_ref().map(vtu::Piece::Plate),
        Inside::Volumes(found) => found.gears.each_ref().map(vtu::Piece::Volume),
    };
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    match cells {
        Cells::Quadratic => vtu::write(gears, &mut packed)?,
        Cells::Linear => {
            let divided = gears.map(Divided::of);
            vtu::write(divided.each_ref().map(vtu::Piece::Linear), &mut packed)?;
        }
    }
    packed.finish()
}

/// The body of a packed file: as it is, or unpacked as it is sent.
fn packed_or_plain(packed: Held, request: &HeaderMap) -> Response {
    if takes_gzip(request) {
        let packing = [(CONTENT_ENCODING, "gzip"), (VARY, "accept-encoding")];
        (packing, packed).into_response()
    } else {
        const AT_ONCE: usize = 64 << 10;
        let mut decoder = GzDecoder::new(packed.0.reader());
        let pieces = std::iter::from_fn(move || {
            let mut piece = vec![0; AT_ONCE];
            let read = decoder.read(&mut piece);
            read.map(|read| {
                piece.truncate(read);
                (read > 0).then(|| Bytes::from(piece))
            })
            .transpose()
        });
        Body::from_stream(stream::iter(pieces)).into_response()
    }
}

impl FieldParameters {
    /// The torque and the position, if `submission` has them.
    fn within(&self, submission: &Submission) -> Result<(f64, f64), Problem> {
        let case = submission.case();
        let mut loaded = case.output_torques.iter().filter(|torque| **torque != 0.0);
        let torque = match self.torque {
            None => loaded.next(),
            Some(wanted) => loaded.find(|torque| **torque == wanted),
        };
        let torque = *torque.ok_or_else(|| {
            let all: Vec<String> = case.output_torques.iter().map(f64::to_string).collect();
            let detail = format!(
                "There is no such torque to look at; the job's are {} N m, and at 0 nothing is deformed.",
                all.join(", ")
            );
            Problem::new(Code::NotFound, detail)
        })?;
        let (position, span) = (self.mesh_position.unwrap_or(0.0), f64::from(case.span()));
        let outside = |nearest| {
            format!(
                "mesh_position is {position:?}; the job spans 0 to {span} mesh periods, and the nearest is {nearest}."
            )
        };
        if position > span {
            return Err(Problem::new(Code::NotFound, outside(span)));
        }
        if !(0.0..).contains(&position) {
            return Err(invalid(outside(0.0)));
        }
        Ok((torque, position))
    }
}

#[cfg(test)]
mod tests {
    use meshwright_engine::analysis::fields::{Fields, GearField};

    use super::*;
    use crate::testing::submission;

    fn bytes<T>(of: &[T]) -> u64 {
        size_of_val(of) as u64
    }

    /// What is inside of case 2 of the paper, the bytes that its file takes on such `cells`, and the bytes that are said of both.
    fn plates(cells: Cells) -> (Fields, u64, [u64; 2]) {
        let submission = submission("test-case-2");
        let library = Library::with_capacity(1 << 20);
        let place = (submission.case().output_torques[0], 0.25);
        let found = inside(&submission, place, &library, &Run::unattended()).expect("computed");
        let sent = packed_grids(&found, cells).expect("packed").len() as u64;
        let Inside::Plates(found) = found else {
            panic!("a plane pair has plates");
        };
        #[expect(clippy::disallowed_methods, reason = "in a test")]
        let unknowns = analysis::estimate(submission.case(), None).degrees_of_freedom;
        let said = field_bytes(submission.case(), unknowns, Some(cells));
        (found, sent, said)
    }

    fn bytes_of(gear: &GearField) -> u64 {
        bytes(&gear.nodes)
            + bytes(&gear.displacements)
            + bytes(&gear.stresses)
            + bytes(&gear.von_mises)
            + bytes(&gear.elements)
            + bytes(&gear.thicknesses)
            + bytes(&gear.edges)
    }

    #[test]
    fn the_file_of_plates_and_what_it_is_made_of_take_no_more_than_is_said() {
        let (found, sent, [made, most]) = plates(Cells::Quadratic);
        let field: u64 = found.gears.iter().map(bytes_of).sum();
        println!("{field} bytes, {sent} packed; {made} and {most} said");
        assert!(field + sent <= made && sent <= most);
    }

    #[test]
    #[ignore = "./test all"]
    fn linear_cells_take_no_more_than_is_said() {
        let (found, sent, [made, most]) = plates(Cells::Linear);
        let field: u64 = found.gears.iter().map(bytes_of).sum();
        let divided = found
            .gears
            .iter()
            .map(|gear| Divided::of(vtu::Piece::Plate(gear)));
        let divided: u64 = divided.map(|gear| gear.bytes()).sum();
        println!("{field} and {divided} bytes, {sent} packed; {made} and {most} said");
        assert!(field + divided + sent <= made && sent <= most);
    }

    #[test]
    fn a_file_may_take_as_long_as_its_job_however_short_previews_are() {
        let seconds = Duration::from_secs;
        assert_eq!(time_limit(Duration::ZERO, [5.0, 2.0]), seconds(20));
        assert_eq!(time_limit(Duration::ZERO, [5.0, 30.0]), seconds(120));
        assert_eq!(time_limit(seconds(10), [5.0, 2.0]), seconds(40));
        assert_eq!(time_limit(seconds(1000), [5.0, 2.0]), LONGEST);
        assert_eq!(time_limit(seconds(10), [f64::MAX, 2.0]), LONGEST);
    }
}
