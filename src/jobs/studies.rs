//! Studies as handlers see them: submit, look, cancel, delete. Their designs are expanded in chunks: the first one stands
//! when the study is answered, the others follow, also when the process ends in between.

use std::time::Duration;

use jiff::Timestamp;
use tracing::{error, info};
use uuid::Uuid;

use meshwright_engine::run::Run;

use super::error::JobError;
use super::queue::{Jobs, Member, rough_cost};
use super::resource::{Listed, Submitted};
use super::searches;
use super::store::{
    Document, NewJob, NewRow, NewStudy, StoreError, StoredRow, StudyFilter, StudyOutcome,
};
use super::study::StudyRecord;
use crate::hash::sha256_hex;
use crate::wire::{
    DOCUMENT_VERSION, Design, Kept, RowState, Status, Study, memory_above, too_much_memory,
};

/// So many designs are expanded and written in one transaction. Others write in between.
pub(super) const CHUNK: usize = 500;

/// So many rows of a table are read at a time, and so many documents.
const ROWS_AT_ONCE: u32 = 500;
const DOCUMENTS_AT_ONCE: u32 = 8;

/// The results of a design.
#[derive(Debug, Clone)]
pub struct DocumentLine {
    /// Its place in the table, from 0.
    pub position: i64,
    /// What the design is called.
    pub label: String,
    /// The job that computed it.
    pub job: String,
    /// Its results.
    pub document: Document,
}

impl Jobs {
    /// Takes a study: it and its first designs are on the disk when this comes back.
    ///
    /// # Errors
    ///
    /// [`JobError::QueueFull`], [`JobError::ClientQueueFull`], [`JobError::KeyConflict`], [`JobError::ShuttingDown`],
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn submit_study(
        &self,
        member: &Member,
        study: Study,
        idempotency_key: Option<String>,
    ) -> Result<Submitted<StudyRecord>, JobError> {
        self.refuse_if_failing()?;
        let now = self.clock.now();
        let owner = self.owner(&study, Uuid::now_v7(), member.client.clone(), now);
        let Expanded {
            study,
            rows,
            search,
            owner,
        } = begun(study, owner).await?;
        let new = NewStudy {
            id: owner.study,
            client: member.client.clone(),
            name: study.name().map(str::to_owned),
            tags: study.tags().to_vec(),
            body_hash: sha256_hex(study.document()),
            document: study.document().to_owned(),
            document_version: DOCUMENT_VERSION,
            gear: study.gear(),
            total: study.total() as u64,
            search,
            submitted_at: now,
            idempotency_key,
            client_limit: self.rules.client_design_limit,
        };
        let outcome = self.store.begin_study(&new, &rows, self.bounds()).await?;
        let (id, repeated) = match outcome {
            StudyOutcome::Taken => {
                info!(study = %new.id, client = new.client, designs = new.total, "study taken");
                self.live.ring();
                // It may have ended with its beginning.
                self.live.changed(new.id);
                if rows.len() < study.total() {
                    self.continue_in_background(study, rows.len(), owner);
                }
                (new.id, false)
            }
            StudyOutcome::Repeated(id) => (id, true),
            StudyOutcome::KeyConflict => return Err(JobError::KeyConflict),
            StudyOutcome::QueueFull { waiting } => return Err(JobError::QueueFull { waiting }),
            StudyOutcome::ClientQueueFull { waiting } => {
                return Err(JobError::ClientQueueFull {
                    waiting,
                    limit: new.client_limit,
                });
            }
        };
        let record = self.find_study(&member.client, id).await?;
        Ok(Submitted { record, repeated })
    }

    /// Goes on with the expansion of studies, and with their cancellation, that another process has left.
    pub(super) async fn resume_studies(&self) -> Result<(), StoreError> {
        for id in self.store.unfinished_cancellations().await? {
            self.dismiss_designs(id).await?;
        }
        for (id, client) in self
            .store
            .unfinished_expansions(self.clock.steady(), DOCUMENT_VERSION)
            .await?
        {
            let Some(record) = self.store.find_study(&client, id).await? else {
                continue;
            };
            let document = self
                .store
                .study_text(id, u64::MAX)
                .await?
                .unwrap_or_default();
            match Study::parse(document.as_bytes(), &Run::unattended()) {
                Ok(study) => {
                    info!(study = %id, expanded = record.expanded, designs = record.total, "study resumed");
                    let owner = self.owner(&study, id, client, record.submitted_at);
                    let expanded = usize::try_from(record.expanded).unwrap_or(usize::MAX);
                    self.continue_in_background(study, expanded, owner);
                }
                // An earlier version took it; what it has of rows is kept.
                Err(problem) => {
                    error!(study = %id, %problem, "a study is no longer understood, and cancelled");
                    let now = self.clock.now();
                    self.store.cancel_study(&client, id, now).await?;
                    self.dismiss_designs(id).await?;
                }
            }
        }
        Ok(())
    }

