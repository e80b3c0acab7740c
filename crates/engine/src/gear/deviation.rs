//! Deviations of the teeth of a gear from each other, and of their circle from the axis of rotation.

use std::f64::consts::PI;

use super::modification::TablePlaces;
use super::{Vector, radial};

/// The gear's own axis off the axis about which it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eccentricity {
    /// The distance e of both axes.
    pub amount: f64,
    /// The direction of the gear's axis from the axis of rotation: the angle from the centerline of tooth 0, positive towards its
    /// loaded flank, in radians.
    pub direction: f64,
}

/// A trace of each loaded flank along its profile. It adds to the modifications of the gear.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothProfiles {
    /// Where the entries of all traces stand; linear between them, ends held.
    pub places: TablePlaces,
    /// Removed at each, tooth 0 first.
    pub removed: Vec<Vec<f64>>,
}

/// A trace of each loaded flank along its lead, the same at every roll length. It adds to the lead modifications of the gear.
#[derive(Debug, Clone, PartialEq)]
pub struct ToothLeads {
    /// The heights from the middle of the face at which the entries of all traces stand, rising; linear between them, ends held.
    pub heights: Vec<f64>,
    /// Removed at each, tooth 0 first.
    pub removed: Vec<Vec<f64>>,
}

/// Measured deviations of each tooth from its drawing. Lengths in meters, positive where the loaded flank stands farther towards its mate, so that it touches
/// earlier. Empty lists are teeth without deviation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToothDeviations {
    /// The cumulative pitch deviation F_p of each loaded flank, tooth 0 first: a transverse arc on the reference circle (ISO 1328-1).
    pub cumulative_pitch: Vec<f64>,
    /// Deviation of each other flank, positive in the same sense of rotation. Empty: each tooth is displaced as a whole. Its mean has no meaning: that of
    /// the loaded flanks takes its place, because the drawing says how thick teeth are in the mean.
    pub other_cumulative_pitch: Vec<f64>,
    /// The profile slope deviation f_Hα of each loaded flank: nothing at the form circle, this at the tip circle.
    pub profile_slope: Vec<f64>,
    /// The lead slope of each loaded flank, as [`super::LeadModification::Slope`]: nothing removed at the end at −z of the face, this at that at +z.
    /// The plane does not know it.
    pub lead_slope: Vec<f64>,
    /// Profile trace of each loaded flank beside the modifications.
    pub profiles: Option<ToothProfiles>,
    /// Lead trace of each loaded flank beside the modifications. The plane does not support it.
    pub leads: Option<ToothLeads>,
    /// The eccentricity of the teeth.
    pub eccentricity: Option<Eccentricity>,
}

impl ToothDeviations {
    /// The shortest form: lists of zeros become empty.
    pub(super) fn without_zeros(mut self) -> Self {
        if self.other_pitch() == self.cumulative_pitch {
            self.other_cumulative_pitch.clear();
        }
        for list in [
            &mut self.cumulative_pitch,
            &mut self.profile_slope,
            &mut self.lead_slope,
        ] {
            if list.iter().all(|deviation| *deviation == 0.0) {
                list.clear();
            }
        }
        let deviates = |rows: &[Vec<f64>]| rows.iter().flatten().any(|removed| *removed != 0.0);
        self.profiles = self.profiles.filter(|traces| deviates(&traces.removed));
        self.leads = self.leads.filter(|traces| deviates(&traces.removed));
        self.eccentricity = self.eccentricity.filter(|each| each.amount != 0.0);
        self
    }

    /// True if every tooth stands as drawn, about the axis of rotation. Of a gear that has been checked.
    pub fn is_none(&self) -> bool {
        self.are_teeth_equal() && self.eccentricity.is_none()
    }

    /// True if no flank deviates. Of a gear that has been checked.
    pub fn are_teeth_equal(&self) -> bool {
        self.cumulative_pitch.is_empty()
            && self.other_cumulative_pitch.is_empty()
            && self.profile_slope.is_empty()
            && self.lead_slope.is_empty()
            && self.profiles.is_none()
            && self.leads.is_none()
    }

    /// Where the gear's own axis stands from the axis of rotation while the centerline of tooth 0 points along `angle`.
    pub fn displacement(&self, angle: f64) -> Vector {
        self.eccentricity
            .map_or_else(Vector::zeros, |each| each.displacement(angle))
    }

    /// The cumulative pitch deviation of each other flank, of the mean of that of the loaded ones. Empty where no tooth is displaced.
    pub(super) fn other_pitch(&self) -> Vec<f64> {
        let (loaded, other) = (&self.cumulative_pitch, &self.other_cumulative_pitch);
        if other.is_empty() {
            return loaded.clone();
        }
        let sum = |arcs: &[f64]| arcs.iter().sum::<f64>();
        let shift = (sum(loaded) - sum(other)) / other.len() as f64;
        let shifted: Vec<f64> = other.iter().map(|arc| arc + shift).collect();
        let are_none = loaded.is_empty() && shifted.iter().all(|arc| *arc == 0.0);
        if are_none { Vec::new() } else { shifted }
    }

    /// Deviations of the mirror image of the gear, whose loaded flanks are the other flanks of this one: teeth are counted the other way round, from the tooth
    /// `first` of this gear on, which has `teeth` teeth. Slopes and traces are those of the loaded flanks and are left out.
    pub(super) fn mirrored(&self, teeth: usize, first: usize) -> Self {
        let turned = |arcs: &[f64]| -> Vec<f64> {
            let from = |tooth: usize| (first + teeth - tooth) % teeth;
            let places = (0..arcs.len()).map(from);
            places.map(|place| 0.0 - arcs[place]).collect()
        };
        let to_first = 2.0 * PI * first as f64 / teeth as f64;
        Self {
            cumulative_pitch: turned(&self.other_pitch()),
            other_cumulative_pitch: turned(&self.cumulative_pitch),
            profile_slope: Vec::new(),
            lead_slope: Vec::new(),
            profiles: None,
            leads: None,
            eccentricity: self.eccentricity.map(|each| Eccentricity {
                direction: to_first - each.direction,
                ..each
            }),
        }
        .without_zeros()
    }
}

impl Eccentricity {
    /// Where the gear's axis stands from the axis of rotation while the centerline of tooth 0 points along `angle`.
    pub(super) fn displacement(self, angle: f64) -> Vector {
        self.amount * radial(angle + self.direction)
    }
}
