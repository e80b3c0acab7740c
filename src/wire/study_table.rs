//! The table of a study: a row for each design, with the few numbers that designs are compared by.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use utoipa::ToSchema;
use uuid::Uuid;

use super::problem::Problem;
use super::results::StatisticsDocument;
use super::units::significant;
use super::warning::GearName;

/// What of a results document a table shows. It is kept beside the document, so that a table of thousands of rows reads
/// kilobytes where the documents have hundreds of megabytes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    #[serde(default)]
    method: Option<String>,
    #[serde(default)]
    driving: GearSummary,
    #[serde(default)]
    driven: GearSummary,
    #[serde(default)]
    curves: Vec<CurveSummary>,
}

/// The mass of a gear and what holes leave of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Gear of a row")]
pub struct GearSummary {
    /// The mass of the true profile, in kg.
    pub mass_kg: Option<f64>,
    /// The share of the blank that the holes remove, in percent.
    pub mass_removed_percent: Option<f64>,
    /// The least material around the holes, in mm; null without holes.
    pub least_ligament_mm: Option<f64>,
    /// The polar moment of inertia of the true profile, in kg m2.
    pub polar_inertia_kg_m2: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct CurveSummary {
    output_torque_n_m: f64,
    statistics: Option<StatisticsDocument>,
    /// Amplitudes of the transmission error, in um, by the names of their orders.
    orders: BTreeMap<String, f64>,
}

/// The names of orders that a table shows.
const ORDERS: [&str; 4] = [
    MESH_ORDER,
    HOLE_ORDER,
    DRIVING_HOLE_ORDER,
    DRIVEN_HOLE_ORDER,
];
const MESH_ORDER: &str = "H_Z2";
/// The holes of the only holed gear, or of both if they make the same order.
const HOLE_ORDER: &str = "H_N";
const DRIVING_HOLE_ORDER: &str = "H_N1";
const DRIVEN_HOLE_ORDER: &str = "H_N2";

impl Summary {
    /// The summary of a results document. Its curves are passed over, not kept. None if it is no results document.
    pub fn of_document(document: &str) -> Option<Self> {
        #[derive(Deserialize)]
        struct Glance {
            method: Option<String>,
            #[serde(default)]
            pair: Pair,
            #[serde(default)]
            curves: Vec<Curve>,
        }
        #[derive(Default, Deserialize)]
        #[serde(default)]
        struct Pair {
            driving: GearSummary,
            driven: GearSummary,
        }
        #[derive(Deserialize)]
        struct Curve {
            output_torque_n_m: f64,
            statistics: Option<StatisticsDocument>,
            spectrum: Option<Spectrum>,
        }
        #[derive(Deserialize)]
        struct Spectrum {
            #[serde(default)]
            named: Vec<Line>,
        }
        #[derive(Deserialize)]
        struct Line {
            label: String,
            transmission_error_um: Option<f64>,
        }

        let Glance {
            method,
            pair,
            curves,
        } = serde_json::from_str(document).ok()?;
        let curve = |curve: Curve| {
            let named = curve
                .spectrum
                .map_or_else(Vec::new, |spectrum| spectrum.named);
            let orders = named.into_iter().filter_map(|line| {
                let shown = ORDERS.contains(&line.label.as_str());
                line.transmission_error_um
                    .filter(|_| shown)
                    .map(|amplitude| (line.label, amplitude))
            });
            CurveSummary {
                output_torque_n_m: curve.output_torque_n_m,
                statistics: curve.statistics,
                orders: orders.collect(),
            }
        };
        Some(Self {
            method,
            driving: pair.driving,
            driven: pair.driven,
            curves: curves.into_iter().map(curve).collect(),
        })
    }
}

/// A design and what has come of it so far.
#[derive(Debug, Clone, PartialEq)]
pub struct RowState {
    /// What the design is called.
    pub label: String,
    /// What it changes in the base.
    pub changes: Map<String, Value>,
    /// The job that computes it, if it could be built.
    pub job: Option<Uuid>,
    /// `accepted`, `running`, `successful`, `failed` or `dismissed`.
    pub status: &'static str,
    /// What of its results is shown, once there are some.
    pub summary: Option<Summary>,
    /// Why it has no results.
    pub problem: Option<Value>,
}

/// The table of a study. It can be read at any time; rows fill as their designs are computed.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Study results")]
pub struct StudyResults {
    /// The study; null for a study that was computed from the command line.
    #[schema(value_type = Option<String>, format = "uuid")]
    pub id: Option<Uuid>,
    /// `accepted`, `running`, `successful`, `failed` (no design could be computed) or `dismissed`.
    pub status: &'static str,
    /// Designs that have come to an end, whichever.
    pub done: u64,
    /// Designs in all.
    pub total: u64,
    /// The gear that `mass_kg` and its neighbors tell of: the one of constant mass, else the only one that the study
    /// changes, else the driven one.
    pub gear: GearName,
    /// Of a failed study: why.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Problem>)]
    pub problem: Option<Value>,
    /// One row for each design, in the order of the study: designs as they are listed, axes with the last one changing
    /// fastest.
    pub rows: Vec<TableRow>,
}

/// A design, and the numbers that designs are compared by.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Row")]
pub struct TableRow {
    /// What the design is called.
    pub label: String,
    /// What it changes in the base: JSON pointers and values, the hole radius among them where the study sets it.
    #[schema(value_type = Object)]
    pub changes: Map<String, Value>,
    /// The job that computes it; null for a design that could not be built.
    #[schema(value_type = Option<String>, format = "uuid")]
    pub job: Option<Uuid>,
    /// `accepted`, `running`, `successful`, `failed` or `dismissed`.
    pub status: &'static str,
    /// The method that computed it; null until then.
    pub method: Option<String>,
    /// The mass of the study's gear, in kg.
    pub mass_kg: Option<f64>,
    /// The share of its blank that the holes remove, in percent.
    pub mass_removed_percent: Option<f64>,
    /// The least material around its holes, in mm; null without holes.
    pub least_ligament_mm: Option<f64>,
    /// Its polar moment of inertia, in kg m2.
    pub polar_inertia_kg_m2: Option<f64>,
    /// The mass of both gears, in kg.
    pub pair_mass_kg: Option<f64>,
    /// Whether no other design of the study is at least as good in everything and better in something, of those that
    /// were computed by the same method at the same torques so far. Compared are the mass of both gears (less is
    /// better), the largest peak-to-peak transmission error over the torques (less), and the mean tangent stiffness,
    /// averaged over the torques (more), each to six significant digits.
    pub pareto: bool,
    /// One entry for each output torque.
    pub curves: Vec<RowCurve>,
    /// Why the design has no results; its pointers lead into the design's submission.
    #[schema(value_type = Option<Problem>)]
    pub problem: Option<Value>,
}

/// The numbers of one design at one torque.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Curve of a row")]
pub struct RowCurve {
    /// The output torque on the driven gear, in N m.
    pub output_torque_n_m: f64,
    /// Statistics over the span, as in the results.
    pub statistics: Option<StatisticsDocument>,
    /// The amplitude of the transmission error at the order of the holes, H_N, in um. Where the holes of both gears make
    /// different orders it is that of the study's gear. Null without holes or spectrum.
    pub hole_order_um: Option<f64>,
    /// The amplitude of the transmission error at the mesh order, H_Z2, in um; null without spectrum.
    pub mesh_order_um: Option<f64>,
}

/// Makes rows of what has come of designs, `gear` being the study's.
pub fn table(gear: GearName, states: Vec<RowState>) -> Vec<TableRow> {
    let front = pareto_front(&states);
    let row = |(state, pareto): (RowState, bool)| {
        let summary = state.summary.unwrap_or_default();
        let own = match gear {
            GearName::Driving => summary.driving,
            GearName::Driven => summary.driven,
        };
        TableRow {
            label: state.label,
            changes: state.changes,
            job: state.job,
            status: state.status,
            pair_mass_kg: summary.pair_mass(),
            method: summary.method,
            mass_kg: own.mass_kg,
            mass_removed_percent: own.mass_removed_percent,
            least_ligament_mm: own.least_ligament_mm,
            polar_inertia_kg_m2: own.polar_inertia_kg_m2,
            pareto,
            curves: summary
                .curves
                .into_iter()
                .map(|curve| RowCurve::of(gear, curve))
                .collect(),
            problem: state.problem,
        }
    };
    states.into_iter().zip(front).map(row).collect()
}

impl Summary {
    fn pair_mass(&self) -> Option<f64> {
        let sum = self.driving.mass_kg? + self.driven.mass_kg?;
        Some(significant(sum, 10))
    }

