//! A whole spur gear: what its drawing says, checked once.

use std::f64::consts::PI;

use super::involute::involute_function;
use super::rack::Trochoid;
use super::{Blank, HolePattern, Involute, Material, Rack, ReliefShape, ReliefStart, TipRelief};
use crate::quadrature::gauss_legendre_panels;
use crate::root_finding::bisect;

/// The least material, in meters, between a hole and its neighbor, the bore or the root circle.
pub const LEAST_LIGAMENT: f64 = 0.5e-3;

/// The least thickness of a tooth at its tip circle, in modules; below it the tooth counts as pointed.
pub const LEAST_TIP_THICKNESS: f64 = 0.05;

/// The least rim between the bore and the root circle, in modules.
pub const LEAST_RIM: f64 = 1.0;

/// A tip relief as a drawing gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefData {
    /// The amount C_a at the tip.
    pub amount: f64,
    /// How it grows towards the tip.
    pub shape: ReliefShape,
    /// Where it starts.
    pub start: ReliefStart,
}

/// What a drawing says of a spur gear; [`SpurGear::new`] checks it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GearData {
    /// The number of teeth Z.
    pub tooth_count: u32,
    /// The basic rack.
    pub rack: Rack,
    /// The profile shift coefficient x.
    pub profile_shift: f64,
    /// The face width b.
    pub face_width: f64,
    /// The tip relief of the loaded flanks.
    pub tip_relief: Option<ReliefData>,
    /// The material of teeth and blank.
    pub material: Material,
    /// What carries the teeth.
    pub blank: Blank,
}

/// Why a gear cannot be made as drawn. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GearError {
    /// The rack's tip rounding does not fit between its flanks.
    #[error("the rack's tip rounding of radius {tip_radius} m does not fit: at most {largest} m")]
    RackTipRadius {
        /// The radius asked for.
        tip_radius: f64,
        /// The largest that fits.
        largest: f64,
    },
    /// The rack cuts into the involute.
    #[error("the flank is undercut at profile shift {profile_shift}; {smallest} avoids it")]
    Undercut {
        /// The profile shift coefficient asked for.
        profile_shift: f64,
        /// The smallest that avoids undercut.
        smallest: f64,
    },
    /// The flanks meet, or nearly, below the tip circle.
    #[error(
        "the tooth is {thickness} m thick at its tip; an addendum of {largest_addendum} m leaves enough"
    )]
    PointedTip {
        /// The thickness at the tip circle, negative if the flanks cross.
        thickness: f64,
        /// The largest addendum of the rack that leaves [`LEAST_TIP_THICKNESS`].
        largest_addendum: f64,
    },
    /// No involute is left between the form circle and the tip circle.
    #[error("the tip radius {tip_radius} m leaves no flank above the form radius {form_radius} m")]
    NoFlank {
        /// The tip radius.
        tip_radius: f64,
        /// The form radius.
        form_radius: f64,
    },
    /// The relief starts below the flank or at the tip.
    #[error(
        "the relief starts at radius {start_radius} m, outside the flank from {form_radius} m to {tip_radius} m"
    )]
    ReliefTooLong {
        /// The radius at which it was to start.
        start_radius: f64,
        /// The form radius.
        form_radius: f64,
        /// The tip radius.
        tip_radius: f64,
    },
    /// The bore leaves too thin a rim below the root circle.
    #[error("the bore of radius {bore_radius} m leaves no rim; at most {largest} m")]
    BoreTooLarge {
        /// The bore radius asked for.
        bore_radius: f64,
        /// The largest that leaves [`LEAST_RIM`].
        largest: f64,
    },
    /// Neighboring holes leave too little between them.
    #[error("the holes leave {ligament} m between them; a radius of {largest_radius} m would do")]
    HolesOverlap {
        /// The material left, negative if they overlap.
        ligament: f64,
        /// The largest hole radius that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
    /// The holes leave too little below the root circle.
    #[error(
        "the holes leave {ligament} m below the root circle; a radius of {largest_radius} m would do"
    )]
    HolesBreachRim {
        /// The material left, negative if they cut through.
        ligament: f64,
        /// The largest hole radius that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
    /// The holes leave too little around the bore.
    #[error(
        "the holes leave {ligament} m around the bore; a radius of {largest_radius} m would do"
    )]
    HolesBreachBore {
        /// The material left, negative if they cut through.
        ligament: f64,
        /// The largest hole radius that leaves [`LEAST_LIGAMENT`].
        largest_radius: f64,
    },
}

