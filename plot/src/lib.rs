//! Figures as SVG: charts of named series, order spectra, and drawings of gears.
//!
//! Read in this order: [`axis`], [`chart`] (curves and stems), [`drawing`] (shapes, and the true outline of a gear), [`map`] (fields by color),
//! `simplify` (what keeps the files small). Nothing here knows what the figures are about.

pub mod axis;
pub mod chart;
pub mod drawing;
pub mod map;
mod simplify;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use axis::Axis;
pub use plotters::style::{RGBColor, WHITE};

pub use chart::{Chart, Look, Mark, Series};
pub use drawing::{Drawing, Shape};
pub use map::Map;

/// Units of a figure per pixel: plotters rounds to whole units, and a curve wants quarters of a pixel.
const DETAIL: u32 = 4;

/// Lettering and frames.
pub const INK: RGBColor = RGBColor(38, 38, 38);
/// Grid lines.
const GRID: RGBColor = RGBColor(226, 226, 226);
/// The colors of series, alike in all figures and told apart by readers who do not see red and green.
pub const PALETTE: [RGBColor; 7] = [
    RGBColor(38, 38, 38),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 145, 105),
    RGBColor(180, 80, 140),
    RGBColor(210, 145, 0),
    RGBColor(70, 165, 215),
];

/// The height of the figure's title and of its legend, in pixels.
const HEAD: u32 = 26;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// One panel of a figure.
pub enum Panel {
    /// Curves or stems over axes.
    Chart(Chart),
    /// Shapes to scale.
    Drawing(Drawing),
    /// A field by color over axes.
    Map(Map),
}

/// Panels in rows under one title and one legend.
pub struct Figure {
    /// The title.
    pub title: String,
    /// Panels in a row.
    pub columns: u32,
    /// Width and height of a panel in pixels.
    pub panel_size: (u32, u32),
    /// The panels, row by row.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// The figure as an SVG document.
    ///
    /// # Errors
    ///
    /// If the drawing library fails; with a string to write to, it has no reason to.
    pub fn to_svg(&self) -> anyhow::Result<String> {
        let (width, height) = self.panel_size;
        let columns = self.columns.max(1);
        let rows = (self.panels.len() as u32).div_ceil(columns);
        let legend = self.legend();
        let head = if legend.is_empty() { HEAD } else { 2 * HEAD };
        let size = (columns * width, rows * height + head);
        let mut svg = String::new();
        {
            let canvas = (size.0 * DETAIL, size.1 * DETAIL);
            let root = SVGBackend::with_string(&mut svg, canvas).into_drawing_area();
            root.fill(&WHITE)?;
            write(&root, &self.title, (10.0, 15.0), 15.0, (HPos::Left, true))?;
            draw_legend(&root, &legend)?;
            for (i, panel) in (0..).zip(&self.panels) {
                let corner = (i % columns * width, i / columns * height + head);
                let area = root.clone().shrink(
                    (units(corner.0), units(corner.1)),
                    (units(width), units(height)),
                );
                match panel {
                    Panel::Chart(chart) => chart.draw(&area, self.panel_size)?,
                    Panel::Drawing(drawing) => drawing.draw(&area, self.panel_size)?,
                    Panel::Map(map) => map.draw(&area, self.panel_size)?,
                }
            }
            root.present()?;
        }
        Ok(compact(&svg, size))
    }

    /// Every name in the panels once, with how it looks.
    fn legend(&self) -> Vec<(&str, RGBColor, Look)> {
        let mut entries: Vec<(&str, RGBColor, Look)> = Vec::new();
        let mut add = |name, color, look| {
            if entries.iter().all(|&(known, ..)| known != name) {
                entries.push((name, color, look));
            }
        };
        for panel in &self.panels {
            match panel {
                Panel::Chart(chart) => {
                    for series in chart.series.iter().filter(|series| !series.name.is_empty()) {
                        add(&series.name, series.color, series.look);
                    }
                }
                Panel::Drawing(drawing) => {
                    for (name, color, look) in &drawing.legend {
                        add(name, *color, *look);
                    }
                }
                Panel::Map(map) => {
                    if let Some((name, color)) = map.legend() {
                        add(name, color, Look::Patch);
                    }
                }
            }
        }
        entries
    }
}

