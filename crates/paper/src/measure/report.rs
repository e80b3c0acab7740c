//! Tables and figures of the measurements.

use super::benchmarks::{Benchmark, expectation};
use super::growth::{Growth, TimeSeries, Varied};
use super::levels::{Differences, LevelRow};
use super::stopwatch::{PATIENCE, RUNS};
use super::{Machine, Measured};
use crate::reproduce::tables::table;
use meshwright_plot::{Axis, Chart, Figure, Look, PALETTE, Panel, Series};

/// The text of measured.md.
pub(super) fn text(measured: &Measured) -> String {
    let mut text = format!(
        "# Measured\n\n{}\n\n## Jobs and their parts\n\n{}\n## How time grows\n\n",
        opening(&measured.machine),
        benchmarks(&measured.benchmarks)
    );
    for growth in &measured.growth {
        let title = title(growth.varied);
        text.push_str(&format!(
            "![{title}]({})\n\n*{title}.* {}\n\n{}\n",
            growth.file(),
            sentence(growth),
            times(growth)
        ));
    }
    text.push_str(&format!(
        "## Grid levels\n\n{}",
        levels(&measured.grid_levels)
    ));
    text
}

fn opening(machine: &Machine) -> String {
    format!(
        "By `meshwright-paper measure` of version {}, {}, on {} with {} threads; [what it means](../../docs/performance.md). Jobs and their parts are \
         the least of criterion's samples. All other times are the least of up to {RUNS} runs in one process (as many as begin within \
         {PATIENCE} s), nothing computed before, without the time to start the process.",
        machine.version, machine.compiler, machine.processor, machine.threads
    )
}

fn milliseconds(seconds: f64) -> String {
    let value = seconds * 1e3;
    let decimals = if value < 10.0 { 1 } else { 0 };
    format!("{value:.decimals$}")
}

/// A time in the unit that suits it.
fn duration(seconds: f64) -> String {
    match seconds * 1e3 {
        t if t >= 100.0 => format!("{t:.0} ms"),
        t if t >= 1.0 => format!("{t:.1} ms"),
        t => format!("{:.1} µs", t * 1e3),
    }
}

fn benchmarks(benchmarks: &[Benchmark]) -> String {
    let mut rows = Vec::new();
    for of_group in benchmarks.chunk_by(|a, b| a.group == b.group) {
        rows.push(vec![
            format!("**{}**", of_group[0].group),
            String::new(),
            String::new(),
            String::new(),
        ]);
        rows.extend(of_group.iter().map(|benchmark| {
            let (paper, goal) = expectation(benchmark);
            vec![
                benchmark.name.clone(),
                paper.to_owned(),
                goal.to_owned(),
                duration(benchmark.seconds),
            ]
        }));
    }
    table(&["what", "paper", "goal", "measured"], &rows)
}

fn title(varied: Varied) -> &'static str {
    match varied {
        Varied::ToothCount => "Time over the tooth count of both gears",
        Varied::HoleCount => "Time over the number of holes",
        Varied::PositionsPerMeshPeriod => "Time over the positions per mesh period",
        Varied::TorqueCount => "Time over the number of torques",
    }
}

fn quantity(varied: Varied) -> &'static str {
    match varied {
        Varied::ToothCount => "teeth",
        Varied::HoleCount => "holes",
        Varied::PositionsPerMeshPeriod => "positions per mesh period",
        Varied::TorqueCount => "torques",
    }
}

