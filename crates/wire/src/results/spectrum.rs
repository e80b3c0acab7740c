//! The order spectrum of a curve.

use meshwright_engine::analysis::spectrum::{NamedOrder, Spectrum};
use meshwright_engine::analysis::{Case, OrderCause, OrderKind};
use meshwright_engine::gear::Member;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{all, each};
use crate::declare::document;
use crate::geometry::Frequencies;
use crate::units::{known, to_um};
use crate::warning::GearName;

document! {
    /// Single-sided amplitudes and phases: y = sum of A cos(2 pi k j/n + phase), no window; the mean is left out.
    pub struct SpectrumDocument as Spectrum, "Spectrum"
    answer of (case: &Case, spectrum: &Spectrum) with {
        // An order counts per revolution of the driven gear, so that gear's speed turns it into a frequency.
        let driven_hz = Frequencies::of_case(case).map(|frequencies| frequencies.driven_hz);
        let [z_1, z_2] = Member::BOTH.map(|member| f64::from(case.pair.gear(member).tooth_count()));
    } {
        /// Orders per revolution of the driven gear.
        order: Vec<f64> = spectrum.order.clone(),
        /// The same orders per revolution of the driving gear.
        driving_order: Vec<f64> = each(&spectrum.order, |order| order * z_1 / z_2),
        /// The frequency of each order, in Hz; absent without a speed.
        frequency_hz?: Vec<f64> = driven_hz.map(|hz| each(&spectrum.order, |order| order * hz)),
        /// Amplitudes of the transmission error, in um.
        transmission_error_um: Vec<f64> = each(&spectrum.transmission_error, to_um),
        /// Phases of the transmission error, in degrees.
        transmission_error_phase_deg: Vec<f64> =
            each(&spectrum.transmission_error_phase, f64::to_degrees),
        /// Amplitudes of the tangent stiffness, in N/m.
        mesh_stiffness_tangent_n_per_m: Vec<f64> = spectrum.mesh_stiffness_tangent.clone(),
        /// Phases of the tangent stiffness, in degrees.
        mesh_stiffness_tangent_phase_deg: Vec<f64> =
            each(&spectrum.mesh_stiffness_tangent_phase, f64::to_degrees),
        /// The lines that have names, by rising order.
        #[serde(deserialize_with = "known")]
        named: Vec<NamedOrderDocument> = all(&spectrum.named, |line| {
            NamedOrderDocument::of(line, driven_hz)
        }),
    }
}

document! {
    /// A line of the spectrum that has a name.
    pub struct NamedOrderDocument as NamedOrder, "Named order"
    answer of (line: &NamedOrder, driven_hz: Option<f64>) with {
        let (kind, cause, mesh_harmonic, multiple) = parts_of(&line.kind);
    } {
        /// The order per revolution of the driven gear.
        order: f64 = line.order,
        /// Its name: H_Z2 and multiples for the mesh, H_N for the holes (H_N1 and H_N2 where both gears have different
        /// ones), H_1 and multiples for revolutions of gears that deviate (H_1(1) for those of a driving gear that turns at another speed), H_Z2+N, H_Z2-1 and so
        /// on for the sidebands.
        #[schema(example = "H_N")]
        label: String = line.label.clone(),
        /// Kind of order.
        kind: OrderKindName = kind,
        /// The gears that make it: both for the mesh.
        gears: Vec<GearName> = cause
            .map_or(&Member::BOTH[..], |cause| &cause.gears)
            .iter()
            .copied()
            .map(GearName::from)
            .collect(),
        /// k, for the k-th multiple of the mesh order and for sidebands about it; absent for others.
        mesh_harmonic?: u32 = mesh_harmonic,
        /// n, for the n-th multiple of a hole or revolution order; for a sideband with the sign of its side, absent for the mesh.
        multiple?: i64 = multiple,
        /// Its frequency, in Hz; absent without a speed.
        frequency_hz?: f64 = driven_hz.map(|hz| line.order * hz),
        /// The amplitude of the transmission error, in um.
        transmission_error_um: f64 = to_um(line.transmission_error),
        /// The amplitude of the tangent stiffness, in N/m.
        mesh_stiffness_tangent_n_per_m: f64 = line.mesh_stiffness_tangent,
        /// Of an order of holes, where teeth deviate: the amplitude of the transmission error that the holes alone make, in um. It is that of the pair as
        /// drawn; along faces by the method that takes holes to the first order.
        transmission_error_of_holes_um?: f64 = line.of_holes.map(to_um),
    }
}

/// Kind of a line of the spectrum.
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

/// Kind of an order, its cause unless it is the mesh, k and n.
fn parts_of(kind: &OrderKind) -> (OrderKindName, Option<&OrderCause>, Option<u32>, Option<i64>) {
    match kind {
        OrderKind::Mesh { harmonic } => (OrderKindName::Mesh, None, Some(*harmonic), None),
        OrderKind::Cause { cause, multiple } => {
            let kind = if cause.holes {
                OrderKindName::Holes
            } else {
                OrderKindName::Revolution
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
    }
}
