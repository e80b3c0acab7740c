//! Pictures of results as SVG, for mails, wikis and portals that draw nothing themselves.

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use meshwright_engine::analysis::contact_pattern::{ContactPattern, PatternCurve, Pressure};
use meshwright_engine::gear::GearPair;
use meshwright_plot::map::Cell;
use meshwright_plot::{
    Axis, Chart, Drawing, Figure, Look, Map, Mark, PALETTE, Panel, RGBColor, Series, drawing,
};
use serde_json::Value;

use super::problem::internal;
use crate::wire::Problem;

/// Width and height of a picture in pixels.
const SIZE: (u32, u32) = (760, 340);

/// Amplitudes below are noise of the solution, in um.
const LEAST_AMPLITUDE: f64 = 1e-4;

/// A spectrum is shown up to so many times the mesh order.
const MESH_ORDERS: f64 = 5.4;

/// A picture of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Picture {
    TransmissionError,
    MeshStiffness,
    LoadShare,
    Spectrum,
    RunUp,
}

const NAMES: [(&str, Picture); 5] = [
    ("ste.svg", Picture::TransmissionError),
    ("mesh-stiffness.svg", Picture::MeshStiffness),
    ("load-share.svg", Picture::LoadShare),
    ("spectrum.svg", Picture::Spectrum),
    ("run-up.svg", Picture::RunUp),
];

impl Picture {
    /// The picture of a file name; `None` if there is no such one.
    pub(super) fn named(file: &str) -> Option<Self> {
        NAMES
            .iter()
            .find_map(|&(name, picture)| (name == file).then_some(picture))
    }

    /// The picture of these curves of a results document; `None` if they have nothing that it shows.
    pub(super) fn draw(self, curves: &[&Value]) -> Option<Result<String, Problem>> {
        let chart = match self {
            Self::TransmissionError => over_period(
                curves,
                "transmission error in µm",
                "transmission_error_um",
                1.0,
            ),
            Self::MeshStiffness => over_period(
                curves,
                "tangent mesh stiffness in N/µm",
                "mesh_stiffness_tangent_n_per_m",
                1e-6,
            ),
            Self::LoadShare => load_share(curves),
            Self::Spectrum => spectrum(curves),
            Self::RunUp => run_up(curves),
        }?;
        Some(svg(self.title(), Panel::Chart(chart), SIZE))
    }

    fn title(self) -> &'static str {
        match self {
            Self::TransmissionError => "Static transmission error",
            Self::MeshStiffness => "Mesh stiffness",
            Self::LoadShare => "Load share of the tooth pairs",
            Self::Spectrum => "Spectrum of the transmission error",
            Self::RunUp => "Run-up and run-down",
        }
    }
}

/// The pair at mesh position 0, as it is cut.
pub(super) fn pair(pair: &GearPair) -> Result<String, Problem> {
    const STEEL: [RGBColor; 2] = [RGBColor(188, 203, 217), RGBColor(214, 207, 191)];
    let [driving, driven] = drawing::placements(pair);
    let mut shapes = drawing::gear(pair.driving(), driving, STEEL[0]);
    shapes.extend(drawing::gear(pair.driven(), driven, STEEL[1]));
    let title = format!(
        "{}/{} teeth, module {} mm, a = {} mm",
        pair.driving().tooth_count(),
        pair.driven().tooth_count(),
        short(pair.driving().data().rack.module * 1e3),
        short(pair.center_distance() * 1e3)
    );
    let panel = Panel::Drawing(Drawing {
        title: String::new(),
        window: drawing::window(pair),
        shapes,
        legend: Vec::new(),
    });
    svg(&title, panel, (760, 460))
}

