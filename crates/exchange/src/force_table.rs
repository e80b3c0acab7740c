//! The force table of a pair for other programs: rows for a spreadsheet, tables over angle and approach for Modelica, and the resource of an FMU.
//!
//! Angles are those of the gears, each growing in the sense in which its gear turns; the approach is r_b1 θ_1 − r_b2 θ_2. The force has
//! an energy V(θ_1, δ), and the mesh exerts −r_b1 F − ∂V/∂θ_1 on the driving and r_b2 F on the driven gear: without the second term, which is
//! small, a turning mesh would make energy of nothing.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use meshwright_engine::dynamics::ForceTable;

/// How much finer than computed the tables are that others interpolate in straight lines: in position, and in load.
const REFINED: (usize, usize) = (2, 4);

/// Parts of the largest load between which rows of the table of an FMU rise by the same factor, and by which about: a kink of δ between two rows leaves
/// straight lines less than a percent beside the load.
const LIGHT: ([f64; 2], f64) = ([5e-4, 0.1], 1.11);

/// Parts of the largest load at which that table has rows below these, and from which step on above.
const BESIDE_LIGHT: ([f64; 2], f64) = ([1e-4, 2.5e-4], 0.0375);

/// Loads that differ by less than this part of them are one.
const NEXT: f64 = 0.02;

/// Columns of a table over approach for a flank that closes evenly from touch to the largest load: straight lines cut the corner at the
/// touch by less than 0.2 % of that load.
const COLUMNS: f64 = 160.0;

/// The most columns for a flank, where the touch wanders far.
const MOST_COLUMNS: usize = 320;

/// Columns in the backlash.
const IN_BACKLASH: usize = 2;

/// Parts of the dynamics that no form of the table has: the program that reads it has to add them.
pub(super) const LEFT_OUT: &str = "inertia, shafts, supports and vibrations of the gear bodies; their static compliance with bores held is in it";

/// How the table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A line for each flank, load and position.
    Csv,
    /// Two tables over angle and approach, as `CombiTable2D` of the Modelica library reads them.
    Text,
    /// A Modelica package with the element.
    Modelica,
}

/// The force table of a pair, with the lever arms that turn it into torques.
pub struct MeshForces {
    /// The table.
    pub table: ForceTable,
    /// In m, driving and driven.
    pub base_radii: [f64; 2],
    /// Of the driving gear.
    pub tooth_count: f64,
    /// The method's word.
    pub method: String,
}

impl MeshForces {
    /// The numbers of teeth, driving and driven.
    pub(super) fn tooth_counts(&self) -> [f64; 2] {
        let [r_1, r_2] = self.base_radii;
        [self.tooth_count, (self.tooth_count * r_2 / r_1).round()]
    }

    /// The output torque of the largest load in N m.
    pub(super) fn largest_output_torque(&self) -> f64 {
        self.largest_load() * self.base_radii[1]
    }

    fn largest_load(&self) -> f64 {
        self.table.loads().last().copied().unwrap_or_default()
    }

    /// The angle of the driving gear in a mesh period.
    fn pitch_angle(&self) -> f64 {
        TAU / self.tooth_count
    }

    /// The table in `form`.
    pub fn write(&self, form: Form) -> String {
        match form {
            Form::Csv => self.csv(),
            Form::Text => self.text(),
            Form::Modelica => self.modelica(),
        }
    }

    fn head(&self, mark: &str) -> String {
        let [r_1, r_2] = self.base_radii;
        [
            "Meshwright force table, form 1: the force between the gears over the true period".to_owned(),
            format!("method: {}", self.method),
            format!("driving_base_radius_m: {r_1}"),
            format!("driven_base_radius_m: {r_2}"),
            format!("driving_tooth_count: {}", self.tooth_count),
            format!("period_mesh_periods: {}", self.table.period()),
            "datum: at angle 0 of both gears a pair of teeth touches at the pitch point; each angle grows in the sense in which its gear turns".to_owned(),
            format!("left_out: {LEFT_OUT}"),
            "approach: r_b1 theta_1 - r_b2 theta_2, positive where the driven gear lags; no force in the backlash, the other flank beyond it".to_owned(),
        ]
        .iter()
        .map(|line| format!("{mark} {line}\n"))
        .collect()
    }