/// A spur gear that can be made: neither undercut nor pointed, with its holes inside its blank.
///
/// Lengths are in meters, angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpurGear {
    data: GearData,
    flank: Involute,
    tip_relief: Option<TipRelief>,
}

impl SpurGear {
    /// Checks a drawing.
    ///
    /// # Errors
    ///
    /// [`GearError`] says which part cannot be made and what would do.
    pub fn new(data: GearData) -> Result<Self, GearError> {
        let rack = &data.rack;
        let (z, alpha) = (f64::from(data.tooth_count), rack.pressure_angle);
        let r = rack.module * z / 2.0;
        let psi_b =
            PI / (2.0 * z) + 2.0 * data.profile_shift * alpha.tan() / z + involute_function(alpha);
        let mut gear = Self {
            data,
            flank: Involute::new(r * alpha.cos(), psi_b),
            tip_relief: None,
        };

        gear.check_rack()?;
        gear.check_tooth()?;
        gear.check_blank()?;
        gear.tip_relief = gear.checked_relief()?;
        Ok(gear)
    }

    fn check_rack(&self) -> Result<(), GearError> {
        let rack = &self.data.rack;
        let largest = rack.largest_tip_radius();
        if rack.tip_radius > largest {
            return Err(GearError::RackTipRadius {
                tip_radius: rack.tip_radius,
                largest,
            });
        }
        Ok(())
    }

    fn check_tooth(&self) -> Result<(), GearError> {
        let rack = &self.data.rack;
        let (r, sin) = (self.reference_radius(), rack.pressure_angle.sin());
        if self.form_roll_length_signed() < 0.0 {
            let smallest = (rack.straight_depth() - r * sin * sin) / rack.module;
            return Err(GearError::Undercut {
                profile_shift: self.data.profile_shift,
                smallest,
            });
        }
        let (r_a, r_form) = (self.tip_radius(), self.form_radius());
        if r_a <= r_form {
            return Err(GearError::NoFlank {
                tip_radius: r_a,
                form_radius: r_form,
            });
        }
        let thickness = self.tip_thickness();
        if thickness < LEAST_TIP_THICKNESS * rack.module {
            return Err(GearError::PointedTip {
                thickness,
                largest_addendum: self.largest_addendum(),
            });
        }
        Ok(())
    }

    fn check_blank(&self) -> Result<(), GearError> {
        let bore_radius = self.data.blank.bore_radius;
        let largest = self.root_radius() - LEAST_RIM * self.data.rack.module;
        if bore_radius > largest {
            return Err(GearError::BoreTooLarge {
                bore_radius,
                largest,
            });
        }
        let Some(holes) = self.data.blank.holes else {
            return Ok(());
        };
        let too_thin = |ligament: f64| ligament < LEAST_LIGAMENT;
        let largest_radius = |ligament: f64| holes.radius + ligament - LEAST_LIGAMENT;
        let ligament = holes.ligament_between();
        if too_thin(ligament) {
            let largest_radius = holes.radius + (ligament - LEAST_LIGAMENT) / 2.0;
            return Err(GearError::HolesOverlap {
                ligament,
                largest_radius,
            });
        }
        let ligament = self.root_radius() - holes.outer_reach();
        if too_thin(ligament) {
            return Err(GearError::HolesBreachRim {
                ligament,
                largest_radius: largest_radius(ligament),
            });
        }
        let ligament = holes.inner_reach() - bore_radius;
        if too_thin(ligament) {
            return Err(GearError::HolesBreachBore {
                ligament,
                largest_radius: largest_radius(ligament),
            });
        }
        Ok(())
    }

