//! The columns of the curves of results: which table has which, as JSON and as CSV.

use meshwright_wire::csv::CsvWriter;
use meshwright_wire::results::{
    CurveDocument, CurveDynamicsDocument, FaceDocument, NamedOrderDocument, ResonanceDocument,
};
use meshwright_wire::{Code, Problem};
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

/// Content of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Table {
    TransmissionError,
    MeshStiffness,
    Spectrum,
    RunUp,
    FaceLoad,
}

/// A table of the results as JSON: for each curve its torque, and the columns of the table, which have one value for each
/// position or order. A column that the results do not have is absent.
#[derive(Serialize, ToSchema)]
#[schema(title = "CurveTable")]
pub(super) struct CurveTable {
    /// One entry for each output torque.
    pub(super) curves: Vec<CurveColumns>,
}

/// Declares the columns that tables have.
macro_rules! columns {
    ($($(#[doc = $about:literal])* $name:ident: $cell:ident,)*) => {
        /// The columns of one curve.
        #[derive(Default, Serialize, ToSchema)]
        #[schema(title = "CurveColumns")]
        pub(super) struct CurveColumns {
            /// The output torque, in N m.
            output_torque_n_m: f64,
            $(
                $(#[doc = $about])*
                #[serde(skip_serializing_if = "Option::is_none")]
                $name: Option<Vec<$cell>>,
            )*
            /// The orders that have names.
            #[serde(skip_serializing_if = "Option::is_none")]
            named: Option<Vec<NamedOrderDocument>>,
            /// The speeds at which orders resonate.
            #[serde(skip_serializing_if = "Option::is_none")]
            resonances: Option<Vec<ResonanceDocument>>,
        }

        impl CurveColumns {
            /// Its columns by their names, their cells as JSON has them.
            fn cells(&self) -> [(&'static str, Option<Vec<Value>>); [$(stringify!($name)),*].len()] {
                [$((
                    stringify!($name),
                    self.$name.as_ref().map(|cells| cells.iter().map(|cell| json!(cell)).collect()),
                )),*]
            }
        }
    };
}

columns! {
    /// The position in mesh periods.
    mesh_position: f64,
    /// The angle of the driving gear, in degrees.
    driving_angle_deg: f64,
    /// The angle of the driven gear, in degrees.
    driven_angle_deg: f64,
    /// The order, for each revolution of the driven gear.
    order: f64,
    /// The frequency of the order, in Hz.
    frequency_hz: f64,
    /// The transmission error, in um; in the spectrum its amplitude.
    transmission_error_um: f64,
    /// The phase of the transmission error, in degrees.
    transmission_error_phase_deg: f64,
    /// The tangent mesh stiffness, in N/m; in the spectrum its amplitude.
    mesh_stiffness_tangent_n_per_m: f64,
    /// The phase of the tangent mesh stiffness, in degrees.
    mesh_stiffness_tangent_phase_deg: f64,
    /// The secant mesh stiffness, in N/m.
    mesh_stiffness_secant_n_per_m: f64,
    /// The middle of a strip of the common face, in mm from the middle of the face.
    z_mm: f64,
    /// The load on the strip for its width, in N/mm: the mean over the positions, where none stands beside it.
    load_n_per_mm: f64,
    /// The speed of the driving gear, in 1/min: of the branch that runs up, and again of the one that runs down.
    driving_speed_rpm: f64,
    /// `up` or `down`.
    branch: String,
    /// The root mean square of the dynamic transmission error, in um.
    rms_um: f64,
    /// Its largest less its smallest value, in um.
    peak_to_peak_um: f64,
    /// The largest force between the gears over the static load.
    dynamic_load_factor: f64,
    /// True if the loaded flanks separate.
    contact_lost: bool,
    /// True periods after which the motion repeats; 0 where it was not found to.
    period_multiple: u32,
}

impl CurveColumns {
    /// The columns of `table`, if the curve has them.
    fn of(table: Table, curve: &CurveDocument) -> Option<Self> {
        let torque = Self {
            output_torque_n_m: curve.output_torque_n_m,
            ..Self::default()
        };
        if table == Table::Spectrum {
            let spectrum = curve.spectrum.as_ref()?;
            return Some(Self {
                order: column(&spectrum.order),
                frequency_hz: spectrum.frequency_hz.clone(),
                transmission_error_um: column(&spectrum.transmission_error_um),
                transmission_error_phase_deg: column(&spectrum.transmission_error_phase_deg),
                mesh_stiffness_tangent_n_per_m: column(&spectrum.mesh_stiffness_tangent_n_per_m),
                mesh_stiffness_tangent_phase_deg: column(
                    &spectrum.mesh_stiffness_tangent_phase_deg,
                ),
                named: Some(spectrum.named.clone()),
                ..torque
            });
        }
        if table == Table::RunUp {
            return torque.with_branches(curve.dynamics.as_ref()?);
        }
        if table == Table::FaceLoad {
            return Some(torque.with_strips(curve.face.as_ref()?, &curve.mesh_position));
        }
        let positions = Self {
            mesh_position: column(&curve.mesh_position),
            driving_angle_deg: column(&curve.driving_angle_deg),
            driven_angle_deg: column(&curve.driven_angle_deg),
            ..torque
        };
        Some(if table == Table::TransmissionError {
            Self {
                transmission_error_um: column(&curve.transmission_error_um),
                ..positions
            }
        } else {
            Self {
                mesh_stiffness_tangent_n_per_m: column(&curve.mesh_stiffness_tangent_n_per_m),
                mesh_stiffness_secant_n_per_m: column(&curve.mesh_stiffness_secant_n_per_m),
                ..positions
            }
        })
    }

    /// With the branches of a run-up one after the other, up first.
    fn with_branches(self, dynamics: &CurveDynamicsDocument) -> Option<Self> {
        let branches = [("up", &dynamics.up), ("down", &dynamics.down)];
        let branches = branches.map(|(word, branch)| Some((word, branch.as_ref()?)));
        let speeds = &dynamics.driving_speed_rpm;
        let mut columns = Self {
            resonances: Some(dynamics.resonances.clone()),
            ..self
        };
        for (word, branch) in branches.into_iter().flatten() {
            let error = &branch.dynamic_transmission_error_um;
            append(&mut columns.driving_speed_rpm, speeds);
            append(&mut columns.branch, &vec![word.to_owned(); speeds.len()]);
            append(&mut columns.rms_um, &error.rms);
            append(&mut columns.peak_to_peak_um, &error.peak_to_peak);
            append(
                &mut columns.dynamic_load_factor,
                &branch.dynamic_load_factor,
            );
            append(&mut columns.contact_lost, &branch.contact_lost);
            append(&mut columns.period_multiple, &branch.period_multiple);
        }
        Some(columns)
    }

    /// With the strips of the face, position after position where the results tell each.
    fn with_strips(self, face: &FaceDocument, positions: &[f64]) -> Self {
        let rows = &face.load_n_per_mm;
        let of_strips = |position: &f64| vec![*position; face.z_mm.len()];
        Self {
            mesh_position: (rows.len() > 1).then(|| positions.iter().flat_map(of_strips).collect()),
            z_mm: Some(face.z_mm.repeat(rows.len())),
            load_n_per_mm: Some(rows.concat()),
            ..self
        }
    }
}

/// A list of the results as a column: an earlier version may not have written it.
fn column(list: &[f64]) -> Option<Vec<f64>> {
    (!list.is_empty()).then(|| list.to_vec())
}

fn append<T: Clone>(column: &mut Option<Vec<T>>, cells: &[T]) {
    column.get_or_insert_default().extend_from_slice(cells);
}

/// The columns of `table` of those curves that have them.
pub(super) fn select(
    table: Table,
    curves: &[&CurveDocument],
) -> Result<Vec<CurveColumns>, Problem> {
    let columns = curves
        .iter()
        .filter_map(|curve| CurveColumns::of(table, curve));
    let selected: Vec<_> = columns.collect();
    if selected.is_empty() {
        Err(no_table(table))
    } else {
        Ok(selected)
    }
}

/// One line for each torque and position or order. Numbers are written as they stand in the results.
pub(super) fn csv(curves: &[CurveColumns]) -> String {
    let cells: Vec<_> = curves.iter().map(CurveColumns::cells).collect();
    let present = |column: &usize| cells.iter().any(|cells| cells[*column].1.is_some());
    let columns = cells.first().map_or(0, |cells| cells.len());
    let columns: Vec<usize> = (0..columns).filter(present).collect();
    let mut text = CsvWriter::default();
    text.text("output_torque_n_m");
    for &column in &columns {
        text.text(cells[0][column].0);
    }
    text.end_line();
    for (curve, cells) in curves.iter().zip(&cells) {
        let columns: Vec<&[Value]> = columns
            .iter()
            .map(|&column| cells[column].1.as_deref().unwrap_or_default())
            .collect();
        for row in 0..columns.iter().map(|cells| cells.len()).max().unwrap_or(0) {
            text.number(Some(curve.output_torque_n_m));
            for column in &columns {
                text.value(column.get(row));
            }
            text.end_line();
        }
    }
    text.into_text()
}

/// Problem of results that have no `table`.
pub(super) fn no_table(table: Table) -> Problem {
    let detail = match table {
        Table::Spectrum => {
            "These results have no spectrum: they span no whole number of true periods."
        }
        Table::RunUp => "These results have no run-up: the submission asks for no dynamics.",
        Table::FaceLoad => {
            "These results have no load along the face: a plane method spreads it evenly."
        }
        _ => "These results have no such table.",
    };
    Problem::new(Code::NotFound, detail)
}
