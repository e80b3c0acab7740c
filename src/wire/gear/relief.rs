//! Reliefs of tip and root: how much, in what shape, and from where.

use meshwright_engine::gear::{
    ModificationData, ReliefData, ReliefShape, ReliefStart, RootReliefData, RootReliefStart,
    SpurGear,
};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::Schema;

use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, Quantity};
use crate::wire::schema::{self, Property, documented};
use crate::wire::tree::{Choice, Node, ObjectReader, as_word};
use crate::wire::units::{from_mm, from_um};

/// A relief of the tip or of the root.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReliefDocument {
    amount_um: f64,
    #[serde(serialize_with = "as_word")]
    shape: ReliefShape,
    pub(super) start: StartDocument,
}

documented!(
    ReliefDocument,
    "TipRelief",
    [StartDocument],
    schema::object(
        "Tip relief",
        "c(r) = amount ((r - r_s)/(r_a - r_s))^n, normal to the flank, in the radius however the start r_s is given.",
        ReliefDocument::properties(ReliefEnd::Tip)
    )
);

impl Choice for ReliefShape {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("linear", Self::Linear, "in proportion to the radius, n = 1"),
        ("parabolic", Self::Parabolic, "with its square, n = 2"),
    ];
}

/// Where a relief has its amount.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReliefEnd {
    /// At the tip circle.
    Tip,
    /// At the form circle.
    Form,
}

/// Where a relief starts: exactly one of four ways to say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartDocument {
    pub(super) end: ReliefEnd,
    pub(super) way: StartWay,
    pub(super) value: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StartWay {
    RadialLength,
    RollLength,
    Diameter,
    RollAngle,
}

impl StartWay {
    const ALL: [Self; 4] = [
        Self::RadialLength,
        Self::RollLength,
        Self::Diameter,
        Self::RollAngle,
    ];

    fn quantity(self, end: ReliefEnd) -> &'static Quantity {
        match (self, end) {
            (Self::RadialLength, ReliefEnd::Tip) => &quantity::RELIEF_RADIAL_LENGTH,
            (Self::RadialLength, ReliefEnd::Form) => &quantity::ROOT_RELIEF_RADIAL_LENGTH,
            (Self::RollLength, ReliefEnd::Tip) => &quantity::RELIEF_ROLL_LENGTH,
            (Self::RollLength, ReliefEnd::Form) => &quantity::ROOT_RELIEF_ROLL_LENGTH,
            (Self::Diameter, _) => &quantity::RELIEF_DIAMETER,
            (Self::RollAngle, _) => &quantity::RELIEF_ROLL_ANGLE,
        }
    }
}

documented!(
    StartDocument,
    "ReliefStart",
    [],
    start_schema(ReliefEnd::Tip)
);

/// Names the start of a root relief in the contract.
pub(super) enum RootStart {}

documented!(
    RootStart,
    "RootReliefStart",
    [],
    start_schema(ReliefEnd::Form)
);

fn start_schema(end: ReliefEnd) -> RefOr<Schema> {
    let ways = StartWay::ALL.iter().map(|way| {
        let quantity = way.quantity(end);
        // Generators of clients name types by their titles.
        let title = match end {
            ReliefEnd::Tip => quantity.title.to_owned(),
            ReliefEnd::Form => format!("{} of a root relief", quantity.title),
        };
        schema::object(&title, quantity.description, vec![schema::number(quantity)])
    });
    schema::one_of(
        "Start of the relief",
        "Where the relief starts: exactly one of the four. A bare length is not accepted, because drawings mean different ones by it.",
        None,
        ways.collect(),
    )
}

impl Serialize for StartDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(self.quantity().name, &self.value)?;
        map.end()
    }
}

impl ReliefDocument {
    /// What the schema says of its fields.
    pub(super) fn properties(end: ReliefEnd) -> Vec<Property> {
        let (amount, grows, start) = match end {
            ReliefEnd::Tip => (
                &quantity::RELIEF_AMOUNT,
                "How the relief grows towards the tip.",
                schema::document::<StartDocument>("start", true),
            ),
            ReliefEnd::Form => (
                &quantity::ROOT_RELIEF_AMOUNT,
                "How the relief grows towards the form circle.",
                schema::document::<RootStart>("start", true),
            ),
        };
        let shape = schema::choice("shape", "Shape", grows, Some(ReliefShape::Linear));
        vec![schema::number(amount), shape, start]
    }

