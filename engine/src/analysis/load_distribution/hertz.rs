//! Two flanks pressed together along a line: half-width and pressure by Hertz, the approach of points at a depth by
//! Weber.
//!
//! With the line load F/b, 1/R = 1/R_1 + 1/R_2 and 1/E* = 1/E'_1 + 1/E'_2 (E' = E in plane stress, E/(1 - ν²) in
//! plane strain):
//!
//! - half-width a = sqrt(4 F R/(π b E*)) and peak pressure p_0 = 2 F/(π b a);
//! - a point at the depth t under the middle of the contact comes nearer to it by
//!   `δ = (2 F/(π b E')) (ln(2 t/a) - ν'/2)`, ν' = ν in plane stress and ν/(1 - ν) in plane strain.
//!
//! In two dimensions a half-plane sinks without bound, so the approach needs its depths: Weber measures them along
//! the load, from the flank to the tooth's centerline ([`super::tooth_load::ToothLoad::depth`]). For bodies of one
//! material the sum over both is Weber's form with ln(4 t_1 t_2/a²). The expansion is for t much greater than a;
//! since a grows with the root of F, the approach grows a little slower than F, and it is refused where it would
//! begin to fall.

use crate::analysis::PlaneState;

use super::elastic_constants::ElasticConstants;
use super::quantity::{NotPositive, positive};
use std::f64::consts::PI;

/// One of two bodies in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactBody {
    /// What it is made of.
    pub material: ElasticConstants,
    /// The radius of curvature of its convex flank, in m: for an involute, the roll length.
    pub curvature_radius: f64,
    /// The depth t from its flank to the point whose approach is asked for, in m.
    pub depth: f64,
}

/// A contact of two convex bodies along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineContact {
    bodies: [ContactBody; 2],
    face_width: f64,
    plane: PlaneState,
}

/// A contact too wide for the approach to be given.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("a contact {half_width} m wide to each side is too wide for a depth of {depth} m")]
pub struct ContactTooWide {
    /// The half-width a, in m.
    pub half_width: f64,
    /// The depth t of the body that is too thin, in m.
    pub depth: f64,
}

impl LineContact {
    /// The contact of `bodies` over `face_width` (m).
    ///
    /// # Errors
    ///
    /// [`NotPositive`] if a length is not a positive number.
    pub fn new(
        bodies: [ContactBody; 2],
        face_width: f64,
        plane: PlaneState,
    ) -> Result<Self, NotPositive> {
        for body in bodies {
            positive("the radius of curvature", body.curvature_radius)?;
            positive("the depth", body.depth)?;
        }
        positive("the face width", face_width)?;
        Ok(Self {
            bodies,
            face_width,
            plane,
        })
    }

    /// The half-width a of the contact under `force` (N), in m; none without a pressing force.
    pub fn half_width(&self, force: f64) -> f64 {
        let [r, e] = [self.relative_radius(), self.contact_modulus()];
        (4.0 * force.max(0.0) * r / (PI * self.face_width * e)).sqrt()
    }

    /// The pressure p_0 in the middle of the contact under `force` (N), in Pa; none without a pressing force.
    pub fn peak_pressure(&self, force: f64) -> f64 {
        // p_0 = 2 F/(π b a) with F written through a: no division by a half-width of zero.
        self.half_width(force) * self.contact_modulus() / (2.0 * self.relative_radius())
    }

    /// The approach of the two points at their depths under `force` (N), in m; none without a pressing force.
    ///
    /// # Errors
    ///
    /// [`ContactTooWide`] if the contact is so wide that the approach would fall with the force.
    pub fn approach(&self, force: f64) -> Result<f64, ContactTooWide> {
        if force.is_nan() || force <= 0.0 {
            return Ok(0.0);
        }
        let a = self.half_width(force);
        let line_load = force / self.face_width;
        self.sum(a, |e, logarithm| 2.0 * line_load / (PI * e) * logarithm)
    }

    /// The tangent compliance d(approach)/dF under `force` (N), in m/N; infinite without a pressing force, where the
    /// contact has no width.
    ///
    /// # Errors
    ///
    /// [`ContactTooWide`] as for [`Self::approach`].
    pub fn tangent_compliance(&self, force: f64) -> Result<f64, ContactTooWide> {
        if force.is_nan() || force <= 0.0 {
            return Ok(f64::INFINITY);
        }
        let a = self.half_width(force);
        // F ln(2 t/a) with a ~ sqrt(F): the derivative of the logarithm takes 1/2 away.
        self.sum(a, |e, logarithm| {
            2.0 / (PI * self.face_width * e) * (logarithm - 0.5)
        })
    }

