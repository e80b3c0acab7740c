//! The outline of a pair, for those who draw it: teeth, holes, webs, circles and the line of action, in one frame.

use meshwright_engine::gear::{GearPair, Hole, HoleShape, Member, Vector, Web, radial, tangential};
use serde::Serialize;
use utoipa::ToSchema;

use super::geometry::PathOfContact;
use super::units::{rounded_json, to_mm};

/// No point of a profile is farther from the outline, in meters.
const TOLERANCE: f64 = 0.5e-6;

/// A point, in mm.
type Point = [f64; 2];

/// The outline of a pair as it is cut. The driving gear has its center at the origin, the driven one at the center distance on the x
/// axis. A gear at mesh position eta stands at `angle_deg` + eta times `angle_per_mesh_period_deg`, counter-clockwise.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Pair outline")]
pub struct PairOutline {
    /// Gear 1, which drives and turns counter-clockwise.
    pub driving: GearOutline,
    /// Gear 2, which is driven and turns clockwise.
    pub driven: GearOutline,
    /// The line on which loaded flanks touch.
    pub line_of_action: LineOfAction,
}

/// The outline of a gear in its own frame: its center is the origin, the centerline of tooth 0 the x axis, and the loaded flank of
/// each tooth lies on its counter-clockwise side.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Gear outline")]
pub struct GearOutline {
    /// Where its center stands, in mm.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub center_mm: Point,
    /// The angle of the centerline of tooth 0 at mesh position 0, counter-clockwise from the x axis, in degrees.
    pub angle_deg: f64,
    /// How far it turns in a mesh period, counter-clockwise, in degrees.
    pub angle_per_mesh_period_deg: f64,
    /// The number of teeth Z. Tooth i is tooth 0 turned by 360 i/Z degrees.
    pub tooth_count: u32,
    /// Tooth 0 counter-clockwise, in mm: from the middle of the space before it to the middle of the space behind it. The points lie
    /// on the true profile, and no point of the profile is more than a micrometer from the line through them.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub tooth_mm: Vec<Point>,
    /// The radius of the bore, in mm.
    pub bore_radius_mm: f64,
    /// The holes.
    pub holes: Vec<HoleOutline>,
    /// The web, where the blank has one that is not as thick as the face is wide.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub web: Option<WebOutline>,
    /// The radii of its circles.
    pub circles: Circles,
}

/// A hole: round, or a slot along its circle with round ends.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Hole outline")]
pub struct HoleOutline {
    /// Its center, in mm.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub at_mm: Point,
    /// The radius of a round hole, or of the ends of a slot, in mm.
    pub radius_mm: f64,
    /// The angle between the centers of the ends of a slot, about the center of the gear, in degrees; absent for a round hole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slot_angle_deg: Option<f64>,
}

/// A web: a ring of its own thickness. Its edges are those two circles, less what the holes take of them.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Web outline")]
pub struct WebOutline {
    /// The radius at which it begins, in mm.
    pub inner_radius_mm: f64,
    /// The radius at which it ends, in mm.
    pub outer_radius_mm: f64,
}

/// The circles of a gear, in mm.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Circles")]
pub struct Circles {
    /// The tip circle's radius.
    pub tip_mm: f64,
    /// The radius of the reference circle.
    pub reference_mm: f64,
    /// The radius of the working pitch circle.
    pub pitch_mm: f64,
    /// The radius of the base circle.
    pub base_mm: f64,
    /// The radius of the root circle.
    pub root_mm: f64,
}

/// The line of action of the loaded flanks, in the frame of the pair.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Line of action")]
pub struct LineOfAction {
    /// Where it touches the base circle of the driving gear, in mm.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub from_mm: Point,
    /// Where it touches the base circle of the driven gear, in mm.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub to_mm: Point,
    /// A, B, C, D and E, in this order.
    pub points: Vec<LinePoint>,
}

/// A named point of the line of action.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(title = "Point of the line of action")]
pub struct LinePoint {
    /// `A` to `E`.
    pub name: &'static str,
    /// Where, in mm.
    #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
    pub at_mm: Point,
    /// The mesh position at which the reference pair touches there.
    pub mesh_position: f64,
}

