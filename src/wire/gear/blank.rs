//! What carries the teeth: the bore and the holes.

use meshwright_engine::gear::{BlankRegion, HolePattern};
use serde::Serialize;

use crate::wire::quantity;
use crate::wire::schema::{self, documented};
use crate::wire::tree::{ObjectReader, OptionalObject};
use crate::wire::units::from_mm;

/// What carries the teeth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlankDocument {
    pub(super) bore_radius_mm: f64,
    pub(super) holes: Option<HolesDocument>,
}

documented!(
    BlankDocument,
    "Blank",
    [HolesDocument],
    schema::object(
        "Blank",
        "What carries the teeth: everything between the bore and the root circle.",
        vec![
            schema::number(&quantity::BORE_RADIUS),
            schema::optional_document::<HolesDocument>(
                "holes",
                "Holes",
                "Equal round holes on a circle. Default: none."
            ),
        ]
    )
);

/// Equal round holes on a circle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HolesDocument {
    pub(super) count: u32,
    pub(super) circle_radius_mm: f64,
    pub(super) radius_mm: f64,
    phase_deg: f64,
}

documented!(
    HolesDocument,
    "Holes",
    [],
    schema::object(
        "Holes",
        "Equal, evenly spaced round holes on a circle.",
        vec![
            schema::number(&quantity::HOLE_COUNT),
            schema::number(&quantity::HOLE_CIRCLE),
            schema::number(&quantity::HOLE_RADIUS),
            schema::number(&quantity::HOLE_PHASE),
        ]
    )
);

impl BlankDocument {
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let bore_radius_mm = reader.number(&quantity::BORE_RADIUS, None);
        let holes = match reader.optional_object("holes") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(holes) => HolesDocument::read(holes).map(Some),
        };
        reader.finish();
        Some(Self {
            bore_radius_mm: bore_radius_mm?,
            holes: holes?,
        })
    }

    pub(super) fn data(&self) -> BlankRegion {
        let holes = self.holes.as_ref().map(HolesDocument::data);
        BlankRegion {
            bore_radius: from_mm(self.bore_radius_mm),
            holes: holes.map_or_else(Vec::new, |pattern| pattern.holes()),
            web: None,
        }
    }
}

impl HolesDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let count = reader.count(&quantity::HOLE_COUNT);
        let circle_radius_mm = reader.number(&quantity::HOLE_CIRCLE, None);
        let radius_mm = reader.number(&quantity::HOLE_RADIUS, None);
        let phase_deg = reader.number(&quantity::HOLE_PHASE, None);
        reader.finish();
        Some(Self {
            count: count?,
            circle_radius_mm: circle_radius_mm?,
            radius_mm: radius_mm?,
            phase_deg: phase_deg?,
        })
    }

    fn data(&self) -> HolePattern {
        HolePattern {
            count: self.count,
            circle_radius: from_mm(self.circle_radius_mm),
            radius: from_mm(self.radius_mm),
            phase: self.phase_deg.to_radians(),
        }
    }
}
