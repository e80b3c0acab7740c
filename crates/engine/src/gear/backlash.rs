//! Backlash with deviations and eccentricities.
//!
//! A tooth that is displaced as a whole takes nothing by itself: its loaded flank closes by as much as its other flank opens. At a mesh position the loaded
//! flanks touch at the pair that stands out most, and the other flanks at the one that stands back most. Only teeth in mesh at the same time count, and a part
//! common to all teeth does not count. An eccentric gear closes up on both flanks as it comes nearer to its mate.

use std::f64::consts::PI;

use super::{GearPair, GearPairError, Member, PairDeviations};
use crate::root_finding::{bisect, least_between};

/// Further mesh positions a mesh period that are looked at where a gear is eccentric.
const PLACES: u32 = 4;

/// A pair that is so little of a mesh period off its path of contact is on it.
const ON_PATH: f64 = 1e-9;

impl GearPair {
    /// The least backlash over the true period, along the line of action as [`GearPair::backlash`]: with pitch deviations of teeth in mesh at the same time,
    /// slopes that stand out and eccentricities.
    pub fn least_backlash(&self) -> f64 {
        // Where the other flanks were moved back to touch, rounding leaves some last bits.
        (self.backlash() - self.taken_backlash(&self.deviations())).max(0.0)
    }

    /// The least backlash of teeth that have these `deviations`, along the line of action; negative where they jam.
    pub fn backlash_with(&self, deviations: &PairDeviations) -> f64 {
        self.backlash() - self.taken_backlash(deviations)
    }

    /// By how much the other flanks of teeth that have these `deviations` have to be moved back for room: nothing, or as much as the last printed digits
    /// explain.
    pub(super) fn shortfall(&self, deviations: &PairDeviations) -> Result<f64, GearPairError> {
        let base_radii = self.driving().base_radius() + self.driven().base_radius();
        let tip_radii = self.driving().tip_radius() + self.driven().tip_radius();
        // Below the base circles together there is no line of action; the backlash decides the nearest distance.
        let is_possible = self.center_distance() > base_radii;
        // The reduction hardly changes with the distance.
        let mut taken = if is_possible {
            self.taken_backlash(deviations)
        } else {
            0.0
        };
        let backlash = if is_possible {
            self.drawn_backlash() - taken
        } else {
            f64::NEG_INFINITY
        };
        if backlash >= -self.backlash_in_last_digits() {
            return Ok((-backlash).max(0.0));
        }
        let rounding = 1e-9 * self.driving().data().rack.module;
        let mut smallest = tip_radii;
        for _ in 0..8 {
            let fits = |a: f64| self.at(a).drawn_backlash() >= taken;
            smallest = bisect(tip_radii, base_radii, fits);
            let there = self.at(smallest);
            let needed = there.taken_backlash(deviations);
            if there.drawn_backlash() >= needed - 0.5 * rounding {
                break;
            }
            taken = needed;
        }
        Err(GearPairError::NegativeBacklash { backlash, smallest })
    }

    /// The most that `deviations` take of the backlash at any mesh position.
    fn taken_backlash(&self, deviations: &PairDeviations) -> f64 {
        if deviations.are_none() {
            return 0.0;
        }
        let (from, to) = self.phases_on_path();
        let later = self.other_flanks_later();
        // Between events of pairs the reduction changes evenly.
        let events = [from, to, later - to, later - from].map(|phase| phase - phase.floor());
        let eccentric = Member::BOTH
            .into_iter()
            .any(|member| deviations.of_gear(member).eccentricity() > 0.0);
        let places = (0..PLACES).map(|i| f64::from(i) / f64::from(PLACES));
        let places = places.filter(|_| eccentric).chain(events);
        let places: Vec<f64> = places.collect();
        let most = |a: (f64, f64), b: (f64, f64)| if b.1 > a.1 { b } else { a };
        let at = |eta: f64| (eta, self.taken_at(deviations, eta));
        let periods = 0..self.period_of_teeth(deviations);
        let found = periods
            .flat_map(|k| places.iter().map(move |place| f64::from(k) + place))
            .map(at)
            .fold((0.0, f64::NEG_INFINITY), most);
        if !eccentric {
            return found.1;
        }
        // A turn between two places is smooth.
        let step = 1.0 / f64::from(PLACES);
        let around = [found.0 - step, found.0 + step];
        let between = least_between(around, |eta| -self.taken_at(deviations, eta));
        most(found, at(between)).1
    }

    /// Reduction of the backlash by `deviations` at the mesh position `eta`.
    fn taken_at(&self, deviations: &PairDeviations, eta: f64) -> f64 {
        let [driving, driven] = Member::BOTH.map(|member| deviations.of_gear(member));
        let (from, to) = self.phases_on_path();
        let pairs =
            |eta: f64| (eta - to - ON_PATH).ceil() as i64..=(eta - from + ON_PATH).floor() as i64;
        let out = pairs(eta).map(|n| {
            let s = self.roll_length_of(eta - n as f64);
            let teeth = self.teeth(n);
            driving.at(teeth[0], s) + driven.at(teeth[1], self.line_of_action() - s)
        });
        // The other flanks pass the path of contact from its end, the driven one of the next pair.
        let mirrored = pairs(self.other_flanks_later() - eta);
        let back = mirrored.map(|n| {
            let tooth = |member, n| self.tooth(member, n);
            driving.other_turn(tooth(Member::Driving, -n))
                + driven.other_turn(tooth(Member::Driven, 1 - n))
        });
        let out = out.fold(f64::NEG_INFINITY, f64::max);
        let back = back.fold(f64::INFINITY, f64::min);
        let by_teeth = if out.is_finite() && back.is_finite() {
            out - back
        } else {
            0.0
        };
        let alpha = self.working_pressure_angle();
        let nearer = Member::BOTH.map(|member| {
            let moved = deviations
                .of_gear(member)
                .displacement(self.centerline(member, eta));
            match member {
                Member::Driving => moved.x,
                Member::Driven => -moved.x,
            }
        });
        by_teeth + 2.0 * alpha.sin() * (nearer[0] + nearer[1])
    }

    /// The phases, in mesh periods since a pair passed the pitch point, between which it is on the path of contact.
    fn phases_on_path(&self) -> (f64, f64) {
        let (s_a, s_e) = self.path_of_contact();
        let phase = |s: f64| (s - self.pitch_roll_length()) / self.base_pitch();
        (phase(s_a), phase(s_e))
    }

    /// The angle of the centerline of tooth 0 of `member` at the mesh position `eta`, from the line of centers.
    fn centerline(&self, member: Member, eta: f64) -> f64 {
        let s_1 = self.roll_length_of(eta);
        let (tangent, s) = match member {
            Member::Driving => (0.0, s_1),
            Member::Driven => (PI, self.line_of_action() - s_1),
        };
        let gear = self.gear(member);
        tangent - self.working_pressure_angle() - gear.flank().base_half_angle()
            + s / gear.base_radius()
    }
}
