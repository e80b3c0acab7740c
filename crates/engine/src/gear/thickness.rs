//! Tooth thickness on drawings: by a deviation, by a span over several teeth, or by balls in opposite spaces (ISO 21771).
//!
//! All of them are one number to the engine, the deviation of the transverse arc on the reference circle. With ψ_b half the angle of a tooth on its base
//! circle and c = m_n z cos α_n, which is 2 r_b cos β_b:
//!
//! ```text
//! W_k = c ((k − 1) π/z + ψ_b)
//! inv α_K = D_M/c + ψ_b − π/z,   M_dK = D_M + 2 r_b/cos α_K (even z), D_M + 2 r_b cos(π/2z)/cos α_K (odd z)
//! ```

use std::f64::consts::PI;

use super::involute::involute_function;
use super::solid::transverse_angle;
use crate::root_finding::bisect;

/// Thickness of the teeth as a drawing gives it. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Thickness {
    /// The deviation A_st of the transverse arc on the reference circle; negative is thinner.
    Transverse(f64),
    /// The deviation A_sn of the arc in the normal section.
    Normal(f64),
    /// The span W_k.
    Span {
        /// The number k of teeth that it is measured over.
        teeth: u32,
        /// Its length.
        length: f64,
    },
    /// The size M_dK over two balls in opposite spaces, or nearly opposite ones of an odd number.
    Balls {
        /// The diameter D_M of a ball.
        diameter: f64,
        /// The size over both.
        over: f64,
    },
}

/// Teeth on which a thickness is measured: as the rack cuts them, in the normal section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredTeeth {
    /// The number of teeth z.
    pub tooth_count: u32,
    /// The module m_n in meters.
    pub module: f64,
    /// The pressure angle α_n in radians.
    pub pressure_angle: f64,
    /// The profile shift x.
    pub profile_shift: f64,
    /// The helix angle β in radians.
    pub helix_angle: f64,
}

impl MeasuredTeeth {
    fn teeth(&self) -> f64 {
        f64::from(self.tooth_count)
    }

    fn transverse_angle(&self) -> f64 {
        transverse_angle(self.pressure_angle, self.helix_angle.cos())
    }

    fn reference_radius(&self) -> f64 {
        self.module * self.teeth() / (2.0 * self.helix_angle.cos())
    }

    fn base_radius(&self) -> f64 {
        self.reference_radius() * self.transverse_angle().cos()
    }

    /// cos β_b: sin β_b = sin β cos α_n.
    fn cos_base_helix(&self) -> f64 {
        let sin = self.helix_angle.sin() * self.pressure_angle.cos();
        (1.0 - sin * sin).sqrt()
    }

    /// c = m_n z cos α_n.
    fn scale(&self) -> f64 {
        self.module * self.teeth() * self.pressure_angle.cos()
    }

    /// ψ_b as the rack leaves it.
    fn nominal_half_angle(&self) -> f64 {
        let half = PI / 2.0 + 2.0 * self.profile_shift * self.pressure_angle.tan();
        half / self.teeth() + involute_function(self.transverse_angle())
    }

    /// The profile shift, in normal modules, that makes the teeth thicker by the transverse arc `deviation`: A_st cos β/(2 m_n tan α_n).
    pub fn profile_shift_of(&self, deviation: f64) -> f64 {
        deviation / self.deviation_of(1.0)
    }

    /// The transverse arc by which a further profile `shift`, in normal modules, makes the teeth thicker.
    pub fn deviation_of(&self, shift: f64) -> f64 {
        2.0 * shift * self.module * self.pressure_angle.tan() / self.helix_angle.cos()
    }

    /// The share of a diameter at which balls stand to both sides of a gear.
    fn opposite(&self) -> f64 {
        if self.tooth_count.is_multiple_of(2) {
            1.0
        } else {
            (PI / (2.0 * self.teeth())).cos()
        }
    }

