//! `meshwright study`: a study from a file, computed here and now.

use std::collections::HashMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use meshwright::wire::study_table::{TableRow, csv, table};
use meshwright::wire::warning::GearName;
use meshwright::wire::{
    Code, Design, Kept, PopulationResults, PopulationSample, Problem, RowState, SearchState,
    Searching, Status, Study as StudyDocument, StudyResults, Summary, solve,
};
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

use super::solve::{EXIT_PROBLEM, read, told};

/// What the substructures that designs share may take.
const LIBRARY_BYTES: usize = 256 << 20;

/// A printed table has so many designs at most; of more, only the best are printed.
const MOST_PRINTED: usize = 40;

/// Compute a study: many variants of one submission, and their table.
#[derive(Debug, clap::Args)]
pub(crate) struct Study {
    /// The study; - reads standard input.
    study: PathBuf,
    /// Where to write table.json, table.csv, of a population population.json, of a search search.json with how it went and best.json with the submission of the best design, and, unless the study keeps statistics only, each result; the folder is made if it
    /// is absent. Without it, only a short table is printed.
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// What of a design's results the table shows, or why there are none.
type Outcome = Result<Summary, Problem>;

impl Study {
    /// Runs the command.
    ///
    /// # Errors
    ///
    /// If a file cannot be read or written. A study that is refused, or none of whose designs can be computed, is exit
    /// code 2.
    pub(crate) fn run(&self) -> anyhow::Result<ExitCode> {
        let document = read(&self.study)?;
        let study = match StudyDocument::parse(&document, &Run::unattended()) {
            Ok(study) => study,
            Err(problem) => {
                eprint!("{}", told(&problem));
                return Ok(ExitCode::from(EXIT_PROBLEM));
            }
        };
        let folder = self.output.as_deref().map(ResultFolder::make).transpose()?;

        let started = Instant::now();
        let (rows, search) = match Searching::new(study.clone()) {
            Some(search) => {
                let (rows, state) = self::search(&study, search, folder.as_ref(), started)?;
                (rows, Some(state))
            }
            None => (compute(&study, folder.as_ref())?, None),
        };
        let elapsed = started.elapsed();

        let population = population(&study, &rows);
        let best = search.as_ref().and_then(|search| {
            let row = rows.get(usize::try_from(search.best.as_ref()?.row).ok()?)?;
            study.submission_searched(&row.label, &row.changes)
        });
        let results = results(&study, rows, search.as_ref());
        if let Some(folder) = &folder {
            let json = serde_json::to_string_pretty(&results).context("the table is no JSON")?;
            folder.write("table.json", &format!("{json}\n"))?;
            folder.write("table.csv", &csv(&results.rows))?;
            if let Some(population) = &population {
                let json = serde_json::to_string_pretty(population)
                    .context("the population is no JSON")?;
                folder.write("population.json", &format!("{json}\n"))?;
            }
        }
        if let Some(search) = &search {
            if let Some(folder) = &folder {
                let json = serde_json::to_string_pretty(search).context("the search is no JSON")?;
                folder.write("search.json", &format!("{json}\n"))?;
                if let Some(best) = &best {
                    folder.write("best.json", &format!("{best}\n"))?;
                }
            }
            print!("{}", search_table(&study, search, elapsed));
            return Ok(match &results.problem {
                Some(_) => ExitCode::from(EXIT_PROBLEM),
                None => ExitCode::SUCCESS,
            });
        }
        match &population {
            Some(population) => print!("{}", spread_table(population, elapsed)),
            None => print!("{}", short_table(&results, elapsed)),
        }
        if let Some(problem) = &results.problem {
            eprintln!("{}", problem["detail"].as_str().unwrap_or_default());
            return Ok(ExitCode::from(EXIT_PROBLEM));
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// Computes a search to its end: its rows, and what is told of it.
fn search(
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

/// Some numbers as they are shown.
fn numbers(values: &[Option<f64>]) -> String {
    let told = values
        .iter()
        .map(|value| value.map_or_else(|| "?".to_owned(), |value| format!("{value:.4}")));
    told.collect::<Vec<_>>().join(", ")
}

/// So many designs are held at a time. Equal ones among them are computed once.
const AT_ONCE: usize = 2_000;

/// Computes every design on all cores, and writes each result as it comes.
fn compute(study: &StudyDocument, folder: Option<&ResultFolder>) -> anyhow::Result<Vec<RowState>> {
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
        let document = designs[equal[0]]
            .submission
            .as_ref()
            .map_err(Problem::clone)
            .and_then(|submission| solve(submission, library, &Run::unattended()));
        if let (Some(folder), Ok(document)) = (folder, &document) {
            for &i in equal {
                folder.write_result(first + i, &designs[i].label, document)?;
            }
        }
        bar.inc(equal.len() as u64);
        // Documents go to the disk; in memory thousands of them would be too many.
        Ok(document.map(|document| Summary::of_document(&document).unwrap_or_default()))
    };
    let solved = on_every_core(&work, one)?;

    let mut outcomes: Vec<Option<Outcome>> = vec![None; count];
    for (equal, outcome) in work.iter().zip(solved) {
        for &i in equal {
            outcomes[i] = Some(outcome.clone());
        }
    }
    Ok(designs
        .into_iter()
        .zip(outcomes)
        .map(|(design, outcome)| row_state(design, outcome))
        .collect())
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

/// What the members of a population come to; none where the designs are none.
fn population(study: &StudyDocument, rows: &[RowState]) -> Option<PopulationResults> {
    let mut sample = PopulationSample::new(study, 0..StudyDocument::MOST_TORQUES)?;
    for (member, row) in (0..).zip(rows) {
        sample.add(member, row);
    }
    let failed = rows.iter().all(|row| row.status == Status::Failed);
    Some(sample.results(None, ended(failed)))
}

fn ended(failed: bool) -> Status {
    if failed {
        Status::Failed
    } else {
        Status::Successful
    }
}

fn row_state(design: Design, outcome: Option<Outcome>) -> RowState {
    let (summary, problem) = match (design.submission, outcome) {
        (Ok(_), Some(Ok(summary))) => (Some(summary), None),
        (Ok(_), Some(Err(problem))) | (Err(problem), _) => (None, Some(problem)),
        (Ok(_), None) => (
            None,
            Some(Problem::new(
                Code::InternalError,
                "The design was not computed.",
            )),
        ),
    };
    RowState {
        label: design.label,
        changes: design.changes,
        job: None,
        status: if summary.is_some() {
            Status::Successful
        } else {
            Status::Failed
        },
        summary,
        problem: problem.map(|problem| {
            serde_json::to_value(problem).expect("a problem is strings and finite numbers")
        }),
    }
}

fn results(
    study: &StudyDocument,
    states: Vec<RowState>,
    search: Option<&SearchState>,
) -> StudyResults {
    let rows = table(study.gear(), states);
    let failed = rows.iter().all(|row| row.status == Status::Failed);
    let problem = failed.then(|| {
        let searched = search.and_then(SearchState::why_nothing);
        let detail = searched.unwrap_or_else(|| {
            format!(
                "None of the {} designs could be computed; each row of the table has its problem.",
                rows.len()
            )
        });
        serde_json::to_value(Problem::new(Code::NoDesignComputed, detail))
            .expect("a problem is strings")
    });
    StudyResults {
        id: None,
        status: ended(failed),
        done: rows.len() as u64,
        total: rows.len() as u64,
        gear: study.gear(),
        problem,
        rows,
    }
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

/// Where results are written.
struct ResultFolder(PathBuf);

impl ResultFolder {
    fn make(path: &Path) -> anyhow::Result<Self> {
        let results = path.join("results");
        fs::create_dir_all(&results)
            .with_context(|| format!("{} cannot be made", results.display()))?;
        Ok(Self(path.to_owned()))
    }

    fn write(&self, name: &str, text: &str) -> anyhow::Result<()> {
        let path = self.0.join(name);
        fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
    }

    /// Writes a results document under the number of its row, from 1, and as much of its label as a file name bears.
    fn write_result(&self, row: usize, label: &str, document: &str) -> anyhow::Result<()> {
        let plain = |c: char| {
            if c.is_ascii_alphanumeric() || ".-=".contains(c) {
                c
            } else {
                '_'
            }
        };
        let label: String = label.chars().map(plain).take(60).collect();
        self.write(&format!("results/{:05}-{label}.json", row + 1), document)
    }
}

/// What a search found: the best design, of two goals the front, and what the best one comes to by the flexible method on the fine grid.
fn search_table(study: &StudyDocument, search: &SearchState, elapsed: Duration) -> String {
    let mut text = String::new();
    let names = study.goals().join(", ");
    let conditions = study.conditions().join(", ");
    let mut say = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    match &search.best {
        None => say(search
            .why_nothing()
            .unwrap_or_else(|| "No design could be had.".to_owned())),
        Some(best) => {
            say(format!(
                "best: row {}, {names}: {}",
                best.row,
                numbers(&best.goals)
            ));
            if !best.feasible {
                say(
                    "  It does not keep every condition; no design that was looked at does."
                        .to_owned(),
                );
            }
            for (path, value) in &best.values {
                say(format!("  {path} = {value}"));
            }
            if !best.conditions.is_empty() {
                say(format!("  {conditions}: {}", numbers(&best.conditions)));
            }
        }
    }
    if search.front.len() > 1 {
        say(format!("front of {} designs, {names}:", search.front.len()));
        for design in &search.front {
            let values = design.values.values().map(ToString::to_string);
            let values = values.collect::<Vec<_>>().join(", ");
            say(format!("  {}  at {values}", numbers(&design.goals)));
        }
    }
    if let Some(confirmed) = &search.confirmed {
        let goals = numbers(&confirmed.goals);
        match &confirmed.error_estimate {
            Some(estimate) => say(format!(
                "by the flexible method on the fine grid: {goals}; another grid level changes the peak-to-peak value by {:.4} um, the mean by {:.4} um",
                estimate.transmission_error_peak_to_peak_um, estimate.transmission_error_mean_um
            )),
            None => {
                let problem = confirmed.problem.as_ref();
                let detail = problem.and_then(|problem| problem["detail"].as_str());
                say(format!("not confirmed: {}", detail.unwrap_or_default()));
            }
        }
    }
    for refusal in &search.refusals {
        say(format!(
            "{} designs refused, {}; the first: {}",
            refusal.count, refusal.code, refusal.detail
        ));
    }
    say(format!(
        "{} designs in {} generations, {:.2} s.",
        search.evaluations,
        search.generations.len(),
        elapsed.as_secs_f64()
    ));
    text
}

/// A line for each quantity of a population and each torque, and what makes the peak-to-peak values vary.
fn spread_table(results: &PopulationResults, elapsed: Duration) -> String {
    const SHOWN: [&str; 4] = [
        "transmission_error_um.peak_to_peak",
        "transmission_error_um.mean",
        "mesh_stiffness_tangent_n_per_m.mean",
        "mesh_order_um",
    ];
    let mut text = format!(
        "{:38} {:>8} {:>10} {:>10} {:>10} {:>10} {:>10}  {}\n",
        "quantity", "torque", "mean", "std", "p5", "p50", "p95", "95 % limits of p95"
    );
    let told = |value: f64| {
        if value.abs() < 1e5 {
            format!("{value:.3}")
        } else {
            format!("{value:.3e}")
        }
    };
    let limit = |value: Option<f64>| value.map_or_else(|| "?".to_owned(), told);
    let shown = || {
        let all = results.quantities.iter();
        all.filter(|quantity| SHOWN.contains(&quantity.name))
    };
    for quantity in shown() {
        let percentile = |percent: f64| {
            let mut all = quantity.percentiles.iter();
            all.find(|percentile| percentile.percent == percent)
        };
        let value =
            |percent| percentile(percent).map_or_else(String::new, |found| told(found.value));
        let limits = percentile(95.0).map_or_else(String::new, |found| {
            format!("{} to {}", limit(found.low), limit(found.high))
        });
        let torque = quantity.output_torque_n_m.map(|torque| torque.to_string());
        text.push_str(&format!(
            "{:38} {:>8} {:>10} {:>10} {:>10} {:>10} {:>10}  {limits}\n",
            quantity.name,
            torque.unwrap_or_default(),
            told(quantity.mean),
            told(quantity.standard_deviation),
            value(5.0),
            value(50.0),
            value(95.0),
        ));
    }
    for quantity in shown().filter(|quantity| quantity.name == SHOWN[0]) {
        let torque = quantity.output_torque_n_m.unwrap_or_default();
        for influence in &quantity.influences {
            let input = match (&influence.path, influence.accuracy) {
                (Some(path), _) => path.clone(),
                (None, Some(GearName::Driving)) => "the teeth of the driving gear".to_owned(),
                (None, _) => "the teeth of the driven gear".to_owned(),
            };
            text.push_str(&format!(
                "At {torque} N m {:.0} % of the variance of the peak-to-peak value come from {input}.\n",
                100.0 * influence.share
            ));
        }
    }
    let seconds = elapsed.as_secs_f64();
    text.push_str(&format!(
        "{} of {} members computed in {seconds:.2} s, {:.1} a second.\n",
        results.done - results.failed,
        results.size,
        (results.done - results.failed) as f64 / seconds.max(1e-9),
    ));
    text
}

/// A line for each design and torque, or for the best designs of a large study, and what could not be computed.
fn short_table(results: &StudyResults, elapsed: Duration) -> String {
    let computed: Vec<&TableRow> = results
        .rows
        .iter()
        .filter(|row| !row.curves.is_empty())
        .collect();
    let all = computed.len() <= MOST_PRINTED;
    let shown: Vec<&TableRow> = computed
        .iter()
        .copied()
        .filter(|row| all || row.pareto)
        .take(MOST_PRINTED)
        .collect();
    let width = shown
        .iter()
        .map(|row| row.label.chars().count())
        .max()
        .unwrap_or(0)
        .clamp(6, 60);
    let mut text = format!(
        "{:width$}  {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}  best\n{:width$}  {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}\n",
        "design",
        "mass",
        "torque",
        "STE",
        "rms",
        "p-p",
        "stiffness",
        "H_N",
        "H_Z2",
        "",
        "kg",
        "N m",
        "um",
        "um",
        "um",
        "N/m",
        "um",
        "um",
    );
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    for row in &shown {
        for (i, curve) in row.curves.iter().enumerate() {
            let (label, mass, mark) = if i == 0 {
                (
                    &*row.label,
                    number(row.mass_kg, 4),
                    if row.pareto { "*" } else { "" },
                )
            } else {
                ("", String::new(), "")
            };
            let ste = curve.statistics.as_ref().map(|s| &s.transmission_error_um);
            let k = curve
                .statistics
                .as_ref()
                .map(|s| &s.mesh_stiffness_tangent_n_per_m);
            let line = format!(
                "{label:width$}  {mass:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8}  {mark}",
                curve.output_torque_n_m,
                number(ste.map(|s| s.mean), 3),
                number(ste.map(|s| s.rms), 3),
                number(ste.map(|s| s.peak_to_peak), 3),
                k.map_or_else(|| "-".to_owned(), |k| format!("{:.3e}", k.mean)),
                number(curve.hole_order_um, 4),
                number(curve.mesh_order_um, 4),
            );
            text.push_str(line.trim_end());
            text.push('\n');
        }
    }
    if !all {
        text.push_str(&format!(
            "{} of {} designs are shown: those that no other one beats in mass, peak-to-peak and stiffness at once.\n",
            shown.len(),
            computed.len()
        ));
    }
    let failed: Vec<&TableRow> = results
        .rows
        .iter()
        .filter(|row| row.problem.is_some())
        .collect();
    for row in failed.iter().take(MOST_PRINTED) {
        let detail = row
            .problem
            .as_ref()
            .and_then(|problem| problem["detail"].as_str());
        text.push_str(&format!("{}: {}\n", row.label, detail.unwrap_or_default()));
    }
    let seconds = elapsed.as_secs_f64();
    text.push_str(&format!(
        "{} of {} designs computed in {seconds:.2} s, {:.1} a second.\n",
        computed.len(),
        results.total,
        computed.len() as f64 / seconds.max(1e-9),
    ));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn study() -> StudyDocument {
        let mut study: Value =
            serde_json::from_str(meshwright::wire::examples::STUDY_SECTION_5).unwrap();
        // The formulas do not see holes, but they are quick.
        study["base"]["method"] = json!("load_distribution");
        let designs = study["designs"].as_array_mut().unwrap();
        designs.push(json!({ "label": "8R34 again", "changes": designs[1]["changes"] }));
        designs.push(json!({ "label": "14R34", "changes": {
            "/pair/driven/blank/holes": { "count": 14, "circle_radius_mm": 45 } } }));
        StudyDocument::parse(study.to_string().as_bytes(), &Run::unattended()).unwrap()
    }

    #[test]
    fn a_study_leaves_its_table_and_every_result() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let results = results(
            &study(),
            compute(&study(), Some(&ResultFolder::make(&path).unwrap())).unwrap(),
            None,
        );
        let labels: Vec<&str> = results.rows.iter().map(|row| &*row.label).collect();
        assert_eq!(
            labels,
            [
                "standard",
                "8R34",
                "10R34",
                "6R30",
                "8R30",
                "8R27",
                "8R34 again",
                "14R34"
            ]
        );
        assert_eq!(results.rows[1].curves, results.rows[6].curves);
        assert_eq!(results.rows[7].status, Status::Failed);
        assert_eq!(
            results.rows[7].problem.as_ref().unwrap()["code"],
            "holes_breach_rim"
        );
        let files = fs::read_dir(path.join("results")).unwrap().count();
        assert_eq!(files, 7);
        assert!(path.join("results/00002-8R34.json").exists());

        assert_eq!(population(&study(), &[]), None);
        let text = short_table(&results, Duration::from_secs(2));
        assert!(
            text.contains("7 of 8 designs computed in 2.00 s, 3.5 a second."),
            "{text}"
        );
        assert!(text.contains("14R34: "), "{text}");
    }
    #[test]
    fn a_population_leaves_what_its_members_come_to() {
        let mut document: Value =
            serde_json::from_str(meshwright::wire::examples::STUDY_SECTION_5).unwrap();
        document["base"]["method"] = json!("load_distribution");
        document.as_object_mut().unwrap().remove("designs");
        document.as_object_mut().unwrap().remove("constant_mass");
        document["population"] = json!({ "size": 80, "vary": [
            { "path": "/pair/center_distance_mm", "kind": "uniform", "low": 100.45, "high": 100.55 }
        ] });
        let study =
            StudyDocument::parse(document.to_string().as_bytes(), &Run::unattended()).unwrap();
        let rows = compute(&study, None).unwrap();
        let found = population(&study, &rows).expect("a population");
        assert_eq!((found.size, found.done, found.failed), (80, 80, 0));
        let text = spread_table(&found, Duration::from_secs(2));
        assert!(
            text.contains("80 of 80 members computed in 2.00 s, 40.0 a second."),
            "{text}"
        );
        assert!(
            text.contains(
                "% of the variance of the peak-to-peak value come from /pair/center_distance_mm."
            ),
            "{text}"
        );
    }
}
