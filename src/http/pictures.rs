//! Pictures of results as SVG, for mails, wikis and portals that draw nothing themselves.

use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use meshwright_engine::analysis::contact_pattern::{ContactPattern, PatternCurve, Pressure};
use meshwright_engine::gear::GearPair;
use meshwright_plot::map::Cell;
use meshwright_plot::{
    Axis, Chart, Color, Drawing, Figure, Look, Map, Mark, PALETTE, Panel, Series, drawing,
};

use meshwright_wire::results::{
    CurveDocument, ExcitationName, HolePhaseDocument, ResonanceDocument,
};

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
    FaceLoad,
}

impl Picture {
    /// The picture of these curves; `None` if they have nothing that it shows.
    pub(super) fn draw(self, curves: &[&CurveDocument]) -> Option<String> {
        let chart = match self {
            Self::TransmissionError => over_period(curves, "transmission error in µm", |curve| {
                curve.transmission_error_um.clone()
            }),
            Self::MeshStiffness => over_period(curves, "tangent mesh stiffness in N/µm", |curve| {
                scaled(&curve.mesh_stiffness_tangent_n_per_m, 1e-6)
            }),
            Self::LoadShare => load_share(curves),
            Self::Spectrum => spectrum(curves),
            Self::RunUp => run_up(curves),
            Self::FaceLoad => face_load(curves),
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
            Self::FaceLoad => "Load along the face, mean over the period",
        }
    }
}

