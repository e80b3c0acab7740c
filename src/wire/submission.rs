//! A submission: what is asked, checked once, with every default filled in.

use meshwright_engine::analysis::spectrum::RotationSpeed;
use meshwright_engine::analysis::{Case, Method};
use meshwright_engine::gear::{GearPair, Member, SpurGear};
use serde::Serialize;
use sha2::{Digest, Sha256};
use utoipa::openapi::schema::{ObjectBuilder, Type};

use super::pair::PairDocument;
use super::problem::{Code, FieldError, Problem};
use super::quantity::{self, MOST_POSITIONS, MOST_TAGS, MOST_TORQUES};
use super::resolution::ResolutionDocument;
use super::schema::{self, Property, documented};
use super::tree::{Choice, Errors, Node, ObjectReader, as_word};
use super::units::{Side, plain, rounded_inward, to_mm};

/// The version of the solver, which a result belongs to.
pub const SOLVER_VERSION: &str = concat!("meshwright ", env!("CARGO_PKG_VERSION"));

/// The document of a submission, in the reader's units, with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Document {
    #[serde(serialize_with = "as_word")]
    method: Method,
    pair: PairDocument,
    output_torques_n_m: Vec<f64>,
    driving_speed_rpm: Option<f64>,
    resolution: ResolutionDocument,
    tags: Vec<String>,
}

/// What is asked: a gear pair, torques, and how to compute.
///
/// A value of this type can be computed: its gears can be made and mesh, and the work is within the limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Submission {
    document: Document,
    case: Case,
}

impl Serialize for Submission {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.document.serialize(serializer)
    }
}

documented!(
    Submission,
    "Submission",
    [PairDocument, ResolutionDocument],
    schema::object(
        "Submission",
        "What is asked: a gear pair, torques, and how to compute. Unknown fields are refused.",
        Submission::properties()
    )
);

/// What a submission is for, which decides how large it may be.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose {
    /// A job, which is queued.
    Job,
    /// A preview, for which a request waits.
    Preview {
        /// The most positions times torques.
        most_positions: u64,
    },
}

impl Submission {
    /// What the schema says of its fields.
    pub(super) fn properties() -> Vec<Property> {
        vec![
            schema::choice::<Method>("method", "Method", "How the curves are computed.", None),
            schema::document::<PairDocument>("pair", true),
            (
                quantity::OUTPUT_TORQUE.name,
                schema::list(
                    "Output torques",
                    "The torques on the driven gear, each of which gives a curve. Unit: N m.",
                    schema::number_schema(&quantity::OUTPUT_TORQUE),
                    (1, MOST_TORQUES),
                )
                .unique_items(true)
                .into(),
                true,
            ),
            schema::number(&quantity::DRIVING_SPEED),
            schema::document::<ResolutionDocument>("resolution", false),
            (
                "tags",
                schema::list(
                    "Tags",
                    "Short strings to find the job by. They do not change the result.",
                    ObjectBuilder::new()
                        .schema_type(Type::String)
                        .title(Some("Tag"))
                        .min_length(Some(1))
                        .max_length(Some(MOST_TAGS.1))
                        .into(),
                    (0, MOST_TAGS.0),
                )
                .default(Some(serde_json::json!([])))
                .into(),
                false,
            ),
        ]
    }

    /// Reads and checks a submission.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400) where the text is not JSON; else 422 with every field that is wrong, its
    /// JSON pointer, and the nearest value that would do.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        let node = Node::parse(document)?;
        let errors = Errors::default();
        let read = ObjectReader::new(&node, String::new(), &errors)
            .and_then(|reader| Self::read(reader, Purpose::Job, &errors));
        match read {
            Some(submission) if errors.count() == 0 => Ok(submission),
            _ => Err(errors.into_problem()),
        }
    }

    /// The fields of a submission that are unknown or of the wrong type. What is missing, out of bounds or does not go
    /// together is not looked for.
    pub(super) fn misread_fields(document: &[u8]) -> Vec<FieldError> {
        let errors = Errors::default();
        match Node::parse(document) {
            Ok(node) => {
                if let Some(reader) = ObjectReader::new(&node, String::new(), &errors) {
                    Document::read(reader);
                }
            }
            Err(problem) => return problem.errors,
        }
        let mut errors = errors.into_problem().errors;
        errors.retain(|error| matches!(error.code, Code::UnknownField | Code::WrongType));
        errors
    }

    /// Reads what is left of `reader`, and checks it.
    pub(super) fn read(
        reader: ObjectReader<'_>,
        purpose: Purpose,
        errors: &Errors,
    ) -> Option<Self> {
        let mut document = Document::read(reader)?;
        if errors.count() > 0 {
            return None;
        }
        let pair = document.pair.to_pair(errors)?;
        document.check_torques(&pair, errors);
        document.check_interface(&pair, errors);
        document.check_span(&pair, errors);
        document
            .resolution
            .span_mesh_periods
            .get_or_insert(pair.period());
        document.check_size(purpose, errors);
        let case = Case {
            pair,
            method: document.method,
            output_torques: document.output_torques_n_m.clone(),
            resolution: document.resolution.data(),
            driving_speed: document
                .driving_speed_rpm
                .map(|speed| RotationSpeed(speed / 60.0)),
        };
        Some(Self { document, case })
    }

    /// What the engine is asked.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// The document with every default filled in.
    pub fn canonical_json(&self) -> String {
        serde_json::to_string(&self.document).expect("a submission is words and finite numbers")
    }

    /// SHA-256, in hexadecimal, of what decides the result: the canonical document without its tags, and the solver's
    /// version.
    pub fn input_hash(&self) -> String {
        let untagged = Document {
            tags: Vec::new(),
            ..self.document.clone()
        };
        let text =
            serde_json::to_string(&untagged).expect("a submission is words and finite numbers");
        let mut hasher = Sha256::new();
        hasher.update(SOLVER_VERSION.as_bytes());
        hasher.update([0]);
        hasher.update(text.as_bytes());
        hasher
            .finalize()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// Positions times torques.
    pub fn positions_total(&self) -> u64 {
        self.case.positions() as u64 * self.case.output_torques.len() as u64
    }

    /// The method's word.
    pub fn method(&self) -> &'static str {
        self.case.method.word()
    }

    /// The tags.
    pub fn tags(&self) -> &[String] {
        &self.document.tags
    }

    /// How it is computed, with every default filled in.
    pub(super) fn resolution(&self) -> &ResolutionDocument {
        &self.document.resolution
    }
}

