//! The radii at which holed blanks are cut: one for both gears, or one for each.

use meshwright_engine::gear::{GearPair, Member, SpurGear};
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;

use super::problem::{Code, FieldError};
use super::quantity;
use super::schema::{self, Property, documented};
use super::tree::{Choice, Node, ObjectReader};
use super::units::{Side, from_mm, plain, rounded_inward, to_mm};

/// The interface radii of both gears, in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum InterfaceRadii {
    /// The same for both; none where each gear has its own default.
    Common(Option<f64>),
    /// One each, driving and driven; none where that gear has its default.
    Each([Option<f64>; 2]),
}

/// What the schema says of the field.
pub(super) fn property() -> Property {
    let quantity = &quantity::INTERFACE_RADIUS;
    let (name, number, _) = schema::number(quantity);
    let either = schema::one_of(
        quantity.title,
        quantity.description,
        Some(Value::Null),
        vec![number, schema::reference::<EachRadius>()],
    );
    (name, either, false)
}

/// Names the object with a radius for each gear in the contract.
pub(super) enum EachRadius {}

documented!(
    EachRadius,
    "InterfaceRadii",
    [],
    schema::object(
        "Interface radius of each gear",
        "One radius for each gear that has holes.",
        Member::BOTH.map(radius_of).to_vec(),
    )
);

fn radius_of(member: Member) -> Property {
    let (_, number, _) = schema::number(&quantity::INTERFACE_RADIUS);
    (member.word(), number, false)
}

impl InterfaceRadii {
    /// Reads a number, an object with one for each gear, or nothing.
    pub(super) fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        let quantity = &quantity::INTERFACE_RADIUS;
        let Some(node @ Node::Object(_)) = reader.present(quantity.name) else {
            return reader.optional_number(quantity).map(Self::Common);
        };
        let pointer = reader.pointer_to(quantity.name);
        let mut object = reader.object(node, pointer)?;
        let radii = Member::BOTH.map(|member| {
            let name = member.word();
            match object.present(name) {
                None => Some(None),
                Some(node) => object
                    .checked_number(node, &object.pointer_to(name), quantity)
                    .map(Some),
            }
        });
        object.finish();
        Some(Self::Each([radii[0]?, radii[1]?]))
    }

    /// Those of both gears in meters; `None` for a gear's default.
    pub(super) fn data(self) -> [Option<f64>; 2] {
        let radii = match self {
            Self::Common(radius) => [radius; 2],
            Self::Each(radii) => radii,
        };
        radii.map(|radius| radius.map(from_mm))
    }

    /// What is wrong with them on `pair`, whose submission has them at `pointer`: the interface has to stay clear of the holes and
    /// of the roots by a quarter of the material between them, or of a module where that is less.
    pub(super) fn faults(self, pair: &GearPair, pointer: &str) -> Vec<FieldError> {
        match self {
            Self::Common(None) => Vec::new(),
            Self::Common(Some(radius)) => {
                let ranges = Member::BOTH.map(|member| range(pair.gear(member)));
                let both = (ranges[0].0.max(ranges[1].0), ranges[0].1.min(ranges[1].1));
                fault(radius, both, pointer.to_owned())
                    .into_iter()
                    .collect()
            }
            Self::Each(radii) => Member::BOTH
                .into_iter()
                .filter_map(|member| {
                    let place = format!("{pointer}/{}", member.word());
                    fault(radii[member.index()]?, range(pair.gear(member)), place)
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

impl Serialize for InterfaceRadii {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Common(radius) => radius.serialize(serializer),
            Self::Each(radii) => {
                let mut map = serializer.serialize_map(Some(2))?;
                for member in Member::BOTH {
                    map.serialize_entry(member.word(), &radii[member.index()])?;
                }
                map.end()
            }
        }
    }
}
