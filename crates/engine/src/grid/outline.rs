//! The closed curves that bound a blank and its web, by their length.

use std::f64::consts::{PI, TAU};

use crate::gear::{Contour, Hole, Side, Vector, radial, turned};

/// A closed curve, counter-clockwise.
#[derive(Debug, Clone)]
pub(super) enum Outline {
    /// A circle about the axis, from the angle −π.
    Circle {
        /// Its radius.
        radius: f64,
    },
    /// The edge of a hole, from its outermost point at its own angle, or from the first corner of its contour.
    Edge(Hole),
}

impl Outline {
    /// The length of the whole curve.
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Circle { radius } => TAU * radius,
            Self::Edge(hole) => match hole.contour() {
                Some(contour) => contour.length(),
                None => 2.0 * hole.circle_radius * hole.span() + TAU * hole.half_width(),
            },
        }
    }

    /// The lengths at which its sides begin, and whether they meet the ones before at an angle; none where it has no sides.
    pub(super) fn corners(&self) -> Vec<(f64, bool)> {
        match self {
            Self::Circle { .. } => Vec::new(),
            Self::Edge(hole) => hole.contour().map_or_else(Vec::new, Contour::corners),
        }
    }

    /// Center and radius of a circle around all of a curve that is drawn by its sides; `None` of others.
    pub(super) fn circle_around(&self) -> Option<(Vector, f64)> {
        let Self::Edge(hole) = self else { return None };
        hole.contour()?;
        let center = hole.circle_radius * radial(hole.angle);
        let sides = hole.sides().into_iter().map(|side| side.circle_around());
        let reaches = sides.map(|(middle, radius)| (middle - center).norm() + radius);
        Some((center, reaches.fold(0.0, f64::max)))
    }

    /// Its roundings, by the elements that there would be `around` a whole circle, and its pieces between two corners, by their length: each with
    /// the largest element that it asks for.
    pub(super) fn details(&self, around: f64) -> Vec<(Side, f64)> {
        let Self::Edge(hole) = self else {
            return Vec::new();
        };
        if hole.contour().is_none() {
            return Vec::new();
        }
        let (sides, corners) = (hole.sides(), self.corners());
        let is_corner = |i: usize| corners[i % corners.len()].1;
        let sides = sides.into_iter().enumerate();
        sides
            .filter_map(|(i, side)| {
                let rounding =
                    (side.turn().abs() >= LEAST_ROUNDING).then(|| TAU * side.radius() / around);
                let alone = (is_corner(i) && is_corner(i + 1)).then(|| side.length());
                let size = rounding.into_iter().chain(alone).reduce(f64::min)?;
                Some((side, size))
            })
            .collect()
    }

    /// The distance from `point`, in the material, to a part of the curve that faces the nearest one across the material; infinite where there is
    /// none.
    pub(super) fn distance_across(&self, point: Vector) -> f64 {
        match self {
            Self::Circle { .. } => f64::INFINITY,
            Self::Edge(hole) => hole.contour().map_or(f64::INFINITY, |contour| {
                contour.distance_across(hole.own(point))
            }),
        }
    }

    /// The point at `length` along the curve, from 0 to the whole length.
    pub(super) fn point(&self, length: f64) -> Vector {
        match self {
            Self::Circle { radius } => *radius * radial(length / radius - PI),
            Self::Edge(hole) => edge_point(hole, length),
        }
    }

    /// The distance of `point` from the curve, negative inside of it.
    pub(super) fn distance(&self, point: Vector) -> f64 {
        match self {
            Self::Circle { radius } => point.norm() - radius,
            Self::Edge(hole) => hole.distance_to(point),
        }
    }
}

/// Sine of the angle between two curves below which they count as touching rather than crossing: an element between them
/// would be too sharp.
const LEAST_CROSSING: f64 = 0.6;
/// An arc that turns less, in radians, is a piece of a smooth curve and no rounding: 15 degrees.
const LEAST_ROUNDING: f64 = PI / 12.0;

