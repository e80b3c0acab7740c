//! From a model to a submission: which stage, which gear drives, and what was not read.

use std::cell::RefCell;
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::fault::{Fault, Refused};
use super::file::{Component, Model};
use super::gear::Gear;
use super::own;
use super::reading::{Choices, Reading};
use super::unit::{DEG, MM};

/// A submission out of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The document, which is still to be checked as every submission is.
    pub submission: Value,
    /// What the model does not say and was assumed, and what it says and was not read: one sentence each.
    pub remarks: Vec<String>,
    /// What the model says and was not read.
    pub not_read: Vec<NotRead>,
    origins: Vec<(String, String)>,
}

/// What a model says and was not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotRead {
    /// The component.
    pub component: String,
    /// Its attribute; none where nothing of the component was read.
    pub attribute: Option<String>,
}

impl Import {
    /// Where in the model the field at `pointer` of the submission is from, or what that field is a part of.
    pub fn origin(&self, pointer: &str) -> Option<&str> {
        let found = self.origins.iter().find(|(field, _)| field == pointer);
        match found {
            Some((_, place)) => Some(place),
            None => self.origin(pointer.rsplit_once('/')?.0),
        }
    }
}

/// Reads a model and takes one pair out of it.
///
/// # Errors
///
/// Everything that is wrong, with its place: what is no model, several stages, and what the mechanics cannot compute.
pub fn import(bytes: &[u8], choices: &Choices) -> Result<Import, Refused> {
    let model = Model::read(bytes)?;
    let reading = Reading {
        model: &model,
        choices,
        faults: RefCell::default(),
        remarks: RefCell::default(),
        origins: RefCell::default(),
    };
    let submission = reading.submission();
    let faults = with_other_files(&model, reading.faults.take());
    match submission {
        Some(submission) if faults.is_empty() => {
            let mut remarks = reading.remarks.take();
            remarks.extend(left_out(&model));
            Ok(Import {
                submission,
                remarks,
                not_read: not_read(&model),
                origins: reading.origins.take(),
            })
        }
        _ => Err(Refused(faults)),
    }
}

/// The faults, with one for each component that was asked for what stands in another file instead of those that follow from that.
fn with_other_files(model: &Model, mut faults: Vec<Fault>) -> Vec<Fault> {
    let elsewhere = model.components.iter().filter_map(Component::elsewhere);
    let elsewhere: Vec<Fault> = elsewhere.collect();
    faults.retain(|fault| !elsewhere.iter().any(|other| fault.is_of(&other.place)));
    elsewhere.into_iter().chain(faults).collect()
}

