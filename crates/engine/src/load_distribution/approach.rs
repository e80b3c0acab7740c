//! The approach of two flanks pressed together along a line: Hertz's pressure, Weber's depths.
//!
//! Under the semi-elliptic pressure of a line load F/b, of half-width a ([`crate::flank::half_plane::hertz`]), the strain
//! on the axis of a half plane, summed from its surface down to the depth t, is
//!
//! h = (2 F/(π b E')) (arsinh S − ν' S/(S + sqrt(1 + S²))), S = t/a,
//!
//! with E' and ν' of the plane state. In two dimensions a half plane sinks without bound, so the approach needs its depths:
//! Weber measures them along the load, from the flank to the tooth's centerline ([`super::tooth_load::ToothLoad::depth`]).
//! For t ≫ a the bracket is Weber's ln(2 t/a) − ν'/2, and the sum over two bodies of one material his form with
//! ln(4 t_1 t_2/a²). Since a grows with the root of F, the approach grows a little slower than F, and never falls.

use crate::flank::half_plane::{hertz, logarithm_factor};
use crate::gear::{Material, PlaneState};

/// One of two bodies in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactBody {
    /// Its material.
    pub(super) material: Material,
    /// The radius of curvature of its convex flank, in m: for an involute, the roll length.
    pub(super) curvature_radius: f64,
    /// The depth t from its flank to the point whose approach is asked for, in m.
    pub(super) depth: f64,
}

/// A contact of two convex bodies along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LineContact {
    /// ρ, with 1/ρ = 1/ρ_1 + 1/ρ_2.
    relative_radius: f64,
    face_width: f64,
    halves: [HalfPlane; 2],
    /// The sum of 2/(π b E') in plane strain, in which a contact presses whatever the plane state of the bodies: it is far narrower than the face is wide.
    in_plane_strain: f64,
}

/// A body as the law of the approach sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HalfPlane {
    /// 2/(π b E').
    factor: f64,
    /// ν'.
    poisson_ratio: f64,
    /// t.
    depth: f64,
}

impl LineContact {
    /// The contact of `bodies` over `face_width` (m).
    pub(super) fn new(bodies: [ContactBody; 2], face_width: f64, plane: PlaneState) -> Self {
        let [one, other] = bodies.map(|body| body.curvature_radius);
        Self {
            relative_radius: one * other / (one + other),
            face_width,
            in_plane_strain: bodies
                .map(|body| {
                    let modulus = body.material.plane_modulus(PlaneState::Strain);
                    logarithm_factor(modulus, face_width)
                })
                .into_iter()
                .sum(),
            halves: bodies.map(
                |ContactBody {
                     material, depth, ..
                 }| HalfPlane {
                    factor: logarithm_factor(material.plane_modulus(plane), face_width),
                    poisson_ratio: material.plane_poisson_ratio(plane),
                    depth,
                },
            ),
        }
    }

    /// The pressure p_0 in the middle of the contact under `force` (N, positive), in Pa: that of plane strain.
    pub(super) fn peak_pressure(&self, force: f64) -> f64 {
        let (radius, width) = (self.relative_radius, self.face_width);
        hertz(force, radius, self.in_plane_strain, width).1
    }

    /// The approach h of the two points at their depths under `force` (N, positive), in m.
    pub(super) fn approach(&self, force: f64) -> f64 {
        let (a, _) = self.hertz(force);
        let compliance = |half: &HalfPlane| {
            let s = half.depth / a;
            half.factor * (s.asinh() - half.poisson_ratio * s / (s + s.hypot(1.0)))
        };
        force * self.halves.iter().map(compliance).sum::<f64>()
    }

    /// The tangent compliance dh/dF under `force` (N, positive), in m/N. It has no limit where the force vanishes.
    pub(super) fn tangent_compliance(&self, force: f64) -> f64 {
        let (a, _) = self.hertz(force);
        let compliance = |half: &HalfPlane| {
            // F d/dF is −½ S d/dS, since a grows with the root of F; the bracket's derivatives are 1/q and, of
            // S/(S + q), 1/(q (S + q)²), with q = sqrt(1 + S²).
            let s = half.depth / a;
            let q = s.hypot(1.0);
            let of_stress_along = s.asinh() - 0.5 * s / q;
            let of_stress_across = s / (s + q) - 0.5 * s / (q * (s + q).powi(2));
            half.factor * (of_stress_along - half.poisson_ratio * of_stress_across)
        };
        self.halves.iter().map(compliance).sum()
    }

