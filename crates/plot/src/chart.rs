//! Curves and stems over a pair of axes.

use super::simplify::simplified;
use super::svg::{Anchor, Paint, Point, Svg};
use super::{Axis, Color, GRID, INK};

/// How far a drawn curve may pass its points, in pixels.
const TOLERANCE: f64 = 0.15;

/// The room for ticks and labels below and beside a chart, in pixels.
const BELOW: f64 = 40.0;
const BESIDE: f64 = 58.0;

/// The margins of a chart in pixels: above it, with its title, to its left and to its right.
const ABOVE: f64 = 25.0;
const LEFT: f64 = 8.0;
const RIGHT: f64 = 18.0;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// A line through the points.
    Line,
    /// A thin line, for curves that are much folded or lie over others.
    ThinLine,
    /// A wide line, for curves that others lie over.
    WideLine,
    /// A stem up from the axis to a dot at each point.
    Stems,
    /// A dot at each point.
    Dots,
    /// A ring at each point.
    Rings,
    /// A cross at each point.
    Crosses,
    /// A filled square, in legends of drawings.
    Patch,
}

/// Named points.
#[derive(Debug, Clone)]
pub struct Series {
    /// The name in the legend; none if empty.
    pub name: String,
    /// The color.
    pub color: Color,
    /// How it is drawn.
    pub look: Look,
    /// The points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A series of points.
    pub fn new(name: &str, color: Color, look: Look, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            color,
            look,
            points,
        }
    }
}

/// A vertical line with a word beside it.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// The word.
    pub name: String,
}

/// Series over a pair of axes.
#[derive(Debug, Clone)]
pub struct Chart {
    /// The title of the panel.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upward.
    pub y: Axis,
    /// What is drawn, in this order.
    pub series: Vec<Series>,
    /// Vertical lines.
    pub marks: Vec<Mark>,
}

/// The frame of a panel: two axes, and where they lie.
pub(crate) struct Frame<'a> {
    axes: (&'a Axis, &'a Axis),
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

impl<'a> Frame<'a> {
    /// That of a panel of this size, with so much room to its `right`.
    pub(crate) fn new(axes: (&'a Axis, &'a Axis), (width, height): (f64, f64), right: f64) -> Self {
        Self {
            axes,
            left: LEFT + BESIDE,
            right: width - right,
            top: ABOVE,
            bottom: height - BELOW,
        }
    }

    /// The place of a point; what lies beyond an end of an axis is put there.
    pub(crate) fn at(&self, (x, y): (f64, f64)) -> Point {
        (self.across(x), self.up(y))
    }

    fn across(&self, x: f64) -> f64 {
        self.left + self.axes.0.fraction(x) * (self.right - self.left)
    }

    fn up(&self, y: f64) -> f64 {
        self.bottom + self.axes.1.fraction(y) * (self.top - self.bottom)
    }

    /// True if both axes contain the point.
    fn shows(&self, (x, y): (f64, f64)) -> bool {
        self.axes.0.shows(x) && self.axes.1.shows(y)
    }

    /// Draws the `title`, both axes with their labels, ticks and names, and a grid.
    pub(crate) fn draw(&self, svg: &mut Svg, title: &str) {
        const LINE: f64 = 0.75;
        const TICK: f64 = 3.0;
        const NAME: f64 = 11.0;
        const LABEL: f64 = 11.5;
        let Self {
            left,
            right,
            top,
            bottom,
            axes,
        } = *self;
        svg.heading(title, (left, 13.0), 12.0);
        let across = axes.0.ticks().iter();
        let across = across.map(|(value, name)| (self.across(*value), name));
        let up = axes.1.ticks().iter();
        let up = up.map(|(value, name)| (self.up(*value), name));
        for (x, _) in across.clone() {
            svg.path([(x, bottom), (x, top)], GRID, LINE);
        }
        for (y, _) in up.clone() {
            svg.path([(left, y), (right, y)], GRID, LINE);
        }
        svg.path([(left, top), (left, bottom), (right, bottom)], INK, LINE);
        for (x, name) in across {
            svg.path([(x, bottom), (x, bottom + TICK)], INK, LINE);
            svg.text(name, (x, bottom + TICK + 8.0), NAME, Anchor::Middle);
        }
        for (y, name) in up {
            svg.path([(left - TICK, y), (left, y)], INK, LINE);
            svg.text(name, (left - TICK - 3.0, y), NAME, Anchor::End);
        }
        let middle = (f64::midpoint(left, right), f64::midpoint(top, bottom));
        svg.text(
            &axes.0.label,
            (middle.0, bottom + BELOW - 10.0),
            LABEL,
            Anchor::Middle,
        );
        svg.upward(&axes.1.label, (LEFT + 6.0, middle.1), LABEL);
    }
}

impl Chart {
    pub(crate) fn draw(&self, svg: &mut Svg, size: (f64, f64)) {
        let frame = Frame::new((&self.x, &self.y), size, RIGHT);
        frame.draw(svg, &self.title);
        for mark in &self.marks {
            let x = frame.across(mark.x);
            svg.path(
                [(x, frame.top), (x, frame.bottom)],
                Color(140, 140, 140),
                1.0,
            );
            svg.text(&mark.name, (x + 4.0, frame.top + 8.0), 11.0, Anchor::Start);
        }
        for series in &self.series {
            draw_series(svg, &frame, series);
        }
    }
}

fn draw_series(svg: &mut Svg, frame: &Frame<'_>, series: &Series) {
    let points = series.points.iter().copied();
    let finite = points.filter(|(x, y)| x.is_finite() && y.is_finite());
    let Some(width) = line_width(series.look) else {
        for point in finite.filter(|point| frame.shows(*point)) {
            let place = frame.at(point);
            if series.look == Look::Stems {
                svg.path([(place.0, frame.bottom), place], series.color, 1.0);
            }
            draw_point(svg, place, series.color, (series.look, 1.0));
        }
        return;
    };
    let places: Vec<Point> = finite.map(|point| frame.at(point)).collect();
    svg.path(simplified(&places, TOLERANCE), series.color, width);
}

/// Draws the mark of a point, by lines of a `width`.
fn draw_point(svg: &mut Svg, place: Point, color: Color, (look, width): (Look, f64)) {
    match look {
        Look::Crosses => svg.cross(place, 3.0, color, width),
        Look::Rings => svg.circle(place, 3.0, Paint::Line(color, width)),
        _ => svg.circle(place, 2.0, Paint::Fill(color)),
    }
}

/// The width of a line in pixels; none for points.
fn line_width(look: Look) -> Option<f64> {
    match look {
        Look::ThinLine => Some(0.75),
        Look::Line => Some(1.25),
        Look::WideLine => Some(2.5),
        Look::Stems | Look::Dots | Look::Rings | Look::Crosses | Look::Patch => None,
    }
}

/// A sample of `look` for a legend, with its middle 12 pixels right of `place`.
pub(crate) fn draw_sample(svg: &mut Svg, (x, y): Point, color: Color, look: Look) {
    match (look, line_width(look)) {
        (_, Some(width)) => svg.path([(x, y), (x + 24.0, y)], color, width),
        (Look::Patch, None) => {
            let corners = [(x + 4.0, y - 6.0), (x + 20.0, y + 6.0)];
            svg.rectangle(corners, Paint::Fill(color));
        }
        (look, None) => draw_point(svg, (x + 12.0, y), color, (look, 1.25)),
    }
}
