//! A tip relief: how much, in what shape, and from where.

use meshwright_engine::gear::{ReliefData, ReliefShape, ReliefStart};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, Quantity};
use crate::wire::schema::{self, documented};
use crate::wire::tree::{Choice, Node, ObjectReader, as_word};
use crate::wire::units::{from_mm, from_um};

/// A tip relief.
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
        vec![
            schema::number(&quantity::RELIEF_AMOUNT),
            schema::choice(
                "shape",
                "Shape",
                "How the relief grows towards the tip.",
                Some(ReliefShape::Linear)
            ),
            schema::document::<StartDocument>("start", true),
        ]
    )
);

impl Choice for ReliefShape {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("linear", Self::Linear, "in proportion to the radius, n = 1"),
        ("parabolic", Self::Parabolic, "with its square, n = 2"),
    ];
}

/// Where a relief starts: exactly one of four ways to say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartDocument {
    pub(super) way: StartWay,
    pub(super) value: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StartWay {
    RadialLength,
    RollLengthFromTip,
    Diameter,
    RollAngle,
}

impl StartWay {
    const ALL: [Self; 4] = [
        Self::RadialLength,
        Self::RollLengthFromTip,
        Self::Diameter,
        Self::RollAngle,
    ];

    pub(super) fn quantity(self) -> &'static Quantity {
        match self {
            Self::RadialLength => &quantity::RELIEF_RADIAL_LENGTH,
            Self::RollLengthFromTip => &quantity::RELIEF_ROLL_LENGTH,
            Self::Diameter => &quantity::RELIEF_DIAMETER,
            Self::RollAngle => &quantity::RELIEF_ROLL_ANGLE,
        }
    }
}

documented!(
    StartDocument,
    "ReliefStart",
    [],
    schema::one_of(
        "Start of the relief",
        "Where the relief starts: exactly one of the four. A bare length is not accepted, because drawings mean different ones by it.",
        None,
        StartWay::ALL
            .iter()
            .map(|way| {
                let quantity = way.quantity();
                schema::object(
                    quantity.title,
                    quantity.description,
                    vec![schema::number(quantity)],
                )
            })
            .collect()
    )
);

impl Serialize for StartDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(self.way.quantity().name, &self.value)?;
        map.end()
    }
}

impl ReliefDocument {
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let amount_um = reader.number(&quantity::RELIEF_AMOUNT, None);
        let shape = reader.choice("shape", Some(ReliefShape::Linear));
        let start = reader
            .needed("start")
            .and_then(|node| StartDocument::read(node, &reader));
        reader.finish();
        Some(Self {
            amount_um: amount_um?,
            shape: shape?,
            start: start?,
        })
    }

    pub(super) fn data(&self) -> ReliefData {
        let value = self.start.value;
        ReliefData {
            amount: from_um(self.amount_um),
            shape: self.shape,
            start: match self.start.way {
                StartWay::RadialLength => ReliefStart::RadialLength(from_mm(value)),
                StartWay::RollLengthFromTip => ReliefStart::RollLengthFromTip(from_mm(value)),
                StartWay::Diameter => ReliefStart::Diameter(from_mm(value)),
                StartWay::RollAngle => ReliefStart::RollAngle(value.to_radians()),
            },
        }
    }
}

impl StartDocument {
    fn read(node: &Node, parent: &ObjectReader<'_>) -> Option<Self> {
        let pointer = parent.pointer_to("start");
        let mut reader = parent.object(node, pointer.clone())?;
        let mut found = Vec::new();
        let mut wrong = false;
        for way in StartWay::ALL {
            match reader.optional_number(way.quantity()) {
                Some(Some(value)) => found.push(Self { way, value }),
                Some(None) => {}
                None => wrong = true,
            }
        }
        let names: Vec<_> = StartWay::ALL
            .iter()
            .map(|way| way.quantity().name)
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
