//! The holes of a blank: one pattern or several, evenly spaced or at angles, round or kidneys.

use std::f64::consts::TAU;

use meshwright_engine::gear::{Hole, HolePattern, HoleShape};
use serde::Serializer;
use serde_json::{Value, json};

use crate::declare::{
    Declared, EACH, Kind, List, Location, Named, Nested, Node, Number, absent, document, list,
    nested, number, unless,
};
use crate::problem::Code;
use crate::units::from_mm;

/// The most patterns of holes in one blank.
const MOST_PATTERNS: usize = 12;

/// The most holes in one blank.
pub(crate) const MOST_HOLES: usize = 60;

document! {
    /// Equal holes on a circle: count of them evenly spaced from phase_deg on, or one at each angle of at_deg; each round with
    /// radius_mm, or a slot.
    pub struct PatternDocument as "Holes", "Holes" {
        /// The number N of equal, evenly spaced holes.
        count: Option<u32> =
            unless(&["at_deg"], number("Number of holes", "1", 1.0, MOST_HOLES as f64)).left_out(),
        /// The radius R of the circle through the holes' centers.
        pub(super) circle_radius_mm: f64 = number("Radius of the hole circle", "mm", 0.1, 25_000.0),
        /// The radius r of each hole: at least 1 % of the root radius. At least 0.5 mm of material has to be left between holes, to the
        /// bore and to the root circle; below one module there is a warning.
        radius_mm: Option<f64> =
            unless(&["slot"], number("Radius of a hole", "mm", 0.05, 12_500.0)).left_out(),
        /// The shape of the holes, where they are not round.
        pub(super) slot: Option<SlotDocument> = absent(nested("Slot"), "round holes").left_out(),
        /// The angle of a hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth.
        phase_deg: Option<f64> = unless(
            &["at_deg"],
            number("Phase of the holes", "deg", -360.0, 360.0).or(0.0),
        )
        .left_out(),
        /// The angle of each hole's center from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that
        /// tooth; instead of count and phase_deg. Unequal angles spread the order of the holes over those of a revolution.
        at_deg: Option<Vec<f64>> = absent(
            list("Angles of the holes", number("", "deg", -360.0, 360.0), MOST_HOLES)
                .not_empty(Code::WrongLength, "give the angle of a hole"),
            "even spacing",
        )
        .left_out(),
    }
}

document! {
    /// A kidney along the hole circle, with round ends.
    pub struct SlotDocument as "Slot", "Slot" {
        /// The width across the hole circle, which is the diameter of the round ends: at least 2 % of the root radius.
        width_mm: f64 = number("Width of a slot", "mm", 0.1, 25_000.0),
        /// The angle between the centers of the ends; with 0 the slot is a round hole.
        pub(super) angle_deg: f64 = number("Angle of a slot", "deg", 0.0, 350.0),
    }
}

/// The holes of a blank, as the document has them.
#[derive(Debug, Clone, PartialEq)]
pub enum HolesDocument {
    /// None.
    None,
    /// One pattern, as an object.
    One(Box<PatternDocument>),
    /// A list of patterns.
    Several(Vec<PatternDocument>),
}

const PATTERNS: List<Nested> = list("Several patterns of holes", EACH, MOST_PATTERNS);

impl Kind for HolesDocument {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, _: &()) -> Option<Self> {
        match node {
            Node::Null => Some(Self::None),
            Node::List(_) => Kind::read(node, place, &PATTERNS).map(Self::Several),
            _ => PatternDocument::read(node, place, &EACH).map(|one| Self::One(Box::new(one))),
        }
    }

    fn usual(_: &()) -> Option<Self> {
        Some(Self::None)
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => serializer.serialize_none(),
            Self::One(pattern) => pattern.write(serializer),
            Self::Several(patterns) => patterns.write(serializer),
        }
    }

    fn describe(about: &str, _: &()) -> Value {
        json!({
            "title": "Holes",
            "description": format!("{about} Default: none."),
            "default": null,
            "oneOf": [
                { "type": "null" },
                PatternDocument::describe("", &EACH),
                Vec::<PatternDocument>::describe(
                    "Holes on several circles, of unlike sizes or shapes.",
                    &PATTERNS,
                ),
            ],
        })
    }

    fn name_parts(named: &mut Named) {
        PatternDocument::name_parts(named);
    }
}

impl HolesDocument {
    /// The patterns, in the order of the document.
    pub(super) fn patterns(&self) -> &[PatternDocument] {
        match self {
            Self::None => &[],
            Self::One(pattern) => std::slice::from_ref(pattern),
            Self::Several(patterns) => patterns,
        }
    }

    /// Where a pattern stands in a blank.
    pub(super) fn pointer_within(&self, index: usize) -> String {
        match self {
            Self::Several(_) => format!("blank/holes/{index}"),
            Self::None | Self::One(_) => "blank/holes".to_owned(),
        }
    }

    /// The holes of the engine, pattern after pattern.
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
            end += pattern.hole_count();
            end
        });
        ends.into_iter().position(|end| hole < end).unwrap_or(0)
    }

    /// The number of all holes.
    pub(super) fn count(&self) -> usize {
        self.patterns()
            .iter()
            .map(PatternDocument::hole_count)
            .sum()
    }
}

impl PatternDocument {
    /// The number of its holes.
    pub(super) fn hole_count(&self) -> usize {
        match &self.at_deg {
            None => self.count.unwrap_or(0) as usize,
            Some(angles) => angles.len(),
        }
    }

    fn data(&self) -> Vec<Hole> {
        let circle_radius = from_mm(self.circle_radius_mm);
        let (count, phase) = (self.count.unwrap_or(0), self.phase_deg.unwrap_or(0.0));
        let shape = match &self.slot {
            None => HoleShape::Round {
                radius: from_mm(self.width()),
            },
            Some(slot) => HoleShape::Slot {
                width: from_mm(slot.width_mm),
                angle: slot.angle_deg.to_radians(),
            },
        };
        let angles: Vec<f64> = match (&self.at_deg, &shape) {
            // The engine's own pattern, so that its digits are those that they always were.
            (None, &HoleShape::Round { radius }) => {
                let pattern = HolePattern {
                    count,
                    circle_radius,
                    radius,
                    phase: phase.to_radians(),
                };
                return pattern.holes();
            }
            (None, _) => {
                let turn = TAU / f64::from(count);
                (0..count)
                    .map(|i| phase.to_radians() + f64::from(i) * turn)
                    .collect()
            }
            (Some(angles), _) => angles.iter().map(|angle| angle.to_radians()).collect(),
        };
        let hole = |angle| Hole {
            circle_radius,
            angle,
            shape: shape.clone(),
        };
        angles.into_iter().map(hole).collect()
    }

    /// The field that says how wide a hole is, and where it stands in the pattern.
    pub(super) fn width_field(&self) -> (&'static str, Declared<Number>) {
        match self.slot {
            None => ("", Self::radius_mm.given()),
            Some(_) => ("slot/", SlotDocument::width_mm),
        }
    }

    /// The value of that field.
    pub(super) fn width(&self) -> f64 {
        match &self.slot {
            None => self.radius_mm.unwrap_or(0.0),
            Some(slot) => slot.width_mm,
        }
    }

    /// Value of that field for holes of another half width.
    pub(super) fn of_half_width(&self, half_width: f64) -> f64 {
        match self.slot {
            None => half_width,
            Some(_) => 2.0 * half_width,
        }
    }

    /// The angle between the ends of a hole, in degrees.
    pub(super) fn span_deg(&self) -> f64 {
        self.slot.as_ref().map_or(0.0, |slot| slot.angle_deg)
    }
}
