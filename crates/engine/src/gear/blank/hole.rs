//! One hole of a blank: round, a slot along its circle, or any opening by its contour.
//!
//! A slot is all that lies within half its width of an arc about the gear's axis, and a round hole is a slot whose arc is one
//! point. So every distance between holes is a distance between two such arcs, less the half widths.

use std::f64::consts::{PI, TAU};

use super::contour::{Contour, SMOOTH, Side, between, turn_at};
use super::moments::Moments;
use crate::gear::{Vector, radial, turned};

/// The shape of a hole. Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub enum HoleShape {
    /// A circle.
    Round {
        /// Its radius.
        radius: f64,
    },
    /// A kidney along the hole circle with round ends.
    Slot {
        /// The width, which is the diameter of its ends.
        width: f64,
        /// The angle between the centers of its ends, as seen from the gear's axis; with 0 the slot is a round hole.
        angle: f64,
    },
    /// Any opening, by the lines and arcs around it.
    Contour(Contour),
}

/// A hole through a blank, in the frame of its gear.
#[derive(Debug, Clone, PartialEq)]
pub struct Hole {
    /// The radius of the circle on which its middle stands, in meters: of a contour, the center of mass of the opening.
    pub circle_radius: f64,
    /// The polar angle of its middle, in radians: from the centerline of tooth 0, positive towards its loaded flank.
    pub angle: f64,
    /// Its shape.
    pub shape: HoleShape,
}

impl Hole {
    /// The radius of a round hole, half the width of a slot; of a contour half its extent along the radius, or twice its area by its length where
    /// that is less.
    pub fn half_width(&self) -> f64 {
        match &self.shape {
            HoleShape::Round { radius } => *radius,
            HoleShape::Slot { width, .. } => width / 2.0,
            HoleShape::Contour(contour) => contour.half_width(),
        }
    }

    /// The angle between the centers of the ends of a slot; 0 for any other hole.
    pub fn span(&self) -> f64 {
        match self.shape {
            HoleShape::Slot { angle, .. } => angle,
            HoleShape::Round { .. } | HoleShape::Contour(_) => 0.0,
        }
    }

    /// The contour, if that defines the hole.
    pub fn contour(&self) -> Option<&Contour> {
        match &self.shape {
            HoleShape::Contour(contour) => Some(contour),
            HoleShape::Round { .. } | HoleShape::Slot { .. } => None,
        }
    }

    /// The largest radius that the hole reaches.
    pub fn outer_reach(&self) -> f64 {
        match self.contour() {
            Some(contour) => contour.reach()[1],
            None => self.circle_radius + self.half_width(),
        }
    }

    /// The smallest radius that the hole reaches; not positive if it reaches the axis.
    pub fn inner_reach(&self) -> f64 {
        match self.contour() {
            Some(contour) => contour.reach()[0],
            None => self.circle_radius - self.half_width(),
        }
    }

    /// The lines and arcs around the hole, counter-clockwise, in the frame of the gear.
    pub fn sides(&self) -> Vec<Side> {
        if let Some(contour) = self.contour() {
            let sides = contour.sides().iter();
            return sides.map(|side| side.turned(self.angle)).collect();
        }
        let (r, w, half) = (self.circle_radius, self.half_width(), self.span() / 2.0);
        let [from, to] = [self.angle - half, self.angle + half];
        let [outer, inner] = [r + w, r - w].map(|r| [from, to].map(|angle| r * radial(angle)));
        let bulge = (half / 2.0).tan();
        let end = |from, to| Side::new(from, to, 1.0);
        match half > 0.0 {
            false => vec![end(outer[0], inner[0]), end(inner[0], outer[0])],
            true => vec![
                Side::new(outer[0], outer[1], bulge),
                end(outer[1], inner[1]),
                Side::new(inner[1], inner[0], -bulge),
                end(inner[0], outer[0]),
            ],
        }
    }

    /// Points along the edge, counter-clockwise, each once: no point of the edge is farther than `tolerance` from the closed line through them.
    pub fn edge(&self, tolerance: f64) -> Vec<Vector> {
        let pieces = |side: &Side| {
            // An arc that turns by φ rises by r (1 − cos(φ/2)) over its chord.
            let most = 2.0 * (1.0 - tolerance / side.radius().max(tolerance)).acos();
            (side.turn().abs() / most).ceil().max(1.0)
        };
        let sides = self.sides();
        let points = sides.iter().flat_map(|side| {
            let count = pieces(side);
            (0..count as u32).map(move |i| side.point(side.length() * f64::from(i) / count))
        });
        points.collect()
    }

    /// A point of the frame of the gear in that of the hole, whose x axis runs through its middle.
    pub(crate) fn own(&self, point: Vector) -> Vector {
        turned(point, -self.angle)
    }