/// The largest pressure over the period on both flanks, under each load.
pub(super) fn contact_pattern(pattern: &ContactPattern) -> Result<String, Problem> {
    let pressures = pattern.curves.iter().flat_map(|curve| &curve.largest);
    let limited = pressures.flatten().flatten().filter_map(|cell| match cell {
        Pressure::Of(pressure) => Some(*pressure),
        Pressure::Unlimited => None,
    });
    let most = 1e-6 * limited.fold(0.0, f64::max);
    let scale = Axis::linear("MPa", 0.0, if most > 0.0 { most } else { 1.0 });
    let half = 5e2 * pattern.face_width;
    let panel = |curve: &PatternCurve, g: usize| {
        let rows = curve.largest[g].iter().map(|row| {
            let cells = row.iter().map(|cell| match cell {
                Pressure::Unlimited => Cell::Beyond,
                Pressure::Of(0.0) => Cell::Empty,
                Pressure::Of(pressure) => Cell::Value(1e-6 * pressure),
            });
            cells.collect()
        });
        let ends = pattern.flanks[g].ends.map(|radius| 2e3 * radius);
        Panel::Map(Map {
            title: format!(
                "{} flank, {} N m",
                ["driving", "driven"][g],
                curve.output_torque
            ),
            x: (Axis::linear("z in mm", -half, half), [-half, half]),
            y: (Axis::linear("diameter in mm", ends[0], ends[1]), ends),
            rows: rows.collect(),
            scale: scale.clone(),
            beyond: "sharp tip edge, where pressure has no limit".to_owned(),
        })
    };
    let panels = pattern
        .curves
        .iter()
        .flat_map(|curve| [0, 1].map(|g| panel(curve, g)));
    let figure = Figure {
        title: "Largest contact pressure over the period".to_owned(),
        columns: 2,
        panel_size: (480, 300),
        panels: panels.collect(),
    };
    figure.to_svg().map_err(|error| {
        tracing::error!(%error, "a contact pattern could not be drawn");
        internal()
    })
}

