//! The holes of a blank: one pattern or several, evenly spaced or at angles, round or kidneys.

use std::f64::consts::TAU;

use meshwright_engine::gear::{Hole, HolePattern, HoleShape};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, MOST_HOLES, MOST_PATTERNS, Quantity};
use crate::wire::schema::{self, Property, documented};
use crate::wire::tree::{Node, ObjectReader, OptionalObject};
use crate::wire::units::from_mm;

/// The holes of a blank, as the document has them.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HolesDocument {
    None,
    One(PatternDocument),
    Several(Vec<PatternDocument>),
}

/// Equal holes on a circle.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternDocument {
    pub(super) angles: HoleAngles,
    pub(super) circle_radius_mm: f64,
    pub(super) shape: ShapeDocument,
}

/// Where the holes of a pattern stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HoleAngles {
    Even { count: u32, phase_deg: f64 },
    At(Vec<f64>),
}

/// The shape of the holes of a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ShapeDocument {
    Round { radius_mm: f64 },
    Slot(SlotDocument),
}

/// A kidney along the hole circle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SlotDocument {
    pub(super) width_mm: f64,
    pub(super) angle_deg: f64,
}

documented!(
    SlotDocument,
    "Slot",
    [],
    schema::object(
        "Slot",
        "A kidney along the hole circle, with round ends.",
        vec![
            schema::number(&quantity::SLOT_WIDTH),
            schema::number(&quantity::SLOT_ANGLE),
        ]
    )
);

documented!(
    PatternDocument,
    "Holes",
    [SlotDocument],
    schema::object(
        "Holes",
        "Equal holes on a circle: count of them evenly spaced from phase_deg on, or one at each angle of at_deg; each round with radius_mm, or a slot.",
        vec![
            schema::number(&quantity::HOLE_COUNT),
            schema::number(&quantity::HOLE_PHASE),
            schema::numbers(&quantity::HOLE_ANGLES, (1, MOST_HOLES), false),
            schema::number(&quantity::HOLE_CIRCLE),
            schema::number(&quantity::HOLE_RADIUS),
            schema::optional_document::<SlotDocument>(
                "slot",
                "Slot",
                "The shape of the holes, where they are not round."
            ),
        ]
    )
);

/// What the schema says of the holes of a blank.
pub(super) fn property() -> Property {
    let null = utoipa::openapi::schema::Object::with_type(utoipa::openapi::schema::Type::Null);
    let several = schema::list(
        "Several patterns of holes",
        "Holes on several circles, of unlike sizes or shapes.",
        schema::reference::<PatternDocument>(),
        (0, MOST_PATTERNS),
    );
    let either = schema::one_of(
        "Holes",
        "The holes of the blank: a pattern, or a list of patterns. Default: none.",
        Some(serde_json::Value::Null),
        vec![
            null.into(),
            schema::reference::<PatternDocument>(),
            several.into(),
        ],
    );
    ("holes", either, false)
}