/// The pair at mesh position 0, as it is cut.
pub(super) fn pair(pair: &GearPair) -> String {
    const STEEL: [Color; 2] = [Color(188, 203, 217), Color(214, 207, 191)];
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
pub(super) fn contact_pattern(pattern: &ContactPattern) -> String {
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
    figure.to_svg()
}

/// Amplitude at the order of the holes and peak-to-peak over the turn of the driving gear's holes, with the best turn.
pub(super) fn hole_phase(phase: &HolePhaseDocument) -> String {
    let over = &phase.over_turn;
    let turns = over.turn_of_driving_deg.iter().copied();
    let series = [
        ("amplitude at the order of the holes", &over.amplitude_um),
        ("peak-to-peak", &over.peak_to_peak_um),
    ];
    let lines = series.into_iter().zip(colors());
    let lines = lines.map(|((name, values), &color)| {
        let points = turns.clone().zip(values.iter().copied()).collect();
        Series::new(name, color, Look::Line, points)
    });
    let confirmed = vec![
        (0.0, phase.amplitude_now_um),
        (phase.turn_of_driving_deg, phase.amplitude_um),
    ];
    let confirmed = Series::new("in full", PALETTE[0], Look::Rings, confirmed);
    let series: Vec<Series> = lines.chain([confirmed]).collect();
    let points = series.iter().flat_map(|each| &each.points);
    let [right, most] = points.fold([0.0_f64; 2], |[x, y], point| {
        [x.max(point.0), y.max(point.1)]
    });
    let chart = Chart {
        title: String::new(),
        x: Axis::linear("turn of the driving gear's holes in degrees", 0.0, right),
        y: Axis::linear("transmission error in µm", 0.0, 1.08 * most),
        marks: vec![Mark {
            x: phase.turn_of_driving_deg,
            name: format!("{:.1}°", phase.turn_of_driving_deg),
        }],
        series,
    };
    let title = format!(
        "Phase of the holes: order {}, {} N m",
        phase.order,
        short(phase.output_torque_n_m)
    );
    svg(&title, Panel::Chart(chart), SIZE)
}

/// A number without digits that say nothing.
fn short(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// An answer that is a picture.
pub(super) fn answer(svg: String) -> Response {
    ([(CONTENT_TYPE, "image/svg+xml")], svg).into_response()
}

fn svg(title: &str, panel: Panel, panel_size: (u32, u32)) -> String {
    let figure = Figure {
        title: title.to_owned(),
        columns: 1,
        panel_size,
        panels: vec![panel],
    };
    figure.to_svg()
}

fn torque_of(curve: &CurveDocument) -> String {
    format!("{} N m", curve.output_torque_n_m)
}

/// The colors of curves, one after the other.
fn colors() -> impl Iterator<Item = &'static Color> {
    PALETTE.iter().skip(2).chain(&PALETTE).cycle()
}

fn over_period(
    curves: &[&CurveDocument],
    label: &str,
    values: impl Fn(&CurveDocument) -> Vec<f64>,
) -> Option<Chart> {
    let series: Vec<Series> = curves
        .iter()
        .zip(colors())
        .filter_map(|(curve, &color)| {
            let points = closed(curve, values(curve))?;
            Some(Series::new(&torque_of(curve), color, Look::Line, points))
        })
        .collect();
    chart(series, label, None)
}

/// The shares of the first curve, a series for each offset.
fn load_share(curves: &[&CurveDocument]) -> Option<Chart> {
    let curve = curves.first()?;
    let positions = &curve.mesh_position;
    let colors = PALETTE.iter().skip(1).cycle();
    let series = curve.load_shares.iter().zip(colors).map(|(share, &color)| {
        let name = match share.pair_offset {
            0 => "pair that passed the pitch point last".to_owned(),
            offset @ 1.. => format!("{offset} after it"),
            offset => format!("{} before it", -offset),
        };
        let shares = scaled(&share.share, 100.0);
        let points = positions.iter().copied().zip(shares).collect();
        Series::new(&name, color, Look::Dots, points)
    });
    chart(series.collect(), "load share in %", Some((0.0, 100.0)))
}

fn spectrum(curves: &[&CurveDocument]) -> Option<Chart> {
    let mesh_order = curves.iter().find_map(|curve| named_order(curve, "H_Z2"));
    let last = mesh_order.map_or(f64::INFINITY, |order| MESH_ORDERS * order);
    let series: Vec<Series> = curves
        .iter()
        .zip(colors())
        .filter_map(|(curve, &color)| {
            let spectrum = curve.spectrum.as_ref()?;
            let orders = spectrum.order.iter().copied();
            let lines = orders.zip(spectrum.transmission_error_um.iter().copied());
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
fn run_up(curves: &[&CurveDocument]) -> Option<Chart> {
    let mut series = Vec::new();
    for (curve, &color) in curves.iter().zip(colors()) {
        let Some(dynamics) = &curve.dynamics else {
            continue;
        };
        for (word, branch, look) in [
            ("up", &dynamics.up, Look::Line),
            ("down", &dynamics.down, Look::Dots),
        ] {
            let Some(branch) = branch else {
                continue;
            };
            let speeds = dynamics.driving_speed_rpm.iter().copied();
            let ranges = &branch.dynamic_transmission_error_um.peak_to_peak;
            let points = speeds.zip(ranges.iter().copied()).collect();
            let name = format!("{}, {word}", torque_of(curve));
            series.push(Series::new(&name, color, look, points));
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

/// The mean over the positions of the load on each strip of the common face.
fn face_load(curves: &[&CurveDocument]) -> Option<Chart> {
    let series = curves.iter().zip(colors()).filter_map(|(curve, &color)| {
        let face = curve.face.as_ref()?;
        let rows = &face.load_n_per_mm;
        let mean =
            |strip: usize| rows.iter().map(|row| row[strip]).sum::<f64>() / rows.len() as f64;
        let points = face
            .z_mm
            .iter()
            .enumerate()
            .map(|(strip, z)| (*z, mean(strip)));
        let name = format!("{}, K_Hβ {:.3}", torque_of(curve), face.face_load_factor);
        Some(Series::new(&name, color, Look::Line, points.collect()))
    });
    let series: Vec<Series> = series.collect();
    let points = || series.iter().flat_map(|each| &each.points);
    let half = points().map(|point| point.0.abs()).fold(0.0, f64::max);
    let most = points().map(|point| point.1).fold(0.0, f64::max);
    (half > 0.0 && most > 0.0).then(|| Chart {
        title: String::new(),
        x: Axis::linear("z from the middle of the common face, in mm", -half, half),
        y: Axis::linear("load in N/mm", 0.0, 1.08 * most),
        marks: Vec::new(),
        series,
    })
}

/// Where the orders of mesh and holes resonate.
fn resonances(curves: &[&CurveDocument]) -> Vec<Mark> {
    let found = curves.iter().find_map(|curve| curve.dynamics.as_ref());
    let resonances = found.iter().flat_map(|dynamics| &dynamics.resonances);
    let shown = resonances.filter(|resonance| {
        resonance.excited == ExcitationName::Forced
            && ["H_N", "H_N1", "H_N2", "H_Z2", "H_2Z2", "H_3Z2"].contains(&&*resonance.label)
    });
    let mark = |resonance: &ResonanceDocument| Mark {
        x: resonance.driving_speed_rpm,
        name: resonance.label.clone(),
    };
    shown.map(mark).collect()
}

fn named_order(curve: &CurveDocument, label: &str) -> Option<f64> {
    let mut named = curve.spectrum.as_ref()?.named.iter();
    Some(named.find(|line| line.label == label)?.order)
}

/// The orders of holes and of the mesh by their names.
fn marks(curves: &[&CurveDocument], most: f64) -> Vec<Mark> {
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

fn scaled(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

/// The points of a curve, and the first again at the end of the span.
fn closed(curve: &CurveDocument, values: Vec<f64>) -> Option<Vec<(f64, f64)>> {
    let positions = &curve.mesh_position;
    let end = positions.last()? + positions.get(1)? - positions.first()?;
    let again = (end, *values.first()?);
    let points = positions.iter().copied().zip(values);
    Some(points.chain([again]).collect())
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
    use meshwright_wire::Results;
    use serde_json::json;

    use super::*;
    use crate::testing::RESULTS;
    use crate::testing::submission;

    /// The first of the stub, with a run-up.
    fn curve() -> CurveDocument {
        let mut curve = Results::read(RESULTS)
            .expect("a results document")
            .curves
            .remove(0);
        let branch = |resonant: f64| {
            json!({ "dynamic_transmission_error_um": { "rms": [1.0, 3.0, 1.0], "peak_to_peak": [3.0, resonant, 1.0] },
                    "dynamic_load_factor": [], "contact_lost": [], "period_multiple": [], "orders": [] })
        };
        let dynamics = json!({ "natural_frequency_hz": 1.0, "equivalent_mass_kg": 1.0, "driving_speed_rpm": [0.0, 500.0, 1000.0],
            "resonances": [{ "driving_speed_rpm": 500.0, "label": "H_Z2", "excited": "forced" }], "up": branch(9.0), "down": branch(8.0) });
        curve.dynamics = Some(serde_json::from_value(dynamics).expect("a run-up"));
        curve
    }

    const ALL: [(Picture, [&str; 2]); 5] = [
        (
            Picture::TransmissionError,
            ["transmission error in µm", "115 N m"],
        ),
        (Picture::MeshStiffness, ["N/µm", "115 N m"]),
        (Picture::LoadShare, ["load share in %", "1 after it"]),
        (Picture::RunUp, ["115 N m, down", "H_Z2"]),
        (
            Picture::Spectrum,
            ["H_N", "per revolution of the driven gear"],
        ),
    ];

    #[test]
    fn every_picture_is_drawn_and_says_its_unit_and_torque() {
        let curve = curve();
        for (picture, words) in ALL {
            let svg = picture.draw(&[&curve]).expect("has what it shows");
            assert!(svg.starts_with("<svg"), "{picture:?}");
            for word in words {
                assert!(svg.contains(word), "{picture:?} lacks {word}");
            }
        }
    }

    #[test]
    fn results_that_lack_what_a_picture_shows_have_no_such_picture() {
        let mut bare = curve();
        bare.mesh_position.truncate(1);
        (bare.spectrum, bare.dynamics) = (None, None);
        for (picture, _) in ALL {
            assert!(picture.draw(&[&bare]).is_none(), "{picture:?}");
        }
    }

    #[test]
    fn the_phase_of_the_holes_is_drawn_with_its_best_turn() {
        let phase = json!({ "output_torque_n_m": 115.0, "order": 10, "turn_of_driving_deg": 28.26, "amplitude_um": 0.0004, "amplitude_now_um": 0.418,
            "other_flanks_turn_deg": 14.94,
            "over_turn": { "turn_of_driving_deg": [0.0, 18.0, 36.0], "amplitude_um": [0.418, 0.521, 0.418], "peak_to_peak_um": [3.9, 4.2, 3.9] } });
        let svg = hole_phase(&serde_json::from_value(phase).expect("a phase"));
        for word in [
            "order 10, 115 N m",
            "28.3°",
            "peak-to-peak",
            "turn of the driving gear",
        ] {
            assert!(svg.contains(word), "{word} in {svg}");
        }
    }

    #[test]
    fn a_pair_is_drawn_with_its_holes() {
        let submission = submission("test-case-2");
        let svg = pair(&submission.case().pair);
        // A bore each and ten holes, each a filled disk.
        assert!(
            svg.matches("<circle").count() >= 12,
            "{}",
            svg.matches("<circle").count()
        );
        assert!(svg.contains("50/50 teeth, module 2 mm, a = 100.5 mm"));
    }
}
