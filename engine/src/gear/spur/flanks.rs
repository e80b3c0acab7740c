//! How the flanks of a gear differ from the involute that the rack cuts, and from each other.

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

    /// The material removed from every loaded flank at the roll length `s`, modifications and the broken edge: the flank is turned back by
    /// this length on the base circle there, so that it belongs to the actual radius, and a tip corner stays on the tip circle.
    pub fn removed(&self, s: f64) -> f64 {
        let edge = self
            .broken_edge
            .map_or(0.0, |edge| edge.depth_and_slope(&self.flank, s).0);
        self.modified(s) + edge
    }

    /// The part of [`SpurGear::removed`] that is meant by modifications, without the broken edge.
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
        modified.sum::<f64>() + self.edge_slope(s)
    }

    /// By how much the normal of the flank is inclined at the roll length `s`, as [`SpurGear::removed_slope`]: a kink of a modification is rounded
    /// over a length far below any contact's. Flanks that are pressed together bend over it; a normal that jumped would open a step in their gap.
    pub fn inclination(&self, s: f64) -> f64 {
        let half = ROUNDED * self.data.rack.module;
        let modified = if self.modifications.is_empty() {
            0.0
        } else {
            (self.modified(s + half) - self.modified(s - half)) / (2.0 * half)
        };
        modified + self.edge_slope(s)
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
        let half = ROUNDED * self.data.rack.module;
        let below_edge = self.broken_edge.map_or(f64::INFINITY, |edge| edge.from);
        let each = self.modifications.iter();
        let [from, to] = each
            .map(|each| each.untouched(&self.flank))
            .fold([0.0, below_edge], |[from, to], [low, high]| {
                [from.max(low), to.min(high)]
            });
        [from + half, to - half]
    }

    fn edge_slope(&self, s: f64) -> f64 {
        self.broken_edge
            .map_or(0.0, |edge| edge.depth_and_slope(&self.flank, s).1)
    }

    /// The roll lengths, rising, at which the flank has a kink: the starts of reliefs, the entries of tables, and where a rounding begins,
    /// which bends a hundred times as sharply; so may a short parabolic relief.
    pub fn kinks(&self) -> Vec<f64> {
        let rounded = matches!(self.data.tip_edge, TipEdge::Rounded(_));
        let rounding = rounded.then(|| self.tip_form_roll_length());
        let modifications = self.modifications.iter();
        let mut kinks: Vec<f64> = modifications
            .flat_map(|each| each.kinks(&self.flank))
            .chain(rounding)
            .filter(|s| (self.form_roll_length()..self.tip_roll_length()).contains(s))
            .collect();
        kinks.sort_by(f64::total_cmp);
        kinks.dedup();
        kinks
    }

    /// The roll length of the edge at which a chamfer begins.
    pub fn chamfer_edge(&self) -> Option<f64> {
        let chamfered = matches!(self.data.tip_edge, TipEdge::Chamfered(_));
        chamfered.then(|| self.tip_form_roll_length())
    }

    /// Whether the modifications only ever bend the flank away from its mate.
    pub fn is_convex(&self) -> bool {
        self.modifications.iter().all(Modification::is_convex)
    }

    /// How the teeth deviate from each other.
    pub fn deviations(&self) -> &ToothDeviations {
        &self.data.deviations
    }
}