    /// Adds `term`(E', ln(2 t/a) - ν'/2) over the bodies.
    fn sum(&self, half_width: f64, term: impl Fn(f64, f64) -> f64) -> Result<f64, ContactTooWide> {
        let mut sum = 0.0;
        for body in &self.bodies {
            let nu = body.material.plane_poisson_ratio(self.plane);
            let logarithm = (2.0 * body.depth / half_width).ln() - 0.5 * nu;
            if logarithm.is_nan() || logarithm <= 0.5 {
                return Err(ContactTooWide {
                    half_width,
                    depth: body.depth,
                });
            }
            sum += term(body.material.plane_modulus(self.plane), logarithm);
        }
        Ok(sum)
    }

    /// R, with 1/R = 1/R_1 + 1/R_2.
    fn relative_radius(&self) -> f64 {
        1.0 / self
            .bodies
            .iter()
            .map(|body| 1.0 / body.curvature_radius)
            .sum::<f64>()
    }

    /// E*, with 1/E* = 1/E'_1 + 1/E'_2.
    fn contact_modulus(&self) -> f64 {
        1.0 / self
            .bodies
            .iter()
            .map(|body| 1.0 / body.material.plane_modulus(self.plane))
            .sum::<f64>()
    }
}

/// The constant contact stiffness k = π E' b/4 of many energy methods, in N/m, whatever the load.
///
/// It is about three times too stiff beside Weber's approach; it is here to be compared with.
///
/// # Errors
///
/// [`NotPositive`] if `face_width` (m) is not a positive number.
pub fn constant_stiffness(
    material: &ElasticConstants,
    face_width: f64,
    plane: PlaneState,
) -> Result<f64, NotPositive> {
    Ok(PI * material.plane_modulus(plane) * positive("the face width", face_width)? / 4.0)
}

