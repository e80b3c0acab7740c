//! The table of a study, and the results behind it. Both are sent in pieces as they are read, each of which holds its memory until it has
//! left.

use std::sync::Arc;

use axum::body::{Body, Bytes};
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, HeaderName, HeaderValue, LINK};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use meshwright_connections::Keep;
use meshwright_engine::run::Run;
use meshwright_studies::table::{CsvTable, Outline, TableRow};
use meshwright_studies::{RowState, StudyResults};
use meshwright_wire::{Code, Problem, Results};
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;
use tokio::sync::OnceCell;
use utoipa::ToSchema;
use uuid::Uuid;

use super::outlines::Front;
use super::tag_of;
use super::view::why_failed;
use crate::http::answer::{self, tell_when_to_return};
use crate::http::app::App;
use crate::http::blocking::{blocking, turn_to_read};
use crate::http::client::Client;
use crate::http::listed_files::ListedFile;
use crate::http::parameters::{IfNoneMatch, StudyId};
use crate::http::problem::Refusal;
use crate::http::view::with_public_type;
use crate::jobs::{DocumentLine, JobError, Resource as _, StudyRecord, gear_of};

/// Get the table of a study
///
/// A row for each design, filled as far as the study has come; it can be read at any time. Rows have their place when the
/// study is taken, those beyond the first 500 a moment later.
#[utoipa::path(
    get, path = "/v1/studies/{id}/results", tag = "Studies", operation_id = "get_study_results",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The table.", body = StudyResults, headers(
            ("Retry-After" = u32, description = "Until the study has ended: seconds after which it is worth looking again."),
        )),
    ),
)]
pub(in crate::http) async fn results(
    client: Client,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    send(client, id, &request, StudyFile::Json).await
}

/// Get {file} of a study
#[utoipa::path(
    get, path = "/v1/studies/{id}/results/{file}", tag = "Studies", operation_id = "get_study_file",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The file. It is sent as it is read.", body = DesignResults),
        (status = 404, description = "There is no such study."),
    ),
)]
pub(in crate::http) async fn file(
    client: Client,
    Path((id, file)): Path<(String, String)>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let form = StudyFile::ALL.into_iter().find(|form| form.name() == file);
    let form = form.ok_or_else(|| {
        let names = StudyFile::ALL.map(StudyFile::name).join(", ");
        Problem::new(Code::NotFound, format!("The files are {names}."))
    })?;
    let StudyId(id) = StudyId::of(&id)?;
    send(client, id, &request, form).await
}

/// The table as CSV at the address that it had first.
pub(in crate::http) async fn old_csv(
    client: Client,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let address = format!(
        "<{}/v1/studies/{id}/results/table.csv>; rel=\"successor-version\"",
        client.app.edge.public_url
    );
    let mut response = send(client, id, &request, StudyFile::Csv).await?;
    let headers = response.headers_mut();
    // 2026-11-21, as RFC 9745 wants it.
    headers.insert(
        HeaderName::from_static("deprecation"),
        HeaderValue::from_static("@1795219200"),
    );
    if let Ok(address) = HeaderValue::try_from(address) {
        headers.insert(LINK, address);
    }
    Ok(response)
}

/// A file of a study.
#[derive(Clone, Copy)]
enum StudyFile {
    /// The table.
    Json,
    /// The table, one row to a line.
    Ndjson,
    /// The table as CSV.
    Csv,
    /// The results, one to a line.
    Documents,
}

