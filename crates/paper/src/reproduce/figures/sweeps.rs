//! Peak-to-peak and mesh harmonics over the torque.

use meshwright_engine::analysis::Curve;

use super::super::computed::{Computed, Sweep, line};
use super::super::paper::OPTIMAL_TORQUES;
use super::Illustration;
use meshwright_plot::{Axis, Chart, Figure, Look, Mark, PALETTE, Panel, Series};

const HARMONICS: [&str; 3] = ["H_Z2", "H_2Z2", "H_3Z2"];

/// The figure.
pub(super) fn over_torque(computed: &Computed) -> anyhow::Result<Illustration> {
    let ends = computed.sweeps.iter().flat_map(|sweep| sweep.curves.last());
    let last = ends.map(|curve| curve.output_torque).fold(0.0, f64::max);
    let torque = Axis::linear("output torque in N m", 0.0, last);
    let marks = OPTIMAL_TORQUES.map(|torque| Mark {
        x: torque,
        name: format!("{torque}"),
    });
    let peak_to_peak = computed.sweeps.iter().enumerate().map(|(i, sweep)| {
        let value = |curve: &Curve| Ok(curve.transmission_error_statistics.peak_to_peak);
        // The first colors are those of the harmonics.
        series(sweep.name, HARMONICS.len() + 1 + i, sweep, value)
    });
    let mut panels = vec![(
        "peak-to-peak STE".to_owned(),
        "p-p in µm",
        peak_to_peak.collect::<anyhow::Result<Vec<_>>>()?,
    )];
    for sweep in &computed.sweeps {
        let mut labels = HARMONICS.to_vec();
        if sweep.curves.iter().all(|curve| line(curve, "H_N").is_ok()) {
            labels.push("H_N");
        }
        let harmonics = labels
            .into_iter()
            .enumerate()
            .map(|(i, label)| series(label, i, sweep, |curve| Ok(line(curve, label)?.0)));
        panels.push((
            format!("amplitudes, {}", sweep.name),
            "amplitude in µm",
            harmonics.collect::<anyhow::Result<Vec<_>>>()?,
        ));
    }
    let panels = panels
        .into_iter()
        .zip('a'..)
        .map(|((title, label, series), letter)| {
            let values: Vec<f64> = series
                .iter()
                .flat_map(|series| series.points.iter().map(|point| point.1))
                .collect();
            Panel::Chart(Chart {
                title: format!("({letter}) {title}"),
                x: torque.clone(),
                y: Axis::reaching(label, (0.0, 0.1), &values),
                series,
                marks: marks.to_vec(),
            })
        });
    let figure = Figure {
        title: "Torque sweep: 40 torques from 2 to 300 N m".into(),
        columns: 2,
        panel_size: (470, 250),
        panels: panels.collect(),
    };
    Illustration::new("sweep-torque.svg", caption(computed), &figure)
}

fn series(
    name: &str,
    i: usize,
    sweep: &Sweep,
    value: impl Fn(&Curve) -> anyhow::Result<f64>,
) -> anyhow::Result<Series> {
    let points = sweep
        .curves
        .iter()
        .map(|curve| Ok((curve.output_torque, value(curve)? * 1e6)))
        .collect::<anyhow::Result<_>>()?;
    Ok(Series::new(
        name,
        PALETTE[i % PALETTE.len()],
        Look::Line,
        points,
    ))
}

fn caption(computed: &Computed) -> String {
    let best: Vec<String> = computed
        .sweeps
        .iter()
        .map(|sweep| {
            format!(
                "{} {:.2} µm at {:.0} N m",
                sweep.name,
                sweep.best * 1e6,
                sweep.best_torque
            )
        })
        .collect();
    format!(
        "Peak-to-peak of three pairs (a) and the mesh harmonics of each (b to d), by the flexible method unless stated \
         otherwise. Minimum peak-to-peak: {}. H_Z2 has its minimum near the same torque and grows to both sides; H_N grows \
         with the torque. The lines are at 115 and 160 N m. At these torques, by the paper, the relief minimizes the \
         fluctuation of 50/50 and 29/85 teeth.",
        best.join("; ")
    )
}
