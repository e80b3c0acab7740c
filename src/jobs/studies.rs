//! Studies as handlers see them: submit, look, cancel, delete. Their designs are expanded in chunks: the first one stands
//! when the study is answered, the others follow, also when the process ends in between.

use std::time::Duration;

use jiff::Timestamp;
use sha2::{Digest, Sha256};
use tracing::{error, info};
use uuid::Uuid;

use super::job::Status;
use super::queue::{JobError, Jobs, KEY_LIFETIME};
use super::store::Cursor;
use super::study::StudyRecord;
use super::study_transitions::{NewRow, NewStudy, StoredRow, StudyOutcome};
use super::transitions::NewJob;
use crate::wire::{RowState, SOLVER_VERSION, Study};

/// So many designs are expanded and written in one transaction. Others write in between.
const CHUNK: usize = 500;

/// A study that answers a submission.
#[derive(Debug, Clone, PartialEq)]
pub struct StudySubmitted {
    /// The study.
    pub study: StudyRecord,
    /// Whether an earlier request with the same key made it.
    pub repeated: bool,
}

/// Some studies of a list.
#[derive(Debug)]
pub struct StudyPage {
    /// The studies, newest first.
    pub items: Vec<StudyRecord>,
    /// Where the list goes on.
    pub next: Option<Cursor>,
}

impl Jobs {
    /// Takes a study: it and its first designs are on the disk when this comes back.
    ///
    /// # Errors
    ///
    /// [`JobError::QueueFull`], [`JobError::KeyConflict`], [`JobError::ShuttingDown`], [`JobError::Database`].
    pub async fn submit_study(
        &self,
        client: &str,
        study: Study,
        idempotency_key: Option<String>,
    ) -> Result<StudySubmitted, JobError> {
        let now = (self.clock)();
        let document = study.document().to_string();
        let new = NewStudy {
            id: Uuid::now_v7(),
            client: client.to_owned(),
            body_hash: Sha256::digest(&document)
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect(),
            document,
            gear: study.gear(),
            total: study.total() as u64,
            submitted_at: now,
            idempotency_key,
        };
        let owner = Owner {
            study: new.id,
            client: client.to_owned(),
            submitted_at: now,
        };
        let (study, rows, owner) = expand(study, 0, owner).await?;
        let forget_before = now.saturating_sub(KEY_LIFETIME).unwrap_or(Timestamp::MIN);
        let outcome = self
            .store
            .begin_study(&new, &rows, forget_before, SOLVER_VERSION)
            .await?;
        let (id, repeated) = match outcome {
            StudyOutcome::Taken => {
                info!(study = %new.id, designs = new.total, "study taken");
                self.live.work.notify_one();
                if rows.len() < study.total() {
                    self.continue_in_background(study, rows.len(), owner);
                }
                (new.id, false)
            }
            StudyOutcome::Repeated(id) => (id, true),
            StudyOutcome::KeyConflict => return Err(JobError::KeyConflict),
            StudyOutcome::QueueFull { waiting } => return Err(JobError::QueueFull { waiting }),
        };
        let study = self.find_study(client, id).await?;
        Ok(StudySubmitted { study, repeated })
    }

    /// Goes on with the expansion of studies that an earlier process has left.
    pub(super) async fn resume_studies(&self) -> Result<(), sqlx::Error> {
        for (id, client) in self.store.unfinished_expansions().await? {
            let Some(record) = self.store.find_study(&client, id).await? else {
                continue;
            };
            match Study::parse(record.document.as_bytes()) {
                Ok(study) => {
                    info!(study = %id, expanded = record.expanded, designs = record.total, "study resumed");
                    let owner = Owner {
                        study: id,
                        client,
                        submitted_at: record.submitted_at,
                    };
                    let expanded = usize::try_from(record.expanded).unwrap_or(usize::MAX);
                    self.continue_in_background(study, expanded, owner);
                }
                // An earlier version took it; what it has of rows is kept.
                Err(problem) => {
                    error!(study = %id, %problem, "a study is no longer understood, and cancelled");
                    self.store.cancel_study(&client, id, (self.clock)()).await?;
                }
            }
        }
        Ok(())
    }

