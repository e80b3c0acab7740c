//! Figs. 10 and 11: the designs of section 5 at 20 and 115 N m.

use super::super::computed::{Computed, line};
use super::{Illustration, over_revolution};
use meshwright_plot::{Axis, Chart, Figure, Look, PALETTE, Panel, Series};

/// The axes of the paper: STE in um at 20 and at 115 N m, stiffness in 1e8 N/m.
const STE: [(f64, f64); 2] = [(0.0, 8.0), (10.0, 22.0)];
const STIFFNESS: (f64, f64) = (1.0, 4.0);

const FILES: [&str; 2] = [
    "fig-10-designs-at-20-n-m.svg",
    "fig-11-designs-at-115-n-m.svg",
];

/// The figure at the torque of this index: 0 for 20, 1 for 115 N m.
pub(super) fn at(computed: &Computed, torque: usize) -> anyhow::Result<Illustration> {
    let mut figure = Figure {
        title: format!(
            "Fig. {}: the designs of section 5 at {} N m",
            10 + torque,
            computed.designs[0].flexible[torque].output_torque
        ),
        columns: 2,
        panel_size: (470, 165),
        panels: Vec::new(),
    };
    let kept = computed.designs.iter().filter(|design| design.kept);
    for (design, letters) in kept.zip(["ab", "cd", "ef", "gh", "ij", "kl"]) {
        let curve = &design.flexible[torque];
        let z = design.case.pair.driving().tooth_count();
        let quantities = [
            (&curve.transmission_error, 1e6, STE[torque], "STE in µm"),
            (
                &curve.mesh_stiffness_tangent,
                1e-8,
                STIFFNESS,
                "k in 10⁸ N/m",
            ),
        ];
        for ((values, scale, ends, label), letter) in quantities.into_iter().zip(letters.chars()) {
            let points = over_revolution(curve, values, scale, z);
            let values: Vec<f64> = points.iter().map(|point| point.1).collect();
            figure.panels.push(Panel::Chart(Chart {
                title: format!("({letter}) {}", design.name),
                x: Axis::revolution("θ₁ in rad"),
                y: Axis::reaching(label, ends, &values),
                series: vec![Series::new("", PALETTE[0], Look::ThinLine, points)],
                marks: Vec::new(),
            }));
        }
    }
    Illustration::new(FILES[torque], caption(computed, torque)?, &figure)
}

fn caption(computed: &Computed, torque: usize) -> anyhow::Result<String> {
    let mut lines = Vec::new();
    for design in computed.holed_kept() {
        let amplitude = line(&design.flexible[torque], "H_N")?.0;
        lines.push(format!("{} {:.3}", design.name, amplitude * 1e6));
    }
    let standard = computed.design("standard")?.flexible[torque].transmission_error_statistics;
    let paper = super::super::paper::STANDARD_PEAK_TO_PEAK[torque];
    Ok(format!(
        "STE and tangent stiffness over a revolution by the flexible method (the paper uses the decomposition; both are in \
         the table of section 5), axes as in the paper where the curves fit them. The holes add a wave of N to a \
         revolution; its amplitude H_N in µm: {}. The peak-to-peak of the standard pair is {:.2} µm; the paper has {paper} \
         µm.",
        lines.join(", "),
        standard.peak_to_peak * 1e6
    ))
}