    fn csv(&self) -> String {
        let mut text = self.head("#");
        text.push_str("flank,load_n,mesh_position,driving_angle_rad,transmission_error_m\n");
        let flanks = [
            ("loaded", 1.0, &self.table.loaded().delta),
            ("other", -1.0, &self.table.other().delta),
        ];
        for (flank, sign, rows) in flanks {
            for (load, row) in self.table.loads().iter().zip(rows) {
                for (eta, delta) in self.table.mesh_positions().iter().zip(row) {
                    let load = sign * load + 0.0;
                    let angle = eta * self.pitch_angle();
                    writeln!(text, "{flank},{load:.9e},{eta},{angle:.9e},{delta:.9e}").ok();
                }
            }
        }
        text
    }

    /// Approaches at which a table over angle and approach has columns.
    fn approaches(&self) -> Vec<f64> {
        let (one, other) = (&self.table.loaded().delta, &self.table.other().delta);
        let fold = |row: &Vec<f64>, of: fn(f64, f64) -> f64| {
            row.iter().copied().reduce(of).unwrap_or_default()
        };
        let last = one.len() - 1;
        let ends = [
            fold(&other[last], f64::min),
            fold(&other[0], f64::max),
            fold(&one[0], f64::min),
            fold(&one[last], f64::max),
        ];
        let columns = |rows: &[Vec<f64>], range: f64| {
            let closes = rows[0]
                .iter()
                .zip(&rows[last])
                .map(|(touch, end)| (end - touch).abs());
            let least = closes.reduce(f64::min).unwrap_or_default();
            ((COLUMNS * range / least).ceil() as usize).clamp(1, MOST_COLUMNS)
        };
        let counts = [
            columns(other, ends[1] - ends[0]),
            IN_BACKLASH,
            columns(one, ends[3] - ends[2]),
        ];
        let mut approaches: Vec<f64> = Vec::new();
        for (part, &count) in counts.iter().enumerate() {
            let (from, to) = (ends[part], ends[part + 1].max(ends[part]));
            for i in 0..count {
                approaches.push(from + (to - from) * i as f64 / count as f64);
            }
        }
        approaches.push(ends[3]);
        approaches.dedup();
        approaches
    }

    /// Angles over the period, both ends included.
    fn angles(&self, table: &ForceTable) -> Vec<f64> {
        let mut positions = table.mesh_positions();
        positions.push(f64::from(table.period()));
        positions
            .iter()
            .map(|eta| eta * self.pitch_angle())
            .collect()
    }

