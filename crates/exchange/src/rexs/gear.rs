//! From the components of one gear to the gear of a submission.

use meshwright_engine::gear::data::LEAST_RIM;
use meshwright_engine::gear::{Rack, ToolDepth};
use serde_json::{Map, Value, json};

use super::content::Component;
use super::own;
use super::reading::{LoadedFlank, Reading};
use super::unit::{DEG, KG_PER_DM3, MM, MPA, NONE, Unit, um_of_mm};
use crate::significant;

/// Largest difference of two statements of the same radius, in mm.
pub(super) const SAME: f64 = 5e-4;

/// Largest difference of two statements of the same profile shift: less than a file has digits of it.
pub(super) const SAME_SHIFT: f64 = 1e-9;

/// Digits of values computed from several attributes.
pub(super) const DIGITS: usize = 12;

/// A gear and its components.
pub(super) struct Gear<'a> {
    pub(super) reading: &'a Reading<'a>,
    pub(super) gear: &'a Component,
    /// Both flanks, or one if the model has one.
    pub(super) flanks: Vec<&'a Component>,
    /// Its loaded flanks: one if the model says which, otherwise all.
    pub(super) loaded: Vec<&'a Component>,
    pub(super) tool: Option<&'a Component>,
    /// The settings of the manufacturing steps, in their order; before version 1.3 the flank has them itself.
    pub(super) settings: Vec<&'a Component>,
    body: Option<&'a Component>,
    material: Option<&'a Component>,
    /// The basic numbers, without which nothing else can be read.
    pub(super) module: f64,
    tooth_count: f64,
    profile_shift: f64,
    pub(super) pressure_angle_deg: f64,
    /// The cosine of the helix angle at the reference circle.
    cosine: f64,
}

impl<'a> Gear<'a> {
    /// Collects the parts of `gear`, and reads its basic numbers.
    pub(super) fn of(
        reading: &'a Reading<'a>,
        gear: &'a Component,
        data: Option<&'a Component>,
        helix_angle_deg: f64,
    ) -> Option<Self> {
        let model = reading.model;
        let side = |role: &str| {
            model
                .related("flank", ("gear", gear), role)
                .into_iter()
                .next()
        };
        let (left, right) = (side("left"), side("right"));
        let flanks: Vec<_> = left.into_iter().chain(right).collect();
        let said =
            data.and_then(|data| reading.choice(data, "loaded_tooth_flank", &["left", "right"]));
        let said = said.and_then(LoadedFlank::named);
        let loaded = match reading.choices.flank.or(said) {
            Some(LoadedFlank::Left) => left.into_iter().collect(),
            Some(LoadedFlank::Right) => right.into_iter().collect(),
            None => flanks.clone(),
        };
        let steps = |role: &str| {
            let first = flanks.first();
            first.map_or(Vec::new(), |flank| {
                model.related("manufacturing_step", ("workpiece", flank), role)
            })
        };
        let (mut tools, mut settings) = (steps("tool"), steps("manufacturing_settings"));
        if tools.is_empty() {
            // Before version 1.3 the gear refers to its tools, or its flank does.
            let referring = std::iter::once(gear).chain(flanks.first().copied());
            let referenced = |of| model.related("ordered_reference", ("origin", of), "referenced");
            tools = referring.flat_map(referenced).collect();
            tools.retain(|tool| tool.kind.ends_with("_tool"));
        }
        if settings.is_empty() {
            let of_flank = flanks.iter().copied();
            let mut says = of_flank.filter(|flank| flank.attribute(GENERATED_SHIFT).is_some());
            settings.extend(says.next());
        }
        let bodies = model.related("assembly", ("assembly", gear), "part");
        let body = bodies.into_iter().find(|part| part.kind == "gear_body");
        let material = |of| {
            let referenced = model.related("reference", ("origin", of), "referenced");
            referenced
                .into_iter()
                .find(|other| other.kind == "material")
        };
        let module = needed(reading, gear, "normal_module", MM);
        let tooth_count = needed(reading, gear, "number_of_teeth", NONE);
        let (module, tooth_count) = (module?, tooth_count?);
        if tooth_count < 0.0 {
            let detail =
                format!("It is {tooth_count}: an internal gear, which the mechanics do not know.");
            reading.wrong(gear.place_of("number_of_teeth"), detail);
            return None;
        }
        let mut found = Self {
            reading,
            gear,
            flanks,
            loaded,
            tool: tools.first().copied().filter(|tool| tool.kind == RACK),
            settings,
            body,
            material: material(gear).or_else(|| material(body?)),
            module,
            tooth_count,
            profile_shift: 0.0,
            pressure_angle_deg: 20.0,
            cosine: helix_angle_deg.to_radians().cos(),
        };
        let of_tool = found
            .tool
            .and_then(|tool| reading.number(tool, "normal_pressure_angle", DEG));
        let angle = found.of_flanks("normal_pressure_angle", DEG).or(of_tool);
        let shift = found.of_flanks("addendum_modification_coefficient", NONE);
        let as_length = || Some(found.of_flanks("addendum_modification", MM)? / module);
        let shift = shift.or_else(as_length);
        found.pressure_angle_deg =
            angle.unwrap_or_else(|| found.assumed("normal_pressure_angle", "20 deg", 20.0));
        found.profile_shift =
            shift.unwrap_or_else(|| found.assumed("addendum_modification_coefficient", "0", 0.0));
        if let Some(other) = tools.first().filter(|tool| tool.kind != RACK) {
            let detail = "It cuts the root, which is known here as a rack_shaped_tool cuts it.";
            reading.wrong(other.place(), detail);
        }
        found.refuse_other_rack();
        found.refuse_broken_tips();
        if found.material.is_none() {
            found.material = reading.shaft_of(gear).and_then(material);
            if let Some(material) = found.material {
                reading.remark(format!(
                    "Assumed: {} has no material; taken is that of its shaft, {}.",
                    gear.place(),
                    material.place()
                ));
            }
        }
        Some(found)
    }

