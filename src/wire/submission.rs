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
use super::schema::{self, documented};
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
        vec![
            schema::choice::<Method>("method", "Method", "How the curves are computed.", None),
            schema::document::<PairDocument>("pair", true),
            (
                quantity::OUTPUT_TORQUE.name,
                schema::list(
                    "Output torques",
                    "The torques on the driven gear, each of which gives a curve. Unit: N m.",
                    schema::number_schema(&quantity::OUTPUT_TORQUE),
                    (1, MOST_TORQUES)
                )
                .unique_items(true)
                .into(),
                true
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
                    (0, MOST_TAGS.0)
                )
                .default(Some(serde_json::json!([])))
                .into(),
                false
            ),
        ]
    )
);

impl Submission {
    /// Reads and checks a submission.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400) where the text is not JSON; else 422 with every field that is wrong, its
    /// JSON pointer, and the nearest value that would do.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        let node = Node::parse(document)?;
        let errors = Errors::default();
        match Self::read(&node, &errors) {
            Some(submission) if errors.count() == 0 => Ok(submission),
            _ => Err(errors.into_problem()),
        }
    }

    fn read(node: &Node, errors: &Errors) -> Option<Self> {
        let mut document = Document::read(ObjectReader::new(node, String::new(), errors)?)?;
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
        document.check_size(errors);
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
            LARGEST_DEFLECTION * module * USUAL_STIFFNESS * softer * pair.contact_width();
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

    fn check_size(&self, errors: &Errors) {
        let resolution = &self.resolution;
        let span = u64::from(resolution.span_mesh_periods.unwrap_or(1));
        let (positions, torques) = (
            u64::from(resolution.positions_per_mesh_period),
            self.output_torques_n_m.len() as u64,
        );
        let total = span * positions * torques;
        if total <= MOST_POSITIONS {
            return;
        }
        let fitting_positions = MOST_POSITIONS / (span * torques);
        let fitting_torques = MOST_POSITIONS / (span * positions);
        let fitting_span = MOST_POSITIONS / (positions * torques);
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
        let (name, nearest) = if fitting_positions >= least_positions {
            (quantity::POSITIONS.name, fitting_positions)
        } else {
            (quantity::SPAN.name, fitting_span)
        };
        let detail = format!(
            "{span} mesh periods of {positions} positions at {torques} torques are {total} positions; the limit is {MOST_POSITIONS}. What would fit: {}.",
            ways.join(", or ")
        );
        let pointer = format!("/resolution/{name}");
        errors.push(FieldError::new(pointer, Code::TooLarge, detail).nearest(nearest as f64));
    }
}
