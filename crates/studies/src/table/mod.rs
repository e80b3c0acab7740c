//! The table of a study: a row for each design, with the few numbers that designs are compared by.

mod csv;
mod named;
mod pareto;
mod quantity;
mod row;
mod summary;
#[cfg(test)]
mod tests;

use meshwright_wire::Status;
use meshwright_wire::problem::Problem;
use meshwright_wire::warning::GearName;
use serde::Serialize;
use serde_json::Value;
use utoipa::ToSchema;
use uuid::Uuid;

pub use self::csv::CsvTable;
pub(crate) use named::name_quantities;
pub use pareto::{KnownQuantities, Outline};
pub use quantity::{Better, Quantity, QuantityEntry, QuantityOf, quantities};
pub(crate) use quantity::{Of, QUANTITIES};
pub use row::{RowCurve, RowMeshOrders, RowState, TableRow};
pub(crate) use summary::CurveSummary;
pub use summary::{HolePhaseSummary, Summary};

/// The table of a study. It can be read at any time; rows fill as their designs are computed.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(title = "Study results")]
pub struct StudyResults {
    /// The study; null for a study that was computed from the command line.
    pub id: Option<Uuid>,
    /// Where it stands; `failed` when no design could be computed.
    pub status: Status,
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

/// Rows of all designs with their outcomes, for `gear`, the study's.
pub fn table(gear: GearName, states: Vec<RowState>) -> Vec<TableRow> {
    let mut outline = Outline::default();
    for state in &states {
        outline.add(state);
    }
    let rows = states.into_iter().zip(outline.front());
    rows.map(|(state, pareto)| TableRow::new(gear, state, pareto))
        .collect()
}

/// The whole table as CSV.
pub fn csv(rows: &[TableRow]) -> String {
    let mut pointers: Vec<String> = Vec::new();
    for pointer in rows.iter().flat_map(|row| row.changes.keys()) {
        if !pointers.contains(pointer) {
            pointers.push(pointer.clone());
        }
    }
    let mut quantities = KnownQuantities::default();
    rows.iter().for_each(|row| quantities.add(row.summary()));
    let table = CsvTable::new(pointers, quantities);
    table.header() + &table.lines(rows)
}
