//! Designs of a study: their jobs, and their rows with the outcomes.

use std::time::{Duration, Instant};

use jiff::Timestamp;
use meshwright_store::{Damaged, DocumentLine, Kept, NewJob, NewRow, Status, StoredRow};
use meshwright_studies::{Design, RowState, Study};
use meshwright_wire::{memory_above, too_much_memory};
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::error::{JobError, not_done};
use super::queue::{Jobs, new_job, rough_cost};

/// Designs expanded and written in one transaction. Others write in between.
pub(super) const CHUNK: usize = 500;

/// Designs are written after so long, however few: somebody may wait for the first of them.
const LONGEST_CHUNK: Duration = Duration::from_secs(1);

/// Whose jobs the designs become.
pub(super) struct Owner {
    pub(super) study: Uuid,
    pub(super) client: String,
    /// The user of the client.
    user: Option<String>,
    submitted_at: Timestamp,
    /// Limit of the memory of a design, in MB.
    memory_mb: u64,
    /// How much of their results is kept.
    keep: Kept,
    /// True for members of a population, whose drawn pair is known from the first of them.
    is_population: bool,
}

impl Owner {
    pub(super) fn row(&self, design: Design) -> NewRow {
        let is_known_as_drawn = self.is_population || is_drawn_as_the_base(&design);
        let submission = design.submission.and_then(|submission| {
            #[expect(clippy::disallowed_methods, reason = "in `blocking`")]
            let above = memory_above(&submission, self.memory_mb);
            match above {
                None => Ok(submission),
                Some(needed_mb) => Err(too_much_memory(needed_mb, self.memory_mb)),
            }
        });
        let job = match submission {
            Ok(submission) => Ok(NewJob {
                study: Some(self.study),
                keep: self.keep,
                submitted_by: self.user.clone(),
                cost: rough_cost(&submission, is_known_as_drawn),
                ..new_job(&submission, &self.client, self.submitted_at)
            }),
            Err(problem) => Err(problem.to_json()),
        };
        NewRow {
            label: design.label,
            changes: serde_json::Value::Object(design.changes).to_string(),
            job,
        }
    }
}

impl Jobs {
    /// The owner of the designs of a study that a user of a client submitted.
    pub(super) fn owner(
        &self,
        study: &Study,
        id: Uuid,
        (client, user): (String, Option<String>),
        submitted_at: Timestamp,
    ) -> Owner {
        Owner {
            study: id,
            client,
            user,
            submitted_at,
            memory_mb: self.rules.job_memory_mb,
            keep: study.keep(),
            is_population: study.is_population(),
        }
    }

    /// Up to a given number of rows of a study, behind the first `after` ones, with their outcomes so far. An empty list means the end of the table.
    ///
    /// # Errors
    ///
    /// [`JobError::Damaged`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_rows(
        &self,
        id: Uuid,
        after: u64,
        most: u32,
    ) -> Result<Vec<RowState>, JobError> {
        let rows = self
            .store
            .study_rows(id, position_before(after), most)
            .await?;
        // Hundreds of small documents are read here, which is more than a thread that answers requests should do.
        let states = blocking(move || rows.into_iter().map(row_state).collect::<Result<_, _>>());
        Ok(states.await??)
    }

    /// At most so many results of a study that was found, of the designs behind the position `after` that have results. None left:
    /// there are no more now.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_documents(
        &self,
        id: Uuid,
        after: Option<i64>,
        most: u32,
    ) -> Result<Vec<DocumentLine>, JobError> {
        let after = after.unwrap_or(-1);
        Ok(self.store.study_documents(id, after, most).await?)
    }

    /// The bytes of the text of each of these.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_document_bytes(
        &self,
        id: Uuid,
        after: Option<i64>,
        most: u32,
    ) -> Result<Vec<u64>, JobError> {
        let after = after.unwrap_or(-1);
        let bytes = self.store.study_document_bytes(id, after, most).await?;
        let bytes = bytes
            .into_iter()
            .map(|bytes| u64::try_from(bytes).unwrap_or_default());
        Ok(bytes.collect())
    }
}

/// A chunk of rows of `owner`, one for each of `designs` as long as it `goes_on`. It ends early where rows take long.
pub(super) fn chunk(
    designs: impl Iterator<Item = Design>,
    owner: &Owner,
    goes_on: impl Fn() -> bool,
) -> Vec<NewRow> {
    let begin = Instant::now();
    let mut rows = Vec::new();
    for design in designs.take(CHUNK) {
        rows.push(owner.row(design));
        if !goes_on() || begin.elapsed() >= LONGEST_CHUNK {
            break;
        }
    }
    rows
}

/// The next chunk of rows behind the first `expanded` ones, unless `stop` comes.
pub(super) async fn expand(
    study: Study,
    expanded: usize,
    owner: Owner,
    stop: CancellationToken,
) -> Result<(Study, Vec<NewRow>, Owner), JobError> {
    blocking(move || {
        let designs = (expanded..).map_while(|row| study.design(row));
        let rows = chunk(designs, &owner, || !stop.is_cancelled());
        (study, rows, owner)
    })
    .await
}

/// Does work of some milliseconds where it holds nobody up.
pub(super) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, JobError> {
    tokio::task::spawn_blocking(work).await.map_err(not_done)
}

/// True if a design differs from the base only by the deviations of its teeth and has gears drawn alike.
fn is_drawn_as_the_base(design: &Design) -> bool {
    let changes = &design.changes;
    !changes.is_empty()
        && changes
            .keys()
            .all(|path| path.contains("/tooth_deviations"))
}

/// The position before the first one behind `count` rows.
fn position_before(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX) - 1
}

fn row_state(row: StoredRow) -> Result<RowState, Damaged> {
    let problem: Option<serde_json::Value> = row
        .problem
        .and_then(|text| serde_json::from_str(&text).ok());
    let status = match (row.status.as_deref().and_then(Status::of_word), &problem) {
        (Some(status), _) => status,
        (None, Some(_)) => Status::Failed,
        // The client has deleted the job.
        (None, None) => Status::Dismissed,
    };
    let summary = row.summary.transpose()?;
    Ok(RowState {
        label: row.label,
        changes: serde_json::from_str(&row.changes).unwrap_or_default(),
        job: row.job.and_then(|id| id.parse().ok()),
        status,
        summary: summary.and_then(|text| serde_json::from_str(&text).ok()),
        problem,
    })
}
