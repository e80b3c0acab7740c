//! Geometry of the pair, which follows from the submission without any load.

use meshwright_engine::analysis::Case;
use meshwright_engine::analysis::RotationSpeed;
use meshwright_engine::gear::{GearPair, Member, SolidGear, SolidPair};

use super::declare::document;
use super::units::{not_a_number, to_mm};

document! {
    /// The derived geometry of a pair.
    pub struct PairGeometry as PairGeometry, "Pair geometry" answer of (case: &Case) with {
        let pair = &case.pair;
        let faces = case.faces().map(|faces| &faces.pair);
        let rack = &pair.driving().data().rack;
        let width = faces.map_or(pair.common_face_width(), SolidPair::common_face_width);
        let normal = faces.map_or(1.0, |pair| pair.base_helix_angle().cos());
    } {
        /// The operating center distance a, in mm.
        center_distance_mm: f64 = to_mm(pair.center_distance()),
        /// The working pressure angle, in degrees: its cosine is the base radii together over the center distance.
        working_pressure_angle_deg: f64 = pair.working_pressure_angle().to_degrees(),
        /// The contact ratio: the length of the path of contact over the base pitch.
        contact_ratio: f64 = pair.contact_ratio(),
        /// The base pitch, in mm.
        base_pitch_mm: f64 = to_mm(pair.base_pitch()),
        /// The number of mesh periods after which the contact repeats.
        period_mesh_periods: u32 = pair.period(),
        /// The normal backlash j_bn of ISO 21771, in mm, of teeth as drawn: across the flanks in the normal section. Straight teeth have it along the line of
        /// action.
        backlash_mm: f64 = to_mm(pair.backlash() * normal),
        /// The circumferential backlash j_wt of ISO 21771, in mm, of teeth as drawn: in the transverse section, along the working pitch circles. It is the
        /// backlash along the line of action over the cosine of the working pressure angle.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        backlash_transverse_mm: f64 = to_mm(pair.backlash() / pair.working_pressure_angle().cos()),
        /// The backlash along the line of action in the transverse section, in mm, of teeth as drawn: the normal one over the cosine of the helix angle at the base
        /// circles. Force tables have it so.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        backlash_line_of_action_mm: f64 = to_mm(pair.backlash()),
        /// The least normal backlash over the true period, in mm: after the pitch deviations of teeth in mesh at the same time, slopes that stand out and
        /// eccentricity.
        least_backlash_mm: f64 = to_mm(pair.least_backlash() * normal),
        /// The face width on which the gears touch, in mm: the smaller of the two.
        contact_width_mm: f64 = to_mm(width),
        /// The helix angle at the base circles, in degrees, without a sign; absent, as the following fields, for plane methods. With a helix all other values
        /// of the pair are those of its transverse section.
        helix_angle_base_deg?: f64 = faces.map(|pair| pair.base_helix_angle().to_degrees()),
        /// The overlap ratio: the common face over the axial pitch.
        overlap_ratio?: f64 = faces.map(SolidPair::overlap_ratio),
        /// The total contact ratio: the transverse contact ratio and the overlap ratio together.
        total_contact_ratio?: f64 = faces.map(SolidPair::total_contact_ratio),
        /// The transverse module, in mm.
        transverse_module_mm?: f64 = faces.map(|_| to_mm(rack.module)),
        /// The pressure angle in the transverse section at the reference circle, in degrees.
        transverse_pressure_angle_deg?: f64 = faces.map(|_| rack.pressure_angle.to_degrees()),
        /// The path of contact along the theoretical line of action.
        path_of_contact: PathOfContact = PathOfContact::of(pair),
        /// Gear 1, which drives.
        driving: GearGeometry = GearGeometry::of(case, Member::Driving),
        /// Gear 2, which is driven.
        driven: GearGeometry = GearGeometry::of(case, Member::Driven),
    }
}

