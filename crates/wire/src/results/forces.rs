//! The table of force, and the motion over speed.

use meshwright_engine::analysis::at_speed::CurveDynamics;
use meshwright_engine::dynamics::{Branch, FlankRows, ForceTable, Resonance, ResonanceKind};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{all, each};
use crate::declare::document;
use crate::units::to_um;

document! {
    /// The force between the gears over mesh position and approach: under which approach each load acts at each position, over the true period.
    pub struct ForceTableDocument as ForceTable, "Force table" answer of (table: &ForceTable) with {
        let in_um = |row: &Vec<f64>| each(row, to_um);
        let stiffness = |row: &Vec<f64>| {
            each(row, |compliance| {
                if compliance > 0.0 {
                    1.0 / compliance
                } else {
                    0.0
                }
            })
        };
        let stiffnesses =
            |flank: &FlankRows| all(flank.compliance.as_deref().unwrap_or_default(), stiffness);
        let (loaded, other) = (table.loaded(), table.other());
    } {
        /// The mesh position, in mesh periods, end excluded.
        mesh_position: Vec<f64> = table.mesh_positions(),
        /// The loads on the line of action, in N, rising from 0.
        load_n: Vec<f64> = table.loads().to_vec(),
        /// The approach under each load, in um: one row a load, one number a position. Positive where the driven gear lags.
        transmission_error_um: Vec<Vec<f64>> = all(&loaded.delta, in_um),
        /// The stiffness dF/d(approach) under each load, in N/m: one row a load, that of the load 0 being 0. With it tables need fewer loads.
        #[serde(default)]
        #[schema(required)]
        mesh_stiffness_tangent_n_per_m: Vec<Vec<f64>> = stiffnesses(loaded),
        /// The backlash along the line of action at each position, in um, deviations and eccentricity included: no force acts while the approach is less
        /// than that of load 0 by up to this much.
        backlash_um: Vec<f64> = each(&table.backlash(), to_um),
        /// The approach at which the other flanks carry each load: one row a load. Pitch deviations and eccentricity move them as they say; profile and
        /// lead slopes of single teeth are those of the loaded flanks alone.
        other_flank_transmission_error_um: Vec<Vec<f64>> = all(&other.delta, in_um),
        /// The stiffness of the other flanks under each load, in N/m, in the same order.
        #[serde(default)]
        #[schema(required)]
        other_flank_mesh_stiffness_tangent_n_per_m: Vec<Vec<f64>> = stiffnesses(other),
    }
}

document! {
    /// The motion of the gears over speed under one torque. All lists run over the same speeds.
    pub struct CurveDynamicsDocument as Dynamics, "Dynamics"
    answer of (dynamics: &CurveDynamics) with {
        let CurveDynamics { run_up, labels, .. } = dynamics;
        let branch = |branch: &Branch| BranchDocument::of(branch, labels);
    } {
        /// The natural frequency of the mean mesh stiffness and the equivalent mass, in Hz.
        natural_frequency_hz: f64 = run_up.natural_frequency,
        /// The mass on the line of action, in kg: 1/m = R_b1^2/J_1 + R_b2^2/J_2.
        equivalent_mass_kg: f64 = dynamics.equivalent_mass,
        /// The speed of the driving gear, in 1/min.
        driving_speed_rpm: Vec<f64> = each(&dynamics.speeds, to_rpm),
        /// Run up from the lowest speed; absent if not asked for.
        up?: BranchDocument = run_up.up.as_ref().map(branch),
        /// Run down from the highest speed; absent if not asked for.
        down?: BranchDocument = run_up.down.as_ref().map(branch),
        /// The speeds at which an order meets the natural frequency, or twice it: the one with the largest amplitude first.
        resonances: Vec<ResonanceDocument> = all(&run_up.resonances, |found| {
            ResonanceDocument::of(found, labels)
        }),
    }
}

document! {
    /// The motion over speed, run through one way.
    pub struct BranchDocument as RunUpBranch, "Branch of a run-up"
    answer of (branch: &Branch, labels: &[String]) {
        /// The dynamic transmission error, in um.
        dynamic_transmission_error_um: DynamicErrorDocument = DynamicErrorDocument::of(branch),
        /// The largest force between the gears over the static load.
        dynamic_load_factor: Vec<f64> = branch.load_factor.clone(),
        /// True where the loaded flanks separate.
        contact_lost: Vec<bool> = branch.contact_lost.clone(),
        /// True periods after which the motion repeats; 0 where it was not found to.
        period_multiple: Vec<u32> = all(&branch.repeats, |repeats| repeats.unwrap_or(0)),
        /// The amplitudes at the orders of the mesh to the tenth, of holes, of the first revolutions of gears that deviate, at the sidebands of both, and at
        /// others that stand out.
        orders: Vec<OrderAmplitudesDocument> = labels
            .iter()
            .zip(&branch.orders)
            .map(|(label, found)| OrderAmplitudesDocument::of(label, found))
            .collect(),
    }
}

document! {
    /// The dynamic transmission error over speed, in um.
    pub struct DynamicErrorDocument as DynamicTransmissionError, "Dynamic transmission error"
    answer of (branch: &Branch) {
        /// The root mean square of the fluctuation, the mean removed.
        rms: Vec<f64> = each(&branch.rms, to_um),
        /// The largest less the smallest value.
        peak_to_peak: Vec<f64> = each(&branch.peak_to_peak, to_um),
    }
}

document! {
    /// The amplitude at one order over speed.
    pub struct OrderAmplitudesDocument as OrderAmplitudes, "Amplitudes of an order"
    answer of (label: &str, amplitudes: &[f64]) {
        /// Its name, as in the spectrum.
        #[schema(example = "H_Z2")]
        label: String = label.to_owned(),
        /// Its amplitude, in um.
        amplitude_um: Vec<f64> = each(amplitudes, to_um),
    }
}

document! {
    /// A speed at which an order resonates.
    pub struct ResonanceDocument as Resonance, "Resonance"
    answer of (resonance: &Resonance, labels: &[String]) {
        /// The speed of the driving gear, in 1/min.
        driving_speed_rpm: f64 = to_rpm(resonance.speed),
        /// The name of the order.
        #[schema(example = "H_Z2")]
        label: String = labels[resonance.order].clone(),
        /// Cause: forced or parametric.
        kind: ResonanceKindName = resonance.kind.into(),
        /// The amplitude of the motion at the natural frequency at this speed, in um, on the branch where it is larger. A parametric resonance that does not
        /// pump has 0.
        #[serde(default)]
        #[schema(required)]
        amplitude_um: f64 = to_um(resonance.amplitude),
    }
}

/// Why an order resonates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ResonanceKind, title = "Kind of a resonance")]
pub enum ResonanceKindName {
    /// The order meets the natural frequency.
    Forced,
    /// It meets twice the natural frequency; its part of the stiffness excites parametrically.
    Parametric,
}

impl From<ResonanceKind> for ResonanceKindName {
    fn from(kind: ResonanceKind) -> Self {
        match kind {
            ResonanceKind::Forced => Self::Forced,
            ResonanceKind::Parametric => Self::Parametric,
        }
    }
}

fn to_rpm(revolutions_per_second: f64) -> f64 {
    60.0 * revolutions_per_second
}
