//! The elements of SVG that figures are made of. Lengths are pixels from the upper left corner.

use std::fmt::Write;

/// A color: red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

/// White.
pub const WHITE: Color = Color(255, 255, 255);

/// A place: to the right, and down.
pub(crate) type Point = (f64, f64);

/// How a shape is painted.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Paint {
    /// Filled.
    Fill(Color),
    /// Drawn by a line of this width.
    Line(Color, f64),
    /// Filled, with a thin border.
    Bordered(Color),
}

/// At which end of a text its place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// The border of filled shapes, and its width.
const BORDER: (Color, f64) = (Color(85, 85, 85), 1.0);

/// A document under way.
pub(crate) struct Svg {
    text: String,
}

impl Svg {
    /// A white sheet, on which texts are written in `ink`.
    pub(crate) fn new((width, height): (u32, u32), ink: Color) -> Self {
        let mut svg = Self {
            text: format!(
                "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" fill=\"{}\">\n",
                hex(ink)
            ),
        };
        let corners = [(0.0, 0.0), (f64::from(width), f64::from(height))];
        svg.rectangle(corners, Paint::Fill(WHITE));
        svg
    }

    /// The document.
    pub(crate) fn end(self) -> String {
        self.text + "</svg>\n"
    }

    /// The content that `draw` draws, with its upper left corner at `corner`.
    pub(crate) fn group(&mut self, corner: Point, draw: impl FnOnce(&mut Self)) {
        let [x, y] = [corner.0, corner.1].map(number);
        self.line(format_args!("<g transform=\"translate({x} {y})\">"));
        draw(self);
        self.line(format_args!("</g>"));
    }

    /// A line through `points`.
    pub(crate) fn path(
        &mut self,
        points: impl IntoIterator<Item = Point>,
        color: Color,
        width: f64,
    ) {
        self.points("polyline", points, Paint::Line(color, width));
    }

    /// A region with the corners `points`.
    pub(crate) fn region(&mut self, points: impl IntoIterator<Item = Point>, paint: Paint) {
        self.points("polygon", points, paint);
    }

    fn points(&mut self, name: &str, points: impl IntoIterator<Item = Point>, paint: Paint) {
        let points: Vec<String> = points
            .into_iter()
            .map(|(x, y)| format!("{},{}", number(x), number(y)))
            .collect();
        let points = points.join(" ");
        self.line(format_args!(
            "<{name}{} points=\"{points}\"/>",
            painted(paint)
        ));
    }

    /// A rectangle between two opposite `corners`, whose sides are sharp, so that nothing shines through between two that touch.
    pub(crate) fn rectangle(&mut self, corners: [Point; 2], paint: Paint) {
        let [(a, b), (c, d)] = corners;
        let [x, y] = [a.min(c), b.min(d)].map(number);
        let [width, height] = [(c - a).abs(), (d - b).abs()].map(number);
        self.line(format_args!(
            "<rect{} shape-rendering=\"crispEdges\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>",
            painted(paint)
        ));
    }

    /// A circle.
    pub(crate) fn circle(&mut self, center: Point, radius: f64, paint: Paint) {
        let [x, y, r] = [center.0, center.1, radius].map(number);
        self.line(format_args!(
            "<circle{} cx=\"{x}\" cy=\"{y}\" r=\"{r}\"/>",
            painted(paint)
        ));
    }

    /// A cross whose arms reach so far from its `center` to the right and down.
    pub(crate) fn cross(&mut self, center: Point, reach: f64, color: Color, width: f64) {
        for way in [1.0, -1.0] {
            let ends = [-reach, reach].map(|arm| (center.0 + arm, center.1 + way * arm));
            self.path(ends, color, width);
        }
    }

    /// A text of a `size` with its middle line at `place`.
    pub(crate) fn text(&mut self, text: &str, place: Point, size: f64, anchor: Anchor) {
        self.write(text, place, size, anchor, "");
    }

    /// A heading, which is bold and begins at `place`.
    pub(crate) fn heading(&mut self, text: &str, place: Point, size: f64) {
        self.write(text, place, size, Anchor::Start, " font-weight=\"bold\"");
    }

    /// A text that is read upward, with its middle at `place`.
    pub(crate) fn upward(&mut self, text: &str, place: Point, size: f64) {
        let [x, y] = [place.0, place.1].map(number);
        let turned = format!(" transform=\"rotate(-90 {x} {y})\"");
        self.write(text, place, size, Anchor::Middle, &turned);
    }

    fn write(&mut self, text: &str, place: Point, size: f64, anchor: Anchor, besides: &str) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let [x, y] = [place.0, place.1].map(number);
        let text = text
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;");
        // Half the height of a capital, which not every reader of SVG knows how to take by itself.
        self.line(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.35em\" font-size=\"{size}\"{anchor}{besides}>{text}</text>"
        ));
    }

    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        // A string takes whatever is written to it.
        let _ = writeln!(self.text, "{line}");
    }
}

/// The attributes of a paint.
fn painted(paint: Paint) -> String {
    let line = |color, width| format!(" stroke=\"{}\" stroke-width=\"{width}\"", hex(color));
    match paint {
        Paint::Fill(color) => format!(" fill=\"{}\"", hex(color)),
        Paint::Line(color, width) => format!(" fill=\"none\"{}", line(color, width)),
        Paint::Bordered(color) => format!(" fill=\"{}\"{}", hex(color), line(BORDER.0, BORDER.1)),
    }
}

fn hex(Color(red, green, blue): Color) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A length in quarters of a pixel, which is as fine as anybody sees.
fn number(length: f64) -> f64 {
    // And no negative zero.
    (4.0 * length).round() / 4.0 + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_those_of_svg() {
        let mut svg = Svg::new((30, 20), Color(1, 2, 255));
        svg.group((5.0, 2.6), |svg| {
            svg.path([(0.0, -0.1), (1.13, 2.0)], WHITE, 1.5);
            svg.rectangle([(4.0, 1.0), (2.0, 3.0)], Paint::Bordered(WHITE));
        });
        svg.upward("a < b & c", (3.0, 4.0), 11.5);
        assert_eq!(
            svg.end(),
            "<svg width=\"30\" height=\"20\" viewBox=\"0 0 30 20\" xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" fill=\"#0102ff\">
<rect fill=\"#ffffff\" shape-rendering=\"crispEdges\" x=\"0\" y=\"0\" width=\"30\" height=\"20\"/>
<g transform=\"translate(5 2.5)\">
<polyline fill=\"none\" stroke=\"#ffffff\" stroke-width=\"1.5\" points=\"0,0 1.25,2\"/>
<rect fill=\"#ffffff\" stroke=\"#555555\" stroke-width=\"1\" shape-rendering=\"crispEdges\" x=\"2\" y=\"1\" width=\"2\" height=\"2\"/>
</g>
<text x=\"3\" y=\"4\" dy=\"0.35em\" font-size=\"11.5\" text-anchor=\"middle\" transform=\"rotate(-90 3 4)\">a &lt; b &amp; c</text>
</svg>
"
        );
    }
}
