//! From the components of one gear to the gear of a submission.

use serde_json::{Map, Value, json};

use super::file::Component;
use super::own;
use super::reading::Reading;
use super::unit::{DEG, KG_PER_DM3, MM, MPA, NONE, Unit, um_of_mm};
use crate::significant;

/// What two ways to say one radius may differ by, in mm, to be the same.
const SAME: f64 = 5e-4;

/// The digits of what is computed from several attributes.
const DIGITS: usize = 12;

/// A gear and what belongs to it.
pub(super) struct Gear<'a> {
    reading: &'a Reading<'a>,
    gear: &'a Component,
    /// Both flanks, or one if the model has one.
    flanks: Vec<&'a Component>,
    /// Those of them that are loaded: one if the model says which, else all.
    loaded: Vec<&'a Component>,
    tool: Option<&'a Component>,
    /// The settings of the manufacturing steps, in their order.
    settings: Vec<&'a Component>,
    body: Option<&'a Component>,
    material: Option<&'a Component>,
    /// The basic numbers, without which nothing else can be read.
    module: f64,
    tooth_count: f64,
    profile_shift: f64,
    pressure_angle_deg: f64,
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
        let loaded = match data
            .and_then(|data| reading.choice(data, "loaded_tooth_flank", &["left", "right"]))
        {
            Some("left") => left.into_iter().collect(),
            Some("right") => right.into_iter().collect(),
            _ => flanks.clone(),
        };
        let steps = |role: &str| {
            let first = flanks.first();
            first.map_or(Vec::new(), |flank| {
                model.related("manufacturing_step", ("workpiece", flank), role)
            })
        };
        let (tools, settings) = (steps("tool"), steps("manufacturing_settings"));
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
            tool: (tools.into_iter().next()).filter(|tool| tool.kind == "rack_shaped_tool"),
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
        found.refuse_other_rack();
        Some(found)
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

    /// The gear as a submission has it. `pointer` is its place there, `bore` what the caller says of its bore radius.
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
        let (dedendum, from) = self.dedendum();
        put("dedendum_mm", json!(dedendum), from);
        if let Some((radius, from)) = self.rack_tip_radius() {
            put("rack_tip_radius_mm", json!(radius), Some(from));
        }
        if let Some((deviation, settings)) = self.thickness_deviation() {
            let from = (settings, GENERATED_SHIFT);
            put("tooth_thickness_deviation_um", json!(deviation), Some(from));
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

    /// From where addendum and dedendum count.
    fn shifted_radius(&self) -> f64 {
        self.reference_radius() + self.profile_shift * self.module
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
    fn generated_shift(&self, settings: &'a Component) -> Option<(f64, &'a Component)> {
        let shift = self.reading.number(settings, GENERATED_SHIFT, NONE)?;
        Some((shift, settings))
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
            // The tool stands where it generates the teeth, which may be off the nominal profile shift.
            let first = self.settings.first();
            let generated = first.and_then(|settings| self.generated_shift(settings));
            let off = generated.map_or(0.0, |(shift, _)| shift - self.profile_shift);
            Some((significant(reach - off * self.module, DIGITS), (tool, name)))
        });
        let diameter = self.reading.number(self.gear, of_circle, MM);
        let of_diameter = diameter.map(|diameter| {
            let dedendum = self.shifted_radius() - diameter / 2.0;
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
        if found.is_none() {
            let said = "0.38 modules, or the largest that fits";
            self.assumed("rack_shaped_tool with a tip radius", said, 0.0);
        }
        found
    }

    /// How much thicker than nominal the teeth are on the reference circle, by the shift of the last step that says one, in um.
    fn thickness_deviation(&self) -> Option<(f64, &'a Component)> {
        let mut shifts = self.settings.iter().rev();
        let (shift, settings) = shifts.find_map(|settings| self.generated_shift(settings))?;
        let off = (shift - self.profile_shift) * self.module;
        let thicker = 2.0 * off * self.pressure_angle_deg.to_radians().tan() / self.cosine;
        // Of a difference of two numbers near each other fewer digits are left.
        Some((um_of_mm(significant(thicker, 10)), settings))
    }

    /// The material; what of it the model does not say is that of steel, as everywhere.
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
        let inner = |of: &'a Component| {
            let diameter = reading
                .number(of, "inner_diameter", MM)
                .filter(|d| *d > 0.0)?;
            Some((diameter / 2.0, of))
        };
        let (of_gear, of_body) = (inner(self.gear), self.body.and_then(inner));
        let said = of_gear.or(of_body);
        let radius = match (bore, said) {
            (Some(bore), _) => bore,
            (None, Some((radius, of))) => {
                reading.from(format!("{pointer}/bore_radius_mm"), of, "inner_diameter");
                radius
            }
            (None, None) => {
                let detail = "It has no inner_diameter above 0, and neither has a gear_body of it. The hub is rigid on the bore, so that it needs one; say it by --bore-radius MM.";
                reading.wrong(self.gear.place(), detail);
                return None;
            }
        };
        let mut blank = json!({ "bore_radius_mm": radius });
        if let Some(holes) = reading.json(self.gear, own::HOLES) {
            reading.from(format!("{pointer}/holes"), self.gear, own::HOLES);
            blank["holes"] = holes;
        }
        if let Some(web) = self.web(radius, self.shifted_radius() - dedendum) {
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

    /// The modifications of the loaded flanks, tip reliefs first.
    fn modifications(&self, pointer: &str) -> Option<Vec<Value>> {
        let of_each: Vec<Vec<Value>> = self
            .loaded
            .iter()
            .map(|flank| self.modifications_of(flank))
            .collect::<Option<_>>()?;
        let mut of_each = of_each.into_iter();
        let first = of_each.next().unwrap_or_default();
        if of_each.any(|other| other != first) {
            let detail = "Its flanks are modified differently, and no loaded_tooth_flank of a cylindrical_stage_gear_data says which is loaded.";
            self.reading.wrong(self.gear.place(), detail);
            return None;
        }
        for (i, modification) in first.iter().enumerate() {
            // The first tip relief has a field of its own.
            let short = first[0]["kind"] == "tip_relief";
            let field = match i {
                0 if short => format!("{pointer}/tip_relief"),
                i => format!("{pointer}/profile_modifications/{}", i - usize::from(short)),
            };
            let kind = modification["kind"].as_str().unwrap_or_default();
            let flank = self.loaded.first()?;
            self.reading.from(field, flank, &format!("its {kind}"));
        }
        Some(first)
    }

    fn modifications_of(&self, flank: &'a Component) -> Option<Vec<Value>> {
        let model = self.reading.model;
        let parts = model.related("reference", ("origin", flank), "referenced");
        let of_kind =
            |kind: &'static str| parts.iter().copied().filter(move |part| part.kind == kind);
        let mut modifications = Vec::new();
        for tip in of_kind("tip_relief") {
            modifications.push(self.relief(tip, &TIP)?);
        }
        for root in of_kind("root_relief") {
            modifications.push(self.relief(root, &ROOT)?);
        }
        for crowning in of_kind("profile_crowning") {
            modifications.push(self.crowning(crowning)?);
        }
        for slope in of_kind("profile_slope") {
            let amount = um_of_mm(needed(self.reading, slope, "profile_slope", MM)?);
            self.reading.remark(format!(
                "Assumed: a positive profile_slope of {} takes material off at the tip.",
                slope.place()
            ));
            modifications.push(json!({ "kind": "slope", "amount_um": amount }));
        }
        match self.reading.json(flank, own::TABLES) {
            Some(Value::Array(tables)) => modifications.extend(tables),
            Some(_) => {
                let detail = "A list of profile tables is expected, as a submission has them.";
                self.reading.wrong(flank.place_of(own::TABLES), detail);
            }
            None => {}
        }
        Some(modifications)
    }

    /// The modifications of the leads of the loaded flanks.
    fn leads(&self) -> Option<Vec<Value>> {
        let of_each = self.loaded.iter().map(|flank| self.leads_of(flank));
        let mut of_each = of_each.collect::<Option<Vec<_>>>()?.into_iter();
        let first = of_each.next().unwrap_or_default();
        if of_each.any(|other| other != first) {
            let detail = "The leads of its flanks are modified differently, and no loaded_tooth_flank of a cylindrical_stage_gear_data says which is loaded.";
            self.reading.wrong(self.gear.place(), detail);
            return None;
        }
        Some(first)
    }

    fn leads_of(&self, flank: &'a Component) -> Option<Vec<Value>> {
        let reading = self.reading;
        let parts = reading
            .model
            .related("reference", ("origin", flank), "referenced");
        let mut leads = Vec::new();
        for part in &parts {
            match part.kind.as_str() {
                "helix_crowning" => leads.push(self.helix_crowning(part)?),
                "helix_slope" => {
                    let amount = um_of_mm(needed(reading, part, "helix_slope", MM)?);
                    reading.remark(format!(
                        "Assumed: a positive helix_slope of {} takes material off at the +z end of the face, towards which the driving gear is seen to turn counter-clockwise.",
                        part.place()
                    ));
                    leads.push(json!({ "kind": "slope", "amount_um": amount }));
                }
                _ => {}
            }
        }
        match reading.json(flank, own::LEADS) {
            Some(Value::Array(others)) => leads.extend(others),
            Some(_) => {
                let detail = "A list of lead modifications is expected, as a submission has them.";
                reading.wrong(flank.place_of(own::LEADS), detail);
            }
            None => {}
        }
        Some(leads)
    }

    fn helix_crowning(&self, crowning: &'a Component) -> Option<Value> {
        let reading = self.reading;
        let names = [
            "helix_crowning_amount_datum_face",
            "helix_crowning_amount_non_datum_face",
        ];
        let [one, other] = names.map(|name| reading.number(crowning, name, MM));
        let Some(amount) = one.or(other) else {
            let detail = format!("It has neither {} nor {}.", names[0], names[1]);
            reading.wrong(crowning.place(), detail);
            return None;
        };
        if let Some(other) = other.filter(|other| (other - amount).abs() > 1e-4) {
            let detail = format!(
                "It takes off {amount} mm at the datum face and {other} mm at the other; a crowning has the same at both here. A helix_slope beside it says the rest."
            );
            reading.wrong(crowning.place(), detail);
            return None;
        }
        Some(json!({ "kind": "crowning", "amount_um": um_of_mm(amount) }))
    }

    fn relief(&self, relief: &'a Component, names: &ReliefNames) -> Option<Value> {
        let reading = self.reading;
        let amount = um_of_mm(needed(reading, relief, names.depth, MM)?);
        let name = "shape_of_relief";
        let said = reading.choice(relief, name, &["linear", "parabolic"]);
        if relief.attribute(name).is_none() {
            reading.assumed(relief, name, "linear");
        }
        let shape = said.unwrap_or("linear");
        if names.kind == "tip_relief"
            && let Some(at) = reading.number(relief, "tip_relief_evaluation_reference", MM)
        {
            let (name, value, _) = self.tip();
            let tip = if name == "tip_diameter_mm" {
                value
            } else {
                2.0 * (self.shifted_radius() + value)
            };
            if (at - tip).abs() > 2.0 * SAME {
                let detail = format!(
                    "The depth is said at {at} mm; a relief has its amount at the tip circle here, {tip} mm."
                );
                reading.wrong(relief.place_of("tip_relief_evaluation_reference"), detail);
                return None;
            }
        }
        let diameter = reading.number(relief, names.diameter, MM);
        let start = match diameter {
            Some(diameter) => json!({ "diameter_mm": diameter }),
            None => match reading.number(relief, names.length, MM) {
                Some(length) => json!({ names.roll_length: length }),
                None => {
                    let detail = format!(
                        "It has neither {} nor {}: where does it begin?",
                        names.diameter, names.length
                    );
                    reading.wrong(relief.place(), detail);
                    return None;
                }
            },
        };
        Some(json!({ "kind": names.kind, "amount_um": amount, "shape": shape, "start": start }))
    }

    fn crowning(&self, crowning: &'a Component) -> Option<Value> {
        let reading = self.reading;
        let tip = needed(reading, crowning, "profile_crowning_at_tip", MM)?;
        let root = reading
            .number(crowning, "profile_crowning_at_root", MM)
            .unwrap_or(tip);
        if (tip - root).abs() > 1e-4 {
            let detail = format!(
                "It takes off {tip} mm at the tip and {root} mm at the root; a crowning has the same at both here. A profile_slope beside it says the rest."
            );
            reading.wrong(crowning.place(), detail);
            return None;
        }
        // A circle and a parabola of so little height are the same to a millionth of it.
        let shapes = ["parabolic", "circular"];
        reading.choice(crowning, "shape_of_profile_crowning", &shapes);
        Some(json!({ "kind": "crowning", "amount_um": um_of_mm(tip) }))
    }
}

/// The profile shift of a manufacturing step.
pub(super) const GENERATED_SHIFT: &str = "generated_addendum_modification_coefficient";

/// How the attributes of a relief are called, in the model and in a submission.
pub(super) struct ReliefNames {
    pub(super) kind: &'static str,
    pub(super) depth: &'static str,
    pub(super) diameter: &'static str,
    pub(super) length: &'static str,
    pub(super) roll_length: &'static str,
}

pub(super) const TIP: ReliefNames = ReliefNames {
    kind: "tip_relief",
    depth: "tip_relief_depth",
    diameter: "tip_relief_datum_diameter",
    length: "tip_relief_datum_length",
    roll_length: "roll_length_from_tip_mm",
};

pub(super) const ROOT: ReliefNames = ReliefNames {
    kind: "root_relief",
    depth: "root_relief_depth",
    diameter: "root_relief_datum_diameter",
    length: "root_relief_datum_length",
    roll_length: "roll_length_from_form_mm",
};

/// A number that has no default.
fn needed(reading: &Reading<'_>, of: &Component, attribute: &str, unit: Unit) -> Option<f64> {
    let number = reading.number(of, attribute, unit);
    if number.is_none() && of.attribute(attribute).is_none() {
        let detail = format!("It has no {attribute}, which has no default.");
        reading.wrong(of.place(), detail);
    }
    number
}
