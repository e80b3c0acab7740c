//! Blanks: bore or shaft, holes and web.

use meshwright_engine::gear::{BlankRegion, Core, FaceEnds, Hub, Web};

use super::field::Field;
use super::holes::HolesDocument;
use super::openings::{LOOPS, Shape, SideDocument, SpokesDocument};
use crate::declare::{absent, document, nested, number, unless, word};
use crate::units::from_mm;

document! {
    /// The blank: everything between the bore and the root circle.
    pub struct BlankDocument as "Blank", "Blank" {
        /// The radius on which the hub is rigid: at least 5 % of the root radius, and a module below it. A gear that is cut on its shaft has none, and says
        /// the shaft instead.
        pub(super) bore_radius_mm: Option<f64> =
            unless(&["shaft"], number("Bore radius", "mm", 0.02, 25_000.0)).left_out(),
        /// The shaft on which the gear is cut, said instead of the bore: gear and shaft are one piece, solid to the axis.
        pub(super) shaft: Option<ShaftDocument> =
            absent(nested("Shaft"), "the gear has a bore").left_out(),
        /// The holes of the blank: a pattern, or a list of patterns.
        pub(super) holes: HolesDocument = (),
        /// Straight spokes, with openings between them. Holes and an outline stand beside them.
        pub(super) spokes: Option<SpokesDocument> = absent(nested("Spokes"), "none").left_out(),
        /// Openings of any shape, by closed loops of lines and arcs. A loop around an opening runs clockwise. A clockwise circle about the axis is the bore and
        /// has its radius; a counter-clockwise one goes around the blank and says no more, because the teeth end the gear. Loops that are circles, or kidneys
        /// along a circle about the axis, are holes of that shape. All loops together have at most 1,000 sides.
        pub(super) outline: Option<Vec<Vec<SideDocument>>> = absent(LOOPS, "none").left_out(),
        /// A ring that is thinner, or thicker, than the face is wide.
        pub(super) web: Option<WebDocument> = absent(nested("Web"), "none"),
        /// The ring on the bore where it is not as wide as the face. It needs three dimensions.
        pub(crate) hub: Option<HubDocument> =
            absent(nested("Hub"), "as wide as the face") => in_three_dimensions,
    }
}

document! {
    /// A shaft in one piece with the gear. The gear is held at the section of the shaft: the torque rises with the radius, as torsion leaves it, and a force is
    /// uniform. The transmission error refers to the mean rotation of that section, whose mean displacement is zero. In three dimensions the section stands at
    /// both ends of the face, or of the hub where it has one: the torque enters there, and the mean displacement and tilt of each are zero.
    pub struct ShaftDocument as "Shaft", "Shaft" {
        /// The radius of the shaft: at least 5 % of the root radius, and a module below it. Holes and web lie outside of it.
        pub(super) radius_mm: f64 = number("Radius of the shaft", "mm", 0.02, 25_000.0),
        /// Through which ends of the face the torque enters, half of it each where it is both: through one of them the gear twists under its teeth, and these
        /// carry more there. A plane knows both only.
        pub(super) torque_at: FaceEnds =
            word("Where the torque enters").or(FaceEnds::Both) => in_three_dimensions,
    }
}

document! {
    /// Between its two radii the blank has this thickness, elsewhere the face width. The model is plane stress with a thickness by
    /// region.
    pub struct WebDocument as "Web", "Web" {
        /// Where the web begins: at the bore, or at least 0.1 modules outside of it.
        pub(super) inner_radius_mm: f64 = number("Inner radius of the web", "mm", 0.02, 25_000.0),
        /// Where the web ends: at least half a module below the root circle, and 0.1 modules outside of its inner radius.
        pub(super) outer_radius_mm: f64 = number("Outer radius of the web", "mm", 0.1, 25_000.0),
        /// Its thickness, symmetric to the middle of the face: 1 % to four times the face width. A web as thick as the face is wide is
        /// none.
        pub(super) thickness_mm: f64 = number("Thickness of the web", "mm", 0.001, 8_000.0),
        /// Where the middle of the web stands from that of the face. Other than 0 it needs three dimensions.
        pub(crate) offset_mm: f64 =
            number("Offset of the web", "mm", -1_000.0, 1_000.0).or(0.0) => in_three_dimensions,
    }
}

document! {
    /// The ring on the bore where it is not as wide as the face.
    pub struct HubDocument as "Hub", "Hub" {
        /// Where the hub ends: between the bore and the rim.
        pub(super) outer_radius_mm: f64 = number("Outer radius of the hub", "mm", 0.02, 25_000.0),
        /// Its width: at least that of the web that stands on it.
        pub(super) width_mm: f64 = number("Width of the hub", "mm", 0.1, 4_000.0),
        /// Where its middle stands from that of the face.
        pub(super) offset_mm: f64 = number("Offset of the hub", "mm", -1_000.0, 1_000.0).or(0.0),
    }
}

impl BlankDocument {
    /// The openings that a few numbers draw: those between spokes.
    pub(super) fn shapes(&self) -> impl Iterator<Item = &dyn Shape> {
        let spokes = self.spokes.as_ref();
        spokes.map(|spokes| spokes as &dyn Shape).into_iter()
    }

    /// The same blank with neither holes nor other openings.
    pub(super) fn without_openings(self) -> Self {
        Self {
            holes: HolesDocument::None,
            spokes: None,
            outline: None,
            ..self
        }
    }

    /// Where the middle of the web stands from that of the face, in m.
    pub(super) fn web_offset(&self) -> f64 {
        self.web.as_ref().map_or(0.0, |web| from_mm(web.offset_mm))
    }

    /// The hub as the engine is told.
    pub(super) fn hub_data(&self) -> Option<Hub> {
        self.hub.as_ref().map(|hub| Hub {
            outer_radius: from_mm(hub.outer_radius_mm),
            width: from_mm(hub.width_mm),
            offset: from_mm(hub.offset_mm),
        })
    }

    /// The field of the radius of the bore or of the shaft, and its value.
    pub(super) fn core_field(&self) -> (Field, f64) {
        match &self.shaft {
            Some(shaft) => (
                Field::of("blank/shaft/", ShaftDocument::radius_mm),
                shaft.radius_mm,
            ),
            None => (
                Field::of("blank/", Self::bore_radius_mm.given()),
                self.bore_radius_mm.unwrap_or_default(),
            ),
        }
    }

    /// The blank of the engine.
    pub(super) fn data(&self) -> BlankRegion {
        let region = BlankRegion {
            bore_radius: from_mm(self.core_field().1),
            core: match &self.shaft {
                Some(shaft) => Core::Shaft {
                    torque_at: shaft.torque_at,
                },
                None => Core::Bore,
            },
            // Openings that there cannot be are refused before.
            holes: [self.holes.data(), self.openings().unwrap_or_default()].concat(),
            web: self.web.as_ref().map(|web| Web {
                inner_radius: from_mm(web.inner_radius_mm),
                outer_radius: from_mm(web.outer_radius_mm),
                thickness: from_mm(web.thickness_mm),
            }),
        };
        match self.outline {
            Some(_) => region.evened(self.last_decimal()),
            None => region,
        }
    }
}