document! {
    /// The path of contact along the theoretical line of action, from the first touch of a pair of teeth to the last.
    pub struct PathOfContact as PathOfContact, "Path of contact" answer of (pair: &GearPair) with {
        let (s_a, s_e) = pair.path_of_contact();
        let p_b = pair.base_pitch();
        let point = |s| PathPoint::of(pair, s);
    } {
        /// Its length, in mm.
        length_mm: f64 = to_mm(s_e - s_a),
        /// A: a pair comes into contact, at the tip of the driven tooth.
        #[serde(alias = "a")]
        point_a: PathPoint = point(s_a),
        /// B: the pair before it leaves contact, one base pitch before E.
        #[serde(alias = "b")]
        point_b: PathPoint = point(s_e - p_b),
        /// C: the pitch point.
        #[serde(alias = "c")]
        point_c: PathPoint = point(pair.pitch_roll_length()),
        /// D: the next pair comes into contact, one base pitch after A.
        #[serde(alias = "d")]
        point_d: PathPoint = point(s_a + p_b),
        /// E: the pair leaves contact, at the tip of the driving tooth.
        #[serde(alias = "e")]
        point_e: PathPoint = point(s_e),
    }
}

document! {
    /// A point of the path of contact.
    pub struct PathPoint as PathPoint, "Point of the path of contact"
    answer of (pair: &GearPair, s: f64) {
        /// The mesh position of the reference pair there, in mesh periods; zero at the pitch point.
        mesh_position: f64 = (s - pair.pitch_roll_length()) / pair.base_pitch(),
        /// The roll length on the driving flank, in mm.
        driving_roll_length_mm: f64 = to_mm(s),
        /// The roll length on the driven flank, in mm.
        driven_roll_length_mm: f64 = to_mm(pair.line_of_action() - s),
    }
}

document! {
    /// The derived geometry of a gear.
    pub struct GearGeometry as GearGeometry, "Gear geometry"
    answer of (case: &Case, member: Member) with {
        let (pair, gear) = (&case.pair, case.pair.gear(member));
        let solid = case.faces().map(|faces| faces.pair.gear(member));
        // A remainder of rounding, of holes that balance each other, has no direction.
        let noise = 1e-12 * gear.mass() * gear.tip_radius();
        let normal = solid.map_or(1.0, |solid| solid.helix_angle_at(gear.tip_radius()).cos());
        let module = solid.map_or(gear.data().rack.module, |solid| solid.normal_rack().module);
        let [sliding_a, sliding_e] = pair.specific_sliding(member);
        let imbalance = Some(gear.imbalance()).filter(|imbalance| imbalance.norm() > noise);
    } {
        /// The number of mesh periods after which this gear stands alike again: 1 for a solid blank, fewer than its teeth for holes that
        /// repeat, all of its teeth where they deviate.
        period_mesh_periods: u32 = pair.period_of(member),
        /// The generating profile shift x_E, in normal modules, at which the tool stood that cut the root: root circle, fillet and form circle follow from it. It is the
        /// profile shift x of teeth of nominal thickness.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        generating_profile_shift: f64 = gear.generating_shift_length() / module,
        /// The reference radius, in mm.
        reference_radius_mm: f64 = to_mm(gear.reference_radius()),
        /// The base radius, in mm.
        base_radius_mm: f64 = to_mm(gear.base_radius()),
        /// The tip radius, in mm.
        tip_radius_mm: f64 = to_mm(gear.tip_radius()),
        /// The root radius, in mm.
        root_radius_mm: f64 = to_mm(gear.root_radius()),
        /// The form radius, in mm, where the involute ends and the fillet begins.
        form_radius_mm: f64 = to_mm(gear.form_radius()),
        /// The radius at which the involute ends, in mm: the tip radius, or less where the tip edge is broken.
        tip_form_radius_mm: f64 = to_mm(gear.flank().radius(gear.tip_form_roll_length())),
        /// The working pitch radius, in mm.
        working_pitch_radius_mm: f64 = to_mm(pair.working_radius(member)),
        /// The form diameter, in mm: where the involute ends and the fillet begins.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        form_diameter_mm: f64 = to_mm(2.0 * gear.form_radius()),
        /// The diameter at which the active profile begins, in mm: the lowest that the tip of the mate reaches.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        active_root_diameter_mm: f64 = to_mm(2.0 * pair.active_root_radius(member)),
        /// The working pitch diameter, in mm.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        working_pitch_diameter_mm: f64 = to_mm(2.0 * pair.working_radius(member)),
        /// The thickness s_an of a tooth on its tip circle in the normal section (ISO 21771), in mm.
        tip_thickness_mm: f64 = to_mm(gear.tip_thickness() * normal),
        /// The same in the transverse section, along the tip circle, in mm.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        tip_thickness_transverse_mm: f64 = to_mm(gear.tip_thickness()),
        /// The tip clearance, in mm: from the tip circle of this gear to the root circle of the other one.
        #[serde(default = "not_a_number")]
        #[schema(required)]
        tip_clearance_mm: f64 = to_mm(pair.tip_clearance(member)),
        /// The specific sliding of this flank at A, where a pair of teeth comes into contact: the sliding velocity over the velocity at which the
        /// contact runs along the flank. Absent where it has no bound, on the base circle.
        specific_sliding_a?: f64 = sliding_a,
        /// The specific sliding of this flank at E, where a pair leaves contact; absent where it has no bound.
        specific_sliding_e?: f64 = sliding_e,
        /// The radius at which the tip relief starts, in mm; absent without relief.
        relief_start_radius_mm?: f64 = gear.tip_relief().map(|relief| to_mm(relief.start_radius())),
        /// The least material around the holes, in mm; absent without holes.
        least_ligament_mm?: f64 = gear.least_ligament().map(to_mm),
        /// The mass of the true profile, in kg.
        mass_kg: f64 = solid.map_or(gear.mass(), SolidGear::mass),
        /// The share of the blank that the holes remove, in percent. The blank is the ring between the bore and the mean of
        /// tip and root circle.
        mass_removed_percent: f64 = 100.0 * gear.removed_fraction(),
        /// The polar moment of inertia of the true profile, in kg m2.
        polar_inertia_kg_m2: f64 = solid.map_or(gear.polar_inertia(), SolidGear::polar_inertia),
        /// The imbalance, in kg mm: mass times the distance of its center from the axis of rotation.
        imbalance_kg_mm: f64 = to_mm(imbalance.map_or(0.0, |imbalance| imbalance.norm())),
        /// The direction of the center of mass from the axis of rotation, in degrees from the centerline of tooth 0, positive towards its
        /// loaded flank; absent without imbalance.
        imbalance_angle_deg?: f64 =
            imbalance.map(|imbalance| imbalance.y.atan2(imbalance.x).to_degrees()),
    }
}

