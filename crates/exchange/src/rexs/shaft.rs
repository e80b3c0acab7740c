//! The shafts of a gearbox: how thick one is under its gear, and how torques go on over them.

use std::collections::{HashMap, HashSet};

use super::content::{Component, LoadCase};
use super::file::Model;
use super::import::Stage;
use super::reading::Reading;
use super::unit::{MM, N_M, NONE};

/// Places along a shaft nearer than this are the same, in mm.
const SAME_PLACE: f64 = 1e-6;

/// Components that hold a gear or a shaft on a shaft so that they turn together. A switchable coupling may be open.
const HOLDING: [&str; 5] = [
    "coupling",
    "feather_key_connection",
    "cylindrical_interference_fit",
    "tapered_interference_fit",
    "involute_spline_connection",
];

/// Loads beyond this number are not added up.
const MOST_LOADS: usize = 100;

impl<'a> Reading<'a> {
    /// The shaft of which `part` is a part, or on which it is held.
    pub(super) fn shaft_of(&self, part: &Component) -> Option<&'a Component> {
        let carries = self.model.related("assembly", ("part", part), "assembly");
        let holds = || {
            self.model
                .related("side", ("outer_part", part), "inner_part")
        };
        let is_shaft = |other: &&Component| other.kind == "shaft";
        let found = carries.into_iter().find(is_shaft);
        found.or_else(|| holds().into_iter().find(is_shaft))
    }

    /// The outer diameter, in mm, of the shaft under the middle of the face of `gear`, and the section that says it.
    pub(super) fn seat(&self, gear: &Component) -> Option<(f64, &'a Component)> {
        let shaft = self.shaft_of(gear)?;
        let parts = self.model.related("assembly", ("assembly", shaft), "part");
        let middle = self.place_on(shaft, gear);
        let mut seats: Vec<(f64, &Component)> = parts
            .into_iter()
            .filter(|part| part.kind == "shaft_section")
            .filter_map(|section| {
                let number = |name| section.glance(name, MM);
                let begin = number("outer_diameter_begin")?;
                let end = number("outer_diameter_end").unwrap_or(begin);
                let Some(middle) = middle else {
                    return Some((if begin == end { begin } else { f64::NAN }, section));
                };
                let from = number("u_coordinate_on_shaft")?;
                let length = number("length").filter(|length| *length > 0.0)?;
                let part = (middle - from) / length;
                let inside = (-SAME_PLACE..=length + SAME_PLACE).contains(&(middle - from));
                inside.then_some((begin + (end - begin) * part.clamp(0.0, 1.0), section))
            })
            .filter(|(diameter, _)| diameter.is_nan() || *diameter > 0.0)
            .collect();
        if middle.is_none() && seats.iter().any(|(diameter, _)| *diameter != seats[0].0) {
            return None;
        }
        // Where two meet, the thicker one.
        seats.sort_by(|one, other| other.0.total_cmp(&one.0));
        let (diameter, section) = *seats.first()?;
        for name in [
            "u_coordinate_on_shaft",
            "length",
            "outer_diameter_begin",
            "outer_diameter_end",
        ] {
            section.attribute(name);
        }
        Some((diameter, section))
    }

    /// Where the middle of the face of `gear` stands on its shaft, in mm: by both places in space, or by that on the shaft.
    fn place_on(&self, shaft: &Component, gear: &Component) -> Option<f64> {
        let vector = |of: &Component, name: &str| of.attribute(name)?.vector(MM);
        let in_space = || {
            let axis = vector(shaft, "u_axis_vector")?;
            let from = vector(shaft, "support_vector")?;
            let to = vector(gear, "support_vector")?;
            Some((0..3).map(|i| (to[i] - from[i]) * axis[i]).sum())
        };
        let on_shaft = || {
            let place = self.number(gear, "u_coordinate_on_shaft", MM)?;
            // In version 1.0 it is where the face begins.
            let begins = self.model.version < (1, 1);
            let width = begins.then(|| self.number(gear, "face_width", MM));
            Some(place + 0.5 * width.flatten().unwrap_or(0.0))
        };
        in_space().or_else(on_shaft)
    }
}

/// Units of components that turn together, and meshes between them. Components are known by their ids.
pub(super) struct Train<'a> {
    /// The shaft of each gear.
    shafts: HashMap<i64, &'a Component>,
    /// The unit of each component.
    units: HashMap<i64, i64>,
    /// The loads on each unit.
    loads: HashMap<i64, Vec<&'a Component>>,
    /// The gears that mesh with those of each unit: the stage, the own one and the other.
    meshes: HashMap<i64, Vec<(i64, &'a Component, &'a Component)>>,
    /// Units of which power goes on in ways that are not followed.
    open: HashSet<i64>,
}

/// A load on one side of a mesh, and how fast it turns there against the gear.
pub(super) type Turning<'a> = (&'a Component, f64);

