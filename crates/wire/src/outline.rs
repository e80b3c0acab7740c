//! The outline of a pair, for those who draw it: teeth, holes, webs, circles and the line of action, in one frame.

use meshwright_engine::gear::{GearPair, Hole, HoleShape, Member, Vector, Web, radial, tangential};

use super::declare::document;
use super::geometry::{PathOfContact, PathPoint};
use super::units::{rounded_json, to_mm};

/// No point of a profile is farther from the outline, in meters.
const TOLERANCE: f64 = 0.5e-6;

/// A point, in mm.
type Point = [f64; 2];

document! {
    /// The outline of a pair as it is cut. The driving gear has its center at the origin, the driven one at the center distance on the x
    /// axis. A gear at mesh position eta stands at `angle_deg` + eta times `angle_per_mesh_period_deg`, counter-clockwise.
    pub struct PairOutline as PairOutline, "Pair outline" answer of (pair: &GearPair) {
        /// Gear 1, which drives and turns counter-clockwise.
        driving: GearOutline = GearOutline::of(pair, Member::Driving),
        /// Gear 2, which is driven and turns clockwise.
        driven: GearOutline = GearOutline::of(pair, Member::Driven),
        /// The line on which loaded flanks touch.
        line_of_action: LineOfAction = LineOfAction::of(pair),
    }
}

document! {
    /// The outline of a gear in its own frame: its center is the origin, the centerline of tooth 0 the x axis, and the loaded flank of
    /// each tooth lies on its counter-clockwise side.
    pub struct GearOutline as GearOutline, "Gear outline"
    answer of (pair: &GearPair, member: Member) with {
        let gear = pair.gear(member);
        // At mesh position 0 the loaded flanks of tooth 0 touch at the pitch point, which lies on the line of centers.
        let half_angle = gear.flank().half_angle(pair.working_radius(member)).to_degrees();
        let (center, towards_mate, sense) = match member {
            Member::Driving => (0.0, 0.0, 1.0),
            Member::Driven => (pair.center_distance(), 180.0, -1.0),
        };
    } {
        /// Where its center stands, in mm.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        center_mm: Point = point(Vector::new(center, 0.0)),
        /// The angle of the centerline of tooth 0 at mesh position 0, counter-clockwise from the x axis, in degrees.
        angle_deg: f64 = towards_mate - half_angle,
        /// How far it turns in a mesh period, counter-clockwise, in degrees.
        angle_per_mesh_period_deg: f64 = sense * gear.pitch_angle().to_degrees(),
        /// The number of teeth Z. Tooth i is tooth 0 turned by 360 i/Z degrees.
        tooth_count: u32 = gear.tooth_count(),
        /// Tooth 0 counter-clockwise, in mm: from the middle of the space before it to the middle of the space behind it. The points lie
        /// on the true profile, and no point of the profile is more than a micrometer from the line through them.
        #[schema(value_type = Vec<Vec<f64>>)]
        tooth_mm: Vec<Point> = gear.tooth_outline(TOLERANCE).into_iter().map(point).collect(),
        /// The radius of the bore, in mm: 0 of a gear that is cut on its shaft.
        bore_radius_mm: f64 = to_mm(gear.data().blank.open_radius()),
        /// The radius of the shaft on which the gear is cut, in mm.
        shaft_radius_mm?: f64 = gear.data().blank.shaft().map(|_| to_mm(gear.bore_radius())),
        /// The holes.
        holes: Vec<HoleOutline> = gear.holes().iter().map(HoleOutline::of).collect(),
        /// The web, where the blank has one that is not as thick as the face is wide.
        web?: WebOutline = gear.data().blank.web_in(gear.face_width()).map(WebOutline::of),
        /// The radii of its circles.
        circles: Circles = Circles::of(pair, member),
    }
}

document! {
    /// A hole: round, a slot along its circle with round ends, or an opening drawn by its edge.
    pub struct HoleOutline as HoleOutline, "Hole outline" answer of (hole: &Hole) {
        /// Its center, in mm: of an opening drawn by its edge, its center of mass.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        at_mm: Point = point(hole.circle_radius * radial(hole.angle)),
        /// The radius of a round hole, or of the ends of a slot, in mm; of an opening drawn by its edge, about half its extent along the radius.
        radius_mm: f64 = to_mm(hole.half_width()),
        /// The angle between the centers of the ends of a slot, about the center of the gear, in degrees; absent for a round hole.
        slot_angle_deg?: f64 = match hole.shape {
            HoleShape::Round { .. } | HoleShape::Contour(_) => None,
            HoleShape::Slot { angle, .. } => Some(angle.to_degrees()),
        },
        /// The edge of an opening between spokes, or of a loop of the outline, counter-clockwise, in mm: no point of it is more than a micrometer from the line
        /// through these. Absent for round holes and slots.
        #[schema(value_type = Option<Vec<Vec<f64>>>)]
        edge_mm?: Vec<Point> = hole
            .contour()
            .map(|_| hole.edge(TOLERANCE).into_iter().map(point).collect()),
    }
}

