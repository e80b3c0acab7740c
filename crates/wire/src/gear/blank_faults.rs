//! Faults of a blank: holes too near to each other, to the rim or to the bore, and a web outside of it.

use meshwright_engine::gear::data::LEAST_LIGAMENT;

use super::GearDocument;
use super::blank::WebDocument;
use super::faults::Fault;
use super::field::Field;
use super::holes::{PatternDocument, SlotDocument};
use super::proportions::check_between;
use crate::declare::{Declared, Number};
use crate::problem::Code;
use crate::units::{Side, from_mm, plain, rounded_inward, to_mm};

impl GearDocument {
    /// Two holes, by their places in the list, or the ends of one slot leave too little between them.
    pub(super) fn overlap_fault(&self, [one, other]: [usize; 2], ligament: f64) -> Fault {
        let holes = &self.blank.holes;
        let missing = self.least_ligament_mm() - to_mm(ligament);
        let detail = self.left("between them", ligament);
        // Drawn holes come last.
        if let Some(by) = self.blank.drawn_by(other) {
            let fault = self.opening_fault(by, Code::HolesOverlap, missing, detail);
            return match self.blank.drawn_by(one) == Some(by) {
                true => fault,
                // Neither is to blame more than the other.
                false => Fault::new(by.field(), fault.code, fault.detail, None),
            };
        }
        let (first, second) = (holes.pattern_of(one), holes.pattern_of(other));
        if first == second {
            return self.overlap_within(first, [one, other], missing, detail);
        }
        // The hole that comes later gives way, or the one before it, or the later one moves to another circle.
        [second, first]
            .into_iter()
            .find_map(|pattern| self.narrower(pattern, missing, Code::HolesOverlap, &detail))
            .unwrap_or_else(|| {
                Fault::new(self.hole_circle(second), Code::HolesOverlap, detail, None)
            })
    }

    /// Holes of one pattern: their ends, their width, or their circle has to give way.
    fn overlap_within(
        &self,
        pattern: usize,
        [one, other]: [usize; 2],
        missing: f64,
        detail: String,
    ) -> Fault {
        let (least, code) = (self.least_ligament_mm(), Code::HolesOverlap);
        let document = &self.blank.holes.patterns()[pattern];
        let width = self.half_width(pattern);
        let apart = self.apart(one, other);
        let circle = document.circle_radius_mm;
        if document.span_deg() > 0.0 {
            let chord = ((2.0 * width + least) / (2.0 * circle)).min(1.0);
            let span = (apart - 2.0 * chord.asin()).to_degrees();
            if span > 0.0 {
                let field = self.hole_field(pattern, "slot/", SlotDocument::angle_deg);
                return Fault::new(field, code, detail, Some((span, Side::AtMost)));
            }
        }
        if let Some(fault) = self.narrower(pattern, missing / 2.0, code, &detail) {
            return fault;
        }
        let needed = (width + least / 2.0) / (apart / 2.0).sin();
        // Holes at one and the same angle find no circle.
        let bound = needed.is_finite().then_some((needed, Side::AtLeast));
        Fault::new(self.hole_circle(pattern), code, detail, bound)
    }

    /// A hole leaves too little below the root circle or around the bore.
    pub(super) fn breach_fault(&self, code: Code, hole: usize, ligament: f64) -> Fault {
        let missing = self.least_ligament_mm() - to_mm(ligament);
        let (place, sign, side) = match code {
            Code::HolesBreachRim => ("below the root circle", -1.0, Side::AtMost),
            _ => ("around the bore", 1.0, Side::AtLeast),
        };
        let detail = self.left(place, ligament);
        if let Some(by) = self.blank.drawn_by(hole) {
            return self.opening_fault(by, code, missing, detail);
        }
        let pattern = self.blank.holes.pattern_of(hole);
        // The width of the holes is to blame, unless none would do: then it is their circle.
        self.narrower(pattern, missing, code, &detail)
            .unwrap_or_else(|| {
                let circle = self.blank.holes.patterns()[pattern].circle_radius_mm;
                let bound = (circle + sign * missing, side);
                Fault::new(self.hole_circle(pattern), code, detail, Some(bound))
            })
    }

    /// A hole reaches over an edge of the web, or of the part that it stands in. All in meters.
    pub(super) fn edge_fault(
        &self,
        hole: usize,
        [from, to]: [f64; 2],
        [inner, outer]: [f64; 2],
    ) -> Fault {
        let code = Code::HoleAcrossEdge;
        let detail = format!(
            "A hole reaches from {} mm to {} mm; it has to lie within {} mm and {} mm, and touch neither edge.",
            plain(to_mm(from)),
            plain(to_mm(to)),
            plain(to_mm(inner)),
            plain(to_mm(outer))
        );
        if let Some(by) = self.blank.drawn_by(hole) {
            return Fault::new(by.field(), code, detail, None);
        }
        let pattern = self.blank.holes.pattern_of(hole);
        let least = from_mm(self.least_ligament_mm());
        let (low, high) = (inner + least, outer - least);
        if to - from > high - low {
            let missing = to_mm((low - from).max(to - high));
            let narrower = self.narrower(pattern, missing, code, &detail);
            return narrower
                .unwrap_or_else(|| Fault::new(self.hole_width(pattern), code, detail, None));
        }
        let circle = self.blank.holes.patterns()[pattern].circle_radius_mm;
        let bound = if from <= inner {
            (circle + to_mm(low - from), Side::AtLeast)
        } else {
            (circle - to_mm(to - high), Side::AtMost)
        };
        Fault::new(self.hole_circle(pattern), code, detail, Some(bound))
    }

