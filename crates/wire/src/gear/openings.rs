//! The openings of a blank that are no pattern of holes: those between spokes, and those of an outline.

use meshwright_engine::gear::printed::last_unit;
use meshwright_engine::gear::{
    Contour, ContourFault, Drawn, Hole, Side, Spokes, SpokesFault, Vector,
};
use serde::Serializer;
use serde_json::{Value, json};

use super::GearDocument;
use super::blank::BlankDocument;
use super::faults::Fault;
use super::field::Field;
use super::holes::MOST_HOLES;
use super::proportions::check_between;
use crate::declare::{
    Declared, EACH, Kind, List, Location, Nested, Node, Number, document, list, number, or_else,
    unless,
};
use crate::problem::{Code, FieldError};
use crate::units::{Side as Bound, from_mm, plain, to_mm};

/// The most sides of a loop.
const MOST_SIDES: usize = 200;

/// The most loops of an outline: the openings, the bore and the circle around.
const MOST_LOOPS: usize = MOST_HOLES + 2;

/// The most sides of all loops together: each place of a grid is looked at from many of them.
const MOST_SIDES_IN_ALL: usize = 1000;

/// The coarsest last decimal of coordinates, in mm, to within which openings are meant as equal: coordinates with fewer decimals are round numbers.
const COARSEST_DECIMAL: f64 = 1e-3;

/// How far the bore of an outline may be from the bore radius, as a part of it: the digits of a drawing.
const DIGITS: f64 = 1e-6;

document! {
    /// Straight spokes of constant width, evenly spaced, that run along the radius from the hub ring to the rim. The openings between them are bounded by the
    /// sides of two neighboring spokes and an arc at each of both radii, with equal fillets in the four corners.
    pub struct SpokesDocument as "Spokes", "Spokes" {
        /// The number of spokes.
        pub(super) count: u32 = number("Number of spokes", "1", 2.0, MOST_HOLES as f64),
        /// The width of a spoke: at least 0.25 modules.
        pub(super) width_mm: f64 = number("Width of a spoke", "mm", 0.05, 25_000.0),
        /// The radius of the fillets at both ends of a spoke: at least 0.2 % of the root radius.
        pub(super) fillet_radius_mm: f64 = number("Radius of the fillets", "mm", 0.01, 12_500.0),
        /// Where the openings begin, which is the radius of the hub ring.
        pub(super) inner_radius_mm: f64 = number("Radius of the hub ring", "mm", 0.1, 25_000.0),
        /// Where the openings end, which is the inner radius of the rim.
        pub(super) outer_radius_mm: f64 = number("Inner radius of the rim", "mm", 0.1, 25_000.0),
        /// The angle of the centerline of spoke 0 from the centerline of tooth 0 of its own gear, positive towards the loaded flank of that tooth.
        phase_deg: f64 = number("Phase of the spokes", "deg", -360.0, 360.0).or(0.0),
    }
}

document! {
    /// A side of a loop, from where the side before it ends: a line, or an arc through a point. The first side begins where the last one ends.
    pub struct SideDocument as "Side", "Side of a loop" {
        /// Where a line ends, in the frame of the gear: the x axis is the centerline of tooth 0, and y is positive on the side of its loaded flank.
        line_to: Option<Point> = or_else(&["arc_to"], "End of the line").left_out(),
        /// Where an arc ends, likewise.
        arc_to: Option<Point> = or_else(&["line_to"], "End of the arc").left_out(),
        /// A point of the arc between its ends.
        through: Option<Point> = unless(&["line_to"], "A point of the arc").left_out(),
    }
}

/// The sides of a loop.
pub(super) const SIDES: List<Nested> = list("", EACH, MOST_SIDES)
    .not_empty(Code::WrongLength, "give its sides")
    .of("sides", "sides", "fit");

/// The loops of an outline.
pub(super) const LOOPS: List<List<Nested>> = list("Outline", SIDES, MOST_LOOPS)
    .not_empty(Code::WrongLength, "give a loop")
    .of("loops", "loops", "fit");

/// A point, in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point([f64; 2]);

/// A coordinate.
const COORDINATE: Number = number("", "mm", -25_000.0, 25_000.0);

impl Kind for Point {
    /// Its description.
    type Spec = &'static str;

    fn read(node: &Node, place: &Location<'_>, _: &Self::Spec) -> Option<Self> {
        let Node::List(nodes) = node else {
            return place.wrong_kind(node, "a list of two numbers");
        };
        let [x, y] = nodes.as_slice() else {
            let detail = format!("{place} has {} numbers; a point has two.", nodes.len());
            return place.wrong(Code::WrongLength, detail, Some(2.0));
        };
        let [x, y] =
            [("0", x), ("1", y)].map(|(i, node)| f64::read(node, &place.of(i), &COORDINATE));
        Some(Self([x?, y?]))
    }

