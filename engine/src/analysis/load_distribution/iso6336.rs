//! The single stiffness and mesh stiffness of ISO 6336-1, method B: one number per pair of teeth.
//!
//! The standard fits a polynomial in 1/z and x to sums of the tooth, body and contact compliances of steel disc
//! gears. In its symbols:
//!
//! - q' = 0.04723 + 0.15551/z_n1 + 0.25791/z_n2 − 0.00635 x_1 − 0.11654 x_1/z_n1 − 0.00193 x_2
//!   − 0.24188 x_2/z_n2 + 0.00529 x_1² + 0.00182 x_2², in mm um/N;
//! - c'_th = 1/q', the theoretical single stiffness;
//! - c' = c'_th C_M C_R C_B cos(β), the greatest stiffness of one pair of teeth, with C_M = 0.8 from measurements;
//! - c_γ_α = c' (0.75 ε_α + 0.25), the mean over the path of contact, and
//!   c_γ_β = 0.85 c_γ_α.
//!
//! All stiffnesses are per unit of face width and for loads normal to the flank, in N/m² here: 1 N/(mm um) = 1e9
//! N/m². They hold for line loads of 100 N/mm and more; [`low_load_factor`] says what is left below that. Gear 1 of
//! the standard is the pinion, the gear with fewer teeth. The helix angle is there because the worked example of
//! ISO/TR 6336-30 is helical; a spur gear has 0.

use super::quantity::{NotPositive, positive};

/// One N/(mm um), in N/m².
const NEWTON_PER_MILLIMETER_MICROMETER: f64 = 1e9;
/// C_M: what measured single stiffnesses reach of c'_th.
const MEASURED_SHARE: f64 = 0.8;
/// The line load from which c' is constant, 100 N/mm, in N/m.
const CONSTANT_FROM_LINE_LOAD: f64 = 100e3;
/// Young's modulus of the steel that the fit was made for, in Pa.
const STEEL_YOUNG_MODULUS: f64 = 206e9;
/// The contact ratio from which c_γ_α holds for spur gears.
const LEAST_CONTACT_RATIO: f64 = 1.2;

/// One gear as the fit sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsoGear {
    /// The number of teeth z.
    pub tooth_count: u32,
    /// The profile shift x, in modules.
    pub profile_shift: f64,
}

/// The basic rack as the factor C_B sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasicRack {
    /// The dedendum h_fP over the module.
    pub dedendum_factor: f64,
    /// The normal pressure angle α_n, in rad.
    pub pressure_angle: f64,
}

/// The blank as the factor C_R sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IsoBlank {
    /// A disc as wide as its teeth: C_R = 1.
    Solid,
    /// A rim on a web in its middle.
    Webbed {
        /// The web's thickness b_s over the face width b.
        web_over_face_width: f64,
        /// The rim's thickness s_R under the teeth over the module.
        rim_over_module: f64,
    },
}

/// Two gears within the range that the fit was made for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IsoPair {
    pinion: IsoGear,
    wheel: IsoGear,
    helix_angle: f64,
    base_helix_angle: f64,
}

/// A pair outside the range of the standard's fit.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum IsoError {
    /// A count, factor or ratio is not a positive number.
    #[error(transparent)]
    NotPositive(#[from] NotPositive),
    /// The wheel has the greater profile shift.
    #[error(
        "the fit of ISO 6336-1 holds for x1 >= x2, and the pinion has {pinion}, the wheel {wheel}"
    )]
    ShiftOnWheel {
        /// The profile shift of the gear with fewer teeth.
        pinion: f64,
        /// The profile shift of the gear with more teeth.
        wheel: f64,
    },
    /// The sum of the profile shifts is out of range.
    #[error("the fit of ISO 6336-1 holds for -0.5 <= x1 + x2 <= 2, not for {0}")]
    ShiftSum(f64),
    /// The helix angle is out of range.
    #[error("the helix angle has to lie within 45 degrees, not at {0} rad")]
    HelixAngle(f64),
    /// The pressure angle is out of range.
    #[error("the normal pressure angle has to lie between 0 and 45 degrees, not at {0} rad")]
    PressureAngle(f64),
    /// The contact ratio is too small for the mean stiffness.
    #[error(
        "the mean mesh stiffness of ISO 6336-1 holds from a transverse contact ratio of {LEAST_CONTACT_RATIO}, not at {0}"
    )]
    ContactRatio(f64),
    /// The dedendum is so great that nothing is left of the stiffness.
    #[error("the basic rack factor of ISO 6336-1 vanishes at a dedendum of {0} modules")]
    Dedendum(f64),
}