    /// A rack that breaks the tip edges by an amount that nothing says.
    fn refuse_broken_tips(&self) {
        let Some(tool) = self.tool else { return };
        let name = "chamfer_angle";
        let breaks = self
            .reading
            .number(tool, name, DEG)
            .is_some_and(|angle| angle != 0.0);
        if breaks && self.of_flanks("tooth_tip_chamfer", MM).is_none() {
            let detail =
                "It breaks the tip edges; no tooth_tip_chamfer of the flanks says by how much.";
            self.reading.wrong(tool.place_of(name), detail);
        }
    }

    /// A rack of another module and angle can generate the same flanks, but its numbers mean another root then.
    fn refuse_other_rack(&self) {
        let Some(tool) = self.tool else { return };
        for (name, unit, of_gear) in [
            ("normal_module", MM, self.module),
            ("normal_pressure_angle", DEG, self.pressure_angle_deg),
        ] {
            let of_tool = self.reading.number(tool, name, unit);
            if let Some(of_tool) = of_tool.filter(|value| *value != of_gear) {
                let unit = unit.name;
                let detail = format!(
                    "It is {of_tool} {unit}, that of its gear {of_gear} {unit}; a rack is taken to have the same."
                );
                self.reading.wrong(tool.place_of(name), detail);
            }
        }
    }

    /// `value`, and a remark that the model does not say it.
    fn assumed(&self, attribute: &str, said: &str, value: f64) -> f64 {
        self.reading.assumed(self.gear, attribute, said);
        value
    }

    /// A number that both flanks have alike.
    fn of_flanks(&self, attribute: &str, unit: Unit) -> Option<f64> {
        let numbers: Vec<(f64, &Component)> = self
            .flanks
            .iter()
            .filter_map(|flank| Some((self.reading.number(flank, attribute, unit)?, *flank)))
            .collect();
        let (first, _) = *numbers.first()?;
        if let Some((other, flank)) = numbers.iter().find(|(number, _)| *number != first) {
            let detail = format!(
                "It is {other}, that of the other flank {first}; teeth are computed with the same on both sides."
            );
            self.reading.wrong(flank.place_of(attribute), detail);
        }
        Some(first)
    }