    fn checked_relief(&self) -> Result<Option<TipRelief>, GearError> {
        let Some(relief) = self.data.tip_relief.filter(|relief| relief.amount > 0.0) else {
            return Ok(None);
        };
        let (r_form, r_a) = (self.form_radius(), self.tip_radius());
        let r_s = relief.start.radius(&self.flank, r_a);
        if !(r_s >= r_form && r_s < r_a) {
            return Err(GearError::ReliefTooLong {
                start_radius: r_s,
                form_radius: r_form,
                tip_radius: r_a,
            });
        }
        Ok(Some(TipRelief::new(relief.amount, relief.shape, r_s, r_a)))
    }

    /// The drawing.
    pub fn data(&self) -> &GearData {
        &self.data
    }

    /// The same teeth on a blank without bore and holes: what is left to say where the blank does not matter.
    pub fn without_blank(&self) -> Self {
        self.on_blank(Blank {
            bore_radius: 0.0,
            holes: None,
        })
    }

    /// The same gear without holes.
    pub fn without_holes(&self) -> Self {
        self.on_blank(Blank {
            holes: None,
            ..self.data.blank
        })
    }

    /// The same gear with hole 0 at the angle 0.
    pub fn with_holes_unturned(&self) -> Self {
        let holes = self.data.blank.holes;
        self.on_blank(Blank {
            holes: holes.map(|holes| HolePattern {
                phase: 0.0,
                ..holes
            }),
            ..self.data.blank
        })
    }

    /// The same gear with flanks that are not relieved.
    pub fn without_relief(&self) -> Self {
        Self {
            data: GearData {
                tip_relief: None,
                ..self.data
            },
            tip_relief: None,
            ..*self
        }
    }

    /// The same gear on a `blank` that is known to fit.
    fn on_blank(&self, blank: Blank) -> Self {
        Self {
            data: GearData { blank, ..self.data },
            ..*self
        }
    }

    /// The number of teeth Z.
    pub fn tooth_count(&self) -> u32 {
        self.data.tooth_count
    }

    /// The face width b.
    pub fn face_width(&self) -> f64 {
        self.data.face_width
    }

    /// The material.
    pub fn material(&self) -> &Material {
        &self.data.material
    }

    /// The bore radius.
    pub fn bore_radius(&self) -> f64 {
        self.data.blank.bore_radius
    }

    /// The holes of the blank, if there are any.
    pub fn holes(&self) -> Option<&HolePattern> {
        self.data.blank.holes.as_ref()
    }

    /// The loaded flank of tooth 0.
    pub fn flank(&self) -> &Involute {
        &self.flank
    }

    /// The fillet of tooth 0 on its loaded side.
    pub fn fillet(&self) -> Trochoid {
        Trochoid::new(
            &self.data.rack,
            self.data.tooth_count,
            self.profile_shift_length(),
        )
    }

    /// The tip relief, if there is any.
    pub fn tip_relief(&self) -> Option<&TipRelief> {
        self.tip_relief.as_ref()
    }

    /// The material removed from the flank at `radius`, along the normal.
    pub fn relief_depth(&self, radius: f64) -> f64 {
        self.tip_relief.map_or(0.0, |relief| relief.depth(radius))
    }

    /// The slope of [`SpurGear::relief_depth`] by the radius.
    pub fn relief_slope(&self, radius: f64) -> f64 {
        self.tip_relief.map_or(0.0, |relief| relief.slope(radius))
    }

    /// The flank from the form circle to the tip circle, by arc length from the base circle.
    pub fn flank_arcs(&self) -> (f64, f64) {
        (
            self.flank.arc_length(self.form_roll_length()),
            self.flank.arc_length(self.tip_roll_length()),
        )
    }

    /// The angle 2π/Z between teeth.
    pub fn pitch_angle(&self) -> f64 {
        2.0 * PI / f64::from(self.data.tooth_count)
    }

    /// The reference radius r = m Z/2.
    pub fn reference_radius(&self) -> f64 {
        self.data.rack.module * f64::from(self.data.tooth_count) / 2.0
    }

