//! The order spectrum of a curve.

use meshwright_engine::analysis::spectrum::{NamedOrder, Spectrum};
use meshwright_engine::analysis::{Case, OrderCause, OrderKind};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::each;
use crate::wire::geometry::Frequencies;
use crate::wire::units::{known, to_um};
use crate::wire::warning::GearName;

/// Single-sided amplitudes and phases: y = sum of A cos(2 pi k j/n + phase), no window; the mean is left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Spectrum, title = "Spectrum")]
pub struct SpectrumDocument {
    /// Orders per revolution of the driven gear.
    pub order: Vec<f64>,
    /// The same orders per revolution of the driving gear.
    pub driving_order: Vec<f64>,
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
    #[serde(deserialize_with = "known")]
    pub named: Vec<NamedOrderDocument>,
}

impl SpectrumDocument {
    pub(super) fn of(case: &Case, spectrum: &Spectrum) -> Self {
        // An order counts per revolution of the driven gear, so that gear's speed turns it into a frequency.
        let driven_hz = Frequencies::of(case).map(|frequencies| frequencies.driven_hz);
        let pair = &case.pair;
        let [z_1, z_2] = [pair.driving(), pair.driven()].map(|gear| f64::from(gear.tooth_count()));
        Self {
            order: spectrum.order.clone(),
            driving_order: each(&spectrum.order, |order| order * z_1 / z_2),
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
                .map(|line| NamedOrderDocument::of(line, driven_hz))
                .collect(),
        }
    }
}

/// A line of the spectrum that has a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = NamedOrder, title = "Named order")]
pub struct NamedOrderDocument {
    /// The order per revolution of the driven gear.
    pub order: f64,
    /// Its name: H_Z2 and multiples for the mesh, H_N for the holes (H_N1 and H_N2 where both gears have different
    /// ones), H_1 and multiples for revolutions of gears that deviate (H_1(1) for those of a driving gear that turns at another speed), H_Z2+N, H_Z2-1 and so
    /// on for the sidebands.
    #[schema(example = "H_N")]
    pub label: String,
    /// What it is.
    pub kind: OrderKindName,
    /// The gears that make it: both for the mesh.
    pub gears: Vec<GearName>,
    /// k, for the k-th multiple of the mesh order and for sidebands about it; absent for others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_harmonic: Option<u32>,
    /// n, for the n-th multiple of a hole or revolution order; for a sideband with the sign of its side, absent for the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiple: Option<i64>,
    /// Its frequency, in Hz; absent without a speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// The amplitude of the transmission error, in um.
    pub transmission_error_um: f64,
    /// The amplitude of the tangent stiffness, in N/m.
    pub mesh_stiffness_tangent_n_per_m: f64,
}

/// What a line of the spectrum is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = OrderKind, title = "Kind of an order")]
pub enum OrderKindName {
    /// k times the mesh.
    Mesh,
    /// n times the order of the holes.
    Holes,
    /// n times a revolution: eccentricity, pitch deviations, ghost orders.
    Revolution,
    /// k times the mesh and n times the order of the holes, more or less.
    HoleSideband,
    /// k times the mesh and n revolutions, more or less.
    RevolutionSideband,
}

impl NamedOrderDocument {
    fn of(line: &NamedOrder, driven_hz: Option<f64>) -> Self {
        let (kind, cause, mesh_harmonic, multiple) = match &line.kind {
            OrderKind::Mesh { harmonic } => (OrderKindName::Mesh, None, Some(*harmonic), None),
            OrderKind::Cause { cause, multiple } => {
                let [of_holes, of_revolutions] = [OrderKindName::Holes, OrderKindName::Revolution];
                let kind = if cause.holes {
                    of_holes
                } else {
                    of_revolutions
                };
                (kind, Some(cause), None, Some(i64::from(*multiple)))
            }
            OrderKind::Sideband {
                harmonic,
                cause,
                multiple,
            } => {
                let kind = if cause.holes {
                    OrderKindName::HoleSideband
                } else {
                    OrderKindName::RevolutionSideband
                };
                let multiple = Some(i64::from(*multiple));
                (kind, Some(cause), Some(*harmonic), multiple)
            }
        };
        Self {
            order: line.order,
            label: line.label.clone(),
            kind,
            gears: gears_of(cause),
            mesh_harmonic,
            multiple,
            frequency_hz: driven_hz.map(|hz| line.order * hz),
            transmission_error_um: to_um(line.transmission_error),
            mesh_stiffness_tangent_n_per_m: line.mesh_stiffness_tangent,
        }
    }
}

/// The gears behind a cause; behind the mesh, which has none, are both.
fn gears_of(cause: Option<&OrderCause>) -> Vec<GearName> {
    match cause {
        None => vec![GearName::Driving, GearName::Driven],
        Some(cause) => cause.gears.iter().copied().map(GearName::from).collect(),
    }
}
