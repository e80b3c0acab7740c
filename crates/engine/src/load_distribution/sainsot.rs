//! The gear body under a loaded tooth, as Sainsot, Velex and Duverger have it (J. Mech. Des. 126, 2004): a ring whose
//! bore is rigid and fixed.
//!
//! Muskhelishvili's solution for a ring, loaded on its outer circle over the foot of one tooth by a force and a
//! moment (linear normal, constant shear stress), gives
//!
//! δ_f = (F cos² α_m/(E b)) (L (u/S_f)² + M (u/S_f) + P (1 + Q tan² α_m)),
//!
//! where each of L, M, P and Q was fitted as A/θ_f² + B h² + C h/θ_f + D/θ_f + E h + F. In them
//!
//! - h = r_f/r_bore is the ratio of root radius to bore radius;
//! - θ_f is half the angle that the tooth spans at the root circle, where its fillets end, and
//!   S_f = 2 r_f θ_f its width there;
//! - u is the height above the root circle at which the load line crosses the tooth's centerline, and α_m the
//!   load's angle there ([`super::tooth_load`]).
//!
//! δ_f is the displacement of the tooth's foot along the load. Poisson's ratio is inside the fit, so neither it
//! nor the plane state is asked for. The fit was made for 1.4 ≤ h ≤ 7 and 0.01 ≤ θ_f ≤ 0.12; outside it
//! [`Ring::out_of_range`] says so and the value is given all the same.

use super::range::{FormulaQuantity, FormulaRange};
use super::tooth_load::ToothLoad;
use crate::gear::{Member, SpurGear};

/// The range of h = r_f/r_bore that the fit was made for.
const RADIUS_RATIOS: (f64, f64) = (1.4, 7.0);
/// The range of θ_f that the fit was made for, in rad.
const ROOT_HALF_ANGLES: (f64, f64) = (0.01, 0.12);

/// The fit of one of the functions L, M, P and Q.
struct Fit {
    name: char,
    /// A, B, C, D, E and F, in this order.
    coefficients: [f64; 6],
    /// The values that the function takes according to its authors.
    range: (f64, f64),
}