    /// The profile angle α_K at the centers of balls that stand so far over a gear; `None` where they would stand in its base circle.
    fn angle_under_balls(&self, diameter: f64, over: f64) -> Option<f64> {
        let cos = 2.0 * self.base_radius() * self.opposite() / (over - diameter);
        (cos > 0.0 && cos < 1.0).then(|| cos.acos())
    }
}

impl Thickness {
    /// The thickness as a deviation of the transverse arc on the reference circle of `teeth`, in meters; `None` where balls would stand in the base circle.
    pub fn deviation(self, teeth: &MeasuredTeeth) -> Option<f64> {
        let half_angle = match self {
            Self::Transverse(deviation) => return Some(deviation),
            Self::Normal(deviation) => return Some(deviation / teeth.helix_angle.cos()),
            Self::Span { teeth: k, length } => {
                length / teeth.scale() - (f64::from(k) - 1.0) * PI / teeth.teeth()
            }
            Self::Balls { diameter, over } => {
                let alpha = teeth.angle_under_balls(diameter, over)?;
                involute_function(alpha) + PI / teeth.teeth() - diameter / teeth.scale()
            }
        };
        Some(2.0 * teeth.reference_radius() * (half_angle - teeth.nominal_half_angle()))
    }

    /// The same statement of `teeth` that deviate by `deviation`, a transverse arc; `None` where a ball falls to the bottom of its space.
    pub fn of_deviation(self, teeth: &MeasuredTeeth, deviation: f64) -> Option<Self> {
        let half_angle = teeth.nominal_half_angle() + deviation / (2.0 * teeth.reference_radius());
        Some(match self {
            Self::Transverse(_) => Self::Transverse(deviation),
            Self::Normal(_) => Self::Normal(deviation * teeth.helix_angle.cos()),
            Self::Span { teeth: k, .. } => Self::Span {
                teeth: k,
                length: teeth.scale() * ((f64::from(k) - 1.0) * PI / teeth.teeth() + half_angle),
            },
            Self::Balls { diameter, .. } => {
                let wanted = diameter / teeth.scale() + half_angle - PI / teeth.teeth();
                if wanted <= 0.0 {
                    return None;
                }
                let alpha = bisect(0.0, PI / 2.0, |alpha| involute_function(alpha) <= wanted);
                let across = 2.0 * teeth.base_radius() / alpha.cos();
                Self::Balls {
                    diameter,
                    over: diameter + across * teeth.opposite(),
                }
            }
        })
    }

