//! A field over a pair of axes, told by color.

use super::chart::Frame;
use super::svg::{Anchor, Paint, Svg};
use super::{Axis, Color, INK};

/// The room for the scale of colors to the right, in pixels.
const SCALE: f64 = 84.0;

/// Colors that are told apart; neighbors that have the same are one rectangle.
const SHADES: u32 = 32;

/// From nothing to the most: rising in darkness, so that it reads in gray and to those who do not see red and green.
const RAMP: [Color; 6] = [
    Color(255, 247, 214),
    Color(254, 217, 142),
    Color(247, 162, 80),
    Color(222, 95, 54),
    Color(160, 38, 61),
    Color(78, 14, 60),
];

/// Color of cells without a value.
pub const BEYOND: Color = Color(0, 114, 178);

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
    /// Label of cells beyond it.
    pub beyond: String,
}

impl Map {
    pub(crate) fn draw(&self, svg: &mut Svg, size: (f64, f64)) {
        let frame = Frame::new((&self.x.0, &self.y.0), size, SCALE);
        frame.draw(svg, &self.title);
        let place = |[low, high]: [f64; 2], i: usize, count: usize| {
            low + (high - low) * i as f64 / count as f64
        };
        for (r, row) in self.rows.iter().enumerate() {
            let ends = [r, r + 1].map(|i| place(self.y.1, i, self.rows.len()));
            let mut from = 0;
            for run in row.chunk_by(|one, next| self.color(*one) == self.color(*next)) {
                let to = from + run.len();
                if let Some(color) = self.color(run[0]) {
                    let sides = [from, to].map(|i| place(self.x.1, i, row.len()));
                    let corners = [(sides[0], ends[0]), (sides[1], ends[1])];
                    svg.rectangle(corners.map(|corner| frame.at(corner)), Paint::Fill(color));
                }
                from = to;
            }
        }
        self.draw_scale(svg, &frame);
    }

    /// Legend of cells beyond the scale, if there are any.
    pub(crate) fn legend(&self) -> Option<(&str, Color)> {
        let any = self.rows.iter().flatten().any(|cell| *cell == Cell::Beyond);
        any.then_some((&self.beyond, BEYOND))
    }

    /// The color of a cell, if it has any.
    fn color(&self, cell: Cell) -> Option<Color> {
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

    /// The scale of colors, to the right of the frame.
    fn draw_scale(&self, svg: &mut Svg, frame: &Frame<'_>) {
        let (left, width) = (frame.right + 4.0, 14.0);
        let level = |part: f64| frame.bottom + (frame.top - frame.bottom) * part;
        for shade in 0..SHADES {
            let part = |shade: u32| f64::from(shade) / f64::from(SHADES);
            let color = shaded(f64::from(shade) / f64::from(SHADES - 1));
            let corners = [
                (left, level(part(shade + 1))),
                (left + width, level(part(shade))),
            ];
            svg.rectangle(corners, Paint::Fill(color));
        }
        let corners = [(left, frame.top), (left + width, frame.bottom)];
        svg.rectangle(corners, Paint::Line(INK, 0.5));
        for (value, name) in self.scale.ticks() {
            let place = (left + width + 5.0, level(self.scale.fraction(*value)));
            svg.text(name, place, 11.0, Anchor::Start);
        }
        svg.text(
            &self.scale.label,
            (left, frame.top - 12.0),
            11.0,
            Anchor::Start,
        );
    }
}

/// The color at `part` of the ramp.
fn shaded(part: f64) -> Color {
    let place = part.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let first = (place as usize).min(RAMP.len() - 2);
    let (one, next, rest) = (RAMP[first], RAMP[first + 1], place - first as f64);
    let mixed = |one: u8, next: u8| {
        (f64::from(one) + rest * (f64::from(next) - f64::from(one))).round() as u8
    };
    Color(
        mixed(one.0, next.0),
        mixed(one.1, next.1),
        mixed(one.2, next.2),
    )
}
