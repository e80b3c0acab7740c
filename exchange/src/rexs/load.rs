//! The torques and the speed of a stage.

use super::file::{Component, LoadCase};
use super::import::Stage;
use super::reading::Reading;
use super::unit::{N_M, NONE, PER_MINUTE, Unit};

impl<'a> Reading<'a> {
    /// The output torques: those that the caller says, else one for each load case, else that of the model itself.
    pub(super) fn torques(&self, stage: &Stage<'a>) -> Option<Vec<f64>> {
        if !self.choices.torques.is_empty() {
            return Some(self.choices.torques.clone());
        }
        let mut torques: Vec<f64> = Vec::new();
        for (id, case) in &self.model.load_cases {
            match self.output_torque(stage, Some(case)) {
                Some(torque) if !torques.contains(&torque) => torques.push(torque),
                Some(_) => {}
                None => self.remark(format!(
                    "Not read: load case {id} has no torque of the stage."
                )),
            }
        }
        if torques.is_empty() {
            torques.extend(self.output_torque(stage, None));
        }
        if torques.is_empty() {
            let detail = "No torque is said: neither by the torque of a cylindrical_stage_gear_data, nor by a single external_load on a shaft that carries one gear of this stage alone. Say it by --torque N_M, on the driven gear.";
            self.wrong(stage.component.place(), detail);
            return None;
        }
        Some(torques)
    }

    /// The torque on the driven gear, without its sign. Without friction that on the driving gear says it as well.
    fn output_torque(&self, stage: &Stage<'a>, case: Option<&'a LoadCase>) -> Option<f64> {
        let on = |i: usize| {
            let data = stage.gear_data[i];
            let of_data = data.and_then(|data| self.number_in(case, data, "torque", N_M));
            of_data
                .or_else(|| self.torque_of_shaft(stage.gears[i], case))
                .map(f64::abs)
        };
        on(1).or_else(|| {
            let teeth = |i: usize| self.number(stage.gears[i], "number_of_teeth", NONE);
            Some(on(0)? * teeth(1)? / teeth(0)?)
        })
    }

    /// The external torque on the shaft of `gear`, where it can only act on this gear.
    fn torque_of_shaft(&self, gear: &'a Component, case: Option<&'a LoadCase>) -> Option<f64> {
        let shafts = self.model.related("assembly", ("part", gear), "assembly");
        let shaft = shafts.into_iter().find(|shaft| shaft.kind == "shaft")?;
        let parts = self.model.related("assembly", ("assembly", shaft), "part");
        if parts.iter().filter(|part| is_gear(part)).count() != 1 {
            return None;
        }
        let loads = parts.iter().filter(|part| part.kind == "external_load");
        let torques: Vec<f64> = loads
            .filter_map(|load| self.number_in(case, load, "torque_around_u_axis", N_M))
            .filter(|torque| *torque != 0.0)
            .collect();
        match torques.as_slice() {
            [one] => Some(*one),
            _ => None,
        }
    }

    /// The speed of the driving gear without its sign, if the model knows exactly one.
    pub(super) fn driving_speed(&self, stage: &Stage<'a>) -> Option<f64> {
        let gear = stage.gears[0];
        let shafts = self.model.related("assembly", ("part", gear), "assembly");
        let speed = |case: Option<&'a LoadCase>| {
            let turning = std::iter::once(gear).chain(shafts.iter().copied());
            let speeds = turning
                .filter_map(|part| self.number_in(case, part, "rotational_speed", PER_MINUTE));
            speeds.map(f64::abs).find(|speed| *speed > 0.0)
        };
        let cases = self.model.load_cases.iter();
        let mut speeds: Vec<f64> = cases.filter_map(|(_, case)| speed(Some(case))).collect();
        if speeds.is_empty() {
            speeds.extend(speed(None));
        }
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        match speeds.as_slice() {
            [] => None,
            [one] => Some(*one),
            several => {
                self.remark(format!(
                    "Not read: the speeds of the load cases ({} different ones): a submission has one, which only turns orders into frequencies.",
                    several.len()
                ));
                None
            }
        }
    }

    /// A number as the case has it, else as the component itself has it.
    fn number_in(
        &self,
        case: Option<&'a LoadCase>,
        of: &Component,
        attribute: &str,
        unit: Unit,
    ) -> Option<f64> {
        let there = case.and_then(|case| case.get(&of.id));
        let of_case = there.and_then(|component| self.number(component, attribute, unit));
        if of_case.is_some() {
            of.met.set(true);
        }
        of_case.or_else(|| self.number(of, attribute, unit))
    }
}

fn is_gear(component: &Component) -> bool {
    matches!(
        component.kind.as_str(),
        "cylindrical_gear" | "ring_gear" | "bevel_gear" | "worm_gear" | "worm_wheel"
    )
}