document! {
    /// The frequencies of eq. 2 at the speed given.
    pub struct Frequencies as Frequencies, "Frequencies"
    answer of (pair: &GearPair, speed: RotationSpeed) with {
        let teeth = |member| f64::from(pair.gear(member).tooth_count());
        let mesh_hz = speed.0 * teeth(Member::Driving);
    } {
        /// f_m: the mesh frequency, in Hz.
        mesh_hz: f64 = mesh_hz,
        /// f_1: the rotation of the driving gear, in Hz.
        driving_hz: f64 = speed.0,
        /// f_2: the rotation of the driven gear, in Hz.
        driven_hz: f64 = mesh_hz / teeth(Member::Driven),
        /// f_0: the true period of the contact, in Hz.
        period_hz: f64 = mesh_hz / f64::from(pair.period()),
    }
}

impl Frequencies {
    /// The speeds of `case`, if it has one.
    pub(super) fn of_case(case: &Case) -> Option<Self> {
        Some(Self::of(&case.pair, case.driving_speed?))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::testing::{example, parse, submission, with};

    fn geometry(name: &str) -> PairGeometry {
        PairGeometry::of(submission(name).case())
    }

    #[test]
    fn the_standard_pair_has_the_geometry_of_its_closed_form() {
        // By the closed forms of ISO 21771: alpha_w 20.76902 deg, epsilon 1.51155, s_A, s_C, s_E 13.3564, 17.8187, 22.2810, j 0.34836 mm.
        let pair = geometry("standard-pair");
        let path = &pair.path_of_contact;
        for (value, printed, half_digit) in [
            (pair.working_pressure_angle_deg, 20.769_02, 6e-6),
            (pair.contact_ratio, 1.511_55, 6e-6),
            (pair.backlash_mm, 0.348_36, 6e-6),
            (path.point_a.driving_roll_length_mm, 13.3564, 6e-5),
            (path.point_c.driving_roll_length_mm, 17.8187, 6e-5),
            (path.point_e.driving_roll_length_mm, 22.2810, 6e-5),
            (pair.driving.tip_radius_mm, 52.0, 1e-12),
            (pair.driving.root_radius_mm, 47.5, 1e-12),
            (pair.driving.working_pitch_radius_mm, 50.25, 1e-12),
        ] {
            assert!((value - printed).abs() <= half_digit, "{value} {printed}");
        }
        assert_eq!(pair.driving.least_ligament_mm, None);
    }

    #[test]
    fn what_rounding_leaves_of_balanced_holes_is_no_imbalance() {
        for name in [
            "test-case-1",
            "test-case-2",
            "interface-radii",
            "slots",
            "web",
        ] {
            let driven = geometry(name).driven;
            let imbalance = (driven.imbalance_kg_mm, driven.imbalance_angle_deg);
            assert_eq!(imbalance, (0.0, None), "{name}");
        }
        let unequal = geometry("unequal-holes").driven;
        assert!(unequal.imbalance_kg_mm > 0.1 && unequal.imbalance_angle_deg.is_some());
    }

    #[test]
    fn an_eccentric_gear_is_out_of_balance_by_its_mass_times_its_eccentricity() {
        let balanced = geometry("standard-pair");
        assert_eq!(balanced.driven.imbalance_kg_mm, 0.0);
        assert_eq!(balanced.driven.imbalance_angle_deg, None);
        let eccentric = geometry("eccentricity");
        let driven = &eccentric.driven;
        // 20 um at 30 degrees, as the example says.
        assert!((driven.imbalance_kg_mm / (driven.mass_kg * 0.02) - 1.0).abs() < 1e-12);
        let angle = driven.imbalance_angle_deg.expect("an angle");
        assert!((angle - 30.0).abs() < 1e-9, "{angle}");
        assert_eq!(
            (
                driven.period_mesh_periods,
                eccentric.driving.period_mesh_periods
            ),
            (50, 1)
        );
        assert_eq!(eccentric.period_mesh_periods, 50);
        // Nearer by e, both flanks close up by e sin alpha_w.
        let taken = 2.0 * 0.02 * eccentric.working_pressure_angle_deg.to_radians().sin();
        assert!((eccentric.backlash_mm - eccentric.least_backlash_mm - taken).abs() < 1e-12);
    }

    #[test]
    fn the_least_ligament_of_case_1_is_the_one_between_its_holes() {
        // 2 R sin(pi/8) - 2 r = 63 x 0.382683 - 20 = 4.1090 mm; 6 mm to the root circle, 5.5 mm to the bore.
        let ligament = geometry("test-case-1")
            .driven
            .least_ligament_mm
            .expect("holes");
        assert!((ligament - 4.109_06).abs() < 1e-5, "{ligament}");
    }

    #[test]
    fn a_hub_weighs_what_it_is_wider_than_the_face() {
        // The driven gear of the example: bore 20 mm, hub to 30 mm, 24 mm wide on a face of 20 mm.
        let hub = geometry("helical-pair").driven;
        let width = ("/pair/driven/blank/hub/width_mm", 20.into());
        let submission = parse(&with(example("helical-pair"), &[width])).expect("valid");
        let plain = PairGeometry::of(submission.case()).driven;
        let mass = 7850.0 * PI * (0.03_f64.powi(2) - 0.02_f64.powi(2)) * 4e-3;
        assert!((hub.mass_kg - plain.mass_kg - mass).abs() < 1e-12);
        let inertia = 7850.0 * PI / 2.0 * (0.03_f64.powi(4) - 0.02_f64.powi(4)) * 4e-3;
        assert!((hub.polar_inertia_kg_m2 - plain.polar_inertia_kg_m2 - inertia).abs() < 1e-15);
    }
}