    /// The base radius r_b = r cos α (R_b in the paper).
    pub fn base_radius(&self) -> f64 {
        self.flank.base_radius()
    }

    /// The tip radius r_a = r + h_a + x m; tips are not shortened.
    pub fn tip_radius(&self) -> f64 {
        self.reference_radius() + self.data.rack.addendum + self.profile_shift_length()
    }

    /// The root radius r_f = r − h_f + x m.
    pub fn root_radius(&self) -> f64 {
        self.reference_radius() - self.data.rack.dedendum + self.profile_shift_length()
    }

    /// The base pitch p_b = π m cos α.
    pub fn base_pitch(&self) -> f64 {
        PI * self.data.rack.module * self.data.rack.pressure_angle.cos()
    }

    /// The roll length at which the generated flank ends and the fillet begins.
    pub fn form_roll_length(&self) -> f64 {
        self.form_roll_length_signed().max(0.0)
    }

    /// The form radius: where the flank ends and the fillet begins.
    pub fn form_radius(&self) -> f64 {
        self.flank.radius(self.form_roll_length())
    }

    /// The roll length at the tip circle.
    pub fn tip_roll_length(&self) -> f64 {
        self.flank.roll_length(self.tip_radius())
    }

    /// The thickness of the tooth along its tip circle.
    pub fn tip_thickness(&self) -> f64 {
        let r_a = self.tip_radius();
        2.0 * r_a * self.flank.half_angle(r_a)
    }

    /// The thinnest material around the holes: between them, above them and below them. `None` without holes.
    pub fn least_ligament(&self) -> Option<f64> {
        self.holes().map(|holes| {
            let above = self.root_radius() - holes.outer_reach();
            let below = holes.inner_reach() - self.bore_radius();
            holes.ligament_between().min(above).min(below)
        })
    }

    /// The mass in kg, from the true profile.
    pub fn mass(&self) -> f64 {
        let (area, _) = self.profile_moments();
        let holes = self.holes().map_or(0.0, HolePattern::area);
        let bore = PI * self.bore_radius().powi(2);
        self.data.material.density * self.data.face_width * (area - bore - holes)
    }

    /// The polar moment of inertia about the axis in kg m², from the true profile.
    pub fn polar_inertia(&self) -> f64 {
        let (_, moment) = self.profile_moments();
        let holes = self.holes().map_or(0.0, HolePattern::polar_moment);
        let bore = PI / 2.0 * self.bore_radius().powi(4);
        self.data.material.density * self.data.face_width * (moment - bore - holes)
    }

    /// The share of the blank that the holes remove; the blank is the ring between the bore and the mean of tip and root
    /// circle (DESIGN section 4).
    pub fn removed_fraction(&self) -> f64 {
        self.holes()
            .map_or(0.0, |holes| holes.area() / self.nominal_blank_area())
    }

    /// The area π (((r_a + r_f)/2)² − r_bore²) to which removed mass is referred.
    pub fn nominal_blank_area(&self) -> f64 {
        let mean = f64::midpoint(self.tip_radius(), self.root_radius());
        PI * (mean.powi(2) - self.bore_radius().powi(2))
    }

    fn profile_shift_length(&self) -> f64 {
        self.data.profile_shift * self.data.rack.module
    }

    fn form_roll_length_signed(&self) -> f64 {
        let sin = self.data.rack.pressure_angle.sin();
        self.reference_radius() * sin
            - (self.data.rack.straight_depth() - self.profile_shift_length()) / sin
    }

    fn largest_addendum(&self) -> f64 {
        let r_0 = self.reference_radius() + self.profile_shift_length();
        let least = LEAST_TIP_THICKNESS * self.data.rack.module;
        let thick_enough = |addendum: f64| {
            let r_a = r_0 + addendum;
            2.0 * r_a * self.flank.half_angle(r_a) >= least
        };
        bisect(
            self.form_radius() - r_0,
            self.data.rack.addendum,
            thick_enough,
        )
    }

