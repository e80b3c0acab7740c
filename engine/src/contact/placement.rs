//! Both gears turned to a mesh position, and what one flank sees of the other.

use std::f64::consts::PI;

use crate::gear::{GearPair, Member, SpurGear, Vector, radial, tangential, teeth_on};

/// Both gears at one mesh position, as one tooth pair sees them.
///
/// The driving center is the origin, the driven one lies on the x axis; the driving gear turns counter-clockwise.
#[derive(Debug, Clone, Copy)]
pub struct Placement<'a> {
    pair: &'a GearPair,
    /// Where the gears' own axes stand: beside the axes of rotation where they are eccentric.
    centers: [Vector; 2],
    /// The driven axis of rotation.
    driven_axis: Vector,
    /// The angle of each tooth's centerline.
    angles: [f64; 2],
}

/// A place on the boundary of a gear.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlankPlace {
    pub(super) point: Vector,
    /// The outward unit normal.
    pub(super) normal: Vector,
    /// The unit tangent towards the tip.
    pub(super) to_tip: Vector,
}

/// What a point sees of an involute: where the involute's normal through the point meets it.
///
/// The normal of an involute is a tangent of its base circle, so that this is a closed form.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// The roll length at the foot of the normal; less than that of the form circle, or negative, where the involute's
    /// continuation is met below the flank.
    pub(super) roll_length: f64,
    /// The distance along the normal, positive outside.
    pub(super) gap: f64,
    /// The outward unit normal at the foot.
    pub(super) normal: Vector,
    /// The length of the tangent from the point to the base circle.
    tangent: f64,
}

impl<'a> Placement<'a> {
    /// The teeth of pair `n` at the mesh position `eta`, `home` whole mesh periods later.
    ///
    /// Those periods turn both gears by whole teeth, which shows only where a gear is eccentric.
    pub fn new(pair: &'a GearPair, eta: f64, n: i64, home: i64) -> Self {
        let alpha_w = pair.working_pressure_angle();
        let s_1 = pair.roll_length_of(eta - n as f64);
        let angle = |gear: &SpurGear, tangent: f64, s: f64| {
            tangent - gear.flank().base_half_angle() + s / gear.base_radius()
        };
        let angles = [
            angle(pair.driving(), -alpha_w, s_1),
            angle(pair.driven(), PI - alpha_w, pair.line_of_action() - s_1),
        ];
        let driven_axis = Vector::new(pair.center_distance(), 0.0);
        let center = |member: Member, axis: Vector| {
            let gear = pair.gear(member);
            // From the tooth in mesh back to tooth 0.
            let teeth = teeth_on(member, n + home) as f64;
            let tooth_0 = angles[member.index()] - teeth * gear.pitch_angle();
            axis + gear.deviations().displacement(tooth_0)
        };
        Self {
            pair,
            centers: [
                center(Member::Driving, Vector::zeros()),
                center(Member::Driven, driven_axis),
            ],
            driven_axis,
            angles,
        }
    }

    /// Where the own axis of `member` stands, and the angle of the centerline of its tooth.
    pub fn frame(&self, member: Member) -> (Vector, f64) {
        (self.centers[member.index()], self.angles[member.index()])
    }

    /// The place on the flank of `member` at roll length `s`.
    pub(super) fn place(&self, member: Member, s: f64) -> FlankPlace {
        let gear = self.pair.gear(member);
        let t = self.angles[member.index()] + gear.flank().tangent_angle(s);
        let (e_r, e_t) = (radial(t), tangential(t));
        FlankPlace {
            point: self.centers[member.index()] + gear.base_radius() * e_r + s * e_t,
            normal: e_t,
            to_tip: e_r,
        }
    }

    /// What `point` sees of the flank of `member`; `None` from inside its base circle.
    pub(super) fn sight(&self, member: Member, point: Vector) -> Option<Sight> {
        let d = point - self.centers[member.index()];
        let flank = self.pair.gear(member).flank();
        let r_b = flank.base_radius();
        let tangent = (d.norm_squared() - r_b * r_b).max(0.0).sqrt();
        let t = d.y.atan2(d.x) - (tangent / r_b).atan();
        let turn = self.angles[member.index()] + flank.base_half_angle() - t;
        let roll_length = r_b * (turn - (turn / (2.0 * PI)).round() * 2.0 * PI);
        (tangent > 0.0).then(|| Sight {
            roll_length,
            gap: tangent - roll_length,
            normal: tangential(t),
            tangent,
        })
    }

    /// The distance of `point` from the fillet on the loaded side of the tooth of `member`, positive outside.
    pub(super) fn fillet_distance(&self, member: Member, point: Vector) -> f64 {
        const POINTS: u32 = 64;
        let d = point - self.centers[member.index()];
        let (e_x, e_y) = (
            radial(self.angles[member.index()]),
            tangential(self.angles[member.index()]),
        );
        let in_tooth = Vector::new(d.dot(&e_x), d.dot(&e_y));
        let fillet = self.pair.gear(member).fillet();
        let (gamma_0, gamma_1) = fillet.ends();
        let at =
            |i: u32| fillet.point(gamma_0 + (gamma_1 - gamma_0) * f64::from(i) / f64::from(POINTS));
        let mut nearest = f64::INFINITY;
        for i in 0..POINTS {
            let (from, to) = (at(i), at(i + 1));
            let way = to - from;
            let part = ((in_tooth - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
            let apart = in_tooth - from - part * way;
            // On the way down to the root the space lies on the left of the tooth.
            let side = apart.dot(&Vector::new(way.y, -way.x));
            if apart.norm() < nearest.abs() {
                nearest = apart.norm().copysign(side);
            }
        }
        nearest
    }

    /// The arm about the driven axis, over r_b2, of a force that presses the driven gear along `direction` at `point`.
    pub(super) fn arm(&self, point: Vector, direction: Vector) -> f64 {
        let d = point - self.driven_axis;
        -(d.x * direction.y - d.y * direction.x) / self.pair.driven().base_radius()
    }
}

impl Sight {
    /// The way to the tip at the foot.
    pub(super) fn tipward(&self) -> Vector {
        // An involute's normal is e_t and its tangent e_r of the same angle.
        Vector::new(self.normal.y, -self.normal.x)
    }

    /// How the gap and the roll length at the foot change as the point moves along the unit vector `way`.
    pub(super) fn change(&self, base_radius: f64, way: Vector) -> (f64, f64) {
        // The point stands at r_b e_r(t) + L e_t(t) of the center, L the tangent: dt = −way·e_r / L, and the gap is the
        // distance along e_t.
        let turn = -way.dot(&self.tipward()) / self.tangent;
        (way.dot(&self.normal), -base_radius * turn)
    }
}
