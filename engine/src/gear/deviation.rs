//! How the teeth of a gear deviate from each other, and their circle from the axis of rotation.

use super::{Vector, radial};

/// The gear's own axis beside the axis about which it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eccentricity {
    /// The distance e of both axes.
    pub amount: f64,
    /// The direction of the gear's axis from the axis of rotation: the angle from the centerline of tooth 0, positive towards its
    /// loaded flank, in radians.
    pub direction: f64,
}

/// What each tooth deviates from its drawing, as measured. Lengths in meters, positive where the loaded flank stands farther towards its
/// mate, so that it touches earlier. Empty lists are teeth without deviation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToothDeviations {
    /// The cumulative pitch deviation F_p of each loaded flank, tooth 0 first: a transverse arc on the reference circle (ISO 1328-1).
    pub cumulative_pitch: Vec<f64>,
    /// The profile slope deviation f_Hα of each loaded flank: nothing at the form circle, this at the tip circle.
    pub profile_slope: Vec<f64>,
    /// The lead slope of each loaded flank, as [`super::LeadModification::Slope`]: nothing removed at the end at −z of the face, this at that at +z.
    /// The plane does not know it.
    pub lead_slope: Vec<f64>,
    /// The eccentricity of the teeth.
    pub eccentricity: Option<Eccentricity>,
}

impl ToothDeviations {
    /// The same said shortest: what deviates by nothing is not there.
    pub(super) fn without_zeros(mut self) -> Self {
        for list in [
            &mut self.cumulative_pitch,
            &mut self.profile_slope,
            &mut self.lead_slope,
        ] {
            if list.iter().all(|deviation| *deviation == 0.0) {
                list.clear();
            }
        }
        self.eccentricity = self.eccentricity.filter(|each| each.amount != 0.0);
        self
    }

    /// Whether every tooth stands as drawn, about the axis of rotation. Of a gear that exists.
    pub fn is_none(&self) -> bool {
        self.are_teeth_alike() && self.eccentricity.is_none()
    }

    /// Whether no tooth deviates. Of a gear that exists.
    pub fn are_teeth_alike(&self) -> bool {
        self.cumulative_pitch.is_empty()
            && self.profile_slope.is_empty()
            && self.lead_slope.is_empty()
    }

    /// Where the gear's own axis stands from the axis of rotation while the centerline of tooth 0 points along `angle`.
    pub fn displacement(&self, angle: f64) -> Vector {
        self.eccentricity
            .map_or_else(Vector::zeros, |each| each.displacement(angle))
    }
}

impl Eccentricity {
    /// Where the gear's axis stands from the axis of rotation while the centerline of tooth 0 points along `angle`.
    pub(super) fn displacement(self, angle: f64) -> Vector {
        self.amount * radial(angle + self.direction)
    }
}
