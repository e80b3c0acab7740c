//! Figs. 6 to 8: STE and stiffness of the test cases over a revolution, closer, and as spectra.

use meshwright_engine::analysis::Curve;
use meshwright_engine::analysis::spectrum::harmonics;
use meshwright_plot::Color;

use super::super::computed::{METHODS, TestCase, line, name_of};
use super::{Illustration, over_revolution};
use meshwright_plot::{Axis, Chart, Figure, Look, PALETTE, Panel, Series};

/// The axes that the paper draws for one case: STE in um, stiffness in 1e8 N/m, then the exponents of both spectra, in um
/// and N/m.
struct Axes {
    ste: (f64, f64),
    stiffness: (f64, f64),
    ste_decades: (i32, i32),
    stiffness_decades: (i32, i32),
}

/// Figs. 6, 7 and 8. The stiffness of Fig. 8 is divided by 85/29, and its spectra go two decades further down.
const AXES: [Axes; 3] = [
    Axes {
        ste: (20.0, 28.0),
        stiffness: (0.6, 1.4),
        ste_decades: (-6, 0),
        stiffness_decades: (3, 7),
    },
    Axes {
        ste: (12.0, 18.0),
        stiffness: (0.5, 3.0),
        ste_decades: (-8, 0),
        stiffness_decades: (4, 8),
    },
    Axes {
        ste: (13.0, 19.0),
        stiffness: (1.0, 2.0),
        ste_decades: (-4, 0),
        stiffness_decades: (3, 8),
    },
];

/// The lines and colors of the methods: the projected one lies over the flexible one.
const LINES: [Look; 3] = [Look::WideLine, Look::Line, Look::Line];
const COLORS: [Color; 3] = [Color(125, 125, 125), PALETTE[1], PALETTE[2]];

const FILES: [&str; 3] = [
    "fig-06-case-1.svg",
    "fig-07-case-2.svg",
    "fig-08-case-3.svg",
];

/// Curve of a panel.
#[derive(Clone, Copy)]
enum Quantity {
    TransmissionError,
    Stiffness,
}

impl Quantity {
    fn values(self, curve: &Curve) -> &[f64] {
        match self {
            Self::TransmissionError => &curve.transmission_error,
            Self::Stiffness => &curve.mesh_stiffness_tangent,
        }
    }

    /// From SI to the unit of the axis.
    fn scale(self) -> f64 {
        match self {
            Self::TransmissionError => 1e6,
            Self::Stiffness => 1e-8,
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::TransmissionError => "STE in µm",
            Self::Stiffness => "k in 10⁸ N/m",
        }
    }
}

/// The figure of one test case.
pub(super) fn curves_and_spectra(test_case: &TestCase) -> anyhow::Result<Illustration> {
    let index = test_case.number - 1;
    let axes = &AXES[index];
    let torque = test_case.flexible().output_torque;
    let panels = [
        (Quantity::TransmissionError, axes.ste, "(a)", "(b)"),
        (Quantity::Stiffness, axes.stiffness, "(c)", "(d)"),
    ];
    let mut figure = Figure {
        title: format!(
            "Fig. {}: test case {} at {torque} N m",
            5 + test_case.number,
            test_case.number
        ),
        columns: 2,
        panel_size: (470, 230),
        panels: Vec::new(),
    };
    let revolution = panels.map(|(quantity, ends, ..)| revolution(test_case, quantity, ends));
    let closer = panels.map(|(quantity, ends, ..)| closer(test_case, quantity, ends));
    let spectra = [
        spectrum(test_case, Quantity::TransmissionError, axes.ste_decades),
        spectrum(test_case, Quantity::Stiffness, axes.stiffness_decades),
    ];
    for (chart, letter) in revolution
        .into_iter()
        .chain(closer)
        .chain(spectra)
        .zip('a'..)
    {
        let title = format!("({letter}) {}", chart.title);
        figure.panels.push(Panel::Chart(Chart { title, ..chart }));
    }
    Illustration::new(FILES[index], caption(test_case)?, &figure)
}

/// A whole revolution, as the paper shows it: of gear 1, and of gear 2 in the reducer.
fn revolution(test_case: &TestCase, quantity: Quantity, ends: (f64, f64)) -> Chart {
    let pair = &test_case.case.pair;
    let (gear, label) = if test_case.number == 3 {
        (pair.driven(), "θ₂ in rad")
    } else {
        (pair.driving(), "θ₁ in rad")
    };
    let series: Vec<Series> = test_case.answers[..2]
        .iter()
        .enumerate()
        .map(|(i, answer)| {
            let values = quantity.values(&answer.curve);
            let points =
                over_revolution(&answer.curve, values, quantity.scale(), gear.tooth_count());
            Series::new("", COLORS[i], Look::ThinLine, points)
        })
        .collect();
    chart(
        "one revolution",
        Axis::revolution(label),
        quantity,
        ends,
        series,
    )
}

/// Two hole periods, where the methods can be told apart.
fn closer(test_case: &TestCase, quantity: Quantity, ends: (f64, f64)) -> Chart {
    let gear = test_case.case.pair.driven();
    let holes = gear.hole_repeats().max(1);
    let span = (2.0 * f64::from(gear.tooth_count()) / f64::from(holes)).ceil();
    let series: Vec<Series> = METHODS
        .iter()
        .zip(&test_case.answers)
        .enumerate()
        .map(|(i, (&method, answer))| {
            let values = quantity.values(&answer.curve);
            let repeated = values.iter().cycle();
            let step = answer.curve.mesh_position.get(1).copied().unwrap_or(1.0);
            let count = (span / step).round() as usize;
            let points = (0..=count)
                .zip(repeated)
                .map(|(i, value)| (i as f64 * step, value * quantity.scale()))
                .collect();
            Series::new(name_of(method), COLORS[i], LINES[i], points)
        })
        .collect();
    let axis = Axis::linear("mesh position η in mesh periods", 0.0, span);
    let middle = |(low, high): (f64, f64)| f64::midpoint(low, high);
    let start = middle(ends);
    chart("two hole periods", axis, quantity, (start, start), series)
}

