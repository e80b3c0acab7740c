//! The tooth as a cantilever of its true profile: Weber and Banaschek's integral (1953).
//!
//! With y from the root circle up the centerline, 2 x(y) the tooth's thickness there, y_p = u the height at which the
//! load line crosses the centerline and α' = α_m the load's angle ([`super::tooth_load`]), a section carries
//! the moment F cos(α') (y_p - y), the shear force F cos(α') and the axial force F sin(α'). Its second
//! moment of area is b (2x)³/12, its area b 2x. The load's work, F δ/2, is the energy of these three, so
//!
//! δ/F = (cos²(α')/b) ( (12/E') ∫ (y_p - y)²/(2x)³ dy + (1.2/G) ∫ dy/(2x) +
//! (tan²(α')/E') ∫ dy/(2x) ), from 0 to y_p.
//!
//! The three terms are bending, shear and compression. 1.2 = 6/5 is the shear factor of a rectangle;
//! 1.2/G = 2.4 (1 + ν)/E. E' is E in plane stress and E/(1 - ν²) in plane strain, where the numbers for ν = 0.3 are Weber and
//! Banaschek's 10.92, 3.1 and 0.91 = 3.1 x 0.294, all over E. The body under the tooth and the contact are not in it.

use crate::analysis::PlaneState;

use super::elastic_constants::ElasticConstants;
use super::quantity::{NotPositive, positive};
use super::tooth_load::ToothLoad;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// The shear factor of a rectangular section.
const SHEAR_FACTOR: f64 = 6.0 / 5.0;
/// Gauss points in a panel.
const POINT_COUNT: usize = 16;
/// Panels between root and load.
const PANEL_COUNT: u32 = 12;

/// The compliance of a tooth in its three parts, each in m/N along the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToothCompliance {
    /// The share of bending.
    pub bending: f64,
    /// The share of shear.
    pub shear: f64,
    /// The share of compression along the tooth.
    pub compression: f64,
}

/// A profile that is no tooth.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ToothError {
    /// A length is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// The profile has no thickness at a height below the load.
    #[error("the tooth has the half-thickness {half_thickness} m at the height {height} m")]
    NoThickness {
        /// The height y above the root circle, in m.
        height: f64,
        /// What the profile gave there, in m.
        half_thickness: f64,
    },
}

impl ToothCompliance {
    /// The compliance of the tooth, δ/F, in m/N.
    pub fn total(&self) -> f64 {
        self.bending + self.shear + self.compression
    }
}

/// The compliance of a tooth under `load`, by integrating over its profile from the root circle to the height of the
/// load.
///
/// `half_thickness` is x(y): half the tooth's thickness across its centerline at the height y above the root circle, both in m,
/// asked for on 0 < y < u only. It may start with a vertical tangent in y, as a fillet does that ends on the root
/// circle, and may have kinks. `face_width` is b, in m.
///
/// # Errors
///
/// [`ToothError`] if a length is not positive, or the profile has no thickness somewhere below the load.
pub fn tooth_compliance(
    half_thickness: impl Fn(f64) -> f64,
    load: &ToothLoad,
    face_width: f64,
    material: &ElasticConstants,
    plane: PlaneState,
) -> Result<ToothCompliance, ToothError> {
    let b = positive("the face width", face_width)?;
    let y_p = positive("the height of the load", load.height)?;
    let (sin, cos) = load.angle.sin_cos();
    let (e, g) = (material.plane_modulus(plane), material.shear_modulus());

    let (mut of_moment, mut of_force) = (0.0, 0.0);
    for (y, weight) in heights(y_p) {
        let x = half_thickness(y);
        if !(x > 0.0 && x.is_finite()) {
            return Err(ToothError::NoThickness {
                height: y,
                half_thickness: x,
            });
        }
        of_moment += weight * (y_p - y).powi(2) / (2.0 * x).powi(3);
        of_force += weight / (2.0 * x);
    }
    Ok(ToothCompliance {
        bending: cos.powi(2) / b * 12.0 / e * of_moment,
        shear: cos.powi(2) / b * SHEAR_FACTOR / g * of_force,
        compression: sin.powi(2) / b / e * of_force,
    })
}