impl HolesDocument {
    pub(super) fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        match reader.present("holes") {
            None => Some(Self::None),
            Some(Node::List(_)) => {
                let items = reader.objects("holes", MOST_PATTERNS)?;
                let read: Vec<_> = items.into_iter().map(PatternDocument::read).collect();
                let patterns: Option<Vec<_>> = read.into_iter().collect();
                patterns.map(Self::Several)
            }
            Some(_) => match reader.optional_object("holes") {
                OptionalObject::Present(pattern) => PatternDocument::read(pattern).map(Self::One),
                OptionalObject::Absent | OptionalObject::Wrong => None,
            },
        }
    }

    /// The patterns, in the order of the document.
    pub(super) fn patterns(&self) -> &[PatternDocument] {
        match self {
            Self::None => &[],
            Self::One(pattern) => std::slice::from_ref(pattern),
            Self::Several(patterns) => patterns,
        }
    }

    pub(super) fn pattern_mut(&mut self, index: usize) -> Option<&mut PatternDocument> {
        match self {
            Self::None => None,
            Self::One(pattern) => Some(pattern),
            Self::Several(patterns) => patterns.get_mut(index),
        }
    }

    /// Where a pattern stands in a blank.
    pub(super) fn pointer_within(&self, index: usize) -> String {
        match self {
            Self::Several(_) => format!("blank/holes/{index}"),
            Self::None | Self::One(_) => "blank/holes".to_owned(),
        }
    }

    /// What the engine is told: the holes of every pattern, one after the other.
    pub(super) fn data(&self) -> Vec<Hole> {
        self.patterns()
            .iter()
            .flat_map(PatternDocument::data)
            .collect()
    }

    /// The pattern that a hole of [`HolesDocument::data`] belongs to.
    pub(super) fn pattern_of(&self, hole: usize) -> usize {
        let mut end = 0;
        let ends = self.patterns().iter().map(|pattern| {
            end += pattern.count();
            end
        });
        ends.into_iter().position(|end| hole < end).unwrap_or(0)
    }

    /// That there are more holes than a blank may have.
    pub(super) fn too_many(&self, pointer: &str) -> Option<FieldError> {
        let count: usize = self.patterns().iter().map(PatternDocument::count).sum();
        if count <= MOST_HOLES {
            return None;
        }
        let pointer = format!("{pointer}/blank/holes");
        let detail = format!("{pointer} has {count} holes; a blank has at most {MOST_HOLES}.");
        Some(FieldError::new(pointer, Code::TooLarge, detail))
    }
}

impl Serialize for HolesDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => serializer.serialize_none(),
            Self::One(pattern) => pattern.serialize(serializer),
            Self::Several(patterns) => patterns.serialize(serializer),
        }
    }
}

impl PatternDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let angles = HoleAngles::read(&mut reader);
        let circle_radius_mm = reader.number(&quantity::HOLE_CIRCLE, None);
        let shape = ShapeDocument::read(&mut reader);
        reader.finish();
        Some(Self {
            angles: angles?,
            circle_radius_mm: circle_radius_mm?,
            shape: shape?,
        })
    }

    /// The number of its holes.
    pub(super) fn count(&self) -> usize {
        match &self.angles {
            HoleAngles::Even { count, .. } => *count as usize,
            HoleAngles::At(angles) => angles.len(),
        }
    }

    fn data(&self) -> Vec<Hole> {
        let circle_radius = from_mm(self.circle_radius_mm);
        let shape = self.shape.data();
        let angles: Vec<f64> = match (&self.angles, self.shape) {
            // The engine's own pattern, so that its digits are those that they always were.
            (&HoleAngles::Even { count, phase_deg }, ShapeDocument::Round { radius_mm }) => {
                let pattern = HolePattern {
                    count,
                    circle_radius,
                    radius: from_mm(radius_mm),
                    phase: phase_deg.to_radians(),
                };
                return pattern.holes();
            }
            (&HoleAngles::Even { count, phase_deg }, ShapeDocument::Slot(_)) => {
                let turn = TAU / f64::from(count);
                (0..count)
                    .map(|i| phase_deg.to_radians() + f64::from(i) * turn)
                    .collect()
            }
            (HoleAngles::At(angles), _) => angles.iter().map(|angle| angle.to_radians()).collect(),
        };
        let hole = |angle| Hole {
            circle_radius,
            angle,
            shape,
        };
        angles.into_iter().map(hole).collect()
    }
}

impl HoleAngles {
    fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        let (of_count, of_phase) = (&quantity::HOLE_COUNT, &quantity::HOLE_PHASE);
        let of_angles = &quantity::HOLE_ANGLES;
        let by_count = reader.conflict(of_count.name, of_angles.name);
        let by_phase = !by_count && reader.conflict(of_phase.name, of_angles.name);
        let phase = match reader.present(of_phase.name) {
            Some(_) => reader.number(of_phase, None),
            None => of_phase.preset_for(None),
        };
        let read = match reader.optional_numbers(of_angles, MOST_HOLES)? {
            Some(angles) if angles.is_empty() => {
                let pointer = reader.pointer_to(of_angles.name);
                let detail = format!("{pointer} is empty; give the angle of a hole.");
                reader.report(FieldError::new(pointer, Code::WrongLength, detail).nearest(1.0));
                None
            }
            Some(angles) => Some(Self::At(angles)),
            None => {
                let count = reader.given_number(of_count).map(|count| count as u32);
                count
                    .zip(phase)
                    .map(|(count, phase_deg)| Self::Even { count, phase_deg })
            }
        };
        read.filter(|_| !by_count && !by_phase)
    }
}

