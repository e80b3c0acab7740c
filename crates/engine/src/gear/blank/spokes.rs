//! Straight spokes of constant width between a hub ring and a rim.

use std::f64::consts::{PI, TAU};

use super::contour::{Contour, Side};
use super::hole::Hole;
use crate::gear::{Vector, radial, tangential};

/// Straight spokes, evenly spaced, and the openings between them. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spokes {
    /// The number of spokes N.
    pub count: u32,
    /// The width of each, the same from the hub ring to the rim.
    pub width: f64,
    /// The radius of the fillets at both ends.
    pub fillet_radius: f64,
    /// Where the openings begin: the radius of the hub ring.
    pub inner_radius: f64,
    /// Where the openings end: the inner radius of the rim.
    pub outer_radius: f64,
    /// The angle of the centerline of spoke 0 from the centerline of tooth 0, positive towards its loaded flank, in radians.
    pub phase: f64,
}

/// Faults of spokes. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpokesFault {
    /// There are fewer than two.
    TooFew,
    /// The rim begins where the hub ring ends, or further in.
    NoLength,
    /// Neighboring spokes overlap at the hub ring.
    Overlap {
        /// The width at which they just meet there.
        largest_width: f64,
    },
    /// The fillets of an opening leave no room for each other.
    FilletsDoNotFit {
        /// The largest radius that fits.
        largest_radius: f64,
    },
}

