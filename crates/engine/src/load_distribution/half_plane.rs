//! The gear body under a loaded tooth as an elastic half plane: no bore, no neighboring tooth.
//!
//! A half plane carries over the tooth's root, of width S, the moment F cos α_m u and the force of the tooth. Its
//! displacement there, averaged so that the work is right, is (Weber and Banaschek, 1953)
//!
//! δ = (F cos² α_m/(E' b)) (c_1 (u/S)² + c_2 (u/S) + c_3 (1 + c_4 tan² α_m)),
//!
//! c_1 = 18/π, c_2 = 2 (1 − ν'), c_3 = 4.8/π, c_4 = 1/(2.4 (1 + ν')),
//!
//! with u and α_m of [`super::tooth_load`]. E' and ν' are E and ν in plane stress, E/(1 − ν²) and ν/(1 − ν) in plane strain.
//! There, at ν = 0.3, the sum over E/(1 − ν²) is the familiar 5.2 (u/S)² + u/S + 1.4 (1 + 0.294 tan²). c_1 is the mean
//! rotation, weighted by the load, of a half plane under a pressure that grows linearly across S.

use std::f64::consts::PI;

use super::tooth_load::ToothLoad;
use crate::gear::{Material, PlaneState};

/// The compliance δ/F of a half plane under `load`, in m/N along the load.
///
/// `root_width` is S, the tooth's width at the root, and `face_width` b, both in m.
pub(super) fn compliance(
    load: &ToothLoad,
    root_width: f64,
    face_width: f64,
    material: &Material,
    plane: PlaneState,
) -> f64 {
    let (u_s, b, alpha_m) = (load.height / root_width, face_width, load.angle);
    let e = material.plane_modulus(plane);
    let [c_1, c_2, c_3, c_4] = coefficients(material.plane_poisson_ratio(plane));
    alpha_m.cos().powi(2) / (e * b)
        * (c_1 * u_s.powi(2) + c_2 * u_s + c_3 * (1.0 + c_4 * alpha_m.tan().powi(2)))
}

/// c_1 to c_4 of the sum at ν' = `nu`.
fn coefficients(nu: f64) -> [f64; 4] {
    [
        18.0 / PI,
        2.0 * (1.0 - nu),
        4.8 / PI,
        1.0 / (2.4 * (1.0 + nu)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Material;

    #[test]
    fn weber_and_banascheks_own_numbers_come_out_in_plane_strain() {
        // Printed for ν = 0.3 with E alone in the denominator: 5.2, 1, 1.4 and 0.294, each rounded to about 1 %; c_2
        // is 1.04.
        let [c_1, c_2, c_3, c_4] =
            coefficients(Material::STEEL.plane_poisson_ratio(PlaneState::Strain));
        let over_e = 1.0 - 0.3_f64.powi(2);
        for (value, print) in [
            (c_1 * over_e, 5.2),
            (c_2 * over_e, 1.0),
            (c_3 * over_e, 1.4),
            (c_4, 0.294),
        ] {
            assert!(
                (value / print - 1.0).abs() < 0.041,
                "{value} beside {print}"
            );
        }
    }

    #[test]
    fn the_rotation_of_weber_and_banaschek_is_the_mean_under_a_linear_pressure() {
        // On -1 < x < 1 (S = 2) the pressure p = (3/2) M x gives w = -(2/(π E')) ∫ p ln|x - ξ|; the rotation is
        // ∫ p w / M. With ln|x - ξ| = -ln 2 - sum (2/n) T_n(x) T_n(ξ) it is (2/(π E')) (9/4) sum (2/n) m_n² M,
        // where m_n = ∫ x T_n over the interval. c_1 M/(E' S²) must be the same; 20,000 terms fall off as n^-4.
        let moment_of_chebyshev = |n: f64| {
            // ∫_0^π cos(t) cos(n t) sin(t) dt = -2/(n² - 4) for odd n.
            -2.0 / (n * n - 4.0)
        };
        let sum: f64 = (0..20_000)
            .map(|k| 2.0 * f64::from(k) + 1.0)
            .map(|n| 2.0 / n * moment_of_chebyshev(n).powi(2))
            .sum();
        let rotation = 2.0 / PI * 9.0 / 4.0 * sum;
        let [c_1, ..] = coefficients(Material::STEEL.plane_poisson_ratio(PlaneState::Stress));
        assert!(
            (c_1 / 4.0 / rotation - 1.0).abs() < 1e-9,
            "{} beside {rotation}",
            c_1 / 4.0
        );
    }

    #[test]
    fn the_form_of_odonnell_is_stiffer_by_less_than_a_tenth() {
        // O'Donnell's rotation as Cornell has it, written out as published (plane stress): 5.306 for c_1, 1.534 for c_3
        // and 0.4167/(1 + ν) for c_4.
        let (nu, u_s, tan) = (0.3_f64, 2.5 / 4.0, 0.33_f64.tan());
        let published = 0.33_f64.cos().powi(2) / (210e9 * 20e-3)
            * (5.306 * u_s * u_s
                + 2.0 * (1.0 - nu) * u_s
                + 1.534 * (1.0 + 0.4167 * tan * tan / (1.0 + nu)));
        let load = ToothLoad {
            height: 2.5e-3,
            angle: 0.33,
            depth: 1.6e-3,
        };
        let ours = compliance(&load, 4e-3, 20e-3, &Material::STEEL, PlaneState::Stress);
        assert!(ours > published && ours < 1.1 * published);
    }
}
