//! Curves and stems over a pair of axes.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::simplify::simplified;
use super::{Area, Axis, DETAIL, GRID, INK, at, font, thickness, units, write};

/// How far a drawn curve may pass its points, in pixels.
const TOLERANCE: f64 = 0.15;

/// The room for ticks and labels below and beside a chart, in pixels.
const BELOW: u32 = 40;
const BESIDE: u32 = 58;

/// The margins of a chart in pixels: above it, with its title, to its left and to its right.
const ABOVE: u32 = 25;
const LEFT: u32 = 8;
const RIGHT: u32 = 18;

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
    pub color: RGBColor,
    /// How it is drawn.
    pub look: Look,
    /// The points, in the units of the axes.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A series of points.
    pub fn new(name: &str, color: RGBColor, look: Look, points: Vec<(f64, f64)>) -> Self {
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

pub(crate) type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// Where the frame of a panel begins below its top, and ends above its bottom, in pixels.
pub(crate) fn top() -> f64 {
    f64::from(ABOVE)
}

pub(crate) fn bottom() -> f64 {
    f64::from(BELOW)
}

/// A panel with its title, its axes and so much room to the `right`.
pub(crate) fn framed<'a, 'b>(
    area: &'a Area<'b>,
    title: &str,
    (x, y): (&Axis, &Axis),
    right: u32,
) -> anyhow::Result<Context<'a, 'b>> {
    let start = f64::from(LEFT + BESIDE);
    write(area, title, (start, 13.0), 12.0, (HPos::Left, true))?;
    let mut context = ChartBuilder::on(area)
        .margin_top(units(ABOVE))
        .margin_left(units(LEFT))
        .margin_right(units(right))
        .x_label_area_size(units(BELOW))
        .y_label_area_size(units(BESIDE))
        .build_cartesian_2d(x.clone(), y.clone())?;
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(thickness(0.75)))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(thickness(0.75)))
        .set_all_tick_mark_size(units(3))
        .label_style(font(11.0))
        .axis_desc_style(font(11.5))
        .x_desc(&x.label)
        .y_desc(&y.label)
        .draw()?;
    Ok(context)
}

impl Chart {
    pub(crate) fn draw(&self, area: &Area<'_>, size: (u32, u32)) -> anyhow::Result<()> {
        let mut context = framed(area, &self.title, (&self.x, &self.y), RIGHT)?;
        for mark in &self.marks {
            self.draw_mark(&mut context, mark)?;
        }
        let frame = (
            f64::from(size.0 - LEFT - BESIDE - RIGHT),
            f64::from(size.1 - BELOW - ABOVE),
        );
        for series in &self.series {
            self.draw_series(&mut context, series, frame)?;
        }
        Ok(())
    }

    fn draw_mark(&self, context: &mut Context<'_, '_>, mark: &Mark) -> anyhow::Result<()> {
        let (x, low, high) = (mark.x, self.y.low(), self.y.high());
        let style = RGBColor(140, 140, 140).stroke_width(thickness(1.0));
        context.draw_series([PathElement::new([(x, low), (x, high)], style)])?;
        let label =
            EmptyElement::at((x, high)) + Text::new(mark.name.clone(), at(4.0, 3.0), font(11.0));
        context.draw_series([label])?;
        Ok(())
    }

    fn draw_series(
        &self,
        context: &mut Context<'_, '_>,
        series: &Series,
        frame: (f64, f64),
    ) -> anyhow::Result<()> {
        let finite = series
            .points
            .iter()
            .copied()
            .filter(|(x, y)| x.is_finite() && y.is_finite());
        match (series.look, line_width(series.look)) {
            (_, Some(width)) => {
                let path = self.path(finite, frame);
                let style = series.color.stroke_width(thickness(width));
                context.draw_series([PathElement::new(path, style)])?;
            }
            (look, None) => {
                let inside = finite.filter(|&(x, y)| self.x.shows(x) && self.y.shows(y));
                for point in inside {
                    self.draw_point(context, point, series.color, look)?;
                }
            }
        }
        Ok(())
    }

    /// The path of a line, simplified in pixels.
    fn path(
        &self,
        points: impl Iterator<Item = (f64, f64)>,
        (width, height): (f64, f64),
    ) -> Vec<(f64, f64)> {
        let pixels: Vec<(f64, f64)> = points
            .map(|(x, y)| (self.x.fraction(x) * width, self.y.fraction(y) * height))
            .collect();
        simplified(&pixels, TOLERANCE)
            .into_iter()
            .map(|(u, v)| (self.x.value(u / width), self.y.value(v / height)))
            .collect()
    }

    fn draw_point(
        &self,
        context: &mut Context<'_, '_>,
        point: (f64, f64),
        color: RGBColor,
        look: Look,
    ) -> anyhow::Result<()> {
        let line = color.stroke_width(thickness(1.0));
        if look == Look::Stems {
            let foot = (point.0, self.y.low());
            context.draw_series([PathElement::new([foot, point], line)])?;
        }
        let radius = DETAIL as i32;
        match look {
            Look::Crosses => context
                .draw_series([Cross::new(point, 3 * radius, line)])
                .map(|_| ())?,
            Look::Rings => context
                .draw_series([Circle::new(point, 3 * radius, line)])
                .map(|_| ())?,
            _ => context
                .draw_series([Circle::new(point, 2 * radius, color.filled())])
                .map(|_| ())?,
        }
        Ok(())
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
pub(crate) fn draw_sample(
    area: &Area<'_>,
    (x, y): (f64, f64),
    color: RGBColor,
    look: Look,
) -> anyhow::Result<()> {
    let middle = at(x + 12.0, y);
    let radius = DETAIL as i32;
    let line = color.stroke_width(thickness(line_width(look).unwrap_or(1.25)));
    match look {
        Look::Line | Look::ThinLine | Look::WideLine => {
            area.draw(&PathElement::new([at(x, y), at(x + 24.0, y)], line))?
        }
        Look::Crosses => area.draw(&Cross::new(middle, 3 * radius, line))?,
        Look::Rings => area.draw(&Circle::new(middle, 3 * radius, line))?,
        Look::Patch => {
            let corners = [at(x + 4.0, y - 6.0), at(x + 20.0, y + 6.0)];
            area.draw(&Rectangle::new(corners, color.filled()))?;
        }
        Look::Dots | Look::Stems => area.draw(&Circle::new(middle, 2 * radius, color.filled()))?,
    }
    Ok(())
}
