//! The torques and the speed of a stage.

use std::cell::LazyCell;

use super::content::{Component, LoadCase};
use super::gear::DIGITS;
use super::import::Stage;
use super::reading::Reading;
use super::shaft::{Train, Turning, torque_of};
use super::unit::{N_M, NONE, PER_MINUTE, Unit};
use crate::significant;

impl<'a> Reading<'a> {
    /// The output torques: those that the caller says, else one for each load case, else that of the model itself.
    pub(super) fn torques(&self, stage: &Stage<'a>) -> Option<Vec<f64>> {
        if !self.choices.torques.is_empty() {
            return Some(self.choices.torques.clone());
        }
        let train = &LazyCell::new(|| Train::of(self.model));
        let behind =
            [0, 1].map(|from| LazyCell::new(move || train.loads_behind(self, stage, from)));
        let behind = |from: usize| behind[from].as_deref();
        let mut torques: Vec<f64> = Vec::new();
        for (id, case) in &self.model.load_cases {
            match self.output_torque(stage, &behind, Some(case)) {
                Some(torque) if !torques.contains(&torque) => torques.push(torque),
                Some(_) => {}
                None => self.remark(format!(
                    "Not read: load case {id} has no torque of the stage."
                )),
            }
        }
        if torques.is_empty() {
            torques.extend(self.output_torque(stage, &behind, None));
        }
        if torques.is_empty() {
            let detail = "No torque is said: neither by the torque of a cylindrical_stage_gear_data, nor by every external_load on the shafts on one side of it. Say it by --torque N_M, on the driven gear.";
            self.wrong(stage.component.place(), detail);
            return None;
        }
        Some(torques)
    }

    /// The torque on the driven gear, without its sign. Without friction that on the driving gear says it as well.
    fn output_torque<'b>(
        &self,
        stage: &Stage<'a>,
        behind: &impl Fn(usize) -> Option<&'b [Turning<'a>]>,
        case: Option<&'a LoadCase>,
    ) -> Option<f64>
    where
        'a: 'b,
    {
        let on = |i: usize| {
            let data = stage.gear_data[i];
            let of_data = data.and_then(|data| self.number_in(case, data, "torque", N_M));
            of_data.map(f64::abs).or_else(|| {
                let loads = behind(i)?;
                let torque = torque_of(self, loads, case)?;
                // A load on its own shaft turns as fast as the gear.
                if loads.iter().any(|(_, speed)| *speed != 1.0) {
                    self.remark(format!(
                        "Assumed: the torque of {} is carried over the shafts from {} without losses.",
                        stage.component.place(),
                        names(loads)
                    ));
                }
                Some(significant(torque, DIGITS))
            })
        };
        on(1).or_else(|| {
            let teeth = |i: usize| self.number(stage.gears[i], "number_of_teeth", NONE);
            Some(significant(on(0)? * teeth(1)? / teeth(0)?, DIGITS))
        })
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
    pub(super) fn number_in(
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

/// The loads in one sentence, the first of them if there are many.
fn names(loads: &[Turning<'_>]) -> String {
    let places = loads.iter().take(3).map(|(load, _)| load.place());
    places.collect::<Vec<_>>().join(" and ")
}