impl ShapeDocument {
    fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        let of_radius = &quantity::HOLE_RADIUS;
        let conflict = reader.conflict(of_radius.name, "slot");
        let read = match reader.optional_object("slot") {
            OptionalObject::Absent => reader
                .given_number(of_radius)
                .map(|radius_mm| Self::Round { radius_mm }),
            OptionalObject::Wrong => None,
            OptionalObject::Present(mut slot) => {
                let width_mm = slot.number(&quantity::SLOT_WIDTH, None);
                let angle_deg = slot.number(&quantity::SLOT_ANGLE, None);
                slot.finish();
                let both = width_mm.zip(angle_deg);
                both.map(|(width_mm, angle_deg)| {
                    Self::Slot(SlotDocument {
                        width_mm,
                        angle_deg,
                    })
                })
            }
        };
        read.filter(|_| !conflict)
    }

    /// The quantity that says how wide a hole is, and where it stands in the pattern.
    pub(super) fn width(self) -> (&'static Quantity, &'static str) {
        match self {
            Self::Round { .. } => (&quantity::HOLE_RADIUS, ""),
            Self::Slot(_) => (&quantity::SLOT_WIDTH, "slot/"),
        }
    }

    /// The value of that quantity.
    pub(super) fn width_value(self) -> f64 {
        match self {
            Self::Round { radius_mm } => radius_mm,
            Self::Slot(slot) => slot.width_mm,
        }
    }

    /// What that quantity would be for holes of another half width.
    pub(super) fn of_half_width(self, half_width: f64) -> f64 {
        match self {
            Self::Round { .. } => half_width,
            Self::Slot(_) => 2.0 * half_width,
        }
    }

    pub(super) fn set_width(&mut self, value: f64) {
        match self {
            Self::Round { radius_mm } => *radius_mm = value,
            Self::Slot(slot) => slot.width_mm = value,
        }
    }

    /// The angle between the ends of a hole, in degrees.
    pub(super) fn span_deg(self) -> f64 {
        match self {
            Self::Round { .. } => 0.0,
            Self::Slot(slot) => slot.angle_deg,
        }
    }

    pub(super) fn set_span(&mut self, angle_deg: f64) {
        if let Self::Slot(slot) = self {
            slot.angle_deg = angle_deg;
        }
    }

    fn data(self) -> HoleShape {
        match self {
            Self::Round { radius_mm } => HoleShape::Round {
                radius: from_mm(radius_mm),
            },
            Self::Slot(slot) => HoleShape::Slot {
                width: from_mm(slot.width_mm),
                angle: slot.angle_deg.to_radians(),
            },
        }
    }
}

impl Serialize for PatternDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        if let HoleAngles::Even { count, .. } = &self.angles {
            map.serialize_entry(quantity::HOLE_COUNT.name, count)?;
        }
        map.serialize_entry(quantity::HOLE_CIRCLE.name, &self.circle_radius_mm)?;
        match &self.shape {
            ShapeDocument::Round { radius_mm } => {
                map.serialize_entry(quantity::HOLE_RADIUS.name, radius_mm)?;
            }
            ShapeDocument::Slot(slot) => map.serialize_entry("slot", slot)?,
        }
        match &self.angles {
            HoleAngles::Even { phase_deg, .. } => {
                map.serialize_entry(quantity::HOLE_PHASE.name, phase_deg)?;
            }
            HoleAngles::At(angles) => map.serialize_entry(quantity::HOLE_ANGLES.name, angles)?,
        }
        map.end()
    }
}