impl IsoPair {
    /// Two gears in either order, with `helix_angle` at the reference circle and `normal_pressure_angle`, in rad.
    ///
    /// The gear with fewer teeth is the pinion; of two gears alike in teeth, the one with the greater profile shift.
    ///
    /// # Errors
    ///
    /// [`IsoError`] for a pair outside x_1 ≥ x_2 and -0.5 ≤ x_1 + x_2 ≤ 2, or for angles out of range.
    pub fn new(
        gears: [IsoGear; 2],
        helix_angle: f64,
        normal_pressure_angle: f64,
    ) -> Result<Self, IsoError> {
        for gear in gears {
            positive("the tooth count", f64::from(gear.tooth_count))?;
        }
        // Ranges rather than comparisons: NaN has to be refused.
        if !(0.0..=45_f64.to_radians()).contains(&helix_angle.abs()) {
            return Err(IsoError::HelixAngle(helix_angle));
        }
        if !(normal_pressure_angle > 0.0 && normal_pressure_angle < 45_f64.to_radians()) {
            return Err(IsoError::PressureAngle(normal_pressure_angle));
        }

        let [first, second] = gears;
        let in_order = first.tooth_count < second.tooth_count
            || (first.tooth_count == second.tooth_count
                && first.profile_shift >= second.profile_shift);
        let (pinion, wheel) = if in_order {
            (first, second)
        } else {
            (second, first)
        };
        let (x_1, x_2) = (pinion.profile_shift, wheel.profile_shift);
        if x_1.is_nan() || x_2.is_nan() || x_1 < x_2 {
            return Err(IsoError::ShiftOnWheel {
                pinion: x_1,
                wheel: x_2,
            });
        }
        if !(-0.5..=2.0).contains(&(x_1 + x_2)) {
            return Err(IsoError::ShiftSum(x_1 + x_2));
        }
        let base_helix_angle = (helix_angle.sin() * normal_pressure_angle.cos()).asin();
        Ok(Self {
            pinion,
            wheel,
            helix_angle,
            base_helix_angle,
        })
    }

    /// The theoretical single stiffness c'_th = 1/q', in N/m².
    ///
    /// For helical gears the tooth counts are those of the equivalent spur gears, z_n = z/(cos²(β_b) cos(β)).
    pub fn theoretical_single_stiffness(&self) -> f64 {
        let to_equivalent = 1.0 / (self.base_helix_angle.cos().powi(2) * self.helix_angle.cos());
        let z_n1 = f64::from(self.pinion.tooth_count) * to_equivalent;
        let z_n2 = f64::from(self.wheel.tooth_count) * to_equivalent;
        let (x_1, x_2) = (self.pinion.profile_shift, self.wheel.profile_shift);

        let q = 0.04723 + 0.15551 / z_n1 + 0.25791 / z_n2
            - 0.00635 * x_1
            - 0.11654 * x_1 / z_n1
            - 0.00193 * x_2
            - 0.24188 * x_2 / z_n2
            + 0.00529 * x_1.powi(2)
            + 0.00182 * x_2.powi(2);
        NEWTON_PER_MILLIMETER_MICROMETER / q
    }

    /// The single stiffness c' = c'_th C_M C_R C_B cos(β) of steel gears, in N/m².
    ///
    /// Gears cut by two racks have the mean of their two [`BasicRack::factor`]s; ours are cut by one.
    ///
    /// # Errors
    ///
    /// [`IsoError`] if a factor does not come out positive.
    pub fn single_stiffness(&self, rack: &BasicRack, blank: &IsoBlank) -> Result<f64, IsoError> {
        Ok(self.theoretical_single_stiffness()
            * MEASURED_SHARE
            * blank.factor()?
            * rack.factor()?
            * self.helix_angle.cos())
    }
}

