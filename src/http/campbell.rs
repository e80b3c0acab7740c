//! The natural modes of both gears over speed: as a table of crossings, and as a Campbell diagram.

use meshwright_plot::{Axis, Chart, Color, Figure, Look, PALETTE, Panel, Series};
use meshwright_wire::Results;
use meshwright_wire::csv::CsvWriter;
use meshwright_wire::results::{ModeDirection, ModeDocument, ModesDocument};
use meshwright_wire::warning::GearName;
use serde_json::json;

/// Width and height of the panel of a gear in pixels.
const SIZE: (u32, u32) = (760, 380);
/// Multiples of the mesh order that are drawn.
const MULTIPLES: u32 = 5;
/// Where the results have no speeds, the diagram ends beyond the crossings of the mesh order with so many of the lowest modes.
const LOWEST: usize = 4;
const BEYOND: f64 = 1.2;

const GEARS: [GearName; 2] = [GearName::Driving, GearName::Driven];

/// One line for each crossing, and for each mode that the mesh does not meet. Numbers are written as they stand in the results.
pub(super) fn csv(modes: &ModesDocument) -> String {
    let mut text = CsvWriter::default();
    for name in [
        "gear",
        "mode",
        "frequency_hz",
        "nodal_diameters",
        "nodal_circles",
        "direction",
        "is_double",
        "wave_split",
        "label",
        "driving_speed_rpm",
        "wave",
    ] {
        text.text(name);
    }
    text.end_line();
    for gear in GEARS {
        for (mode, number) in modes.of_gear(gear).iter().zip(1..) {
            let of_mode = [
                json!(gear.word()),
                json!(number),
                json!(mode.frequency_hz),
                json!(mode.nodal_diameters),
                json!(mode.nodal_circles),
                json!(mode.direction),
                json!(mode.is_double),
                json!(mode.wave_split),
            ];
            let crossings = mode.crossings.iter().map(Some);
            // A mode that the mesh does not meet has a line as well.
            let none = mode.crossings.is_empty().then_some(None);
            for crossing in crossings.chain(none) {
                for cell in &of_mode {
                    text.value(Some(cell));
                }
                if let Some(crossing) = crossing {
                    text.text(&crossing.label);
                    text.number(Some(crossing.driving_speed_rpm));
                    text.text(crossing.wave.word());
                }
                text.end_line();
            }
        }
    }
    text.into_text()
}

/// The frequencies of the modes of each gear over the speed of the driving one, seen in space, with the mesh order and its multiples. `None` where there
/// are no modes.
pub(super) fn draw(results: &Results) -> Option<String> {
    let modes = results.modes.as_ref()?;
    let teeth = results.tooth_counts();
    let asked = results.curves.iter().find_map(|curve| {
        let speeds = &curve.dynamics.as_ref()?.driving_speed_rpm;
        speeds.last().copied()
    });
    let last = asked
        .filter(|last| *last > 0.0)
        .or_else(|| usual_end(modes))?;
    let panels = GEARS.into_iter().zip(teeth).map(|(gear, own)| {
        let per_turn = teeth[0] / (60.0 * own);
        panel(gear.word(), modes.of_gear(gear), (last, per_turn), teeth[0])
    });
    let figure = Figure {
        title: "Campbell diagram, seen from the mesh".to_owned(),
        columns: 1,
        panel_size: SIZE,
        panels: panels.collect(),
    };
    Some(figure.to_svg())
}

/// Beyond the speeds at which the mesh order meets the lowest modes of either gear.
fn usual_end(modes: &ModesDocument) -> Option<f64> {
    let lowest = GEARS
        .into_iter()
        .flat_map(|gear| modes.of_gear(gear).iter().take(LOWEST));
    let first = lowest.filter_map(|mode| mode.crossings.first());
    let met = first.map(|crossing| crossing.driving_speed_rpm);
    met.reduce(f64::max).map(|speed| BEYOND * speed)
}

