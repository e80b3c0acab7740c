//! The table as CSV: one line for each row and torque, a row without curves having one line.

use meshwright_wire::csv::CsvWriter;
use meshwright_wire::warning::GearName;

use super::pareto::KnownQuantities;
use super::row::TableRow;
use super::summary::CurveSummary;

/// The columns of a table, whose lines can be written some at a time. Columns bear the names of the JSON, joined by dots;
/// `changes.` is followed by the pointer.
#[derive(Debug, Clone)]
pub struct CsvTable {
    pointers: Vec<String>,
    quantities: KnownQuantities,
}

impl CsvTable {
    /// A table whose rows change the values at these pointers, with columns for the quantities in `told`.
    pub fn new(pointers: Vec<String>, quantities: KnownQuantities) -> Self {
        Self {
            pointers,
            quantities,
        }
    }

    /// The line of names.
    pub fn header(&self) -> String {
        let mut text = CsvWriter::default();
        text.text("label");
        for pointer in &self.pointers {
            text.text(&format!("changes.{pointer}"));
        }
        for name in ["job", "status", "method"] {
            text.text(name);
        }
        // Rows of any study have the same names.
        let of_pair = self.quantities.columns_of_pair(GearName::Driven);
        of_pair.for_each(|quantity| text.text(&quantity.column()));
        for name in ["pareto", "output_torque_n_m"] {
            text.text(name);
        }
        let curves = self.quantities.columns();
        curves.for_each(|quantity| text.text(&quantity.column()));
        for name in ["problem.code", "problem.detail", "warnings"] {
            text.text(name);
        }
        text.end_line();
        text.into_text()
    }

    /// The lines of some rows.
    pub fn lines<'a>(&self, rows: impl IntoIterator<Item = &'a TableRow>) -> String {
        let mut text = CsvWriter::default();
        for row in rows {
            if row.curves.is_empty() {
                self.line(&mut text, row, None);
            }
            for curve in row.summary().curves() {
                self.line(&mut text, row, Some(curve));
            }
        }
        text.into_text()
    }

    fn line(&self, text: &mut CsvWriter, row: &TableRow, curve: Option<&CurveSummary>) {
        text.text(&row.label);
        for pointer in &self.pointers {
            text.value(row.changes.get(pointer));
        }
        text.text(&row.job.map_or_else(String::new, |job| job.to_string()));
        text.text(row.status.as_str());
        text.text(row.method.as_deref().unwrap_or_default());
        let of_pair = self.quantities.columns_of_pair(row.gear());
        of_pair.for_each(|quantity| text.number(row.number(quantity, curve)));
        text.text(if row.pareto { "true" } else { "false" });
        text.number(curve.map(|curve| curve.output_torque_n_m));
        let curves = self.quantities.columns();
        curves.for_each(|quantity| text.number(row.number(quantity, curve)));
        for part in ["code", "detail"] {
            text.value(row.problem.as_ref().and_then(|problem| problem.get(part)));
        }
        let codes = row.warnings.iter().flatten().map(|code| code.to_string());
        text.text(&codes.collect::<Vec<_>>().join(" "));
        text.end_line();
    }
}