    fn owner(&self, study: &Study, id: Uuid, client: String, submitted_at: Timestamp) -> Owner {
        Owner {
            study: id,
            client,
            submitted_at,
            memory_mb: self.rules.job_memory_mb,
            keep: study.keep(),
            is_population: study.is_population(),
        }
    }

    fn continue_in_background(&self, study: Study, expanded: usize, owner: Owner) {
        let jobs = self.clone();
        tokio::spawn(async move {
            let id = owner.study;
            // The next process goes on where this one stops.
            let expanded = if study.is_search() {
                jobs.search_on(study, owner).await
            } else {
                jobs.expand_all(study, expanded, owner).await
            };
            if let Err(error) = expanded {
                error!(study = %id, error = %error, "a study cannot be expanded now");
            }
        });
    }

    /// Adds chunk after chunk of rows, until there are all, or the study is cancelled, or the service stops.
    async fn expand_all(
        &self,
        mut study: Study,
        mut expanded: usize,
        mut owner: Owner,
    ) -> Result<(), JobError> {
        while expanded < study.total() && !self.stop().is_cancelled() {
            let rows;
            (study, rows, owner) = expand(study, expanded, owner).await?;
            let stands = self
                .store
                .continue_study(
                    owner.study,
                    expanded as u64,
                    &rows,
                    None,
                    self.clock.now(),
                    self.bounds(),
                )
                .await;
            // What the disk does not take now it takes later; the study is not given up for that.
            let stands = match stands {
                Err(error) if error.may_pass() => {
                    self.wait_for_storage().await;
                    continue;
                }
                stands => stands?,
            };
            if !stands {
                // It is cancelled or deleted; or a commit has lasted that was said to have failed.
                let now = self.store.find_study(&owner.client, owner.study).await?;
                let now = now.filter(|study| study.cancelled_at.is_none());
                let stored = now.map_or(0, |study| study.expanded as usize);
                if stored <= expanded {
                    break;
                }
                expanded = stored;
                continue;
            }
            expanded += rows.len();
            self.live.ring();
            self.live.changed(owner.study);
        }
        Ok(())
    }

    /// Comes back when it is worth writing again, or the service stops.
    pub(crate) async fn wait_for_storage(&self) {
        const PAUSE: Duration = Duration::from_millis(100);
        let writable = async {
            tokio::time::sleep(PAUSE).await;
            self.store.writable().await;
        };
        tokio::select! {
            () = writable => {}
            () = self.stop().cancelled() => {}
        }
    }

    /// A study as it stands now.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyNotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn find_study(&self, client: &str, id: Uuid) -> Result<StudyRecord, JobError> {
        self.store
            .find_study(client, id)
            .await?
            .ok_or(JobError::StudyNotFound(id))
    }

    /// A study once it has ended, or as it stands after `patience`.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyNotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn wait_for_study(
        &self,
        client: &str,
        id: Uuid,
        patience: Duration,
    ) -> Result<StudyRecord, JobError> {
        /// Between two looks: the jobs of a study end much faster than anybody wants to know.
        const PAUSE: Duration = Duration::from_millis(50);
        let look = || self.find_study(client, id);
        self.until_ended(id, patience, PAUSE, look, |study| {
            study.status().has_ended()
        })
        .await
    }

    /// At most `limit` studies, newest first.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn list_studies(
        &self,
        client: &str,
        filter: &StudyFilter,
        limit: u32,
    ) -> Result<Listed<StudyRecord>, JobError> {
        let found = self.store.list_studies(client, filter, limit + 1).await?;
        Ok(Listed::first(found, limit, |study| study.sequence))
    }

    /// The study that was found, as it was sent, JSON.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyNotFound`] if it has been deleted since, [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_text(&self, id: Uuid) -> Result<String, JobError> {
        let text = self.store.study_text(id, u64::MAX).await?;
        text.ok_or(JobError::StudyNotFound(id))
    }

    /// The same, if it has no more characters than `most`.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn short_study_text(&self, id: Uuid, most: u64) -> Result<Option<String>, JobError> {
        Ok(self.store.study_text(id, most).await?)
    }

    /// Some rows of a study that was found, behind the first `after` ones, with what has come of each so far. None left:
    /// the table is at its end.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_rows(&self, id: Uuid, after: u64) -> Result<Vec<RowState>, JobError> {
        let rows = self
            .store
            .study_rows(id, position_before(after), ROWS_AT_ONCE)
            .await?;
        // Hundreds of small documents are read here, which is more than a thread that answers requests should do.
        blocking(move || rows.into_iter().map(row_state).collect()).await
    }

    /// Some results of a study that was found, of the designs behind the position `after` that have results. None left:
    /// there are no more now.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_documents(
        &self,
        id: Uuid,
        after: Option<i64>,
    ) -> Result<Vec<DocumentLine>, JobError> {
        let after = after.unwrap_or(-1);
        Ok(self
            .store
            .study_documents(id, after, DOCUMENTS_AT_ONCE)
            .await?)
    }

    /// Ends a study: what waits or runs of it is dismissed, what has results keeps them. A study that was cancelled
    /// before stays so.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyEnded`], [`JobError::StudyNotFound`], [`JobError::ShuttingDown`], [`JobError::Unavailable`],
    /// [`JobError::Database`].
    pub async fn cancel_study(&self, client: &str, id: Uuid) -> Result<StudyRecord, JobError> {
        let cancelled = self
            .store
            .cancel_study(client, id, self.clock.now())
            .await?;
        let study = self.find_study(client, id).await?;
        if !cancelled && study.cancelled_at.is_none() {
            return Err(JobError::StudyEnded(study.status()));
        }
        let jobs = self.clone();
        // A hundred thousand jobs take some seconds, and the client may go away meanwhile.
        let dismissed = tokio::spawn(async move { jobs.dismiss_designs(id).await });
        dismissed.await.map_err(|_| JobError::ShuttingDown)??;
        self.find_study(client, id).await
    }

    /// Dismisses what waits or runs of a study that was cancelled, some jobs at a time. What a process leaves of it the next
    /// one does.
    async fn dismiss_designs(&self, id: Uuid) -> Result<(), StoreError> {
        loop {
            let (dismissed, more) = self.store.dismiss_designs(id, self.clock.now()).await?;
            for job in dismissed {
                // One that enters only now finds at its first report that it is dismissed.
                if let Some(running) = self.live.running(job) {
                    running.stop();
                }
                self.live.changed(job);
            }
            self.live.changed(id);
            if !more || self.stop().is_cancelled() {
                return Ok(());
            }
        }
    }

    /// Removes a study that has ended, with its jobs and their results.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyRunning`], [`JobError::StudyNotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn delete_study(&self, client: &str, id: Uuid) -> Result<(), JobError> {
        if self.store.delete_study(client, id).await? {
            self.live.changed(id);
            return Ok(());
        }
        self.find_study(client, id).await?;
        Err(JobError::StudyRunning)
    }
}

