//! From a submission, and its results, to a model.

use std::fmt::Write as _;

use meshwright_engine::analysis::Case;
use meshwright_engine::gear::{Member, SpurGear};
use serde_json::Value;

use super::flank::{ROOT, ReliefNames, TIP};
use super::gear::{GENERATED_SHIFT, SAME_SHIFT};
use super::import::HELIX_ANGLE;
use super::own;
use super::unit::{DEG, KG_PER_DM3, MM, MPA, MUM, N_M, N_PER_MM, NONE, PER_MINUTE, Unit, mm_of_um};
use crate::significant;

/// The version whose names are written.
const VERSION: &str = "2.0.0";

/// The digits that the standard keeps of a number.
const DIGITS: usize = 15;

/// The components of one gear, by their ids.
struct Ids {
    gear: usize,
    left: usize,
    right: usize,
    data: usize,
    tool: usize,
    settings: usize,
    /// Tool of the grinding, where it leaves the teeth of another thickness than the tool that cut the root.
    grinding: Option<usize>,
    material: usize,
    body: usize,
    /// The modifications of both flanks, which are the same.
    modifications: Vec<usize>,
    /// Lead modifications for which the standard has names.
    leads: Vec<usize>,
}

const UNIT: usize = 1;
const STAGE: usize = 2;

/// The model of a submission, whose `document` has every default filled in and asks for `case`; with its results, one load case for each
/// torque has the curves. `date` is the time of writing, by ISO 8601 with its offset.
///
/// The curves stand at the stage: `meshing_stiffness_characteristic`, the tangent stiffness at each mesh position, and each gear
/// says by `rotational_meshing_position` the angles at which it stands then.
pub fn export(document: &Value, case: &Case, results: Option<&Value>, date: &str) -> String {
    let mut components = Xml {
        indent: "    ",
        ..Xml::default()
    };
    let mut relations = Relations::default();
    components.open(UNIT, "gear_unit");
    components.close();
    components.open(STAGE, "cylindrical_stage");
    let pair = &document["pair"];
    components.number("center_distance", MM, number(pair, "center_distance_mm"));
    components.number("radial_contact_ratio", NONE, case.pair.contact_ratio());
    components.word(own::METHOD, document["method"].as_str().unwrap_or_default());
    if let Some(offset) = number_of(pair, "axial_offset_mm").filter(|offset| *offset != 0.0) {
        components.number(own::AXIAL_OFFSET, MM, offset);
    }
    if !pair["misalignment_um"].is_null() {
        components.word(own::MISALIGNMENT, &pair["misalignment_um"].to_string());
    }
    components.close();
    relations.add("assembly", None, &[("assembly", UNIT), ("part", STAGE)]);
    let mut next = STAGE + 1;
    let helix = number(pair, "helix_angle_deg");
    let ids = [("driving", Member::Driving), ("driven", Member::Driven)].map(|(member, of)| {
        let gear = Gear {
            document: &pair[member],
            section: case.pair.gear(of),
            helix_angle_deg: if member == "driving" { helix } else { -helix },
        };
        let ids = gear.ids(&mut next);
        gear.write(
            &ids,
            member == "driving",
            number_of(document, "driving_speed_rpm"),
            &mut components,
        );
        gear.relate(&ids, &mut relations);
        ids
    });
    let gears = [
        ("stage", STAGE),
        ("gear_1", ids[0].gear),
        ("gear_2", ids[1].gear),
    ];
    relations.add("stage", None, &gears);
    let load_cases = load_cases(document, results, &ids);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model version=\"{VERSION}\" applicationId=\"Meshwright\" applicationVersion=\"{}\" date=\"{}\" applicationLanguage=\"en\">\n  <relations>\n{}  </relations>\n  <components>\n{}  </components>\n  <load_spectrum id=\"1\">\n{load_cases}  </load_spectrum>\n</model>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(date),
        relations.text,
        components.text,
    )
}

