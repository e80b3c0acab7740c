//! Where flanks touch first along their faces, and the contact as its load vanishes.

use std::sync::Arc;

use faer::Mat;

use super::slice::drives;
use super::{FaceModel, FlankYield};
use crate::contact::facing::Facing;
use crate::contact::light::{FirstTouch, TOGETHER, first, on_path, touching_near};
use crate::contact::{MeshContact, PositionError};
use crate::gear::{Member, SolidPair};
use crate::root_finding::least_places;

impl FaceModel {
    /// The `pair`, whose flanks yield nowhere, its face cut into so many `slices`.
    pub fn rigid(pair: SolidPair, slices: usize) -> Self {
        let rigid: Arc<dyn FlankYield> = Arc::new(Rigid);
        Self::new(pair, [Arc::clone(&rigid), rigid], slices, usize::MAX)
    }

    /// The limit of the contact at the mesh position `eta` as the load goes to zero: δ is that at which the first of the flanks touch.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn light_contact(&self, eta: f64) -> Result<MeshContact, PositionError> {
        MeshContact::of_first(0.0, &self.touches(eta), self.rounding())
    }

    /// The δ at which the first flanks touch at the position `eta`, on the path of contact or off it.
    pub fn least_touch(&self, eta: f64) -> Option<f64> {
        Some(first(&self.touches(eta))).filter(|touch| touch.is_finite())
    }

    /// Where each pair touches at the position `eta` that may be the first.
    fn touches(&self, eta: f64) -> Vec<FirstTouch> {
        let beside = 0.5 * self.pair.overlap_ratio();
        let slopes = Member::BOTH.map(|member| self.deviations.of_gear(member).steepest_lead());
        let apart = 2.0 * (self.deviations.nearest() + slopes[0] + slopes[1]) + self.rounding();
        let pairs = on_path(self.pair.section(), eta, beside);
        touching_near(pairs, apart, |n| self.touch_of(eta, n))
    }

    /// Where pair `n` touches first at the position `eta`: in that of its sections which does.
    fn touch_of(&self, eta: f64, n: i64) -> Option<FirstTouch> {
        let half = 0.5 * self.pair.common_face_width();
        // Straight teeth face each other alike in all sections.
        let straight = (self.pair.advance() == 0.0).then(|| self.faced(eta, n, 0.0));
        let touch = |z: f64| {
            let facing = straight.clone().unwrap_or_else(|| self.faced(eta, n, z))?;
            let opening = self.opening(n, z, facing.minima[0].roll_lengths);
            let section = FirstTouch::of(n, &facing);
            Some(FirstTouch {
                delta: section.delta + opening,
                ..section
            })
        };
        let delta = |z: f64| touch(z).map_or(f64::INFINITY, |touch| touch.delta);
        let places = least_places([-half, half], self.slices, self.rounding(), delta);
        let touches = places.into_iter().filter_map(|(z, _)| touch(z));
        touches.min_by(|a, b| a.delta.total_cmp(&b.delta))
    }

    /// The phases between `from` and `to` at which sections as drawn are nearer to each other than those beside them, rising; looked for from `step`
    /// to `step`.
    pub(super) fn nearest_phases(&self, [from, to]: [f64; 2], step: f64) -> Vec<f64> {
        let touch = |phase: f64| {
            let facing = Facing::drawn(&self.plane_strain, phase);
            let facing = facing.filter(|facing| drives(&self.plane_strain, phase, facing));
            facing.map_or(f64::INFINITY, |facing| facing.touch())
        };
        let count = ((to - from) / step).ceil() as usize;
        let found = least_places([from, to], count, self.rounding(), touch);
        found.into_iter().map(|(phase, _)| phase).collect()
    }

    /// How the flanks of pair `n` as drawn face each other at `z`, where a force between them drives on.
    fn faced(&self, eta: f64, n: i64, z: f64) -> Option<Facing> {
        let phase = self.pair.phase(eta, n, z);
        Facing::drawn(&self.plane_strain, phase)
            .filter(|facing| drives(&self.plane_strain, phase, facing))
    }

    /// By how much leads, axes and deviations open pair `n` at `z`, along the base tangent.
    pub(super) fn opening(&self, n: i64, z: f64, roll_lengths: [f64; 2]) -> f64 {
        let (pair, deviations) = (&self.pair, &self.deviations);
        let teeth = pair.section().teeth(n);
        let out = Member::BOTH.map(|member| {
            let (g, teeth_of) = (member.index(), deviations.of_gear(member));
            let (tooth, s) = (teeth[g], roll_lengths[g]);
            let turn = pair.gear(member).twist() * pair.own_height(member, z);
            teeth_of.at(tooth, s) + teeth_of.runout(pair.section().gear(member), tooth, s, turn)
        });
        pair.lead_gap(deviations, teeth, z) - out[0] - out[1]
    }

    fn rounding(&self) -> f64 {
        TOGETHER * self.pair.section().driving().data().rack.module
    }
}

/// Flanks that yield nowhere.
struct Rigid;

impl FlankYield for Rigid {
    fn basis_len(&self) -> usize {
        0
    }

    fn basis(&self, _: f64, _: f64, _: &mut [f64]) {}

    fn smooth(&self, _: &[usize]) -> Mat<f64> {
        Mat::new()
    }

    fn repeats_after(&self) -> usize {
        1
    }

    fn at_ends(&self, _: (f64, f64), _: (f64, f64), _: f64) -> f64 {
        0.0
    }
}
