//! The fields that may have to change to make a gear: their values, bounds and places.

use super::GearDocument;
use super::blank::{BlankDocument, WebDocument};
use super::holes::{PatternDocument, SlotDocument};
use super::relief::Relief;
use crate::wire::declare::{Declared, Node, Number, Optional};

/// The fields that may have to change to make a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Field {
    ProfileShift,
    /// The tip circle, by addendum or by diameter.
    Tip,
    Dedendum,
    RackTipRadius,
    ThicknessDeviation,
    /// The rounding or the chamfer.
    TipEdge,
    ReliefStart(ReliefPlace),
    /// A modification as a whole.
    Modification(ReliefPlace),
    /// The deviations as a whole.
    Deviations,
    Bore,
    /// The circle of a pattern of holes.
    HoleCircle(usize),
    /// The radius of its holes, or the width of its slots.
    HoleWidth(usize),
    SlotAngle(usize),
    WebInner,
    WebOuter,
    WebThickness,
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
    fn pointer_within(self) -> String {
        match self {
            Self::Short => "tip_relief".to_owned(),
            Self::Listed(i) => format!("profile_modifications/{i}"),
        }
    }
}

/// A field as it stands in a gear.
pub(super) struct Found {
    /// Where, within the gear.
    pub(super) pointer: String,
    /// What it says, and what it may say; none where it is no number.
    pub(super) number: Option<(f64, Number)>,
}

impl GearDocument {
    /// Where `field` stands, and what it says.
    pub(super) fn found(&self, field: Field) -> Found {
        let number = |folder: &str, declared: Declared<Number>, value: f64| Found {
            pointer: format!("{folder}{}", declared.name),
            number: Some((value, declared.spec)),
        };
        let given = |declared: Declared<Optional<Number>>, value: Option<f64>| {
            let declared = declared.map(|optional| optional.spec);
            number("", declared, value.unwrap_or(0.0))
        };
        let whole = |pointer: String| Found {
            pointer,
            number: None,
        };
        let holes = |i: usize| {
            (
                format!("{}/", self.blank.holes.pointer_within(i)),
                &self.blank.holes.patterns()[i],
            )
        };
        let web = |declared: Declared<Number>, value: fn(&WebDocument) -> f64| {
            number(
                "blank/web/",
                declared,
                self.blank.web.as_ref().map_or(0.0, value),
            )
        };
        match field {
            Field::ProfileShift => number("", Self::profile_shift, self.profile_shift),
            Field::Tip if self.tip_diameter_mm.is_some() => {
                given(Self::tip_diameter_mm, self.tip_diameter_mm)
            }
            Field::Tip => given(Self::addendum_mm, self.addendum_mm),
            Field::Dedendum => number("", Self::dedendum_mm, self.dedendum_mm),
            Field::RackTipRadius => number("", Self::rack_tip_radius_mm, self.rack_tip_radius_mm),
            Field::ThicknessDeviation => number(
                "",
                Self::tooth_thickness_deviation_um,
                self.tooth_thickness_deviation_um,
            ),
            Field::TipEdge if self.tip_rounding_mm.is_some() => {
                given(Self::tip_rounding_mm, self.tip_rounding_mm)
            }
            Field::TipEdge => given(Self::tip_chamfer_mm, self.tip_chamfer_mm),
            Field::ReliefStart(place) => match self.relief(place) {
                Some(Relief { start, .. }) => number(
                    &format!("{}/start/", place.pointer_within()),
                    start.field(),
                    start.value,
                ),
                None => whole(place.pointer_within()),
            },
            Field::Modification(place) => whole(place.pointer_within()),
            Field::Deviations => whole(Self::tooth_deviations.name.to_owned()),
            Field::Bore => number(
                "blank/",
                BlankDocument::bore_radius_mm,
                self.blank.bore_radius_mm,
            ),
            Field::HoleCircle(i) => {
                let (folder, pattern) = holes(i);
                number(
                    &folder,
                    PatternDocument::circle_radius_mm,
                    pattern.circle_radius_mm,
                )
            }
            Field::HoleWidth(i) => {
                let (folder, pattern) = holes(i);
                let (within, declared) = pattern.width_field();
                number(&(folder + within), declared, pattern.width())
            }
            Field::SlotAngle(i) => {
                let (folder, pattern) = holes(i);
                number(
                    &(folder + "slot/"),
                    SlotDocument::angle_deg,
                    pattern.span_deg(),
                )
            }
            Field::WebInner => web(WebDocument::inner_radius_mm, |web| web.inner_radius_mm),
            Field::WebOuter => web(WebDocument::outer_radius_mm, |web| web.outer_radius_mm),
            Field::WebThickness => web(WebDocument::thickness_mm, |web| web.thickness_mm),
        }
    }

    /// The number that `field` says.
    pub(super) fn value(&self, field: Field) -> f64 {
        self.found(field).number.map_or(0.0, |(value, _)| value)
    }

    /// The same gear with another number in `field`.
    pub(super) fn with_value(&self, field: Field, value: f64) -> Option<Self> {
        let mut gear = Node::of(&serde_json::to_value(self).ok()?);
        let pointer = self.found(field).pointer;
        let steps: Vec<&str> = pointer.split('/').collect();
        gear.put(&steps, Node::Number(value))?;
        Self::at(&gear)
    }

    /// Whether `value` is within the bounds of `field`.
    pub(super) fn accepts(&self, field: Field, value: f64) -> bool {
        self.found(field).number.is_some_and(
            |(
                _,
                Number {
                    bounds: (least, most),
                    ..
                },
            )| { (least..=most).contains(&value) },
        )
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