    /// The gear as a submission has it. `pointer` is its place there, `bore` the caller's bore radius.
    pub(super) fn document(&self, pointer: &str, bore: Option<f64>) -> Option<Value> {
        let reading = self.reading;
        let face_width = needed(reading, self.gear, "face_width", MM);
        let mut gear = Map::new();
        let mut put = |name: &str, value: Value, from: Option<(&Component, &str)>| {
            if let Some((component, attribute)) = from {
                reading.from(format!("{pointer}/{name}"), component, attribute);
            }
            gear.insert(name.to_owned(), value);
        };
        let of_gear = |attribute| Some((self.gear, attribute));
        let of_flank = |attribute| self.flanks.first().map(|flank| (*flank, attribute));
        let teeth = match self.tooth_count {
            whole if whole.fract() == 0.0 => json!(whole as u64),
            broken => json!(broken),
        };
        put("tooth_count", teeth, of_gear("number_of_teeth"));
        put("module_mm", json!(self.module), of_gear("normal_module"));
        put(
            "pressure_angle_deg",
            json!(self.pressure_angle_deg),
            of_flank("normal_pressure_angle"),
        );
        let shift = "addendum_modification_coefficient";
        put("profile_shift", json!(self.profile_shift), of_flank(shift));
        put("face_width_mm", json!(face_width?), of_gear("face_width"));
        let (name, tip, from) = self.tip();
        put(name, json!(tip), from);
        if let Some((of, attribute)) = from {
            // However the submission says it.
            reading.from(format!("{pointer}/addendum_mm"), of, attribute);
        }
        let (dedendum, from_root) = self.dedendum();
        let root = 2.0 * (self.generated_radius() - dedendum);
        if let Some((of, attribute)) = from.filter(|_| 2.0 * self.tip_radius() <= root) {
            let detail = format!(
                "It is {tip} mm; a tip circle lies outside the root circle, {} mm.",
                significant(root, 8)
            );
            reading.wrong(of.place_of(attribute), detail);
            return None;
        }
        put("dedendum_mm", json!(dedendum), from_root);
        let rounding = self.rack_tip_radius();
        if let Some((radius, from)) = rounding {
            put("rack_tip_radius_mm", json!(radius), Some(from));
        }
        if let Some((deviation, settings)) = self.thickness_deviation() {
            let from = (settings, GENERATED_SHIFT);
            put("tooth_thickness_deviation_um", json!(deviation), Some(from));
        }
        let from = self.settings.first().map(|of| (*of, GENERATED_SHIFT));
        match self.tool_depth() {
            ToolDepth::ByThickness => {}
            ToolDepth::Nominal => put("thinned_by", json!("flank_grinding"), from),
            ToolDepth::At(shift) => put("generating_profile_shift", json!(shift), from),
        }
        if let Some(rounding) = reading.number(self.gear, own::TIP_ROUNDING, MM) {
            put(
                "tip_rounding_mm",
                json!(rounding),
                of_gear(own::TIP_ROUNDING),
            );
        } else if let Some(chamfer) = self
            .of_flanks("tooth_tip_chamfer", MM)
            .filter(|depth| *depth > 0.0)
        {
            put(
                "tip_chamfer_mm",
                json!(chamfer),
                of_flank("tooth_tip_chamfer"),
            );
        }
        let mut modifications = self.modifications(pointer)?;
        if modifications
            .first()
            .is_some_and(|first| first["kind"] == "tip_relief")
        {
            let mut relief = modifications.remove(0);
            relief.as_object_mut()?.remove("kind");
            put("tip_relief", relief, None);
        }
        put("profile_modifications", Value::Array(modifications), None);
        let leads = self.leads()?;
        if !leads.is_empty() {
            put("lead_modifications", Value::Array(leads), None);
        }
        let rounding = rounding.map(|(radius, _)| radius);
        if let Some(protuberance) = self.protuberance(pointer, rounding) {
            put("protuberance", protuberance, None);
        }
        if let Some(deviations) = reading.json(self.gear, own::DEVIATIONS) {
            put("tooth_deviations", deviations, of_gear(own::DEVIATIONS));
        }
        put("material", self.material(pointer), None);
        put("blank", self.blank(pointer, bore, dedendum)?, None);
        Some(Value::Object(gear))
    }

    fn reference_radius(&self) -> f64 {
        self.module * self.tooth_count / (2.0 * self.cosine)
    }

    /// The pressure angle in the transverse section, in radians.
    fn transverse_angle(&self) -> f64 {
        (self.pressure_angle_deg.to_radians().tan() / self.cosine).atan()
    }

    pub(super) fn base_radius(&self) -> f64 {
        self.reference_radius() * self.transverse_angle().cos()
    }

