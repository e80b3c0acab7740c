//! Where the line of a load meets the tooth: the geometry that the classical formulas share.
//!
//! Without friction the load lies on the flank's normal, and the normal of an involute touches the base circle. Seen
//! from the tooth's centerline (radial, from the gear's center O) a load at roll length s (the distance of its flank
//! point from the point of tangency, which is also the radius of curvature of the flank there) has
//!
//! - the load angle `α_m = s/r_b - ψ_b`, between the load and the perpendicular to the centerline; positive
//!   when the load also presses the tooth toward the hub;
//! - its crossing with the centerline at the radius `r_b/cos(α_m)`, thus at the height
//!   `u = r_b/cos(α_m) - r_f` above the root circle;
//! - the depth `t = s - r_b tan(α_m)`, measured along the load from the flank to the centerline (Weber's t_1,
//!   t_2).
//!
//! Here ψ_b is half the angle that the tooth spans at its base circle. The component across the tooth is
//! F cos(α_m), the one along it F sin(α_m); the bending moment at a height y is F cos(α_m) (u - y).

use super::quantity::{NotPositive, positive};
use std::f64::consts::{FRAC_PI_2, PI};

/// An involute tooth, as far as a load on it needs to be placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InvoluteTooth {
    base_radius: f64,
    base_half_angle: f64,
    root_radius: f64,
}

/// The least height of a load over the root radius: a load below it bends the tooth by nothing that counts.
const LEAST_HEIGHT: f64 = 1e-6;

/// Where a load acts on a tooth, as the formulas want it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToothLoad {
    /// The height u above the root circle at which the load line crosses the tooth's centerline, in m; positive.
    pub height: f64,
    /// The angle α_m between the load and the perpendicular to the centerline, in rad; positive toward the hub,
    /// within a right angle.
    pub angle: f64,
    /// The distance t from the flank to the centerline along the load, in m; positive.
    pub depth: f64,
}

/// A load that the tooth cannot be given, or a tooth that cannot exist.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ToothLoadError {
    /// A radius, count or length is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// The angles given do not make a tooth.
    #[error("a tooth cannot span {base_half_angle} rad to each side at its base circle")]
    NoTooth {
        /// The half-angle ψ_b that came out, in rad.
        base_half_angle: f64,
    },
    /// The flank point lies where both flanks have already met.
    #[error("at the roll length {roll_length} m the flanks have already met")]
    BeyondPointedTip {
        /// The roll length asked for, in m.
        roll_length: f64,
    },
    /// The rack's rounded tip is wider than the rack's tooth.
    #[error(
        "a rack tip radius of {rack_tip_radius} m does not fit the rack's tooth; at most {greatest} m does"
    )]
    RackTipTooRound {
        /// The radius given, in m.
        rack_tip_radius: f64,
        /// The full radius, in m.
        greatest: f64,
    },
}

impl InvoluteTooth {
    /// The tooth of a gear with `tooth_count` teeth cut by a rack at `pressure_angle` with `profile_shift` (in
    /// modules), in m and rad.
    ///
    /// ψ_b = π/(2 z) + 2 x tan(α)/z + tan(α) - α.
    ///
    /// # Errors
    ///
    /// [`ToothLoadError`] if a radius is not positive or the angles do not make a tooth.
    pub fn new(
        tooth_count: u32,
        pressure_angle: f64,
        profile_shift: f64,
        base_radius: f64,
        root_radius: f64,
    ) -> Result<Self, ToothLoadError> {
        let (z, alpha, x) = (
            positive("the tooth count", f64::from(tooth_count))?,
            pressure_angle,
            profile_shift,
        );
        let psi_b = PI / (2.0 * z) + 2.0 * x * alpha.tan() / z + alpha.tan() - alpha;
        Self::with_base_half_angle(psi_b, base_radius, root_radius)
    }

