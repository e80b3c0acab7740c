//! Searches: studies that choose their rows generation by generation, from the outcomes of earlier ones.
//!
//! A search is a function of its document and of its rows. Who takes one over, after a crash or in another process, is given the rows that stand
//! and goes on; two that did so at once would write the same rows, of which the table takes one.

use std::sync::Arc;
use std::time::Duration;

use meshwright_store::{NewRow, SearchStep, StudyRecord};
use meshwright_studies::{Design, RowState, Searching, Study};

use super::designs::{CHUNK, Owner, blocking, chunk};
use super::error::JobError;
use super::queue::Jobs;

/// Between two looks at rows of which nothing is heard.
const PATIENCE: Duration = Duration::from_secs(5);

/// Rows to be computed: where they begin, where they end, and how each is made.
struct Wanted<'a> {
    first: u64,
    end: u64,
    search: &'a Arc<Searching>,
    /// The best design once more, in place of those that the search asked for.
    confirmed: Option<Design>,
}

impl Jobs {
    /// Goes on with a search until its end, or until it is cancelled, or the service stops.
    pub(super) async fn search_on(&self, study: Study, owner: Owner) -> Result<(), JobError> {
        let owner = Arc::new(owner);
        let Some(mut search) = Searching::new(study) else {
            return Ok(());
        };
        loop {
            let Some(record) = self.unended(&owner).await? else {
                return Ok(());
            };
            let stands = record.expanded > search.rows();
            let is_over = if stands {
                self.is_confirmed(&owner, search.rows()).await?
            } else {
                self.is_out_of_time(&record, &search)
            };
            if is_over {
                break;
            }
            let count;
            (search, count) = blocking(move || {
                let count = search.ask();
                (search, count)
            })
            .await?;
            if count == 0 {
                break;
            }
            let first = search.rows();
            let end = first + count as u64;
            let step = step_of(&search, None);
            let shared = Arc::new(search);
            let wanted = Wanted {
                first,
                end,
                search: &shared,
                confirmed: None,
            };
            if !self.look_at(&owner, wanted, &step).await? {
                return Ok(());
            }
            let Some(own) = Arc::into_inner(shared) else {
                return Ok(());
            };
            search = self.tell(own, &owner, end).await?;
        }
        search.end();
        self.confirm(search, &owner).await
    }

    /// Reports the outcomes of the rows up to `end` to a search.
    async fn tell(
        &self,
        mut search: Searching,
        owner: &Owner,
        end: u64,
    ) -> Result<Searching, JobError> {
        while search.rows() < end {
            let rows = self.rows_between(owner, search.rows(), end).await?;
            if rows.is_empty() {
                return Err(JobError::StudyNotFound(owner.study));
            }
            search = blocking(move || {
                rows.into_iter().for_each(|row| search.tell(row));
                search
            })
            .await?;
        }
        Ok(search)
    }

    /// Has the best design computed once more, and ends the search.
    async fn confirm(&self, search: Searching, owner: &Arc<Owner>) -> Result<(), JobError> {
        let mut end = search.rows();
        let confirmation = search.confirmation();
        let shared = Arc::new(search);
        if confirmation.is_some() {
            let first = end;
            end += 1;
            // One row beyond the last: a study ends with its last row, and this one shows its outcome.
            let step = step_of(&shared, Some(end + 1));
            let wanted = Wanted {
                first,
                end,
                search: &shared,
                confirmed: confirmation,
            };
            if !self.look_at(owner, wanted, &step).await? {
                return Ok(());
            }
        }
        let Some(mut search) = Arc::into_inner(shared) else {
            return Ok(());
        };
        if let Some(row) = self.rows_between(owner, search.rows(), end).await?.first() {
            search.confirm(row);
        }
        let step = step_of(&search, Some(end));
        self.write(owner, end, &[], &step).await?;
        self.live.changed(owner.study);
        Ok(())
    }