    /// The half-width a (m) and the peak pressure p_0 (Pa).
    fn hertz(&self, force: f64) -> (f64, f64) {
        let factors = self.halves.iter().map(|half| half.factor).sum();
        hertz(force, self.relative_radius, factors, self.face_width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Material;
    use std::f64::consts::PI;

    const FACE_WIDTH: f64 = 20e-3;

    /// A contact of two equal steel bodies whose relative radius is `relative_radius`.
    fn contact(relative_radius: f64, depth: f64, plane: PlaneState) -> LineContact {
        let body = ContactBody {
            material: Material::STEEL,
            curvature_radius: 2.0 * relative_radius,
            depth,
        };
        LineContact::new([body, body], FACE_WIDTH, plane)
    }

    /// To half a unit of the last printed digit.
    fn assert_printed(value: f64, print: f64, decimals: i32) {
        assert!(
            (value - print).abs() <= 0.5 * 10_f64.powi(-decimals),
            "{value} beside the printed {print}"
        );
    }

    #[test]
    fn the_papers_pitch_points_have_the_contacts_worked_out_for_them() {
        // Plane strain, E = 210 GPa, ν = 0.3, b = 20 mm: a (µm), p_0 (MPa) and Weber's approach (µm) at the depths 1.672
        // and 2 mm, from his logarithm; it drops terms of (a/t)², here a thousandth.
        for (force, radius, a, p_0, weber) in [
            (2447.61, 8.9094e-3, 109.69, 710.3, [2.163, 2.284]),
            (425.67, 8.9094e-3, 45.74, 296.2, [0.479, 0.500]),
            (2003.16, 7.6683e-3, 92.06, 692.6, [1.867, 1.966]),
        ] {
            for (depth, weber) in [1.672e-3, 2e-3].into_iter().zip(weber) {
                let contact = contact(radius, depth, PlaneState::Strain);
                let (half_width, _) = contact.hertz(force);
                assert_printed(half_width * 1e6, a, 2);
                assert_printed(contact.peak_pressure(force) * 1e-6, p_0, 1);
                assert!((contact.approach(force) * 1e6 - weber).abs() < 0.5e-3 + 1e-3 * weber);
            }
        }
    }

    #[test]
    fn the_approach_is_the_strain_under_an_elliptic_pressure_summed_down_to_the_depth() {
        // The stresses on the axis under a Hertzian line load (Johnson): σ_z = -p_0/sqrt(1 + s²), σ_x =
        // -p_0((1 + 2 s²)/sqrt(1 + s²) - 2 s) with s = z/a. In plane stress the strain is (σ_z - ν σ_x)/E.
        // Simpson's rule in sinh steps, for contacts far narrower than the depth and wider than it.
        let nu = 0.3;
        for force in [100.0, 1e5, 1e8] {
            let contact = contact(9e-3, 2.3e-3, PlaneState::Stress);
            let (a, p_0) = contact.hertz(force);
            let strain = |s: f64| {
                let root = (1.0 + s * s).sqrt();
                p_0 / 210e9 * (1.0 / root - nu * ((1.0 + 2.0 * s * s) / root - 2.0 * s))
            };
            let (n, end) = (2000, (2.3e-3 / a).asinh());
            let integrand = |i: i32| {
                let x = f64::from(i) * end / f64::from(n);
                strain(x.sinh()) * x.cosh()
            };
            let weight = |i| {
                if i == 0 || i == n {
                    1.0
                } else {
                    f64::from(2 + 2 * (i % 2))
                }
            };
            let simpson: f64 =
                (0..=n).map(|i| integrand(i) * weight(i)).sum::<f64>() * end / f64::from(n) / 3.0
                    * a;
            let approach = contact.approach(force);
            assert!(
                (2.0 * simpson / approach - 1.0).abs() < 1e-9,
                "{} beside {approach}",
                2.0 * simpson
            );
        }
    }

    #[test]
    fn bodies_of_one_material_approach_as_webers_product_of_depths_says() {
        let (force, t_1, t_2, e, nu) = (20.0, 1.5e-3, 2.5e-3, 210e9, 0.3);
        let body = |curvature_radius, depth| ContactBody {
            material: Material::STEEL,
            curvature_radius,
            depth,
        };
        let contact = LineContact::new(
            [body(10e-3, t_1), body(30e-3, t_2)],
            FACE_WIDTH,
            PlaneState::Strain,
        );
        let (a, _) = contact.hertz(force);
        let weber = 2.0 * force * (1.0 - nu * nu) / (PI * e * FACE_WIDTH)
            * ((4.0 * t_1 * t_2 / (a * a)).ln() - nu / (1.0 - nu));
        // Weber drops terms of (a/t)², 5e-5 here.
        assert!((contact.approach(force) / weber - 1.0).abs() < 5e-5);
    }

    #[test]
    fn the_pitch_point_of_the_standard_pair_in_plane_stress() {
        // Worked out beside the plane strain values: 115.0 µm and 677 MPa. The radius has five digits, the pressure
        // three.
        let (half_width, peak_pressure) =
            contact(8.9094e-3, 1.672e-3, PlaneState::Stress).hertz(2447.61);
        assert_printed(half_width * 1e6, 115.0, 1);
        assert!((peak_pressure * 1e-6 - 677.0).abs() < 1.0);
    }

    #[test]
    fn a_contact_presses_as_in_plane_strain_whatever_the_state_of_the_bodies() {
        // p_0² = F E'/(2 π b ρ) of two equal bodies (Hertz), with E' = E/(1 − ν²).
        let (force, radius) = (2447.61, 8.9094e-3);
        let modulus = 210e9 / (1.0 - 0.3 * 0.3);
        let square = force * modulus / (2.0 * PI * FACE_WIDTH * radius);
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let pressure = contact(radius, 2e-3, plane).peak_pressure(force);
            assert!((pressure / square.sqrt() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_pressure_carries_the_force() {
        // A semi-ellipse of half-width a and height p_0 over the face: F = π a p_0 b/2.
        let (half_width, peak_pressure) =
            contact(8.9094e-3, 2e-3, PlaneState::Stress).hertz(1234.5);
        let carried = PI / 2.0 * half_width * peak_pressure * FACE_WIDTH;
        assert!((carried / 1234.5 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_approach() {
        // A central difference with a step of 1e-4 F, whose error is of the order 1e-9.
        for (plane, force) in [
            (PlaneState::Stress, 1e-3),
            (PlaneState::Strain, 2447.61),
            (PlaneState::Stress, 1e6),
            (PlaneState::Strain, 1e9),
        ] {
            let contact = contact(8.9094e-3, 1.6e-3, plane);
            let step = 1e-4 * force;
            let difference =
                (contact.approach(force + step) - contact.approach(force - step)) / (2.0 * step);
            let tangent = contact.tangent_compliance(force);
            assert!(tangent > 0.0 && (tangent / difference - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn unlike_bodies_share_the_contact_and_keep_their_own_approach() {
        // A partner a million times stiffer takes no part: a² and h are those of one body alone.
        let body = ContactBody {
            material: Material::STEEL,
            curvature_radius: 18e-3,
            depth: 1.6e-3,
        };
        let mut stiff = body;
        stiff.material.youngs_modulus *= 1e6;
        let unlike = LineContact::new([body, stiff], FACE_WIDTH, PlaneState::Stress);
        let equal = LineContact::new([body, body], FACE_WIDTH, PlaneState::Stress);
        // Half of the contact of equal bodies under twice the force is as wide as that of unequal ones.
        let (force, tolerance) = (1000.0, 1e-5);
        assert!((unlike.hertz(2.0 * force).0 / equal.hertz(force).0 - 1.0).abs() < tolerance);
        assert!((unlike.approach(2.0 * force) / equal.approach(force) - 1.0).abs() < tolerance);
    }
}
