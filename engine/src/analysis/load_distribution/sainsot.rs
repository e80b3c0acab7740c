//! The gear body under a loaded tooth, as Sainsot, Velex and Duverger have it (J. Mech. Des. 126, 2004): a ring whose
//! bore is rigid and fixed.
//!
//! Muskhelishvili's solution for a ring, loaded on its outer circle over the foot of one tooth by a force and a
//! moment (linear normal, constant shear stress), gives
//!
//! δ_f = (F cos²(α_m)/(E b)) (L (u/S_f)² + M (u/S_f) + P (1 + Q tan²(α_m))),
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
//! [`GearBody::extrapolations`] says so and the value is given all the same.

use super::quantity::{NotPositive, positive};
use super::tooth_load::ToothLoad;

/// The range of h = r_f/r_bore that the fit was made for.
const RADIUS_RATIOS: (f64, f64) = (1.4, 7.0);
/// The range of θ_f that the fit was made for, in rad.
const ROOT_HALF_ANGLES: (f64, f64) = (0.01, 0.12);

/// The fit of one of the functions L, M, P and Q.
struct Fit {
    name: &'static str,
    /// A, B, C, D, E and F, in this order.
    coefficients: [f64; 6],
    /// The values that the function takes according to its authors.
    range: (f64, f64),
}

const L: Fit = Fit {
    name: "L",
    coefficients: [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
    range: (6.82, 6.94),
};
const M: Fit = Fit {
    name: "M",
    coefficients: [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
    range: (1.08, 3.29),
};
const P: Fit = Fit {
    name: "P",
    coefficients: [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
    range: (2.56, 13.47),
};
const Q: Fit = Fit {
    name: "Q",
    coefficients: [
        -6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904,
    ],
    range: (0.141, 0.62),
};

impl Fit {
    fn at(&self, radius_ratio: f64, root_half_angle: f64) -> f64 {
        let (h, theta) = (radius_ratio, root_half_angle);
        let [a, b, c, d, e, f] = self.coefficients;
        a / theta.powi(2) + b * h.powi(2) + c * h / theta + d / theta + e * h + f
    }
}

/// The four functions of the fit, at one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// L, of the moment alone.
    pub l: f64,
    /// M, of the moment and the force together.
    pub m: f64,
    /// P, of the force across the tooth.
    pub p: f64,
    /// Q, of the force along the tooth, relative to P.
    pub q: f64,
}

/// A gear body that carries one tooth: a ring on a rigid bore.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearBody {
    root_radius: f64,
    bore_radius: f64,
    root_half_angle: f64,
    coefficients: Coefficients,
}

/// A ring that cannot carry a tooth.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GearBodyError {
    /// A length, angle or modulus is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// The bore reaches the root circle.
    #[error(
        "a bore of radius {bore_radius} m leaves no ring inside the root circle of radius {root_radius} m"
    )]
    NoRing {
        /// The bore's radius, in m.
        bore_radius: f64,
        /// The root circle's radius, in m.
        root_radius: f64,
    },
    /// The fit has left the body without a positive compliance, far outside its range.
    #[error(
        "the fit gives the body a compliance of {compliance} m/N at h = {radius_ratio} and theta_f = {root_half_angle} rad"
    )]
    NotCompliant {
        /// What came out, in m/N.
        compliance: f64,
        /// The body's r_f/r_bore.
        radius_ratio: f64,
        /// The body's θ_f, in rad.
        root_half_angle: f64,
    },
}

/// A quantity that lies outside the range that the fit was made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extrapolation {
    /// `r_f/r_bore`, `θ_f`, or one of `L`, `M`, `P`, `Q`.
    pub quantity: &'static str,
    /// Its value (θ_f in rad, the others without unit).
    pub value: f64,
    /// The lower end of the range.
    pub least: f64,
    /// The upper end of the range.
    pub greatest: f64,
}

impl GearBody {
    /// The ring between `bore_radius` and `root_radius` (m) whose teeth span `root_half_angle` (θ_f, rad) to each
    /// side at the root circle.
    ///
    /// # Errors
    ///
    /// [`GearBodyError`] if a number is not positive or the bore leaves no ring.
    pub fn new(
        root_radius: f64,
        bore_radius: f64,
        root_half_angle: f64,
    ) -> Result<Self, GearBodyError> {
        let r_f = positive("the root radius", root_radius)?;
        let r_bore = positive("the bore radius", bore_radius)?;
        let theta_f = positive("the root half-angle", root_half_angle)?;
        if r_bore >= r_f {
            return Err(GearBodyError::NoRing {
                bore_radius,
                root_radius,
            });
        }
        let value = |fit: Fit| fit.at(r_f / r_bore, theta_f);
        let coefficients = Coefficients {
            l: value(L),
            m: value(M),
            p: value(P),
            q: value(Q),
        };
        Ok(Self {
            root_radius,
            bore_radius,
            root_half_angle,
            coefficients,
        })
    }

    /// The ratio h = r_f/r_bore.
    pub fn radius_ratio(&self) -> f64 {
        self.root_radius / self.bore_radius
    }

    /// The width S_f = 2 r_f θ_f of the tooth at the root circle, in m.
    pub fn root_width(&self) -> f64 {
        2.0 * self.root_radius * self.root_half_angle
    }

