//! What carries the teeth: the bore, the holes and the web.

use meshwright_engine::gear::{BlankRegion, Web};

use super::holes::HolesDocument;
use crate::wire::declare::{absent, document, nested, number};
use crate::wire::units::from_mm;

document! {
    /// What carries the teeth: everything between the bore and the root circle.
    pub struct BlankDocument as "Blank", "Blank" {
        /// The radius on which the hub is rigid: at least 5 % of the root radius, and a module below it.
        pub(super) bore_radius_mm: f64 = number("Bore radius", "mm", 0.02, 7_500.0),
        /// The holes of the blank: a pattern, or a list of patterns.
        pub(super) holes: HolesDocument = (),
        /// A ring that is thinner, or thicker, than the face is wide.
        pub(super) web: Option<WebDocument> = absent(nested("Web"), "none"),
    }
}

document! {
    /// Between its two radii the blank has this thickness, elsewhere the face width. The model is plane stress with a thickness by
    /// region.
    pub struct WebDocument as "Web", "Web" {
        /// Where the web begins: at the bore, or at least 0.1 modules outside of it.
        pub(super) inner_radius_mm: f64 = number("Inner radius of the web", "mm", 0.02, 7_500.0),
        /// Where the web ends: at least half a module below the root circle, and 0.1 modules outside of its inner radius.
        pub(super) outer_radius_mm: f64 = number("Outer radius of the web", "mm", 0.1, 7_500.0),
        /// Its thickness, symmetric to the middle of the face: 1 % to four times the face width. A web as thick as the face is wide is
        /// none.
        pub(super) thickness_mm: f64 = number("Thickness of the web", "mm", 0.001, 8_000.0),
    }
}

impl BlankDocument {
    /// What the engine is told.
    pub(super) fn data(&self) -> BlankRegion {
        BlankRegion {
            bore_radius: from_mm(self.bore_radius_mm),
            holes: self.holes.data(),
            web: self.web.as_ref().map(|web| Web {
                inner_radius: from_mm(web.inner_radius_mm),
                outer_radius: from_mm(web.outer_radius_mm),
                thickness: from_mm(web.thickness_mm),
            }),
        }
    }
}
