//! Where the largest pressure and the largest stresses of a curve stand.

use std::f64::consts::TAU;

use super::Case;
use super::stress::PeakStress;
use crate::contact::PeakPlace;
use crate::gear::{GearPair, Member};

/// Of a kink that turns the flank by less than this part of the angle between the ends of a contact of two cylinders pressure says little.
const SHARP: f64 = 0.1;

/// The largest pressure of a curve, and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestPressure {
    /// In Pa.
    pub pressure: f64,
    /// The mesh position η.
    pub mesh_position: f64,
    /// The place on the flanks.
    pub place: PeakPlace,
}

/// Where the largest value of a curve stands. Lengths are in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LargestWhere {
    /// The mesh position η.
    pub mesh_position: f64,
    /// n − floor(η) of the pair on whose tooth it stands; `None` off the teeth.
    pub pair_offset: Option<i32>,
    /// The diameters on the driving and on the driven gear; of a stress that of its own gear alone.
    pub diameters: [Option<f64>; 2],
    /// The height from the middle of the common face, of a stress from that of the face of its gear; `None` in the plane.
    pub z: Option<f64>,
}

impl LargestPressure {
    /// The largest of values at some positions: mesh position, pressure and place. `None` where a pressure has no limit.
    pub(super) fn of(
        found: impl Iterator<Item = (f64, Option<f64>, Option<PeakPlace>)>,
    ) -> Option<Self> {
        let mut largest: Option<Self> = None;
        for (mesh_position, pressure, place) in found {
            let pressure = pressure?;
            let is_larger = largest.is_none_or(|known| pressure > known.pressure);
            if let Some(place) = place.filter(|_| is_larger) {
                largest = Some(Self {
                    pressure,
                    mesh_position,
                    place,
                });
            }
        }
        largest
    }

    /// Where it stands on the flanks of `pair`.
    pub fn stands(&self, pair: &GearPair) -> LargestWhere {
        let PeakPlace {
            pair: n,
            roll_lengths,
            z,
            ..
        } = self.place;
        LargestWhere {
            mesh_position: self.mesh_position,
            pair_offset: Some(offset(n, self.mesh_position)),
            diameters: Member::BOTH.map(|member| {
                let flank = pair.gear(member).flank();
                Some(2.0 * flank.radius(roll_lengths[member.index()]))
            }),
            z,
        }
    }

    /// The gear of `pair` with a kink of its profile within the contact, sharp enough to decide the pressure, and the diameter of that kink.
    pub(super) fn kink(&self, pair: &GearPair) -> Option<(Member, f64)> {
        let PeakPlace {
            roll_lengths,
            half_width,
            ..
        } = self.place;
        let [one, other] = roll_lengths;
        let radius = one * other / (one + other);
        let mut members = Member::BOTH.into_iter();
        members.find_map(|member| {
            let (gear, s) = (pair.gear(member), roll_lengths[member.index()]);
            // Along the flank, for each roll length.
            let along = s / gear.base_radius();
            let mut kinks = gear.kinks().into_iter();
            let kink = kinks.find(|kink| {
                let [before, beyond] = gear.slopes_beside(*kink);
                let turn = (beyond - before) / along;
                (kink - s).abs() * along < half_width && turn * radius > SHARP * half_width
            })?;
            Some((member, 2.0 * gear.flank().radius(kink)))
        })
    }
}

impl PeakStress {
    /// Where it stands as the largest of `member` at a `mesh_position` of `case`: on a tooth, or at the edge of a hole.
    pub fn stands(
        &self,
        (case, member): (&Case, Member),
        mesh_position: f64,
        on_tooth: bool,
    ) -> LargestWhere {
        let teeth = case.pair.gear(member).tooth_count() as usize;
        let tooth = (self.angle / TAU * teeth as f64).round() as usize % teeth;
        let mut diameters = [None; 2];
        diameters[member.index()] = Some(2.0 * self.radius);
        LargestWhere {
            mesh_position,
            pair_offset: on_tooth.then(|| nearest_offset(&case.pair, member, tooth, mesh_position)),
            diameters,
            z: self.z,
        }
    }
}

/// n − floor(η).
fn offset(n: i64, eta: f64) -> i32 {
    (n - eta.floor() as i64) as i32
}

/// The offset of the pair that has `tooth` of `member` and is the nearest to its pitch point at the mesh position `eta`.
fn nearest_offset(pair: &GearPair, member: Member, tooth: usize, eta: f64) -> i32 {
    let now = eta.floor() as i64;
    let teeth = i64::from(pair.gear(member).tooth_count());
    let mut by_distance = (0..=teeth).flat_map(|apart| [now + apart, now - apart]);
    let found = by_distance.find(|n| pair.tooth(member, *n) == tooth);
    offset(found.unwrap_or(now), eta)
}