impl PairOutline {
    /// The outline of `pair`.
    pub fn of(pair: &GearPair) -> Self {
        let half_angle = |member| {
            let flank = pair.gear(member).flank();
            flank.half_angle(pair.working_radius(member)).to_degrees()
        };
        // At mesh position 0 the loaded flanks of tooth 0 touch at the pitch point, which lies on the line of centers.
        let driving = Stand {
            center: Vector::zeros(),
            angle_deg: -half_angle(Member::Driving),
            sense: 1.0,
        };
        let driven = Stand {
            center: Vector::new(pair.center_distance(), 0.0),
            angle_deg: 180.0 - half_angle(Member::Driven),
            sense: -1.0,
        };
        Self {
            driving: GearOutline::of(pair, Member::Driving, driving),
            driven: GearOutline::of(pair, Member::Driven, driven),
            line_of_action: LineOfAction::of(pair),
        }
    }

    /// The document, rounded as results are.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, which no valid pair has.
    pub fn to_json(&self) -> serde_json::Result<String> {
        rounded_json(self)
    }
}

/// Where a gear stands at mesh position 0, and which way it turns.
struct Stand {
    center: Vector,
    angle_deg: f64,
    sense: f64,
}

impl GearOutline {
    fn of(pair: &GearPair, member: Member, stand: Stand) -> Self {
        let gear = pair.gear(member);
        let outline = gear.tooth_outline(TOLERANCE);
        Self {
            center_mm: point(stand.center),
            angle_deg: stand.angle_deg,
            angle_per_mesh_period_deg: stand.sense * gear.pitch_angle().to_degrees(),
            tooth_count: gear.tooth_count(),
            tooth_mm: outline.into_iter().map(point).collect(),
            bore_radius_mm: to_mm(gear.bore_radius()),
            holes: gear.holes().iter().map(hole).collect(),
            web: gear.data().blank.web_in(gear.face_width()).map(web),
            circles: Circles {
                tip_mm: to_mm(gear.tip_radius()),
                reference_mm: to_mm(gear.reference_radius()),
                pitch_mm: to_mm(pair.working_radius(member)),
                base_mm: to_mm(gear.base_radius()),
                root_mm: to_mm(gear.root_radius()),
            },
        }
    }
}

fn hole(hole: &Hole) -> HoleOutline {
    let slot_angle_deg = match hole.shape {
        HoleShape::Round { .. } => None,
        HoleShape::Slot { angle, .. } => Some(angle.to_degrees()),
    };
    HoleOutline {
        at_mm: point(hole.circle_radius * radial(hole.angle)),
        radius_mm: to_mm(hole.half_width()),
        slot_angle_deg,
    }
}

fn web(web: Web) -> WebOutline {
    WebOutline {
        inner_radius_mm: to_mm(web.inner_radius),
        outer_radius_mm: to_mm(web.outer_radius),
    }
}

impl LineOfAction {
    fn of(pair: &GearPair) -> Self {
        // The driving gear turns counter-clockwise and pushes upward: the line leaves its base circle below the line of centers.
        let angle = -pair.working_pressure_angle();
        let foot = pair.driving().base_radius() * radial(angle);
        let at = |s: f64| point(foot + s * tangential(angle));
        let path = PathOfContact::of(pair);
        let named = [
            ("A", &path.point_a),
            ("B", &path.point_b),
            ("C", &path.point_c),
            ("D", &path.point_d),
            ("E", &path.point_e),
        ];
        Self {
            from_mm: at(0.0),
            to_mm: at(pair.line_of_action()),
            points: named
                .map(|(name, place)| LinePoint {
                    name,
                    at_mm: at(place.driving_roll_length_mm * 1e-3),
                    mesh_position: place.mesh_position,
                })
                .into(),
        }
    }
}