    pub(super) fn read(mut reader: ObjectReader<'_>, end: ReliefEnd) -> Option<Self> {
        let relief = Self::read_fields(&mut reader, end);
        reader.finish();
        relief
    }

    /// Reads its fields, beside which there may be others.
    pub(super) fn read_fields(reader: &mut ObjectReader<'_>, end: ReliefEnd) -> Option<Self> {
        let amount = match end {
            ReliefEnd::Tip => &quantity::RELIEF_AMOUNT,
            ReliefEnd::Form => &quantity::ROOT_RELIEF_AMOUNT,
        };
        let amount_um = reader.number(amount, None);
        let shape = reader.choice("shape", Some(ReliefShape::Linear));
        let start = reader
            .needed("start")
            .and_then(|node| StartDocument::read(node, reader, end));
        Some(Self {
            amount_um: amount_um?,
            shape: shape?,
            start: start?,
        })
    }

    /// Whether it takes anything off.
    pub(super) fn is_there(&self) -> bool {
        self.amount_um != 0.0
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> ModificationData {
        let (amount, shape) = (from_um(self.amount_um), self.shape);
        match self.start.data() {
            Start::Tip(start) => ModificationData::TipRelief(ReliefData {
                amount,
                shape,
                start,
            }),
            Start::Root(start) => ModificationData::RootRelief(RootReliefData {
                amount,
                shape,
                start,
            }),
        }
    }
}

/// Where a relief starts, as the engine is told.
enum Start {
    Tip(ReliefStart),
    Root(RootReliefStart),
}

impl StartDocument {
    pub(super) fn quantity(self) -> &'static Quantity {
        self.way.quantity(self.end)
    }

    /// The radius in meters at which it starts on the flank of `gear`.
    pub(super) fn radius(self, gear: &SpurGear) -> f64 {
        match self.data() {
            Start::Tip(start) => start.radius(gear.flank(), gear.tip_radius()),
            Start::Root(start) => start.radius(gear.flank(), gear.form_radius()),
        }
    }

    fn data(self) -> Start {
        let (length, angle) = (from_mm(self.value), self.value.to_radians());
        match self.end {
            ReliefEnd::Tip => Start::Tip(match self.way {
                StartWay::RadialLength => ReliefStart::RadialLength(length),
                StartWay::RollLength => ReliefStart::RollLengthFromTip(length),
                StartWay::Diameter => ReliefStart::Diameter(length),
                StartWay::RollAngle => ReliefStart::RollAngle(angle),
            }),
            ReliefEnd::Form => Start::Root(match self.way {
                StartWay::RadialLength => RootReliefStart::RadialLength(length),
                StartWay::RollLength => RootReliefStart::RollLengthFromForm(length),
                StartWay::Diameter => RootReliefStart::Diameter(length),
                StartWay::RollAngle => RootReliefStart::RollAngle(angle),
            }),
        }
    }

    fn read(node: &Node, parent: &ObjectReader<'_>, end: ReliefEnd) -> Option<Self> {
        let pointer = parent.pointer_to("start");
        let mut reader = parent.object(node, pointer.clone())?;
        let mut found = Vec::new();
        let mut wrong = false;
        for way in StartWay::ALL {
            match reader.optional_number(way.quantity(end)) {
                Some(Some(value)) => found.push(Self { end, way, value }),
                Some(None) => {}
                None => wrong = true,
            }
        }
        let names: Vec<_> = StartWay::ALL
            .iter()
            .map(|way| way.quantity(end).name)
            .collect();
        let names = names.join(", ");
        let one = match (found.as_slice(), wrong) {
            ([one], false) => Some(*one),
            ([], false) => {
                let detail = format!("{pointer} needs exactly one of {names}; it has none.");
                reader.report(FieldError::new(pointer, Code::MissingField, detail));
                None
            }
            (several, false) => {
                let detail = format!(
                    "{pointer} needs exactly one of {names}; it has {}.",
                    several.len()
                );
                reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
                None
            }
            (_, true) => None,
        };
        reader.finish();
        one
    }
}
