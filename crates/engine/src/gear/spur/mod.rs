//! A whole spur gear: drawing data, checked once (`checks`), and the true shape of its flanks (`flanks`).

mod checks;
mod flanks;
#[cfg(test)]
mod hobbed;

use std::f64::consts::PI;

use super::involute::involute_function;
use super::modification::Modification;
use super::rack::Trochoid;
use super::tip::BrokenEdge;
use super::{
    BlankRegion, GearData, GearError, Hole, HolePattern, Involute, Material, PlaneState, Rack,
    TipEdge, ToothDeviations, Vector,
};

/// A spur gear that can be made: not pointed, with its holes inside its blank.
///
/// Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct SpurGear {
    data: GearData,
    /// The rack as it is across its own teeth: round at its tips. Of a spur gear that of the drawing.
    normal_rack: Rack,
    flank: Involute,
    fillet: Trochoid,
    /// Where the flank ends and the fillet begins.
    form_roll_length: f64,
    /// The roll length at which the rack's straight flank ends, negative where it goes past the base circle.
    end_of_rack: f64,
    /// True if the rack, or its protuberance, undercuts the flank, so that the fillet begins at a corner.
    is_undercut: bool,
    broken_edge: Option<BrokenEdge>,
    modifications: Vec<Modification>,
    /// Roll lengths between which the flank is as the rack cuts it.
    untouched: [f64; 2],
    hole_repeats: u32,
}

impl SpurGear {
    /// Checks a drawing.
    ///
    /// # Errors
    ///
    /// [`GearError`] with the part that cannot be made and the value that would do.
    pub fn new(data: GearData) -> Result<Self, GearError> {
        let normal_rack = data.rack;
        Self::cut_by(normal_rack, data)
    }

    /// The transverse section of a gear that `normal_rack` cuts at an angle, with `data` as they are in that section.
    pub(in crate::gear) fn cut_by(normal_rack: Rack, data: GearData) -> Result<Self, GearError> {
        let rack = &data.rack;
        let (z, alpha) = (f64::from(data.tooth_count), rack.pressure_angle);
        let r = rack.module * z / 2.0;
        let psi_b = PI / (2.0 * z)
            + 2.0 * data.profile_shift * alpha.tan() / z
            + involute_function(alpha)
            + data.thickness_deviation / (2.0 * r);
        let shift = data.generating_profile_shift() * rack.module;
        let flank = Involute::new(r * alpha.cos(), psi_b);
        let whole = Trochoid::new(
            rack,
            &normal_rack,
            data.tooth_count,
            shift,
            data.thickness_of_flanks(),
        );
        let end_of_rack = r * alpha.sin() - (normal_rack.straight_depth() - shift) / alpha.sin();
        let is_undercut = end_of_rack < 0.0 || normal_rack.residual_undercut() > 0.0;
        let (fillet, form_roll_length) = if is_undercut {
            let fillet = whole.under(&flank, end_of_rack, rack.module, &normal_rack);
            let corner = fillet.point(fillet.ends().0);
            (fillet, flank.roll_length(corner.norm()))
        } else {
            (whole, end_of_rack)
        };
        let mut gear = Self {
            data,
            normal_rack,
            flank,
            fillet,
            form_roll_length,
            end_of_rack,
            is_undercut,
            broken_edge: None,
            modifications: Vec::new(),
            untouched: [0.0, f64::INFINITY],
            hole_repeats: 0,
        };

        gear.check_rack()?;
        gear.check_tooth()?;
        gear.broken_edge = gear.checked_edge()?;
        gear.check_blank()?;
        gear.hole_repeats = gear.data.blank.symmetry().count;
        gear.modifications = gear.checked_modifications()?;
        gear.untouched = gear.untouched_roll_lengths();
        gear.fits(&gear.data.deviations)?;
        gear.data.deviations = std::mem::take(&mut gear.data.deviations).without_zeros();
        Ok(gear)
    }

    /// The drawing.
    pub fn data(&self) -> &GearData {
        &self.data
    }

    /// The same teeth on a blank without bore and holes, for questions that do not concern the blank.
    pub fn without_blank(&self) -> Self {
        self.on_blank(BlankRegion::solid(0.0))
    }

    /// The same gear without holes.
    pub fn without_holes(&self) -> Self {
        self.on_blank(BlankRegion {
            holes: Vec::new(),
            ..self.data.blank.clone()
        })
    }

    /// The same section with its blank seen from the other side of the face.
    pub(in crate::gear) fn turned_over(&self) -> Self {
        self.on_blank(self.data.blank.turned_over())
    }