/// Heights between 0 and `y_p` with the weights of an integral over them.
///
/// A fillet that is tangent to the root circle makes the thickness start like the root of y; with y = y_p τ² it is
/// smooth in τ, so the panels are in τ. Several of them keep the error of a kink, where fillet and flank join, to
/// that of one panel.
fn heights(y_p: f64) -> impl Iterator<Item = (f64, f64)> {
    (0..PANEL_COUNT).flat_map(move |panel| {
        let width = 1.0 / f64::from(PANEL_COUNT);
        GAUSS.iter().map(move |&(point, weight)| {
            let tau = (f64::from(panel) + 0.5 * (1.0 + point)) * width;
            (y_p * tau.powi(2), 0.5 * weight * width * 2.0 * y_p * tau)
        })
    })
}

/// Points and weights of the Gauss-Legendre rule on (-1, 1).
static GAUSS: LazyLock<[(f64, f64); POINT_COUNT]> = LazyLock::new(|| {
    let n = POINT_COUNT as f64;
    std::array::from_fn(|k| {
        // The usual first guess lies close enough for Newton's method to double its digits each time: six steps are
        // more than it needs.
        let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        for _ in 0..6 {
            let (p, slope) = legendre(x);
            x -= p / slope;
        }
        let (_, slope) = legendre(x);
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
});

/// The Legendre polynomial of degree [`POINT_COUNT`] and its derivative, inside (-1, 1).
fn legendre(x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 2..=POINT_COUNT {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    (p, POINT_COUNT as f64 * (x * p - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const B: f64 = 20e-3;
    const LOAD: ToothLoad = ToothLoad {
        height: 3e-3,
        angle: 0.33,
        depth: 1.5e-3,
    };

    fn steel() -> ElasticConstants {
        ElasticConstants::new(210e9, 0.3).expect("steel is a material")
    }

    fn compliance(
        half_thickness: impl Fn(f64) -> f64,
        load: &ToothLoad,
        plane: PlaneState,
    ) -> ToothCompliance {
        tooth_compliance(half_thickness, load, B, &steel(), plane).expect("the profile is a tooth")
    }

    #[test]
    fn the_gauss_rule_integrates_what_it_must() {
        // Exact for polynomials up to degree 2 n - 1 = 31; rounding only.
        for degree in 0..=31 {
            let sum: f64 = GAUSS.iter().map(|&(x, w)| w * x.powi(degree)).sum();
            let exact = if degree % 2 == 0 {
                2.0 / f64::from(degree + 1)
            } else {
                0.0
            };
            assert!(
                (sum - exact).abs() < 1e-14,
                "degree {degree}: {sum} beside {exact}"
            );
        }
    }

    #[test]
    fn a_parallel_tooth_is_timoshenkos_cantilever() {
        // δ/F = cos² l³/(3 E' I) + 1.2 cos² l/(G A) + sin² l/(E' A), with I = b t³/12 and A = b t; rounding
        // only.
        let (l, t, e, nu) = (3e-3_f64, 4e-3_f64, 210e9, 0.3);
        for (plane, e_plane) in [
            (PlaneState::Stress, e),
            (PlaneState::Strain, e / (1.0 - nu * nu)),
        ] {
            let tooth = compliance(|_| 0.5 * t, &LOAD, plane);
            let (sin, cos) = LOAD.angle.sin_cos();
            let (i, a, g) = (B * t.powi(3) / 12.0, B * t, e / (2.0 * (1.0 + nu)));
            assert!(
                (tooth.bending / (cos * cos * l.powi(3) / (3.0 * e_plane * i)) - 1.0).abs() < 1e-13
            );
            assert!((tooth.shear / (1.2 * cos * cos * l / (g * a)) - 1.0).abs() < 1e-13);
            assert!((tooth.compression / (sin * sin * l / (e_plane * a)) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn a_tapered_tooth_is_the_wedge_integrated_by_hand() {
        // Thickness t(y) = t_0 - k y, t_1 at the load. By hand: ∫ dy/t = ln(t_0/t_1)/k and ∫ (y_p - y)²/t³ dy =
        // (ln(t_0/t_1) + 2 t_1 (1/t_0 - 1/t_1) - t_1² (1/t_0² - 1/t_1²)/2)/k³; rounding only.
        let (l, t_0, t_1) = (3e-3, 5e-3_f64, 2e-3_f64);
        let k = (t_0 - t_1) / l;
        let of_force = (t_0 / t_1).ln() / k;
        let of_moment = ((t_0 / t_1).ln() + 2.0 * t_1 * (1.0 / t_0 - 1.0 / t_1)
            - 0.5 * t_1 * t_1 * (1.0 / (t_0 * t_0) - 1.0 / (t_1 * t_1)))
            / k.powi(3);

        let tooth = compliance(|y| 0.5 * (t_0 - k * y), &LOAD, PlaneState::Stress);
        let (sin, cos) = LOAD.angle.sin_cos();
        assert!((tooth.bending / (cos * cos / B * 12.0 / 210e9 * of_moment) - 1.0).abs() < 1e-12);
        assert!((tooth.shear / (cos * cos / B * 1.2 * 2.6 / 210e9 * of_force) - 1.0).abs() < 1e-12);
        assert!((tooth.compression / (sin * sin / B / 210e9 * of_force) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_fillet_that_ends_on_the_root_circle_costs_no_accuracy() {
        // t = t_0 - 2 c sqrt(y) below the load starts with a vertical tangent. With r = sqrt(y):
        // ∫ dy/t = ∫ 2 r dr/(t_0 - 2 c r) = -R/c + (t_0/(2 c²)) ln(t_0/(t_0 - 2 c R)).
        let (t_0, c, r) = (5e-3_f64, 0.02_f64, 3e-3_f64.sqrt());
        let of_force = -r / c + t_0 / (2.0 * c * c) * (t_0 / (t_0 - 2.0 * c * r)).ln();
        let tooth = compliance(|y| 0.5 * t_0 - c * y.sqrt(), &LOAD, PlaneState::Stress);
        assert!(
            (tooth.compression / (LOAD.angle.sin().powi(2) / B / 210e9 * of_force) - 1.0).abs()
                < 1e-12
        );
    }

    #[test]
    fn a_kink_in_the_profile_is_integrated_to_a_ten_thousandth() {
        // Thickness 5 mm falling to 3 mm at y = 0.7 mm, then parallel: both parts by hand.
        let (l, y_k, t_0, t_1) = (3e-3, 0.7e-3, 5e-3_f64, 3e-3_f64);
        let k = (t_0 - t_1) / y_k;
        let of_force = (t_0 / t_1).ln() / k + (l - y_k) / t_1;
        let tooth = compliance(
            |y: f64| 0.5 * (t_0 - k * y).max(t_1),
            &LOAD,
            PlaneState::Stress,
        );
        // A jump in the slope of the profile is harsher than a fillet, which is tangent to its flank.
        assert!(
            (tooth.compression / (LOAD.angle.sin().powi(2) / B / 210e9 * of_force) - 1.0).abs()
                < 1e-4
        );
    }

    #[test]
    fn the_numbers_of_weber_and_banaschek_come_out_for_steel_in_plane_strain() {
        // A tooth of unit thickness and height, loaded across: 10.92 ∫ (1 - y)² = 3.64 and 3.12 (printed 3.1),
        // over E b; along it, 0.91 tan² (printed 3.1 x 0.294).
        let load = ToothLoad {
            height: 1.0,
            angle: PI / 4.0,
            depth: 1.0,
        };
        let tooth = compliance(|_| 0.5, &load, PlaneState::Strain);
        let scale = 210e9 * B * 2.0;
        for (value, number) in [
            (tooth.bending, 3.64),
            (tooth.shear, 3.12),
            (tooth.compression, 0.91),
        ] {
            assert!((value * scale - number).abs() < 1e-12);
        }
    }

    #[test]
    fn a_profile_without_thickness_is_refused_with_its_place() {
        let refused = |profile: fn(f64) -> f64| {
            tooth_compliance(profile, &LOAD, B, &steel(), PlaneState::Stress)
        };
        assert!(
            matches!(refused(|y| 1e-3 - y), Err(ToothError::NoThickness { height, .. }) if height > 1e-3)
        );
        assert!(matches!(
            refused(|_| f64::NAN),
            Err(ToothError::NoThickness { .. })
        ));
        let flat = ToothLoad {
            height: 0.0,
            ..LOAD
        };
        assert!(matches!(
            tooth_compliance(|_| 1e-3, &flat, B, &steel(), PlaneState::Stress),
            Err(ToothError::NotPositive(_))
        ));
    }
}