fn chart(title: &str, x: Axis, quantity: Quantity, ends: (f64, f64), series: Vec<Series>) -> Chart {
    let values: Vec<f64> = series
        .iter()
        .flat_map(|series| series.points.iter().map(|point| point.1))
        .collect();
    let ends = if ends.0 < ends.1 {
        ends
    } else {
        around(&values)
    };
    Chart {
        title: title.into(),
        x,
        y: Axis::reaching(quantity.label(), ends, &values),
        series,
        marks: Vec::new(),
    }
}

/// The range of `values` with a margin of a twentieth.
fn around(values: &[f64]) -> (f64, f64) {
    let (low, high) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| {
            (low.min(value), high.max(value))
        });
    let margin = 0.05 * (high - low);
    (low - margin, high + margin)
}

/// Amplitudes over the orders of gear 2, up to the fourth mesh harmonic.
fn spectrum(test_case: &TestCase, quantity: Quantity, (low, high): (i32, i32)) -> Chart {
    let gear = test_case.case.pair.driven();
    let (z, n) = (gear.tooth_count(), gear.hole_repeats());
    let looks = [Look::Stems, Look::Rings, Look::Crosses];
    let series = METHODS
        .iter()
        .zip(&test_case.answers)
        .enumerate()
        .filter_map(|(i, (_, answer))| {
            let spectrum = answer.curve.spectrum.as_ref()?;
            let (amplitudes, scale) = match quantity {
                Quantity::TransmissionError => (&spectrum.transmission_error, 1e6),
                Quantity::Stiffness => (&spectrum.mesh_stiffness_tangent, 1.0),
            };
            let points = spectrum
                .order
                .iter()
                .zip(amplitudes)
                .map(|(&order, a)| (order, a * scale));
            Some(Series::new("", COLORS[i], looks[i], points.collect()))
        })
        .collect();
    let ticks = [n, z, 2 * z, 3 * z, 4 * z].map(|order| (f64::from(order), order.to_string()));
    let label = match quantity {
        Quantity::TransmissionError => "STE in µm",
        Quantity::Stiffness => "k in N/m",
    };
    Chart {
        title: "amplitudes".into(),
        x: Axis::linear("order of gear 2", 0.0, 4.2 * f64::from(z)).with_ticks(ticks.to_vec()),
        y: Axis::decades(label, low, high),
        series,
        marks: Vec::new(),
    }
}

/// Of the mean square of the difference between decomposition and flexible method, the share on H_Z2 and its multiples.
fn share_on_mesh_orders(test_case: &TestCase) -> anyhow::Result<f64> {
    let (a, b) = (test_case.decomposition(), test_case.flexible());
    let pairs = a.transmission_error.iter().zip(&b.transmission_error);
    let difference: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
    let lines = harmonics(&difference);
    // The span holds as many mesh periods as the bin of H_Z2 says.
    let mesh_bin = test_case.case.span() as usize;
    let square = |line: &(f64, f64)| line.0 * line.0;
    let on_mesh: f64 = lines
        .iter()
        .skip(mesh_bin - 1)
        .step_by(mesh_bin)
        .map(square)
        .sum();
    let all: f64 = lines.iter().map(square).sum();
    anyhow::ensure!(all > 0.0, "the two methods cannot agree to the last bit");
    Ok(on_mesh / all)
}

fn caption(test_case: &TestCase) -> anyhow::Result<String> {
    let lines = |label: &str| -> anyhow::Result<String> {
        let (flexible, decomposition) = (
            line(test_case.flexible(), label)?.0,
            line(test_case.decomposition(), label)?.0,
        );
        let projected = line(test_case.projected(), label)?.0;
        Ok(format!(
            "{:.3}, {:.3} and {:.3} µm",
            flexible * 1e6,
            decomposition * 1e6,
            projected * 1e6
        ))
    };
    let farthest = |curve: &Curve| {
        let pairs = curve
            .transmission_error
            .iter()
            .zip(&test_case.flexible().transmission_error);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) * 1e6
    };
    let only = match test_case.number {
        1 => " The contact repeats after 25 mesh periods, half a revolution.",
        2 => " The contact repeats after 5 mesh periods, a tenth of a revolution.",
        _ => {
            " Drawn for 160 N m, not the 115 of the paper's caption, and with the stiffness axis of the paper divided by \
             85/29; the spectra reach two decades lower than the paper's."
        }
    };
    Ok(format!(
        "STE and tangent stiffness over a revolution (a, b), over two hole periods (c, d), and their amplitudes (e, f); \
         axes as in the paper where the curves fit them. Dots, rings and crosses of the spectra are the flexible method, \
         the decomposition and the projected decomposition. H_N is {} by these three, H_Z2 {}. At no position is the \
         decomposition more than {:.2} µm from the flexible method, the projected one {:.3} µm. Of the mean square of the \
         decomposition's error, {:.0} % is at H_Z2 and its multiples: its mesh lines are those of a pair on a rigid blank. \
         The rest are the multiples of H_N and the sidebands, which one cosine does not contain.{only}",
        lines("H_N")?,
        lines("H_Z2")?,
        farthest(test_case.decomposition()),
        farthest(test_case.projected()),
        share_on_mesh_orders(test_case)? * 100.0,
    ))
}