/// The stage with its gears.
pub(super) struct Stage<'a> {
    pub(super) component: &'a Component,
    /// The driving gear, then the driven one.
    pub(super) gears: [&'a Component; 2],
    /// What is said of each gear in this stage.
    pub(super) gear_data: [Option<&'a Component>; 2],
}

impl<'a> Reading<'a> {
    fn submission(&self) -> Option<Value> {
        let stage = self.stage()?;
        if self.choices.bore_radii.len() > 2 {
            let detail = "There are at most two: of the driving and of the driven gear.";
            self.wrong("the bore radii".to_owned(), detail);
        }
        let distance = self.number(stage.component, "center_distance", MM);
        match distance {
            Some(_) => self.from(
                "/pair/center_distance_mm".to_owned(),
                stage.component,
                "center_distance",
            ),
            None if stage.component.attribute("center_distance").is_none() => self.wrong(
                stage.component.place(),
                "It has no center_distance, which has no default.",
            ),
            None => {}
        }
        let helix = self.helix(&stage)?;
        let gear = |i: usize| {
            let pointer = ["/pair/driving", "/pair/driven"][i];
            let bores = &self.choices.bore_radii;
            let bore = bores.get(i).or(bores.first()).copied();
            Gear::of(self, stage.gears[i], stage.gear_data[i], helix)
                .and_then(|gear| gear.document(pointer, bore))
        };
        let (driving, driven) = (gear(0), gear(1));
        let torques = self.torques(&stage);
        let mut pair =
            json!({ "center_distance_mm": distance?, "driving": driving?, "driven": driven? });
        if helix != 0.0 {
            pair["helix_angle_deg"] = json!(helix);
            self.from(
                "/pair/helix_angle_deg".to_owned(),
                stage.gears[0],
                HELIX_ANGLE,
            );
        }
        if let Some(offset) = self.number(stage.component, own::AXIAL_OFFSET, MM) {
            pair["axial_offset_mm"] = json!(offset);
        }
        if let Some(askew) = self.json(stage.component, own::MISALIGNMENT) {
            pair["misalignment_um"] = askew;
        }
        let own_method = self.word(stage.component, own::METHOD);
        let method = match (&self.choices.method, own_method) {
            (Some(method), _) => method.clone(),
            (None, Some(method)) => method.to_owned(),
            (None, None) if needs_faces(&pair) => {
                let place = stage.component.place();
                self.remark(format!(
                    "Assumed: {place} is computed by three_dimensional, which sees its helix and its leads."
                ));
                "three_dimensional".to_owned()
            }
            (None, None) => "flexible".to_owned(),
        };
        let mut submission = json!({
            "method": method,
            "pair": pair,
            "output_torques_n_m": torques?,
        });
        if let Some(speed) = self.driving_speed(&stage) {
            submission["driving_speed_rpm"] = json!(speed);
        }
        Some(submission)
    }

    /// The helix angle of the driving gear in degrees, positive if it is right-handed; the driven one has the other hand.
    fn helix(&self, stage: &Stage<'a>) -> Option<f64> {
        let [driving, driven] = stage.gears;
        let said = stage.gears.map(|gear| self.number(gear, HELIX_ANGLE, DEG));
        let angle = match said {
            [None, None] => {
                for gear in stage.gears {
                    self.assumed(gear, HELIX_ANGLE, "0, spur teeth");
                }
                0.0
            }
            [Some(angle), None] => {
                self.assumed(driven, HELIX_ANGLE, "that of its mate with the other hand");
                angle
            }
            [None, Some(angle)] => {
                self.assumed(driving, HELIX_ANGLE, "that of its mate with the other hand");
                -angle
            }
            [Some(angle), Some(other)] if (angle + other).abs() <= 1e-9 => angle,
            [Some(angle), Some(other)] => {
                let detail = format!(
                    "It is {angle} deg, that of its mate {other} deg; on parallel axes they are as large as each other and of opposite sign, the right hand positive."
                );
                self.wrong(driving.place_of(HELIX_ANGLE), detail);
                return None;
            }
        };
        if angle != 0.0 {
            self.remark(format!(
                "Assumed: a positive {HELIX_ANGLE} is a right hand: {} is {}-handed.",
                driving.place(),
                if angle > 0.0 { "right" } else { "left" }
            ));
        }
        Some(angle)
    }

    /// The one stage that is meant, and its gears in the order of the power.
    fn stage(&self) -> Option<Stage<'a>> {
        let component = self.chosen_stage()?;
        let relation = self
            .model
            .relations
            .iter()
            .find(|relation| relation.kind == "stage" && relation.has("stage", component.id));
        let gear = |role: &str| relation.and_then(|relation| self.model.in_role(relation, role));
        let (Some(first), Some(second)) = (gear("gear_1"), gear("gear_2")) else {
            let detail = "It needs a relation of type stage with a gear_1 and a gear_2.";
            self.wrong(component.place(), detail);
            return None;
        };
        let mut external = true;
        for gear in [first, second] {
            if gear.kind != "cylindrical_gear" {
                let detail = format!(
                    "A gear of type {} cannot be computed; the mechanics know external spur and helical gears, type cylindrical_gear.",
                    gear.kind
                );
                self.wrong(gear.place(), detail);
                external = false;
            }
        }
        if !external {
            return None;
        }
        let data = [first, second].map(|gear| {
            let relations = self.model.relations.iter();
            relations
                .filter(|relation| {
                    relation.kind == "stage_gear_data"
                        && relation.has("stage", component.id)
                        && relation.has("gear", gear.id)
                })
                .find_map(|relation| self.model.in_role(relation, "stage_gear_data"))
        });
        let drives = data.map(|data| self.choice(data?, "is_driving_gear", &["true", "false"]));
        let swapped = match drives {
            [Some("true"), Some("true")] => {
                let detail = "Both of its gears say is_driving_gear; exactly one drives.";
                self.wrong(component.place(), detail);
                return None;
            }
            [Some("false"), Some("false")] | [None, None] => {
                self.remark(format!(
                    "Assumed: gear_1 drives, {}; no is_driving_gear says which gear does.",
                    first.place()
                ));
                false
            }
            [Some("true"), _] | [_, Some("false")] => false,
            [Some("false"), _] | [_, Some("true")] => true,
            _ => false,
        };
        let order = if swapped { [1, 0] } else { [0, 1] };
        component.met.set(true);
        Some(Stage {
            component,
            gears: order.map(|i| [first, second][i]),
            gear_data: order.map(|i| data[i]),
        })
    }

    fn chosen_stage(&self) -> Option<&'a Component> {
        let stages: Vec<&Component> = self.model.of_kind("cylindrical_stage").collect();
        let names = || {
            let names: Vec<String> = stages.iter().map(|stage| stage.place()).collect();
            names.join(", ")
        };
        let file = "the file".to_owned();
        match (stages.as_slice(), self.choices.stage) {
            ([], _) => {
                let kinds = ["planetary_stage", "bevel_stage", "worm_stage"];
                let there = kinds
                    .iter()
                    .filter(|kind| self.model.of_kind(kind).count() > 0);
                let there: Vec<&str> = there.copied().collect();
                let has = if there.is_empty() {
                    "no stage at all".to_owned()
                } else {
                    format!("{} only", there.join(" and "))
                };
                self.wrong(
                    file,
                    format!("It has {has}; a cylindrical_stage is needed."),
                );
                None
            }
            (_, Some(id)) => {
                let found = stages.iter().find(|stage| stage.id == id).copied();
                if found.is_none() {
                    let detail = format!("No stage has the id {id}; it has {}.", names());
                    self.wrong(file, detail);
                }
                found
            }
            ([one], None) => Some(one),
            (several, None) => {
                let detail = format!(
                    "It has {} cylindrical stages, and one pair is computed at a time. Choose by --stage ID: {}.",
                    several.len(),
                    names()
                );
                self.wrong(file, detail);
                None
            }
        }
    }
}