    /// The tooth that spans `base_half_angle` (rad) to each side of its centerline at the base circle.
    ///
    /// # Errors
    ///
    /// [`ToothLoadError`] if a radius is not positive or the half-angle lies outside (0, π/2).
    pub fn with_base_half_angle(
        base_half_angle: f64,
        base_radius: f64,
        root_radius: f64,
    ) -> Result<Self, ToothLoadError> {
        if !(base_half_angle > 0.0 && base_half_angle < FRAC_PI_2) {
            return Err(ToothLoadError::NoTooth { base_half_angle });
        }
        Ok(Self {
            base_radius: positive("the base radius", base_radius)?,
            base_half_angle,
            root_radius: positive("the root radius", root_radius)?,
        })
    }

    /// Half the angle that the involute flanks span at `radius`, ψ = ψ_b - inv(α_r), in rad.
    ///
    /// Below the base circle there is no involute, and its value at the base circle is returned.
    pub fn half_angle_at(&self, radius: f64) -> f64 {
        let roll_angle = ((radius / self.base_radius).powi(2) - 1.0).max(0.0).sqrt();
        self.base_half_angle - (roll_angle - roll_angle.atan())
    }
}

impl ToothLoad {
    /// The load on `tooth` at `roll_length` (m), measured along the line of action from the base circle.
    ///
    /// # Errors
    ///
    /// [`ToothLoadError`] if the roll length is not positive or lies beyond a pointed tip.
    pub fn at_roll_length(tooth: &InvoluteTooth, roll_length: f64) -> Result<Self, ToothLoadError> {
        let &InvoluteTooth {
            base_radius: r_b,
            base_half_angle: psi_b,
            root_radius: r_f,
        } = tooth;
        let s = positive("the roll length", roll_length)?;

        let alpha_m = s / r_b - psi_b;
        // The depth decides: the flanks meet where it vanishes, long before the load line turns parallel to the
        // centerline.
        let t = if alpha_m < FRAC_PI_2 {
            s - r_b * alpha_m.tan()
        } else {
            0.0
        };
        if t <= 0.0 {
            return Err(ToothLoadError::BeyondPointedTip { roll_length });
        }
        let u = r_b / alpha_m.cos() - r_f;
        Ok(Self {
            // On large gears the line of a load near the root crosses the centerline below the root circle: there is no
            // tooth left to bend, and the formulas want a positive height.
            height: u.max(LEAST_HEIGHT * r_f),
            angle: alpha_m,
            depth: t,
        })
    }
}