fn point(p: Vector) -> Point {
    [to_mm(p.x), to_mm(p.y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{Submission, examples};

    /// A test case without its reliefs: masses and conjugate flanks are those of the plain profile.
    fn plain_case(name: &str) -> Submission {
        let example = examples().iter().find(|example| example.name == name);
        let json = example.expect("ships").json;
        let mut document: serde_json::Value = serde_json::from_str(json).expect("JSON");
        for member in ["driving", "driven"] {
            document["pair"][member]["tip_relief"] = serde_json::Value::Null;
        }
        Submission::parse(document.to_string().as_bytes()).expect("valid")
    }

    fn world(gear: &GearOutline, local: Point, mesh_position: f64) -> Vector {
        let angle = gear.angle_deg + mesh_position * gear.angle_per_mesh_period_deg;
        let (e_r, e_t) = (radial(angle.to_radians()), tangential(angle.to_radians()));
        Vector::from(gear.center_mm) + local[0] * e_r + local[1] * e_t
    }

    #[test]
    fn loaded_flanks_touch_on_the_line_of_action_at_every_mesh_position() {
        // Conjugate action: without relief the flank points at s_1 and at T - s_1 coincide, and lie on the line from foot to foot.
        let submission = plain_case("test-case-3");
        let pair = &submission.case().pair;
        let outline = PairOutline::of(pair);
        let line = &outline.line_of_action;
        let (from, to) = (Vector::from(line.from_mm), Vector::from(line.to_mm));
        for mesh_position in [-0.4, 0.0, 0.3, 0.6] {
            let s_1 = pair.roll_length_of(mesh_position);
            let s_2 = pair.line_of_action() - s_1;
            let flank = |member: Member, s: f64| point(pair.gear(member).flank().point(s));
            let p_1 = world(&outline.driving, flank(Member::Driving, s_1), mesh_position);
            let p_2 = world(&outline.driven, flank(Member::Driven, s_2), mesh_position);
            let on_line = from + (to - from) * (s_1 / pair.line_of_action());
            assert!((p_1 - p_2).norm() < 1e-10, "{p_1} {p_2}");
            assert!((p_1 - on_line).norm() < 1e-10, "{p_1} {on_line}");
        }
    }

    #[test]
    fn a_web_is_drawn_where_it_is_thinner_than_the_face() {
        let example = examples().iter().find(|example| example.name == "web");
        let json = example.expect("ships").json;
        let outline = |thickness_mm: f64| {
            let mut document: serde_json::Value = serde_json::from_str(json).expect("JSON");
            document["pair"]["driven"]["blank"]["web"]["thickness_mm"] = thickness_mm.into();
            let submission = Submission::parse(document.to_string().as_bytes()).expect("valid");
            PairOutline::of(&submission.case().pair)
        };
        let outlined = outline(8.0);
        let web = outlined.driven.web.expect("as the example has it");
        assert_eq!((web.inner_radius_mm, web.outer_radius_mm), (22.0, 43.0));
        assert!(outlined.driving.web.is_none());
        // As thick as the face is wide it has no edges.
        assert!(outline(20.0).driven.web.is_none());
    }

    #[test]
    fn the_outline_with_its_bore_and_holes_encloses_the_mass() {
        for name in ["test-case-1", "test-case-2", "test-case-3"] {
            let submission = plain_case(name);
            let pair = &submission.case().pair;
            let outline = PairOutline::of(pair);
            for (member, drawn) in [
                (Member::Driving, &outline.driving),
                (Member::Driven, &outline.driven),
            ] {
                let gear = pair.gear(member);
                let twice: f64 = drawn
                    .tooth_mm
                    .windows(2)
                    .map(|ends| ends[0][0] * ends[1][1] - ends[1][0] * ends[0][1])
                    .sum();
                let circle = |r: f64| std::f64::consts::PI * r * r;
                let open: f64 = drawn.holes.iter().map(|hole| circle(hole.radius_mm)).sum();
                let teeth = f64::from(drawn.tooth_count) * twice / 2.0;
                let area = (teeth - open - circle(drawn.bore_radius_mm)) * 1e-6;
                let mass = gear.material().density * gear.face_width() * area;
                let off = mass / gear.mass() - 1.0;
                // Half a micrometer along the 700 mm of a profile is 6e-5 of the smallest area.
                assert!(off.abs() < 6e-5, "{name}: {off:e}");
            }
        }
    }
}