/// A number without digits that say nothing.
fn short(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// An answer that is a picture.
pub(super) fn answer(svg: String) -> Response {
    ([(CONTENT_TYPE, "image/svg+xml")], svg).into_response()
}

fn svg(title: &str, panel: Panel, panel_size: (u32, u32)) -> Result<String, Problem> {
    let figure = Figure {
        title: title.to_owned(),
        columns: 1,
        panel_size,
        panels: vec![panel],
    };
    figure.to_svg().map_err(|error| {
        tracing::error!(%error, "a picture could not be drawn");
        internal()
    })
}

/// The numbers of a list; what is null is no number.
fn numbers(holder: &Value, name: &str) -> Option<Vec<f64>> {
    let list = holder.get(name)?.as_array()?;
    Some(
        list.iter()
            .map(|each| each.as_f64().unwrap_or(f64::NAN))
            .collect(),
    )
}

fn torque_of(curve: &Value) -> String {
    let torque = curve.get("output_torque_n_m").and_then(Value::as_f64);
    torque.map_or(String::new(), |torque| format!("{torque} N m"))
}

fn over_period(curves: &[&Value], label: &str, name: &str, factor: f64) -> Option<Chart> {
    let series: Vec<Series> = curves
        .iter()
        .zip(PALETTE.iter().skip(2).chain(&PALETTE).cycle())
        .filter_map(|(curve, &color)| {
            let points = closed(curve, &scaled(numbers(curve, name)?, factor))?;
            Some(Series::new(&torque_of(curve), color, Look::Line, points))
        })
        .collect();
    chart(series, label, None)
}

/// The shares of the first curve, a series for each offset.
fn load_share(curves: &[&Value]) -> Option<Chart> {
    let curve = curves.first()?;
    let shares = curve.get("load_shares")?.as_array()?;
    let colors = PALETTE.iter().skip(1).cycle();
    let series = shares.iter().zip(colors).filter_map(|(share, &color)| {
        let offset = share.get("pair_offset")?.as_i64()?;
        let name = match offset {
            0 => "pair that passed the pitch point last".to_owned(),
            1.. => format!("{offset} after it"),
            _ => format!("{} before it", -offset),
        };
        let points = position(curve)?
            .into_iter()
            .zip(scaled(numbers(share, "share")?, 100.0));
        Some(Series::new(&name, color, Look::Dots, points.collect()))
    });
    chart(series.collect(), "load share in %", Some((0.0, 100.0)))
}

fn spectrum(curves: &[&Value]) -> Option<Chart> {
    let mesh_order = curves.iter().find_map(|curve| named_order(curve, "H_Z2"));
    let last = mesh_order.map_or(f64::INFINITY, |order| MESH_ORDERS * order);
    let series: Vec<Series> = curves
        .iter()
        .zip(PALETTE.iter().skip(2).chain(&PALETTE).cycle())
        .filter_map(|(curve, &color)| {
            let spectrum = curve.get("spectrum")?;
            let amplitudes = numbers(spectrum, "transmission_error_um")?;
            let lines = numbers(spectrum, "order")?.into_iter().zip(amplitudes);
            let points = lines.filter(|&(order, value)| order <= last && value >= LEAST_AMPLITUDE);
            Some(Series::new(
                &torque_of(curve),
                color,
                Look::Stems,
                points.collect(),
            ))
        })
        .collect();
    let points = || series.iter().flat_map(|each| &each.points);
    let most_x = points().map(|&(x, _)| x).fold(0.0, f64::max);
    let most_y = points()
        .map(|&(_, y)| y)
        .fold(LEAST_AMPLITUDE * 10.0, f64::max);
    (most_x > 0.0).then(|| Chart {
        title: String::new(),
        x: Axis::linear(
            "order, per revolution of the driven gear",
            0.0,
            1.02 * most_x,
        ),
        y: Axis::decades(
            "amplitude in µm",
            LEAST_AMPLITUDE.log10() as i32,
            most_y.log10().ceil() as i32,
        ),
        marks: marks(curves, most_x),
        series,
    })
}

/// The dynamic transmission error over speed, both branches, with the resonances of the first curve.
fn run_up(curves: &[&Value]) -> Option<Chart> {
    let colors = PALETTE.iter().skip(2).chain(&PALETTE).cycle();
    let mut series = Vec::new();
    for (curve, &color) in curves.iter().zip(colors) {
        let Some(dynamics) = curve.get("dynamics") else {
            continue;
        };
        let speeds = numbers(dynamics, "driving_speed_rpm")?;
        for (branch, look) in [("up", Look::Line), ("down", Look::Dots)] {
            let Some(error) = dynamics.pointer(&format!("/{branch}/dynamic_transmission_error_um"))
            else {
                continue;
            };
            let points = speeds.iter().copied().zip(numbers(error, "peak_to_peak")?);
            let name = format!("{}, {branch}", torque_of(curve));
            series.push(Series::new(&name, color, look, points.collect()));
        }
    }
    let most = |pick: fn(&(f64, f64)) -> f64| {
        let points = series.iter().flat_map(|each| &each.points);
        points.map(pick).fold(0.0, f64::max)
    };
    let (last, highest) = (most(|point| point.0), most(|point| point.1));
    (last > 0.0 && highest > 0.0).then(|| Chart {
        title: String::new(),
        x: Axis::linear("speed of the driving gear in 1/min", 0.0, last),
        y: Axis::linear(
            "dynamic transmission error, peak to peak, in µm",
            0.0,
            1.08 * highest,
        ),
        marks: resonances(curves),
        series,
    })
}

/// Where the orders of mesh and holes resonate.
fn resonances(curves: &[&Value]) -> Vec<Mark> {
    let found = curves.iter().find_map(|curve| {
        let resonances = curve.get("dynamics")?.get("resonances")?;
        resonances.as_array()
    });
    let mark = |resonance: &Value| {
        let label = resonance.get("label")?.as_str()?;
        let shown = ["H_N", "H_N1", "H_N2", "H_Z2", "H_2Z2", "H_3Z2"].contains(&label);
        let forced = resonance.get("kind")?.as_str()? == "forced";
        (shown && forced).then_some(Mark {
            x: resonance.get("driving_speed_rpm")?.as_f64()?,
            name: label.to_owned(),
        })
    };
    found.into_iter().flatten().filter_map(mark).collect()
}

fn named_order(curve: &Value, label: &str) -> Option<f64> {
    let named = curve.get("spectrum")?.get("named")?.as_array()?;
    let line = named
        .iter()
        .find(|line| line.get("label").and_then(Value::as_str) == Some(label));
    line?.get("order")?.as_f64()
}

/// The orders of holes and of the mesh by their names.
fn marks(curves: &[&Value], most: f64) -> Vec<Mark> {
    let names = [
        "H_N", "H_N1", "H_N2", "H_Z2", "H_2Z2", "H_3Z2", "H_4Z2", "H_5Z2",
    ];
    let order = |name: &str| curves.iter().find_map(|curve| named_order(curve, name));
    let found = names.iter().filter_map(|&name| Some((name, order(name)?)));
    found
        .filter(|&(_, order)| order <= most)
        .map(|(name, x)| Mark {
            x,
            name: name.to_owned(),
        })
        .collect()
}

fn position(curve: &Value) -> Option<Vec<f64>> {
    numbers(curve, "mesh_position").filter(|positions| positions.len() > 1)
}

fn scaled(values: Vec<f64>, factor: f64) -> Vec<f64> {
    values.into_iter().map(|value| value * factor).collect()
}

/// The points of a curve, and the first again at the end of the span.
fn closed(curve: &Value, values: &[f64]) -> Option<Vec<(f64, f64)>> {
    let positions = position(curve)?;
    let end = positions.last()? + positions.get(1)? - positions.first()?;
    let again = (end, *values.first()?);
    Some(
        positions
            .into_iter()
            .zip(values.iter().copied())
            .chain([again])
            .collect(),
    )
}

fn chart(series: Vec<Series>, label: &str, range: Option<(f64, f64)>) -> Option<Chart> {
    let points = || series.iter().flat_map(|each| &each.points);
    let span = |pick: fn(&(f64, f64)) -> f64| {
        let values = points().map(pick).filter(|value| value.is_finite());
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    let (left, right) = span(|point| point.0);
    let (low, high) = range.unwrap_or_else(|| span(|point| point.1));
    // An axis needs a span, also where a curve is flat.
    let room = (0.08 * (high - low)).max(1e-6 * high.abs()).max(1e-9);
    (right > left && high >= low).then(|| Chart {
        title: String::new(),
        x: Axis::linear("mesh position in mesh periods", left, right),
        y: Axis::linear(label, low - room, high + room),
        series,
        marks: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::wire::{Submission, examples};

    fn curve() -> Value {
        json!({ "output_torque_n_m": 115.0, "mesh_position": [0.0, 0.5], "transmission_error_um": [13.0, 14.0],
                "mesh_stiffness_tangent_n_per_m": [2.2e8, 2.2e8],
                "load_shares": [{ "pair_offset": 0, "share": [1.0, 0.5] }, { "pair_offset": 1, "share": [0.0, 0.5] }],
                "spectrum": { "order": [10, 50], "transmission_error_um": [0.3, 0.2], "named": [{ "label": "H_Z2", "order": 50 }] },
                "dynamics": { "driving_speed_rpm": [0.0, 500.0, 1000.0], "resonances": [{ "driving_speed_rpm": 500.0, "label": "H_Z2", "kind": "forced" }],
                              "up": { "dynamic_transmission_error_um": { "peak_to_peak": [3.0, 9.0, 1.0] } },
                              "down": { "dynamic_transmission_error_um": { "peak_to_peak": [3.0, 8.0, 1.0] } } } })
    }

    #[test]
    fn every_picture_is_drawn_and_says_its_unit_and_torque() {
        let curve = curve();
        for (name, words) in [
            ("ste.svg", ["transmission error in µm", "115 N m"]),
            ("mesh-stiffness.svg", ["N/µm", "115 N m"]),
            ("load-share.svg", ["load share in %", "1 after it"]),
            ("run-up.svg", ["115 N m, down", "H_Z2"]),
            (
                "spectrum.svg",
                ["H_Z2", "per revolution of the driven gear"],
            ),
        ] {
            let picture = Picture::named(name).expect("known");
            let svg = picture
                .draw(&[&curve])
                .expect("has what it shows")
                .expect("drawn");
            assert!(svg.starts_with("<svg"), "{name}");
            for word in words {
                assert!(svg.contains(word), "{name} lacks {word}");
            }
        }
    }

    #[test]
    fn results_that_lack_what_a_picture_shows_have_no_such_picture() {
        let bare = json!({ "output_torque_n_m": 1.0, "mesh_position": [0.0] });
        assert!(
            NAMES
                .iter()
                .all(|(_, picture)| picture.draw(&[&bare]).is_none())
        );
        assert_eq!(Picture::named("peak.svg"), None);
    }

    #[test]
    fn a_pair_is_drawn_with_its_holes() {
        let example = examples()
            .iter()
            .find(|example| example.name == "test-case-2");
        let submission = Submission::parse(example.expect("ships").json.as_bytes()).expect("valid");
        let svg = pair(&submission.case().pair).expect("drawn");
        // A bore each and ten holes, each a filled disk.
        assert!(
            svg.matches("<circle").count() >= 12,
            "{}",
            svg.matches("<circle").count()
        );
        assert!(svg.contains("50/50 teeth, module 2 mm, a = 100.5 mm"));
    }
}
