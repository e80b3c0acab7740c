//! The tip of a tooth: its circle, said by addendum or by diameter, and the edge there.

use meshwright_engine::gear::TipEdge;
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::wire::quantity::{self, Quantity};
use crate::wire::tree::ObjectReader;
use crate::wire::units::from_mm;

/// The tip circle, said in one of two ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum TipCircle {
    /// By the addendum of the basic rack.
    Addendum(f64),
    /// By its diameter.
    Diameter(f64),
}

impl TipCircle {
    /// Reads either way; by default the addendum is a module.
    pub(super) fn read(reader: &mut ObjectReader<'_>, module: Option<f64>) -> Option<Self> {
        if reader.conflict(quantity::ADDENDUM.name, quantity::TIP_DIAMETER.name) {
            return None;
        }
        if let Some(diameter) = reader.optional_number(&quantity::TIP_DIAMETER)? {
            return Some(Self::Diameter(diameter));
        }
        match reader.present(quantity::ADDENDUM.name) {
            Some(_) => reader.number(&quantity::ADDENDUM, module),
            None => quantity::ADDENDUM.preset_for(module),
        }
        .map(Self::Addendum)
    }

    pub(super) fn quantity(self) -> &'static Quantity {
        match self {
            Self::Addendum(_) => &quantity::ADDENDUM,
            Self::Diameter(_) => &quantity::TIP_DIAMETER,
        }
    }

    pub(super) fn value(self) -> f64 {
        match self {
            Self::Addendum(value) | Self::Diameter(value) => value,
        }
    }

    /// The same way with another value.
    pub(super) fn with(self, value: f64) -> Self {
        match self {
            Self::Addendum(_) => Self::Addendum(value),
            Self::Diameter(_) => Self::Diameter(value),
        }
    }

    /// The addendum, given the radius from which it counts: the reference radius plus the profile shift.
    pub(super) fn addendum(self, from_radius: f64) -> f64 {
        match self {
            Self::Addendum(addendum) => addendum,
            Self::Diameter(diameter) => diameter / 2.0 - from_radius,
        }
    }

    /// What this way would say of another `addendum`.
    pub(super) fn said(self, addendum: f64, from_radius: f64) -> f64 {
        match self {
            Self::Addendum(_) => addendum,
            Self::Diameter(_) => 2.0 * (from_radius + addendum),
        }
    }
}

impl Serialize for TipCircle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (addendum, diameter) = match *self {
            Self::Addendum(addendum) => (Some(addendum), None),
            Self::Diameter(diameter) => (None, Some(diameter)),
        };
        either(
            serializer,
            (quantity::ADDENDUM.name, addendum),
            (quantity::TIP_DIAMETER.name, diameter),
        )
    }
}

/// The edge between flanks and tip circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum EdgeDocument {
    Sharp,
    Rounding(f64),
    Chamfer(f64),
}

impl EdgeDocument {
    /// Reads a rounding or a chamfer, or neither.
    pub(super) fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        if reader.conflict(quantity::TIP_ROUNDING.name, quantity::TIP_CHAMFER.name) {
            return None;
        }
        let rounding = reader.optional_number(&quantity::TIP_ROUNDING);
        let chamfer = reader.optional_number(&quantity::TIP_CHAMFER);
        Some(match (rounding?, chamfer?) {
            (Some(radius), _) => Self::Rounding(radius),
            (None, Some(depth)) => Self::Chamfer(depth),
            (None, None) => Self::Sharp,
        })
    }

    pub(super) fn quantity(self) -> Option<&'static Quantity> {
        match self {
            Self::Sharp => None,
            Self::Rounding(_) => Some(&quantity::TIP_ROUNDING),
            Self::Chamfer(_) => Some(&quantity::TIP_CHAMFER),
        }
    }

    pub(super) fn value(self) -> f64 {
        match self {
            Self::Sharp => 0.0,
            Self::Rounding(value) | Self::Chamfer(value) => value,
        }
    }

    /// The same kind of edge with another value.
    pub(super) fn with(self, value: f64) -> Self {
        match self {
            Self::Sharp => Self::Sharp,
            Self::Rounding(_) => Self::Rounding(value),
            Self::Chamfer(_) => Self::Chamfer(value),
        }
    }

    /// What the engine is told.
    pub(super) fn data(self) -> TipEdge {
        match self {
            Self::Rounding(radius) if radius > 0.0 => TipEdge::Rounded(from_mm(radius)),
            Self::Chamfer(depth) if depth > 0.0 => TipEdge::Chamfered(from_mm(depth)),
            _ => TipEdge::Sharp,
        }
    }
}

impl Serialize for EdgeDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (rounding, chamfer) = match *self {
            Self::Sharp => (None, None),
            Self::Rounding(radius) => (Some(radius), None),
            Self::Chamfer(depth) => (None, Some(depth)),
        };
        either(
            serializer,
            (quantity::TIP_ROUNDING.name, rounding),
            (quantity::TIP_CHAMFER.name, chamfer),
        )
    }
}

/// Writes two fields that exclude each other.
pub(super) fn either<S: Serializer, T: Serialize>(
    serializer: S,
    one: (&'static str, Option<T>),
    other: (&'static str, Option<T>),
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(2))?;
    map.serialize_entry(one.0, &one.1)?;
    map.serialize_entry(other.0, &other.1)?;
    map.end()
}