impl BasicRack {
    /// C_B = (1 + 0.5 (1.2 - h_fP/m_n)) (1 - 0.02 (20 - α_n in degrees)).
    ///
    /// # Errors
    ///
    /// [`IsoError`] for a dedendum or pressure angle at which the factor is no longer positive.
    pub fn factor(&self) -> Result<f64, IsoError> {
        let depth = 1.0 + 0.5 * (1.2 - positive("the dedendum factor", self.dedendum_factor)?);
        if depth <= 0.0 {
            return Err(IsoError::Dedendum(self.dedendum_factor));
        }
        let alpha_n = self.pressure_angle;
        if !(alpha_n > 0.0 && alpha_n < 45_f64.to_radians()) {
            return Err(IsoError::PressureAngle(alpha_n));
        }
        Ok(depth * (1.0 - 0.02 * (20.0 - alpha_n.to_degrees())))
    }
}

impl IsoBlank {
    /// C_R = 1 + ln(b_s/b) / (5 exp(s_R/(5 m_n))).
    ///
    /// Outside 0.2 ≤ b_s/b ≤ 1.2 and below s_R/m_n = 1 the value at that bound holds.
    ///
    /// # Errors
    ///
    /// [`IsoError::NotPositive`] for a ratio that is not a positive number.
    pub fn factor(&self) -> Result<f64, IsoError> {
        match *self {
            Self::Solid => Ok(1.0),
            Self::Webbed {
                web_over_face_width,
                rim_over_module,
            } => {
                let web = positive(
                    "the web's thickness over the face width",
                    web_over_face_width,
                )?
                .clamp(0.2, 1.2);
                let rim =
                    positive("the rim's thickness over the module", rim_over_module)?.max(1.0);
                Ok(1.0 + web.ln() / (5.0 * (rim / 5.0).exp()))
            }
        }
    }
}

/// What a single stiffness of steel gears is multiplied by for other materials: E/E_steel with E = 2 E_1 E_2/(E_1 +
/// E_2) and E_steel = 206 GPa.
///
/// # Errors
///
/// [`IsoError::NotPositive`] for a modulus (Pa) that is not a positive number.
pub fn material_factor(young_moduli: [f64; 2]) -> Result<f64, IsoError> {
    let e_1 = positive("Young's modulus", young_moduli[0])?;
    let e_2 = positive("Young's modulus", young_moduli[1])?;
    Ok(2.0 / (1.0 / e_1 + 1.0 / e_2) / STEEL_YOUNG_MODULUS)
}

/// What is left of a single stiffness at a line load F K_A/b below 100 N/mm: ((F K_A/b)/(100 N/mm))^0.25, and 1
/// above.
///
/// `line_load` is in N/m; without load nothing is left.
pub fn low_load_factor(line_load: f64) -> f64 {
    (line_load / CONSTANT_FROM_LINE_LOAD)
        .clamp(0.0, 1.0)
        .powf(0.25)
}

/// The mean mesh stiffness c_γ_α = c' (0.75 ε_α + 0.25) over the path of contact, in the unit of
/// `single_stiffness`.
///
/// # Errors
///
/// [`IsoError::ContactRatio`] below 1.2, where the standard does not vouch for it.
pub fn mean_mesh_stiffness(single_stiffness: f64, contact_ratio: f64) -> Result<f64, IsoError> {
    if !(contact_ratio >= LEAST_CONTACT_RATIO && contact_ratio.is_finite()) {
        return Err(IsoError::ContactRatio(contact_ratio));
    }
    Ok(single_stiffness * (0.75 * contact_ratio + 0.25))
}