/// One load case for each torque.
fn load_cases(document: &Value, results: Option<&Value>, ids: &[Ids; 2]) -> String {
    let mut text = String::new();
    let torques = document["output_torques_n_m"].as_array();
    for (i, torque) in torques
        .into_iter()
        .flatten()
        .filter_map(Value::as_f64)
        .enumerate()
    {
        let curve = results.and_then(|results| results["curves"].get(i));
        let list = |name: &str| curve.map(|curve| numbers(&curve[name]));
        let mut case = Xml {
            indent: "      ",
            ..Xml::default()
        };
        case.open(STAGE, "cylindrical_stage");
        for (attribute, unit, name, divisor) in [
            (
                "meshing_stiffness_characteristic",
                N_PER_MM,
                "mesh_stiffness_tangent_n_per_m",
                1e3,
            ),
            (own::SECANT, N_PER_MM, "mesh_stiffness_secant_n_per_m", 1e3),
            (own::TRANSMISSION_ERROR, MUM, "transmission_error_um", 1.0),
            (own::MESH_POSITION, NONE, "mesh_position", 1.0),
        ] {
            if let Some(values) = list(name) {
                case.list(
                    attribute,
                    unit,
                    values.into_iter().map(|value| value / divisor),
                );
            }
        }
        case.close();
        for (member, (ids, name)) in ids
            .iter()
            .zip(["driving_angle_deg", "driven_angle_deg"])
            .enumerate()
        {
            case.open(ids.data, "cylindrical_stage_gear_data");
            if member == 1 {
                case.number("torque", N_M, torque);
            }
            if let Some(values) = list(name) {
                case.list("rotational_meshing_position", DEG, values.into_iter());
            }
            case.close();
        }
        let _ = write!(
            text,
            "    <load_case id=\"{}\">\n{}    </load_case>\n",
            i + 1,
            case.text
        );
    }
    text
}

/// A gear as the submission has it, and derived values.
struct Gear<'a> {
    document: &'a Value,
    section: &'a SpurGear,
    /// Positive if it is right-handed.
    helix_angle_deg: f64,
}