/// The half-angle θ_f that a tooth spans at its root circle, when a rack with a rounded tip generates its fillet,
/// in rad.
///
/// The fillet reaches the root circle where the center of the rack's tip rounding passes the line of centers. From
/// the middle of the rack's space that center is π m/4 + (h_f - ρ) tan(α) + ρ/cos(α) away, and the
/// reference circle rolls on the rack, so
///
/// θ_f = (2/(m z)) (π m/4 + (h_f - ρ) tan(α) + ρ/cos(α)),
///
/// whatever the profile shift. `dedendum` is the rack's h_f and `rack_tip_radius` its ρ, both in m. (Some published
/// codes have the addendum in place of h_f, which makes the angle about 6 % smaller for the usual rack.)
///
/// # Errors
///
/// [`ToothLoadError::RackTipTooRound`] if the rounding is wider than the rack's tooth, which would give
/// θ_f > π/z; [`ToothLoadError::NotPositive`] for a length that is not positive (a sharp rack, ρ = 0, is allowed).
pub fn generated_root_half_angle(
    tooth_count: u32,
    module: f64,
    pressure_angle: f64,
    dedendum: f64,
    rack_tip_radius: f64,
) -> Result<f64, ToothLoadError> {
    let z = positive("the tooth count", f64::from(tooth_count))?;
    let m = positive("the module", module)?;
    let h_f = positive("the dedendum", dedendum)?;
    let (alpha, rho) = (pressure_angle, rack_tip_radius);
    if rho.is_nan() || rho < 0.0 {
        return Err(NotPositive {
            quantity: "the rack tip radius",
            value: rho,
        }
        .into());
    }
    let greatest = (PI * m / 4.0 - h_f * alpha.tan()) * alpha.cos() / (1.0 - alpha.sin());
    // A full radius, computed by the caller from the same numbers, may differ from ours in the last digits.
    if !(0.0..=greatest * (1.0 + 1e-12)).contains(&rho) {
        return Err(ToothLoadError::RackTipTooRound {
            rack_tip_radius: rho,
            greatest,
        });
    }
    Ok(2.0 / (m * z) * (PI * m / 4.0 + (h_f - rho) * alpha.tan() + rho / alpha.cos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tooth_of_50() -> InvoluteTooth {
        let alpha = 20_f64.to_radians();
        InvoluteTooth::new(50, alpha, 0.0, 50e-3 * alpha.cos(), 47.5e-3)
            .expect("the standard tooth exists")
    }

    #[test]
    fn the_load_line_runs_from_the_flank_to_the_centerline_as_coordinates_say() {
        // The flank point in coordinates (along and across the centerline), then t along the inward normal: it must
        // end on the centerline at r_f + u. Only rounding is allowed for.
        let tooth = tooth_of_50();
        for s in [13.3564e-3, 17.8187e-3, 22.2810e-3] {
            let load = ToothLoad::at_roll_length(&tooth, s).expect("the load lies on the flank");
            let r = tooth.base_radius.hypot(s);
            let psi = tooth.half_angle_at(r);
            let along = r * psi.cos() - load.depth * load.angle.sin();
            let across = r * psi.sin() - load.depth * load.angle.cos();
            assert!((along - (47.5e-3 + load.height)).abs() < 1e-15);
            assert!(across.abs() < 1e-15);
        }
    }

    #[test]
    fn the_tooth_is_half_a_pitch_thick_at_the_reference_circle() {
        assert!((tooth_of_50().half_angle_at(50e-3) - PI / 100.0).abs() < 1e-15);
    }

    #[test]
    fn a_load_that_the_tooth_cannot_carry_is_refused() {
        let tooth = tooth_of_50();
        assert!(matches!(
            ToothLoad::at_roll_length(&tooth, 40e-3),
            Err(ToothLoadError::BeyondPointedTip { .. })
        ));
        assert!(matches!(
            ToothLoad::at_roll_length(&tooth, 1.0),
            Err(ToothLoadError::BeyondPointedTip { .. })
        ));
        let low = ToothLoad::at_roll_length(&tooth, 3e-3)
            .expect("a load below the root circle bends nothing");
        assert!(low.height < 1e-6);
        assert!(matches!(
            ToothLoad::at_roll_length(&tooth, f64::NAN),
            Err(ToothLoadError::NotPositive(_))
        ));
        assert!(matches!(
            InvoluteTooth::new(0, 0.35, 0.0, 1.0, 1.0),
            Err(ToothLoadError::NotPositive(_))
        ));
        assert!(matches!(
            InvoluteTooth::new(20, 0.35, -9.0, 1.0, 1.0),
            Err(ToothLoadError::NoTooth { .. })
        ));
    }

    #[test]
    fn a_full_radius_on_the_rack_leaves_no_root_between_the_teeth() {
        // With the full radius two fillets meet on the root circle, so the tooth spans its whole pitch, 2 π/z.
        let (m, alpha, h_f) = (2e-3, 20_f64.to_radians(), 2.5e-3);
        let full = (PI * m / 4.0 - h_f * alpha.tan()) * alpha.cos() / (1.0 - alpha.sin());
        let theta_f =
            generated_root_half_angle(50, m, alpha, h_f, full).expect("the full radius fits");
        assert!((theta_f - PI / 50.0).abs() < 1e-15);
        assert!(matches!(
            generated_root_half_angle(50, m, alpha, h_f, 1.01 * full),
            Err(ToothLoadError::RackTipTooRound { .. })
        ));
    }

    #[test]
    fn a_sharp_rack_ends_the_tooth_where_its_corner_passes_the_line_of_centers() {
        let theta_f = generated_root_half_angle(50, 2e-3, 20_f64.to_radians(), 2.5e-3, 0.0)
            .expect("a sharp rack is allowed");
        let corner = PI * 2e-3 / 4.0 + 2.5e-3 * 20_f64.to_radians().tan();
        assert!((theta_f - corner / 50e-3).abs() < 1e-15);
    }
}