/// Pixels in units of the drawing library.
fn units(pixels: u32) -> i32 {
    (pixels * DETAIL) as i32
}

/// A pixel position in units of the drawing library.
fn at(x: f64, y: f64) -> (i32, i32) {
    let scale = f64::from(DETAIL);
    ((x * scale).round() as i32, (y * scale).round() as i32)
}

/// A line width in pixels in units of the drawing library.
fn thickness(pixels: f64) -> u32 {
    (pixels * f64::from(DETAIL)).round() as u32
}

/// A font of `pixels` in height.
fn font(pixels: f64) -> TextStyle<'static> {
    // The backend divides sizes by 1.24, its estimate of a line's height over the font's.
    ("sans-serif", pixels * 1.24 * f64::from(DETAIL))
        .into_font()
        .color(&INK)
}

/// Writes `text` with its middle line at `place`, in pixels.
fn write(
    area: &Area<'_>,
    text: &str,
    place: (f64, f64),
    size: f64,
    (side, bold): (HPos, bool),
) -> anyhow::Result<()> {
    let mut style = font(size).pos(Pos::new(side, VPos::Center));
    if bold {
        style.font = style.font.style(FontStyle::Bold);
    }
    area.draw_text(text, &style, at(place.0, place.1))?;
    Ok(())
}

fn draw_legend(root: &Area<'_>, entries: &[(&str, RGBColor, Look)]) -> anyhow::Result<()> {
    let (mut x, y) = (12.0, 1.45 * f64::from(HEAD));
    for &(name, color, look) in entries {
        chart::draw_sample(root, (x, y), color, look)?;
        write(root, name, (x + 30.0, y), 12.0, (HPos::Left, false))?;
        x += 30.0 + 6.9 * name.chars().count() as f64 + 18.0;
    }
    Ok(())
}

/// `svg` at `size` pixels, without what says nothing.
fn compact(svg: &str, size: (u32, u32)) -> String {
    let (width, height) = size;
    let canvas = format!(
        "width=\"{}\" height=\"{}\"",
        width * DETAIL,
        height * DETAIL
    );
    let svg = svg
        .replacen(
            &canvas,
            &format!("width=\"{width}\" height=\"{height}\""),
            1,
        )
        .replace(" opacity=\"1\"", "")
        .replace(" \"/>", "\"/>")
        // A region has a border, which the drawing library would write as a second list of the same points.
        .replace(
            "<polygon ",
            &format!("<polygon stroke=\"#555\" stroke-width=\"{DETAIL}\" "),
        );
    const FONT_SIZE: &str = "font-size=\"";
    let mut parts = svg.split(FONT_SIZE);
    let mut rounded = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (number, rest) = part.split_once('"').unwrap_or((part, ""));
        let number: f64 = number.parse().unwrap_or_default();
        rounded.push_str(&format!("{FONT_SIZE}{}\"{rest}", number.round()));
    }
    rounded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(y: Vec<f64>) -> Figure {
        let points = (0..).map(f64::from).zip(y).collect();
        Figure {
            title: "A < B".into(),
            columns: 1,
            panel_size: (300, 200),
            panels: vec![Panel::Chart(Chart {
                title: "(a)".into(),
                x: Axis::linear("x in mm", 0.0, 10.0),
                y: Axis::linear("y in um", 0.0, 1.0),
                series: vec![Series::new("y", PALETTE[0], Look::Line, points)],
                marks: vec![],
            })],
        }
    }

    #[test]
    fn a_figure_is_of_the_size_that_it_says_and_names_its_series_once() {
        let svg = chart(vec![0.0, 0.5, 0.2]).to_svg().expect("drawn");
        assert!(svg.starts_with("<svg width=\"300\" height=\"252\" viewBox=\"0 0 1200 1008\""));
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains("A &lt; B"));
        assert_eq!(svg.matches("\ny\n").count(), 1);
    }

    #[test]
    fn what_is_no_number_and_what_lies_outside_the_frame_is_not_drawn() {
        let svg = chart(vec![0.5, f64::NAN, f64::INFINITY, 1e9, 0.5])
            .to_svg()
            .expect("drawn");
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let coordinates = svg
            .split(['"', ',', ' '])
            .filter_map(|word| word.parse::<i64>().ok());
        assert!(coordinates.into_iter().all(|number| number.abs() <= 1200));
    }
}