impl Gear<'_> {
    fn ids(&self, next: &mut usize) -> Ids {
        let mut id = || {
            *next += 1;
            *next - 1
        };
        Ids {
            gear: id(),
            left: id(),
            right: id(),
            data: id(),
            tool: id(),
            settings: id(),
            grinding: self.is_ground().then(&mut id),
            material: id(),
            body: id(),
            modifications: self.modifications().iter().map(|_| id()).collect(),
            leads: self
                .leads()
                .filter(|lead| is_known(lead))
                .map(|_| id())
                .collect(),
        }
    }

    fn number(&self, name: &str) -> f64 {
        number(self.document, name)
    }

    /// The generating profile shift of the tool that cut the root.
    fn generated_shift(&self) -> f64 {
        to_mm(self.section.generating_shift_length()) / self.number("module_mm")
    }

    /// True if the flanks are ground to another thickness than that tool leaves.
    fn is_ground(&self) -> bool {
        (self.finished_shift() - self.generated_shift()).abs() > SAME_SHIFT
    }

    /// The profile shift with which the teeth come out as thick as they are.
    fn finished_shift(&self) -> f64 {
        let angle = self.number("pressure_angle_deg").to_radians();
        let thicker = to_mm(self.section.data().thickness_deviation);
        let normal = thicker * self.helix_angle_deg.to_radians().cos();
        self.number("profile_shift") + normal / (2.0 * self.number("module_mm") * angle.tan())
    }

    fn write(&self, ids: &Ids, drives: bool, speed: Option<f64>, out: &mut Xml) {
        let (module, section) = (self.number("module_mm"), self.section);
        let shift = self.number("profile_shift");
        let blank = &self.document["blank"];
        out.open(ids.gear, "cylindrical_gear");
        out.number("number_of_teeth", NONE, self.number("tooth_count"));
        out.number("normal_module", MM, module);
        out.number(HELIX_ANGLE, DEG, self.helix_angle_deg);
        out.number("face_width", MM, self.number("face_width_mm"));
        let tip = number_of(self.document, "tip_diameter_mm");
        out.number(
            "tip_diameter",
            MM,
            tip.unwrap_or(2.0 * to_mm(section.tip_radius())),
        );
        out.number("root_diameter", MM, 2.0 * to_mm(section.root_radius()));
        out.number("base_diameter", MM, 2.0 * to_mm(section.base_radius()));
        out.number("inner_diameter", MM, 2.0 * number(blank, "bore_radius_mm"));
        if let Some(speed) = speed.filter(|_| drives) {
            out.number("rotational_speed", PER_MINUTE, speed);
        }
        if let Some(rounding) = number_of(self.document, "tip_rounding_mm") {
            out.number(own::TIP_ROUNDING, MM, rounding);
        }
        let openings = own::OPENINGS.map(|(field, attribute)| (attribute, &blank[field]));
        for (attribute, value) in openings.into_iter().chain([
            (own::SHAFT, &blank["shaft"]),
            (own::PROTUBERANCE, &self.document["protuberance"]),
            (own::DEVIATIONS, &self.document["tooth_deviations"]),
        ]) {
            if !value.is_null() {
                out.word(attribute, &value.to_string());
            }
        }
        out.close();
        for flank in [ids.left, ids.right] {
            out.open(flank, "cylindrical_gear_flank");
            out.number(
                "normal_pressure_angle",
                DEG,
                self.number("pressure_angle_deg"),
            );
            out.number("addendum_modification_coefficient", NONE, shift);
            if let Some(addendum) = number_of(self.document, "addendum_mm") {
                out.number(
                    "addendum_coefficient_basic_profile",
                    NONE,
                    addendum / module,
                );
            }
            let chamfer = number_of(self.document, "tip_chamfer_mm");
            out.number("tooth_tip_chamfer", MM, chamfer.unwrap_or(0.0));
            let tables = self.tables();
            if !tables.is_empty() {
                out.word(own::TABLES, &Value::Array(tables).to_string());
            }
            let leads: Vec<Value> = self
                .leads()
                .filter(|lead| !is_known(lead))
                .cloned()
                .collect();
            if !leads.is_empty() {
                out.word(own::LEADS, &Value::Array(leads).to_string());
            }
            out.close();
        }
        out.open(ids.data, "cylindrical_stage_gear_data");
        out.word("is_driving_gear", if drives { "true" } else { "false" });
        out.close();
        out.open(ids.tool, "rack_shaped_tool");
        out.number("normal_module", MM, module);
        out.number(
            "normal_pressure_angle",
            DEG,
            self.number("pressure_angle_deg"),
        );
        let reach = to_mm(section.data().rack.dedendum) / module;
        out.number("addendum_coefficient_reference_profile", NONE, reach);
        let rounding = self.number("rack_tip_radius_mm") / module;
        out.number("tip_corner_radius_factor_reference_profile", NONE, rounding);
        out.close();
        out.open(ids.settings, "cylindrical_gear_manufacturing_settings");
        out.number(GENERATED_SHIFT, NONE, self.generated_shift());
        out.close();
        if let Some(grinding) = ids.grinding {
            out.open(grinding, "cylindrical_gear_manufacturing_settings");
            out.number(GENERATED_SHIFT, NONE, self.finished_shift());
            out.close();
        }
        let material = &self.document["material"];
        out.open(ids.material, "material");
        out.number(
            "elastic_modulus",
            MPA,
            number(material, "youngs_modulus_gpa") * 1e3,
        );
        out.number("poisson_ratio", NONE, number(material, "poisson_ratio"));
        out.number(
            "density",
            KG_PER_DM3,
            number(material, "density_kg_m3") / 1e3,
        );
        out.close();
        out.open(ids.body, "gear_body");
        out.number("inner_diameter", MM, 2.0 * number(blank, "bore_radius_mm"));
        out.number("outer_diameter", MM, 2.0 * to_mm(section.root_radius()));
        if let Some(outer) = number_of(&blank["web"], "outer_radius_mm") {
            out.number(
                "gear_body_rim_thickness",
                MM,
                to_mm(section.root_radius()) - outer,
            );
            out.number(
                "gear_body_web_thickness",
                MM,
                number(&blank["web"], "thickness_mm"),
            );
            out.number(
                own::WEB_INNER_RADIUS,
                MM,
                number(&blank["web"], "inner_radius_mm"),
            );
            let offset = number_of(&blank["web"], "offset_mm");
            if let Some(offset) = offset.filter(|offset| *offset != 0.0) {
                out.number(own::WEB_OFFSET, MM, offset);
            }
        }
        if !blank["hub"].is_null() {
            out.word(own::HUB, &blank["hub"].to_string());
        }
        out.close();
        for (id, modification) in ids.modifications.iter().zip(self.modifications()) {
            self.write_modification(*id, modification, out);
        }
        let leads = self.leads().filter(|lead| is_known(lead));
        for (id, lead) in ids.leads.iter().zip(leads) {
            let amount = mm_of_um(number(lead, "amount_um"));
            if kind(lead) == "slope" {
                out.open(*id, "helix_slope");
                out.number("helix_slope", MM, amount);
            } else {
                out.open(*id, "helix_crowning");
                out.number("helix_crowning_amount_datum_face", MM, amount);
                out.number("helix_crowning_amount_non_datum_face", MM, amount);
            }
            out.close();
        }
    }

    /// Modifications of the leads.
    fn leads(&self) -> impl Iterator<Item = &Value> {
        let listed = self.document["lead_modifications"].as_array();
        listed.into_iter().flatten()
    }

    /// Modifications of the flanks for which the standard has names, in the order of the submission.
    fn modifications(&self) -> Vec<&Value> {
        let listed = self.document["profile_modifications"].as_array();
        std::iter::once(&self.document["tip_relief"])
            .chain(listed.into_iter().flatten())
            .filter(|modification| !modification.is_null() && kind(modification) != "table")
            // A modification without an amount may begin anywhere, even beside the flank.
            .filter(|modification| number(modification, "amount_um") != 0.0)
            .collect()
    }

    fn tables(&self) -> Vec<Value> {
        let listed = self.document["profile_modifications"].as_array();
        let tables = listed
            .into_iter()
            .flatten()
            .filter(|each| kind(each) == "table");
        tables.cloned().collect()
    }

    fn write_modification(&self, id: usize, modification: &Value, out: &mut Xml) {
        let amount = mm_of_um(number(modification, "amount_um"));
        out.open(id, component_of(kind(modification)));
        match kind(modification) {
            "crowning" => {
                out.number("profile_crowning_at_tip", MM, amount);
                out.number("profile_crowning_at_root", MM, amount);
                out.word("shape_of_profile_crowning", "parabolic");
            }
            "slope" => out.number("profile_slope", MM, amount),
            "root_relief" => self.write_relief(&ROOT, amount, modification, out),
            _ => self.write_relief(&TIP, amount, modification, out),
        }
        out.close();
    }

    fn write_relief(&self, names: &ReliefNames, amount: f64, relief: &Value, out: &mut Xml) {
        let (start, section) = (&relief["start"], self.section);
        out.number(names.depth, MM, amount);
        out.word(
            "shape_of_relief",
            relief["shape"].as_str().unwrap_or("linear"),
        );
        if let Some(length) = number_of(start, names.roll_length) {
            out.number(names.length, MM, length);
            return;
        }
        let from_radial = |length: f64| {
            let radius = match names.kind {
                "tip_relief" => to_mm(section.tip_radius()) - length,
                _ => to_mm(section.form_radius()) + length,
            };
            2.0 * radius
        };
        let from_angle =
            |angle: f64| 2.0 * to_mm(section.base_radius()) * angle.to_radians().hypot(1.0);
        let diameter = number_of(start, "diameter_mm")
            .or_else(|| number_of(start, "radial_length_mm").map(from_radial))
            .or_else(|| number_of(start, "roll_angle_deg").map(from_angle));
        if let Some(diameter) = diameter {
            out.number(names.diameter, MM, diameter);
        }
    }

    fn relate(&self, ids: &Ids, out: &mut Relations) {
        let gear = ids.gear;
        out.add(
            "stage_gear_data",
            None,
            &[
                ("stage", STAGE),
                ("gear", gear),
                ("stage_gear_data", ids.data),
            ],
        );
        out.add(
            "flank",
            None,
            &[("gear", gear), ("left", ids.left), ("right", ids.right)],
        );
        out.add("assembly", None, &[("assembly", gear), ("part", ids.body)]);
        out.add(
            "reference",
            None,
            &[("origin", gear), ("referenced", ids.material)],
        );
        out.add(
            "reference",
            None,
            &[("origin", ids.body), ("referenced", ids.material)],
        );
        for flank in [ids.left, ids.right] {
            let step = [
                ("workpiece", flank),
                ("tool", ids.tool),
                ("manufacturing_settings", ids.settings),
            ];
            out.add("manufacturing_step", Some(1), &step);
            if let Some(grinding) = ids.grinding {
                let step = [("workpiece", flank), ("manufacturing_settings", grinding)];
                out.add("manufacturing_step", Some(2), &step);
            }
            for modification in ids.modifications.iter().chain(&ids.leads) {
                out.add(
                    "reference",
                    None,
                    &[("origin", flank), ("referenced", *modification)],
                );
            }
        }
    }
}

