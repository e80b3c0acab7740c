//! Fig. 3: the rotation of the holed blanks over one hole period, with the cosine that is fitted to it.

use std::f64::consts::TAU;

use anyhow::Context;
use meshwright_engine::analysis::curve::BlankFit;
use meshwright_engine::gear::SpurGear;

use super::super::computed::Computed;
use super::Illustration;
use meshwright_plot::{Axis, Chart, Figure, Look, PALETTE, Panel, Series};

/// Points of a drawn cosine.
const FINENESS: u32 = 120;

/// The figure.
pub(super) fn rotations(computed: &Computed) -> anyhow::Result<Illustration> {
    let mut figure = Figure {
        title: "Fig. 3: rotation of the holed blank, sampled and fitted".into(),
        columns: 2,
        panel_size: (470, 230),
        panels: Vec::new(),
    };
    let mut residuals = Vec::new();
    for test_case in &computed.test_cases {
        let parts = test_case.decomposition().decomposition.as_ref();
        for fit in &parts.context("a decomposition tells its parts")?.blanks {
            let gear = test_case.case.pair.gear(fit.member);
            let place = format!("test case {}, {} gear", test_case.number, fit.member);
            let residual = fit
                .samples
                .iter()
                .map(|sample| (sample.rotation - fitted(fit, gear, sample.mesh_position)).abs())
                .fold(0.0, f64::max);
            residuals.push(format!(
                "{place} {:.3}, {:.3} and {:.3}",
                fit.mean * 1e6,
                fit.amplitude * 1e6,
                residual * 1e6
            ));
            figure.panels.push(Panel::Chart(chart(&place, fit, gear)));
        }
    }
    let caption = format!(
        "δ_gb = R_b θ_gb of eqs. 13 and 14 at the 16 positions of one hole period, and A + B cos(Nθ + phase) through them. A, B \
         and the largest residual in µm: {}. The paper's Fig. 3 has no numbers to compare with. The scatter comes mostly \
         from the mesh: at a sample one pair or two pairs carry the load, and the blank deforms differently under them. \
         The fit averages this away; it is the part of H_Z2 that the decomposition lacks in Figs. 6 and 7. The fit also \
         removes the next harmonics of the hole pattern.",
        residuals.join("; ")
    );
    Illustration::new("fig-03-blank-rotation.svg", caption, &figure)
}

/// A + B cos(N θ + phase) at the mesh position η, with θ = η 2π/Z.
fn fitted(fit: &BlankFit, gear: &SpurGear, mesh_position: f64) -> f64 {
    let n = f64::from(gear.hole_repeats());
    fit.mean + fit.amplitude * (n * mesh_position * gear.pitch_angle() + fit.phase).cos()
}

fn chart(place: &str, fit: &BlankFit, gear: &SpurGear) -> Chart {
    let degrees = |mesh_position: f64| (mesh_position * gear.pitch_angle()).to_degrees();
    let samples: Vec<(f64, f64)> = fit
        .samples
        .iter()
        .map(|sample| (degrees(sample.mesh_position), sample.rotation * 1e6))
        .collect();
    let holes = gear.hole_repeats().max(1);
    let period = TAU / f64::from(holes) / gear.pitch_angle();
    let curve = (0..=FINENESS)
        .map(|i| f64::from(i) / f64::from(FINENESS) * period)
        .map(|eta| (degrees(eta), fitted(fit, gear, eta) * 1e6))
        .collect();
    let middle = fit.mean * 1e6;
    let values: Vec<f64> = samples.iter().map(|point| point.1).collect();
    let reach = values
        .iter()
        .map(|value| (value - middle).abs())
        .fold(0.0, f64::max);
    Chart {
        title: place.into(),
        x: Axis::linear("θ of the gear in degrees", 0.0, degrees(period)),
        y: Axis::reaching(
            "δ_gb in µm",
            (middle - 1.1 * reach, middle + 1.1 * reach),
            &values,
        ),
        series: vec![
            Series::new("A + B cos(Nθ + phase)", PALETTE[1], Look::Line, curve),
            Series::new("samples", PALETTE[0], Look::Dots, samples),
        ],
        marks: Vec::new(),
    }
}