/// The helix angle of a gear.
pub(super) const HELIX_ANGLE: &str = "helix_angle_reference_diameter";

/// Whether a plane method would refuse `pair`.
fn needs_faces(pair: &Value) -> bool {
    let said = |value: &Value| match value {
        Value::Null => false,
        Value::Array(list) => !list.is_empty(),
        Value::Number(number) => number.as_f64() != Some(0.0),
        // A torque that enters at both ends of a shaft is what a plane has.
        Value::String(word) => word != "both",
        _ => true,
    };
    let of_pair = ["helix_angle_deg", "axial_offset_mm", "misalignment_um"];
    let of_gear = [
        "/lead_modifications",
        "/tooth_deviations/lead_slope_um",
        "/blank/hub",
        "/blank/web/offset_mm",
        "/blank/shaft/torque_at",
    ];
    of_pair.iter().any(|name| said(&pair[*name]))
        || ["driving", "driven"].iter().any(|gear| {
            let mut of_gear = of_gear
                .iter()
                .filter_map(|place| pair[*gear].pointer(place));
            of_gear.any(said)
        })
}

/// The ids of the cylindrical stages of a model, each of which may have a pair.
///
/// # Errors
///
/// If the bytes are no model.
pub fn stages(bytes: &[u8]) -> Result<Vec<i64>, Refused> {
    let model = Model::read(bytes)?;
    let stages = model.components.iter();
    let stages = stages.filter(|component| component.kind == "cylindrical_stage");
    Ok(stages.map(|stage| stage.id).collect())
}

/// What was not read: attributes of what was met, and what was not met.
fn not_read(model: &Model) -> Vec<NotRead> {
    let of = |component: &Component| {
        let place = component.place();
        let named = |attribute: Option<String>| NotRead {
            component: place.clone(),
            attribute,
        };
        if component.met.get() {
            let unread = component.attributes.iter().filter(|a| !a.read.get());
            unread
                .map(|attribute| named(Some(attribute.id.clone())))
                .collect()
        } else {
            vec![named(None)]
        }
    };
    model.components.iter().flat_map(of).collect()
}

/// The same in sentences, those that go together in one.
fn left_out(model: &Model) -> Vec<String> {
    let unread = |component: &Component| -> Vec<String> {
        let unread = component.attributes.iter().filter(|a| !a.read.get());
        unread.map(|attribute| attribute.id.clone()).collect()
    };
    let mut sentences: Vec<String> = model
        .components
        .iter()
        .filter(|component| component.met.get())
        .map(|component| (component.place(), unread(component)))
        .filter(|(_, ids)| !ids.is_empty())
        .map(|(place, ids)| format!("Not read: of {place}: {}.", ids.join(", ")))
        .collect();
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    for component in model.components.iter().filter(|other| !other.met.get()) {
        *kinds.entry(&component.kind).or_default() += 1;
    }
    if !kinds.is_empty() {
        let kinds: Vec<String> = kinds
            .iter()
            .map(|(kind, n)| format!("{n} {kind}"))
            .collect();
        sentences.push(format!("Not read: {}.", kinds.join(", ")));
    }
    let mut in_cases: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let cases = model.load_cases.iter();
    for component in cases.flat_map(|(_, case)| case.values()) {
        let ids = in_cases.entry(&component.kind).or_default();
        ids.extend(unread(component));
    }
    for (kind, mut ids) in in_cases.into_iter().filter(|(_, ids)| !ids.is_empty()) {
        ids.sort();
        ids.dedup();
        sentences.push(format!(
            "Not read: in load cases, of {kind}: {}.",
            ids.join(", ")
        ));
    }
    sentences
}
