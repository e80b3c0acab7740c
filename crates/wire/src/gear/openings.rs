//! The openings of a blank that are no pattern of holes: those between spokes, and those of an outline.

use meshwright_engine::gear::{
    Contour, ContourFault, Drawn, Hole, Side, Spokes, SpokesFault, Vector,
};
use serde::Serializer;
use serde_json::{Value, json};

use super::faults::Fault;
use super::field::Field;
use super::holes::MOST_HOLES;
use super::proportions::check_between;
use crate::declare::{
    Declared, EACH, Kind, List, Location, Nested, Node, Number, document, list, number, or_else,
    unless,
};
use crate::problem::Code;
use crate::units::{Side as Bound, from_mm, plain, to_mm};

/// The most sides of a loop.
const MOST_SIDES: usize = 200;

/// The most loops of an outline: the openings, the bore and the circle around.
pub(super) const MOST_LOOPS: usize = MOST_HOLES + 2;

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
    /// The coordinates of the points that it names, in mm.
    pub(super) fn coordinates(&self) -> impl Iterator<Item = f64> {
        let points = [self.line_to, self.arc_to, self.through];
        points.into_iter().flatten().flat_map(|point| point.0)
    }

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

/// Openings of a blank that a few numbers draw.
pub(super) trait Shape {
    /// Name of their field within the blank.
    fn name(&self) -> &'static str;

    /// Number of the openings.
    fn count(&self) -> usize;

    /// The openings of the engine.
    ///
    /// # Errors
    ///
    /// The fault of the number to blame, if there are no such openings.
    fn openings(&self) -> Result<Vec<Hole>, Fault>;

    /// Checks the numbers that the engine takes as they are; the radius of the least hole is `least_hole_mm`.
    ///
    /// # Errors
    ///
    /// The fault of a number.
    fn check(&self, least_hole_mm: f64) -> Result<(), Fault>;

    /// The field whose number leaves more material, and the value that leaves `missing` mm more, where `code` says the place.
    fn cure(&self, code: Code, missing: f64) -> (Field, (f64, Bound));
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
}

impl Shape for SpokesDocument {
    fn name(&self) -> &'static str {
        "spokes"
    }

    fn count(&self) -> usize {
        self.count as usize
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

    fn check(&self, least_hole_mm: f64) -> Result<(), Fault> {
        check_between(
            Self::field(Self::fillet_radius_mm),
            self.fillet_radius_mm,
            0.2 * least_hole_mm,
            f64::INFINITY,
            "0.2 % of the root radius and more",
        )
    }

    fn cure(&self, code: Code, missing: f64) -> (Field, (f64, Bound)) {
        let (declared, bound) = match code {
            Code::HolesBreachRim => (
                Self::outer_radius_mm,
                (self.outer_radius_mm - missing, Bound::AtMost),
            ),
            Code::HolesBreachBore => (
                Self::inner_radius_mm,
                (self.inner_radius_mm + missing, Bound::AtLeast),
            ),
            _ => (Self::width_mm, (self.width_mm + missing, Bound::AtLeast)),
        };
        (Self::field(declared), bound)
    }
}

/// The opening bounded by loop `i` of the outline.
pub(super) fn drawn(i: usize, sides: &[SideDocument]) -> Result<Drawn, Fault> {
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

pub(super) fn loop_at(i: usize) -> Field {
    Field::whole(format!("blank/outline/{i}"))
}

pub(super) fn unsound(field: Field, detail: String) -> Fault {
    Fault::new(field, Code::OutlineUnsound, detail, None)
}