/// Whose jobs the designs become.
pub(super) struct Owner {
    pub(super) study: Uuid,
    pub(super) client: String,
    submitted_at: Timestamp,
    /// So much memory may a design take.
    memory_mb: u64,
    /// How much of their results is kept.
    keep: Kept,
    /// Whether they are members of a population, whose drawn pair is known from the first of them.
    is_population: bool,
}

impl Owner {
    pub(super) fn row(&self, design: Design) -> NewRow {
        let submission = design.submission.and_then(|submission| {
            match memory_above(&submission, self.memory_mb) {
                None => Ok(submission),
                Some(needed_mb) => Err(too_much_memory(needed_mb, self.memory_mb)),
            }
        });
        let job = match submission {
            Ok(submission) => Ok(NewJob {
                study: Some(self.study),
                keep: self.keep,
                cost: rough_cost(&submission, self.is_population),
                ..NewJob::of(&submission, &self.client, self.submitted_at)
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

/// A study with its first rows.
struct Expanded {
    study: Study,
    rows: Vec<NewRow>,
    /// How a search stands before it begins.
    search: Option<String>,
    owner: Owner,
}

/// The first rows of a study.
async fn begun(study: Study, owner: Owner) -> Result<Expanded, JobError> {
    if study.is_search() {
        let made = blocking(move || {
            let (rows, search) = searches::begun(&study, &owner);
            Expanded {
                study,
                rows,
                search,
                owner,
            }
        });
        return made.await;
    }
    let (study, rows, owner) = expand(study, 0, owner).await?;
    Ok(Expanded {
        study,
        rows,
        search: None,
        owner,
    })
}

/// The next chunk of rows behind the first `expanded` ones.
async fn expand(
    study: Study,
    expanded: usize,
    owner: Owner,
) -> Result<(Study, Vec<NewRow>, Owner), JobError> {
    blocking(move || {
        let designs = (expanded..expanded + CHUNK).map_while(|row| study.design(row));
        let rows = designs.map(|design| owner.row(design)).collect();
        (study, rows, owner)
    })
    .await
}

/// Does work of some milliseconds where it holds nobody up.
pub(super) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, JobError> {
    match tokio::task::spawn_blocking(work).await {
        Ok(done) => Ok(done),
        Err(error) => match error.try_into_panic() {
            Ok(panic) => std::panic::resume_unwind(panic),
            // Only a runtime that ends drops such work.
            Err(_) => Err(JobError::ShuttingDown),
        },
    }
}

/// The position before the first one behind `count` rows.
fn position_before(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX) - 1
}

fn row_state(row: StoredRow) -> RowState {
    let problem: Option<serde_json::Value> = row
        .problem
        .and_then(|text| serde_json::from_str(&text).ok());
    let status = match (row.status.as_deref().and_then(Status::of_word), &problem) {
        (Some(status), _) => status,
        (None, Some(_)) => Status::Failed,
        // The client has deleted the job.
        (None, None) => Status::Dismissed,
    };
    RowState {
        label: row.label,
        changes: serde_json::from_str(&row.changes).unwrap_or_default(),
        job: row.job.and_then(|id| id.parse().ok()),
        status,
        summary: row
            .summary
            .and_then(|text| serde_json::from_str(&text).ok()),
        problem,
    }
}