    /// What designs are compared by, each the less the better; none if a number is missing.
    fn objectives(&self) -> Option<[f64; 3]> {
        let mut worst_range = f64::NEG_INFINITY;
        let mut stiffness = 0.0;
        for curve in &self.curves {
            let statistics = curve.statistics.as_ref()?;
            worst_range = worst_range.max(statistics.transmission_error_um.peak_to_peak);
            stiffness += statistics.mesh_stiffness_tangent_n_per_m.mean;
        }
        if self.curves.is_empty() {
            return None;
        }
        let objectives = [
            self.pair_mass()?,
            worst_range,
            -stiffness / self.curves.len() as f64,
        ];
        // Six digits: what differs beyond them, as the masses of a study of constant mass do, is rounding and no merit.
        Some(objectives.map(|objective| significant(objective, 6)))
    }

    /// What has to be the same for a comparison to mean something: method and torques.
    fn conditions(&self) -> (Option<&str>, Vec<u64>) {
        let mut torques: Vec<u64> = self
            .curves
            .iter()
            .map(|curve| curve.output_torque_n_m.to_bits())
            .collect();
        torques.sort_unstable();
        (self.method.as_deref(), torques)
    }
}

impl RowCurve {
    fn of(gear: GearName, curve: CurveSummary) -> Self {
        let amplitude = |label: &str| curve.orders.get(label).copied();
        let own = match gear {
            GearName::Driving => DRIVING_HOLE_ORDER,
            GearName::Driven => DRIVEN_HOLE_ORDER,
        };
        Self {
            hole_order_um: amplitude(HOLE_ORDER).or_else(|| amplitude(own)),
            mesh_order_um: amplitude(MESH_ORDER),
            output_torque_n_m: curve.output_torque_n_m,
            statistics: curve.statistics,
        }
    }
}

/// Whether each design is one that no other one dominates.
fn pareto_front(states: &[RowState]) -> Vec<bool> {
    let mut groups: BTreeMap<_, Vec<(usize, [f64; 3])>> = BTreeMap::new();
    for (i, state) in states.iter().enumerate() {
        if let Some(summary) = &state.summary
            && let Some(objectives) = summary.objectives()
        {
            groups
                .entry(summary.conditions())
                .or_default()
                .push((i, objectives));
        }
    }
    let mut optimal = vec![false; states.len()];
    for (_, mut designs) in groups {
        // In lexical order a design is dominated by earlier ones only, and if by any then by one of the front.
        designs.sort_by(|(_, a), (_, b)| {
            a.iter()
                .zip(b)
                .map(|(a, b)| a.total_cmp(b))
                .find(|order| order.is_ne())
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let mut front: Vec<[f64; 3]> = Vec::new();
        for (i, design) in designs {
            let dominated = front.iter().any(|other| {
                *other != design && other.iter().zip(&design).all(|(other, own)| other <= own)
            });
            if !dominated {
                front.push(design);
                optimal[i] = true;
            }
        }
    }
    optimal
}

/// The table as CSV (RFC 4180): one line for each row and torque, a row without curves having one line. Columns bear the
/// names of the JSON, joined by dots; `changes.` is followed by the pointer.
pub fn csv(rows: &[TableRow]) -> String {
    let mut pointers: Vec<&str> = Vec::new();
    let mut known = std::collections::HashSet::new();
    for pointer in rows.iter().flat_map(|row| row.changes.keys()) {
        if known.insert(pointer) {
            pointers.push(pointer);
        }
    }
    let spread = |name: &str| {
        ["mean", "rms", "peak_to_peak"].map(|part| format!("statistics.{name}.{part}"))
    };
    let mut header: Vec<String> = vec!["label".to_owned()];
    header.extend(pointers.iter().map(|pointer| format!("changes.{pointer}")));
    let fixed = [
        "job",
        "status",
        "method",
        "mass_kg",
        "mass_removed_percent",
        "least_ligament_mm",
        "polar_inertia_kg_m2",
        "pair_mass_kg",
        "pareto",
        "output_torque_n_m",
    ];
    header.extend(fixed.map(str::to_owned));
    header.extend(spread("transmission_error_um"));
    header.extend(spread("mesh_stiffness_tangent_n_per_m"));
    let last = [
        "hole_order_um",
        "mesh_order_um",
        "problem.code",
        "problem.detail",
    ];
    header.extend(last.map(str::to_owned));

    let mut text = String::new();
    line(&mut text, header.iter().map(String::as_str));
    for row in rows {
        let mut front: Vec<String> = vec![row.label.clone()];
        let change = |pointer: &&str| row.changes.get(*pointer).map_or_else(String::new, cell);
        front.extend(pointers.iter().map(change));
        front.push(row.job.map_or_else(String::new, |job| job.to_string()));
        front.push(row.status.to_owned());
        front.push(row.method.clone().unwrap_or_default());
        let numbers = [
            row.mass_kg,
            row.mass_removed_percent,
            row.least_ligament_mm,
            row.polar_inertia_kg_m2,
            row.pair_mass_kg,
        ];
        front.extend(numbers.map(number));
        front.push(row.pareto.to_string());
        let problem = |part: &str| {
            let part = row.problem.as_ref().and_then(|problem| problem.get(part));
            part.map_or_else(String::new, cell)
        };
        let problem = [problem("code"), problem("detail")];
        let curves: Vec<Option<&RowCurve>> = if row.curves.is_empty() {
            vec![None]
        } else {
            row.curves.iter().map(Some).collect()
        };
        for curve in curves {
            let cells = front
                .iter()
                .cloned()
                .chain(curve_cells(curve))
                .chain(problem.clone());
            let cells: Vec<String> = cells.collect();
            line(&mut text, cells.iter().map(String::as_str));
        }
    }
    text
}

fn curve_cells(curve: Option<&RowCurve>) -> Vec<String> {
    let statistics = curve.and_then(|curve| curve.statistics.as_ref());
    let ste = statistics.map(|statistics| &statistics.transmission_error_um);
    let k = statistics.map(|statistics| &statistics.mesh_stiffness_tangent_n_per_m);
    let mut cells = vec![number(curve.map(|curve| curve.output_torque_n_m))];
    for values in [ste, k] {
        cells.push(number(values.map(|values| values.mean)));
        cells.push(number(values.map(|values| values.rms)));
        cells.push(number(values.map(|values| values.peak_to_peak)));
    }
    cells.push(number(curve.and_then(|curve| curve.hole_order_um)));
    cells.push(number(curve.and_then(|curve| curve.mesh_order_um)));
    cells
}

/// A number as JSON writes it; nothing for none.
fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| Value::from(value).to_string())
}

fn cell(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

fn line<'a>(text: &mut String, cells: impl Iterator<Item = &'a str>) {
    for (i, cell) in cells.enumerate() {
        if i > 0 {
            text.push(',');
        }
        if cell.contains([',', '"', '\r', '\n']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push_str("\r\n");
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// A results document with two torques, of which the second has no spectrum.
    fn document(mass: f64, ranges: [f64; 2], stiffness: f64) -> String {
        let statistics = |range: f64| {
            json!({
                "partial": false,
                "transmission_error_um": { "mean": 13.79, "rms": 0.38, "peak_to_peak": range },
                "mesh_stiffness_tangent_n_per_m": { "mean": stiffness, "rms": 2.4e7, "peak_to_peak": 6.8e7 },
            })
        };
        json!({
            "method": "flexible",
            "pair": {
                "driving": { "mass_kg": 1.0, "mass_removed_percent": 0.0, "polar_inertia_kg_m2": 1e-3 },
                "driven": {
                    "mass_kg": mass, "mass_removed_percent": 25.0, "least_ligament_mm": 5.5, "polar_inertia_kg_m2": 9e-4
                }
            },
            "curves": [
                {
                    "output_torque_n_m": 115.0, "transmission_error_um": [1.0, 2.0], "statistics": statistics(ranges[0]),
                    "spectrum": { "order": [10, 50], "named": [
                        { "order": 10, "label": "H_N", "transmission_error_um": 0.31 },
                        { "order": 50, "label": "H_Z2", "transmission_error_um": 0.42 },
                        { "order": 60, "label": "H_Z2+N", "transmission_error_um": 0.01 },
                    ] }
                },
                { "output_torque_n_m": 20.0, "transmission_error_um": [1.0], "statistics": statistics(ranges[1]) },
            ]
        })
        .to_string()
    }

    fn state(label: &str, mass: f64, ranges: [f64; 2], stiffness: f64) -> RowState {
        let changes = json!({ "/pair/driven/blank/holes/count": 10, "/method": "flexible" });
        RowState {
            label: label.to_owned(),
            changes: changes.as_object().unwrap().clone(),
            job: Some(Uuid::nil()),
            status: "successful",
            summary: Summary::of_document(&document(mass, ranges, stiffness)),
            problem: None,
        }
    }

    fn failed(label: &str) -> RowState {
        RowState {
            label: label.to_owned(),
            changes: Map::new(),
            job: None,
            status: "failed",
            summary: None,
            problem: Some(
                json!({ "code": "holes_overlap", "detail": "Too many, \"far\" too many." }),
            ),
        }
    }

    #[test]
    fn a_summary_keeps_what_the_table_shows_and_survives_the_store() {
        let summary = Summary::of_document(&document(0.9, [1.7, 2.5], 2.2e8)).unwrap();
        let stored = serde_json::to_string(&summary).unwrap();
        assert!(!stored.contains("[1.0,2.0]"), "no curve: {stored}");
        assert_eq!(serde_json::from_str::<Summary>(&stored).unwrap(), summary);
        assert_eq!(Summary::of_document("not JSON"), None);
        // A document without any of it has a summary without any of it.
        assert_eq!(Summary::of_document("{}"), Some(Summary::default()));
    }

    #[test]
    fn a_row_has_the_names_of_the_contract() {
        let rows = table(
            GearName::Driven,
            vec![state("10R34", 0.9, [1.7, 2.5], 2.2e8)],
        );
        let row = serde_json::to_value(&rows[0]).unwrap();
        for (pointer, value) in [
            ("/label", json!("10R34")),
            ("/status", json!("successful")),
            ("/mass_kg", json!(0.9)),
            ("/mass_removed_percent", json!(25.0)),
            ("/least_ligament_mm", json!(5.5)),
            ("/pareto", json!(true)),
            ("/curves/0/output_torque_n_m", json!(115.0)),
            (
                "/curves/0/statistics/transmission_error_um/peak_to_peak",
                json!(1.7),
            ),
            (
                "/curves/0/statistics/mesh_stiffness_tangent_n_per_m/mean",
                json!(2.2e8),
            ),
            ("/curves/0/hole_order_um", json!(0.31)),
            ("/curves/0/mesh_order_um", json!(0.42)),
            ("/curves/1/hole_order_um", Value::Null),
            ("/problem", Value::Null),
        ] {
            assert_eq!(row.pointer(pointer), Some(&value), "{pointer}");
        }
        let driving = table(GearName::Driving, vec![state("x", 0.9, [1.7, 2.5], 2.2e8)]);
        assert_eq!(
            (driving[0].mass_kg, driving[0].least_ligament_mm),
            (Some(1.0), None)
        );
    }

    #[test]
    fn a_design_is_on_the_front_unless_another_is_as_good_in_all_and_better_in_one() {
        let mut other_method = state("another method", 2.0, [9.0, 9.0], 1e8);
        let summary = other_method.summary.as_mut().unwrap();
        summary.method = Some("decomposition".to_owned());
        let states = vec![
            state("reference", 1.0, [1.0, 2.5], 2.0e8),
            state("lighter", 0.9, [1.0, 2.6], 1.9e8),
            state("worse in all", 1.1, [1.0, 2.7], 1.8e8),
            state("same worst torque", 1.0, [2.4, 2.5], 2.0e8),
            state("softer", 1.0, [1.0, 2.5], 1.9e8),
            state("quieter and heavier", 1.2, [1.0, 2.0], 1.5e8),
            failed("impossible"),
            other_method,
        ];
        let front: Vec<bool> = table(GearName::Driven, states)
            .iter()
            .map(|row| row.pareto)
            .collect();
        assert_eq!(front, [true, true, false, true, false, true, false, true]);
    }

    #[test]
    fn the_front_of_thousands_is_that_of_the_definition() {
        // A pseudorandom cloud, against the comparison of each with each.
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((seed >> 33) % 20) as f64
        };
        let states: Vec<RowState> = (0..400)
            .map(|i| state(&i.to_string(), random(), [random(), 0.0], random()))
            .collect();
        let values: Vec<[f64; 3]> = states
            .iter()
            .map(|state| state.summary.as_ref().unwrap().objectives().unwrap())
            .collect();
        let by_definition = |own: &[f64; 3]| {
            !values
                .iter()
                .any(|other| other != own && other.iter().zip(own).all(|(a, b)| a <= b))
        };
        let expected: Vec<bool> = values.iter().map(by_definition).collect();
        assert_eq!(pareto_front(&states), expected);
    }

    #[test]
    fn the_csv_has_a_line_for_each_row_and_torque_and_names_joined_by_dots() {
        let rows = table(
            GearName::Driven,
            vec![state("10R34", 0.9, [1.7, 2.5], 2.2e8), failed("a, \"b\"")],
        );
        let text = csv(&rows);
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(
            lines,
            [
                "label,changes./pair/driven/blank/holes/count,changes./method,job,status,method,mass_kg,mass_removed_percent,\
                 least_ligament_mm,polar_inertia_kg_m2,pair_mass_kg,pareto,output_torque_n_m,\
                 statistics.transmission_error_um.mean,statistics.transmission_error_um.rms,\
                 statistics.transmission_error_um.peak_to_peak,statistics.mesh_stiffness_tangent_n_per_m.mean,\
                 statistics.mesh_stiffness_tangent_n_per_m.rms,statistics.mesh_stiffness_tangent_n_per_m.peak_to_peak,\
                 hole_order_um,mesh_order_um,problem.code,problem.detail",
                "10R34,10,flexible,00000000-0000-0000-0000-000000000000,successful,flexible,0.9,25.0,5.5,0.0009,1.9,true,\
                 115.0,13.79,0.38,1.7,220000000.0,24000000.0,68000000.0,0.31,0.42,,",
                "10R34,10,flexible,00000000-0000-0000-0000-000000000000,successful,flexible,0.9,25.0,5.5,0.0009,1.9,true,\
                 20.0,13.79,0.38,2.5,220000000.0,24000000.0,68000000.0,,,,",
                "\"a, \"\"b\"\"\",,,,failed,,,,,,,false,,,,,,,,,,holes_overlap,\"Too many, \"\"far\"\" too many.\"",
                "",
            ]
        );
    }
}
