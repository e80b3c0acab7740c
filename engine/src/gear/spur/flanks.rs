//! How the flanks of a gear differ from the involute that the rack cuts, and from each other.

use super::SpurGear;
use crate::gear::modification::{Modification, Relief};
use crate::gear::{TipEdge, ToothDeviations};

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
        let edge = self
            .broken_edge
            .map_or(0.0, |edge| edge.depth_and_slope(&self.flank, s).1);
        modified.sum::<f64>() + edge
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
