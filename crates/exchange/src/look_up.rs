//! One curve as a look-up table over the angle, in SI units, for rotor dynamics and multibody codes.
//!
//! A head tells datum, signs and period, so that the file is enough by itself. The last row repeats the first at the end of the true
//! period: a reader that interpolates between rows and wraps at the last angle is right everywhere.

use serde_json::json;

/// How rows and remarks are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Commas, remarks after `#`: NumPy, pandas, ROSS.
    Csv,
    /// Spaces, remarks after `%`: the spreadsheet form of COMSOL, and the import of multibody codes.
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

/// One curve over whole true periods.
pub struct LookUp<'a> {
    /// The method's word.
    pub method: &'a str,
    /// T in N m.
    pub output_torque: f64,
    /// F in N.
    pub load: f64,
    /// In m, driving and driven.
    pub base_radii: [f64; 2],
    /// The mesh periods that the curve spans.
    pub periods: f64,
    /// The angles of both gears in degrees, by position.
    pub angles_deg: [&'a [f64]; 2],
    /// dF/dδ in N/m.
    pub stiffness: &'a [f64],
    /// δ in um.
    pub transmission_error_um: &'a [f64],
}

impl LookUp<'_> {
    /// The table, the first row again at the end. `None` without two positions, or where a list is shorter than another.
    pub fn write(&self, form: Form) -> Option<String> {
        let mut text = self.head(form);
        for row in self.rows()? {
            let written = row.map(|value| format!("{value:.9e}"));
            text.push_str(&written.join(form.between()));
            text.push('\n');
        }
        Some(text)
    }

    fn rows(&self) -> Option<Vec<[f64; 4]>> {
        let [driving, driven] = self.angles_deg;
        let row = |i: usize| -> Option<[f64; 4]> {
            Some([
                driving.get(i)?.to_radians(),
                driven.get(i)?.to_radians(),
                *self.stiffness.get(i)?,
                self.transmission_error_um.get(i)? * 1e-6,
            ])
        };
        let mut rows = (0..driving.len()).map(row).collect::<Option<Vec<_>>>()?;
        let [first, second] = *rows.first_chunk()?;
        let span = |column: usize| (second[column] - first[column]) * rows.len() as f64;
        rows.push([first[0] + span(0), first[1] + span(1), first[2], first[3]]);
        Some(rows)
    }

    fn head(&self, form: Form) -> String {
        let [driving, driven] = self.base_radii;
        let remark = form.remark();
        let mut text: String = [
            "Meshwright look-up table, form 1: mesh stiffness and static transmission error over the true period".to_owned(),
            format!("method: {}", self.method),
            // As JSON writes them.
            format!("output_torque_n_m: {}", json!(self.output_torque)),
            format!("load_n: {}", json!(self.load)),
            format!("driving_base_radius_m: {driving}"),
            format!("driven_base_radius_m: {driven}"),
            format!("period_mesh_periods: {}", self.periods),
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
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: LookUp<'_> = LookUp {
        method: "flexible",
        output_torque: 115.0,
        load: 2300.0,
        base_radii: [0.04, 0.05],
        periods: 2.0,
        angles_deg: [&[0.0, 9.0, 18.0, 27.0], &[0.0, 4.5, 9.0, 13.5]],
        stiffness: &[2.0e8, 1.5e8, 2.1e8, 1.4e8],
        transmission_error_um: &[13.0, 14.0, 13.5, 14.5],
    };

    #[test]
    fn the_last_row_is_the_first_a_period_later() {
        let text = CURVE.write(Form::Csv).expect("rows");
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
        for (form, remark) in [(Form::Csv, "# "), (Form::Text, "% ")] {
            let text = CURVE.write(form).expect("rows");
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
        let text = CURVE.write(Form::Text).expect("rows");
        let first = text
            .lines()
            .find(|line| !line.starts_with('%'))
            .expect("rows");
        assert_eq!(first.split(' ').count(), 4);
    }
}