    /// How long the path from the base circle to a diameter of the flank is.
    pub(super) fn roll_length(&self, diameter: f64) -> f64 {
        let square = 0.25 * diameter * diameter - self.base_radius().powi(2);
        square.max(0.0).sqrt()
    }

    /// The diameter that a roll length leads to.
    pub(super) fn diameter(&self, roll_length: f64) -> f64 {
        2.0 * self.base_radius().hypot(roll_length)
    }

    pub(super) fn tip_radius(&self) -> f64 {
        match self.tip() {
            ("tip_diameter_mm", diameter, _) => 0.5 * diameter,
            (_, addendum, _) => self.shifted_radius() + addendum,
        }
    }

    /// The roll length at the tip circle.
    pub(super) fn tip_length(&self) -> f64 {
        self.roll_length(2.0 * self.tip_radius())
    }

    /// The roll length of the form circle, where the straight flank of the rack ends; none where the rack cuts into the flank.
    pub(super) fn form_length(&self) -> Option<f64> {
        let (module, angle) = (self.module, self.pressure_angle_deg.to_radians());
        let dedendum = self.dedendum().0;
        let mut rack = Rack {
            module,
            pressure_angle: angle,
            addendum: module,
            dedendum,
            tip_radius: 0.0,
            protuberance: None,
        };
        // As a submission has it where it is not said.
        let usual = (0.38 * module).min(rack.largest_tip_radius());
        rack.tip_radius = self.rack_tip_radius().map_or(usual, |(radius, _)| radius);
        let depth = rack.straight_depth() - self.generating_shift() * module;
        let sine = self.transverse_angle().sin();
        let form = self.reference_radius() * sine - depth / sine;
        (form >= 0.0 && self.tip_length() > form).then_some(form)
    }

    /// From where the addendum counts.
    fn shifted_radius(&self) -> f64 {
        self.reference_radius() + self.profile_shift * self.module
    }

    /// From where the dedendum counts.
    fn generated_radius(&self) -> f64 {
        self.reference_radius() + self.generating_shift() * self.module
    }

    /// Where the tool stood that cut the root: by the generated shift of the first step, which may be that of the finished teeth, the nominal one or another.
    /// Where the first step says none, a hob is taken that left the finished teeth.
    fn tool_depth(&self) -> ToolDepth {
        let first = self.settings.first();
        let first = first.and_then(|settings| self.generated_shift(settings));
        let (Some((first, _)), Some((finished, _))) = (first, self.finished_shift()) else {
            return ToolDepth::ByThickness;
        };
        let alike = |one: f64, other: f64| (one - other).abs() <= SAME_SHIFT;
        if alike(first, finished) {
            ToolDepth::ByThickness
        } else if alike(first, self.profile_shift) {
            ToolDepth::Nominal
        } else {
            ToolDepth::At(first)
        }
    }

    /// The generating profile shift x_E.
    fn generating_shift(&self) -> f64 {
        let finished = || self.finished_shift().map(|(shift, _)| shift);
        match self.tool_depth() {
            ToolDepth::ByThickness => finished().unwrap_or(self.profile_shift),
            ToolDepth::Nominal => self.profile_shift,
            ToolDepth::At(shift) => shift,
        }
    }

    /// The tip circle. The basic profile has the rounder numbers, and holds where the diameter agrees or is not said.
    fn tip(&self) -> (&'static str, f64, Option<(&'a Component, &'static str)>) {
        let (of_profile, of_circle) = ("addendum_coefficient_basic_profile", "tip_diameter");
        let coefficient = self.of_flanks(of_profile, NONE);
        let addendum = coefficient.map(|modules| significant(modules * self.module, DIGITS));
        let height = || {
            // Version 2.0 renamed it.
            let names = [("tooth_tip_height", 1.0), ("addendum_basic_profile", 1.0)];
            let (height, name) = self.reading.either(self.gear, names, [MM, MM])?;
            let diameter = 2.0 * (self.reference_radius() + height);
            Some((significant(diameter, DIGITS), name))
        };
        let diameter = self.reading.number(self.gear, of_circle, MM);
        let diameter = diameter.filter(|diameter| *diameter != 0.0);
        let diameter = diameter.map(|d| (d, of_circle)).or_else(height);
        let flank = || self.flanks.first().map(|flank| (*flank, of_profile));
        match (addendum, diameter) {
            (Some(addendum), Some((diameter, _)))
                if (self.shifted_radius() + addendum - diameter / 2.0).abs() <= SAME =>
            {
                ("addendum_mm", addendum, flank())
            }
            (_, Some((diameter, name))) => ("tip_diameter_mm", diameter, Some((self.gear, name))),
            (Some(addendum), None) => ("addendum_mm", addendum, flank()),
            (None, None) => {
                let addendum = self.assumed(of_circle, "an addendum of one module", self.module);
                ("addendum_mm", addendum, None)
            }
        }
    }

