//! How two flanks push each other where they meet, and how that changes as gears turn and teeth deviate.

use super::placement::{self, FlankPlace, Sight, inclined, quarter_turned, unit};
use crate::gear::{GearPair, Member, PairDeviations, Vector};

/// The square of an angle below which a few terms tell its sine and cosine.
const SMALL_TURN: f64 = 1e-4;

/// What contact needs of a point at which two flanks face each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    /// The gap along the common normal, positive when open.
    pub(super) gap: f64,
    /// The arms of the force about the axes of rotation, over the base radii: 1 on the line of action.
    pub(super) arms: [f64; 2],
}

/// The direction in which two flanks push.
///
/// Pressed together both turn to a common normal between their own.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    seat: Member,
    /// Outward from the flank of the other gear.
    pub(super) normal: Vector,
}

impl Push {
    /// Between flanks with the outward normals `on_seat` and `on_mate`.
    pub(super) fn new(seat: Member, on_seat: Vector, on_mate: Vector) -> Self {
        Self {
            seat,
            normal: unit(on_mate - on_seat),
        }
    }

    /// The arms about `centers`, over the base radii of `pair`, of the force at `point`.
    fn arms(&self, pair: &GearPair, point: Vector, centers: [Vector; 2]) -> [f64; 2] {
        // On the driven gear; it stands on the other side of the flank.
        let push = match self.seat {
            Member::Driving => -self.normal,
            Member::Driven => self.normal,
        };
        let about = |center: Vector| {
            let d = point - center;
            d.x * push.y - d.y * push.x
        };
        [
            about(centers[0]) / pair.driving().base_radius(),
            -about(centers[1]) / pair.driven().base_radius(),
        ]
    }

    /// The meeting at `point` of flanks of which that of the other gear passes through it once turned by the length `turn` on its base
    /// circle about its own center.
    pub(super) fn meeting(
        &self,
        pair: &GearPair,
        point: Vector,
        turn: f64,
        centers: [Vector; 2],
    ) -> Meeting {
        let axes = placement::axes(pair);
        let arms = self.arms(pair, point, axes);
        let closing = if centers == axes {
            arms
        } else {
            self.arms(pair, point, centers)
        };
        Meeting {
            gap: turn * closing[self.seat.other().index()],
            arms,
        }
    }
}

/// A point of the seat's flank as drawn and as laid, with all that is needed to tell how it meets the other flank once both gears have turned
/// on a little and their teeth deviate: the same as [`placement::Placement`] tells, without an angle to be taken.
#[derive(Debug, Clone, Copy)]
pub(super) struct Probe {
    /// Roll lengths on the seat and on the other gear, as laid.
    roll_lengths: [f64; 2],
    /// From the center of the seat.
    point: Vector,
    normal: Vector,
    radial: Vector,
    /// The radial direction of the tangent point on the other base circle.
    seen: Vector,
    /// The roll length at which the involute of the other gear would pass through the point unturned.
    foot: f64,
}

/// How the flanks of one pair stand, from how they were laid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standing<'a> {
    pair: &'a GearPair,
    seat: Member,
    /// Cosine and sine of the turn of each gear since.
    turns: [[f64; 2]; 2],
    centers: [Vector; 2],
    /// The profile slope deviations, and the roll lengths at which they begin.
    slopes: [f64; 2],
    forms: [f64; 2],
}

impl Probe {
    /// The point at `place` on the flank of `seat` that sees `sight`, its center at `center`.
    pub(super) fn new(
        roll_length: f64,
        place: &FlankPlace,
        sight: &Sight,
        removed: f64,
        center: Vector,
    ) -> Self {
        Self {
            roll_lengths: [roll_length, sight.roll_length],
            point: place.point - center,
            normal: place.normal,
            radial: place.radial,
            seen: sight.radial,
            foot: sight.roll_length + removed - sight.gap,
        }
    }
}

/// Cosine and sine of the turn by an `arc` on a circle of the `radius`.
fn turn(arc: f64, radius: f64) -> [f64; 2] {
    let angle = arc / radius;
    let square = angle * angle;
    if square < SMALL_TURN {
        // To the last digit.
        let cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0));
        let sine = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
        return [cosine, sine];
    }
    let (sine, cosine) = angle.sin_cos();
    [cosine, sine]
}

