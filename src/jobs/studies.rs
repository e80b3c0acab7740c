//! Studies as handlers see them: submit, look, cancel, delete. Their designs are expanded in chunks: the first one stands
//! when the study is answered, the others follow, also when the process ends in between.

use std::sync::atomic::Ordering;
use std::time::Duration;

use meshwright_connections::{blocking as beside_requests, spawn};
use meshwright_engine::run::Run;
use meshwright_store::{
    By, NewRow, NewStudy, Status, StoreError, StudyFilter, StudyOutcome, StudyRecord,
};
use meshwright_studies::Study;
use meshwright_wire::DOCUMENT_VERSION;
use meshwright_wire::hash::sha256_hex;
use tracing::{error, info};
use uuid::Uuid;

use super::designs::{Owner, blocking, chunk, expand};
use super::error::{JobError, not_done};
use super::listed::{Listed, Submitted};
use super::queue::{Jobs, Member};
use super::resource::Resource;
use super::searches;

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
        let whose = (member.client.clone(), member.user.clone());
        let owner = self.owner(&study, Uuid::now_v7(), whose, now);
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
            gear: study.gear().word().to_owned(),
            total: study.total() as u64,
            search,
            submitted_at: now,
            idempotency_key,
            client_limit: self.rules.client_design_limit,
            submitted_by: member.user.clone(),
        };
        let outcome = self.store.begin_study(&new, &rows, self.bounds()).await?;
        let (id, repeated) = match outcome {
            StudyOutcome::Taken => {
                info!(study = %new.id, client = new.client, designs = new.total, "study taken");
                self.live.ring();
                // The study may end as soon as it begins.
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
        let record = StudyRecord::find(self, &member.client, id).await?;
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
                .and_then(Result::ok)
                .unwrap_or_default();
            let read =
                blocking(move || Study::parse(document.as_bytes(), &Run::unattended())).await;
            let Ok(read) = read else {
                return Ok(());
            };
            match read {
                Ok(study) => {
                    info!(study = %id, expanded = record.expanded, designs = record.total, "study resumed");
                    let whose = (client, record.submitted_by.clone());
                    let owner = self.owner(&study, id, whose, record.submitted_at);
                    let expanded = usize::try_from(record.expanded).unwrap_or(usize::MAX);
                    self.continue_in_background(study, expanded, owner);
                }
                // An earlier version accepted it; its rows are kept.
                Err(problem) => {
                    error!(study = %id, %problem, "a study is no longer understood, and cancelled");
                    let now = self.clock.now();
                    self.store.cancel_study(&client, id, By::Owner, now).await?;
                    self.dismiss_designs(id).await?;
                }
            }
        }
        Ok(())
    }

    fn continue_in_background(&self, study: Study, expanded: usize, owner: Owner) {
        let jobs = self.clone();
        spawn(async move {
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
            (study, rows, owner) = expand(study, expanded, owner, self.stop().clone()).await?;
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
            // A write that a full disk refuses is repeated; the study goes on.
            let stands = match stands {
                Err(error) if error.may_pass() => {
                    self.wait_for_storage().await;
                    continue;
                }
                stands => stands?,
            };
            if !stands {
                // The study is cancelled or deleted; or a commit that was reported as failed has lasted.
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

    /// The study that was found, as it was sent, JSON.
    ///
    /// # Errors
    ///
    /// [`JobError::StudyNotFound`] if it has been deleted since, [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn study_text(&self, id: Uuid) -> Result<String, JobError> {
        let text = self.store.study_text(id, u64::MAX).await?;
        Ok(text.ok_or(JobError::StudyNotFound(id))??)
    }

    /// The number of bytes of that.
    ///
    /// # Errors
    ///
    /// The same.
    pub async fn study_text_bytes(&self, id: Uuid) -> Result<u64, JobError> {
        let bytes = self.store.study_text_bytes(id).await?;
        let bytes = bytes.ok_or(JobError::StudyNotFound(id))?;
        Ok(u64::try_from(bytes).unwrap_or_default())
    }

    /// The text, if it has no more characters than `most`.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn short_study_text(&self, id: Uuid, most: u64) -> Result<Option<String>, JobError> {
        Ok(self.store.study_text(id, most).await?.transpose()?)
    }

    /// Dismisses the waiting and running jobs of a cancelled study, some at a time. The next process goes on where this one stops.
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
}

impl Resource for StudyRecord {
    type Filter = StudyFilter;

    async fn find(jobs: &Jobs, client: &str, id: Uuid) -> Result<Self, JobError> {
        let found = jobs.store.find_study(client, id).await?;
        found.ok_or(JobError::StudyNotFound(id))
    }

    async fn wait(
        jobs: &Jobs,
        client: &str,
        id: Uuid,
        patience: Duration,
    ) -> Result<Self, JobError> {
        /// Between two looks: the jobs of a study end much faster than anybody wants to know.
        const PAUSE: Duration = Duration::from_millis(50);
        let look = || Self::find(jobs, client, id);
        let ended = async {
            let mut news = jobs.news(id);
            loop {
                let study = look().await?;
                if study.status().has_ended() {
                    return Ok(study);
                }
                news.changed_state().await;
                tokio::time::sleep(PAUSE).await;
            }
        };
        tokio::select! {
            study = ended => study,
            () = tokio::time::sleep(patience) => look().await,
            () = jobs.stop().cancelled() => look().await,
        }
    }

    async fn list(
        jobs: &Jobs,
        client: &str,
        filter: &StudyFilter,
        limit: u32,
    ) -> Result<Listed<Self>, JobError> {
        let found = jobs.store.list_studies(client, filter, limit + 1).await?;
        Ok(Listed::first(found, limit, |study| study.sequence))
    }

    async fn owner(jobs: &Jobs, id: Uuid) -> Result<Option<String>, JobError> {
        Ok(jobs.store.owner_of_study(id).await?)
    }

    async fn cancel(jobs: &Jobs, client: &str, id: Uuid, by: By) -> Result<Self, JobError> {
        let now = jobs.clock.now();
        let cancelled = jobs.store.cancel_study(client, id, by, now).await?;
        let study = Self::find(jobs, client, id).await?;
        if !cancelled && study.cancelled_at.is_none() {
            return Err(JobError::StudyEnded(study.status()));
        }
        let own = jobs.clone();
        // A hundred thousand jobs take some seconds, and the client may go away meanwhile.
        let dismissed = spawn(async move { own.dismiss_designs(id).await });
        dismissed.await.map_err(|_| JobError::ShuttingDown)??;
        Self::find(jobs, client, id).await
    }

    async fn delete(jobs: &Jobs, client: &str, id: Uuid, by: By) -> Result<(), JobError> {
        let now = jobs.clock.now();
        if jobs.store.delete_study(client, id, by, now).await? {
            jobs.live.mail.notify_one();
            jobs.live.changed(id);
            return Ok(());
        }
        Self::find(jobs, client, id).await?;
        Err(JobError::StudyRunning)
    }

    fn status(&self) -> Status {
        self.status()
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

/// The first rows of a study. They are no longer made when its request has ended.
async fn begun(study: Study, owner: Owner) -> Result<Expanded, JobError> {
    let client = owner.client.clone();
    let made = beside_requests(&client, move |stop| {
        let goes_on = || !stop.load(Ordering::Relaxed);
        let (rows, search) = if study.is_search() {
            searches::begun(&study, &owner, goes_on)
        } else {
            let designs = (0..).map_while(|row| study.design(row));
            (chunk(designs, &owner, goes_on), None)
        };
        Expanded {
            study,
            rows,
            search,
            owner,
        }
    });
    made.await.map_err(not_done)
}
