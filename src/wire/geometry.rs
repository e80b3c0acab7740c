//! The pair as its drawing makes it: what follows from the submission without any load.

use meshwright_engine::analysis::Case;
use meshwright_engine::gear::{GearPair, Member, SolidPair};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::units::{to_mm, untold};

/// The derived geometry of a pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Pair geometry")]
pub struct PairGeometry {
    /// The operating center distance a, in mm.
    pub center_distance_mm: f64,
    /// The working pressure angle, in degrees: its cosine is the base radii together over the center distance.
    pub working_pressure_angle_deg: f64,
    /// The contact ratio: the length of the path of contact over the base pitch.
    pub contact_ratio: f64,
    /// The base pitch, in mm.
    pub base_pitch_mm: f64,
    /// The number of mesh periods after which the contact repeats.
    pub period_mesh_periods: u32,
    /// The normal backlash, along the line of action, in mm, of teeth as drawn.
    pub backlash_mm: f64,
    /// The least normal backlash, in mm: what pitch and slope deviations that stand out and eccentricity leave of it.
    pub least_backlash_mm: f64,
    /// The face width on which the gears touch, in mm: the smaller of the two.
    pub contact_width_mm: f64,
    /// The helix angle at the base circles, in degrees, without a sign; absent, as what follows, for plane methods. With a helix all other values of the
    /// pair are those of its transverse section.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub helix_angle_base_deg: Option<f64>,
    /// The overlap ratio: the common face over the axial pitch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlap_ratio: Option<f64>,
    /// The total contact ratio: the transverse contact ratio and the overlap ratio together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub total_contact_ratio: Option<f64>,
    /// The transverse module, in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transverse_module_mm: Option<f64>,
    /// The pressure angle in the transverse section at the reference circle, in degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transverse_pressure_angle_deg: Option<f64>,
    /// The path of contact along the theoretical line of action.
    pub path_of_contact: PathOfContact,
    /// Gear 1, which drives.
    pub driving: GearGeometry,
    /// Gear 2, which is driven.
    pub driven: GearGeometry,
}

/// The path of contact along the theoretical line of action, from the first touch of a pair of teeth to the last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Path of contact")]
pub struct PathOfContact {
    /// Its length, in mm.
    pub length_mm: f64,
    /// A: a pair comes into contact, at the tip of the driven tooth.
    #[serde(alias = "a")]
    pub point_a: PathPoint,
    /// B: the pair before it leaves contact, one base pitch before E.
    #[serde(alias = "b")]
    pub point_b: PathPoint,
    /// C: the pitch point.
    #[serde(alias = "c")]
    pub point_c: PathPoint,
    /// D: the next pair comes into contact, one base pitch after A.
    #[serde(alias = "d")]
    pub point_d: PathPoint,
    /// E: the pair leaves contact, at the tip of the driving tooth.
    #[serde(alias = "e")]
    pub point_e: PathPoint,
}

/// A point of the path of contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Point of the path of contact")]
pub struct PathPoint {
    /// The mesh position of the reference pair there, in mesh periods; zero at the pitch point.
    pub mesh_position: f64,
    /// The roll length on the driving flank, in mm.
    pub driving_roll_length_mm: f64,
    /// The roll length on the driven flank, in mm.
    pub driven_roll_length_mm: f64,
}