    /// F in N and ∂V/∂θ_1 in N m, a row each angle and a column each approach.
    fn over_angle_and_approach(&self) -> [Vec<Vec<f64>>; 2] {
        let fine = self.table.refined(REFINED.0, REFINED.1);
        let approaches = self.approaches();
        let mut positions = fine.mesh_positions();
        positions.push(0.0);
        let step = f64::from(fine.period()) / fine.positions() as f64;
        let rows = |value: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
            positions
                .iter()
                .map(|eta| approaches.iter().map(|delta| value(*eta, *delta)).collect())
                .collect()
        };
        // The energy has a slope to either side of a position of its own.
        let per_angle = |eta: f64, delta: f64| {
            let beside = [-0.5, 0.5].map(|d| fine.forces(eta + d * step, delta).per_period);
            f64::midpoint(beside[0], beside[1]) / self.pitch_angle()
        };
        [rows(&|eta, delta| fine.load(eta, delta)), rows(&per_angle)]
    }

    fn text(&self) -> String {
        let fine = self.table.refined(REFINED.0, 1);
        let (angles, approaches) = (self.angles(&fine), self.approaches());
        let mut text = "#1\n".to_owned();
        text += &self.head("#");
        text += "# rows: the angle of the driving gear in rad, over the period; columns: the approach in m\n";
        text += "# force: N along the line of action; torque: the part dV/dtheta_1 of the driving gear's, N m\n";
        for (name, rows) in ["force", "torque"]
            .iter()
            .zip(self.over_angle_and_approach())
        {
            writeln!(
                text,
                "double {name}({},{})",
                angles.len() + 1,
                approaches.len() + 1
            )
            .ok();
            text += "0";
            for approach in &approaches {
                write!(text, " {approach:.9e}").ok();
            }
            text += "\n";
            for (angle, row) in angles.iter().zip(rows) {
                write!(text, "{angle:.12e}").ok();
                for value in row {
                    write!(text, " {value:.7e}").ok();
                }
                text += "\n";
            }
        }
        text
    }

    /// The loads of the table and others between them, closer where they are light.
    fn dense_loads(&self) -> Vec<f64> {
        let ([from, to], factor) = LIGHT;
        let (below, step) = BESIDE_LIGHT;
        let light = ((to / from).ln() / factor.ln()).round();
        let heavy = ((1.0 - to) / step).round();
        let parts = below
            .into_iter()
            .chain((0..=light as u32).map(|i| from * (to / from).powf(f64::from(i) / light)))
            .chain((1..heavy as u32).map(|i| to + (1.0 - to) * f64::from(i) / heavy));
        let (own, largest) = (self.table.loads(), self.largest_load());
        // Rows that were computed stand for those next to them.
        let is_new = |load: &f64| own.iter().all(|own| (own - load).abs() > NEXT * load);
        let mut loads = own.to_vec();
        loads.extend(parts.map(|part| part * largest).filter(is_new));
        loads.sort_by(f64::total_cmp);
        loads
    }

    /// The table as the FMU reads it, as doubles, little-endian: positions, rows, the period in rad, both base radii, the loads, and δ at each
    /// position under each load, of the loaded and of the other flank.
    pub(super) fn table_of_doubles(&self) -> Vec<u8> {
        let fine = self.table.under(REFINED.0, self.dense_loads());
        let [r_1, r_2] = self.base_radii;
        let period = f64::from(fine.period()) * self.pitch_angle();
        let head = [
            fine.positions() as f64,
            fine.loads().len() as f64,
            period,
            r_1,
            r_2,
        ];
        let rows = fine.loaded().delta.iter().chain(&fine.other().delta);
        head.iter()
            .chain(fine.loads())
            .chain(rows.flatten())
            .flat_map(|number| number.to_le_bytes())
            .collect()
    }

    fn modelica(&self) -> String {
        let fine = self.table.refined(REFINED.0, 1);
        let (angles, approaches) = (self.angles(&fine), self.approaches());
        let [force, torque] = self.over_angle_and_approach().map(|rows| {
            let mut text = String::from("[0");
            for approach in &approaches {
                write!(text, ", {approach:.9e}").ok();
            }
            for (angle, row) in angles.iter().zip(rows) {
                write!(text, ";\n      {angle:.12e}").ok();
                for value in row {
                    write!(text, ", {value:.7e}").ok();
                }
            }
            text + "]"
        });
        let [r_1, r_2] = self.base_radii;
        let period = angles.last().copied().unwrap_or_default();
        let head = self.head("//");
        format!(
            "{head}package MeshwrightMesh \"A gear mesh as Meshwright computed it\"
  model Mesh \"The mesh between two gears; each angle grows in the sense in which its gear turns\"
    Modelica.Mechanics.Rotational.Interfaces.Flange_a driving;
    Modelica.Mechanics.Rotational.Interfaces.Flange_b driven;
    constant Real r_1(unit=\"m\") = {r_1:e} \"Driving base radius\";
    constant Real r_2(unit=\"m\") = {r_2:e} \"Driven base radius\";
    constant Real period(unit=\"rad\") = {period:.12e} \"Angle after which the mesh repeats\";
    Real approach(unit=\"m\") \"Positive where the driven gear lags\";
    Real load(unit=\"N\") \"Along the line of action\";
  protected
    Modelica.Blocks.Tables.CombiTable2Ds force(table=MeshwrightMesh.force,
      extrapolation=Modelica.Blocks.Types.Extrapolation.LastTwoPoints);
    Modelica.Blocks.Tables.CombiTable2Ds torque(table=MeshwrightMesh.torque,
      extrapolation=Modelica.Blocks.Types.Extrapolation.LastTwoPoints);
  equation
    approach = r_1*driving.phi - r_2*driven.phi;
    force.u1 = driving.phi - period*floor(driving.phi/period);
    force.u2 = approach;
    torque.u1 = force.u1;
    torque.u2 = approach;
    load = force.y;
    driving.tau = r_1*load + torque.y;
    driven.tau = -r_2*load;
  end Mesh;

  constant Real force[:,:] = {force} \"Force in N over driving angle and approach\";
  constant Real torque[:,:] = {torque} \"Part of the driving torque in N m over driving angle and approach\";
  annotation(uses(Modelica(version=\"4.0.0\")));
end MeshwrightMesh;
"
        )
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use meshwright_engine::dynamics::{FlankRows, LoadSteps};

    use super::*;

    /// Two positions a period, δ = F/k with k = 1e8 and 2e8 N/m, 100 um of backlash.
    pub(crate) fn forces() -> MeshForces {
        let ladder = LoadSteps {
            count: 4,
            largest: 1000.0,
        };
        let rows = |sign: f64, from: f64| -> Vec<Vec<f64>> {
            let loads = ladder.loads().into_iter();
            loads
                .map(|load| vec![from + sign * load * 1e-8, from + sign * load * 0.5e-8])
                .collect()
        };
        let mut compliance = vec![vec![1e-8, 0.5e-8]; 4];
        compliance[0].fill(0.0);
        let flank = |delta| FlankRows {
            delta,
            compliance: Some(compliance.clone()),
        };
        let flanks = [flank(rows(1.0, 0.0)), flank(rows(-1.0, -100e-6))];
        MeshForces {
            table: ForceTable::new(1, ladder.loads(), flanks).expect("rows that rise"),
            base_radii: [40e-3, 50e-3],
            tooth_count: 20.0,
            method: "flexible".to_owned(),
        }
    }

    #[test]
    fn the_rows_of_an_fmu_are_close_where_loads_are_light() {
        let forces = forces();
        let loads = forces.dense_loads();
        assert!(loads.is_sorted_by(|a, b| a < b) && loads.len() < 100);
        assert_eq!((loads[0], loads[loads.len() - 1]), (0.0, 1000.0));
        for own in forces.table.loads() {
            assert!(loads.contains(own), "{own}");
        }
        for pair in loads.windows(2).skip(1) {
            let [low, high] = [pair[0], pair[1]];
            if (2.0..100.0).contains(&low) {
                assert!(high / low < 1.14, "{low} {high}");
            }
            assert!(high - low < 45.0, "{low} {high}");
        }
        assert!(loads[1] <= 0.1);
    }

    #[test]
    fn a_line_of_the_csv_is_a_load_at_a_position() {
        let forces = forces();
        let text = forces.write(Form::Csv);
        let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!(lines.len(), 1 + 2 * 4 * 2);
        let last: Vec<&str> = lines[16].split(',').collect();
        assert_eq!(last[0], "other");
        let numbers: Vec<f64> = last[1..]
            .iter()
            .map(|cell| cell.parse().expect("a number"))
            .collect();
        assert_eq!(numbers[..2], [-1000.0, 0.5]);
        assert!((numbers[2] - TAU / 40.0).abs() < 1e-9 && (numbers[3] + 105e-6).abs() < 1e-14);
        assert!(text.contains("# driven_base_radius_m: 0.05"));
    }

    #[test]
    fn the_tables_over_angle_and_approach_are_whole_and_their_last_row_is_the_first() {
        let forces = forces();
        let text = forces.write(Form::Text);
        assert!(text.starts_with("#1\n"));
        for name in ["force", "torque"] {
            let from = text.find(&format!("double {name}(")).expect("the table");
            let mut lines = text[from..].lines();
            let size = lines.next().expect("its size");
            let inner = size.split(['(', ')', ',']).skip(1);
            let size: Vec<usize> = inner.filter_map(|word| word.parse().ok()).collect();
            let rows: Vec<Vec<f64>> = lines
                .take(size[0])
                .map(|line| {
                    line.split(' ')
                        .map(|cell| cell.parse().expect("a number"))
                        .collect()
                })
                .collect();
            assert!(rows.len() == size[0] && rows.iter().all(|row| row.len() == size[1]));
            assert!(
                rows[0].is_sorted_by(|a, b| a < b || *a == 0.0),
                "approaches rise"
            );
            assert_eq!(rows[1][1..], rows[size[0] - 1][1..]);
            assert!((rows[size[0] - 1][0] - TAU / 20.0).abs() < 1e-12);
            if name == "force" {
                for (approach, force) in rows[0].iter().zip(&rows[1]).skip(1) {
                    let expected = if *approach >= 0.0 {
                        1e8 * approach
                    } else if *approach <= -100e-6 {
                        1e8 * (approach + 100e-6)
                    } else {
                        0.0
                    };
                    assert!(
                        (force - expected).abs() < 1e-3,
                        "{approach}: {force} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_package_has_both_tables_and_torques_of_both_gears() {
        let forces = forces();
        let text = forces.write(Form::Modelica);
        for said in [
            "package MeshwrightMesh",
            "driven.tau = -r_2*load;",
            "constant Real r_2(unit=\"m\") = 5e-2",
            "end MeshwrightMesh;",
        ] {
            assert!(text.contains(said), "{said}");
        }
        assert_eq!(text.matches('[').count(), text.matches(']').count());
    }
}