/// Palmgren's approach of two steel bodies along a line, 3.84e-5 F^0.9/b^0.8 mm with F in N and b in mm; here in m
/// from N and m.
///
/// Measured on rollers between plates, it holds more of the bodies than a flank has; it is here to be compared with.
/// None without a pressing force.
///
/// # Errors
///
/// [`NotPositive`] if `face_width` (m) is not a positive number.
pub fn palmgren_approach(force: f64, face_width: f64) -> Result<f64, NotPositive> {
    let b_mm = positive("the face width", face_width)? * 1e3;
    Ok(3.84e-5 * force.max(0.0).powf(0.9) / b_mm.powf(0.8) * 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE_WIDTH: f64 = 20e-3;

    fn steel() -> ElasticConstants {
        ElasticConstants::new(210e9, 0.3).expect("steel is a material")
    }

    /// A contact of two alike bodies whose relative radius is `relative_radius`.
    fn contact(relative_radius: f64, depth: f64, plane: PlaneState) -> LineContact {
        let body = ContactBody {
            material: steel(),
            curvature_radius: 2.0 * relative_radius,
            depth,
        };
        LineContact::new([body, body], FACE_WIDTH, plane).expect("the lengths are positive")
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
        // Plane strain, E = 210 GPa, ν = 0.3, b = 20 mm: a (um), p_0 (MPa), Weber's approach (um) at the depths
        // 1.672 and 2 mm, the constant stiffness and Palmgren (um).
        for (force, radius, a, p_0, weber, constant, palmgren) in [
            (
                2447.61,
                8.9094e-3,
                109.69,
                710.3,
                [2.163, 2.284],
                0.675,
                3.92,
            ),
            (425.67, 8.9094e-3, 45.74, 296.2, [0.479, 0.500], 0.117, 0.81),
            (
                2003.16,
                7.6683e-3,
                92.06,
                692.6,
                [1.867, 1.966],
                0.553,
                3.27,
            ),
        ] {
            let plane = PlaneState::Strain;
            let [shallow, deep] = [1.672e-3, 2e-3].map(|depth| contact(radius, depth, plane));
            assert_printed(shallow.half_width(force) * 1e6, a, 2);
            assert_printed(shallow.peak_pressure(force) * 1e-6, p_0, 1);
            assert_printed(
                shallow.approach(force).expect("the contact is narrow") * 1e6,
                weber[0],
                3,
            );
            assert_printed(
                deep.approach(force).expect("the contact is narrow") * 1e6,
                weber[1],
                3,
            );
            let k = constant_stiffness(&steel(), FACE_WIDTH, plane).expect("the width is positive");
            assert_printed(force / k * 1e6, constant, 3);
            assert_printed(
                palmgren_approach(force, FACE_WIDTH).expect("the width is positive") * 1e6,
                palmgren,
                2,
            );
        }
    }

    #[test]
    fn the_pitch_point_of_the_standard_pair_in_plane_stress() {
        // Worked out beside the plane strain values: 115.0 um and 677 MPa. The radius has five digits, the pressure
        // three.
        let contact = contact(8.9094e-3, 1.672e-3, PlaneState::Stress);
        assert_printed(contact.half_width(2447.61) * 1e6, 115.0, 1);
        assert!((contact.peak_pressure(2447.61) * 1e-6 - 677.0).abs() < 1.0);
    }

    #[test]
    fn the_pressure_carries_the_force() {
        // A semi-ellipse of half-width a and height p_0 over the face: F = π a p_0 b/2.
        let contact = contact(8.9094e-3, 2e-3, PlaneState::Stress);
        let carried =
            PI / 2.0 * contact.half_width(1234.5) * contact.peak_pressure(1234.5) * FACE_WIDTH;
        assert!((carried / 1234.5 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn bodies_of_one_material_approach_as_webers_product_of_depths_says() {
        let (force, t_1, t_2, e, nu) = (2000.0, 1.5e-3, 2.5e-3, 210e9, 0.3);
        let body = |curvature_radius, depth| ContactBody {
            material: steel(),
            curvature_radius,
            depth,
        };
        let contact = LineContact::new(
            [body(10e-3, t_1), body(30e-3, t_2)],
            FACE_WIDTH,
            PlaneState::Strain,
        )
        .expect("the lengths are positive");
        let a = contact.half_width(force);
        let weber = 2.0 * force * (1.0 - nu * nu) / (PI * e * FACE_WIDTH)
            * ((4.0 * t_1 * t_2 / (a * a)).ln() - nu / (1.0 - nu));
        assert!(
            (contact.approach(force).expect("the contact is narrow") / weber - 1.0).abs() < 1e-14
        );
    }

    #[test]
    fn the_approach_is_the_strain_under_an_elliptic_pressure_summed_down_to_the_depth() {
        // The stresses on the axis under a Hertzian line load (Johnson): σ_z = -p_0/sqrt(1 + s²), σ_x =
        // -p_0((1 + 2 s²)/sqrt(1 + s²) - 2 s) with s = z/a. In plane stress the strain is (σ_z - ν σ_x)/E.
        // Simpson's rule in sinh steps; the formula drops terms of (a/t)² = 1e-4 here.
        let (force, nu) = (100.0, 0.3);
        let contact = contact(9e-3, 2.3e-3, PlaneState::Stress);
        let (a, p_0) = (contact.half_width(force), contact.peak_pressure(force));
        let strain = |s: f64| {
            let root = (1.0 + s * s).sqrt();
            p_0 / 210e9 * (1.0 / root - nu * ((1.0 + 2.0 * s * s) / root - 2.0 * s))
        };
        let (n, end) = (2000, (2.3e-3 / a).asinh());
        let integrand = |i: i32| {
            strain((f64::from(i) * end / f64::from(n)).sinh())
                * (f64::from(i) * end / f64::from(n)).cosh()
        };
        let simpson: f64 = (0..=n)
            .map(|i| {
                integrand(i)
                    * if i == 0 || i == n {
                        1.0
                    } else {
                        f64::from(2 + 2 * (i % 2))
                    }
            })
            .sum::<f64>()
            * end
            / f64::from(n)
            / 3.0
            * a;
        let approach = contact.approach(force).expect("the contact is narrow");
        assert!(
            (2.0 * simpson / approach - 1.0).abs() < 2e-4,
            "{} beside {approach}",
            2.0 * simpson
        );
    }

    #[test]
    fn the_tangent_is_the_derivative_of_the_approach() {
        // A central difference with a step of 1e-4 F, whose error is of the order 1e-9.
        for plane in [PlaneState::Stress, PlaneState::Strain] {
            let contact = contact(8.9094e-3, 1.6e-3, plane);
            let approach = |force| contact.approach(force).expect("the contact is narrow");
            let (force, step) = (2447.61, 0.244_761);
            let difference = (approach(force + step) - approach(force - step)) / (2.0 * step);
            let tangent = contact
                .tangent_compliance(force)
                .expect("the contact is narrow");
            assert!((tangent / difference - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn without_a_pressing_force_nothing_is_touched() {
        let contact = contact(8.9094e-3, 1.6e-3, PlaneState::Stress);
        for force in [0.0, -5.0, f64::NAN] {
            assert_eq!(
                (
                    contact.half_width(force),
                    contact.peak_pressure(force),
                    contact.approach(force)
                ),
                (0.0, 0.0, Ok(0.0))
            );
        }
    }

    #[test]
    fn a_contact_wider_than_the_depth_is_refused() {
        let contact = contact(8.9094e-3, 0.1e-3, PlaneState::Stress);
        assert!(matches!(
            contact.approach(2447.61),
            Err(ContactTooWide { .. })
        ));
        assert!(matches!(
            contact.tangent_compliance(f64::INFINITY),
            Err(ContactTooWide { .. })
        ));
        let body = ContactBody {
            material: steel(),
            curvature_radius: 0.0,
            depth: 1e-3,
        };
        assert!(LineContact::new([body, body], FACE_WIDTH, PlaneState::Stress).is_err());
    }
}