/// The derived geometry of a gear.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Gear geometry")]
pub struct GearGeometry {
    /// The number of mesh periods after which this gear stands alike again: 1 for a solid blank, fewer than its teeth for holes that
    /// repeat, all of its teeth where they deviate.
    pub period_mesh_periods: u32,
    /// The reference radius, in mm.
    pub reference_radius_mm: f64,
    /// The base radius, in mm.
    pub base_radius_mm: f64,
    /// The tip radius, in mm.
    pub tip_radius_mm: f64,
    /// The root radius, in mm.
    pub root_radius_mm: f64,
    /// The form radius, in mm, where the involute ends and the fillet begins.
    pub form_radius_mm: f64,
    /// The radius at which the involute ends, in mm: the tip radius, or less where the tip edge is broken.
    pub tip_form_radius_mm: f64,
    /// The working pitch radius, in mm.
    pub working_pitch_radius_mm: f64,
    /// The form diameter, in mm: where the involute ends and the fillet begins.
    #[serde(default = "untold")]
    #[schema(required)]
    pub form_diameter_mm: f64,
    /// The diameter at which the active profile begins, in mm: the lowest that the tip of the mate reaches.
    #[serde(default = "untold")]
    #[schema(required)]
    pub active_root_diameter_mm: f64,
    /// The working pitch diameter, in mm.
    #[serde(default = "untold")]
    #[schema(required)]
    pub working_pitch_diameter_mm: f64,
    /// The thickness of a tooth along its tip circle, in mm.
    pub tip_thickness_mm: f64,
    /// The specific sliding of this flank at A, where a pair of teeth comes into contact: the sliding velocity over the velocity at which the
    /// contact runs along the flank. Absent where it has no bound, on the base circle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specific_sliding_a: Option<f64>,
    /// The specific sliding of this flank at E, where a pair leaves contact; absent where it has no bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specific_sliding_e: Option<f64>,
    /// The radius at which the tip relief starts, in mm; absent without relief.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relief_start_radius_mm: Option<f64>,
    /// The least material around the holes, in mm; absent without holes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_ligament_mm: Option<f64>,
    /// The mass of the true profile, in kg.
    pub mass_kg: f64,
    /// The share of the blank that the holes remove, in percent. The blank is the ring between the bore and the mean of
    /// tip and root circle.
    pub mass_removed_percent: f64,
    /// The polar moment of inertia of the true profile, in kg m2.
    pub polar_inertia_kg_m2: f64,
    /// The imbalance, in kg mm: mass times the distance of its center from the axis of rotation.
    pub imbalance_kg_mm: f64,
    /// The direction of the center of mass from the axis of rotation, in degrees from the centerline of tooth 0, positive towards its
    /// loaded flank; absent without imbalance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imbalance_angle_deg: Option<f64>,
}

/// The frequencies of eq. 2 at the speed given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Frequencies")]
pub struct Frequencies {
    /// f_m: the mesh frequency, in Hz.
    pub mesh_hz: f64,
    /// f_1: the rotation of the driving gear, in Hz.
    pub driving_hz: f64,
    /// f_2: the rotation of the driven gear, in Hz.
    pub driven_hz: f64,
    /// f_0: the true period of the contact, in Hz.
    pub period_hz: f64,
}

impl PairGeometry {
    /// What follows for the pair of `case`.
    pub fn of(case: &Case) -> Self {
        let pair = &case.pair;
        let faces = case.faces.as_ref().map(|faces| &faces.pair);
        let rack = &pair.driving().data().rack;
        let width = faces.map_or(pair.common_face_width(), SolidPair::common_face_width);
        Self {
            center_distance_mm: to_mm(pair.center_distance()),
            working_pressure_angle_deg: pair.working_pressure_angle().to_degrees(),
            contact_ratio: pair.contact_ratio(),
            base_pitch_mm: to_mm(pair.base_pitch()),
            period_mesh_periods: pair.period(),
            backlash_mm: to_mm(pair.backlash()),
            least_backlash_mm: to_mm(pair.least_backlash()),
            contact_width_mm: to_mm(width),
            helix_angle_base_deg: faces.map(|pair| pair.base_helix_angle().to_degrees()),
            overlap_ratio: faces.map(SolidPair::overlap_ratio),
            total_contact_ratio: faces.map(SolidPair::total_contact_ratio),
            transverse_module_mm: faces.map(|_| to_mm(rack.module)),
            transverse_pressure_angle_deg: faces.map(|_| rack.pressure_angle.to_degrees()),
            path_of_contact: PathOfContact::of(pair),
            driving: GearGeometry::of_case(case, Member::Driving),
            driven: GearGeometry::of_case(case, Member::Driven),
        }
    }
}

impl PathOfContact {
    pub(super) fn of(pair: &GearPair) -> Self {
        let (s_a, s_e) = pair.path_of_contact();
        let (s_c, p_b) = (pair.pitch_roll_length(), pair.base_pitch());
        let point = |s: f64| PathPoint {
            mesh_position: (s - s_c) / p_b,
            driving_roll_length_mm: to_mm(s),
            driven_roll_length_mm: to_mm(pair.line_of_action() - s),
        };
        Self {
            length_mm: to_mm(s_e - s_a),
            point_a: point(s_a),
            point_b: point(s_e - p_b),
            point_c: point(s_c),
            point_d: point(s_a + p_b),
            point_e: point(s_e),
        }
    }
}

impl GearGeometry {
    fn of_case(case: &Case, member: Member) -> Self {
        let gear = Self::of(&case.pair, member);
        match &case.faces {
            None => gear,
            Some(faces) => {
                let solid = faces.pair.gear(member);
                Self {
                    mass_kg: solid.mass(),
                    polar_inertia_kg_m2: solid.polar_inertia(),
                    ..gear
                }
            }
        }
    }