    /// The area and the second polar moment inside the tooth profile, by Green's theorem along one half tooth:
    /// A = ½∮ r² dθ and J = ¼∮ r⁴ dθ, with r² dθ = x dy − y dx.
    fn profile_moments(&self) -> (f64, f64) {
        let (s_form, s_tip) = (self.form_roll_length(), self.tip_roll_length());
        let fillet = self.fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let (r_a, r_f) = (self.tip_radius(), self.root_radius());
        let tip_angle = self.flank.half_angle(r_a);
        let root_end = fillet.point(gamma_1);
        let root_angle = self.pitch_angle() / 2.0 - root_end.y.atan2(root_end.x);

        let mut area = r_a.powi(2) * tip_angle + r_f.powi(2) * root_angle;
        let mut moment = r_a.powi(4) * tip_angle + r_f.powi(4) * root_angle;
        for (s, weight) in gauss_legendre_panels(s_form, s_tip, 8) {
            // From the tip down the involute, x dy − y dx = (s²/r_b) |ds|.
            let swept = s * s / self.flank.base_radius();
            area += weight * swept;
            moment += weight * swept * self.flank.radius(s).powi(2);
        }
        let step = 1e-5;
        for (gamma, weight) in gauss_legendre_panels(gamma_0, gamma_1, 8) {
            let p = fillet.point(gamma);
            let d = (fillet.point(gamma + step) - fillet.point(gamma - step)) / (2.0 * step);
            let swept = p.x * d.y - p.y * d.x;
            area += weight * swept;
            moment += weight * swept * p.norm_squared();
        }
        let halves = 2.0 * f64::from(self.data.tooth_count);
        (halves * area / 2.0, halves * moment / 4.0)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The paper's gears (Table 1): module 2 mm, 20 degrees, addendum 2 mm, dedendum 2.5 mm, width 20 mm, steel.
    pub(crate) fn paper_gear(tooth_count: u32) -> GearData {
        GearData {
            tooth_count,
            rack: Rack {
                module: 2e-3,
                pressure_angle: 20_f64.to_radians(),
                addendum: 2e-3,
                dedendum: 2.5e-3,
                tip_radius: 0.76e-3,
            },
            profile_shift: 0.0,
            face_width: 20e-3,
            tip_relief: None,
            material: Material {
                youngs_modulus: 210e9,
                poisson_ratio: 0.3,
                density: 7850.0,
            },
            blank: Blank {
                bore_radius: 15e-3,
                holes: None,
            },
        }
    }

    fn with_holes(count: u32, circle_radius: f64, radius: f64) -> Result<SpurGear, GearError> {
        let mut data = paper_gear(50);
        data.blank.holes = Some(HolePattern {
            count,
            circle_radius,
            radius,
            phase: 0.0,
        });
        SpurGear::new(data)
    }

    #[test]
    fn the_form_radius_is_the_one_of_the_independent_solver() {
        // calculix-s1.json: r_form = 48.31354660697083 mm.
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        assert!((gear.form_radius() - 48.313_546_606_970_83e-3).abs() < 1e-12);
    }

    #[test]
    fn undercut_begins_below_the_textbook_tooth_count_and_the_named_shift_cures_it() {
        // z_min = 2 h_Ff/(m sin² α) = 17.1 for the ISO rack with rounding 0.38 m, whose straight depth is one module.
        assert!(
            SpurGear::new(paper_gear(18)).is_err(),
            "a bore of 15 mm leaves no rim"
        );
        let small = |z, x| {
            let mut data = paper_gear(z);
            data.blank.bore_radius = 5e-3;
            data.profile_shift = x;
            SpurGear::new(data)
        };
        assert!(small(18, 0.0).is_ok());
        let Err(GearError::Undercut { smallest, .. }) = small(12, 0.0) else {
            panic!("12 teeth are undercut")
        };
        assert!(small(12, smallest + 1e-9).is_ok());
        assert!(matches!(
            small(12, smallest - 1e-6),
            Err(GearError::Undercut { .. })
        ));
    }

    #[test]
    fn a_pointed_tooth_is_refused_and_the_named_addendum_cures_it() {
        let mut data = paper_gear(30);
        data.rack.addendum = 4e-3;
        let Err(GearError::PointedTip {
            largest_addendum, ..
        }) = SpurGear::new(data)
        else {
            panic!("pointed")
        };
        data.rack.addendum = largest_addendum;
        assert!(SpurGear::new(data).is_ok());
    }

    #[test]
    fn holes_are_refused_where_they_touch_and_the_named_radius_cures_each() {
        // Touching limits R sin(π/N) of FIELD section 3.1, less half the least ligament.
        let Err(GearError::HolesOverlap { largest_radius, .. }) = with_holes(8, 27e-3, 10.5e-3)
        else {
            panic!("overlap")
        };
        assert!((largest_radius - (10.332e-3 - 0.25e-3)).abs() < 1e-6);
        assert!(with_holes(8, 27e-3, largest_radius - 1e-12).is_ok());
        let Err(GearError::HolesBreachRim { largest_radius, .. }) = with_holes(6, 38e-3, 9.5e-3)
        else {
            panic!("rim")
        };
        assert!((largest_radius - 9e-3).abs() < 1e-12);
        let Err(GearError::HolesBreachBore { largest_radius, .. }) = with_holes(3, 25e-3, 10e-3)
        else {
            panic!("bore")
        };
        assert!((largest_radius - 9.5e-3).abs() < 1e-12);
    }

    #[test]
    fn a_relief_must_start_on_the_flank() {
        let mut data = paper_gear(50);
        let relief = |length| ReliefData {
            amount: 5e-6,
            shape: ReliefShape::Linear,
            start: ReliefStart::RadialLength(length),
        };
        data.tip_relief = Some(relief(3.7e-3));
        assert!(matches!(
            SpurGear::new(data),
            Err(GearError::ReliefTooLong { .. })
        ));
        data.tip_relief = Some(relief(1.75e-3));
        assert!((SpurGear::new(data).expect("fits").relief_depth(52e-3) - 5e-6).abs() < 1e-18);
    }

    #[test]
    fn the_profile_area_agrees_with_a_polygon_through_the_true_profile() {
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        let (s_0, s_1) = (gear.form_roll_length(), gear.tip_roll_length());
        let (gamma_0, gamma_1) = gear.fillet().ends();
        let n = 4000;
        let half: Vec<_> = (0..=n)
            .map(|i| {
                gear.flank()
                    .point(s_1 + (s_0 - s_1) * f64::from(i) / f64::from(n))
            })
            .chain((1..=n).map(|i| {
                gear.fillet()
                    .point(gamma_0 + (gamma_1 - gamma_0) * f64::from(i) / f64::from(n))
            }))
            .collect();
        let swept: f64 = half
            .windows(2)
            .map(|p| (p[0].x * p[1].y - p[0].y * p[1].x) / 2.0)
            .sum();
        let first = half[0].y.atan2(half[0].x);
        let last = gear.pitch_angle() / 2.0 - half[half.len() - 1].y.atan2(half[half.len() - 1].x);
        let area =
            100.0 * (swept + 52e-3_f64.powi(2) * first / 2.0 + 47.5e-3_f64.powi(2) * last / 2.0);
        let mass = 7850.0 * 20e-3 * (area - PI * 15e-3_f64.powi(2));
        assert!(
            (gear.mass() / mass - 1.0).abs() < 1e-6,
            "polygon {mass}, quadrature {}",
            gear.mass()
        );
    }

    #[test]
    fn a_quarter_of_the_blank_goes_with_the_papers_hole_radii() {
        // DESIGN section 4: bore 15 mm and 25 % give r = 7.500 (10 holes), 8.385 (8), 9.683 (6) mm.
        for (count, circle_radius, radius) in [
            (10, 34e-3, 7.5e-3),
            (8, 34e-3, 8.385e-3),
            (6, 30e-3, 9.683e-3),
        ] {
            let gear = with_holes(count, circle_radius, radius).expect("a design of the study");
            assert!((gear.removed_fraction() - 0.25).abs() < 5e-5);
        }
    }
}