impl Spokes {
    /// The openings, the first between spoke 0 and spoke 1, counter-clockwise.
    ///
    /// A fillet of radius ρ stands off the centerline of its spoke by w/2 + ρ, and off the axis by r_i + ρ or r_o − ρ.
    ///
    /// # Errors
    ///
    /// [`SpokesFault`].
    pub fn openings(&self) -> Result<Vec<Hole>, SpokesFault> {
        let (half, rho) = (self.width / 2.0, self.fillet_radius);
        let (inner, outer) = (self.inner_radius, self.outer_radius);
        if self.count < 2 {
            return Err(SpokesFault::TooFew);
        }
        if !(outer > inner && inner > 0.0) {
            return Err(SpokesFault::NoLength);
        }
        let pitch = TAU / f64::from(self.count);
        let sin = (pitch / 2.0).sin();
        if half.is_nan() || half >= inner * sin {
            let largest_width = 2.0 * inner * sin;
            return Err(SpokesFault::Overlap { largest_width });
        }
        // Fillets that meet on the hub ring, on the rim, and along the spoke.
        let largest_radius = [
            match self.count {
                2 => f64::INFINITY,
                _ => (inner * sin - half) / (1.0 - sin),
            },
            (outer * sin - half) / (1.0 + sin),
            (outer - inner) / 2.0,
        ]
        .into_iter()
        .fold(f64::INFINITY, f64::min);
        if !(rho > 0.0 && rho <= largest_radius) {
            return Err(SpokesFault::FilletsDoNotFit { largest_radius });
        }

        // Beside the spoke on the clockwise side, whose centerline is at −π/N; the other side is its mirror image.
        let (along, across) = (radial(-pitch / 2.0), tangential(-pitch / 2.0));
        let off = half + rho;
        let center =
            |distance: f64| (distance * distance - off * off).sqrt() * along + off * across;
        let on_spoke = |center: Vector| center - rho * across;
        let mirrored = |p: Vector| Vector::new(p.x, -p.y);
        let (low, high) = (center(inner + rho), center(outer - rho));
        let ring = low * (inner / (inner + rho));
        let rim = high * (outer / (outer - rho));
        let polar = |p: Vector| p.y.atan2(p.x);
        let bulge = |angle: f64| (angle / 4.0).tan();
        // Around the corner from the spoke to the rim, and from the hub ring to the spoke.
        let to_rim = bulge(PI / 2.0 + (polar(rim) - polar(along)));
        let to_ring = bulge(PI / 2.0 - (polar(ring) - polar(along)));
        let corners = [
            (ring, to_ring),
            (on_spoke(low), 0.0),
            (on_spoke(high), to_rim),
            (rim, bulge(-2.0 * polar(rim))),
            (mirrored(rim), to_rim),
            (mirrored(on_spoke(high)), 0.0),
            (mirrored(on_spoke(low)), to_ring),
            (mirrored(ring), bulge(2.0 * polar(ring))),
        ];
        let sides: Vec<Side> = (0..corners.len())
            .map(|i| {
                Side::new(
                    corners[i].0,
                    corners[(i + 1) % corners.len()].0,
                    corners[i].1,
                )
            })
            // Fillets that just fit leave nothing between them.
            .filter(|side| side.length() > 1e-9 * outer)
            .collect();
        let opening = Contour::opening(&sides)
            .map_err(|_| SpokesFault::FilletsDoNotFit { largest_radius })?;
        let angle = |i: u32| self.phase + (f64::from(i) + 0.5) * pitch + opening.angle;
        Ok((0..self.count)
            .map(|i| Hole {
                angle: angle(i),
                ..opening.clone()
            })
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::{BlankRegion, HoleShape, Moments};
    use crate::quadrature::gauss_legendre_panels;

    const SPOKES: Spokes = Spokes {
        count: 5,
        width: 4e-3,
        fillet_radius: 3e-3,
        inner_radius: 19e-3,
        outer_radius: 39e-3,
        phase: 0.3,
    };

    fn blank(spokes: &Spokes) -> BlankRegion {
        BlankRegion {
            holes: spokes.openings().expect("spokes"),
            ..BlankRegion::solid(12e-3)
        }
    }

    #[test]
    fn openings_have_the_moments_of_their_angle_over_the_radius() {
        for spokes in [
            SPOKES,
            Spokes { count: 2, ..SPOKES },
            Spokes {
                count: 11,
                width: 1e-3,
                fillet_radius: 2e-3,
                ..SPOKES
            },
        ] {
            let (half, rho) = (spokes.width / 2.0, spokes.fillet_radius);
            let mut expected = Moments::default();
            // From the centerline of the spoke to the opening: a fillet, the spoke's side, a fillet.
            let fillet = |r: f64, d: f64| {
                let seen = ((half + rho) / d).asin();
                seen - ((r * r + d * d - rho * rho) / (2.0 * r * d))
                    .min(1.0)
                    .acos()
            };
            let (low, high) = (spokes.inner_radius + rho, spokes.outer_radius - rho);
            let tangent = |d: f64| (d * d - (half + rho).powi(2)).sqrt().hypot(half);
            let radii = [
                spokes.inner_radius,
                tangent(low),
                tangent(high),
                spokes.outer_radius,
            ];
            for (k, ends) in radii.windows(2).enumerate() {
                for (s, weight) in gauss_legendre_panels(-PI / 2.0, PI / 2.0, 40) {
                    // Square roots at both ends are smooth in s.
                    let r = f64::midpoint(ends[0], ends[1]) + (ends[1] - ends[0]) / 2.0 * s.sin();
                    let weight = weight * (ends[1] - ends[0]) / 2.0 * s.cos();
                    let taken = match k {
                        0 => fillet(r, low),
                        1 => (half / r).asin(),
                        _ => fillet(r, high),
                    };
                    let reach = PI / f64::from(spokes.count) - taken;
                    expected = expected
                        + Moments {
                            area: weight * 2.0 * reach * r,
                            first: weight * 2.0 * reach.sin() * r * r * radial(0.0),
                            polar: weight * 2.0 * reach * r.powi(3),
                        };
                }
            }
            for (i, opening) in spokes.openings().expect("spokes").iter().enumerate() {
                let found = opening.moments();
                let middle = 0.3 + (i as f64 + 0.5) * TAU / f64::from(spokes.count);
                let first = expected.first.x * radial(middle);
                assert!((found.area / expected.area - 1.0).abs() < 1e-11);
                assert!((found.polar / expected.polar - 1.0).abs() < 1e-11);
                assert!((found.first - first).norm() < 1e-11 * expected.area * 30e-3);
            }
        }
    }

    #[test]
    fn spokes_are_as_wide_as_drawn_and_repeat_with_their_number() {
        let blank = blank(&SPOKES);
        assert_eq!(blank.symmetry().count, 5);
        assert_eq!((blank.symmetry().orbits.len(), blank.pattern()), (1, None));
        let (_, least) = blank.least_ligament(45e-3).expect("openings");
        assert!((least - 4e-3).abs() < 1e-15, "{least}");
        assert!((blank.inner_reach().expect("openings") - 19e-3).abs() < 1e-15);
        assert!((blank.outer_reach().expect("openings") - 39e-3).abs() < 1e-15);
        assert_eq!(blank.holes[0].ligament_between_own_ends(), f64::INFINITY);
        // The point in the middle of spoke 0 stands half a width off both neighbors.
        let middle = 29e-3 * radial(0.3);
        for opening in [&blank.holes[0], &blank.holes[4]] {
            assert!((opening.distance_to(middle) - 2e-3).abs() < 1e-15);
        }
    }

    #[test]
    fn spokes_remove_a_fifth_more_than_kidneys_with_equal_ligaments() {
        // Six between the same two circles, both leaving 3 mm between openings: kidneys end in half circles. With five it is 16 % more, with seven 25 %.
        let spokes = Spokes {
            count: 6,
            width: 3e-3,
            ..SPOKES
        };
        let kidney = |angle: f64, span: f64| Hole {
            circle_radius: 29e-3,
            angle,
            shape: HoleShape::Slot {
                width: 20e-3,
                angle: span,
            },
        };
        let between = TAU / 6.0;
        // The ends of two kidneys stand 23 mm apart, as a chord of their circle.
        let span = between - 2.0 * (23.0_f64 / (2.0 * 29.0)).asin();
        let kidneys = [kidney(0.0, span), kidney(between, span)];
        assert!((kidneys[0].ligament_to(&kidneys[1]) - 3e-3).abs() < 1e-15);
        let more = blank(&spokes).hole_area() / (6.0 * kidneys[0].moments().area);
        println!("spokes remove {more:.4} of what kidneys remove");
        assert!(more > 1.2 && more < 1.21);
    }

    #[test]
    fn spokes_that_do_not_fit_are_refused_with_what_would() {
        let refused = |spokes: Spokes| spokes.openings().expect_err("a refusal");
        assert_eq!(refused(Spokes { count: 1, ..SPOKES }), SpokesFault::TooFew);
        assert_eq!(
            refused(Spokes {
                outer_radius: 19e-3,
                ..SPOKES
            }),
            SpokesFault::NoLength
        );
        let SpokesFault::Overlap { largest_width } = refused(Spokes {
            width: 30e-3,
            ..SPOKES
        }) else {
            panic!("they overlap")
        };
        assert!((largest_width - 38e-3 * (PI / 5.0).sin()).abs() < 1e-15);
        for tight in [
            Spokes {
                fillet_radius: 12e-3,
                width: 1e-3,
                count: 3,
                ..SPOKES
            },
            Spokes {
                fillet_radius: 9e-3,
                count: 12,
                ..SPOKES
            },
            Spokes {
                fillet_radius: 9e-3,
                count: 8,
                inner_radius: 6e-3,
                ..SPOKES
            },
        ] {
            let SpokesFault::FilletsDoNotFit { largest_radius } = refused(tight) else {
                panic!("they do not fit")
            };
            let with = |fillet_radius| {
                Spokes {
                    fillet_radius,
                    ..tight
                }
                .openings()
            };
            assert!(
                with(largest_radius * (1.0 - 1e-6)).is_ok(),
                "{tight:?}: {largest_radius}"
            );
            assert!(with(largest_radius * (1.0 + 1e-6)).is_err());
        }
    }
}
