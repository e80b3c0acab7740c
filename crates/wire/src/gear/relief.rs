//! Reliefs of tip and root: amount, shape and start.

use meshwright_engine::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart, SpurGear};
use serde::Serializer;
use serde::ser::SerializeMap;
use serde_json::{Value, json};

use crate::declare::{
    Declared, Kind, Location, Named, Node, Number, ObjectReader, document, number, object, word,
    words,
};
use crate::problem::Code;
use crate::units::{from_mm, from_um};

document! {
    /// c(r) = amount ((r - r_s)/(r_a - r_s))^n, normal to the flank, in the radius however the start r_s is given.
    pub struct TipReliefDocument as "TipRelief", "Tip relief" {
        /// The material taken off at the tip circle, normal to the flank.
        amount_um: f64 = number("Amount of tip relief", "um", 0.0, 1_000.0),
        /// How the relief grows towards the tip.
        shape: ReliefShape = word("Shape").or(ReliefShape::Linear),
        /// Where the relief starts.
        pub(super) start: StartDocument = ReliefEnd::Tip,
    }
}

document! {
    /// The same in the radius from the form circle.
    pub struct RootReliefDocument as "RootRelief", "Root relief" {
        /// The material taken off at the form circle, where the flank ends, normal to the flank.
        amount_um: f64 = number("Amount of root relief", "um", 0.0, 1_000.0),
        /// How the relief grows towards the form circle.
        shape: ReliefShape = word("Shape").or(ReliefShape::Linear),
        /// Where the relief starts.
        pub(super) start: StartDocument = ReliefEnd::Form,
    }
}

words! {
    ReliefShape {
        Linear = "linear": "in proportion to the radius, n = 1",
        Parabolic = "parabolic": "with its square, n = 2",
    }
}

/// Where a relief has its amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReliefEnd {
    /// At the tip circle.
    Tip,
    /// At the form circle.
    Form,
}

/// A relief of either end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Relief {
    amount_um: f64,
    shape: ReliefShape,
    pub(super) start: StartDocument,
}

impl TipReliefDocument {
    pub(super) fn relief(&self) -> Relief {
        Relief::of(self.amount_um, self.shape, self.start)
    }
}

impl RootReliefDocument {
    pub(super) fn relief(&self) -> Relief {
        Relief::of(self.amount_um, self.shape, self.start)
    }
}

/// Where a relief starts: exactly one of four ways to say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartDocument {
    pub(super) end: ReliefEnd,
    pub(super) way: StartWay,
    pub(super) value: f64,
}

/// How the start of a relief is said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StartWay {
    /// By the radial length from the end.
    RadialLength,
    /// By the roll length from the end.
    RollLength,
    /// By the diameter.
    Diameter,
    /// By the roll angle.
    RollAngle,
}

impl StartWay {
    const ALL: [Self; 4] = [
        Self::RadialLength,
        Self::RollLength,
        Self::Diameter,
        Self::RollAngle,
    ];

    /// The field that says it so.
    fn field(self, end: ReliefEnd) -> Declared<Number> {
        match (self, end) {
            (Self::RadialLength, ReliefEnd::Tip) => Declared::new(
                "radial_length_mm",
                "The relief starts at the tip radius less this length. However the start is given, it is at least 0.01 modules below the tip circle.",
                number("Radial length below the tip circle", "mm", 0.001, 225.0),
            ),
            (Self::RadialLength, ReliefEnd::Form) => Declared::new(
                "radial_length_mm",
                "The relief starts at the form radius plus this length. However the start is given, it is at least 0.01 modules above the form circle.",
                number("Radial length above the form circle", "mm", 0.001, 225.0),
            ),
            (Self::RollLength, ReliefEnd::Tip) => Declared::new(
                "roll_length_from_tip_mm",
                "The relief starts where the roll length is this much less than at the tip circle.",
                number(
                    "Length along the path of contact from the tip",
                    "mm",
                    0.001,
                    2_000.0,
                ),
            ),
            (Self::RollLength, ReliefEnd::Form) => Declared::new(
                "roll_length_from_form_mm",
                "The relief starts where the roll length is this much more than at the form circle.",
                number(
                    "Length along the path of contact from the form circle",
                    "mm",
                    0.001,
                    2_000.0,
                ),
            ),
            (Self::Diameter, _) => Declared::new(
                "diameter_mm",
                "The relief starts at this diameter.",
                number("Start diameter", "mm", 0.1, 52_500.0),
            ),
            (Self::RollAngle, _) => Declared::new(
                "roll_angle_deg",
                "The relief starts at this roll angle of the flank, the roll length over the base radius.",
                number("Start roll angle", "deg", 0.001, 180.0),
            ),
        }
    }
}

