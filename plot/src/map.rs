//! A field over a pair of axes, told by color.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{Area, Axis, INK, at, chart, write};

/// The room for the scale of colors to the right, in pixels.
const SCALE: u32 = 84;

/// Colors that are told apart; neighbors that have the same are one rectangle.
const SHADES: u32 = 32;

/// From nothing to the most: rising in darkness, so that it reads in gray and to those who do not see red and green.
const RAMP: [RGBColor; 6] = [
    RGBColor(255, 247, 214),
    RGBColor(254, 217, 142),
    RGBColor(247, 162, 80),
    RGBColor(222, 95, 54),
    RGBColor(160, 38, 61),
    RGBColor(78, 14, 60),
];

/// What has no value to tell.
pub const BEYOND: RGBColor = RGBColor(0, 114, 178);

/// The value of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// Nothing is there.
    Empty,
    /// A value of the scale.
    Value(f64),
    /// More than any scale has.
    Beyond,
}

/// Equal cells that fill both axes, row by row from below.
#[derive(Debug, Clone)]
pub struct Map {
    /// The title of the panel.
    pub title: String,
    /// The axis to the right, and where it begins and ends.
    pub x: (Axis, [f64; 2]),
    /// The axis upward.
    pub y: (Axis, [f64; 2]),
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
    /// The scale of colors, with its label.
    pub scale: Axis,
    /// What is told of cells beyond it.
    pub beyond: String,
}

impl Map {
    pub(crate) fn draw(&self, area: &Area<'_>, size: (u32, u32)) -> anyhow::Result<()> {
        let (_, height) = size;
        let mut context = chart::framed(area, &self.title, (&self.x.0, &self.y.0), SCALE)?;
        let place = |(low, high): (f64, f64), i: usize, count: usize| {
            low + (high - low) * i as f64 / count as f64
        };
        for (r, row) in self.rows.iter().enumerate() {
            let [y_low, y_high] = self.y.1;
            let ends = [r, r + 1].map(|i| place((y_low, y_high), i, self.rows.len()));
            let mut from = 0;
            for run in row.chunk_by(|one, next| self.color(*one) == self.color(*next)) {
                let to = from + run.len();
                if let Some(color) = self.color(run[0]) {
                    let [x_low, x_high] = self.x.1;
                    let sides = [from, to].map(|i| place((x_low, x_high), i, row.len()));
                    let corners = [(sides[0], ends[0]), (sides[1], ends[1])];
                    context.draw_series([Rectangle::new(corners, color.filled())])?;
                }
                from = to;
            }
        }
        self.draw_scale(area, (f64::from(size.0 - SCALE) + 4.0, f64::from(height)))
    }

    /// What stands for cells beyond the scale, if there are any.
    pub(crate) fn legend(&self) -> Option<(&str, RGBColor)> {
        let any = self.rows.iter().flatten().any(|cell| *cell == Cell::Beyond);
        any.then_some((&self.beyond, BEYOND))
    }

    /// The color of a cell, if it has any.
    fn color(&self, cell: Cell) -> Option<RGBColor> {
        match cell {
            Cell::Empty => None,
            Cell::Beyond => Some(BEYOND),
            Cell::Value(value) => {
                let shade = (self.scale.fraction(value) * f64::from(SHADES)).floor();
                Some(shaded(
                    shade.min(f64::from(SHADES - 1)) / f64::from(SHADES - 1),
                ))
            }
        }
    }

    fn draw_scale(&self, area: &Area<'_>, (left, height): (f64, f64)) -> anyhow::Result<()> {
        let (top, bottom, width) = (chart::top(), height - chart::bottom(), 14.0);
        let level = |part: f64| bottom + (top - bottom) * part;
        for shade in 0..SHADES {
            let part = |shade: u32| f64::from(shade) / f64::from(SHADES);
            let color = shaded(f64::from(shade) / f64::from(SHADES - 1));
            let corners = [
                at(left, level(part(shade + 1))),
                at(left + width, level(part(shade))),
            ];
            area.draw(&Rectangle::new(corners, color.filled()))?;
        }
        let frame = [at(left, top), at(left + width, bottom)];
        area.draw(&Rectangle::new(frame, INK.stroke_width(2)))?;
        for (value, name) in self.scale.ticks() {
            let place = (left + width + 5.0, level(self.scale.fraction(*value)));
            write(area, name, place, 11.0, (HPos::Left, false))?;
        }
        let label = (left, top - 12.0);
        write(area, &self.scale.label, label, 11.0, (HPos::Left, false))
    }
}

/// The color at `part` of the ramp.
fn shaded(part: f64) -> RGBColor {
    let place = part.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let first = (place as usize).min(RAMP.len() - 2);
    let (one, next, rest) = (RAMP[first], RAMP[first + 1], place - first as f64);
    let mixed = |one: u8, next: u8| {
        (f64::from(one) + rest * (f64::from(next) - f64::from(one))).round() as u8
    };
    RGBColor(
        mixed(one.0, next.0),
        mixed(one.1, next.1),
        mixed(one.2, next.2),
    )
}
