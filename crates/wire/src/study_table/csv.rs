//! The table as CSV: one line for each row and torque, a row without curves having one line.

use super::pareto::Told;
use super::row::{RowCurve, TableRow};
use crate::csv::CsvWriter;

/// The columns behind the label and the changes.
const FIXED: [&str; 12] = [
    "job",
    "status",
    "method",
    "mass_kg",
    "mass_removed_percent",
    "least_ligament_mm",
    "polar_inertia_kg_m2",
    "pair_mass_kg",
    "contact_ratio",
    "backlash_mm",
    "pareto",
    "output_torque_n_m",
];

/// The largest stresses, in the tables of studies that ask for them.
const STRESSES: [&str; 8] = [
    "statistics.stress.driving.root_mpa",
    "statistics.stress.driving.root_tension_mpa",
    "statistics.stress.driving.root_compression_mpa",
    "statistics.stress.driving.hole_mpa",
    "statistics.stress.driven.root_mpa",
    "statistics.stress.driven.root_tension_mpa",
    "statistics.stress.driven.root_compression_mpa",
    "statistics.stress.driven.hole_mpa",
];

/// How even the load is along the face, in the tables of studies that see it.
const FACE_LOAD_FACTOR: &str = "face_load_factor";

/// What holes alone make of their order, in the tables of studies whose teeth deviate.
const HOLES_ALONE: &str = "hole_order_of_holes_um";

/// The last columns.
const LAST: [&str; 4] = [
    "hole_order_um",
    "mesh_order_um",
    "problem.code",
    "problem.detail",
];

/// The columns of a table, whose lines can be written some at a time. Columns bear the names of the JSON, joined by dots;
/// `changes.` is followed by the pointer.
#[derive(Debug, Clone)]
pub struct CsvTable {
    pointers: Vec<String>,
    told: Told,
}

impl CsvTable {
    /// A table whose rows change what is at these pointers, with columns for what it has `told`.
    pub fn new(pointers: Vec<String>, told: Told) -> Self {
        Self { pointers, told }
    }

    /// The line of names.
    pub fn header(&self) -> String {
        let spread = |name: &'static str| {
            ["mean", "rms", "peak_to_peak"].map(|part| format!("statistics.{name}.{part}"))
        };
        let mut text = CsvWriter::new();
        text.text("label");
        for pointer in &self.pointers {
            text.text(&format!("changes.{pointer}"));
        }
        for name in FIXED {
            text.text(name);
        }
        for name in [
            spread("transmission_error_um"),
            spread("mesh_stiffness_tangent_n_per_m"),
        ]
        .concat()
        {
            text.text(&name);
        }
        let stresses = STRESSES.into_iter().filter(|_| self.told.stress);
        let faces = [FACE_LOAD_FACTOR].into_iter().filter(|_| self.told.faces);
        let alone = [HOLES_ALONE].into_iter();
        let alone = alone.filter(|_| self.told.holes_alone);
        for name in stresses.chain(faces).chain(alone).chain(LAST) {
            text.text(name);
        }
        text.end_line();
        text.into_text()
    }

    /// The lines of some rows.
    pub fn lines<'a>(&self, rows: impl IntoIterator<Item = &'a TableRow>) -> String {
        let mut text = CsvWriter::new();
        for row in rows {
            if row.curves.is_empty() {
                self.line(&mut text, row, None);
            }
            for curve in &row.curves {
                self.line(&mut text, row, Some(curve));
            }
        }
        text.into_text()
    }

    fn line(&self, text: &mut CsvWriter, row: &TableRow, curve: Option<&RowCurve>) {
        text.text(&row.label);
        for pointer in &self.pointers {
            text.value(row.changes.get(pointer));
        }
        text.text(&row.job.map_or_else(String::new, |job| job.to_string()));
        text.text(row.status.as_str());
        text.text(row.method.as_deref().unwrap_or_default());
        for number in [
            row.mass_kg,
            row.mass_removed_percent,
            row.least_ligament_mm,
            row.polar_inertia_kg_m2,
            row.pair_mass_kg,
            row.contact_ratio,
            row.backlash_mm,
        ] {
            text.number(number);
        }
        text.text(if row.pareto { "true" } else { "false" });
        cells_of_curve(text, curve, self.told);
        for part in ["code", "detail"] {
            text.value(row.problem.as_ref().and_then(|problem| problem.get(part)));
        }
        text.end_line();
    }
}

fn cells_of_curve(text: &mut CsvWriter, curve: Option<&RowCurve>, told: Told) {
    let statistics = curve.and_then(|curve| curve.statistics.as_ref());
    let ste = statistics.map(|statistics| &statistics.transmission_error_um);
    let k = statistics.map(|statistics| &statistics.mesh_stiffness_tangent_n_per_m);
    text.number(curve.map(|curve| curve.output_torque_n_m));
    for values in [ste, k] {
        text.number(values.map(|values| values.mean));
        text.number(values.map(|values| values.rms));
        text.number(values.map(|values| values.peak_to_peak));
    }
    if told.stress {
        let stress = statistics.and_then(|statistics| statistics.stress.as_ref());
        let (driving, driven) = (stress.map(|s| &s.driving), stress.map(|s| &s.driven));
        for gear in [driving, driven] {
            text.number(gear.map(|gear| gear.root_mpa));
            text.number(gear.and_then(|gear| gear.root_tension_mpa));
            text.number(gear.and_then(|gear| gear.root_compression_mpa));
            text.number(gear.and_then(|gear| gear.hole_mpa));
        }
    }
    if told.faces {
        text.number(curve.and_then(|curve| curve.face_load_factor));
    }
    if told.holes_alone {
        text.number(curve.and_then(|curve| curve.hole_order_of_holes_um));
    }
    text.number(curve.and_then(|curve| curve.hole_order_um));
    text.number(curve.and_then(|curve| curve.mesh_order_um));
}