    /// The same gear with hole 0 at the angle 0.
    pub fn with_holes_unturned(&self) -> Self {
        self.on_blank(self.data.blank.turned(-self.hole_angle()))
    }

    /// The same gear with its blank turned by `angle` under the teeth, counter-clockwise.
    pub(in crate::gear) fn with_blank_turned(&self, angle: f64) -> Self {
        self.on_blank(self.data.blank.turned(angle))
    }

    /// The same gear with its blank seen in a mirror, tooth 0 being the tooth `first` of this gear.
    pub(in crate::gear) fn with_blank_mirrored(&self, first: usize) -> Self {
        let tooth = first as f64 * self.pitch_angle();
        self.on_blank(self.data.blank.mirrored().turned(tooth))
    }

    /// The same gear with flanks as the rack cuts them, each like the other, up to a sharp tip.
    pub fn with_plain_flanks(&self) -> Self {
        let plain = self.with_unmodified_flanks();
        Self {
            data: GearData {
                tip_edge: TipEdge::Sharp,
                ..plain.data
            },
            broken_edge: None,
            ..plain
        }
    }

    /// The same gear with flanks as the rack cuts them, each like the other, and the edge at the tip as it is.
    pub fn with_unmodified_flanks(&self) -> Self {
        Self {
            data: GearData {
                modifications: Vec::new(),
                deviations: ToothDeviations::default(),
                ..self.data.clone()
            },
            modifications: Vec::new(),
            ..self.clone()
        }
    }

    /// The same gear with teeth that do not deviate.
    pub fn as_drawn(&self) -> Self {
        self.with_deviations(ToothDeviations::default())
    }

    /// The same drawing with teeth whose other flanks are the loaded ones of this gear, seen in a mirror: tooth 0 is the tooth `first` of this gear.
    pub(in crate::gear) fn mirror_image(&self, first: usize) -> Self {
        let teeth = self.data.tooth_count as usize;
        self.with_deviations(self.data.deviations.mirrored(teeth, first))
    }

    fn with_deviations(&self, deviations: ToothDeviations) -> Self {
        Self {
            data: GearData {
                deviations,
                ..self.data.clone()
            },
            ..self.clone()
        }
    }

    /// A slice of the same flanks, one meter long, in a body that cannot yield along its axis: plane strain is plane stress with E/(1 − ν²).
    pub(in crate::gear) fn plane_strain(&self) -> Self {
        let plane = self.without_blank().as_drawn();
        let material = Material {
            youngs_modulus: plane.data.material.plane_modulus(PlaneState::Strain),
            ..plane.data.material
        };
        Self {
            data: GearData {
                face_width: 1.0,
                material,
                ..plane.data
            },
            ..plane
        }
    }

    /// The same gear on a `blank` that is known to fit.
    fn on_blank(&self, blank: BlankRegion) -> Self {
        Self {
            hole_repeats: blank.symmetry().count,
            data: GearData {
                blank,
                ..self.data.clone()
            },
            ..self.clone()
        }
    }

