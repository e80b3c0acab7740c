//! A study as the service computes it: by its queue, its workers and its tables, on a database that is gone afterwards.

use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, anyhow};
use meshwright_engine::library::Library;
use meshwright_studies::solve;
use meshwright_studies::{RowState, Study as StudyDocument};
use meshwright_wire::Kept;
use tokio_util::sync::CancellationToken;
use uuid::Uuid;

use super::folder::ResultFolder;
use super::tables::numbers;
use crate::commands::progress::Progress;
use crate::commands::serve::signal;
use crate::compute::Cores;
use crate::jobs::{
    Clock, DatabaseAddress, Jobs, Member, Migrate, Pace, Resource as _, Rules, StudyRecord,
    Workers, search_state,
};
use crate::serve::open;

/// Limit of the memory of the substructures that designs share, in bytes.
const LIBRARY_BYTES: usize = 256 << 20;

/// Time between two looks at the progress of the study.
const BETWEEN_LOOKS: Duration = Duration::from_millis(500);

/// Nobody else waits for a design here.
const TIME_LIMIT: Duration = Duration::from_secs(365 * 24 * 3600);

/// A study at its end.
pub(super) struct Computed {
    pub(super) record: StudyRecord,
    /// Every design, in the order of the study.
    pub(super) rows: Vec<RowState>,
}

/// Computes a study on all cores; results go to the folder as they come.
pub(super) fn compute(
    study: &StudyDocument,
    folder: Option<&ResultFolder>,
) -> anyhow::Result<Computed> {
    let runtime = crate::runtime::runtime()?;
    let computed = runtime.block_on(compute_on_database(study, folder));
    runtime.shutdown_background();
    computed
}

async fn compute_on_database(
    study: &StudyDocument,
    folder: Option<&ResultFolder>,
) -> anyhow::Result<Computed> {
    let beside = folder.map_or_else(std::env::temp_dir, |folder| folder.path().to_owned());
    let database = tempfile::Builder::new()
        .prefix(".study-")
        .tempdir_in(&beside);
    let database =
        database.with_context(|| format!("nothing can be written in {}", beside.display()))?;
    let store = open(
        &DatabaseAddress::File(database.path().join("study.db")),
        Migrate::Auto,
    )
    .await?;
    let stop = CancellationToken::new();
    let jobs = Jobs::new(
        store.clone(),
        Rules::of_machine(),
        Clock::system(),
        stop.clone(),
    );
    let library = Library::with_capacity(LIBRARY_BYTES);
    let solve = Arc::new(move |submission: &_, run: &_| solve(submission, &library, run));
    let pace = Pace::with_time_limit(TIME_LIMIT);
    let mut workers = Workers::beside(jobs.clone(), solve, Cores::here().workers(), pace).await?;

    let computed = tokio::select! {
        computed = follow(&jobs, study, folder) => computed,
        stop = signal() => Err(stop.err().unwrap_or_else(|| anyhow!("the study was stopped before its end"))),
    };
    stop.cancel();
    workers.ended().await;
    store.close().await;
    computed
}

/// Submits the study, and takes its rows and results as they come.
async fn follow(
    jobs: &Jobs,
    study: &StudyDocument,
    folder: Option<&ResultFolder>,
) -> anyhow::Result<Computed> {
    const CLIENT: &str = "study";
    let study = match folder {
        Some(_) => study.clone(),
        None => study.clone().keeping(Kept::Statistics),
    };
    let progress = Progress::of("designs");
    let total = study.total() as u64;
    let member = Member::usual(CLIENT);
    let submitted = jobs.submit_study(&member, study, None).await?;
    let id = submitted.record.id;
    let mut rows = Vec::new();
    let mut written = None;
    loop {
        let record = StudyRecord::wait(jobs, CLIENT, id, BETWEEN_LOOKS).await?;
        take_rows(jobs, id, &mut rows).await?;
        if let Some(folder) = folder {
            written = write_results(jobs, id, written, rows.len(), folder).await?;
        }
        let best = search_state(&record).and_then(|search| search.best);
        let best = best.map(|best| format!("best {}", numbers(&best.goals)));
        progress.tell(record.done(), total, &best.unwrap_or_default());
        if record.status().has_ended() {
            return Ok(Computed { record, rows });
        }
    }
}

/// Rows or documents read at a time.
const AT_ONCE: u32 = 100;

/// Takes the rows that have ended behind those that are here, up to the first one that has not.
async fn take_rows(jobs: &Jobs, id: Uuid, rows: &mut Vec<RowState>) -> anyhow::Result<()> {
    loop {
        let read = jobs.study_rows(id, rows.len() as u64, AT_ONCE).await?;
        let (before, count) = (rows.len(), read.len());
        let ended = read.into_iter().take_while(|row| row.status.has_ended());
        // The jobs are gone with the database.
        rows.extend(ended.map(|row| RowState { job: None, ..row }));
        if count == 0 || rows.len() < before + count {
            return Ok(());
        }
    }
}

/// Writes the results of the designs behind the place `written` and before the place `end`, and gives back the last place.
async fn write_results(
    jobs: &Jobs,
    id: Uuid,
    mut written: Option<i64>,
    end: usize,
    folder: &ResultFolder,
) -> anyhow::Result<Option<i64>> {
    loop {
        let lines = jobs.study_documents(id, written, AT_ONCE).await?;
        if lines.is_empty() {
            return Ok(written);
        }
        for line in lines {
            let row = usize::try_from(line.position)?;
            if row >= end {
                return Ok(written);
            }
            folder.write_result(row, &line.label, &line.document.text()?)?;
            written = Some(line.position);
        }
    }
}
