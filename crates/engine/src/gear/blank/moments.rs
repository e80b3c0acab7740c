//! Area, first moment and polar moment of a plane region, in closed form along its arcs.

use std::ops::{Add, Mul, Neg, Sub};

use crate::gear::Vector;

/// Moments of a plane region about the origin; of a plate, times its thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// The area ∫ dA in m²; of a plate its volume in m³.
    pub area: f64,
    /// The first moment ∫ (x, y) dA in m³; of a plate in m⁴.
    pub first: Vector,
    /// The polar moment ∫ (x² + y²) dA in m⁴; of a plate in m⁵.
    pub polar: f64,
}

impl Default for Moments {
    /// The moments of an empty region.
    fn default() -> Self {
        Self {
            area: 0.0,
            first: Vector::zeros(),
            polar: 0.0,
        }
    }
}

impl Moments {
    /// Contribution of the arc about `center` from the angle `from` to `to` to the moments of a region that lies on the left of it.
    ///
    /// Green's theorem: the area is ½ ∮ x dy − y dx, the first moment ½ ∮ (x² dy, −y² dx), and the polar moment
    /// ¼ ∮ (x² + y²) (x dy − y dx).
    pub fn under_arc(center: Vector, radius: f64, from: f64, to: f64) -> Self {
        let (a, b, w) = (center.x, center.y, radius);
        let (sin_0, cos_0) = from.sin_cos();
        let (sin_1, cos_1) = to.sin_cos();
        // ∫ of 1, cos, sin, cos², sin², sin cos, cos³ and sin³ over the angle.
        let turn = to - from;
        let (c, s) = (sin_1 - sin_0, cos_0 - cos_1);
        let sc = (sin_1 * sin_1 - sin_0 * sin_0) / 2.0;
        let cc = turn / 2.0 + (sin_1 * cos_1 - sin_0 * cos_0) / 2.0;
        let ss = turn - cc;
        let ccc = c - (sin_1.powi(3) - sin_0.powi(3)) / 3.0;
        let sss = s + (cos_1.powi(3) - cos_0.powi(3)) / 3.0;

        // x dy − y dx = (w² + a w cos + b w sin) dφ, and x² + y² = a² + b² + w² + 2 w (a cos + b sin).
        let swept = w * w * turn + w * (a * c + b * s);
        let squared = a * a + b * b + w * w;
        let along = w * w * (a * c + b * s) + w * (a * a * cc + 2.0 * a * b * sc + b * b * ss);
        Self {
            area: swept / 2.0,
            first: Vector::new(
                w / 2.0 * (a * a * c + 2.0 * a * w * cc + w * w * ccc),
                w / 2.0 * (b * b * s + 2.0 * b * w * ss + w * w * sss),
            ),
            polar: (squared * swept + 2.0 * w * along) / 4.0,
        }
    }

    /// Contribution of the line from `a` to `b`, likewise.
    pub fn under_line(a: Vector, b: Vector) -> Self {
        let swept = a.x * b.y - b.x * a.y;
        let squares = |p: f64, q: f64| (p * p + p * q + q * q) / 3.0;
        Self {
            area: swept / 2.0,
            first: Vector::new(
                (b.y - a.y) * squares(a.x, b.x),
                (a.x - b.x) * squares(a.y, b.y),
            ) / 2.0,
            polar: swept * (squares(a.x, b.x) + squares(a.y, b.y)) / 4.0,
        }
    }

    /// Moments of the disc of `radius` about the origin.
    pub fn of_disc(radius: f64) -> Self {
        Self {
            area: std::f64::consts::PI * radius.powi(2),
            first: Vector::zeros(),
            polar: std::f64::consts::FRAC_PI_2 * radius.powi(4),
        }
    }
}

impl Add for Moments {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            first: self.first + other.first,
            polar: self.polar + other.polar,
        }
    }
}

impl Neg for Moments {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Moments {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul<f64> for Moments {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            area: self.area * factor,
            first: self.first * factor,
            polar: self.polar * factor,
        }
    }
}

impl std::iter::Sum for Moments {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Self::add)
    }
}