impl Outline {
    /// Where the circle of `radius` about the axis crosses the curve, by the length along the curve; a circle that all but
    /// touches it does not cross it.
    pub(super) fn crossings(&self, radius: f64) -> Vec<f64> {
        let Self::Edge(hole) = self else {
            return Vec::new();
        };
        if let Some(contour) = hole.contour() {
            let crossings = contour.crossings(radius).into_iter();
            let square = crossings.filter(|(_, sine)| *sine >= LEAST_CROSSING);
            return square.map(|(length, _)| length).collect();
        }
        let (r, w) = (hole.circle_radius, hole.half_width());
        // On either end, seen from its center, off the radius through it; circles about the axis cross no other part.
        let cos = (radius * radius - r * r - w * w) / (2.0 * r * w);
        if cos.abs() >= 1.0 {
            return Vec::new();
        }
        let seen = cos.acos();
        let off = (w * seen.sin()).atan2(r + w * cos);
        if (seen - off).sin() < LEAST_CROSSING {
            return Vec::new();
        }
        let counter_clockwise = (r + w) * hole.span() / 2.0 + w * seen;
        vec![counter_clockwise, self.length() - counter_clockwise]
    }
}

/// Half the outer arc, the counter-clockwise end, the inner arc, the clockwise end, and the other half of the outer arc.
fn edge_point(hole: &Hole, length: f64) -> Vector {
    if let Some(contour) = hole.contour() {
        return turned(contour.point(length), hole.angle);
    }
    let (r, w, half) = (hole.circle_radius, hole.half_width(), hole.span() / 2.0);
    let [clockwise, counter_clockwise] = hole.ends();
    let (outer, end, inner) = ((r + w) * half, PI * w, 2.0 * (r - w) * half);
    let on_end = |center: Vector, from: f64, past: f64| center + w * radial(from + past / w);
    let mut past = length;
    if past <= outer {
        return (r + w) * radial(hole.angle + past / (r + w));
    }
    past -= outer;
    if past <= end {
        return on_end(counter_clockwise, hole.angle + half, past);
    }
    past -= end;
    if past <= inner {
        return (r - w) * radial(hole.angle + half - past / (r - w));
    }
    past -= inner;
    if past <= end {
        return on_end(clockwise, hole.angle - half + PI, past);
    }
    past -= end;
    (r + w) * radial(hole.angle - half + past / (r + w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::HoleShape;

    #[test]
    fn a_circle_crosses_a_hole_where_both_have_a_point() {
        for angle in [0.0, 0.8] {
            let outline = Outline::Edge(Hole {
                circle_radius: 3.0,
                angle: 0.7,
                shape: HoleShape::Slot { width: 0.8, angle },
            });
            for radius in [2.8, 3.0, 3.2] {
                let crossings = outline.crossings(radius);
                assert_eq!(crossings.len(), 2);
                for length in crossings {
                    assert!((outline.point(length).norm() - radius).abs() < 1e-14);
                }
            }
            for radius in [2.5, 2.601, 3.399, 3.5] {
                assert_eq!(outline.crossings(radius), [0.0; 0], "beside or touching");
            }
        }
    }

    #[test]
    fn outlines_are_walked_at_unit_speed_on_their_curve_and_closed() {
        let slot = |angle| {
            Outline::Edge(Hole {
                circle_radius: 3.0,
                angle: 0.7,
                shape: HoleShape::Slot { width: 0.8, angle },
            })
        };
        for outline in [
            Outline::Circle { radius: 2.0 },
            slot(0.0),
            slot(1.1),
            slot(4.0),
        ] {
            let (whole, steps) = (outline.length(), 5000);
            let at = |i: i32| outline.point(whole * f64::from(i) / f64::from(steps));
            assert!((at(0) - at(steps)).norm() < 1e-14);
            let mut turned = 0.0;
            for i in 0..steps {
                let (p, q) = (at(i), at(i + 1));
                assert!(outline.distance(p).abs() < 1e-14);
                let step = whole / f64::from(steps);
                // A chord is shorter than its arc by a 24th of the square of its angle.
                assert!(((q - p).norm() / step - 1.0).abs() < (step / 0.4).powi(2) / 24.0 + 1e-9);
                turned += p.x * q.y - p.y * q.x;
            }
            assert!(turned > 0.0, "counter-clockwise");
        }
    }
}