    /// The rack across its own teeth: of a spur gear that of the drawing.
    pub(crate) fn normal_rack(&self) -> &Rack {
        &self.normal_rack
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

    /// The bore radius, or that of the shaft.
    pub fn bore_radius(&self) -> f64 {
        self.data.blank.bore_radius
    }

    /// The holes of the blank.
    pub fn holes(&self) -> &[Hole] {
        &self.data.blank.holes
    }

    /// True if it has holes.
    pub fn has_holes(&self) -> bool {
        !self.holes().is_empty()
    }

    /// The holes as one pattern of equal round ones, if they are such.
    pub fn hole_pattern(&self) -> Option<HolePattern> {
        self.data.blank.pattern()
    }

    /// The angle of hole 0 from the centerline of tooth 0; 0 without holes.
    pub fn hole_angle(&self) -> f64 {
        self.holes().first().map_or(0.0, |hole| hole.angle)
    }

    /// How often the holes repeat around the blank: N of a pattern; 0 without holes.
    pub fn hole_repeats(&self) -> u32 {
        self.hole_repeats
    }

    /// The loaded flank of tooth 0.
    pub fn flank(&self) -> &Involute {
        &self.flank
    }

    /// The fillet of tooth 0 on its loaded side.
    pub fn fillet(&self) -> Trochoid {
        self.fillet
    }

    /// True if the rack, or its protuberance, undercuts the flank: it ends in a corner, at which the fillet cuts the involute.
    pub fn is_undercut(&self) -> bool {
        self.is_undercut
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

    /// The root radius r_f = r − h_f + x_E m.
    pub fn root_radius(&self) -> f64 {
        self.reference_radius() - self.data.rack.dedendum + self.generating_shift_length()
    }

    /// The generating profile shift x_E, at which the tool stood that cut the root, in modules of this section.
    pub fn generating_profile_shift(&self) -> f64 {
        self.data.generating_profile_shift()
    }

    /// x_E as a length, the same in every section.
    pub fn generating_shift_length(&self) -> f64 {
        self.generating_profile_shift() * self.data.rack.module
    }

    /// The base pitch p_b = π m cos α.
    pub fn base_pitch(&self) -> f64 {
        PI * self.data.rack.module * self.data.rack.pressure_angle.cos()
    }

    /// The roll length at which the generated flank ends and the fillet begins.
    pub fn form_roll_length(&self) -> f64 {
        self.form_roll_length
    }

    /// The form radius: where the flank ends and the fillet begins.
    pub fn form_radius(&self) -> f64 {
        self.flank.radius(self.form_roll_length())
    }

    /// The roll length at the tip circle.
    pub fn tip_roll_length(&self) -> f64 {
        self.flank.roll_length(self.tip_radius())
    }

    /// The roll length s_Fa at which the involute ends: at the tip circle, or at a broken edge.
    pub fn tip_form_roll_length(&self) -> f64 {
        self.broken_edge
            .map_or_else(|| self.tip_roll_length(), |edge| edge.from)
    }

    /// Half the angle of the tip land between both edges.
    pub fn tip_half_angle(&self) -> f64 {
        self.broken_edge.map_or_else(
            || self.flank.half_angle(self.tip_radius()),
            |edge| edge.half_angle(),
        )
    }

    /// The point of the broken edge of tooth 0 at the part `t` of the way from the tip circle down to the flank; `None` of a sharp one.
    pub fn edge_point(&self, t: f64) -> Option<Vector> {
        self.broken_edge.map(|edge| edge.point(&self.flank, t).0)
    }

    /// The edge between flank and tip circle, if it is broken.
    pub(super) fn broken_edge(&self) -> Option<&BrokenEdge> {
        self.broken_edge.as_ref()
    }

    /// The thickness of the tooth along its tip circle, were its edges sharp.
    pub fn tip_thickness(&self) -> f64 {
        let r_a = self.tip_radius();
        2.0 * r_a * self.flank.half_angle(r_a)
    }

    /// The thinnest material around the holes: between them, above them and below them. `None` without holes.
    pub fn least_ligament(&self) -> Option<f64> {
        let blank = &self.data.blank;
        let least = blank.least_ligament(self.root_radius());
        least.map(|(_, ligament)| ligament)
    }

    /// The share of the blank that the holes remove; the blank is the ring between the bore, or the axis of a shaft, and the mean of tip and root
    /// circle.
    pub fn removed_fraction(&self) -> f64 {
        self.data.blank.hole_area() / self.nominal_blank_area()
    }

    /// The area π (((r_a + r_f)/2)² − r_bore²) to which removed mass is referred.
    pub fn nominal_blank_area(&self) -> f64 {
        let mean = f64::midpoint(self.tip_radius(), self.root_radius());
        PI * (mean.powi(2) - self.data.blank.open_radius().powi(2))
    }

    pub(in crate::gear) fn profile_shift_length(&self) -> f64 {
        self.data.profile_shift * self.data.rack.module
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::gear::{ModificationData, ReliefData, ReliefShape, ReliefStart};

    /// The paper's gears (Table 1): module 2 mm, 20 degrees, addendum 2 mm, dedendum 2.5 mm, width 20 mm, steel.
    pub(crate) fn paper_gear(tooth_count: u32) -> GearData {
        GearData::plain(tooth_count, 2e-3, 15e-3)
    }

    fn with_holes(count: u32, circle_radius: f64, radius: f64) -> Result<SpurGear, GearError> {
        let mut data = paper_gear(50);
        data.blank.holes = HolePattern {
            count,
            circle_radius,
            radius,
            phase: 0.0,
        }
        .holes();
        SpurGear::new(data)
    }

    #[test]
    fn the_form_radius_is_the_one_of_the_independent_solver() {
        // calculix-s1.json: r_form = 48.31354660697083 mm.
        let gear = SpurGear::new(paper_gear(50)).expect("the standard gear");
        assert!((gear.form_radius() - 48.313_546_606_970_83e-3).abs() < 1e-12);
    }

    fn of_module(tooth_count: u32, profile_shift: f64) -> GearData {
        let mut data = paper_gear(tooth_count);
        data.rack = Rack::profile_a(1e-3);
        data.profile_shift = profile_shift;
        data.blank.bore_radius = 0.5e-3;
        data
    }

    #[test]
    fn undercut_begins_below_the_textbook_tooth_count_and_at_the_base_circle() {
        // z_min = 2 h_Ff/(m sin² α) = 17.1 for the ISO rack with rounding 0.38 m, whose straight depth is one module.
        let gear = |z, x| SpurGear::new(of_module(z, x)).expect("can be made");
        assert!(!gear(18, 0.0).is_undercut() && gear(17, 0.0).is_undercut());
        // 17 sin²(20 deg)/2 = 0.994308, and the rack's straight depth is 0.999968.
        assert!(gear(17, 0.00565).is_undercut() && !gear(17, 0.00567).is_undercut());
        // The rack's flank ends 0.01654 mm beyond the base circle. A small fold of an envelope cuts itself half as far before it.
        let barely = gear(17, 0.0);
        assert!((barely.form_roll_length() - 0.008_27e-3).abs() < 1e-7);
    }

    #[test]
    fn an_undercut_flank_ends_where_the_swept_rounding_of_the_rack_cuts_the_involute() {
        // 10 teeth of module 1, by a polygon of the swept rack: a radius of 4.7256 mm.
        let gear = SpurGear::new(of_module(10, 0.0)).expect("can be made");
        assert!((gear.form_radius() - 4.7256e-3).abs() < 1e-7);
        let corner = gear.fillet().point(gear.fillet().ends().0);
        assert!((corner - gear.flank().point(gear.form_roll_length())).norm() < 1e-15);
        // Just below the corner the flank as it is cut is the fillet, which falls away from the involute.
        for part in [0.2, 0.5, 0.9] {
            let s = part * gear.form_roll_length();
            let depth = gear.removed(s);
            let (r, t) = (gear.flank().radius(s), gear.flank().base_radius());
            let on_fillet = gear.flank().half_angle(r) - depth / t;
            let point = gear.fillet().point(gear.fillet().gamma_at(r));
            assert!(depth > 0.0 && (point - r * crate::gear::radial(on_fillet)).norm() < 1e-12);
            let step = 1e-9;
            let slope = (gear.removed(s + step) - gear.removed(s - step)) / (2.0 * step);
            assert!((gear.removed_slope(s) - slope).abs() < 1e-5 * slope.abs());
        }
    }

    #[test]
    fn a_tooth_of_which_undercut_leaves_nothing_is_refused_and_the_named_shift_cures_it() {
        let mut data = of_module(5, -0.6);
        data.rack.addendum = 1.7e-3;
        let Err(GearError::Undercut { smallest, .. }) = SpurGear::new(data.clone()) else {
            panic!("the fillets meet")
        };
        data.profile_shift = smallest + 1e-9;
        data.rack.addendum = 0.5e-3;
        assert!(SpurGear::new(data).is_ok_and(|gear| !gear.is_undercut()));
    }

    #[test]
    fn a_pointed_tooth_is_refused_and_the_named_addendum_cures_it() {
        let mut data = paper_gear(30);
        data.rack.addendum = 4e-3;
        let Err(GearError::PointedTip {
            largest_addendum, ..
        }) = SpurGear::new(data.clone())
        else {
            panic!("pointed")
        };
        data.rack.addendum = largest_addendum;
        assert!(SpurGear::new(data).is_ok());
    }

    #[test]
    fn holes_are_refused_where_they_touch_and_the_named_radius_cures_each() {
        // Touching limits R sin(π/N) , less half the least ligament.
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
        let relief = |length| {
            ModificationData::TipRelief(ReliefData {
                amount: 5e-6,
                shape: ReliefShape::Linear,
                start: ReliefStart::RadialLength(length),
            })
        };
        data.modifications = vec![relief(3.7e-3)];
        assert!(matches!(
            SpurGear::new(data.clone()),
            Err(GearError::ReliefTooLong { .. })
        ));
        data.modifications = vec![relief(1.75e-3)];
        let gear = SpurGear::new(data).expect("fits");
        assert!((gear.removed(gear.tip_roll_length()) - 5e-6).abs() < 1e-18);
    }

    #[test]
    fn a_quarter_of_the_blank_goes_with_the_papers_hole_radii() {
        // Bore 15 mm and 25 % give r = 7.500 (10 holes), 8.385 (8), 9.683 (6) mm.
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