    /// The profile shift with which the teeth were generated in a manufacturing step, if it is said.
    pub(super) fn generated_shift(&self, settings: &'a Component) -> Option<(f64, &'a Component)> {
        let shift = self.reading.number(settings, GENERATED_SHIFT, NONE)?;
        Some((shift, settings))
    }

    /// Stock that the first tool leaves on each flank, normal to it, for another step; the teeth are cut thicker by it, and the root less deep.
    pub(super) fn allowance(&self) -> f64 {
        let steps = self
            .settings
            .first()
            .copied()
            .map(|of| (of, "machining_allowance"));
        let flank = self.flanks.first().copied();
        let of_flank = flank.map(|of| (of, "machining_allowance"));
        let of_tool = self.tool.into_iter().flat_map(|of| {
            let names = [
                "machining_allowance_din_3972",
                "machining_allowance_din_3972_1952",
            ];
            names.map(|name| (of, name))
        });
        let places = steps.into_iter().chain(of_flank).chain(of_tool);
        let mut said = places.filter_map(|(of, name)| {
            let amount = self.reading.number(of, name, MM)?;
            Some((amount, of, name)).filter(|_| amount != 0.0)
        });
        let Some((amount, of, name)) = said.next() else {
            return 0.0;
        };
        self.reading.remark(format!(
            "Assumed: the tool stands out by {}, {amount} mm on each flank, when it cuts the root.",
            of.place_of(name)
        ));
        amount
    }

    /// The dedendum, from the tool that cuts the root or from the root diameter; the diameter holds where they disagree.
    fn dedendum(&self) -> (f64, Option<(&'a Component, &'static str)>) {
        let of_circle = "root_diameter";
        let of_tool = self.tool.and_then(|tool| {
            let names = [
                ("addendum_coefficient_reference_profile", self.module),
                ("addendum_reference_profile", 1.0),
            ];
            let (reach, name) = self.reading.either(tool, names, [NONE, MM])?;
            // A step that says where its tool stood is followed there; otherwise an allowance moves the tool out.
            let first = self.settings.first();
            let generated = first.and_then(|settings| self.generated_shift(settings));
            let out = match generated {
                Some(_) => 0.0,
                None => self.allowance() / self.pressure_angle_deg.to_radians().sin(),
            };
            Some((significant(reach - out, DIGITS), (tool, name)))
        });
        let diameter = self.reading.number(self.gear, of_circle, MM);
        let of_diameter = diameter.map(|diameter| {
            let dedendum = self.generated_radius() - diameter / 2.0;
            (significant(dedendum, DIGITS), (self.gear, of_circle))
        });
        match (of_tool, of_diameter) {
            (Some(tool), Some(circle)) if (tool.0 - circle.0).abs() <= SAME => {
                (tool.0, Some(tool.1))
            }
            (Some(tool), Some(circle)) => {
                self.reading.remark(format!(
                    "Not read: {}: it would leave a dedendum of {} mm, the {of_circle} {} mm.",
                    tool.1.0.place_of(tool.1.1),
                    tool.0,
                    circle.0
                ));
                (circle.0, Some(circle.1))
            }
            (Some(one), None) | (None, Some(one)) => (one.0, Some(one.1)),
            (None, None) => {
                let usual = significant(1.25 * self.module, DIGITS);
                (
                    self.assumed(of_circle, "a dedendum of 1.25 modules", usual),
                    None,
                )
            }
        }
    }