/// The files of a study.
pub(in crate::http) fn files() -> Vec<ListedFile> {
    let of = |form: StudyFile| {
        let (schema, about) = match form {
            StudyFile::Json => (
                Some("StudyResults"),
                "The table, as `/v1/studies/{id}/results` gives it.",
            ),
            StudyFile::Ndjson => (
                Some("TableRow"),
                "The table, one row to a line, each as in the JSON. The schema is that of a line.",
            ),
            StudyFile::Csv => (
                None,
                "The table, one line for each row and torque, the columns named as in the JSON with dots between the names.",
            ),
            StudyFile::Documents => (
                Some("DesignResults"),
                "The results of every design that has some, as `/v1/jobs/{id}/results` gives them: one object to a line, with the place of the design in the table, its label and its job. The schema is that of a line.",
            ),
        };
        let media_type = form.content_type();
        ListedFile {
            name: form.name(),
            media_type: media_type
                .split_once(';')
                .map_or(media_type, |(plain, _)| plain),
            schema,
            about: Some(about),
            without: &[],
        }
    };
    StudyFile::ALL.map(of).into()
}

/// A line of `documents.ndjson`: the results of a design.
#[derive(Serialize, ToSchema)]
#[schema(title = "DesignResults")]
pub(in crate::http) struct DesignResults<'a> {
    /// The place of the design in the table, from 0.
    row: i64,
    /// Label of the design.
    label: &'a str,
    /// The job that computed it.
    #[schema(format = "uuid")]
    job: &'a str,
    /// The results.
    #[schema(value_type = Results)]
    results: &'a RawValue,
}

/// A line of NDJSON.
fn ndjson(line: &impl Serialize) -> String {
    let mut text = serde_json::to_string(line).expect("a line is plain data");
    text.push('\n');
    text
}

impl StudyFile {
    const ALL: [Self; 4] = [Self::Json, Self::Ndjson, Self::Csv, Self::Documents];

    fn name(self) -> &'static str {
        match self {
            Self::Json => "table.json",
            Self::Ndjson => "table.ndjson",
            Self::Csv => "table.csv",
            Self::Documents => "documents.ndjson",
        }
    }

    fn content_type(self) -> &'static str {
        match self {
            Self::Json => "application/json",
            Self::Csv => "text/csv; charset=utf-8",
            Self::Ndjson | Self::Documents => "application/x-ndjson",
        }
    }
}

async fn send(
    client: Client,
    id: Uuid,
    request: &HeaderMap,
    form: StudyFile,
) -> Result<Response, Refusal> {
    let study = StudyRecord::find(&client.app.jobs, client.name(), id).await?;
    let tag = tag_of(&study, form.name(), &client.app.edge);
    let name = Arc::from(client.name());
    let made = async {
        let body = match form {
            StudyFile::Json | StudyFile::Ndjson | StudyFile::Csv => {
                table(client.app, name, &study, form).await?
            }
            StudyFile::Documents => documents(client.app, name, &study).await?,
        };
        let media_type = form.content_type();
        Ok::<_, Refusal>(match form {
            StudyFile::Json => ([(CONTENT_TYPE, media_type)], body).into_response(),
            _ => answer::file(
                media_type,
                &format!("study-{}-{}", study.id, form.name()),
                body,
            ),
        })
    };
    let mut response = tag.answer(Keep::AskAgain, request, made).await?;
    tell_when_to_return(study.status().has_ended(), &mut response);
    Ok(response)
}

/// About so many bytes are sent at a time, and so many at most as a rule.
const PIECE: u64 = 256 << 10;
const LARGEST_PIECE: u64 = 1 << 20;

/// Rows read first, and maximum number of rows read at a time.
const FIRST_ROWS: u32 = 50;
const MOST_ROWS: u32 = 500;

/// Maximum number of documents read at a time.
const MOST_DOCUMENTS: u32 = 8;

/// The outline of the table of `study`, kept as long as somebody has it.
async fn outline_of(
    app: &App,
    client: &str,
    study: &StudyRecord,
) -> Result<Arc<OnceCell<Front>>, Problem> {
    let cell = app.outlines.of((study.id, study.version));
    let make = async || {
        let add = |outline: &mut Outline, _, state: &RowState| outline.add(state);
        let outline = over_rows(app, client, study.id, Outline::default(), add).await?;
        let front = move |_: &Run| Front {
            pointers: outline.pointers().to_vec(),
            quantities: outline.quantities(),
            best: outline.front(),
        };
        blocking(client, front).await
    };
    cell.get_or_try_init(make).await?;
    Ok(cell)
}