    fn continue_in_background(&self, study: Study, expanded: usize, owner: Owner) {
        let jobs = self.clone();
        tokio::spawn(async move {
            let id = owner.study;
            // The next process goes on where this one stops.
            if let Err(error) = jobs.expand_all(study, expanded, owner).await {
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
                .continue_study(owner.study, expanded as u64, &rows, SOLVER_VERSION)
                .await?;
            if !stands {
                break;
            }
            expanded += rows.len();
            self.live.work.notify_one();
            self.live.changed(owner.study);
        }
        Ok(())
    }

    /// A study as it stands now.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyNotFound`], [`JobError::Database`].
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
    /// [`JobError::StudyNotFound`], [`JobError::Database`].
    pub async fn wait_for_study(
        &self,
        client: &str,
        id: Uuid,
        patience: Duration,
    ) -> Result<StudyRecord, JobError> {
        /// Between two looks: the jobs of a study end much faster than anybody wants to know.
        const PAUSE: Duration = Duration::from_millis(50);
        let ended = async {
            let mut news = self.news(id);
            loop {
                let study = self.find_study(client, id).await?;
                if study.status().has_ended() {
                    return Ok(study);
                }
                news.changed_state().await;
                tokio::time::sleep(PAUSE).await;
            }
        };
        tokio::select! {
            study = ended => study,
            () = tokio::time::sleep(patience) => self.find_study(client, id).await,
            () = self.stop().cancelled() => self.find_study(client, id).await,
        }
    }

    /// At most `limit` studies, newest first.
    ///
    /// # Errors
    ///
    /// [`JobError::Database`].
    pub async fn list_studies(
        &self,
        client: &str,
        after: Option<Cursor>,
        limit: u32,
    ) -> Result<StudyPage, JobError> {
        // One more than asked for tells whether the list goes on.
        let mut items = self
            .store
            .list_studies(client, after, limit.saturating_add(1))
            .await?;
        let goes_on = items.len() > limit as usize;
        items.truncate(limit as usize);
        let next = items.last().filter(|_| goes_on).map(|study| Cursor {
            submitted_at: study.submitted_at,
            id: study.id,
        });
        Ok(StudyPage { items, next })
    }

    /// The rows of a study that was found, with what has come of each so far.
    ///
    /// # Errors
    ///
    /// [`JobError::Database`].
    pub async fn study_rows(&self, study: &StudyRecord) -> Result<Vec<RowState>, JobError> {
        let rows = self.store.study_rows(study.id).await?;
        // Thousands of small documents are read here, which is more than a thread that answers requests should do.
        blocking(move || rows.into_iter().map(row_state).collect()).await
    }

    /// Ends a study: what waits or runs of it is dismissed, what has results keeps them. A study that was cancelled
    /// before stays so.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyEnded`], [`JobError::StudyNotFound`], [`JobError::Database`].
    pub async fn cancel_study(&self, client: &str, id: Uuid) -> Result<StudyRecord, JobError> {
        let dismissed = self.store.cancel_study(client, id, (self.clock)()).await?;
        let cancelled = dismissed.is_some();
        for job in dismissed.into_iter().flatten() {
            // One that enters only now finds at its first report that it is dismissed.
            if let Some(running) = self.live.running(job) {
                running.stop();
            }
            self.live.changed(job);
        }
        self.live.changed(id);
        let study = self.find_study(client, id).await?;
        if cancelled || study.cancelled_at.is_some() {
            Ok(study)
        } else {
            Err(JobError::StudyEnded(study.status()))
        }
    }

    /// Removes a study that has ended, with its jobs and their results.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyRunning`], [`JobError::StudyNotFound`], [`JobError::Database`].
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
struct Owner {
    study: Uuid,
    client: String,
    submitted_at: Timestamp,
}

impl Owner {
    fn row(&self, design: crate::wire::Design) -> NewRow {
        let job = match design.submission {
            Ok(submission) => Ok(NewJob {
                id: Uuid::now_v7(),
                client: self.client.clone(),
                method: submission.method().to_owned(),
                tags: submission.tags().to_vec(),
                submission: submission.canonical_json(),
                input_hash: submission.input_hash(),
                positions_total: submission.positions_total(),
                submitted_at: self.submitted_at,
                idempotency_key: None,
                study: Some(self.study),
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
async fn blocking<T: Send + 'static>(
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

fn row_state(row: StoredRow) -> RowState {
    let problem: Option<serde_json::Value> = row
        .problem
        .and_then(|text| serde_json::from_str(&text).ok());
    let status = match (row.status, &problem) {
        (Some(status), _) => status,
        (None, Some(_)) => Status::Failed,
        // The client has deleted the job.
        (None, None) => Status::Dismissed,
    };
    RowState {
        label: row.label,
        changes: serde_json::from_str(&row.changes).unwrap_or_default(),
        job: row.job.and_then(|id| id.parse().ok()),
        status: status.as_str(),
        summary: row
            .summary
            .and_then(|text| serde_json::from_str(&text).ok()),
        problem,
    }
}
