//! From a model to a submission: the stage, the driving gear, and the parts that were not read.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

use serde_json::{Value, json};

use super::content::Component;
use super::fault::{Faults, Refused};
use super::file::Model;
use super::gear::Gear;
use super::own;
use super::reading::{Choices, MOST_REMARKS, Reading};
use super::unit::{DEG, MM};

/// A pair of gears on parallel axes.
const STAGE: &str = "cylindrical_stage";

/// Maximum number of names in a list.
const MOST_LISTED: usize = 20;

/// Maximum number of unread parts that are listed one by one.
const MOST_NOT_READ: usize = 1000;

/// A submission out of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Import {
    /// The document, which is still to be checked as every submission is.
    pub submission: Value,
    /// Assumptions where the model is silent, and parts that were not read: one sentence each.
    pub remarks: Vec<String>,
    origins: Vec<(String, String)>,
}

/// A part of a model that was not read.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct NotRead {
    /// The component.
    pub component: String,
    /// Its attribute; none where nothing of the component was read.
    pub attribute: Option<String>,
}

impl Import {
    /// The place in the model from which the field at `pointer` of the submission, or its object, comes.
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
/// All faults, with their places: a file that is no model, several stages, and pairs that the mechanics cannot compute.
pub fn import(bytes: &[u8], choices: &Choices) -> Result<Import, Refused> {
    import_of(&Model::read(bytes)?, choices)
}

/// Calls `take` with each of the first `most` cylindrical stages of a model, or with the chosen one: its id, where there are several, and the pair or its
/// faults. Returns the parts that were read for none of the stages that `take` accepted; `take` may end it.
///
/// # Errors
///
/// If the bytes are no model.
pub fn each_stage(
    bytes: &[u8],
    choices: &Choices,
    most: usize,
    mut take: impl FnMut(Option<i64>, Result<Import, Refused>) -> ControlFlow<(), bool>,
) -> Result<Vec<NotRead>, Refused> {
    let model = Model::read(bytes)?;
    let stages: Vec<i64> = model.of_kind(STAGE).map(|stage| stage.id).collect();
    let wanted: Vec<Option<i64>> = match choices.stage {
        None if stages.len() > 1 => stages.into_iter().take(most).map(Some).collect(),
        stage => vec![stage],
    };
    let mut read = model.read_marks();
    for stage in wanted {
        let choices = Choices {
            stage,
            ..choices.clone()
        };
        let import = import_of(&model, &choices);
        let marks = model.take_read_marks();
        match take(stage, import) {
            ControlFlow::Break(()) => break,
            ControlFlow::Continue(false) => {}
            ControlFlow::Continue(true) => {
                read.iter_mut()
                    .zip(marks)
                    .for_each(|(all, own)| *all |= own);
            }
        }
    }
    Ok(not_read(&model, &read))
}

fn import_of(model: &Model, choices: &Choices) -> Result<Import, Refused> {
    // Another stage may have asked for more.
    model.components.iter().for_each(Component::begin);
    let reading = Reading {
        model,
        choices,
        faults: RefCell::default(),
        remarks: RefCell::default(),
        origins: RefCell::default(),
    };
    let submission = reading.submission();
    let faults = with_other_files(model, reading.faults.take());
    match submission {
        Some(submission) if faults.is_empty() => {
            let mut remarks = reading.remarks.take();
            remarks.extend(left_out(model));
            Ok(Import {
                submission,
                remarks,
                origins: reading.origins.take(),
            })
        }
        _ => Err(faults.into()),
    }
}

/// The faults, with one for each component whose values stand in another file instead of the faults that follow from that.
fn with_other_files(model: &Model, faults: Faults) -> Faults {
    let elsewhere = model.components.iter().filter_map(Component::elsewhere);
    faults.after(elsewhere.collect())
}

/// The stage with its gears.
pub(super) struct Stage<'a> {
    pub(super) component: &'a Component,
    /// The driving gear, then the driven one.
    pub(super) gears: [&'a Component; 2],
    /// Attributes of each gear in this stage.
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
        let stages: Vec<&Component> = self.model.of_kind(STAGE).collect();
        let names = || {
            let names: Vec<String> = stages.iter().map(|stage| stage.place()).collect();
            listed(&names)
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

/// True if a plane method would refuse `pair`.
fn needs_faces(pair: &Value) -> bool {
    let said = |value: &Value| match value {
        Value::Null => false,
        Value::Array(list) => !list.is_empty(),
        Value::Number(number) => number.as_f64() != Some(0.0),
        // A plane has a torque that enters at both ends of a shaft.
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

/// The unread parts by the marks `read`: attributes of components that were met, and components that were not. The first are listed one by one, the others by
/// their number.
fn not_read(model: &Model, read: &[bool]) -> Vec<NotRead> {
    let mut marks = read.iter();
    let mut is_read = || marks.next().copied().unwrap_or_default();
    let (mut told, mut more) = (Vec::new(), 0_usize);
    let mut tell = |component: &Component, attribute: Option<&str>| {
        if told.len() < MOST_NOT_READ {
            told.push(NotRead {
                component: component.place(),
                attribute: attribute.map(str::to_owned),
            });
        } else {
            more += 1;
        }
    };
    for component in &model.components {
        let is_met = is_read();
        if !is_met {
            tell(component, None);
        }
        for attribute in &component.attributes {
            if !is_read() && is_met {
                tell(component, Some(&attribute.id));
            }
        }
    }
    if more > 0 {
        told.push(NotRead {
            component: format!("and {more} more"),
            attribute: None,
        });
    }
    told
}

/// The first of `names` in a list, and how many more there are.
fn listed(names: &[String]) -> String {
    let first = names.iter().take(MOST_LISTED).map(String::as_str);
    let first = first.collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOST_LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
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
        .take(MOST_REMARKS)
        .map(|(place, ids)| format!("Not read: of {place}: {}.", listed(&ids)))
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
        sentences.push(format!("Not read: {}.", listed(&kinds)));
    }
    let mut in_cases: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let cases = model.load_cases.iter();
    for component in cases.flat_map(|(_, case)| case.values()) {
        let ids = in_cases.entry(&component.kind).or_default();
        ids.extend(unread(component));
    }
    let in_cases = in_cases.into_iter().filter(|(_, ids)| !ids.is_empty());
    for (kind, mut ids) in in_cases.take(MOST_REMARKS) {
        ids.sort();
        ids.dedup();
        sentences.push(format!(
            "Not read: in load cases, of {kind}: {}.",
            listed(&ids)
        ));
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A model of `pairs` pairs, `beside` components of unknown kinds, and more text of the first stage.
    fn model(pairs: i64, beside: i64, more: &str) -> String {
        let mut components = String::new();
        let mut relations = String::new();
        let number = |id: &str, unit: &str, value: f64| {
            format!("<attribute id='{id}' unit='{unit}'>{value}</attribute>")
        };
        for pair in 0..pairs {
            let [stage, first, second] = [1, 2, 3].map(|i| 10 * pair + i);
            let distance = number("center_distance", "mm", 100.0);
            let more = if pair == 0 { more } else { "" };
            components += &format!(
                "<component id='{stage}' type='cylindrical_stage'>{distance}{more}</component>"
            );
            for gear in [first, second] {
                let said = number("number_of_teeth", "none", 50.0)
                    + &number("normal_module", "mm", 2.0)
                    + &number("face_width", "mm", 20.0);
                components +=
                    &format!("<component id='{gear}' type='cylindrical_gear'>{said}</component>");
            }
            relations += &format!(
                "<relation id='{pair}' type='stage'><ref id='{stage}' role='stage'/><ref id='{first}' role='gear_1'/><ref id='{second}' role='gear_2'/></relation>"
            );
        }
        for i in 0..beside {
            components += &format!("<component id='{}' type='bearing'/>", 1_000_000 + i);
        }
        format!(
            "<model version='1.4'><relations>{relations}</relations><components>{components}</components></model>"
        )
    }

    fn choices() -> Choices {
        Choices {
            torques: vec![10.0],
            bore_radii: vec![10.0],
            ..Choices::default()
        }
    }

    #[test]
    fn what_one_pair_reads_has_been_read_and_what_none_reads_is_told_once() {
        let said = "<attribute id='paint'>blue</attribute>";
        let text = model(3, 2, said);
        let mut taken = Vec::new();
        let not_read = each_stage(text.as_bytes(), &choices(), 2, |stage, import| {
            assert_eq!(import.map(|_| ()), Ok(()));
            taken.extend(stage);
            ControlFlow::Continue(true)
        });
        assert_eq!(taken, [1, 11]);
        let told = not_read.expect("a model");
        let told: Vec<String> = told
            .iter()
            .map(|it| {
                format!(
                    "{} {}",
                    it.component,
                    it.attribute.as_deref().unwrap_or("-")
                )
            })
            .collect();
        let expected = [
            "component 1 (cylindrical_stage) paint",
            // The third pair was not wanted.
            "component 21 (cylindrical_stage) -",
            "component 22 (cylindrical_gear) -",
            "component 23 (cylindrical_gear) -",
            "component 1000000 (bearing) -",
            "component 1000001 (bearing) -",
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn of_thousands_that_are_not_read_some_are_told_and_then_their_number() {
        let text = model(1, 40_000, "");
        let not_read = each_stage(text.as_bytes(), &choices(), 20, |_, _| {
            ControlFlow::Continue(true)
        });
        let not_read = not_read.expect("a model");
        assert_eq!(not_read.len(), MOST_NOT_READ + 1);
        assert_eq!(not_read[MOST_NOT_READ].component, "and 39000 more");
    }

    #[test]
    fn no_stage_is_looked_at_behind_the_one_that_ends_it() {
        let text = model(5, 0, "");
        let mut looked_at = 0;
        let ended = each_stage(text.as_bytes(), &choices(), 20, |_, _| {
            looked_at += 1;
            if looked_at == 2 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(true)
            }
        });
        assert!(ended.is_ok());
        assert_eq!(looked_at, 2);
    }

    /// Limit in bytes of the refusal of a model, whatever its content.
    const MOST_BYTES: usize = 200_000;

    #[test]
    fn what_is_wrong_with_a_model_is_told_in_bounded_length_whatever_repeats() {
        let long = "x".repeat(500_000);
        let twice: String = (0..5000)
            .map(|i| format!("<attribute id='a{i}'/><attribute id='a{i}'/>"))
            .collect();
        let equal = "<component id='7' type='bearing' name='b'/>".repeat(100_000);
        let unlike: String = (0..5000)
            .map(|i| format!("<component id='{}' type='bearing'/>", i / 2))
            .collect();
        let of = |components: &str| {
            format!("<model version='1.4'><components>{components}</components></model>")
        };
        let unknown: String = (0..5000)
            .map(|i| format!("<ref id='{i}' role='{i}'/>"))
            .collect();
        let json: Vec<Value> = (0..5000)
            .map(|i| json!({ "id": i, "name": &long[..1000] }))
            .collect();
        let models = [
            of(&format!(
                "<component id='1' type='{long}' name='{long}'>{twice}</component>"
            )),
            of(&format!(
                "<component id='1' type='bearing'><attribute id='{long}'/><attribute id='{long}'/></component>"
            )),
            of(&equal),
            of(&unlike),
            format!(
                "<model version='1.4'><relations><relation type='{long}'>{unknown}</relation></relations></model>"
            ),
            format!("<model version='{long}'/>"),
            json!({ "model": { "version": "1.4", "components": json } }).to_string(),
            json!({ "model": { "version": "1.4", "components": long } }).to_string(),
        ];
        for text in models {
            let Refused(faults) = import(text.as_bytes(), &choices()).expect_err("wrong");
            let bytes: usize = faults
                .iter()
                .map(|it| it.place.len() + it.detail.len())
                .sum();
            assert!(
                !faults.is_empty() && bytes < MOST_BYTES,
                "{bytes} bytes of {}",
                &text[..100]
            );
        }
    }

    #[test]
    fn load_cases_have_a_component_of_a_long_type_without_its_length() {
        let long = "x".repeat(100_000);
        let case = "<load_case id='1'><component id='1' type=''/></load_case>".repeat(900);
        let text = format!(
            "<model version='1.4'><components><component id='1' type='{long}'/></components><load_spectrum>{case}</load_spectrum></model>"
        );
        let model = Model::read(text.as_bytes()).expect("a model");
        let kinds = model.load_cases.iter().flat_map(|(_, case)| case.values());
        let bytes: usize = kinds.map(|component| component.kind.len()).sum();
        assert!(bytes < MOST_BYTES, "{bytes}");
    }
}