/// The table, read twice: first for the values that the first row needs, then row by row.
async fn table(
    app: App,
    client: Arc<str>,
    study: &StudyRecord,
    form: StudyFile,
) -> Result<Body, Problem> {
    let outline = outline_of(&app, &client, study).await?;
    let front = outline.get().ok_or_else(crate::http::problem::internal)?;
    let (head, foot, layout) = match form {
        StudyFile::Csv => {
            let csv = CsvTable::new(front.pointers.clone(), front.quantities);
            (csv.header(), "", Layout::Csv(csv))
        }
        StudyFile::Ndjson => (String::new(), "", Layout::Lines),
        StudyFile::Json | StudyFile::Documents => (head_of_json(study, &app), "]}", Layout::List),
    };
    let writer = RowWriter {
        client,
        study: study.clone(),
        outline,
        layout,
        public_url: Arc::from(app.edge.public_url.as_str()),
    };
    let begin = Some((app, Arc::new(writer), 0, FIRST_ROWS));
    let rows = stream::unfold(begin, async |at| {
        let (app, writer, read, most) = at?;
        match page(&app, &writer, read, most).await {
            Ok(Some((text, count))) => {
                // Rows that come one after the other have about as many bytes.
                let fit = PIECE * count / (text.len() as u64).max(1);
                let most = u32::try_from(fit).unwrap_or(MOST_ROWS).clamp(1, MOST_ROWS);
                Some((Ok(text), Some((app, writer, read + count, most))))
            }
            Ok(None) => None,
            // The head has been sent; the connection is cut, so that nobody takes this for the whole table.
            Err(problem) => Some((Err(problem), None)),
        }
    });
    let head = stream::iter([Ok(Bytes::from(head))]);
    let foot = stream::iter([Ok(Bytes::from_static(foot.as_bytes()))]);
    use futures_util::StreamExt;
    Ok(Body::from_stream(head.chain(rows).chain(foot)))
}

/// Applies `add` to every row of a study and its place; rows are read some at a time.
pub(super) async fn over_rows<T: Send + 'static>(
    app: &App,
    client: &str,
    study: Uuid,
    mut made: T,
    add: fn(&mut T, u64, &RowState),
) -> Result<T, Problem> {
    let mut read = 0;
    loop {
        let _turn = turn_to_read(client).await;
        let rows = app.jobs.study_rows(study, read, MOST_ROWS).await?;
        if rows.is_empty() {
            return Ok(made);
        }
        let before = read;
        read += rows.len() as u64;
        let added = blocking(client, move |run| {
            (before..)
                .zip(&rows)
                .take_while(|_| run.check().is_ok())
                .for_each(|(place, row)| add(&mut made, place, row));
            made
        });
        made = added.await?;
    }
}

/// Everything before the rows.
fn head_of_json(study: &StudyRecord, app: &App) -> String {
    let empty = StudyResults {
        id: Some(study.id),
        status: study.status(),
        done: study.done(),
        total: study.total,
        gear: gear_of(study),
        problem: why_failed(study, &app.edge),
        rows: Vec::new(),
    };
    let mut text = serde_json::to_string(&empty).expect("a table is plain data");
    // The rows come last.
    let end = text.rfind("]}").expect("a table ends with its rows");
    text.truncate(end);
    text
}

/// How rows follow each other.
enum Layout {
    /// In the list of a JSON document.
    List,
    /// As JSON, each on a line of its own.
    Lines,
    /// As CSV.
    Csv(CsvTable),
}

/// How rows are written.
struct RowWriter {
    client: Arc<str>,
    study: StudyRecord,
    outline: Arc<OnceCell<Front>>,
    layout: Layout,
    public_url: Arc<str>,
}