    /// The rounding of the tool's tip. Version 2.0 renamed it.
    fn rack_tip_radius(&self) -> Option<(f64, (&'a Component, &'static str))> {
        let found = self.tool.and_then(|tool| {
            let factors = [
                ("tip_corner_radius_factor_reference_profile", self.module),
                ("tip_radius_factor", self.module),
            ];
            let lengths = [
                ("tip_corner_radius_reference_profile", 1.0),
                ("tip_radius", 1.0),
            ];
            let by_factor = self.reading.either(tool, factors, [NONE, NONE]);
            let by_length = self.reading.either(tool, lengths, [MM, MM]);
            let (radius, name) = by_factor.or(by_length)?;
            Some((significant(radius, DIGITS), (tool, name)))
        });
        // Before version 1.3 the flank may say it.
        let name = "tool_edge_radius";
        let of_flank = || {
            let radius = self.of_flanks(name, MM).filter(|radius| *radius > 0.0)?;
            Some((radius, (*self.flanks.first()?, name)))
        };
        let found = found.or_else(of_flank);
        if found.is_none() {
            let said = "0.38 modules, or the largest that fits";
            self.assumed("rack_shaped_tool with a tip radius", said, 0.0);
        }
        found
    }

    /// The profile shift with which the finished teeth are as thick as they are, by the last step that says one.
    fn finished_shift(&self) -> Option<(f64, &'a Component)> {
        let mut shifts = self.settings.iter().rev();
        let finished = "addendum_modification_coefficient_after_finishing";
        let of_flank = || Some((self.of_flanks(finished, NONE)?, *self.flanks.first()?));
        let generated = shifts.find_map(|settings| self.generated_shift(settings));
        generated.or_else(of_flank)
    }

    /// How much thicker than nominal the teeth are on the reference circle, in um.
    fn thickness_deviation(&self) -> Option<(f64, &'a Component)> {
        let (shift, settings) = self.finished_shift()?;
        let off = (shift - self.profile_shift) * self.module;
        let thicker = 2.0 * off * self.pressure_angle_deg.to_radians().tan() / self.cosine;
        // Of a difference of two numbers near each other fewer digits are left.
        Some((um_of_mm(significant(thicker, 10)), settings))
    }

    /// The material; values that the model lacks are those of steel, as everywhere.
    fn material(&self, pointer: &str) -> Value {
        let mut document = Map::new();
        for (name, attribute, unit, factor) in [
            ("youngs_modulus_gpa", "elastic_modulus", MPA, 1e-3),
            ("poisson_ratio", "poisson_ratio", NONE, 1.0),
            ("density_kg_m3", "density", KG_PER_DM3, 1e3),
        ] {
            let said = self.material.and_then(|material| {
                let number = self.reading.number(material, attribute, unit)?;
                Some((number, material))
            });
            match said {
                Some((number, material)) => {
                    let field = format!("{pointer}/material/{name}");
                    self.reading.from(field, material, attribute);
                    document.insert(name.to_owned(), json!(significant(number * factor, 15)));
                }
                None => {
                    self.assumed(attribute, "that of steel", 0.0);
                }
            }
        }
        Value::Object(document)
    }

