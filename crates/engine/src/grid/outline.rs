//! The closed curves that bound a blank and its web, by their length.

use std::f64::consts::{PI, TAU};

use crate::gear::{Hole, Vector, radial};

/// A closed curve, counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub(super) enum Outline {
    /// A circle about the axis, from the angle −π.
    Circle {
        /// Its radius.
        radius: f64,
    },
    /// The edge of a hole, from its outermost point at its own angle.
    Edge(Hole),
}

impl Outline {
    /// The length of the whole curve.
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Circle { radius } => TAU * radius,
            Self::Edge(hole) => 2.0 * hole.circle_radius * hole.span() + TAU * hole.half_width(),
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

/// Below this sine of the angle between them, two curves count as touching rather than crossing: an element between them
/// would be too sharp.
const LEAST_CROSSING: f64 = 0.6;

impl Outline {
    /// Where the circle of `radius` about the axis crosses the curve, by the length along the curve; a circle that all but
    /// touches it does not cross it.
    pub(super) fn crossings(&self, radius: f64) -> Vec<f64> {
        let Self::Edge(hole) = self else {
            return Vec::new();
        };
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