    /// The roll length, in meters, at which the gauge touches the flanks of `teeth`; `None` without a measurement, and for balls in the base circle.
    pub fn touch(self, teeth: &MeasuredTeeth) -> Option<f64> {
        match self {
            Self::Transverse(_) | Self::Normal(_) => None,
            Self::Span { length, .. } => Some(0.5 * length * teeth.cos_base_helix()),
            Self::Balls { diameter, over } => {
                let alpha = teeth.angle_under_balls(diameter, over)?;
                Some(teeth.base_radius() * alpha.tan() - 0.5 * diameter * teeth.cos_base_helix())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::gear::{Involute, Vector};

    fn teeth(z: u32, module: f64, x: f64, beta: f64) -> MeasuredTeeth {
        MeasuredTeeth {
            tooth_count: z,
            module: module * 1e-3,
            pressure_angle: 20_f64.to_radians(),
            profile_shift: x,
            helix_angle: beta.to_radians(),
        }
    }

    fn span(teeth: &MeasuredTeeth, k: u32, deviation: f64) -> f64 {
        let any = Thickness::Span {
            teeth: k,
            length: 0.0,
        };
        match any.of_deviation(teeth, deviation) {
            Some(Thickness::Span { length, .. }) => length,
            _ => panic!("a span"),
        }
    }

    fn over_balls(teeth: &MeasuredTeeth, diameter: f64, deviation: f64) -> f64 {
        let any = Thickness::Balls {
            diameter,
            over: 0.0,
        };
        match any.of_deviation(teeth, deviation) {
            Some(Thickness::Balls { over, .. }) => over,
            _ => panic!("a size over balls"),
        }
    }

    #[test]
    fn spans_and_sizes_over_balls_are_those_of_printed_tables() {
        // Base tangent lengths of unshifted spur gears of module 1 at 20 degrees, as every handbook prints them: 2.9521 (k − 0.5) + 0.01400554 z.
        for (z, k, printed) in [(17_u32, 2_u32, 4.6663), (30, 4, 10.7526), (50, 6, 16.9370)] {
            let found = span(&teeth(z, 1.0, 0.0, 0.0), k, 0.0) * 1e3;
            assert!((found - printed).abs() < 1e-4, "{z}: {found} {printed}");
        }
    }

    #[test]
    fn what_was_said_comes_back_whichever_way_it_is_said() {
        for (z, x, beta) in [
            (24, 0.2, 0.0),
            (25, -0.1, 0.0),
            (37, 0.3, 25.0),
            (40, 0.0, 15.0),
        ] {
            let teeth = teeth(z, 2.0, x, beta);
            for deviation in [-80e-6, 0.0, 30e-6] {
                for said in [
                    Thickness::Transverse(0.0),
                    Thickness::Normal(0.0),
                    Thickness::Span {
                        teeth: 4,
                        length: 0.0,
                    },
                    Thickness::Balls {
                        diameter: 3.5e-3,
                        over: 0.0,
                    },
                ] {
                    let said = said
                        .of_deviation(&teeth, deviation)
                        .expect("can be measured");
                    let found = said.deviation(&teeth).expect("was measured");
                    assert!((found - deviation).abs() < 1e-13, "{said:?} {found}");
                }
            }
        }
    }

    /// A flank of a tooth in space: the involute of tooth 0, turned by `turn` and along the axis by the twist.
    struct Flank {
        involute: Involute,
        side: f64,
        turn: f64,
        twist: f64,
    }

    impl Flank {
        /// The point at roll length `s` and height `z`, and the outer normal there.
        fn at(&self, s: f64, z: f64) -> (Vector3<f64>, Vector3<f64>) {
            let angle = self.turn + self.twist * z;
            let turned = |v: Vector| {
                let v = Vector::new(v.x, self.side * v.y);
                Vector::new(
                    v.x * angle.cos() - v.y * angle.sin(),
                    v.x * angle.sin() + v.y * angle.cos(),
                )
            };
            let (point, normal) = (
                turned(self.involute.point(s)),
                turned(self.involute.normal(s)),
            );
            // A screw leaves the moment of its normal alone: n_z = −τ (x n_y − y n_x).
            let n_z = -self.twist * (point.x * normal.y - point.y * normal.x);
            let normal = Vector3::new(normal.x, normal.y, n_z).normalize();
            (Vector3::new(point.x, point.y, z), normal)
        }
    }

    fn flanks(teeth: &MeasuredTeeth, deviation: f64) -> (Involute, f64) {
        let half_angle = teeth.nominal_half_angle() + deviation / (2.0 * teeth.reference_radius());
        let involute = Involute::new(teeth.base_radius(), half_angle);
        (involute, teeth.helix_angle.tan() / teeth.reference_radius())
    }

    #[test]
    fn a_span_is_the_distance_of_parallel_planes_that_touch_the_flanks_in_space() {
        // Independent of the formulas: points of the flanks in space, and planes normal to them.
        for (z, k, x, beta) in [(30, 4, 0.0, 0.0), (25, 3, 0.3, 0.0), (40, 6, 0.2, 25.0)] {
            let teeth = teeth(z, 2.0, x, beta);
            let deviation = -50e-6;
            let (involute, twist) = flanks(&teeth, deviation);
            // The other flank of the first tooth, and the loaded one of the last, counter-clockwise.
            let pitch = 2.0 * PI / f64::from(z);
            let first = Flank {
                involute,
                side: -1.0,
                turn: 0.0,
                twist,
            };
            let last = Flank {
                involute,
                side: 1.0,
                turn: pitch * f64::from(k - 1),
                twist,
            };
            // The gauge lies symmetrically about the middle of the teeth: equal roll lengths, and heights on both sides of the middle.
            let out_of_parallel = |s: f64, height: f64| {
                let (_, one) = first.at(s, -height);
                let (_, other) = last.at(s, height);
                (one + other).norm()
            };
            // Normals are opposite where the flanks have turned towards each other: the height that does it for any roll length.
            let s = 0.5 * span(&teeth, k, deviation) * teeth.cos_base_helix();
            let height = 0.5
                * span(&teeth, k, deviation)
                * teeth.helix_angle.sin().abs()
                * teeth.pressure_angle.cos();
            let best = [1.0, -1.0]
                .map(|sign| (out_of_parallel(s, sign * height), sign * height))
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .expect("two");
            assert!(best.0 < 1e-9, "planes are parallel: {}", best.0);
            let (one, normal) = first.at(s, -best.1);
            let (other, _) = last.at(s, best.1);
            let distance = (other - one).dot(&normal).abs();
            assert!(
                (distance - span(&teeth, k, deviation)).abs() < 1e-12,
                "{distance}"
            );
        }
    }

    #[test]
    fn a_ball_in_a_space_touches_both_flanks_and_enters_none() {
        // Independent of the formulas: the least distance of the center from points all over the flank in space.
        for (z, x, beta, diameter) in [
            (24, 0.0, 0.0, 3.5e-3),
            (25, 0.3, 0.0, 3.5e-3),
            (40, 0.2, 25.0, 3.5e-3),
            (37, -0.2, 15.0, 3.5e-3),
        ] {
            let teeth = teeth(z, 2.0, x, beta);
            let deviation = -50e-6;
            let (involute, twist) = flanks(&teeth, deviation);
            let over = over_balls(&teeth, diameter, deviation);
            // The center of a ball in the space counter-clockwise of tooth 0, whose loaded flank it touches; the other flank is its mirror image.
            let radius = 0.5 * (over - diameter) / teeth.opposite();
            let middle = PI / f64::from(z);
            let center = Vector3::new(radius * middle.cos(), radius * middle.sin(), 0.0);
            let flank = Flank {
                involute,
                side: 1.0,
                turn: 0.0,
                twist,
            };
            let away = |s: f64, height: f64| (flank.at(s, height).0 - center).norm();
            let mut place = (teeth.base_radius() * 0.36, 0.0);
            let mut step = 1e-3;
            while step > 1e-10 {
                let neighbors = [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)];
                let better = neighbors
                    .map(|(s, h)| (place.0 + s, place.1 + h))
                    .into_iter()
                    .filter(|(s, _)| *s > 0.0)
                    .find(|(s, h)| away(*s, *h) < away(place.0, place.1));
                match better {
                    Some(better) => place = better,
                    None => step *= 0.5,
                }
            }
            let nearest = away(place.0, place.1);
            assert!(
                (nearest - 0.5 * diameter).abs() < 1e-10,
                "{z} teeth, beta {beta}: {nearest}"
            );
            let said = Thickness::Balls { diameter, over };
            let touch = said.touch(&teeth).expect("touches");
            assert!((touch - place.0).abs() < 1e-6, "{touch} {}", place.0);
        }
    }

    #[test]
    fn balls_of_an_odd_number_of_teeth_stand_apart_as_two_spaces_do() {
        // The distance of two points on a circle under the angle of the spaces that are nearest to opposite, of 25 teeth 12 pitches.
        let teeth = teeth(25, 2.0, 0.0, 0.0);
        let (diameter, over) = (3.5e-3, over_balls(&teeth, 3.5e-3, 0.0));
        let alpha = teeth.angle_under_balls(diameter, over).expect("balls");
        let radius = teeth.base_radius() / alpha.cos();
        let apart = 2.0 * radius * (12.0 * PI / 25.0).sin();
        assert!((apart + diameter - over).abs() < 1e-15);
    }
}
