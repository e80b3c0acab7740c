//! The designs of a study, computed on every core.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use meshwright::wire::{
    Code, Design, Kept, Problem, RowState, SearchState, Searching, Study as StudyDocument, Summary,
    solve,
};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use super::folder::ResultFolder;
use super::tables::numbers;

/// What the substructures that designs share may take.
const LIBRARY_BYTES: usize = 256 << 20;

/// So many designs are held at a time. Equal ones among them are computed once.
const AT_ONCE: usize = 2_000;

/// What of a design's results the table shows, or why there are none.
type Outcome = Result<Summary, Problem>;

/// Computes every design on all cores, and writes each result as it comes.
pub(super) fn compute(
    study: &StudyDocument,
    folder: Option<&ResultFolder>,
) -> anyhow::Result<Vec<RowState>> {
    // What is kept of a study is the same here.
    let folder = folder.filter(|_| study.keep() == Kept::Results);
    let total = study.total();
    let bar = progress_bar(total);
    let library = Library::with_capacity(LIBRARY_BYTES);
    let mut states = Vec::with_capacity(total);
    for first in (0..total).step_by(AT_ONCE) {
        let rows = first..total.min(first + AT_ONCE);
        states.extend(compute_some(study, rows, folder, &library, &bar)?);
    }
    bar.finish_and_clear();
    Ok(states)
}

fn compute_some(
    study: &StudyDocument,
    rows: Range<usize>,
    folder: Option<&ResultFolder>,
    library: &Library,
    bar: &ProgressBar,
) -> anyhow::Result<Vec<RowState>> {
    let first = rows.start;
    let designs: Vec<Design> = rows
        .into_par_iter()
        .filter_map(|row| study.design(row))
        .collect();
    compute_designs(first, designs, folder, library, bar)
}

/// Computes designs that stand behind the first ones of the table; equal ones are computed once.
fn compute_designs(
    first: usize,
    designs: Vec<Design>,
    folder: Option<&ResultFolder>,
    library: &Library,
    bar: &ProgressBar,
) -> anyhow::Result<Vec<RowState>> {
    let count = designs.len();
    // Designs by what they compute; the first of equals computes for all.
    let mut equals: HashMap<String, Vec<usize>> = HashMap::new();
    for (i, design) in designs.iter().enumerate() {
        if let Ok(submission) = &design.submission {
            equals.entry(submission.input_hash()).or_default().push(i);
        }
    }
    let mut work: Vec<Vec<usize>> = equals.into_values().collect();
    // In the order of the study, in which neighbors share most.
    work.sort_unstable();

    bar.inc((count - work.iter().map(Vec::len).sum::<usize>()) as u64);
    let one = |equal: &Vec<usize>| -> anyhow::Result<Outcome> {
        let results = designs[equal[0]]
            .submission
            .as_ref()
            .map_err(Problem::clone)
            .and_then(|submission| solve(submission, library, &Run::unattended()));
        if let (Some(folder), Ok(results)) = (folder, &results) {
            let document = results.to_json()?;
            for &i in equal {
                folder.write_result(first + i, &designs[i].label, &document)?;
            }
        }
        bar.inc(equal.len() as u64);
        // Results go to the disk; in memory thousands of them would be too many.
        Ok(results.and_then(|results| Summary::of(&results)))
    };
    let solved = on_every_core(&work, one)?;

    let uncomputed = Problem::new(Code::InternalError, "The design was not computed.");
    let mut outcomes: Vec<Outcome> = vec![Err(uncomputed); count];
    for (equal, outcome) in work.iter().zip(solved) {
        for &i in equal {
            outcomes[i] = outcome.clone();
        }
    }
    let rows = designs.into_iter().zip(outcomes).map(|(design, outcome)| {
        let outcome = design.submission.and(outcome);
        RowState::computed(design.label, design.changes, outcome)
    });
    Ok(rows.collect())
}

/// Does each piece of work on a core of its own: in one pool for all, a core that waits for a part of one design would begin another one meanwhile,
/// and another one in that, as long as the memory lasts.
fn on_every_core<W: Sync, T: Send>(
    work: &[W],
    each: impl Fn(&W) -> anyhow::Result<T> + Sync,
) -> anyhow::Result<Vec<T>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let take = || {
        let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(piece) = work.get(i) else {
                return anyhow::Ok(done);
            };
            done.push((i, pool.install(|| each(piece))?));
        }
    };
    let parts = thread::scope(|scope| {
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(take)).collect();
        let ended = workers.into_iter().map(|worker| match worker.join() {
            Ok(done) => done,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        ended.collect::<anyhow::Result<Vec<_>>>()
    })?;
    let mut done: Vec<(usize, T)> = parts.into_iter().flatten().collect();
    done.sort_by_key(|(i, _)| *i);
    Ok(done.into_iter().map(|(_, done)| done).collect())
}

fn progress_bar(total: usize) -> ProgressBar {
    let bar = ProgressBar::new(total as u64);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:40} {pos}/{len} designs, {elapsed}, {eta} to go  {msg}")
    {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Computes a search to its end: its rows, and what is told of it.
pub(super) fn search(
    study: &StudyDocument,
    mut search: Searching,
    folder: Option<&ResultFolder>,
    started: Instant,
) -> anyhow::Result<(Vec<RowState>, SearchState)> {
    let folder = folder.filter(|_| study.keep() == Kept::Results);
    let bar = progress_bar(study.total());
    let library = Library::with_capacity(LIBRARY_BYTES);
    let mut rows: Vec<RowState> = Vec::new();
    let is_over = |search: &Searching| {
        let seconds = search.seconds();
        seconds.is_some_and(|seconds| started.elapsed().as_secs_f64() >= seconds)
    };
    while !is_over(&search) {
        let count = search.ask();
        if count == 0 {
            break;
        }
        let mut generation = Vec::with_capacity(count);
        for first in (0..count).step_by(AT_ONCE) {
            let places = first..count.min(first + AT_ONCE);
            let designs: Vec<Design> = places
                .into_par_iter()
                .map(|row| search.design(row))
                .collect();
            let place = rows.len() + first;
            generation.extend(compute_designs(place, designs, folder, &library, &bar)?);
        }
        for row in generation {
            search.tell(row.clone());
            rows.push(row);
        }
        if let Some(best) = search.state().best {
            bar.set_message(format!("best {}", numbers(&best.goals)));
        }
    }
    search.end();
    if let Some(design) = search.confirmation() {
        let confirmed = compute_designs(rows.len(), vec![design], folder, &library, &bar)?;
        confirmed.iter().for_each(|row| search.confirm(row));
        rows.extend(confirmed);
    }
    bar.finish_and_clear();
    Ok((rows, search.state()))
}