impl ReliefEnd {
    /// Name of the start of a relief in the contract.
    fn name(self) -> &'static str {
        match self {
            Self::Tip => "ReliefStart",
            Self::Form => "RootReliefStart",
        }
    }

    fn json_schema(self) -> Value {
        let ways = StartWay::ALL.map(|way| {
            let field = way.field(self);
            let property = field.property::<f64>();
            // Generators of clients name types by their titles.
            let title = property.schema["title"].as_str().unwrap_or_default();
            let title = match self {
                Self::Tip => title.to_owned(),
                Self::Form => format!("{title} of a root relief"),
            };
            object(&title, field.about, vec![property])
        });
        json!({
            "title": "Start of the relief",
            "description": "Where the relief starts: exactly one of the four. A bare length is not accepted, because drawings mean different ones by it.",
            "oneOf": ways,
        })
    }
}

impl Kind for StartDocument {
    type Spec = ReliefEnd;

    fn read(node: &Node, place: &Location<'_>, &end: &ReliefEnd) -> Option<Self> {
        let mut reader = ObjectReader::new(node, place.clone())?;
        let mut found = Vec::new();
        let mut wrong = false;
        for way in StartWay::ALL {
            let field = way.field(end);
            if let Some(node) = reader.present(field.name) {
                match f64::read(node, &reader.place_of(field.name), &field.spec) {
                    Some(value) => found.push(Self { end, way, value }),
                    None => wrong = true,
                }
            }
        }
        let names = StartWay::ALL.map(|way| way.field(end).name).join(", ");
        let refuse = |code, has: &str| {
            let detail = format!("{place} needs exactly one of {names}; it has {has}.");
            place.wrong(code, detail, None)
        };
        let one = match (found.as_slice(), wrong) {
            (_, true) => None,
            ([one], false) => Some(*one),
            ([], false) => refuse(Code::MissingField, "none"),
            (several, false) => refuse(Code::OutOfRange, &several.len().to_string()),
        };
        reader.finish();
        one
    }

    fn absent(reader: &mut ObjectReader<'_>, name: &'static str, end: &ReliefEnd) -> Option<Self> {
        let place = reader.place_of(name);
        let names = StartWay::ALL.map(|way| way.field(*end).name).join(", ");
        let detail = format!("{place} is needed, with exactly one of {names}.");
        place.wrong(Code::MissingField, detail, None)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        self.field().write(&self.value, &mut map)?;
        map.end()
    }

    fn describe(_: &str, end: &ReliefEnd) -> Value {
        json!({ "$ref": format!("#/components/schemas/{}", end.name()) })
    }

    fn name_parts(named: &mut Named) {
        for end in [ReliefEnd::Tip, ReliefEnd::Form] {
            named.push((end.name(), end.json_schema()));
        }
    }
}

impl Relief {
    fn of(amount_um: f64, shape: ReliefShape, start: StartDocument) -> Self {
        Self {
            amount_um,
            shape,
            start,
        }
    }

    /// True if it removes material.
    pub(super) fn is_there(&self) -> bool {
        self.amount_um != 0.0
    }

    /// As the engine has it.
    pub(super) fn data(&self) -> ModificationData {
        let (amount, shape) = (from_um(self.amount_um), self.shape);
        let data = ReliefData {
            amount,
            shape,
            start: self.start.data(),
        };
        match self.start.end {
            ReliefEnd::Tip => ModificationData::TipRelief(data),
            ReliefEnd::Form => ModificationData::RootRelief(data),
        }
    }
}

impl StartDocument {
    /// The field that says it.
    pub(super) fn field(self) -> Declared<Number> {
        self.way.field(self.end)
    }

    /// The radius in meters at which it starts on the flank of `gear`.
    pub(super) fn radius(self, gear: &SpurGear) -> f64 {
        let start = self.data();
        match self.end {
            ReliefEnd::Tip => start.below_tip(gear.flank(), gear.tip_radius()),
            ReliefEnd::Form => start.above_form(gear.flank(), gear.form_radius()),
        }
    }

    /// As the engine has it.
    fn data(self) -> ReliefStart {
        let (length, angle) = (from_mm(self.value), self.value.to_radians());
        match self.way {
            StartWay::RadialLength => ReliefStart::RadialLength(length),
            StartWay::RollLength => ReliefStart::RollLength(length),
            StartWay::Diameter => ReliefStart::Diameter(length),
            StartWay::RollAngle => ReliefStart::RollAngle(angle),
        }
    }
}
