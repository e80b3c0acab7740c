//! One curve as a look-up table over the angle, in SI units, for rotor dynamics and multibody codes.
//!
//! A head tells datum, signs and period, so that the file is enough by itself. The last row repeats the first at the end of the true
//! period: a reader that interpolates between rows and wraps at the last angle is right everywhere.

use serde_json::json;

use crate::wire::Results;
use crate::wire::results::CurveDocument;

/// How rows and remarks are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Commas, remarks after `#`: NumPy, pandas, ROSS.
    Csv,
    /// Spaces, remarks after `%`: the spreadsheet form of COMSOL, and what multibody codes import.
    Text,
}

/// The columns, with their units.
const COLUMNS: [&str; 4] = [
    "driving_angle_rad",
    "driven_angle_rad",
    "mesh_stiffness_n_per_m",
    "transmission_error_m",
];

impl Form {
    fn remark(self) -> char {
        match self {
            Self::Csv => '#',
            Self::Text => '%',
        }
    }

    fn between(self) -> &'static str {
        match self {
            Self::Csv => ",",
            Self::Text => " ",
        }
    }
}

/// The table of one curve of the results. `None` where the curve spans no whole true period: it could not be repeated.
pub fn table(results: &Results, curve: &CurveDocument, form: Form) -> Option<String> {
    let rows = Rows::of(results, curve)?;
    let mut text = head(results, curve, &rows, form);
    let line = |values: [f64; 4]| {
        let written: Vec<String> = values.iter().map(|value| format!("{value:.9e}")).collect();
        written.join(form.between())
    };
    for row in &rows.rows {
        text.push_str(&line(*row));
        text.push('\n');
    }
    Some(text)
}

/// The rows of a table, the first again at the end.
struct Rows {
    rows: Vec<[f64; 4]>,
    periods: f64,
}

impl Rows {
    fn of(results: &Results, curve: &CurveDocument) -> Option<Self> {
        let positions = &curve.mesh_position;
        let step = positions.get(1)? - positions.first()?;
        let periods = (step * positions.len() as f64).round();
        let true_period = f64::from(results.pair.period_mesh_periods);
        if true_period <= 0.0 || periods <= 0.0 || periods % true_period != 0.0 {
            return None;
        }
        let row = |i: usize| -> Option<[f64; 4]> {
            Some([
                curve.driving_angle_deg.get(i)?.to_radians(),
                curve.driven_angle_deg.get(i)?.to_radians(),
                *curve.mesh_stiffness_tangent_n_per_m.get(i)?,
                curve.transmission_error_um.get(i)? * 1e-6,
            ])
        };
        let mut rows = (0..positions.len()).map(row).collect::<Option<Vec<_>>>()?;
        let again = *rows.first()?;
        let span = |angles: &[f64]| (angles[1] - angles[0]).to_radians() * positions.len() as f64;
        rows.push([
            again[0] + span(&curve.driving_angle_deg),
            again[1] + span(&curve.driven_angle_deg),
            again[2],
            again[3],
        ]);
        Some(Self { rows, periods })
    }
}

fn head(results: &Results, curve: &CurveDocument, rows: &Rows, form: Form) -> String {
    let [driving, driven] = [&results.pair.driving, &results.pair.driven];
    let remark = form.remark();
    let mut text: String = [
        "Meshwright look-up table, form 1: mesh stiffness and static transmission error over the true period".to_owned(),
        format!("method: {}", results.method),
        // As JSON writes them.
        format!("output_torque_n_m: {}", json!(curve.output_torque_n_m)),
        format!("load_n: {}", json!(curve.load_n)),
        format!("driving_base_radius_m: {}", driving.base_radius_mm * 1e-3),
        format!("driven_base_radius_m: {}", driven.base_radius_mm * 1e-3),
        format!("period_mesh_periods: {}", rows.periods),
        "datum: at angle 0 of both gears a pair of teeth touches at the pitch point; each angle grows in the sense in which its gear turns".to_owned(),
        "signs: the transmission error is positive where load makes the driven gear lag, a length along the line of action: the driven base radius times the angle of lag".to_owned(),
        "stiffness: tangent, dF/d(transmission error) along the line of action; the last row is the first one a period later".to_owned(),
    ]
    .iter()
    .map(|line| format!("{remark} {line}\n"))
    .collect();
    match form {
        Form::Csv => text += &COLUMNS.join(","),
        Form::Text => text += &format!("{remark} {}", COLUMNS.join(" ")),
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::results::STUB;

    fn results() -> Results {
        let mut results = Results::read(STUB).expect("a results document");
        results.pair.period_mesh_periods = 2;
        results.pair.driven.base_radius_mm = 50.0;
        let curve = &mut results.curves[0];
        curve.mesh_position = vec![0.0, 0.5, 1.0, 1.5];
        curve.driving_angle_deg = vec![0.0, 9.0, 18.0, 27.0];
        curve.driven_angle_deg = vec![0.0, 4.5, 9.0, 13.5];
        curve.mesh_stiffness_tangent_n_per_m = vec![2.0e8, 1.5e8, 2.1e8, 1.4e8];
        curve.transmission_error_um = vec![13.0, 14.0, 13.5, 14.5];
        results
    }

    #[test]
    fn the_last_row_is_the_first_a_period_later() {
        let results = results();
        let text = table(&results, &results.curves[0], Form::Csv).expect("a whole period");
        let rows: Vec<Vec<f64>> = text
            .lines()
            .filter(|line| !line.starts_with('#'))
            .skip(1)
            .map(|line| {
                line.split(',')
                    .map(|cell| cell.parse().expect("a number"))
                    .collect()
            })
            .collect();
        assert_eq!(rows.len(), 5);
        // Four steps of 9 and of 4.5 degrees.
        assert!((rows[4][0] - 36_f64.to_radians()).abs() < 1e-9);
        assert!((rows[4][1] - 18_f64.to_radians()).abs() < 1e-9);
        assert_eq!(rows[4][2..], rows[0][2..]);
        assert!((rows[1][3] - 14e-6).abs() < 1e-14);
    }

    #[test]
    fn the_head_tells_datum_signs_and_period_in_both_forms() {
        let results = results();
        for (form, remark) in [(Form::Csv, "# "), (Form::Text, "% ")] {
            let text = table(&results, &results.curves[0], form).expect("a whole period");
            for said in [
                "datum: ",
                "signs: ",
                "period_mesh_periods: 2",
                "output_torque_n_m: 115",
                "driven_base_radius_m: 0.05",
            ] {
                assert!(text.contains(&format!("{remark}{said}")), "{said}: {text}");
            }
        }
        let text = table(&results, &results.curves[0], Form::Text).expect("a whole period");
        let first = text
            .lines()
            .find(|line| !line.starts_with('%'))
            .expect("rows");
        assert_eq!(first.split(' ').count(), 4);
    }

    #[test]
    fn a_span_that_cannot_be_repeated_has_no_table() {
        let mut results = results();
        results.pair.period_mesh_periods = 5;
        assert_eq!(table(&results, &results.curves[0], Form::Csv), None);
        results.pair.period_mesh_periods = 0;
        assert_eq!(table(&results, &results.curves[0], Form::Csv), None);
    }
}
