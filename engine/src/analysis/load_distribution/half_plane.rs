//! The gear body under a loaded tooth as an elastic half-plane: no bore, no neighboring tooth.
//!
//! A half-plane carries over the tooth's root, of width S, the moment F cos(α_m) u and the force of the tooth.
//! Its displacement there, averaged so that the work is right, is
//!
//! δ = (F cos²(α_m)/(E' b)) (c_1 (u/S)² + c_2 (u/S) + c_3 (1 + c_4 tan²(α_m))),
//!
//! with u and α_m of [`super::tooth_load`] and two sets of coefficients in use ([`FoundationForm`]). E' is E in
//! plane stress and E/(1 - ν²) in plane strain.

use crate::analysis::PlaneState;

use super::elastic_constants::ElasticConstants;
use super::quantity::{NotPositive, positive};
use super::tooth_load::ToothLoad;
use std::f64::consts::PI;

/// Whose coefficients of the half-plane are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FoundationForm {
    /// Weber and Banaschek (1953): c_1 = 18/π, c_2 = 2 (1 - ν'), c_3 = 4.8/π, c_4 = 1/(2.4 (1 + ν')).
    ///
    /// ν' is ν in plane stress and ν/(1 - ν) in plane strain. In plane strain at ν = 0.3 the sum over
    /// E/(1 - ν²) is the familiar 5.2 (u/S)² + u/S + 1.4 (1 + 0.294 tan²). c_1 is the mean rotation, weighted by the
    /// load, of a half-plane under a pressure that grows linearly across S.
    WeberBanaschek,
    /// O'Donnell's rotation, as Cornell and Ishikawa use it: c_1 = 5.306 = 16.67/π, c_2 as Weber's, c_3 = 1.534,
    /// c_4 = 0.4167/(1 + ν) in both plane states.
    ///
    /// That c_4 does not follow the plane state is how the form is published; it changes the sum by about 0.1 %.
    ODonnell,
}

/// The compliance δ/F of a half-plane under `load`, in m/N along the load.
///
/// `root_width` is S, the tooth's width at the root, and `face_width` b, both in m.
///
/// # Errors
///
/// [`NotPositive`] if a length is not a positive number.
pub fn compliance(
    form: FoundationForm,
    load: &ToothLoad,
    root_width: f64,
    face_width: f64,
    material: &ElasticConstants,
    plane: PlaneState,
) -> Result<f64, NotPositive> {
    let u_s =
        positive("the height of the load", load.height)? / positive("the root width", root_width)?;
    let b = positive("the face width", face_width)?;
    let alpha_m = load.angle;
    let e = material.plane_modulus(plane);

    let [c_1, c_2, c_3, c_4] = coefficients(form, material, plane);
    Ok(alpha_m.cos().powi(2) / (e * b)
        * (c_1 * u_s.powi(2) + c_2 * u_s + c_3 * (1.0 + c_4 * alpha_m.tan().powi(2))))
}

/// c_1 to c_4 of the sum.
fn coefficients(form: FoundationForm, material: &ElasticConstants, plane: PlaneState) -> [f64; 4] {
    let nu = material.plane_poisson_ratio(plane);
    match form {
        FoundationForm::WeberBanaschek => [
            18.0 / PI,
            2.0 * (1.0 - nu),
            4.8 / PI,
            1.0 / (2.4 * (1.0 + nu)),
        ],
        FoundationForm::ODonnell => [
            5.306,
            2.0 * (1.0 - nu),
            1.534,
            0.4167 / (1.0 + material.poisson_ratio()),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOAD: ToothLoad = ToothLoad {
        height: 2.5e-3,
        angle: 0.33,
        depth: 1.6e-3,
    };

    fn steel() -> ElasticConstants {
        ElasticConstants::new(210e9, 0.3).expect("steel is a material")
    }

    #[test]
    fn weber_and_banascheks_own_numbers_come_out_in_plane_strain() {
        // Printed for ν = 0.3 with E alone in the denominator: 5.2, 1, 1.4 and 0.294, each rounded to about 1 %; c_2
        // is 1.04.
        let [c_1, c_2, c_3, c_4] =
            coefficients(FoundationForm::WeberBanaschek, &steel(), PlaneState::Strain);
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
        let [c_1, ..] = coefficients(FoundationForm::WeberBanaschek, &steel(), PlaneState::Stress);
        assert!(
            (c_1 / 4.0 / rotation - 1.0).abs() < 1e-9,
            "{} beside {rotation}",
            c_1 / 4.0
        );
    }

    #[test]
    fn the_form_of_odonnell_is_the_published_sum_in_both_plane_states() {
        // Written out as it is published, with ν and not ν'.
        let (nu, u_s, tan) = (0.3_f64, 2.5 / 4.0, 0.33_f64.tan());
        let prefix = 0.33_f64.cos().powi(2) / (210e9 * 20e-3);
        let last = 1.534 * (1.0 + 0.4167 * tan * tan / (1.0 + nu));
        let stress = prefix * (5.306 * u_s * u_s + 2.0 * (1.0 - nu) * u_s + last);
        let strain = prefix
            * (1.0 - nu * nu)
            * (5.306 * u_s * u_s + 2.0 * (1.0 - nu - 2.0 * nu * nu) / (1.0 - nu * nu) * u_s + last);
        for (plane, published) in [(PlaneState::Stress, stress), (PlaneState::Strain, strain)] {
            let value = compliance(
                FoundationForm::ODonnell,
                &LOAD,
                4e-3,
                20e-3,
                &steel(),
                plane,
            )
            .expect("the root has a width");
            assert!((value / published - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_two_forms_differ_by_less_than_a_tenth() {
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let [weber, odonnell] =
                [FoundationForm::WeberBanaschek, FoundationForm::ODonnell].map(|form| {
                    compliance(form, &LOAD, 4e-3, 20e-3, &steel(), plane)
                        .expect("the root has a width")
                });
            assert!(weber > odonnell && weber < 1.1 * odonnell);
        }
    }

    #[test]
    fn a_root_without_width_is_refused() {
        assert!(
            compliance(
                FoundationForm::WeberBanaschek,
                &LOAD,
                0.0,
                20e-3,
                &steel(),
                PlaneState::Stress
            )
            .is_err()
        );
        assert!(
            compliance(
                FoundationForm::WeberBanaschek,
                &LOAD,
                4e-3,
                f64::NAN,
                &steel(),
                PlaneState::Stress
            )
            .is_err()
        );
    }
}