    /// The centers of the clockwise and of the counter-clockwise end; the center twice for a round hole.
    pub fn ends(&self) -> [Vector; 2] {
        [-0.5, 0.5].map(|part| self.circle_radius * radial(self.angle + part * self.span()))
    }

    /// The distance from `point` to the edge of the hole, negative inside of it.
    pub fn distance_to(&self, point: Vector) -> f64 {
        if let Some(contour) = self.contour() {
            return contour.distance_to(self.own(point));
        }
        let off = wrapped(point.y.atan2(point.x) - self.angle).abs();
        let apart = (off - self.span() / 2.0).max(0.0);
        chord(point.norm(), self.circle_radius, apart) - self.half_width()
    }

    /// The least material between this hole and `other`, negative where they overlap.
    ///
    /// The nearest points of two arcs about one center are at one angle where the arcs overlap in angle, and their
    /// nearest ends otherwise. Where the arcs meet, this is less the sum of the half widths.
    pub fn ligament_to(&self, other: &Self) -> f64 {
        if self.contour().or(other.contour()).is_some() {
            return between(&self.sides(), &other.sides());
        }
        let between = wrapped(self.angle - other.angle).abs();
        let half_spans = f64::midpoint(self.span(), other.span());
        // The far sides of two long slots may be nearer than their near ones.
        let apart = (between - half_spans)
            .min(TAU - between - half_spans)
            .max(0.0);
        chord(self.circle_radius, other.circle_radius, apart)
            - self.half_width()
            - other.half_width()
    }

    /// The least material between the two ends of a slot of more than half a turn, or between two parts of a contour that face each other; infinite
    /// for other holes, between whose ends nothing is left standing alone.
    pub fn ligament_between_own_ends(&self) -> f64 {
        if let Some(contour) = self.contour() {
            return contour.neck();
        }
        if self.span() <= PI {
            return f64::INFINITY;
        }
        let apart = (TAU - self.span()).max(0.0);
        chord(self.circle_radius, self.circle_radius, apart) - 2.0 * self.half_width()
    }

    /// The decrement λ of the field of the hole on a circle of `radius` about the axis: from each order to the next it falls by e^−λ.
    ///
    /// The images of a source in two circles gather in the two points that are inverse in both, and there the field is singular. With the
    /// hole a circle of radius a about a center at the distance e, cosh λ = (r² + e² − a²)/(2 r e). An arc counts as its circle, a corner as a
    /// circle without extent. Where an arc around a part of the material or a straight side ends smoothly, the field goes on through it.
    pub fn decrement(&self, radius: f64) -> f64 {
        let of = |center: Vector, own: f64| {
            let e = center.norm();
            ((radius * radius + e * e - own * own) / (2.0 * radius * e)).acosh()
        };
        let sides = self.sides();
        let of_side = |(i, side): (usize, &Side)| {
            let arc = match side.bulge > 0.0 {
                true => of(side.center, side.radius),
                false => f64::INFINITY,
            };
            // A circle that crosses the other one is no image: then the ends of its arc count.
            if arc.is_nan() {
                return of(side.from, 0.0).min(of(side.to, 0.0));
            }
            match turn_at(&sides, i).abs() > SMOOTH {
                true => arc.min(of(side.from, 0.0)),
                false => arc,
            }
        };
        let each = sides.iter().enumerate().map(of_side);
        each.fold(f64::INFINITY, f64::min)
    }

    /// The same hole, narrower by `by` to each side; `None` of a contour, and of a hole that is no wider.
    pub fn narrowed(&self, by: f64) -> Option<Self> {
        let shape = match self.shape {
            HoleShape::Round { radius } => HoleShape::Round {
                radius: radius - by,
            },
            HoleShape::Slot { width, angle } => HoleShape::Slot {
                width: width - 2.0 * by,
                angle,
            },
            HoleShape::Contour(_) => return None,
        };
        let narrowed = Self {
            shape,
            ..self.clone()
        };
        (narrowed.half_width() > 0.0).then_some(narrowed)
    }

    /// Area and moments of the hole, in closed form.
    pub fn moments(&self) -> Moments {
        self.moments_within(f64::INFINITY)
    }