/// The kind of a modification; the short form of a tip relief has no word for it.
fn kind(modification: &Value) -> &str {
    modification["kind"].as_str().unwrap_or(TIP.kind)
}

/// True if the standard has a name for a modification of a lead.
fn is_known(lead: &Value) -> bool {
    ["crowning", "slope"].contains(&kind(lead))
}

fn component_of(kind: &str) -> &'static str {
    match kind {
        "crowning" => "profile_crowning",
        "slope" => "profile_slope",
        "root_relief" => ROOT.kind,
        _ => TIP.kind,
    }
}

fn number_of(document: &Value, name: &str) -> Option<f64> {
    document[name].as_f64()
}

fn to_mm(meters: f64) -> f64 {
    meters * 1e3
}

/// A number that every submission with its defaults has.
fn number(document: &Value, name: &str) -> f64 {
    number_of(document, name).unwrap_or_default()
}

fn numbers(list: &Value) -> Vec<f64> {
    let items = list.as_array().into_iter().flatten();
    items.filter_map(Value::as_f64).collect()
}

/// Components as text.
#[derive(Default)]
struct Xml {
    indent: &'static str,
    text: String,
}

impl Xml {
    fn open(&mut self, id: usize, kind: &str) {
        let _ = writeln!(
            self.text,
            "{}<component id=\"{id}\" type=\"{kind}\">",
            self.indent
        );
    }

