//! The openings of a blank beside its holes, as the engine has them, and their faults.

use meshwright_engine::gear::printed::last_unit;
use meshwright_engine::gear::{Drawn, Hole};

use super::GearDocument;
use super::blank::BlankDocument;
use super::faults::Fault;
use super::field::Field;
use super::holes::MOST_HOLES;
use super::openings::{MOST_LOOPS, Shape, SideDocument, drawn, loop_at, unsound};
use crate::problem::{Code, FieldError};
use crate::units::{from_mm, plain, to_mm};

/// The most sides of all loops together: each place of a grid is looked at from many of them.
const MOST_SIDES_IN_ALL: usize = 1000;

/// The coarsest last decimal of coordinates, in mm, to within which openings are meant as equal: coordinates with fewer decimals are round numbers.
const COARSEST_DECIMAL: f64 = 1e-3;

/// How far the bore of an outline may be from the bore radius, as a part of it: the digits of a drawing.
const DIGITS: f64 = 1e-6;

/// The openings of an outline, each with the place of its loop.
type Openings = Vec<(usize, Hole)>;

impl BlankDocument {
    /// The openings of each shape, then those of the outline.
    ///
    /// # Errors
    ///
    /// The openings of the engine, or the fault of one.
    pub(super) fn openings(&self) -> Result<Vec<Hole>, Fault> {
        let mut openings = Vec::new();
        for shape in self.shapes() {
            openings.extend(shape.openings()?);
        }
        openings.extend(self.outlined()?.into_iter().map(|(_, hole)| hole));
        Ok(openings)
    }

    /// The last decimal of the coordinates of the outline, in meters: that of the coordinate that has most decimals.
    pub(super) fn last_decimal(&self) -> f64 {
        let sides = self.outline.iter().flatten().flatten();
        let coordinates = sides.flat_map(SideDocument::coordinates);
        from_mm(coordinates.map(last_unit).fold(COARSEST_DECIMAL, f64::min))
    }

    /// The openings of the outline.
    fn outlined(&self) -> Result<Openings, Fault> {
        let mut openings = Openings::new();
        let (mut bore, mut around) = (None, None);
        for (i, sides) in self.outline.iter().flatten().enumerate() {
            let drawn = drawn(i, sides)?;
            let known = match drawn {
                Drawn::Opening(hole) => {
                    openings.push((i, hole));
                    continue;
                }
                Drawn::Circle { radius, is_inside } => {
                    let known = if is_inside { &mut around } else { &mut bore };
                    known.replace((i, radius))
                }
            };
            if let Some((first, _)) = known {
                let detail = format!(
                    "Loop {i} is a circle about the axis, as loop {first} is; there is one bore, and one circle around."
                );
                return Err(unsound(loop_at(i), detail));
            }
        }
        if let Some((i, radius)) = bore {
            let (_, core) = self.core_field();
            let said = match self.shaft {
                Some(_) => Some("the gear is cut on its shaft, and has no bore".to_owned()),
                None if (to_mm(radius) - core).abs() > DIGITS * core => {
                    Some(format!("blank/bore_radius_mm is {}", plain(core)))
                }
                None => None,
            };
            if let Some(said) = said {
                let detail = format!(
                    "Loop {i} is a bore with the radius {} mm, but {said}.",
                    plain(to_mm(radius))
                );
                return Err(unsound(loop_at(i), detail));
            }
        }
        if let Some((i, radius)) = around
            && let Some((k, _)) = openings
                .iter()
                .find(|(_, hole)| hole.outer_reach() >= radius)
        {
            let detail =
                format!("Loop {i} is the circle around the blank, and loop {k} reaches beyond it.");
            return Err(unsound(loop_at(i), detail));
        }
        Ok(openings)
    }

    /// That there are more holes and openings than a blank may have, or more sides of these.
    pub(super) fn too_many(&self, pointer: &str) -> Option<FieldError> {
        let sides: usize = self.outline.iter().flatten().map(Vec::len).sum();
        if sides > MOST_SIDES_IN_ALL {
            let pointer = format!("{pointer}/blank/outline");
            let detail = format!(
                "{pointer} has {sides} sides; its loops have at most {MOST_SIDES_IN_ALL} together. An arc stands for many lines."
            );
            return Some(FieldError::new(pointer, Code::TooLarge, detail));
        }
        let loops = self.outline.as_ref().map_or(0, Vec::len);
        let of_shapes: usize = self.shapes().map(Shape::count).sum();
        let count = self.holes.count() + of_shapes + loops.saturating_sub(MOST_LOOPS - MOST_HOLES);
        if count <= MOST_HOLES {
            return None;
        }
        let pointer = match self.holes.count() {
            0 => format!("{pointer}/blank"),
            _ => format!("{pointer}/blank/holes"),
        };
        let detail = format!("{pointer} has {count} holes; a blank has at most {MOST_HOLES}.");
        Some(FieldError::new(pointer, Code::TooLarge, detail))
    }

    /// The source of the opening that the engine knows as `hole`; `None` if that is one of a pattern.
    pub(super) fn drawn_by(&self, hole: usize) -> Option<DrawnBy> {
        let mut index = hole.checked_sub(self.holes.count())?;
        for shape in self.shapes() {
            let Some(behind) = index.checked_sub(shape.count()) else {
                return Some(DrawnBy::Shape(shape.name()));
            };
            index = behind;
        }
        let outlined = self.outlined().ok()?;
        outlined.get(index).map(|(i, _)| DrawnBy::Loop(*i))
    }
}

/// Source of an opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DrawnBy {
    /// A shape, by the name of its field within the blank.
    Shape(&'static str),
    /// A loop of the outline, by its place.
    Loop(usize),
}

impl GearDocument {
    /// Shapes and outlines whose openings exist and are no mere points.
    pub(super) fn check_openings(&self) -> Result<(), Fault> {
        let blank = &self.blank;
        let openings = blank.openings()?;
        for shape in blank.shapes() {
            shape.check(self.least_hole_mm())?;
        }
        let holes = blank.holes.count();
        let small = |hole: &Hole| to_mm(hole.half_width()) < self.least_hole_mm();
        match openings.iter().position(small) {
            None => Ok(()),
            Some(i) => {
                let field = blank
                    .drawn_by(holes + i)
                    .map_or_else(|| loop_at(0), DrawnBy::field);
                let detail = "An opening is smaller than 1 % of the root radius to each side.";
                Err(unsound(field, detail.to_owned()))
            }
        }
    }

    /// An opening of a shape or of an outline leaves too little between it and another one, the rim or the bore.
    pub(super) fn opening_fault(
        &self,
        by: DrawnBy,
        code: Code,
        missing: f64,
        detail: String,
    ) -> Fault {
        let mut shapes = self.blank.shapes();
        match shapes.find(|shape| by == DrawnBy::Shape(shape.name())) {
            Some(shape) => {
                let (field, bound) = shape.cure(code, missing);
                Fault::new(field, code, detail, Some(bound))
            }
            None => Fault::new(by.field(), code, detail, None),
        }
    }
}

impl DrawnBy {
    /// Where it stands.
    pub(super) fn field(self) -> Field {
        match self {
            Self::Shape(name) => Field::whole(format!("blank/{name}")),
            Self::Loop(i) => loop_at(i),
        }
    }
}