impl RowWriter {
    /// The rows behind the first `read` ones, as text.
    fn write(&self, read: u64, states: Vec<RowState>) -> String {
        let mut text = String::new();
        let front = self.outline.get().map_or(&[][..], |front| &front.best);
        for (i, state) in (read..).zip(states) {
            let best = usize::try_from(i).ok().and_then(|i| front.get(i));
            let mut row =
                TableRow::new(gear_of(&self.study), state, best.copied().unwrap_or(false));
            row.problem = row.problem.map(|problem| self.with_address(problem));
            match &self.layout {
                Layout::Csv(csv) => text.push_str(&csv.lines([&row])),
                Layout::Lines => text.push_str(&ndjson(&row)),
                Layout::List => {
                    if i > 0 {
                        text.push(',');
                    }
                    text.push_str(&serde_json::to_string(&row).expect("a row is plain data"));
                }
            }
        }
        text
    }

    fn with_address(&self, problem: Value) -> Value {
        with_public_type(problem, &self.public_url)
    }
}

/// The text of at most so many rows behind the first `read` ones, and how many they are.
async fn page(
    app: &App,
    writer: &Arc<RowWriter>,
    read: u64,
    most: u32,
) -> Result<Option<(Bytes, u64)>, Problem> {
    let client = &writer.client;
    let memory = app.bodies.for_answer(client, LARGEST_PIECE).await?;
    let turn = turn_to_read(client).await;
    let rows = app.jobs.study_rows(writer.study.id, read, most).await?;
    // The written text has its own memory.
    drop(turn);
    if rows.is_empty() {
        return Ok(None);
    }
    let (count, words) = (rows.len() as u64, Arc::clone(writer));
    let text = blocking(client, move |_| words.write(read, rows)).await?;
    Ok(Some((memory.hold(text).0, count)))
}

/// The results of every design that has some.
async fn documents(app: App, client: Arc<str>, study: &StudyRecord) -> Result<Body, Problem> {
    let id = study.id;
    // The first lines are read before anything is sent, so that an early failure is a problem document.
    let first = lines(&app, &client, id, None).await?;
    let lines = stream::unfold(Some((app, client, first)), move |at| async move {
        let (app, client, ready) = at?;
        let (text, last) = ready?;
        match lines(&app, &client, id, Some(last)).await {
            Ok(next) => Some((Ok(text), Some((app, client, next)))),
            Err(problem) => Some((Err(problem), None)),
        }
    });
    Ok(Body::from_stream(lines))
}

/// The next lines behind the position `after`, and the position of the last one; none at the end.
async fn lines(
    app: &App,
    client: &str,
    study: Uuid,
    after: Option<i64>,
) -> Result<Option<(Bytes, i64)>, Problem> {
    let sizes = app
        .jobs
        .study_document_bytes(study, after, MOST_DOCUMENTS)
        .await?;
    // As many as a piece has, and one in any case.
    let mut bytes = 0;
    let fit = sizes.iter().take_while(|size| {
        let fits = bytes == 0 || bytes + **size <= PIECE;
        bytes += if fits { **size } else { 0 };
        fits
    });
    let count = fit.count() as u32;
    if count == 0 {
        return Ok(None);
    }
    // Packed, unpacked, and as lines.
    let memory = app.bodies.for_answer(client, 3 * bytes).await?;
    let turn = turn_to_read(client).await;
    let found = app.jobs.study_documents(study, after, count).await?;
    drop(turn);
    let Some(last) = found.last().map(|line| line.position) else {
        return Ok(None);
    };
    let text = blocking(client, move |_| {
        found.iter().map(line).collect::<Result<String, _>>()
    });
    Ok(Some((memory.hold(text.await??).0, last)))
}

fn line(line: &DocumentLine) -> Result<String, Problem> {
    let text = line.document.text().map_err(JobError::from)?;
    // In JSON a line can only end between values.
    let text = text.replace(['\n', '\r'], " ");
    let results: &RawValue =
        serde_json::from_str(&text).map_err(|_| crate::http::problem::internal())?;
    Ok(ndjson(&DesignResults {
        row: line.position,
        label: &line.label,
        job: &line.job,
        results,
    }))
}
