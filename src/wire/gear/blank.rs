//! What carries the teeth: the bore, the holes and the web.

use meshwright_engine::gear::{BlankRegion, Web};
use serde::Serialize;

use super::holes::{self, HolesDocument, PatternDocument};
use crate::wire::quantity;
use crate::wire::schema::{self, documented};
use crate::wire::tree::{ObjectReader, OptionalObject};
use crate::wire::units::from_mm;

/// What carries the teeth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlankDocument {
    pub(super) bore_radius_mm: f64,
    pub(super) holes: HolesDocument,
    pub(super) web: Option<WebDocument>,
}

documented!(
    BlankDocument,
    "Blank",
    [PatternDocument, WebDocument],
    schema::object(
        "Blank",
        "What carries the teeth: everything between the bore and the root circle.",
        vec![
            schema::number(&quantity::BORE_RADIUS),
            holes::property(),
            schema::optional_document::<WebDocument>(
                "web",
                "Web",
                "A ring that is thinner, or thicker, than the face is wide. Default: none."
            ),
        ]
    )
);

/// A ring of its own thickness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WebDocument {
    pub(super) inner_radius_mm: f64,
    pub(super) outer_radius_mm: f64,
    pub(super) thickness_mm: f64,
}

documented!(
    WebDocument,
    "Web",
    [],
    schema::object(
        "Web",
        "Between its two radii the blank has this thickness, elsewhere the face width. The model is plane stress with a thickness by region.",
        vec![
            schema::number(&quantity::WEB_INNER),
            schema::number(&quantity::WEB_OUTER),
            schema::number(&quantity::WEB_THICKNESS),
        ]
    )
);

impl BlankDocument {
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let bore_radius_mm = reader.number(&quantity::BORE_RADIUS, None);
        let holes = HolesDocument::read(&mut reader);
        let web = match reader.optional_object("web") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(web) => WebDocument::read(web).map(Some),
        };
        reader.finish();
        Some(Self {
            bore_radius_mm: bore_radius_mm?,
            holes: holes?,
            web: web?,
        })
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> BlankRegion {
        BlankRegion {
            bore_radius: from_mm(self.bore_radius_mm),
            holes: self.holes.data(),
            web: self.web.map(WebDocument::data),
        }
    }
}

impl WebDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let inner_radius_mm = reader.number(&quantity::WEB_INNER, None);
        let outer_radius_mm = reader.number(&quantity::WEB_OUTER, None);
        let thickness_mm = reader.number(&quantity::WEB_THICKNESS, None);
        reader.finish();
        Some(Self {
            inner_radius_mm: inner_radius_mm?,
            outer_radius_mm: outer_radius_mm?,
            thickness_mm: thickness_mm?,
        })
    }

    fn data(self) -> Web {
        Web {
            inner_radius: from_mm(self.inner_radius_mm),
            outer_radius: from_mm(self.outer_radius_mm),
            thickness: from_mm(self.thickness_mm),
        }
    }
}
