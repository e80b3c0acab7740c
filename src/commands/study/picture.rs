//! Picture of the results of a study.

use meshwright_plot::{Axis, Chart, Color, Figure, Look, PALETTE, Panel, Series};
use meshwright_studies::table::{Quantity, TableRow};
use meshwright_studies::{PopulationResults, SearchState, Study as StudyDocument, StudyResults};

/// The quantity that is shown, and that over which designs are.
const SHOWN: &str = "transmission_error_um.peak_to_peak";
const OVER: &str = "pair_mass_kg";

/// Label of the axis of a quantity; a goal without a quantity is labelled by its own words.
fn at_axis(name: &str) -> String {
    Quantity::of_name(name).map_or_else(|| name.to_owned(), Quantity::at_axis)
}

const BASE: Color = PALETTE[2];
const BEST: Color = PALETTE[1];
const OTHER: Color = PALETTE[0];

/// The picture of a study. A search shows how its goal fell, and the front of two goals. A population shows the spread of the peak-to-peak value over
/// torque, or a histogram where there is one torque. Other studies show the peak-to-peak value over mass. None where nothing was computed.
pub(super) fn picture(
    study: &StudyDocument,
    results: &StudyResults,
    population: Option<&PopulationResults>,
    search: Option<&SearchState>,
) -> Option<Figure> {
    let (kind, charts) = match (search, population) {
        (Some(search), _) => ("A search", of_search(study, search)),
        (None, Some(population)) => ("A population", of_population(population)),
        (None, None) => ("A study", vec![of_designs(&results.rows)?]),
    };
    if charts.is_empty() {
        return None;
    }
    Some(Figure {
        title: study.name().unwrap_or(kind).to_owned(),
        columns: 1,
        panel_size: (760, 340),
        panels: charts.into_iter().map(Panel::Chart).collect(),
    })
}

/// A chart whose axes reach as far as its points, from 0 upward where `from_zero`.
fn chart(title: &str, (x, y): (&str, &str), from_zero: bool, series: Vec<Series>) -> Chart {
    let all = || series.iter().flat_map(|series| &series.points);
    let axis = |label: &str, values: Vec<f64>, from_zero: bool| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if from_zero { (0.0, high) } else { (low, high) };
        // Points of one value are in the middle.
        let room = if high > low {
            0.04 * (high - low)
        } else {
            0.1 * high.abs().max(1e-9)
        };
        let low = if from_zero { low } else { low - room };
        Axis::linear(label, low, high + room)
    };
    Chart {
        title: title.to_owned(),
        x: axis(x, all().map(|point| point.0).collect(), false),
        y: axis(y, all().map(|point| point.1).collect(), from_zero),
        series,
        marks: Vec::new(),
    }
}

/// Mass and the largest peak-to-peak value over the torques of every design.
fn of_designs(rows: &[TableRow]) -> Option<Chart> {
    let points = |pareto: bool| -> Vec<(f64, f64)> {
        let rows = rows.iter().filter(|row| row.pareto == pareto);
        rows.filter_map(|row| {
            let peaks = row.numbers(SHOWN).into_iter().flatten();
            let mass = row.numbers(OVER).first().copied().flatten();
            Some((mass?, peaks.reduce(f64::max)?))
        })
        .collect()
    };
    let series = [
        ("designs", OTHER, Look::Rings, points(false)),
        ("that no other beats", BEST, Look::Dots, points(true)),
    ];
    let series: Vec<Series> = series
        .into_iter()
        .filter(|(.., points)| !points.is_empty())
        .map(|(name, color, look, points)| Series::new(name, color, look, points))
        .collect();
    let axes = (&*at_axis(OVER), &*at_axis(SHOWN));
    (!series.is_empty()).then(|| chart("", axes, false, series))
}

fn of_population(population: &PopulationResults) -> Vec<Chart> {
    let at_torques = || {
        let all = population.quantities.iter();
        all.filter(|quantity| quantity.name == SHOWN)
    };
    let torques = at_torques().filter(|quantity| quantity.output_torque_n_m.is_some());
    if torques.count() > 1 {
        let percentile = |percent: f64| -> Vec<(f64, f64)> {
            let values = at_torques().filter_map(|quantity| {
                let mut all = quantity.percentiles.iter();
                let found = all.find(|percentile| percentile.percent == percent)?;
                Some((quantity.output_torque_n_m?, found.value))
            });
            values.collect()
        };
        let series = [("p5", 5.0, BASE), ("p50", 50.0, OTHER), ("p95", 95.0, BEST)];
        let series = series
            .map(|(name, percent, color)| Series::new(name, color, Look::Line, percentile(percent)))
            .to_vec();
        let axes = ("output torque in N m", &*at_axis(SHOWN));
        return vec![chart("", axes, true, series)];
    }
    let bars = at_torques().map(|quantity| {
        let edges = quantity.histogram.edges.windows(2);
        let mut outline = vec![(quantity.smallest, 0.0)];
        for (edges, &count) in edges.zip(&quantity.histogram.counts) {
            outline.extend(edges.iter().map(|&edge| (edge, count as f64)));
        }
        outline.push((quantity.largest, 0.0));
        let series = Series::new("", OTHER, Look::Line, outline);
        let axes = (&*at_axis(SHOWN), "members");
        let torque = quantity.output_torque_n_m;
        let torque = torque.map(|torque| format!("{torque} N m"));
        let shown = [5.0, 50.0, 95.0];
        let percentiles = quantity.percentiles.iter();
        let percentiles = percentiles
            .filter(|percentile| shown.contains(&percentile.percent))
            .map(|percentile| format!("p{} {:.3}", percentile.percent, percentile.value));
        let label: Vec<String> = torque.into_iter().chain(percentiles).collect();
        chart(&label.join(", "), axes, true, vec![series])
    });
    bars.collect()
}

fn of_search(study: &StudyDocument, search: &SearchState) -> Vec<Chart> {
    let goals: Vec<String> = study.goals().iter().map(|goal| at_axis(goal)).collect();
    let [first, others @ ..] = &goals[..] else {
        return Vec::new();
    };
    let mut charts = Vec::new();
    let fallen = (1..).zip(&search.generations);
    let fallen: Vec<(f64, f64)> = fallen
        .filter_map(|(number, generation)| Some((f64::from(number), generation.best?)))
        .collect();
    if !fallen.is_empty() {
        let series = Series::new("", BEST, Look::Line, fallen);
        let axes = ("generation", &**first);
        charts.push(chart("The best so far", axes, false, vec![series]));
    }
    if let [second, ..] = others {
        let goals = search.front.iter().filter_map(|design| {
            let [Some(x), Some(y), ..] = design.goals[..] else {
                return None;
            };
            Some((x, y))
        });
        let front: Vec<(f64, f64)> = goals.collect();
        if !front.is_empty() {
            let series = Series::new("", BASE, Look::Dots, front);
            let axes = (&**first, &**second);
            charts.push(chart(
                "Which no other beats in both",
                axes,
                false,
                vec![series],
            ));
        }
    }
    charts
}