    fn of(pair: &GearPair, member: Member) -> Self {
        let gear = pair.gear(member);
        // What rounding leaves of holes that balance each other has no direction.
        let noise = 1e-12 * gear.mass() * gear.tip_radius();
        let [specific_sliding_a, specific_sliding_e] = pair.specific_sliding(member);
        let imbalance = Some(gear.imbalance()).filter(|imbalance| imbalance.norm() > noise);
        Self {
            period_mesh_periods: pair.period_of(member),
            reference_radius_mm: to_mm(gear.reference_radius()),
            base_radius_mm: to_mm(gear.base_radius()),
            tip_radius_mm: to_mm(gear.tip_radius()),
            root_radius_mm: to_mm(gear.root_radius()),
            form_radius_mm: to_mm(gear.form_radius()),
            tip_form_radius_mm: to_mm(gear.flank().radius(gear.tip_form_roll_length())),
            working_pitch_radius_mm: to_mm(pair.working_radius(member)),
            form_diameter_mm: to_mm(2.0 * gear.form_radius()),
            active_root_diameter_mm: to_mm(2.0 * pair.active_root_radius(member)),
            working_pitch_diameter_mm: to_mm(2.0 * pair.working_radius(member)),
            tip_thickness_mm: to_mm(gear.tip_thickness()),
            specific_sliding_a,
            specific_sliding_e,
            relief_start_radius_mm: gear.tip_relief().map(|relief| to_mm(relief.start_radius())),
            least_ligament_mm: gear.least_ligament().map(to_mm),
            mass_kg: gear.mass(),
            mass_removed_percent: 100.0 * gear.removed_fraction(),
            polar_inertia_kg_m2: gear.polar_inertia(),
            imbalance_kg_mm: to_mm(imbalance.map_or(0.0, |imbalance| imbalance.norm())),
            imbalance_angle_deg: imbalance
                .map(|imbalance| imbalance.y.atan2(imbalance.x).to_degrees()),
        }
    }
}

impl Frequencies {
    /// Those of `case`, if it has a speed.
    pub fn of(case: &Case) -> Option<Self> {
        let driving_hz = case.driving_speed?.0;
        let mesh_hz = driving_hz * f64::from(case.pair.driving().tooth_count());
        Some(Self {
            mesh_hz,
            driving_hz,
            driven_hz: mesh_hz / f64::from(case.pair.driven().tooth_count()),
            period_hz: mesh_hz / f64::from(case.pair.period()),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::wire::{Submission, examples};

    fn geometry(name: &str) -> PairGeometry {
        let example = examples()
            .iter()
            .find(|example| example.name == name)
            .expect("ships");
        PairGeometry::of(
            Submission::parse(example.json.as_bytes())
                .expect("valid")
                .case(),
        )
    }

    #[test]
    fn the_standard_pair_has_the_geometry_of_its_closed_form() {
        // By the closed forms of ISO 21771: alpha_w 20.76902 deg, epsilon 1.51155, s_A, s_C, s_E 13.3564, 17.8187, 22.2810, j 0.34836 mm.
        let pair = geometry("standard-pair");
        for (value, printed, half_digit) in [
            (pair.working_pressure_angle_deg, 20.769_02, 6e-6),
            (pair.contact_ratio, 1.511_55, 6e-6),
            (pair.backlash_mm, 0.348_36, 6e-6),
            (
                pair.path_of_contact.point_a.driving_roll_length_mm,
                13.3564,
                6e-5,
            ),
            (
                pair.path_of_contact.point_c.driving_roll_length_mm,
                17.8187,
                6e-5,
            ),
            (
                pair.path_of_contact.point_e.driving_roll_length_mm,
                22.2810,
                6e-5,
            ),
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
            let told = (driven.imbalance_kg_mm, driven.imbalance_angle_deg);
            assert_eq!(told, (0.0, None), "{name}");
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
        let example = examples()
            .iter()
            .find(|example| example.name == "helical-pair")
            .expect("ships");
        let without = example
            .json
            .replace("\"width_mm\": 24.0", "\"width_mm\": 20.0");
        assert_ne!(without, example.json);
        let submission = Submission::parse(without.as_bytes()).expect("valid");
        let plain = PairGeometry::of(submission.case()).driven;
        let mass = 7850.0 * PI * (0.03_f64.powi(2) - 0.02_f64.powi(2)) * 4e-3;
        assert!((hub.mass_kg - plain.mass_kg - mass).abs() < 1e-12);
        let inertia = 7850.0 * PI / 2.0 * (0.03_f64.powi(4) - 0.02_f64.powi(4)) * 4e-3;
        assert!((hub.polar_inertia_kg_m2 - plain.polar_inertia_kg_m2 - inertia).abs() < 1e-15);
    }
}