/// L of the moment alone, M of moment and force together, P of the force across the tooth, Q of the force along it relative
/// to P.
const FITS: [Fit; 4] = [
    Fit {
        name: 'L',
        coefficients: [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
        range: (6.82, 6.94),
    },
    Fit {
        name: 'M',
        coefficients: [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
        range: (1.08, 3.29),
    },
    Fit {
        name: 'P',
        coefficients: [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
        range: (2.56, 13.47),
    },
    Fit {
        name: 'Q',
        coefficients: [
            -6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904,
        ],
        range: (0.141, 0.62),
    },
];

impl Fit {
    fn at(&self, radius_ratio: f64, root_half_angle: f64) -> f64 {
        let (h, theta) = (radius_ratio, root_half_angle);
        let [a, b, c, d, e, f] = self.coefficients;
        a / theta.powi(2) + b * h.powi(2) + c * h / theta + d / theta + e * h + f
    }
}

/// A gear body that carries one tooth: a ring on a rigid bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ring {
    root_radius: f64,
    bore_radius: f64,
    root_half_angle: f64,
}

impl Ring {
    /// The body of `gear`, without its holes.
    pub(super) fn of(gear: &SpurGear) -> Self {
        let fillet = gear.fillet();
        let foot = fillet.point(fillet.ends().1);
        Self {
            root_radius: gear.root_radius(),
            bore_radius: gear.bore_radius(),
            root_half_angle: foot.y.atan2(foot.x),
        }
    }

    /// The width S_f = 2 r_f θ_f of the tooth at the root circle, in m.
    pub(super) fn root_width(&self) -> f64 {
        2.0 * self.root_radius * self.root_half_angle
    }

    /// The compliance δ_f/F of the body under `load`, in m/N along the load, for `face_width` (m) and
    /// `youngs_modulus` (Pa). Far outside its range the fit can give one that is not positive.
    pub(super) fn compliance(&self, load: &ToothLoad, face_width: f64, youngs_modulus: f64) -> f64 {
        let [l, m, p, q] = self.functions();
        let (u_s, alpha_m) = (load.height / self.root_width(), load.angle);
        alpha_m.cos().powi(2) / (youngs_modulus * face_width)
            * (l * u_s.powi(2) + m * u_s + p * (1.0 + q * alpha_m.tan().powi(2)))
    }

    /// Values of this body, which is that of `member`, outside the range of the fit: h and θ_f, or, where these lie within it, the functions that the fit does
    /// not follow there.
    pub(super) fn out_of_range(&self, member: Member) -> Vec<FormulaRange> {
        let outside =
            |quantity, value, range| FormulaRange::outside(quantity, Some(member), value, range);
        let h = outside(
            FormulaQuantity::RadiusRatio,
            self.radius_ratio(),
            RADIUS_RATIOS,
        );
        let theta_f = outside(
            FormulaQuantity::RootHalfAngle,
            self.root_half_angle,
            ROOT_HALF_ANGLES,
        );
        if h.is_some() || theta_f.is_some() {
            return h.into_iter().chain(theta_f).collect();
        }
        FITS.iter()
            .zip(self.functions())
            .filter_map(|(fit, value)| {
                outside(FormulaQuantity::BodyFunction(fit.name), value, fit.range)
            })
            .collect()
    }

    /// h = r_f/r_bore.
    fn radius_ratio(&self) -> f64 {
        self.root_radius / self.bore_radius
    }

    /// L, M, P and Q of this body.
    fn functions(&self) -> [f64; 4] {
        FITS.map(|fit| fit.at(self.radius_ratio(), self.root_half_angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::spur::tests::paper_gear;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn body(radius_ratio: f64, root_half_angle: f64) -> Ring {
        Ring {
            root_radius: radius_ratio * 10e-3,
            bore_radius: 10e-3,
            root_half_angle,
        }
    }

    /// θ_f of the published codes for 50 teeth, which the third vector was computed with; it prints as 0.0566165.
    fn root_half_angle_of_the_vector() -> f64 {
        let alpha = 20_f64.to_radians();
        let rho = 0.25 / (1.0 - alpha.sin());
        (FRAC_PI_2 + 2.0 * alpha.tan() * (1.0 - rho) + 2.0 * rho / alpha.cos()) / 50.0
    }

    #[test]
    fn the_fit_takes_its_known_values_to_six_decimals() {
        let theta_f = root_half_angle_of_the_vector();
        assert!((theta_f - 0.056_616_5).abs() < 0.5e-7);
        for (body, printed) in [
            (body(3.0, 0.05), [6.927112, 1.190046, 4.324115, 0.437799]),
            (body(5.0, 0.1), [6.920655, 1.966800, 7.490917, 0.233233]),
            (
                body(4.75, theta_f),
                [6.935688, 1.626255, 7.266986, 0.280839],
            ),
        ] {
            for (value, print) in body.functions().into_iter().zip(printed) {
                assert!((value - print).abs() < 0.5e-6, "{value} beside {print}");
            }
            assert_eq!(body.out_of_range(Member::Driving), []);
        }
    }

    #[test]
    fn the_compliance_is_the_printed_sum() {
        // By hand with the printed coefficients of (3, 0.05): S_f = 3 mm, u = 3 mm, α_m = 45 degrees, so cos² =
        // 1/2, tan² = 1, and E b = 4.2e9 N/m; six digits of L, M, P and Q.
        let load = ToothLoad {
            height: 3e-3,
            angle: FRAC_PI_2 / 2.0,
            depth: 1e-3,
        };
        let by_hand = 0.5 / 4.2e9 * (6.927112 + 1.190046 + 4.324115 * 1.437799);
        let compliance = body(3.0, 0.05).compliance(&load, 20e-3, 210e9);
        assert!((compliance / by_hand - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_load_that_points_away_from_the_hub_is_as_compliant_as_one_toward_it() {
        let at = |angle| {
            body(4.0, 0.05).compliance(
                &ToothLoad {
                    height: 3e-3,
                    angle,
                    depth: 1e-3,
                },
                20e-3,
                210e9,
            )
        };
        assert_eq!(at(0.2), at(-0.2));
    }

    #[test]
    fn a_larger_bore_stiffens_the_body() {
        // The bore is rigid: the thinner the ring between bore and teeth, the stiffer. Within the fit's range.
        let load = ToothLoad {
            height: 2.5e-3,
            angle: 0.33,
            depth: 1.6e-3,
        };
        let compliance = |bore_radius| {
            let ring = Ring {
                root_radius: 47.5e-3,
                bore_radius,
                root_half_angle: 0.06,
            };
            ring.compliance(&load, 20e-3, 210e9)
        };
        assert!(compliance(10e-3) > compliance(15e-3) && compliance(15e-3) > compliance(25e-3));
    }

    #[test]
    fn a_body_outside_the_fit_is_flagged_with_what_is_outside() {
        let flagged = |radius_ratio, theta_f| {
            body(radius_ratio, theta_f)
                .out_of_range(Member::Driving)
                .iter()
                .map(|found| found.quantity)
                .collect::<Vec<_>>()
        };
        assert_eq!(flagged(8.0, 0.05), [FormulaQuantity::RadiusRatio]);
        assert_eq!(flagged(3.0, 0.15), [FormulaQuantity::RootHalfAngle]);
        // Within both ranges the fit can still leave the values that its authors give for it.
        assert_eq!(
            flagged(1.4, 0.12),
            ['M', 'P'].map(FormulaQuantity::BodyFunction)
        );
    }

    #[test]
    fn the_foot_of_the_tooth_is_where_a_sharp_or_a_full_rack_leaves_it() {
        // The center of the rack's rounding passes the line of centers π m/4 + (h_f − ρ) tan α + ρ/cos α from the middle of
        // its space while the reference circle rolls on the rack; with the full rounding the fillets of two teeth meet.
        let mut data = paper_gear(50);
        let full = data.rack.largest_tip_radius();
        for tip_radius in [1e-9, full] {
            data.rack.tip_radius = tip_radius;
            let ring = Ring::of(&SpurGear::new(data.clone()).expect("a gear of 50 teeth"));
            let (alpha, rho) = (20_f64.to_radians(), tip_radius);
            let along = PI * 2e-3 / 4.0 + (2.5e-3 - rho) * alpha.tan() + rho / alpha.cos();
            assert!((ring.root_half_angle - along / 50e-3).abs() < 1e-12);
        }
        let ring = Ring::of(&SpurGear::new(data).expect("a gear of 50 teeth"));
        assert!((ring.root_half_angle - PI / 50.0).abs() < 1e-12);
    }
}