/// The mesh stiffness for the load's distribution over the face, c_γ_β = 0.85 c_γ_α.
pub fn face_load_mesh_stiffness(mean_mesh_stiffness: f64) -> f64 {
    0.85 * mean_mesh_stiffness
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const ALPHA: f64 = 20.0 * TAU / 360.0;

    /// A value in N/m² against a print in N/(mm um), to half a unit of its last digit.
    fn assert_printed(value: f64, print: f64, decimals: i32) {
        let value = value / 1e9;
        assert!(
            (value - print).abs() <= 0.5 * 10_f64.powi(-decimals),
            "{value} beside the printed {print}"
        );
    }

    fn gear(tooth_count: u32, profile_shift: f64) -> IsoGear {
        IsoGear {
            tooth_count,
            profile_shift,
        }
    }

    fn spur_pair(z_1: u32, z_2: u32) -> IsoPair {
        IsoPair::new([gear(z_1, 0.0), gear(z_2, 0.0)], 0.0, ALPHA).expect("the pair is in range")
    }

    /// The contact ratio of a pair of module 2 mm, addendum 2 mm, without profile shift.
    fn contact_ratio(z_1: f64, z_2: f64, center_distance: f64) -> f64 {
        let path = |z: f64| ((z + 2.0).powi(2) - (z * ALPHA.cos()).powi(2)).sqrt() * 1e-3;
        let cos_alpha_w = (z_1 + z_2) * 1e-3 * ALPHA.cos() / center_distance;
        (path(z_1) + path(z_2) - center_distance * (1.0 - cos_alpha_w.powi(2)).sqrt())
            / (TAU / 2.0 * 2e-3 * ALPHA.cos())
    }

    #[test]
    fn the_worked_example_of_iso_tr_6336_30_comes_out_to_its_printed_digits() {
        // Example 1: z 17/103, β 15.8 degrees, x 0.145/0, rack D. Its ε_α is implied by its own
        // c_γ_α, 1.54909.
        let pair = IsoPair::new(
            [gear(17, 0.145), gear(103, 0.0)],
            15.8_f64.to_radians(),
            ALPHA,
        )
        .expect("the example is in range");
        let rack = BasicRack {
            dedendum_factor: 1.4,
            pressure_angle: ALPHA,
        };
        assert_printed(pair.theoretical_single_stiffness(), 17.85584, 5);

        let single = pair
            .single_stiffness(&rack, &IsoBlank::Solid)
            .expect("the rack is in range");
        assert_printed(single, 12.37047, 5);
        let mean = mean_mesh_stiffness(single, 1.54909).expect("the contact ratio is in range");
        assert_printed(mean, 17.46485, 5);
        assert_printed(face_load_mesh_stiffness(mean), 14.84512, 5);

        // With the contact ratio of the example's geometry, 1.54934 to five digits, which leaves 5e-5 open.
        let mean = mean_mesh_stiffness(single, 1.54934).expect("the contact ratio is in range");
        assert!((mean / 1e9 - 17.46719).abs() < 5e-5);
    }

    #[test]
    fn the_papers_pairs_have_the_single_stiffnesses_worked_out_for_them() {
        let rack = BasicRack {
            dedendum_factor: 1.25,
            pressure_angle: ALPHA,
        };
        for (z_1, z_2, c_th, c, means) in [
            (
                50,
                50,
                18.0185,
                14.0545,
                [(100.0e-3, 22.0094), (100.5e-3, 19.4467)],
            ),
            (
                29,
                85,
                17.9770,
                14.0221,
                [(114.0e-3, 21.8011), (114.5e-3, 19.2387)],
            ),
        ] {
            let pair = spur_pair(z_1, z_2);
            assert_printed(pair.theoretical_single_stiffness(), c_th, 4);
            let single = pair
                .single_stiffness(&rack, &IsoBlank::Solid)
                .expect("the rack is in range");
            assert_printed(single, c, 4);
            for (center_distance, print) in means {
                let epsilon_alpha = contact_ratio(f64::from(z_1), f64::from(z_2), center_distance);
                assert_printed(
                    mean_mesh_stiffness(single, epsilon_alpha)
                        .expect("the contact ratio is in range"),
                    print,
                    4,
                );
            }
        }
    }

    #[test]
    fn twenty_millimeters_of_the_standard_pair_are_as_stiff_as_worked_out() {
        // k = c b, printed in N/m to four digits.
        let rack = BasicRack {
            dedendum_factor: 1.25,
            pressure_angle: ALPHA,
        };
        let single = spur_pair(50, 50)
            .single_stiffness(&rack, &IsoBlank::Solid)
            .expect("the rack is in range");
        assert!((single * 20e-3 - 2.811e8).abs() < 0.5e5);
        for (center_distance, k) in [(100.0e-3, 4.402e8), (100.5e-3, 3.889e8)] {
            let mean = mean_mesh_stiffness(single, contact_ratio(50.0, 50.0, center_distance))
                .expect("the contact ratio is in range");
            assert!((mean * 20e-3 - k).abs() < 0.5e5);
        }
    }

    #[test]
    fn the_order_of_the_gears_does_not_matter() {
        let (small, large) = (gear(29, 0.2), gear(85, -0.1));
        let forward = IsoPair::new([small, large], 0.0, ALPHA).expect("the pair is in range");
        let backward = IsoPair::new([large, small], 0.0, ALPHA).expect("the pair is in range");
        assert_eq!(forward, backward);
        // Of two equal tooth counts, either gear may be called the pinion, so the shift decides.
        assert!(IsoPair::new([gear(50, 0.0), gear(50, 0.3)], 0.0, ALPHA).is_ok());
    }

    #[test]
    fn a_pair_outside_the_range_of_the_fit_is_refused_with_its_numbers() {
        let pair = |x_1, x_2, beta| IsoPair::new([gear(29, x_1), gear(85, x_2)], beta, ALPHA);
        assert_eq!(
            pair(0.0, 0.1, 0.0),
            Err(IsoError::ShiftOnWheel {
                pinion: 0.0,
                wheel: 0.1
            })
        );
        assert_eq!(pair(-0.3, -0.3, 0.0), Err(IsoError::ShiftSum(-0.6)));
        assert_eq!(pair(1.5, 1.0, 0.0), Err(IsoError::ShiftSum(2.5)));
        assert!(matches!(
            pair(f64::NAN, 0.0, 0.0),
            Err(IsoError::ShiftOnWheel { .. })
        ));
        assert!(matches!(pair(0.0, 0.0, 0.9), Err(IsoError::HelixAngle(_))));
        assert!(matches!(
            IsoPair::new([gear(0, 0.0), gear(85, 0.0)], 0.0, ALPHA),
            Err(IsoError::NotPositive(_))
        ));
        assert_eq!(
            mean_mesh_stiffness(14e9, 1.1),
            Err(IsoError::ContactRatio(1.1))
        );
        assert!(matches!(
            BasicRack {
                dedendum_factor: 3.3,
                pressure_angle: ALPHA
            }
            .factor(),
            Err(IsoError::Dedendum(_))
        ));
    }

    #[test]
    fn a_web_as_wide_as_the_teeth_is_a_solid_disc_and_a_thinner_one_is_softer() {
        let webbed = |web, rim| {
            IsoBlank::Webbed {
                web_over_face_width: web,
                rim_over_module: rim,
            }
            .factor()
            .expect("the ratios are positive")
        };
        assert_eq!(webbed(1.0, 2.0), 1.0);
        // By hand: 1 + ln(0.3)/(5 exp(0.4)) = 1 - 1.203973/7.459123 = 0.838591.
        assert!((webbed(0.3, 2.0) - 0.838_591).abs() < 1e-6);
        assert_eq!(webbed(0.05, 0.3), webbed(0.2, 1.0));
    }

    #[test]
    fn other_materials_scale_the_stiffness_by_their_modulus_in_series() {
        assert!(
            (material_factor([206e9, 206e9]).expect("the moduli are positive") - 1.0).abs() < 1e-15
        );
        // A rigid partner doubles the modulus in series.
        assert!(
            (material_factor([206e9, 206e15]).expect("the moduli are positive") - 2.0).abs() < 1e-5
        );
    }

    #[test]
    fn a_sixteenth_of_the_least_line_load_leaves_half_of_the_stiffness() {
        assert!((low_load_factor(100e3 / 16.0) - 0.5).abs() < 1e-15);
        assert_eq!(low_load_factor(150e3), 1.0);
        assert_eq!(low_load_factor(0.0), 0.0);
    }
}