    /// Bore, holes and web.
    fn blank(&self, pointer: &str, bore: Option<f64>, dedendum: f64) -> Option<Value> {
        let reading = self.reading;
        let pointer = format!("{pointer}/blank");
        let root = self.generated_radius() - dedendum;
        let inner = |of: &'a Component| Some((reading.number(of, "inner_diameter", MM)?, of));
        let said = inner(self.gear).filter(|(diameter, _)| *diameter > 0.0);
        let said = said.or_else(|| self.body.and_then(inner));
        let said = said.or_else(|| inner(self.gear));
        let own = reading.json(self.gear, own::SHAFT);
        let own = own.and_then(|own| Some((own["radius_mm"].as_f64()?, own)));
        let (radius, mut blank) = match (bore, own, said) {
            (Some(bore), ..) => (bore, json!({ "bore_radius_mm": bore })),
            (None, Some((radius, shaft)), _) => (radius, json!({ "shaft": shaft })),
            (None, None, Some((diameter, of))) if diameter > 0.0 => {
                reading.from(format!("{pointer}/bore_radius_mm"), of, "inner_diameter");
                (diameter / 2.0, json!({ "bore_radius_mm": diameter / 2.0 }))
            }
            (None, None, solid) => {
                let Some((diameter, section)) = reading.seat(self.gear) else {
                    let detail = "It has no inner_diameter above 0, neither has a gear_body of it, and no shaft_section under it says how thick its shaft is. The hub is rigid on the bore, so that it needs one; say it by --bore-radius MM.";
                    reading.wrong(self.gear.place(), detail);
                    return None;
                };
                // Where it says to have no bore, or nothing would be left of it around one, it is of one piece with its shaft.
                let radius = diameter / 2.0;
                let largest = root - LEAST_RIM * self.module / self.cosine;
                let solid = solid.is_some() || radius > largest;
                let blank = if solid {
                    self.on_solid_shaft(&pointer, (radius, largest), section)
                } else {
                    reading.remark(format!(
                        "Assumed: {} has no inner_diameter; taken is the outer diameter of its shaft under it, {diameter} mm of {}.",
                        self.gear.place(),
                        section.place()
                    ));
                    reading.from(format!("{pointer}/bore_radius_mm"), section, SECTION);
                    json!({ "bore_radius_mm": radius })
                };
                (radius, blank)
            }
        };
        for (field, attribute) in own::OPENINGS {
            if let Some(openings) = reading.json(self.gear, attribute) {
                reading.from(format!("{pointer}/{field}"), self.gear, attribute);
                blank[field] = openings;
            }
        }
        if let Some(web) = self.web(radius, root) {
            blank["web"] = web;
            if let Some(offset) = self
                .body
                .and_then(|body| reading.number(body, own::WEB_OFFSET, MM))
            {
                blank["web"]["offset_mm"] = json!(offset);
            }
        }
        if let Some(hub) = self.body.and_then(|body| reading.json(body, own::HUB)) {
            blank["hub"] = hub;
        }
        Some(blank)
    }

    /// The blank of a gear that is of one piece with its shaft, whose radius under the teeth is `radius`, in mm; at most `largest`.
    fn on_solid_shaft(
        &self,
        pointer: &str,
        (radius, largest): (f64, f64),
        section: &'a Component,
    ) -> Value {
        let reading = self.reading;
        let taken = radius.min((1e4 * largest).floor() / 1e4);
        let thicker = if taken < radius {
            format!("; taken are {taken} mm, a module below the root circle")
        } else {
            String::new()
        };
        reading.remark(format!(
            "Assumed: {} is of one piece with its shaft, whose radius under it is {radius} mm by {}{thicker}.",
            self.gear.place(),
            section.place()
        ));
        reading.from(format!("{pointer}/shaft/radius_mm"), section, SECTION);
        json!({ "shaft": { "radius_mm": taken } })
    }

    /// The web between a rim, which lies under the root circle, and the bore, unless we wrote where it begins.
    fn web(&self, bore: f64, root: f64) -> Option<Value> {
        let body = self.body?;
        let number = |attribute| self.reading.number(body, attribute, MM);
        let thickness = number("gear_body_web_thickness");
        let rim = number("gear_body_rim_thickness");
        let inner = number(own::WEB_INNER_RADIUS);
        match (thickness, rim) {
            (Some(thickness), Some(rim)) => {
                let inner = inner.unwrap_or_else(|| {
                    let hub = format!("{bore} mm, the bore: no hub");
                    self.assumed("inner radius of the web", &hub, bore)
                });
                let outer = significant(root - rim, DIGITS);
                Some(
                    json!({ "inner_radius_mm": inner, "outer_radius_mm": outer, "thickness_mm": thickness }),
                )
            }
            (None, None) => None,
            _ => {
                let detail =
                    "A web needs both gear_body_web_thickness and gear_body_rim_thickness.";
                self.reading.wrong(body.place(), detail);
                None
            }
        }
    }
}

/// The tool whose root is known.
const RACK: &str = "rack_shaped_tool";

/// The attribute of a section of a shaft that says how thick it is.
const SECTION: &str = "outer_diameter_begin";

/// The profile shift of a manufacturing step.
pub(super) const GENERATED_SHIFT: &str = "generated_addendum_modification_coefficient";

/// A number that has no default.
pub(super) fn needed(
    reading: &Reading<'_>,
    of: &Component,
    attribute: &str,
    unit: Unit,
) -> Option<f64> {
    let number = reading.number(of, attribute, unit);
    if number.is_none() && of.attribute(attribute).is_none() {
        let detail = format!("It has no {attribute}, which has no default.");
        reading.wrong(of.place(), detail);
    }
    number
}