/// Sentence about the figure, from its numbers.
fn sentence(growth: &Growth) -> String {
    let series = &growth.series;
    match growth.varied {
        Varied::ToothCount => {
            let (whole, gears) = (&series[0], &series[1]);
            let (least, most) = ends(&series[2].seconds);
            let last = whole.counts.len() - 1;
            let middle = last / 2;
            let power = (gears.seconds[last] / gears.seconds[middle]).ln()
                / (f64::from(gears.counts[last]) / f64::from(gears.counts[middle])).ln();
            format!(
                "Test case 2 with other tooth counts, bore and holes scaled with the room for them, over 5 mesh periods (200 \
                 positions): {} ms at {} teeth, {} ms at {}, {} ms at {}. The positions take {} to {} ms of it; the gears grow with \
                 the power {power:.1} of the tooth count from {} teeth on.",
                milliseconds(whole.seconds[0]),
                whole.counts[0],
                milliseconds(whole.seconds[middle]),
                whole.counts[middle],
                milliseconds(whole.seconds[last]),
                whole.counts[last],
                milliseconds(least),
                milliseconds(most),
                whole.counts[middle],
            )
        }
        Varied::HoleCount => {
            let (whole, fixed) = (&series[0], &series[1]);
            let (least, most) = ends(&fixed.seconds);
            let (least_whole, most_whole) = ends(&whole.seconds);
            let slowest = fixed.seconds.iter().position(|&seconds| seconds == most);
            let at_most = slowest.map_or(0, |i| fixed.counts[i]);
            format!(
                "Test case 2 with other hole counts in its driven gear, the holes as large as there is room for and at most as \
                 in the test case. Over 5 mesh periods the job takes {} to {} ms, most with {} holes; the fewer holes, the \
                 larger the sector of the blank that is condensed. Over the true period, which is 1 to 50 mesh periods with these counts, \
                 it takes {} to {} ms.",
                milliseconds(least),
                milliseconds(most),
                at_most,
                milliseconds(least_whole),
                milliseconds(most_whole),
            )
        }
        Varied::PositionsPerMeshPeriod => linear(
            growth,
            "Test case 2 over its true period of 5 mesh periods",
            "position per mesh period",
        ),
        Varied::TorqueCount => linear(growth, "Test case 2 at several torques", "torque"),
    }
}

/// A straight line through the ends of each series, in words.
fn linear(growth: &Growth, what: &str, unit: &str) -> String {
    let parts: Vec<String> = growth
        .series
        .iter()
        .map(|series| {
            let last = series.counts.len() - 1;
            let slope = (series.seconds[last] - series.seconds[0])
                / f64::from(series.counts[last] - series.counts[0]);
            format!(
                "{} {} ms at {} and {:.2} ms for each further {unit}",
                series.name,
                milliseconds(series.seconds[0]),
                series.counts[0],
                slope * 1e3
            )
        })
        .collect();
    format!("{what}: {}.", parts.join("; "))
}

fn ends(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, 0.0), |(least, most), &value| {
            (value.min(least), value.max(most))
        })
}

fn times(growth: &Growth) -> String {
    let counts = &growth.series[0].counts;
    let mut header = vec![quantity(growth.varied).to_owned()];
    header.extend(
        growth
            .series
            .iter()
            .map(|series| format!("{} ms", series.name)),
    );
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows: Vec<Vec<String>> = counts
        .iter()
        .enumerate()
        .map(|(i, count)| {
            std::iter::once(count.to_string())
                .chain(
                    growth
                        .series
                        .iter()
                        .map(|series| milliseconds(series.seconds[i])),
                )
                .collect()
        })
        .collect();
    table(&header, &rows)
}