impl Document {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let method = reader.choice::<Method>("method", None);
        let pair = reader.needed_object("pair").and_then(PairDocument::read);
        let output_torques_n_m = Self::read_torques(&mut reader);
        let driving_speed_rpm = reader.optional_number(&quantity::DRIVING_SPEED);
        let resolution = ResolutionDocument::read(reader.optional_object("resolution"));
        let tags = Self::read_tags(&mut reader);
        reader.finish();
        Some(Self {
            method: method?,
            pair: pair?,
            output_torques_n_m: output_torques_n_m?,
            driving_speed_rpm: driving_speed_rpm?,
            resolution: resolution?,
            tags: tags?,
        })
    }

    fn read_torques(reader: &mut ObjectReader<'_>) -> Option<Vec<f64>> {
        let name = quantity::OUTPUT_TORQUE.name;
        let node = reader.needed(name)?;
        let pointer = reader.pointer_to(name);
        let Node::List(items) = node else {
            reader.wrong_kind(name, node, "a list of torques in N m");
            return None;
        };
        if items.is_empty() {
            reader.report(FieldError::new(
                &*pointer,
                Code::OutOfRange,
                format!("{pointer} is empty; give a torque."),
            ));
            return None;
        }
        if items.len() > MOST_TORQUES {
            let detail = format!(
                "{pointer} has {} torques; at most {MOST_TORQUES} fit in one submission.",
                items.len()
            );
            reader.report(
                FieldError::new(&*pointer, Code::TooLarge, detail).nearest(MOST_TORQUES as f64),
            );
            return None;
        }
        let torques: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| {
                reader.checked_number(item, &format!("{pointer}/{i}"), &quantity::OUTPUT_TORQUE)
            })
            .collect();
        for (i, torque) in torques.iter().enumerate() {
            if torque.is_some() && torques[..i].contains(torque) {
                let pointer = format!("{pointer}/{i}");
                let detail = format!("{pointer} repeats a torque; each gives one curve.");
                reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
            }
        }
        torques.into_iter().collect()
    }

    fn read_tags(reader: &mut ObjectReader<'_>) -> Option<Vec<String>> {
        let (most, longest) = MOST_TAGS;
        let Some(node) = reader.get("tags") else {
            return Some(Vec::new());
        };
        let Node::List(items) = node else {
            reader.wrong_kind("tags", node, "a list of short strings");
            return None;
        };
        let pointer = reader.pointer_to("tags");
        if items.len() > most {
            let detail = format!(
                "{pointer} has {} tags; at most {most} are kept.",
                items.len()
            );
            reader.report(FieldError::new(pointer, Code::OutOfRange, detail).nearest(most as f64));
            return None;
        }
        let tags = items.iter().enumerate().map(|(i, item)| {
            let pointer = format!("{pointer}/{i}");
            match item {
                Node::Text(tag)
                    if (1..=longest).contains(&tag.chars().count()) && !tag.chars().any(char::is_control) =>
                {
                    Some(tag.clone())
                }
                Node::Text(_) => {
                    let detail = format!("{pointer} has to have 1 to {longest} characters, none of them a control character.");
                    reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
                    None
                }
                _ => {
                    let detail = format!("{pointer} is not a string.");
                    reader.report(FieldError::new(pointer, Code::WrongType, detail));
                    None
                }
            }
        });
        tags.collect::<Vec<_>>().into_iter().collect()
    }

    /// Refuses torques that would deflect the teeth by more than about a quarter of a module: small displacements and a
    /// search among neighboring flanks mean nothing there.
    fn check_torques(&self, pair: &GearPair, errors: &Errors) {
        const LARGEST_DEFLECTION: f64 = 0.25;
        // The usual mesh stiffness of steel gears, 14 N/(mm um), in proportion to Young's modulus.
        const USUAL_STIFFNESS: f64 = 14e9 / 210e9;
        let modulus = |gear: &SpurGear| gear.material().youngs_modulus;
        let softer = modulus(pair.driving()).min(modulus(pair.driven()));
        let module = pair.driving().data().rack.module;
        let largest_load =
            LARGEST_DEFLECTION * module * USUAL_STIFFNESS * softer * pair.common_face_width();
        let largest = largest_load * pair.driven().base_radius();
        for (i, &torque) in self.output_torques_n_m.iter().enumerate() {
            if torque > largest {
                let nearest = rounded_inward(largest, Side::AtMost, 0);
                let pointer = format!("/{}/{i}", quantity::OUTPUT_TORQUE.name);
                let detail = format!(
                    "{pointer} is {} N m, which would deflect these teeth by more than about a quarter of a module; at most {} N m.",
                    plain(torque),
                    plain(nearest)
                );
                errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
            }
        }
    }

    /// The interface has to stay clear of the holes and of the roots by a quarter of the material between them, or of a
    /// module where that is less.
    fn check_interface(&self, pair: &GearPair, errors: &Errors) {
        let Some(radius) = self.resolution.interface_radius_mm else {
            return;
        };
        let mut range = (0.0_f64, f64::INFINITY);
        for member in [Member::Driving, Member::Driven] {
            let gear = pair.gear(member);
            if let Some(holes) = gear.holes() {
                let (inner, outer) = (to_mm(holes.outer_reach()), to_mm(gear.root_radius()));
                let margin = 0.25 * (outer - inner).min(to_mm(gear.data().rack.module));
                range = (range.0.max(inner + margin), range.1.min(outer - margin));
            }
        }
        let (least, most) = range;
        if (least..=most).contains(&radius) {
            return;
        }
        let nearest = if least > most {
            None
        } else if radius < least {
            Some(rounded_inward(least, Side::AtLeast, 0))
        } else {
            Some(rounded_inward(most, Side::AtMost, 0))
        };
        let pointer = format!("/resolution/{}", quantity::INTERFACE_RADIUS.name);
        let said = match nearest {
            Some(_) => format!(
                "it has to lie between {} mm and {} mm, between the holes and the root circle",
                plain(least),
                plain(most)
            ),
            None => {
                "no one radius lies between holes and roots of both gears; leave it out".to_owned()
            }
        };
        let detail = format!("{pointer} is {} mm; {said}.", plain(radius));
        let nearest = nearest.filter(|nearest| (least..=most).contains(nearest));
        errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
    }

    fn check_span(&self, pair: &GearPair, errors: &Errors) {
        let (Some(span), period) = (self.resolution.span_mesh_periods, pair.period()) else {
            return;
        };
        if span > period && span % period != 0 {
            let nearest =
                (f64::from(span) / f64::from(period)).round().max(1.0) * f64::from(period);
            let pointer = format!("/resolution/{}", quantity::SPAN.name);
            let detail = format!(
                "{pointer} is {span}; the true period is {period} mesh periods, and a longer span has to be a whole multiple of it."
            );
            errors.push(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest));
        }
    }

    fn check_size(&self, purpose: Purpose, errors: &Errors) {
        let (limit, said) = match purpose {
            Purpose::Job => (MOST_POSITIONS, format!("the limit is {MOST_POSITIONS}")),
            Purpose::Preview { most_positions } => (
                most_positions,
                format!(
                    "the limit of a preview is {most_positions}, that of POST /v1/jobs {MOST_POSITIONS}"
                ),
            ),
        };
        let resolution = &self.resolution;
        let span = u64::from(resolution.span_mesh_periods.unwrap_or(1));
        let (positions, torques) = (
            u64::from(resolution.positions_per_mesh_period),
            self.output_torques_n_m.len() as u64,
        );
        let total = span * positions * torques;
        if total <= limit {
            return;
        }
        let fitting_positions = limit / (span * torques);
        let fitting_torques = limit / (span * positions);
        let fitting_span = limit / (positions * torques);
        let mut ways = Vec::new();
        let least_positions = quantity::POSITIONS.bounds.0 as u64;
        if fitting_positions >= least_positions {
            ways.push(format!("{fitting_positions} positions in a mesh period"));
        }
        if fitting_torques >= 1 {
            ways.push(format!("{fitting_torques} torques"));
        }
        if fitting_span >= 1 {
            ways.push(format!("a span of {fitting_span} mesh periods"));
        }
        if ways.is_empty() {
            ways.push("less of more than one of them".to_owned());
        }
        let (name, nearest) = if fitting_positions >= least_positions {
            (quantity::POSITIONS.name, Some(fitting_positions as f64))
        } else {
            let nearest = (fitting_span >= 1).then_some(fitting_span as f64);
            (quantity::SPAN.name, nearest)
        };
        let detail = format!(
            "{span} mesh periods of {positions} positions at {torques} torques are {total} positions; {said}. What would fit: {}.",
            ways.join(", or ")
        );
        let pointer = format!("/resolution/{name}");
        errors.push(FieldError::new(pointer, Code::TooLarge, detail).nearest(nearest));
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::wire::examples;

    /// Every needed field and nothing else.
    fn least() -> Value {
        json!({
            "method": "flexible",
            "pair": {
                "center_distance_mm": 100.5,
                "driving": { "tooth_count": 50, "module_mm": 2, "face_width_mm": 20, "blank": { "bore_radius_mm": 15 } },
                "driven": { "tooth_count": 50, "module_mm": 2, "face_width_mm": 20, "blank": { "bore_radius_mm": 15 } }
            },
            "output_torques_n_m": [115]
        })
    }

    fn case_2() -> Value {
        let example = examples()
            .iter()
            .find(|example| example.name == "test-case-2")
            .expect("ships");
        serde_json::from_str(example.json).expect("JSON")
    }

    fn parse(document: &Value) -> Result<Submission, Problem> {
        Submission::parse(document.to_string().as_bytes())
    }

    /// Puts `value` where `pointer` says, in objects that are there.
    fn put(document: &mut Value, pointer: &str, value: Value) {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        match document.pointer_mut(parent) {
            Some(Value::Object(fields)) => {
                fields.insert(key.to_owned(), value);
            }
            Some(Value::Array(items)) => {
                if let Some(item) = key.parse::<usize>().ok().and_then(|i| items.get_mut(i)) {
                    *item = value;
                }
            }
            _ => panic!("{pointer} has no parent"),
        }
    }

    #[test]
    fn the_least_submission_is_echoed_with_every_default() {
        let submission = parse(&least()).expect("valid");
        let echo: Value = serde_json::from_str(&submission.canonical_json()).expect("JSON");
        // The defaults are API.md's: ISO 53 rack, steel, 40 positions; the standard pair repeats every mesh period.
        for gear in ["driving", "driven"] {
            assert_eq!(
                echo["pair"][gear],
                json!({
                    "tooth_count": 50, "module_mm": 2.0, "pressure_angle_deg": 20.0, "profile_shift": 0.0,
                    "addendum_mm": 2.0, "dedendum_mm": 2.5, "rack_tip_radius_mm": 0.76, "face_width_mm": 20.0,
                    "tip_relief": null,
                    "material": { "youngs_modulus_gpa": 210.0, "poisson_ratio": 0.3, "density_kg_m3": 7850.0 },
                    "blank": { "bore_radius_mm": 15.0, "holes": null }
                })
            );
        }
        assert_eq!(
            echo["resolution"],
            json!({
                "positions_per_mesh_period": 40, "span_mesh_periods": 1, "grid": "standard", "blank_positions": 16,
                "interface_radius_mm": null, "contact_solver": "active_set", "stiffness": "tangent",
                "load_distribution": { "tooth": "weber_banaschek", "body": "sainsot", "plane_state": "stress" },
                "error_estimate": false
            })
        );
        assert_eq!(
            (&echo["tags"], &echo["driving_speed_rpm"]),
            (&json!([]), &Value::Null)
        );
    }

    #[test]
    fn an_echo_is_its_own_echo() {
        for example in examples().iter().filter(|example| example.valid) {
            let submission = Submission::parse(example.json.as_bytes()).expect("valid");
            let again = Submission::parse(submission.canonical_json().as_bytes())
                .expect("an echo is valid");
            assert_eq!(again, submission, "{}", example.name);
            assert_eq!(again.input_hash(), submission.input_hash());
        }
    }

    #[test]
    fn the_hash_knows_what_decides_the_result_and_no_tags() {
        let hash = |pointer: &str, value: Value| {
            let mut document = least();
            put(&mut document, pointer, value);
            parse(&document).expect("valid").input_hash()
        };
        let plain = parse(&least()).expect("valid").input_hash();
        assert_eq!(plain.len(), 64);
        assert_eq!(hash("/tags", json!(["tuesday"])), plain);
        assert_eq!(
            hash("/resolution", json!({ "span_mesh_periods": 1 })),
            plain,
            "the default, said"
        );
        assert_ne!(hash("/output_torques_n_m", json!([116])), plain);
        assert_ne!(hash("/resolution", json!({ "grid": "fine" })), plain);
    }

    #[test]
    fn the_choices_of_the_resolution_reach_the_engine() {
        use meshwright_engine::analysis::{
            BodyFormula, ContactSolver, PlaneState, StiffnessRule, ToothFormula,
        };
        let mut document = least();
        document["method"] = json!("load_distribution");
        document["driving_speed_rpm"] = json!(600);
        document["resolution"] = json!({
            "contact_solver": { "augmented_lagrangian": { "penalty_n_per_m": 1e10, "gap_tolerance_um": 0.01 } },
            "stiffness": { "torque_step_percent": 1.0 },
            "load_distribution": { "tooth": "iso_6336", "body": "half_plane", "plane_state": "strain" },
            "span_mesh_periods": 3
        });
        let submission = parse(&document).expect("valid");
        let case = submission.case();
        let ContactSolver::AugmentedLagrangian {
            penalty,
            gap_tolerance,
        } = case.resolution.contact_solver
        else {
            panic!("the solver")
        };
        assert_eq!((penalty, gap_tolerance), (1e10, 1e-8));
        assert_eq!(
            case.resolution.stiffness,
            StiffnessRule::TorqueStep { fraction: 0.01 }
        );
        let formulas = case.resolution.formulas;
        assert_eq!(
            (formulas.tooth, formulas.body, formulas.plane_state),
            (
                ToothFormula::Iso6336,
                BodyFormula::HalfPlane,
                PlaneState::Strain
            )
        );
        assert_eq!(
            (case.driving_speed, case.span()),
            (Some(RotationSpeed(10.0)), 3)
        );
        let echo: Value = serde_json::from_str(&submission.canonical_json()).expect("JSON");
        for choice in ["contact_solver", "stiffness", "load_distribution"] {
            assert_eq!(echo["resolution"][choice], document["resolution"][choice]);
        }
    }

    #[test]
    fn every_kind_of_bad_value_is_refused_with_its_place_and_a_value_that_works() {
        let long = "x".repeat(65);
        // Place and value that are sent, place and code that are told, and whether a nearest value is.
        let bad: &[(&str, Value, &str, Code, bool)] = &[
            ("/method", json!("fast"), "/method", Code::WrongType, false),
            (
                "/pair/driving/tooth_count",
                json!(-3),
                "/pair/driving/tooth_count",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driving/tooth_count",
                json!(50.5),
                "/pair/driving/tooth_count",
                Code::WrongType,
                true,
            ),
            (
                "/pair/driving/tooth_count",
                json!("50"),
                "/pair/driving/tooth_count",
                Code::WrongType,
                false,
            ),
            (
                "/pair/driving/tooth_count",
                json!(null),
                "/pair/driving/tooth_count",
                Code::WrongType,
                false,
            ),
            (
                "/pair/driving/face_width_mm",
                json!(1e308),
                "/pair/driving/face_width_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driving/face_width_mm",
                json!(-1e-308),
                "/pair/driving/face_width_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driving/tip_releif",
                json!({}),
                "/pair/driving/tip_releif",
                Code::UnknownField,
                false,
            ),
            (
                "/pair/driving/blank",
                json!([]),
                "/pair/driving/blank",
                Code::WrongType,
                false,
            ),
            (
                "/pair/driving/blank",
                json!({}),
                "/pair/driving/blank/bore_radius_mm",
                Code::MissingField,
                false,
            ),
            (
                "/pair/driving/rack_tip_radius_mm",
                json!(2.0),
                "/pair/driving/rack_tip_radius_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driving/addendum_mm",
                json!(3.9),
                "/pair/driving/addendum_mm",
                Code::PointedTip,
                true,
            ),
            (
                "/pair/driving/addendum_mm",
                json!(0.2),
                "/pair/driving/addendum_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driving/module_mm",
                json!(2.5),
                "/pair/driven/module_mm",
                Code::ModuleMismatch,
                true,
            ),
            (
                "/pair/driven/pressure_angle_deg",
                json!(25),
                "/pair/driven/pressure_angle_deg",
                Code::PressureAngleMismatch,
                true,
            ),
            (
                "/pair/center_distance_mm",
                json!(99.5),
                "/pair/center_distance_mm",
                Code::NegativeBacklash,
                true,
            ),
            (
                "/pair/center_distance_mm",
                json!(60.0),
                "/pair/center_distance_mm",
                Code::NegativeBacklash,
                true,
            ),
            (
                "/pair/center_distance_mm",
                json!(103.0),
                "/pair/center_distance_mm",
                Code::ContactRatioBelowOne,
                true,
            ),
            (
                "/pair/center_distance_mm",
                json!(104.1),
                "/pair/center_distance_mm",
                Code::TeethDoNotReach,
                true,
            ),
            (
                "/pair/driven/blank/bore_radius_mm",
                json!(46.0),
                "/pair/driven/blank/bore_radius_mm",
                Code::BoreTooLarge,
                true,
            ),
            (
                "/pair/driven/blank/bore_radius_mm",
                json!(1.0),
                "/pair/driven/blank/bore_radius_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/pair/driven/blank/holes/count",
                json!(15),
                "/pair/driven/blank/holes/radius_mm",
                Code::HolesOverlap,
                true,
            ),
            (
                "/pair/driven/blank/holes/circle_radius_mm",
                json!(42),
                "/pair/driven/blank/holes/radius_mm",
                Code::HolesBreachRim,
                true,
            ),
            (
                "/pair/driven/blank/holes/circle_radius_mm",
                json!(47.4),
                "/pair/driven/blank/holes/circle_radius_mm",
                Code::HolesBreachRim,
                true,
            ),
            (
                "/pair/driven/blank/holes/radius_mm",
                json!(12),
                "/pair/driven/blank/holes/radius_mm",
                Code::HolesOverlap,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "radial_length_mm": 4.0 }),
                "/pair/driven/tip_relief/start/radial_length_mm",
                Code::ReliefTooLong,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "roll_length_from_tip_mm": 60.0 }),
                "/pair/driven/tip_relief/start/roll_length_from_tip_mm",
                Code::ReliefTooLong,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "diameter_mm": 104.0 }),
                "/pair/driven/tip_relief/start/diameter_mm",
                Code::ReliefTooLong,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "diameter_mm": 96.0 }),
                "/pair/driven/tip_relief/start/diameter_mm",
                Code::ReliefTooLong,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "roll_angle_deg": 1.0 }),
                "/pair/driven/tip_relief/start/roll_angle_deg",
                Code::ReliefTooLong,
                true,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({}),
                "/pair/driven/tip_relief/start",
                Code::MissingField,
                false,
            ),
            (
                "/pair/driven/tip_relief/start",
                json!({ "diameter_mm": 100.0, "roll_angle_deg": 20 }),
                "/pair/driven/tip_relief/start",
                Code::OutOfRange,
                false,
            ),
            (
                "/pair/driven/tip_relief/length_mm",
                json!(1.75),
                "/pair/driven/tip_relief/length_mm",
                Code::UnknownField,
                false,
            ),
            (
                "/output_torques_n_m/0",
                json!(0),
                "/output_torques_n_m/0",
                Code::TorqueNotPositive,
                true,
            ),
            (
                "/output_torques_n_m/0",
                json!(-115),
                "/output_torques_n_m/0",
                Code::TorqueNotPositive,
                true,
            ),
            (
                "/output_torques_n_m/0",
                json!(1e6),
                "/output_torques_n_m/0",
                Code::OutOfRange,
                true,
            ),
            (
                "/output_torques_n_m",
                json!([]),
                "/output_torques_n_m",
                Code::OutOfRange,
                false,
            ),
            (
                "/output_torques_n_m",
                json!([20, 20.0]),
                "/output_torques_n_m/1",
                Code::OutOfRange,
                false,
            ),
            (
                "/output_torques_n_m",
                json!(vec![1.0; 61]),
                "/output_torques_n_m",
                Code::TooLarge,
                true,
            ),
            (
                "/output_torques_n_m",
                json!({}),
                "/output_torques_n_m",
                Code::WrongType,
                false,
            ),
            (
                "/resolution/positions_per_mesh_period",
                json!(7),
                "/resolution/positions_per_mesh_period",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/span_mesh_periods",
                json!(7),
                "/resolution/span_mesh_periods",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/span_mesh_periods",
                json!(5000),
                "/resolution/span_mesh_periods",
                Code::TooLarge,
                true,
            ),
            (
                "/resolution/interface_radius_mm",
                json!(41.0),
                "/resolution/interface_radius_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/interface_radius_mm",
                json!(47.4),
                "/resolution/interface_radius_mm",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/grid",
                json!("finest"),
                "/resolution/grid",
                Code::WrongType,
                false,
            ),
            (
                "/resolution/contact_solver",
                json!({ "penalty": {} }),
                "/resolution/contact_solver",
                Code::MissingField,
                false,
            ),
            (
                "/resolution/contact_solver",
                json!({ "augmented_lagrangian": { "penalty_n_per_m": 0 } }),
                "/resolution/contact_solver/augmented_lagrangian/penalty_n_per_m",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/stiffness",
                json!({ "torque_step_percent": 50 }),
                "/resolution/stiffness/torque_step_percent",
                Code::OutOfRange,
                true,
            ),
            (
                "/resolution/stiffness",
                json!("secant"),
                "/resolution/stiffness",
                Code::WrongType,
                false,
            ),
            (
                "/resolution/error_estimate",
                json!(1),
                "/resolution/error_estimate",
                Code::WrongType,
                false,
            ),
            (
                "/driving_speed_rpm",
                json!(0),
                "/driving_speed_rpm",
                Code::OutOfRange,
                true,
            ),
            ("/tags", json!([long]), "/tags/0", Code::OutOfRange, false),
            ("/tags", json!([7]), "/tags/0", Code::WrongType, false),
        ];
        for (sent_at, value, told_at, code, has_nearest) in bad {
            let mut document = case_2();
            put(&mut document, sent_at, value.clone());
            let problem = parse(&document).expect_err(sent_at);
            assert_eq!(problem.status, 422, "{sent_at} {value}");
            let error = &problem.errors[0];
            assert_eq!(
                (&*error.pointer, error.code),
                (*told_at, *code),
                "{sent_at} {value}: {problem:?}"
            );
            assert_eq!(
                error.nearest.is_some(),
                *has_nearest,
                "{sent_at} {value}: {error:?}"
            );
            assert!(
                !error.detail.contains("NaN") && !error.detail.contains("inf"),
                "{}",
                error.detail
            );
        }
    }

    #[test]
    fn the_nearest_values_together_make_a_submission() {
        let changes: &[&[(&str, Value)]] = &[
            &[
                ("/pair/driving/tooth_count", json!(12)),
                ("/pair/driving/blank/bore_radius_mm", json!(30)),
            ],
            &[
                ("/pair/driven/blank/holes/radius_mm", json!(20)),
                ("/pair/driven/addendum_mm", json!(3.9)),
            ],
            &[
                ("/pair/driven/blank/holes/circle_radius_mm", json!(12)),
                ("/output_torques_n_m/0", json!(-1)),
            ],
            &[
                ("/pair/driven/blank/holes/circle_radius_mm", json!(5000)),
                ("/pair/driven/tip_relief/amount_um", json!(-1)),
            ],
            &[
                ("/resolution/positions_per_mesh_period", json!(400)),
                ("/resolution/span_mesh_periods", json!(500)),
            ],
            &[("/pair/center_distance_mm", json!(1e9))],
        ];
        for change in changes {
            let mut document = case_2();
            for (pointer, value) in *change {
                put(&mut document, pointer, value.clone());
            }
            assert!(parse(&document).is_err());
            // What the first answer cannot know, because it needs a whole pair, comes with a later one.
            for _ in 0..4 {
                let Err(problem) = parse(&document) else {
                    break;
                };
                for error in &problem.errors {
                    let nearest = error
                        .nearest
                        .unwrap_or_else(|| panic!("{change:?}: {error:?}"));
                    put(&mut document, &error.pointer, json!(nearest));
                }
            }
            assert!(
                parse(&document).is_ok(),
                "{change:?}: {:?}",
                parse(&document)
            );
        }
    }

    #[test]
    fn the_wrong_fields_of_both_gears_are_told_together() {
        let mut document = case_2();
        for (pointer, value) in [
            ("/pair/driving/tooth_count", json!(3)),
            ("/pair/driven/face_width_mm", json!("wide")),
            ("/resolution/grids", json!("fine")),
            ("/method", json!(7)),
        ] {
            put(&mut document, pointer, value);
        }
        let problem = parse(&document).expect_err("four fields");
        let mut pointers: Vec<_> = problem.errors.iter().map(|error| &*error.pointer).collect();
        pointers.sort_unstable();
        assert_eq!(
            pointers,
            [
                "/method",
                "/pair/driven/face_width_mm",
                "/pair/driving/tooth_count",
                "/resolution/grids"
            ]
        );

        let mut document = case_2();
        put(
            &mut document,
            "/pair/driving/blank/bore_radius_mm",
            json!(50),
        );
        put(
            &mut document,
            "/pair/driven/blank/holes/radius_mm",
            json!(15),
        );
        let problem = parse(&document).expect_err("both gears");
        assert_eq!(problem.errors.len(), 2, "{problem:?}");
    }

    #[test]
    fn what_is_too_large_is_told_with_what_would_fit() {
        let mut document = case_2();
        document["output_torques_n_m"] = json!([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
        document["resolution"] = json!({ "positions_per_mesh_period": 400 });
        let problem = parse(&document).expect_err("24,000 positions");
        assert_eq!(problem.code, Code::TooLarge);
        for part in [
            "24000",
            "20000",
            "333 positions",
            "10 torques",
            "4 mesh periods",
        ] {
            assert!(problem.detail.contains(part), "{part}: {}", problem.detail);
        }
        assert_eq!(problem.errors[0].nearest, Some(333.0));
    }

    /// Follows the advice of every problem until there is none, and says whether it led to a submission; `None` where a
    /// problem has no advice.
    fn follow_advice(document: &mut Value) -> Option<bool> {
        const MOST_ROUNDS: usize = 6;
        for _ in 0..MOST_ROUNDS {
            let Err(problem) = parse(document) else {
                return Some(true);
            };
            for error in &problem.errors {
                put(document, &error.pointer, json!(error.nearest?));
            }
        }
        Some(false)
    }

    #[test]
    fn whoever_follows_the_advice_arrives_at_a_submission() {
        let mut chance = Chance(0x2545_f491_4f6c_dd1d);
        let whole: Value =
            serde_json::from_str(&parse(&case_2()).expect("valid").canonical_json()).expect("JSON");
        let mut places = Vec::new();
        pointers(&whole, String::new(), &mut places);
        places.retain(|place| whole.pointer(place).is_some_and(Value::is_number));
        let mut led = 0;
        for _ in 0..4000 {
            let mut document = whole.clone();
            for _ in 0..=chance.below(2) {
                let target = document
                    .pointer_mut(&places[chance.below(places.len())])
                    .expect("a place");
                let number = target.as_f64().expect("a number");
                let sign = if chance.below(8) == 0 { -1.0 } else { 1.0 };
                *target = json!(sign * number * 1.1_f64.powi(chance.below(60) as i32 - 30));
            }
            let sent = document.clone();
            // Two values together may leave no way out that changes only the fields at fault.
            if let Some(arrived) = follow_advice(&mut document) {
                assert!(arrived, "{sent}\n{document}\n{:?}", parse(&document));
                led += 1;
            }
        }
        assert!(led > 3000, "advice is the rule: {led} of 4000");
    }

    /// A xorshift generator: the same numbers in every run.
    struct Chance(u64);

    impl Chance {
        fn below(&mut self, end: usize) -> usize {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 % end as u64) as usize
        }
    }

    fn pointers(value: &Value, here: String, all: &mut Vec<String>) {
        match value {
            Value::Object(fields) => {
                for (key, value) in fields {
                    let pointer = format!("{here}/{key}");
                    all.push(pointer.clone());
                    pointers(value, pointer, all);
                }
            }
            Value::Array(items) => {
                for (i, value) in items.iter().enumerate() {
                    let pointer = format!("{here}/{i}");
                    all.push(pointer.clone());
                    pointers(value, pointer, all);
                }
            }
            _ => {}
        }
    }

    #[test]
    fn no_change_of_a_document_gets_past_a_problem_or_a_submission() {
        let odd = [
            json!(null),
            json!(true),
            json!(""),
            json!([]),
            json!({}),
            json!([[[]]]),
            json!(0),
            json!(-1),
            json!(1),
            json!(1e308),
            json!(-1e308),
            json!(5e-324),
            json!(u64::MAX),
            json!(i64::MIN),
            json!(0.5),
            json!(7.77),
            json!(300),
            json!(1e5),
            json!("flexible"),
            json!({ "count": 3 }),
        ];
        let mut chance = Chance(0x9e37_79b9_7f4a_7c15);
        let whole: Value =
            serde_json::from_str(&parse(&case_2()).expect("valid").canonical_json()).expect("JSON");
        let mut places = Vec::new();
        pointers(&whole, String::new(), &mut places);
        for _ in 0..4000 {
            let mut document = whole.clone();
            for _ in 0..=chance.below(3) {
                let place = &places[chance.below(places.len())];
                let Some(target) = document.pointer_mut(place) else {
                    continue;
                };
                let value = match (target.as_f64(), chance.below(3)) {
                    (Some(number), 0) => json!(number * 1.1_f64.powi(chance.below(40) as i32 - 20)),
                    _ => odd[chance.below(odd.len())].clone(),
                };
                *target = value;
            }
            if let Err(problem) = parse(&document) {
                assert_eq!(problem.status, 422);
                assert!(!problem.errors.is_empty(), "{problem:?}");
                for error in &problem.errors {
                    assert!(error.nearest.is_none_or(f64::is_finite), "{error:?}");
                }
            }
        }
        let text = whole.to_string().into_bytes();
        for _ in 0..4000 {
            let mut bytes = text.clone();
            for _ in 0..=chance.below(4) {
                let at = chance.below(bytes.len());
                match chance.below(3) {
                    0 => bytes[at] = chance.below(256) as u8,
                    1 => bytes.truncate(at.max(1)),
                    _ => bytes.insert(at, b"{}[]\",:0-.e"[chance.below(11)]),
                }
            }
            if let Err(problem) = Submission::parse(&bytes) {
                assert!([400, 422].contains(&problem.status));
            }
        }
    }

    #[test]
    fn every_field_of_the_schema_has_a_title_and_the_defaults_are_those_that_are_filled_in() {
        use utoipa::{PartialSchema, ToSchema};
        let mut named = Vec::new();
        Submission::schemas(&mut named);
        named.push(("Submission".to_owned(), Submission::schema()));
        let schemas: std::collections::HashMap<String, Value> = named
            .into_iter()
            .map(|(name, schema)| (name, serde_json::to_value(schema).expect("JSON")))
            .collect();
        let echo: Value =
            serde_json::from_str(&parse(&least()).expect("valid").canonical_json()).expect("JSON");
        for (name, place) in [
            ("Submission", ""),
            ("Pair", "/pair"),
            ("Gear", "/pair/driven"),
            ("Material", "/pair/driven/material"),
            ("Blank", "/pair/driven/blank"),
            ("Resolution", "/resolution"),
            ("LoadDistribution", "/resolution/load_distribution"),
        ] {
            let schema = &schemas[name];
            let fields = echo
                .pointer(place)
                .and_then(Value::as_object)
                .expect("an object");
            let properties = schema["properties"].as_object().expect("properties");
            assert_eq!(
                fields.keys().collect::<Vec<_>>(),
                properties.keys().collect::<Vec<_>>(),
                "{name} is echoed field by field"
            );
            for (field, property) in properties {
                if property.get("$ref").is_none() {
                    assert!(property["title"].is_string(), "{name}.{field}");
                }
                // A span that is not given is filled in with the true period.
                if let Some(default) = property
                    .get("default")
                    .filter(|_| field != "span_mesh_periods")
                {
                    assert_eq!(default.as_f64(), fields[field].as_f64(), "{name}.{field}");
                    if !default.is_number() {
                        assert_eq!(default, &fields[field], "{name}.{field}");
                    }
                }
                let number = ["number", "integer"]
                    .iter()
                    .any(|kind| property["type"] == **kind);
                if number {
                    assert!(
                        property["minimum"].is_number() && property["maximum"].is_number(),
                        "{name}.{field}"
                    );
                    assert!(property["x-unit"].is_string(), "{name}.{field}");
                }
            }
        }
    }
}
