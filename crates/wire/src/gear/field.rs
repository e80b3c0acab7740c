//! Fields that may have to change so that a gear can be made: pointers and bounds.

use super::GearDocument;
use super::relief::Relief;
use crate::declare::{Declared, Node, Number};

/// A field that may have to change to make a gear.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// Where it stands in the gear.
    pub(super) pointer: String,
    /// Its unit, "1" where it has none.
    pub(super) unit: &'static str,
    /// Bounds; empty for a field that is no number.
    bounds: (f64, f64),
}

impl Field {
    /// A number of the object in `folder`, which is empty or ends with a slash.
    pub(super) fn of(folder: &str, declared: Declared<Number>) -> Self {
        Self {
            pointer: format!("{folder}{}", declared.name),
            unit: declared.spec.unit,
            bounds: declared.spec.bounds,
        }
    }

    /// A field that is no number.
    pub(super) fn whole(pointer: String) -> Self {
        Self {
            pointer,
            unit: "1",
            bounds: (f64::INFINITY, f64::NEG_INFINITY),
        }
    }

    /// True if `value` is within its bounds.
    pub(super) fn accepts(&self, value: f64) -> bool {
        let (least, most) = self.bounds;
        (least..=most).contains(&value)
    }
}

/// Where a relief stands in the document of a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ReliefPlace {
    /// In its own field.
    Short,
    /// Among the profile modifications.
    Listed(usize),
}

impl ReliefPlace {
    /// The modification as a whole.
    pub(super) fn field(self) -> Field {
        Field::whole(match self {
            Self::Short => "tip_relief".to_owned(),
            Self::Listed(i) => format!("profile_modifications/{i}"),
        })
    }
}

impl GearDocument {
    /// The tip circle, by addendum or by diameter.
    pub(super) fn tip_field(&self) -> Field {
        let said = match self.tip_diameter_mm {
            Some(_) => Self::tip_diameter_mm,
            None => Self::addendum_mm,
        };
        Field::of("", said.given())
    }

    /// The root circle, by dedendum or by diameter.
    pub(super) fn root_field(&self) -> Field {
        let said = match self.root_diameter_mm {
            Some(_) => Self::root_diameter_mm,
            None => Self::dedendum_mm,
        };
        Field::of("", said.given())
    }

    /// The rounding or the chamfer of the tip edges, and its value.
    pub(super) fn tip_edge_field(&self) -> (Field, f64) {
        let (said, value) = match self.tip_rounding_mm {
            Some(_) => (Self::tip_rounding_mm, self.tip_rounding_mm),
            None => (Self::tip_chamfer_mm, self.tip_chamfer_mm),
        };
        (Field::of("", said.given()), value.unwrap_or(0.0))
    }

    /// The start of the relief at `place`.
    pub(super) fn relief_start_field(&self, place: ReliefPlace) -> Field {
        let whole = place.field();
        match self.relief(place) {
            Some(Relief { start, .. }) => {
                Field::of(&format!("{}/start/", whole.pointer), start.field())
            }
            None => whole,
        }
    }

    /// The same gear with another number in `field`.
    pub(super) fn with_value(&self, field: &Field, value: f64) -> Option<Self> {
        let mut gear = Node::of(&serde_json::to_value(self).ok()?);
        let steps: Vec<&str> = field.pointer.split('/').collect();
        gear.put(&steps, Node::Number(value))?;
        Self::at(&gear)
    }

    /// The places of all reliefs, in the order in which the engine is told of them.
    pub(super) fn relief_places(&self) -> impl Iterator<Item = ReliefPlace> {
        let listed = (0..self.profile_modifications.len()).map(ReliefPlace::Listed);
        [ReliefPlace::Short].into_iter().chain(listed)
    }

    /// The place of a modification that the engine knows by its number.
    pub(super) fn place_of(&self, modification: usize) -> ReliefPlace {
        match (&self.tip_relief, modification) {
            (Some(_), 0) => ReliefPlace::Short,
            (Some(_), i) => ReliefPlace::Listed(i - 1),
            (None, i) => ReliefPlace::Listed(i),
        }
    }

    /// The relief at `place`, if there is one.
    pub(super) fn relief(&self, place: ReliefPlace) -> Option<Relief> {
        match place {
            ReliefPlace::Short => Some(self.tip_relief.as_ref()?.relief()),
            ReliefPlace::Listed(i) => self.profile_modifications.get(i)?.relief(),
        }
    }
}