    /// Area and moments of that part of the hole which lies within `radius` of the axis, in closed form.
    ///
    /// Green's theorem around the part, counter-clockwise: along the outer arc or the circle that cuts it, around the
    /// counter-clockwise end, back along the inner arc, and around the clockwise end.
    pub fn moments_within(&self, radius: f64) -> Moments {
        if let Some(contour) = self.contour() {
            let own = contour.moments_within(radius);
            let first = turned(own.first, self.angle);
            return Moments { first, ..own };
        }
        let (r, w, half) = (self.circle_radius, self.half_width(), self.span() / 2.0);
        if radius <= r - w {
            return Moments::default();
        }
        let outer = radius.min(r + w);
        // Where the cutting circle meets an end: seen from the end's center, off the radius through it, and from the axis.
        let seen = ((outer * outer - r * r - w * w) / (2.0 * r * w))
            .clamp(-1.0, 1.0)
            .acos();
        let off = (w * seen.sin()).atan2(r + w * seen.cos());
        let [clockwise, counter_clockwise] = self.ends();
        let (from, to) = (self.angle - half, self.angle + half);
        Moments::under_arc(Vector::zeros(), outer, from - off, to + off)
            + Moments::under_arc(counter_clockwise, w, to + seen, to + PI)
            + Moments::under_arc(Vector::zeros(), r - w, to, from)
            + Moments::under_arc(clockwise, w, from - PI, from - seen)
    }
}

/// The distance between two points at the radii `a` and `b` whose polar angles are `apart`.
fn chord(a: f64, b: f64, apart: f64) -> f64 {
    // Written so that equal radii and small angles keep their digits.
    let sin = (apart / 2.0).sin();
    ((a - b).powi(2) + 4.0 * a * b * sin * sin).sqrt()
}