    /// Has rows computed; false if they are not wanted any more.
    async fn look_at(
        &self,
        owner: &Arc<Owner>,
        wanted: Wanted<'_>,
        step: &SearchStep,
    ) -> Result<bool, JobError> {
        let mut news = self.news(owner.study);
        loop {
            let Some(record) = self.unended(owner).await? else {
                return Ok(false);
            };
            if record.expanded < wanted.end {
                let missing = (record.expanded - wanted.first) as usize;
                let rows = match &wanted.confirmed {
                    Some(design) => {
                        let (design, owner) = (design.clone(), Arc::clone(owner));
                        blocking(move || vec![owner.row(design)]).await?
                    }
                    None => {
                        let last = (wanted.end - wanted.first) as usize;
                        let (search, owner) = (Arc::clone(wanted.search), Arc::clone(owner));
                        let stop = self.stop().clone();
                        blocking(move || {
                            let designs = (missing..last).map(|row| search.design(row));
                            chunk(designs, &owner, || !stop.is_cancelled())
                        })
                        .await?
                    }
                };
                // The next look shows whether it was written.
                self.write(owner, record.expanded, &rows, step).await?;
                self.live.ring();
                self.live.changed(owner.study);
                continue;
            }
            if record.done() >= wanted.end {
                return Ok(true);
            }
            tokio::select! {
                () = news.changed_state() => {}
                () = tokio::time::sleep(PATIENCE) => self.store.hold_study(owner.study, self.clock.steady()).await?,
                () = self.stop().cancelled() => return Ok(false),
            }
        }
    }

    /// Adds rows behind the first `expanded` ones; what a full disk refuses is added later.
    async fn write(
        &self,
        owner: &Owner,
        expanded: u64,
        rows: &[NewRow],
        step: &SearchStep,
    ) -> Result<(), JobError> {
        while !self.stop().is_cancelled() {
            let now = self.clock.now();
            let written = self.store.continue_study(
                owner.study,
                expanded,
                rows,
                Some(step),
                now,
                self.bounds(),
            );
            match written.await {
                Err(error) if error.may_pass() => self.wait_for_storage().await,
                written => {
                    written?;
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    /// The study, if it goes on.
    async fn unended(&self, owner: &Owner) -> Result<Option<StudyRecord>, JobError> {
        if self.stop().is_cancelled() {
            return Ok(None);
        }
        let found = self.store.find_study(&owner.client, owner.study).await?;
        Ok(found.filter(|study| study.cancelled_at.is_none()))
    }

    /// True while the best design is computed again: its row stands behind the first `rows` ones.
    async fn is_confirmed(&self, owner: &Owner, rows: u64) -> Result<bool, JobError> {
        let next = self.rows_between(owner, rows, rows + 1).await?;
        Ok(next
            .first()
            .is_some_and(|row| Searching::is_confirmation(&row.label)))
    }

    fn is_out_of_time(&self, record: &StudyRecord, search: &Searching) -> bool {
        let passed = self.clock.now().duration_since(record.submitted_at);
        search
            .seconds()
            .is_some_and(|seconds| passed.as_secs_f64() >= seconds)
    }

    /// Some rows from the place `first` on, none from `end` on.
    async fn rows_between(
        &self,
        owner: &Owner,
        first: u64,
        end: u64,
    ) -> Result<Vec<RowState>, JobError> {
        let mut rows = self.study_rows(owner.study, first, CHUNK as u32).await?;
        rows.truncate(end.saturating_sub(first) as usize);
        Ok(rows)
    }
}

/// The first rows of a search, with which it is taken, and how it stands then.
pub(super) fn begun(
    study: &Study,
    owner: &Owner,
    goes_on: impl Fn() -> bool,
) -> (Vec<NewRow>, Option<String>) {
    let Some(mut search) = Searching::new(study.clone()) else {
        return (Vec::new(), None);
    };
    let designs = (0..search.ask()).map(|row| search.design(row));
    let rows = chunk(designs, owner, goes_on);
    (rows, Some(step_of(&search, None).state))
}

fn step_of(search: &Searching, total: Option<u64>) -> SearchStep {
    let state = serde_json::to_string(&search.state()).expect("a state is plain data");
    SearchStep { total, state }
}