    fn write<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_vec().write(serializer)
    }

    fn describe(about: &str, title: &Self::Spec) -> Value {
        let coordinate = f64::describe("", &COORDINATE);
        json!({ "type": "array", "title": title, "description": format!("{about} Unit: mm."), "x-unit": "mm", "items": coordinate, "minItems": 2, "maxItems": 2 })
    }
}

impl Point {
    fn vector(self) -> Vector {
        Vector::from(self.0.map(from_mm))
    }
}

impl SideDocument {
    fn end(&self) -> Vector {
        let end = self.line_to.or(self.arc_to);
        end.map_or_else(Vector::zeros, Point::vector)
    }

    /// The side that begins at `from`.
    fn side(&self, from: Vector) -> Option<Side> {
        match self.through {
            Some(through) => Side::through(from, through.vector(), self.end()),
            None => Some(Side::new(from, self.end(), 0.0)),
        }
    }
}

impl SpokesDocument {
    fn data(&self) -> Spokes {
        Spokes {
            count: self.count,
            width: from_mm(self.width_mm),
            fillet_radius: from_mm(self.fillet_radius_mm),
            inner_radius: from_mm(self.inner_radius_mm),
            outer_radius: from_mm(self.outer_radius_mm),
            phase: self.phase_deg.to_radians(),
        }
    }

    fn field(declared: Declared<Number>) -> Field {
        Field::of("blank/spokes/", declared)
    }

    fn openings(&self) -> Result<Vec<Hole>, Fault> {
        self.data().openings().map_err(|fault| match fault {
            SpokesFault::TooFew => Fault::new(
                Self::field(Self::count),
                Code::OutOfRange,
                "There are at least two spokes.".to_owned(),
                Some((2.0, Bound::AtLeast)),
            ),
            SpokesFault::NoLength => Fault::new(
                Self::field(Self::outer_radius_mm),
                Code::SpokesDoNotFit,
                format!(
                    "The rim begins at {} mm, and the hub ring ends at {} mm; spokes have a length.",
                    plain(self.outer_radius_mm),
                    plain(self.inner_radius_mm)
                ),
                Some((
                    self.inner_radius_mm + 2.0 * self.fillet_radius_mm,
                    Bound::AtLeast,
                )),
            ),
            SpokesFault::Overlap { largest_width } => Fault::new(
                Self::field(Self::width_mm),
                Code::SpokesDoNotFit,
                format!(
                    "{} spokes of {} mm overlap at the hub ring, whose radius is {} mm; they are narrower than {} mm.",
                    self.count,
                    plain(self.width_mm),
                    plain(self.inner_radius_mm),
                    plain(to_mm(largest_width))
                ),
                // Narrower, so that the fillets stand side by side.
                Some((
                    to_mm(largest_width) - 2.0 * self.fillet_radius_mm,
                    Bound::AtMost,
                )),
            ),
            SpokesFault::FilletsDoNotFit { largest_radius } => Fault::new(
                Self::field(Self::fillet_radius_mm),
                Code::SpokesDoNotFit,
                format!(
                    "Fillets of {} mm do not fit into the openings; at most {} mm.",
                    plain(self.fillet_radius_mm),
                    plain(to_mm(largest_radius))
                ),
                Some((to_mm(largest_radius), Bound::AtMost)),
            ),
        })
    }
}

/// The openings of an outline, each with the place of its loop.
type Openings = Vec<(usize, Hole)>;

impl BlankDocument {
    /// The openings of the spokes, then those of the outline.
    ///
    /// # Errors
    ///
    /// The openings of the engine, or the fault of one.
    pub(super) fn openings(&self) -> Result<Vec<Hole>, Fault> {
        let mut openings = match &self.spokes {
            Some(spokes) => spokes.openings()?,
            None => Vec::new(),
        };
        openings.extend(self.outlined()?.into_iter().map(|(_, hole)| hole));
        Ok(openings)
    }