/// The diagram of one gear up to the driving speed `last`; `per_turn` makes turns of this gear a second of it.
fn panel(
    gear: &str,
    modes: &[ModeDocument],
    (last, per_turn): (f64, f64),
    driving_teeth: f64,
) -> Panel {
    let mut series = Vec::new();
    let directions = [
        ModeDirection::Torsion,
        ModeDirection::InPlane,
        ModeDirection::OutOfPlane,
    ];
    for (direction, color) in directions.into_iter().zip(PALETTE.iter().skip(2)) {
        let of_direction = modes.iter().filter(|mode| mode.direction == direction);
        let waves = of_direction.flat_map(|mode| {
            let signs: &[f64] = if mode.wave_split == 0.0 {
                &[0.0]
            } else {
                &[1.0, -1.0]
            };
            signs.iter().map(move |sign| {
                let end = mode.frequency_hz + sign * mode.wave_split * last * per_turn;
                vec![(0.0, mode.frequency_hz), (last, end)]
            })
        });
        for (number, points) in waves.enumerate() {
            // The first names all of them.
            let name = if number == 0 { direction.words() } else { "" };
            series.push(Series::new(name, *color, Look::ThinLine, points));
        }
    }
    let highest = modes
        .iter()
        .map(|mode| mode.frequency_hz)
        .fold(0.0, f64::max);
    let top = if highest > 0.0 { 1.1 * highest } else { 1.0 };
    for multiple in 1..=MULTIPLES {
        let name = match multiple {
            1 => "mesh order and its multiples",
            _ => "",
        };
        // Up to the upper edge.
        let slope = f64::from(multiple) * driving_teeth / 60.0;
        let end = last.min(top / slope);
        let points = vec![(0.0, 0.0), (end, slope * end)];
        series.push(Series::new(name, Color(60, 60, 60), Look::Line, points));
    }
    // No wave leaves the panel.
    for each in &mut series {
        if let [(_, at_rest), (end, frequency)] = &mut each.points[..] {
            let limit = if *frequency > top {
                top
            } else {
                frequency.max(0.0)
            };
            if limit != *frequency {
                *end *= (limit - *at_rest) / (*frequency - *at_rest);
                *frequency = limit;
            }
        }
    }
    Panel::Chart(Chart {
        title: format!("{gear} gear"),
        x: Axis::linear("speed of the driving gear in 1/min", 0.0, last),
        y: Axis::linear("frequency in Hz", 0.0, top),
        marks: Vec::new(),
        series,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::RESULTS;

    /// The results of the stub with one mode of the driven gear.
    fn with_a_mode() -> Results {
        let mut results = Results::read(RESULTS).expect("a results document");
        let modes = json!({ "driving": [], "driven": [{
            "frequency_hz": 4000.0, "nodal_diameters": 2, "nodal_circles": 0, "direction": "out_of_plane", "is_double": true, "wave_split": 2.0,
            "crossings": [
                { "label": "H_Z2", "driving_speed_rpm": 4615.384615, "wave": "backward" },
                { "label": "H_Z2", "driving_speed_rpm": 5000.0, "wave": "forward" },
            ],
        }] });
        results.modes = Some(serde_json::from_value(modes).expect("modes"));
        results
    }

    #[test]
    fn a_table_of_modes_has_a_line_for_each_crossing() {
        let modes = with_a_mode().modes.expect("put in above");
        let lines = [
            "gear,mode,frequency_hz,nodal_diameters,nodal_circles,direction,is_double,wave_split,label,driving_speed_rpm,wave",
            "driven,1,4000.0,2,0,out_of_plane,true,2.0,H_Z2,4615.384615,backward",
            "driven,1,4000.0,2,0,out_of_plane,true,2.0,H_Z2,5000.0,forward",
            "",
        ];
        assert_eq!(csv(&modes), lines.join("\r\n"));
    }

    #[test]
    fn a_campbell_diagram_has_a_panel_for_each_gear_and_results_without_modes_have_none() {
        let svg = draw(&with_a_mode()).expect("there are modes");
        for words in [
            "driving gear",
            "driven gear",
            "out of the plane",
            "mesh order",
        ] {
            assert!(svg.contains(words), "{words}");
        }
        assert!(!svg.contains("NaN"));
        let bare = Results::read(RESULTS).expect("a results document");
        assert!(draw(&bare).is_none());
    }
}
