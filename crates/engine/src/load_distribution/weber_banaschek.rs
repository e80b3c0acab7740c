//! The tooth as a cantilever of its true profile: Weber and Banaschek's integral (1953).
//!
//! With y from the root circle up the centerline, 2 x(y) the tooth's thickness there, u the height at which the load line
//! crosses the centerline and α_m the load's angle ([`super::tooth_load`]), a section carries the moment
//! F cos α_m (u − y), the shear force F cos α_m and the axial force F sin α_m. Its second moment of area is b (2x)³/12,
//! its area b 2x. The load's work, F δ/2, is the energy of these three, so
//!
//! δ/F = (cos² α_m/b) ((12/E') ∫ (u − y)²/(2x)³ dy + (1.2/G) ∫ dy/(2x) + (tan² α_m/E') ∫ dy/(2x)), from 0 to u.
//!
//! The three terms are bending, shear and compression. 1.2 = 6/5 is the shear factor of a rectangle;
//! 1.2/G = 2.4 (1 + ν)/E. E' is E in plane stress and E/(1 − ν²) in plane strain, where the numbers for ν = 0.3 are Weber and
//! Banaschek's 10.92, 3.1 and 0.91 = 3.1 × 0.294, all over E. The body under the tooth and the contact are not in it.

use super::tooth_load::ToothLoad;
use crate::gear::{Material, PlaneState};
use crate::quadrature::gauss_legendre_panels;

/// The shear factor of a rectangular section.
const SHEAR_FACTOR: f64 = 6.0 / 5.0;
/// Panels between root and load.
const PANELS: usize = 64;

/// The compliance of a tooth in its three parts, each in m/N along the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ToothCompliance {
    /// The share of bending.
    bending: f64,
    /// The share of shear.
    shear: f64,
    /// The share of compression along the tooth.
    compression: f64,
}

impl ToothCompliance {
    /// The compliance of a tooth of `face_width` (m) under `load`.
    ///
    /// `half_thickness` is x(y): half the tooth's thickness across its centerline at the height y above the root circle,
    /// both in m, asked for on 0 < y < u only, in rising order. It may start with a vertical tangent in y, as a fillet does that ends on the
    /// root circle, and may have kinks.
    pub(super) fn new(
        mut half_thickness: impl FnMut(f64) -> f64,
        load: &ToothLoad,
        face_width: f64,
        material: &Material,
        plane: PlaneState,
    ) -> Self {
        let (b, u) = (face_width, load.height);
        let (sin, cos) = load.angle.sin_cos();
        let (e, g) = (material.plane_modulus(plane), material.shear_modulus());
        let (mut of_moment, mut of_force) = (0.0, 0.0);
        for (y, weight) in heights(u) {
            let thickness = 2.0 * half_thickness(y);
            of_moment += weight * (u - y).powi(2) / thickness.powi(3);
            of_force += weight / thickness;
        }
        Self {
            bending: cos.powi(2) / b * 12.0 / e * of_moment,
            shear: cos.powi(2) / b * SHEAR_FACTOR / g * of_force,
            compression: sin.powi(2) / b / e * of_force,
        }
    }

    /// The compliance of the tooth, δ/F, in m/N.
    pub(super) fn total(&self) -> f64 {
        self.bending + self.shear + self.compression
    }
}

/// Heights between 0 and `u` with the weights of an integral over them.
///
/// A fillet that is tangent to the root circle makes the thickness start like the root of y; with y = u τ² it is smooth in
/// τ, so the panels are in τ. Many of them keep the error of a kink, where fillet and flank join, to that of one panel.
fn heights(u: f64) -> impl Iterator<Item = (f64, f64)> {
    gauss_legendre_panels(0.0, 1.0, PANELS)
        .map(move |(tau, weight)| (u * tau.powi(2), weight * 2.0 * u * tau))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Material;
    use std::f64::consts::PI;

    const B: f64 = 20e-3;
    const LOAD: ToothLoad = ToothLoad {
        height: 3e-3,
        angle: 0.33,
        depth: 1.5e-3,
    };

    fn compliance(
        half_thickness: impl Fn(f64) -> f64,
        load: &ToothLoad,
        plane: PlaneState,
    ) -> ToothCompliance {
        ToothCompliance::new(half_thickness, load, B, &Material::STEEL, plane)
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
        // (ln(t_0/t_1) + 2 t_1 (1/t_0 - 1/t_1) - t_1² (1/t_0² - 1/t_1²)/2)/k³; the quadrature leaves 1e-10.
        let (l, t_0, t_1) = (3e-3, 5e-3_f64, 2e-3_f64);
        let k = (t_0 - t_1) / l;
        let of_force = (t_0 / t_1).ln() / k;
        let of_moment = ((t_0 / t_1).ln() + 2.0 * t_1 * (1.0 / t_0 - 1.0 / t_1)
            - 0.5 * t_1 * t_1 * (1.0 / (t_0 * t_0) - 1.0 / (t_1 * t_1)))
            / k.powi(3);

        let tooth = compliance(|y| 0.5 * (t_0 - k * y), &LOAD, PlaneState::Stress);
        let (sin, cos) = LOAD.angle.sin_cos();
        assert!((tooth.bending / (cos * cos / B * 12.0 / 210e9 * of_moment) - 1.0).abs() < 1e-10);
        assert!((tooth.shear / (cos * cos / B * 1.2 * 2.6 / 210e9 * of_force) - 1.0).abs() < 1e-10);
        assert!((tooth.compression / (sin * sin / B / 210e9 * of_force) - 1.0).abs() < 1e-10);
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
                < 1e-11
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
}