    /// The last decimal of the coordinates of the outline, in meters: that of the coordinate that has most decimals.
    pub(super) fn last_decimal(&self) -> f64 {
        let sides = self.outline.iter().flatten().flatten();
        let points = sides.flat_map(|side| [side.line_to, side.arc_to, side.through]);
        let coordinates = points.flatten().flat_map(|point| point.0);
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

    /// The number of spokes, which is that of the openings between them.
    fn spoke_count(&self) -> usize {
        let spokes = self.spokes.as_ref();
        spokes.map_or(0, |spokes| spokes.count as usize)
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
        let count =
            self.holes.count() + self.spoke_count() + loops.saturating_sub(MOST_LOOPS - MOST_HOLES);
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
        let index = hole.checked_sub(self.holes.count())?;
        let Some(index) = index.checked_sub(self.spoke_count()) else {
            return Some(DrawnBy::Spokes);
        };
        let outlined = self.outlined().ok()?;
        outlined.get(index).map(|(i, _)| DrawnBy::Loop(*i))
    }
}

/// Source of an opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DrawnBy {
    Spokes,
    Loop(usize),
}

impl GearDocument {
    /// Spokes and outlines whose openings exist and are no mere points.
    pub(super) fn check_openings(&self) -> Result<(), Fault> {
        let blank = &self.blank;
        let openings = blank.openings()?;
        if let Some(spokes) = &blank.spokes {
            check_between(
                SpokesDocument::field(SpokesDocument::fillet_radius_mm),
                spokes.fillet_radius_mm,
                0.2 * self.least_hole_mm(),
                f64::INFINITY,
                "0.2 % of the root radius and more",
            )?;
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

    /// An opening of spokes or of an outline leaves too little between it and another one, the rim or the bore.
    pub(super) fn opening_fault(
        &self,
        by: DrawnBy,
        code: Code,
        missing: f64,
        detail: String,
    ) -> Fault {
        let (DrawnBy::Spokes, Some(spokes)) = (by, &self.blank.spokes) else {
            return Fault::new(by.field(), code, detail, None);
        };
        let (declared, bound) = match code {
            Code::HolesBreachRim => (
                SpokesDocument::outer_radius_mm,
                (spokes.outer_radius_mm - missing, Bound::AtMost),
            ),
            Code::HolesBreachBore => (
                SpokesDocument::inner_radius_mm,
                (spokes.inner_radius_mm + missing, Bound::AtLeast),
            ),
            _ => (
                SpokesDocument::width_mm,
                (spokes.width_mm + missing, Bound::AtLeast),
            ),
        };
        Fault::new(SpokesDocument::field(declared), code, detail, Some(bound))
    }
}

impl DrawnBy {
    /// Where it stands.
    pub(super) fn field(self) -> Field {
        match self {
            Self::Spokes => Field::whole("blank/spokes".to_owned()),
            Self::Loop(i) => loop_at(i),
        }
    }
}

/// The opening bounded by loop `i` of the outline.
fn drawn(i: usize, sides: &[SideDocument]) -> Result<Drawn, Fault> {
    let mut from = sides.last().map_or_else(Vector::zeros, SideDocument::end);
    let mut found = Vec::new();
    let at = |k: usize| Field::whole(format!("blank/outline/{i}/{k}"));
    for (k, side) in sides.iter().enumerate() {
        let Some(side) = side.side(from) else {
            let detail = format!(
                "Side {k} of loop {i} is no arc: its ends and the point between them lie on a line, or on each other."
            );
            return Err(unsound(at(k), detail));
        };
        from = side.to;
        found.push(side);
    }
    Contour::drawn(&found).map_err(|fault| match fault {
        ContourFault::NoLength { side } => {
            unsound(at(side), format!("Side {side} of loop {i} ends where it begins."))
        }
        ContourFault::TooFew => {
            unsound(loop_at(i), format!("Loop {i} has too few sides to enclose anything."))
        }
        ContourFault::Crosses { sides: [a, b] } => {
            unsound(at(b), format!("Sides {a} and {b} of loop {i} cross or touch each other."))
        }
        ContourFault::TooSharp { corner } => unsound(
            at(corner),
            format!("The corner of loop {i} where side {corner} begins is too sharp: the material has at least 30 degrees there, and the opening 10."),
        ),
        ContourFault::Clockwise => unsound(
            loop_at(i),
            format!("Loop {i} runs counter-clockwise, which is for material, and is no circle about the axis; the loop of an opening runs clockwise."),
        ),
        ContourFault::AroundAxis => unsound(
            loop_at(i),
            format!("Loop {i} runs around the axis; a bore is a circle about it."),
        ),
    })
}

fn loop_at(i: usize) -> Field {
    Field::whole(format!("blank/outline/{i}"))
}

fn unsound(field: Field, detail: String) -> Fault {
    Fault::new(field, Code::OutlineUnsound, detail, None)
}