    /// L, M, P and Q of this body.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }

    /// What of this body lies outside the range of the fit; empty for a body within it.
    pub fn extrapolations(&self) -> Vec<Extrapolation> {
        let Coefficients { l, m, p, q } = self.coefficients;
        let checks = [
            ("r_f/r_bore", self.radius_ratio(), RADIUS_RATIOS),
            ("theta_f", self.root_half_angle, ROOT_HALF_ANGLES),
            (L.name, l, L.range),
            (M.name, m, M.range),
            (P.name, p, P.range),
            (Q.name, q, Q.range),
        ];
        let outside = |&(_, value, (least, greatest)): &(&str, f64, (f64, f64))| {
            !(least..=greatest).contains(&value)
        };
        checks
            .into_iter()
            .filter(outside)
            .map(|(quantity, value, (least, greatest))| Extrapolation {
                quantity,
                value,
                least,
                greatest,
            })
            .collect()
    }

    /// The compliance δ_f/F of the body under `load`, in m/N along the load, for `face_width` (m) and
    /// `young_modulus` (Pa).
    ///
    /// # Errors
    ///
    /// [`GearBodyError`] if a number is not positive, or far outside the fit's range what comes out is not.
    pub fn compliance(
        &self,
        load: &ToothLoad,
        face_width: f64,
        young_modulus: f64,
    ) -> Result<f64, GearBodyError> {
        let b = positive("the face width", face_width)?;
        let e = positive("Young's modulus", young_modulus)?;
        let Coefficients { l, m, p, q } = self.coefficients;
        let u_s = positive("the height of the load", load.height)? / self.root_width();
        let alpha_m = load.angle;

        let compliance = alpha_m.cos().powi(2) / (e * b)
            * (l * u_s.powi(2) + m * u_s + p * (1.0 + q * alpha_m.tan().powi(2)));
        if compliance > 0.0 && compliance.is_finite() {
            Ok(compliance)
        } else {
            Err(GearBodyError::NotCompliant {
                compliance,
                radius_ratio: self.radius_ratio(),
                root_half_angle: self.root_half_angle,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn body(radius_ratio: f64, root_half_angle: f64) -> GearBody {
        GearBody::new(radius_ratio * 10e-3, 10e-3, root_half_angle).expect("the ring exists")
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
        for (body, [l, m, p, q]) in [
            (body(3.0, 0.05), [6.927112, 1.190046, 4.324115, 0.437799]),
            (body(5.0, 0.1), [6.920655, 1.966800, 7.490917, 0.233233]),
            (
                body(4.75, theta_f),
                [6.935688, 1.626255, 7.266986, 0.280839],
            ),
        ] {
            let got = body.coefficients();
            for (value, print) in [(got.l, l), (got.m, m), (got.p, p), (got.q, q)] {
                assert!((value - print).abs() < 0.5e-6, "{value} beside {print}");
            }
            assert_eq!(body.extrapolations(), []);
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
        let compliance = body(3.0, 0.05)
            .compliance(&load, 20e-3, 210e9)
            .expect("the body is in range");
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
        let compliance = |bore| {
            GearBody::new(47.5e-3, bore, 0.06)
                .expect("the ring exists")
                .compliance(&load, 20e-3, 210e9)
                .expect("the body is in range")
        };
        assert!(compliance(10e-3) > compliance(15e-3) && compliance(15e-3) > compliance(25e-3));
    }

    #[test]
    fn a_body_outside_the_fit_is_computed_and_flagged() {
        let flagged = |radius_ratio, theta_f| {
            body(radius_ratio, theta_f)
                .extrapolations()
                .iter()
                .map(|e| e.quantity)
                .collect::<Vec<_>>()
        };
        assert!(flagged(8.0, 0.05).contains(&"r_f/r_bore"));
        assert!(flagged(3.0, 0.15).contains(&"theta_f"));
        // Within both ranges the fit can still leave the values that its authors give for it.
        assert_eq!(flagged(1.4, 0.12), ["M", "P"]);
        let load = ToothLoad {
            height: 2.5e-3,
            angle: 0.33,
            depth: 1.6e-3,
        };
        assert!(body(8.0, 0.05).compliance(&load, 20e-3, 210e9).is_ok());
    }

    #[test]
    fn a_ring_that_cannot_be_is_refused() {
        assert!(matches!(
            GearBody::new(47.5e-3, 47.5e-3, 0.06),
            Err(GearBodyError::NoRing { .. })
        ));
        assert!(matches!(
            GearBody::new(47.5e-3, 0.0, 0.06),
            Err(GearBodyError::NotPositive(_))
        ));
        assert!(matches!(
            GearBody::new(47.5e-3, 10e-3, f64::NAN),
            Err(GearBodyError::NotPositive(_))
        ));
        // At θ_f = 0.001 rad the term A/θ_f² has taken over and P is about -450.
        let load = ToothLoad {
            height: 1e-6,
            angle: 0.0,
            depth: 1.6e-3,
        };
        assert!(matches!(
            body(3.0, 1e-3).compliance(&load, 20e-3, 210e9),
            Err(GearBodyError::NotCompliant { .. })
        ));
    }
}