fn turned([cosine, sine]: [f64; 2], v: Vector) -> Vector {
    Vector::new(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y)
}

impl<'a> Standing<'a> {
    /// Pair `n` with these `deviations` at the mesh position `eta`, the driven gear lagging by `lag`, from where a pair of `phase` was laid on
    /// `seat`.
    pub(super) fn new(
        (pair, deviations): (&'a GearPair, &PairDeviations),
        eta: f64,
        n: i64,
        lag: f64,
        (seat, phase): (Member, f64),
    ) -> Self {
        let teeth = pair.teeth(n);
        let ahead = (eta - n as f64 - phase) * pair.base_pitch();
        let advance = [ahead, lag - ahead];
        let lengths = Member::BOTH.map(|member| {
            let g = member.index();
            advance[g] + deviations.of_gear(member).turn(teeth[g])
        });
        let body = placement::angles(pair, eta - n as f64);
        let body = [body[0], body[1] + lag / pair.driven().base_radius()];
        Self {
            pair,
            seat,
            turns: Member::BOTH
                .map(|member| turn(lengths[member.index()], pair.gear(member).base_radius())),
            centers: placement::centers(pair, deviations, n, body),
            slopes: Member::BOTH
                .map(|member| deviations.of_gear(member).slope(teeth[member.index()])),
            forms: Member::BOTH.map(|member| pair.gear(member).form_roll_length()),
        }
    }

    /// The same with the tooth of `member` standing out more: turned by the length `arc` on its base circle, and inclined by `slope`.
    pub(super) fn deviating(&self, member: Member, arc: f64, slope: f64) -> Self {
        let mut other = *self;
        let g = member.index();
        let so_far = Vector::new(self.turns[g][0], self.turns[g][1]);
        let turned = turned(turn(arc, self.pair.gear(member).base_radius()), so_far);
        other.turns[g] = [turned.x, turned.y];
        other.slopes[g] += slope;
        other
    }

    /// How `probe` meets the other flank.
    pub(super) fn meeting(&self, probe: &Probe) -> Meeting {
        let (seat, mate) = (self.seat.index(), self.seat.other().index());
        let (gear, other) = (self.pair.gear(self.seat), self.pair.gear(self.seat.other()));
        // A slope deviation turns each point by itself and inclines the flank.
        let (mut place, mut normal) = (probe.point, probe.normal);
        let slope = self.slopes[seat];
        if slope != 0.0 {
            let (s, r_b) = (probe.roll_lengths[0], gear.base_radius());
            place = turned(turn(slope * (s - self.forms[seat]), r_b), place);
            normal -= slope * r_b / s.max(1e-9 * r_b) * probe.radial;
        }
        let point = self.centers[seat] + turned(self.turns[seat], place);

        // As the other gear sees it in the frame in which it was laid.
        let [cosine, sine] = self.turns[mate];
        let d = turned([cosine, -sine], point - self.centers[mate]);
        let r_b = other.base_radius();
        let far = d.norm_squared();
        let s = (far - r_b * r_b).max(0.0).sqrt();
        let radial = (r_b * d - s * quarter_turned(d)) / far;
        let across = quarter_turned(radial);
        // An arc of a few thousandths, to the last digit.
        let chord = probe.seen.x * radial.y - probe.seen.y * radial.x;
        let square = chord * chord;
        let turn = chord * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0)));
        let foot = probe.foot - r_b * turn;
        let slope = self.slopes[mate];
        let (removed, inclination) = other.removed_and_inclination(s);
        let missing = removed - slope * (s - self.forms[mate]);

        let on_mate = turned(
            self.turns[mate],
            inclined(radial, across, s, r_b, inclination - slope),
        );
        let on_seat = turned(self.turns[seat], normal);
        let push = Push::new(self.seat, on_seat, on_mate);
        push.meeting(self.pair, point, s - foot + missing, self.centers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_turn_is_the_sine_and_cosine_of_its_angle() {
        for i in -400..=400 {
            let angle = 5e-5 * f64::from(i);
            let (sine, cosine) = angle.sin_cos();
            let found = turn(angle * 0.05, 0.05);
            // A rounding each.
            assert!((found[0] - cosine).abs() < 3e-16 && (found[1] - sine).abs() < 1e-17);
        }
    }
}
