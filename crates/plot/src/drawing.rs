//! Shapes to scale, gears as they are cut, and pairs in mesh.

use std::f64::consts::PI;

use meshwright_engine::gear::{
    GearPair, Hole, HoleShape, Member, SpurGear, Vector, radial, tangential,
};

use super::svg::{Paint, Point, Svg};
use super::{Color, INK, Look, WHITE};

/// The points of one flank and of one fillet.
const FLANK_POINTS: u32 = 5;
const FILLET_POINTS: u32 = 4;

/// A shape, in meters.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A filled region with a thin border.
    Region(Vec<Vector>, Color),
    /// A filled disk with a thin border.
    Disk(Vector, f64, Color),
    /// A circle.
    Circle(Vector, f64, Color),
    /// A line.
    Line(Vector, Vector, Color),
}

/// Shapes under a title, in one scale.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// The title of the panel.
    pub title: String,
    /// Corners of the visible part, in meters.
    pub window: (Vector, Vector),
    /// The shapes, each over those before it.
    pub shapes: Vec<Shape>,
    /// Meaning of the fills and the circles.
    pub legend: Vec<(String, Color, Look)>,
}

impl Drawing {
    pub(crate) fn draw(&self, svg: &mut Svg, (width, height): (f64, f64)) {
        const TITLE: f64 = 20.0;
        const LINE: f64 = 1.0;
        svg.heading(&self.title, (12.0, 9.0), 12.0);
        let height = height - TITLE;
        let (low, high) = self.window;
        let scale = (width / (high.x - low.x)).min(height / (high.y - low.y));
        let middle = (low + high) / 2.0;
        let place = |p: Vector| -> Point {
            (
                width / 2.0 + (p.x - middle.x) * scale,
                TITLE + height / 2.0 - (p.y - middle.y) * scale,
            )
        };
        for shape in &self.shapes {
            match shape {
                Shape::Region(points, fill) => {
                    svg.region(points.iter().map(|&p| place(p)), Paint::Bordered(*fill));
                }
                Shape::Disk(center, radius, fill) => {
                    svg.circle(place(*center), radius * scale, Paint::Bordered(*fill));
                }
                Shape::Circle(center, radius, color) => {
                    svg.circle(place(*center), radius * scale, Paint::Line(*color, LINE));
                }
                Shape::Line(from, to, color) => {
                    svg.path([place(*from), place(*to)], *color, LINE);
                }
            }
        }
    }
}

/// Where a gear stands: its center, and the angle of the centerline of tooth 0.
#[derive(Debug, Clone, Copy)]
pub struct Placement {
    /// The center in meters.
    pub center: Vector,
    /// The angle in radians.
    pub angle: f64,
}

/// Where both gears stand at mesh position 0: the centers on the x axis, the loaded flanks of tooth 0 at the pitch point.
pub fn placements(pair: &GearPair) -> [Placement; 2] {
    let half_angle = |member| {
        pair.gear(member)
            .flank()
            .half_angle(pair.working_radius(member))
    };
    [
        Placement {
            center: Vector::zeros(),
            angle: -half_angle(Member::Driving),
        },
        Placement {
            center: Vector::new(pair.center_distance(), 0.0),
            angle: PI - half_angle(Member::Driven),
        },
    ]
}

/// The corners around both gears of a pair, with a margin.
pub fn window(pair: &GearPair) -> (Vector, Vector) {
    let (r_1, r_2) = (pair.driving().tip_radius(), pair.driven().tip_radius());
    let height = 1.04 * r_1.max(r_2);
    let margin = 0.1 * r_2;
    (
        Vector::new(-r_1 - margin, -height),
        Vector::new(pair.center_distance() + r_2 + margin, height),
    )
}

/// The gear with its teeth, web, bore and holes, filled with `fill`.
pub fn gear(gear: &SpurGear, place: Placement, fill: Color) -> Vec<Shape> {
    let mut shapes = vec![Shape::Region(outline(gear, place), fill)];
    shapes.extend(web_edges(gear, place));
    shapes.extend(openings(gear, place));
    shapes
}