document! {
    /// A web: a ring of its own thickness. Its edges are those two circles, except where holes cut them.
    pub struct WebOutline as WebOutline, "Web outline" answer of (web: Web) {
        /// The radius at which it begins, in mm.
        inner_radius_mm: f64 = to_mm(web.inner_radius),
        /// The radius at which it ends, in mm.
        outer_radius_mm: f64 = to_mm(web.outer_radius),
    }
}

document! {
    /// The circles of a gear, in mm.
    pub struct Circles as Circles, "Circles" answer of (pair: &GearPair, member: Member) with {
        let gear = pair.gear(member);
    } {
        /// The tip circle's radius.
        tip_mm: f64 = to_mm(gear.tip_radius()),
        /// The radius of the reference circle.
        reference_mm: f64 = to_mm(gear.reference_radius()),
        /// The radius of the working pitch circle.
        pitch_mm: f64 = to_mm(pair.working_radius(member)),
        /// The radius of the base circle.
        base_mm: f64 = to_mm(gear.base_radius()),
        /// The radius of the root circle.
        root_mm: f64 = to_mm(gear.root_radius()),
    }
}

document! {
    /// The line of action of the loaded flanks, in the frame of the pair.
    pub struct LineOfAction as LineOfAction, "Line of action" answer of (pair: &GearPair) with {
        // The driving gear turns counter-clockwise and pushes upward: the line leaves its base circle below the line of centers.
        let angle = -pair.working_pressure_angle();
        let foot = pair.driving().base_radius() * radial(angle);
        let at = |s: f64| point(foot + s * tangential(angle));
        let PathOfContact {
            point_a,
            point_b,
            point_c,
            point_d,
            point_e,
            ..
        } = PathOfContact::of(pair);
        let points = [
            ("A", point_a),
            ("B", point_b),
            ("C", point_c),
            ("D", point_d),
            ("E", point_e),
        ];
    } {
        /// Where it touches the base circle of the driving gear, in mm.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        from_mm: Point = at(0.0),
        /// Where it touches the base circle of the driven gear, in mm.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        to_mm: Point = at(pair.line_of_action()),
        /// A, B, C, D and E, in this order.
        points: Vec<LinePoint> = points
            .map(|(name, place)| {
                LinePoint::of(name, at(place.driving_roll_length_mm * 1e-3), &place)
            })
            .into(),
    }
}

document! {
    /// A named point of the line of action.
    pub struct LinePoint as LinePoint, "Point of the line of action"
    answer of (name: &str, at_mm: Point, place: &PathPoint) {
        /// `A` to `E`.
        name: String = name.to_owned(),
        /// Where, in mm.
        #[schema(value_type = Vec<f64>, min_items = 2, max_items = 2)]
        at_mm: Point = at_mm,
        /// The mesh position at which the reference pair touches there.
        mesh_position: f64 = place.mesh_position,
    }
}

impl PairOutline {
    /// The document, rounded as results are.
    ///
    /// # Errors
    ///
    /// Where a number is not finite, which no valid pair has.
    pub fn to_json(&self) -> serde_json::Result<String> {
        rounded_json(self)
    }
}

fn point(p: Vector) -> Point {
    [to_mm(p.x), to_mm(p.y)]
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::Submission;
    use crate::testing::{example, parse, with};

    /// A test case without its reliefs: masses and conjugate flanks are those of the plain profile.
    fn plain_case(name: &str) -> Submission {
        let plain = ["driving", "driven"].map(|gear| format!("/pair/{gear}/tip_relief"));
        let plain = plain.each_ref().map(|place| (&**place, Value::Null));
        parse(&with(example(name), &plain)).expect("valid")
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
        let outline = |thickness_mm: f64| {
            let place = "/pair/driven/blank/web/thickness_mm";
            let document = with(example("web"), &[(place, thickness_mm.into())]);
            PairOutline::of(&parse(&document).expect("valid").case().pair)
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
