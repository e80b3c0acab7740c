//! Differences of the flanks of a gear from the involute that the rack cuts, and from each other.

use super::SpurGear;
use crate::gear::modification::{Modification, Relief};
use crate::gear::{TipEdge, ToothDeviations};

/// A kink is rounded so far to either side, over the module.
const ROUNDED: f64 = 0.005;

impl SpurGear {
    /// The first tip relief, if there is any.
    pub fn tip_relief(&self) -> Option<&Relief> {
        self.modifications.iter().find_map(|each| match each {
            Modification::Tip(relief) => Some(relief),
            _ => None,
        })
    }

    /// The material removed from every loaded flank at the roll length `s`, modifications, the broken edge and undercut: the flank is turned
    /// back by this length on the base circle there, so that it belongs to the actual radius, and a tip corner stays on the tip circle.
    pub fn removed(&self, s: f64) -> f64 {
        self.modified(s) + self.ends_depth_and_slope(s).0
    }

    /// The part of [`SpurGear::removed`] that is meant by modifications, without the broken edge and undercut.
    pub(in crate::gear) fn modified(&self, s: f64) -> f64 {
        let depths = self
            .modifications
            .iter()
            .map(|each| each.depth(&self.flank, s));
        depths.sum()
    }

    /// The slope of [`SpurGear::removed`] by the roll length.
    pub fn removed_slope(&self, s: f64) -> f64 {
        let modified = self
            .modifications
            .iter()
            .map(|each| each.slope(&self.flank, s));
        modified.sum::<f64>() + self.ends_depth_and_slope(s).1
    }

    /// By how much the normal of the flank is inclined at the roll length `s`, as [`SpurGear::removed_slope`]: a kink of a modification is rounded
    /// over a length far below any contact's. Flanks that are pressed together bend over it; a normal that jumped would open a step in their gap.
    pub fn inclination(&self, s: f64) -> f64 {
        let half = self.rounding_of_kinks();
        let modified = if self.modifications.is_empty() {
            0.0
        } else {
            (self.modified(s + half) - self.modified(s - half)) / (2.0 * half)
        };
        modified + self.ends_depth_and_slope(s).1
    }

    /// The length to either side of a kink of a modification over which normals are rounded.
    pub(in crate::gear) fn rounding_of_kinks(&self) -> f64 {
        ROUNDED * self.data.rack.module
    }

    /// [`SpurGear::removed`] and [`SpurGear::inclination`] at once; where nothing is removed that costs nothing.
    pub fn removed_and_inclination(&self, s: f64) -> (f64, f64) {
        let [from, to] = self.untouched;
        if from < s && s < to {
            return (0.0, 0.0);
        }
        (self.removed(s), self.inclination(s))
    }

    /// The roll lengths between which nothing is removed, and no kink is near.
    pub fn untouched(&self) -> [f64; 2] {
        self.untouched
    }

    pub(super) fn untouched_roll_lengths(&self) -> [f64; 2] {
        let half = self.rounding_of_kinks();
        let below_edge = self.broken_edge.map_or(f64::INFINITY, |edge| edge.from);
        let above_undercut = if self.is_undercut {
            self.form_roll_length
        } else {
            0.0
        };
        let each = self.modifications.iter();
        let [from, to] = each
            .map(|each| each.untouched(&self.flank))
            .fold([above_undercut, below_edge], |[from, to], [low, high]| {
                [from.max(low), to.min(high)]
            });
        [from + half, to - half]
    }

    /// Turn of the ends of the flank, by the broken edge at its tip and the undercut at its root, and its slope by the roll length `s`.
    fn ends_depth_and_slope(&self, s: f64) -> (f64, f64) {
        if self.is_undercut && s < self.form_roll_length {
            return self.undercut_depth_and_slope(s);
        }
        self.broken_edge
            .map_or((0.0, 0.0), |edge| edge.depth_and_slope(&self.flank, s))
    }

    /// How far the involute is turned back at the radius of its roll length `s` to lie on the fillet that undercuts it, as a length on the base
    /// circle, and the slope of that by `s`.
    fn undercut_depth_and_slope(&self, s: f64) -> (f64, f64) {
        const STEP: f64 = 1e-6;
        // Where the rounding of a protuberance has come back to the involute the flank has ended.
        let s = if self.end_of_rack > 0.0 {
            s.max(self.end_of_rack)
        } else {
            s
        };
        let (r_b, r) = (self.flank.base_radius(), self.flank.radius(s));
        let gamma = self.fillet.gamma_at(r);
        let polar = |gamma: f64| {
            let point = self.fillet.point(gamma);
            (point.norm(), point.y.atan2(point.x))
        };
        let (before, here, after) = (polar(gamma - STEP), polar(gamma), polar(gamma + STEP));
        let change = (after.1 - before.1) / (after.0 - before.0);
        let depth = r_b * (self.flank.half_angle(r) - here.1);
        // As of a broken edge.
        let slope = -s / r * (s / r + r_b * change);
        (depth.max(0.0), slope)
    }

    /// The roll length down to which the flank is followed as it is cut: the form circle, or below the corner of an undercut flank nearly the base circle, or
    /// the end of the rack's flank.
    pub fn lowest_roll_length(&self) -> f64 {
        // A roll length of a tenth is a hundredth of the height above the base circle.
        const NEARLY: f64 = 0.1;
        if self.is_undercut {
            self.end_of_rack.max(NEARLY * self.form_roll_length)
        } else {
            self.form_roll_length
        }
    }

    /// The roll lengths, rising, at which the flank has a kink: the corner of undercut, the starts of reliefs, the entries of tables, and where a
    /// rounding begins, which bends a hundred times as sharply; so may a short parabolic relief.
    pub fn kinks(&self) -> Vec<f64> {
        let rounded = matches!(self.data.tip_edge, TipEdge::Rounded(_));
        let rounding = rounded.then(|| self.tip_form_roll_length());
        let modifications = self.modifications.iter();
        let mut kinks: Vec<f64> = modifications
            .flat_map(|each| each.kinks(&self.flank))
            .chain(rounding)
            .chain(self.is_undercut.then_some(self.form_roll_length))
            .filter(|s| (self.form_roll_length()..self.tip_roll_length()).contains(s))
            .collect();
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    /// [`SpurGear::removed_slope`] just before and beyond the roll length `s` of a kink.
    pub fn slopes_beside(&self, s: f64) -> [f64; 2] {
        let step = 1e-6 * self.data.rack.module;
        [s - step, s + step].map(|s| self.removed_slope(s))
    }

    /// The roll length of the edge at which a chamfer begins.
    pub fn chamfer_edge(&self) -> Option<f64> {
        let chamfered = matches!(self.data.tip_edge, TipEdge::Chamfered(_));
        chamfered.then(|| self.tip_form_roll_length())
    }

    /// True if the flank, down to its fillet, is an involute whose modifications only ever bend it away from its mate.
    pub fn is_convex(&self) -> bool {
        !self.is_undercut && self.modifications.iter().all(Modification::is_convex)
    }

    /// How the teeth deviate from each other.
    pub fn deviations(&self) -> &ToothDeviations {
        &self.data.deviations
    }
}
