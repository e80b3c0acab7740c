//! Tables of a study for the terminal.

use std::time::Duration;

use meshwright_studies::refusals::{RefusalState, Refusals};
use meshwright_studies::table::TableRow;
use meshwright_studies::{PopulationResults, SearchState, Study as StudyDocument, StudyResults};
use meshwright_wire::warning::GearName;

/// A printed table has so many designs at most; of more, only the best are printed.
const MOST_PRINTED: usize = 40;

/// Some numbers as they are shown.
pub(super) fn numbers(values: &[Option<f64>]) -> String {
    let values = values
        .iter()
        .map(|value| value.map_or_else(|| "?".to_owned(), |value| format!("{value:.4}")));
    values.collect::<Vec<_>>().join(", ")
}

/// The result of a search: the best design, or the front of two goals, and the best one computed again on the fine grid.
pub(super) fn search_table(
    study: &StudyDocument,
    search: &SearchState,
    elapsed: Duration,
) -> String {
    let mut text = String::new();
    let names = study.goals().join(", ");
    let conditions = study.conditions().join(", ");
    let confirmed = search.confirmed.as_ref();
    let failed = confirmed.filter(|confirmed| confirmed.feasible == Some(false));
    let mut say = |line: String| {
        text.push_str(line.trim_end());
        text.push('\n');
    };
    if let Some(confirmed) = failed {
        say(match &confirmed.problem {
            Some(problem) => format!(
                "NOT FEASIBLE: the best design has no results on the fine grid: {}",
                problem["detail"].as_str().unwrap_or_default()
            ),
            None => format!(
                "NOT FEASIBLE: on the fine grid the best design does not keep {}: {}",
                if conditions.is_empty() {
                    "its goals"
                } else {
                    &conditions
                },
                numbers(&confirmed.conditions)
            ),
        });
    }
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
            if !best.feasible && failed.is_none() {
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
            if let Some(share) = best.failed_share.filter(|share| *share > 0.0) {
                say(format!(
                    "  {:.1} % of its members have no results, and count as beyond every bound",
                    100.0 * share
                ));
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
    if let Some(confirmed) = confirmed {
        // Percentiles are not computed again: none of these may have a value.
        let has_values = |values: &[Option<f64>]| values.iter().any(Option::is_some);
        let goals = match &confirmed.goals {
            goals if has_values(goals) => format!("{}; ", numbers(goals)),
            _ => String::new(),
        };
        match &confirmed.error_estimate {
            Some(estimate) => say(format!(
                "once more on the fine grid: {goals}another grid level changes the peak-to-peak value by {:.4} um, the mean by {:.4} um",
                estimate.transmission_error_peak_to_peak_um, estimate.transmission_error_mean_um
            )),
            None => say("once more on the fine grid: no results".to_owned()),
        }
        if has_values(&confirmed.conditions) {
            say(format!(
                "  {conditions}: {}",
                numbers(&confirmed.conditions)
            ));
        }
    }
    say(format!(
        "{} designs in {} generations, {:.2} s.{}{}",
        search.evaluations,
        search.generations.len(),
        elapsed.as_secs_f64(),
        why_others_failed("designs", &search.refusals),
        why_others_failed("members", &search.member_refusals),
    ));
    text
}

/// How many have no results, and why, as a sentence behind that on those that have.
fn why_others_failed(what: &str, refusals: &[RefusalState]) -> String {
    let count: u64 = refusals.iter().map(|refusal| refusal.count).sum();
    if count == 0 {
        return String::new();
    }
    let reasons = refusals.iter().map(|refusal| {
        format!(
            "{} {}; the first: {}",
            refusal.count, refusal.code, refusal.detail
        )
    });
    let reasons: Vec<String> = reasons.collect();
    format!(" {count} {what} failed: {}", reasons.join(" "))
}

/// A line for each quantity of a population and each torque, and the shares of the causes in the variance of the peak-to-peak values.
pub(super) fn spread_table(results: &PopulationResults, elapsed: Duration) -> String {
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
    let number = |value: f64| {
        if value.abs() < 1e5 {
            format!("{value:.3}")
        } else {
            format!("{value:.3e}")
        }
    };
    let limit = |value: Option<f64>| value.map_or_else(|| "?".to_owned(), number);
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
            |percent| percentile(percent).map_or_else(String::new, |found| number(found.value));
        let limits = percentile(95.0).map_or_else(String::new, |found| {
            format!("{} to {}", limit(found.low), limit(found.high))
        });
        let torque = quantity.output_torque_n_m.map(|torque| torque.to_string());
        text.push_str(&format!(
            "{:38} {:>8} {:>10} {:>10} {:>10} {:>10} {:>10}  {limits}\n",
            quantity.name,
            torque.unwrap_or_default(),
            number(quantity.mean),
            number(quantity.standard_deviation),
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
                "At {torque} N m {:.0} % of the variance of the peak-to-peak value comes from {input}.\n",
                100.0 * influence.share
            ));
        }
    }
    let seconds = elapsed.as_secs_f64();
    text.push_str(&format!(
        "{} of {} members computed in {seconds:.2} s, {:.1} a second.{}\n",
        results.done - results.failed,
        results.size,
        (results.done - results.failed) as f64 / seconds.max(1e-9),
        why_others_failed("members", &results.refusals),
    ));
    text
}

/// A line for each design and torque, or for the best designs of a large study, and the designs that failed.
pub(super) fn short_table(results: &StudyResults, elapsed: Duration) -> String {
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
    let mut refusals = Refusals::default();
    failed
        .iter()
        .for_each(|row| refusals.note(row.problem.as_ref()));
    for row in failed.iter().take(MOST_PRINTED) {
        let detail = row
            .problem
            .as_ref()
            .and_then(|problem| problem["detail"].as_str());
        text.push_str(&format!("{}: {}\n", row.label, detail.unwrap_or_default()));
    }
    let seconds = elapsed.as_secs_f64();
    text.push_str(&format!(
        "{} of {} designs computed in {seconds:.2} s, {:.1} a second.{}\n",
        computed.len(),
        results.total,
        computed.len() as f64 / seconds.max(1e-9),
        why_others_failed("designs", &refusals.most_common_first()),
    ));
    text
}