    fn close(&mut self) {
        let _ = writeln!(self.text, "{}</component>", self.indent);
    }

    fn number(&mut self, id: &str, unit: Unit, value: f64) {
        self.attribute(id, unit, &written(value));
    }

    fn word(&mut self, id: &str, word: &str) {
        self.attribute(id, NONE, &escaped(word));
    }

    fn attribute(&mut self, id: &str, unit: Unit, content: &str) {
        let _ = writeln!(
            self.text,
            "{}  <attribute id=\"{id}\" unit=\"{}\">{content}</attribute>",
            self.indent, unit.name
        );
    }

    fn list(&mut self, id: &str, unit: Unit, values: impl Iterator<Item = f64>) {
        let cells: String = values
            .map(|value| format!("<c>{}</c>", written(value)))
            .collect();
        self.attribute(id, unit, &format!("<array>{cells}</array>"));
    }
}

/// Relations as text, numbered.
#[derive(Default)]
struct Relations {
    text: String,
    count: usize,
}

impl Relations {
    fn add(&mut self, kind: &str, order: Option<usize>, refs: &[(&str, usize)]) {
        self.count += 1;
        let order = order.map_or_else(String::new, |order| format!(" order=\"{order}\""));
        let _ = writeln!(
            self.text,
            "    <relation id=\"{}\" type=\"{kind}\"{order}>",
            self.count
        );
        for (role, id) in refs {
            let _ = writeln!(self.text, "      <ref id=\"{id}\" role=\"{role}\"/>");
        }
        self.text.push_str("    </relation>\n");
    }
}

fn written(value: f64) -> String {
    significant(value, DIGITS).to_string()
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
