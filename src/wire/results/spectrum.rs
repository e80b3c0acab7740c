//! The order spectrum of a curve.

use meshwright_engine::analysis::Case;
use meshwright_engine::analysis::spectrum::Spectrum;
use serde::Serialize;
use utoipa::ToSchema;

use super::each;
use crate::wire::geometry::Frequencies;
use crate::wire::units::to_um;

/// Single-sided amplitudes and phases: y = sum of A cos(2 pi k j/n + phase), no window; the mean is left out.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Spectrum, title = "Spectrum")]
pub struct SpectrumDocument {
    /// Orders per revolution of the driven gear.
    pub order: Vec<f64>,
    /// The frequency of each order, in Hz; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<Vec<f64>>,
    /// Amplitudes of the transmission error, in um.
    pub transmission_error_um: Vec<f64>,
    /// Phases of the transmission error, in degrees.
    pub transmission_error_phase_deg: Vec<f64>,
    /// Amplitudes of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: Vec<f64>,
    /// Phases of the tangent stiffness, in degrees.
    pub mesh_stiffness_tangent_phase_deg: Vec<f64>,
    /// The lines that have names, by rising order.
    pub named: Vec<NamedOrderDocument>,
}

impl SpectrumDocument {
    pub(super) fn of(case: &Case, spectrum: &Spectrum) -> Self {
        // An order counts per revolution of the driven gear, so that gear's speed turns it into a frequency.
        let driven_hz = Frequencies::of(case).map(|frequencies| frequencies.driven_hz);
        Self {
            order: spectrum.order.clone(),
            frequency_hz: driven_hz.map(|hz| each(&spectrum.order, |order| order * hz)),
            transmission_error_um: each(&spectrum.transmission_error, to_um),
            transmission_error_phase_deg: each(&spectrum.transmission_error_phase, f64::to_degrees),
            mesh_stiffness_tangent_n_per_m: spectrum.mesh_stiffness_tangent.clone(),
            mesh_stiffness_tangent_phase_deg: each(
                &spectrum.mesh_stiffness_tangent_phase,
                f64::to_degrees,
            ),
            named: spectrum
                .named
                .iter()
                .map(|line| NamedOrderDocument {
                    order: line.order,
                    label: line.label.clone(),
                    frequency_hz: driven_hz.map(|hz| line.order * hz),
                    transmission_error_um: to_um(line.transmission_error),
                    mesh_stiffness_tangent_n_per_m: line.mesh_stiffness_tangent,
                })
                .collect(),
        }
    }
}

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = NamedOrder, title = "Named order")]
pub struct NamedOrderDocument {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// Its name: H_Z2 and multiples for the mesh, H_N for the holes (H_N1 and H_N2 where both gears have different
    /// ones), H_Z2+N and so on for the sidebands.
    #[schema(example = "H_N")]
    pub label: String,
    /// Its frequency, in Hz; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// The amplitude of the transmission error, in um.
    pub transmission_error_um: f64,
    /// The amplitude of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: f64,
}