impl<'a> Train<'a> {
    /// The shafts of a whole model.
    pub(super) fn of(model: &'a Model) -> Self {
        let mut united = Units::default();
        let mut shafts = HashMap::new();
        for relation in &model.relations {
            let role = |name| model.in_role(relation, name);
            match relation.kind.as_str() {
                "assembly" => {
                    let shaft = role("assembly").filter(|shaft| shaft.kind == "shaft");
                    let part = role("part").filter(|part| is_gear(part) || part.kind == LOAD);
                    if let Some((shaft, part)) = shaft.zip(part) {
                        united.join(shaft.id, part.id);
                        shafts.insert(part.id, shaft);
                    }
                }
                "side" => {
                    let holds = |by: &&Component| HOLDING.contains(&by.kind.as_str());
                    let turns = |part: &&Component| part.kind == "shaft" || is_gear(part);
                    let ends = ["inner_part", "outer_part"].map(|end| role(end).filter(turns));
                    if let (Some(_), [Some(inner), Some(outer)]) =
                        (role("assembly").filter(holds), ends)
                    {
                        united.join(inner.id, outer.id);
                        if inner.kind == "shaft" {
                            shafts.entry(outer.id).or_insert(inner);
                        }
                    }
                }
                _ => {}
            }
        }
        let mut unit = |id: i64| united.of(id);
        let mut train = Self {
            shafts,
            units: HashMap::new(),
            loads: HashMap::new(),
            meshes: HashMap::new(),
            open: HashSet::new(),
        };
        for component in &model.components {
            let turns_with = unit(component.id);
            train.units.insert(component.id, turns_with);
            if component.kind == LOAD {
                let loads = train.loads.entry(turns_with).or_default();
                loads.push(component);
            }
        }
        for relation in &model.relations {
            let role = |name| model.in_role(relation, name);
            if let (Some(stage), Some(one), Some(other)) =
                (role("stage"), role("gear_1"), role("gear_2"))
            {
                if ["cylindrical_stage", "bevel_stage"].contains(&stage.kind.as_str()) {
                    for (own, mate) in [(one, other), (other, one)] {
                        let meshes = train.meshes.entry(unit(own.id)).or_default();
                        meshes.push((stage.id, own, mate));
                    }
                } else {
                    train.open.extend([unit(one.id), unit(other.id)]);
                }
            } else if let (Some(_), Some(shaft)) = (role("planetary_stage"), role("shaft")) {
                train.open.insert(unit(shaft.id));
            }
        }
        train
    }

    /// The loads whose power comes to the mesh of `stage` through its gear `from`; none if it is not said how much of it does: power
    /// that comes there on two ways, or over a stage of another kind.
    pub(super) fn loads_behind(
        &self,
        reading: &Reading<'a>,
        stage: &Stage<'a>,
        from: usize,
    ) -> Option<Vec<Turning<'a>>> {
        let (own, mate) = (stage.gears[from], stage.gears[1 - from]);
        let beyond = self.units.get(&mate.id)?;
        let mut seen = HashSet::from([*self.units.get(&own.id)?]);
        let mut open: Vec<(i64, f64, i64)> = seen
            .iter()
            .map(|unit| (*unit, 1.0, stage.component.id))
            .collect();
        let mut found = Vec::new();
        while let Some((unit, speed, through)) = open.pop() {
            if unit == *beyond || self.open.contains(&unit) {
                return None;
            }
            for load in self.loads.get(&unit).into_iter().flatten() {
                found.push((*load, speed));
            }
            for (stage, gear, other) in self.meshes.get(&unit).into_iter().flatten() {
                if *stage == through {
                    continue;
                }
                let next = *self.units.get(&other.id)?;
                let teeth = |gear| reading.number(gear, "number_of_teeth", NONE);
                let ratio = teeth(gear)? / teeth(other)?;
                if !seen.insert(next) || !ratio.is_finite() || found.len() > MOST_LOADS {
                    return None;
                }
                open.push((next, -speed * ratio * self.along(gear, other), *stage));
            }
        }
        Some(found)
    }

    /// Sign of the directions of two gears' axes: 1 where they point the same way, also where the model is silent.
    fn along(&self, one: &Component, other: &Component) -> f64 {
        let axis = |gear: &Component| {
            let shaft = self.shafts.get(&gear.id)?;
            shaft.attribute("u_axis_vector")?.vector(MM)
        };
        let product = axis(one)
            .zip(axis(other))
            .map_or(1.0, |(one, other)| (0..3).map(|i| one[i] * other[i]).sum());
        if product < 0.0 { -1.0 } else { 1.0 }
    }
}

/// The torque on a gear, in N m, by the loads whose power comes through it: none if one of them is not said, or if they come to nothing.
pub(super) fn torque_of(
    reading: &Reading<'_>,
    loads: &[Turning<'_>],
    case: Option<&LoadCase>,
) -> Option<f64> {
    let (mut power, mut largest) = (0.0, 0.0_f64);
    for (load, speed) in loads {
        match reading.number_in(case, load, "torque_around_u_axis", N_M) {
            Some(torque) => {
                power += torque * speed;
                largest = largest.max((torque * speed).abs());
            }
            None if reading.word(load, "transmits_torque") == Some("true") => return None,
            None => {}
        }
    }
    (power.abs() > 1e-9 * largest).then_some(power.abs())
}

/// A torque from outside.
const LOAD: &str = "external_load";

pub(super) fn is_gear(component: &Component) -> bool {
    matches!(
        component.kind.as_str(),
        "cylindrical_gear" | "ring_gear" | "bevel_gear" | "worm_gear" | "worm_wheel"
    )
}

/// Units of components that turn together, by one of each.
#[derive(Default)]
struct Units(HashMap<i64, i64>);

impl Units {
    /// The one by which those are known that `id` turns with.
    fn of(&mut self, mut id: i64) -> i64 {
        while let Some(&next) = self.0.get(&id) {
            // The way gets shorter each time that it is gone.
            if let Some(&after) = self.0.get(&next) {
                self.0.insert(id, after);
            }
            id = next;
        }
        id
    }

    fn join(&mut self, one: i64, other: i64) {
        let (one, other) = (self.of(one), self.of(other));
        if one != other {
            self.0.insert(one, other);
        }
    }
}
