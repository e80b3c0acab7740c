//! Figures as SVG: charts of named series, order spectra, and drawings of gears.
//!
//! Read in this order: `svg` (its elements), [`axis`], [`chart`] (curves and stems), [`drawing`] (shapes, and the true outline of a gear), [`map`] (fields by
//! color), `simplify` (small files). Nothing here knows the subject of the figures.

pub mod axis;
pub mod chart;
pub mod drawing;
pub mod map;
mod simplify;
mod svg;

use svg::{Anchor, Svg};

pub use axis::Axis;
pub use chart::{Chart, Look, Mark, Series};
pub use drawing::{Drawing, Shape};
pub use map::Map;
pub use svg::{Color, WHITE};

/// Lettering and frames.
pub const INK: Color = Color(38, 38, 38);
/// Grid lines.
const GRID: Color = Color(226, 226, 226);
/// The colors of series, alike in all figures and told apart by readers who do not see red and green.
pub const PALETTE: [Color; 7] = [
    Color(38, 38, 38),
    Color(213, 94, 0),
    Color(0, 114, 178),
    Color(0, 145, 105),
    Color(180, 80, 140),
    Color(210, 145, 0),
    Color(70, 165, 215),
];

/// The height of the figure's title and of its legend, in pixels.
const HEAD: u32 = 26;

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
    pub fn to_svg(&self) -> String {
        let (width, height) = self.panel_size;
        let columns = self.columns.max(1);
        let rows = (self.panels.len() as u32).div_ceil(columns);
        let legend = self.legend();
        let head = if legend.is_empty() { HEAD } else { 2 * HEAD };
        let mut svg = Svg::new((columns * width, rows * height + head), INK);
        svg.heading(&self.title, (10.0, 15.0), 15.0);
        draw_legend(&mut svg, &legend);
        for (i, panel) in (0..).zip(&self.panels) {
            let corner = (i % columns * width, i / columns * height + head);
            let size = (f64::from(width), f64::from(height));
            let corner = (f64::from(corner.0), f64::from(corner.1));
            svg.group(corner, |svg| match panel {
                Panel::Chart(chart) => chart.draw(svg, size),
                Panel::Drawing(drawing) => drawing.draw(svg, size),
                Panel::Map(map) => map.draw(svg, size),
            });
        }
        svg.end()
    }

    /// Every name in the panels once, with how it looks.
    fn legend(&self) -> Vec<(&str, Color, Look)> {
        let mut entries: Vec<(&str, Color, Look)> = Vec::new();
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

fn draw_legend(svg: &mut Svg, entries: &[(&str, Color, Look)]) {
    let (mut x, y) = (12.0, 1.45 * f64::from(HEAD));
    for &(name, color, look) in entries {
        chart::draw_sample(svg, (x, y), color, look);
        svg.text(name, (x + 30.0, y), 12.0, Anchor::Start);
        x += 30.0 + 6.9 * name.chars().count() as f64 + 18.0;
    }
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
        let svg = chart(vec![0.0, 0.5, 0.2]).to_svg();
        assert!(svg.starts_with("<svg width=\"300\" height=\"252\" viewBox=\"0 0 300 252\""));
        assert!(svg.trim_end().ends_with("</svg>") && svg.contains("A &lt; B"));
        assert_eq!(svg.matches(">y</text>").count(), 1);
    }

    #[test]
    fn what_is_no_number_and_what_lies_outside_the_frame_is_not_drawn() {
        let svg = chart(vec![0.5, f64::NAN, f64::INFINITY, 1e9, 0.5]).to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let words = svg.split(['"', ',', ' ']);
        let coordinates = words.filter_map(|word| word.parse::<f64>().ok());
        assert!(coordinates.into_iter().all(|number| number.abs() <= 300.0));
    }
}
