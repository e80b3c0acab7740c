//! The radii at which holed blanks are cut: one for both gears, or one for each.

use meshwright_engine::gear::{GearPair, Member, SpurGear};
use serde::Serializer;
use serde_json::{Value, json};

use super::declare::{
    Choice, EACH, Kind, Location, Named, Node, Number, Optional, absent, document, number,
};
use super::problem::{Code, FieldError};
use super::units::{Side, from_mm, plain, rounded_inward, to_mm};

document! {
    /// One radius for each gear that has holes.
    pub struct EachRadius as "InterfaceRadii", "Interface radius of each gear" {
        /// That of the driving gear.
        driving: Option<f64> = RADIUS,
        /// That of the driven gear.
        driven: Option<f64> = RADIUS,
    }
}

const RADIUS: Optional<Number> = absent(
    number("Interface radius of holed gears", "mm", 0.1, 25_000.0),
    "for each holed gear one module below its root circle, or halfway to the holes where they come closer",
);

/// The interface radii of both gears, in mm.
#[derive(Debug, Clone, PartialEq)]
pub enum InterfaceRadii {
    /// The same for both; none where each gear has its own default.
    Common(Option<f64>),
    /// One each; none where that gear has its default.
    Each(EachRadius),
}

impl Kind for InterfaceRadii {
    type Spec = ();

    fn read(node: &Node, place: &Location<'_>, _: &()) -> Option<Self> {
        match node {
            Node::Null => Some(Self::Common(None)),
            Node::Object(_) => EachRadius::read(node, place, &EACH).map(Self::Each),
            _ => f64::read(node, place, &RADIUS.spec).map(|radius| Self::Common(Some(radius))),
        }
    }

    fn usual(_: &()) -> Option<Self> {
        Some(Self::Common(None))
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Common(radius) => radius.write(serializer),
            Self::Each(radii) => radii.write(serializer),
        }
    }

    fn describe(about: &str, _: &()) -> Value {
        let number = Option::<f64>::describe(about, &RADIUS);
        json!({
            "title": number["title"],
            "description": about,
            "default": null,
            "oneOf": [number, EachRadius::describe("", &EACH)],
        })
    }

    fn name_parts(named: &mut Named) {
        EachRadius::name_parts(named);
    }
}

impl InterfaceRadii {
    fn of(&self, member: Member) -> Option<f64> {
        match (self, member) {
            (Self::Common(radius), _) => *radius,
            (Self::Each(radii), Member::Driving) => radii.driving,
            (Self::Each(radii), Member::Driven) => radii.driven,
        }
    }

    /// The radii of both gears in meters; `None` for a gear's default.
    pub(super) fn data(&self) -> [Option<f64>; 2] {
        Member::BOTH.map(|member| self.of(member).map(from_mm))
    }

    /// Faults on `pair`, whose submission has them at `pointer`. The interface has to stay clear of the holes and of the roots, by a quarter of the material
    /// between them or a quarter of a module, whichever is less.
    pub(super) fn faults(&self, pair: &GearPair, pointer: &str) -> Vec<FieldError> {
        match self {
            Self::Common(None) => Vec::new(),
            Self::Common(Some(radius)) => {
                let ranges = Member::BOTH.map(|member| range(pair.gear(member)));
                let both = (ranges[0].0.max(ranges[1].0), ranges[0].1.min(ranges[1].1));
                fault(*radius, both, pointer.to_owned())
                    .into_iter()
                    .collect()
            }
            Self::Each(_) => Member::BOTH
                .into_iter()
                .filter_map(|member| {
                    let place = format!("{pointer}/{}", member.word());
                    fault(self.of(member)?, range(pair.gear(member)), place)
                })
                .collect(),
        }
    }
}

/// The radii in mm at which the blank of `gear` can be cut; any where it has no holes.
fn range(gear: &SpurGear) -> (f64, f64) {
    let blank = &gear.data().blank;
    let Some(reach) = blank.outer_reach() else {
        return (0.0, f64::INFINITY);
    };
    let web = blank
        .web_in(gear.face_width())
        .map_or(0.0, |web| web.outer_radius);
    let (inner, outer) = (to_mm(reach.max(web)), to_mm(gear.root_radius()));
    let margin = 0.25 * (outer - inner).min(to_mm(gear.data().rack.module));
    (inner + margin, outer - margin)
}

fn fault(radius: f64, (least, most): (f64, f64), pointer: String) -> Option<FieldError> {
    if (least..=most).contains(&radius) {
        return None;
    }
    let nearest = if least > most {
        None
    } else if radius < least {
        Some(rounded_inward(least, Side::AtLeast, 0))
    } else {
        Some(rounded_inward(most, Side::AtMost, 0))
    };
    let said = match nearest {
        Some(_) => format!(
            "it has to lie between {} mm and {} mm, between the holes and the root circle",
            plain(least),
            plain(most)
        ),
        None => "no one radius lies between holes and roots of both gears; give one for each, or leave it out".to_owned(),
    };
    let detail = format!("{pointer} is {} mm; {said}.", plain(radius));
    let nearest = nearest.filter(|nearest| (least..=most).contains(nearest));
    Some(FieldError::new(pointer, Code::OutOfRange, detail).nearest(nearest))
}
