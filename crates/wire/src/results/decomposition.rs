//! Terms of the decomposition.

use meshwright_engine::analysis::curve::{BlankFit, BlankSample, DecompositionParts};

use super::{all, each};
use crate::declare::document;
use crate::units::{to_mm, to_um};
use crate::warning::GearName;

document! {
    /// Terms of the decomposition, eq. 15.
    pub struct DecompositionDocument as Decomposition, "Decomposition"
    answer of (parts: &DecompositionParts) {
        /// The transmission error with rigid blanks, in um, at each position of the curve.
        rigid_blank_transmission_error_um: Vec<f64> =
            each(&parts.rigid_blank_transmission_error, to_um),
        /// One entry for each holed gear.
        blanks: Vec<BlankFitDocument> = all(&parts.blanks, BlankFitDocument::of),
    }
}

document! {
    /// The decomposition's fit for one holed blank: mean + amplitude cos(N theta + phase), eq. 13.
    pub struct BlankFitDocument as BlankFit, "Blank fit" answer of (fit: &BlankFit) {
        /// The gear.
        gear: GearName = fit.member.into(),
        /// The interface radius, in mm.
        interface_radius_mm: f64 = to_mm(fit.interface_radius),
        /// The mean A, in um along the line of action.
        mean_um: f64 = to_um(fit.mean),
        /// The amplitude B, in um along the line of action, not negative.
        amplitude_um: f64 = to_um(fit.amplitude),
        /// The phase, in degrees.
        phase_deg: f64 = fit.phase.to_degrees(),
        /// The harmonics 2, 3 and so on of holes that are not equal or not evenly spaced; absent for a pattern, which has none.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        higher: Vec<BlankHarmonicDocument> = (2..)
            .zip(&fit.higher)
            .map(|(harmonic, found)| BlankHarmonicDocument::of(harmonic, found))
            .collect(),
        /// The samples that were fitted.
        samples: Vec<BlankSampleDocument> = all(&fit.samples, BlankSampleDocument::of),
    }
}

document! {
    /// One sample of a holed blank.
    pub struct BlankSampleDocument as BlankSample, "Blank sample" answer of (sample: &BlankSample) {
        /// The mesh position, in mesh periods.
        mesh_position: f64 = sample.mesh_position,
        /// The rotation of the hub times the base radius, in um.
        rotation_um: f64 = to_um(sample.rotation),
    }
}

document! {
    /// A further harmonic of a holed blank: amplitude cos(harmonic N theta + phase).
    pub struct BlankHarmonicDocument as BlankHarmonic, "Blank harmonic"
    answer of (harmonic: u32, (amplitude, phase): &(f64, f64)) {
        /// Which of them.
        harmonic: u32 = harmonic,
        /// The amplitude, in um along the line of action, not negative.
        amplitude_um: f64 = to_um(*amplitude),
        /// The phase, in degrees.
        phase_deg: f64 = phase.to_degrees(),
    }
}
