//! What the decomposition adds up.

use meshwright_engine::analysis::curve::{BlankFit, DecompositionParts};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::each;
use crate::wire::units::{to_mm, to_um};
use crate::wire::warning::GearName;

/// What the decomposition adds up, eq. 15.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Decomposition, title = "Decomposition")]
pub struct DecompositionDocument {
    /// The transmission error with rigid blanks, in um, at each position of the curve.
    pub rigid_blank_transmission_error_um: Vec<f64>,
    /// One entry for each holed gear.
    pub blanks: Vec<BlankFitDocument>,
}

impl DecompositionDocument {
    pub(super) fn of(parts: &DecompositionParts) -> Self {
        Self {
            rigid_blank_transmission_error_um: each(&parts.rigid_blank_transmission_error, to_um),
            blanks: parts.blanks.iter().map(BlankFitDocument::of).collect(),
        }
    }
}

/// What the decomposition found for one holed blank: mean + amplitude cos(N theta + phase), eq. 13.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BlankFit, title = "Blank fit")]
pub struct BlankFitDocument {
    /// The gear.
    pub gear: GearName,
    /// The interface radius, in mm.
    pub interface_radius_mm: f64,
    /// The mean A, in um along the line of action.
    pub mean_um: f64,
    /// The amplitude B, in um along the line of action, not negative.
    pub amplitude_um: f64,
    /// The phase, in degrees.
    pub phase_deg: f64,
    /// The harmonics 2, 3 and so on of holes that are not equal or not evenly spaced; absent for a pattern, which has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub higher: Vec<BlankHarmonicDocument>,
    /// The samples that were fitted.
    pub samples: Vec<BlankSampleDocument>,
}

impl BlankFitDocument {
    fn of(fit: &BlankFit) -> Self {
        Self {
            gear: fit.member.into(),
            interface_radius_mm: to_mm(fit.interface_radius),
            mean_um: to_um(fit.mean),
            amplitude_um: to_um(fit.amplitude),
            phase_deg: fit.phase.to_degrees(),
            higher: (2..)
                .zip(&fit.higher)
                .map(|(harmonic, (amplitude, phase))| BlankHarmonicDocument {
                    harmonic,
                    amplitude_um: to_um(*amplitude),
                    phase_deg: phase.to_degrees(),
                })
                .collect(),
            samples: fit
                .samples
                .iter()
                .map(|sample| BlankSampleDocument {
                    mesh_position: sample.mesh_position,
                    rotation_um: to_um(sample.rotation),
                })
                .collect(),
        }
    }
}

/// One sample of a holed blank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BlankSample, title = "Blank sample")]
pub struct BlankSampleDocument {
    /// The mesh position, in mesh periods.
    pub mesh_position: f64,
    /// The rotation of the hub times the base radius, in um.
    pub rotation_um: f64,
}

/// A further harmonic of a holed blank: amplitude cos(harmonic N theta + phase).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = BlankHarmonic, title = "Blank harmonic")]
pub struct BlankHarmonicDocument {
    /// Which of them.
    pub harmonic: u32,
    /// The amplitude, in um along the line of action, not negative.
    pub amplitude_um: f64,
    /// The phase, in degrees.
    pub phase_deg: f64,
}