/// The angle in [−π, π] that differs from `angle` by whole turns.
pub(super) fn wrapped(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Round holes and slots in every mutual position, some overlapping.
    pub(in crate::gear::blank) fn holes() -> Vec<Hole> {
        let round = |circle_radius, angle, radius| Hole {
            circle_radius,
            angle,
            shape: HoleShape::Round { radius },
        };
        let slot = |circle_radius, angle, width, span| Hole {
            circle_radius,
            angle,
            shape: HoleShape::Slot { width, angle: span },
        };
        vec![
            round(30e-3, 0.0, 8e-3),
            round(25e-3, 2.9, 4e-3),
            round(34e-3, -0.7, 7e-3),
            slot(30e-3, 0.9, 6e-3, 0.6),
            slot(22e-3, -2.0, 5e-3, 2.5),
            slot(36e-3, 3.1, 3e-3, 1.2),
            slot(30e-3, 1.0, 4e-3, 4.8),
            slot(30e-3, -1.4, 9e-3, 0.0),
        ]
    }

    /// Points on the edge of the hole, by its definition and not by its distances.
    fn edge(hole: &Hole, count: usize) -> Vec<Vector> {
        let (r, w, half) = (hole.circle_radius, hole.half_width(), hole.span() / 2.0);
        let parts = (0..=count).map(|i| i as f64 / count as f64);
        parts
            .flat_map(|part| {
                let [right, left] = hole.ends();
                let along = hole.angle + half * (2.0 * part - 1.0);
                [
                    (r + w) * radial(along),
                    (r - w) * radial(along),
                    left + w * radial(hole.angle + half + PI * part),
                    right + w * radial(hole.angle - half - PI * part),
                ]
            })
            .collect()
    }

    #[test]
    fn ligaments_are_the_least_distances_between_sampled_edges() {
        let holes = holes();
        for (i, one) in holes.iter().enumerate() {
            for other in &holes[i + 1..] {
                let ligament = one.ligament_to(other);
                assert!((ligament - other.ligament_to(one)).abs() < 1e-15);
                let sampled = edge(one, 400)
                    .iter()
                    .flat_map(|p| edge(other, 400).into_iter().map(move |q| (p - q).norm()))
                    .fold(f64::INFINITY, f64::min);
                if ligament > 0.0 {
                    // The samples stand at most 0.35 mm apart on edges that bend with 1.5 mm and more.
                    let slack = 0.2e-3_f64.powi(2) / 1.5e-3;
                    assert!(sampled >= ligament - 1e-15 && sampled < ligament + slack);
                } else {
                    let inside = |p: &Vector| other.distance_to(*p) < 1e-4;
                    assert!(edge(one, 400).iter().any(inside), "{one:?} meets {other:?}");
                }
            }
        }
    }

    #[test]
    fn the_edge_is_at_no_distance_and_every_other_point_at_its_distance_from_it() {
        for hole in holes() {
            let edge = edge(&hole, 2000);
            assert!(edge.iter().all(|p| hole.distance_to(*p).abs() < 1e-16));
            for i in 0..200 {
                let (r, t) = (15e-3 + 1.3e-4 * f64::from(i), 0.37 * f64::from(i));
                let point = r * radial(t);
                let sampled = edge.iter().map(|p| (p - point).norm()).fold(1.0, f64::min);
                let distance = hole.distance_to(point).abs();
                // The samples stand at most 0.08 mm apart.
                let slack = 0.04e-3_f64.powi(2) / distance.max(0.04e-3);
                assert!(sampled >= distance - 1e-15 && sampled - distance <= slack);
            }
        }
    }

    #[test]
    fn the_field_of_a_hole_falls_from_order_to_order_by_where_its_images_gather() {
        for hole in holes() {
            // An end of a slot, or the hole itself.
            let (e, own) = (hole.circle_radius, hole.half_width());
            for radius in [hole.outer_reach() + 0.5e-3, hole.inner_reach() - 2e-3] {
                // Inverse in the circle, and that again in the hole.
                let mut place = e;
                for _ in 0..200 {
                    let image = radius * radius / place;
                    place = e + own * own / (image - e);
                }
                let expected = (radius / place).ln().abs();
                assert!(
                    (hole.decrement(radius) / expected - 1.0).abs() < 1e-9,
                    "{hole:?}"
                );
            }
        }
        // Of a square window the corners count, those that are nearest.
        let corners = [[30e-3, -5e-3], [40e-3, -5e-3], [40e-3, 5e-3], [30e-3, 5e-3]];
        let corners = corners.map(|[x, y]| Vector::new(x, y));
        let sides = [0, 1, 2, 3].map(|i| Side::new(corners[i], corners[(i + 1) % 4], 0.0));
        let window = Contour::opening(&sides).expect("an opening");
        let expected = (45e-3 / 40e-3_f64.hypot(5e-3)).ln();
        assert!((window.decrement(45e-3) / expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn moments_are_those_of_a_fine_lattice_in_polar_coordinates() {
        for hole in holes() {
            for cut in [f64::INFINITY, hole.circle_radius, hole.outer_reach() - 1e-3] {
                // ∫ over r of the angle that the hole takes there, by definition from its distance function.
                let (low, high) = (hole.inner_reach(), hole.outer_reach().min(cut));
                let mut expected = Moments::default();
                for (s, weight) in
                    crate::quadrature::gauss_legendre_panels(-PI / 2.0, PI / 2.0, 400)
                {
                    // Square roots at both ends are smooth in s.
                    let r = f64::midpoint(low, high) + (high - low) / 2.0 * s.sin();
                    let weight = weight * (high - low) / 2.0 * s.cos();
                    let (c, w) = (hole.circle_radius, hole.half_width());
                    let off = ((r * r + c * c - w * w) / (2.0 * r * c))
                        .clamp(-1.0, 1.0)
                        .acos();
                    let reach = hole.span() / 2.0 + off;
                    expected = expected
                        + Moments {
                            area: weight * 2.0 * reach * r,
                            first: weight * 2.0 * reach.sin() * r * r * radial(hole.angle),
                            polar: weight * 2.0 * reach * r.powi(3),
                        };
                }
                let found = hole.moments_within(cut);
                let scale = hole.circle_radius;
                let apart = (found.area - expected.area).abs()
                    + (found.first - expected.first).norm() / scale
                    + (found.polar - expected.polar).abs() / scale.powi(2);
                // The rule's own error: the integrand has a square root where the circle cuts.
                assert!(
                    apart < 1e-7 * found.area,
                    "{hole:?} within {cut}: {apart:e}"
                );
            }
        }
    }

    #[test]
    fn a_round_hole_has_the_moments_of_a_disc_and_a_slot_those_of_its_sector_and_its_disc() {
        for hole in holes() {
            let (r, w, a) = (hole.circle_radius, hole.half_width(), hole.span());
            let moments = hole.moments();
            let area = 2.0 * a * r * w + PI * w * w;
            let polar =
                a / 4.0 * ((r + w).powi(4) - (r - w).powi(4)) + PI * w * w * (r * r + w * w / 2.0);
            // Half discs have their centroids 4w/3π off.
            let (sin, cos) = (a / 2.0).sin_cos();
            let first = 2.0 * sin / 3.0 * ((r + w).powi(3) - (r - w).powi(3))
                + PI * w * w * (r * cos - 4.0 * w / (3.0 * PI) * sin);
            assert!((moments.area / area - 1.0).abs() < 1e-12);
            assert!((moments.polar / polar - 1.0).abs() < 1e-12);
            assert!((moments.first - first * radial(hole.angle)).norm() < 1e-12 * area * r);
        }
    }

    #[test]
    fn the_ends_of_a_long_slot_leave_a_tongue() {
        let long = &holes()[6];
        let [right, left] = long.ends();
        let tongue = (right - left).norm() - 4e-3;
        assert!((long.ligament_between_own_ends() - tongue).abs() < 1e-16);
        assert_eq!(holes()[4].ligament_between_own_ends(), f64::INFINITY);
    }
}