/// The figure of one growth.
pub(super) fn figure(growth: &Growth) -> Figure {
    let label = quantity(growth.varied);
    let seconds = growth.series.iter().flat_map(|series| &series.seconds);
    let scaled: Vec<f64> = seconds
        .map(|seconds| seconds * unit(growth.varied))
        .collect();
    let (x, y) = match growth.varied {
        // Twenty to three hundred teeth span several decades of time.
        Varied::ToothCount => (
            Axis::decades(label, 1, 3).with_ticks(
                [10, 20, 50, 100, 200, 300]
                    .map(|count| (f64::from(count), count.to_string()))
                    .to_vec(),
            ),
            Axis::decades("time in s", decade(&scaled).0, decade(&scaled).1),
        ),
        _ => {
            let last = growth.series[0].counts.last().copied().unwrap_or(1);
            (
                Axis::linear(label, 0.0, f64::from(last)),
                Axis::reaching("time in ms", (0.0, 1.0), &scaled),
            )
        }
    };
    let series = growth
        .series
        .iter()
        .zip(PALETTE)
        .flat_map(|(series, color)| {
            let points = points(series, unit(growth.varied));
            [
                Series::new(series.name, color, Look::Line, points.clone()),
                Series::new("", color, Look::Dots, points),
            ]
        });
    Figure {
        title: title(growth.varied).to_owned(),
        columns: 1,
        panel_size: (620, 300),
        panels: vec![Panel::Chart(Chart {
            title: String::new(),
            x,
            y,
            series: series.collect(),
            marks: Vec::new(),
        })],
    }
}

/// A second in the unit of the figure: seconds over decades, milliseconds otherwise.
fn unit(varied: Varied) -> f64 {
    if varied == Varied::ToothCount {
        1.0
    } else {
        1e3
    }
}

fn points(series: &TimeSeries, unit: f64) -> Vec<(f64, f64)> {
    series
        .counts
        .iter()
        .zip(&series.seconds)
        .map(|(&count, seconds)| (f64::from(count), seconds * unit))
        .collect()
}

/// The powers of ten around `values`.
fn decade(values: &[f64]) -> (i32, i32) {
    let (least, most) = ends(values);
    (least.log10().floor() as i32, most.log10().ceil() as i32)
}

fn levels(rows: &[LevelRow]) -> String {
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let mut cells = vec![
                row.pair.to_owned(),
                row.grid.to_owned(),
                row.degrees_of_freedom.to_string(),
                milliseconds(row.seconds),
            ];
            cells.extend(differences(row.against_fine));
            cells
        })
        .collect();
    format!(
        "The flexible method over the true period; differences from the fine level in percent, of the mesh harmonics the largest \
         of the first three (one below a fifth of the largest harmonic is compared with that one).\n\n{}",
        table(
            &[
                "pair",
                "grid",
                "degrees of freedom",
                "cold ms",
                "mean",
                "p-p",
                "rms",
                "mean k",
                "mesh harmonics",
            ],
            &cells,
        )
    )
}

fn differences(differences: Option<Differences>) -> Vec<String> {
    let Some(differences) = differences else {
        return vec!["-".to_owned(); 5];
    };
    let values = [
        differences.mean,
        differences.peak_to_peak,
        differences.rms,
        differences.mean_stiffness,
    ];
    values
        .iter()
        .map(|value| format!("{:+.3}", value * 100.0))
        .chain([format!("{:.3}", differences.mesh_harmonic * 100.0)])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn growth(varied: Varied) -> Growth {
        let series = |name, slope: f64| TimeSeries {
            name,
            counts: vec![1, 2, 4],
            seconds: vec![slope, 2.0 * slope, 4.0 * slope],
        };
        Growth {
            varied,
            series: vec![series("a", 0.010), series("b", 0.002), series("c", 0.001)],
        }
    }

    #[test]
    fn sentences_say_what_the_numbers_do() {
        let torques = sentence(&growth(Varied::TorqueCount));
        assert!(
            torques.contains("a 10 ms at 1 and 10.00 ms for each further torque"),
            "{torques}"
        );
        assert!(sentence(&growth(Varied::ToothCount)).contains("power 1.0"));
    }

    #[test]
    fn every_growth_has_its_figure_and_its_table() {
        for varied in [
            Varied::ToothCount,
            Varied::HoleCount,
            Varied::PositionsPerMeshPeriod,
            Varied::TorqueCount,
        ] {
            let growth = growth(varied);
            let svg = figure(&growth).to_svg();
            assert!(svg.contains("time in") && !svg.contains("NaN"));
            assert!(times(&growth).contains("| 4 | 40 | 8.0 | 4.0 |"));
        }
    }
}