/// The two circles between which the blank is not as thick as the face is wide.
fn web_edges(gear: &SpurGear, place: Placement) -> Vec<Shape> {
    let Some(web) = gear.data().blank.web_in(gear.face_width()) else {
        return Vec::new();
    };
    let edge = |radius| Shape::Circle(place.center, radius, INK);
    vec![edge(web.inner_radius), edge(web.outer_radius)]
}

/// The bore and the holes of a gear, and a mark on tooth 0's centerline at the bore.
pub fn openings(gear: &SpurGear, place: Placement) -> Vec<Shape> {
    let mut shapes = vec![Shape::Disk(place.center, gear.bore_radius(), WHITE)];
    shapes.extend(gear.holes().iter().map(|hole| opening(hole, place)));
    let arm = 0.12 * gear.bore_radius();
    for direction in [Vector::x(), Vector::y()] {
        let (from, to) = (
            place.center - arm * direction,
            place.center + arm * direction,
        );
        shapes.push(Shape::Line(from, to, INK));
    }
    shapes
}

/// A hole: a disk, a slot along its circle with round ends, or the inside of its contour.
fn opening(hole: &Hole, place: Placement) -> Shape {
    let at = |angle: f64| place.center + hole.circle_radius * radial(place.angle + angle);
    match hole.shape {
        HoleShape::Round { radius } => Shape::Disk(at(hole.angle), radius, WHITE),
        HoleShape::Contour(_) => {
            // A two-thousandth of the radius is no longer seen.
            let edge = hole.edge(5e-4 * hole.circle_radius).into_iter();
            let (e_x, e_y) = (radial(place.angle), tangential(place.angle));
            let placed = edge.map(|p| place.center + p.x * e_x + p.y * e_y);
            Shape::Region(placed.collect(), WHITE)
        }
        HoleShape::Slot { width, angle } => {
            const POINTS: i32 = 24;
            let half = 0.5 * width;
            let part = |i: i32| f64::from(i) / f64::from(POINTS);
            let along = |radius: f64, t: f64| {
                place.center + radius * radial(place.angle + hole.angle + (t - 0.5) * angle)
            };
            let end = |side: f64, i: i32| {
                let middle = hole.angle + side * 0.5 * angle;
                let turn = side * std::f64::consts::PI * part(i);
                at(middle) + half * radial(place.angle + middle + turn)
            };
            let outer = (0..=POINTS).map(|i| along(hole.circle_radius + half, part(i)));
            let inner = (0..=POINTS)
                .rev()
                .map(|i| along(hole.circle_radius - half, part(i)));
            let far = (0..=POINTS).map(|i| end(1.0, i));
            let near = (0..=POINTS).rev().map(|i| end(-1.0, i));
            Shape::Region(outer.chain(far).chain(inner).chain(near).collect(), WHITE)
        }
    }
}

/// The outline of all teeth: involutes and trochoids as the rack cuts them, tip and root lands.
pub fn outline(gear: &SpurGear, place: Placement) -> Vec<Vector> {
    let half = half_tooth(gear);
    let mirrored = half.iter().rev().map(|p| Vector::new(p.x, -p.y));
    let tooth: Vec<Vector> = mirrored.chain(half.iter().copied()).collect();
    (0..gear.tooth_count())
        .flat_map(|i| {
            let angle = place.angle + f64::from(i) * gear.pitch_angle();
            let (e_r, e_t) = (radial(angle), radial(angle + std::f64::consts::FRAC_PI_2));
            tooth
                .iter()
                .map(move |p| place.center + p.x * e_r + p.y * e_t)
        })
        .collect()
}

/// The loaded half of tooth 0 from its tip corner to the end of its fillet.
fn half_tooth(gear: &SpurGear) -> Vec<Vector> {
    let between =
        |from: f64, to: f64, i: u32, n: u32| from + (to - from) * f64::from(i) / f64::from(n);
    let (tip, form) = (gear.tip_roll_length(), gear.form_roll_length());
    let fillet = gear.fillet();
    let (first, last) = fillet.ends();
    let flank = (0..=FLANK_POINTS).map(|i| gear.flank().point(between(tip, form, i, FLANK_POINTS)));
    flank
        .chain((1..=FILLET_POINTS).map(|i| fillet.point(between(first, last, i, FILLET_POINTS))))
        .collect()
}