    /// That the holes of a pattern are wider by `missing` mm to each side than would do, if holes so narrow can be made.
    fn narrower(&self, pattern: usize, missing: f64, code: Code, detail: &str) -> Option<Fault> {
        let shape = &self.blank.holes.patterns()[pattern];
        let largest = shape.of_half_width(self.half_width(pattern) - missing);
        let field = self.hole_width(pattern);
        let rounded = rounded_inward(largest, Side::AtMost, 0);
        let can_be_made =
            field.accepts(rounded) && rounded >= shape.of_half_width(self.least_hole_mm());
        can_be_made.then(|| {
            let bound = Some((largest, Side::AtMost));
            Fault::new(field, code, detail.to_owned(), bound)
        })
    }

    /// The circle of a pattern.
    fn hole_circle(&self, pattern: usize) -> Field {
        self.hole_field(pattern, "", PatternDocument::circle_radius_mm)
    }

    /// The radius of its holes, or the width of its slots.
    pub(super) fn hole_width(&self, pattern: usize) -> Field {
        let (within, declared) = self.blank.holes.patterns()[pattern].width_field();
        self.hole_field(pattern, within, declared)
    }

    fn hole_field(&self, pattern: usize, within: &str, declared: Declared<Number>) -> Field {
        let folder = self.blank.holes.pointer_within(pattern);
        Field::of(&format!("{folder}/{within}"), declared)
    }

    fn half_width(&self, pattern: usize) -> f64 {
        let shape = &self.blank.holes.patterns()[pattern];
        shape.width() / shape.of_half_width(1.0)
    }

    /// The angle between the middles of two holes, a whole turn for a hole and itself.
    fn apart(&self, one: usize, other: usize) -> f64 {
        use std::f64::consts::TAU;
        if one == other {
            return TAU;
        }
        let holes = self.blank.holes.data();
        let between = (holes[one].angle - holes[other].angle).rem_euclid(TAU);
        between.min(TAU - between)
    }

    /// The web begins in the bore, ends in the rim or before it begins. All in meters.
    pub(super) fn web_fault(&self, [inner, outer]: [f64; 2], [least, largest]: [f64; 2]) -> Fault {
        let detail = format!(
            "The web from {} mm to {} mm has to lie between the bore, {} mm, and the rim, {} mm.",
            plain(to_mm(inner)),
            plain(to_mm(outer)),
            plain(to_mm(least)),
            plain(to_mm(largest))
        );
        let (field, bound) = if inner < least {
            (WebDocument::inner_radius_mm, (to_mm(least), Side::AtLeast))
        } else if outer > largest {
            (WebDocument::outer_radius_mm, (to_mm(largest), Side::AtMost))
        } else {
            let narrowest = to_mm(inner) + self.least_web_mm();
            (WebDocument::outer_radius_mm, (narrowest, Side::AtLeast))
        };
        Fault::new(web(field), Code::WebOutsideBlank, detail, Some(bound))
    }

    /// A web is a ring of some width, away from the bore or up to it, and of some thickness.
    pub(super) fn check_web(&self) -> Result<(), Fault> {
        let Some(WebDocument {
            inner_radius_mm: inner,
            outer_radius_mm: outer,
            thickness_mm,
            ..
        }) = self.blank.web
        else {
            return Ok(());
        };
        let (least, bore) = (self.least_web_mm(), self.blank.core_field().1);
        if inner > bore && inner < (bore + least) * (1.0 - 1e-12) {
            let detail = format!(
                "The web begins {} mm outside of the bore; it begins there, or at least 0.1 modules away.",
                plain(inner - bore)
            );
            let bound = Some((bore + least, Side::AtLeast));
            return Err(Fault::new(
                web(WebDocument::inner_radius_mm),
                Code::OutOfRange,
                detail,
                bound,
            ));
        }
        if outer > inner && outer < (inner + least) * (1.0 - 1e-12) {
            let detail = format!(
                "The web is {} mm wide; at least 0.1 modules.",
                plain(outer - inner)
            );
            let bound = Some((inner + least, Side::AtLeast));
            return Err(Fault::new(
                web(WebDocument::outer_radius_mm),
                Code::OutOfRange,
                detail,
                bound,
            ));
        }
        check_between(
            web(WebDocument::thickness_mm),
            thickness_mm,
            0.01 * self.face_width_mm,
            4.0 * self.face_width_mm,
            "1 % to four times the face width",
        )
    }

    /// The least material around a hole.
    fn least_ligament_mm(&self) -> f64 {
        LEAST_LIGAMENT * self.module_mm
    }

    /// Sentence about the ligament at `place`.
    fn left(&self, place: &str, ligament: f64) -> String {
        if ligament < 0.0 {
            let too_far = plain(to_mm(-ligament));
            return format!("The holes leave nothing {place}: they cut {too_far} mm too far.");
        }
        let (left, least) = (plain(to_mm(ligament)), plain(self.least_ligament_mm()));
        format!(
            "The holes leave {left} mm {place}; at least {LEAST_LIGAMENT} modules, {least} mm, have to stay."
        )
    }

    /// Least width of a web, and of the ring between it and the bore, in mm.
    fn least_web_mm(&self) -> f64 {
        0.1 * self.module_mm
    }
}

/// A number of the web.
fn web(declared: Declared<Number>) -> Field {
    Field::of("blank/web/", declared)
}
